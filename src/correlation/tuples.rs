//! The tuples of a cluster that are worth having, and prices of its tracks that bound what any division into tuples costs.
//!
//! # Reference
//! S. Deb, M. Yeddanapudi, K. Pattipati, Y. Bar-Shalom, A generalized S-D assignment algorithm for multisensor-multitarget
//! state estimation, IEEE Trans. Aerospace and Electronic Systems 33, 1997, 523–538; M. Held, P. Wolfe, H. P. Crowder,
//! Validation of subgradient optimization, Mathematical Programming 6, 1974, 62–88 (the step).
//!
//! # Symbols
//! c(T) cost of a tuple; u(t) ≤ 0 price of a track; r(T) = c(T) − Σ u(t) over its members; r*(t) the least r(T) of all T whose lowest
//! member is t; L(u) = Σ u(t) + Σ min(0, r*(t)).
//!
//! # Method
//! 1. Every tuple of two members or more with c(T) < 0 is listed; another is worth no more than its tracks alone. Where c(T) is
//!    the sum over all pairs, a tuple is not listed either that costs no less than without one of its members, whose links to
//!    the others sum to 0 or more. What cannot grow into a tuple to be listed is not grown: a member's links to the sensors yet
//!    to come are at best its best ones.
//! 2. That each track is in one tuple is relaxed with u as multipliers, but for this: it is the lowest of one at most. No division
//!    costs less than L(u).
//! 3. Start at u(t) = min c(T) / |T|, where no r(T) is negative. Then, round after round, take the T of each r*(t) < 0, count how
//!    often each track is taken, n(t), and step: u(t) += θ (known − L) / Σ (1 − n)² · (1 − n(t)), at most 0. θ begins at 1 and is
//!    halved when ten rounds have brought nothing. The best L counts. A tuple with L + r(T) ≥ known is in no answer that costs
//!    less than the one known, and is looked at no more: the best L bounds what undercuts that.
//! 4. The u of the best L, each lowered by its r*(t), so that no r(T) is negative, and then raised track by track as far as it
//!    goes, are prices whose sum over any set of tracks bounds what that set can cost.

use super::cluster::{Cluster, NONE};
use crate::model::watch::Watch;

/// More nodes than allowed would have to be looked at.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct TooLarge;

#[derive(Debug)]
pub(super) struct Tuple {
    pub(super) members: Vec<u32>,
    pub(super) cost: f64,
}

/// Step 1; by lowest member, the cheapest first.
pub(super) fn list_tuples(
    cluster: &Cluster,
    nodes: &mut u64,
    watch: &Watch,
) -> Result<Vec<Vec<Tuple>>, TooLarge> {
    let mut listing = Listing::new(cluster, nodes, watch);
    (0..cluster.len() as u32)
        .map(|first| listing.of_lowest(first))
        .collect()
}

struct Listing<'a> {
    cluster: &'a Cluster<'a>,
    nodes: &'a mut u64,
    watch: &'a Watch<'a>,
    members: Vec<u32>,
    /// For each number of members what the links of each to the others sum to, one stretch behind the other.
    sums: Vec<f64>,
    /// [`Cluster::best_links`].
    rests: Vec<f64>,
    row: Vec<u32>,
    found: Vec<Tuple>,
}

impl<'a> Listing<'a> {
    fn new(cluster: &'a Cluster, nodes: &'a mut u64, watch: &'a Watch) -> Self {
        let (rests, row) = (cluster.best_links(), vec![NONE; cluster.sensors()]);
        Listing {
            cluster,
            nodes,
            watch,
            members: Vec::new(),
            sums: Vec::new(),
            rests,
            row,
            found: Vec::new(),
        }
    }

    fn of_lowest(&mut self, first: u32) -> Result<Vec<Tuple>, TooLarge> {
        let next = self.cluster.sensor_of(first) + 1;
        self.members.push(first);
        self.sums.push(0.0);
        let is_whole = if self.cluster.is_pairwise() {
            self.grow_pairs(next, 0.0)
        } else {
            self.grow(next)
        };
        self.members.clear();
        self.sums.clear();
        is_whole?;
        self.found
            .sort_by(|left, right| left.cost.total_cmp(&right.cost));
        Ok(std::mem::take(&mut self.found))
    }

    /// One more is looked at; a stop is as if there were too many.
    fn count_node(&mut self) -> Result<(), TooLarge> {
        *self.nodes = self.nodes.checked_sub(1).ok_or(TooLarge)?;
        if self.watch.stops_after(64) {
            Err(TooLarge)
        } else {
            Ok(())
        }
    }

    /// The tuples that begin with the members and go on with sensors from `next`, of any cost.
    fn grow(&mut self, next: usize) -> Result<(), TooLarge> {
        self.count_node()?;
        if self.members.len() > 1 {
            self.row.fill(NONE);
            self.members
                .iter()
                .for_each(|&member| self.row[self.cluster.sensor_of(member)] = member);
            self.take(self.cluster.cost(&self.row));
        }
        for sensor in next..self.cluster.sensors() {
            for edge in self.cluster.edges_to(self.members[0], sensor) {
                if self.members[1..]
                    .iter()
                    .all(|&member| self.cluster.link(member, edge.track).is_some())
                {
                    self.members.push(edge.track);
                    self.grow(sensor + 1)?;
                    self.members.pop();
                }
            }
        }
        Ok(())
    }

    /// The same where the cost is the sum over all pairs.
    fn grow_pairs(&mut self, next: usize, cost: f64) -> Result<(), TooLarge> {
        self.count_node()?;
        let begin = self.sums.len() - self.members.len();
        let stride = self.cluster.sensors() + 1;
        let with_rest =
            |(&member, sum): (&u32, &f64)| sum + self.rests[member as usize * stride + next];
        if self
            .members
            .iter()
            .zip(&self.sums[begin..])
            .map(with_rest)
            .any(|least| least >= 0.0)
        {
            return Ok(());
        }
        if self.sums[begin..].iter().all(|&sum| sum < 0.0) {
            self.take(cost);
        }
        for sensor in next..self.cluster.sensors() {
            for edge in self.cluster.edges_to(self.members[0], sensor) {
                if let Some(added) = self.push(begin, edge.track) {
                    self.grow_pairs(sensor + 1, cost + added)?;
                    self.members.pop();
                }
                self.sums.truncate(begin + self.members.len());
            }
        }
        Ok(())
    }

    /// Adds a member with its sums behind those that begin there, and tells its own; `None` where a link is missing.
    fn push(&mut self, begin: usize, track: u32) -> Option<f64> {
        let mut added = 0.0;
        for place in 0..self.members.len() {
            let cost = self.cluster.link(self.members[place], track)?;
            self.sums.push(self.sums[begin + place] + cost);
            added += cost;
        }
        self.sums.push(added);
        self.members.push(track);
        Some(added)
    }

    fn take(&mut self, cost: f64) {
        if cost < 0.0 {
            self.found.push(Tuple {
                members: self.members.clone(),
                cost,
            });
        }
    }
}

/// What a relaxation found.
pub(super) struct Relaxation {
    /// The best L.
    pub(super) bound: f64,
    /// Its u.
    pub(super) multipliers: Vec<f64>,
    /// L round by round, the first included.
    pub(super) bounds: Vec<f64>,
    /// The tuples that may be in an answer better than the one known, by lowest member, the cheapest first.
    pub(super) tuples: Vec<Vec<Tuple>>,
}

/// Steps 2 and 3; `known` is what some division costs. It ends after `rounds`, or where L has reached `known`.
pub(super) fn relax(tuples: &[Vec<Tuple>], known: f64, rounds: usize) -> Relaxation {
    let mut open = Open::new(tuples);
    let found = improve_prices(shares(tuples), &mut open, known, rounds);
    Relaxation {
        tuples: open.listed(tuples.len()),
        ..found
    }
}

/// Better prices, from others on.
pub(super) fn better_prices(
    prices: Vec<f64>,
    tuples: &[Vec<Tuple>],
    known: f64,
    rounds: usize,
) -> Vec<f64> {
    improve_prices(prices, &mut Open::new(tuples), known, rounds).multipliers
}

/// Step 3.
fn improve_prices(mut prices: Vec<f64>, open: &mut Open, known: f64, rounds: usize) -> Relaxation {
    let mut counts = vec![0.0; prices.len()];
    let mut value = open.count_taken(&prices, &mut counts);
    let mut found = Relaxation {
        bound: value,
        multipliers: prices.clone(),
        bounds: vec![value],
        tuples: Vec::new(),
    };
    let (mut theta, mut idle) = (1.0, 0);
    for round in 1..=rounds {
        let squares: f64 = counts
            .iter()
            .map(|count| (1.0 - count) * (1.0 - count))
            .sum();
        if squares == 0.0 || known - found.bound <= 1e-9 {
            break;
        }
        if round % 16 == 0 {
            open.close(known - value);
        }
        let step = theta * (known - value).max(1e-9) / squares;
        prices
            .iter_mut()
            .zip(&counts)
            .for_each(|(price, count)| *price = (*price + step * (1.0 - count)).min(0.0));
        value = open.count_taken(&prices, &mut counts);
        found.bounds.push(value);
        idle += 1;
        if value > found.bound {
            (found.bound, idle) = (value, 0);
            found.multipliers.copy_from_slice(&prices);
        } else if idle == 10 {
            (theta, idle) = (theta / 2.0, 0);
        }
    }
    found
}

/// The tuples that may be in an answer better than the one known, by lowest member, one behind the other.
struct Open {
    members: Vec<u32>,
    /// Where each tuple's members end.
    ends: Vec<usize>,
    costs: Vec<f64>,
    /// r(T) under the last prices.
    rests: Vec<f64>,
}

impl Open {
    fn new(tuples: &[Vec<Tuple>]) -> Self {
        let mut open = Open {
            members: Vec::new(),
            ends: Vec::new(),
            costs: Vec::new(),
            rests: Vec::new(),
        };
        for tuple in tuples.iter().flatten() {
            open.members.extend_from_slice(&tuple.members);
            open.ends.push(open.members.len());
            open.costs.push(tuple.cost);
        }
        open.rests = open.costs.clone();
        open
    }

    /// L, and n(t). A track whose price is 0 may as well stay alone, which counts it once.
    fn count_taken(&mut self, prices: &[f64], counts: &mut [f64]) -> f64 {
        counts.fill(0.0);
        let mut value: f64 = prices.iter().sum();
        let (mut begin, mut least) = (0, (0.0, 0..0));
        for index in 0..self.ends.len() {
            let range = begin..self.ends[index];
            begin = range.end;
            let rest = self.costs[index]
                - self.members[range.clone()]
                    .iter()
                    .map(|&member| prices[member as usize])
                    .sum::<f64>();
            self.rests[index] = rest;
            if rest < least.0 {
                least = (rest, range.clone());
            }
            let is_last = self
                .members
                .get(begin)
                .is_none_or(|next| *next != self.members[range.start]);
            if is_last {
                value += least.0;
                self.members[least.1]
                    .iter()
                    .for_each(|&member| counts[member as usize] += 1.0);
                least = (0.0, 0..0);
            }
        }
        let may_be_alone = |(count, price): &(&mut f64, &f64)| **count == 0.0 && **price == 0.0;
        counts
            .iter_mut()
            .zip(prices)
            .filter(may_be_alone)
            .for_each(|(count, _)| *count = 1.0);
        value
    }

    /// The tuples by lowest member, of so many tracks.
    fn listed(&self, tracks: usize) -> Vec<Vec<Tuple>> {
        let mut tuples: Vec<Vec<Tuple>> = (0..tracks).map(|_| Vec::new()).collect();
        let mut begin = 0;
        for (&end, &cost) in self.ends.iter().zip(&self.costs) {
            let members = self.members[begin..end].to_vec();
            tuples[members[0] as usize].push(Tuple { members, cost });
            begin = end;
        }
        tuples
    }

    /// Drops the tuples whose r(T) is that much or more.
    fn close(&mut self, most: f64) {
        let (mut begin, mut kept, mut length) = (0, 0, 0);
        for index in 0..self.ends.len() {
            let end = self.ends[index];
            if self.rests[index] < most {
                self.members.copy_within(begin..end, length);
                length += end - begin;
                (self.ends[kept], self.costs[kept], self.rests[kept]) =
                    (length, self.costs[index], self.rests[index]);
                kept += 1;
            }
            begin = end;
        }
        self.members.truncate(length);
        self.ends.truncate(kept);
        self.costs.truncate(kept);
        self.rests.truncate(kept);
    }
}

/// min c(T) / |T|, at most 0.
fn shares(tuples: &[Vec<Tuple>]) -> Vec<f64> {
    let mut shares = vec![0.0_f64; tuples.len()];
    for tuple in tuples.iter().flatten() {
        for &member in &tuple.members {
            shares[member as usize] =
                shares[member as usize].min(tuple.cost / tuple.members.len() as f64);
        }
    }
    shares
}

fn reduced(tuple: &Tuple, prices: &[f64]) -> f64 {
    tuple.cost
        - tuple
            .members
            .iter()
            .map(|&member| prices[member as usize])
            .sum::<f64>()
}

/// Step 4.
pub(super) fn prices(tuples: &[Vec<Tuple>], multipliers: &[f64]) -> Vec<f64> {
    let least = |of_lowest: &Vec<Tuple>| {
        of_lowest
            .iter()
            .map(|tuple| reduced(tuple, multipliers))
            .fold(0.0, f64::min)
    };
    let mut prices: Vec<f64> = multipliers
        .iter()
        .zip(tuples)
        .map(|(price, of_lowest)| price + least(of_lowest))
        .collect();
    let mut room: Vec<f64> = prices.iter().map(|price| -price).collect();
    for track in 0..prices.len() {
        // Only the tuples of this track limit it; those are few, and known by their lowest member.
        for tuple in tuples[..=track]
            .iter()
            .flatten()
            .filter(|tuple| tuple.members.contains(&(track as u32)))
        {
            room[track] = room[track].min(reduced(tuple, &prices).max(0.0));
        }
        prices[track] += room[track];
    }
    prices
}
