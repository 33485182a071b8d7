//! The linear programme of a large cluster with few of its pairs: those that it needs, found by their prices.
//!
//! # Symbols
//! g gain of a pair at a step, u and v prices of a truth and a track at a step (duals of "not shared out to more than 1"), γ share
//! of a switch.
//!
//! # Method
//! 1. Begin with the pairs of most gain of each truth and of each track, and solve the programme of these alone.
//! 2. A pair that is left out would improve it only if some way to hold and to leave it, W in {0, 1}, makes
//!    Σ (g − u − v) W − γ/2 Σ |Wₖ₊₁ − Wₖ| more than 0. The best one is found by dynamic programming over two states.
//! 3. Add such pairs, the best first, and solve again. Where there is none the solution is that of all pairs: the sum of what
//!    is left is by duality as far as it can be from it.
//!
//! # Reference
//! G. B. Dantzig, P. Wolfe, Decomposition Principle for Linear Programs, Operations Research 8, 1960: pricing of columns that are left out.

use super::linear_programme::{Prices, Programme};
use super::problem::Near;
use crate::model::watch::Watch;
use std::collections::{BTreeMap, BTreeSet};

/// A truth and a track by their places in the cluster.
pub type Members = (usize, usize);

/// Pairs of each member to begin with.
const FIRST: usize = 3;
/// What all pairs that are left out could still gain, as a share of cᵖ.
const NOTHING: f64 = 1e-8;

/// The gains of each pair that is ever near, by step.
type Gains = BTreeMap<Members, Vec<(usize, f64)>>;

pub enum Columns<'a> {
    Solved(Programme<'a>, Vec<f64>),
    /// More pairs are needed than a programme may have.
    TooMany,
    Unsolved,
}

/// Solves the programme of all pairs; `most_pairs` is what one programme may have.
pub fn solve<'a>(
    steps: &'a [Vec<Near>],
    penalty: f64,
    most_pairs: usize,
    watch: &Watch,
) -> Columns<'a> {
    let gains = gains_of(steps);
    let mut active = best_of_each(&gains);
    loop {
        if active.len() > most_pairs {
            return Columns::TooMany;
        }
        // A programme takes a second at most.
        if watch.stops_after(u64::MAX) {
            return Columns::Unsolved;
        }
        let programme = Programme::new(steps, active.iter().copied(), penalty);
        let Some((shares, prices)) = programme.solve() else {
            return Columns::Unsolved;
        };
        let mut wanted: Vec<(f64, Members)> = Vec::new();
        for (members, of_pair) in &gains {
            if !active.contains(members) {
                let worth = worth(*members, of_pair, &prices, penalty);
                if worth > 0.0 {
                    wanted.push((worth, *members));
                }
            }
        }
        let left: f64 = wanted.iter().map(|(worth, _)| worth).sum();
        if left <= NOTHING {
            return Columns::Solved(programme, shares);
        }
        wanted.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let many = active.len() / 2 + FIRST;
        active.extend(wanted.iter().take(many).map(|(_, members)| *members));
    }
}

fn gains_of(steps: &[Vec<Near>]) -> Gains {
    let mut gains = Gains::new();
    for (step, near) in steps.iter().enumerate() {
        for pair in near {
            let of_pair = gains.entry((pair.truth, pair.track)).or_default();
            of_pair.push((step, pair.gain));
        }
    }
    gains
}

/// Of each truth and of each track the pairs with the largest sums of gains.
fn best_of_each(gains: &Gains) -> BTreeSet<Members> {
    let mut of_truth: BTreeMap<usize, Vec<(f64, Members)>> = BTreeMap::new();
    let mut of_track: BTreeMap<usize, Vec<(f64, Members)>> = BTreeMap::new();
    for (members, of_pair) in gains {
        let sum: f64 = of_pair.iter().map(|(_, gain)| gain).sum();
        of_truth.entry(members.0).or_default().push((sum, *members));
        of_track.entry(members.1).or_default().push((sum, *members));
    }
    let mut best = BTreeSet::new();
    for mut pairs in of_truth.into_values().chain(of_track.into_values()) {
        pairs.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        best.extend(pairs.iter().take(FIRST).map(|(_, members)| *members));
    }
    best
}

/// Method 2.
fn worth(members: Members, gains: &[(usize, f64)], prices: &Prices, penalty: f64) -> f64 {
    let half = 0.5 * penalty;
    let (mut alone, mut held) = (0.0f64, 0.0f64);
    let mut gains = gains.iter().peekable();
    for step in 0..prices.steps() {
        let gain = gains.next_if(|(at, _)| *at == step);
        let price = prices.of(step, members);
        let reward = gain.map_or(0.0, |(_, gain)| *gain) - price;
        // Whom one holds at first costs nothing.
        let (left, taken) = if step == 0 {
            (alone, held)
        } else {
            (alone.max(held - half), held.max(alone - half))
        };
        (alone, held) = (left, taken + reward);
    }
    alone.max(held)
}
