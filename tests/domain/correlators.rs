//! Correlators on random problems: the exact one against a sum over all divisions of the tracks, the genetic one against the
//! exact one, and every one against what all must keep.

use crate::random_tracks::Scene;
use serde_json::{Value, json};
use std::sync::Arc;
use trackloom_domain::correlation::estimates::Estimates;
use trackloom_domain::correlation::evidence::{Evidence, Times};
use trackloom_domain::correlation::problem::CorrelationProblem;
use trackloom_domain::correlation::{CORRELATORS, Solution};
use trackloom_domain::math::rng::Seed;
use trackloom_domain::registry;

fn solved(method: &str, parameters: Value, problem: &CorrelationProblem) -> Solution {
    let entry = CORRELATORS
        .iter()
        .find(|entry| entry.name == method)
        .unwrap();
    let parameters = registry::check(&parameters, entry.parameters).unwrap();
    let mut correlator = (entry.build)(&parameters, Seed { seed: 7, run: 0 }).unwrap();
    correlator.correlate(problem).unwrap()
}

/// The least cost over all ways to divide at most 16 tracks into tuples that exist.
fn least_cost(problem: &CorrelationProblem) -> f64 {
    let tracks = problem.tracks();
    let members = |set: usize| {
        (0..tracks as u32)
            .filter(|track| set >> track & 1 == 1)
            .collect::<Vec<u32>>()
    };
    let is_tuple = |tuple: &[u32]| {
        tuple
            .windows(2)
            .all(|pair| problem.sensor_of(pair[0]) < problem.sensor_of(pair[1]))
    };
    let cost_of = |set: usize| {
        Some(members(set))
            .filter(|tuple| is_tuple(tuple))
            .and_then(|tuple| problem.cost(&tuple))
    };
    let costs: Vec<Option<f64>> = (0..1 << tracks).map(cost_of).collect();
    let mut least = vec![0.0; 1 << tracks];
    for set in 1..1usize << tracks {
        // The lowest track goes with some part of the others.
        let (lowest, others) = (set & set.wrapping_neg(), set & (set - 1));
        let mut best = f64::INFINITY;
        let mut part = others;
        loop {
            if let Some(cost) = costs[lowest | part] {
                best = best.min(cost + least[others & !part]);
            }
            if part == 0 {
                break;
            }
            part = (part - 1) & others;
        }
        least[set] = best;
    }
    least[(1 << tracks) - 1]
}

/// Close targets, missing and false tracks.
const SMALL: Scene = Scene {
    sensors: 3,
    targets: 4,
    spacing: 2.0,
    detection_probability: 0.8,
    false_share: 0.2,
};

fn small_problems(number: u32) -> Vec<CorrelationProblem> {
    let problems = vec![
        SMALL.chain(number),
        SMALL.all_pairs(number),
        SMALL.fused(number),
    ];
    problems
        .into_iter()
        .filter(|problem| problem.tracks() <= 14)
        .collect()
}

fn check(problem: &CorrelationProblem, solution: &Solution) {
    let mut tracks: Vec<u32> = solution.tuples.iter().flatten().copied().collect();
    tracks.sort_unstable();
    assert_eq!(
        tracks,
        (0..problem.tracks() as u32).collect::<Vec<_>>(),
        "every track once"
    );
    let sum: f64 = solution
        .tuples
        .iter()
        .map(|tuple| problem.cost(tuple).expect("it exists"))
        .sum();
    assert!(
        (sum - solution.cost).abs() < 1e-9,
        "J is the sum of the tuples"
    );
}

#[test]
fn the_exact_answer_is_the_least_over_all_divisions() {
    let mut compared = 0;
    for number in 0..110 {
        for problem in small_problems(number) {
            let solution = solved("exact", json!({}), &problem);
            let least = least_cost(&problem);
            check(&problem, &solution);
            assert!(
                (solution.cost - least).abs() < 1e-9,
                "problem {number}: {} for {least}",
                solution.cost
            );
            assert!((solution.dual_bound.unwrap() - least).abs() < 1e-9);
            compared += 1;
        }
    }
    assert!(compared >= 200, "{compared}");
}

#[test]
fn no_correlator_undercuts_the_optimum_and_all_divide_the_tracks() {
    for number in 200..240 {
        for problem in small_problems(number) {
            let least = solved("exact", json!({}), &problem).cost;
            for entry in CORRELATORS {
                let solution = solved(entry.name, json!({}), &problem);
                check(&problem, &solution);
                assert!(
                    solution.cost >= least - 1e-9,
                    "{}: {} below {least}",
                    entry.name,
                    solution.cost
                );
                assert!(
                    solution
                        .dual_bound
                        .is_none_or(|bound| bound <= least + 1e-9),
                    "{}: {:?}",
                    entry.name,
                    solution.dual_bound
                );
            }
        }
    }
}

/// In how many of 1 000 problems of three sensors and ten targets, chain and all pairs, the genetic algorithm misses the optimum.
fn misses(spacing: f64) -> usize {
    let scene = Scene {
        sensors: 3,
        targets: 10,
        spacing,
        detection_probability: 0.9,
        false_share: 0.05,
    };
    let problems = (0..500).flat_map(|number| [scene.chain(number), scene.all_pairs(number)]);
    let is_missed = |problem: &CorrelationProblem| {
        solved("genetic", json!({}), problem).cost > solved("exact", json!({}), problem).cost + 1e-9
    };
    problems.filter(is_missed).count()
}

#[test]
fn the_genetic_algorithm_finds_the_optima_of_three_sensors_and_ten_targets() {
    // Six and three standard deviations apart.
    assert_eq!([6.0, 3.0].map(misses), [0, 0]);
}

#[test]
fn the_papers_variant_finds_most_optima_of_three_by_ten() {
    let scene = Scene {
        sensors: 3,
        targets: 10,
        spacing: 6.0,
        detection_probability: 1.0,
        false_share: 0.0,
    };
    let settings =
        json!({"variant": "paper", "population": 60, "generations": 300, "stop_after": 60});
    let gap = |number| {
        let problem = scene.chain(number);
        let (found, least) = (
            solved("genetic", settings.clone(), &problem),
            solved("exact", json!({}), &problem).cost,
        );
        check(&problem, &found);
        assert!(
            found
                .search
                .unwrap()
                .best
                .windows(2)
                .all(|pair| pair[1] <= pair[0]),
            "the elite lives on"
        );
        (found.cost - least) / least.abs()
    };
    let mean = (0..20).map(gap).sum::<f64>() / 20.0;
    assert!((0.0..0.5).contains(&mean), "a mean gap of {mean}");
}

/// Tracks that say nothing.
fn silent(counts: &[usize]) -> Evidence {
    let named = counts
        .iter()
        .map(|&count| (String::new(), vec![String::new(); count]))
        .collect();
    Evidence {
        estimates: Arc::new(Estimates::new(named, vec![0.0], false)),
        cross: None,
        times: Times::All,
        until: 1,
    }
}

#[test]
fn problems_without_links_tracks_or_rivals_have_answers() {
    use trackloom_domain::correlation::problem::Costs;
    for entry in CORRELATORS {
        for counts in [&[][..], &[0, 0], &[3], &[2, 0, 1]] {
            let problem =
                CorrelationProblem::new(counts, &[], Costs::AllPairs).with_evidence(silent(counts));
            let solution = solved(entry.name, json!({}), &problem);
            check(&problem, &solution);
            assert_eq!(
                (solution.cost, solution.tuples.len()),
                (0.0, problem.tracks()),
                "{} {counts:?}",
                entry.name
            );
        }
    }
}

#[test]
fn too_many_nodes_are_refused_with_the_size() {
    let scene = Scene {
        sensors: 6,
        targets: 12,
        spacing: 0.5,
        detection_probability: 1.0,
        false_share: 0.0,
    };
    let entry = CORRELATORS
        .iter()
        .find(|entry| entry.name == "exact")
        .unwrap();
    let exact = |may_be_unproven: bool| {
        let parameters = json!({"max_nodes": 1000, "may_be_unproven": may_be_unproven});
        let mut exact = (entry.build)(&parameters, Seed { seed: 1, run: 0 }).unwrap();
        exact.correlate(&scene.all_pairs(1))
    };
    let answer = exact(true).unwrap();
    check(&scene.all_pairs(1), &answer);
    assert!(answer.dual_bound.unwrap() < answer.cost - 1e-6);
    assert_eq!(answer.search.unwrap().stop, "evaluations");
    let fault = exact(false).unwrap_err().remove(0);
    assert_eq!((&*fault.pointer, &*fault.code), ("/max_nodes", "too_large"));
    assert!(fault.detail.contains("6 sensors"), "{}", fault.detail);
}
