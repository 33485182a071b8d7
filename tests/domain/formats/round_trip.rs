//! What is written reads back as the same dataset, and no bytes make a reader panic.

use super::*;
use nalgebra::{Matrix2, Matrix6};
use proptest::prelude::*;
use std::collections::BTreeSet;
use trackloom_domain::formats::{FORMATS, write_csv, write_json};
use trackloom_domain::model::modes::ModeTable;
use trackloom_domain::model::names::{name_fault, natural_order};
use trackloom_domain::model::own::{Own, OwnNoise, whole};
use trackloom_domain::model::scan::{Detection, Measurement, RecordingParts, Scan};
use trackloom_domain::model::sensor::SensorSettings;
use trackloom_domain::model::space::{Place, Space};
use trackloom_domain::model::state::upper_triangle;
use trackloom_domain::model::state::{Covariance, Position, State};
use trackloom_domain::model::time::TimeBase;
use trackloom_domain::model::track::{Candidate, Kinematics, Track, TrackPoint, TrackStatus};
use trackloom_domain::model::truth::{Target, TruthPoint};

fn check(dataset: &Dataset) {
    check_as_it_is(dataset);
    if dataset.summary().end_s.is_some() {
        for base in [TimeBase::Utc, TimeBase::AssumedDate] {
            let mut dataset = dataset.clone();
            dataset.set_time_base(base);
            check_as_it_is(&dataset);
        }
    }
}

fn check_as_it_is(dataset: &Dataset) {
    let (mut csv, mut json) = (Vec::new(), Vec::new());
    write_csv(dataset, &mut csv).expect("a Vec takes any bytes");
    write_json(dataset, &mut json).expect("a Vec takes any bytes");
    for (format, bytes) in [("csv", &csv), ("json", &json)] {
        let text = String::from_utf8_lossy(bytes);
        let outcome = read_with(format, bytes, &of_kind(dataset.kind()))
            .unwrap_or_else(|faults| panic!("{faults:#?}\n{text}"));
        assert_eq!(outcome.dataset, *dataset, "{text}");
    }
}

/// Any finite number, with the extremes.
fn number() -> impl Strategy<Value = f64> {
    let extremes = prop_oneof![
        Just(0.0),
        Just(f64::MAX),
        Just(f64::MIN_POSITIVE),
        Just(5e-324),
        Just(-1e-5),
        Just(1e16),
        Just(0.1)
    ];
    prop_oneof![4 => -1e6..1e6, 2 => prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL, 1 => extremes]
}

/// A name with all that CSV and JSON must protect.
fn name() -> impl Strategy<Value = String> {
    let odd = prop::sample::select(vec![
        "a", "7", "10", "T-2", "-1.5", "+", "=", " ", ",", "\"", "\n", "\\", "é", "null", "NaN",
        "'", "\t", ";",
    ]);
    prop::collection::vec(odd, 1..4)
        .prop_map(|parts| parts.concat())
        .prop_filter("a formula", |name| name_fault(name).is_none())
}

/// Different names in natural order.
fn names(count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<String>> {
    prop::collection::btree_set(name(), count).prop_map(|names| {
        let mut names: Vec<String> = names.into_iter().collect();
        names.sort_by(|a, b| natural_order(a, b));
        names
    })
}

fn times(count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(number(), count).prop_map(|mut times| {
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    })
}

fn measurement() -> impl Strategy<Value = Measurement> {
    prop_oneof![
        (number(), number()).prop_map(|(x_m, y_m)| Measurement::Position { x_m, y_m }),
        (
            number().prop_map(f64::abs),
            -400.0..400.0,
            prop::option::of(number())
        )
            .prop_map(
                |(range_m, bearing, range_rate_mps): (f64, f64, Option<f64>)| {
                    Measurement::RangeBearing {
                        range_m,
                        bearing_rad: bearing.to_radians(),
                        range_rate_mps,
                    }
                }
            ),
        (-400.0..400.0).prop_map(|bearing: f64| Measurement::Bearing {
            bearing_rad: bearing.to_radians()
        }),
    ]
}

/// Angles are read in degrees, which not every radian survives: there are none.
fn own() -> impl Strategy<Value = Own> {
    let sigma = || prop::option::weighted(0.2, 1e-3..1e6);
    let velocity = prop::option::weighted(0.2, [number(), number()]);
    let correlation = prop::option::weighted(0.2, -0.99..0.99);
    (sigma(), sigma(), correlation, sigma(), velocity).prop_map(
        |(sigma_x_m, sigma_range_m, correlation_xy, sigma_speed_mps, velocity_mps)| Own {
            after_s: 0.0,
            noise: OwnNoise {
                sigma_x_m,
                sigma_range_m,
                correlation_xy,
                sigma_speed_mps,
                ..OwnNoise::default()
            },
            velocity_mps,
        },
    )
}

type RawDetection = (
    Measurement,
    Option<prop::sample::Index>,
    String,
    Option<f64>,
    Own,
);
type RawScan = (prop::sample::Index, u32, Vec<RawDetection>);

fn raw_scan() -> impl Strategy<Value = RawScan> {
    let detection = (
        measurement(),
        prop::option::of(any::<prop::sample::Index>()),
        name(),
        prop::option::weighted(0.2, number()),
        own(),
    );
    (
        any::<prop::sample::Index>(),
        1..5_u32,
        prop::collection::vec(detection, 0..4),
    )
}

/// A recording whose sensors and targets all occur, as every one that was read from CSV.
fn assemble(
    sensors: Vec<String>,
    targets: Vec<String>,
    times: Vec<f64>,
    raw: Vec<RawScan>,
    origins_known: bool,
) -> Recording {
    let mut parts = RecordingParts {
        origins_known,
        ..Default::default()
    };
    let used_sensors: BTreeSet<usize> = times
        .iter()
        .zip(&raw)
        .map(|(_, scan)| scan.0.index(sensors.len()))
        .collect();
    let used_sensors: Vec<usize> = used_sensors.into_iter().collect();
    let mut used_targets = BTreeSet::new();
    let mut number = 0;
    for (time_s, (sensor, step, detections)) in times.into_iter().zip(raw) {
        let sensor = used_sensors
            .binary_search(&sensor.index(sensors.len()))
            .expect("it was collected above");
        number = if used_sensors.len() == 1 {
            number + step
        } else {
            number + 1
        };
        let mut scan = Scan {
            number,
            time_s,
            sensor,
            pose: None,
            own: Vec::new(),
            detections: Vec::new(),
        };
        for (nth, (measurement, origin, id, amplitude, own)) in detections.into_iter().enumerate() {
            scan.own.push(own);
            let origin = origin
                .filter(|_| origins_known)
                .map(|origin| origin.index(targets.len()) as u32);
            used_targets.extend(origin);
            scan.detections.push(Detection {
                measurement,
                origin,
                amplitude,
            });
            parts.detection_ids.push(format!("{id}{nth}"));
        }
        scan.own = whole(scan.own);
        parts.scans.push(scan);
    }
    let used_targets: Vec<u32> = used_targets.into_iter().collect();
    for detection in parts.scans.iter_mut().flat_map(|scan| &mut scan.detections) {
        detection.origin = detection.origin.map(|origin| {
            used_targets
                .iter()
                .position(|&used| used == origin)
                .expect("collected") as u32
        });
    }
    parts.sensors = used_sensors
        .into_iter()
        .map(|sensor| SensorSettings::named(&sensors[sensor]))
        .collect();
    parts.targets = used_targets
        .into_iter()
        .map(|target| targets[target as usize].clone())
        .collect();
    Recording::new(parts).expect("it is made to be sound")
}

/// A position and a velocity.
type RawTruthPoint = ((f64, f64), Option<(f64, f64)>);

fn truth_set() -> impl Strategy<Value = TruthSet> {
    let velocity = prop::option::of((number(), number()));
    let path = (
        times(1..5),
        prop::collection::vec(((number(), number()), velocity), 5),
    );
    (names(0..4), prop::collection::vec(path, 4)).prop_map(|(names, paths)| {
        let target = |(truth_id, (times, points)): (String, (Vec<f64>, Vec<_>))| {
            let point = |(time_s, ((x, y), velocity)): (f64, RawTruthPoint)| {
                TruthPoint::in_plane(
                    time_s,
                    Position::new(x, y),
                    velocity.map(|(vx, vy)| Position::new(vx, vy)),
                )
            };
            Target {
                truth_id,
                points: times.into_iter().zip(points).map(point).collect(),
            }
        };
        TruthSet::new(
            Space::Plane,
            names.into_iter().zip(paths).map(target).collect(),
        )
        .expect("it is made to be sound")
    })
}

/// A point and its candidates: how many detections, whether ε, and whether a sensor is named.
type RawPoint = (
    [f64; 4],
    bool,
    Option<[f64; 4]>,
    Option<usize>,
    (usize, bool),
    bool,
);

fn raw_point() -> impl Strategy<Value = RawPoint> {
    let numbers = || [number(), number(), number(), number()];
    (
        numbers(),
        any::<bool>(),
        prop::option::of(numbers()),
        prop::option::of(0..3_usize),
        (0..3_usize, any::<bool>()),
        any::<bool>(),
    )
}

fn track_set() -> impl Strategy<Value = TrackSet> {
    let path = (times(1..4), prop::collection::vec(raw_point(), 4));
    (names(0..4), prop::collection::vec(path, 4)).prop_map(|(names, paths)| {
        let mut set = TrackSet::default();
        let named = paths
            .iter()
            .zip(&names)
            .any(|((times, points), _)| points[..times.len()].iter().any(|point| point.5));
        set.sensor_ids = if named {
            vec!["radar".to_owned()]
        } else {
            Vec::new()
        };
        for (track_id, (times, points)) in names.into_iter().zip(paths) {
            let points = times
                .into_iter()
                .zip(points)
                .map(|(time_s, raw)| point(&mut set, time_s, raw))
                .collect();
            set.tracks.push(Track { track_id, points });
        }
        set
    })
}

fn point(set: &mut TrackSet, time_s: f64, raw: RawPoint) -> TrackPoint {
    let ([x, y, vx, vy], has_velocity, diagonal, status, (detections, epsilon), sensor) = raw;
    let first_candidate = set.candidates.len();
    for nth in 0..detections {
        set.candidates.push(Candidate {
            detection: Some(set.detection_ids.len() as u32),
            probability: 0.1 * nth as f64,
        });
        set.detection_ids
            .push(format!("d{}", set.detection_ids.len()));
    }
    set.candidates.extend(epsilon.then_some(Candidate {
        detection: None,
        probability: 1.0 / 3.0,
    }));
    let covariance = diagonal.map(|values| {
        // Positive definite: large on the diagonal, and a correlation below one.
        let diagonal = State::from(values).abs().add_scalar(1.0);
        let mut covariance = Covariance::from_diagonal(&diagonal);
        let correlated = 0.5 * diagonal[0].sqrt() * diagonal[3].sqrt();
        (covariance[(0, 3)], covariance[(3, 0)]) = (correlated, correlated);
        covariance
    });
    let state = if has_velocity {
        State::new(x, y, vx, vy)
    } else {
        State::new(x, y, 0.0, 0.0)
    };
    let share = x.abs().fract();
    TrackPoint {
        height_m: None,
        time_s,
        sensor: sensor.then_some(0),
        estimate: Kinematics::of_plane(&state, has_velocity, covariance.as_ref()),
        status: status.map(|index| TrackStatus::ALL[index].0),
        nis: status.map(|_| x.abs()),
        known_at_s: status.filter(|index| index % 2 == 0).map(|_| time_s + 1.5),
        existence: status.map(|_| 1.0 - share),
        mode_row: status.and_then(|_| set.modes.push(&[share, 1.0 - share])),
        first_candidate: first_candidate as u32,
        candidates: (set.candidates.len() - first_candidate) as u32,
    }
}

/// The same truth with its x taken for a bearing in degrees.
fn truth_of_bearings(truth: &TruthSet) -> TruthSet {
    let point =
        |point: &TruthPoint| TruthPoint::at_bearing(point.time_s, point.position.x.to_radians());
    let target = |target: &Target| Target {
        truth_id: target.truth_id.clone(),
        points: target.points.iter().map(point).collect(),
    };
    let targets = truth.targets().iter().map(target).collect();
    TruthSet::new(Space::Bearing, targets).expect("it was sound")
}

/// The same tracks with x taken for a bearing in degrees, and its velocity and covariance for those of the bearing; of one model.
fn tracks_of_bearings(mut set: TrackSet) -> TrackSet {
    let degree = 1f64.to_radians();
    set.modes = ModeTable::default();
    for point in set.tracks.iter_mut().flat_map(|track| &mut track.points) {
        point.mode_row = None;
        let plane = &point.estimate;
        let square = |covariance: Covariance| {
            Matrix2::new(
                covariance[(0, 0)],
                covariance[(0, 3)],
                covariance[(3, 0)],
                covariance[(3, 3)],
            )
            .map(|value| value * (degree * degree))
        };
        let velocity = plane.velocity.map(|velocity| velocity.x.to_radians());
        point.estimate = Kinematics {
            position: Place::new(plane.position.x.to_radians(), 0.0, 0.0),
            velocity: velocity.map(|rate_radps| Place::new(rate_radps, 0.0, 0.0)),
            covariance: plane.covariance().map(square).as_ref().map(upper_triangle),
        };
    }
    set.space = Space::Bearing.of_points(!set.tracks.is_empty());
    set
}

/// The same truth with its x and its speed eastwards taken for heights, too.
fn truth_of_volumes(truth: &TruthSet) -> TruthSet {
    let mut targets = truth.targets().to_vec();
    for point in targets.iter_mut().flat_map(|target| &mut target.points) {
        point.position.z = point.position.x;
        point.velocity = point.velocity.map(|it| Place::new(it.x, it.y, it.x));
    }
    TruthSet::new(Space::Volume, targets).expect("it was sound")
}

/// The same tracks with y taken for a height, too; heights have correlations of their own.
fn tracks_of_volumes(mut set: TrackSet) -> TrackSet {
    for point in set.tracks.iter_mut().flat_map(|track| &mut track.points) {
        let plane = &mut point.estimate;
        let of_volume = |flat: Covariance| {
            let diagonal = flat.diagonal();
            let [x, y, vx, vy] = [diagonal[0], diagonal[1], diagonal[2], diagonal[3]];
            let mut whole = Matrix6::from_diagonal(&[x, y, x, vx, vy, vy].into());
            for (row, column) in [(0, 2), (1, 5), (3, 4)] {
                let correlated = -0.25 * whole[(row, row)].sqrt() * whole[(column, column)].sqrt();
                (whole[(row, column)], whole[(column, row)]) = (correlated, correlated);
            }
            whole
        };
        plane.covariance = plane
            .covariance()
            .map(of_volume)
            .as_ref()
            .map(upper_triangle);
        plane.position.z = plane.position.y;
        plane.velocity = plane.velocity.map(|it| Place::new(it.x, it.y, it.x));
    }
    set.space = Space::Volume.of_points(!set.tracks.is_empty());
    set
}

/// The same recording with heights and elevations of its detections, where there are some.
fn detections_of_volumes(recording: Recording, heights: &[Option<f64>]) -> Recording {
    let mut parts = recording.into_parts();
    let detections = parts.scans.iter_mut().flat_map(|scan| &mut scan.detections);
    for (detection, height) in detections.zip(heights.iter().cycle()) {
        let Some(z_m) = *height else { continue };
        let elevation_rad = (z_m % 90.0).to_radians();
        detection.measurement = match detection.measurement {
            Measurement::Position { x_m, y_m } => Measurement::Position3 { x_m, y_m, z_m },
            Measurement::RangeBearing {
                range_m,
                bearing_rad,
                range_rate_mps,
            } => Measurement::RangeBearingElevation {
                range_m,
                bearing_rad,
                elevation_rad,
                range_rate_mps,
            },
            Measurement::Bearing { bearing_rad } => Measurement::BearingElevation {
                bearing_rad,
                elevation_rad,
            },
            other => other,
        };
    }
    Recording::new(parts).expect("it was sound")
}

proptest! {
    #[test]
    fn volumes_survive(
        truth in truth_set(),
        set in track_set(),
        raw in prop::collection::vec(raw_scan(), 8),
        times in times(0..8),
        heights in prop::collection::vec(prop::option::of(number()), 1..5),
    ) {
        check(&Dataset::Truth(truth_of_volumes(&truth)));
        check(&Dataset::Tracks(tracks_of_volumes(set)));
        let names = |name: &str| vec![name.to_owned()];
        let plane = assemble(names("s"), names("t"), times, raw, true);
        check(&Dataset::Detections(detections_of_volumes(plane, &heights)));
    }

    #[test]
    fn detections_survive(
        sensors in names(1..4),
        targets in names(1..4),
        times in times(0..8),
        raw in prop::collection::vec(raw_scan(), 8),
        origins_known: bool,
    ) {
        check(&Dataset::Detections(assemble(sensors, targets, times, raw, origins_known)));
    }

    #[test]
    fn truth_survives(truth in truth_set()) {
        check(&Dataset::Truth(truth));
    }

    #[test]
    fn bearings_survive(truth in truth_set(), set in track_set()) {
        check(&Dataset::Truth(truth_of_bearings(&truth)));
        check(&Dataset::Tracks(tracks_of_bearings(set)));
    }

    #[test]
    fn tracks_survive(set in track_set()) {
        check(&Dataset::Tracks(set));
    }

    #[test]
    fn no_bytes_make_a_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        for format in FORMATS {
            let _ = (format.read)(&mut bytes.as_slice(), &ReadOptions::default());
        }
    }

    /// Text that gets past the header: its cells are what readers meet in earnest.
    #[test]
    fn no_cells_make_a_reader_panic(
        kind in 0..3_usize,
        cells in prop::collection::vec(prop::sample::select(vec!["", "0", "1", "2", "-1", "x", "1e400", "\"", "\n", "nan", "tentative", ",", "\r"]), 0..200),
        width in 4..8_usize,
    ) {
        let headers = [
            "time_s,scan,sensor_id,detection_id,x_m,y_m,range_m,bearing_deg,truth_id",
            "time_s,truth_id,x_m,y_m,vx_mps,vy_mps",
            "time_s,track_id,x_m,y_m,detection_id,probability,status",
        ];
        let columns: Vec<&str> = headers[kind].split(',').collect();
        let header = columns[..columns.len().min(width + 2)].join(",");
        let rows: Vec<String> = cells.chunks(columns.len().min(width + 2)).map(|row| row.join(",")).collect();
        let _ = read("csv", format!("{header}\n{}\n", rows.join("\n")));
    }

    #[test]
    fn no_json_makes_a_reader_panic(parts in prop::collection::vec(prop::sample::select(vec![
        "[", "]", "{", "}", ",", ":", "\"columns\"", "\"time_s\"", "\"sensorID\"", "1", "2", "null", "\"x\"", "[[1,2],[3,4]]", "{\"sensorID\":2}",
        "{\"targetID\":1,\"time\":1,\"position\":[1,2]}",
    ]), 0..20)) {
        let text = parts.concat();
        for text in [text.clone(), format!("[{text}]"), format!("[[{text}]]"), format!("{{\"columns\":{{{text}}}}}")] {
            let _ = read("json", &text);
            let _ = read("autoferry", &text);
        }
    }
}

/// Rows in order of time, not of tracks: what is read does not depend on the order of the rows that wrote it.
#[test]
fn interleaved_rows_survive() {
    let tracks = "time_s,track_id,x_m,y_m,detection_id,probability\n0,10,1,2,d1,1\n0,9,3,4,d2,0.5\n0,9,3,4,,0.5\n1,10,1,2,d3,1\n1,9,3,4,d1,1\n";
    let dataset = read("csv", tracks).expect("sound").dataset;
    let Dataset::Tracks(set) = &dataset else {
        panic!("tracks")
    };
    assert_eq!(set.detection_ids, ["d2", "d1", "d3"]);
    let named: Vec<Option<u32>> = set
        .candidates
        .iter()
        .map(|candidate| candidate.detection)
        .collect();
    assert_eq!(named, [Some(0), None, Some(1), Some(1), Some(2)]);
    check(&dataset);
    let truth = "time_s,truth_id,x_m,y_m\n0,10,1,2\n0,9,3,4\n1,10,1,2\n1,9,3,4\n";
    check(&read("csv", truth).expect("sound").dataset);
    let detections = "time_s,scan,sensor_id,detection_id,bearing_deg\n0,1,r,a,10.1\n0,1,q,a,20.2\n0,1,r,b,359.9\n1,2,q,,\n";
    check(&read("csv", detections).expect("sound").dataset);
}
