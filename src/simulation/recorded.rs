//! Targets that were recorded: a truth becomes the paths of a scenario, and its sensors find their places in the truth's plane.

use super::Simulated;
use super::spline::Spline;
use super::targets::Path;
use crate::geodesy::{Geodetic, Stereographic};
use crate::model::fault::Fault;
use crate::model::scenario::{Scenario, ScenarioSensor, TargetPlan};
use crate::model::sensing::Site;
use crate::model::space::{Frame, Place, Space};
use crate::model::truth::TruthSet;

/// The paths of a recording.
pub(super) struct Played {
    pub start_s: f64,
    pub paths: Vec<Path>,
    /// How far the splines pass by points that they do not know (m), in rising order.
    errors_m: Vec<f64>,
}

/// What cannot go together with recorded targets.
pub(super) fn fault(scenario: &Scenario) -> Option<Fault> {
    if scenario.origin.is_some() {
        let detail = "recorded targets have the origin of their recording";
        return Some(Fault::new("/origin", "unsupported", detail).allowing("no origin"));
    }
    scenario.coverage.map(|_| {
        let detail = "how many targets there are, only the recording says";
        Fault::new("/coverage", "unsupported", detail).allowing("no coverage")
    })
}

/// The scenario with its sensors in the plane of the truth, and the truth's targets where the scenario wants them.
///
/// # Errors
/// Recorded targets without a truth in the plane; latitudes without an origin.
pub(super) fn placed(
    scenario: &Scenario,
    recorded: Option<&TruthSet>,
) -> Result<(Scenario, Option<Played>), Vec<Fault>> {
    let mut scenario = scenario.clone();
    if scenario.targets.space() == Space::Volume {
        for sensor in &mut scenario.sensors {
            sensor.in_space.z_m.get_or_insert(0.0);
        }
    }
    let TargetPlan::Recorded(plan) = scenario.targets.clone() else {
        match scenario.origin {
            Some(origin) => place_sensors(&mut scenario, origin),
            None => refuse_latitudes(&scenario)?,
        }
        return Ok((scenario, None));
    };
    let truth = recorded
        .filter(|truth| truth.space() == Space::Plane)
        .ok_or_else(|| {
            let detail = "recorded targets come from the job's truth, in the plane: there is none";
            vec![Fault::new("/targets", "missing", detail).allowing("`truth` beside `input`")]
        })?;
    if let Some(frame) = truth.frame {
        place_sensors(&mut scenario, frame);
    } else {
        refuse_latitudes(&scenario)?;
    }
    let mut played = Played {
        start_s: plan.start_s.unwrap_or_else(|| first_time_s(truth)),
        paths: Vec::with_capacity(truth.targets().len()),
        errors_m: Vec::new(),
    };
    for target in truth
        .targets()
        .iter()
        .filter(|target| !target.points.is_empty())
    {
        let spline = Spline::through(&target.points, plan.max_gap_s);
        played.errors_m.extend(spline.leave_one_out_m());
        played
            .paths
            .push(Path::recorded(target.truth_id.clone(), spline));
    }
    played.errors_m.sort_by(f64::total_cmp);
    Ok((scenario, Some(played)))
}

/// Puts sensors with a latitude and longitude into the plane or the volume of the targets.
fn place_sensors(scenario: &mut Scenario, frame: Frame) {
    let (plane, space) = (Stereographic::from(frame), scenario.targets.space());
    for sensor in &mut scenario.sensors {
        let (Some(lat_deg), Some(lon_deg)) = (sensor.lat_deg, sensor.lon_deg) else {
            continue;
        };
        if space == Space::Volume {
            let place_m = site_of(sensor, Some(frame)).place_m;
            (sensor.x_m, sensor.y_m) = (place_m.x, place_m.y);
            sensor.in_space.z_m = Some(place_m.z);
        } else {
            let place_m = plane.project(lat_deg, lon_deg);
            (sensor.x_m, sensor.y_m) = (place_m.x, place_m.y);
        }
    }
}

/// Where a sensor stands in a volume, and how its axes lie there.
pub(super) fn site_of(sensor: &ScenarioSensor, origin: Option<Frame>) -> Site {
    if let (Some(origin), Some(lat_deg), Some(lon_deg)) = (origin, sensor.lat_deg, sensor.lon_deg) {
        let origin = Geodetic::from(&origin);
        let own = Geodetic {
            lat_deg,
            lon_deg,
            height_m: sensor.in_space.height_m.unwrap_or(0.0),
        };
        return Site {
            place_m: origin.enu_of(&own),
            turn: origin.turn_to(&own),
        };
    }
    let up_m = sensor.in_space.z_m.unwrap_or(0.0);
    Site::level(Place::new(sensor.x_m, sensor.y_m, up_m))
}

/// A latitude needs an origin.
fn refuse_latitudes(scenario: &Scenario) -> Result<(), Vec<Fault>> {
    let mut faults = Vec::new();
    for (index, sensor) in scenario.sensors.iter().enumerate() {
        if sensor.lat_deg.is_some() || sensor.lon_deg.is_some() {
            let detail = "the targets have no origin on the Earth to measure a latitude from";
            let pointer = format!("/sensors/{index}/lat_deg");
            faults.push(Fault::new(pointer, "unsupported", detail).allowing("x_m, y_m"));
        }
    }
    if faults.is_empty() {
        Ok(())
    } else {
        Err(faults)
    }
}

fn first_time_s(truth: &TruthSet) -> f64 {
    let firsts = truth
        .targets()
        .iter()
        .filter_map(|target| target.points.first());
    let first_s = firsts
        .map(|point| point.time_s)
        .fold(f64::INFINITY, f64::min);
    if first_s.is_finite() { first_s } else { 0.0 }
}

impl Played {
    /// Gives what was simulated the origin and the names of the recording, and says how good the splines are.
    pub fn describe(&self, source: &TruthSet, simulated: &mut Simulated) -> Result<(), Vec<Fault>> {
        let truth = &mut simulated.truth;
        (truth.frame, truth.time_base) = (source.frame, source.time_base);
        for target in truth.targets().to_vec() {
            if let Some(known) = source.attributes.get(&target.truth_id) {
                truth.attributes.insert(target.truth_id, known.clone());
            }
        }
        let mut parts = std::mem::take(&mut simulated.recording).into_parts();
        (parts.frame, parts.time_base) = (source.frame, source.time_base);
        simulated.recording = crate::model::scan::Recording::new(parts)?;
        if let Some(most_m) = self.errors_m.get(self.errors_m.len() * 19 / 20) {
            let middle_m = self.errors_m[self.errors_m.len() / 2];
            simulated.warnings.push(format!(
                "recorded targets move on splines: with each point left out in turn, they pass it by {middle_m:.1} m (median) and {most_m:.1} m (95 %)"
            ));
        }
        Ok(())
    }
}
