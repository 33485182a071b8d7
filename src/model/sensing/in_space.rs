//! Places as reports of targets in space: positions, of three coordinates or of two, and ranges with bearings and elevations that
//! are turned into positions without bias. The conversion is the multiplicative one, and its covariance is taken at the
//! prediction, as in the plane ([`super::converted`]).
//!
//! # Symbols
//! r, β, ε range, bearing, elevation; z converted position, R its covariance; a = σβ², b = σε².
//!
//! # Method
//! z = e^(a/2) e^(b/2) r (sin β cos ε, cos β cos ε, e^(−a/2) sin ε). R = E\[z zᵀ\] − x xᵀ, whose elements are products of a second
//! moment of the bearing and one of the elevation: with M + m and N + n for them, M and N without noise, R = σr² M N + (r² + σr²)
//! (m N + M n + m n). Around a prediction r² gains its variance, and the sines and cosines lose e^(−v/2) or, of twice an
//! angle, e^(−2v) with the variance v of that angle.

use super::Sensing;
use super::converted;
use super::polar::Polar;
use super::site::Sight;
use super::spherical::Spherical;
use crate::model::own::Own;
use crate::model::scan::Measurement;
use crate::model::space::Place;
use crate::model::state::{GaussianState, Position};
use nalgebra::{Matrix3, SMatrix, SVector};

/// What makes a position of a report, and how well.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Places {
    /// Positions with independent noise on each axis (m); those of the plane have two.
    Measured {
        sigmas_m: [f64; 3],
        /// Of the errors of x and y.
        correlation_xy: f64,
        /// As of [`Spherical::clutter_span`].
        clutter_span: Option<f64>,
    },
    /// Ranges and bearings along the ground.
    Flat(Polar),
    Converted(Spherical),
}

/// The first `D` coordinates: 2 or 3.
impl<const D: usize> Sensing<6, D> for Places {
    const IS_DIRECT: bool = true;

    fn read(&self, report: &Measurement, own: &Own) -> Option<SVector<f64, D>> {
        let place_m = match (self, *report) {
            (Places::Measured { .. }, Measurement::Position3 { x_m, y_m, z_m }) => {
                Place::new(x_m, y_m, z_m)
            }
            (Places::Measured { .. }, Measurement::Position { x_m, y_m }) if D < 3 => {
                Place::new(x_m, y_m, 0.0)
            }
            (Places::Flat(polar), _) => {
                Sensing::<4, 2>::read(&converted::Converted(*polar), report, own)?.push(0.0)
            }
            (
                Places::Converted(spherical),
                Measurement::RangeBearingElevation {
                    range_m,
                    bearing_rad,
                    elevation_rad,
                    ..
                },
            ) => unbiased_place(spherical, range_m, bearing_rad, elevation_rad),
            _ => return None,
        };
        Some(place_m.fixed_rows::<D>(0).into_owned())
    }

    fn project(&self, mean: &SVector<f64, 6>) -> SVector<f64, D> {
        mean.fixed_rows::<D>(0).into_owned()
    }

    fn jacobian(&self, _belief: &GaussianState<6>) -> SMatrix<f64, D, 6> {
        SMatrix::identity()
    }

    fn noise(&self, belief: &GaussianState<6>) -> SMatrix<f64, D, D> {
        let noise = match self {
            Places::Measured {
                sigmas_m,
                correlation_xy,
                ..
            } => measured_noise(sigmas_m, *correlation_xy),
            Places::Flat(polar) => {
                let spread = belief.covariance.fixed_view::<2, 2>(0, 0).into_owned();
                let place_m = Position::new(belief.mean[0], belief.mean[1]);
                let mut noise = Matrix3::zeros();
                noise
                    .fixed_view_mut::<2, 2>(0, 0)
                    .copy_from(&converted::unbiased_covariance(polar, place_m, &spread));
                noise
            }
            Places::Converted(spherical) => {
                let spread = belief.covariance.fixed_view::<3, 3>(0, 0).into_owned();
                let place_m = belief.mean.fixed_rows::<3>(0).into_owned();
                unbiased_covariance(spherical, &place_m, &spread)
            }
        };
        noise.fixed_view::<D, D>(0, 0).into_owned()
    }

    fn with_own(&self, own: &Own) -> Self {
        match *self {
            Places::Measured {
                sigmas_m,
                clutter_span,
                ..
            } => Places::Measured {
                sigmas_m: own.noise.sigmas_m(sigmas_m),
                correlation_xy: own.noise.correlation_xy.unwrap_or(0.0),
                clutter_span,
            },
            Places::Flat(polar) => Places::Flat(polar.with_noise(&own.noise)),
            Places::Converted(spherical) => Places::Converted(spherical.with_noise(&own.noise)),
        }
    }

    fn log_clutter_scale(&self, _expected: &SVector<f64, D>) -> f64 {
        let span_m = match self {
            Places::Measured { clutter_span, .. } => *clutter_span,
            Places::Flat(_) => None,
            Places::Converted(spherical) => spherical.clutter_span,
        };
        -span_m.filter(|_| D > 2).unwrap_or(1.0).ln()
    }

    /// A place of two coordinates does not say how high its target is.
    fn locate(&self, report: &SVector<f64, D>, rate_sigma: f64) -> Option<GaussianState<6>> {
        if D < 3 {
            return None;
        }
        let place_m = Place::new(report[0], report[1], report[2]);
        let at = at_rest(&place_m, &Matrix3::zeros(), rate_sigma);
        let noise = Sensing::<6, 3>::noise(self, &at);
        Some(at_rest(&place_m, &noise, rate_sigma))
    }
}

/// Of coordinates whose errors are independent but for those of x and y.
pub(super) fn measured_noise(sigmas_m: &[f64; 3], correlation_xy: f64) -> Matrix3<f64> {
    let variances = sigmas_m.map(|sigma_m| sigma_m * sigma_m);
    let mut noise = Matrix3::from_diagonal(&variances.into());
    let mixed = correlation_xy * sigmas_m[0] * sigmas_m[1];
    (noise[(0, 1)], noise[(1, 0)]) = (mixed, mixed);
    noise
}

/// At a place, with velocity 0 ± `speed_sigma_mps` on each axis.
pub(super) fn at_rest(
    place_m: &Place,
    noise: &Matrix3<f64>,
    speed_sigma_mps: f64,
) -> GaussianState<6> {
    let (mut mean, mut covariance) = (SVector::<f64, 6>::zeros(), SMatrix::<f64, 6, 6>::zeros());
    mean.fixed_rows_mut::<3>(0).copy_from(place_m);
    covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(noise);
    for rate in 3..6 {
        covariance[(rate, rate)] = speed_sigma_mps * speed_sigma_mps;
    }
    GaussianState { mean, covariance }
}

/// Variance of elevations; none where they are not measured.
fn elevation_variance(spherical: &Spherical) -> f64 {
    spherical.sigma_elevation_rad.unwrap_or(0.0).powi(2)
}

/// The place of a report, freed of the bias that comes from bending errors of angles; on the axes of the data.
pub fn unbiased_place(
    spherical: &Spherical,
    range_m: f64,
    bearing_rad: f64,
    elevation_rad: f64,
) -> Place {
    let of_bearing = (spherical.sigma_bearing_rad.powi(2) / 2.0).exp();
    let of_elevation = (elevation_variance(spherical) / 2.0).exp();
    let (rise, level) = elevation_rad.sin_cos();
    let (east, north) = bearing_rad.sin_cos();
    let offset_m = Place::new(of_bearing * east * level, of_bearing * north * level, rise)
        * (range_m * of_elevation);
    spherical.site.place_m + spherical.site.turn.transpose() * offset_m
}

/// A second moment of the directions: what it is without noise, and what noise adds.
struct Moment {
    true_one: f64,
    gain: f64,
}

impl Moment {
    /// ½ (1 + s c₂), with c₂ the cosine of twice the angle: of sin² with s = −1, of cos² with s = 1; `noise` a.
    fn square(sign: f64, cosine: f64, noise: f64) -> Self {
        Moment {
            true_one: 0.5 * (1.0 + sign * cosine),
            gain: 0.5 * (noise.exp_m1() + sign * (-noise).exp_m1() * cosine),
        }
    }

    /// sin cos = ½ sin of twice the angle.
    fn mixed(sine: f64, noise: f64) -> Self {
        Moment {
            true_one: 0.5 * sine,
            gain: 0.5 * (-noise).exp_m1() * sine,
        }
    }

    /// The conversion makes its mean right.
    fn unbiased(true_one: f64) -> Self {
        Moment {
            true_one,
            gain: 0.0,
        }
    }
}

/// Covariance of [`unbiased_place`] of a target that is believed to be around `place_m` with covariance `spread`.
pub fn unbiased_covariance(
    spherical: &Spherical,
    place_m: &Place,
    spread: &Matrix3<f64>,
) -> Matrix3<f64> {
    let site = &spherical.site;
    let mut mean = SVector::<f64, 6>::zeros();
    mean.fixed_rows_mut::<3>(0).copy_from(place_m);
    let sight = Sight::from(site, &mean, false);
    let turn = sight.axes * site.turn;
    let believed = turn * spread * turn.transpose();
    let square_m2 = sight.range_m.powi(2) + believed[(0, 0)];
    let of_bearing = believed[(1, 1)] / sight.ground_m.powi(2);
    let of_elevation = believed[(2, 2)] / sight.range_m.powi(2);
    let [of_heading, of_tilt] = spherical.carrier.angle_variances(&sight);
    let (a, b) = (
        spherical.sigma_bearing_rad.powi(2) + of_heading,
        elevation_variance(spherical) + of_tilt,
    );
    let range_noise = spherical.sigma_range_m.powi(2);
    let product = |first: &Moment, second: &Moment| {
        let gained = first.gain * (second.true_one + second.gain) + first.true_one * second.gain;
        range_noise * first.true_one * second.true_one + (square_m2 + range_noise) * gained
    };
    let once = (-of_bearing / 2.0).exp();
    let (sin, cos) = sight.bearing_rad.sin_cos();
    let twice = (-2.0 * of_bearing).exp();
    let (sin2, cos2) = (2.0 * sight.bearing_rad).sin_cos();
    let rising = (-2.0 * of_elevation).exp();
    let (rise2, level2) = (2.0 * sight.elevation_rad).sin_cos();
    let (up, level) = (
        Moment::square(-1.0, rising * level2, b),
        Moment::square(1.0, rising * level2, b),
    );
    let slanted = Moment::mixed(rising * rise2, b);
    let xx = product(&Moment::square(-1.0, twice * cos2, a), &level);
    let yy = product(&Moment::square(1.0, twice * cos2, a), &level);
    let xy = product(&Moment::mixed(twice * sin2, a), &level);
    let xz = product(&Moment::unbiased(once * sin), &slanted);
    let yz = product(&Moment::unbiased(once * cos), &slanted);
    let zz = product(&Moment::unbiased(1.0), &up);
    let own = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    site.turn.transpose() * own * site.turn + spherical.carrier.place_covariance()
}
