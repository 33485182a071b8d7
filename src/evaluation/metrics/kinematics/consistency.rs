//! Whether errors are as large as the tracks say: NEES, the normalised estimation error squared, from their covariances, and
//! NIS, the same of innovations, where the tracks carry it.
//!
//! # Symbols
//! e error, P covariance, n numbers in e; N samples; χ²(k, q) the q-quantile with k degrees of freedom.
//!
//! # Method
//! 1. NEES = eᵀ P⁻¹ e, of position (n = 2, in a volume 3) and, where velocities are known, of the whole state (n = 4, 6).
//! 2. The mean of N samples of a consistent filter lies within χ²(N n, ½ ∓ ½ confidence) / N with that confidence, if the
//!    samples are independent. Those of one track are not over time, so the bounds of the whole are rather too narrow.
//! 3. NIS (n the numbers of a measurement) has the same mean and bounds. Detections outside the gate are missing from it, so
//!    a consistent filter lies a little low.
//! 4. The share of steps at which the mean over the targets of that step is within the bounds for their number.

use super::Sample;
use crate::evaluation::metrics::origin::{Origin, PAIRS, SERIES, Statistic};
use crate::evaluation::metrics::{Quantity, Series};
use crate::math::gaussian::{Gaussian, chi_square_quantile};
use crate::model::space::{Place, Space};
use crate::model::track::Kinematics;
use nalgebra::{SMatrix, SVector};
use std::collections::BTreeMap;

/// NEES of one match, and the NIS of its track point.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Normalised {
    pub position: Option<f64>,
    pub state: Option<f64>,
    pub innovation: Option<f64>,
}

impl Normalised {
    /// Of errors in `space`, which is that of the estimate, or the plane.
    pub fn new(
        space: Space,
        error_m: Place,
        error_mps: Option<Place>,
        estimate: &Kinematics,
    ) -> Normalised {
        if space == Space::Volume {
            return Normalised::of_axes::<3, 6>(error_m, error_mps, estimate.covariance());
        }
        let of_plane = estimate.covariance();
        let covariance = of_plane.or_else(|| estimate.in_plane().covariance());
        Normalised::of_axes::<2, 4>(error_m, error_mps, covariance)
    }

    /// Of K coordinates and the K rates behind them, N numbers in all.
    fn of_axes<const K: usize, const N: usize>(
        error_m: Place,
        error_mps: Option<Place>,
        covariance: Option<SMatrix<f64, N, N>>,
    ) -> Normalised {
        let Some(covariance) = covariance else {
            return Normalised::default();
        };
        let block = covariance.fixed_view::<K, K>(0, 0).into_owned();
        let position = squared(&block, &SVector::from_fn(|axis, _| error_m[axis]));
        let state = error_mps.and_then(|error_mps| {
            let error = |row: usize, _| match row.checked_sub(K) {
                Some(axis) => error_mps[axis],
                None => error_m[row],
            };
            squared(&covariance, &SVector::from_fn(error))
        });
        Normalised {
            position,
            state,
            innovation: None,
        }
    }
}

/// eᵀ P⁻¹ e, where it is a number.
fn squared<const N: usize>(
    covariance: &SMatrix<f64, N, N>,
    error: &SVector<f64, N>,
) -> Option<f64> {
    let value = Gaussian::new(covariance)?.squared_distance(error);
    value.is_finite().then_some(value)
}

/// One of the kinds of normalised errors, with the names under which it is reported.
struct Family {
    mean: &'static str,
    /// What it is called in a sentence.
    word: &'static str,
    lower: &'static str,
    upper: &'static str,
    within: &'static str,
    samples: &'static str,
    /// How many numbers it has of each axis; `None`: as many in all as a measurement has.
    of_axis: Option<u32>,
    reason: &'static str,
    of: fn(&Sample) -> Option<f64>,
}

const FAMILIES: [Family; 3] = [
    Family {
        mean: "nees_position",
        word: "NEES of the position",
        lower: "nees_position_lower",
        upper: "nees_position_upper",
        within: "nees_position_steps_within",
        samples: "nees_position_samples",
        of_axis: Some(1),
        reason: NO_COVARIANCE,
        of: |sample| sample.normalised.position,
    },
    Family {
        mean: "nees_state",
        word: "NEES of the state",
        lower: "nees_state_lower",
        upper: "nees_state_upper",
        within: "nees_state_steps_within",
        samples: "nees_state_samples",
        of_axis: Some(2),
        reason: NO_COVARIANCE,
        of: |sample| sample.normalised.state,
    },
    Family {
        mean: "nis_of_matches",
        word: "NIS",
        lower: "nis_of_matches_lower",
        upper: "nis_of_matches_upper",
        within: "nis_of_matches_steps_within",
        samples: "nis_of_matches_samples",
        of_axis: None,
        reason: "no matched track says the NIS of its updates",
        of: |sample| sample.normalised.innovation.filter(|nis| nis.is_finite()),
    },
];

/// Means, numbers and shares of steps; the bounds are quantiles of the numbers of samples.
pub const FROM: &[Origin] = &[
    Origin::rows("nees_position", Statistic::Mean, PAIRS, "nees_position"),
    Origin::rows(
        "nees_position_samples",
        Statistic::Count,
        PAIRS,
        "nees_position",
    ),
    Origin::rows(
        "nees_position_steps_within",
        Statistic::ShareWithin,
        SERIES,
        "nees_position",
    ),
    Origin::rows("nees_state", Statistic::Mean, PAIRS, "nees_state"),
    Origin::rows("nees_state_samples", Statistic::Count, PAIRS, "nees_state"),
    Origin::rows(
        "nees_state_steps_within",
        Statistic::ShareWithin,
        SERIES,
        "nees_state",
    ),
    Origin::rows("nis_of_matches", Statistic::Mean, PAIRS, "nis_of_matches"),
    Origin::rows(
        "nis_of_matches_samples",
        Statistic::Count,
        PAIRS,
        "nis_of_matches",
    ),
    Origin::rows(
        "nis_of_matches_steps_within",
        Statistic::ShareWithin,
        SERIES,
        "nis_of_matches",
    ),
];

/// The kinds of normalised errors, and what a match says of each.
pub fn families() -> impl Iterator<Item = (&'static str, fn(&Sample) -> Option<f64>)> {
    FAMILIES.iter().map(|family| (family.mean, family.of))
}

pub const NO_COVARIANCE: &str = "no matched track has a covariance that can be inverted";

/// The bounds, each computed once.
pub struct Consistency {
    confidence: f64,
    measurement_dimensions: u32,
    /// Of the space.
    axes: u32,
    bounds: BTreeMap<(u32, usize), (f64, f64)>,
}

impl Consistency {
    pub fn new(confidence: f64, measurement_dimensions: u32, axes: u32) -> Consistency {
        Consistency {
            confidence,
            measurement_dimensions,
            axes,
            bounds: BTreeMap::new(),
        }
    }

    fn dimensions(&self, family: &Family) -> u32 {
        let of_axes = family.of_axis.map(|numbers| numbers * self.axes);
        of_axes.unwrap_or(self.measurement_dimensions)
    }

    /// Step 2, for the mean of `samples` samples, at least one.
    fn bounds(&mut self, family: &Family, samples: usize) -> (f64, f64) {
        let confidence = self.confidence;
        let dimensions = self.dimensions(family);
        *self.bounds.entry((dimensions, samples)).or_insert_with(|| {
            let quantile = |probability| {
                chi_square_quantile(probability, f64::from(dimensions) * samples as f64)
                    / samples as f64
            };
            (
                quantile(0.5 - 0.5 * confidence),
                quantile(0.5 + 0.5 * confidence),
            )
        })
    }

    /// Means, bounds and shares of steps over all sequences.
    pub fn summary(&mut self, sequences: &[Vec<Sample>]) -> Vec<Quantity> {
        let mut quantities = Vec::new();
        for family in &FAMILIES {
            let (mut within, mut steps) = (0.0, 0.0);
            for (mean, count) in sequences
                .iter()
                .flat_map(|samples| step_means(samples, family))
                .map(|(_, mean, count)| (mean, count))
            {
                let (lower, upper) = self.bounds(family, count);
                steps += 1.0;
                within += f64::from(u8::from((lower..=upper).contains(&mean)));
            }
            quantities.extend(self.mean(&sequences.iter().flatten().collect::<Vec<_>>(), family));
            quantities.push(Quantity::ratio(
                family.within,
                within,
                steps,
                "",
                family.reason,
            ));
        }
        quantities
    }

    /// Warnings of means outside their bounds: of the whole state where it is known, else of the position; and of the NIS where
    /// `is_nis_told` says so. A σ that is less than a tenth away from what would fit is not worth one.
    pub fn doubts(&self, quantities: &[Quantity], is_nis_told: bool) -> Vec<String> {
        let has_state = quantities
            .iter()
            .any(|quantity| quantity.name == "nees_state" && quantity.value.is_some());
        let is_told = |family: &&Family| match family.mean {
            "nees_state" => has_state,
            "nees_position" => !has_state,
            _ => is_nis_told,
        };
        FAMILIES
            .iter()
            .filter(is_told)
            .filter_map(|family| self.doubt(family, quantities))
            .collect()
    }

    fn doubt(&self, family: &Family, quantities: &[Quantity]) -> Option<String> {
        let value = |name: &str| {
            quantities
                .iter()
                .find(|quantity| quantity.name == name)
                .and_then(|quantity| quantity.value)
        };
        let (mean, lower, upper) = (
            value(family.mean)?,
            value(family.lower)?,
            value(family.upper)?,
        );
        let due = self.dimensions(family);
        let factor = (mean / f64::from(due)).sqrt();
        if (lower..=upper).contains(&mean) || (factor - 1.0).abs() <= 0.1 {
            return None;
        }
        let (what, sigma) = match (family.of_axis, mean > f64::from(due)) {
            (Some(_), true) => (
                "the tracks are surer than they are right",
                "covariances of sigma",
            ),
            (Some(_), false) => (
                "the tracks are less sure than they could be",
                "covariances of sigma",
            ),
            (None, true) => ("the noise was assumed too small", "sigma"),
            (None, false) => ("the noise was assumed too large", "sigma"),
        };
        let (name, percent) = (family.word, 100.0 * self.confidence);
        Some(format!(
            "mean {name} {mean:.2} over {} matches, {due} is due ({lower:.2} to {upper:.2} with {percent} %): {what}; {sigma} × {factor:.2} \
             would fit",
            value(family.samples)?
        ))
    }

    /// Means and bounds over some samples.
    pub fn means(&mut self, samples: &[&Sample]) -> Vec<Quantity> {
        FAMILIES
            .iter()
            .flat_map(|family| self.mean(samples, family))
            .collect()
    }

    fn mean(&mut self, samples: &[&Sample], family: &Family) -> [Quantity; 4] {
        let values: Vec<f64> = samples
            .iter()
            .filter_map(|sample| (family.of)(sample))
            .collect();
        let bounds = (!values.is_empty()).then(|| self.bounds(family, values.len()));
        [
            Quantity::ratio(
                family.mean,
                values.iter().sum(),
                values.len() as f64,
                "",
                family.reason,
            ),
            Quantity::or(
                family.lower,
                bounds.map(|(lower, _)| lower),
                "",
                family.reason,
            ),
            Quantity::or(
                family.upper,
                bounds.map(|(_, upper)| upper),
                "",
                family.reason,
            ),
            Quantity::new(family.samples, values.len() as f64, ""),
        ]
    }

    /// Mean and bounds at each step.
    pub fn series(&mut self, samples: &[Sample], steps: usize) -> Vec<Series> {
        let mut series = Vec::new();
        for family in &FAMILIES {
            let mut values = vec![[None; 3]; steps];
            for (step, mean, count) in step_means(samples, family) {
                let (lower, upper) = self.bounds(family, count);
                values[step] = [mean, lower, upper].map(Some);
            }
            let names = [family.mean, family.lower, family.upper]
                .into_iter()
                .enumerate();
            series.extend(names.map(|(place, name)| {
                Series::over_time(name, "", values.iter().map(|step| step[place]))
            }));
        }
        series
    }
}

/// Step, mean and number of samples of each step that has any; samples are in order of steps.
fn step_means<'s>(
    samples: &'s [Sample],
    family: &'s Family,
) -> impl Iterator<Item = (usize, f64, usize)> + 's {
    samples
        .chunk_by(|left, right| left.step == right.step)
        .filter_map(|at_step| {
            let values: Vec<f64> = at_step.iter().filter_map(family.of).collect();
            (!values.is_empty()).then(|| {
                (
                    at_step[0].step,
                    values.iter().sum::<f64>() / values.len() as f64,
                    values.len(),
                )
            })
        })
}
