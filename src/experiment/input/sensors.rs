//! The sensors of a recording, completed: what the request says, else what came with the data, else what can soundly
//! be estimated from the data, said in a warning; what cannot be estimated is a fault.

mod bearings;
mod correlated;
mod in_space;
mod place;
mod range_rates;
mod sight;
mod velocities;

pub use correlated::with_own_noises;
pub use in_space::is_in_volume;
use range_rates::{range_rate_span_mps, reported_rates, uses_range_rates};

use super::extent::{Extent, detections_of, place_of, space_of};
use crate::experiment::job::refuse_any;
use crate::experiment::request::methods::NamedFilter;
use crate::filtering::AnyFilter;
use crate::model::fault::Fault;
use crate::model::relative_bearings::unknown_heading;
use crate::model::scan::{Measurement, Recording};
use crate::model::sensing::{Bearing, MeasurementModel, Platform, Polar, RangeRate};
use crate::model::sensor::{Sensor, SensorSettings};
use crate::model::sight::clutter::LEAST_CLUTTER;
use crate::model::space::Space;
use crate::model::state::Position;
use bearings::{any_locates, moves, range_prior, tells_bearings, unknown_place};
use sight::with_sight;

/// Assumed when nobody says how often a target is detected.
const ASSUMED_P_D: f64 = 0.9;

/// What is known of each sensor of the recording, request over upload over data.
///
/// # Errors
/// A fault for each setting of a sensor that the recording does not have.
pub fn merge_settings(
    recording: &Recording,
    uploaded: &[SensorSettings],
    requested: &[SensorSettings],
) -> Result<Vec<SensorSettings>, Vec<Fault>> {
    let names: Vec<&str> = recording
        .sensors
        .iter()
        .map(|sensor| sensor.sensor_id.as_str())
        .collect();
    let mut faults = Vec::new();
    for (index, SensorSettings { sensor_id, .. }) in requested.iter().enumerate() {
        if !names.contains(&sensor_id.as_str()) {
            let pointer = format!("/sensors/{index}/sensor_id");
            let detail = format!("the recording has no sensor '{sensor_id}'");
            faults.push(Fault::new(pointer, "unknown_value", detail).allowing(names.join(", ")));
        }
    }
    let mut merged = Vec::with_capacity(recording.sensors.len());
    for sensor in &recording.sensors {
        let own = sensor.overridden_by(&settings_of(sensor, uploaded));
        let asked = settings_of(sensor, requested);
        let index = requested
            .iter()
            .position(|other| other.sensor_id == sensor.sensor_id);
        match place::in_plane(own.overridden_by(&asked), &asked, recording.frame) {
            Ok(settings) => {
                faults.extend(unknown_heading(recording, &settings));
                merged.push(settings);
            }
            Err(fault) => faults.push(Fault {
                pointer: format!("/sensors/{}{}", index.unwrap_or_default(), fault.pointer),
                ..*fault
            }),
        }
    }
    refuse_any(faults)?;
    Ok(merged)
}

/// What a list says of a sensor; nothing where it does not name it.
fn settings_of(sensor: &SensorSettings, list: &[SensorSettings]) -> SensorSettings {
    list.iter()
        .find(|other| other.sensor_id == sensor.sensor_id)
        .cloned()
        .unwrap_or_default()
}

/// Sensors that a tracker with the given filter can work with.
///
/// # Errors
/// All faults: noise that nobody knows, reports that the filter cannot use.
pub fn resolve(
    recording: &Recording,
    known: &[SensorSettings],
    filter: &NamedFilter,
    warnings: &mut Vec<String>,
) -> Result<Vec<Sensor>, Vec<Fault>> {
    let mut faults = Vec::new();
    if let Some(fault) = bearings::nothing_starts(recording, known, filter) {
        return Err(vec![fault]);
    }
    let crosses = filter.filter.space() == Space::Plane && bearings::may_cross(recording, known);
    let rates = reported_rates(&mut recording.detections(), false);
    if rates > 0 && !filter.filter.uses_range_rates() {
        warnings.push(format!(
            "range rates are not used: the filter '{}' does not know them",
            filter.name
        ));
    }
    let mut sensors = Vec::with_capacity(known.len());
    for (index, settings) in known.iter().enumerate() {
        let Some(kind) = usable_kind(recording, (index, known), filter, &mut faults) else {
            continue;
        };
        let uses_rates =
            kind == Kind::Polar && uses_range_rates(recording, index, filter, warnings);
        if kind == Kind::Bearing {
            warnings.extend(unused_ranges(recording, index));
        }
        let rates_mps = uses_rates.then(|| range_rate_span_mps(recording, index, settings));
        let reader = NoiseReader {
            settings,
            moves: moves(recording, index),
            inflation: correlated::inflation(recording, index, settings, warnings),
            faults: &mut faults,
        };
        let report = if filter.filter.space() == Space::Volume {
            reader.report_in_space((recording, index), kind, rates_mps, warnings)
        } else {
            reader.report(kind, rates_mps, warnings)
        };
        let report = velocities::with_velocities(report, (recording, index), settings, warnings);
        let starts = report.starts_in(filter.filter.space());
        if kind == Kind::Bearing {
            faults.extend(bearings::unfit_prior(settings));
            faults.extend(bearings::unfit_filter(settings, filter));
        }
        let may_start = starts || (crosses && report.is_bearing());
        faults.extend(bearings::unable_start(
            settings,
            may_start,
            report.is_bearing(),
        ));
        match complete(recording, index, settings, report, warnings) {
            Ok(sensor) => sensors.push(Sensor {
                may_start: settings.may_start.unwrap_or(starts),
                ..sensor
            }),
            Err(found) => faults.extend(found),
        }
    }
    if !filter.filter.space().has_places() {
        faults.extend(two_places(known));
    }
    if faults.is_empty() {
        Ok(sensors)
    } else {
        Err(faults)
    }
}

/// A warning where a sensor's ranges are not used.
fn unused_ranges(recording: &Recording, index: usize) -> Option<String> {
    let mut reports = detections_of(recording, index).map(|one| one.measurement.flat());
    let has_ranges = reports.any(|report| matches!(report, Measurement::RangeBearing { .. }));
    let id = &recording.sensors[index].sensor_id;
    has_ranges.then(|| format!("sensor '{id}': its ranges are not used"))
}

/// The filter that starts tracks at ranges, where a sensor's bearings start any.
pub fn filter_for(sensors: &[Sensor], filter: &AnyFilter) -> AnyFilter {
    let starts = |sensor: &Sensor| sensor.may_start && sensor.report.range_prior().is_some();
    let at_ranges = filter.at_ranges();
    at_ranges
        .filter(|_| sensors.iter().any(starts))
        .unwrap_or(*filter)
}

/// A fault for each density that the request states over a space in which the sensor's reports do not lie.
pub fn misplaced_densities(requested: &[SensorSettings], sensors: &[Sensor]) -> Vec<Fault> {
    let fault = |(index, settings): (usize, &SensorSettings)| {
        let sensor = sensors
            .iter()
            .find(|sensor| sensor.sensor_id == settings.sensor_id)?;
        let (given, wanted) = misplaced_density(settings, space_of(&sensor.report))?;
        let detail = format!(
            "the clutter of sensor '{}' is stated in '{given}'; what is used of its reports needs '{wanted}'",
            sensor.sensor_id
        );
        Some(
            Fault::new(format!("/sensors/{index}/{given}"), "unsupported", detail).allowing(wanted),
        )
    };
    requested.iter().enumerate().filter_map(fault).collect()
}

/// The density that is given and the one that is wanted instead. A sensor that has both is described for either use.
fn misplaced_density(
    settings: &SensorSettings,
    space: Space,
) -> Option<(&'static str, &'static str)> {
    let densities = [
        ("clutter_per_m2", settings.clutter_per_m2),
        ("clutter_per_m3", settings.clutter_per_m3),
        ("clutter_per_deg", settings.clutter_per_deg),
    ];
    let wanted = match space {
        Space::Bearing => "clutter_per_deg",
        Space::Plane => "clutter_per_m2",
        Space::Volume => "clutter_per_m3",
    };
    let given = || densities.iter().filter(|(_, density)| density.is_some());
    if given().any(|(name, _)| *name == wanted) {
        return None;
    }
    given().next().map(|(name, _)| (*name, wanted))
}

/// Bearings from two places are not one track.
fn two_places(known: &[SensorSettings]) -> Option<Fault> {
    let (first, rest) = known.split_first()?;
    let other = rest
        .iter()
        .find(|other| place_of(other) != place_of(first))?;
    let detail = format!(
        "bearings from two places are not one track: sensors '{}' and '{}' stand apart",
        first.sensor_id, other.sensor_id
    );
    Some(
        Fault::new("/input/sensor_ids", "unsupported", detail)
            .allowing("sensors that stand at one place"),
    )
}

/// What of a sensor's reports is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Position,
    Polar,
    Bearing,
}

/// What the sensor reports, if the filter can use it.
fn usable_kind(
    recording: &Recording,
    (index, known): (usize, &[SensorSettings]),
    named: &NamedFilter,
    faults: &mut Vec<Fault>,
) -> Option<Kind> {
    let settings = &known[index];
    let has = |wanted: fn(&Measurement) -> bool| {
        detections_of(recording, index).any(|detection| wanted(&detection.measurement.flat()))
    };
    let positions = has(|measurement| matches!(measurement, Measurement::Position { .. }));
    let ranges = has(|measurement| matches!(measurement, Measurement::RangeBearing { .. }));
    let bearings = has(|measurement| matches!(measurement, Measurement::Bearing { .. }));
    let name = &settings.sensor_id;
    let (filter, filter_name) = (&named.filter, named.name);
    let usable = usable_reports(filter);
    let mut refuse = |what: &str| {
        let others = if recording.sensors.len() > 1 {
            "; 'sensor_ids' of the input can leave it out"
        } else {
            ""
        };
        let detail = format!(
            "sensor '{name}' reports {what}, which the filter '{filter_name}' cannot use{others}"
        );
        faults.push(Fault::new("/filter/method", "unsupported", detail).allowing(usable));
        None
    };
    match (positions, ranges, bearings) {
        (true, ..) if !filter.space().has_places() => refuse("positions"),
        _ if !filter.space().has_places() => Some(Kind::Bearing),
        (false, false, true) if filter.uses_ranges() => {
            faults.extend(unknown_place(recording, index, settings));
            Some(Kind::Bearing)
        }
        (false, false, true) => refuse("bearings without ranges"),
        (_, _, true) => refuse("bearings in some detections and places in others"),
        (true, true, _) => refuse("positions in some detections and ranges in others"),
        (false, true, _) if !filter.uses_ranges() => refuse("ranges and bearings"),
        (false, true, _) => Some(Kind::Polar),
        // A sensor that never reported anything is what its settings say.
        (false, false, _) if settings.sigma_range_m.is_some() && filter.uses_ranges() => {
            Some(Kind::Polar)
        }
        (false, false, _)
            if tells_bearings(settings)
                && filter.uses_ranges()
                && any_locates(recording, known) =>
        {
            faults.extend(unknown_place(recording, index, settings));
            Some(Kind::Bearing)
        }
        _ => Some(Kind::Position),
    }
}

/// What a filter can use, for people.
fn usable_reports(filter: &AnyFilter) -> &'static str {
    if !filter.space().has_places() {
        "bearings (bearing_deg), with or without ranges (range_m)"
    } else if filter.uses_ranges() {
        "positions (x_m, y_m); ranges and bearings (range_m, bearing_deg)"
    } else {
        "positions (x_m, y_m)"
    }
}

/// Takes noises from the settings; those that are missing become faults.
struct NoiseReader<'a> {
    settings: &'a SensorSettings,
    /// Whether its scans say where it is.
    moves: bool,
    /// What noise is multiplied with.
    inflation: f64,
    faults: &'a mut Vec<Fault>,
}

impl NoiseReader<'_> {
    /// What the sensor reports, and range rates too where they reach over an interval of this length.
    fn report(
        mut self,
        kind: Kind,
        span_mps: Option<f64>,
        warnings: &mut Vec<String>,
    ) -> MeasurementModel {
        let settings = self.settings;
        match kind {
            Kind::Position => MeasurementModel::Position {
                sigma_x_m: self.required("sigma_x_m", settings.sigma_x_m, "m"),
                sigma_y_m: self.required("sigma_y_m", settings.sigma_y_m, "m"),
            },
            Kind::Polar => {
                let place_m = if self.moves {
                    place_of(settings)
                } else {
                    place(settings, warnings)
                };
                MeasurementModel::Polar(self.polar(place_m, span_mps))
            }
            Kind::Bearing => MeasurementModel::Bearing(Bearing {
                place_m: place_of(settings),
                sigma_bearing_rad: self.bearing_sigma(),
                platform: Platform::STANDING,
                range_prior: range_prior(settings),
            }),
        }
    }

    fn polar(&mut self, place_m: Position, span_mps: Option<f64>) -> Polar {
        let settings = self.settings;
        Polar {
            place_m,
            sigma_range_m: self.required("sigma_range_m", settings.sigma_range_m, "m"),
            sigma_bearing_rad: self.bearing_sigma(),
            range_rate: span_mps.map(|span_mps| RangeRate {
                sigma_mps: self.required(
                    "sigma_range_rate_mps",
                    settings.sigma_range_rate_mps,
                    "m/s",
                ),
                span_mps,
            }),
            platform: Platform::STANDING,
        }
    }

    fn bearing_sigma(&mut self) -> f64 {
        self.required("sigma_bearing_deg", self.settings.sigma_bearing_deg, "deg")
            .to_radians()
    }

    fn required(&mut self, field: &str, value: Option<f64>, unit: &str) -> f64 {
        if value.is_none() {
            let detail = format!(
                "the noise of sensor '{}' is not known: give '{field}' in 'sensors'",
                self.settings.sensor_id
            );
            self.faults
                .push(Fault::new("/sensors", "missing", detail).allowing(format!("> 0 {unit}")));
        }
        value.unwrap_or(1.0) * self.inflation
    }
}

fn place(settings: &SensorSettings, warnings: &mut Vec<String>) -> Position {
    if settings.x_m.is_none() || settings.y_m.is_none() {
        warnings.push(format!(
            "sensor '{}': its position is not known; missing x_m or y_m are taken to be 0",
            settings.sensor_id
        ));
    }
    place_of(settings)
}

fn complete(
    recording: &Recording,
    index: usize,
    settings: &SensorSettings,
    report: MeasurementModel,
    warnings: &mut Vec<String>,
) -> Result<Sensor, Vec<Fault>> {
    let name = &settings.sensor_id;
    let p_d = settings.p_d.unwrap_or_else(|| {
        warnings.push(format!(
            "sensor '{name}': the detection probability is not known; {ASSUMED_P_D} is assumed"
        ));
        ASSUMED_P_D
    });
    let extent = Extent::measure(recording, index, settings, &report);
    let density = extent.density_of(settings).unwrap_or_else(|| {
        let density = estimated_clutter(recording, index, &extent);
        let unknown = misplaced_density(settings, extent.space).map_or(
            "the clutter density is not known".to_owned(),
            |(given, wanted)| format!("'{given}' is not used, '{wanted}' is not known"),
        );
        warnings.push(format!(
            "sensor '{name}': {unknown}; {density:.3e} per {} is estimated from the data",
            extent.unit()
        ));
        density
    });
    let sensor = Sensor {
        sensor_id: name.clone(),
        p_d,
        clutter_density: extent.inside(density.max(LEAST_CLUTTER)),
        may_start: true,
        report,
        sight: None,
    };
    with_sight(sensor, (recording, index), settings, &extent, warnings)
}

/// Detections a scan over the extent of them all: an upper bound, since targets are among them.
fn estimated_clutter(recording: &Recording, sensor: usize, extent: &Extent) -> f64 {
    let scans = || recording.scans.iter().filter(|scan| scan.sensor == sensor);
    let detections: usize = detections_of(recording, sensor).count();
    if detections < 2 || extent.seen <= 0.0 {
        LEAST_CLUTTER
    } else {
        detections as f64 / scans().count() as f64 / extent.seen
    }
}

#[cfg(test)]
mod tests;
