//! The detector on records whose truth is known.

use super::*;
use crate::model::bearing_time::BearingTimeParts;
use crate::model::space::Space;
use crate::model::truth::{Target, TruthPoint, TruthSet};
use crate::registry;
use rand::SeedableRng;
use rand_distr::{Distribution, Gamma};
use serde_json::{Value, json};

fn detector(body: Value) -> Detector {
    serde_json::from_value(registry::check(&body, &DETECTOR).unwrap()).unwrap()
}

fn record(
    bearings_deg: impl Iterator<Item = f64>,
    rows: usize,
    mut level_db: impl FnMut(usize, f64) -> f64,
) -> BearingTimeRecord {
    let degrees: Vec<f64> = bearings_deg.collect();
    let levels = (0..rows).flat_map(|row| degrees.iter().map(move |&bearing| (row, bearing)));
    BearingTimeRecord::new(BearingTimeParts {
        levels_db: levels
            .map(|(row, bearing)| level_db(row, bearing) as f32)
            .collect(),
        times_s: (0..rows).map(|row| row as f64).collect(),
        bearings_rad: degrees.iter().map(|bearing| bearing.to_radians()).collect(),
    })
    .unwrap()
}

/// Levels of noise of which each is the mean of `averages` values.
fn noise(averages: f64) -> impl FnMut(usize, f64) -> f64 {
    let mut draw = rand_chacha::ChaCha8Rng::seed_from_u64(5);
    let gamma = Gamma::new(averages, 1.0 / averages).unwrap();
    move |_, _| 10.0 * gamma.sample(&mut draw).log10()
}

fn turn() -> impl Iterator<Item = f64> {
    (0..360).map(f64::from)
}

fn found(detector: &Detector, record: &BearingTimeRecord) -> Found {
    detector
        .detect(record, &SensorSettings::named("sonar"), &mut |_, _| {
            ControlFlow::Continue(())
        })
        .unwrap()
        .unwrap()
}

fn bearings_deg(recording: &Recording) -> Vec<f64> {
    let degrees = |detection: &Detection| match detection.measurement {
        Measurement::Bearing { bearing_rad } => bearing_rad.to_degrees(),
        _ => f64::NAN,
    };
    recording.detections().map(degrees).collect()
}

#[test]
fn noise_alone_exceeds_the_threshold_as_often_as_asked() {
    // 400 scans of 360 cells at 0.002: 288 exceedances, of which neighbours are one peak (few: 0.4 %); 5 standard deviations
    // are 85.
    for (averages, given) in [(1.0, Some(1.0)), (4.0, None)] {
        let mut threshold = json!({"kind": "cell_averaging", "false_alarm_probability": 0.002});
        if let Some(given) = given {
            threshold["noise_averages"] = json!(given);
        }
        let found = found(
            &detector(json!({"threshold": threshold, "every_s": 2.0})),
            &record(turn(), 800, noise(averages)),
        );
        assert_eq!(found.recording.scans.len(), 400);
        let count = found.recording.detection_count();
        assert!((203..=373).contains(&count), "{averages}: {count}");
        let estimated = found.tuning.noise_averages.unwrap();
        assert!(
            (estimated / averages - 1.0).abs() < 0.08,
            "{averages}: {estimated}"
        );
    }
}

#[test]
fn a_peak_is_found_to_a_fraction_of_its_cell_also_across_north() {
    // A Gaussian beam of 3 degrees in cells of 1 degree: in dB a parabola.
    let beam = |bearing: f64, at: f64| {
        let off = (bearing - at + 180.0).rem_euclid(360.0) - 180.0;
        40.0 - 10.0 * 4.0 * 2f64.log10() * (off / 3.0).powi(2)
    };
    for at in [0.0, 0.3, 359.8, 100.25, 249.6] {
        let record = record(turn(), 1, |_, bearing| beam(bearing, at).max(0.0));
        let found = found(
            &detector(json!({"threshold": {"kind": "constant", "level_db": 20.0}})),
            &record,
        );
        let bearings = bearings_deg(&found.recording);
        assert_eq!(bearings.len(), 1, "{at}");
        assert!(
            (wrap((bearings[0] - at).to_radians())).abs() < 1e-5,
            "{at}: {}",
            bearings[0]
        );
        assert!(
            (found.recording.scans[0].detections[0].amplitude.unwrap() - 40.0).abs() < 1e-4,
            "{at}"
        );
    }
}

#[test]
fn with_noise_a_strong_target_is_found_within_a_quarter_of_a_cell() {
    let mut noise = noise(4.0);
    let beam =
        |bearing: f64| (-4.0 * std::f64::consts::LN_2 * ((bearing - 100.4) / 3.0).powi(2)).exp();
    let record = record(turn(), 500, |row, bearing| {
        10.0 * (1.0 + 1000.0 * beam(bearing)).log10() + noise(row, bearing)
    });
    let found = found(&detector(json!({})), &record);
    let truth = TruthSet::new(
        Space::Bearing,
        vec![Target {
            truth_id: "a".into(),
            points: vec![
                TruthPoint::at_bearing(0.0, 100.4f64.to_radians()),
                TruthPoint::at_bearing(499.0, 100.4f64.to_radians()),
            ],
        }],
    )
    .unwrap();
    let (recording, quality) = assign_origins(found.recording, &truth, 2.0).unwrap();
    assert_eq!((recording.scans.len(), quality.p_d), (50, Some(1.0)));
    let error_deg = quality.bearing_rmse_deg.unwrap();
    assert!(error_deg < 0.25, "{error_deg}");
    let sigma_deg = estimated_sigma_rad(&recording, 1f64.to_radians())
        .unwrap()
        .to_degrees();
    assert!(
        (0.6..1.6).contains(&(sigma_deg / error_deg)),
        "{sigma_deg} and {error_deg}"
    );
}

#[test]
fn power_is_averaged_and_the_time_is_the_middle() {
    // 10 dB and 0 dB are 5.5 in the mean, 7.40 dB: not 5 dB.
    let record = record([10.0, 11.0, 12.0].into_iter(), 3, |row, bearing| {
        match (row, bearing) {
            (0 | 2, 11.0) => 10.0,
            _ => 0.0,
        }
    });
    let at = |level_db: f64| {
        let found = found(
            &detector(
                json!({"threshold": {"kind": "constant", "level_db": level_db}, "every_s": 2.0}),
            ),
            &record,
        );
        found
            .recording
            .scans
            .iter()
            .map(|scan| (scan.time_s, scan.detections.len()))
            .collect::<Vec<_>>()
    };
    assert_eq!(at(7.39), [(0.5, 1), (2.0, 1)]);
    assert_eq!(at(7.41), [(0.5, 0), (2.0, 1)]);
}

#[test]
fn the_ends_of_a_sector_have_no_peak() {
    let sector = record((0..100).map(f64::from), 2, |_, bearing| {
        if bearing == 0.0 || bearing == 50.0 {
            30.0
        } else {
            0.0
        }
    });
    assert_eq!(
        bearings_deg(&found(&detector(json!({})), &sector).recording),
        [50.0]
    );
    let few = record((0..10).map(f64::from), 2, |_, _| 0.0);
    let faults = detector(json!({}))
        .detect(&few, &SensorSettings::named("sonar"), &mut |_, _| {
            ControlFlow::Continue(())
        })
        .unwrap_err();
    assert_eq!(
        (faults[0].pointer.as_str(), faults.len()),
        ("/detector/threshold/training_cells", 1)
    );
}

#[test]
fn a_detection_has_one_target_and_a_target_one_detection() {
    let record = record(turn(), 1, |_, bearing| {
        if [10.0, 13.0, 80.0].contains(&bearing) {
            20.0
        } else {
            0.0
        }
    });
    let found = found(
        &detector(json!({"threshold": {"kind": "constant", "level_db": 10.0}})),
        &record,
    );
    let target = |name: &str, degrees: f64| Target {
        truth_id: name.into(),
        points: vec![TruthPoint::at_bearing(0.0, degrees.to_radians())],
    };
    let truth = TruthSet::new(
        Space::Bearing,
        vec![
            target("a", 10.5),
            target("b", 11.5),
            target("c", 79.0),
            target("d", 81.5),
        ],
    )
    .unwrap();
    let (recording, quality) = assign_origins(found.recording, &truth, 2.0).unwrap();
    let origins: Vec<_> = recording
        .detections()
        .map(|detection| detection.origin)
        .collect();
    assert_eq!(origins, [Some(0), Some(1), Some(2)]);
    assert_eq!(
        (quality.p_d, quality.false_alarms_per_scan),
        (Some(0.75), Some(0.0))
    );
    // Errors 0.5, 1.5 and 1 degrees.
    assert!((quality.bearing_rmse_deg.unwrap() - (3.5f64 / 3.0).sqrt()).abs() < 1e-9);
}
