//! Plays a scenario: targets move, sensors detect them with noise, misses and clutter; true origins are known.

mod coverage;
mod radar;
mod targets;
mod weaving;

use crate::math::rng::Seed;
use crate::model::fault::Fault;
use crate::model::scan::{Detection, Measurement, Recording, RecordingParts, Scan};
use crate::model::scenario::{ReportNoise, Scenario, ScenarioSensor, TargetPlan};
use crate::model::sensor::SensorSettings;
use crate::model::truth::{Target, TruthPoint, TruthSet};
use std::collections::BTreeSet;
use std::ops::ControlFlow;

/// What a scenario produced: what the sensors saw, and what was really there.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulated {
    pub recording: Recording,
    /// Targets that were inside a sensor's field of view at one scan at least, from their first such scan to their last.
    pub truth: TruthSet,
}

/// What no table of fields can see: two sensors or two targets of one name, speeds in the wrong order, noises that do not
/// say what a sensor reports.
///
/// # Errors
/// All faults, with pointers into the scenario.
pub fn check(scenario: &Scenario) -> Result<(), Vec<Fault>> {
    let sensor_ids = scenario.sensors.iter().map(|sensor| sensor.sensor_id.as_str());
    let mut faults = duplicate_faults("sensors", sensor_ids, |index| format!("/sensors/{index}/sensor_id"));
    faults.extend(scenario.sensors.iter().enumerate().filter_map(|(index, sensor)| noise_fault(index, sensor)));
    match &scenario.targets {
        TargetPlan::Random(plan) if plan.speed_min_mps > plan.speed_max_mps => {
            let detail = format!("{} m/s is above speed_max_mps", plan.speed_min_mps);
            faults.push(Fault::new("/targets/speed_min_mps", "out_of_range", detail).allowing(format!("<= {} m/s", plan.speed_max_mps)));
        }
        TargetPlan::Random(_) => {}
        TargetPlan::Listed { targets } => {
            let names = targets.iter().map(|target| target.truth_id.as_str());
            faults.extend(duplicate_faults("targets", names, |index| format!("/targets/targets/{index}/truth_id")));
        }
        TargetPlan::Formation(_) => {}
    }
    faults.extend(coverage::fault(scenario));
    if faults.is_empty() { Ok(()) } else { Err(faults) }
}

/// Simulates `scenario`; `progress(done)` is told after each scan and may stop the work (then the result is `None`).
///
/// # Errors
/// Those of [`check`].
pub fn simulate(
    scenario: &Scenario,
    seed: Seed,
    progress: &mut dyn FnMut(u64) -> ControlFlow<()>,
) -> Result<Option<Simulated>, Vec<Fault>> {
    check(scenario)?;
    let paths = targets::paths(scenario, seed);
    let times: Vec<f64> = (0..scenario.scans).map(|scan| f64::from(scan) * scenario.scan_period_s).collect();
    let coverage = coverage::Coverage::new(scenario, seed);
    let (truth, seen) = observed_truth(scenario, &paths, &coverage, &times)?;
    let mut parts = RecordingParts {
        sensors: scenario.sensors.iter().map(settings).collect(),
        targets: truth.targets().iter().map(|target| target.truth_id.clone()).collect(),
        origins_known: true,
        ..Default::default()
    };
    let fastest_mps = paths.iter().map(|path| path.speed_mps()).fold(0.0, f64::max);
    let radar =
        |(index, sensor)| Some(radar::Radar { sensor, index, noise: ScenarioSensor::noise(sensor)?, coverage: &coverage, fastest_mps });
    let radars = || scenario.sensors.iter().enumerate().filter_map(radar);
    for (index, &time_s) in times.iter().enumerate() {
        for radar in radars() {
            let found = radar::scan(radar, index as u64, time_s, &paths, &seen, seed);
            append_scan(&mut parts, radar.index, time_s, found);
        }
        if progress(index as u64 + 1).is_break() {
            return Ok(None);
        }
    }
    Ok(Some(Simulated { recording: Recording::new(parts)?, truth }))
}

/// The noises of a sensor must be those of one kind of report, all of them.
fn noise_fault(index: usize, sensor: &ScenarioSensor) -> Option<Fault> {
    if sensor.noise().is_some() {
        return None;
    }
    let given = [
        ("sigma_x_m", sensor.sigma_x_m),
        ("sigma_y_m", sensor.sigma_y_m),
        ("sigma_range_m", sensor.sigma_range_m),
        ("sigma_bearing_deg", sensor.sigma_bearing_deg),
        ("sigma_range_rate_mps", sensor.sigma_range_rate_mps),
    ];
    let names: Vec<&str> = given.iter().filter(|(_, value)| value.is_some()).map(|(name, _)| *name).collect();
    let (code, found) = if names.len() < 2 { ("missing", "do") } else { ("conflict", "together do") };
    let detail = format!("the noises of sensor '{}' ({}) {found} not say what it reports", sensor.sensor_id, names.join(", "));
    Some(
        Fault::new(format!("/sensors/{index}"), code, detail)
            .allowing("sigma_x_m, sigma_y_m; or sigma_range_m, sigma_bearing_deg[, sigma_range_rate_mps]; or sigma_bearing_deg alone"),
    )
}

/// A fault for each name that stood in the list before.
fn duplicate_faults<'a>(what: &str, names: impl Iterator<Item = &'a str>, pointer: impl Fn(usize) -> String) -> Vec<Fault> {
    let mut seen = BTreeSet::new();
    let repeated = names.enumerate().filter(|(_, name)| !seen.insert(name.to_owned()));
    let fault = |index, name| Fault::new(pointer(index), "duplicate", format!("two {what} are called '{name}'"));
    repeated.map(|(index, name)| fault(index, name).allowing("each name once")).collect()
}

/// The truth of every target that some sensor could see, and for each path its index among those.
fn observed_truth(
    scenario: &Scenario,
    paths: &[targets::Path],
    coverage: &coverage::Coverage,
    times: &[f64],
) -> Result<(TruthSet, Vec<Option<u32>>), Vec<Fault>> {
    let mut observed = Vec::new();
    let mut seen = Vec::with_capacity(paths.len());
    for (index, path) in paths.iter().enumerate() {
        let is_visible = |time_s: &f64| {
            let position_m = path.position_at(*time_s);
            let mut sensors = scenario.sensors.iter().enumerate();
            sensors.any(|(sensor_index, sensor)| coverage.includes(sensor_index, index) && radar::is_in_view(sensor, &position_m))
        };
        let first = times.iter().position(is_visible);
        let last = times.iter().rposition(is_visible);
        seen.push(first.map(|_| observed.len() as u32));
        if let (Some(first), Some(last)) = (first, last) {
            let point = |&time_s: &f64| TruthPoint::in_plane(time_s, path.position_at(time_s), Some(path.velocity_at(time_s)));
            observed.push(Target { truth_id: path.truth_id.clone(), points: times[first..=last].iter().map(point).collect() });
        }
    }
    Ok((TruthSet::new(observed)?, seen))
}

/// Appends one scan. Detections are sorted by what was measured, so that their order tells nothing of their origin.
fn append_scan(parts: &mut RecordingParts, sensor: usize, time_s: f64, mut found: Vec<Detection>) {
    let values = |detection: &Detection| match detection.measurement {
        Measurement::Position { x_m, y_m } => (x_m, y_m),
        Measurement::RangeBearing { range_m, bearing_rad, .. } => (range_m, bearing_rad),
        Measurement::Bearing { bearing_rad } => (bearing_rad, 0.0),
    };
    found.sort_by(|left, right| values(left).0.total_cmp(&values(right).0).then(values(left).1.total_cmp(&values(right).1)));
    let number = parts.scans.len() as u32 + 1;
    parts.scans.push(Scan { number, time_s, sensor, first: parts.detections.len(), count: found.len() });
    parts.detection_ids.extend((1..=found.len()).map(|index| format!("{number}-{index}")));
    parts.detections.append(&mut found);
}

/// Clutter is stated over what the sensor reports: an area, or all directions.
fn settings(sensor: &ScenarioSensor) -> SensorSettings {
    let is_of_bearings = matches!(sensor.noise(), Some(ReportNoise::Bearing { .. }));
    SensorSettings {
        sensor_id: sensor.sensor_id.clone(),
        x_m: Some(sensor.x_m),
        y_m: Some(sensor.y_m),
        max_range_m: Some(sensor.max_range_m),
        p_d: Some(sensor.p_d),
        clutter_per_m2: (!is_of_bearings).then(|| sensor.clutter_per_m2()),
        clutter_per_deg: is_of_bearings.then_some(sensor.clutter_per_scan / 360.0),
        sigma_x_m: sensor.sigma_x_m,
        sigma_y_m: sensor.sigma_y_m,
        sigma_range_m: sensor.sigma_range_m,
        sigma_bearing_deg: sensor.sigma_bearing_deg,
        sigma_range_rate_mps: sensor.sigma_range_rate_mps,
    }
}
