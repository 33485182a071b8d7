//! Levels of noise, targets and transients beside their formulas.

use super::*;
use crate::model::scenario::{BearingLine, BearingTargets, InterferenceSector, ScenarioSensor};
use serde_json::json;

fn scenario(plan: &serde_json::Value, lines: &[(f64, f64)]) -> Scenario {
    let line = |(index, &(bearing_deg, rate_degps)): (usize, &(f64, f64))| BearingLine {
        truth_id: index.to_string(),
        bearing_deg,
        rate_degps,
    };
    let sensor: ScenarioSensor =
        serde_json::from_value(json!({"sensor_id": "sonar", "x_m": 0, "y_m": 0, "p_d": 0.9}))
            .unwrap();
    let plan = crate::registry::check(plan, &RECORD).unwrap();
    Scenario {
        origin: None,
        scans: 20,
        scan_period_s: 10.0,
        sensors: vec![sensor],
        targets: TargetPlan::Bearings(BearingTargets {
            crossings: vec![],
            lines: lines.iter().enumerate().map(line).collect(),
        }),
        coverage: None,
        record: Some(serde_json::from_value(plan).unwrap()),
    }
}

fn record(scenario: &Scenario) -> SimulatedRecord {
    simulate_record(scenario, Seed { seed: 1, run: 0 }, &mut |_| {
        ControlFlow::Continue(())
    })
    .unwrap()
    .unwrap()
}

#[test]
fn the_noise_has_its_mean_and_its_variance_and_a_sector_has_more() {
    let mut scenario = scenario(
        &json!({"levels_db": [-60.0], "noise_averages": 5}),
        &[(0.0, 0.0)],
    );
    if let Some(plan) = &mut scenario.record {
        plan.sectors = vec![InterferenceSector {
            centre_deg: 0.0,
            width_deg: 40.0,
            level_db: 10.0,
        }];
    }
    let found = record(&scenario);
    assert_eq!(
        (
            found.record.times_s.len(),
            found.record.width(),
            found.record.wraps()
        ),
        (200, 360, true)
    );
    let powers = |cells: std::ops::Range<usize>| -> Vec<f64> {
        (0..200)
            .flat_map(|row| found.record.row(row)[cells.clone()].to_vec())
            .map(|level| from_db(f64::from(level)))
            .collect()
    };
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let outside = powers(30..330);
    // 60 000 values of variance 1/5: the mean is within 5 · 0.447/245, the variance within 3 %.
    assert!((mean(&outside) - 1.0).abs() < 0.0092, "{}", mean(&outside));
    let squares: Vec<f64> = outside.iter().map(|power| (power - 1.0).powi(2)).collect();
    assert!((mean(&squares) - 0.2).abs() < 0.006, "{}", mean(&squares));
    // 1 + 10 on both sides of north.
    assert!(
        (mean(&powers(0..20)) - 11.0).abs() < 0.4 && (mean(&powers(341..360)) - 11.0).abs() < 0.4
    );
}

#[test]
fn a_target_has_the_shape_of_the_beam_and_half_its_power_at_half_its_width() {
    let plan = json!({"levels_db": [50.0], "fluctuation_db": 0.0, "noise_averages": 10_000, "beam_width_deg": 4.0});
    let found = record(&scenario(&plan, &[(359.0, 0.01)]));
    let last = found.record.row(100);
    // At 100 s it is at 0 degrees; 2 degrees off the power is half, 3.01 dB less.
    assert!((last[0] - 50.0).abs() < 0.2, "{}", last[0]);
    assert!(
        (last[2] - 46.99).abs() < 0.2 && (last[358] - 46.99).abs() < 0.2,
        "{} {}",
        last[2],
        last[358]
    );
    assert_eq!(found.truth.targets()[0].points.len(), 200);
}

#[test]
fn one_more_target_changes_no_other_and_transients_come_as_often_as_asked() {
    let plan = json!({"levels_db": [40.0], "noise_averages": 1000, "transients": {"per_minute": 30.0, "duration_s": 1.0, "level_db": 40.0}});
    let (one, two) = (
        record(&scenario(&plan, &[(90.0, 0.0)])),
        record(&scenario(&plan, &[(90.0, 0.0), (270.0, 0.0)])),
    );
    for row in 0..200 {
        assert_eq!(one.record.row(row)[80..100], two.record.row(row)[80..100]);
    }
    // 200 s of 30 a minute are 100 ± 10, each seen in one row.
    let loud = |row: usize| {
        (0..360)
            .filter(move |cell| !(80..100).contains(cell))
            .map(move |cell| (row, cell))
    };
    let peaks = (0..200).flat_map(loud).filter(|&(row, cell)| {
        let levels = one.record.row(row);
        levels[cell] > 33.0
            && levels[cell] > levels[(cell + 1) % 360]
            && levels[cell] > levels[(cell + 359) % 360]
    });
    let count = peaks.count();
    assert!((65..=135).contains(&count), "{count}");
}

#[test]
fn all_faults_of_a_record_are_told() {
    let mut wrong = scenario(
        &json!({"bearing_step_deg": 0.7, "levels_db": [1.0, 2.0]}),
        &[(0.0, 0.0)],
    );
    wrong.sensors.push(ScenarioSensor {
        lat_deg: None,
        lon_deg: None,
        sensor_id: "other".into(),
        ..wrong.sensors[0].clone()
    });
    let pointers = |scenario: &Scenario| -> Vec<String> {
        super::super::check(scenario)
            .unwrap_err()
            .into_iter()
            .map(|fault| fault.pointer)
            .collect()
    };
    assert_eq!(
        pointers(&wrong),
        [
            "/sensors/1",
            "/record/bearing_step_deg",
            "/record/levels_db"
        ]
    );
    let mut large = scenario(&json!({"time_step_s": 0.001}), &[(0.0, 0.0)]);
    assert_eq!(pointers(&large), ["/record"]);
    large.targets = TargetPlan::Listed { targets: vec![] };
    assert!(pointers(&large).contains(&"/record".to_owned()));
}
