//! Motion models, one file a model: how a target's state changes over a time without a look at it.

use super::state::GaussianState;
use nalgebra::{SMatrix, SVector};

pub mod constant_acceleration;
pub mod constant_velocity;
pub mod coordinated_turn;
mod decay;
pub mod in_space;
pub mod linear;
pub mod ornstein_uhlenbeck;
pub mod singer;
pub mod unknown_turn;

/// A motion model of states of `N` variables: the coordinates, then their rates, then what the model adds.
pub trait Motion<const N: usize>: Copy + Send + 'static {
    /// What a time does to a state; the same for all states, so a scan works it out once.
    type Step: Copy + Send;

    /// Over `dt_s` ≥ 0; over 0 nothing changes, and two steps are as one over their sum.
    fn step(&self, dt_s: f64) -> Self::Step;

    fn predict(step: &Self::Step, belief: &mut GaussianState<N>);

    /// F of a motion x ← F x + b; of any other ∂f/∂x at this mean.
    fn transition(step: &Self::Step, _mean: &SVector<f64, N>) -> SMatrix<f64, N, N> {
        slope(|state| Self::predict(step, state))
    }

    /// The standard deviation at the start of each variable beyond coordinates and rates, whose mean is 0 then.
    fn initial_sigma(&self) -> f64 {
        0.0
    }

    /// Variance of a rate at the end of `dt_s` around the mean rate of that time, as far as the model's own noise goes.
    fn rate_variance(&self, dt_s: f64) -> f64;

    /// Spectral density of the acceleration, where that is white and all there is.
    fn white_acceleration(&self) -> Option<f64> {
        None
    }

    /// By how much the model itself, without noise, changes a velocity of this size in `dt_s`, at most; of a turn that is not known one
    /// standard deviation.
    fn bend_mps(&self, _speed_mps: f64, _dt_s: f64) -> f64 {
        0.0
    }
}

/// Variance of the difference of the mean rates before and after a moment within `dt_s`, with what the model does to a target of this
/// speed without noise. Around white acceleration it is that of the rate at the end around the mean.
pub fn wander<M: Motion<N>, const N: usize>(motion: &M, dt_s: f64, speed_mps: f64) -> f64 {
    motion.rate_variance(dt_s) + (motion.bend_mps(speed_mps, dt_s) / 2.0).powi(2)
}

/// F of a motion x ← F x + b, column by column.
pub fn slope<const N: usize>(predict: impl Fn(&mut GaussianState<N>)) -> SMatrix<f64, N, N> {
    let moved = |mean| {
        let mut state = GaussianState {
            mean,
            covariance: SMatrix::zeros(),
        };
        predict(&mut state);
        state.mean
    };
    let origin = moved(SVector::zeros());
    let mut slope = SMatrix::<f64, N, N>::zeros();
    for variable in 0..N {
        let mut unit = SVector::<f64, N>::zeros();
        unit[variable] = 1.0;
        slope.set_column(variable, &(moved(unit) - origin));
    }
    slope
}
