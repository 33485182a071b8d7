//! One scan of a sensor that reports positions: detection with probability P_D, Gaussian noise on x and y, and a
//! Poisson number of false detections uniform over the field of view.

use super::targets::Path;
use crate::math::rng::{Purpose, Seed};
use crate::model::scan::{Detection, Measurement};
use crate::model::scenario::ScenarioSensor;
use crate::model::state::Position;
use rand::RngExt;
use rand_distr::{Distribution, Poisson, StandardNormal};

/// Whether a place is inside the sensor's field of view.
pub(super) fn is_in_view(sensor: &ScenarioSensor, position_m: &Position) -> bool {
    (position_m - Position::new(sensor.x_m, sensor.y_m)).norm() <= sensor.max_range_m
}

/// The detections of one scan, targets first. `seen[path]` is the index of the path's target in the recording.
pub(super) fn scan(
    sensor: &ScenarioSensor,
    sensor_index: u64,
    scan_index: u64,
    time_s: f64,
    paths: &[Path],
    seen: &[Option<u32>],
    seed: Seed,
) -> Vec<Detection> {
    let mut found = Vec::new();
    for (index, path) in paths.iter().enumerate() {
        let position_m = path.position_at(time_s);
        if is_in_view(sensor, &position_m) {
            let entity = (sensor_index << 32) | index as u64;
            let mut draw = seed.stream(Purpose::Detection, entity, scan_index);
            if draw.random::<f64>() < sensor.p_d {
                let (noise_x, noise_y): (f64, f64) = (StandardNormal.sample(&mut draw), StandardNormal.sample(&mut draw));
                let (x_m, y_m) = (position_m[0] + noise_x * sensor.sigma_x_m, position_m[1] + noise_y * sensor.sigma_y_m);
                found.push(Detection { measurement: Measurement::Position { x_m, y_m }, origin: seen[index], amplitude: None });
            }
        }
    }
    add_clutter(sensor, sensor_index, scan_index, seed, &mut found);
    found
}

fn add_clutter(sensor: &ScenarioSensor, sensor_index: u64, scan_index: u64, seed: Seed, found: &mut Vec<Detection>) {
    // A mean of zero is no distribution at all: then there is no clutter.
    let Ok(count) = Poisson::new(sensor.clutter_per_scan) else { return };
    let mut draw = seed.stream(Purpose::Clutter, sensor_index, scan_index);
    let number = count.sample(&mut draw) as u64;
    for _ in 0..number {
        let range_m = sensor.max_range_m * draw.random::<f64>().sqrt();
        let bearing_rad = std::f64::consts::TAU * draw.random::<f64>();
        let (x_m, y_m) = (sensor.x_m + range_m * bearing_rad.sin(), sensor.y_m + range_m * bearing_rad.cos());
        found.push(Detection { measurement: Measurement::Position { x_m, y_m }, origin: None, amplitude: None });
    }
}
