//! The noise of reports from three of one target in a row: what of the third a straight course through the first two does not
//! explain is noise, whatever the filter assumes of motions.
//!
//! # Symbols
//! z₁, z₂, z₃ one value of three reports; ρ ratio of the second time between them to the first; e = z₃ − z₂ − ρ (z₂ − z₁).
//!
//! # Method
//! e has the variance σ² (1 + (1 + ρ)² + ρ²). Of |e| over the root of that sum the median is 0.6745 σ, and wrong reports and
//! turns among them hardly move it. What lies within 2.5 of that σ tells it better: the root of its mean square is 0.9546 σ, and
//! this is done twice.

use crate::math::stats::{quantile, standard_deviation};
use crate::model::angle::wrap;
use crate::model::scan::Measurement;

/// Median of the absolute value of a standard normal variable.
const MEDIAN: f64 = 0.674_489_75;
/// What is farther out than so many σ is no noise, and the root of the mean square of the rest.
const FARTHEST: f64 = 2.5;
const WITHIN: f64 = 0.954_598;
/// The lower fifth of it.
const LOWER_FIFTH: f64 = 0.253_347_1;
/// Beyond this ratio of times, either way, three reports say little.
const MOST_UNEVEN: f64 = 3.0;
/// Parts of which the scatter of the estimate is told.
const PARTS: usize = 8;

/// The values of a report: x and y, or range, bearing and range rate, or a bearing.
pub const MOST_VALUES: usize = 4;

/// A report at a time.
#[derive(Debug, Clone, Copy)]
pub struct Seen {
    pub time_s: f64,
    pub report: Measurement,
}

/// Residuals of each value, in the order of time.
#[derive(Debug, Clone, Default)]
pub struct Residuals {
    of: [Vec<f64>; MOST_VALUES],
}

/// A standard deviation that was estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sigma {
    pub value: f64,
    pub standard_error: f64,
    /// Of so many residuals.
    pub count: usize,
}

impl Residuals {
    /// One triple of reports of one target.
    pub fn add(&mut self, triple: [&Seen; 3]) {
        let [first, second, third] = triple;
        let before_s = second.time_s - first.time_s;
        let after_s = third.time_s - second.time_s;
        let ratio = after_s / before_s;
        if before_s <= 0.0 || !(1.0 / MOST_UNEVEN..=MOST_UNEVEN).contains(&ratio) {
            return;
        }
        let scale = (1.0 + (1.0 + ratio).powi(2) + ratio * ratio).sqrt();
        let values = triple.map(|seen| values_of(&seen.report));
        for axis in 0..MOST_VALUES {
            let [Some(first), Some(second), Some(third)] = values.map(|values| values[axis]) else {
                continue;
            };
            let is_angle = is_angle(&triple[0].report, axis);
            let (step, next) = (second - first, third - second);
            let (step, next) = if is_angle {
                (wrap(step), wrap(next))
            } else {
                (step, next)
            };
            self.of[axis].push(((next - ratio * step) / scale).abs());
        }
    }

    /// The noise of one value; `None` of none.
    pub fn sigma(&self, axis: usize) -> Option<Sigma> {
        let residuals = &self.of[axis];
        let value = scale(residuals)?;
        let length = residuals.len().div_ceil(PARTS).max(1);
        let of_parts: Vec<f64> = residuals.chunks(length).filter_map(scale).collect();
        let scatter = standard_deviation(&of_parts).unwrap_or(value);
        Some(Sigma {
            value,
            standard_error: scatter / (of_parts.len() as f64).sqrt(),
            count: residuals.len(),
        })
    }

    /// The same where most of the triples are of no target: by the smallest fifth.
    pub fn least_sigma(&self, axis: usize) -> Option<f64> {
        scaled_quantile(&self.of[axis], 0.2, LOWER_FIFTH)
    }
}

/// σ of absolute values of which most are noise.
fn scale(absolute: &[f64]) -> Option<f64> {
    let mut sigma = scaled_quantile(absolute, 0.5, MEDIAN)?;
    for _ in 0..2 {
        let (mut sum, mut count) = (0.0, 0.0);
        for value in absolute.iter().filter(|value| **value <= FARTHEST * sigma) {
            sum += value * value;
            count += 1.0;
        }
        let within: f64 = sum / f64::max(count, 1.0);
        if within > 0.0 {
            sigma = within.sqrt() / WITHIN;
        }
    }
    Some(sigma)
}

/// σ by a quantile of absolute values, or by their mean where that is 0: values may be whole numbers.
fn scaled_quantile(absolute: &[f64], share: f64, of_standard: f64) -> Option<f64> {
    let mut sorted = absolute.to_vec();
    sorted.sort_by(f64::total_cmp);
    let found = quantile(&sorted, share)? / of_standard;
    let mean = absolute.iter().sum::<f64>() / absolute.len() as f64;
    Some(if found > 0.0 { found } else { mean * 1.2533 })
}

fn values_of(report: &Measurement) -> [Option<f64>; MOST_VALUES] {
    match *report {
        Measurement::Position { x_m, y_m } => [Some(x_m), Some(y_m), None, None],
        Measurement::Position3 { x_m, y_m, z_m } => [Some(x_m), Some(y_m), Some(z_m), None],
        Measurement::RangeBearingElevation {
            range_m,
            bearing_rad,
            elevation_rad,
            range_rate_mps,
        } => [
            Some(range_m),
            Some(bearing_rad),
            Some(elevation_rad),
            range_rate_mps,
        ],
        Measurement::BearingElevation {
            bearing_rad,
            elevation_rad,
        } => [Some(bearing_rad), Some(elevation_rad), None, None],
        Measurement::RangeBearing {
            range_m,
            bearing_rad,
            range_rate_mps,
        } => [Some(range_m), Some(bearing_rad), range_rate_mps, None],
        Measurement::Bearing { bearing_rad } => [Some(bearing_rad), None, None, None],
    }
}

fn is_angle(report: &Measurement, axis: usize) -> bool {
    match report {
        Measurement::Position { .. } | Measurement::Position3 { .. } => false,
        Measurement::RangeBearing { .. } | Measurement::RangeBearingElevation { .. } => axis == 1,
        Measurement::Bearing { .. } | Measurement::BearingElevation { .. } => axis == 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::{Purpose, Seed};
    use rand::RngExt;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn noise_is_told_whatever_the_course_and_the_times_are() {
        let mut draw = Seed { seed: 5, run: 0 }.stream(Purpose::Detection, 0, 0);
        let (mut residuals, mut time_s, mut seen) = (Residuals::default(), 0.0, Vec::new());
        for _ in 0..4000 {
            time_s += draw.random_range(1.0..2.0);
            let errors: [f64; 2] = std::array::from_fn(|_| StandardNormal.sample(&mut draw));
            seen.push(Seen {
                time_s,
                report: Measurement::RangeBearing {
                    range_m: 5e4 - 20.0 * time_s + 30.0 * errors[0],
                    bearing_rad: 3.0 + 0.001 * time_s + 0.01 * errors[1],
                    range_rate_mps: None,
                },
            });
        }
        for triple in seen.windows(3) {
            residuals.add([&triple[0], &triple[1], &triple[2]]);
        }
        for (axis, wanted) in [(0, 30.0), (1, 0.01)] {
            let found = residuals.sigma(axis).unwrap();
            // Three neighbours share reports: as good as about 1 300 values, σ / √(2 · 1 300).
            assert!((found.value / wanted - 1.0).abs() < 0.06, "{found:?}");
            assert!(
                (found.value - wanted).abs() < 4.0 * found.standard_error,
                "{found:?}"
            );
            assert!(
                found.standard_error < 0.05 * wanted && found.count == 3998,
                "{found:?}"
            );
        }
        assert_eq!(residuals.sigma(2), None);
    }

    #[test]
    fn one_wrong_report_in_ten_hardly_moves_it() {
        let mut draw = Seed { seed: 6, run: 0 }.stream(Purpose::Detection, 0, 0);
        let (mut residuals, mut seen) = (Residuals::default(), Vec::new());
        for index in 0..3000 {
            let error: f64 = StandardNormal.sample(&mut draw);
            let wild = if index % 10 == 0 { 500.0 } else { 0.0 };
            seen.push(Seen {
                time_s: f64::from(index),
                report: Measurement::Position {
                    x_m: 4.0 * error + wild,
                    y_m: 0.0,
                },
            });
        }
        for triple in seen.windows(3) {
            residuals.add([&triple[0], &triple[1], &triple[2]]);
        }
        // Three of ten residuals hold a wrong report, and lie farther out than any noise.
        let found = residuals.sigma(0).unwrap().value;
        assert!((found - 4.0).abs() < 0.4, "{found}");
        assert_eq!(residuals.sigma(1).unwrap().value, 0.0, "what never errs");
    }
}
