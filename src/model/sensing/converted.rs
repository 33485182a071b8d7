//! Ranges and bearings that are turned into positions without bias. The conversion is the multiplicative one, and its covariance
//! is taken at the prediction, so that it does not depend on the error of the very report (decorrelated).
//!
//! # Reference
//! Mo Longbin, Song Xiaoquan, Zhou Yiyu, Sun Zhong Kang, Y. Bar-Shalom, Unbiased converted measurements for tracking,
//! IEEE Transactions on Aerospace and Electronic Systems 34(3), 1998 (the conversion); S. V. Bordonaro, P. Willett,
//! Y. Bar-Shalom, Decorrelated unbiased converted measurement Kalman filter, the same Transactions 50(2), 2014 (R).
//!
//! # Symbols
//! r, β range and bearing; z converted position; R its covariance; σ standard deviations.
//!
//! # Method
//! z = e^(σβ²/2) r (sin β, cos β); R from the predicted place and its covariance; h(x) = (x, y).

use super::Sensing;
use super::polar::{Polar, View};
use super::position::at_rest;
use crate::model::own::Own;
use crate::model::scan::Measurement;
use crate::model::state::{GaussianState, Position, PositionCovariance, State};
use nalgebra::{SMatrix, SVector};

/// The reports of a polar sensor as positions; range rates are not used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Converted(pub Polar);

impl Sensing<4, 2> for Converted {
    const IS_DIRECT: bool = true;

    fn read(&self, report: &Measurement, _own: &Own) -> Option<Position> {
        match report.flat() {
            Measurement::RangeBearing {
                range_m,
                bearing_rad,
                ..
            } => Some(unbiased_position(
                &self.0.widened(bearing_rad),
                range_m,
                bearing_rad,
            )),
            _ => None,
        }
    }

    fn project(&self, mean: &State) -> Position {
        Position::new(mean[0], mean[1])
    }

    fn jacobian(&self, _belief: &GaussianState) -> SMatrix<f64, 2, 4> {
        SMatrix::identity()
    }

    fn noise(&self, belief: &GaussianState) -> PositionCovariance {
        let spread = belief.covariance.fixed_view::<2, 2>(0, 0).into_owned();
        self.noise_at(self.project(&belief.mean), &spread)
    }

    fn with_own(&self, own: &Own) -> Self {
        Converted(self.0.with_noise(&own.noise))
    }

    fn locate(&self, report: &SVector<f64, 2>, rate_sigma: f64) -> Option<GaussianState> {
        let noise = self.noise_at(*report, &PositionCovariance::zeros());
        Some(at_rest(report, &noise, rate_sigma))
    }
}

impl Converted {
    /// R of a report of a target that is believed to be around a position.
    fn noise_at(&self, position_m: Position, spread: &PositionCovariance) -> PositionCovariance {
        let Converted(polar) = self;
        if polar.platform.errors.is_none() {
            return unbiased_covariance(polar, position_m, spread);
        }
        let polar = polar.widened(View::of(position_m - polar.place_m).bearing_rad);
        unbiased_covariance(&polar, position_m, spread) + polar.place_noise()
    }
}

/// The place of a report, freed of the bias that comes from bending an error in bearing: e^(σβ²/2) r (sin β, cos β).
pub fn unbiased_position(polar: &Polar, range_m: f64, bearing_rad: f64) -> Position {
    let scale = (polar.sigma_bearing_rad.powi(2) / 2.0).exp();
    polar.place_m + Position::new(bearing_rad.sin(), bearing_rad.cos()) * (range_m * scale)
}

/// Covariance of [`unbiased_position`] of a target that is believed to be around `position_m` with covariance `spread`
/// (Bordonaro 2014): the mean over that belief of E\[z zᵀ\] − x xᵀ, where z zᵀ has the factor e^(σβ²) (r² + σr²) / 2 and
/// both turn with 2β.
pub fn unbiased_covariance(
    polar: &Polar,
    position_m: Position,
    spread: &PositionCovariance,
) -> PositionCovariance {
    let view = View::of(position_m - polar.place_m);
    let believed_range = view.along.dot(&(spread * view.along));
    let believed_bearing = view.across.dot(&(spread * view.across)) / view.range_m.powi(2);
    let square = view.range_m.powi(2) + believed_range;
    let (noise, range_noise) = (polar.sigma_bearing_rad.powi(2), polar.sigma_range_m.powi(2));
    // e^s (r² + σr²) − r², and e^(−s) (r² + σr²) − r², written so that a large r² cannot swallow the rest.
    let half_sum = 0.5 * (noise.exp_m1() * square + noise.exp() * range_noise);
    let half_turn = 0.5
        * ((-noise).exp_m1() * square + (-noise).exp() * range_noise)
        * (-2.0 * believed_bearing).exp();
    let (sine, cosine) = (2.0 * view.bearing_rad).sin_cos();
    PositionCovariance::new(
        half_sum - half_turn * cosine,
        half_turn * sine,
        half_turn * sine,
        half_sum + half_turn * cosine,
    )
}

#[cfg(test)]
mod tests {
    use super::super::platform::Platform;
    use super::*;
    use crate::math::rng::{Purpose, Seed};
    use rand_distr::{Distribution, StandardNormal};

    const POLAR: Polar = Polar {
        place_m: Position::new(10.0, -20.0),
        sigma_range_m: 3.0,
        sigma_bearing_rad: 0.3,
        range_rate: None,
        platform: Platform::STANDING,
    };

    #[test]
    fn converted_measurements_have_no_bias_and_the_stated_covariance() {
        let (polar, target) = (POLAR, Position::new(110.0, 60.0));
        let view = View::of(target - polar.place_m);
        let mut draw = Seed { seed: 3, run: 0 }.stream(Purpose::Detection, 0, 0);
        let count = 200_000;
        let (mut mean, mut square) = (Position::zeros(), PositionCovariance::zeros());
        for _ in 0..count {
            let (first, second): (f64, f64) = (
                StandardNormal.sample(&mut draw),
                StandardNormal.sample(&mut draw),
            );
            let error = unbiased_position(
                &polar,
                view.range_m + 3.0 * first,
                view.bearing_rad + 0.3 * second,
            ) - target;
            mean += error / f64::from(count);
            square += error * error.transpose() / f64::from(count);
        }
        let stated = unbiased_covariance(&polar, target, &PositionCovariance::zeros());
        // Without the factor e^(σ²/2) = 1.046 the bias would be 5.6 m.
        assert!(mean.norm() < 0.4, "{mean}");
        assert!(
            (square - stated).abs().max() < 0.02 * stated.max(),
            "{square} {stated}"
        );
    }
}
