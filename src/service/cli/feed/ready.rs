//! Scans that are ready to be pushed.

use crate::experiment::session::{PushedScan, checked_scan};
use crate::model::fault::Fault;
use serde_json::Value;

/// A scan with where it came from.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ready {
    pub scan: PushedScan,
    /// Number of its first line, record or frame; 0 where that is not known.
    pub unit: u64,
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
    let value: Value = serde_json::from_slice(line)
        .map_err(|error| placed(vec![Fault::new("", "malformed", error.to_string())], number))?;
    let scan = checked_scan(&value).map_err(|faults| placed(faults, number))?;
    Ok(Ready { scan, unit: number })
}

fn placed(mut faults: Vec<Fault>, line: u64) -> Vec<Fault> {
    for fault in &mut faults {
        fault.line = Some(line);
    }
    faults
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
        assert_eq!(faults.len(), 2, "{faults:?}");
        assert!(faults.iter().all(|fault| fault.line == Some(9)));
    }
}
