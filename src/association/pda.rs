//! Probabilistic data association: each track for itself weighs the detections in its gate by how probable it is that
//! each is its target's, and "none" by how probable it is that all are clutter. Other tracks are taken for clutter, too.
//!
//! # Reference
//! Y. Bar-Shalom, T. E. Fortmann, Tracking and Data Association, 1988, section 6.3; Y. Bar-Shalom, X.-R. Li,
//! Multitarget-Multisensor Tracking, 1995, section 3.4.
//!
//! # Symbols
//! P_D, P_G probability of detection and of the gate; λ clutter density; N(νⱼ; 0, S) density of an innovation; m detections
//! in the gate, V its volume; βⱼ weight of a detection, β₀ of none.
//!
//! # Method
//! 1. Parametric: eⱼ = P_D N(νⱼ; 0, S) / λ, b = 1 − P_D P_G. Non-parametric: the same with m / V for λ.
//! 2. βⱼ = eⱼ / (b + Σ eⱼ), β₀ = b / (b + Σ eⱼ), in logarithms from the largest on, so that nothing overflows.

use super::problem::{Problem, Row, Weights};
use super::{Associator, BuildAssociator};
use crate::registry::{Kind, Method, Object, default};
use serde::Deserialize;

pub const METHOD: Method<BuildAssociator> = Method {
    name: "pda",
    parameters: &PARAMETERS,
    build: |spec, _| Ok(Box::new(Pda::deserialize(spec)?)),
};

static PARAMETERS: Object = Object {
    name: "Pda",
    summary: "Probabilistic data association: each track averages over the detections in its gate.",
    fields: &[default(
        "clutter",
        "parametric: clutter has the sensor's given density; nonparametric: the density of the detections in the gate.",
        Kind::Choice(&["parametric", "nonparametric"]),
        "\"parametric\"",
    )],
};

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Pda {
    clutter: Clutter,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Clutter {
    Parametric,
    Nonparametric,
}

impl Associator for Pda {
    fn is_soft(&self) -> bool {
        true
    }

    fn associate(&mut self, problem: &Problem, weights: &mut Weights) {
        for (index, row) in problem.rows() {
            weigh(
                problem,
                row,
                self.log_correction(row),
                &mut weights.missed[index],
                &mut weights.edges[row.edges()],
            );
        }
    }

    fn fork(&self) -> Box<dyn Associator> {
        Box::new(*self)
    }
}

impl Pda {
    /// What ln eⱼ must gain for the clutter density that was chosen: ln(λ V / m) turns λ into m / V.
    #[inline]
    fn log_correction(self, row: &Row) -> f64 {
        match self.clutter {
            Clutter::Parametric => 0.0,
            Clutter::Nonparametric => row.log_gate_clutter - f64::from(row.count).ln(),
        }
    }
}

/// Step 2.
#[inline]
fn weigh(problem: &Problem, row: &Row, log_correction: f64, missed: &mut f64, weights: &mut [f64]) {
    let edges = problem.edges_of(row);
    let largest = edges.iter().fold(row.log_missed, |largest, edge| {
        largest.max(edge.log_likelihood + log_correction)
    });
    *missed = (row.log_missed - largest).exp();
    let mut sum = *missed;
    for (weight, edge) in weights.iter_mut().zip(edges) {
        *weight = (edge.log_likelihood + log_correction - largest).exp();
        sum += *weight;
    }
    *missed /= sum;
    weights.iter_mut().for_each(|weight| *weight /= sum);
}

#[cfg(test)]
mod tests {
    use super::super::problem::{Edge, ScanProblem};
    use super::*;

    const PARAMETRIC: Pda = Pda {
        clutter: Clutter::Parametric,
    };
    const NONPARAMETRIC: Pda = Pda {
        clutter: Clutter::Nonparametric,
    };

    /// The weights of one track, β₀ first.
    fn weights_of(
        mut pda: Pda,
        log_likelihoods: &[f64],
        missed: f64,
        gate_clutter: f64,
    ) -> Vec<f64> {
        let mut problem = ScanProblem::default();
        problem.begin(0, log_likelihoods.len());
        for (detection, &log_likelihood) in log_likelihoods.iter().enumerate() {
            problem.push_edge(Edge {
                detection: detection as u32,
                squared_distance: 1.0,
                log_likelihood,
            });
        }
        problem.end_row(missed.ln(), gate_clutter.ln());
        let mut weights = Weights::default();
        weights.reset(&problem);
        problem.for_each_cluster(|cluster| pda.associate(cluster, &mut weights));
        let mut all = weights.missed;
        all.extend(weights.edges);
        all
    }

    fn assert_close(found: &[f64], expected: &[f64]) {
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            assert!(
                (found - expected).abs() < 1e-12,
                "{found} is not {expected}"
            );
        }
    }

    /// ln(P_D N(ν; 0, S) / λ) with P_D = 0.8, det S = 1, λ = 0.1.
    fn log_likelihood(squared_distance: f64) -> f64 {
        (0.8 * (-squared_distance / 2.0).exp() / std::f64::consts::TAU / 0.1).ln()
    }

    #[test]
    fn parametric_weights_by_hand() {
        // P_D = 0.8, P_G = 0.9: b = 1 − 0.72 = 0.28. det S = 1: N = e^(−d²/2) / 2π.
        // d² = 2 ln 2 halves the peak, d² = 2 ln 4 quarters it: e₁ = 0.8 / (2 · 2π · 0.1) = 4 / 2π = 0.636620,
        // e₂ = 2 / 2π = 0.318310. Sum with b: 1.234930. β = 0.226734, 0.515511, 0.257755.
        let found = weights_of(
            PARAMETRIC,
            &[
                log_likelihood(2.0 * 2f64.ln()),
                log_likelihood(2.0 * 4f64.ln()),
            ],
            0.28,
            1.0,
        );
        let half_turn = std::f64::consts::PI;
        let sum = 0.28 + 3.0 / half_turn;
        assert_close(
            &found,
            &[0.28 / sum, 2.0 / half_turn / sum, 1.0 / half_turn / sum],
        );
        assert!(
            (found[0] - 0.226_734).abs() < 1e-6
                && (found[1] - 0.515_511).abs() < 1e-6
                && (found[2] - 0.257_755).abs() < 1e-6
        );
    }

    #[test]
    fn nonparametric_weights_by_hand() {
        // The same gate with V = 5, so λ V = 0.5 where m = 2 detections fell: the density is 0.4 instead of 0.1, and e₁, e₂
        // are a quarter: 0.159155, 0.079577. Sum with b: 0.518732. β = 0.539777, 0.306815, 0.153407.
        let found = weights_of(
            NONPARAMETRIC,
            &[
                log_likelihood(2.0 * 2f64.ln()),
                log_likelihood(2.0 * 4f64.ln()),
            ],
            0.28,
            0.5,
        );
        let half_turn = std::f64::consts::PI;
        let sum = 0.28 + 0.75 / half_turn;
        assert_close(
            &found,
            &[0.28 / sum, 0.5 / half_turn / sum, 0.25 / half_turn / sum],
        );
        assert!(
            (found[0] - 0.539_777).abs() < 1e-6
                && (found[1] - 0.306_815).abs() < 1e-6
                && (found[2] - 0.153_407).abs() < 1e-6
        );
    }

    #[test]
    fn extreme_likelihoods_neither_overflow_nor_vanish() {
        assert_close(
            &weights_of(PARAMETRIC, &[2000.0, 2000.0], 0.1, 1.0),
            &[0.0, 0.5, 0.5],
        );
        assert_close(&weights_of(PARAMETRIC, &[-2000.0], 0.1, 1.0), &[1.0, 0.0]);
        let equal = weights_of(
            PARAMETRIC,
            &[-2000.0],
            (-2000.0f64).exp().max(f64::MIN_POSITIVE),
            1.0,
        );
        assert!((equal.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
