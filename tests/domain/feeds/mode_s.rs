//! Frames that others publish with their meaning (J. Sun, The 1090 Megahertz Riddle, and the tests of pyModeS), in every framing,
//! and frames made for one rule each.

use super::{assert_close, identity, ignored, place, rejected, units, used};
use proptest::prelude::*;
use trackloom_domain::formats::feed::{Attribute, Feed};
use trackloom_domain::formats::mode_s::{Receiver, Ticks, Told, decode};

/// Even and odd, at 52.2572 N 3.91937 E by the even one.
const EVEN: &str = "8D40621D58C382D690C8AC2863A7";
const ODD: &str = "8D40621D58C386435CC412692AD6";
const SURFACE_EVEN: &str = "8C4841753AAB238733C8CD4020B1";
const SURFACE_ODD: &str = "8C4841753A8A35323FAEBDAC702D";
const CALLSIGN: &str = "8D4840D6202CC371C32CE0576098";
const SQUAWK: &str = "8DA2C1B6E112B600000000760759";

fn octets(hex: &str) -> Vec<u8> {
    let octet = |at: usize| u8::from_str_radix(&hex[at..at + 2], 16).unwrap();
    (0..hex.len()).step_by(2).map(octet).collect()
}

/// The frame with these bits (first, how many, value), its parity by long division.
fn made(first: u8, address: u32, fields: &[(usize, usize, u64)]) -> String {
    let mut frame = vec![0u8; 11];
    frame[0] = first;
    frame[1..4].copy_from_slice(&address.to_be_bytes()[1..]);
    for &(from, count, value) in fields {
        for bit in (0..count).filter(|bit| value >> (count - 1 - bit) & 1 == 1) {
            frame[4 + (from + bit) / 8] |= 0x80 >> ((from + bit) % 8);
        }
    }
    with_parity(frame, 0)
}

fn with_parity(mut frame: Vec<u8>, address: u32) -> String {
    let mut rest: u64 = 0;
    for octet in frame.iter().copied().chain([0; 3]) {
        for bit in (0..8).rev() {
            rest = rest << 1 | u64::from(octet >> bit & 1);
            rest ^= if rest >> 24 == 1 { 0x1ff_f409 } else { 0 };
        }
    }
    let parity = rest as u32 ^ address;
    frame.extend_from_slice(&parity.to_be_bytes()[1..]);
    frame.iter().map(|octet| format!("{octet:02x}")).collect()
}

fn beast_hex(hex: &str) -> String {
    let kind = if hex.len() == 14 { "32" } else { "33" };
    format!("1a{kind}00000000000100{}", hex.to_lowercase())
}

/// Frames at their times, as rs1090 writes them.
fn read(frames: &[(f64, &str)], told: &Told) -> Feed {
    let line = |(time_s, hex): &(f64, &str)| format!("{time_s},{}\n", beast_hex(hex));
    let text: String = frames.iter().map(line).collect();
    decode(&mut text.as_bytes(), told).unwrap()
}

fn read_alone(frames: &[(f64, &str)]) -> Feed {
    read(frames, &Told::default())
}

fn near_schiphol() -> Told {
    Told {
        receiver: Some(Receiver {
            lat_deg: 51.99,
            lon_deg: 4.375,
        }),
        ..Told::default()
    }
}

#[test]
fn a_published_pair_in_the_air() {
    let feed = read_alone(&[(1.0, ODD), (2.0, EVEN)]);
    assert_eq!(
        (used(&feed), ignored(&feed, "position without its pair")),
        (1, 1)
    );
    let (lat_deg, lon_deg) = place(feed.reports[0].spot);
    assert_close(lat_deg, 52.257_202, 1e-6);
    assert_close(lon_deg, 3.919_373, 1e-6);
    assert_eq!(identity(&feed, 0), "40621D");
    assert_close(feed.reports[0].height_m.unwrap(), 38_000.0 * 0.3048, 1e-9);
    assert_eq!(feed.reports[0].sigma_m, Some(50.0));
    let said = |attribute| feed.said_of_report(0, attribute);
    assert_eq!(said(Attribute::ModeC), Some("38000"));
    assert_eq!(said(Attribute::OnGround), Some("false"));
    assert_eq!(feed.said_of_identity(0, Attribute::Address), Some("40621D"));
    // The other way round the odd one is the later: 52.265 78 N 3.938 91 E.
    let feed = read_alone(&[(1.0, EVEN), (2.0, ODD)]);
    let (lat_deg, lon_deg) = place(feed.reports[0].spot);
    assert_close(lat_deg, 52.265_78, 1e-5);
    assert_close(lon_deg, 3.938_91, 1e-5);
}

#[test]
fn a_pair_is_ten_seconds_long() {
    assert_eq!(used(&read_alone(&[(1.0, ODD), (11.0, EVEN)])), 1);
    assert_eq!(used(&read_alone(&[(1.0, ODD), (11.5, EVEN)])), 0);
    // A place leads to the next for 300 s.
    assert_eq!(
        used(&read_alone(&[(1.0, ODD), (2.0, EVEN), (302.0, EVEN)])),
        2
    );
    assert_eq!(
        used(&read_alone(&[(1.0, ODD), (2.0, EVEN), (303.0, EVEN)])),
        1
    );
}

#[test]
fn a_published_pair_on_the_surface() {
    let frames = [(1.0, SURFACE_EVEN), (2.0, SURFACE_ODD)];
    let feed = read(&frames, &near_schiphol());
    assert_eq!(used(&feed), 1);
    let (lat_deg, lon_deg) = place(feed.reports[0].spot);
    assert_close(lat_deg, 52.320_61, 1e-5);
    assert_close(lon_deg, 4.734_73, 1e-5);
    // pyModeS: movement 40, 16 kt, 98.4375 degrees.
    let motion = feed.reports[0].motion.unwrap();
    assert_close(motion.speed_mps, 16.0 * 1852.0 / 3600.0, 1e-9);
    assert_close(motion.course_rad.to_degrees(), 98.4375, 1e-9);
    assert_eq!(feed.said_of_report(0, Attribute::OnGround), Some("true"));
    let alone = read_alone(&frames);
    assert_eq!(
        ignored(&alone, "surface position without receiver place"),
        2
    );
    // It moves, so 25 s are a pair and 26 s are not.
    let after = |time_s: f64| {
        used(&read(
            &[(1.0, SURFACE_EVEN), (time_s, SURFACE_ODD)],
            &near_schiphol(),
        ))
    };
    assert_eq!((after(26.0), after(27.0)), (1, 0));
}

#[test]
fn what_is_far_from_the_receiver_is_not_believed() {
    let told = Told {
        receiver: Some(Receiver {
            lat_deg: 43.6,
            lon_deg: 1.4,
        }),
        ..Told::default()
    };
    let feed = read(&[(1.0, ODD), (2.0, EVEN), (3.0, EVEN)], &told);
    assert_eq!((used(&feed), rejected(&feed, "out_of_range")), (0, 1));
    assert_eq!(ignored(&feed, "position without its pair"), 2);
}

/// Latitude and longitude in parts of a zone, half a zone from those of EVEN.
#[test]
fn nobody_jumps() {
    let jump = made(
        0x8d,
        0x40_621d,
        &[
            (0, 5, 11),
            (8, 12, 0xc38),
            (22, 17, 93_000 - 60_000),
            (39, 17, 51_372),
        ],
    );
    let frames = [
        (1.0, ODD),
        (2.0, EVEN),
        (3.0, &jump),
        (4.0, EVEN),
        (5.0, ODD),
    ];
    let feed = read_alone(&frames);
    assert_eq!((used(&feed), rejected(&feed, "position_jump")), (2, 1));
    assert_eq!(feed.units.rejected["position_jump"].first, [3]);
}

#[test]
fn what_an_aircraft_says_goes_with_its_places() {
    let address = 0x40_621d;
    // Subtype 1: 8 kt west and 160 kt south, as in the Riddle's 8D485020994409940838175B284F, 159.20 kt, 182.88 degrees.
    let velocity = made(
        0x8d,
        address,
        &[
            (0, 5, 19),
            (5, 3, 1),
            (13, 1, 1),
            (14, 10, 9),
            (24, 1, 1),
            (25, 10, 160),
        ],
    );
    let accuracy = made(0x8d, address, &[(0, 5, 31), (40, 3, 2), (44, 4, 8)]);
    // KLM1023 and EZY85MH of published frames, 6513 of SQUAWK.
    let named = |message: u64| made(0x8d, address, &[(0, 56, message)]);
    let [first, second] = [0x20_2cc3_71c3_2ce0, 0x20_15a6_78d4_d220].map(named);
    let squawk = made(0x8d, address, &[(0, 56, 0xe1_12b6_0000_0000)]);
    let frames = [
        (1.0, ODD),
        (1.1, &velocity),
        (1.2, &accuracy),
        (1.3, &first),
        (1.4, &squawk),
        (2.0, EVEN),
        (2.5, &second),
        (3.0, ODD),
        (13.0, EVEN),
    ];
    let feed = read_alone(&frames);
    assert_eq!((used(&feed), units(&feed)), (3, 9));
    let motion = feed.reports[0].motion.unwrap();
    assert_close(motion.speed_mps, 159.20 * 1852.0 / 3600.0, 0.003);
    assert_close(motion.course_rad.to_degrees(), 182.88, 0.001);
    assert_eq!(feed.reports[2].motion, None);
    // Category 8 is 92.6 m in 95 % of cases.
    assert_close(feed.reports[0].sigma_m.unwrap(), 37.83, 0.005);
    let callsigns = [0, 1, 2].map(|report| feed.said_of_report(report, Attribute::Callsign));
    assert_eq!(
        callsigns,
        [Some("KLM1023"), Some("EZY85MH"), Some("EZY85MH")]
    );
    let begins: Vec<bool> = feed.reports.iter().map(|report| report.begins).collect();
    assert_eq!(begins, [false, true, false]);
    assert_eq!(feed.said_of_report(0, Attribute::ModeA), Some("6513"));
    assert_eq!(
        feed.said_of_identity(0, Attribute::Callsign),
        Some("EZY85MH")
    );
    let kinds = ["TC19", "TC31", "TC4", "TC28"].map(|kind| ignored(&feed, kind));
    assert_eq!(kinds, [1, 1, 2, 1]);
}

/// Replies of pyModeS's tests: identity 0356, altitude 36 000 ft; here of the aircraft of EVEN.
#[test]
fn replies_are_believed_of_aircraft_that_were_heard() {
    let reply = |hex: &str, address: u32| with_parity(octets(&hex[..8]), address);
    let identity = reply("2A00516D492B80", 0x40_621d);
    let altitude = reply("20001718029FCD", 0x40_621d);
    // A position whose altitude is not known.
    let without = made(
        0x8d,
        0x40_621d,
        &[(0, 5, 11), (22, 17, 93_000), (39, 17, 51_372)],
    );
    let feed = read_alone(&[
        (1.0, ODD),
        (2.0, EVEN),
        (3.0, &identity),
        (3.0, &altitude),
        (4.0, &without),
    ]);
    assert_eq!(feed.said_of_report(1, Attribute::ModeA), Some("0356"));
    assert_eq!(feed.said_of_report(1, Attribute::ModeC), Some("36000"));
    assert_eq!((ignored(&feed, "DF4"), ignored(&feed, "DF5")), (1, 1));
    let late = read_alone(&[(1.0, EVEN), (61.5, &identity), (62.0, ODD), (63.0, EVEN)]);
    assert_eq!(late.said_of_report(0, Attribute::ModeA), None);
}

#[test]
fn heights_above_the_ellipsoid_are_told_apart() {
    let [odd, even] = [(1, 74_158, 50_194), (0, 93_000, 51_372)].map(|(format, lat, lon)| {
        let fields = [
            (0, 5, 20),
            (8, 12, 0xc38),
            (21, 1, format),
            (22, 17, lat),
            (39, 17, lon),
        ];
        made(0x8d, 0x40_621d, &fields)
    });
    let feed = read_alone(&[(1.0, &odd), (2.0, &even)]);
    assert_close(feed.reports[0].height_m.unwrap(), 38_000.0 * 0.3048, 1e-9);
    assert_eq!(feed.said_of_report(0, Attribute::ModeC), None);
    assert!(
        feed.warnings[0].contains("ellipsoid"),
        "{:?}",
        feed.warnings
    );
}

#[test]
fn addresses_that_are_no_aircrafts_own() {
    let pair = |first: u8| {
        [(1, 74_158, 50_194), (0, 93_000, 51_372)].map(|(format, lat, lon)| {
            made(
                first,
                0x40_621d,
                &[(0, 5, 11), (21, 1, format), (22, 17, lat), (39, 17, lon)],
            )
        })
    };
    for (control, name) in [
        (0, "40621D"),
        (1, "~40621D"),
        (2, "40621D"),
        (5, "~40621D"),
        (6, "40621D"),
    ] {
        let [odd, even] = pair(0x90 | control);
        let feed = read_alone(&[(1.0, &odd), (2.0, &even)]);
        assert_eq!(identity(&feed, 0), name);
    }
    for control in [3, 4, 7] {
        let [odd, even] = pair(0x90 | control);
        let feed = read_alone(&[(1.0, &odd), (2.0, &even)]);
        assert_eq!(ignored(&feed, &format!("DF18 CF{control}")), 2);
    }
}

#[test]
fn two_receivers_hear_one_frame() {
    let feed = read_alone(&[
        (1.0, ODD),
        (1.05, ODD),
        (2.0, EVEN),
        (2.09, EVEN),
        (2.5, EVEN),
    ]);
    assert_eq!((used(&feed), ignored(&feed, "duplicate")), (2, 2));
}

#[test]
fn every_reason_to_reject() {
    let broken = EVEN.replace("63A7", "63A6");
    let cases = [
        ("checksum", format!("1,{}", beast_hex(&broken))),
        // All-call replies carry the code of an interrogator, seven bits at most.
        (
            "checksum",
            format!("1,{}", beast_hex(&with_parity(octets("5d40621d"), 128))),
        ),
        ("truncated", format!("1,{}", &beast_hex(EVEN)[..40])),
        ("truncated", format!("1,{}", &beast_hex(EVEN)[..41])),
        ("truncated", format!("1,1a3200000000000100{}", &EVEN[..14])),
        ("malformed", format!("1,1a32{}", &beast_hex(EVEN)[4..])),
        ("malformed", format!("1,1b33{}", &beast_hex(EVEN)[4..])),
        ("malformed", format!("x,{}", beast_hex(EVEN))),
        ("malformed", "1".to_owned()),
        (
            "malformed",
            format!("1,{}", beast_hex(EVEN).replace("c382", "c3g2")),
        ),
        ("not_finite", format!("inf,{}", beast_hex(EVEN))),
        ("no_time", format!(",{}", beast_hex(EVEN))),
    ];
    for (reason, line) in cases {
        let text = format!("0,{}\n{line}\n", beast_hex(CALLSIGN));
        let feed = decode(&mut text.as_bytes(), &Told::default()).unwrap();
        assert_eq!(
            (rejected(&feed, reason), units(&feed)),
            (1, 2),
            "{reason} of {line}"
        );
        assert_eq!(feed.units.rejected[reason].first, [2]);
    }
    let sound = with_parity(octets("5d40621d"), 127);
    assert_eq!(ignored(&read_alone(&[(1.0, &sound)]), "DF11"), 1);
    assert_eq!(ignored(&read_alone(&[(1.0, SQUAWK)]), "TC28"), 1);
}

/// Octets of Beast: clock, signal, frame, each `1A` twice.
fn beast(ticks: u64, hex: &str) -> Vec<u8> {
    let frame = octets(hex);
    let kind = if frame.len() == 7 { b'2' } else { b'3' };
    let inside = [&ticks.to_be_bytes()[2..], &[0x1a], &frame].concat();
    let doubled = inside
        .iter()
        .flat_map(|octet| vec![*octet; if *octet == 0x1a { 2 } else { 1 }]);
    [0x1a, kind].into_iter().chain(doubled).collect()
}

fn started() -> Told {
    Told {
        start_s: Some(1000.0),
        ..Told::default()
    }
}

#[test]
fn beast_in_octets() {
    // Ticks hold a 1A themselves: 0x1a1a00 is 0.1426 s.
    let mut stream = b"\x00\x1a\x35junk".to_vec();
    stream.extend(beast(0x1a_1a00, ODD));
    stream.extend_from_slice(b"\x1a1\x00\x00\x00\x00\x00\x01\x00\x12\x34");
    stream.extend_from_slice(&[&b"\x1a4"[..], &[0; 21]].concat());
    stream.extend_from_slice(&beast(0x1a_1a00 + 1, ODD)[..15]);
    stream.extend(beast(0x1a_1a00 + 12_000_000, EVEN));
    stream.extend_from_slice(&beast(1, EVEN)[..9]);
    let feed = decode(&mut stream.as_slice(), &started()).unwrap();
    assert_eq!((units(&feed), used(&feed)), (7, 1));
    assert_eq!(
        (rejected(&feed, "malformed"), rejected(&feed, "truncated")),
        (1, 2)
    );
    assert_eq!(
        (ignored(&feed, "mode A/C"), ignored(&feed, "status")),
        (1, 1)
    );
    assert_eq!((feed.reports[0].time_s, feed.reports[0].unit), (1001.0, 6));
    let told = Told {
        ticks: Ticks::TimeOfDay,
        ..started()
    };
    let at = |second: u64| {
        beast(
            second << 30 | 500_000_000,
            if second == 7 { ODD } else { EVEN },
        )
    };
    let feed = decode(&mut [at(7), at(8)].concat().as_slice(), &told).unwrap();
    assert_eq!(feed.reports[0].time_s, 8.5);
}

#[test]
fn avr_with_and_without_a_clock() {
    let text = format!(
        "@000000000001{ODD};\r\n*{EVEN};\n@000000b71b01{EVEN};\n@000000b71b01{EVEN}\n*1234;\n"
    );
    let feed = decode(&mut text.as_bytes(), &started()).unwrap();
    assert_eq!(
        (units(&feed), used(&feed), feed.reports[0].time_s),
        (5, 1, 1001.0)
    );
    assert_eq!(
        (rejected(&feed, "no_time"), rejected(&feed, "truncated")),
        (1, 1)
    );
    assert_eq!(ignored(&feed, "mode A/C"), 1);
}

/// Made after the description at <http://woodair.net/sbs/article/barebones42_socket_data.htm>.
#[test]
fn base_station_text() {
    let line = |kind: u8, values: &str| {
        format!(
            "MSG,{kind},1,1,4CA2D6,1,2009/02/12,17:03:25.250,2009/02/12,17:03:26.000,{values}\n"
        )
    };
    let lines = [
        line(1, "RYR41YT,,,,,,,,,,,"),
        line(4, ",,360,90,,,-64,,,,,"),
        line(6, ",,,,,,,0123,0,0,0,"),
        line(3, ",37000,,,53.6,-6.2,,,0,0,0,0"),
        line(3, ",37000,,,95.0,-6.2,,,0,0,0,0"),
        line(3, ",37000,,,x,-6.2,,,0,0,0,0"),
        line(9, ",37000,,,53.6,-6.2,,,0,0,0,0"),
        "SEL,,1,1,4CA2D6,1,2009/02/12,17:03:25.250,,,RYR41YT\n".to_owned(),
        "MSG,3,1,1\n".to_owned(),
        line(3, ",37000,,,53.6,-6.2,,,0,0,0,-1").replace("4CA2D6", ""),
        line(3, ",37000,,,53.6,-6.2,,,0,0,0,-1").replace("2009/02/12", "2009/02/30"),
    ];
    let told = Told {
        utc_offset_s: Some(3600.0),
        ..Told::default()
    };
    let feed = decode(&mut lines.concat().as_bytes(), &told).unwrap();
    assert_eq!((units(&feed), used(&feed)), (11, 1));
    let report = feed.reports[0];
    // 2009-02-12 16:03:25.25 UTC.
    assert_eq!(
        (report.time_s, report.unit, place(report.spot)),
        (1_234_454_605.25, 4, (53.6, -6.2))
    );
    assert_close(report.motion.unwrap().speed_mps, 185.2, 1e-9);
    assert_close(report.height_m.unwrap(), 11_277.6, 1e-9);
    let said = [
        Attribute::Callsign,
        Attribute::ModeA,
        Attribute::ModeC,
        Attribute::OnGround,
    ];
    let said = said.map(|attribute| feed.said_of_report(0, attribute));
    assert_eq!(
        said,
        [Some("RYR41YT"), Some("0123"), Some("37000"), Some("false")]
    );
    let reasons = [
        "out_of_range",
        "malformed",
        "unknown_type",
        "truncated",
        "no_identity",
        "no_time",
    ];
    assert!(
        reasons.iter().all(|reason| rejected(&feed, reason) == 1),
        "{:?}",
        feed.units
    );
    assert_eq!(
        (ignored(&feed, "other message"), ignored(&feed, "MSG,4")),
        (1, 1)
    );
}

#[test]
fn what_has_to_be_told_is_asked_for() {
    let code = |bytes: &[u8]| {
        let fault = decode(&mut &*bytes, &Told::default())
            .err()
            .unwrap()
            .remove(0);
        (fault.code, fault.pointer)
    };
    let missing = |pointer: &str| ("missing".to_owned(), pointer.to_owned());
    assert_eq!(code(&beast(1, EVEN)), missing("/meta/start"));
    assert_eq!(code(b"@000000000001*8D;"), missing("/meta/start"));
    assert_eq!(code(b"*8D;"), missing("/file"));
    let text = format!("*{EVEN};\n*{ODD};\n");
    let faults = decode(&mut text.as_bytes(), &started()).err().unwrap();
    assert!(faults[0].detail.contains("have no times"), "{faults:?}");
    assert!(
        faults[0]
            .allowed
            .as_ref()
            .unwrap()
            .contains("trackloom feed")
    );
    assert_eq!(code(b"MSG,1"), missing("/meta/utc_offset_s"));
    assert_eq!(code(b"<xml>").0, "unsupported");
    assert_eq!(code(b"").0, "unsupported");
}

#[test]
fn every_prefix_has_its_fates() {
    let text = format!(
        "1,{}\n# x\n\n2,{}\n3,{}",
        beast_hex(ODD),
        beast_hex(EVEN),
        beast_hex(CALLSIGN)
    );
    for end in 1..=text.len() {
        let part = &text.as_bytes()[..end];
        let feed = decode(&mut &*part, &Told::default()).unwrap();
        let lines = part.split_inclusive(|byte| *byte == b'\n').count();
        assert_eq!(units(&feed), lines as u64, "{end}");
    }
    let stream = [beast(0x1a, ODD), beast(0x1a1a, EVEN), beast(3, CALLSIGN)].concat();
    let begins = [
        0,
        beast(0x1a, ODD).len(),
        beast(0x1a, ODD).len() + beast(0x1a1a, EVEN).len(),
    ];
    for end in 1..=stream.len() {
        let feed = decode(&mut &stream[..end], &started()).unwrap();
        let frames = begins.iter().filter(|begin| end > **begin).count();
        assert_eq!(units(&feed), frames as u64, "{end}");
    }
}

proptest! {
    #[test]
    fn broken_bits_have_their_fates(flips in prop::collection::vec((any::<usize>(), 0..8_u8), 1..6)) {
        let text = format!("1,{}\n2,{}\n3,{}\n", beast_hex(ODD), beast_hex(EVEN), beast_hex(SURFACE_ODD));
        let stream = [beast(0x1a, ODD), beast(0x1a1a, EVEN), beast(3, SURFACE_ODD)].concat();
        let told = Told { start_s: Some(0.0), ..near_schiphol() };
        for sound in [text.into_bytes(), stream] {
            let mut bytes = sound.clone();
            for (at, bit) in &flips {
                let at = at % bytes.len();
                bytes[at] ^= 1 << bit;
            }
            if let Ok(feed) = decode(&mut bytes.as_slice(), &told) {
                prop_assert!(units(&feed) >= 1 && units(&feed) <= bytes.len() as u64);
            }
        }
    }

    #[test]
    fn random_bytes_have_their_fates(bytes in prop::collection::vec(any::<u8>(), 0..300), escapes in prop::collection::vec(0..300_usize, 0..20)) {
        let mut bytes = bytes;
        for at in escapes.into_iter().filter(|at| *at + 1 < 300) {
            if let Some(pair) = bytes.get_mut(at..at + 2) {
                pair.copy_from_slice(b"\x1a3");
            }
        }
        for first in [&b""[..], b"\x1a2", b"1", b"*", b"@", b"MSG,"] {
            let bytes = [first, &bytes].concat();
            let told = Told { start_s: Some(0.0), utc_offset_s: Some(0.0), ..near_schiphol() };
            if let Ok(feed) = decode(&mut bytes.as_slice(), &told) {
                prop_assert!(units(&feed) <= bytes.len() as u64);
            }
        }
    }

    /// Frames with a sound parity, whatever they say.
    #[test]
    fn random_messages_have_their_fates(messages in prop::collection::vec((0..1_u64 << 56, any::<bool>(), 0.0..20.0), 1..40)) {
        let frames: Vec<(f64, String)> = messages
            .iter()
            .map(|(message, is_odd, time_s)| {
                let position = message & !(0x1f << 51) & !(1 << 34) | 11 << 51 | u64::from(*is_odd) << 34;
                (*time_s, made(0x8d, 0x40_621d, &[(0, 56, if message % 3 == 0 { *message } else { position })]))
            })
            .collect();
        let frames: Vec<(f64, &str)> = frames.iter().map(|(time_s, hex)| (*time_s, hex.as_str())).collect();
        for told in [Told::default(), near_schiphol()] {
            let feed = read(&frames, &told);
            prop_assert_eq!(units(&feed), frames.len() as u64);
            for report in &feed.reports {
                let (lat_deg, lon_deg) = place(report.spot);
                prop_assert!(lat_deg.abs() <= 90.0 && lon_deg.abs() <= 180.0);
            }
        }
    }
}
