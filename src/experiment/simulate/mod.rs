//! Simulates a scenario: detections with known origins, or a bearing-time record, and the truth.

use crate::experiment::input::JobData;
use crate::experiment::job::{
    InputRequest, Job, Known, KnownInputs, Outcome, Planner, RunError, Work, to_value,
};
use crate::experiment::limits::LIMITS;
use crate::experiment::limits::LimitsReport;
use crate::experiment::observer::Observer;
use crate::experiment::request::draft::{Draft, Planned};
use crate::experiment::request::fields::{JOB_NAME, LABELS, SEED};
use crate::experiment::request::scenario::SCENARIO;
use crate::experiment::request::sources::InputSpec;
use crate::model::fault::Fault;
use crate::model::scan::Detection;
use crate::model::sensor::SensorSettings;
use crate::registry::{Kind, Object, required};
use serde::Serialize;

pub static SIMULATE: Object = Object {
    name: "SimulateRequest",
    summary: "Simulate a scenario: detections with known origins, and the truth.",
    fields: &[
        JOB_NAME,
        LABELS,
        LIMITS,
        SEED,
        required("scenario", "The scene.", Kind::Object(&SCENARIO)),
    ],
};

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct SimulateResult {
    counts: SimulationCounts,
    sensors: Vec<SensorSettings>,
    /// Whether the numbers are within the limits, where the request has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub limits: Option<LimitsReport>,
}

#[derive(Debug, Default, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
struct SimulationCounts {
    sensors: u64,
    scans: u64,
    targets: u64,
    detections: u64,
    /// Detections that no target made.
    clutter: u64,
    /// Cells of the bearing-time record that was made instead of detections; then its times are the scans.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    cells: Option<u64>,
}

struct SimulateJob {
    input: InputSpec,
}

/// Plans a simulation.
///
/// # Errors
/// All faults of the request.
pub fn plan(mut draft: Draft, _: Planner) -> Result<Planned, Vec<Fault>> {
    let cost = draft.check_scenario();
    // The scenario stands where other requests have their input.
    draft.finish(Vec::new(), cost, |input: InputSpec| SimulateJob { input })
}

impl Job for SimulateJob {
    fn check_known(&self, _: &[InputRequest], _: &[Option<Known>]) -> KnownInputs {
        KnownInputs::default()
    }

    fn run(&self, work: Work, observer: &mut dyn Observer) -> Result<Outcome, RunError> {
        let settings = work.settings;
        let mut data = JobData::default();
        data.gather(&self.input, None, &[], settings.seed, observer)?;
        let result = to_value(&SimulateResult {
            limits: None,
            counts: counts(&data),
            sensors: data.sensors.clone(),
        })?;
        let mut artifacts = Vec::new();
        if settings.wants_files {
            artifacts = data.write(&self.input, Vec::new(), None, observer)?;
        }
        Ok(data.into_outcome(result, artifacts))
    }
}

fn counts(data: &JobData) -> SimulationCounts {
    if let Some(record) = &data.record {
        return SimulationCounts {
            sensors: 1,
            scans: record.times_s.len() as u64,
            targets: data
                .truth
                .as_ref()
                .map_or(0, |truth| truth.targets().len() as u64),
            cells: Some(record.levels_db.len() as u64),
            ..SimulationCounts::default()
        };
    }
    let Some(recording) = &data.recording else {
        return SimulationCounts::default();
    };
    let is_clutter = |detection: &&Detection| detection.origin.is_none();
    SimulationCounts {
        sensors: recording.sensors.len() as u64,
        scans: recording.scans.len() as u64,
        targets: recording.targets.len() as u64,
        detections: recording.detection_count() as u64,
        clutter: recording.detections().filter(is_clutter).count() as u64,
        cells: None,
    }
}
