//! A uniform grid over the detections of one scan: finds those inside a rectangle without looking at all of them.
//! About two detections a cell; memory is reused from scan to scan.

use crate::model::state::Position;

/// The grid of one scan's positions.
#[derive(Debug, Default)]
pub struct Grid {
    low: [f64; 2],
    cells_per_m: [f64; 2],
    cells: [usize; 2],
    /// Detections of cell c: `order[first[c]..first[c + 1]]`.
    first: Vec<u32>,
    order: Vec<u32>,
    cell_of: Vec<u32>,
}

impl Grid {
    /// Takes the positions of a new scan.
    pub fn rebuild(&mut self, positions: &[Position]) {
        let (low, high) = bounds(positions);
        let side = ((positions.len() as f64 / 2.0).sqrt().ceil() as usize).clamp(1, 4096);
        self.low = low;
        self.cells = [side, side];
        for axis in 0..2 {
            let extent_m = high[axis] - low[axis];
            self.cells_per_m[axis] = if extent_m > 0.0 { side as f64 / extent_m } else { 0.0 };
        }
        self.sort_into_cells(positions);
    }

    /// Counting sort of the detections by cell; inside a cell they keep their order.
    fn sort_into_cells(&mut self, positions: &[Position]) {
        self.cell_of.clear();
        self.first.clear();
        self.first.resize(self.cells[0] * self.cells[1] + 1, 0);
        for position in positions {
            let cell = self.column(position[0], 0) + self.column(position[1], 1) * self.cells[0];
            self.cell_of.push(cell as u32);
            self.first[cell + 1] += 1;
        }
        for cell in 1..self.first.len() {
            self.first[cell] += self.first[cell - 1];
        }
        self.order.clear();
        self.order.resize(positions.len(), 0);
        // Filling backwards moves each cell's end to its start.
        for cell in (1..self.first.len()).rev() {
            self.first[cell] = self.first[cell - 1];
        }
        for (detection, &cell) in self.cell_of.iter().enumerate() {
            let place = &mut self.first[cell as usize + 1];
            self.order[*place as usize] = detection as u32;
            *place += 1;
        }
    }

    /// Calls `found` for every detection that may lie within `half_m` of `centre` on both axes (and some that do not).
    #[inline]
    pub fn near(&self, centre: &Position, half_m: [f64; 2], mut found: impl FnMut(u32)) {
        if self.order.is_empty() {
            return;
        }
        let left = self.column(centre[0] - half_m[0], 0);
        let right = self.column(centre[0] + half_m[0], 0);
        let bottom = self.column(centre[1] - half_m[1], 1);
        let top = self.column(centre[1] + half_m[1], 1);
        for row in bottom..=top {
            let from = self.first[row * self.cells[0] + left];
            let to = self.first[row * self.cells[0] + right + 1];
            for &detection in &self.order[from as usize..to as usize] {
                found(detection);
            }
        }
    }

    /// The cell of a coordinate along one axis; places outside the grid belong to its edge.
    #[inline]
    fn column(&self, coordinate_m: f64, axis: usize) -> usize {
        let cell = (coordinate_m - self.low[axis]) * self.cells_per_m[axis];
        (cell.max(0.0) as usize).min(self.cells[axis] - 1)
    }
}

fn bounds(positions: &[Position]) -> ([f64; 2], [f64; 2]) {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for position in positions {
        for axis in 0..2 {
            low[axis] = low[axis].min(position[axis]);
            high[axis] = high[axis].max(position[axis]);
        }
    }
    (low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn within(positions: &[Position], centre: &Position, half_m: [f64; 2]) -> Vec<u32> {
        let inside = |position: &Position| (0..2).all(|axis| (position[axis] - centre[axis]).abs() <= half_m[axis]);
        (0..positions.len() as u32).filter(|&index| inside(&positions[index as usize])).collect()
    }

    proptest! {
        #[test]
        fn every_detection_inside_the_rectangle_is_found(
            places in prop::collection::vec((-50.0..50.0f64, -5.0..5.0f64), 0..60),
            centre in (-60.0..60.0f64, -60.0..60.0f64),
            half in (0.0..40.0f64, 0.0..40.0f64),
        ) {
            let positions: Vec<Position> = places.iter().map(|&(x, y)| Position::new(x, y)).collect();
            let centre = Position::new(centre.0, centre.1);
            let half = [half.0, half.1];
            let mut grid = Grid::default();
            grid.rebuild(&positions[..positions.len() / 2]);
            grid.rebuild(&positions);
            let mut found = Vec::new();
            grid.near(&centre, half, |detection| found.push(detection));
            found.sort_unstable();
            let distinct = found.windows(2).all(|pair| pair[0] < pair[1]);
            prop_assert!(distinct);
            for detection in within(&positions, &centre, half) {
                prop_assert!(found.contains(&detection));
            }
        }
    }
}
