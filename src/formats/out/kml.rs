//! KML 2.2 with Google's tracks: `gx:Track`, an instant and a place for each point, in the programs that show a time slider.
//!
//! Pieces of a path, between which there is silence, are the tracks of a `gx:MultiTrack`; one of a single point has it twice. Heights count from the sea level there
//! (`absolute`), and are written as they are; where a path has none at all, it lies on the ground. Detections are points with
//! an instant each; bearings alone have no place, and are left out.
//!
//! # Reference
//! OGC 07-147r2, KML 2.2; Google's extension schema kml22gx.xsd.

use super::earth::{Earth, Spot};
use super::paths::{self, Path, id_name};
use super::seen::{self, Seen};
use super::text::{DEGREES, METRES, instant, push_element, push_fixed};
use super::{TABLES, WriteError, Writer};
use crate::model::dataset::Dataset;
use std::io::Write;

pub const WRITER: Writer = Writer {
    name: "kml",
    media_type: "application/vnd.google-earth.kml+xml",
    extension: "kml",
    summary: "KML for Google Earth: truth and tracks with their times, detections as points",
    kinds: TABLES,
    feature: None,
    write,
};

const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <kml xmlns=\"http://www.opengis.net/kml/2.2\" xmlns:gx=\"http://www.google.com/kml/ext/2.2\">\n<Document>\n";
/// Colours are opacity, blue, green, red.
const STYLES: &str = "<Style id=\"path\"><IconStyle><color>ff0055ff</color><scale>0.7</scale></IconStyle>\
    <LineStyle><color>ff0055ff</color><width>2</width></LineStyle></Style>\n\
    <Style id=\"detection\"><IconStyle><color>ffff8800</color><scale>0.3</scale></IconStyle>\
    <LabelStyle><scale>0</scale></LabelStyle></Style>\n";

fn write(dataset: &Dataset, out: &mut dyn Write) -> Result<(), WriteError> {
    let earth = Earth::of(dataset, WRITER.name)?;
    let mut head = HEAD.to_owned();
    push_element(&mut head, "name", dataset.kind().name());
    if !dataset.time_base().is_utc() {
        push_element(&mut head, "description", super::RELATIVE_TIMES);
    }
    head.push('\n');
    head.push_str(STYLES);
    out.write_all(head.as_bytes())?;
    let (id, mut text) = (id_name(dataset), String::new());
    if matches!(dataset, Dataset::Detections(_)) {
        seen::for_each(dataset, &earth, |seen| {
            text.clear();
            push_detection(&mut text, &seen)?;
            Ok(out.write_all(text.as_bytes())?)
        })?;
    } else {
        paths::for_each(dataset, &earth, |path| {
            text.clear();
            push_path(&mut text, id, path)?;
            Ok(out.write_all(text.as_bytes())?)
        })?;
    }
    out.write_all(b"</Document>\n</kml>\n")?;
    Ok(())
}

fn push_path(text: &mut String, id: &str, mut path: Path) -> Result<(), WriteError> {
    path.fill_heights();
    text.push_str("<Placemark>");
    push_element(text, "name", path.label());
    text.push_str("<styleUrl>#path</styleUrl><ExtendedData>");
    push_data(text, id, path.id);
    if let Some(status) = path.status {
        push_data(text, "status", status.name());
    }
    for (name, value) in path.attributes.into_iter().flatten() {
        push_data(text, name, value);
    }
    text.push_str("</ExtendedData>\n<gx:MultiTrack>");
    let mode = altitude_mode(path.has_heights());
    text.push_str(mode);
    text.push_str("<gx:interpolate>0</gx:interpolate>\n");
    for piece in &path.pieces {
        text.push_str("<gx:Track>");
        text.push_str(mode);
        for spot in paths::line(piece) {
            push_element(text, "when", &instant(spot.time_s)?);
        }
        text.push('\n');
        for spot in paths::line(piece) {
            text.push_str("<gx:coord>");
            push_place(text, spot, ' ');
            text.push_str("</gx:coord>");
        }
        text.push_str("</gx:Track>\n");
    }
    text.push_str("</gx:MultiTrack></Placemark>\n");
    Ok(())
}

fn push_detection(text: &mut String, seen: &Seen) -> Result<(), WriteError> {
    let Some(spot) = &seen.spot else {
        return Ok(());
    };
    text.push_str("<Placemark>");
    push_element(text, "name", seen.id);
    text.push_str("<TimeStamp>");
    push_element(text, "when", &instant(seen.time_s)?);
    text.push_str("</TimeStamp><styleUrl>#detection</styleUrl><ExtendedData>");
    push_data(text, "sensor_id", seen.sensor_id);
    push_data(text, "scan", &seen.scan.to_string());
    for (name, value) in seen
        .truth_id
        .map(|id| ("truth_id", id))
        .iter()
        .chain(&seen.attributes)
    {
        push_data(text, name, value);
    }
    text.push_str("</ExtendedData><Point>");
    text.push_str(altitude_mode(spot.height_m.is_some()));
    text.push_str("<coordinates>");
    push_place(text, spot, ',');
    text.push_str("</coordinates></Point></Placemark>\n");
    Ok(())
}

fn altitude_mode(has_heights: bool) -> &'static str {
    if has_heights {
        "<altitudeMode>absolute</altitudeMode>"
    } else {
        "<altitudeMode>clampToGround</altitudeMode>"
    }
}

fn push_data(text: &mut String, name: &str, value: &str) {
    text.push_str(&format!("<Data name=\"{name}\">"));
    push_element(text, "value", value);
    text.push_str("</Data>");
}

fn push_place(text: &mut String, spot: &Spot, between: char) {
    push_fixed(text, spot.lon_deg, DEGREES);
    text.push(between);
    push_fixed(text, spot.lat_deg, DEGREES);
    text.push(between);
    push_fixed(text, spot.height_m.unwrap_or_default(), METRES);
}
