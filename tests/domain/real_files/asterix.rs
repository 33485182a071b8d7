//! ASTERIX, against asterix_decoder 0.7.11 and libasterix 0.36.3, which agree.

use super::*;
use trackloom_domain::model::scan::Recording;

const NM: f64 = 1852.0;
/// Midnights of 5 May 2016 and 25 February 2014.
const DAY_2016_S: f64 = 1_462_406_400.0;
const DAY_2014_S: f64 = 1_393_286_400.0;

fn recording(dataset: &Dataset) -> &Recording {
    match dataset {
        Dataset::Detections(recording) => recording,
        _ => panic!("no detections"),
    }
}

/// Asserts that a sensor saw something at a time there: slant range (NM), azimuth (degrees). The range in the plane is shorter, by the height
/// of an aircraft below 15 km.
fn assert_plot(recording: &Recording, sensor_id: &str, seen: [f64; 3]) {
    let [time_s, slant_nm, azimuth_deg] = seen;
    let scans = recording.scans_with_firsts();
    let of_sensor = scans.filter(|(_, scan)| recording.sensors[scan.sensor].sensor_id == sensor_id);
    let found = of_sensor.into_iter().find_map(|(first, scan)| {
        let mut times = recording.beside.times_s[first..first + scan.detections.len()].iter();
        let at = times.position(|found_s| (found_s - time_s).abs() <= TIME_S)?;
        let place_m = Place::default().xy();
        scan.detections[at].measurement.position_seen_from(&place_m)
    });
    let place_m = found.unwrap_or_else(|| panic!("nothing of {sensor_id} at {time_s} s"));
    let (range_m, slant_m) = (place_m.norm(), slant_nm * NM);
    let bearing_deg = place_m.x.atan2(place_m.y).to_degrees().rem_euclid(360.0);
    assert!((bearing_deg - azimuth_deg).abs() < 1e-9, "{bearing_deg}");
    let least_m = (slant_m * slant_m - 15_000.0 * 15_000.0).max(0.0).sqrt();
    // The plane is up to 0.1 % longer than the Earth this far out.
    assert!(
        (least_m * 0.99..=slant_m * 1.002).contains(&range_m),
        "{range_m} m"
    );
}

#[test]
fn plots_of_seven_radars() {
    let Some(read) = read("asterix-samples/cat_034_048.pcap", &[]) else {
        return;
    };
    assert_eq!(fates(&read), [162, 63, 99, 0]);
    let kinds = ["duplicate", "service message", "no position"];
    assert_eq!(
        kinds.map(|kind| ignored(&read.units, kind)),
        [64 + 17, 17, 1]
    );
    let recording = recording(&read.dataset);
    assert_eq!(recording.sensors.len(), 7);
    let count = |sensor_id: &str| {
        let of_it = recording.only_sensors(&[sensor_id.to_owned()]).unwrap();
        of_it.detection_count()
    };
    let sensors = [
        "25/11", "25/12", "25/13", "25/14", "25/201", "25/204", "25/205",
    ];
    // One of 25/13 has no position.
    assert_eq!(sensors.map(count), [4, 19, 8 - 1, 2, 14, 14, 3]);
    let first = [
        DAY_2016_S + 27_354.601_562_5,
        197.683_593_75,
        340.136_718_75,
    ];
    let last = [DAY_2016_S + 27_355.062_5, 238.539_062_5, 356.813_964_843_75];
    assert_plot(recording, "25/201", first);
    assert_plot(recording, "25/201", last);
    let frame = read.dataset.frame().unwrap();
    assert!((frame.latitude_deg() - 43.571_022_022_19).abs() < 1e-5);
    assert!((frame.longitude_deg() - 16.406_062_413_26).abs() < 1e-5);
}

/// The radars' own tracks: each record has one fate, and radars that nobody places are named.
#[test]
fn plots_as_tracks() {
    let said = [("kind", Value::from("tracks"))];
    let Some(read) = read("asterix-samples/cat_034_048.pcap", &said) else {
        return;
    };
    assert_eq!(read.units.total, 162);
    let unknown = ignored(&read.units, "unknown site");
    assert!(unknown > 0 && read.units.used > 0, "{:?}", read.units);
    let told = read.warnings.join("\n");
    assert!(
        told.contains("`sites`") && told.contains("25/201"),
        "{told}"
    );
}

#[test]
fn one_plot_without_a_day() {
    let Some(read) = read("asterix-samples/cat048.raw", &[]) else {
        return;
    };
    assert_eq!(fates(&read), [1, 1, 0, 0]);
    let only = [27_354.601_562_5, 197.683_593_75, 340.136_718_75];
    assert_plot(recording(&read.dataset), "25/201", only);
}

#[test]
fn plots_in_frames_of_oradis() {
    let Some(read) = read("asterix-samples/cat_001_002.pcap", &[]) else {
        return;
    };
    assert_eq!(fates(&read), [8, 7, 1, 0]);
    assert_eq!(ignored(&read.units, "service message"), 1);
    let first = [
        DAY_2014_S + 45_824.101_562_5,
        236.992_187_5,
        34.562_988_281_25,
    ];
    let last = [DAY_2014_S + 45_824.460_937_5, 111.984_375, 47.504_882_812_5];
    assert_plot(recording(&read.dataset), "25/201", first);
    assert_plot(recording(&read.dataset), "25/201", last);
}

#[test]
fn tracks_of_a_centre() {
    let Some(captured) = read("asterix-samples/cat_062_065.pcap", &[]) else {
        return;
    };
    assert_eq!(fates(&captured), [3, 2, 1, 0]);
    let time_s = DAY_2014_S + 45_827.398_437_5;
    let rows = [
        (
            "25/100-4713",
            time_s,
            41.167_123_317_718_506,
            15.708_866_715_431_213,
        ),
        (
            "25/100-6831",
            time_s,
            41.416_938_900_947_57,
            19.389_136_433_601_38,
        ),
    ];
    for row in rows {
        assert_row(&captured.dataset, row, DEGREE);
    }
    let bare = read("asterix-samples/cat062cat065.raw", &[]).unwrap();
    assert_eq!(fates(&bare), [3, 2, 1, 0]);
    let rows = [
        (
            "25/100-4980",
            30_911.664_062_5,
            44.734_413_027_763_37,
            13.041_527_867_317_2,
        ),
        (
            "25/100-7977",
            30_911.828_125,
            45.400_807_857_513_43,
            15.133_184_194_564_82,
        ),
    ];
    for row in rows {
        assert_row(&bare.dataset, row, DEGREE);
    }
}

/// Items 073 say 28 802.921875 and 28 803.1640625 s; 074 refines them to steps of 2⁻³⁰ s.
#[test]
fn reports_of_two_vehicles() {
    let Some(read) = read("asterix-samples/cat21_re.ast", &[]) else {
        return;
    };
    assert_eq!(fates(&read), [2, 2, 0, 0]);
    let rows = [
        (
            "000001",
            28_802.919_599_999_67,
            61.475_329_399_108_89,
            -7.878_699_302_673_34,
        ),
        (
            "000002",
            28_803.160_666_000_1,
            61.475_243_568_420_41,
            -7.878_849_506_378_174,
        ),
    ];
    for row in rows {
        assert_row(&read.dataset, row, DEGREE);
    }
}

#[test]
fn what_has_nothing_to_give_is_refused() {
    let Some(old) = try_read("asterix-samples/asterix.pcap", &[]) else {
        return;
    };
    let faults = old.expect_err("none of 62 records is plausible");
    assert_eq!(faults[0].code, "unsupported_edition");
    let message = try_read("asterix-samples/cat034.raw", &[]).unwrap();
    let faults = message.expect_err("one message of a radar of itself");
    assert_eq!(faults[0].code, "empty");
    assert!(faults[0].detail.contains("service message 1"), "{faults:?}");
}
