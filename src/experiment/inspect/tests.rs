//! Files with something to be said of each.

use super::*;
use crate::formats::{ReadOptions, read_file};

fn look(text: &str, options: serde_json::Value) -> Inspection {
    let options = ReadOptions {
        options: serde_json::from_value(options).unwrap(),
        ..ReadOptions::default()
    };
    let (read, format) = read_file("a.csv", &mut text.as_bytes(), None, &options).unwrap();
    inspect(read, format.name, "a.csv")
}

fn truth(columns: &str, rows: impl Iterator<Item = String>) -> String {
    let rows: Vec<String> = rows.collect();
    format!("time_s,truth_id,{columns}\n{}\n", rows.join("\n"))
}

#[test]
fn a_recording_is_summed_up() {
    let text =
        "time_s,scan,sensor_id,detection_id,x_m,y_m\n0,1,a,1,0,5\n2,2,a,1,10,-5\n4,5,a,1,3,3\n";
    let found = look(text, serde_json::json!({"time_base": "utc"}));
    assert_eq!((found.scans, found.rows, found.units.used), (3, 3, 3));
    assert_eq!(found.sensors[0].period_s, Some(2.0));
    assert_eq!(found.area.unwrap().x_m, [0.0, 10.0]);
    assert_eq!(
        found.time,
        Some(TimeSpan {
            start_s: 0.0,
            end_s: 4.0
        })
    );
    assert_eq!(found.time_base, TimeBase::Utc);
    assert!(
        found.suspicions[0].starts_with("2 scans are missing"),
        "{:?}",
        found.suspicions
    );
    assert_eq!(found.job["input"]["path"], "a.csv");
}

#[test]
fn degrees_in_columns_of_metres_are_told() {
    let degrees = truth(
        "x_m,y_m",
        (0..5).map(|step| format!("{step},A,{},50.77", -1.2 + 1e-5 * f64::from(step))),
    );
    let found = look(&degrees, serde_json::json!({}));
    assert!(
        found.suspicions[0].contains("look like degrees"),
        "{:?}",
        found.suspicions
    );
    let walking = truth(
        "x_m,y_m",
        (0..5).map(|step| format!("{step},A,{step},50.77")),
    );
    assert_eq!(look(&walking, serde_json::json!({})).suspicions, [""; 0]);
}

#[test]
fn kilometres_and_knots_are_told_from_the_velocities() {
    let moving = |unit: f64, said: f64| {
        let row = |step: u32| format!("{step},A,{},0,{said},0", f64::from(step) * 20.0 * unit);
        look(
            &truth("x_m,y_m,vx_mps,vy_mps", (0..20).map(row)),
            serde_json::json!({}),
        )
        .suspicions
    };
    assert!(moving(0.001, 20.0)[0].contains("kilometres"));
    assert!(moving(1.0, 20.0 / 0.514444)[0].contains("knots"));
    assert_eq!(moving(1.0, 20.0), [""; 0]);
}

#[test]
fn jumps_and_unix_times_are_told() {
    let row = |step: u32| {
        format!(
            "{},A,{},0",
            1_700_000_000 + u64::from(step),
            if step == 3 { 9e5 } else { 0.0 }
        )
    };
    let found = look(&truth("x_m,y_m", (0..6).map(row)), serde_json::json!({}));
    assert!(
        found.suspicions[0].contains("seconds since 1970"),
        "{:?}",
        found.suspicions
    );
    assert!(
        found.suspicions[1].starts_with("2 steps are faster than sound"),
        "{:?}",
        found.suspicions
    );
}

/// The corners of the box around the places say little of a wide area, and nothing of one across 180°.
#[test]
fn latitudes_and_longitudes_are_those_of_the_data() {
    let rows = ["10,170", "20,-170", "-30,175", "60,-150"].into_iter();
    let rows = rows
        .zip(0..)
        .map(|(row, time_s)| format!("{time_s},a,{row}"));
    let origin = serde_json::json!({"origin": {"lat_deg": 0, "lon_deg": 180}});
    let area = look(&truth("lat_deg,lon_deg", rows), origin).area.unwrap();
    let spans = [area.lat_deg.unwrap(), area.lon_deg.unwrap()].concat();
    for (found, expected) in spans.iter().zip([-30.0, 60.0, 170.0, -150.0]) {
        assert!((found - expected).abs() < 1e-9, "{spans:?}");
    }
}

fn detections(rows: impl Iterator<Item = String>) -> String {
    let rows: Vec<String> = rows.collect();
    format!("time_s,scan,sensor_id,x_m,y_m\n{}\n", rows.join("\n"))
}

#[test]
fn kilometres_are_told_without_velocities() {
    let none = || serde_json::json!({});
    // Aircraft at 200 m/s far from the origin: of truth, and of detections.
    let moving = |unit: f64| {
        let row = move |step: u32| {
            let x = (150_000.0 + 800.0 * f64::from(step)) * unit;
            format!("{},A,{x},{}", 4 * step, 200_000.0 * unit)
        };
        look(&truth("x_m,y_m", (0..20).map(row)), none()).suspicions
    };
    assert!(
        moving(0.001)[0].contains("at 0.2000 m/s"),
        "{:?}",
        moving(0.001)
    );
    assert_eq!(moving(1.0), [""; 0]);
    let seen = |unit: f64| {
        let row = |at: u32| {
            let (step, noise_m) = (at / 2, f64::from(at * at * 37 % 100));
            let x = (150_000.0 + 800.0 * f64::from(step) + noise_m) * unit;
            let y = (20_000.0 + 90_000.0 * f64::from(at % 2)) * unit;
            format!("{},{step},a,{x},{y}", 4 * step)
        };
        look(&detections((0..40).map(row)), none()).suspicions
    };
    assert!(seen(0.001)[0].contains("kilometres"), "{:?}", seen(0.001));
    assert_eq!(seen(1.0), [""; 0]);
    // What lies still is no slow mover.
    let still = |step: u32| format!("{step},A,{},0", f64::from(step * step * 37 % 10));
    assert_eq!(
        look(&truth("x_m,y_m", (0..40).map(still)), none()).suspicions,
        [""; 0]
    );
}

#[test]
fn clocks_an_hour_apart_and_detections_that_nothing_follows_are_told() {
    let of = |late_s: u32| {
        let row = |at: u32| {
            let (step, is_b) = (at / 2, at % 2 == 1);
            let time_s = 4 * step + if is_b { late_s } else { 0 };
            format!(
                "{time_s},{step},{},{},7",
                if is_b { "b" } else { "a" },
                20 * step
            )
        };
        look(&detections((0..60).map(row)), serde_json::json!({})).suspicions
    };
    assert_eq!(of(0), [""; 0]);
    assert_eq!(
        of(3601),
        [
            "the times of sensor 'b' are those of sensor 'a' but for 1 hour: `clock_offset_s` -3600 of its file puts them together"
        ]
    );
    let scattered = |step: u32| {
        format!(
            "{step},{step},a,{},{}",
            step * 7919 % 10_007 * 100,
            step * 104_729 % 10_009 * 100
        )
    };
    let found = look(&detections((0..40).map(scattered)), serde_json::json!({})).suspicions;
    assert!(
        found[0].starts_with("nothing ever lies within a gate"),
        "{found:?}"
    );
}

#[test]
fn what_was_seen_is_held_against_the_truth() {
    let walk = |late_s: f64, unit: f64| {
        let row = move |step: u32| {
            let time_s = 10.0 * f64::from(step) + late_s;
            format!(
                "{time_s},{step},a,{},{}",
                f64::from(50 * step) * unit,
                300.0 * unit
            )
        };
        let text = detections((0..50).map(row));
        let path = |step: u32| format!("{},A,{},300", 10 * step, 50 * step);
        let truth = truth("x_m,y_m", (0..50).map(path));
        let read = |text: &str| {
            let read = read_file("a.csv", &mut text.as_bytes(), None, &ReadOptions::default());
            read.unwrap().0.dataset
        };
        let Dataset::Truth(truth) = read(&truth) else {
            panic!("no truth");
        };
        suspicions_beside_truth(&read(&text), &truth)
    };
    assert_eq!(walk(0.0, 1.0), [""; 0]);
    assert_eq!(
        walk(7200.0, 1.0),
        [
            "nothing lies near the truth as its times are, 100 % does 2 hours earlier: `clock_offset_s` -7200 reads the file so"
        ]
    );
    assert_eq!(
        walk(1e6, 1.0),
        ["the file and the truth have no time in common"]
    );
    assert!(walk(0.0, 40.0)[0].starts_with("nothing ever lies within 122 m of the truth"));
}
