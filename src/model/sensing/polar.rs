//! Ranges and bearings, with range rates where the sensor measures them. Bearings are clockwise from north.
//!
//! # Symbols
//! r, β, ṙ range, bearing and range rate; u, t unit vectors along the range and clockwise across it; p position, v velocity, less
//! that of the sensor where it moves.

use super::Sensing;
use super::converted::{unbiased_covariance, unbiased_position};
use super::platform::Platform;
use super::position::at_rest;
use crate::model::angle::wrap;
use crate::model::own::{Own, OwnNoise};
use crate::model::scan::Measurement;
use crate::model::state::{GaussianState, Position, PositionCovariance, State};
use nalgebra::{SMatrix, SVector};

/// A target nearer than this is taken to be this far away: a bearing to the sensor itself does not exist.
const LEAST_RANGE_M: f64 = 1e-3;

/// Range and bearing from the sensor's place, and the rate of the range where the sensor measures it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polar {
    pub place_m: Position,
    pub sigma_range_m: f64,
    pub sigma_bearing_rad: f64,
    pub range_rate: Option<RangeRate>,
    pub platform: Platform,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeRate {
    pub sigma_mps: f64,
    /// False detections have range rates uniform over an interval of this length.
    pub span_mps: f64,
}

impl RangeRate {
    pub(super) fn with_noise(self, own: &OwnNoise) -> RangeRate {
        RangeRate {
            sigma_mps: own.sigma_range_rate_mps.unwrap_or(self.sigma_mps),
            ..self
        }
    }
}

/// A target as a sensor sees it.
pub(super) struct View {
    pub range_m: f64,
    pub bearing_rad: f64,
    /// u.
    pub along: Position,
    /// t.
    pub across: Position,
}

impl View {
    /// From a place, of a target in this state.
    pub fn from(place_m: Position, mean: &State) -> Self {
        View::of(Position::new(mean[0], mean[1]) - place_m)
    }

    pub fn of(offset_m: Position) -> Self {
        let bearing_rad = offset_m[0].atan2(offset_m[1]);
        let along = Position::new(bearing_rad.sin(), bearing_rad.cos());
        View {
            range_m: offset_m.norm().max(LEAST_RANGE_M),
            bearing_rad,
            along,
            across: Position::new(along[1], -along[0]),
        }
    }

    /// The range of a target, at least the standard deviation across it: a target that may be anywhere around the sensor has
    /// no bearing to linearise, and this bounds ∂β/∂p.
    pub fn least_range(&self, belief: &GaussianState) -> f64 {
        let across_m = self
            .across
            .dot(&(belief.covariance.fixed_view::<2, 2>(0, 0) * self.across))
            .max(0.0)
            .sqrt();
        self.range_m.max(across_m)
    }
}

/// (r, β) with `D` = 2, (r, β, ṙ) with `D` = 3.
impl<const D: usize> Sensing<4, D> for Polar {
    const ANGLE: Option<usize> = Some(1);

    fn read(&self, report: &Measurement, _own: &Own) -> Option<SVector<f64, D>> {
        let Measurement::RangeBearing {
            range_m,
            bearing_rad,
            range_rate_mps,
        } = report.flat()
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

    fn project(&self, state: &State) -> SVector<f64, D> {
        let view = View::from(self.place_m, state);
        let mut values = SVector::zeros();
        values[0] = view.range_m;
        values[1] = view.bearing_rad;
        if D > 2 {
            values[2] = view.along.dot(&self.relative_mps(state));
        }
        values
    }

    /// ∂r/∂p = u, ∂β/∂p = t / r, ∂ṙ/∂p = (v·t) t / r, ∂ṙ/∂v = u.
    fn jacobian(&self, belief: &GaussianState) -> SMatrix<f64, D, 4> {
        let state = &belief.mean;
        let view = View::from(self.place_m, state);
        let range_m = view.least_range(belief);
        let turn_radps = view.across.dot(&self.relative_mps(state)) / range_m;
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

    /// ½ tr(Fᵢ P) and ½ tr(Fᵢ P Fⱼ P), with F the second derivatives. Along u and t, at p = r u: ∂²r/∂t² = 1/r;
    /// ∂²β/∂u∂t = −1/r²; ∂²ṙ/∂t² = −(v·u)/r², ∂²ṙ/∂u∂t = −(v·t)/r², ∂²ṙ/∂t∂(v·t) = 1/r. For r holds what holds for the
    /// Jacobian; in the terms of ṙ, which grow with the speed, it is at least ten standard deviations of the place.
    fn curvature(&self, belief: &GaussianState) -> (SVector<f64, D>, SMatrix<f64, D, D>) {
        let view = View::from(self.place_m, &belief.mean);
        let range_m = view.least_range(belief);
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
            let velocity_mps = self.relative_mps(&belief.mean);
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

    fn noise(&self, belief: &GaussianState) -> SMatrix<f64, D, D> {
        let mut noise = SMatrix::zeros();
        noise[(0, 0)] = self.sigma_range_m.powi(2);
        noise[(1, 1)] = self.sigma_bearing_rad.powi(2);
        if let Some(rate) = self.range_rate.filter(|_| D > 2) {
            noise[(2, 2)] = rate.sigma_mps.powi(2);
        }
        match &self.platform.errors {
            None => noise,
            Some(errors) => {
                let slopes: SMatrix<f64, D, 4> = self.jacobian(belief);
                let bearing_rad = View::from(self.place_m, &belief.mean).bearing_rad;
                noise + errors.noise(&slopes, 1, bearing_rad)
            }
        }
    }

    fn with_own(&self, own: &Own) -> Self {
        self.with_noise(&own.noise)
    }

    /// The plane's area a unit of (r, β) covers is r; with range rates, r over the interval that clutter's rates fill.
    fn log_clutter_scale(&self, expected: &SVector<f64, D>) -> f64 {
        let span_mps = self
            .range_rate
            .filter(|_| D > 2)
            .map_or(1.0, |rate| rate.span_mps);
        (expected[0].abs().max(LEAST_RANGE_M) / span_mps).ln()
    }

    /// A range rate is the velocity's part along the range.
    fn locate(&self, report: &SVector<f64, D>, rate_sigma: f64) -> Option<GaussianState> {
        let polar = self.widened(report[1]);
        let position_m = unbiased_position(&polar, report[0], report[1]);
        let noise = unbiased_covariance(&polar, position_m, &PositionCovariance::zeros());
        let mut state = at_rest(&position_m, &(noise + self.place_noise()), rate_sigma);
        if let Some(rate) = self.range_rate.filter(|_| D > 2) {
            let along = Position::new(report[1].sin(), report[1].cos());
            // Across the range nothing is known, and some of that looks like range rate when the bearing is wrong.
            let known = rate.sigma_mps.powi(2) + (rate_sigma * polar.sigma_bearing_rad).powi(2);
            let gained = (rate_sigma.powi(2) - known).max(0.0);
            state
                .mean
                .fixed_rows_mut::<2>(2)
                .copy_from(&(along * (report[2] + along.dot(&self.platform.velocity_mps))));
            let mut velocity = state.covariance.fixed_view_mut::<2, 2>(2, 2);
            velocity -= along * along.transpose() * gained;
        }
        Some(state)
    }
}

impl Polar {
    pub(super) fn with_noise(&self, own: &OwnNoise) -> Polar {
        Polar {
            sigma_range_m: own.sigma_range_m.unwrap_or(self.sigma_range_m),
            sigma_bearing_rad: own.sigma_bearing_rad.unwrap_or(self.sigma_bearing_rad),
            range_rate: self.range_rate.map(|rate| rate.with_noise(own)),
            ..*self
        }
    }

    fn relative_mps(&self, state: &State) -> Position {
        state.fixed_rows::<2>(2) - self.platform.velocity_mps
    }

    /// With the errors of the attitude in those of a bearing.
    pub(super) fn widened(&self, bearing_rad: f64) -> Polar {
        let mut polar = *self;
        if let Some(errors) = &self.platform.errors {
            polar.sigma_bearing_rad = errors.widened(self.sigma_bearing_rad, bearing_rad);
        }
        polar
    }

    /// What the errors of its place add to those of a position.
    pub(super) fn place_noise(&self) -> PositionCovariance {
        let errors = self.platform.errors.as_ref();
        errors.map_or_else(PositionCovariance::zeros, |errors| errors.of_place())
    }
}

fn symmetric(row: usize, column: usize, value: f64) -> SMatrix<f64, 4, 4> {
    let mut matrix = SMatrix::zeros();
    (matrix[(row, column)], matrix[(column, row)]) = (value, value);
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::{Purpose, Seed};
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
            platform: Platform::STANDING,
        }
    }

    fn projected(polar: &Polar, state: &State) -> SVector<f64, 3> {
        polar.project(state)
    }

    #[test]
    fn a_state_to_the_south_east_is_seen_as_worked_by_hand() {
        // Offset (300, −400): r = 500, β = atan2(300, −400) = 143.13°; ṙ = (3·10 − 4·(−5)) / 5 = 10.
        let state = State::new(310.0, -420.0, 10.0, -5.0);
        let seen = projected(&sensor(0.01), &state);
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
        let matrix = Sensing::<4, 3>::jacobian(&polar, &belief);
        for variable in 0..4 {
            let step = State::ith(variable, 1e-3);
            let slope =
                (projected(&polar, &(mean + step)) - projected(&polar, &(mean - step))) / 2e-3;
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
        let (shift, spread) = Sensing::<4, 3>::curvature(&polar, &belief);
        let (at, slope) = (
            projected(&polar, &mean),
            Sensing::<4, 3>::jacobian(&polar, &belief),
        );
        let mut draw = Seed { seed: 4, run: 0 }.stream(Purpose::Detection, 0, 0);
        let count = 1_000_000;
        let (mut sum, mut square) = (SVector::<f64, 3>::zeros(), SMatrix::<f64, 3, 3>::zeros());
        for _ in 0..count {
            let step = root * State::from_fn(|_, _| StandardNormal.sample(&mut draw));
            let beyond = projected(&polar, &(mean + step)) - at - slope * step;
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
    fn a_range_rate_starts_a_track_along_the_range() {
        // Straight east: ṙ is vx; what is not known across stays so.
        let polar = Polar {
            place_m: Position::zeros(),
            ..sensor(1e-3)
        };
        let measurement = SVector::<f64, 3>::new(1000.0, std::f64::consts::FRAC_PI_2, -40.0);
        let state = polar.locate(&measurement, 100.0).unwrap();
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
        assert!((sensor(0.1).log_clutter_scale(&expected).exp() - 10.0).abs() < 1e-9);
        let flat = SVector::<f64, 2>::new(1000.0, 0.0);
        assert!((sensor(0.1).log_clutter_scale(&flat).exp() - 1000.0).abs() < 1e-9);
    }
}
