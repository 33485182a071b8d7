//! The filter `auto`: which filter suits what the sensors report.
//!
//! Positions are linear in the state, so they have the Kalman filter; ranges and bearings the unscented one, whose covariances stay
//! honest also near the sensor and where bearings are coarse; bearings alone the filter of directions.

use super::dry_run as rehearsal;
use crate::experiment::plan::scenario_of;
use crate::filtering::{AUTO, FILTER_KIND};
use crate::model::scan::{Measurement, Recording};
use crate::registry;
use serde_json::{Value, json};

/// Puts the filter that suits the request's own scenario, or the detector that it asks for, in the place of `auto`.
pub fn settle_at_planning(spec: &mut Value) {
    if !is_open(spec) {
        return;
    }
    if spec.get("detector").is_some() {
        spec["filter"] = filter_named("bearing_only");
    } else if let Some(recording) =
        scenario_of(spec).and_then(|(scenario, _)| rehearsal::recording_of(&scenario).ok())
    {
        settle(spec, &recording);
    }
}

/// Puts the filter that suits what was recorded in the place of `auto`; whether there was a choice to make.
pub fn settle(spec: &mut Value, recording: &Recording) -> bool {
    let is_open = is_open(spec);
    if is_open {
        spec["filter"] = filter_named(suited(recording));
    }
    is_open
}

/// Whether the filter of the spec still has to be chosen.
pub fn is_open(spec: &Value) -> bool {
    spec.pointer("/filter/method") == Some(&json!(AUTO))
}

fn suited(recording: &Recording) -> &'static str {
    let has = |wanted: fn(&Measurement) -> bool| {
        recording
            .detections
            .iter()
            .any(|detection| wanted(&detection.measurement))
    };
    let is_polar = has(|measurement| matches!(measurement, Measurement::RangeBearing { .. }));
    let is_placed = has(|measurement| matches!(measurement, Measurement::Position { .. }));
    let knows = |wanted: fn(&crate::model::sensor::SensorSettings) -> bool| {
        recording.sensors.iter().any(wanted)
    };
    match (is_placed, is_polar) {
        (_, true) => "unscented",
        (true, false) => "kalman",
        // Without places: bearings, or nothing at all, where settings tell what would be reported.
        (false, false) if !recording.detections.is_empty() => "bearing_only",
        _ if knows(|sensor| sensor.sigma_range_m.is_some()) => "unscented",
        _ if knows(|sensor| sensor.sigma_bearing_deg.is_some() && sensor.sigma_x_m.is_none()) => {
            "bearing_only"
        }
        _ => "kalman",
    }
}

fn filter_named(method: &str) -> Value {
    registry::check_field(
        &json!({"method": method}),
        &FILTER_KIND,
        "",
        &mut Vec::new(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scan::{Detection, RecordingParts, Scan};
    use crate::model::sensor::SensorSettings;

    fn chosen(measurements: &[Measurement]) -> String {
        let detection = |&measurement| Detection {
            measurement,
            origin: None,
            amplitude: None,
        };
        let recording = Recording::new(RecordingParts {
            sensors: vec![SensorSettings::named("radar")],
            scans: vec![Scan {
                number: 1,
                time_s: 0.0,
                sensor: 0,
                first: 0,
                count: measurements.len(),
            }],
            detections: measurements.iter().map(detection).collect(),
            detection_ids: (0..measurements.len())
                .map(|index| index.to_string())
                .collect(),
            ..Default::default()
        });
        let mut spec = json!({"filter": {"method": "auto"}});
        assert!(settle(&mut spec, &recording.unwrap()));
        spec["filter"]["method"].as_str().unwrap().to_owned()
    }

    #[test]
    fn the_filter_suits_what_is_reported() {
        let (at, polar) = (
            Measurement::Position { x_m: 1.0, y_m: 2.0 },
            Measurement::RangeBearing {
                range_m: 1.0,
                bearing_rad: 0.5,
                range_rate_mps: None,
            },
        );
        let bearing = Measurement::Bearing { bearing_rad: 0.5 };
        let found = [
            chosen(&[at]),
            chosen(&[polar]),
            chosen(&[bearing]),
            chosen(&[at, polar]),
            chosen(&[at, bearing]),
            chosen(&[]),
        ];
        assert_eq!(
            found,
            [
                "kalman",
                "unscented",
                "bearing_only",
                "unscented",
                "kalman",
                "kalman"
            ]
        );
    }

    #[test]
    fn a_filter_that_is_named_stays() {
        let mut spec = json!({"filter": {"method": "converted", "process_noise_m2ps3": 2.0}});
        assert!(!settle(&mut spec, &Recording::default()));
        assert_eq!(spec["filter"]["method"], "converted");
    }
}
