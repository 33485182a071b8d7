//! GPX 1.1: truth and tracks as `trk`, pieces between which there is silence as `trkseg`, which has a lone point twice. A point has `ele` where its height
//! is known; programs take that for the height above mean sea level, and it is written as it is.
//!
//! # Reference
//! Topografix, GPX 1.1 Schema Documentation, https://www.topografix.com/GPX/1/1/.

use super::earth::{Earth, Spot};
use super::paths::{self, Path};
use super::text::{DEGREES, METRES, fixed, instant, push_element, push_xml};
use super::{PATHS, WriteError, Writer};
use crate::model::dataset::Dataset;
use std::io::Write;

pub const WRITER: Writer = Writer {
    name: "gpx",
    media_type: "application/gpx+xml",
    extension: "gpx",
    summary: "GPX 1.1: truth and tracks for programs of GPS logs",
    kinds: PATHS,
    feature: None,
    write,
};

const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <gpx version=\"1.1\" creator=\"trackloom\" xmlns=\"http://www.topografix.com/GPX/1/1\">\n";

fn write(dataset: &Dataset, out: &mut dyn Write) -> Result<(), WriteError> {
    let earth = Earth::of(dataset, WRITER.name)?;
    let mut head = HEAD.to_owned();
    if !dataset.time_base().is_utc() {
        head.push_str("<metadata>");
        push_element(&mut head, "desc", super::RELATIVE_TIMES);
        head.push_str("</metadata>\n");
    }
    out.write_all(head.as_bytes())?;
    let mut text = String::new();
    paths::for_each(dataset, &earth, |path| {
        text.clear();
        push_path(&mut text, &path)?;
        Ok(out.write_all(text.as_bytes())?)
    })?;
    out.write_all(b"</gpx>\n")?;
    Ok(())
}

fn push_path(text: &mut String, path: &Path) -> Result<(), WriteError> {
    text.push_str("<trk>");
    push_element(text, "name", path.id);
    if path.label() != path.id {
        push_element(text, "desc", path.label());
    }
    text.push('\n');
    for piece in &path.pieces {
        text.push_str("<trkseg>\n");
        for spot in paths::line(piece) {
            push_point(text, spot)?;
        }
        text.push_str("</trkseg>\n");
    }
    text.push_str("</trk>\n");
    Ok(())
}

fn push_point(text: &mut String, spot: &Spot) -> Result<(), WriteError> {
    let lon = match fixed(spot.lon_deg, DEGREES) {
        // The schema has 180 degrees on the other side.
        lon if lon == "180" => "-180".to_owned(),
        lon => lon,
    };
    text.push_str("<trkpt lat=\"");
    push_xml(text, &fixed(spot.lat_deg, DEGREES));
    text.push_str(&format!("\" lon=\"{lon}\">"));
    if let Some(height_m) = spot.height_m {
        push_element(text, "ele", &fixed(height_m, METRES));
    }
    push_element(text, "time", &instant(spot.time_s)?);
    text.push_str("</trkpt>\n");
    Ok(())
}
