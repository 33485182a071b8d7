//! From the body of a request to a plan: names and parameters checked, every fault reported, inputs named.

use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;
use serde::{Deserialize, Serialize};
use serde_json::Value;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JobKind {
    Simulate,
    Associate,
    Evaluate,
}

impl JobKind {
    pub const ALL: [JobKind; 3] = [JobKind::Simulate, JobKind::Associate, JobKind::Evaluate];

    pub fn name(self) -> &'static str {
        match self {
            JobKind::Simulate => "simulate",
            JobKind::Associate => "associate",
            JobKind::Evaluate => "evaluate",
        }
    }
}

/// Where an input comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "source", rename_all = "snake_case")]
pub enum Source {
    Dataset {
        dataset_id: String,
        #[serde(default)]
        sensor_ids: Option<Vec<String>>,
    },
    Job {
        job_id: String,
        #[serde(default)]
        sensor_ids: Option<Vec<String>>,
    },
    File {
        path: String,
        #[serde(default)]
        format: Option<String>,
        #[serde(default)]
        sensor_ids: Option<Vec<String>>,
    },
}

/// One input that the caller must load before the plan can run.
#[derive(Debug, Clone, PartialEq)]
pub struct InputRequest {
    /// Where the request names it, for faults: `/input`, `/truth`, `/tracks`, `/detections`.
    pub pointer: &'static str,
    pub role: DatasetKind,
    pub source: Source,
    /// A job's output may lack this input (a recording without truth); then the plan does without it.
    pub optional: bool,
}

/// A checked request.
#[derive(Debug, Clone)]
pub struct Plan {
    pub kind: JobKind,
    /// The request as normalised: defaults filled in, presets written out. A plan of it is the same plan.
    pub spec: Value,
    pub seed: u32,
    pub inputs: Vec<InputRequest>,
    pub estimate: Estimate,
}

/// What a job will roughly cost.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Detections that a simulation will make; 0 where the input is data.
    pub detections: u64,
    pub cost_s: f64,
    pub bytes: u64,
}

/// Checks the body of a request.
///
/// # Errors
/// Every fault, each with its JSON pointer.
pub fn plan(kind: JobKind, body: &Value) -> Result<Plan, Vec<Fault>> {
    let _ = (kind, body);
    unimplemented!("being written")
}
