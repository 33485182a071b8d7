//! The life of a track: started by one unused detection, confirmed when M of its last N scans had a detection,
//! deleted after `max_missed` scans in a row without one.
//!
//! Confirmed tracks choose among all detections of a scan first, tentative ones among what is left, and what no track
//! used starts new tracks. Every scan counts, of whichever sensor.
//!
//! Under an associator with soft weights: a tentative track is served by global nearest neighbour until it is confirmed; a
//! detection is used when one track at least gives it a weight of 0.01; a scan had a detection for a track when the weights
//! of all its detections together exceed that of none.

use crate::model::track::TrackStatus;
use crate::registry::{Bound, Field, Kind, Object, Presence};
use serde::Deserialize;

pub static LIFECYCLE: Object = Object {
    name: "TrackerSettings",
    summary: "Gate, initiation, confirmation and deletion of tracks.",
    fields: &[
        Field {
            name: "gate_probability",
            summary: "P_G: the probability that a true detection lies inside its track's gate.",
            kind: Kind::Number { min: Bound::Excluding(0.0), max: Bound::Excluding(1.0), unit: "" },
            presence: Presence::Default("0.99"),
        },
        Field {
            name: "confirm_hits",
            summary: "M: detections that confirm a track.",
            kind: Kind::Integer { min: 1, max: 64, unit: "" },
            presence: Presence::Default("3"),
        },
        Field {
            name: "confirm_window",
            summary: "N: the last scans among which the M detections are counted; at least M.",
            kind: Kind::Integer { min: 1, max: 64, unit: "scans" },
            presence: Presence::Default("5"),
        },
        Field {
            name: "max_missed",
            summary: "Scans in a row without a detection that delete a track.",
            kind: Kind::Integer { min: 1, max: 1000, unit: "scans" },
            presence: Presence::Default("5"),
        },
        Field {
            name: "initial_speed_sigma_mps",
            summary: "Standard deviation of each velocity component of a new track, which starts at rest.",
            kind: Kind::Number { min: Bound::Excluding(0.0), max: Bound::Including(1e5), unit: "m/s" },
            presence: Presence::Default("10.0"),
        },
    ],
};

/// The parameters of [`LIFECYCLE`].
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Lifecycle {
    pub gate_probability: f64,
    pub confirm_hits: u32,
    pub confirm_window: u32,
    pub max_missed: u32,
    pub initial_speed_sigma_mps: f64,
}

/// What a track has lived through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Life {
    /// One bit a scan, the newest lowest: whether the track was given a detection.
    hits: u64,
    missed: u32,
    is_confirmed: bool,
}

impl Lifecycle {
    /// A track after its first detection.
    pub(super) fn start(&self) -> Life {
        let mut life = Life { hits: 0, missed: 0, is_confirmed: false };
        self.advance(&mut life, true);
        life
    }

    /// One more scan.
    pub(super) fn advance(&self, life: &mut Life, was_detected: bool) {
        life.hits = (life.hits << 1) | u64::from(was_detected);
        life.missed = if was_detected { 0 } else { life.missed + 1 };
        let window = u64::MAX >> (64 - self.confirm_window);
        life.is_confirmed |= (life.hits & window).count_ones() >= self.confirm_hits;
    }

    /// Ends the track with this scan.
    pub(super) fn end(&self, life: &mut Life) {
        life.missed = self.max_missed;
    }

    pub(super) fn is_over(&self, life: &Life) -> bool {
        life.missed >= self.max_missed
    }
}

impl Life {
    pub(super) fn is_confirmed(&self) -> bool {
        self.is_confirmed
    }

    pub(super) fn status(&self) -> TrackStatus {
        match (self.is_confirmed, self.missed) {
            (false, _) => TrackStatus::Tentative,
            (true, 0) => TrackStatus::Confirmed,
            (true, _) => TrackStatus::Coasted,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn statuses(lifecycle: &Lifecycle, detected: &str) -> String {
        let mut life = lifecycle.start();
        let mut seen = String::from(&life.status().name()[..1]);
        for symbol in detected.chars().skip(1) {
            lifecycle.advance(&mut life, symbol == '1');
            seen.push_str(if lifecycle.is_over(&life) { "x" } else { &life.status().name()[..1] });
        }
        seen
    }

    #[test]
    fn confirmation_counts_the_last_n_scans_and_deletion_counts_misses_in_a_row() {
        let lifecycle =
            Lifecycle { gate_probability: 0.99, confirm_hits: 3, confirm_window: 4, max_missed: 3, initial_speed_sigma_mps: 1.0 };
        assert_eq!(statuses(&lifecycle, "111"), "ttc");
        assert_eq!(statuses(&lifecycle, "11001011"), "tttttttc");
        assert_eq!(statuses(&lifecycle, "1111001000"), "ttcccccccx");
        assert_eq!(statuses(&lifecycle, "1000"), "tttx");
        let at_once = Lifecycle { confirm_hits: 1, confirm_window: 1, ..lifecycle };
        assert_eq!(statuses(&at_once, "1001"), "cccc");
        let long = Lifecycle { confirm_hits: 2, confirm_window: 64, max_missed: 100, ..lifecycle };
        assert_eq!(statuses(&long, &format!("1{}1", "0".repeat(62))).pop(), Some('c'));
        assert_eq!(statuses(&long, &format!("1{}1", "0".repeat(63))).pop(), Some('t'));
    }
}
