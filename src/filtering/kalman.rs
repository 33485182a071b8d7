//! The Kalman filter for position reports of a target with nearly constant velocity. One update serves hard and
//! soft association: the moment-matched mixture over a track's weighted detections and "none".
//!
//! # Reference
//! Y. Bar-Shalom, X.-R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, section 5.2;
//! Y. Bar-Shalom, T. E. Fortmann, Tracking and Data Association, 1988, section 6.3 (the mixture update).
//!
//! # Symbols
//! x̂, P state and covariance; F, Q transition and process noise; H = \[I 0\]; R, S noise and innovation covariance;
//! K gain; ν innovation; βⱼ weight of detection j, β₀ of none.
//!
//! # Method
//! 1. x̂ ← F x̂, P ← F P Fᵀ + Q, written out in 2 × 2 blocks.
//! 2. S = H P Hᵀ + R, K = P Hᵀ S⁻¹.
//! 3. ν = Σ βⱼ νⱼ, x̂ ← x̂ + K ν.
//! 4. P ← P − (1 − β₀) K S Kᵀ + K (Σ βⱼ νⱼ νⱼᵀ − ν νᵀ) Kᵀ.

use crate::math::gaussian::Gaussian2;
use crate::model::motion::ConstantVelocity;
use crate::model::state::{Covariance, GaussianState, Position, PositionCovariance, State};
use crate::registry::{Bound, Field, Kind, Method, Object, Presence};
use nalgebra::SMatrix;
use serde::Deserialize;

pub const METHOD: Method<super::BuildFilter> = Method { name: "kalman", parameters: &PARAMETERS, build: |spec| Kalman::deserialize(spec) };

static PARAMETERS: Object = Object {
    name: "KalmanFilter",
    summary: "Kalman filter for position reports, nearly constant velocity.",
    fields: &[Field {
        name: "process_noise_m2ps3",
        summary: "Spectral density q of the white-noise acceleration; the velocity wanders by about sqrt(q·T) in T seconds.",
        kind: Kind::Number { min: Bound::Including(0.0), max: Bound::Including(1e9), unit: "m²/s³" },
        presence: Presence::Default("1.0"),
    }],
};

/// The filter of one tracker.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Kalman {
    pub process_noise_m2ps3: f64,
}

/// How a track's state changes over one time step; the same for all tracks of a scan.
#[derive(Debug, Clone, Copy)]
pub struct Transition {
    dt_s: f64,
    noise: Covariance,
}

/// What a track expects to be measured: ẑ, S, and the parts of the update that do not depend on the detections.
#[derive(Debug, Clone, Copy)]
pub struct Expected {
    pub position_m: Position,
    pub covariance: PositionCovariance,
    pub gaussian: Gaussian2,
}

/// A gated detection of a track: its innovation ν (m) and weight β.
#[derive(Debug, Clone, Copy)]
pub struct WeightedInnovation {
    pub innovation_m: Position,
    pub weight: f64,
}

type Gain = SMatrix<f64, 4, 2>;

impl Kalman {
    pub fn transition(&self, dt_s: f64) -> Transition {
        let motion = ConstantVelocity { process_noise_m2ps3: self.process_noise_m2ps3 };
        Transition { dt_s, noise: motion.process_noise(dt_s) }
    }

    /// Step 1.
    pub fn predict(&self, state: &mut GaussianState, transition: &Transition) {
        let dt = transition.dt_s;
        state.mean = ConstantVelocity::transition(&state.mean, dt);
        let p = &mut state.covariance;
        // P in blocks [A B; Bᵀ C]: A ← A + dt (B + Bᵀ) + dt² C, B ← B + dt C, then + Q.
        for row in 0..2 {
            for column in row..2 {
                p[(row, column)] += dt * (p[(row, column + 2)] + p[(column, row + 2)]) + dt * dt * p[(row + 2, column + 2)];
            }
        }
        for row in 0..2 {
            for column in 0..2 {
                p[(row, column + 2)] += dt * p[(row + 2, column + 2)];
            }
        }
        *p += transition.noise;
        mirror(p);
    }

    /// Step 2 for a sensor with noise R. `None` when S is not positive definite.
    pub fn expect(&self, state: &GaussianState, noise: &PositionCovariance) -> Option<Expected> {
        let covariance = state.covariance.fixed_view::<2, 2>(0, 0) + noise;
        let gaussian = Gaussian2::new(&covariance)?;
        Some(Expected { position_m: Position::new(state.mean[0], state.mean[1]), covariance, gaussian })
    }

    /// Steps 3 and 4. The weights of `detections` and β₀ sum to 1.
    pub fn update(&self, state: &mut GaussianState, expected: &Expected, detections: &[WeightedInnovation]) {
        if detections.is_empty() {
            return;
        }
        let cross: Gain = state.covariance.fixed_columns::<2>(0).into_owned();
        let gain: Gain = cross * expected.gaussian.inverse();
        let mut mean_innovation = Position::zeros();
        let mut detected = 0.0;
        for detection in detections {
            mean_innovation += detection.innovation_m * detection.weight;
            detected += detection.weight;
        }
        state.mean += gain * mean_innovation;
        state.covariance -= gain * cross.transpose() * detected;
        if detected < 1.0 || detections.len() > 1 {
            state.covariance += spread(&gain, detections, &mean_innovation);
        }
        mirror(&mut state.covariance);
    }

    /// One-point initiation: at the detection, with velocity 0 ± `speed_sigma_mps` on each axis.
    pub fn initiate(&self, position_m: &Position, noise: &PositionCovariance, speed_sigma_mps: f64) -> GaussianState {
        let mut covariance = Covariance::zeros();
        covariance.fixed_view_mut::<2, 2>(0, 0).copy_from(noise);
        covariance[(2, 2)] = speed_sigma_mps * speed_sigma_mps;
        covariance[(3, 3)] = speed_sigma_mps * speed_sigma_mps;
        GaussianState { mean: State::new(position_m[0], position_m[1], 0.0, 0.0), covariance }
    }
}

/// K (Σ βⱼ νⱼ νⱼᵀ − ν νᵀ) Kᵀ: what is not known because it is not known which detection was the right one.
fn spread(gain: &Gain, detections: &[WeightedInnovation], mean_innovation: &Position) -> Covariance {
    let mut second_moment = -(mean_innovation * mean_innovation.transpose());
    for detection in detections {
        second_moment += detection.innovation_m * detection.innovation_m.transpose() * detection.weight;
    }
    gain * second_moment * gain.transpose()
}

/// Copies the upper triangle below the diagonal, so that rounding never makes P unsymmetric.
fn mirror(covariance: &mut Covariance) {
    for row in 1..4 {
        for column in 0..row {
            covariance[(row, column)] = covariance[(column, row)];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix4;

    fn filter() -> Kalman {
        Kalman { process_noise_m2ps3: 0.5 }
    }

    fn started() -> GaussianState {
        let mut state = filter().initiate(&Position::new(1.0, 2.0), &PositionCovariance::new(4.0, 0.0, 0.0, 9.0), 10.0);
        state.mean = State::new(1.0, 2.0, 3.0, -1.0);
        state
    }

    #[test]
    fn the_block_prediction_equals_f_p_ft_plus_q() {
        let (mut state, dt) = (started(), 2.0);
        let mut f = Matrix4::identity();
        f[(0, 2)] = dt;
        f[(1, 3)] = dt;
        for _ in 0..3 {
            let motion = ConstantVelocity { process_noise_m2ps3: 0.5 };
            let expected = f * state.covariance * f.transpose() + motion.process_noise(dt);
            let expected_mean = f * state.mean;
            filter().predict(&mut state, &filter().transition(dt));
            assert!((state.covariance - expected).abs().max() < 1e-9);
            assert!((state.mean - expected_mean).abs().max() < 1e-12);
        }
    }

    #[test]
    fn one_certain_detection_gives_the_textbook_update() {
        // One axis by hand: P = 4, R = 12 → S = 16, K = 1/4; ν = 8 → x = 1 + 2 = 3, P = 4 − 4·4/16 = 3.
        let mut state = started();
        let noise = PositionCovariance::new(12.0, 0.0, 0.0, 9.0);
        let expected = filter().expect(&state, &noise).unwrap();
        let detection = WeightedInnovation { innovation_m: Position::new(8.0, 0.0), weight: 1.0 };
        filter().update(&mut state, &expected, &[detection]);
        assert!((state.mean[0] - 3.0).abs() < 1e-12 && (state.covariance[(0, 0)] - 3.0).abs() < 1e-12);
        assert!((state.covariance[(1, 1)] - 4.5).abs() < 1e-12);
    }

    #[test]
    fn two_weighted_detections_spread_the_covariance() {
        // The axis above with ν = ±8, β = 0.4 each, β₀ = 0.2: ν̄ = 0, P = 4 − 0.8·1 + (1/4)²·(0.8·64) = 6.4.
        let mut state = started();
        let expected = filter().expect(&state, &PositionCovariance::new(12.0, 0.0, 0.0, 9.0)).unwrap();
        let detection = |x_m| WeightedInnovation { innovation_m: Position::new(x_m, 0.0), weight: 0.4 };
        filter().update(&mut state, &expected, &[detection(8.0), detection(-8.0)]);
        assert!((state.mean[0] - 1.0).abs() < 1e-12);
        assert!((state.covariance[(0, 0)] - 6.4).abs() < 1e-12);
    }

    #[test]
    fn no_detection_changes_nothing() {
        let mut state = started();
        let expected = filter().expect(&state, &PositionCovariance::identity()).unwrap();
        filter().update(&mut state, &expected, &[]);
        assert_eq!(state, started());
    }
}
