//! Groups of reports against the targets that the reports really came from.
//!
//! # Reference
//! Cai Yubao et al., Application of fuzzy data association algorithm on multitarget tracking, tables 1 and 2: the accuracy of
//! "duplicate" targets, those that several sensors report.
//!
//! # Method
//! - A target with reports of two sensors or more is a duplicate; it is exact when all its reports are in one group and
//!   nothing else is.
//! - Pairs: two reports in one group are a found pair, two reports of one target a true one. Precision is the share of found
//!   pairs that are true, recall the share of true pairs that are found. A report of no target is in no true pair.

use serde::Serialize;
use std::collections::BTreeMap;

/// One report of an instant: who made it, of which target, and where it was put.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GroupedReport {
    pub sensor: u32,
    pub origin: Option<u32>,
    pub group: usize,
}

/// Counts of one instant, or of several added up.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct GroupingCounts {
    pub duplicates: u64,
    pub exact: u64,
    pub true_pairs: u64,
    pub found_pairs: u64,
    pub right_pairs: u64,
}

impl GroupingCounts {
    pub fn from_reports(reports: &[GroupedReport]) -> Self {
        let mut counts = GroupingCounts::default();
        let groups = sizes(reports.iter().map(|report| report.group));
        let both = sizes(
            reports
                .iter()
                .filter_map(|report| Some((report.origin?, report.group))),
        );
        let mut of_targets: BTreeMap<u32, Vec<&GroupedReport>> = BTreeMap::new();
        for report in reports {
            if let Some(origin) = report.origin {
                of_targets.entry(origin).or_default().push(report);
            }
        }
        for (origin, reports) in of_targets {
            counts.true_pairs += pairs(reports.len() as u64);
            if reports
                .iter()
                .all(|report| report.sensor == reports[0].sensor)
            {
                continue;
            }
            let size = reports.len() as u64;
            counts.duplicates += 1;
            let is_whole = both.get(&(origin, reports[0].group)) == Some(&size);
            counts.exact += u64::from(is_whole && groups.get(&reports[0].group) == Some(&size));
        }
        counts.found_pairs = groups.values().copied().map(pairs).sum();
        counts.right_pairs = both.values().copied().map(pairs).sum();
        counts
    }

    pub fn add(&mut self, other: &GroupingCounts) {
        self.duplicates += other.duplicates;
        self.exact += other.exact;
        self.true_pairs += other.true_pairs;
        self.found_pairs += other.found_pairs;
        self.right_pairs += other.right_pairs;
    }

    /// `None` without duplicates.
    pub fn accuracy(&self) -> Option<f64> {
        share(self.exact, self.duplicates)
    }

    /// `None` where no pair was found.
    pub fn precision(&self) -> Option<f64> {
        share(self.right_pairs, self.found_pairs)
    }

    /// `None` where there is no true pair.
    pub fn recall(&self) -> Option<f64> {
        share(self.right_pairs, self.true_pairs)
    }
}

fn share(part: u64, whole: u64) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}

fn pairs(members: u64) -> u64 {
    members * members.saturating_sub(1) / 2
}

fn sizes<K: Ord>(keys: impl Iterator<Item = K>) -> BTreeMap<K, u64> {
    let mut sizes = BTreeMap::new();
    keys.for_each(|key| *sizes.entry(key).or_default() += 1);
    sizes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (sensor, origin, group).
    fn counts(reports: &[(u32, Option<u32>, usize)]) -> GroupingCounts {
        let report = |&(sensor, origin, group): &(u32, Option<u32>, usize)| GroupedReport {
            sensor,
            origin,
            group,
        };
        GroupingCounts::from_reports(&reports.iter().map(report).collect::<Vec<_>>())
    }

    #[test]
    fn exact_split_and_mixed_targets() {
        // Target 0 is exact; 1 is split (3, 1); 2 shares its group with clutter; 3 is seen by one sensor alone.
        let reports = [
            (0, Some(0), 7),
            (1, Some(0), 7),
            (0, Some(1), 1),
            (1, Some(1), 1),
            (2, Some(1), 1),
            (3, Some(1), 9),
            (0, Some(2), 2),
            (1, Some(2), 2),
            (1, None, 2),
            (0, Some(3), 3),
        ];
        let counts = counts(&reports);
        // True pairs 1 + 6 + 1, found 1 + 3 + 3, right 1 + 3 + 1.
        let expected = GroupingCounts {
            duplicates: 3,
            exact: 1,
            true_pairs: 8,
            found_pairs: 7,
            right_pairs: 5,
        };
        assert_eq!(counts, expected);
        assert_eq!(
            (counts.accuracy(), counts.precision(), counts.recall()),
            (Some(1.0 / 3.0), Some(5.0 / 7.0), Some(5.0 / 8.0))
        );
    }

    #[test]
    fn two_targets_in_one_group_are_both_wrong() {
        let counts = counts(&[
            (0, Some(0), 1),
            (1, Some(0), 1),
            (0, Some(1), 1),
            (1, Some(1), 1),
        ]);
        assert_eq!(
            (
                counts.duplicates,
                counts.exact,
                counts.found_pairs,
                counts.right_pairs
            ),
            (2, 0, 6, 2)
        );
    }

    #[test]
    fn two_reports_of_one_sensor_make_no_duplicate() {
        let counts = counts(&[(0, Some(0), 1), (0, Some(0), 2)]);
        assert_eq!(
            (counts.duplicates, counts.true_pairs, counts.accuracy()),
            (0, 1, None)
        );
        assert_eq!(GroupingCounts::from_reports(&[]).precision(), None);
    }
}
