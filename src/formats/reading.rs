//! What a reader may be told of a file besides its content, whatever its format: where its origin is, how its times are written,
//! how much of it may be wrong.

use super::clock::Clock;
use super::options::FormatOptions;
use crate::model::fault::Fault;
use crate::model::space::Frame;
use crate::model::time::TimeBase;
use crate::registry::{Field, Kind, Object, above, default, list, number, optional, required};
use serde::Deserialize;

const LATITUDE: Kind = number(-90.0, 90.0, "deg");
const LONGITUDE: Kind = number(-180.0, 180.0, "deg");
const HEIGHT: Kind = number(-20_000.0, 1e8, "m");
const SHORT_TEXT: Kind = Kind::Text { max_length: 100 };

static FRAME: Object = Object {
    name: "Frame",
    summary: "A place on the Earth (WGS 84), the origin of a plane that touches there.",
    fields: &[
        required("lat_deg", "Latitude.", LATITUDE),
        required("lon_deg", "Longitude.", LONGITUDE),
        default("height_m", "Height above the ellipsoid.", HEIGHT, "0.0"),
    ],
};

static SITE: Object = Object {
    name: "SensorSite",
    summary: "Where a sensor of a file stands.",
    fields: &[
        required("sensor_id", "Its name in the file.", SHORT_TEXT),
        required("lat_deg", "Latitude.", LATITUDE),
        required("lon_deg", "Longitude.", LONGITUDE),
        default("height_m", "Height above the ellipsoid.", HEIGHT, "0.0"),
    ],
};
const SITE_KIND: Kind = Kind::Object(&SITE);

/// The fields of [`Reading`].
pub const READING: &[Field] = &[
    optional(
        "origin",
        "Where the plane of the data touches the Earth; chosen from the data when absent.",
        Kind::Object(&FRAME),
    ),
    optional(
        "time_format",
        "How times are written, in the letters of strptime, such as %d/%m/%Y %H:%M:%S; told from the file when absent.",
        SHORT_TEXT,
    ),
    optional(
        "encoding",
        "How a text is encoded, such as windows-1252; UTF-8, or UTF-16 with a byte order mark, when absent.",
        SHORT_TEXT,
    ),
    optional(
        "utc_offset_s",
        "How far the clock of times without a zone is ahead of UTC.",
        number(-86_400.0, 86_400.0, "s"),
    ),
    optional(
        "clock_offset_s",
        "Added to every time: the offset between this clock and another.",
        number(-1e9, 1e9, "s"),
    ),
    optional(
        "time_base",
        "What numbers are seconds from: `utc` of 1970-01-01 00:00 UTC; `relative` when absent.",
        Kind::Choice(&["utc", "assumed_date", "relative"]),
    ),
    optional(
        "date",
        "The day (YYYY-MM-DD, UTC) of times of day.",
        SHORT_TEXT,
    ),
    optional(
        "start",
        "The time (ISO 8601) of the first unit of a feed without times.",
        SHORT_TEXT,
    ),
    optional(
        "receiver",
        "Where the receiver stands; surface positions of Mode S need it.",
        Kind::Object(&FRAME),
    ),
    optional(
        "sites",
        "Where sensors stand that the file does not place.",
        list(&SITE_KIND, 1, 64),
    ),
    optional(
        "max_rejected",
        "Share of units that may be wrong; 0 of canonical tables, 0.01 of other tables, 0.25 of what comes off the air.",
        number(0.0, 1.0, ""),
    ),
    optional(
        "identity",
        "`drop` forgets whose each report is, which makes an association problem of a recording that knows.",
        Kind::Choice(&["keep", "drop"]),
    ),
    optional(
        "frame_s",
        "Period of the scans that reports without scans are gathered in; 10 when absent.",
        above(0.0, 86_400.0, "s"),
    ),
    optional(
        "path_gap_s",
        "Silence after which the path of an identity begins anew; 600 when absent, 60 of tracks.",
        above(0.0, 1e9, "s"),
    ),
    optional(
        "max_speed_mps",
        "Reports that imply more are rejected as jumps; 1000 of aircraft, 60 of ships when absent.",
        above(0.0, 1e9, "m/s"),
    ),
    optional(
        "assumed_height_m",
        "Height of targets of a radar that does not know it.",
        HEIGHT,
    ),
    optional(
        "test_targets",
        "Whether test and simulated targets are used.",
        Kind::Flag,
    ),
    optional(
        "editions",
        "The edition of each ASTERIX category of the file, such as {\"021\": \"0.26\"}.",
        Kind::TextMap {
            max_entries: 16,
            max_length: 10,
        },
    ),
];

/// What a reader was told. What is absent is told from the file, or is what the field says.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct Reading {
    pub origin: Option<Frame>,
    pub time_format: Option<String>,
    pub utc_offset_s: Option<f64>,
    pub clock_offset_s: Option<f64>,
    pub time_base: Option<TimeBase>,
    pub date: Option<String>,
    pub start: Option<String>,
    pub receiver: Option<Frame>,
    pub sites: Vec<SensorSite>,
    pub max_rejected: Option<f64>,
    pub identity: Option<Identity>,
    pub frame_s: Option<f64>,
    pub path_gap_s: Option<f64>,
    pub max_speed_mps: Option<f64>,
    pub assumed_height_m: Option<f64>,
    pub test_targets: bool,
    pub editions: std::collections::BTreeMap<String, String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Identity {
    Keep,
    Drop,
}

/// Where a sensor of a file stands.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct SensorSite {
    pub sensor_id: String,
    pub lat_deg: f64,
    pub lon_deg: f64,
    #[serde(default)]
    pub height_m: f64,
}

impl Reading {
    /// # Errors
    /// What no table can check: a day or a time that is none. Each names the field.
    pub fn of(options: &FormatOptions) -> Result<Self, Vec<Fault>> {
        let reading: Reading = options
            .parse()
            .map_err(|error| vec![Fault::new("/meta", "malformed", error.to_string())])?;
        let mut faults = Vec::new();
        for (name, text) in [
            ("date", reading.day_s().err()),
            ("start", reading.start_s().err()),
        ] {
            if let Some(text) = text {
                let detail = format!("'{text}' is not a {name}");
                faults.push(
                    Fault::new(format!("/meta/{name}"), "malformed", detail)
                        .allowing("YYYY-MM-DD, of a start also THH:MM:SS[.s]Z"),
                );
            }
        }
        if faults.is_empty() {
            Ok(reading)
        } else {
            Err(faults)
        }
    }

    /// The beginning of the day that times of day are of (Unix s).
    ///
    /// # Errors
    /// The text that is no day.
    pub fn day_s(&self) -> Result<Option<f64>, String> {
        read_utc(self.date.as_deref())
    }

    /// The time of the first unit of a feed without times (Unix s).
    ///
    /// # Errors
    /// The text that is no time.
    pub fn start_s(&self) -> Result<Option<f64>, String> {
        read_utc(self.start.as_deref())
    }
}

fn read_utc(text: Option<&str>) -> Result<Option<f64>, String> {
    let Some(text) = text else { return Ok(None) };
    let mut clock = Clock::default();
    match clock.read(text) {
        Ok(time_s) if clock.base().is_utc() => Ok(Some(time_s)),
        _ => Err(text.to_owned()),
    }
}
