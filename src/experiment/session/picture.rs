//! What a page draws of a session: what is believed now, and the scans that the tracker took lately as places in the plane.

use super::Session;
use super::events::track_id;
use super::line::Kept;
use super::scene::Scene;
use super::told::{LiveTrack, SessionCounts};
use crate::model::scan::{Measurement, Scan};
use crate::model::state::Position;
use serde::Serialize;
use std::collections::VecDeque;

/// Scans that are kept for pictures, and their detections.
const RECENT_SCANS: usize = 64;
const RECENT_DETECTIONS: usize = 20_000;
/// Points that a picture tells of the way of one track, and of all.
const WAY_POINTS: usize = 64;
const ALL_WAY_POINTS: usize = 100_000;

/// The scans that the tracker took lately, in the order in which it first took them. No part of a checkpoint.
#[derive(Debug, Clone, Default)]
pub struct RecentScans {
    /// Number of the latest; the first scan that a session takes is number 1.
    last: u64,
    kept: VecDeque<SeenScan>,
    /// Of all kept scans.
    detections: usize,
}

/// A scan as places in the plane.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct SeenScan {
    /// Counts the scans that the tracker took, from 1.
    pub number: u64,
    pub sensor_id: String,
    pub time_s: f64,
    /// Where the sensor was, where that is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub sensor_x_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub sensor_y_m: Option<f64>,
    /// How many it had; of very many only the first are here.
    pub detections: u64,
    /// East of each detection that has a place.
    pub x_m: Vec<f64>,
    /// North of each.
    pub y_m: Vec<f64>,
    /// Of each detection that is a direction alone, clockwise from north.
    pub bearing_deg: Vec<f64>,
}

/// A session for whoever draws it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct SessionPicture {
    /// Time of the last scan that the tracker took.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub processed_to_s: Option<f64>,
    /// How much later the newest that was heard of any sensor is.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub lag_s: Option<f64>,
    /// Number of the latest event.
    pub last_event: u64,
    /// Number of the latest scan that the tracker took.
    pub last_scan: u64,
    /// Scans that wait for others.
    pub waiting: u64,
    /// Whether it takes no scans for the time being.
    pub is_paused: bool,
    pub counts: SessionCounts,
    pub sensors: Vec<SensorPlace>,
    /// The living tracks.
    pub tracks: Vec<LiveTrack>,
    /// Where they were lately; only in a picture that does not follow another.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub ways: Option<Vec<TrackWay>>,
    /// In the order in which the tracker took them.
    pub scans: Vec<SeenScan>,
}

/// Where a sensor stands, as far as that is known.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct SensorPlace {
    pub sensor_id: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub x_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub y_m: Option<f64>,
    /// Radius of its field of view.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub max_range_m: Option<f64>,
}

/// The latest points of a track in the plane, oldest first.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct TrackWay {
    pub track_id: String,
    pub time_s: Vec<f64>,
    pub x_m: Vec<f64>,
    pub y_m: Vec<f64>,
}

impl RecentScans {
    /// Of a session that took so many scans of which nothing is known any more.
    pub fn after(taken: u64) -> Self {
        RecentScans {
            last: taken,
            ..RecentScans::default()
        }
    }

    /// Keeps a scan that the tracker takes for the first time.
    pub fn push(&mut self, kept: &Kept, scene: &Scene) {
        self.last += 1;
        let seen = SeenScan::of(self.last, kept, scene);
        self.detections += seen.kept();
        self.kept.push_back(seen);
        while self.kept.len() > RECENT_SCANS || self.detections > RECENT_DETECTIONS {
            let oldest = self.kept.pop_front();
            self.detections -= oldest.map_or(0, |scan| scan.kept());
        }
    }

    /// Those after a number, oldest first.
    fn after_number(&self, number: u64) -> impl Iterator<Item = &SeenScan> {
        self.kept.iter().filter(move |scan| scan.number > number)
    }
}

impl SeenScan {
    fn of(number: u64, kept: &Kept, scene: &Scene) -> Self {
        let scan = kept.scan.scan(0, kept.sensor);
        let place = sensor_place(&scan, scene);
        let mut seen = SeenScan {
            number,
            sensor_id: kept.scan.sensor_id.clone(),
            time_s: scan.time_s,
            sensor_x_m: place.map(|place| place.x),
            sensor_y_m: place.map(|place| place.y),
            detections: scan.detections.len() as u64,
            x_m: Vec::new(),
            y_m: Vec::new(),
            bearing_deg: Vec::new(),
        };
        for detection in scan.detections.iter().take(RECENT_DETECTIONS) {
            seen.add(&detection.measurement, &place.unwrap_or_default());
        }
        seen
    }

    fn add(&mut self, measurement: &Measurement, from: &Position) {
        if let Some(place) = measurement.position_seen_from(from) {
            self.x_m.push(place.x);
            self.y_m.push(place.y);
        } else if let Measurement::Bearing { bearing_rad } = measurement.flat() {
            self.bearing_deg.push(bearing_rad.to_degrees());
        }
    }

    /// Detections that are here.
    fn kept(&self) -> usize {
        self.x_m.len() + self.bearing_deg.len()
    }
}

/// Where the sensor of a scan was.
fn sensor_place(scan: &Scan, scene: &Scene) -> Option<Position> {
    let known = &scene.known_sensors()[scan.sensor];
    let fixed = known.x_m.zip(known.y_m).map(|(x, y)| Position::new(x, y));
    match scan.pose {
        Some(pose) => Some(pose.place.xy()),
        None => fixed,
    }
}

impl Session {
    /// What is believed now, and the scans after a number; all that are kept, and the ways of the tracks, where there is none.
    pub fn picture(&self, after_scan: Option<u64>) -> SessionPicture {
        let tracks = self.tracks(None);
        let newest_s = super::feeds::newest_s(&self.feeds);
        let processed_to_s = self.processed_to_s();
        let lag_s = newest_s.zip(processed_to_s);
        SessionPicture {
            processed_to_s,
            lag_s: lag_s.map(|(newest_s, taken_s)| (newest_s - taken_s).max(0.0)),
            last_event: self.last_event(),
            last_scan: self.last_scan(),
            waiting: self.waiting() as u64,
            is_paused: self.is_paused(),
            counts: self.counts(),
            sensors: self.sensor_places(),
            ways: after_scan.is_none().then(|| self.ways()),
            tracks,
            scans: self
                .recent
                .after_number(after_scan.unwrap_or(0))
                .cloned()
                .collect(),
        }
    }

    /// Number of the latest scan that the tracker took; 0 when there was none.
    pub fn last_scan(&self) -> u64 {
        self.recent.last
    }

    fn sensor_places(&self) -> Vec<SensorPlace> {
        let known = self.scene.known_sensors().iter();
        known
            .map(|sensor| SensorPlace {
                sensor_id: sensor.sensor_id.clone(),
                x_m: sensor.x_m,
                y_m: sensor.y_m,
                max_range_m: sensor.max_range_m,
            })
            .collect()
    }

    fn ways(&self) -> Vec<TrackWay> {
        let serials = self.line.book.lines.keys();
        let most = (ALL_WAY_POINTS / serials.len().max(1)).clamp(1, WAY_POINTS);
        serials.map(|&serial| self.way_of(serial, most)).collect()
    }

    fn way_of(&self, serial: u32, most: usize) -> TrackWay {
        let mut way = TrackWay {
            track_id: track_id(serial),
            time_s: Vec::new(),
            x_m: Vec::new(),
            y_m: Vec::new(),
        };
        if !self.scene.space().has_places() {
            return way;
        }
        let skipped = self.trails.of(serial).count().saturating_sub(most);
        for point in self.trails.of(serial).skip(skipped) {
            let place = self.place_of(&point.kinematics);
            way.time_s.push(point.time_s);
            way.x_m.push(place.x);
            way.y_m.push(place.y);
        }
        way
    }
}
