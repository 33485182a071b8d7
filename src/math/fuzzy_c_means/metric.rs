//! The objects, how far they are from a centre, and the centres that fit them best.
//!
//! # Symbols
//! W_k inverse covariance of object k; w = u^q; δ_k = x_k − v, where an angle takes the way round that makes the distance
//! least: the shorter one, unless W_k ties the angle to an attribute that is far off.
//!
//! # Method
//! The centre of a cluster minimises Σ_k w_k δ_kᵀ W_k δ_k.
//! - One scale for all objects: the mean Σ w x / Σ w, whatever the scale is.
//! - An inverse covariance for each object: the information-weighted mean (Σ w W_k)⁻¹ Σ w W_k x_k. The plain mean would
//!   not be the minimum, and J could rise.
//! - Both are computed as a step from the present centre, v + (Σ w W_k)⁻¹ Σ w W_k δ_k. With angles this is the wrapped
//!   mean about v, one round of it an iteration of the whole: the quadratic with the turns of δ_k held fixed is an upper
//!   bound of the true sum that touches it at v, so J cannot rise. Where covariances tie several angles to each other the
//!   turns are chosen one after the other and need not be the least: there a step that would raise J is halved until it
//!   does not.

use super::{Fuzzifier, FuzzyError};
use crate::model::angle::wrap;
use std::f64::consts::TAU;

/// m at most.
pub const MAX_ATTRIBUTES: usize = 16;

/// How attributes of different kinds are made comparable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Metric<'a> {
    /// σ of each attribute: d² = Σ_a ((x_a − v_a) / σ_a)².
    Scaled(&'a [f64]),
    /// The inverse covariance of each object, n times m × m values: d² = δᵀ W_k δ (Mahalanobis).
    Mahalanobis(&'a [f64]),
}

/// n objects of m attributes, checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Objects<'a> {
    attributes: usize,
    values: &'a [f64],
    metric: Metric<'a>,
    angles: &'a [bool],
    has_angles: bool,
}

impl<'a> Objects<'a> {
    /// `values` are the attributes of the first object, then of the second and so on; `angles` says of each attribute
    /// whether it goes round at 2π (rad).
    ///
    /// # Errors
    /// Values that are not finite, a σ that is not positive, a matrix that is no inverse covariance, wrong lengths.
    pub fn new(
        values: &'a [f64],
        angles: &'a [bool],
        metric: Metric<'a>,
    ) -> Result<Self, FuzzyError> {
        let attributes = angles.len();
        if !(1..=MAX_ATTRIBUTES).contains(&attributes) || !values.len().is_multiple_of(attributes) {
            return Err(FuzzyError::Length {
                field: "objects",
                found: values.len(),
                wanted: "a multiple of the attributes, which are 1 to 16",
            });
        }
        if let Some(place) = values.iter().position(|value| !value.is_finite()) {
            return Err(FuzzyError::Object {
                object: place / attributes,
                attribute: place % attributes,
            });
        }
        let objects = Objects {
            attributes,
            values,
            metric,
            angles,
            has_angles: angles.contains(&true),
        };
        objects.check_metric()?;
        Ok(objects)
    }

    fn check_metric(&self) -> Result<(), FuzzyError> {
        match self.metric {
            Metric::Scaled(sigmas) if sigmas.len() != self.attributes => Err(FuzzyError::Length {
                field: "sigmas",
                found: sigmas.len(),
                wanted: "one for each attribute",
            }),
            Metric::Scaled(sigmas) => match sigmas
                .iter()
                .position(|sigma| !(sigma.is_finite() && *sigma > 0.0))
            {
                Some(attribute) => Err(FuzzyError::Sigma {
                    attribute,
                    found: sigmas[attribute],
                }),
                None => Ok(()),
            },
            Metric::Mahalanobis(inverses)
                if inverses.len() != self.values.len() * self.attributes =>
            {
                Err(FuzzyError::Length {
                    field: "inverses",
                    found: inverses.len(),
                    wanted: "a square matrix for each object",
                })
            }
            Metric::Mahalanobis(inverses) => {
                let (mut factor, size) = (Vec::new(), self.attributes * self.attributes);
                let is_wrong = |inverse: &[f64]| {
                    !is_symmetric(inverse, self.attributes)
                        || !factorise(inverse, self.attributes, &mut factor)
                };
                inverses
                    .chunks_exact(size)
                    .position(is_wrong)
                    .map_or(Ok(()), |object| Err(FuzzyError::Inverse { object }))
            }
        }
    }

    /// n.
    pub fn len(&self) -> usize {
        self.values.len() / self.attributes
    }

    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// m.
    pub fn attributes(&self) -> usize {
        self.attributes
    }

    /// x_k.
    pub fn object(&self, object: usize) -> &'a [f64] {
        &self.values[object * self.attributes..][..self.attributes]
    }

    pub fn metric(&self) -> Metric<'a> {
        self.metric
    }

    /// W_k.
    fn inverse(&self, inverses: &'a [f64], object: usize) -> &'a [f64] {
        let size = self.attributes * self.attributes;
        &inverses[object * size..][..size]
    }

    /// x_a − v_a.
    #[inline]
    pub(super) fn difference(&self, attribute: usize, left: f64, right: f64) -> f64 {
        let difference = left - right;
        if self.has_angles && self.angles[attribute] {
            wrap(difference)
        } else {
            difference
        }
    }

    /// d² of an object from any point.
    pub fn squared_distance(&self, object: usize, point: &[f64]) -> f64 {
        let values = self.object(object);
        match self.metric {
            Metric::Scaled(sigmas) => self.scaled(values, point, sigmas),
            Metric::Mahalanobis(inverses) => {
                self.quadratic(values, point, self.inverse(inverses, object))
            }
        }
    }

    #[inline]
    pub(super) fn scaled(&self, left: &[f64], right: &[f64], sigmas: &[f64]) -> f64 {
        let mut sum = 0.0;
        for attribute in 0..self.attributes {
            let scaled =
                self.difference(attribute, left[attribute], right[attribute]) / sigmas[attribute];
            sum += scaled * scaled;
        }
        sum
    }

    /// δᵀ W δ; W is symmetric and positive definite, so less than 0 is rounding.
    pub(super) fn quadratic(&self, left: &[f64], right: &[f64], inverse: &[f64]) -> f64 {
        let differences = self.turned(left, right, inverse);
        let mut sum = 0.0;
        for row in 0..self.attributes {
            let first = differences[row];
            sum += inverse[row * self.attributes + row] * first * first;
            for column in row + 1..self.attributes {
                sum += 2.0 * inverse[row * self.attributes + column] * first * differences[column];
            }
        }
        sum.max(0.0)
    }

    /// δ. An angle gains the whole turns that bring it nearest to −(Σ_b W_ab δ_b) / W_aa, b ≠ a, where δᵀ W δ is least.
    #[inline]
    pub(super) fn turned(
        &self,
        left: &[f64],
        right: &[f64],
        inverse: &[f64],
    ) -> [f64; MAX_ATTRIBUTES] {
        let mut differences = [0.0; MAX_ATTRIBUTES];
        for attribute in 0..self.attributes {
            differences[attribute] = self.difference(attribute, left[attribute], right[attribute]);
        }
        if self.has_angles {
            for angle in (0..self.attributes).filter(|&attribute| self.angles[attribute]) {
                let row = &inverse[angle * self.attributes..][..self.attributes];
                let slope: f64 = row
                    .iter()
                    .zip(&differences)
                    .map(|(inverse, difference)| inverse * difference)
                    .sum();
                differences[angle] -= TAU * (slope / row[angle] / TAU).round();
            }
        }
        differences
    }

    /// d_ik² at `k * c + i`.
    pub(super) fn squared_distances(&self, centres: &[f64], squared_distances: &mut [f64]) {
        let clusters = centres.len() / self.attributes;
        for (object, row) in squared_distances.chunks_exact_mut(clusters).enumerate() {
            for (squared, centre) in row.iter_mut().zip(centres.chunks_exact(self.attributes)) {
                *squared = self.squared_distance(object, centre);
            }
        }
    }
}

/// Moves centres; holds the memory for it.
#[derive(Debug, Clone, Default)]
pub(super) struct CentreUpdate {
    /// Σ w W_k.
    information: Vec<f64>,
    /// Its Cholesky factor.
    factor: Vec<f64>,
    /// Σ w W_k δ_k, then the step.
    step: Vec<f64>,
    trial: Vec<f64>,
}

/// Halvings of a step that would raise J; after them the centre stays.
const MOST_HALVINGS: u32 = 30;

/// By how much a sum may seem to have risen, relative to itself, when it has not.
const ROUNDING: f64 = 1e-13;

impl CentreUpdate {
    /// Moves each centre to where it fits the memberships best, or with angles one round nearer.
    pub(super) fn centres(
        &mut self,
        objects: &Objects,
        fuzzifier: Fuzzifier,
        memberships: &[f64],
        centres: &mut [f64],
    ) {
        let clusters = centres.len() / objects.attributes;
        for (cluster, centre) in centres.chunks_exact_mut(objects.attributes).enumerate() {
            let weight = |object: usize| fuzzifier.raise(memberships[object * clusters + cluster]);
            match objects.metric {
                Metric::Scaled(_) => self.mean(objects, weight, centre),
                Metric::Mahalanobis(inverses) => {
                    self.informed_mean(objects, inverses, weight, centre)
                }
            }
        }
    }

    fn mean(&mut self, objects: &Objects, weight: impl Fn(usize) -> f64, centre: &mut [f64]) {
        self.step.clear();
        self.step.resize(objects.attributes, 0.0);
        let mut total = 0.0;
        for object in 0..objects.len() {
            let weight = weight(object);
            total += weight;
            let values = objects.object(object);
            for attribute in 0..objects.attributes {
                self.step[attribute] +=
                    weight * objects.difference(attribute, values[attribute], centre[attribute]);
            }
        }
        // A centre to which nothing belongs stays where it is.
        if total > 0.0 {
            self.step.iter_mut().for_each(|step| *step /= total);
            walk(objects, &self.step, 1.0, centre);
        }
    }

    fn informed_mean(
        &mut self,
        objects: &Objects,
        inverses: &[f64],
        weight: impl Fn(usize) -> f64,
        centre: &mut [f64],
    ) {
        self.sum_information(objects, inverses, &weight, centre);
        if !factorise(&self.information, objects.attributes, &mut self.factor) {
            return;
        }
        solve(&self.factor, objects.attributes, &mut self.step);
        if objects.angles.iter().filter(|&&is_angle| is_angle).count() < 2 {
            walk(objects, &self.step, 1.0, centre);
            return;
        }
        let cost = |point: &[f64]| {
            (0..objects.len())
                .map(|object| weight(object) * objects.squared_distance(object, point))
                .sum::<f64>()
        };
        let before = cost(centre);
        for halvings in 0..MOST_HALVINGS {
            self.trial.clear();
            self.trial.extend_from_slice(centre);
            walk(
                objects,
                &self.step,
                0.5f64.powi(halvings as i32),
                &mut self.trial,
            );
            if cost(&self.trial) <= before * (1.0 + ROUNDING) {
                centre.copy_from_slice(&self.trial);
                return;
            }
        }
    }

    /// Σ w W_k and Σ w W_k δ_k.
    fn sum_information(
        &mut self,
        objects: &Objects,
        inverses: &[f64],
        weight: &impl Fn(usize) -> f64,
        centre: &[f64],
    ) {
        let size = objects.attributes;
        for (values, length) in [(&mut self.information, size * size), (&mut self.step, size)] {
            values.clear();
            values.resize(length, 0.0);
        }
        let inverse_of = |object: usize| &inverses[object * size * size..][..size * size];
        for object in 0..objects.len() {
            let (weight, inverse, values) =
                (weight(object), inverse_of(object), objects.object(object));
            let differences = objects.turned(values, centre, inverse);
            for row in 0..size {
                for column in 0..size {
                    let information = weight * inverse[row * size + column];
                    self.information[row * size + column] += information;
                    self.step[row] += information * differences[column];
                }
            }
        }
    }
}

/// v + a step's part; angles are brought back into one turn.
fn walk(objects: &Objects, step: &[f64], part: f64, centre: &mut [f64]) {
    for attribute in 0..objects.attributes {
        let moved = centre[attribute] + part * step[attribute];
        centre[attribute] = if objects.angles[attribute] {
            wrap(moved)
        } else {
            moved
        };
    }
}

fn is_symmetric(matrix: &[f64], size: usize) -> bool {
    let close = |left: f64, right: f64| (left - right).abs() <= 1e-9 * left.abs().max(right.abs());
    (0..size).all(|row| {
        (0..row).all(|column| close(matrix[row * size + column], matrix[column * size + row]))
    })
}

/// Cholesky's lower factor; false when the matrix is not positive definite.
fn factorise(matrix: &[f64], size: usize, factor: &mut Vec<f64>) -> bool {
    factor.clear();
    factor.resize(size * size, 0.0);
    for row in 0..size {
        for column in 0..=row {
            let inner: f64 = (0..column)
                .map(|inner| factor[row * size + inner] * factor[column * size + inner])
                .sum();
            let rest = matrix[row * size + column] - inner;
            if row != column {
                factor[row * size + column] = rest / factor[column * size + column];
            } else if rest.is_finite() && rest > 0.0 {
                factor[row * size + row] = rest.sqrt();
            } else {
                return false;
            }
        }
    }
    true
}

/// Solves L Lᵀ x = b in place of b.
fn solve(factor: &[f64], size: usize, values: &mut [f64]) {
    for row in 0..size {
        let known: f64 = (0..row)
            .map(|column| factor[row * size + column] * values[column])
            .sum();
        values[row] = (values[row] - known) / factor[row * size + row];
    }
    for row in (0..size).rev() {
        let known: f64 = (row + 1..size)
            .map(|column| factor[column * size + row] * values[column])
            .sum();
        values[row] = (values[row] - known) / factor[row * size + row];
    }
}
