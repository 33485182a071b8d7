//! The attributes by which reports are compared instead of places: which, of the reports, and as the tracks expect them.
//!
//! # Symbols
//! p, v position and velocity of a track, P its covariance; r, β, ṙ range, bearing and range rate from the sensors' place; G the
//! slopes of the attributes over (p, v).
//!
//! # Method
//! A report's attributes are known as well as its sensor measures them: positions by the covariance of the converted range and
//! bearing, the others by their σ. Of a track they are those of (p, v), known to G P Gᵀ. Attributes are compared as if their
//! errors were independent, also where one follows from others.

use super::instants::Instant;
use super::spec::AttributeName;
use crate::correlation::grouping::Place;
use crate::correlation::grouping::attributes::{Attributes, Described};
use crate::model::angle::wrap;
use crate::model::fault::Fault;
use crate::model::scan::{DetectionIndex, Measurement, Recording};
use crate::model::sensing::{MeasurementModel, Polar, Sensing};
use crate::model::sensor::Sensor;
use crate::model::state::{GaussianState, State};
use nalgebra::{DMatrix, SMatrix, Vector3};

/// The attributes of an instant.
pub struct DescribedInstant {
    pub angles: Vec<bool>,
    pub reports: Vec<Attributes>,
    pub predictions: Vec<Attributes>,
}

impl DescribedInstant {
    pub fn view(&self) -> Described<'_> {
        Described {
            angles: &self.angles,
            reports: &self.reports,
            predictions: &self.predictions,
        }
    }
}

/// Which attributes, in their fixed order, and the sensor that all of them are seen by.
#[derive(Debug, Clone, PartialEq)]
pub struct AttributeSet {
    names: Vec<AttributeName>,
    polar: Polar,
}

/// All that can be compared: x, y, r, β, ṙ.
const MOST: usize = 5;

impl AttributeSet {
    /// # Errors
    /// A sensor that does not report an attribute, or stands elsewhere than another.
    pub fn new(
        wanted: &[AttributeName],
        recording: &Recording,
        sensors: &[Sensor],
    ) -> Result<Self, Vec<Fault>> {
        let refuse = |detail: String, allowed: &str| {
            vec![Fault::new("/attributes", "unsupported", detail).allowing(allowed)]
        };
        let mut places = Vec::new();
        for sensor in sensors {
            let MeasurementModel::Converted(polar) = sensor.report else {
                let detail = format!("sensor '{}' reports positions alone", sensor.sensor_id);
                return Err(refuse(detail, "sensors of ranges and bearings"));
            };
            places.push(polar);
        }
        if places
            .iter()
            .any(|polar| polar.place_m != places[0].place_m)
        {
            let detail = "ranges, bearings and range rates from different places do not compare";
            return Err(refuse(detail.to_owned(), "sensors at one place"));
        }
        if wanted.contains(&AttributeName::RangeRate) && lacks_rates(recording, &places) {
            let detail = "range rates are not reported by all sensors with a known noise";
            return Err(refuse(
                detail.to_owned(),
                "'range_rate_mps' and 'sigma_range_rate_mps'",
            ));
        }
        let all = AttributeName::ALL.into_iter();
        Ok(AttributeSet {
            names: all.filter(|name| wanted.contains(name)).collect(),
            polar: places[0],
        })
    }

    /// Names of the values, as a trace has them.
    pub fn columns(&self) -> Vec<&'static str> {
        self.rows()
            .map(|row| ["x_m", "y_m", "range_m", "bearing_rad", "range_rate_mps"][row])
            .collect()
    }

    pub fn angles(&self) -> Vec<bool> {
        self.rows().map(|row| row == 3).collect()
    }

    /// Places of the chosen attributes among all.
    fn rows(&self) -> impl Iterator<Item = usize> {
        self.names.iter().flat_map(|name| name.rows())
    }

    /// Of each report of an instant.
    pub fn of_reports(
        &self,
        instant: &Instant,
        detections: &DetectionIndex,
        sensors: &[Sensor],
    ) -> Vec<Attributes> {
        let mut described = Vec::with_capacity(instant.reports.len());
        for (&detection, report) in instant.detections.iter().zip(&instant.reports) {
            let sensor = &sensors[report.sensor as usize].report;
            let measurement = detections
                .get(detection)
                .map(|found| found.measurement.flat());
            if let (
                MeasurementModel::Converted(polar),
                Some(Measurement::RangeBearing {
                    range_m,
                    bearing_rad,
                    range_rate_mps,
                }),
            ) = (sensor, measurement)
            {
                // A rate that is absent is not among the chosen ones.
                let rate_mps = range_rate_mps.unwrap_or(0.0);
                let seen = Vector3::new(range_m, wrap(bearing_rad), rate_mps);
                described.push(self.of_report(&report.place, seen, polar));
            }
        }
        described
    }

    fn of_report(&self, place: &Place, seen: Vector3<f64>, polar: &Polar) -> Attributes {
        let mut covariance = SMatrix::<f64, MOST, MOST>::identity();
        covariance
            .fixed_view_mut::<2, 2>(0, 0)
            .copy_from(&place.covariance);
        covariance[(2, 2)] = polar.sigma_range_m.powi(2);
        covariance[(3, 3)] = polar.sigma_bearing_rad.powi(2);
        covariance[(4, 4)] = polar.range_rate.map_or(1.0, |rate| rate.sigma_mps.powi(2));
        let (x_m, y_m) = (place.position_m[0], place.position_m[1]);
        self.chosen([x_m, y_m, seen[0], seen[1], seen[2]], &covariance)
    }

    /// As a track expects them.
    pub fn of_state(&self, state: &GaussianState) -> Attributes {
        let seen: Vector3<f64> = self.polar.project(&state.mean);
        let mut slopes = SMatrix::<f64, MOST, 4>::zeros();
        slopes.fixed_view_mut::<2, 2>(0, 0).fill_with_identity();
        let seen_slopes: SMatrix<f64, 3, 4> = self.polar.jacobian(state);
        slopes.fixed_view_mut::<3, 4>(2, 0).copy_from(&seen_slopes);
        let covariance = slopes * state.covariance * slopes.transpose();
        let mean: &State = &state.mean;
        self.chosen([mean[0], mean[1], seen[0], seen[1], seen[2]], &covariance)
    }

    fn chosen(&self, values: [f64; MOST], covariance: &SMatrix<f64, MOST, MOST>) -> Attributes {
        let rows: Vec<usize> = self.rows().collect();
        Attributes {
            values: rows.iter().map(|&row| values[row]).collect(),
            covariance: DMatrix::from_fn(rows.len(), rows.len(), |row, column| {
                covariance[(rows[row], rows[column])]
            }),
        }
    }
}

/// Whether a report lacks its range rate, or a sensor the noise of it.
fn lacks_rates(recording: &Recording, sensors: &[Polar]) -> bool {
    let mut reports = recording.detections();
    sensors.iter().any(|polar| polar.range_rate.is_none())
        || reports.any(|found| {
            !matches!(
                found.measurement,
                Measurement::RangeBearing {
                    range_rate_mps: Some(_),
                    ..
                }
            )
        })
}
