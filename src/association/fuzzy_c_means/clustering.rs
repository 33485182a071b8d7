//! The sparse clustering of one association cluster: memberships and centres over the gated pairs alone, with a noise cluster
//! beside the tracks. All memory is reused.

use super::super::problem::{Places, Problem, Row, Weights};
use crate::math::fuzzy_c_means::{Fuzzifier, largest_change};
use crate::model::angle::wrap;

/// δ² at least: dense clutter never puts noise nearer than one standard deviation, so that what fits well is still taken.
const LEAST_NOISE: f64 = 1.0;

/// δ² at most, for a sensor without clutter or misses.
const MOST_NOISE: f64 = 1e6;

/// A detection is on a centre below this d², a millionth of a standard deviation squared: what is nearer is rounding, and two
/// centres on one detection must share it alike.
const ON_CENTRE: f64 = 1e-12;

/// A track and a detection in its gate.
#[derive(Debug, Clone, Copy)]
struct Pair {
    detection: u32,
    /// The track, by its place in the cluster.
    row: u32,
    edge: u32,
}

/// Noise as a detection sees it.
#[derive(Debug, Clone, Copy)]
struct Noise {
    /// δ_k².
    squared: f64,
    /// u_0k.
    membership: f64,
}

#[derive(Debug, Clone, Default)]
pub(super) struct Clustering {
    dimensions: usize,
    angle: Option<usize>,
    /// For each track of the cluster, its row in the scan.
    rows: Vec<u32>,
    /// δ_i².
    noise_of: Vec<f64>,
    centres: Vec<f64>,
    /// In the order of detections, then of tracks.
    pairs: Vec<Pair>,
    /// u_ik of each pair.
    memberships: Vec<f64>,
    before: Vec<f64>,
    /// For each detection, in the order of `pairs`.
    noise: Vec<Noise>,
    squared: Vec<f64>,
    shares: Vec<f64>,
    /// For each track Σ_k u^q (z_k − v), and Σ_k u^q; then the sums of step 4.
    steps: Vec<f64>,
    totals: Vec<f64>,
    odds: Vec<f64>,
}

impl Clustering {
    /// Steps 1 and 2: pairs, noise, and the predictions as centres.
    pub(super) fn load(&mut self, problem: &Problem) {
        let places = problem.places();
        (self.dimensions, self.angle) = (places.dimensions(), places.angle);
        self.rows.clear();
        self.noise_of.clear();
        self.centres.clear();
        self.pairs.clear();
        for (place, (row, state)) in problem.rows().enumerate() {
            self.rows.push(row as u32);
            self.noise_of.push(noise_of(problem, state));
            self.centres.extend_from_slice(places.expected(row));
            self.pairs.extend(state.edges().map(|edge| Pair {
                detection: problem.edge(edge).detection,
                row: place as u32,
                edge: edge as u32,
            }));
        }
        self.pairs
            .sort_unstable_by_key(|pair| (pair.detection, pair.row));
        for values in [&mut self.memberships, &mut self.before, &mut self.odds] {
            values.clear();
            values.resize(self.pairs.len(), 0.0);
        }
        let noise_of = &self.noise_of;
        let mean = |pairs: &[Pair]| {
            pairs
                .iter()
                .map(|pair| noise_of[pair.row as usize])
                .sum::<f64>()
                / pairs.len() as f64
        };
        self.noise.clear();
        self.noise
            .extend(by_detection(&self.pairs).map(|pairs| Noise {
                squared: mean(pairs),
                membership: 0.0,
            }));
    }

    /// Step 3: memberships for the present centres. Returns J.
    pub(super) fn share(&mut self, places: &Places, fuzzifier: Fuzzifier) -> f64 {
        std::mem::swap(&mut self.memberships, &mut self.before);
        let Clustering {
            dimensions,
            angle,
            rows,
            centres,
            pairs,
            memberships,
            noise,
            squared,
            shares,
            ..
        } = self;
        let (mut cost, mut first) = (0.0, 0);
        for (pairs, noise) in by_detection(pairs).zip(noise) {
            squared.clear();
            for pair in pairs {
                let centre = &centres[pair.row as usize * *dimensions..][..*dimensions];
                let inverse = places.inverse(rows[pair.row as usize] as usize);
                squared.push(squared_distance(
                    places.seen(pair.edge, pair.detection),
                    centre,
                    inverse,
                    *angle,
                ));
            }
            squared.push(noise.squared);
            shares.resize(squared.len(), 0.0);
            fuzzifier.share(squared, shares);
            cost += shares
                .iter()
                .zip(squared.iter())
                .map(|(&share, &squared)| fuzzifier.raise(share) * squared)
                .sum::<f64>();
            memberships[first..first + pairs.len()].copy_from_slice(&shares[..pairs.len()]);
            noise.membership = shares[pairs.len()];
            first += pairs.len();
        }
        cost
    }

    /// Between the memberships of the last two calls of [`share`](Self::share).
    pub(super) fn largest_change(&self) -> f64 {
        largest_change(&self.before, &self.memberships)
    }

    /// v_i for the present memberships.
    pub(super) fn move_centres(&mut self, places: &Places, fuzzifier: Fuzzifier) {
        self.totals.clear();
        self.totals.resize(self.rows.len(), 0.0);
        self.steps.clear();
        self.steps.resize(self.centres.len(), 0.0);
        for (pair, &membership) in self.pairs.iter().zip(&self.memberships) {
            let weight = fuzzifier.raise(membership);
            self.totals[pair.row as usize] += weight;
            let first = pair.row as usize * self.dimensions;
            for (axis, measured) in places.seen(pair.edge, pair.detection).iter().enumerate() {
                self.steps[first + axis] += weight
                    * difference(
                        *measured,
                        self.centres[first + axis],
                        self.angle == Some(axis),
                    );
            }
        }
        for (row, &total) in self
            .totals
            .iter()
            .enumerate()
            .filter(|(_, total)| **total > 0.0)
        {
            for axis in 0..self.dimensions {
                let place = row * self.dimensions + axis;
                let moved = self.centres[place] + self.steps[place] / total;
                self.centres[place] = if self.angle == Some(axis) {
                    wrap(moved)
                } else {
                    moved
                };
            }
        }
    }

    /// Writes the memberships as the weights of their edges.
    pub(super) fn spread_over_edges(&self, weights: &mut Weights) {
        for (pair, &membership) in self.pairs.iter().zip(&self.memberships) {
            weights.edges[pair.edge as usize] = membership;
        }
    }

    /// Step 4, weighted.
    pub(super) fn weigh(&mut self, weights: &mut Weights) {
        self.compute_odds();
        let tracks = self.rows.len();
        // Detections that are certainly the track's, and the sum of the others' odds.
        self.totals.clear();
        self.totals.resize(tracks, 0.0);
        self.steps.clear();
        self.steps.resize(tracks, 0.0);
        for (pair, &odds) in self.pairs.iter().zip(&self.odds) {
            let is_certain = odds == f64::INFINITY;
            self.totals[pair.row as usize] += f64::from(u8::from(is_certain));
            self.steps[pair.row as usize] += if is_certain { 0.0 } else { odds };
        }
        for (pair, &odds) in self.pairs.iter().zip(&self.odds) {
            let (certain, sum) = (
                self.totals[pair.row as usize],
                self.steps[pair.row as usize],
            );
            weights.edges[pair.edge as usize] = match odds == f64::INFINITY {
                true => 1.0 / certain,
                false if certain > 0.0 => 0.0,
                false => odds / (1.0 + sum),
            };
        }
        for (place, &row) in self.rows.iter().enumerate() {
            weights.missed[row as usize] = if self.totals[place] > 0.0 {
                0.0
            } else {
                1.0 / (1.0 + self.steps[place])
            };
        }
    }

    /// oᵢₖ of each pair.
    fn compute_odds(&mut self) {
        let mut first = 0;
        for (pairs, noise) in by_detection(&self.pairs).zip(&self.noise) {
            let memberships = &self.memberships[first..first + pairs.len()];
            for (place, &membership) in memberships.iter().enumerate() {
                // Near 1 the difference from 1 would be rounding; the others' sum is not.
                let others = || {
                    memberships
                        .iter()
                        .enumerate()
                        .filter(|(other, _)| *other != place)
                        .map(|(_, membership)| membership)
                };
                let rest = if membership < 0.5 {
                    1.0 - membership
                } else {
                    noise.membership + others().sum::<f64>()
                };
                self.odds[first + place] = membership / rest;
            }
            first += pairs.len();
        }
    }

    /// The state for a trace, as `write(quantity, row of the track, detection, value)`: J; u, without a track for noise; v1 and
    /// so on, the coordinates of the centres.
    pub(super) fn describe(
        &self,
        cost: f64,
        mut write: impl FnMut(&str, Option<u32>, Option<u32>, f64),
    ) {
        write("J", None, None, cost);
        let mut memberships = self.memberships.iter();
        for (pairs, noise) in by_detection(&self.pairs).zip(&self.noise) {
            for (pair, &membership) in pairs.iter().zip(memberships.by_ref()) {
                write(
                    "u",
                    Some(self.rows[pair.row as usize]),
                    Some(pair.detection),
                    membership,
                );
            }
            write(
                "u",
                None,
                pairs.first().map(|pair| pair.detection),
                noise.membership,
            );
        }
        for (&row, centre) in self
            .rows
            .iter()
            .zip(self.centres.chunks_exact(self.dimensions))
        {
            for (name, &value) in ["v1", "v2", "v3"].into_iter().zip(centre) {
                write(name, Some(row), None, value);
            }
        }
    }
}

/// δ_i² of step 1; any edge of the row tells it.
fn noise_of(problem: &Problem, row: &Row) -> f64 {
    let squared = problem
        .edges_of(row)
        .first()
        .map(|edge| 2.0 * (edge.log_likelihood - row.log_missed) + edge.squared_distance);
    squared
        .filter(|squared| !squared.is_nan())
        .unwrap_or(MOST_NOISE)
        .clamp(LEAST_NOISE, MOST_NOISE)
}

fn by_detection(pairs: &[Pair]) -> impl Iterator<Item = &[Pair]> {
    pairs.chunk_by(|left, right| left.detection == right.detection)
}

#[inline]
fn difference(left: f64, right: f64, is_angle: bool) -> f64 {
    if is_angle {
        wrap(left - right)
    } else {
        left - right
    }
}

/// d².
#[inline]
fn squared_distance(
    measured: &[f64],
    centre: &[f64],
    inverse: &[f64],
    angle: Option<usize>,
) -> f64 {
    let dimensions = measured.len();
    let difference = |axis: usize| difference(measured[axis], centre[axis], angle == Some(axis));
    let mut sum = 0.0;
    for row in 0..dimensions {
        let first = difference(row);
        sum += inverse[row * dimensions + row] * first * first;
        for column in row + 1..dimensions {
            sum += 2.0 * inverse[row * dimensions + column] * first * difference(column);
        }
    }
    if sum > ON_CENTRE { sum } else { 0.0 }
}
