//! What about a dataset seems wrong, though it can be read: degrees or kilometres in columns of metres, times that are Unix
//! seconds, clocks that are hours apart, jumps faster than sound, detections that nothing follows, scans that are missing.

use super::chains::{self, Chain};
use super::clocks;
use crate::model::dataset::Dataset;
use crate::model::space::{Place, Space};
use crate::model::state::Position;
use crate::model::time::TimeBase;
use crate::model::truth::TruthPoint;

/// In dry air of 20 °C.
const SOUND_MPS: f64 = 343.0;
/// Relative times beyond these are Unix seconds, or milliseconds.
const UNIX_S: f64 = 1e9;
const UNIX_MS: f64 = 1e11;

/// What goes steadily, and yet no faster than this, may be given in kilometres (m/s).
const SLOW_MPS: f64 = 0.5;
/// Steps, or links from scan to scan, below which nobody can tell.
const LEAST_STEPS: usize = 10;

/// From one point of an object to the next.
struct Step {
    way_m: f64,
    time_s: f64,
    at_s: f64,
    /// As the file says it, at the second point.
    speed_mps: Option<f64>,
}

/// A sentence for each thing that seems wrong; `places_m` are all places of the set.
pub fn of(dataset: &Dataset, places_m: &[Position]) -> Vec<String> {
    let chains = match dataset {
        Dataset::Detections(recording) => chains::of(recording),
        _ => Vec::new(),
    };
    let steps = steps_of(dataset);
    let mut found = Vec::new();
    found.extend(unix_times(dataset));
    // Kilometres may look like degrees; what velocities say is surer.
    let steady = steady_steps(dataset, &chains);
    let units = other_units(&steps)
        .or_else(|| {
            degrees(
                dataset,
                places_m,
                if steps.is_empty() { &steady } else { &steps },
            )
        })
        .or_else(|| slow(dataset, &steady));
    found.extend(units);
    found.extend(jumps(&steps));
    found.extend(nothing_follows(&chains));
    found.extend(clocks::of_sensors(dataset));
    found.extend(missing_scans(dataset));
    found
}

fn steps_of(dataset: &Dataset) -> Vec<Step> {
    let mut steps = Vec::new();
    match dataset {
        Dataset::Truth(truth) if truth.space() != Space::Bearing => {
            for target in truth.targets() {
                let points = target.points.iter();
                let points: Vec<_> = points
                    .map(|point| (point.time_s, point.position, point.velocity))
                    .collect();
                add_steps(&points, &mut steps);
            }
        }
        Dataset::Tracks(set) if set.space != Space::Bearing => {
            for track in &set.tracks {
                let points: Vec<_> = track
                    .points
                    .iter()
                    .map(|point| {
                        (
                            point.time_s,
                            point.estimate.position,
                            point.estimate.velocity,
                        )
                    })
                    .collect();
                add_steps(&points, &mut steps);
            }
        }
        _ => {}
    }
    steps
}

fn add_steps(points: &[(f64, Place, Option<Place>)], steps: &mut Vec<Step>) {
    for pair in points.windows(2) {
        let time_s = pair[1].0 - pair[0].0;
        if time_s > 0.0 {
            steps.push(Step {
                way_m: (pair[1].1 - pair[0].1).norm(),
                time_s,
                at_s: pair[1].0,
                speed_mps: pair[1].2.map(|velocity| velocity.norm()),
            });
        }
    }
}

/// The steps of what goes steadily: less than half of its way is to and fro.
fn steady_steps(dataset: &Dataset, chains: &[Chain]) -> Vec<Step> {
    let paths: Vec<Chain> = match dataset {
        Dataset::Truth(truth) if truth.space() != Space::Bearing => {
            let points = truth.targets().iter().map(|target| &target.points);
            let path = |point: &TruthPoint| (point.time_s, point.position);
            points
                .map(|points| points.iter().map(path).collect())
                .collect()
        }
        _ => chains.to_vec(),
    };
    let mut steps = Vec::new();
    for path in paths {
        let mut of_it = Vec::new();
        let points = path.iter().map(|&(time_s, place)| (time_s, place, None));
        let points: Vec<_> = points.collect();
        add_steps(&points, &mut of_it);
        let way_m: f64 = of_it.iter().map(|step| step.way_m).sum();
        let ends = path.first().zip(path.last());
        let net_m = ends.map_or(0.0, |(first, last)| (last.1 - first.1).norm());
        if of_it.len() >= LEAST_STEPS && net_m > 0.5 * way_m {
            steps.append(&mut of_it);
        }
    }
    steps
}

/// Places that may be in kilometres: all that goes steadily is slower than a person walks.
fn slow(dataset: &Dataset, steady: &[Step]) -> Option<String> {
    if dataset.frame().is_some() || steady.len() < LEAST_STEPS {
        return None;
    }
    let mut speeds_mps: Vec<f64> = steady.iter().map(|step| step.way_m / step.time_s).collect();
    speeds_mps.sort_by(f64::total_cmp);
    let middle_mps = speeds_mps[speeds_mps.len() / 2];
    (middle_mps < SLOW_MPS).then(|| {
        format!(
            "what goes steadily goes at {middle_mps:.4} m/s: are the lengths kilometres (map them as x_m [km], range_m [km])?"
        )
    })
}

/// Detections that no other ever follows as fast as sound.
fn nothing_follows(chains: &[Chain]) -> Option<String> {
    let mut links = 0;
    let mut slowest_mps = f64::INFINITY;
    for pair in chains.iter().flat_map(|chain| chain.windows(2)) {
        let (way_m, time_s) = ((pair[1].1 - pair[0].1).norm(), pair[1].0 - pair[0].0);
        slowest_mps = slowest_mps.min(way_m / time_s.max(1.0));
        links += 1;
    }
    (links >= LEAST_STEPS && slowest_mps > SOUND_MPS).then(|| {
        format!(
            "nothing ever lies within a gate: from scan to scan the nearest detection is {slowest_mps:.0} m/s away, and more"
        )
    })
}

fn unix_times(dataset: &Dataset) -> Option<String> {
    let last_s = dataset.summary().end_s?;
    if dataset.time_base() != TimeBase::Relative || last_s < UNIX_S {
        return None;
    }
    let told = if last_s < UNIX_MS {
        "times look like seconds since 1970: `time_base: utc` says so"
    } else {
        "times look like milliseconds since 1970: the mapping `time_s [ms]` with `time_base: utc` says so"
    };
    Some(told.to_owned())
}

/// Columns of metres with degrees in them: all values are angles, and nothing moves as fast as a person walks.
fn degrees(dataset: &Dataset, places_m: &[Position], steps: &[Step]) -> Option<String> {
    if dataset.frame().is_some() || steps.is_empty() {
        return None;
    }
    let are_angles = places_m
        .iter()
        .all(|place| place.x.abs() <= 180.0 && place.y.abs() <= 90.0);
    let moving = steps.iter().filter(|step| step.way_m > 0.0);
    let are_slow = moving.clone().all(|step| step.way_m / step.time_s < 0.05);
    (are_angles && are_slow && moving.count() > 0)
        .then(|| "x_m and y_m look like degrees: map them to lon_deg and lat_deg; or like kilometres: x_m [km], y_m [km]".to_owned())
}

/// How many times as fast as it says it is a step goes; of slow ones nobody can tell.
fn ratio_of(step: &Step) -> Option<f64> {
    let found_mps = step.way_m / step.time_s;
    let said_mps = step.speed_mps.filter(|said_mps| *said_mps > 1.0)?;
    (found_mps > 0.0).then_some(found_mps / said_mps)
}

/// Given speeds that are another multiple of the steps than 1.
fn other_units(steps: &[Step]) -> Option<String> {
    let mut ratios: Vec<f64> = steps.iter().filter_map(ratio_of).collect();
    if ratios.len() < 10 {
        return None;
    }
    ratios.sort_by(f64::total_cmp);
    let middle = ratios[ratios.len() / 2];
    let told = |what: &str| {
        format!("positions move {middle:.3} times as fast as the velocities say: {what}")
    };
    match middle {
        0.0008..0.0012 => Some(told(
            "the positions look like kilometres (map them as x_m [km])",
        )),
        0.9..1.1 => None,
        0.49..0.54 => Some(told("the velocities look like knots")),
        0.26..0.29 => Some(told("the velocities look like kilometres an hour")),
        900.0..1100.0 => Some(told("the velocities look like kilometres a second")),
        _ if !(0.5..2.0).contains(&middle) => Some(told("one of the two is in another unit")),
        _ => None,
    }
}

fn jumps(steps: &[Step]) -> Option<String> {
    // A step across less than a second is mostly rounding of the times.
    let fast: Vec<&Step> = steps
        .iter()
        .filter(|step| step.way_m / step.time_s.max(1.0) > SOUND_MPS)
        .collect();
    let first = fast.first()?;
    let count = match fast.len() {
        1 => "1 step is".to_owned(),
        count => format!("{count} steps are"),
    };
    Some(format!(
        "{count} faster than sound, the first of {:.0} m in {} s at {} s",
        first.way_m,
        rounded(first.time_s),
        rounded(first.at_s)
    ))
}

/// To the millisecond.
fn rounded(time_s: f64) -> f64 {
    (time_s * 1e3).round() / 1e3
}

/// Sensors whose numbers of scans leave some out.
fn missing_scans(dataset: &Dataset) -> Option<String> {
    let Dataset::Detections(recording) = dataset else {
        return None;
    };
    let mut missing = 0;
    let mut latest: Vec<Option<u32>> = vec![None; recording.sensors.len()];
    if !crate::model::scan_numbers::are_by_sensor(&recording.scans) {
        return None;
    }
    for scan in &recording.scans {
        if let Some(before) = latest[scan.sensor].replace(scan.number) {
            missing += u64::from(scan.number.saturating_sub(before).saturating_sub(1));
        }
    }
    (missing > 0).then(|| {
        format!("{missing} scans are missing from the numbers: a tracker counts them as misses")
    })
}
