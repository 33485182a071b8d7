//! Scans that are ready to be pushed.

use crate::experiment::session::{PUSHED_SCAN, PushedDetection, PushedScan};
use crate::formats::degrees;
use crate::model::fault::Fault;
use crate::model::scan::{Detection, Measurement};
use crate::registry;
use serde::Deserialize;
use serde_json::Value;

/// A scan with where it came from.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ready {
    pub scan: PushedScan,
    /// Number of its first line, record or frame; 0 where that is not known.
    pub unit: u64,
}

/// What a session takes of a detection.
pub(super) fn pushed(detection_id: String, detection: &Detection) -> PushedDetection {
    let pushed = PushedDetection {
        detection_id: Some(detection_id),
        amplitude: detection.amplitude,
        ..PushedDetection::default()
    };
    match detection.measurement {
        Measurement::Position { x_m, y_m } => PushedDetection {
            x_m: Some(x_m),
            y_m: Some(y_m),
            ..pushed
        },
        Measurement::Position3 { x_m, y_m, z_m } => PushedDetection {
            x_m: Some(x_m),
            y_m: Some(y_m),
            z_m: Some(z_m),
            ..pushed
        },
        Measurement::RangeBearing {
            range_m,
            bearing_rad,
            ..
        } => PushedDetection {
            range_m: Some(range_m),
            bearing_deg: Some(degrees(bearing_rad)),
            ..pushed
        },
        Measurement::RangeBearingElevation {
            range_m,
            bearing_rad,
            elevation_rad,
            ..
        } => PushedDetection {
            range_m: Some(range_m),
            bearing_deg: Some(degrees(bearing_rad)),
            elevation_deg: Some(degrees(elevation_rad)),
            ..pushed
        },
        Measurement::Bearing { bearing_rad } => PushedDetection {
            bearing_deg: Some(degrees(bearing_rad)),
            ..pushed
        },
        Measurement::BearingElevation {
            bearing_rad,
            elevation_rad,
        } => PushedDetection {
            bearing_deg: Some(degrees(bearing_rad)),
            elevation_deg: Some(degrees(elevation_rad)),
            ..pushed
        },
    }
}

/// Whether a line is a scan as sessions take them.
pub(super) fn is_scan(line: &[u8]) -> bool {
    let value: Option<Value> = serde_json::from_slice(line.trim_ascii()).ok();
    value.is_some_and(|value| {
        let is_there = |name: &str| value.get(name).is_some();
        is_there("sensor_id") && (is_there("detections") || is_there("heartbeat"))
    })
}

/// A line that is such a scan, with its number.
///
/// # Errors
/// All faults of it.
pub(super) fn read_scan(line: &[u8], number: u64) -> Result<Ready, Vec<Fault>> {
    let malformed = |error: serde_json::Error| {
        let fault = Fault::new("", "malformed", error.to_string());
        vec![in_line(fault, number)]
    };
    let value: Value = serde_json::from_slice(line).map_err(malformed)?;
    let checked = registry::check(&value, &PUSHED_SCAN);
    let checked = checked.map_err(|faults| {
        let placed = faults.into_iter().map(|fault| in_line(fault, number));
        placed.collect::<Vec<_>>()
    })?;
    let scan = PushedScan::deserialize(checked).map_err(malformed)?;
    Ok(Ready { scan, unit: number })
}

fn in_line(fault: Fault, number: u64) -> Fault {
    Fault {
        line: Some(number),
        ..fault
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scans_are_told_from_records_and_checked() {
        let line = br#"{"sensor_id": "r", "time_s": 1.5, "detections": [{"x_m": 1, "y_m": 2}]}"#;
        assert!(is_scan(line) && !is_scan(br#"{"sensor_id": "r", "time_s": 1, "x_m": 2}"#));
        let read = read_scan(line, 7).unwrap_or_else(|faults| unreachable!("{faults:?}"));
        assert_eq!(
            (read.unit, read.scan.time_s, read.scan.detections.len()),
            (7, 1.5, 1)
        );
        let faults = read_scan(br#"{"sensor_id": "r", "detections": 3, "x": 1}"#, 9);
        let faults = faults.err().unwrap_or_default();
        assert_eq!(faults.len(), 3, "{faults:?}");
        assert!(faults.iter().all(|fault| fault.line == Some(9)));
    }
}
