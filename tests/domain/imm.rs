//! The IMM against worked numbers of another program, against single filters, and against data that moves as it believes.

use nalgebra::{Cholesky, Matrix2, Matrix4, Matrix6, SMatrix, SVector, Vector2, Vector4, Vector6};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use trackloom_domain::filtering::gaussian::GaussianFilter;
use trackloom_domain::filtering::imm::settings::Model;
use trackloom_domain::filtering::imm::{Belief, Imm, Mixing, ModeStep, Models, Step, chain};
use trackloom_domain::filtering::motions::AnyMotion;
use trackloom_domain::filtering::unscented::Unscented;
use trackloom_domain::filtering::{Corrector, Filter, Reports, Way, Weighted, WithCorrector};
use trackloom_domain::hypotheses::certain::{locate, update};
use trackloom_domain::math::rng::{Purpose, Seed};
use trackloom_domain::model::angle::difference;
use trackloom_domain::model::motion::constant_acceleration::ConstantAcceleration;
use trackloom_domain::model::motion::constant_velocity::ConstantVelocity;
use trackloom_domain::model::motion::unknown_turn::UnknownTurn;
use trackloom_domain::model::own::Own;
use trackloom_domain::model::scan::Measurement;
use trackloom_domain::model::sensing::{MeasurementModel, Platform, Polar};
use trackloom_domain::model::state::{GaussianState, Position};

fn velocity(spectral_density: f64) -> AnyMotion {
    AnyMotion::ConstantVelocity(ConstantVelocity { spectral_density })
}

fn models(motions: &[AnyMotion]) -> Models {
    let model = |motion: &AnyMotion| Model {
        motion: *motion,
        sojourn_s: 50.0,
        initial_probability: None,
    };
    let models: Vec<Model> = motions.iter().map(model).collect();
    Models::new(&models, Mixing::Unbiased).unwrap()
}

fn two() -> Imm<2, 4> {
    let models = models(&[velocity(0.01), velocity(25.0)]);
    Imm::new(models, Way::Line, Reports::Positions)
}

/// Of the axis of y a sensor says nothing that would tell one model from another.
const BLIND_M: f64 = 1e9;

const ALONG_X: MeasurementModel = MeasurementModel::Position {
    sigma_x_m: 10.0,
    sigma_y_m: BLIND_M,
};

fn at(x_m: f64, y_m: f64) -> Measurement {
    Measurement::Position { x_m, y_m }
}

/// A position and a velocity along x, for certain at rest along y.
fn along_x(mean: [f64; 2], covariance: [[f64; 2]; 2]) -> GaussianState {
    let mut state = GaussianState {
        mean: Vector4::new(mean[0], 0.0, mean[1], 0.0),
        covariance: Matrix4::zeros(),
    };
    for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        state.covariance[(2 * row, 2 * column)] = covariance[row][column];
    }
    state
}

fn assert_along_x(state: &GaussianState, mean: [f64; 2], covariance: [[f64; 2]; 2]) {
    for row in 0..2 {
        assert!(
            (state.mean[2 * row] - mean[row]).abs() < 1e-9,
            "{}",
            state.mean
        );
        for (column, expected) in covariance[row].iter().enumerate() {
            let found = state.covariance[(2 * row, 2 * column)];
            assert!((found - expected).abs() < 1e-9, "{}", state.covariance);
        }
    }
}

/// A worked step: two models that take turns as Π says, mixed and predicted over a second.
fn predicted() -> (Imm<2, 4>, Belief<2, 4>) {
    let step = Step::new(
        Matrix2::new(0.95, 0.05, 0.1, 0.9),
        [0.01, 25.0].map(|q| ModeStep::new(&velocity(q), 1.0)),
        Mixing::Unbiased,
    );
    let mut belief = Belief {
        probabilities: [0.8, 0.2],
        states: [
            along_x([0.0, 10.0], [[40.0, 5.0], [5.0, 4.0]]),
            along_x([4.0, 13.0], [[70.0, 20.0], [20.0, 30.0]]),
        ],
    };
    Imm::<2, 4>::predict(&step, &mut belief);
    (two(), belief)
}

#[test]
fn a_step_of_two_models_as_worked_out() {
    let (filter, mut belief) = predicted();
    assert!((belief.probabilities[0] - 0.78).abs() < 1e-12);
    let covariances = [
        [
            [57.43265614727, 10.58093688363],
            [10.58093688363, 4.901518737673],
        ],
        [
            [139.9862258953, 58.1694214876],
            [58.1694214876, 51.61157024793],
        ],
    ];
    let means = [
        [10.17948717949, 10.07692307692],
        [15.72727272727, 12.45454545455],
    ];
    for mode in 0..2 {
        assert_along_x(&belief.states[mode], means[mode], covariances[mode]);
    }
    update(&filter, &ALONG_X, &at(22.0, 0.0), &mut belief).unwrap();
    assert!((belief.probabilities[0] - 0.752999914593).abs() < 1e-11);
    assert!((belief.probabilities[1] - 0.247000085407).abs() < 1e-11);
    let covariances = [
        [
            [36.48077695745, 6.720928899104],
            [6.720928899104, 4.190381492865],
        ],
        [
            [58.33094185846, 24.23865006027],
            [24.23865006027, 37.51208773147],
        ],
    ];
    let means = [
        [14.49170209676, 10.8713713391],
        [19.38621362567, 13.97496986742],
    ];
    for mode in 0..2 {
        assert_along_x(&belief.states[mode], means[mode], covariances[mode]);
    }
    let covariance = [
        [46.33341620108, 13.87312283583],
        [13.87312283583, 14.21237173651],
    ];
    let told = Imm::kinematics(&belief);
    assert_along_x(&told, [15.70064686243, 11.63796044066], covariance);
}

/// The weights that PDA gives to detections, with what each changes.
struct Soft<'a> {
    reports: &'a [Measurement],
    log_density: f64,
    missed: f64,
    belief: &'a mut Belief<2, 4>,
}

impl WithCorrector<Imm<2, 4>, 4> for Soft<'_> {
    type Output = Vec<f64>;

    fn with<C: Corrector<Imm<2, 4>, 4, D>, const D: usize>(self, corrector: &C) -> Vec<f64> {
        let (expected, gain) = corrector.expect(self.belief).unwrap();
        let mut detections = Vec::new();
        for report in self.reports {
            let report = corrector.read(report, &Own::default()).unwrap();
            let innovation = difference(&report, &expected.measurement, C::ANGLE);
            let squared = expected.gaussian.squared_distance(&innovation);
            let (change, log) = C::assess(&gain, &expected, &innovation, squared);
            let weight = (self.log_density + log).exp();
            detections.push(Weighted { change, weight });
        }
        let total: f64 = self.missed + detections.iter().map(|one| one.weight).sum::<f64>();
        detections.iter_mut().for_each(|one| one.weight /= total);
        Imm::update(self.belief, &C::loss(&gain), &detections);
        let weights = detections.iter().map(|one| one.weight);
        [self.missed / total].into_iter().chain(weights).collect()
    }
}

#[test]
fn two_uncertain_detections_as_the_moments_of_all_models_and_events() {
    let (filter, mut belief) = predicted();
    // 0.002 false detections a metre; along y a density is 1/(√2π 1e9 m) everywhere.
    let log_blind = (std::f64::consts::TAU.sqrt() * BLIND_M).ln();
    let soft = Soft {
        reports: &[at(22.0, 0.0), at(5.0, 0.0)],
        log_density: (0.9f64 / 0.002).ln() + log_blind,
        missed: 1.0 - 0.9 * 0.99,
        belief: &mut belief,
    };
    let weights = filter.correct(&ALONG_X, soft).unwrap();
    let expected = [0.004983304108094, 0.4347537794752, 0.5602629164167];
    for (found, expected) in weights.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-11, "{weights:?}");
    }
    assert!((belief.probabilities[0] - 0.799808753695).abs() < 1e-11);
    let covariance = [
        [55.84853194415, 14.86776194127],
        [14.86776194127, 12.53736921866],
    ];
    let told = Imm::kinematics(&belief);
    assert_along_x(&told, [11.63550511842, 10.57468126745], covariance);
}

#[test]
fn without_a_detection_only_the_chain_moves_the_probabilities() {
    let (filter, mut belief) = predicted();
    let soft = Soft {
        reports: &[],
        log_density: 0.0,
        missed: 0.109,
        belief: &mut belief,
    };
    filter.correct(&ALONG_X, soft).unwrap();
    assert!((belief.probabilities[0] - 0.78).abs() < 1e-12);
}

/// Constant velocity beside constant acceleration, mixed without moving: the second state afterwards.
fn mixed(mixing: Mixing) -> (GaussianState<6>, GaussianState<6>) {
    let acceleration = AnyMotion::ConstantAcceleration(ConstantAcceleration {
        spectral_density: 1.0,
        initial_sigma: 1.0,
    });
    let modes = [velocity(1.0), acceleration].map(|motion| ModeStep::new(&motion, 0.0));
    let step = Step::new(Matrix2::new(0.95, 0.05, 0.2, 0.8), modes, mixing);
    let of_axis = |mean: [f64; 3], covariance: [[f64; 3]; 3]| {
        let mut state = GaussianState {
            mean: Vector6::new(mean[0], 0.0, mean[1], 0.0, mean[2], 0.0),
            covariance: Matrix6::zeros(),
        };
        for (row, values) in covariance.iter().enumerate() {
            for (column, value) in values.iter().enumerate() {
                state.covariance[(2 * row, 2 * column)] = *value;
            }
        }
        state
    };
    let slow = of_axis(
        [100.0, 20.0, 0.0],
        [[25.0, 5.0, 0.0], [5.0, 9.0, 0.0], [0.0; 3]],
    );
    let fast = of_axis(
        [102.0, 22.0, 1.5],
        [[36.0, 8.0, 2.0], [8.0, 16.0, 3.0], [2.0, 3.0, 4.0]],
    );
    let mut belief = Belief {
        probabilities: [0.7, 0.3],
        states: [slow, fast],
    };
    Imm::<2, 6>::predict(&step, &mut belief);
    assert!((belief.probabilities[0] - 0.725).abs() < 1e-12);
    (belief.states[0], belief.states[1])
}

#[test]
fn models_of_different_size_lend_what_they_have() {
    let expected = [
        (
            Mixing::Zero,
            1.309090909091,
            [2.07867768595, 2.951404958678, 3.740826446281],
        ),
        (Mixing::Unbiased, 1.5, [1.745454545455, 2.618181818182, 4.0]),
    ];
    for (mixing, acceleration, covariances) in expected {
        let (slow, fast) = mixed(mixing);
        let block = [
            [26.21398335315, 5.551914387634],
            [5.551914387634, 9.882948870392],
        ];
        assert_along_x(&slow.leading(), [100.1655172414, 20.16551724138], block);
        assert_eq!(slow.covariance[(4, 4)], 0.0);
        let block = [
            [35.04429752066, 8.062479338843],
            [8.062479338843, 15.55338842975],
        ];
        assert_along_x(&fast.leading(), [101.7454545455, 21.74545454545], block);
        assert!((fast.mean[4] - acceleration).abs() < 1e-11, "{}", fast.mean);
        for (row, expected) in covariances.iter().enumerate() {
            assert!(
                (fast.covariance[(2 * row, 4)] - expected).abs() < 1e-11,
                "{mixing:?}"
            );
        }
    }
}

#[test]
fn the_chain_is_the_same_however_time_is_cut() {
    let generator = chain::generator::<2>(&[200.0, 25.0]);
    let whole = chain::transition(&generator, 5.0);
    let expected = Matrix2::new(
        0.9776129131955,
        0.02238708680451,
        0.1790966944361,
        0.8209033055639,
    );
    assert!((whole - expected).abs().max() < 1e-12, "{whole}");
    let second = chain::transition(&generator, 1.0);
    assert!((second.pow(5) - expected).abs().max() < 1e-12);
    assert_eq!(chain::transition(&generator, 0.0), Matrix2::identity());
    // Two models: Π₁₂ = a/(a + b) (1 − e^−(a+b)T).
    for dt_s in [1e-3, 7.0, 300.0, 1e4, 1e9] {
        let expected = 0.005 / 0.045 * (1.0 - (-0.045f64 * dt_s).exp());
        let found = chain::transition(&generator, dt_s)[(0, 1)];
        assert!(
            (found - expected).abs() < 1e-12,
            "{dt_s}: {found} {expected}"
        );
    }
    let six = chain::transition(
        &chain::generator::<6>(&[100.0, 20.0, 20.0, 5.0, 0.1, 1e6]),
        40.0,
    );
    for row in six.row_iter() {
        assert!((row.sum() - 1.0).abs() < 1e-12 && row.min() > 0.0);
    }
}

fn stream(entity: u64) -> ChaCha8Rng {
    Seed { seed: 21, run: 0 }.stream(Purpose::Detection, entity, 0)
}

fn normals<const N: usize>(draw: &mut ChaCha8Rng) -> SVector<f64, N> {
    SVector::from_fn(|_, _| StandardNormal.sample(draw))
}

const RADAR: MeasurementModel = MeasurementModel::Polar(Polar {
    place_m: Position::new(100.0, -50.0),
    sigma_range_m: 15.0,
    sigma_bearing_rad: 0.005,
    range_rate: None,
    platform: Platform::STANDING,
});

/// Both filters over forty reports of one target; asserts that they tell the same.
fn assert_same<A: Filter<4>, B: Filter<4>>(one: &A, several: &B) {
    let mut draw = stream(1);
    let mut report = |scan: f64| Measurement::RangeBearing {
        range_m: 4e3 + 30.0 * scan + 15.0 * normals::<1>(&mut draw)[0],
        bearing_rad: 3.1 + 0.01 * scan + 0.005 * normals::<1>(&mut draw)[0],
        range_rate_mps: None,
    };
    let start = locate(one, &RADAR, &report(0.0), 50.0).unwrap();
    let (mut left, mut right) = (one.begin(&start), several.begin(&start));
    for scan in 1..40 {
        let (dt_s, report) = (1.0 + f64::from(scan % 3), report(f64::from(scan)));
        A::predict(&one.step(dt_s), &mut left);
        B::predict(&several.step(dt_s), &mut right);
        update(one, &RADAR, &report, &mut left).unwrap();
        update(several, &RADAR, &report, &mut right).unwrap();
        let (left, right) = (A::kinematics(&left), B::kinematics(&right));
        let sigmas = left.covariance.diagonal().map(f64::sqrt);
        let mean = (left.mean - right.mean).component_div(&sigmas).abs().max();
        let scale = sigmas * sigmas.transpose();
        let spread = (left.covariance - right.covariance).component_div(&scale);
        assert!(
            mean < 1e-9 && spread.abs().max() < 1e-9,
            "{scan}: {mean} {spread}"
        );
    }
}

#[test]
fn equal_models_are_one() {
    let points = Way::Points(Unscented::default());
    let motion = ConstantVelocity {
        spectral_density: 1.0,
    };
    for (way, reports) in [
        (Way::Line, Reports::All),
        (points, Reports::All),
        (Way::Line, Reports::Converted),
    ] {
        let one = GaussianFilter::<_, 4, 4>::new(motion, way, reports);
        assert_same(
            &one,
            &Imm::<2, 4>::new(models(&[velocity(1.0); 2]), way, reports),
        );
        assert_same(
            &one,
            &Imm::<6, 6>::new(models(&[velocity(1.0); 5]), way, reports),
        );
    }
    let turning = UnknownTurn {
        spectral_density: 0.5,
        turn_density: 1e-4,
        initial_sigma: 0.05,
    };
    let one = GaussianFilter::<_, 5, 4>::new(turning, points, Reports::All);
    let models = models(&[AnyMotion::UnknownTurn(turning); 3]);
    assert_same(&one, &Imm::<3, 6>::new(models, points, Reports::All));
}

#[test]
fn models_that_are_all_far_off_are_still_compared() {
    let filter = two();
    let mut belief = filter.begin(&along_x([0.0, 0.0], [[1.0, 0.0], [0.0, 1.0]]));
    for scan in 1..20 {
        Imm::predict(&filter.step(1.0), &mut belief);
        // 1e5 standard deviations away and more: exp(−d²/2) is 0 for both.
        let report = at(1e7 * f64::from(scan * scan), 0.0);
        update(&filter, &ALONG_X, &report, &mut belief).unwrap();
        let told = Imm::kinematics(&belief);
        assert!(
            told.mean
                .iter()
                .chain(&told.covariance)
                .all(|value| value.is_finite())
        );
        if scan == 1 {
            assert!(belief.probabilities[1] > 0.99, "the freer model is nearer");
            assert!(belief.probabilities[0] > 0.9e-6, "none is lost for good");
        }
        assert!((belief.probabilities.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_belief_comes_back_to_the_bit() {
    let (_, belief) = predicted();
    let mut packed = Vec::new();
    Imm::<2, 4>::pack(&belief, &mut packed);
    assert_eq!(Imm::<2, 4>::unpack(&packed), Some(belief));
    assert_eq!(Imm::<2, 4>::unpack(&packed[1..]), None);
    assert_eq!(Imm::<2, 4>::unpack(&packed[..packed.len() - 14]), None);
    assert_eq!(Imm::<2, 4>::mode_probabilities(&belief).len(), 2);
}

/// Targets that move by the models and change between them as the chain says: the mean normalised errors of estimates, and of
/// innovations.
#[test]
fn on_its_own_terms_the_filter_is_nearly_consistent() {
    let filter = Imm::<2, 4>::new(
        models(&[velocity(0.05), velocity(20.0)]),
        Way::Line,
        Reports::Positions,
    );
    let sensor = MeasurementModel::Position {
        sigma_x_m: 20.0,
        sigma_y_m: 20.0,
    };
    let (dt_s, runs, scans) = (4.0, 300, 80);
    let transition = chain::transition(&chain::generator::<2>(&[50.0, 50.0]), dt_s);
    let roots = [0.05, 20.0].map(|spectral_density| {
        let noise: Matrix4<f64> = ConstantVelocity { spectral_density }.process_noise(dt_s);
        Cholesky::new(noise).unwrap().l()
    });
    let (mut estimates, mut in_mode) = (0.0, 0.0);
    for run in 0..runs {
        let mut draw = stream(100 + run);
        let mut truth = Vector4::from_row_slice(&[0.0, 0.0, 50.0, 0.0]);
        let mut mode = usize::from(draw.random::<f64>() < 0.5);
        let start = GaussianState {
            mean: truth + normals::<4>(&mut draw) * 20.0,
            covariance: Matrix4::from_diagonal_element(400.0),
        };
        let mut belief = filter.begin(&start);
        for _ in 0..scans {
            if draw.random::<f64>() >= transition[(mode, mode)] {
                mode = 1 - mode;
            }
            let mut moved = truth;
            (moved[0], moved[1]) = (truth[0] + dt_s * truth[2], truth[1] + dt_s * truth[3]);
            truth = moved + roots[mode] * normals::<4>(&mut draw);
            Imm::predict(&filter.step(dt_s), &mut belief);
            let seen: Vector2<f64> = truth.xy() + normals::<2>(&mut draw) * 20.0;
            update(&filter, &sensor, &at(seen[0], seen[1]), &mut belief).unwrap();
            let told = Imm::kinematics(&belief);
            let error = truth - told.mean;
            let inverse: SMatrix<f64, 4, 4> = told.covariance.try_inverse().unwrap();
            estimates += (error.transpose() * inverse * error)[0];
            in_mode += belief.probabilities[mode];
        }
    }
    let count = (runs * scans) as f64;
    let (nees, right) = (estimates / count, in_mode / count);
    assert!((nees / 4.0 - 1.0).abs() < 0.05, "mean NEES {nees}");
    assert!(
        right > 0.6,
        "the model that moves the target has the probability {right}"
    );
}
