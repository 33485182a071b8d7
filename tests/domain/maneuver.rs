//! Scenes with manoeuvres: their courses, and how well filters follow, beside numbers of another program.

use crate::maneuver_scene::{Named, PUBLISHED, filter_of, published, row, truth};
use std::ops::ControlFlow;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{plan, presets, run};
use trackloom_domain::math::rng::Seed;
use trackloom_domain::model::scenario::Scenario;
use trackloom_domain::simulation::simulate;

#[test]
fn the_airliner_is_where_the_book_has_it() {
    let truth = truth();
    let expected = [
        (0, [25000.0, 10000.0, -120.0, 0.0]),
        (25, [10000.0, 10000.0, -120.0, 0.0]),
        (43, [3124.50645843, 3124.50645843, 0.0, -120.0]),
        (68, [3124.50645843, -11875.49354157, 0.0, -120.0]),
        (74, [832.6752779068, -14167.32472209, -120.0, 0.0]),
        (99, [-14167.32472209, -14167.32472209, -120.0, 0.0]),
    ];
    assert_eq!(truth.len(), 100);
    for (fix, state) in expected {
        let apart = truth[fix] - nalgebra::Vector4::from(state);
        assert!(apart.abs().max() < 1e-7, "{fix}: {}", truth[fix]);
    }
}

#[test]
fn the_agile_target_ends_where_its_numbers_say() {
    let preset = presets::find("maneuver-10hz").unwrap();
    let scenario = preset.body["input"]["scenario"].clone();
    let scenario: Scenario = serde_json::from_value(scenario).unwrap();
    let seed = Seed { seed: 1, run: 0 };
    let simulated = simulate(&scenario, seed, &mut |_| ControlFlow::Continue(()));
    let truth = simulated.unwrap().unwrap().truth;
    let points = &truth.targets()[0].points;
    let expected = [
        (
            666,
            [
                6137.663668574,
                115.9734801731,
                179.7588092598,
                -87.67422935782,
            ],
        ),
        (
            1000,
            [
                13645.59592729,
                -3545.889755146,
                269.817972699,
                -131.5990182661,
            ],
        ),
    ];
    assert_eq!(points.len(), 1001);
    for (fix, state) in expected {
        let (position, velocity) = (points[fix].position, points[fix].velocity.unwrap());
        let found = [position.x, position.y, velocity.x, velocity.y];
        for (found, expected) in found.iter().zip(state) {
            assert!((found - expected).abs() < 1e-6, "{fix}: {found} {expected}");
        }
    }
}

const RUNS: u32 = 100;

/// Every RMS error of place (over all fixes, over each part, at the peak) is within four standard errors of that of a
/// program in numpy, for a hundred runs here and a thousand or three hundred there.
#[test]
fn filters_err_as_in_the_published_table() {
    let truth = truth();
    for (name, expected, of_runs) in PUBLISHED {
        let errors = published(name, &truth, RUNS);
        let deviation = errors.largest_deviation(&expected, of_runs);
        assert!(deviation < 4.0, "{name}: {deviation}, {:?}", row(&errors));
        let nees = row(&errors)[8];
        assert!((nees / expected[8] - 1.0).abs() < 0.25, "{name}: {nees}");
    }
}

#[test]
fn the_preset_follows_turns_of_rates_that_it_is_not_told() {
    let preset = presets::find("atc-maneuver").unwrap();
    let truth = truth();
    let errors = filter_of(&preset.body["filter"]).with(Named {
        truth: &truth,
        runs: RUNS,
    });
    let [all, straight, _, _, _, _, peak, ..] = row(&errors);
    let standard_errors_m = errors.standard_errors_m();
    for (found, most, error) in [
        (all, 98.0, standard_errors_m[0]),
        (straight, 84.0, standard_errors_m[1]),
        (peak, 189.0, standard_errors_m[6]),
    ] {
        assert!(found < most + 4.0 * error, "{found} above {most} ± {error}");
    }
}

/// The tracks of a job with two models have their probabilities in the file, and the report tells what was taken.
#[test]
fn a_job_tells_how_probable_each_model_was() {
    let preset = presets::find("atc-maneuver").unwrap();
    let plan = plan(preset.kind, &preset.body).unwrap();
    let outcome = run(&plan, Vec::new(), &mut Silent).unwrap();
    let models = &outcome.result["association"]["models"];
    assert_eq!(models[1]["model"], "unknown_turn");
    assert_eq!(
        (&models[0]["sojourn_s"], &models[1]["sojourn_s"]),
        (&200.0.into(), &25.0.into())
    );
    // Stationary: 200 of 225 s.
    let initial = models[0]["initial_probability"].as_f64().unwrap();
    assert!((initial - 200.0 / 225.0).abs() < 1e-12);
    let artifact = outcome
        .artifacts
        .iter()
        .find(|one| one.name == "tracks.csv")
        .unwrap();
    let csv = String::from_utf8(artifact.bytes.clone()).unwrap();
    let header: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let first = header.iter().position(|name| *name == "mode_1").unwrap();
    assert_eq!(header[first + 1..], ["mode_2"]);
    let mut turning = Vec::new();
    for line in csv.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let [straight, turn] = [0, 1].map(|mode| cells[first + mode].parse::<f64>().unwrap());
        assert!((straight + turn - 1.0).abs() < 1e-9);
        turning.push(turn);
    }
    // At 100 s, and at 365 s near the end of the turn of 3°/s.
    assert!(
        turning[20] < 0.5 && turning[73] > 0.5,
        "{} {}",
        turning[20],
        turning[73]
    );
}
