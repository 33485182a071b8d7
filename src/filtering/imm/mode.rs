//! One model of several: how a belief of `N` variables is predicted by a model that has fewer, and what models lend each other.

use super::Mixing;
use crate::filtering::expected::{Expected, Gain, Way};
use crate::filtering::motions::AnyMotion;
use crate::model::motion::linear::Linear;
use crate::model::motion::ornstein_uhlenbeck::OrnsteinUhlenbeck;
use crate::model::motion::unknown_turn::UnknownTurn;
use crate::model::motion::{Motion, constant_velocity, ornstein_uhlenbeck, slope, unknown_turn};
use crate::model::sensing::Sensing;
use crate::model::state::GaussianState;
use nalgebra::{SMatrix, SVector};

/// A motion that may be one of several, of beliefs of up to `N` variables of which the first `K` are the kinematics.
pub trait ModeMotion<const N: usize, const K: usize>: Motion<N> {
    fn extra(&self) -> Extra;

    fn extra_of(step: &Self::Step) -> Extra;

    /// What a state of a model with this extra expects of a report: only its own variables are looked at.
    fn expect<S: Sensing<K, D>, const D: usize>(
        extra: Extra,
        state: &GaussianState<N>,
        way: &Way,
        sensing: &S,
    ) -> Option<(Expected<D>, Gain<N, D>)>;
}

impl<const N: usize> ModeMotion<N, 4> for AnyMotion {
    fn extra(&self) -> Extra {
        Extra::of(self)
    }

    fn extra_of(step: &ModeStep) -> Extra {
        step.extra()
    }

    #[inline(always)]
    fn expect<S: Sensing<4, D>, const D: usize>(
        extra: Extra,
        state: &GaussianState<N>,
        way: &Way,
        sensing: &S,
    ) -> Option<(Expected<D>, Gain<N, D>)> {
        match extra {
            Extra::TurnRate if N > 4 => expect_leading::<S, 5, 4, N, D>(state, way, sensing),
            Extra::Acceleration if N > 5 => expect_leading::<S, 6, 4, N, D>(state, way, sensing),
            _ => expect_leading::<S, 4, 4, N, D>(state, way, sensing),
        }
    }
}

/// What the first `M` variables of a state expect.
#[inline(always)]
pub fn expect_leading<
    S: Sensing<K, D>,
    const M: usize,
    const K: usize,
    const N: usize,
    const D: usize,
>(
    state: &GaussianState<N>,
    way: &Way,
    sensing: &S,
) -> Option<(Expected<D>, Gain<N, D>)> {
    let (expected, gain) = way.expect::<S, M, K, D>(&state.leading(), sensing)?;
    Some((expected, gain.widened()))
}

/// What a model has beyond position and velocity, in the places after them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extra {
    Nothing,
    /// ω.
    TurnRate,
    /// East, north and in space up.
    Acceleration,
}

impl Extra {
    pub fn of(motion: &AnyMotion) -> Self {
        match motion {
            AnyMotion::ConstantVelocity(_)
            | AnyMotion::CoordinatedTurn(_)
            | AnyMotion::OrnsteinUhlenbeck(_) => Extra::Nothing,
            AnyMotion::UnknownTurn(_) => Extra::TurnRate,
            AnyMotion::ConstantAcceleration(_) | AnyMotion::Singer(_) => Extra::Acceleration,
        }
    }

    /// All variables of a state with so many kinematics.
    #[inline(always)]
    pub fn variables(self, kinematics: usize) -> usize {
        match self {
            Extra::Nothing => kinematics,
            Extra::TurnRate => kinematics + 1,
            Extra::Acceleration => kinematics + kinematics / 2,
        }
    }
}

/// What a time does to the states of one model.
#[expect(
    clippy::large_enum_variant,
    reason = "one is made for a model and scan, and memory asked for would cost more"
)]
#[derive(Debug, Clone, Copy)]
pub enum ModeStep {
    Velocity(constant_velocity::Step<4>),
    Linear(Linear<4>),
    Drifting(ornstein_uhlenbeck::Step),
    Turning(unknown_turn::Step),
    Accelerating(Linear<6>),
}

impl ModeStep {
    pub fn new(motion: &AnyMotion, dt_s: f64) -> Self {
        match motion {
            AnyMotion::ConstantVelocity(motion) => ModeStep::Velocity(motion.step(dt_s)),
            AnyMotion::CoordinatedTurn(motion) => ModeStep::Linear(motion.step(dt_s)),
            AnyMotion::OrnsteinUhlenbeck(motion) => ModeStep::Drifting(motion.step(dt_s)),
            AnyMotion::UnknownTurn(motion) => ModeStep::Turning(motion.step(dt_s)),
            AnyMotion::ConstantAcceleration(motion) => ModeStep::Accelerating(motion.step(dt_s)),
            AnyMotion::Singer(motion) => ModeStep::Accelerating(motion.step(dt_s)),
        }
    }

    pub fn extra(&self) -> Extra {
        match self {
            ModeStep::Velocity(_) | ModeStep::Linear(_) | ModeStep::Drifting(_) => Extra::Nothing,
            ModeStep::Turning(_) => Extra::TurnRate,
            ModeStep::Accelerating(_) => Extra::Acceleration,
        }
    }

    /// Predicts the variables that the model has; the others stay 0.
    #[inline(always)]
    pub fn predict<const N: usize>(&self, state: &mut GaussianState<N>) {
        match self {
            ModeStep::Velocity(step) => on_leading::<4, N>(state, |state| {
                constant_velocity::ConstantVelocity::predict(step, state);
            }),
            ModeStep::Linear(step) => on_leading::<4, N>(state, |state| step.predict(state)),
            ModeStep::Drifting(step) => on_leading::<4, N>(state, |state| {
                OrnsteinUhlenbeck::predict(step, state);
            }),
            ModeStep::Turning(step) if N >= 5 => on_leading::<5, N>(state, |state| {
                UnknownTurn::predict(step, state);
            }),
            ModeStep::Accelerating(step) if N >= 6 => {
                on_leading::<6, N>(state, |state| step.predict(state));
            }
            ModeStep::Turning(_) | ModeStep::Accelerating(_) => {
                debug_assert!(
                    false,
                    "the beliefs of a filter hold the variables of its models"
                );
            }
        }
    }

    /// F at this mean; of variables that the model does not have it is 0.
    pub fn transition<const N: usize>(&self, mean: &SVector<f64, N>) -> SMatrix<f64, N, N> {
        let mut transition = SMatrix::<f64, N, N>::zeros();
        if let (ModeStep::Turning(step), true) = (self, N >= 5) {
            let own = UnknownTurn::transition(step, &mean.fixed_rows::<5>(0).into_owned());
            transition.fixed_view_mut::<5, 5>(0, 0).copy_from(&own);
            return transition;
        }
        transition = slope(|state| self.predict(state));
        for variable in self.extra().variables(4)..N {
            transition[(variable, variable)] = 0.0;
        }
        transition
    }
}

#[inline(always)]
pub fn on_leading<const M: usize, const N: usize>(
    state: &mut GaussianState<N>,
    work: impl FnOnce(&mut GaussianState<M>),
) {
    let mut leading = state.leading::<M>();
    work(&mut leading);
    set_leading(state, &leading);
}

/// Replaces the first `M` variables, and their covariance with each other.
#[inline(always)]
pub fn set_leading<const M: usize, const N: usize>(
    state: &mut GaussianState<N>,
    leading: &GaussianState<M>,
) {
    let mut mean = state.mean.fixed_rows_mut::<M>(0);
    mean.copy_from(&leading.mean);
    let mut covariance = state.covariance.fixed_view_mut::<M, M>(0, 0);
    covariance.copy_from(&leading.covariance);
}

/// The state of one model as another one takes it: without what that does not have. What it has and the lender has not, it
/// takes from itself, or it is 0.
#[inline(always)]
pub fn lent<const N: usize, const K: usize>(
    (from, of): (&GaussianState<N>, Extra),
    (to, its): (&GaussianState<N>, Extra),
    mixing: Mixing,
) -> GaussianState<N> {
    if N == K || of == its {
        return *from;
    }
    let mut lent = GaussianState {
        mean: SVector::zeros(),
        covariance: SMatrix::zeros(),
    };
    if mixing == Mixing::Unbiased {
        lent = *to;
        lent.covariance.fixed_rows_mut::<K>(0).fill(0.0);
        lent.covariance.fixed_columns_mut::<K>(0).fill(0.0);
    }
    set_leading(&mut lent, &from.leading::<K>());
    lent
}
