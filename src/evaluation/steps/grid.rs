//! Steps at the times of the truth, or on a grid.
//!
//! # Method
//! 1. The times of all targets are steps where the median target has points at three quarters or more of those in its life: two clocks
//!    that take turns leave each a half and a little.
//! 2. Else targets have clocks of their own, and nobody says where two of them are at one time: then the steps are a grid from
//!    the first time on, as far apart as the points of a target usually are, at the times at which any target exists.

use super::{MOST_MADE_UP, Steps, sort_times};
use crate::evaluation::paths::{Paths, gaps_s, median};
use crate::model::time::rounding_s;

/// Of the steps in the life of the median target.
const LEAST_SHARE: f64 = 0.75;

impl Steps {
    pub(super) fn take_truth(&mut self, paths: &Paths) {
        let times_s = self.times_of_truth(paths);
        let mut shares: Vec<f64> = paths
            .targets()
            .iter()
            .filter_map(|target| {
                let (first, last) = (target.points.first()?, target.points.last()?);
                let from_s = first.time_s - self.tolerance_s - rounding_s(first.time_s);
                let from = times_s.partition_point(|time_s| *time_s < from_s);
                let to = times_s.partition_point(|time_s| *time_s <= last.time_s);
                Some(target.points.len() as f64 / (to - from).max(1) as f64)
            })
            .collect();
        shares.sort_unstable_by(f64::total_cmp);
        match usual_period_s(paths) {
            Some(period_s) if median(&shares).is_some_and(|share| share < LEAST_SHARE) => {
                self.take_grid(
                    paths,
                    period_s,
                    "a grid, because targets have clocks of their own",
                );
            }
            _ => self.take_times_of_truth(paths),
        }
    }

    pub(super) fn take_times_of_truth(&mut self, paths: &Paths) {
        self.made_of = "the times of the truth";
        self.period_s = usual_period_s(paths);
        let half_s = 0.5 * self.period_s.unwrap_or(0.0);
        let times_s = self.times_of_truth(paths);
        self.take_windows(times_s.into_iter().map(|time_s| (time_s, half_s)));
    }

    /// Of times nearer than τ the first.
    fn times_of_truth(&self, paths: &Paths) -> Vec<f64> {
        let points = paths.targets().iter().flat_map(|target| &target.points);
        let mut kept: Vec<f64> = Vec::new();
        for time_s in sort_times(points.map(|point| point.time_s)) {
            if kept
                .last()
                .is_none_or(|last_s| time_s - last_s > self.tolerance_s + rounding_s(time_s))
            {
                kept.push(time_s);
            }
        }
        kept
    }

    pub(super) fn take_grid(&mut self, paths: &Paths, period_s: f64, made_of: &'static str) {
        let stretches_s = paths.stretches_s();
        let Some(&(start_s, _)) = stretches_s.first() else {
            return;
        };
        let mut steps: Vec<(f64, f64)> = Vec::new();
        for (from_s, to_s) in stretches_s {
            // A step that rounding puts outside a stretch is in it.
            let rounding = rounding_s(to_s) / period_s;
            let first = ((from_s - start_s) / period_s - rounding).ceil().max(0.0);
            let last = ((to_s - start_s) / period_s + rounding).floor();
            if last - first >= (MOST_MADE_UP - steps.len().min(MOST_MADE_UP)) as f64 {
                self.warnings.push(format!(
                    "steps {period_s} s apart would be more than {MOST_MADE_UP}: the steps are the times of the truth"
                ));
                return self.take_times_of_truth(paths);
            }
            let mut place = first;
            while place <= last {
                let time_s = start_s + place * period_s;
                if steps.last().is_none_or(|&(before_s, _)| before_s < time_s) {
                    steps.push((time_s, 0.5 * period_s));
                }
                place += 1.0;
            }
        }
        (self.made_of, self.period_s) = (made_of, Some(period_s));
        self.take_windows(steps.into_iter());
    }
}

/// The median time between two points of a target, over all targets.
fn usual_period_s(paths: &Paths) -> Option<f64> {
    let mut all_s: Vec<f64> = paths.targets().iter().flat_map(gaps_s).collect();
    all_s.sort_unstable_by(f64::total_cmp);
    let first = paths
        .targets()
        .iter()
        .find_map(|target| target.points.first());
    Some(plainest(median(&all_s)?, rounding_s(first?.time_s)))
}

/// The number of fewest decimals that differs by rounding alone: a grid of many periods would add up what was rounded.
fn plainest(period_s: f64, rounding_s: f64) -> f64 {
    let rounded = |decimals: i32| {
        let scale = 10f64.powi(decimals);
        (period_s * scale).round() / scale
    };
    let mut candidates = (0..=9).map(rounded);
    let found =
        candidates.find(|plain_s| *plain_s > 0.0 && (plain_s - period_s).abs() <= rounding_s);
    found.unwrap_or(period_s)
}
