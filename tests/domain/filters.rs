//! Every filter keeps its covariances healthy, is consistent where theory says so, and agrees with the others where they
//! must agree.

use nalgebra::{Cholesky, Matrix4, SMatrix, SVector, Vector4};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use trackloom_domain::filtering::bearing_only::BearingOnly;
use trackloom_domain::filtering::gaussian::GaussianFilter;
use trackloom_domain::filtering::unscented::Unscented;
use trackloom_domain::filtering::{Corrector, Filter, Reports, Way, Weighted, WithCorrector};
use trackloom_domain::hypotheses::certain::{locate, update};
use trackloom_domain::math::rng::{Purpose, Seed};
use trackloom_domain::model::angle;
use trackloom_domain::model::motion::constant_acceleration::ConstantAcceleration;
use trackloom_domain::model::motion::constant_velocity::ConstantVelocity;
use trackloom_domain::model::own::Own;
use trackloom_domain::model::scan::Measurement;
use trackloom_domain::model::sensing::{Bearing, MeasurementModel, Platform, Polar, RangeRate};
use trackloom_domain::model::sensor::Sensor;
use trackloom_domain::model::state::{GaussianState, Position};

type PlaneFilter = GaussianFilter<ConstantVelocity, 4, 4>;

const MOTION: ConstantVelocity = ConstantVelocity {
    spectral_density: 1.0,
};
const POINTS: Unscented = Unscented {
    alpha: 1.0,
    beta: 2.0,
    kappa: 0.0,
};

fn kalman() -> PlaneFilter {
    GaussianFilter::new(MOTION, Way::Line, Reports::Positions)
}

fn extended() -> PlaneFilter {
    GaussianFilter::new(MOTION, Way::Line, Reports::All)
}

fn unscented() -> PlaneFilter {
    GaussianFilter::new(MOTION, Way::Points(POINTS), Reports::All)
}

fn converted() -> PlaneFilter {
    GaussianFilter::new(MOTION, Way::Line, Reports::Converted)
}

fn sensor(report: MeasurementModel) -> Sensor {
    Sensor {
        sensor_id: "radar".into(),
        p_d: 0.9,
        clutter_density: 1e-8,
        may_start: true,
        report,
        sight: None,
    }
}

fn positions() -> Sensor {
    sensor(MeasurementModel::Position {
        sigma_x_m: 15.0,
        sigma_y_m: 5.2,
    })
}

fn doppler(sigma_bearing_rad: f64) -> Sensor {
    let range_rate = Some(RangeRate {
        sigma_mps: 0.5,
        span_mps: 600.0,
    });
    polar_with(sigma_bearing_rad, range_rate)
}

fn polar(sigma_bearing_rad: f64) -> Sensor {
    polar_with(sigma_bearing_rad, None)
}

fn polar_with(sigma_bearing_rad: f64, range_rate: Option<RangeRate>) -> Sensor {
    sensor(MeasurementModel::Polar(Polar {
        place_m: Position::new(100.0, -50.0),
        sigma_range_m: 15.0,
        sigma_bearing_rad,
        range_rate,
        platform: Platform::STANDING,
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
struct StaysDefinite<'a, F> {
    filter: &'a F,
    first: Measurement,
    rate_sigma: f64,
}

fn stays_definite<F, const N: usize, const K: usize>(
    filter: &F,
    sensor: &Sensor,
    first: Measurement,
    rate_sigma: f64,
) where
    F: Filter<K, Belief = GaussianState<N>>,
{
    let work = StaysDefinite {
        filter,
        first,
        rate_sigma,
    };
    filter.correct(&sensor.report, work).unwrap();
}

impl<F, const N: usize, const K: usize> WithCorrector<F, K> for StaysDefinite<'_, F>
where
    F: Filter<K, Belief = GaussianState<N>>,
{
    type Output = ();

    fn with<C: Corrector<F, K, D>, const D: usize>(self, corrector: &C) {
        let mut draw = stream(1);
        let first = corrector.read(&self.first, &Own::default()).unwrap();
        let start = corrector
            .locate(&first, self.rate_sigma, &Own::default())
            .unwrap();
        let mut belief = self.filter.begin(&start);
        let steps = [0.1, 1.0, 8.0].map(|dt_s| self.filter.step(dt_s));
        for round in 0..1_000_000 {
            if round % 500 == 0 {
                belief = self.filter.begin(&start);
            }
            F::predict(&steps[draw.random_range(0..steps.len())], &mut belief);
            let (expected, gain) = corrector
                .expect(&belief)
                .unwrap_or_else(|| panic!("round {round}: nothing is expected of {belief:?}"));
            let count = draw.random_range(1..=3);
            let weight = if count == 1 && draw.random::<f64>() < 0.5 {
                1.0
            } else {
                0.9 / f64::from(count)
            };
            let detections: Vec<Weighted<F::Change>> = (0..count)
                .map(|_| {
                    let innovation = SVector::from_fn(|axis, _| {
                        (expected.covariance[(axis, axis)]).sqrt() * draw.random_range(-2.0..2.0)
                    });
                    Weighted {
                        change: C::change(&gain, &innovation),
                        weight,
                    }
                })
                .collect();
            F::update(&mut belief, &C::loss(&gain), &detections);
            let covariance = belief.covariance;
            assert_eq!(covariance, covariance.transpose(), "round {round}");
            assert!(
                Cholesky::new(covariance).is_some(),
                "round {round}: {covariance}"
            );
        }
    }
}

fn range_bearing(range_m: f64, bearing_rad: f64, range_rate_mps: Option<f64>) -> Measurement {
    Measurement::RangeBearing {
        range_m,
        bearing_rad,
        range_rate_mps,
    }
}

#[test]
fn kalman_covariances_stay_definite_over_a_million_updates() {
    let first = Measurement::Position {
        x_m: 3e3,
        y_m: -2e3,
    };
    stays_definite(&kalman(), &positions(), first, 430.0);
}

#[test]
fn covariances_of_accelerations_stay_definite_over_a_million_updates() {
    let motion = ConstantAcceleration {
        spectral_density: 0.1,
        initial_sigma: 3.0,
    };
    let filter = GaussianFilter::<_, 6, 4>::new(motion, Way::Line, Reports::All);
    stays_definite(
        &filter,
        &polar(0.0052),
        range_bearing(3e4, 3.0, None),
        430.0,
    );
}

#[test]
fn extended_covariances_stay_definite_over_a_million_updates() {
    stays_definite(
        &extended(),
        &polar(0.0052),
        range_bearing(3e4, 3.0, None),
        430.0,
    );
}

#[test]
fn extended_covariances_with_range_rates_stay_definite_over_a_million_updates() {
    let first = range_bearing(3e4, -1.0, Some(20.0));
    stays_definite(&extended(), &doppler(0.0052), first, 430.0);
}

#[test]
fn unscented_covariances_stay_definite_over_a_million_updates() {
    stays_definite(
        &unscented(),
        &polar(0.0052),
        range_bearing(3e4, 3.0, None),
        430.0,
    );
}

#[test]
fn bearing_only_covariances_stay_definite_over_a_million_updates() {
    let sonar = sensor(MeasurementModel::Bearing(Bearing {
        place_m: Position::zeros(),
        sigma_bearing_rad: 0.01,
        platform: Platform::STANDING,
        range_prior: None,
    }));
    let filter = BearingOnly {
        process_noise_rad2ps3: 1e-6,
        initial_rate_sigma_radps: 0.1,
    };
    let first = Measurement::Bearing { bearing_rad: 3.0 };
    stays_definite(&filter.build(), &sonar, first, 0.1);
}

#[test]
fn converted_covariances_stay_definite_over_a_million_updates() {
    let first = range_bearing(4.2e4, 0.8, None);
    stays_definite(&converted(), &polar(0.0052), first, 430.0);
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
struct MeanNis<'a> {
    filter: &'a PlaneFilter,
    sensor: &'a Sensor,
}

fn mean_nis(filter: &PlaneFilter, sensor: &Sensor) -> f64 {
    filter
        .correct(&sensor.report, MeanNis { filter, sensor })
        .unwrap()
}

impl WithCorrector<PlaneFilter, 4> for MeanNis<'_> {
    type Output = f64;

    fn with<C: Corrector<PlaneFilter, 4, D>, const D: usize>(self, corrector: &C) -> f64 {
        let (speed_sigma, dt_s, runs, scans) = (30.0, 8.0, 200, 50);
        let noise: Matrix4<f64> = self.filter.motion.process_noise(dt_s);
        let root = Cholesky::new(noise).unwrap().l();
        let mut sum = 0.0;
        for run in 0..runs {
            let mut draw = stream(100 + run);
            let bearing = draw.random_range(-3.1..3.1f64);
            let start = Position::new(bearing.sin(), bearing.cos()) * 3e4;
            let velocity = normals::<2>(&mut draw) * speed_sigma;
            let mut truth = Vector4::new(start[0], start[1], velocity[0], velocity[1]);
            let first = corrector.read(
                &noisy_report(self.sensor, &truth, &mut draw),
                &Own::default(),
            );
            let mut state = corrector
                .locate(&first.unwrap(), speed_sigma, &Own::default())
                .unwrap();
            for _ in 0..scans {
                truth = Vector4::new(
                    truth[0] + dt_s * truth[2],
                    truth[1] + dt_s * truth[3],
                    truth[2],
                    truth[3],
                ) + root * normals::<4>(&mut draw);
                PlaneFilter::predict(&self.filter.step(dt_s), &mut state);
                let (expected, gain) = corrector.expect(&state).unwrap();
                let measured = corrector.read(
                    &noisy_report(self.sensor, &truth, &mut draw),
                    &Own::default(),
                );
                let innovation =
                    angle::difference(&measured.unwrap(), &expected.measurement, C::ANGLE);
                sum += expected.gaussian.squared_distance(&innovation);
                let certain = Weighted {
                    change: C::change(&gain, &innovation),
                    weight: 1.0,
                };
                PlaneFilter::update(&mut state, &C::loss(&gain), &[certain]);
            }
        }
        sum / (runs * scans) as f64
    }
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
    assert_consistent(mean_nis(&kalman(), &positions()), 2.0, 0.0);
}

#[test]
fn the_mean_nis_of_polar_data_is_within_its_chi_square_bounds() {
    assert_consistent(mean_nis(&extended(), &polar(0.0052)), 2.0, 0.01);
    assert_consistent(mean_nis(&extended(), &doppler(0.0052)), 3.0, 0.01);
    assert_consistent(mean_nis(&unscented(), &polar(0.0052)), 2.0, 0.01);
    assert_consistent(mean_nis(&unscented(), &doppler(0.0052)), 3.0, 0.01);
    assert_consistent(mean_nis(&converted(), &polar(0.0052)), 2.0, 0.01);
}

/// The state after 20 scans of one target.
fn estimate(filter: &PlaneFilter, sensor: &Sensor, errors: &[[f64; 2]]) -> GaussianState {
    let report = |scan: usize| {
        let time_s = 4.0 * scan as f64;
        let [x, y] = errors[scan];
        let (x_m, y_m) = (-300.0 + 10.0 * time_s + x, 200.0 - 5.0 * time_s + y);
        report_of(sensor, &Vector4::new(x_m, y_m, 10.0, -5.0))
    };
    let mut state = locate(filter, &sensor.report, &report(0), 30.0).unwrap();
    for scan in 1..errors.len() {
        PlaneFilter::predict(&filter.step(4.0), &mut state);
        update(filter, &sensor.report, &report(scan), &mut state).unwrap();
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
    let linear = estimate(&kalman(), &positions(), &errors);
    assert_equal_states(&linear, &estimate(&extended(), &positions(), &errors), 1e-9);
    assert_equal_states(
        &linear,
        &estimate(&unscented(), &positions(), &errors),
        1e-9,
    );
    assert_equal_states(
        &linear,
        &estimate(&converted(), &positions(), &errors),
        1e-9,
    );
    // A radar far to the south sees ranges that are y and bearings that are x, each up to a constant.
    let far_m = 1e8;
    let polar = Polar {
        place_m: Position::new(0.0, -far_m),
        sigma_range_m: 5.2,
        sigma_bearing_rad: 15.0 / far_m,
        range_rate: None,
        platform: Platform::STANDING,
    };
    let far = sensor(MeasurementModel::Polar(polar));
    assert_equal_states(&linear, &estimate(&extended(), &far, &errors), 1e-3);
    assert_equal_states(&linear, &estimate(&unscented(), &far, &errors), 1e-3);
    assert_equal_states(&linear, &estimate(&converted(), &far, &errors), 1e-3);
}
