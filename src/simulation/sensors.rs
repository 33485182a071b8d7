//! The sensors of a scenario: whether what is told of one fits together and fits the targets, and what a tracker may know of it.

use crate::model::fault::Fault;
use crate::model::scenario::{
    ReportNoise, Scenario, ScenarioSensor, Segment, SensorCourse, TargetPlan,
};
use crate::model::sensor::SensorSettings;
use crate::model::space::Space;

/// What a single sensor may make.
const MAX_SCANS: u64 = 100_000;
const LIMITS: &str = "both bearings or neither; range_from_m below range_to_m";

/// Noises that do not say what the sensor reports, places where targets have none, no field of view where they have, and
/// clutter stated twice or of the wrong kind.
pub(super) fn faults(index: usize, sensor: &ScenarioSensor, scenario: &Scenario) -> Vec<Fault> {
    let targets = &scenario.targets;
    let mut faults = Vec::new();
    match (sensor.noise(), targets) {
        // The noise of what is found in a record need not be known.
        (None, _) if scenario.record.is_some() && !has_noise(sensor) => {}
        (None, _) => faults.push(unclear_noise(index, sensor)),
        (
            Some(ReportNoise::Position { .. } | ReportNoise::RangeBearing { .. }),
            TargetPlan::Bearings(_),
        ) => {
            let detail = format!(
                "targets of bearings have no places, which sensor '{}' reports",
                sensor.sensor_id
            );
            faults.push(
                Fault::new(format!("/sensors/{index}"), "conflict", detail)
                    .allowing("sigma_bearing_deg alone"),
            );
        }
        _ => {}
    }
    if sensor.max_range_m.is_none() && !matches!(targets, TargetPlan::Bearings(_)) {
        let detail = "'max_range_m' is required where targets have places";
        faults.push(
            Fault::new(format!("/sensors/{index}/max_range_m"), "missing", detail)
                .allowing("> 0 m"),
        );
    }
    let climbs = |course: &SensorCourse| course.segments.iter().any(Segment::climbs);
    if sensor.course.as_ref().is_some_and(climbs) {
        let detail = "a sensor moves in the plane";
        faults.push(
            Fault::new(
                format!("/sensors/{index}/course/segments"),
                "conflict",
                detail,
            )
            .allowing("straight, turn, accelerate"),
        );
    }
    if sensor.course.is_some() && targets.space() != Space::Plane {
        let detail = "a sensor moves where targets are in the plane";
        faults.push(
            Fault::new(format!("/sensors/{index}/course"), "conflict", detail)
                .allowing("no course"),
        );
    }
    if sensor.snr_db.is_some() && scenario.record.is_some() {
        let detail = "a detector tells how strong what it finds in a record is";
        faults.push(
            Fault::new(format!("/sensors/{index}/snr_db"), "conflict", detail)
                .allowing("without 'record'"),
        );
    }
    if sensor.tells_heights() && targets.space() != Space::Volume {
        let detail = format!(
            "targets have no heights, which sensor '{}' reports",
            sensor.sensor_id
        );
        faults.push(
            Fault::new(format!("/sensors/{index}"), "conflict", detail)
                .allowing("listed targets with z_m; without sigma_z_m, sigma_elevation_deg"),
        );
    }
    faults.extend(clutter_faults(index, sensor));
    faults.extend(timing_faults(index, sensor, scenario));
    faults.extend(sight_faults(index, sensor, scenario));
    faults
}

/// Scans that nobody makes, too many, or those of a record.
fn timing_faults(index: usize, sensor: &ScenarioSensor, scenario: &Scenario) -> Vec<Fault> {
    let timing = &sensor.timing;
    let named = [
        ("scan_period_s", timing.scan_period_s),
        ("first_scan_s", timing.first_scan_s),
        ("latency_s", timing.latency_s),
    ];
    let told = named.iter().filter(|(_, value)| value.is_some());
    let mut faults = Vec::new();
    for (name, _) in told.filter(|_| scenario.record.is_some()) {
        let detail = "a record is made without scans of its own";
        faults.push(
            Fault::new(format!("/sensors/{index}/{name}"), "conflict", detail)
                .allowing("without 'record'"),
        );
    }
    let scans = sensor.scan_count(scenario);
    // Without times of its own it makes the scenario's scans, which are checked there.
    let has_own = timing.scan_period_s.is_some() || timing.first_scan_s.is_some();
    if has_own && (scans == 0 || scans > MAX_SCANS) {
        let detail = format!("sensor '{}' would make {scans} scans", sensor.sensor_id);
        faults.push(
            Fault::new(format!("/sensors/{index}"), "out_of_range", detail).allowing(format!(
                "1 to {MAX_SCANS} scans within scans · scan_period_s of the scenario"
            )),
        );
    }
    faults
}

/// Parts that are none, clutter of another kind than the sensor reports, velocities beside what is no place.
fn sight_faults(index: usize, sensor: &ScenarioSensor, scenario: &Scenario) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut refuse = |field: &str, code: &str, detail: String, allowed: &str| {
        faults
            .push(Fault::new(format!("/sensors/{index}/{field}"), code, detail).allowing(allowed));
    };
    let (name, sight) = (&sensor.sensor_id, &sensor.sight);
    if sight.field_of_view.is_some_and(|view| !view.is_sound()) {
        let detail = format!("the field of view of sensor '{name}' is no part of a plane");
        refuse("field_of_view", "conflict", detail, LIMITS);
    }
    let in_space = scenario.targets.space() == Space::Volume;
    for (number, sector) in sight.sectors.iter().flatten().enumerate() {
        let field = format!("sectors/{number}");
        if !sector.is_sound() {
            let detail = format!("sector {number} of sensor '{name}' is no part of a plane");
            refuse(&field, "conflict", detail, LIMITS);
        }
        let (wrong, wanted) = match reports_bearings(sensor) {
            true => (sector.clutter_per_m2, "clutter_per_deg"),
            false => (sector.clutter_per_deg, "clutter_per_m2"),
        };
        let is_of_space = in_space && sector.clutter_per_m2.or(sector.clutter_per_deg).is_some();
        if wrong.is_some() || is_of_space {
            let detail = format!(
                "the clutter of sector {number} is not one of what sensor '{name}' reports"
            );
            let allowed = if in_space {
                "p_d where targets are in space"
            } else {
                wanted
            };
            refuse(&field, "unsupported", detail, allowed);
        }
    }
    let tells_places = matches!(sensor.noise(), Some(ReportNoise::Position { .. }));
    if sight.sigma_speed_mps.is_some() && !tells_places {
        let detail =
            format!("sensor '{name}' does not report positions, with which velocities come");
        refuse(
            "sigma_speed_mps",
            "conflict",
            detail,
            "with sigma_x_m, sigma_y_m",
        );
    }
    if sight.sigma_course_deg.is_some() && sight.sigma_speed_mps.is_none() {
        let detail = "the noise of a course needs that of the speed: 'sigma_speed_mps' is missing";
        refuse(
            "sigma_course_deg",
            "missing",
            detail.to_owned(),
            "with sigma_speed_mps",
        );
    }
    let has_sight = sight.field_of_view.is_some() || sight.sectors.is_some();
    if has_sight && scenario.record.is_some() {
        let detail = "a record shows all directions".to_owned();
        refuse("field_of_view", "conflict", detail, "without 'record'");
    }
    faults
}

fn clutter_faults(index: usize, sensor: &ScenarioSensor) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut refuse = |field: &str, code: &str, detail: String, allowed: &str| {
        faults
            .push(Fault::new(format!("/sensors/{index}/{field}"), code, detail).allowing(allowed));
    };
    let name = &sensor.sensor_id;
    if sensor.clutter_per_deg.is_some() && sensor.clutter_per_scan.is_some() {
        refuse(
            "clutter_per_deg",
            "conflict",
            format!("the clutter of sensor '{name}' is stated twice"),
            "clutter_per_scan or clutter_per_deg",
        );
    }
    if sensor.clutter_per_deg.is_some() && sensor.noise().is_some() && !reports_bearings(sensor) {
        let detail = format!("sensor '{name}' does not report bearings alone");
        refuse("clutter_per_deg", "unsupported", detail, "clutter_per_scan");
    }
    if sensor.clutter_within_deg.is_some() && sensor.clutter_per_deg.is_none() {
        let detail =
            "clutter near targets needs its density: 'clutter_per_deg' is missing".to_owned();
        refuse(
            "clutter_within_deg",
            "missing",
            detail,
            "with clutter_per_deg",
        );
    }
    faults
}

fn has_noise(sensor: &ScenarioSensor) -> bool {
    let noises = [
        sensor.sigma_x_m,
        sensor.sigma_y_m,
        sensor.sigma_range_m,
        sensor.sigma_bearing_deg,
        sensor.sigma_range_rate_mps,
        sensor.in_space.sigma_z_m,
        sensor.in_space.sigma_elevation_deg,
    ];
    noises.iter().any(Option::is_some)
}

fn reports_bearings(sensor: &ScenarioSensor) -> bool {
    matches!(sensor.noise(), Some(ReportNoise::Bearing { .. }))
}

/// The noises of a sensor must be those of one kind of report, all of them.
fn unclear_noise(index: usize, sensor: &ScenarioSensor) -> Fault {
    let given = [
        ("sigma_x_m", sensor.sigma_x_m),
        ("sigma_y_m", sensor.sigma_y_m),
        ("sigma_range_m", sensor.sigma_range_m),
        ("sigma_bearing_deg", sensor.sigma_bearing_deg),
        ("sigma_range_rate_mps", sensor.sigma_range_rate_mps),
        ("sigma_z_m", sensor.in_space.sigma_z_m),
        ("sigma_elevation_deg", sensor.in_space.sigma_elevation_deg),
    ];
    let names: Vec<&str> = given
        .iter()
        .filter(|(_, value)| value.is_some())
        .map(|(name, _)| *name)
        .collect();
    let (code, found) = if names.len() < 2 {
        ("missing", "do")
    } else {
        ("conflict", "together do")
    };
    let detail = format!(
        "the noises of sensor '{}' ({}) {found} not say what it reports",
        sensor.sensor_id,
        names.join(", ")
    );
    Fault::new(format!("/sensors/{index}"), code, detail)
        .allowing("sigma_x_m, sigma_y_m; or sigma_range_m, sigma_bearing_deg[, sigma_range_rate_mps]; or sigma_bearing_deg alone")
}

/// Whether it was placed in space by its latitude and longitude.
fn is_of_volume(sensor: &ScenarioSensor) -> bool {
    sensor.lat_deg.is_some() && sensor.in_space.z_m.is_some()
}

/// What a recording says of a sensor. Clutter is stated over what it reports: an area, or all directions.
pub fn settings(sensor: &ScenarioSensor) -> SensorSettings {
    let reports_bearings = reports_bearings(sensor);
    let sight = &sensor.sight;
    // Parts of the ground take clutter per square metre.
    let is_cut = sight.field_of_view.is_some() || sight.sectors.is_some();
    let width_deg = sensor.view().arc_rad().1.to_degrees();
    SensorSettings {
        sensor_id: sensor.sensor_id.clone(),
        x_m: Some(sensor.x_m).filter(|_| sensor.course.is_none()),
        y_m: Some(sensor.y_m).filter(|_| sensor.course.is_none()),
        max_range_m: sensor.max_range_m,
        p_d: Some(sensor.p_d),
        clutter_per_m2: sensor
            .clutter_per_m2()
            .filter(|_| !reports_bearings && (!sensor.tells_heights() || is_cut)),
        clutter_per_m3: sensor
            .clutter_per_m3()
            .filter(|_| !reports_bearings && sensor.tells_heights() && !is_cut),
        clutter_per_deg: reports_bearings.then(|| {
            sensor
                .clutter_per_deg
                .unwrap_or_else(|| sensor.mean_clutter() / width_deg)
        }),
        sigma_x_m: sensor.sigma_x_m,
        sigma_y_m: sensor.sigma_y_m,
        sigma_range_m: sensor.sigma_range_m,
        sigma_bearing_deg: sensor.sigma_bearing_deg,
        sigma_range_rate_mps: sensor.sigma_range_rate_mps,
        sigma_z_m: sensor.in_space.sigma_z_m,
        sigma_elevation_deg: sensor.in_space.sigma_elevation_deg,
        sigma_speed_mps: sight.sigma_speed_mps,
        sigma_course_deg: sight.sigma_course_deg,
        field_of_view: sight.field_of_view,
        sectors: sight.sectors.clone(),
        z_m: sensor.in_space.z_m,
        height_m: sensor.in_space.height_m,
        lat_deg: sensor.lat_deg.filter(|_| is_of_volume(sensor)),
        lon_deg: sensor.lon_deg.filter(|_| is_of_volume(sensor)),
        ..SensorSettings::default()
    }
}
