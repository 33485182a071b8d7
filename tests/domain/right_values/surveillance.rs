//! Requirements of air surveillance: worked examples, what cannot be judged, and what must not change.

use super::{judged, table};
use crate::origins::jobs::Texts;
use serde_json::{Value, json};
use trackloom_domain::experiment::Outcome;
use trackloom_domain::model::fault::Fault;

const TRUTH: &str = "time_s,truth_id,x_m,y_m,address,callsign,mode_a,mode_c_ft";
const TRACKS: &str = "time_s,track_id,x_m,y_m,address,callsign,mode_a,mode_c_ft";

/// Settings of a job that holds requirements and nothing else.
fn only(requirements: Value) -> Value {
    json!({"profile": "vision", "metrics": [], "requirements": requirements})
}

fn held(truth: &str, tracks: &str, items: Value) -> Outcome {
    judged(truth, tracks, only(json!({"items": items})))
}

#[track_caller]
fn finding<'o>(outcome: &'o Outcome, name: &str) -> &'o Value {
    let findings = outcome.result["requirements"]["findings"]
        .as_array()
        .unwrap();
    let of_name = |finding: &&Value| finding["requirement"] == name;
    findings.iter().find(of_name).unwrap()
}

/// Numerator and denominator.
#[track_caller]
fn counts(outcome: &Outcome, name: &str) -> (u64, u64) {
    let finding = finding(outcome, name);
    let of = |field: &str| finding[field].as_u64().unwrap();
    (of("numerator"), of("denominator"))
}

#[track_caller]
fn value(outcome: &Outcome, name: &str) -> f64 {
    finding(outcome, name)["value"].as_f64().unwrap()
}

fn events(outcome: &Outcome) -> Vec<String> {
    let named = |artifact: &&trackloom_domain::experiment::Artifact| {
        artifact.name == "requirement_events.csv"
    };
    let file = outcome.artifacts.iter().find(named).unwrap();
    let text = String::from_utf8(file.bytes.clone()).unwrap();
    text.lines().skip(1).map(str::to_owned).collect()
}

/// Rows of one object each second or at other times, going east at 10 m/s, with what follows the place.
fn going(name: &str, times_s: &[f64], codes: &str) -> Vec<String> {
    let row = |time_s: &f64| format!("{time_s},{name},{},0,{codes}", 10.0 * time_s);
    times_s.iter().map(row).collect()
}

fn every(step_s: f64, from_s: f64, to_s: f64) -> Vec<f64> {
    let count = ((to_s - from_s) / step_s).round() as usize;
    (0..=count)
        .map(|index| from_s + step_s * index as f64)
        .collect()
}

fn truth(codes: &str) -> String {
    table(TRUTH, going("A", &every(1.0, 0.0, 60.0), codes))
}

fn tracks(times_s: &[f64], codes: &str) -> String {
    table(TRACKS, going("T", times_s, codes))
}

const CODES: &str = "3C660C,DLH65A,1000,10000";

#[test]
fn updates_and_gaps_of_a_whole_job() {
    let times_s = [1.0, 6.0, 11.0, 16.0, 31.0, 36.0, 41.0, 46.0, 51.0, 56.0];
    let items = json!([
        {"requirement": "detection", "update_interval_s": 5.0, "tolerance_s": 0.1, "at_least": 0.9},
        {"requirement": "detection", "name": "strict", "update_interval_s": 5.0, "at_least": 0.7},
        {"requirement": "detection", "name": "slots", "update_interval_s": 5.0, "count": "slots"}
    ]);
    let outcome = held(&truth(CODES), &tracks(&times_s, CODES), items);
    assert_eq!(counts(&outcome, "detection"), (10, 12));
    assert_eq!(counts(&outcome, "strict"), (9, 12));
    assert_eq!(counts(&outcome, "slots"), (10, 12));
    let found = finding(&outcome, "detection");
    assert_eq!(found["verdict"], "fail");
    assert!((found["margin"].as_f64().unwrap() - (10.0 / 12.0 - 0.9)).abs() < 1e-12);
    assert_eq!(found["failed_targets"][0]["truth_id"], "A");
    assert_eq!(finding(&outcome, "strict")["verdict"], "pass");
    assert_eq!(finding(&outcome, "slots")["verdict"], Value::Null);
    assert_eq!(
        events(&outcome)[0],
        "16,A,,everywhere,detection,gap,15,s,160,0"
    );
    let limits = &outcome.result["limits"];
    assert_eq!(limits["met"], false);
    assert_eq!(limits["checks"].as_array().unwrap().len(), 2);
    assert_eq!(
        limits["checks"][0]["quantity"],
        "requirements.everywhere.detection"
    );
}

#[test]
fn no_update_at_all_is_one_gap() {
    let items = json!([{"requirement": "detection", "update_interval_s": 5.0, "tolerance_s": 0.1}]);
    let outcome = held(&truth(CODES), &format!("{TRACKS}\n"), items);
    assert_eq!(counts(&outcome, "detection"), (1, 12));
    assert_eq!(finding(&outcome, "detection")["targets_without_update"], 1);
}

#[test]
fn along_is_ahead_across_is_right_and_late_is_positive() {
    let truth_rows = (0..20).map(|time| format!("{time},A,{},0,200,0", 200 * time));
    let truth = table("time_s,truth_id,x_m,y_m,vx_mps,vy_mps", truth_rows);
    let track_rows = (0..20).map(|time| format!("{time},T,{},40", 200 * time - 30));
    let tracks = table("time_s,track_id,x_m,y_m", track_rows);
    let items = json!([
        {"requirement": "along", "max_m": 70.0, "at_least": 0.9},
        {"requirement": "across", "max_m": 39.0, "at_least": 0.9},
        {"requirement": "latency", "max_s": 0.5, "at_least": 0.9},
        {"requirement": "position_within", "distance_m": 50.0},
        {"requirement": "position_beyond", "distance_m": 50.0},
        {"requirement": "position_beyond", "name": "farther", "distance_m": 50.0, "inclusive": false},
        {"requirement": "position_rms", "at_most": 50.0}
    ]);
    let outcome = held(&truth, &tracks, items);
    let mean = |name: &str| finding(&outcome, name)["errors"]["mean"].as_f64().unwrap();
    for (name, wanted) in [("along", -30.0), ("across", -40.0), ("latency", 0.15)] {
        assert!((mean(name) - wanted).abs() < 1e-9, "{name} {}", mean(name));
    }
    assert_eq!(counts(&outcome, "along"), (20, 20));
    assert_eq!(counts(&outcome, "across"), (0, 20));
    assert_eq!(counts(&outcome, "position_within"), (20, 20));
    assert_eq!(counts(&outcome, "position_beyond"), (20, 20));
    assert_eq!(counts(&outcome, "farther"), (0, 20));
    assert_eq!(finding(&outcome, "position_rms")["verdict"], "pass");
}

#[test]
fn identity_is_right_or_wrong_by_any_or_by_all() {
    let said = ["3C660C,,1000,", "3C660C,DLH65B,1000,", ",,2000,", ",,,"];
    let rows = said
        .iter()
        .enumerate()
        .map(|(time, codes)| format!("{},T,{},0,{codes}", time + 1, 10 * (time + 1)));
    let items = json!([
        {"requirement": "identity_correct", "name": "any"},
        {"requirement": "identity_correct", "name": "all", "rule": "all"},
        {"requirement": "identity_false", "name": "any_false"},
        {"requirement": "identity_false", "name": "all_false", "rule": "all"}
    ]);
    let outcome = held(&truth(CODES), &table(TRACKS, rows), items);
    let found = ["any", "all", "any_false", "all_false"].map(|name| counts(&outcome, name));
    assert_eq!(found, [(2, 4), (0, 4), (2, 3), (0, 3)]);
    let left_out = &finding(&outcome, "any_false")["not_judged"];
    assert_eq!(left_out, &json!({"no_code": 1}));
}

/// Tracks of one point at 2 s each, between points of the truth at 0 and 4 s with these codes.
fn between(codes: [&str; 2], said: &[&str], items: Value) -> Outcome {
    let of = |name: &str, time_s: f64, codes: &str| going(name, &[time_s], codes);
    let truth = [of("A", 0.0, codes[0]), of("A", 4.0, codes[1])].concat();
    let said = said.iter().enumerate();
    let tracks = said.flat_map(|(track, codes)| of(&format!("T{track}"), 2.0, codes));
    held(&table(TRUTH, truth), &table(TRACKS, tracks), items)
}

#[test]
fn a_code_is_right_before_and_after_a_change() {
    let items = json!([
        {"requirement": "mode_a_false"},
        {"requirement": "code_present", "code": "mode_a"}
    ]);
    let said = [",,1000,", ",,2000,", ",,3000,", ",,,"];
    let outcome = between([",,1000,", ",,2000,"], &said, items);
    assert_eq!(counts(&outcome, "mode_a_false"), (1, 3));
    assert_eq!(counts(&outcome, "code_present"), (3, 4));
    assert!(events(&outcome)[0].starts_with("2,A,T2,everywhere,mode_a_false,"));
}

#[test]
fn codes_are_written_row_by_row() {
    let truth = [
        going("A", &[0.0], "ABCDEF,,1000,100"),
        going("A", &[1.0], "ABCDEF,,,200"),
        going("A", &[2.0], "ABCDEF,,2000,200"),
    ];
    let (truth, track) = (table(TRUTH, truth.concat()), tracks(&[0.0, 2.0], ",,,"));
    let outcome = held(&truth, &track, json!([{"requirement": "position_rms"}]));
    let named = |artifact: &&trackloom_domain::experiment::Artifact| artifact.name == "truth.csv";
    let file = outcome.artifacts.iter().find(named).unwrap();
    let text = String::from_utf8(file.bytes.clone()).unwrap();
    let wanted = [
        "time_s,truth_id,x_m,y_m,address,mode_a,mode_c_ft",
        "0,A,0,0,ABCDEF,1000,100",
        "1,A,10,0,ABCDEF,,200",
        "2,A,20,0,ABCDEF,2000,200",
    ];
    assert_eq!(text.lines().collect::<Vec<_>>(), wanted);
}

#[test]
fn a_height_is_right_within_300_ft_of_one_of_both() {
    let items = json!([{"requirement": "mode_c_correct"}, {"requirement": "mode_c_false"}]);
    let said = [",,,10250", ",,,10700", ",,,10701", ",,,"];
    let outcome = between([",,,10000", ",,,10400"], &said, items);
    assert_eq!(counts(&outcome, "mode_c_correct"), (2, 4));
    assert_eq!(counts(&outcome, "mode_c_false"), (1, 3));
}

#[test]
fn an_identity_that_is_never_right_is_a_gap_of_the_whole_period() {
    let times_s = every(5.0, 0.0, 60.0);
    let items = json!([{"requirement": "identity_update", "of": ["address"], "update_interval_s": 5.0, "tolerance_s": 0.1}]);
    let wrong = |is_wrong: fn(f64) -> bool| {
        let rows = times_s.iter().flat_map(|&time_s| {
            let address = if is_wrong(time_s) { "3C0000" } else { "3C660C" };
            going("T", &[time_s], &format!("{address},,,"))
        });
        let outcome = held(&truth(CODES), &table(TRACKS, rows), items.clone());
        counts(&outcome, "identity_update")
    };
    assert_eq!(wrong(|time_s| (20.0..=30.0).contains(&time_s)), (9, 12));
    assert_eq!(wrong(|_| true), (1, 12));
    assert_eq!(wrong(|_| false), (12, 12));
}

#[test]
fn extra_tracks_and_extra_data_are_counted_by_updates() {
    let truth_90 = table(TRUTH, going("A", &every(5.0, 0.0, 90.0), CODES));
    let two = [
        going("T1", &every(5.0, 0.0, 60.0), ",,,"),
        going("T2", &every(5.0, 30.0, 90.0), ",,,"),
    ];
    let outcome = held(
        &truth_90,
        &table(TRACKS, two.concat()),
        json!([{"requirement": "extra_track", "at_most": 0.0}]),
    );
    assert_eq!(counts(&outcome, "extra_track"), (14, 26));
    let truth_60 = table(TRUTH, going("A", &every(5.0, 0.0, 60.0), CODES));
    let items = json!([
        {"requirement": "extra_data"},
        {"requirement": "extra_data", "name": "long", "min_duration_s": 36.0}
    ]);
    let outcome = held(&truth_60, &tracks(&every(5.0, 0.0, 100.0), ",,,"), items);
    assert_eq!(counts(&outcome, "extra_data"), (8, 21));
    assert_eq!(counts(&outcome, "long"), (0, 13));
}

#[test]
fn extra_data_are_looked_for_where_updates_are() {
    // The truth is inside to 30 s; updates 20 m ahead of it leave the sector with that of 30 s, and one that comes back is extra.
    let row =
        |time_s: &f64, ahead_m: f64| format!("{time_s},T,{},0,3C660C,,,", 10.0 * time_s + ahead_m);
    let mut rows: Vec<String> = every(5.0, 0.0, 30.0)
        .iter()
        .map(|time_s| row(time_s, 20.0))
        .collect();
    rows.extend(
        every(5.0, 35.0, 60.0)
            .iter()
            .map(|time_s| row(time_s, 290.0 - 10.0 * time_s)),
    );
    let requirements = json!({
        "sectors": [{"sector_id": "s", "areas": [{"kind": "polygon", "corners": [
            {"x_m": -10.0, "y_m": -10.0}, {"x_m": 305.0, "y_m": -10.0}, {"x_m": 305.0, "y_m": 10.0}, {"x_m": -10.0, "y_m": 10.0}]}]}],
        "gate_m": 1000.0, "items": [{"requirement": "extra_data"}]
    });
    let outcome = judged(&truth(CODES), &table(TRACKS, rows), only(requirements));
    assert_eq!(counts(&outcome, "extra_data"), (6, 12));
    assert_eq!(
        finding(&outcome, "extra_data")["not_judged"],
        json!({"outside": 1})
    );
}

#[test]
fn speeds_and_courses_are_held_against_the_truth() {
    let header = "time_s,truth_id,x_m,y_m,vx_mps,vy_mps";
    let rows = |id: &str, east_mps: f64, north_mps: f64| -> Vec<String> {
        (0..10)
            .map(|time| format!("{time},{id},{},0,{east_mps},{north_mps}", 100 * time))
            .collect()
    };
    let items = json!([
        {"requirement": "speed", "max_difference_mps": 5.0},
        {"requirement": "speed", "name": "tenth", "max_difference_mps": 5.0, "max_share": 0.1},
        {"requirement": "course", "max_difference_deg": 5.0},
        {"requirement": "course", "name": "fast", "max_difference_deg": 5.0, "min_speed_mps": 101.0}
    ]);
    let truth = table(header, rows("A", 100.0, 0.0));
    let tracks = table(&header.replace("truth", "track"), rows("T", 108.0, 10.0));
    let outcome = held(&truth, &tracks, items);
    let found = ["speed", "tenth", "course"].map(|name| counts(&outcome, name));
    assert_eq!(found, [(0, 10), (10, 10), (0, 10)]);
    let error = finding(&outcome, "course")["errors"]["mean"]
        .as_f64()
        .unwrap();
    assert!((error + (10.0f64 / 108.0).atan().to_degrees()).abs() < 1e-9);
    assert_eq!(finding(&outcome, "fast")["not_judged"], json!({"slow": 10}));
}

#[test]
fn what_cannot_be_judged_is_null_with_a_reason_and_not_met() {
    let items = json!([
        {"requirement": "identity_correct", "at_least": 0.0},
        {"requirement": "mode_c_false", "at_most": 1.0},
        {"requirement": "speed", "max_difference_mps": 5.0, "at_least": 0.0},
        {"requirement": "position_within", "distance_m": 5.0, "at_least": 0.0},
        {"requirement": "detection", "update_interval_s": 100.0, "at_least": 0.0}
    ]);
    let none = ",,,";
    let outcome = held(&truth(none), &tracks(&every(5.0, 0.0, 60.0), none), items);
    for (name, reason) in [
        ("identity_correct", "no_reference_identity"),
        ("mode_c_false", "no_reference_code"),
        ("speed", "no_velocity"),
    ] {
        let found = finding(&outcome, name);
        assert_eq!(found["value"], Value::Null, "{name}");
        assert_eq!(found["verdict"], Value::Null, "{name}");
        assert_eq!(found["not_judged"], json!({reason: 13}), "{name}");
    }
    assert_eq!(finding(&outcome, "detection")["value"], Value::Null);
    assert_eq!(finding(&outcome, "position_within")["verdict"], "pass");
    let checks = outcome.result["limits"]["checks"].as_array().unwrap();
    let met: Vec<bool> = checks
        .iter()
        .map(|check| check["met"].as_bool().unwrap())
        .collect();
    assert_eq!(met, [false, false, false, true, false]);
    assert_eq!(
        checks[0]["reason"],
        "nothing could be judged: 13 no_reference_identity"
    );
}

const ALL: &str = r#"[
    {"requirement": "detection", "update_interval_s": 1.0, "at_least": 1.0},
    {"requirement": "position_rms", "at_most": 0.0},
    {"requirement": "identity_correct", "rule": "all", "at_least": 1.0},
    {"requirement": "identity_false", "at_most": 0.0},
    {"requirement": "mode_c_correct", "at_least": 1.0},
    {"requirement": "extra_data", "at_most": 0.0},
    {"requirement": "extra_track", "at_most": 0.0},
    {"requirement": "false_tracks", "at_most": 0.0},
    {"requirement": "continuity", "at_most": 0.0},
    {"requirement": "longest_track", "at_least": 1.0},
    {"requirement": "initiation_delay", "max_delay_s": 0.0, "at_least": 1.0}
]"#;

fn all() -> Value {
    serde_json::from_str(ALL).unwrap()
}

#[test]
fn a_copy_of_the_truth_meets_everything_and_half_of_it_half_the_updates() {
    let outcome = held(&truth(CODES), &tracks(&every(1.0, 0.0, 60.0), CODES), all());
    assert_eq!(
        outcome.result["limits"]["met"], true,
        "{:#}",
        outcome.result
    );
    assert_eq!(events(&outcome), Vec::<String>::new());
    assert_eq!(value(&outcome, "position_rms"), 0.0);
    let outcome = held(&truth(CODES), &tracks(&every(2.0, 0.0, 60.0), CODES), all());
    // Gaps of two seconds are two misses each, without a tolerance.
    assert_eq!(counts(&outcome, "detection"), (0, 60));
    assert_eq!(value(&outcome, "position_rms"), 0.0);
}

#[test]
fn a_target_far_away_or_another_sector_changes_no_other_number() {
    let track = tracks(&every(3.0, 0.0, 60.0), CODES);
    let far = |header: &str, name: &str, step_s: f64| {
        let rows = every(step_s, 0.0, 60.0).into_iter();
        let rows = rows.map(|time_s| format!("{time_s},{name},900000,900000,ABCDEF,,,"));
        table(header, rows).split_once('\n').unwrap().1.to_owned()
    };
    let alone = held(&truth(CODES), &track, all());
    let truth = truth(CODES) + &far(TRUTH, "B", 1.0);
    let track = track + &far(TRACKS, "U", 1.0);
    let ring = json!({"kind": "sector", "range_max_m": 10000.0});
    let sectors = json!([
        {"sector_id": "here", "areas": [ring]},
        {"sector_id": "there", "areas": [{"kind": "sector", "x_m": 900000.0, "y_m": 900000.0, "range_max_m": 10.0}]}
    ]);
    let requirements = json!({"items": all(), "sectors": sectors});
    let both = judged(&truth, &track, only(requirements));
    let findings = |outcome: &Outcome, sector: &str| -> Vec<Value> {
        let findings = outcome.result["requirements"]["findings"]
            .as_array()
            .unwrap();
        let of_sector = findings.iter().filter(|one| one["sector_id"] == sector);
        of_sector
            .map(|one| {
                let mut one = one.clone();
                let fields = one.as_object_mut().unwrap();
                fields.remove("sector_id");
                fields.remove("not_judged");
                one
            })
            .collect()
    };
    assert_eq!(findings(&alone, "everywhere"), findings(&both, "here"));
    let there = findings(&both, "there");
    assert_eq!(there[0]["value"], 1.0);
    assert_eq!(there[0]["targets"], 1);
}

#[test]
fn a_recording_in_two_parts_has_the_counts_of_the_whole_and_midnight_is_a_time() {
    let items = json!([
        {"requirement": "detection", "update_interval_s": 5.0, "tolerance_s": 0.1},
        {"requirement": "position_within", "distance_m": 5.0}
    ]);
    let of = |parts: &[(f64, f64)]| -> Vec<[(u64, u64); 2]> {
        let of_part = |&(from_s, to_s): &(f64, f64)| {
            let truth = table(TRUTH, going("A", &every(1.0, from_s, to_s), ",,,"));
            let times_s = every(4.0, from_s, to_s).into_iter();
            let seen: Vec<f64> = times_s.filter(|time_s| time_s % 100.0 > 15.0).collect();
            let outcome = held(&truth, &tracks(&seen, ",,,"), items.clone());
            ["detection", "position_within"].map(|name| counts(&outcome, name))
        };
        parts.iter().map(of_part).collect()
    };
    let whole = of(&[(86_000.0, 86_800.0)]);
    let parts = of(&[(86_000.0, 86_400.0), (86_400.0, 86_800.0)]);
    // No update is at the cut.
    assert_eq!(whole[0][0].1, parts[0][0].1 + parts[1][0].1);
    assert_eq!(whole[0][1].1, parts[0][1].1 + parts[1][1].1);
    assert!(whole[0][0].0 < whole[0][0].1);
}

#[test]
fn a_target_may_fail_by_itself_where_the_sum_does_not() {
    let truth = [
        going("A", &every(1.0, 0.0, 600.0), ",,,"),
        going("B", &every(1.0, 0.0, 600.0), ",,,")
            .iter()
            .map(|row| row.replace(",0,,,,", ",50000,,,,"))
            .collect(),
    ];
    let seen: Vec<f64> = every(5.0, 0.0, 600.0);
    let half = seen.iter().copied().filter(|time_s| *time_s < 500.0);
    let half: Vec<f64> = half.collect();
    let tracks = [
        going("T", &seen, ",,,"),
        going("U", &half, ",,,")
            .iter()
            .map(|row| row.replace(",0,,,,", ",50000,,,,"))
            .collect(),
    ];
    let item = |each: bool| json!({"requirement": "detection", "name": format!("each {each}"), "update_interval_s": 5.0, "tolerance_s": 0.1, "at_least": 0.9, "each_target": each});
    let outcome = held(
        &table(TRUTH, truth.concat()),
        &table(TRACKS, tracks.concat()),
        json!([item(false), item(true)]),
    );
    // B is lost from 495 to 600 s: ⌊104.9 / 5⌋ = 20 misses of 120.
    assert_eq!(counts(&outcome, "each false"), (220, 240));
    assert_eq!(finding(&outcome, "each false")["verdict"], "pass");
    let each = finding(&outcome, "each true");
    assert_eq!(
        (&each["verdict"], &each["failed_target_count"]),
        (&json!("fail"), &json!(1))
    );
    assert_eq!(each["failed_targets"][0]["truth_id"], "B");
}

#[test]
fn sectors_have_heights_and_phases_are_of_the_truth() {
    // Climbs at 10 m/s from 30 s on, up to 300 m.
    let header = "time_s,truth_id,x_m,y_m,height_m";
    let rows = |name: &str| -> Vec<String> {
        (0..=60)
            .map(|time: i32| format!("{time},{name},{},0,{}", 100 * time, 10 * (time - 30).max(0)))
            .collect()
    };
    let truth = table(header, rows("A"));
    let tracks = table(&header.replace("truth", "track"), rows("T"));
    let items = json!([
        {"requirement": "position_within", "distance_m": 1.0},
        {"requirement": "position_within", "name": "climb", "phase": "climbing", "distance_m": 1.0},
        {"requirement": "position_within", "name": "steady", "phase": "steady", "distance_m": 1.0, "sectors": ["low"]}
    ]);
    let sectors = json!([{"sector_id": "low", "height_max_m": 100.0}, {"sector_id": "high", "height_min_m": 101.0}]);
    let requirements = json!({"items": items, "sectors": sectors});
    let outcome = judged(&truth, &tracks, only(requirements));
    let findings = outcome.result["requirements"]["findings"]
        .as_array()
        .unwrap();
    let found: Vec<(&str, &str, u64)> = findings
        .iter()
        .map(|one| {
            let text = |field: &str| one[field].as_str().unwrap();
            let count = one["denominator"].as_u64().unwrap();
            (text("sector_id"), text("requirement"), count)
        })
        .collect();
    let wanted = [
        ("low", "position_within", 41),
        ("low", "climb", 11),
        ("low", "steady", 30),
        ("high", "position_within", 20),
        ("high", "climb", 20),
    ];
    assert_eq!(found, wanted);
}

fn faults(requirements: Value, more: Value) -> Vec<(String, String)> {
    let mut texts = Texts::of("csv");
    let (truth, tracks) = (truth(CODES), tracks(&[1.0, 2.0], CODES));
    let mut body = only(requirements);
    body["truth"] = texts.dataset(&truth);
    body["tracks"] = texts.dataset(&tracks);
    body.as_object_mut()
        .unwrap()
        .extend(more.as_object().unwrap().clone());
    let told = |fault: Fault| (fault.pointer, fault.code);
    let faults = texts.judge(&body).unwrap_err();
    faults.into_iter().map(told).collect()
}

#[test]
fn a_wrong_request_is_told_of_all_its_faults() {
    let of = |pointer: &str, code: &str| (pointer.to_owned(), code.to_owned());
    let found = faults(json!({}), json!({}));
    assert_eq!(found, [of("/requirements", "missing")]);
    let item =
        json!({"requirement": "position_rms", "at_most": 1.0, "below": 2.0, "sectors": ["x"]});
    let sector = json!({"sector_id": "s", "height_min_m": 2.0, "height_max_m": 1.0});
    let found = faults(
        json!({"items": [item], "sectors": [sector, {"sector_id": "s"}], "presets": [{"preset": "en_route_8s", "sectors": ["y"]}]}),
        json!({}),
    );
    let wanted = [
        of("/requirements/sectors/0/height_max_m", "out_of_range"),
        of("/requirements/sectors/1/sector_id", "duplicate"),
        of("/requirements/presets/0/sectors/0", "unknown_value"),
        of("/requirements/items/0/sectors/0", "unknown_value"),
        of("/requirements/items/0", "conflict"),
    ];
    assert_eq!(found, wanted);
    let found = faults(json!({"items": [{"requirement": "nothing"}]}), json!({}));
    assert_eq!(
        found,
        [of("/requirements/items/0/requirement", "unknown_value")]
    );
    let corners = json!([{"lat_deg": 50.0, "lon_deg": 8.0}, {"lat_deg": 51.0, "lon_deg": 8.0}, {"lat_deg": 50.0, "lon_deg": 9.0}]);
    let area = json!({"kind": "polygon_deg", "corners": corners});
    let found = faults(
        json!({"items": [{"requirement": "position_rms"}], "sectors": [{"sector_id": "s", "areas": [area]}]}),
        json!({}),
    );
    assert_eq!(
        found,
        [of("/requirements/sectors/0/areas/0", "unsupported")]
    );
}

#[test]
fn every_preset_judges() {
    let presets = [
        "airport_surface_radar",
        "airport_mlat_manoeuvring_area",
        "airport_mlat_apron",
        "airport_mlat_stand",
        "asmgcs_manoeuvring_area",
        "asmgcs_apron",
        "asmgcs_stand",
        "en_route_8s",
        "terminal_area_5s",
        "radar_5s",
        "tracker_against_tracker",
    ];
    let header =
        |id: &str| format!("time_s,{id},x_m,y_m,vx_mps,vy_mps,address,callsign,mode_a,mode_c_ft");
    let rows = |name: &str| -> Vec<String> {
        let row = |time: i32| format!("{time},{name},{},0,100,0,{CODES}", 100 * time);
        (0..=600).map(row).collect()
    };
    let truth = table(&header("truth_id"), rows("A"));
    let tracks = table(&header("track_id"), rows("T"));
    for preset in presets {
        let requirements = json!({"presets": [{"preset": preset}]});
        let outcome = judged(&truth, &tracks, only(requirements));
        let limits = &outcome.result["limits"];
        assert_eq!(limits["met"], true, "{preset}: {limits:#}");
    }
}
