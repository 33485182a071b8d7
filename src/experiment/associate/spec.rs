//! The body of a job that tracks, and its type.

use crate::detection::Detector;
use crate::experiment::limits::LIMITS;
use crate::experiment::request::fields::{
    ASSOCIATOR_FIELD, DATA, DETECTOR, FILTER_FIELD, INPUT, JOB_NAME, LABELS, SEED, SENSORS,
    TRACKER_FIELD,
};
use crate::experiment::request::methods::TrackingSpec;
use crate::experiment::request::sources::InputSpec;
use crate::model::sensor::SensorSettings;
use crate::registry::{Kind, Object, optional, required};
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
        ASSOCIATOR_FIELD,
        FILTER_FIELD,
        TRACKER_FIELD,
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
