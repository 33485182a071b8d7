//! Where the data of a request come from: what of its scenario, its detector and its sensors does not go together, and the
//! inputs to load.

use super::draft::Draft;
use super::fields;
use super::preset_source;
use crate::detection::DETECTOR;
use crate::experiment::job::{Cost, InputRequest, Source};
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;
use crate::model::scenario::Scenario;
use crate::registry::{self, Kind, placed};
use crate::simulation::{self, LocalTracks};
use serde::Deserialize;
use serde_json::{Value, json};

static DETECTOR_KIND: Kind = Kind::Object(&DETECTOR);

/// The field `input`: what is simulated of it; data that are loaded stand in the inputs of the job.
#[derive(Debug, Clone, Default, Deserialize)]
pub struct InputSpec {
    pub scenario: Option<Scenario>,
    /// Tracks that are drawn.
    pub tracks: Option<LocalTracks>,
}

impl Draft {
    /// Writes out the preset and checks the detector and the sensors.
    pub fn check_sources(&mut self, takes_detector: bool) {
        preset_source::write_out(&mut self.spec, &mut self.faults);
        self.check_detector(takes_detector);
        self.check_sensors();
    }

    /// Fills in the detector where the scenario has a record, and refuses one where there can be none, or a job that needs none.
    fn check_detector(&mut self, takes_detector: bool) {
        let has_record = self.at("/input/scenario/record").is_some();
        if has_record && !takes_detector {
            let detail = "a bearing-time record gives no detections without a detector, which this job does not have";
            self.add([Fault::new("/input/scenario/record", "unsupported", detail)
                .allowing("associate, evaluate")]);
        } else if has_record && !self.has("detector") {
            let detector =
                registry::check_field(&json!({}), &DETECTOR_KIND, "/detector", &mut self.faults);
            self.put("detector", detector);
        } else if !has_record && self.has("detector") && self.at("/input/scenario").is_some() {
            let detail = "the scenario has no bearing-time record to find detections in";
            self.add([Fault::new("/detector", "conflict", detail)
                .allowing("a scenario with 'record', or a record as input")]);
        } else if self.has("detector") && !self.has("input") {
            self.add([
                Fault::new("/detector", "conflict", "'detector' needs 'input'")
                    .allowing("with input"),
            ]);
        }
    }

    /// Settings of one sensor stand in one place.
    fn check_sensors(&mut self) {
        let sensors = self.spec.get("sensors").and_then(Value::as_array);
        let names: Vec<Option<&str>> = sensors
            .into_iter()
            .flatten()
            .map(|sensor| sensor["sensor_id"].as_str())
            .collect();
        for (index, name) in names.iter().enumerate() {
            if let Some(name) = name.filter(|_| names[..index].contains(name)) {
                let fault = Fault::new(
                    format!("/sensors/{index}/sensor_id"),
                    "duplicate",
                    format!("sensor '{name}' is set twice"),
                );
                self.faults.push(fault.allowing("each sensor_id once"));
            }
        }
    }

    /// The scenario of the request, and where it stands.
    pub fn scenario(&self) -> Option<(Scenario, &'static str)> {
        let pointer = ["/scenario", "/input/scenario"]
            .into_iter()
            .find(|pointer| self.at(pointer).is_some())?;
        Some((self.read(pointer)?, pointer))
    }

    /// Checks the scenario, where there is one, and tells what its simulation costs.
    pub fn check_scenario(&mut self) -> Cost {
        let Some((scenario, pointer)) = self.scenario() else {
            return Cost::default();
        };
        if let Err(found) = simulation::check(&scenario) {
            self.add(placed(pointer, found));
        }
        let (detections, cost) = cost_of(&scenario);
        if detections > fields::MAX_DETECTIONS {
            let detail = format!("the scenario makes about {detections:.0} detections");
            self.add([Fault::new(pointer, "too_large", detail)
                .allowing(format!("at most {} detections", fields::MAX_DETECTIONS))]);
        }
        cost
    }

    /// Whether there will be truth, unless a job that may know it does not.
    pub fn knows_truth(&self, inputs: &[InputRequest]) -> bool {
        self.at("/input/scenario").is_some()
            || inputs.iter().any(|input| input.role == DatasetKind::Truth)
    }

    /// The inputs to load. A job brings along what else it knows: the truth with its detections, both with its tracks.
    pub fn inputs(&self) -> Vec<InputRequest> {
        let mut inputs = self.given_inputs();
        let is_record = inputs
            .iter()
            .any(|input| input.role == DatasetKind::BearingTime);
        for pointer in ["/input", "/tracks"] {
            if let Some(source @ Source::Job { .. }) = self.read(pointer) {
                for role in [DatasetKind::Detections, DatasetKind::Truth] {
                    // Detections are found in a record.
                    let is_found = is_record && role == DatasetKind::Detections;
                    if !is_found && !inputs.iter().any(|input| input.role == role) {
                        inputs.push(request(pointer, role, source.clone(), true));
                    }
                }
            }
        }
        inputs.extend(self.truth_of_sets(&inputs));
        inputs.extend(self.sequence_inputs());
        inputs
    }

    /// Those that the request names itself.
    fn given_inputs(&self) -> Vec<InputRequest> {
        let of_input = if self.has("detector") {
            DatasetKind::BearingTime
        } else {
            DatasetKind::Detections
        };
        let mut inputs = Vec::new();
        for (pointer, role) in [
            ("/input", of_input),
            ("/tracks", DatasetKind::Tracks),
            ("/detections", DatasetKind::Detections),
            ("/truth", DatasetKind::Truth),
        ] {
            inputs.extend(
                self.read(pointer)
                    .map(|source| request(pointer, role, source, false)),
            );
        }
        inputs.extend(
            self.sets()
                .into_iter()
                .map(|(pointer, source)| request(&pointer, DatasetKind::Tracks, source, false)),
        );
        inputs
    }

    fn sets(&self) -> Vec<(String, Source)> {
        (0..self.length_of("sets").unwrap_or(0))
            .map(|index| format!("/sets/{index}"))
            .filter_map(|pointer| self.read(&pointer).map(|source| (pointer, source)))
            .collect()
    }

    /// One job among the sets may know the truth behind all of them.
    fn truth_of_sets(&self, inputs: &[InputRequest]) -> Option<InputRequest> {
        if inputs.iter().any(|input| input.role == DatasetKind::Truth) {
            return None;
        }
        let (pointer, source) = self
            .sets()
            .into_iter()
            .find(|(_, source)| matches!(source, Source::Job { .. }))?;
        Some(request(&pointer, DatasetKind::Truth, source, true))
    }

    fn sequence_inputs(&self) -> Vec<InputRequest> {
        let mut inputs = Vec::new();
        for index in 0..self.length_of("sequences").unwrap_or(0) {
            for (name, role) in [
                ("truth", DatasetKind::Truth),
                ("tracks", DatasetKind::Tracks),
            ] {
                let pointer = format!("/sequences/{index}/{name}");
                inputs.extend(self.read(&pointer).map(|source| InputRequest {
                    sequence: Some(index),
                    ..request(&pointer, role, source, false)
                }));
            }
        }
        inputs
    }
}

fn request(pointer: &str, role: DatasetKind, source: Source, optional: bool) -> InputRequest {
    InputRequest {
        pointer: pointer.to_owned(),
        sequence: None,
        role,
        source,
        optional,
    }
}

/// The detections that a scenario makes, and what they cost.
fn cost_of(scenario: &Scenario) -> (f64, Cost) {
    let targets = scenario.targets.count() as f64;
    let detections: f64 = scenario
        .sensors
        .iter()
        .map(|sensor| {
            let in_a_scan = targets * sensor.p_d + sensor.mean_clutter();
            in_a_scan * sensor.scan_count(scenario) as f64
        })
        .sum();
    let cells = scenario.record.as_ref().map_or(0.0, |record| {
        simulation::row_count(scenario, record) as f64 * 360.0 / record.bearing_step_deg
    });
    // Measured: about 3 µs and 250 bytes a detection, from simulation to the written artefacts; 0.2 µs and 15 bytes a cell.
    let cost = Cost {
        detections: detections as u64,
        cost_s: detections * 3e-6 + cells * 2e-7,
        bytes: (detections * 250.0 + cells * 15.0) as u64,
    };
    (detections, cost)
}
