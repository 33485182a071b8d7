//! Whether an objective is largest at the truth: J of the assignment in which every track has the detection of its own target,
//! beside the optimum over all assignments of the cluster. It asks whether the objective is the right one, not whether it is met.
//!
//! # Method
//! For each cluster, J† of the truth ("none" for a target without a detection) and J* by linear assignment; J† is largest where
//! it equals J*. What it lacks is (J* − J†) / J* of a sum of likelihoods, and J* − J† of a log-likelihood ratio.

use super::super::problem::Problem;
use super::cluster::Cluster;
use super::optimality_check::{OptimalityCheck, gap};
use super::{BatSettings, Objective};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// Both objectives, at the truth of every cluster that was looked at.
#[derive(Debug, Clone, Default)]
pub(in crate::association) struct ObjectivesAtTruth {
    cluster: Cluster,
    solver: OptimalityCheck,
    entries: Vec<u32>,
    counts: Counts,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::association) struct Counts {
    likelihood_sum: OfObjective,
    log_likelihood_ratio: OfObjective,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
struct OfObjective {
    all: Clusters,
    /// Those whose targets all have a detection.
    detected: Clusters,
    /// Of these, those of several tracks.
    shared: Clusters,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
struct Clusters {
    clusters: u64,
    /// Those in which J is largest at the truth.
    largest: u64,
    sum_of_lacks: f64,
}

impl ObjectivesAtTruth {
    /// Looks at one cluster, whose problem knows the own detection of each row.
    pub(in crate::association) fn look(&mut self, problem: &Problem) {
        let is_detected = problem.rows().all(|(row, _)| problem.own(row).is_some());
        let is_shared = is_detected && problem.row_count() > 1;
        for objective in [Objective::LikelihoodSum, Objective::LogLikelihoodRatio] {
            let lack = self.lack(problem, objective);
            let counts = match objective {
                Objective::LikelihoodSum => &mut self.counts.likelihood_sum,
                Objective::LogLikelihoodRatio => &mut self.counts.log_likelihood_ratio,
            };
            counts.all.add(lack, true);
            counts.detected.add(lack, is_detected);
            counts.shared.add(lack, is_shared);
        }
    }

    /// What J lacks at the truth; 0 where it is largest there.
    fn lack(&mut self, problem: &Problem, objective: Objective) -> f64 {
        let settings = BatSettings {
            objective,
            ..BatSettings::default()
        };
        self.cluster.load(problem, &settings);
        self.entries.clear();
        for (place, (row, edges)) in problem.rows().enumerate() {
            let own = problem.own(row);
            let of_row = problem.edges_of(edges).iter();
            let at = of_row.zip(self.cluster.codes_of(place));
            let found = at
                .filter(|(edge, _)| Some(edge.detection) == own)
                .map(|(_, code)| code)
                .next();
            self.entries.push(found.unwrap_or(self.cluster.missed()));
        }
        let truth = self.cluster.value_of(&self.entries);
        let optimum = self.solver.optimum(&self.cluster);
        match objective {
            _ if gap(truth, optimum) == 0.0 => 0.0,
            Objective::LikelihoodSum => (optimum - truth) / optimum,
            Objective::LogLikelihoodRatio => optimum - truth,
        }
    }

    pub(in crate::association) fn counts(&self) -> Counts {
        self.counts
    }

    pub(in crate::association) fn set_counts(&mut self, counts: Counts) {
        self.counts = counts;
    }

    /// The part `association.diagnostics.objectives` of a report.
    pub(in crate::association) fn report(&self) -> Value {
        let of = |counts: OfObjective| {
            json!({
                "all": counts.all.report(),
                "detected": counts.detected.report(),
                "shared": counts.shared.report()
            })
        };
        json!({
            "likelihood_sum": of(self.counts.likelihood_sum),
            "log_likelihood_ratio": of(self.counts.log_likelihood_ratio)
        })
    }
}

impl Clusters {
    fn add(&mut self, lack: f64, is_of_them: bool) {
        if is_of_them {
            self.clusters += 1;
            self.largest += u64::from(lack == 0.0);
            self.sum_of_lacks += lack;
        }
    }

    /// `mean_lack` is that of the clusters in which J is larger elsewhere.
    fn report(&self) -> Value {
        let elsewhere = self.clusters - self.largest;
        let share_largest = (self.clusters > 0).then(|| self.largest as f64 / self.clusters as f64);
        let mean_lack = (elsewhere > 0).then(|| self.sum_of_lacks / elsewhere as f64);
        json!({
            "clusters": self.clusters,
            "largest": self.largest,
            "share_largest": share_largest,
            "mean_lack": mean_lack
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::random_problem;
    use super::*;
    use crate::association::problem::ScanProblem;
    use crate::math::rng::{Purpose, Seed};
    use rand::RngExt;

    /// J of every assignment of the rows from `row` on, added to `sum`; the largest.
    fn largest(problem: &Problem, row: usize, taken: u32, gain: &dyn Fn(usize, f64) -> f64) -> f64 {
        let Some((_, edges)) = problem.rows().nth(row) else {
            return 0.0;
        };
        let mut best = largest(problem, row + 1, taken, gain);
        for edge in problem.edges_of(edges) {
            if taken & (1 << edge.detection) == 0 {
                let with = largest(problem, row + 1, taken | 1 << edge.detection, gain);
                best = best.max(with + gain(row, edge.log_likelihood));
            }
        }
        best
    }

    /// J of the true assignment.
    fn at_truth(problem: &Problem, gain: &dyn Fn(usize, f64) -> f64) -> f64 {
        let mut sum = 0.0;
        for (place, (row, edges)) in problem.rows().enumerate() {
            for edge in problem.edges_of(edges) {
                if Some(edge.detection) == problem.own(row) {
                    sum += gain(place, edge.log_likelihood);
                }
            }
        }
        sum
    }

    /// Each track's own detection is one of its candidates, another's never; some have none.
    fn tell_own(problem: &mut ScanProblem, random: &mut impl RngExt) {
        let mut taken = 0u32;
        for row in problem.rows().to_vec() {
            let edges = problem.edges()[row.edges()].to_vec();
            let free = edges.iter().map(|edge| edge.detection);
            let own = free
                .filter(|detection| taken & (1 << detection) == 0)
                .find(|_| random.random::<f64>() < 0.6);
            taken |= own.map_or(0, |detection| 1 << detection);
            problem.push_own(own);
        }
    }

    #[test]
    fn truth_and_optimum_equal_those_of_all_assignments_of_small_clusters() {
        let mut random = Seed { seed: 11, run: 0 }.stream(Purpose::Clutter, 0, 0);
        let (mut clusters, mut elsewhere) = (0, [0, 0]);
        for _ in 0..500 {
            let mut problem = random_problem(&mut random, 4, 6, 0.5);
            tell_own(&mut problem, &mut random);
            let mut objectives = ObjectivesAtTruth::default();
            problem.for_each_cluster(|cluster| {
                let likelihood = |_: usize, log_likelihood: f64| log_likelihood.exp();
                let ratio = |_: usize, log_likelihood: f64| log_likelihood - 0.05f64.ln();
                let best = largest(cluster, 0, 0, &likelihood);
                let sum = (best - at_truth(cluster, &likelihood)) / best;
                let log = largest(cluster, 0, 0, &ratio) - at_truth(cluster, &ratio);
                let asked = [Objective::LikelihoodSum, Objective::LogLikelihoodRatio];
                for (index, expected) in [sum, log].into_iter().enumerate() {
                    let found = objectives.lack(cluster, asked[index]);
                    assert!((found - expected).abs() < 1e-9, "{found}, not {expected}");
                    elsewhere[index] += usize::from(found > 0.0);
                }
                clusters += 1;
            });
        }
        assert!(
            clusters > 500
                && elsewhere
                    .iter()
                    .all(|&count| count > 100 && count < clusters)
        );
    }

    #[test]
    fn clusters_are_counted_by_whether_their_targets_are_detected() {
        use crate::association::problem::tests::problem_of;
        // Two tracks that share a detection, and one alone with clutter nearer than its own detection.
        let mut problem = problem_of(&[
            &[(0, 0.1), (1, 4.0)],
            &[(1, 0.2)],
            &[(3, 2.0), (2, 1.0)],
            &[(4, 1.0)],
        ]);
        [Some(0), Some(1), Some(3), None]
            .into_iter()
            .for_each(|own| problem.push_own(own));
        let mut objectives = ObjectivesAtTruth::default();
        problem.for_each_cluster(|cluster| objectives.look(cluster));
        let report = objectives.report();
        // e^−½·1 is the best of the lone track, e^−½·2 its own; of the target without a detection all is lacking.
        let sum = &report["likelihood_sum"];
        let mean = (1.0 - (-0.5f64).exp() + 1.0) / 2.0;
        assert!((sum["all"]["mean_lack"].as_f64().unwrap() - mean).abs() < 1e-12);
        let share = |group: &str| sum[group]["share_largest"].as_f64();
        assert_eq!(
            ["all", "detected", "shared"].map(share),
            [Some(1.0 / 3.0), Some(0.5), Some(1.0)]
        );
        let ratio = &report["log_likelihood_ratio"]["all"];
        // ½ of the lone track; ln 10 − ½ of the one without a detection.
        let mean = (0.5 + 10f64.ln() - 0.5) / 2.0;
        assert!((ratio["mean_lack"].as_f64().unwrap() - mean).abs() < 1e-12);
        assert_eq!(
            report["log_likelihood_ratio"]["shared"]["mean_lack"],
            Value::Null
        );
    }
}
