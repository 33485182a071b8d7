//! One cluster in compact form: tracks and detections numbered from 0, each edge with the ratio of its weight to that
//! of "no detection", and the marginals that a method finds. All memory is reused from cluster to cluster.

use crate::association::local_numbers::LocalNumbers;
use crate::association::problem::{Problem, Weights};

/// Nodes of one side with the edges at each.
#[derive(Debug, Clone, Default)]
pub(super) struct Nodes {
    /// End of each node's part of `incident`.
    ends: Vec<u32>,
    /// Edges, grouped by node.
    incident: Vec<u32>,
}

impl Nodes {
    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    /// The edges at a node.
    #[inline]
    pub(super) fn edges_of(&self, node: usize) -> &[u32] {
        let start = if node == 0 { 0 } else { self.ends[node - 1] };
        &self.incident[start as usize..self.ends[node] as usize]
    }
}

/// One side as the one whose elements are taken in turn, the other as the one whose nodes get used.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sides<'a> {
    pub(super) elements: &'a Nodes,
    pub(super) others: &'a Nodes,
    /// The other end of each edge.
    pub(super) other_of: &'a [u32],
    /// This end of each edge.
    pub(super) element_of: &'a [u32],
}

impl Sides<'_> {
    /// How many of an element's nodes others want, too.
    pub(super) fn shared_nodes(&self, element: usize) -> usize {
        let is_shared = |&&edge: &&u32| {
            self.others
                .edges_of(self.other_of[edge as usize] as usize)
                .len()
                > 1
        };
        self.elements
            .edges_of(element)
            .iter()
            .filter(is_shared)
            .count()
    }
}

/// Which side is taken in turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Turn {
    Tracks,
    Detections,
}

#[derive(Debug, Clone, Default)]
pub(super) struct Cluster {
    pub(super) tracks: Nodes,
    pub(super) detections: Nodes,
    track_of: Vec<u32>,
    detection_of: Vec<u32>,
    /// ln of (weight of the edge ÷ weight of the track's "none").
    pub(super) log_ratio: Vec<f64>,
    /// Answer: β of each edge.
    pub(super) beta: Vec<f64>,
    /// Answer: β₀ of each track.
    pub(super) missed: Vec<f64>,
    numbers: LocalNumbers,
}

/// Logarithms of ratios beyond this are as good as certain; the limit keeps infinities out.
const MAX_LOG_RATIO: f64 = 1e9;

/// Sums and products of weights whose logarithms stay within this are computed in `f64`, whose own limit is about 708.
const NARROW_LOG_RANGE: f64 = 600.0;

impl Cluster {
    /// Copies a cluster of the problem.
    pub(super) fn load(&mut self, problem: &Problem) {
        self.clear();
        for (index, (_, row)) in problem.rows().enumerate() {
            for edge in row.edges().map(|edge| problem.edge(edge)) {
                let detection = self.numbers.number_of(edge.detection);
                self.track_of.push(index as u32);
                self.detection_of.push(detection);
                self.log_ratio.push(
                    (edge.log_likelihood - row.log_missed).clamp(-MAX_LOG_RATIO, MAX_LOG_RATIO),
                );
            }
            self.tracks.ends.push(self.track_of.len() as u32);
        }
        let edges = self.track_of.len();
        self.tracks.incident.extend(0..edges as u32);
        self.beta.resize(edges, 0.0);
        self.missed.resize(self.tracks.len(), 0.0);
        self.group_by_detection();
    }

    fn clear(&mut self) {
        self.numbers.clear();
        for list in [
            &mut self.tracks.ends,
            &mut self.tracks.incident,
            &mut self.track_of,
            &mut self.detection_of,
        ] {
            list.clear();
        }
        for list in [&mut self.log_ratio, &mut self.beta, &mut self.missed] {
            list.clear();
        }
    }

    /// Counting sort of the edges by detection.
    fn group_by_detection(&mut self) {
        let Nodes { ends, incident } = &mut self.detections;
        ends.clear();
        ends.resize(self.numbers.len(), 0);
        for &detection in &self.detection_of {
            ends[detection as usize] += 1;
        }
        let mut total = 0;
        for end in ends.iter_mut() {
            let size = *end;
            *end = total;
            total += size;
        }
        incident.clear();
        incident.resize(total as usize, 0);
        for (edge, &detection) in self.detection_of.iter().enumerate() {
            let end = &mut ends[detection as usize];
            incident[*end as usize] = edge as u32;
            *end += 1;
        }
    }

    pub(super) fn sides(&self, turn: Turn) -> Sides<'_> {
        let (tracks, detections) = (
            (&self.tracks, &self.track_of[..]),
            (&self.detections, &self.detection_of[..]),
        );
        let ((elements, element_of), (others, other_of)) = match turn {
            Turn::Tracks => (tracks, detections),
            Turn::Detections => (detections, tracks),
        };
        Sides {
            elements,
            others,
            other_of,
            element_of,
        }
    }

    #[inline]
    pub(super) fn detection_of(&self, edge: u32) -> usize {
        self.detection_of[edge as usize] as usize
    }

    /// Tracks and detections together, numbered in this order.
    pub(super) fn vertices(&self) -> usize {
        self.tracks.len() + self.detections.len()
    }

    /// The edges at a track or a detection, by its number among [`Cluster::vertices`].
    #[inline]
    pub(super) fn edges_at(&self, vertex: u32) -> &[u32] {
        match (vertex as usize).checked_sub(self.tracks.len()) {
            None => self.tracks.edges_of(vertex as usize),
            Some(detection) => self.detections.edges_of(detection),
        }
    }

    /// Track and detection of an edge, by their numbers among [`Cluster::vertices`].
    #[inline]
    pub(super) fn ends_of(&self, edge: u32) -> [u32; 2] {
        let edge = edge as usize;
        [
            self.track_of[edge],
            self.tracks.len() as u32 + self.detection_of[edge],
        ]
    }

    /// Whether no product of one weight a track, nor any sum of such products, can leave the range of `f64`.
    pub(super) fn is_narrow(&self) -> bool {
        let mut range = 0.0;
        for track in 0..self.tracks.len() {
            let edges = self.tracks.edges_of(track);
            let ratios = || edges.iter().map(|&edge| self.log_ratio[edge as usize]);
            range += ratios().fold(0.0, f64::max) - ratios().fold(0.0, f64::min);
            // 1 + the number of edges is below two to the power of its bits.
            range += f64::from(u32::BITS - edges.len().leading_zeros().min(u32::BITS)).max(1.0)
                * std::f64::consts::LN_2;
        }
        range < NARROW_LOG_RANGE
    }

    /// Upper bound of the number of joint events: every track free to choose.
    pub(super) fn most_events(&self) -> f64 {
        (0..self.tracks.len())
            .map(|track| 1.0 + self.tracks.edges_of(track).len() as f64)
            .product()
    }

    /// β₀ of every track as what its edges leave.
    pub(super) fn leave_missed(&mut self) {
        for track in 0..self.tracks.len() {
            let given: f64 = self
                .tracks
                .edges_of(track)
                .iter()
                .map(|&edge| self.beta[edge as usize])
                .sum();
            self.missed[track] = (1.0 - given).max(0.0);
        }
    }

    /// Writes the marginals, each track's scaled to sum to 1, to the weights of the scan.
    pub(super) fn store(&self, problem: &Problem, weights: &mut Weights) {
        for (track, (index, row)) in problem.rows().enumerate() {
            let beta = self
                .tracks
                .edges_of(track)
                .iter()
                .map(|&edge| self.beta[edge as usize]);
            let total = self.missed[track] + beta.clone().sum::<f64>();
            for (edge, beta) in row.edges().zip(beta) {
                weights.edges[edge] = beta / total;
            }
            weights.missed[index] = self.missed[track] / total;
        }
    }
}
