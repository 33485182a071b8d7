//! Memory that the tracker writes anew at each scan.

use super::multi_scan::{Choice, Ways};
use super::undetected::Newborn;
use crate::association::Needs;
use crate::association::problem::Weights;
use crate::filtering::{Filter, Weighted};
use crate::hypotheses::Hypotheses;
use crate::model::state::GaussianState;
use crate::model::track::Candidate;

pub(super) struct Scratch<F: Filter<K>, const K: usize> {
    pub hypotheses: Hypotheses<F, K>,
    pub weights: Weights,
    /// Indices of the tracks that are confirmed, and of the others.
    pub members: [Vec<u32>; 2],
    pub weighted: Vec<Weighted<F::Change>>,
    pub candidates: Vec<Candidate>,
    /// Of the point that is told.
    pub kinematics: Vec<f64>,
    pub belief: Vec<f64>,
    /// What of each detection the tracks left over that chose first.
    pub left: Vec<f64>,
    /// What each detection would make of undetected targets.
    pub newborn: Vec<Newborn<F::Belief, K>>,
    /// Of tracks that begin over several scans.
    pub ways: Ways<F, K>,
    pub choice: Choice<F::Belief>,
}

impl<F: Filter<K>, const K: usize> Scratch<F, K> {
    pub fn new(gate_probability: f64, needs: Needs) -> Self {
        Scratch {
            hypotheses: Hypotheses::new(gate_probability, needs),
            weights: Weights::default(),
            members: Default::default(),
            weighted: Vec::new(),
            candidates: Vec::new(),
            kinematics: Vec::new(),
            belief: Vec::new(),
            left: Vec::new(),
            newborn: Vec::new(),
            ways: Ways::new(gate_probability, needs),
            choice: Choice::default(),
        }
    }

    /// Packs what is told of a point: its kinematics, and the belief where tracks are smoothed afterwards.
    pub fn pack(&mut self, kinematics: &GaussianState<K>, belief: Option<&F::Belief>) {
        self.kinematics.clear();
        kinematics.pack_into(&mut self.kinematics);
        self.belief.clear();
        if let Some(belief) = belief {
            F::pack(belief, &mut self.belief);
        }
    }
}
