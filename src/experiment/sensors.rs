//! The sensors of a recording, completed: what the request says, else what came with the data, else what can soundly
//! be estimated from the data, said in a warning; what cannot be estimated is a fault.

use crate::model::fault::Fault;
use crate::model::scan::{Measurement, Recording};
use crate::model::sensor::{Sensor, SensorSettings};

/// Assumed when nobody says how often a target is detected.
const ASSUMED_P_D: f64 = 0.9;
/// No scene is so clean that a false detection is impossible; keeps likelihood ratios finite.
const LEAST_CLUTTER_PER_M2: f64 = 1e-15;

/// What is known of each sensor of the recording, request over upload over data.
///
/// # Errors
/// A fault for each setting of a sensor that the recording does not have.
pub(super) fn known(
    recording: &Recording,
    uploaded: &[SensorSettings],
    requested: &[SensorSettings],
) -> Result<Vec<SensorSettings>, Vec<Fault>> {
    let names: Vec<&str> = recording.sensors.iter().map(|sensor| sensor.sensor_id.as_str()).collect();
    let is_unknown = |(_, settings): &(usize, &SensorSettings)| !names.contains(&settings.sensor_id.as_str());
    let fault = |(index, settings): (usize, &SensorSettings)| {
        let detail = format!("the recording has no sensor '{}'", settings.sensor_id);
        Fault::new(format!("/sensors/{index}/sensor_id"), "unknown_value", detail).allowing(names.join(", "))
    };
    let mut faults: Vec<Fault> = requested.iter().enumerate().filter(is_unknown).map(fault).collect();
    for (index, settings) in requested.iter().enumerate() {
        if requested[..index].iter().any(|earlier| earlier.sensor_id == settings.sensor_id) {
            let detail = format!("sensor '{}' is set twice", settings.sensor_id);
            faults.push(Fault::new(format!("/sensors/{index}/sensor_id"), "duplicate", detail));
        }
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let complete = |sensor: &SensorSettings| {
        let of_this = |list: &[SensorSettings]| list.iter().find(|other| other.sensor_id == sensor.sensor_id).cloned().unwrap_or_default();
        sensor.overridden_by(&of_this(uploaded)).overridden_by(&of_this(requested))
    };
    Ok(recording.sensors.iter().map(complete).collect())
}

/// Sensors that a tracker of position reports can work with.
///
/// # Errors
/// All faults: noise that nobody knows, reports that are not positions.
pub(super) fn resolve(recording: &Recording, known: &[SensorSettings], warnings: &mut Vec<String>) -> Result<Vec<Sensor>, Vec<Fault>> {
    let mut faults = Vec::new();
    let sensors = known.iter().enumerate().map(|(index, settings)| complete(recording, index, settings, warnings, &mut faults)).collect();
    check_reports(recording, &mut faults);
    if faults.is_empty() { Ok(sensors) } else { Err(faults) }
}

fn complete(recording: &Recording, index: usize, settings: &SensorSettings, warnings: &mut Vec<String>, faults: &mut Vec<Fault>) -> Sensor {
    let name = &settings.sensor_id;
    for (field, value) in [("sigma_x_m", settings.sigma_x_m), ("sigma_y_m", settings.sigma_y_m)] {
        if value.is_none() {
            let detail = format!("the noise of sensor '{name}' is not known: give '{field}' in 'sensors'");
            faults.push(Fault::new("/sensors", "missing", detail).allowing("> 0 m"));
        }
    }
    let p_d = settings.p_d.unwrap_or_else(|| {
        warnings.push(format!("sensor '{name}': the detection probability is not known; {ASSUMED_P_D} is assumed"));
        ASSUMED_P_D
    });
    let clutter_per_m2 = settings.clutter_per_m2.unwrap_or_else(|| {
        let density = estimated_clutter(recording, index);
        warnings.push(format!("sensor '{name}': the clutter density is not known; {density:.3e} per m² is estimated from the data"));
        density
    });
    Sensor {
        sensor_id: name.clone(),
        p_d,
        clutter_per_m2: clutter_per_m2.max(LEAST_CLUTTER_PER_M2),
        sigma_x_m: settings.sigma_x_m.unwrap_or(1.0),
        sigma_y_m: settings.sigma_y_m.unwrap_or(1.0),
    }
}

/// Detections a scan over the area of the rectangle that holds them all: an upper bound, since targets are among them.
fn estimated_clutter(recording: &Recording, sensor: usize) -> f64 {
    let scans = || recording.scans.iter().filter(|scan| scan.sensor == sensor);
    let detections: usize = scans().map(|scan| scan.count).sum();
    let area_m2 = extent_m2(recording, sensor);
    if detections < 2 || area_m2 <= 0.0 { LEAST_CLUTTER_PER_M2 } else { detections as f64 / scans().count() as f64 / area_m2 }
}

/// Area of the rectangle that holds all positions that the sensor reported; 0 when there are none.
pub(super) fn extent_m2(recording: &Recording, sensor: usize) -> f64 {
    let scans = recording.scans.iter().filter(|scan| scan.sensor == sensor);
    let positions: Vec<_> =
        scans.flat_map(|scan| recording.detections_of(scan)).filter_map(|detection| detection.measurement.position()).collect();
    let extent_m = |axis: usize| {
        let values = || positions.iter().map(|position| position[axis]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    };
    if positions.is_empty() { 0.0 } else { extent_m(0) * extent_m(1) }
}

/// One fault a sensor whose reports are not positions.
fn check_reports(recording: &Recording, faults: &mut Vec<Fault>) {
    for (index, sensor) in recording.sensors.iter().enumerate() {
        let mut reports = recording.scans.iter().filter(|scan| scan.sensor == index).flat_map(|scan| recording.detections_of(scan));
        if reports.any(|detection| !matches!(detection.measurement, Measurement::Position { .. })) {
            let detail = format!("sensor '{}' reports ranges or bearings, which the filter 'kalman' cannot use", sensor.sensor_id);
            faults.push(Fault::new("/filter/method", "unsupported", detail).allowing("position reports (x_m, y_m)"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scan::{Detection, RecordingParts, Scan};

    fn recording(measurements: &[Measurement]) -> Recording {
        let detections: Vec<Detection> = measurements.iter().map(|&measurement| Detection { measurement, origin: None }).collect();
        Recording::new(RecordingParts {
            sensors: vec![SensorSettings::named("radar")],
            scans: vec![Scan { number: 1, time_s: 0.0, sensor: 0, first: 0, count: detections.len() }],
            detection_ids: (0..detections.len()).map(|index| index.to_string()).collect(),
            detections,
            ..Default::default()
        })
        .unwrap()
    }

    fn at(x_m: f64, y_m: f64) -> Measurement {
        Measurement::Position { x_m, y_m }
    }

    #[test]
    fn the_request_wins_over_the_upload_and_the_rest_is_estimated_with_a_warning() {
        let recording = recording(&[at(0.0, 0.0), at(10.0, 20.0), at(5.0, 5.0), at(1.0, 1.0)]);
        let uploaded = [SensorSettings { sigma_x_m: Some(1.0), sigma_y_m: Some(2.0), ..SensorSettings::named("radar") }];
        let requested = [SensorSettings { sigma_x_m: Some(3.0), ..SensorSettings::named("radar") }];
        let mut warnings = Vec::new();
        let known = known(&recording, &uploaded, &requested).unwrap();
        let sensors = resolve(&recording, &known, &mut warnings).unwrap();
        let expected = Sensor { sensor_id: "radar".into(), p_d: 0.9, clutter_per_m2: 0.02, sigma_x_m: 3.0, sigma_y_m: 2.0 };
        assert_eq!(sensors, [expected]);
        assert_eq!(warnings.len(), 2);
    }

    #[test]
    fn unknown_noise_unknown_sensors_and_unusable_reports_are_faults() {
        let recording = recording(&[Measurement::Bearing { bearing_rad: 1.0 }]);
        let faults = known(&recording, &[], &[SensorSettings::named("sonar")]).unwrap_err();
        assert_eq!((faults[0].pointer.as_str(), faults[0].allowed.as_deref()), ("/sensors/0/sensor_id", Some("radar")));
        let known = known(&recording, &[], &[]).unwrap();
        let faults = resolve(&recording, &known, &mut Vec::new()).unwrap_err();
        let seen: Vec<_> = faults.iter().map(|fault| (fault.pointer.as_str(), fault.code.as_str())).collect();
        assert_eq!(seen, [("/sensors", "missing"), ("/sensors", "missing"), ("/filter/method", "unsupported")]);
    }
}
