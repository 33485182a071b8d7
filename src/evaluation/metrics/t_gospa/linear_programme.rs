//! T-GOSPA of a cluster from below, by linear programming: assignments may be fractions. Where the solution has none, it is
//! the exact one.
//!
//! # Symbols
//! W share (0 to 1) of a pair at a step; D by how much it falls to the next step; g gain; γ share of a switch, over steps k.
//!
//! # Method
//! 1. Minimise −Σ g W + γ/2 Σ |Wₖ₊₁ − Wₖ|, where no truth and no track is shared out to more than 1 at a step. A fall costs
//!    γ/2 as a rise does; rises are falls plus last minus first, so only falls need variables: D ≥ 0, D ≥ Wₖ − Wₖ₊₁.
//! 2. An interior-point solver finds a solution. Shares all within 1e-5 of 0 or 1 are rounded, and the value is that of
//!    the rounded assignment.
//! 3. A cluster of very many pairs and steps is cut into blocks of steps. Switches between blocks then are free, which
//!    leaves a lower bound.
//! 4. Where one step alone has more pairs than that, a block is one step, and its programme is an assignment of whole numbers,
//!    which a method of assignments solves.

use super::problem::{Near, Solution};
use crate::math::assignment::AssignmentSolver;
use crate::model::watch::Watch;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus,
};
use std::collections::BTreeMap;

/// Most pairs times steps of one programme.
const MAX_SHARES: usize = 8192;

pub struct Bound {
    pub solution: Solution,
    /// Whether it is the exact value.
    pub is_exact: bool,
}

/// `None` when the solver finds no solution, which a programme of sound numbers always has, or the watch says to stop.
pub fn solve(steps: &[Vec<Near>], penalty: f64, watch: &Watch) -> Option<Bound> {
    let pairs = pairs_of(steps).len();
    if pairs > MAX_SHARES {
        return assigned_step_by_step(steps, watch);
    }
    let mut bound = Bound {
        solution: Solution::default(),
        is_exact: true,
    };
    let blocks = steps.chunks((MAX_SHARES / pairs.max(1)).max(1));
    let is_cut = blocks.len() > 1;
    for block in blocks {
        // A programme takes some seconds at most.
        if watch.stops_after(u64::MAX) {
            return None;
        }
        let programme = Programme::new(block, penalty);
        let shares = programme.solve()?;
        bound.is_exact &= !is_cut && shares.iter().all(|share| share.fract() == 0.0);
        bound.solution.add(programme.solution(&shares));
    }
    Some(bound)
}

/// Method 4.
fn assigned_step_by_step(steps: &[Vec<Near>], watch: &Watch) -> Option<Bound> {
    let mut bound = Bound {
        solution: Solution::default(),
        is_exact: steps.len() == 1,
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

struct Programme<'a> {
    steps: &'a [Vec<Near>],
    pairs: BTreeMap<(usize, usize), usize>,
    penalty: f64,
}

/// Rows of A x ≤ b, entry by entry.
#[derive(Default)]
struct Constraints {
    rows: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
    limits: Vec<f64>,
}

impl Constraints {
    fn push(&mut self, entries: impl IntoIterator<Item = (usize, f64)>, limit: f64) {
        for (column, value) in entries {
            self.rows.push(self.limits.len());
            self.columns.push(column);
            self.values.push(value);
        }
        self.limits.push(limit);
    }
}

impl<'a> Programme<'a> {
    fn new(steps: &'a [Vec<Near>], penalty: f64) -> Programme<'a> {
        Programme {
            steps,
            pairs: pairs_of(steps),
            penalty,
        }
    }

    /// Number of the variable W of a pair at a step; the D of the same step lies `pairs · steps` further on.
    fn share(&self, step: usize, pair: usize) -> usize {
        step * self.pairs.len() + pair
    }

    /// Method 1.
    fn objective(&self) -> Vec<f64> {
        let shares = self.pairs.len() * self.steps.len();
        let mut objective = vec![0.0; shares];
        for (step, near) in self.steps.iter().enumerate() {
            for pair in near {
                objective[self.share(step, self.pairs[&(pair.truth, pair.track)])] -= pair.gain;
            }
        }
        for pair in 0..self.pairs.len() {
            objective[self.share(0, pair)] -= 0.5 * self.penalty;
            objective[self.share(self.steps.len() - 1, pair)] += 0.5 * self.penalty;
        }
        objective.resize(2 * shares - self.pairs.len(), self.penalty);
        objective
    }

    fn constraints(&self) -> Constraints {
        let (pairs, shares) = (self.pairs.len(), self.pairs.len() * self.steps.len());
        let (mut of_truth, mut of_track) = (
            BTreeMap::<usize, Vec<usize>>::new(),
            BTreeMap::<usize, Vec<usize>>::new(),
        );
        for (&(truth, track), &pair) in &self.pairs {
            of_truth.entry(truth).or_default().push(pair);
            of_track.entry(track).or_default().push(pair);
        }
        let mut constraints = Constraints::default();
        for variable in 0..2 * shares - pairs {
            constraints.push([(variable, -1.0)], 0.0);
        }
        for step in 0..self.steps.len() {
            for pairs in of_truth.values().chain(of_track.values()) {
                constraints.push(pairs.iter().map(|&pair| (self.share(step, pair), 1.0)), 1.0);
            }
        }
        for variable in 0..shares - pairs {
            constraints.push(
                [
                    (variable, 1.0),
                    (variable + pairs, -1.0),
                    (shares + variable, -1.0),
                ],
                0.0,
            );
        }
        constraints
    }

    /// Method 2: the shares of all pairs at all steps.
    fn solve(&self) -> Option<Vec<f64>> {
        let objective = self.objective();
        let Constraints {
            rows,
            columns,
            values,
            limits,
        } = self.constraints();
        let matrix =
            CscMatrix::new_from_triplets(limits.len(), objective.len(), rows, columns, values);
        let no_squares = CscMatrix::zeros((objective.len(), objective.len()));
        let (tolerance, mut settings) = (1e-10, DefaultSettingsBuilder::default());
        settings
            .verbose(false)
            .tol_gap_abs(tolerance)
            .tol_gap_rel(tolerance)
            .tol_feas(tolerance)
            .max_threads(1);
        let cones = [NonnegativeConeT(limits.len())];
        let mut solver = DefaultSolver::new(
            &no_squares,
            &objective,
            &matrix,
            &limits,
            &cones,
            settings.build().ok()?,
        )
        .ok()?;
        solver.solve();
        if !matches!(
            solver.solution.status,
            SolverStatus::Solved | SolverStatus::AlmostSolved
        ) {
            return None;
        }
        let mut shares = solver.solution.x;
        shares.truncate(self.pairs.len() * self.steps.len());
        if shares
            .iter()
            .all(|share| (share - share.round()).abs() < 1e-5)
        {
            shares.iter_mut().for_each(|share| *share = share.round());
        }
        self.keep_within_one(&mut shares);
        Some(shares)
    }

    /// The solver keeps its constraints to a tolerance; this keeps them exactly.
    fn keep_within_one(&self, shares: &mut [f64]) {
        for at_step in shares.chunks_mut(self.pairs.len().max(1)) {
            let (mut of_truth, mut of_track) =
                (BTreeMap::<usize, f64>::new(), BTreeMap::<usize, f64>::new());
            for (&(truth, track), &pair) in &self.pairs {
                at_step[pair] = at_step[pair].max(0.0);
                *of_truth.entry(truth).or_default() += at_step[pair];
                *of_track.entry(track).or_default() += at_step[pair];
            }
            for (&(truth, track), &pair) in &self.pairs {
                at_step[pair] /= of_truth[&truth].max(of_track[&track]).max(1.0);
            }
        }
    }

    fn solution(&self, shares: &[f64]) -> Solution {
        let mut solution = Solution::default();
        for (step, near) in self.steps.iter().enumerate() {
            for pair in near {
                let share = shares[self.share(step, self.pairs[&(pair.truth, pair.track)])];
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
            let bound = solve(&cluster.steps, penalty, &Watch::never()).unwrap();
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
        let half = MAX_SHARES / 4 + 100;
        let steps: Vec<Vec<Near>> = (0..2 * half)
            .map(|step| near(usize::from(step >= half)))
            .collect();
        let bound = solve(&steps, 0.2, &Watch::never()).unwrap();
        assert!(!bound.is_exact);
        let exact = 0.2 - 0.5 * 2.0 * half as f64;
        assert!(
            bound.solution.tally.cost(0.2) <= exact + 1e-6,
            "{} {exact}",
            bound.solution.tally.cost(0.2)
        );
        assert!(bound.solution.tally.cost(0.2) >= exact - 0.2 - 1e-6);
    }
}
