//! A break is explained by what became of the track and by what the sensors saw.

use trackloom_domain::evaluation::EvaluationInput;
use trackloom_domain::evaluation::breaks::{Break, BreakCause, explain};
use trackloom_domain::evaluation::comparison::{Comparison, PointSettings};
use trackloom_domain::evaluation::credit::Credit;
use trackloom_domain::evaluation::events::EventLog;
use trackloom_domain::evaluation::paths::Alignment;
use trackloom_domain::evaluation::steps::StepSettings;
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::model::dataset::Dataset;

fn read(text: &str) -> Dataset {
    (format_named("csv").unwrap().read)(&mut text.as_bytes(), &ReadOptions::default())
        .unwrap()
        .dataset
}

/// A stands at (0, 0), B at (100, 0), for five scans. Track 1 leaves A at t = 2 for B, whose own track 2 ends there;
/// track 3 runs away from A at t = 4. A is not detected from t = 1 to 2, and at t = 4 it is.
#[test]
fn a_break_says_what_became_of_the_track_and_whether_the_target_was_seen() {
    let truth: String = (0..5)
        .map(|t| format!("{t},A,0,0\n{t},B,100,0\n"))
        .collect();
    let Dataset::Truth(truth) = read(&format!("time_s,truth_id,x_m,y_m\n{truth}")) else {
        panic!("not truth")
    };
    let Dataset::Detections(recording) = read(
        "time_s,scan,sensor_id,detection_id,x_m,y_m\n0,1,r,a,1,0\n0,1,r,b,99,0\n1,2,r,c,99,0\n2,3,r,d,98,0\n3,4,r,e,0,1\n4,5,r,f,0,2\n4,5,r,g,50,0\n",
    ) else {
        panic!("not detections")
    };
    let rows = "0,1,0,0,a\n1,1,5,0,\n2,1,98,0,d\n3,1,98,0,\n4,1,98,0,\n0,2,99,0,b\n1,2,99,0,c\n3,3,0,1,e\n4,3,50,0,g\n";
    let Dataset::Tracks(tracks) = read(&format!("time_s,track_id,x_m,y_m,detection_id\n{rows}"))
    else {
        panic!("not tracks")
    };
    let input = EvaluationInput {
        recording: Some(&recording),
        truth: Some(&truth),
        tracks: &tracks,
    };
    let settings = PointSettings {
        alignment: Alignment::Interpolate {
            max_gap_s: Some(1.0),
        },
        gate_m: 10.0,
        reach_m: 10.0,
        steps: StepSettings::default(),
        credit: Credit::Afterwards,
    };
    let comparison = Comparison::of_points(&input, &truth, &settings);
    let log = EventLog::new(&comparison);
    let breaks: Vec<Break> = explain(&comparison, &log, Some(&input)).collect();
    let brief: Vec<_> = breaks
        .iter()
        .map(|b| (b.time_s, b.truth_id.as_str(), b.track_id.as_str(), b.cause))
        .collect();
    assert_eq!(
        brief,
        [
            (2.0, "A", "1", BreakCause::TookOtherTarget),
            (4.0, "A", "3", BreakCause::LeftGate)
        ]
    );
    assert_eq!(
        (
            breaks[0].other_truth_id.as_deref(),
            breaks[0].unseen_scans,
            breaks[0].last_detection_time_s
        ),
        (Some("B"), Some(2), Some(2.0))
    );
    assert_eq!(
        (
            breaks[1].other_truth_id.as_deref(),
            breaks[1].unseen_scans,
            breaks[1].last_detection_time_s
        ),
        (None, Some(0), Some(4.0))
    );
}

/// A stands at (0, 0, 5) and its track ends after t = 0. What is seen 50 m above it at t = 1 is something else, unless the
/// sensor says no height.
#[test]
fn in_a_volume_a_detection_above_the_target_is_not_of_it() {
    let truth = "time_s,truth_id,x_m,y_m,z_m\n0,A,0,0,5\n1,A,0,0,5\n";
    let tracks = "time_s,track_id,x_m,y_m,z_m\n0,1,0,0,5\n";
    for (height, unseen) in [("55", Some(1)), ("6", Some(0)), ("", Some(0))] {
        let seen = format!(
            "time_s,scan,sensor_id,detection_id,x_m,y_m,z_m\n0,1,r,a,0,0,5\n1,2,r,b,0,0,{height}\n"
        );
        let (Dataset::Truth(truth), Dataset::Tracks(tracks), Dataset::Detections(recording)) =
            (read(truth), read(tracks), read(&seen))
        else {
            panic!("other kinds")
        };
        let input = EvaluationInput {
            recording: Some(&recording),
            truth: Some(&truth),
            tracks: &tracks,
        };
        let settings = PointSettings {
            alignment: Alignment::Interpolate {
                max_gap_s: Some(1.0),
            },
            gate_m: 10.0,
            reach_m: 10.0,
            steps: StepSettings::default(),
            credit: Credit::Afterwards,
        };
        let comparison = Comparison::of_points(&input, &truth, &settings);
        let log = EventLog::new(&comparison);
        let breaks: Vec<Break> = explain(&comparison, &log, Some(&input)).collect();
        assert_eq!(breaks.len(), 1);
        assert_eq!(breaks[0].unseen_scans, unseen, "height {height}");
    }
}
