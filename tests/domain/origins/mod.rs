//! Every number of the metrics can be followed to the files of its job: it is made again from their text, as the report says.

mod files;
pub mod jobs;
mod scenes;

pub use scenes::entangled;

use files::{Files, Metric, Scope};
use serde_json::Value;
use std::collections::BTreeSet;
use trackloom_domain::experiment::Outcome;

/// Numbers that count or average no rows: quantiles, how the programme went, what a whole run is.
const WITHOUT_ORIGIN: [&str; 18] = [
    "nees_bearing_lower",
    "nees_bearing_upper",
    "nees_position_lower",
    "nees_position_upper",
    "nees_state_lower",
    "nees_state_upper",
    "nis_of_matches_lower",
    "nis_of_matches_upper",
    "ospa2_whole",
    "t_gospa_lower",
    "t_gospa_upper",
    "gap",
    "clusters_exact",
    "clusters_linear_programme_whole",
    "clusters_linear_programme_bound",
    "identity",
    "stay",
    "mean_absolute_error_kept",
];

/// Counts must be equal; other numbers to 1e-9 of their size.
fn assert_same(what: &str, reported: f64, made: Option<f64>) {
    let made = made.unwrap_or_else(|| panic!("{what} is {reported}, but its rows make nothing"));
    let tolerance = if reported.fract() == 0.0 && reported.abs() < 1e6 {
        1e-9
    } else {
        1e-9 * reported.abs().max(1.0)
    };
    assert!(
        (reported - made).abs() <= tolerance,
        "{what} is {reported}, its rows make {made}"
    );
}

/// Makes every number of these metrics again; returns those that are not null.
fn check(metrics: &Value, from: &Value, files: &Files, scope: Scope) -> BTreeSet<String> {
    let mut made = BTreeSet::new();
    for (name, report) in metrics.as_object().unwrap() {
        let metric = Metric {
            files,
            from: from[name]["from"].as_array().unwrap(),
        };
        let listed = |quantity: &str| {
            metric
                .from
                .iter()
                .any(|entry| entry["quantity"] == quantity)
        };
        for (quantity, said) in report["quantities"].as_object().unwrap() {
            if !listed(quantity) {
                assert!(
                    WITHOUT_ORIGIN.contains(&quantity.as_str()),
                    "{name}.{quantity} cannot be followed"
                );
                continue;
            }
            if let Some(reported) = said["value"].as_f64() {
                let again = metric.number(quantity, scope);
                assert_same(&format!("{name}.{quantity}"), reported, again);
                if metric
                    .from
                    .iter()
                    .any(|entry| entry["quantity"] == *quantity && entry["statistic"] == "count")
                {
                    assert_eq!(Some(reported), again, "{name}.{quantity} is a count");
                }
                made.insert(format!("{name}.{quantity}"));
            }
        }
        for curve in report["curves"].as_array().unwrap() {
            let again = metric.curve(curve["name"].as_str().unwrap(), scope);
            for (said, again) in curve["values"].as_array().unwrap().iter().zip(again) {
                // TrackEval's curves have a value where nothing can be divided.
                if let (Some(said), Some(again)) = (said.as_f64(), again) {
                    assert_same(&format!("{name}.{}", curve["name"]), said, Some(again));
                }
            }
        }
        // Steps of several sequences may be at the same times.
        if scope.sequence.is_some() || files.series_columns()[0] != "sequence" {
            check_series(name, &metric, scope);
        }
    }
    made
}

/// Every value over time that says how it is made.
fn check_series(name: &str, metric: &Metric, scope: Scope) {
    for column in metric.files.series_columns() {
        let Some(series) = column
            .strip_prefix(&format!("{name}."))
            .map(|label| label.split(" [").next().unwrap())
        else {
            continue;
        };
        let is_made = metric.from.iter().any(|entry| {
            let quantity = entry["quantity"].as_str().unwrap();
            quantity == format!("series.{series}")
                || (quantity == series && entry["file"] != "metric-series.csv")
        });
        if !is_made {
            continue;
        }
        for (time_s, value) in metric.files.series(column, scope) {
            // OSPA of two empty sets is 0.
            if let Some(value) = value.filter(|value| *value != 0.0) {
                let again = metric.number(
                    &format!("series.{series}"),
                    Scope {
                        time_s: Some(&time_s),
                        ..scope
                    },
                );
                assert_same(&format!("{name}.{series} at {time_s} s"), value, again);
            }
        }
    }
}

/// Checks all metrics of a job and of its sequences.
pub fn check_all(outcome: &Outcome) -> BTreeSet<String> {
    let files = Files::of(outcome);
    let metrics = &outcome.result["metrics"];
    let made = check(metrics, metrics, &files, Scope::default());
    for sequence in outcome.result["sequences"].as_array().into_iter().flatten() {
        let name = sequence["name"].as_str();
        check(
            &sequence["metrics"],
            metrics,
            &files,
            Scope {
                sequence: name,
                time_s: None,
            },
        );
    }
    made
}

fn assert_made(made: &BTreeSet<String>, expected: &[&str]) {
    for name in expected {
        assert!(made.contains(*name), "{name} is not among {made:?}");
    }
}

#[test]
fn the_scene_of_two_targets() {
    let made = check_all(&scenes::two_targets());
    assert_made(
        &made,
        &[
            "gospa.gospa",
            "gospa_2.switches",
            "ospa.ospa",
            "t_gospa.t_gospa",
            "t_gospa.switches",
            "siap.longest_segment",
        ],
    );
    assert_made(
        &made,
        &[
            "siap_2.completeness",
            "clear.mota",
            "clear.motal",
            "identity.idf1",
            "hota.ass_a",
            "assignment.breaks",
        ],
    );
    assert_made(
        &made,
        &[
            "kinematics.along_rmse",
            "kinematics.position_95",
            "hota.hota_loc_a_0",
        ],
    );
}

#[test]
fn tracks_of_a_tracker_with_their_covariances() {
    let made = check_all(&scenes::tracked());
    let expected = [
        "nees_position",
        "nees_state_steps_within",
        "nis_of_matches",
        "nis_of_matches_samples",
    ];
    assert_made(
        &made,
        &expected
            .map(|name| format!("kinematics.{name}"))
            .each_ref()
            .map(String::as_str),
    );
    assert_made(
        &made,
        &[
            "siap.velocity_accuracy",
            "gospa.false",
            "assignment.false_track_length",
        ],
    );
}

#[test]
fn tracks_that_carry_the_names_of_their_targets() {
    assert_made(
        &check_all(&scenes::bearings()),
        &[
            "track_keeping.mean_absolute_error",
            "track_keeping.targets_identity",
        ],
    );
}

#[test]
fn sequences_of_boxes() {
    let outcome = scenes::boxes();
    assert_made(
        &check_all(&outcome),
        &[
            "hota.hota",
            "clear.mota",
            "identity.idf1",
            "assignment.swaps",
        ],
    );
    assert!(outcome.result["sequences"].as_array().unwrap().len() == 3);
}

#[test]
fn sequences_of_which_one_has_no_truth_and_one_no_covariances() {
    let made = check_all(&scenes::uneven_sequences());
    assert_made(
        &made,
        &[
            "kinematics.nees_position",
            "clear.mt",
            "siap.track_number_change_rate",
            "t_gospa.false",
        ],
    );
}

#[test]
fn trajectories_too_entangled_for_an_exact_solution() {
    let outcome = scenes::entangled();
    let quantities = &outcome.result["metrics"]["t_gospa"]["quantities"];
    assert!(
        quantities["clusters_linear_programme_bound"]["value"].as_f64() > Some(0.0),
        "{quantities}"
    );
    assert_made(
        &check_all(&outcome),
        &[
            "t_gospa.t_gospa",
            "t_gospa.localisation",
            "t_gospa.switching",
        ],
    );
}
