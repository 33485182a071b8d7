//! Whole jobs, still pure: from a checked request and loaded datasets to a result, its artefacts and its warnings.
//!
//! [`plan`] parses a request and says which inputs it needs; the caller loads them; [`run`] does the work.
//! No clock, file, thread or network: time is measured and bytes are stored by whoever calls.
//!
//! One folder a kind of job, one line of [`JOBS`]. Below the kinds stand `request` (what is asked for, from JSON to types),
//! `input` (the data) and `files` (what is left behind).

mod associate;
pub mod campaign;
pub mod catalogue;
mod correlate;
mod evaluate;
mod files;
mod group;
mod input;
pub mod inspect;
mod job;
mod limits;
pub mod observer;
pub mod presets;
mod request;
mod result_numbers;
pub mod session;
mod simulate;
#[cfg(test)]
mod tests;

pub use associate::track::SMOOTHED_TRACKS;
pub use associate::{AssociateResult, Association, gates};
pub use campaign::CampaignResult;
pub use correlate::CorrelateResult;
pub use evaluate::{Break, CauseCount, Compared, RequirementsReport};
pub use files::text;
pub use group::GroupResult;
pub use input::DetectionResult;
pub use job::{
    ARTIFACT_TYPES, Artifact, AssociationTime, CellTime, Cost, Estimates, Input, InputRequest,
    Inputs, Job, JobKind, Known, Outcome, Plan, RunError, Source, run,
};
pub use limits::{Limit, LimitCheck, LimitsReport};
pub use request::job_shape;
pub use simulate::SimulateResult;

use crate::model::fault::Fault;
use crate::registry::Object;
use job::{KnownInputs, Planner};
use request::draft::{Draft, Planned};
use request::paths::put_field;
use serde_json::Value;

/// A kind of job: how its request is described, and how a job is made of one.
struct JobDefinition {
    kind: JobKind,
    request: &'static Object,
    plan: fn(Draft, Planner) -> Result<Planned, Vec<Fault>>,
}

/// Every kind of job.
static JOBS: [JobDefinition; 6] = [
    job_definition(JobKind::Simulate, &simulate::SIMULATE, simulate::plan),
    job_definition(JobKind::Associate, &associate::ASSOCIATE, associate::plan),
    job_definition(JobKind::Evaluate, &evaluate::EVALUATE, evaluate::plan),
    job_definition(JobKind::Group, &group::GROUP, group::plan),
    job_definition(JobKind::Correlate, &correlate::CORRELATE, correlate::plan),
    job_definition(JobKind::Campaign, &campaign::CAMPAIGN, campaign::plan),
];

const fn job_definition(
    kind: JobKind,
    request: &'static Object,
    plan: fn(Draft, Planner) -> Result<Planned, Vec<Fault>>,
) -> JobDefinition {
    JobDefinition {
        kind,
        request,
        plan,
    }
}

fn find(kind: JobKind) -> &'static JobDefinition {
    let found = JOBS.iter().find(|definition| definition.kind == kind);
    found.expect("every kind has a line in the table; a test asks for all")
}

/// The body of a request of this kind.
pub fn request_object(kind: JobKind) -> &'static Object {
    find(kind).request
}

/// Parses the body of a request.
///
/// # Errors
/// Every fault, each with its JSON pointer.
pub fn plan(kind: JobKind, body: &Value) -> Result<Plan, Vec<Fault>> {
    let planner = Planner {
        plan,
        request: request_object,
    };
    let definition = find(kind);
    let mut draft = Draft::new(body, definition.request)?;
    request::limits::check_limits(&mut draft, kind == JobKind::Campaign);
    let limits = draft.read("/limits").unwrap_or_default();
    let Planned {
        spec,
        seed,
        inputs,
        cost,
        job,
    } = (definition.plan)(draft, planner)?;
    Ok(Plan {
        kind,
        spec,
        seed,
        run: 0,
        wants_files: true,
        time_association: false,
        inputs,
        cost,
        limits,
        job,
    })
}

/// Holds what is `known` of the inputs, in the order of the plan, against the plan: puts the filter that suits them in the place of
/// `auto`, estimates what the job costs, and gives every fault.
pub fn check_known(plan: &mut Plan, known: &[Option<Known>]) -> Vec<Fault> {
    let KnownInputs {
        faults,
        cost,
        settled,
    } = plan.job.check_known(&plan.inputs, known);
    if let Some(settled) = settled {
        put_field(&mut plan.spec, "filter", settled.filter);
        plan.job = settled.job;
    }
    plan.cost += cost;
    faults
}
