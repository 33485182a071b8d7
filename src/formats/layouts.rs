//! Tables as others write them, told by their column names: AIS, state vectors of aircraft, GPS logs. Each is one entry of
//! [`LAYOUTS`]; its rows become the reports of a feed, so that a wrong one is counted and the rest is used.

use super::clock::Clock;
use super::feed::{Attribute, Feed, Manner, Motion, Report, Spot};
use super::live::{Broken, Listener, Reports};
use super::table::{FaultLog, Interner, Rows};
use super::{ReadOptions, ReadOutcome, Reading, Reason, Units};
use crate::geodesy::is_on_earth;
use crate::model::fault::Fault;
use crate::model::time::TimeBase;
use std::collections::HashSet;

const KNOT_MPS: f64 = 1852.0 / 3600.0;
const FOOT_M: f64 = 0.3048;
/// Rows and objects of a table that is read as it comes that are remembered at most.
const MOST_SEEN: usize = 1_000_000;
/// Share of the rows that may be wrong.
const MAX_REJECTED: f64 = 0.01;

const SHIPS: Manner = Manner {
    max_rejected: MAX_REJECTED,
    ..Manner::SHIPS
};
const AIRCRAFT: Manner = Manner {
    max_rejected: MAX_REJECTED,
    ..Manner::AIRCRAFT
};

/// A table that is known. Names are of lower-case letters and digits alone.
pub(super) struct Layout {
    pub name: &'static str,
    /// Columns that it has, and no other.
    told_by: &'static [&'static str],
    time: &'static str,
    time_format: Option<&'static str>,
    /// What the objects are named by; `None`: there is one.
    identity: Option<&'static str>,
    lat: &'static str,
    lon: &'static str,
    /// Heights, and what makes metres of them; the first that is there.
    heights: &'static [(&'static str, f64)],
    speed: Option<(&'static str, f64)>,
    course: Option<&'static str>,
    attributes: &'static [(&'static str, Attribute)],
    manner: Manner,
    sensor: &'static str,
    /// Whether rows repeat the last position of an object until a new one comes.
    repeats: bool,
}

const GPS_LOG: Layout = Layout {
    name: "gps",
    told_by: &["time", "latitude", "longitude"],
    time: "time",
    time_format: None,
    identity: None,
    lat: "latitude",
    lon: "longitude",
    heights: &[
        ("altitudem", 1.0),
        ("altitude", 1.0),
        ("ele", 1.0),
        ("altitudeft", FOOT_M),
    ],
    speed: None,
    course: None,
    attributes: &[],
    manner: AIRCRAFT,
    sensor: "gps",
    repeats: false,
};

const TRAFFIC: Layout = Layout {
    name: "traffic",
    told_by: &["timestamp", "icao24", "latitude", "longitude"],
    time: "timestamp",
    identity: Some("icao24"),
    heights: &[("altitude", FOOT_M), ("geoaltitude", FOOT_M)],
    speed: Some(("groundspeed", KNOT_MPS)),
    course: Some("track"),
    attributes: &[
        ("callsign", Attribute::Callsign),
        ("squawk", Attribute::ModeA),
        ("onground", Attribute::OnGround),
    ],
    sensor: "adsb",
    ..GPS_LOG
};

const OPENSKY: Layout = Layout {
    name: "opensky",
    told_by: &["icao24", "lat", "lon", "lastposupdate"],
    time: "lastposupdate",
    lat: "lat",
    lon: "lon",
    heights: &[("baroaltitude", 1.0), ("geoaltitude", 1.0)],
    speed: Some(("velocity", 1.0)),
    course: Some("heading"),
    repeats: true,
    ..TRAFFIC
};

const SOLENT: Layout = Layout {
    name: "ais",
    told_by: &["time", "mmsi", "latitudedegrees", "longitudedegrees"],
    time: "time",
    identity: Some("mmsi"),
    lat: "latitudedegrees",
    lon: "longitudedegrees",
    heights: &[],
    speed: Some(("sogknots", KNOT_MPS)),
    course: Some("cogdegrees"),
    manner: SHIPS,
    sensor: "ais",
    ..GPS_LOG
};

const MARINE_CADASTRE: Layout = Layout {
    name: "marinecadastre",
    told_by: &["mmsi", "basedatetime", "lat", "lon"],
    time: "basedatetime",
    lat: "lat",
    lon: "lon",
    speed: Some(("sog", KNOT_MPS)),
    course: Some("cog"),
    attributes: &[
        ("vesselname", Attribute::ShipName),
        ("callsign", Attribute::Callsign),
        ("vesseltype", Attribute::ShipType),
    ],
    ..SOLENT
};

const DANISH: Layout = Layout {
    name: "dma",
    told_by: &["timestamp", "mmsi", "latitude", "longitude"],
    time: "timestamp",
    time_format: Some("%d/%m/%Y %H:%M:%S"),
    lat: "latitude",
    lon: "longitude",
    attributes: &[
        ("name", Attribute::ShipName),
        ("callsign", Attribute::Callsign),
        ("shiptype", Attribute::ShipType),
    ],
    ..MARINE_CADASTRE
};

/// The first whose columns are all there.
pub(super) const LAYOUTS: &[Layout] = &[OPENSKY, TRAFFIC, SOLENT, MARINE_CADASTRE, DANISH, GPS_LOG];

/// A column name without what differs between spellings.
fn plain(name: &str) -> String {
    let letters = name.chars().filter(char::is_ascii_alphanumeric);
    letters.collect::<String>().to_ascii_lowercase()
}

/// The layout of a table, if it is one of those.
pub(super) fn find(names: &[String]) -> Option<&'static Layout> {
    let plain: Vec<String> = names.iter().map(|name| plain(name)).collect();
    let has = |name: &str| plain.iter().any(|known| known == name);
    LAYOUTS
        .iter()
        .find(|layout| layout.told_by.iter().all(|name| has(name)))
}

/// Where the columns of a layout are.
struct Columns {
    time: usize,
    identity: Option<usize>,
    lat: usize,
    lon: usize,
    height: Option<(usize, f64)>,
    speed: Option<(usize, f64)>,
    course: Option<usize>,
    attributes: Vec<(Attribute, usize)>,
}

impl Layout {
    fn columns(&self, names: &[String]) -> Columns {
        let plain: Vec<String> = names.iter().map(|name| plain(name)).collect();
        let find = |name: &str| plain.iter().position(|known| known == name);
        let mut columns = Columns {
            time: find(self.time).unwrap_or_default(),
            identity: self.identity.and_then(find),
            lat: find(self.lat).unwrap_or_default(),
            lon: find(self.lon).unwrap_or_default(),
            height: None,
            speed: self
                .speed
                .and_then(|(name, scale)| Some((find(name)?, scale))),
            course: self.course.and_then(find),
            attributes: Vec::new(),
        };
        for (name, scale) in self.heights {
            columns.height = columns.height.or(find(name).map(|column| (column, *scale)));
        }
        for (name, attribute) in self.attributes {
            columns
                .attributes
                .extend(find(name).map(|column| (*attribute, column)));
        }
        columns
    }
}

/// Reads a table of a known layout.
///
/// # Errors
/// As of [`Feed::finish`].
pub(super) fn read(
    rows: &mut dyn Rows,
    layout: &Layout,
    options: &ReadOptions,
) -> Result<ReadOutcome, Vec<Fault>> {
    let mut reading = Reading::of(&options.options)?;
    // Added to all times when the feed is finished.
    reading.clock_offset_s = None;
    let columns = layout.columns(rows.names());
    let mut reader = Reader::new(layout, reading, rows.row_word());
    while reader.next_row(rows, &columns) {}
    reader.feed.finish(TimeBase::Utc, &layout.manner, options)
}

/// Reads a table of a known layout as it comes.
///
/// # Errors
/// Latitudes without a plane.
pub(super) fn follow(
    rows: &mut dyn Rows,
    layout: &Layout,
    reading: &Reading,
    (broken, listener): (&Broken, &mut dyn Listener),
) -> Result<Units, Vec<Fault>> {
    let columns = layout.columns(rows.names());
    let mut without_offset = reading.clone();
    without_offset.clock_offset_s = None;
    let mut reader = Reader::new(layout, without_offset, rows.row_word());
    let mut reports = Reports::of(&mut reader.feed, reading)?;
    while reader.next_row(rows, &columns) {
        reader.forget();
        reports.hand_on(&mut reader.feed, listener)?;
    }
    let mut units = reader.feed.units;
    units.add(&broken.borrow());
    Ok(units)
}

struct Reader {
    feed: Feed,
    clock: Clock,
    sensor: u32,
    /// Objects and times so far, where rows repeat them.
    seen: Option<HashSet<(u32, u64)>>,
}

/// A cell, empty where it says that there is nothing.
fn text(rows: &dyn Rows, column: usize) -> &str {
    let text = rows.cell(column).trim();
    match text {
        "nan" | "NaN" | "null" | "None" | "NA" => "",
        text => text,
    }
}

fn number(rows: &dyn Rows, column: usize) -> Result<Option<f64>, Reason> {
    let text = text(rows, column);
    if text.is_empty() {
        return Ok(None);
    }
    let number: f64 = text.parse().map_err(|_| Reason::Malformed)?;
    if number.is_finite() {
        Ok(Some(number))
    } else {
        Err(Reason::NotFinite)
    }
}

/// A number in the unit of this program, where there is such a column.
fn scaled(rows: &dyn Rows, column: Option<(usize, f64)>) -> Result<Option<f64>, Reason> {
    match column {
        Some((column, scale)) => Ok(number(rows, column)?.map(|value| value * scale)),
        None => Ok(None),
    }
}

impl Reader {
    fn new(layout: &Layout, mut reading: Reading, row_word: &str) -> Self {
        if reading.time_format.is_none() {
            reading.time_format = layout.time_format.map(str::to_owned);
        }
        let mut reader = Reader {
            feed: Feed::of(row_word),
            clock: Clock::new(&reading, 1.0),
            sensor: 0,
            seen: layout.repeats.then(HashSet::new),
        };
        reader.sensor = reader.feed.sensors.number(layout.sensor);
        reader.feed.warnings.push(format!(
            "the columns are those of '{}'; `columns` with names of trackloom reads them otherwise",
            layout.name
        ));
        reader
    }

    /// Reads the next row; `false` at the end.
    fn next_row(&mut self, rows: &mut dyn Rows, columns: &Columns) -> bool {
        let mut log = FaultLog::default();
        let is_there = rows.advance(&mut log);
        for fault in log.finish().err().unwrap_or_default() {
            if let Some(line) = fault.line {
                self.feed.reject(Reason::Malformed, line, 1);
            }
        }
        if is_there {
            self.read_row(rows, columns);
        }
        is_there
    }

    /// Of a table that goes on and on not every row is remembered.
    fn forget(&mut self) {
        if self
            .seen
            .as_ref()
            .is_some_and(|seen| seen.len() > MOST_SEEN)
        {
            self.seen = Some(HashSet::new());
        }
        if self.feed.identities.names().len() > MOST_SEEN {
            self.feed.identities = Interner::default();
        }
    }

    fn read_row(&mut self, rows: &dyn Rows, columns: &Columns) {
        match self.report(rows, columns) {
            Ok(Some(report)) => {
                self.feed.push(report);
                for &(attribute, column) in &columns.attributes {
                    let text = text(rows, column);
                    if !text.is_empty() {
                        self.feed.describe(attribute, &spelled(attribute, text));
                    }
                }
            }
            Ok(None) => {}
            Err(reason) => self.feed.reject(reason, rows.row(), 1),
        }
    }

    /// `None` of a row that was ignored.
    fn report(&mut self, rows: &dyn Rows, columns: &Columns) -> Result<Option<Report>, Reason> {
        let identity = match columns.identity.map(|column| text(rows, column)) {
            Some("") => return Err(Reason::NoIdentity),
            Some(name) => name,
            None => "1",
        };
        let (lat_deg, lon_deg) = (number(rows, columns.lat)?, number(rows, columns.lon)?);
        let (Some(lat_deg), Some(lon_deg)) = (lat_deg, lon_deg) else {
            self.feed.ignore("no position", 1);
            return Ok(None);
        };
        // What AIS sends in place of a position that is not known.
        if lat_deg == 91.0 || lon_deg == 181.0 {
            self.feed.ignore("no position", 1);
            return Ok(None);
        }
        if !is_on_earth(lat_deg, lon_deg) {
            return Err(Reason::OutOfRange);
        }
        let time = text(rows, columns.time);
        if time.is_empty() {
            return Err(Reason::NoTime);
        }
        let time_s = self.clock.read_unix(time).map_err(|_| Reason::Malformed)?;
        let identity = self.feed.identities.number(identity);
        let seen = self.seen.as_mut();
        if seen.is_some_and(|seen| !seen.insert((identity, time_s.to_bits()))) {
            self.feed.ignore("stale", 1);
            return Ok(None);
        }
        let height_m = scaled(rows, columns.height)?;
        let speed_mps = scaled(rows, columns.speed)?;
        let course_deg = columns
            .course
            .map_or(Ok(None), |column| number(rows, column))?;
        let spot = Spot::Geographic { lat_deg, lon_deg };
        Ok(Some(Report {
            time_s,
            unit: rows.row(),
            units: 1,
            sensor: self.sensor,
            identity: Some(identity),
            spot,
            height_m,
            motion: motion(speed_mps, course_deg),
            sigma_m: None,
            status: None,
            begins: false,
            ends: false,
        }))
    }
}

/// Speed and course where both are there; 360 degrees and 102.3 knots stand for unknown.
fn motion(speed_mps: Option<f64>, course_deg: Option<f64>) -> Option<Motion> {
    let course_deg = course_deg.filter(|course_deg| (0.0..360.0).contains(course_deg))?;
    let speed_mps = speed_mps.filter(|speed_mps| *speed_mps >= 0.0)?;
    Some(Motion {
        speed_mps,
        course_rad: course_deg.to_radians(),
    })
}

/// A squawk that became a number has lost its leading zeros.
fn spelled(attribute: Attribute, text: &str) -> String {
    match (attribute, text.parse::<f64>()) {
        (Attribute::ModeA, Ok(code)) if (0.0..=7777.0).contains(&code) => format!("{code:04.0}"),
        _ => text.to_owned(),
    }
}
