//! Counts of one target or of a sector, and what they say.

use super::settings::{Check, PER_HOUR, Rank};
use crate::math::stats::{Interval, mean, quantile, standard_deviation, wilson_interval};
use serde::Serialize;
use std::collections::BTreeMap;

const CONFIDENCE: f64 = 0.95;

/// What was counted.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Score {
    pub numerator: u64,
    pub denominator: u64,
    /// Of requirements per hour.
    pub hours: f64,
    /// One of each update that was judged, signed where that has a meaning.
    pub errors: Vec<f64>,
    /// Updates that could not be judged, by reason.
    pub not_judged: BTreeMap<&'static str, u64>,
}

/// Of errors; σ is about their mean, with n − 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = ErrorStatistics))]
pub struct Statistics {
    pub unit: &'static str,
    pub count: u64,
    pub mean: f64,
    pub rms: f64,
    /// Null of a single one.
    pub sigma: Option<f64>,
    pub min: f64,
    pub max: f64,
}

impl Score {
    /// Adds what was counted of another target.
    pub fn add(&mut self, other: &Score) {
        self.numerator += other.numerator;
        self.denominator += other.denominator;
        self.hours += other.hours;
        self.errors.extend_from_slice(&other.errors);
        for (reason, count) in &other.not_judged {
            *self.not_judged.entry(reason).or_default() += count;
        }
    }

    pub fn leave_out(&mut self, reason: &'static str) {
        *self.not_judged.entry(reason).or_default() += 1;
    }

    /// Counts an update, as one of those that the value is the share of or not.
    pub fn count(&mut self, is_hit: bool, error: Option<f64>) {
        self.denominator += 1;
        self.numerator += u64::from(is_hit);
        self.errors.extend(error);
    }

    /// What the check says of it; `None` where nothing could be judged.
    pub fn value(&self, check: &Check) -> Option<f64> {
        match check {
            Check::PositionRms {} => rms(&self.errors),
            Check::PositionPercentile { percent, rank } => {
                percentile(&self.errors, *percent, *rank)
            }
            _ if check.unit() == PER_HOUR => {
                (self.hours > 0.0).then(|| self.numerator as f64 / self.hours)
            }
            _ => (self.denominator > 0).then(|| self.numerator as f64 / self.denominator as f64),
        }
    }

    /// Wilson's, of a share.
    pub fn interval(&self, check: &Check) -> Option<Interval> {
        if check.unit().is_empty() {
            wilson_interval(self.numerator as f64, self.denominator as usize, CONFIDENCE)
        } else {
            None
        }
    }

    pub fn statistics(&self, check: &Check) -> Option<Statistics> {
        let (unit, errors) = (check.error_unit()?, &self.errors);
        Some(Statistics {
            unit,
            count: errors.len() as u64,
            mean: mean(errors)?,
            rms: rms(errors)?,
            sigma: standard_deviation(errors),
            min: errors.iter().copied().fold(f64::INFINITY, f64::min),
            max: errors.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        })
    }
}

fn rms(errors: &[f64]) -> Option<f64> {
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    (!errors.is_empty()).then(|| (squares / errors.len() as f64).sqrt())
}

/// The nearest rank ⌈p n / 100⌉, or linear between the values beside (n − 1) p / 100.
fn percentile(values: &[f64], percent: f64, rank: Rank) -> Option<f64> {
    let mut rising = values.to_vec();
    rising.sort_unstable_by(f64::total_cmp);
    let last = rising.len().checked_sub(1)?;
    match rank {
        Rank::Nearest => {
            let rank = (percent * rising.len() as f64 / 100.0 - 1e-9).ceil() as usize;
            Some(rising[rank.saturating_sub(1).min(last)])
        }
        Rank::Linear => quantile(&rising, percent / 100.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(errors: &[f64]) -> Score {
        Score {
            errors: errors.to_vec(),
            ..Score::default()
        }
    }

    #[test]
    fn distances_have_their_root_mean_square_and_their_percentiles() {
        let score = of(&[3.0, 4.0, 12.0, 5.0, 0.0, 9.0, 61.0, 7.0, 2.0, 20.0]);
        let check = Check::PositionRms {};
        let found = score.statistics(&check).unwrap();
        assert!((score.value(&check).unwrap() - 21.092652749239484).abs() < 1e-12);
        assert!((found.mean - 12.3).abs() < 1e-12);
        assert!((found.sigma.unwrap() - 18.06193049851907).abs() < 1e-12);
        for (rank, wanted) in [(Rank::Nearest, 61.0), (Rank::Linear, 42.55)] {
            let percent = 95.0;
            let value = score.value(&Check::PositionPercentile { percent, rank });
            assert!((value.unwrap() - wanted).abs() < 1e-12);
        }
        assert_eq!(of(&[]).value(&check), None);
    }

    #[test]
    fn a_sector_is_the_sum_of_its_counts() {
        let mut sum = Score::default();
        for (expected, missed) in [(120, 2), (60, 9), (12, 12)] {
            sum.add(&Score {
                numerator: expected - missed,
                denominator: expected,
                ..Score::default()
            });
        }
        let check = Check::ModeAFalse {};
        assert!((sum.value(&check).unwrap() - 0.8802083333333334).abs() < 1e-15);
        let interval = sum.interval(&check).unwrap();
        assert!((interval.low - 0.8266638821640017).abs() < 1e-5);
        assert!((interval.high - 0.9188365630937985).abs() < 1e-5);
    }
}
