//! The small scenes give the values of the definitions.

use super::fixture::{Scene, assert_close, assert_series};
use super::golden::{GOSPA, OSPA};
use super::scenes;
use serde_json::json;

fn scene(name: &str) -> Scene {
    match name {
        "main" => scenes::main(),
        "swap" => scenes::swap(),
        _ => scenes::probe(),
    }
}

#[test]
fn ospa_of_the_small_scenes() {
    for &(name, cutoff_m, p, mean, values) in OSPA {
        let report = scene(name).evaluate(
            10.0,
            json!({"metric": "ospa", "cutoff_m": cutoff_m, "p": p}),
        );
        assert_close(report.value, mean, name);
        assert_series(&report, "ospa", values);
    }
}

#[test]
fn gospa_and_its_parts_of_the_small_scenes() {
    for &(name, cutoff_m, p, mean, parts) in GOSPA {
        let report = scene(name).evaluate(
            10.0,
            json!({"metric": "gospa", "cutoff_m": cutoff_m, "p": p}),
        );
        assert_close(report.value, mean, name);
        for (series, values) in ["gospa", "localisation", "missed", "false"]
            .iter()
            .zip(parts)
        {
            assert_series(&report, series, values);
        }
        for (sum, values) in ["localisation_sum", "missed_sum", "false_sum"]
            .iter()
            .zip(&parts[1..])
        {
            assert_close(report.quantity(sum), values.iter().sum(), sum);
        }
    }
}

#[test]
fn switches_of_gospa_are_whole_for_an_exchange_and_half_for_a_loss_or_a_find() {
    let spec = json!({"metric": "gospa", "cutoff_m": 10.0, "p": 2.0, "switch_penalty_m": 2.0});
    let main = scenes::main().evaluate(10.0, spec.clone());
    let squares = |values: &[f64]| {
        values
            .iter()
            .map(|value| value * value)
            .collect::<Vec<f64>>()
    };
    let half = std::f64::consts::SQRT_2;
    assert_series(
        &main,
        "switching",
        &squares(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, half, 2.0, half, 0.0]),
    );
    let distances = [
        2.23606797749979,
        std::f64::consts::SQRT_2,
        7.245688373094719,
        3.0,
        7.245688373094719,
        7.483314773547883,
        11.269427669584646,
        10.63014581273465,
        3.3911649915626336,
        3.1622776601683795,
    ];
    assert_series(&main, "gospa", &distances);
    assert_close(
        main.quantity("switches"),
        2.0,
        "A loses T1 and finds T3; B loses T2 and finds it again",
    );
    let swap = scenes::swap().evaluate(10.0, spec);
    assert_series(
        &swap,
        "switching",
        &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 8.0, 0.0, 0.0, 0.0, 0.0],
    );
    assert_close(swap.quantity("switches"), 2.0, "both change at one step");
}
