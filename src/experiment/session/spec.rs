//! What a live session is asked to be, and its type.

use crate::experiment::request::fields::{
    ASSOCIATOR_FIELD, FILTER_FIELD, JOB_NAME, LABELS, ONE_SENSOR, SEED, TRACKER_FIELD,
};
use crate::experiment::request::methods::TrackingSpec;
use crate::experiment::request::scenario::ORIGIN;
use crate::model::sensor::SensorSettings;
use crate::model::space::Frame;
use crate::registry::{Kind, Object, default, list, number, optional, required, whole};
use serde::{Deserialize, Serialize};
use serde_json::Value;

pub static SESSION: Object = Object {
    name: "SessionRequest",
    summary: "Track a live feed: a session takes scans one by one and tells its tracks at once. Nothing is estimated from data that are still to come, so each sensor says its noise, p_d and clutter density, and the tracker the speed that new tracks allow for.",
    fields: &[
        JOB_NAME,
        LABELS,
        SEED,
        optional(
            "origin",
            "Where x and y are 0 on the Earth (WGS 84): scans may then give places by latitude and longitude, and tracks tell theirs.",
            Kind::Object(&ORIGIN),
        ),
        required(
            "sensors",
            "The sensors that report. What a sensor reports follows from its noises: places (sigma_x_m, sigma_y_m; in space sigma_z_m), ranges and bearings (sigma_range_m, sigma_bearing_deg; in space sigma_elevation_deg) or bearings alone (sigma_bearing_deg).",
            list(&ONE_SENSOR, 1, 64),
        ),
        ASSOCIATOR_FIELD,
        FILTER_FIELD,
        TRACKER_FIELD,
        default(
            "late",
            "What becomes of a scan that comes after a later one: it is dropped and counted; or every scan waits for others, for delay_s; or the scans since are processed again, as far back as window_s.",
            Kind::Choice(&["drop", "wait", "replay"]),
            "\"drop\"",
        ),
        default(
            "delay_s",
            "With late wait: how much later data must be before a scan is processed, unless every sensor was heard since.",
            number(0.0, 3600.0, "s"),
            "0.0",
        ),
        default(
            "window_s",
            "With late replay: how far back a scan may come.",
            number(0.0, 3600.0, "s"),
            "10.0",
        ),
        default(
            "max_window_scans",
            "With late wait or replay: scans that are kept at most.",
            whole(1, 4096, "scans"),
            "256",
        ),
        default(
            "max_gap_s",
            "A scan that is later than the last by more is refused, so that one wrong clock does not make all others late.",
            number(1.0, 1e9, "s"),
            "86400.0",
        ),
        default(
            "max_tracks",
            "Living tracks; beyond it the youngest tentative ones are dropped, and an event says so.",
            whole(1, 20_000, "tracks"),
            "2000",
        ),
        default(
            "max_detections",
            "Detections of a scan; a scan of more is refused.",
            whole(1, 50_000, "detections"),
            "5000",
        ),
        optional(
            "max_scans_per_s",
            "Scans and heartbeats that it takes a second, and as many as of ten seconds at once; beyond it a push is answered 429 with Retry-After. No limit when absent.",
            number(0.001, 1e6, "1/s"),
        ),
        optional(
            "max_age_s",
            "A session that was begun so long ago is closed. No limit when absent.",
            number(1.0, 1e10, "s"),
        ),
        optional(
            "max_log_bytes",
            "A session whose log has grown to this is closed. No limit when absent.",
            whole(1, 1 << 50, "bytes"),
        ),
    ],
};

/// What becomes of a scan that comes after a later one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum LatePolicy {
    Drop,
    Wait,
    Replay,
}

/// A request for a session.
#[derive(Clone, Deserialize)]
pub struct Spec {
    pub seed: u32,
    pub origin: Option<Frame>,
    pub sensors: Vec<SensorSettings>,
    #[serde(flatten)]
    pub tracking: TrackingSpec,
    #[serde(flatten)]
    pub rules: Rules,
}

/// How scans are taken in.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Rules {
    pub late: LatePolicy,
    pub delay_s: f64,
    pub window_s: f64,
    pub max_window_scans: usize,
    pub max_gap_s: f64,
    pub max_tracks: usize,
    pub max_detections: usize,
    pub max_scans_per_s: Option<f64>,
}

/// When a session ends by itself.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
struct Ends {
    max_age_s: Option<f64>,
    max_log_bytes: Option<u64>,
}

/// Whether a session of this request and age, whose log has so many bytes, is to be closed.
pub fn is_over(request: &Value, age_s: f64, log_bytes: u64) -> bool {
    let ends = Ends::deserialize(request).unwrap_or_default();
    ends.max_age_s.is_some_and(|most_s| age_s >= most_s)
        || ends.max_log_bytes.is_some_and(|most| log_bytes >= most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_session_is_over_by_age_or_by_bytes() {
        let request = json!({"max_age_s": 60.0, "max_log_bytes": 1000});
        assert!(!is_over(&request, 59.9, 999));
        assert!(is_over(&request, 60.0, 0) && is_over(&request, 0.0, 1000));
        assert!(!is_over(&json!({}), 1e9, u64::MAX));
    }
}
