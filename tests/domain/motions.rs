//! Motion models: published and computed steps to all digits, steps that compose, limits, and slopes.
//! The numbers of steps come from matrix exponentials (Van Loan's method) in another program.

use nalgebra::{Cholesky, Matrix4, Matrix5, SMatrix, SVector, Vector4, Vector5};
use proptest::prelude::*;
use trackloom_domain::model::motion::Motion;
use trackloom_domain::model::motion::constant_acceleration::ConstantAcceleration;
use trackloom_domain::model::motion::constant_velocity::ConstantVelocity;
use trackloom_domain::model::motion::coordinated_turn::CoordinatedTurn;
use trackloom_domain::model::motion::ornstein_uhlenbeck::OrnsteinUhlenbeck;
use trackloom_domain::model::motion::singer::Singer;
use trackloom_domain::model::motion::unknown_turn::UnknownTurn;
use trackloom_domain::model::state::GaussianState;

/// F, found by moving states of which one variable is 1, and Q.
fn step_of<M: Motion<N>, const N: usize>(motion: &M, dt_s: f64) -> [SMatrix<f64, N, N>; 2] {
    let still = moved(motion, dt_s, SVector::zeros()).mean;
    let mut transition = SMatrix::<f64, N, N>::zeros();
    for variable in 0..N {
        let one = SVector::from_fn(|row, _| f64::from(u8::from(row == variable)));
        let mean = moved(motion, dt_s, one).mean - still;
        transition.set_column(variable, &mean);
    }
    [transition, moved(motion, dt_s, SVector::zeros()).covariance]
}

/// A state that is certain, one step later.
fn moved<M: Motion<N>, const N: usize>(
    motion: &M,
    dt_s: f64,
    mean: SVector<f64, N>,
) -> GaussianState<N> {
    let mut state = GaussianState {
        mean,
        covariance: SMatrix::zeros(),
    };
    M::predict(&motion.step(dt_s), &mut state);
    state
}

/// Of the axis of x, whose variables lie every second place.
fn of_axis<const N: usize, const D: usize>(matrix: &SMatrix<f64, N, N>) -> SMatrix<f64, D, D> {
    SMatrix::from_fn(|row, column| matrix[(2 * row, 2 * column)])
}

/// Relative to 1 and what is larger.
fn assert_near<const R: usize, const C: usize>(
    found: &SMatrix<f64, R, C>,
    expected: &[[f64; C]; R],
    tolerance: f64,
) {
    for row in 0..R {
        for column in 0..C {
            let (found, expected) = (found[(row, column)], expected[row][column]);
            let apart = (found - expected).abs();
            assert!(
                apart <= tolerance * expected.abs().max(1.0),
                "{row} {column}: {found} {expected}"
            );
        }
    }
}

#[test]
fn constant_velocity_and_acceleration_over_two_seconds() {
    let velocity = ConstantVelocity {
        spectral_density: 0.5,
    };
    let [f, q] = step_of::<_, 4>(&velocity, 2.0);
    assert_near(&of_axis::<4, 2>(&f), &[[1.0, 2.0], [0.0, 1.0]], 1e-12);
    assert_near(&of_axis::<4, 2>(&q), &[[4.0 / 3.0, 1.0], [1.0, 1.0]], 1e-12);
    let acceleration = ConstantAcceleration {
        spectral_density: 0.5,
        initial_sigma: 1.0,
    };
    let [f, q] = step_of::<_, 6>(&acceleration, 2.0);
    let expected = [[1.0, 2.0, 2.0], [0.0, 1.0, 2.0], [0.0, 0.0, 1.0]];
    assert_near(&of_axis::<6, 3>(&f), &expected, 1e-12);
    let expected = [
        [0.8, 1.0, 2.0 / 3.0],
        [1.0, 4.0 / 3.0, 1.0],
        [2.0 / 3.0, 1.0, 1.0],
    ];
    assert_near(&of_axis::<6, 3>(&q), &expected, 1e-12);
}

fn singer(maneuver_sigma_mps2: f64, maneuver_time_s: f64) -> Singer {
    Singer {
        maneuver_sigma_mps2,
        maneuver_time_s,
    }
}

#[test]
fn singer_over_a_fifth_of_its_time() {
    let [f, q] = step_of::<_, 6>(&singer(3.0, 10.0), 2.0);
    let expected = [
        [1.0, 2.0, 1.873075307798],
        [0.0, 1.0, 1.81269246922],
        [0.0, 0.0, 0.818730753078],
    ];
    assert_near(&of_axis::<6, 3>(&f), &expected, 1e-12);
    let expected = [
        [2.581635177769, 3.157569997815, 1.968887459851],
        [3.157569997815, 4.142669648659, 2.957268589171],
        [1.968887459851, 2.957268589171, 2.967119585679],
    ];
    assert_near(&of_axis::<6, 3>(&q), &expected, 1e-12);
}

/// Where the textbook's formula is 80 % off in double precision.
#[test]
fn singer_over_a_thousandth_of_its_time() {
    let [f, q] = step_of::<_, 6>(&singer(3.0, 60.0), 0.05);
    let expected = [
        [1.0, 0.05, 0.001249652850104],
        [0.0, 1.0, 0.0499791724525],
        [0.0, 0.0, 0.9991670137925],
    ];
    assert_near(&of_axis::<6, 3>(&f), &expected, 1e-12);
    let expected = [
        [4.685330506835e-9, 2.342448368658e-7, 6.244794053036e-6],
        [2.342448368658e-7, 1.249219053729e-5, 0.0003746876518555],
        [6.244794053036e-6, 0.0003746876518555, 0.01498750694155],
    ];
    let q = of_axis::<6, 3>(&q);
    for (found, expected) in q.transpose().iter().zip(expected.as_flattened()) {
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
}

#[test]
fn singer_between_constant_velocity_and_constant_acceleration() {
    // τ → ∞ with 2 σ²/τ = q: white jerk; τ → 0 with 2 σ² τ = q: white acceleration.
    let q: f64 = 0.3;
    let slow = singer((q * 1e9 / 2.0).sqrt(), 1e9);
    let white_jerk = ConstantAcceleration {
        spectral_density: q,
        initial_sigma: 1.0,
    };
    let ([f, noise], [expected_f, expected]) = (
        step_of::<_, 6>(&slow, 4.0),
        step_of::<_, 6>(&white_jerk, 4.0),
    );
    assert!((f - expected_f).abs().max() < 1e-7 && (noise - expected).abs().max() < 1e-6);
    let fast = singer((q / 2e-6).sqrt(), 1e-6);
    let white_acceleration = ConstantVelocity {
        spectral_density: q,
    };
    let ([f, noise], [expected_f, expected]) = (
        step_of::<_, 6>(&fast, 4.0),
        step_of::<_, 4>(&white_acceleration, 4.0),
    );
    let (f, noise) = (f.fixed_view::<4, 4>(0, 0), noise.fixed_view::<4, 4>(0, 0));
    assert!((f - expected_f).abs().max() < 1e-6);
    assert!((noise - expected).abs().max() < 1e-5, "{noise}");
}

fn pulled_back(damping_per_s: f64, spectral_density: f64, mean_mps: f64) -> OrnsteinUhlenbeck {
    OrnsteinUhlenbeck {
        damping_per_s,
        spectral_density,
        mean_velocity_mps: [mean_mps, 0.0],
    }
}

#[test]
fn ornstein_uhlenbeck_over_ten_seconds() {
    let [f, q] = step_of::<_, 4>(&pulled_back(0.02, 0.4, 0.0), 10.0);
    let expected = [[1.0, 9.063462346101], [0.0, 0.818730753078]];
    assert_near(&of_axis::<4, 2>(&f), &expected, 1e-12);
    let expected = [
        [115.0741569072, 16.42926993984],
        [16.42926993984, 3.296799539644],
    ];
    for (found, expected) in of_axis::<4, 2>(&q).iter().zip(expected.as_flattened()) {
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
    let state = moved(
        &pulled_back(0.02, 0.4, 5.0),
        10.0,
        Vector4::new(0.0, 0.0, 8.0, 0.0),
    );
    // 5 + 3 e^(−0.2), and 5 · 10 + 3 · 9.063….
    assert!((state.mean[2] - 7.456192259234).abs() < 1e-12);
    assert!((state.mean[0] - (50.0 + 3.0 * 9.063462346101)).abs() < 1e-11);
}

#[test]
fn ornstein_uhlenbeck_ends_as_constant_velocity_or_at_rest() {
    let velocity = ConstantVelocity {
        spectral_density: 0.4,
    };
    let ([f, q], [expected_f, expected]) = (
        step_of::<_, 4>(&pulled_back(1e-9, 0.4, 0.0), 10.0),
        step_of::<_, 4>(&velocity, 10.0),
    );
    assert!((f - expected_f).abs().max() < 1e-6 && (q - expected).abs().max() < 1e-5);
    // After 1e4 decay times the speed has its stationary variance q/2θ = 0.2.
    let [_, q] = step_of::<_, 4>(&pulled_back(1.0, 0.4, 0.0), 1e4);
    assert!((q[(2, 2)] - 0.2).abs() < 1e-12);
}

fn turn(turn_rate_radps: f64, spectral_density: f64) -> CoordinatedTurn {
    CoordinatedTurn {
        turn_rate_radps,
        spectral_density,
    }
}

#[test]
fn a_turn_of_three_degrees_a_second() {
    let motion = turn(3f64.to_radians(), 0.2);
    let state = moved(&motion, 5.0, Vector4::new(0.0, 0.0, 200.0, 0.0));
    let expected = Vector4::new(
        988.6159294654,
        130.1537562688,
        193.1851652578,
        51.7638090205,
    );
    assert!(
        (state.mean - expected).abs().max() < 1e-10,
        "{}",
        state.mean
    );
    let [f, q] = step_of::<_, 4>(&motion, 5.0);
    let expected = [
        [1.0, 0.0, 4.943079647327, -0.650768781344],
        [0.0, 1.0, 0.650768781344, 4.943079647327],
        [0.0, 0.0, 0.9659258262891, -0.2588190451025],
        [0.0, 0.0, 0.2588190451025, 0.9659258262891],
    ];
    assert_near(&f, &expected, 1e-12);
    let expected = [
        [8.304822008904, 0.0, 2.485753640659, 0.2174197317712],
        [0.0, 8.304822008904, -0.2174197317712, 2.485753640659],
        [2.485753640659, -0.2174197317712, 1.0, 0.0],
        [0.2174197317712, 2.485753640659, 0.0, 1.0],
    ];
    assert_near(&q, &expected, 1e-12);
}

#[test]
fn a_turn_that_is_hardly_one_is_straight() {
    let velocity = ConstantVelocity {
        spectral_density: 0.2,
    };
    let [expected_f, expected] = step_of::<_, 4>(&velocity, 5.0);
    let [f, q] = step_of::<_, 4>(&turn(1e-9, 0.2), 5.0);
    assert!((f - expected_f).abs().max() < 1e-6 && (q - expected).abs().max() < 1e-6);
    // a = T (1 − u²/6), b = T u/2 (1 − u²/12) with u = 5e-9.
    assert!((f[(0, 2)] - 5.0).abs() < 1e-12 && (f[(1, 2)] / 1.25e-8 - 1.0).abs() < 1e-12);
    let [f, q] = step_of::<_, 4>(&turn(0.0, 0.2), 5.0);
    assert!((f - expected_f).abs().max() < 1e-12 && (q - expected).abs().max() < 1e-12);
}

const UNKNOWN: UnknownTurn = UnknownTurn {
    spectral_density: 0.0,
    turn_density: 0.0,
    initial_sigma: 0.05,
};

/// F of the turn of unknown rate around a state, by what it makes of errors that go with one of the rate: the rate stays
/// what it was, so its covariances with the others are the sums of two columns.
fn slope(motion: &UnknownTurn, dt_s: f64, mean: &Vector5<f64>) -> Matrix5<f64> {
    let column = |error: Vector5<f64>| {
        let mut state = GaussianState {
            mean: *mean,
            covariance: error * error.transpose(),
        };
        UnknownTurn::predict(&motion.step(dt_s), &mut state);
        state.covariance.column(4).into_owned()
    };
    let rate = Vector5::ith(4, 1.0);
    let mut slope = Matrix5::zeros();
    slope.set_column(4, &column(rate));
    for variable in 0..4 {
        let both = column(rate + Vector5::ith(variable, 1.0));
        slope.set_column(variable, &(both - column(rate)));
    }
    slope
}

#[test]
fn the_slope_of_a_turn_of_unknown_rate() {
    let mean = Vector5::new(1000.0, 2000.0, 150.0, -80.0, 0.05);
    let after = moved(&UNKNOWN, 4.0, mean).mean;
    let expected = Vector5::new(
        1627.901467839,
        1741.929337204,
        162.9035331398,
        -48.60492660804,
        0.05,
    );
    assert!((after - expected).abs().max() < 1e-9, "{after}");
    let expected: [[f64; 5]; 5] = [
        [1.0, 0.0, 3.973386615901, -0.3986684431752, 474.2532943993],
        [0.0, 1.0, 0.3986684431752, 3.973386615901, 1273.019127273],
        [0.0, 0.0, 0.9800665778412, -0.1986693307951, 194.4197064322],
        [0.0, 0.0, 0.1986693307951, 0.9800665778412, 651.6141325592],
        [0.0, 0.0, 0.0, 0.0, 1.0],
    ];
    let found = slope(&UNKNOWN, 4.0, &mean);
    for (found, expected) in found.transpose().iter().zip(expected.as_flattened()) {
        let scale = expected.abs().max(1.0);
        assert!(
            (found - expected).abs() < 1e-12 * scale,
            "{found} {expected}"
        );
    }
    // ω → 0: (−T² vy/2, T² vx/2, −T vy, T vx, 1).
    let straight = Vector5::new(0.0, 0.0, 150.0, -80.0, 0.0);
    let found = slope(&UNKNOWN, 4.0, &straight).column(4).into_owned();
    let expected = Vector5::new(640.0, 1200.0, 320.0, 600.0, 1.0);
    assert!((found - expected).abs().max() < 1e-9, "{found}");
}

#[test]
fn the_slope_is_that_of_central_differences() {
    for rate_radps in [-0.3, -1e-6, 0.0, 1e-3, 0.11, 2.0] {
        let mean = Vector5::new(-50.0, 20.0, 90.0, 130.0, rate_radps);
        let found = slope(&UNKNOWN, 3.0, &mean);
        for variable in 0..5 {
            let step = Vector5::ith(variable, if variable == 4 { 1e-6 } else { 1e-3 });
            let [up, down] = [mean + step, mean - step].map(|mean| moved(&UNKNOWN, 3.0, mean).mean);
            let expected = (up - down) / (2.0 * step[variable]);
            let apart = (found.column(variable) - expected).abs().max();
            assert!(
                apart < 1e-6 * expected.norm().max(1.0),
                "{rate_radps} {variable}: {apart}"
            );
        }
    }
}

#[test]
fn what_disturbs_a_turn_of_unknown_rate() {
    let motion = UnknownTurn {
        spectral_density: 0.2,
        turn_density: 0.01,
        initial_sigma: 0.05,
    };
    let rate_radps = 3f64.to_radians();
    let noise = moved(&motion, 5.0, Vector5::new(0.0, 0.0, 200.0, 0.0, rate_radps)).covariance;
    let [_, known] = step_of::<_, 4>(&turn(rate_radps, 0.2), 5.0);
    assert!((noise.fixed_view::<4, 4>(0, 0) - known).abs().max() < 1e-12);
    assert!((noise[(4, 4)] - 0.05).abs() < 1e-15);
}

/// Noise and rest of a step, as one and in parts.
fn composes<M: Motion<N>, const N: usize>(
    motion: &M,
    parts: [f64; 2],
) -> Result<(), TestCaseError> {
    let root =
        SMatrix::<f64, N, N>::from_fn(|row, column| ((3 * row + 5 * column) % 7) as f64 - 2.5);
    let start = GaussianState {
        mean: SVector::from_fn(|row, _| row as f64 - 1.5),
        covariance: root * root.transpose() + SMatrix::identity(),
    };
    let (mut whole, mut in_parts) = (start, start);
    M::predict(&motion.step(parts[0] + parts[1]), &mut whole);
    for part in [parts[0], 0.0, parts[1]] {
        M::predict(&motion.step(part), &mut in_parts);
    }
    let sigmas = whole.covariance.diagonal().map(f64::sqrt);
    let mean = (whole.mean - in_parts.mean).component_div(&sigmas);
    prop_assert!(mean.abs().max() < 1e-9, "{}", mean);
    let scale = sigmas * sigmas.transpose();
    let covariance = (whole.covariance - in_parts.covariance).component_div(&scale);
    prop_assert!(covariance.abs().max() < 1e-9, "{}", covariance);
    Ok(())
}

/// Whether the correlations of Q have no eigenvalue below −1e-12.
fn is_noise<M: Motion<N>, const N: usize>(motion: &M, dt_s: f64) -> bool {
    let [_, q] = step_of::<M, N>(motion, dt_s);
    let sigmas = q.diagonal().map(|variance| variance.max(1e-300).sqrt());
    let correlations = SMatrix::<f64, N, N>::from_fn(|row, column| {
        q[(row, column)] / (sigmas[row] * sigmas[column])
    });
    Cholesky::new(correlations + SMatrix::identity() * 1e-12).is_some()
}

proptest! {
    #[test]
    fn two_steps_are_one_over_their_sum(
        first in 0.01..50.0f64, second in 0.01..50.0f64, q in 0.01..10.0f64, rate in -1.0..1.0f64, time in 0.1..200.0f64,
    ) {
        let parts = [first, second];
        composes::<_, 4>(&ConstantVelocity { spectral_density: q }, parts)?;
        composes::<_, 6>(&ConstantAcceleration { spectral_density: q, initial_sigma: 1.0 }, parts)?;
        composes::<_, 6>(&singer(q, time), parts)?;
        composes::<_, 4>(&pulled_back(1.0 / time, q, 3.0), parts)?;
        composes::<_, 4>(&turn(rate, q), parts)?;
    }

    #[test]
    fn noise_is_never_negative(exponent in -3.0..4.0f64, rate in -1.5..1.5f64, time in 0.1..1e4f64) {
        let dt_s = 10f64.powf(exponent);
        for is_noise in [
            is_noise::<_, 4>(&ConstantVelocity { spectral_density: 1.0 }, dt_s),
            is_noise::<_, 6>(&ConstantAcceleration { spectral_density: 1.0, initial_sigma: 1.0 }, dt_s),
            is_noise::<_, 6>(&singer(1.0, time), dt_s),
            is_noise::<_, 4>(&pulled_back(1.0 / time, 1.0, 0.0), dt_s),
            is_noise::<_, 4>(&turn(rate, 1.0), dt_s),
        ] {
            prop_assert!(is_noise, "over {}", dt_s);
        }
    }
}

#[test]
fn over_no_time_nothing_changes() {
    for [f, q] in [
        step_of::<_, 4>(&turn(0.3, 1.0), 0.0),
        step_of::<_, 4>(&pulled_back(0.1, 1.0, 0.0), 0.0),
    ] {
        assert_eq!((f, q), (Matrix4::identity(), Matrix4::zeros()));
    }
    let [f, q] = step_of::<_, 6>(&singer(1.0, 20.0), 0.0);
    assert_eq!((f, q), (SMatrix::identity(), SMatrix::zeros()));
}
