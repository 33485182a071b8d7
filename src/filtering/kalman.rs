//! The Kalman filter for position reports.
//!
//! # Reference
//! Y. Bar-Shalom, X.-R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 5.2.
//!
//! # Symbols
//! x̂, P state and covariance; H = \[I 0\]; R, S noise and innovation covariance; C = cov(x, z).
//!
//! # Method
//! ẑ = H x̂, S = H P Hᵀ + R, C = P Hᵀ; prediction and update are those of all filters.

use super::{FilterMethod, MOTION_FIELDS, Reports, Way, in_plane};
use crate::registry::Object;

pub const METHOD: FilterMethod = FilterMethod {
    name: "kalman",
    parameters: &PARAMETERS,
    build: |spec| in_plane(spec, Way::Line, Reports::Positions),
};

static PARAMETERS: Object = Object {
    name: "KalmanFilter",
    summary: "Kalman filter for position reports.",
    fields: &MOTION_FIELDS,
};
