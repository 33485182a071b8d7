//! Hand-worked memberships and weights, the hard choice, and what holds of every cluster.

use super::super::problem::tests::chosen_by;
use super::super::problem::{Edge, ScanProblem};
use super::*;
use proptest::prelude::*;
use std::f64::consts::PI;

const HARD: FuzzyAssociatorSettings = FuzzyAssociatorSettings {
    weights: Answer::Hard,
    fuzzifier: 2.0,
    tolerance: 1e-4,
    max_iterations: 100,
    trace: false,
};
const WEIGHTED: FuzzyAssociatorSettings = FuzzyAssociatorSettings {
    weights: Answer::Weighted,
    ..HARD
};

/// δ² of every track below.
const NOISE: f64 = 9.0;

/// Detections and tracks on a line, S = 1; each track has the detections within 4. A miss is as probable as d² = 9.
fn line(tracks: &[f64], detections: &[f64]) -> ScanProblem {
    around(tracks, detections, None)
}

fn around(tracks: &[f64], detections: &[f64], angle: Option<usize>) -> ScanProblem {
    let mut problem = ScanProblem::default();
    problem.begin(3, detections.len());
    let measured: Vec<[f64; 1]> = detections.iter().map(|&place| [place]).collect();
    problem.set_measurements(1, angle, measured.iter().map(|place| &place[..]));
    for &track in tracks {
        for (detection, &place) in detections.iter().enumerate() {
            let difference = if angle.is_some() {
                crate::model::angle::wrap(place - track)
            } else {
                place - track
            };
            if difference.abs() <= 4.0 {
                let squared_distance = difference * difference;
                let log_likelihood = 0.5 * (NOISE - squared_distance) + 0.1f64.ln();
                problem.push_edge(Edge {
                    detection: detection as u32,
                    squared_distance,
                    log_likelihood,
                });
            }
        }
        problem.push_place(&[track], &[1.0]);
        problem.end_row(0.1f64.ln(), 0.0);
    }
    problem
}

fn chosen(mut problem: ScanProblem) -> Vec<Option<u32>> {
    chosen_by(&mut FuzzyCMeans::new(HARD).unwrap(), &mut problem)
}

fn weighed(settings: FuzzyAssociatorSettings, problem: &mut ScanProblem) -> Weights {
    let mut means = FuzzyCMeans::new(settings).unwrap();
    let mut weights = Weights::default();
    weights.reset(problem);
    problem.for_each_cluster(|cluster| means.associate(cluster, &mut weights));
    weights
}

fn assert_close(found: &[f64], expected: &[f64]) {
    let close = found
        .iter()
        .zip(expected)
        .all(|(found, expected)| (found - expected).abs() < 1e-12);
    assert!(
        close && found.len() == expected.len(),
        "{found:?} is not {expected:?}"
    );
}

#[test]
fn a_lone_track_takes_its_nearest_detection() {
    assert_eq!(chosen(line(&[0.0], &[3.9])), [Some(0)]);
    assert_eq!(
        chosen(line(&[0.0, 50.0], &[3.0, -1.0, 2.0])),
        [Some(1), None]
    );
}

#[test]
fn a_track_alone_shares_its_detections_with_noise_by_hand() {
    // d² = 1 and 4, δ² = 9: 1/1 : 1/4 : 1/9 = 36 : 9 : 4.
    let weights = weighed(WEIGHTED, &mut line(&[0.0], &[1.0, -2.0]));
    assert_close(&weights.edges, &[36.0 / 49.0, 9.0 / 49.0]);
    assert_close(&weights.missed, &[4.0 / 49.0]);
    // q = 3: 1/1 : 1/2 : 1/3 = 6 : 3 : 2.
    let weights = weighed(
        FuzzyAssociatorSettings {
            fuzzifier: 3.0,
            ..WEIGHTED
        },
        &mut line(&[0.0], &[1.0, -2.0]),
    );
    assert_close(&weights.edges, &[6.0 / 11.0, 3.0 / 11.0]);
    // A detection exactly where it was expected is certain.
    let weights = weighed(WEIGHTED, &mut line(&[0.0], &[0.0, -2.0]));
    assert_eq!((weights.edges, weights.missed), (vec![1.0, 0.0], vec![0.0]));
}

/// The rows of a trace as (iteration, quantity, track, detection) and value.
fn traced(settings: FuzzyAssociatorSettings, problem: &mut ScanProblem) -> Vec<(String, f64)> {
    let mut means = FuzzyCMeans::new(FuzzyAssociatorSettings {
        trace: true,
        ..settings
    })
    .unwrap();
    let mut weights = Weights::default();
    weights.reset(problem);
    problem.for_each_cluster(|cluster| means.associate(cluster, &mut weights));
    let text = means.trace().unwrap().text().to_owned();
    let row = |line: &str| {
        line.rsplit_once(',')
            .map(|(name, value)| (name.to_owned(), value.parse().unwrap()))
            .unwrap()
    };
    text.lines().skip(1).map(row).collect()
}

#[test]
fn two_tracks_and_noise_by_hand() {
    // Tracks at 0 and 4, detections at 1 and 3, all pairs gated. Detection 0: d² = 1, 9, δ² = 9: 1 : 1/9 : 1/9 = 9 : 1 : 1 of 11.
    // By symmetry J = 2 · (81·1 + 1·9 + 1·9) / 121 = 198/121. v₁ = (81·1 + 1·3) / 82 = 84/82.
    let rows = traced(
        FuzzyAssociatorSettings {
            max_iterations: 1,
            ..HARD
        },
        &mut line(&[0.0, 4.0], &[1.0, 3.0]),
    );
    let value = |name: &str| {
        rows.iter()
            .find(|(found, _)| found == name)
            .unwrap_or_else(|| panic!("no {name}"))
            .1
    };
    let found = [
        "3,0,0,J,,",
        "3,0,0,u,0,0",
        "3,0,0,u,1,0",
        "3,0,0,u,,0",
        "3,0,0,u,0,1",
        "3,0,0,v1,1,",
        "3,0,1,v1,0,",
    ]
    .map(value);
    assert_close(
        &found,
        &[
            198.0 / 121.0,
            9.0 / 11.0,
            1.0 / 11.0,
            1.0 / 11.0,
            1.0 / 11.0,
            4.0,
            84.0 / 82.0,
        ],
    );
    assert_eq!(chosen(line(&[0.0, 4.0], &[1.0, 3.0])), [Some(0), Some(1)]);
}

#[test]
fn two_tracks_that_want_one_detection_share_it_and_the_prediction_decides() {
    // Both centres move onto the one detection: u = ½ each. Then o = 1 each: β = ½, none ½; hard, the nearer prediction has it.
    let scene = || line(&[0.0, 4.0], &[2.5]);
    let weights = weighed(WEIGHTED, &mut scene());
    assert_close(&weights.edges, &[0.5, 0.5]);
    assert_close(&weights.missed, &[0.5, 0.5]);
    assert_eq!(chosen(scene()), [None, Some(0)]);
    assert_eq!(chosen(line(&[0.0, 4.0], &[1.5])), [Some(0), None]);
}

#[test]
fn bearings_are_averaged_across_the_end_of_the_turn() {
    // Around ±π the same as on the line; tracks at π − 0.2 and −π + 0.2, that is 0.4 apart.
    let tracks = [PI - 0.2, -PI + 0.2];
    let detections = [PI - 0.15, -PI + 0.15];
    assert_eq!(
        chosen(around(&tracks, &detections, Some(0))),
        [Some(0), Some(1)]
    );
    let shifted = weighed(WEIGHTED, &mut around(&[-0.2, 0.2], &[-0.15, 0.15], None));
    assert!(shifted.missed.iter().all(|missed| *missed < 0.1));
    let wrapped = weighed(WEIGHTED, &mut around(&tracks, &detections, Some(0)));
    assert!(
        wrapped
            .edges
            .iter()
            .zip(&shifted.edges)
            .all(|(left, right)| (left - right).abs() < 1e-9),
        "{wrapped:?} {shifted:?}"
    );
}

#[test]
fn diagnostics_count_clusters_and_iterations() {
    let mut means = FuzzyCMeans::new(FuzzyAssociatorSettings {
        max_iterations: 1,
        ..HARD
    })
    .unwrap();
    let mut problem = line(&[0.0, 3.0, 90.0], &[1.0, 2.0, 91.0]);
    let mut weights = Weights::default();
    weights.reset(&problem);
    problem.for_each_cluster(|cluster| means.associate(cluster, &mut weights));
    let said = means.diagnostics().unwrap();
    let expected = serde_json::json!({"lone_tracks": 1, "clusters": 1, "iterations": {"mean": 1.0, "max": 1}, "not_converged": 1});
    assert_eq!(said, expected);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn no_detection_counts_more_than_once_and_the_cost_never_rises(
        tracks in prop::collection::vec(0.0..12.0f64, 1..6),
        detections in prop::collection::vec(0.0..12.0f64, 1..8),
        fuzzifier in prop::sample::select(vec![1.5, 2.0, 3.0]),
    ) {
        let mut problem = line(&tracks, &detections);
        let settings = FuzzyAssociatorSettings { fuzzifier, ..WEIGHTED };
        let weights = weighed(settings, &mut problem);
        let mut counted = vec![0.0; detections.len()];
        problem.edges().iter().zip(&weights.edges).for_each(|(edge, weight)| counted[edge.detection as usize] += weight);
        prop_assert!(counted.iter().all(|counted| *counted <= 1.0 + 1e-9), "{counted:?}");
        let costs: Vec<(String, f64)> = traced(settings, &mut problem).into_iter().filter(|(name, _)| name.contains(",J,")).collect();
        for pair in costs.windows(2).filter(|pair| !pair[1].0.contains(",0,J")) {
            prop_assert!(pair[1].1 <= pair[0].1 * (1.0 + 1e-12) + 1e-9, "{pair:?}");
        }
    }
}
