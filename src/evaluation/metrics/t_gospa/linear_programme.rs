//! T-GOSPA of a cluster from below, by linear programming: assignments may be fractions. Where the solution has none, it is
//! the exact one.
//!
//! # Symbols
//! W share (0 to 1) of a pair at a step; g gain; γ share of a switch, over steps k.
//!
//! # Method
//! 1. Minimise −Σ g W + γ/2 Σ |Wₖ₊₁ − Wₖ|, where no truth and no track is shared out to more than 1 at a step.
//! 2. [`primal_dual`](super::primal_dual) finds shares, and prices that prove how little any shares may cost.
//! 3. A cluster of very many pairs and steps is cut into blocks of steps. Switches between blocks then are free, which
//!    leaves a lower bound.
//! 4. Where one step alone has more pairs than that, a block is one step, and its programme is an assignment of whole numbers,
//!    which a method of assignments solves.

use super::primal_dual::Programme;
use super::problem::{Cluster, Near, Solution};
use crate::math::assignment::AssignmentSolver;
use crate::model::watch::Watch;
use std::collections::BTreeMap;

/// Most pairs times steps of one programme.
const MAX_SHARES: usize = 1 << 20;
/// Most members times steps of which prices are kept.
const MAX_PRICES: usize = 1 << 24;

#[derive(Debug, Default)]
pub struct Bound {
    pub solution: Solution,
    /// Whether it is the exact value.
    pub is_exact: bool,
    /// No shares cost less.
    pub least: f64,
    /// By step, then member, tracks numbered on from the truths; empty where they would be too many.
    pub prices: Vec<f64>,
}

/// `None` when the watch says to stop.
pub fn solve(cluster: &Cluster, penalty: f64, watch: &Watch) -> Option<Bound> {
    solve_in_blocks(cluster, penalty, MAX_SHARES, watch)
}

fn solve_in_blocks(
    cluster: &Cluster,
    penalty: f64,
    most_shares: usize,
    watch: &Watch,
) -> Option<Bound> {
    let steps = &cluster.steps;
    let pairs = pairs_of(steps).len();
    if pairs > most_shares {
        return assigned_step_by_step(steps, watch);
    }
    let mut bound = Bound::default();
    let blocks = steps.chunks((most_shares / pairs.max(1)).max(1));
    let (is_cut, members) = (blocks.len() > 1, cluster.truths + cluster.tracks);
    let mut are_whole = true;
    for block in blocks {
        let block = Block::new(block, cluster.truths, penalty);
        let relaxed = block.programme.solve(watch)?;
        are_whole &= relaxed.shares.iter().all(|share| share.fract() == 0.0) && relaxed.is_tight;
        bound.least += relaxed.bound;
        bound.solution.add(block.solution(&relaxed.shares));
        if members * steps.len() <= MAX_PRICES {
            block.spread(&relaxed.prices, members, &mut bound.prices);
        }
    }
    bound.is_exact = are_whole && !is_cut;
    Some(bound)
}

/// Method 4.
fn assigned_step_by_step(steps: &[Vec<Near>], watch: &Watch) -> Option<Bound> {
    let mut bound = Bound {
        is_exact: steps.len() == 1,
        ..Bound::default()
    };
    let mut solver = AssignmentSolver::default();
    for near in steps {
        solver.clear();
        let rows: Vec<&[Near]> = near
            .chunk_by(|one, other| one.truth == other.truth)
            .collect();
        for row in &rows {
            row.iter()
                .for_each(|pair| solver.push_edge(pair.track as u32, -pair.gain));
            solver.end_row(0.0);
        }
        solver.solve_until(watch)?;
        for (index, row) in rows.iter().enumerate() {
            let Some(pair) = solver.edge_of(index).map(|edge| row[edge]) else {
                continue;
            };
            bound.solution.tally.gain += pair.gain;
            bound.least -= pair.gain;
            bound.solution.tally.matched += 1.0;
            bound.solution.shares.push((pair.pair, 1.0));
        }
    }
    Some(bound)
}

/// The pairs that are ever near, numbered.
fn pairs_of(steps: &[Vec<Near>]) -> BTreeMap<(usize, usize), usize> {
    let mut pairs = BTreeMap::new();
    for near in steps.iter().flatten() {
        let next = pairs.len();
        pairs.entry((near.truth, near.track)).or_insert(next);
    }
    pairs
}

/// The programme of some steps, with what its numbers mean.
struct Block<'a> {
    steps: &'a [Vec<Near>],
    /// Numbers of pairs by truth and track.
    pairs: BTreeMap<(usize, usize), usize>,
    /// Members of the cluster by their numbers in the programme.
    members: Vec<usize>,
    programme: Programme,
}

impl<'a> Block<'a> {
    fn new(steps: &'a [Vec<Near>], truths: usize, penalty: f64) -> Block<'a> {
        let pairs = pairs_of(steps);
        let mut of_pair = vec![[0; 2]; pairs.len()];
        for (&(truth, track), &pair) in &pairs {
            of_pair[pair] = [truth, truths + track];
        }
        let mut members = of_pair.concat();
        members.sort_unstable();
        members.dedup();
        for member in of_pair.iter_mut().flatten() {
            *member = members.partition_point(|other| other < member);
        }
        let mut gains = vec![0.0; pairs.len() * steps.len()];
        for (near, at_step) in steps.iter().zip(gains.chunks_mut(pairs.len().max(1))) {
            for pair in near {
                at_step[pairs[&(pair.truth, pair.track)]] = pair.gain;
            }
        }
        let programme = Programme {
            pairs: of_pair,
            members: members.len(),
            gains,
            half: 0.5 * penalty,
        };
        Block {
            steps,
            pairs,
            members,
            programme,
        }
    }

    /// Adds the prices of all members of the cluster at these steps.
    fn spread(&self, prices: &[f64], members: usize, all: &mut Vec<f64>) {
        for at_step in prices.chunks(self.members.len().max(1)) {
            let from = all.len();
            all.resize(from + members, 0.0);
            for (&member, &price) in self.members.iter().zip(at_step) {
                all[from + member] = price;
            }
        }
    }

    fn solution(&self, shares: &[f64]) -> Solution {
        let mut solution = Solution::default();
        for (step, near) in self.steps.iter().enumerate() {
            for pair in near {
                let share = shares[step * self.pairs.len() + self.pairs[&(pair.truth, pair.track)]];
                solution.tally.gain += share * pair.gain;
                solution.tally.matched += share;
                if share != 0.0 {
                    solution.shares.push((pair.pair, share));
                }
            }
        }
        let by_step: Vec<&[f64]> = shares.chunks(self.pairs.len().max(1)).collect();
        for (step, change) in by_step.windows(2).enumerate() {
            let switches = change[0]
                .iter()
                .zip(change[1])
                .map(|(now, next)| 0.5 * (next - now).abs())
                .sum();
            solution.tally.switches += switches;
            if let Some(pair) = self.steps[step + 1].first().filter(|_| switches != 0.0) {
                solution.switches.push((pair.pair, switches));
            }
        }
        solution
    }
}

#[cfg(test)]
mod tests {
    use super::super::exact;
    use super::super::problem::Cluster;
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn random(rng: &mut ChaCha8Rng) -> Cluster {
        let (truths, tracks) = (rng.random_range(1..=3), rng.random_range(1..=3));
        let pairs: Vec<(usize, usize)> = (0..truths)
            .flat_map(|truth| (0..tracks).map(move |track| (truth, track)))
            .collect();
        let mut step = || {
            let is_near = |_: &&(usize, usize)| rng.random_bool(0.6);
            let near: Vec<(usize, usize)> = pairs.iter().filter(is_near).copied().collect();
            near.into_iter()
                .map(|(truth, track)| Near {
                    truth,
                    track,
                    gain: rng.random_range(0.01..1.0),
                    pair: 0,
                })
                .collect()
        };
        Cluster {
            truths,
            tracks,
            steps: (0..6).map(|_| step()).collect(),
        }
    }

    #[test]
    fn it_never_exceeds_the_exact_value_and_equals_it_where_it_says_so() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut integral = 0;
        for case in 0..200 {
            let cluster = random(&mut rng);
            let penalty = [0.0, 0.1, 0.4, 1.5][case % 4];
            let exact = exact::solve(&cluster, penalty, &Watch::never())
                .unwrap()
                .tally
                .cost(penalty);
            let bound = solve(&cluster, penalty, &Watch::never()).unwrap();
            let cost = bound.solution.tally.cost(penalty);
            assert!(cost <= exact + 1e-7, "case {case}: {cost} above {exact}");
            if bound.is_exact {
                integral += 1;
                assert!(
                    (cost - exact).abs() < 1e-9,
                    "case {case}: {cost} is not {exact}"
                );
            }
        }
        assert!(
            integral > 100,
            "only {integral} of 200 have whole solutions"
        );
    }

    #[test]
    fn blocks_leave_out_the_switches_between_them() {
        // Truth 0 has track 0 and track 1 by turns, each for half of very many steps: one switch, in the middle.
        let near = |track| {
            vec![Near {
                truth: 0,
                track,
                gain: 0.5,
                pair: 0,
            }]
        };
        let half = 100;
        let cluster = Cluster {
            truths: 1,
            tracks: 2,
            steps: (0..2 * half)
                .map(|step| near(usize::from(step >= half)))
                .collect(),
        };
        let bound = solve_in_blocks(&cluster, 0.2, 2 * half, &Watch::never()).unwrap();
        assert!(!bound.is_exact);
        let exact = 0.2 - 0.5 * 2.0 * half as f64;
        assert!(
            bound.solution.tally.cost(0.2) <= exact + 1e-6,
            "{} {exact}",
            bound.solution.tally.cost(0.2)
        );
        assert!(bound.solution.tally.cost(0.2) >= exact - 0.2 - 1e-6);
        assert!((bound.least - exact + 0.2).abs() < 1e-6, "{}", bound.least);
    }
}
