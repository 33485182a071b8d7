//! The report, in the names that users read. Absent values are null and no number is NaN.
//!
//! In records a symbol is shown by name, ε inside a string as "ε", and null is "outside the string".

use super::model_check::ViolationKind;
use super::output_tracks::TrackClass;
use super::shares::Share;
use super::verdict::Verdict;
use serde::Serialize;

/// How ε inside a string is written.
pub const EPSILON: &str = "ε";

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TfaReport {
    pub parameters: Parameters,
    pub counts: Counts,
    pub probability: Probabilities,
    pub ratios: Ratios,
    /// All probabilities with what they are shares of.
    pub shares: Vec<Share>,
    pub automaton: AutomatonSizes,
    /// Verdicts that forgive up to k errors, for each k from 0.
    pub tolerance: Vec<Tolerance>,
    /// The truth strings are all among those that the automaton accepts.
    pub consistent: bool,
    /// Missed targets that a track is matched to: it began too late for the strict verdict.
    pub missed_with_matched_track: usize,
    pub targets: Vec<TargetReport>,
    pub output_tracks: Vec<OutputTrackReport>,
    /// The first ones by scan; `counts.violations` are all.
    pub violations: Vec<Violation>,
    pub violations_left_out: usize,
    /// The first ones by track; `counts.unknown_detections` are all.
    pub unknown_detections: Vec<UnknownDetection>,
    pub unknown_detections_left_out: usize,
    pub warnings: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Parameters {
    /// `detection_id`, `nearest_detection` or `nearest_truth`.
    pub symbols: &'static str,
    pub gate_m: Option<f64>,
    pub max_gap_s: Option<f64>,
    /// `most_probable` or `all_gated`.
    pub decision: &'static str,
    /// Of `all_gated`.
    pub min_weight: Option<f64>,
    pub max_missed: u32,
    /// The largest k of `tolerance`.
    pub tolerance: u32,
    /// `breadth_first` or `depth_first`.
    pub search: &'static str,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Counts {
    pub targets: usize,
    pub output_tracks: usize,
    pub correct: usize,
    pub missed: usize,
    /// Of the missed, those that a track followed all the same, from a later scan on.
    pub late: usize,
    #[serde(rename = "false")]
    pub wrong: usize,
    pub matched_tracks: usize,
    pub redundant_tracks: usize,
    pub false_tracks: usize,
    pub violations: usize,
    pub unknown_detections: usize,
}

/// Correct targets by output tracks; missed and false targets by targets.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Probabilities {
    pub correct: Option<f64>,
    pub missed: Option<f64>,
    #[serde(rename = "false")]
    pub wrong: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Ratios {
    pub correct_per_target: Option<f64>,
    pub output_tracks_per_target: Option<f64>,
}

/// Targets that are correct when up to `k` errors are forgiven, and what part of the output tracks they are.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Tolerance {
    pub k: usize,
    pub correct: usize,
    pub probability: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Size {
    pub states: usize,
    pub transitions: usize,
}

/// The automaton as built, and determinised and minimised where that was asked for and was not too large.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct AutomatonSizes {
    pub states: usize,
    pub transitions: usize,
    pub minimised: Option<Size>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TargetReport {
    pub truth_id: String,
    pub verdict: Verdict,
    /// Its strings lead from the start state to final states.
    pub reachable: bool,
    /// Number and time of the first scan at which truth and track differ; of false targets only.
    pub at_scan: Option<u32>,
    pub at_time_s: Option<f64>,
    /// What the truth string has at that scan; null after its end.
    pub expected: Option<String>,
    /// What the track has there; null after its end.
    pub took: Option<String>,
    pub took_kind: Option<TookKind>,
    pub took_truth_id: Option<String>,
    /// The track that speaks for the target; null when none began as its string does.
    pub track_id: Option<String>,
    pub errors: usize,
    /// The least k with which it counts as correct in `tolerance`; null when no track was left for it.
    pub least_errors: Option<usize>,
    /// Logarithm of the product of the weights along the paths of a correct target.
    pub log_probability: Option<f64>,
    /// How many scans the target has in its strings that are not ε, and how many strings.
    pub symbols: usize,
    pub strings: usize,
    pub start_scan: Option<u32>,
    pub end_scan: Option<u32>,
    pub matched_track_id: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TookKind {
    Clutter,
    Target,
    Epsilon,
    Ended,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutputTrackReport {
    pub track_id: String,
    /// Which string of the track, from 1: a gap ends one output track and begins the next.
    pub part: u32,
    pub class: TrackClass,
    pub follows: Option<String>,
    pub start_scan: Option<u32>,
    pub end_scan: Option<u32>,
    /// Scans that are not ε.
    pub symbols: usize,
    /// Scans at which the track and the target it follows differ.
    pub errors: Option<usize>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Violation {
    pub kind: ViolationKind,
    pub scan: u32,
    pub time_s: f64,
    pub detection_ids: Vec<String>,
    pub track_ids: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnknownDetection {
    pub track_id: String,
    pub scan: u32,
    pub time_s: f64,
    pub detection_id: String,
}
