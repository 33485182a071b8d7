//! Tracks that begin where bearings cross: one of this scan, and one of the last scan of another sensor at another place, which no
//! track used either.
//!
//! # Method
//! All pairs that cross start a track at rest; those that are not of one target find no further bearings and end. Since the other
//! sensor looked, a target has moved by about its speed times the time between, which widens the older bearing.

use super::SingleHypothesis;
use super::initiation::Point;
use crate::filtering::Filter;
use crate::hypotheses::bounds;
use crate::model::scan::{Detection, Measurement, Scan};
use crate::model::sensing::{Bearing, LineOfSight, MeasurementModel, Sensing, cross};
use crate::model::state::{GaussianState, Position, PositionCovariance};
use crate::model::watch::Halt;
use crate::tracking::recorder::Recorder;

/// A bearing that no track used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ray {
    pub time_s: f64,
    pub origin: Option<u32>,
    pub sight: LineOfSight,
    /// Whether it crossed another one: then it has a track.
    pub has_crossed: bool,
}

impl<F: Filter<K>, const K: usize> SingleHypothesis<F, K> {
    /// Starts tracks where the bearings that no track used cross earlier ones.
    pub(super) fn start_at_crossings(
        &mut self,
        scan: &Scan,
        bearing: &Bearing,
        recorder: &mut dyn Recorder,
    ) -> Result<(), Halt> {
        if self.memory.rays.len() <= scan.sensor {
            self.memory.rays.resize_with(scan.sensor + 1, Vec::new);
        }
        let report = MeasurementModel::Bearing(*bearing);
        let mut alone = Vec::new();
        let mut started = 0;
        for (index, detection) in scan.detections.iter().enumerate() {
            let Some(ray) = self.unused_ray(scan, bearing, (index, detection)) else {
                continue;
            };
            let places = self.take_crossings(&ray, scan.sensor);
            for place in &places {
                let point = Point {
                    scan_index: self.memory.scans,
                    time_s: scan.time_s,
                    sensor: scan.sensor,
                    detection: index as u32,
                    origin: ray.origin,
                    after_s: scan.own_of(index).after_s,
                    state: self.at_rest(place),
                };
                self.start_with_one(&point, (scan, &report), recorder);
            }
            started += places.len();
            bounds::check_scan(started, scan)?;
            if places.is_empty() {
                alone.push(ray);
            }
        }
        for rays in &mut self.memory.rays {
            rays.retain(|ray| !ray.has_crossed);
        }
        self.memory.rays[scan.sensor] = alone;
        Ok(())
    }

    /// A detection as a ray, if no track uses it.
    fn unused_ray(
        &self,
        scan: &Scan,
        bearing: &Bearing,
        (index, detection): (usize, &Detection),
    ) -> Option<Ray> {
        let Measurement::Bearing { bearing_rad } = detection.measurement.flat() else {
            return None;
        };
        let own = scan.own_of(index);
        let bearing = Sensing::<4, 1>::with_own(bearing, &own);
        (!self.scratch.hypotheses.is_used(index)).then(|| Ray {
            time_s: scan.time_s + own.after_s,
            origin: detection.origin,
            sight: bearing.sight(bearing_rad),
            has_crossed: false,
        })
    }

    /// Where a ray crosses those of other sensors, which are marked.
    fn take_crossings(&mut self, ray: &Ray, sensor: usize) -> Vec<(Position, PositionCovariance)> {
        let is_by_origin = self.associator.needs().is_by_origin();
        let speed_mps = self
            .filter
            .rate_sigma(self.lifecycle.initial_speed_sigma_mps);
        let mut places = Vec::new();
        for (other, rays) in self.memory.rays.iter_mut().enumerate() {
            if other == sensor {
                continue;
            }
            for earlier in rays {
                if is_by_origin && (ray.origin.is_none() || ray.origin != earlier.origin) {
                    continue;
                }
                let moved_m = speed_mps * (ray.time_s - earlier.time_s);
                let mut sight = earlier.sight;
                sight.spread_m2 += PositionCovariance::from_diagonal_element(moved_m * moved_m);
                if let Some(place) = cross(&sight, &ray.sight) {
                    places.push(place);
                    earlier.has_crossed = true;
                }
            }
        }
        places
    }

    fn at_rest(
        &self,
        (position_m, spread_m2): &(Position, PositionCovariance),
    ) -> GaussianState<K> {
        let speed_mps = self
            .filter
            .rate_sigma(self.lifecycle.initial_speed_sigma_mps);
        let mut state = GaussianState {
            mean: nalgebra::SVector::zeros(),
            covariance: nalgebra::SMatrix::zeros(),
        };
        for row in 0..2 {
            state.mean[row] = position_m[row];
            for column in 0..2 {
                state.covariance[(row, column)] = spread_m2[(row, column)];
            }
        }
        for rate in K / 2..K {
            state.covariance[(rate, rate)] = speed_mps * speed_mps;
        }
        state
    }
}
