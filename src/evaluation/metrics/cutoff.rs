//! What the distances of sets share: a cutoff c, an order p, and the best assignment of truths to tracks under them.
//!
//! # Symbols
//! d distance of a pair, c cutoff, p order; a *share* is (d / c)ᵖ, at most 1, so that no power overflows.
//!
//! # Method
//! A pair at c or beyond costs as much as two strangers. So among the pairs with d < c those matter whose (d / c)ᵖ − 1 is
//! gained, and an assignment of least cost over them, anyone free to stay alone at 0, is a best one over all pairs.

use super::Sequence;
use crate::evaluation::comparison::{ComparedStep, Comparison, Pair};
use crate::math::assignment::AssignmentSolver;
use crate::model::space::Space;
use crate::registry::{Field, Kind, default, number};
use serde::Deserialize;

/// Distances of targets, from a millimetre to ten thousand kilometres: no power of them overflows.
pub const METRES: Kind = number(1e-3, 1e7, "m");

pub const CUTOFF_M: Field = default(
    "cutoff_m",
    "The distance c at which a track is as bad as none.",
    METRES,
    "100.0",
);

pub const ORDER: Field = default(
    "p",
    "The order: the larger, the more one large error counts against many small ones.",
    number(1.0, 10.0, ""),
    "2.0",
);

pub const CUTOFF_DEG: Field = default(
    "cutoff_deg",
    "The same of directions.",
    number(1e-6, 180.0, "°"),
    "10.0",
);

/// c of places in metres; of directions the same field holds degrees.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Cutoff {
    pub cutoff_m: f64,
    pub p: f64,
}

/// c of places and of directions, and the order of both.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Cutoffs {
    pub cutoff_m: f64,
    pub cutoff_deg: f64,
    pub p: f64,
}

/// What distances are measured in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    pub cutoff: Cutoff,
    /// The parameter that holds c.
    pub parameter: &'static str,
    pub name: &'static str,
    pub power: &'static str,
}

impl Cutoffs {
    /// Those of the first sequence; all are of one space.
    pub fn unit(self, sequences: &[Sequence]) -> Unit {
        let space = sequences.first().and_then(|first| first.comparison.space);
        let (c, parameter, name, power) = match space {
            Some(Space::Bearing) => (self.cutoff_deg, "cutoff_deg", "deg", "deg^p"),
            _ => (self.cutoff_m, "cutoff_m", "m", "m^p"),
        };
        let cutoff = Cutoff {
            cutoff_m: c,
            p: self.p,
        };
        Unit {
            cutoff,
            parameter,
            name,
            power,
        }
    }
}

impl Cutoff {
    /// (d / c)ᵖ of a distance or penalty.
    pub fn share_of(self, distance_m: f64) -> f64 {
        let ratio = distance_m / self.cutoff_m;
        if self.p == 2.0 {
            ratio * ratio
        } else {
            ratio.powf(self.p)
        }
    }

    /// The distance of which this is the share, or the sum of shares.
    pub fn metres(self, share: f64) -> f64 {
        self.cutoff_m
            * if self.p == 2.0 {
                share.max(0.0).sqrt()
            } else {
                share.max(0.0).powf(1.0 / self.p)
            }
    }

    /// A sum of shares as a sum of p-th powers of metres.
    pub fn powers(self, share: f64) -> f64 {
        share * self.cutoff_m.powf(self.p)
    }
}

/// Assigns step after step; all memory is reused.
#[derive(Default)]
pub struct Matcher {
    solver: AssignmentSolver,
    /// Of each row that has edges: where its pairs begin among those of the step.
    first_of_row: Vec<usize>,
}

impl Matcher {
    /// Calls back with each pair of a best assignment of a step and its share.
    pub fn assign(
        &mut self,
        comparison: &Comparison,
        step: &ComparedStep,
        cutoff: Cutoff,
        matched: impl FnMut(&Pair, f64),
    ) {
        self.assign_by(
            comparison,
            step,
            |pair| {
                if pair.distance < cutoff.cutoff_m {
                    cutoff.share_of(pair.distance)
                } else {
                    1.0
                }
            },
            matched,
        );
    }

    /// The same with shares of one's own; a pair with a share of 1 or more is no better than two strangers.
    pub fn assign_by(
        &mut self,
        comparison: &Comparison,
        step: &ComparedStep,
        share: impl Fn(&Pair) -> f64,
        mut matched: impl FnMut(&Pair, f64),
    ) {
        let pairs = &comparison.pairs[step.pairs.clone()];
        self.solver.clear();
        self.first_of_row.clear();
        let mut first = 0;
        for row in pairs.chunk_by(|left, right| left.truth == right.truth) {
            for pair in row {
                let share = share(pair);
                let gain = if share < 1.0 { share - 1.0 } else { f64::NAN };
                self.solver
                    .push_edge(pair.track - step.tracks.start as u32, gain);
            }
            self.solver.end_row(0.0);
            self.first_of_row.push(first);
            first += row.len();
        }
        let is_solved = self.solver.solve().is_some();
        debug_assert!(
            is_solved,
            "an assignment in which everyone may stay alone exists"
        );
        for (row, first) in self.first_of_row.iter().enumerate() {
            if let Some(edge) = self.solver.edge_of(row) {
                let pair = &pairs[first + edge];
                matched(pair, share(pair));
            }
        }
    }
}
