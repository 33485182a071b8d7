//! The life of tracks: how they begin, when they are believed, and when they end.

use rand::RngExt;
use rand_distr::{Distribution, Poisson, StandardNormal};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use trackloom_domain::association::ASSOCIATORS;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, JobKind, plan, presets};
use trackloom_domain::filtering::AnyFilter;
use trackloom_domain::formats;
use trackloom_domain::math::rng::{Purpose, Seed};
use trackloom_domain::model::scan::{Detection, Measurement, Recording, RecordingParts, Scan};
use trackloom_domain::model::sensing::MeasurementModel;
use trackloom_domain::model::sensor::{Sensor, SensorSettings};
use trackloom_domain::model::state::Covariance;
use trackloom_domain::model::track::{TrackPoint, TrackSet};
use trackloom_domain::model::watch::Watch;
use trackloom_domain::registry;
use trackloom_domain::tracking::{
    Confirmation, History, Initiation, Lifecycle, ScanOutcome, ScoreRule, TRACKERS, TrackerParts,
};

const LIFE: Lifecycle = Lifecycle {
    gate_probability: 0.99,
    initiation: Initiation::OnePoint,
    confirmation: Confirmation::MOfN,
    confirm_hits: 2,
    confirm_window: 3,
    max_missed: 4,
    max_missed_s: None,
    max_position_sigma_m: None,
    initial_speed_sigma_mps: 10.0,
    smoothing: None,
    merging: None,
};

fn score(false_track_probability: f64) -> Confirmation {
    Confirmation::Score(ScoreRule {
        false_track_probability,
        missed_track_probability: 0.05,
        max_score_drop: 10.0,
    })
}

/// A radar of 10 m noise that scans every second; one list of places a scan.
fn recording(scans: &[Vec<[f64; 2]>]) -> Recording {
    let mut parts = RecordingParts {
        sensors: vec![SensorSettings::named("radar")],
        ..Default::default()
    };
    for (index, places) in scans.iter().enumerate() {
        let detection = |&[x_m, y_m]: &[f64; 2]| Detection {
            measurement: Measurement::Position { x_m, y_m },
            origin: None,
            amplitude: None,
        };
        parts.scans.push(Scan {
            number: index as u32 + 1,
            time_s: index as f64,
            sensor: 0,
            pose: None,
            own: Vec::new(),
            detections: places.iter().map(detection).collect(),
        });
        let ids = (1..=places.len()).map(|nth| format!("{}-{nth}", index + 1));
        parts.detection_ids.extend(ids);
    }
    Recording::new(parts).unwrap()
}

fn tracked(
    recording: &Recording,
    method: &str,
    lifecycle: Lifecycle,
    clutter_density: f64,
) -> (Vec<ScanOutcome>, TrackSet) {
    let entry = ASSOCIATORS
        .iter()
        .find(|entry| entry.name == method)
        .unwrap();
    let associator = (entry.build)(
        &registry::check(&json!({}), entry.parameters).unwrap(),
        Seed { seed: 1, run: 0 },
    )
    .unwrap();
    let report = MeasurementModel::Position {
        sigma_x_m: 10.0,
        sigma_y_m: 10.0,
    };
    let sensors = vec![Sensor {
        sensor_id: "radar".into(),
        p_d: 0.9,
        clutter_density,
        may_start: true,
        report,
        sight: None,
    }];
    let mut tracker = (TRACKERS[0].build)(TrackerParts {
        filter: AnyFilter::kalman(1.0),
        associator,
        lifecycle,
        sensors,
        undetected: None,
        given: Vec::new(),
    });
    let mut history = History::default();
    let mut step = |scan: &Scan| tracker.step(scan, &mut history, &Watch::never());
    let outcomes = recording.scans.iter().map(|scan| step(scan).unwrap());
    let outcomes = outcomes.collect();
    (outcomes, history.into_tracks(recording))
}

/// Poisson clutter of 1e-4 per m² in a square kilometre, 300 scans: about one detection in the gate of a young track.
fn pure_clutter(seed: u32) -> Recording {
    let mut draw = Seed { seed, run: 0 }.stream(Purpose::Clutter, 0, 0);
    let count = Poisson::new(100.0).unwrap();
    let mut scan = |_| {
        let count = count.sample(&mut draw) as usize;
        (0..count)
            .map(|_| {
                [
                    draw.random_range(0.0..1000.0),
                    draw.random_range(0.0..1000.0),
                ]
            })
            .collect()
    };
    let scans: Vec<Vec<[f64; 2]>> = (0..300).map(&mut scan).collect();
    recording(&scans)
}

/// Tracks started, detections unused, tracks confirmed.
fn counts(
    recording: &Recording,
    method: &str,
    lifecycle: Lifecycle,
    clutter_density: f64,
) -> [f64; 3] {
    let (outcomes, tracks) = tracked(recording, method, lifecycle, clutter_density);
    let sum = |number: fn(&ScanOutcome) -> u32| {
        outcomes
            .iter()
            .map(|outcome| f64::from(number(outcome)))
            .sum()
    };
    [
        sum(|outcome| outcome.started),
        sum(|outcome| outcome.unused),
        tracks.tracks.len() as f64,
    ]
}

#[test]
fn scores_confirm_no_more_false_tracks_than_they_may() {
    // Λ has the mean 1 over Poisson clutter when all candidates are summed, and less when one is chosen: so a share of
    // α / (1 − β) at most passes the threshold. Steps over it and rivals for the same clutter make it fewer.
    for alpha in [0.1, 0.02] {
        let mut sums = [0.0; 3];
        for seed in 1..=5 {
            let lifecycle = Lifecycle {
                confirmation: score(alpha),
                ..LIFE
            };
            let found = counts(
                &pure_clutter(seed),
                "global_nearest_neighbour",
                lifecycle,
                1e-4,
            );
            sums.iter_mut()
                .zip(found)
                .for_each(|(sum, count)| *sum += count);
        }
        let [started, unused, confirmed] = sums;
        assert!(
            started == unused && started > 50_000.0,
            "{started} tracks started by {unused} detections"
        );
        let share = confirmed / started;
        println!("α = {alpha}: {confirmed} of {started} = {share:.5}");
        assert!(
            share <= alpha / 0.95 && share >= alpha / 20.0,
            "α = {alpha}: {confirmed} of {started} are confirmed"
        );
    }
}

#[test]
fn pairs_of_clutter_are_confirmed_no_more_than_they_may() {
    // Here α counts for the first points: every unused detection is one, or the second of a pair.
    let lifecycle = Lifecycle {
        initiation: Initiation::TwoPoint {
            max_speed_mps: 20.0,
            max_wait_scans: 1,
        },
        confirmation: score(0.1),
        ..LIFE
    };
    let [started, unused, confirmed] = counts(
        &pure_clutter(1),
        "global_nearest_neighbour",
        lifecycle,
        1e-4,
    );
    println!("{confirmed} of {started} pairs and {unused} unused detections");
    assert!(
        2.0 * started < unused && confirmed > 10.0 && confirmed <= 0.1 / 0.95 * (unused - started)
    );
}

#[test]
fn scores_drop_no_more_true_tracks_than_they_may() {
    // 900 targets 2 km apart, found with P_D = 0.9 and noise of 10 m in the clutter of a tenth of a detection in a gate.
    let mut draw = Seed { seed: 3, run: 0 }.stream(Purpose::Detection, 0, 0);
    let mut normal = |sigma: f64| {
        let value: f64 = StandardNormal.sample(&mut draw);
        sigma * value
    };
    let velocities: Vec<[f64; 2]> = (0..900).map(|_| [normal(10.0), normal(10.0)]).collect();
    let mut scans = Vec::new();
    let mut misses = Seed { seed: 3, run: 0 }.stream(Purpose::TargetStart, 0, 0);
    for scan in 0..12 {
        let mut places = Vec::new();
        for (target, velocity) in velocities.iter().enumerate() {
            let centre = [(target % 30) as f64 * 2000.0, (target / 30) as f64 * 2000.0];
            let place =
                [0, 1].map(|axis| centre[axis] + velocity[axis] * f64::from(scan) + normal(10.0));
            if scan == 0 || misses.random_range(0.0..1.0) < 0.9 {
                places.push(place);
            }
        }
        scans.push(places);
    }
    let lifecycle = Lifecycle {
        confirmation: score(0.001),
        ..LIFE
    };
    // Later starts do not count: they are detections outside the gate of a track that is followed already.
    let (_, tracks) = tracked(
        &recording(&scans),
        "global_nearest_neighbour",
        lifecycle,
        1e-5,
    );
    let confirmed = tracks
        .tracks
        .iter()
        .filter(|track| track.points[0].time_s == 0.0)
        .count();
    println!("{confirmed} of 900");
    assert!(
        confirmed < 900 && confirmed as f64 >= 900.0 * (1.0 - 0.05 / 0.999),
        "{confirmed} of 900 are confirmed"
    );
}

/// A target that starts at (0, 0) and goes 5 m a scan to the east, seen in the scans that are not listed.
fn walk(scans: u32, missed: &[u32]) -> Vec<Vec<[f64; 2]>> {
    (1..=scans)
        .map(|scan| {
            if missed.contains(&scan) {
                vec![]
            } else {
                vec![[5.0 * f64::from(scan - 1), 0.0]]
            }
        })
        .collect()
}

#[test]
fn a_detection_in_the_gate_of_a_confirmed_track_starts_one_only_if_no_track_used_it() {
    let started = |method: &str, extra: [f64; 2]| {
        let mut scans = walk(8, &[]);
        scans[7].push(extra);
        let lifecycle = Lifecycle {
            gate_probability: 0.999,
            ..LIFE
        };
        tracked(&recording(&scans), method, lifecycle, 1e-6)
            .0
            .iter()
            .map(|outcome| outcome.started)
            .collect::<Vec<_>>()
    };
    let (alone, with_another) = (vec![1, 0, 0, 0, 0, 0, 0, 0], vec![1, 0, 0, 0, 0, 0, 0, 1]);
    // 8 m beside the target is inside the gate (σ about 13 m), 200 m is not.
    assert_eq!(
        started("pda", [35.0, 8.0]),
        alone,
        "both detections have a weight"
    );
    assert_eq!(
        started("nearest_neighbour", [35.0, 8.0]),
        with_another,
        "the second nearest is left over"
    );
    assert_eq!(started("pda", [35.0, 200.0]), with_another);
    // In the gate, but so far out that its weight is below 0.01.
    assert_eq!(started("pda", [35.0, 43.0]), with_another);
}

#[test]
fn a_track_that_ends_leaves_its_detection_to_others() {
    // After a second detection σ² = 100 · 200.33 / 300.33 = 66.7 m²: more than 8 m allow, so each scan starts anew.
    let started = |limit_m: f64| {
        let lifecycle = Lifecycle {
            max_position_sigma_m: Some(limit_m),
            ..LIFE
        };
        let (outcomes, tracks) = tracked(
            &recording(&walk(4, &[])),
            "nearest_neighbour",
            lifecycle,
            1e-6,
        );
        (
            outcomes
                .iter()
                .map(|outcome| outcome.started)
                .collect::<Vec<_>>(),
            tracks.tracks.len(),
        )
    };
    assert_eq!(started(8.0), (vec![1, 1, 1, 1], 0));
    assert_eq!(started(8.2), (vec![1, 0, 0, 0], 1));
}

#[test]
fn a_tentative_track_sees_only_what_confirmed_tracks_left() {
    // The second track begins in scan 6 beside the first; in scan 7 one detection is left for both, and nearer to it.
    let mut scans = walk(9, &[]);
    scans[5].push([25.0, 30.0]);
    scans[6] = vec![[30.0, 16.0]];
    let (_, tracks) = tracked(&recording(&scans), "nearest_neighbour", LIFE, 1e-6);
    assert_eq!(tracks.tracks.len(), 1);
    assert_eq!(names(&tracks, 0)[6], "7-1");
}

fn covariance_of(point: &TrackPoint) -> Covariance {
    point.estimate.covariance().unwrap()
}

/// The names of the detections of a track, empty where it has none.
fn names(tracks: &TrackSet, track: usize) -> Vec<&str> {
    let named = |point| {
        tracks
            .candidates_of(point)
            .iter()
            .find_map(|candidate| candidate.detection)
    };
    tracks.tracks[track]
        .points
        .iter()
        .map(|point| named(point).map_or("", |name| &tracks.detection_ids[name as usize]))
        .collect()
}

#[test]
fn two_points_start_a_track_with_a_speed_and_remember_both() {
    let lifecycle = Lifecycle {
        initiation: Initiation::TwoPoint {
            max_speed_mps: 10.0,
            max_wait_scans: 1,
        },
        ..LIFE
    };
    let (outcomes, tracks) = tracked(
        &recording(&walk(4, &[])),
        "nearest_neighbour",
        lifecycle,
        1e-6,
    );
    assert_eq!(
        outcomes
            .iter()
            .map(|outcome| (outcome.unused, outcome.started))
            .collect::<Vec<_>>(),
        [(1, 0), (1, 1), (0, 0), (0, 0)]
    );
    assert_eq!(names(&tracks, 0), ["1-1", "2-1", "3-1", "4-1"]);
    let points = &tracks.tracks[0].points;
    assert_eq!(
        points
            .iter()
            .map(|point| point.status.unwrap().name())
            .collect::<Vec<_>>(),
        ["tentative", "confirmed", "confirmed", "confirmed"]
    );
    let second = &points[1];
    let state = second.estimate.state();
    assert!((state[0] - 5.0).abs() < 1e-12 && (state[2] - 5.0).abs() < 1e-12 && state[3] == 0.0);
    // R = 100 I, T = 1 s, q = 1: P_xv = 100, P_vv = 200 + 1 / 3.
    let covariance = covariance_of(second);
    assert!(
        (covariance[(0, 2)] - 100.0).abs() < 1e-9
            && (covariance[(2, 2)] - (200.0 + 1.0 / 3.0)).abs() < 1e-9
    );
    assert_eq!(
        points
            .iter()
            .map(|point| point.nis.is_some())
            .collect::<Vec<_>>(),
        [false, false, true, true]
    );
    // A miss in the second scan: the first detection is forgotten.
    let (_, tracks) = tracked(
        &recording(&walk(5, &[2])),
        "nearest_neighbour",
        lifecycle,
        1e-6,
    );
    assert_eq!(names(&tracks, 0), ["3-1", "4-1", "5-1"]);
    // Unless it may wait for two scans: the speed is that over two seconds, and the missed scan counts as one.
    let patient = Lifecycle {
        initiation: Initiation::TwoPoint {
            max_speed_mps: 10.0,
            max_wait_scans: 2,
        },
        ..LIFE
    };
    let statuses = |missed: &[u32], hits: u32, window: u32| {
        let lifecycle = Lifecycle {
            confirm_hits: hits,
            confirm_window: window,
            ..patient
        };
        let (_, tracks) = tracked(
            &recording(&walk(6, missed)),
            "nearest_neighbour",
            lifecycle,
            1e-6,
        );
        let initials = tracks.tracks[0]
            .points
            .iter()
            .map(|point| &point.status.unwrap().name()[..1])
            .collect::<String>();
        (
            names(&tracks, 0).join(" "),
            tracks.tracks[0].points[1].estimate.state()[2],
            initials,
        )
    };
    assert_eq!(
        statuses(&[2], 3, 4),
        ("1-1 3-1 4-1 5-1 6-1".to_owned(), 5.0, "ttccc".to_owned())
    );
    assert_eq!(
        statuses(&[2], 3, 3),
        ("1-1 3-1 4-1 5-1 6-1".to_owned(), 5.0, "tttcc".to_owned())
    );
    assert_eq!(statuses(&[2, 3], 2, 2).0, "4-1 5-1 6-1");
}

#[test]
fn an_uncertain_position_ends_a_track_whose_weights_are_never_a_miss() {
    // After ten scans the target is gone, but four false detections a gate go on: PDA always has something to average.
    let mut scans = walk(10, &[]);
    let mut draw = Seed { seed: 5, run: 0 }.stream(Purpose::Clutter, 0, 0);
    for _ in 0..40 {
        scans.push(
            (0..160)
                .map(|_| {
                    [
                        draw.random_range(-150.0..250.0),
                        draw.random_range(-200.0..200.0),
                    ]
                })
                .collect(),
        );
    }
    let last_scan = |limit| {
        let lifecycle = Lifecycle {
            max_position_sigma_m: limit,
            confirm_hits: 8,
            confirm_window: 8,
            ..LIFE
        };
        let (_, tracks) = tracked(&recording(&scans), "pda", lifecycle, 1e-3);
        let first = &tracks.tracks[0].points;
        let widest = first.iter().map(|point| {
            covariance_of(point)
                .fixed_view::<2, 2>(0, 0)
                .symmetric_eigenvalues()
                .max()
                .sqrt()
        });
        (first.len(), widest.fold(0.0, f64::max))
    };
    let (unlimited, widest_m) = last_scan(None);
    println!("{unlimited} {widest_m}");
    assert!(
        unlimited == 50 && widest_m > 25.0,
        "{unlimited} scans, up to {widest_m} m"
    );
    let (limited, widest_m) = last_scan(Some(20.0));
    println!("{limited} {widest_m}");
    assert!(
        (11..40).contains(&limited) && widest_m <= 20.0,
        "{limited} scans, up to {widest_m} m"
    );
}

/// The job that tracks a CSV recording by nearest neighbour, run to its end: its report and its tracks, column by column.
fn front_door(csv: &str, tracker: Value) -> (Value, BTreeMap<String, Vec<String>>) {
    let body = json!({
        "input": {"source": "dataset", "dataset_id": "0198c0de-0000-7000-8000-000000000000"},
        "tracker": tracker,
        "sensors": [{"sensor_id": "radar", "p_d": 0.9, "clutter_per_m2": 1e-6, "sigma_x_m": 10.0, "sigma_y_m": 10.0}]
    });
    let plan = plan(JobKind::Associate, &body).unwrap();
    let dataset =
        (formats::format_named("csv").unwrap().read)(&mut csv.as_bytes(), &Default::default())
            .unwrap()
            .dataset;
    let outcome = experiment::run(
        &plan,
        vec![Some(experiment::Input {
            dataset,
            sensors: vec![],
            sha256: String::new(),
        })],
        &mut Silent,
    )
    .unwrap();
    let bytes = &outcome
        .artifacts
        .iter()
        .find(|artifact| artifact.name == "tracks.csv")
        .unwrap()
        .bytes;
    let mut lines = std::str::from_utf8(bytes)
        .unwrap()
        .lines()
        .map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let rows: Vec<Vec<String>> = lines.collect();
    let column = |index: usize| rows.iter().map(|row| row[index].clone()).collect();
    (
        outcome.result,
        header
            .iter()
            .enumerate()
            .map(|(index, name)| (name.clone(), column(index)))
            .collect(),
    )
}

#[test]
fn tracks_coast_and_say_so_and_every_update_has_its_nis() {
    let mut csv = String::from("time_s,scan,sensor_id,detection_id,x_m,y_m\n");
    for scan in 0..8 {
        let y_m = [0.0, 4.0, -3.0, 9.0, 1.0, 0.0, -5.0, 2.0][scan];
        // Scans 5 and 6 saw nothing.
        csv += &if [4, 5].contains(&scan) {
            format!("{scan},{},radar,,,\n", scan + 1)
        } else {
            format!("{scan},{},radar,d{scan},{},{y_m}\n", scan + 1, 5 * scan)
        };
    }
    let (result, tracks) = front_door(&csv, json!({"confirm_hits": 3, "confirm_window": 4}));
    let [c, t] = ["confirmed", "tentative"];
    assert_eq!(tracks["status"], [t, t, c, c, "coasted", "coasted", c, c]);
    assert_eq!(
        tracks["detection_id"],
        ["d0", "d1", "d2", "d3", "", "", "d6", "d7"]
    );
    let number = |name: &str, row: usize| tracks[name][row].parse::<f64>().unwrap();
    for row in [4, 5] {
        let step = (
            number("x_m", row) - number("x_m", row - 1),
            number("vx_mps", row),
        );
        assert!(
            (step.0 - step.1).abs() < 1e-9,
            "a track that coasts goes on at its speed: {step:?}"
        );
        assert!(number("p_xx", row) > number("p_xx", row - 1));
    }
    let given: Vec<bool> = tracks["nis"].iter().map(|cell| !cell.is_empty()).collect();
    assert_eq!(given, [false, true, true, true, false, false, true, true]);
    // By hand: at rest with 10 m/s, so S = 100 + (100 + 100 + 1/3) = 300.33 in the second scan; ν = (5, 4).
    assert!(
        (number("nis", 1) - 41.0 / (300.0 + 1.0 / 3.0)).abs() < 1e-9,
        "{}",
        number("nis", 1)
    );
    // The mean of the report is that of the updates after the confirmation.
    let mean = [3, 6, 7].map(|row| number("nis", row)).iter().sum::<f64>() / 3.0;
    let nis = &result["association"]["nis"];
    assert_eq!(nis["updates"], 3);
    assert!((nis["mean"].as_f64().unwrap() - mean).abs() < 1e-12);
}

#[test]
fn the_oracle_pairs_what_belongs_together() {
    let mut preset = presets::find("liang2009-30").unwrap();
    preset.body["associator"] = json!({"method": "oracle"});
    preset.body["tracker"]["initiation"] = json!({"method": "two_point", "max_speed_mps": 1000.0});
    let result = experiment::run(
        &plan(preset.kind, &preset.body).unwrap(),
        vec![],
        &mut Silent,
    )
    .unwrap()
    .result;
    let counts = &result["tfa"]["counts"];
    assert!(
        counts["false_tracks"] == 0
            && counts["false"] == 0
            && counts["correct"].as_u64().unwrap() > 20,
        "{counts}"
    );
    let started = result["association"]["counts"]["started_tracks"]
        .as_u64()
        .unwrap();
    assert!(
        started <= counts["targets"].as_u64().unwrap(),
        "clutter starts nothing, but {started} tracks were started"
    );
}
