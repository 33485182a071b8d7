//! Plays a scenario: targets move, sensors detect them with noise, misses and clutter; true origins are known.

mod bearing_time;
mod carriers;
mod course;
mod coverage;
mod echoes;
mod local_tracks;
mod meeting;
mod radar;
mod recorded;
mod sensors;
mod spline;
mod targets;
mod weaving;

pub use bearing_time::{RECORD, SimulatedRecord, row_count, simulate_record};
pub use carriers::first_pose;
pub use local_tracks::{LOCAL_TRACKS, LocalTracks, SensorTracks, simulate_local_tracks};
pub use sensors::settings as sensor_settings;
pub use targets::fastest_mps;

use crate::math::rng::Seed;
use crate::model::fault::Fault;
use crate::model::scan::{Detection, Measurement, Recording, RecordingParts, Scan};
use crate::model::scenario::{BearingTargets, ManeuveringTarget, Scenario, TargetPlan};
use crate::model::sensing::Site;
use crate::model::truth::TruthSet;
use std::collections::BTreeSet;
use std::ops::ControlFlow;

/// What a scenario produced: what the sensors saw, and what was really there.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulated {
    pub recording: Recording,
    /// Targets that were inside a sensor's field of view at one scan at least, from their first such scan to their last.
    pub truth: TruthSet,
    /// Of recorded targets: how far their splines may be off.
    pub warnings: Vec<String>,
}

/// What no table of fields can see: two sensors or two targets of one name, speeds in the wrong order, a plan of bearings
/// without a target, and of a sensor what [`sensors::faults`] finds.
///
/// # Errors
/// All faults, with pointers into the scenario.
pub fn check(scenario: &Scenario) -> Result<(), Vec<Fault>> {
    let sensor_ids = scenario
        .sensors
        .iter()
        .map(|sensor| sensor.sensor_id.as_str());
    let mut faults = duplicate_faults("sensors", sensor_ids, |index| {
        format!("/sensors/{index}/sensor_id")
    });
    faults.extend(
        scenario
            .sensors
            .iter()
            .enumerate()
            .flat_map(|(index, sensor)| sensors::faults(index, sensor, scenario)),
    );
    match &scenario.targets {
        TargetPlan::Random(plan) if plan.speed_min_mps > plan.speed_max_mps => {
            let detail = format!("{} m/s is above speed_max_mps", plan.speed_min_mps);
            faults.push(
                Fault::new("/targets/speed_min_mps", "out_of_range", detail)
                    .allowing(format!("<= {} m/s", plan.speed_max_mps)),
            );
        }
        TargetPlan::Random(_) => {}
        TargetPlan::Listed { targets } => {
            let names = targets.iter().map(|target| target.truth_id.as_str());
            faults.extend(duplicate_faults("targets", names, |index| {
                format!("/targets/targets/{index}/truth_id")
            }));
        }
        TargetPlan::Maneuvering { targets } => faults.extend(maneuvering_faults(targets)),
        TargetPlan::Bearings(plan) => faults.extend(bearing_faults(plan)),
        TargetPlan::Meeting(plan) if plan.leaving > plan.count => {
            let detail = format!("{} targets cannot leave of {}", plan.leaving, plan.count);
            faults.push(
                Fault::new("/targets/leaving", "out_of_range", detail)
                    .allowing(format!("<= {} (count)", plan.count)),
            );
        }
        TargetPlan::Formation(_) | TargetPlan::Meeting(_) => {}
        TargetPlan::Recorded(_) => faults.extend(recorded::fault(scenario)),
    }
    faults.extend(coverage::fault(scenario));
    faults.extend(
        scenario
            .record
            .iter()
            .flat_map(|plan| bearing_time::faults(scenario, plan)),
    );
    if faults.is_empty() {
        Ok(())
    } else {
        Err(faults)
    }
}

/// Simulates `scenario`; `progress(done)` is told after each scan and may stop the work (then the result is `None`).
///
/// # Errors
/// Those of [`check`]; recorded targets, which need a truth.
pub fn simulate(
    scenario: &Scenario,
    seed: Seed,
    progress: &mut dyn FnMut(u64) -> ControlFlow<()>,
) -> Result<Option<Simulated>, Vec<Fault>> {
    simulate_recorded(scenario, None, seed, progress)
}

/// What a recording says besides its scans.
fn without_scans(scenario: &Scenario, truth: &TruthSet) -> RecordingParts {
    let targets = truth.targets().iter();
    RecordingParts {
        frame: scenario.origin,
        sensors: scenario.sensors.iter().map(sensors::settings).collect(),
        targets: targets.map(|target| target.truth_id.clone()).collect(),
        origins_known: true,
        ..Default::default()
    }
}

/// The same; the targets may be those of a recorded truth.
///
/// # Errors
/// Those of [`check`]; recorded targets without a truth.
pub fn simulate_recorded(
    scenario: &Scenario,
    recorded: Option<&TruthSet>,
    seed: Seed,
    progress: &mut dyn FnMut(u64) -> ControlFlow<()>,
) -> Result<Option<Simulated>, Vec<Fault>> {
    check(scenario)?;
    let (scenario, played) = &recorded::placed(scenario, recorded)?;
    let paths = match played {
        Some(played) => played.paths.clone(),
        None => targets::paths(scenario, seed),
    };
    let sites: Vec<Site> = scenario
        .sensors
        .iter()
        .map(|sensor| recorded::site_of(sensor, scenario.origin))
        .collect();
    let start_s = played.as_ref().map_or(0.0, |played| played.start_s);
    let times: Vec<f64> = (0..scenario.scans)
        .map(|scan| start_s + f64::from(scan) * scenario.scan_period_s)
        .collect();
    let coverage = coverage::Coverage::new(scenario, seed);
    let carriers = carriers::Carriers::new(scenario);
    let (mut truth, seen) = observed_truth(scenario, &paths, (&coverage, &carriers), &times)?;
    truth.frame = scenario.origin;
    let mut parts = without_scans(scenario, &truth);
    let fastest_mps = paths
        .iter()
        .map(targets::Path::speed_mps)
        .fold(0.0, f64::max);
    let radars = || {
        let sensors = scenario.sensors.iter().enumerate();
        sensors.filter_map(|(index, sensor)| {
            Some(radar::Radar {
                sensor,
                index,
                noise: sensor.noise()?,
                coverage: &coverage,
                carriers: &carriers,
                fastest_mps,
                space: scenario.targets.space(),
                site: sites[index],
            })
        })
    };
    for (index, &time_s) in times.iter().enumerate() {
        for radar in radars() {
            let found = radar::scan(radar, index as u64, time_s, &paths, &seen, seed);
            append_scan(&mut parts, radar.index, time_s, found);
            if let Some(scan) = parts.scans.last_mut() {
                scan.pose = carriers.pose(radar.index, time_s);
            }
        }
        if progress(index as u64 + 1).is_break() {
            return Ok(None);
        }
    }
    let mut simulated = Simulated {
        recording: Recording::new(parts)?,
        truth,
        warnings: Vec::new(),
    };
    if let (Some(played), Some(source)) = (played, recorded) {
        played.describe(source, &mut simulated)?;
    }
    Ok(Some(simulated))
}

fn maneuvering_faults(targets: &[ManeuveringTarget]) -> Vec<Fault> {
    let names = targets.iter().map(|target| target.truth_id.as_str());
    let mut faults = duplicate_faults("targets", names, |index| {
        format!("/targets/targets/{index}/truth_id")
    });
    for (index, target) in targets.iter().enumerate() {
        if let Some(end_s) = target.end_s.filter(|end_s| *end_s <= target.start_s) {
            let detail = format!("{end_s} s is not after start_s");
            let pointer = format!("/targets/targets/{index}/end_s");
            faults.push(
                Fault::new(pointer, "out_of_range", detail)
                    .allowing(format!("> {} s", target.start_s)),
            );
        }
    }
    faults
}

fn bearing_faults(plan: &BearingTargets) -> Vec<Fault> {
    let (names, lines): (Vec<String>, Vec<Option<usize>>) = targets::bearing_names(plan).unzip();
    if names.is_empty() {
        return vec![
            Fault::new("/targets", "missing", "the scene has no target")
                .allowing("at least one entry in crossings or lines"),
        ];
    }
    // Only lines have names of their own, and they come last: none of them is repeated by a crossing.
    let pointer = |index: usize| {
        lines[index].map_or_else(String::new, |line| {
            format!("/targets/lines/{line}/truth_id")
        })
    };
    duplicate_faults("targets", names.iter().map(String::as_str), pointer)
}

/// A fault for each name that stood in the list before.
fn duplicate_faults<'a>(
    what: &str,
    names: impl Iterator<Item = &'a str>,
    pointer: impl Fn(usize) -> String,
) -> Vec<Fault> {
    let mut seen = BTreeSet::new();
    let repeated = names
        .enumerate()
        .filter(|(_, name)| !seen.insert(name.to_owned()));
    let fault = |index, name| {
        Fault::new(
            pointer(index),
            "duplicate",
            format!("two {what} are called '{name}'"),
        )
    };
    repeated
        .map(|(index, name)| fault(index, name).allowing("each name once"))
        .collect()
}

/// The truth of every target that some sensor could see, and for each path its index among those.
fn observed_truth(
    scenario: &Scenario,
    paths: &[targets::Path],
    (coverage, carriers): (&coverage::Coverage, &carriers::Carriers),
    times: &[f64],
) -> Result<(TruthSet, Vec<Option<u32>>), Vec<Fault>> {
    let mut observed = Vec::new();
    let mut seen = Vec::with_capacity(paths.len());
    for (index, path) in paths.iter().enumerate() {
        let is_visible = |time_s: &f64| {
            if !path.exists_at(*time_s) {
                return false;
            }
            let point = path.point_at(*time_s);
            let mut sensors = scenario.sensors.iter().enumerate();
            sensors.any(|(sensor_index, sensor)| {
                coverage.includes(sensor_index, index)
                    && radar::is_in_view(
                        (sensor, carriers.place_m(sensor_index, *time_s)),
                        scenario.targets.space(),
                        &point,
                    )
            })
        };
        let first = times.iter().position(is_visible);
        let last = times.iter().rposition(is_visible);
        seen.push(first.map(|_| observed.len() as u32));
        if let (Some(first), Some(last)) = (first, last) {
            let between = &times[first..=last];
            let is_recorded = matches!(scenario.targets, TargetPlan::Recorded(_));
            // A recorded target may leave the sight of all sensors and come back.
            observed.push(if is_recorded {
                let seen: Vec<f64> = between.iter().copied().filter(is_visible).collect();
                path.truth_at(&seen)
            } else {
                path.truth_at(between)
            });
        }
    }
    Ok((TruthSet::new(scenario.targets.space(), observed)?, seen))
}

/// Appends one scan. Detections are sorted by what was measured, so that their order tells nothing of their origin.
fn append_scan(parts: &mut RecordingParts, sensor: usize, time_s: f64, mut found: Vec<Detection>) {
    let values = |detection: &Detection| match detection.measurement.flat() {
        Measurement::Position { x_m, y_m } => (x_m, y_m),
        Measurement::RangeBearing {
            range_m,
            bearing_rad,
            ..
        } => (range_m, bearing_rad),
        Measurement::Bearing { bearing_rad } => (bearing_rad, 0.0),
        _ => (0.0, 0.0),
    };
    found.sort_by(|left, right| {
        values(left)
            .0
            .total_cmp(&values(right).0)
            .then(values(left).1.total_cmp(&values(right).1))
    });
    let number = parts.scans.len() as u32 + 1;
    parts
        .detection_ids
        .extend((1..=found.len()).map(|index| format!("{number}-{index}")));
    found.shrink_to_fit();
    parts.scans.push(Scan {
        number,
        time_s,
        sensor,
        pose: None,
        own: Vec::new(),
        detections: found,
    });
}
