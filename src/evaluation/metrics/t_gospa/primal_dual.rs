//! The linear programme of T-GOSPA, solved by a first-order method: no matrix, no factors, a few passes over all shares a round.
//!
//! # Symbols
//! W share of a pair at a step, g its gain, h half a switch, k step; u ≥ 0 price of a member (truth or track) at a step, y pull of a pair from
//! one step to the next, within ±h; ω weight of W against u and y.
//!
//! # Method
//! 1. min over W ≥ 0, max over u and y of −Σ g W + Σ u (Σ W of the member − 1) + Σ y (Wₖ₊₁ − Wₖ).
//! 2. A round takes W a step down its gradient, then u and y a step up theirs at twice the new W less the old. Steps are as long as the number
//!    of entries in a row and a column of the constraints allows, by ω longer or shorter.
//! 3. The point goes twice as far as the round, and is drawn back to where it started, less with each round. From where a round moves
//!    it much less it starts anew, with ω as the ways of W and of u and y were.
//! 4. Any u bounds the programme from below ([`Programme::bound`]), any W within its limits from above. It ends where these meet, or with what
//!    rounds are allowed.
//!
//! # References
//! - A. Chambolle, T. Pock, A First-Order Primal-Dual Algorithm for Convex Problems with Applications to Imaging, Journal of Mathematical
//!   Imaging and Vision 40, 2011, 120–145: rounds.
//! - T. Pock, A. Chambolle, Diagonal Preconditioning for First Order Primal-Dual Algorithms in Convex Optimization, ICCV 2011: lengths of steps.
//! - H. Lu, J. Yang, Restarted Halpern PDHG for Linear Programming, arXiv:2407.16144, 2024: drawing back and starting anew.

use crate::model::watch::Watch;

/// Rounds between two looks at whether to start anew, and at the bounds.
const RESTART_ROUNDS: usize = 8;
const BOUND_ROUNDS: usize = 40;
/// Most rounds, and most shares times rounds.
const MAX_ROUNDS: usize = 20_000;
const MAX_WORK: usize = 4_000_000_000;
/// How near the bounds have to come, as a share of what all pairs would gain.
const TIGHT: f64 = 1e-9;
/// Most entries of a column: a truth, a track, the change before and the change after.
const ENTRIES: f64 = 4.0;

#[derive(Debug, Default)]
pub struct Programme {
    /// Truth and track of each pair, numbered together.
    pub pairs: Vec<[usize; 2]>,
    pub members: usize,
    /// By step, then pair: 0 where they are not near.
    pub gains: Vec<f64>,
    /// Half a switch.
    pub half: f64,
}

/// W, u and y, by step, then pair or member.
#[derive(Debug, Clone)]
struct Point {
    shares: Vec<f64>,
    prices: Vec<f64>,
    pulls: Vec<f64>,
}

#[derive(Debug)]
pub struct Relaxed {
    /// Within their limits; they cost `cost`.
    pub shares: Vec<f64>,
    pub cost: f64,
    /// They prove that nothing costs less than `bound`.
    pub prices: Vec<f64>,
    pub bound: f64,
    /// Whether both are as near as it was to come.
    pub is_tight: bool,
}

impl Programme {
    fn steps(&self) -> usize {
        self.gains.len() / self.pairs.len().max(1)
    }

    /// The best of both bounds that any round had; `None` when the watch says to stop.
    pub fn solve(&self, watch: &Watch) -> Option<Relaxed> {
        let mut descent = Descent::new(self);
        let mut best = Relaxed {
            shares: vec![0.0; self.gains.len()],
            cost: 0.0,
            prices: vec![0.0; self.members * self.steps()],
            bound: f64::NEG_INFINITY,
            is_tight: false,
        };
        let tight = TIGHT * self.gains.iter().sum::<f64>();
        let most = MAX_ROUNDS
            .min(MAX_WORK / self.gains.len().max(1))
            .max(BOUND_ROUNDS);
        for round in 0..most {
            // A share takes some nanoseconds a round.
            if watch.stops_after(2 * self.gains.len() as u64) {
                return None;
            }
            descent.round(round);
            if (round + 1) % BOUND_ROUNDS == 0 {
                self.improve(&mut best, &descent.next);
                best.is_tight = best.cost - best.bound <= tight;
                if best.is_tight {
                    break;
                }
            }
        }
        Some(best)
    }

    fn improve(&self, best: &mut Relaxed, point: &Point) {
        let bound = self.bound(&point.prices);
        if bound > best.bound {
            best.bound = bound;
            best.prices.copy_from_slice(&point.prices);
        }
        for is_rounded in [true, false] {
            let shares = self.within_limits(&point.shares, is_rounded);
            let cost = self.cost(&shares);
            if cost < best.cost {
                (best.cost, best.shares) = (cost, shares);
            }
        }
    }

    /// What prices prove: a pair alone gains at most what its best way to be held and left does, less the prices.
    fn bound(&self, prices: &[f64]) -> f64 {
        let count = self.pairs.len();
        let (mut left, mut held) = (vec![0.0_f64; count], vec![0.0_f64; count]);
        let by_step = self.gains.chunks(count.max(1));
        for (step, (gains, prices)) in by_step.zip(prices.chunks(self.members.max(1))).enumerate() {
            let cost = if step == 0 { 0.0 } else { self.half };
            for (pair, &[truth, track]) in self.pairs.iter().enumerate() {
                let (off, on) = (left[pair], held[pair]);
                left[pair] = off.max(on - cost);
                held[pair] = on.max(off - cost) + gains[pair] - prices[truth] - prices[track];
            }
        }
        let gains = left.iter().zip(&held).map(|(left, held)| left.max(*held));
        -prices.iter().sum::<f64>() - gains.sum::<f64>()
    }

    /// Rounds keep the limits in the end only; this keeps them exactly, rounded to whole numbers or not.
    fn within_limits(&self, shares: &[f64], is_rounded: bool) -> Vec<f64> {
        let mut shares = shares.to_vec();
        let mut sums = vec![0.0_f64; self.members];
        for at_step in shares.chunks_mut(self.pairs.len().max(1)) {
            sums.fill(0.0);
            for (share, &[truth, track]) in at_step.iter_mut().zip(&self.pairs) {
                if is_rounded {
                    *share = f64::from(*share > 0.5);
                }
                sums[truth] += *share;
                sums[track] += *share;
            }
            for (share, &[truth, track]) in at_step.iter_mut().zip(&self.pairs) {
                *share /= sums[truth].max(sums[track]).max(1.0);
            }
        }
        shares
    }

    fn cost(&self, shares: &[f64]) -> f64 {
        let gained: f64 = shares.iter().zip(&self.gains).map(|(w, g)| w * g).sum();
        let later = shares.iter().skip(self.pairs.len());
        let changed: f64 = shares
            .iter()
            .zip(later)
            .map(|(now, next)| (next - now).abs())
            .sum();
        self.half * changed - gained
    }
}

struct Descent<'a> {
    programme: &'a Programme,
    /// Entries of the rows of each member.
    entries: Vec<f64>,
    weight: f64,
    start: Point,
    now: Point,
    next: Point,
    sums: Vec<f64>,
    /// Rounds since the start, and how far one moved the point at first and at the last look.
    since: usize,
    first_move: f64,
    last_move: f64,
}

impl<'a> Descent<'a> {
    fn new(programme: &'a Programme) -> Self {
        let mut entries = vec![0.0; programme.members];
        for member in programme.pairs.iter().flatten() {
            entries[*member] += 1.0;
        }
        let shares = programme.gains.len();
        let point = Point {
            shares: vec![0.0; shares],
            prices: vec![0.0; programme.members * programme.steps()],
            pulls: vec![0.0; shares - programme.pairs.len()],
        };
        Descent {
            programme,
            entries,
            weight: 1.0,
            start: point.clone(),
            now: point.clone(),
            next: point,
            sums: vec![0.0; programme.members],
            since: 0,
            first_move: f64::INFINITY,
            last_move: f64::INFINITY,
        }
    }

    fn round(&mut self, round: usize) {
        for step in 0..self.programme.steps() {
            self.lower(step);
            self.raise(step);
        }
        if self.since == 0 || round.is_multiple_of(RESTART_ROUNDS) {
            let now = self.moved_since(&self.now);
            let moved = (self.weight * now.0 + now.1 / self.weight).sqrt();
            if self.since == 0 {
                (self.first_move, self.last_move) = (moved, moved);
            } else if self.is_far_enough(moved, round) {
                return self.restart();
            }
            self.last_move = moved;
        }
        self.draw_back();
    }

    /// Method 2, of the shares of a step.
    fn lower(&mut self, step: usize) {
        let (pairs, members) = (&self.programme.pairs, self.programme.members);
        let at = step * pairs.len()..(step + 1) * pairs.len();
        let prices = &self.now.prices[step * members..(step + 1) * members];
        let gains = &self.programme.gains[at.clone()];
        let before = step
            .checked_sub(1)
            .map(|step| &self.now.pulls[step * pairs.len()..]);
        let after = self
            .now
            .pulls
            .get(at.start..)
            .filter(|pulls| !pulls.is_empty());
        let length = 1.0 / (ENTRIES * self.weight);
        self.sums.fill(0.0);
        let shares = self.next.shares[at.clone()]
            .iter_mut()
            .zip(&self.now.shares[at]);
        for (pair, (next, &now)) in shares.enumerate() {
            let [truth, track] = pairs[pair];
            let pull =
                before.map_or(0.0, |pulls| pulls[pair]) - after.map_or(0.0, |pulls| pulls[pair]);
            let slope = prices[truth] + prices[track] - gains[pair] + pull;
            *next = (now - length * slope).clamp(0.0, 1.0);
            self.sums[truth] += 2.0 * *next - now;
            self.sums[track] += 2.0 * *next - now;
        }
    }

    /// Method 2, of the prices of a step and of the pulls that lead to it.
    fn raise(&mut self, step: usize) {
        let (count, members) = (self.programme.pairs.len(), self.programme.members);
        for member in 0..members {
            let (place, length) = (step * members + member, self.weight / self.entries[member]);
            self.next.prices[place] =
                (self.now.prices[place] + length * (self.sums[member] - 1.0)).max(0.0);
        }
        let Some(before) = step.checked_sub(1).map(|step| step * count) else {
            return;
        };
        let (at, half) = (before + count, self.programme.half);
        let next = &self.next.shares[before..at + count];
        let now = &self.now.shares[before..at + count];
        let pulls = self.next.pulls[before..at].iter_mut();
        for (pair, (pull, old)) in pulls.zip(&self.now.pulls[before..at]).enumerate() {
            let change = 2.0 * (next[pair + count] - next[pair]) - (now[pair + count] - now[pair]);
            *pull = (old + 0.5 * self.weight * change).clamp(-half, half);
        }
    }

    /// Squares of the ways of W, and of u and y, from a point to the last round's, in the lengths of steps.
    fn moved_since(&self, point: &Point) -> (f64, f64) {
        let square =
            |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum() };
        let mut dual = 2.0 * square(&self.next.pulls, &point.pulls);
        let members = self.programme.members.max(1);
        let by_step = self
            .next
            .prices
            .chunks(members)
            .zip(point.prices.chunks(members));
        for (next, old) in by_step {
            for (member, entries) in self.entries.iter().enumerate() {
                dual += entries * (next[member] - old[member]) * (next[member] - old[member]);
            }
        }
        (ENTRIES * square(&self.next.shares, &point.shares), dual)
    }

    fn is_far_enough(&self, moved: f64, round: usize) -> bool {
        moved <= 0.2 * self.first_move
            || (moved <= 0.8 * self.first_move && moved > self.last_move)
            || self.since as f64 >= 0.36 * round as f64
    }

    fn restart(&mut self) {
        let (shares, dual) = self.moved_since(&self.start);
        if shares > 0.0 && dual > 0.0 {
            // The geometric mean of what it was and of what the ways say; square roots are the same on every machine.
            self.weight = (self.weight * (dual / shares).sqrt()).sqrt();
        }
        for point in [&mut self.start, &mut self.now] {
            point.shares.copy_from_slice(&self.next.shares);
            point.prices.copy_from_slice(&self.next.prices);
            point.pulls.copy_from_slice(&self.next.pulls);
        }
        self.since = 0;
    }

    /// Method 3.
    fn draw_back(&mut self) {
        self.since += 1;
        let back = 1.0 / (self.since + 1) as f64;
        let (now, next, start) = (&mut self.now, &self.next, &self.start);
        for (now, next, start) in [
            (&mut now.shares, &next.shares, &start.shares),
            (&mut now.prices, &next.prices, &start.prices),
            (&mut now.pulls, &next.pulls, &start.pulls),
        ] {
            for ((now, next), start) in now.iter_mut().zip(next).zip(start) {
                *now = (1.0 - back) * (2.0 * next - *now) + back * start;
            }
        }
    }
}
