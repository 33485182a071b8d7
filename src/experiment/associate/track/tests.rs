//! A tracker that is written down after any scan, read back and fed the rest tells the same to the bit, also in another process.

use super::*;
use crate::experiment::associate::settle;
use crate::experiment::associate::spec::Spec;
use crate::experiment::observer::Silent;
use crate::experiment::{JobKind, plan, presets};
use crate::formats::{ReadOptions, format_named};
use crate::model::dataset::Dataset;
use crate::tracking::recorder::{RecordedPoint, Recorder};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;

/// Names the folder from which the other process reads, and into which it writes.
const FOLDER: &str = "TRACKLOOM_CHECKPOINTS";

/// All that a recorder is told, numbers by their bits.
#[derive(Default)]
struct Log(String);

impl Recorder for Log {
    fn given(&mut self, serial: u32, name: &str) {
        writeln!(self.0, "given {serial} {name}").unwrap();
    }

    fn point(&mut self, point: &RecordedPoint) {
        let kinematics: Vec<u64> = point
            .kinematics
            .iter()
            .map(|value| value.to_bits())
            .collect();
        let nis = point.nis.map(f64::to_bits);
        let (serial, scan, status) = (point.serial, point.scan_index, point.status);
        write!(self.0, "{serial} {scan} {status:?} {kinematics:?} {nis:?}").unwrap();
        for candidate in point.candidates {
            let (detection, weight) = (candidate.detection, candidate.probability.to_bits());
            write!(self.0, " {detection:?}={weight}").unwrap();
        }
        self.0.push('\n');
    }

    fn end(&mut self, serial: u32) {
        writeln!(self.0, "end {serial}").unwrap();
    }
}

/// What a job tracks, and how.
struct Scene {
    name: String,
    spec: Spec,
    data: JobData,
}

impl Scene {
    fn of(name: String, body: &Value) -> Scene {
        Scene::with(name, body, JobData::default())
    }

    fn with(name: String, body: &Value, mut data: JobData) -> Scene {
        let planned =
            plan(JobKind::Associate, body).unwrap_or_else(|faults| panic!("{name}: {faults:?}"));
        let spec: Spec = serde_json::from_value(planned.spec).unwrap();
        let (input, detector) = (&spec.input, spec.detector.as_ref());
        data.gather(input, detector, &spec.sensors, SETTINGS.seed, &mut Silent)
            .unwrap();
        Scene { name, spec, data }
    }

    fn tracker(&self) -> Box<dyn Tracker> {
        let settled = settle(&self.spec.tracking, self.data.recording().unwrap());
        let (scenario, sensors) = (self.spec.input.scenario.as_ref(), &self.spec.sensors);
        let mut warnings = Vec::new();
        let run = TrackerRun::new(
            (&self.data, self.data.recording().unwrap()),
            scenario,
            &settled,
            sensors,
            SETTINGS,
            &mut warnings,
        );
        run.unwrap().0.start().unwrap()
    }

    fn scans(&self) -> usize {
        self.data.recording().unwrap().scans.len()
    }

    /// Feeds some scans, and adds what the tracker says of itself to what it told.
    fn feed(&self, tracker: &mut dyn Tracker, scans: std::ops::Range<usize>) -> String {
        let recording = self.data.recording().unwrap();
        let mut log = Log::default();
        for scan in &recording.scans[scans] {
            let outcome = tracker.step(scan, &mut log, &Watch::never());
            writeln!(log.0, "{:?}", outcome.unwrap()).unwrap();
        }
        log.0
    }
}

fn says(tracker: &dyn Tracker) -> String {
    format!(
        "{:?} {:?} {:?} {:?}",
        tracker.nis(),
        tracker.diagnostics().map(|value| value.to_string()),
        tracker.trace().map(Trace::text),
        tracker.tracks()
    )
}

const SETTINGS: RunSettings = RunSettings {
    seed: Seed { seed: 1, run: 0 },
    wants_files: false,
    time_association: false,
};

/// The trackers of all presets, those of campaigns by their base, and one scene with what presets do not use.
fn scenes() -> Vec<Scene> {
    let fields = [
        "input",
        "associator",
        "filter",
        "tracker",
        "sensors",
        "detector",
    ];
    let mut scenes = Vec::new();
    for preset in presets::all() {
        let body = preset.body.get("base").unwrap_or(&preset.body);
        if body.get("associator").is_none() {
            continue;
        }
        let known = fields.iter().filter(|name| body.get(**name).is_some());
        let body: Value = known
            .map(|name| (name.to_string(), body[*name].clone()))
            .collect();
        scenes.push(Scene::of(preset.name, &body));
    }
    let of_liang = presets::find("liang2009-30").unwrap().body;
    for (number, (associator, tracker, filter)) in [
        (json!({"method": "fuzzy_c_means", "trace": true}), json!({}), json!({"method": "kalman"})),
        (json!({"method": "bat", "trace": true}), json!({}), json!({"method": "kalman"})),
        (
            json!({"method": "jpda"}),
            json!({"initiation": {"method": "two_point", "max_wait_scans": 3}, "confirmation": {"rule": "score"}}),
            json!({"method": "kalman", "motion": {"model": "constant_acceleration"}}),
        ),
        (
            json!({"method": "pda"}),
            json!({"initiation": {"method": "multi_scan"}}),
            json!({"method": "kalman"}),
        ),
        (
            json!({"method": "oracle"}),
            json!({"initiation": {"method": "truth"}}),
            json!({"method": "unscented"}),
        ),
    ]
    .into_iter()
    .enumerate()
    {
        let input = &of_liang["input"];
        let body = json!({"input": input, "associator": associator, "tracker": tracker, "filter": filter});
        scenes.push(Scene::of(format!("more-{number}"), &body));
    }
    scenes.push(crossing_scene());
    scenes
}

/// Two cameras whose bearings cross, with more bearings than those of the ship.
fn crossing_scene() -> Scene {
    let camera = |name: &str, x_m: f64| {
        json!({"sensor_id": name, "x_m": x_m, "y_m": 0.0, "max_range_m": 1e4, "p_d": 0.8,
            "sigma_bearing_deg": 0.3, "clutter_per_scan": 1.0})
    };
    let ship = json!({"truth_id": "1", "x_m": 900.0, "y_m": 4000.0, "vx_mps": 5.0, "vy_mps": -3.0});
    let body = json!({
        "input": {"source": "scenario", "scenario": {
            "scans": 20, "scan_period_s": 2.0, "sensors": [camera("east", 2000.0), camera("west", 0.0)],
            "targets": {"kind": "listed", "targets": [ship]}}},
        "sensors": [{"sensor_id": "east", "may_start": true}, {"sensor_id": "west", "may_start": true}],
        "associator": {"method": "jpda"},
        "filter": {"method": "unscented"}
    });
    Scene::of("crossing".into(), &body)
}

#[test]
fn a_tracker_that_is_read_back_goes_on_to_the_bit() {
    let scenes = scenes();
    assert!(scenes.len() > 15, "{}", scenes.len());
    let is_other = std::env::var_os(FOLDER).map(PathBuf::from);
    if let Some(folder) = is_other {
        return scenes.iter().for_each(|scene| go_on(scene, &folder));
    }
    let folder = tempfile::tempdir().unwrap();
    let mut expected = Vec::new();
    for scene in &scenes {
        let (half, all) = (scene.scans() / 2, scene.scans());
        let mut whole = scene.tracker();
        scene.feed(whole.as_mut(), 0..half);
        let written = whole.write_down();
        std::fs::write(folder.path().join(&scene.name), &written).unwrap();
        let mut fork = whole.fork();
        let rest = scene.feed(whole.as_mut(), half..all);
        assert!(
            rest.lines().count() > all - half,
            "{}: nothing is tracked",
            scene.name
        );
        assert!(
            rest == scene.feed(fork.as_mut(), half..all),
            "{}: a fork",
            scene.name
        );
        assert_eq!(says(whole.as_ref()), says(fork.as_ref()), "{}", scene.name);
        expected.push((scene.name.clone(), rest + &says(whole.as_ref())));
    }
    let other = std::process::Command::new(std::env::current_exe().unwrap())
        .args(["--exact", &this_test()])
        .env(FOLDER, folder.path())
        .output()
        .unwrap();
    assert!(
        other.status.success(),
        "{}",
        String::from_utf8_lossy(&other.stdout)
    );
    for (name, rest) in expected {
        let told = std::fs::read_to_string(folder.path().join(format!("{name}.rest"))).unwrap();
        assert!(told == rest, "{name}: another process");
    }
}

fn small_scene() -> Scene {
    let input = &presets::find("liang2009-10").unwrap().body["input"];
    Scene::of("liang2009-10".into(), &json!({"input": input}))
}

fn this_test() -> String {
    let module = module_path!().split_once("::").unwrap().1;
    format!("{module}::a_tracker_that_is_read_back_goes_on_to_the_bit")
}

/// What the other process does.
fn go_on(scene: &Scene, folder: &std::path::Path) {
    let mut tracker = scene.tracker();
    let written = std::fs::read(folder.join(&scene.name)).unwrap();
    tracker.read_back(&written).unwrap();
    let rest = scene.feed(tracker.as_mut(), scene.scans() / 2..scene.scans());
    let told = rest + &says(tracker.as_ref());
    std::fs::write(folder.join(format!("{}.rest", scene.name)), told).unwrap();
}

#[test]
fn after_any_scan_a_tracker_can_be_written_down() {
    let body = presets::find("liang2009-10").unwrap().body;
    let fields = ["input", "tracker"].map(|name| (name.to_owned(), body[name].clone()));
    let mut body = Value::Object(fields.into_iter().collect());
    body["associator"] = json!({"method": "jpda"});
    let scene = Scene::of("liang2009-10".into(), &body);
    let mut whole = scene.tracker();
    let mut expected = Vec::new();
    for scan in 0..scene.scans() {
        let written = whole.write_down();
        let mut other = scene.tracker();
        other.read_back(&written).unwrap();
        assert!(
            other.write_down() == written,
            "what is read back is written alike"
        );
        expected.push(scene.feed(whole.as_mut(), scan..scan + 1));
        assert_eq!(
            scene.feed(other.as_mut(), scan..scan + 1),
            expected[scan],
            "scan {scan}"
        );
    }
}

/// Two tracks on one target, of which the younger ends at 25 s, with the tenth scan that counts: the counts are written, too, whatever
/// they are.
#[test]
fn counts_of_twins_go_on_to_the_bit() {
    let twin = include_str!("../../../../tests/domain/twins/twin.csv");
    let read = format_named("csv").unwrap().read;
    let read = read(&mut twin.as_bytes(), &ReadOptions::default()).unwrap();
    let Dataset::Detections(recording) = read.dataset else {
        panic!("these are detections");
    };
    let body = json!({
        "input": {"source": "dataset", "dataset_id": "d"},
        "sensors": [{"sensor_id": "r", "p_d": 0.9, "clutter_per_m2": 1e-7, "sigma_x_m": 5, "sigma_y_m": 5}],
        "associator": {"method": "pda"},
        "filter": {"method": "kalman", "process_noise_m2ps3": 0.3},
        "tracker": {"initial_speed_sigma_mps": 12, "merging": {"scans": 10}}
    });
    let mut data = JobData::default();
    data.recording = Some(recording);
    let scene = Scene::with("twin".into(), &body, data);
    let mut whole = scene.tracker();
    let mut counts = Vec::new();
    for scan in 0..40 {
        let written = whole.write_down();
        let told: Value = serde_json::from_slice(&written).unwrap();
        counts.extend(told["twins"][0]["scans"].as_u64());
        let mut other = scene.tracker();
        other.read_back(&written).unwrap();
        assert!(other.write_down() == written, "scan {scan}");
        let mut fork = whole.fork();
        let rest = scene.feed(other.as_mut(), scan..40);
        assert!(rest == scene.feed(fork.as_mut(), scan..40), "scan {scan}");
        scene.feed(whole.as_mut(), scan..scan + 1);
    }
    assert_eq!(counts, [1, 2, 3, 4, 1, 2, 1, 2, 3, 4, 5, 6, 7, 8, 9]);
}

#[test]
fn what_no_tracker_wrote_is_refused() {
    let scene = small_scene();
    let mut tracker = scene.tracker();
    scene.feed(tracker.as_mut(), 0..3);
    let written = String::from_utf8(tracker.write_down()).unwrap();
    let shorter = written.replacen("\"belief\":[", "\"belief\":[1,", 1);
    let newer = written.replacen("\"version\":4", "\"version\":5", 1);
    let mapped = written.replacen("\"maps\":[null", "\"maps\":[[0]", 1);
    assert!(newer != written && mapped != written && shorter != written);
    let half = &written[..written.len() / 2];
    for wrong in ["", "{}", half, &shorter, &newer, &mapped] {
        let before = says(tracker.as_ref());
        let fault = tracker.read_back(wrong.as_bytes()).unwrap_err();
        assert_eq!(fault.pointer, "/tracker");
        assert_eq!(says(tracker.as_ref()), before, "nothing changes");
    }
}

#[test]
fn a_scan_from_before_is_late_and_changes_nothing() {
    let scene = small_scene();
    let recording = scene.data.recording().unwrap();
    let mut tracker = scene.tracker();
    scene.feed(tracker.as_mut(), 0..3);
    let before = tracker.write_down();
    let (scan, mut log) = (&recording.scans[1], Log::default());
    let halt = tracker.step(scan, &mut log, &Watch::never()).unwrap_err();
    let (time_s, last_s) = (scan.time_s, recording.scans[2].time_s);
    assert_eq!(halt, crate::model::watch::Halt::Late { time_s, last_s });
    assert!(log.0.is_empty() && tracker.write_down() == before);
}
