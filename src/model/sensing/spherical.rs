//! Ranges, bearings and elevations of targets in space, with range rates where the sensor measures them; any part of them. Bearings
//! are clockwise from north, elevations above the horizontal of the sensor.
//!
//! # Symbols
//! As of [`super::site`]; ṙ = w·u range rate.
//!
//! # Method
//! ∂r = u; ∂β = t/g; ∂ε = e/r; ∂ṙ/∂p = ((w·t) t + (w·e) e)/r, ∂ṙ/∂v = u. Of second derivatives, on the axes u, t, e with
//! h = cos ε u − sin ε e the horizontal along the range: r has 1/r on tt and ee; β has −1/g² on ht; ε has −1/r² on ue and
//! −sin ε/(r g) on tt; ṙ has −(w·t)/r² on ut, −(w·e)/r² on ue, −(w·u)/r² on tt and ee, and 1/r between t and w·t, e and w·e.
//! Elevations lie between −π/2 and π/2 and are never brought round.

use super::Sensing;
use super::carrier::{self, Carrier};
use super::in_space::{at_rest, unbiased_covariance, unbiased_place};
use super::polar::{Polar, RangeRate};
use super::site::{Sight, Site, axes};
use super::{Bearing, site};
use crate::model::angle::wrap;
use crate::model::own::{Own, OwnNoise};
use crate::model::pose::Pose;
use crate::model::scan::Measurement;
use crate::model::state::GaussianState;
use nalgebra::{Matrix3, SMatrix, SVector};

/// Right above a sensor an elevation covers no ground; clutter is not denser than here.
const LEAST_COSINE: f64 = 1e-3;

/// A sensor of ranges and directions, and where it stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spherical {
    pub site: Site,
    pub carrier: Carrier,
    /// Whether ranges are along the ground, of a sensor of the plane beside those of space.
    pub is_flat: bool,
    /// Not used of directions alone.
    pub sigma_range_m: f64,
    pub sigma_bearing_rad: f64,
    /// `None` where elevations are not measured.
    pub sigma_elevation_rad: Option<f64>,
    pub range_rate: Option<RangeRate>,
    /// Where clutter is stated per m² of ground, or of directions per radian of bearing: the interval of heights (m), or of
    /// elevations (rad), that false detections fill. `None` where it is stated per m³.
    pub clutter_span: Option<f64>,
}

impl From<Polar> for Spherical {
    /// Along the ground.
    fn from(polar: Polar) -> Self {
        Spherical {
            site: Site::level(polar.place_m.push(0.0)),
            carrier: Carrier::from(polar.platform),
            is_flat: true,
            sigma_range_m: polar.sigma_range_m,
            sigma_bearing_rad: polar.sigma_bearing_rad,
            sigma_elevation_rad: None,
            range_rate: polar.range_rate,
            clutter_span: None,
        }
    }
}

impl From<Bearing> for Spherical {
    fn from(bearing: Bearing) -> Self {
        Spherical {
            sigma_bearing_rad: bearing.sigma_bearing_rad,
            ..Spherical::from(Polar {
                place_m: bearing.place_m,
                sigma_range_m: 1.0,
                sigma_bearing_rad: bearing.sigma_bearing_rad,
                range_rate: None,
                platform: bearing.platform,
            })
        }
    }
}

/// What can be measured, in the order in which it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Value {
    Range,
    Bearing,
    Elevation,
    RangeRate,
}

/// Reports with a range: (r, β), and with them ε and ṙ where they are measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ranges(pub Spherical);

/// Reports of directions alone: β, and with it ε.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Directions(pub Spherical);

impl Spherical {
    /// The same carried elsewhere.
    #[must_use]
    pub fn seen_from(self, pose: &Pose) -> Self {
        Spherical {
            site: Site {
                place_m: pose.place,
                ..self.site
            },
            carrier: Carrier::of(pose),
            ..self
        }
    }

    /// What is seen of a target, and how fast it moves past the sensor.
    fn sight(&self, mean: &SVector<f64, 6>) -> Sight {
        let mut sight = Sight::from(&self.site, mean, self.is_flat);
        sight.velocity_mps -= self.site.turn * self.carrier.velocity_mps;
        sight
    }

    pub(super) fn with_noise(&self, own: &OwnNoise) -> Spherical {
        let elevation = self.sigma_elevation_rad;
        Spherical {
            sigma_range_m: own.sigma_range_m.unwrap_or(self.sigma_range_m),
            sigma_bearing_rad: own.sigma_bearing_rad.unwrap_or(self.sigma_bearing_rad),
            sigma_elevation_rad: elevation
                .map(|sigma_rad| own.sigma_elevation_rad.unwrap_or(sigma_rad)),
            range_rate: self.range_rate.map(|rate| rate.with_noise(own)),
            ..*self
        }
    }

    /// Values of a report with its range.
    pub fn dimensions(&self) -> usize {
        2 + usize::from(self.sigma_elevation_rad.is_some()) + usize::from(self.range_rate.is_some())
    }

    fn ranged<const D: usize>(&self) -> [Value; D] {
        let third = if self.sigma_elevation_rad.is_some() {
            Value::Elevation
        } else {
            Value::RangeRate
        };
        let all = [Value::Range, Value::Bearing, third, Value::RangeRate];
        std::array::from_fn(|index| all[index])
    }

    fn directed<const D: usize>() -> [Value; D] {
        std::array::from_fn(|index| [Value::Bearing, Value::Elevation][index])
    }

    fn project<const D: usize>(
        &self,
        values: [Value; D],
        mean: &SVector<f64, 6>,
    ) -> SVector<f64, D> {
        let sight = self.sight(mean);
        SVector::from(values.map(|value| match value {
            Value::Range => sight.range_m,
            Value::Bearing => sight.bearing_rad,
            Value::Elevation => sight.elevation_rad,
            Value::RangeRate => (sight.axes * sight.velocity_mps).x,
        }))
    }

    fn jacobian<const D: usize>(
        &self,
        values: [Value; D],
        belief: &GaussianState<6>,
    ) -> SMatrix<f64, D, 6> {
        let sight = self.sight(&belief.mean);
        let (ground_m, range_m) = sight.least_ranges(&self.site, belief);
        let turn = sight.axes * self.site.turn;
        let (along, across, up) = (turn.row(0), turn.row(1), turn.row(2));
        let seen = sight.axes * sight.velocity_mps;
        // On level ground nothing is across upwards.
        let rising = if self.is_flat { 0.0 } else { seen.z };
        let mut slopes = SMatrix::<f64, D, 6>::zeros();
        for (row, value) in values.into_iter().enumerate() {
            let of_place = match value {
                Value::Range => along.into_owned(),
                Value::Bearing => across / ground_m,
                Value::Elevation => up / range_m,
                Value::RangeRate => (across * seen.y + up * rising) / range_m,
            };
            slopes.fixed_view_mut::<1, 3>(row, 0).copy_from(&of_place);
            if value == Value::RangeRate {
                slopes.fixed_view_mut::<1, 3>(row, 3).copy_from(&along);
            }
        }
        slopes
    }

    /// ½ tr(Fᵢ P) and ½ tr(Fᵢ P Fⱼ P); g and r are bounded as in the Jacobian, in the terms of ṙ, which grow with the speed, r is
    /// at least ten standard deviations of the place.
    fn curvature<const D: usize>(
        &self,
        values: [Value; D],
        belief: &GaussianState<6>,
    ) -> (SVector<f64, D>, SMatrix<f64, D, D>) {
        let sight = self.sight(&belief.mean);
        let ranges_m = sight.least_ranges(&self.site, belief);
        let covariance = sight.covariance(&self.site, belief);
        let products =
            values.map(|value| self.second(value, &sight, ranges_m, &covariance) * covariance);
        let shift = SVector::from_fn(|row, _| 0.5 * products[row].trace());
        let spread =
            SMatrix::from_fn(|row, column| 0.5 * products[row].dot(&products[column].transpose()));
        (shift, spread)
    }

    /// Second derivatives on the axes u, t, e of place and velocity.
    fn second(
        &self,
        value: Value,
        sight: &Sight,
        (ground_m, range_m): (f64, f64),
        covariance: &SMatrix<f64, 6, 6>,
    ) -> SMatrix<f64, 6, 6> {
        let (rise, level) = sight.elevation_rad.sin_cos();
        let of_height = if self.is_flat { 0.0 } else { 1.0 };
        let mut second = SMatrix::<f64, 6, 6>::zeros();
        let mut set = |row: usize, column: usize, value: f64| {
            (second[(row, column)], second[(column, row)]) = (value, value);
        };
        match value {
            Value::Range => {
                set(1, 1, 1.0 / range_m);
                set(2, 2, of_height / range_m);
            }
            Value::Bearing => {
                set(0, 1, -level / ground_m.powi(2));
                set(1, 2, rise / ground_m.powi(2));
            }
            Value::Elevation => {
                set(0, 2, -1.0 / range_m.powi(2));
                set(1, 1, -rise / (range_m * ground_m));
            }
            Value::RangeRate => {
                let axes = if self.is_flat { 2 } else { 3 };
                let spread_m2: f64 = (0..axes).map(|axis| covariance[(axis, axis)]).sum();
                let range_m = sight.range_m.max(10.0 * spread_m2.max(0.0).sqrt());
                let seen = sight.axes * sight.velocity_mps / range_m.powi(2);
                set(0, 1, -seen.y);
                set(0, 2, -seen.z * of_height);
                set(1, 1, -seen.x);
                set(2, 2, -seen.x * of_height);
                set(1, 4, 1.0 / range_m);
                set(2, 5, of_height / range_m);
            }
        }
        second
    }

    fn noise<const D: usize>(
        &self,
        values: [Value; D],
        belief: &GaussianState<6>,
    ) -> SMatrix<f64, D, D> {
        let noise = self.own_noise(values);
        let Some(pose) = &self.carrier.errors else {
            return noise;
        };
        let slopes = self.jacobian(values, belief);
        let mut noise = noise + slopes * carrier::kinematic_variances(pose) * slopes.transpose();
        if self.is_flat {
            // Nobody says at which elevation a target is: at the height of the sensor.
            let bearing_rad = self.sight(&belief.mean).bearing_rad;
            for row in (0..D).filter(|row| values[*row] == Value::Bearing) {
                noise[(row, row)] += pose.bearing_variance(bearing_rad);
            }
            return noise;
        }
        for [of_bearing, of_elevation] in carrier::turns_rad(pose, &self.sight(&belief.mean)) {
            let moved = SVector::from(values.map(|value| match value {
                Value::Bearing => of_bearing,
                Value::Elevation => of_elevation,
                Value::Range | Value::RangeRate => 0.0,
            }));
            noise += moved * moved.transpose();
        }
        noise
    }

    /// Without what the carrier adds.
    fn own_noise<const D: usize>(&self, values: [Value; D]) -> SMatrix<f64, D, D> {
        let sigmas = values.map(|value| match value {
            Value::Range => self.sigma_range_m,
            Value::Bearing => self.sigma_bearing_rad,
            Value::Elevation => self.sigma_elevation_rad.unwrap_or(1.0),
            Value::RangeRate => self.range_rate.map_or(1.0, |rate| rate.sigma_mps),
        });
        SMatrix::from_diagonal(&SVector::from(sigmas.map(|sigma| sigma * sigma)))
    }

    /// The kinematics that a range, bearing and elevation tell, and along the range what a range rate tells of them.
    fn locate(
        &self,
        report: &[f64],
        sigma_elevation_rad: f64,
        rate_sigma: f64,
    ) -> GaussianState<6> {
        let (bearing_rad, elevation_rad) = (report[1], report[2]);
        let place_m = unbiased_place(self, report[0], bearing_rad, elevation_rad);
        let noise = unbiased_covariance(self, &place_m, &Matrix3::zeros());
        let mut state = at_rest(&place_m, &noise, rate_sigma);
        if let Some((rate, range_rate_mps)) = self.range_rate.zip(report.get(3)) {
            let along =
                self.site.turn.transpose() * axes(bearing_rad, elevation_rad).row(0).transpose();
            // Across the range nothing is known, and some of that looks like range rate when the direction is wrong.
            let direction = self.sigma_bearing_rad.hypot(sigma_elevation_rad);
            let known = rate.sigma_mps.powi(2) + (rate_sigma * direction).powi(2);
            let gained = (rate_sigma.powi(2) - known).max(0.0);
            let mut velocity = state.mean.fixed_rows_mut::<3>(3);
            // Past a sensor that moves.
            let own_mps = along.dot(&self.carrier.velocity_mps);
            velocity.copy_from(&(along * (*range_rate_mps + own_mps)));
            let mut velocities = state.covariance.fixed_view_mut::<3, 3>(3, 3);
            velocities -= along * along.transpose() * gained;
        }
        state
    }
}

/// With `D` = 2 (r, β), 3 one more, 4 all of them.
impl<const D: usize> Sensing<6, D> for Ranges {
    const ANGLE: Option<usize> = Some(1);

    fn read(&self, report: &Measurement, _own: &Own) -> Option<SVector<f64, D>> {
        let sight = match *report {
            Measurement::RangeBearingElevation { .. } if self.0.is_flat => report.flat(),
            other => other,
        };
        let (range_m, bearing_rad, elevation_rad, range_rate_mps) = match sight {
            Measurement::RangeBearing {
                range_m,
                bearing_rad,
                range_rate_mps,
            } => (range_m, bearing_rad, None, range_rate_mps),
            Measurement::RangeBearingElevation {
                range_m,
                bearing_rad,
                elevation_rad,
                range_rate_mps,
            } => (range_m, bearing_rad, Some(elevation_rad), range_rate_mps),
            _ => return None,
        };
        let mut read = SVector::zeros();
        for (row, value) in self.0.ranged::<D>().into_iter().enumerate() {
            read[row] = match value {
                Value::Range => range_m,
                Value::Bearing => wrap(bearing_rad),
                Value::Elevation => elevation_rad?,
                Value::RangeRate => range_rate_mps?,
            };
        }
        Some(read)
    }

    fn project(&self, mean: &SVector<f64, 6>) -> SVector<f64, D> {
        self.0.project(self.0.ranged(), mean)
    }

    fn jacobian(&self, belief: &GaussianState<6>) -> SMatrix<f64, D, 6> {
        self.0.jacobian(self.0.ranged(), belief)
    }

    fn curvature(&self, belief: &GaussianState<6>) -> (SVector<f64, D>, SMatrix<f64, D, D>) {
        self.0.curvature(self.0.ranged(), belief)
    }

    fn noise(&self, belief: &GaussianState<6>) -> SMatrix<f64, D, D> {
        self.0.noise(self.0.ranged(), belief)
    }

    fn with_own(&self, own: &Own) -> Self {
        Ranges(self.0.with_noise(&own.noise))
    }

    /// A unit of (r, β, ε) covers r² cos ε of space, of (r, β) r of the ground; range rates as in the plane.
    fn log_clutter_scale(&self, expected: &SVector<f64, D>) -> f64 {
        let range_m = expected[0].abs().max(site::LEAST_RANGE_M);
        let mut scale = range_m;
        if self.0.sigma_elevation_rad.is_some() {
            scale *=
                range_m * expected[2].cos().max(LEAST_COSINE) / self.0.clutter_span.unwrap_or(1.0);
        }
        let span_mps = self.0.range_rate.map_or(1.0, |rate| rate.span_mps);
        (scale / span_mps).ln()
    }

    fn locate(&self, report: &SVector<f64, D>, rate_sigma: f64) -> Option<GaussianState<6>> {
        let sigma_rad = self.0.sigma_elevation_rad?;
        Some(self.0.locate(report.as_slice(), sigma_rad, rate_sigma))
    }
}

impl<const D: usize> Sensing<6, D> for Directions {
    const ANGLE: Option<usize> = Some(0);

    fn read(&self, report: &Measurement, _own: &Own) -> Option<SVector<f64, D>> {
        let (bearing_rad, elevation_rad) = match *report {
            Measurement::Bearing { bearing_rad } => (bearing_rad, None),
            Measurement::BearingElevation {
                bearing_rad,
                elevation_rad,
            } => (bearing_rad, Some(elevation_rad)),
            _ => return None,
        };
        let mut read = SVector::zeros();
        read[0] = wrap(bearing_rad);
        if D > 1 {
            read[1] = elevation_rad?;
        }
        Some(read)
    }

    fn project(&self, mean: &SVector<f64, 6>) -> SVector<f64, D> {
        self.0.project(Spherical::directed(), mean)
    }

    fn jacobian(&self, belief: &GaussianState<6>) -> SMatrix<f64, D, 6> {
        self.0.jacobian(Spherical::directed(), belief)
    }

    fn curvature(&self, belief: &GaussianState<6>) -> (SVector<f64, D>, SMatrix<f64, D, D>) {
        self.0.curvature(Spherical::directed(), belief)
    }

    fn noise(&self, belief: &GaussianState<6>) -> SMatrix<f64, D, D> {
        self.0.noise(Spherical::directed(), belief)
    }

    fn with_own(&self, own: &Own) -> Self {
        Directions(self.0.with_noise(&own.noise))
    }

    /// Per radian of bearing, and with elevations over the interval that clutter fills.
    fn log_clutter_scale(&self, _expected: &SVector<f64, D>) -> f64 {
        if D > 1 {
            -self.0.clutter_span.unwrap_or(1.0).ln()
        } else {
            0.0
        }
    }

    fn locate(&self, _report: &SVector<f64, D>, _rate_sigma: f64) -> Option<GaussianState<6>> {
        None
    }
}
