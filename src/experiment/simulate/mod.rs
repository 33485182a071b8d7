//! Simulates a scenario: detections with known origins, or a bearing-time record, and the truth.

use crate::experiment::input::JobData;
use crate::experiment::job::{
    Cost, InputRequest, Inputs, Job, Known, KnownInputs, Outcome, Planner, RunError, RunSettings,
    to_value,
};
use crate::experiment::observer::Observer;
use crate::experiment::request::draft::{Draft, Planned};
use crate::experiment::request::fields::{JOB_NAME, LABELS, SEED};
use crate::experiment::request::scenario::SCENARIO;
use crate::experiment::request::sources::InputSpec;
use crate::model::fault::Fault;
use crate::registry::{Kind, Object, required};
use serde_json::{Value, json};

pub static SIMULATE: Object = Object {
    name: "SimulateRequest",
    summary: "Simulate a scenario: detections with known origins, and the truth.",
    fields: &[
        JOB_NAME,
        LABELS,
        SEED,
        required("scenario", "The scene.", Kind::Object(&SCENARIO)),
    ],
};

struct SimulateJob {
    input: InputSpec,
    cost: Cost,
}

/// Plans a simulation.
///
/// # Errors
/// All faults of the request.
pub fn plan(mut draft: Draft, _: Planner) -> Result<Planned, Vec<Fault>> {
    let cost = draft.check_scenario();
    // The scenario stands where other requests have their input.
    draft.finish(|input: InputSpec| SimulateJob { input, cost })
}

impl Job for SimulateJob {
    fn inputs(&self) -> &[InputRequest] {
        &[]
    }

    fn cost(&self) -> Cost {
        self.cost
    }

    fn check_known(&self, _: &[Option<Known>]) -> KnownInputs {
        KnownInputs::default()
    }

    fn run(
        &self,
        _: Inputs,
        settings: RunSettings,
        observer: &mut dyn Observer,
    ) -> Result<Outcome, RunError> {
        let mut data = JobData::default();
        data.gather(&self.input, None, &[], settings.seed, observer)?;
        let result = json!({"counts": counts(&data), "sensors": to_value(&data.sensors)?});
        let mut artifacts = Vec::new();
        if settings.wants_files {
            artifacts = data.write(&self.input, Vec::new(), None, observer)?;
        }
        Ok(data.into_outcome(result, artifacts))
    }
}

fn counts(data: &JobData) -> Value {
    match (&data.recording, &data.record) {
        (Some(recording), _) => {
            json!({
                "sensors": recording.sensors.len(),
                "scans": recording.scans.len(),
                "targets": recording.targets.len(),
                "detections": recording.detection_count(),
                "clutter": recording.detections().filter(|detection| detection.origin.is_none()).count(),
            })
        }
        (None, Some(record)) => json!({
            "sensors": 1,
            "scans": record.times_s.len(),
            "targets": data.truth.as_ref().map_or(0, |truth| truth.targets().len()),
            "detections": 0,
            "clutter": 0,
            "cells": record.levels_db.len(),
        }),
        (None, None) => Value::Null,
    }
}
