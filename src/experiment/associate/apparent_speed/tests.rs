//! Scenes whose speeds are known, made here with a small generator of our own.

use super::*;
use crate::model::scan::{Detection, Measurement, RecordingParts};

/// Numbers from 0 to 1 (Lehmer's generator).
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> f64 {
        self.0 = self.0 * 48_271 % 2_147_483_647;
        self.0 as f64 / 2_147_483_647.0
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.next()).sum::<f64>() - 6.0
    }
}

const SIGMA_M: f64 = 10.0;
const PERIOD_S: f64 = 4.0;

/// 30 scans of a square of 20 km: targets of these speeds, clutter all over, and returns of a straight shore of which each is there in
/// half of the scans.
fn scene(speeds_mps: &[f64], clutter: usize, shore: usize) -> Recording {
    let mut draw = Draw(12_345);
    let courses: Vec<(Position, f64)> = speeds_mps
        .iter()
        .map(|_| {
            (
                Position::new(draw.next(), draw.next()) * 20e3,
                draw.next() * std::f64::consts::TAU,
            )
        })
        .collect();
    let mut parts = RecordingParts {
        sensors: vec![SensorSettings::named("radar")],
        ..Default::default()
    };
    for number in 0..30 {
        let time_s = f64::from(number) * PERIOD_S;
        let mut places = Vec::new();
        for ((start_m, heading), speed_mps) in courses.iter().zip(speeds_mps) {
            if draw.next() < 0.9 {
                places.push(
                    start_m + Position::new(heading.cos(), heading.sin()) * (speed_mps * time_s),
                );
            }
        }
        let returns = (0..shore)
            .filter(|_| draw.next() < 0.5)
            .map(|index| Position::new(index as f64 * 150.0, 3e3))
            .collect::<Vec<_>>();
        places.extend(returns);
        places
            .iter_mut()
            .for_each(|place_m| *place_m += Position::new(draw.normal(), draw.normal()) * SIGMA_M);
        places.extend(
            (0..clutter)
                .map(|_| Position::new(draw.next(), draw.next()) * 20e3)
                .collect::<Vec<_>>(),
        );
        let detection = |place_m: &Position| Detection {
            measurement: Measurement::Position {
                x_m: place_m[0],
                y_m: place_m[1],
            },
            origin: None,
            amplitude: None,
        };
        parts
            .detection_ids
            .extend((0..places.len()).map(|index| index.to_string()));
        parts.scans.push(Scan {
            number,
            time_s,
            sensor: 0,
            pose: None,
            own: Vec::new(),
            detections: places.iter().map(detection).collect(),
        });
    }
    Recording::new(parts).unwrap()
}

fn seen(recording: &Recording) -> ApparentSpeed {
    let report = MeasurementModel::Position {
        sigma_x_m: SIGMA_M,
        sigma_y_m: SIGMA_M,
    };
    let sensor = Sensor {
        sensor_id: "radar".into(),
        p_d: 0.9,
        clutter_density: 1e-8,
        may_start: true,
        report,
        sight: None,
    };
    apparent_speed(recording, &[SensorSettings::named("radar")], &[sensor]).unwrap()
}

#[test]
fn the_fastest_targets_are_seen_among_slow_ones_and_clutter() {
    for clutter in [0, 20, 200] {
        for (speeds_mps, fastest_mps) in [
            (vec![70.0; 8], 70.0),
            (vec![250.0; 10], 250.0),
            ([[15.0; 20], [90.0; 20]].concat(), 90.0),
        ] {
            let seen = seen(&scene(&speeds_mps, clutter, 0));
            let found = seen.fastest_mps.unwrap_or(0.0);
            assert!(
                (found - fastest_mps).abs() < 0.15 * fastest_mps,
                "{clutter} false, {fastest_mps} m/s: {seen:?}"
            );
            assert_eq!(seen.noise_mps, SIGMA_M / PERIOD_S);
        }
    }
}

#[test]
fn a_shore_and_clutter_are_no_targets() {
    for (clutter, shore) in [(0, 60), (50, 100), (500, 0), (1000, 0), (300, 130)] {
        let seen = seen(&scene(&[], clutter, shore));
        assert!(
            seen.fastest_mps.is_none(),
            "{clutter} false, {shore} of a shore: {seen:?}"
        );
    }
    // Among so much clutter nobody sees 25 m/s, and that is known.
    assert!(seen(&scene(&[], 1000, 0)).is_hidden && !seen(&scene(&[], 50, 0)).is_hidden);
    let with_boats = seen(&scene(&[12.0; 6], 20, 100));
    assert!(
        with_boats
            .fastest_mps
            .is_none_or(|found| (found - 12.0).abs() < 3.0),
        "{with_boats:?}"
    );
}

#[test]
fn targets_that_stand_still_have_the_speed_of_noise() {
    let seen = seen(&scene(&[0.0; 20], 5, 0));
    assert_eq!((seen.fastest_mps, seen.noise_mps), (None, 2.5));
}

#[test]
fn three_scans_are_the_least() {
    let whole = scene(&[100.0; 4], 0, 0).into_parts();
    let cut = |scans: usize| {
        let seen = whole.scans[..scans].iter();
        let count: usize = seen.map(|scan| scan.detections.len()).sum();
        let parts = RecordingParts {
            sensors: whole.sensors.clone(),
            scans: whole.scans[..scans].to_vec(),
            detection_ids: whole.detection_ids[..count].to_vec(),
            ..Default::default()
        };
        Recording::new(parts).unwrap()
    };
    let report = MeasurementModel::Position {
        sigma_x_m: SIGMA_M,
        sigma_y_m: SIGMA_M,
    };
    let sensors = [Sensor {
        sensor_id: "radar".into(),
        p_d: 0.9,
        clutter_density: 1e-8,
        may_start: true,
        report,
        sight: None,
    }];
    let known = [SensorSettings::named("radar")];
    assert_eq!(apparent_speed(&cut(2), &known, &sensors), None);
    let three = apparent_speed(&cut(3), &known, &sensors).and_then(|seen| seen.fastest_mps);
    assert!(
        three.is_some_and(|found| (found - 100.0).abs() < 15.0),
        "{three:?}"
    );
}
