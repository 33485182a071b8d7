//! What is written is read as it was, to the steps of its items.

use super::samples::{adsb, plot, track};
use super::{ignored, said, sound, units};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use trackloom_domain::formats::asterix::Told;
use trackloom_domain::formats::asterix::encode::{
    AdsbRecord, MarkRecord, PlotRecord, TrackRecord, encode_adsb, encode_marks, encode_marks_002,
    encode_plots, encode_plots_001, encode_tracks,
};
use trackloom_domain::formats::feed::{Motion, Report, Site, Spot};
use trackloom_domain::model::dataset::DatasetKind;

const NM: f64 = 1852.0;
const FOOT: f64 = 0.3048;
/// Rounding beside that of a step.
const SLACK: f64 = 1e-6;

fn is_near(found: f64, wanted: f64, step: f64) -> bool {
    (found - wanted).abs() <= 0.5 * step + SLACK * step.max(1e-6) + 1e-9
}

fn is_near_angle(found_rad: f64, wanted_rad: f64, step_rad: f64) -> bool {
    let apart_rad = (found_rad - wanted_rad + PI).rem_euclid(TAU) - PI;
    apart_rad.abs() <= 0.5 * step_rad + 1e-9
}

fn assert_place(report: &Report, lat_deg: f64, lon_deg: f64, step_deg: f64) {
    let Spot::Geographic {
        lat_deg: lat,
        lon_deg: lon,
    } = report.spot
    else {
        panic!("{:?}", report.spot)
    };
    assert!(is_near(lat, lat_deg, step_deg) && is_near(lon, lon_deg, step_deg));
}

fn assert_motion(found: Option<Motion>, wanted: Option<Motion>) {
    assert_eq!(found.is_some(), wanted.is_some());
    if let (Some(found), Some(wanted)) = (found, wanted) {
        assert!(is_near(found.speed_mps, wanted.speed_mps, NM / 16_384.0));
        assert!(is_near_angle(
            found.course_rad,
            wanted.course_rad,
            TAU / 65_536.0
        ));
    }
}

/// A time for each record, in steps of 1/128 s.
fn time_s(index: usize) -> f64 {
    40_000.0 + index as f64 * 0.25
}

/// Reads what was written, of which every record is a report.
fn all_of(file: &[u8], kind: DatasetKind) -> super::Decoded {
    let told = Told {
        kind: Some(kind),
        day_s: Some(0.0),
        ..Told::default()
    };
    let decoded = sound(file, &told);
    assert_eq!(
        units(&decoded),
        decoded.feed.reports.len() as u64,
        "{:?}",
        decoded.feed.units
    );
    decoded
}

fn assert_track(decoded: &super::Decoded, index: usize, wanted: &TrackRecord) {
    let report = &decoded.feed.reports[index];
    let (sac, sic) = wanted.source;
    assert_eq!(report.time_s, wanted.time_s);
    assert_eq!(
        decoded.feed.sensors.name(report.sensor),
        format!("{sac}/{sic}")
    );
    let name = format!("{sac}/{sic}-{}", wanted.number);
    assert_eq!(decoded.feed.identities.name(report.identity.unwrap()), name);
    assert_place(
        report,
        wanted.lat_deg,
        wanted.lon_deg,
        180.0 / 2f64.powi(25),
    );
    assert_eq!(report.status, Some(wanted.status));
    assert_eq!((report.begins, report.ends), (wanted.begins, wanted.ends));
    assert_eq!(report.motion.is_some(), wanted.velocity_mps.is_some());
    if let (Some(motion), Some((east, north))) = (report.motion, wanted.velocity_mps) {
        assert!(is_near(
            motion.speed_mps * motion.course_rad.sin(),
            east,
            0.25
        ));
        assert!(is_near(
            motion.speed_mps * motion.course_rad.cos(),
            north,
            0.25
        ));
    }
    let height_m = wanted.pressure_altitude_m.or(wanted.geometric_altitude_m);
    assert_eq!(report.height_m.is_some(), height_m.is_some());
    if let (Some(found), Some(wanted)) = (report.height_m, height_m) {
        assert!(is_near(found, wanted, 25.0 * FOOT));
    }
    if let (Some(found), Some([xx, _, yy])) = (report.sigma_m, wanted.covariance_m2) {
        assert!(is_near(found, (0.5 * (xx + yy)).sqrt(), 0.8));
    }
    let said = said(decoded, index);
    assert_eq!(said.get("callsign"), wanted.callsign.as_ref());
    assert_eq!(
        said.get("address").cloned(),
        wanted.address.map(|address| format!("{address:06X}"))
    );
    assert_eq!(
        said.get("mode_a").cloned(),
        wanted.mode_a.map(|code| format!("{code:04o}"))
    );
}

fn assert_plot(decoded: &super::Decoded, index: usize, wanted: &PlotRecord, range_step_m: f64) {
    let report = &decoded.feed.reports[index];
    assert_eq!(report.time_s, wanted.time_s);
    let Spot::Polar {
        range_m,
        bearing_rad,
    } = report.spot
    else {
        panic!("{:?}", report.spot)
    };
    let (range, bearing) = wanted.place.unwrap();
    assert!(is_near(range_m, range, range_step_m));
    assert!(is_near_angle(bearing_rad, bearing, TAU / 65_536.0));
    assert_eq!(
        report.height_m,
        wanted.level_ft.map(|level_ft| level_ft * FOOT)
    );
    let said = said(decoded, index);
    assert_eq!(
        said.get("mode_a").cloned(),
        wanted.mode_a.map(|code| format!("{code:04o}"))
    );
}

fn assert_adsb(decoded: &super::Decoded, index: usize, wanted: &AdsbRecord) {
    let report = &decoded.feed.reports[index];
    assert_eq!(report.time_s, wanted.time_s);
    assert_place(
        report,
        wanted.lat_deg,
        wanted.lon_deg,
        180.0 / 2f64.powi(30),
    );
    assert_motion(report.motion, wanted.motion);
    let name = format!("{:06X}", wanted.address);
    assert_eq!(decoded.feed.identities.name(report.identity.unwrap()), name);
    let level_m = wanted.level_ft.map(|level_ft| level_ft * FOOT);
    let height_m = level_m.or(wanted.geometric_altitude_m);
    assert_eq!(report.height_m.is_some(), height_m.is_some());
    if let (Some(found), Some(wanted)) = (report.height_m, height_m) {
        assert!(is_near(found, wanted, 6.25 * FOOT));
    }
    // 10 m hold 95 % of a Gaussian of 4.0854 m on each axis.
    if wanted.nacp == Some(10) {
        assert!((report.sigma_m.unwrap() - 4.085_390).abs() < 1e-5);
    }
    let said = said(decoded, index);
    assert_eq!(said.get("callsign"), wanted.callsign.as_ref());
    assert_eq!(said["on_ground"], wanted.is_on_ground.to_string());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn tracks_are_read_as_they_are_written(mut points in proptest::collection::vec(track(), 1..40)) {
        points.iter_mut().enumerate().for_each(|(index, point)| point.time_s = time_s(index));
        let decoded = all_of(&encode_tracks(&points), DatasetKind::Tracks);
        prop_assert_eq!(decoded.feed.reports.len(), points.len());
        points.iter().enumerate().for_each(|(index, point)| assert_track(&decoded, index, point));
    }

    #[test]
    fn plots_are_read_as_they_are_written(mut plots in proptest::collection::vec(plot(), 1..40)) {
        plots.iter_mut().enumerate().for_each(|(index, plot)| plot.time_s = time_s(index));
        let decoded = all_of(&encode_plots(&plots), DatasetKind::Detections);
        prop_assert_eq!(decoded.feed.reports.len(), plots.len());
        for (index, plot) in plots.iter().enumerate() {
            assert_plot(&decoded, index, plot, NM / 256.0);
            let said = said(&decoded, index);
            prop_assert_eq!(said.get("callsign"), plot.callsign.as_ref());
            let number = plot.number.map(|number| number.to_string());
            prop_assert_eq!(said.get("track_number").cloned(), number);
            assert_motion(decoded.feed.reports[index].motion, plot.motion);
        }
    }

    #[test]
    fn reports_of_adsb_are_read_as_they_are_written(
        mut reports in proptest::collection::vec(adsb(), 1..40),
    ) {
        reports.iter_mut().enumerate().for_each(|(index, report)| report.time_s = time_s(index));
        let decoded = all_of(&encode_adsb(&reports), DatasetKind::Truth);
        prop_assert_eq!(decoded.feed.reports.len(), reports.len());
        for (index, report) in reports.iter().enumerate() {
            assert_adsb(&decoded, index, report);
        }
    }

    /// Their times are completed by the north mark before each of them.
    #[test]
    fn plots_of_category_001_are_read_as_they_are_written(
        mut plots in proptest::collection::vec(plot(), 1..40),
        start_s in 0.0..86_000.0,
    ) {
        let start_s: f64 = f64::round(start_s * 128.0) / 128.0;
        let mut file = Vec::new();
        for (index, plot) in plots.iter_mut().enumerate() {
            plot.source = (25, 201);
            plot.detection = 1 + plot.detection % 3;
            plot.time_s = start_s + index as f64;
            file.extend(encode_marks_002(&[mark(plot.time_s)]));
            file.extend(encode_plots_001(std::slice::from_ref(plot)));
        }
        let told = Told { day_s: Some(0.0), ..Told::default() };
        let decoded = sound(&file, &told);
        prop_assert_eq!(decoded.feed.reports.len(), plots.len());
        prop_assert_eq!(decoded.feed.north_s.len(), plots.len());
        for (index, plot) in plots.iter().enumerate() {
            assert_plot(&decoded, index, plot, NM / 128.0);
        }
    }
}

fn mark(time_s: f64) -> MarkRecord {
    MarkRecord {
        source: (25, 201),
        time_s,
        kind: 1,
        sector: None,
        rotation_s: Some(4.0),
        site: None,
    }
}

#[test]
fn service_messages_are_read_as_they_are_written() {
    let site = Site {
        lat_deg: 43.571,
        lon_deg: -16.406,
        height_m: 780.0,
    };
    let sector = MarkRecord {
        kind: 2,
        sector: Some(64),
        site: Some(site),
        ..mark(20.0)
    };
    let feed = sound(&encode_marks(&[mark(19.5), sector]), &Told::default()).feed;
    assert_eq!(feed.north_s, [(0, 19.5)]);
    assert_eq!(feed.rotation_s[&0], 4.0);
    let step_deg = 180.0 / 2f64.powi(23);
    let found = feed.sites[&0];
    assert!(is_near(found.lat_deg, site.lat_deg, step_deg));
    assert!(is_near(found.lon_deg, site.lon_deg, step_deg));
    assert_eq!(found.height_m, 780.0);
}

fn plain_plot() -> PlotRecord {
    PlotRecord {
        source: (25, 1),
        time_s: 100.0,
        place: Some((18_520.0, 1.0)),
        detection: 3,
        is_simulated: false,
        is_test: false,
        is_tentative: false,
        ends: false,
        mode_a: None,
        level_ft: None,
        address: None,
        callsign: None,
        number: Some(7),
        motion: None,
    }
}

#[test]
fn what_is_no_target_is_ignored_unless_asked_for() {
    let simulated = PlotRecord {
        is_simulated: true,
        ..plain_plot()
    };
    let test = PlotRecord {
        is_test: true,
        ..plain_plot()
    };
    let unseen = PlotRecord {
        detection: 0,
        ..plain_plot()
    };
    let file = encode_plots(&[plain_plot(), simulated, test, unseen, plain_plot()]);
    let decoded = sound(&file, &Told::default());
    let kinds = [
        ("duplicate", 1),
        ("no detection", 1),
        ("simulated target", 1),
        ("test target", 1),
    ];
    assert_eq!(ignored(&decoded), kinds.into());
    assert_eq!((units(&decoded), decoded.feed.reports.len()), (5, 1));
    let told = Told {
        with_test_targets: true,
        ..Told::default()
    };
    assert_eq!(sound(&file, &told).feed.reports.len(), 3);
}

/// A last record without a position ends the track at the one before.
#[test]
fn a_track_ends_without_a_position() {
    let end = PlotRecord {
        time_s: 104.0,
        place: None,
        detection: 0,
        ends: true,
        ..plain_plot()
    };
    let told = Told {
        kind: Some(DatasetKind::Tracks),
        ..Told::default()
    };
    let decoded = sound(&encode_plots(&[plain_plot(), end]), &told);
    assert_eq!(ignored(&decoded), [("no position", 1)].into());
    assert_eq!(decoded.feed.reports.len(), 1);
    assert!(decoded.feed.reports[0].ends);
}

#[test]
fn records_of_another_kind_are_counted() {
    let mut file = encode_plots(&[plain_plot()]);
    file.extend(encode_marks(&[mark(100.0)]));
    let told = Told {
        kind: Some(DatasetKind::Truth),
        ..Told::default()
    };
    let decoded = sound(&file, &told);
    assert_eq!(
        ignored(&decoded),
        [("detections", 1), ("service message", 1)].into()
    );
    assert_eq!(decoded.held[&DatasetKind::Detections], 1);
    assert_eq!(decoded.held[&DatasetKind::Tracks], 1);
}
