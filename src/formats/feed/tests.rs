//! Feeds put together by hand.

use super::*;
use crate::model::dataset::Dataset;
use crate::model::scan::Measurement;

const ORIGIN_S: f64 = 1_700_000_000.0;

/// A report of a ship at a latitude of 50 and a longitude.
fn report(unit: u64, time_s: f64, identity: u32, lon_deg: f64) -> Report {
    Report {
        time_s: ORIGIN_S + time_s,
        unit,
        units: 1,
        sensor: 0,
        identity: Some(identity),
        spot: Spot::Geographic {
            lat_deg: 50.0,
            lon_deg,
        },
        height_m: None,
        motion: None,
        sigma_m: None,
        status: None,
        begins: false,
        ends: false,
    }
}

fn feed(reports: &[Report]) -> Feed {
    let mut feed = Feed::of("line");
    feed.sensors.number("ais");
    feed.identities.number("7");
    feed.identities.number("12");
    reports.iter().for_each(|report| feed.push(*report));
    feed
}

fn finish(feed: Feed, said: serde_json::Value, kind: DatasetKind) -> ReadOutcome {
    let options = ReadOptions {
        kind: Some(kind),
        options: serde_json::from_value(said).unwrap(),
        ..ReadOptions::default()
    };
    feed.finish(TimeBase::Utc, &Manner::SHIPS, &options)
        .unwrap()
}

fn truth_of(outcome: ReadOutcome) -> crate::model::truth::TruthSet {
    match outcome.dataset {
        Dataset::Truth(truth) => truth,
        other => panic!("{:?}", other.kind()),
    }
}

#[test]
fn paths_are_sorted_split_and_free_of_repetitions_and_jumps() {
    // One degree of longitude at 50° N is 71.7 km: 0.0001 is 7.2 m, and 1 in 10 s is a jump.
    let reports = [
        report(1, 10.0, 0, 1.0001),
        report(2, 0.0, 0, 1.0),
        report(3, 10.0, 0, 1.0001),
        report(4, 10.0, 0, 1.0002),
        report(5, 20.0, 0, 2.0),
        report(6, 30.0, 0, 1.0003),
        report(7, 1000.0, 0, 1.0004),
        report(8, 0.0, 1, 1.5),
    ];
    let outcome = finish(feed(&reports), serde_json::json!({}), DatasetKind::Truth);
    let units = &outcome.units;
    assert_eq!(
        (units.total, units.used, units.ignored["duplicate"]),
        (8, 5, 1)
    );
    assert_eq!(units.rejected["duplicate"].first, [4]);
    assert_eq!(units.rejected["position_jump"].first, [5]);
    assert!(
        outcome.warnings[0].contains("largest step back is 10 s, at line 2"),
        "{:?}",
        outcome.warnings
    );
    let truth = truth_of(outcome);
    let names: Vec<&str> = truth
        .targets()
        .iter()
        .map(|target| target.truth_id.as_str())
        .collect();
    assert_eq!(names, ["7", "7-2", "12"]);
    let times_s: Vec<f64> = truth.targets()[0]
        .points
        .iter()
        .map(|point| point.time_s - ORIGIN_S)
        .collect();
    assert_eq!(times_s, [0.0, 10.0, 30.0]);
    // The middle of 1.0 and 1.5: the jump has no say.
    assert_eq!(truth.frame.unwrap().longitude_deg(), 1.25);
    assert_eq!(truth.time_base, TimeBase::Utc);
}

#[test]
fn enough_reports_that_agree_begin_a_new_path() {
    let mut reports = vec![report(1, 0.0, 0, 1.0), report(2, 10.0, 0, 1.0)];
    reports.extend((3..=7).map(|unit| report(unit, 10.0 * unit as f64, 0, 3.0)));
    let outcome = finish(feed(&reports), serde_json::json!({}), DatasetKind::Truth);
    assert_eq!(outcome.units.used, 7);
    assert!(
        outcome.warnings[0].contains("'7' is elsewhere 1 times"),
        "{:?}",
        outcome.warnings
    );
    assert_eq!(truth_of(outcome).targets().len(), 2);
}

#[test]
fn too_many_rejects_are_refused_by_reason() {
    let mut feed = feed(&[report(1, 0.0, 0, 1.0)]);
    feed.reject(Reason::Checksum, 2, 1);
    let faults = feed
        .finish(TimeBase::Utc, &Manner::SHIPS, &ReadOptions::default())
        .unwrap_err();
    assert_eq!(
        faults[0].detail,
        "checksum: line 2; 50.000 % of the lines are wrong"
    );
    let more = "max_rejected 0.25; `max_rejected` allows more";
    assert_eq!(faults[0].allowed.as_deref(), Some(more));
    for sound in [0, 1] {
        let reports = [report(1, 0.0, 0, 1.0)];
        let mut timeless = self::feed(&reports[..sound]);
        timeless.reject(Reason::NoTime, 2, 5);
        let faults = timeless.finish(TimeBase::Utc, &Manner::SHIPS, &ReadOptions::default());
        let allowed = faults.unwrap_err()[0].allowed.clone().unwrap();
        assert!(allowed.starts_with("`start`"), "{allowed}");
    }
    let nothing = super::Feed::of("line")
        .finish(TimeBase::Utc, &Manner::SHIPS, &ReadOptions::default())
        .unwrap_err();
    assert_eq!(nothing[0].code, "empty");
}

#[test]
fn reports_as_detections_are_gathered_in_frames() {
    let reports = [
        report(1, 1.0, 0, 1.0),
        report(2, 5.0, 0, 1.0001),
        report(3, 6.0, 1, 1.1),
        report(4, 12.0, 1, 1.1),
    ];
    let outcome = finish(
        feed(&reports),
        serde_json::json!({"frame_s": 10.0}),
        DatasetKind::Detections,
    );
    assert_eq!(
        (outcome.units.used, outcome.units.ignored["superseded"]),
        (3, 1)
    );
    let Dataset::Detections(recording) = outcome.dataset else {
        panic!("not detections");
    };
    let scans: Vec<(f64, usize)> = recording
        .scans
        .iter()
        .map(|scan| (scan.time_s - ORIGIN_S, scan.detections.len()))
        .collect();
    // The mean of 5 and 6 s.
    assert_eq!(scans, [(5.5, 2), (12.0, 1)]);
    assert_eq!(recording.beside.times_s[0] - ORIGIN_S, 5.0);
    assert_eq!(recording.targets, ["7", "12"]);
    assert_eq!(recording.scans[0].detections[1].origin, Some(1));
    let dropped = feed(&reports);
    let outcome = finish(
        dropped,
        serde_json::json!({"identity": "drop"}),
        DatasetKind::Detections,
    );
    let Dataset::Detections(recording) = outcome.dataset else {
        panic!("not detections");
    };
    assert!(!recording.origins_known && recording.detection_count() == 4);
}

/// One degree of longitude is 71.7 km: a ship is not there in ten seconds. It does not move the origin either.
#[test]
fn wild_positions_are_no_detections() {
    for said in [
        serde_json::json!({}),
        serde_json::json!({"identity": "drop"}),
    ] {
        let reports: Vec<Report> = (1..=20)
            .map(|unit| {
                let lon_deg = if unit == 9 {
                    60.0
                } else {
                    1.0 + 1e-4 * unit as f64
                };
                report(unit, 10.0 * unit as f64, 0, lon_deg)
            })
            .collect();
        let outcome = finish(feed(&reports), said, DatasetKind::Detections);
        assert_eq!(outcome.units.used, 19);
        assert_eq!(outcome.units.rejected["position_jump"].first, [9]);
        let frame = outcome.dataset.frame().unwrap();
        assert_eq!((frame.latitude_deg(), frame.longitude_deg()), (50.0, 1.0));
    }
}

/// A radar at 43.57 N 16.41 E that turns in 4 s and passes north at 1 s.
fn radar() -> Feed {
    let mut feed = Feed::of("record");
    feed.sensors.number("25/12");
    let site = Site {
        lat_deg: 43.57102202219,
        lon_deg: 16.40606241326,
        height_m: 780.0,
    };
    feed.sites.insert(0, site);
    feed.north_s.push((0, ORIGIN_S + 1.0));
    feed.rotation_s.insert(0, 4.0);
    for (unit, time_s) in [(1, 1.5), (2, 4.5), (3, 5.5)] {
        let spot = Spot::Polar {
            range_m: 64.0 * 1852.0,
            bearing_rad: 90_f64.to_radians(),
        };
        let height_m = Some(330.0 * 30.48);
        feed.push(Report {
            identity: None,
            spot,
            height_m,
            ..report(unit, time_s, 0, 0.0)
        });
        feed.describe(Attribute::ModeA, if unit == 2 { "1000" } else { "7777" });
    }
    feed
}

#[test]
fn plots_of_a_radar_are_of_turns_and_lie_on_the_ground() {
    let outcome = finish(radar(), serde_json::json!({}), DatasetKind::Detections);
    let Dataset::Detections(recording) = outcome.dataset else {
        panic!("not detections");
    };
    let counts: Vec<usize> = recording
        .scans
        .iter()
        .map(|scan| scan.detections.len())
        .collect();
    assert_eq!(counts, [2, 1]);
    assert_eq!(recording.scans[0].time_s - ORIGIN_S, 3.0);
    // PROJ 9.5.1: the place is 43.56168122544841 N 17.867451678982732 E; the flat slant range is 118 528 m.
    let frame = recording.frame.unwrap();
    let plane = crate::geodesy::Stereographic::about(frame.latitude_deg(), frame.longitude_deg());
    let wanted_m = plane.project(43.56168122544841, 17.867451678982732);
    let Measurement::RangeBearing {
        range_m,
        bearing_rad,
        ..
    } = recording.scans[0].detections[0].measurement
    else {
        panic!("not polar");
    };
    assert!(
        (range_m - wanted_m.norm()).abs() < 1e-3,
        "{range_m} {}",
        wanted_m.norm()
    );
    assert!((bearing_rad - wanted_m.x.atan2(wanted_m.y)).abs() < 1e-9);
    assert!((110_000.0..118_528.0).contains(&range_m));
    let modes = &recording.beside.attributes["mode_a"];
    assert_eq!((modes.get(0), modes.get(1)), (Some("7777"), Some("1000")));
    assert_eq!(recording.sensors[0].x_m, Some(0.0));
}

/// Two radars, the second of which nobody places.
#[test]
fn reports_of_radars_that_nobody_places_are_counted_and_told() {
    for kind in [DatasetKind::Truth, DatasetKind::Tracks] {
        let mut feed = radar();
        feed.sensors.number("1/2");
        feed.identities.number("7");
        for report in &mut feed.reports {
            report.identity = Some(0);
            report.sensor = u32::from(report.unit > 1);
        }
        let outcome = finish(feed, serde_json::json!({}), kind);
        let units = &outcome.units;
        assert_eq!((units.total, units.used), (3, 1), "{kind:?}");
        assert_eq!(units.ignored["unknown site"], 2);
        assert_eq!(outcome.dataset.row_count(), 1);
        let told = &outcome.warnings[0];
        assert!(told.contains("stand: 1/2; `sites`"), "{told}");
        let mut nowhere = radar();
        nowhere.identities.number("7");
        nowhere.sites.clear();
        for report in &mut nowhere.reports {
            report.identity = Some(0);
        }
        let options = ReadOptions {
            kind: Some(kind),
            ..ReadOptions::default()
        };
        let faults = nowhere.finish(TimeBase::Utc, &Manner::SHIPS, &options);
        let fault = &faults.unwrap_err()[0];
        assert!(fault.detail.ends_with("unknown site 3"), "{}", fault.detail);
        assert!(fault.allowed.as_ref().unwrap().contains("`sites`"));
    }
}

#[test]
fn bearings_that_fall_end_a_turn_and_unplaced_radars_are_told() {
    let mut feed = Feed::of("record");
    feed.sensors.number("1/2");
    for (unit, bearing_deg) in [(1, 10.0), (2, 350.0), (3, 5.0), (4, 4.0)] {
        let spot = Spot::Polar {
            range_m: 1000.0,
            bearing_rad: f64::to_radians(bearing_deg),
        };
        feed.push(Report {
            identity: None,
            spot,
            ..report(unit, unit as f64, 0, 0.0)
        });
    }
    let outcome = finish(feed, serde_json::json!({}), DatasetKind::Detections);
    assert!(
        outcome.warnings[0].contains("1/2"),
        "{:?}",
        outcome.warnings
    );
    let Dataset::Detections(recording) = outcome.dataset else {
        panic!("not detections");
    };
    let counts: Vec<usize> = recording
        .scans
        .iter()
        .map(|scan| scan.detections.len())
        .collect();
    assert_eq!((counts, recording.frame), (vec![2, 2], None));
}

#[test]
fn a_code_that_changes_is_kept_report_by_report() {
    let mut feed = feed(&[]);
    for (unit, mode_a) in [
        (1, Some("1000")),
        (2, Some("2000")),
        (3, None),
        (4, Some("2000")),
    ] {
        feed.push(report(
            unit,
            10.0 * unit as f64,
            0,
            1.0 + 1e-4 * unit as f64,
        ));
        feed.describe(Attribute::Address, "3c660c");
        if let Some(mode_a) = mode_a {
            feed.describe(Attribute::ModeA, mode_a);
        }
    }
    let truth = truth_of(finish(feed, serde_json::json!({}), DatasetKind::Truth));
    let at = |time_s: f64, name: &str| {
        let of = ("7", ORIGIN_S + time_s);
        truth.changes.word(&truth.attributes, of, name)
    };
    let modes = [10.0, 20.0, 30.0, 40.0].map(|time_s| at(time_s, "mode_a"));
    assert_eq!(modes, [Some("1000"), Some("2000"), None, Some("2000")]);
    // What is always the same is of the whole target.
    assert_eq!(truth.changes.at("7", "address", ORIGIN_S + 10.0), None);
    assert_eq!(at(10.0, "address"), Some("3c660c"));
}
