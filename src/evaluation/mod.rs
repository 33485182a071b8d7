//! How good tracks are, measured against what is known of the targets.
//!
//! Every method here reads tracks as *strings*: one symbol a scan, a detection or a target, or ε for nothing.
//! [`strings`] makes them (scan by scan on the [`axis`], by [`identities`] of detections, by the nearest detection or by
//! [`nearest_truth`]), and [`temporal_automaton`] judges them.
//!
//! Absent here: files, job requests, and any knowledge of how the tracks were made.

mod acquaintances;
pub mod axis;
pub mod causes;
pub mod comparison;
pub mod credit;
pub mod events;
pub mod extent;
pub mod grouping;
mod id_order;
pub mod identities;
mod matching;
pub mod metrics;
mod nearest_detection;
mod nearest_point;
pub mod nearest_truth;
pub mod nearness;
mod overlaps;
pub mod paths;
pub mod scope;
pub mod spaces;
pub mod steps;
pub mod strings;
pub mod surveillance;
pub mod temporal_automaton;
#[cfg(test)]
mod tests;

pub use strings::{DecisionPolicy, SymbolRule};
pub use temporal_automaton::{TfaReport, TfaSettings, evaluate_temporal_automaton};

use crate::model::{scan::Recording, track::TrackSet, truth::TruthSet};

/// What an evaluation is given.
#[derive(Debug, Clone, Copy)]
pub struct EvaluationInput<'a> {
    pub recording: Option<&'a Recording>,
    pub truth: Option<&'a TruthSet>,
    pub tracks: &'a TrackSet,
}
