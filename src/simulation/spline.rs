//! A curve through the recorded points of a target: between two points a cubic of time (Hermite), whose slopes at a point are those
//! of the parabola through it and its neighbours (W. Kluczewicz; "Bessel" in C. de Boor, A Practical Guide to Splines, IV).

use crate::model::space::Place;
use crate::model::truth::TruthPoint;

/// Points in order of time, with the slope at each (m/s).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Spline {
    points: Vec<TruthPoint>,
    slopes: Vec<Place>,
    max_gap_s: f64,
}

impl Spline {
    /// `points` in order of time; between two of them farther apart than `max_gap_s` there is nothing.
    pub fn through(points: &[TruthPoint], max_gap_s: f64) -> Self {
        let slopes = (0..points.len())
            .map(|index| slope_at(points, index, max_gap_s))
            .collect();
        Spline {
            points: points.to_vec(),
            slopes,
            max_gap_s,
        }
    }

    pub fn exists_at(&self, time_s: f64) -> bool {
        let after = self.points.partition_point(|point| point.time_s < time_s);
        let Some(next) = self.points.get(after) else {
            return false;
        };
        let before = after.checked_sub(1).map(|before| &self.points[before]);
        next.time_s == time_s
            || before.is_some_and(|before| next.time_s - before.time_s <= self.max_gap_s)
    }

    /// Place and velocity; before the first and after the last point the place there.
    pub fn point_at(&self, time_s: f64) -> TruthPoint {
        let after = self.points.partition_point(|point| point.time_s < time_s);
        let last = self.points.len().saturating_sub(1);
        let (to, from) = (after.min(last), after.saturating_sub(1).min(last));
        let (before, next) = (&self.points[from], &self.points[to]);
        let gap_s = next.time_s - before.time_s;
        if gap_s <= 0.0 || next.time_s == time_s {
            return TruthPoint {
                time_s,
                velocity: Some(self.slopes[to]),
                ..*next
            };
        }
        let u = (time_s - before.time_s) / gap_s;
        let (start, end) = (self.slopes[from] * gap_s, self.slopes[to] * gap_s);
        let way = next.position - before.position;
        // p(u) = p0 + m0 u + (3 Δ − 2 m0 − m1) u² + (m0 + m1 − 2 Δ) u³.
        let (square, cube) = (way * 3.0 - start * 2.0 - end, start + end - way * 2.0);
        let position = before.position + (start + (square + cube * u) * u) * u;
        let velocity = (start + (square * 2.0 + cube * (3.0 * u)) * u) / gap_s;
        let heights_m = before.height_m.zip(next.height_m);
        TruthPoint {
            time_s,
            position,
            velocity: Some(velocity),
            height_m: heights_m.map(|(from_m, to_m)| from_m + (to_m - from_m) * u),
        }
    }

    /// The fastest mean speed between two points.
    pub fn fastest_mps(&self) -> f64 {
        let speeds = self.points.windows(2).map(|pair| {
            (pair[1].position - pair[0].position).norm() / (pair[1].time_s - pair[0].time_s)
        });
        speeds.fold(0.0, f64::max)
    }

    /// How far the curve through the other points passes by each inner point (m), where its neighbours are near enough in time:
    /// more than the curve through all of them is off in between.
    pub fn leave_one_out_m(&self) -> Vec<f64> {
        let mut errors_m = Vec::new();
        for index in 1..self.points.len().saturating_sub(1) {
            let around = index.saturating_sub(2)..(index + 3).min(self.points.len());
            let mut others = self.points[around].to_vec();
            others.retain(|point| point.time_s != self.points[index].time_s);
            let curve = Spline::through(&others, self.max_gap_s);
            let point = &self.points[index];
            if curve.exists_at(point.time_s) {
                errors_m.push((curve.point_at(point.time_s).position - point.position).norm());
            }
        }
        errors_m
    }
}

/// The slope of the parabola through a point and its neighbours; of the line to the only neighbour at an end.
fn slope_at(points: &[TruthPoint], index: usize, max_gap_s: f64) -> Place {
    let slope = |from: usize, to: usize| {
        let (from, to) = (&points[from], &points[to]);
        let gap_s = to.time_s - from.time_s;
        (gap_s <= max_gap_s).then(|| ((to.position - from.position) / gap_s, gap_s))
    };
    let before = index.checked_sub(1).and_then(|before| slope(before, index));
    let after = (index + 1 < points.len())
        .then(|| slope(index, index + 1))
        .flatten();
    match (before, after) {
        (Some((before, before_s)), Some((after, after_s))) => {
            (before * after_s + after * before_s) / (before_s + after_s)
        }
        (Some((one, _)), None) | (None, Some((one, _))) => one,
        (None, None) => points[index].velocity.unwrap_or_default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(time_s: f64, x_m: f64, y_m: f64) -> TruthPoint {
        TruthPoint {
            time_s,
            position: Place::new(x_m, y_m, 0.0),
            velocity: None,
            height_m: Some(10.0 * time_s),
        }
    }

    #[test]
    fn a_parabola_is_met_between_its_inner_points() {
        // x = t², y = 3 t: the slopes at inner points are exact, so the cubic is the parabola itself.
        let points: Vec<TruthPoint> = [0.0, 1.0, 3.0, 4.0]
            .map(|time_s: f64| point(time_s, time_s * time_s, 3.0 * time_s))
            .to_vec();
        let spline = Spline::through(&points, 10.0);
        let found = spline.point_at(2.0);
        assert!(
            (found.position - Place::new(4.0, 6.0, 0.0)).norm() < 1e-12,
            "{found:?}"
        );
        assert!((found.velocity.unwrap() - Place::new(4.0, 3.0, 0.0)).norm() < 1e-12);
        assert_eq!(found.height_m, Some(20.0));
        assert_eq!(spline.point_at(3.0).position.x, 9.0);
    }

    #[test]
    fn there_is_nothing_in_long_gaps_and_outside() {
        let spline = Spline::through(
            &[
                point(0.0, 0.0, 0.0),
                point(5.0, 5.0, 0.0),
                point(60.0, 0.0, 0.0),
            ],
            10.0,
        );
        let exists = [-1.0, 0.0, 2.0, 5.0, 20.0, 60.0, 61.0].map(|time_s| spline.exists_at(time_s));
        assert_eq!(exists, [false, true, true, true, false, true, false]);
        assert_eq!(spline.fastest_mps(), 1.0);
    }

    #[test]
    fn on_a_straight_line_no_point_is_missed() {
        let points: Vec<TruthPoint> = (0..9)
            .map(|step| point(f64::from(step), 7.0 * f64::from(step), 0.0))
            .collect();
        let errors_m = Spline::through(&points, 10.0).leave_one_out_m();
        assert_eq!(errors_m.len(), 7);
        assert!(
            errors_m.iter().all(|error_m| *error_m < 1e-12),
            "{errors_m:?}"
        );
    }
}
