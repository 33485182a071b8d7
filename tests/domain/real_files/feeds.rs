//! AIS and Mode S, against pyais 3.3.1, pyModeS 3.6.1 and rs1090 0.7.0.

use super::*;
use serde_json::json;

/// Its messages have no times; a base station says 9:30:40 UTC on 21 June 2015.
#[test]
fn a_minute_of_ships_without_times() {
    const FILE: &str = "ais-nmea/pyais_nmea_data_sample.txt";
    let Some(refused) = try_read(FILE, &[]) else {
        return;
    };
    refused.expect_err("too few lines have a time");
    let read = read(FILE, &[("start", json!("2015-06-21T09:30:00Z"))]).unwrap();
    let units = &read.units;
    assert_eq!(units.total, 898);
    let repeated = ignored(units, "duplicate") + rejected(units, "duplicate");
    let jumps = rejected(units, "position_jump");
    // Seconds of the minute that are wrong put ships where they cannot be, or at one time twice.
    assert_eq!(units.used + jumps + repeated, 758);
    assert!(units.used >= 740, "{units:?}");
    assert_eq!(ignored(units, "no position"), 4);
    let messages = [4, 15, 20, 24].map(|kind| ignored(units, &format!("message {kind}")));
    assert_eq!(messages, [6, 7, 1, 2]);
    let reasons = ["empty_payload", "incomplete_message"];
    assert_eq!(reasons.map(|reason| rejected(units, reason)), [100, 20]);
    assert_eq!(identities_and_paths(&read.dataset)[0], 163);
    // Line 1 says second 9 of the minute.
    let first = ("235070716", 1_434_879_009.0, 36.910_433, 20.760_008);
    assert_row(&read.dataset, first, SIX_DIGITS);
}

/// pyais gives 44 places, 7 beyond the ends of the axes and 37 within. Four of them are of messages 27 that end before their last field
/// (lines 311, 315 and 319 within, 322 beyond; in line 319 of the latitude's 17 bits there are two), and one repeats another of
/// its ship.
#[test]
fn messages_of_all_types() {
    let Some(read) = read("ais-nmea/libais_test.aivdm", &[]) else {
        return;
    };
    let units = &read.units;
    assert_eq!(units.total, 345);
    assert_eq!(
        (ignored(units, "comment"), ignored(units, "blank")),
        (47, 35)
    );
    assert_eq!(units.used + ignored(units, "duplicate") + 3, 37);
    assert_eq!(rejected(units, "out_of_range") + 1, 7);
    let short = [311, 312, 314, 315, 319, 322, 324];
    assert_eq!(units.rejected["truncated"].first, short);
    assert_eq!(identities_and_paths(&read.dataset)[0] + 3, 33);
    // Received in second 27; the fix is of second 58.
    let first = ("354490000", 1_272_412_798.0, 36.873, -76.348_667);
    let last = ("580663414", 1_272_448_190.0, -36.523_333, 129.446_667);
    assert_row(&read.dataset, first, SIX_DIGITS);
    assert_row(&read.dataset, last, SIX_DIGITS);
}

#[test]
fn a_sentence_of_each_type() {
    let Some(read) = read("ais-nmea/libais_typeexamples.nmea", &[]) else {
        return;
    };
    assert_eq!(fates(&read), [26, 3, 20, 3]);
    assert_eq!(rejected(&read.units, "out_of_range"), 3);
    assert_eq!(identities_and_paths(&read.dataset)[0], 3);
    // Received in seconds 1 and 57; the fixes are of seconds 56 and 52.
    let first = ("367033650", 1_325_394_001.0 - 5.0, 42.798_55, -70.346_905);
    let last = ("366764000", 1_325_394_177.0 - 5.0, 43.072_162, -70.711_067);
    assert_row(&read.dataset, first, SIX_DIGITS);
    assert_row(&read.dataset, last, SIX_DIGITS);
}

#[test]
fn tag_blocks_out_of_order() {
    let Some(read) = read("ais-nmea/libais_tagblock.nmea", &[]) else {
        return;
    };
    assert_eq!(fates(&read), [5, 3, 2, 0]);
    assert_eq!(identities_and_paths(&read.dataset), [1, 1]);
    // Received in seconds 53 and 41; the fixes are of seconds 51 and 41. The last line is the earliest.
    assert_eq!(span_s(&read.dataset), [1_418_171_561.0, 1_418_172_111.0]);
    let first = ("224651000", 1_418_172_111.0, -5.277_917, -161.882_65);
    let last = ("224651000", 1_418_171_561.0, -5.275_983, -161.880_883);
    assert_row(&read.dataset, first, SIX_DIGITS);
    assert_row(&read.dataset, last, SIX_DIGITS);
}

/// pyModeS gives 10 392 of the 10 408 positions in the air: at the beginning of the two paths it waits for 6 and for 7 frames more.
#[test]
fn frames_of_two_flights() {
    let Some(read) = read("modes-raw/rs1090_long_flight.csv.gz", &[]) else {
        return;
    };
    let units = &read.units;
    assert_eq!(fates(&read), [172_432, 10_392 + 6 + 7, 162_027, 0]);
    let kinds = [0, 4, 5, 11, 16, 20, 21];
    let counts = kinds.map(|kind| ignored(units, &format!("DF{kind}")));
    assert_eq!(counts, [21_393, 8841, 2949, 38_456, 2694, 29_460, 18_254]);
    assert_eq!(
        ignored(units, "surface position without receiver place"),
        2556
    );
    assert_eq!(
        units.used + ignored(units, "position without its pair"),
        10_408
    );
    assert_eq!(identities_and_paths(&read.dataset)[0], 2);
    let first = (
        "398101",
        1_698_142_153.523_785,
        43.622_772_216_796_875,
        1.368_117_221_566_134,
    );
    let last = (
        "486257",
        1_698_147_494.359_309,
        52.334_472_656_25,
        4.709_548_950_195_312_5,
    );
    assert_row(&read.dataset, first, DEGREE);
    assert_row(&read.dataset, last, DEGREE);
}
