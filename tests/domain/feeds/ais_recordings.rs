//! Recordings of AIS against pyais 3.3.1, which decoded each line of them. pyais gives the fields of a message that ends too
//! early as far as they go, and the time of the receiver.

use super::{assert_close, identity, ignored, place, recording, rejected, units, used};
use std::collections::BTreeSet;
use trackloom_domain::formats::ais::{Told, decode};
use trackloom_domain::formats::feed::{Attribute, Feed};

fn read(name: &str, start_s: Option<f64>) -> Option<Feed> {
    let bytes = recording(&format!("ais-nmea/{name}"))?;
    let told = Told {
        start_s,
        ..Told::default()
    };
    let feed = decode(&mut bytes.as_slice(), &told).unwrap();
    let lines = bytes.split_inclusive(|byte| *byte == b'\n').count();
    assert_eq!(units(&feed), lines as u64);
    Some(feed)
}

fn ships(feed: &Feed) -> usize {
    let ships: BTreeSet<_> = feed.reports.iter().map(|report| report.identity).collect();
    ships.len()
}

/// Line, MMSI, place, speed (kt), course (degrees).
fn assert_report(feed: &Feed, report: usize, expected: (u64, &str, [f64; 4])) {
    let (line, mmsi, [lat_deg, lon_deg, speed_kt, course_deg]) = expected;
    let found = feed.reports[report];
    assert_eq!((found.unit, identity(feed, report)), (line, mmsi));
    let (found_lat_deg, found_lon_deg) = place(found.spot);
    // pyais rounds to six digits.
    assert_close(found_lat_deg, lat_deg, 5.1e-7);
    assert_close(found_lon_deg, lon_deg, 5.1e-7);
    let motion = found.motion.unwrap();
    assert_close(motion.speed_mps, speed_kt * 1852.0 / 3600.0, 1e-9);
    assert_close(motion.course_rad.to_degrees(), course_deg, 1e-9);
}

#[test]
fn a_feed_without_times_needs_a_start() {
    // Half past nine on 21 June 2015, as its base station says.
    let Some(feed) = read("pyais_nmea_data_sample.txt", Some(1_434_879_000.0)) else {
        return;
    };
    assert_eq!((units(&feed), used(&feed), ships(&feed)), (898, 758, 163));
    assert_eq!(
        (
            rejected(&feed, "empty_payload"),
            rejected(&feed, "incomplete_message")
        ),
        (100, 20)
    );
    let kinds = [
        "message 4",
        "message 15",
        "message 20",
        "message 24",
        "no position",
    ];
    assert_eq!(kinds.map(|kind| ignored(&feed, kind)), [6, 7, 1, 2, 4]);
    assert_eq!(
        (feed.units.ignored_count(), feed.units.rejected_count()),
        (20, 120)
    );
    let empty = &feed.units.rejected["empty_payload"].first;
    assert_eq!(empty[..], [4, 6, 13, 28, 39, 48, 51, 76, 82, 92]);
    assert_report(
        &feed,
        0,
        (1, "235070716", [36.910_433, 20.760_008, 14.6, 156.1]),
    );
    assert_report(
        &feed,
        757,
        (898, "247061100", [37.900_988, 23.268_065, 1.2, 273.0]),
    );
    let second = |report: usize| feed.reports[report].time_s.rem_euclid(60.0);
    assert_eq!((second(0), second(757)), (9.0, 48.0));
    assert!(
        feed.warnings[0].starts_with("758 positions"),
        "{:?}",
        feed.warnings
    );
}

/// Its base station (lines 236 to 814) says the time of what comes after; the clock that is carried on stays with it.
#[test]
fn a_base_station_says_the_time() {
    let Some(feed) = read("pyais_nmea_data_sample.txt", None) else {
        return;
    };
    assert!(feed.reports.iter().all(|report| report.unit > 236));
    assert_eq!(used(&feed) + rejected(&feed, "no_time"), 758);
    let station_s = 1_434_879_040.0;
    assert!(
        feed.reports
            .iter()
            .all(|report| (report.time_s - station_s - 30.0).abs() < 65.0)
    );
    // With a start that no station agrees with, seconds alone end where the stations do: 9:31:40 in line 814.
    let alone = read("pyais_nmea_data_sample.txt", Some(1_000_000_020.0)).unwrap();
    let at = |line: u64| {
        alone
            .reports
            .iter()
            .find(|report| report.unit >= line)
            .unwrap()
            .time_s
    };
    let took_s = at(814) - at(236);
    assert!((40.0..80.0).contains(&took_s), "{took_s}");
}

#[test]
fn all_types_with_receivers_and_times() {
    let Some(feed) = read("libais_test.aivdm", None) else {
        return;
    };
    assert_eq!(
        (ignored(&feed, "comment"), ignored(&feed, "blank")),
        (47, 35)
    );
    // pyais has 37 places in range of 33 ships and 7 beyond; of these seven messages 27 end before their last field.
    let short = [311, 312, 314, 315, 319, 322, 324];
    assert_eq!(feed.units.rejected["truncated"].first[..], short);
    let has_place_within_range = [311, 315, 319].len() as u64;
    let has_place_beyond = [322].len() as u64;
    assert_eq!(used(&feed) + has_place_within_range, 37);
    assert_eq!(ships(&feed) + has_place_within_range as usize, 33);
    assert_eq!(rejected(&feed, "out_of_range") + has_place_beyond, 7);
    let others = [
        (1, 0),
        (5, 4),
        (6, 10),
        (7, 6),
        (8, 13),
        (15, 18),
        (23, 13),
        (24, 10),
        (28, 17),
    ];
    for (number, count) in others {
        assert_eq!(
            ignored(&feed, &format!("message {number}")),
            count,
            "{number}"
        );
    }
    assert_report(
        &feed,
        0,
        (4, "354490000", [36.873, -76.348_667, 0.0, 217.0]),
    );
    assert_report(
        &feed,
        33,
        (326, "580663414", [-36.523_333, 129.446_667, 25.0, 254.0]),
    );
    // Received at 1 272 412 827 s, second 27; the fix is of second 58.
    assert_eq!(feed.reports[0].time_s, 1_272_412_798.0);
    assert_eq!(feed.reports[33].time_s, 1_272_448_190.0);
}

#[test]
fn one_sentence_of_each_type() {
    let Some(feed) = read("libais_typeexamples.nmea", None) else {
        return;
    };
    assert_eq!((used(&feed), ships(&feed)), (3, 3));
    assert_eq!(
        (feed.units.ignored_count(), rejected(&feed, "out_of_range")),
        (20, 3)
    );
    assert_report(
        &feed,
        0,
        (2, "367033650", [42.798_55, -70.346_905, 8.6, 35.9]),
    );
    // Received in seconds 1 and 57; the fixes are of seconds 56 and 52.
    assert_eq!(feed.reports[0].time_s, 1_325_394_001.0 - 5.0);
    let last = feed
        .reports
        .iter()
        .position(|report| report.unit == 6)
        .unwrap();
    assert_report(
        &feed,
        last,
        (6, "366764000", [43.072_162, -70.711_067, 0.0, 0.0]),
    );
    assert_eq!(feed.reports[last].time_s, 1_325_394_177.0 - 5.0);
}

#[test]
fn tag_blocks_with_a_message_in_two_parts() {
    let Some(feed) = read("libais_tagblock.nmea", None) else {
        return;
    };
    assert_eq!(
        (
            used(&feed),
            ignored(&feed, "message 5"),
            feed.units.rejected_count()
        ),
        (3, 2, 0)
    );
    assert_report(
        &feed,
        0,
        (2, "224651000", [-5.277_917, -161.882_65, 1.2, 224.6]),
    );
    assert_report(
        &feed,
        2,
        (5, "224651000", [-5.275_983, -161.880_883, 1.2, 222.9]),
    );
    // Received in second 53 and in second 41; the fixes are of seconds 51 and 41.
    assert_eq!(feed.reports[0].time_s, 1_418_172_113.0 - 2.0);
    assert_eq!(feed.reports[2].time_s, 1_418_171_561.0);
    assert_close(feed.reports[1].time_s, 1_418_171_722.0, 30.0);
    let said = [
        Attribute::Mmsi,
        Attribute::ShipName,
        Attribute::Callsign,
        Attribute::ShipType,
    ];
    let said = said.map(|attribute| feed.said_of_identity(1, attribute));
    assert_eq!(
        said,
        [Some("219005012"), Some("ROSINANTE"), Some("XPD5019"), None]
    );
}
