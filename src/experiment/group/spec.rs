//! The body of a job that groups reports, and its type.

use crate::correlation::grouping::{BuildGrouper, GROUPER};
use crate::experiment::limits::LIMITS;
use crate::experiment::request::fields::{INPUT, JOB_NAME, LABELS, SEED, SENSORS};
use crate::experiment::request::methods::Choice;
use crate::experiment::request::sources::InputSpec;
use crate::model::sensor::SensorSettings;
use crate::registry::{Kind, Object, default, list, number, optional, required};
use serde::Deserialize;

pub static GROUP: Object = Object {
    name: "GroupRequest",
    summary: "Put together what several sensors report of one target at one instant.",
    fields: &[
        JOB_NAME,
        LABELS,
        LIMITS,
        SEED,
        required(
            "input",
            "The detections: positions, or ranges with bearings, of two sensors or more at common times.",
            Kind::Union(&INPUT),
        ),
        SENSORS,
        required(
            "grouper",
            "How reports are put together.",
            Kind::Union(&GROUPER),
        ),
        default(
            "predictions",
            "The tracks behind groupers that use predictions.",
            Kind::Object(&PREDICTIONS),
            "{}",
        ),
        optional(
            "attributes",
            "What nearest_neighbour and fuzzy_c_means compare instead of places, each by its σ, of sensors at one place that report ranges and bearings.",
            list(
                &Kind::Choice(&["position", "range", "bearing", "range_rate"]),
                1,
                4,
            ),
        ),
    ],
};

static PREDICTIONS: Object = Object {
    name: "PredictionSettings",
    summary: "The constant-velocity Kalman tracks whose predictions a grouper may use. All begin at the first instant, which is then not grouped; none ends.",
    fields: &[
        default(
            "start",
            "truth: a track for each target, with its true reports, and its true velocity where truth is given; groups: one for each group of a sequential nearest neighbour within 4 σ.",
            Kind::Choice(&["truth", "groups"]),
            "\"truth\"",
        ),
        default(
            "loop",
            "open: tracks are updated with their true reports, so that every grouper meets the same predictions; closed: with the groups that were found.",
            Kind::Choice(&["open", "closed"]),
            "\"open\"",
        ),
        default(
            "process_noise_m2ps3",
            "Spectral density of the white-noise acceleration.",
            number(0.0, 1e9, "m²/s³"),
            "100.0",
        ),
        default(
            "speed_sigma_mps",
            "Standard deviation of each component of a first velocity that is not known, around 0.",
            number(0.0, 1e5, "m/s"),
            "300.0",
        ),
    ],
};

/// A request that groups reports.
#[derive(Deserialize)]
pub struct Spec {
    pub input: InputSpec,
    #[serde(default)]
    pub sensors: Vec<SensorSettings>,
    pub grouper: Choice<BuildGrouper>,
    pub predictions: PredictionSpec,
    #[serde(default)]
    pub attributes: Vec<AttributeName>,
}

/// What may be compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AttributeName {
    Position,
    Range,
    Bearing,
    RangeRate,
}

impl AttributeName {
    pub const ALL: [AttributeName; 4] = [
        AttributeName::Position,
        AttributeName::Range,
        AttributeName::Bearing,
        AttributeName::RangeRate,
    ];

    /// Places of its values among x, y, r, β, ṙ.
    pub fn rows(self) -> std::ops::Range<usize> {
        match self {
            AttributeName::Position => 0..2,
            AttributeName::Range => 2..3,
            AttributeName::Bearing => 3..4,
            AttributeName::RangeRate => 4..5,
        }
    }
}

/// The parameters of `predictions`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct PredictionSpec {
    pub start: Start,
    #[serde(rename = "loop")]
    pub feedback: Loop,
    pub process_noise_m2ps3: f64,
    pub speed_sigma_mps: f64,
}

/// What tracks begin at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Start {
    Truth,
    Groups,
}

/// Whether tracks are updated with their true reports, or with the groups that were found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Loop {
    Open,
    Closed,
}
