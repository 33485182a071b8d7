//! The life of a track: started by detections that no track used ([`super::initiation`]), confirmed by hits or by score
//! or by their probability of existence ([`super::confirmation`]), deleted after `max_missed` scans in a row without a detection or after `max_missed_s` without
//! one, when its score says so, or when its position has become too uncertain (which also ends a track of a soft associator,
//! whose weights may never be a miss).
//! A track that was given at the start is confirmed from then on and never deleted: a lost one is to be judged, not forgotten.
//!
//! Confirmed tracks choose among all detections of a scan first, tentative ones among what is left, and what no track used
//! goes to the initiation; where tracks have a probability of existence, all choose together. So a detection inside a confirmed track's gate starts a track only if it stayed unused by all. A
//! track that ends does so before the scan, and uses none of its detections.
//!
//! # What a miss counts
//! A scan of any sensor counts by its share: P_D of the track there over the highest P_D of all sensors, 1 at most. A miss of
//! a sensor that does not see the track changes nothing, one where it hardly sees it hardly anything; and it is one of the
//! scans among which detections are counted where its share is one half at least.
//!
//! P_D is rarely known for each track, so a sensor is taken to see a track only if it detected it lately: among the last
//! `max_missed` detections of the track by whichever sensors, or the `max_missed` before these. A tentative track is too young
//! to tell: all sensors that ever detected a confirmed track are taken to see it, so that what one sensor alone sees of clutter is
//! not confirmed the more easily. Misses of the others count nothing. For one sensor alone this changes nothing.
//!
//! So that what has left every field of view ends too, a track ends after [`UNSEEN`] times `max_missed` scans of the sensor that
//! detected it last, whatever they count.
//!
//! Under an associator with soft weights: a tentative track is served by global nearest neighbour until it is confirmed; a
//! detection is used when one track at least gives it a weight of 0.01; a scan had a detection for a track when the weights
//! of all its detections together exceed that of none.

use super::confirmation::{CONFIRMATION, Confirmation, Score};
use super::existence::{ExistenceRule, by_ratio, survival};
use super::initiation::{INITIATION, Initiation};
use super::twins::{MERGING, Merging};
use super::undetected::UNDETECTED;
use crate::model::track::TrackStatus;
use crate::registry::{Kind, Object, above, check, default, optional, whole};
use crate::tracking::bits;
use crate::tracking::smoothing::{SMOOTHING, Smoothing};
use nalgebra::SMatrix;
use serde::{Deserialize, Serialize};
use serde_json::json;

pub static LIFECYCLE: Object = Object {
    name: "TrackerSettings",
    summary: "Gate, initiation, confirmation and deletion of tracks.",
    fields: &[
        default(
            "method",
            "What turns scans into tracks: single_hypothesis decides after each scan which detections continue which track, for good; poisson_multi_bernoulli does so, too, with a probability of existence for each track and a Poisson process of targets that were never detected (Williams 2015). Of the fields that follow it uses those of gate, position, space, speed and smoothing, and undetected.",
            Kind::Choice(&[super::NAME, super::super::poisson_multi_bernoulli::NAME]),
            r#""single_hypothesis""#,
        ),
        default(
            "gate_probability",
            "P_G: the probability that a true detection lies inside its track's gate; with 1 there is no gate, and every detection of a scan is a candidate of every track.",
            above(0.0, 1.0, ""),
            "0.99",
        ),
        default(
            "initiation",
            "How tracks begin.",
            Kind::Union(&INITIATION),
            r#"{"method":"one_point"}"#,
        ),
        default(
            "confirmation",
            "When a track is confirmed.",
            Kind::Union(&CONFIRMATION),
            r#"{"rule":"m_of_n"}"#,
        ),
        optional(
            "confirm_hits",
            "M of the rule m_of_n: detections that confirm a track. When absent 3; where P_D is estimated from the data, the most that three targets of four meet in N scans, if that is more, and the report tells it.",
            whole(1, 64, ""),
        ),
        default(
            "confirm_window",
            "N of the rule m_of_n: the last scans among which the M detections are counted; at least M.",
            whole(1, 64, "scans"),
            "5",
        ),
        default(
            "max_missed",
            "Scans in a row without a detection that delete a track, under every rule of confirmation; not used with max_missed_s.",
            whole(1, 1000, "scans"),
            "5",
        ),
        optional(
            "max_missed_s",
            "A track is deleted at the first scan more than this after its last detection, in place of max_missed.",
            above(0.0, 1e6, "s"),
        ),
        optional(
            "max_position_sigma_m",
            "A track is deleted when the largest standard deviation of its position exceeds this; no limit when absent.",
            above(0.0, 1e9, "m"),
        ),
        optional(
            "space",
            "plane: a recording of a volume is tracked in the plane, without heights; of a slant range with its elevation the part along the ground is used. When absent, it is tracked in space.",
            Kind::Choice(&["plane"]),
        ),
        optional(
            "initial_speed_sigma_mps",
            "Standard deviation of each velocity component of a track of one point, which starts at rest. When absent, it follows from the targets of a scenario or is estimated from the data, and the report tells it.",
            above(0.0, 1e5, "m/s"),
        ),
        optional(
            "undetected",
            "Of the method poisson_multi_bernoulli: targets that were never detected.",
            Kind::Object(&UNDETECTED),
        ),
        optional(
            "smoothing",
            "Whether each estimate is made once more in the light of later scans: smoothed_tracks.csv beside tracks.csv, and the metrics of both.",
            Kind::Union(&SMOOTHING),
        ),
        optional(
            "merging",
            "Two confirmed tracks on one target become one; never when absent.",
            Kind::Object(&MERGING),
        ),
    ],
};

/// The parameters of [`LIFECYCLE`].
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Lifecycle {
    pub gate_probability: f64,
    pub initiation: Initiation,
    pub confirmation: Confirmation,
    #[serde(default = "usual_hits")]
    pub confirm_hits: u32,
    pub confirm_window: u32,
    pub max_missed: u32,
    #[serde(default)]
    pub max_missed_s: Option<f64>,
    pub max_position_sigma_m: Option<f64>,
    #[serde(default = "assumed_speed_sigma_mps")]
    pub initial_speed_sigma_mps: f64,
    pub smoothing: Option<Smoothing>,
    #[serde(default)]
    pub merging: Option<Merging>,
}

/// As a request that says nothing has it.
impl Default for Lifecycle {
    fn default() -> Self {
        let fields =
            check(&json!({}), &LIFECYCLE).expect("every field has a default or may be absent");
        Lifecycle::deserialize(fields).expect("the defaults are a life cycle")
    }
}

fn usual_hits() -> u32 {
    Lifecycle::USUAL_HITS
}

fn assumed_speed_sigma_mps() -> f64 {
    Lifecycle::ASSUMED_SPEED_SIGMA_MPS
}

/// What a track has lived through.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct TrackLifecycleState {
    /// One bit a scan that counts, the newest lowest: whether the track was given a detection.
    hits: u64,
    /// What the misses since the last detection count.
    #[serde(with = "bits")]
    missed: f64,
    /// Scans of `last_sensor` since it detected the track.
    unseen: u32,
    /// The sensor that detected it last, and when.
    last_sensor: u32,
    #[serde(with = "bits")]
    last_time_s: f64,
    /// One bit a sensor: which of them took part in the last detections, and in those before.
    seen_by: [u64; 2],
    /// Detections that `seen_by[0]` tells of.
    detections: u32,
    /// Whether the last scan had no detection for it.
    is_missed: bool,
    is_confirmed: bool,
    is_over: bool,
    /// Whether no rule of deletion applies to it.
    is_permanent: bool,
    score: Score,
    /// r.
    #[serde(with = "bits")]
    existence: f64,
}

/// What a scan is to a track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Glance {
    pub time_s: f64,
    /// Index of the sensor.
    pub sensor: usize,
    pub was_detected: bool,
    /// Whether the sensor ever detected a confirmed track.
    pub finds_targets: bool,
    /// P_D of the track over the highest of the sensors.
    pub share: f64,
    /// What the scan adds to the score; matters only when [`Lifecycle::is_scored`].
    pub log_ratio: f64,
    /// r after the scan, where that says more than `log_ratio`.
    pub existence: Option<f64>,
}

/// A track that its last sensor does not see ends after so many times `max_missed` of its scans.
const UNSEEN: u32 = 20;
/// A scan without a detection is one of those among which detections are counted if its share is at least this.
const LEAST_SHARE: f64 = 0.5;

impl Glance {
    /// A detection that is the first of a track.
    pub fn first(time_s: f64, sensor: usize) -> Self {
        Glance {
            time_s,
            sensor,
            was_detected: true,
            finds_targets: false,
            share: 1.0,
            log_ratio: 0.0,
            existence: None,
        }
    }
}

impl Lifecycle {
    /// Where neither the request nor the scene nor the data tell how fast targets are.
    pub const ASSUMED_SPEED_SIGMA_MPS: f64 = 10.0;
    /// Detections that confirm a track where nothing says how many.
    pub const USUAL_HITS: u32 = 3;

    /// A track after its first detection.
    pub(super) fn start(&self, first: &Glance) -> TrackLifecycleState {
        let mut life = TrackLifecycleState {
            is_confirmed: false,
            is_permanent: false,
            ..TrackLifecycleState::permanent()
        };
        self.advance(&mut life, first);
        life
    }

    /// A track that somebody begins: confirmed, as probable as others are when they are, and seen by any sensor.
    pub(super) fn begin_by_hand(&self, time_s: f64) -> TrackLifecycleState {
        let rule = self.existence_rule();
        TrackLifecycleState {
            hits: 1,
            last_time_s: time_s,
            seen_by: [u64::MAX; 2],
            is_permanent: false,
            existence: rule.map_or(1.0, |rule| rule.confirm_existence),
            ..TrackLifecycleState::permanent()
        }
    }

    /// One more scan.
    #[inline]
    pub(super) fn advance(&self, life: &mut TrackLifecycleState, glance: &Glance) {
        let share = self.look(life, glance);
        if glance.was_detected || share >= LEAST_SHARE {
            life.hits = (life.hits << 1) | u64::from(glance.was_detected);
        }
        life.is_over |= match self.max_missed_s {
            Some(limit_s) => glance.time_s - life.last_time_s > limit_s,
            None => self.is_lost(life),
        };
        match &self.confirmation {
            Confirmation::MOfN => {
                let window = u64::MAX >> (64 - self.confirm_window);
                life.is_confirmed |= (life.hits & window).count_ones() >= self.confirm_hits;
            }
            Confirmation::Score(rule) => {
                life.score.add(glance.log_ratio);
                life.is_confirmed |= rule.is_confirmed(&life.score);
                life.is_over |= rule.is_over(&life.score, life.is_confirmed);
            }
            Confirmation::Existence(rule) if !life.is_permanent => {
                let by_ratio = || by_ratio(life.existence, glance.log_ratio);
                life.existence = glance.existence.unwrap_or_else(by_ratio);
                life.is_confirmed |= life.existence >= rule.confirm_existence;
                life.is_over |= life.existence <= rule.delete_existence;
            }
            Confirmation::Existence(_) => {}
        }
        life.is_over &= !life.is_permanent;
    }

    /// Whether too many scans missed the track; its existence takes account of each miss by itself.
    fn is_lost(&self, life: &TrackLifecycleState) -> bool {
        let is_missed = self.existence_rule().is_none();
        (is_missed && life.missed >= f64::from(self.max_missed))
            || life.unseen >= UNSEEN.saturating_mul(self.max_missed)
    }

    /// Whether a sensor is taken to see a track, so that a miss tells something.
    pub(super) fn sees(
        &self,
        life: &TrackLifecycleState,
        sensor: usize,
        finds_targets: bool,
    ) -> bool {
        let saw = (life.seen_by[0] | life.seen_by[1]) & (1 << sensor.min(63)) != 0;
        saw || (finds_targets && !life.is_confirmed)
    }

    /// Counts a detection or a miss, and tells what a miss counts.
    #[inline]
    fn look(&self, life: &mut TrackLifecycleState, glance: &Glance) -> f64 {
        let bit = 1 << glance.sensor.min(63);
        life.is_missed = !glance.was_detected;
        if glance.was_detected {
            if life.detections >= self.max_missed {
                (life.seen_by, life.detections) = ([0, life.seen_by[0]], 0);
            }
            life.seen_by[0] |= bit;
            life.detections = life.detections.saturating_add(1);
            (life.missed, life.unseen) = (0.0, 0);
            (life.last_sensor, life.last_time_s) = (glance.sensor as u32, glance.time_s);
            return 0.0;
        }
        let sees = self.sees(life, glance.sensor, glance.finds_targets);
        let share = if sees { glance.share.min(1.0) } else { 0.0 };
        life.missed += share;
        let is_last = glance.sensor as u32 == life.last_sensor;
        life.unseen = life.unseen.saturating_add(u32::from(is_last));
        share
    }

    /// Ends a track whose position is too uncertain to be of use.
    #[inline]
    pub(super) fn limit<const K: usize>(
        &self,
        life: &mut TrackLifecycleState,
        covariance: impl FnOnce() -> SMatrix<f64, K, K>,
    ) {
        if let Some(limit_m) = self.max_position_sigma_m.filter(|_| !life.is_permanent) {
            life.is_over |= largest_variance(&covariance()) > limit_m * limit_m;
        }
    }

    /// The same for a track whose beginning is decided already: its existence ends it at no scan before.
    pub(super) fn forbearing(&self) -> Lifecycle {
        let mut lifecycle = *self;
        if let Confirmation::Existence(rule) = &mut lifecycle.confirmation {
            rule.delete_existence = 0.0;
        }
        lifecycle
    }

    /// Whether tracks are judged by their score.
    pub(super) fn is_scored(&self) -> bool {
        matches!(self.confirmation, Confirmation::Score(_))
    }

    /// Whether a point of a track is told.
    pub(super) fn tells(&self, life: &TrackLifecycleState) -> bool {
        let rule = self.existence_rule();
        rule.is_none_or(|rule| life.is_permanent || life.existence > rule.report_existence)
    }

    /// r, where tracks have one.
    pub(super) fn existence_of(&self, life: &TrackLifecycleState) -> Option<f64> {
        self.existence_rule().map(|_| life.existence)
    }

    /// By which tracks have a probability of existence.
    pub(super) fn existence_rule(&self) -> Option<&ExistenceRule> {
        match &self.confirmation {
            Confirmation::Existence(rule) => Some(rule),
            _ => None,
        }
    }
}

/// The largest variance of the position in any direction of the plane: the greater eigenvalue of its covariance. How high a
/// target is may be unknown for long where sensors of the plane follow it.
fn largest_variance<const K: usize>(covariance: &SMatrix<f64, K, K>) -> f64 {
    if K < 4 {
        return covariance[(0, 0)];
    }
    let (xx, xy, yy) = (covariance[(0, 0)], covariance[(0, 1)], covariance[(1, 1)]);
    (xx + yy) / 2.0 + ((xx - yy) / 2.0).hypot(xy)
}

impl TrackLifecycleState {
    /// A track that was there before the first scan.
    pub(super) fn permanent() -> TrackLifecycleState {
        TrackLifecycleState {
            hits: 0,
            missed: 0.0,
            unseen: 0,
            last_sensor: 0,
            last_time_s: 0.0,
            seen_by: [0; 2],
            detections: 0,
            is_missed: false,
            is_confirmed: true,
            is_over: false,
            is_permanent: true,
            score: Score::default(),
            existence: 1.0,
        }
    }

    /// Goes on for `dt_s`, in which the target may have ceased to be.
    pub(super) fn survive(&mut self, rule: &ExistenceRule, dt_s: f64) {
        if !self.is_permanent {
            self.existence *= survival(dt_s, rule.lifetime_s);
        }
    }

    /// r.
    pub(super) fn existence(&self) -> f64 {
        self.existence
    }

    /// Ends the track with this scan.
    pub(super) fn end(&mut self) {
        self.is_over = true;
    }

    /// Ends the track with this scan, for its target has another one; `false` of one that never ends.
    pub(super) fn merge(&mut self) -> bool {
        self.is_over = !self.is_permanent;
        if self.is_over {
            self.existence = 0.0;
        }
        self.is_over
    }

    pub(super) fn is_over(&self) -> bool {
        self.is_over
    }

    pub(super) fn is_confirmed(&self) -> bool {
        self.is_confirmed
    }

    pub(super) fn status(&self) -> TrackStatus {
        match (self.is_confirmed, self.is_missed) {
            (false, _) => TrackStatus::Tentative,
            (true, false) => TrackStatus::Confirmed,
            (true, true) => TrackStatus::Coasted,
        }
    }
}

#[cfg(test)]
mod tests;
