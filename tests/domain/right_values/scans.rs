//! Scans of several sensors at one time, and scans that no row names.

use super::{table, warning};
use crate::origins::jobs::Texts;
use serde_json::{Value, json};
use trackloom_domain::experiment::Outcome;

const DETECTIONS: &str = "time_s,scan,sensor_id,detection_id,x_m,y_m,truth_id";

fn by_automaton(detections: &str, tracks: &str) -> Outcome {
    let mut texts = Texts::of("csv");
    let body = json!({"tracks": texts.dataset(tracks), "detections": texts.dataset(detections), "profile": "tfa"});
    texts.judge(&body).unwrap()
}

fn lines(header: &str, rows: &[&str]) -> String {
    table(header, rows.iter().map(|row| (*row).to_owned()))
}

#[test]
fn a_detection_that_one_of_two_sensors_has_tells_the_scan_of_a_point() {
    let detections = lines(
        DETECTIONS,
        &[
            "0,1,A,a1,0,0,T1",
            "0,1,B,b1,0,0,T1",
            "1,2,A,a2,5,0,T1",
            "1,2,B,b2,5,0,T1",
        ],
    );
    let rows = [("0,1,0,0,a1", "A"), ("1,1,5,0,b2", "B")];
    let without = lines(
        "time_s,track_id,x_m,y_m,detection_id",
        &rows.map(|(row, _)| row),
    );
    let with = table(
        "time_s,track_id,x_m,y_m,detection_id,sensor_id",
        rows.map(|(row, sensor)| format!("{row},{sensor}")),
    );
    let (without, with) = (
        by_automaton(&detections, &without),
        by_automaton(&detections, &with),
    );
    assert_eq!(without.result["tfa"], with.result["tfa"]);
    assert_eq!(
        without.result["tfa"]["targets"][0]["verdict"], "false",
        "it took a1 and b2 of a1, b1, a2, b2"
    );
    assert_eq!(without.result["tfa"]["output_tracks"][0]["symbols"], 2);
    assert_eq!(without.warnings, [""; 0]);
}

#[test]
fn a_point_that_may_be_of_two_scans_is_told_in_the_warnings_of_the_job() {
    let detections = lines(
        DETECTIONS,
        &["0,1,A,d1,0,0,T1", "0,1,B,d1,0,0,T1", "1,2,A,d1,0,0,T1"],
    );
    let tracks = lines(
        "time_s,track_id,x_m,y_m,detection_id",
        &["0,1,0,0,d1", "1,1,0,0,d1"],
    );
    let outcome = by_automaton(&detections, &tracks);
    assert_eq!(
        warning(&outcome, "belong to no scan"),
        "1 track point(s) belong to no scan and were left out, first: track '1' at 0 s"
    );
    let told = "1 of these points name no sensor at a time of several scans, and no detection that one of the scans alone has: a column \
                'sensor_id' would tell";
    assert_eq!(warning(&outcome, "name no sensor"), told);
    // A point that was given no detection is ε, wherever it is.
    let coasted = lines(
        "time_s,track_id,x_m,y_m,detection_id",
        &["0,1,0,0,", "1,1,0,0,d1"],
    );
    assert_eq!(by_automaton(&detections, &coasted).warnings, [""; 0]);
}

#[test]
fn the_numbers_of_the_file_are_told_also_of_several_sensors() {
    let rows = |sensors: &[&str]| {
        let scans = [(0, 1), (1, 2), (3, 4)];
        let row = |(time_s, scan): (u32, u32), sensor: &str| {
            format!("{time_s},{scan},{sensor},{sensor}{scan},0,0,T1")
        };
        table(
            DETECTIONS,
            scans
                .iter()
                .flat_map(|&scan| sensors.iter().map(move |sensor| row(scan, sensor))),
        )
    };
    for sensors in [&["A"][..], &["A", "B"]] {
        let point =
            |time_s: u32, sensor: &str| format!("{time_s},1,0,0,{sensor}{},{sensor}", time_s + 1);
        let points = [0, 1, 3]
            .iter()
            .flat_map(|&time_s| sensors.iter().map(move |sensor| point(time_s, sensor)));
        let tracks = table("time_s,track_id,x_m,y_m,detection_id,sensor_id", points);
        let outcome = by_automaton(&rows(sensors), &tracks);
        let target = &outcome.result["tfa"]["targets"][0];
        assert_eq!(
            (
                &target["verdict"],
                &target["start_scan"],
                &target["end_scan"]
            ),
            (&json!("correct"), &json!(1), &json!(4))
        );
        let file = outcome
            .artifacts
            .iter()
            .find(|file| file.name == "truth_probability.csv")
            .unwrap();
        let last = std::str::from_utf8(&file.bytes)
            .unwrap()
            .lines()
            .last()
            .unwrap()
            .to_owned();
        assert!(last.starts_with("T1,3,4,"), "{last}");
    }
}

/// The number of strings of a target that sensor A sees in scans 1 and `last`, beside other sensors that see nothing.
fn strings(last: u32, others: &[&str], has_rows: bool) -> Value {
    let mut rows = Vec::new();
    for scan in (1..=last).filter(|scan| has_rows || [1, last].contains(scan)) {
        let of_a = if [1, last].contains(&scan) {
            format!("{scan},{scan},A,a{scan},0,0,T1")
        } else {
            format!("{scan},{scan},A,,,,")
        };
        rows.push(of_a);
        rows.extend(
            others
                .iter()
                .map(|sensor| format!("{scan},{scan},{sensor},,,,")),
        );
    }
    let tracks = lines(
        "time_s,track_id,x_m,y_m,detection_id,sensor_id",
        &["1,1,0,0,a1,A"],
    );
    by_automaton(&table(DETECTIONS, rows), &tracks).result["tfa"]["targets"][0]["strings"].take()
}

#[test]
fn missing_scans_count_as_if_they_were_written_for_one_sensor_and_for_several() {
    // Between them one sensor leaves last − 2 scans; of two the second one leaves as many, and one more at the first time.
    for (last, others, expected) in [
        (6, &[][..], 1),
        (7, &[], 2),
        (3, &["B"], 1),
        (4, &["B"], 2),
        (3, &["B", "C"], 2),
    ] {
        for has_rows in [true, false] {
            assert_eq!(
                strings(last, others, has_rows),
                expected,
                "{last} {others:?} {has_rows}"
            );
        }
    }
}

/// A target seen once a second, whose scans jump from 5 to 20.
fn jumping() -> Outcome {
    let seen = |time: u32| format!("{time},{time},r,a{time},{},0", 10 * time);
    let detections = table(
        "time_s,scan,sensor_id,detection_id,x_m,y_m",
        (0..6).chain(20..24).map(seen),
    );
    let truth = table(
        "time_s,truth_id,x_m,y_m",
        (0..24).map(|time| format!("{time},A,{},0", 10 * time)),
    );
    let mut texts = Texts::of("csv");
    let body = json!({
        "input": texts.dataset(&detections), "truth": texts.dataset(&truth), "metrics": [{"metric": "clear"}],
        "sensors": [{"sensor_id": "r", "p_d": 0.9, "clutter_per_m2": 1e-8, "sigma_x_m": 5.0, "sigma_y_m": 5.0}],
        "associator": {"method": "global_nearest_neighbour"}, "filter": {"method": "kalman", "process_noise_m2ps3": 1.0}
    });
    texts.judge(&body).unwrap()
}

#[test]
fn scan_numbers_that_jump_are_told_with_what_to_write() {
    let told = "14 scan(s) are missing, told from the scan numbers: scans 6 to 19 of 'r' between 5 s and 20 s; no track counts them as missed. \
                A scan that saw nothing is a row with time_s, scan and sensor_id alone";
    assert_eq!(warning(&jumping(), "are missing"), told);
}
