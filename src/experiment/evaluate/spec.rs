//! The type of a request that judges tracks.

use super::requirements::RequirementsSpec;
use super::within::WithinSpec;
use crate::detection::Detector;
use crate::evaluation::credit::Credit;
use crate::evaluation::metrics::BuildMetric;
use crate::evaluation::paths::Alignment;
use crate::evaluation::steps::StepSettings;
use crate::evaluation::{SymbolRule, TfaSettings};
use crate::experiment::request::methods::{Choice, OptionalTracking};
use crate::experiment::request::sources::InputSpec;
use crate::model::sensor::SensorSettings;
use serde::Deserialize;

/// The metrics that directions can be judged by.
pub const METRICS_OF_BEARINGS: &str =
    "ospa, labelled_ospa, ospa2, gospa, clear, identity, hota, kinematics, track_keeping";

/// A request that judges tracks.
#[derive(Clone, Deserialize)]
pub struct Spec {
    #[serde(default)]
    pub input: InputSpec,
    pub detector: Option<Detector>,
    #[serde(default)]
    pub sensors: Vec<SensorSettings>,
    #[serde(flatten)]
    pub tracking: OptionalTracking,
    /// Empty where one recording is judged.
    #[serde(default)]
    pub sequences: Vec<SequenceSpec>,
    pub profile: Profile,
    pub metrics: Vec<Choice<BuildMetric>>,
    pub comparison: ComparisonSpec,
    pub tfa: Option<TfaSettings>,
    pub requirements: Option<RequirementsSpec>,
}

/// One of several recordings.
#[derive(Clone, Deserialize)]
pub struct SequenceSpec {
    pub name: String,
}

/// What is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Profile {
    Tracking,
    Vision,
    /// The automaton alone.
    Tfa,
}

/// How truth and tracks are put side by side.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct ComparisonSpec {
    pub gate_m: f64,
    pub gate_deg: f64,
    pub min_iou: f64,
    pub alignment: AlignmentSpec,
    #[serde(flatten)]
    steps: StepSettings,
    credit: Option<Credit>,
    /// Where, when and whom to judge.
    pub within: Option<WithinSpec>,
}

impl ComparisonSpec {
    /// Of the metrics, and of an automaton on targets.
    pub fn credit(&self) -> Credit {
        self.credit.unwrap_or_default()
    }

    /// An automaton on detections judges what the tracker decided, not what an operator saw.
    pub fn credit_of(&self, symbols: SymbolRule) -> Credit {
        match symbols {
            SymbolRule::NearestTruth { .. } => self.credit(),
            _ => self.credit.unwrap_or(Credit::Afterwards),
        }
    }

    pub fn steps(&self) -> StepSettings {
        StepSettings {
            time_tolerance_s: self.alignment.time_tolerance_s,
            ..self.steps
        }
    }
}

/// How truth is brought to the times of tracks.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct AlignmentSpec {
    #[serde(flatten)]
    pub rule: Alignment,
    /// Times that differ by no more are one step.
    pub time_tolerance_s: Option<f64>,
}
