//! Files with a third coordinate: values, what of the plane is not read in them, and what is wrong with broken ones.

use super::*;
use nalgebra::SMatrix;
use trackloom_domain::model::scan::Measurement;
use trackloom_domain::model::space::{Place, Space};

const COVARIANCE: &str = "p_xx,p_xy,p_xz,p_xvx,p_xvy,p_xvz,p_yy,p_yz,p_yvx,p_yvy,p_yvz,p_zz,p_zvx,p_zvy,p_zvz,p_vxvx,p_vxvy,p_vxvz,p_vyvy,p_vyvz,p_vzvz";

#[test]
fn truth_with_a_z_is_of_a_volume() {
    let text =
        "time_s,truth_id,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps\n0,A,1,2,-3,4,5,-6\n1,A,5,7,-9,,,\n";
    let outcome = read("csv", text).expect("sound");
    assert_eq!(outcome.warnings, Vec::<String>::new());
    let truth = truth(outcome);
    assert_eq!(truth.space(), Space::Volume);
    let [first, second] = truth.targets()[0].points.as_slice() else {
        panic!("two points")
    };
    assert_eq!(first.position, Place::new(1.0, 2.0, -3.0));
    assert_eq!(first.velocity, Some(Place::new(4.0, 5.0, -6.0)));
    assert_eq!(
        (second.position, second.velocity),
        (Place::new(5.0, 7.0, -9.0), None)
    );
}

/// 21 different numbers, dominated by the diagonal; the matrix is written out here by hand.
#[test]
fn a_covariance_of_six_variables_is_read_in_the_order_of_the_field() {
    let text = format!(
        "time_s,track_id,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,{COVARIANCE}\n0,1,1,2,3,4,5,6,101,1,2,3,4,5,102,6,7,8,9,103,10,11,12,104,13,14,105,15,106\n"
    );
    let set = tracks(read("csv", text).expect("sound"));
    assert_eq!(set.space, Space::Volume);
    let estimate = &set.tracks[0].points[0].estimate;
    #[rustfmt::skip]
    let wanted = SMatrix::<f64, 6, 6>::from_row_slice(&[
        101.0, 1.0, 2.0, 3.0, 4.0, 5.0,
        1.0, 102.0, 6.0, 7.0, 8.0, 9.0,
        2.0, 6.0, 103.0, 10.0, 11.0, 12.0,
        3.0, 7.0, 10.0, 104.0, 13.0, 14.0,
        4.0, 8.0, 11.0, 13.0, 105.0, 15.0,
        5.0, 9.0, 12.0, 14.0, 15.0, 106.0,
    ]);
    assert_eq!(estimate.covariance::<6>(), Some(wanted));
    #[rustfmt::skip]
    let marginal = SMatrix::<f64, 4, 4>::from_row_slice(&[
        101.0, 1.0, 3.0, 4.0,
        1.0, 102.0, 7.0, 8.0,
        3.0, 7.0, 104.0, 13.0,
        4.0, 8.0, 13.0, 105.0,
    ]);
    let plane = set.clone().into_plane();
    let flat = &plane.tracks[0].points[0].estimate;
    assert_eq!(
        (plane.space, flat.covariance()),
        (Space::Plane, Some(marginal))
    );
    assert_eq!(flat.position, Place::new(1.0, 2.0, 0.0));
    assert_eq!(flat.velocity, Some(Place::new(4.0, 5.0, 0.0)));
}

#[test]
fn what_is_of_the_plane_is_not_read_into_a_volume_and_is_named() {
    let planar = "p_xx,p_xy,p_xvx,p_xvy,p_yy,p_yvx,p_yvy,p_vxvx,p_vxvy,p_vyvy";
    let text = format!(
        "time_s,track_id,x_m,y_m,z_m,vx_mps,vy_mps,{planar}\n0,1,1,2,3,4,5,1,0,0,0,1,0,0,1,0,1\n"
    );
    let outcome = read("csv", text).expect("sound");
    let warning = |names: &str| {
        format!(
            "z_m makes these places those of a volume, but {names} are of the plane, so they are not read; without z_m all is of the plane"
        )
    };
    assert_eq!(
        outcome.warnings,
        [warning("vx_mps … vy_mps"), warning("p_xx … p_vyvy")]
    );
    let set = tracks(outcome);
    let estimate = &set.tracks[0].points[0].estimate;
    assert_eq!(set.space, Space::Volume);
    assert_eq!((estimate.velocity, &estimate.covariance), (None, &None));
}

#[test]
fn a_covariance_of_a_volume_is_whole_or_absent() {
    let faults = read(
        "csv",
        format!(
            "time_s,track_id,x_m,y_m,z_m,{}\n",
            &COVARIANCE[..COVARIANCE.len() - 7]
        ),
    )
    .expect_err("one column is missing");
    let named: Vec<_> = faults.iter().map(|fault| fault.column.as_deref()).collect();
    assert_eq!(named, [Some("p_vzvz")]);
    let faults = read("csv", "time_s,truth_id,x_m,y_m,z_m,vx_mps,vz_mps\n").expect_err("no vy_mps");
    assert_eq!(faults.len(), 1);
    assert_eq!(
        faults[0].detail,
        "column 'vy_mps' is missing: vx_mps, vy_mps, vz_mps come together"
    );
    // Definite in each pair, not in three: correlations of -0.6 each.
    let cells = "1,-0.6,-0.6,0,0,0,1,-0.6,0,0,0,1,0,0,0,1,0,0,1,0,1";
    let text = format!("time_s,track_id,x_m,y_m,z_m,{COVARIANCE}\n0,1,1,2,3,{cells}\n");
    let found = fault("csv", text);
    assert_eq!(
        (found.code.as_str(), found.column.as_deref()),
        ("out_of_range", Some("p_xx"))
    );
}

#[test]
fn half_a_place_is_a_place_with_a_hole() {
    assert_eq!(
        fault("csv", "time_s,truth_id,x_m,y_m,z_m\n0,A,1,2,\n"),
        at(2, "z_m", "missing", "'z_m' is empty")
    );
    assert_eq!(
        fault("csv", "time_s,truth_id,x_m,z_m\n0,A,1,2\n")
            .column
            .as_deref(),
        Some("y_m")
    );
}

#[test]
fn detections_keep_their_third_coordinate_where_they_have_one() {
    let text = "time_s,scan,sensor_id,detection_id,x_m,y_m,z_m\n0,1,s,a,1,2,30\n0,1,r,b,3,4,\n1,2,r,,,,\n1,2,s,c,5,6,-70\n1,2,s,d,7,8,90\n";
    let outcome = read("csv", text).expect("sound");
    assert_eq!(outcome.warnings, Vec::<String>::new());
    let recording = recording(outcome);
    assert!(recording.is_in_volume());
    // In order of time and sensor, as the detections are.
    assert_eq!(recording.detection_ids, ["b", "a", "c", "d"]);
    assert_eq!(recording.z_m(), [None, Some(30.0), Some(-70.0), Some(90.0)]);
    let first = recording.detections().next().expect("four detections");
    assert_eq!(
        first.measurement,
        Measurement::Position { x_m: 3.0, y_m: 4.0 }
    );
    let own = |id: &str| {
        recording
            .only_sensors(&[id.to_owned()])
            .expect("known")
            .z_m()
    };
    assert_eq!(own("s"), [Some(30.0), Some(-70.0), Some(90.0)]);
    assert_eq!(own("r"), [], "of this sensor nothing has a height");
}

#[test]
fn a_column_of_heights_without_a_height_is_of_the_plane() {
    let text = "time_s,scan,sensor_id,detection_id,x_m,y_m,z_m\n0,1,s,a,1,2,\n";
    assert!(!recording(read("csv", text).expect("sound")).is_in_volume());
    let broken = "time_s,scan,sensor_id,detection_id,x_m,y_m,z_m\n0,1,s,a,1,2,high\n";
    assert_eq!(
        fault("csv", broken),
        at(2, "z_m", "malformed", "expected a number, found 'high'")
    );
}
