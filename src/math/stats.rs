//! Means and their intervals: Student's t for means, Wilson's score for shares, and the bootstrap for what is neither.
//!
//! # Reference
//! Student, The probable error of a mean, Biometrika 6, 1908; E. B. Wilson, Probable inference, the law of succession, and
//! statistical inference, J. American Statistical Association 22, 1927; B. Efron, R. J. Tibshirani, An Introduction to the
//! Bootstrap, 1993, section 13.3 (percentile interval).
//!
//! # Symbols
//! n values, x̄ their mean, s their standard deviation (n − 1); p̂ a share; z, t quantiles at (1 + confidence) / 2.

use rand::RngExt;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    pub low: f64,
    pub high: f64,
}

/// x̄; `None` of no values.
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// s; `None` of fewer than two values.
pub fn standard_deviation(values: &[f64]) -> Option<f64> {
    let mean = mean(values).filter(|_| values.len() > 1)?;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    Some((squares / (values.len() - 1) as f64).sqrt())
}

/// x̄ ± t s / √n with n − 1 degrees of freedom: of a mean of values that are nearly normal, or many. `None` of fewer than two.
pub fn t_interval(values: &[f64], confidence: f64) -> Option<Interval> {
    let (mean, deviation) = (mean(values)?, standard_deviation(values)?);
    let students = StudentsT::new(0.0, 1.0, (values.len() - 1) as f64).ok()?;
    let half = students.inverse_cdf(0.5 + confidence / 2.0) * deviation / (values.len() as f64).sqrt();
    Some(Interval { low: mean - half, high: mean + half })
}

/// (p̂ + z²/2n ± z √(p̂(1 − p̂)/n + z²/4n²)) / (1 + z²/n): of the probability behind a share of `n` trials. `None` of none.
pub fn wilson_interval(successes: f64, n: usize, confidence: f64) -> Option<Interval> {
    if n == 0 {
        return None;
    }
    let (n, z) = (n as f64, Normal::standard().inverse_cdf(0.5 + confidence / 2.0));
    let (share, z2) = (successes / n, z * z);
    let centre = share + z2 / (2.0 * n);
    let half = z * (share * (1.0 - share) / n + z2 / (4.0 * n * n)).sqrt();
    let scale = 1.0 + z2 / n;
    Some(Interval { low: ((centre - half) / scale).max(0.0), high: ((centre + half) / scale).min(1.0) })
}

/// Resamples of a bootstrap.
const RESAMPLES: usize = 2000;

/// The quantiles of the means of 2 000 resamples drawn with replacement. `None` of fewer than two values.
pub fn bootstrap_interval(values: &[f64], confidence: f64, draw: &mut impl RngExt) -> Option<Interval> {
    if values.len() < 2 {
        return None;
    }
    let resampled = |_| (0..values.len()).map(|_| values[draw.random_range(0..values.len())]).sum::<f64>() / values.len() as f64;
    let mut means: Vec<f64> = (0..RESAMPLES).map(resampled).collect();
    means.sort_by(f64::total_cmp);
    Some(Interval { low: quantile(&means, 0.5 - confidence / 2.0)?, high: quantile(&means, 0.5 + confidence / 2.0)? })
}

/// The quantile of sorted values, on the line between its two neighbours; `None` of none.
pub fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let place = share.clamp(0.0, 1.0) * sorted.len().checked_sub(1)? as f64;
    let (below, above) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
    Some(below + (above - below) * place.fract())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::{Purpose, Seed};
    use rand_distr::{Distribution, StandardNormal};

    fn assert_interval(found: Option<Interval>, low: f64, high: f64) {
        let found = found.unwrap();
        assert!((found.low - low).abs() < 1e-4 && (found.high - high).abs() < 1e-4, "{found:?}");
    }

    #[test]
    fn intervals_by_hand() {
        // 1, 2, 3, 4, 5: mean 3, s² = 10/4, t(0.975; 4) = 2.77645: 3 ± 2.77645 · 1.58114 / 2.23607.
        let values = [1.0, 2.0, 3.0, 4.0, 5.0];
        assert_interval(t_interval(&values, 0.95), 1.036_757, 4.963_243);
        // 8 of 10 at 95 %, z² = 3.84146: (0.8 + 0.192073 ± 1.95996 √(0.016 + 0.0096036)) / 1.384146.
        assert_interval(wilson_interval(8.0, 10, 0.95), 0.490_162, 0.943_318);
        assert_interval(wilson_interval(0.0, 10, 0.95), 0.0, 0.277_533);
        assert_eq!((t_interval(&[1.0], 0.95), wilson_interval(0.0, 0, 0.95), mean(&[])), (None, None, None));
        assert_eq!((quantile(&values, 0.5), quantile(&values, 0.875), quantile(&[], 0.5)), (Some(3.0), Some(4.5), None));
    }

    #[test]
    fn a_t_interval_of_a_normal_mean_covers_it_as_often_as_it_says() {
        let mut draw = Seed { seed: 1, run: 0 }.stream(Purpose::Bootstrap, 0, 0);
        let mut covered = 0;
        for _ in 0..20_000 {
            let values: [f64; 30] = std::array::from_fn(|_| StandardNormal.sample(&mut draw));
            covered += u32::from(t_interval(&values, 0.95).is_some_and(|interval| interval.low <= 0.0 && 0.0 <= interval.high));
        }
        let share = f64::from(covered) / 20_000.0;
        assert!((0.945..0.955).contains(&share), "{share}");
    }

    #[test]
    fn a_bootstrap_of_a_normal_mean_covers_it_nearly_as_often() {
        let mut draw = Seed { seed: 2, run: 0 }.stream(Purpose::Bootstrap, 0, 0);
        let mut covered = 0;
        for _ in 0..400 {
            let values: [f64; 40] = std::array::from_fn(|_| StandardNormal.sample(&mut draw));
            let interval = bootstrap_interval(&values, 0.95, &mut draw).unwrap();
            covered += u32::from(interval.low <= 0.0 && 0.0 <= interval.high);
        }
        // The percentile interval of 40 values is a little too narrow: about 94 %; four standard deviations are 4.5 points.
        assert!((0.89..0.985).contains(&(f64::from(covered) / 400.0)), "{covered}");
    }

    #[test]
    fn a_wilson_interval_covers_a_probability_as_the_binomial_distribution_says() {
        // The coverage at n = 100, summed over the binomial distribution, averaged over probabilities from 0.1 to 0.9.
        let n = 100;
        let coverage = |p: f64| {
            let mut probability = (1.0 - p).powi(n);
            let mut covered = 0.0;
            for successes in 0..=n {
                let interval = wilson_interval(f64::from(successes), n as usize, 0.95).unwrap();
                covered += if interval.low <= p && p <= interval.high { probability } else { 0.0 };
                probability *= f64::from(n - successes) / f64::from(successes + 1) * p / (1.0 - p);
            }
            covered
        };
        let shares: Vec<f64> = (0..81).map(|step| coverage(0.1 + 0.01 * f64::from(step))).collect();
        let average = mean(&shares).unwrap();
        assert!((0.94..0.96).contains(&average), "{average}");
        assert!(shares.iter().all(|share| (0.92..0.98).contains(share)), "{shares:?}");
    }
}
