//! Targets that were never detected, as a Poisson process, and tracks that begin from it: the Poisson multi-Bernoulli filter.
//!
//! # Reference
//! J. L. Williams, Marginal Multi-Bernoulli Filters: RFS Derivation of MHT, JIPDA, and Association-Based MeMBer, IEEE Transactions
//! on Aerospace and Electronic Systems 51(3), 2015 (the track-oriented filter, TOMB/P); J. L. Williams, Hybrid Poisson and
//! Multi-Bernoulli Filters, 15th International Conference on Information Fusion, 2012 (recycling).
//!
//! # Symbols
//! D the intensity of undetected targets: Gaussian parts of weight w, and a density ρ that is the same everywhere; uⱼ intensity of
//! detections of them at detection j; λ clutter density; βⱼ sum of all tracks' weights of detection j; p_S, P_D, N as in
//! [`super::existence`].
//!
//! # Method
//! 1. w ← p_S w, each part is predicted, and the births are added.
//! 2. uⱼ = P_D Σ w N(zⱼ) + P_D ρ. In the problem of the tracks λ + uⱼ stands for λ. A part keeps w (1 − P_D).
//! 3. What the tracks leave of a detection begins one: r = (1 − βⱼ) uⱼ / (λ + uⱼ), with the moments of the parts that it updated.
//!    Births that are counted have uⱼ = λ (1 + b) / (1 + c).
//! 4. A track with r below `recycle_existence` is a part of D with w = r.
//!
//! Parts below [`LEAST_WEIGHT`] are dropped, and beyond [`MOST_PARTS`] the lightest.

mod begin;
mod settings;

pub use settings::{Births, UNDETECTED, Undetected};

use super::existence::survival;
use crate::filtering::Filter;
use crate::model::state::GaussianState;
use crate::tracking::bits;
use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

const LEAST_WEIGHT: f64 = 1e-5;
const MOST_PARTS: usize = 2000;

/// D.
#[derive(Debug, Clone)]
pub(super) struct Intensity<B> {
    /// w of each part.
    weights: Vec<f64>,
    beliefs: Vec<B>,
    /// ρ, per unit of the sensors' clutter.
    density: f64,
}

impl<B> Default for Intensity<B> {
    fn default() -> Self {
        Intensity {
            weights: Vec::new(),
            beliefs: Vec::new(),
            density: 0.0,
        }
    }
}

impl<B: Copy> Intensity<B> {
    pub fn push(&mut self, weight: f64, belief: B) {
        if weight >= LEAST_WEIGHT {
            self.weights.push(weight);
            self.beliefs.push(belief);
        }
    }

    /// Step 1. The first scan has the targets that are there at the start.
    fn advance<F: Filter<K, Belief = B>, const K: usize>(
        &mut self,
        filter: &F,
        rule: &Undetected,
        (dt_s, is_first): (f64, bool),
    ) {
        self.prune();
        let (step, survival) = (filter.step(dt_s), survival(dt_s, rule.lifetime_s));
        self.density *= survival;
        for (weight, belief) in self.weights.iter_mut().zip(&mut self.beliefs) {
            *weight *= survival;
            F::predict(&step, belief);
        }
        let expected = |per_s: f64, at_start: f64| if is_first { at_start } else { per_s * dt_s };
        match &rule.births {
            Births::Counted => {}
            Births::Uniform {
                birth_per_m2_s,
                initial_per_m2,
            } => self.density += expected(*birth_per_m2_s, *initial_per_m2),
            Births::Gaussian { components } => {
                for birth in components {
                    let weight = expected(birth.expected_per_s, birth.expected_at_start);
                    self.push(weight, filter.begin(&birth.kinematics::<K>()));
                }
            }
        }
    }

    /// Drops what is too light to matter.
    fn prune(&mut self) {
        let mut least = LEAST_WEIGHT;
        if self.weights.len() > MOST_PARTS {
            let mut sorted = self.weights.clone();
            sorted.sort_by(|a, b| b.total_cmp(a));
            least = least.max(sorted[MOST_PARTS - 1]);
        }
        let mut kept = 0;
        for at in 0..self.weights.len() {
            if self.weights[at] >= least && kept < MOST_PARTS {
                self.weights[kept] = self.weights[at];
                self.beliefs[kept] = self.beliefs[at];
                kept += 1;
            }
        }
        self.weights.truncate(kept);
        self.beliefs.truncate(kept);
    }

    pub fn write<F: Filter<K, Belief = B>, const K: usize>(&self) -> WrittenIntensity {
        let pack = |belief: &B| {
            let mut values = Vec::new();
            F::pack(belief, &mut values);
            bits::of(&values)
        };
        WrittenIntensity {
            weights: bits::of(&self.weights),
            beliefs: self.beliefs.iter().map(pack).collect(),
            density: self.density,
        }
    }

    /// `None` for what no intensity wrote.
    pub fn read<F: Filter<K, Belief = B>, const K: usize>(
        written: &WrittenIntensity,
    ) -> Option<Self> {
        let beliefs = written.beliefs.iter();
        let beliefs: Option<Vec<B>> = beliefs.map(|bits| F::unpack(&bits::values(bits))).collect();
        let (weights, beliefs) = (bits::values(&written.weights), beliefs?);
        (weights.len() == beliefs.len()).then_some(Intensity {
            weights,
            beliefs,
            density: written.density,
        })
    }
}

#[derive(Default, Serialize, Deserialize)]
pub(super) struct WrittenIntensity {
    weights: Vec<u64>,
    beliefs: Vec<Vec<u64>>,
    #[serde(with = "bits")]
    density: f64,
}

/// What a detection would make of the parts of D.
#[derive(Debug, Clone, Copy)]
pub(super) struct Newborn<B, const K: usize> {
    /// uⱼ / λ.
    ratio: f64,
    /// Sums over the parts, by their share of the ratio: of means, and of squares about the first part's mean.
    origin: SVector<f64, K>,
    mean: SVector<f64, K>,
    square: SMatrix<f64, K, K>,
    /// Of the only part, as long as there is one alone.
    only: Option<B>,
}

impl<B: Copy, const K: usize> Newborn<B, K> {
    fn none() -> Self {
        Newborn {
            ratio: 0.0,
            origin: SVector::zeros(),
            mean: SVector::zeros(),
            square: SMatrix::zeros(),
            only: None,
        }
    }

    fn add<F: Filter<K, Belief = B>>(&mut self, ratio: f64, belief: B) {
        let state = F::kinematics(&belief);
        if self.ratio == 0.0 {
            self.origin = state.mean;
            self.only = Some(belief);
        } else {
            self.only = None;
        }
        let offset = state.mean - self.origin;
        self.ratio += ratio;
        self.mean += offset * ratio;
        self.square += (state.covariance + offset * offset.transpose()) * ratio;
    }

    /// How probably the detection is clutter if no track wants it.
    pub fn clutter(&self) -> f64 {
        1.0 / (1.0 + self.ratio)
    }

    /// What is believed of a target of which this is the first detection.
    fn belief<F: Filter<K, Belief = B>>(&self, filter: &F) -> B {
        self.only.unwrap_or_else(|| {
            let offset = self.mean / self.ratio;
            filter.begin(&GaussianState {
                mean: self.origin + offset,
                covariance: self.square / self.ratio - offset * offset.transpose(),
            })
        })
    }
}

#[cfg(test)]
mod tests;
