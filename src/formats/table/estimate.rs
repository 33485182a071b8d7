//! The columns of what truth or a track says of a target, by the space of the file: a place with velocity and covariance, or a
//! direction with its rate and covariance, in degrees.

use super::Sink;
use super::degrees::{degrees, radians_of_square_degrees, square_degrees};
use super::header::{
    BEARING_COVARIANCE, COVARIANCE, Header, VELOCITY, VOLUME_COVARIANCE, VOLUME_VELOCITY,
};
use super::row::RowReader;
use crate::model::space::{Place, Space};
use crate::model::state::{Packed, from_upper_triangle};
use crate::model::track::{Kinematics, TrackSet};
use nalgebra::Cholesky;
use std::io;

/// The columns of a space.
struct Names {
    position: &'static [&'static str],
    velocity: &'static [&'static str],
    covariance: &'static [&'static str],
}

impl Names {
    const fn of(space: Space) -> Names {
        match space {
            Space::Bearing => Names {
                position: &["bearing_deg"],
                velocity: &["bearing_rate_degps"],
                covariance: &BEARING_COVARIANCE,
            },
            Space::Plane => Names {
                position: &["x_m", "y_m"],
                velocity: &VELOCITY,
                covariance: &COVARIANCE,
            },
            Space::Volume => Names {
                position: &["x_m", "y_m", "z_m"],
                velocity: &VOLUME_VELOCITY,
                covariance: &VOLUME_COVARIANCE,
            },
        }
    }
}

/// Where the columns of estimates are.
pub struct EstimateColumns {
    pub space: Space,
    position: Vec<usize>,
    velocity: Option<Vec<usize>>,
    covariance: Option<Vec<usize>>,
}

impl EstimateColumns {
    /// Of tracks.
    pub fn from_header(header: &Header) -> Self {
        let space = match (header.find("x_m"), header.find("z_m")) {
            (None, _) => Space::Bearing,
            (Some(_), None) => Space::Plane,
            (Some(_), Some(_)) => Space::Volume,
        };
        let names = Names::of(space);
        EstimateColumns {
            space,
            position: names
                .position
                .iter()
                .map(|name| header.required(name))
                .collect(),
            velocity: header.all(names.velocity),
            covariance: header.all(names.covariance),
        }
    }

    /// Of truth, which is certain, and says no rates of directions.
    pub fn of_truth(header: &Header) -> Self {
        let columns = EstimateColumns::from_header(header);
        EstimateColumns {
            velocity: columns.velocity.filter(|_| columns.space.has_places()),
            covariance: None,
            ..columns
        }
    }

    /// The column that faults of a whole estimate are reported in.
    pub fn first(&self) -> usize {
        self.position[0]
    }

    pub fn read(&self, reader: &mut RowReader) -> Option<Kinematics> {
        let mut position = Some(Place::zeros());
        for (axis, &column) in self.position.iter().enumerate() {
            match (reader.number(column), &mut position) {
                (Some(value), Some(position)) => position[axis] = self.inside(value),
                _ => position = None,
            }
        }
        let mut velocity = Place::zeros();
        let has_velocity = reader.fill(self.velocity.as_deref(), velocity.as_mut_slice());
        velocity.apply(|value| *value = self.inside(*value));
        let covariance = self.read_covariance(reader);
        Some(Kinematics {
            position: position?,
            velocity: has_velocity.then_some(velocity),
            covariance,
        })
    }

    fn inside(&self, value: f64) -> f64 {
        match self.space {
            Space::Bearing => value.to_radians(),
            Space::Plane | Space::Volume => value,
        }
    }

    /// A covariance must be positive definite: one that is not gives no distances.
    fn read_covariance(&self, reader: &mut RowReader) -> Option<Packed> {
        let columns = self.covariance.as_deref()?;
        let mut elements = vec![0.0; columns.len()];
        if !reader.fill(Some(columns), &mut elements) {
            return None;
        }
        if self.space == Space::Bearing {
            let inside = |element: &mut f64| *element = radians_of_square_degrees(*element);
            elements.iter_mut().for_each(inside);
        }
        if !is_definite(self.space, &elements) {
            let detail = "the covariance is singular, or not one: it is not positive definite";
            let allowed = "a positive definite matrix: every variance > 0, every correlation within (-1, 1); or all its cells empty";
            reader.fault_allowing(columns[0], "out_of_range", detail.to_owned(), allowed);
        }
        Some(elements.as_slice().into())
    }
}

fn is_definite(space: Space, elements: &[f64]) -> bool {
    match space {
        Space::Bearing => Cholesky::new(from_upper_triangle::<2>(elements)).is_some(),
        Space::Plane => Cholesky::new(from_upper_triangle::<4>(elements)).is_some(),
        Space::Volume => Cholesky::new(from_upper_triangle::<6>(elements)).is_some(),
    }
}

/// From what is held to what is written.
type Convert = fn(f64) -> f64;

/// Which columns the points of a set need.
#[derive(Clone, Copy)]
pub struct EstimateLayout {
    pub space: Space,
    pub velocity: bool,
    pub covariance: bool,
}

impl EstimateLayout {
    pub fn for_set(set: &TrackSet) -> Self {
        let (mut velocity, mut covariance) = (false, false);
        for point in set.tracks.iter().flat_map(|track| &track.points) {
            velocity |= point.estimate.velocity.is_some();
            covariance |= point.estimate.covariance.is_some();
        }
        EstimateLayout {
            space: set.space,
            velocity,
            covariance,
        }
    }

    pub fn columns(self) -> Vec<&'static str> {
        let names = Names::of(self.space);
        let velocity = if self.velocity { names.velocity } else { &[] };
        let covariance = if self.covariance {
            names.covariance
        } else {
            &[]
        };
        [names.position, velocity, covariance].concat()
    }

    /// The cells of a point; those of columns that it does not fill are empty.
    pub fn write(
        self,
        position: &Place,
        velocity: Option<&Place>,
        covariance: Option<&[f64]>,
        sink: &mut dyn Sink,
    ) -> io::Result<()> {
        let names = Names::of(self.space);
        let (place, square): (Convert, Convert) = match self.space {
            Space::Bearing => (degrees, square_degrees),
            Space::Plane | Space::Volume => (|value| value, |value| value),
        };
        for axis in 0..names.position.len() {
            sink.number(Some(place(position[axis])))?;
        }
        if self.velocity {
            for axis in 0..names.velocity.len() {
                sink.number(velocity.map(|velocity| place(velocity[axis])))?;
            }
        }
        if self.covariance {
            for element in 0..names.covariance.len() {
                sink.number(covariance.map(|covariance| square(covariance[element])))?;
            }
        }
        Ok(())
    }
}
