//! Where a sensor's detections lie: an area of the plane, the space above it, or, where directions alone are used, an arc.
//! Densities of clutter are stated over it, per m², per m³ or per degree.

use crate::model::scan::{Detection, Measurement, Recording, Scan};
use crate::model::sensing::MeasurementModel;
use crate::model::sensor::SensorSettings;
use crate::model::space::Space;
use crate::model::state::Position;
use std::f64::consts::{PI, TAU};

/// Of one sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    pub space: Space,
    /// The rectangle (m²), box (m³) or arc (degrees) that holds every detection; 0 when there are none.
    pub seen: f64,
    /// The field of view, or where that is not known what was seen.
    pub watched: f64,
}

impl Extent {
    pub fn measure(
        recording: &Recording,
        sensor: usize,
        settings: &SensorSettings,
        report: &MeasurementModel,
    ) -> Self {
        let space = space_of(report);
        let seen = match space {
            Space::Bearing => arc_deg(recording, sensor),
            Space::Plane => area_m2(recording, sensor, settings),
            Space::Volume => area_m2(recording, sensor, settings) * heights_m(recording, sensor),
        };
        let view = settings.field_of_view.unwrap_or_default();
        let limits = view.limits();
        let field_of_view = |range_m: f64| match space {
            Space::Bearing => limits.arc_rad().1.to_degrees(),
            Space::Plane | Space::Volume => {
                let area_m2 = limits.area_m2(range_m);
                if space == Space::Volume {
                    area_m2 * heights_m(recording, sensor)
                } else {
                    area_m2
                }
            }
        };
        let is_arc = space == Space::Bearing && settings.field_of_view.is_some();
        let range_to_m = view.range_to_m.or(settings.max_range_m);
        Extent {
            space,
            seen,
            watched: range_to_m
                .or(is_arc.then_some(0.0))
                .map_or(seen, field_of_view),
        }
    }

    pub fn unit(&self) -> &'static str {
        match self.space {
            Space::Bearing => "degree",
            Space::Plane => "m²",
            Space::Volume => "m³",
        }
    }

    /// The density over this extent that is known of the sensor.
    pub fn density_of(&self, settings: &SensorSettings) -> Option<f64> {
        match self.space {
            Space::Bearing => settings.clutter_per_deg,
            Space::Plane => settings.clutter_per_m2,
            Space::Volume => settings.clutter_per_m3,
        }
    }

    /// A density over this extent, in the units that are used inside: per radian instead of per degree.
    pub fn inside(&self, density: f64) -> f64 {
        match self.space {
            Space::Bearing => density * (180.0 / PI),
            Space::Plane | Space::Volume => density,
        }
    }
}

/// The space over which the clutter of these reports is stated.
pub fn space_of(report: &MeasurementModel) -> Space {
    match report {
        MeasurementModel::Bearing { .. } | MeasurementModel::Sight(_) => Space::Bearing,
        MeasurementModel::Position3 {
            clutter_span: None, ..
        } => Space::Volume,
        MeasurementModel::Moving(moving)
            if moving.is_in_volume && moving.clutter_span.is_none() =>
        {
            Space::Volume
        }
        MeasurementModel::Spherical(spherical)
        | MeasurementModel::ConvertedSpherical(spherical)
            if spherical.sigma_elevation_rad.is_some() && spherical.clutter_span.is_none() =>
        {
            Space::Volume
        }
        _ => Space::Plane,
    }
}

/// The interval of heights that a sensor's detections fill, from the sensor or, of positions, from the origin; at least 1 m, so
/// that a density over it exists.
pub fn heights_m(recording: &Recording, sensor: usize) -> f64 {
    let height_m = |detection: &Detection| match detection.measurement {
        Measurement::Position3 { z_m, .. } => Some(z_m),
        Measurement::RangeBearingElevation {
            range_m,
            elevation_rad,
            ..
        } => Some(range_m * elevation_rad.sin()),
        _ => None,
    };
    length(detections_of(recording, sensor).filter_map(height_m)).max(1.0)
}

/// The interval of elevations (rad) that they fill; at least a thousandth.
pub fn elevations_rad(recording: &Recording, sensor: usize) -> f64 {
    let detections = detections_of(recording, sensor);
    length(detections.filter_map(|one| one.measurement.elevation_rad())).max(1e-3)
}

/// From the least of some values to the greatest.
pub fn length(values: impl Iterator<Item = f64>) -> f64 {
    let ends = values.fold(None, |ends: Option<(f64, f64)>, value| {
        let (low, high) = ends.unwrap_or((value, value));
        Some((low.min(value), high.max(value)))
    });
    ends.map_or(0.0, |(low, high)| high - low)
}

/// The detections of one sensor.
pub fn detections_of(recording: &Recording, sensor: usize) -> impl Iterator<Item = &Detection> {
    scans_of(recording, sensor).flat_map(|scan| &scan.detections)
}

pub fn scans_of(recording: &Recording, sensor: usize) -> impl Iterator<Item = &Scan> {
    let scans = recording.scans.iter();
    scans.filter(move |scan| scan.sensor == sensor)
}

pub fn place_of(settings: &SensorSettings) -> Position {
    Position::new(settings.x_m.unwrap_or(0.0), settings.y_m.unwrap_or(0.0))
}

fn area_m2(recording: &Recording, sensor: usize, settings: &SensorSettings) -> f64 {
    corners(recording, sensor, settings).map_or(0.0, |(low_m, high_m)| {
        (high_m[0] - low_m[0]) * (high_m[1] - low_m[1])
    })
}

/// The rectangle that holds every detection, by its corners; `None` of none.
pub fn corners(
    recording: &Recording,
    sensor: usize,
    settings: &SensorSettings,
) -> Option<(Position, Position)> {
    let place_m = place_of(settings);
    let mut positions: Vec<Position> = Vec::new();
    for scan in recording.scans.iter().filter(|scan| scan.sensor == sensor) {
        let from_m = scan.sensor_place_m(place_m);
        let seen = scan
            .detections
            .iter()
            .map(|detection| detection.measurement);
        positions.extend(seen.filter_map(|measurement| measurement.position_seen_from(&from_m)));
    }
    let first = positions.first()?;
    let low_m = positions.iter().fold(*first, |low, place| low.inf(place));
    let high_m = positions.iter().fold(*first, |high, place| high.sup(place));
    Some((low_m, high_m))
}

/// The whole turn without the widest gap between neighbouring bearings.
fn arc_deg(recording: &Recording, sensor: usize) -> f64 {
    let bearing = |detection: &Detection| match detection.measurement.flat() {
        Measurement::Bearing { bearing_rad } | Measurement::RangeBearing { bearing_rad, .. } => {
            Some(bearing_rad.rem_euclid(TAU))
        }
        _ => None,
    };
    let mut bearings: Vec<f64> = detections_of(recording, sensor)
        .filter_map(bearing)
        .collect();
    bearings.sort_by(f64::total_cmp);
    let (Some(first), Some(last)) = (bearings.first(), bearings.last()) else {
        return 0.0;
    };
    let across_north = first + TAU - last;
    let widest = bearings
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .fold(across_north, f64::max);
    (TAU - widest).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::input::tests::one_scan;
    use crate::model::sensing::{Bearing, Platform};

    fn arc_of(bearings_deg: &[f64]) -> f64 {
        let bearing = |degrees: &f64| Measurement::Bearing {
            bearing_rad: degrees.to_radians(),
        };
        let bearings: Vec<Measurement> = bearings_deg.iter().map(bearing).collect();
        Extent::measure(
            &one_scan(SensorSettings::named("sonar"), &bearings),
            0,
            &SensorSettings::named("sonar"),
            &MeasurementModel::Bearing(Bearing {
                place_m: Position::zeros(),
                sigma_bearing_rad: 0.01,
                platform: Platform::STANDING,
                range_prior: None,
            }),
        )
        .seen
    }

    #[test]
    fn an_arc_may_hold_north() {
        for (bearings_deg, expected) in [
            (&[10.0, 350.0, 0.0][..], 20.0),
            (&[-10.0, 370.0], 20.0),
            (&[90.0, 270.0, 180.0], 180.0),
            (&[5.0], 0.0),
            (&[], 0.0),
        ] {
            assert!(
                (arc_of(bearings_deg) - expected).abs() < 1e-9,
                "{bearings_deg:?}: {}",
                arc_of(bearings_deg)
            );
        }
    }
}
