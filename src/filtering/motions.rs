//! The motion models of targets in the plane, as a request chooses them.

use super::PROCESS_NOISE;
use super::imm::ModeStep;
use crate::model::motion::Motion;
use crate::model::motion::constant_acceleration::ConstantAcceleration;
use crate::model::motion::constant_velocity::ConstantVelocity;
use crate::model::motion::coordinated_turn::CoordinatedTurn;
use crate::model::motion::ornstein_uhlenbeck::OrnsteinUhlenbeck;
use crate::model::motion::singer::Singer;
use crate::model::motion::unknown_turn::UnknownTurn;
use crate::model::state::GaussianState;
use crate::registry::{Field, Kind, Object, Union, above, default, number, required, variant};
use nalgebra::{SMatrix, SVector};
use serde::Deserialize;

/// A motion model that was chosen by name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AnyMotion {
    ConstantVelocity(ConstantVelocity),
    ConstantAcceleration(ConstantAcceleration),
    CoordinatedTurn(CoordinatedTurn),
    UnknownTurn(UnknownTurn),
    Singer(Singer),
    OrnsteinUhlenbeck(OrnsteinUhlenbeck),
}

/// Of states that have the variables of the model.
impl<const N: usize> Motion<N> for AnyMotion {
    type Step = ModeStep;

    fn step(&self, dt_s: f64) -> ModeStep {
        ModeStep::new(self, dt_s)
    }

    #[inline]
    fn predict(step: &ModeStep, belief: &mut GaussianState<N>) {
        step.predict(belief);
    }

    fn transition(step: &ModeStep, mean: &SVector<f64, N>) -> SMatrix<f64, N, N> {
        step.transition(mean)
    }

    fn initial_sigma(&self) -> f64 {
        AnyMotion::initial_sigma(self)
    }

    fn rate_variance(&self, dt_s: f64) -> f64 {
        AnyMotion::rate_variance(self, dt_s)
    }

    fn bend_mps(&self, speed_mps: f64, dt_s: f64) -> f64 {
        AnyMotion::bend_mps(self, speed_mps, dt_s)
    }
}

/// The same as a request says it.
#[derive(Deserialize)]
#[serde(tag = "model", rename_all = "snake_case")]
pub(in crate::filtering) enum MotionSpec {
    ConstantVelocity {
        process_noise_m2ps3: f64,
    },
    ConstantAcceleration {
        process_noise_m2ps5: f64,
        initial_acceleration_sigma_mps2: f64,
    },
    CoordinatedTurn {
        turn_rate_degps: f64,
        process_noise_m2ps3: f64,
    },
    UnknownTurn {
        process_noise_m2ps3: f64,
        turn_noise_deg2ps3: f64,
        initial_turn_sigma_degps: f64,
    },
    Singer {
        maneuver_sigma_mps2: f64,
        maneuver_time_s: f64,
    },
    OrnsteinUhlenbeck {
        damping_per_s: f64,
        process_noise_m2ps3: f64,
        mean_velocity_x_mps: f64,
        mean_velocity_y_mps: f64,
    },
}

impl From<MotionSpec> for AnyMotion {
    fn from(spec: MotionSpec) -> Self {
        match spec {
            MotionSpec::ConstantVelocity {
                process_noise_m2ps3: spectral_density,
            } => AnyMotion::ConstantVelocity(ConstantVelocity { spectral_density }),
            MotionSpec::ConstantAcceleration {
                process_noise_m2ps5: spectral_density,
                initial_acceleration_sigma_mps2: initial_sigma,
            } => AnyMotion::ConstantAcceleration(ConstantAcceleration {
                spectral_density,
                initial_sigma,
            }),
            MotionSpec::CoordinatedTurn {
                turn_rate_degps,
                process_noise_m2ps3: spectral_density,
            } => AnyMotion::CoordinatedTurn(CoordinatedTurn {
                turn_rate_radps: turn_rate_degps.to_radians(),
                spectral_density,
            }),
            MotionSpec::UnknownTurn {
                process_noise_m2ps3: spectral_density,
                turn_noise_deg2ps3,
                initial_turn_sigma_degps,
            } => AnyMotion::UnknownTurn(UnknownTurn {
                spectral_density,
                turn_density: turn_noise_deg2ps3 * 1f64.to_radians().powi(2),
                initial_sigma: initial_turn_sigma_degps.to_radians(),
            }),
            MotionSpec::Singer {
                maneuver_sigma_mps2,
                maneuver_time_s,
            } => AnyMotion::Singer(Singer {
                maneuver_sigma_mps2,
                maneuver_time_s,
            }),
            MotionSpec::OrnsteinUhlenbeck {
                damping_per_s,
                process_noise_m2ps3: spectral_density,
                mean_velocity_x_mps,
                mean_velocity_y_mps,
            } => AnyMotion::OrnsteinUhlenbeck(OrnsteinUhlenbeck {
                damping_per_s,
                spectral_density,
                mean_velocity_mps: [mean_velocity_x_mps, mean_velocity_y_mps],
            }),
        }
    }
}

impl AnyMotion {
    /// As a request says it.
    pub fn name(&self) -> &'static str {
        match self {
            AnyMotion::ConstantVelocity(_) => "constant_velocity",
            AnyMotion::ConstantAcceleration(_) => "constant_acceleration",
            AnyMotion::CoordinatedTurn(_) => "coordinated_turn",
            AnyMotion::UnknownTurn(_) => "unknown_turn",
            AnyMotion::Singer(_) => "singer",
            AnyMotion::OrnsteinUhlenbeck(_) => "ornstein_uhlenbeck",
        }
    }

    /// As of [`Motion::initial_sigma`].
    pub fn initial_sigma(&self) -> f64 {
        match self {
            AnyMotion::ConstantVelocity(motion) => Motion::<4>::initial_sigma(motion),
            AnyMotion::ConstantAcceleration(motion) => Motion::<6>::initial_sigma(motion),
            AnyMotion::CoordinatedTurn(motion) => motion.initial_sigma(),
            AnyMotion::UnknownTurn(motion) => Motion::<5>::initial_sigma(motion),
            AnyMotion::Singer(motion) => Motion::<6>::initial_sigma(motion),
            AnyMotion::OrnsteinUhlenbeck(motion) => motion.initial_sigma(),
        }
    }

    /// As of [`Motion::rate_variance`].
    pub fn rate_variance(&self, dt_s: f64) -> f64 {
        match self {
            AnyMotion::ConstantVelocity(motion) => Motion::<4>::rate_variance(motion, dt_s),
            AnyMotion::ConstantAcceleration(motion) => Motion::<6>::rate_variance(motion, dt_s),
            AnyMotion::CoordinatedTurn(motion) => motion.rate_variance(dt_s),
            AnyMotion::UnknownTurn(motion) => motion.rate_variance(dt_s),
            AnyMotion::Singer(motion) => Motion::<6>::rate_variance(motion, dt_s),
            AnyMotion::OrnsteinUhlenbeck(motion) => motion.rate_variance(dt_s),
        }
    }

    /// As of [`Motion::bend_mps`].
    pub fn bend_mps(&self, speed_mps: f64, dt_s: f64) -> f64 {
        match self {
            AnyMotion::CoordinatedTurn(motion) => motion.bend_mps(speed_mps, dt_s),
            AnyMotion::UnknownTurn(motion) => motion.bend_mps(speed_mps, dt_s),
            AnyMotion::OrnsteinUhlenbeck(motion) => motion.bend_mps(speed_mps, dt_s),
            AnyMotion::ConstantVelocity(_)
            | AnyMotion::ConstantAcceleration(_)
            | AnyMotion::Singer(_) => 0.0,
        }
    }

    /// Whether a target has variables beyond its position and velocity.
    pub fn has_more_than_kinematics(&self) -> bool {
        match self {
            AnyMotion::ConstantVelocity(_)
            | AnyMotion::CoordinatedTurn(_)
            | AnyMotion::OrnsteinUhlenbeck(_) => false,
            AnyMotion::ConstantAcceleration(_)
            | AnyMotion::UnknownTurn(_)
            | AnyMotion::Singer(_) => true,
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
    fields: &ACCELERATION_FIELDS,
};

static COORDINATED_TURN: Object = Object {
    name: "CoordinatedTurnMotion",
    summary: "Turn of a known rate, disturbed by white acceleration: one of the models of an IMM.",
    fields: &TURN_FIELDS,
};

static UNKNOWN_TURN: Object = Object {
    name: "UnknownTurnMotion",
    summary: "Turn whose rate is estimated with the state, linearised: for targets that keep their rates over several scans.",
    fields: &UNKNOWN_TURN_FIELDS,
};

static SINGER: Object = Object {
    name: "SingerMotion",
    summary: "Singer's model: accelerations that last for about maneuver_time_s.",
    fields: &SINGER_FIELDS,
};

static ORNSTEIN_UHLENBECK: Object = Object {
    name: "OrnsteinUhlenbeckMotion",
    summary: "Velocity that is pulled back to a mean (integrated Ornstein–Uhlenbeck): for vessels with long gaps between reports.",
    fields: &ORNSTEIN_UHLENBECK_FIELDS,
};

static MOTION: Union = Union {
    name: "Motion",
    summary: "How targets move between scans.",
    tag: "model",
    variants: || {
        vec![
            variant("constant_velocity", &CONSTANT_VELOCITY),
            variant("constant_acceleration", &CONSTANT_ACCELERATION),
            variant("coordinated_turn", &COORDINATED_TURN),
            variant("unknown_turn", &UNKNOWN_TURN),
            variant("singer", &SINGER),
            variant("ornstein_uhlenbeck", &ORNSTEIN_UHLENBECK),
        ]
    },
};

pub(super) const ACCELERATION_FIELDS: [Field; 2] = [
    default(
        "process_noise_m2ps5",
        "Spectral density q of the white-noise jerk; the acceleration wanders by about sqrt(q·T) in T seconds. A jerk that is piecewise constant over scans of T s with sigma_j is about q = sigma_j²·T.",
        number(0.0, 1e9, "m²/s⁵"),
        "0.1",
    ),
    default(
        "initial_acceleration_sigma_mps2",
        "Standard deviation of each component of the acceleration of a new track, which starts without one.",
        number(0.0, 1e4, "m/s²"),
        "1.0",
    ),
];

pub(super) const TURN_FIELDS: [Field; 2] = [
    required(
        "turn_rate_degps",
        "Rate ω of the turn, positive to the left (counter-clockwise); 0 flies straight.",
        number(-90.0, 90.0, "deg/s"),
    ),
    PROCESS_NOISE,
];

pub(super) const UNKNOWN_TURN_FIELDS: [Field; 3] = [
    PROCESS_NOISE,
    default(
        "turn_noise_deg2ps3",
        "Spectral density of the white noise that changes the turn rate, which wanders by about sqrt(q·T) in T seconds.",
        number(0.0, 1e4, "deg²/s³"),
        "0.1",
    ),
    default(
        "initial_turn_sigma_degps",
        "Standard deviation of the turn rate of a new track, which starts straight.",
        above(0.0, 90.0, "deg/s"),
        "3.0",
    ),
];

pub(super) const SINGER_FIELDS: [Field; 2] = [
    default(
        "maneuver_sigma_mps2",
        "Standard deviation σ of each component of the acceleration, of new tracks too. Of accelerations up to a_max, which are a_max with probability p and 0 with p₀: σ² = a_max²·(1 + 4p − p₀)/3.",
        above(0.0, 500.0, "m/s²"),
        "1.0",
    ),
    default(
        "maneuver_time_s",
        "Time τ after which an acceleration is forgotten to 1/e.",
        number(0.1, 1e4, "s"),
        "20.0",
    ),
];

pub(super) const ORNSTEIN_UHLENBECK_FIELDS: [Field; 4] = [
    default(
        "damping_per_s",
        "Rate θ at which the velocity is pulled back; the speed has the stationary standard deviation sqrt(q/2θ) on each axis.",
        number(1e-6, 10.0, "1/s"),
        "0.001",
    ),
    PROCESS_NOISE,
    default(
        "mean_velocity_x_mps",
        "Velocity to which it is pulled back, east.",
        number(-1e5, 1e5, "m/s"),
        "0.0",
    ),
    default(
        "mean_velocity_y_mps",
        "The same, north.",
        number(-1e5, 1e5, "m/s"),
        "0.0",
    ),
];

/// The field kind of a motion model.
pub(super) static MOTION_KIND: Kind = Kind::Union(&MOTION);
