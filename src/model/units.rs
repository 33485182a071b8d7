//! How the units of a file fared: lines, rows, sentences, records or frames, whatever its format counts.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Every unit of a file has one of three fates: it is used, ignored (sound, but nothing that was asked for) or rejected.
/// `used`, the ignored and the rejected add up to `total`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct Units {
    /// What a unit is called: `line`, `row`, `sentence`, `record`, `frame`.
    pub called: String,
    pub total: u64,
    pub used: u64,
    /// How many of each kind: `duplicate`, `no position`, `message 24`.
    pub ignored: BTreeMap<String, u64>,
    /// By reason: `checksum`, `malformed`, `out_of_range`, `no_time` and others.
    pub rejected: BTreeMap<String, Rejected>,
}

/// Units rejected for one reason.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct Rejected {
    pub count: u64,
    /// Numbers of the first ten units, counted from 1: lines of a text, records or frames of other files.
    pub first: Vec<u64>,
}

/// How many units rejected for a reason are named.
const NAMED: usize = 10;

/// How many kinds of ignored units are told apart: those of a hostile file would not end.
const KINDS: usize = 100;

/// Why a unit is rejected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reason {
    Checksum,
    Truncated,
    EmptyPayload,
    IncompleteMessage,
    Malformed,
    UnknownType,
    UnsupportedEdition,
    OutOfRange,
    NotFinite,
    Missing,
    NoTime,
    NoIdentity,
    TimeJump,
    PositionJump,
    Duplicate,
}

impl Reason {
    pub fn name(self) -> &'static str {
        match self {
            Reason::Checksum => "checksum",
            Reason::Truncated => "truncated",
            Reason::EmptyPayload => "empty_payload",
            Reason::IncompleteMessage => "incomplete_message",
            Reason::Malformed => "malformed",
            Reason::UnknownType => "unknown_type",
            Reason::UnsupportedEdition => "unsupported_edition",
            Reason::OutOfRange => "out_of_range",
            Reason::NotFinite => "not_finite",
            Reason::Missing => "missing",
            Reason::NoTime => "no_time",
            Reason::NoIdentity => "no_identity",
            Reason::TimeJump => "time_jump",
            Reason::PositionJump => "position_jump",
            Reason::Duplicate => "duplicate",
        }
    }
}

impl Units {
    pub fn called(word: &str) -> Self {
        Units {
            called: word.to_owned(),
            ..Units::default()
        }
    }

    pub fn use_up(&mut self, units: u64) {
        self.total += units;
        self.used += units;
    }

    pub fn ignore(&mut self, kind: &str, units: u64) {
        self.total += units;
        if let Some(count) = self.ignored.get_mut(kind) {
            *count += units;
            return;
        }
        let kind = if self.ignored.len() < KINDS {
            kind
        } else {
            "other"
        };
        *self.ignored.entry(kind.to_owned()).or_default() += units;
    }

    /// Units that were counted as used, but are not asked for after all.
    pub fn ignore_used(&mut self, kind: &str, units: u64) {
        let units = units.min(self.used);
        if units > 0 {
            self.used -= units;
            self.total -= units;
            self.ignore(kind, units);
        }
    }

    /// `unit` is the number of the first of them.
    pub fn reject(&mut self, reason: Reason, unit: u64, units: u64) {
        self.total += units;
        let rejected = self.rejected.entry(reason.name().to_owned()).or_default();
        rejected.count += units;
        if rejected.first.len() < NAMED {
            rejected.first.push(unit);
        }
    }

    /// Adds how others fared.
    pub fn add(&mut self, other: &Units) {
        self.total += other.total;
        self.used += other.used;
        for (kind, count) in &other.ignored {
            *self.ignored.entry(kind.clone()).or_default() += count;
        }
        for (reason, rejected) in &other.rejected {
            let own = self.rejected.entry(reason.clone()).or_default();
            own.count += rejected.count;
            let room = NAMED.saturating_sub(own.first.len());
            own.first.extend(rejected.first.iter().take(room));
        }
    }

    pub fn ignored_count(&self) -> u64 {
        self.ignored.values().sum()
    }

    pub fn rejected_count(&self) -> u64 {
        self.rejected.values().map(|rejected| rejected.count).sum()
    }

    /// All that was not used, in one line: ignored kinds and reasons, with their counts.
    pub fn fates(&self) -> String {
        let ignored = self
            .ignored
            .iter()
            .map(|(kind, count)| format!("{kind} {count}"));
        let rejected = self
            .rejected
            .iter()
            .map(|(reason, rejected)| format!("{reason} {}", rejected.count));
        let list: Vec<String> = ignored.chain(rejected).collect();
        list.join(", ")
    }

    /// What a user is told of rejected units, a line a reason: `record`s 5, 9 and 14 more.
    pub fn rejections(&self) -> Vec<String> {
        let told = |(reason, rejected): (&String, &Rejected)| {
            let first: Vec<String> = rejected.first.iter().map(u64::to_string).collect();
            let more = rejected.count.saturating_sub(rejected.first.len() as u64);
            let rest = if more > 0 {
                format!(" and {more} more")
            } else {
                String::new()
            };
            format!("{}: {} {}{rest}", reason, self.called, first.join(", "))
        };
        self.rejected.iter().map(told).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fates_add_up_and_the_first_rejects_are_named() {
        let mut units = Units::called("line");
        units.use_up(3);
        units.ignore("duplicate", 2);
        for line in 1..=12 {
            units.reject(Reason::Checksum, line, 1);
        }
        assert_eq!((units.total, units.used, units.ignored_count()), (17, 3, 2));
        assert_eq!(units.rejected_count(), 12);
        let told = units.rejections();
        assert_eq!(
            told,
            ["checksum: line 1, 2, 3, 4, 5, 6, 7, 8, 9, 10 and 2 more"]
        );
    }

    #[test]
    fn kinds_without_end_become_one() {
        let mut units = Units::called("record");
        for kind in 0..1000 {
            units.ignore(&format!("message {kind}"), 1);
        }
        assert_eq!(
            (units.ignored.len(), units.ignored["other"]),
            (KINDS + 1, 900)
        );
    }
}
