//! The extended Kalman filter for ranges and bearings, with range rates where the sensor measures them: the report is
//! linearised at the predicted state, and what a line cannot say of it counts as more noise. Without that a track of a sensor
//! so precise that it sees the curvature would be certain of what is wrong. Position reports are linear already.
//!
//! # Reference
//! Y. Bar-Shalom, X.-R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 10.3, with the
//! second-order terms of section 10.3.2.
//!
//! # Symbols
//! x̂, P state and covariance; h report of a state; H = ∂h/∂x at x̂; Fᵢ = ∂²hᵢ/∂x² at x̂; R, S noise and innovation covariance;
//! C = cov(x, z).
//!
//! # Method
//! ẑᵢ = hᵢ(x̂) + ½ tr(Fᵢ P), Sᵢⱼ = (H P Hᵀ + R)ᵢⱼ + ½ tr(Fᵢ P Fⱼ P), C = P Hᵀ. Differences of bearings take the shorter way
//! round.

use super::expected::{Expected, Gain, expected};
use super::{FilterMethod, MOTION_FIELDS, Reports, Way, in_plane};
use crate::model::sensing::Sensing;
use crate::model::state::GaussianState;
use crate::registry::Object;

pub const METHOD: FilterMethod = FilterMethod {
    name: "extended",
    parameters: &PARAMETERS,
    build: |spec| in_plane(spec, Way::Line, Reports::All),
};

static PARAMETERS: Object = Object {
    name: "ExtendedFilter",
    summary: "Extended Kalman filter for ranges and bearings, with or without range rates, for positions, and for bearings from a known place.",
    fields: &MOTION_FIELDS,
};

pub(super) fn expect<S: Sensing<K, D>, const N: usize, const K: usize, const D: usize>(
    belief: &GaussianState<N>,
    sensing: &S,
) -> Option<(Expected<D>, Gain<N, D>)> {
    let kinematics = belief.leading::<K>();
    let (shift, spread) = sensing.curvature(&kinematics);
    let measurement = sensing.project(&kinematics.mean) + shift;
    let slope = sensing.jacobian(&kinematics);
    let noise = sensing.noise(&kinematics) + spread;
    let cross = belief.covariance.fixed_columns::<K>(0) * slope.transpose();
    let covariance = slope * cross.fixed_rows::<K>(0) + noise;
    expected(measurement, covariance, cross)
}
