//! Broken CSV: every fault with its line, column, code and words.

use super::*;
use trackloom_domain::model::scan::Measurement;

const HEADER: &str = "time_s,scan,sensor_id,detection_id,x_m,y_m\n";
const KNOWN: &str = "time_s, scan, sensor_id, detection_id, x_m, y_m, range_m, bearing_deg, range_rate_mps, amplitude, truth_id, z_m, elevation_deg, vx_mps, vy_mps, sigma_x_m, sigma_y_m, correlation_xy, sigma_z_m, sigma_range_m, sigma_bearing_deg, sigma_elevation_deg, sigma_range_rate_mps, sigma_speed_mps, sigma_course_deg, sensor_x_m, sensor_y_m, sensor_z_m, sensor_vx_mps, sensor_vy_mps, sensor_vz_mps, sensor_heading_deg, sensor_pitch_deg, sensor_roll_deg, sensor_sigma_x_m, sensor_sigma_y_m, sensor_sigma_z_m, sensor_sigma_vx_mps, sensor_sigma_vy_mps, sensor_sigma_vz_mps, sensor_sigma_heading_deg, sensor_sigma_pitch_deg, sensor_sigma_roll_deg, lat_deg, lon_deg, height_m, speed_mps, course_deg, time_base, address, callsign, mode_a, mode_c_ft, position_accuracy_m, mmsi, ship_name, ship_type, track_number, on_ground, report_kind";

fn detections(rows: &str) -> Fault {
    fault("csv", format!("{HEADER}{rows}"))
}

#[test]
fn an_empty_file_is_a_fault() {
    let expected = Fault {
        line: Some(1),
        ..Fault::new(
            "/file",
            "empty",
            "the file is empty; its first line must name the columns",
        )
    };
    for text in ["", "\n\n", "\r\n", "\u{feff}"] {
        assert_eq!(fault("csv", text), expected, "{text:?}");
    }
}

#[test]
fn columns_that_say_nothing_are_a_fault() {
    let detail = "the columns do not say what the file holds: tracks have 'track_id', truth 'truth_id', detections 'scan' or 'detection_id', or `kind` says that they are detections";
    let expected = Fault {
        line: Some(1),
        ..Fault::new("/file", "missing", detail).allowing("tracks, detections, truth")
    };
    assert_eq!(fault("csv", "a,b\n1,2\n"), expected);
}

#[test]
fn each_missing_column_is_named() {
    let faults = read("csv", "scan,detection_id,x_m\n1,a,2\n").expect_err("columns are missing");
    assert_eq!(
        faults,
        [
            at(
                1,
                "time_s",
                "missing",
                "a file of detections needs a column 'time_s'"
            )
            .allowing(KNOWN),
            at(
                1,
                "y_m",
                "missing",
                "column 'y_m' is missing: x_m, y_m come together"
            )
            .allowing(KNOWN),
        ]
    );
    let none = fault("csv", "time_s,scan,sensor_id,detection_id\n");
    assert_eq!(
        none,
        at(
            1,
            "x_m",
            "missing",
            "detections need measurements: x_m, y_m or lat_deg, lon_deg or range_m, bearing_deg or bearing_deg"
        )
        .allowing(KNOWN)
    );
    let range = fault("csv", "time_s,scan,sensor_id,detection_id,range_m\n");
    assert_eq!(
        range,
        at(
            1,
            "bearing_deg",
            "missing",
            "column 'bearing_deg' is missing: range_m, bearing_deg come together"
        )
        .allowing(KNOWN)
    );
}

#[test]
fn a_covariance_is_whole_or_absent() {
    let faults = read(
        "csv",
        "time_s,track_id,x_m,y_m,p_xx,p_xy,p_xvx,p_xvy,p_yy,p_yvx,p_yvy,p_vxvx\n",
    )
    .expect_err("two columns are missing");
    let named: Vec<_> = faults
        .iter()
        .map(|fault| (fault.code.as_str(), fault.column.as_deref()))
        .collect();
    assert_eq!(
        named,
        [("missing", Some("p_vxvy")), ("missing", Some("p_vyvy"))]
    );
}

#[test]
fn duplicate_columns_are_named_with_their_places() {
    let found = fault("csv", "time_s,truth_id,x_m,y_m,x_m\n1,a,2,3,4\n");
    assert_eq!(
        found,
        at(
            1,
            "x_m",
            "duplicate",
            "column 'x_m' occurs twice: columns 3 and 5"
        )
    );
}

#[test]
fn a_renaming_must_fit_the_file_and_the_format() {
    let columns = [
        ("t", "time_s"),
        ("id", "truth_id"),
        ("x_m", "east"),
        ("a/b", "y_m"),
    ];
    let columns = columns
        .into_iter()
        .map(|(from, to)| (from.to_owned(), to.to_owned()))
        .collect();
    let options = ReadOptions {
        columns,
        ..Default::default()
    };
    let faults =
        read_with("csv", "t,id,x_m,y_m\n1,a,2,3\n", &options).expect_err("the renaming is broken");
    let known = "time_s, truth_id, x_m, y_m, vx_mps, vy_mps, z_m, bearing_deg, lat_deg, lon_deg, height_m, speed_mps, course_deg, time_base, address, callsign, mode_a, mode_c_ft, position_accuracy_m, mmsi, ship_name, ship_type, track_number, on_ground, report_kind";
    assert_eq!(
        faults,
        [
            Fault::new(
                "/meta/columns/a~1b",
                "unknown_value",
                "the file has no column 'a/b'"
            )
            .allowing("t, id, x_m, y_m"),
            Fault::new(
                "/meta/columns/x_m",
                "unknown_value",
                "'east' is not a column of truth"
            )
            .allowing(known),
            at(1, "x_m", "missing", "a file of truth needs a column 'x_m'").allowing(known),
        ]
    );
}

#[test]
fn numbers_that_are_none_are_named() {
    assert_eq!(
        detections("0,1,r,a,1.5,NaN\n"),
        at(2, "y_m", "not_finite", "'NaN' is not a finite number")
    );
    assert_eq!(
        detections("inf,1,r,a,1,2\n"),
        at(2, "time_s", "not_finite", "'inf' is not a finite number")
    );
    assert_eq!(
        detections("0,1,r,a,1e999,2\n"),
        at(2, "x_m", "not_finite", "'1e999' is not a finite number")
    );
    assert_eq!(
        detections("0,1,r,a,1;5,2\n"),
        at(2, "x_m", "malformed", "expected a number, found '1;5'")
    );
    assert_eq!(
        detections("0,1,r,a,1,\n"),
        at(2, "y_m", "missing", "'y_m' is empty")
    );
    assert_eq!(
        detections("0,-1,r,a,1,2\n"),
        at(
            2,
            "scan",
            "malformed",
            "expected a whole number from 0 to 4294967295, found '-1'"
        )
    );
    assert_eq!(
        detections("0,,r,a,1,2\n"),
        at(2, "scan", "missing", "'scan' is empty")
    );
    assert_eq!(
        detections("0,1,,a,1,2\n"),
        at(2, "sensor_id", "missing", "'sensor_id' is empty")
    );
    assert_eq!(
        detections("0,1,r,,1,2\n"),
        at(2, "detection_id", "missing", "'detection_id' is empty")
    );
    assert_eq!(
        detections("0,1,r,a,,\n"),
        at(2, "x_m", "missing", "detection 'a' has no measurement")
    );
}

#[test]
fn a_range_below_zero_is_named_and_zero_is_a_range() {
    let polar = "time_s,scan,sensor_id,detection_id,range_m,bearing_deg\n";
    let expected = at(
        3,
        "range_m",
        "out_of_range",
        "a range of -0.5 m is below zero",
    )
    .allowing(">= 0 m");
    assert_eq!(
        fault("csv", format!("{polar}0,1,r,a,0,10\n1,2,r,a,-0.5,10\n")),
        expected
    );
    assert_eq!(
        fault("csv", format!("{polar}0,1,r,a,5,inf\n")),
        at(
            2,
            "bearing_deg",
            "not_finite",
            "'inf' is not a finite number"
        )
    );
    assert_eq!(
        fault("csv", format!("{polar}0,1,r,a,NaN,5\n")),
        at(2, "range_m", "not_finite", "'NaN' is not a finite number")
    );
    let zero = recording(
        read("csv", format!("{polar}0,1,r,a,0,90\n")).expect("a target may be at the sensor"),
    );
    let bearing_rad = std::f64::consts::FRAC_PI_2;
    assert_eq!(
        zero.scans[0].detections[0].measurement,
        Measurement::RangeBearing {
            range_m: 0.0,
            bearing_rad,
            range_rate_mps: None
        }
    );
}

#[test]
fn two_faults_at_once_are_both_named() {
    let faults = read(
        "csv",
        format!("{HEADER}0,1,r,a,1,two\n1,2,r,b,1,2\n2,three,r,c,nan,2\n"),
    )
    .expect_err("three cells are broken");
    assert_eq!(
        faults,
        [
            at(2, "y_m", "malformed", "expected a number, found 'two'"),
            at(
                4,
                "scan",
                "malformed",
                "expected a whole number from 0 to 4294967295, found 'three'"
            ),
            at(4, "x_m", "not_finite", "'nan' is not a finite number"),
        ]
    );
}

#[test]
fn rows_of_the_wrong_length_do_not_stop_the_reader() {
    let faults = read(
        "csv",
        format!("{HEADER}0,1,r,a\n0,1,r,b,1,2,3\n0,1,r,c,x,2\n"),
    )
    .expect_err("three rows are broken");
    let long = Fault {
        line: Some(3),
        ..Fault::new(
            "/file",
            "malformed",
            "the row has 7 values, the header names 6 columns",
        )
    };
    assert_eq!(
        faults,
        [
            at(
                2,
                "x_m",
                "malformed",
                "the row has 4 values, the header names 6 columns"
            ),
            long,
            at(4, "x_m", "malformed", "expected a number, found 'x'"),
        ]
    );
}

#[test]
fn lines_are_counted_through_blank_lines_quotes_and_windows_ends() {
    for (text, line) in [
        ("0,1,r,a,1,2\n\n\n0,1,r,b,x,2\n", 5),
        ("0,1,r,\"a\nb\nc\",1,2\n0,1,r,b,x,2\n", 5),
        ("0,1,r,a,1,2\n0,1,\"r\n\",b,x,2\n", 3),
        ("0,1,r,a,1,2\r\n0,1,r,b,x,2\r\n", 3),
        ("0,1,r,a,1,2\r\n\r\n0,1,r,b,x,2\r\n", 4),
        ("0,1,r,a,1,2\n0,1,r,b,x,2", 3),
    ] {
        assert_eq!(
            detections(text),
            at(line, "x_m", "malformed", "expected a number, found 'x'"),
            "{text:?}"
        );
    }
}

#[test]
fn text_that_is_not_utf_8_is_named_and_reading_goes_on() {
    let mut bytes = HEADER.as_bytes().to_vec();
    bytes.extend_from_slice(b"0,1,r,\xff\xfe,1,2\n0,1,r,b,x,2\n");
    let faults = read("csv", bytes).expect_err("two rows are broken");
    let expected = [
        at(2, "detection_id", "malformed", "the text is not UTF-8"),
        at(3, "x_m", "malformed", "expected a number, found 'x'"),
    ];
    assert_eq!(faults, expected);
    assert_eq!(
        fault("csv", b"time_s,\xff\n").detail,
        "the text is not UTF-8"
    );
}

#[test]
fn detections_out_of_order_are_named() {
    let unsorted = detections("0,1,r,a,1,2\n2.5,2,r,b,1,2\n1.5,3,r,c,1,2\n");
    assert_eq!(
        unsorted,
        at(
            4,
            "scan",
            "unsorted",
            "sensor 'r': scan 3 at 1.5 s is before the end of scan 2 at 2.5 s; scan numbers rise with time (line 3)"
        )
    );
    let back = detections("0,2,r,a,1,2\n1,1,r,b,1,2\n");
    assert_eq!(
        back,
        at(
            2,
            "scan",
            "unsorted",
            "sensor 'r': scan 2 at 0 s is before the end of scan 1 at 1 s; scan numbers rise with time (line 3)"
        )
    );
    let two_scans = detections("0,1,r,a,1,2\n0,2,r,b,1,2\n");
    assert_eq!(
        two_scans,
        at(
            3,
            "scan",
            "conflict",
            "sensor 'r': scans 1 and 2 are both at 0 s (line 2)"
        )
    );
}

#[test]
fn a_detection_id_is_unique_in_its_scan() {
    let found = detections("0,1,r,a,1,2\n0,1,q,a,1,2\n0,1,r,b,1,2\n0,1,r,a,3,4\n1,2,r,a,1,2\n");
    assert_eq!(
        found,
        at(
            5,
            "detection_id",
            "duplicate",
            "detection 'a' occurs twice in scan 1 of sensor 'r': also on line 2"
        )
    );
}

#[test]
fn truth_out_of_order_is_named() {
    let header = "time_s,truth_id,x_m,y_m,vx_mps,vy_mps\n";
    let faults = read(
        "csv",
        format!("{header}0,A,1,2,,\n5,B,1,2,,\n0,A,1,3,,\n3,B,1,2,1,\n4,,1,2,,\n"),
    )
    .expect_err("three faults");
    assert_eq!(
        faults,
        [
            at(
                4,
                "time_s",
                "duplicate",
                "target 'A' is at 0 s twice: also on line 2"
            ),
            at(5, "vy_mps", "missing", "'vy_mps' is empty"),
            at(6, "truth_id", "missing", "'truth_id' is empty"),
        ]
    );
}

#[test]
fn tracks_that_contradict_themselves_are_named() {
    let header = "time_s,track_id,x_m,y_m,detection_id,probability,status\n";
    let rows = "0,T,1,2,a,0.5,tentative\n0,T,1,3,b,0.5,lost\n0,T,1,2,a,1.5,\n0,T,1,2,a,0.1,\n2,T,1,2,,1,\n1,T,1,2,,1,\n";
    let faults = read("csv", format!("{header}{rows}")).expect_err("four faults");
    assert_eq!(
        faults,
        [
            at(3, "status", "unknown_value", "'lost' is not a status")
                .allowing("tentative, confirmed, coasted"),
            at(
                3,
                "x_m",
                "conflict",
                "track 'T' at 0 s is at another position on line 2"
            ),
            at(4, "probability", "out_of_range", "1.5 is not a probability").allowing("0 to 1"),
            at(
                5,
                "detection_id",
                "duplicate",
                "detection 'a' occurs twice for one track and time: also on line 2"
            ),
        ]
    );
    let twice = fault("csv", "time_s,track_id,x_m,y_m\n0,T,1,2\n0,T,1,3\n");
    assert_eq!(
        twice,
        at(
            3,
            "time_s",
            "duplicate",
            "track 'T' is at 0 s twice: also on line 2"
        )
    );
}

#[test]
fn a_covariance_without_an_inverse_and_a_negative_square_are_named() {
    let header =
        "time_s,track_id,x_m,y_m,p_xx,p_xy,p_xvx,p_xvy,p_yy,p_yvx,p_yvy,p_vxvx,p_vxvy,p_vyvy,nis\n";
    // Perfectly correlated, of no variance at all, of a negative one; then a sound one with a negative NIS.
    let rows = "0,T,1,2,4,2,0,0,1,0,0,1,0,1,\n1,T,1,2,0,0,0,0,0,0,0,0,0,0,\n2,T,1,2,1,0,0,0,-1,0,0,1,0,1,0.5\n3,T,1,2,1,0,0,0,1,0,0,1,0,1,-2\n";
    let faults = read("csv", format!("{header}{rows}")).expect_err("four faults");
    let allowed = "a positive definite matrix: every variance > 0, every correlation within (-1, 1); or all its cells empty";
    let singular = |line| {
        let detail = "the covariance is singular, or not one: it is not positive definite";
        at(line, "p_xx", "out_of_range", detail).allowing(allowed)
    };
    let negative = at(5, "nis", "out_of_range", "-2 is not a square").allowing(">= 0");
    assert_eq!(faults, [singular(2), singular(3), singular(4), negative]);
}

#[test]
fn reading_stops_after_the_most_faults() {
    let rows: String = (0..250).map(|_| "0,1,r,a,x,2\n").collect();
    let faults = read("csv", format!("{HEADER}{rows}")).expect_err("every row is broken");
    assert_eq!(faults.len(), MAX_FAULTS + 1);
    assert_eq!(
        faults[MAX_FAULTS - 1],
        at(101, "x_m", "malformed", "expected a number, found 'x'")
    );
    assert_eq!(
        faults[MAX_FAULTS],
        Fault::new(
            "/file",
            "too_large",
            "reading stopped after 100 faults; there may be more"
        )
    );
}

#[test]
fn rows_out_of_order_are_sorted_and_told() {
    let truth = read(
        "csv",
        "time_s,truth_id,x_m,y_m\n5,B,1,2\n3,B,3,4\n0,A,0,0\n",
    )
    .expect("sound");
    assert_eq!(
        truth.warnings,
        [
            "1 lines are older than one before them and are sorted; the largest step back is 2 s, at line 3"
        ]
    );
    let times_s: Vec<f64> = super::truth(truth).targets()[1]
        .points
        .iter()
        .map(|point| point.time_s)
        .collect();
    assert_eq!(times_s, [3.0, 5.0]);
    let tracks = "time_s,track_id,x_m,y_m,detection_id,probability\n2,T,1,2,b,1\n1,T,1,2,a,0.25\n1,T,1,2,c,0.75\n";
    let set = super::tracks(read("csv", tracks).expect("sound"));
    let points = &set.tracks[0].points;
    let named: Vec<Vec<&str>> = points
        .iter()
        .map(|point| {
            let candidates = set.candidates_of(point).iter();
            let named = candidates.filter_map(|candidate| candidate.detection);
            named
                .map(|detection| set.detection_ids[detection as usize].as_str())
                .collect()
        })
        .collect();
    assert_eq!(named, [vec!["a", "c"], vec!["b"]]);
}

#[test]
fn a_rotating_sensor_has_a_time_for_each_detection() {
    let header = "time_s,scan,sensor_id,detection_id,range_m,bearing_deg\n";
    let rows = "0.5,1,r,a,10,45\n3,1,r,b,10,270\n4.5,2,r,a,10,46\n";
    let found = super::recording(read("csv", format!("{header}{rows}")).expect("sound"));
    let times_s: Vec<f64> = found.scans.iter().map(|scan| scan.time_s).collect();
    assert_eq!(times_s, [1.75, 4.5]);
    assert_eq!(found.beside.times_s, [0.5, 3.0, 4.5]);
    // Without numbers the turns are told by the bearings that fall.
    let bare = "time_s,range_m,bearing_deg\n0.5,10,45\n1,10,100\n3,10,270\n4.5,10,46\n5,10,90\n";
    let options = super::of_kind(DatasetKind::Detections);
    let found = super::recording(read_with("csv", bare, &options).expect("sound"));
    let counts: Vec<usize> = found
        .scans
        .iter()
        .map(|scan| scan.detections.len())
        .collect();
    assert_eq!(counts, [3, 2]);
    assert_eq!(found.detection_ids[3], "5");
    assert_eq!(found.sensors[0].sensor_id, "sensor");
}

#[test]
fn noises_that_are_none_are_refused() {
    let text = "time_s,scan,sensor_id,detection_id,x_m,y_m,sigma_x_m,correlation_xy,speed_mps,course_deg\n\
                0,1,r,a,1,2,0,0,1,2\n1,2,r,b,1,2,1,1,1,2\n2,3,r,c,1,2,1,0,-1,2\n";
    let faults = read("csv", text).expect_err("three cells are wrong");
    let found: Vec<_> = faults
        .iter()
        .map(|fault| {
            (
                fault.line,
                fault.column.as_deref(),
                fault.allowed.as_deref(),
            )
        })
        .collect();
    assert_eq!(
        found,
        [
            (Some(2), Some("sigma_x_m"), Some("> 0")),
            (
                Some(3),
                Some("correlation_xy"),
                Some("above -1 and below 1")
            ),
            (Some(4), Some("speed_mps"), Some(">= 0 m/s")),
        ]
    );
}

#[test]
fn times_are_counted_from_one_beginning() {
    let text = "time_s,truth_id,x_m,y_m,time_base\n0,a,1,2,\n1,a,1,2,utc\n2,a,1,2,relative\n3,a,1,2,noon\n";
    let faults = read("csv", text).unwrap_err();
    assert_eq!(
        faults,
        [
            at(
                4,
                "time_base",
                "conflict",
                "times are 'relative' here and 'utc' before"
            ),
            at(
                5,
                "time_base",
                "unknown_value",
                "'noon' is nothing that times are counted from"
            )
            .allowing("relative, utc, assumed_date"),
        ]
    );
}
