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
    /// How many times the area of the requirement the sector has, of requirements per area.
    pub areas: Option<f64>,
    /// One of each update that was judged, signed where that has a meaning.
    pub errors: Vec<f64>,
    /// What has these errors, where they may have a gain.
    pub measured: Vec<f64>,
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
    /// Of errors as seen from a radar; null of fewer than two different measurements.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub line: Option<Line>,
}

/// The straight line of least squares, truth = gain × measured + bias.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = ErrorLine))]
pub struct Line {
    pub gain: f64,
    pub bias: f64,
}

impl Line {
    fn of(measured: &[f64], errors: &[f64]) -> Option<Line> {
        let (middle, middle_error) = (mean(measured)?, mean(errors)?);
        let (mut squares, mut products) = (0.0, 0.0);
        for (value, error) in measured.iter().zip(errors) {
            squares += (value - middle) * (value - middle);
            products += (value - middle) * (error - middle_error);
        }
        let gain = 1.0 - products / squares;
        gain.is_finite().then_some(Line {
            gain,
            bias: middle - middle_error - gain * middle,
        })
    }
}

impl Score {
    /// Adds what was counted of another target.
    pub fn add(&mut self, other: &Score) {
        self.numerator += other.numerator;
        self.denominator += other.denominator;
        self.hours += other.hours;
        self.errors.extend_from_slice(&other.errors);
        self.measured.extend_from_slice(&other.measured);
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
                let shares = self.hours * self.areas.unwrap_or(1.0);
                (shares > 0.0).then(|| self.numerator as f64 / shares)
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
            line: Line::of(&self.measured, errors),
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
    fn errors_of_a_radar_have_a_gain_and_a_bias() {
        // Truth 0.98 × measured + 7.
        let measured = [100.0, 300.0, 800.0];
        let score = Score {
            errors: measured.map(|one| one - (0.98 * one + 7.0)).to_vec(),
            measured: measured.to_vec(),
            ..Score::default()
        };
        let radar = crate::evaluation::surveillance::settings::Radar::default();
        let check = Check::RadarRange { radar, max_m: 70.0 };
        let line = score.statistics(&check).unwrap().line.unwrap();
        assert!((line.gain - 0.98).abs() < 1e-12 && (line.bias - 7.0).abs() < 1e-9);
        assert_eq!(Line::of(&[5.0, 5.0], &[1.0, 2.0]), None);
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
