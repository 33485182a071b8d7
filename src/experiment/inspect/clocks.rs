//! Clocks that are hours apart: of the sensors of a recording, and of what was seen and the truth.

use crate::model::dataset::Dataset;

const HOUR_S: f64 = 3600.0;
/// The clocks of two zones are no more apart.
const MOST_HOURS: i32 = 14;
/// How well two spans of time must lie over each other, to be the same but for the hours (s).
const FIT_S: f64 = 60.0;

/// Shifts by whole hours, the shorter first, without none.
pub fn shifts_s() -> impl Iterator<Item = f64> {
    (1..=MOST_HOURS)
        .flat_map(|hours| [-hours, hours])
        .map(|hours| f64::from(hours) * HOUR_S)
}

/// Sensors that begin and end as the first one does, but whole hours before or after it.
pub fn of_sensors(dataset: &Dataset) -> Vec<String> {
    let Dataset::Detections(recording) = dataset else {
        return Vec::new();
    };
    let mut spans: Vec<Option<(f64, f64)>> = vec![None; recording.sensors.len()];
    for scan in &recording.scans {
        let span = spans[scan.sensor].get_or_insert((scan.time_s, scan.time_s));
        *span = (span.0.min(scan.time_s), span.1.max(scan.time_s));
    }
    let mut known = spans
        .iter()
        .zip(&recording.sensors)
        .filter_map(|(span, sensor)| Some(((*span)?, sensor.sensor_id.as_str())));
    let Some(first) = known.next() else {
        return Vec::new();
    };
    known.filter_map(|other| shifted(first, other)).collect()
}

fn shifted(first: ((f64, f64), &str), other: ((f64, f64), &str)) -> Option<String> {
    let shift_s = shifts_s().find(|shift_s| fits(first.0, other.0, *shift_s))?;
    Some(format!(
        "the times of sensor '{}' are those of sensor '{}' but for {}: `clock_offset_s` {} of its file puts them together",
        other.1,
        first.1,
        hours(shift_s),
        -shift_s
    ))
}

/// Whether the second span is the first one, shifted.
fn fits(one: (f64, f64), other: (f64, f64), shift_s: f64) -> bool {
    (other.0 - one.0 - shift_s).abs() < FIT_S && (other.1 - one.1 - shift_s).abs() < FIT_S
}

/// "1 hour", "3 hours".
pub fn hours(shift_s: f64) -> String {
    match (shift_s / HOUR_S).abs().round() {
        1.0 => "1 hour".to_owned(),
        hours => format!("{hours} hours"),
    }
}
