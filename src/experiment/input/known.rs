//! What is known of a job's data before they are loaded, held against the request: what cannot work is a fault of the request, not
//! of the job that waits in a queue. The checks are those of the job, made on a small recording of the same kind.

use crate::experiment::job::{Cost, InputRequest, Known, KnownInputs, Source};
use crate::model::dataset::DatasetKind;
use crate::model::facts::RecordingFacts;
use crate::model::fault::Fault;
use crate::model::scan::Recording;
use crate::model::sensor::SensorSettings;

/// As of a simulation: 3 µs and 250 bytes a detection, from the file to the written artefacts.
pub fn cost_of(known: &[Option<Known>]) -> Cost {
    let detections: u64 = known
        .iter()
        .flatten()
        .flat_map(|known| &known.recording.sensors)
        .map(|sensor| sensor.detections)
        .sum();
    Cost {
        detections,
        cost_s: detections as f64 * 3e-6,
        bytes: detections * 250,
    }
}

/// A fault for each sensor that is wanted of an input that does not have it.
pub fn unknown_sensors(inputs: &[InputRequest], known: &[Option<Known>]) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (request, known) in inputs.iter().zip(known) {
        if let (Some(known), DatasetKind::Detections) = (known, request.role) {
            let InputRequest {
                pointer, source, ..
            } = request;
            faults.extend(unknown_sensors_of(pointer, source, &known.recording));
        }
    }
    faults
}

fn unknown_sensors_of(pointer: &str, source: &Source, facts: &RecordingFacts) -> Vec<Fault> {
    let names: Vec<&str> = facts
        .sensors
        .iter()
        .map(|sensor| sensor.settings.sensor_id.as_str())
        .collect();
    let mut faults = Vec::new();
    for (index, wanted) in source.sensor_ids().unwrap_or_default().iter().enumerate() {
        if !names.contains(&wanted.as_str()) {
            let pointer = format!("{pointer}/sensor_ids/{index}");
            let detail = format!("the recording has no sensor '{wanted}'");
            faults.push(Fault::new(pointer, "unknown_value", detail).allowing(names.join(", ")));
        }
    }
    faults
}

/// The recording that a job works on, as far as it is known.
pub struct KnownRecording {
    /// One scan of each wanted sensor.
    pub sample: Recording,
    /// What came with it of the wanted sensors.
    pub uploaded: Vec<SensorSettings>,
    pub origins_known: bool,
}

impl KnownRecording {
    /// What is known of the detections at `/input`.
    pub fn find(inputs: &[InputRequest], known: &[Option<Known>]) -> Option<KnownRecording> {
        let place = inputs.iter().position(|request| {
            request.pointer == "/input" && request.role == DatasetKind::Detections
        })?;
        let known = known.get(place)?.as_ref()?;
        let wanted = inputs[place].source.sensor_ids();
        let is_wanted = |sensor: &&SensorSettings| {
            wanted.is_none_or(|wanted| wanted.contains(&sensor.sensor_id))
        };
        Some(KnownRecording {
            sample: known.recording.only(wanted).sample(),
            uploaded: known.sensors.iter().filter(is_wanted).cloned().collect(),
            origins_known: known.recording.origins_known,
        })
    }
}

/// For a job that tracks nothing: sensors that an input lacks, and what the data add to the cost.
pub fn check_inputs(inputs: &[InputRequest], known: &[Option<Known>]) -> KnownInputs {
    KnownInputs {
        faults: unknown_sensors(inputs, known),
        cost: cost_of(known),
        settled: None,
    }
}
