//! Runs the tracker over a recording.

use super::observer::{Observer, Step};
use super::run::RunError;
use crate::association::{ASSOCIATORS, Needs};
use crate::filtering::FILTERS;
use crate::model::fault::Fault;
use crate::model::scan::Recording;
use crate::model::sensor::{Sensor, SensorSettings};
use crate::model::track::TrackSet;
use crate::tracking::{Lifecycle, ScanOutcome, Tracker, TrackerParts};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The tracks, and what happened scan by scan.
pub(super) struct Tracked {
    pub tracks: TrackSet,
    pub scans: Vec<ScanOutcome>,
    pub method: String,
    /// What the associator says of its work.
    pub diagnostics: Option<Value>,
}

/// The part `association` of a report.
#[derive(Debug, Serialize)]
pub(super) struct AssociationReport {
    method: String,
    counts: Counts,
    sensors: Vec<SensorSettings>,
    tracks: Vec<TrackLine>,
    #[serde(skip_serializing_if = "Option::is_none")]
    diagnostics: Option<Value>,
}

#[derive(Debug, Serialize)]
struct Counts {
    scans: usize,
    detections: usize,
    /// Tracks ever started, tentative ones counted too: one for each detection that no track was given.
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
pub(super) fn track(spec: &Value, recording: &Recording, sensors: Vec<Sensor>, observer: &mut dyn Observer) -> Result<Tracked, RunError> {
    let (parts, method) = parts_of(spec, sensors)?;
    check_needs(&method, parts.associator.needs(), recording)?;
    let mut tracker = Tracker::new(parts);
    let mut scans = Vec::with_capacity(recording.scans.len());
    for (index, scan) in recording.scans.iter().enumerate() {
        scans.push(tracker.step(scan, recording.detections_of(scan)));
        if observer.progress(Step::Associate, index as u64 + 1, recording.scans.len() as u64).is_break() {
            return Err(RunError::Stopped);
        }
    }
    let diagnostics = tracker.diagnostics();
    Ok(Tracked { tracks: tracker.into_history().into_tracks(recording), scans, method, diagnostics })
}

/// Whether the recording knows of its detections what the associator needs.
fn check_needs(method: &str, needs: Needs, recording: &Recording) -> Result<(), RunError> {
    let (what, lacking, column) = match needs {
        Needs::Nothing => return Ok(()),
        Needs::Origins => ("origin", if recording.origins_known { 0 } else { recording.detections.len() }, "a 'truth_id' column"),
        Needs::Amplitudes => {
            let lacking = recording.detections.iter().filter(|detection| detection.amplitude.is_none()).count();
            ("amplitude", lacking, "an 'amplitude' column without empty cells")
        }
    };
    if lacking == 0 {
        return Ok(());
    }
    let detail = format!("'{method}' needs the {what} of every detection; {lacking} of {} lack it", recording.detections.len());
    Err(RunError::Faults(vec![Fault::new("/associator/method", "unsupported", detail).allowing(column)]))
}

/// The checked spec names only methods of the tables, with parameters that fit them; anything else is a fault of ours,
/// reported like one of the request instead of a panic.
fn parts_of(spec: &Value, sensors: Vec<Sensor>) -> Result<(TrackerParts, String), RunError> {
    let unusable = |pointer: &str| RunError::Faults(vec![Fault::new(pointer, "malformed", "the settings cannot be used")]);
    let name = |part: &str| spec[part]["method"].as_str().unwrap_or_default().to_owned();
    let method = name("associator");
    let associator = ASSOCIATORS.iter().find(|entry| entry.name == method).and_then(|entry| (entry.build)(&spec["associator"]).ok());
    let filter = FILTERS.iter().find(|entry| entry.name == name("filter")).and_then(|entry| (entry.build)(&spec["filter"]).ok());
    let parts = TrackerParts {
        filter: filter.ok_or_else(|| unusable("/filter"))?,
        associator: associator.ok_or_else(|| unusable("/associator"))?,
        lifecycle: Lifecycle::deserialize(&spec["tracker"]).map_err(|_| unusable("/tracker"))?,
        sensors,
    };
    Ok((parts, method))
}

pub(super) fn report(tracked: &Tracked, recording: &Recording, sensors: &[SensorSettings]) -> AssociationReport {
    let set = &tracked.tracks;
    let lines: Vec<TrackLine> = set.tracks.iter().map(|track| line(set, track)).collect();
    AssociationReport {
        method: tracked.method.clone(),
        counts: Counts {
            scans: recording.scans.len(),
            detections: recording.detections.len(),
            started_tracks: tracked.scans.iter().map(|scan| u64::from(scan.unused)).sum(),
            tracks: lines.len(),
            track_points: lines.iter().map(|line| line.points).sum(),
            associated_detections: lines.iter().map(|line| line.detections).sum(),
        },
        sensors: sensors.to_vec(),
        tracks: lines,
        diagnostics: tracked.diagnostics.clone(),
    }
}

fn line(set: &TrackSet, track: &crate::model::track::Track) -> TrackLine {
    let is_detected =
        |point: &&crate::model::track::TrackPoint| set.candidates_of(point).iter().any(|candidate| candidate.detection.is_some());
    TrackLine {
        track_id: track.track_id.clone(),
        start_time_s: track.points.first().map(|point| point.time_s),
        end_time_s: track.points.last().map(|point| point.time_s),
        points: track.points.len(),
        detections: track.points.iter().filter(is_detected).count(),
    }
}
