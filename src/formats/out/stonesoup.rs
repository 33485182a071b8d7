//! CSV for the readers of Stone Soup, which read row by row: sorted by time, a number in each cell of the state and of the
//! covariance. So a column that some point lacks is left out of all, and places, ranges and bearings alone are files of their own.
//!
//! Bearings are Stone Soup's, counterclockwise from the x axis (rad, -π to π). `time_s` counts seconds, of absolute times since
//! 1970: `timestamp=True`.
//!
//! # Reference
//! Stone Soup 1.9.1, `stonesoup.reader.generic`: CSVGroundTruthReader, CSVTrackReader, CSVDetectionReader.

use super::seen::{time_of, truth_of};
use super::{TABLES, WriteError, Writer, refusal};
use crate::formats::table::push_number;
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use crate::model::scan::{Measurement, Recording};
use crate::model::space::{Place, Space};
use crate::model::track::TrackSet;
use crate::model::truth::TruthSet;
use std::f64::consts::FRAC_PI_2;
use std::io::Write;

pub const WRITER: Writer = Writer {
    name: "stonesoup",
    media_type: "text/csv",
    extension: "csv",
    summary: "CSV for the readers of Stone Soup: truth, tracks, or detections with positions",
    kinds: TABLES,
    feature: None,
    write: |dataset, out| write(dataset, Report::Position, out),
};

pub const POLAR: Writer = Writer {
    name: "stonesoup_polar",
    media_type: "text/csv",
    extension: "csv",
    summary: "CSV for the readers of Stone Soup: detections with bearing and range",
    kinds: &[DatasetKind::Detections],
    feature: None,
    write: |dataset, out| write(dataset, Report::Polar, out),
};

pub const BEARINGS: Writer = Writer {
    name: "stonesoup_bearings",
    media_type: "text/csv",
    extension: "csv",
    summary: "CSV for the readers of Stone Soup: detections with bearings alone",
    kinds: &[DatasetKind::Detections],
    feature: None,
    write: |dataset, out| write(dataset, Report::Bearing, out),
};

/// What the detections of a file report.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Report {
    Position,
    Polar,
    Bearing,
}

impl Report {
    fn columns(self) -> &'static [&'static str] {
        match self {
            Report::Position => &["x_m", "y_m"],
            Report::Polar => &["bearing_rad", "range_m"],
            Report::Bearing => &["bearing_rad"],
        }
    }

    fn writer(self) -> &'static Writer {
        match self {
            Report::Position => &WRITER,
            Report::Polar => &POLAR,
            Report::Bearing => &BEARINGS,
        }
    }

    fn of(measurement: &Measurement) -> Report {
        match measurement {
            Measurement::Position { .. } | Measurement::Position3 { .. } => Report::Position,
            Measurement::RangeBearing { .. } | Measurement::RangeBearingElevation { .. } => {
                Report::Polar
            }
            Measurement::Bearing { .. } | Measurement::BearingElevation { .. } => Report::Bearing,
        }
    }
}

const RATES: [&str; 3] = ["vx_mps", "vy_mps", "vz_mps"];
const AXES: [&str; 3] = ["x_m", "y_m", "z_m"];
/// The variables of a covariance, by the axes of the space.
const VARIABLES: [[&str; 6]; 2] = [
    ["x", "y", "vx", "vy", "", ""],
    ["x", "y", "z", "vx", "vy", "vz"],
];

fn write(dataset: &Dataset, report: Report, out: &mut dyn Write) -> Result<(), WriteError> {
    let mut table = csv::Writer::from_writer(out);
    match dataset {
        Dataset::Detections(recording) => write_detections(recording, report, &mut table)?,
        Dataset::Truth(truth) if truth.space().has_places() => write_truth(truth, &mut table)?,
        Dataset::Tracks(set) if set.space.has_places() => write_tracks(set, &mut table)?,
        _ => return Err(super::no_places(WRITER.name).into()),
    }
    table.flush()?;
    Ok(())
}

type Table<'a> = csv::Writer<&'a mut dyn Write>;

fn write_detections(
    recording: &Recording,
    report: Report,
    table: &mut Table,
) -> Result<(), WriteError> {
    check_reports(recording, report)?;
    let mut header = vec!["time_s"];
    header.extend(report.columns());
    header.extend(["sensor_id", "scan", "detection_id"]);
    header.extend(recording.origins_known.then_some("truth_id"));
    put(table, &header)?;
    let mut found = Vec::new();
    for (first, scan) in recording.scans_with_firsts() {
        for (index, detection) in (first..).zip(&scan.detections) {
            if Report::of(&detection.measurement) == report {
                found.push((time_of(recording, scan, index), index, scan, detection));
            }
        }
    }
    // Scans are sorted, but detections may have times of their own.
    found.sort_by(|one, next| one.0.total_cmp(&next.0));
    for (time_s, index, scan, detection) in found {
        let mut row = vec![number(time_s)];
        row.extend(measured(&detection.measurement).into_iter().map(number));
        row.push(recording.sensors[scan.sensor].sensor_id.clone());
        row.push(scan.number.to_string());
        row.push(recording.detection_ids[index].clone());
        if recording.origins_known {
            row.push(
                truth_of(recording, detection)
                    .unwrap_or_default()
                    .to_owned(),
            );
        }
        put(table, &row)?;
    }
    Ok(())
}

/// Refuses a recording that has reports, but none for this file.
fn check_reports(recording: &Recording, wanted: Report) -> Result<(), Box<Fault>> {
    let has = |report: &Report| {
        recording
            .detections()
            .any(|detection| Report::of(&detection.measurement) == *report)
    };
    let there: Vec<&str> = [Report::Position, Report::Polar, Report::Bearing]
        .iter()
        .filter(|report| has(report))
        .map(|report| report.writer().name)
        .collect();
    let name = wanted.writer().name;
    if there.is_empty() || there.contains(&name) {
        return Ok(());
    }
    let columns = wanted.columns().join(" and ");
    let detail = format!("'{name}' holds detections with {columns}, the dataset has others");
    Err(refusal("unsupported", detail)
        .allowing(there.join(", "))
        .into())
}

fn measured(measurement: &Measurement) -> Vec<f64> {
    match *measurement {
        Measurement::Position { x_m, y_m } | Measurement::Position3 { x_m, y_m, .. } => {
            vec![x_m, y_m]
        }
        Measurement::RangeBearing {
            range_m,
            bearing_rad,
            ..
        }
        | Measurement::RangeBearingElevation {
            range_m,
            bearing_rad,
            ..
        } => vec![from_x_axis(bearing_rad), range_m],
        Measurement::Bearing { bearing_rad }
        | Measurement::BearingElevation { bearing_rad, .. } => vec![from_x_axis(bearing_rad)],
    }
}

/// Counterclockwise from the x axis, of a bearing clockwise from north (rad).
fn from_x_axis(bearing_rad: f64) -> f64 {
    let (sin, cos) = (FRAC_PI_2 - bearing_rad).sin_cos();
    sin.atan2(cos)
}

fn write_truth(truth: &TruthSet, table: &mut Table) -> Result<(), WriteError> {
    let axes = truth.space().axes();
    let mut points = truth.targets().iter().flat_map(|target| &target.points);
    let has_rates = points.all(|point| point.velocity.is_some());
    let mut header = vec!["time_s", "truth_id"];
    header.extend(&AXES[..axes]);
    header.extend(RATES[..axes].iter().filter(|_| has_rates));
    put(table, &header)?;
    let mut found: Vec<_> = truth
        .targets()
        .iter()
        .flat_map(|target| target.points.iter().map(|point| (&target.truth_id, point)))
        .collect();
    found.sort_by(|one, next| one.1.time_s.total_cmp(&next.1.time_s));
    for (truth_id, point) in found {
        let mut row = vec![number(point.time_s), truth_id.clone()];
        push_place(&mut row, Some(&point.position), axes);
        push_place(
            &mut row,
            point.velocity.as_ref().filter(|_| has_rates),
            axes,
        );
        put(table, &row)?;
    }
    Ok(())
}

fn write_tracks(set: &TrackSet, table: &mut Table) -> Result<(), WriteError> {
    let axes = set.space.axes();
    let mut found: Vec<_> = set
        .tracks
        .iter()
        .flat_map(|track| track.points.iter().map(|point| (&track.track_id, point)))
        .collect();
    found.sort_by(|one, next| one.1.time_s.total_cmp(&next.1.time_s));
    let has_rates = found
        .iter()
        .all(|(_, point)| point.estimate.velocity.is_some());
    let has_covariance = found
        .iter()
        .all(|(_, point)| point.estimate.covariance.is_some());
    let mut header: Vec<String> = ["time_s", "track_id"].map(str::to_owned).to_vec();
    header.extend(AXES[..axes].iter().map(|name| (*name).to_owned()));
    let rates = RATES[..axes].iter().filter(|_| has_rates);
    header.extend(rates.map(|name| (*name).to_owned()));
    if has_covariance {
        header.extend(covariance_columns(set.space));
    }
    header.push("status".to_owned());
    put(table, &header)?;
    for (track_id, point) in found {
        let estimate = &point.estimate;
        let mut row = vec![number(point.time_s), track_id.clone()];
        push_place(&mut row, Some(&estimate.position), axes);
        push_place(
            &mut row,
            estimate.velocity.as_ref().filter(|_| has_rates),
            axes,
        );
        let elements = estimate.covariance.as_deref().filter(|_| has_covariance);
        row.extend(
            elements
                .unwrap_or_default()
                .iter()
                .map(|value| number(*value)),
        );
        row.push(point.status.map_or("", |status| status.name()).to_owned());
        put(table, &row)?;
    }
    Ok(())
}

/// Names of the upper triangle: coordinates, then their rates.
fn covariance_columns(space: Space) -> Vec<String> {
    let variables = VARIABLES[space.axes() - 2];
    let variables = &variables[..2 * space.axes()];
    let mut columns = Vec::new();
    for (row, one) in variables.iter().enumerate() {
        columns.extend(
            variables[row..]
                .iter()
                .map(|other| format!("p_{one}{other}")),
        );
    }
    columns
}

fn push_place(row: &mut Vec<String>, place: Option<&Place>, axes: usize) {
    let values = place.into_iter().flat_map(|place| place.iter().take(axes));
    row.extend(values.map(|value| number(*value)));
}

fn number(value: f64) -> String {
    let mut text = String::new();
    push_number(&mut text, value);
    text
}

fn put<Cell: AsRef<[u8]>>(table: &mut Table, row: &[Cell]) -> Result<(), WriteError> {
    Ok(table.write_record(row).map_err(std::io::Error::from)?)
}
