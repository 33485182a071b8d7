//! Random problems of track correlation: targets in a plane, and what each sensor makes of them.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::sync::Arc;
use trackloom_domain::correlation::estimates::Estimates;
use trackloom_domain::correlation::evidence::{Evidence, Times};
use trackloom_domain::correlation::problem::{CorrelationProblem, Costs, JointCost};
use trackloom_domain::math::rng::{Purpose, Seed};
use trackloom_domain::model::state::{Covariance, GaussianState, State};

/// δ, the 0.99 quantile of chi-square with 2 degrees of freedom; and the gate, beyond which 1e-6 of the true pairs lie.
pub const DELTA: f64 = 9.210_340_371_976_184;
const GATE: f64 = 27.631_021_115_928_547;

/// Targets lie uniformly in a square of `spacing`² for each; errors have a standard deviation of 0.7 to 1.4.
#[derive(Debug, Clone, Copy)]
pub struct Scene {
    pub sensors: usize,
    pub targets: usize,
    pub spacing: f64,
    pub detection_probability: f64,
    /// False tracks of a sensor for each target.
    pub false_share: f64,
}

/// What a sensor says of a target: a position and the variance of both its coordinates.
#[derive(Debug, Clone, Copy)]
pub struct Estimate {
    pub position: [f64; 2],
    pub variance: f64,
}

impl Scene {
    /// The estimates of each sensor.
    pub fn estimates(&self, number: u32) -> Vec<Vec<Estimate>> {
        let mut dice = Seed {
            seed: number,
            run: 0,
        }
        .stream(Purpose::TargetStart, 0, 0);
        let side = self.spacing * (self.targets as f64).sqrt();
        let place =
            |dice: &mut ChaCha8Rng| [dice.random_range(0.0..side), dice.random_range(0.0..side)];
        let truth: Vec<[f64; 2]> = (0..self.targets).map(|_| place(&mut dice)).collect();
        let of_sensor = |_| {
            let mut tracks = Vec::new();
            for target in &truth {
                if dice.random_bool(self.detection_probability) {
                    let sigma: f64 = dice.random_range(0.7..1.4);
                    let mut error = || -> f64 {
                        sigma * Distribution::<f64>::sample(&StandardNormal, &mut dice)
                    };
                    tracks.push(Estimate {
                        position: [target[0] + error(), target[1] + error()],
                        variance: sigma * sigma,
                    });
                }
                if dice.random_bool(self.false_share) {
                    tracks.push(Estimate {
                        position: place(&mut dice),
                        variance: 1.0,
                    });
                }
            }
            tracks
        };
        (0..self.sensors).map(of_sensor).collect()
    }

    pub fn chain(&self, number: u32) -> CorrelationProblem {
        problem(&self.estimates(number), Costs::Chain)
    }

    pub fn all_pairs(&self, number: u32) -> CorrelationProblem {
        problem(&self.estimates(number), Costs::AllPairs)
    }

    pub fn fused(&self, number: u32) -> CorrelationProblem {
        let estimates = self.estimates(number);
        let fused = Fused {
            estimates: estimates.concat(),
        };
        problem(&estimates, Costs::Joint(Box::new(fused)))
    }
}

/// Links with λ = dᵀ (Pᵢ + Pⱼ)⁻¹ d within the gate, of cost λ − δ.
pub fn problem(estimates: &[Vec<Estimate>], costs: Costs) -> CorrelationProblem {
    let counts: Vec<usize> = estimates.iter().map(Vec::len).collect();
    let all: Vec<(usize, &Estimate)> = estimates
        .iter()
        .enumerate()
        .flat_map(|(sensor, tracks)| tracks.iter().map(move |track| (sensor, track)))
        .collect();
    let mut pairs = Vec::new();
    for (a, (sensor, left)) in all.iter().enumerate() {
        for (b, (_, right)) in all
            .iter()
            .enumerate()
            .skip(a + 1)
            .filter(|(_, (other, _))| other != sensor)
        {
            let squared =
                squared_distance(left.position, right.position) / (left.variance + right.variance);
            if squared < GATE {
                pairs.push((a as u32, b as u32, squared - DELTA));
            }
        }
    }
    CorrelationProblem::new(&counts, &pairs, costs).with_evidence(evidence(estimates))
}

/// The same estimates for correlators that look at tracks: positions, at one time.
fn evidence(estimates: &[Vec<Estimate>]) -> Evidence {
    let named = estimates
        .iter()
        .map(|tracks| (String::new(), vec![String::new(); tracks.len()]))
        .collect();
    let mut table = Estimates::new(named, vec![0.0], false);
    for (track, estimate) in estimates.iter().flatten().enumerate() {
        let mean = State::new(estimate.position[0], estimate.position[1], 0.0, 0.0);
        table.set(
            track,
            0,
            &GaussianState {
                mean,
                covariance: Covariance::identity() * estimate.variance,
            },
        );
    }
    Evidence {
        estimates: Arc::new(table),
        cross: None,
        times: Times::All,
        until: 1,
    }
}

fn squared_distance(left: [f64; 2], right: [f64; 2]) -> f64 {
    (left[0] - right[0]).powi(2) + (left[1] - right[1]).powi(2)
}

/// Q of the estimates about their weighted mean, less δ for each track but one.
struct Fused {
    estimates: Vec<Estimate>,
}

impl JointCost for Fused {
    fn cost(&self, tuple: &[u32]) -> f64 {
        let members = || tuple.iter().map(|&track| &self.estimates[track as usize]);
        let weight: f64 = members().map(|member| 1.0 / member.variance).sum();
        let mean = [0, 1].map(|axis| {
            members()
                .map(|member| member.position[axis] / member.variance)
                .sum::<f64>()
                / weight
        });
        let q: f64 = members()
            .map(|member| squared_distance(member.position, mean) / member.variance)
            .sum();
        q - (tuple.len() - 1) as f64 * DELTA
    }
}
