//! Columns that say where a sensor that moves is.

use super::*;
use trackloom_domain::formats::{write_csv, write_json};
use trackloom_domain::model::pose::Pose;

const ALL: &str = "\
time_s,scan,sensor_id,detection_id,bearing_deg,sensor_x_m,sensor_y_m,sensor_z_m,sensor_vx_mps,sensor_vy_mps,sensor_vz_mps,\
sensor_heading_deg,sensor_pitch_deg,sensor_roll_deg,sensor_sigma_x_m,sensor_sigma_y_m,sensor_sigma_z_m,sensor_sigma_vx_mps,\
sensor_sigma_vy_mps,sensor_sigma_vz_mps,sensor_sigma_heading_deg,sensor_sigma_pitch_deg,sensor_sigma_roll_deg
0,1,sonar,a,40,100,-200,3,4,5,6,30,5,-10,1,2,3,0.1,0.2,0.3,0.5,0.25,0.75
0,1,sonar,b,50,100,-200,3,4,5,6,30,5,-10,1,2,3,0.1,0.2,0.3,0.5,0.25,0.75
1,2,sonar,,,104,-195,9,4,5,6,31,5,-10,1,2,3,0.1,0.2,0.3,0.5,0.25,0.75
2,3,sonar,a,41,,,,,,,,,,,,,,,,,,
";

#[test]
fn each_scan_has_the_pose_of_its_rows() {
    let recording = recording(read("csv", ALL).unwrap());
    let poses: Vec<Option<Pose>> = recording.scans.iter().map(|scan| scan.pose).collect();
    assert_eq!((poses.len(), poses[2]), (3, None));
    let pose = poses[0].unwrap();
    assert_eq!(pose.place.as_slice(), [100.0, -200.0, 3.0]);
    assert_eq!(pose.velocity.as_slice(), [4.0, 5.0, 6.0]);
    let attitude = pose.attitude.unwrap();
    let angles = [attitude.heading_rad, attitude.pitch_rad, attitude.roll_rad];
    assert_eq!(angles, [30.0, 5.0, -10.0].map(f64::to_radians));
    assert_eq!(pose.sigmas.place.as_slice(), [1.0, 2.0, 3.0]);
    assert_eq!(pose.sigmas.velocity.as_slice(), [0.1, 0.2, 0.3]);
    let sigmas = [
        pose.sigmas.heading_rad,
        pose.sigmas.pitch_rad,
        pose.sigmas.roll_rad,
    ];
    assert_eq!(sigmas, [0.5, 0.25, 0.75].map(f64::to_radians));
    assert_eq!(poses[1].unwrap().place.as_slice(), [104.0, -195.0, 9.0]);
}

#[test]
fn poses_are_written_and_read_back_with_the_columns_that_they_need() {
    let dataset = read("csv", ALL).unwrap().dataset;
    let (mut csv, mut json) = (Vec::new(), Vec::new());
    write_csv(&dataset, &mut csv).unwrap();
    write_json(&dataset, &mut json).unwrap();
    for (format, bytes) in [("csv", &csv), ("json", &json)] {
        let read = read_with(format, bytes, &of_kind(dataset.kind())).unwrap();
        assert_eq!(read.dataset, dataset, "{}", String::from_utf8_lossy(bytes));
    }
    let placed =
        "time_s,scan,sensor_id,detection_id,x_m,y_m,sensor_x_m,sensor_y_m\n0,1,radar,a,5,6,0,0\n";
    let mut written = Vec::new();
    write_csv(&read("csv", placed).unwrap().dataset, &mut written).unwrap();
    assert_eq!(String::from_utf8(written).unwrap(), placed);
}

#[test]
fn of_a_scan_with_times_the_row_nearest_to_its_time_counts() {
    let turning = "time_s,scan,sensor_id,detection_id,x_m,y_m,sensor_x_m,sensor_y_m\n\
        0,1,radar,a,5,6,0,0\n0.4,1,radar,b,5,6,4,0\n1,1,radar,c,5,6,10,0\n";
    let recording = recording(read("csv", turning).unwrap());
    assert_eq!(recording.scans[0].pose.unwrap().place.x, 4.0);
}

#[test]
fn poses_that_cannot_be_are_faults() {
    let header = "time_s,scan,sensor_id,detection_id,x_m,y_m,sensor_x_m,sensor_y_m,sensor_pitch_deg,sensor_sigma_x_m\n";
    let cases = [
        ("0,1,r,a,5,6,1,,,\n", "sensor_x_m", "missing"),
        ("0,1,r,a,5,6,,,3,\n", "sensor_pitch_deg", "missing"),
        ("0,1,r,a,5,6,1,2,90,\n", "sensor_pitch_deg", "out_of_range"),
        ("0,1,r,a,5,6,1,2,,-1\n", "sensor_sigma_x_m", "out_of_range"),
        ("0,1,r,a,5,6,1,inf,,\n", "sensor_y_m", "not_finite"),
        (
            "0,1,r,a,5,6,1,2,,\n0,1,r,b,5,6,1,3,,\n",
            "sensor_x_m",
            "conflict",
        ),
    ];
    for (rows, column, code) in cases {
        let faults = read("csv", format!("{header}{rows}")).unwrap_err();
        let told: Vec<(&str, &str)> = faults
            .iter()
            .map(|fault| {
                (
                    fault.column.as_deref().unwrap_or_default(),
                    fault.code.as_str(),
                )
            })
            .collect();
        assert_eq!(told, [(column, code)], "{rows}: {faults:?}");
    }
    let half = "time_s,scan,sensor_id,detection_id,x_m,y_m,sensor_x_m\n0,1,r,a,5,6,1\n";
    let faults = read("csv", half).unwrap_err();
    assert!(faults[0].detail.contains("come together"), "{faults:?}");
}
