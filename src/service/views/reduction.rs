//! Fewer points, honestly: which rows are kept, and a label that says how they were chosen.

use serde::Serialize;
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
        Reduced { rows: (0..count).collect(), source_points: count, method: Method::All }
    }

    /// At most `max_points` of `count` rows, evenly spread, the first among them.
    pub fn every_nth(count: usize, max_points: usize) -> Self {
        if count <= max_points {
            return Reduced::all(count);
        }
        let step = count.div_ceil(max_points.max(1));
        Reduced { rows: (0..count).step_by(step).collect(), source_points: count, method: Method::EveryNth }
    }

    /// At most `max_points` of the rows with these values: the extremes of equal stretches.
    pub fn min_max(values: &[f64], max_points: usize) -> Self {
        if values.len() <= max_points {
            return Reduced::all(values.len());
        }
        let length = values.len().div_ceil((max_points / 2).max(1));
        let starts = (0..values.len()).step_by(length);
        let rows = starts.flat_map(|start| extremes(values, start..(start + length).min(values.len()))).collect();
        Reduced { rows, source_points: values.len(), method: Method::MinMax }
    }

    /// The kept values of a column.
    pub fn column<T>(&self, value: impl Fn(usize) -> T) -> Vec<T> {
        self.rows.iter().map(|&row| value(row)).collect()
    }
}

/// The rows of the least and the greatest value of a stretch, in order; one where they are the same.
fn extremes(values: &[f64], stretch: std::ops::Range<usize>) -> Vec<usize> {
    let order = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]);
    let (low, high) = (stretch.clone().min_by(order), stretch.max_by(order));
    let mut rows: Vec<usize> = low.into_iter().chain(high).collect();
    rows.sort_unstable();
    rows.dedup();
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_points_stay_as_they_are() {
        assert_eq!(Reduced::every_nth(3, 3), Reduced { rows: vec![0, 1, 2], source_points: 3, method: Method::All });
        assert_eq!(Reduced::min_max(&[1.0, 2.0], 2).method, Method::All);
    }

    #[test]
    fn every_nth_keeps_no_more_than_asked_for() {
        let reduced = Reduced::every_nth(10, 4);
        assert_eq!(reduced, Reduced { rows: vec![0, 3, 6, 9], source_points: 10, method: Method::EveryNth });
        for (count, max) in [(1001, 10), (99_999, 50_000), (7, 1)] {
            assert!(Reduced::every_nth(count, max).rows.len() <= max);
        }
    }

    #[test]
    fn min_max_keeps_every_peak() {
        let mut values = vec![0.5; 1000];
        (values[123], values[777]) = (1.0, 0.0);
        let reduced = Reduced::min_max(&values, 100);
        assert!(reduced.rows.contains(&123) && reduced.rows.contains(&777));
        assert!(reduced.rows.len() <= 100 && reduced.method == Method::MinMax);
        assert!(reduced.rows.is_sorted());
    }
}
