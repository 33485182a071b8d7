//! Reports with noises, times and velocities of their own, against a plain Kalman filter that takes each at its time.

use nalgebra::{DMatrix, DVector};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde_json::{Value, json};
use trackloom_domain::association::ASSOCIATORS;
use trackloom_domain::filtering::{AnyFilter, FILTERS};
use trackloom_domain::math::gaussian::gate_threshold;
use trackloom_domain::math::rng::{Purpose, Seed};
use trackloom_domain::model::own::{Own, OwnNoise};
use trackloom_domain::model::scan::{Detection, Measurement, Scan};
use trackloom_domain::model::sensing::{MeasurementModel, Moving, VelocityNoise};
use trackloom_domain::model::sensor::Sensor;
use trackloom_domain::model::state::GaussianState;
use trackloom_domain::model::track::Candidate;
use trackloom_domain::model::watch::Watch;
use trackloom_domain::registry;
use trackloom_domain::tracking::recorder::{RecordedPoint, Recorder};
use trackloom_domain::tracking::{GivenTrack, Initiation, Lifecycle, TRACKERS, TrackerParts};

const PERIOD_S: f64 = 4.0;
const GATE: f64 = 0.99;
/// So little noise that what it does between the times of a scan and of a plot is below rounding.
const STILL: f64 = 1e-12;

fn filter(method: &str, parameters: &Value) -> AnyFilter {
    let found = FILTERS.iter().find(|filter| filter.name == method).unwrap();
    (found.build)(&registry::check(parameters, found.parameters).unwrap()).unwrap()
}

fn kalman(process_noise_m2ps3: f64) -> AnyFilter {
    let parameters = json!({"process_noise_m2ps3": process_noise_m2ps3});
    filter("kalman", &parameters)
}

fn sensor(report: MeasurementModel) -> Sensor {
    Sensor {
        sensor_id: "radar".into(),
        p_d: 0.9,
        clutter_density: 1e-6,
        may_start: false,
        report,
        sight: None,
    }
}

fn places(sigma_m: f64) -> Sensor {
    sensor(MeasurementModel::Position {
        sigma_x_m: sigma_m,
        sigma_y_m: sigma_m,
    })
}

fn guess() -> GaussianState {
    GaussianState {
        mean: [0.0, 0.0, 90.0, -20.0].into(),
        covariance: nalgebra::Matrix4::from_diagonal(&[1e4, 1e4, 400.0, 400.0].into()),
    }
}

/// The candidates of the track after each scan.
#[derive(Default)]
struct Candidates(Vec<Vec<Candidate>>);

impl Recorder for Candidates {
    fn given(&mut self, _serial: u32, _name: &str) {}

    fn end(&mut self, _serial: u32) {}

    fn point(&mut self, point: &RecordedPoint) {
        self.0.push(point.candidates.to_vec());
    }
}

/// The track's kinematics and candidates after each scan.
fn tracked(
    filter: AnyFilter,
    associator: &str,
    sensor: Sensor,
    scans: &[Scan],
) -> Vec<(GaussianState, Vec<Candidate>)> {
    tracked_with(filter, (associator, &json!({})), sensor, scans)
}

fn tracked_with(
    filter: AnyFilter,
    (associator, parameters): (&str, &Value),
    sensor: Sensor,
    scans: &[Scan],
) -> Vec<(GaussianState, Vec<Candidate>)> {
    let method = ASSOCIATORS.iter().find(|method| method.name == associator);
    let method = method.unwrap();
    let parameters = registry::check(parameters, method.parameters).unwrap();
    let rules = registry::check(&json!({"gate_probability": GATE}), TRACKERS[0].parameters);
    let mut kinematics = Vec::new();
    guess().pack_into(&mut kinematics);
    let mut tracker = (TRACKERS[0].build)(TrackerParts {
        filter,
        associator: (method.build)(&parameters, Seed { seed: 1, run: 0 }).unwrap(),
        lifecycle: Lifecycle {
            initiation: Initiation::Truth {
                speed_sigma_mps: 5.0,
                rate_sigma_degps: 0.1,
            },
            ..serde_json::from_value(rules.unwrap()).unwrap()
        },
        sensors: vec![sensor],
        undetected: None,
        given: vec![GivenTrack {
            name: "target".into(),
            origin: None,
            kinematics,
        }],
    });
    let (mut recorder, mut found) = (Candidates::default(), Vec::new());
    for scan in scans {
        tracker.step(scan, &mut recorder, &Watch::never()).unwrap();
        let state = GaussianState::unpacked(&tracker.tracks()[0].kinematics).unwrap();
        found.push((state, recorder.0.last().unwrap().clone()));
    }
    found
}

/// A plain Kalman filter of (x, y, vx, vy) at any times.
#[derive(Clone)]
struct Plain {
    time_s: f64,
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
    noise_m2ps3: f64,
}

impl Plain {
    fn new(noise_m2ps3: f64) -> Self {
        let guess = guess();
        Plain {
            time_s: 0.0,
            mean: DVector::from_column_slice(guess.mean.as_slice()),
            covariance: DMatrix::from_column_slice(4, 4, guess.covariance.as_slice()),
            noise_m2ps3,
        }
    }

    /// Back in time without noise.
    fn go_to(&mut self, time_s: f64) {
        let dt_s = time_s - self.time_s;
        let mut transition = DMatrix::identity(4, 4);
        let mut noise = DMatrix::zeros(4, 4);
        let q = if dt_s > 0.0 { self.noise_m2ps3 } else { 0.0 };
        for axis in 0..2 {
            transition[(axis, axis + 2)] = dt_s;
            noise[(axis, axis)] = q * dt_s.powi(3) / 3.0;
            noise[(axis, axis + 2)] = q * dt_s.powi(2) / 2.0;
            noise[(axis + 2, axis)] = q * dt_s.powi(2) / 2.0;
            noise[(axis + 2, axis + 2)] = q * dt_s;
        }
        self.mean = &transition * &self.mean;
        self.covariance = &transition * &self.covariance * transition.transpose() + noise;
        self.time_s = time_s;
    }

    /// The squared distance of a report of the first variables.
    fn squared_distance(&self, report: &DVector<f64>, noise: &DMatrix<f64>) -> f64 {
        let values = report.len();
        let innovation = report - self.mean.rows(0, values);
        let spread = self.covariance.view((0, 0), (values, values)) + noise;
        let weighted = spread.try_inverse().unwrap() * &innovation;
        innovation.dot(&weighted)
    }

    fn take(&mut self, report: &DVector<f64>, noise: &DMatrix<f64>) {
        let values = report.len();
        let innovation = report - self.mean.rows(0, values);
        let spread = self.covariance.view((0, 0), (values, values)) + noise;
        let cross = self.covariance.columns(0, values).into_owned();
        let gain = &cross * spread.try_inverse().unwrap();
        self.mean += &gain * innovation;
        self.covariance -= &gain * cross.transpose();
    }

    fn assert_is(&self, state: &GaussianState, tolerance: f64) {
        for row in 0..4 {
            let (found, wanted) = (state.mean[row], self.mean[row]);
            let scale = self.covariance[(row, row)].sqrt();
            assert!(
                (found - wanted).abs() < tolerance * scale,
                "{found} {wanted}"
            );
            for column in 0..4 {
                let found = state.covariance[(row, column)];
                let wanted = self.covariance[(row, column)];
                let scale = scale * self.covariance[(column, column)].sqrt();
                assert!(
                    (found - wanted).abs() < tolerance * scale,
                    "{found} {wanted}"
                );
            }
        }
    }
}

/// Draws of the standard normal distribution, and uniform ones.
struct Draw(ChaCha8Rng);

impl Draw {
    fn new(number: u64) -> Self {
        Draw(Seed { seed: 11, run: 0 }.stream(Purpose::Detection, number, 0))
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }
}

/// The target at a time.
fn truth(time_s: f64) -> [f64; 4] {
    [100.0 * time_s, -30.0 * time_s, 100.0, -30.0]
}

fn noise(sigma_x_m: f64, sigma_y_m: f64, correlation_xy: f64) -> OwnNoise {
    OwnNoise {
        sigma_x_m: Some(sigma_x_m),
        sigma_y_m: Some(sigma_y_m),
        correlation_xy: Some(correlation_xy),
        ..OwnNoise::default()
    }
}

/// R of a position.
fn matrix(noise: &OwnNoise) -> DMatrix<f64> {
    let (x, y) = (noise.sigma_x_m.unwrap(), noise.sigma_y_m.unwrap());
    let mixed = noise.correlation_xy.unwrap() * x * y;
    DMatrix::from_row_slice(2, 2, &[x * x, mixed, mixed, y * y])
}

/// A plot of the target at its own time, with errors of its own noise.
fn plot(scan_s: f64, own: &Own, draw: &mut Draw) -> Detection {
    let [x_m, y_m, ..] = truth(scan_s + own.after_s);
    let root = matrix(&own.noise).cholesky().unwrap().l();
    let errors = root * DVector::from_vec(vec![draw.normal(), draw.normal()]);
    Detection {
        measurement: Measurement::Position {
            x_m: x_m + errors[0],
            y_m: y_m + errors[1],
        },
        origin: None,
        amplitude: None,
    }
}

fn scan(index: usize, detections: Vec<Detection>, own: Vec<Own>) -> Scan {
    Scan {
        number: index as u32 + 1,
        time_s: PERIOD_S * index as f64,
        sensor: 0,
        pose: None,
        own,
        detections,
    }
}

fn report(detection: &Detection) -> DVector<f64> {
    let place_m = detection.measurement.position().unwrap();
    DVector::from_column_slice(place_m.as_slice())
}

/// Scans of one plot each: at its own time, with its own noise.
fn single_plots(draw: &mut Draw, latest_s: f64) -> Vec<Scan> {
    let plots = (0..20).map(|index| {
        let (x, y) = (draw.uniform(5.0, 80.0), draw.uniform(5.0, 80.0));
        let own = Own {
            after_s: draw.uniform(-latest_s, latest_s),
            noise: noise(x, y, draw.uniform(-0.9, 0.9)),
            velocity_mps: None,
        };
        let detection = plot(PERIOD_S * index as f64, &own, draw);
        scan(index, vec![detection], vec![own])
    });
    plots.collect()
}

#[test]
fn a_plot_counts_at_its_own_time_with_its_own_noise() {
    for (latest_s, q) in [(0.0, 1.0), (1.9, STILL)] {
        let scans = single_plots(&mut Draw::new(1), latest_s);
        let found = tracked(kalman(q), "nearest_neighbour", places(20.0), &scans);
        let mut plain = Plain::new(q);
        for (scan, (state, candidates)) in scans.iter().zip(&found) {
            assert_eq!(candidates[0].detection, Some(0));
            plain.go_to(scan.time_s + scan.own[0].after_s);
            plain.take(&report(&scan.detections[0]), &matrix(&scan.own[0].noise));
            plain.go_to(scan.time_s);
            plain.assert_is(state, 1e-6);
        }
    }
}

#[test]
fn without_their_own_times_plots_of_a_fast_target_are_far_off() {
    let draw = &mut Draw::new(2);
    let mut scans = Vec::new();
    for index in 0..40 {
        let own = Own {
            after_s: draw.uniform(-1.9, 1.9),
            noise: noise(10.0, 10.0, 0.0),
            velocity_mps: None,
        };
        scans.push(scan(
            index,
            vec![plot(PERIOD_S * index as f64, &own, draw)],
            vec![own],
        ));
    }
    let error_m = |scans: &[Scan]| {
        let found = tracked(kalman(1.0), "nearest_neighbour", places(10.0), scans);
        let errors = found.iter().zip(scans).skip(10).map(|((state, _), scan)| {
            let [x_m, y_m, ..] = truth(scan.time_s);
            (state.mean[0] - x_m).hypot(state.mean[1] - y_m)
        });
        errors.sum::<f64>() / 30.0
    };
    let with_times = error_m(&scans);
    scans.iter_mut().for_each(|scan| scan.own.clear());
    let without = error_m(&scans);
    assert!(
        with_times < 15.0 && without > 3.0 * with_times,
        "{with_times} {without}"
    );
}

/// Scans of a plot of the target and one that is not, both near.
fn double_plots(draw: &mut Draw) -> Vec<Scan> {
    let mut scans = Vec::new();
    for index in 0..15 {
        let (mut detections, mut own) = (Vec::new(), Vec::new());
        for _ in 0..2 {
            let (x, y) = (draw.uniform(30.0, 90.0), draw.uniform(30.0, 90.0));
            own.push(Own {
                after_s: 0.0,
                noise: noise(x, y, draw.uniform(-0.5, 0.5)),
                velocity_mps: None,
            });
            detections.push(plot(PERIOD_S * index as f64, own.last().unwrap(), draw));
        }
        scans.push(scan(index, detections, own));
    }
    scans
}

#[test]
fn soft_weights_mix_what_each_plot_would_make_of_the_track() {
    let scans = double_plots(&mut Draw::new(3));
    let found = tracked(kalman(1.0), "jpda", places(20.0), &scans);
    let (mut plain, mut mixed) = (Plain::new(1.0), 0);
    for (scan, (state, candidates)) in scans.iter().zip(&found) {
        plain.go_to(scan.time_s);
        let parts: Vec<(f64, Plain)> = candidates
            .iter()
            .map(|candidate| {
                let mut part = plain.clone();
                if let Some(detection) = candidate.detection {
                    let at = detection as usize;
                    part.take(&report(&scan.detections[at]), &matrix(&scan.own[at].noise));
                }
                (candidate.probability, part)
            })
            .collect();
        mixed += usize::from(parts.iter().filter(|(weight, _)| *weight > 0.1).count() > 1);
        let mean = parts.iter().map(|(weight, part)| &part.mean * *weight);
        plain.mean = mean.fold(DVector::zeros(4), |sum, part| sum + part);
        let spread = |(weight, part): &(f64, Plain)| {
            let apart = &part.mean - &plain.mean;
            (&part.covariance + &apart * apart.transpose()) * *weight
        };
        plain.covariance = parts
            .iter()
            .map(spread)
            .fold(DMatrix::zeros(4, 4), |sum, part| sum + part);
        plain.assert_is(state, 1e-9);
    }
    assert!(mixed > 10, "{mixed}");
}

/// With q = 2 the weights of a track alone are inverse to squared distances.
#[test]
fn memberships_compare_plots_with_the_track_at_their_own_times() {
    let (draw, weighted) = (&mut Draw::new(7), json!({"weights": "weighted"}));
    let mut compared = 0;
    for _ in 0..50 {
        let plots = [-1.9, 1.9].map(|after_s| {
            let own = Own {
                after_s,
                noise: noise(20.0, 20.0, 0.0),
                velocity_mps: None,
            };
            (plot(0.0, &own, draw), own)
        });
        let (detections, own): (Vec<_>, Vec<_>) = plots.into_iter().unzip();
        let scan = scan(0, detections, own);
        let (mut plain, mut squared) = (Plain::new(STILL), Vec::new());
        plain.go_to(scan.time_s);
        let spread = plain.covariance.clone();
        for (detection, own) in scan.detections.iter().zip(&scan.own) {
            plain.go_to(scan.time_s + own.after_s);
            let at_the_scan = Plain {
                covariance: spread.clone(),
                ..plain.clone()
            };
            let sensor = matrix(&noise(20.0, 20.0, 0.0));
            squared.push(at_the_scan.squared_distance(&report(detection), &sensor));
        }
        let found = tracked_with(
            kalman(STILL),
            ("fuzzy_c_means", &weighted),
            places(20.0),
            &[scan],
        );
        let weight = |detection| {
            let mut candidates = found[0].1.iter();
            let one = candidates.find(|candidate| candidate.detection == Some(detection));
            one.map(|candidate| candidate.probability)
        };
        if let (Some(first), Some(second)) = (weight(0), weight(1)) {
            let (ratio, wanted) = (first / second, squared[1] / squared[0]);
            assert!((ratio / wanted - 1.0).abs() < 1e-6, "{ratio} {wanted}");
            compared += 1;
        }
    }
    assert!(compared > 20, "{compared}");
}

#[test]
fn models_that_are_the_same_are_one_filter() {
    let model = |sojourn_s: f64| json!({"model": "constant_velocity", "process_noise_m2ps3": 1.0, "sojourn_s": sojourn_s});
    let models = json!({"models": [model(20.0), model(10.0)]});
    let imm = filter("imm", &models);
    for scans in [
        double_plots(&mut Draw::new(4)),
        single_plots(&mut Draw::new(5), 1.9),
    ] {
        let wanted = tracked(kalman(1.0), "jpda", places(20.0), &scans);
        let found = tracked(imm, "jpda", places(20.0), &scans);
        for ((state, _), (wanted, _)) in found.iter().zip(&wanted) {
            let difference = (state.covariance - wanted.covariance).abs().max();
            assert!(difference < 1e-6 * wanted.covariance.max(), "{difference}");
            assert!((state.mean - wanted.mean).abs().max() < 1e-6);
        }
    }
}

#[test]
fn the_candidates_are_those_inside_their_own_gates() {
    let (draw, mut scans, mut plain) = (&mut Draw::new(6), Vec::new(), Plain::new(STILL));
    let mut wanted = Vec::new();
    for index in 0..8 {
        let [x_m, y_m, ..] = truth(PERIOD_S * index as f64);
        let (mut detections, mut own) = (Vec::new(), Vec::new());
        for _ in 0..300 {
            own.push(Own {
                after_s: draw.uniform(-1.9, 1.9),
                noise: noise(
                    draw.uniform(1.0, 200.0),
                    draw.uniform(1.0, 200.0),
                    draw.uniform(-0.9, 0.9),
                ),
                velocity_mps: None,
            });
            detections.push(Detection {
                measurement: Measurement::Position {
                    x_m: x_m + draw.uniform(-2000.0, 2000.0),
                    y_m: y_m + draw.uniform(-2000.0, 2000.0),
                },
                origin: None,
                amplitude: None,
            });
        }
        scans.push(scan(index, detections, own));
    }
    let found = tracked(kalman(STILL), "pda", places(20.0), &scans);
    for (scan, (state, candidates)) in scans.iter().zip(&found) {
        plain.go_to(scan.time_s);
        let is_inside = |(detection, own): &(&Detection, &Own)| {
            let mut there = plain.clone();
            there.go_to(scan.time_s + own.after_s);
            let squared = there.squared_distance(&report(detection), &matrix(&own.noise));
            squared <= gate_threshold(GATE, 2)
        };
        let all = scan.detections.iter().zip(&scan.own).enumerate();
        let inside: Vec<u32> = all
            .filter(|(_, pair)| is_inside(pair))
            .map(|(at, _)| at as u32)
            .collect();
        let mut told: Vec<u32> = candidates
            .iter()
            .filter_map(|candidate| candidate.detection)
            .collect();
        told.sort_unstable();
        assert_eq!(told, inside);
        wanted.push(inside.len());
        plain.mean = DVector::from_column_slice(state.mean.as_slice());
        plain.covariance = DMatrix::from_column_slice(4, 4, state.covariance.as_slice());
    }
    assert!(wanted.iter().sum::<usize>() > 20, "{wanted:?}");
}

fn ais(sigma_course_rad: Option<f64>) -> Sensor {
    sensor(MeasurementModel::Moving(Moving {
        sigmas_m: [15.0, 15.0, 1.0],
        correlation_xy: 0.0,
        is_in_volume: false,
        clutter_span: None,
        velocity: VelocityNoise {
            sigma_speed_mps: 2.0,
            sigma_course_rad,
            area_m2ps2: 900.0,
        },
        tells_velocity: true,
    }))
}

/// Scans of places with velocities; those of every third scan are not told.
fn moving_plots(draw: &mut Draw) -> Vec<Scan> {
    let scans = (0..20).map(|index| {
        let told = [100.0 + 2.0 * draw.normal(), -30.0 + 2.0 * draw.normal()];
        let own = Own {
            velocity_mps: (index % 3 != 1).then_some(told),
            ..Own::default()
        };
        let exact = Own {
            noise: noise(15.0, 15.0, 0.0),
            ..own
        };
        let detection = plot(PERIOD_S * index as f64, &exact, draw);
        scan(index, vec![detection], vec![own])
    });
    scans.collect()
}

#[test]
fn velocities_are_used_where_they_are_told() {
    let scans = moving_plots(&mut Draw::new(7));
    let found = tracked(kalman(1.0), "nearest_neighbour", ais(None), &scans);
    let mut plain = Plain::new(1.0);
    for (scan, (state, candidates)) in scans.iter().zip(&found) {
        assert_eq!(candidates[0].detection, Some(0));
        plain.go_to(scan.time_s);
        let place_m = report(&scan.detections[0]);
        match scan.own[0].velocity_mps {
            Some([east, north]) => {
                let whole = DVector::from_vec(vec![place_m[0], place_m[1], east, north]);
                let noise = DVector::from_vec(vec![225.0, 225.0, 4.0, 4.0]);
                plain.take(&whole, &DMatrix::from_diagonal(&noise));
            }
            None => plain.take(&place_m, &(DMatrix::identity(2, 2) * 225.0)),
        }
        plain.assert_is(state, 1e-6);
    }
}

#[test]
fn a_velocity_that_is_not_told_does_not_change_how_probable_a_plot_is() {
    let mut scans = double_plots(&mut Draw::new(8));
    for scan in &mut scans {
        scan.own
            .iter_mut()
            .for_each(|own| own.noise = OwnNoise::default());
    }
    let found = tracked(kalman(1.0), "jpda", ais(None), &scans);
    let wanted = tracked(kalman(1.0), "jpda", places(15.0), &scans);
    for ((_, found), (_, wanted)) in found.iter().zip(&wanted).take(1) {
        for (found, wanted) in found.iter().zip(wanted) {
            assert_eq!(found.detection, wanted.detection);
            // The gate of four values is wider than that of two, and (1 - P_D P_G) the same.
            assert!(
                (found.probability - wanted.probability).abs() < 1e-6,
                "{found:?} {wanted:?}"
            );
        }
    }
}
