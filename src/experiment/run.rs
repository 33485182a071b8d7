//! Runs a plan on its loaded inputs.

use crate::experiment::input::Scene;
use crate::experiment::observer::Observer;
use crate::experiment::plan::{JobKind, Plan};
use crate::experiment::{associate, campaign};
use crate::model::dataset::{Dataset, DatasetSummary};
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use crate::model::watch::Halt;
use serde::Serialize;
use serde_json::{Map, Value};
use std::time::Duration;

/// One loaded input.
#[derive(Debug, Clone)]
pub struct Input {
    pub dataset: Dataset,
    /// What is known of the sensors besides the data: from the upload or from the job that made it.
    pub sensors: Vec<SensorSettings>,
    /// SHA-256 of the bytes it was read from, in hex.
    pub sha256: String,
}

/// What was loaded for each [`InputRequest`](super::plan::InputRequest), in the same order; `None` for an optional one that is absent.
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
    /// How long the associator or the grouper took, where that was asked for.
    pub decided: Option<Decided>,
    /// Of a campaign: the same, cell by cell.
    pub cell_times: Vec<CellTime>,
}

/// What deciding took: that alone, without filter and simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decided {
    pub spent: Duration,
    /// Scans or instants that were decided.
    pub scans: u64,
}

/// What deciding took in a cell of a campaign, per scan; the middle of its timed runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CellTime {
    pub cell: String,
    pub decide_us_per_scan: f64,
    /// To the cell it is compared with.
    pub ratio: Option<f64>,
    pub timed_runs: u32,
}

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
        RunError::Faults(vec![Fault::new("", "malformed", error.to_string())])
    }
}

impl From<Halt> for RunError {
    fn from(halt: Halt) -> Self {
        match halt {
            Halt::Stopped => RunError::Stopped,
            Halt::TooLarge(fault) => RunError::Faults(vec![*fault]),
        }
    }
}

impl From<Vec<Fault>> for RunError {
    fn from(faults: Vec<Fault>) -> Self {
        RunError::Faults(faults)
    }
}

/// Does the work of `plan`.
///
/// # Errors
/// [`RunError::Stopped`] as soon as the observer says so; [`RunError::Faults`] when the inputs do not fit.
pub fn run(plan: &Plan, inputs: Inputs, observer: &mut dyn Observer) -> Result<Outcome, RunError> {
    let mut outcome = work(plan, inputs, observer)?;
    unsign_zeros(&mut outcome.result);
    Ok(outcome)
}

/// Makes every -0 of a result 0: sums and products of nothing have a sign that means nothing.
pub(super) fn unsign_zeros(value: &mut Value) {
    match value {
        Value::Number(number) if number.is_f64() && number.as_f64() == Some(0.0) => {
            *value = Value::from(0.0)
        }
        Value::Array(items) => items.iter_mut().for_each(unsign_zeros),
        Value::Object(fields) => fields.values_mut().for_each(unsign_zeros),
        _ => {}
    }
}

fn work(plan: &Plan, inputs: Inputs, observer: &mut dyn Observer) -> Result<Outcome, RunError> {
    if let Some(campaign) = &plan.campaign {
        return campaign::run(campaign, &inputs, observer);
    }
    let mut scene = Scene::gather(plan, inputs, observer)?;
    let settled = scene.settled(plan);
    let plan = settled.as_ref();
    let mut decided = None;
    let mut parts = Vec::new();
    let mut of_tuples = Map::new();
    if plan.kind == JobKind::Simulate {
        parts.push(("counts", scene.counts()));
        parts.push(("sensors", to_value(&scene.sensors)?));
    }
    if let Some(detection) = &scene.detection {
        parts.push(("detection", to_value(detection)?));
    }
    let tracked = if plan.spec.get("associator").is_some() && plan.kind != JobKind::Correlate {
        Some(scene.track(plan, observer)?)
    } else {
        None
    };
    if let (Some(tracked), Some(recording)) = (&tracked, &scene.recording) {
        decided = tracked.decided;
        parts.push((
            "association",
            to_value(&associate::report(tracked, recording, &scene.sensors))?,
        ));
    }
    let mut files = Vec::new();
    if plan.kind == JobKind::Evaluate {
        let tracks = tracked.as_ref().map(|tracked| &tracked.tracks);
        if scene.wants_automaton(&plan.spec)? {
            let (report, of_automaton) = scene.judge(plan, tracks, observer)?;
            parts.push(("tfa", report));
            files = of_automaton;
        }
        if let Some(judgement) = scene.measure(plan, tracks, observer)? {
            parts.extend(judgement.parts);
            files.extend(judgement.artifacts);
            scene.warn(judgement.warnings);
        }
    }
    if plan.kind == JobKind::Group {
        let (report, of_groups, spent) = scene.group(plan, observer)?;
        decided = spent;
        parts.push(("grouping", report));
        files = of_groups;
    }
    if plan.kind == JobKind::Correlate {
        let (report, of_correlation, spent) = scene.correlate(plan, observer)?;
        decided = spent;
        of_tuples = report;
        files = of_correlation;
    }
    let mut artifacts = if plan.wants_files {
        scene.artifacts(plan, tracked, observer)?
    } else {
        Vec::new()
    };
    artifacts.append(&mut files);
    let mut result: Map<String, Value> = parts
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect();
    result.extend(of_tuples);
    Ok(Outcome {
        result: Value::Object(result),
        warnings: scene.warnings,
        artifacts,
        decided,
        cell_times: Vec::new(),
    })
}

pub(super) fn to_value<T: Serialize>(part: &T) -> Result<Value, RunError> {
    serde_json::to_value(part)
        .map_err(|error| RunError::Faults(vec![Fault::new("", "malformed", error.to_string())]))
}
