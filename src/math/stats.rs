//! Means and their intervals: Student's t for means, Wilson's score for shares, and the bootstrap for what is neither.
//!
//! # Reference
//! Student, The probable error of a mean, Biometrika 6, 1908; E. B. Wilson, Probable inference, the law of succession, and
//! statistical inference, J. American Statistical Association 22, 1927; B. Efron, R. J. Tibshirani, An Introduction to the
//! Bootstrap, 1993, section 13.3 (percentile interval); T. C. Hesterberg, What teachers should know about the bootstrap, The American
//! Statistician 69, 2015, section 4 (percentiles farther out for few values); N. R. Draper, H. Smith, Applied Regression Analysis,
//! 1998, section 1.4 (interval of a slope); E. L. Korn, B. I. Graubard, Confidence intervals for proportions with small expected number
//! of positive counts estimated from survey data, Survey Methodology 24, 1998 (effective number of trials); C. Franco, R. J. A. Little,
//! T. A. Louis, E. V. Slud, Comparative study of confidence intervals for proportions in complex sample surveys, J. Survey Statistics
//! and Methodology 7, 2019 (Wilson's form with it).
//!
//! # Symbols
//! n values, x̄ their mean, s their standard deviation (n − 1); p̂ a share; Φ the normal distribution; z, t quantiles at
//! (1 + confidence) / 2.

use rand::RngExt;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
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
    let half =
        students.inverse_cdf(0.5 + confidence / 2.0) * deviation / (values.len() as f64).sqrt();
    Some(Interval {
        low: mean - half,
        high: mean + half,
    })
}

/// Of a mean that lies between two bounds: the t interval, and where that reaches beyond them Wilson's form with as many trials as would
/// vary so: |p̂ − p| = t √(p(1 − p)/n*), n* = p̂(1 − p̂) n / s², over values scaled to 0 … 1. `None` of fewer than two.
pub fn bounded_interval(values: &[f64], bounds: Interval, confidence: f64) -> Option<Interval> {
    let plain = t_interval(values, confidence)?;
    if plain.low >= bounds.low && plain.high <= bounds.high {
        return Some(plain);
    }
    let length = bounds.high - bounds.low;
    let share = ((plain.low + plain.high) / 2.0 - bounds.low) / length;
    let variance = ((plain.high - plain.low) / 2.0 / length).powi(2);
    let over_trials = variance / (share * (1.0 - share));
    let centre = (share + over_trials / 2.0) / (1.0 + over_trials);
    let half = (variance + over_trials * over_trials / 4.0).sqrt() / (1.0 + over_trials);
    let place = |share: f64| (bounds.low + share * length).clamp(bounds.low, bounds.high);
    Some(Interval {
        low: place(centre - half),
        high: place(centre + half),
    })
}

/// (p̂ + z²/2n ± z √(p̂(1 − p̂)/n + z²/4n²)) / (1 + z²/n): of the probability behind a share of `n` trials. `None` of none.
pub fn wilson_interval(successes: f64, n: usize, confidence: f64) -> Option<Interval> {
    if n == 0 {
        return None;
    }
    let (n, z) = (
        n as f64,
        Normal::standard().inverse_cdf(0.5 + confidence / 2.0),
    );
    let (share, z2) = (successes / n, z * z);
    let centre = share + z2 / (2.0 * n);
    let half = z * (share * (1.0 - share) / n + z2 / (4.0 * n * n)).sqrt();
    let scale = 1.0 + z2 / n;
    Some(Interval {
        low: ((centre - half) / scale).max(0.0),
        high: ((centre + half) / scale).min(1.0),
    })
}

/// Resamples of a bootstrap.
const RESAMPLES: usize = 2000;

/// The quantiles of the means of 2 000 resamples drawn with replacement, at Φ(∓t √(n/(n − 1))) instead of (1 ∓ confidence) / 2: resamples
/// of few values vary too little, by √((n − 1)/n) and by what t is above z. `None` of fewer than two values.
pub fn bootstrap_interval(
    values: &[f64],
    confidence: f64,
    draw: &mut impl RngExt,
) -> Option<Interval> {
    let degrees = values.len().checked_sub(1)? as f64;
    let students = StudentsT::new(0.0, 1.0, degrees).ok()?;
    let tail = Normal::standard().cdf(
        -students.inverse_cdf(0.5 + confidence / 2.0) * (values.len() as f64 / degrees).sqrt(),
    );
    let resampled = |_| {
        (0..values.len())
            .map(|_| values[draw.random_range(0..values.len())])
            .sum::<f64>()
            / values.len() as f64
    };
    let mut means: Vec<f64> = (0..RESAMPLES).map(resampled).collect();
    means.sort_by(f64::total_cmp);
    Some(Interval {
        low: quantile(&means, tail)?,
        high: quantile(&means, 1.0 - tail)?,
    })
}

/// The slope of a line through points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Slope {
    pub slope: f64,
    pub interval: Interval,
}

/// b = Σ(x − x̄)(y − ȳ) / Σ(x − x̄)² of the least-squares line through points (x, y), b ± t √(Σ residual² / (n − 2) / Σ(x − x̄)²) with n − 2
/// degrees of freedom. `None` of fewer than three points, and where all have one x.
pub fn slope(points: &[(f64, f64)], confidence: f64) -> Option<Slope> {
    let degrees = points.len().checked_sub(2)? as f64;
    let students = StudentsT::new(0.0, 1.0, degrees).ok()?;
    let column = |of: fn(&(f64, f64)) -> f64| mean(&points.iter().map(of).collect::<Vec<_>>());
    let (mean_x, mean_y) = (column(|point| point.0)?, column(|point| point.1)?);
    let spread: f64 = points.iter().map(|(x, _)| (x - mean_x).powi(2)).sum();
    let slope = points
        .iter()
        .map(|(x, y)| (x - mean_x) * (y - mean_y))
        .sum::<f64>()
        / spread;
    let residuals: f64 = points
        .iter()
        .map(|(x, y)| (y - mean_y - slope * (x - mean_x)).powi(2))
        .sum();
    let half = students.inverse_cdf(0.5 + confidence / 2.0) * (residuals / degrees / spread).sqrt();
    (spread > 0.0).then_some(Slope {
        slope,
        interval: Interval {
            low: slope - half,
            high: slope + half,
        },
    })
}

/// The quantile of sorted values, on the line between its two neighbours; `None` of none.
pub fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let place = share.clamp(0.0, 1.0) * sorted.len().checked_sub(1)? as f64;
    let (below, above) = (
        sorted[place.floor() as usize],
        sorted[place.ceil() as usize],
    );
    Some(below + (above - below) * place.fract())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::{Purpose, Seed};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Exp1, StandardNormal};

    fn assert_interval(found: Option<Interval>, low: f64, high: f64) {
        let found = found.unwrap();
        assert!(
            (found.low - low).abs() < 1e-4 && (found.high - high).abs() < 1e-4,
            "{found:?}"
        );
    }

    #[test]
    fn intervals_by_hand() {
        // 1, 2, 3, 4, 5: mean 3, s² = 10/4, t(0.975; 4) = 2.77645: 3 ± 2.77645 · 1.58114 / 2.23607.
        let values = [1.0, 2.0, 3.0, 4.0, 5.0];
        assert_interval(t_interval(&values, 0.95), 1.036_757, 4.963_243);
        // 8 of 10 at 95 %, z² = 3.84146: (0.8 + 0.192073 ± 1.95996 √(0.016 + 0.0096036)) / 1.384146.
        assert_interval(wilson_interval(8.0, 10, 0.95), 0.490_162, 0.943_318);
        assert_interval(wilson_interval(0.0, 10, 0.95), 0.0, 0.277_533);
        assert_eq!(
            (
                t_interval(&[1.0], 0.95),
                wilson_interval(0.0, 0, 0.95),
                mean(&[])
            ),
            (None, None, None)
        );
        assert_eq!(
            (
                quantile(&values, 0.5),
                quantile(&values, 0.875),
                quantile(&[], 0.5)
            ),
            (Some(3.0), Some(4.5), None)
        );
    }

    const SHARE: Interval = Interval {
        low: 0.0,
        high: 1.0,
    };

    #[test]
    fn an_interval_of_a_share_by_hand() {
        // Mean 0.9, s² = 0.075/4, t(0.975; 4) = 2.776445: half² = 7.708647 · 0.01875/5 = 0.02890743, which reaches to 1.070022. As many
        // trials vary so as 0.9 · 0.1 · 5/0.01875 = 24: half²/0.09 = 0.3211936, centre (0.9 + 0.1605968)/1.3211936 = 0.8027565, half
        // √(0.02890743 + 0.02579134)/1.3211936 = 0.1770200.
        let values = [1.0, 1.0, 1.0, 0.75, 0.75];
        assert_interval(t_interval(&values, 0.95), 0.729_978, 1.070_022);
        assert_interval(bounded_interval(&values, SHARE, 0.95), 0.625_737, 0.979_777);
        // The limits are where the distance to the mean is t √(p(1 − p)/24).
        for limit in [0.625_737_f64, 0.979_777] {
            assert!(
                ((0.9 - limit).abs() - 2.776_445 * (limit * (1.0 - limit) / 24.0).sqrt()).abs()
                    < 1e-5
            );
        }
        // Mirrored, and on other bounds: the same interval, mirrored and stretched.
        let mirrored = values.map(|value| 1.0 - value);
        assert_interval(
            bounded_interval(&mirrored, SHARE, 0.95),
            1.0 - 0.979_777,
            1.0 - 0.625_737,
        );
        let stretched = values.map(|value| 2.0 * value - 1.0);
        assert_interval(
            bounded_interval(
                &stretched,
                Interval {
                    low: -1.0,
                    high: 1.0,
                },
                0.95,
            ),
            0.251_473,
            0.959_553,
        );
        // Within the bounds it is the t interval; equal values have one of no length.
        let inside = [0.4, 0.5, 0.6];
        assert_eq!(
            bounded_interval(&inside, SHARE, 0.95),
            t_interval(&inside, 0.95)
        );
        assert_eq!(
            bounded_interval(&[1.0; 5], SHARE, 0.95),
            Some(Interval {
                low: 1.0,
                high: 1.0
            })
        );
        assert_eq!(bounded_interval(&[1.0], SHARE, 0.95), None);
    }

    #[test]
    fn the_slope_of_a_line_by_hand() {
        // x 1 … 5, y 2, 4, 5, 4, 5: x̄ = 3, ȳ = 4, Σ(x − x̄)(y − ȳ) = 6, Σ(x − x̄)² = 10, so 0.6; residuals −0.8, 0.6, 1, −0.6, −0.2, their
        // squares 2.4; t(0.975; 3) = 3.18245, √(2.4 / 3 / 10) = 0.282843: 0.6 ± 0.900131.
        let points = [(1.0, 2.0), (2.0, 4.0), (3.0, 5.0), (4.0, 4.0), (5.0, 5.0)];
        let found = slope(&points, 0.95).unwrap();
        assert!((found.slope - 0.6).abs() < 1e-12);
        assert_interval(Some(found.interval), -0.300_131, 1.500_131);
        assert_eq!(
            (slope(&points[..2], 0.95), slope(&[(1.0, 2.0); 4], 0.95)),
            (None, None)
        );
    }

    /// How often intervals of 95 % of `count` values hold the mean that they are drawn around.
    fn coverage(
        repetitions: u32,
        count: usize,
        value: impl Fn(&mut ChaCha8Rng) -> f64,
        mean: f64,
        interval: impl Fn(&[f64], &mut ChaCha8Rng) -> Option<Interval>,
    ) -> f64 {
        let mut draw = Seed { seed: 1, run: 0 }.stream(Purpose::Bootstrap, 0, 0);
        let covers = |_: &u32| {
            let values: Vec<f64> = (0..count).map(|_| value(&mut draw)).collect();
            interval(&values, &mut draw)
                .is_some_and(|interval| interval.low <= mean && mean <= interval.high)
        };
        (0..repetitions).filter(covers).count() as f64 / f64::from(repetitions)
    }

    fn normal(draw: &mut ChaCha8Rng) -> f64 {
        StandardNormal.sample(draw)
    }

    fn exponential(draw: &mut ChaCha8Rng) -> f64 {
        Exp1.sample(draw)
    }

    fn assert_nominal(share: f64) {
        assert!((0.94..=0.96).contains(&share), "{share}");
    }

    #[test]
    fn t_intervals_cover_a_mean_as_often_as_they_say() {
        let interval = |values: &[f64], _: &mut ChaCha8Rng| t_interval(values, 0.95);
        // A standard deviation of these shares is 0.2 points.
        assert_nominal(coverage(10_000, 5, normal, 0.0, interval));
        assert_nominal(coverage(10_000, 30, normal, 0.0, interval));
        assert_nominal(coverage(10_000, 30, |draw| draw.random(), 0.5, interval));
        // Of values far from normal it takes many.
        assert_nominal(coverage(10_000, 200, exponential, 1.0, interval));
    }

    #[test]
    fn a_t_interval_of_the_differences_of_pairs_covers_the_difference_of_their_means() {
        // Two values of a pair have a large part in common, as two methods on one scene have.
        let pair = |draw: &mut ChaCha8Rng| {
            let scene = 10.0 * normal(draw);
            (scene + normal(draw) + 0.3) - (scene + normal(draw))
        };
        assert_nominal(coverage(10_000, 20, pair, 0.3, |values, _| {
            t_interval(values, 0.95)
        }));
    }

    #[test]
    fn bootstraps_cover_a_mean_as_often_as_they_say() {
        let interval =
            |values: &[f64], draw: &mut ChaCha8Rng| bootstrap_interval(values, 0.95, draw);
        // A standard deviation of these shares is 0.4 points.
        assert_nominal(coverage(3_000, 15, normal, 0.0, interval));
        assert_nominal(coverage(3_000, 15, |draw| draw.random(), 0.5, interval));
    }

    #[test]
    fn intervals_of_shares_cover_a_mean_near_the_bound_as_often_as_they_say() {
        // A run gives the share of 50 targets; each is followed with a probability of 0.98.
        let share = |draw: &mut ChaCha8Rng| {
            (0..50).filter(|_| draw.random_bool(0.98)).count() as f64 / 50.0
        };
        let interval = |values: &[f64], _: &mut ChaCha8Rng| bounded_interval(values, SHARE, 0.95);
        assert_nominal(coverage(10_000, 10, share, 0.98, interval));
        // Five runs can vary too little by chance.
        let of_few = coverage(10_000, 5, share, 0.98, interval);
        let of_t = coverage(10_000, 5, share, 0.98, |values, _| t_interval(values, 0.95));
        assert!(of_few > 0.92 && of_few >= of_t, "{of_few} {of_t}");
    }

    #[test]
    fn wilson_intervals_cover_a_probability_as_often_as_they_say() {
        let flips = |p: f64| move |draw: &mut ChaCha8Rng| f64::from(u8::from(draw.random_bool(p)));
        let interval = |values: &[f64], _: &mut ChaCha8Rng| {
            wilson_interval(values.iter().sum(), values.len(), 0.95)
        };
        for p in [0.3, 0.5, 0.9] {
            assert_nominal(coverage(10_000, 200, flips(p), p, interval));
        }
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
                covered += if interval.low <= p && p <= interval.high {
                    probability
                } else {
                    0.0
                };
                probability *= f64::from(n - successes) / f64::from(successes + 1) * p / (1.0 - p);
            }
            covered
        };
        let shares: Vec<f64> = (0..81)
            .map(|step| coverage(0.1 + 0.01 * f64::from(step)))
            .collect();
        let average = mean(&shares).unwrap();
        assert!((0.94..0.96).contains(&average), "{average}");
        assert!(
            shares.iter().all(|share| (0.92..0.98).contains(share)),
            "{shares:?}"
        );
    }
}
