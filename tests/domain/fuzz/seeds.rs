//! Small sound files of every format.

use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::json;
use std::io::Write;
use trackloom_domain::formats::asterix::encode::{
    AdsbRecord, MarkRecord, PlotRecord, TrackRecord, encode_adsb, encode_marks, encode_marks_002,
    encode_plots, encode_plots_001, encode_tracks,
};
use trackloom_domain::formats::feed::Motion;
use trackloom_domain::formats::{ReadOptions, read_file, writer_named};
use trackloom_domain::model::dataset::DatasetKind;
use trackloom_domain::model::track::TrackStatus;

pub struct Seed {
    pub name: &'static str,
    /// The format that it is told to be.
    pub format: &'static str,
    pub bytes: Vec<u8>,
    kind: Option<DatasetKind>,
}

impl Seed {
    /// What a user has to say of it.
    pub fn options(&self) -> ReadOptions {
        let start = ("start".to_owned(), json!("2026-01-31T12:00:00Z"));
        let offset = ("utc_offset_s".to_owned(), json!(0.0));
        ReadOptions {
            kind: self.kind,
            options: [start, offset].into_iter().collect(),
            ..ReadOptions::default()
        }
    }
}

const DETECTIONS: &str = "time_s,sensor_id,scan,detection_id,truth_id,amplitude,x_m,y_m\n\
    0,radar,1,d1,A,1.5,100,200\n0,radar,1,d2,,2.5,-40,3e2\n4,radar,2,d3,A,1,110,210.5\n";
const POLAR: &str = "time_s,sensor_id,scan,detection_id,range_m,bearing_deg\n\
    0,radar,1,d1,1000,45\n0,radar,1,d2,2000.5,359.9\n4,radar,2,d3,990,44\n";
const BEARINGS: &str =
    "time_s,sensor_id,scan,detection_id,bearing_deg\n0,sonar,1,d1,45\n1,sonar,2,d2,46.5\n";
const TRUTH: &str =
    "time_s,truth_id,x_m,y_m,vx_mps,vy_mps\n0,A,1,2,3,4\n1,A,4,6,3,4\n0,B,-1,-2,,\n";
const GEOGRAPHIC: &str = "time_s,truth_id,lat_deg,lon_deg,height_m\n\
    2026-01-31T12:00:00Z,A,50.77,-1.2,10\n2026-01-31T12:00:10Z,A,50.78,-1.21,11\n";
const VOLUME: &str = "time_s,truth_id,x_m,y_m,z_m\n0,A,1,2,3\n1,A,4,6,-9\n";
const TRACKS: &str = "time_s,track_id,x_m,y_m,vx_mps,vy_mps,status\n\
    0,T1,1,2,3,4,tentative\n1,T1,4,6,3,4,confirmed\n0,T2,5,5,0,0,coasted\n";
const RECORD: &str = "time_s,0,90,180,270\n0,1,2,3,4\n2,5,6,7,8\n";
const SHIPS: &str = "Time, MMSI, Latitude_degrees, Longitude_degrees, COG_degrees, SOG_knots\n\
    2016-01-12 13:02:11.218,235070762,50.773,-1.0929,157.8,5.9\n2016-01-12 13:02:21.218,235070762,50.7731,-1.0929,360,5.9\n";
const STATES: &str = "time,icao24,lat,lon,velocity,heading,vertrate,callsign,onground,squawk,baroaltitude,geoaltitude,lastposupdate,lastcontact\n\
    1626098400,3c4591,51.4,-0.44,254.6,99.6,0,BOX413,False,1174,10668,10843,1626098398.9,1626098399\n";
const COLUMNS: &str =
    r#"{"columns": {"time_s": [0, 1], "truth_id": ["A", "A"], "x_m": [1, 4.5], "y_m": [2, 6]}}"#;
const ROWS: &str = r#"[{"time_s": 0, "truth_id": "A", "x_m": 1, "y_m": 2}, {"time_s": 1, "truth_id": "A", "x_m": 4, "y_m": 6}]"#;
const TRAFFIC_ROWS: &str = r#"[{"timestamp": 1533101250000, "icao24": "3003ae", "callsign": "DLH8JW", "latitude": 45.8, "longitude": 9.2, "altitude": 34975.0, "groundspeed": 443.4, "track": 324.2, "vertical_rate": 960.0}]"#;
const TRAFFIC_COLUMNS: &str = r#"{"timestamp": {"0": 1533101250000}, "icao24": {"0": "3003ae"}, "callsign": {"0": "DLH8JW"}, "latitude": {"0": 45.8}, "longitude": {"0": 9.2}, "altitude": {"0": 34975.0}, "groundspeed": {"0": 443.4}, "track": {"0": 324.2}, "vertical_rate": {"0": 960.0}}"#;
const FERRY: &str = r#"[{"sensorID": 2, "ownshipPosition": [1.0, 2.0], "time": 100.0, "measurement": [[3.0, 4.0], [5.0, 6.0]]}, {"sensorID": 4, "ownshipPosition": [1.0, 2.0], "time": 100.5, "measurement": [0.5, -1.5]}]"#;
const FERRY_TRUTH: &str = r#"[[{"targetID": 1, "position": [3.0, 4.0, 0], "time": 100.0}, {"targetID": 2, "position": [5.0, 6.0, 0], "time": 100.0}]]"#;
const BOXES: &str = "1,1,399,182,121,229,1,-1,-1,-1\n2,1,400,182,121,229,0.5,-1,-1,-1\n";
/// From the page "AIVDM/AIVDO protocol decoding" of the gpsd project.
const SENTENCES: &str = "# a comment\n!AIVDM,1,1,,B,177KQJ5000G?tO`K>RA1wUbN0TKH,0*5C\n\
    !AIVDM,1,1,,A,B5NJ;PP005l4ot5Isbl03wsUkP06,0*76\n!AIVDM,1,1,,B,91b55wi;hbOS@OdQAC062Ch2089h,0*30\n\
    !AIVDM,1,1,,B,C5N3SRgPEnJGEBT>NhWAwwo862PaLELTBJ:V00000000S0D:R220,0*0B\n\
    !AIVDM,2,1,3,B,55P5TL01VIaAL@7WKO@mBplU@<PDhh000000001S;AJ::4A80?4i@E53,0*3E\n!AIVDM,2,2,3,B,1@0000000000000,2*55\n";
/// From J. Sun, The 1090 Megahertz Riddle: two positions, a callsign.
const FRAMES: [&str; 3] = [
    "8D40621D58C382D690C8AC2863A7",
    "8D40621D58C386435CC412692AD6",
    "8D4840D6202CC371C32CE0576098",
];
const BASE_STATION: &str = "MSG,3,1,1,40621D,1,2026/01/31,12:00:00.000,2026/01/31,12:00:00.000,,38000,,,52.2572,3.9194,,,,,,0\n\
    MSG,1,1,1,40621D,1,2026/01/31,12:00:01.000,2026/01/31,12:00:01.000,KLM1302,,,,,,,,,,,\n";
const WAY: &str = r#"<?xml version="1.0"?><gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1"><trk><name>a</name><trkseg><trkpt lat="50.1" lon="-1.2"><ele>3</ele><time>2026-01-31T12:00:00Z</time></trkpt><trkpt lat="50.101" lon="-1.2"><time>2026-01-31T12:00:10Z</time></trkpt></trkseg></trk></gpx>"#;

fn texts() -> Vec<Seed> {
    let seed = |(name, format, text): (&'static str, &'static str, &str)| Seed {
        name,
        format,
        bytes: text.as_bytes().to_vec(),
        kind: (format == "mot").then_some(DatasetKind::Truth),
    };
    let texts = [
        ("detections", "csv", DETECTIONS),
        ("polar", "csv", POLAR),
        ("bearings", "csv", BEARINGS),
        ("truth", "csv", TRUTH),
        ("geographic", "csv", GEOGRAPHIC),
        ("volume", "csv", VOLUME),
        ("tracks", "csv", TRACKS),
        ("record", "csv", RECORD),
        ("ships", "csv", SHIPS),
        ("states", "csv", STATES),
        ("columns", "json", COLUMNS),
        ("rows", "json", ROWS),
        ("traffic rows", "json", TRAFFIC_ROWS),
        ("traffic columns", "json", TRAFFIC_COLUMNS),
        ("ferry", "autoferry", FERRY),
        ("ferry truth", "autoferry", FERRY_TRUTH),
        ("boxes", "mot", BOXES),
        ("sentences", "ais", SENTENCES),
        ("base station", "mode_s", BASE_STATION),
        ("way", "gpx", WAY),
    ];
    texts.into_iter().map(seed).collect()
}

fn binary(name: &'static str, format: &'static str, bytes: Vec<u8>) -> Seed {
    Seed {
        name,
        format,
        bytes,
        kind: None,
    }
}

fn octets(hex: &str) -> Vec<u8> {
    let octet = |at: usize| u8::from_str_radix(&hex[at..at + 2], 16).unwrap();
    (0..hex.len()).step_by(2).map(octet).collect()
}

/// The frames in each framing, half a second apart. A counter at 0 says no time.
fn frames() -> Vec<Seed> {
    // What says no time cannot be used: the first frame only makes the reader meet one.
    let mut avr = format!("*{};\n", FRAMES[2]);
    let (mut beast, mut text) = (Vec::new(), String::new());
    for (index, frame) in FRAMES.iter().enumerate() {
        let ticks = 6_000_000 * (index as u64 + 1);
        avr.push_str(&format!("@{ticks:012X}{frame};\n"));
        let body = [&ticks.to_be_bytes()[2..], &[0x40], &octets(frame)[..]].concat();
        beast.extend([0x1a, 0x33]);
        for octet in body {
            let times = if octet == 0x1a { 2 } else { 1 };
            beast.extend(std::iter::repeat_n(octet, times));
        }
        let seconds = 1_698_142_148.5 + 0.5 * index as f64;
        text.push_str(&format!("{seconds},1a3300000000000100{frame}\n"));
    }
    vec![
        binary("avr", "mode_s", avr.into_bytes()),
        binary("beast", "mode_s", beast),
        binary("rs1090", "mode_s", text.to_lowercase().into_bytes()),
    ]
}

const SOURCE: (u8, u8) = (25, 201);
const MOTION: Option<Motion> = Some(Motion {
    speed_mps: 200.0,
    course_rad: 1.5,
});

fn plots() -> Vec<PlotRecord> {
    let plot = |number: u16| PlotRecord {
        source: SOURCE,
        time_s: 45_826.0 + f64::from(number),
        place: Some((18_520.0 * f64::from(number), 1.0)),
        detection: 2,
        is_simulated: false,
        is_test: false,
        is_tentative: false,
        ends: false,
        mode_a: Some(0o1234),
        level_ft: Some(10_000.0),
        address: Some(0x3c_660c),
        callsign: Some("DLH65A".to_owned()),
        number: Some(number),
        motion: MOTION,
    };
    (1..4).map(plot).collect()
}

fn marks() -> Vec<MarkRecord> {
    let mark = |kind: u8| MarkRecord {
        source: SOURCE,
        time_s: 45_825.0,
        kind,
        sector: Some(64),
        rotation_s: Some(4.9),
        site: None,
    };
    vec![mark(1), mark(2)]
}

fn tracks() -> Vec<TrackRecord> {
    let track = |number: u16| TrackRecord {
        source: SOURCE,
        time_s: 45_826.0 + f64::from(number),
        number: 7,
        lat_deg: 45.1,
        lon_deg: 13.2 + 0.001 * f64::from(number),
        place_m: Some((1000.0, -2000.0)),
        velocity_mps: Some((80.0, 0.0)),
        covariance_m2: Some([100.0, 5.0, 90.0]),
        velocity_sigma_mps: Some((1.0, 1.0)),
        pressure_altitude_m: Some(5000.0),
        geometric_altitude_m: Some(5100.0),
        vertical_rate_mps: Some(1.0),
        status: TrackStatus::Confirmed,
        begins: number == 0,
        ends: number == 2,
        address: Some(0x3c_660c),
        callsign: Some("DLH65A".to_owned()),
        mode_a: Some(0o1234),
    };
    (0..3).map(track).collect()
}

fn reports() -> Vec<AdsbRecord> {
    let report = |number: u32| AdsbRecord {
        source: SOURCE,
        time_s: 45_826.0 + f64::from(number),
        address: 0x3c_660c,
        lat_deg: 45.1,
        lon_deg: 13.2 + 0.001 * f64::from(number),
        geometric_altitude_m: Some(5100.0),
        level_ft: Some(16_000.0),
        motion: MOTION,
        nacp: Some(8),
        is_on_ground: false,
        callsign: Some("DLH65A".to_owned()),
        mode_a: Some(0o1234),
    };
    (0..3).map(report).collect()
}

/// A capture of one datagram of raw IP on 25 February 2014.
fn capture(blocks: &[u8]) -> Vec<u8> {
    let datagram = blocks.len() as u16 + 8;
    let packet = datagram + 20;
    let words =
        |words: &[u32]| -> Vec<u8> { words.iter().flat_map(|word| word.to_le_bytes()).collect() };
    let mut file = words(&[0xa1b2_c3d4, 0x0004_0002, 0, 0, 65_535, 101]);
    let length = u32::from(packet);
    file.extend(words(&[1_393_332_227, 401_501, length, length]));
    file.extend([0x45, 0]);
    file.extend(packet.to_be_bytes());
    file.extend([0, 0, 0, 0, 64, 17, 0, 0, 10, 0, 0, 1, 232, 1, 1, 12]);
    file.extend([0x21, 0x34, 0x21, 0x34]);
    file.extend(datagram.to_be_bytes());
    file.extend([0, 0]);
    file.extend_from_slice(blocks);
    file
}

fn blocks() -> Vec<Seed> {
    let radar = [encode_marks(&marks()), encode_plots(&plots())].concat();
    let old_radar = [encode_marks_002(&marks()), encode_plots_001(&plots())].concat();
    let frame = [
        &(radar.len() as u16 + 6).to_be_bytes()[..],
        &45_826_101_u32.to_be_bytes(),
        &radar,
    ];
    vec![
        binary("oradis in a capture", "asterix", capture(&frame.concat())),
        binary("capture", "asterix", capture(&radar)),
        binary("048", "asterix", radar),
        binary("001", "asterix", old_radar),
        binary("062", "asterix", encode_tracks(&tracks())),
        binary("021", "asterix", encode_adsb(&reports())),
    ]
}

fn gzip(name: &'static str, format: &'static str, text: &str) -> Seed {
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(text.as_bytes()).unwrap();
    binary(name, format, packed.finish().unwrap())
}

/// Truth as another format holds it.
fn written(name: &'static str) -> Option<Seed> {
    let options = ReadOptions::default();
    let (read, _) = read_file("a.csv", &mut TRUTH.as_bytes(), None, &options).unwrap();
    let mut bytes = Vec::new();
    (writer_named(name)?.write)(&read.dataset, &mut bytes).ok()?;
    Some(binary(name, name, bytes))
}

pub fn seeds() -> Vec<Seed> {
    let mut seeds = texts();
    seeds.extend(frames());
    seeds.extend(blocks());
    seeds.push(gzip("packed truth", "csv", TRUTH));
    seeds.push(gzip("packed sentences", "ais", SENTENCES));
    #[cfg(feature = "parquet")]
    {
        seeds.extend(["parquet", "arrow"].into_iter().filter_map(written));
        let packed = crate::formats::packed_columns::packed();
        seeds.extend(
            packed
                .into_iter()
                .map(|(name, bytes)| binary(name, name, bytes)),
        );
    }
    seeds
}
