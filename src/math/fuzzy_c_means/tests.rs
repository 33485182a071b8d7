//! What fuzzy c-means owes: hand-worked cases, J that never rises, fixed points, and known optima.

use super::genetic::{GeneticSettings, search};
use super::validity::{Index, choose, partition_coefficient, xie_beni};
use super::*;
use crate::math::rng::{Purpose, Seed};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

const TIGHT: FuzzyCMeansSettings = FuzzyCMeansSettings {
    fuzzifier: 2.0,
    tolerance: 1e-12,
    max_iterations: 10_000,
};

fn run(
    settings: FuzzyCMeansSettings,
    objects: &Objects,
    initial: &[f64],
) -> (FuzzyCMeans, ClusteringResult) {
    let mut means = FuzzyCMeans::new(settings).unwrap();
    let outcome = means.run(objects, initial).unwrap();
    (means, outcome)
}

#[test]
fn one_iteration_by_hand() {
    // Objects 0, 1, 4 from centres 0 and 3, q = 2. d²: (0, 9), (1, 4), (16, 1). U: (1, 0), (0.8, 0.2), (1/17, 16/17).
    // J = 0 + 0.64·1 + 0.04·4 + 16/289 + 256/289 = 0.8 + 272/289 = 1.7411765.
    // v₁ = (0.64 + 4/289) / (1 + 0.64 + 1/289) = 0.6538408 / 1.6434602 = 0.3978440,
    // v₂ = (0.04 + 4·256/289) / (0.04 + 256/289) = 3.5832526 / 0.9258131 = 3.8703844.
    let objects = Objects::new(&[0.0, 1.0, 4.0], &[false], Metric::Scaled(&[1.0])).unwrap();
    let settings = FuzzyCMeansSettings {
        max_iterations: 1,
        ..FuzzyCMeansSettings::default()
    };
    let mut means = FuzzyCMeans::new(settings).unwrap();
    let mut seen = Vec::new();
    let outcome = means
        .run_observed(&objects, &[0.0, 3.0], |step| {
            seen.push((step.iteration, step.cost, step.centres.to_vec()))
        })
        .unwrap();
    assert!((means.costs()[0] - (0.8 + 272.0 / 289.0)).abs() < 1e-12);
    assert!(
        (means.centres()[0] - 0.397_844_0).abs() < 1e-6
            && (means.centres()[1] - 3.870_384_4).abs() < 1e-6,
        "{:?}",
        means.centres()
    );
    assert_eq!(
        (outcome.iterations, outcome.converged, outcome.cost),
        (1, false, means.costs()[1])
    );
    assert_eq!(
        seen.iter()
            .map(|(iteration, cost, _)| (*iteration, *cost))
            .collect::<Vec<_>>(),
        [(0, means.costs()[0]), (1, outcome.cost)]
    );
    assert_eq!(
        (&seen[0].2[..], &seen[1].2[..]),
        (&[0.0, 3.0][..], means.centres())
    );
}

#[test]
fn two_objects_become_two_clusters() {
    // From 1 and 9 the objects 0 and 10 have d² 1 and 81: u = 81/82, 1/82 and v₁ = 10 · (1/82)² / ((81/82)² + (1/82)²)
    // = 10 / 6562; each iteration comes much nearer, and on the objects J is 0 and U the unit matrix.
    let objects = Objects::new(&[0.0, 10.0], &[false], Metric::Scaled(&[1.0])).unwrap();
    let (first, _) = run(
        FuzzyCMeansSettings {
            max_iterations: 1,
            ..TIGHT
        },
        &objects,
        &[1.0, 9.0],
    );
    assert!((first.centres()[0] - 10.0 / 6562.0).abs() < 1e-12);
    let (means, outcome) = run(TIGHT, &objects, &[1.0, 9.0]);
    assert!(outcome.converged && outcome.cost < 1e-20 && outcome.iterations < 10);
    assert!((means.centres()[0]).abs() < 1e-9 && (means.centres()[1] - 10.0).abs() < 1e-9);
    assert!(
        means
            .memberships()
            .iter()
            .zip([1.0, 0.0, 0.0, 1.0])
            .all(|(found, wanted)| (found - wanted).abs() < 1e-9)
    );
}

#[test]
fn a_covariance_of_its_own_makes_the_centre_the_information_weighted_mean() {
    // Both clusters start alike, so every u is ½ and stays: the centre is (3·0 + 1·4) / (3 + 1) = 1 in x, (1·0 + 1·4) / 2
    // = 2 in y for inverse covariances diag(3, 1) and diag(1, 1); the plain mean would be (2, 2).
    let inverses = [3.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0];
    let objects = Objects::new(
        &[0.0, 0.0, 4.0, 4.0],
        &[false, false],
        Metric::Mahalanobis(&inverses),
    )
    .unwrap();
    let (means, _) = run(TIGHT, &objects, &[3.0, 3.0, 3.0, 3.0]);
    let expected = [1.0, 2.0, 1.0, 2.0];
    assert!(
        means
            .centres()
            .iter()
            .zip(expected)
            .all(|(found, wanted)| (found - wanted).abs() < 1e-12),
        "{:?}",
        means.centres()
    );
}

#[test]
fn a_cluster_across_north_is_one_cluster() {
    // Around 0 (as 6.2, 0.1, −0.02) and around 3 rad.
    let values = [6.2, 0.1, -0.02, 2.9, 3.0, 3.1];
    let objects = Objects::new(&values, &[true], Metric::Scaled(&[0.1])).unwrap();
    for initial in [[1.0, 2.0], [-1.0, 4.0], [6.2, 3.1]] {
        let (means, outcome) = run(TIGHT, &objects, &initial);
        let mut labels = Vec::new();
        harden::largest(means.memberships(), 2, &mut labels);
        assert_eq!(labels, [0, 0, 0, 1, 1, 1]);
        // The mean of −0.083185, 0.1, −0.02 is −0.001062; the far cluster weighs next to nothing.
        assert!(
            outcome.converged && (means.centres()[0] - (6.2 - TAU + 0.08) / 3.0).abs() < 0.005,
            "{:?}",
            means.centres()
        );
        assert!((means.centres()[1] - 3.0).abs() < 0.005);
    }
}

#[test]
fn faults_name_the_field_and_what_is_allowed() {
    let objects = Objects::new(&[0.0, 1.0, 4.0], &[false], Metric::Scaled(&[1.0])).unwrap();
    let settings = FuzzyCMeansSettings::default();
    let named = |error: FuzzyError| (error.field(), error.allowed());
    let mut means = FuzzyCMeans::new(settings).unwrap();
    for initial in [&[1.0][..], &[1.0; 4][..]] {
        assert_eq!(
            named(means.run(&objects, initial).unwrap_err()),
            ("clusters", "[2, 3], the number of objects".to_owned())
        );
    }
    assert_eq!(
        means.run(&objects, &[0.0, f64::NAN]).unwrap_err(),
        FuzzyError::Centre {
            centre: 1,
            attribute: 0
        }
    );
    let refused = |settings| named(FuzzyCMeans::new(settings).unwrap_err());
    assert_eq!(
        refused(FuzzyCMeansSettings {
            fuzzifier: 1.0,
            ..settings
        }),
        ("fuzzifier", "> 1".to_owned())
    );
    assert_eq!(
        refused(FuzzyCMeansSettings {
            tolerance: 0.0,
            ..settings
        }),
        ("tolerance", "> 0".to_owned())
    );
    assert_eq!(
        refused(FuzzyCMeansSettings {
            max_iterations: 0,
            ..settings
        }),
        ("max_iterations", ">= 1".to_owned())
    );
    let fault = FuzzyError::Tolerance(-1.0).fault("/correlator");
    assert_eq!(
        (
            fault.pointer.as_str(),
            fault.detail.as_str(),
            fault.allowed.as_deref()
        ),
        ("/correlator/tolerance", "the tolerance is -1", Some("> 0"))
    );
}

#[test]
fn objects_and_metrics_that_are_no_numbers_are_named() {
    let flat = [false, false];
    let not_finite = Objects::new(
        &[0.0, 1.0, f64::INFINITY, 2.0],
        &flat,
        Metric::Scaled(&[1.0, 1.0]),
    );
    assert_eq!(
        not_finite.unwrap_err(),
        FuzzyError::Object {
            object: 1,
            attribute: 0
        }
    );
    let bad_sigma = Objects::new(&[0.0, 1.0], &flat, Metric::Scaled(&[1.0, 0.0]));
    assert_eq!(
        bad_sigma.unwrap_err(),
        FuzzyError::Sigma {
            attribute: 1,
            found: 0.0
        }
    );
    let bad_inverse = Objects::new(
        &[0.0; 4],
        &flat,
        Metric::Mahalanobis(&[1.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 1.0]),
    );
    assert_eq!(bad_inverse.unwrap_err(), FuzzyError::Inverse { object: 1 });
}

/// Three groups of three, 100 apart.
const GROUPS: [f64; 9] = [0.0, 1.0, 2.0, 100.0, 101.0, 102.0, 200.0, 201.0, 202.0];

#[test]
fn indices_by_hand_and_the_choice_of_three_groups() {
    assert!((partition_coefficient(&[0.9, 0.1, 0.5, 0.5], 2) - 0.66).abs() < 1e-15);
    let objects = Objects::new(&GROUPS, &[false], Metric::Scaled(&[1.0])).unwrap();
    let mut means = FuzzyCMeans::new(TIGHT).unwrap();
    for index in [Index::PartitionCoefficient, Index::XieBeni] {
        let (clusters, tried) = choose(&mut means, &objects, 2..=5, index, |clusters, centres| {
            start::farthest_first(&objects, clusters, centres)
        })
        .unwrap();
        assert_eq!(
            (clusters, means.clusters(), tried.len()),
            (3, 3, 4),
            "{index:?}: {tried:?}"
        );
    }
    // J is nearly 3 · (1 + 0 + 1) = 6, the centres 100 apart: 6 / (9 · 10 000).
    assert!((xie_beni(&means, &objects) - 6.0 / 90_000.0).abs() < 1e-6);
    assert!(
        choose(
            &mut means,
            &objects,
            1..=3,
            Index::XieBeni,
            |clusters, centres| start::farthest_first(&objects, clusters, centres)
        )
        .is_err()
    );
}

/// Pairs of close groups far apart: FCM from random objects often gives one pair a centre too many and another one too few.
fn pairs() -> Vec<f64> {
    let centre = |pair: usize| {
        (
            f64::from(pair as u32 % 2) * 1000.0,
            f64::from(pair as u32 / 2) * 1000.0,
        )
    };
    let mut values = Vec::new();
    for pair in 0..4 {
        let (x, y) = centre(pair);
        for side in [-6.0, 6.0] {
            for place in 0..5 {
                let around = f64::from(place) * TAU / 5.0 + side;
                values.extend([x + side + around.cos(), y + around.sin()]);
            }
        }
    }
    values
}

#[test]
fn genetic_search_is_never_above_the_best_of_twenty_random_starts() {
    let values = pairs();
    let objects = Objects::new(&values, &[false, false], Metric::Scaled(&[1.0, 1.0])).unwrap();
    let mut means = FuzzyCMeans::new(FuzzyCMeansSettings {
        tolerance: 1e-6,
        max_iterations: 300,
        ..FuzzyCMeansSettings::default()
    })
    .unwrap();
    let (mut worst_of_plain, mut initial) = (0.0f64, Vec::new());
    for seed in 0..3 {
        let seed = Seed { seed, run: 0 };
        let mut stream = seed.stream(Purpose::Clustering, 0, 1);
        let mut best = f64::INFINITY;
        for _ in 0..20 {
            start::random(&objects, 8, &mut stream, &mut initial).unwrap();
            let cost = means.run(&objects, &initial).unwrap().cost;
            best = best.min(cost);
            worst_of_plain = worst_of_plain.max(cost);
        }
        let found = search(
            &mut means,
            &objects,
            8,
            GeneticSettings::default(),
            &mut seed.stream(Purpose::Clustering, 0, 0),
        )
        .unwrap();
        assert!(
            found.cost <= best * (1.0 + 1e-6),
            "{} is above {best}",
            found.cost
        );
        assert!(found.trace.windows(2).all(|pair| pair[1] <= pair[0]));
        assert_eq!((found.runs, means.clusters()), (111, 8));
        assert!((means.costs().last().unwrap() - found.cost).abs() <= 1e-9 * found.cost);
        // Five objects at distance 1 from each of eight centres: the optimum is a little below 40.
        assert!((35.0..40.0).contains(&found.cost), "{}", found.cost);
    }
    assert!(
        worst_of_plain > 100.0,
        "no random start was caught in a bad optimum: {worst_of_plain}"
    );
}

#[test]
fn genetic_search_repeats_and_refuses_bad_rates() {
    let values = pairs();
    let objects = Objects::new(&values, &[false, false], Metric::Scaled(&[1.0, 1.0])).unwrap();
    let mut means = FuzzyCMeans::new(FuzzyCMeansSettings::default()).unwrap();
    let few = GeneticSettings {
        population: 3,
        generations: 2,
        ..GeneticSettings::default()
    };
    let mut once = || {
        search(
            &mut means,
            &objects,
            8,
            few,
            &mut Seed { seed: 5, run: 0 }.stream(Purpose::Clustering, 0, 0),
        )
        .unwrap()
    };
    assert_eq!(once(), once());
    let refused = GeneticSettings {
        mutation_rate: 1.5,
        ..few
    }
    .check()
    .unwrap_err();
    assert_eq!(
        (refused.field(), refused.allowed().as_str()),
        ("mutation_rate", "[0, 1]")
    );
    assert_eq!(
        GeneticSettings {
            population: 1,
            ..few
        }
        .check()
        .unwrap_err()
        .field(),
        "population"
    );
}

/// A random case: objects of two attributes, the second an angle or not, a metric, a fuzzifier and a start.
#[derive(Debug, Clone)]
struct Case {
    values: Vec<f64>,
    angles: [bool; 2],
    inverses: Option<Vec<f64>>,
    fuzzifier: f64,
    clusters: usize,
}

impl Case {
    fn objects(&self) -> Objects<'_> {
        let metric = self
            .inverses
            .as_deref()
            .map_or(Metric::Scaled(&[2.0, 0.5]), Metric::Mahalanobis);
        Objects::new(&self.values, &self.angles, metric).unwrap()
    }

    fn initial(&self) -> &[f64] {
        &self.values[..2 * self.clusters]
    }
}

fn cases() -> impl Strategy<Value = Case> {
    let inverse = (0.2..5.0f64, 0.2..5.0f64, -0.95..0.95f64).prop_map(|(xx, yy, correlation)| {
        let xy = correlation * (xx * yy).sqrt();
        [xx, xy, xy, yy]
    });
    (
        4..20usize,
        any::<bool>(),
        any::<bool>(),
        prop::sample::select(vec![1.3, 1.5, 2.0, 3.0]),
    )
        .prop_flat_map(move |(count, wraps, own, fuzzifier)| {
            let values = prop::collection::vec((-10.0..10.0f64, -PI..PI), count);
            (
                values,
                prop::collection::vec(inverse.clone(), count),
                2..=count.min(5),
            )
                .prop_map(move |(values, inverses, clusters)| Case {
                    values: values.into_iter().flat_map(|(x, y)| [x, y]).collect(),
                    angles: [false, wraps],
                    inverses: own.then(|| inverses.concat()),
                    fuzzifier,
                    clusters,
                })
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn the_cost_never_rises_and_memberships_sum_to_one(case in cases()) {
        let settings = FuzzyCMeansSettings { fuzzifier: case.fuzzifier, tolerance: 1e-6, max_iterations: 60 };
        let (means, outcome) = run(settings, &case.objects(), case.initial());
        for pair in means.costs().windows(2) {
            prop_assert!(pair[1] <= pair[0] * (1.0 + 1e-12) + 1e-300, "{} after {}", pair[1], pair[0]);
        }
        prop_assert_eq!(means.costs().len(), outcome.iterations as usize + 1);
        for memberships in means.memberships().chunks_exact(case.clusters) {
            prop_assert!((memberships.iter().sum::<f64>() - 1.0).abs() < 1e-12 && memberships.iter().all(|u| (0.0..=1.0).contains(u)));
        }
    }

    #[test]
    fn a_fixed_point_satisfies_both_equations(case in cases()) {
        let objects = case.objects();
        let settings = FuzzyCMeansSettings { fuzzifier: case.fuzzifier, tolerance: 1e-13, max_iterations: 20_000 };
        let (means, outcome) = run(settings, &objects, case.initial());
        prop_assume!(outcome.converged);
        let c = case.clusters;
        for object in 0..objects.len() {
            let squared: Vec<f64> = means.centres().chunks_exact(2).map(|centre| objects.squared_distance(object, centre)).collect();
            prop_assume!(squared.iter().all(|squared| *squared > 1e-12));
            for (i, u) in means.memberships()[object * c..][..c].iter().enumerate() {
                let sum: f64 = squared.iter().map(|other| (squared[i] / other).powf(1.0 / (case.fuzzifier - 1.0))).sum();
                prop_assert!((u - 1.0 / sum).abs() < 1e-9, "u is {}, not {}", u, 1.0 / sum);
            }
        }
        for i in 0..c {
            // Σ_k u^q W_k δ_k = 0, relative to the information.
            let (mut rest, mut information) = ([0.0; 2], 0.0);
            for object in 0..objects.len() {
                let weight = means.memberships()[object * c + i].powf(case.fuzzifier);
                let w = case.inverses.as_ref().map_or([0.25, 0.0, 0.0, 4.0], |all| all[4 * object..][..4].try_into().unwrap());
                let delta = objects.turned(objects.object(object), &means.centres()[2 * i..][..2], &w);
                rest[0] += weight * (w[0] * delta[0] + w[1] * delta[1]);
                rest[1] += weight * (w[2] * delta[0] + w[3] * delta[1]);
                information += weight * (w[0] + w[3]);
            }
            prop_assert!(rest.iter().all(|rest| rest.abs() <= 1e-9 * information.max(1.0)), "{rest:?} of {information}");
        }
    }

    #[test]
    fn well_separated_clusters_are_found_from_any_start_in_them(
        places in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64), 12),
        chosen in prop::collection::vec(0..4usize, 3),
        fuzzifier in prop::sample::select(vec![1.5, 2.0, 3.0]),
    ) {
        let corners = [(0.0, 0.0), (200.0, 0.0), (0.0, 200.0)];
        let values: Vec<f64> = places.iter().enumerate().flat_map(|(k, (x, y))| [corners[k % 3].0 + x, corners[k % 3].1 + y]).collect();
        let objects = Objects::new(&values, &[false, false], Metric::Scaled(&[1.0, 1.0])).unwrap();
        let initial: Vec<f64> = (0..3).flat_map(|group| objects.object(3 * chosen[group] + group).to_vec()).collect();
        let (means, outcome) = run(FuzzyCMeansSettings { fuzzifier, ..FuzzyCMeansSettings::default() }, &objects, &initial);
        let mut labels = Vec::new();
        harden::largest(means.memberships(), 3, &mut labels);
        prop_assert!(outcome.converged);
        prop_assert_eq!(labels, (0..12).map(|k| k % 3).collect::<Vec<_>>());
    }

    #[test]
    fn two_far_groups_are_found_from_any_two_objects(
        places in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64), 12),
        (first, second) in (0..12usize, 0..12usize),
    ) {
        prop_assume!(first != second);
        let values: Vec<f64> = places.iter().enumerate().flat_map(|(k, (x, y))| [f64::from(k as u32 % 2) * 50.0 + x, *y]).collect();
        let objects = Objects::new(&values, &[false, false], Metric::Scaled(&[1.0, 1.0])).unwrap();
        let initial = [objects.object(first), objects.object(second)].concat();
        let (means, outcome) = run(FuzzyCMeansSettings::default(), &objects, &initial);
        let mut labels = Vec::new();
        harden::largest(means.memberships(), 2, &mut labels);
        prop_assert!(outcome.converged);
        prop_assert!((0..12).all(|k| labels[k] == labels[k % 2]) && labels[0] != labels[1], "{labels:?}");
    }
}
