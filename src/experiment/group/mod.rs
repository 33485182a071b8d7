//! Groups what several sensors report of one target at one instant.

mod attributes;
mod instants;
mod report;
mod run;
mod sensors;
mod spec;
mod tracks;

pub use report::GroupResult;
pub use spec::GROUP;

use crate::experiment::input::JobData;
use crate::experiment::input::known::{KnownRecording, check_inputs};
use crate::experiment::input::sensors::merge_settings;
use crate::experiment::job::{
    InputRequest, Job, Known, KnownInputs, Outcome, Planner, RunError, Work, to_value,
};
use crate::experiment::observer::Observer;
use crate::experiment::request::draft::{Draft, Planned};
use crate::math::rng::Seed;
use crate::model::fault::Fault;
use spec::Spec;

/// Of a grouper that groups nothing.
const SAMPLE: Seed = Seed { seed: 0, run: 0 };

struct GroupJob {
    spec: Spec,
}

/// Plans a job that groups reports.
///
/// # Errors
/// All faults of the request.
pub fn plan(mut draft: Draft, _: Planner) -> Result<Planned, Vec<Fault>> {
    draft.check_sources(false);
    let cost = draft.check_scenario();
    let inputs = draft.inputs();
    draft.finish(inputs, cost, |spec| GroupJob { spec })
}

impl Job for GroupJob {
    fn check_known(&self, requests: &[InputRequest], known: &[Option<Known>]) -> KnownInputs {
        let mut found = check_inputs(requests, known);
        let recording = KnownRecording::find(requests, known);
        if let Some(recording) = recording.filter(|_| found.faults.is_empty()) {
            found.faults = self.check_recording(&recording).err().unwrap_or_default();
        }
        found
    }

    fn run(&self, work: Work, observer: &mut dyn Observer) -> Result<Outcome, RunError> {
        let settings = work.settings;
        let Spec { input, sensors, .. } = &self.spec;
        let mut data = JobData::load(work.requests, work.inputs, sensors)?;
        data.gather(input, None, sensors, settings.seed, observer)?;
        data.warn_of_heights("grouped");
        let grouped = run::group(&self.spec, &data, settings.seed, observer)?;
        let left_out = grouped
            .history
            .as_ref()
            .map_or(0, |history| history.left_out);
        if left_out > 0 {
            data.warnings.push(format!(
                "grouping_trace.csv lacks the last {left_out} iterations"
            ));
        }
        let recording = data.recording()?;
        let result = to_value(&report::report(&grouped, recording))?;
        let mut artifacts = Vec::new();
        if settings.wants_files {
            let files = report::artifacts(&grouped, recording);
            artifacts = data.write(input, Vec::new(), None, observer)?;
            artifacts.extend(files);
        }
        Ok(Outcome {
            association_time: grouped.association_time,
            ..data.into_outcome(result, artifacts)
        })
    }
}

impl GroupJob {
    fn check_recording(&self, recording: &KnownRecording) -> Result<(), Vec<Fault>> {
        let KnownRecording {
            sample, uploaded, ..
        } = recording;
        let known = merge_settings(sample, uploaded, &self.spec.sensors)?;
        let sensors = sensors::usable_sensors(sample, &known)?;
        let grouper = self.spec.grouper.build(SAMPLE);
        run::attributes_of(&self.spec, &*grouper, sample, &sensors).map(drop)
    }
}
