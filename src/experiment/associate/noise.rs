//! Whether the noise that a tracker assumes fits its data, told from the normalised innovations squared (NIS) of its updates.
//!
//! # Symbols
//! D numbers of a measurement; γ threshold of the gate; F(k) probability that a chi-square variable of k degrees of freedom is
//! below γ; N updates.
//!
//! # Method
//! 1. A gate cuts the chi-square variable off at γ: its mean is D F(D + 2) / F(D), its second moment D (D + 2) F(D + 4) / F(D).
//! 2. The mean of N updates lies within 1.96 standard deviations of that with a probability of 95 %.
//! 3. NIS goes with 1/σ²: the σ that would fit is the square root of mean / due mean times the assumed one. Where that is less than
//!    a tenth away nothing is said, for with many updates every interval is narrow.

use super::estimates::three_digits;
use super::report::NisReport;
use crate::math::gaussian::{chi_square_tail, gate_threshold};
use crate::model::sensing::{MeasurementModel, Spherical};
use crate::model::sensor::Sensor;

/// Fewer updates say nothing.
const FEWEST_UPDATES: u64 = 10;

/// A warning where the mean NIS says that the noise is assumed too large or too small, with the values that would fit. Nothing is
/// said of reports of different numbers of values.
pub fn warning(nis: &NisReport, gate_probability: f64, sensors: &[Sensor]) -> Option<String> {
    let (mean, updates) = (nis.mean?, nis.updates);
    let (due, variance) = gated_chi_square(nis.dimensions? as u32, gate_probability);
    let half = 1.96 * (variance / updates as f64).sqrt();
    let factor = (mean / due).sqrt();
    if updates < FEWEST_UPDATES || (mean - due).abs() <= half || (factor - 1.0).abs() <= 0.1 {
        return None;
    }
    let what = if mean < due {
        "the noise is assumed too large"
    } else {
        "the noise, or how much targets turn, is assumed too small"
    };
    let values = match sensors {
        [sensor] => format!(": {}", fitting(&sensor.report, factor)),
        _ => String::new(),
    };
    Some(format!(
        "mean NIS {mean:.2} of {updates} updates, {due:.2} is due within the gate ({:.2} to {:.2} with 95 %): {what}; sigma × {factor:.2} \
         would fit{values}",
        due - half,
        due + half
    ))
}

/// The noises of a sensor, each times `factor`.
fn fitting(report: &MeasurementModel, factor: f64) -> String {
    let named = |name: &str, sigma: f64| format!("{name} {}", three_digits(factor * sigma));
    match report {
        MeasurementModel::Position {
            sigma_x_m,
            sigma_y_m,
        } => format!(
            "{}, {}",
            named("sigma_x_m", *sigma_x_m),
            named("sigma_y_m", *sigma_y_m)
        ),
        MeasurementModel::Polar(polar) | MeasurementModel::Converted(polar) => {
            let bearing_deg = polar.sigma_bearing_rad.to_degrees();
            let places = format!(
                "{}, {}",
                named("sigma_range_m", polar.sigma_range_m),
                named("sigma_bearing_deg", bearing_deg)
            );
            match polar.range_rate {
                Some(rate) => format!(
                    "{places}, {}",
                    named("sigma_range_rate_mps", rate.sigma_mps)
                ),
                None => places,
            }
        }
        MeasurementModel::Bearing(bearing) => {
            named("sigma_bearing_deg", bearing.sigma_bearing_rad.to_degrees())
        }
        MeasurementModel::Moving(moving) => {
            let [x_m, y_m, z_m] = moving.sigmas_m;
            let mut all = vec![named("sigma_x_m", x_m), named("sigma_y_m", y_m)];
            all.extend(moving.is_in_volume.then(|| named("sigma_z_m", z_m)));
            all.push(named("sigma_speed_mps", moving.velocity.sigma_speed_mps));
            let course_rad = moving.velocity.sigma_course_rad;
            all.extend(course_rad.map(|sigma| named("sigma_course_deg", sigma.to_degrees())));
            all.join(", ")
        }
        MeasurementModel::Position3 { sigmas_m, .. } => ["sigma_x_m", "sigma_y_m", "sigma_z_m"]
            .iter()
            .zip(sigmas_m)
            .map(|(name, sigma_m)| named(name, *sigma_m))
            .collect::<Vec<_>>()
            .join(", "),
        MeasurementModel::Spherical(spherical)
        | MeasurementModel::ConvertedSpherical(spherical) => {
            let range = named("sigma_range_m", spherical.sigma_range_m);
            [range, angles(spherical, named)].join(", ")
        }
        MeasurementModel::Sight(spherical) => angles(spherical, named),
    }
}

/// The noises of bearings, and of elevations where they are measured.
fn angles(spherical: &Spherical, named: impl Fn(&str, f64) -> String) -> String {
    let bearing = named(
        "sigma_bearing_deg",
        spherical.sigma_bearing_rad.to_degrees(),
    );
    match spherical.sigma_elevation_rad {
        Some(sigma_rad) => {
            let elevation = named("sigma_elevation_deg", sigma_rad.to_degrees());
            format!("{bearing}, {elevation}")
        }
        None => bearing,
    }
}

/// Step 1: mean and variance.
pub fn gated_chi_square(dimensions: u32, gate_probability: f64) -> (f64, f64) {
    let degrees = f64::from(dimensions);
    let threshold = gate_threshold(gate_probability, dimensions);
    if threshold.is_infinite() {
        return (degrees, 2.0 * degrees);
    }
    let below = |degrees: f64| 1.0 - chi_square_tail(threshold, degrees);
    let mean = degrees * below(degrees + 2.0) / below(degrees);
    (
        mean,
        degrees * (degrees + 2.0) * below(degrees + 4.0) / below(degrees) - mean * mean,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::sensor::SensorSettings;

    #[test]
    fn a_gate_lowers_the_mean_as_worked_by_hand() {
        // Two degrees of freedom, γ = −2 ln 0.01 = 9.21034: E = 2 − γ · 0.01 / 0.99.
        let (mean, variance) = gated_chi_square(2, 0.99);
        assert!(
            (mean - (2.0 - 9.210_340_372 * 0.01 / 0.99)).abs() < 1e-9,
            "{mean}"
        );
        // E[x²] = 8 − (γ² + 4γ) · 0.01 / 0.99.
        let second = 8.0 - (9.210_340_372f64.powi(2) + 4.0 * 9.210_340_372) * 0.01 / 0.99;
        assert!(
            (variance - (second - mean * mean)).abs() < 1e-8,
            "{variance}"
        );
        assert_eq!(gated_chi_square(3, 1.0), (3.0, 6.0));
    }

    /// Of reports of two values, without a gate.
    fn of_two(mean: f64, updates: u64) -> Option<String> {
        let nis = NisReport {
            mean: Some(mean),
            updates,
            dimensions: Some(2),
        };
        warning(&nis, 1.0, &[])
    }

    #[test]
    fn the_values_that_would_fit_are_named() {
        let nis = NisReport {
            mean: Some(8.0),
            updates: 400,
            dimensions: Some(2),
        };
        let sensor = Sensor::of_positions(&SensorSettings::named("radar"), 6.0);
        let told = warning(&nis, 1.0, std::slice::from_ref(&sensor)).unwrap();
        assert!(
            told.ends_with("sigma × 2.00 would fit: sigma_x_m 12, sigma_y_m 12"),
            "{told}"
        );
    }

    #[test]
    fn the_sigma_that_would_fit_is_named_outside_the_interval_alone() {
        // √(0.31 / 2) = 0.39; 1.96 · √(4 / 400) = 0.196.
        let told = "mean NIS 0.31 of 400 updates, 2.00 is due within the gate (1.80 to 2.20 with 95 %): the noise is assumed too large; \
                    sigma × 0.39 would fit";
        assert_eq!(of_two(0.31, 400).as_deref(), Some(told));
        assert!(
            of_two(5.0, 400)
                .unwrap()
                .contains("is assumed too small; sigma × 1.58 would fit")
        );
        assert_eq!(
            [of_two(2.15, 400), of_two(1.9, 1_000_000), of_two(0.3, 9)],
            [None, None, None]
        );
    }
}
