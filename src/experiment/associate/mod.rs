//! Tracks the targets of a recording or a scenario.

mod apparent_speed;
mod auto_filter;
pub mod check;
mod clutter;
mod confirm;
mod dry_run;
mod estimates;
pub mod gates;
pub mod known;
mod maneuver_index;
mod no_tracks;
mod noise;
mod observability;
mod report;
mod reports;
mod scan_gaps;
mod slant;
mod spec;
mod speeds;
pub mod track;
mod truth_initiation;

pub use auto_filter::settle;
pub use report::{AssociateResult, Association, report};
pub use spec::ASSOCIATE;

use crate::experiment::input::JobData;
use crate::experiment::job::{
    InputRequest, Job, Known, KnownInputs, Outcome, Planner, RunError, Work, to_value,
};
use crate::experiment::observer::Observer;
use crate::experiment::request::draft::{Draft, Planned};
use crate::model::fault::Fault;
use spec::Spec;

#[derive(Clone)]
struct AssociateJob {
    spec: Spec,
}

/// Plans a job that tracks.
///
/// # Errors
/// All faults of the request.
pub fn plan(mut draft: Draft, _: Planner) -> Result<Planned, Vec<Fault>> {
    let cost = check::check_tracking(&mut draft, true);
    let inputs = draft.inputs();
    check::check_start(&mut draft, &inputs);
    draft.finish(inputs, cost, |spec| AssociateJob { spec })
}

impl Job for AssociateJob {
    fn check_known(&self, requests: &[InputRequest], known: &[Option<Known>]) -> KnownInputs {
        let Spec {
            sensors, tracking, ..
        } = &self.spec;
        let found = known::check_tracked(requests, known, tracking, sensors);
        found.into_known_inputs(tracking, |tracking| {
            let mut job = self.clone();
            job.spec.tracking = tracking;
            job
        })
    }

    fn run(&self, work: Work, observer: &mut dyn Observer) -> Result<Outcome, RunError> {
        let settings = work.settings;
        let Spec {
            input,
            detector,
            sensors,
            tracking,
        } = &self.spec;
        let mut data = JobData::load(work.requests, work.inputs, sensors)?;
        data.gather(input, detector.as_ref(), sensors, settings.seed, observer)?;
        let tracking = settle(tracking, data.recording()?);
        let mut tracked = track::track(&mut data, input, &tracking, sensors, settings, observer)?;
        let result = AssociateResult {
            limits: None,
            detection: data.detection.take(),
            association: report(&tracked, data.recording()?, &data.sensors),
        };
        let result = to_value(&result)?;
        let association_time = tracked.association_time;
        let mut artifacts = Vec::new();
        if settings.wants_files {
            let files = tracked.files(&mut data)?;
            artifacts = data.write(input, files, Some(tracked.tracks), observer)?;
        }
        Ok(Outcome {
            association_time,
            ..data.into_outcome(result, artifacts)
        })
    }
}
