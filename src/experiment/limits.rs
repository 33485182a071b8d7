//! Limits: what a number of the result must not exceed or fall below, so that a build server or an authority can use a job.
//!
//! # Method
//! - A limit names a number of the result by its path, or a quantity of a metric by `metric.quantity`. In a campaign it names an
//!   outcome, and holds of each cell.
//! - `with: value` holds the number itself (of a campaign the mean) against the limit; `with: interval` the end of its confidence interval that
//!   is nearer to failing, so that chance alone is unlikely to have met it. A number exactly at the limit meets it.
//! - A number that is absent or null meets nothing: what was not measured was not shown.

use super::result_numbers::{nearest_quantity, number_at, place_of, reason_at};
use crate::math::stats::Interval;
use crate::registry::{Field, Kind, Object, default, list, number, optional, required};
use serde::{Deserialize, Serialize};
use serde_json::Value;

static LIMIT: Object = Object {
    name: "Limit",
    summary: "What a number of the result must not exceed or fall below.",
    fields: &[
        required(
            "quantity",
            "A quantity of a metric (`clear.mota`), any number of the result by its path (`tfa.probability.correct`), or in a campaign the name of an outcome.",
            Kind::Text { max_length: 200 },
        ),
        optional("at_most", "The largest value that is met.", ANY),
        optional("at_least", "The smallest value that is met.", ANY),
        default(
            "with",
            "value: the number, in a campaign the mean. interval: of a campaign, the end of the confidence interval that is nearer to failing.",
            Kind::Choice(&["value", "interval"]),
            "\"value\"",
        ),
        optional(
            "cell",
            "Of a campaign: the one cell that it holds of; all when absent.",
            Kind::Text { max_length: 500 },
        ),
    ],
};

const ANY: Kind = number(-1e15, 1e15, "");
const MOST_LIMITS: usize = 100;
static ONE: Kind = Kind::Object(&LIMIT);

/// The field of every request.
pub const LIMITS: Field = optional(
    "limits",
    "What numbers of the result must not exceed or fall below. The result says `limits.met`; the command line ends with 1 where it is not.",
    list(&ONE, 1, MOST_LIMITS),
);

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum HeldAgainst {
    Value,
    Interval,
}

/// One limit of a request.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = JudgedLimit))]
pub struct Limit {
    pub quantity: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub at_most: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub at_least: Option<f64>,
    pub with: HeldAgainst,
    /// Of a campaign.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub cell: Option<String>,
}

/// Whether the result of a job is within its limits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct LimitsReport {
    /// All of them.
    pub met: bool,
    /// Limit by limit, in a campaign cell by cell.
    pub checks: Vec<LimitCheck>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct LimitCheck {
    #[serde(flatten)]
    pub limit: Limit,
    pub met: bool,
    /// Null where there is none.
    pub value: Option<f64>,
    /// Of a campaign, and of a requirement that is a share.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub interval: Option<Interval>,
    /// How far what was held against the limit is on its right side; negative where it is not met.
    pub margin: Option<f64>,
    /// Why there is no number, or why one on the right side is not met.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub reason: Option<String>,
}

/// Holds the result of one run against the limits.
pub fn judge(limits: &[Limit], result: &Value) -> LimitsReport {
    LimitsReport::of(
        limits
            .iter()
            .map(|limit| limit.check_result(result))
            .collect(),
    )
}

impl LimitsReport {
    pub fn of(checks: Vec<LimitCheck>) -> Self {
        LimitsReport {
            met: checks.iter().all(|check| check.met),
            checks,
        }
    }

    /// For whoever reads nothing but warnings.
    pub fn warning(&self) -> Option<String> {
        let failed = self.checks.iter().filter(|check| !check.met).count();
        let of = self.checks.len();
        (failed > 0)
            .then(|| format!("{failed} of {of} limits are not met: see limits in the result"))
    }
}

impl Limit {
    fn check_result(&self, result: &Value) -> LimitCheck {
        let path = self.path_in(result);
        let reason = match reason_at(result, &path) {
            None => format!("there is no such number{}", nearest_quantity(&path, result)),
            Some(told) => told.to_owned(),
        };
        self.check(number_at(result, &path), None, reason)
    }

    /// `clear.mota` is short for `metrics.clear.quantities.mota`.
    fn path_in(&self, result: &Value) -> String {
        if place_of(result, &self.quantity).is_none()
            && let Some((metric, quantity)) = self.quantity.split_once('.')
        {
            let path = format!("metrics.{metric}.quantities.{quantity}");
            if place_of(result, &path).is_some() {
                return path;
            }
        }
        self.quantity.clone()
    }

    /// Holds a number against the limit; `reason` is why there is none.
    pub fn check(
        &self,
        value: Option<f64>,
        interval: Option<Interval>,
        reason: String,
    ) -> LimitCheck {
        let (low, high) = match self.with {
            HeldAgainst::Value => (value, value),
            HeldAgainst::Interval => (
                interval.map(|interval| interval.low),
                interval.map(|interval| interval.high),
            ),
        };
        let above = self.at_least.map(|least| low.map(|low| low - least));
        let below = self.at_most.map(|most| high.map(|high| most - high));
        let margins = [above, below].into_iter().flatten();
        let margin = margins
            .reduce(|one, other| Some(one?.min(other?)))
            .flatten();
        let lacks_interval = value.is_some() && low.is_none();
        let why = if lacks_interval {
            "too few runs have it for an interval".to_owned()
        } else {
            reason
        };
        LimitCheck {
            limit: self.clone(),
            met: margin.is_some_and(|margin| margin >= 0.0),
            value,
            interval,
            margin,
            reason: margin.is_none().then_some(why),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn limit(value: Value) -> Limit {
        let mut faults = Vec::new();
        let checked = crate::registry::check_field(&value, &ONE, "", &mut faults);
        assert!(faults.is_empty(), "{faults:?}");
        serde_json::from_value(checked).unwrap()
    }

    #[test]
    fn a_number_at_its_limit_meets_it_and_what_is_null_meets_nothing() {
        let result = json!({
            "tfa": {"probability": {"correct": 0.9}},
            "metrics": {"clear": {"quantities": {"mota": {"value": 0.8, "unit": ""}, "motp": {"value": null, "reason": "nothing was matched"}}}}
        });
        let of = |value: Value| limit(value).check_result(&result);
        let found = of(json!({"quantity": "clear.mota", "at_least": 0.8}));
        assert_eq!(
            (found.met, found.value, found.margin),
            (true, Some(0.8), Some(0.0))
        );
        let found = of(json!({"quantity": "clear.mota", "at_least": 0.9}));
        assert!(!found.met && (found.margin.unwrap() + 0.1).abs() < 1e-12);
        let found =
            of(json!({"quantity": "tfa.probability.correct", "at_most": 0.95, "at_least": 0.85}));
        assert!(found.met && (found.margin.unwrap() - 0.05).abs() < 1e-12);
        let found = of(json!({"quantity": "clear.motp", "at_most": 1.0}));
        assert_eq!(
            (found.met, found.reason.as_deref()),
            (false, Some("nothing was matched"))
        );
        let found = of(json!({"quantity": "clear.moda", "at_least": 0.0}));
        assert!(!found.met && found.reason.unwrap().contains("there is no such number"));
        let found = of(json!({"quantity": "clear.motaa", "at_least": 0.0}));
        let told = "there is no such number; the nearest path is 'clear.mota'";
        assert_eq!(found.reason.as_deref(), Some(told));
    }

    #[test]
    fn the_interval_has_to_be_on_the_right_side_as_a_whole() {
        let interval = Some(Interval {
            low: 0.7,
            high: 0.9,
        });
        let of = |value: Value| limit(value).check(Some(0.8), interval, String::new());
        assert!(of(json!({"quantity": "x", "at_least": 0.75})).met);
        let found = of(json!({"quantity": "x", "at_least": 0.75, "with": "interval"}));
        assert!(!found.met && (found.margin.unwrap() + 0.05).abs() < 1e-12);
        assert!(of(json!({"quantity": "x", "at_most": 0.9, "with": "interval"})).met);
        let none = limit(json!({"quantity": "x", "at_most": 0.9, "with": "interval"}));
        let found = none.check(Some(0.8), None, String::new());
        assert_eq!(
            found.reason.as_deref(),
            Some("too few runs have it for an interval")
        );
    }
}
