//! The columns that say where a sensor that moves is at each of its scans.

use crate::formats::table::Sink;
use crate::formats::table::degrees::degrees;
use crate::formats::table::header::Header;
use crate::formats::table::row::RowReader;
use crate::model::pose::Pose;
use crate::model::scan::Recording;
use std::io;

/// East and north come together; the others need both.
pub const PLACE: [&str; 2] = ["sensor_x_m", "sensor_y_m"];

/// All of them, in the order in which they are written and held.
pub const COLUMNS: [&str; 18] = [
    PLACE[0],
    PLACE[1],
    "sensor_z_m",
    "sensor_vx_mps",
    "sensor_vy_mps",
    "sensor_vz_mps",
    "sensor_heading_deg",
    "sensor_pitch_deg",
    "sensor_roll_deg",
    "sensor_sigma_x_m",
    "sensor_sigma_y_m",
    "sensor_sigma_z_m",
    "sensor_sigma_vx_mps",
    "sensor_sigma_vy_mps",
    "sensor_sigma_vz_mps",
    "sensor_sigma_heading_deg",
    "sensor_sigma_pitch_deg",
    "sensor_sigma_roll_deg",
];

const HEADING: usize = 6;
/// From here on values are standard deviations.
const SIGMAS: usize = 9;

/// Where a file has them.
#[derive(Clone, Copy, Default)]
pub struct PoseColumns([Option<usize>; COLUMNS.len()]);

impl PoseColumns {
    pub fn from_header(header: &Header) -> Self {
        PoseColumns(COLUMNS.map(|name| header.find(name)))
    }

    pub fn are_there(&self) -> bool {
        self.0.iter().any(Option::is_some)
    }

    /// The column in which a fault of a whole pose is told.
    pub fn first(&self) -> Option<usize> {
        self.0.iter().flatten().next().copied()
    }

    /// What a row says; `None` where it says nothing, and for faults.
    pub fn read(&self, reader: &mut RowReader) -> Option<Pose> {
        let mut values = [None; COLUMNS.len()];
        for (index, column) in self.0.iter().enumerate() {
            values[index] = reader.optional_number(*column);
            self.check(index, values[index], reader);
        }
        if !reader.is_sound() {
            return None;
        }
        let is_placed = values[0].is_some() && values[1].is_some();
        let alone = (0..values.len()).find(|&index| values[index].is_some());
        if let (false, Some(column)) = (is_placed, alone.and_then(|index| self.0[index])) {
            let detail = format!("'{}' and '{}' are needed with it", PLACE[0], PLACE[1]);
            reader.fault(column, "missing", detail);
        }
        (is_placed && reader.is_sound()).then(|| Pose::from_named(&values))
    }

    /// Reports a value that no pose has.
    fn check(&self, index: usize, value: Option<f64>, reader: &mut RowReader) {
        let (Some(column), Some(value)) = (self.0[index], value) else {
            return;
        };
        if index >= SIGMAS && value < 0.0 {
            let detail = format!("a standard deviation of {value} is below zero");
            reader.fault_allowing(column, "out_of_range", detail, ">= 0");
        } else if (HEADING + 1..SIGMAS).contains(&index) && value.abs() >= 90.0 {
            let detail = format!("a sensor that is turned by {value}° sees no horizon");
            reader.fault_allowing(column, "out_of_range", detail, "above -90 and below 90 deg");
        }
    }
}

/// The cells of a pose, in the order of [`Pose::NAMES`].
pub fn cells(pose: &Pose) -> [Option<f64>; COLUMNS.len()] {
    let attitude = pose.attitude.unwrap_or_default();
    let (place, velocity, sigmas) = (&pose.place, &pose.velocity, &pose.sigmas);
    let turned = |angle_rad: f64| pose.attitude.map(|_| degrees(angle_rad));
    [
        Some(place.x),
        Some(place.y),
        Some(place.z),
        Some(velocity.x),
        Some(velocity.y),
        Some(velocity.z),
        turned(attitude.heading_rad),
        turned(attitude.pitch_rad),
        turned(attitude.roll_rad),
        Some(sigmas.place.x),
        Some(sigmas.place.y),
        Some(sigmas.place.z),
        Some(sigmas.velocity.x),
        Some(sigmas.velocity.y),
        Some(sigmas.velocity.z),
        Some(degrees(sigmas.heading_rad)),
        Some(degrees(sigmas.pitch_rad)),
        Some(degrees(sigmas.roll_rad)),
    ]
}

/// The columns that a recording needs: those in which some scan has more than nothing.
#[derive(Clone, Copy)]
pub struct PoseLayout([bool; COLUMNS.len()]);

impl PoseLayout {
    pub fn for_recording(recording: &Recording) -> Self {
        let mut needed = [false; COLUMNS.len()];
        for pose in recording.scans.iter().filter_map(|scan| scan.pose.as_ref()) {
            (needed[0], needed[1]) = (true, true);
            needed[HEADING] |= pose.attitude.is_some();
            for (needed, cell) in needed.iter_mut().zip(cells(pose)) {
                *needed |= cell.is_some_and(|value| value != 0.0);
            }
        }
        PoseLayout(needed)
    }

    /// Needs what another needs, too.
    pub fn join(&mut self, other: &PoseLayout) {
        for (needed, other) in self.0.iter_mut().zip(other.0) {
            *needed |= other;
        }
    }

    pub fn columns(&self) -> impl Iterator<Item = &'static str> {
        let needed = self.0;
        let columns = COLUMNS.into_iter().zip(needed);
        columns.filter(|(_, is)| *is).map(|(name, _)| name)
    }

    /// # Errors
    /// What the output says.
    pub fn write(&self, pose: Option<&Pose>, sink: &mut dyn Sink) -> io::Result<()> {
        let cells = pose.map_or([None; COLUMNS.len()], cells);
        for (cell, is_needed) in cells.into_iter().zip(self.0) {
            if is_needed {
                sink.number(cell)?;
            }
        }
        Ok(())
    }
}
