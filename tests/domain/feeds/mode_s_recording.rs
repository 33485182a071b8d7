//! A recording of Mode S against pyModeS 3.6.1 and rs1090 0.7.0, which decoded each of its frames.

use super::{assert_close, identity, ignored, place, recording, units, used};
use std::collections::BTreeMap;
use std::io::Read;
use std::sync::OnceLock;
use trackloom_domain::formats::feed::{Attribute, Feed};
use trackloom_domain::formats::mode_s::{Receiver, Told, decode};

/// The text, unpacked once for all tests.
fn text() -> Option<&'static [u8]> {
    static TEXT: OnceLock<Option<Vec<u8>>> = OnceLock::new();
    let unpack = || {
        let packed = recording("modes-raw/rs1090_long_flight.csv.gz")?;
        let mut text = Vec::new();
        let mut unpacked = flate2::read::GzDecoder::new(packed.as_slice());
        unpacked.read_to_end(&mut text).unwrap();
        Some(text)
    };
    TEXT.get_or_init(unpack).as_deref()
}

fn report_of_line(feed: &Feed, line: u64) -> usize {
    feed.reports
        .iter()
        .position(|report| report.unit == line)
        .unwrap()
}

/// Time, address, latitude, longitude, feet: as both peers, or pyModeS alone, have them.
fn assert_report(feed: &Feed, line: u64, expected: (f64, &str, f64, f64, i32)) {
    let report = report_of_line(feed, line);
    let (time_s, address, lat_deg, lon_deg, feet) = expected;
    assert_eq!(feed.reports[report].time_s, time_s);
    assert_eq!(identity(feed, report), address);
    let (found_lat_deg, found_lon_deg) = place(feed.reports[report].spot);
    assert_close(found_lat_deg, lat_deg, 1e-9);
    assert_close(found_lon_deg, lon_deg, 1e-9);
    assert_eq!(
        feed.said_of_report(report, Attribute::ModeC),
        Some(feet.to_string().as_str())
    );
}

#[test]
fn a_flight_and_its_neighbours() {
    let Some(text) = text() else { return };
    let feed = decode(&mut &*text, &Told::default()).unwrap();
    assert_eq!((units(&feed), feed.units.rejected_count()), (172_432, 0));
    let formats = [
        (0, 21_393),
        (4, 8841),
        (5, 2949),
        (11, 38_456),
        (16, 2694),
        (20, 29_460),
        (21, 18_254),
    ];
    for (format, count) in formats {
        assert_eq!(ignored(&feed, &format!("DF{format}")), count, "DF{format}");
    }
    let codes = [
        (0, 1),
        (2, 12),
        (3, 1),
        (4, 1315),
        (19, 10_450),
        (24, 18_880),
        (28, 18),
        (29, 4175),
        (31, 2569),
    ];
    for (code, count) in codes {
        assert_eq!(ignored(&feed, &format!("TC{code}")), count, "TC{code}");
    }
    assert_eq!(
        ignored(&feed, "surface position without receiver place"),
        91 + 2458 + 7
    );
    // pyModeS gives 10 392 of the 10 408 positions in the air, all of them as here; it waits for more frames at the beginning of
    // a path, so it lacks the first 6 and 7 of the two aircraft.
    assert_eq!(
        used(&feed) + ignored(&feed, "position without its pair"),
        10_408
    );
    assert_eq!(used(&feed), 10_392 + 6 + 7);
    assert_report(
        &feed,
        26_832,
        (
            1_698_142_153.523_785,
            "398101",
            43.622_772_216_796_875,
            1.368_117_221_566_134,
            525,
        ),
    );
    let last = (
        1_698_147_494.359_309,
        "486257",
        52.334_472_656_25,
        4.709_548_950_195_312_5,
        350,
    );
    assert_report(&feed, 169_669, last);
    assert_eq!(feed.reports.last().unwrap().unit, 169_669);
    let mut aircraft: BTreeMap<&str, u64> = BTreeMap::new();
    for report in 0..feed.reports.len() {
        *aircraft.entry(identity(&feed, report)).or_default() += 1;
    }
    assert_eq!(
        aircraft,
        BTreeMap::from([("398101", 6 + 6), ("486257", 10_386 + 7)])
    );
    let callsign = |report: usize| {
        feed.said_of_identity(feed.reports[report].identity.unwrap(), Attribute::Callsign)
    };
    assert_eq!(callsign(0), Some("CCM320N"));
    assert_eq!(callsign(feed.reports.len() - 1), Some("KLM1302"));
    let last = feed.reports.len() - 1;
    assert_eq!(feed.said_of_report(last, Attribute::ModeA), Some("1000"));
}

/// Toulouse and Amsterdam are 990 km apart, and each receiver hears its own end only.
#[test]
fn surface_positions_need_the_receiver() {
    let Some(text) = text() else { return };
    for (lat_deg, lon_deg) in [(43.63, 1.37), (52.31, 4.76)] {
        let receiver = Receiver { lat_deg, lon_deg };
        let told = Told {
            receiver: Some(receiver),
            ..Told::default()
        };
        let feed = decode(&mut &*text, &told).unwrap();
        assert_eq!(units(&feed), 172_432);
        let on_ground =
            |report: &usize| feed.said_of_report(*report, Attribute::OnGround) == Some("true");
        let places: Vec<_> = (0..feed.reports.len()).filter(on_ground).collect();
        // Of the 2556 pyModeS, which is told either place, gives 2531.
        assert!(places.len() > 1150, "{}", places.len());
        for report in places {
            let (found_lat_deg, found_lon_deg) = place(feed.reports[report].spot);
            assert!((found_lat_deg - lat_deg).abs() < 0.1 && (found_lon_deg - lon_deg).abs() < 0.1);
        }
    }
}

/// The same frames as octets of Beast: its counter runs at 12 000 000.0005 Hz beside the times in the text.
#[test]
fn the_counter_tells_the_same_times() {
    let Some(text) = text() else { return };
    let mut stream = Vec::new();
    let mut start_s = None;
    for line in std::str::from_utf8(text).unwrap().lines() {
        let (time_s, hex) = line.split_once(',').unwrap();
        start_s = start_s.or(time_s.parse::<f64>().ok());
        let octet = |at: usize| u8::from_str_radix(&hex[at..at + 2], 16).unwrap();
        let octets = (0..hex.len()).step_by(2).map(octet);
        stream.extend(octets.clone().take(2));
        for octet in octets.skip(2) {
            stream.extend(std::iter::repeat_n(
                octet,
                if octet == 0x1a { 2 } else { 1 },
            ));
        }
    }
    let told = Told {
        start_s,
        ..Told::default()
    };
    let counted = decode(&mut stream.as_slice(), &told).unwrap();
    let timed = decode(&mut &*text, &Told::default()).unwrap();
    assert_eq!((units(&counted), used(&counted)), (172_432, used(&timed)));
    for (counted, timed) in counted.reports.iter().zip(&timed.reports) {
        assert_eq!((counted.unit, counted.spot), (timed.unit, timed.spot));
        assert_close(counted.time_s, timed.time_s, 0.1);
    }
}
