//! Rows told one by one as they come. Without scan numbers a scan is the rows of one time, or a frame of the period that is given:
//! whether a sensor turns is seen from a whole file only.

use super::columns::Columns;
use super::{Builder, Found};
use crate::formats::live::{Broken, Listener, LiveReport, ScanKey, ScanKind, no_origin};
use crate::formats::table::header::Header;
use crate::formats::table::row::RowReader;
use crate::formats::table::{Interner, Rows};
use crate::formats::{Reading, Units};
use crate::geodesy::Stereographic;
use crate::model::fault::Fault;
use crate::model::scan::Measurement;
use std::sync::Arc;

/// Names of sensors that are known at most; beyond it they are made known anew.
const MOST_SENSORS: usize = 10_000;

/// Reads rows to their end.
///
/// # Errors
/// Latitudes without a plane.
pub fn follow(
    (rows, header): (&mut dyn Rows, &Header),
    reading: &Reading,
    broken: &Broken,
    listener: &mut dyn Listener,
) -> Result<Units, Vec<Fault>> {
    let mut columns = Columns::from_header(header);
    // Nobody asks a session for these.
    (columns.truth, columns.attributes) = (None, Vec::new());
    let plane = reading.origin.map(Stereographic::from);
    if columns.is_geographic && plane.is_none() {
        return Err(no_origin());
    }
    if columns.pose.are_there() {
        listener.warn("the rows say where their sensors were, which is not pushed".to_owned());
    }
    let mut reader = RowReader::new(rows, header, reading);
    let mut told = Told {
        builder: Builder::default(),
        frame_s: reading.frame_s,
        plane: plane.filter(|_| columns.is_geographic),
        ignored: Units::default(),
    };
    while reader.advance() {
        let report = told.row(&mut reader, &columns);
        let mut units = reader.units();
        told.count(&mut units, broken);
        listener.units(&units);
        if let Some(report) = report {
            listener.report(report);
        }
    }
    let mut units = reader.units();
    told.count(&mut units, broken);
    Ok(units)
}

/// What the rows told so far.
struct Told {
    builder: Builder,
    frame_s: Option<f64>,
    plane: Option<Stereographic>,
    ignored: Units,
}

impl Told {
    /// What the current row says, unless it is wrong, repeats the one before or is the header again.
    fn row(&mut self, reader: &mut RowReader, columns: &Columns) -> Option<LiveReport> {
        if reader.is_header() {
            self.ignored.ignore("header", 1);
            return None;
        }
        let (before, repeated) = (self.builder.found.len(), self.builder.repeats.count());
        self.builder.read_row(reader, columns);
        if self.builder.repeats.count() > repeated {
            self.ignored.ignore("duplicate", 1);
        }
        let is_new = self.builder.found.len() > before;
        let report = is_new.then(|| self.report(columns)).flatten();
        self.forget();
        report
    }

    fn report(&self, columns: &Columns) -> Option<LiveReport> {
        let found = self.builder.found.last()?;
        let mut detection = found.detection;
        if let (Some(plane), Some(detection)) = (&self.plane, &mut detection)
            && let Measurement::Position { x_m, y_m } | Measurement::Position3 { x_m, y_m, .. } =
                &mut detection.measurement
        {
            let place_m = plane.project(*y_m, *x_m);
            (*x_m, *y_m) = (place_m.x, place_m.y);
        }
        Some(LiveReport {
            sensor: Arc::from(self.builder.sensors.name(found.sensor)),
            scan: self.scan(found, columns),
            time_s: found.time_s,
            detection,
            detection_id: self.builder.ids.last()?.clone(),
            identity: None,
            unit: found.row,
            units: 1,
        })
    }

    fn scan(&self, found: &Found, columns: &Columns) -> ScanKey {
        let (number, kind) = match (columns.scan.and(found.scan), self.frame_s) {
            (Some(number), _) => (i64::from(number), ScanKind::Numbered),
            (None, Some(frame_s)) => ((found.time_s / frame_s).floor() as i64, ScanKind::Frame),
            (None, None) => (in_order(found.time_s), ScanKind::Instant),
        };
        ScanKey { number, kind }
    }

    /// Only the row before is of use later.
    fn forget(&mut self) {
        let builder = &mut self.builder;
        let first = builder.found.len().saturating_sub(1);
        builder.found.drain(..first);
        builder.ids.drain(..first);
        builder.poses.clear();
        if builder.sensors.names().len() > MOST_SENSORS {
            builder.sensors = Interner::default();
        }
    }

    /// Adds what the reader of rows does not know: rows that were used are told apart from those that were ignored.
    fn count(&self, units: &mut Units, broken: &Broken) {
        let ignored = self.ignored.ignored_count();
        units.used = units.used.saturating_sub(ignored);
        units.total -= ignored;
        units.add(&self.ignored);
        units.add(&broken.borrow());
    }
}

/// A number that rises with a time.
fn in_order(time_s: f64) -> i64 {
    let bits = time_s.to_bits() as i64;
    bits ^ ((bits >> 63) as u64 >> 1) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_times_are_in_the_order_of_times() {
        let times_s = [-1e9, -2.5, -0.0, 0.0, 1e-9, 3.0, 1_700_000_000.25];
        let numbers = times_s.map(in_order);
        assert!(numbers.is_sorted());
        assert_ne!(in_order(3.0), in_order(3.000_000_000_000_000_4));
    }
}
