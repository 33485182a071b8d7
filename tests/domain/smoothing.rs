//! Smoothing against worked numbers, against the Gaussian of all states at once, and against data that moves as it believes.

use crate::maneuver_scene::{Named, NamedAndSmoothed, filter_of, smoothed_errors_of, truth};
use nalgebra::{DMatrix, DVector, Matrix2, Matrix4, SMatrix, SVector, Vector2, Vector4};
use rand_distr::{Distribution, StandardNormal};
use serde_json::{Value, json};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{Outcome, plan, presets, run};
use trackloom_domain::filtering::gaussian::GaussianFilter;
use trackloom_domain::filtering::imm::settings::Model;
use trackloom_domain::filtering::imm::{Imm, Mixing, Models};
use trackloom_domain::filtering::motions::AnyMotion;
use trackloom_domain::filtering::{Filter, Reports, Way};
use trackloom_domain::hypotheses::certain::update;
use trackloom_domain::math::rng::{Purpose, Seed};
use trackloom_domain::model::motion::Motion;
use trackloom_domain::model::motion::constant_acceleration::ConstantAcceleration;
use trackloom_domain::model::motion::constant_velocity::ConstantVelocity;
use trackloom_domain::model::motion::coordinated_turn::CoordinatedTurn;
use trackloom_domain::model::motion::ornstein_uhlenbeck::OrnsteinUhlenbeck;
use trackloom_domain::model::motion::singer::Singer;
use trackloom_domain::model::scan::Measurement;
use trackloom_domain::model::sensing::MeasurementModel;
use trackloom_domain::model::state::GaussianState;

/// Of the axis of y it says nothing.
const ALONG_X: MeasurementModel = MeasurementModel::Position {
    sigma_x_m: 2.0,
    sigma_y_m: 1e9,
};

fn velocity(spectral_density: f64) -> ConstantVelocity {
    ConstantVelocity { spectral_density }
}

/// The beliefs of a filter after each look, some of them without a report, then the same smoothed.
fn smoothed<F: Filter<K>, const K: usize>(
    filter: &F,
    sensor: &MeasurementModel,
    start: F::Belief,
    looks: &[(f64, Option<Measurement>)],
) -> Vec<F::Belief> {
    let mut beliefs = Vec::new();
    let (mut belief, mut last_s) = (start, looks[0].0);
    for (time_s, report) in looks {
        F::predict(&filter.step(time_s - last_s), &mut belief);
        if let Some(report) = report {
            update(filter, sensor, report, &mut belief).unwrap();
        }
        last_s = *time_s;
        beliefs.push(belief);
    }
    for index in (1..beliefs.len()).rev() {
        let step = filter.step(looks[index].0 - looks[index - 1].0);
        beliefs[index - 1] = F::smooth(&step, &beliefs[index - 1], &beliefs[index]);
    }
    beliefs
}

#[test]
fn a_gap_is_bridged_as_worked_by_hand() {
    let filter = GaussianFilter::<_, 4, 4>::new(velocity(0.5), Way::Line, Reports::Positions);
    let start = GaussianState {
        mean: Vector4::new(0.0, 0.0, 1.0, 0.0),
        covariance: Matrix4::from_diagonal(&Vector4::new(10.0, 1.0, 4.0, 1.0)),
    };
    let at = |x_m| Some(Measurement::Position { x_m, y_m: 0.0 });
    let looks = [(0.0, at(0.3)), (1.0, at(1.9)), (2.0, None), (4.0, at(7.5))];
    let found = smoothed(&filter, &ALONG_X, start, &looks);
    let expected = [
        (
            [0.2907812435883, 1.642731274951],
            [2.004959346257, -0.6021560845785, 0.8575331062742],
        ),
        (
            [1.971452103619, 1.716379325505],
            [1.430800705798, -0.03552439517665, 0.6348402867745],
        ),
        (
            [3.717589069898, 1.772174901956],
            [1.65071065074, 0.2150417870842, 0.5512084742683],
        ),
        (
            [7.321454155358, 1.816811363117],
            [3.652587829084, 1.074947094444, 1.035448187728],
        ),
    ];
    for (found, (mean, [pp, pv, vv])) in found.iter().zip(expected) {
        let mean = Vector2::from(mean);
        let along = Vector2::new(found.mean[0], found.mean[2]);
        assert!((along - mean).abs().max() < 1e-11, "{along} {mean}");
        let p = &found.covariance;
        let along = Matrix2::new(p[(0, 0)], p[(0, 2)], p[(2, 0)], p[(2, 2)]);
        assert!(
            (along - Matrix2::new(pp, pv, pv, vv)).abs().max() < 1e-11,
            "{along}"
        );
    }
}

/// All states of a linear motion are one Gaussian: conditioned on all reports at once it says of each state what the smoother does.
fn equals_the_batch<M: Motion<N>, const N: usize>(motion: M) {
    let filter = GaussianFilter::<M, N, 4>::new(motion, Way::Line, Reports::Positions);
    let mut draw = Seed { seed: 3, run: 0 }.stream(Purpose::Detection, 0, 0);
    let start = GaussianState {
        mean: SVector::<f64, N>::from_fn(|row, _| row as f64 - 2.0),
        covariance: SMatrix::<f64, N, N>::identity() * 9.0,
    };
    let times_s = [0.0, 0.7, 2.0, 2.0, 5.5, 6.0];
    let mut looks = Vec::new();
    for (index, time_s) in times_s.into_iter().enumerate() {
        let [x_m, y_m] = [0, 1].map(|_| {
            let one: f64 = StandardNormal.sample(&mut draw);
            5.0 * one
        });
        looks.push((
            time_s,
            (index != 2).then_some(Measurement::Position { x_m, y_m }),
        ));
    }
    let sensor = MeasurementModel::Position {
        sigma_x_m: 2.0,
        sigma_y_m: 3.0,
    };
    let found = smoothed(&filter, &sensor, start, &looks);
    // The means, and the covariances of all pairs of states.
    let all = N * looks.len();
    let (mut mean, mut covariance) = (DVector::zeros(all), DMatrix::zeros(all, all));
    let mut state = start;
    for index in 0..looks.len() {
        let dt_s = looks[index].0 - looks[index.saturating_sub(1)].0;
        let step = motion.step(dt_s);
        let transition = M::transition(&step, &state.mean);
        M::predict(&step, &mut state);
        for before in 0..index {
            let cross =
                covariance.view((N * before, N * (index - 1)), (N, N)) * transition.transpose();
            covariance
                .view_mut((N * before, N * index), (N, N))
                .copy_from(&cross);
            covariance
                .view_mut((N * index, N * before), (N, N))
                .tr_copy_from(&cross);
        }
        mean.rows_mut(N * index, N).copy_from(&state.mean);
        covariance
            .view_mut((N * index, N * index), (N, N))
            .copy_from(&state.covariance);
    }
    let reported: Vec<(usize, f64, f64)> = looks
        .iter()
        .enumerate()
        .filter_map(|(index, look)| Some((index, look.1?.position()?)))
        .flat_map(|(index, place)| [(N * index, place.x, 4.0), (N * index + 1, place.y, 9.0)])
        .collect();
    let seen = |row: usize, column: usize| covariance[(reported[row].0, reported[column].0)];
    let mut s = DMatrix::from_fn(reported.len(), reported.len(), seen);
    for (index, (.., variance)) in reported.iter().enumerate() {
        s[(index, index)] += variance;
    }
    let cross = DMatrix::from_fn(all, reported.len(), |row, column| {
        covariance[(row, reported[column].0)]
    });
    let innovation = DVector::from_fn(reported.len(), |row, _| {
        reported[row].1 - mean[reported[row].0]
    });
    let gain = &cross * s.try_inverse().unwrap();
    let (mean, covariance) = (
        mean + &gain * innovation,
        covariance - gain * cross.transpose(),
    );
    for (index, found) in found.iter().enumerate() {
        let apart = found.mean - mean.rows(N * index, N);
        assert!(apart.amax() < 1e-8, "{index}: {apart}");
        let apart = found.covariance - covariance.view((N * index, N * index), (N, N));
        assert!(apart.amax() < 1e-8, "{index}: {apart}");
    }
}

#[test]
fn every_linear_motion_is_smoothed_as_by_all_states_at_once() {
    equals_the_batch::<_, 4>(velocity(0.5));
    equals_the_batch::<_, 6>(ConstantAcceleration {
        spectral_density: 0.3,
        initial_sigma: 1.0,
    });
    equals_the_batch::<_, 6>(Singer {
        maneuver_sigma_mps2: 1.0,
        maneuver_time_s: 4.0,
    });
    equals_the_batch::<_, 4>(CoordinatedTurn {
        turn_rate_radps: 0.2,
        spectral_density: 0.4,
    });
    equals_the_batch::<_, 4>(OrnsteinUhlenbeck {
        damping_per_s: 0.1,
        spectral_density: 0.4,
        mean_velocity_mps: [3.0, -1.0],
    });
}

/// A motion without noise from what is known for certain: nothing is learned, and nothing fails.
#[test]
fn what_is_certain_stays() {
    let filter = GaussianFilter::<_, 4, 4>::new(velocity(0.0), Way::Line, Reports::Positions);
    let start = GaussianState {
        mean: Vector4::new(1.0, 2.0, 3.0, 4.0),
        covariance: Matrix4::zeros(),
    };
    let at = Some(Measurement::Position { x_m: 9.0, y_m: 9.0 });
    let found = smoothed(&filter, &ALONG_X, start, &[(0.0, at), (1.0, at), (2.0, at)]);
    assert_eq!(found[1].mean, Vector4::new(4.0, 6.0, 3.0, 4.0));
    assert_eq!(found[0].covariance, Matrix4::zeros());
}

#[test]
fn equal_models_are_smoothed_as_one() {
    let motion = velocity(0.5);
    let model = Model {
        motion: AnyMotion::ConstantVelocity(motion),
        sojourn_s: 10.0,
        initial_probability: None,
    };
    let models = Models::new(&[model, model], Mixing::Unbiased).unwrap();
    let several = Imm::<2, 4>::new(models, Way::Line, Reports::Positions);
    let one = GaussianFilter::<_, 4, 4>::new(motion, Way::Line, Reports::Positions);
    let start = GaussianState {
        mean: Vector4::new(0.0, 5.0, 1.0, -1.0),
        covariance: Matrix4::identity() * 16.0,
    };
    let sensor = MeasurementModel::Position {
        sigma_x_m: 2.0,
        sigma_y_m: 3.0,
    };
    let at = |x_m, y_m| Some(Measurement::Position { x_m, y_m });
    let looks = [
        (0.0, at(1.0, 4.0)),
        (1.0, at(4.0, 3.0)),
        (3.0, None),
        (4.0, at(2.0, 0.0)),
    ];
    let expected = smoothed(&one, &sensor, start, &looks);
    let found = smoothed(&several, &sensor, several.begin(&start), &looks);
    for (found, expected) in found.iter().zip(&expected) {
        let found = Imm::<2, 4>::kinematics(found);
        assert!((found.mean - expected.mean).abs().max() < 1e-12);
        assert!((found.covariance - expected.covariance).abs().max() < 1e-11);
    }
}

/// Targets that move as the filter believes: at every time but the last the error is smaller than before, and the normalised error is
/// that of four variables within four standard errors.
#[test]
fn smoothed_errors_are_smaller_and_as_large_as_they_say() {
    const RUNS: u32 = 1000;
    let motion = velocity(1.0);
    let filter = GaussianFilter::<_, 4, 4>::new(motion, Way::Line, Reports::Positions);
    let sensor = MeasurementModel::Position {
        sigma_x_m: 10.0,
        sigma_y_m: 10.0,
    };
    let start = GaussianState {
        mean: Vector4::zeros(),
        covariance: Matrix4::from_diagonal(&Vector4::new(100.0, 100.0, 400.0, 400.0)),
    };
    let (mut filtered, mut later, mut normalised) = ([0.0; 20], [0.0; 20], [0.0; 20]);
    for run in 0..RUNS {
        let mut draw = Seed { seed: 5, run }.stream(Purpose::Detection, 0, 0);
        let mut normal = |covariance: &Matrix4<f64>| {
            let noise = Vector4::from_fn(|_, _| StandardNormal.sample(&mut draw));
            covariance
                .cholesky()
                .map_or(Vector4::zeros(), |root| root.l() * noise)
        };
        let mut state = normal(&start.covariance);
        let (mut states, mut looks) = (Vec::new(), Vec::new());
        for index in 0..20 {
            if index > 0 {
                let step = motion.step(2.0);
                let noise = GaussianState {
                    mean: state,
                    covariance: Matrix4::zeros(),
                };
                let mut moved = noise;
                ConstantVelocity::predict(&step, &mut moved);
                state = moved.mean + normal(&moved.covariance);
            }
            let seen = state + normal(&(Matrix4::identity() * 100.0));
            let report = Measurement::Position {
                x_m: seen[0],
                y_m: seen[1],
            };
            states.push(state);
            looks.push((2.0 * f64::from(index), Some(report)));
        }
        let found = smoothed(&filter, &sensor, start, &looks);
        for index in 0..20 {
            let known = smoothed(&filter, &sensor, start, &looks[..=index]);
            filtered[index] += (known[index].mean - states[index]).xy().norm_squared();
            let error = found[index].mean - states[index];
            later[index] += error.xy().norm_squared();
            let inverse = found[index].covariance.try_inverse().unwrap();
            normalised[index] += (error.transpose() * inverse * error)[0] / f64::from(RUNS);
        }
    }
    // The variance of a chi-square variable of four is 8.
    let most = 4.0 * (8.0 / f64::from(RUNS)).sqrt();
    for index in 0..20 {
        assert!(
            (normalised[index] - 4.0).abs() < most,
            "{index}: {}",
            normalised[index]
        );
        assert!(index == 19 || later[index] < filtered[index], "{index}");
    }
    assert_eq!(later[19], filtered[19]);
}

/// The airliner that turns twice. Of rates that are told every fix but the last gains; of others those that gain nothing are the
/// four before the short turn, which comes as a surprise from both sides.
#[test]
fn several_models_err_less() {
    let (truth, runs) = (truth(), 100);
    let told = json!({"method": "imm", "models": [
        {"model": "constant_velocity", "process_noise_m2ps3": 0.05, "sojourn_s": 200.0},
        {"model": "coordinated_turn", "turn_rate_degps": 1.0, "process_noise_m2ps3": 0.05},
        {"model": "coordinated_turn", "turn_rate_degps": -3.0, "process_noise_m2ps3": 0.05},
    ]});
    let preset = presets::find("atc-maneuver").unwrap();
    for (filter, surprised) in [(told, 0..0), (preset.body["filter"].clone(), 66..70)] {
        let named = || Named {
            truth: &truth,
            runs,
        };
        let filtered = filter_of(&filter).with(named());
        let later = filter_of(&filter).with(NamedAndSmoothed(named()));
        for fix in (0..99).filter(|fix| !surprised.contains(fix)) {
            let [before, after] = [&filtered, &later].map(|errors| errors.place_m(fix..fix + 1));
            assert!(after < before, "{fix}: {after} {before}");
        }
        assert_eq!(later.place_m(99..100), filtered.place_m(99..100));
        assert!(later.all_m() < 0.65 * filtered.all_m(), "{}", later.all_m());
        assert!(
            later.nees() < 1.1 * filtered.nees(),
            "{} {}",
            later.nees(),
            filtered.nees()
        );
        // One motion that is as agile all the time has less to gain.
        let one = GaussianFilter::<_, 4, 4>::new(velocity(20.0), Way::Line, Reports::Positions);
        let one = smoothed_errors_of(&one, &one.step(5.0), &truth, runs);
        assert!(
            later.all_m() < one.all_m(),
            "{} {}",
            later.all_m(),
            one.all_m()
        );
    }
}

fn outcome(kind: &str, smoothing: Value) -> Outcome {
    let mut body = presets::find("atc-maneuver").unwrap().body.clone();
    if kind == "associate" {
        body.as_object_mut().unwrap().remove("comparison");
    }
    if !smoothing.is_null() {
        body["tracker"]["smoothing"] = smoothing;
    }
    let kind = serde_json::from_value(json!(kind)).unwrap();
    run(&plan(kind, &body).unwrap(), Vec::new(), &mut Silent).unwrap()
}

fn file(outcome: &Outcome, name: &str) -> Option<String> {
    let artifact = outcome.artifacts.iter().find(|one| one.name == name)?;
    Some(String::from_utf8(artifact.bytes.clone()).unwrap())
}

/// Columns x and y of each line.
fn places(csv: &str) -> Vec<[f64; 2]> {
    let header: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let columns = ["x_m", "y_m"].map(|name| header.iter().position(|one| *one == name).unwrap());
    let of_line = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        columns.map(|column| cells[column].parse().unwrap())
    };
    csv.lines().skip(1).map(of_line).collect()
}

#[test]
fn a_job_leaves_smoothed_tracks_beside_the_others() {
    let none = outcome("associate", Value::Null);
    assert_eq!(file(&none, "smoothed_tracks.csv"), None);
    let all = outcome("associate", json!({"method": "fixed_interval"}));
    let tracks = file(&all, "tracks.csv");
    assert_eq!(tracks, file(&none, "tracks.csv"), "what is filtered stays");
    let smoothed = file(&all, "smoothed_tracks.csv").unwrap();
    let (before, after) = (places(&tracks.unwrap()), places(&smoothed));
    assert_eq!(before.len(), after.len());
    assert_eq!(before.last(), after.last());
    assert_ne!(before[20], after[20]);
    let long = outcome("associate", json!({"method": "fixed_lag", "lag_s": 1e5}));
    assert_eq!(file(&long, "smoothed_tracks.csv").unwrap(), smoothed);
    // With a lag of one period only the next fix matters: the last but one is as with all.
    let short = outcome("associate", json!({"method": "fixed_lag", "lag_s": 5.0}));
    let short = places(&file(&short, "smoothed_tracks.csv").unwrap());
    let last = after.len() - 1;
    assert_eq!(short[last - 1], after[last - 1]);
    assert_ne!(short[last - 2], after[last - 2]);
}

#[test]
fn a_job_judges_both() {
    let judged = outcome("evaluate", json!({"method": "fixed_interval"}));
    let rmse = |part: &Value| part["metrics"]["kinematics"]["value"].as_f64().unwrap();
    let (filtered, smoothed) = (rmse(&judged.result), rmse(&judged.result["smoothed"]));
    assert!(smoothed < 0.9 * filtered, "{smoothed} {filtered}");
}
