//! Whether bearings alone can tell how far a target is: only from a sensor that leaves its own straight course across the line of sight.
//!
//! # Reference
//! S. C. Nardone, V. J. Aidala, Observability criteria for bearings-only target motion analysis, IEEE Transactions on Aerospace and
//! Electronic Systems 17(2), 1981.
//!
//! # Method
//! A straight course at constant speed is fitted to the places of the sensor by least squares. What it leaves across a bearing is the
//! manoeuvre across that line of sight: seen from the nearest range that a target may have, it must be larger than the noise.

use super::track::ResolvedRecording;
use crate::model::scan::{Measurement, Scan};
use crate::model::sensing::{Bearing, MeasurementModel};
use crate::model::state::Position;

/// What there is to say where one sensor of bearings is alone, and does not manoeuvre.
pub fn warning(data: &ResolvedRecording) -> Option<String> {
    let [sensor] = data.sensors else {
        return None;
    };
    let MeasurementModel::Bearing(bearing) = &sensor.report else {
        return None;
    };
    let prior = bearing.range_prior.filter(|_| sensor.may_start)?;
    let moved_m = across_sight_m(&data.recording.scans, bearing);
    let seen_rad = moved_m / prior.min_m;
    (seen_rad <= bearing.sigma_bearing_rad).then(|| {
        format!(
            "sensor '{}' never leaves a straight course across the line of sight by more than {moved_m:.1} m: its bearings do not tell how far targets are, and ranges stay what was assumed",
            sensor.sensor_id
        )
    })
}

/// The largest distance of the sensor from a straight course, across a bearing that it reported there.
fn across_sight_m(scans: &[Scan], bearing: &Bearing) -> f64 {
    let seen = || scans.iter().filter(|scan| !scan.detections.is_empty());
    let places: Vec<(f64, Position)> = seen()
        .map(|scan| (scan.time_s, scan.sensor_place_m(bearing.place_m)))
        .collect();
    let Some(course) = Line::through(&places) else {
        return 0.0;
    };
    let mut farthest_m: f64 = 0.0;
    for (scan, (time_s, place_m)) in seen().zip(&places) {
        let off_m = place_m - course.at(*time_s);
        for detection in &scan.detections {
            if let Measurement::Bearing { bearing_rad } = detection.measurement.flat() {
                let across = Position::new(bearing_rad.cos(), -bearing_rad.sin());
                farthest_m = farthest_m.max(across.dot(&off_m).abs());
            }
        }
    }
    farthest_m
}

/// A straight course at constant speed.
struct Line {
    mean_s: f64,
    mean_m: Position,
    velocity_mps: Position,
}

impl Line {
    /// `None` without a place.
    fn through(places: &[(f64, Position)]) -> Option<Line> {
        let count = places.len() as f64;
        let (first_s, _) = places.first()?;
        let mean_s = first_s
            + places
                .iter()
                .map(|(time_s, _)| time_s - first_s)
                .sum::<f64>()
                / count;
        let mean_m = places.iter().map(|(_, place_m)| place_m).sum::<Position>() / count;
        let (mut square_s2, mut product) = (0.0, Position::zeros());
        for (time_s, place_m) in places {
            square_s2 += (time_s - mean_s).powi(2);
            product += (place_m - mean_m) * (time_s - mean_s);
        }
        let velocity_mps = if square_s2 > 0.0 {
            product / square_s2
        } else {
            Position::zeros()
        };
        Some(Line {
            mean_s,
            mean_m,
            velocity_mps,
        })
    }

    fn at(&self, time_s: f64) -> Position {
        self.mean_m + self.velocity_mps * (time_s - self.mean_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_course_leaves_nothing() {
        let at = |time_s: f64| (time_s, Position::new(3.0 - 2.0 * time_s, 5.0 * time_s));
        let line = Line::through(&[at(10.0), at(11.0), at(15.0), at(40.0)]).unwrap();
        for time_s in [0.0, 17.0, 40.0] {
            assert!((line.at(time_s) - at(time_s).1).norm() < 1e-9);
        }
        let alone = Line::through(&[at(10.0)]).unwrap();
        assert_eq!(alone.at(50.0), at(10.0).1);
        assert!(Line::through(&[]).is_none());
    }
}
