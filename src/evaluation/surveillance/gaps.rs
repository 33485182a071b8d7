//! Periods in which a target is due, the updates that are expected in them, and the gaps between those that came.
//!
//! # Symbols
//! I update interval, τ tolerance, g the length of a gap, g′ = g − τ.

use serde::Deserialize;

/// Times are sums that were rounded: those that differ by no more are the same.
const ROUNDING_S: f64 = 1e-6;

/// Shorter periods expect nothing.
const SHORTEST_PERIOD_S: f64 = 1.0;

/// From when to when a target is due; both belong to it.
pub type Period = (f64, f64);

/// How misses are counted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Count {
    /// ⌊g′ / I⌋ of each gap.
    #[default]
    Gaps,
    /// Each interval of I seconds from a period's begin on that holds no update.
    Slots,
}

/// Which gaps count, and how much.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GapRule {
    pub update_interval_s: f64,
    pub tolerance_s: f64,
    pub min_gap_s: Option<f64>,
    pub max_gap_s: Option<f64>,
    pub count: Count,
}

/// Whether a time is at most another, roundings aside.
pub fn is_at_most(time_s: f64, limit_s: f64) -> bool {
    time_s <= limit_s + ROUNDING_S
}

/// The periods of reference points in the order of time: each ends at a point outside, and where the next is more than
/// `longest_gap_s` away.
pub fn periods(points: impl IntoIterator<Item = (f64, bool)>, longest_gap_s: f64) -> Vec<Period> {
    let mut periods: Vec<Period> = Vec::new();
    let mut is_open = false;
    for (time_s, is_inside) in points {
        match periods.last_mut() {
            Some(last) if is_inside && is_open && is_at_most(time_s - last.1, longest_gap_s) => {
                last.1 = time_s;
            }
            _ if is_inside => periods.push((time_s, time_s)),
            _ => {}
        }
        is_open = is_inside;
    }
    periods.retain(|(from_s, to_s)| is_at_most(SHORTEST_PERIOD_S, to_s - from_s));
    periods
}

/// Whether a period covers a time.
pub fn covers(periods: &[Period], time_s: f64) -> bool {
    let after = periods.partition_point(|period| period.0 <= time_s);
    after > 0 && time_s <= periods[after - 1].1
}

impl GapRule {
    /// Σ ⌊duration / I⌋.
    pub fn expected(&self, periods: &[Period]) -> u64 {
        let of = |(from_s, to_s): &Period| self.intervals(to_s - from_s);
        periods.iter().map(of).sum()
    }

    fn intervals(&self, duration_s: f64) -> u64 {
        ((duration_s + ROUNDING_S) / self.update_interval_s).floor() as u64
    }

    /// 0 of g′ ≤ I and of a gap outside `min_gap_s … max_gap_s`, else ⌊g′ / I⌋.
    pub fn misses(&self, gap_s: f64) -> u64 {
        let left_s = gap_s - self.tolerance_s;
        let is_short = self
            .min_gap_s
            .is_some_and(|least_s| !is_at_most(least_s, left_s));
        let is_long = self
            .max_gap_s
            .is_some_and(|most_s| !is_at_most(left_s, most_s));
        if is_short || is_long || is_at_most(left_s, self.update_interval_s) {
            0
        } else {
            self.intervals(left_s)
        }
    }

    /// What is missed in the periods, each gap or empty slot with its misses. `updates` are times in order, with whether each counts
    /// (`Some(true)`), is as if it were not there (`Some(false)`), or lies outside the sector, which breaks the count (`None`).
    pub fn missed(
        &self,
        periods: &[Period],
        updates: &[(f64, Option<bool>)],
    ) -> Vec<(Period, u64)> {
        let mut missed = Vec::new();
        for period in periods {
            let first = updates.partition_point(|update| update.0 < period.0);
            let inside = updates[first..].partition_point(|update| update.0 <= period.1);
            let updates = &updates[first..first + inside];
            match self.count {
                Count::Gaps => self.add_gaps(*period, updates, &mut missed),
                Count::Slots => self.add_slots(*period, updates, &mut missed),
            }
        }
        missed
    }

    fn add_gaps(
        &self,
        period: Period,
        updates: &[(f64, Option<bool>)],
        missed: &mut Vec<(Period, u64)>,
    ) {
        let mut from_s = Some(period.0);
        let last = (period.1, Some(true));
        for &(time_s, counts) in updates.iter().chain([&last]) {
            match (counts, from_s) {
                (None, _) => from_s = None,
                (Some(false), _) => {}
                (Some(true), since_s) => {
                    let gap = since_s.map(|since_s| (since_s, time_s));
                    let misses = gap.map_or(0, |gap| self.misses(gap.1 - gap.0));
                    missed.extend(gap.filter(|_| misses > 0).map(|gap| (gap, misses)));
                    from_s = Some(time_s);
                }
            }
        }
    }

    fn add_slots(
        &self,
        period: Period,
        updates: &[(f64, Option<bool>)],
        missed: &mut Vec<(Period, u64)>,
    ) {
        let seen = updates.iter().filter(|update| update.1 == Some(true));
        let mut seen = seen.peekable();
        for slot in 0..self.intervals(period.1 - period.0) {
            let from_s = period.0 + slot as f64 * self.update_interval_s;
            let to_s = from_s + self.update_interval_s;
            let mut is_empty = true;
            while seen.next_if(|update| !is_at_most(to_s, update.0)).is_some() {
                is_empty = false;
            }
            if is_empty {
                missed.push(((from_s, to_s), 1));
            }
        }
    }
}
