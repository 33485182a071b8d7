//! The worked numbers of existence.

use super::*;
use crate::association::ASSOCIATORS;
use crate::association::problem::Edge;
use crate::math::rng::Seed;
use crate::registry;
use serde_json::json;

const P_D: f64 = 0.8;
const CLUTTER: f64 = 0.02;

/// Rows of tracks with these existences; the densities of each detection around them, 0 for one outside its gate.
fn problem(existences: &[f64], densities: &[&[f64]], crowd: &[f64], p_g: f64) -> ScanProblem {
    let mut problem = ScanProblem::default();
    problem.begin(0, 3);
    for (existence, densities) in existences.iter().zip(densities) {
        for (detection, density) in densities.iter().enumerate() {
            if *density > 0.0 {
                let clutter = CLUTTER + crowd.get(detection).copied().unwrap_or_default();
                problem.push_edge(Edge {
                    detection: detection as u32,
                    squared_distance: 1.0,
                    log_likelihood: (existence * P_D * density / clutter).ln(),
                });
            }
        }
        problem.end_row((1.0 - existence * P_D * p_g).ln(), 0.0);
    }
    problem
}

fn weights(problem: &mut ScanProblem, method: &str) -> Weights {
    let method = ASSOCIATORS.iter().find(|entry| entry.name == method);
    let method = method.unwrap();
    let defaults = registry::check(&json!({}), method.parameters).unwrap();
    let mut associator = (method.build)(&defaults, Seed { seed: 1, run: 0 }).unwrap();
    let mut weights = Weights::default();
    weights.reset(problem);
    problem.for_each_cluster(|cluster| associator.associate(cluster, &mut weights));
    weights
}

fn near(found: f64, wanted: f64) {
    assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
}

/// The example of one track with two detections; the sums over absent, missed and either detection are made by hand:
/// β = (1 − δ)⁻¹ (0.24, 2, 0.4) with δ = 0.76 − 2.4.
#[test]
fn one_track_is_integrated_probabilistic_data_association() {
    near(survival(20.0, 1000.0), 0.980_198_673_306_755_3);
    let mut row = problem(&[0.588], &[&[0.05, 0.01]], &[], 0.95);
    for method in ["pda", "jpda"] {
        let weights = weights(&mut row, method);
        let after = after((&row, &weights, 0), 0.588, 0.95 * P_D, true);
        near(after.existence, 2.64 * 0.588 / (1.0 + 1.64 * 0.588));
        assert!((after.existence - 0.790_258_206_402_2).abs() < 1e-12);
        near(after.missed, 0.24 / 2.64);
        near(weights.edges[0] * after.scale, 2.0 / 2.64);
        near(weights.edges[1] * after.scale, 0.4 / 2.64);
    }
    let nothing = problem(&[0.588], &[&[]], &[], 0.95);
    let mut missed = Weights::default();
    missed.reset(&nothing);
    for is_soft in [true, false] {
        let after = after((&nothing, &missed, 0), 0.588, 0.95 * P_D, is_soft);
        assert!((after.existence - 0.255_134_509_690_5).abs() < 1e-12);
        near(after.missed, 1.0);
    }
}

/// The published example of two tracks and three detections, by Bayes over all joint events.
#[test]
fn two_tracks_are_joint_integrated_probabilistic_data_association() {
    let densities: [&[f64]; 2] = [&[0.06, 0.03, 0.0], &[0.04, 0.05, 0.01]];
    let mut rows = problem(&[0.9, 0.5], &densities, &[], 0.95);
    let weights = weights(&mut rows, "jpda");
    let wanted = [
        (
            0.959_746_309_566_2,
            0.090_594_744_121_72,
            [0.629_322_268_326_4, 0.280_082_987_551_9].as_slice(),
        ),
        (
            0.726_828_009_193_8,
            0.090_201_914_296_34,
            &[
                0.236_074_001_420_5,
                0.523_387_560_455_9,
                0.150_336_523_827_2,
            ],
        ),
    ];
    for (row, (existence, missed, detected)) in wanted.into_iter().enumerate() {
        let after = after((&rows, &weights, row), [0.9, 0.5][row], 0.95 * P_D, true);
        assert!((after.existence - existence).abs() < 1e-12);
        assert!((after.missed - missed).abs() < 1e-12);
        for (edge, wanted) in rows.rows()[row].edges().zip(detected) {
            assert!((weights.edges[edge] * after.scale - wanted).abs() < 1e-12);
        }
    }
}

#[test]
fn tracks_that_surely_exist_are_weighed_as_by_jpda() {
    let densities: [&[f64]; 2] = [&[0.06, 0.03, 0.0], &[0.04, 0.05, 0.01]];
    let mut rows = problem(&[1.0, 1.0], &densities, &[], 0.95);
    let weights = weights(&mut rows, "jpda");
    let wanted = [0.101_338_432_122_4, 0.091_778_202_676_88];
    for (row, missed) in wanted.into_iter().enumerate() {
        let after = after((&rows, &weights, row), 1.0, 0.95 * P_D, true);
        near(after.existence, 1.0);
        near(after.scale, 1.0);
        assert!((after.missed - missed).abs() < 1e-12);
    }
}

/// Two tracks among undetected targets, by brute force: what is left of each detection is a new track.
#[test]
fn what_tracks_leave_of_undetected_targets_begins_tracks() {
    let crowd = [0.004, 0.003, 0.012];
    let densities: [&[f64]; 2] = [&[0.06, 0.03, 0.0], &[0.04, 0.05, 0.01]];
    let mut rows = problem(&[0.9, 0.5], &densities, &crowd, 1.0);
    let weights = weights(&mut rows, "jpda");
    for (row, existence) in [0.952_992_058_135_9, 0.686_181_879_534_3]
        .into_iter()
        .enumerate()
    {
        let after = after((&rows, &weights, row), [0.9, 0.5][row], P_D, true);
        assert!((after.existence - existence).abs() < 1e-12);
    }
    let mut left = [1.0; 3];
    for (edge, weight) in rows.edges().iter().zip(&weights.edges) {
        left[edge.detection as usize] -= weight;
    }
    let wanted = [
        0.039_060_052_061_99,
        0.045_951_939_068_19,
        0.345_579_551_206_3,
    ];
    for ((left, crowd), wanted) in left.into_iter().zip(crowd).zip(wanted) {
        assert!((left * crowd / (CLUTTER + crowd) - wanted).abs() < 1e-12);
    }
}

/// Detections and misses in a row, each detection the only one in the gate.
#[test]
fn existence_rises_with_detections_and_falls_with_misses() {
    let wanted = [
        0.353_198_609_859_7,
        0.542_497_773_316_5,
        0.214_105_172_624_3,
        0.372_965_329_566,
        0.121_461_606_573_7,
        0.031_409_189_801_6,
        0.007_564_399_714_445,
    ];
    let mut existence = 0.2;
    for (is_hit, wanted) in [true, true, false, true, false, false, false]
        .into_iter()
        .zip(wanted)
    {
        existence *= 0.98;
        let density: &[f64] = if is_hit { &[0.05] } else { &[] };
        let mut row = problem(&[existence], &[density], &[], 0.95);
        let weights = weights(&mut row, "jpda");
        existence = after((&row, &weights, 0), existence, 0.95 * P_D, true).existence;
        assert!((existence - wanted).abs() < 1e-12, "{existence} {wanted}");
    }
}

/// A hard choice weighs its detection against clutter alone: 0.6 × 2 / (0.4 + 0.6 × 2) with Λ = 0.8 × 0.05 / 0.02. The less a
/// track exists the likelier it is that none is its: 0.3 × 2 is less than 1 − 0.3 × 0.76.
#[test]
fn a_hard_choice_raises_existence_by_its_likelihood_ratio() {
    for (existence, wanted, missed) in [(0.6, 0.75, 0.0), (0.3, 0.24 * 0.3 / 0.772, 1.0)] {
        let mut row = problem(&[existence], &[&[0.05, 0.01]], &[], 0.95);
        let weights = weights(&mut row, "global_nearest_neighbour");
        let after = after((&row, &weights, 0), existence, 0.95 * P_D, false);
        near(after.existence, wanted);
        near(after.missed, missed);
    }
    near(by_ratio(0.3, 800.0), 1.0);
    near(by_ratio(0.3, -800.0), 0.0);
    near(by_ratio(1.0, -800.0), 1.0);
}

#[test]
fn a_miss_where_the_sensor_does_not_see_says_nothing() {
    let nothing = problem(&[0.4], &[&[]], &[], 0.95);
    let mut missed = Weights::default();
    missed.reset(&nothing);
    near(after((&nothing, &missed, 0), 0.4, 0.0, true).existence, 0.4);
}
