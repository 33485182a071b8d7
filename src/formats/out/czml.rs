//! CZML 1.0 for CesiumJS: a clock over all of it, and a packet for each target or track with its moving place, the path behind
//! it, and its label. It is shown while there is a point: silence is a gap in its availability.
//!
//! CZML counts heights from the ellipsoid; they are written as they are. What has no heights at all has the height 0, its point
//! and label are drawn on the ground.
//!
//! # Reference
//! Analytical Graphics, CZML Guide, https://github.com/AnalyticalGraphicsInc/czml-writer/wiki/CZML-Guide.

use super::earth::{Earth, Spot};
use super::paths::{self, Path, id_name};
use super::text::{DEGREES, METRES, SECONDS, instant, push_fixed, push_json};
use super::{PATHS, WriteError, Writer};
use crate::model::dataset::Dataset;
use std::io::Write;

pub const WRITER: Writer = Writer {
    name: "czml",
    media_type: "application/json",
    extension: "czml",
    summary: "CZML: truth and tracks that move in CesiumJS",
    kinds: PATHS,
    feature: None,
    write,
};

/// How long the whole is shown, and how long a path is drawn behind its end (s).
const SHOWN_S: f64 = 120.0;
const TRAIL_S: f64 = 120.0;

fn write(dataset: &Dataset, out: &mut dyn Write) -> Result<(), WriteError> {
    let earth = Earth::of(dataset, WRITER.name)?;
    let mut text = String::new();
    push_document(&mut text, dataset)?;
    out.write_all(text.as_bytes())?;
    let id = id_name(dataset);
    paths::for_each(dataset, &earth, |path| {
        text.clear();
        push_path(&mut text, id, path)?;
        Ok(out.write_all(text.as_bytes())?)
    })?;
    out.write_all(b"\n]\n")?;
    Ok(())
}

fn push_document(text: &mut String, dataset: &Dataset) -> Result<(), WriteError> {
    text.push_str("[\n{\"id\":\"document\",\"version\":\"1.0\",\"name\":");
    push_json(text, dataset.kind().name());
    if !dataset.time_base().is_utc() {
        text.push_str(",\"description\":");
        push_json(text, super::RELATIVE_TIMES);
    }
    if let Some((start_s, end_s)) = paths::span_s(dataset) {
        let (start, end) = (instant(start_s)?, instant(end_s)?);
        text.push_str(&format!(
            ",\"clock\":{{\"interval\":\"{start}/{end}\",\"currentTime\":\"{start}\",\"multiplier\":"
        ));
        push_fixed(text, ((end_s - start_s) / SHOWN_S).round().max(1.0), 0);
        text.push_str(",\"range\":\"LOOP_STOP\",\"step\":\"SYSTEM_CLOCK_MULTIPLIER\"}");
    }
    text.push('}');
    Ok(())
}

fn push_path(text: &mut String, id: &str, mut path: Path) -> Result<(), WriteError> {
    path.fill_heights();
    text.push_str(",\n{\"id\":");
    push_json(text, &format!("{id}/{}", path.id));
    text.push_str(",\"name\":");
    push_json(text, path.label());
    push_availability(text, &path.pieces)?;
    push_position(text, &path)?;
    let ground = if path.has_heights() {
        ""
    } else {
        ",\"heightReference\":{\"heightReference\":\"CLAMP_TO_GROUND\"}"
    };
    text.push_str(&format!(
        ",\"point\":{{\"pixelSize\":8,\"color\":{{\"rgba\":[255,85,0,255]}}{ground}}},\"label\":{{\"text\":"
    ));
    push_json(text, path.label());
    text.push_str(&format!(
        ",\"font\":\"11pt sans-serif\",\"horizontalOrigin\":\"LEFT\",\"pixelOffset\":{{\"cartesian2\":[10,0]}}{ground}}}"
    ));
    text.push_str(&format!(
        ",\"path\":{{\"leadTime\":0,\"trailTime\":{TRAIL_S},\"width\":2,\
         \"material\":{{\"solidColor\":{{\"color\":{{\"rgba\":[255,85,0,255]}}}}}}}}"
    ));
    push_properties(text, id, &path);
    text.push('}');
    Ok(())
}

/// One interval, or a list of them where there is silence in between.
fn push_availability(text: &mut String, pieces: &[Vec<Spot>]) -> Result<(), WriteError> {
    text.push_str(",\"availability\":");
    let mut intervals = Vec::new();
    for piece in pieces {
        let (first, last) = (&piece[0], &piece[piece.len() - 1]);
        intervals.push(format!(
            "\"{}/{}\"",
            instant(first.time_s)?,
            instant(last.time_s)?
        ));
    }
    match intervals.as_slice() {
        [interval] => text.push_str(interval),
        intervals => text.push_str(&format!("[{}]", intervals.join(","))),
    }
    Ok(())
}

fn push_position(text: &mut String, path: &Path) -> Result<(), WriteError> {
    let epoch_s = path.spots().next().map_or(0.0, |spot| spot.time_s);
    text.push_str(&format!(
        ",\"position\":{{\"epoch\":\"{}\",\"interpolationAlgorithm\":\"LINEAR\",\"interpolationDegree\":1,\
         \"forwardExtrapolationType\":\"NONE\",\"cartographicDegrees\":[",
        instant(epoch_s)?
    ));
    for (index, spot) in path.spots().enumerate() {
        if index > 0 {
            text.push(',');
        }
        push_fixed(text, spot.time_s - epoch_s, SECONDS);
        for (value, decimals) in [
            (spot.lon_deg, DEGREES),
            (spot.lat_deg, DEGREES),
            (spot.height_m.unwrap_or_default(), METRES),
        ] {
            text.push(',');
            push_fixed(text, value, decimals);
        }
    }
    text.push_str("]}");
    Ok(())
}

fn push_properties(text: &mut String, id: &str, path: &Path) {
    text.push_str(",\"properties\":{");
    let status = path.status.map(|status| ("status", status.name()));
    let known = path.attributes.into_iter().flatten();
    let known = known.map(|(name, value)| (*name, value.as_str()));
    for (index, (name, value)) in [(id, path.id)]
        .into_iter()
        .chain(status)
        .chain(known)
        .enumerate()
    {
        if index > 0 {
            text.push(',');
        }
        push_json(text, name);
        text.push(':');
        push_json(text, value);
    }
    text.push('}');
}
