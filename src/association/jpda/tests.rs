//! Marginals against a hand-worked example, plain enumeration written anew, and each other.

use super::*;
use crate::association::problem::{Edge, ScanProblem};
use crate::math::rng::{Purpose, Seed};
use rand::{Rng, RngExt};

/// Detections with log-likelihoods, and the logarithm of none, of each track.
pub(super) type Tracks = Vec<(Vec<(u32, f64)>, f64)>;

pub(super) fn problem_of(tracks: &Tracks) -> ScanProblem {
    let mut problem = ScanProblem::default();
    let detections = tracks
        .iter()
        .flat_map(|(candidates, _)| candidates)
        .map(|&(detection, _)| detection as usize + 1)
        .max();
    problem.begin(0, detections.unwrap_or(0));
    for (candidates, log_missed) in tracks {
        for &(detection, log_likelihood) in candidates {
            problem.push_edge(Edge {
                detection,
                squared_distance: 0.0,
                log_likelihood,
            });
        }
        problem.end_row(*log_missed, 0.0);
    }
    problem
}

pub(super) fn settings(marginals: Marginals) -> JpdaSettings {
    JpdaSettings {
        marginals,
        ..JpdaSettings::default()
    }
}

/// β of each track: its edges in order, then none.
pub(super) fn solve(associator: &mut Jpda, tracks: &Tracks) -> Vec<Vec<f64>> {
    let mut problem = problem_of(tracks);
    let mut weights = Weights::default();
    weights.reset(&problem);
    problem.for_each_cluster(|cluster| associator.associate(cluster, &mut weights));
    let line = |(index, row): (usize, &crate::association::problem::Row)| {
        row.edges()
            .map(|edge| weights.edges[edge])
            .chain([weights.missed[index]])
            .collect()
    };
    problem.rows().iter().enumerate().map(line).collect()
}

fn solved(marginals: Marginals, tracks: &Tracks) -> Vec<Vec<f64>> {
    solve(&mut Jpda::new(settings(marginals)), tracks)
}

/// Every joint event as a list of choices, its weight in logarithms; nothing of the shipped code.
pub(super) fn every_event(tracks: &Tracks) -> Vec<(Vec<usize>, f64)> {
    let mut events: Vec<(Vec<usize>, f64)> = vec![(Vec::new(), 0.0)];
    for (candidates, log_missed) in tracks {
        let mut longer = Vec::new();
        for (choices, log_weight) in &events {
            let taken: Vec<u32> = choices
                .iter()
                .zip(tracks)
                .filter_map(|(&choice, track)| track.0.get(choice).map(|edge| edge.0))
                .collect();
            for choice in 0..=candidates.len() {
                let (is_free, log_choice) = match candidates.get(choice) {
                    Some(&(detection, log_likelihood)) => {
                        (!taken.contains(&detection), log_likelihood)
                    }
                    None => (true, *log_missed),
                };
                if is_free {
                    longer.push((
                        choices.iter().copied().chain([choice]).collect(),
                        log_weight + log_choice,
                    ));
                }
            }
        }
        events = longer;
    }
    events
}

pub(super) fn by_brute_force(tracks: &Tracks) -> Vec<Vec<f64>> {
    marginals_of(&every_event(tracks), tracks)
}

/// β of each track over some joint events.
pub(super) fn marginals_of(events: &[(Vec<usize>, f64)], tracks: &Tracks) -> Vec<Vec<f64>> {
    let top = events
        .iter()
        .map(|event| event.1)
        .fold(f64::NEG_INFINITY, f64::max);
    let mut sums: Vec<Vec<f64>> = tracks
        .iter()
        .map(|(candidates, _)| vec![0.0; candidates.len() + 1])
        .collect();
    for (choices, log_weight) in events {
        choices
            .iter()
            .enumerate()
            .for_each(|(track, &choice)| sums[track][choice] += (log_weight - top).exp());
    }
    let total: f64 = events.iter().map(|event| (event.1 - top).exp()).sum();
    sums.into_iter()
        .map(|line| line.into_iter().map(|sum| sum / total).collect())
        .collect()
}

pub(super) fn random_tracks(
    random: &mut impl Rng,
    tracks: u32,
    detections: u32,
    density: f64,
    spread: f64,
) -> Tracks {
    let mut track = || {
        let wanted: Vec<u32> = (0..detections)
            .filter(|_| random.random_bool(density))
            .collect();
        let candidates = wanted
            .into_iter()
            .map(|detection| (detection, random.random_range(-spread..spread)))
            .collect();
        (candidates, random.random_range(-spread..spread))
    };
    (0..tracks).map(|_| track()).collect()
}

pub(super) fn random_stream(number: u64) -> impl Rng {
    Seed { seed: 1, run: 0 }.stream(Purpose::Clutter, number, 0)
}

pub(super) fn largest_difference(left: &[Vec<f64>], right: &[Vec<f64>]) -> f64 {
    let pairs = left.iter().flatten().zip(right.iter().flatten());
    pairs
        .map(|(left, right)| (left - right).abs())
        .fold(
            0.0,
            |largest, next| if next <= largest { largest } else { next },
        )
}

#[test]
fn two_tracks_and_two_detections_by_hand() {
    // Track A: detection 0 weighs 4, detection 1 weighs 1, none 1. Track B: detection 0 weighs 2, detection 1 weighs 3, none 0.5.
    //   A none · B none 0.5   A none · B 0  2   A none · B 1  3
    //   A 0    · B none 2     (A 0 · B 0 no)    A 0    · B 1 12
    //   A 1    · B none 0.5   A 1    · B 0  2   (A 1 · B 1 no)
    // Sum 22. A has 0: 14, 1: 2.5, none: 5.5. B has 0: 4, 1: 15, none: 3.
    let tracks: Tracks = vec![
        (vec![(0, 4f64.ln()), (1, 0.0)], 0.0),
        (vec![(0, 2f64.ln()), (1, 3f64.ln())], 0.5f64.ln()),
    ];
    let expected = vec![
        vec![14.0 / 22.0, 2.5 / 22.0, 5.5 / 22.0],
        vec![4.0 / 22.0, 15.0 / 22.0, 3.0 / 22.0],
    ];
    for marginals in [Marginals::Auto, Marginals::Exact, Marginals::Enumerate] {
        assert!(
            largest_difference(&solved(marginals, &tracks), &expected) < 1e-15,
            "{marginals:?}"
        );
    }
    assert!(largest_difference(&by_brute_force(&tracks), &expected) < 1e-15);
    // Belief propagation is close, not equal: the two tracks and two detections are a cycle.
    let error = largest_difference(&solved(Marginals::BeliefPropagation, &tracks), &expected);
    assert!(error > 1e-3 && error < 0.1, "{error}");
}

#[test]
fn a_single_track_is_weighed_in_closed_form() {
    let tracks: Tracks = vec![(vec![(3, 2f64.ln()), (1, 0.0)], 5f64.ln())];
    assert!(
        largest_difference(
            &solved(Marginals::Auto, &tracks),
            &[vec![2.0 / 8.0, 1.0 / 8.0, 5.0 / 8.0]]
        ) < 1e-15
    );
}

#[test]
fn marginals_equal_brute_force_on_ten_thousand_random_clusters() {
    let mut associators = [Marginals::Auto, Marginals::Exact, Marginals::Enumerate]
        .map(|marginals| Jpda::new(settings(marginals)));
    let mut random = random_stream(1);
    let mut worst = 0.0f64;
    for _ in 0..10_000 {
        let (tracks, detections) = (random.random_range(1..=6), random.random_range(1..=6));
        let (density, spread) = (random.random_range(0.2..1.0), random.random_range(0.1..8.0));
        let tracks = random_tracks(&mut random, tracks, detections, density, spread);
        let expected = by_brute_force(&tracks);
        for associator in &mut associators {
            let found = solve(associator, &tracks);
            worst = worst.max(largest_difference(&found, &expected));
            assert!(worst <= 1e-12, "{:?} {tracks:?}", associator.settings);
            assert!(
                found
                    .iter()
                    .all(|line| (line.iter().sum::<f64>() - 1.0).abs() < 1e-14)
            );
        }
    }
}

#[test]
fn exact_equals_enumerate_on_larger_clusters() {
    let mut random = random_stream(2);
    let mut exact = Jpda::new(settings(Marginals::Exact));
    let mut enumerate = Jpda::new(JpdaSettings {
        max_events: 100_000_000,
        ..settings(Marginals::Enumerate)
    });
    for (tracks, detections, density) in [
        (8, 7, 0.6),
        (7, 9, 0.8),
        (12, 12, 0.2),
        (20, 20, 0.08),
        (3, 30, 0.9),
        (14, 4, 0.9),
    ] {
        for _ in 0..5 {
            let tracks = random_tracks(&mut random, tracks, detections, density, 6.0);
            let difference =
                largest_difference(&solve(&mut exact, &tracks), &solve(&mut enumerate, &tracks));
            // Millions of terms one by one: the list itself is not better than this.
            assert!(difference <= 1e-11, "{difference} {tracks:?}");
        }
    }
    assert_eq!(
        (
            exact.diagnostics.caps().exact,
            enumerate.diagnostics.caps().enumerate
        ),
        (0, 0)
    );
}

#[test]
fn permuting_tracks_and_detections_permutes_the_answer() {
    let mut random = random_stream(3);
    for marginals in [
        Marginals::Exact,
        Marginals::Enumerate,
        Marginals::BeliefPropagation,
    ] {
        for _ in 0..200 {
            let tracks = random_tracks(&mut random, 6, 6, 0.6, 4.0);
            let renamed = |detection: u32| (detection * 5 + 2) % 6;
            let permuted: Tracks = tracks
                .iter()
                .rev()
                .map(|(candidates, missed)| {
                    (
                        candidates
                            .iter()
                            .rev()
                            .map(|&(detection, weight)| (renamed(detection), weight))
                            .collect(),
                        *missed,
                    )
                })
                .collect();
            let mut back = solved(marginals, &permuted);
            back.reverse();
            for line in &mut back {
                let missed = line.pop().unwrap();
                line.reverse();
                line.push(missed);
            }
            assert!(
                largest_difference(&solved(marginals, &tracks), &back) < 1e-8,
                "{marginals:?} {tracks:?}"
            );
        }
    }
}

#[test]
fn extreme_weights_stay_right() {
    let mut random = random_stream(4);
    for marginals in [Marginals::Auto, Marginals::Exact, Marginals::Enumerate] {
        for _ in 0..500 {
            let tracks = random_tracks(&mut random, 5, 4, 0.8, 700.0);
            let difference =
                largest_difference(&solved(marginals, &tracks), &by_brute_force(&tracks));
            assert!(difference <= 1e-11, "{marginals:?} {difference} {tracks:?}");
        }
    }
    // Four tracks that all but must have a detection, and three of those: every event is far beyond the range of f64.
    let tracks: Tracks = (0..4)
        .map(|_| ((0..3).map(|detection| (detection, 700.0)).collect(), -700.0))
        .collect();
    let expected = vec![vec![0.25; 4]; 4];
    for marginals in [Marginals::Auto, Marginals::Exact, Marginals::Enumerate] {
        assert!(
            largest_difference(&solved(marginals, &tracks), &expected) < 1e-12,
            "{marginals:?}"
        );
    }
}

#[test]
fn belief_propagation_stays_finite_with_extreme_weights() {
    let mut random = random_stream(5);
    for _ in 0..200 {
        for line in solved(
            Marginals::BeliefPropagation,
            &random_tracks(&mut random, 6, 4, 0.8, 700.0),
        ) {
            assert!(
                line.iter().all(|beta| (0.0..=1.0).contains(beta))
                    && (line.iter().sum::<f64>() - 1.0).abs() < 1e-12,
                "{line:?}"
            );
        }
    }
}

/// Track i wants detections i and i + 1.
pub(super) fn chain(tracks: u32) -> Tracks {
    (0..tracks)
        .map(|track| {
            (
                vec![
                    (track, f64::from(track % 5)),
                    (track + 1, f64::from(track % 3)),
                ],
                -1.0,
            )
        })
        .collect()
}

#[test]
fn a_chain_of_thirty_tracks_needs_a_frontier_of_two() {
    let mut exact = Jpda::new(settings(Marginals::Auto));
    let found = solve(&mut exact, &chain(30));
    let report = exact.diagnostics().unwrap();
    assert_eq!(
        (&report["clusters"]["exact"], &report["largest_frontier"]),
        (&1.into(), &2.into())
    );
    // A chain has no cycle, so belief propagation must agree.
    assert!(largest_difference(&found, &solved(Marginals::BeliefPropagation, &chain(30))) < 1e-9);
    assert!(
        largest_difference(
            &solved(Marginals::Exact, &chain(8)),
            &by_brute_force(&chain(8))
        ) < 1e-12
    );
}

#[test]
fn beyond_the_caps_the_diagnostics_say_what_was_done_instead() {
    let tracks: Tracks = (0..5)
        .map(|track| {
            (
                (0..5)
                    .map(|detection| (detection, f64::from(detection * track % 4)))
                    .collect(),
                0.0,
            )
        })
        .collect();
    // 5 × 5 full: Σ C(5,k)² k! = 1546 events.
    let mut capped = Jpda::new(JpdaSettings {
        max_events: 1545,
        ..settings(Marginals::Enumerate)
    });
    assert!(largest_difference(&solve(&mut capped, &tracks), &by_brute_force(&tracks)) < 1e-12);
    let report = capped.diagnostics().unwrap();
    assert_eq!(
        (
            &report["caps"]["enumerate"],
            &report["clusters"]["exact"],
            &report["clusters"]["enumerate"]
        ),
        (&1.into(), &1.into(), &0.into())
    );
    let mut enough = Jpda::new(JpdaSettings {
        max_events: 1546,
        ..settings(Marginals::Enumerate)
    });
    solve(&mut enough, &tracks);
    assert_eq!(enough.diagnostics().unwrap()["clusters"]["enumerate"], 1);
    let mut narrow = Jpda::new(JpdaSettings {
        max_states: 16,
        ..settings(Marginals::Exact)
    });
    solve(&mut narrow, &tracks);
    let report = narrow.diagnostics().unwrap();
    assert_eq!(
        (
            &report["caps"]["exact"],
            &report["approximation"]["clusters"]
        ),
        (&1.into(), &1.into())
    );
    assert_eq!(
        report["approximation"]["largest_cluster"],
        serde_json::json!({"tracks": 5, "detections": 5, "edges": 25})
    );
    assert_eq!(report["approximation"]["not_converged"], 0);
}

#[test]
fn the_defaults_of_the_table_are_those_of_the_type() {
    let checked = crate::registry::check(&serde_json::json!({}), &PARAMETERS).unwrap();
    assert_eq!(
        JpdaSettings::deserialize(&checked).unwrap(),
        JpdaSettings::default()
    );
}
