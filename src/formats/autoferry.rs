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

use super::json::parse;
use super::table::FaultLog;
use super::{Format, ReadOptions, ReadOutcome, refuse_columns};
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use crate::model::names::natural_order;
use crate::model::scan::{Detection, Measurement, Recording, RecordingParts, Scan};
use crate::model::sensor::SensorSettings;
use crate::model::state::Position;
use crate::model::truth::{Target, TruthPoint, TruthSet};
use serde_json::Value;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::io::BufRead;

pub const FORMAT: Format = Format {
    name: "autoferry",
    summary: "JSON of the autoferry recordings: detections of radar, lidar and cameras (bearings), or truth",
    media_type: "application/json",
    kinds: &[DatasetKind::Detections, DatasetKind::Truth],
    read,
};

/// What is read of one scan's measurement; `None` where it has another shape.
type ReadMeasurement = fn(&Value, [f64; 2]) -> Option<Vec<Measurement>>;

struct FerrySensor {
    number: u64,
    name: &'static str,
    read: ReadMeasurement,
    /// The shapes that `read` knows.
    expected: &'static str,
}

const POSITIONS: &str = "expected [], [north, east] or [[norths], [easts]] of equal length";
const BEARINGS: &str = "expected a bearing in radians or a list of bearings";

/// In the order of their names.
const SENSORS: [FerrySensor; 4] = [
    FerrySensor { number: 4, name: "daylight", read: bearings, expected: BEARINGS },
    FerrySensor { number: 3, name: "infrared", read: bearings, expected: BEARINGS },
    FerrySensor { number: 1, name: "lidar", read: positions, expected: POSITIONS },
    FerrySensor { number: 2, name: "radar", read: positions, expected: POSITIONS },
];

/// Reads one file; an array of objects holds detections, an array of arrays truth.
///
/// # Errors
/// Every fault: of the JSON text with its line, of a value with its pointer, such as `/file/17/measurement`.
pub fn read(input: &mut dyn BufRead, options: &ReadOptions) -> Result<ReadOutcome, Vec<Fault>> {
    let document: Value = parse(input)?;
    let Value::Array(items) = document else {
        return Err(vec![Fault::new("/file", "wrong_type", "expected an array: of scans for detections, of lists for truth")]);
    };
    refuse_columns(options)?;
    let found = match items.first() {
        Some(Value::Object(_)) => DatasetKind::Detections,
        Some(Value::Array(_)) => DatasetKind::Truth,
        Some(_) => return Err(vec![Fault::new("/file/0", "wrong_type", "expected a scan or a list of positions")]),
        None => return Err(vec![Fault::new("/file", "empty", "the array is empty")]),
    };
    if let Some(asked) = options.kind.filter(|asked| *asked != found) {
        let detail = format!("the file holds {}, not {}", found.name(), asked.name());
        return Err(vec![Fault::new("/meta/kind", "conflict", detail)]);
    }
    match found {
        DatasetKind::Truth => read_truth(&items),
        _ => read_detections(&items),
    }
}

/// One scan of a sensor.
struct FerryScan {
    /// Index into [`SENSORS`].
    sensor: usize,
    time_s: f64,
    measurements: Vec<Measurement>,
    /// Its place in the file.
    item: usize,
}

fn read_detections(items: &[Value]) -> Result<ReadOutcome, Vec<Fault>> {
    let mut faults = FaultLog::default();
    let mut scans: Vec<FerryScan> = items.iter().enumerate().filter_map(|(item, scan)| read_scan(item, scan, &mut faults)).collect();
    scans.sort_by(|a, b| a.time_s.total_cmp(&b.time_s).then(a.sensor.cmp(&b.sensor)));
    for pair in scans.windows(2).filter(|pair| (pair[0].time_s, pair[0].sensor) == (pair[1].time_s, pair[1].sensor)) {
        let detail = format!("the {} has another scan at {} s: item {}", name(&pair[1]), pair[1].time_s, pair[0].item);
        faults.push(Fault::new(format!("/file/{}/time", pair[1].item), "conflict", detail));
    }
    faults.finish()?;
    Ok(ReadOutcome { dataset: Dataset::Detections(recording(&scans)?), warnings: Vec::new() })
}

fn name(scan: &FerryScan) -> &'static str {
    SENSORS[scan.sensor].name
}

/// One item of the file; `None` for faults.
fn read_scan(item: usize, scan: &Value, faults: &mut FaultLog) -> Option<FerryScan> {
    let pointer = |field: &str| format!("/file/{item}{field}");
    let Some(number) = scan.get("sensorID").and_then(Value::as_u64) else {
        faults.push(Fault::new(pointer("/sensorID"), "wrong_type", "expected a sensor's number").allowing("1, 2, 3, 4"));
        return None;
    };
    let Some(sensor) = SENSORS.iter().position(|known| known.number == number) else {
        let detail = format!("there is no sensor {number}");
        faults.push(Fault::new(pointer("/sensorID"), "unknown_value", detail).allowing("1, 2, 3, 4"));
        return None;
    };
    let time_s = scan.get("time").and_then(Value::as_f64);
    if time_s.is_none() {
        faults.push(Fault::new(pointer("/time"), "wrong_type", "expected a time in seconds"));
    }
    let ownship = scan.get("ownshipPosition").and_then(numbers).filter(|pair| pair.len() == 2);
    if ownship.is_none() {
        faults.push(Fault::new(pointer("/ownshipPosition"), "wrong_type", "expected [north, east]"));
    }
    let FerrySensor { read, expected, .. } = SENSORS[sensor];
    let measurements = read(scan.get("measurement").unwrap_or(&Value::Null), ownship.as_deref().map_or([0.0; 2], |at| [at[0], at[1]]));
    if measurements.is_none() {
        faults.push(Fault::new(pointer("/measurement"), "wrong_type", expected));
    }
    let (time_s, _, measurements) = (time_s?, ownship?, measurements?);
    Some(FerryScan { sensor, time_s, measurements, item })
}

fn numbers(value: &Value) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(Value::as_f64).collect()
}

/// The positions of a measurement made from `[north, east]`. A flat pair is one position, not two numbers of a row.
fn positions(measurement: &Value, from: [f64; 2]) -> Option<Vec<Measurement>> {
    let at = |north: f64, east: f64| Measurement::Position { x_m: east + from[1], y_m: north + from[0] };
    match measurement.as_array()?.as_slice() {
        [] => Some(Vec::new()),
        [north, east] if north.is_number() => Some(vec![at(north.as_f64()?, east.as_f64()?)]),
        [norths, easts] => {
            let (norths, easts) = (numbers(norths)?, numbers(easts)?);
            (norths.len() == easts.len()).then(|| norths.into_iter().zip(easts).map(|(north, east)| at(north, east)).collect())
        }
        _ => None,
    }
}

/// The bearings of a measurement; from where they were taken is not in them.
fn bearings(measurement: &Value, _from: [f64; 2]) -> Option<Vec<Measurement>> {
    let bearings_rad = measurement.as_f64().map(|bearing_rad| vec![bearing_rad]).or_else(|| numbers(measurement))?;
    Some(bearings_rad.into_iter().map(|bearing_rad| Measurement::Bearing { bearing_rad: bearing_rad.rem_euclid(TAU) }).collect())
}

fn recording(ferry_scans: &[FerryScan]) -> Result<Recording, Vec<Fault>> {
    let present: Vec<usize> = (0..SENSORS.len()).filter(|&sensor| ferry_scans.iter().any(|scan| scan.sensor == sensor)).collect();
    let sensors = present.iter().map(|&sensor| SensorSettings::named(SENSORS[sensor].name)).collect();
    let mut parts = RecordingParts { sensors, ..Default::default() };
    let mut counts = [0; SENSORS.len()];
    for (index, scan) in ferry_scans.iter().enumerate() {
        counts[scan.sensor] += 1;
        let first = parts.detections.len();
        for (nth, &measurement) in scan.measurements.iter().enumerate() {
            parts.detection_ids.push(format!("{}-{}-{}", name(scan), counts[scan.sensor], nth + 1));
            parts.detections.push(Detection { measurement, origin: None, amplitude: None });
        }
        let sensor = present.partition_point(|&sensor| sensor < scan.sensor);
        parts.scans.push(Scan { number: index as u32 + 1, time_s: scan.time_s, sensor, first, count: scan.measurements.len() });
    }
    Recording::new(parts)
}

/// A position of a target, and where the file has it.
type TruthEntry = (f64, Position, String);

fn read_truth(items: &[Value]) -> Result<ReadOutcome, Vec<Fault>> {
    let mut faults = FaultLog::default();
    let mut entries: BTreeMap<String, Vec<TruthEntry>> = BTreeMap::new();
    for (item, list) in items.iter().enumerate() {
        let Some(list) = list.as_array() else {
            faults.push(Fault::new(format!("/file/{item}"), "wrong_type", "expected a list of positions"));
            continue;
        };
        for (nth, entry) in list.iter().enumerate() {
            if let Some((target, entry)) = read_truth_entry(format!("/file/{item}/{nth}"), entry, &mut faults) {
                entries.entry(target).or_default().push(entry);
            }
        }
    }
    let mut targets: Vec<Target> = entries.into_iter().map(|(truth_id, entries)| target(truth_id, entries, &mut faults)).collect();
    faults.finish()?;
    targets.sort_by(|a, b| natural_order(&a.truth_id, &b.truth_id));
    Ok(ReadOutcome { dataset: Dataset::Truth(TruthSet::new(targets)?), warnings: Vec::new() })
}

fn read_truth_entry(pointer: String, entry: &Value, faults: &mut FaultLog) -> Option<(String, TruthEntry)> {
    let target = entry.get("targetID").and_then(Value::as_u64);
    let time_s = entry.get("time").and_then(Value::as_f64);
    let position = entry.get("position").and_then(numbers).filter(|position| (2..=3).contains(&position.len()));
    let mut expect = |present: bool, field: &str, what: &str| {
        if !present {
            faults.push(Fault::new(format!("{pointer}/{field}"), "wrong_type", format!("expected {what}")));
        }
    };
    expect(target.is_some(), "targetID", "a target's number");
    expect(time_s.is_some(), "time", "a time in seconds");
    expect(position.is_some(), "position", "[north, east, 0]");
    let position = position?;
    Some((target?.to_string(), (time_s?, Position::new(position[1], position[0]), pointer)))
}

/// A target's path: in order of time, each time once.
fn target(truth_id: String, mut entries: Vec<TruthEntry>, faults: &mut FaultLog) -> Target {
    entries.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut points: Vec<TruthPoint> = Vec::new();
    for (time_s, position_m, pointer) in entries {
        match points.last().filter(|last| last.time_s == time_s) {
            Some(last) if last.position_m() != Some(position_m) => {
                let detail = format!("target {truth_id} is at two positions at {time_s} s");
                faults.push(Fault::new(format!("{pointer}/position"), "conflict", detail));
            }
            Some(_) => {}
            None => points.push(TruthPoint::in_plane(time_s, position_m, None)),
        }
    }
    Target { truth_id, points }
}
