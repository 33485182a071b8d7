//! Every filter keeps its covariances healthy, is consistent where theory says so, and agrees with the others where they
//! must agree.

use nalgebra::{Cholesky, Matrix4, SMatrix, SVector, Vector4};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use trackloom_domain::filtering::Filter;
use trackloom_domain::filtering::bearing_only::BearingOnly;
use trackloom_domain::filtering::converted::Converted;
use trackloom_domain::filtering::extended::Extended;
use trackloom_domain::filtering::kalman::Kalman;
use trackloom_domain::filtering::mixture::{WeightedInnovation, update};
use trackloom_domain::filtering::prediction::Transition;
use trackloom_domain::filtering::unscented::Unscented;
use trackloom_domain::math::angle;
use trackloom_domain::math::rng::{Purpose, Seed};
use trackloom_domain::model::scan::Measurement;
use trackloom_domain::model::sensor::{MeasurementModel, Polar, RangeRate, Sensor};
use trackloom_domain::model::state::{GaussianState, Position};

const KALMAN: Kalman = Kalman {
    process_noise_m2ps3: 1.0,
};
const EXTENDED: Extended = Extended {
    process_noise_m2ps3: 1.0,
};
const UNSCENTED: Unscented = Unscented {
    process_noise_m2ps3: 1.0,
    alpha: 1.0,
    beta: 2.0,
    kappa: 0.0,
};
const CONVERTED: Converted = Converted {
    process_noise_m2ps3: 1.0,
};

fn sensor(report: MeasurementModel) -> Sensor {
    Sensor {
        sensor_id: "radar".into(),
        p_d: 0.9,
        clutter_density: 1e-8,
        report,
    }
}

fn positions() -> Sensor {
    sensor(MeasurementModel::Position {
        sigma_x_m: 15.0,
        sigma_y_m: 5.2,
    })
}

fn polar(sigma_bearing_rad: f64) -> Sensor {
    let range_rate = Some(RangeRate {
        sigma_mps: 0.5,
        span_mps: 600.0,
    });
    sensor(MeasurementModel::Polar(Polar {
        place_m: Position::new(100.0, -50.0),
        sigma_range_m: 15.0,
        sigma_bearing_rad,
        range_rate,
    }))
}

fn stream(entity: u64) -> ChaCha8Rng {
    Seed { seed: 11, run: 0 }.stream(Purpose::Detection, entity, 0)
}

fn normal(draw: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(draw)
}

fn normals<const N: usize>(draw: &mut ChaCha8Rng) -> SVector<f64, N> {
    SVector::from_fn(|_, _| normal(draw))
}

/// A million updates of random tracks: random time steps, one to three weighted detections anywhere in the gate, and
/// now and then a new track. The covariance must stay symmetric and positive definite after each.
fn stays_definite<const N: usize, const D: usize>(
    filter: &impl Filter<N, D>,
    sensor: &Sensor,
    first: SVector<f64, D>,
    speed_sigma: f64,
) {
    let mut draw = stream(1);
    let mut state = filter.initiate(&first, sensor, speed_sigma).unwrap();
    let transitions: Vec<Transition<N>> = [0.1, 1.0, 8.0]
        .map(|dt_s| Transition::new(filter.motion(), dt_s))
        .into();
    for round in 0..1_000_000 {
        if round % 500 == 0 {
            state = filter.initiate(&first, sensor, speed_sigma).unwrap();
        }
        transitions[draw.random_range(0..transitions.len())].predict(&mut state);
        let expected = filter
            .expect(&state, sensor)
            .unwrap_or_else(|| panic!("round {round}: nothing is expected of {state:?}"));
        let count = draw.random_range(1..=3);
        let share = if count == 1 && draw.random::<f64>() < 0.5 {
            1.0
        } else {
            0.9 / f64::from(count)
        };
        let detections: Vec<WeightedInnovation<D>> = (0..count)
            .map(|_| {
                let innovation = SVector::from_fn(|axis, _| {
                    (expected.covariance[(axis, axis)]).sqrt() * draw.random_range(-2.0..2.0)
                });
                WeightedInnovation {
                    innovation,
                    weight: share,
                }
            })
            .collect();
        update(&mut state, &expected.correction(), &detections);
        assert_eq!(
            state.covariance,
            state.covariance.transpose(),
            "round {round}"
        );
        assert!(
            Cholesky::new(state.covariance).is_some(),
            "round {round}: {}",
            state.covariance
        );
    }
}

#[test]
fn kalman_covariances_stay_definite_over_a_million_updates() {
    stays_definite(&KALMAN, &positions(), SVector::from([3e3, -2e3]), 430.0);
}

#[test]
fn extended_covariances_stay_definite_over_a_million_updates() {
    stays_definite::<4, 2>(&EXTENDED, &polar(0.0052), SVector::from([3e4, 3.0]), 430.0);
}

#[test]
fn extended_covariances_with_range_rates_stay_definite_over_a_million_updates() {
    stays_definite::<4, 3>(
        &EXTENDED,
        &polar(0.0052),
        SVector::from([3e4, -1.0, 20.0]),
        430.0,
    );
}

#[test]
fn unscented_covariances_stay_definite_over_a_million_updates() {
    stays_definite::<4, 2>(&UNSCENTED, &polar(0.0052), SVector::from([3e4, 3.0]), 430.0);
}

#[test]
fn bearing_only_covariances_stay_definite_over_a_million_updates() {
    let sonar = sensor(MeasurementModel::Bearing {
        sigma_bearing_rad: 0.01,
    });
    stays_definite(
        &BearingOnly {
            process_noise_rad2ps3: 1e-6,
            initial_rate_sigma_radps: 0.1,
        },
        &sonar,
        SVector::from([3.0]),
        0.1,
    );
}

#[test]
fn converted_covariances_stay_definite_over_a_million_updates() {
    stays_definite(&CONVERTED, &polar(0.0052), SVector::from([3e4, 3e4]), 430.0);
}

/// What the sensor reports of a state, without noise.
fn report_of(sensor: &Sensor, state: &Vector4<f64>) -> Measurement {
    let MeasurementModel::Polar(polar) = &sensor.report else {
        return Measurement::Position {
            x_m: state[0],
            y_m: state[1],
        };
    };
    let offset = Position::new(state[0], state[1]) - polar.place_m;
    let rate = offset.dot(&Position::new(state[2], state[3])) / offset.norm();
    Measurement::RangeBearing {
        range_m: offset.norm(),
        bearing_rad: offset[0].atan2(offset[1]),
        range_rate_mps: Some(rate),
    }
}

/// The same with noise.
fn noisy_report(sensor: &Sensor, state: &Vector4<f64>, draw: &mut ChaCha8Rng) -> Measurement {
    match (report_of(sensor, state), &sensor.report) {
        (
            Measurement::RangeBearing {
                range_m,
                bearing_rad,
                range_rate_mps,
            },
            MeasurementModel::Polar(polar),
        ) => Measurement::RangeBearing {
            range_m: range_m + polar.sigma_range_m * normal(draw),
            bearing_rad: bearing_rad + polar.sigma_bearing_rad * normal(draw),
            range_rate_mps: range_rate_mps.map(|rate| rate + 0.5 * normal(draw)),
        },
        (Measurement::Position { x_m, y_m }, _) => Measurement::Position {
            x_m: x_m + 15.0 * normal(draw),
            y_m: y_m + 5.2 * normal(draw),
        },
        (other, _) => other,
    }
}

/// Mean NIS of 200 targets over 50 scans each, which move and are measured exactly as the filter believes.
fn mean_nis<const D: usize>(filter: &impl Filter<4, D>, sensor: &Sensor) -> f64 {
    let (speed_sigma, dt_s, runs, scans) = (30.0, 8.0, 200, 50);
    let noise: Matrix4<f64> = filter.motion().process_noise(dt_s);
    let root = Cholesky::new(noise).unwrap().l();
    let mut sum = 0.0;
    for run in 0..runs {
        let mut draw = stream(100 + run);
        let bearing = draw.random_range(-3.1..3.1f64);
        let start = Position::new(bearing.sin(), bearing.cos()) * 3e4;
        let velocity = normals::<2>(&mut draw) * speed_sigma;
        let mut truth = Vector4::new(start[0], start[1], velocity[0], velocity[1]);
        let first = filter
            .to_measurement_space(sensor, &noisy_report(sensor, &truth, &mut draw))
            .unwrap();
        let mut state = filter.initiate(&first, sensor, speed_sigma).unwrap();
        for _ in 0..scans {
            truth = Vector4::new(
                truth[0] + dt_s * truth[2],
                truth[1] + dt_s * truth[3],
                truth[2],
                truth[3],
            ) + root * normals::<4>(&mut draw);
            Transition::new(filter.motion(), dt_s).predict(&mut state);
            let expected = filter.expect(&state, sensor).unwrap();
            let measured = filter
                .to_measurement_space(sensor, &noisy_report(sensor, &truth, &mut draw))
                .unwrap();
            let innovation =
                angle::difference(&measured, &expected.measurement, filter.angle(sensor));
            sum += expected.gaussian.squared_distance(&innovation);
            update(
                &mut state,
                &expected.correction(),
                &[WeightedInnovation {
                    innovation,
                    weight: 1.0,
                }],
            );
        }
    }
    sum / (runs * scans) as f64
}

/// The mean of n chi-square values of D degrees of freedom has the standard deviation √(2 D / n); four of them hold
/// 99.99 %, and the filters that linearise may be off by another percent.
fn assert_consistent(mean: f64, dimensions: f64, bias: f64) {
    let bound = 4.0 * (2.0 * dimensions / 10_000.0).sqrt() + bias * dimensions;
    assert!(
        (mean - dimensions).abs() < bound,
        "mean {mean}, expected {dimensions} ± {bound}"
    );
}

#[test]
fn the_mean_nis_of_linear_gaussian_data_is_within_its_chi_square_bounds() {
    assert_consistent(mean_nis(&KALMAN, &positions()), 2.0, 0.0);
}

#[test]
fn the_mean_nis_of_polar_data_is_within_its_chi_square_bounds() {
    assert_consistent(mean_nis::<2>(&EXTENDED, &polar(0.0052)), 2.0, 0.01);
    assert_consistent(mean_nis::<3>(&EXTENDED, &polar(0.0052)), 3.0, 0.01);
    assert_consistent(mean_nis::<2>(&UNSCENTED, &polar(0.0052)), 2.0, 0.01);
    assert_consistent(mean_nis::<3>(&UNSCENTED, &polar(0.0052)), 3.0, 0.01);
    assert_consistent(mean_nis(&CONVERTED, &polar(0.0052)), 2.0, 0.01);
}

/// The state after 20 scans of one target.
fn estimate<const D: usize>(
    filter: &impl Filter<4, D>,
    sensor: &Sensor,
    errors: &[[f64; 2]],
) -> GaussianState {
    let at = |scan: usize| {
        let time_s = 4.0 * scan as f64;
        let [x, y] = errors[scan];
        Vector4::new(
            -300.0 + 10.0 * time_s + x,
            200.0 - 5.0 * time_s + y,
            10.0,
            -5.0,
        )
    };
    let measured = |scan| {
        filter
            .to_measurement_space(sensor, &report_of(sensor, &at(scan)))
            .unwrap()
    };
    let mut state = filter.initiate(&measured(0), sensor, 30.0).unwrap();
    for scan in 1..errors.len() {
        Transition::new(filter.motion(), 4.0).predict(&mut state);
        let expected = filter.expect(&state, sensor).unwrap();
        let innovation =
            angle::difference(&measured(scan), &expected.measurement, filter.angle(sensor));
        update(
            &mut state,
            &expected.correction(),
            &[WeightedInnovation {
                innovation,
                weight: 1.0,
            }],
        );
    }
    state
}

/// Relative to the standard deviations of `left`.
fn assert_equal_states(left: &GaussianState, right: &GaussianState, tolerance: f64) {
    let deviations = left.covariance.diagonal().map(f64::sqrt);
    let mean = (left.mean - right.mean)
        .component_div(&deviations)
        .abs()
        .max();
    let scale: SMatrix<f64, 4, 4> = deviations * deviations.transpose();
    let covariance = (left.covariance - right.covariance)
        .component_div(&scale)
        .abs()
        .max();
    assert!(
        mean < tolerance && covariance < tolerance,
        "mean {mean}, covariance {covariance}"
    );
}

#[test]
fn on_a_linear_measurement_all_filters_are_the_kalman_filter() {
    let mut draw = stream(2);
    let errors: Vec<[f64; 2]> = (0..20)
        .map(|_| [15.0 * normal(&mut draw), 5.2 * normal(&mut draw)])
        .collect();
    let linear = estimate(&KALMAN, &positions(), &errors);
    assert_equal_states(
        &linear,
        &estimate::<2>(&EXTENDED, &positions(), &errors),
        1e-9,
    );
    assert_equal_states(
        &linear,
        &estimate::<2>(&UNSCENTED, &positions(), &errors),
        1e-9,
    );
    assert_equal_states(&linear, &estimate(&CONVERTED, &positions(), &errors), 1e-9);
    // A radar far to the south sees ranges that are y and bearings that are x, each up to a constant.
    let far_m = 1e8;
    let polar = Polar {
        place_m: Position::new(0.0, -far_m),
        sigma_range_m: 5.2,
        sigma_bearing_rad: 15.0 / far_m,
        range_rate: None,
    };
    let far = sensor(MeasurementModel::Polar(polar));
    assert_equal_states(&linear, &estimate::<2>(&EXTENDED, &far, &errors), 1e-3);
    assert_equal_states(&linear, &estimate::<2>(&UNSCENTED, &far, &errors), 1e-3);
    assert_equal_states(&linear, &estimate(&CONVERTED, &far, &errors), 1e-3);
}
