//! Motion in space: steps compose, the horizontal moves as in the plane, and beside it the vertical.

use super::belief;
use nalgebra::{SMatrix, SVector};
use proptest::prelude::*;
use trackloom_domain::filtering::climbing::Climbing;
use trackloom_domain::filtering::motions::AnyMotion;
use trackloom_domain::model::motion::Motion;
use trackloom_domain::model::motion::constant_acceleration::ConstantAcceleration;
use trackloom_domain::model::motion::constant_velocity::ConstantVelocity;
use trackloom_domain::model::motion::coordinated_turn::CoordinatedTurn;
use trackloom_domain::model::motion::in_space::ClimbingVelocity;
use trackloom_domain::model::motion::ornstein_uhlenbeck::OrnsteinUhlenbeck;
use trackloom_domain::model::motion::singer::Singer;
use trackloom_domain::model::motion::unknown_turn::UnknownTurn;
use trackloom_domain::model::state::GaussianState;

const VERTICAL: ConstantVelocity = ConstantVelocity {
    spectral_density: 0.03,
};
const HORIZONTAL: ConstantVelocity = ConstantVelocity {
    spectral_density: 1.5,
};

fn linear() -> [AnyMotion; 5] {
    [
        AnyMotion::ConstantVelocity(HORIZONTAL),
        AnyMotion::CoordinatedTurn(CoordinatedTurn {
            turn_rate_radps: -0.05,
            spectral_density: 0.7,
        }),
        AnyMotion::OrnsteinUhlenbeck(OrnsteinUhlenbeck {
            damping_per_s: 0.02,
            spectral_density: 0.4,
            mean_velocity_mps: [3.0, -5.0],
        }),
        AnyMotion::ConstantAcceleration(ConstantAcceleration {
            spectral_density: 0.1,
            initial_sigma: 1.0,
        }),
        AnyMotion::Singer(Singer {
            maneuver_sigma_mps2: 2.0,
            maneuver_time_s: 15.0,
        }),
    ]
}

const TURN: AnyMotion = AnyMotion::UnknownTurn(UnknownTurn {
    spectral_density: 0.5,
    turn_density: 1e-5,
    initial_sigma: 0.05,
});

/// A state with so many variables, correlated all.
fn state(variables: usize) -> GaussianState<9> {
    let six = belief(
        SVector::from([100.0, -40.0, 900.0, 80.0, 60.0, -4.0]),
        30.0,
        6.0,
    );
    let mut state = GaussianState::<9> {
        mean: SVector::zeros(),
        covariance: SMatrix::zeros(),
    };
    state.mean.fixed_rows_mut::<6>(0).copy_from(&six.mean);
    state
        .covariance
        .fixed_view_mut::<6, 6>(0, 0)
        .copy_from(&six.covariance);
    for variable in 6..variables {
        state.mean[variable] = 0.02 * variable as f64 - 0.1;
        state.covariance[(variable, variable)] = 4e-4;
        for other in 0..6 {
            state.covariance[(variable, other)] = 1e-3 * (other as f64 - 2.0);
            state.covariance[(other, variable)] = 1e-3 * (other as f64 - 2.0);
        }
    }
    state
}

fn variables(motion: &AnyMotion) -> usize {
    match motion {
        AnyMotion::UnknownTurn(_) => 7,
        AnyMotion::ConstantAcceleration(_) | AnyMotion::Singer(_) => 9,
        _ => 6,
    }
}

fn moved(motion: AnyMotion, dt_s: f64, mut state: GaussianState<9>) -> GaussianState<9> {
    let climbing = Climbing {
        motion,
        vertical: VERTICAL,
    };
    Climbing::predict(&climbing.step(dt_s), &mut state);
    state
}

/// Variables of a state in space as those of the plane.
fn flat<const N: usize>(state: &GaussianState<9>, places: [usize; N]) -> GaussianState<N> {
    GaussianState {
        mean: SVector::from(places.map(|place| state.mean[place])),
        covariance: SMatrix::from_fn(|row, column| state.covariance[(places[row], places[column])]),
    }
}

fn assert_alike<const N: usize>(found: &GaussianState<N>, wanted: &GaussianState<N>) {
    let (mean, covariance) = (
        found.mean - wanted.mean,
        found.covariance - wanted.covariance,
    );
    assert!(
        mean.norm() <= 1e-11 * wanted.mean.norm(),
        "{} {}",
        found.mean,
        wanted.mean
    );
    assert!(
        covariance.norm() <= 1e-11 * wanted.covariance.norm(),
        "{} {}",
        found.covariance,
        wanted.covariance
    );
}

proptest! {
    #[test]
    fn two_steps_are_one_over_their_sum(first_s in 0.0..40.0f64, second_s in 0.0..40.0f64) {
        for motion in linear() {
            let start = state(variables(&motion));
            let whole = moved(motion, first_s + second_s, start);
            let parts = moved(motion, second_s, moved(motion, first_s, start));
            assert!((whole.mean - parts.mean).norm() <= 1e-9 * whole.mean.norm());
            assert!((whole.covariance - parts.covariance).norm() <= 1e-9 * whole.covariance.norm());
        }
    }

    #[test]
    fn without_its_noise_a_turn_of_a_sure_rate_composes(first_s in 0.0..20.0f64, second_s in 0.0..20.0f64) {
        let motion = AnyMotion::UnknownTurn(UnknownTurn { spectral_density: 0.5, turn_density: 0.0, initial_sigma: 0.0 });
        let mut start = state(7);
        for other in 0..7 {
            start.covariance[(6, other)] = 0.0;
            start.covariance[(other, 6)] = 0.0;
        }
        let whole = moved(motion, first_s + second_s, start);
        let parts = moved(motion, second_s, moved(motion, first_s, start));
        assert!((whole.mean - parts.mean).norm() <= 1e-9 * whole.mean.norm());
        assert!((whole.covariance - parts.covariance).norm() <= 1e-9 * whole.covariance.norm());
    }
}

#[test]
fn over_no_time_nothing_changes() {
    for motion in linear().into_iter().chain([TURN]) {
        let start = state(variables(&motion));
        assert_alike(&moved(motion, 0.0, start), &start);
    }
}

#[test]
fn the_horizontal_moves_as_in_the_plane_and_the_vertical_by_itself() {
    for motion in linear().into_iter().chain([TURN]) {
        let start = state(variables(&motion));
        let end = moved(motion, 4.0, start);
        match variables(&motion) {
            7 => {
                const OF_TURN: [usize; 5] = [0, 1, 3, 4, 6];
                let mut plane = flat(&start, OF_TURN);
                AnyMotion::predict(&Motion::<5>::step(&motion, 4.0), &mut plane);
                assert_alike(&flat(&end, OF_TURN), &plane);
            }
            9 => {
                const ACCELERATED: [usize; 6] = [0, 1, 3, 4, 6, 7];
                let mut plane = flat(&start, ACCELERATED);
                AnyMotion::predict(&Motion::<6>::step(&motion, 4.0), &mut plane);
                assert_alike(&flat(&end, ACCELERATED), &plane);
                // Up is as east and north.
                const TURNED: [usize; 6] = [0, 2, 3, 5, 6, 8];
                let mut upright = flat(&start, TURNED);
                AnyMotion::predict(&Motion::<6>::step(&motion, 4.0), &mut upright);
                assert_alike(&flat(&end, TURNED), &upright);
                continue;
            }
            _ => {
                let mut plane = flat(&start, [0, 1, 3, 4]);
                AnyMotion::predict(&Motion::<4>::step(&motion, 4.0), &mut plane);
                assert_alike(&flat(&end, [0, 1, 3, 4]), &plane);
            }
        }
        let mut vertical = flat(&start, [2, 5]);
        ConstantVelocity::predict(&Motion::<2>::step(&VERTICAL, 4.0), &mut vertical);
        assert_alike(&flat(&end, [2, 5]), &vertical);
    }
}

#[test]
fn the_usual_motion_is_the_same_alone_and_as_one_of_several() {
    let alone = ClimbingVelocity {
        horizontal: HORIZONTAL,
        vertical: VERTICAL,
    };
    let start = state(6);
    let mut own = start.leading::<6>();
    ClimbingVelocity::predict(&alone.step(3.0), &mut own);
    assert_eq!(moved(linear()[0], 3.0, start).leading::<6>(), own);
    // q T³/3: the vertical is calmer.
    let mut sure = GaussianState::<6> {
        mean: SVector::zeros(),
        covariance: SMatrix::zeros(),
    };
    ClimbingVelocity::predict(&alone.step(3.0), &mut sure);
    let of_place = [0, 1, 2].map(|axis| sure.covariance[(axis, axis)]);
    assert!((of_place[0] - 13.5).abs() < 1e-12 && (of_place[1] - 13.5).abs() < 1e-12);
    assert!((of_place[2] - 0.27).abs() < 1e-12);
}

/// ∂f/∂x of a turn of unknown rate, cross terms with the vertical included.
#[test]
fn a_turn_in_space_is_linearised_as_it_moves() {
    let start = state(7);
    let sharp = |mean| GaussianState {
        mean,
        covariance: SMatrix::zeros(),
    };
    let mut slopes = SMatrix::<f64, 9, 9>::identity();
    for variable in 0..7 {
        let step = SVector::<f64, 9>::ith(variable, if variable == 6 { 1e-6 } else { 1e-2 });
        let ahead = moved(TURN, 5.0, sharp(start.mean + step)).mean;
        let behind = moved(TURN, 5.0, sharp(start.mean - step)).mean;
        slopes.set_column(variable, &((ahead - behind) / (2.0 * step[variable])));
    }
    let noise = moved(TURN, 5.0, sharp(start.mean)).covariance;
    let wanted = slopes * start.covariance * slopes.transpose() + noise;
    let found = moved(TURN, 5.0, start).covariance;
    assert!(
        (found - wanted).norm() < 1e-7 * wanted.norm(),
        "{found} {wanted}"
    );
}
