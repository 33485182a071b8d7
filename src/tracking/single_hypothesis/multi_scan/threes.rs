//! Which three detections may follow each other on a way: what has to be known before any belief is worth its price.
//!
//! # Symbols
//! z₁, z₂ places of two detections and T₁ the time between them; z₃, T₂ a third one before or after them and its time from the nearer
//! one, z₂; κ = T₂/T₁; rᵢ traces of their noises; σ_w² variance of how much the mean rates before and after z₂ differ
//! ([`Filter::most_rate_variance`]); γ threshold of the gate; W scans of the window.
//!
//! # Method
//! 1. z₃ is expected at z₂ + κ (z₂ − z₁), ± σ with σ² = (1 + κ)² r₂ + κ² r₁ + r₃ + T₂² σ_w².
//! 2. Three detections are kept when z₃ is within (1 + √(W − 2)) √γ σ of that.
//!
//! The filter of a way is the best linear estimator, so that its prediction differs from this one, which is unbiased and linear too, by
//! a sum over its at most W − 2 innovations whose variances add up to less than σ². Each innovation was inside its gate: together they
//! reach √(W − 2) √γ σ, and the gate around the prediction √γ σ. So no way is lost of linear motion and of positions. Of turns,
//! damping, ranges and bearings σ is one of a linear approximation.
//!
//! The nearer two are always the ones that are extrapolated: there are fewest of them.

use super::{Layer, MultiScan};
use crate::association::Needs;
use crate::filtering::Filter;
use crate::hypotheses::bounds;
use crate::math::gaussian::gate_threshold;
use crate::model::angle;
use crate::model::scan::Scan;
use crate::model::sensing::MeasurementModel;
use crate::model::watch::{Halt, Watch};
use crate::tracking::single_hypothesis::initiation::Point;
use crate::tracking::single_hypothesis::lifecycle::Lifecycle;
use nalgebra::SVector;
use std::collections::VecDeque;

/// Three detections of rising layers that may follow each other; the third is in the layer that holds this.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Three {
    /// How many layers before the last the others are.
    pub before: [u32; 2],
    pub detections: [u32; 3],
    /// Squared distance from where one is expected of the others, over the largest.
    pub strain: f64,
}

impl Three {
    fn new(before: [u32; 2], detections: [u32; 3], strain: f64) -> Self {
        Three {
            before,
            detections,
            strain,
        }
    }
}

/// What is looked at of a detection.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mark {
    /// The coordinates that there are.
    place: SVector<f64, 3>,
    /// Trace of its noise.
    noise: f64,
    at_s: f64,
    origin: Option<u32>,
}

impl Mark {
    pub fn of<const K: usize>(point: &Point<K>) -> Self {
        let mut mark = Mark {
            place: SVector::zeros(),
            noise: 0.0,
            at_s: point.at_s(),
            origin: point.origin,
        };
        for axis in 0..K / 2 {
            mark.place[axis] = point.state.mean[axis];
            mark.noise += point.state.covariance[(axis, axis)];
        }
        mark
    }

    pub fn place(&self) -> [f64; 3] {
        self.place.data.0[0]
    }
}

/// What the marks of a layer have in common.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Spread {
    /// The largest.
    noise: f64,
    /// The first and the last.
    times_s: [f64; 2],
}

impl Spread {
    pub fn of(marks: &[Mark], time_s: f64) -> Self {
        let mut spread = Spread {
            noise: 0.0,
            times_s: [time_s; 2],
        };
        for mark in marks {
            spread.noise = spread.noise.max(mark.noise);
            spread.times_s[0] = spread.times_s[0].min(mark.at_s);
            spread.times_s[1] = spread.times_s[1].max(mark.at_s);
        }
        spread
    }

    /// The longest time from a mark of this layer to one of a later.
    fn longest_s(&self, later: &Spread) -> f64 {
        later.times_s[1] - self.times_s[0]
    }
}

/// Two detections that may follow each other, of a layer and each of those that are so many before it.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Pairs(pub Vec<Vec<[u32; 2]>>);

impl Pairs {
    /// Those of a layer `gap` before; 1 is the last.
    fn of(&self, gap: usize) -> &[[u32; 2]] {
        self.0.get(gap - 1).map_or(&[], Vec::as_slice)
    }

    fn take(&mut self, gap: usize) -> Vec<[u32; 2]> {
        if self.0.len() < gap {
            self.0.resize_with(gap, Vec::new);
        }
        std::mem::take(&mut self.0[gap - 1])
    }

    fn put(&mut self, gap: usize, pairs: Vec<[u32; 2]>) {
        self.0[gap - 1] = pairs;
    }

    pub fn clear(&mut self) {
        self.0.iter_mut().for_each(Vec::clear);
    }
}

/// Finds them.
pub(super) struct Search<'a> {
    rule: &'a MultiScan,
    needs: Needs,
    /// The highest rate of a way from its root to its second detection.
    speed: f64,
    /// Standard deviation of a rate that nothing is known of.
    rate_sigma: f64,
    /// γ.
    gate_threshold: f64,
    /// What widens the bound of step 2.
    slack: f64,
    /// Where the first coordinate goes round.
    angle: Option<usize>,
}

/// Two detections, of which the nearer to a third one is the second, and what may be of the time of all three.
#[derive(Clone, Copy)]
struct Two<'a> {
    far: &'a Mark,
    near: &'a Mark,
    /// σ_w².
    rate_variance: f64,
}

impl<'a> Search<'a> {
    pub fn new<F: Filter<K>, const K: usize>(
        (rule, needs): (&'a MultiScan, Needs),
        (filter, lifecycle): (&F, &Lifecycle),
        (report, max_speed_mps): (&MeasurementModel, f64),
        slack: f64,
    ) -> Self {
        let values = report.dimensions().max(K / 2) as u32;
        let gate_threshold = gate_threshold(lifecycle.gate_probability, values);
        let rate_sigma = filter.rate_sigma(lifecycle.initial_speed_sigma_mps);
        Search {
            rule,
            needs,
            // A direction is gated by what its rate is thought to be.
            speed: if K > 2 {
                max_speed_mps
            } else {
                gate_threshold.sqrt() * rate_sigma
            },
            rate_sigma,
            gate_threshold,
            slack,
            angle: (K == 2).then_some(0),
        }
    }

    /// How many layers lie between two that are extrapolated, at most.
    fn widest_gap(&self) -> usize {
        let (window, gap) = (self.rule.window_scans, self.rule.max_gap_scans + 1);
        gap.min(window.saturating_sub(1) / 2) as usize
    }

    /// Finds the pairs and the threes that end in a new layer. Tells how many of these were cut.
    ///
    /// # Errors
    /// When too many detections are within reach of each other, or the watch says to stop.
    pub fn connect<F: Filter<K>, const K: usize>(
        &self,
        filter: &F,
        (layers, newest): (&VecDeque<Layer<K>>, &mut Layer<K>),
        (scan, watch): (&Scan, &Watch),
    ) -> Result<u64, Halt> {
        let kept = layers
            .len()
            .min(self.rule.window_scans.saturating_sub(1) as usize);
        let before = |gap: usize| &layers[layers.len() - gap];
        let shortest_s = shortest_s(layers, newest);
        for gap in 1..=kept.min(self.widest_gap()) {
            let rate_variance = self.rate_variance(filter, before(kept), newest);
            let reach = self.reach((before(gap), newest), rate_variance, shortest_s);
            self.pair((before(gap), reach), (newest, gap), (scan, watch))?;
        }
        let (mut cut, widest) = (0, self.rule.max_gap_scans as usize + 1);
        for first in 2..=kept {
            let rate_variance = self.rate_variance(filter, before(first), newest);
            for second in 1..first {
                if second > widest || first - second > widest {
                    continue;
                }
                let layers = [before(first), before(second)];
                let gaps = [first, second];
                self.close((layers, gaps), rate_variance, newest, watch)?;
                cut += self.limit(&mut newest.threes, 2);
                bounds::check_scan(newest.threes.len(), scan)?;
            }
        }
        Ok(cut + self.limit(&mut newest.threes, 1))
    }

    fn rate_variance<F: Filter<K>, const K: usize>(
        &self,
        filter: &F,
        first: &Layer<K>,
        last: &Layer<K>,
    ) -> f64 {
        filter.most_rate_variance(first.spread.longest_s(&last.spread).max(0.0), self.speed)
    }

    /// How far apart two detections of these layers may be. As the second and the third of a way they are as far apart as the first two,
    /// in proportion, and off by the bound; what is thought of a rate that nothing is known of bounds them, too.
    fn reach<const K: usize>(
        &self,
        (earlier, later): (&Layer<K>, &Layer<K>),
        rate_variance: f64,
        shortest_s: f64,
    ) -> f64 {
        let time_s = earlier.spread.longest_s(&later.spread).max(0.0);
        let noise = 4.0 * earlier.spread.noise.max(later.spread.noise);
        let kappa = (time_s / shortest_s).max(1.0);
        let wandered = time_s * time_s * rate_variance;
        let by_proportion = noise * (1.0 + kappa).powi(2) + wandered;
        let by_rate = noise + wandered + (time_s * self.rate_sigma).powi(2);
        let off = by_proportion.min(by_rate).sqrt();
        self.slack * (self.speed * time_s + (1.0 + self.factor()) * off)
    }

    /// The pairs of a layer and a new one, `gap` layers later.
    fn pair<const K: usize>(
        &self,
        (earlier, reach): (&Layer<K>, f64),
        (newest, gap): (&mut Layer<K>, usize),
        (scan, watch): (&Scan, &Watch),
    ) -> Result<(), Halt> {
        let mut pairs = newest.pairs.take(gap);
        for (index, mark) in newest.marks.iter().enumerate() {
            earlier
                .grid
                .near(&mark.place, [reach; 2], self.angle, |other| {
                    let apart = self.apart(mark, &earlier.marks[other as usize]);
                    if apart <= reach * reach && !earlier.is_used[other as usize] {
                        pairs.push([other, index as u32]);
                    }
                });
            bounds::check_scan(pairs.len(), scan)?;
            if watch.stops_after(64) {
                return Err(Halt::Stopped);
            }
        }
        newest.pairs.put(gap, pairs);
        Ok(())
    }

    /// The threes of two layers, so many layers before the new one, and that.
    fn close<const K: usize>(
        &self,
        ([first, second], gaps): ([&Layer<K>; 2], [usize; 2]),
        rate_variance: f64,
        newest: &mut Layer<K>,
        watch: &Watch,
    ) -> Result<(), Halt> {
        let mut threes = std::mem::take(&mut newest.threes);
        let before = gaps.map(|gap| gap as u32);
        let between = gaps[0] - gaps[1];
        if between <= gaps[1] {
            for &[one, two] in second.pairs.of(between) {
                if first.is_used[one as usize] || second.is_used[two as usize] {
                    continue;
                }
                let [far, near] = [&first.marks[one as usize], &second.marks[two as usize]];
                let two_of = Two {
                    far,
                    near,
                    rate_variance,
                };
                self.find(two_of, newest, |three, strain| {
                    threes.push(Three::new(before, [one, two, three], strain));
                });
                stop(watch)?;
            }
        } else {
            for &[two, three] in newest.pairs.of(gaps[1]) {
                if second.is_used[two as usize] {
                    continue;
                }
                let [near, far] = [&second.marks[two as usize], &newest.marks[three as usize]];
                let two_of = Two {
                    far,
                    near,
                    rate_variance,
                };
                self.find(two_of, first, |one, strain| {
                    threes.push(Three::new(before, [one, two, three], strain));
                });
                stop(watch)?;
            }
        }
        newest.threes = threes;
        Ok(())
    }

    /// Calls `found` with each detection of a layer that goes on from two, or leads to them, and its strain.
    #[inline]
    fn find<const K: usize>(&self, two: Two, layer: &Layer<K>, mut found: impl FnMut(u32, f64)) {
        let spread = &layer.spread;
        let middle_s = (spread.times_s[0] + spread.times_s[1]) / 2.0;
        let half_s = spread.times_s[1] - middle_s;
        let along = two.near.place - two.far.place;
        let along = self.wrapped(along);
        let span_s = two.near.at_s - two.far.at_s;
        let (mut centre, mut half) = (two.near.place, f64::INFINITY);
        let kappa = (middle_s - two.near.at_s) / span_s;
        let widest = kappa + half_s / span_s.abs();
        if kappa > 0.0 && widest.is_finite() && !self.needs.is_by_origin() {
            centre += along * kappa;
            if self.angle.is_some() {
                centre[0] = angle::wrap(centre[0]);
            }
            half = self
                .bound(&two, spread.noise, widest, widest * span_s)
                .sqrt()
                + along.norm() * (widest - kappa);
        }
        layer.grid.near(&centre, [half; 2], self.angle, |index| {
            let mark = &layer.marks[index as usize];
            let strain = self.strain(&two, mark, (along, span_s));
            if strain <= 1.0 && !layer.is_used[index as usize] {
                found(index, strain);
            }
        });
    }

    /// Of a third detection, which is kept when it is at most 1.
    #[inline]
    fn strain(&self, two: &Two, mark: &Mark, (along, span_s): (SVector<f64, 3>, f64)) -> f64 {
        let is_own = mark.origin.is_some()
            && (mark.origin == two.near.origin || mark.origin == two.far.origin);
        if self.needs.is_by_origin() && (is_own || self.needs == Needs::Origins) {
            return if is_own { 0.0 } else { f64::INFINITY };
        }
        let kappa = (mark.at_s - two.near.at_s) / span_s;
        // Times of their own may overlap: then they say nothing.
        if !(kappa > 0.0 && kappa.is_finite()) {
            return 1.0;
        }
        let off = self.wrapped(mark.place - two.near.place - along * kappa);
        let bound = self.bound(two, mark.noise, kappa, kappa * span_s);
        if bound.is_finite() {
            off.norm_squared() / bound
        } else {
            0.0
        }
    }

    /// The square of the largest distance of a third detection from where it is expected.
    #[inline]
    fn bound(&self, two: &Two, noise: f64, kappa: f64, time_s: f64) -> f64 {
        let variance = (1.0 + kappa).powi(2) * two.near.noise
            + kappa * kappa * two.far.noise
            + noise
            + time_s * time_s * two.rate_variance;
        (self.slack * self.factor()).powi(2) * variance
    }

    /// (1 + √(W − 2)) √γ.
    fn factor(&self) -> f64 {
        let innovations = f64::from(self.rule.window_scans.saturating_sub(2));
        (1.0 + innovations.sqrt()) * self.gate_threshold.sqrt()
    }

    fn apart(&self, one: &Mark, other: &Mark) -> f64 {
        self.wrapped(one.place - other.place).norm_squared()
    }

    #[inline]
    fn wrapped(&self, mut difference: SVector<f64, 3>) -> SVector<f64, 3> {
        if self.angle.is_some() {
            difference[0] = angle::wrap(difference[0]);
        }
        difference
    }

    /// Keeps so many times `max_nodes`, the least strained, where there are more. Tells how many were cut.
    fn limit(&self, threes: &mut Vec<Three>, times: usize) -> u64 {
        let most = self.rule.max_nodes as usize;
        if threes.len() <= times * most {
            return 0;
        }
        let cut = threes.len() - most;
        let order = |one: &Three, other: &Three| {
            let by_strain = one.strain.total_cmp(&other.strain);
            by_strain
                .then(one.before.cmp(&other.before))
                .then(one.detections.cmp(&other.detections))
        };
        threes.select_nth_unstable_by(most, order);
        threes.truncate(most);
        cut as u64
    }
}

/// Between layers that follow each other.
fn shortest_s<const K: usize>(layers: &VecDeque<Layer<K>>, newest: &Layer<K>) -> f64 {
    let mut shortest_s = f64::INFINITY;
    let later = layers.iter().skip(1).chain(std::iter::once(newest));
    for (one, other) in layers.iter().zip(later) {
        shortest_s = shortest_s.min(other.scan.time_s - one.scan.time_s);
    }
    shortest_s.max(0.0)
}

fn stop(watch: &Watch) -> Result<(), Halt> {
    if watch.stops_after(32) {
        return Err(Halt::Stopped);
    }
    Ok(())
}
