//! The nearest of many points in the plane: a balanced k-d tree kept in one list, the median of each part in its middle.

use crate::model::state::Position;

/// A point with the index it stands for; of equally near points the one with the smaller rank is the nearest.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    pub position_m: Position,
    pub index: u32,
    pub rank: u32,
}

/// A place and the axis (0 is x, 1 is y) that parts its list: smaller before it, larger behind it.
#[derive(Debug, Clone, Copy)]
struct Node {
    place: Place,
    axis: usize,
}

#[derive(Debug, Default)]
pub struct PlaneTree(Vec<Node>);

/// Squared distance, rank and index of the best place so far; a place replaces it by smaller distance, then rank.
type Best = (f64, u32, Option<u32>);

impl PlaneTree {
    pub fn new(places: Vec<Place>) -> Self {
        let mut nodes: Vec<Node> = places
            .into_iter()
            .map(|place| Node { place, axis: 0 })
            .collect();
        arrange(&mut nodes);
        PlaneTree(nodes)
    }

    /// Index of the nearest place at most `limit_m` away.
    pub fn nearest(&self, position_m: &Position, limit_m: f64) -> Option<u32> {
        let mut best: Best = (limit_m * limit_m, u32::MAX, None);
        search(&self.0, position_m, &mut best);
        best.2
    }
}

/// Parts along the longer side, so that places on a line are as quickly found as places in a square.
fn arrange(nodes: &mut [Node]) {
    if nodes.len() < 2 {
        return;
    }
    let middle = nodes.len() / 2;
    let axis = if extent_m(nodes, 1) > extent_m(nodes, 0) {
        1
    } else {
        0
    };
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

fn search(nodes: &[Node], wanted: &Position, best: &mut Best) {
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
            points in prop::collection::vec((0..12i32, 0..12i32), 0..60), x in 0..12i32, y in 0..12i32, limit in 0..6i32,
        ) {
            let place = |(index, &(x, y)): (usize, &(i32, i32))| {
                Place { position_m: Position::new(f64::from(x), f64::from(y)), index: index as u32, rank: 1000 - index as u32 }
            };
            let places: Vec<Place> = points.iter().enumerate().map(place).collect();
            let naive = points.iter().enumerate()
                .map(|(index, &(px, py))| ((px - x).pow(2) + (py - y).pow(2), 1000 - index as u32, index as u32))
                .filter(|&(squared, ..)| squared <= limit * limit)
                .min();
            let found = PlaneTree::new(places).nearest(&Position::new(f64::from(x), f64::from(y)), f64::from(limit));
            prop_assert_eq!(found, naive.map(|(_, _, index)| index));
        }
    }
}
