//! Requirements of radars, of what is false or dubious, of the accuracy of the truth, and of campaigns; causes by the job's sensors.

use super::{judged, table};
use crate::origins::jobs::Texts;
use serde_json::{Value, json};
use trackloom_domain::experiment::{JobKind, Outcome};

fn held(truth: &str, tracks: &str, requirements: Value) -> Outcome {
    let settings = json!({"profile": "vision", "metrics": [], "requirements": requirements});
    judged(truth, tracks, settings)
}

#[track_caller]
fn finding<'o>(outcome: &'o Outcome, name: &str) -> &'o Value {
    let findings = outcome.result["requirements"]["findings"].as_array();
    let mut findings = findings.unwrap().iter();
    findings.find(|one| one["requirement"] == name).unwrap()
}

#[track_caller]
fn near(found: &Value, wanted: f64, within: f64) {
    let found = found.as_f64().unwrap();
    assert!((found - wanted).abs() <= within, "{found}, not {wanted}");
}

fn standing(times: std::ops::Range<u32>, of: &str) -> Vec<String> {
    times.map(|time| format!("{time},{of}")).collect()
}

/// The worked examples: truth at (3000, 4000), seen at (3030, 4040) and at (3010, 4000) from a radar at the origin.
#[test]
fn a_radar_has_errors_of_range_and_azimuth() {
    let truth = table("time_s,truth_id,x_m,y_m", standing(0..10, "A,3000,4000"));
    let items = json!({"gate_m": 1000.0, "items": [
        {"requirement": "radar_range", "x_m": 0.0, "y_m": 0.0, "max_m": 70.0, "at_least": 0.9},
        {"requirement": "radar_range", "name": "strict", "x_m": 0.0, "y_m": 0.0, "max_m": 49.0, "at_least": 0.9},
        {"requirement": "radar_azimuth", "x_m": 0.0, "y_m": 0.0, "max_deg": 0.08, "at_least": 0.9}
    ]});
    let far = table("time_s,track_id,x_m,y_m", standing(0..10, "T,3030,4040"));
    let outcome = held(&truth, &far, items.clone());
    near(
        &finding(&outcome, "radar_range")["errors"]["mean"],
        50.0,
        1e-9,
    );
    near(
        &finding(&outcome, "radar_azimuth")["errors"]["mean"],
        0.0,
        1e-9,
    );
    assert_eq!(finding(&outcome, "radar_range")["verdict"], "pass");
    assert_eq!(finding(&outcome, "strict")["value"], 0.0);
    // All measured the same: a straight line has no slope then.
    assert!(
        finding(&outcome, "radar_range")["errors"]
            .get("line")
            .is_none()
    );
    let beside = table("time_s,track_id,x_m,y_m", standing(0..10, "T,3010,4000"));
    let outcome = held(&truth, &beside, items);
    near(
        &finding(&outcome, "radar_azimuth")["errors"]["mean"],
        0.0916,
        5e-5,
    );
    assert_eq!(finding(&outcome, "radar_azimuth")["verdict"], "fail");
}

/// Going away from a radar at (1000, 0) whose ranges are 1 % too long, and 20 m; sensor b is no part of it.
#[test]
fn bias_and_gain_are_those_of_one_sensor() {
    let truth_rows = (0..50).map(|time| format!("{time},A,{},0", 2000 + 100 * time));
    let truth = table("time_s,truth_id,x_m,y_m", truth_rows);
    let seen = |time: u32| {
        let range_m = 1.01 * f64::from(1000 + 100 * time) + 20.0;
        format!(
            "{time},T,{},0,{}",
            1000.0 + range_m,
            if time % 5 == 4 { "b" } else { "a" }
        )
    };
    let tracks = table("time_s,track_id,x_m,y_m,sensor_id", (0..50).map(seen));
    let item = json!({"requirement": "radar_range", "sensor_id": "a", "x_m": 1000.0, "y_m": 0.0, "max_m": 60.0});
    let outcome = held(&truth, &tracks, json!({"gate_m": 1000.0, "items": [item]}));
    let found = finding(&outcome, "radar_range");
    assert_eq!(found["denominator"], 40);
    assert_eq!(found["not_judged"], json!({"other_sensor": 10}));
    // reference = (measured − 20) / 1.01.
    near(&found["errors"]["line"]["gain"], 1.0 / 1.01, 1e-9);
    near(&found["errors"]["line"]["bias"], -20.0 / 1.01, 1e-6);
}

#[test]
fn a_radar_without_a_place_is_a_fault() {
    let truth = table("time_s,truth_id,x_m,y_m", standing(0..10, "A,0,0"));
    let tracks = table("time_s,track_id,x_m,y_m", standing(0..10, "T,0,0"));
    let mut texts = Texts::of("csv");
    let mut body = json!({"truth": texts.dataset(&truth), "tracks": texts.dataset(&tracks)});
    body["requirements"] = json!({"presets": [{"preset": "radar_5s"}], "items": [
        {"requirement": "radar_range", "max_m": 1.0},
        {"requirement": "false_tracks", "per_km2": 1000.0}
    ]});
    let faults = texts.judge(&body).unwrap_err();
    let told: Vec<(&str, &str)> = faults
        .iter()
        .map(|fault| (fault.pointer.as_str(), fault.code.as_str()))
        .collect();
    let wanted = [
        ("/requirements/items/0/sensor_id", "missing"),
        ("/requirements/items/1/per_km2", "unsupported"),
    ];
    assert_eq!(told, wanted);
}

/// One target for an hour, two plots of nobody, and one track of nobody of 20 updates.
#[test]
fn what_is_of_no_target_is_counted_by_update_and_by_hour_and_area() {
    let rows: Vec<String> = (0..=720).map(|at| format!("{},A,0,0", 5 * at)).collect();
    let truth = table("time_s,truth_id,x_m,y_m", rows);
    let mut rows: Vec<String> = (0..=720).map(|at| format!("{},T,0,0", 5 * at)).collect();
    rows.extend((0..20).map(|at| format!("{},N,9000,{}", 100 + 5 * at, 100 * at)));
    rows.extend(["700,P,-9000,0".to_owned(), "900,Q,0,-9000".to_owned()]);
    // Outside of the sector.
    rows.push("950,R,0,90000".to_owned());
    let tracks = table("time_s,track_id,x_m,y_m", rows);
    let square = json!([{"x_m": -1e4, "y_m": -1e4}, {"x_m": 1e4, "y_m": -1e4}, {"x_m": 1e4, "y_m": 1e4}, {"x_m": -1e4, "y_m": 1e4}]);
    let sector = json!({"sector_id": "s", "areas": [{"kind": "polygon", "corners": square}]});
    let outcome = held(
        &truth,
        &tracks,
        json!({"gate_m": 1000.0, "sectors": [sector], "items": [
            {"requirement": "false_updates", "at_most": 0.01},
            {"requirement": "false_tracks", "name": "an_hour"},
            {"requirement": "false_tracks", "name": "an_hour_and_area", "per_km2": 1000.0},
            {"requirement": "dubious_tracks", "needs_code": false},
            {"requirement": "dubious_tracks", "name": "unnamed"}
        ]}),
    );
    let counts = |name: &str| {
        (
            finding(&outcome, name)["numerator"].clone(),
            finding(&outcome, name)["denominator"].clone(),
        )
    };
    assert_eq!(counts("false_updates"), (json!(22), json!(743)));
    near(&finding(&outcome, "an_hour")["value"], 3.0, 1e-12);
    // 400 km² are 0.4 times the area.
    near(&finding(&outcome, "an_hour_and_area")["value"], 7.5, 1e-12);
    assert_eq!(counts("dubious_tracks"), (json!(2), json!(4)));
    assert_eq!(counts("unnamed"), (json!(4), json!(4)));
    let values = &outcome.result["requirements"]["values"]["s"];
    assert_eq!(values["false_updates"]["met"], false);
    near(&values["an_hour_and_area"]["value"], 7.5, 1e-12);
}

/// Tracks that are too fast, turn, accelerate or climb too much in one update of ten; one that does so once in thirty is sound.
#[test]
fn tracks_that_nothing_flies_are_dubious() {
    let truth = table("time_s,truth_id,x_m,y_m", standing(0..10, "A,0,0"));
    let wild = [
        ("fast", 9, "700,0", 1000),
        ("turn", 9, "-200,0", 1000),
        ("boost", 9, "400,0", 1000),
        ("climb", 9, "200,0", 3000),
        ("sound", 29, "700,0", 1000),
    ];
    let mut rows = Vec::new();
    for (name, count, odd, height_m) in wild {
        for step in 0..count {
            rows.push(format!("{},{name},0,0,200,0,1000,ABC", 5 * step));
        }
        rows.push(format!("{},{name},0,0,{odd},{height_m},ABC", 5 * count));
    }
    let tracks = table(
        "time_s,track_id,x_m,y_m,vx_mps,vy_mps,height_m,callsign",
        rows,
    );
    let outcome = held(
        &truth,
        &tracks,
        json!({"gate_m": 1000.0, "items": [{"requirement": "dubious_tracks"}]}),
    );
    let events = outcome
        .artifacts
        .iter()
        .find(|file| file.name == "requirement_events.csv");
    let text = String::from_utf8(events.unwrap().bytes.clone()).unwrap();
    let found: Vec<&str> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').nth(2).unwrap())
        .collect();
    assert_eq!(found, ["boost", "climb", "fast", "turn"]);
}

#[test]
fn a_truth_that_says_it_is_inaccurate_judges_nobody() {
    let rows = (0..20).map(|time| {
        format!(
            "{time},A,0,0,{}",
            if time < 5 {
                "80"
            } else if time < 10 {
                "30"
            } else {
                ""
            }
        )
    });
    let truth = table("time_s,truth_id,x_m,y_m,position_accuracy_m", rows);
    let tracks = table(
        "time_s,track_id,x_m,y_m",
        (0..20).map(|time| format!("{}.5,T,100,0", time)),
    );
    let items = json!({"gate_m": 1000.0, "items": [
        {"requirement": "position_rms", "reference_accuracy_m": 35.0, "at_most": 350.0},
        {"requirement": "position_rms", "name": "anybody"}
    ]});
    let outcome = held(&truth, &tracks, items);
    // 4.5 s lies between a point of 80 m and one of 30 m; after the last point there is no truth.
    let wanted = json!({"no_reference": 1, "reference_inaccurate": 5});
    assert_eq!(finding(&outcome, "position_rms")["not_judged"], wanted);
    assert_eq!(finding(&outcome, "position_rms")["denominator"], 14);
    assert_eq!(finding(&outcome, "anybody")["denominator"], 19);
}

/// A campaign keeps what runs say of requirements, and holds it against limits.
#[test]
fn requirements_are_outcomes_and_limits_of_campaigns() {
    let base = json!({"kind": "evaluate", "input": {"source": "preset", "preset": "liang2009-10"},
        "comparison": {"gate_m": 1000.0},
        "requirements": {"reference_reach_s": 100.0, "items": [{"requirement": "detection", "update_interval_s": 20.0, "at_least": 0.1}]}});
    let (value, met) = (
        "requirements.values.everywhere.detection",
        "requirements.values.everywhere.detection.met",
    );
    let body = json!({"base": base, "runs": 3, "seed": 5,
        "outcomes": [{"name": "P_U", "path": value}, {"name": "met", "path": met, "interval": "wilson"}],
        "limits": [{"quantity": "P_U", "at_least": 0.1}, {"quantity": "met", "at_least": 1.0}]});
    let outcome = Texts::of("csv").run(JobKind::Campaign, &body).unwrap();
    let cell = &outcome.result["cells"][0]["outcomes"];
    let mean = cell["P_U"]["mean"]
        .as_f64()
        .unwrap_or_else(|| panic!("{cell:#}"));
    assert!(mean > 0.1 && mean <= 1.0, "{mean}");
    let checks = &outcome.result["limits"]["checks"];
    assert_eq!(checks.as_array().map(Vec::len), Some(2), "{checks:#}");
    assert_eq!(outcome.result["limits"]["met"], true, "{checks:#}");
}

/// The file says nothing of the radar; the job says that it sees 500 m.
#[test]
fn causes_know_the_sensors_of_the_job() {
    let mut texts = Texts::of("csv");
    let rows = (0..4).map(|time| format!("{time},A,0,0\n{time},D,900,0"));
    let truth = texts.dataset(&table("time_s,truth_id,x_m,y_m", rows));
    let tracks = texts.dataset(&table("time_s,track_id,x_m,y_m", standing(0..4, "1,0,0")));
    let seen = (0..4).map(|time| format!("{time},{},r,0,0", time + 1));
    let detections = texts.dataset(&table("time_s,scan,sensor_id,x_m,y_m", seen));
    let radar = json!([{"sensor_id": "r", "x_m": 0.0, "y_m": 0.0, "max_range_m": 500.0}]);
    for (sensors, cause) in [(None, "no_detection"), (Some(radar), "outside_coverage")] {
        let mut body = json!({"truth": truth, "tracks": tracks, "detections": detections,
            "metrics": [{"metric": "clear"}], "comparison": {"gate_m": 10.0}, "profile": "vision"});
        if let Some(sensors) = sensors {
            body["sensors"] = sensors;
        }
        let outcome = texts.judge(&body).unwrap();
        let mut files = outcome.artifacts.iter();
        let file = files.find(|file| file.name == "causes.csv").unwrap();
        let text = String::from_utf8(file.bytes.clone()).unwrap();
        let row = format!("miss,{cause},");
        assert!(text.lines().any(|line| line.starts_with(&row)), "{text}");
    }
}
