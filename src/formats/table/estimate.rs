//! The columns of what a track says of its target: a place in the plane with velocity and covariance, or a direction with
//! its rate and covariance, in degrees. A file has the columns of one of them.

use super::Sink;
use super::degrees::{degrees, radians_of_square_degrees, square_degrees};
use super::header::{BEARING_COVARIANCE, COVARIANCE, Header};
use super::row::RowReader;
use crate::model::state::{State, from_upper_triangle, upper_triangle};
use crate::model::track::{BearingEstimate, Estimate, PlaneEstimate, TrackPoint, TrackSet};
use nalgebra::{Cholesky, Matrix2, SMatrix};
use std::io;

/// Where the columns of estimates are.
pub enum EstimateColumns {
    Plane {
        position: [usize; 2],
        velocity: Option<[usize; 2]>,
        covariance: Option<[usize; 10]>,
    },
    Bearing {
        bearing: usize,
        rate: Option<usize>,
        covariance: Option<[usize; 3]>,
    },
}

impl EstimateColumns {
    pub fn from_header(header: &Header) -> Self {
        if header.find("x_m").is_none() {
            return EstimateColumns::Bearing {
                bearing: header.required("bearing_deg"),
                rate: header.find("bearing_rate_degps"),
                covariance: header.all(BEARING_COVARIANCE),
            };
        }
        EstimateColumns::Plane {
            position: [header.required("x_m"), header.required("y_m")],
            velocity: header.all(["vx_mps", "vy_mps"]),
            covariance: header.all(COVARIANCE),
        }
    }

    /// The column that faults of a whole estimate are reported in.
    pub fn first(&self) -> usize {
        match self {
            EstimateColumns::Plane { position, .. } => position[0],
            EstimateColumns::Bearing { bearing, .. } => *bearing,
        }
    }

    pub fn read(&self, reader: &mut RowReader) -> Option<Estimate> {
        match *self {
            EstimateColumns::Plane {
                position,
                velocity,
                covariance,
            } => {
                let [x_m, y_m] = position.map(|column| reader.number(column));
                let velocity = reader.all_or_none(velocity);
                let first = covariance.map(|columns| columns[0]);
                let covariance = reader
                    .all_or_none(covariance)
                    .map(|upper| from_upper_triangle(&upper));
                check_definite(reader, first, covariance);
                let [vx_mps, vy_mps] = velocity.unwrap_or_default();
                let state = State::new(x_m?, y_m?, vx_mps, vy_mps);
                Some(Estimate::Plane(PlaneEstimate {
                    state,
                    has_velocity: velocity.is_some(),
                    covariance,
                }))
            }
            EstimateColumns::Bearing {
                bearing,
                rate,
                covariance,
            } => {
                let bearing_deg = reader.number(bearing);
                let rate_radps = reader.optional_number(rate).map(f64::to_radians);
                let first = covariance.map(|columns| columns[0]);
                let covariance = reader.all_or_none(covariance).map(|upper| {
                    let [bb, bbr, brbr] = upper.map(radians_of_square_degrees);
                    Matrix2::new(bb, bbr, bbr, brbr)
                });
                check_definite(reader, first, covariance);
                Some(Estimate::Bearing(BearingEstimate {
                    bearing_rad: bearing_deg?.to_radians(),
                    rate_radps,
                    covariance,
                }))
            }
        }
    }
}

/// A covariance must be positive definite: one that is not gives no distances. `first` is its first column.
fn check_definite<const N: usize>(
    reader: &mut RowReader,
    first: Option<usize>,
    covariance: Option<SMatrix<f64, N, N>>,
) {
    if let (Some(first), Some(covariance)) = (first, covariance)
        && Cholesky::new(covariance).is_none()
    {
        let detail =
            "the covariance is singular, or not one: it is not positive definite".to_owned();
        let allowed = "a positive definite matrix: every variance > 0, every correlation within (-1, 1); or all its cells empty";
        reader.fault_allowing(first, "out_of_range", detail, allowed);
    }
}

/// Whether two estimates are at one place, or in one direction.
pub fn is_same_place(left: &Estimate, right: &Estimate) -> bool {
    match (left, right) {
        (Estimate::Plane(left), Estimate::Plane(right)) => left.position_m() == right.position_m(),
        (Estimate::Bearing(left), Estimate::Bearing(right)) => {
            left.bearing_rad == right.bearing_rad
        }
        _ => false,
    }
}

/// Which columns the estimates of a set need.
#[derive(Clone, Copy)]
pub enum EstimateLayout {
    Plane { velocity: bool, covariance: bool },
    Bearing { rate: bool, covariance: bool },
}

impl EstimateLayout {
    pub fn for_set(set: &TrackSet) -> Self {
        let (mut has_rates, mut has_covariance) = (false, false);
        for point in set.tracks.iter().flat_map(|track| &track.points) {
            match &point.estimate {
                Estimate::Plane(plane) => {
                    has_rates |= plane.has_velocity;
                    has_covariance |= plane.covariance.is_some();
                }
                Estimate::Bearing(bearing) => {
                    has_rates |= bearing.rate_radps.is_some();
                    has_covariance |= bearing.covariance.is_some();
                }
            }
        }
        if set.is_of_bearings() {
            EstimateLayout::Bearing {
                rate: has_rates,
                covariance: has_covariance,
            }
        } else {
            EstimateLayout::Plane {
                velocity: has_rates,
                covariance: has_covariance,
            }
        }
    }

    pub fn columns(self) -> Vec<&'static str> {
        let (place, rates, covariance): (&[_], &[_], &[_]) = match self {
            EstimateLayout::Plane { .. } => (&["x_m", "y_m"], &["vx_mps", "vy_mps"], &COVARIANCE),
            EstimateLayout::Bearing { .. } => (
                &["bearing_deg"],
                &["bearing_rate_degps"],
                &BEARING_COVARIANCE,
            ),
        };
        let (EstimateLayout::Plane {
            velocity: has_rates,
            covariance: has_covariance,
        }
        | EstimateLayout::Bearing {
            rate: has_rates,
            covariance: has_covariance,
        }) = self;
        [
            place,
            if has_rates { rates } else { &[] },
            if has_covariance { covariance } else { &[] },
        ]
        .concat()
    }

    pub fn write(self, point: &TrackPoint, sink: &mut dyn Sink) -> io::Result<()> {
        match self {
            EstimateLayout::Plane {
                velocity,
                covariance,
            } => {
                let plane = point.estimate.plane();
                let moving = plane.filter(|plane| plane.has_velocity);
                numbers(
                    sink,
                    true,
                    [0, 1].map(|axis| plane.map(|plane| plane.state[axis])),
                )?;
                numbers(
                    sink,
                    velocity,
                    [2, 3].map(|axis| moving.map(|plane| plane.state[axis])),
                )?;
                let upper = plane
                    .and_then(|plane| plane.covariance.as_ref())
                    .map(upper_triangle);
                numbers::<10>(
                    sink,
                    covariance,
                    std::array::from_fn(|index| upper.map(|upper| upper[index])),
                )
            }
            EstimateLayout::Bearing { rate, covariance } => {
                let bearing = point.estimate.bearing();
                numbers(
                    sink,
                    true,
                    [bearing.map(|bearing| degrees(bearing.bearing_rad))],
                )?;
                numbers(
                    sink,
                    rate,
                    [bearing.and_then(|bearing| bearing.rate_radps).map(degrees)],
                )?;
                let square = bearing
                    .and_then(|bearing| bearing.covariance)
                    .map(|covariance| covariance.map(square_degrees));
                numbers(
                    sink,
                    covariance,
                    [(0, 0), (0, 1), (1, 1)].map(|place| square.map(|square| square[place])),
                )
            }
        }
    }
}

/// Cells of columns that the table may lack.
fn numbers<const N: usize>(
    sink: &mut dyn Sink,
    has_columns: bool,
    values: [Option<f64>; N],
) -> io::Result<()> {
    if has_columns {
        values.into_iter().try_for_each(|value| sink.number(value))
    } else {
        Ok(())
    }
}
