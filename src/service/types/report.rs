//! Reports on the wire. The service stores and sends a report as bytes; these types say what is in it, to the API
//! document and to Rust programs that read one.

use super::dataset::DatasetKind;
use super::tracking_events::EventCounts;
use crate::evaluation::temporal_automaton::Share as TfaShare;
use crate::experiment::{
    AssociateResult, Association, CampaignResult, CellTime, Compared, CorrelateResult,
    DetectionResult, GroupResult, Input, InputRequest, LimitsReport, RequirementsReport,
    SimulateResult, Source,
};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use utoipa::ToSchema;
use uuid::Uuid;

macro_rules! report {
    ($(#[$doc:meta])* $report:ident, $kind:ident::$variant:ident, $result:ty) => {
        #[derive(Debug, Serialize, ToSchema)]
        #[serde(rename_all = "snake_case")]
        pub enum $kind {
            $variant,
        }

        $(#[$doc])*
        #[derive(Debug, Serialize, ToSchema)]
        pub struct $report {
            pub kind: $kind,
            pub job_id: Uuid,
            /// The request as normalised.
            #[schema(value_type = Object)]
            pub spec: Value,
            pub seed: u32,
            pub engine_version: String,
            pub inputs: Vec<ReportInput>,
            pub warnings: Vec<String>,
            pub timing: Timing,
            pub result: $result,
        }
    };
}

report!(
    /// What a simulation made.
    SimulateReport,
    SimulateReportKind::Simulate,
    SimulateResult
);
report!(
    /// What a tracker made of a recording.
    AssociateReport,
    AssociateReportKind::Associate,
    AssociateResult
);
report!(
    /// How tracks compare with the truth.
    EvaluateReport,
    EvaluateReportKind::Evaluate,
    EvaluateResult
);
report!(
    /// What was put together.
    GroupReport,
    GroupReportKind::Group,
    GroupResult
);
report!(
    /// Which tracks are of one target.
    CorrelateReport,
    CorrelateReportKind::Correlate,
    CorrelateResult
);
report!(
    /// What many runs gave.
    CampaignReport,
    CampaignReportKind::Campaign,
    CampaignResult
);

/// The report of a job. `result` is the same, byte for byte, for the same request.
#[derive(Debug, Serialize, ToSchema)]
#[serde(untagged)]
#[expect(
    clippy::large_enum_variant,
    reason = "one report at a time; boxes would only hide the shape"
)]
pub enum Report {
    Simulate(SimulateReport),
    Associate(AssociateReport),
    Evaluate(EvaluateReport),
    Group(GroupReport),
    Correlate(CorrelateReport),
    Campaign(CampaignReport),
}

/// What a job read.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct ReportInput {
    pub role: DatasetKind,
    /// `dataset` or `job`.
    pub source: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Uuid>, nullable = false)]
    pub dataset_id: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Uuid>, nullable = false)]
    pub job_id: Option<String>,
    pub sha256: String,
}

impl ReportInput {
    pub fn new(request: &InputRequest, input: &Input) -> Self {
        let (source, dataset_id, job_id) = match &request.source {
            Source::Dataset { dataset_id, .. } => ("dataset", Some(dataset_id.clone()), None),
            Source::Job { job_id, .. } => ("job", None, Some(job_id.clone())),
        };
        ReportInput {
            role: request.role,
            source,
            dataset_id,
            job_id,
            sha256: input.sha256.clone(),
        }
    }
}

/// Seconds that each step computed.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct Timing {
    pub load_s: f64,
    pub simulate_s: f64,
    pub detect_s: f64,
    pub associate_s: f64,
    pub correlate_s: f64,
    pub evaluate_s: f64,
    pub total_s: f64,
    /// Of a campaign.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cells: Vec<CellTime>,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct EvaluateResult {
    /// Where the input was a bearing-time record.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub detection: Option<DetectionResult>,
    /// Absent where the job judged tracks that it did not make.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub association: Option<Association>,
    /// Absent where only metrics were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub tfa: Option<Tfa>,
    /// By name, over all sequences together. Absent where no metric was asked for or no truth was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub metrics: Option<BTreeMap<String, MetricReport>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub events: Option<EventCounts>,
    /// What a reader must know before the numbers: whose times count, what is a match, what was left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub comparison: Option<Compared>,
    /// Each sequence alone, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub sequences: Option<Vec<SequenceMetrics>>,
    /// The same tracks in the light of later scans, where `tracker.smoothing` asked for them.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub smoothed: Option<SmoothedMetrics>,
    /// Of air surveillance, where the request has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub requirements: Option<RequirementsReport>,
    /// Whether the numbers are within the limits, where the request has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub limits: Option<LimitsReport>,
}

/// What the metrics say of smoothed tracks.
#[derive(Debug, Serialize, ToSchema)]
pub struct SmoothedMetrics {
    pub metrics: BTreeMap<String, MetricReport>,
    pub events: EventCounts,
    pub comparison: Compared,
}

/// What a metric says. Its values over time, and those of each target and each track, are in the job's files.
#[derive(Debug, Serialize, ToSchema)]
pub struct MetricReport {
    /// The headline; null with a reason where undefined.
    pub value: Option<f64>,
    pub unit: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub reason: Option<String>,
    pub higher_is_better: bool,
    /// All parameters that it was computed with.
    #[schema(value_type = Object)]
    pub parameters: Value,
    /// Everything it says in numbers, by name; the headline too.
    pub quantities: BTreeMap<String, Quantity>,
    /// How its numbers are made of the rows of the job's files; of the metrics over everything.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub from: Option<Vec<NumberOrigin>>,
    /// Values over another axis than time.
    pub curves: Vec<Curve>,
    /// What it says besides numbers, target by target; only of metrics that have it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Object, nullable = false)]
    pub findings: Option<Value>,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct Quantity {
    pub value: Option<f64>,
    pub unit: String,
    /// Why there is no value.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub reason: Option<String>,
}

/// How a number is made: a statistic of rows of a `file`, or of other numbers of the metric (`over`, `under`).
#[derive(Debug, Serialize, ToSchema)]
pub struct NumberOrigin {
    /// One of the quantities, or a step on the way to them; `series.x` is over time, `curves.x` along a curve.
    pub quantity: String,
    pub statistic: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub file: Option<String>,
    /// Of the file: the rows in which it is filled.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub column: Option<String>,
    /// The values that a column of the rows must have.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub filter: Option<BTreeMap<String, Vec<String>>>,
    /// Numbers that are added; those after `-` are subtracted.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub over: Option<Vec<String>>,
    /// Their sum is what is divided by.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub under: Option<Vec<String>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub factor: Option<f64>,
    /// The order of the root that is taken.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub root: Option<f64>,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct Curve {
    pub name: String,
    pub unit: String,
    /// What `at` holds.
    pub axis: String,
    pub at: Vec<f64>,
    pub values: Vec<Option<f64>>,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct SequenceMetrics {
    pub name: String,
    pub metrics: BTreeMap<String, MetricReport>,
}

/// The verdicts of the temporal automaton.
#[derive(Debug, Serialize, ToSchema)]
pub struct Tfa {
    pub parameters: TfaParameters,
    pub counts: TfaCounts,
    pub probability: TfaProbability,
    pub ratios: TfaRatios,
    /// All probabilities with what they are shares of.
    #[schema(required = false)]
    pub shares: Vec<TfaShare>,
    pub automaton: TfaAutomaton,
    /// Verdicts that forgive up to k errors, for each k from 0.
    pub tolerance: Vec<TfaTolerance>,
    /// The automaton accepts every truth string.
    pub consistent: bool,
    /// Missed targets that a track is matched to: it began too late for the strict verdict.
    pub missed_with_matched_track: u64,
    pub targets: Vec<TfaTarget>,
    pub output_tracks: Vec<TfaOutputTrack>,
    /// The first 1000 by scan; `counts.violations` are all.
    pub violations: Vec<TfaViolation>,
    pub violations_left_out: u64,
    /// The first 1000 by track; `counts.unknown_detections` are all.
    pub unknown_detections: Vec<TfaUnknownDetection>,
    pub unknown_detections_left_out: u64,
    pub warnings: Vec<String>,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct TfaParameters {
    /// `detection_id`, `nearest_detection` or `nearest_truth`.
    pub symbols: String,
    pub gate_m: Option<f64>,
    pub max_gap_s: Option<f64>,
    /// `most_probable` or `all_gated`.
    pub decision: String,
    /// Of `all_gated`.
    pub min_weight: Option<f64>,
    pub max_missed: u32,
    /// The largest k of `tolerance`.
    pub tolerance: u32,
    /// `breadth_first` or `depth_first`.
    pub search: String,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct TfaCounts {
    pub targets: u64,
    pub output_tracks: u64,
    pub correct: u64,
    pub missed: u64,
    /// Of the missed, those that a track followed all the same, from a later scan on.
    pub late: u64,
    #[serde(rename = "false")]
    pub wrong: u64,
    pub matched_tracks: u64,
    pub redundant_tracks: u64,
    pub false_tracks: u64,
    pub violations: u64,
    pub unknown_detections: u64,
}

/// The automaton as built, and determinised and minimised where that was asked for and was not too large.
#[derive(Debug, Serialize, ToSchema)]
pub struct TfaAutomaton {
    pub states: u64,
    pub transitions: u64,
    pub minimised: Option<TfaAutomatonSize>,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct TfaAutomatonSize {
    pub states: u64,
    pub transitions: u64,
}

/// Targets that are correct when up to `k` errors are forgiven, and what part of the output tracks they are.
#[derive(Debug, Serialize, ToSchema)]
pub struct TfaTolerance {
    pub k: u64,
    pub correct: u64,
    pub probability: Option<f64>,
}

/// Correct targets by output tracks; missed and false targets by targets. Null over zero.
#[derive(Debug, Serialize, ToSchema)]
pub struct TfaProbability {
    pub correct: Option<f64>,
    pub missed: Option<f64>,
    #[serde(rename = "false")]
    pub wrong: Option<f64>,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct TfaRatios {
    pub correct_per_target: Option<f64>,
    pub output_tracks_per_target: Option<f64>,
}

#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum TfaVerdict {
    Correct,
    Missed,
    False,
}

#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum TfaTookKind {
    Clutter,
    Target,
    Epsilon,
    Ended,
}

/// The verdict on one target, with the record of its first error.
#[derive(Debug, Serialize, ToSchema)]
pub struct TfaTarget {
    pub truth_id: String,
    pub verdict: TfaVerdict,
    /// Its strings lead from the start state to final states.
    pub reachable: bool,
    /// Number of the first scan at which truth and track differ; of false targets only.
    pub at_scan: Option<u32>,
    pub at_time_s: Option<f64>,
    /// What the truth has at that scan; null after its end.
    pub expected: Option<String>,
    /// What the track has there; null after its end.
    pub took: Option<String>,
    pub took_kind: Option<TfaTookKind>,
    pub took_truth_id: Option<String>,
    /// The track that speaks for the target; null where none began as its string does.
    pub track_id: Option<String>,
    pub errors: u64,
    /// The least k with which it counts as correct in `tolerance`; null where no track was left for it.
    pub least_errors: Option<u64>,
    pub log_probability: Option<f64>,
    pub symbols: u64,
    pub strings: u64,
    pub start_scan: Option<u32>,
    pub end_scan: Option<u32>,
    pub matched_track_id: Option<String>,
}

#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum TfaTrackClass {
    Matched,
    Redundant,
    False,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct TfaOutputTrack {
    pub track_id: String,
    /// Which string of the track, from 1.
    pub part: u32,
    pub class: TfaTrackClass,
    /// The target it follows.
    pub follows: Option<String>,
    pub start_scan: Option<u32>,
    pub end_scan: Option<u32>,
    pub symbols: u64,
    pub errors: Option<u64>,
}

#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum TfaViolationKind {
    DetectionSharedByTracks,
    SeveralDetectionsInTrack,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct TfaViolation {
    pub kind: TfaViolationKind,
    pub scan: u32,
    pub time_s: f64,
    pub detection_ids: Vec<String>,
    pub track_ids: Vec<String>,
}

#[derive(Debug, Serialize, ToSchema)]
pub struct TfaUnknownDetection {
    pub track_id: String,
    pub scan: u32,
    pub time_s: f64,
    pub detection_id: String,
}

/// A job as normalised: a request with its kind. Its schema comes from the tables that check requests.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(value_type = Object)]
pub struct JobSpec(pub Value);
