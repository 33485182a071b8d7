//! Where the living tracks were lately.

use crate::model::track::TrackStatus;
use crate::tracking::recorder::RecordedPoint;
use std::collections::{BTreeMap, VecDeque};

/// Points that are kept of a track.
pub const TRAIL_POINTS: usize = 256;

/// A track at one scan.
#[derive(Debug, Clone, PartialEq)]
pub struct TrailPoint {
    pub time_s: f64,
    pub status: TrackStatus,
    pub existence: Option<f64>,
    /// Mean of the kinematics, then the upper triangle of its covariance row by row.
    pub kinematics: Box<[f64]>,
}

/// Of each living track, by serial, its latest points.
#[derive(Debug, Clone, Default)]
pub struct Trails(BTreeMap<u32, VecDeque<TrailPoint>>);

impl Trails {
    pub fn push(&mut self, point: &RecordedPoint) {
        let trail = self.0.entry(point.serial).or_default();
        if trail.len() == TRAIL_POINTS {
            trail.pop_front();
        }
        trail.push_back(TrailPoint {
            time_s: point.time_s,
            status: point.status,
            existence: point.existence,
            kinematics: point.kinematics.into(),
        });
    }

    pub fn end(&mut self, serial: u32) {
        self.0.remove(&serial);
    }

    pub fn of(&self, serial: u32) -> impl Iterator<Item = &TrailPoint> {
        self.0.get(&serial).into_iter().flatten()
    }

    /// Forgets what was from this time on.
    pub fn cut(&mut self, time_s: f64) {
        for trail in self.0.values_mut() {
            while trail.back().is_some_and(|point| point.time_s >= time_s) {
                trail.pop_back();
            }
        }
        self.0.retain(|_, trail| !trail.is_empty());
    }
}
