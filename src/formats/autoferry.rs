//! The JSON files of the autoferry recordings: boats seen by the radar, lidar and cameras of a ferry.
//!
//! Detections are an array of scans `{sensorID, ownshipPosition: [north, east], time, measurement}`. Radar (2) and lidar
//! (1) report positions relative to the ferry: nothing, one flat pair `[north, east]`, or two rows, norths and easts.
//! Infrared (3) and daylight (4) cameras report bearings (rad, from north through east) as the ferry sees them from where it
//! is at that time: a list, or one bare number. Truth is an array with one list of `{targetID, position: [north, east, 0],
//! time}` for each scan, so that a position occurs as often as scans fall between two of them.
//!
//! # Reference
//! Helgesen et al.: Heterogeneous multi-sensor tracking for an autonomous surface vehicle in a
//! littoral environment. Ocean Engineering 252 (2022) 111168.

use super::autoferry_items::{Entry, FerryScan, FileSeed, Items};
use super::autoferry_sensors::SENSORS;
use super::json_text::parse;
use super::table::FaultLog;
use super::{Format, ReadOptions, ReadOutcome, refuse_columns};
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use crate::model::names::natural_order;
use crate::model::pose::Pose;
use crate::model::scan::{Detection, Recording, RecordingParts, Scan};
use crate::model::sensor::SensorSettings;
use crate::model::space::Space;
use crate::model::truth::{Target, TruthPoint, TruthSet};
use std::collections::BTreeMap;
use std::io::BufRead;

pub const FORMAT: Format = Format {
    name: "autoferry",
    summary: "JSON of the autoferry recordings: detections of radar, lidar and cameras (bearings), or truth",
    media_type: "application/json",
    kinds: &[DatasetKind::Detections, DatasetKind::Truth],
    options: &[],
    read,
};

/// Whether a text that begins with `[` is of these files.
pub(super) fn is_one(text: &[u8]) -> bool {
    let has = |word: &str| text.windows(word.len()).any(|part| part == word.as_bytes());
    let inside = text[1..].trim_ascii_start();
    inside.starts_with(b"[")
        || ["\"sensorID\"", "\"ownshipPosition\"", "\"measurement\""]
            .into_iter()
            .any(has)
}

/// Reads one file, item by item; an array of objects holds detections, an array of arrays truth.
///
/// # Errors
/// Every fault: of the JSON text with its line, of a value with its pointer, such as `/file/17/measurement`.
pub fn read(input: &mut dyn BufRead, options: &ReadOptions) -> Result<ReadOutcome, Vec<Fault>> {
    refuse_columns(options)?;
    let mut items = Items::new(options.kind);
    let read = parse(input, FileSeed(&mut items));
    if let Some(fault) = items.refusal {
        return Err(vec![fault]);
    }
    // A full log ends the reading before the text does.
    if !items.faults.is_full() {
        read?;
    }
    match items.found {
        Some(DatasetKind::Truth) => truth(items.entries, items.faults),
        Some(_) => detections(items.scans, items.faults),
        None => Err(vec![Fault::new("/file", "empty", "the array is empty")]),
    }
}

fn detections(mut scans: Vec<FerryScan>, mut faults: FaultLog) -> Result<ReadOutcome, Vec<Fault>> {
    scans.sort_by(|a, b| a.time_s.total_cmp(&b.time_s).then(a.sensor.cmp(&b.sensor)));
    for pair in scans
        .windows(2)
        .filter(|pair| (pair[0].time_s, pair[0].sensor) == (pair[1].time_s, pair[1].sensor))
    {
        let detail = format!(
            "the {} has another scan at {} s: item {}",
            name(&pair[1]),
            pair[1].time_s,
            pair[0].item
        );
        faults.push(Fault::new(
            format!("/file/{}/time", pair[1].item),
            "conflict",
            detail,
        ));
    }
    faults.finish()?;
    Ok(ReadOutcome::all_used(
        Dataset::Detections(recording(&scans)?),
        Vec::new(),
        "measurement",
    ))
}

fn name(scan: &FerryScan) -> &'static str {
    SENSORS[scan.sensor].name
}

fn recording(ferry_scans: &[FerryScan]) -> Result<Recording, Vec<Fault>> {
    let present: Vec<usize> = (0..SENSORS.len())
        .filter(|&sensor| ferry_scans.iter().any(|scan| scan.sensor == sensor))
        .collect();
    let sensors = present
        .iter()
        .map(|&sensor| SensorSettings::named(SENSORS[sensor].name))
        .collect();
    let mut parts = RecordingParts {
        sensors,
        ..Default::default()
    };
    let mut counts = [0; SENSORS.len()];
    for (index, scan) in ferry_scans.iter().enumerate() {
        counts[scan.sensor] += 1;
        for nth in 1..=scan.measurements.len() {
            let id = format!("{}-{}-{nth}", name(scan), counts[scan.sensor]);
            parts.detection_ids.push(id);
        }
        let detection = |&measurement| Detection {
            measurement,
            origin: None,
            amplitude: None,
        };
        let sensor = present.partition_point(|&sensor| sensor < scan.sensor);
        parts.scans.push(Scan {
            number: index as u32 + 1,
            time_s: scan.time_s,
            sensor,
            pose: Some(Pose::at(scan.place_m.push(0.0))),
            own: Vec::new(),
            detections: scan.measurements.iter().map(detection).collect(),
        });
    }
    Recording::new(parts)
}

fn truth(
    entries: BTreeMap<String, Vec<Entry>>,
    mut faults: FaultLog,
) -> Result<ReadOutcome, Vec<Fault>> {
    let mut targets: Vec<Target> = entries
        .into_iter()
        .map(|(truth_id, entries)| target(truth_id, entries, &mut faults))
        .collect();
    faults.finish()?;
    targets.sort_by(|a, b| natural_order(&a.truth_id, &b.truth_id));
    Ok(ReadOutcome::all_used(
        Dataset::Truth(TruthSet::new(Space::Plane, targets)?),
        Vec::new(),
        "measurement",
    ))
}

/// A target's path: in order of time, each time once.
fn target(truth_id: String, mut entries: Vec<Entry>, faults: &mut FaultLog) -> Target {
    entries.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    let mut points: Vec<TruthPoint> = Vec::new();
    for Entry {
        time_s,
        position_m,
        item,
        nth,
    } in entries
    {
        match points.last().filter(|last| last.time_s == time_s) {
            Some(last) if last.position.xy() != position_m => {
                let detail = format!("target {truth_id} is at two positions at {time_s} s");
                faults.push(Fault::new(
                    format!("/file/{item}/{nth}/position"),
                    "conflict",
                    detail,
                ));
            }
            Some(_) => {}
            None => points.push(TruthPoint::in_plane(time_s, position_m, None)),
        }
    }
    Target { truth_id, points }
}
