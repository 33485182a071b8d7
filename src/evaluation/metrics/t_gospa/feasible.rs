//! T-GOSPA of a cluster from above: what some assignment costs that is one. Beside the bound from below it shows how far the
//! exact value may be.
//!
//! # Symbols
//! γ share of a switch. A member is *fresh* until it is first assigned: two that take each other then might have held each other
//! from the start, so that is no switch.
//!
//! # Method
//! 1. Step by step, one to one with the largest worth: what a pair gains within the next so many steps, γ/2 more if it is held
//!    already, γ/2 less if taking it is a switch.
//! 2. For windows of several lengths; the assignment that costs least counts.

use super::problem::{Cluster, Solution, Tally};
use crate::math::assignment::AssignmentSolver;
use std::collections::BTreeMap;

/// Steps that a decision looks ahead, its own among them.
const WINDOWS: [usize; 7] = [1, 2, 3, 5, 8, 16, 64];

/// The assignment that costs least.
pub fn solve(cluster: &Cluster, penalty: f64) -> Solution {
    let solutions = WINDOWS
        .iter()
        .map(|&window| Walk::new(cluster, penalty).go(window));
    let cheaper = |best: Solution, next: Solution| {
        if next.tally.cost(penalty) < best.tally.cost(penalty) {
            next
        } else {
            best
        }
    };
    // To assign nobody is an assignment, too.
    solutions.fold(Solution::default(), cheaper)
}

struct Walk<'a> {
    cluster: &'a Cluster,
    penalty: f64,
    /// The track that each truth holds.
    track_of: Vec<Option<usize>>,
    is_fresh_truth: Vec<bool>,
    is_fresh_track: Vec<bool>,
    /// Of pairs near in the window: what they gain in it, and at how many of its steps.
    ahead: BTreeMap<(usize, usize), (f64, usize)>,
    solver: AssignmentSolver,
    solution: Solution,
}

impl<'a> Walk<'a> {
    fn new(cluster: &'a Cluster, penalty: f64) -> Walk<'a> {
        Walk {
            cluster,
            penalty,
            track_of: vec![None; cluster.truths],
            is_fresh_truth: vec![true; cluster.truths],
            is_fresh_track: vec![true; cluster.tracks],
            ahead: BTreeMap::new(),
            solver: AssignmentSolver::default(),
            solution: Solution::default(),
        }
    }

    fn go(mut self, window: usize) -> Solution {
        let steps = &self.cluster.steps;
        (0..window.min(steps.len())).for_each(|step| self.look_at(step));
        for step in 0..steps.len() {
            self.assign(step);
            for near in &steps[step] {
                if self.track_of[near.truth] == Some(near.track) {
                    self.solution.tally += Tally {
                        gain: near.gain,
                        matched: 1.0,
                        switches: 0.0,
                    };
                    self.solution.shares.push((near.pair, 1.0));
                }
            }
            self.forget(step);
            if step + window < steps.len() {
                self.look_at(step + window);
            }
        }
        self.solution
    }

    fn look_at(&mut self, step: usize) {
        for near in &self.cluster.steps[step] {
            let entry = self.ahead.entry((near.truth, near.track)).or_default();
            *entry = (entry.0 + near.gain, entry.1 + 1);
        }
    }

    fn forget(&mut self, step: usize) {
        for near in &self.cluster.steps[step] {
            let key = (near.truth, near.track);
            match self.ahead.get_mut(&key) {
                Some(entry) if entry.1 > 1 => *entry = (entry.0 - near.gain, entry.1 - 1),
                _ => {
                    self.ahead.remove(&key);
                }
            }
        }
    }

    /// Step 1.
    fn assign(&mut self, step: usize) {
        let mut rows: Vec<Vec<(usize, f64)>> = vec![Vec::new(); self.cluster.truths];
        for (&(truth, track), &(gain, _)) in &self.ahead {
            rows[truth].push((track, gain + self.bonus(truth, track)));
        }
        for (truth, row) in rows.iter_mut().enumerate() {
            if let Some(held) =
                self.track_of[truth].filter(|held| row.iter().all(|(track, _)| track != held))
            {
                row.push((held, 0.5 * self.penalty));
            }
        }
        self.solver.clear();
        for row in &rows {
            row.iter()
                .for_each(|&(track, worth)| self.solver.push_edge(track as u32, -worth));
            self.solver.end_row(0.0);
        }
        // To leave everybody alone is always possible.
        self.solver.solve();
        let chosen: Vec<Option<usize>> = (0..rows.len())
            .map(|truth| self.solver.column_of(truth).map(|track| track as usize))
            .collect();
        self.take(step, &chosen);
    }

    fn bonus(&self, truth: usize, track: usize) -> f64 {
        match self.track_of[truth] == Some(track) {
            true => 0.5 * self.penalty,
            false if self.is_fresh_truth[truth] && self.is_fresh_track[track] => 0.0,
            false => -0.5 * self.penalty,
        }
    }

    /// Counts half a switch for each pair that is let go, and for each that is taken by a member that is not fresh.
    fn take(&mut self, step: usize, chosen: &[Option<usize>]) {
        let mut halves = 0;
        for (truth, &track) in chosen.iter().enumerate() {
            let before = self.track_of[truth];
            if before == track {
                continue;
            }
            halves += usize::from(before.is_some());
            halves += track.map_or(0, |track| {
                usize::from(!(self.is_fresh_truth[truth] && self.is_fresh_track[track]))
            });
        }
        let switches = 0.5 * halves as f64;
        self.solution.tally.switches += switches;
        let first = self.cluster.steps[step].first();
        if let Some(pair) = first.filter(|_| halves > 0) {
            self.solution.switches.push((pair.pair, switches));
        }
        for (truth, &track) in chosen.iter().enumerate() {
            self.track_of[truth] = track;
            if let Some(track) = track {
                (self.is_fresh_truth[truth], self.is_fresh_track[track]) = (false, false);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::exact;
    use super::super::problem::Near;
    use super::*;
    use crate::model::watch::Watch;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn near(truth: usize, track: usize, gain: f64) -> Near {
        Near {
            truth,
            track,
            gain,
            pair: 0,
        }
    }

    #[test]
    fn a_change_of_track_is_one_switch_and_a_first_hold_none() {
        // Truth 0 has track 0 for three steps, then track 1 for three: gains 6 · 0.8, one switch.
        let steps = (0..6)
            .map(|step| vec![near(0, usize::from(step >= 3), 0.8)])
            .collect();
        let tally = solve(
            &Cluster {
                truths: 1,
                tracks: 2,
                steps,
            },
            0.2,
        )
        .tally;
        assert!(
            (tally.gain - 4.8).abs() < 1e-12 && tally.switches == 1.0,
            "{tally:?}"
        );
    }

    #[test]
    fn it_is_never_below_the_exact_value() {
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        let mut equal = 0;
        for case in 0..200 {
            let (truths, tracks) = (rng.random_range(1..=3), rng.random_range(1..=3));
            let mut step = || {
                let pairs =
                    (0..truths).flat_map(|truth| (0..tracks).map(move |track| (truth, track)));
                let near_ones: Vec<(usize, usize)> =
                    pairs.filter(|_| rng.random_bool(0.6)).collect();
                near_ones
                    .into_iter()
                    .map(|(truth, track)| near(truth, track, rng.random_range(0.01..1.0)))
                    .collect()
            };
            let cluster = Cluster {
                truths,
                tracks,
                steps: (0..6).map(|_| step()).collect(),
            };
            let penalty = [0.0, 0.1, 0.4, 1.5][case % 4];
            let exact = exact::solve(&cluster, penalty, &Watch::never())
                .unwrap()
                .tally
                .cost(penalty);
            let above = solve(&cluster, penalty).tally.cost(penalty);
            assert!(above >= exact - 1e-9, "case {case}: {above} below {exact}");
            equal += usize::from((above - exact).abs() < 1e-9);
        }
        assert!(equal > 100, "only {equal} of 200 are exact");
    }
}
