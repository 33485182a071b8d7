//! How well a number of clusters fits the objects, and the choice of that number.
//!
//! # Reference
//! J. C. Bezdek, Cluster validity with fuzzy sets, J. Cybernetics 3, 1973, 58–73 (partition coefficient); X. L. Xie,
//! G. Beni, A validity measure for fuzzy clustering, IEEE Trans. Pattern Analysis and Machine Intelligence 13, 1991,
//! 841–847.
//!
//! # Method
//! - Partition coefficient F = Σ u_ik² / n, from 1/c (nothing decided) to 1 (each object in one cluster): larger is better.
//! - Xie–Beni index X = J / (n · min_{i≠j} |v_i − v_j|²): smaller is better; infinite when two centres coincide. Where each
//!   object has a metric of its own, centres are compared by the mean of these.
//!
//! Both are best at c = n, where each object is its own cluster: a range to choose from must end well below n. Both compare
//! what FCM found from one start a number, which need not be its best.

use super::{FuzzyCMeans, FuzzyError, Metric, Objects};
use std::ops::RangeInclusive;

/// What is to be best.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Index {
    PartitionCoefficient,
    XieBeni,
}

impl Index {
    /// Of the last run, which was on these objects.
    pub fn of(self, found: &FuzzyCMeans, objects: &Objects) -> f64 {
        match self {
            Index::PartitionCoefficient => {
                partition_coefficient(found.memberships(), found.clusters())
            }
            Index::XieBeni => xie_beni(found, objects),
        }
    }

    pub fn is_better(self, value: f64, than: f64) -> bool {
        match self {
            Index::PartitionCoefficient => value > than,
            Index::XieBeni => value < than,
        }
    }
}

/// F.
pub fn partition_coefficient(memberships: &[f64], clusters: usize) -> f64 {
    let objects = memberships.len() / clusters;
    memberships
        .iter()
        .map(|membership| membership * membership)
        .sum::<f64>()
        / objects as f64
}

/// X.
pub fn xie_beni(found: &FuzzyCMeans, objects: &Objects) -> f64 {
    let mut inverse = Vec::new();
    if let Metric::Mahalanobis(inverses) = objects.metric() {
        let size = objects.attributes() * objects.attributes();
        inverse.resize(size, 0.0);
        let share = 1.0 / objects.len() as f64;
        inverses
            .iter()
            .enumerate()
            .for_each(|(place, value)| inverse[place % size] += share * value);
    }
    let distance = |left: &[f64], right: &[f64]| match objects.metric() {
        Metric::Scaled(sigmas) => objects.scaled(left, right, sigmas),
        Metric::Mahalanobis(_) => objects.quadratic(left, right, &inverse),
    };
    let centres: Vec<&[f64]> = found.centres().chunks_exact(objects.attributes()).collect();
    let mut separation = f64::INFINITY;
    for (index, left) in centres.iter().enumerate() {
        separation = centres[..index]
            .iter()
            .fold(separation, |least, right| least.min(distance(left, right)));
    }
    let cost = found.costs().last().copied().unwrap_or(0.0);
    if separation > 0.0 {
        cost / (objects.len() as f64 * separation)
    } else {
        f64::INFINITY
    }
}

/// A number of clusters tried, and its index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tried {
    pub clusters: usize,
    pub index: f64,
    /// Of FCM.
    pub iterations: u32,
    pub converged: bool,
}

/// Runs FCM for each number of clusters of the range, from the initial centres that `start` writes for it, and leaves in
/// `means` the run with the best index (of equals that with the fewest clusters). Returns the number, and all that were tried.
///
/// # Errors
/// A range that is empty or not within 2 to n; what `start` refuses.
pub fn choose(
    means: &mut FuzzyCMeans,
    objects: &Objects,
    range: RangeInclusive<usize>,
    index: Index,
    mut start: impl FnMut(usize, &mut Vec<f64>) -> Result<(), FuzzyError>,
) -> Result<(usize, Vec<Tried>), FuzzyError> {
    let mut tried: Vec<Tried> = Vec::new();
    let mut best: Option<(Tried, FuzzyCMeans)> = None;
    let mut initial = Vec::new();
    for clusters in range.clone() {
        initial.clear();
        start(clusters, &mut initial)?;
        let outcome = means.run(objects, &initial)?;
        let (iterations, converged) = (outcome.iterations, outcome.converged);
        let this = Tried {
            clusters,
            index: index.of(means, objects),
            iterations,
            converged,
        };
        tried.push(this);
        if best
            .as_ref()
            .is_none_or(|(best, _)| index.is_better(this.index, best.index))
        {
            best = Some((this, means.clone()));
        }
    }
    let (chosen, found) = best.ok_or(FuzzyError::Clusters {
        found: *range.start(),
        objects: objects.len(),
    })?;
    *means = found;
    Ok((chosen.clusters, tried))
}
