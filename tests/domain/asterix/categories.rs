//! Records of categories of which no recording is at hand, made by libasterix 0.36.3 from the values that are asserted here.

use super::{ignored, read, said, sound, units};
use std::f64::consts::PI;
use trackloom_domain::formats::asterix::{Decoded, Told};
use trackloom_domain::formats::feed::{Report, Spot};
use trackloom_domain::model::dataset::DatasetKind;
use trackloom_domain::model::track::TrackStatus;

fn octets(hex: &str) -> Vec<u8> {
    let pairs = hex.as_bytes().chunks(2);
    let octet = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap();
    pairs.map(octet).collect()
}

fn read_as(hex: &str, kind: DatasetKind) -> Decoded {
    let told = Told {
        kind: Some(kind),
        ..Told::default()
    };
    sound(&octets(hex), &told)
}

fn only(decoded: &Decoded) -> &Report {
    assert_eq!((units(decoded), decoded.feed.reports.len()), (1, 1));
    &decoded.feed.reports[0]
}

fn assert_at(report: &Report, lat_deg: f64, lon_deg: f64, step_deg: f64) {
    let Spot::Geographic {
        lat_deg: lat,
        lon_deg: lon,
    } = report.spot
    else {
        panic!("{:?}", report.spot)
    };
    assert!((lat - lat_deg).abs() <= step_deg && (lon - lon_deg).abs() <= step_deg);
}

fn assert_said(decoded: &Decoded, wanted: &[(&'static str, &str)]) {
    let wanted = wanted
        .iter()
        .map(|(name, value)| (*name, (*value).to_owned()));
    assert_eq!(said(decoded, 0), wanted.collect());
}

fn assert_motion(report: &Report, speed_mps: f64, course_rad: f64) {
    let motion = report.motion.unwrap();
    assert!((motion.speed_mps - speed_mps).abs() < 1e-9, "{motion:?}");
    assert!((motion.course_rad - course_rad).abs() < 1e-9, "{motion:?}");
}

const MOVEMENT: &str = "0a0032fb7f0180190701250257e4402084e4770b6ba23fff880154ffd0004001411008\
    d1abcdef0010c236d418200c100000";

#[test]
fn surface_movement() {
    for kind in [DatasetKind::Detections, DatasetKind::Tracks] {
        let decoded = read_as(MOVEMENT, kind);
        let report = only(&decoded);
        assert_eq!(
            (report.time_s, decoded.feed.sensors.name(0)),
            (45_000.5, "25/7")
        );
        assert_at(report, 45.73, 16.06, 1e-7);
        assert_motion(report, 5.0, (-3f64).atan2(4.0) + 2.0 * PI);
        // 3 and 4 m on the two axes.
        assert!((report.sigma_m.unwrap() - 12.5f64.sqrt()).abs() < 1e-12);
        let wanted = [
            ("address", "ABCDEF"),
            ("callsign", "DLH65A"),
            ("mode_a", "4321"),
            ("on_ground", "true"),
            ("report_kind", "mlat"),
            ("track_number", "321"),
        ];
        assert_said(&decoded, &wanted);
        let status = (kind == DatasetKind::Tracks).then_some(TrackStatus::Coasted);
        assert_eq!(report.status, status);
    }
}

#[test]
fn surface_movement_in_polar_coordinates() {
    let decoded = read_as(
        "0a0013f501101907016057e4c005dcc000000a",
        DatasetKind::Detections,
    );
    let report = only(&decoded);
    assert_eq!(
        report.spot,
        Spot::Polar {
            range_m: 1500.0,
            bearing_rad: 1.5 * PI
        }
    );
    assert_eq!(report.height_m, Some(62.5 * 0.3048));
    assert_eq!(report.identity, None);
    let message = read_as("0a000ad019070257e540", DatasetKind::Detections);
    assert_eq!(ignored(&message), [("service message", 1)].into());
}

#[test]
fn multilateration() {
    let hex = "140033f7ed081907bf1057e440ff7dec6efeb5dfb00fa0c00011ff88ff603fec00abcd803b1c380c58\
        2060007800a00000000a";
    let decoded = read_as(hex, DatasetKind::Tracks);
    let report = only(&decoded);
    assert_at(report, -45.73, -116.06, 6e-6);
    assert_motion(report, 50.0, (-30f64).atan2(-40.0) + 2.0 * PI);
    assert!((report.sigma_m.unwrap() - 1250f64.sqrt()).abs() < 1e-12);
    assert_eq!(report.height_m, Some(-500.0 * 0.3048));
    assert_eq!(
        (report.status, report.ends),
        (Some(TrackStatus::Tentative), true)
    );
    let wanted = [
        ("address", "00ABCD"),
        ("callsign", "N108CE"),
        ("mode_a", "0021"),
        ("mode_c_ft", "-500"),
        ("on_ground", "true"),
        ("report_kind", "mlat"),
        ("track_number", "4000"),
    ];
    assert_said(&decoded, &wanted);
}

#[test]
fn multilateration_of_a_fixed_transponder() {
    let file = octets("140015e901801907bf8057e4c0fff69f001a900064");
    let decoded = sound(&file, &Told::default());
    assert_eq!(ignored(&decoded), [("field monitor", 1)].into());
    let told = Told {
        with_test_targets: true,
        ..Told::default()
    };
    let decoded = sound(&file, &told);
    let report = only(&decoded);
    assert_eq!(
        report.spot,
        Spot::Plane {
            x_m: -1200.5,
            y_m: 3400.0
        }
    );
    assert_eq!(report.height_m, Some(625.0 * 0.3048));
}

#[test]
fn fused_tracks_of_an_airport() {
    let hex = "0b0030db7d412019070157e4402084e4770b6ba23f000c00100e000010c236d4182040abcdef4e2041\
        21200032800c10";
    let decoded = read_as(hex, DatasetKind::Tracks);
    let report = only(&decoded);
    assert_at(report, 45.73, 16.06, 1e-7);
    assert_motion(report, 5.0, 3f64.atan2(4.0));
    assert!((report.sigma_m.unwrap() - 12.5f64.sqrt()).abs() < 1e-12);
    assert_eq!(report.status, Some(TrackStatus::Coasted));
    assert_eq!((report.begins, report.ends), (true, false));
    let wanted = [
        ("address", "ABCDEF"),
        ("callsign", "DLH65A"),
        ("mode_a", "7000"),
        ("mode_c_ft", "1250"),
        ("on_ground", "true"),
        ("track_number", "20000"),
    ];
    assert_said(&decoded, &wanted);
    let message = read_as("0b000ad019070457e480", DatasetKind::Tracks);
    assert_eq!(ignored(&message), [("service message", 1)].into());
}

const DRAFT: &str =
    "150028ff21501907402857e44000821392002dae893c660c15e0000505280800400010c236d41820";

#[test]
fn the_only_edition_that_fits_is_used_with_a_warning() {
    let decoded = sound(&octets(DRAFT), &Told::default());
    let report = only(&decoded);
    assert_eq!(report.time_s, 45_000.5);
    assert_at(report, 45.73, 16.06, 6e-6);
    assert_motion(report, 0.125 * 1852.0, 0.5 * PI);
    assert_eq!(report.height_m, Some(33_000.0 * 0.3048));
    let wanted = [
        ("address", "3C660C"),
        ("callsign", "DLH65A"),
        ("mode_c_ft", "33000"),
        ("on_ground", "true"),
        ("report_kind", "adsb"),
    ];
    assert_said(&decoded, &wanted);
    let [warning] = &decoded.feed.warnings[..] else {
        panic!("{:?}", decoded.feed.warnings)
    };
    assert!(
        warning.contains("category 021 is read as edition 0.26"),
        "{warning}"
    );
    let told = Told {
        editions: [("021".to_owned(), "2.1".to_owned())].into(),
        ..Told::default()
    };
    let faults = read(&octets(DRAFT), &told)
        .err()
        .expect("it is of another edition");
    assert_eq!(faults[0].code, "unsupported_edition");
}

/// Received in the second before midnight, three quarters of it later; 92.6 m hold 95 %.
#[test]
fn a_time_of_reception_is_refined_across_midnight() {
    let hex = "15001cc51d20190701002084e40b6ba23c660c000000b00000000110";
    let decoded = read_as(hex, DatasetKind::Truth);
    let report = only(&decoded);
    assert_eq!(report.time_s, 86_399.75);
    assert_at(report, 45.73, 16.06, 2.2e-5);
    assert!((report.sigma_m.unwrap() - 92.6 / 2.447_746_83).abs() < 1e-6);
}

#[test]
fn system_tracks_in_the_plane_and_simulated_ones() {
    let plane = "3e0024951d0904190757e440fff69f001a9081103c660c0200004d0340019080003c0050";
    let decoded = read_as(plane, DatasetKind::Tracks);
    let report = only(&decoded);
    assert_eq!(
        report.spot,
        Spot::Plane {
            x_m: -1200.5,
            y_m: 3400.0
        }
    );
    assert_eq!(
        (report.status, report.ends),
        (Some(TrackStatus::Tentative), true)
    );
    assert_eq!(report.height_m, Some(10_000.0 * 0.3048));
    assert!((report.sigma_m.unwrap() - 1250f64.sqrt()).abs() < 1e-12);
    let wanted = [
        ("address", "3C660C"),
        ("on_ground", "true"),
        ("track_number", "77"),
    ];
    assert_said(&decoded, &wanted);
    let simulated = "3e0016990c190757e4c000821392002dae89004e0180";
    let decoded = read_as(simulated, DatasetKind::Tracks);
    assert_eq!(ignored(&decoded), [("simulated target", 1)].into());
}

/// A plot of a primary radar with a height of its own, and a code that is not validated.
#[test]
fn a_calculated_position_stands_in_for_a_measured_one() {
    let decoded = read_as(
        "300014e90908190757e4c020829cfe80fe0000c8",
        DatasetKind::Detections,
    );
    let report = only(&decoded);
    let Spot::Polar {
        range_m,
        bearing_rad,
    } = report.spot
    else {
        panic!("{:?}", report.spot)
    };
    assert!((range_m - 5.0 * 1852.0).abs() < 1e-9);
    assert!((bearing_rad - ((-3f64).atan2(-4.0) + 2.0 * PI)).abs() < 1e-12);
    assert_eq!(report.height_m, Some(5000.0 * 0.3048));
    assert_said(&decoded, &[("report_kind", "psr")]);
}
