//! Where the numbers of a metric come from: for each the rows of a job's files, or the other numbers, that it is made of.
//!
//! # Method
//! - A metric says it in a table of [`Origin`]s. A number is a statistic of rows, or a combination of other numbers of the
//!   same metric; a name that the metric does not report is only a step on the way.
//! - `series.x` is a number at every step; where it is not listed itself, it is made as `x` is, of the rows of that step.
//!   `curves.x` is a number at every point of a curve of the report.
//! - Columns that belong to the metric are named as it names them; the report puts in front what the metric is called.

use crate::evaluation::comparison::Comparison;

/// The log of events: one row an event.
pub const EVENTS: &str = "events.csv";
/// The pairs of a truth and a track at one step, with what each contributes to the metrics.
pub const PAIRS: &str = "pairs.csv";
/// The metrics over time: one row a step.
pub const SERIES: &str = "metric-series.csv";
/// What the metrics say of each truth and each track.
pub const TRUTHS: &str = "metric-truths.csv";
pub const TRACKS: &str = "metric-tracks.csv";

/// How one number is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Origin {
    pub quantity: &'static str,
    pub statistic: Statistic,
    pub source: Source,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Source {
    /// Rows of a file: of these events, or those in which the column is filled; all where neither is named.
    Rows {
        file: &'static str,
        column: Option<&'static str>,
        events: &'static [&'static str],
    },
    /// factor · (Σ over / Σ under)^(1/power); without `under` nothing is divided. A name after `-` is subtracted.
    Numbers {
        over: &'static [&'static str],
        under: &'static [&'static str],
        factor: f64,
        power: f64,
    },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Statistic {
    /// Of rows: how many.
    Count,
    /// Of rows: of how many steps they are.
    CountSteps,
    /// Of rows: in how many the column is above 0.
    CountPositive,
    Sum,
    Mean,
    RootMeanSquare,
    /// The smallest value that at least 95 % of the rows do not exceed.
    NearestRank95,
    /// The share of the rows in which the column lies from `<column>_lower` to `<column>_upper`.
    ShareWithin,
    /// At place k of a curve (from 1): in how many rows the column is at least k.
    CountReaching,
    /// The same rows' mean `similarity`; 1 without any.
    MeanReaching,
    /// The mean over the same rows of c / (g + t − c), c / g or c / t: c are those of them with the same truth and track,
    /// g and t the points of that truth and that track; 0 without any.
    AssociationJaccard,
    AssociationRecall,
    AssociationPrecision,
    /// Of numbers, as [`Source::Numbers`] has it.
    Ratio,
    Largest,
    /// The logarithm to base 10, 0 of numbers below 1.
    Log10,
    GeometricMean,
    Product,
    /// Of a curve.
    MeanOfCurve,
    FirstOfCurve,
}

/// Points of truths and of tracks: every one is exactly one of these events.
pub const TRUTH_POINTS: Origin = Origin::events("truth_points", &["match", "miss"]);
pub const TRACK_POINTS: Origin = Origin::events(
    "track_points",
    &["match", "false_alarm", "redundant", "divergence"],
);
pub const STEPS: Origin = Origin::all_rows("steps", SERIES);
/// The steps at which a target is due: means are over these.
pub const DUE_STEPS: Origin = Origin {
    statistic: Statistic::CountSteps,
    ..Origin::events("due_steps", &["match", "miss"])
};

impl Origin {
    /// How often these events occurred.
    pub const fn events(quantity: &'static str, events: &'static [&'static str]) -> Origin {
        Origin {
            quantity,
            statistic: Statistic::Count,
            source: Source::Rows {
                file: EVENTS,
                column: None,
                events,
            },
        }
    }

    /// How many rows a file has.
    pub const fn all_rows(quantity: &'static str, file: &'static str) -> Origin {
        Origin {
            quantity,
            statistic: Statistic::Count,
            source: Source::Rows {
                file,
                column: None,
                events: &[],
            },
        }
    }

    /// A statistic of the rows in which a column is filled.
    pub const fn rows(
        quantity: &'static str,
        statistic: Statistic,
        file: &'static str,
        column: &'static str,
    ) -> Origin {
        Origin {
            quantity,
            statistic,
            source: Source::Rows {
                file,
                column: Some(column),
                events: &[],
            },
        }
    }

    /// The sum of a column that is called like the quantity.
    pub const fn sum(quantity: &'static str, file: &'static str) -> Origin {
        Origin::rows(quantity, Statistic::Sum, file, quantity)
    }

    pub const fn numbers(
        quantity: &'static str,
        statistic: Statistic,
        over: &'static [&'static str],
    ) -> Origin {
        Origin {
            quantity,
            statistic,
            source: Source::Numbers {
                over,
                under: &[],
                factor: 1.0,
                power: 1.0,
            },
        }
    }

    pub const fn ratio(
        quantity: &'static str,
        over: &'static [&'static str],
        under: &'static [&'static str],
    ) -> Origin {
        Origin {
            quantity,
            statistic: Statistic::Ratio,
            source: Source::Numbers {
                over,
                under,
                factor: 1.0,
                power: 1.0,
            },
        }
    }

    /// A sum of other numbers.
    pub const fn terms(quantity: &'static str, over: &'static [&'static str]) -> Origin {
        Origin::ratio(quantity, over, &[])
    }

    /// The same, times a factor.
    pub fn times(self, times: f64) -> Origin {
        match self.source {
            Source::Numbers {
                over,
                under,
                factor,
                power,
            } => Origin {
                source: Source::Numbers {
                    over,
                    under,
                    factor: factor * times,
                    power,
                },
                ..self
            },
            Source::Rows { .. } => self,
        }
    }

    /// The same, under a root.
    pub fn root(self, order: f64) -> Origin {
        match self.source {
            Source::Numbers {
                over,
                under,
                factor,
                ..
            } => Origin {
                source: Source::Numbers {
                    over,
                    under,
                    factor,
                    power: order,
                },
                ..self
            },
            Source::Rows { .. } => self,
        }
    }
}

/// What pairs of a truth and a track at one step contribute to a metric.
#[derive(Debug, Clone, PartialEq)]
pub struct PairColumn {
    pub name: &'static str,
    pub unit: &'static str,
    /// Indices into the truths and tracks of the comparison, rising, and the contribution. A pair need not be within reach.
    pub cells: Vec<(u32, u32, f64)>,
}

impl PairColumn {
    pub fn new(
        name: &'static str,
        unit: &'static str,
        mut cells: Vec<(u32, u32, f64)>,
    ) -> PairColumn {
        cells.sort_unstable_by_key(|&(truth, track, _)| (truth, track));
        PairColumn { name, unit, cells }
    }

    /// What the pairs of each step contribute together.
    pub fn sums(&self, comparison: &Comparison) -> Vec<f64> {
        let mut cells = self.cells.iter().peekable();
        let mut sum_before = |end: usize| {
            std::iter::from_fn(|| cells.next_if(|cell| (cell.0 as usize) < end))
                .map(|cell| cell.2)
                .sum()
        };
        let steps = comparison.steps.iter();
        steps.map(|step| sum_before(step.truths.end)).collect()
    }
}
