//! The range rates of a sensor, and whether they are used.

use crate::experiment::input::extent::{detections_of, length};
use crate::experiment::request::methods::NamedFilter;
use crate::model::scan::{Detection, Measurement, Recording};
use crate::model::sensor::SensorSettings;
use crate::model::space::Space;

/// The range rate of a detection; a flat tracker cannot use those along a slant.
fn range_rate_of(detection: &Detection, is_flat: bool) -> Option<f64> {
    match detection.measurement {
        Measurement::RangeBearing { range_rate_mps, .. } => range_rate_mps,
        Measurement::RangeBearingElevation { range_rate_mps, .. } if !is_flat => range_rate_mps,
        _ => None,
    }
}

pub fn reported_rates(detections: &mut dyn Iterator<Item = &Detection>, is_flat: bool) -> usize {
    detections
        .filter(|detection| range_rate_of(detection, is_flat).is_some())
        .count()
}

/// Range rates of a sensor are used by a filter that can, when every detection of the sensor has one.
pub fn uses_range_rates(
    recording: &Recording,
    sensor: usize,
    named: &NamedFilter,
    warnings: &mut Vec<String>,
) -> bool {
    let is_flat = named.filter.space() != Space::Volume;
    let with_rate = reported_rates(&mut detections_of(recording, sensor), false);
    let usable = reported_rates(&mut detections_of(recording, sensor), is_flat);
    let all = detections_of(recording, sensor).count();
    if with_rate == 0 || !named.filter.uses_range_rates() {
        return false;
    }
    if usable < all {
        let whose = match recording.sensors.as_slice() {
            [_] => String::new(),
            sensors => format!("sensor '{}': ", sensors[sensor].sensor_id),
        };
        let why = if usable < with_rate {
            "tracks of the plane know none along a slant".to_owned()
        } else {
            format!("{with_rate} of {all} detections have one")
        };
        warnings.push(format!("{whose}range rates are not used: {why}"));
    }
    usable == all
}

/// The interval over which a sensor's range rates reach: as it is stated, else that of the data; at least 1 m/s then, so that a
/// density over it exists.
pub fn range_rate_span_mps(recording: &Recording, sensor: usize, stated: &SensorSettings) -> f64 {
    if let Some(span_mps) = stated.range_rate_span_mps {
        return span_mps;
    }
    let detections = detections_of(recording, sensor);
    length(detections.filter_map(|detection| range_rate_of(detection, false))).max(1.0)
}
