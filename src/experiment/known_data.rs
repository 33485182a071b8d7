//! What is known of a job's data before they are loaded, held against the request: what cannot work is a fault of the request, not
//! of the job that waits in a queue. The checks are those of the job, made on a small recording of the same kind.

use super::group::{self, Material};
use super::plan::{Estimate, JobKind, Plan, Source};
use super::{associate, auto_filter, scene, sensors};
use crate::filtering::AnyFilter;
use crate::math::rng::Seed;
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::facts::RecordingFacts;
use crate::model::fault::Fault;
use crate::model::scan::Recording;
use crate::model::sensor::SensorSettings;
use crate::tracking::Lifecycle;
use serde::Deserialize;
use serde_json::Value;

/// What is known of one input.
#[derive(Debug, Clone, PartialEq)]
pub struct Known {
    /// Of detections.
    pub recording: RecordingFacts,
    /// What is known of the sensors besides the data.
    pub sensors: Vec<SensorSettings>,
}

impl Known {
    /// Of data that are there; `None` of anything but detections.
    pub fn of(dataset: &Dataset, sensors: &[SensorSettings]) -> Option<Known> {
        let Dataset::Detections(recording) = dataset else {
            return None;
        };
        Some(Known {
            recording: RecordingFacts::from_recording(recording),
            sensors: sensors.to_vec(),
        })
    }
}

/// Holds what is `known` of the inputs, in the order of the plan, against the plan: puts the filter that suits them in the place of
/// `auto`, estimates what the job costs, and gives every fault.
pub fn check(plan: &mut Plan, known: &[Option<Known>]) -> Vec<Fault> {
    if let Some(campaign) = &plan.campaign {
        let runs = plan.spec["runs"].as_u64().unwrap_or(1) * campaign.cell_count() as u64;
        let estimate = estimate_of(known);
        plan.estimate.detections += estimate.detections;
        plan.estimate.cost_s += estimate.cost_s * runs as f64;
        return campaign.check_known(known);
    }
    let faults = faults_of(plan, known);
    if let Some((pointer, known)) = tracked_input(plan, known) {
        let wanted = wanted_sensors(plan, pointer);
        let sample = known.recording.only(wanted.as_deref()).sample();
        auto_filter::settle(&mut plan.spec, &sample);
    }
    let estimate = estimate_of(known);
    plan.estimate.detections += estimate.detections;
    plan.estimate.cost_s += estimate.cost_s;
    plan.estimate.bytes += estimate.bytes;
    faults
}

/// As of a simulation: 3 µs and 250 bytes a detection, from the file to the written artefacts.
fn estimate_of(known: &[Option<Known>]) -> Estimate {
    let detections: u64 = known
        .iter()
        .flatten()
        .flat_map(|known| &known.recording.sensors)
        .map(|sensor| sensor.detections)
        .sum();
    Estimate {
        detections,
        cost_s: detections as f64 * 3e-6,
        bytes: detections * 250,
    }
}

/// Every fault of a plan that is no campaign.
pub(super) fn faults_of(plan: &Plan, known: &[Option<Known>]) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (request, known) in plan.inputs.iter().zip(known) {
        if let (Some(known), DatasetKind::Detections) = (known, request.role) {
            faults.extend(unknown_sensors(
                &request.pointer,
                &request.source,
                &known.recording,
            ));
        }
    }
    if !faults.is_empty() {
        return faults;
    }
    if let Some((pointer, known)) = tracked_input(plan, known) {
        let wanted = wanted_sensors(plan, pointer);
        let sample = known.recording.only(wanted.as_deref()).sample();
        let uploaded: Vec<SensorSettings> = known
            .sensors
            .iter()
            .filter(|sensor| {
                wanted
                    .as_ref()
                    .is_none_or(|wanted| wanted.contains(&sensor.sensor_id))
            })
            .cloned()
            .collect();
        faults.extend(faults_of_input(plan, &sample, &uploaded));
        faults.extend(missing_truth(plan, &known.recording));
    }
    faults
}

/// The recording that the job works on.
fn tracked_input<'a>(plan: &Plan, known: &'a [Option<Known>]) -> Option<(&'static str, &'a Known)> {
    let place = plan.inputs.iter().position(|request| {
        request.pointer == "/input" && request.role == DatasetKind::Detections
    })?;
    known.get(place)?.as_ref().map(|known| ("/input", known))
}

fn wanted_sensors(plan: &Plan, pointer: &str) -> Option<Vec<String>> {
    let request = plan
        .inputs
        .iter()
        .find(|request| request.pointer == pointer)?;
    let (Source::Dataset { sensor_ids, .. } | Source::Job { sensor_ids, .. }) = &request.source;
    sensor_ids.clone()
}

fn unknown_sensors(pointer: &str, source: &Source, facts: &RecordingFacts) -> Vec<Fault> {
    let (Source::Dataset { sensor_ids, .. } | Source::Job { sensor_ids, .. }) = source;
    let names: Vec<&str> = facts
        .sensors
        .iter()
        .map(|sensor| sensor.settings.sensor_id.as_str())
        .collect();
    let wanted = sensor_ids
        .iter()
        .flatten()
        .enumerate()
        .filter(|(_, wanted)| !names.contains(&wanted.as_str()));
    let fault = |(index, wanted): (usize, &String)| {
        let detail = format!("the recording has no sensor '{wanted}'");
        Fault::new(
            format!("{pointer}/sensor_ids/{index}"),
            "unknown_value",
            detail,
        )
        .allowing(names.join(", "))
    };
    wanted.map(fault).collect()
}

fn faults_of_input(plan: &Plan, sample: &Recording, uploaded: &[SensorSettings]) -> Vec<Fault> {
    let mut spec = plan.spec.clone();
    auto_filter::settle(&mut spec, sample);
    let known = match sensors::known(sample, uploaded, &scene::requested_sensors(&spec)) {
        Ok(known) => known,
        Err(faults) => return faults,
    };
    if plan.kind == JobKind::Group {
        return group::unusable(&Material {
            recording: sample,
            settings: &known,
            truth: None,
        });
    }
    let Ok((filter, name)) = associate::filter_of(&spec) else {
        return Vec::new();
    };
    faults_of_tracking(&spec, sample, &known, (&filter, name))
}

fn faults_of_tracking(
    spec: &Value,
    sample: &Recording,
    known: &[SensorSettings],
    filter: (&AnyFilter, &str),
) -> Vec<Fault> {
    let mut faults = Vec::new();
    let lifecycle = Lifecycle::deserialize(&spec["tracker"]).ok();
    match sensors::resolve(sample, known, filter, &mut Vec::new()) {
        Ok(resolved) => {
            faults.extend(sensors::misplaced_densities(
                &scene::requested_sensors(spec),
                &resolved,
            ));
            faults.extend(
                lifecycle.and_then(|lifecycle| associate::unbounded_gate(&lifecycle, &resolved)),
            );
        }
        Err(found) => faults.extend(found),
    }
    if let Ok((associator, method)) = associate::associator_of(spec, Seed { seed: 0, run: 0 }) {
        faults.extend(associate::unmet_need(&method, associator.needs(), sample));
    }
    faults
}

/// Tracks cannot be judged without truth and without detections of known origins.
fn missing_truth(plan: &Plan, facts: &RecordingFacts) -> Option<Fault> {
    let has_truth = plan
        .inputs
        .iter()
        .any(|request| request.role == DatasetKind::Truth);
    if plan.kind != JobKind::Evaluate || facts.origins_known || has_truth {
        return None;
    }
    let detail = "the recording does not say which target its detections came from, so there is nothing to judge its tracks by";
    Some(
        Fault::new("/truth", "missing", detail)
            .allowing("truth, a column 'truth_id' in the recording, or a job of kind associate, which judges nothing"),
    )
}
