//! The series of gates: where each track looked for its detections at each scan.

use super::layers::JobLayers;
use super::{Method, Reduced, Window};
use crate::experiment::gates::{Gate, Region, compute_gates};
use serde::Serialize;
use std::collections::BTreeMap;
use utoipa::ToSchema;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum GatesName {
    Gates,
}

/// One row for each gate: of a track at each scan but the first, as long as it lives. A detection is inside where its squared
/// distance `νᵀ S⁻¹ ν` from what was expected is at most `threshold`. No rows where the job had no gates in the plane.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct GatesSeries {
    pub name: GatesName,
    /// Null where the job had no gates in the plane.
    pub threshold: Option<f64>,
    pub columns: GatesColumns,
    /// Unit of each column that has one.
    pub units: BTreeMap<String, String>,
    pub source_points: usize,
    pub returned_points: usize,
    pub method: Method,
}

/// A gate over places has `s_xx`, `s_xy`, `s_yy`; one over ranges and bearings has the columns after them instead.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct GatesColumns {
    pub time_s: Vec<f64>,
    pub track_id: Vec<String>,
    pub sensor_id: Vec<String>,
    /// Where the track was expected.
    pub x_m: Vec<f64>,
    pub y_m: Vec<f64>,
    /// Innovation covariance of the place (m²).
    pub s_xx: Vec<Option<f64>>,
    pub s_xy: Vec<Option<f64>>,
    pub s_yy: Vec<Option<f64>>,
    /// Where the sensor stands.
    pub sensor_x_m: Vec<Option<f64>>,
    pub sensor_y_m: Vec<Option<f64>>,
    /// What was expected of the sensor.
    pub range_m: Vec<Option<f64>>,
    pub bearing_deg: Vec<Option<f64>>,
    /// Innovation covariance of range and bearing (m², m·deg, deg²).
    pub s_rr: Vec<Option<f64>>,
    pub s_rb: Vec<Option<f64>>,
    pub s_bb: Vec<Option<f64>>,
}

const UNITS: [(&str, &str); 14] = [
    ("time_s", "s"),
    ("x_m", "m"),
    ("y_m", "m"),
    ("s_xx", "m²"),
    ("s_xy", "m²"),
    ("s_yy", "m²"),
    ("sensor_x_m", "m"),
    ("sensor_y_m", "m"),
    ("range_m", "m"),
    ("bearing_deg", "deg"),
    ("s_rr", "m²"),
    ("s_rb", "m·deg"),
    ("s_bb", "deg²"),
    ("threshold", "1"),
];

pub(super) fn of(layers: &JobLayers, window: &Window) -> GatesSeries {
    let found = layers
        .detections
        .as_ref()
        .zip(layers.tracks.as_ref())
        .and_then(|(recording, tracks)| {
            compute_gates(
                &layers.spec,
                (recording, &layers.sensors),
                tracks,
                |track| window.holds_track(&track.track_id),
            )
        });
    let threshold = found.as_ref().map(|found| found.threshold);
    let mut rows = found.map(|found| found.gates).unwrap_or_default();
    rows.retain(|gate| window.holds(gate.time_s));
    let kept = Reduced::every_nth(rows.len(), window.max_points);
    GatesSeries {
        name: GatesName::Gates,
        threshold,
        columns: columns(&rows, &kept),
        units: UNITS
            .map(|(column, unit)| (column.to_owned(), unit.to_owned()))
            .into(),
        source_points: kept.source_points,
        returned_points: kept.rows.len(),
        method: kept.method,
    }
}

fn columns(rows: &[Gate], kept: &Reduced) -> GatesColumns {
    let in_plane = |place: (usize, usize)| {
        kept.column(|row| match rows[row].region {
            Region::Plane { covariance_m2 } => Some(covariance_m2[place]),
            Region::Polar { .. } => None,
        })
    };
    let polar = |value: fn(&Polar) -> f64| {
        kept.column(|row| Polar::of(&rows[row].region).as_ref().map(value))
    };
    GatesColumns {
        time_s: kept.column(|row| rows[row].time_s),
        track_id: kept.column(|row| rows[row].track_id.to_owned()),
        sensor_id: kept.column(|row| rows[row].sensor_id.to_owned()),
        x_m: kept.column(|row| rows[row].place_m.x),
        y_m: kept.column(|row| rows[row].place_m.y),
        s_xx: in_plane((0, 0)),
        s_xy: in_plane((0, 1)),
        s_yy: in_plane((1, 1)),
        sensor_x_m: polar(|gate| gate.sensor_m.0),
        sensor_y_m: polar(|gate| gate.sensor_m.1),
        range_m: polar(|gate| gate.range_m),
        bearing_deg: polar(|gate| gate.bearing_deg),
        s_rr: polar(|gate| gate.s_rr),
        s_rb: polar(|gate| gate.s_rb),
        s_bb: polar(|gate| gate.s_bb),
    }
}

/// A gate over ranges and bearings, in degrees.
struct Polar {
    sensor_m: (f64, f64),
    range_m: f64,
    bearing_deg: f64,
    s_rr: f64,
    s_rb: f64,
    s_bb: f64,
}

impl Polar {
    fn of(region: &Region) -> Option<Polar> {
        let Region::Polar {
            sensor_m,
            range_m,
            bearing_rad,
            covariance,
        } = *region
        else {
            return None;
        };
        Some(Polar {
            sensor_m: (sensor_m.x, sensor_m.y),
            range_m,
            bearing_deg: bearing_rad.to_degrees().rem_euclid(360.0),
            s_rr: covariance[(0, 0)],
            s_rb: covariance[(0, 1)].to_degrees(),
            s_bb: covariance[(1, 1)].to_degrees().to_degrees(),
        })
    }
}
