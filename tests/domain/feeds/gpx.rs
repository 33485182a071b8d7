//! GPX written by hand.

use super::{assert_close, identity, ignored, place, rejected, units, used};
use proptest::prelude::*;
use trackloom_domain::formats::feed::Feed;
use trackloom_domain::formats::gpx::{Told, decode};
use trackloom_domain::model::fault::Fault;

const FILE: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<!-- two tracks -->
<gpx version="1.1" creator="hand" xmlns="http://www.topografix.com/GPX/1/1" xmlns:x="http://x.example">
  <metadata><time>2020-01-01T00:00:00Z</time><name>not a track</name></metadata>
  <wpt lat="1" lon="2"><ele>3</ele><time>2024-01-01T00:00:00Z</time></wpt>
  <rte><rtept lat="1" lon="2"/></rte>
  <trk>
    <name> Fish &amp; <![CDATA[Chips]]>&#33;
    </name>
    <trkseg>
      <trkpt lat="47.5" lon="-122.25"><ele>12.5</ele><time>2024-02-29T12:30:15.25Z</time>
        <extensions><x:time>2001-01-01T00:00:00Z</x:time><x:ele>9999</x:ele></extensions></trkpt>
      <trkpt lon='-122.5' lat='47.75'><time>2024-02-29T14:30:16+02:00</time></trkpt>
    </trkseg>
    <trkseg>
      <trkpt lat="47.0" lon="-122.0"><time>2024-02-29T12:31:00Z</time></trkpt>
    </trkseg>
  </trk>
  <trk><number>7</number><trkseg>
    <trkpt lat="-90" lon="180"><time>2024-02-29T12:30:15Z</time><speed>5</speed><course>90</course></trkpt>
  </trkseg></trk>
</gpx>
"#;

fn read(text: &str) -> Result<Feed, Vec<Fault>> {
    decode(&mut text.as_bytes(), &Told::default())
}

/// A track without a name of these points.
fn track(points: &str) -> String {
    format!(r#"<gpx version="1.0"><trk><trkseg>{points}</trkseg></trk></gpx>"#)
}

#[test]
fn tracks_and_their_segments() {
    let feed = read(FILE).unwrap();
    assert_eq!(
        (
            units(&feed),
            used(&feed),
            ignored(&feed, "waypoint or route")
        ),
        (6, 4, 2)
    );
    let names = [0, 1, 2, 3].map(|report| identity(&feed, report).to_owned());
    assert_eq!(
        names,
        ["Fish & Chips!", "Fish & Chips!", "Fish & Chips!", "7"]
    );
    // `date -u -d 2024-02-29T12:30:15Z +%s` is 1709209815.
    let times = feed
        .reports
        .iter()
        .map(|report| report.time_s - 1_709_209_815.0);
    assert!(times.eq([0.25, 1.0, 45.0, 0.0]));
    let begins = feed.reports.iter().map(|report| report.begins);
    assert!(begins.eq([true, false, true, true]));
    let places = feed.reports.iter().map(|report| place(report.spot));
    assert!(places.eq([
        (47.5, -122.25),
        (47.75, -122.5),
        (47.0, -122.0),
        (-90.0, 180.0)
    ]));
    let heights = feed.reports.iter().map(|report| report.height_m);
    assert!(heights.eq([Some(12.5), None, None, None]));
    let motion = feed.reports[3].motion.unwrap();
    assert_eq!(motion.speed_mps, 5.0);
    assert_close(motion.course_rad, std::f64::consts::FRAC_PI_2, 1e-15);
    assert_eq!(feed.reports[0].unit, 3);
    assert_eq!(feed.warnings.len(), 1);
}

#[test]
fn every_reason_to_reject() {
    let time = "<time>2024-02-29T12:30:15Z</time>";
    let cases = [
        ("no_time", r#"<trkpt lat="1" lon="2"/>"#.to_owned()),
        ("no_time", r#"<trkpt lat="1" lon="2"><time>2024-02-29T12:30:15</time></trkpt>"#.to_owned()),
        ("no_time", r#"<trkpt lat="1" lon="2"><extensions><time>2024-02-29T12:30:15Z</time></extensions></trkpt>"#.to_owned()),
        ("malformed", r#"<trkpt lat="1" lon="2"><time>yesterday</time></trkpt>"#.to_owned()),
        ("malformed", format!(r#"<trkpt lat="1">{time}</trkpt>"#)),
        ("malformed", format!(r#"<trkpt lat="1" lon="east">{time}</trkpt>"#)),
        ("malformed", format!(r#"<trkpt lat="1" lon="2">{time}<ele>high</ele></trkpt>"#)),
        ("out_of_range", format!(r#"<trkpt lat="90.1" lon="2">{time}</trkpt>"#)),
        ("out_of_range", format!(r#"<trkpt lat="1" lon="-180.1">{time}</trkpt>"#)),
        ("not_finite", format!(r#"<trkpt lat="NaN" lon="2">{time}</trkpt>"#)),
        ("not_finite", format!(r#"<trkpt lat="1" lon="2">{time}<ele>inf</ele></trkpt>"#)),
    ];
    for (reason, point) in cases {
        let feed = read(&track(&format!(
            r#"<trkpt lat="1" lon="2">{time}</trkpt>{point}"#
        )))
        .unwrap();
        assert_eq!(
            (used(&feed), rejected(&feed, reason), units(&feed)),
            (1, 1, 2),
            "{point}"
        );
        assert_eq!(feed.units.rejected[reason].first, [2]);
    }
    let local = track(r#"<trkpt lat="1" lon="2"><time>1970-01-01T02:00:00</time></trkpt>"#);
    let told = Told {
        utc_offset_s: Some(7200.0),
    };
    assert_eq!(
        decode(&mut local.as_bytes(), &told).unwrap().reports[0].time_s,
        0.0
    );
}

#[test]
fn names_are_told_apart() {
    let point =
        r#"<trkseg><trkpt lat="1" lon="2"><time>2024-02-29T12:30:15Z</time></trkpt></trkseg>"#;
    let tracks = [
        "<name>a</name>",
        "",
        "<name>a</name>",
        "<name>=1+1</name>",
        "<name>a-3</name><number>9</number>",
    ];
    let text: String = tracks
        .iter()
        .map(|name| format!("<trk>{name}{point}</trk>"))
        .collect();
    let feed = read(&format!(r#"<gpx version="1.1">{text}</gpx>"#)).unwrap();
    let names: Vec<&str> = (0..5).map(|report| identity(&feed, report)).collect();
    assert_eq!(names, ["a", "track 2", "a-3", "track 4", "a-3-5"]);
}

#[test]
fn files_that_are_refused() {
    let code = |text: &str| {
        let fault = read(text).err().unwrap().remove(0);
        (fault.code, fault.line)
    };
    let is = |text: &str, expected: &str, line: u64| {
        assert_eq!(code(text), (expected.to_owned(), Some(line)), "{text:.60}");
    };
    is("", "malformed", 1);
    is("<kml/>", "malformed", 1);
    is("<gpx version=\"1.2\"/>", "unsupported", 1);
    is("<gpx/>", "unsupported", 1);
    is(
        "<gpx version=\"1.1\"/>\n\n<gpx version=\"1.1\"/>",
        "malformed",
        3,
    );
    is("<gpx version=\"1.1\">\n<trk>", "malformed", 2);
    is("<gpx version=\"1.1\">\n<trk></gpx>", "malformed", 2);
    is(
        "\n<!DOCTYPE gpx [<!ENTITY a \"b\">]>\n<gpx version=\"1.1\"/>",
        "unsupported",
        2,
    );
    let track = |name: &str| format!("<gpx version=\"1.1\"><trk><name>{name}</name></trk></gpx>");
    is(&track("&a;"), "unsupported", 1);
    is(&track(&"a".repeat(2 << 20)), "too_large", 1);
    is(
        &format!("<gpx version=\"1.1\" x=\"{}\"/>", "a".repeat(2 << 20)),
        "too_large",
        1,
    );
    is(
        &format!("<gpx version=\"1.1\">{}", "<a>".repeat(200)),
        "too_large",
        1,
    );
    assert!(read(&track(&"&amp;".repeat(100_000))).is_ok());
}

#[test]
fn every_prefix_is_refused() {
    let whole = FILE.trim_end();
    for end in 0..whole.len() {
        let faults = decode(&mut &whole.as_bytes()[..end], &Told::default()).err();
        assert!(faults.is_some(), "{end}");
    }
}

proptest! {
    #[test]
    fn broken_bits_do_no_harm(flips in prop::collection::vec((0..1600_usize, 0..8_u8), 1..6)) {
        let mut bytes = FILE.as_bytes().to_vec();
        for (at, bit) in flips {
            let at = at % bytes.len();
            bytes[at] ^= 1 << bit;
        }
        if let Ok(feed) = decode(&mut bytes.as_slice(), &Told::default()) {
            prop_assert!(units(&feed) <= 6);
        }
    }

    #[test]
    fn random_bytes_do_no_harm(bytes in prop::collection::vec(any::<u8>(), 0..200), text in "[<>/!?a-z&;=\"' \\[\\]-]{0,100}") {
        for inside in [bytes, text.into_bytes()] {
            let file = [&b"<gpx version=\"1.1\">"[..], &inside, b"</gpx>"].concat();
            for file in [&file, &inside] {
                if let Ok(feed) = decode(&mut file.as_slice(), &Told::default()) {
                    prop_assert_eq!(units(&feed), 0);
                }
            }
        }
    }
}
