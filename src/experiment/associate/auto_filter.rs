//! The filter `auto`: which filter suits what the sensors report.
//!
//! Positions are linear in the state, so they have the Kalman filter; ranges and bearings the unscented one, whose covariances stay
//! honest also near the sensor and where bearings are coarse, and so have bearings beside reports of places; bearings alone have the
//! filter of directions.

use super::dry_run;
use crate::experiment::input::sensors::is_in_volume;
use crate::experiment::request::draft::{Draft, parse};
use crate::experiment::request::methods::{FilterChoice, NamedFilter, TrackingSpec, filter_named};
use crate::filtering::AUTO;
use crate::model::scan::{Measurement, Recording};
use crate::model::sensor::SensorSettings;
use crate::model::space::Space;
use serde_json::Value;

/// How to track a recording, with its filter.
#[derive(Clone)]
pub struct SettledTracking<'s> {
    pub spec: &'s TrackingSpec,
    pub filter: NamedFilter,
    /// The filter as a request would say it, where the request left it open.
    pub chosen: Option<Value>,
    /// M of the rule of confirmation, where the data tell it.
    pub confirm_hits: Option<u32>,
}

/// Puts the filter that suits the request's own scenario, or the detector that it asks for, in the place of `auto`.
pub fn settle_at_planning(draft: &mut Draft) {
    if draft.text_at("/filter/method") != Some(AUTO) {
        return;
    }
    if draft.has("detector") {
        draft.put("filter", filter_named("bearing_only"));
    } else if let Some((scenario, _)) = draft.scenario()
        && let Ok(recording) = dry_run::recording_of(&scenario)
    {
        draft.put("filter", filter_named(choose_method(&recording)));
    }
}

/// Takes the filter that suits what was recorded in the place of `auto`, and any filter of places for the space of the recording.
pub fn settle<'s>(spec: &'s TrackingSpec, recording: &Recording) -> SettledTracking<'s> {
    let space = tracked_space(recording, spec.tracker.stays_flat);
    if let FilterChoice::Named(filter) = spec.filter {
        return SettledTracking {
            spec,
            filter: filter.within(space),
            chosen: None,
            confirm_hits: None,
        };
    }
    let chosen = filter_named(choose_method(recording));
    SettledTracking {
        spec,
        filter: parse::<NamedFilter>(&chosen).within(space),
        chosen: Some(chosen),
        confirm_hits: None,
    }
}

/// Where places are tracked: in space if a sensor tells heights, unless the request says otherwise.
pub fn tracked_space(recording: &Recording, stays_flat: bool) -> Space {
    if !stays_flat && is_in_volume(recording) {
        Space::Volume
    } else {
        Space::Plane
    }
}

fn choose_method(recording: &Recording) -> &'static str {
    let has = |wanted: fn(&Measurement) -> bool| {
        recording
            .detections()
            .any(|detection| wanted(&detection.measurement.flat()))
    };
    let is_polar = has(|measurement| matches!(measurement, Measurement::RangeBearing { .. }));
    let is_placed = has(|measurement| matches!(measurement, Measurement::Position { .. }));
    let knows = |wanted: fn(&SensorSettings) -> bool| recording.sensors.iter().any(wanted);
    match (is_placed, is_polar) {
        (_, true) => "unscented",
        (true, false) if has(|measurement| matches!(measurement, Measurement::Bearing { .. })) => {
            "unscented"
        }
        (true, false) => "kalman",
        // Without places: bearings, or nothing at all, where settings tell what would be reported.
        (false, false) if recording.detection_count() > 0 => "bearing_only",
        _ if knows(|sensor| sensor.sigma_range_m.is_some()) => "unscented",
        _ if knows(|sensor| sensor.sigma_bearing_deg.is_some() && sensor.sigma_x_m.is_none()) => {
            "bearing_only"
        }
        _ => "kalman",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::input::tests::one_scan;
    use crate::registry::{self, Kind};
    use crate::tracking::LIFECYCLE;
    use serde_json::json;

    fn chosen(measurements: &[Measurement]) -> &'static str {
        choose_method(&one_scan(SensorSettings::named("radar"), measurements))
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
                "unscented",
                "kalman"
            ]
        );
    }

    #[test]
    fn a_filter_that_is_named_stays() {
        static ASSOCIATOR: Kind = Kind::Union(&crate::association::ASSOCIATOR);
        let nearest = json!({"method": "nearest_neighbour"});
        let associator = registry::check_field(&nearest, &ASSOCIATOR, "", &mut Vec::new());
        let tracking = |filter: Value| -> TrackingSpec {
            parse(&json!({
                "associator": associator,
                "filter": filter,
                "tracker": registry::check(&json!({}), &LIFECYCLE).unwrap()
            }))
        };
        let named = tracking(filter_named("converted"));
        let settled = settle(&named, &Recording::default());
        assert_eq!((settled.filter.name, settled.chosen), ("converted", None));
        let open = tracking(json!({"method": "auto"}));
        let settled = settle(&open, &Recording::default());
        let chosen = Some(filter_named("kalman"));
        assert_eq!((settled.filter.name, settled.chosen), ("kalman", chosen));
    }
}
