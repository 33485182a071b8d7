//! Thresholds: one level for all cells, or for each cell a multiple of the mean power around it that is exceeded by noise alone
//! with a known probability.
//!
//! # Reference
//! H. M. Finn, R. S. Johnson, RCA Review 29 (1968); for means of several values P. P. Gandhi, S. A. Kassam, IEEE Trans. AES 24
//! (1988).
//!
//! # Symbols
//! n training cells of a cell; M independent values in the power of a cell (those of a row times the rows of the interval);
//! Z mean power of the training cells; α threshold factor; P_FA probability that noise alone exceeds α Z.
//!
//! # Method
//! 1. On each side of a cell, `guard_cells` are left out and the next `training_cells` taken, round the turn if the axis goes
//!    round; at the edges of a sector there are fewer.
//! 2. In noise, P_b / Z has the F distribution with 2M and 2nM degrees of freedom: α is its quantile at 1 − P_FA. With M = 1
//!    that is α = n (P_FA^(−1/n) − 1).
//! 3. M of the record, where it is not given, comes from the differences of the logarithms of each cell's power from row to row:
//!    their variance is 2ψ′(M), and their median size that of a normal variable, which is up to
//!    a tenth too much for M. Targets hardly change it.

use super::Tuning;
use crate::model::bearing_time::BearingTimeRecord;
use crate::model::fault::Fault;
use crate::registry::{Object, Union, default, number, optional, required, variant, whole};
use serde::Deserialize;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::collections::BTreeMap;

pub(super) static THRESHOLD: Union = Union {
    name: "DetectorThreshold",
    summary: "What the power of a cell must exceed.",
    tag: "kind",
    variants: || {
        vec![
            variant("constant", &CONSTANT),
            variant("cell_averaging", &CELL_AVERAGING),
        ]
    },
};

static CONSTANT: Object = Object {
    name: "ConstantThreshold",
    summary: "One level for all cells.",
    fields: &[required(
        "level_db",
        "The level, on the scale of the record.",
        number(-300.0, 300.0, "dB"),
    )],
};

static CELL_AVERAGING: Object = Object {
    name: "CellAveragingThreshold",
    summary: "A multiple of the mean power of the cells around, for a constant rate of false alarms.",
    fields: &[
        default(
            "guard_cells",
            "Cells on each side that are left out, because a target fills them too.",
            whole(0, 10_000, ""),
            "4",
        ),
        default(
            "training_cells",
            "Cells on each side whose mean is taken.",
            whole(1, 10_000, ""),
            "12",
        ),
        default(
            "false_alarm_probability",
            "Probability that a cell of noise alone exceeds its threshold in a scan.",
            number(1e-12, 0.5, ""),
            "0.0001",
        ),
        optional(
            "noise_averages",
            "Independent values of which the power in a cell of the record is the mean; estimated from the record when absent.",
            number(0.5, 1e6, ""),
        ),
    ],
};

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(super) enum Threshold {
    Constant {
        level_db: f64,
    },
    CellAveraging {
        guard_cells: usize,
        training_cells: usize,
        false_alarm_probability: f64,
        #[serde(default)]
        noise_averages: Option<f64>,
    },
}

/// A threshold at work on one record.
pub(super) struct Scale {
    rule: Rule,
    /// Of each cell; reused from scan to scan.
    thresholds: Vec<f64>,
}

enum Rule {
    Constant,
    Averaging(Averaging),
}

struct Averaging {
    wraps: bool,
    guard: usize,
    training: usize,
    false_alarm_probability: f64,
    /// M of the record.
    averages: f64,
    /// α by number of training cells and of rows.
    factors: BTreeMap<(usize, usize), f64>,
    /// Reused: sums of the power of all cells before one.
    sums: Vec<f64>,
}

impl Scale {
    pub fn new(threshold: &Threshold, record: &BearingTimeRecord) -> Result<Scale, Vec<Fault>> {
        let width = record.width();
        let (guard, training, false_alarm_probability, given) = match *threshold {
            Threshold::Constant { level_db } => {
                return Ok(Scale {
                    rule: Rule::Constant,
                    thresholds: vec![10f64.powf(level_db / 10.0); width],
                });
            }
            Threshold::CellAveraging {
                guard_cells,
                training_cells,
                false_alarm_probability,
                noise_averages,
            } => (
                guard_cells,
                training_cells,
                false_alarm_probability,
                noise_averages,
            ),
        };
        let needed = 2 * (guard + training) + 1;
        if needed > width {
            let detail =
                format!("guard and training cells need {needed} cells; the record has {width}");
            let fault = Fault::new("/detector/threshold/training_cells", "out_of_range", detail);
            return Err(vec![fault.allowing(format!(
                "guard_cells + training_cells <= {}",
                (width - 1) / 2
            ))]);
        }
        let averages = given
            .or_else(|| estimated_averages(record))
            .ok_or_else(|| {
                let detail =
                    "two rows at least are needed to estimate how many values a cell averages";
                vec![
                    Fault::new("/detector/threshold/noise_averages", "missing", detail)
                        .allowing("a number"),
                ]
            })?;
        let sums = vec![0.0; width + 1];
        let factors = BTreeMap::new();
        let rule = Rule::Averaging(Averaging {
            wraps: record.wraps(),
            guard,
            training,
            false_alarm_probability,
            averages,
            factors,
            sums,
        });
        Ok(Scale {
            rule,
            thresholds: vec![0.0; width],
        })
    }

    /// The threshold of each cell, in power, of the mean of `rows` rows.
    pub fn thresholds(&mut self, power: &[f64], rows: usize) -> &[f64] {
        if let Rule::Averaging(averaging) = &mut self.rule {
            averaging.fill(power, rows, &mut self.thresholds);
        }
        &self.thresholds
    }

    pub fn tuning(&self, rows: usize) -> Tuning {
        match &self.rule {
            Rule::Constant => Tuning {
                noise_averages: None,
                threshold_over_mean_db: None,
            },
            Rule::Averaging(averaging) => {
                let factor = averaging.factor(2 * averaging.training, rows);
                Tuning {
                    noise_averages: Some(averaging.averages),
                    threshold_over_mean_db: Some(10.0 * factor.log10()),
                }
            }
        }
    }
}

impl Averaging {
    fn fill(&mut self, power: &[f64], rows: usize, thresholds: &mut [f64]) {
        for (index, value) in power.iter().enumerate() {
            self.sums[index + 1] = self.sums[index] + value;
        }
        for (cell, threshold) in thresholds.iter_mut().enumerate() {
            let (sum, count) = self.trained(cell as isize);
            let factor = match self.factors.get(&(count, rows)) {
                Some(&factor) => factor,
                None => {
                    let factor = self.factor(count, rows);
                    self.factors.insert((count, rows), factor);
                    factor
                }
            };
            *threshold = factor * sum / count as f64;
        }
    }

    /// Sum and number of the training cells of a cell.
    fn trained(&self, cell: isize) -> (f64, usize) {
        let (guard, training) = (self.guard as isize, self.training as isize);
        let sides = [
            (cell - guard - training, cell - guard),
            (cell + guard + 1, cell + guard + 1 + training),
        ];
        sides
            .map(|(from, to)| self.sum(from, to))
            .into_iter()
            .fold((0.0, 0), |all, side| (all.0 + side.0, all.1 + side.1))
    }

    /// Sum and number of the cells from `from` up to `to`, which may lie beyond the ends.
    fn sum(&self, from: isize, to: isize) -> (f64, usize) {
        let width = self.sums.len() as isize - 1;
        let within = |from: isize, to: isize| {
            let [from, to] = [from, to].map(|end| end.clamp(0, width) as usize);
            (self.sums[to] - self.sums[from], to - from)
        };
        let inside = within(from, to);
        if !self.wraps {
            return inside;
        }
        let (low, high) = (
            within(from + width, to + width),
            within(from - width, to - width),
        );
        (inside.0 + low.0 + high.0, inside.1 + low.1 + high.1)
    }

    /// α of step 2.
    fn factor(&self, cells: usize, rows: usize) -> f64 {
        let values = self.averages * rows as f64;
        let ratio = FisherSnedecor::new(2.0 * values, 2.0 * values * cells as f64);
        ratio.map_or(f64::INFINITY, |ratio| {
            ratio.inverse_cdf(1.0 - self.false_alarm_probability)
        })
    }
}

/// Pairs of values that are looked at to estimate M.
const MOST_PAIRS: usize = 200_000;
/// Median of the size of a standard normal variable.
const MEDIAN_SIZE: f64 = 0.674_489_750_196_081_7;

/// M of step 3; `None` of a record of one row.
fn estimated_averages(record: &BearingTimeRecord) -> Option<f64> {
    let width = record.width();
    let pairs = record
        .levels_db
        .len()
        .checked_sub(width)
        .filter(|&pairs| pairs > 0)?;
    let to_logarithm = std::f64::consts::LN_10 / 10.0;
    let difference = |index: usize| {
        f64::from(record.levels_db[index + width] - record.levels_db[index]).abs() * to_logarithm
    };
    let mut sizes: Vec<f64> = (0..pairs)
        .step_by(pairs.div_ceil(MOST_PAIRS))
        .map(difference)
        .collect();
    let middle = sizes.len() / 2;
    let median = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
    let variance = (median / MEDIAN_SIZE).powi(2) / 2.0;
    Some(inverse_trigamma(variance).clamp(0.5, 1e6))
}

/// M with ψ′(M) = `value`, where ψ′(M) ≈ 1/M + 1/2M² + 1/6M³ is near enough from M = 1 on.
fn inverse_trigamma(value: f64) -> f64 {
    let (mut low, mut high) = (0.1f64, 1e7f64);
    for _ in 0..100 {
        let middle = (low * high).sqrt();
        let trigamma = 1.0 / middle + 0.5 / middle.powi(2) + 1.0 / (6.0 * middle.powi(3));
        if trigamma > value {
            low = middle
        } else {
            high = middle
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    fn averaging(
        width: usize,
        wraps: bool,
        guard: usize,
        training: usize,
        averages: f64,
    ) -> Averaging {
        let (factors, sums) = (BTreeMap::new(), vec![0.0; width + 1]);
        Averaging {
            wraps,
            guard,
            training,
            false_alarm_probability: 1e-3,
            averages,
            factors,
            sums,
        }
    }

    #[test]
    fn the_factor_of_single_values_is_that_of_the_closed_form() {
        for cells in [4, 16, 64] {
            let closed = cells as f64 * (1e-3f64.powf(-1.0 / cells as f64) - 1.0);
            let factor = averaging(8, true, 0, 1, 1.0).factor(cells, 1);
            assert!(
                (factor / closed - 1.0).abs() < 1e-6,
                "{cells}: {factor} and {closed}"
            );
        }
        assert!(
            averaging(8, true, 0, 1, 4.0).factor(24, 10) < 2.0,
            "40 values vary little"
        );
    }

    #[test]
    fn training_cells_go_round_or_end_at_the_edge() {
        let power: Vec<f64> = (0..10).map(f64::from).collect();
        let sum = |wraps: bool, cell: isize| {
            let mut averaging = averaging(10, wraps, 1, 2, 1.0);
            averaging.fill(&power, 1, &mut [0.0; 10]);
            averaging.trained(cell)
        };
        // Of cell 0: 7 and 8 before, 2 and 3 behind.
        assert_eq!([sum(true, 0), sum(false, 0)], [(20.0, 4), (5.0, 2)]);
        // Of cell 9: 6 and 7 before, 1 and 2 behind.
        assert_eq!([sum(true, 9), sum(false, 9)], [(16.0, 4), (13.0, 2)]);
        assert_eq!([sum(true, 5), sum(false, 5)], [(20.0, 4), (20.0, 4)]);
    }

    #[test]
    fn the_inverse_of_trigamma_is_right_at_published_values() {
        // ψ′(1) = π²/6 and ψ′(10) = 0.105166 (Abramowitz and Stegun, table 6.1).
        assert!((inverse_trigamma(0.105_166) - 10.0).abs() < 0.01);
        assert!((inverse_trigamma(std::f64::consts::PI.powi(2) / 6.0) - 1.0).abs() < 0.02);
    }
}
