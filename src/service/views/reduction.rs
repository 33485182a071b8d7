//! Fewer points, honestly: which rows are kept, and a label that says how they were chosen.

use serde::Serialize;
use std::ops::Range;
use utoipa::ToSchema;

/// Points of one answer when the caller does not say.
pub const DEFAULT_MAX_POINTS: usize = 50_000;

/// How the returned points were chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ReductionMethod)]
pub enum Method {
    /// Nothing is left out.
    All,
    /// Every n-th row.
    EveryNth,
    /// The lowest and the highest value of each stretch of rows.
    MinMax,
}

/// The rows that are kept, in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Reduced {
    pub rows: Vec<usize>,
    pub source_points: usize,
    pub method: Method,
}

impl Reduced {
    fn all(count: usize) -> Self {
        Reduced {
            rows: (0..count).collect(),
            source_points: count,
            method: Method::All,
        }
    }

    /// At most `max_points` of `count` rows, evenly spread, the first among them.
    pub fn every_nth(count: usize, max_points: usize) -> Self {
        if count <= max_points {
            return Reduced::all(count);
        }
        let step = count.div_ceil(max_points.max(1));
        Reduced {
            rows: (0..count).step_by(step).collect(),
            source_points: count,
            method: Method::EveryNth,
        }
    }

    /// At most `max_points` of the rows of these columns, of equal length: the first and the last row, and of equal stretches
    /// the rows where a column is least and greatest. NaN is no value. Every n-th row where `max_points` is too small for that.
    pub fn min_max(columns: &[&[f64]], max_points: usize) -> Self {
        let count = columns.first().map_or(0, |column| column.len());
        if count <= max_points {
            return Reduced::all(count);
        }
        let stretches = max_points.saturating_sub(2) / (2 * columns.len().max(1));
        if stretches == 0 {
            return Reduced::every_nth(count, max_points);
        }
        let length = count.div_ceil(stretches);
        let mut rows = vec![0, count - 1];
        for start in (0..count).step_by(length) {
            rows.extend(
                columns
                    .iter()
                    .flat_map(|column| extremes(column, start..(start + length).min(count))),
            );
        }
        rows.sort_unstable();
        rows.dedup();
        Reduced {
            rows,
            source_points: count,
            method: Method::MinMax,
        }
    }

    /// The kept values of a column.
    pub fn column<T>(&self, value: impl Fn(usize) -> T) -> Vec<T> {
        self.rows.iter().map(|&row| value(row)).collect()
    }
}

/// The rows of the least and the greatest value of a stretch; none where it has no value.
fn extremes(values: &[f64], stretch: Range<usize>) -> impl Iterator<Item = usize> {
    let order = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]);
    let known = || stretch.clone().filter(|&row| !values[row].is_nan());
    known()
        .min_by(order)
        .into_iter()
        .chain(known().max_by(order))
}

/// Cells along the longer side of a [`Density`].
const DENSITY_CELLS: f64 = 200.0;

/// How many of all points lie in each square of a grid, for layers of which not every point is returned.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = DensityGrid)]
pub struct Density {
    /// South-west corner of the grid.
    pub x_min_m: f64,
    pub y_min_m: f64,
    /// Side of a cell.
    pub cell_m: f64,
    pub columns: DensityColumns,
    /// Points of the layer that have a place: the sum of all counts.
    pub source_points: usize,
}

/// One row for each cell that is not empty.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct DensityColumns {
    /// Number of the cell eastwards, from 0.
    pub east: Vec<u32>,
    /// Number of the cell northwards, from 0.
    pub north: Vec<u32>,
    pub count: Vec<u32>,
}

impl Density {
    /// `None` where there is no place.
    pub fn of(places_m: &[(f64, f64)]) -> Option<Density> {
        let (x_min_m, width_m) = span(places_m.iter().map(|place| place.0))?;
        let (y_min_m, height_m) = span(places_m.iter().map(|place| place.1))?;
        let cell_m = if width_m.max(height_m) > 0.0 {
            width_m.max(height_m) / DENSITY_CELLS
        } else {
            1.0
        };
        // The longer side has so many cells, whatever its quotient is rounded to.
        let cells = |length_m: f64| (length_m / cell_m).ceil().clamp(1.0, DENSITY_CELLS) as usize;
        let (east, north) = (cells(width_m), cells(height_m));
        let mut counts = vec![0; east * north];
        for (x_m, y_m) in places_m {
            let column = (((x_m - x_min_m) / cell_m) as usize).min(east - 1);
            let row = (((y_m - y_min_m) / cell_m) as usize).min(north - 1);
            counts[row * east + column] += 1;
        }
        let mut columns = DensityColumns::default();
        for (index, count) in counts
            .into_iter()
            .enumerate()
            .filter(|(_, count)| *count > 0)
        {
            columns.east.push((index % east) as u32);
            columns.north.push((index / east) as u32);
            columns.count.push(count);
        }
        Some(Density {
            x_min_m,
            y_min_m,
            cell_m,
            columns,
            source_points: places_m.len(),
        })
    }
}

/// The least of some values, and how far they reach.
fn span(values: impl Iterator<Item = f64> + Clone) -> Option<(f64, f64)> {
    let low = values.clone().reduce(f64::min)?;
    Some((low, values.fold(low, f64::max) - low))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn few_points_stay_as_they_are() {
        assert_eq!(
            Reduced::every_nth(3, 3),
            Reduced {
                rows: vec![0, 1, 2],
                source_points: 3,
                method: Method::All
            }
        );
        assert_eq!(Reduced::min_max(&[&[1.0, 2.0]], 2).method, Method::All);
    }

    #[test]
    fn every_nth_keeps_no_more_than_asked_for() {
        let reduced = Reduced::every_nth(10, 4);
        assert_eq!(
            reduced,
            Reduced {
                rows: vec![0, 3, 6, 9],
                source_points: 10,
                method: Method::EveryNth
            }
        );
        for (count, max) in [(1001, 10), (99_999, 50_000), (7, 1)] {
            assert!(Reduced::every_nth(count, max).rows.len() <= max);
        }
    }

    #[test]
    fn extremes_of_every_column_need_room() {
        let (rising, falling): (Vec<f64>, Vec<f64>) = (0..100)
            .map(|row| (f64::from(row), -f64::from(row)))
            .unzip();
        let reduced = |max| Reduced::min_max(&[&rising, &falling], max);
        // Two stretches of 50 rows; what one column has least the other has greatest.
        assert_eq!(
            (reduced(10).rows, reduced(10).method),
            (vec![0, 49, 50, 99], Method::MinMax)
        );
        assert_eq!(
            (reduced(5).rows, reduced(5).method),
            (vec![0, 20, 40, 60, 80], Method::EveryNth)
        );
    }

    #[test]
    fn cells_are_squares_and_the_last_ones_hold_the_far_edge() {
        let density =
            Density::of(&[(0.0, 0.0), (400.0, 100.0), (399.0, 99.0), (1.0, 3.0)]).unwrap();
        assert_eq!(
            (
                density.x_min_m,
                density.y_min_m,
                density.cell_m,
                density.source_points
            ),
            (0.0, 0.0, 2.0, 4)
        );
        assert_eq!(
            density.columns,
            DensityColumns {
                east: vec![0, 0, 199],
                north: vec![0, 1, 49],
                count: vec![1, 1, 2]
            }
        );
        assert_eq!(Density::of(&[(5.0, 5.0); 3]).unwrap().columns.count, [3]);
        assert_eq!(Density::of(&[]), None);
    }

    /// Values, some of them missing.
    fn values() -> impl Strategy<Value = Vec<f64>> {
        prop::collection::vec(prop_oneof![9 => -1e6..1e6f64, 1 => Just(f64::NAN)], 1..400)
    }

    #[test]
    fn the_longer_side_has_as_many_cells_as_there_are() {
        let places = [(-45_455.042_219_442_475, 0.0), (90_632.913_386_084_26, 0.0)];
        let density = Density::of(&places).unwrap();
        assert_eq!(density.columns.east, [0, 199]);
    }

    proptest! {
        #[test]
        fn min_max_keeps_the_extremes_of_every_stretch_and_both_ends(values in values(), max_points in 4..120usize) {
            let reduced = Reduced::min_max(&[&values], max_points);
            prop_assert!(reduced.rows.len() <= max_points && reduced.rows.is_sorted_by(|a, b| a < b));
            prop_assert_eq!((reduced.rows[0], reduced.rows[reduced.rows.len() - 1]), (0, values.len() - 1));
            prop_assert_eq!(reduced.source_points, values.len());
            let length = if values.len() <= max_points { 1 } else { values.len().div_ceil((max_points - 2) / 2) };
            for start in (0..values.len()).step_by(length) {
                let stretch = start..(start + length).min(values.len());
                let all = || stretch.clone().map(|row| values[row]);
                let kept = || reduced.rows.iter().filter(|row| stretch.contains(row)).map(|&row| values[row]);
                prop_assert_eq!(all().fold(f64::INFINITY, f64::min), kept().fold(f64::INFINITY, f64::min));
                prop_assert_eq!(all().fold(f64::NEG_INFINITY, f64::max), kept().fold(f64::NEG_INFINITY, f64::max));
            }
        }

        #[test]
        fn every_column_keeps_its_extremes(
            columns in (1..200usize).prop_flat_map(|rows| prop::collection::vec(prop::collection::vec(-1e6..1e6f64, rows), 1..5)),
            max_points in 10..120usize,
        ) {
            let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
            let reduced = Reduced::min_max(&columns, max_points);
            prop_assert!(reduced.rows.len() <= max_points);
            for column in columns {
                let kept = || reduced.rows.iter().map(|&row| column[row]);
                prop_assert_eq!(column.iter().copied().fold(f64::INFINITY, f64::min), kept().fold(f64::INFINITY, f64::min));
                prop_assert_eq!(column.iter().copied().fold(f64::NEG_INFINITY, f64::max), kept().fold(f64::NEG_INFINITY, f64::max));
            }
        }

        #[test]
        fn a_density_counts_every_point_once_where_it_is(places in prop::collection::vec((-1e5..1e5f64, -1e5..1e5f64), 1..500)) {
            let density = Density::of(&places).unwrap();
            let DensityColumns { east, north, count } = &density.columns;
            prop_assert_eq!(count.iter().sum::<u32>() as usize, places.len());
            prop_assert_eq!(density.source_points, places.len());
            for ((east, north), count) in east.iter().zip(north).zip(count) {
                // The edges of a cell, with a little for rounding.
                let inside = |value: f64, low: f64, cell: u32| {
                    let place = (value - low) / density.cell_m - f64::from(cell);
                    (-1e-6..1.0 + 1e-6).contains(&place)
                };
                let near = places.iter().filter(|place| inside(place.0, density.x_min_m, *east) && inside(place.1, density.y_min_m, *north));
                prop_assert!(near.count() >= *count as usize && *count > 0 && *east < 200 && *north < 200);
            }
        }
    }
}
