//! Fuzzy c-means: each object belongs to every cluster by a membership between 0 and 1, the nearer its centre the more.
//! Centres and memberships are improved in turn until the memberships stay.
//!
//! # Reference
//! J. C. Bezdek, R. Ehrlich, W. Full, FCM: the fuzzy c-means clustering algorithm, Computers & Geosciences 10, 1984,
//! 191–203; Cai Yubao et al., Application of fuzzy data association algorithm on multitarget tracking.
//!
//! # Symbols
//! x_k object (k = 1 … n, m attributes), v_i centre (i = 1 … c), d_ik their distance, u_ik membership, q > 1 fuzzifier;
//! U all memberships, V all centres, J(U, V) = Σ_k Σ_i u_ik^q d_ik².
//!
//! # Method
//! 1. From the initial centres the memberships u_ik = 1 / Σ_j (d_ik / d_jk)^(2/(q−1)); an object on a centre belongs to
//!    it alone, on several to each alike.
//! 2. The centres that minimise J for these memberships ([`Metric`] says what they are), then the memberships again.
//! 3. End when no membership changed by more than the tolerance, or after `max_iterations` of step 2.
//!
//! Both halves of step 2 minimise J with the other half fixed, so J never rises. Where it ends depends on where it began:
//! J has local minima, and [`genetic`] looks for a better one.
//!
//! All memory is reused from run to run.

mod error;
pub mod genetic;
pub mod harden;
mod membership;
mod metric;
pub mod start;
#[cfg(test)]
mod tests;
pub mod validity;

pub use error::FuzzyError;
pub use membership::Fuzzifier;
pub use metric::{MAX_ATTRIBUTES, Metric, Objects};

use metric::CentreUpdate;

/// How fuzzy, and how long.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FuzzyCMeansSettings {
    /// q.
    pub fuzzifier: f64,
    /// Of the largest change of a membership.
    pub tolerance: f64,
    pub max_iterations: u32,
}

impl Default for FuzzyCMeansSettings {
    fn default() -> Self {
        FuzzyCMeansSettings {
            fuzzifier: 2.0,
            tolerance: 1e-4,
            max_iterations: 100,
        }
    }
}

impl FuzzyCMeansSettings {
    /// # Errors
    /// The first value out of its range.
    pub fn check(&self) -> Result<(), FuzzyError> {
        Fuzzifier::new(self.fuzzifier)?;
        if !(self.tolerance.is_finite() && self.tolerance > 0.0) {
            return Err(FuzzyError::Tolerance(self.tolerance));
        }
        if self.max_iterations == 0 {
            return Err(FuzzyError::MaxIterations);
        }
        Ok(())
    }
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClusteringResult {
    /// How often the centres were moved.
    pub iterations: u32,
    /// Whether the memberships stayed within the tolerance at last.
    pub converged: bool,
    /// J at the end.
    pub cost: f64,
}

/// What an observer is shown: the state after an iteration, 0 being that of the initial centres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IterationState<'a> {
    pub iteration: u32,
    /// J.
    pub cost: f64,
    /// u_ik at `k * c + i`.
    pub memberships: &'a [f64],
    /// v_i from `i * m` on.
    pub centres: &'a [f64],
}

/// Runs fuzzy c-means on one set of objects after another, and holds the result of the last run.
#[derive(Debug, Clone)]
pub struct FuzzyCMeans {
    settings: FuzzyCMeansSettings,
    fuzzifier: Fuzzifier,
    clusters: usize,
    memberships: Vec<f64>,
    before: Vec<f64>,
    squared_distances: Vec<f64>,
    centres: Vec<f64>,
    costs: Vec<f64>,
    update: CentreUpdate,
}

impl FuzzyCMeans {
    /// # Errors
    /// The first setting out of its range.
    pub fn new(settings: FuzzyCMeansSettings) -> Result<Self, FuzzyError> {
        settings.check()?;
        Ok(FuzzyCMeans {
            settings,
            fuzzifier: Fuzzifier::new(settings.fuzzifier)?,
            clusters: 0,
            memberships: Vec::new(),
            before: Vec::new(),
            squared_distances: Vec::new(),
            centres: Vec::new(),
            costs: Vec::new(),
            update: CentreUpdate::default(),
        })
    }

    /// Clusters the objects from the given initial centres, c times m values.
    ///
    /// # Errors
    /// c outside 2 to n, or an initial value that is not finite.
    pub fn run(
        &mut self,
        objects: &Objects,
        initial: &[f64],
    ) -> Result<ClusteringResult, FuzzyError> {
        self.run_observed(objects, initial, |_| {})
    }

    /// The same, showing each iteration to an observer.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn run_observed(
        &mut self,
        objects: &Objects,
        initial: &[f64],
        mut observe: impl FnMut(&IterationState),
    ) -> Result<ClusteringResult, FuzzyError> {
        self.begin(objects, initial)?;
        let mut outcome = ClusteringResult {
            iterations: 0,
            converged: false,
            cost: self.show(0, &mut observe),
        };
        while !outcome.converged && outcome.iterations < self.settings.max_iterations {
            std::mem::swap(&mut self.memberships, &mut self.before);
            self.update
                .centres(objects, self.fuzzifier, &self.before, &mut self.centres);
            self.share(objects);
            outcome.iterations += 1;
            outcome.converged =
                largest_change(&self.before, &self.memberships) <= self.settings.tolerance;
            outcome.cost = self.show(outcome.iterations, &mut observe);
        }
        Ok(outcome)
    }

    /// J of the best memberships for these centres, which stay where they are.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn judge(&mut self, objects: &Objects, centres: &[f64]) -> Result<f64, FuzzyError> {
        self.begin(objects, centres)?;
        Ok(self.show(0, &mut |_| {}))
    }

    /// Step 1.
    fn begin(&mut self, objects: &Objects, initial: &[f64]) -> Result<(), FuzzyError> {
        let attributes = objects.attributes();
        if !initial.len().is_multiple_of(attributes) {
            return Err(FuzzyError::Length {
                field: "initial",
                found: initial.len(),
                wanted: "a multiple of the attributes",
            });
        }
        let clusters = initial.len() / attributes;
        check_clusters(clusters, objects.len())?;
        if let Some(place) = initial.iter().position(|value| !value.is_finite()) {
            return Err(FuzzyError::Centre {
                centre: place / attributes,
                attribute: place % attributes,
            });
        }
        self.clusters = clusters;
        self.centres.clear();
        self.centres.extend_from_slice(initial);
        self.costs.clear();
        let size = clusters * objects.len();
        for values in [
            &mut self.memberships,
            &mut self.before,
            &mut self.squared_distances,
        ] {
            values.clear();
            values.resize(size, 0.0);
        }
        self.share(objects);
        Ok(())
    }

    /// Distances and memberships for the present centres.
    fn share(&mut self, objects: &Objects) {
        objects.squared_distances(&self.centres, &mut self.squared_distances);
        let rows = self
            .squared_distances
            .chunks_exact(self.clusters)
            .zip(self.memberships.chunks_exact_mut(self.clusters));
        rows.for_each(|(squared, memberships)| self.fuzzifier.share(squared, memberships));
    }

    /// J, remembered and shown.
    fn show(&mut self, iteration: u32, observe: &mut impl FnMut(&IterationState)) -> f64 {
        let pairs = self.memberships.iter().zip(&self.squared_distances);
        let cost = pairs
            .map(|(&membership, &squared)| self.fuzzifier.raise(membership) * squared)
            .sum();
        self.costs.push(cost);
        observe(&IterationState {
            iteration,
            cost,
            memberships: &self.memberships,
            centres: &self.centres,
        });
        cost
    }

    pub fn settings(&self) -> FuzzyCMeansSettings {
        self.settings
    }

    /// c of the last run.
    pub fn clusters(&self) -> usize {
        self.clusters
    }

    /// u_ik of the last run at `k * c + i`.
    pub fn memberships(&self) -> &[f64] {
        &self.memberships
    }

    /// d_ik² of the last run at `k * c + i`.
    pub fn squared_distances(&self) -> &[f64] {
        &self.squared_distances
    }

    /// v_i of the last run from `i * m` on.
    pub fn centres(&self) -> &[f64] {
        &self.centres
    }

    /// J of the last run: of the initial centres, then after each iteration.
    pub fn costs(&self) -> &[f64] {
        &self.costs
    }
}

/// # Errors
/// c outside 2 to n.
pub(crate) fn check_clusters(clusters: usize, objects: usize) -> Result<(), FuzzyError> {
    if (2..=objects).contains(&clusters) {
        Ok(())
    } else {
        Err(FuzzyError::Clusters {
            found: clusters,
            objects,
        })
    }
}

/// max |U(l+1) − U(l)|.
pub fn largest_change(before: &[f64], after: &[f64]) -> f64 {
    before
        .iter()
        .zip(after)
        .fold(0.0, |largest, (before, after)| {
            (before - after).abs().max(largest)
        })
}
