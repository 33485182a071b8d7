//! Tracks that begin at the truth: of every target that is there at the first scan, a state as one detection and a known rate
//! would give it, with the errors that its covariance tells.
//!
//! # Symbols
//! z what the sensor of the first scan whose reports can start a track would report of the true place, with its own noise; ṙ the true rate of each coordinate,
//! σ the standard deviation that is given for it.
//!
//! # Method
//! 1. The filter makes a state of z as of any detection.
//! 2. Its rates are replaced by ṙ + σ N(0, 1), with variances σ² and no covariance with anything.
//!
//! Truth between two points is on the line between them, however far they are apart.

use crate::experiment::job::RunError;
use crate::experiment::request::methods::NamedFilter;
use crate::filtering::{AnyFilter, Filter, WithFilter};
use crate::hypotheses::certain::locate;
use crate::math::rng::{Purpose, Seed};
use crate::model::fault::Fault;
use crate::model::scan::{Measurement, Recording};
use crate::model::sensing::{MeasurementModel, Moving, RangeRate, Spherical};
use crate::model::sensor::Sensor;
use crate::model::space::{Place, Space};
use crate::model::state::{GaussianState, Position};
use crate::model::truth::{Target, TruthSet};
use crate::tracking::{GivenTrack, Initiation, Lifecycle};
use rand_distr::{Distribution, StandardNormal};

/// Where a track begins.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    pub truth_id: String,
    /// Index of the target in the recording, if that knows it.
    pub origin: Option<u32>,
    /// What the sensor that would report z measures.
    report: MeasurementModel,
    /// z.
    measurement: Measurement,
    /// ṙ with its error, m/s or rad/s; of a bearing only the first, of the plane the first two.
    rates: [f64; 3],
    /// σ.
    sigma: f64,
}

/// What is true of a target.
struct Truth {
    space: Space,
    position: Place,
    rates: [f64; 3],
}

/// The starts of all targets that are there at the first scan; none where tracks begin otherwise.
///
/// # Errors
/// No truth, or truth of another kind than the tracks of this filter.
pub fn starts(
    lifecycle: &Lifecycle,
    recording: &Recording,
    truth: Option<&TruthSet>,
    sensors: &[Sensor],
    filter: &NamedFilter,
    seed: Seed,
) -> Result<Vec<Start>, RunError> {
    let Initiation::Truth {
        speed_sigma_mps,
        rate_sigma_degps,
    } = lifecycle.initiation
    else {
        return Ok(Vec::new());
    };
    let Some(truth) = truth else {
        return Err(refusal(
            "missing",
            "no truth was found for this job, and its tracks begin at it",
            "truth",
        ));
    };
    if let Some(fault) = unfit_truth(lifecycle, truth.space(), filter) {
        return Err(fault.into());
    }
    let Some(scan) = recording.scans.first() else {
        return Ok(Vec::new());
    };
    let Some(report) = starting_report(recording, sensors, filter) else {
        return Ok(Vec::new());
    };
    let sigma = match truth.space() {
        Space::Bearing => rate_sigma_degps.to_radians(),
        Space::Plane | Space::Volume => speed_sigma_mps,
    };
    let start = |(index, target): (usize, &Target)| {
        let truth = true_at(truth.space(), target, scan.time_s)?;
        let mut draw = seed.stream(Purpose::TrackStart, index as u64, 0);
        let errors: [f64; 7] = std::array::from_fn(|_| StandardNormal.sample(&mut draw));
        Some(Start {
            truth_id: target.truth_id.clone(),
            origin: recording
                .targets
                .iter()
                .position(|name| *name == target.truth_id)
                .map(|origin| origin as u32),
            report,
            measurement: draw_report(&report, &truth, errors)?,
            rates: [(0, 3), (1, 4), (2, 5)]
                .map(|(axis, error)| truth.rates[axis] + sigma * errors[error]),
            sigma,
        })
    };
    Ok(truth
        .targets()
        .iter()
        .enumerate()
        .filter_map(start)
        .collect())
}

/// What is measured in the first scan whose reports can start a track of this filter.
fn starting_report(
    recording: &Recording,
    sensors: &[Sensor],
    named: &NamedFilter,
) -> Option<MeasurementModel> {
    let space = named.filter.space();
    let mut reports = recording
        .scans
        .iter()
        .map(|scan| sensors[scan.sensor].report_in(scan));
    reports.find(|report| report.locates_in(space))
}

/// A fault where tracks begin at truth of another kind than theirs.
pub fn unfit_truth(lifecycle: &Lifecycle, space: Space, named: &NamedFilter) -> Option<Fault> {
    let tracked = named.filter.space();
    let is_alike = space.has_places() == tracked.has_places();
    let is_low = space == Space::Plane && tracked == Space::Volume;
    if !matches!(lifecycle.initiation, Initiation::Truth { .. }) || (is_alike && !is_low) {
        return None;
    }
    if is_low {
        let detail = "the truth has no heights (z_m), and tracks of a volume cannot begin at it";
        return Some(
            Fault::new("/truth", "unsupported", detail)
                .allowing("truth with z_m, or space plane of the tracker"),
        );
    }
    let (found, wanted) = match space {
        Space::Bearing => ("directions (bearing_deg)", "places (x_m, y_m)"),
        Space::Plane | Space::Volume => ("places", "directions (bearing_deg)"),
    };
    let detail = format!(
        "the truth are {found}, and tracks of the filter '{}' cannot begin at them",
        named.name
    );
    Some(Fault::new("/truth", "unsupported", detail).allowing(wanted))
}

fn refusal(code: &str, detail: &str, allowed: &str) -> RunError {
    Fault::new("/truth", code, detail).allowing(allowed).into()
}

fn true_at(space: Space, target: &Target, time_s: f64) -> Option<Truth> {
    let position = target.position_at(space, time_s, f64::INFINITY)?;
    let rates = target.velocity_at(space, time_s, f64::INFINITY);
    Some(Truth {
        space,
        position,
        rates: rates.unwrap_or_default().into(),
    })
}

/// What the sensor would report, with draws of the standard normal distribution as its errors. `None` where it reports
/// something else than truth tells.
fn draw_report(report: &MeasurementModel, truth: &Truth, errors: [f64; 7]) -> Option<Measurement> {
    match (*report, truth.space) {
        (MeasurementModel::Bearing(sensor), Space::Bearing) => Some(Measurement::Bearing {
            bearing_rad: truth.position.x + sensor.sigma_bearing_rad * errors[0],
        }),
        (
            MeasurementModel::Position {
                sigma_x_m,
                sigma_y_m,
            },
            Space::Plane | Space::Volume,
        ) => Some(Measurement::Position {
            x_m: truth.position.x + sigma_x_m * errors[0],
            y_m: truth.position.y + sigma_y_m * errors[1],
        }),
        (MeasurementModel::Moving(moving), Space::Plane) => Some(Measurement::Position {
            x_m: truth.position.x + moving.sigmas_m[0] * errors[0],
            y_m: truth.position.y + moving.sigmas_m[1] * errors[1],
        }),
        (MeasurementModel::Polar(polar), Space::Plane | Space::Volume) => {
            let offset_m = truth.position.xy() - polar.place_m;
            let towards = offset_m.try_normalize(0.0).unwrap_or_else(Position::zeros);
            let range_rate = |sigma_mps: f64| {
                towards.dot(&Place::from(truth.rates).xy()) + sigma_mps * errors[2]
            };
            Some(Measurement::RangeBearing {
                range_m: (offset_m.norm() + polar.sigma_range_m * errors[0]).abs(),
                bearing_rad: offset_m[0].atan2(offset_m[1]) + polar.sigma_bearing_rad * errors[1],
                range_rate_mps: polar.range_rate.map(|rate| range_rate(rate.sigma_mps)),
            })
        }
        (
            MeasurementModel::Position3 { sigmas_m, .. }
            | MeasurementModel::Moving(Moving { sigmas_m, .. }),
            Space::Volume,
        ) => Some(Measurement::Position3 {
            x_m: truth.position.x + sigmas_m[0] * errors[0],
            y_m: truth.position.y + sigmas_m[1] * errors[1],
            z_m: truth.position.z + sigmas_m[2] * errors[6],
        }),
        (MeasurementModel::Spherical(spherical), Space::Volume) => {
            Some(seen_in_space(&spherical, truth, errors))
        }
        _ => None,
    }
}

/// The same of a range with its bearing and elevation.
fn seen_in_space(spherical: &Spherical, truth: &Truth, errors: [f64; 7]) -> Measurement {
    let offset_m = spherical.site.turn * (truth.position - spherical.site.place_m);
    let velocity_mps = spherical.site.turn * Place::from(truth.rates);
    let towards = offset_m.try_normalize(0.0).unwrap_or_else(Place::zeros);
    let range_rate = |rate: RangeRate| towards.dot(&velocity_mps) + rate.sigma_mps * errors[2];
    let elevation_rad = offset_m.z.atan2(offset_m.xy().norm());
    Measurement::RangeBearingElevation {
        range_m: (offset_m.norm() + spherical.sigma_range_m * errors[0]).abs(),
        bearing_rad: offset_m.x.atan2(offset_m.y) + spherical.sigma_bearing_rad * errors[1],
        elevation_rad: elevation_rad + spherical.sigma_elevation_rad.unwrap_or(0.0) * errors[6],
        range_rate_mps: spherical.range_rate.map(range_rate),
    }
}

impl Start {
    /// The fault of a start of which the filter makes no state.
    fn without_state(&self) -> Fault {
        let detail = format!(
            "the filter makes no state of what a sensor would report of target '{}'",
            self.truth_id
        );
        Fault::new("/truth", "unsupported", detail)
    }

    /// What is known of the target where its track begins, packed as a tracker takes it.
    ///
    /// # Errors
    /// The filter cannot use what the sensor would report of it.
    pub fn given(self, filter: &AnyFilter) -> Result<GivenTrack, RunError> {
        let Some(kinematics) = filter.with(Begin {
            start: &self,
            report: &self.report,
        }) else {
            return Err(self.without_state().into());
        };
        Ok(GivenTrack {
            name: self.truth_id,
            origin: self.origin,
            kinematics,
        })
    }

    /// Steps 1 and 2.
    fn packed<const K: usize>(&self, located: Option<GaussianState<K>>) -> Option<Vec<f64>> {
        let mut state = located?;
        for (axis, rate) in (K / 2..K).enumerate() {
            state.mean[rate] = self.rates[axis];
            state.covariance.row_mut(rate).fill(0.0);
            state.covariance.column_mut(rate).fill(0.0);
            state.covariance[(rate, rate)] = self.sigma * self.sigma;
        }
        let mut packed = Vec::new();
        state.pack_into(&mut packed);
        Some(packed)
    }
}

struct Begin<'a> {
    start: &'a Start,
    report: &'a MeasurementModel,
}

impl WithFilter for Begin<'_> {
    type Output = Option<Vec<f64>>;

    fn in_plane<F: Filter<4>>(self, filter: F) -> Option<Vec<f64>> {
        let Begin { start, report } = self;
        start.packed(locate(&filter, report, &start.measurement, start.sigma))
    }

    fn in_volume<F: Filter<6>>(self, filter: F) -> Option<Vec<f64>> {
        let Begin { start, report } = self;
        start.packed(locate(&filter, report, &start.measurement, start.sigma))
    }

    fn of_bearings<F: Filter<2>>(self, filter: F) -> Option<Vec<f64>> {
        let Begin { start, report } = self;
        start.packed(locate(&filter, report, &start.measurement, start.sigma))
    }
}
