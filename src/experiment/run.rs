//! Runs a plan on its loaded inputs.

use super::associate::{self, Tracked};
use super::judge::{Judgement, Subject};
use super::observer::{Observer, Step};
use super::plan::{JobKind, Plan, scenario_of};
use super::{artifacts, clutter, judge, profiles, sensors, tfa};
use crate::evaluation::EvaluationInput;
use crate::math::rng::Seed;
use crate::model::dataset::{Dataset, DatasetKind, DatasetSummary};
use crate::model::fault::Fault;
use crate::model::scan::Recording;
use crate::model::sensor::SensorSettings;
use crate::model::track::TrackSet;
use crate::model::truth::TruthSet;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// One loaded input.
#[derive(Debug, Clone)]
pub struct Input {
    pub dataset: Dataset,
    /// What is known of the sensors besides the data: from the upload or from the job that made it.
    pub sensors: Vec<SensorSettings>,
    /// SHA-256 of the bytes it was read from, in hex.
    pub sha256: String,
}

/// What was loaded for each [`super::plan::InputRequest`], in the same order; `None` for an optional one that is absent.
pub type Inputs = Vec<Option<Input>>;

/// A file that a job leaves behind.
#[derive(Debug, Clone)]
pub struct Artifact {
    /// `detections.csv`, `truth.csv`, `tracks.csv`, …
    pub name: &'static str,
    pub media_type: &'static str,
    pub bytes: Vec<u8>,
    /// Set when the artefact is a dataset that other jobs can use.
    pub dataset: Option<DatasetSummary>,
    /// What is known of the sensors behind it.
    pub sensors: Vec<SensorSettings>,
}

/// What a job found.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The report's `result`: the same bytes for the same spec, seed and inputs.
    pub result: Value,
    pub warnings: Vec<String>,
    pub artifacts: Vec<Artifact>,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RunError {
    /// The observer asked to stop.
    #[error("stopped")]
    Stopped,
    /// The data and the request do not fit together.
    #[error("{} fault(s) in the inputs", .0.len())]
    Faults(Vec<Fault>),
}

impl From<Vec<Fault>> for RunError {
    fn from(faults: Vec<Fault>) -> Self {
        RunError::Faults(faults)
    }
}

/// Does the work of `plan`.
///
/// # Errors
/// [`RunError::Stopped`] as soon as the observer says so; [`RunError::Faults`] when the inputs do not fit.
pub fn run(plan: &Plan, inputs: Inputs, observer: &mut dyn Observer) -> Result<Outcome, RunError> {
    let mut scene = Scene::gather(plan, inputs, observer)?;
    let mut parts = Vec::new();
    if plan.kind == JobKind::Simulate {
        parts.push(("counts", simulation_counts(&scene)));
        parts.push(("sensors", to_value(&scene.sensors)?));
    }
    let tracked = if plan.spec.get("associator").is_some() { Some(scene.track(plan, observer)?) } else { None };
    if let (Some(tracked), Some(recording)) = (&tracked, &scene.recording) {
        parts.push(("association", to_value(&associate::report(tracked, recording, &scene.sensors))?));
    }
    let mut files = Vec::new();
    if plan.kind == JobKind::Evaluate {
        let tracks = tracked.as_ref().map(|tracked| &tracked.tracks);
        if profiles::wants_automaton(&plan.spec) {
            let (report, of_automaton) = scene.judge(plan, tracks, observer)?;
            parts.push(("tfa", report));
            files = of_automaton;
        }
        if let Some(judgement) = scene.measure(plan, tracks, observer)? {
            parts.extend(judgement.parts);
            files.extend(judgement.artifacts);
            scene.warnings.extend(judgement.warnings);
        }
    }
    let mut artifacts = scene.artifacts(plan, tracked, observer)?;
    artifacts.append(&mut files);
    let result = parts.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
    Ok(Outcome { result: Value::Object(result), warnings: scene.warnings, artifacts })
}

/// Everything a job works on.
#[derive(Default)]
struct Scene {
    recording: Option<Recording>,
    truth: Option<TruthSet>,
    tracks: Option<TrackSet>,
    /// Truth and tracks of each sequence.
    sequences: Vec<(TruthSet, TrackSet)>,
    sensors: Vec<SensorSettings>,
    warnings: Vec<String>,
}

impl Scene {
    /// Simulates the scenario of the plan, or takes what was loaded.
    fn gather(plan: &Plan, inputs: Inputs, observer: &mut dyn Observer) -> Result<Scene, RunError> {
        let mut scene = Scene::default();
        let mut uploaded = Vec::new();
        for (request, input) in plan.inputs.iter().zip(inputs) {
            let Some(input) = input else { continue };
            if let Some(index) = request.sequence {
                scene.sequences.resize(scene.sequences.len().max(index + 1), Default::default());
                match (request.role, input.dataset) {
                    (DatasetKind::Truth, Dataset::Truth(truth)) => scene.sequences[index].0 = truth,
                    (DatasetKind::Tracks, Dataset::Tracks(tracks)) => scene.sequences[index].1 = tracks,
                    (wanted, found) => return Err(RunError::Faults(vec![wrong_kind(&request.pointer, wanted, found.kind())])),
                }
                continue;
            }
            match (request.role, input.dataset) {
                (DatasetKind::Detections, Dataset::Detections(recording)) => {
                    scene.recording = Some(recording);
                    uploaded = input.sensors;
                }
                (DatasetKind::Truth, Dataset::Truth(truth)) => scene.truth = Some(truth),
                (DatasetKind::Tracks, Dataset::Tracks(tracks)) => scene.tracks = Some(tracks),
                (wanted, found) => return Err(RunError::Faults(vec![wrong_kind(&request.pointer, wanted, found.kind())])),
            }
        }
        if let Some((scenario, _)) = scenario_of(&plan.spec) {
            let total = u64::from(scenario.scans);
            let mut progress = |done| observer.progress(Step::Simulate, done, total);
            let seed = Seed { seed: plan.seed, run: 0 };
            let simulated = crate::simulation::simulate(&scenario, seed, &mut progress)?.ok_or(RunError::Stopped)?;
            scene.recording = Some(simulated.recording);
            scene.truth.get_or_insert(simulated.truth);
        }
        if let Some(recording) = &scene.recording {
            let requested = plan.spec.get("sensors").and_then(|value| Vec::deserialize(value).ok()).unwrap_or_default();
            scene.sensors = sensors::known(recording, &uploaded, &requested)?;
        }
        Ok(scene)
    }

    fn track(&mut self, plan: &Plan, observer: &mut dyn Observer) -> Result<Tracked, RunError> {
        let recording = self.recording.as_ref().ok_or_else(|| missing("/input", "detections"))?;
        let (filter, filter_name) = associate::filter_of(&plan.spec)?;
        let sensors = sensors::resolve(recording, &self.sensors, (&filter, filter_name), &mut self.warnings)?;
        let tracked = associate::track(&plan.spec, recording, sensors.clone(), observer)?;
        self.warnings.extend(clutter::disagreements(recording, &sensors, &self.sensors, &tracked.tracks));
        Ok(tracked)
    }

    /// The part `tfa` of the report, and its files.
    fn judge(&mut self, plan: &Plan, tracked: Option<&TrackSet>, observer: &mut dyn Observer) -> Result<(Value, Vec<Artifact>), RunError> {
        step(observer, Step::Evaluate, 0)?;
        let tracks = tracked.or(self.tracks.as_ref()).ok_or_else(|| missing("/tracks", "tracks"))?;
        let input = EvaluationInput { recording: self.recording.as_ref(), truth: self.truth.as_ref(), tracks };
        let (report, files) = tfa::judge(&tfa::spec_of(&plan.spec, &input)?, input, &self.sensors, &mut self.warnings)?;
        step(observer, Step::Evaluate, 1)?;
        Ok((to_value(&report)?, files))
    }

    /// What the metrics say; `None` when there are none or no truth was found.
    fn measure(&mut self, plan: &Plan, tracked: Option<&TrackSet>, observer: &mut dyn Observer) -> Result<Option<Judgement>, RunError> {
        if plan.spec["metrics"].as_array().is_none_or(Vec::is_empty) {
            return Ok(None);
        }
        let names = plan.spec["sequences"].as_array().into_iter().flatten().map(|sequence| sequence["name"].as_str().unwrap_or_default());
        let mut subjects: Vec<Subject> = names
            .zip(&self.sequences)
            .map(|(name, (truth, tracks))| {
                let input = EvaluationInput { recording: None, truth: Some(truth), tracks };
                Subject { name, input, truth }
            })
            .collect();
        if subjects.is_empty() {
            let Some(truth) = &self.truth else {
                self.warnings.push("no truth was found for this job, so no metric was computed".to_owned());
                return Ok(None);
            };
            let tracks = tracked.or(self.tracks.as_ref()).ok_or_else(|| missing("/tracks", "tracks"))?;
            let input = EvaluationInput { recording: self.recording.as_ref(), truth: Some(truth), tracks };
            subjects.push(Subject { name: "", input, truth });
        }
        let of_bearings = |subject: &Subject| subject.truth.is_of_bearings() || subject.input.tracks.is_of_bearings();
        if let Some(index) = subjects.iter().position(of_bearings) {
            let detail = "directions (bearing_deg) are not compared in metres, so no metric was computed";
            if !self.sequences.is_empty() {
                return Err(RunError::Faults(vec![
                    Fault::new(format!("/sequences/{index}"), "unsupported", detail).allowing("places (x_m, y_m)"),
                ]));
            }
            self.warnings.push(detail.to_owned());
            return Ok(None);
        }
        judge::judge(&plan.spec, &subjects, observer).map(Some)
    }

    /// The datasets of the job, and its scan by scan record.
    fn artifacts(&mut self, plan: &Plan, tracked: Option<Tracked>, observer: &mut dyn Observer) -> Result<Vec<Artifact>, RunError> {
        step(observer, Step::Write, 0)?;
        let mut files = Vec::new();
        if let (Some(tracked), Some(recording)) = (&tracked, &self.recording) {
            files.push(artifacts::scans(recording, &tracked.scans).map_err(unwritten)?);
        }
        let tracks = tracked.map(|tracked| tracked.tracks).or(self.tracks.take());
        let datasets = [
            self.recording.take().map(Dataset::Detections),
            self.truth.take().map(Dataset::Truth),
            tracks.filter(|_| plan.kind != JobKind::Simulate).map(Dataset::Tracks),
        ];
        for dataset in datasets.into_iter().flatten() {
            files.push(artifacts::dataset(&dataset, &self.sensors).map_err(unwritten)?);
        }
        step(observer, Step::Write, 1)?;
        Ok(files)
    }
}

/// Asks whether to go on, before (0) and after (1) a step without parts.
fn step(observer: &mut dyn Observer, step: Step, done: u64) -> Result<(), RunError> {
    if observer.progress(step, done, 1).is_break() { Err(RunError::Stopped) } else { Ok(()) }
}

fn simulation_counts(scene: &Scene) -> Value {
    let Some(recording) = &scene.recording else { return Value::Null };
    let clutter = recording.detections.iter().filter(|detection| detection.origin.is_none()).count();
    json!({
        "sensors": recording.sensors.len(), "scans": recording.scans.len(), "targets": recording.targets.len(),
        "detections": recording.detections.len(), "clutter": clutter
    })
}

fn missing(pointer: &str, what: &str) -> RunError {
    RunError::Faults(vec![Fault::new(pointer, "missing", format!("no {what} were found for this job"))])
}

fn wrong_kind(pointer: &str, wanted: DatasetKind, found: DatasetKind) -> Fault {
    let detail = format!("expected a dataset of {}, found one of {}", wanted.name(), found.name());
    Fault::new(pointer, "wrong_type", detail).allowing(wanted.name())
}

fn to_value<T: Serialize>(part: &T) -> Result<Value, RunError> {
    serde_json::to_value(part).map_err(|error| RunError::Faults(vec![Fault::new("", "malformed", error.to_string())]))
}

fn unwritten(error: std::io::Error) -> RunError {
    RunError::Faults(vec![Fault::new("", "too_large", format!("an artefact could not be written: {error}"))])
}
