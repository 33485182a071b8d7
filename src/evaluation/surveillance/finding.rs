//! What is told of one requirement in one sector.

use super::reference::Phase;
use super::score::{Score, Statistics};
use super::settings::{PER_HOUR, Requirement};
use crate::math::stats::Interval;
use serde::Serialize;
use std::collections::BTreeMap;

/// One requirement in one sector.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = RequirementFinding))]
pub struct Finding {
    pub sector_id: String,
    /// Its name, else its kind.
    pub requirement: String,
    pub kind: &'static str,
    pub phase: Option<&'static str>,
    /// Null where nothing could be judged.
    pub value: Option<f64>,
    /// Empty of a share.
    pub unit: &'static str,
    /// `>=`, `<=`, `>` or `<`.
    pub comparison: Option<&'static str>,
    pub threshold: Option<f64>,
    /// How far the value is on the right side; negative where it is not.
    pub margin: Option<f64>,
    /// `pass` or `fail`; null without a value or a threshold.
    pub verdict: Option<&'static str>,
    /// Counts over all targets: a share is one over the other.
    pub numerator: u64,
    pub denominator: u64,
    /// Wilson's, of a share.
    pub interval_95: Option<Interval>,
    /// Hours in which targets were due, of values per hour.
    pub hours: Option<f64>,
    /// Of the errors that were judged.
    pub errors: Option<Statistics>,
    /// Updates that could not be judged, by reason.
    pub not_judged: BTreeMap<&'static str, u64>,
    /// Targets that were due in the sector.
    pub targets: usize,
    /// Of these, those without any update there.
    pub targets_without_update: usize,
    /// Whether one target that fails is enough.
    pub each_target: bool,
    pub failed_target_count: usize,
    /// The first 100, the worst first.
    pub failed_targets: Vec<FailedTarget>,
}

/// A target that does not meet a requirement by itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct FailedTarget {
    pub truth_id: String,
    pub value: f64,
}

/// Of the targets of a requirement.
#[derive(Debug, Default)]
pub struct OfTargets {
    pub due: usize,
    pub without_update: usize,
    pub failed_count: usize,
    pub failed: Vec<FailedTarget>,
}

impl Requirement {
    /// What the counts of all targets say.
    pub fn finding(&self, sector_id: &str, sum: Score, targets: OfTargets) -> Finding {
        let check = &self.check;
        let value = sum.value(check);
        let comparison = self.bound.comparison();
        let held = value.and_then(|value| self.bound.hold(value));
        let verdict = held.map(|(_, is_held)| {
            let is_met = if self.each_target {
                targets.failed_count == 0
            } else {
                is_held
            };
            if is_met { "pass" } else { "fail" }
        });
        Finding {
            sector_id: sector_id.to_owned(),
            requirement: self.name.clone().unwrap_or_else(|| check.name().to_owned()),
            kind: check.name(),
            phase: self.phase.map(Phase::name),
            value,
            unit: check.unit(),
            comparison: comparison.map(|(comparison, _)| comparison),
            threshold: comparison.map(|(_, threshold)| threshold),
            margin: held.map(|(margin, _)| margin),
            verdict,
            numerator: sum.numerator,
            denominator: sum.denominator,
            interval_95: sum.interval(check),
            hours: (check.unit() == PER_HOUR).then_some(sum.hours),
            errors: sum.statistics(check),
            not_judged: sum.not_judged,
            targets: targets.due,
            targets_without_update: targets.without_update,
            each_target: self.each_target,
            failed_target_count: targets.failed_count,
            failed_targets: targets.failed,
        }
    }
}
