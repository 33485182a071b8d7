//! One pass over a recording with what is assumed of its sensors, and what it tells of them.

use super::differences::{Residuals, Seen};
use crate::association::global_nearest_neighbour::GlobalNearestNeighbour;
use crate::experiment::associate::auto_filter::SettledTracking;
use crate::experiment::associate::noise::gated_chi_square;
use crate::experiment::associate::speeds;
use crate::experiment::associate::track::ResolvedRecording;
use crate::experiment::input::extent::Extent;
use crate::experiment::input::sensors;
use crate::experiment::job::RunError;
use crate::experiment::observer::{Observer, Step};
use crate::model::scan::{Measurement, Recording};
use crate::model::sensor::{Sensor, SensorSettings};
use crate::model::track::{Track, TrackPoint, TrackSet, TrackStatus};
use crate::model::watch::Watch;
use crate::tracking::{History, Initiation, TrackerParts};
use std::cell::RefCell;

/// What a pass found.
pub struct Found {
    pub tracks: usize,
    pub sensors: Vec<FoundOfSensor>,
}

/// Of one sensor.
#[derive(Debug, Clone, Default)]
pub struct FoundOfSensor {
    /// Tracks that it detected.
    pub tracks: usize,
    pub residuals: Residuals,
    /// Detections of confirmed tracks, and scans in which there might have been one.
    pub hits: usize,
    pub looks: usize,
    /// Detections of each scan that no track took.
    pub left_over: Vec<f64>,
    /// m² or degrees.
    pub watched: f64,
    /// Sum of the squared innovations of confirmed tracks, and their number.
    nis: (f64, usize),
    /// Values of a report.
    dimensions: u32,
}

impl FoundOfSensor {
    /// The root of mean NIS over what is due.
    pub fn innovation_factor(&self, gate_probability: f64) -> f64 {
        let (sum, count) = self.nis;
        if count < super::LEAST_COUNT {
            return 1.0;
        }
        let (due, _) = gated_chi_square(self.dimensions, gate_probability);
        (sum / count as f64 / due).sqrt()
    }
}

/// Tracks a recording.
///
/// # Errors
/// [`RunError::Stopped`]; what of the data the settings do not fit.
pub fn track(
    recording: &Recording,
    known: &[SensorSettings],
    tracking: &SettledTracking,
    observer: &mut dyn Observer,
) -> Result<Found, RunError> {
    let filter = &tracking.filter.filter;
    let sensors = sensors::resolve(recording, known, &tracking.filter, &mut Vec::new())?;
    let resolved = ResolvedRecording {
        recording,
        known,
        sensors: &sensors,
    };
    let tracker = &tracking.spec.tracker;
    let (mut lifecycle, _) = speeds::complete(tracker, None, &resolved, filter, &mut Vec::new());
    if matches!(lifecycle.initiation, Initiation::Truth { .. }) {
        lifecycle.initiation = Initiation::OnePoint;
    }
    let mut tracker = (tracker.build)(TrackerParts {
        filter: *filter,
        associator: Box::new(GlobalNearestNeighbour::default()),
        lifecycle,
        undetected: tracker.undetected.clone(),
        sensors: sensors.clone(),
        given: Vec::new(),
    });
    let mut history = History::default();
    let total = recording.scans.len() as u64;
    let asked = RefCell::new(observer);
    let question = || asked.borrow_mut().progress(Step::Associate, 0, total);
    let watch = Watch::new(&question);
    for scan in &recording.scans {
        tracker.step(scan, &mut history, &watch)?;
        if question().is_break() {
            return Err(RunError::Stopped);
        }
    }
    Ok(read(
        recording,
        (known, &sensors),
        &history.into_tracks(recording),
    ))
}

fn read(
    recording: &Recording,
    (known, sensors): (&[SensorSettings], &[Sensor]),
    tracks: &TrackSet,
) -> Found {
    let mut found: Vec<FoundOfSensor> = Vec::with_capacity(sensors.len());
    for (index, (settings, sensor)) in known.iter().zip(sensors).enumerate() {
        found.push(FoundOfSensor {
            watched: Extent::measure(recording, index, settings, &sensor.report).watched,
            dimensions: sensor.report.dimensions() as u32,
            ..FoundOfSensor::default()
        });
    }
    let reports: Vec<Measurement> = recording
        .detections()
        .map(|detection| detection.measurement)
        .collect();
    let mut used = vec![false; reports.len()];
    for track in &tracks.tracks {
        for (index, of_sensor) in found.iter_mut().enumerate() {
            of_sensor.add(index, (tracks, track), &reports, &mut used);
        }
    }
    for (first, scan) in recording.scans_with_firsts() {
        let of_scan = &used[first..first + scan.detections.len()];
        let left = of_scan.iter().filter(|is_used| !**is_used).count();
        found[scan.sensor].left_over.push(left as f64);
    }
    Found {
        tracks: tracks.tracks.len(),
        sensors: found,
    }
}

impl FoundOfSensor {
    /// What one track tells.
    fn add(
        &mut self,
        sensor: usize,
        (set, track): (&TrackSet, &Track),
        reports: &[Measurement],
        used: &mut [bool],
    ) {
        let detection = |point: &TrackPoint| {
            let mut candidates = set.candidates_of(point).iter();
            candidates.find_map(|candidate| candidate.detection)
        };
        let last = track
            .points
            .iter()
            .rposition(|point| detection(point).is_some());
        let confirmed = track.points.iter().position(is_confirmed);
        let mut seen: Vec<Seen> = Vec::new();
        for (index, point) in track.points.iter().enumerate() {
            if point.sensor != Some(sensor as u32) {
                continue;
            }
            let taken = detection(point);
            if confirmed.is_some_and(|from| index > from) && last.is_some_and(|last| index < last) {
                self.looks += 1;
                self.hits += usize::from(taken.is_some());
            }
            let Some(taken) = taken else { continue };
            used[taken as usize] = true;
            seen.push(Seen {
                time_s: point.time_s,
                report: reports[taken as usize],
            });
            if let Some(nis) = point.nis.filter(|_| is_confirmed(point)) {
                self.nis = (self.nis.0 + nis, self.nis.1 + 1);
            }
        }
        self.tracks += usize::from(!seen.is_empty());
        for triple in seen.windows(3) {
            self.residuals.add([&triple[0], &triple[1], &triple[2]]);
        }
    }
}

fn is_confirmed(point: &TrackPoint) -> bool {
    point.status != Some(TrackStatus::Tentative)
}
