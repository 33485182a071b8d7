//! The clusters of a scene of 30 targets that fly close together, for `benches/peers/enumerate.py`: each line one cluster, for
//! each track its detections with the ratio of their weights to that of none.
//!
//! `cargo run --release -p trackloom-domain --example jpda_clusters -- "in line" | python3 benches/peers/enumerate.py`

#[path = "../benches/support/flights.rs"]
mod flights;

use serde_json::json;
use trackloom_domain::association::problem::{Problem, Weights};
use trackloom_domain::association::{ASSOCIATORS, Associator};
use trackloom_domain::math::rng::Seed;
use trackloom_domain::registry::check;

fn main() {
    let chosen = std::env::args()
        .nth(1)
        .unwrap_or_else(|| "in line".to_owned());
    for scene in flights::scenes()
        .iter()
        .filter(|scene| scene.name == chosen)
    {
        scene.tracked(Box::new(Telling(jpda())));
    }
}

fn jpda() -> Box<dyn Associator> {
    let jpda = ASSOCIATORS
        .iter()
        .find(|method| method.name == "jpda")
        .expect("jpda is in the table");
    let parameters = check(&json!({}), jpda.parameters).expect("every parameter has a default");
    (jpda.build)(&parameters, Seed { seed: 0, run: 0 }).expect("defaults build")
}

/// An associator that says what it is asked.
struct Telling(Box<dyn Associator>);

impl Associator for Telling {
    fn fork(&self) -> Box<dyn Associator> {
        unreachable!("nobody goes another way")
    }

    fn is_soft(&self) -> bool {
        self.0.is_soft()
    }

    fn associate(&mut self, problem: &Problem, weights: &mut Weights) {
        let tracks = problem.rows().map(|(_, row)| {
            let ratio = |edge: usize| (problem.edge(edge).log_likelihood - row.log_missed).exp();
            row.edges()
                .map(|edge| (problem.edge(edge).detection, ratio(edge)))
                .collect::<Vec<_>>()
        });
        println!("{}", json!(tracks.collect::<Vec<_>>()));
        self.0.associate(problem, weights);
    }
}
