//! Steps of truth and tracks with clocks that agree, jitter or differ.

use super::*;
use crate::evaluation::comparison::{Comparison, PointSettings};
use crate::evaluation::credit::Credit;
use crate::evaluation::events::{EventKind, EventLog};
use crate::evaluation::paths::Alignment;
use crate::evaluation::tests::{tracks_of, truth_of};
use crate::evaluation::{
    EvaluationInput, SymbolRule, TfaReport, TfaSettings, evaluate_temporal_automaton,
};
use crate::model::space::Space;
use crate::model::state::Position;
use crate::model::truth::{Target, TruthPoint, TruthSet};

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

fn compared(truth: &TruthSet, tracks: &TrackSet, steps: StepSettings) -> (Comparison, EventLog) {
    compared_with(None, truth, tracks, steps)
}

fn compared_with(
    recording: Option<&Recording>,
    truth: &TruthSet,
    tracks: &TrackSet,
    steps: StepSettings,
) -> (Comparison, EventLog) {
    let input = EvaluationInput {
        recording,
        truth: Some(truth),
        tracks,
    };
    let settings = PointSettings {
        alignment: Alignment::Interpolate { max_gap_s: None },
        gate_m: 10.0,
        reach_m: 10.0,
        steps,
        credit: Credit::Afterwards,
    };
    let comparison = Comparison::of_points(&input, truth, &settings);
    let log = EventLog::new(&comparison);
    (comparison, log)
}

const AUTO: StepSettings = StepSettings {
    rule: StepRule::Auto,
    every_s: None,
    time_tolerance_s: None,
};

fn by(rule: StepRule) -> StepSettings {
    StepSettings { rule, ..AUTO }
}

/// Matches, misses, unmatched track points, breaks.
fn counts(truth: &[f64], track: &[f64], steps: StepSettings) -> [usize; 4] {
    let (_, log) = compared(&truth_at(truth), &track_at(track), steps);
    counts_of(&log)
}

fn counts_of(log: &EventLog) -> [usize; 4] {
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
        max_gap_s: None,
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
    for track in [&noisy, &late, &early] {
        let (truth, track) = (truth_at(&truth), track_at(track));
        let (comparison, log) = compared(&truth, &track, AUTO);
        assert_eq!(counts_of(&log), [20, 0, 0, 0]);
        assert_eq!(judged(&truth, &track).counts.correct, 1);
        assert_eq!(comparison.warnings, Vec::<String>::new());
        // Truth at the time of the track: the distance is of rounding, not 20 m/s times 1 ms; beyond its ends by its velocity.
        assert!(comparison.pairs.iter().all(|pair| pair.distance < 1e-9));
    }
}

#[test]
fn a_tolerance_joins_times_of_truth() {
    let mut truth = truth_at(&every(1.0, 10));
    let mut other = truth_at(
        &every(1.0, 10)
            .iter()
            .map(|time_s| time_s + 0.004)
            .collect::<Vec<_>>(),
    );
    let mut targets = truth.targets().to_vec();
    targets.push(Target {
        truth_id: "B".to_owned(),
        points: std::mem::take(&mut other).targets()[0].points.clone(),
    });
    truth = TruthSet::new(Space::Plane, targets).unwrap();
    let none = TrackSet::default();
    let steps = |time_tolerance_s| {
        let settings = StepSettings {
            time_tolerance_s,
            ..AUTO
        };
        let (comparison, log) = compared(&truth, &none, settings);
        (comparison.steps.len(), log.count(EventKind::Miss))
    };
    assert_eq!(steps(None), (10, 20));
    // Else they have clocks of their own: a grid from the first time on, at which B does not exist yet.
    assert_eq!(steps(Some(0.001)), (10, 19));
    let (comparison, _) = compared(
        &truth,
        &none,
        StepSettings {
            time_tolerance_s: Some(1.5),
            ..AUTO
        },
    );
    assert!(
        comparison.warnings[0].starts_with("a tolerance of 1.5 s makes one step of points"),
        "{:?}",
        comparison.warnings
    );
}

#[test]
fn one_report_in_k_is_a_kth_of_the_truth() {
    for k in 1..=5_usize {
        let truth = every(1.0, 60);
        let track: Vec<f64> = truth.iter().copied().step_by(k).collect();
        let matched = 60_usize.div_ceil(k);
        let found = counts(&truth, &track, AUTO);
        assert_eq!(found[..3], [matched, 60 - matched, 0], "{k}");
    }
}

#[test]
fn tracks_at_times_of_their_own_are_compared_there() {
    // Truth each 10 s, a perfect track each 4 s: 13 steps, of which each has a point within 2 s.
    let (truth, track) = (every(10.0, 13), every(4.0, 31));
    let (comparison, log) = compared(&truth_at(&truth), &track_at(&track), AUTO);
    assert_eq!(counts_of(&log), [13, 0, 0, 0]);
    assert_eq!(comparison.facts.between_steps, 18);
    assert_eq!(comparison.facts.period_s, Some(10.0));
    assert!(comparison.pairs.iter().all(|pair| pair.distance < 1e-9));
    assert_eq!(counts(&truth, &track, by(StepRule::Tracks)), [31, 0, 0, 0]);
    assert_eq!(
        judged(&truth_at(&truth), &track_at(&track)).counts.correct,
        1
    );
    // At the time of the step the same point would be 40 m away, or 20 m.
    let at = comparison.truth_beside(1, 1);
    assert_eq!(
        (comparison.truths[1].position_m.x, at.position_m.x),
        (200.0, 240.0)
    );
}

#[test]
fn silence_is_missed_and_what_nobody_is_near_is_false() {
    let truth = every(1.0, 21);
    let lacks: Vec<f64> = truth
        .iter()
        .copied()
        .filter(|time_s| !(6.0..=9.0).contains(time_s))
        .collect();
    assert_eq!(counts(&truth, &lacks, AUTO), [17, 4, 0, 1]);
    assert_eq!(counts(&truth, &lacks, by(StepRule::Tracks)), [17, 0, 0, 0]);
    assert_eq!(counts(&truth, &lacks, by(StepRule::Union)), [17, 4, 0, 1]);
    // Beyond the last window, which reaches to 20.5 s, two points make steps at which nothing is due.
    let long: Vec<f64> = every(1.0, 23);
    let (comparison, log) = compared(&truth_at(&truth), &track_at(&long), AUTO);
    assert_eq!(counts_of(&log), [21, 0, 2, 0]);
    let extra: Vec<f64> = comparison
        .steps
        .iter()
        .filter(|step| step.is_extra)
        .map(|step| step.time_s)
        .collect();
    assert_eq!((extra, comparison.due_steps()), (vec![21.0, 22.0], 21));
    assert_eq!(
        judged(&truth_at(&truth), &track_at(&long)).counts.correct,
        1
    );
}

#[test]
fn a_frame_without_truth_costs_its_false_point_and_flatters_nobody() {
    // Eleven points of truth, none at 5 s; a patchy track, and a point far away at 5 s.
    let times: Vec<f64> = every(1.0, 12)
        .into_iter()
        .filter(|time_s| *time_s != 5.0)
        .collect();
    let truth = truth_at(&times);
    let mut tracks = track_at(&[0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
    let (_, log) = compared(&truth, &tracks, AUTO);
    assert_eq!(counts_of(&log)[..3], [6, 5, 0]);
    let mut far = track_at(&[5.0]).tracks.remove(0);
    far.track_id = "far".to_owned();
    far.points[0].estimate.position.y = 500.0;
    tracks.tracks.push(far);
    let (_, log) = compared(&truth, &tracks, AUTO);
    assert_eq!(counts_of(&log)[..3], [6, 5, 1]);
}

#[test]
fn a_point_near_a_target_in_a_hole_of_the_truth_is_not_false() {
    // Truth misses 5 s, which its path bridges; a track there is right, but nobody knows whether it was due.
    let times: Vec<f64> = every(1.0, 12)
        .into_iter()
        .filter(|time_s| *time_s != 5.0)
        .collect();
    let (comparison, log) = compared(&truth_at(&times), &track_at(&every(1.0, 12)), AUTO);
    assert_eq!(counts_of(&log), [11, 0, 0, 0]);
    assert_eq!(comparison.facts.between_steps, 1);
}

#[test]
fn targets_with_clocks_of_their_own_are_compared_on_a_grid() {
    // Three targets each 6 s, two seconds apart: steps each 6 s from the first time on.
    let mut targets = Vec::new();
    for (index, name) in ["A", "B", "C"].into_iter().enumerate() {
        let times: Vec<f64> = every(6.0, 10)
            .iter()
            .map(|time_s| time_s + 2.0 * index as f64)
            .collect();
        let mut target = truth_at(&times).targets()[0].clone();
        target.truth_id = name.to_owned();
        targets.push(target);
    }
    let truth = TruthSet::new(Space::Plane, targets).unwrap();
    let (comparison, log) = compared(&truth, &TrackSet::default(), AUTO);
    let times: Vec<f64> = comparison.steps.iter().map(|step| step.time_s).collect();
    assert_eq!(times, every(6.0, 10));
    // B and C exist from 2 and 4 s on, so not at 0 s.
    assert_eq!(log.count(EventKind::Miss), 28);
    let (comparison, _) = compared(&truth, &TrackSet::default(), by(StepRule::Truth));
    assert_eq!(comparison.steps.len(), 30);
    let every_s = StepSettings {
        rule: StepRule::EveryS,
        every_s: Some(20.0),
        ..AUTO
    };
    let (comparison, _) = compared(&truth, &TrackSet::default(), every_s);
    let times: Vec<f64> = comparison.steps.iter().map(|step| step.time_s).collect();
    assert_eq!(times, [0.0, 20.0, 40.0]);
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
            counts(&truth, &track, AUTO),
            [12 - missed, missed, 0, breaks],
            "{name}"
        );
        let report = judged(&truth_at(&truth), &track_at(&track));
        let target = &report.targets[0];
        assert_eq!(report.counts.late, usize::from(name == "late"), "{name}");
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

/// Scans of one sensor a second apart, but for these.
fn recorded(sensors: &[(&str, &[f64])]) -> Recording {
    use crate::model::scan::{RecordingParts, Scan};
    use crate::model::sensor::SensorSettings;
    let mut scans = Vec::new();
    for (sensor, (_, times_s)) in sensors.iter().enumerate() {
        for (index, &time_s) in times_s.iter().enumerate() {
            scans.push(Scan {
                number: index as u32 + 1,
                time_s,
                sensor,
                pose: None,
                own: Vec::new(),
                detections: Vec::new(),
            });
        }
    }
    scans.sort_by(|a, b| a.time_s.total_cmp(&b.time_s).then(a.sensor.cmp(&b.sensor)));
    let names = sensors.iter().map(|(name, _)| SensorSettings::named(*name));
    Recording::new(RecordingParts {
        sensors: names.collect(),
        scans,
        ..Default::default()
    })
    .unwrap()
}

/// From 1 s to 24 s, silent for 14 s.
fn silent() -> Vec<f64> {
    (1..=5).chain(20..=24).map(f64::from).collect()
}

#[test]
fn the_hole_of_a_regular_sensor_is_filled_and_costs_what_the_truth_costs() {
    let truth = truth_at(&(1..=24).map(f64::from).collect::<Vec<_>>());
    let recording = recorded(&[("radar", &silent())]);
    let tracks = track_at(&silent());
    let of = |recording, rule| {
        let (comparison, log) = compared_with(recording, &truth, &tracks, by(rule));
        (counts_of(&log), comparison.facts.filled)
    };
    assert_eq!(of(Some(&recording), StepRule::Auto), ([10, 14, 0, 1], 14));
    assert_eq!(
        of(Some(&recording), StepRule::AsRecorded),
        ([10, 0, 0, 0], 0)
    );
    assert_eq!(of(None, StepRule::Auto), ([10, 14, 0, 1], 0));
    // The automaton sees the same steps: an error for each of the misses.
    let symbols = SymbolRule::NearestTruth {
        gate_m: 10.0,
        max_gap_s: None,
    };
    let settings = TfaSettings {
        symbols,
        max_missed: 20,
        ..TfaSettings::PAPER
    };
    let errors = [Some(&recording), None].map(|recording| {
        let input = EvaluationInput {
            recording,
            truth: Some(&truth),
            tracks: &tracks,
        };
        evaluate_temporal_automaton(&input, &settings)
            .unwrap()
            .targets[0]
            .least_errors
    });
    assert_eq!(errors, [Some(14), Some(14)]);
}

#[test]
fn what_another_sensor_saw_and_what_is_irregular_is_no_hole() {
    let truth = truth_at(&(1..=24).map(f64::from).collect::<Vec<_>>());
    let others: Vec<f64> = (1..=24).map(|second| f64::from(second) + 0.3).collect();
    let filled = |sensors: &[(&str, &[f64])]| {
        let recording = recorded(sensors);
        compared_with(Some(&recording), &truth, &TrackSet::default(), AUTO)
            .0
            .facts
            .filled
    };
    assert_eq!(filled(&[("radar", &silent())]), 14);
    assert_eq!(filled(&[("radar", &silent()), ("lidar", &others)]), 0);
    assert_eq!(
        filled(&[("radar", &[1.0, 2.4, 3.1, 5.7, 6.0, 9.5, 20.0, 21.3])]),
        0
    );
    // Every second scan says nothing, and so is not written: it is a multiple of the period.
    assert_eq!(
        filled(&[("radar", &[1.0, 2.0, 3.0, 5.0, 6.0, 7.0, 10.0, 11.0])]),
        3
    );
    // A hole of a year where no target is: nothing to fill.
    assert_eq!(filled(&[("radar", &[1.0, 2.0, 3.0, 4.0, 5.0, 3e7])]), 19);
}

#[test]
fn points_belong_to_the_nearest_scan_of_a_recording() {
    let recording = recorded(&[("radar", &[1.0, 2.0, 3.0, 4.0])]);
    let tracks = track_at(&[1.0 - 1e-9, 2.0, 3.004, 4.2, 4.6]);
    let truth = truth_of(&[]);
    let paths = Paths::new(&truth, Alignment::Interpolate { max_gap_s: None });
    let steps = Steps::new(Some(&recording), &paths, &tracks, &AUTO);
    let at = |steps: &Steps| [1.0 - 1e-9, 2.0, 3.004, 4.2, 4.6].map(|time_s| steps.at(time_s));
    assert_eq!(at(&steps), [Some(0), Some(1), Some(2), Some(3), None]);
    // Where detections are compared, a point belongs to a scan at its very time.
    let steps = Steps::of_detections(&recording, &tracks, None);
    assert_eq!(at(&steps), [Some(0), Some(1), Some(2), None, None]);
    let told = "times of tracks and scans that differ by up to 0.01 s are one step: so at 2 of 4 steps, by 4.000e-3 s at most";
    assert_eq!(steps.warnings, [told]);
}
