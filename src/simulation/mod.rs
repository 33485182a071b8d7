//! Plays a scenario: targets move, sensors detect them with noise, misses and clutter; true origins are known.

mod bearing_time;
mod carriers;
mod clutter;
mod course;
mod coverage;
mod echoes;
mod local_tracks;
mod meeting;
mod radar;
mod recorded;
mod schedule;
mod sensors;
mod spline;
mod targets;
mod view;
mod weaving;

pub use bearing_time::{RECORD, SimulatedRecord, row_count, simulate_record};
pub use carriers::first_pose;
pub use local_tracks::{LOCAL_TRACKS, LocalTracks, SensorTracks, simulate_local_tracks};
pub use schedule::step_count;
pub use sensors::settings as sensor_settings;
pub use targets::fastest_mps;

use self::radar::Found;
use self::schedule::Look;
use crate::math::rng::Seed;
use crate::model::fault::Fault;
use crate::model::own::{Own, whole};
use crate::model::scan::{Measurement, Recording, RecordingParts, Scan};
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
    let looks = schedule::looks(scenario, start_s);
    let coverage = coverage::Coverage::new(scenario, seed);
    let carriers = carriers::Carriers::new(scenario);
    let views: Vec<view::View> = scenario.sensors.iter().map(view::View::of).collect();
    let watchers = Watchers {
        scenario,
        coverage: &coverage,
        carriers: &carriers,
        views: &views,
    };
    let (mut truth, seen) = watchers.observed_truth(&paths, &schedule::times_s(&looks))?;
    truth.frame = scenario.origin;
    let mut parts = without_scans(scenario, &truth);
    let fastest_mps = paths
        .iter()
        .map(targets::Path::speed_mps)
        .fold(0.0, f64::max);
    let scene = Scene {
        watchers,
        fastest_mps,
        sites,
    };
    let mut steps = 0;
    for (index, look) in looks.iter().enumerate() {
        let Some(radar) = scene.radar(look.sensor) else {
            continue;
        };
        let found = radar::scan(radar, look.number, look.made_s, &paths, &seen, seed);
        append_scan(&mut parts, look, found);
        if let Some(scan) = parts.scans.last_mut() {
            scan.pose = carriers.pose(look.sensor, look.made_s);
        }
        let next = looks.get(index + 1);
        let is_last = next.is_none_or(|next| next.time_s != look.time_s);
        steps += u64::from(is_last);
        if is_last && progress(steps).is_break() {
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

/// What the sensors of a scenario work with.
struct Scene<'s> {
    watchers: Watchers<'s>,
    fastest_mps: f64,
    sites: Vec<Site>,
}

impl<'s> Scene<'s> {
    /// `None` of a sensor that reports nothing.
    fn radar(&self, index: usize) -> Option<radar::Radar<'s>> {
        let Watchers {
            scenario,
            coverage,
            carriers,
            views,
        } = self.watchers;
        let sensor = &scenario.sensors[index];
        Some(radar::Radar {
            sensor,
            index,
            noise: sensor.noise()?,
            view: &views[index],
            coverage,
            carriers,
            fastest_mps: self.fastest_mps,
            space: scenario.targets.space(),
            site: self.sites[index],
        })
    }
}

/// What decides who sees whom.
#[derive(Clone, Copy)]
struct Watchers<'w> {
    scenario: &'w Scenario,
    coverage: &'w coverage::Coverage,
    carriers: &'w carriers::Carriers,
    views: &'w [view::View],
}

impl Watchers<'_> {
    /// The truth of every target that some sensor could see, and for each path its index among those.
    fn observed_truth(
        &self,
        paths: &[targets::Path],
        times: &[f64],
    ) -> Result<(TruthSet, Vec<Option<u32>>), Vec<Fault>> {
        let space = self.scenario.targets.space();
        let mut observed = Vec::new();
        let mut seen = Vec::with_capacity(paths.len());
        for (index, path) in paths.iter().enumerate() {
            let is_visible = |time_s: &f64| self.see((index, path), *time_s);
            let first = times.iter().position(is_visible);
            let last = times.iter().rposition(is_visible);
            seen.push(first.map(|_| observed.len() as u32));
            if let (Some(first), Some(last)) = (first, last) {
                let between = &times[first..=last];
                let is_recorded = matches!(self.scenario.targets, TargetPlan::Recorded(_));
                // A recorded target may leave the sight of all sensors and come back.
                observed.push(if is_recorded {
                    let seen: Vec<f64> = between.iter().copied().filter(is_visible).collect();
                    path.truth_at(&seen)
                } else {
                    path.truth_at(between)
                });
            }
        }
        Ok((TruthSet::new(space, observed)?, seen))
    }

    /// Whether a sensor could see a target in a scan of that time, if it made one.
    fn see(&self, (index, path): (usize, &targets::Path), time_s: f64) -> bool {
        let space = self.scenario.targets.space();
        for (number, sensor) in self.scenario.sensors.iter().enumerate() {
            let made_s = time_s - sensor.timing.latency_s.unwrap_or(0.0);
            let is_there = path.exists_at(time_s) && path.exists_at(made_s);
            if !is_there || !self.coverage.includes(number, index) {
                continue;
            }
            let place_m = self.carriers.place_m(number, made_s);
            let point = path.point_at(made_s);
            if radar::p_d((sensor, place_m), &self.views[number], space, &point) > 0.0 {
                return true;
            }
        }
        false
    }
}

/// Appends one scan. Detections are sorted by what was measured, so that their order tells nothing of their origin.
fn append_scan(parts: &mut RecordingParts, look: &Look, mut found: Vec<Found>) {
    let values = |found: &Found| match found.detection.measurement.flat() {
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
    let own = found.iter().map(|found| Own {
        velocity_mps: found.velocity_mps,
        ..Own::default()
    });
    parts.scans.push(Scan {
        number,
        time_s: look.time_s,
        sensor: look.sensor,
        pose: None,
        own: whole(own.collect()),
        detections: found.into_iter().map(|found| found.detection).collect(),
    });
}
