//! What is known of a recording before it is loaded, held against how it is to be tracked.

use super::auto_filter::settle;
use super::estimates::presume;
use super::track::{nothing_starts, unbounded_gate, unmet_need};
use crate::experiment::input::known::{KnownRecording, cost_of, unknown_sensors};
use crate::experiment::input::sensors;
use crate::experiment::job::{Cost, InputRequest, Job, Known, KnownInputs, Settled};
use crate::experiment::request::methods::{FilterChoice, NamedFilter, TrackingSpec};
use crate::model::fault::Fault;
use crate::model::scan::Recording;
use crate::model::sensor::SensorSettings;
use crate::tracking::Lifecycle;
use serde_json::Value;
use std::sync::Arc;

/// What was found of the recording that a job tracks.
#[derive(Default)]
pub struct KnownTracking {
    pub faults: Vec<Fault>,
    cost: Cost,
    /// The filter that suits it, where the request left it open.
    filter: Option<(Value, NamedFilter)>,
    /// Whether it says which target its detections came from; `None` where it could not be looked at.
    pub origins_known: Option<bool>,
}

/// Holds what is known of the recording against how it is tracked.
pub fn check_tracked(
    inputs: &[InputRequest],
    known: &[Option<Known>],
    tracking: &TrackingSpec,
    requested: &[SensorSettings],
) -> KnownTracking {
    let mut found = KnownTracking {
        faults: unknown_sensors(inputs, known),
        cost: cost_of(known),
        ..KnownTracking::default()
    };
    let Some(recording) = KnownRecording::find(inputs, known) else {
        return found;
    };
    let settled = settle(tracking, &recording.sample);
    if found.faults.is_empty() {
        found.origins_known = Some(recording.origins_known);
        found.faults = faults_of(&recording, &settled.filter, tracking, requested);
    }
    found.filter = settled.chosen.map(|filter| (filter, settled.filter));
    found
}

/// The same where each sensor is tracked by itself, without the others' help.
pub fn check_tracked_apart(
    inputs: &[InputRequest],
    known: &[Option<Known>],
    tracking: &TrackingSpec,
    requested: &[SensorSettings],
) -> KnownTracking {
    let mut found = check_tracked(inputs, known, tracking, requested);
    let Some(recording) = KnownRecording::find(inputs, known) else {
        return found;
    };
    if found.faults.is_empty() {
        let filter = settle(tracking, &recording.sample).filter;
        let KnownRecording {
            sample, uploaded, ..
        } = &recording;
        let known = sensors::merge_settings(sample, uploaded, requested).unwrap_or_default();
        found.faults = unusable_alone(sample, &known, &filter, &tracking.tracker.lifecycle);
    }
    found
}

/// The faults of sensors that are of use beside others only.
pub fn unusable_alone(
    sample: &Recording,
    known: &[SensorSettings],
    filter: &NamedFilter,
    lifecycle: &Lifecycle,
) -> Vec<Fault> {
    let mut faults = Vec::new();
    for settings in known {
        let own = sample.only_sensors(std::slice::from_ref(&settings.sensor_id));
        let known = std::slice::from_ref(settings);
        let resolved = own.and_then(|own| {
            let known = presume(&own, known, &filter.filter);
            sensors::resolve(&own, &known, filter, &mut Vec::new())
        });
        match resolved {
            Ok(resolved) => faults.extend(nothing_starts(lifecycle, &resolved)),
            Err(found) => faults.extend(found),
        }
    }
    faults
}

fn faults_of(
    recording: &KnownRecording,
    filter: &NamedFilter,
    tracking: &TrackingSpec,
    requested: &[SensorSettings],
) -> Vec<Fault> {
    let KnownRecording {
        sample, uploaded, ..
    } = recording;
    let known = match sensors::merge_settings(sample, uploaded, requested) {
        Ok(known) => known,
        Err(faults) => return faults,
    };
    let known = presume(sample, &known, &filter.filter);
    let mut faults = match sensors::resolve(sample, &known, filter, &mut Vec::new()) {
        Ok(resolved) => {
            let mut faults = sensors::misplaced_densities(requested, &resolved);
            faults.extend(unbounded_gate(&tracking.tracker.lifecycle, &resolved));
            faults.extend(nothing_starts(&tracking.tracker.lifecycle, &resolved));
            faults
        }
        Err(faults) => faults,
    };
    faults.extend(unmet_need(&tracking.associator, sample));
    faults
}

impl KnownTracking {
    /// `with_tracking` makes the job with a filter in the place of the open one of `tracking`.
    pub fn into_known_inputs<J: Job>(
        self,
        tracking: &TrackingSpec,
        with_tracking: impl FnOnce(TrackingSpec) -> J,
    ) -> KnownInputs {
        let settled = self.filter.map(|(filter, named)| Settled {
            filter,
            job: Arc::new(with_tracking(TrackingSpec {
                filter: FilterChoice::Named(named),
                ..tracking.clone()
            })),
        });
        KnownInputs {
            faults: self.faults,
            cost: self.cost,
            settled,
        }
    }
}
