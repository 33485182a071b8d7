//! Truth and tracks that are directions: values, round trips, and what is wrong with broken ones.

use super::*;
use std::f64::consts::PI;
use trackloom_domain::model::space::Space;
use trackloom_domain::model::truth::TruthPoint;

fn survives(dataset: &Dataset) {
    for name in ["csv", "json"] {
        let mut bytes = Vec::new();
        match name {
            "csv" => trackloom_domain::formats::write_csv(dataset, &mut bytes),
            _ => trackloom_domain::formats::write_json(dataset, &mut bytes),
        }
        .expect("written to memory");
        let again = read(name, String::from_utf8(bytes).expect("text"))
            .expect("what was written is sound")
            .dataset;
        assert_eq!(&again, dataset, "{name}");
    }
}

#[test]
fn tracks_of_bearings_are_read_in_degrees_and_survive() {
    let text = "time_s,track_id,sensor_id,bearing_deg,bearing_rate_degps,p_bb,p_bbr,p_brbr,detection_id,probability,status\n\
                0,1,sonar,180,-1.8,3.24,0.1,0.0324,d1,1,confirmed\n1,1,sonar,359.9,,,,,,1,coasted\n0,2,sonar,0.7,0,1,0,1,d2,0.5,tentative\n";
    let outcome = read("csv", text).expect("sound");
    assert_eq!(outcome.warnings, Vec::<String>::new());
    survives(&outcome.dataset);
    let set = tracks(outcome);
    assert_eq!(set.space, Space::Bearing);
    let first = &set.tracks[0].points[0].estimate;
    assert!(
        (first.position.x - PI).abs() < 1e-15
            && (first.velocity.unwrap().x + PI / 100.0).abs() < 1e-15
    );
    let covariance = first.covariance::<2>().expect("given");
    assert!(
        (covariance[(0, 0)] - (PI / 100.0).powi(2)).abs() < 1e-15
            && (covariance[(1, 1)] - (PI / 1000.0).powi(2)).abs() < 1e-15
    );
    assert!(
        covariance[(0, 1)] == covariance[(1, 0)]
            && (covariance[(0, 1)] - 0.1 * (PI / 180.0).powi(2)).abs() < 1e-18
    );
    let second = &set.tracks[0].points[1].estimate;
    assert_eq!((second.velocity, &second.covariance), (None, &None));
}

#[test]
fn truth_of_bearings_is_read_in_degrees_and_survives() {
    let outcome = read(
        "csv",
        "time_s,truth_id,bearing_deg\n0,a,270\n1,a,271.3\n0,b,90\n",
    )
    .expect("sound");
    survives(&outcome.dataset);
    let truth = truth(outcome);
    assert_eq!(truth.space(), Space::Bearing);
    assert_eq!(
        truth.targets()[0].points[0],
        TruthPoint::at_bearing(0.0, 270f64.to_radians())
    );
}

#[test]
fn a_file_with_both_is_of_places_and_says_so() {
    for text in [
        "time_s,track_id,x_m,y_m,bearing_deg\n0,1,1,2,45\n",
        "time_s,truth_id,x_m,y_m,bearing_deg\n0,1,1,2,45\n",
    ] {
        let outcome = read("csv", text).expect("sound");
        assert_eq!(
            outcome.warnings,
            ["columns kept in the file but not used: bearing_deg"]
        );
    }
}

#[test]
fn what_is_wrong_with_a_bearing_is_named_by_its_line() {
    let faults = read(
        "csv",
        "time_s,track_id,bearing_deg,p_bb,p_bbr,p_brbr,detection_id\n0,1,x,1,0,1,a\n1,1,,1,,1,a\n2,1,5,1,0,1,a\n2,1,6,1,0,1,b\n",
    )
    .expect_err("three broken lines");
    assert_eq!(
        faults,
        [
            at(
                2,
                "bearing_deg",
                "malformed",
                "expected a number, found 'x'"
            ),
            at(3, "bearing_deg", "missing", "'bearing_deg' is empty"),
            at(3, "p_bbr", "missing", "'p_bbr' is empty"),
            at(
                5,
                "bearing_deg",
                "conflict",
                "track '1' at 2 s is at another position on line 4"
            ),
        ]
    );
    assert_eq!(
        fault("csv", "time_s,truth_id,bearing_deg\n0,a,1e400\n"),
        at(
            2,
            "bearing_deg",
            "not_finite",
            "'1e400' is not a finite number"
        )
    );
    let known = "time_s, track_id, bearing_deg, sensor_id, bearing_rate_degps, p_bb, p_bbr, p_brbr, detection_id, probability, status, nis, known_at_s, existence, lat_deg, lon_deg, height_m, speed_mps, course_deg, time_base, address, callsign, mode_a, mode_c_ft, position_accuracy_m, mmsi, ship_name, ship_type, track_number, on_ground, report_kind";
    assert_eq!(
        fault("csv", "time_s,track_id,bearing_deg,p_bb,p_brbr\n"),
        at(
            1,
            "p_bbr",
            "missing",
            "column 'p_bbr' is missing: p_bb, p_bbr, p_brbr come together"
        )
        .allowing(known)
    );
    assert_eq!(
        fault("csv", "time_s,track_id,bearing_deg,x_m\n0,1,2,3\n")
            .column
            .as_deref(),
        Some("y_m"),
        "half a place is a place with a hole"
    );
}
