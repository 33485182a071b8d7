//! Filters: prediction of a track to the time of a scan, and its update with weighted detections.

use crate::registry::{Kind, Method, Union};

pub mod kalman;

/// Builds a filter from its checked parameters.
pub type BuildFilter = fn(&serde_json::Value) -> Result<kalman::Kalman, serde_json::Error>;

/// Every filter.
pub const FILTERS: &[Method<BuildFilter>] = &[kalman::METHOD];

pub static FILTER: Union = Union {
    name: "Filter",
    summary: "How a track is predicted and updated.",
    tag: "method",
    variants: || FILTERS.iter().map(Method::variant).collect(),
};

/// The field kind of a filter choice.
pub static FILTER_KIND: Kind = Kind::Union(&FILTER);
