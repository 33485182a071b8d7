//! The part `association` of a report.

use super::clutter::ClutterLine;
use super::estimates::Estimate;
use super::speeds::Taken;
use super::track::Tracked;
use crate::experiment::input::DetectionResult;
use crate::experiment::limits::LimitsReport;
use crate::filtering::imm::Models;
use crate::filtering::imm::settings::Model;
use crate::model::modes::MAX_MODES;
use crate::model::scan::Recording;
use crate::model::sensor::SensorSettings;
use crate::model::track::{Track, TrackPoint, TrackSet};
use crate::tracking::Merge;
use serde::Serialize;
use serde_json::Value;

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct AssociateResult {
    /// Where the input was a bearing-time record.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub detection: Option<DetectionResult>,
    pub association: Association,
    /// Whether the numbers are within the limits, where the request has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub limits: Option<LimitsReport>,
}

/// What the tracker made.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct Association {
    /// The associator.
    method: &'static str,
    counts: Counts,
    nis: NisReport,
    /// Of a filter of several motion models, in the order of the request.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    models: Option<Vec<ModelLine>>,
    sensors: Vec<SensorSettings>,
    /// The densities of clutter that were used, one a sensor; absent where each was given as one number.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    clutter: Option<Vec<ClutterLine>>,
    /// What nobody said of the sensors and was estimated from the recording; absent where nothing was.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "service", schema(required = false))]
    estimates: Vec<Estimate>,
    /// Tracks that were confirmed.
    tracks: Vec<TrackLine>,
    /// Tracks that ended because another one followed the same target; absent where there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "service", schema(required = false))]
    merged: Vec<MergeLine>,
    /// What the associator says of its own work; each has its own fields.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false, value_type = Object))]
    diagnostics: Option<Value>,
    /// What the request left open and was taken from the scene or the data; absent where it left nothing open.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    taken: Option<Taken>,
}

/// A motion model with what was taken where the request left it open, and how probable it was.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = MotionModelLine))]
struct ModelLine {
    model: &'static str,
    sojourn_s: f64,
    initial_probability: f64,
    /// Over all track points; `null` without any.
    mean_probability: Option<f64>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = AssociationCounts))]
struct Counts {
    scans: u64,
    detections: u64,
    /// Tracks ever started, tentative ones counted too.
    started_tracks: u64,
    tracks: u64,
    track_points: u64,
    /// Track points that were given a detection.
    associated_detections: u64,
    /// Detections that were put together with others, of sensors with `merge_within_m`; `detections` counts what is left.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    merged_detections: Option<u64>,
}

/// Normalised innovation squared of the updates of confirmed tracks: near `dimensions` on average when the filter's
/// covariances are honest. `dimensions` is null where some sensors report more values than others.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = Nis))]
pub struct NisReport {
    /// `null` when no confirmed track was updated.
    pub mean: Option<f64>,
    pub updates: u64,
    /// Values of one measurement.
    #[cfg_attr(feature = "service", schema(value_type = Option<u64>))]
    pub dimensions: Option<usize>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
struct TrackLine {
    track_id: String,
    start_time_s: Option<f64>,
    end_time_s: Option<f64>,
    points: u64,
    detections: u64,
}

/// A track that ended because `into_track_id` followed the same target.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = MergedTrack))]
struct MergeLine {
    track_id: String,
    into_track_id: String,
    /// Of the scan after which it ended.
    time_s: f64,
}

/// The part `association` of a report.
pub fn report(tracked: &Tracked, recording: &Recording, sensors: &[SensorSettings]) -> Association {
    let set = &tracked.tracks;
    let lines: Vec<TrackLine> = set.tracks.iter().map(|track| line(set, track)).collect();
    Association {
        method: tracked.method,
        counts: Counts {
            scans: recording.scans.len() as u64,
            detections: recording.detection_count() as u64,
            started_tracks: tracked
                .scans
                .iter()
                .map(|scan| u64::from(scan.started))
                .sum(),
            tracks: lines.len() as u64,
            track_points: lines.iter().map(|line| line.points).sum(),
            associated_detections: lines.iter().map(|line| line.detections).sum(),
            merged_detections: tracked.merged_detections,
        },
        nis: tracked.nis,
        models: tracked
            .models
            .as_ref()
            .map(|models| model_lines(set, models)),
        sensors: sensors.to_vec(),
        clutter: tracked.clutter.clone(),
        estimates: tracked.estimates.clone(),
        tracks: lines,
        merged: tracked.merges.iter().map(merge_line).collect(),
        diagnostics: tracked.diagnostics.clone(),
        taken: (!tracked.taken.is_empty()).then(|| tracked.taken.clone()),
    }
}

fn model_lines(set: &TrackSet, models: &Models) -> Vec<ModelLine> {
    let (mut sums, mut points) = ([0.0; MAX_MODES], 0u64);
    for point in set.tracks.iter().flat_map(|track| &track.points) {
        points += 1;
        for (sum, probability) in sums.iter_mut().zip(set.modes_of(point)) {
            *sum += probability;
        }
    }
    let initial = models.initial_probabilities();
    let line = |((model, initial_probability), sum): ((&Model, f64), f64)| ModelLine {
        model: model.motion.name(),
        sojourn_s: model.sojourn_s,
        initial_probability,
        mean_probability: (points > 0).then(|| sum / points as f64),
    };
    models.iter().zip(initial).zip(sums).map(line).collect()
}

fn merge_line(merge: &Merge) -> MergeLine {
    MergeLine {
        track_id: merge.track_id.clone(),
        into_track_id: merge.into_track_id.clone(),
        time_s: merge.time_s,
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
        points: track.points.len() as u64,
        detections: track.points.iter().filter(is_detected).count() as u64,
    }
}
