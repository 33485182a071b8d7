//! Bearings from a ship that moves: what they can tell of a range, tracks that begin at several ranges, and jobs over such recordings.

use crate::moving_sensor::standing_bearing;
use nalgebra::{Matrix4, SMatrix, Vector4};
use rand_distr::{Distribution, StandardNormal};
use serde_json::{Value, json};
use std::fmt::Write;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, Input, JobKind, Outcome, RunError, presets};
use trackloom_domain::filtering::imm::RangeParametrised;
use trackloom_domain::filtering::motions::AnyMotion;
use trackloom_domain::filtering::{Filter, Reports, Way};
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::hypotheses::certain;
use trackloom_domain::math::rng::{Purpose, Seed};
use trackloom_domain::model::dataset::Dataset;
use trackloom_domain::model::motion::constant_velocity::ConstantVelocity;
use trackloom_domain::model::scan::{Measurement, Recording};
use trackloom_domain::model::sensing::{Bearing, MeasurementModel, RangePrior, Sensing};
use trackloom_domain::model::state::{GaussianState, Position};
use trackloom_domain::model::track::TrackSet;

const SCANS: usize = 60;
const PERIOD_S: f64 = 20.0;
const SIGMA_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;
const PRIOR: RangePrior = RangePrior {
    min_m: 1000.0,
    max_m: 32_000.0,
    ranges: 5,
};

fn target(time_s: f64) -> Vector4<f64> {
    Vector4::new(4000.0 - 3.0 * time_s, 8000.0 - 2.0 * time_s, -3.0, -2.0)
}

/// East at 5 m/s, then from `turn_s` on north.
fn ship_m(time_s: f64, turn_s: f64) -> Position {
    Position::new(5.0 * time_s.min(turn_s), 5.0 * (time_s - turn_s).max(0.0))
}

fn times_s() -> impl Iterator<Item = f64> {
    (0..SCANS).map(|scan| PERIOD_S * scan as f64)
}

fn sonar(place_m: Position) -> Bearing {
    Bearing {
        range_prior: Some(PRIOR),
        ..standing_bearing(place_m, SIGMA_RAD)
    }
}

/// The state at time 0 as that of `time_s`.
fn transition(time_s: f64) -> Matrix4<f64> {
    let mut transition = Matrix4::identity();
    (transition[(0, 2)], transition[(1, 3)]) = (time_s, time_s);
    transition
}

/// What the bearings say of the state at time 0: Σ Φᵀ Hᵀ R⁻¹ H Φ at the true states.
fn information(turn_s: f64) -> Matrix4<f64> {
    let mut sum = Matrix4::zeros();
    for time_s in times_s() {
        let belief = GaussianState {
            mean: target(time_s),
            covariance: Matrix4::zeros(),
        };
        let slope = sonar(ship_m(time_s, turn_s)).jacobian(&belief) * transition(time_s);
        sum += slope.transpose() * slope / SIGMA_RAD.powi(2);
    }
    sum
}

/// Standard deviation of the range at a time, at best.
fn bound_m(turn_s: f64, time_s: f64) -> f64 {
    let covariance = information(turn_s).try_inverse().unwrap();
    let covariance = transition(time_s) * covariance * transition(time_s).transpose();
    let along = (target(time_s).xy() - ship_m(time_s, turn_s)).normalize();
    (along.transpose() * covariance.fixed_view::<2, 2>(0, 0) * along)[0].sqrt()
}

#[test]
fn one_leg_does_not_tell_the_range_and_two_do() {
    // Places in units of 10 km and velocities in 10 m/s, so that singular values compare.
    let scale = Matrix4::from_diagonal(&Vector4::new(1e4, 1e4, 10.0, 10.0));
    let values = |turn_s: f64| (scale * information(turn_s) * scale).singular_values();
    let (one, two) = (values(1e9), values(600.0));
    assert!(one[3] < 1e-9 * one[0] && one[2] > 1e-4 * one[0], "{one}");
    assert!(two[3] > 1e-5 * two[0], "{two}");
    assert!((bound_m(600.0, 0.0) - 271.823_795_741).abs() < 1e-6);
}

/// A target that 60 bearings are of, started at ranges: its state after the last, and how many ranges are left.
fn followed(run: u32) -> GaussianState {
    let mut draw = Seed { seed: 3, run }.stream(Purpose::Detection, 0, 0);
    let filter = RangeParametrised {
        motion: AnyMotion::ConstantVelocity(ConstantVelocity {
            spectral_density: 0.0,
        }),
        way: Way::Line,
        reports: Reports::All,
    };
    let step = filter.step(PERIOD_S);
    let mut belief = None;
    for time_s in times_s() {
        let sonar = sonar(ship_m(time_s, 600.0));
        let away_m = target(time_s).xy() - sonar.place_m;
        let error: f64 = StandardNormal.sample(&mut draw);
        let bearing_rad = away_m.x.atan2(away_m.y) + SIGMA_RAD * error;
        let Some(belief) = &mut belief else {
            let report = [bearing_rad].into();
            let whole = sonar.locate(&report, 5.0).unwrap();
            belief = Some(filter.begin_among(&whole, &sonar.parts(&report, 5.0)));
            continue;
        };
        RangeParametrised::predict(&step, belief);
        let model = MeasurementModel::Bearing(sonar);
        certain::update(
            &filter,
            &model,
            &Measurement::Bearing { bearing_rad },
            belief,
        )
        .unwrap();
    }
    RangeParametrised::kinematics(&belief.unwrap())
}

#[test]
fn a_track_at_ranges_comes_near_the_bound_and_knows_how_near() {
    const RUNS: u32 = 200;
    let end_s = PERIOD_S * (SCANS - 1) as f64;
    let ship_m = ship_m(end_s, 600.0);
    let range_m = (target(end_s).xy() - ship_m).norm();
    let (mut square, mut nees) = (0.0, 0.0);
    for run in 0..RUNS {
        let state = followed(run);
        let error_m = (state.mean.xy() - ship_m).norm() - range_m;
        square += error_m * error_m / f64::from(RUNS);
        let error = state.mean - target(end_s);
        let inverse = state.covariance.try_inverse().unwrap();
        nees += error.dot(&(inverse * error)) / f64::from(RUNS);
    }
    let bound_m = bound_m(600.0, end_s);
    assert!((bound_m - 205.891).abs() < 1e-3, "{bound_m}");
    // The rms of 200 runs is known to 5 %, the mean of their NEES to 0.2.
    let ratio = square.sqrt() / bound_m;
    assert!((0.85..1.25).contains(&ratio), "{ratio}");
    assert!((3.4..4.8).contains(&nees), "{nees}");
}

#[test]
fn a_belief_is_dropped_when_it_is_wrong_and_written_down_whole() {
    let sonar = sonar(Position::zeros());
    let filter = RangeParametrised {
        motion: AnyMotion::ConstantVelocity(ConstantVelocity {
            spectral_density: 0.0,
        }),
        way: Way::Line,
        reports: Reports::All,
    };
    let report = [0.3].into();
    let whole = sonar.locate(&report, 5.0).unwrap();
    let mut belief = filter.begin_among(&whole, &sonar.parts(&report, 5.0));
    let count = |probabilities: &[f64]| probabilities.iter().filter(|p| **p > 0.0).count();
    assert_eq!(count(&belief.probabilities), 5);
    let told = RangeParametrised::kinematics(&belief);
    assert!((told.mean - whole.mean).norm() < 1e-6);
    assert!((told.covariance - whole.covariance).norm() < 1e-9 * whole.covariance.norm());
    // A radar says that it is 6 km away, give or take 100 m: 3 km ± 577 m are wrong, 12 km ± 2309 m hardly right.
    let at = Measurement::Position {
        x_m: 6000.0 * 0.3f64.sin(),
        y_m: 6000.0 * 0.3f64.cos(),
    };
    let radar = MeasurementModel::Position {
        sigma_x_m: 100.0,
        sigma_y_m: 100.0,
    };
    certain::update(&filter, &radar, &at, &mut belief).unwrap();
    assert_eq!(count(&belief.probabilities), 2);
    assert!(belief.probabilities[2] > 0.95, "{:?}", belief.probabilities);
    let told = RangeParametrised::kinematics(&belief);
    assert!((told.mean.xy().norm() - 6000.0).abs() < 30.0, "{told:?}");
    let mut packed = Vec::new();
    RangeParametrised::pack(&belief, &mut packed);
    assert_eq!(RangeParametrised::unpack(&packed), Some(belief));
    assert_eq!(RangeParametrised::unpack(&packed[1..]), None);
}

fn done(kind: JobKind, request: &Value, csv: Option<&str>) -> Result<Outcome, RunError> {
    let plan = experiment::plan(kind, request).unwrap_or_else(|faults| panic!("{faults:?}"));
    let inputs = plan.inputs.iter().map(|input| {
        let csv = csv.filter(|_| !input.optional)?;
        Some(Input {
            dataset: Dataset::Detections(recording(csv)),
            sensors: Vec::new(),
            sha256: String::new(),
        })
    });
    experiment::run(&plan, inputs.collect(), &mut Silent)
}

fn recording(csv: &str) -> Recording {
    let read = format_named("csv").unwrap().read;
    match read(&mut csv.as_bytes(), &ReadOptions::default()) {
        Ok(outcome) => match outcome.dataset {
            Dataset::Detections(recording) => recording,
            _ => panic!("no detections"),
        },
        Err(faults) => panic!("{faults:?}"),
    }
}

fn tracks_of(outcome: &Outcome) -> TrackSet {
    tracks_in(outcome, "tracks.csv")
}

fn tracks_in(outcome: &Outcome, name: &str) -> TrackSet {
    let file = outcome.artifacts.iter().find(|file| file.name == name);
    let read = format_named("csv").unwrap().read;
    match read(&mut file.unwrap().bytes.as_slice(), &ReadOptions::default())
        .unwrap()
        .dataset
    {
        Dataset::Tracks(set) => set,
        _ => panic!("no tracks"),
    }
}

fn preset() -> Value {
    presets::find("own-ship-bearings").unwrap().body
}

#[test]
fn the_preset_ends_within_its_own_standard_deviations() {
    let outcome = done(JobKind::Evaluate, &preset(), None).unwrap();
    let warned = |word: &str| {
        outcome
            .warnings
            .iter()
            .any(|warning| warning.contains(word))
    };
    assert!(!warned("do not tell how far"), "{:?}", outcome.warnings);
    let tracks = tracks_of(&outcome);
    assert_eq!(tracks.tracks.len(), 1);
    let points = &tracks.tracks[0].points;
    assert_eq!(points.len(), SCANS);
    let error_m = |index: usize| {
        let point = &points[index];
        (point.estimate.position.xy() - target(point.time_s).xy()).norm()
    };
    // The middle of all ranges at first, and a few hundred metres at the end.
    assert!(
        error_m(0) > 300.0 && error_m(SCANS - 1) < 700.0,
        "{}",
        error_m(SCANS - 1)
    );
    let nees = &outcome.result["metrics"]["kinematics"];
    assert!(nees.is_object(), "{nees}");
}

#[test]
fn later_bearings_tell_how_far_the_target_was_at_first() {
    let mut request = preset();
    request["tracker"]["smoothing"] = json!({"method": "fixed_interval"});
    let outcome = done(JobKind::Evaluate, &request, None).unwrap();
    let smoothed = tracks_in(&outcome, "smoothed_tracks.csv");
    let first = &smoothed.tracks[0].points[0];
    let error_m = (first.estimate.position.xy() - target(0.0).xy()).norm();
    // At best 272 m along the bearing.
    assert!(error_m < 4.0 * bound_m(600.0, 0.0), "{error_m}");
    let last = smoothed.tracks[0].points.last().unwrap();
    let filtered = tracks_of(&outcome);
    assert_eq!(
        last.estimate,
        filtered.tracks[0].points.last().unwrap().estimate
    );
}

#[test]
fn a_ship_that_never_turns_is_told_that_ranges_stay_open() {
    let mut request = preset();
    request["input"]["scenario"]["sensors"][0]["course"]["segments"] = json!([]);
    let outcome = done(JobKind::Evaluate, &request, None).unwrap();
    let warned = |word: &str| {
        outcome
            .warnings
            .iter()
            .any(|warning| warning.contains(word))
    };
    assert!(warned("do not tell how far"), "{:?}", outcome.warnings);
    // A second sensor at another place tells it.
    request["input"]["scenario"]["sensors"]
        .as_array_mut()
        .unwrap()
        .push(json!({"sensor_id": "radar", "x_m": 0.0, "y_m": 0.0, "max_range_m": 40_000.0, "p_d": 1.0,
            "sigma_range_m": 50.0, "sigma_bearing_deg": 0.5}));
    let outcome = done(JobKind::Evaluate, &request, None).unwrap();
    let warned = |word: &str| {
        outcome
            .warnings
            .iter()
            .any(|warning| warning.contains(word))
    };
    assert!(!warned("do not tell how far"), "{:?}", outcome.warnings);
}

/// The bearings of a ship that turns, as a file; from the bow where `is_relative`.
fn file(is_relative: bool) -> String {
    let mut csv =
        "time_s,scan,sensor_id,detection_id,bearing_deg,sensor_x_m,sensor_y_m,sensor_heading_deg\n"
            .to_owned();
    for (scan, time_s) in times_s().enumerate() {
        let ship_m = ship_m(time_s, 600.0);
        let away_m = target(time_s).xy() - ship_m;
        let bearing_deg = away_m.x.atan2(away_m.y).to_degrees();
        let heading_deg = if time_s <= 600.0 { 90.0 } else { 0.0 };
        let told_deg = if is_relative {
            bearing_deg - heading_deg
        } else {
            bearing_deg
        };
        writeln!(
            csv,
            "{time_s},{},sonar,a,{told_deg},{},{},{heading_deg}",
            scan + 1,
            ship_m.x,
            ship_m.y
        )
        .unwrap();
    }
    csv
}

fn request(sensor: &Value) -> Value {
    let mut sensor = sensor.clone();
    for (name, value) in [
        ("sensor_id", json!("sonar")),
        ("sigma_bearing_deg", json!(0.5)),
        ("p_d", json!(0.99)),
        ("clutter_per_deg", json!(1e-6)),
    ] {
        sensor[name] = value;
    }
    json!({
        "input": {"source": "dataset", "dataset_id": "0198c0de-0000-7000-8000-000000000000"},
        "sensors": [sensor],
        "associator": {"method": "global_nearest_neighbour"},
        "filter": {"method": "extended", "process_noise_m2ps3": 0.0},
        "tracker": {"confirm_hits": 1, "confirm_window": 1, "initial_speed_sigma_mps": 5.0}
    })
}

#[test]
fn bearings_from_the_bow_are_turned_by_the_heading() {
    let at_ranges = json!({"range_min_m": 1000.0, "range_max_m": 32_000.0});
    let mut relative = at_ranges.clone();
    relative["bearings"] = json!("relative");
    let straight = done(JobKind::Associate, &request(&at_ranges), Some(&file(false))).unwrap();
    let turned = done(JobKind::Associate, &request(&relative), Some(&file(true))).unwrap();
    let (straight, turned) = (tracks_of(&straight), tracks_of(&turned));
    assert_eq!((straight.tracks.len(), turned.tracks.len()), (1, 1));
    let points = straight.tracks[0]
        .points
        .iter()
        .zip(&turned.tracks[0].points);
    for (one, other) in points {
        let apart_m = (one.estimate.position - other.estimate.position).norm();
        assert!(apart_m < 1e-3, "{}: {apart_m}", one.time_s);
    }
    let last = straight.tracks[0].points.last().unwrap();
    let error_m = (last.estimate.position.xy() - target(last.time_s).xy()).norm();
    assert!(error_m < 100.0, "{error_m}");
}

fn faults(request: &Value, csv: &str) -> Vec<trackloom_domain::model::fault::Fault> {
    match done(JobKind::Associate, request, Some(csv)) {
        Err(RunError::Faults(faults)) => faults,
        Err(error) => panic!("{error:?}"),
        Ok(_) => Vec::new(),
    }
}

#[test]
fn what_cannot_start_is_refused_in_one_fault() {
    let headless: String = file(false)
        .lines()
        .map(|line| format!("{}\n", line.rsplit_once(',').unwrap().0))
        .collect();
    let cases = [
        (json!({}), "bearings without ranges"),
        (json!({"may_start": true}), "bearings without ranges"),
        (json!({"range_min_m": 1000.0}), "bearings without ranges"),
        (
            json!({"range_min_m": 1000.0, "range_max_m": 500.0}),
            "is not below range_max_m",
        ),
        (
            json!({"range_min_m": 1000.0, "range_max_m": 9000.0, "bearings": "relative"}),
            "60 of its 60 scans have no heading",
        ),
    ];
    for (sensor, wanted) in cases {
        let found = faults(&request(&sensor), &headless);
        assert_eq!(found.len(), 1, "{sensor}: {found:?}");
        assert!(found[0].detail.contains(wanted), "{sensor}: {found:?}");
    }
    let mut several = request(&json!({"range_min_m": 1000.0, "range_max_m": 9000.0}));
    several["filter"] = json!({"method": "imm"});
    let found = faults(&several, &headless);
    assert!(found[0].detail.contains("several ranges"), "{found:?}");
}

/// Where cameras stand, and what they see of boats: each once a second, one after another where they take turns.
struct Cameras {
    places_m: Vec<f64>,
    boats: u32,
    take_turns: bool,
}

fn boat_m(boat: u32, time_s: f64) -> Position {
    Position::new(500.0 + 1500.0 * f64::from(boat), 2000.0) + Position::new(4.0, -2.0) * time_s
}

impl Cameras {
    fn file(&self) -> String {
        let mut csv = "time_s,scan,sensor_id,detection_id,bearing_deg\n".to_owned();
        for scan in 0..20 {
            for (camera, place_m) in self.places_m.iter().enumerate() {
                let late_s = if self.take_turns { 0.3 } else { 0.0 };
                let time_s = f64::from(scan) + late_s * camera as f64;
                for boat in 0..self.boats {
                    let boat_m = boat_m(boat, time_s);
                    let bearing_deg = (boat_m.x - place_m).atan2(boat_m.y).to_degrees();
                    writeln!(csv, "{time_s},{},{camera},{boat},{bearing_deg}", scan + 1).unwrap();
                }
            }
        }
        csv
    }

    fn request(&self, may_start: &[bool]) -> Value {
        let camera = |(camera, may_start): (usize, &bool)| {
            json!({"sensor_id": camera.to_string(), "x_m": self.places_m[camera], "y_m": 0.0, "sigma_bearing_deg": 0.2,
                "p_d": 0.95, "clutter_per_deg": 1e-4, "may_start": may_start})
        };
        let cameras: Vec<Value> = may_start.iter().enumerate().map(camera).collect();
        json!({
            "input": {"source": "dataset", "dataset_id": "0198c0de-0000-7000-8000-000000000000"},
            "sensors": cameras,
            "associator": {"method": "global_nearest_neighbour"},
            "filter": {"method": "unscented", "process_noise_m2ps3": 0.01},
            "tracker": {"confirm_hits": 8, "confirm_window": 10, "max_missed": 2, "initial_speed_sigma_mps": 5.0}
        })
    }
}

#[test]
fn tracks_begin_where_bearings_of_two_cameras_cross() {
    for (places_m, boats, take_turns) in [
        (vec![0.0, 3000.0], 1, false),
        (vec![0.0, 3000.0], 1, true),
        (vec![0.0, 3000.0, -1400.0], 2, true),
    ] {
        let cameras = Cameras {
            places_m,
            boats,
            take_turns,
        };
        let may_start = vec![true; cameras.places_m.len()];
        let request = cameras.request(&may_start);
        let outcome = done(JobKind::Associate, &request, Some(&cameras.file())).unwrap();
        let tracks = tracks_of(&outcome);
        let mut found = vec![0; boats as usize];
        for track in &tracks.tracks {
            let last = track.points.last().unwrap();
            for boat in 0..boats {
                let error_m = last.estimate.position.xy() - boat_m(boat, last.time_s);
                found[boat as usize] += usize::from(error_m.norm() < 15.0);
            }
        }
        assert_eq!(found, vec![1; boats as usize], "{take_turns} {boats}");
        assert_eq!(tracks.tracks.len(), boats as usize, "{take_turns} {boats}");
    }
    let cameras = Cameras {
        places_m: vec![0.0, 3000.0],
        boats: 1,
        take_turns: false,
    };
    let found = faults(&cameras.request(&[true, false]), &cameras.file());
    assert!(
        found[0].detail.contains("bearings without ranges"),
        "{found:?}"
    );
}

/// A pose of a scan moves the state as updates from its place do, with H P Hᵀ more noise.
#[test]
fn an_uncertain_pose_counts_as_noise() {
    use trackloom_domain::model::pose::{Attitude, Pose};
    use trackloom_domain::model::sensing::{Platform, Polar, RangeRate};
    let mut pose = Pose::at([100.0, -50.0, 0.0].into());
    pose.velocity = [3.0, 8.0, 0.0].into();
    pose.attitude = Some(Attitude::default());
    (pose.sigmas.place, pose.sigmas.velocity) = ([4.0, 2.0, 0.0].into(), [0.3, 0.2, 0.0].into());
    pose.sigmas.heading_rad = 0.01;
    let polar = |pose: &Pose| {
        let standing = MeasurementModel::Polar(Polar {
            place_m: Position::zeros(),
            sigma_range_m: 5.0,
            sigma_bearing_rad: 0.02,
            range_rate: Some(RangeRate {
                sigma_mps: 0.5,
                span_mps: 40.0,
            }),
            platform: Platform::STANDING,
        });
        match standing.seen_from(pose) {
            MeasurementModel::Polar(polar) => polar,
            other => panic!("{other:?}"),
        }
    };
    let belief = GaussianState {
        mean: Vector4::new(900.0, 650.0, -4.0, 6.0),
        covariance: Matrix4::zeros(),
    };
    let stated = Sensing::<4, 3>::noise(&polar(&pose), &belief);
    let at = Sensing::<4, 3>::project(&polar(&pose), &belief.mean);
    // By hand: Δ (800, 700), relative velocity (−7, −2).
    let range_m = 800f64.hypot(700.0);
    assert!((at[0] - range_m).abs() < 1e-9 && (at[1] - 800f64.atan2(700.0)).abs() < 1e-12);
    assert!((at[2] - (-7.0 * 800.0 - 2.0 * 700.0) / range_m).abs() < 1e-9);
    let mut draw = Seed { seed: 8, run: 0 }.stream(Purpose::Detection, 0, 0);
    let count = 200_000;
    let mut square = SMatrix::<f64, 3, 3>::zeros();
    for _ in 0..count {
        let errors: [f64; 8] = std::array::from_fn(|_| StandardNormal.sample(&mut draw));
        let mut true_pose = pose;
        true_pose.place.x += 4.0 * errors[0];
        true_pose.place.y += 2.0 * errors[1];
        true_pose.velocity.x += 0.3 * errors[2];
        true_pose.velocity.y += 0.2 * errors[3];
        let mut error = Sensing::<4, 3>::project(&polar(&true_pose), &belief.mean) - at;
        error[0] += 5.0 * errors[4];
        error[1] += 0.02 * errors[5] + 0.01 * errors[6];
        error[2] += 0.5 * errors[7];
        square += error * error.transpose() / f64::from(count);
    }
    for row in 0..3 {
        for column in 0..3 {
            let scale = (stated[(row, row)] * stated[(column, column)]).sqrt();
            let apart = (square[(row, column)] - stated[(row, column)]) / scale;
            // Known to 0.3 % of 200 000 draws.
            assert!(apart.abs() < 0.015, "{row} {column}: {square} {stated}");
        }
    }
}
