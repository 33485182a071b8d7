//! A live session is the same tracker as that of a job on what it recorded, whatever comes late and whenever it is written down.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::Arc;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::session::{
    Checked, Entry, EntryFate, LatePolicy, Scene, Session, SessionEventKind, SessionRecording,
    read_scan,
};
use trackloom_domain::experiment::{self, Input, JobKind};
use trackloom_domain::formats::{DetectionsCsv, ReadOptions, format_named, write_csv};
use trackloom_domain::model::dataset::{Dataset, DatasetKind};
use trackloom_domain::model::scan::Recording;
use trackloom_domain::model::track::TrackSet;

const ID: &str = "0198c0de-0000-7000-8000-000000000000";

fn request(more: Value) -> Value {
    let mut body = json!({
        "sensors": [
            {"sensor_id": "plots", "sigma_x_m": 20.0, "sigma_y_m": 20.0, "p_d": 0.9, "clutter_per_m2": 1e-7},
            {"sensor_id": "radar", "x_m": 500.0, "y_m": -800.0, "sigma_range_m": 20.0, "sigma_bearing_deg": 0.2, "p_d": 0.8, "clutter_per_m2": 1e-7}
        ],
        "filter": {"method": "unscented", "process_noise_m2ps3": 1.0},
        "tracker": {"initial_speed_sigma_mps": 15.0}
    });
    for (name, value) in more.as_object().unwrap() {
        body[name] = value.clone();
    }
    body
}

pub fn scene(more: Value) -> Arc<Scene> {
    Arc::new(Scene::plan(&request(more)).unwrap_or_else(|faults| panic!("{faults:?}")))
}

/// Scans of eight targets by two sensors in turn, with clutter and misses; each has an own number of its sensor.
pub fn scans(count: usize, seed: u64) -> Vec<Value> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut uniform = |low: f64, high: f64| low + (high - low) * rng.random::<f64>();
    let targets: Vec<[f64; 4]> = (0..8)
        .map(|_| {
            [
                uniform(-4e3, 4e3),
                uniform(-4e3, 4e3),
                uniform(-15.0, 15.0),
                uniform(-15.0, 15.0),
            ]
        })
        .collect();
    let mut scans = Vec::new();
    for index in 0..count {
        let time_s = 1.7e9 + index as f64 * 1.5;
        let is_radar = index % 2 == 1;
        let mut detections = Vec::new();
        for [x_m, y_m, vx_mps, vy_mps] in &targets {
            if uniform(0.0, 1.0) < 0.85 {
                let dt_s = index as f64 * 1.5;
                let noise = uniform(-30.0, 30.0);
                detections.push([x_m + vx_mps * dt_s + noise, y_m + vy_mps * dt_s - noise]);
            }
        }
        for _ in 0..3 {
            detections.push([uniform(-5e3, 5e3), uniform(-5e3, 5e3)]);
        }
        let report = |&[x_m, y_m]: &[f64; 2]| {
            if is_radar {
                let (east, north): (f64, f64) = (x_m - 500.0, y_m + 800.0);
                json!({"range_m": east.hypot(north), "bearing_deg": east.atan2(north).to_degrees()})
            } else {
                json!({"x_m": x_m, "y_m": y_m})
            }
        };
        let detections: Vec<Value> = detections.iter().map(report).collect();
        let sensor_id = if is_radar { "radar" } else { "plots" };
        let nothing_seen = index % 11 == 10;
        scans.push(json!({
            "sensor_id": sensor_id, "time_s": time_s, "sequence": index / 2,
            "detections": if nothing_seen { json!([]) } else { json!(detections) }
        }));
    }
    scans
}

pub fn entry(scan: &Value, scene: &Scene) -> Entry {
    Entry::Scan(read_scan(scan, scene).unwrap_or_else(|faults| panic!("{faults:?}")))
}

pub fn push(session: &mut Session, scan: &Value) -> EntryFate {
    let entry = entry(scan, &session.scene().clone());
    let checked = session.checking().check(entry).unwrap();
    match checked {
        Checked::New(entry) => session.take(entry).unwrap(),
        Checked::Duplicate => EntryFate::Duplicate,
    }
}

/// Pieces of a recording as one table.
pub fn table_of(pieces: &[Recording]) -> Vec<u8> {
    let (mut table, mut text) = (DetectionsCsv::default(), Vec::new());
    for piece in pieces {
        table.look(piece);
    }
    table.begin(&mut text).unwrap();
    for piece in pieces {
        table.write(piece, &mut text).unwrap();
    }
    text
}

/// The tracks of the job on what was recorded.
pub fn tracks_of_job(scene: &Arc<Scene>, scans: &[Value]) -> TrackSet {
    let (mut recording, mut pieces) = (SessionRecording::new(scene.clone()), Vec::new());
    for scan in scans {
        pieces.extend(recording.add(entry(scan, scene)).unwrap());
    }
    pieces.push(recording.end().unwrap());
    let text = table_of(&pieces);
    let options = ReadOptions {
        kind: Some(DatasetKind::Detections),
        ..ReadOptions::default()
    };
    let read = (format_named("csv").unwrap().read)(&mut &text[..], &options).unwrap();
    let plan = experiment::plan(JobKind::Associate, &scene.job_on(ID)).unwrap();
    let input = Input {
        dataset: read.dataset,
        sensors: Vec::new(),
        sha256: String::new(),
    };
    let outcome = experiment::run(&plan, vec![Some(input), None], &mut Silent).unwrap();
    let file = outcome
        .artifacts
        .iter()
        .find(|file| file.name == "tracks.csv")
        .unwrap();
    let read = (format_named("csv").unwrap().read)(&mut &file.bytes[..], &ReadOptions::default());
    match read.unwrap().dataset {
        Dataset::Tracks(tracks) => tracks,
        _ => panic!("not tracks"),
    }
}

/// What a session believed of its confirmed tracks at each time, by the bits.
pub type Told = BTreeMap<(String, u64), [u64; 4]>;

pub fn told(session: &Session, told: &mut Told) {
    for track in session.tracks(None) {
        let point = &track.point;
        let values = [point.x_m, point.y_m, point.vx_mps, point.vy_mps];
        let bits = values.map(|value| value.unwrap().to_bits());
        told.insert((track.track_id, point.time_s.to_bits()), bits);
    }
}

/// Every point of the job's tracks is what the session told at that time, to the bit.
pub fn assert_same(session: &Session, seen: &Told, job: &TrackSet) -> usize {
    let ids = session.confirmed_track_ids();
    assert_eq!(job.tracks.len(), ids.len());
    let mut compared = 0;
    for (track, live) in job.tracks.iter().zip(&ids) {
        for point in &track.points {
            let state = point.estimate.state();
            let Some(bits) = seen.get(&(live.clone(), point.time_s.to_bits())) else {
                continue;
            };
            assert_eq!(
                *bits,
                [0, 1, 2, 3].map(|row| state[row].to_bits()),
                "track {live}"
            );
            compared += 1;
        }
    }
    compared
}

#[test]
fn a_job_on_the_recording_has_the_tracks_of_the_session() {
    let settings = [
        json!({}),
        json!({"associator": {"method": "jpda"}}),
        json!({"associator": {"method": "global_nearest_neighbour"}, "tracker": {"initial_speed_sigma_mps": 15.0, "initiation": {"method": "multi_scan"}}}),
        json!({"associator": {"method": "jpda"}, "tracker": {"initial_speed_sigma_mps": 15.0, "confirmation": {"rule": "existence"}}}),
        json!({"associator": {"method": "jpda"}, "tracker": {"method": "poisson_multi_bernoulli", "initial_speed_sigma_mps": 15.0}}),
        json!({"associator": {"method": "bat"}}),
        json!({"associator": {"method": "fuzzy_c_means"}}),
        json!({"late": "wait", "delay_s": 4.0}),
        json!({"late": "replay", "window_s": 30.0}),
    ];
    for more in settings {
        let scene = scene(more.clone());
        let (scans, mut session, mut seen) =
            (scans(60, 5), Session::new(scene.clone()), Told::new());
        for scan in &scans {
            push(&mut session, scan);
            told(&session, &mut seen);
        }
        session.finish().unwrap();
        told(&session, &mut seen);
        let job = tracks_of_job(&scene, &scans);
        let points: usize = job.tracks.iter().map(|track| track.points.len()).sum();
        let compared = assert_same(&session, &seen, &job);
        // Points of the past that were decided later, and those of scans that waited together, were never the latest.
        assert!(
            job.tracks.len() >= 6 && compared * 10 > points * 5,
            "{more}: {compared} of {points}"
        );
    }
}

#[test]
fn scans_in_any_order_within_the_window_give_the_tracks_of_the_order_of_time() {
    for seed in 0..8 {
        let more = json!({"late": "replay", "window_s": 30.0, "associator": {"method": "jpda"}});
        let scene = scene(more);
        let in_order = scans(60, seed);
        let mut session = Session::new(scene.clone());
        for scan in &in_order {
            assert_eq!(push(&mut session, scan), EntryFate::Taken);
        }
        // Each scan is put off by up to 24 s.
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut shuffled: Vec<(f64, &Value)> = in_order
            .iter()
            .map(|scan| {
                (
                    scan["time_s"].as_f64().unwrap() + 24.0 * rng.random::<f64>(),
                    scan,
                )
            })
            .collect();
        shuffled.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mut late = Session::new(scene.clone());
        let mut replayed = 0;
        for (_, scan) in &shuffled {
            let fate = push(&mut late, scan);
            assert_ne!(fate, EntryFate::LateDropped);
            replayed += u64::from(fate == EntryFate::Replayed);
        }
        assert!(replayed > 15, "{replayed}");
        assert_eq!(late.counts().replayed, replayed);
        let (told, wanted) = (late.tracks(None), session.tracks(None));
        assert_eq!(json!(told), json!(wanted));
        assert_eq!(late.confirmed_track_ids(), session.confirmed_track_ids());
        let events = late.events_after(0, 10_000).unwrap();
        let revised = events
            .iter()
            .filter(|event| event.kind == SessionEventKind::Revised);
        assert_eq!(revised.count() as u64, replayed);
    }
}

#[test]
fn a_session_that_is_written_down_and_read_back_goes_on_to_the_bit() {
    let policies = [
        json!({"associator": {"method": "bat"}}),
        json!({"late": "wait", "delay_s": 4.0}),
        json!({"late": "replay", "window_s": 12.0, "tracker": {"initial_speed_sigma_mps": 15.0, "initiation": {"method": "multi_scan"}}}),
    ];
    for more in policies {
        let (scene, mut scans) = (scene(more.clone()), scans(60, 9));
        for index in (3..57).step_by(5) {
            scans.swap(index, index + 1);
        }
        let mut whole = Session::new(scene.clone());
        let mut broken = Session::new(scene.clone());
        for (index, scan) in scans.iter().enumerate() {
            let fates = [push(&mut whole, scan), push(&mut broken, scan)];
            assert_eq!(fates[0], fates[1], "{more} {index}");
            if index % 7 == 0 {
                let written = broken.write_down();
                broken = Session::read_back(scene.clone(), &written).unwrap();
                assert_eq!(broken.write_down(), written, "{more} {index}");
            }
        }
        assert_eq!(
            json!(whole.tracks(None)),
            json!(broken.tracks(None)),
            "{more}"
        );
        assert_eq!(whole.write_down(), broken.write_down(), "{more}");
        assert!(whole.tracks(None).len() >= 6);
    }
}

#[test]
fn what_comes_late_is_dropped_waited_for_or_told_as_it_was_asked() {
    let dropping = scene(json!({}));
    let order = scans(6, 1);
    let mut session = Session::new(dropping);
    let fates: Vec<EntryFate> = [0, 1, 3, 2, 4, 4]
        .iter()
        .map(|&index| push(&mut session, &order[index]))
        .collect();
    use EntryFate::{Duplicate, LateDropped, Taken, Waiting};
    assert_eq!(fates, [Taken, Taken, Taken, LateDropped, Taken, Duplicate]);
    let counts = session.counts();
    assert_eq!(
        (counts.scans, counts.late_dropped, counts.missing),
        (5, 1, 0)
    );
    // Scans are 1.5 s apart: with 2 s a scan waits until the one after the next has come.
    let mut session = Session::new(scene(json!({"late": "wait", "delay_s": 2.0})));
    let fates: Vec<EntryFate> = [0, 2, 1]
        .iter()
        .map(|&index| push(&mut session, &order[index]))
        .collect();
    assert_eq!(fates, [Waiting, Waiting, Taken]);
    assert_eq!(session.processed_to_s(), order[1]["time_s"].as_f64());
    assert_eq!(session.waiting(), 1);
    let beat =
        json!({"sensor_id": "radar", "time_s": 1.7e9 + 9.0, "sequence": 7, "heartbeat": true});
    push(&mut session, &beat);
    assert_eq!(session.processed_to_s(), order[2]["time_s"].as_f64());
    // Numbers 1 to 6 of the radar were left out.
    assert_eq!(session.counts().missing, 6);
    let mut session = Session::new(scene(json!({"late": "replay", "window_s": 2.0})));
    let fates: Vec<EntryFate> = [0, 3, 4, 1]
        .iter()
        .map(|&index| push(&mut session, &order[index]))
        .collect();
    assert_eq!(fates, [Taken, Taken, Taken, LateDropped]);
}

#[test]
fn faults_are_told_all_together_and_nothing_is_taken() {
    let scene = scene(json!({}));
    let bad = json!({"sensor_id": "plots", "time_s": 1.0, "detections": [
        {"x_m": 1.0, "y_m": 2.0}, {"x_m": 1.0}, {"range_m": 3.0, "bearing_deg": 1.0}, {"lat_deg": 1.0, "lon_deg": 2.0}
    ]});
    let faults = read_scan(&bad, &scene).unwrap_err();
    let places: Vec<&str> = faults.iter().map(|fault| fault.pointer.as_str()).collect();
    assert_eq!(
        places,
        ["/detections/1", "/detections/2", "/detections/3/lat_deg"]
    );
    let unknown = json!({"sensor_id": "sonar", "time_s": 1.0});
    let faults = read_scan(&unknown, &scene).unwrap_err();
    assert_eq!(faults[0].allowed.as_deref(), Some("plots, radar"));
    let mut session = Session::new(scene.clone());
    push(&mut session, &scans(1, 1)[0]);
    let far = json!({"sensor_id": "plots", "time_s": 1.8e9});
    let fault = session.checking().check(entry(&far, &scene)).unwrap_err();
    assert_eq!(
        (fault.code.as_str(), fault.pointer.as_str()),
        ("out_of_range", "/time_s")
    );
    assert_eq!(session.counts().entries, 1);
}

#[test]
fn settings_that_would_be_taken_from_the_data_are_asked_for() {
    let body = json!({"sensors": [{"sensor_id": "a", "sigma_x_m": 1.0, "sigma_y_m": 1.0}, {"sensor_id": "b", "merge_within_m": 3.0}]});
    let faults = Scene::plan(&body).err().unwrap();
    let places: Vec<&str> = faults.iter().map(|fault| fault.pointer.as_str()).collect();
    assert_eq!(
        places,
        [
            "/sensors/0/p_d",
            "/sensors/1",
            "/sensors/1/p_d",
            "/sensors/1/merge_within_m"
        ]
    );
    let body =
        json!({"sensors": [{"sensor_id": "a", "sigma_x_m": 1.0, "sigma_y_m": 1.0, "p_d": 0.9}]});
    let faults = Scene::plan(&body).err().unwrap();
    let places: Vec<&str> = faults.iter().map(|fault| fault.pointer.as_str()).collect();
    assert_eq!(
        places,
        [
            "/sensors/0/clutter_per_m2",
            "/tracker/initial_speed_sigma_mps"
        ]
    );
}

#[test]
fn too_many_tracks_drop_the_youngest_tentative_ones() {
    let scene = scene(json!({"max_tracks": 5}));
    let mut session = Session::new(scene);
    for scan in scans(30, 3) {
        push(&mut session, &scan);
        let tracks = session.tracks(None);
        let tentative = tracks
            .iter()
            .filter(|track| json!(track.status) == "tentative")
            .count();
        assert!(tracks.len() <= 5 || tentative == 0, "{}", tracks.len());
    }
    let events = session.events_after(0, 10_000).unwrap();
    assert!(
        events
            .iter()
            .any(|event| event.kind == SessionEventKind::Limited)
    );
    let first = session.tracks(None)[0].track_id.clone();
    session
        .take(Entry::End {
            track_id: first.clone(),
        })
        .unwrap();
    assert!(
        session
            .tracks(None)
            .iter()
            .all(|track| track.track_id != first)
    );
    assert!(session.history(&first).is_none());
}

#[test]
fn tracks_are_told_for_a_time_ahead_and_where_they_are_on_the_earth() {
    let scene = scene(json!({"origin": {"lat_deg": 50.0, "lon_deg": 8.0}}));
    let mut session = Session::new(scene);
    for scan in scans(20, 4) {
        push(&mut session, &scan);
    }
    let now_s = session.processed_to_s().unwrap();
    let (now, ahead) = (session.tracks(None), session.tracks(Some(now_s + 10.0)));
    for (now, ahead) in now.iter().zip(&ahead) {
        let (from, to) = (&now.point, &ahead.point);
        let moved_m = to.x_m.unwrap() - from.x_m.unwrap() - 10.0 * from.vx_mps.unwrap();
        assert!(moved_m.abs() < 1e-6);
        assert!(to.covariance[0] > from.covariance[0]);
        // A degree of latitude is about 111.2 km there.
        let north_m = (from.lat_deg.unwrap() - 50.0) * 111_230.0;
        assert!((north_m - from.y_m.unwrap()).abs() < 30.0, "{north_m}");
        let history = session.history(&now.track_id).unwrap();
        assert_eq!(history.points.last().unwrap().point, *from);
    }
    assert!(now.len() >= 6);
}

#[test]
fn a_long_session_is_recorded_in_pieces_that_are_its_scans_in_order() {
    let policies = [
        json!({}),
        json!({"late": "wait", "delay_s": 6.0}),
        json!({"late": "replay", "window_s": 9.0}),
    ];
    for more in policies {
        let scene = scene(more.clone());
        let mut late = scans(5000, 3);
        for index in (5..4990).step_by(11) {
            late.swap(index, index + 2);
        }
        let (mut recording, mut pieces) = (SessionRecording::new(scene.clone()), Vec::new());
        for scan in &late {
            pieces.extend(recording.add(entry(scan, &scene)).unwrap());
        }
        pieces.push(recording.end().unwrap());
        assert!(pieces.len() >= 4, "{more}: {}", pieces.len());
        let text = table_of(&pieces);
        let options = ReadOptions {
            kind: Some(DatasetKind::Detections),
            ..ReadOptions::default()
        };
        let read = (format_named("csv").unwrap().read)(&mut &text[..], &options).unwrap();
        assert_eq!(read.warnings, Vec::<String>::new(), "{more}");
        let Dataset::Detections(whole) = &read.dataset else {
            panic!("not detections");
        };
        // Of each of 454 swaps two scans come late; with `wait` one does, when both sensors were heard since.
        let dropped = match scene.rules().late {
            LatePolicy::Drop => 2 * 454,
            LatePolicy::Wait => 454,
            LatePolicy::Replay => 0,
        };
        assert_eq!(whole.scans.len(), 5000 - dropped, "{more}");
        assert!(
            whole
                .scans
                .windows(2)
                .all(|pair| pair[0].time_s < pair[1].time_s)
        );
        let mut again = Vec::new();
        write_csv(&read.dataset, &mut again).unwrap();
        assert!(
            again == text,
            "{more}: it is not the canonical table of its scans"
        );
    }
}
