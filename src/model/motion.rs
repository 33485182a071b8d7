//! Motion models. The nearly-constant-velocity model: acceleration is white noise of spectral density q.

use nalgebra::SMatrix;

/// Nearly constant velocity of each of `N / 2` coordinates (a state holds the coordinates, then their rates).
/// `spectral_density` is q, the same for every coordinate: m²/s³ in the plane, rad²/s³ for a bearing
/// (Bar-Shalom, Li, Kirubarajan 2001, section 6.2.2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantVelocity {
    pub spectral_density: f64,
}

impl ConstantVelocity {
    /// Q(dt): q·dt³/3 on a coordinate, q·dt²/2 between it and its rate, q·dt on the rate.
    pub fn process_noise<const N: usize>(&self, dt_s: f64) -> SMatrix<f64, N, N> {
        let q = self.spectral_density;
        let (position, cross, velocity) =
            (q * dt_s.powi(3) / 3.0, q * dt_s.powi(2) / 2.0, q * dt_s);
        let mut noise = SMatrix::zeros();
        for (axis, rate) in (0..N / 2).map(|axis| (axis, axis + N / 2)) {
            noise[(axis, axis)] = position;
            noise[(axis, rate)] = cross;
            noise[(rate, axis)] = cross;
            noise[(rate, rate)] = velocity;
        }
        noise
    }
}
