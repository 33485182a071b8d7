//! The life of a track: started by detections that no track used ([`super::initiation`]), confirmed by hits or by score
//! ([`super::confirmation`]), deleted after `max_missed` scans in a row without a detection or after `max_missed_s` without
//! one, when its score says so, or when its position has become too uncertain (which also ends a track of a soft associator,
//! whose weights may never be a miss).
//! A track that was given at the start is confirmed from then on and never deleted: a lost one is to be judged, not forgotten.
//!
//! Confirmed tracks choose among all detections of a scan first, tentative ones among what is left, and what no track used
//! goes to the initiation. So a detection inside a confirmed track's gate starts a track only if it stayed unused by all. A
//! track that ends does so before the scan, and uses none of its detections.
//!
//! # What a miss counts
//! A scan of any sensor counts by its share: P_D of the track there over the highest P_D of all sensors, 1 at most. A miss of
//! a sensor that does not see the track changes nothing, one where it hardly sees it hardly anything; and it is one of the
//! scans among which detections are counted where its share is one half at least.
//!
//! P_D is rarely known for each track, so a sensor is taken to see a track only if it detected it lately: among the last
//! `max_missed` detections of the track by whichever sensors, or the `max_missed` before these. Misses of the others count
//! nothing. For one sensor alone this changes nothing.
//!
//! So that what has left every field of view ends too, a track ends after [`UNSEEN`] times `max_missed` scans of the sensor that
//! detected it last, whatever they count.
//!
//! Under an associator with soft weights: a tentative track is served by global nearest neighbour until it is confirmed; a
//! detection is used when one track at least gives it a weight of 0.01; a scan had a detection for a track when the weights
//! of all its detections together exceed that of none.

use super::confirmation::{CONFIRMATION, Confirmation, Score};
use super::initiation::{INITIATION, Initiation};
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
            "What turns scans into tracks: single_hypothesis decides after each scan which detections continue which track, for good.",
            Kind::Choice(&[super::NAME]),
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
        default(
            "confirm_hits",
            "M of the rule m_of_n: detections that confirm a track.",
            whole(1, 64, ""),
            "3",
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
            "initial_speed_sigma_mps",
            "Standard deviation of each velocity component of a track of one point, which starts at rest. When absent, it follows from the targets of a scenario or is estimated from the data, and the report tells it.",
            above(0.0, 1e5, "m/s"),
        ),
        optional(
            "smoothing",
            "Whether each estimate is made once more in the light of later scans: smoothed_tracks.csv beside tracks.csv, and the metrics of both.",
            Kind::Union(&SMOOTHING),
        ),
    ],
};

/// The parameters of [`LIFECYCLE`].
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Lifecycle {
    pub gate_probability: f64,
    pub initiation: Initiation,
    pub confirmation: Confirmation,
    pub confirm_hits: u32,
    pub confirm_window: u32,
    pub max_missed: u32,
    #[serde(default)]
    pub max_missed_s: Option<f64>,
    pub max_position_sigma_m: Option<f64>,
    #[serde(default = "assumed_speed_sigma_mps")]
    pub initial_speed_sigma_mps: f64,
    pub smoothing: Option<Smoothing>,
}

/// As a request that says nothing has it.
impl Default for Lifecycle {
    fn default() -> Self {
        let fields =
            check(&json!({}), &LIFECYCLE).expect("every field has a default or may be absent");
        Lifecycle::deserialize(fields).expect("the defaults are a life cycle")
    }
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
}

/// What a scan is to a track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Glance {
    pub time_s: f64,
    /// Index of the sensor.
    pub sensor: usize,
    pub was_detected: bool,
    /// P_D of the track over the highest of the sensors.
    pub share: f64,
    /// What the scan adds to the score; matters only when [`Lifecycle::is_scored`].
    pub log_ratio: f64,
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
            share: 1.0,
            log_ratio: 0.0,
        }
    }
}

impl Lifecycle {
    /// Where neither the request nor the scene nor the data tell how fast targets are.
    pub const ASSUMED_SPEED_SIGMA_MPS: f64 = 10.0;

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

    /// One more scan.
    #[inline]
    pub(super) fn advance(&self, life: &mut TrackLifecycleState, glance: &Glance) {
        let share = self.look(life, glance);
        if glance.was_detected || share >= LEAST_SHARE {
            life.hits = (life.hits << 1) | u64::from(glance.was_detected);
        }
        life.is_over |= match self.max_missed_s {
            Some(limit_s) => glance.time_s - life.last_time_s > limit_s,
            None => {
                life.missed >= f64::from(self.max_missed)
                    || life.unseen >= UNSEEN.saturating_mul(self.max_missed)
            }
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
        }
        life.is_over &= !life.is_permanent;
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
            life.detections += 1;
            (life.missed, life.unseen) = (0.0, 0);
            (life.last_sensor, life.last_time_s) = (glance.sensor as u32, glance.time_s);
            return 0.0;
        }
        let sees = (life.seen_by[0] | life.seen_by[1]) & bit != 0;
        let share = if sees { glance.share.min(1.0) } else { 0.0 };
        life.missed += share;
        life.unseen += u32::from(glance.sensor as u32 == life.last_sensor);
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

    /// Whether tracks are judged by their score.
    pub(super) fn is_scored(&self) -> bool {
        matches!(self.confirmation, Confirmation::Score(_))
    }
}

/// The largest variance of the position in any direction: the greater eigenvalue of its covariance.
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
        }
    }

    /// Ends the track with this scan.
    pub(super) fn end(&mut self) {
        self.is_over = true;
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
mod tests {
    use super::super::confirmation::ScoreRule;
    use super::*;

    const LIFE: Lifecycle = Lifecycle {
        gate_probability: 0.99,
        initiation: Initiation::OnePoint,
        confirmation: Confirmation::MOfN,
        confirm_hits: 3,
        confirm_window: 4,
        max_missed: 3,
        max_missed_s: None,
        max_position_sigma_m: None,
        initial_speed_sigma_mps: 1.0,
        smoothing: None,
    };

    fn statuses(lifecycle: &Lifecycle, detected: &str) -> String {
        let mut life = lifecycle.start(&Glance::first(0.0, 0));
        let mut seen = String::from(&life.status().name()[..1]);
        for (index, symbol) in detected.chars().enumerate().skip(1) {
            let glance = Glance {
                was_detected: symbol == '1',
                log_ratio: if symbol == '1' { 3.0 } else { -2.0 },
                ..Glance::first(index as f64, 0)
            };
            lifecycle.advance(&mut life, &glance);
            seen.push_str(if life.is_over() {
                "x"
            } else {
                &life.status().name()[..1]
            });
        }
        seen
    }

    #[test]
    fn confirmation_counts_the_last_n_scans_and_deletion_counts_misses_in_a_row() {
        let lifecycle = LIFE;
        assert_eq!(statuses(&lifecycle, "111"), "ttc");
        assert_eq!(statuses(&lifecycle, "11001011"), "tttttttc");
        assert_eq!(statuses(&lifecycle, "1111001000"), "ttcccccccx");
        assert_eq!(statuses(&lifecycle, "1000"), "tttx");
        let at_once = Lifecycle {
            confirm_hits: 1,
            confirm_window: 1,
            ..lifecycle
        };
        assert_eq!(statuses(&at_once, "1001"), "cccc");
        let long = Lifecycle {
            confirm_hits: 2,
            confirm_window: 64,
            max_missed: 100,
            ..lifecycle
        };
        assert_eq!(
            statuses(&long, &format!("1{}1", "0".repeat(62))).pop(),
            Some('c')
        );
        assert_eq!(
            statuses(&long, &format!("1{}1", "0".repeat(63))).pop(),
            Some('t')
        );
    }

    /// Statuses after scans of several sensors: a letter a sensor, capital where it detects the track.
    fn statuses_of(lifecycle: &Lifecycle, scans: &str) -> String {
        let glance = |(index, letter): (usize, char)| Glance {
            was_detected: letter.is_uppercase(),
            ..Glance::first(
                index as f64,
                letter.to_ascii_lowercase() as usize - 'a' as usize,
            )
        };
        let mut glances = scans.chars().enumerate().map(glance);
        let mut life = lifecycle.start(&glances.next().unwrap());
        let mut seen = String::from(&life.status().name()[..1]);
        for glance in glances {
            lifecycle.advance(&mut life, &glance);
            seen.push_str(match (life.is_over(), life.status()) {
                (true, _) => "x",
                (false, TrackStatus::Coasted) => "-",
                (false, status) => &status.name()[..1],
            });
        }
        seen
    }

    #[test]
    fn a_sensor_that_never_detects_a_track_deletes_none() {
        // A detects, B never does; one real miss of A between two of B would be three.
        assert_eq!(statuses_of(&LIFE, "AbAbAbabAb"), "ttttc---c-");
        assert_eq!(statuses_of(&LIFE, "AbAbAbababab"), "ttttc-----xx");
        // A fast one neither, nor does it keep the track from being confirmed.
        assert_eq!(
            statuses_of(&LIFE, "AbbbbAbbbbAbbbbabbbbA"),
            "ttttttttttc---------c"
        );
        // Where B detects it too, its misses count as those of A.
        assert_eq!(statuses_of(&LIFE, "ABAbab"), "ttc--x");
    }

    #[test]
    fn a_sensor_that_detects_a_track_no_more_is_forgotten() {
        // After three detections by B and three more, A has no say: b is a first real miss.
        assert_eq!(statuses_of(&LIFE, "AAABaBaBaBaBaBaba"), "ttcc-c-c-c-c-c---");
        // Before that it has: a, b and a are three.
        assert_eq!(statuses_of(&LIFE, "AAABaBaba"), "ttcc-c--x");
    }

    #[test]
    fn a_miss_counts_as_much_as_the_sensor_sees() {
        let mut life = LIFE.start(&Glance::first(0.0, 0));
        let miss = |share: f64, time_s: f64| Glance {
            was_detected: false,
            share,
            ..Glance::first(time_s, 0)
        };
        // Thirty at a tenth are three; what is not seen counts nothing.
        for index in 0..29 {
            LIFE.advance(&mut life, &miss(0.1, f64::from(index)));
            assert!(!life.is_over(), "{index}");
        }
        LIFE.advance(&mut life, &miss(0.0, 29.0));
        assert!(!life.is_over());
        LIFE.advance(&mut life, &miss(0.1, 29.0));
        LIFE.advance(&mut life, &miss(0.1, 30.0));
        assert!(life.is_over());
        // 20 times three scans of nothing end it as well.
        let mut life = LIFE.start(&Glance::first(0.0, 0));
        for index in 1..=60 {
            assert!(!life.is_over());
            LIFE.advance(&mut life, &miss(0.0, f64::from(index)));
        }
        assert!(life.is_over());
    }

    #[test]
    fn a_time_takes_the_place_of_scans() {
        let timed = Lifecycle {
            max_missed_s: Some(10.0),
            ..LIFE
        };
        // The last detection is at 2 s: at 12 s the track is there, at 13 s no more.
        assert_eq!(statuses(&timed, "11100000000000"), "ttcccccccccccx");
    }

    #[test]
    fn a_score_confirms_drops_and_deletes() {
        // Each detection adds 3, each miss −2. ln(0.9 / 0.005) = 5.19, ln(0.1 / 0.995) = −2.30; the first one adds nothing.
        let rule = ScoreRule {
            false_track_probability: 0.005,
            missed_track_probability: 0.1,
            max_score_drop: 5.0,
        };
        let scored = Lifecycle {
            confirmation: Confirmation::Score(rule),
            max_missed: 10,
            ..LIFE
        };
        assert_eq!(statuses(&scored, "111"), "ttc");
        assert_eq!(statuses(&scored, "100"), "ttx");
        assert_eq!(statuses(&scored, "10100"), "ttttx", "−2, 1, −1, −3");
        assert_eq!(
            statuses(&scored, "1110010000"),
            "ttcccccxxx",
            "6, then 2, 5, 3, 1 and, 5 below the highest, the end"
        );
        let impatient = Lifecycle {
            max_missed: 2,
            ..scored
        };
        assert_eq!(
            statuses(&impatient, "11100"),
            "ttccx",
            "misses in a row end a track before its score does"
        );
    }

    #[test]
    fn no_rule_ends_a_track_that_was_given() {
        let rule = ScoreRule {
            false_track_probability: 0.005,
            missed_track_probability: 0.1,
            max_score_drop: 5.0,
        };
        for lifecycle in [
            LIFE,
            Lifecycle {
                confirmation: Confirmation::Score(rule),
                ..LIFE
            },
        ] {
            let lifecycle = Lifecycle {
                max_position_sigma_m: Some(1.0),
                ..lifecycle
            };
            let mut life = TrackLifecycleState::permanent();
            assert_eq!(life.status(), TrackStatus::Confirmed);
            for time_s in 0..10 {
                let glance = Glance {
                    was_detected: false,
                    log_ratio: -2.0,
                    ..Glance::first(f64::from(time_s), 0)
                };
                lifecycle.advance(&mut life, &glance);
                lifecycle.limit(&mut life, || {
                    SMatrix::<f64, 4, 4>::from_diagonal_element(1e6)
                });
                assert_eq!(
                    (life.is_over(), life.status()),
                    (false, TrackStatus::Coasted)
                );
            }
        }
    }

    #[test]
    fn an_uncertain_position_ends_a_track() {
        // [5 2; 2 2] has the eigenvalues 6 and 1.
        let mut covariance = SMatrix::<f64, 4, 4>::from_diagonal_element(1e6);
        (
            covariance[(0, 0)],
            covariance[(0, 1)],
            covariance[(1, 0)],
            covariance[(1, 1)],
        ) = (5.0, 2.0, 2.0, 2.0);
        assert!((largest_variance(&covariance) - 6.0).abs() < 1e-12);
        assert!(
            (largest_variance(&SMatrix::<f64, 2, 2>::new(3.0, 1.0, 1.0, 9.0)) - 3.0).abs() < 1e-12
        );
        for (limit_m, is_over) in [(6.01f64.sqrt(), false), (5.99f64.sqrt(), true)] {
            let lifecycle = Lifecycle {
                max_position_sigma_m: Some(limit_m),
                ..LIFE
            };
            let mut life = lifecycle.start(&Glance::first(0.0, 0));
            lifecycle.limit(&mut life, || covariance);
            assert_eq!(life.is_over(), is_over);
        }
    }
}
