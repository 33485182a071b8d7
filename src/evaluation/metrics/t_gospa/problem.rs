//! What T-GOSPA has to decide: clusters of truths and tracks that come within the cutoff of each other.
//!
//! # Symbols
//! Gain of a pair at a step: 1 − (d / c)ᵖ, what assigning it saves against leaving both alone, as a share of cᵖ.
//!
//! # Method
//! A pair that is not within the cutoff at a step, or of which one is absent, costs the same assigned or not. So only gains
//! and switches matter; no optimal solution assigns a pair that never has a gain; clusters do not touch each other.

use crate::evaluation::comparison::{ComparedStep, Comparison};
use crate::evaluation::metrics::cutoff::Cutoff;
use crate::math::disjoint_sets;

/// A pair within the cutoff at one step, by places in its cluster.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Near {
    pub truth: usize,
    pub track: usize,
    pub gain: f64,
    /// Its index among the pairs of the comparison.
    pub pair: u32,
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cluster {
    pub truths: usize,
    pub tracks: usize,
    /// The steps at which any pair is near, in order; pairs rise by truth, then track.
    pub steps: Vec<Vec<Near>>,
}

/// A solution of one or more clusters, with what it is made of.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Solution {
    pub tally: Tally,
    /// Near pairs that are assigned, by their index among the pairs of the comparison, and to which share (0 to 1).
    pub shares: Vec<(u32, f64)>,
    /// Switches, each at the step of a pair of the comparison.
    pub switches: Vec<(u32, f64)>,
}

impl Solution {
    pub fn add(&mut self, other: Solution) {
        self.tally += other.tally;
        self.shares.extend(other.shares);
        self.switches.extend(other.switches);
    }
}

/// What a solution adds up to.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Tally {
    pub gain: f64,
    /// Pairs assigned at steps at which they are near; a fraction where the solution is.
    pub matched: f64,
    /// A change of track is 1, a loss or a find one half.
    pub switches: f64,
}

impl Tally {
    /// What it costs against leaving everyone alone; `penalty` is the share of a switch.
    pub fn cost(self, penalty: f64) -> f64 {
        self.switches * penalty - self.gain
    }
}

impl std::ops::AddAssign for Tally {
    fn add_assign(&mut self, other: Tally) {
        self.gain += other.gain;
        self.matched += other.matched;
        self.switches += other.switches;
    }
}

pub fn clusters(comparison: &Comparison, cutoff: Cutoff) -> Vec<Cluster> {
    let truths = comparison.truth_ids.len();
    let mut parents = Vec::new();
    disjoint_sets::reset(&mut parents, truths + comparison.track_ids.len());
    let steps: Vec<Vec<Near>> = comparison
        .steps
        .iter()
        .map(|step| near_pairs(comparison, step, cutoff))
        .collect();
    for pair in steps.iter().flatten() {
        let track = truths + pair.track;
        disjoint_sets::join(&mut parents, pair.truth as u32, track as u32);
    }
    gather(&steps, truths, &mut parents)
}

/// The pairs of a step that gain anything.
fn near_pairs(comparison: &Comparison, step: &ComparedStep, cutoff: Cutoff) -> Vec<Near> {
    let mut near = Vec::new();
    for index in step.pairs.clone() {
        let pair = &comparison.pairs[index];
        let gain = 1.0 - cutoff.share_of(pair.distance);
        if gain > 0.0 {
            near.push(Near {
                truth: comparison.truths[pair.truth as usize].id as usize,
                track: comparison.tracks[pair.track as usize].id as usize,
                gain,
                pair: index as u32,
            });
        }
    }
    near
}

/// Deals the pairs out to their clusters, in the order of the clusters' first truths.
fn gather(steps: &[Vec<Near>], truths: usize, parents: &mut [u32]) -> Vec<Cluster> {
    let mut clusters: Vec<Cluster> = Vec::new();
    let mut cluster_of = vec![None; parents.len()];
    let mut place_of = vec![0; parents.len()];
    for (member, place) in place_of.iter_mut().enumerate() {
        let root = disjoint_sets::root(parents, member as u32) as usize;
        // A cluster's smallest member is its root, and a truth; alone it has no pair.
        let cluster = *cluster_of[root].get_or_insert_with(|| {
            clusters.push(Cluster::default());
            clusters.len() - 1
        });
        let count = if member < truths {
            &mut clusters[cluster].truths
        } else {
            &mut clusters[cluster].tracks
        };
        *place = *count;
        *count += 1;
    }
    let mut last_step = vec![usize::MAX; clusters.len()];
    for (index, step) in steps.iter().enumerate() {
        for pair in step {
            let root = disjoint_sets::root(parents, pair.truth as u32) as usize;
            let cluster = cluster_of[root].expect("every member was given a cluster");
            if std::mem::replace(&mut last_step[cluster], index) != index {
                clusters[cluster].steps.push(Vec::new());
            }
            let near = Near {
                truth: place_of[pair.truth],
                track: place_of[truths + pair.track],
                ..*pair
            };
            clusters[cluster]
                .steps
                .last_mut()
                .expect("pushed above")
                .push(near);
        }
    }
    clusters.retain(|cluster| !cluster.steps.is_empty());
    clusters
}
