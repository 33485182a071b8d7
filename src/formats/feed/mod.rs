//! Reports of a feed (AIS, Mode S, ASTERIX, a table of state vectors) on their way to a dataset. A decoder only says what each
//! report says; what becomes of times, paths, scans and places is decided here, once for all of them.

use super::table::Interner;
use super::units::{Reason, Units};
use crate::model::track::TrackStatus;
use std::collections::BTreeMap;

/// Where a report puts its object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Spot {
    /// WGS 84.
    Geographic { lat_deg: f64, lon_deg: f64 },
    /// Slant range, and bearing clockwise from true north, from the site of the report's sensor.
    Polar { range_m: f64, bearing_rad: f64 },
    /// East and north of the origin that the request names.
    Plane { x_m: f64, y_m: f64 },
}

/// Speed over ground, and course clockwise from true north.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    pub speed_mps: f64,
    pub course_rad: f64,
}

/// What one report says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Report {
    pub time_s: f64,
    /// Number of its first unit (from 1), and of how many units it is made.
    pub unit: u64,
    pub units: u32,
    /// Number of a name in [`Feed::sensors`].
    pub sensor: u32,
    /// Number of a name in [`Feed::identities`]; `None`: nobody said whose report it is.
    pub identity: Option<u32>,
    pub spot: Spot,
    pub height_m: Option<f64>,
    pub motion: Option<Motion>,
    /// Standard deviation on each axis (m), where the report says it.
    pub sigma_m: Option<f64>,
    /// Of tracks.
    pub status: Option<TrackStatus>,
    /// Whether the path of this identity begins anew here, or ends here: numbers are given again.
    pub begins: bool,
    pub ends: bool,
}

/// What is known of an object, or of one report of it, beside its motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Attribute {
    /// 24 bits, six hexadecimal digits.
    Address,
    Callsign,
    /// Four octal digits.
    ModeA,
    /// Feet.
    ModeC,
    Mmsi,
    ShipName,
    ShipType,
    TrackNumber,
    /// `true` or `false`.
    OnGround,
    /// `psr`, `ssr`, `combined`, `mode_s`, `adsb`, `mlat`, `ais`.
    ReportKind,
}

impl Attribute {
    /// Its column.
    pub fn name(self) -> &'static str {
        match self {
            Attribute::Address => "address",
            Attribute::Callsign => "callsign",
            Attribute::ModeA => "mode_a",
            Attribute::ModeC => "mode_c_ft",
            Attribute::Mmsi => "mmsi",
            Attribute::ShipName => "ship_name",
            Attribute::ShipType => "ship_type",
            Attribute::TrackNumber => "track_number",
            Attribute::OnGround => "on_ground",
            Attribute::ReportKind => "report_kind",
        }
    }
}

/// Where a sensor stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    pub lat_deg: f64,
    pub lon_deg: f64,
    pub height_m: f64,
}

/// All reports of a file, and how its units fared so far. A unit that became a report is counted when the feed is finished.
#[derive(Default)]
pub struct Feed {
    pub reports: Vec<Report>,
    pub identities: Interner,
    pub sensors: Interner,
    /// Of the sensors that the file itself places, by their numbers.
    pub sites: BTreeMap<u32, Site>,
    /// Times at which the antenna of a sensor passes north, as the file says them: (sensor, s), unsorted.
    pub north_s: Vec<(u32, f64)>,
    /// Time of one turn of a sensor's antenna, where the file says it.
    pub rotation_s: BTreeMap<u32, f64>,
    pub units: Units,
    pub warnings: Vec<String>,
    /// What is said of single reports: index of the report, and a number of `texts`.
    said: Vec<(u32, Attribute, u32)>,
    /// What is said of identities; the last word counts.
    known: BTreeMap<(u32, Attribute), u32>,
    texts: Interner,
}

impl Feed {
    /// `unit` is what a unit is called: `line`, `sentence`, `record`, `frame`, `row`.
    pub fn of(unit: &str) -> Self {
        Feed {
            units: Units::called(unit),
            ..Feed::default()
        }
    }

    pub fn push(&mut self, report: Report) {
        self.reports.push(report);
    }

    /// Says something of the report pushed last.
    pub fn describe(&mut self, attribute: Attribute, text: &str) {
        if let Some(report) = self.reports.len().checked_sub(1) {
            let text = self.texts.number(text);
            self.said.push((report as u32, attribute, text));
        }
    }

    /// Says something of an identity, whenever it is known.
    pub fn describe_identity(&mut self, identity: u32, attribute: Attribute, text: &str) {
        let text = self.texts.number(text);
        self.known.insert((identity, attribute), text);
    }

    /// What is said of a single report, by its index.
    pub fn said_of(&self, report: usize) -> impl Iterator<Item = (Attribute, &str)> {
        let first = self.said.partition_point(|said| (said.0 as usize) < report);
        let of_it = self.said[first..]
            .iter()
            .take_while(move |said| said.0 as usize == report);
        of_it.map(|&(_, attribute, text)| (attribute, self.texts.name(text)))
    }

    /// Counts units that are sound, but nothing that was asked for.
    pub fn ignore(&mut self, kind: &str, units: u64) {
        self.units.ignore(kind, units);
    }

    /// Counts units that are wrong, the first of them by its number.
    pub fn reject(&mut self, reason: Reason, unit: u64, units: u64) {
        self.units.reject(reason, unit, units);
    }
}
