//! A uniform grid over the measurements of one scan: finds those inside a rectangle without looking at all of them.
//! It covers the first two coordinates of the measurement space (the only one, for bearings), of which one may be an
//! angle from −π to π that goes round. About two detections a cell; memory is reused from scan to scan.

use nalgebra::SVector;
use std::f64::consts::{PI, TAU};
use std::ops::{Range, RangeInclusive};

/// The grid of one scan.
#[derive(Debug, Clone, Default)]
pub struct Grid {
    axes: Axes,
    /// Detections of cell c: `order[first[c]..first[c + 1]]`.
    first: Vec<u32>,
    order: Vec<u32>,
    cell_of: Vec<u32>,
}

/// Columns and rows.
type Part = [RangeInclusive<usize>; 2];

/// Where the cells lie.
#[derive(Debug, Clone, Copy, Default)]
struct Axes {
    low: [f64; 2],
    cells_per_unit: [f64; 2],
    cells: [usize; 2],
}

impl Grid {
    /// Writes the measurements of [`Grid::rebuild`] in the order of the cells, one after the other: those that a gate looks at
    /// are neighbours in memory, too.
    pub fn arrange<const D: usize>(&self, measurements: &[[f64; D]], placed: &mut Vec<f64>) {
        placed.clear();
        for &detection in &self.order {
            placed.extend_from_slice(&measurements[detection as usize]);
        }
    }

    /// Takes the measurements of a new scan.
    pub fn rebuild<const D: usize>(&mut self, measurements: &[[f64; D]]) {
        let (low, high) = bounds(measurements);
        let cells = measurements.len() as f64 / 2.0;
        let side = (if D == 1 { cells } else { cells.sqrt() }.ceil() as usize).clamp(1, 4096);
        let cells = [side, if D == 1 { 1 } else { side }];
        let per_unit = |extent: f64| {
            if extent > 0.0 {
                side as f64 / extent
            } else {
                0.0
            }
        };
        self.axes = Axes {
            low,
            cells_per_unit: [per_unit(high[0] - low[0]), per_unit(high[1] - low[1])],
            cells,
        };
        self.sort_into_cells(measurements);
    }

    /// Counting sort of the detections by cell; inside a cell they keep their order.
    fn sort_into_cells<const D: usize>(&mut self, measurements: &[[f64; D]]) {
        let axes = self.axes;
        self.cell_of.clear();
        self.cell_of.extend(
            measurements
                .iter()
                .map(|measurement| axes.cell(plane(measurement))),
        );
        self.first.clear();
        self.first.resize(axes.cells[0] * axes.cells[1] + 1, 0);
        for &cell in &self.cell_of {
            self.first[cell as usize] += 1;
        }
        let mut total = 0;
        for end in &mut self.first {
            total += *end;
            *end = total;
        }
        self.order.clear();
        self.order.resize(measurements.len(), 0);
        // Filling backwards moves each cell's end to its start.
        for (detection, &cell) in self.cell_of.iter().enumerate().rev() {
            let place = &mut self.first[cell as usize];
            *place -= 1;
            self.order[*place as usize] = detection as u32;
        }
    }

    /// Calls `found` once for every detection that may lie within `half` of `centre` on both axes (and some that do not).
    /// `angle` names the axis that goes round, if there is one.
    #[inline]
    pub fn near<const D: usize>(
        &self,
        centre: &SVector<f64, D>,
        half: [f64; 2],
        angle: Option<usize>,
        mut found: impl FnMut(u32),
    ) {
        self.near_places(centre, half, angle, |_, detections| {
            detections.iter().for_each(|&detection| found(detection))
        });
    }

    /// The same, in stretches of the order of the cells: the places in that order, and their detections.
    #[inline]
    pub fn near_places<const D: usize>(
        &self,
        centre: &SVector<f64, D>,
        half: [f64; 2],
        angle: Option<usize>,
        mut found: impl FnMut(Range<usize>, &[u32]),
    ) {
        if self.order.is_empty() {
            return;
        }
        let centre = plane(&centre.data.0[0]);
        let parts = match angle {
            None => [
                Some([
                    self.span(centre[0], half[0], 0),
                    self.span(centre[1], half[1], 1),
                ]),
                None,
            ],
            Some(axis) => self.parts_round(centre, half, axis),
        };
        for [columns, rows] in parts.into_iter().flatten() {
            self.visit(columns, rows, &mut found);
        }
    }

    /// The columns and rows with an axis that goes round.
    #[inline(never)]
    fn parts_round(&self, centre: [f64; 2], half: [f64; 2], axis: usize) -> [Option<Part>; 2] {
        let other = self.span(centre[1 - axis], half[1 - axis], 1 - axis);
        self.spans_round(centre[axis], half[axis], axis)
            .map(|part| {
                let part = part?;
                Some(if axis == 0 {
                    [part, other.clone()]
                } else {
                    [other.clone(), part]
                })
            })
    }

    #[inline(always)]
    fn visit(
        &self,
        columns: RangeInclusive<usize>,
        rows: RangeInclusive<usize>,
        found: &mut impl FnMut(Range<usize>, &[u32]),
    ) {
        for row in rows {
            let from = self.first[row * self.axes.cells[0] + columns.start()] as usize;
            let to = self.first[row * self.axes.cells[0] + columns.end() + 1] as usize;
            found(from..to, &self.order[from..to]);
        }
    }

    /// The cells along one axis that an interval touches.
    #[inline]
    fn span(&self, centre: f64, half: f64, axis: usize) -> RangeInclusive<usize> {
        self.axes.column(centre - half, axis)..=self.axes.column(centre + half, axis)
    }

    /// The same along an angle: an interval that crosses ±π has a second part on the other side. No cell is in both.
    fn spans_round(
        &self,
        centre: f64,
        half: f64,
        axis: usize,
    ) -> [Option<RangeInclusive<usize>>; 2] {
        let last = self.axes.cells[axis] - 1;
        let direct = self.span(centre, half, axis);
        let (start, end) = (*direct.start(), *direct.end());
        if half >= PI {
            [Some(0..=last), None]
        } else if centre - half < -PI {
            let other = self.axes.column(centre - half + TAU, axis);
            if other <= end {
                [Some(0..=last), None]
            } else {
                [Some(direct), Some(other..=last)]
            }
        } else if centre + half > PI {
            let other = self.axes.column(centre + half - TAU, axis);
            if other >= start {
                [Some(0..=last), None]
            } else {
                [Some(direct), Some(0..=other)]
            }
        } else {
            [Some(direct), None]
        }
    }
}

impl Axes {
    #[inline]
    fn cell(&self, [x, y]: [f64; 2]) -> u32 {
        (self.column(x, 0) + self.column(y, 1) * self.cells[0]) as u32
    }

    /// The cell of a coordinate along one axis; places outside the grid belong to its edge.
    #[inline]
    fn column(&self, coordinate: f64, axis: usize) -> usize {
        let cell = (coordinate - self.low[axis]) * self.cells_per_unit[axis];
        (cell.max(0.0) as usize).min(self.cells[axis] - 1)
    }
}

/// The two coordinates that the grid looks at.
#[inline]
fn plane<const D: usize>(measurement: &[f64; D]) -> [f64; 2] {
    [measurement[0], if D > 1 { measurement[1] } else { 0.0 }]
}

fn bounds<const D: usize>(measurements: &[[f64; D]]) -> ([f64; 2], [f64; 2]) {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for measurement in measurements {
        for (axis, value) in plane(measurement).into_iter().enumerate() {
            // No value is NaN, of which `f64::min` would have to think.
            low[axis] = if value < low[axis] { value } else { low[axis] };
            high[axis] = if value > high[axis] {
                value
            } else {
                high[axis]
            };
        }
    }
    (low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::state::Position;
    use proptest::prelude::*;

    fn within(positions: &[Position], centre: &Position, half_m: [f64; 2]) -> Vec<u32> {
        let inside = |position: &Position| {
            (0..2).all(|axis| (position[axis] - centre[axis]).abs() <= half_m[axis])
        };
        (0..positions.len() as u32)
            .filter(|&index| inside(&positions[index as usize]))
            .collect()
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
            let rows: Vec<[f64; 2]> = positions.iter().map(|&position| position.into()).collect();
            grid.rebuild(&rows[..rows.len() / 2]);
            grid.rebuild(&rows);
            let mut found = Vec::new();
            grid.near(&centre, half, None, |detection| found.push(detection));
            found.sort_unstable();
            let distinct = found.windows(2).all(|pair| pair[0] < pair[1]);
            prop_assert!(distinct);
            for detection in within(&positions, &centre, half) {
                prop_assert!(found.contains(&detection));
            }
        }
    }
}
