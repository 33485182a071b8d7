//! Reports of a tracker as tracks: each path of a track number is one.

use super::codes::Codes;
use super::place::{Ground, Unplaced};
use super::{Feed, Manner, note, path_name, paths};
use crate::formats::Reading;
use crate::model::attributes::Attributes;
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::names::natural_order;
use crate::model::space::Space;
use crate::model::track::{Kinematics, Track, TrackPoint, TrackSet};

/// Silence after which a track number is given to another track (s).
const TRACK_GAP_S: f64 = 60.0;

pub(super) fn build(
    feed: &mut Feed,
    manner: &Manner,
    reading: &Reading,
) -> Result<Dataset, Vec<Fault>> {
    let manner = Manner {
        path_gap_s: TRACK_GAP_S,
        splits_by_callsign: false,
        ..*manner
    };
    let paths = paths::divide(feed, &manner, reading);
    let used: Vec<usize> = paths
        .iter()
        .flat_map(|path| path.reports.iter().copied())
        .collect();
    let mut ground = Ground::of(feed, &used, reading)?;
    let mut attributes = Attributes::new();
    let mut codes = Codes::default();
    let mut tracks = Vec::with_capacity(paths.len());
    let mut unplaced = Unplaced::default();
    for path in paths {
        let track_id = path_name(feed.identities.name(path.identity), path.number);
        let known = feed.attributes_of(path.identity, &path.reports);
        note(&mut attributes, &track_id, known);
        codes.note(feed, &track_id, &path.reports);
        let mut points = Vec::with_capacity(path.reports.len());
        for &index in &path.reports {
            let point = point(feed, index, &mut ground);
            unplaced.count(feed, index, point.is_some());
            points.extend(point);
        }
        tracks.push(Track { track_id, points });
    }
    feed.warnings.extend(unplaced.warning(feed));
    feed.warnings.extend(ground.warning());
    tracks.retain(|track| !track.points.is_empty());
    tracks.sort_by(|a, b| natural_order(&a.track_id, &b.track_id));
    Ok(Dataset::Tracks(TrackSet {
        space: Space::Plane,
        frame: ground.frame,
        tracks,
        attributes,
        changes: codes.finish(feed),
        sensor_ids: std::mem::take(&mut feed.sensors).into_names(),
        ..TrackSet::default()
    }))
}

fn point(feed: &Feed, index: usize, ground: &mut Ground) -> Option<TrackPoint> {
    let report = &feed.reports[index];
    let place_m = ground.place_m(report)?;
    Some(TrackPoint {
        time_s: report.time_s,
        sensor: Some(report.sensor),
        estimate: Kinematics {
            position: place_m.push(0.0),
            velocity: ground.velocity(report),
            covariance: None,
        },
        height_m: report.height_m,
        status: report.status,
        nis: None,
        known_at_s: None,
        existence: None,
        mode_row: None,
        first_candidate: 0,
        candidates: 0,
    })
}
