//! Rows brought into scans.

use super::columns::Columns;
use super::turns::{passes_of_north, rate_radps};
use super::{Builder, Found};
use crate::formats::Reading;
use crate::formats::disorder::Disorder;
use crate::formats::table::interner::Interner;
use crate::formats::table::row::RowReader;
use crate::geodesy::Stereographic;
use crate::model::beside::Beside;
use crate::model::fault::Fault;
use crate::model::names::natural_order;
use crate::model::own::{Own, whole};
use crate::model::pose::Pose;
use crate::model::scan::{Measurement, Recording, RecordingParts, Scan, mean_time_s};
use crate::model::sensor::SensorSettings;
use crate::model::space::Frame;
use std::ops::Range;

/// Rows of one scan: a range of the order of rows.
struct Group {
    sensor: u32,
    number: u32,
    time_s: f64,
    rows: Range<usize>,
}

type Grouped = Result<(Recording, Vec<String>), Vec<Fault>>;

/// A recording of all rows, and what there is to say of their scans. Faults of rows are told to the reader.
pub(super) fn group(
    mut builder: Builder,
    declared: Vec<SensorSettings>,
    reader: &mut RowReader,
    (columns, frame, reading): (&Columns, Option<Frame>, &Reading),
) -> Grouped {
    let mut told = Vec::new();
    let mut order = sort_rows(&builder.found, columns.scan.is_some(), &mut told, reader);
    let mut groups = if columns.scan.is_some() {
        numbered(&builder.found, &order)
    } else {
        timed(&builder, &mut order, reading, &mut told)
    };
    check_numbers(&builder, &groups, &order, reader, columns);
    check_poses(&builder, &groups, &order, reader, columns);
    groups.sort_by(|a, b| {
        let name = |group: &Group| builder.sensors.name(group.sensor);
        a.time_s
            .total_cmp(&b.time_s)
            .then_with(|| natural_order(name(a), name(b)))
    });
    check_ids(&builder, &groups, &order, reader, columns);
    for settings in &declared {
        builder.sensors.number(&settings.sensor_id);
    }
    let recording = assemble(builder, &groups, &order, (declared, columns, frame));
    Ok((recording?, told))
}

/// Rows by sensor, number of the scan and time, in the order of the file where these are equal.
fn sort_rows(
    found: &[Found],
    is_numbered: bool,
    told: &mut Vec<String>,
    reader: &RowReader,
) -> Vec<usize> {
    let (mut disorder, mut latest_s) = (Disorder::default(), f64::NEG_INFINITY);
    for one in found {
        disorder.note(&mut latest_s, one.time_s, one.row);
    }
    // Within a numbered scan the times of a sensor that turns may come in any order.
    if !(is_numbered && has_own_times(found)) {
        told.extend(disorder.warning(reader.row_word()));
    }
    let mut order: Vec<usize> = (0..found.len()).collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (&found[a], &found[b]);
        (a.sensor, a.scan)
            .cmp(&(b.sensor, b.scan))
            .then(a.time_s.total_cmp(&b.time_s))
    });
    order
}

/// Whether rows of one scan have different times.
fn has_own_times(found: &[Found]) -> bool {
    found.windows(2).any(|pair| {
        (pair[0].sensor, pair[0].scan) == (pair[1].sensor, pair[1].scan)
            && pair[0].time_s != pair[1].time_s
    })
}

/// Scans as the file numbers them.
fn numbered(found: &[Found], order: &[usize]) -> Vec<Group> {
    let mut groups = Vec::new();
    let mut first = 0;
    let key = |index: &usize| (found[*index].sensor, found[*index].scan);
    for rows in order.chunk_by(|a, b| key(a) == key(b)) {
        let (sensor, number) = key(&rows[0]);
        groups.push(Group {
            sensor,
            number: number.unwrap_or_default(),
            time_s: time_of(found, rows),
            rows: first..first + rows.len(),
        });
        first += rows.len();
    }
    groups
}

/// The mean time of detections; of a row that declares an empty scan, its own.
fn time_of(found: &[Found], rows: &[usize]) -> f64 {
    let times_s: Vec<f64> = rows.iter().map(|&index| found[index].time_s).collect();
    mean_time_s(&times_s)
}

/// Scans of a file that does not number them: a sensor's rows of one time; of a sensor whose times and bearings show that it turns, its
/// turns; of reports that come one by one, frames of the period that was asked for.
fn timed(
    builder: &Builder,
    order: &mut [usize],
    reading: &Reading,
    told: &mut Vec<String>,
) -> Vec<Group> {
    let found = &builder.found;
    let mut groups: Vec<Group> = Vec::new();
    let mut first = 0;
    let mut single = 0;
    for of_sensor in order.chunk_by(|&a, &b| found[a].sensor == found[b].sensor) {
        let starts = starts_of_scans(found, of_sensor, reading.frame_s);
        for (number, pair) in starts.windows(2).enumerate() {
            let rows = &of_sensor[pair[0]..pair[1]];
            single += usize::from(rows.len() == 1);
            groups.push(Group {
                sensor: found[rows[0]].sensor,
                number: number as u32 + 1,
                time_s: time_of(found, rows),
                rows: first + pair[0]..first + pair[1],
            });
        }
        first += of_sensor.len();
    }
    if reading.frame_s.is_none() && groups.len() > 10 && single * 10 > groups.len() * 9 {
        told.push(format!(
            "{single} of {} scans have one detection: the file has no scan numbers, and its times all differ; `frame_s` gathers them",
            groups.len()
        ));
    }
    groups
}

/// Where each scan of a sensor's rows begins, and the end.
fn starts_of_scans(found: &[Found], rows: &[usize], frame_s: Option<f64>) -> Vec<usize> {
    let seen: Vec<(f64, f64)> = rows
        .iter()
        .map(|&row| (found[row].time_s, bearing_of(&found[row])))
        .collect();
    let rate_radps = frame_s.is_none().then(|| rate_radps(&seen)).flatten();
    let mut starts = vec![0];
    for (index, pair) in seen.windows(2).enumerate() {
        let (before_s, after_s) = (pair[0].0, pair[1].0);
        let is_new = match (frame_s, rate_radps) {
            (Some(frame_s), _) => (before_s / frame_s).floor() != (after_s / frame_s).floor(),
            (None, Some(rate_radps)) => passes_of_north(pair[0], pair[1], rate_radps) > 0.0,
            (None, None) => before_s != after_s,
        };
        if is_new {
            starts.push(index + 1);
        }
    }
    starts.push(rows.len());
    starts
}

/// The bearing of what was seen (rad); not a number of a position, and of a row that saw nothing.
fn bearing_of(found: &Found) -> f64 {
    match found
        .detection
        .map(|detection| detection.measurement.flat())
    {
        Some(
            Measurement::RangeBearing { bearing_rad, .. } | Measurement::Bearing { bearing_rad },
        ) => bearing_rad.rem_euclid(std::f64::consts::TAU),
        _ => f64::NAN,
    }
}

/// The scans of a sensor come one after the other: their numbers rise with their times. Groups are in the order of numbers.
fn check_numbers(
    builder: &Builder,
    groups: &[Group],
    order: &[usize],
    reader: &mut RowReader,
    columns: &Columns,
) {
    let Some(column) = columns.scan else { return };
    for pair in groups
        .windows(2)
        .filter(|pair| pair[0].sensor == pair[1].sensor)
    {
        let last = &builder.found[order[pair[0].rows.end - 1]];
        let next = &builder.found[order[pair[1].rows.start]];
        let (sensor, before) = (builder.sensors.name(next.sensor), pair[0].number);
        let (number, time_s) = (pair[1].number, next.time_s);
        let (code, what) = if last.time_s == time_s {
            (
                "conflict",
                format!("scans {before} and {number} are both at {time_s} s"),
            )
        } else if last.time_s > time_s {
            let detail = format!(
                "scan {number} at {time_s} s is before the end of scan {before} at {} s; scan numbers rise with time",
                last.time_s
            );
            ("unsorted", detail)
        } else {
            continue;
        };
        let detail = format!("sensor '{sensor}': {what} ({})", reader.called(last.row));
        reader.fault_in(next.row, column, code, detail);
    }
}

/// A sensor is at one place at a time.
fn check_poses(
    builder: &Builder,
    groups: &[Group],
    order: &[usize],
    reader: &mut RowReader,
    columns: &Columns,
) {
    let Some(column) = columns.pose.first() else {
        return;
    };
    for group in groups {
        for pair in order[group.rows.clone()].windows(2) {
            let (before, after) = (&builder.found[pair[0]], &builder.found[pair[1]]);
            let poses = before.pose.zip(after.pose);
            let differ = poses.is_some_and(|(before, after)| {
                builder.poses[before as usize] != builder.poses[after as usize]
            });
            if before.time_s == after.time_s && differ {
                let detail = format!(
                    "scan {} of sensor '{}' has another pose at {} s: {}",
                    group.number,
                    builder.sensors.name(group.sensor),
                    before.time_s,
                    reader.called(before.row)
                );
                reader.fault_in(after.row, column, "conflict", detail);
            }
        }
    }
}

fn check_ids(
    builder: &Builder,
    groups: &[Group],
    order: &[usize],
    reader: &mut RowReader,
    columns: &Columns,
) {
    let Some(column) = columns.id else { return };
    let mut sorted: Vec<usize> = Vec::new();
    for group in groups {
        sorted.clear();
        let rows = order[group.rows.clone()].iter();
        sorted.extend(rows.filter(|&&row| builder.found[row].detection.is_some()));
        sorted.sort_by(|&a, &b| builder.ids[a].cmp(&builder.ids[b]).then(a.cmp(&b)));
        for pair in sorted
            .windows(2)
            .filter(|pair| builder.ids[pair[0]] == builder.ids[pair[1]])
        {
            let detail = format!(
                "detection '{}' occurs twice in scan {} of sensor '{}': also on {}",
                builder.ids[pair[1]],
                group.number,
                builder.sensors.name(group.sensor),
                reader.called(builder.found[pair[0]].row)
            );
            reader.fault_in(builder.found[pair[1]].row, column, "duplicate", detail);
        }
    }
}

fn assemble(
    mut builder: Builder,
    groups: &[Group],
    order: &[usize],
    (declared, columns, frame): (Vec<SensorSettings>, &Columns, Option<Frame>),
) -> Result<Recording, Vec<Fault>> {
    let (names, sensor_place) = std::mem::take(&mut builder.sensors).sorted();
    let (targets, target_place) = std::mem::take(&mut builder.targets).sorted();
    let mut parts = RecordingParts {
        frame,
        sensors: names
            .into_iter()
            .map(|name| settings_of(name, &declared))
            .collect(),
        targets,
        origins_known: columns.truth.is_some(),
        ..RecordingParts::default()
    };
    let plane = frame.map(Stereographic::from);
    let (mut kept, mut has_own_times) = (Vec::with_capacity(builder.found.len()), false);
    for group in groups {
        let rows = order[group.rows.clone()].iter().copied();
        let rows = rows.filter(|&row| builder.found[row].detection.is_some());
        let from = kept.len();
        kept.extend(rows);
        let mut scan = Scan {
            number: group.number,
            time_s: group.time_s,
            sensor: sensor_place[group.sensor as usize] as usize,
            pose: pose_of(&builder, group, order),
            own: Vec::with_capacity(kept.len() - from),
            detections: Vec::with_capacity(kept.len() - from),
        };
        for &row in &kept[from..] {
            let Some(mut detection) = builder.found[row].detection else {
                continue;
            };
            detection.origin = detection.origin.map(|origin| target_place[origin as usize]);
            if let (
                Some(plane),
                Measurement::Position { x_m, y_m } | Measurement::Position3 { x_m, y_m, .. },
            ) = (
                plane.filter(|_| columns.is_geographic),
                &mut detection.measurement,
            ) {
                let place_m = plane.project(*y_m, *x_m);
                (*x_m, *y_m) = (place_m.x, place_m.y);
            }
            has_own_times |= builder.found[row].time_s != group.time_s;
            scan.own.push(Own {
                after_s: builder.found[row].time_s - group.time_s,
                ..builder.found[row].own
            });
            scan.detections.push(detection);
            parts
                .detection_ids
                .push(std::mem::take(&mut builder.ids[row]));
        }
        scan.own = whole(scan.own);
        parts.scans.push(scan);
    }
    parts.beside = beside(builder, &kept, columns, has_own_times);
    Recording::new(parts)
}

/// That of the row nearest in time to the scan, of those that have one.
fn pose_of(builder: &Builder, group: &Group, order: &[usize]) -> Option<Pose> {
    let rows = order[group.rows.clone()]
        .iter()
        .map(|&row| &builder.found[row]);
    let away_s = |row: &Found| (row.time_s - group.time_s).abs();
    let nearest = rows
        .filter(|row| row.pose.is_some())
        .min_by(|a, b| away_s(a).total_cmp(&away_s(b)))?;
    builder.poses.get(nearest.pose? as usize).copied()
}

fn settings_of(name: String, declared: &[SensorSettings]) -> SensorSettings {
    let known = declared.iter().find(|known| known.sensor_id == name);
    known.cloned().unwrap_or(SensorSettings::named(name))
}

fn column_of<T>(found: &[Found], kept: &[usize], read: impl Fn(&Found) -> T) -> Vec<T> {
    kept.iter().map(|&row| read(&found[row])).collect()
}

/// What is known beside the measurements of these rows.
fn beside(builder: Builder, kept: &[usize], columns: &Columns, has_own_times: bool) -> Beside {
    let mut beside = Beside::default();
    if has_own_times {
        beside.times_s = column_of(&builder.found, kept, |one| one.time_s);
    }
    if columns.height.is_some() {
        beside.heights_m = column_of(&builder.found, kept, |one| one.height_m);
    }
    for ((texts, mut labels), &(name, _)) in builder.labels.into_iter().zip(&columns.attributes) {
        labels.texts = Interner::into_names(texts);
        labels.of = kept.iter().map(|&row| labels.of[row]).collect();
        beside.attributes.insert(name, labels);
    }
    beside
}
