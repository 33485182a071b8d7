//! Runs the tracker over a recording.

use super::given::{self, Start};
use super::noise;
use super::observer::{Observer, Step};
use super::plan::Plan;
use super::run::{Decided, RunError};
use super::speeds::Taken;
use crate::association::{ASSOCIATORS, Associator, Needs, Trace};
use crate::filtering::{AnyFilter, FILTERS, Filter};
use crate::math::rng::Seed;
use crate::model::fault::Fault;
use crate::model::scan::Recording;
use crate::model::sensor::{Sensor, SensorSettings};
use crate::model::state::GaussianState;
use crate::model::track::{Estimate, TrackSet};
use crate::model::truth::TruthSet;
use crate::model::watch::Watch;
use crate::tracking::{Lifecycle, ScanOutcome, Tracker, TrackerParts};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::cell::RefCell;

/// The tracks, and what happened scan by scan.
pub(super) struct Tracked {
    pub tracks: TrackSet,
    pub scans: Vec<ScanOutcome>,
    pub method: String,
    nis: NisReport,
    /// What the associator says of its work.
    diagnostics: Option<Value>,
    /// How long the associator took, where that was asked for.
    pub decided: Option<Decided>,
    /// What the associator wrote down step by step.
    pub trace: Option<Trace>,
    /// What the request left open.
    pub taken: Taken,
}

impl Tracked {
    /// A warning where the noise that was assumed does not fit the data.
    pub fn doubt_of_noise(&self, spec: &Value) -> Option<String> {
        let gate_probability = spec.pointer("/tracker/gate_probability")?.as_f64()?;
        noise::doubt(
            self.nis.mean?,
            self.nis.updates,
            self.nis.dimensions as u32,
            gate_probability,
        )
    }
}

/// The part `association` of a report.
#[derive(Debug, Serialize)]
pub(super) struct AssociationReport {
    method: String,
    counts: Counts,
    nis: NisReport,
    sensors: Vec<SensorSettings>,
    tracks: Vec<TrackLine>,
    #[serde(skip_serializing_if = "Option::is_none")]
    diagnostics: Option<Value>,
    /// What the request left open, and what was taken.
    #[serde(skip_serializing_if = "Taken::is_empty")]
    taken: Taken,
}

/// Normalised innovation squared of the updates of confirmed tracks: near `dimensions` on average when the filter's
/// covariances are honest.
#[derive(Debug, Clone, Copy, Serialize)]
struct NisReport {
    mean: Option<f64>,
    updates: u64,
    dimensions: usize,
}

#[derive(Debug, Serialize)]
struct Counts {
    scans: usize,
    detections: usize,
    /// Tracks ever started, tentative ones counted too.
    started_tracks: u64,
    tracks: usize,
    track_points: usize,
    /// Track points that were given a detection.
    associated_detections: usize,
}

#[derive(Debug, Serialize)]
struct TrackLine {
    track_id: String,
    start_time_s: Option<f64>,
    end_time_s: Option<f64>,
    points: usize,
    detections: usize,
}

/// Builds the tracker that `spec` names and feeds it every scan.
pub(super) fn track(
    plan: &Plan,
    (recording, truth): (&Recording, Option<&TruthSet>),
    (sensors, lifecycle): (Vec<Sensor>, Lifecycle),
    observer: &mut dyn Observer,
) -> Result<Tracked, RunError> {
    let (spec, seed) = (&plan.spec, plan.stream());
    let (filter, filter_name) = filter_of(spec)?;
    let (associator, method) = associator_of(spec, seed)?;
    if let Some(fault) = unmet_need(&method, associator.needs(), recording) {
        return Err(vec![fault].into());
    }
    if let Some(fault) = unbounded_gate(&lifecycle, &sensors) {
        return Err(vec![fault].into());
    }
    let has_rates = !sensors.is_empty()
        && sensors
            .iter()
            .all(|sensor| sensor.report.range_rate().is_some());
    let starts = given::starts(
        &lifecycle,
        recording,
        truth,
        &sensors,
        (&filter, filter_name),
        seed,
    )?;
    let job = Tracking {
        recording,
        associator,
        lifecycle,
        sensors,
        method,
        starts,
        is_timed: plan.is_timed,
    };
    match filter {
        AnyFilter::Kalman(filter) => job.run::<_, 4, 2>(filter, observer),
        AnyFilter::Converted(filter) => job.run::<_, 4, 2>(filter, observer),
        AnyFilter::Extended(filter) if has_rates => job.run::<_, 4, 3>(filter, observer),
        AnyFilter::Extended(filter) => job.run::<_, 4, 2>(filter, observer),
        AnyFilter::Unscented(filter) if has_rates => job.run::<_, 4, 3>(filter, observer),
        AnyFilter::Unscented(filter) => job.run::<_, 4, 2>(filter, observer),
        AnyFilter::BearingOnly(filter) => job.run::<_, 2, 1>(filter, observer),
    }
}

/// Everything that a tracker needs besides its filter.
struct Tracking<'a> {
    recording: &'a Recording,
    associator: Box<dyn Associator>,
    lifecycle: Lifecycle,
    sensors: Vec<Sensor>,
    method: String,
    /// The tracks that are given to the tracker.
    starts: Vec<Start>,
    /// Whether the associator is timed by itself.
    is_timed: bool,
}

impl Tracking<'_> {
    /// With a filter whose states have `N` variables and whose measurements have `D` values.
    fn run<F: Filter<N, D>, const N: usize, const D: usize>(
        self,
        filter: F,
        observer: &mut dyn Observer,
    ) -> Result<Tracked, RunError>
    where
        Estimate: From<GaussianState<N>>,
    {
        let Tracking {
            recording,
            associator,
            lifecycle,
            sensors,
            method,
            starts,
            is_timed,
        } = self;
        let first_sensor = recording.scans.first().map_or(0, |scan| scan.sensor);
        let states: Vec<_> = starts
            .iter()
            .map(|start| start.state(&filter, &sensors[first_sensor]))
            .collect();
        let mut tracker = Tracker::new(TrackerParts {
            filter,
            associator,
            lifecycle,
            sensors,
        });
        for (start, state) in starts.into_iter().zip(states) {
            tracker.add_track(
                start.truth_id,
                state.ok_or_else(|| unusable("/filter"))?,
                start.origin,
            );
        }
        if is_timed {
            tracker.keep_problems();
        }
        let mut scans = Vec::with_capacity(recording.scans.len());
        let total = recording.scans.len() as u64;
        let asked = RefCell::new((&mut *observer, 1));
        let question = || {
            let (observer, done) = &mut *asked.borrow_mut();
            observer.progress(Step::Associate, *done, total)
        };
        let watch = Watch::new(&question);
        for (index, scan) in recording.scans.iter().enumerate() {
            scans.push(tracker.step(scan, recording.detections_of(scan), &watch)?);
            asked.borrow_mut().1 = index as u64 + 1;
            if question().is_break() {
                return Err(RunError::Stopped);
            }
        }
        let nis = NisReport {
            mean: tracker.nis().mean(),
            updates: tracker.nis().updates,
            dimensions: D,
        };
        let (diagnostics, trace) = (tracker.diagnostics(), tracker.trace().cloned());
        let decided = if is_timed {
            timed(&mut tracker, recording.scans.len(), observer)
        } else {
            None
        };
        Ok(Tracked {
            tracks: tracker.into_history().into_tracks(recording),
            scans,
            method,
            nis,
            diagnostics,
            decided,
            trace,
            taken: Taken::default(),
        })
    }
}

/// How long the associator takes for all problems that it met, one after the other: that alone, and long enough for a clock.
/// `None` where the observer has no clock.
fn timed<F: Filter<N, D>, const N: usize, const D: usize>(
    tracker: &mut Tracker<F, N, D>,
    scans: usize,
    observer: &mut dyn Observer,
) -> Option<Decided>
where
    Estimate: From<GaussianState<N>>,
{
    let begun = observer.now()?;
    let asked = RefCell::new(&mut *observer);
    let question = || {
        asked
            .borrow_mut()
            .progress(Step::Associate, scans as u64, scans as u64)
    };
    let watch = Watch::new(&question);
    tracker.decide_again(&watch);
    if watch.is_stopped() {
        return None;
    }
    Some(Decided {
        spent: observer.now()?.checked_sub(begun)?,
        scans: scans as u64,
    })
}

/// Gate and life cycle of the tracks.
pub(super) fn lifecycle_of(spec: &Value) -> Result<Lifecycle, RunError> {
    Lifecycle::deserialize(&spec["tracker"]).map_err(|_| unusable("/tracker"))
}

/// A fault where a sensor never misses and nothing is outside a gate.
pub(super) fn unbounded_gate(lifecycle: &Lifecycle, sensors: &[Sensor]) -> Option<Fault> {
    if lifecycle.gate_probability < 1.0 || sensors.iter().all(|sensor| sensor.p_d < 1.0) {
        return None;
    }
    let detail = "without a gate a target of P_D = 1 is never without a detection: no assignment could leave it alone";
    Some(
        Fault::new("/tracker/gate_probability", "conflict", detail)
            .allowing("below 1, or a P_D below 1"),
    )
}

/// A fault where the recording does not know of its detections what the associator needs.
pub(super) fn unmet_need(method: &str, needs: Needs, recording: &Recording) -> Option<Fault> {
    let (what, lacking, column) = match needs {
        Needs::Nothing | Needs::Places => return None,
        Needs::Origins => (
            "origin",
            if recording.origins_known {
                0
            } else {
                recording.detections.len()
            },
            "a 'truth_id' column",
        ),
        Needs::Amplitudes => {
            let lacking = recording
                .detections
                .iter()
                .filter(|detection| detection.amplitude.is_none())
                .count();
            (
                "amplitude",
                lacking,
                "an 'amplitude' column without empty cells",
            )
        }
    };
    let detail = format!(
        "'{method}' needs the {what} of every detection; {lacking} of {} lack it",
        recording.detections.len()
    );
    (lacking > 0).then(|| Fault::new("/associator/method", "unsupported", detail).allowing(column))
}

/// The checked spec names only methods of the tables, with parameters that fit them; anything else is a fault of ours,
/// reported like one of the request instead of a panic.
fn unusable(pointer: &str) -> RunError {
    RunError::Faults(vec![Fault::new(
        pointer,
        "malformed",
        "the settings cannot be used",
    )])
}

/// The filter that `spec` names, and its name.
pub(super) fn filter_of(spec: &Value) -> Result<(AnyFilter, &'static str), RunError> {
    let entry = FILTERS
        .iter()
        .find(|entry| spec["filter"]["method"] == entry.name)
        .ok_or_else(|| unusable("/filter"))?;
    (entry.build)(&spec["filter"])
        .map(|filter| (filter, entry.name))
        .map_err(|_| unusable("/filter"))
}

pub(super) fn associator_of(
    spec: &Value,
    seed: Seed,
) -> Result<(Box<dyn Associator>, String), RunError> {
    let entry = ASSOCIATORS
        .iter()
        .find(|entry| spec["associator"]["method"] == entry.name)
        .ok_or_else(|| unusable("/associator"))?;
    (entry.build)(&spec["associator"], seed)
        .map(|associator| (associator, entry.name.to_owned()))
        .map_err(|_| unusable("/associator"))
}

pub(super) fn report(
    tracked: &Tracked,
    recording: &Recording,
    sensors: &[SensorSettings],
) -> AssociationReport {
    let set = &tracked.tracks;
    let lines: Vec<TrackLine> = set.tracks.iter().map(|track| line(set, track)).collect();
    AssociationReport {
        method: tracked.method.clone(),
        counts: Counts {
            scans: recording.scans.len(),
            detections: recording.detections.len(),
            started_tracks: tracked
                .scans
                .iter()
                .map(|scan| u64::from(scan.started))
                .sum(),
            tracks: lines.len(),
            track_points: lines.iter().map(|line| line.points).sum(),
            associated_detections: lines.iter().map(|line| line.detections).sum(),
        },
        nis: tracked.nis,
        sensors: sensors.to_vec(),
        tracks: lines,
        diagnostics: tracked.diagnostics.clone(),
        taken: tracked.taken.clone(),
    }
}

fn line(set: &TrackSet, track: &crate::model::track::Track) -> TrackLine {
    let is_detected = |point: &&crate::model::track::TrackPoint| {
        set.candidates_of(point)
            .iter()
            .any(|candidate| candidate.detection.is_some())
    };
    TrackLine {
        track_id: track.track_id.clone(),
        start_time_s: track.points.first().map(|point| point.time_s),
        end_time_s: track.points.last().map(|point| point.time_s),
        points: track.points.len(),
        detections: track.points.iter().filter(is_detected).count(),
    }
}
