//! JPDA*: of all joint events that detect the same tracks with the same detections only the most probable one counts.
//! Averages over permutations of close targets draw their tracks together; this keeps misses and clutter averaged, and
//! decides who is who.
//!
//! # Reference
//! H. A. P. Blom, E. A. Bloem, Probabilistic data association avoiding track coalescence, IEEE Trans. Automatic Control
//! 45(2), 2000.
//!
//! # Symbols
//! A block of a cluster ([`super::blocks`]) shares single vertices v with others. r_b(v) sum over the kept events of block b,
//! and of all that hangs in it, that use v, over the sum over those that leave v.
//!
//! # Method
//! Two events with the same tracks and detections differ along cycles, and a cycle lies within a block. So an event counts
//! when its part in each block is the best with that part's tracks and detections, and blocks can be summed one by one.
//! 1. Upwards: each block is summed ([`super::kept_events`]), each vertex v that blocks hang in left at the weight
//!    f(v) = 1 + Σ r(v) over those.
//! 2. Downwards: the vertex that a block hangs in has the f of all its other blocks. Then each pair's share of the block's
//!    sum is its probability.
//!
//! A cluster without a cycle has nothing to decide between, and gets the marginals of JPDA.

#[cfg(test)]
mod tests;

use super::blocks::Blocks;
use super::cluster::Cluster;
use super::kept_events::{Bounds, KeptEvents, Split, Sums};
use super::number::{Number, Wide};
use crate::model::watch::Watch;

#[derive(Debug, Clone, Default)]
pub(super) struct BestPermutation {
    blocks: Blocks,
    ordinary: BlockTree<f64>,
    extreme: BlockTree<Wide>,
}

impl BestPermutation {
    /// Writes the marginals, and tells how many events were kept. `None`, and nothing written, when they would be more than
    /// `max_events` or a block is too wide.
    pub(super) fn marginals(
        &mut self,
        cluster: &mut Cluster,
        max_events: u64,
        watch: &Watch,
    ) -> Option<u64> {
        self.blocks.find(cluster);
        let bounds = Bounds {
            events: max_events,
            watch,
        };
        if cluster.is_narrow() {
            self.ordinary.run(&mut self.blocks, cluster, bounds)
        } else {
            self.extreme.run(&mut self.blocks, cluster, bounds)
        }
    }
}

/// Of one block.
#[derive(Debug, Clone, Copy)]
struct BlockSum<T> {
    total: Split<T>,
    /// Σ r of the vertex it hangs in over the blocks before it.
    before: T,
    /// 1 / f of that vertex, once it is known.
    share: T,
}

impl<T: Number> BlockSum<T> {
    /// r of the vertex it hangs in.
    fn ratio(&self) -> T {
        self.total.0[1] / self.total.0[0]
    }
}

/// Of one vertex.
#[derive(Debug, Clone, Copy)]
struct Joint<T> {
    /// Σ r over the blocks that hang in it: in the end over all, on the way over those met.
    below: T,
    /// The same over those met on the way down.
    after: T,
    /// The block it belongs to without being what that hangs in; [`NONE`] for the root.
    parent: u32,
    /// Weight of the parent's events that use it, once known.
    used: T,
}

const NONE: u32 = u32::MAX;

#[derive(Debug, Clone, Default)]
struct BlockTree<T> {
    events: KeptEvents<T>,
    sums: Sums<T>,
    blocks: Vec<BlockSum<T>>,
    joints: Vec<Joint<T>>,
    is_joint: Vec<bool>,
}

impl<T: Number> BlockTree<T> {
    fn run(&mut self, blocks: &mut Blocks, cluster: &mut Cluster, bounds: Bounds) -> Option<u64> {
        self.reset(cluster);
        let kept = self.sum_upwards(blocks, cluster, bounds)?;
        self.share_downwards(blocks, cluster);
        cluster.leave_missed();
        Some(kept)
    }

    fn reset(&mut self, cluster: &Cluster) {
        let Sums {
            weight,
            with,
            without,
        } = &mut self.sums;
        weight.clear();
        weight.extend(cluster.log_ratio.iter().map(|&logarithm| T::exp(logarithm)));
        with.clear();
        with.resize(weight.len(), Split::default());
        without.clear();
        without.resize(cluster.vertices(), Split::default());
        self.blocks.clear();
        self.joints.clear();
        let joint = Joint {
            below: T::default(),
            after: T::default(),
            parent: NONE,
            used: T::default(),
        };
        self.joints.resize(cluster.vertices(), joint);
        self.is_joint.clear();
        self.is_joint.resize(cluster.vertices(), false);
    }

    /// Step 1; tells how many events were kept.
    fn sum_upwards(
        &mut self,
        blocks: &mut Blocks,
        cluster: &Cluster,
        bounds: Bounds,
    ) -> Option<u64> {
        let mut left = bounds;
        for block in 0..blocks.len() {
            let top = blocks.top_of(block);
            for &edge in blocks.edges_of(block) {
                for vertex in cluster.ends_of(edge).into_iter().filter(|&end| end != top) {
                    let joint = &mut self.joints[vertex as usize];
                    joint.parent = block as u32;
                    let weight = &mut self.sums.weight[edge as usize];
                    *weight = *weight / (T::ONE + joint.below);
                }
            }
            let place = (&mut *blocks, block);
            let (total, kept) =
                self.events
                    .sum(cluster, place, &mut self.sums, &self.is_joint, left)?;
            left.events -= kept;
            let joint = &mut self.joints[top as usize];
            let sum = BlockSum {
                total,
                before: joint.below,
                share: T::ONE,
            };
            joint.below = joint.below + sum.ratio();
            self.is_joint[top as usize] = true;
            self.blocks.push(sum);
        }
        Some(bounds.events - left.events)
    }

    /// Step 2.
    fn share_downwards(&mut self, blocks: &Blocks, cluster: &mut Cluster) {
        for block in (0..blocks.len()).rev() {
            let top = blocks.top_of(block);
            let sum = self.blocks[block];
            let others = sum.before + self.joints[top as usize].after + self.ratio_above(top);
            let share = T::ONE / (T::ONE + others);
            self.blocks[block].share = share;
            let total = sum.total.weighed(share);
            for &edge in blocks.edges_of(block) {
                let with = self.sums.with[edge as usize].weighed(share);
                cluster.beta[edge as usize] = with.share_of(total);
                for vertex in cluster.ends_of(edge).into_iter().filter(|&end| end != top) {
                    let joint = &mut self.joints[vertex as usize];
                    joint.used = joint.used + with;
                }
            }
            let joint = &mut self.joints[top as usize];
            joint.after = joint.after + sum.ratio();
        }
    }

    /// r of a vertex in its parent block; 0 for the root, which has none.
    fn ratio_above(&self, vertex: u32) -> T {
        let joint = self.joints[vertex as usize];
        let Some(parent) = self.blocks.get(joint.parent as usize) else {
            return T::default();
        };
        let without = self.sums.without[vertex as usize].weighed(parent.share);
        (T::ONE + joint.below) * joint.used / without
    }
}
