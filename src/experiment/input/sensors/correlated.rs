//! Errors that persist from report to report: a tracker that takes them to be independent trusts a fast sensor too much.
//!
//! # Symbols
//! T time from scan to scan of the sensor; τ time after which an error is forgotten to 1/e; ρ = e^(−T/τ).
//!
//! # Method
//! The mean of n reports whose errors have the variance σ² and the correlation ρᵏ over k scans has the variance
//! σ² (1 + ρ) / (n (1 − ρ)) for large n. With σ² times that factor, independent errors say as much.

use crate::model::scan::{Recording, Scan};
use crate::model::sensor::SensorSettings;
use std::borrow::Cow;

/// What the noise of a sensor is multiplied with, and that this was done.
pub(super) fn inflation(
    recording: &Recording,
    index: usize,
    settings: &SensorSettings,
    warnings: &mut Vec<String>,
) -> f64 {
    let Some((correlation_s, period_s)) =
        settings.error_correlation_s.zip(period_s(recording, index))
    else {
        return 1.0;
    };
    let factor = factor(period_s, correlation_s);
    warnings.push(format!(
        "sensor '{}': its noise counts {factor:.2} times, for errors that persist for {correlation_s} s at a scan each {period_s:.3} s",
        settings.sensor_id
    ));
    factor
}

/// The recording with the noises that detections have of their own counted likewise.
pub fn with_own_noises<'r>(
    recording: Cow<'r, Recording>,
    known: &[SensorSettings],
) -> Cow<'r, Recording> {
    let mut factors = vec![1.0; known.len()];
    for (index, settings) in known.iter().enumerate() {
        let tells = |scan: &Scan| scan.sensor == index && !scan.own.is_empty();
        if recording.scans.iter().any(tells) {
            factors[index] = inflation(&recording, index, settings, &mut Vec::new());
        }
    }
    if factors.iter().all(|factor| *factor == 1.0) {
        return recording;
    }
    let mut parts = recording.clone().into_owned().into_parts();
    for scan in &mut parts.scans {
        for own in &mut scan.own {
            own.noise = own.noise.scaled(factors[scan.sensor]);
        }
    }
    // What was sound stays so.
    Recording::new(parts).map_or(recording, Cow::Owned)
}

/// √((1 + ρ) / (1 − ρ)).
fn factor(period_s: f64, correlation_s: f64) -> f64 {
    let lost = (-period_s / correlation_s).exp_m1();
    ((2.0 + lost) / -lost).sqrt()
}

/// The median time between scans of a sensor.
fn period_s(recording: &Recording, index: usize) -> Option<f64> {
    let scans = recording.scans.iter().filter(|scan| scan.sensor == index);
    let times_s: Vec<f64> = scans.map(|scan| scan.time_s).collect();
    let mut periods_s: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    periods_s.sort_by(f64::total_cmp);
    periods_s.get(periods_s.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::{Purpose, Seed};
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn the_mean_of_errors_that_persist_has_the_stated_variance() {
        // 400 means of 500 errors each, ρ = e^(−1/4): the variance of a mean is 8.04 times that of independent ones.
        let rho = (-0.25f64).exp();
        let mut draw = Seed { seed: 6, run: 0 }.stream(Purpose::Detection, 0, 0);
        let (mut square, runs, count) = (0.0, 400, 500);
        for _ in 0..runs {
            let mut error: f64 = StandardNormal.sample(&mut draw);
            let mut sum = 0.0;
            for _ in 0..count {
                sum += error;
                let fresh: f64 = StandardNormal.sample(&mut draw);
                error = rho * error + (1.0 - rho * rho).sqrt() * fresh;
            }
            square += sum * sum / f64::from(count);
        }
        let wanted = factor(0.25, 1.0).powi(2);
        assert!((wanted - (1.0 + rho) / (1.0 - rho)).abs() < 1e-12);
        // A variance of 400 draws is known to 7 %.
        let found = square / f64::from(runs);
        assert!((found / wanted - 1.0).abs() < 0.21, "{found} {wanted}");
        assert!((factor(10.0, 0.1) - 1.0).abs() < 1e-12);
    }
}
