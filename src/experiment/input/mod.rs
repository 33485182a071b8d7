//! The data of a job, and the steps that it takes on them.

pub mod detect;
pub mod extent;
pub mod known;
pub mod sensors;

use crate::correlation::alignment::Node;
use crate::evaluation::EvaluationInput;
use crate::experiment::associate::speeds::Taken;
use crate::experiment::associate::{self, Tracked};
use crate::experiment::associate::{auto_filter, clutter, no_tracks, scan_gaps, speeds};
use crate::experiment::correlate::{self, Material, Nodes};
use crate::experiment::evaluate::metrics::{self as judge, Content, Judgement, Subject};
use crate::experiment::evaluate::{automaton as tfa, profiles};
use crate::experiment::files::{datasets as artifacts, record_picture};
use crate::experiment::group;
use crate::experiment::group::report as group_report;
use crate::experiment::observer::{Observer, Step};
use crate::experiment::plan::{JobKind, Plan, scenario_of};
use crate::experiment::run::{Artifact, Decided, Inputs, RunError, to_value};
use crate::math::rng::Seed;
use crate::model::bearing_time::BearingTimeRecord;
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use crate::model::scan::Recording;
use crate::model::scenario::Scenario;
use crate::model::sensor::SensorSettings;
use crate::model::track::TrackSet;
use crate::model::truth::TruthSet;
use crate::simulation;
use detect::DetectionReport;
use serde::Deserialize;
use serde_json::{Map, Value, json};
use std::borrow::Cow;

/// The parts of a result, its files, and what deciding took.
type Correlation = (Map<String, Value>, Vec<Artifact>, Option<Decided>);

const WITHOUT_TRUTH: &str = "there is no truth with positions, so the automaton judged by the origins of the detections, and no metric \
                             (GOSPA, OSPA, SIAP, CLEAR, …) was computed; 'truth' gives it";

const OF_BEARINGS: &str = "directions (bearing_deg) are not compared in metres";

/// Everything a job works on.
#[derive(Default)]
pub struct Scene {
    pub recording: Option<Recording>,
    /// What the detections are found in.
    record: Option<BearingTimeRecord>,
    truth: Option<TruthSet>,
    tracks: Option<TrackSet>,
    /// The tracks of each sensor, of a job that puts them together.
    sets: Vec<TrackSet>,
    /// Of each sequence, or the boxes of a job without sequences.
    sides: Vec<Sides>,
    pub sensors: Vec<SensorSettings>,
    pub warnings: Vec<String>,
    /// The part `detection` of the report.
    pub detection: Option<DetectionReport>,
    /// The filter that was chosen by what the sensors report.
    chosen_filter: Option<Value>,
}

/// Truth and tracks to compare.
#[derive(Default)]
struct Sides {
    truth: Option<Dataset>,
    tracks: Option<Dataset>,
}

impl Scene {
    /// Simulates the scenario of the plan, or takes what was loaded.
    pub fn gather(
        plan: &Plan,
        inputs: Inputs,
        observer: &mut dyn Observer,
    ) -> Result<Scene, RunError> {
        let mut scene = Scene::default();
        let mut uploaded = Vec::new();
        for (request, input) in plan.inputs.iter().zip(inputs) {
            let Some(input) = input else { continue };
            let is_of_boxes = matches!(
                input.dataset,
                Dataset::TruthBoxes(_) | Dataset::TrackBoxes(_)
            );
            if input.dataset.kind() != request.role {
                return Err(RunError::Faults(vec![wrong_kind(
                    &request.pointer,
                    request.role,
                    input.dataset.kind(),
                )]));
            }
            match (request.sequence.or(is_of_boxes.then_some(0)), input.dataset) {
                (Some(index), dataset) => scene.keep_side(index, dataset),
                (None, Dataset::Detections(recording)) => {
                    scene.recording = Some(recording);
                    uploaded = input.sensors;
                }
                (None, Dataset::Truth(truth)) => scene.truth = Some(truth),
                (None, Dataset::Tracks(tracks)) if request.pointer.starts_with("/sets/") => {
                    scene.sets.push(tracks)
                }
                (None, Dataset::Tracks(tracks)) => scene.tracks = Some(tracks),
                // Boxes always have a side.
                (None, Dataset::TruthBoxes(_) | Dataset::TrackBoxes(_)) => {}
                (None, Dataset::BearingTime(record)) => {
                    scene.sensors = vec![detect::sensor_of(
                        &input.sensors,
                        &requested_sensors(&plan.spec),
                    )];
                    scene.record = Some(record);
                    uploaded = input.sensors;
                }
            }
        }
        if let Some((scenario, _)) = scenario_of(&plan.spec) {
            scene.simulate(&scenario, plan.stream(), observer)?;
        }
        if plan.spec.get("detector").is_some() {
            scene.detect(&plan.spec, observer)?;
        }
        if let Some(recording) = &scene.recording {
            scene.sensors = sensors::known(recording, &uploaded, &requested_sensors(&plan.spec))?;
        }
        if let Some(record) = &scene.record {
            let found = scene.recording.take();
            let complete = |recording| {
                detect::complete(&mut scene.sensors, recording, record, &mut scene.warnings)
            };
            scene.recording = found.map(complete).transpose()?;
        }
        Ok(scene)
    }

    /// The plan with what its request left open until the data are there.
    pub fn settled<'a>(&mut self, plan: &'a Plan) -> Cow<'a, Plan> {
        let Some(recording) = self
            .recording
            .as_ref()
            .filter(|_| auto_filter::is_open(&plan.spec))
        else {
            return Cow::Borrowed(plan);
        };
        let mut settled = plan.clone();
        auto_filter::settle(&mut settled.spec, recording);
        self.chosen_filter = settled.spec.get("filter").cloned();
        if plan.kind == JobKind::Correlate {
            // Its result has no part for how the tracks of each sensor were made.
            self.warnings.push(format!(
                "the filter of the tracks is '{}'",
                settled.spec["filter"]["method"]
                    .as_str()
                    .unwrap_or_default()
            ));
        }
        Cow::Owned(settled)
    }

    fn simulate(
        &mut self,
        scenario: &Scenario,
        seed: Seed,
        observer: &mut dyn Observer,
    ) -> Result<(), RunError> {
        let total = scenario
            .record
            .as_ref()
            .map_or(u64::from(scenario.scans), |record| {
                simulation::row_count(scenario, record)
            });
        let mut progress = |done| observer.progress(Step::Simulate, done, total);
        let truth = if scenario.record.is_some() {
            let simulated = simulation::simulate_record(scenario, seed, &mut progress)?
                .ok_or(RunError::Stopped)?;
            self.record = Some(simulated.record);
            self.sensors = vec![simulated.sensor];
            simulated.truth
        } else {
            let simulated =
                simulation::simulate(scenario, seed, &mut progress)?.ok_or(RunError::Stopped)?;
            self.recording = Some(simulated.recording);
            simulated.truth
        };
        self.truth.get_or_insert(truth);
        Ok(())
    }

    fn detect(&mut self, spec: &Value, observer: &mut dyn Observer) -> Result<(), RunError> {
        let (Some(record), Some(sensor)) = (&self.record, self.sensors.first()) else {
            return Err(missing("/input", "bearing-time record"));
        };
        let (recording, report) =
            detect::detect(spec, record, sensor, self.truth.as_ref(), observer)?;
        (self.recording, self.detection) = (Some(recording), Some(report));
        Ok(())
    }

    /// What a simulation made.
    pub fn counts(&self) -> Value {
        let targets = self.truth.as_ref().map_or(0, |truth| truth.targets().len());
        match (&self.recording, &self.record) {
            (Some(recording), _) => {
                let clutter = recording
                    .detections
                    .iter()
                    .filter(|detection| detection.origin.is_none())
                    .count();
                json!({
                    "sensors": recording.sensors.len(), "scans": recording.scans.len(), "targets": recording.targets.len(),
                    "detections": recording.detections.len(), "clutter": clutter
                })
            }
            (None, Some(record)) => json!({
                "sensors": 1, "scans": record.times_s.len(), "targets": targets, "detections": 0, "clutter": 0,
                "cells": record.levels_db.len()
            }),
            (None, None) => Value::Null,
        }
    }

    pub fn track(&mut self, plan: &Plan, observer: &mut dyn Observer) -> Result<Tracked, RunError> {
        let recording = self
            .recording
            .as_ref()
            .ok_or_else(|| missing("/input", "detections"))?;
        let (filter, filter_name) = associate::filter_of(&plan.spec)?;
        let sensors = sensors::resolve(
            recording,
            &self.sensors,
            (&filter, filter_name),
            &mut self.warnings,
        )?;
        let misplaced = sensors::misplaced_densities(&requested_sensors(&plan.spec), &sensors);
        if !misplaced.is_empty() {
            return Err(misplaced.into());
        }
        let mut lifecycle = associate::lifecycle_of(&plan.spec)?;
        let scene = (recording, self.sensors.as_slice(), sensors.as_slice());
        let taken = speeds::complete(
            &mut lifecycle,
            &plan.spec,
            scene,
            &filter,
            &mut self.warnings,
        );
        let mut tracked = associate::track(
            plan,
            (recording, self.truth.as_ref()),
            (sensors.clone(), lifecycle),
            observer,
        )?;
        tracked.taken = Taken {
            filter: self.chosen_filter.clone(),
            ..taken
        };
        self.warnings.extend(scan_gaps::warning(recording));
        self.warnings.extend(tracked.doubt_of_noise(&plan.spec));
        self.warnings
            .extend(no_tracks::warning(&tracked, scene, (&lifecycle, &filter)));
        // Clutter that lies near targets only is not spread over what the sensor watches: a comparison would mislead.
        let is_local = scenario_of(&plan.spec).is_some_and(|(scenario, _)| {
            scenario
                .sensors
                .iter()
                .any(|sensor| sensor.clutter_within_deg.is_some())
        });
        if !is_local {
            self.warnings.extend(clutter::disagreements(
                recording,
                &sensors,
                &self.sensors,
                &tracked.tracks,
            ));
        }
        Ok(tracked)
    }

    /// The part `grouping` of the report, and its files.
    pub fn group(
        &mut self,
        plan: &Plan,
        observer: &mut dyn Observer,
    ) -> Result<(Value, Vec<Artifact>, Option<Decided>), RunError> {
        let recording = self
            .recording
            .as_ref()
            .ok_or_else(|| missing("/input", "detections"))?;
        let material = group::Material {
            recording,
            settings: &self.sensors,
            truth: self.truth.as_ref(),
        };
        let grouped = group::group(&plan.spec, plan.stream(), &material, observer)?;
        if let Some(left_out) = grouped
            .history
            .as_ref()
            .map(|history| history.left_out)
            .filter(|count| *count > 0)
        {
            self.warnings.push(format!(
                "grouping_trace.csv lacks the last {left_out} iterations"
            ));
        }
        let files = if plan.wants_files {
            group_report::artifacts(&grouped, recording)
        } else {
            Vec::new()
        };
        Ok((
            to_value(&group_report::report(&grouped, recording))?,
            files,
            grouped.decided,
        ))
    }

    /// The result of a job that puts tracks together, and its files.
    pub fn correlate(
        &mut self,
        plan: &Plan,
        observer: &mut dyn Observer,
    ) -> Result<Correlation, RunError> {
        let nodes = match correlate::drawn(plan)? {
            Some((nodes, truth)) => {
                self.truth = Some(truth);
                nodes
            }
            None if plan.spec.get("sets").is_some() => {
                correlate::of_sets(std::mem::take(&mut self.sets))
            }
            None => self.track_by_sensor(plan, observer)?,
        };
        let sensors = if self.sensors.is_empty() {
            requested_sensors(&plan.spec)
        } else {
            self.sensors.clone()
        };
        let material = Material {
            nodes,
            truth: self.truth.as_ref(),
            sensors: &sensors,
        };
        let correlated = correlate::correlate(plan, material, &mut self.warnings, observer)?;
        let lines = correlate::tuple_lines(&correlated);
        let files = if plan.wants_files {
            correlate::artifacts(&correlated, &lines)?
        } else {
            Vec::new()
        };
        match to_value(&correlate::report(&correlated, lines))? {
            Value::Object(report) => Ok((report, files, correlated.decided)),
            _ => Err(RunError::Faults(vec![Fault::new(
                "",
                "malformed",
                "the report is no object",
            )])),
        }
    }

    /// The tracks of each sensor by itself.
    fn track_by_sensor(
        &mut self,
        plan: &Plan,
        observer: &mut dyn Observer,
    ) -> Result<Nodes, RunError> {
        let all = self
            .recording
            .take()
            .ok_or_else(|| missing("/input", "detections"))?;
        let settings = self.sensors.clone();
        let mut nodes = Nodes {
            truth_ids: all.targets.clone(),
            ..Nodes::default()
        };
        let mut origins = Vec::new();
        for settings in &settings {
            self.recording = Some(all.only_sensors(std::slice::from_ref(&settings.sensor_id))?);
            self.sensors = vec![settings.clone()];
            let tracked = self.track(plan, observer)?;
            if let Some(recording) = &self.recording {
                origins.extend(correlate::by_detections(&tracked.tracks, recording));
            }
            nodes.nodes.push(Node {
                sensor_id: settings.sensor_id.clone(),
                tracks: tracked.tracks,
            });
        }
        nodes.origins = all.origins_known.then_some(origins);
        (self.recording, self.sensors) = (Some(all), settings);
        Ok(nodes)
    }

    /// The part `tfa` of the report, and its files.
    pub fn judge(
        &mut self,
        plan: &Plan,
        tracked: Option<&TrackSet>,
        observer: &mut dyn Observer,
    ) -> Result<(Value, Vec<Artifact>), RunError> {
        step(observer, Step::Evaluate, 0)?;
        let tracks = tracked
            .or(self.tracks.as_ref())
            .ok_or_else(|| missing("/tracks", "tracks"))?;
        let input = EvaluationInput {
            recording: self.recording.as_ref(),
            truth: self.truth.as_ref(),
            tracks,
        };
        let spec = tfa::spec_of(&plan.spec, &input)?;
        let evaluation = tfa::evaluation(
            &spec,
            judge::time_tolerance_s(&plan.spec),
            input,
            &self.sensors,
        )?;
        let mut warnings = evaluation.strings.warnings.clone();
        let files = if plan.wants_files {
            tfa::artifacts(&evaluation, &mut warnings)?
        } else {
            Vec::new()
        };
        step(observer, Step::Evaluate, 1)?;
        let report = to_value(&evaluation.report())?;
        self.warn(warnings);
        Ok((report, files))
    }

    /// Adds warnings that were not given yet: metrics and automaton read the same times, and say so in the same words.
    pub fn warn(&mut self, warnings: impl IntoIterator<Item = String>) {
        for warning in warnings {
            if !self.warnings.contains(&warning) {
                self.warnings.push(warning);
            }
        }
    }

    /// Whether there is a string to read: boxes have none.
    pub fn wants_automaton(&self, spec: &Value) -> Result<bool, RunError> {
        if self.sides.is_empty() || spec.get("sequences").is_some() {
            return Ok(profiles::wants_automaton(spec));
        }
        if spec.get("tfa").is_some() {
            let detail = "the automaton reads tracks in the plane, not boxes";
            return Err(RunError::Faults(vec![
                Fault::new("/tfa", "unsupported", detail).allowing("metrics hota, clear, identity"),
            ]));
        }
        if spec["profile"] == "tfa" && spec["metrics"].as_array().is_none_or(Vec::is_empty) {
            let detail =
                "the automaton reads tracks in the plane, not boxes, so nothing would be judged";
            return Err(RunError::Faults(vec![
                Fault::new("/profile", "unsupported", detail).allowing("vision"),
            ]));
        }
        Ok(false)
    }

    /// What the metrics say; `None` when there are none or no truth was found.
    pub fn measure(
        &mut self,
        plan: &Plan,
        tracked: Option<&TrackSet>,
        observer: &mut dyn Observer,
    ) -> Result<Option<Judgement>, RunError> {
        if plan.spec["metrics"].as_array().is_none_or(Vec::is_empty) {
            if self.truth.is_none() && self.sides.is_empty() && plan.spec["profile"] != "tfa" {
                self.warnings.push(WITHOUT_TRUTH.to_owned());
            }
            return Ok(None);
        }
        let names: Vec<&str> = plan.spec["sequences"]
            .as_array()
            .into_iter()
            .flatten()
            .map(|sequence| sequence["name"].as_str().unwrap_or_default())
            .collect();
        let mut spec = Cow::Borrowed(&plan.spec);
        let mut subjects = Vec::with_capacity(self.sides.len());
        for (index, sides) in self.sides.iter().enumerate() {
            subjects.push(subject_of(names.get(index).copied(), index, sides)?);
        }
        let is_of_boxes = subjects
            .iter()
            .any(|subject| matches!(subject.content, Content::Boxes { .. }));
        if let Some(metrics) = profiles::metrics_of_boxes(&spec).filter(|_| is_of_boxes) {
            self.warnings.push(
                "the data are boxes, so the metrics are those of the profile vision".to_owned(),
            );
            spec.to_mut()["metrics"] = metrics;
        }
        if subjects.is_empty() {
            let Some(truth) = &self.truth else {
                self.warnings
                    .push("no truth was found for this job, so no metric was computed".to_owned());
                return Ok(None);
            };
            let tracks = tracked
                .or(self.tracks.as_ref())
                .ok_or_else(|| missing("/tracks", "tracks"))?;
            if truth.is_of_bearings() || tracks.is_of_bearings() {
                let are_alike = truth.is_of_bearings() && tracks.is_of_bearings();
                let Some(metrics) =
                    metrics_of_bearings(&spec["metrics"], are_alike, &mut self.warnings)
                else {
                    return Ok(None);
                };
                spec.to_mut()["metrics"] = metrics;
            }
            let input = EvaluationInput {
                recording: self.recording.as_ref(),
                truth: Some(truth),
                tracks,
            };
            subjects.push(Subject {
                name: "",
                content: Content::Points { input, truth },
            });
        }
        judge::judge(&spec, &subjects, plan.wants_files, observer).map(Some)
    }

    fn keep_side(&mut self, index: usize, dataset: Dataset) {
        self.sides
            .resize_with(self.sides.len().max(index + 1), Sides::default);
        match dataset.kind() {
            DatasetKind::Truth => self.sides[index].truth = Some(dataset),
            _ => self.sides[index].tracks = Some(dataset),
        }
    }

    /// The datasets of the job, and its scan by scan record.
    pub fn artifacts(
        &mut self,
        plan: &Plan,
        tracked: Option<Tracked>,
        observer: &mut dyn Observer,
    ) -> Result<Vec<Artifact>, RunError> {
        step(observer, Step::Write, 0)?;
        let mut files = Vec::new();
        if let (Some(tracked), Some(recording)) = (&tracked, &self.recording) {
            files.push(artifacts::scans(recording, &tracked.scans)?);
            if let Some(trace) = &tracked.trace {
                if trace.left_out() > 0 {
                    self.warnings.push(format!(
                        "association_trace.csv lacks the last {} rows",
                        trace.left_out()
                    ));
                }
                files.push(artifacts::trace(trace));
            }
        }
        let tracks = tracked.map(|tracked| tracked.tracks).or(self.tracks.take());
        if let Some(record) = self.record.take() {
            files.push(record_picture::draw(
                &record,
                self.recording.as_ref(),
                tracks.as_ref(),
            ));
            // A record that was loaded is there already.
            if scenario_of(&plan.spec).is_some() {
                files.push(artifacts::dataset(
                    &Dataset::BearingTime(record),
                    &self.sensors,
                )?);
            }
        }
        let datasets = [
            self.recording.take().map(Dataset::Detections),
            self.truth.take().map(Dataset::Truth),
            tracks
                .filter(|_| plan.kind != JobKind::Simulate)
                .map(Dataset::Tracks),
        ];
        for dataset in datasets.into_iter().flatten() {
            files.push(artifacts::dataset(&dataset, &self.sensors)?);
        }
        step(observer, Step::Write, 1)?;
        Ok(files)
    }
}

/// What the request says of sensors.
pub fn requested_sensors(spec: &Value) -> Vec<SensorSettings> {
    spec.get("sensors")
        .and_then(|value| Vec::deserialize(value).ok())
        .unwrap_or_default()
}

/// Asks whether to go on, before (0) and after (1) a step without parts.
fn step(observer: &mut dyn Observer, step: Step, done: u64) -> Result<(), RunError> {
    if observer.progress(step, done, 1).is_break() {
        Err(RunError::Stopped)
    } else {
        Ok(())
    }
}

/// Those of the metrics that directions can be judged by; `None` when there is none, or when only one side are directions.
fn metrics_of_bearings(
    metrics: &Value,
    are_alike: bool,
    warnings: &mut Vec<String>,
) -> Option<Value> {
    let bodies = metrics.as_array().into_iter().flatten();
    let (kept, others): (Vec<&Value>, Vec<&Value>) =
        bodies.partition(|body| are_alike && judge::accepts_bearings(body));
    if kept.is_empty() {
        warnings.push(format!("{OF_BEARINGS}, so no metric was computed"));
        return None;
    }
    if !others.is_empty() {
        let names: Vec<&str> = others
            .iter()
            .filter_map(|body| body["metric"].as_str())
            .collect();
        warnings.push(format!(
            "{OF_BEARINGS}, so these metrics were not computed: {}",
            names.join(", ")
        ));
    }
    Some(kept.into_iter().cloned().collect())
}

/// Truth and tracks of one sequence, or of a job that compares boxes.
fn subject_of<'a>(
    name: Option<&'a str>,
    index: usize,
    sides: &'a Sides,
) -> Result<Subject<'a>, RunError> {
    let place = if name.is_some() {
        format!("/sequences/{index}")
    } else {
        String::new()
    };
    let refuse = |detail: &str, allowed: &str| {
        RunError::Faults(vec![
            Fault::new(format!("{place}/truth"), "unsupported", detail).allowing(allowed),
        ])
    };
    let content = match (&sides.truth, &sides.tracks) {
        (Some(Dataset::Truth(truth)), Some(Dataset::Tracks(tracks)))
            if truth.is_of_bearings() != tracks.is_of_bearings() =>
        {
            return Err(refuse(OF_BEARINGS, "truth and tracks of one kind"));
        }
        (Some(Dataset::Truth(truth)), Some(Dataset::Tracks(tracks))) => Content::Points {
            input: EvaluationInput {
                recording: None,
                truth: Some(truth),
                tracks,
            },
            truth,
        },
        (Some(Dataset::TruthBoxes(truth)), Some(Dataset::TrackBoxes(tracks))) => {
            Content::Boxes { truth, tracks }
        }
        _ => {
            return Err(refuse(
                "truth and tracks are not of one kind",
                "both in the plane, or both boxes",
            ));
        }
    };
    Ok(Subject {
        name: name.unwrap_or_default(),
        content,
    })
}

fn missing(pointer: &str, what: &str) -> RunError {
    RunError::Faults(vec![Fault::new(
        pointer,
        "missing",
        format!("no {what} were found for this job"),
    )])
}

fn wrong_kind(pointer: &str, wanted: DatasetKind, found: DatasetKind) -> Fault {
    let hint = match (wanted, found) {
        (DatasetKind::Detections, DatasetKind::BearingTime) => {
            "; give 'detector' to find detections in it ({} takes the defaults)"
        }
        (DatasetKind::BearingTime, DatasetKind::Detections) => "; leave out 'detector'",
        _ => "",
    };
    let detail = format!(
        "expected a dataset of {}, found one of {}{hint}",
        wanted.name(),
        found.name()
    );
    Fault::new(pointer, "wrong_type", detail).allowing(wanted.name())
}
