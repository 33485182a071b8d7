//! Detections: rows become scans. The file numbers them, or its times and sensors do. A row with neither detection nor measurement
//! declares a scan that saw nothing.

mod columns;
mod live;
mod own;
mod poses;
mod scans;
mod turns;
mod write;

pub use live::follow;
pub use own::{COLUMNS as OWN_COLUMNS, VELOCITY as OWN_VELOCITY};
pub use poses::{COLUMNS as POSE_COLUMNS, PLACE as POSE_PLACE, cells as named_pose};
pub use write::{Layout, write, write_rows};

use super::ground::Ground;
use super::header::Header;
use super::interner::Interner;
use super::row::RowReader;
use super::{Repeats, Table};
use crate::formats::Units;
use crate::model::beside::Labels;
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::own::Own;
use crate::model::pose::Pose;
use crate::model::scan::{Detection, Measurement};
use crate::model::sensor::SensorSettings;
use columns::Columns;

/// What a row says.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Found {
    time_s: f64,
    /// Numbered in the order the file names them.
    sensor: u32,
    /// The file's own.
    scan: Option<u32>,
    row: u64,
    detection: Option<Detection>,
    height_m: Option<f64>,
    own: Own,
    /// Of the poses that the rows have shown.
    pose: Option<u32>,
}

/// What the rows have shown so far; one entry a row in the lists.
#[derive(Default)]
struct Builder {
    sensors: Interner,
    targets: Interner,
    found: Vec<Found>,
    ids: Vec<String>,
    /// Attributes, in the order of the columns.
    labels: Vec<(Interner, Labels)>,
    ground: Ground,
    /// One after another as they change from row to row.
    poses: Vec<Pose>,
    /// Whether a row had both a position and a range or bearing.
    ambiguous: bool,
    /// Whether a row had a height that belongs to no position.
    has_stray_height: bool,
    repeats: Repeats,
}

/// Reads detections, and tells how the rows fared.
///
/// # Errors
/// Every fault of the rows.
pub fn read(
    table: Table,
    header: &Header,
    sensors: Vec<SensorSettings>,
    warnings: &mut Vec<String>,
) -> Result<(Dataset, Units), Vec<Fault>> {
    let columns = Columns::from_header(header);
    let mut reader = RowReader::new(table.rows, header, table.reading);
    let mut builder = Builder {
        labels: columns
            .attributes
            .iter()
            .map(|_| Default::default())
            .collect(),
        ..Builder::default()
    };
    while reader.advance() {
        builder.read_row(&mut reader, &columns);
    }
    let frame = builder.ground.frame(table.reading)?;
    let repeated = builder.repeats.count() as u64;
    let base = reader.time_base();
    let repeats = reader.repeats_warning(&builder.repeats);
    let (ambiguous, has_stray_height) = (builder.ambiguous, builder.has_stray_height);
    let told = reader.told();
    let grouped = scans::group(
        builder,
        sensors,
        &mut reader,
        (&columns, frame, table.reading),
    );
    let units = reader.finish(repeated)?;
    let (mut recording, grouping) = grouped?;
    recording.set_time_base(base);
    warnings.extend(told.into_iter().chain(repeats).chain(grouping));
    if ambiguous {
        warnings.push(
            "rows have x_m, y_m and also range_m or bearing_deg: the position is used".to_owned(),
        );
    }
    if has_stray_height {
        warnings
            .push("z_m belongs to x_m, y_m: it is not read of rows without a position".to_owned());
    }
    Ok((Dataset::Detections(recording), units))
}

impl Builder {
    fn read_row(&mut self, reader: &mut RowReader, columns: &Columns) {
        let time_s = reader.time(columns.time);
        let scan = columns.scan.map(|column| reader.whole_number(column));
        if let Some(sensor) = columns.sensor {
            reader.require_name(sensor);
        }
        for column in columns.truth.into_iter().chain(columns.id) {
            reader.check_name(column);
        }
        let measurement = self.measurement(reader, columns);
        let amplitude = reader.optional_number(columns.amplitude);
        let height_m = reader.optional_number(columns.height);
        let own = columns.own.read(reader);
        let pose = self.pose(reader, columns);
        let (Some(time_s), true) = (time_s, reader.is_sound()) else {
            return;
        };
        let sensor = self.sensors.number(match columns.sensor {
            Some(column) => reader.text(column),
            None => "sensor",
        });
        let truth = reader.optional_text(columns.truth);
        let origin = (!truth.is_empty()).then(|| self.targets.number(truth));
        let found = Found {
            time_s,
            sensor,
            scan: scan.flatten(),
            row: reader.row(),
            detection: measurement.map(|measurement| Detection {
                measurement,
                origin,
                amplitude,
            }),
            height_m,
            own,
            pose,
        };
        self.keep(found, reader, columns);
    }

    /// The number of what the row says of its sensor's pose.
    fn pose(&mut self, reader: &mut RowReader, columns: &Columns) -> Option<u32> {
        if !columns.pose.are_there() {
            return None;
        }
        let pose = columns.pose.read(reader)?;
        if self.poses.last() != Some(&pose) {
            self.poses.push(pose);
        }
        Some(self.poses.len() as u32 - 1)
    }

    fn keep(&mut self, found: Found, reader: &RowReader, columns: &Columns) {
        let id = match columns.id {
            Some(column) => reader.text(column).to_owned(),
            None => found.row.to_string(),
        };
        let before = self.found.last().zip(self.ids.last());
        let is_repeated = columns.id.is_some()
            && before.is_some_and(|(before, before_id)| {
                *before
                    == Found {
                        row: before.row,
                        ..found
                    }
                    && *before_id == id
            });
        if is_repeated && found.detection.is_some() {
            return self.repeats.add(found.row);
        }
        self.found.push(found);
        self.ids.push(id);
        for ((texts, labels), &(_, column)) in self.labels.iter_mut().zip(&columns.attributes) {
            let text = reader.text(column).trim();
            labels
                .of
                .push((!text.is_empty()).then(|| texts.number(text)));
        }
    }

    /// The row's measurement; `None` for a row that declares an empty scan, and for faults.
    fn measurement(&mut self, reader: &mut RowReader, columns: &Columns) -> Option<Measurement> {
        let position = self.position(reader, columns);
        let range_m = reader.optional_number(columns.range);
        if let (Some(column), Some(range_m)) =
            (columns.range, range_m.filter(|range_m| *range_m < 0.0))
        {
            reader.fault_allowing(
                column,
                "out_of_range",
                format!("a range of {range_m} m is below zero"),
                ">= 0 m",
            );
        }
        let bearing = reader.optional_number(columns.bearing);
        let range_rate_mps = reader.optional_number(columns.range_rate);
        let z_m = reader.optional_number(columns.z);
        let elevation = elevation_of(reader, columns);
        if !reader.is_sound() {
            return None;
        }
        self.has_stray_height |= position.is_none() && z_m.is_some();
        self.ambiguous |= position.is_some() && (range_m.is_some() || bearing.is_some());
        let measurement = match (position, range_m, bearing.map(f64::to_radians)) {
            (Some([x_m, y_m]), _, _) => match z_m {
                Some(z_m) => Measurement::Position3 { x_m, y_m, z_m },
                None => Measurement::Position { x_m, y_m },
            },
            (None, range_m, Some(bearing_rad)) => {
                directed(range_m, bearing_rad, elevation, range_rate_mps)
            }
            (None, range_m, None) => {
                missing_measurement(reader, columns, range_m.is_some());
                return None;
            }
        };
        columns
            .id
            .into_iter()
            .for_each(|id| reader.require_name(id));
        Some(measurement)
    }

    /// East and north; of a latitude and longitude these are those, until the origin is known.
    fn position(&mut self, reader: &mut RowReader, columns: &Columns) -> Option<[f64; 2]> {
        let mut place = [0.0; 2];
        let cells = columns.place.as_ref().map(<[_; 2]>::as_slice);
        if !reader.fill(cells, &mut place) {
            return None;
        }
        if let (true, Some(cells)) = (columns.is_geographic, columns.place) {
            let [lon_deg, lat_deg] = place;
            if !self.ground.add(lat_deg, lon_deg) {
                reader.fault_off_earth(cells, lat_deg, lon_deg);
                return None;
            }
        }
        let mut earth = [0.0; 2];
        if reader.fill(columns.earth.as_ref().map(<[_; 2]>::as_slice), &mut earth) {
            self.ground.add_both(place.into(), earth[1], earth[0]);
        }
        Some(place)
    }
}

/// The elevation (rad), where the row has one.
fn elevation_of(reader: &mut RowReader, columns: &Columns) -> Option<f64> {
    let elevation = reader.optional_number(columns.elevation)?;
    if let Some(column) = columns.elevation.filter(|_| elevation.abs() > 90.0) {
        let detail = format!("an elevation of {elevation} degrees is none");
        reader.fault_allowing(column, "out_of_range", detail, "-90 to 90 deg");
    }
    Some(elevation.to_radians())
}

/// A direction, with its range where that was measured.
fn directed(
    range_m: Option<f64>,
    bearing_rad: f64,
    elevation_rad: Option<f64>,
    range_rate_mps: Option<f64>,
) -> Measurement {
    match (range_m, elevation_rad) {
        (Some(range_m), None) => Measurement::RangeBearing {
            range_m,
            bearing_rad,
            range_rate_mps,
        },
        (Some(range_m), Some(elevation_rad)) => Measurement::RangeBearingElevation {
            range_m,
            bearing_rad,
            elevation_rad,
            range_rate_mps,
        },
        (None, None) => Measurement::Bearing { bearing_rad },
        (None, Some(elevation_rad)) => Measurement::BearingElevation {
            bearing_rad,
            elevation_rad,
        },
    }
}

/// The fault of a detection without a measurement; a row without either is none.
fn missing_measurement(reader: &mut RowReader, columns: &Columns, has_range: bool) {
    let bearing = columns.bearing.filter(|_| has_range);
    let place = columns.place.map(|[first, _]| first);
    let Some(column) = bearing.or(place).or(columns.bearing) else {
        return;
    };
    let id = reader.optional_text(columns.id);
    if has_range {
        reader.fault(column, "missing", "a range needs a bearing".to_owned());
    } else if !id.is_empty() {
        let detail = format!("detection '{id}' has no measurement");
        reader.fault(column, "missing", detail);
    } else if columns.id.is_none() && columns.scan.is_none() {
        reader.fault(column, "missing", "the row has no measurement".to_owned());
    }
}
