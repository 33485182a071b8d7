//! The columns that say how well a single detection was measured, and how fast it went.

use crate::formats::table::Sink;
use crate::formats::table::degrees::degrees;
use crate::formats::table::header::Header;
use crate::formats::table::row::RowReader;
use crate::model::own::{Own, OwnNoise};
use crate::model::scan::Recording;
use std::io;

/// Of the noise.
pub const COLUMNS: [&str; 10] = OwnNoise::NAMES;

const CORRELATION: usize = 2;
/// Those in degrees.
const ANGLES: [usize; 3] = [5, 6, 9];

/// East and north.
pub const VELOCITY: [&str; 2] = ["vx_mps", "vy_mps"];
/// The same as a speed over ground and a course clockwise from north.
const COURSE: [&str; 2] = ["speed_mps", "course_deg"];

/// Where a file has them.
#[derive(Clone, Copy, Default)]
pub struct OwnColumns {
    noise: [Option<usize>; COLUMNS.len()],
    velocity: [Option<usize>; 2],
    course: [Option<usize>; 2],
}

impl OwnColumns {
    pub fn from_header(header: &Header) -> Self {
        OwnColumns {
            noise: COLUMNS.map(|name| header.find(name)),
            velocity: VELOCITY.map(|name| header.find(name)),
            course: COURSE.map(|name| header.find(name)),
        }
    }

    /// What a row says; its time in the scan is found later.
    pub fn read(&self, reader: &mut RowReader) -> Own {
        let mut values = [None; COLUMNS.len()];
        for (index, column) in self.noise.iter().enumerate() {
            values[index] = reader.optional_number(*column);
            check(index, (*column, values[index]), reader);
        }
        Own {
            after_s: 0.0,
            noise: OwnNoise::from_named(values),
            velocity_mps: self.velocity(reader),
        }
    }

    fn velocity(&self, reader: &mut RowReader) -> Option<[f64; 2]> {
        let [east, north] = self.velocity.map(|column| reader.optional_number(column));
        let [speed, course] = self.course.map(|column| reader.optional_number(column));
        if let (Some(column), Some(speed)) = (self.course[0], speed.filter(|speed| *speed < 0.0)) {
            let detail = format!("a speed of {speed} m/s is below zero");
            reader.fault_allowing(column, "out_of_range", detail, ">= 0 m/s");
        }
        let of_course = speed.zip(course).map(|(speed, course_deg)| {
            let (east, north) = course_deg.to_radians().sin_cos();
            [speed * east, speed * north]
        });
        east.zip(north).map(<[f64; 2]>::from).or(of_course)
    }
}

/// Reports a value that no noise has.
fn check(index: usize, (column, value): (Option<usize>, Option<f64>), reader: &mut RowReader) {
    let (Some(column), Some(value)) = (column, value) else {
        return;
    };
    if index == CORRELATION && value.abs() >= 1.0 {
        let detail = format!("a correlation of {value} is none of two axes");
        reader.fault_allowing(column, "out_of_range", detail, "above -1 and below 1");
    } else if index != CORRELATION && value <= 0.0 {
        let detail = format!("a standard deviation of {value} is not above zero");
        reader.fault_allowing(column, "out_of_range", detail, "> 0");
    }
}

/// The columns that a recording needs.
#[derive(Clone, Copy)]
pub struct OwnLayout {
    noise: [bool; COLUMNS.len()],
    velocity: bool,
}

impl OwnLayout {
    pub fn for_recording(recording: &Recording) -> Self {
        let mut layout = OwnLayout {
            noise: [false; COLUMNS.len()],
            velocity: false,
        };
        for own in recording.scans.iter().flat_map(|scan| &scan.own) {
            for (needed, value) in layout.noise.iter_mut().zip(own.noise.values()) {
                *needed |= value.is_some();
            }
            layout.velocity |= own.velocity_mps.is_some();
        }
        layout
    }

    /// Needs what another needs, too.
    pub fn join(&mut self, other: &OwnLayout) {
        self.velocity |= other.velocity;
        for (needed, other) in self.noise.iter_mut().zip(other.noise) {
            *needed |= other;
        }
    }

    pub fn columns(&self) -> impl Iterator<Item = &'static str> {
        let needed = self.noise;
        let noise = COLUMNS.into_iter().zip(needed).filter(|(_, is)| *is);
        let velocity = self.velocity.then_some(VELOCITY);
        velocity
            .into_iter()
            .flatten()
            .chain(noise.map(|(name, _)| name))
    }

    /// # Errors
    /// What the output says.
    pub fn write(&self, own: &Own, sink: &mut dyn Sink) -> io::Result<()> {
        if self.velocity {
            sink.number(own.velocity_mps.map(|velocity_mps| velocity_mps[0]))?;
            sink.number(own.velocity_mps.map(|velocity_mps| velocity_mps[1]))?;
        }
        for (index, value) in own.noise.values().into_iter().enumerate() {
            if self.noise[index] {
                let is_angle = ANGLES.contains(&index);
                sink.number(value.map(|value| if is_angle { degrees(value) } else { value }))?;
            }
        }
        Ok(())
    }
}
