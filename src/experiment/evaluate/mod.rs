//! Judges tracks, those that are given or those that it makes first: by metrics, and by the temporal automaton.

mod automaton;
mod causes;
mod check;
mod compare;
mod fields;
mod head;
mod metric_files;
mod metrics;
mod profiles;
mod progress;
mod report;
mod requirements;
mod run;
mod spec;
mod within;

pub use causes::{Break, CauseCount};
pub use fields::EVALUATE;
pub use head::Compared;
pub use requirements::RequirementsReport;

use crate::evaluation::metrics::BuildMetric;
use crate::experiment::associate::check::{check_start, check_tracking};
use crate::experiment::associate::known::check_tracked;
use crate::experiment::input::known::check_inputs;
use crate::experiment::job::{
    InputRequest, Job, Known, KnownInputs, Outcome, Planner, RunError, Work,
};
use crate::experiment::observer::Observer;
use crate::experiment::request::draft::{Draft, Planned};
use crate::experiment::request::methods::{Choice, TrackingSpec};
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;
use spec::Spec;

#[derive(Clone)]
struct EvaluateJob {
    spec: Spec,
    tracking: Option<TrackingSpec>,
    /// The metrics that are taken instead where the data are boxes.
    metrics_of_boxes: Option<Vec<Choice<BuildMetric>>>,
}

/// Plans a job that judges tracks.
///
/// # Errors
/// All faults of the request.
pub fn plan(mut draft: Draft, _: Planner) -> Result<Planned, Vec<Fault>> {
    check::check_subject(&mut draft);
    let cost = check_tracking(&mut draft, true);
    let inputs = draft.inputs();
    check::check_symbols(&mut draft, &inputs);
    check::check_steps(&mut draft);
    check::check_within(&mut draft);
    check::check_requirements(&mut draft, &inputs);
    check_start(&mut draft, &inputs);
    profiles::fill_metrics(&mut draft, &inputs);
    let metrics_of_boxes = profiles::metrics_of_boxes(&draft);
    draft.finish(inputs, cost, |spec: Spec| EvaluateJob {
        tracking: spec.tracking.whole(),
        spec,
        metrics_of_boxes,
    })
}

impl Job for EvaluateJob {
    fn check_known(&self, requests: &[InputRequest], known: &[Option<Known>]) -> KnownInputs {
        let Some(tracking) = &self.tracking else {
            return check_inputs(requests, known);
        };
        let mut found = check_tracked(requests, known, tracking, &self.spec.sensors);
        if found.origins_known == Some(false) {
            found.faults.extend(missing_truth(requests));
        }
        found.into_known_inputs(tracking, |tracking| EvaluateJob {
            tracking: Some(tracking),
            ..self.clone()
        })
    }

    fn run(&self, work: Work, observer: &mut dyn Observer) -> Result<Outcome, RunError> {
        run::run(self, work, observer)
    }
}

/// Tracks cannot be judged without truth and without detections of known origins.
fn missing_truth(requests: &[InputRequest]) -> Option<Fault> {
    let is_truth = |request: &InputRequest| request.role == DatasetKind::Truth;
    if requests.iter().any(is_truth) {
        return None;
    }
    let detail = "the recording does not say which target its detections came from, so there is nothing to judge its tracks by";
    Some(
        Fault::new("/truth", "missing", detail)
            .allowing("truth, a column 'truth_id' in the recording, or a job of kind associate, which judges nothing"),
    )
}
