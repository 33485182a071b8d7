//! The numbers that a campaign keeps of each run, and what it says of them cell by cell.

use super::axes::Axis;
use super::cells::Cell;
use super::shares::{DIFFERENCE, SHARE, is_share};
use super::stop::Ended;
use crate::experiment::limits::LimitsReport;
use crate::experiment::result_numbers::{fields_at, is_quantity, nearest_to, number_at, place_of};
use crate::math::rng::{Purpose, Seed};
use crate::math::stats::{self, Interval};
use crate::model::fault::Fault;
use rand::RngExt;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    T,
    Wilson,
    Bootstrap,
}

/// A number that a campaign keeps of each run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    path: String,
    name: Option<String>,
    interval: Method,
    #[serde(rename = "where")]
    only_where: Option<String>,
}

impl Outcome {
    /// Its name in the tables.
    pub fn name(&self) -> &str {
        self.name.as_deref().unwrap_or(&self.path)
    }

    /// The number in a result; `None` where it is null, absent, or the run is not one of those that count.
    pub(super) fn of(&self, result: &Value) -> Option<f64> {
        let counts = self
            .only_where
            .as_ref()
            .is_none_or(|path| number_at(result, path) == Some(1.0));
        number_at(result, &self.path).filter(|number| counts && number.is_finite())
    }

    /// The interval of the mean of differences run by run.
    fn interval_of_differences(&self, pairs: &[f64], confidence: f64) -> Option<Interval> {
        if is_share(&self.path) {
            return stats::bounded_interval(pairs, DIFFERENCE, confidence);
        }
        stats::t_interval(pairs, confidence)
    }

    /// Why this result of a run, which said `warnings`, has no number for it.
    pub(super) fn lack(&self, result: &Value, warnings: &[String]) -> String {
        if let Some(path) = self
            .only_where
            .as_ref()
            .filter(|path| number_at(result, path).is_none())
        {
            return format!(
                "'where' has no number at '{path}'{}",
                nearest_to(path, result)
            );
        }
        // Of all that a run says, what it did not have is the cause.
        let cause = warnings.iter().find(|warning| warning.starts_with("no "));
        let said = cause.map_or_else(String::new, |warning| format!("; the run says: {warning}"));
        match place_of(result, &self.path) {
            None => format!(
                "there is no number at '{}' in any result{}",
                self.path,
                nearest_to(&self.path, result)
            ),
            Some(Value::Null) => format!(
                "'{}' is null, as a share or a mean of nothing is{said}",
                self.path
            ),
            Some(found) if !is_quantity(found) => {
                format!(
                    "'{}' is no number{}",
                    self.path,
                    nearest_to(&self.path, result)
                )
            }
            Some(_) => format!("'{}' has no value{said}", self.path),
        }
    }

    /// The interval that it asks for, of the numbers that runs have; `draw` makes the resamples of a bootstrap.
    pub(super) fn interval_of(
        &self,
        present: &[f64],
        confidence: f64,
        mut draw: impl RngExt,
    ) -> Option<Interval> {
        match self.interval {
            Method::T if is_share(&self.path) => {
                stats::bounded_interval(present, SHARE, confidence)
            }
            Method::T => stats::t_interval(present, confidence),
            Method::Wilson if !present.iter().copied().all(is_success_or_failure) => None,
            Method::Wilson => {
                stats::wilson_interval(present.iter().sum(), present.len(), confidence)
            }
            Method::Bootstrap => stats::bootstrap_interval(present, confidence, &mut draw),
        }
    }
}

/// A name that two outcomes have, for each is a column of the tables.
pub(super) fn named_twice(outcomes: &[Outcome]) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (index, outcome) in outcomes.iter().enumerate() {
        let name = outcome.name();
        if outcomes[..index].iter().any(|other| other.name() == name) {
            let detail = format!("two outcomes are named '{name}'");
            let fault = Fault::new(format!("/outcomes/{index}"), "duplicate", detail);
            faults.push(fault.allowing("each name once; 'name' sets it"));
        }
    }
    faults
}

/// What the reader of the tables should know: outcomes that no run has, and shares that are none.
pub(super) fn warnings(
    outcomes: &[Outcome],
    rows: &[Rows],
    lacking: &[Option<String>],
) -> Vec<String> {
    let numbers = |number: usize| {
        rows.iter()
            .flat_map(move |cell| cell[number].iter().flatten().copied())
    };
    let mut warnings = Vec::new();
    for (number, outcome) in outcomes.iter().enumerate() {
        let (name, path) = (outcome.name(), &outcome.path);
        if numbers(number).next().is_none() {
            let absent = || format!("there is no number at '{path}' in any result");
            warnings.push(format!(
                "no run has the outcome '{name}': {}",
                lacking[number].clone().unwrap_or_else(absent)
            ));
        }
        if outcome.interval == Method::Wilson && !numbers(number).all(is_success_or_failure) {
            warnings.push(format!(
                "outcome '{name}' is not 0 or 1 in every run, so it has no Wilson interval"
            ));
        }
    }
    warnings
}

fn is_success_or_failure(number: f64) -> bool {
    number == 0.0 || number == 1.0
}

/// What is kept when nothing is listed: every number of these parts of the result.
pub(super) fn found_in(result: &Value) -> Vec<Outcome> {
    let mut paths = Vec::new();
    for part in [
        "counts",
        "tfa.counts",
        "tfa.probability",
        "grouping.accuracy",
        "grouping.precision",
        "grouping.recall",
        "cost",
        "gap",
        "truth",
    ] {
        match place_of(result, part) {
            Some(Value::Object(fields)) => {
                paths.extend(fields.keys().map(|name| format!("{part}.{name}")))
            }
            Some(_) => paths.push(part.to_owned()),
            None => {}
        }
    }
    for (metric, report) in fields_at(result, "metrics") {
        let names = fields_at(report, "quantities").map(|(name, _)| name);
        paths.extend(names.map(|name| format!("metrics.{metric}.quantities.{name}")));
    }
    paths
        .into_iter()
        .map(|path| Outcome {
            path,
            name: None,
            interval: Method::T,
            only_where: None,
        })
        .collect()
}

/// The kept numbers of one cell: by outcome, by run.
pub(super) type Rows = Vec<Vec<Option<f64>>>;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct CampaignResult {
    /// Names of the outcomes, in their order.
    pub outcomes: Vec<String>,
    /// Of the intervals.
    pub confidence: f64,
    pub cells: Vec<CellReport>,
    /// Whether the cells are within the limits, where the request has any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub limits: Option<LimitsReport>,
}

/// What the runs of one cell gave. Each run by itself is in the file `runs.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = CampaignCell))]
pub struct CellReport {
    pub name: String,
    /// Its point on each axis.
    #[cfg_attr(feature = "service", schema(value_type = BTreeMap<String, String>))]
    pub parameters: Map<String, Value>,
    pub runs: u64,
    /// Why it has no more: `runs` (all are done) or `half_width` (of `stop_at`, reached); `not_yet` while the campaign is running.
    #[cfg_attr(feature = "service", schema(value_type = String))]
    pub ended: Ended,
    pub outcomes: BTreeMap<String, Summary>,
    /// Run by run to the cell it is compared with.
    pub differences: BTreeMap<String, Difference>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub compared_with: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = OutcomeSummary))]
pub struct Summary {
    /// Runs that have the number.
    pub count: u64,
    /// Runs that do not.
    pub missing: u64,
    pub mean: Option<f64>,
    pub interval: Option<Interval>,
    /// `t`, `wilson` or `bootstrap`.
    #[cfg_attr(feature = "service", schema(value_type = String))]
    pub method: Method,
    pub standard_deviation: Option<f64>,
    pub min: Option<f64>,
    pub median: Option<f64>,
    pub max: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = OutcomeDifference))]
pub struct Difference {
    /// Runs in which both cells have the number.
    pub pairs: u64,
    pub mean: Option<f64>,
    /// Student's t.
    pub interval: Option<Interval>,
}

/// What all cells are judged by.
pub(super) struct Judge<'a> {
    pub outcomes: &'a [Outcome],
    pub axes: &'a [Axis],
    pub confidence: f64,
    pub seed: Seed,
}

impl Judge<'_> {
    pub fn report(
        &self,
        cell: &Cell,
        index: usize,
        (rows, ended): (&Rows, Ended),
        reference: Option<(&Cell, &Rows)>,
    ) -> CellReport {
        let mut outcomes = BTreeMap::new();
        let mut differences = BTreeMap::new();
        for (number, outcome) in self.outcomes.iter().enumerate() {
            let summary = self.summary(number, index, &rows[number]);
            outcomes.insert(outcome.name().to_owned(), summary);
            if let Some((_, theirs)) = reference {
                let difference = self.difference(number, &rows[number], &theirs[number]);
                differences.insert(outcome.name().to_owned(), difference);
            }
        }
        CellReport {
            name: cell.name.clone(),
            parameters: cell.parameters(self.axes),
            runs: rows.first().map_or(0, Vec::len) as u64,
            ended,
            outcomes,
            differences,
            compared_with: reference.map(|(cell, _)| cell.name.clone()),
        }
    }

    fn summary(&self, number: usize, cell: usize, values: &[Option<f64>]) -> Summary {
        let mut present: Vec<f64> = values.iter().flatten().copied().collect();
        let method = self.outcomes[number].interval;
        let draw = self
            .seed
            .stream(Purpose::Bootstrap, cell as u64, number as u64);
        let interval = self.outcomes[number].interval_of(&present, self.confidence, draw);
        let (mean, standard_deviation) =
            (stats::mean(&present), stats::standard_deviation(&present));
        present.sort_by(f64::total_cmp);
        Summary {
            count: present.len() as u64,
            missing: (values.len() - present.len()) as u64,
            mean,
            interval,
            method,
            standard_deviation,
            min: present.first().copied(),
            median: stats::quantile(&present, 0.5),
            max: present.last().copied(),
        }
    }

    fn difference(
        &self,
        number: usize,
        ours: &[Option<f64>],
        theirs: &[Option<f64>],
    ) -> Difference {
        let pairs: Vec<f64> = ours
            .iter()
            .zip(theirs)
            .filter_map(|(ours, theirs)| Some((*ours)? - (*theirs)?))
            .collect();
        Difference {
            pairs: pairs.len() as u64,
            mean: stats::mean(&pairs),
            interval: self.outcomes[number].interval_of_differences(&pairs, self.confidence),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(path: &str) -> Outcome {
        Outcome {
            path: path.to_owned(),
            name: None,
            interval: Method::T,
            only_where: None,
        }
    }

    #[test]
    fn the_interval_of_a_share_ends_within_0_and_1() {
        // Mean 0.9, s² = 0.01875: ± 0.170022 by t; with Wilson's form of 24 trials (0.9 + 0.160597 ∓ …) / 1.321194.
        let rows = vec![vec![Some(1.0), Some(1.0), Some(1.0), Some(0.75), Some(0.75)]; 2];
        let outcomes = [
            outcome("tfa.probability.correct"),
            outcome("metrics.gospa.quantities.gospa"),
        ];
        let judge = Judge {
            outcomes: &outcomes,
            axes: &[],
            confidence: 0.95,
            seed: Seed { seed: 1, run: 0 },
        };
        let interval = |number: usize| judge.summary(number, 0, &rows[number]).interval.unwrap();
        assert!(
            (interval(0).low - 0.625_737).abs() < 1e-5
                && (interval(0).high - 0.979_777).abs() < 1e-5,
            "{:?}",
            interval(0)
        );
        assert!(
            (interval(1).high - 1.070_022).abs() < 1e-5,
            "{:?}",
            interval(1)
        );
        // Differences of shares end within −1 and 1: (0.9 + 1) / 2 = 0.95 of that length, ± 0.085011 by t, reaches to 1.035011.
        let none = vec![Some(0.0); 5];
        let difference = judge.difference(0, &rows[0], &none).interval.unwrap();
        assert!(
            (difference.low - 0.583125).abs() < 1e-5 && (difference.high - 0.979180).abs() < 1e-5,
            "{difference:?}"
        );
    }

    #[test]
    fn a_paired_difference_by_hand() {
        // Two methods on six scenes; the third scene has no number of the second. The differences are
        // 1, 2, 3, 4, 5: mean 3, s² = 10/4, t(0.975; 4) = 2.77645, 3 ± 2.77645 · 1.58114 / 2.23607.
        let ours = [11.0, 17.0, 99.0, 23.0, 29.0, 35.0].map(Some);
        let theirs = [
            Some(10.0),
            Some(15.0),
            None,
            Some(20.0),
            Some(25.0),
            Some(30.0),
        ];
        let outcomes = [outcome("metrics.gospa.quantities.gospa")];
        let judge = Judge {
            outcomes: &outcomes,
            axes: &[],
            confidence: 0.95,
            seed: Seed { seed: 1, run: 0 },
        };
        let found = judge.difference(0, &ours, &theirs);
        assert_eq!((found.pairs, found.mean), (5, Some(3.0)));
        let interval = found.interval.unwrap();
        assert!(
            (interval.low - 1.036_757).abs() < 1e-5 && (interval.high - 4.963_243).abs() < 1e-5,
            "{interval:?}"
        );
        // The means alone, 23 and 20 over the same scenes, have intervals that overlap widely.
        let alone = stats::t_interval(&[11.0, 17.0, 23.0, 29.0, 35.0], 0.95).unwrap();
        assert!(alone.low < 20.0);
        assert_eq!(
            judge.difference(0, &ours[2..3], &theirs[2..3]),
            Difference {
                pairs: 0,
                mean: None,
                interval: None
            }
        );
    }
}
