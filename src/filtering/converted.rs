//! The Kalman filter on unbiased converted measurements: ranges and bearings become positions
//! ([`crate::model::sensing::Converted`]) before the linear filter sees them.

use super::{FilterMethod, MOTION_FIELDS, Reports, Way, in_plane};
use crate::registry::Object;

pub const METHOD: FilterMethod = FilterMethod {
    name: "converted",
    parameters: &PARAMETERS,
    build: |spec| in_plane(spec, Way::Line, Reports::Converted),
};

static PARAMETERS: Object = Object {
    name: "ConvertedMeasurementFilter",
    summary: "Kalman filter on unbiased converted measurements: ranges and bearings turned into positions.",
    fields: &MOTION_FIELDS,
};
