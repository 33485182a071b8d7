//! What a scenario will report, tried on the filter, the associator and the start of the tracks before anything is simulated:
//! one detection of each sensor tells what all of them would only tell in the run.

use super::auto_filter::tracked_space;
use super::check::named_filter;
use super::known::unusable_alone;
use super::track::{nothing_starts, unbounded_gate, unmet_need};
use super::truth_initiation;
use crate::association::BuildAssociator;
use crate::experiment::input::sensors;
use crate::experiment::job::refuse_any;
use crate::experiment::request::draft::Draft;
use crate::experiment::request::methods::{Choice, NamedFilter};
use crate::model::fault::Fault;
use crate::model::scan::{Detection, Measurement, Recording, RecordingParts, Scan};
use crate::model::scenario::{ReportNoise, Scenario, ScenarioSensor};
use crate::model::sensor::SensorSettings;
use crate::simulation;
use crate::tracking::Lifecycle;

/// Reports what of the request cannot be used on its own scenario; the scenario itself is right.
pub fn check(draft: &mut Draft) {
    let (Some((scenario, "/input/scenario")), Some(filter)) =
        (draft.scenario(), named_filter(draft))
    else {
        return;
    };
    let Ok(recording) = recording_of(&scenario) else {
        return;
    };
    let stays_flat = draft.text_at("/tracker/space") == Some("plane");
    let filter = filter.within(tracked_space(&recording, stays_flat));
    let lifecycle = draft.read("/tracker");
    let requested: Vec<SensorSettings> = draft.read("/sensors").unwrap_or_default();
    // There each sensor is tracked by itself.
    let is_apart = draft.has("correlator");
    if let Err(found) = check_sensors(
        &requested,
        &recording,
        &filter,
        lifecycle.as_ref(),
        is_apart,
    ) {
        draft.add(found);
    }
    if let Some(associator) = draft.read::<Choice<BuildAssociator>>("/associator") {
        draft.add(unmet_need(&associator, &recording));
    }
    if !draft.has("truth")
        && let Some(lifecycle) = lifecycle
    {
        draft.add(truth_initiation::unfit_truth(
            &lifecycle,
            scenario.targets.space(),
            &filter,
        ));
    }
}

/// The faults of the sensors with this filter, of a gate that does not bound what is near a track, and of tracks that never start.
fn check_sensors(
    requested: &[SensorSettings],
    recording: &Recording,
    filter: &NamedFilter,
    lifecycle: Option<&Lifecycle>,
    is_apart: bool,
) -> Result<(), Vec<Fault>> {
    let known = sensors::merge_settings(recording, &[], requested)?;
    let resolved = sensors::resolve(recording, &known, filter, &mut Vec::new())?;
    let mut faults = sensors::misplaced_densities(requested, &resolved);
    faults.extend(lifecycle.and_then(|lifecycle| unbounded_gate(lifecycle, &resolved)));
    faults.extend(lifecycle.and_then(|lifecycle| nothing_starts(lifecycle, &resolved)));
    if let Some(lifecycle) = lifecycle.filter(|_| is_apart && faults.is_empty()) {
        faults = unusable_alone(recording, &known, filter, lifecycle);
    }
    refuse_any(faults)
}

/// One scan of one detection for each sensor.
pub fn recording_of(scenario: &Scenario) -> Result<Recording, Vec<Fault>> {
    let is_record = scenario.record.is_some();
    let mut parts = RecordingParts {
        frame: scenario.origin,
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
            pose: simulation::first_pose(sensor),
            // A detector of a record tells how strong what it found is, and the noise where nobody else does.
            own: Vec::new(),
            detections: vec![Detection {
                measurement,
                origin: Some(0),
                amplitude: (is_record || sensor.snr_db.is_some()).then_some(1.0),
            }],
        });
        parts.detection_ids.push("1".to_owned());
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
        ReportNoise::Position {
            sigma_z_m: Some(_), ..
        } => Measurement::Position3 {
            x_m: 1.0,
            y_m: 1.0,
            z_m: 0.0,
        },
        ReportNoise::Position { .. } => Measurement::Position { x_m: 1.0, y_m: 1.0 },
        ReportNoise::RangeBearing {
            sigma_elevation_rad,
            sigma_range_rate_mps,
            ..
        } => {
            let (range_m, bearing_rad) = (1.0, 0.0);
            let range_rate_mps = sigma_range_rate_mps.map(|_| 0.0);
            match sigma_elevation_rad {
                Some(_) => Measurement::RangeBearingElevation {
                    range_m,
                    bearing_rad,
                    elevation_rad: 0.0,
                    range_rate_mps,
                },
                None => Measurement::RangeBearing {
                    range_m,
                    bearing_rad,
                    range_rate_mps,
                },
            }
        }
        ReportNoise::Bearing {
            sigma_elevation_rad: Some(_),
            ..
        } => Measurement::BearingElevation {
            bearing_rad: 0.0,
            elevation_rad: 0.0,
        },
        ReportNoise::Bearing { .. } => Measurement::Bearing { bearing_rad: 0.0 },
    })
}
