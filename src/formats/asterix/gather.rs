//! Records become reports of a feed, each of which is used, ignored or rejected.

use super::Told;
use super::framing::{Block, Piece};
use super::items::{Said, Service, Source, Target, kinds_of, said};
use super::repeats::Repeats;
use super::times::{Around, Clock};
use super::uap::Uap;
use super::walk::{Items, walk};
use crate::formats::Reason;
use crate::formats::feed::{Attribute, Feed, Report, Spot};
use crate::formats::table::Interner;
use crate::model::dataset::DatasetKind;
use crate::model::track::TrackStatus;
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write;

/// Reports as they come.
pub struct Gathering {
    pub feed: Feed,
    pub clock: Clock,
    /// How many records could be of each kind.
    pub held: BTreeMap<DatasetKind, u64>,
    kind: DatasetKind,
    with_test_targets: bool,
    repeats: Repeats,
    /// The last report of each identity of a track.
    latest: HashMap<u32, usize>,
    /// Numbers of the names of sources.
    sensors: BTreeMap<Source, u32>,
    units: u64,
    /// Numbers of identities by what they are named after: source and number of a track, or address.
    identities: HashMap<u32, u32>,
    /// Numbers of the texts of values.
    words: HashMap<(Attribute, u64), u32>,
    /// For names, so that each is not allocated.
    text: String,
}

impl Gathering {
    pub fn new(kind: DatasetKind, told: &Told) -> Self {
        Gathering {
            feed: Feed::of("record"),
            clock: Clock::new(told.day_s),
            held: BTreeMap::new(),
            kind,
            with_test_targets: told.with_test_targets,
            repeats: Repeats::default(),
            latest: HashMap::new(),
            sensors: BTreeMap::new(),
            units: 0,
            identities: HashMap::new(),
            words: HashMap::new(),
            text: String::new(),
        }
    }

    /// `uaps` are by category; what is not there is not read.
    pub fn take<'t, 'a>(
        &mut self,
        piece: Piece<'a>,
        uaps: &'t BTreeMap<u8, Uap>,
        items: &mut Items<'t, 'a>,
    ) {
        match piece {
            Piece::Block(block) => match uaps.get(&block.category) {
                Some(uap) => self.block(&block, uap, items),
                None => self.ignore(unread(block.category)),
            },
            Piece::Foreign(kind) => self.ignore(kind),
            Piece::Broken(reason) => self.reject(reason),
        }
    }

    fn ignore(&mut self, kind: &str) {
        self.units += 1;
        self.feed.ignore(kind, 1);
    }

    pub fn reject(&mut self, reason: Reason) {
        self.units += 1;
        self.feed.reject(reason, self.units, 1);
    }

    /// A block is read up to its first record that cannot be: where the next one would begin is not known.
    fn block<'t, 'a>(&mut self, block: &Block<'a>, uap: &'t Uap, items: &mut Items<'t, 'a>) {
        let around = Around {
            captured_s: block.captured_s,
            framed_s: block.framed_s,
        };
        let mut rest = block.records;
        while !rest.is_empty() {
            match walk(uap, rest, items) {
                Ok(length) => {
                    if self.repeats.again(block.category, &rest[..length]) {
                        self.ignore("duplicate");
                    } else {
                        self.record(uap, items, around);
                    }
                    rest = &rest[length..];
                }
                Err(reason) => return self.reject(reason),
            }
        }
    }

    fn record(&mut self, uap: &Uap, items: &Items, around: Around) {
        let outcome = match said(uap, items) {
            Said::Target(target) => {
                self.hold(uap.edition.category, &target);
                self.target(uap.edition.category, &target, around)
            }
            Said::Service(service) => self.service(&service, around),
        };
        match outcome {
            Ok(None) => self.units += 1,
            Ok(Some(ignored)) => self.ignore(ignored),
            Err(reason) => self.reject(reason),
        }
    }

    /// Forgets all identities where they are more.
    pub fn forget_beyond(&mut self, most: usize) {
        if self.identities.len() > most {
            self.identities.clear();
            self.feed.identities = Interner::default();
        }
    }

    fn hold(&mut self, category: u8, target: &Target) {
        for kind in kinds_of(category) {
            let is_one = match kind {
                DatasetKind::Tracks => target.number.is_some(),
                DatasetKind::Truth => target.address.is_some(),
                _ => true,
            };
            if is_one {
                *self.held.entry(*kind).or_default() += 1;
            }
        }
    }

    fn sensor(&mut self, source: Source) -> u32 {
        if let Some(sensor) = self.sensors.get(&source) {
            return *sensor;
        }
        let sensor = self
            .feed
            .sensors
            .number(&format!("{}/{}", source.0, source.1));
        self.sensors.insert(source, sensor);
        sensor
    }

    /// What becomes of a message: none is a report.
    fn service(
        &mut self,
        service: &Service,
        around: Around,
    ) -> Result<Option<&'static str>, Reason> {
        let source = service.source.ok_or(Reason::NoIdentity)?;
        let time_s = match service.of_day_s {
            Some(of_day_s) => Some(self.clock.of_service(source, of_day_s, around)?),
            None => None,
        };
        if let Some(site) = service.site {
            check_place(site.lat_deg, site.lon_deg)?;
            let sensor = self.sensor(source);
            self.feed.sites.insert(sensor, site);
        }
        if let Some(rotation_s) = service.rotation_s.filter(|rotation_s| *rotation_s > 0.0) {
            let sensor = self.sensor(source);
            self.feed.rotation_s.insert(sensor, rotation_s);
        }
        if let (true, Some(time_s)) = (service.is_north, time_s) {
            let sensor = self.sensor(source);
            self.feed.north_s.push((sensor, time_s));
        }
        Ok(Some("service message"))
    }

    /// What becomes of a target: `None` is a report, else what is ignored is named.
    fn target(
        &mut self,
        category: u8,
        target: &Target,
        around: Around,
    ) -> Result<Option<&'static str>, Reason> {
        let source = target.source.ok_or(Reason::NoIdentity)?;
        if !self.with_test_targets && target.special.is_some() {
            return Ok(target.special);
        }
        let kinds = kinds_of(category);
        if !kinds.contains(&self.kind) {
            return Ok(kinds.first().map(|kind| kind.name()));
        }
        let time_s = self.clock.of_target(source, target.time, around)?;
        let identity = match self.identity(source, target)? {
            Some(identity) => Some(identity),
            None if self.kind == DatasetKind::Tracks && kinds[0] == DatasetKind::Detections => {
                return Ok(Some("no track number"));
            }
            None if self.kind == DatasetKind::Detections => None,
            None => return Err(Reason::NoIdentity),
        };
        let Some(spot) = target.spot else {
            self.end(identity, target);
            return Ok(Some("no position"));
        };
        if let Spot::Geographic { lat_deg, lon_deg } = spot {
            check_place(lat_deg, lon_deg)?;
        }
        if target.is_extrapolated && self.kind == DatasetKind::Detections {
            return Ok(Some("no detection"));
        }
        let sensor = self.sensor(source);
        self.push(Report {
            sensor,
            identity,
            ..self.report(target, spot, time_s)
        });
        if !self.feed.is_live {
            self.describe(target);
        }
        Ok(None)
    }

    /// Number of the name of what is seen: of a track its source and number, else the address.
    fn identity(&mut self, source: Source, target: &Target) -> Result<Option<u32>, Reason> {
        let key = match (self.kind, target.number, target.address) {
            (DatasetKind::Tracks, Some(number), _) => {
                u32::from_be_bytes([source.0, source.1, 0, 0]) | u32::from(number)
            }
            (DatasetKind::Tracks, None, _) | (_, _, None) => return Ok(None),
            (_, _, Some(address)) => address,
        };
        if let Some(identity) = self.identities.get(&key) {
            return Ok(Some(*identity));
        }
        self.text.clear();
        let written = match (self.kind, target.number) {
            (DatasetKind::Tracks, Some(number)) => {
                write!(self.text, "{}/{}-{number}", source.0, source.1)
            }
            _ => write!(self.text, "{key:06X}"),
        };
        written.map_err(|_| Reason::Malformed)?;
        let identity = self.feed.identities.number(&self.text);
        self.identities.insert(key, identity);
        Ok(Some(identity))
    }

    /// The last record of a track may say nothing but that it ends.
    fn end(&mut self, identity: Option<u32>, target: &Target) {
        let latest = identity.and_then(|identity| self.latest.get(&identity));
        if let (DatasetKind::Tracks, true, Some(latest)) = (self.kind, target.ends, latest) {
            self.feed.reports[*latest].ends = true;
        }
    }

    fn report(&self, target: &Target, spot: Spot, time_s: f64) -> Report {
        let is_track = self.kind == DatasetKind::Tracks;
        Report {
            time_s,
            unit: self.units + 1,
            units: 1,
            sensor: 0,
            identity: None,
            spot,
            height_m: target.height_m,
            motion: target.motion,
            sigma_m: target
                .sigma_m
                .or(target.track_sigma_m.filter(|_| is_track))
                .filter(|sigma_m| *sigma_m > 0.0),
            status: is_track.then(|| status(target)),
            begins: is_track && target.begins,
            ends: is_track && target.ends,
        }
    }

    fn push(&mut self, report: Report) {
        if let (DatasetKind::Tracks, Some(identity)) = (self.kind, report.identity) {
            self.latest.insert(identity, self.feed.reports.len());
        }
        self.feed.push(report);
    }

    /// What is known of the target, said of its report: a track's number is given to others later.
    fn describe(&mut self, target: &Target) {
        if let Some(address) = target.address {
            let key = (Attribute::Address, u64::from(address));
            self.say(key, format_args!("{address:06X}"));
        }
        if let Some(callsign) = target.callsign {
            let key = (Attribute::Callsign, callsign.code());
            self.say(key, format_args!("{}", callsign.as_str()));
        }
        if let Some(mode_a) = target.mode_a {
            let key = (Attribute::ModeA, u64::from(mode_a));
            self.say(key, format_args!("{mode_a:04o}"));
        }
        if let Some(mode_c_ft) = target.mode_c_ft {
            let key = (Attribute::ModeC, mode_c_ft.to_bits());
            self.say(key, format_args!("{mode_c_ft}"));
        }
        if let Some(number) = target.number {
            let key = (Attribute::TrackNumber, u64::from(number));
            self.say(key, format_args!("{number}"));
        }
        if let Some(on_ground) = target.on_ground {
            let key = (Attribute::OnGround, u64::from(on_ground));
            self.say(key, format_args!("{on_ground}"));
        }
        if let Some(kind) = target.report_kind {
            self.feed.describe(Attribute::ReportKind, kind);
        }
    }

    /// Says it of the report pushed last. What a value is in words is written once.
    fn say(&mut self, key: (Attribute, u64), value: std::fmt::Arguments) {
        let known = self.words.get(&key).copied();
        let text = known.or_else(|| {
            self.text.clear();
            self.text.write_fmt(value).ok()?;
            let text = self.feed.number_of(&self.text);
            self.words.insert(key, text);
            Some(text)
        });
        if let Some(text) = text {
            self.feed.describe_by_number(key.0, text);
        }
    }
}

fn status(target: &Target) -> TrackStatus {
    match (target.is_tentative, target.is_coasted) {
        (true, _) => TrackStatus::Tentative,
        (false, true) => TrackStatus::Coasted,
        (false, false) => TrackStatus::Confirmed,
    }
}

fn check_place(lat_deg: f64, lon_deg: f64) -> Result<(), Reason> {
    if lat_deg.abs() <= 90.0 && lon_deg.abs() <= 180.0 {
        Ok(())
    } else {
        Err(Reason::OutOfRange)
    }
}

/// What is counted of a block whose records are not read.
fn unread(category: u8) -> &'static str {
    match category {
        19 | 23 | 63 => "block of service messages",
        _ => "block of another category",
    }
}
