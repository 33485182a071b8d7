//! Thirty targets whose gates hold each other's detections: the exact sums of JPDA equal the list of all joint events, cluster by
//! cluster, on the scene that takes a plain listing most of a minute.

use serde_json::{Value, json};
use std::sync::{Arc, Mutex};
use trackloom_domain::association::problem::{Problem, Weights};
use trackloom_domain::association::{ASSOCIATORS, Associator};
use trackloom_domain::math::rng::Seed;
use trackloom_domain::registry::check;

fn jpda(parameters: Value) -> Box<dyn Associator> {
    let jpda = ASSOCIATORS
        .iter()
        .find(|method| method.name == "jpda")
        .unwrap();
    (jpda.build)(
        &check(&parameters, jpda.parameters).unwrap(),
        Seed { seed: 0, run: 0 },
    )
    .unwrap()
}

/// Answers as `exact` does, and notes how far `listed` was from it: largest difference, clusters, largest cluster.
struct Comparing {
    exact: Box<dyn Associator>,
    listed: Box<dyn Associator>,
    found: Arc<Mutex<(f64, u32, usize)>>,
}

impl Associator for Comparing {
    fn fork(&self) -> Box<dyn Associator> {
        unreachable!("nobody forks it")
    }

    fn is_soft(&self) -> bool {
        true
    }

    fn associate(&mut self, problem: &Problem, weights: &mut Weights) {
        let of_cluster = |weights: &Weights| -> Vec<f64> {
            problem
                .rows()
                .flat_map(|(row, state)| {
                    state
                        .edges()
                        .map(|edge| weights.edges[edge])
                        .chain([weights.missed[row]])
                })
                .collect()
        };
        self.listed.associate(problem, weights);
        let listed = of_cluster(weights);
        self.exact.associate(problem, weights);
        let exact = of_cluster(weights);
        let largest = listed
            .iter()
            .zip(&exact)
            .map(|(listed, exact)| (listed - exact).abs())
            .fold(0.0, f64::max);
        let mut found = self.found.lock().unwrap();
        *found = (
            found.0.max(largest),
            found.1 + 1,
            found.2.max(problem.row_count()),
        );
    }
}

#[test]
fn the_exact_sums_equal_the_list_of_all_events() {
    let [line, _] = crate::flights::scenes();
    let found = Arc::new(Mutex::new((0.0, 0, 0)));
    let exact = jpda(json!({"marginals": "exact"}));
    let listed = jpda(json!({"marginals": "enumerate", "max_events": 100_000_000}));
    line.tracked(Box::new(Comparing {
        exact,
        listed,
        found: found.clone(),
    }));
    let (largest, clusters, tracks) = *found.lock().unwrap();
    assert!(
        largest < 1e-12,
        "{} scenes: a difference of {largest}",
        line.name
    );
    assert!(
        clusters >= 30 && tracks >= 8,
        "{clusters} clusters, the largest of {tracks}"
    );
}

/// What JPDA* keeps of flights of ten and of six is within its cap, in every scan.
#[test]
fn the_best_permutations_of_flights_are_within_the_cap() {
    for scene in &crate::flights::scenes() {
        let star = jpda(json!({"against_coalescence": "best_permutation"}));
        let (tracker, _) = scene.tracked(star);
        let kept = tracker.diagnostics().unwrap()["best_permutation"].take();
        assert_eq!(kept["left_to_jpda"], 0, "{}: {kept}", scene.name);
        let (clusters, events) = (kept["clusters"].as_u64(), kept["most_events"].as_u64());
        assert!(clusters > Some(100) && events > Some(10_000), "{kept}");
    }
}
