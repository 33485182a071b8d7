//! The statistics of tracks against theory: chi-square under H0, values by hand, the integral by numbers, and the sparse candidates
//! against all pairs.

use nalgebra::Vector4;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use std::sync::Arc;
use trackloom_domain::correlation::cross_covariance::CrossTable;
use trackloom_domain::correlation::estimates::Estimates;
use trackloom_domain::correlation::evidence::{Evidence, Times};
use trackloom_domain::correlation::statistic::{Correlation, Statistic, p_value, pairs_of};
use trackloom_domain::math::gaussian::{chi_square_quantile, chi_square_tail};
use trackloom_domain::math::rng::{Purpose, Seed};
use trackloom_domain::math::stats::wilson_interval;
use trackloom_domain::model::state::{Covariance, GaussianState, State};

/// Tracks by sensor, each with its states by time.
fn estimates(sensors: &[Vec<Vec<Option<GaussianState>>>], has_velocity: bool) -> Estimates {
    let times = sensors[0][0].len();
    let names = |(index, tracks): (usize, &Vec<Vec<_>>)| {
        (
            format!("S{index}"),
            (0..tracks.len()).map(|track| track.to_string()).collect(),
        )
    };
    let times_s = (0..times).map(|time| time as f64).collect();
    let mut made = Estimates::new(
        sensors.iter().enumerate().map(names).collect(),
        times_s,
        has_velocity,
    );
    for (track, states) in sensors.iter().flatten().enumerate() {
        for (time, state) in states.iter().enumerate() {
            if let Some(state) = state {
                assert!(made.set(track, time, state));
            }
        }
    }
    made
}

fn state(x_m: f64, y_m: f64, variances: [f64; 4]) -> GaussianState {
    GaussianState {
        mean: State::new(x_m, y_m, 0.0, 0.0),
        covariance: Covariance::from_diagonal(&Vector4::from(variances)),
    }
}

fn evidence(estimates: Estimates, times: Times) -> Evidence {
    let until = estimates.times();
    Evidence {
        estimates: Arc::new(estimates),
        cross: None,
        times,
        until,
    }
}

fn correlation(estimates: Estimates, statistic: Statistic, p_d: &[f64]) -> Correlation {
    let pairs = pairs_of(&estimates, &statistic).unwrap();
    Correlation {
        statistic,
        estimates: Arc::new(estimates),
        cross: None,
        pairs,
        p_d: p_d.to_vec(),
    }
}

/// A covariance with everything correlated.
fn random_covariance(draw: &mut impl RngExt) -> Covariance {
    let root = Covariance::from_fn(|_, _| draw.random::<f64>() * 4.0 - 2.0);
    root * root.transpose() + Covariance::identity()
}

fn error(covariance: &Covariance, draw: &mut impl RngExt) -> State {
    covariance.cholesky().unwrap().l() * State::from_fn(|_, _| StandardNormal.sample(draw))
}

/// The largest distance between a sample's distribution and another's, and the one that a sample of this size exceeds in 1 % of cases.
fn kolmogorov_smirnov(mut sample: Vec<f64>, distribution: impl Fn(f64) -> f64) -> (f64, f64) {
    sample.sort_by(f64::total_cmp);
    let count = sample.len() as f64;
    let distance = sample.iter().enumerate().map(|(index, &value)| {
        let expected = distribution(value);
        (expected - index as f64 / count)
            .abs()
            .max(((index + 1) as f64 / count - expected).abs())
    });
    (distance.fold(0.0, f64::max), 1.628 / count.sqrt())
}

#[test]
fn lambda_of_one_target_is_chi_square_and_alpha_of_the_true_pairs_are_rejected() {
    const TIMES: usize = 3;
    let mut draw = Seed { seed: 1, run: 0 }.stream(Purpose::LocalTracks, 0, 0);
    let threshold = chi_square_quantile(0.99, 4.0 * TIMES as f64);
    let mut rejected = 0;
    let lambdas: Vec<f64> = (0..10_000)
        .map(|_| {
            let covariances = [random_covariance(&mut draw), random_covariance(&mut draw)];
            let track = |covariance: &Covariance, draw: &mut rand_chacha::ChaCha8Rng| {
                let state = |_| {
                    Some(GaussianState {
                        mean: State::new(1e5, -3e4, 200.0, 10.0) + error(covariance, draw),
                        covariance: *covariance,
                    })
                };
                vec![(0..TIMES).map(state).collect()]
            };
            let sensors = [
                track(&covariances[0], &mut draw),
                track(&covariances[1], &mut draw),
            ];
            let pair = evidence(estimates(&sensors, true), Times::All)
                .pair(0, 1)
                .unwrap();
            assert_eq!(pair.times, TIMES);
            rejected += usize::from(pair.lambda > threshold);
            pair.lambda
        })
        .collect();
    let (distance, allowed) = kolmogorov_smirnov(lambdas, |value| {
        1.0 - chi_square_tail(value, 4.0 * TIMES as f64)
    });
    assert!(distance < allowed, "{distance} against {allowed}");
    let interval = wilson_interval(rejected as f64, 10_000, 0.99).unwrap();
    assert!(
        interval.low < 0.01 && 0.01 < interval.high,
        "{rejected} of 10 000"
    );
}

#[test]
fn q_of_five_tracks_of_one_target_is_chi_square() {
    let mut draw = Seed { seed: 2, run: 0 }.stream(Purpose::LocalTracks, 0, 0);
    let values: Vec<f64> = (0..4_000)
        .map(|_| {
            let mut sensor = || {
                let covariance = random_covariance(&mut draw);
                vec![vec![Some(GaussianState {
                    mean: State::new(-2e4, 4e4, 3.0, 0.0) + error(&covariance, &mut draw),
                    covariance,
                })]]
            };
            let sensors: Vec<_> = (0..5).map(|_| sensor()).collect();
            let spread = evidence(estimates(&sensors, true), Times::All).spread(&[0, 1, 2, 3, 4]);
            assert_eq!((spread.degrees_of_freedom, spread.times), (16, 1));
            spread.q
        })
        .collect();
    let (distance, allowed) =
        kolmogorov_smirnov(values, |value| 1.0 - chi_square_tail(value, 16.0));
    assert!(distance < allowed, "{distance} against {allowed}");
}

#[test]
fn errors_that_last_reject_far_more_than_alpha() {
    // At a correlation of 0.9 the test of all times at 1 % rejects over 5 % of the true pairs; that of one time does not.
    let mut draw = Seed { seed: 3, run: 0 }.stream(Purpose::LocalTracks, 0, 0);
    let (times, runs) = (20, 2_000);
    let covariance = Covariance::identity();
    let mut rejected = [0; 2];
    for _ in 0..runs {
        let mut track = || {
            let mut last = error(&covariance, &mut draw);
            let mut next = |_| {
                last = last * 0.9 + error(&covariance, &mut draw) * (1.0f64 - 0.81).sqrt();
                Some(GaussianState {
                    mean: last,
                    covariance,
                })
            };
            vec![(0..times).map(&mut next).collect::<Vec<_>>()]
        };
        let sensors = [track(), track()];
        for (count, (kind, degrees)) in rejected
            .iter_mut()
            .zip([(Times::All, 80.0), (Times::Latest, 4.0)])
        {
            let lambda = evidence(estimates(&sensors, true), kind)
                .pair(0, 1)
                .unwrap()
                .lambda;
            *count += usize::from(lambda > chi_square_quantile(0.99, degrees));
        }
    }
    assert!(rejected[0] as f64 / f64::from(runs) > 0.05, "{rejected:?}");
    let interval = wilson_interval(rejected[1] as f64, runs as usize, 0.99).unwrap();
    assert!(interval.low < 0.01 && 0.01 < interval.high, "{rejected:?}");
}

#[test]
fn two_sensors_by_hand() {
    // P = diag(4, 9, 1, 1) and diag(12, 7, 3, 3): C = diag(16, 16, 4, 4). t = (4, 0, 0, 0) at both times and velocities equal:
    // λ = 2 · 16 / 16 = 2, 8 degrees of freedom.
    let left = vec![vec![Some(state(0.0, 0.0, [4.0, 9.0, 1.0, 1.0])); 2]];
    let right = vec![vec![Some(state(4.0, 0.0, [12.0, 7.0, 3.0, 3.0])); 2]];
    let sensors = [left, right];
    let all = evidence(estimates(&sensors, true), Times::All);
    let pair = all.pair(0, 1).unwrap();
    assert!((pair.lambda - 2.0).abs() < 1e-12 && pair.times == 2);
    let spread = all.spread(&[0, 1]);
    assert!((spread.q - 2.0).abs() < 1e-9 && spread.degrees_of_freedom == 8);
    assert!((p_value(&spread).unwrap() - chi_square_tail(2.0, 8.0)).abs() < 1e-12);
    let latest = evidence(estimates(&sensors, true), Times::Latest);
    assert!(
        (latest.pair(0, 1).unwrap().lambda - 1.0).abs() < 1e-12
            && latest.spread(&[0, 1]).degrees_of_freedom == 4
    );
    // Without velocities the same λ with half of the degrees of freedom.
    let positions = evidence(estimates(&sensors, false), Times::All);
    assert!(
        (positions.pair(0, 1).unwrap().lambda - 2.0).abs() < 1e-12
            && positions.spread(&[0, 1]).degrees_of_freedom == 4
    );
    // The costs: χ²(0.99, 8) = 20.0902, χ²(0.99, 4) = 13.2767.
    let cost = |statistic| {
        correlation(estimates(&sensors, true), statistic, &[0.9; 2])
            .problem(2)
            .cost(&[0, 1])
            .unwrap()
    };
    let expected = 2.0 - 20.090_235;
    assert!(
        (cost(Statistic::Chain {
            alpha: 0.01,
            k: Times::All
        }) - expected)
            .abs()
            < 1e-5
    );
    assert!(
        (cost(Statistic::AllPairs {
            alpha: 0.01,
            k: Times::All,
            gate_probability: 0.9999
        }) - expected)
            .abs()
            < 1e-5
    );
    assert!(
        (cost(Statistic::Fused {
            alpha: 0.01,
            k: Times::All,
            gate_probability: 0.9999
        }) - expected)
            .abs()
            < 1e-5
    );
    let latest = cost(Statistic::Chain {
        alpha: 0.01,
        k: Times::Latest,
    });
    assert!((latest - (1.0 - 13.276_704)).abs() < 1e-5);
}

#[test]
fn three_sensors_by_hand() {
    // One axis at 0, 3, 6 with σ = 1 and equal elsewhere: λ = 4.5, 4.5, 18; b = 9, all pairs 27, Q = 9 + 0 + 9 about the mean 3.
    let track = |x_m: f64| vec![vec![Some(state(x_m, 0.0, [1.0; 4]))]];
    let sensors = [track(0.0), track(3.0), track(6.0)];
    let made = || estimates(&sensors, false);
    let spread = evidence(made(), Times::All).spread(&[0, 1, 2]);
    assert!((spread.q - 18.0).abs() < 1e-9 && spread.degrees_of_freedom == 4);
    let quantile = |degrees: f64| chi_square_quantile(0.99, degrees);
    let chain = correlation(
        made(),
        Statistic::Chain {
            alpha: 0.01,
            k: Times::All,
        },
        &[0.9; 3],
    )
    .problem(1);
    assert!((chain.cost(&[0, 1, 2]).unwrap() - (9.0 - 2.0 * quantile(2.0))).abs() < 1e-9);
    assert_eq!(chain.cost(&[0, 2]), None, "λ = 18 is no link of a chain");
    let all = correlation(
        made(),
        Statistic::AllPairs {
            alpha: 0.01,
            k: Times::All,
            gate_probability: 0.9999,
        },
        &[0.9; 3],
    )
    .problem(1);
    assert!((all.cost(&[0, 1, 2]).unwrap() - (27.0 - 3.0 * quantile(2.0))).abs() < 1e-9);
    let fused = correlation(made(), FUSED, &[0.9; 3]).problem(1);
    assert!((fused.cost(&[0, 1, 2]).unwrap() - (18.0 - 2.0 * quantile(2.0))).abs() < 1e-9);
    assert_eq!(fused.cost(&[1]), Some(0.0));
}

const FUSED: Statistic = Statistic::Fused {
    alpha: 0.01,
    k: Times::All,
    gate_probability: 0.9999,
};

#[test]
fn a_fused_tuple_allows_what_its_links_allow() {
    // Three tracks at one place, compared by position: Q = 0. At two times of all three there are two links of 2 · 2 degrees of
    // freedom, χ²(0.99, 4) = 13.2767; where the third is there once only, one of them has 2: χ²(0.99, 2) = 9.2103.
    let here = Some(state(0.0, 0.0, [1.0; 4]));
    let cost = |last: [Option<GaussianState>; 2], tuple: &[u32]| {
        let sensors = [
            vec![vec![here; 2]],
            vec![vec![here; 2]],
            vec![last.to_vec()],
        ];
        let problem = correlation(estimates(&sensors, false), FUSED, &[0.9; 3]).problem(2);
        problem.cost(tuple).unwrap()
    };
    let expected = [
        ([here, here], [0, 1, 2].as_slice(), -2.0 * 13.276_704),
        ([here, None], &[0, 1, 2], -13.276_704 - 9.210_340),
        ([None, here], &[0, 2], -9.210_340),
        ([here, here], &[0, 2], -13.276_704),
    ];
    for (last, tuple, expected) in expected {
        let found = cost(last, tuple);
        assert!((found - expected).abs() < 1e-5, "{tuple:?}: {found}");
    }
}

#[test]
fn the_likelihood_ratio_is_the_integral() {
    // Three tracks in the plane whose y agree exactly: the integral over x by Simpson's rule, that over y by the same.
    let sigmas = [1.0, 2.0, 1.5];
    let places = [0.0, 1.0, -0.5];
    let track = |index: usize| {
        vec![vec![Some(state(
            places[index],
            0.0,
            [sigmas[index] * sigmas[index]; 4],
        ))]]
    };
    let sensors: Vec<_> = (0..3).map(track).collect();
    let density = |x: f64, mean: f64, sigma: f64| {
        (-0.5 * ((x - mean) / sigma).powi(2)).exp() / (sigma * std::f64::consts::TAU.sqrt())
    };
    let integral = |members: &[usize], means: &dyn Fn(usize) -> f64| {
        let (steps, low, high) = (4000, -20.0, 20.0);
        let width = (high - low) / steps as f64;
        let value = |step: usize| {
            let x = low + step as f64 * width;
            let weight = if step == 0 || step == steps {
                1.0
            } else if step % 2 == 1 {
                4.0
            } else {
                2.0
            };
            weight
                * members
                    .iter()
                    .map(|&index| density(x, means(index), sigmas[index]))
                    .product::<f64>()
        };
        (0..=steps).map(value).sum::<f64>() * width / 3.0
    };
    let (target, clutter, p_d) = (1e-3, 2e-4, [0.9, 0.8, 0.7]);
    let statistic = Statistic::LikelihoodRatio {
        k: Times::All,
        gate_probability: 0.9999,
        p_d: 0.9,
        target_density: Some(target),
        false_density: Some(clutter),
    };
    let problem = correlation(estimates(&sensors, false), statistic, &p_d).problem(1);
    let absent = |sensor: usize| 1.0 - p_d[sensor];
    for members in [vec![0usize, 1, 2], vec![0, 1], vec![1, 2]] {
        let alone = |sensor: usize| {
            clutter
                + target
                    * p_d[sensor]
                    * (0..3)
                        .filter(|&other| other != sensor)
                        .map(absent)
                        .product::<f64>()
        };
        let detected: f64 = (0..3)
            .map(|sensor| {
                if members.contains(&sensor) {
                    p_d[sensor]
                } else {
                    absent(sensor)
                }
            })
            .product();
        let kinematic = integral(&members, &|index| places[index]) * integral(&members, &|_| 0.0);
        let expected = -(target * detected * kinematic
            / members.iter().map(|&sensor| alone(sensor)).product::<f64>())
        .ln();
        let tuple: Vec<u32> = members.iter().map(|&member| member as u32).collect();
        let cost = problem.cost(&tuple).unwrap();
        assert!(
            (cost - expected).abs() < 1e-6,
            "{members:?}: {cost} against {expected}"
        );
    }
}

#[test]
fn the_likelihood_ratio_of_full_states_is_the_density_of_their_difference() {
    let mut draw = Seed { seed: 4, run: 0 }.stream(Purpose::LocalTracks, 0, 0);
    let covariances = [random_covariance(&mut draw), random_covariance(&mut draw)];
    let means = [
        error(&covariances[0], &mut draw),
        error(&covariances[1], &mut draw),
    ];
    let track = |index: usize| {
        vec![vec![Some(GaussianState {
            mean: means[index],
            covariance: covariances[index],
        })]]
    };
    let spread = evidence(estimates(&[track(0), track(1)], true), Times::All).spread(&[0, 1]);
    let sum = covariances[0] + covariances[1];
    let difference = means[0] - means[1];
    let squared = difference.dot(&(sum.try_inverse().unwrap() * difference));
    let log_density = -0.5 * (squared + 4.0 * std::f64::consts::TAU.ln() + sum.determinant().ln());
    assert!((spread.q - squared).abs() < 1e-9 && (spread.log_density - log_density).abs() < 1e-9);
}

#[test]
fn a_cross_covariance_of_nothing_changes_nothing_and_a_coefficient_shrinks_what_may_differ() {
    let mut draw = Seed { seed: 5, run: 0 }.stream(Purpose::LocalTracks, 0, 0);
    let mut track = || {
        let covariance = random_covariance(&mut draw);
        vec![vec![Some(GaussianState {
            mean: error(&covariance, &mut draw),
            covariance,
        })]]
    };
    let sensors = [track(), track(), track()];
    let made = estimates(&sensors, true);
    let independent = evidence(made.clone(), Times::All);
    let pairs = [(0, 1), (0, 2), (1, 2)];
    let with = |coefficient: f64| {
        let cross = Some(Arc::new(CrossTable::with_coefficient(
            &made,
            &pairs,
            coefficient,
        )));
        Evidence {
            cross,
            ..evidence(made.clone(), Times::All)
        }
    };
    let (plain, zero) = (independent.spread(&[0, 1, 2]), with(0.0).spread(&[0, 1, 2]));
    assert!((plain.q - zero.q).abs() < 1e-9 && (plain.log_density - zero.log_density).abs() < 1e-9);
    assert!(
        (independent.pair(0, 2).unwrap().lambda - with(0.0).pair(0, 2).unwrap().lambda).abs()
            < 1e-12
    );
    // Equal covariances: C = 2 (1 − ρ) P, so that ρ = 0.5 doubles λ.
    let covariance = random_covariance(&mut draw);
    let alike = |mean: State| vec![vec![Some(GaussianState { mean, covariance })]];
    let made = estimates(
        &[alike(State::zeros()), alike(State::new(1.0, 2.0, 0.5, 0.1))],
        true,
    );
    let cross = Some(Arc::new(CrossTable::with_coefficient(
        &made,
        &[(0, 1)],
        0.5,
    )));
    let correlated = Evidence {
        cross,
        ..evidence(made.clone(), Times::All)
    };
    let single = evidence(made, Times::All).pair(0, 1).unwrap().lambda;
    assert!((correlated.pair(0, 1).unwrap().lambda / single - 2.0).abs() < 1e-9);
    assert!((correlated.spread(&[0, 1]).q / single - 2.0).abs() < 1e-9);
}

#[test]
fn every_pair_within_the_gate_is_found() {
    let mut draw = Seed { seed: 6, run: 0 }.stream(Purpose::LocalTracks, 0, 0);
    for _ in 0..20 {
        let mut track = || {
            let sigma = 0.5 + 5.0 * draw.random::<f64>();
            let mut place = || 20.0 * draw.random::<f64>();
            let mut state = |_| Some(state(place(), place(), [sigma, 2.0 * sigma, 1.0, 1.0]));
            (0..2).map(&mut state).collect::<Vec<_>>()
        };
        let mut sensor = || (0..12).map(|_| track()).collect::<Vec<_>>();
        let sensors = [sensor(), sensor(), sensor()];
        let made = estimates(&sensors, false);
        let all = evidence(made.clone(), Times::All);
        let statistic = Statistic::AllPairs {
            alpha: 0.01,
            k: Times::All,
            gate_probability: 0.99,
        };
        let problem = correlation(made, statistic, &[0.9; 3]).problem(2);
        let (mut linked, gate) = (0, chi_square_quantile(0.99, 2.0));
        for a in 0..36u32 {
            for b in a + 1..36 {
                let expected = a / 12 != b / 12 && all.pair(a, b).unwrap().lambda <= 2.0 * gate;
                assert_eq!(problem.link(a, b).is_some(), expected, "{a} {b}");
                linked += usize::from(expected);
            }
        }
        assert!(linked > 20, "{linked}");
    }
}
