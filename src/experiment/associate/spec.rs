//! The body of a job that tracks, and its type.

use crate::association::ASSOCIATOR;
use crate::detection::Detector;
use crate::experiment::limits::LIMITS;
use crate::experiment::request::fields::{
    DATA, DEFAULT_ASSOCIATOR, DEFAULT_FILTER, DETECTOR, INPUT, JOB_NAME, LABELS, SEED, SENSORS,
};
use crate::experiment::request::methods::TrackingSpec;
use crate::experiment::request::sources::InputSpec;
use crate::filtering::FILTER;
use crate::model::sensor::SensorSettings;
use crate::registry::{Kind, Object, default, optional, required};
use crate::tracking::LIFECYCLE;
use serde::Deserialize;

pub static ASSOCIATE: Object = Object {
    name: "AssociateRequest",
    summary: "Track the targets of a recording or a scenario.",
    fields: &[
        JOB_NAME,
        LABELS,
        LIMITS,
        SEED,
        required(
            "input",
            "The detections, or with detector a bearing-time record.",
            Kind::Union(&INPUT),
        ),
        DETECTOR,
        optional(
            "truth",
            "Truth at which tracks begin (initiation truth), where the input does not know it.",
            Kind::Union(&DATA),
        ),
        SENSORS,
        default(
            "associator",
            "How detections are given to tracks.",
            Kind::Union(&ASSOCIATOR),
            DEFAULT_ASSOCIATOR,
        ),
        default(
            "filter",
            "How tracks are predicted and updated.",
            Kind::Union(&FILTER),
            DEFAULT_FILTER,
        ),
        default(
            "tracker",
            "Gate and life cycle.",
            Kind::Object(&LIFECYCLE),
            "{}",
        ),
    ],
};

/// A request that tracks.
#[derive(Clone, Deserialize)]
pub struct Spec {
    pub input: InputSpec,
    pub detector: Option<Detector>,
    #[serde(default)]
    pub sensors: Vec<SensorSettings>,
    #[serde(flatten)]
    pub tracking: TrackingSpec,
}
