//! Progress and cancellation of a running experiment.

use crate::model::watch::Halt;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::time::Duration;

// In the order in which they may occur.
/// The step that a running job is in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = ProgressStep))]
#[serde(rename_all = "snake_case")]
pub enum Step {
    Load,
    /// The runs of a campaign.
    Run,
    Simulate,
    Detect,
    Associate,
    Correlate,
    Evaluate,
    Write,
}

impl Step {
    pub fn name(self) -> &'static str {
        match self {
            Step::Load => "load",
            Step::Run => "run",
            Step::Simulate => "simulate",
            Step::Detect => "detect",
            Step::Associate => "associate",
            Step::Correlate => "correlate",
            Step::Evaluate => "evaluate",
            Step::Write => "write",
        }
    }
}

/// Told of progress between small pieces of work; its answer decides whether the work goes on.
pub trait Observer {
    /// `done` of `total` pieces (scans, targets) of `step` are finished. `Break` stops the job.
    fn progress(&mut self, step: Step, done: u64, total: u64) -> ControlFlow<()>;

    /// A clock, for what is to be timed by itself; its zero is any time. An observer without one times nothing.
    fn now(&self) -> Option<Duration> {
        None
    }
}

/// Tells the observer of progress.
///
/// # Errors
/// [`Halt::Stopped`] when it asks to stop.
pub fn report_progress(
    observer: &mut dyn Observer,
    step: Step,
    done: u64,
    total: u64,
) -> Result<(), Halt> {
    if observer.progress(step, done, total).is_break() {
        Err(Halt::Stopped)
    } else {
        Ok(())
    }
}

/// Listens to nothing and never stops.
pub struct Silent;

impl Observer for Silent {
    fn progress(&mut self, _: Step, _: u64, _: u64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
