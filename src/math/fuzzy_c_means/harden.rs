//! From memberships to groups: each object goes to one cluster, or, where a source (a sensor) reports each target once,
//! no two objects of a source to the same.
//!
//! # Method
//! - [`largest`]: the cluster of the largest membership; of equal ones the first.
//! - [`BySource`]: for each source by itself the assignment of its objects to different clusters at the least total cost
//!   ([`crate::math::assignment`]): −u for the largest total membership, or d². A source with more objects than there are
//!   clusters leaves some in none.

use crate::math::assignment::AssignmentSolver;

/// For each object its cluster. `memberships` has u_ik at `k * c + i`.
pub fn largest(memberships: &[f64], clusters: usize, labels: &mut Vec<usize>) {
    labels.clear();
    labels.extend(memberships.chunks_exact(clusters).map(first_largest));
}

fn first_largest(memberships: &[f64]) -> usize {
    let mut best = 0;
    for (cluster, membership) in memberships.iter().enumerate() {
        if *membership > memberships[best] {
            best = cluster;
        }
    }
    best
}

/// Hardens with at most one object of a source in a cluster; memory is reused.
#[derive(Debug, Default)]
pub struct BySource {
    solver: AssignmentSolver,
    /// Objects in the order of their sources.
    order: Vec<usize>,
}

impl BySource {
    /// For each object its cluster, if there was one left. `sources` names the source of each object; `cost` is that of an
    /// object in a cluster, a finite number.
    pub fn harden(
        &mut self,
        clusters: usize,
        sources: &[u32],
        cost: impl Fn(usize, usize) -> f64,
        labels: &mut Vec<Option<usize>>,
    ) {
        labels.clear();
        labels.resize(sources.len(), None);
        self.order.clear();
        self.order.extend(0..sources.len());
        self.order.sort_by_key(|&object| sources[object]);
        for members in self
            .order
            .chunk_by(|&left, &right| sources[left] == sources[right])
        {
            assign(&mut self.solver, members, clusters, &cost, labels);
        }
    }
}

/// The objects of one source. Rows of the assignment are what there is less of, so that all of them can be served.
fn assign(
    solver: &mut AssignmentSolver,
    members: &[usize],
    clusters: usize,
    cost: &impl Fn(usize, usize) -> f64,
    labels: &mut [Option<usize>],
) {
    let rows_are_objects = members.len() <= clusters;
    let (rows, columns) = if rows_are_objects {
        (members.len(), clusters)
    } else {
        (clusters, members.len())
    };
    solver.clear();
    for row in 0..rows {
        for column in 0..columns {
            let (object, cluster) = if rows_are_objects {
                (row, column)
            } else {
                (column, row)
            };
            solver.push_edge(column as u32, cost(members[object], cluster));
        }
        solver.end_row(f64::INFINITY);
    }
    if solver.solve().is_none() {
        return;
    }
    for row in 0..rows {
        let column = solver.edge_of(row);
        let (object, cluster) = if rows_are_objects {
            (Some(row), column)
        } else {
            (column, Some(row))
        };
        if let Some(object) = object {
            labels[members[object]] = cluster;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_membership_wins_and_the_first_of_equals() {
        let mut labels = Vec::new();
        largest(&[0.2, 0.5, 0.3, 0.4, 0.2, 0.4], 3, &mut labels);
        assert_eq!(labels, [1, 0]);
    }

    #[test]
    fn a_source_has_one_object_a_cluster() {
        // Objects 0 and 2 of source 7 both prefer cluster 0: 0.9 + 0.4 beats 0.1 + 0.6. Object 1 of source 3 is free.
        let memberships = [0.9, 0.1, 0.8, 0.2, 0.6, 0.4];
        let mut labels = Vec::new();
        BySource::default().harden(
            2,
            &[7, 3, 7],
            |object, cluster| -memberships[object * 2 + cluster],
            &mut labels,
        );
        assert_eq!(labels, [Some(0), Some(0), Some(1)]);
    }

    #[test]
    fn a_source_with_more_objects_than_clusters_leaves_the_dearest_out() {
        // d²: all of (0 → 0, 2 → 1) cost 1 + 2; any with object 1 costs more.
        let squared = [1.0, 9.0, 8.0, 7.0, 5.0, 2.0];
        let mut labels = Vec::new();
        BySource::default().harden(
            2,
            &[0, 0, 0],
            |object, cluster| squared[object * 2 + cluster],
            &mut labels,
        );
        assert_eq!(labels, [Some(0), None, Some(1)]);
    }
}
