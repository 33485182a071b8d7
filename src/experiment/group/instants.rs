//! The instants of a recording at which several sensors report.

use crate::correlation::grouping::{Place, SensorReport};
use crate::experiment::job::{RunError, refuse_any};
use crate::model::fault::Fault;
use crate::model::scan::{Measurement, Recording, Scan};
use crate::model::sensing::MeasurementModel;
use crate::model::sensor::{Sensor, SensorSettings};
use crate::model::state::PositionCovariance;

/// The reports of one instant.
pub struct Instant {
    pub time_s: f64,
    /// Their indices in the recording, sensor by sensor.
    pub detections: Vec<usize>,
    pub reports: Vec<SensorReport>,
    /// Where the tracks were expected, when they were predicted beforehand.
    pub predictions: Vec<Place>,
}

/// Sensors that report positions with known noise.
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
        let mut detections = scans.flat_map(|scan| &scan.detections);
        if detections
            .any(|detection| !matches!(detection.measurement, Measurement::Position { .. }))
        {
            let detail = format!(
                "sensor '{}' reports directions, which are not put together",
                settings.sensor_id
            );
            faults
                .push(Fault::new("/input", "unsupported", detail).allowing("positions (x_m, y_m)"));
        }
        let (Some(sigma_x_m), Some(sigma_y_m)) = (settings.sigma_x_m, settings.sigma_y_m) else {
            let detail = format!(
                "the noise of sensor '{}' is not known: give 'sigma_x_m' and 'sigma_y_m' in 'sensors'",
                settings.sensor_id
            );
            faults.push(Fault::new("/sensors", "missing", detail).allowing("> 0 m"));
            continue;
        };
        let report = MeasurementModel::Position {
            sigma_x_m,
            sigma_y_m,
        };
        sensors.push(Sensor {
            sensor_id: settings.sensor_id.clone(),
            p_d: settings.p_d.unwrap_or(1.0),
            clutter_density: 0.0,
            may_start: true,
            report,
        });
    }
    refuse_any(faults)?;
    Ok(sensors)
}

/// Scans of one time are one instant; one sensor alone makes none.
pub fn instants_of(recording: &Recording, sensors: &[Sensor]) -> Result<Vec<Instant>, RunError> {
    let mut instants = Vec::new();
    let mut first = 0;
    for scans in recording
        .scans
        .chunk_by(|left, right| left.time_s == right.time_s)
    {
        let instant = instant_of(scans, first, sensors);
        if scans.len() > 1 && !instant.reports.is_empty() {
            instants.push(instant);
        }
        first += scans
            .iter()
            .map(|scan| scan.detections.len())
            .sum::<usize>();
    }
    if instants.len() > 1 {
        return Ok(instants);
    }
    let detail = format!(
        "the sensors have {} times in common at which anything was reported",
        instants.len()
    );
    Err(Fault::new("/input", "disjoint", detail)
        .allowing("scans of two sensors or more at two times or more")
        .into())
}

/// `next` is the index of the first detection of the scans.
fn instant_of(scans: &[Scan], mut next: usize, sensors: &[Sensor]) -> Instant {
    let mut instant = Instant {
        time_s: scans[0].time_s,
        detections: Vec::new(),
        reports: Vec::new(),
        predictions: Vec::new(),
    };
    for scan in scans {
        let first = next;
        next += scan.detections.len();
        let MeasurementModel::Position {
            sigma_x_m,
            sigma_y_m,
        } = sensors[scan.sensor].report
        else {
            continue;
        };
        let covariance =
            PositionCovariance::new(sigma_x_m * sigma_x_m, 0.0, 0.0, sigma_y_m * sigma_y_m);
        for (index, detection) in (first..).zip(&scan.detections) {
            if let Some(position_m) = detection.measurement.position() {
                instant.detections.push(index);
                instant.reports.push(SensorReport {
                    place: Place {
                        position_m,
                        covariance,
                    },
                    sensor: scan.sensor as u32,
                });
            }
        }
    }
    instant
}
