//! The settings of a session, checked: sensors and tracker are resolved as a job resolves them, on one sample of what each sensor
//! reports. What a job would take from its data is refused, so that a job on the recorded session resolves the same.

use super::reports::Reports;
use super::spec::{Rules, SESSION, Spec};
use crate::association::Needs;
use crate::experiment::associate::check::check_tracking;
use crate::experiment::associate::settle;
use crate::experiment::associate::track::{needs_of, nothing_starts, unbounded_gate};
use crate::experiment::input::extent::space_of;
use crate::experiment::input::sensors;
use crate::experiment::request::draft::{Draft, parse};
use crate::experiment::request::methods::{NamedFilter, TrackingSpec};
use crate::experiment::request::paths::put_field;
use crate::math::rng::Seed;
use crate::model::fault::Fault;
use crate::model::own::whole;
use crate::model::pose::{Attitude, Pose};
use crate::model::relative_bearings::are_relative;
use crate::model::scan::{Detection, Recording, RecordingParts, Scan};
use crate::model::sensor::{Sensor, SensorSettings};
use crate::model::sight::clutter::ClutterSettings;
use crate::model::space::{Frame, Space};
use crate::tracking::{Initiation, Tracker, TrackerParts};
use serde_json::{Value, json};

/// What a session is made of.
pub struct Scene {
    rules: Rules,
    seed: Seed,
    frame: Option<Frame>,
    tracking: TrackingSpec,
    filter: NamedFilter,
    /// As they are used.
    sensors: Vec<Sensor>,
    reports: Vec<Reports>,
    poses: Vec<PoseRule>,
    /// What is known of them, with their places in the plane.
    known: Vec<SensorSettings>,
    sensor_ids: Vec<String>,
    /// Of a recording of this session, in which bearings are counted from north.
    pub recorded_sensors: Vec<SensorSettings>,
    /// Of the associator.
    needs: Needs,
    /// The request with its defaults and the filter that was chosen.
    pub spec: Value,
    /// What a user should know.
    pub warnings: Vec<String>,
}

/// Whether scans of a sensor say where it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct PoseRule {
    /// Its bearings are counted from the bow.
    is_relative: bool,
    is_needed: bool,
    is_refused: bool,
}

impl PoseRule {
    /// A direction counts only from a known place, which does not change half-way.
    fn of(settings: &SensorSettings) -> Self {
        let is_direction = Reports::of(settings).is_some_and(Reports::is_direction);
        let is_placed = settings.x_m.is_some() || settings.lat_deg.is_some();
        let is_relative = are_relative(settings);
        PoseRule {
            is_relative,
            is_needed: is_relative || (is_direction && !is_placed),
            is_refused: is_direction && is_placed && !is_relative,
        }
    }
}

impl Scene {
    /// Of a request, also of one that was planned before.
    ///
    /// # Errors
    /// All faults of the request.
    pub fn plan(body: &Value) -> Result<Scene, Vec<Fault>> {
        let mut draft = Draft::new(body, &SESSION)?;
        check_tracking(&mut draft, false);
        if draft.text_at("/tracker/initiation/method") == Some("truth") {
            let detail = "a live feed has no truth at which tracks could begin";
            let fault = Fault::new("/tracker/initiation/method", "unsupported", detail);
            draft.add([fault.allowing("one_point, two_point, multi_scan")]);
        }
        if draft.at("/tracker/smoothing").is_some() {
            let detail = "a session tells what is believed at the time";
            let fault = Fault::new("/tracker/smoothing", "unsupported", detail);
            draft.add([fault.allowing("no value")]);
        }
        let listed: Vec<SensorSettings> = draft.read("/sensors").unwrap_or_default();
        draft.add(sensor_faults(&listed));
        let mut spec = draft.into_spec()?;
        let typed: Spec = parse(&spec);
        let scene = Scene::resolve(typed, &mut spec)?;
        Ok(Scene { spec, ..scene })
    }

    fn resolve(typed: Spec, spec: &mut Value) -> Result<Scene, Vec<Fault>> {
        let sample = sample_of(&typed.sensors, typed.origin)?;
        let settled = settle(&typed.tracking, &sample);
        if let Some(chosen) = settled.chosen {
            put_field(spec, "filter", chosen);
        }
        let filter = settled.filter;
        let mut warnings = Vec::new();
        let known = sensors::merge_settings(&sample, &[], &typed.sensors)?;
        let resolved = sensors::resolve(&sample, &known, &filter, &mut warnings)?;
        let mut faults = sensors::misplaced_densities(&typed.sensors, &resolved);
        if filter.filter.space() == Space::Volume {
            faults.extend(flat_sensors(&known));
        }
        faults.extend(unstated_densities(&known, &resolved));
        faults.extend(unbounded_gate(&typed.tracking.tracker.lifecycle, &resolved));
        faults.extend(nothing_starts(&typed.tracking.tracker.lifecycle, &resolved));
        faults.extend(unstated_speed(&typed.tracking, &filter));
        let needs = needs_of(&typed.tracking.associator);
        if needs.is_by_origin() {
            let detail = "nobody knows which target a live detection comes from";
            faults.push(Fault::new("/associator/method", "unsupported", detail));
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        Ok(Scene {
            rules: typed.rules,
            seed: Seed {
                seed: typed.seed,
                run: 0,
            },
            frame: typed.origin,
            tracking: typed.tracking,
            filter,
            sensors: resolved,
            known,
            reports: typed.sensors.iter().filter_map(Reports::of).collect(),
            poses: typed.sensors.iter().map(PoseRule::of).collect(),
            sensor_ids: typed
                .sensors
                .iter()
                .map(|one| one.sensor_id.clone())
                .collect(),
            recorded_sensors: typed.sensors.into_iter().map(recorded).collect(),
            needs,
            spec: Value::Null,
            warnings,
        })
    }

    /// A tracker that has seen nothing yet.
    pub fn new_tracker(&self) -> Box<dyn Tracker> {
        let tracker = &self.tracking.tracker;
        (tracker.build)(TrackerParts {
            filter: sensors::filter_for(&self.sensors, &self.filter.filter),
            associator: self.tracking.associator.build(self.seed),
            lifecycle: tracker.lifecycle,
            undetected: tracker.undetected.clone(),
            sensors: self.sensors.clone(),
            given: Vec::new(),
        })
    }

    /// The body of the job that tracks a recording of this session.
    pub fn job_on(&self, dataset_id: &str) -> Value {
        let mut body = json!({"input": {"source": "dataset", "dataset_id": dataset_id}});
        for name in ["seed", "associator", "filter", "tracker"] {
            body[name] = self.spec[name].clone();
        }
        put_field(&mut body, "sensors", json!(self.recorded_sensors));
        body
    }

    pub fn rules(&self) -> &Rules {
        &self.rules
    }

    pub fn frame(&self) -> Option<Frame> {
        self.frame
    }

    pub fn space(&self) -> Space {
        self.filter.filter.space()
    }

    pub fn known_sensors(&self) -> &[SensorSettings] {
        &self.known
    }

    pub fn sensor_ids(&self) -> &[String] {
        &self.sensor_ids
    }

    pub fn sensor_index(&self, sensor_id: &str) -> Option<usize> {
        self.sensor_ids.iter().position(|id| id == sensor_id)
    }

    pub fn reports(&self, sensor: usize) -> Reports {
        self.reports[sensor]
    }

    /// Whether its bearings are counted from the bow.
    pub fn is_relative(&self, sensor: usize) -> bool {
        self.poses[sensor].is_relative
    }

    /// Whether every scan of a sensor has to say where it is.
    pub fn needs_pose(&self, sensor: usize) -> bool {
        self.poses[sensor].is_needed
    }

    /// Whether it stands where the session says.
    pub fn refuses_pose(&self, sensor: usize) -> bool {
        self.poses[sensor].is_refused
    }

    pub fn max_detections(&self) -> usize {
        self.rules.max_detections
    }

    pub fn needs_amplitudes(&self) -> bool {
        self.needs == Needs::Amplitudes
    }
}

fn recorded(settings: SensorSettings) -> SensorSettings {
    SensorSettings {
        bearings: None,
        ..settings
    }
}

/// One scan of one detection for each sensor.
fn sample_of(listed: &[SensorSettings], frame: Option<Frame>) -> Result<Recording, Vec<Fault>> {
    let mut parts = RecordingParts {
        frame,
        ..Default::default()
    };
    for (index, settings) in listed.iter().enumerate() {
        let Some(reports) = Reports::of(settings) else {
            continue;
        };
        let (measurement, own) = reports.sample();
        let turned = Pose {
            attitude: Some(Attitude::default()),
            ..Pose::default()
        };
        parts.scans.push(Scan {
            number: index as u32 + 1,
            time_s: 0.0,
            sensor: index,
            pose: PoseRule::of(settings).is_needed.then_some(turned),
            detections: vec![Detection {
                measurement,
                origin: None,
                amplitude: Some(1.0),
            }],
            own: whole(vec![own]),
        });
        parts.detection_ids.push("1".to_owned());
        parts
            .sensors
            .push(SensorSettings::named(&settings.sensor_id));
    }
    Recording::new(parts)
}

/// What the sensors do not say, and what a session cannot do for them.
fn sensor_faults(listed: &[SensorSettings]) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (index, settings) in listed.iter().enumerate() {
        let place = format!("/sensors/{index}");
        if listed[..index]
            .iter()
            .any(|one| one.sensor_id == settings.sensor_id)
        {
            let detail = format!("sensor '{}' is listed twice", settings.sensor_id);
            faults.push(Fault::new(
                format!("{place}/sensor_id"),
                "duplicate",
                detail,
            ));
        }
        if Reports::of(settings).is_none() {
            let detail = "what the sensor reports does not follow from its noises";
            let fault = Fault::new(&place, "missing", detail);
            faults.push(fault.allowing("sigma_x_m and sigma_y_m, also with sigma_speed_mps; sigma_range_m and sigma_bearing_deg, also with sigma_range_rate_mps; or sigma_bearing_deg"));
        }
        if settings.p_d.is_none() {
            let detail =
                "the probability of detection is estimated from data elsewhere; a session is told";
            faults.push(Fault::new(format!("{place}/p_d"), "missing", detail).allowing("(0, 1]"));
        }
        faults.extend(unstated_spans(settings, &place));
        faults.extend(unsupported(settings, &place));
    }
    faults
}

/// A fault where the span of what a sensor reports besides would be that of the data.
fn unstated_spans(settings: &SensorSettings, place: &str) -> Vec<Fault> {
    let reported = [
        (
            "sigma_range_rate_mps",
            settings.sigma_range_rate_mps,
            "range_rate_span_mps",
            settings.range_rate_span_mps,
        ),
        (
            "sigma_speed_mps",
            settings.sigma_speed_mps,
            "velocity_span_mps",
            settings.velocity_span_mps,
        ),
    ];
    let mut faults = Vec::new();
    for (sigma_name, sigma_mps, span_name, span_mps) in reported {
        if sigma_mps.is_some() == span_mps.is_some() {
            continue;
        }
        let missing = if sigma_mps.is_some() {
            span_name
        } else {
            sigma_name
        };
        let detail = format!("{sigma_name} and {span_name} come together in a session");
        faults
            .push(Fault::new(format!("{place}/{missing}"), "missing", detail).allowing("> 0 m/s"));
    }
    faults
}

/// What needs a whole recording, or what detections of a session do not tell.
fn unsupported(settings: &SensorSettings, place: &str) -> Vec<Fault> {
    let learns = matches!(
        settings.clutter,
        Some(ClutterSettings::Estimated | ClutterSettings::Map { .. })
    );
    let given = [
        ("clutter", learns),
        ("assumed_altitude_m", settings.assumed_altitude_m.is_some()),
        (
            "error_correlation_s",
            settings.error_correlation_s.is_some(),
        ),
        ("merge_within_m", settings.merge_within_m.is_some()),
    ];
    let fault = |(name, _)| {
        let detail = format!("a session does not take '{name}'");
        Fault::new(format!("{place}/{name}"), "unsupported", detail).allowing("no value")
    };
    given.into_iter().filter(|(_, is)| *is).map(fault).collect()
}

/// A fault for each sensor whose density of clutter would be estimated.
fn unstated_densities(known: &[SensorSettings], resolved: &[Sensor]) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (index, (settings, sensor)) in known.iter().zip(resolved).enumerate() {
        let (name, density) = match space_of(&sensor.report) {
            Space::Bearing => ("clutter_per_deg", settings.clutter_per_deg),
            Space::Plane => ("clutter_per_m2", settings.clutter_per_m2),
            Space::Volume => ("clutter_per_m3", settings.clutter_per_m3),
        };
        if density.is_none() {
            let detail =
                "the density of clutter is estimated from data elsewhere; a session is told";
            let pointer = format!("/sensors/{index}/{name}");
            faults.push(Fault::new(pointer, "missing", detail).allowing("> 0"));
        }
    }
    faults
}

/// A fault for each sensor that cannot say where in space a target is, or whose clutter is not stated there.
fn flat_sensors(known: &[SensorSettings]) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (index, settings) in known.iter().enumerate() {
        let place = format!("/sensors/{index}");
        if !Reports::of(settings).is_some_and(Reports::tells_place_in_space) {
            let detail = "in space every sensor of a session reports places there";
            let allowed = "sigma_x_m, sigma_y_m, sigma_z_m; sigma_range_m, sigma_bearing_deg, sigma_elevation_deg; or tracker.space plane";
            faults.push(Fault::new(&place, "unsupported", detail).allowing(allowed));
        }
        if settings.clutter_per_m2.is_some() {
            let detail = "in space clutter is stated per m³";
            let pointer = format!("{place}/clutter_per_m2");
            faults.push(Fault::new(pointer, "unsupported", detail).allowing("clutter_per_m3"));
        }
    }
    faults
}

/// A fault where the speed of new tracks would be taken from the data.
fn unstated_speed(tracking: &TrackingSpec, filter: &NamedFilter) -> Option<Fault> {
    if !tracking.tracker.leaves_speed_open || !filter.filter.space().has_places() {
        return None;
    }
    let pointer = match tracking.tracker.lifecycle.initiation {
        Initiation::TwoPoint { .. } => "/tracker/initiation/max_speed_mps",
        _ => "/tracker/initial_speed_sigma_mps",
    };
    let detail =
        "the speed that new tracks allow for is estimated from data elsewhere; a session is told";
    Some(Fault::new(pointer, "missing", detail).allowing("> 0 m/s"))
}
