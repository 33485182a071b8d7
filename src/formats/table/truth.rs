//! Truth: rows of any interleaving of targets; each target's times rise. A row that repeats its target's last one is taken
//! once, and told.

use super::degrees::degrees;
use super::header::Header;
use super::interner::Interner;
use super::row::RowReader;
use super::{Repeats, Rows, Sink};
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::state::Position;
use crate::model::truth::{Target, TruePlace, TruthPoint, TruthSet};
use std::io;

/// Where the columns of truth are.
struct Columns {
    time: usize,
    truth: usize,
    place: PlaceColumns,
}

enum PlaceColumns {
    Plane {
        position: [usize; 2],
        velocity: Option<[usize; 2]>,
    },
    Bearing(usize),
}

/// A target being read: its points and the row of the last one.
#[derive(Default)]
struct Path {
    points: Vec<TruthPoint>,
    last_row: u64,
}

/// Reads truth; also whether there was no row at all.
///
/// # Errors
/// Every fault of the rows.
pub fn read(
    rows: &mut dyn Rows,
    header: &Header,
    warnings: &mut Vec<String>,
) -> Result<(Dataset, bool), Vec<Fault>> {
    let columns = Columns {
        time: header.required("time_s"),
        truth: header.required("truth_id"),
        place: PlaceColumns::from_header(header),
    };
    let mut reader = RowReader::new(rows);
    let mut names = Interner::default();
    let (mut paths, mut repeats): (Vec<Path>, Repeats) = Default::default();
    while reader.advance() {
        read_row(
            &mut reader,
            &columns,
            &mut names,
            (&mut paths, &mut repeats),
        );
    }
    warnings.extend(reader.repeats_warning(&repeats));
    reader.faults.finish()?;
    let empty = paths.is_empty();
    Ok((
        Dataset::Truth(TruthSet::new(sort_targets(names, paths))?),
        empty,
    ))
}

fn read_row(
    reader: &mut RowReader,
    columns: &Columns,
    names: &mut Interner,
    (paths, repeats): (&mut Vec<Path>, &mut Repeats),
) {
    let time_s = reader.number(columns.time);
    reader.require_name(columns.truth);
    let place = columns.place.read(reader);
    if reader.text(columns.truth).is_empty() {
        return;
    }
    let index = names.number(reader.text(columns.truth)) as usize;
    if paths.len() <= index {
        paths.resize_with(index + 1, Path::default);
    }
    let path = &mut paths[index];
    let point = time_s
        .zip(place)
        .map(|(time_s, place)| TruthPoint { time_s, place });
    if point.is_some() && point.as_ref() == path.points.last() {
        return repeats.add(reader.row());
    }
    if let (Some(time_s), Some(last)) = (time_s, path.points.last()) {
        check_order(reader, columns, time_s, last.time_s, path.last_row);
    }
    if let Some(point) = point {
        path.points.push(point);
        path.last_row = reader.row();
    }
}

impl PlaceColumns {
    fn from_header(header: &Header) -> Self {
        if header.find("x_m").is_none() {
            return PlaceColumns::Bearing(header.required("bearing_deg"));
        }
        PlaceColumns::Plane {
            position: [header.required("x_m"), header.required("y_m")],
            velocity: header.all(["vx_mps", "vy_mps"]),
        }
    }

    fn read(&self, reader: &mut RowReader) -> Option<TruePlace> {
        match *self {
            PlaceColumns::Plane { position, velocity } => {
                let [x_m, y_m] = position.map(|column| reader.number(column));
                let velocity_mps = reader
                    .all_or_none(velocity)
                    .map(|[vx, vy]| Position::new(vx, vy));
                Some(TruePlace::Plane {
                    position_m: Position::new(x_m?, y_m?),
                    velocity_mps,
                })
            }
            PlaceColumns::Bearing(column) => {
                reader.number(column).map(|degrees| TruePlace::Bearing {
                    bearing_rad: degrees.to_radians(),
                })
            }
        }
    }
}

fn check_order(reader: &mut RowReader, columns: &Columns, time_s: f64, before_s: f64, row: u64) {
    let (target, before) = (reader.text(columns.truth), reader.called(row));
    if time_s == before_s {
        let detail = format!("target '{target}' is at {time_s} s twice: also on {before}");
        reader.fault(columns.time, "duplicate", detail);
    } else if time_s < before_s {
        let detail =
            format!("target '{target}': time {time_s} s comes after {before_s} s on {before}");
        reader.fault(columns.time, "unsorted", detail);
    }
}

/// The targets in natural order of their names.
fn sort_targets(names: Interner, mut paths: Vec<Path>) -> Vec<Target> {
    let (names, place) = names.sorted();
    let mut targets: Vec<Target> = names
        .into_iter()
        .map(|truth_id| Target {
            truth_id,
            points: Vec::new(),
        })
        .collect();
    for (path, &place) in paths.iter_mut().zip(&place) {
        targets[place as usize].points = std::mem::take(&mut path.points);
    }
    targets
}

/// Writes target after target.
///
/// # Errors
/// What the output says.
pub fn write(truth: &TruthSet, sink: &mut dyn Sink) -> io::Result<()> {
    let has_velocity = |point: &TruthPoint| point.velocity_mps().is_some();
    let with_velocity = truth
        .targets()
        .iter()
        .any(|target| target.points.iter().any(has_velocity));
    let of_bearings = truth.is_of_bearings();
    let columns: &[&str] = match (of_bearings, with_velocity) {
        (true, _) => &["time_s", "truth_id", "bearing_deg"],
        (false, false) => &["time_s", "truth_id", "x_m", "y_m"],
        (false, true) => &["time_s", "truth_id", "x_m", "y_m", "vx_mps", "vy_mps"],
    };
    sink.begin(columns)?;
    for target in truth.targets() {
        for point in &target.points {
            sink.number(Some(point.time_s))?;
            sink.text(Some(&target.truth_id))?;
            write_place(&point.place, with_velocity, sink)?;
            sink.end_row()?;
        }
    }
    Ok(())
}

fn write_place(place: &TruePlace, with_velocity: bool, sink: &mut dyn Sink) -> io::Result<()> {
    match place {
        TruePlace::Bearing { bearing_rad } => sink.number(Some(degrees(*bearing_rad))),
        TruePlace::Plane {
            position_m,
            velocity_mps,
        } => {
            sink.number(Some(position_m.x))?;
            sink.number(Some(position_m.y))?;
            if with_velocity {
                sink.number(velocity_mps.map(|velocity| velocity.x))?;
                sink.number(velocity_mps.map(|velocity| velocity.y))?;
            }
            Ok(())
        }
    }
}
