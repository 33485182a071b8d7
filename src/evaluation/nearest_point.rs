//! The nearest of many points in the plane: a balanced k-d tree kept in one list, the median of each part in its middle.

use crate::model::state::Position;

/// A point with the index it stands for; of equally near points the one with the smaller rank is the nearest.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    pub position_m: Position,
    pub index: u32,
    pub rank: u32,
}

#[derive(Debug, Default)]
pub struct PlaneTree(Vec<Place>);

/// Squared distance, rank and index of the best place so far; places must be within the first two to replace it.
type Best = (f64, u32, Option<u32>);

impl PlaneTree {
    pub fn new(mut places: Vec<Place>) -> Self {
        arrange(&mut places, 0);
        PlaneTree(places)
    }

    /// Index of the nearest place at most `limit_m` away.
    pub fn nearest(&self, position_m: &Position, limit_m: f64) -> Option<u32> {
        let mut best: Best = (limit_m * limit_m, u32::MAX, None);
        search(&self.0, 0, position_m, &mut best);
        best.2
    }
}

fn arrange(places: &mut [Place], axis: usize) {
    if places.len() < 2 {
        return;
    }
    let middle = places.len() / 2;
    places.select_nth_unstable_by(middle, |a, b| a.position_m[axis].total_cmp(&b.position_m[axis]));
    arrange(&mut places[..middle], 1 - axis);
    arrange(&mut places[middle + 1..], 1 - axis);
}

fn search(places: &[Place], axis: usize, wanted: &Position, best: &mut Best) {
    if places.is_empty() {
        return;
    }
    let middle = places.len() / 2;
    let place = &places[middle];
    let squared_m2 = (place.position_m - wanted).norm_squared();
    if squared_m2 < best.0 || (squared_m2 == best.0 && place.rank <= best.1) {
        *best = (squared_m2, place.rank, Some(place.index));
    }
    let offset_m = wanted[axis] - place.position_m[axis];
    let (near, far) = if offset_m < 0.0 { (&places[..middle], &places[middle + 1..]) } else { (&places[middle + 1..], &places[..middle]) };
    search(near, 1 - axis, wanted, best);
    if offset_m * offset_m <= best.0 {
        search(far, 1 - axis, wanted, best);
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
