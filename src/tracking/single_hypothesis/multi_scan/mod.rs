//! Beginnings over several scans: of the detections that no track used those that follow each other best over a window of scans become
//! tracks, all chosen at once.
//!
//! # Reference
//! S. S. Blackman, R. Popoli, Design and Analysis of Modern Tracking Systems, 1999, sections 6.2 (score of a track) and 6.7; the joint
//! choice is that of track-oriented multiple hypothesis tracking, for beginnings alone.
//!
//! # Symbols
//! W scans of the window; b beginnings so far, c detections so far that were in none; ν, S innovation and its covariance; P_D, P_G
//! probability of detection and of the gate; λ clutter density; L score.
//!
//! # Method
//! For each sensor by itself:
//! 1. Each unused detection is a root, L = ln((1 + b)/(1 + c)): how much more often such a detection was a target than clutter.
//! 2. Each way so far goes on with each unused detection inside its gate, L ← L + ln(P_D N(ν; 0, S)/λ), and with none,
//!    L ← L + ln(1 − P_D P_G), at most `max_gap_scans` times in a row. The second detection is one that a target at `max_speed_mps`
//!    reaches. Ways that can no longer have `min_detections` end.
//! 3. When the window is full, the ways with `min_detections` and L > 0 that share no detection and have the largest sum of scores are
//!    chosen ([`crate::math::set_packing`]), exactly as long as that takes no more than [`MAX_STEPS`] steps a cluster. Those whose root
//!    is in the oldest scan begin; the others wait, for more may come. Roots in the oldest scan that do not begin are clutter.
//! 4. A beginning has lived through its scans: its hits and misses count for confirmation and deletion. Its past points are estimates in
//!    the light of all its detections; scans that missed it are coasted.
//!
//! A scan is kept as it was, and nothing of step 2 is done before the choice. Then it is done with the detections alone that a root of the
//! oldest scan competes for: of each three that may follow each other ([`threes`]) the detections are linked, and what is not linked to
//! such a root decides nothing.
//!
//! More than `max_nodes` threes of a scan, or ways of a choice, are cut: of threes the straightest, of each root the best ways go first.
//! That is told.

mod choice;
mod choose;
mod links;
mod lone;
mod node;
mod threes;
mod ways;
mod written;

use super::SingleHypothesis;
use super::initiation::{Point, SPEED_REACH};
use crate::filtering::Filter;
use crate::gating::grid::Grid;
use crate::model::scan::Scan;
use crate::model::sensing::MeasurementModel;
use crate::model::watch::{Halt, Watch};
use crate::tracking::recorder::Recorder;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use threes::{Mark, Pairs, Search, Spread, Three};

pub(super) use choice::Choice;
pub(super) use ways::Ways;
pub(super) use written::WrittenBeginnings;

/// Sets that are tried in a cluster of beginnings.
const MAX_STEPS: usize = 200_000;

/// The parameters of the initiation.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct MultiScan {
    pub max_speed_mps: Option<f64>,
    pub window_scans: u32,
    pub min_detections: u32,
    pub max_gap_scans: u32,
    pub max_nodes: u32,
}

/// One scan of the window.
#[derive(Debug, Clone)]
struct Layer<const K: usize> {
    /// Of the scans of its sensor.
    number: u32,
    scan_index: u32,
    /// L of a root in it.
    log_odds: f64,
    /// With the detections alone that no track used and that tell where their target is.
    scan: Scan,
    /// Parallel to them, as all that follows. ln of the density of clutter over the sensor's; empty where it is that everywhere.
    log_clutter_ratios: Vec<f64>,
    points: Vec<Point<K>>,
    marks: Vec<Mark>,
    /// By a beginning.
    is_used: Vec<bool>,
    spread: Spread,
    grid: Grid,
    pairs: Pairs,
    /// Those that end here.
    threes: Vec<Three>,
}

/// What waits to begin, of one sensor.
#[derive(Debug, Clone)]
struct OfSensor<const K: usize> {
    /// The oldest first.
    layers: VecDeque<Layer<K>>,
    /// Their memory is reused.
    spare: Vec<Layer<K>>,
    scans: u32,
    counts: Counts,
}

/// What became of detections that no track used.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Counts {
    /// b.
    begun: u64,
    /// c.
    left: u64,
    /// Ways that were cut for want of room.
    cut: u64,
    /// Clusters of which the best choice was not found in time.
    inexact: u64,
}

impl Counts {
    /// L of a root.
    fn log_odds(&self) -> f64 {
        ((1 + self.begun) as f64 / (1 + self.left) as f64).ln()
    }
}

impl<const K: usize> Default for OfSensor<K> {
    fn default() -> Self {
        OfSensor {
            layers: VecDeque::new(),
            spare: Vec::new(),
            scans: 0,
            counts: Counts::default(),
        }
    }
}

/// What waits to begin, of each sensor.
#[derive(Debug, Clone)]
pub(super) struct Beginnings<const K: usize>(Vec<OfSensor<K>>);

impl<const K: usize> Default for Beginnings<K> {
    fn default() -> Self {
        Beginnings(Vec::new())
    }
}

impl<const K: usize> Beginnings<K> {
    fn of(&mut self, sensor: usize) -> &mut OfSensor<K> {
        if self.0.len() <= sensor {
            self.0.resize_with(sensor + 1, OfSensor::default);
        }
        &mut self.0[sensor]
    }

    /// What a user is told of choices that may not be the best.
    pub fn warnings(&self) -> Vec<String> {
        let sum =
            |of: fn(&Counts) -> u64| self.0.iter().map(|sensor| of(&sensor.counts)).sum::<u64>();
        let (cut, inexact) = (sum(|counts| counts.cut), sum(|counts| counts.inexact));
        let mut warnings = Vec::new();
        if cut > 0 {
            warnings.push(format!(
                "beginnings: {cut} of the ways from detection to detection were cut, the crookedest and the least likely of each first; a \
                 larger max_nodes, or a lower max_speed_mps, keeps more"
            ));
        }
        if inexact > 0 {
            warnings.push(format!(
                "beginnings: {inexact} times so many detections competed that the best choice found may not be the best there is"
            ));
        }
        warnings
    }
}

impl<const K: usize> Layer<K> {
    fn new(scan: Scan) -> Self {
        Layer {
            number: 0,
            scan_index: 0,
            log_odds: 0.0,
            scan,
            log_clutter_ratios: Vec::new(),
            points: Vec::new(),
            marks: Vec::new(),
            is_used: Vec::new(),
            spread: Spread::default(),
            grid: Grid::default(),
            pairs: Pairs::default(),
            threes: Vec::new(),
        }
    }

    /// The same memory for the detections of another scan.
    fn clear(&mut self, scan: &Scan) {
        let Scan {
            mut detections,
            mut own,
            ..
        } = std::mem::replace(&mut self.scan, without_detections(scan));
        detections.clear();
        own.clear();
        (self.scan.detections, self.scan.own) = (detections, own);
        self.log_clutter_ratios.clear();
        self.points.clear();
        self.pairs.clear();
        self.threes.clear();
    }

    /// Sorts the points.
    fn arrange(&mut self) {
        self.marks.clear();
        self.marks.extend(self.points.iter().map(Mark::of));
        self.is_used.clear();
        self.is_used.resize(self.points.len(), false);
        self.spread = Spread::of(&self.marks, self.scan.time_s);
        let places: Vec<[f64; 3]> = self.marks.iter().map(Mark::place).collect();
        self.grid.rebuild(&places);
    }
}

fn without_detections(scan: &Scan) -> Scan {
    Scan {
        number: scan.number,
        time_s: scan.time_s,
        sensor: scan.sensor,
        pose: scan.pose,
        detections: Vec::new(),
        own: Vec::new(),
    }
}

impl<F: Filter<K>, const K: usize> SingleHypothesis<F, K> {
    /// Takes the unused detections of a scan, and begins what is decided with it.
    pub(super) fn begin_over_scans(
        &mut self,
        rule: &MultiScan,
        (scan, report): (&Scan, &MeasurementModel),
        recorder: &mut dyn Recorder,
        watch: &Watch,
    ) -> Result<(), Halt> {
        let mut waiting = std::mem::take(self.memory.beginnings.of(scan.sensor));
        let mut layer = self.layer_of((scan, report), &mut waiting);
        if rule.min_detections > 2 {
            let search = Search::new::<F, K>(
                (rule, self.associator.needs()),
                (&self.filter, &self.lifecycle),
                (report, self.max_speed_mps(rule)),
                self.scratch.ways.slack,
            );
            let found =
                search.connect(&self.filter, (&waiting.layers, &mut layer), (scan, watch))?;
            waiting.counts.cut += found;
        }
        waiting.layers.push_back(layer);
        if waiting.layers.len() >= rule.window_scans as usize {
            self.decide(rule, &mut waiting, (scan.time_s, false), recorder, watch)?;
        }
        *self.memory.beginnings.of(scan.sensor) = waiting;
        Ok(())
    }

    /// Decides the rest, for no scan follows.
    pub(super) fn decide_rest(&mut self, rule: &MultiScan, recorder: &mut dyn Recorder) {
        let known_s = self.memory.last_time_s.unwrap_or(0.0);
        for sensor in 0..self.sensors.len() {
            let mut waiting = std::mem::take(self.memory.beginnings.of(sensor));
            if !waiting.layers.is_empty() {
                let end = (known_s, true);
                let decided = self.decide(rule, &mut waiting, end, recorder, &Watch::never());
                // Too many ways to tell which is best.
                waiting.counts.inexact += u64::from(decided.is_err());
            }
            *self.memory.beginnings.of(sensor) = waiting;
        }
    }

    /// The highest speed of a target between its first two detections.
    fn max_speed_mps(&self, rule: &MultiScan) -> f64 {
        let told_mps = SPEED_REACH * self.lifecycle.initial_speed_sigma_mps;
        rule.max_speed_mps.unwrap_or(told_mps)
    }

    /// What no track used of a scan.
    fn layer_of(
        &self,
        (scan, report): (&Scan, &MeasurementModel),
        waiting: &mut OfSensor<K>,
    ) -> Layer<K> {
        let spare = waiting.spare.pop();
        let mut layer = spare.unwrap_or_else(|| Layer::new(without_detections(scan)));
        layer.clear(scan);
        layer.number = waiting.scans;
        layer.scan_index = self.memory.scans;
        layer.log_odds = waiting.counts.log_odds();
        waiting.scans += 1;
        let hypotheses = &self.scratch.hypotheses;
        for (index, detection) in scan.detections.iter().enumerate() {
            let Some(point) = self.point_of(scan, report, index) else {
                continue;
            };
            layer.points.push(point);
            layer.scan.detections.push(*detection);
            if !scan.own.is_empty() {
                layer.scan.own.push(scan.own[index]);
            }
            if hypotheses.has_log_clutter_ratios() {
                let ratio = hypotheses.log_clutter_ratio(index);
                layer.log_clutter_ratios.push(ratio);
            }
        }
        layer.arrange();
        layer
    }
}

#[cfg(test)]
mod tests;
