//! Four sensors of different kinds in one recording, tracked by one tracker: the state of each target after every scan is that of
//! Stone Soup, or of a filter of the second order that was written apart, on the same given associations. The values are made by
//! `mixed/stone_soup.py`.

#[path = "mixed/refused.rs"]
mod refused;
#[path = "mixed/slopes.rs"]
mod slopes;

use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write;
use trackloom_domain::association::ASSOCIATORS;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{self, Input, JobKind, Outcome, RunError};
use trackloom_domain::filtering::{AnyFilter, FILTERS, Filter, WithFilter};
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::hypotheses::certain::{locate, update};
use trackloom_domain::math::rng::Seed;
use trackloom_domain::model::dataset::Dataset;
use trackloom_domain::model::scan::{Measurement, Recording};
use trackloom_domain::model::sensing::{Bearing, MeasurementModel, Platform, Polar, RangeRate};
use trackloom_domain::model::sensor::{Sensor, SensorSettings};
use trackloom_domain::model::state::Position;
use trackloom_domain::model::track::{TrackPoint, TrackSet, TrackStatus};
use trackloom_domain::model::watch::Watch;
use trackloom_domain::tracking::{
    Confirmation, History, Initiation, Lifecycle, TRACKERS, TrackerParts,
};

/// Every number, in standard deviations of the state that it belongs to.
const TOLERANCE: f64 = 1e-9;
const FILTER_NAMES: [&str; 2] = ["unscented", "extended"];

/// `values.json`.
#[derive(Deserialize)]
struct Values {
    process_noise_m2ps3: f64,
    initial_speed_sigma_mps: f64,
    sensors: Vec<SensorSettings>,
    scans: Vec<Scan>,
    /// By filter and target: mean and upper triangle of the covariance after every scan.
    states: BTreeMap<String, BTreeMap<String, Vec<Vec<f64>>>>,
}

#[derive(Deserialize)]
struct Scan {
    time_s: f64,
    sensor_id: String,
    /// By target.
    reports: BTreeMap<String, Report>,
}

#[derive(Deserialize)]
struct Report {
    x_m: Option<f64>,
    y_m: Option<f64>,
    range_m: Option<f64>,
    bearing_deg: Option<f64>,
    range_rate_mps: Option<f64>,
}

impl Report {
    fn measurement(&self) -> Measurement {
        let bearing_rad = self.bearing_deg.unwrap_or_default().to_radians();
        match (self.x_m.zip(self.y_m), self.range_m) {
            (Some((x_m, y_m)), _) => Measurement::Position { x_m, y_m },
            (_, Some(range_m)) => Measurement::RangeBearing {
                range_m,
                bearing_rad,
                range_rate_mps: self.range_rate_mps,
            },
            _ => Measurement::Bearing { bearing_rad },
        }
    }
}

impl Values {
    fn read() -> Values {
        serde_json::from_str(include_str!("mixed/values.json")).unwrap()
    }

    fn filter(&self, name: &str) -> AnyFilter {
        let entry = FILTERS.iter().find(|entry| entry.name == name).unwrap();
        let spec = json!({"process_noise_m2ps3": self.process_noise_m2ps3, "alpha": 1.0, "beta": 2.0, "kappa": 0.0});
        (entry.build)(&spec).unwrap()
    }

    fn model(&self, sensor_id: &str) -> MeasurementModel {
        let named = |settings: &&SensorSettings| settings.sensor_id == sensor_id;
        model_of(self.sensors.iter().find(named).unwrap())
    }

    /// As a file of detections; without range rates where they are not wanted.
    fn csv(&self, has_rates: bool) -> String {
        let mut csv = "time_s,scan,sensor_id,detection_id,x_m,y_m,range_m,bearing_deg,range_rate_mps,truth_id\n".to_owned();
        for (index, scan) in self.scans.iter().enumerate() {
            for (target, report) in &scan.reports {
                let rate = report.range_rate_mps.filter(|_| has_rates);
                let cells = [
                    report.x_m,
                    report.y_m,
                    report.range_m,
                    report.bearing_deg,
                    rate,
                ];
                write!(
                    csv,
                    "{},{},{},{target}",
                    scan.time_s,
                    index + 1,
                    scan.sensor_id
                )
                .unwrap();
                for cell in cells {
                    csv += &cell.map_or(",".to_owned(), |value| format!(",{value}"));
                }
                writeln!(csv, ",{target}").unwrap();
            }
        }
        csv
    }

    /// A job that tracks such a file with the true associations; the camera does not start tracks.
    fn request(&self, filter: &str) -> Value {
        let sensor = |settings: &SensorSettings| {
            let mut sensor = serde_json::to_value(settings).unwrap();
            sensor["p_d"] = json!(0.9);
            let is_camera = settings.sensor_id == "camera";
            let density = if is_camera {
                "clutter_per_deg"
            } else {
                "clutter_per_m2"
            };
            sensor[density] = json!(1e-9);
            if is_camera {
                sensor["may_start"] = json!(false);
            }
            sensor
        };
        json!({
            "input": {"source": "dataset", "dataset_id": "0198c0de-0000-7000-8000-000000000000"},
            "associator": {"method": "oracle"},
            "filter": {"method": filter, "process_noise_m2ps3": self.process_noise_m2ps3},
            "tracker": {"confirm_hits": 1, "confirm_window": 1, "initial_speed_sigma_mps": self.initial_speed_sigma_mps},
            "sensors": self.sensors.iter().map(sensor).collect::<Vec<_>>()
        })
    }
}

fn model_of(settings: &SensorSettings) -> MeasurementModel {
    if let Some((sigma_x_m, sigma_y_m)) = settings.sigma_x_m.zip(settings.sigma_y_m) {
        return MeasurementModel::Position {
            sigma_x_m,
            sigma_y_m,
        };
    }
    let place_m = Position::new(settings.x_m.unwrap(), settings.y_m.unwrap());
    let sigma_bearing_rad = settings.sigma_bearing_deg.unwrap().to_radians();
    let Some(sigma_range_m) = settings.sigma_range_m else {
        return MeasurementModel::Bearing(Bearing {
            place_m,
            sigma_bearing_rad,
            platform: Platform::STANDING,
            range_prior: None,
        });
    };
    let rate = |sigma_mps| RangeRate {
        sigma_mps,
        span_mps: 100.0,
    };
    MeasurementModel::Polar(Polar {
        place_m,
        sigma_range_m,
        sigma_bearing_rad,
        range_rate: settings.sigma_range_rate_mps.map(rate),
        platform: Platform::STANDING,
    })
}

fn recording(csv: &str) -> Recording {
    let read = format_named("csv").unwrap().read;
    match read(&mut csv.as_bytes(), &ReadOptions::default())
        .unwrap()
        .dataset
    {
        Dataset::Detections(recording) => recording,
        _ => panic!("no detections"),
    }
}

fn run(request: &Value, csv: &str) -> Result<Outcome, RunError> {
    let plan = experiment::plan(JobKind::Associate, request).unwrap_or_else(|it| panic!("{it:?}"));
    let detections = Input {
        dataset: Dataset::Detections(recording(csv)),
        sensors: Vec::new(),
        sha256: String::new(),
    };
    let wanted = plan.inputs.iter();
    let inputs = wanted.map(|input| (!input.optional).then(|| detections.clone()));
    experiment::run(&plan, inputs.collect(), &mut Silent)
}

fn tracks_of(outcome: &Outcome) -> TrackSet {
    let is_tracks = |file: &&experiment::Artifact| file.name == "tracks.csv";
    let file = outcome.artifacts.iter().find(is_tracks).unwrap();
    let read = format_named("csv").unwrap().read;
    match read(&mut file.bytes.as_slice(), &ReadOptions::default())
        .unwrap()
        .dataset
    {
        Dataset::Tracks(set) => set,
        _ => panic!("no tracks"),
    }
}

/// The largest difference of two packed states, in standard deviations of the second.
fn apart(ours: &[f64], theirs: &[f64]) -> f64 {
    assert_eq!((ours.len(), theirs.len()), (14, 14));
    let sigma = [4, 8, 11, 13].map(|variance: usize| theirs[variance].sqrt());
    let mut scales = sigma.to_vec();
    for row in 0..4 {
        scales.extend((row..4).map(|column| sigma[row] * sigma[column]));
    }
    let differences = ours.iter().zip(theirs).zip(scales);
    differences
        .map(|((ours, theirs), scale)| (ours - theirs).abs() / scale)
        .fold(0.0, f64::max)
}

fn packed(point: &TrackPoint) -> Vec<f64> {
    let mut packed = point.estimate.state().as_slice().to_vec();
    packed.extend_from_slice(point.estimate.covariance.as_deref().unwrap());
    packed
}

/// One state of one target, updated by each sensor's model in turn.
struct Follow<'v> {
    values: &'v Values,
    target: &'v str,
}

impl WithFilter for Follow<'_> {
    /// Packed, after every scan.
    type Output = Vec<Vec<f64>>;

    fn in_plane<F: Filter<4>>(self, filter: F) -> Vec<Vec<f64>> {
        let Follow { values, target } = self;
        let (first, rest) = values.scans.split_first().unwrap();
        let (model, report) = (values.model(&first.sensor_id), &first.reports[target]);
        let sigma_mps = values.initial_speed_sigma_mps;
        let start = locate(&filter, &model, &report.measurement(), sigma_mps).unwrap();
        let mut belief = filter.begin(&start);
        let (mut states, mut last_s) = (vec![Vec::new()], first.time_s);
        start.pack_into(&mut states[0]);
        for scan in rest {
            F::predict(&filter.step(scan.time_s - last_s), &mut belief);
            last_s = scan.time_s;
            if let Some(report) = scan.reports.get(target) {
                let model = values.model(&scan.sensor_id);
                update(&filter, &model, &report.measurement(), &mut belief).unwrap();
            }
            let mut state = Vec::new();
            F::kinematics(&belief).pack_into(&mut state);
            states.push(state);
        }
        states
    }

    fn in_volume<F: Filter<6>>(self, _filter: F) -> Vec<Vec<f64>> {
        panic!("the sensors are of the plane")
    }

    fn of_bearings<F: Filter<2>>(self, _filter: F) -> Vec<Vec<f64>> {
        panic!("the filters are of places")
    }
}

#[test]
fn one_state_updated_by_each_sensor_in_turn_is_that_of_stone_soup() {
    let values = Values::read();
    for name in FILTER_NAMES {
        for (target, theirs) in &values.states[name] {
            let values = &values;
            let ours = values.filter(name).with(Follow { values, target });
            assert_eq!((ours.len(), theirs.len()), (34, 34));
            for (scan, (ours, theirs)) in ours.iter().zip(theirs).enumerate() {
                let apart = apart(ours, theirs);
                assert!(apart < TOLERANCE, "{name} {target} {scan}: {apart:e}");
            }
        }
    }
}

/// The two filters differ by far more than what is tolerated, so each is told from the other.
#[test]
fn the_filters_are_not_the_same() {
    let values = Values::read();
    for (target, unscented) in &values.states["unscented"] {
        let pairs = unscented.iter().zip(&values.states["extended"][target]);
        let most = pairs
            .map(|(one, other)| apart(one, other))
            .fold(0.0, f64::max);
        assert!(most > 1e3 * TOLERANCE, "{target}: {most:e}");
    }
}

fn lifecycle(values: &Values) -> Lifecycle {
    Lifecycle {
        gate_probability: 0.99,
        initiation: Initiation::OnePoint,
        confirmation: Confirmation::MOfN,
        confirm_hits: 1,
        confirm_window: 1,
        max_missed: 5,
        max_missed_s: None,
        max_position_sigma_m: None,
        initial_speed_sigma_mps: values.initial_speed_sigma_mps,
        smoothing: None,
        merging: None,
    }
}

#[test]
fn a_tracker_believes_after_every_scan_what_stone_soup_does() {
    let values = Values::read();
    let recording = recording(&values.csv(true));
    let oracle = ASSOCIATORS
        .iter()
        .find(|entry| entry.name == "oracle")
        .unwrap();
    let sensors = recording.sensors.iter().map(|settings| Sensor {
        sensor_id: settings.sensor_id.clone(),
        p_d: 0.9,
        clutter_density: 1e-9,
        may_start: settings.sensor_id != "camera",
        report: values.model(&settings.sensor_id),
        sight: None,
    });
    let sensors: Vec<Sensor> = sensors.collect();
    for name in FILTER_NAMES {
        let mut tracker = (TRACKERS[0].build)(TrackerParts {
            filter: values.filter(name),
            associator: (oracle.build)(&json!({}), Seed { seed: 1, run: 0 }).unwrap(),
            lifecycle: lifecycle(&values),
            sensors: sensors.clone(),
            undetected: None,
            given: Vec::new(),
        });
        let mut history = History::default();
        for (index, scan) in recording.scans.iter().enumerate() {
            tracker.step(scan, &mut history, &Watch::never()).unwrap();
            let tracks = tracker.tracks();
            assert_eq!(tracks.len(), 2);
            for (track, theirs) in tracks.iter().zip(values.states[name].values()) {
                let apart = apart(&track.kinematics, &theirs[index]);
                assert!(apart < TOLERANCE, "{name} {index}: {apart:e}");
            }
        }
    }
}

/// The largest difference of a job's tracks from the values.
fn job_apart(values: &Values, name: &str, outcome: &Outcome) -> f64 {
    let set = tracks_of(outcome);
    assert_eq!(set.tracks.len(), 2, "no camera starts a track");
    let mut most = 0.0f64;
    for (track, theirs) in set.tracks.iter().zip(values.states[name].values()) {
        assert_eq!(track.points.len(), values.scans.len());
        for (point, theirs) in track.points.iter().zip(theirs) {
            most = most.max(apart(&packed(point), theirs));
        }
    }
    most
}

#[test]
fn a_job_on_a_recording_of_four_kinds_does_what_it_says() {
    let values = Values::read();
    for name in FILTER_NAMES {
        let outcome = run(&values.request(name), &values.csv(true)).unwrap();
        let most = job_apart(&values, name, &outcome);
        assert!(most < TOLERANCE, "{name}: {most:e}");
        assert_eq!(outcome.warnings, Vec::<String>::new());
        let nis = &outcome.result["association"]["nis"];
        assert_eq!(
            (&nis["dimensions"], &nis["updates"]),
            (&Value::Null, &json!(61))
        );
        let missed = tracks_of(&outcome).tracks[0].points[7].status;
        assert_eq!(missed, Some(TrackStatus::Coasted));
    }
}

#[test]
fn the_filter_that_is_left_open_takes_them_all() {
    let values = Values::read();
    let mut request = values.request("unscented");
    request["filter"] = json!({"method": "auto"});
    let outcome = run(&request, &values.csv(true)).unwrap();
    let taken = &outcome.result["association"]["taken"]["filter"]["method"];
    assert_eq!(
        (taken, tracks_of(&outcome).tracks.len()),
        (&json!("unscented"), 2)
    );
}

#[test]
fn range_rates_are_used_where_a_sensor_has_them() {
    let values = Values::read();
    let request = values.request("unscented");
    let without = run(&request, &values.csv(false)).unwrap();
    assert!(job_apart(&values, "unscented", &without) > 0.01);

    // One rate of the sensor is missing.
    let row = values
        .csv(true)
        .lines()
        .position(|row| row.contains("doppler"))
        .unwrap();
    let some = values.csv(true);
    let lines: Vec<&str> = some.lines().collect();
    let (head, _) = lines[row].rsplit_once(',').unwrap();
    let (head, _) = head.rsplit_once(',').unwrap();
    let partly = some.replace(lines[row], &format!("{head},,north"));
    let outcome = run(&request, &partly).unwrap();
    assert_eq!(
        outcome.warnings,
        ["sensor 'doppler': range rates are not used: 13 of 14 detections have one"]
    );
    assert_eq!(tracks_of(&outcome), tracks_of(&without));
}

#[test]
fn a_camera_that_sees_nothing_is_still_one() {
    let values = Values::read();
    let csv = values.csv(true);
    let mut blind = String::new();
    for row in csv.lines().filter(|row| !row.contains(",camera,")) {
        blind += row;
        blind += "\n";
        if row.starts_with("3.25,") && row.ends_with("south") {
            blind += "3.5,5,camera,,,,,,,\n";
        }
    }
    let outcome = run(&values.request("unscented"), &blind).unwrap();
    assert_eq!(tracks_of(&outcome).tracks.len(), 2);
}

/// A ship that a camera looks at before a radar does.
fn camera_first() -> Value {
    let camera = json!({"sensor_id": "camera", "x_m": -3000.0, "max_range_m": 20000.0, "p_d": 1.0, "sigma_bearing_deg": 0.1});
    let radar = json!({"sensor_id": "radar", "max_range_m": 20000.0, "p_d": 1.0, "sigma_range_m": 10.0, "sigma_bearing_deg": 0.2});
    let ship = json!({"truth_id": "a", "x_m": 1000.0, "y_m": 5000.0, "vx_mps": 10.0});
    json!({"source": "scenario", "scenario": {
        "scans": 20, "scan_period_s": 1.0, "sensors": [camera, radar], "targets": {"kind": "listed", "targets": [ship]}
    }})
}

#[test]
fn tracks_that_begin_at_truth_begin_so_where_a_camera_looks_first() {
    let request = json!({
        "input": camera_first(),
        "associator": {"method": "oracle"},
        "tracker": {"initiation": {"method": "truth", "speed_sigma_mps": 1.0}}
    });
    let plan = experiment::plan(JobKind::Associate, &request).unwrap();
    let outcome = experiment::run(&plan, Vec::new(), &mut Silent).unwrap();
    let set = tracks_of(&outcome);
    assert_eq!((set.tracks.len(), set.tracks[0].points.len()), (1, 40));
    let last = set.tracks[0].points.last().unwrap();
    let truth_m = Position::new(1000.0 + 10.0 * last.time_s, 5000.0);
    assert!(
        (last.estimate.position_m() - truth_m).norm() < 20.0,
        "{last:?}"
    );
}
