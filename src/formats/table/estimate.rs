//! The columns of what truth or a track says of a target, by the space of the file: a place with velocity and covariance, or a
//! direction with its rate and covariance, in degrees.

use super::Sink;
use super::degrees::{degrees, radians_of_square_degrees, square_degrees};
use super::ground::Ground;
use super::header::{
    BEARING_COVARIANCE, COVARIANCE, Header, VELOCITY, VOLUME_COVARIANCE, VOLUME_VELOCITY,
};
use super::row::RowReader;
use crate::geodesy::{Stereographic, is_on_earth};
use crate::model::attributes::{ATTRIBUTES, Attributes};
use crate::model::space::{Frame, Place, Space};
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
    /// Of latitudes and longitudes the longitude comes first, until the plane is known.
    position: Vec<usize>,
    is_geographic: bool,
    velocity: Option<Vec<usize>>,
    /// Speed, and course clockwise from north.
    motion: Option<[usize; 2]>,
    covariance: Option<Vec<usize>>,
    height: Option<usize>,
    /// Longitude and latitude beside places in the plane.
    earth: Option<[usize; 2]>,
}

impl EstimateColumns {
    /// Of tracks.
    pub fn from_header(header: &Header) -> Self {
        let is_geographic = header.is_geographic();
        let space = match (header.find("x_m"), header.find("z_m")) {
            (None, None) if is_geographic => Space::Plane,
            (None, None) => Space::Bearing,
            (Some(_), None) => Space::Plane,
            (_, Some(_)) => Space::Volume,
        };
        let names = Names::of(space);
        let place = |name: &&str| match *name {
            "x_m" if is_geographic => header.required("lon_deg"),
            "y_m" if is_geographic => header.required("lat_deg"),
            name => header.required(name),
        };
        let motion = header.find("speed_mps").zip(header.find("course_deg"));
        EstimateColumns {
            space,
            position: names.position.iter().map(place).collect(),
            is_geographic,
            velocity: header.all(names.velocity),
            motion: motion.map(|(speed, course)| [speed, course]),
            covariance: header.all(names.covariance),
            height: header.find("height_m"),
            earth: header.beside_plane(),
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

    /// Whether places are longitudes and latitudes, until the plane is known.
    pub fn is_geographic(&self) -> bool {
        self.is_geographic
    }

    /// Notes where the row's place is on the Earth, as far as it says it.
    pub fn note_earth(&self, position: &Place, reader: &mut RowReader, ground: &mut Ground) {
        if self.is_geographic {
            ground.add(position.y, position.x);
            return;
        }
        let mut earth = [0.0; 2];
        if reader.fill(self.earth.as_ref().map(<[_; 2]>::as_slice), &mut earth) {
            ground.add_both(position.xy(), earth[1], earth[0]);
        }
    }

    /// How high the target was, where the row says it.
    pub fn read_height(&self, reader: &mut RowReader) -> Option<f64> {
        reader.optional_number(self.height)
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
        if let (true, Some(place)) = (self.is_geographic, position)
            && !is_on_earth(place.y, place.x)
        {
            reader.fault_off_earth([self.position[0], self.position[1]], place.y, place.x);
            position = None;
        }
        let mut velocity = Place::zeros();
        let mut has_velocity = reader.fill(self.velocity.as_deref(), velocity.as_mut_slice());
        velocity.apply(|value| *value = self.inside(*value));
        if !has_velocity {
            let mut motion = [0.0; 2];
            has_velocity = reader.fill(self.motion.as_ref().map(<[_; 2]>::as_slice), &mut motion);
            let (sin, cos) = motion[1].to_radians().sin_cos();
            velocity = Place::new(motion[0] * sin, motion[0] * cos, 0.0);
        }
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

/// Nine decimals of a degree are a tenth of a millimetre.
pub fn rounded_deg(angle_deg: f64) -> f64 {
    (angle_deg * 1e9).round() / 1e9
}

/// From what is held to what is written.
type Convert = fn(f64) -> f64;

/// Which columns the points of a set need.
#[derive(Clone, Copy)]
pub struct EstimateLayout {
    pub space: Space,
    pub velocity: bool,
    pub covariance: bool,
    pub height: bool,
    /// With it places are written as latitudes and longitudes, too.
    pub frame: Option<Frame>,
}

impl EstimateLayout {
    pub fn for_set(set: &TrackSet) -> Self {
        let (mut velocity, mut covariance, mut height) = (false, false, false);
        for point in set.tracks.iter().flat_map(|track| &track.points) {
            velocity |= point.estimate.velocity.is_some();
            covariance |= point.estimate.covariance.is_some();
            height |= point.height_m.is_some();
        }
        EstimateLayout {
            space: set.space,
            velocity,
            covariance,
            height,
            frame: set.frame.filter(|_| set.space == Space::Plane),
        }
    }

    /// The plane whose places have a latitude and longitude.
    pub fn plane(&self) -> Option<Stereographic> {
        self.frame.map(Stereographic::from)
    }

    /// The attributes that any object of a set has.
    pub fn attributes(&self, known: &Attributes) -> Vec<&'static str> {
        let is_there = |name: &&&str| known.values().any(|of_one| of_one.contains_key(**name));
        ATTRIBUTES.iter().filter(is_there).copied().collect()
    }

    /// The cells of latitude, longitude and height, where the set has them.
    pub fn write_beside(
        &self,
        plane: Option<&Stereographic>,
        position: &Place,
        height_m: Option<f64>,
        sink: &mut dyn Sink,
    ) -> io::Result<()> {
        if let Some(plane) = plane {
            let (lat_deg, lon_deg) = plane.unproject(&position.xy());
            sink.number(Some(rounded_deg(lat_deg)))?;
            sink.number(Some(rounded_deg(lon_deg)))?;
        }
        if self.height {
            sink.number(height_m)?;
        }
        Ok(())
    }

    pub fn columns(self) -> Vec<&'static str> {
        let names = Names::of(self.space);
        let velocity = if self.velocity { names.velocity } else { &[] };
        let covariance = if self.covariance {
            names.covariance
        } else {
            &[]
        };
        let earth: &[&str] = if self.frame.is_some() {
            &["lat_deg", "lon_deg"]
        } else {
            &[]
        };
        let height: &[&str] = if self.height { &["height_m"] } else { &[] };
        [names.position, velocity, covariance, earth, height].concat()
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
