//! GeoJSON (RFC 7946): truth and tracks as lines, detections as points. Longitude, latitude, height; seven decimals.
//!
//! A line has `coordTimes`, an instant for each of its coordinates, as togeojson writes them and time plugins of Leaflet read
//! them; of several pieces (after silence, or beyond 180 degrees) a list of lists. Where a line crosses 180 degrees it ends there
//! and goes on at the other side, at a place and time between its neighbours. A piece of one point has it twice; a path of one
//! point is a point. A detection without a place (a bearing alone) has the geometry null.
//!
//! `trips` writes the seconds since 1970 as a fourth coordinate instead, and the height 0 where it is not known: the trip layer
//! of kepler.gl wants that. RFC 7946 (section 3.1.1) advises against more than three.
//!
//! # Reference
//! H. Butler et al., The GeoJSON Format, RFC 7946, 2016; 3.1.9 of the antimeridian.

use super::earth::{Earth, Spot};
use super::paths::{self, Path, id_name};
use super::seen::{self, Seen};
use super::text::{DEGREES, METRES, SECONDS, instant, push_fixed, push_json};
use super::{PATHS, TABLES, WriteError, Writer};
use crate::model::dataset::Dataset;
use crate::model::time::TimeBase;
use std::io::Write;

pub const WRITER: Writer = Writer {
    name: "geojson",
    media_type: "application/geo+json",
    extension: "geojson",
    summary: "GeoJSON: lines of truth and tracks, points of detections, with their times",
    kinds: TABLES,
    feature: None,
    write: |dataset, out| write(dataset, Shape::Plain, out),
};

pub const TRIPS: Writer = Writer {
    name: "trips",
    media_type: "application/geo+json",
    extension: "geojson",
    summary: "GeoJSON whose fourth coordinate is the time, for the trip layer of kepler.gl",
    kinds: PATHS,
    feature: None,
    write: |dataset, out| write(dataset, Shape::Trips, out),
};

#[derive(Clone, Copy, PartialEq, Eq)]
enum Shape {
    Plain,
    Trips,
}

impl Shape {
    fn name(self) -> &'static str {
        match self {
            Shape::Plain => WRITER.name,
            Shape::Trips => TRIPS.name,
        }
    }

    fn push_position(self, text: &mut String, spot: &Spot) {
        text.push('[');
        push_fixed(text, spot.lon_deg, DEGREES);
        text.push(',');
        push_fixed(text, spot.lat_deg, DEGREES);
        let height_m = spot.height_m.or((self == Shape::Trips).then_some(0.0));
        if let Some(height_m) = height_m {
            text.push(',');
            push_fixed(text, height_m, METRES);
        }
        if self == Shape::Trips {
            text.push(',');
            push_fixed(text, spot.time_s, SECONDS);
        }
        text.push(']');
    }
}

fn write(dataset: &Dataset, shape: Shape, out: &mut dyn Write) -> Result<(), WriteError> {
    let earth = Earth::of(dataset, shape.name())?;
    let mut features = Features {
        shape,
        altitude: earth.altitude_reference(),
        time_base: dataset.time_base(),
        text: String::new(),
        is_first: true,
        out,
    };
    features
        .out
        .write_all(b"{\"type\":\"FeatureCollection\",\"features\":[\n")?;
    if matches!(dataset, Dataset::Detections(_)) {
        seen::for_each(dataset, &earth, |seen| features.detection(&seen))?;
    } else {
        let id = id_name(dataset);
        paths::for_each(dataset, &earth, |path| features.path(id, path))?;
    }
    features.out.write_all(b"\n]}\n")?;
    Ok(())
}

struct Features<'a> {
    shape: Shape,
    altitude: &'static str,
    time_base: TimeBase,
    /// Of the feature at hand.
    text: String,
    is_first: bool,
    out: &'a mut dyn Write,
}

impl Features<'_> {
    fn path(&mut self, id: &str, mut path: Path) -> Result<(), WriteError> {
        path.fill_heights();
        let lines = lines(&path);
        self.begin();
        let points = path.spots().count();
        match (lines.as_slice(), points) {
            (_, 1) => {
                self.text.push_str("\"Point\",\"coordinates\":");
                self.shape.push_position(&mut self.text, &lines[0][0]);
            }
            ([line], _) => {
                self.text.push_str("\"LineString\",\"coordinates\":");
                self.line(line);
            }
            (lines, _) => {
                self.text.push_str("\"MultiLineString\",\"coordinates\":");
                self.listed(lines, |features, line| {
                    features.line(line);
                    Ok(())
                })?;
            }
        }
        self.text.push_str("},\"properties\":{");
        self.known(id, path.id);
        if let Some(status) = path.status {
            self.known("status", status.name());
        }
        for (name, value) in path.attributes.into_iter().flatten() {
            self.known(name, value);
        }
        self.times(&path, &lines, points)?;
        self.end(path.has_heights())
    }

    /// `start`, `end` and `coordTimes`.
    fn times(&mut self, path: &Path, lines: &[Vec<Spot>], points: usize) -> Result<(), WriteError> {
        for (name, spot) in [("start", path.spots().next()), ("end", path.spots().last())] {
            if let Some(spot) = spot {
                self.known(name, &instant(spot.time_s)?);
            }
        }
        if self.shape == Shape::Trips {
            return Ok(());
        }
        self.text.push_str(",\"coordTimes\":");
        match lines {
            [line] if points == 1 => self.instants(&line[..1]),
            [line] => self.instants(line),
            lines => self.listed(lines, |features, line| features.instants(line)),
        }
    }

    fn listed(
        &mut self,
        lines: &[Vec<Spot>],
        push: impl Fn(&mut Self, &[Spot]) -> Result<(), WriteError>,
    ) -> Result<(), WriteError> {
        for (index, line) in lines.iter().enumerate() {
            self.text.push(if index == 0 { '[' } else { ',' });
            push(self, line)?;
        }
        self.text.push(']');
        Ok(())
    }

    fn line(&mut self, line: &[Spot]) {
        for (index, spot) in line.iter().enumerate() {
            self.text.push(if index == 0 { '[' } else { ',' });
            self.shape.push_position(&mut self.text, spot);
        }
        self.text.push(']');
    }

    fn instants(&mut self, line: &[Spot]) -> Result<(), WriteError> {
        for (index, spot) in line.iter().enumerate() {
            self.text.push(if index == 0 { '[' } else { ',' });
            push_json(&mut self.text, &instant(spot.time_s)?);
        }
        self.text.push(']');
        Ok(())
    }

    fn detection(&mut self, seen: &Seen) -> Result<(), WriteError> {
        self.begin();
        match &seen.spot {
            Some(spot) => {
                self.text.push_str("\"Point\",\"coordinates\":");
                self.shape.push_position(&mut self.text, spot);
                self.text.push('}');
            }
            None => {
                let unlocated = self.text.len() - GEOMETRY.len();
                self.text.truncate(unlocated);
                self.text.push_str("null");
            }
        }
        self.text.push_str(",\"properties\":{");
        self.known("detection_id", seen.id);
        self.known("sensor_id", seen.sensor_id);
        self.known("time", &instant(seen.time_s)?);
        self.text.push_str(&format!(",\"scan\":{}", seen.scan));
        for (name, value) in seen::numbers(seen.detection) {
            self.text.push_str(&format!(",\"{name}\":"));
            push_fixed(&mut self.text, value, SECONDS);
        }
        if let Some(truth_id) = seen.truth_id {
            self.known("truth_id", truth_id);
        }
        for (name, value) in &seen.attributes {
            self.known(name, value);
        }
        self.end(seen.spot.is_some_and(|spot| spot.height_m.is_some()))
    }

    fn begin(&mut self) {
        self.text.clear();
        if !std::mem::take(&mut self.is_first) {
            self.text.push_str(",\n");
        }
        self.text.push_str("{\"type\":\"Feature\",\"geometry\":");
        self.text.push_str(GEOMETRY);
    }

    /// A property that is a text.
    fn known(&mut self, name: &str, value: &str) {
        if !self.text.ends_with('{') {
            self.text.push(',');
        }
        self.text.push_str(&format!("\"{name}\":"));
        push_json(&mut self.text, value);
    }

    fn end(&mut self, has_heights: bool) -> Result<(), WriteError> {
        if has_heights {
            self.known("altitude_reference", self.altitude);
        }
        if !self.time_base.is_utc() {
            self.known("time_base", "relative");
        }
        self.text.push_str("}}");
        self.out.write_all(self.text.as_bytes())?;
        Ok(())
    }
}

const GEOMETRY: &str = "{\"type\":";

/// The pieces of a path, cut at 180 degrees; each has two points at least.
fn lines(path: &Path) -> Vec<Vec<Spot>> {
    let mut lines = Vec::new();
    for piece in &path.pieces {
        let mut line: Vec<Spot> = Vec::new();
        for spot in piece {
            if let Some(crossing) = line.last().and_then(|last| crossing(last, spot)) {
                line.push(crossing);
                let other_side = Spot {
                    lon_deg: -crossing.lon_deg,
                    ..crossing
                };
                lines.push(std::mem::replace(&mut line, vec![other_side]));
            }
            line.push(*spot);
        }
        lines.push(line);
    }
    for line in &mut lines {
        if let [spot] = line.as_slice() {
            let spot = *spot;
            line.push(spot);
        }
    }
    lines
}

/// Where the shorter way from one place to the next crosses 180 degrees, on the side of the first.
fn crossing(from: &Spot, to: &Spot) -> Option<Spot> {
    let east_deg = to.lon_deg - from.lon_deg;
    if east_deg.abs() <= 180.0 {
        return None;
    }
    let side_deg = 180.0_f64.copysign(from.lon_deg);
    let whole_deg = 360.0 - east_deg.abs();
    let share = if whole_deg > 0.0 {
        (side_deg - from.lon_deg).abs() / whole_deg
    } else {
        0.0
    };
    let between = |from: f64, to: f64| from + (to - from) * share;
    Some(Spot {
        time_s: between(from.time_s, to.time_s),
        lat_deg: between(from.lat_deg, to.lat_deg),
        lon_deg: side_deg,
        height_m: from
            .height_m
            .zip(to.height_m)
            .map(|(from_m, to_m)| between(from_m, to_m)),
    })
}
