//! The scene of Bar-Shalom, Li & Kirubarajan 2001, section 11.7, and filters on its fixes, without misses or false ones: an
//! airliner at 120 m/s that turns by 90° twice, seen every 5 s with 100 m on each axis.

use nalgebra::{Matrix3, SMatrix, Vector2};
use rand_distr::{Distribution, StandardNormal};
use std::ops::Range;
use trackloom_domain::experiment::presets;
use trackloom_domain::filtering::gaussian::GaussianFilter;
use trackloom_domain::filtering::imm::settings::Model;
use trackloom_domain::filtering::imm::{Imm, Mixing, ModeStep, Models, Step, chain};
use trackloom_domain::filtering::motions::AnyMotion;
use trackloom_domain::filtering::{
    AnyFilter, FILTER_KIND, FILTERS, Filter, Reports, Way, WithFilter,
};
use trackloom_domain::hypotheses::certain::{locate, update};
use trackloom_domain::math::rng::{Purpose, Seed};
use trackloom_domain::model::motion::Motion;
use trackloom_domain::model::motion::constant_velocity::ConstantVelocity;
use trackloom_domain::model::motion::coordinated_turn::CoordinatedTurn;
use trackloom_domain::model::motion::linear::Linear;
use trackloom_domain::model::motion::unknown_turn::{self, UnknownTurn};
use trackloom_domain::model::scan::Measurement;
use trackloom_domain::model::scenario::Scenario;
use trackloom_domain::model::sensing::MeasurementModel;
use trackloom_domain::model::state::{GaussianState, State};
use trackloom_domain::registry;

pub const PERIOD_S: f64 = 5.0;
pub const SIGMA_M: f64 = 100.0;
const SPEED_SIGMA_MPS: f64 = 300.0;
/// The first fixes are left out of every mean.
const FIRST: usize = 5;

/// The parts of the course, as fixes: each begins with the first that the part has moved.
pub const PARTS: [(&str, Range<usize>); 5] = [
    ("straight 1", FIRST..26),
    ("turn 1 deg/s", 26..44),
    ("straight 2", 44..69),
    ("turn 3 deg/s", 69..75),
    ("straight 3", 75..100),
];

/// The target at each fix, and what is known of it at first.
#[derive(Clone, Copy)]
pub struct Fixes<'a> {
    pub truth: &'a [State],
    /// Of each axis.
    pub sigma_m: f64,
    /// Of each axis, at the first fix.
    pub speed_sigma_mps: f64,
}

/// The airliner at each fix.
pub fn truth() -> Vec<State> {
    truth_of("atc-maneuver")
}

/// The target at each fix, as a preset has it.
pub fn truth_of(preset: &str) -> Vec<State> {
    let preset = presets::find(preset).expect("the preset is in the table");
    let scenario = preset.body["input"]["scenario"].clone();
    let scenario: Scenario = serde_json::from_value(scenario).expect("it says all of a scenario");
    let seed = Seed { seed: 1, run: 0 };
    let simulated = trackloom_domain::simulation::simulate(&scenario, seed, &mut |_| {
        std::ops::ControlFlow::Continue(())
    });
    let truth = simulated
        .expect("the scene is valid")
        .expect("nobody stops it")
        .truth;
    let state = |point: &trackloom_domain::model::truth::TruthPoint| {
        let velocity = point.velocity.unwrap_or_default();
        State::new(point.position.x, point.position.y, velocity.x, velocity.y)
    };
    truth.targets()[0].points.iter().map(state).collect()
}

/// Sums over runs, of each fix: squared errors of place and velocity, and normalised errors.
pub struct Errors {
    runs: u32,
    place: Vec<f64>,
    velocity: Vec<f64>,
    normalised: Vec<f64>,
    /// Squares of each run's errors of place at each fix, and of its means over all fixes and over each part.
    place_square: Vec<f64>,
    mean_square: [f64; 1 + PARTS.len()],
}

/// All fixes that count, then the parts.
fn ranges() -> [Range<usize>; 1 + PARTS.len()] {
    std::array::from_fn(|index| match index.checked_sub(1) {
        None => FIRST..PARTS[PARTS.len() - 1].1.end,
        Some(part) => PARTS[part].1.clone(),
    })
}

impl Errors {
    fn mean(&self, of: &[f64], fixes: Range<usize>) -> f64 {
        let count = fixes.len() as f64 * f64::from(self.runs);
        of[fixes].iter().sum::<f64>() / count
    }

    /// RMS error of place over some fixes (m).
    pub fn place_m(&self, fixes: Range<usize>) -> f64 {
        self.mean(&self.place, fixes).sqrt()
    }

    /// Over all fixes but the first ones.
    pub fn all_m(&self) -> f64 {
        self.place_m(FIRST..self.place.len())
    }

    /// The fix with the largest RMS error of place, and that.
    pub fn peak_m(&self) -> (usize, f64) {
        let fixes = FIRST..self.place.len();
        let errors = fixes.map(|fix| (fix, self.place_m(fix..fix + 1)));
        errors.fold(
            (FIRST, 0.0),
            |most, one| if one.1 > most.1 { one } else { most },
        )
    }

    pub fn speed_mps(&self) -> f64 {
        self.mean(&self.velocity, FIRST..self.velocity.len()).sqrt()
    }

    /// Mean normalised estimation error squared of the four kinematic variables.
    pub fn nees(&self) -> f64 {
        self.mean(&self.normalised, FIRST..self.normalised.len())
    }

    /// The standard errors of the first seven numbers of a [`row`], from the spread of the runs.
    pub fn standard_errors_m(&self) -> [f64; 7] {
        let of = |mean: f64, square: f64| {
            let runs = f64::from(self.runs);
            let variance = (square / runs - mean * mean) / runs;
            variance.max(0.0).sqrt() / (2.0 * mean.sqrt())
        };
        let (peak, _) = self.peak_m();
        std::array::from_fn(|index| match ranges().get(index) {
            Some(fixes) => of(
                self.mean(&self.place, fixes.clone()),
                self.mean_square[index],
            ),
            None => of(
                self.mean(&self.place, peak..peak + 1),
                self.place_square[peak],
            ),
        })
    }

    /// By how many standard errors of the difference the places differ from a published row of so many runs, at most.
    pub fn largest_deviation(&self, published: &[f64; 9], of_runs: u32) -> f64 {
        let share = (1.0 + f64::from(self.runs) / f64::from(of_runs)).sqrt();
        let (found, errors) = (row(self), self.standard_errors_m());
        let deviation =
            |index: usize| (found[index] - published[index]).abs() / (share * errors[index]);
        (0..7).map(deviation).fold(0.0, f64::max)
    }
}

/// A filter with what a period does to its beliefs, which may be another step than its own.
pub fn errors_of<F: Filter<4>>(filter: &F, step: &F::Step, truth: &[State], runs: u32) -> Errors {
    let fixes = of_airliner(truth);
    errors_in(truth, runs, |run| {
        beliefs_of(filter, step, fixes, run)
            .iter()
            .map(F::kinematics)
            .collect()
    })
}

/// The same in the light of all later fixes.
pub fn smoothed_errors_of<F: Filter<4>>(
    filter: &F,
    step: &F::Step,
    truth: &[State],
    runs: u32,
) -> Errors {
    let fixes = of_airliner(truth);
    errors_in(truth, runs, |run| {
        let mut beliefs = beliefs_of(filter, step, fixes, run);
        for fix in (1..beliefs.len()).rev() {
            beliefs[fix - 1] = F::smooth(step, &beliefs[fix - 1], &beliefs[fix]);
        }
        beliefs.iter().map(F::kinematics).collect()
    })
}

fn of_airliner(truth: &[State]) -> Fixes<'_> {
    Fixes {
        truth,
        sigma_m: SIGMA_M,
        speed_sigma_mps: SPEED_SIGMA_MPS,
    }
}

/// What a filter believes at each fix of a run.
pub fn beliefs_of<F: Filter<4>>(
    filter: &F,
    step: &F::Step,
    fixes: Fixes,
    run: u32,
) -> Vec<F::Belief> {
    let sensor = MeasurementModel::Position {
        sigma_x_m: fixes.sigma_m,
        sigma_y_m: fixes.sigma_m,
    };
    let mut draw = Seed { seed: 7, run }.stream(Purpose::Detection, 0, 0);
    let mut beliefs: Vec<F::Belief> = Vec::with_capacity(fixes.truth.len());
    for state in fixes.truth {
        let noise = Vector2::from_fn(|_, _| StandardNormal.sample(&mut draw));
        let seen: Vector2<f64> = state.xy() + noise * fixes.sigma_m;
        let report = Measurement::Position {
            x_m: seen[0],
            y_m: seen[1],
        };
        beliefs.push(match beliefs.last() {
            None => {
                let start = locate(filter, &sensor, &report, fixes.speed_sigma_mps);
                filter.begin(&start.expect("a position says where the target is"))
            }
            Some(before) => {
                let mut now = *before;
                F::predict(step, &mut now);
                update(filter, &sensor, &report, &mut now).expect("it stays definite");
                now
            }
        });
    }
    beliefs
}

/// Of what is told at each fix of each run.
fn errors_in(truth: &[State], runs: u32, told: impl Fn(u32) -> Vec<GaussianState>) -> Errors {
    let zeros = vec![0.0; truth.len()];
    let mut errors = Errors {
        runs,
        place: zeros.clone(),
        velocity: zeros.clone(),
        normalised: zeros,
        place_square: vec![0.0; truth.len()],
        mean_square: [0.0; 1 + PARTS.len()],
    };
    for run in 0..runs {
        let told = told(run);
        let of_run: Vec<f64> = (0..truth.len())
            .map(|fix| errors.add(fix, &truth[fix], &told[fix]))
            .collect();
        for (square, fixes) in errors.mean_square.iter_mut().zip(ranges()) {
            let mean = of_run[fixes.clone()].iter().sum::<f64>() / fixes.len() as f64;
            *square += mean * mean;
        }
    }
    errors
}

impl Errors {
    /// The squared error of place.
    fn add(&mut self, fix: usize, truth: &State, told: &GaussianState) -> f64 {
        let error = truth - told.mean;
        let inverse = told.covariance.try_inverse().expect("it stays definite");
        let place = error.fixed_rows::<2>(0).norm_squared();
        self.place[fix] += place;
        self.velocity[fix] += error.fixed_rows::<2>(2).norm_squared();
        self.normalised[fix] += (error.transpose() * inverse * error)[0];
        self.place_square[fix] += place * place;
        place
    }
}

/// Straight flight whose acceleration is constant from fix to fix, drawn anew each time: the noise of the reference, which
/// depends on the period.
#[derive(Debug, Clone, Copy)]
pub struct Piecewise {
    pub sigma_mps2: f64,
}

impl Motion<4> for Piecewise {
    type Step = Linear<4>;

    fn step(&self, dt_s: f64) -> Linear<4> {
        let variance = self.sigma_mps2.powi(2);
        let (place, rate) = (dt_s * dt_s / 2.0, dt_s);
        let noise = [[place * place, place * rate], [place * rate, rate * rate]];
        let noise = noise.map(|row| row.map(|element| variance * element));
        Linear::of_axes(&[[1.0, dt_s], [0.0, 1.0]], &noise)
    }

    fn predict(step: &Linear<4>, belief: &mut GaussianState<4>) {
        step.predict(belief);
    }

    fn rate_variance(&self, dt_s: f64) -> f64 {
        (self.sigma_mps2 * dt_s).powi(2) / 4.0
    }
}

/// A row of the reference, under its own name.
pub fn published(name: &str, truth: &[State], runs: u32) -> Errors {
    let slow = Piecewise { sigma_mps2: 0.1 }.step(PERIOD_S);
    match name {
        "CV 0.1" => piecewise(0.1, truth, runs),
        "CV 1" => piecewise(1.0, truth, runs),
        "CV 2" => piecewise(2.0, truth, runs),
        "IMM CV 0.1 / CV 2" => {
            let fast = Piecewise { sigma_mps2: 2.0 }.step(PERIOD_S);
            let step = Step::new(
                chain::transition(&chain::generator::<2>(&[200.0, 25.0]), PERIOD_S),
                [slow, fast].map(ModeStep::Linear),
                Mixing::Unbiased,
            );
            imm::<2, 4>(&[straight(200.0), straight(25.0)], &step, truth, runs)
        }
        "IMM CV / CT+1 / CT-3" => {
            let turning = |rate_degps: f64| {
                let turn = CoordinatedTurn {
                    turn_rate_radps: rate_degps.to_radians(),
                    spectral_density: 0.0,
                };
                let noise = slow.noise;
                ModeStep::Linear(Linear {
                    noise,
                    ..turn.step(PERIOD_S)
                })
            };
            let step = Step::new(
                Matrix3::new(0.9, 0.05, 0.05, 0.1, 0.9, 0.0, 0.1, 0.0, 0.9),
                [ModeStep::Linear(slow), turning(1.0), turning(-3.0)],
                Mixing::Unbiased,
            );
            let models = [straight(200.0), straight(100.0), straight(100.0)];
            imm::<3, 4>(&models, &step, truth, runs)
        }
        "IMM CV / CT unknown, 1 deg/s, lent" => unknown(1.0, Mixing::Unbiased, truth, runs),
        "IMM CV / CT unknown, 0.5 deg/s, lent" => unknown(0.5, Mixing::Unbiased, truth, runs),
        "IMM CV / CT unknown, 0.5 deg/s, zero" => unknown(0.5, Mixing::Zero, truth, runs),
        _ => panic!("no row {name}"),
    }
}

fn piecewise(sigma_mps2: f64, truth: &[State], runs: u32) -> Errors {
    let motion = Piecewise { sigma_mps2 };
    let filter = GaussianFilter::<_, 4, 4>::new(motion, Way::Line, Reports::Positions);
    errors_of(&filter, &motion.step(PERIOD_S), truth, runs)
}

/// A place in an IMM whose steps are made by hand: what it believes at the start.
fn straight(sojourn_s: f64) -> Model {
    let motion = AnyMotion::ConstantVelocity(ConstantVelocity {
        spectral_density: 0.05,
    });
    Model {
        motion,
        sojourn_s,
        initial_probability: None,
    }
}

fn imm<const R: usize, const N: usize>(
    models: &[Model],
    step: &Step<ModeStep, R>,
    truth: &[State],
    runs: u32,
) -> Errors {
    let models = Models::new(models, Mixing::Unbiased).expect("few models");
    let filter = Imm::<R, N>::new(models, Way::Line, Reports::Positions);
    errors_of(&filter, step, truth, runs)
}

/// Straight flight and a turn whose rate wanders by so many degrees a second from fix to fix.
fn unknown(step_degps: f64, mixing: Mixing, truth: &[State], runs: u32) -> Errors {
    let slow = Piecewise { sigma_mps2: 0.1 }.step(PERIOD_S);
    let mut noise = SMatrix::<f64, 5, 5>::zeros();
    noise.fixed_view_mut::<4, 4>(0, 0).copy_from(&slow.noise);
    noise[(4, 4)] = step_degps.to_radians().powi(2);
    let turning = unknown_turn::Step {
        dt_s: PERIOD_S,
        spectral_density: 0.0,
        noise,
    };
    let step = Step::new(
        chain::transition(&chain::generator::<2>(&[200.0, 25.0]), PERIOD_S),
        [ModeStep::Linear(slow), ModeStep::Turning(turning)],
        mixing,
    );
    let turn = AnyMotion::UnknownTurn(UnknownTurn {
        spectral_density: 0.0,
        turn_density: 0.0,
        initial_sigma: 3f64.to_radians(),
    });
    let models = [
        straight(200.0),
        Model {
            motion: turn,
            ..straight(25.0)
        },
    ];
    imm::<2, 5>(&models, &step, truth, runs)
}

/// The filter that a request names, by its own defaults.
pub fn filter_of(request: &serde_json::Value) -> AnyFilter {
    let method = FILTERS
        .iter()
        .find(|method| request["method"] == method.name)
        .expect("a name of the table");
    let checked = registry::check_field(request, &FILTER_KIND, "", &mut Vec::new());
    (method.build)(&checked).expect("checked parameters build")
}

/// The same of a filter that a request names, with its own steps.
pub struct Named<'a> {
    pub truth: &'a [State],
    pub runs: u32,
}

impl WithFilter for Named<'_> {
    type Output = Errors;

    fn in_plane<F: Filter<4>>(self, filter: F) -> Errors {
        errors_of(&filter, &filter.step(PERIOD_S), self.truth, self.runs)
    }

    fn in_volume<F: Filter<6>>(self, _filter: F) -> Errors {
        panic!("the scene is of the plane")
    }

    fn of_bearings<F: Filter<2>>(self, _filter: F) -> Errors {
        panic!("the scene has places")
    }
}

/// The same in the light of all later fixes.
pub struct NamedAndSmoothed<'a>(pub Named<'a>);

impl WithFilter for NamedAndSmoothed<'_> {
    type Output = Errors;

    fn in_plane<F: Filter<4>>(self, filter: F) -> Errors {
        let Named { truth, runs } = self.0;
        smoothed_errors_of(&filter, &filter.step(PERIOD_S), truth, runs)
    }

    fn in_volume<F: Filter<6>>(self, _filter: F) -> Errors {
        panic!("the scene is of the plane")
    }

    fn of_bearings<F: Filter<2>>(self, _filter: F) -> Errors {
        panic!("the scene has places")
    }
}

/// What a program in numpy gave: name, RMS over all fixes, in each part, at the peak, of the velocity, mean NEES; runs.
pub const PUBLISHED: [(&str, [f64; 9], u32); 8] = [
    (
        "CV 0.1",
        [
            982.212, 72.115, 1048.913, 892.658, 905.663, 1369.596, 2163.058, 53.239, 1630.062,
        ],
        1000,
    ),
    (
        "CV 1",
        [
            141.846, 91.584, 162.342, 100.059, 286.121, 144.140, 402.912, 21.038, 9.926,
        ],
        1000,
    ),
    (
        "CV 2",
        [
            114.900, 102.952, 119.908, 105.379, 178.097, 110.432, 215.899, 17.112, 3.610,
        ],
        1000,
    ),
    (
        "IMM CV 0.1 / CV 2",
        [
            107.106, 80.022, 129.898, 87.136, 197.833, 95.281, 223.888, 16.626, 6.534,
        ],
        1000,
    ),
    (
        "IMM CV / CT+1 / CT-3",
        [
            87.488, 88.249, 84.162, 85.960, 100.515, 87.350, 129.631, 10.660, 2.740,
        ],
        1000,
    ),
    (
        "IMM CV / CT unknown, 1 deg/s, lent",
        [
            95.539, 80.655, 114.259, 82.238, 149.499, 87.714, 172.750, 13.203, 7.190,
        ],
        300,
    ),
    (
        "IMM CV / CT unknown, 0.5 deg/s, lent",
        [
            104.082, 79.262, 110.726, 79.528, 185.946, 111.525, 221.076, 14.459, 13.233,
        ],
        300,
    ),
    (
        "IMM CV / CT unknown, 0.5 deg/s, zero",
        [
            116.197, 78.326, 114.845, 79.477, 231.293, 132.293, 302.234, 17.043, 22.334,
        ],
        300,
    ),
];

/// The same numbers of a filter.
pub fn row(errors: &Errors) -> [f64; 9] {
    let mut row = [0.0; 9];
    row[0] = errors.all_m();
    for (place, (_, fixes)) in PARTS.iter().enumerate() {
        row[1 + place] = errors.place_m(fixes.clone());
    }
    (row[6], row[7], row[8]) = (errors.peak_m().1, errors.speed_mps(), errors.nees());
    row
}
