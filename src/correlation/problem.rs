//! What each tuple of tracks of different sensors costs. Tracks are numbered through all sensors; those of one sensor stand
//! together. A tuple has at most one track of each sensor; a track alone costs 0, so a tuple of negative cost is worth it.
//!
//! Only pairs that may be of one target are linked. A tuple exists only where its links do (see [`Costs`]); the others are
//! never thought of, and tracks without a path of links between them are problems of their own.

use super::evidence::Evidence;
use std::ops::Range;

/// Another sensor's track that may be of the same target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    pub track: u32,
    /// What the two alone cost as a tuple.
    pub cost: f64,
}

/// How the cost of a tuple comes from its members.
pub enum Costs {
    /// The sum over the links of neighbours in order of sensor; a sensor without a track in the tuple is skipped. Only
    /// neighbours need a link.
    Chain,
    /// The sum over the links of all pairs; all need one.
    AllPairs,
    /// Something of the whole tuple; all pairs need a link.
    Joint(Box<dyn JointCost>),
}

/// The cost of a tuple that is no sum over pairs.
pub trait JointCost: Send + Sync {
    /// Of two members or more, ascending.
    fn cost(&self, tuple: &[u32]) -> f64;
}

pub struct CorrelationProblem {
    /// Where the tracks of each sensor begin, and the number of all tracks.
    bounds: Vec<u32>,
    /// For each track the linked tracks of all other sensors, ascending.
    links: Vec<Vec<Link>>,
    pub costs: Costs,
    evidence: Option<Evidence>,
    independent: Option<Box<CorrelationProblem>>,
}

impl CorrelationProblem {
    /// From the number of tracks of each sensor and the links, each pair once, `(a, b, cost)` with a < b.
    pub fn new(tracks_of: &[usize], pairs: &[(u32, u32, f64)], costs: Costs) -> Self {
        let mut bounds = vec![0];
        for &count in tracks_of {
            bounds.push(bounds[bounds.len() - 1] + count as u32);
        }
        let mut links = vec![Vec::new(); bounds[tracks_of.len()] as usize];
        for &(a, b, cost) in pairs {
            links[a as usize].push(Link { track: b, cost });
            links[b as usize].push(Link { track: a, cost });
        }
        for of_track in &mut links {
            of_track.sort_unstable_by_key(|link| link.track);
        }
        CorrelationProblem {
            bounds,
            links,
            costs,
            evidence: None,
            independent: None,
        }
    }

    /// With what the tracks say.
    pub fn with_evidence(self, evidence: Evidence) -> Self {
        CorrelationProblem {
            evidence: Some(evidence),
            ..self
        }
    }

    /// With the same problem as it looks when errors are taken to be independent.
    pub fn with_independent(self, independent: CorrelationProblem) -> Self {
        CorrelationProblem {
            independent: Some(Box::new(independent)),
            ..self
        }
    }

    /// What the tracks say, for correlators that look at more than costs.
    pub fn evidence(&self) -> Option<&Evidence> {
        self.evidence.as_ref()
    }

    /// The same problem as it looks when errors are taken to be independent, where the costs take them to be correlated.
    pub fn independent(&self) -> Option<&CorrelationProblem> {
        self.independent.as_deref()
    }

    pub fn sensors(&self) -> usize {
        self.bounds.len() - 1
    }

    pub fn tracks(&self) -> usize {
        self.links.len()
    }

    /// The tracks of one sensor.
    pub fn of_sensor(&self, sensor: usize) -> Range<u32> {
        self.bounds[sensor]..self.bounds[sensor + 1]
    }

    pub fn sensor_of(&self, track: u32) -> usize {
        self.bounds.partition_point(|&bound| bound <= track) - 1
    }

    /// What may be of the same target as this track, ascending.
    pub fn links(&self, track: u32) -> &[Link] {
        &self.links[track as usize]
    }

    /// The cost of the two as a tuple, where they are linked.
    pub fn link(&self, a: u32, b: u32) -> Option<f64> {
        let links = self.links(a);
        links
            .binary_search_by_key(&b, |link| link.track)
            .ok()
            .map(|place| links[place].cost)
    }

    /// The cost of a tuple, members ascending; `None` where a link is missing that it needs.
    pub fn cost(&self, tuple: &[u32]) -> Option<f64> {
        let pairs = |a: usize| match self.costs {
            Costs::Chain => a + 1..tuple.len().min(a + 2),
            Costs::AllPairs | Costs::Joint(_) => a + 1..tuple.len(),
        };
        let mut sum = 0.0;
        for a in 0..tuple.len() {
            for b in pairs(a) {
                sum += self.link(tuple[a], tuple[b])?;
            }
        }
        match &self.costs {
            Costs::Joint(joint) if tuple.len() > 1 => Some(joint.cost(tuple)),
            _ => Some(sum),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_needs_neighbours_and_all_pairs_need_all() {
        let pairs = [(0, 1, -3.0), (1, 2, -2.0), (0, 2, 4.0)];
        let chain = CorrelationProblem::new(&[1, 1, 1], &pairs, Costs::Chain);
        assert_eq!(chain.cost(&[0, 1, 2]), Some(-5.0));
        assert_eq!(chain.cost(&[0, 2]), Some(4.0));
        assert_eq!(chain.cost(&[1]), Some(0.0));
        let all = CorrelationProblem::new(&[1, 1, 1], &pairs, Costs::AllPairs);
        assert_eq!(all.cost(&[0, 1, 2]), Some(-1.0));
        let open = CorrelationProblem::new(&[1, 1, 1], &pairs[..2], Costs::AllPairs);
        assert_eq!(open.cost(&[0, 1, 2]), None);
        assert_eq!(
            (all.sensor_of(1), all.of_sensor(2), all.link(2, 0)),
            (1, 2..3, Some(4.0))
        );
    }

    #[test]
    fn a_sensor_may_have_no_tracks() {
        let problem = CorrelationProblem::new(&[1, 0, 2], &[(0, 2, -1.0)], Costs::Chain);
        assert_eq!(
            (
                problem.sensor_of(0),
                problem.sensor_of(1),
                problem.of_sensor(1)
            ),
            (0, 2, 1..1)
        );
    }
}
