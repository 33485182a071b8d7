//! The tuples of a cluster that are worth having, and prices of its tracks that bound what any division into tuples costs.
//!
//! # Reference
//! S. Deb, M. Yeddanapudi, K. Pattipati, Y. Bar-Shalom, A generalized S-D assignment algorithm for multisensor-multitarget
//! state estimation, IEEE Trans. Aerospace and Electronic Systems 33, 1997, 523–538; M. Held, P. Wolfe, H. P. Crowder,
//! Validation of subgradient optimization, Mathematical Programming 6, 1974, 62–88 (the step).
//!
//! # Symbols
//! c(T) cost of a tuple; u(t) ≤ 0 price of a track; r(T) = c(T) − Σ u(t) over its members; L(u) = Σ u(t) + Σ min(0, r(T)).
//!
//! # Method
//! 1. Every tuple of two members or more with c(T) < 0 is listed; another is worth no more than its tracks alone.
//! 2. That each track is in one tuple is relaxed with u as multipliers: no division costs less than L(u).
//! 3. Start at u(t) = min c(T) / |T|, where no r(T) is negative. Then, round after round, take every T with r(T) < 0, count how
//!    often each track is taken, n(t), and step: u(t) += θ (known − L) / Σ (1 − n)² · (1 − n(t)), at most 0. θ begins at 1 and is
//!    halved when ten rounds have brought nothing. The best L counts.
//! 4. The u of the best L, lowered until no r(T) is negative and then raised track by track as far as it goes, are prices
//!    whose sum over any set of tracks bounds what that set can cost.

use super::cluster::{Cluster, NONE};

/// More nodes than allowed would have to be looked at.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct TooLarge;

#[derive(Debug)]
pub(super) struct Tuple {
    pub(super) members: Vec<u32>,
    pub(super) cost: f64,
}

/// Step 1; by lowest member, the cheapest first.
pub(super) fn listed(cluster: &Cluster, nodes: &mut u64) -> Result<Vec<Vec<Tuple>>, TooLarge> {
    let mut row = vec![NONE; cluster.sensors()];
    let mut tuples = Vec::with_capacity(cluster.len());
    for first in 0..cluster.len() as u32 {
        let sensor = cluster.sensor_of(first);
        row[sensor] = first;
        let mut found = Vec::new();
        grow(cluster, &mut row, sensor + 1, &mut found, nodes)?;
        row[sensor] = NONE;
        found.sort_by(|left: &Tuple, right: &Tuple| left.cost.total_cmp(&right.cost));
        tuples.push(found);
    }
    Ok(tuples)
}

/// Every tuple that begins as `row` does and goes on with sensors from `next`.
fn grow(cluster: &Cluster, row: &mut [u32], next: usize, found: &mut Vec<Tuple>, nodes: &mut u64) -> Result<(), TooLarge> {
    *nodes = nodes.checked_sub(1).ok_or(TooLarge)?;
    let members: Vec<u32> = row.iter().copied().filter(|&track| track != NONE).collect();
    for sensor in next..cluster.sensors() {
        for edge in cluster.edges_to(members[0], sensor) {
            if members[1..].iter().all(|&member| cluster.link(member, edge.track).is_some()) {
                row[sensor] = edge.track;
                grow(cluster, row, sensor + 1, found, nodes)?;
                row[sensor] = NONE;
            }
        }
    }
    let cost = cluster.cost(row);
    if members.len() > 1 && cost < 0.0 {
        found.push(Tuple { members, cost });
    }
    Ok(())
}

/// What a relaxation found.
pub(super) struct Relaxation {
    /// The best L.
    pub(super) bound: f64,
    /// Its u.
    pub(super) multipliers: Vec<f64>,
    /// L round by round, the first included.
    pub(super) bounds: Vec<f64>,
}

/// Steps 2 and 3; `known` is what some division costs. It ends after `rounds`, or where L has reached `known`.
pub(super) fn relaxed(tuples: &[Vec<Tuple>], known: f64, rounds: usize) -> Relaxation {
    let mut prices = shares(tuples);
    let mut counts = vec![0.0; prices.len()];
    let first = count_taken(tuples, &prices, &mut counts);
    let mut found = Relaxation { bound: first, multipliers: prices.clone(), bounds: vec![first] };
    let (mut theta, mut idle) = (1.0, 0);
    let mut value = first;
    for _ in 0..rounds {
        let squares: f64 = counts.iter().map(|count| (1.0 - count) * (1.0 - count)).sum();
        if squares == 0.0 || known - found.bound <= 1e-9 {
            break;
        }
        let step = theta * (known - value).max(1e-9) / squares;
        prices.iter_mut().zip(&counts).for_each(|(price, count)| *price = (*price + step * (1.0 - count)).min(0.0));
        value = count_taken(tuples, &prices, &mut counts);
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

/// min c(T) / |T|, at most 0.
fn shares(tuples: &[Vec<Tuple>]) -> Vec<f64> {
    let mut shares = vec![0.0_f64; tuples.len()];
    for tuple in tuples.iter().flatten() {
        for &member in &tuple.members {
            shares[member as usize] = shares[member as usize].min(tuple.cost / tuple.members.len() as f64);
        }
    }
    shares
}

fn reduced(tuple: &Tuple, prices: &[f64]) -> f64 {
    tuple.cost - tuple.members.iter().map(|&member| prices[member as usize]).sum::<f64>()
}

/// L, and n(t). A track whose price is 0 may as well stay alone, which counts it once.
fn count_taken(tuples: &[Vec<Tuple>], prices: &[f64], counts: &mut [f64]) -> f64 {
    counts.fill(0.0);
    let mut value: f64 = prices.iter().sum();
    for tuple in tuples.iter().flatten() {
        let rest = reduced(tuple, prices);
        if rest < 0.0 {
            value += rest;
            tuple.members.iter().for_each(|&member| counts[member as usize] += 1.0);
        }
    }
    let may_be_alone = |(count, price): &(&mut f64, &f64)| **count == 0.0 && **price == 0.0;
    counts.iter_mut().zip(prices).filter(may_be_alone).for_each(|(count, _)| *count = 1.0);
    value
}

/// Step 4.
pub(super) fn prices(tuples: &[Vec<Tuple>], multipliers: &[f64]) -> Vec<f64> {
    let mut prices = multipliers.to_vec();
    for tuple in tuples.iter().flatten() {
        let rest = reduced(tuple, &prices).min(0.0) / tuple.members.len() as f64;
        tuple.members.iter().for_each(|&member| prices[member as usize] += rest);
    }
    let mut room: Vec<f64> = prices.iter().map(|price| -price).collect();
    for track in 0..prices.len() {
        // Only the tuples of this track limit it; those are few, and known by their lowest member.
        for tuple in tuples[..=track].iter().flatten().filter(|tuple| tuple.members.contains(&(track as u32))) {
            room[track] = room[track].min(reduced(tuple, &prices).max(0.0));
        }
        prices[track] += room[track];
    }
    prices
}
