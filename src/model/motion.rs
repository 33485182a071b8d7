//! Motion models. The nearly-constant-velocity model: acceleration is white noise of spectral density q.

use super::state::{Covariance, State};

/// Nearly constant velocity in the plane; `process_noise_m2ps3` is the spectral density q of the acceleration
/// (m²/s³), the same on both axes (Bar-Shalom, Li, Kirubarajan 2001, section 6.2.2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantVelocity {
    pub process_noise_m2ps3: f64,
}

impl ConstantVelocity {
    /// `x + vx·dt, y + vy·dt, vx, vy`.
    pub fn transition(state: &State, dt_s: f64) -> State {
        State::new(state[0] + state[2] * dt_s, state[1] + state[3] * dt_s, state[2], state[3])
    }

    /// Q(dt): q·dt³/3 on position, q·dt²/2 between position and velocity, q·dt on velocity.
    pub fn process_noise(&self, dt_s: f64) -> Covariance {
        let q = self.process_noise_m2ps3;
        let (position, cross, velocity) = (q * dt_s.powi(3) / 3.0, q * dt_s.powi(2) / 2.0, q * dt_s);
        let mut noise = Covariance::zeros();
        for axis in 0..2 {
            noise[(axis, axis)] = position;
            noise[(axis, axis + 2)] = cross;
            noise[(axis + 2, axis)] = cross;
            noise[(axis + 2, axis + 2)] = velocity;
        }
        noise
    }
}
