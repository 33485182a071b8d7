//! Huo et al. 2008: the problem as printed by hand and on the problems of a plain program, and a table of `docs/data` against the campaign
//! that it is made of. `tests/papers.py` holds the others.

use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{Outcome, RunError, plan, presets, run};
use trackloom_domain::math::assignment::assign_dense;
use trackloom_domain::math::rng::Seed;
use trackloom_domain::model::fault::Fault;
use trackloom_domain::registry;
use trackloom_domain::simulation::{LOCAL_TRACKS, LocalTracks, simulate_local_tracks};

/// Problems of the plain program, the first runs of `huo2008-printed`.
const PROBLEMS: u32 = 15;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../docs/data")
        .join(name)
}

fn campaign(name: &str, change: impl Fn(&mut Value)) -> Outcome {
    let mut preset = presets::find(name).unwrap();
    change(&mut preset.body);
    run(
        &plan(preset.kind, &preset.body).unwrap(),
        Vec::new(),
        &mut Silent,
    )
    .unwrap()
}

/// λ of every pair of tracks of neighbouring sensors, in the scenes of the preset: with equal diagonal covariances Σ (Δ / σ)² / 2 over
/// times and components. One table of ten by ten for each two sensors.
fn tables(number: u32) -> Vec<Vec<f64>> {
    let plan = registry::check(&json!({}), &LOCAL_TRACKS).unwrap();
    let plan: LocalTracks = serde_json::from_value(plan).unwrap();
    let seed = Seed {
        seed: 1,
        run: number,
    };
    let (sensors, _) = simulate_local_tracks(&plan, seed).unwrap();
    let mut tables = Vec::new();
    for pair in sensors.windows(2) {
        let mut table = Vec::new();
        for left in &pair[0].tracks.tracks {
            for right in &pair[1].tracks.tracks {
                let mut lambda = 0.0;
                for (one, other) in left.points.iter().zip(&right.points) {
                    let (one, other) = (&one.estimate, &other.estimate);
                    let apart_m = one.position - other.position;
                    let apart_mps = one.velocity.unwrap() - other.velocity.unwrap();
                    lambda += apart_m.norm_squared() / (2.0 * plan.sigma_m.powi(2));
                    lambda += apart_mps.norm_squared() / (2.0 * plan.sigma_mps.powi(2));
                }
                table.push(lambda);
            }
        }
        tables.push(table);
    }
    tables
}

fn written_problems() -> String {
    let columns: Vec<String> = (1..=10).map(|track| format!("lambda_{track}")).collect();
    let mut text = format!("problem,sensor,track,{}\n", columns.join(","));
    for problem in 0..PROBLEMS {
        for (sensor, table) in tables(problem).iter().enumerate() {
            for (track, row) in table.chunks(10).enumerate() {
                let row: Vec<String> = row.iter().map(|lambda| format!("{lambda:.3}")).collect();
                let (sensor, track) = (sensor + 1, track + 1);
                text.push_str(&format!("{problem},{sensor},{track},{}\n", row.join(",")));
            }
        }
    }
    text
}

#[test]
fn the_problems_of_the_plain_program_are_those_of_the_campaign() {
    let text = written_problems();
    if std::env::var_os("TRACKLOOM_WRITE_GOLDENS").is_some() {
        std::fs::write(data("huo2008-problems.csv"), &text).unwrap();
    }
    assert_eq!(
        std::fs::read_to_string(data("huo2008-problems.csv")).unwrap(),
        text
    );
    // The least J of the tables is the bound that the campaign's gaps are told from; the first runs of fewer are the same.
    let outcome = campaign("huo2008-printed", |body| {
        body["runs"] = json!(2);
        body["grid"][0]["variants"]
            .as_array_mut()
            .unwrap()
            .truncate(1);
    });
    let runs = rows(&outcome, "runs.csv");
    let printed: Vec<_> = runs
        .iter()
        .filter(|row| row["cell"] == "3 × 10, as printed")
        .collect();
    assert_eq!(printed.len(), 2);
    for (row, problem) in printed.iter().zip(0..) {
        let least: f64 = tables(problem)
            .iter()
            .map(|table| assign_dense(table, 10).unwrap().cost)
            .sum();
        let number = |name: &str| row[name].parse::<f64>().unwrap();
        let (cost, gap) = (number("J"), number("gap"));
        assert!(
            (cost / (1.0 + gap) / least - 1.0).abs() < 1e-9,
            "{problem}: {cost}, {gap}, {least}"
        );
    }
}

/// The rows of a file of an outcome, each by column.
fn rows(outcome: &Outcome, name: &str) -> Vec<HashMap<String, String>> {
    let file = outcome
        .artifacts
        .iter()
        .find(|file| file.name == name)
        .unwrap();
    read(&file.bytes)
}

fn read(bytes: &[u8]) -> Vec<HashMap<String, String>> {
    csv::Reader::from_reader(bytes)
        .deserialize()
        .map(Result::unwrap)
        .collect()
}

/// The rows of a table of `docs/data`: value, low and high by cell and quantity.
fn table(name: &str) -> HashMap<(String, String), [f64; 3]> {
    let mut found = HashMap::new();
    for row in read(&std::fs::read(data(name)).unwrap()) {
        let number = |name: &str| row[name].parse().unwrap_or(f64::NAN);
        let key = (row["cell"].clone(), row["quantity"].clone());
        found.insert(key, [number("value"), number("low"), number("high")]);
    }
    found
}

#[test]
fn the_search_as_printed_and_the_plain_program_are_in_each_others_intervals() {
    let table = table("huo2008-printed.csv");
    for quantity in ["J above the optimum", "share at the optimum"] {
        let of = |cell: &str| table[&(cell.to_owned(), quantity.to_owned())];
        let (ours, plain) = (of("3 × 10, as printed"), of("3 × 10, plain program"));
        assert!(
            plain[1] <= ours[0] && ours[0] <= plain[2],
            "{ours:?} {plain:?}"
        );
        assert!(
            ours[1] <= plain[0] && plain[0] <= ours[2],
            "{ours:?} {plain:?}"
        );
    }
}

#[test]
fn a_table_holds_what_its_campaign_gives() {
    let table = table("huo2008-alpha.csv");
    let outcome = campaign("huo2008-alpha", |body| {
        let tests = body["grid"][0]["variants"].as_array_mut();
        tests.expect("the first axis has variants").truncate(1);
    });
    let mut compared = 0;
    for row in rows(&outcome, "cells.csv") {
        if row["outcome"] != "recall" {
            continue;
        }
        let rejected = table[&(row["cell"].clone(), "true pairs rejected".to_owned())];
        for (stored, column) in rejected.iter().zip(["mean", "high", "low"]) {
            let found = 1.0 - row[column].parse::<f64>().unwrap();
            assert!((found - stored).abs() <= 1e-6, "{row:?}: {stored}");
            compared += 1;
        }
    }
    assert!(compared == 9, "{compared}");
}

fn drawn(tracks: Value, correlator: Value) -> Value {
    json!({"seed": 1, "input": {"source": "local_tracks", "tracks": tracks}, "correlator": correlator})
}

fn correlate(body: &Value) -> Result<Value, Vec<Fault>> {
    let plan = plan(trackloom_domain::experiment::JobKind::Correlate, body)?;
    match run(&plan, Vec::new(), &mut Silent) {
        Ok(outcome) => Ok(outcome.result),
        Err(RunError::Faults(faults)) => Err(faults),
        Err(other) => panic!("{other:?}"),
    }
}

const PRINTED: &str = r#"{"method": "genetic", "variant": "paper", "complete": true}"#;

#[test]
fn complete_tuples_have_a_track_of_every_sensor_and_j_is_the_sum_of_b() {
    // Two targets, so far apart that no threshold would link them: one of four chromosomes is right, and the search has them all.
    let correlator: Value = serde_json::from_str(PRINTED).unwrap();
    let tracks = json!({"targets": 2, "spacing_m": 50_000.0});
    let result = correlate(&drawn(tracks, correlator)).unwrap();
    let tuples = result["tuples"].as_array().unwrap();
    assert_eq!(tuples.len(), 2);
    assert_eq!(result["truth"]["tuples_right"], json!(2));
    assert_eq!(result["unassociated"], json!([]));
    let sum: f64 = tuples
        .iter()
        .map(|tuple| tuple["b"].as_f64().unwrap())
        .sum();
    let cost = result["cost"].as_f64().unwrap();
    assert!(
        (sum - cost).abs() < 1e-9 * cost && cost > 0.0,
        "{sum} {cost}"
    );
    assert_eq!(result["gap"], json!(0.0));
}

#[test]
fn what_is_no_problem_of_complete_tuples_is_refused_with_one_fault() {
    let printed: Value = serde_json::from_str(PRINTED).unwrap();
    let refused = |tracks: Value, correlator: &Value, statistic: &str| {
        let mut body = drawn(tracks, correlator.clone());
        body["statistic"] = json!({"kind": statistic});
        let faults = correlate(&body).unwrap_err();
        assert_eq!(faults.len(), 1, "{faults:?}");
        (
            faults[0].pointer.clone(),
            faults[0].code.to_string(),
            faults[0].detail.clone(),
        )
    };
    let (pointer, code, detail) = refused(json!({"p_d": 0.5}), &printed, "chain");
    assert_eq!((&*pointer, &*code), ("/correlator/complete", "unsupported"));
    assert!(
        detail.contains("tracks, and complete tuples have one of each"),
        "{detail}"
    );
    let (pointer, _, detail) = refused(json!({}), &printed, "all_pairs");
    assert_eq!(pointer, "/correlator/complete");
    assert!(detail.contains("neighbouring"), "{detail}");
    let improved = json!({"method": "genetic", "complete": true});
    let (pointer, code, _) = refused(json!({}), &improved, "chain");
    assert_eq!((&*pointer, &*code), ("/correlator/complete", "conflict"));
}
