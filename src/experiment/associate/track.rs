//! Runs the tracker over a recording.

use super::auto_filter::SettledTracking;
use super::clutter::{self, ClutterLine};
use super::confirm;
use super::estimates::{self, Estimate};
use super::report::NisReport;
use super::speeds::{self, Taken};
use super::truth_initiation::{self, Start};
use super::{maneuver_index, no_tracks, noise, observability, reports, scan_gaps};
use crate::association::{Associator, BuildAssociator, Needs, Trace};
use crate::experiment::files::datasets;
use crate::experiment::input::{JobData, sensors};
use crate::experiment::job::{Artifact, AssociationTime, RunError, RunSettings, refuse_any};
use crate::experiment::observer::{Observer, Step};
use crate::experiment::request::methods::Choice;
use crate::experiment::request::sources::InputSpec;
use crate::filtering::AnyFilter;
use crate::filtering::imm::Models;
use crate::math::rng::Seed;
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::scan::Recording;
use crate::model::scenario::Scenario;
use crate::model::sensor::{Sensor, SensorSettings};
use crate::model::sight::clutter::ClutterMap;
use crate::model::track::TrackSet;
use crate::model::watch::Watch;
use crate::tracking::{
    BuildTracker, History, Initiation, Lifecycle, Merge, ScanOutcome, Tracker, TrackerParts,
    Undetected,
};
use serde_json::Value;
use std::cell::RefCell;

/// The file of smoothed tracks.
pub const SMOOTHED_TRACKS: &str = "smoothed_tracks.csv";

/// The tracks, and what happened scan by scan.
pub struct Tracked {
    pub tracks: TrackSet,
    /// The same in the light of later scans, where that was asked for.
    pub smoothed: Option<TrackSet>,
    pub scans: Vec<ScanOutcome>,
    pub method: &'static str,
    pub nis: NisReport,
    /// Where the filter has several motion models.
    pub models: Option<Models>,
    /// What the associator says of its work.
    pub diagnostics: Option<Value>,
    /// The clutter that was used, where it was not given as one number.
    pub clutter: Option<Vec<ClutterLine>>,
    /// What nobody said of the sensors.
    pub estimates: Vec<Estimate>,
    /// Maps of clutter at the end.
    maps: Vec<Option<ClutterMap>>,
    /// Detections that became part of others, where that was asked for.
    pub merged_detections: Option<u64>,
    /// Tracks that ended because another one followed the same target.
    pub merges: Vec<Merge>,
    /// What the tracker tells of how it went.
    told: Vec<String>,
    /// How long the associator took, where that was asked for.
    pub association_time: Option<AssociationTime>,
    /// What the associator wrote down step by step.
    trace: Option<Trace>,
    /// What the request left open.
    pub taken: Taken,
}

impl Tracked {
    /// `scans.csv`; `smoothed_tracks.csv` and `association_trace.csv` where there is one.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn files(&mut self, data: &mut JobData) -> Result<Vec<Artifact>, RunError> {
        let mut files = vec![datasets::scans(data.recording()?, &self.scans)?];
        if let Some(smoothed) = self.smoothed.take() {
            let smoothed = Dataset::Tracks(smoothed);
            files.push(Artifact {
                name: SMOOTHED_TRACKS,
                ..datasets::dataset(&smoothed, &data.sensors)?
            });
        }
        if let Some(trace) = &self.trace {
            let left_out = trace.left_out();
            if left_out > 0 {
                data.warnings.push(format!(
                    "association_trace.csv lacks the last {left_out} rows"
                ));
            }
            files.push(datasets::trace(trace));
        }
        Ok(files)
    }
}

/// A recording with what is known of its sensors and what was made of that.
pub struct ResolvedRecording<'a> {
    pub recording: &'a Recording,
    pub known: &'a [SensorSettings],
    pub sensors: &'a [Sensor],
}

/// Tracks the recording of the data; `requested` is what the job says of sensors.
///
/// # Errors
/// [`RunError::Stopped`]; what of the data the settings do not fit.
pub fn track(
    data: &mut JobData,
    input: &InputSpec,
    tracking: &SettledTracking,
    requested: &[SensorSettings],
    settings: RunSettings,
    observer: &mut dyn Observer,
) -> Result<Tracked, RunError> {
    let mut warnings = Vec::new();
    let scenario = input.scenario.as_ref();
    // A simulation knows what it made, a detector what it looked for.
    let estimates = if scenario.is_some() || data.record.is_some() {
        Vec::new()
    } else {
        estimates::complete(data, tracking, observer)?
    };
    warnings.extend(estimates::warnings(&estimates));
    let confirm_hits = confirm::hits(&tracking.spec.tracker, &estimates, &mut warnings);
    let mut tracked = track_with(
        data,
        scenario,
        &SettledTracking {
            confirm_hits,
            ..tracking.clone()
        },
        requested,
        settings,
        &mut warnings,
        observer,
    );
    data.warnings.append(&mut warnings);
    if let Ok(tracked) = &mut tracked {
        tracked.estimates = estimates;
        tracked.merged_detections = data.merged_detections;
    }
    tracked
}

fn track_with(
    data: &JobData,
    scenario: Option<&Scenario>,
    tracking: &SettledTracking,
    requested: &[SensorSettings],
    settings: RunSettings,
    warnings: &mut Vec<String>,
    observer: &mut dyn Observer,
) -> Result<Tracked, RunError> {
    let filter = &tracking.filter.filter;
    let recording = &*reports::as_taken(data.recording()?, &data.sensors, filter, warnings);
    let (run, taken) = TrackerRun::new(
        (data, recording),
        scenario,
        tracking,
        requested,
        settings,
        warnings,
    )?;
    let (sensors, lifecycle) = (run.sensors.clone(), run.lifecycle);
    let resolved = ResolvedRecording {
        recording,
        known: &data.sensors,
        sensors: &sensors,
    };
    let mut tracked = run.run(observer)?;
    tracked.taken = Taken {
        filter: tracking.chosen.clone(),
        ..taken
    };
    tracked.clutter = clutter::lines(&resolved, &tracked.tracks, &tracked.maps);
    warnings.extend(scan_gaps::warning(recording));
    warnings.extend(observability::warning(&resolved));
    warnings.extend(noise::warning(
        &tracked.nis,
        lifecycle.gate_probability,
        &sensors,
    ));
    warnings.extend(maneuver_index::warning(&resolved, filter));
    warnings.extend(std::mem::take(&mut tracked.told));
    warnings.extend(no_tracks::warning(&tracked, &resolved, &lifecycle, filter));
    // Clutter that lies near targets only is not spread over what the sensor watches: a comparison would mislead.
    if !scenario.is_some_and(has_local_clutter) {
        warnings.extend(clutter::disagreements(&resolved, &tracked.tracks));
    }
    Ok(tracked)
}

fn has_local_clutter(scenario: &Scenario) -> bool {
    scenario
        .sensors
        .iter()
        .any(|sensor| sensor.clutter_within_deg.is_some())
}

/// Everything that a tracker needs.
struct TrackerRun<'a> {
    build: BuildTracker,
    filter: AnyFilter,
    recording: &'a Recording,
    associator: Box<dyn Associator>,
    lifecycle: Lifecycle,
    undetected: Option<Undetected>,
    sensors: Vec<Sensor>,
    method: &'static str,
    /// The tracks that are given to the tracker.
    starts: Vec<Start>,
    /// Whether the associator is timed by itself.
    is_timed: bool,
}

impl<'a> TrackerRun<'a> {
    /// With what the settings leave open taken from the scene or the data.
    fn new(
        (data, recording): (&JobData, &'a Recording),
        scenario: Option<&Scenario>,
        tracking: &SettledTracking,
        requested: &[SensorSettings],
        settings: RunSettings,
        warnings: &mut Vec<String>,
    ) -> Result<(Self, Taken), RunError> {
        let named = &tracking.filter;
        let sensors = sensors::resolve(recording, &data.sensors, named, warnings)?;
        refuse_any(sensors::misplaced_densities(requested, &sensors))?;
        let resolved = ResolvedRecording {
            recording,
            known: &data.sensors,
            sensors: &sensors,
        };
        let (tracker, associator) = (&tracking.spec.tracker, &tracking.spec.associator);
        let (mut lifecycle, mut taken) =
            speeds::complete(tracker, scenario, &resolved, &named.filter, warnings);
        taken.confirm_hits = tracking.confirm_hits;
        lifecycle.confirm_hits = taken.confirm_hits.unwrap_or(lifecycle.confirm_hits);
        let faults = [
            unmet_need(associator, recording),
            unbounded_gate(&lifecycle, &sensors),
            nothing_starts(&lifecycle, &sensors),
        ];
        if let Some(fault) = faults.into_iter().flatten().next() {
            return Err(fault.into());
        }
        let (truth, seed) = (data.truth.as_ref(), settings.seed);
        let starts = truth_initiation::starts(&lifecycle, recording, truth, &sensors, named, seed)?;
        let run = TrackerRun {
            build: tracker.build,
            filter: sensors::filter_for(&sensors, &named.filter),
            recording,
            associator: associator.build(seed),
            lifecycle,
            undetected: tracker.undetected.clone(),
            sensors,
            method: associator.name(),
            starts,
            is_timed: settings.time_association,
        };
        Ok((run, taken))
    }

    fn run(self, observer: &mut dyn Observer) -> Result<Tracked, RunError> {
        let (recording, method, is_timed) = (self.recording, self.method, self.is_timed);
        let filter = self.filter;
        let (dimensions, smoothing) = (common_dimensions(&self.sensors), self.lifecycle.smoothing);
        let mut tracker = self.start()?;
        if is_timed {
            tracker.keep_problems();
        }
        let mut history = History::default();
        let scans = step_all(tracker.as_mut(), recording, &mut history, observer)?;
        let nis = NisReport {
            mean: tracker.nis().mean(),
            updates: tracker.nis().updates,
            dimensions,
        };
        let maps = tracker.clutter_maps().to_vec();
        let told = tracker.warnings();
        let (diagnostics, trace) = (tracker.diagnostics(), tracker.trace().cloned());
        let association_time = if is_timed {
            time_association(tracker.as_mut(), recording.scans.len(), observer)
        } else {
            None
        };
        drop(tracker);
        let merges = history.merges();
        let (tracks, smoothed) = history.into_smoothed(recording, &filter, smoothing);
        Ok(Tracked {
            tracks,
            smoothed,
            scans,
            method,
            nis,
            models: filter.models().copied(),
            diagnostics,
            clutter: None,
            estimates: Vec::new(),
            maps,
            merged_detections: None,
            merges,
            told,
            association_time,
            trace,
            taken: Taken::default(),
        })
    }

    /// A tracker with the tracks that it is given.
    fn start(self) -> Result<Box<dyn Tracker>, RunError> {
        let mut given = Vec::with_capacity(self.starts.len());
        for start in self.starts {
            given.push(start.given(&self.filter)?);
        }
        Ok((self.build)(TrackerParts {
            filter: self.filter,
            associator: self.associator,
            lifecycle: self.lifecycle,
            undetected: self.undetected,
            sensors: self.sensors,
            given,
        }))
    }
}

/// Values of a report, where those of all sensors have as many.
fn common_dimensions(sensors: &[Sensor]) -> Option<usize> {
    let mut dimensions = sensors.iter().map(|sensor| sensor.report.dimensions());
    let first = dimensions.next().unwrap_or(2);
    dimensions.all(|other| other == first).then_some(first)
}

fn step_all(
    tracker: &mut dyn Tracker,
    recording: &Recording,
    history: &mut History,
    observer: &mut dyn Observer,
) -> Result<Vec<ScanOutcome>, RunError> {
    let mut scans = Vec::with_capacity(recording.scans.len());
    let total = recording.scans.len() as u64;
    let asked = RefCell::new((observer, 1));
    let question = || {
        let (observer, done) = &mut *asked.borrow_mut();
        observer.progress(Step::Associate, *done, total)
    };
    let watch = Watch::new(&question);
    for (index, scan) in recording.scans.iter().enumerate() {
        scans.push(tracker.step(scan, history, &watch)?);
        asked.borrow_mut().1 = index as u64 + 1;
        if question().is_break() {
            return Err(RunError::Stopped);
        }
    }
    tracker.finish(history);
    Ok(scans)
}

/// How long the associator takes for all problems that it met, one after the other: that alone, and long enough for a clock.
/// `None` where the observer has no clock.
fn time_association(
    tracker: &mut dyn Tracker,
    scans: usize,
    observer: &mut dyn Observer,
) -> Option<AssociationTime> {
    let begun = observer.now()?;
    let scans = scans as u64;
    let asked = RefCell::new(&mut *observer);
    let question = || asked.borrow_mut().progress(Step::Associate, scans, scans);
    let watch = Watch::new(&question);
    tracker.decide_again(&watch);
    if watch.is_stopped() {
        return None;
    }
    let spent = observer.now()?.checked_sub(begun)?;
    Some(AssociationTime { spent, scans })
}

/// A fault where no sensor may start a track.
pub fn nothing_starts(lifecycle: &Lifecycle, sensors: &[Sensor]) -> Option<Fault> {
    let begins_at_truth = matches!(lifecycle.initiation, Initiation::Truth { .. });
    if begins_at_truth || sensors.is_empty() || sensors.iter().any(|sensor| sensor.may_start) {
        return None;
    }
    let detail = "no sensor may start a track: there will be none";
    Some(Fault::new("/sensors", "conflict", detail).allowing("a sensor with may_start true"))
}

/// A fault where a sensor never misses and nothing is outside a gate.
pub fn unbounded_gate(lifecycle: &Lifecycle, sensors: &[Sensor]) -> Option<Fault> {
    let highest_p_d = |sensor: &Sensor| {
        let sight = sensor.sight.as_ref();
        sight.map_or(sensor.p_d, |sight| sight.highest_p_d())
    };
    if lifecycle.gate_probability < 1.0 || sensors.iter().all(|sensor| highest_p_d(sensor) < 1.0) {
        return None;
    }
    let detail = "without a gate a target of P_D = 1 is never without a detection: no assignment could leave it alone";
    Some(
        Fault::new("/tracker/gate_probability", "conflict", detail)
            .allowing("below 1, or a P_D below 1"),
    )
}

/// A fault where the recording does not know of its detections what the associator needs.
pub fn unmet_need(associator: &Choice<BuildAssociator>, recording: &Recording) -> Option<Fault> {
    let (what, lacking, column) = match needs_of(associator) {
        Needs::Nothing | Needs::Places => return None,
        Needs::Origins | Needs::OriginsInGates if recording.origins_known => return None,
        Needs::Origins | Needs::OriginsInGates => {
            ("origin", recording.detection_count(), "a 'truth_id' column")
        }
        Needs::Amplitudes => (
            "amplitude",
            recording
                .detections()
                .filter(|detection| detection.amplitude.is_none())
                .count(),
            "an 'amplitude' column without empty cells",
        ),
    };
    let detail = format!(
        "'{}' needs the {what} of every detection; {lacking} of {} lack it",
        associator.name(),
        recording.detection_count()
    );
    (lacking > 0).then(|| Fault::new("/associator/method", "unsupported", detail).allowing(column))
}

/// They are the same for every seed.
pub fn needs_of(associator: &Choice<BuildAssociator>) -> Needs {
    associator.build(Seed { seed: 0, run: 0 }).needs()
}

#[cfg(test)]
mod tests;
