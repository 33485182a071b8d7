//! T-GOSPA of an entangled cluster exactly: without the pairs that its prices rule out it is rarely entangled.
//!
//! # Symbols
//! g gain, u and v prices of a truth and a track at a step, γ share of a switch; a *way* of a pair is where it is held.
//!
//! # Method
//! 1. A pair gains at most Σ (g − u − v) − γ/2 changes along its best way, so nothing costs less than −Σ u − Σ v − Σ of these. An
//!    assignment that holds a pair at a step costs as much more as the best way through there is worse than the best of all. Both are
//!    found by dynamic programming over two states, from the front and from the back.
//! 2. Leave out what costs more than a margin above the bound, and solve what is left by [`exact`](super::exact). A solution within the
//!    margin is the best of all, for none that is better was left out. Else its own cost, or a margin ten times as wide, is the next margin.
//! 3. Where that is still entangled, what [`feasible`](super::feasible) assigns of it is as good, or bounds the best from above.
//!
//! # Reference
//! G. L. Nemhauser, L. A. Wolsey, Integer and Combinatorial Optimization, Wiley, 1988, section II.5.2: variables fixed by reduced costs.

use super::exact;
use super::feasible;
use super::linear_programme::Bound;
use super::problem::{Cluster, Near, Solution};
use crate::model::watch::Watch;
use std::collections::BTreeMap;

/// Margins that are tried, and the least, as a share of cᵖ beside the gap of the programme.
const MARGINS: usize = 6;
const LEAST_MARGIN: f64 = 1e-9;
/// Bounds so near each other are one, as a share of the cost.
const MEETING: f64 = 1e-6;

pub enum Reduced {
    Exact(Solution),
    /// No solution was found to be the best; the best costs no more than this.
    AtMost(f64),
}

pub fn solve(cluster: &Cluster, bound: &Bound, penalty: f64, watch: &Watch) -> Reduced {
    if bound.prices.is_empty() {
        return Reduced::AtMost(feasible::solve(cluster, penalty).tally.cost(penalty));
    }
    let (least, excesses) = excesses(cluster, &bound.prices, penalty);
    let tight = LEAST_MARGIN * (1.0 + least.abs());
    let mut margin = (bound.solution.tally.cost(penalty) - least).max(0.0) + tight;
    let mut most = f64::INFINITY;
    for _ in 0..MARGINS {
        let left = within(cluster, &excesses, margin);
        let searched = exact::solve(&left, penalty, watch);
        let is_searched = searched.is_some();
        let solution = searched.unwrap_or_else(|| feasible::solve(&left, penalty));
        let cost = solution.tally.cost(penalty);
        // What was not searched is the best only where the bounds meet.
        if cost <= least + margin && (is_searched || margin <= MEETING * (1.0 + least.abs())) {
            return Reduced::Exact(solution);
        }
        most = most.min(cost);
        if !is_searched {
            break;
        }
        margin = (10.0 * margin).max(1e-3).min(most - least + tight);
    }
    Reduced::AtMost(most)
}

/// A near pair by step and place there, with its gain.
type Place = (usize, usize, f64);

/// The bound, and of each near pair how much more an assignment costs that holds it then.
fn excesses(cluster: &Cluster, prices: &[f64], penalty: f64) -> (f64, Vec<Vec<f64>>) {
    let mut places: BTreeMap<(usize, usize), Vec<Place>> = BTreeMap::new();
    for (step, near) in cluster.steps.iter().enumerate() {
        for (place, pair) in near.iter().enumerate() {
            let of_pair = places.entry((pair.truth, pair.track)).or_default();
            of_pair.push((step, place, pair.gain));
        }
    }
    let mut excesses: Vec<Vec<f64>> = cluster.steps.iter().map(|s| vec![0.0; s.len()]).collect();
    let mut least = -prices.iter().sum::<f64>();
    let members = cluster.truths + cluster.tracks;
    for (&(truth, track), places) in &places {
        let mut worths: Vec<f64> = prices
            .chunks(members)
            .map(|at_step| -at_step[truth] - at_step[cluster.truths + track])
            .collect();
        for &(step, _, gain) in places {
            worths[step] += gain;
        }
        let (best, through) = best_ways(&worths, 0.5 * penalty);
        least -= best;
        for &(step, place, _) in places {
            excesses[step][place] = best - through[step];
        }
    }
    (least, excesses)
}

/// What the best way gains, and what the best does that is held at each step.
fn best_ways(worths: &[f64], half: f64) -> (f64, Vec<f64>) {
    let (mut left, mut held) = (0.0_f64, 0.0_f64);
    let mut through = Vec::with_capacity(worths.len());
    for (step, worth) in worths.iter().enumerate() {
        let change = if step == 0 { 0.0 } else { half };
        (left, held) = (left.max(held - change), held.max(left - change) + worth);
        through.push(held);
    }
    let best = left.max(held);
    let (mut left, mut held) = (0.0_f64, 0.0_f64);
    for (through, worth) in through.iter_mut().zip(worths).rev() {
        *through += held;
        (left, held) = (
            left.max(held + worth - half),
            (held + worth).max(left - half),
        );
    }
    (best, through)
}

fn within(cluster: &Cluster, excesses: &[Vec<f64>], margin: f64) -> Cluster {
    let mut left = Cluster {
        truths: cluster.truths,
        tracks: cluster.tracks,
        steps: Vec::new(),
    };
    for (near, excesses) in cluster.steps.iter().zip(excesses) {
        let kept: Vec<Near> = near
            .iter()
            .zip(excesses)
            .filter(|(_, excess)| **excess <= margin)
            .map(|(pair, _)| *pair)
            .collect();
        if !kept.is_empty() {
            left.steps.push(kept);
        }
    }
    left
}

#[cfg(test)]
mod tests;
