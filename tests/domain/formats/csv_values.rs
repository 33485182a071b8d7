//! What sound CSV becomes: every value by hand.

use super::*;
use std::f64::consts::FRAC_PI_2;
use trackloom_domain::model::own::{Own, OwnNoise};
use trackloom_domain::model::scan::{Detection, Measurement, Scan};
use trackloom_domain::model::space::Place;
use trackloom_domain::model::state::State;
use trackloom_domain::model::track::{Candidate, TrackStatus};

fn position(x_m: f64, y_m: f64, origin: Option<u32>) -> Detection {
    Detection {
        measurement: Measurement::Position { x_m, y_m },
        origin,
        amplitude: None,
    }
}

#[test]
fn one_sensor_keeps_its_scan_numbers_and_empty_scans() {
    let text = "time_s,scan,sensor_id,detection_id,x_m,y_m,truth_id\n0,7,r,a,1,2,10\n0,7,r,b,3,4,\n2,9,r,,,,\n3,10,r,a,5,6,9\n";
    let outcome = read("csv", text).expect("the file is sound");
    assert_eq!(outcome.warnings, Vec::<String>::new());
    let recording = recording(outcome);
    assert!(recording.origins_known);
    assert_eq!(recording.targets, ["9", "10"]);
    assert_eq!(recording.detection_ids, ["a", "b", "a"]);
    let scan = |number, time_s, detections: &[Detection]| Scan {
        number,
        time_s,
        sensor: 0,
        pose: None,
        own: Vec::new(),
        detections: detections.to_vec(),
    };
    let two = [position(1.0, 2.0, Some(1)), position(3.0, 4.0, None)];
    assert_eq!(
        recording.scans,
        [
            scan(7, 0.0, &two),
            scan(9, 2.0, &[]),
            scan(10, 3.0, &[position(5.0, 6.0, Some(0))])
        ]
    );
}

#[test]
fn several_sensors_are_sorted_and_their_scans_keep_their_numbers() {
    let text = "time_s,scan,sensor_id,detection_id,x_m,y_m\n\
                0,4,s10,a,1,1\n0,4,s2,a,2,2\n0,4,s10,b,3,3\n1,5,s10,,,\n2,5,s2,c,4,4\n";
    let recording = recording(read("csv", text).expect("the file is sound"));
    let names: Vec<&str> = recording
        .sensors
        .iter()
        .map(|sensor| sensor.sensor_id.as_str())
        .collect();
    assert_eq!(names, ["s2", "s10"]);
    let at = |value| position(value, value, None);
    let scan = |number, time_s, sensor, detections: &[Detection]| Scan {
        number,
        time_s,
        sensor,
        pose: None,
        own: Vec::new(),
        detections: detections.to_vec(),
    };
    assert_eq!(
        recording.scans,
        [
            scan(4, 0.0, 0, &[at(2.0)]),
            scan(4, 0.0, 1, &[at(1.0), at(3.0)]),
            scan(5, 1.0, 1, &[]),
            scan(5, 2.0, 0, &[at(4.0)])
        ]
    );
    assert_eq!(recording.detection_ids, ["a", "a", "b", "c"]);
    assert!(!recording.origins_known);
}

#[test]
fn measurements_may_be_polar_and_a_position_wins() {
    let text = "time_s,scan,sensor_id,detection_id,x_m,y_m,range_m,bearing_deg\n\
                0,1,r,a,,,100,90\n0,1,r,b,,,,-90\n0,1,r,c,1,2,100,90\n";
    let outcome = read("csv", text).expect("the file is sound");
    assert_eq!(
        outcome.warnings,
        ["rows have x_m, y_m and also range_m or bearing_deg: the position is used"]
    );
    let found: Vec<Measurement> = recording(outcome)
        .detections()
        .map(|detection| detection.measurement)
        .collect();
    let polar = Measurement::RangeBearing {
        range_m: 100.0,
        bearing_rad: FRAC_PI_2,
        range_rate_mps: None,
    };
    assert_eq!(
        found,
        [
            polar,
            Measurement::Bearing {
                bearing_rad: -FRAC_PI_2
            },
            Measurement::Position { x_m: 1.0, y_m: 2.0 }
        ]
    );
}

#[test]
fn ranges_may_have_rates() {
    let text = "time_s,scan,sensor_id,detection_id,range_m,bearing_deg,range_rate_mps\n0,1,r,a,100,90,-7.5\n0,1,r,b,50,-90,\n";
    let outcome = read("csv", text).expect("the file is sound");
    assert_eq!(outcome.warnings, Vec::<String>::new());
    let found: Vec<Measurement> = recording(outcome)
        .detections()
        .map(|detection| detection.measurement)
        .collect();
    let approaching = Measurement::RangeBearing {
        range_m: 100.0,
        bearing_rad: FRAC_PI_2,
        range_rate_mps: Some(-7.5),
    };
    let unknown = Measurement::RangeBearing {
        range_m: 50.0,
        bearing_rad: -FRAC_PI_2,
        range_rate_mps: None,
    };
    assert_eq!(found, [approaching, unknown]);
}

#[test]
fn amplitudes_are_read_where_there_are_any() {
    let text =
        "time_s,scan,sensor_id,detection_id,x_m,y_m,amplitude\n0,1,r,a,1,2,17.5\n0,1,r,b,3,4,\n";
    let outcome = read("csv", text).expect("the file is sound");
    assert_eq!(outcome.warnings, Vec::<String>::new());
    let found = Detection {
        amplitude: Some(17.5),
        ..position(1.0, 2.0, None)
    };
    assert_eq!(
        recording(outcome).scans[0].detections,
        [found, position(3.0, 4.0, None)]
    );
}

#[test]
fn columns_are_renamed_and_others_reported() {
    let columns = [("t", "time_s"), ("east", "x_m"), ("north", "y_m")];
    let options = ReadOptions {
        columns: columns
            .map(|(from, to)| (from.to_owned(), to.to_owned()))
            .into(),
        ..Default::default()
    };
    let text = "\u{feff}t, scan ,sensor_id,detection_id,east,north,sigma_x_m,elevation_deg,colour\r\n1,1,r,a,2,3,1,1,red\r\n";
    let outcome = read_with("csv", text, &options).expect("the file is sound");
    assert_eq!(
        outcome.warnings,
        ["unknown columns, kept in the file but not used: colour"]
    );
    assert_eq!(
        recording(outcome).scans[0].detections,
        [position(2.0, 3.0, None)]
    );
}

#[test]
fn a_header_alone_is_an_empty_dataset() {
    for (header, kind) in [
        (
            "time_s,scan,sensor_id,detection_id,bearing_deg",
            DatasetKind::Detections,
        ),
        ("time_s,truth_id,x_m,y_m\n", DatasetKind::Truth),
        ("time_s,track_id,x_m,y_m\r\n", DatasetKind::Tracks),
    ] {
        let outcome = read("csv", header).expect("the header is sound");
        assert_eq!(
            outcome.warnings,
            [format!(
                "there are columns of {} but no rows: the dataset is empty",
                kind.name()
            )]
        );
        assert_eq!(
            (outcome.dataset.kind(), outcome.dataset.summary().rows),
            (kind, 0)
        );
    }
}

#[test]
fn a_kind_that_is_given_is_not_guessed() {
    let text = "time_s,truth_id,x_m,y_m,scan,sensor_id,detection_id\n0,A,1,2,1,r,a\n";
    assert_eq!(
        read("csv", text).expect("sound").dataset.kind(),
        DatasetKind::Detections
    );
    assert_eq!(
        read_with("csv", text, &of_kind(DatasetKind::Truth))
            .expect("sound")
            .dataset
            .kind(),
        DatasetKind::Truth
    );
}

#[test]
fn truth_may_be_interleaved() {
    let text = "time_s,truth_id,x_m,y_m,bearing_deg,vx_mps,vy_mps\n0,10,1,2,0,,\n0,9,3,4,0,5,6\n1,10,7,8,0,0.5,-0.5\n";
    let outcome = read("csv", text).expect("the file is sound");
    assert_eq!(
        outcome.warnings,
        ["columns kept in the file but not used: bearing_deg"]
    );
    let truth = truth(outcome);
    let [nine, ten] = truth.targets() else {
        panic!("two targets")
    };
    assert_eq!((nine.truth_id.as_str(), ten.truth_id.as_str()), ("9", "10"));
    assert_eq!(nine.points[0].velocity, Some(Place::new(5.0, 6.0, 0.0)));
    assert_eq!(ten.points[0].velocity, None);
    assert_eq!(
        (ten.points[1].time_s, ten.points[1].position),
        (1.0, Place::new(7.0, 8.0, 0.0))
    );
}

#[test]
fn rows_of_one_track_and_time_are_candidates() {
    let text = "time_s,track_id,sensor_id,x_m,y_m,vx_mps,vy_mps,detection_id,probability,status\n\
                0,B,r,1,2,3,4,d7,0.75,confirmed\n0,A,r,5,6,,,,1,tentative\n0,B,r,1,2,3,4,,0.25,confirmed\n0,B,q,1,2,3,4,d7,1,\n1,A,r,5,6,,,,,coasted\n";
    let set = tracks(read("csv", text).expect("the file is sound"));
    let [a, b] = set.tracks.as_slice() else {
        panic!("two tracks")
    };
    assert_eq!((a.track_id.as_str(), b.track_id.as_str()), ("A", "B"));
    assert_eq!(set.sensor_ids, ["q", "r"]);
    assert_eq!(set.detection_ids, ["d7"]);
    let candidate = |detection, probability| Candidate {
        detection,
        probability,
    };
    assert_eq!(set.candidates_of(&a.points[0]), [candidate(None, 1.0)]);
    assert_eq!(set.candidates_of(&a.points[1]), []);
    assert_eq!(
        set.candidates_of(&b.points[0]),
        [candidate(Some(0), 0.75), candidate(None, 0.25)]
    );
    assert_eq!(set.candidates_of(&b.points[1]), [candidate(Some(0), 1.0)]);
    assert_eq!((b.points[0].sensor, b.points[1].sensor), (Some(1), Some(0)));
    assert_eq!(
        (
            b.points[0].estimate.state(),
            b.points[0].estimate.velocity.is_some()
        ),
        (State::new(1.0, 2.0, 3.0, 4.0), true)
    );
    assert!(a.points[0].estimate.velocity.is_none());
    assert_eq!(
        (a.points[1].status, b.points[1].status),
        (Some(TrackStatus::Coasted), None)
    );
}

#[test]
fn a_covariance_is_symmetric() {
    let text = "time_s,track_id,x_m,y_m,p_xx,p_xy,p_xvx,p_xvy,p_yy,p_yvx,p_yvy,p_vxvx,p_vxvy,p_vyvy\n0,T,1,2,110,12,13,14,220,23,24,330,34,440\n1,T,1,2,,,,,,,,,,\n";
    let set = tracks(read("csv", text).expect("the file is sound"));
    let covariance = set.tracks[0].points[0]
        .estimate
        .covariance::<4>()
        .expect("the first point has one");
    assert_eq!(
        (
            covariance[(0, 3)],
            covariance[(3, 0)],
            covariance[(2, 1)],
            covariance[(2, 2)]
        ),
        (14.0, 14.0, 23.0, 330.0)
    );
    assert_eq!(set.tracks[0].points[1].estimate.covariance, None);
    assert_eq!(set.candidates.len(), 0);
}

#[test]
fn detections_have_noises_times_and_velocities_of_their_own() {
    let text = "time_s,scan,sensor_id,detection_id,x_m,y_m,sigma_x_m,sigma_y_m,correlation_xy,vx_mps,vy_mps,speed_mps,course_deg\n\
                0,1,r,a,1,2,3,4,-0.5,5,6,,\n1,1,r,b,3,4,,,,,,2,90\n5,2,r,c,5,6,,,,,,,\n";
    let outcome = read("csv", text).expect("the file is sound");
    assert_eq!(outcome.warnings, Vec::<String>::new());
    let recording = recording(outcome);
    assert_eq!(recording.scans[0].time_s, 0.5);
    let noise = OwnNoise {
        sigma_x_m: Some(3.0),
        sigma_y_m: Some(4.0),
        correlation_xy: Some(-0.5),
        ..OwnNoise::default()
    };
    let [first, second] = recording.scans[0].own[..] else {
        panic!("{:?}", recording.scans[0].own)
    };
    let wanted = Own {
        after_s: -0.5,
        noise,
        velocity_mps: Some([5.0, 6.0]),
    };
    assert_eq!(first, wanted);
    let [east, north] = second.velocity_mps.unwrap();
    assert_eq!(
        (second.after_s, second.noise, east),
        (0.5, OwnNoise::default(), 2.0)
    );
    assert!(north.abs() < 1e-15, "{north}");
    assert_eq!(recording.scans[1].own, []);
}

#[test]
fn polar_noises_are_in_degrees() {
    let text = "time_s,scan,sensor_id,detection_id,range_m,bearing_deg,sigma_range_m,sigma_bearing_deg\n0,1,r,a,100,10,7,90\n";
    let recording = recording(read("csv", text).expect("the file is sound"));
    let noise = recording.scans[0].own[0].noise;
    assert_eq!(
        (noise.sigma_range_m, noise.sigma_bearing_rad),
        (Some(7.0), Some(FRAC_PI_2))
    );
}
