//! What a scenario will report, tried on the filter, the associator and the start of the tracks before anything is simulated:
//! one detection of each sensor tells what all of them would only tell in the run.

use super::plan::scenario_of;
use super::{associate, given, scene, sensors};
use crate::filtering::AnyFilter;
use crate::math::rng::Seed;
use crate::model::fault::Fault;
use crate::model::scan::{Detection, Measurement, Recording, RecordingParts, Scan};
use crate::model::scenario::{ReportNoise, Scenario, ScenarioSensor, TargetPlan};
use crate::model::sensor::SensorSettings;
use crate::simulation;
use crate::tracking::Lifecycle;
use serde::Deserialize;
use serde_json::Value;

/// Reports what of the request cannot be used on its own scenario; the scenario itself is right.
pub(super) fn check(spec: &Value, faults: &mut Vec<Fault>) {
    let (Some((scenario, "/input/scenario")), Ok((filter, name))) =
        (scenario_of(spec), associate::filter_of(spec))
    else {
        return;
    };
    let Ok(recording) = recording_of(&scenario) else {
        return;
    };
    let lifecycle = spec
        .get("tracker")
        .and_then(|tracker| Lifecycle::deserialize(tracker).ok());
    if let Err(found) = check_sensors(spec, &recording, (&filter, name), lifecycle.as_ref()) {
        faults.extend(found);
    }
    if let Ok((associator, method)) = associate::associator_of(spec, Seed { seed: 0, run: 0 }) {
        faults.extend(associate::unmet_need(
            &method,
            associator.needs(),
            &recording,
        ));
    }
    let is_of_bearings = matches!(scenario.targets, TargetPlan::Bearings(_));
    if spec.get("truth").is_none()
        && let Some(lifecycle) = lifecycle
    {
        faults.extend(given::unfit_truth(
            &lifecycle,
            is_of_bearings,
            (&filter, name),
        ));
    }
}

fn check_sensors(
    spec: &Value,
    recording: &Recording,
    filter: (&AnyFilter, &str),
    lifecycle: Option<&Lifecycle>,
) -> Result<(), Vec<Fault>> {
    let requested = scene::requested_sensors(spec);
    let known = sensors::known(recording, &[], &requested)?;
    let resolved = sensors::resolve(recording, &known, filter, &mut Vec::new())?;
    let mut faults = sensors::misplaced_densities(&requested, &resolved);
    faults.extend(lifecycle.and_then(|lifecycle| associate::unbounded_gate(lifecycle, &resolved)));
    if faults.is_empty() {
        Ok(())
    } else {
        Err(faults)
    }
}

/// One scan of one detection for each sensor.
pub(super) fn recording_of(scenario: &Scenario) -> Result<Recording, Vec<Fault>> {
    let is_record = scenario.record.is_some();
    let mut parts = RecordingParts {
        targets: vec!["target".to_owned()],
        origins_known: true,
        ..Default::default()
    };
    for (index, sensor) in scenario.sensors.iter().enumerate() {
        let Some(measurement) = report_of(sensor) else {
            continue;
        };
        parts.scans.push(Scan {
            number: index as u32 + 1,
            time_s: 0.0,
            sensor: index,
            first: parts.detections.len(),
            count: 1,
        });
        parts.detection_ids.push("1".to_owned());
        // A detector tells how strong what it found is; it also tells the noise where nobody else does.
        parts.detections.push(Detection {
            measurement,
            origin: Some(0),
            amplitude: is_record.then_some(1.0),
        });
        let settings = simulation::sensor_settings(sensor);
        let sigma_bearing_deg = settings.sigma_bearing_deg.or(is_record.then_some(1.0));
        parts.sensors.push(SensorSettings {
            sigma_bearing_deg,
            ..settings
        });
    }
    Recording::new(parts)
}

/// What a sensor of the scenario reports; `None` where it does not say.
fn report_of(sensor: &ScenarioSensor) -> Option<Measurement> {
    Some(match sensor.noise()? {
        ReportNoise::Position { .. } => Measurement::Position { x_m: 1.0, y_m: 1.0 },
        ReportNoise::RangeBearing {
            sigma_range_rate_mps,
            ..
        } => Measurement::RangeBearing {
            range_m: 1.0,
            bearing_rad: 0.0,
            range_rate_mps: sigma_range_rate_mps.map(|_| 0.0),
        },
        ReportNoise::Bearing { .. } => Measurement::Bearing { bearing_rad: 0.0 },
    })
}
