//! Costs that are no chain: all tuples worth having are listed, and branch and bound divides the tracks of a cluster among those that
//! the relaxation leaves.
//!
//! # Symbols
//! c(T) cost of a tuple; u(t) ≤ 0 price of a track ([`crate::correlation::tuples`]): tracks that are left cost Σ u(t) at least.
//!
//! # Method
//! 1. Take the lowest track that has no tuple yet. Give it each listed tuple of which it is the lowest member, the cheapest
//!    first, and whose members are all free; last leave it alone. Go on with the next.
//! 2. Where the cost so far and Σ u(t) over the free tracks do not undercut the best answer known, nothing below is looked at.
//!    The first best answer is a local search's.

use super::cluster::{Cluster, LEAST_GAIN};
use super::tuples::{Relaxation, TooLarge, Tuple, list_tuples, prices, relax};
use crate::model::watch::Watch;

/// Rounds of the relaxation that gives the prices.
const ROUNDS: usize = 200;

struct Cover<'w> {
    watch: &'w Watch<'w>,
    /// By lowest member, the cheapest first.
    tuples: Vec<Vec<Tuple>>,
    prices: Vec<f64>,
    is_free: Vec<bool>,
    /// Lowest member and place of each tuple taken.
    chosen: Vec<(u32, u32)>,
    best_cost: f64,
    /// `None` while the answer that was known is the best.
    best: Option<Vec<Vec<u32>>>,
}

/// The cheapest tuples of a cluster, numbered as it does, if they cost less than `known`. `nodes` is what may yet be looked at.
pub(super) fn cheapest_cover(
    cluster: &Cluster,
    known: f64,
    nodes: &mut u64,
    watch: &Watch,
) -> Result<Option<Vec<Vec<u32>>>, TooLarge> {
    let Relaxation {
        tuples,
        multipliers,
        ..
    } = relax(&list_tuples(cluster, nodes, watch)?, known, ROUNDS);
    let prices = prices(&tuples, &multipliers);
    let rest = prices.iter().sum();
    let is_free = vec![true; cluster.len()];
    let mut cover = Cover {
        watch,
        tuples,
        prices,
        is_free,
        chosen: Vec::new(),
        best_cost: known,
        best: None,
    };
    cover.descend(0, 0.0, rest, nodes)?;
    Ok(cover.best)
}

impl Cover<'_> {
    /// `rest` is Σ u(t) over the free tracks.
    fn descend(
        &mut self,
        from: u32,
        cost: f64,
        rest: f64,
        nodes: &mut u64,
    ) -> Result<(), TooLarge> {
        *nodes = nodes
            .checked_sub(1)
            .filter(|_| !self.watch.stops_after(64))
            .ok_or(TooLarge)?;
        if cost + rest >= self.best_cost - LEAST_GAIN {
            return Ok(());
        }
        let Some(track) =
            (from..self.is_free.len() as u32).find(|&track| self.is_free[track as usize])
        else {
            let tuple = |&(track, place): &(u32, u32)| {
                self.tuples[track as usize][place as usize].members.clone()
            };
            self.best = Some(self.chosen.iter().map(tuple).collect());
            self.best_cost = cost;
            return Ok(());
        };
        for place in 0..self.tuples[track as usize].len() {
            let Tuple {
                members,
                cost: of_tuple,
            } = &self.tuples[track as usize][place];
            if !members.iter().all(|&member| self.is_free[member as usize]) {
                continue;
            }
            let price: f64 = members
                .iter()
                .map(|&member| self.prices[member as usize])
                .sum();
            let with_tuple = cost + of_tuple;
            self.set_free(track, place, false);
            self.chosen.push((track, place as u32));
            self.descend(track + 1, with_tuple, rest - price, nodes)?;
            self.chosen.pop();
            self.set_free(track, place, true);
        }
        self.is_free[track as usize] = false;
        self.descend(track + 1, cost, rest - self.prices[track as usize], nodes)?;
        self.is_free[track as usize] = true;
        Ok(())
    }

    fn set_free(&mut self, track: u32, place: usize, is_free: bool) {
        for &member in &self.tuples[track as usize][place].members {
            self.is_free[member as usize] = is_free;
        }
    }
}
