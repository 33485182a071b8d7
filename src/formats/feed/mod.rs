//! Reports of a feed (AIS, Mode S, ASTERIX, a table of state vectors) on their way to a dataset. A decoder only says what each
//! report says; what becomes of times, paths, scans and places is decided here, once for all of them.

pub mod civil;
mod codes;
mod detections;
mod paths;
mod place;
mod scans;
#[cfg(test)]
mod tests;
mod tracks;
mod truth;

pub(super) use detections::{FRAME_S, measure};
pub(super) use place::{Ground, Middle};

use self::place::UNKNOWN_SITE;
use super::reading::{Identity, Reading};
use super::table::Interner;
use super::{ReadOptions, ReadOutcome, Reason, Units};
use crate::model::attributes::Attributes;
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;
use crate::model::time::TimeBase;
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
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

/// What is usual of a kind of feed, where the request says nothing else.
#[derive(Debug, Clone, Copy)]
pub struct Manner {
    pub kind: DatasetKind,
    /// Share of units that may be wrong.
    pub max_rejected: f64,
    pub max_speed_mps: f64,
    /// Silence after which a path begins anew.
    pub path_gap_s: f64,
    /// Standard deviation of positions whose report does not say it (m).
    pub sigma_m: f64,
    /// Of velocities: of speeds, and of courses where they are told apart.
    pub sigma_speed_mps: f64,
    pub sigma_course_deg: Option<f64>,
    /// Whether another callsign is another path.
    pub splits_by_callsign: bool,
    /// What helps where units have no times.
    pub without_times: Option<&'static str>,
}

impl Manner {
    /// Of what ships send.
    pub const SHIPS: Manner = Manner {
        kind: DatasetKind::Truth,
        max_rejected: 0.25,
        max_speed_mps: 60.0,
        path_gap_s: 600.0,
        sigma_m: 15.0,
        sigma_speed_mps: 0.5,
        sigma_course_deg: Some(5.0),
        splits_by_callsign: false,
        without_times: Some("`start` says when a feed without times begins"),
    };
    /// Of what aircraft send.
    pub const AIRCRAFT: Manner = Manner {
        kind: DatasetKind::Truth,
        max_rejected: 0.25,
        max_speed_mps: 1000.0,
        path_gap_s: 600.0,
        sigma_m: 50.0,
        sigma_speed_mps: 1.5,
        sigma_course_deg: None,
        splits_by_callsign: true,
        without_times: None,
    };
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
    /// Whether reports are handed on as they come: nothing is kept that is said beside them.
    pub is_live: bool,
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
        if self.is_live {
            return;
        }
        let text = self.texts.number(text);
        self.describe_by_number(attribute, text);
    }

    /// The number of a text, for [`Feed::describe_by_number`].
    pub fn number_of(&mut self, text: &str) -> u32 {
        self.texts.number(text)
    }

    /// [`Feed::describe`] with a text that has a number already.
    pub fn describe_by_number(&mut self, attribute: Attribute, text: u32) {
        if let Some(report) = self.reports.len().checked_sub(1) {
            self.said.push((report as u32, attribute, text));
        }
    }

    /// Says something of an identity, whenever it is known.
    pub fn describe_identity(&mut self, identity: u32, attribute: Attribute, text: &str) {
        if self.is_live {
            return;
        }
        let text = self.texts.number(text);
        self.known.insert((identity, attribute), text);
    }

    /// The dataset of all reports, of the kind that the request asks for.
    ///
    /// # Errors
    /// Nothing can be used; more units are wrong than may be; a place is missing that the kind needs.
    pub fn finish(
        mut self,
        base: TimeBase,
        manner: &Manner,
        options: &ReadOptions,
    ) -> Result<ReadOutcome, Vec<Fault>> {
        let reading = Reading::of(&options.options)?;
        for report in &mut self.reports {
            report.time_s += reading.clock_offset_s.unwrap_or_default();
        }
        let kind = options.kind.unwrap_or(manner.kind);
        // Who forgets whose reports they are cannot tell that one is elsewhere.
        let is_wild = match kind {
            DatasetKind::Detections => paths::wild(&mut self, manner, &reading),
            _ => Vec::new(),
        };
        if reading.identity == Some(Identity::Drop) {
            self.reports
                .iter_mut()
                .for_each(|report| report.identity = None);
        }
        let mut dataset = match kind {
            DatasetKind::Detections => detections::build(&mut self, &is_wild, manner, &reading)?,
            DatasetKind::Truth => truth::build(&mut self, manner, &reading)?,
            DatasetKind::Tracks => tracks::build(&mut self, manner, &reading)?,
            DatasetKind::BearingTime => return Err(vec![no_record()]),
        };
        dataset.set_time_base(base);
        self.check_units(reading.max_rejected, manner)?;
        let mut warnings = self.warnings;
        warnings.extend(self.units.rejections());
        Ok(ReadOutcome {
            dataset,
            warnings,
            units: self.units,
        })
    }

    fn check_units(&self, max_rejected: Option<f64>, manner: &Manner) -> Result<(), Vec<Fault>> {
        let max_rejected = max_rejected.unwrap_or(manner.max_rejected);
        let units = &self.units;
        let rejected = units.rejected_count();
        if units.used == 0 {
            let detail = format!(
                "none of the {} {}s can be used: {}",
                units.total,
                units.called,
                units.fates()
            );
            let mut fault = Fault::new("/file", "empty", detail);
            fault.allowed = self.cure(manner).map(Into::into);
            return Err(vec![fault]);
        }
        if rejected as f64 <= max_rejected * units.total as f64 {
            return Ok(());
        }
        let share = 100.0 * rejected as f64 / units.total as f64;
        let more = format!("max_rejected {max_rejected}; `max_rejected` allows more");
        let fault = |told: String| {
            let is_timeless = told.starts_with(Reason::NoTime.name());
            let allowed = manner.without_times.filter(|_| is_timeless);
            let detail = format!("{told}; {share:.3} % of the {}s are wrong", units.called);
            Fault::new("/file", "rejected", detail).allowing(allowed.unwrap_or(&more))
        };
        Err(units.rejections().into_iter().map(fault).collect())
    }

    /// What would make units usable of which none is.
    fn cure(&self, manner: &Manner) -> Option<&'static str> {
        if self.units.ignored.contains_key(UNKNOWN_SITE) {
            return Some("`sites` says where the radars stand");
        }
        let is_timeless = self.units.rejected.contains_key(Reason::NoTime.name());
        manner.without_times.filter(|_| is_timeless)
    }

    /// What is said of a single report, by its index.
    pub fn said_of(&self, report: usize) -> impl Iterator<Item = (Attribute, &str)> {
        let numbered = self.numbers_said_of(report);
        numbered.map(|(attribute, text)| (attribute, self.texts.name(text)))
    }

    /// The same by the numbers of the texts.
    fn numbers_said_of(&self, report: usize) -> impl Iterator<Item = (Attribute, u32)> {
        let first = self.said.partition_point(|said| (said.0 as usize) < report);
        let of_it = self.said[first..]
            .iter()
            .take_while(move |said| said.0 as usize == report);
        of_it.map(|&(_, attribute, text)| (attribute, text))
    }

    /// What is known of an identity whose path has these reports: what was said of it at any time, and last in one of them.
    fn attributes_of(&self, identity: u32, reports: &[usize]) -> BTreeMap<&'static str, String> {
        let mut found = BTreeMap::new();
        let known = self.known.range((identity, Attribute::Address)..);
        for ((_, attribute), text) in known.take_while(|((of, _), _)| *of == identity) {
            found.insert(attribute.name(), self.texts.name(*text).to_owned());
        }
        for &report in reports {
            for (attribute, text) in self.said_of(report) {
                if found
                    .get(attribute.name())
                    .is_none_or(|known| known != text)
                {
                    found.insert(attribute.name(), text.to_owned());
                }
            }
        }
        found
    }

    /// What is said of a report by its index, the last word.
    pub fn said_of_report(&self, report: usize, attribute: Attribute) -> Option<&str> {
        let said = self.said_of(report).filter(|said| said.0 == attribute);
        said.last().map(|said| said.1)
    }

    fn number_said_of(&self, report: usize, attribute: Attribute) -> Option<u32> {
        let said = self.numbers_said_of(report);
        let said = said.filter(|said| said.0 == attribute);
        said.last().map(|said| said.1)
    }

    /// What is said of an identity, the last word.
    pub fn said_of_identity(&self, identity: u32, attribute: Attribute) -> Option<&str> {
        let text = self.known.get(&(identity, attribute))?;
        Some(self.texts.name(*text))
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

fn no_record() -> Fault {
    let detail = "a feed of reports is no bearing-time record";
    Fault::new("/meta/kind", "unsupported", detail).allowing("detections, truth, tracks")
}

/// The names of paths: the identity, and its number where there are several.
fn path_name(identity: &str, path: usize) -> String {
    if path == 0 {
        identity.to_owned()
    } else {
        format!("{identity}-{}", path + 1)
    }
}

/// Keeps what is known of an object, if anything is.
fn note(attributes: &mut Attributes, name: &str, known: BTreeMap<&'static str, String>) {
    if !known.is_empty() {
        attributes.insert(name.to_owned(), known);
    }
}
