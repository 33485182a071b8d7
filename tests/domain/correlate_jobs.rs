//! Jobs that put tracks together, from the request to the report and its files: what is found, and what is refused.

use serde_json::{Value, json};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, Input, JobKind, Outcome, plan, presets};
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::model::fault::Fault;

const ID: &str = "0198c0de-0000-7000-8000-000000000000";

fn read(csv: &str) -> Option<Input> {
    let read =
        (format_named("csv").unwrap().read)(&mut csv.as_bytes(), &ReadOptions::default()).unwrap();
    Some(Input {
        dataset: read.dataset,
        sensors: Vec::new(),
        sha256: String::new(),
    })
}

fn done(body: &Value, inputs: Vec<Option<Input>>) -> Outcome {
    let plan = plan(JobKind::Correlate, body).unwrap_or_else(|faults| panic!("{faults:?}"));
    experiment::run(&plan, inputs, &mut Silent).unwrap()
}

/// The faults of a request, or those that the job finds in its data.
fn refused(body: &Value, inputs: Vec<Option<Input>>) -> Vec<Fault> {
    let plan = match plan(JobKind::Correlate, body) {
        Err(faults) => return faults,
        Ok(plan) => plan,
    };
    match experiment::run(&plan, inputs, &mut Silent) {
        Err(experiment::RunError::Faults(faults)) => faults,
        other => panic!("{body} is accepted: {other:?}"),
    }
}

fn told(faults: &[Fault]) -> Vec<(&str, &str)> {
    faults
        .iter()
        .map(|fault| (fault.pointer.as_str(), fault.code.as_str()))
        .collect()
}

fn number(result: &Value, pointer: &str) -> f64 {
    result
        .pointer(pointer)
        .and_then(Value::as_f64)
        .unwrap_or_else(|| panic!("{pointer} is no number: {result}"))
}

/// Drawn tracks with these settings, put together by `genetic`.
fn drawn(tracks: Value) -> Value {
    json!({"seed": 3, "input": {"source": "local_tracks", "tracks": tracks}, "correlator": {"method": "genetic"}})
}

/// Two sets of uploaded tracks.
fn sets() -> Value {
    let set = json!({"source": "dataset", "dataset_id": ID});
    json!({"sets": [set, set], "correlator": {"method": "nearest"}})
}

const HEAD: &str = "time_s,track_id,sensor_id,x_m,y_m,vx_mps,vy_mps,p_xx,p_xy,p_xvx,p_xvy,p_yy,p_yvx,p_yvy,p_vxvx,p_vxvy,p_vyvy\n";

/// Two tracks of a sensor, 100 m apart, at two times from `first_s` on; variances of 4 m² and 1 m²/s².
fn tracks_of(sensor: &str, first_s: f64, offset_m: f64) -> Option<Input> {
    let mut csv = HEAD.to_owned();
    for (time_s, track, y_m) in [
        (0.0, "a", 0.0),
        (1.0, "a", 0.0),
        (0.0, "b", 100.0),
        (1.0, "b", 100.0),
    ] {
        let (time_s, x_m) = (first_s + time_s, 10.0 * time_s + offset_m);
        csv.push_str(&format!(
            "{time_s},{track},{sensor},{x_m},{y_m},10,0,4,0,0,0,4,0,0,1,0,1\n"
        ));
    }
    read(&csv)
}

#[test]
fn the_preset_puts_every_track_of_the_paper_together() {
    let preset = presets::find("huo2008").unwrap();
    let outcome = done(&preset.body, Vec::new());
    let result = &outcome.result;
    assert_eq!(
        [
            number(result, "/truth/tuples"),
            number(result, "/truth/tuples_right"),
            number(result, "/gap")
        ],
        [10.0, 10.0, 0.0]
    );
    assert_eq!(number(result, "/counts/system_tracks"), 10.0);
    let tuples = result["tuples"].as_array().unwrap();
    assert!(tuples.iter().all(|tuple| {
        tuple["p_value"]
            .as_f64()
            .is_some_and(|p| (0.0..=1.0).contains(&p))
    }));
    let sum: f64 = tuples
        .iter()
        .map(|tuple| tuple["cost"].as_f64().unwrap())
        .sum();
    assert!((sum - number(result, "/cost")).abs() < 1e-9);
    assert!(
        outcome
            .warnings
            .iter()
            .any(|warning| warning.contains("one two-dimensional assignment")),
        "{:?}",
        outcome.warnings
    );
}

#[test]
fn two_sets_by_hand() {
    let outcome = done(
        &sets(),
        vec![tracks_of("radar", 0.0, 0.0), tracks_of("lidar", 0.0, 4.0)],
    );
    let tuples = outcome.result["tuples"].as_array().unwrap();
    let pairs: Vec<_> = tuples
        .iter()
        .map(|tuple| (&tuple["tracks"][0], &tuple["tracks"][1]))
        .collect();
    assert_eq!(
        pairs,
        [(&json!("a"), &json!("a")), (&json!("b"), &json!("b"))]
    );
    // λ = 4² / (4 + 4) at each of two times; ν = 8, the 0.99 quantile of χ² with 8 degrees of freedom is 20.090.
    let (lambda, cost) = (
        number(&tuples[0], "/statistic"),
        number(&tuples[0], "/cost"),
    );
    assert!(
        (lambda - 4.0).abs() < 1e-9 && (cost - (4.0 - 20.090_235)).abs() < 1e-5,
        "{lambda}, {cost}"
    );
    assert!(
        (number(&tuples[0], "/p_value") - 0.857_123).abs() < 1e-5,
        "{}",
        tuples[0]
    );
    let file = outcome
        .artifacts
        .iter()
        .find(|file| file.name == "system_tracks.csv")
        .unwrap();
    let system = read(std::str::from_utf8(&file.bytes).unwrap()).unwrap();
    let trackloom_domain::model::dataset::Dataset::Tracks(system) = system.dataset else {
        panic!("tracks")
    };
    let state = &system.tracks[0].points[0].estimate;
    assert!(
        (state.position.x - 2.0).abs() < 1e-9
            && (state.covariance.as_ref().unwrap()[0] - 2.0).abs() < 1e-9,
        "{state:?}"
    );
    assert_eq!(outcome.result["truth"], Value::Null);
}

#[test]
fn every_correlator_and_statistic_finds_what_is_far_apart() {
    for correlator in trackloom_domain::correlation::CORRELATORS {
        for statistic in ["chain", "all_pairs", "likelihood_ratio", "fused"] {
            let mut body = drawn(json!({"spacing_m": 3000.0, "p_d": 0.8, "targets": 12}));
            body["correlator"] = json!({"method": correlator.name});
            body["statistic"] = json!({"kind": statistic});
            let result = done(&body, Vec::new()).result;
            // A track that is not linked with the first centre of its target begins a target of its own.
            // Of one target a track is so far off that `fused`, which has α for each link, takes it out.
            let least = match (statistic, correlator.name) {
                (_, "fuzzy") => 0.8,
                ("fused", _) => 0.9,
                _ => 1.0,
            };
            assert!(
                number(&result, "/truth/share_right") >= least,
                "{} {statistic}",
                correlator.name
            );
            assert!(
                result["gap"].is_null() || number(&result, "/gap") >= 0.0,
                "{} {statistic}",
                correlator.name
            );
        }
    }
}

#[test]
fn modified_sees_what_errors_have_in_common_and_weighted_does_not() {
    // J, which knows of it in both, over twenty draws.
    let cost = |method: &str| -> f64 {
        let of_seed = |seed: u32| {
            let mut body = drawn(json!({"spacing_m": 250.0, "cross_correlation": 0.25}));
            body["seed"] = json!(seed);
            body["cross_covariance"] = json!({"kind": "coefficient", "coefficient": 0.25});
            body["correlator"] = json!({"method": method});
            number(&done(&body, Vec::new()).result, "/cost")
        };
        (0..20).map(of_seed).sum()
    };
    let (exact, modified, weighted) = (cost("exact"), cost("modified"), cost("weighted"));
    assert!(
        exact < modified && modified < weighted,
        "{exact}, {modified}, {weighted}"
    );
    let alone = done(
        &{
            let mut body = drawn(json!({}));
            body["correlator"] = json!({"method": "modified"});
            body
        },
        Vec::new(),
    );
    assert!(
        alone
            .warnings
            .iter()
            .any(|warning| warning.contains("does what 'weighted' does")),
        "{:?}",
        alone.warnings
    );
}

#[test]
fn a_tuple_stands_that_was_found_often_enough() {
    let mut body = drawn(json!({"times": 5}));
    body["confirm"] = json!({"found": 3, "of": 4});
    let result = done(&body, Vec::new()).result;
    assert_eq!(number(&result, "/truth/share_right"), 1.0);
    assert!(
        result["tuples"]
            .as_array()
            .unwrap()
            .iter()
            .all(|tuple| (3..=4).contains(&tuple["found"].as_u64().unwrap()))
    );
    body["confirm"] = json!({"found": 5, "of": 4});
    assert_eq!(
        told(&refused(&body, Vec::new())),
        [("/confirm/found", "out_of_range")]
    );
    body["confirm"] = json!({"found": 2, "of": 6});
    assert_eq!(
        told(&refused(&body, Vec::new())),
        [("/confirm/of", "out_of_range")]
    );
}

#[test]
fn requests_that_cannot_be_are_refused_with_all_their_faults() {
    let mut both = sets();
    both["input"] = json!({"source": "local_tracks", "tracks": {}});
    both["alignment"] = json!({"reference": "radar", "period_s": 1.0, "sigma_mps": 1.0});
    let faults = refused(&both, Vec::new());
    let expected = [
        ("/input", "conflict"),
        ("/alignment/period_s", "conflict"),
        ("/alignment/sigma_m", "missing"),
    ];
    assert_eq!(told(&faults), expected, "{faults:?}");
    assert_eq!(
        told(&refused(
            &json!({"correlator": {"method": "exact"}}),
            Vec::new()
        )),
        [("", "missing")]
    );
    assert_eq!(
        told(&refused(&drawn(json!({"sensors": 1})), Vec::new())),
        [("/input/tracks/sensors", "unsupported")]
    );
    let one = json!({"sets": [{"source": "dataset", "dataset_id": ID}], "correlator": {"method": "exact"}});
    assert_eq!(told(&refused(&one, Vec::new())), [("/sets", "unsupported")]);
    let faults = refused(
        &drawn(json!({"sensors": 64, "targets": 100_000, "times": 100})),
        Vec::new(),
    );
    assert_eq!(told(&faults), [("/input/tracks", "too_large")]);
    assert!(
        faults[0].detail.contains(" s of work"),
        "{}",
        faults[0].detail
    );
    let mut unknown = drawn(json!({}));
    unknown["correlator"] = json!({"method": "simplex"});
    let faults = refused(&unknown, Vec::new());
    assert_eq!(told(&faults), [("/correlator/method", "unknown_value")]);
    assert!(
        faults[0].allowed.as_deref().unwrap().contains("lagrangian"),
        "{faults:?}"
    );
}

#[test]
fn sets_that_do_not_go_together_are_refused_by_name() {
    // Hours apart: no common times.
    let faults = refused(
        &sets(),
        vec![
            tracks_of("radar", 0.0, 0.0),
            tracks_of("lidar", 7200.0, 0.0),
        ],
    );
    assert_eq!(told(&faults), [("/sets", "disjoint")]);
    // The same sensor twice, and directions beside places.
    assert_eq!(
        told(&refused(
            &sets(),
            vec![tracks_of("radar", 0.0, 0.0), tracks_of("radar", 0.0, 4.0)]
        )),
        [("/sets/1", "duplicate")]
    );
    let bearings = read("time_s,track_id,sensor_id,bearing_deg\n0,a,sonar,10\n1,a,sonar,11\n");
    let faults = refused(&sets(), vec![bearings, tracks_of("lidar", 0.0, 0.0)]);
    assert_eq!(told(&faults), [("/sets/0", "unsupported")]);
    assert!(
        faults[0].detail.contains("bearing_deg"),
        "{}",
        faults[0].detail
    );
    let mut reference = sets();
    reference["alignment"] = json!({"reference": "sonar"});
    let faults = refused(
        &reference,
        vec![tracks_of("radar", 0.0, 0.0), tracks_of("lidar", 0.0, 0.0)],
    );
    assert_eq!(
        (told(&faults), faults[0].allowed.as_deref()),
        (
            vec![("/alignment/reference", "unknown_value")],
            Some("radar, lidar")
        )
    );
}

#[test]
fn tracks_without_covariance_need_what_is_assumed_and_it_is_said() {
    let bare = || {
        read(
            "time_s,track_id,sensor_id,x_m,y_m\n0,a,lidar,3,0\n1,a,lidar,13,0\n0,b,lidar,3,100\n1,b,lidar,13,100\n",
        )
    };
    let faults = refused(&sets(), vec![tracks_of("radar", 0.0, 0.0), bare()]);
    assert_eq!(told(&faults), [("/sets/1", "missing")]);
    assert!(
        faults[0]
            .allowed
            .as_deref()
            .unwrap()
            .contains("alignment/sigma_m"),
        "{faults:?}"
    );
    let mut body = sets();
    body["alignment"] = json!({"sigma_m": 2.0});
    let outcome = done(&body, vec![tracks_of("radar", 0.0, 0.0), bare()]);
    // Positions alone: λ = 3² / (4 + 4) at each of two times.
    assert!((number(&outcome.result, "/tuples/0/statistic") - 2.25).abs() < 1e-9);
    assert_eq!(number(&outcome.result, "/tuples/0/degrees_of_freedom"), 4.0);
    assert!(
        outcome
            .warnings
            .iter()
            .any(|warning| warning.contains("'lidar' carry no covariance: σ = 2 m is assumed")),
        "{:?}",
        outcome.warnings
    );
}

#[test]
fn a_crowd_of_tracks_is_refused_with_what_it_would_cost() {
    let faults = refused(
        &drawn(json!({"sensors": 10, "targets": 2000, "spacing_m": 0.1, "times": 1})),
        Vec::new(),
    );
    assert_eq!(told(&faults), [("/input", "too_large")]);
    assert!(
        faults[0]
            .detail
            .contains("the 20000 tracks are near each other"),
        "{}",
        faults[0].detail
    );
}

#[test]
fn sensors_without_tracks_leave_the_others_alone() {
    let mut without = 0;
    for seed in 0..20 {
        let mut body = drawn(json!({"sensors": 4, "targets": 2, "p_d": 0.6, "spacing_m": 5000.0}));
        body["seed"] = json!(seed);
        let Ok(Outcome { result, .. }) = experiment::run(
            &plan(JobKind::Correlate, &body).unwrap(),
            Vec::new(),
            &mut Silent,
        ) else {
            continue;
        };
        without += usize::from(
            result["sensors"]
                .as_array()
                .unwrap()
                .iter()
                .any(|sensor| sensor["tracks"] == 0),
        );
        let members = |tuple: &Value| {
            tuple["tracks"]
                .as_array()
                .unwrap()
                .iter()
                .filter(|track| !track.is_null())
                .count()
        };
        let in_tuples: usize = result["tuples"]
            .as_array()
            .unwrap()
            .iter()
            .map(members)
            .sum();
        assert_eq!(
            (in_tuples as f64) + number(&result, "/counts/unassociated"),
            number(&result, "/counts/tracks")
        );
    }
    assert!(without >= 3, "{without}");
}
