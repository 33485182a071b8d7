//! What a job is: a request that was parsed, the inputs that it reads, and what it leaves behind. Each kind implements [`Job`]
//! in a folder of its own.

use super::limits::{self, Limit, LimitCheck, LimitsReport};
use super::observer::Observer;
use crate::math::rng::Seed;
use crate::model::dataset::{Dataset, DatasetKind, DatasetSummary};
use crate::model::facts::RecordingFacts;
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use crate::model::watch::Halt;
use crate::registry::Object;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::any::Any;
use std::sync::Arc;
use std::time::Duration;

/// What a job does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum JobKind {
    Simulate,
    Associate,
    Evaluate,
    Group,
    Correlate,
    Campaign,
}

impl JobKind {
    pub const ALL: [JobKind; 6] = [
        JobKind::Simulate,
        JobKind::Associate,
        JobKind::Evaluate,
        JobKind::Group,
        JobKind::Correlate,
        JobKind::Campaign,
    ];

    pub fn name(self) -> &'static str {
        match self {
            JobKind::Simulate => "simulate",
            JobKind::Associate => "associate",
            JobKind::Evaluate => "evaluate",
            JobKind::Group => "group",
            JobKind::Correlate => "correlate",
            JobKind::Campaign => "campaign",
        }
    }

    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

/// A parsed request: its parts are typed, and it runs without a look at the JSON that it came from.
pub trait Job: Any + Send + Sync {
    /// Holds what is known of the inputs, in the order of `requests`, against the request.
    fn check_known(&self, requests: &[InputRequest], known: &[Option<Known>]) -> KnownInputs;

    /// Does the work.
    ///
    /// # Errors
    /// [`RunError::Stopped`] as soon as the observer says so; [`RunError::Faults`] when the inputs do not fit.
    fn run(&self, work: Work, observer: &mut dyn Observer) -> Result<Outcome, RunError>;
}

/// What a job works on, and how.
pub struct Work<'a> {
    pub requests: &'a [InputRequest],
    /// What was loaded for them.
    pub inputs: Inputs,
    pub settings: RunSettings,
}

/// How a job is run, besides what its request says.
#[derive(Debug, Clone, Copy)]
pub struct RunSettings {
    pub seed: Seed,
    /// Whether the files are wanted: not of the runs of a campaign.
    pub wants_files: bool,
    /// Whether the associator, the grouper or the correlator is timed by itself, where the observer has a clock.
    pub time_association: bool,
}

/// A checked request.
#[derive(Clone)]
pub struct Plan {
    pub kind: JobKind,
    /// The request as normalised: defaults filled in, presets written out. It is what is stored and hashed; a plan of it is the
    /// same plan.
    pub spec: Value,
    pub seed: u32,
    /// Number of the run within a campaign; 0 for a job alone.
    pub run: u32,
    pub wants_files: bool,
    pub time_association: bool,
    /// What must be loaded before it runs, in the order in which [`run`] takes it.
    pub inputs: Vec<InputRequest>,
    pub cost: Cost,
    /// What the result must meet.
    pub limits: Vec<Limit>,
    pub job: Arc<dyn Job>,
}

impl Plan {
    /// The job, if it is of this type.
    pub fn job_as<T: Job>(&self) -> Option<Arc<T>> {
        let job: Arc<dyn Any + Send + Sync> = self.job.clone();
        job.downcast().ok()
    }
}

impl std::fmt::Debug for Plan {
    fn fmt(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(formatter, "Plan of {} {}", self.kind.name(), self.spec)
    }
}

/// The planner of all kinds, handed to a kind whose jobs hold jobs of other kinds.
#[derive(Clone, Copy)]
pub struct Planner {
    pub plan: fn(JobKind, &Value) -> Result<Plan, Vec<Fault>>,
    /// The table that describes the body of a request.
    pub request: fn(JobKind) -> &'static Object,
}

/// Where an input that must be loaded comes from.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "source", rename_all = "snake_case")]
pub enum Source {
    Dataset {
        dataset_id: String,
        sensor_ids: Option<Vec<String>>,
    },
    Job {
        job_id: String,
        sensor_ids: Option<Vec<String>>,
        /// Which of its tracks are meant.
        #[serde(default)]
        estimates: Estimates,
    },
}

/// Tracks as they were known at each scan, or in the light of later ones.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Estimates {
    #[default]
    Filtered,
    Smoothed,
}

impl Source {
    /// The sensors that are wanted of it; `None` of all.
    pub fn sensor_ids(&self) -> Option<&[String]> {
        let (Source::Dataset { sensor_ids, .. } | Source::Job { sensor_ids, .. }) = self;
        sensor_ids.as_deref()
    }
}

/// One input that the caller must load before the plan can run.
#[derive(Debug, Clone, PartialEq)]
pub struct InputRequest {
    /// Where the request names it, for faults: `/input`, `/truth`, `/tracks`, `/detections`, `/sequences/0/truth`, …
    pub pointer: String,
    /// Index of the sequence that it belongs to.
    pub sequence: Option<usize>,
    pub role: DatasetKind,
    pub source: Source,
    /// A job's output may lack this input (a recording without truth); then the plan does without it.
    pub optional: bool,
}

/// What a job will roughly cost.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = CostEstimate))]
pub struct Cost {
    /// Detections that a simulation will make, or that are known to be in the data.
    pub detections: u64,
    pub cost_s: f64,
    pub bytes: u64,
}

impl std::ops::AddAssign for Cost {
    fn add_assign(&mut self, other: Cost) {
        self.detections += other.detections;
        self.cost_s += other.cost_s;
        self.bytes += other.bytes;
    }
}

/// What is known of one input before it is loaded.
#[derive(Debug, Clone, PartialEq)]
pub struct Known {
    /// Of detections.
    pub recording: RecordingFacts,
    /// What is known of the sensors besides the data.
    pub sensors: Vec<SensorSettings>,
}

impl Known {
    /// Of data that are there; `None` of anything but detections.
    pub fn from_dataset(dataset: &Dataset, sensors: &[SensorSettings]) -> Option<Known> {
        let Dataset::Detections(recording) = dataset else {
            return None;
        };
        Some(Known {
            recording: RecordingFacts::from_recording(recording),
            sensors: sensors.to_vec(),
        })
    }
}

/// What follows from what is known of the inputs.
#[derive(Default)]
pub struct KnownInputs {
    pub faults: Vec<Fault>,
    /// What the data add to the cost.
    pub cost: Cost,
    pub settled: Option<Settled>,
}

/// A job whose filter was left open and is chosen now.
pub struct Settled {
    /// The filter, as the request would say it.
    pub filter: Value,
    pub job: Arc<dyn Job>,
}

/// One loaded input.
#[derive(Debug, Clone)]
pub struct Input {
    pub dataset: Dataset,
    /// What is known of the sensors besides the data: from the upload or from the job that made it.
    pub sensors: Vec<SensorSettings>,
    /// SHA-256 of the bytes it was read from, in hex.
    pub sha256: String,
}

/// What was loaded for each [`InputRequest`], in the same order; `None` for an optional one that is absent.
pub type Inputs = Vec<Option<Input>>;

/// Every media type of an artefact, without parameters.
pub const ARTIFACT_TYPES: [&str; 7] = [
    "application/json",
    "application/vnd.apache.parquet",
    "image/svg+xml",
    "text/csv",
    "text/markdown",
    "text/plain",
    "text/vnd.graphviz",
];

/// A file that a job leaves behind.
#[derive(Debug, Clone)]
pub struct Artifact {
    /// `detections.csv`, `truth.csv`, `tracks.csv`, …
    pub name: &'static str,
    pub media_type: &'static str,
    pub bytes: Vec<u8>,
    /// Set when the artefact is a dataset that other jobs can use.
    pub dataset: Option<DatasetSummary>,
    /// What is known of the sensors behind it.
    pub sensors: Vec<SensorSettings>,
}

impl Artifact {
    /// A file that is no dataset.
    pub fn file(name: &'static str, media_type: &'static str, bytes: Vec<u8>) -> Self {
        debug_assert!(
            media_type
                .split(';')
                .next()
                .is_some_and(|name| ARTIFACT_TYPES.contains(&name)),
            "{media_type} is no type of an artefact"
        );
        Artifact {
            name,
            media_type,
            bytes,
            dataset: None,
            sensors: Vec::new(),
        }
    }
}

/// What a job found.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The report's `result`: the same bytes for the same spec, seed and inputs.
    pub result: Value,
    pub warnings: Vec<String>,
    pub artifacts: Vec<Artifact>,
    /// How long the associator, the grouper or the correlator took, where that was asked for.
    pub association_time: Option<AssociationTime>,
    /// Of a campaign: the same, cell by cell.
    pub cell_times: Vec<CellTime>,
    /// Held already by the job, beside the limits of its request.
    pub checks: Vec<LimitCheck>,
}

/// What deciding took: that alone, without filter and simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AssociationTime {
    pub spent: Duration,
    /// Scans or instants that were decided.
    pub scans: u64,
}

/// How long the associator or grouper of a cell took, by itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct CellTime {
    pub cell: String,
    /// The middle of the timed runs, in microseconds a scan.
    pub decide_us_per_scan: f64,
    /// To the cell it is compared with.
    pub ratio: Option<f64>,
    pub timed_runs: u32,
}

/// Why a job has no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RunError {
    /// The observer asked to stop.
    #[error("stopped")]
    Stopped,
    /// The data and the request do not fit together.
    #[error("{} fault(s) in the inputs", .0.len())]
    Faults(Vec<Fault>),
}

impl From<std::io::Error> for RunError {
    fn from(error: std::io::Error) -> Self {
        Fault::new("", "malformed", error.to_string()).into()
    }
}

impl From<Halt> for RunError {
    fn from(halt: Halt) -> Self {
        match halt {
            Halt::Stopped => RunError::Stopped,
            Halt::TooLarge(fault) => RunError::Faults(vec![*fault]),
            Halt::Late { .. } => Fault::new("/scans", "unsorted", halt.to_string()).into(),
        }
    }
}

impl From<Fault> for RunError {
    fn from(fault: Fault) -> Self {
        RunError::Faults(vec![fault])
    }
}

impl From<Vec<Fault>> for RunError {
    fn from(faults: Vec<Fault>) -> Self {
        RunError::Faults(faults)
    }
}

/// Faults as a refusal; none is none.
pub fn refuse_any(faults: Vec<Fault>) -> Result<(), Vec<Fault>> {
    if faults.is_empty() {
        Ok(())
    } else {
        Err(faults)
    }
}

/// Does the work of `plan`.
///
/// # Errors
/// As [`Job::run`].
pub fn run(plan: &Plan, inputs: Inputs, observer: &mut dyn Observer) -> Result<Outcome, RunError> {
    let settings = RunSettings {
        seed: Seed {
            seed: plan.seed,
            run: plan.run,
        },
        wants_files: plan.wants_files,
        time_association: plan.time_association,
    };
    run_with(plan, inputs, settings, observer)
}

/// The same with other settings.
///
/// # Errors
/// As [`Job::run`].
pub fn run_with(
    plan: &Plan,
    inputs: Inputs,
    settings: RunSettings,
    observer: &mut dyn Observer,
) -> Result<Outcome, RunError> {
    let work = Work {
        requests: &plan.inputs,
        inputs,
        settings,
    };
    let mut outcome = plan.job.run(work, observer)?;
    unsign_zeros(&mut outcome.result);
    // A campaign judges its cells itself, for others put their runs together.
    let mut checks = std::mem::take(&mut outcome.checks);
    if !(plan.limits.is_empty() && checks.is_empty()) && plan.kind != JobKind::Campaign {
        let of_request = limits::judge(&plan.limits, &outcome.result);
        checks.extend(of_request.checks);
        let report = LimitsReport::of(checks);
        outcome.warnings.extend(report.warning());
        if let Some(parts) = outcome.result.as_object_mut() {
            parts.insert("limits".to_owned(), to_value(&report)?);
        }
    }
    Ok(outcome)
}

/// Makes every -0 of a result 0: sums and products of nothing have a sign that means nothing.
pub fn unsign_zeros(value: &mut Value) {
    match value {
        Value::Number(number) if number.is_f64() && number.as_f64() == Some(0.0) => {
            *value = Value::from(0.0)
        }
        Value::Array(items) => items.iter_mut().for_each(unsign_zeros),
        Value::Object(fields) => fields.values_mut().for_each(unsign_zeros),
        _ => {}
    }
}

/// A part of a result as JSON.
pub fn to_value<T: Serialize>(part: &T) -> Result<Value, RunError> {
    serde_json::to_value(part)
        .map_err(|error| Fault::new("", "malformed", error.to_string()).into())
}
