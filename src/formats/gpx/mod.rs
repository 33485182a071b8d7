//! GPX 1.0 and 1.1: tracks of receivers of satellite navigation. A track is one object, each of its segments a piece of a path.
//!
//! A point is a unit: those of tracks (`trkpt`) become reports, waypoints and points of routes are ignored. Heights are above
//! mean sea level, as the format has it; some receivers write those above the ellipsoid.
//!
//! # Reference
//! GPX 1.1 schema documentation, <https://www.topografix.com/GPX/1/1/>.

mod input;
mod point;

use self::input::{Input, MAX_EVENT_BYTES};
use self::point::{Point, Value};
use super::feed::{Feed, Report};
use crate::model::fault::Fault;
use crate::model::names::name_fault;
use quick_xml::Reader;
use quick_xml::escape::resolve_predefined_entity;
use quick_xml::events::{BytesRef, BytesStart, Event};
use std::collections::HashSet;
use std::io::BufRead;

/// What a file does not say itself.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Told {
    /// How far times without a zone are ahead of UTC; without it their points are rejected.
    pub utc_offset_s: Option<f64>,
}

/// How deep tags may lie in each other; those that are read lie five deep.
const MAX_DEPTH: usize = 100;

/// Bytes of a value that is read; longer ones are cut.
const MAX_VALUE_BYTES: usize = 1000;

/// Reads a file, tag by tag.
///
/// # Errors
/// XML that is not well-formed or is cut off, another root or version, a document type (it may define entities), and tags that
/// are too long or too deep; each with the line that was reached.
pub fn decode(input: &mut dyn BufRead, told: &Told) -> Result<Feed, Vec<Fault>> {
    let mut reader = Reader::from_reader(Input::new(input));
    let mut decoder = Decoder::new(told);
    let mut buffer = Vec::new();
    loop {
        buffer.clear();
        reader.get_mut().begin_event();
        let event = reader
            .read_event_into(&mut buffer)
            .map_err(|error| fault_of(&error));
        let is_end = matches!(event, Ok(Event::Eof));
        let taken = event.and_then(|event| decoder.take(&event));
        taken.map_err(|fault| {
            let line = Some(reader.get_mut().line);
            vec![Fault { line, ..fault }]
        })?;
        if is_end {
            return Ok(decoder.finish());
        }
    }
}

fn fault_of(error: &quick_xml::Error) -> Fault {
    let is_long = matches!(error, quick_xml::Error::Io(error)
        if error.kind() == std::io::ErrorKind::FileTooLarge);
    if is_long {
        let detail = format!("a tag or a text is longer than {MAX_EVENT_BYTES} bytes");
        return Fault::new("/file", "too_large", detail);
    }
    malformed(format!("the file is no XML that can be read: {error}"))
}

fn malformed(detail: impl Into<String>) -> Fault {
    Fault::new("/file", "malformed", detail)
}

/// What a tag is, where it stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Tag {
    Gpx,
    Route,
    Track,
    Segment,
    /// `trkpt`.
    Point,
    /// Of a waypoint or of a route.
    OtherPoint,
    Name,
    Number,
    Value(Value),
    Other,
}

impl Tag {
    fn of(parent: Option<Tag>, name: &[u8]) -> Tag {
        match (parent, name) {
            (None, b"gpx") => Tag::Gpx,
            (Some(Tag::Gpx), b"trk") => Tag::Track,
            (Some(Tag::Gpx), b"rte") => Tag::Route,
            (Some(Tag::Gpx), b"wpt") | (Some(Tag::Route), b"rtept") => Tag::OtherPoint,
            (Some(Tag::Track), b"trkseg") => Tag::Segment,
            (Some(Tag::Track), b"name") => Tag::Name,
            (Some(Tag::Track), b"number") => Tag::Number,
            (Some(Tag::Segment), b"trkpt") => Tag::Point,
            (Some(Tag::Point), name) => Value::named(name).map_or(Tag::Other, Tag::Value),
            _ => Tag::Other,
        }
    }

    fn has_text(self) -> bool {
        matches!(self, Tag::Name | Tag::Number | Tag::Value(_))
    }
}

struct Decoder {
    told: Told,
    feed: Feed,
    /// Tags that are open.
    open: Vec<Tag>,
    has_root: bool,
    text: String,
    track: Track,
    tracks: u64,
    names: HashSet<String>,
    point: Point,
    points: u64,
    heights: u64,
}

/// The track that is read.
#[derive(Default)]
struct Track {
    name: String,
    number: String,
    identity: Option<u32>,
    /// Whether the next report is the first of its segment.
    begins: bool,
}

impl Decoder {
    fn new(told: &Told) -> Self {
        let mut feed = Feed::of("point");
        feed.sensors.number("gps");
        Decoder {
            told: *told,
            feed,
            open: Vec::new(),
            has_root: false,
            text: String::new(),
            track: Track::default(),
            tracks: 0,
            names: HashSet::new(),
            point: Point::default(),
            points: 0,
            heights: 0,
        }
    }

    fn take(&mut self, event: &Event<'_>) -> Result<(), Fault> {
        match event {
            Event::Start(start) => self.start(start),
            Event::Empty(start) => {
                self.start(start)?;
                self.end();
                Ok(())
            }
            Event::End(_) => {
                self.end();
                Ok(())
            }
            Event::Text(text) => self.add_text(&String::from_utf8_lossy(text)),
            Event::CData(text) => self.add_text(&String::from_utf8_lossy(text)),
            Event::GeneralRef(reference) => self.add_reference(reference),
            Event::DocType(_) => {
                let detail = "the file has a document type, which may define entities";
                Err(Fault::new("/file", "unsupported", detail))
            }
            Event::Eof if !self.has_root || !self.open.is_empty() => {
                Err(malformed("the file ends before its last tag"))
            }
            Event::Comment(_) | Event::Decl(_) | Event::PI(_) | Event::Eof => Ok(()),
        }
    }

    fn start(&mut self, start: &BytesStart<'_>) -> Result<(), Fault> {
        let tag = Tag::of(self.open.last().copied(), start.local_name().as_ref());
        if self.open.is_empty() && (tag != Tag::Gpx || self.has_root) {
            return Err(malformed("the file's only root is not gpx").allowing("gpx"));
        }
        if self.open.len() == MAX_DEPTH {
            let detail = format!("tags lie more than {MAX_DEPTH} deep");
            return Err(Fault::new("/file", "too_large", detail));
        }
        match tag {
            Tag::Gpx => {
                self.has_root = true;
                check_version(start)?;
            }
            Tag::Track => {
                self.track = Track::default();
                self.tracks += 1;
            }
            Tag::Segment => self.track.begins = true,
            Tag::Point => self.point = Point::at(start),
            _ => {}
        }
        self.text.clear();
        self.open.push(tag);
        Ok(())
    }

    fn end(&mut self) {
        let text = std::mem::take(&mut self.text);
        match self.open.pop() {
            Some(Tag::Name) => {
                self.track.name = text.split_whitespace().collect::<Vec<_>>().join(" ")
            }
            Some(Tag::Number) => self.track.number = text.trim().to_owned(),
            Some(Tag::Value(value)) => self.point.set(value, text.trim(), self.told.utc_offset_s),
            Some(Tag::Point) => self.end_point(),
            Some(Tag::OtherPoint) => {
                self.points += 1;
                self.feed.ignore("waypoint or route", 1);
            }
            _ => {}
        }
    }

    fn end_point(&mut self) {
        self.points += 1;
        let fix = match self.point.finish() {
            Ok(fix) => fix,
            Err(reason) => return self.feed.reject(reason, self.points, 1),
        };
        let identity = match self.track.identity {
            Some(identity) => identity,
            None => self.name_track(),
        };
        self.heights += u64::from(fix.height_m.is_some());
        self.feed.push(Report {
            time_s: fix.time_s,
            unit: self.points,
            units: 1,
            sensor: 0,
            identity: Some(identity),
            spot: fix.spot,
            height_m: fix.height_m,
            motion: fix.motion,
            sigma_m: None,
            status: None,
            begins: std::mem::take(&mut self.track.begins),
            ends: false,
        });
    }

    /// By its name, else its number, else its place in the file; a name that is there, or cannot be one, gets a number.
    fn name_track(&mut self) -> u32 {
        let said = [&self.track.name, &self.track.number];
        let name = said
            .into_iter()
            .find(|name| !name.is_empty() && name_fault(name).is_none());
        let name = name.map_or_else(|| format!("track {}", self.tracks), String::clone);
        let mut unique = name.clone();
        if self.names.contains(&unique) {
            unique = format!("{name}-{}", self.tracks);
        }
        while self.names.contains(&unique) || name_fault(&unique).is_some() {
            unique = format!("track {}-{}", self.tracks, self.names.len());
        }
        self.names.insert(unique.clone());
        let identity = self.feed.identities.number(&unique);
        self.track.identity = Some(identity);
        identity
    }

    fn add_text(&mut self, text: &str) -> Result<(), Fault> {
        let has_text = self.open.last().is_some_and(|tag| tag.has_text());
        if self.open.is_empty() && !text.trim_matches('\u{feff}').trim().is_empty() {
            return Err(malformed("there is text outside the root"));
        }
        if has_text && self.text.len() + text.len() <= MAX_VALUE_BYTES {
            self.text.push_str(text);
        }
        Ok(())
    }

    /// A character by its number, or one of the five entities of XML.
    fn add_reference(&mut self, reference: &BytesRef<'_>) -> Result<(), Fault> {
        let character = reference
            .resolve_char_ref()
            .map_err(|error| fault_of(&error))?;
        if let Some(character) = character {
            return self.add_text(character.encode_utf8(&mut [0; 4]));
        }
        let name = String::from_utf8_lossy(reference);
        match resolve_predefined_entity(&name) {
            Some(text) => self.add_text(text),
            None => {
                let name: String = name.chars().take(50).collect();
                let detail = format!("the entity '{name}' is not one of XML's own");
                Err(Fault::new("/file", "unsupported", detail))
            }
        }
    }

    fn finish(mut self) -> Feed {
        if self.heights > 0 {
            self.feed.warnings.push(format!(
                "the heights of {} points are above mean sea level, as GPX has it",
                self.heights
            ));
        }
        self.feed
    }
}

fn check_version(root: &BytesStart<'_>) -> Result<(), Fault> {
    let attribute = root.try_get_attribute("version");
    let attribute =
        attribute.map_err(|error| malformed(format!("the root cannot be read: {error}")))?;
    match attribute.as_ref().map(|attribute| attribute.value.as_ref()) {
        Some(b"1.0" | b"1.1") => Ok(()),
        _ => {
            let detail = "the version of the file is not known";
            Err(Fault::new("/file", "unsupported", detail).allowing("1.0, 1.1"))
        }
    }
}
