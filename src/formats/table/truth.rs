//! Truth: rows of any interleaving of targets, each target's brought into the order of time. A row that repeats another is taken
//! once, and told.

use super::codes::Codes;
use super::estimate::{EstimateColumns, EstimateLayout};
use super::ground::{self, Ground};
use super::header::Header;
use super::interner::Interner;
use super::row::RowReader;
use super::{Repeats, Sink, Table};
use crate::formats::Units;
use crate::formats::disorder::Disorder;
use crate::geodesy::Stereographic;
use crate::model::attributes::Attributes;
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::truth::{Target, TruthPoint, TruthSet};
use std::io;

/// Where the columns of truth are.
struct Columns {
    time: usize,
    truth: usize,
    estimate: EstimateColumns,
    attributes: Vec<(&'static str, usize)>,
}

/// A target being read: its points, the row of each, and its latest time.
struct Path {
    points: Vec<(TruthPoint, u64)>,
    latest_s: f64,
}

#[derive(Default)]
struct Builder {
    names: Interner,
    paths: Vec<Path>,
    ground: Ground,
    repeats: Repeats,
    disorder: Disorder,
    attributes: Attributes,
    codes: Codes,
}

/// Reads truth, and tells how the rows fared.
///
/// # Errors
/// Every fault of the rows.
pub fn read(
    table: Table,
    header: &Header,
    warnings: &mut Vec<String>,
) -> Result<(Dataset, Units), Vec<Fault>> {
    let columns = Columns {
        time: header.required("time_s"),
        truth: header.required("truth_id"),
        estimate: EstimateColumns::of_truth(header),
        attributes: header.attributes(),
    };
    let mut reader = RowReader::new(table.rows, header, table.reading);
    let mut builder = Builder::default();
    while reader.advance() {
        builder.read_row(&mut reader, &columns);
    }
    builder.sort_points(&mut reader, &columns);
    warnings.extend(reader.told());
    warnings.extend(builder.disorder.warning(reader.row_word()));
    warnings.extend(reader.repeats_warning(&builder.repeats));
    let base = reader.time_base();
    let units = reader.finish(builder.repeats.count() as u64)?;
    let mut truth = builder.finish(&columns, &table)?;
    truth.time_base = base;
    Ok((Dataset::Truth(truth), units))
}

impl Builder {
    fn read_row(&mut self, reader: &mut RowReader, columns: &Columns) {
        let time_s = reader.time(columns.time);
        reader.require_name(columns.truth);
        let estimate = columns.estimate.read(reader);
        let height_m = columns.estimate.read_height(reader);
        let (Some(time_s), Some(estimate), true) = (time_s, estimate, reader.is_sound()) else {
            return;
        };
        columns
            .estimate
            .note_earth(&estimate.position, reader, &mut self.ground);
        let index = self.names.number(reader.text(columns.truth)) as usize;
        if self.paths.len() <= index {
            self.paths.resize_with(index + 1, Path::empty);
        }
        let path = &mut self.paths[index];
        self.disorder.note(&mut path.latest_s, time_s, reader.row());
        let point = TruthPoint {
            time_s,
            position: estimate.position,
            velocity: estimate.velocity,
            height_m,
        };
        path.points.push((point, reader.row()));
        reader.note_attributes(columns.truth, &columns.attributes, &mut self.attributes);
        self.codes
            .note(reader, &columns.attributes, (index as u32, time_s));
    }

    /// Brings each target's points into the order of time; of equal ones one stays.
    fn sort_points(&mut self, reader: &mut RowReader, columns: &Columns) {
        for (index, path) in self.paths.iter_mut().enumerate() {
            path.points
                .sort_by(|a, b| a.0.time_s.total_cmp(&b.0.time_s));
            let repeats = &mut self.repeats;
            path.points.dedup_by(|point, before| {
                let is_repeated = point.0 == before.0;
                if is_repeated {
                    repeats.add(point.1);
                }
                is_repeated
            });
            for pair in path
                .points
                .windows(2)
                .filter(|pair| pair[0].0.time_s == pair[1].0.time_s)
            {
                let (target, time_s) = (self.names.name(index as u32), pair[1].0.time_s);
                let before = reader.called(pair[0].1);
                let detail = format!("target '{target}' is at {time_s} s twice: also on {before}");
                reader.fault_in(pair[1].1, columns.time, "duplicate", detail);
            }
        }
    }

    /// The targets in natural order of their names.
    fn finish(self, columns: &Columns, table: &Table) -> Result<TruthSet, Vec<Fault>> {
        let frame = self.ground.frame(table.reading)?;
        let plane = frame
            .map(Stereographic::from)
            .filter(|_| columns.estimate.is_geographic());
        let changes = self.codes.finish(&columns.attributes, &self.names);
        let (names, place) = self.names.sorted();
        let empty = |truth_id| Target {
            truth_id,
            points: Vec::new(),
        };
        let mut targets: Vec<Target> = names.into_iter().map(empty).collect();
        for (path, &place) in self.paths.into_iter().zip(&place) {
            let points = &mut targets[place as usize].points;
            points.extend(path.points.into_iter().map(|(point, _)| point));
            if let Some(plane) = &plane {
                for point in points {
                    ground::settle(plane, &mut point.position, point.velocity.as_mut());
                }
            }
        }
        let mut truth = TruthSet::new(columns.estimate.space, targets)?;
        (truth.frame, truth.attributes) = (frame, self.attributes);
        truth.changes = changes;
        Ok(truth)
    }
}

impl Path {
    fn empty() -> Self {
        Path {
            points: Vec::new(),
            latest_s: f64::NEG_INFINITY,
        }
    }
}

/// Writes target after target.
///
/// # Errors
/// What the output says.
pub fn write(truth: &TruthSet, sink: &mut dyn Sink) -> io::Result<()> {
    let points = || truth.targets().iter().flat_map(|target| &target.points);
    let layout = EstimateLayout {
        space: truth.space(),
        velocity: points().any(|point| point.velocity.is_some()),
        covariance: false,
        height: points().any(|point| point.height_m.is_some()),
        frame: truth.frame,
    };
    let attributes = layout.attributes(&truth.attributes);
    let mut columns = vec!["time_s", "truth_id"];
    columns.extend(layout.columns());
    columns.extend(&attributes);
    sink.begin(&columns)?;
    let plane = layout.plane();
    for target in truth.targets() {
        for point in &target.points {
            sink.number(Some(point.time_s))?;
            sink.text(Some(&target.truth_id))?;
            layout.write(&point.position, point.velocity.as_ref(), None, sink)?;
            layout.write_beside(plane.as_ref(), &point.position, point.height_m, sink)?;
            for name in &attributes {
                let of = (target.truth_id.as_str(), point.time_s);
                sink.text(truth.changes.word(&truth.attributes, of, name))?;
            }
            sink.end_row()?;
        }
    }
    Ok(())
}
