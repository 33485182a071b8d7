//! Recordings of Croatia Control, read from `TRACKLOOM_DATA/asterix-samples`; skipped where they are not at hand. Their values
//! are those that asterix_decoder 0.7.11 and libasterix 0.36.3 give alike; where the first rounds its steps, those of the
//! second.

use super::{ignored, read, rejected, said, sound, units};
use std::collections::{BTreeMap, BTreeSet};
use trackloom_domain::formats::asterix::{Decoded, Told};
use trackloom_domain::formats::feed::{Report, Spot};
use trackloom_domain::model::dataset::DatasetKind;
use trackloom_domain::model::time::TimeBase;
use trackloom_domain::model::track::TrackStatus;

const NM: f64 = 1852.0;

/// A recording, or `None`, of which the reason is printed.
fn recording(name: &str) -> Option<Vec<u8>> {
    let Some(folder) = std::env::var_os("TRACKLOOM_DATA") else {
        println!("skipped: TRACKLOOM_DATA names no folder with asterix-samples");
        return None;
    };
    let path = std::path::Path::new(&folder)
        .join("asterix-samples")
        .join(name);
    match std::fs::read(&path) {
        Ok(bytes) => Some(bytes),
        Err(error) => {
            println!("skipped: {}: {error}", path.display());
            None
        }
    }
}

fn of_kind(kind: DatasetKind) -> Told {
    Told {
        kind: Some(kind),
        ..Told::default()
    }
}

/// Asserts range (NM) and azimuth (degrees), each exact to rounding.
fn assert_polar(report: &Report, range_nm: f64, azimuth_deg: f64) {
    let Spot::Polar {
        range_m,
        bearing_rad,
    } = report.spot
    else {
        panic!("{:?}", report.spot)
    };
    assert!((range_m / NM / range_nm - 1.0).abs() < 1e-12, "{range_m} m");
    assert!(
        (bearing_rad.to_degrees() / azimuth_deg - 1.0).abs() < 1e-12,
        "{bearing_rad} rad"
    );
}

fn assert_geographic(report: &Report, wanted: (f64, f64)) {
    let Spot::Geographic { lat_deg, lon_deg } = report.spot else {
        panic!("{:?}", report.spot)
    };
    assert!((lat_deg - wanted.0).abs() < 1e-9 && (lon_deg - wanted.1).abs() < 1e-9);
}

/// Asserts speed and course, given as knots and degrees.
fn assert_motion(report: &Report, speed_kt: f64, course_deg: f64) {
    let motion = report.motion.unwrap();
    assert!(
        (motion.speed_mps * 3600.0 / NM / speed_kt - 1.0).abs() < 1e-9,
        "{motion:?}"
    );
    assert!(
        (motion.course_rad.to_degrees() / course_deg - 1.0).abs() < 1e-9,
        "{motion:?}"
    );
}

fn assert_said(decoded: &Decoded, report: usize, wanted: &[(&str, &str)]) {
    let found = said(decoded, report);
    for (name, value) in wanted {
        assert_eq!(
            found.get(name).map(String::as_str),
            Some(*value),
            "{name} of {found:?}"
        );
    }
}

#[test]
fn seven_radars_on_two_networks() {
    let Some(file) = recording("cat_034_048.pcap") else {
        return;
    };
    let decoded = sound(&file, &Told::default());
    let feed = &decoded.feed;
    assert_eq!(
        (decoded.kind, decoded.time_base),
        (DatasetKind::Detections, TimeBase::Utc)
    );
    assert_eq!(decoded.framing, "bare blocks");
    assert_eq!(units(&decoded), 162);
    assert_eq!(feed.reports.len(), 63);
    let kinds = [
        ("duplicate", 64 + 17),
        ("no position", 1),
        ("service message", 17),
    ];
    assert_eq!(ignored(&decoded), BTreeMap::from(kinds));
    assert!(rejected(&decoded).is_empty());
    assert_eq!(decoded.held[&DatasetKind::Detections], 64);
    assert!(feed.warnings.is_empty(), "{:?}", feed.warnings);
    let (first, last) = (&feed.reports[0], feed.reports.last().unwrap());
    // 5 May 2016, midnight, is 1 462 406 400 s.
    assert_eq!(
        (first.time_s, last.time_s),
        (1_462_433_754.6015625, 1_462_406_400.0 + 27_355.062_5)
    );
    assert_eq!((first.unit, feed.sensors.name(first.sensor)), (1, "25/201"));
    assert_polar(first, 197.68359375, 340.13671875);
    assert_polar(last, 238.5390625, 356.81396484375);
    assert_motion(first, 434.3994140625, 124.002685546875);
    assert_motion(last, 445.3857421875, 135.999755859375);
    assert_eq!(first.height_m, Some(330.0 * 30.48));
    let first = [
        ("address", "3C660C"),
        ("callsign", "DLH65A"),
        ("mode_a", "1000"),
        ("mode_c_ft", "33000"),
        ("track_number", "3563"),
        ("report_kind", "mode_s"),
    ];
    assert_said(&decoded, 0, &first);
    let last = [
        ("address", "405F0F"),
        ("callsign", "EZY49VG"),
        ("mode_a", "3462"),
        ("mode_c_ft", "37350"),
        ("track_number", "4010"),
    ];
    assert_said(&decoded, feed.reports.len() - 1, &last);
}

#[test]
fn what_seven_radars_say_together() {
    let Some(file) = recording("cat_034_048.pcap") else {
        return;
    };
    let decoded = sound(&file, &Told::default());
    let feed = &decoded.feed;
    let mut values: BTreeMap<&str, BTreeSet<String>> = BTreeMap::new();
    let mut kinds: BTreeMap<String, usize> = BTreeMap::new();
    let mut sources: BTreeMap<&str, usize> = BTreeMap::new();
    for (index, report) in feed.reports.iter().enumerate() {
        *sources.entry(feed.sensors.name(report.sensor)).or_default() += 1;
        for (name, value) in said(&decoded, index) {
            if name == "report_kind" {
                *kinds.entry(value.clone()).or_default() += 1;
            }
            values.entry(name).or_default().insert(value);
        }
    }
    // Types 5 and 7 are of Mode S, 3 is combined; the one of type 0 has no position.
    assert_eq!(
        kinds,
        BTreeMap::from([("mode_s".into(), 38 + 24), ("combined".into(), 1)])
    );
    assert_eq!(values["address"].len(), 62);
    // Beside these, one plot says spaces and one nothing.
    assert_eq!(values["callsign"].len(), 60);
    assert_eq!(values["mode_a"].len(), 58);
    assert_eq!(sources.len(), 7);
    assert_eq!(
        (sources["25/12"], sources["25/204"], sources["25/14"]),
        (19, 14, 2)
    );
    let times = feed
        .reports
        .iter()
        .map(|report| report.time_s - 1_462_406_400.0);
    let (first, last) = (
        times.clone().fold(f64::MAX, f64::min),
        times.fold(0.0, f64::max),
    );
    assert_eq!((first, last), (27_354.6015625, 27_356.375));
}

#[test]
fn a_radar_says_where_it_stands_and_how_it_turns() {
    let Some(file) = recording("cat_034_048.pcap") else {
        return;
    };
    let feed = sound(&file, &Told::default()).feed;
    assert_eq!(feed.sites.len(), 1);
    let (sensor, site) = feed.sites.first_key_value().unwrap();
    assert_eq!(
        (feed.sensors.name(*sensor), site.height_m),
        ("25/12", 780.0)
    );
    let (lat_deg, lon_deg) = (43.571_026_325_225_83, 16.406_064_033_508_3);
    assert!((site.lat_deg - lat_deg).abs() < 1e-9 && (site.lon_deg - lon_deg).abs() < 1e-9);
    assert_eq!(feed.rotation_s[sensor], 4.9453125);
    assert_eq!(feed.north_s.len(), 1);
}

#[test]
fn local_tracks_of_radars() {
    let Some(file) = recording("cat_034_048.pcap") else {
        return;
    };
    let decoded = sound(&file, &of_kind(DatasetKind::Tracks));
    assert_eq!(units(&decoded), 162);
    assert_eq!(decoded.feed.reports.len(), 63);
    let names: BTreeSet<&str> = decoded
        .feed
        .reports
        .iter()
        .map(|report| decoded.feed.identities.name(report.identity.unwrap()))
        .collect();
    assert_eq!(names.len(), 63);
    assert!(names.contains("25/201-3563") && names.contains("25/201-4010"));
}

#[test]
fn one_plot_and_one_message() {
    let (Some(plot), Some(message)) = (recording("cat048.raw"), recording("cat034.raw")) else {
        return;
    };
    let decoded = sound(&plot, &Told::default());
    assert_eq!((units(&decoded), decoded.feed.reports.len()), (1, 1));
    assert_eq!(decoded.time_base, TimeBase::Relative);
    let report = &decoded.feed.reports[0];
    assert_eq!(report.time_s, 27_354.6015625);
    assert_polar(report, 197.68359375, 340.13671875);
    let decoded = sound(&message, &Told::default());
    assert_eq!((units(&decoded), decoded.feed.reports.len()), (1, 0));
    assert_eq!(ignored(&decoded), BTreeMap::from([("service message", 1)]));
}

#[test]
fn a_told_day_dates_the_records() {
    let Some(plot) = recording("cat048.raw") else {
        return;
    };
    let told = Told {
        day_s: Some(1_462_406_400.0 + 5000.0),
        ..Told::default()
    };
    let decoded = sound(&plot, &told);
    assert_eq!(decoded.time_base, TimeBase::AssumedDate);
    assert_eq!(decoded.feed.reports[0].time_s, 1_462_433_754.6015625);
}

#[test]
fn system_tracks_of_a_capture() {
    let Some(file) = recording("cat_062_065.pcap") else {
        return;
    };
    let decoded = sound(&file, &Told::default());
    assert_eq!((decoded.kind, units(&decoded)), (DatasetKind::Tracks, 3));
    assert_eq!(ignored(&decoded), BTreeMap::from([("service message", 1)]));
    let [first, second] = &decoded.feed.reports[..] else {
        panic!("{}", decoded.feed.reports.len())
    };
    // 25 February 2014, midnight, is 1 393 286 400 s.
    assert_eq!(first.time_s, 1_393_286_400.0 + 45_827.3984375);
    assert_geographic(first, (41.167123317718506, 15.708866715431213));
    assert_geographic(second, (41.41693890094757, 19.38913643360138));
    let motion = first.motion.unwrap();
    assert!((motion.speed_mps * motion.course_rad.sin() - 228.75).abs() < 1e-9);
    assert!((motion.speed_mps * motion.course_rad.cos() + 47.25).abs() < 1e-9);
    assert_eq!(
        decoded.feed.identities.name(first.identity.unwrap()),
        "25/100-4713"
    );
    assert_eq!(
        (first.status, first.begins),
        (Some(TrackStatus::Confirmed), false)
    );
    assert_eq!(first.height_m, Some(39_000.0 * 0.3048));
    let wanted = [
        ("address", "4CA7A8"),
        ("callsign", "RYR174C"),
        ("mode_a", "1275"),
        ("mode_c_ft", "39000"),
        ("track_number", "4713"),
    ];
    assert_said(&decoded, 0, &wanted);
    let wanted = [
        ("address", "4CAC7F"),
        ("callsign", "ISS2007"),
        ("mode_a", "4175"),
    ];
    assert_said(&decoded, 1, &wanted);
}

#[test]
fn system_tracks_without_a_capture() {
    let Some(file) = recording("cat062cat065.raw") else {
        return;
    };
    let decoded = sound(&file, &Told::default());
    assert_eq!(units(&decoded), 3);
    let [first, second] = &decoded.feed.reports[..] else {
        panic!("{}", decoded.feed.reports.len())
    };
    assert_eq!(
        (first.time_s, second.time_s),
        (30_911.6640625, 30_911.828125)
    );
    assert_geographic(first, (44.73441302776337, 13.0415278673172));
    assert_geographic(second, (45.40080785751343, 15.13318419456482));
    assert_said(&decoded, 0, &[("mode_a", "4276"), ("mode_c_ft", "15700")]);
    assert_said(
        &decoded,
        1,
        &[("address", "3C0A55"), ("callsign", "SXD4723")],
    );
    assert!(!said(&decoded, 0).contains_key("address"));
}

#[test]
fn frames_of_oradis_within_a_datagram() {
    let Some(file) = recording("cat_001_002.pcap") else {
        return;
    };
    let decoded = sound(&file, &Told::default());
    assert_eq!((decoded.framing, units(&decoded)), ("ORADIS", 8));
    assert_eq!(decoded.feed.reports.len(), 7);
    let (first, last) = (&decoded.feed.reports[0], &decoded.feed.reports[6]);
    assert_eq!(first.time_s, 1_393_286_400.0 + 45_824.1015625);
    assert_eq!(last.time_s, 1_393_286_400.0 + 45_824.4609375);
    assert_polar(first, 236.9921875, 34.56298828125);
    assert_polar(last, 111.984375, 47.5048828125);
    // 2218 steps of 2⁻¹⁴ NM/s.
    assert_motion(first, 2218.0 * 0.2197265625, 93.9990234375);
    let wanted = [
        ("mode_a", "1464"),
        ("mode_c_ft", "37000"),
        ("track_number", "3762"),
    ];
    assert_said(&decoded, 0, &wanted);
    let wanted = [
        ("mode_a", "2645"),
        ("mode_c_ft", "36000"),
        ("track_number", "3853"),
    ];
    assert_said(&decoded, 6, &wanted);
}

#[test]
fn reports_of_adsb_are_truth() {
    let Some(file) = recording("cat21_re.ast") else {
        return;
    };
    let decoded = sound(&file, &Told::default());
    assert_eq!((decoded.kind, units(&decoded)), (DatasetKind::Truth, 2));
    let [first, second] = &decoded.feed.reports[..] else {
        panic!("{:?}", decoded.feed.units)
    };
    // Items 073 say 28 802.921875 and 28 803.1640625 s; 074 refines them.
    assert!((first.time_s - 28_802.919_599_999_67).abs() < 1e-9);
    assert!((second.time_s - 28_803.160_666_000_1).abs() < 1e-9);
    assert_geographic(first, (61.47532939910889, -7.87869930267334));
    assert_geographic(second, (61.47524356842041, -7.878849506378174));
    assert_eq!(
        decoded.feed.identities.name(first.identity.unwrap()),
        "000001"
    );
    assert_said(&decoded, 1, &[("address", "000002"), ("on_ground", "true")]);
}

/// Both peers read 28 of its 100 blocks in any edition, and 62 records, none of which is plausible.
#[test]
fn an_old_edition_is_refused_by_name() {
    let Some(file) = recording("asterix.pcap") else {
        return;
    };
    let faults = read(&file, &Told::default())
        .err()
        .expect("it is of no edition that is read");
    assert_eq!(faults.len(), 1);
    assert_eq!(faults[0].code, "unsupported_edition");
    let shares = "28 of 100 blocks can be read and 0 of 62 records are plausible";
    assert!(faults[0].detail.contains(shares), "{}", faults[0].detail);
}

/// A cut anywhere is told, or leaves what stands before it.
#[test]
fn prefixes_of_the_recordings_have_their_fates() {
    for name in [
        "cat_034_048.pcap",
        "cat_062_065.pcap",
        "cat_001_002.pcap",
        "cat21_re.ast",
    ] {
        let Some(file) = recording(name) else { return };
        let mut most = 0;
        for end in (0..file.len()).step_by(1 + file.len() / 400) {
            if let Ok(decoded) = read(&file[..end], &Told::default()) {
                assert!(units(&decoded) >= most.min(1), "{name} to {end}");
                most = most.max(units(&decoded));
            }
        }
        assert!(most > 0, "{name}");
    }
}
