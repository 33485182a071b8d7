//! What sensors of a live session may report besides places, and what people do to it by hand.

use crate::sessions::{Told, assert_same, entry, push, scans, told, tracks_of_job};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use std::sync::Arc;
use trackloom_domain::experiment::session::{
    Entry, EntryFate, HandTrack, Scene, Session, SessionEventKind, read_scan, read_track,
};

fn planned(body: &Value) -> Arc<Scene> {
    Arc::new(Scene::plan(body).unwrap_or_else(|faults| panic!("{faults:?}")))
}

/// A ship with a radar that knows range rates and a camera, both counted from the bow; and transponders with velocities.
fn ship() -> Value {
    json!({
        "sensors": [
            {"sensor_id": "radar", "bearings": "relative", "sigma_range_m": 20.0, "sigma_bearing_deg": 0.3, "sigma_range_rate_mps": 0.5,
             "range_rate_span_mps": 60.0, "p_d": 0.85, "clutter_per_m2": 1e-8},
            {"sensor_id": "ais", "sigma_x_m": 15.0, "sigma_y_m": 15.0, "sigma_speed_mps": 0.5, "velocity_span_mps": 40.0, "p_d": 0.8,
             "clutter_per_m2": 1e-9},
            {"sensor_id": "camera", "sigma_bearing_deg": 0.5, "p_d": 0.7, "clutter_per_deg": 1e-3, "may_start": false}
        ],
        "filter": {"method": "unscented", "process_noise_m2ps3": 0.05},
        "tracker": {"initial_speed_sigma_mps": 10.0}
    })
}

/// Scans of six targets by the three sensors in turn, from a ship that goes east at 5 m/s and whose heading swings.
fn scans_of_ship(count: usize) -> Vec<Value> {
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    let mut uniform = |low: f64, high: f64| low + (high - low) * rng.random::<f64>();
    let targets: [[f64; 4]; 6] = std::array::from_fn(|_| {
        [
            uniform(-4e3, 4e3),
            uniform(-4e3, 4e3),
            uniform(-9.0, 9.0),
            uniform(-9.0, 9.0),
        ]
    });
    let mut scans = Vec::new();
    for index in 0..count {
        let time_s = 1.7e9 + index as f64 * 2.0;
        let passed_s = index as f64 * 2.0;
        let (ship_m, heading_deg) = (5.0 * passed_s, 90.0 + 10.0 * (passed_s / 20.0).sin());
        let mut detections = Vec::new();
        for (number, [x_m, y_m, vx, vy]) in targets.iter().enumerate() {
            if uniform(0.0, 1.0) > 0.8 {
                continue;
            }
            // Each report is made a little after the one before.
            let after_s = 0.01 * number as f64 + uniform(0.0, 0.005);
            let (x_m, y_m) = (
                x_m + vx * (passed_s + after_s),
                y_m + vy * (passed_s + after_s),
            );
            let (east, north) = (x_m - ship_m, y_m);
            let (range_m, bearing) = (east.hypot(north), east.atan2(north).to_degrees());
            let rate = ((vx - 5.0) * east + vy * north) / range_m;
            detections.push(match index % 3 {
                0 => json!({
                    "range_m": range_m + uniform(-20.0, 20.0), "bearing_deg": bearing - heading_deg + uniform(-0.3, 0.3),
                    "range_rate_mps": rate + uniform(-0.5, 0.5), "sigma_range_m": uniform(10.0, 40.0), "time_s": time_s + after_s
                }),
                1 if number % 2 == 0 => json!({
                    "x_m": x_m + uniform(-15.0, 15.0), "y_m": y_m + uniform(-15.0, 15.0), "speed_mps": vx.hypot(*vy),
                    "course_deg": vx.atan2(*vy).to_degrees(), "sigma_x_m": 12.0, "correlation_xy": uniform(-0.5, 0.5)
                }),
                1 => json!({"detection_id": format!("ship {number}"), "x_m": x_m + uniform(-15.0, 15.0), "y_m": y_m}),
                _ => json!({"bearing_deg": bearing + uniform(-0.5, 0.5)}),
            });
        }
        let sensor_id = ["radar", "ais", "camera"][index % 3];
        let mut scan = json!({"sensor_id": sensor_id, "time_s": time_s, "detections": detections});
        if sensor_id != "ais" {
            scan["pose"] = json!({
                "x_m": ship_m, "y_m": 0.0, "vx_mps": 5.0, "heading_deg": heading_deg, "sigma_x_m": 1.0, "sigma_heading_deg": 0.2
            });
        }
        scans.push(scan);
    }
    scans
}

#[test]
fn a_moving_ship_is_tracked_as_a_job_on_its_recording_tracks_it() {
    let (scene, scans) = (planned(&ship()), scans_of_ship(90));
    let (mut session, mut seen) = (Session::new(scene.clone()), Told::new());
    for (index, scan) in scans.iter().enumerate() {
        assert_eq!(push(&mut session, scan), EntryFate::Taken);
        told(&session, &mut seen);
        if index % 7 == 0 {
            let written = session.write_down();
            session = Session::read_back(scene.clone(), &written).unwrap();
        }
    }
    let job = tracks_of_job(&scene, &scans);
    let points: usize = job.tracks.iter().map(|track| track.points.len()).sum();
    let compared = assert_same(&session, &seen, &job);
    assert!(
        job.tracks.len() >= 6 && compared * 10 > points * 9,
        "{compared} of {points}"
    );
    // Of six targets, six long tracks: the sensors agree where things are.
    let long = job
        .tracks
        .iter()
        .filter(|track| track.points.len() > 60)
        .count();
    assert_eq!(long, 6);
}

/// The place and the code of each fault.
fn faults_of(scan: &Value, scene: &Scene) -> Vec<(String, String)> {
    let faults = read_scan(scan, scene).unwrap_err();
    let told = |fault: &trackloom_domain::model::fault::Fault| {
        (fault.pointer.to_string(), fault.code.to_string())
    };
    faults.iter().map(told).collect()
}

#[test]
fn what_a_sensor_does_not_report_and_a_pose_that_is_missing_are_told() {
    let scene = planned(&ship());
    let one = |sensor_id: &str, more: Value| {
        let mut scan = json!({"sensor_id": sensor_id, "time_s": 1.0});
        for (name, value) in more.as_object().unwrap() {
            scan[name] = value.clone();
        }
        faults_of(&scan, &scene)
    };
    let wants = |place: &str, code: &str| vec![(place.to_owned(), code.to_owned())];
    assert_eq!(one("camera", json!({})), wants("/pose", "missing"));
    let turned = json!({"pose": {"x_m": 0.0, "y_m": 0.0}});
    assert_eq!(one("radar", turned), wants("/pose/heading_deg", "missing"));
    let half = json!({"pose": {"x_m": 0.0, "heading_deg": 3.0}});
    assert_eq!(one("radar", half), wants("/pose", "missing"));
    let placed = json!({"pose": {"lat_deg": 1.0, "lon_deg": 2.0, "heading_deg": 3.0}});
    assert_eq!(one("radar", placed), wants("/pose/lat_deg", "no_frame"));
    let no_rate = json!({"pose": {"x_m": 0.0, "y_m": 0.0, "heading_deg": 3.0}, "detections": [{"range_m": 1.0, "bearing_deg": 2.0}]});
    assert_eq!(one("radar", no_rate), wants("/detections/0", "conflict"));
    let half = json!({"detections": [{"x_m": 1.0, "y_m": 2.0, "speed_mps": 3.0}]});
    assert_eq!(one("ais", half), wants("/detections/0", "missing"));
    let both = json!({"detections": [{"x_m": 1.0, "y_m": 2.0, "speed_mps": 3.0, "course_deg": 4.0, "vx_mps": 1.0}]});
    assert_eq!(
        one("ais", both),
        wants("/detections/0/speed_mps", "conflict")
    );
    let some =
        json!({"detections": [{"x_m": 1.0, "y_m": 2.0, "time_s": 1.5}, {"x_m": 1.0, "y_m": 3.0}]});
    assert_eq!(one("ais", some), wants("/detections", "missing"));
    let twice = json!({"detections": [{"x_m": 1.0, "y_m": 2.0, "detection_id": "2"}, {"x_m": 1.0, "y_m": 3.0}]});
    assert_eq!(one("ais", twice), wants("/detections", "duplicate"));
    let noise =
        json!({"detections": [{"x_m": 1.0, "y_m": 2.0, "sigma_x_m": 0.0, "correlation_xy": 1.0}]});
    assert_eq!(one("ais", noise).len(), 2);
    let timed = json!({"time": "2026-01-31T12:00:00Z"});
    assert_eq!(one("ais", timed), wants("/time", "conflict"));
    let standing = planned(&json!({
        "sensors": [
            {"sensor_id": "a", "x_m": 0.0, "y_m": 0.0, "sigma_bearing_deg": 0.5, "p_d": 0.9, "clutter_per_deg": 1e-3, "may_start": true},
            {"sensor_id": "b", "x_m": 900.0, "y_m": 0.0, "sigma_bearing_deg": 0.5, "p_d": 0.9, "clutter_per_deg": 1e-3, "may_start": true}
        ],
        "filter": {"method": "unscented"}, "tracker": {"initial_speed_sigma_mps": 10.0}
    }));
    let scan = json!({"sensor_id": "a", "time_s": 1.0, "pose": {"x_m": 0.0, "y_m": 0.0}});
    assert_eq!(faults_of(&scan, &standing), wants("/pose", "conflict"));
}

#[test]
fn a_time_is_a_number_or_iso_8601() {
    let scene = planned(&ship());
    // By another's clock: `date -d 2026-01-31T12:00:00.25+01:00 +%s.%2N`.
    for (text, time_s) in [
        ("2026-01-31T12:00:00.25+01:00", 1_769_857_200.25),
        ("2026-01-31 11:00:00.25", 1_769_857_200.25),
    ] {
        let scan = json!({"sensor_id": "ais", "time": text, "heartbeat": true});
        assert_eq!(read_scan(&scan, &scene).unwrap().time_s, time_s);
    }
    let faults = faults_of(&json!({"sensor_id": "ais", "time": "noon"}), &scene);
    assert_eq!(faults, [("/time".to_owned(), "malformed".to_owned())]);
    let faults = faults_of(&json!({"sensor_id": "ais"}), &scene);
    assert_eq!(faults, [("/time_s".to_owned(), "missing".to_owned())]);
}

#[test]
fn spans_of_what_is_reported_besides_are_to_be_told() {
    let mut body = ship();
    let radar = body["sensors"][0].as_object_mut().unwrap();
    radar.shift_remove("range_rate_span_mps");
    let ais = body["sensors"][1].as_object_mut().unwrap();
    ais.shift_remove("sigma_speed_mps");
    let faults = Scene::plan(&body).err().unwrap();
    let places: Vec<&str> = faults.iter().map(|fault| fault.pointer.as_str()).collect();
    assert_eq!(
        places,
        [
            "/sensors/0/range_rate_span_mps",
            "/sensors/1/sigma_speed_mps"
        ]
    );
}

fn begun(scene: &Scene, [x_m, y_m]: [f64; 2]) -> HandTrack {
    let body = json!({"x_m": x_m, "y_m": y_m, "vx_mps": 3.0, "sigma_m": 30.0, "sigma_mps": 2.0});
    read_track(&body, scene).unwrap_or_else(|faults| panic!("{faults:?}"))
}

#[test]
fn a_track_that_is_begun_by_hand_is_confirmed_and_lives_by_the_rules() {
    let lives = [
        json!({}),
        json!({"tracker": {"initial_speed_sigma_mps": 15.0, "confirmation": {"rule": "existence"}}}),
        json!({"tracker": {"method": "poisson_multi_bernoulli", "initial_speed_sigma_mps": 15.0}}),
    ];
    for more in lives {
        let scene = crate::sessions::scene(more.clone());
        let mut session = Session::new(scene.clone());
        let place = |time_s: f64| [9000.0 + 3.0 * time_s, 9000.0];
        let scan = |index: usize, is_seen: bool| {
            let [x_m, y_m] = place(index as f64);
            let detections = if is_seen {
                json!([{"x_m": x_m + 5.0, "y_m": y_m}])
            } else {
                json!([])
            };
            json!({"sensor_id": "plots", "time_s": index as f64, "detections": detections})
        };
        let early = Entry::Begin(begun(&scene, place(0.0)));
        assert_eq!(
            session.checking().check(early).unwrap_err().code,
            "conflict"
        );
        push(&mut session, &scan(0, false));
        session
            .take(Entry::Begin(begun(&scene, place(0.0))))
            .unwrap();
        let track = &session.tracks(None)[0];
        assert_eq!(
            (track.track_id.as_str(), track.point.x_m, track.point.vx_mps),
            ("1", Some(9000.0), Some(3.0))
        );
        let expected = [900.0, 0.0, 0.0, 0.0, 900.0, 0.0, 0.0, 4.0, 0.0, 4.0];
        assert_eq!(track.point.covariance, expected);
        let events = session.events_after(0, 10).unwrap();
        let kinds: Vec<SessionEventKind> = events.iter().map(|event| event.kind).collect();
        assert_eq!(
            kinds,
            [SessionEventKind::Started, SessionEventKind::Confirmed]
        );
        for index in 1..20 {
            push(&mut session, &scan(index, true));
        }
        let tracks = session.tracks(None);
        assert_eq!(tracks.len(), 1, "{more}");
        assert_eq!(tracks[0].detections, 19, "{more}");
        assert!((tracks[0].point.x_m.unwrap() - place(19.0)[0] - 5.0).abs() < 10.0);
        for index in 20..60 {
            push(&mut session, &scan(index, false));
        }
        assert_eq!(
            session.tracks(None).len(),
            0,
            "{more}: nothing was seen of it for 40 scans"
        );
        assert!(!session.is_by_rule());
    }
}

#[test]
fn late_scans_are_not_put_before_what_was_done_by_hand() {
    let scene = crate::sessions::scene(json!({"late": "replay", "window_s": 30.0}));
    let order = scans(12, 4);
    let mut session = Session::new(scene.clone());
    for index in [0, 1, 2, 4, 5] {
        push(&mut session, &order[index]);
    }
    let track_id = session.tracks(None)[0].track_id.clone();
    session
        .take(Entry::End {
            track_id: track_id.clone(),
        })
        .unwrap();
    session
        .take(Entry::Begin(begun(&scene, [0.0, 0.0])))
        .unwrap();
    let before = json!(session.tracks(None));
    assert_eq!(push(&mut session, &order[3]), EntryFate::LateDropped);
    assert_eq!(json!(session.tracks(None)), before);
    // What comes late of the scans since is taken in its place, and what was ended does not live again.
    for index in [6, 8, 7] {
        push(&mut session, &order[index]);
    }
    assert_eq!(session.counts().replayed, 1);
    assert!(!session.lives(&track_id));
    let mut in_order = Session::new(scene.clone());
    for index in [0, 1, 2, 4, 5] {
        push(&mut in_order, &order[index]);
    }
    in_order.take(Entry::End { track_id }).unwrap();
    in_order
        .take(Entry::Begin(begun(&scene, [0.0, 0.0])))
        .unwrap();
    for scan in &order[6..9] {
        push(&mut in_order, scan);
    }
    assert_eq!(json!(session.tracks(None)), json!(in_order.tracks(None)));
}

#[test]
fn a_pause_is_kept_and_hand_tracks_fit_the_space() {
    let scene = crate::sessions::scene(json!({}));
    let mut session = Session::new(scene.clone());
    push(&mut session, &scans(1, 1)[0]);
    session.take(Entry::Pause).unwrap();
    let session = Session::read_back(scene.clone(), &session.write_down()).unwrap();
    assert!(session.is_paused());
    let faults = read_track(&json!({"bearing_deg": 3.0}), &scene).unwrap_err();
    let places: Vec<&str> = faults.iter().map(|fault| fault.pointer.as_str()).collect();
    assert_eq!(places, ["/x_m", "/y_m", "/sigma_m", "/sigma_mps"]);
    // An entry of a log reads back as it was.
    let entries = [
        Entry::Begin(begun(&scene, [1.0, 2.0])),
        Entry::Resume,
        entry(&scans(1, 1)[0], &scene),
        entry(&scans_of_ship(1)[0], &planned(&ship())),
    ];
    for one in entries {
        let text = serde_json::to_string(&one).unwrap();
        assert_eq!(serde_json::from_str::<Entry>(&text).unwrap(), one, "{text}");
    }
}
