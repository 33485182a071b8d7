//! One scan of a sensor that reports positions, ranges and bearings, or bearings alone: detection with probability P_D,
//! Gaussian noise on each value, and a Poisson number of false detections uniform over the field of view.

use super::coverage::Coverage;
use super::targets::Path;
use crate::math::rng::{Purpose, Seed};
use crate::model::scan::{Detection, Measurement};
use crate::model::scenario::{ReportNoise, ScenarioSensor};
use crate::model::state::Position;
use rand::RngExt;
use rand_distr::{Distribution, Poisson, StandardNormal};
use std::f64::consts::TAU;

/// A sensor at work.
#[derive(Clone, Copy)]
pub(super) struct Radar<'a> {
    pub sensor: &'a ScenarioSensor,
    /// Its place among the sensors of the scenario.
    pub index: usize,
    pub noise: ReportNoise,
    pub coverage: &'a Coverage,
    /// Speed of the fastest target of the scene: range rates of false detections are uniform between it and its opposite.
    pub fastest_mps: f64,
}

/// Whether a place is inside the sensor's field of view.
pub(super) fn is_in_view(sensor: &ScenarioSensor, position_m: &Position) -> bool {
    (position_m - Position::new(sensor.x_m, sensor.y_m)).norm() <= sensor.max_range_m
}

/// The detections of one scan, targets first. `seen[path]` is the index of the path's target in the recording.
pub(super) fn scan(radar: Radar, scan_index: u64, time_s: f64, paths: &[Path], seen: &[Option<u32>], seed: Seed) -> Vec<Detection> {
    let mut found = Vec::new();
    for (index, path) in paths.iter().enumerate() {
        let position_m = path.position_at(time_s);
        if radar.coverage.includes(radar.index, index) && is_in_view(radar.sensor, &position_m) {
            let entity = ((radar.index as u64) << 32) | index as u64;
            let mut draw = seed.stream(Purpose::Detection, entity, scan_index);
            if draw.random::<f64>() < radar.sensor.p_d {
                let errors: [f64; 3] = std::array::from_fn(|_| StandardNormal.sample(&mut draw));
                let measurement = radar.report(&position_m, &path.velocity_at(time_s), errors);
                found.push(Detection { measurement, origin: seen[index], amplitude: None });
            }
        }
    }
    radar.add_clutter(scan_index, seed, &mut found);
    found
}

impl Radar<'_> {
    fn add_clutter(&self, scan_index: u64, seed: Seed, found: &mut Vec<Detection>) {
        let sensor = self.sensor;
        // A mean of zero is no distribution at all: then there is no clutter.
        let Ok(count) = Poisson::new(sensor.clutter_per_scan) else { return };
        let mut draw = seed.stream(Purpose::Clutter, self.index as u64, scan_index);
        let number = count.sample(&mut draw) as u64;
        for _ in 0..number {
            let range_m = sensor.max_range_m * draw.random::<f64>().sqrt();
            let bearing_rad = TAU * draw.random::<f64>();
            let (x_m, y_m) = (sensor.x_m + range_m * bearing_rad.sin(), sensor.y_m + range_m * bearing_rad.cos());
            let measurement = match self.noise {
                ReportNoise::Position { .. } => Measurement::Position { x_m, y_m },
                ReportNoise::RangeBearing { sigma_range_rate_mps, .. } => {
                    let range_rate_mps = sigma_range_rate_mps.map(|_| self.fastest_mps * (2.0 * draw.random::<f64>() - 1.0));
                    Measurement::RangeBearing { range_m, bearing_rad, range_rate_mps }
                }
                ReportNoise::Bearing { .. } => Measurement::Bearing { bearing_rad },
            };
            found.push(Detection { measurement, origin: None, amplitude: None });
        }
    }

    /// What the sensor reports of a target, with draws of the standard normal distribution as its errors.
    fn report(&self, position_m: &Position, velocity_mps: &Position, errors: [f64; 3]) -> Measurement {
        let offset_m = position_m - Position::new(self.sensor.x_m, self.sensor.y_m);
        let seen_rad = |error_rad: f64| (offset_m[0].atan2(offset_m[1]) + error_rad).rem_euclid(TAU);
        match self.noise {
            ReportNoise::Position { sigma_x_m, sigma_y_m } => {
                Measurement::Position { x_m: position_m[0] + errors[0] * sigma_x_m, y_m: position_m[1] + errors[1] * sigma_y_m }
            }
            ReportNoise::RangeBearing { sigma_range_m, sigma_bearing_rad, sigma_range_rate_mps } => {
                // A range below 0 would be one in the opposite direction, which no sensor reports.
                let range_m = (offset_m.norm() + errors[0] * sigma_range_m).abs();
                let towards = offset_m.try_normalize(0.0).unwrap_or_else(Position::zeros);
                let range_rate_mps = sigma_range_rate_mps.map(|sigma_mps| towards.dot(velocity_mps) + errors[2] * sigma_mps);
                Measurement::RangeBearing { range_m, bearing_rad: seen_rad(errors[1] * sigma_bearing_rad), range_rate_mps }
            }
            ReportNoise::Bearing { sigma_bearing_rad } => Measurement::Bearing { bearing_rad: seen_rad(errors[0] * sigma_bearing_rad) },
        }
    }
}
