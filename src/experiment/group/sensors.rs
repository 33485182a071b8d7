//! Sensors whose reports can be put together: those that tell where a target is, with known noise.

use crate::experiment::job::refuse_any;
use crate::model::fault::Fault;
use crate::model::scan::{Measurement, Recording};
use crate::model::sensing::{MeasurementModel, Platform, Polar, RangeRate};
use crate::model::sensor::{Sensor, SensorSettings};
use crate::model::state::Position;

/// Sensors that report positions, or ranges and bearings, with known noise.
///
/// # Errors
/// Every fault of the input that keeps it from being grouped.
pub fn usable_sensors(
    recording: &Recording,
    known: &[SensorSettings],
) -> Result<Vec<Sensor>, Vec<Fault>> {
    let mut faults = Vec::new();
    if known.len() < 2 {
        let detail = format!(
            "the input has {} sensor, whose reports have nothing to be put together with",
            known.len()
        );
        faults.push(Fault::new("/input", "unsupported", detail).allowing("two sensors or more"));
    }
    let mut sensors = Vec::with_capacity(known.len());
    for (index, settings) in known.iter().enumerate() {
        let scans = recording.scans.iter().filter(|scan| scan.sensor == index);
        let reports: Vec<&Measurement> = scans
            .flat_map(|scan| &scan.detections)
            .map(|detection| &detection.measurement)
            .collect();
        match report_of(settings, &reports) {
            Ok(report) => sensors.push(Sensor {
                sensor_id: settings.sensor_id.clone(),
                p_d: settings.p_d.unwrap_or(1.0),
                clutter_density: 0.0,
                may_start: true,
                report,
                sight: None,
            }),
            Err(found) => faults.extend(found),
        }
    }
    refuse_any(faults)?;
    Ok(sensors)
}

fn report_of(
    settings: &SensorSettings,
    reports: &[&Measurement],
) -> Result<MeasurementModel, Vec<Fault>> {
    let is_polar =
        |report: &&Measurement| matches!(report.flat(), Measurement::RangeBearing { .. });
    if !reports.is_empty() && reports.iter().all(is_polar) {
        return polar_of(settings);
    }
    let mut faults = Vec::new();
    if reports.iter().any(|report| report.position().is_none()) {
        let detail = format!(
            "sensor '{}' reports directions, which are not put together",
            settings.sensor_id
        );
        faults.push(
            Fault::new("/input", "unsupported", detail)
                .allowing("positions (x_m, y_m), or ranges with bearings"),
        );
    }
    match (settings.sigma_x_m, settings.sigma_y_m) {
        (Some(sigma_x_m), Some(sigma_y_m)) if faults.is_empty() => {
            return Ok(MeasurementModel::Position {
                sigma_x_m,
                sigma_y_m,
            });
        }
        (Some(_), Some(_)) => {}
        _ => faults.push(unknown_noise(settings, "'sigma_x_m' and 'sigma_y_m'")),
    }
    Err(faults)
}

fn unknown_noise(settings: &SensorSettings, wanted: &str) -> Fault {
    let detail = format!(
        "the noise of sensor '{}' is not known: give {wanted} in 'sensors'",
        settings.sensor_id
    );
    Fault::new("/sensors", "missing", detail).allowing("> 0 m")
}

/// A sensor of ranges and bearings, which are turned into positions.
fn polar_of(settings: &SensorSettings) -> Result<MeasurementModel, Vec<Fault>> {
    let (Some(sigma_range_m), Some(sigma_bearing_deg)) =
        (settings.sigma_range_m, settings.sigma_bearing_deg)
    else {
        let wanted = "'sigma_range_m' and 'sigma_bearing_deg'";
        return Err(vec![unknown_noise(settings, wanted).allowing("> 0")]);
    };
    let (Some(x_m), Some(y_m)) = (settings.x_m, settings.y_m) else {
        let detail = format!(
            "the place of sensor '{}' is not known: give 'x_m' and 'y_m' in 'sensors'",
            settings.sensor_id
        );
        return Err(vec![
            Fault::new("/sensors", "missing", detail).allowing("finite numbers"),
        ]);
    };
    // Rates are compared, and update no track: how false ones are spread does not matter.
    let range_rate = settings.sigma_range_rate_mps.map(|sigma_mps| RangeRate {
        sigma_mps,
        span_mps: 1.0,
    });
    Ok(MeasurementModel::Converted(Polar {
        place_m: Position::new(x_m, y_m),
        sigma_range_m,
        sigma_bearing_rad: sigma_bearing_deg.to_radians(),
        range_rate,
        platform: Platform::STANDING,
    }))
}
