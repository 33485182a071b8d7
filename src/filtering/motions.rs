//! The motion models of targets in the plane, as a request chooses them.

use super::PROCESS_NOISE;
use crate::model::motion::constant_acceleration::ConstantAcceleration;
use crate::model::motion::constant_velocity::ConstantVelocity;
use crate::registry::{Kind, Object, Union, default, number, variant};
use serde::Deserialize;

/// A motion model that was chosen by name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AnyMotion {
    ConstantVelocity(ConstantVelocity),
    ConstantAcceleration(ConstantAcceleration),
}

/// The same as a request says it.
#[derive(Deserialize)]
#[serde(tag = "model", rename_all = "snake_case")]
pub(super) enum MotionSpec {
    ConstantVelocity {
        process_noise_m2ps3: f64,
    },
    ConstantAcceleration {
        process_noise_m2ps5: f64,
        initial_acceleration_sigma_mps2: f64,
    },
}

impl From<MotionSpec> for AnyMotion {
    fn from(spec: MotionSpec) -> Self {
        match spec {
            MotionSpec::ConstantVelocity {
                process_noise_m2ps3,
            } => AnyMotion::ConstantVelocity(ConstantVelocity {
                spectral_density: process_noise_m2ps3,
            }),
            MotionSpec::ConstantAcceleration {
                process_noise_m2ps5,
                initial_acceleration_sigma_mps2,
            } => AnyMotion::ConstantAcceleration(ConstantAcceleration {
                spectral_density: process_noise_m2ps5,
                initial_sigma: initial_acceleration_sigma_mps2,
            }),
        }
    }
}

static CONSTANT_VELOCITY: Object = Object {
    name: "ConstantVelocityMotion",
    summary: "Nearly constant velocity: the acceleration is white noise.",
    fields: &[PROCESS_NOISE],
};

static CONSTANT_ACCELERATION: Object = Object {
    name: "ConstantAccelerationMotion",
    summary: "Nearly constant acceleration: the jerk is white noise; for targets that accelerate over several scans.",
    fields: &[
        default(
            "process_noise_m2ps5",
            "Spectral density q of the white-noise jerk; the acceleration wanders by about sqrt(q·T) in T seconds.",
            number(0.0, 1e9, "m²/s⁵"),
            "0.1",
        ),
        default(
            "initial_acceleration_sigma_mps2",
            "Standard deviation of each component of the acceleration of a new track, which starts without one.",
            number(0.0, 1e4, "m/s²"),
            "1.0",
        ),
    ],
};

static MOTION: Union = Union {
    name: "Motion",
    summary: "How targets move between scans.",
    tag: "model",
    variants: || {
        vec![
            variant("constant_velocity", &CONSTANT_VELOCITY),
            variant("constant_acceleration", &CONSTANT_ACCELERATION),
        ]
    },
};

/// The field kind of a motion model.
pub(super) static MOTION_KIND: Kind = Kind::Union(&MOTION);
