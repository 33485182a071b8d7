//! Which noises a sensor's reports have, and what is found of them.

use super::passes::FoundOfSensor;
use super::{Estimate, start, three_digits};
use crate::experiment::input::extent::detections_of;
use crate::filtering::AnyFilter;
use crate::model::scan::{Measurement, Recording};
use crate::model::sensor::SensorSettings;
use crate::model::space::Space;

/// What errs by no more is no measurement, but made up: it tells nothing of a noise.
const LEAST_SIGMA: f64 = 1e-6;
/// Fewer residuals tell nothing.
const LEAST_RESIDUALS: usize = 5;
/// Without a single track, noises are this much larger the next time.
const WIDENING: f64 = 2.0;

/// As requests name them.
pub const NAMES: [&str; 7] = [
    "sigma_x_m",
    "sigma_y_m",
    "sigma_z_m",
    "sigma_range_m",
    "sigma_bearing_deg",
    "sigma_elevation_deg",
    "sigma_range_rate_mps",
];

/// A noise: its name, and the value of a report whose noise it is.
pub type Field = (&'static str, usize);

pub fn get(settings: &SensorSettings, name: &str) -> Option<f64> {
    match name {
        "sigma_x_m" => settings.sigma_x_m,
        "sigma_y_m" => settings.sigma_y_m,
        "sigma_z_m" => settings.sigma_z_m,
        "sigma_elevation_deg" => settings.sigma_elevation_deg,
        "sigma_range_m" => settings.sigma_range_m,
        "sigma_bearing_deg" => settings.sigma_bearing_deg,
        _ => settings.sigma_range_rate_mps,
    }
}

pub fn put(settings: &mut SensorSettings, name: &str, value: Option<f64>) {
    match name {
        "sigma_x_m" => settings.sigma_x_m = value,
        "sigma_y_m" => settings.sigma_y_m = value,
        "sigma_z_m" => settings.sigma_z_m = value,
        "sigma_elevation_deg" => settings.sigma_elevation_deg = value,
        "sigma_range_m" => settings.sigma_range_m = value,
        "sigma_bearing_deg" => settings.sigma_bearing_deg = value,
        _ => settings.sigma_range_rate_mps = value,
    }
}

/// Whether a sensor reports bearings alone.
pub fn are_bearings(recording: &Recording, index: usize) -> bool {
    let first = detections_of(recording, index).next();
    matches!(
        first.map(|detection| detection.measurement),
        Some(Measurement::Bearing { .. } | Measurement::BearingElevation { .. })
    )
}

/// The noises that a filter needs of a sensor's reports; none of a sensor that never reported anything.
fn fields(recording: &Recording, index: usize, filter: &AnyFilter) -> Vec<Field> {
    let first = detections_of(recording, index).next();
    let Some(report) = first.map(|detection| detection.measurement) else {
        return Vec::new();
    };
    let report = if filter.space() == Space::Volume {
        report
    } else {
        report.flat()
    };
    match report {
        Measurement::Position { .. } => vec![("sigma_x_m", 0), ("sigma_y_m", 1)],
        Measurement::Position3 { .. } => {
            vec![("sigma_x_m", 0), ("sigma_y_m", 1), ("sigma_z_m", 2)]
        }
        Measurement::BearingElevation { .. } => {
            vec![("sigma_bearing_deg", 0), ("sigma_elevation_deg", 1)]
        }
        Measurement::RangeBearingElevation { range_rate_mps, .. } => {
            let mut fields = vec![
                ("sigma_range_m", 0),
                ("sigma_bearing_deg", 1),
                ("sigma_elevation_deg", 2),
            ];
            if range_rate_mps.is_some() && filter.uses_range_rates() {
                fields.push(("sigma_range_rate_mps", 3));
            }
            fields
        }
        Measurement::Bearing { .. } => vec![("sigma_bearing_deg", 0)],
        Measurement::RangeBearing { .. } if !filter.space().has_places() => {
            vec![("sigma_bearing_deg", 1)]
        }
        Measurement::RangeBearing { range_rate_mps, .. } => {
            let mut fields = vec![("sigma_range_m", 0), ("sigma_bearing_deg", 1)];
            if range_rate_mps.is_some() && filter.uses_range_rates() {
                fields.push(("sigma_range_rate_mps", 2));
            }
            fields
        }
    }
}

/// Those of them that are not known.
pub fn open_fields(
    recording: &Recording,
    index: usize,
    filter: &AnyFilter,
    settings: &SensorSettings,
) -> Vec<Field> {
    let mut fields = fields(recording, index, filter);
    fields.retain(|(name, _)| get(settings, name).is_none());
    fields
}

/// Guesses what is open.
pub fn guess(recording: &Recording, index: usize, open: &[Field], settings: &mut SensorSettings) {
    if open.is_empty() {
        return;
    }
    let guesses = start::guess(recording, index);
    for &(name, axis) in open {
        let value = guesses[axis].map(|sigma| in_units(name, sigma).max(LEAST_SIGMA));
        put(settings, name, value);
    }
}

/// Any noise in the place of those that are not known.
pub fn presume(fields: &[Field], settings: &mut SensorSettings) {
    for (name, _) in fields {
        put(settings, name, Some(1.0));
    }
}

/// Tells the guess of each noise that no track told.
pub fn keep_guesses(fields: &[Field], guessed: &SensorSettings, estimates: &mut Vec<Estimate>) {
    for (name, _) in fields {
        let is_told = |estimate: &Estimate| {
            estimate.sensor_id == guessed.sensor_id && estimate.setting == *name
        };
        let guess = get(guessed, name).filter(|sigma| *sigma > LEAST_SIGMA);
        let Some(sigma) = guess.filter(|_| !estimates.iter().any(is_told)) else {
            continue;
        };
        estimates.push(Estimate {
            sensor_id: guessed.sensor_id.clone(),
            setting: name,
            value: three_digits(sigma),
            standard_error: three_digits(sigma),
            from: "the nearest detections of three scans in a row, for hardly a track tells it"
                .into(),
        });
    }
}

/// Makes them larger.
pub fn widen(fields: &[Field], settings: &mut SensorSettings) {
    for (name, _) in fields {
        let value = get(settings, name).map(|sigma| WIDENING * sigma);
        put(settings, name, value);
    }
}

/// What a pass tells of the noises of a sensor; `growth` is what its innovations ask for besides.
pub fn estimates(
    fields: &[Field],
    settings: &SensorSettings,
    found: &FoundOfSensor,
    growth: f64,
) -> Vec<Estimate> {
    let residuals = &found.residuals;
    let mut estimates = Vec::with_capacity(fields.len());
    for &(name, axis) in fields {
        let Some(sigma) = residuals
            .sigma(axis)
            .filter(|sigma| sigma.count >= LEAST_RESIDUALS)
            .filter(|sigma| in_units(name, sigma.value) > LEAST_SIGMA)
        else {
            continue;
        };
        let by_innovations = if growth > 1.0 {
            format!(", times {growth:.2} by their innovations")
        } else {
            String::new()
        };
        estimates.push(Estimate {
            sensor_id: settings.sensor_id.clone(),
            setting: name,
            value: three_digits(in_units(name, growth * sigma.value)),
            standard_error: three_digits(in_units(name, growth * sigma.standard_error)),
            from: format!(
                "{} triples of detections of {} tracks{by_innovations}",
                sigma.count, found.tracks
            ),
        });
    }
    estimates
}

fn in_units(name: &str, sigma: f64) -> f64 {
    if name.ends_with("_deg") {
        sigma.to_degrees()
    } else {
        sigma
    }
}
