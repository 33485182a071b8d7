//! The search against the optimum, the soft answer against JPDA's marginals, and their limits.

use super::*;
use crate::association::ASSOCIATORS;
use crate::association::global_nearest_neighbour::GlobalNearestNeighbour;
use crate::association::problem::tests::chosen_by;
use crate::association::problem::{Edge, ScanProblem};
use rand::RngExt;

const SEED: Seed = Seed { seed: 7, run: 0 };

/// Tracks that may have each of the detections; ln(P_D g / λ) between −2 and 4, none 0.05.
pub(super) fn random_problem(
    random: &mut impl RngExt,
    tracks: u32,
    detections: u32,
    density: f64,
) -> ScanProblem {
    let mut problem = ScanProblem::default();
    problem.begin(0, detections as usize);
    for _ in 0..tracks {
        for detection in 0..detections {
            if random.random::<f64>() < density {
                let squared_distance = 12.0 * random.random::<f64>();
                problem.push_edge(Edge {
                    detection,
                    squared_distance,
                    log_likelihood: 4.0 - squared_distance / 2.0,
                });
            }
        }
        problem.end_row(0.05f64.ln(), 0.0);
    }
    problem
}

fn bat(settings: BatSettings, seed: u32) -> Bat {
    Bat::new(settings, Seed { seed, run: 0 })
}

fn weights_of(associator: &mut dyn Associator, problem: &mut ScanProblem) -> Weights {
    let mut weights = Weights::default();
    weights.reset(problem);
    problem.for_each_cluster(|cluster| associator.associate(cluster, &mut weights));
    weights
}

/// Share of the searches that reach J*, share within 1 % of it, and mean gap, over random problems up to 4 × 6.
fn searched(objective: Objective) -> (f64, f64, f64) {
    let mut random = SEED.stream(Purpose::Clutter, 1, 0);
    let (mut reached, mut near, mut searched, mut gaps) = (0.0, 0.0, 0.0, 0.0);
    for _ in 0..200 {
        let (tracks, detections) = (random.random_range(2..=4), random.random_range(1..=6));
        let mut problem = random_problem(&mut random, tracks, detections, 0.8);
        for seed in 0..5 {
            let mut bat = bat(
                BatSettings {
                    objective,
                    ..BatSettings::default()
                },
                seed,
            );
            weights_of(&mut bat, &mut problem);
            let report = serde_json::to_value(bat.optimality.diagnostics(false)).unwrap();
            reached += report["optimum"]["reached"].as_f64().unwrap();
            searched += report["clusters"]["searched"].as_f64().unwrap();
            let gap = report["optimum"]["largest_gap"].as_f64();
            near += gap.map_or(0.0, |gap| {
                if gap <= 0.01 {
                    report["clusters"]["searched"].as_f64().unwrap()
                } else {
                    0.0
                }
            });
            gaps += gap.unwrap_or(0.0);
        }
    }
    assert!(searched > 900.0, "{searched} searches");
    (reached / searched, near / searched, gaps / searched)
}

#[test]
fn the_optimum_is_reached_on_small_problems() {
    for objective in [Objective::LikelihoodSum, Objective::LogLikelihoodRatio] {
        let (share, near, gap) = searched(objective);
        assert!(
            share >= 0.95,
            "{objective:?}: J* in {share} of the searches"
        );
        assert!(near >= 0.99, "{objective:?}: within 1 % in {near}");
        assert!(gap <= 0.001, "{objective:?}: a mean gap of {gap}");
    }
}

#[test]
fn where_the_ratio_reaches_its_optimum_it_is_the_global_nearest_neighbour() {
    let mut random = SEED.stream(Purpose::Clutter, 2, 0);
    let settings = BatSettings {
        objective: Objective::LogLikelihoodRatio,
        population: 50,
        iterations: 50,
        ..BatSettings::default()
    };
    for seed in 0..50 {
        let mut problem = random_problem(&mut random, 4, 5, 0.7);
        let found = chosen_by(&mut bat(settings, seed), &mut problem);
        assert_eq!(
            found,
            chosen_by(&mut GlobalNearestNeighbour::default(), &mut problem),
            "seed {seed}"
        );
    }
}

#[test]
fn a_search_repeats_and_another_seed_searches_otherwise() {
    let mut random = SEED.stream(Purpose::Clutter, 3, 0);
    let settings = BatSettings {
        population: 3,
        iterations: 2,
        trace: true,
        ..BatSettings::default()
    };
    let mut problem = random_problem(&mut random, 6, 9, 0.9);
    let mut traced = |seed| {
        let mut bat = bat(settings, seed);
        weights_of(&mut bat, &mut problem);
        bat.trace().map(|trace| trace.text().to_owned()).unwrap()
    };
    assert_eq!(traced(1), traced(1));
    assert_ne!(traced(1), traced(2));
    let text = traced(1);
    assert_eq!(
        text.lines().count(),
        1 + 3,
        "a header, the start and two iterations"
    );
    assert!(text.starts_with(TRACE_HEADER));
}

#[test]
fn the_visited_assignments_weigh_as_joint_events_do() {
    let mut random = SEED.stream(Purpose::Clutter, 4, 0);
    let jpda = ASSOCIATORS
        .iter()
        .find(|method| method.name == "jpda")
        .unwrap();
    let settings = BatSettings {
        weights: Answer::Visited,
        population: 60,
        iterations: 60,
        ..BatSettings::default()
    };
    for seed in 0..30 {
        let mut problem = random_problem(&mut random, 3, 3, 0.8);
        let mut exact = (jpda.build)(&serde_json::json!({"marginals": "enumerate"}), SEED).unwrap();
        let expected = weights_of(exact.as_mut(), &mut problem);
        let found = weights_of(&mut bat(settings, seed), &mut problem);
        for (found, expected) in found
            .edges
            .iter()
            .chain(&found.missed)
            .zip(expected.edges.iter().chain(&expected.missed))
        {
            assert!(
                (found - expected).abs() < 1e-12,
                "seed {seed}: {found} for {expected}"
            );
        }
    }
}

#[test]
fn a_swarm_that_sees_part_of_the_events_still_sums_to_one() {
    let mut random = SEED.stream(Purpose::Clutter, 5, 0);
    for objective in [Objective::LikelihoodSum, Objective::LogLikelihoodRatio] {
        let mut problem = random_problem(&mut random, 8, 12, 0.6);
        let settings = BatSettings {
            weights: Answer::Visited,
            objective,
            population: 5,
            iterations: 3,
            ..BatSettings::default()
        };
        let weights = weights_of(&mut bat(settings, 1), &mut problem);
        for (index, row) in problem.rows().iter().enumerate() {
            let total = weights.missed[index] + weights.edges[row.edges()].iter().sum::<f64>();
            assert!((total - 1.0).abs() < 1e-12, "{total}");
        }
    }
}

#[test]
fn free_candidates_never_leave_the_gate_in_the_answer() {
    let mut random = SEED.stream(Purpose::Clutter, 6, 0);
    for seed in 0..20 {
        let mut problem = random_problem(&mut random, 5, 8, 0.3);
        let settings = BatSettings {
            candidates: Candidates::All,
            ..BatSettings::default()
        };
        let chosen = chosen_by(&mut bat(settings, seed), &mut problem);
        let mut taken: Vec<u32> = chosen.iter().flatten().copied().collect();
        taken.sort_unstable();
        assert!(
            taken.windows(2).all(|pair| pair[0] != pair[1]),
            "{chosen:?}"
        );
        for (row, detection) in problem.rows().iter().zip(&chosen) {
            let is_gated = |detection: &u32| {
                problem.edges()[row.edges()]
                    .iter()
                    .any(|edge| edge.detection == *detection)
            };
            assert!(detection.as_ref().is_none_or(is_gated));
        }
    }
}

#[test]
fn a_lone_track_takes_the_most_likely() {
    let mut problem = ScanProblem::default();
    problem.begin(0, 3);
    for (detection, log_likelihood) in [(0, -4.0), (2, -3.5)] {
        problem.push_edge(Edge {
            detection,
            squared_distance: 1.0,
            log_likelihood,
        });
    }
    problem.end_row(0.05f64.ln(), 0.0);
    // ln 0.05 = −3.0 is more than both: the ratio leaves them alone, the sum never does.
    assert_eq!(
        chosen_by(&mut bat(BatSettings::default(), 1), &mut problem),
        [Some(2)]
    );
    let ratio = BatSettings {
        objective: Objective::LogLikelihoodRatio,
        ..BatSettings::default()
    };
    assert_eq!(chosen_by(&mut bat(ratio, 1), &mut problem), [None]);
}
