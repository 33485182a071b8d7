//! The temporal automaton in a job: its settings from the request, and the files it leaves beside the report.

use super::fields::TFA;
use super::spec::ComparisonSpec;
use crate::evaluation::temporal_automaton::weighted::ScanProbability;
use crate::evaluation::temporal_automaton::{TfaEvaluation, report::EPSILON};
use crate::evaluation::{EvaluationInput, SymbolRule, TfaSettings};
use crate::experiment::files::tables::{number, optional, quoted};
use crate::experiment::job::{Artifact, RunError};
use crate::experiment::request::draft::defaults_of;
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use std::io::Write;

/// A larger automaton is not written to files: no picture shows it, and the report says all that it decided.
pub const MAX_TRANSITIONS: usize = 20_000;
/// Longer curves are not written to a file.
pub const MAX_CURVE_ROWS: usize = 500_000;

/// The settings where the request has none: what the data allow. `None` where they allow none: symbols are the nearest targets in metres,
/// and directions are no number of metres away from anything.
pub fn default_settings(
    comparison: &ComparisonSpec,
    input: &EvaluationInput,
) -> Option<TfaSettings> {
    let has_origins = input
        .recording
        .is_some_and(|recording| recording.origins_known);
    let is_whole = comparison.within.is_none();
    let symbols = if is_whole
        && has_origins
        && (!input.tracks.candidates.is_empty() || input.truth.is_none())
    {
        SymbolRule::DetectionId
    } else if is_of_directions(input) {
        return None;
    } else {
        SymbolRule::NearestTruth {
            gate_m: comparison.gate_m,
            max_gap_s: comparison.alignment.rule.max_gap_s(),
        }
    };
    Some(TfaSettings {
        symbols,
        ..defaults_of(&TFA)
    })
}

fn is_of_directions(input: &EvaluationInput) -> bool {
    let truth = input.truth.is_some_and(|truth| !truth.space().has_places());
    truth || !input.tracks.space.has_places()
}

/// Judges tracks.
///
/// # Errors
/// What the settings need and the data do not have.
pub fn evaluate<'a>(
    settings: TfaSettings,
    input: EvaluationInput<'a>,
    sensors: &[SensorSettings],
) -> Result<TfaEvaluation<'a>, Vec<Fault>> {
    // Without a recording nothing is known of sensors.
    let sensors = input.recording.map(|_| sensors);
    TfaEvaluation::new(input, sensors, settings)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::credit::Credit;
    use crate::experiment::request::draft::parse;
    use crate::model::track::TrackSet;
    use serde_json::json;

    #[test]
    fn settings_that_are_not_given_are_those_of_the_comparison() {
        let tracks = TrackSet::default();
        let input = EvaluationInput {
            recording: None,
            truth: None,
            tracks: &tracks,
        };
        let comparison: ComparisonSpec = parse(&json!({
            "gate_m": 7.5, "gate_deg": 5.0, "min_iou": 0.5,
            "alignment": {"method": "interpolate", "max_gap_s": 12.0}
        }));
        let found = default_settings(&comparison, &input);
        let symbols = SymbolRule::NearestTruth {
            gate_m: 7.5,
            max_gap_s: Some(12.0),
        };
        assert_eq!(
            found,
            Some(TfaSettings {
                symbols,
                credit: Credit::AtTheTime,
                ..TfaSettings::PAPER
            })
        );
    }
}
