//! Filters: prediction of a track to the time of a scan, and its update with weighted detections. Both are the same for
//! all ([`prediction`], [`mixture`]); what a filter adds is what it expects a sensor to report of a state.

use crate::model::motion::ConstantVelocity;
use crate::model::scan::Measurement;
use crate::model::sensor::Sensor;
use crate::model::space::Space;
use crate::model::state::GaussianState;
use crate::registry::{Field, Kind, Method, Object, Union, default, number, variant};
use mixture::Expected;
use nalgebra::SVector;

pub mod bearing_only;
pub mod converted;
pub mod extended;
pub mod kalman;
pub mod mixture;
mod plane;
mod polar;
pub mod prediction;
pub mod unscented;

/// A filter of states of `N` variables (coordinates, then their rates) by measurements of `D` values.
pub trait Filter<const N: usize, const D: usize> {
    /// How targets move.
    fn motion(&self) -> ConstantVelocity;

    /// A report as a point of the measurement space; `None` for one that the filter cannot use.
    fn to_measurement_space(
        &self,
        sensor: &Sensor,
        measurement: &Measurement,
    ) -> Option<SVector<f64, D>>;

    /// The coordinate of the sensor's measurements that is an angle, if there is one.
    fn angle(&self, _sensor: &Sensor) -> Option<usize> {
        None
    }

    /// What the sensor should report of a target in this state. `None` when S is not positive definite.
    fn expect(&self, state: &GaussianState<N>, sensor: &Sensor) -> Option<Expected<N, D>>;

    /// ln of how much of the space in which the sensor's clutter density is stated a unit of the measurement space covers.
    fn log_clutter_scale(&self, _sensor: &Sensor, _expected: &Expected<N, D>) -> f64 {
        0.0
    }

    /// A state that knows one detection alone. Of a velocity in the plane it knows that each component is 0 ± `speed_sigma_mps`.
    fn initiate(
        &self,
        measurement: &SVector<f64, D>,
        sensor: &Sensor,
        speed_sigma_mps: f64,
    ) -> Option<GaussianState<N>>;
}

/// A filter that was chosen by name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AnyFilter {
    Kalman(kalman::Kalman),
    Converted(converted::Converted),
    Extended(extended::Extended),
    Unscented(unscented::Unscented),
    BearingOnly(bearing_only::BearingOnly),
}

impl AnyFilter {
    pub fn uses_ranges(&self) -> bool {
        !matches!(self, AnyFilter::Kalman(_) | AnyFilter::BearingOnly(_))
    }

    /// Of the tracks that it makes.
    pub fn space(&self) -> Space {
        match self {
            AnyFilter::BearingOnly(_) => Space::Bearing,
            _ => Space::Plane,
        }
    }

    pub fn uses_range_rates(&self) -> bool {
        matches!(self, AnyFilter::Extended(_) | AnyFilter::Unscented(_))
    }
}

/// An entry of the table: the build takes checked parameters.
pub type FilterMethod = Method<fn(&serde_json::Value) -> Result<AnyFilter, serde_json::Error>>;

/// Every filter.
pub const FILTERS: &[FilterMethod] = &[
    kalman::METHOD,
    extended::METHOD,
    unscented::METHOD,
    converted::METHOD,
    bearing_only::METHOD,
];

/// The name under which the filter is chosen by what the sensors report.
pub const AUTO: &str = "auto";

static AUTO_PARAMETERS: Object = Object {
    name: "AutoFilter",
    summary: "The filter that suits what is reported, with its defaults: kalman for positions, unscented for ranges and bearings, bearing_only for bearings alone.",
    fields: &[],
};

pub static FILTER: Union = Union {
    name: "Filter",
    summary: "How a track is predicted and updated.",
    tag: "method",
    variants: || {
        [variant(AUTO, &AUTO_PARAMETERS)]
            .into_iter()
            .chain(FILTERS.iter().map(Method::variant))
            .collect()
    },
};

/// The field kind of a filter choice.
pub static FILTER_KIND: Kind = Kind::Union(&FILTER);

/// The parameter of every filter in the plane.
const PROCESS_NOISE: Field = default(
    "process_noise_m2ps3",
    "Spectral density q of the white-noise acceleration; the velocity wanders by about sqrt(q·T) in T seconds.",
    number(0.0, 1e9, "m²/s³"),
    "1.0",
);
