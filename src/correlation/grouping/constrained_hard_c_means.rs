//! Constrained hard c-means: the predictions are the first centres; the reports of each sensor are assigned to different
//! centres at the least sum of squared distances, the centres move to their reports, until nothing changes.
//!
//! # Reference
//! K. Wagstaff, C. Cardie, S. Rogers, S. Schrödl, Constrained k-means clustering with background knowledge, Proc. 18th Int.
//! Conf. on Machine Learning, 2001, 577–584; here "cannot link" holds between all reports of one sensor, and each sensor's
//! part is solved to the optimum instead of greedily.
//!
//! # Symbols
//! x_k report k with covariance R_k, v_i centre i, d² = (x_k − v_i)ᵀ R_k⁻¹ (x_k − v_i).
//!
//! # Method
//! 1. For each sensor the assignment of its reports to different centres with the least Σ d²
//!    ([`crate::math::assignment`]). A sensor with more reports than there are centres leaves some out; each of those is a
//!    group of its own.
//! 2. Each centre moves to the information-weighted mean of its reports; a centre without reports stays.
//! 3. Again from 1 until no report changes its centre, or after `max_iterations`.
//!
//! Both steps lower Σ d² or leave it, so the search ends; where depends on where it began.

use super::information::Information;
use super::{BuildGrouper, Grouper, Grouping, Place, SensorReport, Snapshot};
use crate::math::fuzzy_c_means::harden::BySource;
use crate::math::gaussian::Gaussian;
use crate::math::rng::Seed;
use crate::model::fault::Fault;
use crate::registry::{Method, Object};
use serde::Deserialize;
use serde_json::Value;

pub const METHOD: Method<BuildGrouper> = Method {
    name: "constrained_hard_c_means",
    parameters: &PARAMETERS,
    build,
};

static PARAMETERS: Object = Object {
    name: "ConstrainedHardCMeansGrouper",
    summary: "From the predictions: the reports of each sensor go to different centres, the centres to their reports, until nothing changes.",
    fields: &[super::MAX_ITERATIONS],
};

fn build(parameters: &Value, _: Seed) -> Result<Box<dyn Grouper>, serde_json::Error> {
    let Parameters { max_iterations } = Parameters::deserialize(parameters)?;
    Ok(Box::new(ConstrainedHardCMeans {
        max_iterations,
        hardener: BySource::default(),
    }))
}

#[derive(Debug, Deserialize)]
struct Parameters {
    max_iterations: u32,
}

#[derive(Debug, Default)]
pub struct ConstrainedHardCMeans {
    pub max_iterations: u32,
    hardener: BySource,
}

impl Grouper for ConstrainedHardCMeans {
    fn uses_predictions(&self) -> bool {
        true
    }

    fn group(&mut self, snapshot: &Snapshot) -> Result<Grouping, Vec<Fault>> {
        let Snapshot {
            reports,
            predictions,
            ..
        } = *snapshot;
        let sensors: Vec<u32> = reports.iter().map(|report| report.sensor).collect();
        let metrics: Vec<Option<Gaussian<2>>> = reports
            .iter()
            .map(|report| Gaussian::new(&report.place.covariance))
            .collect();
        let mut centres: Vec<Place> = predictions.to_vec();
        let (mut labels, mut before) = (Vec::new(), Vec::new());
        let mut iterations = 0;
        let mut converged = false;
        while !converged && iterations < self.max_iterations {
            std::mem::swap(&mut labels, &mut before);
            // A report of unknown noise is as far from every centre.
            let cost = |report: usize, centre: usize| {
                let difference = reports[report].place.position_m - centres[centre].position_m;
                metrics[report].map_or(0.0, |metric| metric.squared_distance(&difference))
            };
            self.hardener
                .harden(centres.len(), &sensors, cost, &mut labels);
            iterations += 1;
            converged = labels == before;
            move_centres(reports, &labels, &mut centres);
        }
        let mut grouping = Grouping::direct(with_groups_of_their_own(&labels, predictions.len()));
        (grouping.iterations, grouping.converged) = (Some(iterations), converged);
        Ok(grouping)
    }
}

fn move_centres(reports: &[SensorReport], labels: &[Option<usize>], centres: &mut [Place]) {
    let mut sums = vec![Information::none(); centres.len()];
    for (report, label) in reports.iter().zip(labels) {
        if let Some(centre) = label {
            sums[*centre].add(&report.place);
        }
    }
    for (centre, mean) in centres.iter_mut().zip(sums.iter().map(Information::mean)) {
        *centre = mean.unwrap_or(*centre);
    }
}

/// Labels, with a new group for each report that has none.
pub(super) fn with_groups_of_their_own(labels: &[Option<usize>], groups: usize) -> Vec<usize> {
    let mut next = groups;
    let mut number = |label: &Option<usize>| {
        label.unwrap_or_else(|| {
            next += 1;
            next - 1
        })
    };
    labels.iter().map(&mut number).collect()
}
