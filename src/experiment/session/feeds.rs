//! Which scans of each sender have come: what comes twice is taken once, and what is left out is told.

use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Numbers left out that may still come; of more, the oldest are given up.
const MAX_MISSING: usize = 4096;

/// What was heard of one sensor.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Feed {
    /// The lowest number that came.
    first: u64,
    /// The number that comes next.
    next: Option<u64>,
    missing: BTreeSet<u64>,
    /// Time of its newest scan or heartbeat.
    pub newest_s: Option<f64>,
}

/// What becomes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Admission {
    /// It is new, and this many before it are missing.
    New { sequence: u64, missing: u64 },
    /// It has come before.
    Duplicate,
}

impl Feed {
    /// Takes a number; the next one where the sender does not count.
    pub fn admit(&mut self, sequence: Option<u64>) -> Admission {
        let sequence = sequence.unwrap_or_else(|| self.next.unwrap_or(1));
        if self.next.is_none() {
            self.first = sequence;
        }
        let next = self.next.unwrap_or(sequence);
        if sequence < self.first {
            // The sender began earlier than was known.
            self.note_missing(sequence + 1, self.first);
            self.first = sequence;
            return Admission::New {
                sequence,
                missing: 0,
            };
        }
        if sequence < next {
            return if self.missing.remove(&sequence) {
                Admission::New {
                    sequence,
                    missing: 0,
                }
            } else {
                Admission::Duplicate
            };
        }
        let missing = sequence - next;
        self.note_missing(next, sequence);
        self.next = Some(sequence + 1);
        Admission::New { sequence, missing }
    }

    /// Notes the numbers between as missing, the latest where there are too many.
    fn note_missing(&mut self, from: u64, to: u64) {
        let first = from.max(to.saturating_sub(MAX_MISSING as u64));
        self.missing.extend(first..to);
        while self.missing.len() > MAX_MISSING {
            self.missing.pop_first();
        }
    }

    /// The greatest number that came.
    pub fn last(&self) -> Option<u64> {
        self.next.map(|next| next - 1)
    }

    /// Hears of a time.
    pub fn hear(&mut self, time_s: f64) {
        let newest_s = self.newest_s.unwrap_or(time_s);
        self.newest_s = Some(newest_s.max(time_s));
    }
}

/// The time of everything that was heard; `None` before anything was.
pub fn newest_s(feeds: &[Feed]) -> Option<f64> {
    feeds
        .iter()
        .filter_map(|feed| feed.newest_s)
        .reduce(f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_twice_is_taken_once_and_what_is_left_out_may_still_come() {
        let mut feed = Feed::default();
        let mut admit = |sequence| match feed.admit(sequence) {
            Admission::New { sequence, missing } => Some((sequence, missing)),
            Admission::Duplicate => None,
        };
        assert_eq!(admit(Some(7)), Some((7, 0)));
        assert_eq!(admit(Some(7)), None);
        assert_eq!(admit(Some(10)), Some((10, 2)));
        assert_eq!(admit(Some(9)), Some((9, 0)));
        assert_eq!(admit(Some(9)), None);
        assert_eq!(admit(None), Some((11, 0)));
        assert_eq!(admit(Some(8)), Some((8, 0)));
        assert_eq!(admit(Some(4)), Some((4, 0)), "the sender began earlier");
        assert_eq!(admit(Some(5)), Some((5, 0)));
        assert_eq!(admit(Some(5)), None);
        assert_eq!(admit(Some(8)), None);
    }

    #[test]
    fn a_huge_gap_costs_no_more_than_a_bounded_one() {
        let mut feed = Feed::default();
        feed.admit(Some(1));
        let far = 1 << 53;
        let admitted = feed.admit(Some(far));
        assert_eq!(
            admitted,
            Admission::New {
                sequence: far,
                missing: far - 2
            }
        );
        assert_eq!(feed.missing.len(), MAX_MISSING);
        assert_eq!(feed.admit(Some(2)), Admission::Duplicate, "given up");
        assert_ne!(feed.admit(Some(far - 1)), Admission::Duplicate);
    }
}
