//! Exact marginals without listing events: the sum over all joint events is taken element by element (dynamic
//! programming by variable elimination). What earlier elements did matters to later ones only by which nodes of the
//! frontier are used, so events that agree in that are summed into one cell of a table. The elements are tracks and the
//! nodes detections, or the other way round, whichever is cheaper.
//!
//! # Reference
//! U. Bertelè, F. Brioschi, Nonserial Dynamic Programming, 1972 (elimination and its order); the two passes are those of
//! L. R. Rabiner, A tutorial on hidden Markov models, Proc. IEEE 77(2), 1989, section III.
//!
//! # Symbols
//! Fₜ\[S\] sum over all choices of the first t elements after which exactly the nodes S of the frontier are used;
//! Bₜ\[S\] sum over all choices of the others, given S; wⱼ weight of choosing node j, with 1 for none.
//!
//! # Method
//! 1. F₀\[∅\] = 1. For element t: G\[S\] = Fₜ₋₁\[S\] + Σ_{j ∈ S} wⱼ Fₜ₋₁\[S∖j\].
//! 2. Fₜ from G: cells that differ only in nodes that nobody wants any more are added.
//! 3. Backwards, B ends as 1; Bₜ₋₁\[S\] = Bₜ\[S\] + Σ_{j ∉ S} wⱼ Bₜ\[S∪j\], S without the nodes nobody wants any more.
//! 4. The events in which element t takes j weigh Σ_{S ∌ j} Fₜ₋₁\[S\] wⱼ Bₜ\[S∪j\], together with every other: divide.
//!
//! A node that one element alone wants never enters the table: its weight joins that of none, and is split afterwards.

use super::cluster::{Cluster, Turn};
use super::number::{MAX_SCALED_LOG, Number, Scaled, Wide};
use super::plan::{self, Choice, EliminationPlan, EliminationStep, Limits, PRIVATE};

#[derive(Debug, Clone, Default)]
pub(super) struct Exact {
    by_track: EliminationPlan,
    by_detection: EliminationPlan,
    ordinary: Tables<f64>,
    scaled: Tables<Scaled>,
    extreme: Tables<Wide>,
}

/// A plan that keeps the limits.
#[derive(Debug, Clone, Copy)]
pub(super) struct Planned {
    turn: Turn,
    /// Nodes in the widest frontier.
    pub(super) frontier: u32,
}

/// With a plan this cheap the other side is not looked at.
const CHEAP_COST: u64 = 2000;

impl Exact {
    /// The cheaper of the orders over detections and over tracks; `None` when both break a limit. Detections come first:
    /// in the clusters of trackers their order is mostly the cheaper one, since gates differ in size and points do not.
    pub(super) fn plan(&mut self, cluster: &Cluster, limits: Limits) -> Option<Planned> {
        let first = self.make(cluster, Turn::Detections, limits);
        if first.is_some_and(|cost| cost <= CHEAP_COST) {
            return Some(self.planned(Turn::Detections));
        }
        let cheaper = Limits {
            cost: first.unwrap_or(limits.cost),
            ..limits
        };
        if plan::least_cost(cluster.sides(Turn::Tracks)) <= cheaper.cost
            && self.make(cluster, Turn::Tracks, cheaper).is_some()
        {
            return Some(self.planned(Turn::Tracks));
        }
        first.map(|_| self.planned(Turn::Detections))
    }

    fn make(&mut self, cluster: &Cluster, turn: Turn, limits: Limits) -> Option<u64> {
        let plan = self.plan_of(turn);
        plan.make(cluster.sides(turn), limits).then_some(plan.cost)
    }

    fn plan_of(&mut self, turn: Turn) -> &mut EliminationPlan {
        match turn {
            Turn::Tracks => &mut self.by_track,
            Turn::Detections => &mut self.by_detection,
        }
    }

    fn planned(&mut self, turn: Turn) -> Planned {
        Planned {
            turn,
            frontier: self.plan_of(turn).frontier,
        }
    }

    /// Writes the marginals by the plan last made.
    pub(super) fn marginals(&mut self, cluster: &mut Cluster, planned: Planned) {
        let plan = if planned.turn == Turn::Tracks {
            &self.by_track
        } else {
            &self.by_detection
        };
        let is_done = if cluster.is_narrow() {
            self.ordinary.run(plan, planned.turn, cluster)
        } else {
            let is_mild = |logarithm: &f64| logarithm.abs() <= MAX_SCALED_LOG;
            cluster.log_ratio.iter().all(is_mild) && self.scaled.run(plan, planned.turn, cluster)
        };
        if !is_done {
            self.extreme.run(plan, planned.turn, cluster);
        }
    }
}

#[derive(Debug, Clone, Default)]
struct Tables<T> {
    weight: Vec<T>,
    /// 1 + the weights of the private nodes of each step.
    alone: Vec<T>,
    /// F before every step, one after the other.
    forward: Vec<T>,
    starts: Vec<usize>,
    /// Each of them is F times two to minus the power of this.
    exponents: Vec<i64>,
    table: Vec<T>,
    scratch: Vec<T>,
}

impl<T: Number> Tables<T> {
    /// Whether all numbers stayed in range; the marginals mean something only then.
    fn run(&mut self, plan: &EliminationPlan, turn: Turn, cluster: &mut Cluster) -> bool {
        self.weight.clear();
        self.weight
            .extend(cluster.log_ratio.iter().map(|&logarithm| T::exp(logarithm)));
        let Some(exponent) = self.sweep_forward(plan) else {
            return false;
        };
        let total = (self.table[0], exponent);
        if self.sweep_backward(plan, turn, total, cluster).is_none() {
            return false;
        }
        if turn == Turn::Detections {
            cluster.leave_missed();
        }
        true
    }

    /// Steps 1 and 2; tells the exponent of the last table.
    fn sweep_forward(&mut self, plan: &EliminationPlan) -> Option<i64> {
        self.forward.clear();
        self.starts.clear();
        self.exponents.clear();
        let mut exponent = 0;
        self.alone.clear();
        self.table.clear();
        self.table.push(T::ONE);
        let (mut choices_start, mut leaving_start) = (0, 0);
        for step in &plan.steps {
            self.starts.push(self.forward.len());
            self.exponents.push(exponent);
            self.forward.extend_from_slice(&self.table);
            self.expand(
                step,
                &plan.choices[choices_start..step.choices_end as usize],
            );
            for &bit in &plan.leaving[leaving_start..step.leaving_end as usize] {
                add_halves(&self.table, &mut self.scratch, bit);
                std::mem::swap(&mut self.table, &mut self.scratch);
            }
            (choices_start, leaving_start) = (step.choices_end as usize, step.leaving_end as usize);
            exponent += T::settle(&mut self.table)?;
        }
        Some(exponent)
    }

    /// Step 1: `table` from F to G.
    fn expand(&mut self, step: &EliminationStep, choices: &[Choice]) {
        let size = 1 << step.width;
        let private = choices.iter().filter(|choice| choice.bit == PRIVATE);
        let alone = private.fold(T::ONE, |sum, choice| {
            sum + self.weight[choice.edge as usize]
        });
        self.alone.push(alone);
        self.scratch.clear();
        self.scratch
            .extend(self.table.iter().map(|&cell| alone * cell));
        self.scratch.resize(size << step.fresh, T::default());
        for choice in choices.iter().filter(|choice| choice.bit != PRIVATE) {
            let weight = self.weight[choice.edge as usize];
            if u32::from(choice.bit) >= step.width {
                let start = 1 << choice.bit;
                for (to, &from) in self.scratch[start..start + size]
                    .iter_mut()
                    .zip(&self.table)
                {
                    *to = weight * from;
                }
            } else {
                add_used(&self.table, &mut self.scratch[..size], choice.bit, weight);
            }
        }
        std::mem::swap(&mut self.table, &mut self.scratch);
    }

    /// Steps 3 and 4.
    fn sweep_backward(
        &mut self,
        plan: &EliminationPlan,
        turn: Turn,
        (total, total_exponent): (T, i64),
        cluster: &mut Cluster,
    ) -> Option<()> {
        let mut exponent = 0;
        self.table.clear();
        self.table.push(T::ONE);
        for (index, step) in plan.steps.iter().enumerate().rev() {
            let before = index.checked_sub(1).map(|before| &plan.steps[before]);
            let choices_start = before.map_or(0, |before| before.choices_end as usize);
            let leaving_start = before.map_or(0, |before| before.leaving_end as usize);
            for &bit in plan.leaving[leaving_start..step.leaving_end as usize]
                .iter()
                .rev()
            {
                repeat_halves(&self.table, &mut self.scratch, bit);
                std::mem::swap(&mut self.table, &mut self.scratch);
            }
            let choices = &plan.choices[choices_start..step.choices_end as usize];
            let total = (total, self.exponents[index] + exponent - total_exponent);
            let kept = self.contract(index, step, choices, total, &mut cluster.beta);
            if turn == Turn::Tracks {
                cluster.missed[step.element as usize] = kept;
            }
            exponent += T::settle(&mut self.table)?;
        }
        Some(())
    }

    /// `table` from Bₜ to Bₜ₋₁, and the marginals of one element; returns that of "none".
    fn contract(
        &mut self,
        index: usize,
        step: &EliminationStep,
        choices: &[Choice],
        (total, shift): (T, i64),
        beta: &mut [f64],
    ) -> f64 {
        let size = 1 << step.width;
        let forward = &self.forward[self.starts[index]..self.starts[index] + size];
        let alone = self.alone[index];
        self.scratch.clear();
        self.scratch.resize(size, T::default());
        let kept = add_gain(forward, &self.table[..size], &mut self.scratch, T::ONE);
        for cell in &mut self.scratch {
            *cell = alone * *cell;
        }
        for choice in choices {
            let weight = self.weight[choice.edge as usize];
            let mass = if choice.bit == PRIVATE {
                weight * kept
            } else if u32::from(choice.bit) >= step.width {
                let start = 1 << choice.bit;
                add_gain(
                    forward,
                    &self.table[start..start + size],
                    &mut self.scratch,
                    weight,
                )
            } else {
                add_unused(
                    forward,
                    &self.table[..size],
                    &mut self.scratch,
                    choice.bit,
                    weight,
                )
            };
            beta[choice.edge as usize] = mass.share_at(shift, total);
        }
        std::mem::swap(&mut self.table, &mut self.scratch);
        kept.share_at(shift, total)
    }
}

/// Below this the cells of one block are too few for a loop of their own.
const SMALL_BLOCK: usize = 8;

/// Cell number `index` of those without the bit worth `half`.
#[inline]
fn cell_without(half: usize, index: usize) -> usize {
    let low = index & (half - 1);
    ((index - low) << 1) | low
}

/// to\[S∪j\] += w · from\[S\] for every S without j.
fn add_used<T: Number>(from: &[T], to: &mut [T], bit: u8, weight: T) {
    match bit {
        0 => add_used_small::<T, 1>(from, to, weight),
        1 => add_used_small::<T, 2>(from, to, weight),
        2 => add_used_small::<T, 4>(from, to, weight),
        _ => {
            let half = 1 << bit;
            for (from, to) in from
                .chunks_exact(2 * half)
                .zip(to.chunks_exact_mut(2 * half))
            {
                for (to, &from) in to[half..].iter_mut().zip(&from[..half]) {
                    *to = *to + weight * from;
                }
            }
        }
    }
}

/// The same for the lowest bits: in stretches of eight cells, whose places are known to the compiler.
fn add_used_small<T: Number, const HALF: usize>(from: &[T], to: &mut [T], weight: T) {
    let (whole, rest) = (
        from.chunks_exact(SMALL_BLOCK),
        from.len() / SMALL_BLOCK * SMALL_BLOCK,
    );
    for (from, to) in whole.zip(to.chunks_exact_mut(SMALL_BLOCK)) {
        for cell in (0..SMALL_BLOCK / 2).map(|index| cell_without(HALF, index)) {
            to[cell + HALF] = to[cell + HALF] + weight * from[cell];
        }
    }
    for cell in (0..(from.len() - rest) / 2).map(|index| rest + cell_without(HALF, index)) {
        to[cell + HALF] = to[cell + HALF] + weight * from[cell];
    }
}

/// before\[S\] += w · after\[S∪j\] for every S without j; returns Σ F\[S\] w · after\[S∪j\].
fn add_unused<T: Number>(forward: &[T], after: &[T], before: &mut [T], bit: u8, weight: T) -> T {
    match bit {
        0 => add_unused_small::<T, 1>(forward, after, before, weight),
        1 => add_unused_small::<T, 2>(forward, after, before, weight),
        2 => add_unused_small::<T, 4>(forward, after, before, weight),
        _ => {
            let half = 1 << bit;
            let blocks = forward
                .chunks_exact(2 * half)
                .zip(after.chunks_exact(2 * half))
                .zip(before.chunks_exact_mut(2 * half));
            blocks.fold(T::default(), |mass, ((forward, after), before)| {
                mass + add_gain(
                    &forward[..half],
                    &after[half..],
                    &mut before[..half],
                    weight,
                )
            })
        }
    }
}

/// The same for the lowest bits.
fn add_unused_small<T: Number, const HALF: usize>(
    forward: &[T],
    after: &[T],
    before: &mut [T],
    weight: T,
) -> T {
    let mut sums = [T::default(); SMALL_BLOCK / 2];
    let rest = before.len() / SMALL_BLOCK * SMALL_BLOCK;
    let whole = forward
        .chunks_exact(SMALL_BLOCK)
        .zip(after.chunks_exact(SMALL_BLOCK))
        .zip(before.chunks_exact_mut(SMALL_BLOCK));
    for ((forward, after), before) in whole {
        for (lane, sum) in sums.iter_mut().enumerate() {
            let cell = cell_without(HALF, lane);
            let gain = weight * after[cell + HALF];
            before[cell] = before[cell] + gain;
            *sum = *sum + forward[cell] * gain;
        }
    }
    let mut mass = (sums[0] + sums[1]) + (sums[2] + sums[3]);
    for cell in (0..(before.len() - rest) / 2).map(|index| rest + cell_without(HALF, index)) {
        let gain = weight * after[cell + HALF];
        before[cell] = before[cell] + gain;
        mass = mass + forward[cell] * gain;
    }
    mass
}

/// before\[S\] += w · after\[S\]; returns Σ F\[S\] w · after\[S\], in four sums that need not wait for each other.
fn add_gain<T: Number>(forward: &[T], after: &[T], before: &mut [T], weight: T) -> T {
    let mut sums = [T::default(); 4];
    let quads = before.len() / 4 * 4;
    let whole = forward[..quads]
        .chunks_exact(4)
        .zip(after[..quads].chunks_exact(4))
        .zip(before[..quads].chunks_exact_mut(4));
    for ((forward, after), before) in whole {
        for lane in 0..4 {
            let gain = weight * after[lane];
            before[lane] = before[lane] + gain;
            sums[lane] = sums[lane] + forward[lane] * gain;
        }
    }
    let mut mass = (sums[0] + sums[1]) + (sums[2] + sums[3]);
    for cell in quads..before.len() {
        let gain = weight * after[cell];
        before[cell] = before[cell] + gain;
        mass = mass + forward[cell] * gain;
    }
    mass
}

/// Step 2 for one node: cells with and without its bit are added, and the bits above move down.
fn add_halves<T: Number>(from: &[T], to: &mut Vec<T>, bit: u8) {
    let half = 1 << bit;
    to.clear();
    if half < SMALL_BLOCK {
        to.extend(
            (0..from.len() / 2)
                .map(|index| cell_without(half, index))
                .map(|cell| from[cell] + from[cell + half]),
        );
        return;
    }
    for block in from.chunks_exact(2 * half) {
        let (without, with) = block.split_at(half);
        to.extend(
            without
                .iter()
                .zip(with)
                .map(|(&without, &with)| without + with),
        );
    }
}

/// The reverse for B, which does not depend on the node.
fn repeat_halves<T: Number>(from: &[T], to: &mut Vec<T>, bit: u8) {
    let half = 1 << bit;
    to.clear();
    if half < SMALL_BLOCK {
        to.extend(
            (0..2 * from.len())
                .map(|index| from[((index >> (bit + 1)) << bit) | (index & (half - 1))]),
        );
        return;
    }
    for block in from.chunks_exact(half) {
        to.extend_from_slice(block);
        to.extend_from_slice(block);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Tracks, problem_of};
    use super::*;

    /// Bits of β and β₀ with one kind of number; `None` where that does not take the cluster.
    fn shares<T: Number>(cluster: &mut Cluster, turn: Turn) -> Option<Vec<u64>> {
        let mut plan = EliminationPlan::default();
        let limits = Limits {
            width: 16,
            cost: 1 << 20,
        };
        assert!(plan.make(cluster.sides(turn), limits));
        let is_done = Tables::<T>::default().run(&plan, turn, cluster);
        let shares = cluster.beta.iter().chain(&cluster.missed);
        is_done.then(|| shares.map(|share| share.to_bits()).collect())
    }

    /// Eighty tracks, each wants four detections in a row, with logarithms of ratios up to `strength`.
    fn band(strength: f64) -> Cluster {
        let mut tracks = Tracks::new();
        for track in 0..80_u32 {
            let mut wanted = Vec::new();
            for at in 0..4 {
                let ratio = f64::from((track * 7 + at * 11) % 13) / 6.0 - 1.0;
                wanted.push((track + at, strength * ratio));
            }
            tracks.push((wanted, 0.0));
        }
        let mut cluster = Cluster::default();
        problem_of(&tracks).for_each_cluster(|problem| cluster.load(problem));
        cluster
    }

    /// Beyond the range of `f64`; at last so far that cells of one table are, too.
    #[test]
    fn scaled_tables_give_the_same_to_the_bit() {
        for (strength, is_taken) in [(1.0, true), (10.0, true), (14.0, true), (90.0, false)] {
            let mut cluster = band(strength);
            assert_eq!(cluster.is_narrow(), strength == 1.0);
            for turn in [Turn::Tracks, Turn::Detections] {
                let wide = shares::<Wide>(&mut cluster, turn);
                let scaled = shares::<Scaled>(&mut cluster, turn);
                assert_eq!(scaled, wide.filter(|_| is_taken), "{strength} {turn:?}");
            }
        }
    }
}
