//! A file, read whole as a dataset is, pushed at its own pace. The scans of each sensor are numbered in their order, so that a feed
//! that was interrupted goes on where the session is.

use super::client::SessionSeen;
use super::places::Places;
use super::pusher::MOST_SCANS;
use super::ready::{Ready, is_scan, read_scan};
use super::sensors::Mapping;
use super::{Feeding, Speed, no_origin};
use crate::experiment::session::{PushedDetection, PushedPose, PushedScan, Takes};
use crate::formats::{self, ReadOutcome};
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::fault::Fault;
use crate::model::scan::{Measurement, Recording, RecordingParts, Scan};
use crate::model::units::{Reason, Units};
use crate::service::cli::run::Trouble;
use anyhow::Context;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::time::Duration;
use tokio::time::Instant;

/// What comes within this time goes together.
const TOGETHER: Duration = Duration::from_millis(50);
/// A terminal hears of a feed that waits this often.
const HEARD_OF: Duration = Duration::from_secs(1);

/// Feeds a file.
pub(super) async fn feed(feeding: &mut Feeding<'_>, path: &Path) -> Result<(), Trouble> {
    let bytes = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let (scans, units) = if feeding.arguments.is_of_scans() || begins_with_a_scan(&bytes) {
        scans_of_lines(&bytes, feeding)?
    } else {
        scans_of_dataset(bytes, path, feeding)?
    };
    feeding.pusher.progress.units = units;
    push_at_pace(feeding, &scans).await
}

fn begins_with_a_scan(bytes: &[u8]) -> bool {
    let mut lines = bytes.split(|byte| *byte == b'\n');
    let first = lines.find(|line| !line.trim_ascii().is_empty());
    first.is_some_and(is_scan)
}

/// Lines that are scans already. Their own numbers stay; others are numbered from 1.
fn scans_of_lines(bytes: &[u8], feeding: &Feeding) -> Result<(Vec<Ready>, Units), Trouble> {
    let (mut scans, mut faults) = (Vec::new(), Vec::new());
    let mut units = Units::called("line");
    let mut numbers: BTreeMap<String, u64> = BTreeMap::new();
    for (number, line) in (1..).zip(bytes.split(|byte| *byte == b'\n')) {
        if line.trim_ascii().is_empty() {
            continue;
        }
        match read_scan(line, number) {
            Ok(mut ready) => {
                units.use_up(1);
                let next = numbers.entry(ready.scan.sensor_id.clone()).or_insert(1);
                let sequence = *ready.scan.sequence.get_or_insert(*next);
                *next = sequence + 1;
                scans.push(ready);
            }
            Err(found) => {
                units.reject(Reason::Malformed, number, 1);
                faults.extend(found);
            }
        }
    }
    if faults.is_empty() || feeding.arguments.skip_faults {
        Ok((scans, units))
    } else {
        faults.truncate(formats::MAX_FAULTS);
        Err(Trouble::Faults(faults))
    }
}

/// The scans that a dataset of the file has, without those that the session has.
fn scans_of_dataset(
    bytes: Vec<u8>,
    path: &Path,
    feeding: &mut Feeding,
) -> Result<(Vec<Ready>, Units), Trouble> {
    let (format, options) = feeding.arguments.told(&feeding.session)?;
    let is_placed = options.options.iter().any(|(name, _)| name == "origin");
    let (read, format) =
        formats::read_file(&path.to_string_lossy(), &mut &bytes[..], format, &options)?;
    let ReadOutcome {
        dataset,
        warnings,
        mut units,
    } = read;
    feeding.pusher.places = Some(Places {
        bytes,
        format,
        options,
    });
    for warning in warnings {
        eprintln!("warning: {warning}");
    }
    let Dataset::Detections(recording) = dataset else {
        let detail = format!("the file holds {}", dataset.kind().name());
        let fault = Fault::new("/file", "unsupported", detail);
        return Err(vec![fault.allowing(DatasetKind::Detections.name())].into());
    };
    let has_places = recording.detections().any(|detection| {
        let measurement = &detection.measurement;
        matches!(
            measurement,
            Measurement::Position { .. } | Measurement::Position3 { .. }
        )
    });
    if recording.frame.is_some() && has_places && !is_placed {
        return Err(no_origin().into());
    }
    let scans = scans_of(recording, feeding, &mut units)?;
    Ok((not_heard(scans, &feeding.session)?, units))
}

/// The sensors of the session that those of a recording are; of scans of others nothing is pushed.
///
/// # Errors
/// None of them is a sensor of the session.
fn names_of(
    parts: &RecordingParts,
    mapping: &mut Mapping,
) -> Result<Vec<Option<String>>, Vec<Fault>> {
    let used: BTreeSet<usize> = parts.scans.iter().map(|scan| scan.sensor).collect();
    if used.len() > 1 {
        mapping.know_several();
    }
    let (mut names, mut faults) = (Vec::new(), Vec::new());
    for (index, sensor) in parts.sensors.iter().enumerate() {
        if !used.contains(&index) {
            names.push(None);
            continue;
        }
        let name = mapping.of(&sensor.sensor_id).map(str::to_owned);
        if name.is_none() {
            faults.push(mapping.unknown(&sensor.sensor_id));
        }
        names.push(name);
    }
    if used.iter().all(|index| names[*index].is_none()) {
        return Err(faults);
    }
    for fault in faults {
        eprintln!("warning: {}; it is left out", fault.detail);
    }
    Ok(names)
}

/// Scans as they are pushed, numbered from 1 for each sensor.
fn scans_of(
    recording: Recording,
    feeding: &mut Feeding,
    units: &mut Units,
) -> Result<Vec<Ready>, Vec<Fault>> {
    if recording.scans.is_empty() {
        return Ok(Vec::new());
    }
    let names = names_of(&recording, &mut feeding.mapping)?;
    let mut numbers: BTreeMap<&str, u64> = BTreeMap::new();
    let mut scans = Vec::with_capacity(recording.scans.len());
    let mut unsaid = false;
    for (first, scan) in recording.scans_with_firsts() {
        let Some(name) = names[scan.sensor].as_deref() else {
            units.ignore_used("sensor unknown", scan.detections.len() as u64);
            continue;
        };
        let number = numbers.entry(name).or_default();
        *number += 1;
        let (takes, moves) = feeding.session.takes(name);
        unsaid |= scan.pose.is_some() && !moves;
        let pushed = PushedScan {
            sensor_id: name.to_owned(),
            sequence: Some(*number),
            time_s: scan.time_s,
            heartbeat: false,
            pose: scan
                .pose
                .as_ref()
                .filter(|_| moves)
                .map(PushedPose::of)
                .map(Box::new),
            detections: detections_of((&recording, first), scan, takes),
        };
        scans.push(Ready {
            scan: pushed,
            unit: 0,
        });
    }
    if unsaid {
        eprintln!(
            "warning: the file says where its sensors were, and the session says it, too: that of the session counts"
        );
    }
    Ok(scans)
}

/// The detections of a scan, of which the first has this index.
fn detections_of(
    (recording, first): (&Recording, usize),
    scan: &Scan,
    takes: Takes,
) -> Vec<PushedDetection> {
    let has_times = scan.own.iter().any(|own| own.after_s != 0.0);
    let mut pushed = Vec::with_capacity(scan.detections.len());
    for (index, detection) in scan.detections.iter().enumerate() {
        let own_s = recording.beside.times_s.get(first + index).copied();
        let id = recording.detection_ids[first + index].clone();
        let own = (&scan.own_of(index), own_s.filter(|_| has_times));
        pushed.push(PushedDetection::of(id, detection).with_own(detection, own, takes));
    }
    pushed
}

/// The scans that the session does not have. It has those up to its latest time, where that is of a scan of the file; a file that is
/// all later is a further one, numbered on.
fn not_heard(scans: Vec<Ready>, session: &SessionSeen) -> Result<Vec<Ready>, Vec<Fault>> {
    let mut starts: BTreeMap<String, (u64, u64)> = BTreeMap::new();
    let mut faults = Vec::new();
    for sensor_id in session.sensor_ids() {
        let (Some(last), Some(last_s)) = session.heard_of(&sensor_id) else {
            continue;
        };
        let of_sensor = scans
            .iter()
            .filter(|ready| ready.scan.sensor_id == sensor_id);
        let there = of_sensor
            .clone()
            .position(|ready| ready.scan.time_s == last_s);
        let first_s = of_sensor.clone().next().map(|ready| ready.scan.time_s);
        match (there, first_s) {
            (Some(index), _) => {
                let had = index as u64 + 1;
                starts.insert(sensor_id, (had, last.saturating_sub(had)));
            }
            (None, Some(first_s)) if first_s <= last_s => {
                let detail = format!(
                    "the session has heard of '{sensor_id}' up to {last_s} s, where the file, which begins at {first_s} s, has no scan of it"
                );
                let allowed = "the file that was fed before, or a later one";
                faults.push(Fault::new("/file", "conflict", detail).allowing(allowed));
            }
            _ => drop(starts.insert(sensor_id, (0, last))),
        }
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let mut left = Vec::with_capacity(scans.len());
    for mut ready in scans {
        let (had, before) = starts
            .get(&ready.scan.sensor_id)
            .copied()
            .unwrap_or_default();
        let number = ready.scan.sequence.unwrap_or_default();
        if number > had {
            ready.scan.sequence = Some(number + before);
            left.push(ready);
        }
    }
    Ok(left)
}

async fn push_at_pace(feeding: &mut Feeding<'_>, scans: &[Ready]) -> Result<(), Trouble> {
    let Some(first) = scans.first() else {
        return Ok(());
    };
    let pace = Pace {
        start: Instant::now(),
        first_s: first.scan.time_s,
        speed: feeding.arguments.speed,
    };
    let mut at = 0;
    while at < scans.len() {
        if wait_until(feeding, pace.due(&scans[at])).await {
            return Ok(());
        }
        let now = Instant::now() + TOGETHER;
        let due = scans[at..].iter().take(MOST_SCANS);
        let count = due
            .take_while(|ready| pace.due(ready) <= now)
            .count()
            .max(1);
        feeding.pusher.push(&scans[at..at + count]).await?;
        at += count;
        let behind = pace.due(&scans[at - 1]).elapsed();
        let is_paced = pace.speed.0.is_some();
        feeding.pusher.progress.lag_s = is_paced.then_some(behind.as_secs_f64());
    }
    Ok(())
}

/// Whether somebody asked to stop before this time.
async fn wait_until(feeding: &mut Feeding<'_>, due: Instant) -> bool {
    loop {
        let next = due.min(Instant::now() + HEARD_OF);
        tokio::select! {
            biased;
            () = feeding.stop.asked() => return true,
            () = tokio::time::sleep_until(next) => {}
        }
        feeding.pusher.progress.show();
        if Instant::now() >= due {
            return false;
        }
    }
}

/// When scans are pushed.
struct Pace {
    start: Instant,
    first_s: f64,
    speed: Speed,
}

impl Pace {
    fn due(&self, ready: &Ready) -> Instant {
        let Some(speed) = self.speed.0 else {
            return self.start;
        };
        let after_s = (ready.scan.time_s - self.first_s) / speed;
        let after = Duration::try_from_secs_f64(after_s.max(0.0));
        // What is due in a year and more is due in a year.
        let year = Duration::from_secs(366 * 86_400);
        self.start + after.map_or(year, |after| after.min(year))
    }
}
