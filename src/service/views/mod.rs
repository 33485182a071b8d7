//! Pictures as numbers: pure functions from datasets to columns, reduced where there is more than a screen can show,
//! and always saying so.

pub mod association_map;
pub mod bearing_time;
pub mod compare;
pub mod gates;
mod heights;
pub mod layers;
pub mod metrics;
mod modes;
mod origins;
pub mod plan;
pub mod preview;
mod reduction;
pub mod report_page;
pub mod series;

pub use reduction::{DEFAULT_MAX_POINTS, Density, Method, Reduced};

use crate::model::scan::{Detection, Measurement, Recording, Scan};
use crate::model::state::Position;
use crate::model::track::{Candidate, TrackPoint, TrackSet};

/// Which part of the data to show.
#[derive(Debug, Clone, Default)]
pub struct Window {
    pub from_s: Option<f64>,
    pub to_s: Option<f64>,
    /// Only this track.
    pub track_id: Option<String>,
    pub max_points: usize,
}

impl Window {
    fn holds(&self, time_s: f64) -> bool {
        self.from_s.is_none_or(|from_s| time_s >= from_s)
            && self.to_s.is_none_or(|to_s| time_s <= to_s)
    }

    fn holds_track(&self, track_id: &str) -> bool {
        self.track_id
            .as_deref()
            .is_none_or(|wanted| wanted == track_id)
    }
}

/// The scans of a recording inside the window.
fn scans<'a>(recording: &'a Recording, window: &Window) -> impl Iterator<Item = &'a Scan> {
    recording
        .scans
        .iter()
        .filter(move |scan| window.holds(scan.time_s))
}

/// A detection of a recording.
struct Seen<'a> {
    scan: &'a Scan,
    detection: &'a Detection,
    detection_id: &'a str,
    /// Its height, where it has one.
    z_m: Option<f64>,
}

/// The detections of the scans inside the window.
fn detections<'a>(recording: &'a Recording, window: &Window) -> impl Iterator<Item = Seen<'a>> {
    recording
        .scans_with_firsts()
        .filter(|(_, scan)| window.holds(scan.time_s))
        .flat_map(move |(first, scan)| {
            let found = (first..).zip(&scan.detections);
            found.map(move |(index, detection)| Seen {
                scan,
                detection,
                detection_id: &recording.detection_ids[index],
                z_m: detection.measurement.z_m(),
            })
        })
}

/// Name and point of every track point inside the window, track by track.
fn points<'a>(
    set: &'a TrackSet,
    window: &Window,
) -> impl Iterator<Item = (&'a str, &'a TrackPoint)> {
    let tracks = set
        .tracks
        .iter()
        .filter(|track| window.holds_track(&track.track_id));
    let all = tracks.flat_map(|track| {
        track
            .points
            .iter()
            .map(|point| (track.track_id.as_str(), point))
    });
    all.filter(|(_, point)| window.holds(point.time_s))
}

/// The detection that a candidate names; `None` is ε.
fn detection_id(set: &TrackSet, candidate: &Candidate) -> Option<String> {
    candidate
        .detection
        .map(|index| set.detection_ids[index as usize].clone())
}

/// Where a detection is, in the plane; a bearing alone is nowhere.
fn place(measurement: Measurement, sensor_m: Position) -> Option<(f64, f64)> {
    match measurement.flat() {
        Measurement::Position { x_m, y_m } => Some((x_m, y_m)),
        Measurement::RangeBearing {
            range_m,
            bearing_rad,
            ..
        } => {
            let (sine, cosine) = bearing_rad.sin_cos();
            Some((sensor_m.x + range_m * sine, sensor_m.y + range_m * cosine))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests;
