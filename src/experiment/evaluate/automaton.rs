//! The temporal automaton in a job: its settings from the request, and the files it leaves beside the report.

use crate::evaluation::temporal_automaton::weighted::ScanProbability;
use crate::evaluation::temporal_automaton::{Order, TfaEvaluation, report::EPSILON};
use crate::evaluation::{DecisionPolicy, EvaluationInput, SymbolRule, TfaSettings};
use crate::experiment::files::tables::{number, optional, quoted};
use crate::experiment::request::fields as requests;
use crate::experiment::run::{Artifact, RunError};
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use crate::registry;
use serde::Deserialize;
use serde_json::{Value, json};
use std::io::Write;

/// A larger automaton is not written to files: no picture shows it, and the report says all that it decided.
pub const MAX_TRANSITIONS: usize = 20_000;
/// Longer curves are not written to a file.
pub const MAX_CURVE_ROWS: usize = 500_000;

/// The settings in the request; where it has none, what the data allow.
pub fn spec_of(spec: &Value, input: &EvaluationInput) -> Result<Value, RunError> {
    if let Some(given) = spec.get("tfa") {
        return Ok(given.clone());
    }
    let has_origins = input
        .recording
        .is_some_and(|recording| recording.origins_known);
    let symbols = if has_origins && (!input.tracks.candidates.is_empty() || input.truth.is_none()) {
        json!({"kind": "detection_id"})
    } else {
        let comparison = &spec["comparison"];
        json!({"kind": "nearest_truth", "gate_m": comparison["gate_m"], "max_gap_s": comparison["alignment"]["max_gap_s"]})
    };
    Ok(registry::check(
        &json!({"symbols": symbols}),
        &requests::TFA,
    )?)
}

/// Judges tracks as the checked description `spec` says.
pub fn evaluation<'a>(
    spec: &Value,
    time_tolerance_s: Option<f64>,
    input: EvaluationInput<'a>,
    sensors: &[SensorSettings],
) -> Result<TfaEvaluation<'a>, RunError> {
    // Without a recording nothing is known of sensors.
    let sensors = input.recording.map(|_| sensors);
    Ok(TfaEvaluation::new(
        input,
        sensors,
        TfaSettings {
            time_tolerance_s,
            ..settings(spec)?
        },
    )?)
}

/// `automaton.json`, `automaton.dot` and `truth_probability.csv`, where they are not too large.
pub fn artifacts(
    evaluation: &TfaEvaluation,
    warnings: &mut Vec<String>,
) -> Result<Vec<Artifact>, RunError> {
    let mut files = Vec::new();
    match evaluation.automaton_file(MAX_TRANSITIONS) {
        Some(automaton) => {
            let json = serde_json::to_vec(&automaton).map_err(std::io::Error::from)?;
            files.push(Artifact::file("automaton.json", "application/json", json));
            files.push(Artifact::file(
                "automaton.dot",
                "text/vnd.graphviz",
                automaton.dot().into_bytes(),
            ));
        }
        None => warnings.push(format!(
            "the automaton is not in a file: it has more than {MAX_TRANSITIONS} transitions"
        )),
    }
    match evaluation.scan_probabilities(MAX_CURVE_ROWS) {
        Some(curves) => files.push(Artifact::file("truth_probability.csv", "text/csv", csv(evaluation, &curves)?)),
        None => warnings.push(format!("the probabilities scan by scan are not in a file: they are more than {MAX_CURVE_ROWS} rows")),
    }
    Ok(files)
}

/// The curves as a table; scans that no file names are left out.
fn csv(evaluation: &TfaEvaluation, curves: &[ScanProbability]) -> std::io::Result<Vec<u8>> {
    let strings = &evaluation.strings;
    let mut bytes =
        b"truth_id,time_s,scan,expected,track_id,probability,log_probability\n".to_vec();
    for row in curves {
        let Some(scan) = strings.axis.scan_at(row.position) else {
            continue;
        };
        let truth_id = quoted(strings.target_ids[row.target as usize]);
        let expected = quoted(row.symbol.map_or(EPSILON, |symbol| strings.name_of(symbol)));
        let track_id = row
            .track
            .map_or_else(Default::default, |track| quoted(evaluation.track_id(track)));
        let log_probability = optional(row.log_probability);
        let (time_s, scan, probability) =
            (number(scan.time_s), scan.number, number(row.probability));
        writeln!(
            bytes,
            "{truth_id},{time_s},{scan},{expected},{track_id},{probability},{log_probability}"
        )?;
    }
    Ok(bytes)
}

/// The settings, from their checked description.
fn settings(spec: &Value) -> Result<TfaSettings, RunError> {
    #[derive(Deserialize)]
    struct Wire {
        symbols: Symbols,
        decision: Decision,
        max_missed: u32,
        tolerance: u32,
        search: Search,
        minimise: bool,
    }
    #[derive(Deserialize)]
    #[serde(tag = "kind", rename_all = "snake_case")]
    enum Symbols {
        DetectionId,
        NearestDetection { gate_m: f64 },
        NearestTruth { gate_m: f64, max_gap_s: f64 },
    }
    #[derive(Deserialize)]
    #[serde(tag = "policy", rename_all = "snake_case")]
    enum Decision {
        MostProbable,
        AllGated { min_weight: f64 },
    }
    #[derive(Deserialize)]
    #[serde(rename_all = "snake_case")]
    enum Search {
        BreadthFirst,
        DepthFirst,
    }
    let wire = Wire::deserialize(spec).map_err(|error| {
        RunError::Faults(vec![Fault::new("/tfa", "malformed", error.to_string())])
    })?;
    let symbols = match wire.symbols {
        Symbols::DetectionId => SymbolRule::DetectionId,
        Symbols::NearestDetection { gate_m } => SymbolRule::NearestDetection { gate_m },
        Symbols::NearestTruth { gate_m, max_gap_s } => {
            SymbolRule::NearestTruth { gate_m, max_gap_s }
        }
    };
    let decision = match wire.decision {
        Decision::MostProbable => DecisionPolicy::MostProbable,
        Decision::AllGated { min_weight } => DecisionPolicy::AllGated { min_weight },
    };
    let search = match wire.search {
        Search::BreadthFirst => Order::BreadthFirst,
        Search::DepthFirst => Order::DepthFirst,
    };
    let Wire {
        max_missed,
        tolerance,
        minimise,
        ..
    } = wire;
    Ok(TfaSettings {
        symbols,
        decision,
        max_missed,
        tolerance,
        search,
        minimise,
        time_tolerance_s: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::track::TrackSet;

    #[test]
    fn settings_that_are_not_given_are_those_of_the_comparison() {
        let tracks = TrackSet::default();
        let input = EvaluationInput {
            recording: None,
            truth: None,
            tracks: &tracks,
        };
        let spec = json!({"comparison": {"gate_m": 7.5, "alignment": {"method": "interpolate", "max_gap_s": 12.0}}});
        let found = spec_of(&spec, &input).unwrap();
        assert_eq!(
            found["symbols"],
            json!({"kind": "nearest_truth", "gate_m": 7.5, "max_gap_s": 12.0})
        );
        let given = json!({"tfa": {"max_missed": 3}, "comparison": spec["comparison"]});
        assert_eq!(spec_of(&given, &input).unwrap(), given["tfa"]);
    }
}
