//! Sensing models, one file a kind of report: what a sensor reports of a target's kinematics, how well, and where a report alone
//! would put a target.
//!
//! # Symbols
//! x̂, P mean and covariance of the kinematics: position and velocity in the plane (`K` = 4) or in space (`K` = 6), or a bearing
//! and its rate (`K` = 2);
//! z a report as `D` values; h what is reported of a state without noise; H = ∂h/∂x; R noise covariance.

use super::own::Own;
use super::pose::Pose;
use super::scan::Measurement;
use super::space::Space;
use super::state::{GaussianState, Position};
use nalgebra::{SMatrix, SVector};

mod bearing;
mod carrier;
mod converted;
mod crossing;
mod direction;
mod in_space;
mod moving;
mod platform;
mod polar;
mod position;
mod range_prior;
mod site;
mod spherical;

pub use bearing::Bearing;
pub use carrier::Carrier;
pub use converted::Converted;
pub use crossing::{LineOfSight, cross};
pub use direction::Direction;
pub use in_space::{Places, unbiased_covariance, unbiased_place};
pub use moving::{Moving, VelocityNoise};
pub use platform::{Platform, PoseErrors};
pub use polar::{Polar, RangeRate};
pub use position::Positions;
pub use range_prior::{MAX_RANGES, RangePrior};
pub use site::Site;
pub use spherical::{Directions, Ranges, Spherical};

/// One kind of report of targets whose kinematics have `K` variables, as `D` values.
pub trait Sensing<const K: usize, const D: usize>: Copy {
    /// The value that is an angle, if there is one; it is kept in [−π, π).
    const ANGLE: Option<usize> = None;
    /// Whether h picks the first `D` variables of the state; then the others need no H.
    const IS_DIRECT: bool = false;

    /// A report as z; `None` for a report of another kind.
    fn read(&self, report: &Measurement, own: &Own) -> Option<SVector<f64, D>>;

    /// h(x).
    fn project(&self, mean: &SVector<f64, K>) -> SVector<f64, D>;

    /// H around x̂, bounded where h has no slope.
    fn jacobian(&self, belief: &GaussianState<K>) -> SMatrix<f64, D, K>;

    /// What the curvature of h adds to the mean and the covariance of h(x), to second order.
    fn curvature(&self, _belief: &GaussianState<K>) -> (SVector<f64, D>, SMatrix<f64, D, D>) {
        (SVector::zeros(), SMatrix::zeros())
    }

    /// R of a report of a target in this state.
    fn noise(&self, belief: &GaussianState<K>) -> SMatrix<f64, D, D>;

    /// The same of a report that has something of its own.
    #[must_use]
    fn with_own(&self, own: &Own) -> Self;

    /// ln of how much of the space in which clutter is stated a unit of z covers, around the expected z.
    fn log_clutter_scale(&self, _expected: &SVector<f64, D>) -> f64 {
        0.0
    }

    /// The kinematics that one report alone tells; each rate that it does not tell is 0 ± `rate_sigma`. `None` where the report
    /// does not say where the target is.
    fn locate(&self, report: &SVector<f64, D>, rate_sigma: f64) -> Option<GaussianState<K>>;

    /// The same in parts, of which one is true with equal probability; none where the whole is one Gaussian.
    fn parts(&self, _report: &SVector<f64, D>, _rate_sigma: f64) -> Vec<GaussianState<K>> {
        Vec::new()
    }
}

/// What a sensor measures, and how well: independent Gaussian noise on each value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MeasurementModel {
    Position {
        sigma_x_m: f64,
        sigma_y_m: f64,
    },
    Polar(Polar),
    /// Ranges and bearings that are turned into positions.
    Converted(Polar),
    Bearing(Bearing),
    /// Positions of three coordinates.
    Position3 {
        sigmas_m: [f64; 3],
        /// As of [`Spherical::clutter_span`].
        clutter_span: Option<f64>,
    },
    /// Positions with velocities over the ground.
    Moving(Moving),
    /// Ranges and bearings in space, with elevations where they are measured.
    Spherical(Spherical),
    /// Ranges, bearings and elevations that are turned into positions.
    ConvertedSpherical(Spherical),
    /// Bearings and elevations without ranges.
    Sight(Spherical),
}

impl MeasurementModel {
    pub fn range_rate(&self) -> Option<RangeRate> {
        match self {
            MeasurementModel::Polar(polar) => polar.range_rate,
            MeasurementModel::Spherical(spherical) => spherical.range_rate,
            _ => None,
        }
    }

    /// Values of a report.
    pub fn dimensions(&self) -> usize {
        match self {
            MeasurementModel::Position { .. } | MeasurementModel::Converted(_) => 2,
            MeasurementModel::Polar(polar) => 2 + usize::from(polar.range_rate.is_some()),
            MeasurementModel::Bearing(_) => 1,
            MeasurementModel::Position3 { .. } | MeasurementModel::ConvertedSpherical(_) => 3,
            MeasurementModel::Spherical(spherical) => spherical.dimensions(),
            MeasurementModel::Sight(_) => 2,
            MeasurementModel::Moving(moving) => 4 + usize::from(moving.is_in_volume),
        }
    }

    /// Whether its reports are directions alone.
    pub fn is_bearing(&self) -> bool {
        matches!(
            self,
            MeasurementModel::Bearing(_) | MeasurementModel::Sight(_)
        )
    }

    /// Whether one of its reports tells where a target of the plane is.
    pub fn locates(&self) -> bool {
        !self.is_bearing()
    }

    /// Whether one of its reports tells where a target of this space is: in a volume how high, too.
    pub fn locates_in(&self, space: Space) -> bool {
        match space {
            Space::Bearing => true,
            Space::Plane => self.locates(),
            Space::Volume => match self {
                MeasurementModel::Position3 { .. } | MeasurementModel::ConvertedSpherical(_) => {
                    true
                }
                MeasurementModel::Spherical(spherical) => spherical.sigma_elevation_rad.is_some(),
                MeasurementModel::Moving(moving) => moving.is_in_volume,
                _ => false,
            },
        }
    }

    /// Whether one of its reports can start a track in this space: it tells where the target is, or in the plane limits of its range
    /// are known.
    pub fn starts_in(&self, space: Space) -> bool {
        self.locates_in(space) || space == Space::Plane && self.range_prior().is_some()
    }

    /// Whether a track starts with one of its reports where others need two: it tells a velocity, or a second one would not help.
    pub fn starts_alone(&self) -> bool {
        matches!(self, MeasurementModel::Moving(_)) || self.range_prior().is_some()
    }

    /// Where along its bearings targets may be, of a sensor of bearings alone.
    pub fn range_prior(&self) -> Option<RangePrior> {
        match self {
            MeasurementModel::Bearing(bearing) => bearing.range_prior,
            _ => None,
        }
    }

    /// The same with its ranges and bearings turned into positions.
    #[must_use]
    pub fn converted(self) -> Self {
        match self {
            MeasurementModel::Polar(polar) => MeasurementModel::Converted(polar),
            MeasurementModel::Spherical(spherical) if spherical.sigma_elevation_rad.is_some() => {
                MeasurementModel::ConvertedSpherical(spherical)
            }
            other => other,
        }
    }

    /// The same from where the sensor is at a scan. Positions are those of the file's frame, whatever the pose.
    #[must_use]
    pub fn seen_from(&self, pose: &Pose) -> Self {
        let (place_m, platform) = (pose.place.xy(), Platform::of(pose));
        let moved = |polar: Polar| Polar {
            place_m,
            platform,
            ..polar
        };
        match *self {
            MeasurementModel::Position { .. }
            | MeasurementModel::Position3 { .. }
            | MeasurementModel::Moving(_) => *self,
            MeasurementModel::Polar(polar) => MeasurementModel::Polar(moved(polar)),
            MeasurementModel::Converted(polar) => MeasurementModel::Converted(moved(polar)),
            MeasurementModel::Bearing(bearing) => MeasurementModel::Bearing(Bearing {
                place_m,
                platform,
                ..bearing
            }),
            MeasurementModel::Spherical(spherical) => {
                MeasurementModel::Spherical(spherical.seen_from(pose))
            }
            MeasurementModel::ConvertedSpherical(spherical) => {
                MeasurementModel::ConvertedSpherical(spherical.seen_from(pose))
            }
            MeasurementModel::Sight(spherical) => {
                MeasurementModel::Sight(spherical.seen_from(pose))
            }
        }
    }

    /// Where the sensor stands, if that matters to its reports.
    pub fn place_m(&self) -> Option<Position> {
        match self {
            MeasurementModel::Position { .. }
            | MeasurementModel::Position3 { .. }
            | MeasurementModel::Moving(_) => None,
            MeasurementModel::Polar(polar) | MeasurementModel::Converted(polar) => {
                Some(polar.place_m)
            }
            MeasurementModel::Bearing(bearing) => Some(bearing.place_m),
            MeasurementModel::Spherical(spherical)
            | MeasurementModel::ConvertedSpherical(spherical)
            | MeasurementModel::Sight(spherical) => Some(spherical.site.place_m.xy()),
        }
    }
}

/// Work that is compiled for each kind of report.
pub trait WithSensing<const K: usize> {
    type Output;

    fn with<S: Sensing<K, D>, const D: usize>(self, sensing: &S) -> Self::Output;
}

/// The kinds of report of targets whose kinematics have `K` variables.
pub trait Dispatch<const K: usize> {
    /// Does the work with the sensing model of these reports; `None` where they say nothing of such targets.
    fn dispatch<W: WithSensing<K>>(&self, work: W) -> Option<W::Output>;
}

/// Targets in the plane.
impl Dispatch<4> for MeasurementModel {
    fn dispatch<W: WithSensing<4>>(&self, work: W) -> Option<W::Output> {
        Some(match *self {
            MeasurementModel::Position {
                sigma_x_m,
                sigma_y_m,
            } => work.with::<_, 2>(&Positions::new(sigma_x_m, sigma_y_m)),
            MeasurementModel::Polar(polar) if polar.range_rate.is_some() => {
                work.with::<_, 3>(&polar)
            }
            MeasurementModel::Polar(polar) => work.with::<_, 2>(&polar),
            MeasurementModel::Converted(polar) => work.with::<_, 2>(&Converted(polar)),
            MeasurementModel::Bearing(bearing) => work.with::<_, 1>(&bearing),
            MeasurementModel::Moving(moving) => work.with::<_, 4>(&moving),
            MeasurementModel::Position3 { .. }
            | MeasurementModel::Spherical(_)
            | MeasurementModel::ConvertedSpherical(_)
            | MeasurementModel::Sight(_) => return None,
        })
    }
}

/// Targets in space. What is reported of the plane says something of x and y, and nothing of z.
impl Dispatch<6> for MeasurementModel {
    fn dispatch<W: WithSensing<6>>(&self, work: W) -> Option<W::Output> {
        let ranges = |work: W, spherical: Spherical| match spherical.dimensions() {
            2 => work.with::<_, 2>(&Ranges(spherical)),
            3 => work.with::<_, 3>(&Ranges(spherical)),
            _ => work.with::<_, 4>(&Ranges(spherical)),
        };
        Some(match *self {
            MeasurementModel::Position {
                sigma_x_m,
                sigma_y_m,
            } => work.with::<_, 2>(&Places::Measured {
                sigmas_m: [sigma_x_m, sigma_y_m, 0.0],
                correlation_xy: 0.0,
                clutter_span: None,
            }),
            MeasurementModel::Converted(polar) => work.with::<_, 2>(&Places::Flat(polar)),
            MeasurementModel::Position3 {
                sigmas_m,
                clutter_span,
            } => work.with::<_, 3>(&Places::Measured {
                sigmas_m,
                correlation_xy: 0.0,
                clutter_span,
            }),
            MeasurementModel::ConvertedSpherical(spherical) => {
                work.with::<_, 3>(&Places::Converted(spherical))
            }
            MeasurementModel::Moving(moving) if moving.is_in_volume => work.with::<_, 5>(&moving),
            MeasurementModel::Moving(moving) => work.with::<_, 4>(&moving),
            MeasurementModel::Polar(polar) => ranges(work, polar.into()),
            MeasurementModel::Spherical(spherical) => ranges(work, spherical),
            MeasurementModel::Bearing(bearing) => {
                work.with::<_, 1>(&Directions(Spherical::from(bearing)))
            }
            MeasurementModel::Sight(spherical) => work.with::<_, 2>(&Directions(spherical)),
        })
    }
}

/// Directions.
impl Dispatch<2> for MeasurementModel {
    fn dispatch<W: WithSensing<2>>(&self, work: W) -> Option<W::Output> {
        match *self {
            MeasurementModel::Bearing(bearing) => Some(work.with::<_, 1>(&Direction(bearing))),
            _ => None,
        }
    }
}
