//! Correlators against an integer programme: a variable for each tuple that exists, each track in one of them, solved by a
//! general solver that knows nothing of tracks.

use crate::random_tracks::Scene;
use microlp::{ComparisonOp, LinearExpr, OptimizationDirection};
use serde_json::json;
use trackloom_domain::correlation::problem::CorrelationProblem;
use trackloom_domain::correlation::{CORRELATORS, Solution};
use trackloom_domain::math::rng::Seed;
use trackloom_domain::registry;

/// Missing and false tracks, targets close to each other.
const SCENE: Scene = Scene {
    sensors: 4,
    targets: 6,
    spacing: 3.0,
    detection_probability: 0.8,
    false_share: 0.1,
};

/// More would take the solver long.
const MAX_TUPLES: usize = 800;

/// Every tuple of two tracks or more that exists and costs less than its tracks alone.
fn tuples(problem: &CorrelationProblem) -> Vec<(Vec<u32>, f64)> {
    fn grow(problem: &CorrelationProblem, tuple: &mut Vec<u32>, found: &mut Vec<(Vec<u32>, f64)>) {
        if let Some(cost) = problem
            .cost(tuple)
            .filter(|cost| tuple.len() > 1 && *cost < 0.0)
        {
            found.push((tuple.clone(), cost));
        }
        let last = tuple
            .last()
            .map_or(0, |&track| problem.of_sensor(problem.sensor_of(track)).end);
        for track in last..problem.tracks() as u32 {
            tuple.push(track);
            grow(problem, tuple, found);
            tuple.pop();
        }
    }
    let mut found = Vec::new();
    grow(problem, &mut Vec::new(), &mut found);
    found
}

/// The least J, of a problem that is not too large for the solver.
fn least_cost(problem: &CorrelationProblem) -> Option<f64> {
    let tuples = tuples(problem);
    if tuples.len() > MAX_TUPLES {
        return None;
    }
    let mut programme = microlp::Problem::new(OptimizationDirection::Minimize);
    let mut rows = vec![LinearExpr::empty(); problem.tracks()];
    for (tuple, cost) in &tuples {
        let variable = programme.add_binary_var(*cost);
        tuple
            .iter()
            .for_each(|&track| rows[track as usize].add(variable, 1.0));
    }
    rows.into_iter()
        .for_each(|row| programme.add_constraint(row, ComparisonOp::Le, 1.0));
    Some(
        programme
            .solve()
            .unwrap()
            .into_solution()
            .unwrap()
            .objective(),
    )
}

fn solved(method: &str, problem: &CorrelationProblem) -> Solution {
    let entry = CORRELATORS
        .iter()
        .find(|entry| entry.name == method)
        .unwrap();
    let parameters = registry::check(&json!({}), entry.parameters).unwrap();
    (entry.build)(&parameters, Seed { seed: 3, run: 0 })
        .unwrap()
        .correlate(problem)
        .unwrap()
}

#[test]
fn the_optimum_is_that_of_an_integer_programme() {
    let mut compared = [0; 3];
    for number in 0..200 {
        for (kind, problem) in [
            SCENE.chain(number),
            SCENE.all_pairs(number),
            SCENE.fused(number),
        ]
        .into_iter()
        .enumerate()
        {
            let Some(least) = least_cost(&problem) else {
                continue;
            };
            let exact = solved("exact", &problem);
            assert!(
                (exact.cost - least).abs() < 1e-6,
                "problem {number}, kind {kind}: {} for {least}",
                exact.cost
            );
            let relaxed = solved("lagrangian", &problem);
            assert!(
                relaxed.dual_bound.unwrap() <= least + 1e-6 && relaxed.cost >= least - 1e-6,
                "{relaxed:?} for {least}"
            );
            compared[kind] += 1;
        }
    }
    assert!(compared.iter().all(|&count| count >= 70), "{compared:?}");
}
