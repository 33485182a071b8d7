//! The sensors of the autoferry recordings: their numbers, and how each writes a measurement.

use super::loose::Loose;
use crate::model::scan::Measurement;
use std::f64::consts::TAU;

/// What is read of one scan's measurement; `None` where it has another shape.
type ReadMeasurement = fn(Loose, [f64; 2]) -> Option<Vec<Measurement>>;

pub(super) struct FerrySensor {
    pub number: u64,
    pub name: &'static str,
    pub read: ReadMeasurement,
    /// The shapes that `read` knows.
    pub expected: &'static str,
}

const POSITIONS: &str = "expected [], [north, east] or [[norths], [easts]] of equal length";
const BEARINGS: &str = "expected a bearing in radians or a list of bearings";

/// In the order of their names.
pub(super) const SENSORS: [FerrySensor; 4] = [
    FerrySensor {
        number: 4,
        name: "daylight",
        read: bearings,
        expected: BEARINGS,
    },
    FerrySensor {
        number: 3,
        name: "infrared",
        read: bearings,
        expected: BEARINGS,
    },
    FerrySensor {
        number: 1,
        name: "lidar",
        read: positions,
        expected: POSITIONS,
    },
    FerrySensor {
        number: 2,
        name: "radar",
        read: positions,
        expected: POSITIONS,
    },
];

/// The positions of a measurement made from `[north, east]`. A flat pair is one position, not two numbers of a row.
fn positions(measurement: Loose, from: [f64; 2]) -> Option<Vec<Measurement>> {
    let at = |north: f64, east: f64| Measurement::Position {
        x_m: east + from[1],
        y_m: north + from[0],
    };
    match measurement {
        Loose::Numbers(numbers) if numbers.is_empty() => Some(Vec::new()),
        Loose::Numbers(numbers) => <[f64; 2]>::try_from(numbers)
            .ok()
            .map(|[north, east]| vec![at(north, east)]),
        Loose::Pair([norths, easts]) => (norths.len() == easts.len()).then(|| {
            norths
                .into_iter()
                .zip(easts)
                .map(|(north, east)| at(north, east))
                .collect()
        }),
        _ => None,
    }
}

/// The bearings of a measurement; from where they were taken is not in them.
fn bearings(measurement: Loose, _from: [f64; 2]) -> Option<Vec<Measurement>> {
    let bearings_rad = match measurement {
        Loose::Number { value, .. } => vec![value],
        Loose::Numbers(numbers) => numbers,
        _ => return None,
    };
    Some(
        bearings_rad
            .into_iter()
            .map(|bearing_rad| Measurement::Bearing {
                bearing_rad: bearing_rad.rem_euclid(TAU),
            })
            .collect(),
    )
}
