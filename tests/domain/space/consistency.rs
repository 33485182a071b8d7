//! Filters of space are as sure as they may be: normalised errors and innovations over many runs.

use super::{State6, belief, radar};
use nalgebra::{Cholesky, SVector};
use rand_distr::{Distribution, StandardNormal};
use trackloom_domain::filtering::climbing::Climbing;
use trackloom_domain::filtering::gaussian::GaussianFilter;
use trackloom_domain::filtering::imm::settings::Model;
use trackloom_domain::filtering::imm::{Interacting, Mixing, Models};
use trackloom_domain::filtering::motions::AnyMotion;
use trackloom_domain::filtering::unscented::Unscented;
use trackloom_domain::filtering::{Corrector, Filter, Reports, Way, WithCorrector};
use trackloom_domain::hypotheses::certain::update;
use trackloom_domain::math::rng::{Purpose, Seed};
use trackloom_domain::model::angle::difference;
use trackloom_domain::model::motion::Motion;
use trackloom_domain::model::motion::constant_velocity::ConstantVelocity;
use trackloom_domain::model::motion::in_space::ClimbingVelocity;
use trackloom_domain::model::own::Own;
use trackloom_domain::model::scan::Measurement;
use trackloom_domain::model::sensing::{MeasurementModel, Site, Spherical};
use trackloom_domain::model::space::Place;
use trackloom_domain::model::state::GaussianState;

const MOTION: ClimbingVelocity = ClimbingVelocity {
    horizontal: ConstantVelocity {
        spectral_density: 1.0,
    },
    vertical: ConstantVelocity {
        spectral_density: 0.03,
    },
};
const RUNS: u32 = 40;
const SCANS: u32 = 40;

/// The normalised innovation squared of a report.
struct Nis<'a, B>(&'a B, &'a Measurement);

impl<F: Filter<6>> WithCorrector<F, 6> for Nis<'_, F::Belief> {
    type Output = f64;

    fn with<C: Corrector<F, 6, D>, const D: usize>(self, corrector: &C) -> f64 {
        let (expected, _) = corrector.expect(self.0).unwrap();
        let report = corrector.read(self.1, &Own::default()).unwrap();
        let innovation = difference(&report, &expected.measurement, C::ANGLE);
        expected.gaussian.squared_distance(&innovation)
    }
}

fn seen(sensor: &Spherical, truth: &State6, errors: [f64; 4]) -> Measurement {
    let offset_m: Place = truth.fixed_rows::<3>(0) - sensor.site.place_m;
    let velocity_mps: Place = truth.fixed_rows::<3>(3).into();
    Measurement::RangeBearingElevation {
        range_m: offset_m.norm() + sensor.sigma_range_m * errors[0],
        bearing_rad: offset_m.x.atan2(offset_m.y) + sensor.sigma_bearing_rad * errors[1],
        elevation_rad: offset_m.z.atan2(offset_m.xy().norm())
            + sensor.sigma_elevation_rad.unwrap() * errors[2],
        range_rate_mps: Some(offset_m.normalize().dot(&velocity_mps) + errors[3]),
    }
}

/// Mean normalised error and innovation squared, and that of the errors in the light of all later scans.
fn judge(sensor: &Spherical, way: Way, reports: Reports) -> (f64, f64, f64) {
    let filter = GaussianFilter::<_, 6, 6>::new(MOTION, way, reports);
    let model = MeasurementModel::Spherical(*sensor);
    let step = filter.step(4.0);
    let still = GaussianState::<6> {
        mean: SVector::zeros(),
        covariance: nalgebra::SMatrix::zeros(),
    };
    let mut wander = still;
    ClimbingVelocity::predict(&step, &mut wander);
    let noise = Cholesky::new(wander.covariance).unwrap().l();
    let (mut nees, mut nis, mut smoothed) = (0.0, 0.0, 0.0);
    for run in 0..RUNS {
        let mut draw = Seed { seed: 11, run }.stream(Purpose::Detection, 0, 0);
        let start = belief(
            State6::from([9000.0, 12_000.0, 4000.0, -80.0, 30.0, 5.0]),
            60.0,
            15.0,
        );
        let root = Cholesky::new(start.covariance).unwrap().l();
        let mut truth =
            start.mean + root * State6::from_fn(|_, _| StandardNormal.sample(&mut draw));
        let mut believed = filter.begin(&start);
        let mut told: Vec<(State6, GaussianState<6>)> = Vec::new();
        for _ in 0..SCANS {
            let mut moved = GaussianState {
                mean: truth,
                ..still
            };
            ClimbingVelocity::predict(&step, &mut moved);
            truth = moved.mean + noise * State6::from_fn(|_, _| StandardNormal.sample(&mut draw));
            GaussianFilter::<ClimbingVelocity, 6, 6>::predict(&step, &mut believed);
            let errors: [f64; 4] = std::array::from_fn(|_| StandardNormal.sample(&mut draw));
            let report = seen(sensor, &truth, errors);
            nis += filter.correct(&model, Nis(&believed, &report)).unwrap();
            update(&filter, &model, &report, &mut believed).unwrap();
            nees += squared_error(&believed, &truth);
            told.push((truth, believed));
        }
        for scan in (0..told.len()).rev() {
            if scan + 1 < told.len() {
                let (now, next) = (told[scan].1, told[scan + 1].1);
                told[scan].1 = GaussianFilter::<ClimbingVelocity, 6, 6>::smooth(&step, &now, &next);
            }
            smoothed += squared_error(&told[scan].1, &told[scan].0);
        }
    }
    let count = f64::from(RUNS * SCANS);
    (nees / count, nis / count, smoothed / count)
}

fn squared_error(believed: &GaussianState<6>, truth: &State6) -> f64 {
    let error = believed.mean - truth;
    (error.transpose() * believed.covariance.try_inverse().unwrap() * error)[0]
}

#[test]
fn errors_are_as_large_as_is_said() {
    let with_rates = radar(Site::level(Place::new(0.0, 0.0, 30.0)));
    let without = Spherical {
        range_rate: None,
        ..with_rates
    };
    let points = Way::Points(Unscented::default());
    for (sensor, way, reports, values) in [
        (with_rates, Way::Line, Reports::All, 4.0),
        (with_rates, points, Reports::All, 4.0),
        (without, Way::Line, Reports::All, 3.0),
        (without, points, Reports::All, 3.0),
        (without, Way::Line, Reports::Converted, 3.0),
    ] {
        let (nees, nis, smoothed) = judge(&sensor, way, reports);
        // Innovations are white; errors of 40 runs are worth about 300 alone.
        let sigma = (2.0 * values / f64::from(RUNS * SCANS)).sqrt();
        assert!(
            (nis - values).abs() < 4.0 * sigma,
            "{way:?} {reports:?}: NIS {nis}"
        );
        assert!((nees - 6.0).abs() < 0.8, "{way:?} {reports:?}: NEES {nees}");
        assert!(
            (smoothed - 6.0).abs() < 0.8,
            "{way:?} {reports:?}: smoothed NEES {smoothed}"
        );
    }
}

/// A single motion of space beside the usual one is an IMM of one model.
#[test]
fn several_models_of_which_there_is_one_are_that_one() {
    let model = Model {
        motion: AnyMotion::ConstantVelocity(MOTION.horizontal),
        sojourn_s: f64::INFINITY,
        initial_probability: Some(1.0),
    };
    let models = Models::new(&[model], Mixing::Unbiased).unwrap();
    let climbing = |motion: &AnyMotion| Climbing {
        motion: *motion,
        vertical: MOTION.vertical,
    };
    let sensor = radar(Site::level(Place::new(0.0, 0.0, 30.0)));
    let report = MeasurementModel::Spherical(sensor);
    for way in [Way::Line, Way::Points(Unscented::default())] {
        type Several = Interacting<Climbing, 1, 9, 6>;
        type One = GaussianFilter<ClimbingVelocity, 6, 6>;
        let several = Several::of_motions(models, climbing, way, Reports::All);
        let one = One::new(MOTION, way, Reports::All);
        let start = belief(
            State6::from([9000.0, 12_000.0, 4000.0, -80.0, 30.0, 5.0]),
            60.0,
            15.0,
        );
        let (mut wide, mut narrow) = (several.begin(&start), one.begin(&start));
        let (mut truth, mut before) = (start.mean, (wide, narrow));
        for scan in 0..20 {
            before = (wide, narrow);
            let dt_s = f64::from(scan % 3);
            Several::predict(&several.step(dt_s), &mut wide);
            One::predict(&one.step(dt_s), &mut narrow);
            let velocity_mps = truth.fixed_rows::<3>(3) * dt_s;
            let mut place_m = truth.fixed_rows_mut::<3>(0);
            place_m += velocity_mps;
            let seen = seen(&sensor, &truth, [0.3, -0.7, 0.2, 0.5]);
            update(&several, &report, &seen, &mut wide).unwrap();
            update(&one, &report, &seen, &mut narrow).unwrap();
            assert_near(&Several::kinematics(&wide), &narrow);
        }
        assert!(Several::mode_probabilities(&wide).is_empty());
        let back = Several::smooth(&several.step(1.0), &before.0, &wide);
        let wanted = One::smooth(&one.step(1.0), &before.1, &narrow);
        assert_near(&Several::kinematics(&back), &wanted);
    }
}

fn assert_near(found: &GaussianState<6>, wanted: &GaussianState<6>) {
    let apart = (found.mean - wanted.mean).norm();
    assert!(
        apart <= 1e-9 * wanted.mean.norm(),
        "{} {}",
        found.mean,
        wanted.mean
    );
    let apart = (found.covariance - wanted.covariance).norm();
    assert!(
        apart <= 1e-9 * wanted.covariance.norm(),
        "{} {}",
        found.covariance,
        wanted.covariance
    );
}
