//! What other programs are given: places, instants, pieces, and what is refused. Places on the equator and on the meridian of the
//! origin are worked out by hand; that all places and files are right to other programs is checked by `tests/formats/outputs.py`.

use super::*;
use serde_json::json;
use std::collections::BTreeMap;
use trackloom_domain::formats::{WRITERS, WriteError, read_file, writer_named};
use trackloom_domain::geodesy::Stereographic;
use trackloom_domain::model::boxes::BoxSet;
use trackloom_domain::model::scan::{Detection, Measurement, RecordingParts, Scan};
use trackloom_domain::model::sensor::SensorSettings;
use trackloom_domain::model::space::{Frame, Place, Space};
use trackloom_domain::model::state::Position;
use trackloom_domain::model::time::TimeBase;
use trackloom_domain::model::track::{Kinematics, Track, TrackPoint, TrackStatus};
use trackloom_domain::model::truth::{Target, TruthPoint};

/// 2016-01-12T13:02:11.218Z.
const START_S: f64 = 1_452_603_731.218;

fn put(name: &str, dataset: &Dataset) -> Result<String, WriteError> {
    let mut bytes = Vec::new();
    let writer = writer_named(name).expect("the writer is known");
    writer.put(dataset, &mut bytes)?;
    Ok(String::from_utf8(bytes).expect("text formats are UTF-8"))
}

fn written(name: &str, dataset: &Dataset) -> String {
    put(name, dataset).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn refused(name: &str, dataset: &Dataset) -> Fault {
    match put(name, dataset) {
        Err(WriteError::Faults(faults)) => faults[0].clone(),
        other => panic!("{name}: {other:?}"),
    }
}

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).expect("it is JSON")
}

/// Points of one target: time after the start, x, y, height.
fn truth_at(frame: Option<Frame>, points: &[(f64, f64, f64, Option<f64>)]) -> Dataset {
    let point = |&(after_s, x_m, y_m, height_m): &(f64, f64, f64, Option<f64>)| TruthPoint {
        height_m,
        ..TruthPoint::in_plane(START_S + after_s, Position::new(x_m, y_m), None)
    };
    let target = Target {
        truth_id: "a<&\"".to_owned(),
        points: points.iter().map(point).collect(),
    };
    let mut truth = TruthSet::new(Space::Plane, vec![target]).expect("the truth is sound");
    truth.frame = frame;
    truth.time_base = TimeBase::Utc;
    let known = BTreeMap::from([("callsign", "KLM1302".to_owned())]);
    truth.attributes.insert("a<&\"".to_owned(), known);
    Dataset::Truth(truth)
}

fn at(lat_deg: f64, lon_deg: f64) -> Option<Frame> {
    Some(Frame::new(lat_deg, lon_deg, 0.0).expect("it is on the Earth"))
}

#[test]
fn names_are_unique_and_kinds_that_a_format_lacks_are_refused_with_those_that_have_them() {
    for writer in WRITERS {
        let same = WRITERS.iter().filter(|other| other.name == writer.name);
        assert_eq!(same.count(), 1, "{}", writer.name);
        assert!(!writer.kinds.is_empty() && !writer.extension.contains('.'));
    }
    let recording = Dataset::Detections(Recording::default());
    let fault = refused("gpx", &recording);
    assert_eq!(
        (fault.code.as_str(), fault.pointer.as_str()),
        ("unsupported", "/format")
    );
    let allowed = fault.allowed.unwrap_or_default();
    assert!(
        allowed.starts_with("csv, json, geojson, kml, "),
        "{allowed}"
    );
    let boxes = Dataset::TruthBoxes(BoxSet::new(Vec::new(), Vec::new()).expect("no boxes"));
    for name in ["geojson", "kml", "czml", "gpx", "stonesoup"] {
        assert_eq!(refused(name, &boxes).code, "unsupported", "{name}");
    }
    assert_eq!(written("mot", &boxes), "");
    let truth = truth_at(at(0.0, 0.0), &[(0.0, 0.0, 0.0, None)]);
    assert_eq!(refused("mot", &truth).code, "unsupported");
}

#[test]
fn without_an_origin_there_are_no_latitudes() {
    let truth = truth_at(None, &[(0.0, 1.0, 2.0, None)]);
    for name in ["geojson", "trips", "kml", "czml", "gpx"] {
        let fault = refused(name, &truth);
        assert_eq!(fault.code, "no_frame", "{name}");
        assert!(fault.allowed.unwrap_or_default().contains("`origin`"));
    }
    let far = truth_at(at(0.0, 0.0), &[(0.0, f64::MAX, f64::MAX, None)]);
    assert_eq!(refused("geojson", &far).code, "out_of_range");
    let late = truth_at(at(0.0, 0.0), &[(1e18, 0.0, 0.0, None)]);
    assert_eq!(refused("geojson", &late).code, "out_of_range");
}

/// A degree of the equator is pi a/180 = 111 319.490 793 m long; 1 km along it is 0.0089831528 degrees, and the projection about a
/// point of the equator changes that by less than 1e-9 of it.
#[test]
fn lines_have_places_heights_and_instants() {
    let truth = truth_at(
        at(0.0, 10.0),
        &[
            (0.0, 0.0, 0.0, None),
            (10.0, 1000.0, 0.0, Some(120.5)),
            (20.25, 2000.0, 0.0, None),
        ],
    );
    let geojson = json(&written("geojson", &truth));
    let feature = &geojson["features"][0];
    assert_eq!(feature["geometry"]["type"], "LineString");
    // Points without a height take that of a neighbour.
    let wanted = json("[[10,0,120.5],[10.0089832,0,120.5],[10.0179663,0,120.5]]");
    let found = &feature["geometry"]["coordinates"];
    for (one, other) in found
        .as_array()
        .into_iter()
        .flatten()
        .zip(wanted.as_array().into_iter().flatten())
    {
        for axis in 0..3 {
            let difference = one[axis]
                .as_f64()
                .zip(other[axis].as_f64())
                .map(|(a, b)| a - b);
            assert!(difference.is_some_and(|far| far.abs() < 1e-9), "{found}");
        }
    }
    let known = &feature["properties"];
    assert_eq!(
        (&known["truth_id"], &known["callsign"]),
        (&json("\"a<&\\\"\""), &json("\"KLM1302\""))
    );
    assert_eq!(known["start"], "2016-01-12T13:02:11.218Z");
    assert_eq!(known["coordTimes"][2], "2016-01-12T13:02:31.468Z");
    assert_eq!(known["altitude_reference"], "unknown");
    assert!(known.get("time_base").is_none());
    let trips = json(&written("trips", &truth));
    assert_eq!(
        trips["features"][0]["geometry"]["coordinates"][2][3],
        1_452_603_751.468
    );
}

#[test]
fn a_line_over_180_degrees_is_cut_there_on_both_sides() {
    // Half way at 180 degrees, as it runs along the equator.
    let truth = truth_at(
        at(0.0, 180.0),
        &[
            (0.0, -1000.0, 0.0, None),
            (10.0, 1000.0, 0.0, None),
            (20.0, 2000.0, 0.0, None),
        ],
    );
    let geojson = json(&written("geojson", &truth));
    let feature = &geojson["features"][0];
    assert_eq!(feature["geometry"]["type"], "MultiLineString");
    let lines = feature["geometry"]["coordinates"].clone();
    assert_eq!(lines[0], json("[[179.9910168,0],[180,0]]"));
    assert_eq!(
        lines[1],
        json("[[-180,0],[-179.9910168,0],[-179.9820337,0]]")
    );
    let times = &feature["properties"]["coordTimes"];
    assert_eq!(times[0][1], "2016-01-12T13:02:16.218Z");
    assert_eq!(
        (&times[0][1], times[1].as_array().map(Vec::len)),
        (&times[1][0], Some(3))
    );
    // On the line itself the schema of GPX has one side alone.
    let edge = truth_at(at(0.0, 180.0), &[(0.0, 0.0, 0.0, None)]);
    assert!(written("gpx", &edge).contains("lat=\"0\" lon=\"-180\""));
}

#[test]
fn silence_divides_a_path_and_a_lone_point_is_one() {
    let points = [
        (0.0, 0.0, 0.0, None),
        (10.0, 5.0, 0.0, None),
        (1000.0, 9.0, 0.0, None),
    ];
    let truth = truth_at(at(0.0, 0.0), &points);
    let feature = json(&written("geojson", &truth))["features"][0].clone();
    let lines = feature["geometry"]["coordinates"]
        .as_array()
        .cloned()
        .unwrap_or_default();
    assert_eq!(
        lines
            .iter()
            .map(|line| line.as_array().map(Vec::len))
            .collect::<Vec<_>>(),
        [Some(2), Some(2)]
    );
    assert_eq!(lines[1][0], lines[1][1]);
    assert_eq!(written("gpx", &truth).matches("<trkseg>").count(), 2);
    assert_eq!(written("kml", &truth).matches("<gx:Track>").count(), 2);
    let czml = json(&written("czml", &truth));
    assert_eq!(
        czml[1]["availability"][1],
        "2016-01-12T13:18:51.218Z/2016-01-12T13:18:51.218Z"
    );
    let positions = czml[1]["position"]["cartographicDegrees"]
        .as_array()
        .map(Vec::len);
    assert_eq!(
        (positions, &czml[1]["position"]["epoch"]),
        (Some(12), &json("\"2016-01-12T13:02:11.218Z\""))
    );
    let lone = truth_at(at(0.0, 0.0), &points[..1]);
    let feature = json(&written("geojson", &lone))["features"][0].clone();
    assert_eq!(
        feature["geometry"],
        json("{\"type\":\"Point\",\"coordinates\":[0,0]}")
    );
}

#[test]
fn markup_says_names_and_where_there_are_no_heights_lies_on_the_ground() {
    let points = [(0.0, 0.0, 0.0, None), (10.0, 0.0, 0.0, None)];
    let truth = truth_at(at(0.0, 0.0), &points);
    let kml = written("kml", &truth);
    assert!(
        kml.contains("<name>KLM1302</name>") && kml.contains("<value>a&lt;&amp;&quot;</value>")
    );
    assert!(kml.contains("clampToGround") && !kml.contains("absolute"));
    let high = truth_at(at(0.0, 0.0), &[(0.0, 0.0, 0.0, Some(9.0))]);
    assert!(written("kml", &high).contains("<altitudeMode>absolute</altitudeMode>"));
    assert!(written("gpx", &high).contains("<ele>9</ele>"));
    assert!(!written("gpx", &truth).contains("<ele>"));
    assert!(!kml.contains("relative"));
    let mut counted = truth;
    counted.set_time_base(TimeBase::Relative);
    for name in ["kml", "czml", "gpx", "geojson"] {
        assert!(written(name, &counted).contains("relative"), "{name}");
    }
}

/// A radar at (0, 0) and a camera that sees bearings alone.
fn recording() -> RecordingParts {
    let seen = |measurement| Detection {
        measurement,
        origin: None,
        amplitude: None,
    };
    let scan = |number, sensor, detections| Scan {
        number,
        time_s: f64::from(number),
        sensor,
        pose: None,
        own: Vec::new(),
        detections,
    };
    let half_right = std::f64::consts::FRAC_PI_2;
    RecordingParts {
        frame: at(0.0, 10.0),
        sensors: vec![
            SensorSettings::named("camera"),
            SensorSettings::named("radar"),
        ],
        scans: vec![
            scan(
                1,
                0,
                vec![seen(Measurement::Bearing {
                    bearing_rad: 0.25 * std::f64::consts::PI,
                })],
            ),
            scan(
                2,
                1,
                vec![
                    seen(Measurement::RangeBearing {
                        range_m: 1000.0,
                        bearing_rad: half_right,
                        range_rate_mps: None,
                    }),
                    seen(Measurement::Position {
                        x_m: 2000.0,
                        y_m: 0.0,
                    }),
                ],
            ),
        ],
        detection_ids: ["1", "2", "3"].map(str::to_owned).to_vec(),
        ..RecordingParts::default()
    }
}

fn checked(parts: RecordingParts) -> Dataset {
    Dataset::Detections(Recording::new(parts).expect("the recording is sound"))
}

#[test]
fn detections_are_points_where_they_have_a_place() {
    let mut dataset = checked(recording());
    let fault = refused("geojson", &dataset);
    assert!(fault.detail.contains("'radar'"), "{fault}");
    dataset.describe_sensors(&[SensorSettings {
        x_m: Some(0.0),
        y_m: Some(0.0),
        ..SensorSettings::named("radar")
    }]);
    let features = json(&written("geojson", &dataset))["features"].clone();
    assert_eq!(features[0]["geometry"], serde_json::Value::Null);
    assert_eq!(features[0]["properties"]["bearing_deg"], 45.0);
    assert_eq!(
        features[1]["geometry"]["coordinates"],
        json("[10.0089832,0]")
    );
    assert_eq!(
        features[2]["geometry"]["coordinates"],
        json("[10.0179663,0]")
    );
    assert_eq!(written("kml", &dataset).matches("<Point>").count(), 2);
}

#[test]
fn stone_soup_has_a_file_for_each_way_to_measure_and_no_empty_cell() {
    let dataset = checked(recording());
    assert_eq!(
        written("stonesoup", &dataset),
        "time_s,x_m,y_m,sensor_id,scan,detection_id\n2,2000,0,radar,2,3\n"
    );
    // East is 0 there.
    assert_eq!(
        written("stonesoup_polar", &dataset),
        "time_s,bearing_rad,range_m,sensor_id,scan,detection_id\n2,0,1000,radar,2,2\n"
    );
    let bearings = written("stonesoup_bearings", &dataset);
    assert!(
        bearings.ends_with("\n1,0.7853981633974483,camera,1,1\n"),
        "{bearings}"
    );
    let mut parts = recording();
    parts.scans[1].detections.remove(0);
    parts.detection_ids.pop();
    let fault = refused("stonesoup_polar", &checked(parts));
    assert_eq!(
        fault.allowed.as_deref(),
        Some("stonesoup, stonesoup_bearings")
    );
}

#[test]
fn tracks_of_stone_soup_are_sorted_by_time_and_a_column_is_full_or_absent() {
    let point = |time_s, velocity: Option<Place>| TrackPoint {
        time_s,
        sensor: None,
        estimate: Kinematics {
            position: Place::new(time_s, 1.0, 0.0),
            velocity,
            covariance: None,
        },
        height_m: None,
        status: Some(TrackStatus::Confirmed),
        nis: None,
        known_at_s: None,
        existence: None,
        mode_row: None,
        first_candidate: 0,
        candidates: 0,
    };
    let velocity = Some(Place::new(1.0, 2.0, 0.0));
    let track = |track_id: &str, points| Track {
        track_id: track_id.to_owned(),
        points,
    };
    let mut set = TrackSet {
        tracks: vec![
            track("1", vec![point(0.0, velocity), point(2.0, velocity)]),
            track("2", vec![point(1.0, velocity)]),
        ],
        ..TrackSet::default()
    };
    assert_eq!(
        written("stonesoup", &Dataset::Tracks(set.clone())),
        "time_s,track_id,x_m,y_m,vx_mps,vy_mps,status\n0,1,0,1,1,2,confirmed\n1,2,1,1,1,2,confirmed\n2,1,2,1,1,2,confirmed\n"
    );
    set.tracks[1].points[0].estimate.velocity = None;
    let text = written("stonesoup", &Dataset::Tracks(set));
    assert!(
        text.starts_with("time_s,track_id,x_m,y_m,status\n0,1,0,1,confirmed\n"),
        "{text}"
    );
}

#[test]
fn a_volume_has_heights_above_the_ellipsoid() {
    let point = TruthPoint {
        height_m: None,
        time_s: START_S,
        position: Place::new(0.0, 0.0, 500.0),
        velocity: None,
    };
    let target = Target {
        truth_id: "a".to_owned(),
        points: vec![point],
    };
    let mut truth = TruthSet::new(Space::Volume, vec![target]).expect("the truth is sound");
    truth.frame = Some(Frame::new(45.0, 10.0, 100.0).expect("it is on the Earth"));
    let geojson = json(&written("geojson", &Dataset::Truth(truth)));
    let feature = &geojson["features"][0];
    assert_eq!(feature["geometry"]["coordinates"], json("[10,45,600]"));
    assert_eq!(feature["properties"]["altitude_reference"], "ellipsoid");
}

#[test]
fn tracks_written_as_asterix_are_read_again() {
    let text = "time_s,track_id,lat_deg,lon_deg,speed_mps,course_deg,address,callsign\n\
        1700000000,A,50.1,-1.2,200,90,4ca7a8,RYR174C\n1700000004,A,50.1,-1.19,200,90,4ca7a8,RYR174C\n\
        1700000001,B,50.2,-1.3,100,0,,\n";
    let options = ReadOptions {
        options: serde_json::from_value(json!({"time_base": "utc"})).unwrap(),
        ..ReadOptions::default()
    };
    let (read, _) = read_file("a.csv", &mut text.as_bytes(), None, &options).unwrap();
    let mut bytes = Vec::new();
    writer_named("asterix")
        .unwrap()
        .put(&read.dataset, &mut bytes)
        .unwrap();
    let told = ReadOptions {
        options: serde_json::from_value(json!({"date": "2023-11-14"})).unwrap(),
        ..ReadOptions::default()
    };
    let (again, format) = read_file("a.ast", &mut bytes.as_slice(), None, &told).unwrap();
    assert_eq!(format.name, "asterix");
    let Dataset::Tracks(set) = again.dataset else {
        panic!("not tracks");
    };
    assert_eq!(set.tracks.len(), 2);
    let [first, second] = [&set.tracks[0], &set.tracks[1]];
    assert_eq!((first.points.len(), second.points.len()), (2, 1));
    // Times are of 1/128 s, places of 180/2^25 degrees: half a metre; velocities of 0.25 m/s.
    assert!((first.points[1].time_s - 1_700_000_004.0).abs() < 1.0 / 128.0);
    let frame = set.frame.unwrap();
    let plane = Stereographic::about(frame.latitude_deg(), frame.longitude_deg());
    let (lat_deg, lon_deg) = plane.unproject(&first.points[1].estimate.position.xy());
    assert!(
        (lat_deg - 50.1).abs() < 6e-6 && (lon_deg + 1.19).abs() < 6e-6,
        "{lat_deg} {lon_deg}"
    );
    let velocity = first.points[0].estimate.velocity.unwrap();
    assert!(
        (velocity.x - 200.0).abs() < 1.0 && velocity.y.abs() < 1.5,
        "{velocity}"
    );
    let known = &set.attributes[&first.track_id];
    assert_eq!(
        (
            known["address"].to_lowercase().as_str(),
            known["callsign"].as_str()
        ),
        ("4ca7a8", "RYR174C")
    );
}
