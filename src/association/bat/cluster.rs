//! One cluster as the swarm sees it. What an entry of a bat can be is numbered (a code): the edges of the cluster row by row, then, if all
//! detections of the scan may be drawn, each of them as one outside the gate, last "none". All memory is reused.

use super::cluster_rng::{ClusterRng, scale};
use super::{BatSettings, Candidates, Objective};
use crate::association::local_numbers::LocalNumbers;
use crate::association::problem::{Problem, Weights};

/// What an entry can be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Code {
    /// What it adds to the objective.
    pub(super) gain: f64,
    /// ln of (weight of the edge ÷ weight of the row's "none"); 0 for what is not an edge.
    pub(super) log_ratio: f64,
    /// The edge's part of an assignment's hash; 0 for what is not an edge.
    pub(super) key: u64,
    /// The detection's number in the cluster; none has the number behind the last.
    pub(super) detection: u32,
}

impl Code {
    fn without_edge(detection: u32) -> Code {
        Code {
            gain: 0.0,
            log_ratio: 0.0,
            key: 0,
            detection,
        }
    }
}

/// From a bat to a neighbour: `row` gets `code`; unless that is [`NOBODY`], `other` gets `other_code`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Move {
    pub(super) row: u32,
    pub(super) code: u32,
    pub(super) other: u32,
    pub(super) other_code: u32,
    /// What the objective gains.
    pub(super) delta: f64,
}

#[derive(Debug, Clone, Copy)]
struct Span {
    first: u32,
    count: u32,
}

#[derive(Debug, Clone, Default)]
pub(super) struct Cluster {
    rows: Vec<Span>,
    codes: Vec<Code>,
    edges: u32,
    detections: u32,
    /// Detections that a draw outside the gates chooses among; 0 when candidates are gated.
    drawn_from: u32,
    /// 1 when "none" may be drawn, else 0.
    none_draws: u32,
    numbers: LocalNumbers,
}

/// No row, or no number.
pub(super) const NOBODY: u32 = u32::MAX;

/// Logarithms of ratios beyond this are as good as certain; the limit keeps infinities out.
const MAX_LOG_RATIO: f64 = 1e9;

impl Cluster {
    /// Copies a cluster of the problem.
    pub(super) fn load(&mut self, problem: &Problem, settings: &BatSettings) {
        self.clear();
        let level = |edge: usize| {
            problem
                .edge(edge)
                .log_likelihood
                .clamp(-MAX_LOG_RATIO, MAX_LOG_RATIO)
        };
        let top = problem
            .rows()
            .flat_map(|(_, row)| row.edges())
            .map(level)
            .fold(f64::NEG_INFINITY, f64::max);
        let takes_all = settings.candidates == Candidates::All;
        for (_, row) in problem.rows() {
            self.rows.push(Span {
                first: self.codes.len() as u32,
                count: row.count,
            });
            for edge in row.edges() {
                let log_ratio = (level(edge) - row.log_missed).clamp(-MAX_LOG_RATIO, MAX_LOG_RATIO);
                let gain = match settings.objective {
                    Objective::LikelihoodSum => (level(edge) - top).exp(),
                    Objective::LogLikelihoodRatio => log_ratio,
                };
                let number = problem.edge(edge).detection;
                let detection = if takes_all {
                    number
                } else {
                    self.numbers.number_of(number)
                };
                self.codes.push(Code {
                    gain,
                    log_ratio,
                    key: mix(self.codes.len() as u64),
                    detection,
                });
            }
        }
        self.edges = self.codes.len() as u32;
        self.drawn_from = if takes_all { problem.detections() } else { 0 };
        self.detections = if takes_all {
            problem.detections()
        } else {
            self.numbers.len() as u32
        };
        self.none_draws = u32::from(settings.draws_missed());
        self.codes
            .extend((0..self.drawn_from).map(Code::without_edge));
        self.codes.push(Code::without_edge(self.detections));
    }

    fn clear(&mut self) {
        self.numbers.clear();
        self.rows.clear();
        self.codes.clear();
    }

    pub(super) fn row_count(&self) -> usize {
        self.rows.len()
    }

    /// Detections, without the number that stands for none.
    pub(super) fn detections(&self) -> usize {
        self.detections as usize
    }

    /// Codes below this are edges.
    pub(super) fn edges(&self) -> usize {
        self.edges as usize
    }

    /// The code of "none".
    #[inline]
    pub(super) fn missed(&self) -> u32 {
        self.codes.len() as u32 - 1
    }

    #[inline]
    pub(super) fn code(&self, code: u32) -> &Code {
        &self.codes[code as usize]
    }

    #[inline]
    pub(super) fn codes_of(&self, row: usize) -> std::ops::Range<u32> {
        let Span { first, count } = self.rows[row];
        first..first + count
    }

    /// The code by which a row has a detection: one of its edges, or what stands for "outside its gate".
    #[inline]
    pub(super) fn code_for(&self, row: usize, detection: u32) -> u32 {
        let Span { first, count } = self.rows[row];
        let edges = &self.codes[first as usize..(first + count) as usize];
        match edges.iter().position(|edge| edge.detection == detection) {
            Some(place) => first + place as u32,
            None if self.drawn_from > 0 => self.edges + detection,
            None => self.missed(),
        }
    }

    /// A random position and what is to stand there.
    #[inline]
    pub(super) fn draw(&self, rng: &mut ClusterRng) -> (u32, u32) {
        let (for_row, for_code) = rng.pair();
        let row = scale(for_row, self.rows.len() as u32);
        (row, self.draw_for(row as usize, for_code))
    }

    /// What random bits put at a position.
    #[inline]
    pub(super) fn draw_for(&self, row: usize, bits: u32) -> u32 {
        if self.drawn_from > 0 {
            return self.code_for(row, scale(bits, self.drawn_from + self.none_draws));
        }
        let Span { first, count } = self.rows[row];
        let place = scale(bits, count + self.none_draws);
        if place < count {
            first + place
        } else {
            self.missed()
        }
    }

    /// The objective of an assignment, summed.
    pub(super) fn value_of(&self, entries: &[u32]) -> f64 {
        entries.iter().map(|&code| self.code(code).gain).sum()
    }

    /// What no assignment exceeds: every row has its largest gain. Summed in the order of [`Self::value_of`], so that an
    /// assignment which has them all is worth exactly this.
    pub(super) fn bound(&self) -> f64 {
        // None gains 0, and a likelihood is never below that.
        let largest = |row: usize| {
            self.codes_of(row)
                .map(|code| self.code(code).gain)
                .fold(0.0, f64::max)
        };
        (0..self.rows.len()).map(largest).sum()
    }

    /// The optimum of the first row alone: its first largest gain, none when that is better and may be.
    pub(super) fn best_of_first(&self) -> u32 {
        let least = if self.none_draws == 1 {
            0.0
        } else {
            f64::NEG_INFINITY
        };
        let start = (least, self.missed());
        let better = |best: (f64, u32), code: u32| {
            if self.code(code).gain > best.0 {
                (self.code(code).gain, code)
            } else {
                best
            }
        };
        self.codes_of(0).fold(start, better).1
    }

    /// Gives each row the detection of its entry, where that is in its gate.
    pub(super) fn choose(&self, problem: &Problem, entries: &[u32], weights: &mut Weights) {
        for (((index, row), span), &code) in problem.rows().zip(&self.rows).zip(entries) {
            if code < self.edges {
                weights.choose(index, row.first as usize + (code - span.first) as usize);
            }
        }
    }
}

/// 64 bits that look random and are the same everywhere (the finish of SplitMix64).
fn mix(number: u64) -> u64 {
    let mut bits = number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}
