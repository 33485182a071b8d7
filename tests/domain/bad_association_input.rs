//! Settings and data with which nothing can be associated: each is refused with its place and what would be allowed.

use serde_json::{Value, json};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, JobKind, plan};
use trackloom_domain::formats;
use trackloom_domain::model::fault::Fault;

/// A job that associates the detections of a dataset, with one sensor fully described.
fn body() -> Value {
    json!({
        "input": {"source": "dataset", "dataset_id": "0198c0de-0000-7000-8000-000000000000"},
        "associator": {"method": "pda"},
        "filter": {"method": "kalman"},
        "tracker": {},
        "sensors": [{"sensor_id": "radar", "p_d": 0.9, "clutter_per_m2": 1e-6, "sigma_x_m": 10.0, "sigma_y_m": 10.0}]
    })
}

/// A job with the same filter on a scenario.
fn simulated() -> Value {
    let sensor =
        json!({"max_range_m": 1000.0, "sigma_x_m": 1.0, "sigma_y_m": 1.0, "clutter_per_scan": 1.0});
    let targets = json!({"kind": "listed", "targets": [{"truth_id": "a", "x_m": 1.0, "y_m": 2.0}]});
    let scenario =
        json!({"scans": 3, "scan_period_s": 1.0, "sensors": [sensor], "targets": targets});
    json!({"input": {"source": "scenario", "scenario": scenario}, "filter": {"method": "kalman"}, "tracker": {}})
}

/// The body with one value set; its parent exists.
fn with(mut body: Value, pointer: &str, value: Value) -> Value {
    let (parent, name) = pointer.rsplit_once('/').unwrap();
    body.pointer_mut(parent).unwrap()[name] = value;
    body
}

/// Pointer, code and allowed values of each fault.
fn told(faults: &[Fault]) -> Vec<(&str, &str, &str)> {
    faults
        .iter()
        .map(|fault| {
            (
                fault.pointer.as_str(),
                fault.code.as_str(),
                fault.allowed.as_deref().unwrap_or("?"),
            )
        })
        .collect()
}

/// The one fault of a body with one wrong value.
fn refused(body: Value, pointer: &str, value: Value, code: &str, allowed: &str) {
    let body = with(body, pointer, value.clone());
    let faults =
        plan(JobKind::Associate, &body).expect_err(&format!("{pointer} = {value} is accepted"));
    assert_eq!(told(&faults), [(pointer, code, allowed)], "{value}");
}

#[test]
fn probabilities_outside_their_range_are_refused() {
    for p_d in [0.0, -0.1, 1.1] {
        refused(
            body(),
            "/sensors/0/p_d",
            json!(p_d),
            "out_of_range",
            "(0, 1]",
        );
        refused(
            simulated(),
            "/input/scenario/sensors/0/p_d",
            json!(p_d),
            "out_of_range",
            "(0, 1]",
        );
    }
    for p_g in [0.0, -1.0, 2.0] {
        refused(
            body(),
            "/tracker/gate_probability",
            json!(p_g),
            "out_of_range",
            "(0, 1]",
        );
    }
    assert!(
        plan(
            JobKind::Associate,
            &with(body(), "/sensors/0/p_d", json!(1.0))
        )
        .is_ok()
    );
}

#[test]
fn names_that_a_spreadsheet_would_run_are_refused() {
    let allowed = "numbers, and names that do not begin with = @ + - or a tab";
    refused(
        body(),
        "/sensors/0/sensor_id",
        json!("=1+1"),
        "malformed",
        allowed,
    );
    refused(
        simulated(),
        "/input/scenario/targets/targets/0/truth_id",
        json!("@a"),
        "malformed",
        allowed,
    );
    assert!(
        plan(
            JobKind::Associate,
            &with(
                simulated(),
                "/input/scenario/targets/targets/0/truth_id",
                json!("-1.5")
            )
        )
        .is_ok()
    );
    // The name and the labels of the job are in no table.
    let named = json!({"name": "=1+1", "labels": {"name": "=1+1"}});
    let mut body = body();
    body.as_object_mut()
        .unwrap()
        .extend(named.as_object().unwrap().clone());
    assert!(plan(JobKind::Associate, &body).is_ok());
}

#[test]
fn densities_outside_their_range_are_refused() {
    for density in [0.0, -1e-6, 1e7] {
        refused(
            body(),
            "/sensors/0/clutter_per_m2",
            json!(density),
            "out_of_range",
            "(0, 1000000] 1/m²",
        );
    }
    refused(
        simulated(),
        "/input/scenario/sensors/0/clutter_per_scan",
        json!(-1.0),
        "out_of_range",
        "[0, 1000000]",
    );
}

#[test]
fn noises_must_be_positive() {
    for sigma in [0.0, -10.0] {
        for name in ["sigma_x_m", "sigma_y_m", "sigma_range_m"] {
            refused(
                body(),
                &format!("/sensors/0/{name}"),
                json!(sigma),
                "out_of_range",
                "(0, 1000000] m",
            );
        }
        refused(
            body(),
            "/sensors/0/sigma_bearing_deg",
            json!(sigma),
            "out_of_range",
            "(0, 180] deg",
        );
        refused(
            body(),
            "/sensors/0/sigma_range_rate_mps",
            json!(sigma),
            "out_of_range",
            "(0, 100000] m/s",
        );
        refused(
            simulated(),
            "/input/scenario/sensors/0/sigma_y_m",
            json!(sigma),
            "out_of_range",
            "(0, 1000000] m",
        );
        refused(
            body(),
            "/tracker/initial_speed_sigma_mps",
            json!(sigma),
            "out_of_range",
            "(0, 100000] m/s",
        );
    }
    refused(
        body(),
        "/filter/process_noise_m2ps3",
        json!(-1.0),
        "out_of_range",
        "[0, 1000000000] m²/s³",
    );
}

#[test]
fn noises_and_densities_of_directions_have_their_own_ranges() {
    let body = with(body(), "/filter", json!({"method": "bearing_only"}));
    let refused = |pointer: &str, value: f64, allowed: &str| {
        refused(body.clone(), pointer, json!(value), "out_of_range", allowed)
    };
    for density in [0.0, -1.0, 1e7] {
        refused("/sensors/0/clutter_per_deg", density, "(0, 1000000] 1/deg");
    }
    refused(
        "/filter/process_noise_deg2ps3",
        -1e-9,
        "[0, 1000000] deg²/s³",
    );
    refused("/filter/initial_rate_sigma_degps", 0.0, "(0, 360] deg/s");
}

#[test]
fn caps_of_jpda_end_where_a_cluster_would_take_seconds() {
    let jpda = with(body(), "/associator", json!({"method": "jpda"}));
    let refused = |name: &str, value: Value, allowed: &str| {
        refused(
            jpda.clone(),
            &format!("/associator/{name}"),
            value,
            "out_of_range",
            allowed,
        );
    };
    refused("max_events", json!(100_000_001u64), "[1, 100000000]");
    refused("max_states", json!(1 << 25), "[1, 16777216]");
    refused("max_auto_cost", json!((1u64 << 25) + 1), "[1, 33554432]");
    refused("max_iterations", json!(10_001), "[1, 10000]");
    for tolerance in [0.0, 1e-300, 0.11] {
        refused("tolerance", json!(tolerance), "[0.00000000000001, 0.1]");
    }
}

#[test]
fn what_jpda_does_not_do_against_coalescence_is_refused() {
    refused(
        with(body(), "/associator", json!({"method": "jpda"})),
        "/associator/against_coalescence",
        json!("set_jpda"),
        "unknown_value",
        "none, best_permutation, nearest_neighbour",
    );
}

#[test]
fn a_life_cycle_that_cannot_be_is_refused() {
    let lives = |tracker: Value| plan(JobKind::Associate, &with(body(), "/tracker", tracker));
    let faults = lives(json!({"confirm_hits": 6, "confirm_window": 5})).unwrap_err();
    assert_eq!(
        told(&faults),
        [(
            "/tracker/confirm_hits",
            "out_of_range",
            "[1, 5] (confirm_window)"
        )]
    );
    refused(
        body(),
        "/tracker/max_position_sigma_m",
        json!(0.0),
        "out_of_range",
        "(0, 1000000000] m",
    );
}

#[test]
fn parameters_of_initiation_and_confirmation_are_refused_with_their_range() {
    let told_of = |tracker: Value| {
        let faults = plan(JobKind::Associate, &with(body(), "/tracker", tracker)).unwrap_err();
        faults
            .into_iter()
            .map(|fault| (fault.pointer, fault.code, fault.allowed.unwrap_or_default()))
            .collect::<Vec<_>>()
    };
    let fault = |pointer: &str, code: &str, allowed: &str| {
        (
            format!("/tracker/{pointer}"),
            code.to_owned(),
            allowed.into(),
        )
    };
    let two_point =
        |speed: Value| json!({"initiation": {"method": "two_point", "max_speed_mps": speed}});
    assert_eq!(
        told_of(two_point(json!(0.0))),
        [fault(
            "initiation/max_speed_mps",
            "out_of_range",
            "(0, 100000] m/s"
        )]
    );
    assert_eq!(
        told_of(two_point(json!("fast"))),
        [fault("initiation/max_speed_mps", "wrong_type", "a number")]
    );
    let three_point = json!({"initiation": {"method": "three_point"}});
    assert_eq!(
        told_of(three_point),
        [fault(
            "initiation/method",
            "unknown_value",
            "one_point, two_point, multi_scan, truth"
        )]
    );
    let one_point = json!({"initiation": {"method": "one_point", "max_speed_mps": 3.0}});
    assert_eq!(
        told_of(one_point),
        [fault("initiation/max_speed_mps", "unknown_field", "method")]
    );
    let score = json!({"confirmation": {
        "rule": "score", "false_track_probability": 0.0, "missed_track_probability": 0.5, "max_score_drop": -1.0
    }});
    let expected = [
        fault(
            "confirmation/false_track_probability",
            "out_of_range",
            "(0, 0.5)",
        ),
        fault(
            "confirmation/missed_track_probability",
            "out_of_range",
            "(0, 0.5)",
        ),
        fault("confirmation/max_score_drop", "out_of_range", "(0, 1000]"),
    ];
    assert_eq!(told_of(score), expected);
    assert_eq!(
        told_of(json!({"confirmation": {"rule": "luck"}})),
        [fault(
            "confirmation/rule",
            "unknown_value",
            "m_of_n, score, existence"
        )]
    );
}

#[test]
fn directions_have_no_speeds_and_no_positions() {
    let tracker = json!({"initiation": {"method": "two_point", "max_speed_mps": 30.0}, "max_position_sigma_m": 50.0});
    let body = with(
        with(body(), "/filter", json!({"method": "bearing_only"})),
        "/tracker",
        tracker,
    );
    let faults = plan(JobKind::Associate, &body).unwrap_err();
    let expected = [
        (
            "/tracker/initiation/method",
            "unsupported",
            "one_point, multi_scan, truth",
        ),
        ("/tracker/max_position_sigma_m", "unsupported", "no value"),
    ];
    assert_eq!(told(&faults), expected);
}

#[test]
fn a_sensor_is_described_once() {
    let twice = json!([{"sensor_id": "radar"}, {"sensor_id": "sonar"}, {"sensor_id": "radar"}]);
    let faults = plan(JobKind::Associate, &with(body(), "/sensors", twice)).unwrap_err();
    assert_eq!(
        told(&faults),
        [("/sensors/2/sensor_id", "duplicate", "each sensor_id once")]
    );
    let sensor = json!({"sensor_id": "a", "max_range_m": 10.0, "sigma_x_m": 1.0, "sigma_y_m": 1.0});
    let faults = plan(
        JobKind::Associate,
        &with(
            simulated(),
            "/input/scenario/sensors",
            json!([sensor, sensor]),
        ),
    )
    .unwrap_err();
    assert_eq!(
        told(&faults),
        [(
            "/input/scenario/sensors/1/sensor_id",
            "duplicate",
            "each name once"
        )]
    );
}

/// The faults that a job finds in its data.
fn found_in(body: &Value, csv: Option<&str>) -> Vec<Fault> {
    let plan = plan(JobKind::Associate, body).unwrap();
    let read = |csv: &str| {
        (formats::format_named("csv").unwrap().read)(&mut csv.as_bytes(), &Default::default())
            .unwrap()
            .dataset
    };
    let inputs = csv.map(|csv| {
        Some(experiment::Input {
            dataset: read(csv),
            sensors: vec![],
            sha256: String::new(),
        })
    });
    match experiment::run(&plan, inputs.into_iter().collect(), &mut Silent) {
        Err(experiment::RunError::Faults(faults)) => faults,
        other => panic!("{other:?}"),
    }
}

#[test]
fn detections_that_the_filter_cannot_use_are_named_with_those_it_can() {
    let ranges = "time_s,scan,sensor_id,detection_id,range_m,bearing_deg\n0,1,radar,a,100,45\n";
    let faults = found_in(&body(), Some(ranges));
    assert_eq!(
        told(&faults),
        [("/filter/method", "unsupported", "positions (x_m, y_m)")]
    );
    assert_eq!(
        faults[0].detail,
        "sensor 'radar' reports ranges and bearings, which the filter 'kalman' cannot use"
    );

    let bearings = "time_s,scan,sensor_id,detection_id,bearing_deg\n0,1,radar,a,45\n";
    let faults = found_in(
        &with(body(), "/filter/method", json!("extended")),
        Some(bearings),
    );
    assert_eq!(
        told(&faults),
        [(
            "/filter/method",
            "unsupported",
            "positions (x_m, y_m); ranges and bearings (range_m, bearing_deg)"
        )]
    );

    let both = "time_s,scan,sensor_id,detection_id,x_m,y_m,bearing_deg\n0,1,radar,a,1,2,\n0,1,camera,b,,,45\n";
    let faults = found_in(&body(), Some(both));
    assert_eq!(
        told(&faults),
        [("/filter/method", "unsupported", "positions (x_m, y_m)")]
    );
    let detail = "sensor 'camera' reports bearings without ranges, which the filter 'kalman' cannot use; 'sensor_ids' of the input can leave it out";
    assert_eq!(faults[0].detail, detail);
}

#[test]
fn what_a_scenario_will_report_is_tried_before_it_runs() {
    let refused = |changes: &[(&str, Value)]| {
        let body = changes.iter().fold(simulated(), |body, (pointer, value)| {
            with(body, pointer, value.clone())
        });
        let faults = plan(JobKind::Associate, &body).unwrap_err();
        let told = told(&faults)
            .into_iter()
            .map(|(pointer, code, allowed)| format!("{pointer} {code}: {allowed}"));
        told.collect::<Vec<_>>()
    };
    let sensor = |noise: Value| {
        let mut sensor = json!({"sensor_id": "radar", "max_range_m": 10.0, "p_d": 0.9});
        noise
            .as_object()
            .unwrap()
            .iter()
            .for_each(|(name, value)| sensor[name] = value.clone());
        ("/input/scenario/sensors", json!([sensor]))
    };
    let polar = sensor(json!({"sigma_range_m": 1.0, "sigma_bearing_deg": 1.0}));
    let method = |name: &str| ("/associator", json!({"method": name}));
    let positions = "/filter/method unsupported: positions (x_m, y_m)";
    let amplitudes = "/associator/method unsupported: an 'amplitude' column without empty cells";
    assert_eq!(refused(std::slice::from_ref(&polar)), [positions]);
    assert_eq!(refused(&[method("strongest_neighbour")]), [amplitudes]);
    assert_eq!(
        refused(&[polar.clone(), method("strongest_neighbour")]),
        [positions, amplitudes]
    );
    let requested = |settings: Value| ("/sensors", json!([settings]));
    let unknown = requested(json!({"sensor_id": "sonar", "p_d": 0.5}));
    assert_eq!(
        refused(&[unknown]),
        ["/sensors/0/sensor_id unknown_value: radar"]
    );
    let per_deg = requested(json!({"sensor_id": "radar", "clutter_per_deg": 0.5}));
    assert_eq!(
        refused(&[per_deg]),
        ["/sensors/0/clutter_per_deg unsupported: clutter_per_m2"]
    );
    let always = requested(json!({"sensor_id": "radar", "p_d": 1.0}));
    let no_gate = ("/tracker", json!({"gate_probability": 1.0}));
    assert_eq!(
        refused(&[always, no_gate]),
        ["/tracker/gate_probability conflict: below 1, or a P_D below 1"]
    );
    // A filter of directions can use these bearings, but tracks of directions cannot begin at places.
    let (directions, at_truth) = (
        ("/filter", json!({"method": "bearing_only"})),
        ("/tracker", json!({"initiation": {"method": "truth"}})),
    );
    assert_eq!(
        refused(&[polar.clone(), directions, at_truth]),
        ["/truth unsupported: directions (bearing_deg)"]
    );
    // What can be used is a plan, and so is the same scenario without a tracker.
    let usable = with(
        with(simulated(), polar.0, polar.1.clone()),
        "/filter",
        json!({"method": "extended"}),
    );
    assert!(plan(JobKind::Associate, &usable).is_ok());
    let alone = json!({"scenario": usable["input"]["scenario"]});
    assert!(plan(JobKind::Simulate, &alone).is_ok());
}

#[test]
fn what_the_recording_does_not_have_is_named_with_what_it_has() {
    let csv = "time_s,scan,sensor_id,detection_id,x_m,y_m\n0,1,lidar,a,1,2\n";
    assert_eq!(
        told(&found_in(&body(), Some(csv))),
        [("/sensors/0/sensor_id", "unknown_value", "lidar")]
    );
    let faults = found_in(
        &with(
            body(),
            "/sensors",
            json!([{"sensor_id": "lidar", "sigma_x_m": 1.0}]),
        ),
        Some(csv),
    );
    assert_eq!(told(&faults), [("/sensors", "missing", "> 0 m")]);
}

#[test]
fn a_singular_covariance_in_a_file_of_tracks_is_refused() {
    let csv = "time_s,track_id,x_m,y_m,p_xx,p_xy,p_xvx,p_xvy,p_yy,p_yvx,p_yvy,p_vxvx,p_vxvy,p_vyvy\n0,T,1,2,4,2,0,0,1,0,0,1,0,1\n";
    let faults =
        (formats::format_named("csv").unwrap().read)(&mut csv.as_bytes(), &Default::default())
            .unwrap_err();
    let allowed = "a positive definite matrix: every variance > 0, every correlation within (-1, 1); or all its cells empty";
    assert_eq!(told(&faults), [("/file", "out_of_range", allowed)]);
    assert_eq!(
        (faults[0].line, faults[0].column.as_deref()),
        (Some(2), Some("p_xx"))
    );

    let csv = "time_s,track_id,bearing_deg,bearing_rate_degps,p_bb,p_bbr,p_brbr\n0,T,10,0,4,2,1\n";
    let faults =
        (formats::format_named("csv").unwrap().read)(&mut csv.as_bytes(), &Default::default())
            .unwrap_err();
    assert_eq!(told(&faults), [("/file", "out_of_range", allowed)]);
    assert_eq!(
        (faults[0].line, faults[0].column.as_deref()),
        (Some(2), Some("p_bb"))
    );
}
