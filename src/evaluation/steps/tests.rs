//! Steps of truth and tracks with clocks that agree, jitter or differ.

use super::*;
use crate::evaluation::comparison::{Alignment, Comparison, PointSettings};
use crate::evaluation::events::{EventKind, EventLog};
use crate::evaluation::tests::{tracks_of, truth_of};
use crate::evaluation::{
    EvaluationInput, SymbolRule, TfaReport, TfaSettings, evaluate_temporal_automaton,
};
use crate::model::space::Space;
use crate::model::state::Position;
use crate::model::truth::{Target, TruthPoint};

/// 20 m/s along x, at each of these times.
fn truth_at(times_s: &[f64]) -> TruthSet {
    let point =
        |&time_s: &f64| TruthPoint::in_plane(time_s, Position::new(20.0 * time_s, 0.0), None);
    TruthSet::new(
        Space::Plane,
        vec![Target {
            truth_id: "A".to_owned(),
            points: times_s.iter().map(point).collect(),
        }],
    )
    .unwrap()
}

/// A perfect track of the same target at other times.
fn track_at(times_s: &[f64]) -> TrackSet {
    let places: Vec<f64> = times_s.iter().map(|time_s| 20.0 * time_s).collect();
    let mut set = tracks_of(&[("T", &places)]);
    set.tracks[0]
        .points
        .iter_mut()
        .zip(times_s)
        .for_each(|(point, &time_s)| point.time_s = time_s);
    set
}

fn compared(
    truth: &TruthSet,
    tracks: &TrackSet,
    time_tolerance_s: Option<f64>,
) -> (Comparison, EventLog) {
    let input = EvaluationInput {
        recording: None,
        truth: Some(truth),
        tracks,
    };
    let alignment = Alignment::Interpolate { max_gap_s: 5.0 };
    let settings = PointSettings {
        alignment,
        gate_m: 10.0,
        reach_m: 10.0,
        time_tolerance_s,
    };
    let comparison = Comparison::of_points(&input, truth, &settings);
    let log = EventLog::new(&comparison);
    (comparison, log)
}

/// Matches, misses, unmatched track points, breaks.
fn counts(truth: &[f64], track: &[f64], tolerance_s: Option<f64>) -> [usize; 4] {
    let (_, log) = compared(&truth_at(truth), &track_at(track), tolerance_s);
    let unmatched = [
        EventKind::FalseAlarm,
        EventKind::Redundant,
        EventKind::Divergence,
    ]
    .map(|kind| log.count(kind));
    [
        log.count(EventKind::Match),
        log.count(EventKind::Miss),
        unmatched.iter().sum(),
        log.count(EventKind::Break),
    ]
}

fn every(period_s: f64, count: u32) -> Vec<f64> {
    (0..count)
        .map(|index| f64::from(index) * period_s)
        .collect()
}

fn judged(truth: &TruthSet, tracks: &TrackSet) -> TfaReport {
    let symbols = SymbolRule::NearestTruth {
        gate_m: 10.0,
        max_gap_s: 5.0,
    };
    let input = EvaluationInput {
        recording: None,
        truth: Some(truth),
        tracks,
    };
    evaluate_temporal_automaton(
        &input,
        &TfaSettings {
            symbols,
            ..TfaSettings::PAPER
        },
    )
    .unwrap()
}

#[test]
fn noise_of_rounding_and_a_millisecond_change_nothing() {
    let truth = every(1.0, 20);
    let noisy: Vec<f64> = truth
        .iter()
        .enumerate()
        .map(|(index, time_s)| time_s + [1e-9, -1e-9, 0.0][index % 3])
        .collect();
    let late: Vec<f64> = truth.iter().map(|time_s| time_s + 1e-3).collect();
    let early: Vec<f64> = truth.iter().map(|time_s| time_s - 1e-3).collect();
    let partly: Vec<f64> = truth
        .iter()
        .enumerate()
        .map(|(index, time_s)| {
            if index % 3 == 0 {
                *time_s
            } else {
                time_s + 1e-3
            }
        })
        .collect();
    for track in [&noisy, &late, &early, &partly] {
        assert_eq!(counts(&truth, track, None), [20, 0, 0, 0], "{track:?}");
        assert_eq!(
            judged(&truth_at(&truth), &track_at(track)).counts.correct,
            1,
            "{track:?}"
        );
    }
    let (comparison, _) = compared(&truth_at(&truth), &track_at(&partly), None);
    let told = "times of truth and tracks that differ by up to 0.01 s are one step: so at 13 of 20 steps, by 1.000e-3 s at most";
    assert_eq!(comparison.warnings, [told]);
    // The truth is aligned to the track: the distance is of rounding, not 20 m/s times 1 ms.
    assert!(
        comparison.pairs[..19]
            .iter()
            .all(|pair| pair.distance < 1e-9)
    );
}

#[test]
fn a_tolerance_may_be_stated() {
    let truth = every(1.0, 10);
    let track: Vec<f64> = truth.iter().map(|time_s| time_s + 0.1).collect();
    let (first, _) = compared(&truth_at(&truth), &track_at(&track), None);
    assert!(
        first.warnings[0].starts_with("tracks and truth share 0 of 10 times"),
        "{:?}",
        first.warnings
    );
    // Its last point lies behind the truth's last, so that it follows nobody there.
    assert_eq!(counts(&truth, &track, None), [9, 0, 1, 0]);
    assert_eq!(counts(&truth, &track, Some(0.2)), [10, 0, 0, 0]);
    let (second, _) = compared(&truth_at(&truth), &track_at(&track), Some(1.5));
    assert!(
        second.warnings[0].starts_with("a tolerance of 1.5 s makes one step of points"),
        "{:?}",
        second.warnings
    );
}

#[test]
fn the_tolerance_never_joins_two_points_of_one_path() {
    let steps = |period_s: f64| {
        Steps::new(
            None,
            Some(&truth_at(&every(period_s, 9))),
            &track_at(&every(period_s, 9)),
            None,
        )
    };
    assert_eq!(
        [steps(8.0), steps(0.04), steps(1e-3)].map(|steps| steps.count()),
        [9, 9, 9]
    );
    assert!((steps(0.04).tolerance_s - 0.002).abs() < 1e-12);
    assert_eq!(
        (steps(8.0).tolerance_s, steps(8.0).warnings),
        (0.01, Vec::new())
    );
}

#[test]
fn tracks_of_another_rate_miss_nothing_and_their_silence_counts_at_their_own_rate() {
    let fast = every(0.1, 201);
    let (whole, mut silent) = (every(1.0, 21), every(1.0, 21));
    assert_eq!(counts(&fast, &whole, None), [21, 0, 0, 0]);
    // A rate that shares few times with the truth.
    assert_eq!(counts(&fast, &every(0.73, 28), None), [28, 0, 0, 0]);
    assert_eq!(
        counts(&fast, &every(0.73, 27), None),
        [27, 1, 0, 1],
        "it ends 1.02 s early"
    );
    silent.retain(|time_s| !(6.0..=9.0).contains(time_s));
    assert_eq!(counts(&fast, &silent, None), [17, 4, 0, 1]);
    let late: Vec<f64> = every(1.0, 21).split_off(3);
    assert_eq!(counts(&fast, &late, None), [18, 3, 0, 0]);
}

#[test]
fn sensors_that_take_turns_are_no_silence() {
    let mut track: Vec<f64> = (0..20)
        .flat_map(|turn| [0.0, 0.37].map(|shift| 0.05 + f64::from(turn) + shift))
        .collect();
    assert_eq!(counts(&every(0.1, 201), &track, None), [40, 0, 0, 0]);
    assert_eq!(counts(&every(1.0, 21), &track, None), [40, 0, 0, 0]);
    track.retain(|time_s| !(8.0..11.0).contains(time_s));
    let [matched, missed, unmatched, breaks] = counts(&every(0.1, 201), &track, None);
    assert_eq!((matched, unmatched, breaks), (34, 0, 1));
    assert!(
        (3..=5).contains(&missed),
        "3 s of silence at a usual gap of 0.63 s: {missed}"
    );
}

#[test]
fn what_a_track_lacks_costs_the_automaton_as_much_as_clear() {
    let truth = every(1.0, 12);
    let cut = |lacks: &dyn Fn(f64) -> bool| {
        truth
            .iter()
            .copied()
            .filter(|&time_s| !lacks(time_s))
            .collect::<Vec<f64>>()
    };
    let cases = [
        ("late", cut(&|time_s| time_s < 3.0), 3, 0, "missed"),
        (
            "gap",
            cut(&|time_s| (4.0..6.0).contains(&time_s)),
            2,
            1,
            "false",
        ),
        ("early end", cut(&|time_s| time_s > 7.0), 4, 1, "false"),
        ("whole", truth.clone(), 0, 0, "correct"),
    ];
    for (name, track, missed, breaks, verdict) in cases {
        assert_eq!(
            counts(&truth, &track, None),
            [12 - missed, missed, 0, breaks],
            "{name}"
        );
        let report = judged(&truth_at(&truth), &track_at(&track));
        let target = &report.targets[0];
        assert_eq!(
            serde_json::to_value(target.verdict).unwrap(),
            verdict,
            "{name}"
        );
        assert_eq!(
            target.least_errors,
            Some(missed),
            "{name}: the errors are CLEAR's misses"
        );
        if verdict == "false" {
            assert_eq!(target.errors, missed, "{name}");
        }
    }
}

#[test]
fn points_belong_to_the_nearest_scan_of_a_recording() {
    use crate::model::scan::{RecordingParts, Scan};
    use crate::model::sensor::SensorSettings;
    let scan = |number: u32| Scan {
        number,
        time_s: f64::from(number),
        sensor: 0,
        pose: None,
        own: Vec::new(),
        detections: Vec::new(),
    };
    let sensors = vec![SensorSettings::named("radar")];
    let recording = Recording::new(RecordingParts {
        sensors,
        scans: (1..=4).map(scan).collect(),
        ..Default::default()
    })
    .unwrap();
    let tracks = track_at(&[1.0 - 1e-9, 2.0, 3.004, 4.2]);
    let steps = Steps::new(Some(&recording), Some(&truth_of(&[])), &tracks, None);
    assert_eq!(
        [1.0 - 1e-9, 2.0, 3.004, 4.2].map(|time_s| steps.at(time_s)),
        [Some(0), Some(1), Some(2), None]
    );
    let told = "times of tracks and scans that differ by up to 0.01 s are one step: so at 2 of 4 steps, by 4.000e-3 s at most";
    assert_eq!(steps.warnings, [told]);
}
