//! Recordings of bearings alone through the front door: read, tracked by every associator, judged, refused where a filter
//! cannot use them.

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use serde_json::{Value, json};
use std::fmt::Write;
use trackloom_domain::association::ASSOCIATORS;
use trackloom_domain::experiment;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::formats::{self, ReadOptions};
use trackloom_domain::math::rng::{Purpose, Seed};
use trackloom_domain::model::angle::wrap;
use trackloom_domain::model::dataset::Dataset;
use trackloom_domain::model::fault::Fault;
use trackloom_domain::model::track::{Kinematics, Track, TrackSet, TrackStatus};

const SIGMA_DEG: f64 = 0.5;
const SCANS: u32 = 41;

/// A target: its first bearing and its rate, in degrees and degrees a second.
type Course = (f64, f64);

const CROSSING: [Course; 2] = [(250.0, 0.75), (280.0, -0.75)];
const OVER_NORTH: [Course; 1] = [(359.5, 0.025)];

/// One scan a second: every target is seen but in every eleventh scan, and `clutter` false detections lie anywhere.
fn recording(courses: &[Course], clutter: usize, seed: u32) -> String {
    let mut draw = Seed { seed, run: 0 }.stream(Purpose::Detection, 0, 0);
    let mut csv =
        String::from("time_s,scan,sensor_id,detection_id,bearing_deg,amplitude,truth_id\n");
    for scan in 0..SCANS {
        for (target, (first_deg, rate_degps)) in courses.iter().enumerate() {
            let error: f64 = StandardNormal.sample(&mut draw);
            let bearing_deg =
                (first_deg + rate_degps * f64::from(scan) + SIGMA_DEG * error).rem_euclid(360.0);
            if scan % 11 != 5 + target as u32 {
                writeln!(
                    csv,
                    "{scan},{},sonar,{scan}-t{target},{bearing_deg},9,{target}",
                    scan + 1
                )
                .unwrap();
            }
        }
        for index in 0..clutter {
            writeln!(
                csv,
                "{scan},{},sonar,{scan}-c{index},{},{},",
                scan + 1,
                360.0 * draw.random::<f64>(),
                8.0 * draw.random::<f64>()
            )
            .unwrap();
        }
    }
    csv
}

fn read(csv: &str) -> Dataset {
    let format = formats::format_named("csv").unwrap();
    (format.read)(&mut csv.as_bytes(), &ReadOptions::default())
        .unwrap()
        .dataset
}

/// A job on a recording, with what `settings` say otherwise.
fn run_job(
    kind: experiment::JobKind,
    csv: &str,
    settings: &Value,
) -> Result<experiment::Outcome, experiment::RunError> {
    let mut body = json!({
        "input": {"source": "dataset", "dataset_id": "0198c0de-0000-7000-8000-000000000000"},
        "filter": {"method": "bearing_only", "process_noise_deg2ps3": 1e-5, "initial_rate_sigma_degps": 1.0},
        "sensors": [{"sensor_id": "sonar", "p_d": 0.9, "clutter_per_deg": 0.01, "sigma_bearing_deg": SIGMA_DEG}],
        "tracker": {"gate_probability": 0.999, "confirm_hits": 5, "confirm_window": 7}
    });
    for (name, value) in settings.as_object().unwrap() {
        body[name] = value.clone();
    }
    let plan = experiment::plan(kind, &body).unwrap_or_else(|faults| panic!("{faults:?}"));
    let input = experiment::Input {
        dataset: read(csv),
        sensors: vec![],
        sha256: String::new(),
    };
    experiment::run(
        &plan,
        plan.inputs
            .iter()
            .map(|input_of| (!input_of.optional).then(|| input.clone()))
            .collect(),
        &mut Silent,
    )
}

/// The tracks as they are written and read back, and the report.
fn tracked(csv: &str, settings: &Value) -> (TrackSet, Value) {
    let outcome = run_job(experiment::JobKind::Associate, csv, settings)
        .unwrap_or_else(|error| panic!("{error:?}"));
    let tracks = outcome
        .artifacts
        .iter()
        .find(|artifact| artifact.name == "tracks.csv")
        .unwrap();
    let Dataset::Tracks(set) = read(std::str::from_utf8(&tracks.bytes).unwrap()) else {
        panic!("no tracks")
    };
    (set, outcome.result)
}

fn bearing(track: &Track, point: usize) -> &Kinematics {
    &track.points[point].estimate
}

/// Degrees by which a track is off a course at one of its points.
fn error_deg(track: &Track, point: usize, (first_deg, rate_degps): Course) -> f64 {
    let truth_rad = (first_deg + rate_degps * track.points[point].time_s).to_radians();
    wrap(bearing(track, point).position.x - truth_rad).to_degrees()
}

/// The tracks of at least half of the scans; everything shorter is clutter's.
fn long_tracks(set: &TrackSet) -> Vec<&Track> {
    set.tracks
        .iter()
        .filter(|track| track.points.len() > SCANS as usize / 2)
        .collect()
}

/// Scans after which a track knows its rate.
const SETTLED: usize = 10;

/// One track follows the course from its first scan to its last: settled, it is at most two sigma of a single report off, and
/// less than half of one at the end.
fn assert_followed(name: &str, tracks: &[&Track], course: Course) {
    let follows = |track: &&&Track| {
        (SETTLED..track.points.len())
            .all(|point| error_deg(track, point, course).abs() < 2.0 * SIGMA_DEG)
    };
    let found: Vec<_> = tracks.iter().filter(follows).collect();
    assert_eq!(
        found.len(),
        1,
        "{name}: one track follows the course from {} degrees",
        course.0
    );
    let track = found[0];
    assert_eq!(
        (track.points[0].time_s, track.points.len()),
        (0.0, SCANS as usize),
        "{name}: no break"
    );
    let last = track.points.len() - 1;
    let (off_deg, estimate) = (error_deg(track, last, course), bearing(track, last));
    let covariance = estimate
        .covariance::<2>()
        .unwrap()
        .map(|variance| variance * 1f64.to_degrees().powi(2));
    assert!(
        off_deg.abs() < 0.5 * SIGMA_DEG && off_deg.abs() < 4.0 * covariance[(0, 0)].sqrt(),
        "{name}: {off_deg} degrees off at the end"
    );
    let rate_off = estimate.velocity.unwrap().x.to_degrees() - course.1;
    assert!(
        rate_off.abs() < 4.0 * covariance[(1, 1)].sqrt() && rate_off.abs() < 0.05,
        "{name}: the rate is {rate_off} off"
    );
}

#[test]
fn two_targets_that_cross_in_bearing_stay_two_tracks_under_every_associator() {
    let csv = recording(&CROSSING, 2, 1);
    for method in ASSOCIATORS {
        let (set, result) = tracked(&csv, &json!({"associator": {"method": method.name}}));
        let tracks = long_tracks(&set);
        assert_eq!(tracks.len(), 2, "{}", method.name);
        CROSSING
            .iter()
            .for_each(|&course| assert_followed(method.name, &tracks, course));
        let nis = &result["association"]["nis"];
        assert_eq!(nis["dimensions"], 1);
        let mean = nis["mean"].as_f64().unwrap();
        assert!(
            (0.6..1.6).contains(&mean),
            "{}: mean NIS {mean}",
            method.name
        );
    }
}

#[test]
fn a_target_that_crosses_north_is_one_track_under_every_associator() {
    let csv = recording(&OVER_NORTH, 2, 2);
    for method in ASSOCIATORS {
        let (set, _) = tracked(&csv, &json!({"associator": {"method": method.name}}));
        let tracks = long_tracks(&set);
        assert_eq!(tracks.len(), 1, "{}", method.name);
        assert_followed(method.name, &tracks, OVER_NORTH[0]);
        let bearings = || {
            (0..tracks[0].points.len())
                .map(|point| bearing(tracks[0], point).position.x.to_degrees())
        };
        assert!(
            bearings().all(|degrees| (0.0..360.0).contains(&degrees)),
            "{}",
            method.name
        );
        assert!(
            bearings().any(|degrees| degrees > 359.0) && bearings().any(|degrees| degrees < 1.0),
            "{}: both sides",
            method.name
        );
        let ended = tracks[0]
            .points
            .iter()
            .filter(|point| point.status == Some(TrackStatus::Coasted))
            .count();
        assert!(
            ended <= 4,
            "{}: only the scans without a detection are coasted: {ended}",
            method.name
        );
    }
}

#[test]
fn the_automaton_judges_bearings_by_detection_id() {
    let csv = recording(&CROSSING, 0, 3);
    let settings = json!({"associator": {"method": "oracle"}, "tracker": {"confirm_hits": 1, "confirm_window": 1}});
    let tfa = run_job(experiment::JobKind::Evaluate, &csv, &settings)
        .unwrap()
        .result["tfa"]
        .clone();
    let counts = &tfa["counts"];
    assert_eq!(
        [
            &counts["targets"],
            &counts["correct"],
            &counts["missed"],
            &counts["false"]
        ],
        [2, 2, 0, 0].map(|count| json!(count)).each_ref()
    );
    let clutter = recording(&CROSSING, 2, 3);
    let tfa = run_job(
        experiment::JobKind::Evaluate,
        &clutter,
        &json!({"associator": {"method": "jpda"}}),
    )
    .unwrap()
    .result["tfa"]
        .clone();
    assert_eq!(tfa["counts"]["targets"], 2);
}

#[test]
fn metrics_in_metres_are_refused_to_directions_or_left_out_with_a_warning() {
    let dataset =
        json!({"source": "dataset", "dataset_id": "0198c0de-0000-7000-8000-000000000000"});
    let asked = json!({"input": dataset, "truth": dataset, "filter": {"method": "bearing_only"}, "metrics": [{"metric": "siap"}]});
    let faults = experiment::plan(experiment::JobKind::Evaluate, &asked).unwrap_err();
    assert_eq!(
        (
            faults.len(),
            faults[0].pointer.as_str(),
            faults[0].code.as_str()
        ),
        (1, "/metrics", "unsupported")
    );

    // Tracks of a file are known to be directions only when they are read.
    let judged = json!({"tracks": dataset, "truth": dataset, "detections": dataset, "metrics": [{"metric": "siap"}]});
    let plan = experiment::plan(experiment::JobKind::Evaluate, &judged).unwrap();
    let tracks = "time_s,track_id,bearing_deg,detection_id\n0,1,359.5,0-t0\n1,1,359.5,1-t0\n";
    let of = |pointer: &str| match pointer {
        "/tracks" => read(tracks),
        "/truth" => read("time_s,truth_id,bearing_deg\n0,0,359.5\n40,0,0.5\n"),
        _ => read(&recording(&OVER_NORTH, 0, 1)),
    };
    let inputs = plan.inputs.iter().map(|wanted| {
        Some(experiment::Input {
            dataset: of(&wanted.pointer),
            sensors: vec![],
            sha256: String::new(),
        })
    });
    let outcome = experiment::run(&plan, inputs.collect(), &mut Silent).unwrap();
    assert_eq!(outcome.result["tfa"]["counts"]["targets"], 1);
    assert_eq!(
        outcome.result["metrics"],
        Value::Null,
        "SIAP alone was asked for"
    );
    assert_eq!(
        outcome.warnings,
        ["directions (bearing_deg) are not compared in metres, so no metric was computed"]
    );
}

fn faults_of(kind: experiment::JobKind, csv: &str, settings: &Value) -> Vec<Fault> {
    match run_job(kind, csv, settings) {
        Err(experiment::RunError::Faults(faults)) => faults,
        other => panic!("not refused: {other:?}"),
    }
}

#[test]
fn what_a_filter_cannot_use_is_refused_by_name() {
    let bearings = recording(&OVER_NORTH, 0, 1);
    for (filter, usable) in [
        ("kalman", "positions (x_m, y_m)"),
        (
            "extended",
            "positions (x_m, y_m); ranges and bearings (range_m, bearing_deg)",
        ),
        (
            "unscented",
            "positions (x_m, y_m); ranges and bearings (range_m, bearing_deg)",
        ),
        (
            "converted",
            "positions (x_m, y_m); ranges and bearings (range_m, bearing_deg)",
        ),
    ] {
        let faults = faults_of(
            experiment::JobKind::Associate,
            &bearings,
            &json!({"filter": {"method": filter}}),
        );
        assert_eq!(faults.len(), 1, "{filter}");
        assert_eq!(
            faults[0].detail,
            format!(
                "sensor 'sonar' reports bearings without ranges, which the filter '{filter}' cannot use"
            )
        );
        assert_eq!(
            (faults[0].pointer.as_str(), faults[0].allowed.as_deref()),
            ("/filter/method", Some(usable))
        );
    }
    let positions = "time_s,scan,sensor_id,detection_id,x_m,y_m\n0,1,sonar,a,1,2\n";
    let faults = faults_of(experiment::JobKind::Associate, positions, &json!({}));
    assert_eq!(
        faults[0].detail,
        "sensor 'sonar' reports positions, which the filter 'bearing_only' cannot use"
    );
    assert_eq!(
        faults[0].allowed.as_deref(),
        Some("bearings (bearing_deg), with or without ranges (range_m)")
    );
}

#[test]
fn the_nearest_truth_of_a_direction_is_refused() {
    let csv = recording(&OVER_NORTH, 0, 1);
    let dataset =
        json!({"source": "dataset", "dataset_id": "0198c0de-0000-7000-8000-000000000000"});
    let truth = read("time_s,truth_id,bearing_deg\n0,0,359.5\n40,0,0.5\n");
    let body = json!({
        "input": dataset, "truth": dataset,
        "filter": {"method": "bearing_only"},
        "sensors": [{"sensor_id": "sonar", "sigma_bearing_deg": 0.5}],
        "tfa": {"symbols": {"kind": "nearest_truth", "gate_m": 5.0}}
    });
    let plan = experiment::plan(experiment::JobKind::Evaluate, &body).unwrap();
    let input = |dataset| {
        Some(experiment::Input {
            dataset,
            sensors: vec![],
            sha256: String::new(),
        })
    };
    let inputs = plan
        .inputs
        .iter()
        .map(|wanted| {
            input(if wanted.pointer == "/truth" {
                truth.clone()
            } else {
                read(&csv)
            })
        })
        .collect();
    let Err(experiment::RunError::Faults(faults)) = experiment::run(&plan, inputs, &mut Silent)
    else {
        panic!("not refused")
    };
    let seen: Vec<_> = faults
        .iter()
        .map(|fault| (fault.pointer.as_str(), fault.allowed.as_deref()))
        .collect();
    assert_eq!(seen, [("/tfa/symbols", Some("detection_id")); 2]);
    assert!(
        faults[0]
            .detail
            .starts_with("the tracks are directions (bearing_deg)")
            && faults[1].detail.starts_with("the truth")
    );
    let settings = json!({"tfa": {"symbols": {"kind": "nearest_detection", "gate_m": 5.0}}});
    let faults = faults_of(experiment::JobKind::Evaluate, &csv, &settings);
    assert_eq!(
        (faults.len(), faults[0].pointer.as_str()),
        (1, "/tfa/symbols")
    );
}

/// A ship that passes a sonar north of it, and another one south of it.
fn sonar_scene(p_d: f64, clutter_per_scan: f64) -> Value {
    json!({"source": "scenario", "scenario": {
        "scans": 61, "scan_period_s": 10.0,
        "sensors": [{"sensor_id": "sonar", "max_range_m": 20000.0, "p_d": p_d, "sigma_bearing_deg": 0.5, "clutter_per_scan": clutter_per_scan}],
        "targets": {"kind": "listed", "targets": [
            {"truth_id": "north", "x_m": -1500.0, "y_m": 8000.0, "vx_mps": 5.0},
            {"truth_id": "south", "x_m": 1500.0, "y_m": -8000.0, "vx_mps": -5.0}
        ]}
    }})
}

#[test]
fn a_simulated_sonar_reports_bearings_alone_with_clutter_all_round() {
    let body = json!({"scenario": sonar_scene(1.0, 6.0)["scenario"]});
    let plan = experiment::plan(experiment::JobKind::Simulate, &body).unwrap();
    let outcome = experiment::run(&plan, vec![], &mut Silent).unwrap();
    let settings = &outcome.result["sensors"][0];
    assert_eq!(settings["clutter_per_m2"], Value::Null);
    assert!((settings["clutter_per_deg"].as_f64().unwrap() - 6.0 / 360.0).abs() < 1e-15);
    let csv = outcome
        .artifacts
        .iter()
        .find(|artifact| artifact.name == "detections.csv")
        .unwrap();
    assert!(
        csv.bytes
            .starts_with(b"time_s,scan,sensor_id,detection_id,bearing_deg,truth_id\n")
    );
    let text = std::str::from_utf8(&csv.bytes).unwrap();
    let rows: Vec<Vec<&str>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect())
        .collect();
    let bearings = |truth_id: &str| -> Vec<f64> {
        rows.iter()
            .filter(|row| row[5] == truth_id)
            .map(|row| row[4].parse().unwrap())
            .collect()
    };
    assert_eq!(bearings("north").len(), 61);
    let off = |degrees: f64, scan: usize| {
        wrap(degrees.to_radians() - (-1500.0 + 50.0 * scan as f64).atan2(8000.0)).to_degrees()
    };
    let mean_square = bearings("north")
        .iter()
        .enumerate()
        .map(|(scan, &degrees)| off(degrees, scan).powi(2))
        .sum::<f64>()
        / 61.0;
    assert!(
        (0.15..0.4).contains(&mean_square),
        "sigma² = 0.25: {mean_square}"
    );
    let clutter = bearings("");
    assert!(
        (300..430).contains(&clutter.len()),
        "366 expected: {}",
        clutter.len()
    );
    for quarter in 0..4 {
        let inside = clutter
            .iter()
            .filter(|degrees| (**degrees / 90.0) as usize == quarter)
            .count();
        assert!(
            (60..125).contains(&inside),
            "quarter {quarter}: {inside} of {}",
            clutter.len()
        );
    }
}

#[test]
fn a_sonar_scenario_is_tracked_and_judged_at_once() {
    let body = json!({
        "input": sonar_scene(1.0, 0.0),
        "filter": {"method": "bearing_only", "process_noise_deg2ps3": 1e-7, "initial_rate_sigma_degps": 0.1},
        "tracker": {"gate_probability": 0.9999}
    });
    let plan = experiment::plan(experiment::JobKind::Evaluate, &body).unwrap();
    let outcome = experiment::run(&plan, vec![], &mut Silent).unwrap();
    let counts = &outcome.result["tfa"]["counts"];
    assert_eq!(
        [&counts["targets"], &counts["correct"]],
        [&json!(2), &json!(2)],
        "{counts}"
    );
    assert_eq!(
        outcome.result["association"]["counts"]["started_tracks"], 2,
        "one crosses north, one south: no break"
    );
    assert_eq!(outcome.result["association"]["nis"]["dimensions"], 1);
}
