//! Scans of a sensor that moves: each says where the sensor is, and is seen from there.

use serde_json::json;
use trackloom_domain::association::ASSOCIATORS;
use trackloom_domain::filtering::AnyFilter;
use trackloom_domain::hypotheses::certain;
use trackloom_domain::math::rng::Seed;
use trackloom_domain::model::pose::Pose;
use trackloom_domain::model::scan::{Detection, Measurement, Recording, RecordingParts, Scan};
use trackloom_domain::model::sensing::{Bearing, MeasurementModel, Platform, Polar};
use trackloom_domain::model::sensor::{Sensor, SensorSettings};
use trackloom_domain::model::space::Place;
use trackloom_domain::model::state::{GaussianState, Position};
use trackloom_domain::model::watch::Watch;
use trackloom_domain::registry;
use trackloom_domain::tracking::{
    GivenTrack, History, Initiation, Lifecycle, TRACKERS, TrackerParts,
};

const SCANS: usize = 40;

/// Where the target is at a scan, one a second.
fn target_m(scan: usize) -> Position {
    Position::new(100.0 + 5.0 * scan as f64, 800.0 - 3.0 * scan as f64)
}

/// Where the camera is: on a line from west to east and back, for one on a straight course never learns how far the target is.
fn camera_m(scan: usize) -> Position {
    let way = scan.min(SCANS - scan);
    Position::new(-500.0 + 60.0 * way as f64, 0.0)
}

/// A scan of a camera that sees the target exactly.
fn scan_of(index: usize, sensor: usize, pose: Option<Pose>) -> Scan {
    let offset_m = target_m(index) - camera_m(index);
    let bearing_rad = offset_m.x.atan2(offset_m.y);
    Scan {
        number: index as u32 + 1,
        time_s: index as f64,
        sensor,
        pose,
        own: Vec::new(),
        detections: vec![Detection {
            measurement: Measurement::Bearing { bearing_rad },
            origin: None,
            amplitude: None,
        }],
    }
}

fn pose_at(place_m: Position) -> Pose {
    Pose::at(place_m.push(20.0))
}

fn camera_at(place_m: Position) -> Sensor {
    Sensor {
        sensor_id: format!("camera {}", place_m.x),
        p_d: 0.95,
        clutter_density: 0.01,
        may_start: false,
        report: MeasurementModel::Bearing(standing_bearing(place_m, 0.005)),
        sight: None,
    }
}

pub fn standing_bearing(place_m: Position, sigma_bearing_rad: f64) -> Bearing {
    Bearing {
        place_m,
        sigma_bearing_rad,
        platform: Platform::STANDING,
        range_prior: None,
    }
}

/// What is known of the target at the first scan: 80 m beside it, at rest.
fn first_guess() -> GaussianState {
    let mut guess = GaussianState {
        mean: target_m(0).push(0.0).push(0.0),
        covariance: nalgebra::Matrix4::from_diagonal(&[1e4, 1e4, 25.0, 25.0].into()),
    };
    guess.mean.x += 80.0;
    guess
}

fn extended() -> AnyFilter {
    let filters = trackloom_domain::filtering::FILTERS;
    let method = filters.iter().find(|method| method.name == "extended");
    let method = method.expect("it is in the table");
    let parameters = json!({"process_noise_m2ps3": 0.01});
    let parameters = registry::check(&parameters, method.parameters).unwrap();
    (method.build)(&parameters).unwrap()
}

/// The packed kinematics of the one track after each scan.
fn tracked(sensors: Vec<Sensor>, scans: &[Scan]) -> Vec<Vec<f64>> {
    let method = &ASSOCIATORS[0];
    let parameters = registry::check(&json!({}), method.parameters).unwrap();
    let mut kinematics = Vec::new();
    first_guess().pack_into(&mut kinematics);
    let mut tracker = (TRACKERS[0].build)(TrackerParts {
        filter: extended(),
        associator: (method.build)(&parameters, Seed { seed: 1, run: 0 }).unwrap(),
        lifecycle: Lifecycle {
            initiation: Initiation::Truth {
                speed_sigma_mps: 5.0,
                rate_sigma_degps: 0.1,
            },
            ..serde_json::from_value(registry::check(&json!({}), TRACKERS[0].parameters).unwrap())
                .unwrap()
        },
        sensors,
        undetected: None,
        given: vec![GivenTrack {
            name: "boat".into(),
            origin: None,
            kinematics,
        }],
    });
    let mut history = History::default();
    let mut found = Vec::new();
    for scan in scans {
        tracker.step(scan, &mut history, &Watch::never()).unwrap();
        found.push(tracker.tracks()[0].kinematics.clone());
    }
    found
}

#[test]
fn a_camera_that_moves_is_as_many_cameras_that_stand() {
    let poses = |index| Some(pose_at(camera_m(index)));
    let moving: Vec<Scan> = (0..SCANS).map(|at| scan_of(at, 0, poses(at))).collect();
    let standing: Vec<Scan> = (0..SCANS).map(|at| scan_of(at, at, None)).collect();
    let cameras = (0..SCANS).map(|at| camera_at(camera_m(at))).collect();
    let found = tracked(vec![camera_at(Position::zeros())], &moving);
    assert_eq!(found, tracked(cameras, &standing));
    let last = found.last().unwrap();
    let error_m = Position::new(last[0], last[1]) - target_m(SCANS - 1);
    assert!(error_m.norm() < 5.0, "{error_m}");
    assert!(
        (last[2] - 5.0).abs() < 0.3 && (last[3] + 3.0).abs() < 0.3,
        "{last:?}"
    );
}

#[test]
fn the_track_is_that_of_updates_from_each_place() {
    use trackloom_domain::filtering::{Filter, WithFilter};
    struct Updates;
    impl WithFilter for Updates {
        type Output = Vec<f64>;

        fn in_plane<F: Filter<4>>(self, filter: F) -> Vec<f64> {
            let mut belief = filter.begin(&first_guess());
            for index in 0..SCANS {
                let dt_s = if index == 0 { 0.0 } else { 1.0 };
                F::predict(&filter.step(dt_s), &mut belief);
                let report = scan_of(index, 0, None).detections[0].measurement;
                let model = camera_at(camera_m(index)).report;
                certain::update(&filter, &model, &report, &mut belief).unwrap();
            }
            let mut packed = Vec::new();
            F::kinematics(&belief).pack_into(&mut packed);
            packed
        }

        fn in_volume<F: Filter<6>>(self, _filter: F) -> Vec<f64> {
            Vec::new()
        }

        fn of_bearings<F: Filter<2>>(self, _filter: F) -> Vec<f64> {
            Vec::new()
        }
    }
    let moving: Vec<Scan> = (0..SCANS)
        .map(|at| scan_of(at, 0, Some(pose_at(camera_m(at)))))
        .collect();
    let found = tracked(vec![camera_at(Position::zeros())], &moving);
    let wanted = extended().with(Updates);
    for (found, wanted) in found.last().unwrap().iter().zip(&wanted) {
        assert!(
            (found - wanted).abs() <= 1e-9 * wanted.abs().max(1.0),
            "{found} {wanted}"
        );
    }
}

#[test]
fn a_pose_moves_what_is_seen_from_a_place_and_nothing_else() {
    let pose = pose_at(Position::new(3.0, 4.0));
    let polar = Polar {
        place_m: Position::zeros(),
        sigma_range_m: 1.0,
        sigma_bearing_rad: 0.1,
        range_rate: None,
        platform: Platform::STANDING,
    };
    let moved = Polar {
        place_m: Position::new(3.0, 4.0),
        ..polar
    };
    for (model, wanted) in [
        (
            MeasurementModel::Polar(polar),
            MeasurementModel::Polar(moved),
        ),
        (
            MeasurementModel::Converted(polar),
            MeasurementModel::Converted(moved),
        ),
    ] {
        assert_eq!(model.seen_from(&pose), wanted);
    }
    let position = MeasurementModel::Position {
        sigma_x_m: 1.0,
        sigma_y_m: 2.0,
    };
    assert_eq!(position.seen_from(&pose), position);
}

#[test]
fn a_recording_keeps_poses_and_refuses_those_that_are_nowhere() {
    let parts = |up_m: f64| RecordingParts {
        sensors: ["camera", "other"].map(SensorSettings::named).to_vec(),
        scans: (0..4)
            .map(|at| {
                let place = Place::new(at as f64, 0.0, up_m);
                scan_of(at, at % 2, Some(Pose::at(place)))
            })
            .collect(),
        detection_ids: (0..4).map(|id| id.to_string()).collect(),
        ..Default::default()
    };
    let all = Recording::new(parts(20.0)).unwrap();
    let kept = all.only_sensors(&["other".to_owned()]).unwrap();
    let places: Vec<_> = kept
        .scans
        .iter()
        .map(|scan| scan.pose.map(|pose| pose.place.x))
        .collect();
    assert_eq!(places, [Some(1.0), Some(3.0)]);
    let faults = Recording::new(parts(f64::NAN)).unwrap_err();
    assert_eq!((faults.len(), faults[0].code.as_str()), (4, "not_finite"));
}

#[test]
fn a_detection_is_found_by_its_index_past_scans_that_saw_nothing() {
    let mut scans: Vec<Scan> = (0..6).map(|at| scan_of(at, 0, None)).collect();
    for empty in [0, 2, 3, 5] {
        scans[empty].detections.clear();
    }
    let recording = Recording::new(RecordingParts {
        sensors: vec![SensorSettings::named("camera")],
        detection_ids: vec!["a".into(), "b".into()],
        scans,
        ..Default::default()
    })
    .unwrap();
    let index = recording.index_detections();
    assert_eq!(index.get(0), Some(&recording.scans[1].detections[0]));
    assert_eq!(index.get(1), Some(&recording.scans[4].detections[0]));
    assert_eq!(index.get(2), None);
    let ranges = [0..0, 0..1, 1..1, 1..1, 1..2, 2..2];
    assert_eq!([0, 1, 2, 3, 4, 5].map(|scan| index.range(scan)), ranges);
}
