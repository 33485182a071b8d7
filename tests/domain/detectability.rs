//! What a sensor sees: blanked arcs, edges of fields of view, sensors that never see a target, and clutter that is not the
//! same everywhere.

use rand::RngExt;
use rand_distr::{Distribution, Poisson, StandardNormal};
use serde_json::{Value, json};
use std::f64::consts::TAU;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, Input, JobKind, Outcome, plan};
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::math::rng::{Purpose, Seed};

/// A file of positions: (time, sensor, places).
fn csv(scans: &[(f64, &str, Vec<[f64; 2]>)]) -> String {
    let mut text = String::from("time_s,scan,sensor_id,detection_id,x_m,y_m\n");
    for (index, (time_s, sensor, places)) in scans.iter().enumerate() {
        if places.is_empty() {
            text += &format!("{time_s},{},{sensor},,,\n", index + 1);
        }
        for (nth, place) in places.iter().enumerate() {
            let [x_m, y_m] = place;
            text += &format!(
                "{time_s},{},{sensor},{}-{nth},{x_m},{y_m}\n",
                index + 1,
                index + 1
            );
        }
    }
    text
}

fn input_of(text: &str) -> Input {
    let read = format_named("csv").unwrap().read;
    let outcome = read(&mut text.as_bytes(), &ReadOptions::default()).unwrap();
    Input {
        dataset: outcome.dataset,
        sensors: Vec::new(),
        sha256: String::new(),
    }
}

fn tracked(text: &str, body: &Value) -> Outcome {
    let plan = plan(JobKind::Associate, body).unwrap_or_else(|faults| panic!("{faults:?}"));
    experiment::run(&plan, vec![Some(input_of(text))], &mut Silent).unwrap()
}

/// A job on such a file.
fn body(sensors: Value, tracker: Value) -> Value {
    json!({
        "input": {"source": "dataset", "dataset_id": "d"},
        "sensors": sensors,
        "associator": {"method": "global_nearest_neighbour"},
        "filter": {"method": "kalman", "process_noise_m2ps3": 0.1},
        "tracker": tracker,
    })
}

fn radar(more: Value) -> Value {
    let mut radar = json!({"sensor_id": "radar", "x_m": 0, "y_m": 0, "p_d": 0.9, "clutter_per_m2": 1e-8, "sigma_x_m": 5.0, "sigma_y_m": 5.0});
    radar
        .as_object_mut()
        .unwrap()
        .extend(more.as_object().unwrap().clone());
    radar
}

/// Number of tracks, and points of the first one.
fn found(outcome: &Outcome) -> (u64, u64) {
    let tracks = outcome.result.pointer("/association/tracks").unwrap();
    let tracks = tracks.as_array().unwrap();
    let points = tracks
        .first()
        .map_or(0, |track| track["points"].as_u64().unwrap());
    (tracks.len() as u64, points)
}

/// A target that goes east along y = 1 000 m at 20 m/s from x = −800 m on; what lies in a blanked arc is not reported.
fn through_an_arc(is_blank: impl Fn(f64) -> bool) -> String {
    let mut draw = Seed { seed: 3, run: 0 }.stream(Purpose::Detection, 0, 0);
    let mut scans = Vec::new();
    for index in 0..80 {
        let x_m = -800.0 + 20.0 * f64::from(index);
        let errors: [f64; 2] = std::array::from_fn(|_| StandardNormal.sample(&mut draw));
        let bearing_deg = x_m.atan2(1000.0).to_degrees();
        let place = [x_m + 5.0 * errors[0], 1000.0 + 5.0 * errors[1]];
        let places = if is_blank(bearing_deg) {
            vec![]
        } else {
            vec![place]
        };
        scans.push((f64::from(index), "radar", places));
    }
    csv(&scans)
}

const TRACKER: fn() -> Value = || json!({"initial_speed_sigma_mps": 15.0, "confirm_hits": 3, "confirm_window": 4, "max_missed": 4});

#[test]
fn a_track_lives_on_through_an_arc_that_is_blanked() {
    // ±10°: 353 m, 18 scans without a detection.
    let text = through_an_arc(|bearing_deg| bearing_deg.abs() < 10.0);
    let blind = tracked(&text, &body(json!([radar(json!({}))]), TRACKER()));
    assert_eq!(
        found(&blind).0,
        2,
        "who does not know of the arc loses the target"
    );
    let sectors = json!({"sectors": [{"bearing_from_deg": -10, "bearing_to_deg": 10, "p_d": 0}]});
    let knows = tracked(&text, &body(json!([radar(sectors.clone())]), TRACKER()));
    assert_eq!(found(&knows), (1, 80));
    // A score stays as it is, too: twenty misses would cost 20 ln(1 − 0.9 · 0.99) = −44.
    let mut scored = TRACKER();
    scored["confirmation"] = json!({"rule": "score", "max_score_drop": 12.0});
    scored["max_missed"] = json!(1000);
    let knows = tracked(&text, &body(json!([radar(sectors)]), scored.clone()));
    assert_eq!(found(&knows), (1, 80));
    let blind = tracked(&text, &body(json!([radar(json!({}))]), scored));
    assert_eq!(found(&blind).0, 2);
}

#[test]
fn a_field_of_view_is_the_complement_of_what_is_blanked() {
    let text = through_an_arc(|bearing_deg| bearing_deg.abs() < 10.0);
    let view = json!({"field_of_view": {"bearing_from_deg": 10, "bearing_to_deg": 350}});
    let knows = tracked(&text, &body(json!([radar(view)]), TRACKER()));
    assert_eq!(found(&knows), (1, 80));
    let narrow = json!({"field_of_view": {"bearing_from_deg": 300, "bearing_to_deg": 350, "range_to_m": 5000}});
    let outcome = tracked(&text, &body(json!([radar(narrow)]), TRACKER()));
    // From 10° to 38.66° lies what it reports and cannot see: 1 000 m tan 10° = 176 m, so x = 180 … 780 m, 31 scans of the 63.
    let warning = "sensor 'radar': 31 of 63 detections lie outside its field of view, where no track can be given them";
    assert!(
        outcome.warnings.iter().any(|told| told == warning),
        "{:?}",
        outcome.warnings
    );
}

#[test]
fn what_leaves_every_field_of_view_ends() {
    // Seen up to x = 0, never again.
    let mut text = through_an_arc(|bearing_deg| bearing_deg > 0.0);
    for index in 80..400 {
        text += &format!("{index},{},radar,,,\n", index + 1);
    }
    let view = json!({"field_of_view": {"bearing_from_deg": 270, "bearing_to_deg": 0}});
    let outcome = tracked(&text, &body(json!([radar(view.clone())]), TRACKER()));
    let (tracks, points) = found(&outcome);
    // 41 scans with a detection, then 20 · 4 at most, less what is missed while the track fades out.
    assert!(tracks == 1 && (80..=41 + 80).contains(&points), "{points}");
    let mut timed = TRACKER();
    timed["max_missed_s"] = json!(30.0);
    let outcome = tracked(&text, &body(json!([radar(view)]), timed));
    assert_eq!(
        found(&outcome),
        (1, 41 + 30),
        "at the first scan later than that it is gone"
    );
}

#[test]
fn limits_that_are_none_are_told() {
    let faults_of = |more: Value| {
        let input = input_of(&through_an_arc(|_| false));
        let plan = plan(JobKind::Associate, &body(json!([radar(more)]), TRACKER())).unwrap();
        format!(
            "{:?}",
            experiment::run(&plan, vec![Some(input)], &mut Silent).err()
        )
    };
    for (more, word) in [
        (
            json!({"field_of_view": {"bearing_from_deg": 10}}),
            "the field of view of sensor 'radar'",
        ),
        (
            json!({"sectors": [{"range_from_m": 10, "range_to_m": 5}]}),
            "sector 0 of sensor 'radar'",
        ),
        (
            json!({"sectors": [{"clutter_per_deg": 5}]}),
            "clutter_per_m2",
        ),
        (json!({"p_d_at_m": 1000, "p_fa": 0.95}), "p_fa < p_d < 1"),
    ] {
        let told = faults_of(more);
        assert!(told.contains(word), "{told}");
    }
}

/// Clutter of 1e-6 per m² between 100 m and 1 000 m and of 1e-4 within 100 m: as many a scan in both.
fn two_rings(seed: u32, scans: u64) -> String {
    let mut text = Vec::new();
    for scan in 0..scans {
        let mut draw = Seed { seed, run: 0 }.stream(Purpose::Clutter, 0, scan);
        let mut places = Vec::new();
        for (from_m, to_m, density) in [(0.0f64, 100.0f64, 1e-4), (100.0, 1000.0, 1e-6)] {
            let area_m2 = TAU / 2.0 * (to_m * to_m - from_m * from_m);
            let count = Poisson::new(density * area_m2).unwrap().sample(&mut draw) as u64;
            for _ in 0..count {
                let square = draw.random_range(from_m * from_m..to_m * to_m);
                let (range_m, bearing) = (f64::sqrt(square), draw.random_range(0.0..TAU));
                places.push([range_m * bearing.sin(), range_m * bearing.cos()]);
            }
        }
        text.push((scan as f64, "radar", places));
    }
    csv(&text)
}

/// False tracks that begin within 100 m and beyond.
fn false_tracks(outcome: &Outcome) -> [f64; 2] {
    let tracks = outcome
        .artifacts
        .iter()
        .find(|file| file.name == "tracks.csv")
        .unwrap();
    let text = String::from_utf8(tracks.bytes.to_vec()).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|found| *found == name).unwrap();
    let (id, x, y) = (column("track_id"), column("x_m"), column("y_m"));
    let (mut seen, mut counts) = (std::collections::BTreeSet::new(), [0.0; 2]);
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        if seen.insert(cells[id].to_owned()) {
            let place: [f64; 2] = [x, y].map(|column| cells[column].parse().unwrap());
            counts[usize::from(place[0].hypot(place[1]) > 100.0)] += 1.0;
        }
    }
    counts
}

#[test]
fn false_tracks_are_as_many_where_a_hundred_times_the_clutter_is_known_of() {
    let tracker = json!({"initial_speed_sigma_mps": 3.0, "max_missed": 1000,
        "confirmation": {"rule": "score", "false_track_probability": 0.02, "missed_track_probability": 0.1}});
    let near = json!({"field_of_view": {"range_to_m": 1000}, "clutter_per_m2": 1e-6,
        "sectors": [{"range_to_m": 100, "clutter_per_m2": 1e-4}]});
    let mean = json!({"field_of_view": {"range_to_m": 1000}, "clutter_per_m2": 2e-6});
    let (mut known, mut unknown) = ([0.0; 2], [0.0; 2]);
    for seed in 1..=4 {
        let text = two_rings(seed, 600);
        for (more, sum) in [(&near, &mut known), (&mean, &mut unknown)] {
            let found = false_tracks(&tracked(
                &text,
                &body(json!([radar(more.clone())]), tracker.clone()),
            ));
            sum.iter_mut()
                .zip(found)
                .for_each(|(sum, count)| *sum += count);
        }
    }
    println!("{known:?} {unknown:?}");
    let difference = (known[0] - known[1]).abs();
    assert!(
        difference <= 3.0 * (known[0] + known[1]).sqrt(),
        "{known:?}"
    );
    assert!(
        unknown[0] > 10.0 * unknown[1].max(1.0),
        "one density for both: {unknown:?}"
    );
}

#[test]
fn a_map_of_one_density_changes_nothing() {
    let text = two_rings(5, 100);
    let tracker = json!({"initial_speed_sigma_mps": 3.0});
    let plain = tracked(
        &text,
        &body(
            json!([radar(json!({"clutter_per_m2": 2e-6}))]),
            tracker.clone(),
        ),
    );
    // A map that learns next to nothing, and sectors that say what the sensor does.
    for more in [
        json!({"clutter_per_m2": 2e-6, "clutter": {"method": "map", "alpha": 1e-300}}),
        json!({"clutter_per_m2": 2e-6, "sectors": [{"range_to_m": 500, "clutter_per_m2": 2e-6, "p_d": 0.9}]}),
        json!({"clutter_per_m2": 2e-6, "field_of_view": {"range_to_m": 1e8}}),
    ] {
        let other = tracked(&text, &body(json!([radar(more)]), tracker.clone()));
        for name in ["tracks.csv", "scans.csv"] {
            let bytes = |outcome: &Outcome| {
                let file = outcome.artifacts.iter().find(|file| file.name == name);
                file.unwrap().bytes.to_vec()
            };
            assert!(bytes(&other) == bytes(&plain), "{name}");
        }
    }
}

#[test]
fn a_map_learns_where_clutter_is() {
    let tracker = json!({"initial_speed_sigma_mps": 3.0, "max_missed": 1000,
        "confirmation": {"rule": "score", "false_track_probability": 0.02, "missed_track_probability": 0.1}});
    let constant = json!({"clutter_per_m2": 2e-6, "max_range_m": 1000});
    let map = json!({"clutter_per_m2": 2e-6, "max_range_m": 1000, "clutter": {"method": "map", "cells": 20}});
    let text = two_rings(6, 600);
    let counts = [constant, map].map(|more| {
        false_tracks(&tracked(
            &text,
            &body(json!([radar(more)]), tracker.clone()),
        ))
    });
    println!("{counts:?}");
    assert!(counts[1][0] < counts[0][0] / 5.0, "{counts:?}");
}

/// A target that goes east at 10 m/s; sensors scan in turn, and each letter says whose scan it is: a capital detects it.
fn in_turn(scans: &str) -> String {
    let mut draw = Seed { seed: 9, run: 0 }.stream(Purpose::Detection, 0, 0);
    let mut rows = Vec::new();
    for (index, letter) in scans.chars().enumerate() {
        let errors: [f64; 2] = std::array::from_fn(|_| StandardNormal.sample(&mut draw));
        let place = [10.0 * index as f64 + 5.0 * errors[0], 5.0 * errors[1]];
        let places = if letter.is_uppercase() {
            vec![place]
        } else {
            vec![]
        };
        let sensor = if letter.eq_ignore_ascii_case(&'a') {
            "a"
        } else {
            "b"
        };
        rows.push((index as f64, sensor, places));
    }
    csv(&rows)
}

fn two_radars(p_d: Option<f64>) -> Value {
    let one = |name: &str| {
        let mut sensor =
            json!({"sensor_id": name, "clutter_per_m2": 1e-8, "sigma_x_m": 5.0, "sigma_y_m": 5.0});
        if let Some(p_d) = p_d {
            sensor["p_d"] = json!(p_d);
        }
        sensor
    };
    json!([one("a"), one("b")])
}

#[test]
fn a_sensor_that_never_sees_a_target_does_not_lose_its_track() {
    let tracker = json!({"initial_speed_sigma_mps": 10.0, "max_missed": 3});
    // The one real miss of A stands between two scans of B.
    for scans in [
        "AbAbAbAbAbAbabAbAbAbAbAb",
        "AbbbbAbbbbAbbbbAbbbbabbbbAbbbbAbbbb",
    ] {
        let text = in_turn(scans);
        for p_d in [Some(0.9), None] {
            let outcome = tracked(&text, &body(two_radars(p_d), tracker.clone()));
            assert_eq!(found(&outcome), (1, scans.len() as u64), "{scans} {p_d:?}");
        }
    }
    // What A loses for good ends all the same: three misses of A.
    let outcome = tracked(
        &in_turn("AbAbAbAbAbababababab"),
        &body(two_radars(Some(0.9)), tracker),
    );
    assert_eq!(found(&outcome), (1, 14));
}

#[test]
fn points_between_the_scans_of_who_sees_it_are_coasted() {
    let tracker = json!({"initial_speed_sigma_mps": 10.0, "max_missed": 3});
    let outcome = tracked(
        &in_turn("AbAbAbAbAb"),
        &body(two_radars(Some(0.9)), tracker),
    );
    let tracks = outcome
        .artifacts
        .iter()
        .find(|file| file.name == "tracks.csv")
        .unwrap();
    let text = String::from_utf8(tracks.bytes.to_vec()).unwrap();
    let mut lines = text.lines();
    let column = lines
        .next()
        .unwrap()
        .split(',')
        .position(|name| name == "status")
        .unwrap();
    let statuses: Vec<&str> = lines
        .map(|line| line.split(',').nth(column).unwrap())
        .collect();
    let coasts = [
        "confirmed",
        "coasted",
        "confirmed",
        "coasted",
        "confirmed",
        "coasted",
    ];
    assert_eq!(statuses[4..], coasts, "{statuses:?}");
}

#[test]
fn noises_of_detections_count_as_those_of_sensors_where_errors_persist() {
    let plain = through_an_arc(|_| false);
    let mut told = String::new();
    for line in plain.lines() {
        let is_head = line.starts_with("time_s");
        told += line;
        told += if is_head {
            ",sigma_x_m,sigma_y_m\n"
        } else {
            ",5,5\n"
        };
    }
    let tracks = |text: &str, sigma_m: f64, correlation_s: f64| {
        let sensor = radar(
            json!({"sigma_x_m": sigma_m, "sigma_y_m": sigma_m, "error_correlation_s": correlation_s}),
        );
        tracked(text, &body(json!([sensor]), TRACKER())).result["association"].clone()
    };
    let (by_sensor, by_detection) = (tracks(&plain, 5.0, 4.0), tracks(&told, 99.0, 4.0));
    assert_eq!(by_sensor["nis"], by_detection["nis"]);
    // √((1 + e^(−1/4)) / (1 − e^(−1/4))) = 2.835 times the noise: a mean NIS of far less than with the noise as it is.
    let alone = tracks(&told, 99.0, 1e-3);
    let mean = |association: &Value| association["nis"]["mean"].as_f64().unwrap();
    assert!((mean(&alone) - 2.0).abs() < 0.8, "{}", mean(&alone));
    assert!(
        mean(&by_detection) < 0.4 * mean(&alone),
        "{}",
        mean(&by_detection)
    );
}
