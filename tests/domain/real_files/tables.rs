//! Tables of ships and aircraft, against pandas 3.1.1.

use super::*;
use serde_json::json;

#[test]
fn ships_of_the_solent() {
    let Some(read) = read("ais-solent/SolentAIS_20160112_130211.csv", &[]) else {
        return;
    };
    assert_eq!(fates(&read), [18_623, 18_619, 3, 1]);
    assert_eq!(ignored(&read.units, "duplicate"), 3);
    assert_eq!(read.units.rejected["position_jump"].first, [8209]);
    assert_eq!(identities_and_paths(&read.dataset)[0], 91);
    assert_eq!(
        span_s(&read.dataset),
        [1_452_603_731.218, 1_452_608_801.924]
    );
    let first = (
        "235070762",
        1_452_603_731.218,
        50.773_013_333_333_3,
        -1.092_935,
    );
    let last = (
        "235010000",
        1_452_608_801.924,
        50.794_688_333_333_3,
        -1.108_663_333_333_33,
    );
    assert_row(&read.dataset, first, DEGREE);
    assert_row(&read.dataset, last, DEGREE);
}

#[test]
fn aircraft_over_the_united_kingdom() {
    let Some(read) = read("opensky-uk/OpenSky_Plane_States.csv", &[]) else {
        return;
    };
    assert_eq!(fates(&read), [6052, 5407, 645, 0]);
    assert_eq!(ignored(&read.units, "stale"), 645);
    assert_eq!(identities_and_paths(&read.dataset)[0], 84);
    let first = (
        "3c4591",
        1_626_098_398.996,
        51.468_945_519_398_83,
        -0.440_750_122_070_312_5,
    );
    let last = (
        "407a19",
        1_626_099_599.563,
        53.393_042_612_884,
        -2.193_388_097_426_464,
    );
    assert_row(&read.dataset, first, DEGREE);
    assert_row(&read.dataset, last, DEGREE);
}

/// From 10:49:35 UTC on 9 December 2019, a row a second.
#[test]
fn a_drone_with_a_receiver() {
    let Some(read) = read("uav-gps/UAV_Rot.csv", &[]) else {
        return;
    };
    assert_eq!(fates(&read), [965, 965, 0, 0]);
    assert_eq!(span_s(&read.dataset), [1_575_888_575.0, 1_575_889_539.0]);
    let points = points(&read.dataset);
    let name = points[0].0;
    let first = (name, 1_575_888_575.0, 50.297_328_5, -30.891_029_166_666_67);
    let last = (name, 1_575_889_539.0, 50.297_338_5, -30.890_999_333_333_34);
    assert_row(&read.dataset, first, DEGREE);
    assert_row(&read.dataset, last, DEGREE);
}

#[test]
fn a_day_over_switzerland() {
    let Some(read) = read("adsb-traffic/switzerland.json.gz", &[]) else {
        return;
    };
    assert_eq!(fates(&read), [139_098, 139_098, 0, 0]);
    assert_eq!(identities_and_paths(&read.dataset), [842, 1244]);
    assert_eq!(span_s(&read.dataset), [1_533_099_600.0, 1_533_160_790.0]);
    let first = ("3003ae", 1_533_101_250.0, 45.818_984_985_4, 9.229_545_593_3);
    let last = ("c078b1", 1_533_113_160.0, 47.283_462_524_4, 10.467_576_247);
    assert_row(&read.dataset, first, DEGREE);
    assert_row(&read.dataset, last, DEGREE);
}

/// pandas has 2298 rows with an aircraft and a time as another row; one of them says something else.
#[test]
fn aircraft_around_zurich() {
    let Some(read) = read("adsb-traffic/zurich_airport.json.gz", &[]) else {
        return;
    };
    assert_eq!(read.units.total, 17_132);
    let repeated = ignored(&read.units, "duplicate") + rejected(&read.units, "duplicate");
    assert_eq!((repeated, rejected(&read.units, "duplicate")), (2298, 1));
    let jumps = rejected(&read.units, "position_jump");
    assert_eq!(read.units.used + jumps, 17_132 - 2298);
    assert_eq!(identities_and_paths(&read.dataset)[0], 10);
    assert_eq!(span_s(&read.dataset), [1_570_260_821.0, 1_575_023_159.0]);
    let first = ("4b18b8", 1_571_948_485.0, 47.456_049_515, 8.578_068_659_9);
    let last = ("4b160e", 1_572_972_154.0, 47.451_667_785_6, 8.556_272_506_7);
    assert_row(&read.dataset, first, DEGREE);
    assert_row(&read.dataset, last, DEGREE);
}

#[test]
fn a_flight_with_false_positions() {
    let Some(read) = read("adsb-traffic/noisy_spoofing.json.gz", &[]) else {
        return;
    };
    assert_eq!(
        (read.units.total, ignored(&read.units, "no position")),
        (8681, 11)
    );
    let jumps = rejected(&read.units, "position_jump");
    assert_eq!(read.units.used + jumps, 8681 - 11);
    // pandas finds 417 steps of more than 400 m/s; a jump out and back makes two of them.
    assert!((1..=417).contains(&jumps), "{jumps}");
    assert_eq!(identities_and_paths(&read.dataset)[0], 1);
    assert_eq!(span_s(&read.dataset), [1_726_560_266.0, 1_726_569_000.0]);
    let first = (
        "4baac6",
        1_726_560_266.0,
        41.379_684_448_2,
        28.767_639_160_2,
    );
    let last = (
        "4baac6",
        1_726_569_000.0,
        56.967_727_661_1,
        15.888_290_405_3,
    );
    assert_row(&read.dataset, first, DEGREE);
    assert_row(&read.dataset, last, DEGREE);
}

#[test]
fn a_flight_with_false_times_needs_leave() {
    const FILE: &str = "adsb-traffic/noisy_time_issue.json.gz";
    let Some(refused) = try_read(FILE, &[]) else {
        return;
    };
    let faults = refused.expect_err("more than one row in a hundred is wrong");
    assert!(
        faults.iter().all(|fault| fault.code == "rejected"),
        "{faults:?}"
    );
    let read = read(FILE, &[("max_rejected", json!(0.02))]).unwrap();
    let jumps = rejected(&read.units, "position_jump");
    assert_eq!((read.units.total, read.units.used + jumps), (8294, 8294));
    // pandas finds 366 steps of more than 400 m/s.
    assert!((1..=366).contains(&jumps), "{jumps}");
    assert_eq!(identities_and_paths(&read.dataset)[0], 1);
    assert_eq!(span_s(&read.dataset), [1_657_712_422.0, 1_657_720_872.0]);
    let first = (
        "4b1815",
        1_657_712_422.0,
        41.238_532_632_1,
        -8.678_762_262_5,
    );
    let last = ("4b1815", 1_657_720_872.0, 47.459_913_350_8, 8.559_740_506_7);
    assert_row(&read.dataset, first, DEGREE);
    assert_row(&read.dataset, last, DEGREE);
}
