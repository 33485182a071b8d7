//! The part `association` of a report.

use super::speeds::Taken;
use super::track::Tracked;
use crate::model::scan::Recording;
use crate::model::sensor::SensorSettings;
use crate::model::track::{Track, TrackPoint, TrackSet};
use serde::Serialize;
use serde_json::Value;

/// The part `association` of a report.
#[derive(Debug, Serialize)]
pub struct AssociationReport {
    method: &'static str,
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
/// covariances are honest. `dimensions` is null where some sensors report more values than others.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct NisReport {
    pub mean: Option<f64>,
    pub updates: u64,
    pub dimensions: Option<usize>,
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

/// The part `association` of a report.
pub fn report(
    tracked: &Tracked,
    recording: &Recording,
    sensors: &[SensorSettings],
) -> AssociationReport {
    let set = &tracked.tracks;
    let lines: Vec<TrackLine> = set.tracks.iter().map(|track| line(set, track)).collect();
    AssociationReport {
        method: tracked.method,
        counts: Counts {
            scans: recording.scans.len(),
            detections: recording.detection_count(),
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

fn line(set: &TrackSet, track: &Track) -> TrackLine {
    let is_detected = |point: &&TrackPoint| {
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
