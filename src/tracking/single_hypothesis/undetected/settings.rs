//! What a request says of targets that were never detected.

use crate::model::state::GaussianState;
use crate::registry::{
    Bound, Kind, Object, Union, above, check, default, list, number, required, variant,
};
use crate::tracking::single_hypothesis::existence::LIFETIME;
use nalgebra::{SMatrix, SVector};
use serde::Deserialize;
use serde_json::json;

/// The parameters of [`UNDETECTED`].
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Undetected {
    pub births: Births,
    pub lifetime_s: f64,
    pub report_existence: f64,
    pub recycle_existence: f64,
}

/// As a request that says nothing has it.
impl Default for Undetected {
    fn default() -> Self {
        let fields = check(&json!({}), &UNDETECTED).expect("every field has a default");
        Undetected::deserialize(fields).expect("the defaults are settings")
    }
}

/// Where targets appear, and how many.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "method", rename_all = "snake_case")]
pub enum Births {
    Counted,
    Uniform {
        birth_per_m2_s: f64,
        initial_per_m2: f64,
    },
    Gaussian {
        components: Vec<BirthComponent>,
    },
}

/// A Gaussian around which targets appear.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct BirthComponent {
    pub expected_per_s: f64,
    pub expected_at_start: f64,
    pub x_m: f64,
    pub y_m: f64,
    pub z_m: f64,
    pub vx_mps: f64,
    pub vy_mps: f64,
    pub vz_mps: f64,
    pub sigma_m: f64,
    pub speed_sigma_mps: f64,
}

impl BirthComponent {
    /// Kinematics of `K` variables, coordinates and then their rates.
    pub fn kinematics<const K: usize>(&self) -> GaussianState<K> {
        let places = [self.x_m, self.y_m, self.z_m];
        let rates = [self.vx_mps, self.vy_mps, self.vz_mps];
        let (mut mean, mut covariance) = (SVector::zeros(), SMatrix::zeros());
        for (coordinate, (place, rate)) in places.into_iter().zip(rates).enumerate().take(K / 2) {
            let at_rate = coordinate + K / 2;
            (mean[coordinate], mean[at_rate]) = (place, rate);
            covariance[(coordinate, coordinate)] = self.sigma_m.powi(2);
            covariance[(at_rate, at_rate)] = self.speed_sigma_mps.powi(2);
        }
        GaussianState { mean, covariance }
    }
}

pub static UNDETECTED: Object = Object {
    name: "UndetectedTargets",
    summary: "Targets that were never detected, as a Poisson process: where they appear, how long they last, and when one of them is told.",
    fields: &[
        default(
            "births",
            "Where targets appear.",
            Kind::Union(&BIRTHS),
            r#"{"method":"counted"}"#,
        ),
        LIFETIME,
        default(
            "report_existence",
            "Points of a track are told where its probability of existence is above this.",
            PROBABILITY,
            "0.5",
        ),
        default(
            "recycle_existence",
            "A track less probable than this is one of the undetected targets again, with what is known of it.",
            Kind::Number {
                min: Bound::Including(1e-5),
                max: Bound::Including(0.5),
                unit: "",
            },
            "0.1",
        ),
    ],
};

const PROBABILITY: Kind = Kind::Number {
    min: Bound::Including(0.0),
    max: Bound::Excluding(1.0),
    unit: "",
};

static BIRTHS: Union = Union {
    name: "Births",
    summary: "Where targets appear.",
    tag: "method",
    variants: || {
        vec![
            variant("counted", &COUNTED),
            variant("uniform", &UNIFORM),
            variant("gaussian", &GAUSSIAN),
        ]
    },
};

static COUNTED: Object = Object {
    name: "CountedBirths",
    summary: "Anywhere: a detection that no track wants is as often a target as such detections were so far.",
    fields: &[],
};

static UNIFORM: Object = Object {
    name: "UniformBirths",
    summary: "Anywhere alike, with a known density. Of recordings of the plane.",
    fields: &[
        required(
            "birth_per_m2_s",
            "Targets that appear per square metre and second.",
            number(0.0, 1e6, "1/(m²·s)"),
        ),
        default(
            "initial_per_m2",
            "Targets per square metre that are there at the first scan.",
            number(0.0, 1e6, "1/m²"),
            "0.0",
        ),
    ],
};

static GAUSSIAN: Object = Object {
    name: "GaussianBirths",
    summary: "Around known places. Not of bearings alone.",
    fields: &[required(
        "components",
        "The places.",
        list(&COMPONENT_KIND, 1, 100),
    )],
};

static COMPONENT_KIND: Kind = Kind::Object(&COMPONENT);

static COMPONENT: Object = Object {
    name: "BirthComponent",
    summary: "A Gaussian around which targets appear.",
    fields: &[
        default(
            "expected_per_s",
            "Targets that appear per second.",
            number(0.0, 1e6, "1/s"),
            "0.0",
        ),
        default(
            "expected_at_start",
            "Targets that are there at the first scan.",
            number(0.0, 1e6, ""),
            "0.0",
        ),
        required("x_m", "Mean position, east.", number(-1e9, 1e9, "m")),
        required("y_m", "Mean position, north.", number(-1e9, 1e9, "m")),
        default(
            "z_m",
            "Mean position, up; used in space.",
            number(-1e9, 1e9, "m"),
            "0.0",
        ),
        default(
            "vx_mps",
            "Mean velocity, east.",
            number(-1e5, 1e5, "m/s"),
            "0.0",
        ),
        default(
            "vy_mps",
            "Mean velocity, north.",
            number(-1e5, 1e5, "m/s"),
            "0.0",
        ),
        default(
            "vz_mps",
            "Mean velocity, up; used in space.",
            number(-1e5, 1e5, "m/s"),
            "0.0",
        ),
        required(
            "sigma_m",
            "Standard deviation of each coordinate.",
            above(0.0, 1e9, "m"),
        ),
        required(
            "speed_sigma_mps",
            "Standard deviation of each component of the velocity.",
            above(0.0, 1e5, "m/s"),
        ),
    ],
};
