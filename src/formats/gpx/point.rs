//! A point of a track: what its tags say.

use crate::formats::Reason;
use crate::formats::feed::{Motion, Spot, civil};
use quick_xml::events::BytesStart;
use std::str;

/// What is read of a point; speed and course are of GPX 1.0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Value {
    Elevation,
    Time,
    Speed,
    Course,
}

impl Value {
    pub fn named(name: &[u8]) -> Option<Self> {
        match name {
            b"ele" => Some(Value::Elevation),
            b"time" => Some(Value::Time),
            b"speed" => Some(Value::Speed),
            b"course" => Some(Value::Course),
            _ => None,
        }
    }
}

/// A point as far as it is read.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Point {
    lat_deg: f64,
    lon_deg: f64,
    height_m: Option<f64>,
    time_s: Option<f64>,
    speed_mps: Option<f64>,
    course_deg: Option<f64>,
    /// The first thing that is wrong.
    fault: Option<Reason>,
}

/// A sound point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fix {
    pub time_s: f64,
    pub spot: Spot,
    pub height_m: Option<f64>,
    pub motion: Option<Motion>,
}

impl Point {
    pub fn at(start: &BytesStart<'_>) -> Self {
        let degrees = |name: &str, most: f64| {
            let attribute = start.try_get_attribute(name).ok().flatten();
            let attribute = attribute.ok_or(Reason::Malformed)?;
            let text = str::from_utf8(&attribute.value).map_err(|_| Reason::Malformed)?;
            let degrees = number(text.trim())?;
            if degrees.abs() <= most {
                Ok(degrees)
            } else {
                Err(Reason::OutOfRange)
            }
        };
        match (degrees("lat", 90.0), degrees("lon", 180.0)) {
            (Ok(lat_deg), Ok(lon_deg)) => Point {
                lat_deg,
                lon_deg,
                ..Point::default()
            },
            (Err(reason), _) | (_, Err(reason)) => Point {
                fault: Some(reason),
                ..Point::default()
            },
        }
    }

    /// Takes the text of a value; an empty one is none.
    pub fn set(&mut self, value: Value, text: &str, utc_offset_s: Option<f64>) {
        if text.is_empty() {
            return;
        }
        let read = match value {
            Value::Time => time_s(text, utc_offset_s),
            _ => number(text),
        };
        let place = match value {
            Value::Elevation => &mut self.height_m,
            Value::Time => &mut self.time_s,
            Value::Speed => &mut self.speed_mps,
            Value::Course => &mut self.course_deg,
        };
        match read {
            Ok(number) => *place = Some(number),
            Err(reason) => self.fault = self.fault.or(Some(reason)),
        }
    }

    pub fn finish(&self) -> Result<Fix, Reason> {
        if let Some(reason) = self.fault {
            return Err(reason);
        }
        let motion = |speed_mps: f64| {
            Some(Motion {
                speed_mps,
                course_rad: self.course_deg?.to_radians(),
            })
        };
        Ok(Fix {
            time_s: self.time_s.ok_or(Reason::NoTime)?,
            spot: Spot::Geographic {
                lat_deg: self.lat_deg,
                lon_deg: self.lon_deg,
            },
            height_m: self.height_m,
            motion: self.speed_mps.and_then(motion),
        })
    }
}

fn number(text: &str) -> Result<f64, Reason> {
    let number: f64 = text.parse().map_err(|_| Reason::Malformed)?;
    if number.is_finite() {
        Ok(number)
    } else {
        Err(Reason::NotFinite)
    }
}

/// A time that lacks its zone is none.
fn time_s(text: &str, utc_offset_s: Option<f64>) -> Result<f64, Reason> {
    let is_local = || civil::instant(text, Some(0.0)).is_some();
    civil::instant(text, utc_offset_s).ok_or_else(|| {
        if is_local() {
            Reason::NoTime
        } else {
            Reason::Malformed
        }
    })
}
