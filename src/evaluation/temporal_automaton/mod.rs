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
//! 2. The automaton: of decided strings the strings themselves ([`paths`]), else a table ([`automaton`]), on request
//!    with the fewest states ([`determinise`]); and the model check ([`model_check`]).
//! 3. The verdict on each target ([`verdict`], by [`search`]), the class of each output track ([`output_tracks`]).
//! 4. Beyond the paper: verdicts that forgive errors ([`tolerant`]), probabilities scan by scan ([`weighted`]).
//! 5. The report ([`report`]): probabilities, ratios, records. A ratio over zero is null.
//!
//! Every step costs time in proportion to the symbols it reads, apart from sorting and searching sorted lists.

pub mod automaton;
pub mod births;
pub mod determinise;
pub mod evaluation;
pub mod export;
mod findings;
pub mod model_check;
pub mod output_tracks;
pub mod paths;
pub mod report;
pub mod search;
mod shares;
#[cfg(test)]
mod tests;
pub mod tolerant;
pub mod verdict;
pub mod weighted;

pub use evaluation::TfaEvaluation;
pub use report::TfaReport;
pub use search::Order;
pub use shares::Share;

use super::EvaluationInput;
use super::credit::Credit;
use super::steps::{StepRule, StepSettings};
use super::strings::{DecisionPolicy, SymbolRule};
use crate::model::fault::Fault;
use serde::Deserialize;

/// What can be chosen.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct TfaSettings {
    pub symbols: SymbolRule,
    pub decision: DecisionPolicy,
    /// This many ε in a row end a string.
    pub max_missed: u32,
    /// The largest error budget of the verdicts that forgive.
    pub tolerance: u32,
    pub search: Order,
    /// Whether to determinise and minimise the automaton.
    pub minimise: bool,
    /// Whose times count where symbols are targets.
    #[serde(skip)]
    pub steps: StepSettings,
    /// Which points of a track count.
    #[serde(skip)]
    pub credit: Credit,
}

impl TfaSettings {
    /// As in the paper.
    pub const PAPER: TfaSettings = TfaSettings {
        symbols: SymbolRule::DetectionId,
        decision: DecisionPolicy::MostProbable,
        max_missed: 5,
        tolerance: 5,
        search: Order::BreadthFirst,
        minimise: false,
        steps: StepSettings {
            rule: StepRule::Auto,
            every_s: None,
            time_tolerance_s: None,
        },
        credit: Credit::Afterwards,
    };

    /// # Errors
    /// Every value that makes no sense.
    pub fn check(&self) -> Result<(), Vec<Fault>> {
        let mut faults = Vec::new();
        if self.max_missed == 0 {
            faults.push(
                Fault::new(
                    "/tfa/max_missed",
                    "out_of_range",
                    "no string is left when none missed ends it",
                )
                .allowing("1 or more"),
            );
        }
        if let SymbolRule::NearestDetection { gate_m } | SymbolRule::NearestTruth { gate_m, .. } =
            self.symbols
            && !(gate_m.is_finite() && gate_m > 0.0)
        {
            let detail = format!("a gate of {gate_m} m holds nothing");
            faults.push(
                Fault::new("/tfa/symbols/gate_m", "out_of_range", detail).allowing("above 0"),
            );
        }
        if let DecisionPolicy::AllGated { min_weight } = self.decision {
            if !(min_weight > 0.0 && min_weight <= 1.0) {
                let detail = format!("{min_weight} is not a weight that candidates could have");
                faults.push(
                    Fault::new("/tfa/decision/min_weight", "out_of_range", detail)
                        .allowing("above 0, at most 1"),
                );
            }
            if self.symbols != SymbolRule::DetectionId {
                let detail = "only symbols that tracks give weights to can all be kept; the nearest of something is one alone";
                faults.push(
                    Fault::new("/tfa/decision/policy", "conflict", detail)
                        .allowing("most_probable"),
                );
            }
        }
        if faults.is_empty() {
            Ok(())
        } else {
            Err(faults)
        }
    }
}

/// Evaluates tracks with the automaton.
///
/// # Errors
/// Settings that make no sense; what is missing or unfit in the inputs for the chosen symbols.
pub fn evaluate_temporal_automaton(
    input: &EvaluationInput,
    settings: &TfaSettings,
) -> Result<TfaReport, Vec<Fault>> {
    Ok(TfaEvaluation::new(*input, None, *settings)?.report())
}
