//! What is pushed into a session: scans, heartbeats, and what people do by hand. An entry is what the log keeps.

use super::detection::{PUSHED_DETECTION, PushedDetection, TIME};
use super::hand::HandTrack;
use super::pose::{PUSHED_POSE, PushedPose};
use crate::experiment::request::fields::NAME;
use crate::model::own::whole;
use crate::model::scan::Scan;
use crate::registry::{Kind, Object, default, list, optional, required, whole as whole_number};
use serde::{Deserialize, Serialize};

/// Numbers that every program reads exactly.
const MAX_SEQUENCE: i64 = 1 << 53;

pub static PUSHED_SCAN: Object = Object {
    name: "PushedScan",
    summary: "One scan of one sensor. A scan that saw nothing is pushed as well: that a target was not detected is news.",
    fields: &[
        required("sensor_id", "Which of the session's sensors.", NAME),
        optional(
            "sequence",
            "Number of the scan with its sender, one more than the one before: what comes twice is taken once, and what is left out is told. The next number when absent.",
            whole_number(0, MAX_SEQUENCE, ""),
        ),
        optional(
            "time_s",
            "When the scan was made; UTC epoch seconds, or seconds from whatever the feed chose.",
            TIME,
        ),
        optional(
            "time",
            "In the place of time_s: ISO 8601, of UTC where it names no zone.",
            Kind::Text { max_length: 64 },
        ),
        optional(
            "heartbeat",
            "True: the sensor is alive at this time but made no scan, so nothing is missed.",
            Kind::Flag,
        ),
        optional(
            "pose",
            "Of a sensor that moves.",
            Kind::Object(&PUSHED_POSE),
        ),
        default(
            "detections",
            "What was detected.",
            list(&Kind::Object(&PUSHED_DETECTION), 0, 50_000),
            "[]",
        ),
    ],
};

/// One entry of a session's log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "entry", rename_all = "snake_case")]
pub enum Entry {
    Scan(PushedScan),
    /// A track is begun by hand.
    Begin(HandTrack),
    /// A track is ended by hand.
    End {
        track_id: String,
    },
    /// Scans are refused from here on.
    Pause,
    /// They are taken again.
    Resume,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PushedScan {
    pub sensor_id: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sequence: Option<u64>,
    /// A request may say it as a text.
    #[serde(default)]
    pub time_s: f64,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub heartbeat: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pose: Option<Box<PushedPose>>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub detections: Vec<PushedDetection>,
}

impl PushedScan {
    /// The scan as a tracker takes it.
    pub fn scan(&self, number: u32, sensor: usize) -> Scan {
        let detections = self.detections.iter();
        let (detections, own): (Vec<_>, Vec<_>) = detections
            .filter_map(|one| one.detection(self.time_s))
            .unzip();
        Scan {
            number,
            time_s: self.time_s,
            sensor,
            pose: self.pose.as_ref().map(|pose| pose.pose()),
            detections,
            own: whole(own),
        }
    }

    /// What a detection is called: its number in the scan where it has no name.
    pub fn detection_id(&self, index: usize) -> String {
        let id = self
            .detections
            .get(index)
            .and_then(|one| one.detection_id.clone());
        id.unwrap_or_else(|| (index + 1).to_string())
    }
}
