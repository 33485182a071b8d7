//! Several jobs side by side, on the wire.

use super::job::JobKind;
use crate::math::stats::Interval;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use uuid::Uuid;

/// Jobs side by side. Lists of values stand in the order of `jobs`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Comparison {
    pub jobs: Vec<ComparedJob>,
    /// The job that the others are compared with.
    pub baseline: Uuid,
    /// Of the intervals.
    pub confidence: f64,
    /// Numbers of the reports that two jobs or more have.
    pub numbers: Vec<ComparedNumber>,
    /// Differences value by value: over the runs of campaigns, and over the times at which truth and tracks were compared.
    pub paired: Vec<PairedNumber>,
    /// How the verdicts on the same targets differ; absent where the baseline has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub verdicts: Option<Vec<ComparedVerdicts>>,
    /// Where the requests differ.
    pub request: Vec<RequestDifference>,
    /// What the reader of the differences should know.
    pub notes: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ComparedJob {
    pub id: Uuid,
    pub kind: JobKind,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub name: Option<String>,
    pub seed: u32,
    /// Seconds that it computed.
    pub total_s: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ComparedNumber {
    /// Where it stands in `result`, names divided by dots.
    pub path: String,
    /// Empty where it has none, or where the report does not say.
    pub unit: String,
    /// Whether larger values are better; null where neither is.
    pub higher_is_better: Option<bool>,
    pub values: Vec<Option<f64>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum PairedOver {
    /// Runs of a cell that two campaigns share.
    Runs,
    /// Targets that both judged.
    Targets,
    /// Times at which truth and tracks were compared. They follow each other: the interval is that of the means of √n batches.
    Steps,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PairedNumber {
    /// Metric and quantity, or outcome.
    pub name: String,
    /// The cell of the campaigns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub cell: Option<String>,
    pub over: PairedOver,
    pub unit: String,
    /// Whether larger values are better; null where neither is.
    pub higher_is_better: Option<bool>,
    /// Mean of each job over what it has itself.
    pub means: Vec<Option<f64>>,
    /// Each job less the baseline; null of the baseline, and where nothing can be paired.
    pub differences: Vec<Option<PairedDifference>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PairedDifference {
    /// Runs or steps that both jobs have.
    pub pairs: u64,
    pub mean: f64,
    /// Null of too few pairs.
    pub interval: Option<Interval>,
    /// Pairs in which the job has the smaller number, and in which it has the larger.
    pub smaller: u64,
    pub larger: u64,
    /// Against the baseline, where one direction is better and there is an interval.
    pub verdict: Option<DifferenceVerdict>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum DifferenceVerdict {
    /// The whole interval is on the better side of 0.
    Better,
    Worse,
    /// The interval holds 0.
    NotSignificant,
}

/// A job's verdicts beside those of the baseline, on the targets that both judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct ComparedVerdicts {
    pub job_id: Uuid,
    pub targets: u64,
    /// Correct in both.
    pub both_correct: u64,
    /// Correct here alone.
    pub gained: u64,
    /// Correct in the baseline alone.
    pub lost: u64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RequestDifference {
    /// JSON pointer into the request.
    pub pointer: String,
    /// As JSON; null where a request has nothing there.
    pub values: Vec<Option<String>>,
}
