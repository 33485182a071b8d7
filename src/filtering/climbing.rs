//! The motion models of targets in space: those of the plane in the horizontal, with a vertical beside them.

use super::expected::{Expected, Gain, Way};
use super::imm::{Extra, ModeMotion, expect_leading, on_leading};
use super::motions::AnyMotion;
use crate::model::motion::constant_velocity::{self, ConstantVelocity};
use crate::model::motion::in_space::{
    ClimbingVelocity, beside_vertical, horizontal_of, in_horizontal, vertical_step,
};
use crate::model::motion::linear::Linear;
use crate::model::motion::{Motion, slope, unknown_turn};
use crate::model::sensing::Sensing;
use crate::model::state::{GaussianState, mirror};
use nalgebra::{SMatrix, SVector};

/// A model of the plane, and how restless its targets are in the vertical.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Climbing {
    pub motion: AnyMotion,
    /// Of z and vz, where the model does not move all three axes alike.
    pub vertical: ConstantVelocity,
}

impl Climbing {
    /// Nearly constant velocity, if it is that.
    pub fn as_velocity(&self) -> Option<ClimbingVelocity> {
        match self.motion {
            AnyMotion::ConstantVelocity(horizontal) => Some(ClimbingVelocity {
                horizontal,
                vertical: self.vertical,
            }),
            _ => None,
        }
    }
}

/// What a time does to the states of one model.
#[expect(
    clippy::large_enum_variant,
    reason = "one is made for a model and scan, and memory asked for would cost more"
)]
#[derive(Debug, Clone, Copy)]
pub enum ClimbingStep {
    Velocity(constant_velocity::Step<6>),
    /// F, Q, and what a mean velocity adds.
    Linear(Linear<6>, SVector<f64, 6>),
    Turning(unknown_turn::Step, Linear<2>),
    Accelerating(Linear<9>),
}

impl ClimbingStep {
    fn new(climbing: &Climbing, dt_s: f64) -> Self {
        let vertical = vertical_step(&climbing.vertical, dt_s);
        match &climbing.motion {
            AnyMotion::ConstantVelocity(horizontal) => {
                let motion = ClimbingVelocity {
                    horizontal: *horizontal,
                    vertical: climbing.vertical,
                };
                ClimbingStep::Velocity(motion.step(dt_s))
            }
            AnyMotion::CoordinatedTurn(turn) => {
                let whole = beside_vertical(&turn.step(dt_s), &vertical);
                ClimbingStep::Linear(whole, SVector::zeros())
            }
            AnyMotion::OrnsteinUhlenbeck(motion) => {
                let step = motion.step(dt_s);
                let whole = beside_vertical(&step.linear, &vertical);
                ClimbingStep::Linear(whole, in_horizontal(&step.drift))
            }
            AnyMotion::UnknownTurn(turn) => ClimbingStep::Turning(turn.step(dt_s), vertical),
            AnyMotion::ConstantAcceleration(motion) => {
                ClimbingStep::Accelerating(motion.step(dt_s))
            }
            AnyMotion::Singer(motion) => ClimbingStep::Accelerating(motion.step(dt_s)),
        }
    }

    fn extra(&self) -> Extra {
        match self {
            ClimbingStep::Velocity(_) | ClimbingStep::Linear(..) => Extra::Nothing,
            ClimbingStep::Turning(..) => Extra::TurnRate,
            ClimbingStep::Accelerating(_) => Extra::Acceleration,
        }
    }
}

/// Of states of up to nine variables: position, velocity, and a turn rate or an acceleration.
impl Motion<9> for Climbing {
    type Step = ClimbingStep;

    fn step(&self, dt_s: f64) -> ClimbingStep {
        ClimbingStep::new(self, dt_s)
    }

    /// Predicts the variables that the model has; the others stay 0.
    #[inline]
    fn predict(step: &ClimbingStep, belief: &mut GaussianState<9>) {
        match step {
            ClimbingStep::Velocity(step) => on_leading::<6, 9>(belief, |state| {
                ClimbingVelocity::predict(step, state);
            }),
            ClimbingStep::Linear(step, drift) => on_leading::<6, 9>(belief, |state| {
                step.predict(state);
                state.mean += drift;
            }),
            ClimbingStep::Turning(step, vertical) => on_leading::<7, 9>(belief, |state| {
                turn(step, vertical, state);
            }),
            ClimbingStep::Accelerating(step) => step.predict(belief),
        }
    }

    fn transition(step: &ClimbingStep, mean: &SVector<f64, 9>) -> SMatrix<f64, 9, 9> {
        let ClimbingStep::Turning(turn, vertical) = step else {
            return slope(|state| Self::predict(step, state));
        };
        let state = GaussianState::<9> {
            mean: *mean,
            covariance: SMatrix::zeros(),
        };
        let around = turn.around(&horizontal_of::<5, 9>(&state));
        let mut transition = SMatrix::<f64, 9, 9>::identity();
        let own = beside_vertical::<5, 7>(&around, vertical).transition;
        transition.fixed_view_mut::<7, 7>(0, 0).copy_from(&own);
        transition
    }

    fn initial_sigma(&self) -> f64 {
        self.motion.initial_sigma()
    }

    fn rate_variance(&self, dt_s: f64) -> f64 {
        self.motion
            .rate_variance(dt_s)
            .max(Motion::<6>::rate_variance(&self.vertical, dt_s))
    }

    fn bend_mps(&self, speed_mps: f64, dt_s: f64) -> f64 {
        self.motion.bend_mps(speed_mps, dt_s)
    }
}

/// One step of a turn at the rate that is believed.
fn turn(step: &unknown_turn::Step, vertical: &Linear<2>, state: &mut GaussianState<7>) {
    let around = step.around(&horizontal_of::<5, 7>(state));
    let whole = beside_vertical::<5, 7>(&around, vertical);
    // f is F without its last column, which is the place of ω itself.
    let rate = state.mean[6];
    let mut moved = state.mean;
    moved[6] = 0.0;
    moved = whole.transition * moved;
    moved[6] = rate;
    state.mean = moved;
    state.covariance =
        whole.transition * state.covariance * whole.transition.transpose() + whole.noise;
    mirror(&mut state.covariance);
}

impl ModeMotion<9, 6> for Climbing {
    fn extra(&self) -> Extra {
        Extra::of(&self.motion)
    }

    fn extra_of(step: &ClimbingStep) -> Extra {
        step.extra()
    }

    #[inline(always)]
    fn expect<S: Sensing<6, D>, const D: usize>(
        extra: Extra,
        state: &GaussianState<9>,
        way: &Way,
        sensing: &S,
    ) -> Option<(Expected<D>, Gain<9, D>)> {
        match extra {
            Extra::Nothing => expect_leading::<S, 6, 6, 9, D>(state, way, sensing),
            Extra::TurnRate => expect_leading::<S, 7, 6, 9, D>(state, way, sensing),
            Extra::Acceleration => expect_leading::<S, 9, 6, 9, D>(state, way, sensing),
        }
    }
}
