//! The same by the nearest detection: what the track is near to at a scan is what it took.

use super::notation::{assert_sets, target, tracks, tracks_at};
use trackloom_domain::evaluation::temporal_automaton::TfaEvaluation;
use trackloom_domain::evaluation::{EvaluationInput, SymbolRule, TfaReport, TfaSettings};
use trackloom_domain::model::fault::Fault;
use trackloom_domain::model::scan::{Detection, Measurement, Recording, RecordingParts, Scan};
use trackloom_domain::model::sensor::SensorSettings;

const AT: fn(f64, f64) -> Measurement = |x_m, y_m| Measurement::Position { x_m, y_m };

/// One target A, origin 0; detections of each scan with or without origin, named by scan and place: `1.0`, `1.1`, …
fn recorded(scans: &[&[(Measurement, Option<u32>)]]) -> Recording {
    let mut parts = RecordingParts {
        sensors: vec![SensorSettings::named("radar")],
        targets: vec!["A".into()],
        origins_known: true,
        ..Default::default()
    };
    for (index, seen) in scans.iter().enumerate() {
        let number = index as u32 + 1;
        let detection = |&(measurement, origin): &(Measurement, Option<u32>)| Detection {
            measurement,
            origin,
            amplitude: None,
        };
        parts.scans.push(Scan {
            number,
            time_s: f64::from(number),
            sensor: 0,
            pose: None,
            own: Vec::new(),
            detections: seen.iter().map(detection).collect(),
        });
        for place in 0..seen.len() {
            parts.detection_ids.push(format!("{number}.{place}"));
        }
    }
    Recording::new(parts).unwrap()
}

type Path<'a> = &'a [(f64, f64, f64)];

fn evaluate(
    recording: &Recording,
    sensors: &[SensorSettings],
    paths: &[(&str, Path)],
    gate_m: f64,
) -> Result<TfaReport, Vec<Fault>> {
    let tracks = tracks_at(paths);
    let input = EvaluationInput {
        recording: Some(recording),
        truth: None,
        tracks: &tracks,
    };
    let settings = TfaSettings {
        symbols: SymbolRule::NearestDetection { gate_m },
        ..TfaSettings::PAPER
    };
    Ok(TfaEvaluation::new(input, Some(sensors), settings)?.report())
}

#[test]
fn the_nearest_detection_of_the_scan_inside_the_gate_is_the_symbol() {
    let recording = recorded(&[
        &[(AT(0.0, 0.0), Some(0)), (AT(9.0, 0.0), None)],
        &[(AT(10.0, 0.0), Some(0)), (AT(12.0, 0.0), None)],
        &[(AT(20.0, 0.0), Some(0))],
    ]);
    let right: Path = &[(1.0, 1.0, 0.0), (2.0, 10.0, 1.0), (3.0, 20.0, 5.0)];
    let report = evaluate(&recording, &recording.sensors, &[("1", right)], 5.0).unwrap();
    assert_eq!(
        target(&report, "A"),
        "A correct; errors 0",
        "5 m is inside the gate"
    );
    assert_eq!(
        (report.parameters.symbols, report.parameters.gate_m),
        ("nearest_detection", Some(5.0))
    );
    assert_sets(&report, [1, 0, 0], [Some(1.0), Some(0.0), Some(0.0)]);

    let astray: Path = &[(1.0, 1.0, 0.0), (2.0, 11.5, 0.0), (3.0, 20.0, 5.1)];
    let report = evaluate(&recording, &recording.sensors, &[("1", astray)], 5.0).unwrap();
    assert_eq!(
        target(&report, "A"),
        "A false at 2: expected 2.0, took 2.1 (clutter), track 1; errors 2"
    );
    assert_eq!(
        tracks(&report),
        ["1 matched A, scans 1..2, symbols 2, errors 2"]
    );
}

#[test]
fn two_tracks_near_one_detection_share_it() {
    let recording = recorded(&[&[(AT(0.0, 0.0), Some(0))]]);
    let report = evaluate(
        &recording,
        &recording.sensors,
        &[("1", &[(1.0, 1.0, 0.0)]), ("2", &[(1.0, -1.0, 0.0)])],
        5.0,
    )
    .unwrap();
    assert_eq!(report.violations.len(), 1);
    assert_eq!(
        (
            report.violations[0].detection_ids[0].as_str(),
            report.violations[0].track_ids.len()
        ),
        ("1.0", 2)
    );
}

#[test]
fn polar_reports_are_placed_from_their_sensor() {
    let east = Measurement::RangeBearing {
        range_m: 100.0,
        bearing_rad: std::f64::consts::FRAC_PI_2,
        range_rate_mps: None,
    };
    let recording = recorded(&[&[
        (east, Some(0)),
        (Measurement::Bearing { bearing_rad: 0.0 }, None),
    ]]);
    let sensor = SensorSettings {
        x_m: Some(1000.0),
        y_m: Some(50.0),
        ..SensorSettings::named("radar")
    };
    let paths: &[(&str, Path)] = &[("1", &[(1.0, 1100.0, 51.0)])];
    let report = evaluate(&recording, std::slice::from_ref(&sensor), paths, 2.0).unwrap();
    assert_eq!(target(&report, "A"), "A correct; errors 0");
    assert_eq!(
        report.warnings,
        [
            "1 detection(s) are bearings alone, which are near to nothing, and were left out as symbols of tracks"
        ]
    );
    let faults = evaluate(&recording, &recording.sensors, paths, 2.0).unwrap_err();
    assert_eq!(
        (
            faults.len(),
            faults[0].pointer.as_str(),
            faults[0].code.as_str()
        ),
        (1, "/sensors", "missing")
    );
    assert!(faults[0].detail.contains("'radar'"));
}
