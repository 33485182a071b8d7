//! What polar sensors report of a state, and what their reports say about places. Bearings are clockwise from north.
//!
//! # Reference
//! Mo Longbin, Song Xiaoquan, Zhou Yiyu, Sun Zhong Kang, Y. Bar-Shalom, Unbiased converted measurements for tracking,
//! IEEE Transactions on Aerospace and Electronic Systems 34(3), 1998; S. V. Bordonaro, P. Willett, Y. Bar-Shalom,
//! Decorrelated unbiased converted measurement Kalman filter, the same Transactions 50(2), 2014.
//!
//! # Symbols
//! r, β, ṙ range, bearing and range rate; u, t unit vectors along the range and clockwise across it; σ standard deviations.

use super::kalman;
use crate::math::angle::wrap;
use crate::model::scan::Measurement;
use crate::model::sensor::Polar;
use crate::model::state::{GaussianState, Position, PositionCovariance, State};
use nalgebra::{SMatrix, SVector};

/// A target nearer than this is taken to be this far away: a bearing to the sensor itself does not exist.
const LEAST_RANGE_M: f64 = 1e-3;

/// A place as the sensor sees it.
struct View {
    range_m: f64,
    bearing_rad: f64,
    /// u.
    along: Position,
    /// t.
    across: Position,
}

fn view(polar: &Polar, position_m: Position) -> View {
    let offset_m = position_m - polar.place_m;
    let range_m = offset_m.norm().max(LEAST_RANGE_M);
    let bearing_rad = offset_m[0].atan2(offset_m[1]);
    let along = Position::new(bearing_rad.sin(), bearing_rad.cos());
    View {
        range_m,
        bearing_rad,
        along,
        across: Position::new(along[1], -along[0]),
    }
}

/// The report as (r, β) or, with three values, (r, β, ṙ).
pub fn to_measurement_space<const D: usize>(measurement: &Measurement) -> Option<SVector<f64, D>> {
    let Measurement::RangeBearing {
        range_m,
        bearing_rad,
        range_rate_mps,
    } = *measurement
    else {
        return None;
    };
    let mut values = SVector::zeros();
    values[0] = range_m;
    values[1] = wrap(bearing_rad);
    if D > 2 {
        values[2] = range_rate_mps?;
    }
    Some(values)
}

/// R.
pub fn noise<const D: usize>(polar: &Polar) -> Option<SMatrix<f64, D, D>> {
    let mut noise = SMatrix::zeros();
    noise[(0, 0)] = polar.sigma_range_m.powi(2);
    noise[(1, 1)] = polar.sigma_bearing_rad.powi(2);
    if D > 2 {
        noise[(2, 2)] = polar.range_rate?.sigma_mps.powi(2);
    }
    Some(noise)
}

/// h(x): what the sensor would report of this state without noise.
pub fn project<const D: usize>(polar: &Polar, state: &State) -> SVector<f64, D> {
    let view = view(polar, Position::new(state[0], state[1]));
    let mut values = SVector::zeros();
    values[0] = view.range_m;
    values[1] = view.bearing_rad;
    if D > 2 {
        values[2] = view.along.dot(&state.fixed_rows::<2>(2));
    }
    values
}

/// H = ∂h/∂x: ∂r/∂p = u, ∂β/∂p = t / r, ∂ṙ/∂p = (v·t) t / r, ∂ṙ/∂v = u. A target that may be anywhere around the sensor has
/// no bearing to linearise: r is taken to be at least the standard deviation across it, which bounds ∂β/∂p.
pub fn jacobian<const D: usize>(polar: &Polar, belief: &GaussianState) -> SMatrix<f64, D, 4> {
    let state = &belief.mean;
    let view = view(polar, Position::new(state[0], state[1]));
    let range_m = least_range(&view, belief);
    let turn_radps = view.across.dot(&state.fixed_rows::<2>(2)) / range_m;
    let mut matrix = SMatrix::zeros();
    for axis in 0..2 {
        matrix[(0, axis)] = view.along[axis];
        matrix[(1, axis)] = view.across[axis] / range_m;
        if D > 2 {
            matrix[(2, axis)] = turn_radps * view.across[axis];
            matrix[(2, axis + 2)] = view.along[axis];
        }
    }
    matrix
}

/// What the curvature of h adds to its mean and covariance, ½ tr(Fᵢ P) and ½ tr(Fᵢ P Fⱼ P), with F the second derivatives. Along u
/// and t, at p = r u: ∂²r/∂t² = 1/r; ∂²β/∂u∂t = −1/r²; ∂²ṙ/∂t² = −(v·u)/r², ∂²ṙ/∂u∂t = −(v·t)/r², ∂²ṙ/∂t∂(v·t) = 1/r. For r holds
/// what holds for the Jacobian; in the terms of ṙ, which grow with the speed, it is at least ten standard deviations of the place.
pub fn curvature<const D: usize>(
    polar: &Polar,
    belief: &GaussianState,
) -> (SVector<f64, D>, SMatrix<f64, D, D>) {
    let view = view(polar, Position::new(belief.mean[0], belief.mean[1]));
    let range_m = least_range(&view, belief);
    let mut turned = SMatrix::<f64, 4, 4>::zeros();
    for axis in 0..2 {
        (turned[(0, axis)], turned[(1, axis)]) = (view.along[axis], view.across[axis]);
        (turned[(2, axis + 2)], turned[(3, axis + 2)]) = (view.along[axis], view.across[axis]);
    }
    let covariance = turned * belief.covariance * turned.transpose();
    let mut second = [SMatrix::<f64, 4, 4>::zeros(); D];
    second[0][(1, 1)] = 1.0 / range_m;
    second[1] = symmetric(0, 1, -1.0 / range_m.powi(2));
    if D > 2 {
        let velocity_mps: Position = belief.mean.fixed_rows::<2>(2).into_owned();
        let range_m = view
            .range_m
            .max(10.0 * (covariance[(0, 0)] + covariance[(1, 1)]).max(0.0).sqrt());
        second[2] = symmetric(0, 1, -view.across.dot(&velocity_mps) / range_m.powi(2))
            + symmetric(1, 3, 1.0 / range_m);
        second[2][(1, 1)] = -view.along.dot(&velocity_mps) / range_m.powi(2);
    }
    let products = second.map(|second| second * covariance);
    let shift = SVector::from_fn(|row, _| 0.5 * products[row].trace());
    (
        shift,
        SMatrix::from_fn(|row, column| 0.5 * (products[row] * products[column]).trace()),
    )
}

/// The range of a target, at least the standard deviation across it.
fn least_range(view: &View, belief: &GaussianState) -> f64 {
    let across_m = view
        .across
        .dot(&(belief.covariance.fixed_view::<2, 2>(0, 0) * view.across))
        .max(0.0)
        .sqrt();
    view.range_m.max(across_m)
}

fn symmetric(row: usize, column: usize, value: f64) -> SMatrix<f64, 4, 4> {
    let mut matrix = SMatrix::zeros();
    (matrix[(row, column)], matrix[(column, row)]) = (value, value);
    matrix
}

/// ln of the plane's area a unit of (r, β) covers, r; with range rates, r over the interval that clutter's rates fill.
pub fn log_clutter_scale<const D: usize>(polar: &Polar, expected: &SVector<f64, D>) -> f64 {
    let span_mps = polar
        .range_rate
        .filter(|_| D > 2)
        .map_or(1.0, |rate| rate.span_mps);
    (expected[0].abs().max(LEAST_RANGE_M) / span_mps).ln()
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
    let view = view(polar, position_m);
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

/// One-point initiation from (r, β) or (r, β, ṙ); a range rate is the velocity's part along the range.
pub fn initiate<const D: usize>(
    polar: &Polar,
    measurement: &SVector<f64, D>,
    speed_sigma_mps: f64,
) -> GaussianState {
    let position_m = unbiased_position(polar, measurement[0], measurement[1]);
    let noise = unbiased_covariance(polar, position_m, &PositionCovariance::zeros());
    let mut state = kalman::at_rest(&position_m, &noise, speed_sigma_mps);
    if let Some(rate) = polar.range_rate.filter(|_| D > 2) {
        let along = Position::new(measurement[1].sin(), measurement[1].cos());
        // Across the range nothing is known, and some of that looks like range rate when the bearing is wrong.
        let known = rate.sigma_mps.powi(2) + (speed_sigma_mps * polar.sigma_bearing_rad).powi(2);
        let gained = (speed_sigma_mps.powi(2) - known).max(0.0);
        state
            .mean
            .fixed_rows_mut::<2>(2)
            .copy_from(&(along * measurement[2]));
        let mut velocity = state.covariance.fixed_view_mut::<2, 2>(2, 2);
        velocity -= along * along.transpose() * gained;
    }
    state
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::{Purpose, Seed};
    use crate::model::sensor::RangeRate;
    use rand_distr::{Distribution, StandardNormal};

    fn sensor(sigma_bearing_rad: f64) -> Polar {
        let range_rate = Some(RangeRate {
            sigma_mps: 0.5,
            span_mps: 100.0,
        });
        Polar {
            place_m: Position::new(10.0, -20.0),
            sigma_range_m: 3.0,
            sigma_bearing_rad,
            range_rate,
        }
    }

    #[test]
    fn a_state_to_the_south_east_is_seen_as_worked_by_hand() {
        // Offset (300, −400): r = 500, β = atan2(300, −400) = 143.13°; ṙ = (3·10 − 4·(−5)) / 5 = 10.
        let state = State::new(310.0, -420.0, 10.0, -5.0);
        let seen: SVector<f64, 3> = project(&sensor(0.01), &state);
        assert!(
            (seen[0] - 500.0).abs() < 1e-9
                && (seen[1].to_degrees() - 143.130_102_354).abs() < 1e-6
                && (seen[2] - 10.0).abs() < 1e-12
        );
    }

    #[test]
    fn the_jacobian_is_the_slope_of_the_projection() {
        let (polar, mean) = (sensor(0.01), State::new(310.0, -420.0, 10.0, -5.0));
        let belief = GaussianState {
            mean,
            covariance: nalgebra::Matrix4::identity(),
        };
        let matrix: SMatrix<f64, 3, 4> = jacobian(&polar, &belief);
        for variable in 0..4 {
            let step = State::ith(variable, 1e-3);
            let slope = (project::<3>(&polar, &(mean + step))
                - project::<3>(&polar, &(mean - step)))
                / 2e-3;
            assert!(
                (slope - matrix.column(variable)).abs().max() < 1e-8,
                "{variable}"
            );
        }
    }

    #[test]
    fn the_curvature_is_what_a_million_draws_add_to_the_line() {
        // 5 km away, unsure by 40 m across and 60 m along, and 20 m/s; places and speeds go together.
        let polar = sensor(0.01);
        let mean = State::new(3010.0, -4020.0, 30.0, -40.0);
        let root = SMatrix::<f64, 4, 4>::from_rows(&[
            [32.0, 36.0, 0.0, 0.0].into(),
            [24.0, -48.0, 0.0, 0.0].into(),
            [8.0, 0.0, 20.0, 0.0].into(),
            [0.0, 6.0, 0.0, 20.0].into(),
        ]);
        let belief = GaussianState {
            mean,
            covariance: root * root.transpose(),
        };
        let (shift, spread) = curvature::<3>(&polar, &belief);
        let (at, slope) = (project::<3>(&polar, &mean), jacobian::<3>(&polar, &belief));
        let mut draw = Seed { seed: 4, run: 0 }.stream(Purpose::Detection, 0, 0);
        let count = 1_000_000;
        let (mut sum, mut square) = (SVector::<f64, 3>::zeros(), SMatrix::<f64, 3, 3>::zeros());
        for _ in 0..count {
            let step = root * State::from_fn(|_, _| StandardNormal.sample(&mut draw));
            let beyond = project::<3>(&polar, &(mean + step)) - at - slope * step;
            sum += beyond / f64::from(count);
            square += (beyond - shift) * (beyond - shift).transpose() / f64::from(count);
        }
        // Range: ½ · 40² / 5000 = 0.16 m, with a standard deviation √2 times as large.
        assert!(
            (shift[0] - 0.16).abs() < 1e-9
                && (spread[(0, 0)].sqrt() - 0.16 * 2f64.sqrt()).abs() < 1e-9,
            "{shift} {spread}"
        );
        for row in 0..3 {
            let scale = spread[(row, row)].sqrt();
            assert!(
                (sum[row] - shift[row]).abs() < 0.02 * scale,
                "{row}: {sum} {shift}"
            );
            for column in 0..3 {
                let scale = scale * spread[(column, column)].sqrt();
                assert!(
                    (square[(row, column)] - spread[(row, column)]).abs() < 0.03 * scale,
                    "{row} {column}: {square} {spread}"
                );
            }
        }
    }

    #[test]
    fn converted_measurements_have_no_bias_and_the_stated_covariance() {
        let (polar, target) = (sensor(0.3), Position::new(110.0, 60.0));
        let truth: SVector<f64, 2> = project(&polar, &State::new(target[0], target[1], 0.0, 0.0));
        let mut draw = Seed { seed: 3, run: 0 }.stream(Purpose::Detection, 0, 0);
        let count = 200_000;
        let (mut mean, mut square) = (Position::zeros(), PositionCovariance::zeros());
        for _ in 0..count {
            let (first, second): (f64, f64) = (
                StandardNormal.sample(&mut draw),
                StandardNormal.sample(&mut draw),
            );
            let error =
                unbiased_position(&polar, truth[0] + 3.0 * first, truth[1] + 0.3 * second) - target;
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

    #[test]
    fn a_range_rate_starts_a_track_along_the_range() {
        // Straight east: ṙ is vx; what is not known across stays so.
        let polar = Polar {
            place_m: Position::zeros(),
            ..sensor(1e-3)
        };
        let measurement = SVector::<f64, 3>::new(1000.0, std::f64::consts::FRAC_PI_2, -40.0);
        let state = initiate(&polar, &measurement, 100.0);
        assert!(
            (state.mean - State::new(1000.0, 0.0, -40.0, 0.0)).norm() < 1e-2,
            "{}",
            state.mean
        );
        assert!(
            (state.covariance[(2, 2)] - (0.25 + 0.01)).abs() < 1e-6
                && (state.covariance[(3, 3)] - 1e4).abs() < 1e-6
        );
        assert!(
            (state.covariance[(0, 0)] - 9.0).abs() < 0.1
                && (state.covariance[(1, 1)] - 1.0).abs() < 0.01
        );
    }

    #[test]
    fn clutter_per_square_metre_covers_r_per_radian() {
        let expected = SVector::<f64, 3>::new(1000.0, 0.0, 0.0);
        assert!((log_clutter_scale(&sensor(0.1), &expected).exp() - 10.0).abs() < 1e-9);
        let flat = SVector::<f64, 2>::new(1000.0, 0.0);
        assert!((log_clutter_scale(&sensor(0.1), &flat).exp() - 1000.0).abs() < 1e-9);
    }
}
