//! The autoferry recordings: the one shipped with trackloom, broken ones, and more where the machine has them.

use super::*;
use std::path::{Path, PathBuf};
use trackloom_domain::formats::{detect_format, write_csv};
use trackloom_domain::model::scan::{Detection, Measurement, Scan};
use trackloom_domain::model::space::{Place, Space};

fn example(file: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("..")
        .join("examples/data/autoferry-scenario2")
        .join(file);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Scans and detections of one sensor.
fn counts(recording: &Recording, sensor_id: &str) -> (usize, usize) {
    let of_sensor = |scan: &&Scan| recording.sensors[scan.sensor].sensor_id == sensor_id;
    let scans: Vec<&Scan> = recording.scans.iter().filter(of_sensor).collect();
    (
        scans.len(),
        scans.iter().map(|scan| scan.detections.len()).sum(),
    )
}

#[test]
fn the_example_has_its_scans_and_detections() {
    let outcome = read("autoferry", example("detections.json")).expect("the example is sound");
    assert_eq!(outcome.warnings, Vec::<String>::new());
    let all = recording(outcome);
    let names: Vec<&str> = all
        .sensors
        .iter()
        .map(|sensor| sensor.sensor_id.as_str())
        .collect();
    assert_eq!(names, ["daylight", "infrared", "lidar", "radar"]);
    assert_eq!(
        (counts(&all, "daylight"), counts(&all, "infrared")),
        ((591, 1944), (1012, 1446))
    );
    let recording = all
        .only_sensors(&["lidar".to_owned(), "radar".to_owned()])
        .expect("both are there");
    assert_eq!(counts(&recording, "radar"), (70, 437));
    assert_eq!(counts(&recording, "lidar"), (234, 412));
    assert!(!recording.origins_known);
    let index = recording.index_detections();
    let seen = |scan: usize| {
        let Scan { time_s, sensor, .. } = recording.scans[scan];
        (time_s, sensor, index.range(scan))
    };
    assert_eq!(seen(0), (1620114892.18751, 0, 0..0));
    // The fourth scan is one flat pair [99.17898933497725, 33.99357416508701] from [-16.73468391505537, -391.2043895947745].
    assert_eq!(seen(3), (1620114893.197112, 0, 3..4));
    assert_eq!(recording.detection_ids[3], "lidar-3-1");
    assert_close(
        index.get(3).unwrap().measurement,
        -357.2108154296875,
        82.44430541992188,
    );
    // The twelfth radar scan has norths -111.2628…, 76.4863… and easts -176.5955…, 7.0700… from [-17.6414…, -399.1834…].
    let twelfth = recording
        .detection_ids
        .iter()
        .position(|id| id == "radar-12-1")
        .expect("radar scan 12 has detections");
    assert_close(
        index.get(twelfth).unwrap().measurement,
        -575.7789916992188,
        -128.9042510986328,
    );
    assert_eq!(recording.detection_ids[twelfth + 1], "radar-12-2");
    assert_eq!(index.range(50), twelfth..twelfth + 2);
}

#[test]
fn a_camera_reports_one_bare_bearing_or_a_list_all_round() {
    let text = r#"[{"sensorID": 3, "ownshipPosition": [5, 7], "time": 1, "measurement": 0.5},
        {"sensorID": 4, "ownshipPosition": [5, 7], "time": 1, "measurement": [-0.25, 3]},
        {"sensorID": 4, "ownshipPosition": [5, 7], "time": 2, "measurement": []}]"#;
    let recording = recording(read("autoferry", text).expect("sound"));
    let bearings: Vec<f64> = recording
        .detections()
        .filter_map(|detection| bearing_rad(&detection.measurement))
        .collect();
    assert_eq!(bearings, [std::f64::consts::TAU - 0.25, 3.0, 0.5]);
    assert_eq!(
        recording.detection_ids,
        ["daylight-1-1", "daylight-1-2", "infrared-1-1"]
    );
    assert_eq!(
        recording
            .scans
            .iter()
            .map(|scan| (scan.sensor, scan.detections.len()))
            .collect::<Vec<_>>(),
        [(0, 2), (1, 1), (0, 0)]
    );
    let positions =
        r#"[{"sensorID": 4, "ownshipPosition": [0, 0], "time": 1, "measurement": [[1], [2]]}]"#;
    let expected = Fault::new(
        "/file/0/measurement",
        "wrong_type",
        "expected a bearing in radians or a list of bearings",
    );
    assert_eq!(fault("autoferry", positions), expected);
}

fn bearing_rad(measurement: &Measurement) -> Option<f64> {
    if let Measurement::Bearing { bearing_rad } = *measurement {
        Some(bearing_rad)
    } else {
        None
    }
}

fn assert_close(measurement: Measurement, x_m: f64, y_m: f64) {
    let found = measurement.position().expect("a position report");
    assert!(
        (found.x - x_m).abs() < 1e-9 && (found.y - y_m).abs() < 1e-9,
        "found {found}, expected {x_m}, {y_m}"
    );
}

#[test]
fn the_example_has_its_truth() {
    let outcome = read("autoferry", example("groundTruth.json")).expect("the example is sound");
    let truth = truth(outcome);
    let [one, two] = truth.targets() else {
        panic!("two targets")
    };
    assert_eq!((one.truth_id.as_str(), one.points.len()), ("1", 1554));
    assert_eq!((two.truth_id.as_str(), two.points.len()), ("2", 591));
    let (start, end) = (one.points[0], two.points[590]);
    assert_eq!(
        (start.time_s, start.position),
        (
            1620114891.88,
            Place::new(-354.7959646839322, 84.63510099212183, 0.0)
        )
    );
    assert_eq!(
        (end.time_s, end.position),
        (
            1620115009.8,
            Place::new(-388.6721345894895, 29.428033521882423, 0.0)
        )
    );
}

#[test]
fn radar_and_truth_are_in_one_frame() {
    let truth = truth(read("autoferry", example("groundTruth.json")).expect("sound"));
    let recording = recording(read("autoferry", example("detections.json")).expect("sound"));
    let radar = recording
        .only_sensors(&["radar".to_owned()])
        .expect("there is a radar");
    let mut near = 0;
    for scan in &radar.scans {
        let Some(target) = truth.targets()[1].position_at(Space::Plane, scan.time_s, 2.0) else {
            continue;
        };
        let distances = scan
            .detections
            .iter()
            .filter_map(|found| found.measurement.position())
            .map(|at| (at - target.xy()).norm());
        near += usize::from(distances.fold(f64::INFINITY, f64::min) < 10.0);
    }
    assert!(
        near > 50,
        "the second boat is near a radar detection in {near} of 70 scans"
    );
}

#[test]
fn wrong_shapes_are_named_with_their_place() {
    let text = r#"[{"sensorID": 2, "ownshipPosition": [0, 0], "time": 1, "measurement": [[1, 2], [3]]},
        {"sensorID": 1, "ownshipPosition": [0], "time": "late", "measurement": [1, 2, 3]},
        {"sensorID": 9, "ownshipPosition": [0, 0], "time": 1, "measurement": []},
        {"ownshipPosition": [0, 0], "time": 1, "measurement": []},
        {"sensorID": 2, "ownshipPosition": [0, 0], "time": 3, "measurement": []},
        {"sensorID": 2, "ownshipPosition": [0, 0], "time": 3, "measurement": []}, 4]"#;
    let measurement = "expected [], [north, east] or [[norths], [easts]] of equal length";
    assert_eq!(
        read("autoferry", text).expect_err("eight faults"),
        [
            Fault::new("/file/0/measurement", "wrong_type", measurement),
            Fault::new("/file/1/time", "wrong_type", "expected a time in seconds"),
            Fault::new(
                "/file/1/ownshipPosition",
                "wrong_type",
                "expected [north, east]"
            ),
            Fault::new("/file/1/measurement", "wrong_type", measurement),
            Fault::new("/file/2/sensorID", "unknown_value", "there is no sensor 9")
                .allowing("1, 2, 3, 4"),
            Fault::new(
                "/file/3/sensorID",
                "wrong_type",
                "expected a sensor's number"
            )
            .allowing("1, 2, 3, 4"),
            Fault::new(
                "/file/6/sensorID",
                "wrong_type",
                "expected a sensor's number"
            )
            .allowing("1, 2, 3, 4"),
            Fault::new(
                "/file/5/time",
                "conflict",
                "the radar has another scan at 3 s: item 4"
            ),
        ]
    );
}

#[test]
fn truth_that_contradicts_itself_is_named() {
    let entry = |time: f64, north: f64| {
        format!(r#"{{"targetID": 3, "position": [{north}, 1, 0], "time": {time}}}"#)
    };
    let text = format!(
        "[[{}, {}], [{}]]",
        entry(2.0, 5.0),
        entry(1.0, 4.0),
        entry(2.0, 6.0)
    );
    let expected = Fault::new(
        "/file/1/0/position",
        "conflict",
        "target 3 is at two positions at 2 s",
    );
    assert_eq!(fault("autoferry", text), expected);
    let sound = format!(
        "[[{}, {}], [{}]]",
        entry(2.0, 5.0),
        entry(1.0, 4.0),
        entry(2.0, 5.0)
    );
    let truth = truth(read("autoferry", sound).expect("repeats are no fault"));
    assert_eq!(
        truth.targets()[0]
            .points
            .iter()
            .map(|point| point.time_s)
            .collect::<Vec<_>>(),
        [1.0, 2.0]
    );
}

#[test]
fn other_documents_are_refused() {
    let wrong = |text: &str| {
        (
            fault("autoferry", text).pointer,
            fault("autoferry", text).code,
        )
    };
    assert_eq!(wrong("{}"), ("/file".to_owned(), "wrong_type".to_owned()));
    assert_eq!(wrong("[]"), ("/file".to_owned(), "empty".to_owned()));
    assert_eq!(
        wrong("[1]"),
        ("/file/0".to_owned(), "wrong_type".to_owned())
    );
    assert_eq!(
        wrong("[[], {}]"),
        ("/file/1".to_owned(), "wrong_type".to_owned())
    );
    let cut = fault("autoferry", "[{\"sensorID\": 2,\n\"time\": 1");
    assert_eq!(
        (cut.code.as_str(), cut.line, cut.column.as_deref()),
        ("malformed", Some(2), Some("9"))
    );
    let faults = read_with("autoferry", "[[]]", &of_kind(DatasetKind::Detections))
        .expect_err("it holds truth");
    assert_eq!(
        faults,
        [Fault::new(
            "/meta/kind",
            "conflict",
            "the file holds truth, not detections"
        )]
    );
}

/// Scans and detections of every recording in `$TRACKLOOM_DATA/autoferry`.
#[test]
fn more_recordings_have_their_scans_and_detections() {
    let Some(folder) =
        std::env::var_os("TRACKLOOM_DATA").map(|folder| PathBuf::from(folder).join("autoferry"))
    else {
        println!("skipped: TRACKLOOM_DATA names no folder with recordings");
        return;
    };
    for (scenario, lidar, radar, infrared, daylight) in [
        (2, (234, 412), (70, 437), (1012, 1446), (591, 1944)),
        (3, (259, 407), (78, 394), (1117, 1529), (653, 996)),
        (4, (197, 392), (59, 277), (851, 652), (497, 953)),
        (5, (276, 375), (83, 443), (2197, 3587), (694, 1267)),
        (6, (302, 667), (91, 495), (1303, 1323), (761, 1241)),
        (17, (157, 102), (48, 191), (680, 3672), (397, 6224)),
    ] {
        let load = |what: &str| {
            std::fs::read(folder.join(format!("scenario{scenario}_{what}.json")))
                .expect("the folder has the file")
        };
        let bytes = load("detections");
        assert_eq!(
            detect_format("detections.json", &bytes[..100]).map(|format| format.name),
            Some("autoferry")
        );
        let outcome = read("autoferry", bytes).expect("the recording is sound");
        let all = recording(outcome);
        let counted =
            ["lidar", "radar", "infrared", "daylight"].map(|sensor_id| counts(&all, sensor_id));
        assert_eq!(
            counted,
            [lidar, radar, infrared, daylight],
            "scenario {scenario}"
        );
        let mut csv = Vec::new();
        write_csv(&Dataset::Detections(all.clone()), &mut csv).expect("a Vec takes any bytes");
        let again = self::recording(read("csv", csv).expect("what is written can be read"));
        // Bearings are written in degrees, which rounds them.
        let is_kept = |(written, found): (&Detection, &Detection)| match (
            written.measurement,
            found.measurement,
        ) {
            (
                Measurement::Bearing {
                    bearing_rad: written,
                },
                Measurement::Bearing { bearing_rad: found },
            ) => (written - found).abs() < 1e-14,
            (written, found) => written == found,
        };
        assert!(
            all.detections().zip(again.detections()).all(is_kept),
            "scenario {scenario}"
        );
        let of_scans = |recording: &Recording| -> Vec<_> {
            let scans = recording.scans.iter();
            scans
                .map(|scan| (scan.number, scan.time_s, scan.sensor, scan.detections.len()))
                .collect()
        };
        assert!(
            (of_scans(&all), &all.detection_ids) == (of_scans(&again), &again.detection_ids),
            "scenario {scenario}"
        );
        assert_eq!(
            truth(read("autoferry", load("groundTruth")).expect("sound"))
                .targets()
                .len(),
            2
        );
    }
}
