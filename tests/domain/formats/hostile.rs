//! Files that are made to do harm, or that other programs write in another shape: refused at once with what would be read.

use super::*;
use trackloom_domain::formats::{MAX_COLUMNS, write_csv};

#[test]
fn headers_that_no_table_has_are_refused() {
    let columns = |count: usize| {
        (0..count)
            .map(|index| format!("c{index}"))
            .collect::<Vec<_>>()
            .join(",")
    };
    let found = fault("csv", format!("{}\n", columns(MAX_COLUMNS + 1)));
    assert_eq!((found.code.as_str(), found.line), ("too_large", Some(1)));
    assert_eq!(found.detail, "the header names 4097 columns in 19375 bytes");
    assert_eq!(
        found.allowed.as_deref(),
        Some("<= 4096 columns in <= 65536 bytes")
    );
    let truth = format!(
        "time_s,truth_id,x_m,y_m,{}\n0,A,1,2{}\n",
        columns(MAX_COLUMNS - 4),
        ",".repeat(MAX_COLUMNS - 4)
    );
    let outcome = read("csv", truth).expect("as many columns as allowed");
    assert!(
        outcome.warnings[0].ends_with("c48, c49 and 4042 more"),
        "{}",
        outcome.warnings[0]
    );
    let long = fault(
        "csv",
        format!("time_s,truth_id,x_m,y_m,{}\n", "z".repeat(1 << 16)),
    );
    assert_eq!(
        (long.code.as_str(), long.detail.as_str()),
        ("too_large", "the header names 5 columns in 65556 bytes")
    );
    let quoted = fault("csv", "\"\n\",".repeat(1 << 17));
    assert_eq!((quoted.code.as_str(), quoted.line), ("too_large", Some(1)));
    let json = format!(
        "{{\"columns\": {{{}}}}}",
        (0..MAX_COLUMNS + 2)
            .map(|index| format!("\"c{index}\": []"))
            .collect::<Vec<_>>()
            .join(",")
    );
    let expected = Fault::new("/file/columns", "too_large", "there are 4098 columns")
        .allowing("<= 4096 columns");
    assert_eq!(fault("json", json), expected);
}

#[test]
fn lines_without_an_end_are_refused() {
    let row = "1".repeat((1 << 22) + 1);
    for (format, text, line) in [
        ("csv", format!("time_s,truth_id,x_m,y_m\n0,A,1,2\n{row}"), 3),
        ("mot", row, 1),
    ] {
        let faults = read_with(format, &text, &of_kind(DatasetKind::Truth))
            .expect_err("the line is too long");
        let expected = Fault::new(
            "/file",
            "too_large",
            "the line is longer than 4194304 bytes",
        )
        .allowing("<= 4194304 bytes a line");
        assert_eq!(
            faults,
            [Fault {
                line: Some(line),
                ..expected
            }]
        );
    }
}

#[test]
fn an_array_that_holds_no_table_is_refused_at_its_first_item() {
    // What follows the first item is not even JSON: nobody reads it.
    for text in ["[1,1,1,?", "[null, ?", "[[1], ?", "[\"a\", ?"] {
        let found = fault("json", text);
        assert_eq!(
            (found.code.as_str(), found.line),
            ("wrong_type", Some(1)),
            "{text}"
        );
        assert!(found.detail.contains("expected a record"), "{found:?}");
    }
    assert_eq!(fault("json", "[]").code, "missing");
    let expected = Fault::new(
        "/file/0",
        "wrong_type",
        "expected a scan or a list of positions",
    );
    assert_eq!(fault("autoferry", "[1,1,1,?"), expected);
}

#[test]
fn records_are_told_from_scans() {
    let text = r#"[{"timestamp": 1533101250000, "icao24": "abc123", "latitude": 45.8, "longitude": 9.2}, ?"#;
    let detail =
        "the file is an array of records (timestamp, icao24, latitude, longitude), not of scans";
    let expected = Fault::new("/file", "unsupported", detail).allowing("the format json");
    assert_eq!(fault("autoferry", text), expected);
    assert_eq!(fault("json", text).code, "malformed");
    let timed = fault("autoferry", r#"[{"time": 1, "x_m": 2}]"#);
    assert!(timed.detail.contains("records (time, x_m)"), "{timed:?}");
    let scan = r#"[{"note": [[[1]]], "time": 1, "sensorID": 2, "ownshipPosition": [0, 0], "measurement": [3, 4]}]"#;
    assert_eq!(
        recording(read("autoferry", scan).expect("it has the fields of a scan")).detection_count(),
        1
    );
}

#[test]
fn reading_ends_when_there_are_too_many_faults() {
    let truth = format!("[[{}?", "{},".repeat(MAX_FAULTS));
    let scans = format!("[{{\"sensorID\": 2}},{}?", "{},".repeat(MAX_FAULTS));
    for text in [truth, scans] {
        let faults = read("autoferry", text).expect_err("every item is broken");
        assert_eq!(
            (faults.len(), faults[MAX_FAULTS].code.as_str()),
            (MAX_FAULTS + 1, "too_large")
        );
    }
}

#[test]
fn rows_that_repeat_others_are_taken_once_and_told() {
    let outcome = read(
        "csv",
        "time_s,truth_id,x_m,y_m\n0,A,0,0\n0,A,0,0\n0,B,1,1\n1,A,10,0\n1,A,10,0\n",
    )
    .expect("repeats are no fault");
    assert_eq!(
        outcome.warnings,
        ["2 rows repeat earlier ones and are taken once; the first is line 3"]
    );
    let points: Vec<usize> = truth(outcome)
        .targets()
        .iter()
        .map(|target| target.points.len())
        .collect();
    assert_eq!(points, [2, 1]);
    let outcome = read(
        "csv",
        "time_s,track_id,x_m,y_m\n0,T,0,0\n0,U,0,0\n0,T,0,0\n",
    )
    .expect("repeats are no fault");
    assert_eq!(
        outcome.warnings,
        ["line 4 repeats an earlier one and is taken once"]
    );
    assert_eq!(
        tracks(outcome)
            .tracks
            .iter()
            .map(|track| track.points.len())
            .collect::<Vec<_>>(),
        [1, 1]
    );
    let with_candidates = "time_s,track_id,x_m,y_m,detection_id,probability\n0,T,0,0,a,0.5\n0,T,0,0,b,0.5\n0,T,0,0,a,0.5\n";
    let outcome = read("csv", with_candidates).expect("repeats are no fault");
    assert_eq!(
        outcome.warnings,
        ["line 4 repeats an earlier one and is taken once"]
    );
    let set = tracks(outcome);
    assert_eq!(
        (set.tracks[0].points[0].candidates, set.candidates.len()),
        (2, 2)
    );
    let text =
        r#"{"columns": {"time_s": [0, 0], "truth_id": ["A", "A"], "x_m": [1, 1], "y_m": [2, 2]}}"#;
    assert_eq!(
        read("json", text).expect("repeats are no fault").warnings,
        ["row 1 repeats an earlier one and is taken once"]
    );
    let boxes = read_with(
        "mot",
        "1,1,0,0,5,5\n1,2,0,0,5,5\n1,1,0,0,5,5\n",
        &of_kind(DatasetKind::Tracks),
    )
    .expect("repeats are no fault");
    assert_eq!(
        boxes.warnings,
        ["line 3 repeats an earlier one and is taken once"]
    );
    assert_eq!(boxes.dataset.summary().rows, 2);
}

#[test]
fn rows_that_repeat_others_with_another_value_are_refused() {
    let covariance = "time_s,track_id,x_m,y_m,nis\n0,T,1,2,0.5\n0,T,1,2,0.75\n";
    assert_eq!(
        fault("csv", covariance),
        at(
            3,
            "time_s",
            "duplicate",
            "track 'T' is at 0 s twice: also on line 2"
        )
    );
    let velocity = "time_s,truth_id,x_m,y_m,vx_mps,vy_mps\n0,A,1,2,3,4\n0,A,1,2,,\n";
    assert_eq!(
        fault("csv", velocity),
        at(
            3,
            "time_s",
            "duplicate",
            "target 'A' is at 0 s twice: also on line 2"
        )
    );
}

#[test]
fn boxes_may_be_separated_by_spaces_or_tabs() {
    let text = "1 1 0 0 10 20 0.5 0 -1\n2\t1\t0.5\t0\t10\t20\t0\t0\t-1\r\n3,  1, 0, 0, 10, 20\n";
    let outcome =
        read_with("mot", text, &of_kind(DatasetKind::Tracks)).expect("all three are sound");
    let Dataset::TrackBoxes(set) = outcome.dataset else {
        panic!("tracks were asked for")
    };
    let found: Vec<_> = set
        .boxes()
        .iter()
        .map(|one| (one.frame, one.left_px, one.height_px, one.confidence))
        .collect();
    assert_eq!(
        found,
        [
            (1, 0.0, 20.0, 0.5),
            (2, 0.5, 20.0, 0.0),
            (3, 0.0, 20.0, 1.0)
        ]
    );
    let faults =
        read_with("mot", "1 1 0 0 10\n", &of_kind(DatasetKind::Tracks)).expect_err("five values");
    assert_eq!(
        faults[0].detail,
        "expected 6 to 10 values separated by commas, spaces or tabs, found 5"
    );
}

#[test]
fn names_that_a_spreadsheet_would_run_are_refused_wherever_they_stand() {
    let allowed = "numbers, and names that do not begin with = @ + - or a tab";
    let formula = |line, column: &str, name: &str| {
        at(
            line,
            column,
            "malformed",
            &format!("the name '{name}' would be a formula in a spreadsheet"),
        )
        .allowing(allowed)
    };
    let faults = read(
        "csv",
        "time_s,scan,sensor_id,detection_id,x_m,y_m,truth_id\n0,1,=r,@d,1,2,+A\n",
    )
    .expect_err("three names");
    assert_eq!(
        faults,
        [
            formula(2, "sensor_id", "=r"),
            formula(2, "truth_id", "+A"),
            formula(2, "detection_id", "@d")
        ]
    );
    assert_eq!(
        fault("csv", "time_s,truth_id,x_m,y_m\n0,-A1,1,2\n"),
        formula(2, "truth_id", "-A1")
    );
    let faults = read(
        "csv",
        "time_s,track_id,x_m,y_m,sensor_id,detection_id\n0,\"=cmd|'/c calc'!A0\",1,2,-s,=d\n",
    )
    .expect_err("three names");
    assert_eq!(
        faults,
        [
            formula(2, "track_id", "=cmd|'/c calc'!A0"),
            formula(2, "sensor_id", "-s"),
            formula(2, "detection_id", "=d")
        ]
    );
    let sensors = r#"{"columns": {"time_s": [0], "scan": [1], "sensor_id": ["r"], "detection_id": ["a"], "x_m": [1], "y_m": [2]},
        "sensors": [{"sensor_id": "=r"}]}"#;
    assert_eq!(fault("json", sensors).pointer, "/file/sensors/0/sensor_id");
    // Numbers with a sign are numbers there, as names and as values.
    let text = "time_s,truth_id,x_m,y_m\n0,-1.5,-1.5,-2\n0,-1,1,2\n0,\"+12\",1,2\n";
    let outcome = read("csv", text).expect("numbers are sound names");
    let mut written = Vec::new();
    write_csv(&outcome.dataset, &mut written).expect("a Vec takes any bytes");
    assert_eq!(
        read("csv", &written)
            .expect("what is written is sound")
            .dataset,
        outcome.dataset
    );
    assert!(String::from_utf8_lossy(&written).contains("\n0,-1.5,-1.5,-2\n"));
}
