//! Truth: rows of any interleaving of targets; each target's times rise. A row that repeats its target's last one is taken
//! once, and told.

use super::estimate::{EstimateColumns, EstimateLayout};
use super::header::Header;
use super::interner::Interner;
use super::row::RowReader;
use super::{Repeats, Rows, Sink};
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::truth::{Target, TruthPoint, TruthSet};
use std::io;

/// Where the columns of truth are.
struct Columns {
    time: usize,
    truth: usize,
    estimate: EstimateColumns,
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
        estimate: EstimateColumns::of_truth(header),
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
        Dataset::Truth(TruthSet::new(
            columns.estimate.space,
            sort_targets(names, paths),
        )?),
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
    let estimate = columns.estimate.read(reader);
    if reader.text(columns.truth).is_empty() {
        return;
    }
    let index = names.number(reader.text(columns.truth)) as usize;
    if paths.len() <= index {
        paths.resize_with(index + 1, Path::default);
    }
    let path = &mut paths[index];
    let point = time_s.zip(estimate).map(|(time_s, estimate)| TruthPoint {
        height_m: None,
        time_s,
        position: estimate.position,
        velocity: estimate.velocity,
    });
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
    let mut points = truth.targets().iter().flat_map(|target| &target.points);
    let layout = EstimateLayout {
        space: truth.space(),
        velocity: points.any(|point| point.velocity.is_some()),
        covariance: false,
    };
    let mut columns = vec!["time_s", "truth_id"];
    columns.extend(layout.columns());
    sink.begin(&columns)?;
    for target in truth.targets() {
        for point in &target.points {
            sink.number(Some(point.time_s))?;
            sink.text(Some(&target.truth_id))?;
            layout.write(&point.position, point.velocity.as_ref(), None, sink)?;
            sink.end_row()?;
        }
    }
    Ok(())
}
