//! Data association judged by a temporal finite automaton.
//!
//! The tracker's decisions become an automaton that accepts exactly the strings of its tracks. Each target's truth
//! string is fed to it: never left the start state is *missed*, ended on a final state is *correct*, anything else is
//! *false*, with a record of where it went wrong. From the three sets come the probabilities of the report.
//!
//! # Reference
//! Liang Bing, Liu Qun: Method of data association performance evaluation based on automata theory consistency and
//! reachability analysis (2009).
//!
//! # Symbols
//! `M = (T, Q×T, Σ×T, δ, (q0,0), F)`: time is the place on the scan axis; one start state, one path a string, one
//! final state `(q_f, t_end)` a string; Σ is the detections of the recording (or the targets, under `nearest_truth`)
//! and ε.
//!
//! # Method
//! 1. Strings on one axis ([`crate::evaluation::strings`]), split at `max_missed` ε in a row.
//! 2. The automaton ([`build`]) and the model check ([`model_check`]).
//! 3. The verdict on each target ([`verdict`]), the class of each output track ([`output_tracks`]).
//! 4. The report ([`report`]): probabilities, ratios, records. A ratio over zero is null.
//!
//! Every step costs time in proportion to the symbols it reads, apart from sorting and searching sorted lists.

pub mod automaton;
pub mod build;
mod findings;
pub mod model_check;
pub mod output_tracks;
pub mod report;
pub mod verdict;

pub use report::TfaReport;

use super::strings::{self, SymbolRule};
use super::{EvaluationInput, id_order};
use crate::model::fault::Fault;
use findings::Findings;

/// What can be chosen. Decisions are the most probable candidates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TfaSettings {
    pub symbols: SymbolRule,
    /// This many ε in a row end a string.
    pub max_missed: u32,
}

/// Evaluates tracks with the automaton.
///
/// # Errors
/// What is missing or unfit in the inputs for the chosen symbols.
pub fn evaluate_temporal_automaton(input: &EvaluationInput, settings: &TfaSettings) -> Result<TfaReport, Vec<Fault>> {
    if settings.max_missed == 0 {
        return Err(vec![
            Fault::new("/tfa/max_missed", "out_of_range", "no string is left when none missed ends it").allowing("1 or more"),
        ]);
    }
    let strings = strings::write_strings(input, settings.symbols, settings.max_missed)?;
    let target_ranks = id_order::ranks(strings.target_ids.iter().copied());
    let track_ranks = id_order::ranks(input.tracks.tracks.iter().map(|track| track.track_id.as_str()));
    let outputs = &strings.outputs.strings;
    let beginnings = build::Beginnings::new(outputs);
    let automaton = build::build(outputs, &beginnings);
    let judge =
        verdict::Judge { truth: &strings.truth, outputs, automaton: &automaton, beginnings: &beginnings, track_ranks: &track_ranks };
    let verdicts: Vec<verdict::TargetVerdict> = (0..strings.target_ids.len()).map(|target| judge.target(target)).collect();
    let classes = output_tracks::classify(&strings, &target_ranks, &track_ranks);
    let broken = model_check::check(&strings.outputs);
    Ok(Findings { input, settings, strings: &strings, verdicts: &verdicts, classes: &classes, broken: &broken }.report())
}
