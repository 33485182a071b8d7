//! What nobody says of the sensors of a recording, estimated from it: noise, detection probability and clutter. Truth and
//! origins are never looked at.
//!
//! # Method
//! 1. The noise begins as [`start::guess`], P_D as what is assumed, clutter as all detections.
//! 2. The recording, or its first part, is tracked by global nearest neighbour.
//! 3. Noise: from three detections in a row of one track ([`differences`]). Where its innovations are larger than that explains,
//!    σ grows by the square root of mean NIS over what is due; nobody knows a target's course better than its filter does.
//! 4. P_D: detections of confirmed tracks over their scans of that sensor, between confirmation and last detection, over P_G.
//! 5. Clutter: detections that no confirmed track took, a scan, over what the sensor watches.
//! 6. Steps 2 to 5 again until nothing changes by more than a twentieth, [`MOST_PASSES`] times at most.

mod differences;
mod noise;
mod passes;
mod start;

use super::auto_filter::SettledTracking;
use crate::experiment::input::{JobData, sensors};
use crate::experiment::job::RunError;
use crate::experiment::observer::Observer;
use crate::filtering::AnyFilter;
use crate::model::scan::{Recording, RecordingParts};
use crate::model::sensor::SensorSettings;
use crate::model::sight::clutter::{ClutterSettings, LEAST_CLUTTER};
use crate::model::space::Space;
use passes::FoundOfSensor;
use serde::Serialize;

const MOST_PASSES: usize = 5;
/// Changes by less than this share end the passes.
const SETTLED: f64 = 0.05;
/// Fewer scans of tracks tell nothing.
const LEAST_COUNT: usize = 20;
/// What is tracked of a long recording.
const MOST_SCANS: usize = 3000;
const MOST_DETECTIONS: usize = 100_000;

/// A setting of a sensor that was estimated.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = EstimatedSetting))]
pub struct Estimate {
    pub sensor_id: String,
    /// As a request names it.
    pub setting: &'static str,
    pub value: f64,
    /// Of the value, from its scatter in the recording.
    pub standard_error: f64,
    /// What it was estimated from.
    pub from: String,
}

/// What is not known of a sensor.
#[derive(Debug, Clone, PartialEq)]
struct Unknown {
    noise: Vec<noise::Field>,
    p_d: bool,
    /// Whether of a density per degree instead of one per m².
    clutter: Option<Space>,
}

impl Unknown {
    fn of(
        tracking: &SettledTracking,
        recording: &Recording,
        index: usize,
        settings: &SensorSettings,
    ) -> Self {
        let filter = &tracking.filter.filter;
        let is_bearing = !filter.space().has_places() || noise::are_bearings(recording, index);
        let of_ground = settings.clutter_per_m2;
        let (space, density) = match filter.space() {
            _ if is_bearing => (Space::Bearing, settings.clutter_per_deg),
            Space::Volume => (Space::Plane, settings.clutter_per_m3.or(of_ground)),
            _ => (Space::Plane, of_ground),
        };
        let is_open = density.is_none() || settings.clutter == Some(ClutterSettings::Estimated);
        Unknown {
            noise: noise::open_fields(recording, index, filter, settings),
            p_d: settings.p_d.is_none(),
            clutter: is_open.then_some(space),
        }
    }

    fn is_any(&self) -> bool {
        !self.noise.is_empty() || self.p_d || self.clutter.is_some()
    }
}

/// Completes what is known of the sensors of a recording, and tells what was estimated. What cannot be estimated stays open.
///
/// # Errors
/// [`RunError::Stopped`]; what of the data the settings do not fit.
pub fn complete(
    data: &mut JobData,
    tracking: &SettledTracking,
    observer: &mut dyn Observer,
) -> Result<Vec<Estimate>, RunError> {
    let recording = data.recording()?;
    let unknown: Vec<Unknown> = data
        .sensors
        .iter()
        .enumerate()
        .map(|(index, settings)| Unknown::of(tracking, recording, index, settings))
        .collect();
    if !unknown.iter().any(Unknown::is_any) {
        return Ok(Vec::new());
    }
    let part = first_part(recording);
    let sample = part.as_ref().unwrap_or(recording);
    let filter = &tracking.filter.filter;
    let mut known = data.sensors.clone();
    for (index, settings) in known.iter_mut().enumerate() {
        noise::guess(sample, index, &unknown[index].noise, settings);
        // What nothing tells is asked for, as ever.
        if !noise::open_fields(sample, index, filter, settings).is_empty() {
            return Ok(Vec::new());
        }
    }
    let guessed = known.clone();
    begin_with_little_clutter(&mut known, sample, tracking, &unknown)?;
    let mut estimates = iterate(&mut known, sample, tracking, &unknown, observer)?;
    for (index, settings) in guessed.iter().enumerate() {
        noise::keep_guesses(&unknown[index].noise, settings, &mut estimates);
    }
    put_all(&mut data.sensors, &estimates);
    Ok(estimates)
}

/// What is known of the sensors, with any noise in the place of those that will be estimated when the data are there.
pub fn presume(
    sample: &Recording,
    known: &[SensorSettings],
    filter: &AnyFilter,
) -> Vec<SensorSettings> {
    let mut presumed = known.to_vec();
    for (index, settings) in presumed.iter_mut().enumerate() {
        let open = noise::open_fields(sample, index, filter, settings);
        noise::presume(&open, settings);
    }
    presumed
}

/// Of what is detected this share is taken to be clutter at first: with all of it no track of a sparse scene would be given a
/// detection.
const FIRST_SHARE: f64 = 0.03;

fn begin_with_little_clutter(
    known: &mut [SensorSettings],
    sample: &Recording,
    tracking: &SettledTracking,
    unknown: &[Unknown],
) -> Result<(), RunError> {
    let resolved = sensors::resolve(sample, known, &tracking.filter, &mut Vec::new())?;
    for ((settings, sensor), unknown) in known.iter_mut().zip(&resolved).zip(unknown) {
        let density = (FIRST_SHARE * sensor.clutter_density).max(LEAST_CLUTTER);
        match unknown.clutter {
            Some(Space::Bearing) => settings.clutter_per_deg = Some(density.to_radians()),
            Some(_) => settings.clutter_per_m2 = Some(density),
            None => {}
        }
    }
    Ok(())
}

/// Steps 2 to 6.
fn iterate(
    known: &mut [SensorSettings],
    sample: &Recording,
    tracking: &SettledTracking,
    unknown: &[Unknown],
    observer: &mut dyn Observer,
) -> Result<Vec<Estimate>, RunError> {
    let gate_probability = tracking.spec.tracker.lifecycle.gate_probability;
    let mut growth = vec![1.0; known.len()];
    let mut estimates = Vec::new();
    for pass in 0..MOST_PASSES {
        let found = passes::track(sample, known, tracking, observer)?;
        let before = known.to_vec();
        estimates.clear();
        for (index, settings) in known.iter_mut().enumerate() {
            let of_sensor = &found.sensors[index];
            if pass > 0 {
                let factor = of_sensor.innovation_factor(gate_probability);
                growth[index] = (growth[index] * factor).clamp(1.0, 3.0);
            }
            if found.tracks == 0 {
                noise::widen(&unknown[index].noise, settings);
                continue;
            }
            let fields = &unknown[index].noise;
            let told = noise::estimates(fields, settings, of_sensor, growth[index]);
            estimates.extend(told);
            let others = [
                p_d(settings, of_sensor, gate_probability).filter(|_| unknown[index].p_d),
                unknown[index]
                    .clutter
                    .and_then(|space| clutter(settings, of_sensor, space)),
            ];
            estimates.extend(others.into_iter().flatten());
        }
        put_all(known, &estimates);
        if pass > 0 && found.tracks > 0 && is_settled(&before, known) {
            break;
        }
    }
    Ok(estimates)
}

/// Step 4.
fn p_d(
    settings: &SensorSettings,
    found: &FoundOfSensor,
    gate_probability: f64,
) -> Option<Estimate> {
    let (hits, looks) = (found.hits as f64, found.looks as f64);
    if found.looks < LEAST_COUNT {
        return None;
    }
    let share = hits / looks;
    Some(Estimate {
        sensor_id: settings.sensor_id.clone(),
        setting: "p_d",
        value: three_digits((share / gate_probability).clamp(0.01, 0.99)),
        standard_error: three_digits((share * (1.0 - share) / looks).sqrt().max(0.5 / looks)),
        from: format!(
            "{hits} detections in {looks} scans of {} tracks between confirmation and last detection",
            found.tracks
        ),
    })
}

/// Step 5.
fn clutter(settings: &SensorSettings, found: &FoundOfSensor, space: Space) -> Option<Estimate> {
    let scans = found.left_over.len() as f64;
    if found.watched <= 0.0 || scans < 2.0 {
        return None;
    }
    let total: f64 = found.left_over.iter().sum();
    let mean = total / scans;
    let deviation = crate::math::stats::standard_deviation(&found.left_over).unwrap_or(mean.sqrt());
    // Where nothing is left over, less than one would be.
    let value = mean.max(0.5 / scans) / found.watched;
    Some(Estimate {
        sensor_id: settings.sensor_id.clone(),
        setting: match space {
            Space::Bearing => "clutter_per_deg",
            Space::Plane | Space::Volume => "clutter_per_m2",
        },
        value: three_digits(value.max(LEAST_CLUTTER)),
        standard_error: three_digits(deviation.max(0.5) / scans.sqrt() / found.watched),
        from: format!("{total} detections outside every track in {scans} scans"),
    })
}

/// Writes an estimate into the settings of its sensor.
/// Each to its sensor.
fn put_all(sensors: &mut [SensorSettings], estimates: &[Estimate]) {
    for estimate in estimates {
        let is_its = |settings: &&mut SensorSettings| settings.sensor_id == estimate.sensor_id;
        if let Some(settings) = sensors.iter_mut().find(is_its) {
            put(settings, estimate);
        }
    }
}

fn put(settings: &mut SensorSettings, estimate: &Estimate) {
    let value = Some(estimate.value);
    match estimate.setting {
        "p_d" => settings.p_d = value,
        "clutter_per_m2" => settings.clutter_per_m2 = value,
        "clutter_per_deg" => settings.clutter_per_deg = value,
        name => noise::put(settings, name, value),
    }
}

/// Everything that may be estimated.
fn values(settings: &SensorSettings) -> Vec<Option<f64>> {
    let mut values = vec![
        settings.p_d,
        settings.clutter_per_m2,
        settings.clutter_per_deg,
    ];
    values.extend(noise::NAMES.iter().map(|name| noise::get(settings, name)));
    values
}

/// Whether nothing that was estimated changed much.
fn is_settled(before: &[SensorSettings], after: &[SensorSettings]) -> bool {
    let is_near = |(one, other): (Option<f64>, Option<f64>)| match (one, other) {
        (Some(one), Some(other)) => (one - other).abs() <= SETTLED * one.abs().max(other.abs()),
        (one, other) => one == other,
    };
    before
        .iter()
        .zip(after)
        .all(|(before, after)| values(before).into_iter().zip(values(after)).all(is_near))
}

/// Enough of a long recording; `None` of one that is short enough.
fn first_part(recording: &Recording) -> Option<Recording> {
    let (mut scans, mut detections) = (0, 0);
    for scan in &recording.scans {
        if scans == MOST_SCANS || detections + scan.detections.len() > MOST_DETECTIONS {
            break;
        }
        scans += 1;
        detections += scan.detections.len();
    }
    if scans == recording.scans.len() || scans == 0 {
        return None;
    }
    Recording::new(RecordingParts {
        sensors: recording.sensors.clone(),
        scans: recording.scans[..scans].to_vec(),
        detection_ids: recording.detection_ids[..detections].to_vec(),
        ..RecordingParts::default()
    })
    .ok()
}

/// What may be copied into a request.
pub(super) fn three_digits(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// A warning for each estimate.
pub fn warnings(estimates: &[Estimate]) -> impl Iterator<Item = String> {
    estimates.iter().map(|estimate| {
        let Estimate {
            sensor_id,
            setting,
            value,
            standard_error,
            from,
        } = estimate;
        format!(
            "sensor '{sensor_id}': {setting} {value} (standard error {standard_error}) was estimated from {from}; give it in /sensors to fix it"
        )
    })
}
