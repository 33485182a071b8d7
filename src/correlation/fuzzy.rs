//! Fuzzy c-means: targets are clusters, and each track belongs to every target near it, the nearer the more. In the end each
//! sensor's tracks go to different targets, so that the memberships are largest.
//!
//! # Reference
//! Cai Yubao et al., Application of fuzzy data association algorithm on multitarget tracking (memberships and centres, as in
//! [`crate::math::fuzzy_c_means`]); R. J. Hathaway, J. C. Bezdek, Fuzzy c-means clustering of incomplete data, IEEE Trans. Systems,
//! Man, and Cybernetics B 31, 2001, 735–744 (partial distances, for tracks that say nothing at some times).
//!
//! # Symbols
//! x_k(l), P_k(l) estimate and covariance of track k at time l; v_i(l) centre i there; d_ik² the mean of
//! (x_k − v_i)ᵀ P_k⁻¹ (x_k − v_i) over the times of both; u_ik membership; q fuzzifier.
//!
//! # Method
//! Each cluster of the problem by itself:
//! 1. The first centres are the tracks of the sensor that has most there; then each track that no link of negative cost joins to
//!    a centre. A track may belong to the centres that it is linked with, or that it is.
//! 2. u_ik = d_ik^(−2/(q−1)) / Σ_j d_jk^(−2/(q−1)), and v_i(l) = (Σ_k u_ik^q P_k⁻¹)⁻¹ Σ_k u_ik^q P_k⁻¹ x_k(l), in turn until no
//!    membership changes by more than the tolerance.
//! 3. Sensor by sensor, the assignment of tracks to different centres with the largest total membership.
//! 4. The tracks of a centre are a tuple; one that does not exist or does not pay is divided ([`super::admissible`]).

use super::admissible::divide_rows;
use super::bound::dual_bound;
use super::cluster::{Cluster, clusters};
use super::evidence::{Evidence, Times};
use super::grouping::{FUZZIFIER, TOLERANCE};
use super::problem::CorrelationProblem;
use super::{BuildCorrelator, Correlator, Solution};
use crate::math::assignment::AssignmentSolver;
use crate::math::fuzzy_c_means::{Fuzzifier, largest_change};
use crate::model::fault::Fault;
use crate::model::state::{Covariance, State};
use crate::registry::{Method, Object, default, whole};
use serde::Deserialize;

pub const METHOD: Method<BuildCorrelator> = Method {
    name: "fuzzy",
    parameters: &PARAMETERS,
    build: |spec, _| {
        let FuzzyCorrelatorSettings {
            fuzzifier,
            tolerance,
            max_iterations,
        } = FuzzyCorrelatorSettings::deserialize(spec)?;
        let fuzzifier = Fuzzifier::new(fuzzifier).map_err(serde::de::Error::custom)?;
        Ok(Box::new(Fuzzy {
            fuzzifier,
            tolerance,
            max_iterations,
        }))
    },
};

static PARAMETERS: Object = Object {
    name: "FuzzyCorrelator",
    summary: "Fuzzy c-means: targets are clusters, and the tracks of each sensor go to those to which they belong most.",
    fields: &[
        FUZZIFIER,
        TOLERANCE,
        default(
            "max_iterations",
            "Iterations after which a search ends that is not at rest.",
            whole(1, 100_000, ""),
            "100",
        ),
    ],
};

#[derive(Debug, Deserialize)]
struct FuzzyCorrelatorSettings {
    fuzzifier: f64,
    tolerance: f64,
    max_iterations: u32,
}

#[derive(Debug)]
struct Fuzzy {
    fuzzifier: Fuzzifier,
    tolerance: f64,
    max_iterations: u32,
}

impl Correlator for Fuzzy {
    fn correlate(&mut self, problem: &CorrelationProblem) -> Result<Solution, Vec<Fault>> {
        let Some(evidence) = problem.evidence() else {
            return Err(vec![Fault::new(
                "/method",
                "unsupported",
                "'fuzzy' looks at the tracks, and has only costs",
            )]);
        };
        let rows: Vec<Vec<u32>> = clusters(problem)
            .iter()
            .flat_map(|cluster| self.rows(cluster, evidence))
            .collect();
        Ok(Solution::from_tuples(problem, divide_rows(problem, &rows))
            .with_bound(dual_bound(problem)))
    }
}

impl Fuzzy {
    /// The tracks of each centre, as the problem calls them.
    fn rows(&self, cluster: &Cluster, evidence: &Evidence) -> Vec<Vec<u32>> {
        let mut clustering = Clustering::new(cluster, evidence);
        clustering.share(self.fuzzifier);
        for _ in 0..self.max_iterations {
            clustering.move_centres(self.fuzzifier);
            let before = clustering.memberships.clone();
            clustering.share(self.fuzzifier);
            if largest_change(&before, &clustering.memberships) <= self.tolerance {
                break;
            }
        }
        clustering.harden()
    }
}

struct Clustering<'a> {
    cluster: &'a Cluster<'a>,
    evidence: &'a Evidence,
    /// The common times that are looked at.
    times: Vec<usize>,
    /// v_i(l), time by time of centre by centre; `None` where no track of a centre says anything.
    centres: Vec<Option<State>>,
    /// Where the centres of each track begin in `candidates`, and their number.
    firsts: Vec<usize>,
    candidates: Vec<u32>,
    /// u_ik, beside `candidates`.
    memberships: Vec<f64>,
}

impl<'a> Clustering<'a> {
    /// Step 1.
    fn new(cluster: &'a Cluster, evidence: &'a Evidence) -> Self {
        let tracks: Vec<u32> = (0..cluster.len() as u32).collect();
        let times = match evidence.times {
            Times::All => (0..evidence.until).collect(),
            Times::Latest => evidence
                .fullest_time(&cluster.names(&tracks))
                .into_iter()
                .collect::<Vec<_>>(),
        };
        let leaders = leaders(cluster);
        let mut centre_of = vec![None; cluster.len()];
        leaders
            .iter()
            .enumerate()
            .for_each(|(centre, &track)| centre_of[track as usize] = Some(centre as u32));
        let (mut firsts, mut candidates) = (vec![0], Vec::new());
        for &track in &tracks {
            let linked = cluster.edges(track).iter().map(|edge| edge.track);
            candidates.extend(
                linked
                    .chain([track])
                    .filter_map(|other| centre_of[other as usize]),
            );
            firsts.push(candidates.len());
        }
        let memberships = vec![0.0; candidates.len()];
        let state = |track: u32, time: usize| {
            evidence
                .estimates
                .at(cluster.name_of(track), time)
                .map(|estimate| estimate.mean)
        };
        let centres = leaders
            .iter()
            .flat_map(|&track| times.iter().map(move |&time| state(track, time)))
            .collect();
        Clustering {
            cluster,
            evidence,
            times,
            centres,
            firsts,
            candidates,
            memberships,
        }
    }

    fn candidates_of(&self, track: u32) -> std::ops::Range<usize> {
        self.firsts[track as usize]..self.firsts[track as usize + 1]
    }

    /// u_ik.
    fn share(&mut self, fuzzifier: Fuzzifier) {
        let mut squares = Vec::new();
        for track in 0..self.cluster.len() as u32 {
            let range = self.candidates_of(track);
            squares.clear();
            squares.extend(
                self.candidates[range.clone()]
                    .iter()
                    .map(|&centre| self.squared_distance(track, centre)),
            );
            if squares.iter().any(|squared| squared.is_finite()) {
                fuzzifier.share(&squares, &mut self.memberships[range]);
            } else {
                self.memberships[range].fill(0.0);
            }
        }
    }

    /// d_ik²; infinite where the two have no time in common.
    fn squared_distance(&self, track: u32, centre: u32) -> f64 {
        let (mut sum, mut count) = (0.0, 0);
        for (place, &time) in self.times.iter().enumerate() {
            let state = self.centres[centre as usize * self.times.len() + place];
            if let (Some(state), Some(estimate)) = (
                state,
                self.evidence
                    .estimates
                    .at(self.cluster.name_of(track), time),
            ) {
                sum += estimate.gaussian.squared_distance(&(estimate.mean - state));
                count += 1;
            }
        }
        if count == 0 {
            f64::INFINITY
        } else {
            sum / f64::from(count)
        }
    }

    /// v_i.
    fn move_centres(&mut self, fuzzifier: Fuzzifier) {
        let mut sums = vec![(Covariance::zeros(), State::zeros()); self.centres.len()];
        for track in 0..self.cluster.len() as u32 {
            for index in self.candidates_of(track) {
                let weight = fuzzifier.raise(self.memberships[index]);
                for (place, &time) in self.times.iter().enumerate() {
                    let Some(estimate) = self
                        .evidence
                        .estimates
                        .at(self.cluster.name_of(track), time)
                    else {
                        continue;
                    };
                    let (information, vector) =
                        &mut sums[self.candidates[index] as usize * self.times.len() + place];
                    *information += estimate.gaussian.inverse() * weight;
                    *vector += estimate.gaussian.inverse() * estimate.mean * weight;
                }
            }
        }
        self.centres = sums
            .iter()
            .map(|(information, vector)| information.cholesky().map(|root| root.solve(vector)))
            .collect();
    }

    /// Step 3.
    fn harden(&self) -> Vec<Vec<u32>> {
        let mut rows = vec![Vec::new(); self.centres.len() / self.times.len().max(1)];
        let mut solver = AssignmentSolver::default();
        let tracks: Vec<u32> = (0..self.cluster.len() as u32).collect();
        for of_sensor in tracks
            .chunk_by(|left, right| self.cluster.sensor_of(*left) == self.cluster.sensor_of(*right))
        {
            solver.clear();
            for &track in of_sensor {
                self.candidates_of(track).for_each(|index| {
                    solver.push_edge(self.candidates[index], -self.memberships[index])
                });
                solver.end_row(0.0);
            }
            let is_solved = solver.solve().is_some();
            debug_assert!(
                is_solved,
                "tracks that may all be of no centre have an assignment"
            );
            for (row, &track) in of_sensor.iter().enumerate() {
                if let Some(centre) = solver.column_of(row) {
                    rows[centre as usize].push(self.cluster.name_of(track));
                }
            }
        }
        rows
    }
}

/// The tracks that are the first centres.
fn leaders(cluster: &Cluster) -> Vec<u32> {
    let mut counts = vec![0; cluster.sensors()];
    (0..cluster.len() as u32).for_each(|track| counts[cluster.sensor_of(track)] += 1);
    let most = counts.iter().copied().max().unwrap_or(0);
    let first = counts.iter().position(|&count| count == most);
    let mut is_leader: Vec<bool> = (0..cluster.len() as u32)
        .map(|track| Some(cluster.sensor_of(track)) == first)
        .collect();
    for track in 0..cluster.len() as u32 {
        let is_led = cluster
            .edges(track)
            .iter()
            .any(|edge| edge.cost < 0.0 && is_leader[edge.track as usize]);
        is_leader[track as usize] |= !is_led;
    }
    (0..cluster.len() as u32)
        .filter(|&track| is_leader[track as usize])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::estimates::Estimates;
    use super::super::problem::Costs;
    use super::*;
    use crate::math::rng::Seed;
    use crate::model::state::GaussianState;
    use std::sync::Arc;

    /// Positions on a line, σ = 1 m, at one time.
    fn evidence(sensors: &[&[f64]]) -> Evidence {
        let named = sensors
            .iter()
            .map(|tracks| (String::new(), vec![String::new(); tracks.len()]))
            .collect();
        let mut estimates = Estimates::new(named, vec![0.0], false);
        for (track, &x_m) in sensors.iter().copied().flatten().enumerate() {
            estimates.set(
                track,
                0,
                &GaussianState {
                    mean: State::new(x_m, 0.0, 0.0, 0.0),
                    covariance: Covariance::identity(),
                },
            );
        }
        Evidence {
            estimates: Arc::new(estimates),
            cross: None,
            times: Times::All,
            until: 1,
        }
    }

    fn problem(sensors: &[&[f64]]) -> CorrelationProblem {
        let counts: Vec<usize> = sensors.iter().map(|tracks| tracks.len()).collect();
        let evidence = evidence(sensors);
        let tracks: usize = counts.iter().sum();
        let sensor_of = evidence.estimates.sensors_of_tracks();
        let all = (0..tracks as u32).flat_map(|a| (a + 1..tracks as u32).map(move |b| (a, b)));
        let link = |(a, b): (u32, u32)| Some((a, b, evidence.pair(a, b)?.lambda - 9.0));
        let pairs: Vec<_> = all
            .filter(|&(a, b)| sensor_of[a as usize] != sensor_of[b as usize])
            .filter_map(link)
            .collect();
        CorrelationProblem::new(&counts, &pairs, Costs::AllPairs).with_evidence(evidence)
    }

    fn fuzzy(problem: &CorrelationProblem) -> Solution {
        let parameters =
            serde_json::json!({"fuzzifier": 2.0, "tolerance": 1e-4, "max_iterations": 100});
        (METHOD.build)(&parameters, Seed { seed: 0, run: 0 })
            .unwrap()
            .correlate(problem)
            .unwrap()
    }

    #[test]
    fn memberships_of_the_first_centres_by_hand() {
        let problem = problem(&[&[0.0, 4.0], &[1.0]]);
        let clusters = clusters(&problem);
        let mut clustering = Clustering::new(&clusters[0], problem.evidence().unwrap());
        clustering.share(Fuzzifier::new(2.0).unwrap());
        // d² = 1 and 9: memberships 0.9 and 0.1; the centres themselves belong to nothing else.
        assert_eq!(clustering.candidates, [0, 1, 0, 1]);
        let expected = [1.0, 1.0, 0.9, 0.1];
        assert!(
            clustering
                .memberships
                .iter()
                .zip(expected)
                .all(|(is, should)| (is - should).abs() < 1e-12)
        );
        clustering.move_centres(Fuzzifier::new(2.0).unwrap());
        // (0 + 0.81 · 1) / 1.81 and (4 + 0.01 · 1) / 1.01.
        let x_m: Vec<f64> = clustering
            .centres
            .iter()
            .map(|centre| centre.unwrap()[0])
            .collect();
        assert!(
            (x_m[0] - 0.81 / 1.81).abs() < 1e-12 && (x_m[1] - 4.01 / 1.01).abs() < 1e-12,
            "{x_m:?}"
        );
    }

    #[test]
    fn each_sensors_tracks_go_to_different_targets_and_a_stranger_is_alone() {
        // Two targets near 0 and 3, each with three tracks; the last track has no partner.
        let found = fuzzy(&problem(&[&[0.1, 3.1], &[2.9, -0.2], &[0.0, 3.0, 40.0]]));
        assert_eq!(found.tuples, [vec![0, 3, 4], vec![1, 2, 5], vec![6]]);
    }

    #[test]
    fn a_group_that_does_not_pay_is_divided() {
        // 2 is linked to 1 alone (λ = 8), but the pair pays; 0 and 2 would cost (λ = 32).
        let found = fuzzy(&problem(&[&[0.0], &[4.0], &[8.0]]));
        assert_eq!(found.tuples.iter().map(Vec::len).sum::<usize>(), 3);
        assert!(
            found.cost <= 0.0 && found.tuples.iter().all(|tuple| tuple.len() < 3),
            "{found:?}"
        );
    }

    #[test]
    fn costs_alone_are_refused() {
        let parameters =
            serde_json::json!({"fuzzifier": 2.0, "tolerance": 1e-4, "max_iterations": 100});
        let mut fuzzy = (METHOD.build)(&parameters, Seed { seed: 0, run: 0 }).unwrap();
        let fault = fuzzy
            .correlate(&CorrelationProblem::new(
                &[1, 1],
                &[(0, 1, -1.0)],
                Costs::AllPairs,
            ))
            .unwrap_err()
            .remove(0);
        assert_eq!(&*fault.code, "unsupported");
    }
}
