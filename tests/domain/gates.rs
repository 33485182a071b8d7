//! Gates of finished jobs, computed once more from the tracks: they are those in which the tracker looked.

use nalgebra::Vector2;
use serde_json::{Value, json};
use trackloom_domain::experiment::gates::{Gate, Region, compute_gates};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, JobKind, plan, presets};
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::model::dataset::Dataset;
use trackloom_domain::model::scan::{Measurement, Recording};
use trackloom_domain::model::sensor::SensorSettings;
use trackloom_domain::model::track::{TrackPoint, TrackSet};

struct Done {
    spec: Value,
    recording: Recording,
    sensors: Vec<SensorSettings>,
    tracks: TrackSet,
}

/// A preset with some members replaced, tracked; its data as read from the files of the job.
fn done(preset: &str, changes: Value) -> Done {
    let mut body = presets::find(preset).unwrap().body;
    for (pointer, value) in changes.as_object().unwrap() {
        let (part, member) = pointer.split_once('/').unwrap_or((pointer, ""));
        *(if member.is_empty() {
            &mut body[part]
        } else {
            &mut body[part][member]
        }) = value.clone();
    }
    let plan = plan(JobKind::Evaluate, &body).unwrap_or_else(|faults| panic!("{faults:?}"));
    let artifacts = experiment::run(&plan, vec![], &mut Silent)
        .unwrap()
        .artifacts;
    let read = |name: &str| {
        let artifact = artifacts
            .iter()
            .find(|artifact| artifact.name == name)
            .unwrap();
        let dataset = (format_named("csv").unwrap().read)(
            &mut artifact.bytes.as_slice(),
            &ReadOptions::default(),
        )
        .unwrap()
        .dataset;
        (dataset, artifact.sensors.clone())
    };
    let (Dataset::Detections(recording), sensors) = read("detections.csv") else {
        panic!("not detections")
    };
    let (Dataset::Tracks(tracks), _) = read("tracks.csv") else {
        panic!("not tracks")
    };
    Done {
        spec: plan.spec,
        recording,
        sensors,
        tracks,
    }
}

/// d² of the detection that a point was given, from the gate alone.
fn squared_distance(gate: &Gate, done: &Done, point: &TrackPoint) -> Option<f64> {
    let detection = done
        .tracks
        .candidates_of(point)
        .iter()
        .find_map(|candidate| candidate.detection)?;
    let id = &done.tracks.detection_ids[detection as usize];
    let index = done
        .recording
        .detection_ids
        .iter()
        .position(|known| known == id)
        .unwrap();
    let detection = done.recording.index_detections().get(index)?;
    let (innovation, covariance) = match (gate.region, detection.measurement) {
        (Region::Plane { covariance_m2 }, Measurement::Position { x_m, y_m }) => {
            (Vector2::new(x_m, y_m) - gate.place_m, covariance_m2)
        }
        (
            Region::Polar {
                range_m,
                bearing_rad,
                covariance,
                ..
            },
            Measurement::RangeBearing {
                range_m: seen_m,
                bearing_rad: seen_rad,
                ..
            },
        ) => {
            let turn = (seen_rad - bearing_rad)
                .sin()
                .atan2((seen_rad - bearing_rad).cos());
            (Vector2::new(seen_m - range_m, turn), covariance)
        }
        other => panic!("{other:?}"),
    };
    Some((innovation.transpose() * covariance.try_inverse().unwrap() * innovation)[0])
}

/// Compares every gate with the distance that the tracker wrote down; answers how many there were, and how many were empty.
fn assert_gates_are_the_tracker_s(done: &Done, threshold: f64) -> (usize, usize) {
    let found = compute_gates(
        &done.spec,
        (&done.recording, &done.sensors),
        &done.tracks,
        |_| true,
    )
    .unwrap();
    assert!(
        (found.threshold - threshold).abs() < 1e-9,
        "{}",
        found.threshold
    );
    let (mut compared, mut empty) = (0, 0);
    for gate in &found.gates {
        let track = done
            .tracks
            .tracks
            .iter()
            .find(|track| track.track_id == gate.track_id)
            .unwrap();
        let point = track
            .points
            .iter()
            .find(|point| point.time_s == gate.time_s)
            .unwrap();
        match squared_distance(gate, done, point) {
            Some(squared) => {
                let nis = point.nis.unwrap();
                assert!(
                    (squared - nis).abs() < 1e-6 * (1.0 + nis),
                    "track {} at {}: {squared} for {nis}",
                    gate.track_id,
                    gate.time_s
                );
                assert!(squared <= threshold);
                compared += 1;
            }
            None => empty += 1,
        }
    }
    let updated = done
        .tracks
        .tracks
        .iter()
        .flat_map(|track| &track.points)
        .filter(|point| point.nis.is_some())
        .count();
    assert_eq!(compared, updated, "every update has a gate");
    (compared, empty)
}

#[test]
fn the_compute_gates_positions_are_those_of_the_tracker() {
    let done = done(
        "liang2009-30",
        json!({"associator": {"method": "nearest_neighbour"}, "tracker/gate_probability": 0.99}),
    );
    let (compared, empty) = assert_gates_are_the_tracker_s(&done, -2.0 * 0.01f64.ln());
    assert!(
        compared > 200 && empty > 5,
        "{compared} compared, {empty} empty"
    );
}

#[test]
fn the_compute_gates_ranges_and_bearings_are_those_of_the_tracker() {
    for filter in ["extended", "unscented"] {
        let changes = json!({
            "associator": {"method": "nearest_neighbour"}, "filter": {"method": filter}, "tracker/gate_probability": 0.99
        });
        let (compared, _) = assert_gates_are_the_tracker_s(
            &done("liang2009-polar-30", changes),
            -2.0 * 0.01f64.ln(),
        );
        assert!(compared > 200, "{filter}: {compared} compared");
    }
}

#[test]
fn a_job_that_did_not_gate_in_the_plane_has_no_gates() {
    let has_gates = |preset: &str, changes: Value| {
        let done = done(preset, changes);
        compute_gates(
            &done.spec,
            (&done.recording, &done.sensors),
            &done.tracks,
            |_| true,
        )
        .is_some()
    };
    assert!(has_gates("liang2009-10", json!({})));
    assert!(!has_gates(
        "liang2009-10",
        json!({"associator": {"method": "oracle"}})
    ));
    assert!(!has_gates(
        "liang2009-10",
        json!({"tracker/gate_probability": 1.0, "associator": {"method": "nearest_neighbour"}})
    ));
    assert!(!has_gates("wang-bat-record", json!({})));
}

/// In space a gate is drawn as its shadow on the ground.
#[test]
fn gates_of_space_are_drawn_on_the_ground() {
    let done = done("two-radars", json!({}));
    let known = (&done.recording, &done.sensors[..]);
    let found = compute_gates(&done.spec, known, &done.tracks, |_| true).unwrap();
    // χ² of three values at 0.99999.
    assert!(
        (found.threshold - 25.901_750).abs() < 1e-3,
        "{}",
        found.threshold
    );
    let track = done
        .tracks
        .tracks
        .iter()
        .max_by_key(|track| track.points.len());
    let track = track.unwrap();
    let gates: Vec<&Gate> = found
        .gates
        .iter()
        .filter(|gate| gate.track_id == track.track_id)
        .collect();
    assert!(gates.len() > 150, "{}", gates.len());
    for gate in gates {
        let Region::Plane { covariance_m2 } = gate.region else {
            panic!("{:?}", gate.region)
        };
        let point = track.points.iter().find(|point| {
            point.time_s == gate.time_s
                && point
                    .sensor
                    .is_some_and(|sensor| done.tracks.sensor_ids[sensor as usize] == gate.sensor_id)
        });
        let off_m = point.unwrap().estimate.position_m() - gate.place_m;
        let squared = (off_m.transpose() * covariance_m2.try_inverse().unwrap() * off_m)[0];
        assert!(squared < found.threshold, "{squared} at {}", gate.time_s);
    }
}
