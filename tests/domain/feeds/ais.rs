//! Sentences that others publish with their meaning (those of the gpsd project's page "AIVDM/AIVDO protocol decoding"), and
//! sentences made for one rule each.

use super::{assert_close, identity, ignored, place, rejected, units, used};
use proptest::prelude::*;
use trackloom_domain::formats::ais::{Told, decode};
use trackloom_domain::formats::feed::{Attribute, Feed};

const CLASS_A: &str = "!AIVDM,1,1,,B,177KQJ5000G?tO`K>RA1wUbN0TKH,0*5C";
const CLASS_B: &str = "!AIVDM,1,1,,A,B5NJ;PP005l4ot5Isbl03wsUkP06,0*76";
const SEARCH_AIRCRAFT: &str = "!AIVDM,1,1,,B,91b55wi;hbOS@OdQAC062Ch2089h,0*30";
const EXTENDED: &str = "!AIVDM,1,1,,B,C5N3SRgPEnJGEBT>NhWAwwo862PaLELTBJ:V00000000S0D:R220,0*0B";
const LONG_RANGE: &str = "!AIVDM,1,1,,B,KC5E2b@U19PFdLbMuc5=ROv62<7m,0*16";
const STATION: &str = "!AIVDM,1,1,,A,403OviQuMGCqWrRO9>E6fE700@GO,0*4D";
const STATIC: [&str; 2] = [
    "!AIVDM,2,1,3,B,55P5TL01VIaAL@7WKO@mBplU@<PDhh000000001S;AJ::4A80?4i@E53,0*3E",
    "!AIVDM,2,2,3,B,1@0000000000000,2*55",
];
const NAME: &str = "!AIVDM,1,1,,A,H42O55i18tMET00000000000000,2*6D";
const CALLSIGN: &str = "!AIVDM,1,1,,A,H42O55lti4hhhilD3nink000?050,0*40";

/// 14 May 2007, 19:57:39 UTC: what the base station says.
const STATION_S: f64 = 1_179_172_659.0;

fn read(lines: &[&str], told: &Told) -> Feed {
    let text = lines.join("\n");
    decode(&mut text.as_bytes(), told).unwrap()
}

/// With the time 1000 s, second 40 of its minute.
fn started(lines: &[&str]) -> Feed {
    let told = Told {
        start_s: Some(1000.0),
        utc_offset_s: None,
    };
    read(lines, &told)
}

fn checksum(body: &str) -> u8 {
    body.bytes().fold(0, |sum, byte| sum ^ byte)
}

fn sentence(body: &str) -> String {
    format!("!{body}*{:02X}", checksum(body))
}

/// The sentence behind a tag block.
fn tagged(tags: &str, sentence: &str) -> String {
    format!("\\{tags}*{:02x}\\{sentence}", checksum(tags))
}

/// A position of class A: the payload of these bits after type and MMSI.
fn class_a(mmsi: u64, fields: &[(usize, usize, i64)]) -> String {
    payload(168, &[&[(0, 6, 1), (8, 30, mmsi as i64)], fields].concat())
}

/// Letters of a message of so many bits with these fields: first bit, how many, value.
fn payload(count: usize, fields: &[(usize, usize, i64)]) -> String {
    let mut bits = vec![0u8; count.next_multiple_of(6)];
    for &(from, count, value) in fields {
        for bit in 0..count {
            bits[from + bit] = (value >> (count - 1 - bit) & 1) as u8;
        }
    }
    let sextet = |bits: &[u8]| bits.iter().fold(0, |value, bit| value << 1 | bit);
    let letter = |value: u8| char::from(if value < 40 { value + 48 } else { value + 56 });
    bits.chunks(6).map(|bits| letter(sextet(bits))).collect()
}

fn alone(payload: &str) -> String {
    sentence(&format!("AIVDM,1,1,,A,{payload},0"))
}

#[test]
fn published_positions() {
    let feed = started(&[CLASS_A, CLASS_B, SEARCH_AIRCRAFT, EXTENDED, LONG_RANGE]);
    assert_eq!((units(&feed), used(&feed)), (5, 5));
    let expected = [
        ("477553000", 47.582_833, -122.345_833, 0.0, 51.0),
        ("367430530", 37.785_035, -122.267_32, 0.0, 0.0),
        ("111232511", 58.144, -6.278_843, 42.0, 154.5),
        ("367059850", 29.543_695, -88.810_392, 8.7, 335.9),
        ("206914217", 4.84, 137.023_333, 57.0, 167.0),
    ];
    for (report, (mmsi, lat_deg, lon_deg, speed_kt, course_deg)) in expected.into_iter().enumerate()
    {
        let found = feed.reports[report];
        let (found_lat_deg, found_lon_deg) = place(found.spot);
        assert_eq!(identity(&feed, report), mmsi);
        assert_close(found_lat_deg, lat_deg, 5.1e-7);
        assert_close(found_lon_deg, lon_deg, 5.1e-7);
        let motion = found.motion.unwrap();
        assert_close(motion.speed_mps, speed_kt * 1852.0 / 3600.0, 1e-9);
        assert_close(motion.course_rad.to_degrees(), course_deg, 1e-9);
    }
    assert_eq!(feed.reports[2].height_m, Some(303.0));
    assert_eq!(feed.reports[0].height_m, None);
    // A step of a tenth of a minute is 185.2 m, its standard deviation 53.46 m.
    assert_eq!(feed.reports[0].sigma_m, Some(15.0));
    assert_close(feed.reports[4].sigma_m.unwrap(), 53.46f64.hypot(15.0), 0.01);
}

#[test]
fn published_names() {
    let feed = started(&[STATIC[1], NAME, CALLSIGN, STATIC[0], EXTENDED]);
    let said = |identity: u32| {
        [
            Attribute::Mmsi,
            Attribute::ShipName,
            Attribute::Callsign,
            Attribute::ShipType,
        ]
        .map(|attribute| feed.said_of_identity(identity, attribute))
    };
    assert_eq!(
        said(0),
        [
            Some("271041815"),
            Some("PROGUY"),
            Some("TC6163"),
            Some("60")
        ]
    );
    assert_eq!(
        said(1),
        [
            Some("369190000"),
            Some("MT.MITCHELL"),
            Some("WDA9674"),
            Some("99")
        ]
    );
    assert_eq!(
        said(2),
        [Some("367059850"), Some("CAPT.J.RIMES"), None, Some("70")]
    );
    assert_eq!(
        (ignored(&feed, "message 5"), ignored(&feed, "message 24")),
        (2, 2)
    );
    assert_eq!(feed.said_of_identity(2, Attribute::ReportKind), Some("ais"));
}

#[test]
fn what_is_not_known_is_none() {
    let none = (61, 28, 181 * 600_000);
    let of = |fields: &[(usize, usize, i64)]| alone(&class_a(123_456_789, fields));
    let lines = [
        of(&[(50, 10, 1023), (116, 12, 100), (137, 6, 60)]),
        of(&[(50, 10, 1022), (116, 12, 100), (137, 6, 61)]),
        of(&[(50, 10, 100), (116, 12, 3600), (137, 6, 62)]),
        of(&[(50, 10, 100), (116, 12, 3599), (137, 6, 63), (60, 1, 1)]),
        of(&[none]),
        of(&[(89, 27, 91 * 600_000)]),
    ];
    let feed = started(&lines.each_ref().map(String::as_str));
    assert_eq!((used(&feed), ignored(&feed, "no position")), (4, 2));
    let has_motion: Vec<bool> = feed
        .reports
        .iter()
        .map(|report| report.motion.is_some())
        .collect();
    assert_eq!(has_motion, [false, false, false, true]);
    assert!(feed.reports.iter().all(|report| report.time_s == 1000.0));
    assert_eq!(feed.reports[3].sigma_m, Some(5.0));
    assert_eq!(feed.reports[0].sigma_m, Some(15.0));
}

#[test]
fn every_reason_to_reject() {
    let of = |fields: &[(usize, usize, i64)]| alone(&class_a(123_456_789, fields));
    let cases = [
        ("checksum", CLASS_A.replace("5C", "5D")),
        ("checksum", format!("\\c:1418169601*00\\{CLASS_A}")),
        ("truncated", CLASS_A[..30].to_owned()),
        ("truncated", CLASS_A[..CLASS_A.len() - 1].to_owned()),
        (
            "truncated",
            format!("\\c:1418169601*{:02X}", checksum("c:1418169601")),
        ),
        (
            "truncated",
            sentence("AIVDM,1,1,,B,177KQJ5000G?tO`K>RA1wUbN0TK,0"),
        ),
        ("empty_payload", sentence("AIVDM,1,1,,B,,0")),
        (
            "malformed",
            sentence("AIVDM,1,1,,B,177KQJ5000G?tO`K>RA1wUbN0TKH"),
        ),
        (
            "malformed",
            sentence("AIVDM,1,1,,B,177KQJ5000G?tO`K>RA1wUbN0TKH,6"),
        ),
        (
            "malformed",
            sentence("AIVDM,1,2,,B,177KQJ5000G?tO`K>RA1wUbN0TKH,0"),
        ),
        (
            "malformed",
            sentence("AIVDM,1,1,,B,177KQJ5000G?tOX_>RA1wUbN0TKH,0"),
        ),
        ("malformed", "no sentence".to_owned()),
        ("malformed", CLASS_A.replace("5C", "G1")),
        ("unknown_type", alone(&payload(168, &[(0, 6, 0)]))),
        ("unknown_type", alone(&payload(168, &[(0, 6, 29)]))),
        ("out_of_range", of(&[(61, 28, 180 * 600_000 + 1)])),
        ("out_of_range", of(&[(61, 28, -180 * 600_000 - 1)])),
        ("out_of_range", of(&[(89, 27, 90 * 600_000 + 1)])),
        ("no_identity", alone(&class_a(0, &[]))),
        ("no_identity", alone(&class_a(1_000_000_000, &[]))),
        ("incomplete_message", STATIC[0].to_owned()),
    ];
    for (reason, line) in cases {
        let feed = started(&["# the line under it", &line]);
        assert_eq!(
            (rejected(&feed, reason), units(&feed)),
            (1, 2),
            "{reason} of {line}"
        );
        assert_eq!(feed.units.rejected[reason].first, [2]);
    }
    assert_eq!(rejected(&read(&[CLASS_A], &Told::default()), "no_time"), 1);
}

#[test]
fn other_lines_are_ignored() {
    let gga = "$GPGGA,092750.000,5321.6802,N,00630.3372,W,1,8,1.03,61.7,M,55.2,M,,*76";
    let radar = sentence("RATTM,01,0.2,190.8,T,12.1,109.7,T,0.1,0.5,N,TGT01,T,,100021.00,A");
    let feed = started(&["", "  ", "# x", gga, &radar, &tagged("c:1418169601", "")]);
    assert_eq!((ignored(&feed, "blank"), ignored(&feed, "comment")), (2, 1));
    assert_eq!(
        (
            ignored(&feed, "other sentence"),
            ignored(&feed, "tag block")
        ),
        (2, 1)
    );
}

/// CLASS_A is of second 15. 1 418 169 601 s is 2014-12-10 00:00:01 UTC.
#[test]
fn times_in_their_order() {
    let time_of = |line: &str| {
        let told = Told {
            start_s: Some(0.0),
            utc_offset_s: Some(3600.0),
        };
        read(&[line], &told).reports[0].time_s
    };
    let trailer = format!("{CLASS_A},r003669946,1325394001");
    assert_eq!(time_of(&tagged("c:1418169601", CLASS_A)), 1_418_169_615.0);
    assert_eq!(
        time_of(&tagged("s:x,c:1418169601500", &trailer)),
        1_418_169_615.0
    );
    assert_eq!(time_of(&trailer), 1_325_394_015.0);
    assert_eq!(time_of(&format!("{trailer},1325394060")), 1_325_394_075.0);
    assert_eq!(
        time_of(&format!("2014-12-10T00:00:01Z {CLASS_A}")),
        1_418_169_615.0
    );
    assert_eq!(
        time_of(&format!("[2014-12-10 00:00:01.9] {CLASS_A}")),
        1_418_166_015.0
    );
    assert_eq!(time_of(&format!("1418169601 {CLASS_A}")), 1_418_169_615.0);
    assert_eq!(time_of(&format!("Chan B {CLASS_A}")), 15.0);
    let second_before = tagged("c:1418169646", CLASS_A);
    assert_eq!(time_of(&second_before), 1_418_169_675.0);
    assert_eq!(
        time_of(&tagged("c:1418169600", LONG_RANGE)),
        1_418_169_600.0
    );
}

#[test]
fn a_base_station_is_a_clock() {
    let feed = read(&[CLASS_A, STATION, CLASS_A, CLASS_B], &Told::default());
    assert_eq!(
        (rejected(&feed, "no_time"), ignored(&feed, "message 4")),
        (1, 1)
    );
    // Seconds 15 and 55 beside 19:57:39.
    let times = feed.reports.iter().map(|report| report.time_s);
    assert!(times.eq([STATION_S - 24.0, STATION_S + 16.0]));
}

#[test]
fn what_two_receivers_heard_is_used_once() {
    let at = |time_s: u32| tagged(&format!("s:r{time_s},c:{time_s}"), LONG_RANGE);
    let lines = [1_418_169_600, 1_418_169_605, 1_418_169_611, 1_418_169_606].map(at);
    let feed = started(&lines.each_ref().map(String::as_str));
    assert_eq!((used(&feed), ignored(&feed, "duplicate")), (2, 2));
    let feed = started(&[STATIC[0], STATIC[0], STATIC[1]]);
    assert_eq!(
        (ignored(&feed, "duplicate"), ignored(&feed, "message 5")),
        (1, 2)
    );
}

#[test]
fn the_own_ship_is_a_ship() {
    let own = sentence("AIVDO,1,1,,,177KQJ5000G?tO`K>RA1wUbN0TKH,0");
    let feed = started(&[&own]);
    assert_eq!((used(&feed), identity(&feed, 0)), (1, "477553000"));
}

#[test]
fn parts_wait_for_each_other() {
    let parts = [1, 2].map(|part| {
        let payload =
            &"C5N3SRgPEnJGEBT>NhWAwwo862PaLELTBJ:V00000000S0D:R220"[(part - 1) * 26..part * 26];
        sentence(&format!("AIVDM,2,{part},7,A,{payload},0"))
    });
    let [first, second] = parts.each_ref().map(String::as_str);
    for lines in [[first, second], [second, first]] {
        let feed = started(&lines);
        assert_eq!((used(&feed), identity(&feed, 0)), (2, "367059850"));
        assert_eq!((feed.reports[0].unit, feed.reports[0].units), (1, 2));
    }
    // Another channel, another receiver, another group.
    let elsewhere = [
        sentence(&second[1..second.len() - 3].replace(",A,", ",B,")),
        tagged("s:elsewhere", second),
        tagged("g:2-2-17", second),
    ];
    for line in elsewhere {
        let feed = started(&[first, &line]);
        assert_eq!(rejected(&feed, "incomplete_message"), 2, "{line}");
    }
    // More than a minute apart, and, without times, more than a hundred lines.
    for (seconds, is_whole) in [(60, true), (61, false)] {
        let later = tagged(&format!("c:{}", 1_418_169_600 + seconds), second);
        let feed = started(&[&tagged("c:1418169600", first), &later]);
        assert_eq!(used(&feed) == 2, is_whole);
    }
    for (lines, is_whole) in [(99, true), (100, false)] {
        let between = vec!["# nothing"; lines];
        let feed = started(&[&[first], &between[..], &[second]].concat());
        assert_eq!(used(&feed) == 2, is_whole);
        assert_eq!(units(&feed), lines as u64 + 2);
    }
}

#[test]
fn parts_without_end_do_not_fill_memory() {
    let part = |number: u32| sentence(&format!("AIVDM,9,1,1,A{number},55P5TL01,0"));
    let lines: Vec<String> = (0..2000).map(part).collect();
    let feed = decode(&mut lines.join("\n").as_bytes(), &Told::default()).unwrap();
    assert_eq!(
        (units(&feed), rejected(&feed, "incomplete_message")),
        (2000, 2000)
    );
}

#[test]
fn every_prefix_has_its_fates() {
    let lines = [
        CLASS_A, STATIC[0], "# x", EXTENDED, STATION, STATIC[1], NAME, LONG_RANGE,
    ];
    let text = lines.join("\r\n");
    for end in 0..=text.len() {
        let part = &text.as_bytes()[..end];
        let feed = decode(&mut &*part, &Told::default()).unwrap();
        let lines = part.split_inclusive(|byte| *byte == b'\n').count();
        assert_eq!(units(&feed), lines as u64, "{end}");
    }
}

proptest! {
    #[test]
    fn broken_bits_have_their_fates(flips in prop::collection::vec((0..560_usize, 0..8_u8), 1..6)) {
        let lines = [&tagged("g:1-2-3,c:1418169601", STATIC[0]), &tagged("g:2-2-3", STATIC[1]), EXTENDED, STATION, CLASS_A];
        let mut bytes = lines.join("\n").into_bytes();
        for (at, bit) in flips {
            let at = at % bytes.len();
            bytes[at] ^= 1 << bit;
        }
        let feed = decode(&mut bytes.as_slice(), &Told::default()).unwrap();
        let lines = bytes.split_inclusive(|byte| *byte == b'\n').count();
        prop_assert_eq!(units(&feed), lines as u64);
    }

    #[test]
    fn random_bytes_have_their_fates(bytes in prop::collection::vec(any::<u8>(), 0..300), letters in "[!\\\\AIVDM,0-9*:a-w\n]{0,200}") {
        for bytes in [bytes.as_slice(), letters.as_bytes()] {
            let feed = decode(&mut &*bytes, &Told::default()).unwrap();
            let lines = bytes.split_inclusive(|byte| *byte == b'\n').count();
            prop_assert_eq!(units(&feed), lines as u64);
        }
    }

    #[test]
    fn random_messages_have_their_fates(letters in "[0-W`-w]{1,80}", fill in 0..6_u8) {
        let line = sentence(&format!("AIVDM,1,1,,A,{letters},{fill}"));
        let feed = started(&[&line]);
        prop_assert_eq!(units(&feed), 1);
        for report in &feed.reports {
            let (lat_deg, lon_deg) = place(report.spot);
            prop_assert!(lat_deg.abs() <= 90.0 && lon_deg.abs() <= 180.0);
        }
    }
}
