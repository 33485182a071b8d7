//! Bearing-time records: as a matrix in CSV, and as NumPy arrays.

use super::{of_kind, read, read_with};
use proptest::prelude::*;
use serde_json::json;
use trackloom_domain::formats::{ReadOptions, ReadOutcome, write_csv, write_json};
use trackloom_domain::model::bearing_time::{BearingTimeParts, BearingTimeRecord};
use trackloom_domain::model::dataset::{Dataset, DatasetKind};
use trackloom_domain::model::fault::Fault;

fn record(outcome: Result<ReadOutcome, Vec<Fault>>) -> BearingTimeRecord {
    match outcome.expect("the record is sound").dataset {
        Dataset::BearingTime(record) => record,
        other => panic!("expected a record, found {}", other.kind().name()),
    }
}

fn places(outcome: Result<ReadOutcome, Vec<Fault>>) -> Vec<(String, Option<u64>, Option<String>)> {
    outcome
        .expect_err("there are faults")
        .into_iter()
        .map(|fault| (fault.code, fault.line, fault.column.map(Into::into)))
        .collect()
}

fn place(code: &str, line: u64, column: &str) -> (String, Option<u64>, Option<String>) {
    (code.to_owned(), Some(line), Some(column.to_owned()))
}

#[test]
fn a_matrix_is_known_by_its_header() {
    let record = record(read("csv", "time_s,350,355.5\r\n0,1,-2.5\r\n2,3e1,4\r\n"));
    assert_eq!(
        (record.times_s.as_slice(), record.levels_db.as_slice()),
        ([0.0, 2.0].as_slice(), [1.0, -2.5, 30.0, 4.0].as_slice())
    );
    assert_eq!(
        record.bearings_rad,
        [350f64.to_radians(), 355.5f64.to_radians()]
    );
    let summary = Dataset::BearingTime(record).summary();
    assert_eq!(
        (summary.kind, summary.scans, summary.rows, summary.end_s),
        (DatasetKind::BearingTime, 2, 4, Some(2.0))
    );
    assert!((summary.last_bearing_deg.unwrap() - 355.5).abs() < 1e-12);
}

#[test]
fn every_fault_of_a_matrix_has_its_line_and_column() {
    let text = "time_s,0,10,5,20\n0,1,2,3,4\n0,1,x,3,NaN\n1,1,2,3\ninf,1,2,3,1e300\n";
    assert_eq!(
        places(read("csv", text)),
        [
            place("unsorted", 1, "5"),
            place("unsorted", 3, "time_s"),
            place("wrong_type", 3, "10"),
            place("not_finite", 3, "20"),
            place("malformed", 4, "20"),
            place("not_finite", 5, "time_s"),
            place("not_finite", 5, "20"),
        ]
    );
    let lying =
        read("csv", "bearing_deg,0,1,2\n10,1,2,3\n20,1,2,3\n").expect_err("it lies on its side");
    assert!(lying[0].detail.contains("lies on its side"), "{lying:?}");
    assert_eq!(
        places(read_with(
            "csv",
            "time_s,0,west\n0,1,2\n",
            &of_kind(DatasetKind::BearingTime)
        )),
        [place("wrong_type", 1, "west")]
    );
    let turn = read("csv", "time_s,0,360\n0,1,2\n").expect_err("0 and 360 are one bearing");
    assert_eq!(
        (turn[0].pointer.as_str(), turn[0].code.as_str()),
        ("/file", "out_of_range")
    );
    assert_eq!(
        read("csv", "time_s,0,10\n").expect_err("no row")[0].code,
        "empty"
    );
}

#[test]
fn a_record_is_no_table_of_columns() {
    let of_json = read_with(
        "json",
        r#"{"columns":{"time_s":[0]}}"#,
        &of_kind(DatasetKind::BearingTime),
    )
    .expect_err("no table");
    assert_eq!(of_json[0].code, "unsupported");
    let record = record(read("csv", "time_s,0,10\n0,1,2\n"));
    assert!(write_json(&Dataset::BearingTime(record), &mut Vec::new()).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn what_is_written_reads_back(
        levels in proptest::collection::vec(-200f32..200.0, 12), step_s in 0.001..1e5f64, first_deg in -180.0..180f64, step_deg in 0.001..100f64
    ) {
        let record = BearingTimeRecord::new(BearingTimeParts {
            times_s: (0..4).map(|row| f64::from(row) * step_s).collect(),
            bearings_rad: (0..3).map(|cell| (first_deg + f64::from(cell) * step_deg).to_radians()).collect(),
            levels_db: levels,
        }).unwrap();
        let mut text = Vec::new();
        write_csv(&Dataset::BearingTime(record.clone()), &mut text).unwrap();
        let again = read("csv", &text).unwrap().dataset;
        prop_assert_eq!(again, Dataset::BearingTime(record));
    }
}

/// An array as NumPy writes it.
fn npy(version: u8, header: &str, values: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY".to_vec();
    bytes.extend([version, 0]);
    let length = header.len() as u32;
    bytes.extend(&length.to_le_bytes()[..if version == 1 { 2 } else { 4 }]);
    bytes.extend(header.as_bytes());
    bytes.extend(values);
    bytes
}

fn with_axes() -> ReadOptions {
    let axes = json!({"first_time_s": 5.0, "time_step_s": 2.0, "first_bearing_deg": 90.0, "bearing_step_deg": 0.5});
    ReadOptions {
        options: [("bearing_time".to_owned(), axes)].into_iter().collect(),
        ..Default::default()
    }
}

fn header(number: &str, order: &str) -> String {
    format!("{{'descr': '{number}', 'fortran_order': {order}, 'shape': (2, 3), }}    \n")
}

#[test]
fn arrays_of_all_numbers_orders_and_versions_are_the_same_record() {
    const ROWS: [i16; 6] = [1, -2, 3, 4, 500, -600];
    const COLUMNS: [i16; 6] = [1, 4, -2, 500, 3, -600];
    let bytes = |number: &str, values: [i16; 6]| -> Vec<u8> {
        let one = |value: i16| -> Vec<u8> {
            let mut little = match &number[1..] {
                "f4" => f32::from(value).to_le_bytes().to_vec(),
                "f8" => f64::from(value).to_le_bytes().to_vec(),
                "i2" => value.to_le_bytes().to_vec(),
                _ => i32::from(value).to_le_bytes().to_vec(),
            };
            if number.starts_with('>') {
                little.reverse();
            }
            little
        };
        values.into_iter().flat_map(one).collect()
    };
    for number in ["<f4", ">f4", "<f8", ">f8", "<i2", ">i2", "<i4", ">i4"] {
        for version in 1..=3 {
            for (order, values) in [("False", ROWS), ("True", COLUMNS)] {
                let file = npy(version, &header(number, order), &bytes(number, values));
                let found = record(read_with("npy", &file, &with_axes()));
                assert_eq!(
                    found.levels_db,
                    ROWS.map(f32::from),
                    "{number} {version} {order}"
                );
                assert_eq!(found.times_s, [5.0, 7.0]);
                assert_eq!(found.bearings_rad, [90.0, 90.5, 91.0].map(f64::to_radians));
            }
        }
    }
}

#[test]
fn an_array_without_axes_or_of_something_else_says_what_is_needed() {
    let values = [0u8; 24];
    let fault = |file: &[u8], options: &ReadOptions| {
        let faults = read_with("npy", file, options).expect_err("there is a fault");
        assert_eq!(faults.len(), 1, "{faults:?}");
        (
            faults[0].pointer.clone(),
            faults[0].code.clone(),
            faults[0].detail.clone(),
        )
    };
    let sound = npy(1, &header("<f4", "False"), &values);
    let (pointer, code, _) = fault(&sound, &ReadOptions::default());
    assert_eq!(
        (pointer.as_str(), code.as_str()),
        ("/meta/bearing_time", "missing")
    );
    let detail = |file: &[u8]| fault(file, &with_axes()).2;
    assert!(detail(&sound[..sound.len() - 1]).contains("need 24 bytes; there are 23"));
    assert!(detail(&[sound.as_slice(), &[0]].concat()).contains("there are more"));
    assert!(detail(&sound[..20]).contains("ends before its header"));
    assert!(detail(&npy(9, "", &[])).contains("version 9"));
    assert!(detail(&npy(1, &header("<c8", "False"), &values)).contains("'<c8'"));
    assert!(
        detail(&npy(
            1,
            &header("<f4", "False").replace("(2, 3)", "(6,)"),
            &values
        ))
        .contains("no matrix")
    );
    let of_shape = |shape: &str, values: &[u8]| {
        npy(1, &header("<f4", "False").replace("(2, 3)", shape), values)
    };
    assert_eq!(
        detail(&of_shape("(2, 0)", &[])),
        "the array has 2 rows and 0 columns"
    );
    assert_eq!(
        detail(&of_shape("(1000000000000, 0)", &[])),
        "the array has 1000000000000 rows and 0 columns"
    );
    assert_eq!(
        detail(&of_shape("(1000000000000, 1)", &[])),
        "the array has 1000000000000 rows and 1 columns"
    );
    assert!(detail(&of_shape("(4, 3)", &values)).contains("need 48 bytes; there are 24"));
    let nan = npy(
        1,
        &header("<f4", "False"),
        &[&values[..20], &f32::NAN.to_le_bytes()].concat(),
    );
    assert!(detail(&nan).contains("row 1, column 2"));
    let huge = npy(
        1,
        &header("<f4", "False").replace("(2, 3)", "(99999999999, 99999999999)"),
        &values,
    );
    assert!(detail(&huge).contains("cells"));
}
