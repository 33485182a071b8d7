//! Truth: rows of any interleaving of targets; each target's times rise.

use super::header::Header;
use super::interner::Interner;
use super::row::RowReader;
use super::{Rows, Sink};
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::state::Position;
use crate::model::truth::{Target, TruthPoint, TruthSet};
use std::io;

/// Where the columns of truth are.
struct Columns {
    time: usize,
    truth: usize,
    position: [usize; 2],
    velocity: Option<[usize; 2]>,
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
pub fn read(rows: &mut dyn Rows, header: &Header) -> Result<(Dataset, bool), Vec<Fault>> {
    let columns = Columns {
        time: header.required("time_s"),
        truth: header.required("truth_id"),
        position: [header.required("x_m"), header.required("y_m")],
        velocity: header.find("vx_mps").zip(header.find("vy_mps")).map(|(vx, vy)| [vx, vy]),
    };
    let mut reader = RowReader::new(rows);
    let mut names = Interner::default();
    let mut paths: Vec<Path> = Vec::new();
    while reader.advance() {
        read_row(&mut reader, &columns, &mut names, &mut paths);
    }
    reader.faults.finish()?;
    let empty = paths.is_empty();
    Ok((Dataset::Truth(TruthSet::new(sorted(names, paths))?), empty))
}

fn read_row(reader: &mut RowReader, columns: &Columns, names: &mut Interner, paths: &mut Vec<Path>) {
    let time_s = reader.number(columns.time);
    reader.require_text(columns.truth);
    let [x_m, y_m] = columns.position.map(|column| reader.number(column));
    let velocity = reader.all_or_none(columns.velocity).map(|[vx, vy]| Position::new(vx, vy));
    if reader.text(columns.truth).is_empty() {
        return;
    }
    let index = names.number(reader.text(columns.truth)) as usize;
    if paths.len() <= index {
        paths.resize_with(index + 1, Path::default);
    }
    let path = &mut paths[index];
    if let (Some(time_s), Some(last)) = (time_s, path.points.last()) {
        check_order(reader, columns, time_s, last.time_s, path.last_row);
    }
    if let (Some(time_s), Some(x_m), Some(y_m)) = (time_s, x_m, y_m) {
        path.points.push(TruthPoint { time_s, position_m: Position::new(x_m, y_m), velocity_mps: velocity });
        path.last_row = reader.row();
    }
}

fn check_order(reader: &mut RowReader, columns: &Columns, time_s: f64, before_s: f64, row: u64) {
    let (target, before) = (reader.text(columns.truth), reader.called(row));
    if time_s == before_s {
        let detail = format!("target '{target}' is at {time_s} s twice: also on {before}");
        reader.fault(columns.time, "duplicate", detail);
    } else if time_s < before_s {
        let detail = format!("target '{target}': time {time_s} s comes after {before_s} s on {before}");
        reader.fault(columns.time, "unsorted", detail);
    }
}

/// The targets in natural order of their names.
fn sorted(names: Interner, mut paths: Vec<Path>) -> Vec<Target> {
    let (names, place) = names.sorted();
    let mut targets: Vec<Target> = names.into_iter().map(|truth_id| Target { truth_id, points: Vec::new() }).collect();
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
    let with_velocity = truth.targets().iter().any(|target| target.points.iter().any(|point| point.velocity_mps.is_some()));
    let columns = ["time_s", "truth_id", "x_m", "y_m", "vx_mps", "vy_mps"];
    sink.begin(&columns[..if with_velocity { 6 } else { 4 }])?;
    for target in truth.targets() {
        for point in &target.points {
            sink.number(Some(point.time_s))?;
            sink.text(Some(&target.truth_id))?;
            sink.number(Some(point.position_m.x))?;
            sink.number(Some(point.position_m.y))?;
            if with_velocity {
                sink.number(point.velocity_mps.map(|velocity| velocity.x))?;
                sink.number(point.velocity_mps.map(|velocity| velocity.y))?;
            }
            sink.end_row()?;
        }
    }
    Ok(())
}
