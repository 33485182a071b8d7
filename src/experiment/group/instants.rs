//! The instants of a recording at which several sensors report.

use super::attributes::DescribedInstant;
use crate::correlation::grouping::{Place, SensorReport};
use crate::experiment::job::RunError;
use crate::model::fault::Fault;
use crate::model::own::Own;
use crate::model::scan::{Measurement, Recording, Scan};
use crate::model::sensing::{Converted, MeasurementModel, Sensing};
use crate::model::sensor::Sensor;
use crate::model::state::PositionCovariance;

/// The reports of one instant.
pub struct Instant {
    pub time_s: f64,
    /// Their indices in the recording, sensor by sensor.
    pub detections: Vec<usize>,
    pub reports: Vec<SensorReport>,
    /// Where the tracks were expected, when they were predicted beforehand.
    pub predictions: Vec<Place>,
    /// What is compared instead of places, where several attributes are.
    pub described: Option<DescribedInstant>,
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
        described: None,
    };
    for scan in scans {
        let first = next;
        next += scan.detections.len();
        let report = &sensors[scan.sensor].report;
        for (index, detection) in (first..).zip(&scan.detections) {
            if let Some(place) = place_of(report, &detection.measurement) {
                instant.detections.push(index);
                instant.reports.push(SensorReport {
                    place,
                    sensor: scan.sensor as u32,
                });
            }
        }
    }
    instant
}

/// Where a report alone puts its target.
fn place_of(report: &MeasurementModel, measurement: &Measurement) -> Option<Place> {
    match report {
        MeasurementModel::Position {
            sigma_x_m,
            sigma_y_m,
        } => Some(Place {
            position_m: measurement.position()?,
            covariance: PositionCovariance::new(
                sigma_x_m * sigma_x_m,
                0.0,
                0.0,
                sigma_y_m * sigma_y_m,
            ),
        }),
        MeasurementModel::Converted(polar) => {
            let converted = Converted(*polar);
            let alone = converted.locate(&converted.read(measurement, &Own::default())?, 0.0)?;
            Some(Place {
                position_m: alone.mean.fixed_rows::<2>(0).into_owned(),
                covariance: alone.covariance.fixed_view::<2, 2>(0, 0).into_owned(),
            })
        }
        _ => None,
    }
}
