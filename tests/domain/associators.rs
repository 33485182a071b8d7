//! What every associator of the table owes, on random problems: weights that sum to 1, hard methods one-hot, detections
//! shared by hard methods never, and an answer that does not depend on the order of tracks or detections.

use proptest::prelude::*;
use serde_json::json;
use trackloom_domain::association::problem::{Edge, ScanProblem, Weights};
use trackloom_domain::association::{ASSOCIATORS, Associator, Needs};
use trackloom_domain::experiment;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::formats;
use trackloom_domain::math::rng::Seed;
use trackloom_domain::registry;

/// Methods that answer 0 or 1 and nothing between.
const HARD: [&str; 5] = [
    "nearest_neighbour",
    "strongest_neighbour",
    "global_nearest_neighbour",
    "fuzzy_c_means",
    "oracle",
];

/// A track: its candidates, P_D · P_G, the clutter expected in its gate, and where it expects a detection. Likelihoods are apart
/// from ties.
#[derive(Debug, Clone)]
struct Track {
    candidates: Vec<(usize, f64)>,
    found: f64,
    gate_clutter: f64,
    place: [f64; 2],
}

#[derive(Debug, Clone)]
struct Scene {
    tracks: Vec<Track>,
    /// Of each detection.
    amplitudes: Vec<f64>,
    places: Vec<[f64; 2]>,
}

/// Scenes of up to six tracks and six detections, the likelihood ratios from far below clutter to far above it.
fn scenes() -> impl Strategy<Value = Scene> {
    let track = |detections: usize| {
        let candidates = prop::collection::btree_map(0..detections, 0.0..12.0f64, 0..=detections);
        (candidates, 0.3..0.99f64, 0.01..5.0f64, place()).prop_map(
            |(candidates, found, gate_clutter, place)| Track {
                candidates: candidates.into_iter().collect(),
                found,
                gate_clutter,
                place,
            },
        )
    };
    (1..=6usize).prop_flat_map(move |detections| {
        let amplitudes = prop::collection::vec(0.0..100.0f64, detections);
        let places = prop::collection::vec(place(), detections);
        (
            prop::collection::vec(track(detections), 0..=6),
            amplitudes,
            places,
        )
            .prop_map(|(tracks, amplitudes, places)| Scene {
                tracks,
                amplitudes,
                places,
            })
    })
}

/// Metres and an angle.
fn place() -> impl Strategy<Value = [f64; 2]> {
    (-3.0..3.0f64, -3.1..3.1f64).prop_map(|(range, bearing)| [range, bearing])
}

/// Of what a track expects: S = [[2, 0.5], [0.5, 1]].
const INVERSE: [f64; 4] = [1.0 / 1.75, -0.5 / 1.75, -0.5 / 1.75, 2.0 / 1.75];

impl Scene {
    /// The tracks in another order, the detections under other numbers, the candidates listed in another order.
    fn permuted(&self, tracks: &[usize], detections: &[usize]) -> Scene {
        let (mut amplitudes, mut places) = (self.amplitudes.clone(), self.places.clone());
        for (old, &new) in detections.iter().enumerate() {
            (amplitudes[new], places[new]) = (self.amplitudes[old], self.places[old]);
        }
        let renumbered = |track: &Track| {
            let mut track = track.clone();
            track
                .candidates
                .iter_mut()
                .for_each(|candidate| candidate.0 = detections[candidate.0]);
            track.candidates.reverse();
            track
        };
        Scene {
            tracks: tracks
                .iter()
                .map(|&track| renumbered(&self.tracks[track]))
                .collect(),
            amplitudes,
            places,
        }
    }

    /// The weights of each track: for every detection of the scan, then of none.
    fn weighed(&self, associator: &mut dyn Associator) -> Vec<Vec<f64>> {
        let mut problem = ScanProblem::default();
        problem.begin(0, self.amplitudes.len());
        // One that is told origins gets the one right candidate at most.
        let limit = if associator.needs() == Needs::Origins {
            1
        } else {
            usize::MAX
        };
        problem.set_measurements(2, Some(1), self.places.iter().map(|place| &place[..]));
        for track in &self.tracks {
            for &(detection, squared_distance) in track.candidates.iter().take(limit) {
                let log_likelihood = 2.0 - squared_distance / 2.0;
                problem.push_edge(Edge {
                    detection: detection as u32,
                    squared_distance,
                    log_likelihood,
                });
            }
            problem.push_place(&track.place, &INVERSE);
            problem.end_row((1.0 - track.found).ln(), track.gate_clutter.ln());
        }
        problem.set_amplitudes(self.amplitudes.iter().copied());
        let mut weights = Weights::default();
        weights.reset(&problem);
        problem.for_each_cluster(|cluster| associator.associate(cluster, &mut weights));
        let spread = |(index, row): (usize, &trackloom_domain::association::problem::Row)| {
            let mut all = vec![0.0; self.amplitudes.len()];
            row.edges().for_each(|edge| {
                all[problem.edges()[edge].detection as usize] = weights.edges[edge]
            });
            all.push(weights.missed[index]);
            all
        };
        problem.rows().iter().enumerate().map(spread).collect()
    }
}

/// Every method with its defaults, PDA with the other clutter model, and fuzzy c-means with soft weights.
fn associators() -> Vec<(&'static str, Box<dyn Associator>)> {
    let build = |name: &'static str, body: serde_json::Value| {
        let method = ASSOCIATORS
            .iter()
            .find(|method| method.name == name)
            .unwrap();
        (
            name,
            (method.build)(
                &registry::check(&body, method.parameters).unwrap(),
                Seed { seed: 1, run: 0 },
            )
            .unwrap(),
        )
    };
    let mut all: Vec<_> = ASSOCIATORS
        .iter()
        .map(|method| build(method.name, json!({})))
        .collect();
    all.push(build("pda", json!({"clutter": "nonparametric"})));
    all.push((
        "fuzzy_c_means, weighted",
        build("fuzzy_c_means", json!({"weights": "weighted"})).1,
    ));
    all
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn weights_sum_to_one_and_hard_ones_are_zero_or_one(scene in scenes()) {
        for (name, mut associator) in associators() {
            for (track, weights) in scene.weighed(associator.as_mut()).into_iter().enumerate() {
                let sum: f64 = weights.iter().sum();
                prop_assert!((sum - 1.0).abs() < 1e-12, "{name}: the weights of track {track} sum to {sum}");
                prop_assert!(weights.iter().all(|weight| (0.0..=1.0).contains(weight)), "{name}: {weights:?}");
                let is_hard = weights.iter().all(|weight| *weight == 0.0 || *weight == 1.0);
                prop_assert!(is_hard || !HARD.contains(&name), "{name}: {weights:?}");
            }
        }
    }

    #[test]
    fn hard_methods_give_a_detection_to_one_track_at_most(scene in scenes()) {
        for (name, mut associator) in associators().into_iter().filter(|(name, _)| HARD.contains(name) && *name != "oracle") {
            let weights = scene.weighed(associator.as_mut());
            for detection in 0..scene.amplitudes.len() {
                let takers = weights.iter().filter(|weights| weights[detection] == 1.0).count();
                prop_assert!(takers <= 1, "{name}: detection {detection} goes to {takers} tracks");
            }
        }
    }

    #[test]
    fn permuting_tracks_or_detections_permutes_the_answer(
        (scene, tracks, detections) in scenes().prop_flat_map(|scene| {
            let tracks = Just((0..scene.tracks.len()).collect::<Vec<_>>()).prop_shuffle();
            let detections = Just((0..scene.amplitudes.len()).collect::<Vec<_>>()).prop_shuffle();
            (Just(scene), tracks, detections)
        }),
    ) {
        // A random search in another order is another search.
        let are_equivariant = |(name, _): &(&str, _)| !["oracle", "bat"].contains(name);
        for (name, mut associator) in associators().into_iter().filter(are_equivariant) {
            let plain = scene.weighed(associator.as_mut());
            let permuted = scene.permuted(&tracks, &detections).weighed(associator.as_mut());
            for (new, &old) in tracks.iter().enumerate() {
                for (detection, &before) in plain[old].iter().enumerate() {
                    let after = permuted[new][detections.get(detection).copied().unwrap_or(detection)];
                    prop_assert!((before - after).abs() < 1e-9, "{name}: track {old}, detection {detection}: {before} and {after}");
                }
            }
        }
    }

    #[test]
    fn the_global_choice_is_the_most_probable_of_all(scene in scenes()) {
        let method = ASSOCIATORS.iter().find(|method| method.name == "global_nearest_neighbour").unwrap();
        let mut associator = (method.build)(&json!({}), Seed { seed: 1, run: 0 }).unwrap();
        let weights = scene.weighed(associator.as_mut());
        let log_weight = |track: usize, detection: Option<usize>| match detection {
            None => (1.0 - scene.tracks[track].found).ln(),
            Some(wanted) => {
                let candidates = &scene.tracks[track].candidates;
                candidates.iter().find(|(detection, _)| *detection == wanted).map_or(f64::NEG_INFINITY, |(_, squared)| 2.0 - squared / 2.0)
            }
        };
        let taken = |weights: &[f64]| weights[..scene.amplitudes.len()].iter().position(|weight| *weight == 1.0);
        let chosen: f64 = weights.iter().enumerate().map(|(track, weights)| log_weight(track, taken(weights))).sum();
        let best = best_event(0, scene.tracks.len(), &mut vec![false; scene.amplitudes.len()], &log_weight);
        prop_assert!((chosen - best).abs() < 1e-9, "{chosen} instead of {best}");
    }
}

/// The job that tracks a CSV recording by strongest neighbour, run to its end.
fn strongest(csv: &str) -> Result<experiment::Outcome, experiment::RunError> {
    let body = json!({
        "input": {"source": "dataset", "dataset_id": "0198c0de-0000-7000-8000-000000000000"},
        "associator": {"method": "strongest_neighbour"},
        "tracker": {"confirm_hits": 1, "confirm_window": 1},
        "sensors": [{"sensor_id": "radar", "p_d": 0.9, "clutter_per_m2": 1e-6, "sigma_x_m": 1.0, "sigma_y_m": 1.0}]
    });
    let plan = experiment::plan(experiment::JobKind::Associate, &body).unwrap();
    let format = formats::FORMATS
        .iter()
        .find(|format| format.name == "csv")
        .unwrap();
    let dataset = (format.read)(&mut csv.as_bytes(), &Default::default())
        .unwrap()
        .dataset;
    experiment::run(
        &plan,
        vec![Some(experiment::Input {
            dataset,
            sensors: vec![],
            sha256: String::new(),
        })],
        &mut Silent,
    )
}

#[test]
fn the_strongest_is_read_from_the_recording_and_a_gap_is_a_fault() {
    let csv = "time_s,scan,sensor_id,detection_id,x_m,y_m,amplitude\n\
               0,1,radar,a,0,0,5\n1,2,radar,near,0.1,0,3\n1,2,radar,strong,2,0,9\n";
    let outcome = strongest(csv).unwrap();
    let tracks = outcome
        .artifacts
        .iter()
        .find(|artifact| artifact.name == "tracks.csv")
        .unwrap();
    let text = std::str::from_utf8(&tracks.bytes).unwrap();
    let column = text
        .lines()
        .next()
        .unwrap()
        .split(',')
        .position(|name| name == "detection_id")
        .unwrap();
    let rows: Vec<Vec<&str>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect())
        .collect();
    let of_first: Vec<&str> = rows
        .iter()
        .filter(|row| row[1] == "1")
        .map(|row| row[column])
        .collect();
    assert_eq!(of_first, ["a", "strong"]);

    let Err(experiment::RunError::Faults(faults)) = strongest(&csv.replace(",9", ",")) else {
        panic!("a gap was accepted")
    };
    assert_eq!(
        (faults[0].pointer.as_str(), faults[0].code.as_str()),
        ("/associator/method", "unsupported")
    );
    assert_eq!(
        faults[0].detail,
        "'strongest_neighbour' needs the amplitude of every detection; 1 of 3 lack it"
    );
}

/// The log-weight of the best joint event of the tracks from `track` on, by trying all.
fn best_event(
    track: usize,
    tracks: usize,
    used: &mut Vec<bool>,
    log_weight: &impl Fn(usize, Option<usize>) -> f64,
) -> f64 {
    if track == tracks {
        return 0.0;
    }
    let mut best = log_weight(track, None) + best_event(track + 1, tracks, used, log_weight);
    for detection in 0..used.len() {
        if !used[detection] {
            used[detection] = true;
            best = best.max(
                log_weight(track, Some(detection))
                    + best_event(track + 1, tracks, used, log_weight),
            );
            used[detection] = false;
        }
    }
    best
}
