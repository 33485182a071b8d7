//! The data of a job: loaded, simulated, or found in a bearing-time record.

mod clusters;
mod detect;
pub mod extent;
mod extracts;
mod frames;
pub mod known;
pub mod sensors;
#[cfg(test)]
pub mod tests;

use crate::detection::Detector;
use crate::experiment::files::{datasets, record_picture};
use crate::experiment::job::{Artifact, InputRequest, Inputs, Outcome, RunError};
use crate::experiment::observer::{Observer, Step, report_progress};
use crate::experiment::request::sources::InputSpec;
use crate::math::rng::Seed;
use crate::model::bearing_time::BearingTimeRecord;
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use crate::model::relative_bearings::turned;
use crate::model::scan::Recording;
use crate::model::scenario::{RecordedTargets, Scenario, TargetPlan};
use crate::model::sensor::SensorSettings;
use crate::model::track::TrackSet;
use crate::model::truth::TruthSet;
use crate::simulation;
pub use detect::DetectionResult;
pub(super) use frames::move_truth;
use serde_json::Value;

/// What a job works on, as far as it has it.
#[derive(Default)]
pub struct JobData {
    pub recording: Option<Recording>,
    /// What the detections are found in.
    pub record: Option<BearingTimeRecord>,
    pub truth: Option<TruthSet>,
    pub tracks: Option<TrackSet>,
    /// The tracks of each sensor, of a job that puts them together.
    pub sets: Vec<TrackSet>,
    /// Of each sequence, or the boxes of a job without sequences.
    pub pairs: Vec<TruthAndTracks>,
    pub sensors: Vec<SensorSettings>,
    pub warnings: Vec<String>,
    /// The part `detection` of the report.
    pub detection: Option<DetectionResult>,
    /// Detections that became part of others, where sensors tell which are of one target.
    pub merged_detections: Option<u64>,
    /// What came with the detections.
    uploaded: Vec<SensorSettings>,
}

/// Truth and tracks to compare.
#[derive(Default)]
pub struct TruthAndTracks {
    pub truth: Option<Dataset>,
    pub tracks: Option<Dataset>,
}

impl JobData {
    /// Sorts what was loaded for these requests; `requested` is what the job says of sensors.
    ///
    /// # Errors
    /// An input of another kind than was asked for.
    pub fn load(
        requests: &[InputRequest],
        inputs: Inputs,
        requested: &[SensorSettings],
    ) -> Result<JobData, RunError> {
        let mut data = JobData::default();
        for (request, input) in requests.iter().zip(inputs) {
            let Some(input) = input else { continue };
            if input.dataset.kind() != request.role {
                return Err(wrong_kind(request, input.dataset.kind()).into());
            }
            if let Some(sequence) = request.sequence {
                data.keep_pair(sequence, input.dataset);
                continue;
            }
            match input.dataset {
                Dataset::Detections(recording) => {
                    data.recording = Some(recording);
                    data.uploaded = input.sensors;
                }
                Dataset::Truth(truth) => data.truth = Some(truth),
                Dataset::Tracks(tracks) if request.pointer.starts_with("/sets/") => {
                    data.sets.push(tracks)
                }
                Dataset::Tracks(tracks) => data.tracks = Some(tracks),
                boxes @ (Dataset::TruthBoxes(_) | Dataset::TrackBoxes(_)) => {
                    data.keep_pair(0, boxes)
                }
                Dataset::BearingTime(record) => {
                    data.sensors = vec![detect::sensor_of(&input.sensors, requested)];
                    data.record = Some(record);
                    data.uploaded = input.sensors;
                }
            }
        }
        frames::unite(&mut data)?;
        Ok(data)
    }

    fn keep_pair(&mut self, index: usize, dataset: Dataset) {
        let pairs = self.pairs.len().max(index + 1);
        self.pairs.resize_with(pairs, TruthAndTracks::default);
        match dataset.kind() {
            DatasetKind::Truth => self.pairs[index].truth = Some(dataset),
            _ => self.pairs[index].tracks = Some(dataset),
        }
    }

    /// Simulates the scenario, finds the detections of a record, and completes what is known of the sensors.
    ///
    /// # Errors
    /// [`RunError::Stopped`]; settings of sensors that the recording does not have; a detector without a record.
    pub fn gather(
        &mut self,
        input: &InputSpec,
        detector: Option<&Detector>,
        requested: &[SensorSettings],
        seed: Seed,
        observer: &mut dyn Observer,
    ) -> Result<(), RunError> {
        if let Some(scenario) = &input.scenario {
            self.simulate(scenario, seed, observer)?;
        }
        if let Some(detector) = detector {
            self.detect(detector, observer)?;
        }
        if let Some(recording) = self.recording.take() {
            self.sensors = sensors::merge_settings(&recording, &self.uploaded, requested)?;
            let turned = turned(recording, &mut self.sensors);
            let (recording, merged) = clusters::merged(turned, &self.sensors);
            (self.recording, self.merged_detections) = (Some(recording), merged);
        }
        if let Some(record) = &self.record
            && let Some(found) = self.recording.take()
        {
            let (sensors, warnings) = (&mut self.sensors, &mut self.warnings);
            self.recording = Some(detect::complete(sensors, found, record, warnings)?);
        }
        Ok(())
    }

    /// Puts sensors into the recording; gives those that stood there.
    pub fn put_sensors(&mut self, sensors: Vec<SensorSettings>) -> Vec<SensorSettings> {
        match &mut self.recording {
            Some(recording) => recording.replace_sensors(sensors),
            None => sensors,
        }
    }

    fn simulate(
        &mut self,
        scenario: &Scenario,
        seed: Seed,
        observer: &mut dyn Observer,
    ) -> Result<(), RunError> {
        let total = match &scenario.record {
            Some(record) => simulation::row_count(scenario, record),
            None => simulation::step_count(scenario),
        };
        let mut progress = |done| observer.progress(Step::Simulate, done, total);
        let truth = if scenario.record.is_some() {
            let simulated = simulation::simulate_record(scenario, seed, &mut progress)?
                .ok_or(RunError::Stopped)?;
            self.record = Some(simulated.record);
            self.sensors = vec![simulated.sensor];
            simulated.truth
        } else {
            let shipped = match &scenario.targets {
                TargetPlan::Recorded(RecordedTargets {
                    recording: Some(name),
                    ..
                }) => Some(extracts::truth_of(name)?),
                _ => None,
            };
            let recorded = shipped.as_ref().or(self.truth.as_ref());
            let simulated = simulation::simulate_recorded(scenario, recorded, seed, &mut progress)?
                .ok_or(RunError::Stopped)?;
            self.recording = Some(simulated.recording);
            self.warnings.extend(simulated.warnings);
            simulated.truth
        };
        if matches!(scenario.targets, TargetPlan::Recorded(_)) {
            self.truth = Some(truth);
        } else {
            self.truth.get_or_insert(truth);
        }
        Ok(())
    }

    fn detect(&mut self, detector: &Detector, observer: &mut dyn Observer) -> Result<(), RunError> {
        let (Some(record), Some(sensor)) = (&self.record, self.sensors.first()) else {
            return Err(missing("/input", "bearing-time record"));
        };
        let (recording, report) =
            detect::detect(detector, record, sensor, self.truth.as_ref(), observer)?;
        (self.recording, self.detection) = (Some(recording), Some(report));
        Ok(())
    }

    /// The recording, for a job that cannot do without.
    ///
    /// # Errors
    /// There is none.
    pub fn recording(&self) -> Result<&Recording, RunError> {
        self.recording
            .as_ref()
            .ok_or_else(|| missing("/input", "detections"))
    }

    /// Adds warnings that were not given yet: metrics and automaton read the same times, and say so in the same words.
    pub fn warn(&mut self, warnings: impl IntoIterator<Item = String>) {
        for warning in warnings {
            if !self.warnings.contains(&warning) {
                self.warnings.push(warning);
            }
        }
    }

    /// Warns where detections have heights, which what is `done` with them does not use.
    pub fn warn_of_heights(&mut self, done: &str) {
        if self
            .recording
            .as_ref()
            .is_some_and(|found| found.is_in_volume())
        {
            self.warn([format!(
                "the detections are of a volume (z_m): they are {done} in the plane, without heights"
            )]);
        }
    }

    /// The files `first`, then the datasets of the job, with `tracks` if it made some.
    ///
    /// # Errors
    /// [`RunError::Stopped`], or a file cannot be written.
    pub fn write(
        &mut self,
        input: &InputSpec,
        first: Vec<Artifact>,
        tracks: Option<TrackSet>,
        observer: &mut dyn Observer,
    ) -> Result<Vec<Artifact>, RunError> {
        report_progress(observer, Step::Write, 0, 1)?;
        let mut files = first;
        let tracks = tracks.or(self.tracks.take());
        if let Some(record) = self.record.take() {
            let recording = self.recording.as_ref();
            files.push(record_picture::draw(&record, recording, tracks.as_ref()));
            // A record that was loaded is there already.
            if input.scenario.is_some() {
                let record = Dataset::BearingTime(record);
                files.push(datasets::dataset(&record, &self.sensors)?);
            }
        }
        let datasets = [
            self.recording.take().map(Dataset::Detections),
            self.truth.take().map(Dataset::Truth),
            tracks.map(Dataset::Tracks),
        ];
        for dataset in datasets.into_iter().flatten() {
            files.push(datasets::dataset(&dataset, &self.sensors)?);
        }
        report_progress(observer, Step::Write, 1, 1)?;
        Ok(files)
    }

    /// What the job found, with the warnings so far.
    pub fn into_outcome(self, result: Value, artifacts: Vec<Artifact>) -> Outcome {
        Outcome {
            result,
            warnings: self.warnings,
            artifacts,
            association_time: None,
            cell_times: Vec::new(),
            checks: Vec::new(),
        }
    }
}

/// A fault where a job has not what it needs.
pub fn missing(pointer: &str, what: &str) -> RunError {
    Fault::new(
        pointer,
        "missing",
        format!("no {what} were found for this job"),
    )
    .into()
}

fn wrong_kind(request: &InputRequest, found: DatasetKind) -> Fault {
    let wanted = request.role;
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
    Fault::new(&request.pointer, "wrong_type", detail).allowing(wanted.name())
}
