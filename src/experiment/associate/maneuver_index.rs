//! Whether one motion model is enough, told from the manoeuvre index of the scene.
//!
//! # Symbols
//! Λ manoeuvre index; σₐ acceleration that the filter allows for, constant over a scan; q its process noise; T time between scans
//! of a sensor; σ noise of a position.
//!
//! # Method
//! Λ = σₐ T² / σ with σₐ² = q / T, which gives a velocity the same variance in a scan. Above about one half several motion models
//! follow targets better than one that is let loose; below it one is as good. Of several sensors the least Λ counts.
//!
//! # Reference
//! T. Kirubarajan, Y. Bar-Shalom, Kalman Filter versus IMM Estimator: When Do We Need the Latter?, IEEE Transactions on Aerospace
//! and Electronic Systems 39(4), 2003.

use super::speeds::two_digits;
use super::track::ResolvedRecording;
use crate::experiment::input::extent::detections_of;
use crate::filtering::motions::AnyMotion;
use crate::filtering::{AnyFilter, Movement};
use crate::math::stats::quantile;
use crate::model::scan::Measurement;
use crate::model::sensing::{MeasurementModel, Moving};

/// Above it an IMM pays.
const ENOUGH: f64 = 0.5;

/// Λ of a sensor, and what it is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Index {
    value: f64,
    period_s: f64,
    sigma_m: f64,
}

/// Advice where one model of nearly constant velocity is asked to follow what several would follow better.
pub fn warning(data: &ResolvedRecording, filter: &AnyFilter) -> Option<String> {
    let (AnyFilter::Plane(places) | AnyFilter::Volume(places)) = filter else {
        return None;
    };
    let Movement::Single(AnyMotion::ConstantVelocity(motion)) = places.movement else {
        return None;
    };
    let q = motion.spectral_density;
    let indices = (0..data.sensors.len()).filter_map(|sensor| index_of(data, sensor, q));
    let least = indices.min_by(|one, other| one.value.total_cmp(&other.value))?;
    (least.value > ENOUGH).then(|| {
        format!(
            "the manoeuvre index √(q T³) / σ is {}, above {ENOUGH}, with process_noise_m2ps3 {q}, {} s between scans and noise of {} m: if targets \
             turn that much, a filter of several motion models ('method': 'imm') follows them better than one; if not, a smaller process noise fits",
            two_digits(least.value),
            two_digits(least.period_s),
            two_digits(least.sigma_m)
        )
    })
}

fn index_of(data: &ResolvedRecording, sensor: usize, q: f64) -> Option<Index> {
    let times = data
        .recording
        .scans
        .iter()
        .filter(|scan| scan.sensor == sensor)
        .map(|scan| scan.time_s);
    let times: Vec<f64> = times.collect();
    let periods = times.windows(2).map(|pair| pair[1] - pair[0]);
    let mut periods: Vec<f64> = periods.filter(|period_s| *period_s > 0.0).collect();
    periods.sort_by(f64::total_cmp);
    let period_s = quantile(&periods, 0.5)?;
    let sigma_m = sigma_of(data, sensor)?;
    Some(Index {
        value: (q * period_s.powi(3)).sqrt() / sigma_m,
        period_s,
        sigma_m,
    })
}

/// The geometric mean of the noises on the two axes, of ranges and bearings in the middle of what was seen.
fn sigma_of(data: &ResolvedRecording, sensor: usize) -> Option<f64> {
    match data.sensors[sensor].report {
        MeasurementModel::Position {
            sigma_x_m,
            sigma_y_m,
        } => Some((sigma_x_m * sigma_y_m).sqrt()),
        MeasurementModel::Polar(polar) | MeasurementModel::Converted(polar) => {
            across(data, sensor, (polar.sigma_range_m, polar.sigma_bearing_rad))
        }
        MeasurementModel::Position3 { sigmas_m, .. }
        | MeasurementModel::Moving(Moving { sigmas_m, .. }) => {
            Some((sigmas_m[0] * sigmas_m[1]).sqrt())
        }
        MeasurementModel::Spherical(spherical)
        | MeasurementModel::ConvertedSpherical(spherical) => across(
            data,
            sensor,
            (spherical.sigma_range_m, spherical.sigma_bearing_rad),
        ),
        MeasurementModel::Bearing(_) | MeasurementModel::Sight(_) => None,
    }
}

/// Of ranges and bearings.
fn across(
    data: &ResolvedRecording,
    sensor: usize,
    (sigma_range_m, sigma_bearing_rad): (f64, f64),
) -> Option<f64> {
    let ranges = detections_of(data.recording, sensor).filter_map(|detection| {
        match detection.measurement.flat() {
            Measurement::RangeBearing { range_m, .. } => Some(range_m),
            _ => None,
        }
    });
    let mut ranges_m: Vec<f64> = ranges.collect();
    ranges_m.sort_by(f64::total_cmp);
    let range_m = quantile(&ranges_m, 0.5)?;
    Some((sigma_range_m * range_m * sigma_bearing_rad).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scan::{Detection, Recording, RecordingParts, Scan};
    use crate::model::sensor::{Sensor, SensorSettings};

    fn told(process_noise_m2ps3: f64) -> Option<String> {
        let scan = |index: u32| Scan {
            number: index + 1,
            time_s: 4.0 * f64::from(index),
            sensor: 0,
            pose: None,
            own: Vec::new(),
            detections: vec![Detection {
                measurement: Measurement::Position {
                    x_m: f64::from(index),
                    y_m: 0.0,
                },
                origin: None,
                amplitude: None,
            }],
        };
        let known = [SensorSettings::named("radar")];
        let recording = Recording::new(RecordingParts {
            sensors: known.to_vec(),
            scans: (0..3).map(scan).collect(),
            detection_ids: (0..3).map(|index| index.to_string()).collect(),
            ..RecordingParts::default()
        })
        .unwrap();
        let data = ResolvedRecording {
            recording: &recording,
            known: &known,
            sensors: &[Sensor::of_positions(&known[0], 40.0)],
        };
        warning(&data, &AnyFilter::kalman(process_noise_m2ps3))
    }

    #[test]
    fn the_index_is_that_worked_by_hand() {
        // √(25 · 4³) / 40 = 1; √(6 · 64) / 40 = 0.49.
        let warning = told(25.0).unwrap();
        assert!(
            warning.contains("is 1, above 0.5") && warning.contains("4 s between"),
            "{warning}"
        );
        assert_eq!(told(6.0), None);
    }
}
