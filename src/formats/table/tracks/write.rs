//! Tracks as rows, with the columns that their set needs.

use crate::formats::table::Sink;
use crate::formats::table::estimate::EstimateLayout;
use crate::formats::table::header::MODE_COLUMNS;
use crate::geodesy::Stereographic;
use crate::model::modes::MAX_MODES;
use crate::model::track::{Candidate, Track, TrackPoint, TrackSet, TrackStatus};
use std::io;

/// Writes track after track; a point with several candidates is several rows.
///
/// # Errors
/// What the output says.
pub fn write(set: &TrackSet, sink: &mut dyn Sink) -> io::Result<()> {
    let layout = Layout::for_set(set);
    let attributes = layout.estimate.attributes(&set.attributes);
    let mut columns = layout.columns();
    columns.extend(&attributes);
    sink.begin(&columns)?;
    let beside = Beside {
        layout,
        plane: layout.estimate.plane(),
        attributes,
    };
    for track in &set.tracks {
        for point in &track.points {
            let candidates = set.candidates_of(point);
            if candidates.is_empty() {
                write_row(set, track, point, None, &beside, sink)?;
            }
            for candidate in candidates {
                write_row(set, track, point, Some(candidate), &beside, sink)?;
            }
        }
    }
    Ok(())
}

/// Which optional columns a set of tracks needs.
#[derive(Clone, Copy)]
struct Layout {
    sensor: bool,
    estimate: EstimateLayout,
    candidates: bool,
    status: bool,
    nis: bool,
    known: bool,
    existence: bool,
    modes: usize,
}

impl Layout {
    fn for_set(set: &TrackSet) -> Self {
        let has = |wanted: fn(&TrackPoint) -> bool| {
            set.tracks
                .iter()
                .any(|track| track.points.iter().any(wanted))
        };
        Layout {
            sensor: has(|point| point.sensor.is_some()),
            estimate: EstimateLayout::for_set(set),
            candidates: has(|point| point.candidates > 0),
            status: has(|point| point.status.is_some()),
            nis: has(|point| point.nis.is_some()),
            known: has(|point| point.known_at_s.is_some()),
            existence: has(|point| point.existence.is_some()),
            modes: if has(|point| point.mode_row.is_some()) {
                set.modes.modes().min(MAX_MODES)
            } else {
                0
            },
        }
    }

    fn columns(self) -> Vec<&'static str> {
        let mut columns = vec!["time_s", "track_id"];
        columns.extend(self.sensor.then_some("sensor_id"));
        columns.extend(self.estimate.columns());
        columns.extend(
            self.candidates
                .then_some(["detection_id", "probability"])
                .into_iter()
                .flatten(),
        );
        columns.extend(self.status.then_some("status"));
        columns.extend(self.nis.then_some("nis"));
        columns.extend(self.known.then_some("known_at_s"));
        columns.extend(self.existence.then_some("existence"));
        columns.extend(&MODE_COLUMNS[..self.modes]);
        columns
    }
}

/// What is written beside the state of each point.
struct Beside {
    layout: Layout,
    plane: Option<Stereographic>,
    attributes: Vec<&'static str>,
}

fn write_row(
    set: &TrackSet,
    track: &Track,
    point: &TrackPoint,
    candidate: Option<&Candidate>,
    Beside {
        layout,
        plane,
        attributes,
    }: &Beside,
    sink: &mut dyn Sink,
) -> io::Result<()> {
    sink.number(Some(point.time_s))?;
    sink.text(Some(&track.track_id))?;
    if layout.sensor {
        sink.text(
            point
                .sensor
                .map(|sensor| set.sensor_ids[sensor as usize].as_str()),
        )?;
    }
    let estimate = &point.estimate;
    layout.estimate.write(
        &estimate.position,
        estimate.velocity.as_ref(),
        estimate.covariance.as_deref(),
        sink,
    )?;
    let position = &estimate.position;
    layout
        .estimate
        .write_beside(plane.as_ref(), position, point.height_m, sink)?;
    if layout.candidates {
        let detection = candidate.and_then(|candidate| candidate.detection);
        sink.text(detection.map(|detection| set.detection_ids[detection as usize].as_str()))?;
        sink.number(candidate.map(|candidate| candidate.probability))?;
    }
    if layout.status {
        sink.text(point.status.map(TrackStatus::name))?;
    }
    if layout.nis {
        sink.number(point.nis)?;
    }
    if layout.known {
        sink.number(point.known_at_s)?;
    }
    if layout.existence {
        sink.number(point.existence)?;
    }
    let modes = set.modes_of(point);
    for mode in 0..layout.modes {
        sink.number(modes.get(mode).copied())?;
    }
    for name in attributes {
        let of = (track.track_id.as_str(), point.time_s);
        sink.text(set.changes.word(&set.attributes, of, name))?;
    }
    sink.end_row()
}
