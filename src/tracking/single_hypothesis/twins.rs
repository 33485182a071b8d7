//! Two tracks on one target become one.
//!
//! # Symbols
//! x, P what is believed of each of two confirmed tracks after a scan, K its variables; γ the quantile of χ² with K degrees of freedom at
//! `probability`; n scans that count.
//!
//! # Method
//! Two tracks are near each other when d² = (x₁ − x₂)ᵀ (P₁ + P₂)⁻¹ (x₁ − x₂) ≤ γ and a detection lies in the gates of both.
//! 1. A scan of which both together use a single detection counts, n ← n + 1: two targets would rather have been detected twice.
//! 2. One of which they use two detections or more speaks for two targets: n ← 0. So does one after which they are not near.
//! 3. One of which they use none, or that has nothing in either gate, says nothing.
//! 4. When n is `scans`, the younger track ends after that scan.
//!
//! Errors of twins are correlated, for both take the same detections: d² is then smaller than that of a χ² variable, so twins are found
//! more surely than `probability` says.

use super::SingleHypothesis;
use super::USED_WEIGHT;
use crate::filtering::Filter;
use crate::math::gaussian::{Gaussian, gate_threshold};
use crate::model::angle::wrap;
use crate::model::watch::{Halt, Watch};
use crate::registry::{Object, above, default, whole};
use crate::tracking::recorder::Recorder;
use serde::{Deserialize, Serialize};

/// The parameters of [`MERGING`].
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Merging {
    pub probability: f64,
    pub scans: u32,
}

pub(super) static MERGING: Object = Object {
    name: "TrackMerging",
    summary: "Two confirmed tracks on one target become one: the younger ends.",
    fields: &[
        default(
            "probability",
            "Two tracks are near each other when the squared Mahalanobis distance of their estimates, with the sum of their covariances, is below the quantile of chi-square at this probability.",
            above(0.0, 0.9999, ""),
            "0.99",
        ),
        default(
            "scans",
            "After so many scans of which two tracks near each other used a single detection together the younger one ends; a scan of which they used two starts anew.",
            whole(1, 1000, "scans"),
            "5",
        ),
    ],
};

/// Two tracks that may be one, by serial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Pair {
    older: u32,
    younger: u32,
    /// n.
    scans: u32,
}

impl Pair {
    fn serials(&self) -> (u32, u32) {
        (self.older, self.younger)
    }
}

/// Two tracks near each other, the older first, and how many detections they use together.
struct Near {
    tracks: [usize; 2],
    used: usize,
}

impl<F: Filter<K>, const K: usize> SingleHypothesis<F, K> {
    /// What the scan says of twins, while the problem of the confirmed tracks is there.
    ///
    /// # Errors
    /// When the watch says to stop.
    pub(super) fn merge_twins(
        &mut self,
        time_s: f64,
        recorder: &mut dyn Recorder,
        watch: &Watch,
    ) -> Result<(), Halt> {
        let Some(rule) = self.lifecycle.merging else {
            return Ok(());
        };
        let before = std::mem::take(&mut self.memory.twins);
        let mut pairs = self.resting(&before);
        for Near { tracks, used } in self.near_pairs(&rule, watch)? {
            let [older, younger] = tracks.map(|track| self.memory.tracks[track].serial);
            let had = before.binary_search_by_key(&(older, younger), Pair::serials);
            let had = had.map_or(0, |at| before[at].scans);
            let scans = match used {
                0 => had,
                1 => had + 1,
                _ => 0,
            };
            let is_over = |track: &usize| self.memory.tracks[*track].life.is_over();
            if scans == 0 || tracks.iter().any(is_over) {
                continue;
            }
            if scans >= rule.scans && self.memory.tracks[tracks[1]].life.merge() {
                recorder.merged(younger, older, time_s);
            } else {
                pairs.push(Pair {
                    older,
                    younger,
                    scans,
                });
            }
        }
        pairs.sort_unstable_by_key(Pair::serials);
        self.memory.twins = pairs;
        Ok(())
    }

    /// The pairs that the scan says nothing of: both live, and nothing is in either gate.
    fn resting(&self, pairs: &[Pair]) -> Vec<Pair> {
        let problem = self.scratch.hypotheses.problem();
        let mut idle: Vec<u32> = Vec::new();
        for (row, found) in problem.rows().iter().enumerate() {
            if found.count == 0 {
                let track = self.scratch.hypotheses.track(row);
                idle.push(self.memory.tracks[track].serial);
            }
        }
        idle.sort_unstable();
        let is_idle = |serial: &u32| idle.binary_search(serial).is_ok();
        let pairs = pairs.iter().copied();
        pairs
            .filter(|pair| [pair.older, pair.younger].iter().all(is_idle))
            .collect()
    }

    /// The pairs of living confirmed tracks that are near each other and have a detection in the gates of both.
    fn near_pairs(&self, rule: &Merging, watch: &Watch) -> Result<Vec<Near>, Halt> {
        let problem = self.scratch.hypotheses.problem();
        let mut rows_at: Vec<(u32, u32)> = Vec::with_capacity(problem.edges().len());
        for (row, found) in problem.rows().iter().enumerate() {
            let life = &self.memory.tracks[self.scratch.hypotheses.track(row)].life;
            if life.is_confirmed() && !life.is_over() {
                let edges = problem.edges()[found.edges()].iter();
                rows_at.extend(edges.map(|edge| (edge.detection, row as u32)));
            }
        }
        rows_at.sort_unstable();
        let threshold = gate_threshold(rule.probability, K as u32);
        let mut seen = vec![u32::MAX; problem.rows().len()];
        let mut near = Vec::new();
        for (row, found) in problem.rows().iter().enumerate() {
            for edge in &problem.edges()[found.edges()] {
                let start = rows_at.partition_point(|at| *at <= (edge.detection, row as u32));
                let others = rows_at[start..].iter();
                for (_, other) in others.take_while(|(at, _)| *at == edge.detection) {
                    if watch.stops_after(1) {
                        return Err(Halt::Stopped);
                    }
                    if std::mem::replace(&mut seen[*other as usize], row as u32) != row as u32 {
                        near.extend(self.nearness([row, *other as usize], threshold));
                    }
                }
            }
        }
        Ok(near)
    }

    /// `None` of two rows whose tracks are not near each other.
    fn nearness(&self, rows: [usize; 2], threshold: f64) -> Option<Near> {
        let mut tracks = rows.map(|row| self.scratch.hypotheses.track(row));
        let lives = tracks.map(|track| self.memory.tracks[track].life);
        if lives
            .iter()
            .any(|life| life.is_over() || !life.is_confirmed())
        {
            return None;
        }
        let [one, other] = tracks.map(|track| F::kinematics(&self.memory.beliefs[track]));
        let mut difference = one.mean - other.mean;
        if K == 2 {
            difference[0] = wrap(difference[0]);
        }
        let sum = Gaussian::new(&(one.covariance + other.covariance))?;
        if sum.squared_distance(&difference) > threshold {
            return None;
        }
        tracks.sort_by_key(|track| self.memory.tracks[*track].serial);
        Some(Near {
            tracks,
            used: self.used_by(rows),
        })
    }

    /// How many detections the tracks of two rows use together.
    fn used_by(&self, rows: [usize; 2]) -> usize {
        let (problem, weights) = (self.scratch.hypotheses.problem(), &self.scratch.weights);
        let edges = rows.map(|row| problem.rows()[row].edges());
        let used = edges
            .into_iter()
            .flatten()
            .filter(|edge| weights.edges[*edge] >= USED_WEIGHT);
        let mut used: Vec<u32> = used.map(|edge| problem.edges()[edge].detection).collect();
        used.sort_unstable();
        used.dedup();
        used.len()
    }
}
