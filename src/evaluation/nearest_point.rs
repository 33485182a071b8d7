//! The nearest of many points: a balanced k-d tree kept in one list, the median of each part in its middle.

use crate::model::space;

/// A point with the index it stands for; of equally near points the one with the smaller rank is the nearest.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    pub position_m: space::Place,
    pub index: u32,
    pub rank: u32,
}

/// A place and the axis (0 is x, 1 is y, 2 is z) that parts its list: smaller before it, larger behind it.
#[derive(Debug, Clone, Copy)]
struct Node {
    place: Place,
    axis: usize,
}

#[derive(Debug, Default)]
pub struct PlaceTree(Vec<Node>);

/// Squared distance, rank and index of the best place so far; a place replaces it by smaller distance, then rank.
type Best = (f64, u32, Option<u32>);

impl PlaceTree {
    pub fn new(places: Vec<Place>) -> Self {
        let mut nodes: Vec<Node> = places
            .into_iter()
            .map(|place| Node { place, axis: 0 })
            .collect();
        arrange(&mut nodes);
        PlaceTree(nodes)
    }

    pub fn places(&self) -> impl Iterator<Item = &Place> {
        self.0.iter().map(|node| &node.place)
    }

    /// Every place at most `limit_m` away, in no order.
    pub fn for_each_within(
        &self,
        position_m: &space::Place,
        limit_m: f64,
        found: &mut impl FnMut(&Place),
    ) {
        look_within(&self.0, position_m, limit_m, found);
    }

    /// Index of the nearest place at most `limit_m` away.
    pub fn nearest(&self, position_m: &space::Place, limit_m: f64) -> Option<u32> {
        let mut best: Best = (limit_m * limit_m, u32::MAX, None);
        search(&self.0, position_m, &mut best);
        best.2
    }
}

/// Parts along the longest side, so that places on a line are as quickly found as places in a square.
fn arrange(nodes: &mut [Node]) {
    if nodes.len() < 2 {
        return;
    }
    let middle = nodes.len() / 2;
    let (mut axis, mut longest_m) = (0, extent_m(nodes, 0));
    for other in 1..3 {
        let side_m = extent_m(nodes, other);
        if side_m > longest_m {
            (axis, longest_m) = (other, side_m);
        }
    }
    nodes.select_nth_unstable_by(middle, |a, b| {
        a.place.position_m[axis].total_cmp(&b.place.position_m[axis])
    });
    nodes[middle].axis = axis;
    arrange(&mut nodes[..middle]);
    arrange(&mut nodes[middle + 1..]);
}

fn extent_m(nodes: &[Node], axis: usize) -> f64 {
    let values_m = || nodes.iter().map(|node| node.place.position_m[axis]);
    values_m().fold(f64::NEG_INFINITY, f64::max) - values_m().fold(f64::INFINITY, f64::min)
}

fn look_within(
    nodes: &[Node],
    wanted: &space::Place,
    limit_m: f64,
    found: &mut impl FnMut(&Place),
) {
    if nodes.is_empty() {
        return;
    }
    let middle = nodes.len() / 2;
    let Node { place, axis } = &nodes[middle];
    if (place.position_m - wanted).norm() <= limit_m {
        found(place);
    }
    let offset_m = wanted[*axis] - place.position_m[*axis];
    if offset_m <= limit_m {
        look_within(&nodes[..middle], wanted, limit_m, found);
    }
    if -offset_m <= limit_m {
        look_within(&nodes[middle + 1..], wanted, limit_m, found);
    }
}

fn search(nodes: &[Node], wanted: &space::Place, best: &mut Best) {
    if nodes.is_empty() {
        return;
    }
    let middle = nodes.len() / 2;
    let Node { place, axis } = nodes[middle];
    let squared_m2 = (place.position_m - wanted).norm_squared();
    if squared_m2 < best.0 || (squared_m2 == best.0 && place.rank <= best.1) {
        *best = (squared_m2, place.rank, Some(place.index));
    }
    let offset_m = wanted[axis] - place.position_m[axis];
    let (before, behind) = (&nodes[..middle], &nodes[middle + 1..]);
    let (near, far) = if offset_m < 0.0 {
        (before, behind)
    } else {
        (behind, before)
    };
    search(near, wanted, best);
    if offset_m * offset_m <= best.0 {
        search(far, wanted, best);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Whole coordinates make ties common; the naive answer takes the smallest (distance, rank).
        #[test]
        fn finds_what_looking_at_every_point_finds(
            points in prop::collection::vec((0..12i32, 0..12i32, 0..12i32), 0..60), is_flat: bool,
            (x, y, z) in (0..12i32, 0..12i32, 0..12i32), limit in 0..6i32,
        ) {
            let points: Vec<_> = points.into_iter().map(|(x, y, z)| (x, y, if is_flat { 0 } else { z })).collect();
            let z = if is_flat { 0 } else { z };
            let place = |(index, &(x, y, z)): (usize, &(i32, i32, i32))| {
                let position_m = space::Place::new(x.into(), y.into(), z.into());
                Place { position_m, index: index as u32, rank: 1000 - index as u32 }
            };
            let places: Vec<Place> = points.iter().enumerate().map(place).collect();
            let naive = points.iter().enumerate()
                .map(|(index, &(px, py, pz))| {
                    ((px - x).pow(2) + (py - y).pow(2) + (pz - z).pow(2), 1000 - index as u32, index as u32)
                })
                .filter(|&(squared, ..)| squared <= limit * limit)
                .min();
            let wanted = space::Place::new(x.into(), y.into(), z.into());
            let is_within = |place: &&Place| (place.position_m - wanted).norm() <= f64::from(limit);
            let mut within: Vec<u32> = places.iter().filter(is_within).map(|place| place.index).collect();
            let tree = PlaceTree::new(places);
            let mut seen = Vec::new();
            tree.for_each_within(&wanted, f64::from(limit), &mut |place| seen.push(place.index));
            within.sort_unstable();
            seen.sort_unstable();
            prop_assert_eq!(seen, within);
            let found = tree.nearest(&wanted, f64::from(limit));
            prop_assert_eq!(found, naive.map(|(_, _, index)| index));
        }
    }
}
