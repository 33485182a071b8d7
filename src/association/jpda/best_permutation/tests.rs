//! JPDA* and NN-JPDA against worked numbers and brute force over all joint events.

use super::super::tests::{
    Tracks, by_brute_force, chain, every_event, largest_difference, marginals_of, problem_of,
    random_stream, random_tracks, settings, solve,
};
use super::super::*;
use rand::RngExt;
use std::collections::BTreeMap;

fn against(against_coalescence: AgainstCoalescence) -> Jpda {
    Jpda::new(JpdaSettings {
        against_coalescence,
        ..JpdaSettings::default()
    })
}

fn star() -> Jpda {
    against(AgainstCoalescence::BestPermutation)
}

/// Ratios 12 and 8 of the first track, 9 and 10 of the second; a miss weighs 0.1.
fn worked_example() -> Tracks {
    [[12.0f64, 8.0], [9.0, 10.0]]
        .into_iter()
        .map(|[first, second]| (vec![(0, first.ln()), (1, second.ln())], 0.1f64.ln()))
        .collect()
}

/// Detected tracks, and used detections.
type Used = (Vec<usize>, Vec<u32>);

/// Of the events with the same detected tracks and used detections the likeliest one.
fn star_by_brute_force(tracks: &Tracks) -> Vec<Vec<f64>> {
    let mut best: BTreeMap<Used, (Vec<usize>, f64)> = BTreeMap::new();
    for (choices, log_weight) in every_event(tracks) {
        let hits = || {
            choices.iter().enumerate().filter_map(|(track, &choice)| {
                tracks[track].0.get(choice).map(|&(hit, _)| (track, hit))
            })
        };
        let detected = hits().map(|(track, _)| track).collect();
        let mut used: Vec<u32> = hits().map(|(_, detection)| detection).collect();
        used.sort_unstable();
        let kept = best
            .entry((detected, used))
            .or_insert((choices.clone(), log_weight));
        if log_weight > kept.1 {
            *kept = (choices, log_weight);
        }
    }
    marginals_of(&best.into_values().collect::<Vec<_>>(), tracks)
}

#[test]
fn the_worked_example_has_its_numbers() {
    let jpda = [
        vec![0.6186514215711, 0.371599203716, 0.009749374712878],
        vec![0.3721096421826, 0.6176305446378, 0.01025981317952],
    ];
    let jpda_star = [
        vec![0.978129287386, 0.00645629892664, 0.01541441368735],
        vec![0.00726333629247, 0.9765152126543, 0.01622145105318],
    ];
    let nn_jpda = [vec![1.0, 0.0, 0.0], vec![0.0, 1.0, 0.0]];
    for (against_coalescence, expected) in [
        (AgainstCoalescence::None, jpda),
        (AgainstCoalescence::BestPermutation, jpda_star),
        (AgainstCoalescence::NearestNeighbour, nn_jpda),
    ] {
        let found = solve(&mut against(against_coalescence), &worked_example());
        assert!(
            largest_difference(&found, &expected) < 1e-12,
            "{against_coalescence:?}: {found:?}"
        );
    }
}

#[test]
fn best_permutations_equal_brute_force_on_ten_thousand_random_clusters() {
    let mut random = random_stream(11);
    let mut associator = star();
    for _ in 0..10_000 {
        let (tracks, detections) = (random.random_range(1..=6), random.random_range(1..=6));
        let (density, spread) = (random.random_range(0.2..1.0), random.random_range(0.1..8.0));
        let tracks = random_tracks(&mut random, tracks, detections, density, spread);
        let found = solve(&mut associator, &tracks);
        let difference = largest_difference(&found, &star_by_brute_force(&tracks));
        assert!(difference <= 1e-12, "{difference} {tracks:?}");
        for line in &found {
            assert!((line.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        }
    }
    let report = associator.diagnostics().unwrap();
    assert_eq!(report["best_permutation"]["left_to_jpda"], 0);
}

/// Few edges: clusters of many blocks, that hang in tracks and in detections.
#[test]
fn best_permutations_equal_brute_force_on_trees_of_blocks() {
    let mut random = random_stream(12);
    let mut associator = star();
    for round in 0..400 {
        let spread = if round % 2 == 0 { 4.0 } else { 300.0 };
        let tracks = random_tracks(&mut random, 7, 7, 0.25, spread);
        let found = solve(&mut associator, &tracks);
        let difference = largest_difference(&found, &star_by_brute_force(&tracks));
        assert!(difference <= 1e-12, "{difference} {tracks:?}");
    }
}

#[test]
fn best_permutations_of_extreme_weights_stay_right() {
    let mut random = random_stream(13);
    for _ in 0..500 {
        let tracks = random_tracks(&mut random, 5, 4, 0.8, 700.0);
        let found = solve(&mut star(), &tracks);
        let difference = largest_difference(&found, &star_by_brute_force(&tracks));
        assert!(difference <= 1e-11, "{difference} {tracks:?}");
    }
}

/// Without a cycle no two events have the same tracks and detections.
#[test]
fn a_chain_has_the_marginals_of_jpda() {
    let mut associator = star();
    let found = solve(&mut associator, &chain(30));
    let expected = solve(&mut Jpda::new(settings(Marginals::Exact)), &chain(30));
    assert!(largest_difference(&found, &expected) < 1e-12);
    let report = associator.diagnostics().unwrap();
    // A block of one edge has one event besides the empty one.
    assert_eq!(report["best_permutation"]["most_events"], 60);
}

#[test]
fn of_equal_permutations_the_first_stays() {
    let twins: Tracks = vec![(vec![(0, 2.0), (1, 2.0)], 0.0); 2];
    let found = solve(&mut star(), &twins);
    // Both detected: first with first, e⁴, and not second with first. One detected: e² each of four ways; none: 1.
    let total = 4f64.exp() + 4.0 * 2f64.exp() + 1.0;
    let expected = [
        vec![
            (4f64.exp() + 2f64.exp()) / total,
            2f64.exp() / total,
            (2.0 * 2f64.exp() + 1.0) / total,
        ],
        vec![
            2f64.exp() / total,
            (4f64.exp() + 2f64.exp()) / total,
            (2.0 * 2f64.exp() + 1.0) / total,
        ],
    ];
    assert!(largest_difference(&found, &expected) < 1e-14, "{found:?}");
}

/// Every pair of a square is a candidate, and no two permutations weigh the same.
fn full(size: u32) -> Tracks {
    let candidates = |track| {
        (0..size).map(move |detection| (detection, 3.0 * f64::from(track * size + detection).sin()))
    };
    (0..size)
        .map(|track| (candidates(track).collect(), 0.0))
        .collect()
}

#[test]
fn beyond_its_caps_a_cluster_is_left_to_jpda_and_counted() {
    // Σ C(5, k)² = 252 pairs of equally many of five tracks and of five detections; the empty one is not counted.
    for (max_states, kept, left, expected) in [
        (251, 251, 0, star_by_brute_force(&full(5))),
        (250, 0, 1, by_brute_force(&full(5))),
    ] {
        let mut associator = Jpda::new(JpdaSettings {
            max_states,
            against_coalescence: AgainstCoalescence::BestPermutation,
            ..settings(Marginals::Enumerate)
        });
        assert!(largest_difference(&solve(&mut associator, &full(5)), &expected) < 1e-12);
        let report = associator.diagnostics().unwrap();
        assert_eq!(
            report["best_permutation"],
            serde_json::json!({"clusters": 1 - left, "most_events": kept, "left_to_jpda": left})
        );
        assert_eq!(report["clusters"]["enumerate"], left);
    }
    let mut wide = star();
    solve(&mut wide, &full(21));
    assert_eq!(
        wide.diagnostics().unwrap()["best_permutation"]["left_to_jpda"],
        1
    );
}

#[test]
fn decisions_have_the_largest_product_of_probabilities() {
    let mut random = random_stream(14);
    let mut associator = against(AgainstCoalescence::NearestNeighbour);
    assert!(!associator.is_soft() && star().is_soft());
    for _ in 0..5000 {
        let (tracks, detections) = (random.random_range(1..=5), random.random_range(1..=5));
        let (density, spread) = (random.random_range(0.2..1.0), random.random_range(0.1..6.0));
        let tracks = random_tracks(&mut random, tracks, detections, density, spread);
        let beta = by_brute_force(&tracks);
        let gain = |choices: &[usize]| -> f64 {
            let chosen = choices.iter().zip(&beta);
            chosen.map(|(&choice, line)| line[choice].ln()).sum()
        };
        let best = every_event(&tracks)
            .iter()
            .map(|event| gain(&event.0))
            .fold(f64::NEG_INFINITY, f64::max);
        let found = solve(&mut associator, &tracks);
        let choices: Vec<usize> = found.iter().map(|line| only_one(line)).collect();
        assert!((gain(&choices) - best).abs() < 1e-9, "{tracks:?} {found:?}");
    }
}

/// The place of the one among zeros.
fn only_one(line: &[f64]) -> usize {
    let place = line.iter().position(|&weight| weight == 1.0).unwrap();
    let rest = line.iter().enumerate().filter(|&(other, _)| other != place);
    assert!(rest.map(|(_, &weight)| weight).all(|weight| weight == 0.0));
    place
}

/// A cluster's weights do not depend on those before it: not in a single bit.
#[test]
fn clusters_in_another_order_have_equal_bytes() {
    let mut random = random_stream(15);
    for against_coalescence in [
        AgainstCoalescence::BestPermutation,
        AgainstCoalescence::NearestNeighbour,
    ] {
        let clusters: Vec<Tracks> = (0..40)
            .map(|_| random_tracks(&mut random, 5, 5, 0.7, 5.0))
            .collect();
        let mut associator = against(against_coalescence);
        let mut solved = |cluster: &Tracks| solve(&mut associator, cluster);
        let forwards: Vec<_> = clusters.iter().map(&mut solved).collect();
        let mut backwards: Vec<_> = clusters.iter().rev().map(&mut solved).collect();
        backwards.reverse();
        assert_eq!(forwards, backwards);
        // All in one problem, each with detections of its own.
        let moved = |(number, cluster): (usize, &Tracks)| -> Tracks {
            let offset = 5 * number as u32;
            let moved = |&(detection, weight): &(u32, f64)| (detection + offset, weight);
            let track = |(candidates, missed): &(Vec<(u32, f64)>, f64)| {
                (candidates.iter().map(moved).collect(), *missed)
            };
            cluster.iter().map(track).collect()
        };
        let together: Tracks = clusters.iter().enumerate().flat_map(moved).collect();
        assert_eq!(solved(&together), forwards.concat());
    }
}

#[test]
fn renaming_tracks_and_detections_renames_the_answer() {
    let mut random = random_stream(16);
    for _ in 0..300 {
        let tracks = random_tracks(&mut random, 6, 6, 0.5, 4.0);
        let renamed: Tracks = tracks
            .iter()
            .rev()
            .map(|(candidates, missed)| {
                let renamed = candidates.iter().rev();
                let renamed = renamed.map(|&(detection, weight)| ((detection * 5 + 2) % 6, weight));
                (renamed.collect(), *missed)
            })
            .collect();
        let mut back = solve(&mut star(), &renamed);
        back.reverse();
        for line in &mut back {
            let missed = line.pop().unwrap();
            line.reverse();
            line.push(missed);
        }
        assert!(largest_difference(&solve(&mut star(), &tracks), &back) < 1e-12);
    }
}

#[test]
fn a_stopped_sum_ends_at_once() {
    let stop = || std::ops::ControlFlow::Break(());
    let watch = Watch::new(&stop);
    let mut problem = problem_of(&full(14));
    let mut weights = Weights::default();
    weights.reset(&problem);
    let mut associator = Jpda::new(JpdaSettings {
        max_states: 16_777_216,
        against_coalescence: AgainstCoalescence::BestPermutation,
        ..settings(Marginals::BeliefPropagation)
    });
    problem.for_each_cluster_until(&watch, |cluster| {
        associator.associate(cluster, &mut weights)
    });
    assert!(watch.is_stopped());
    assert_eq!(
        associator.diagnostics().unwrap()["best_permutation"]["clusters"],
        0
    );
}
