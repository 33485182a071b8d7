//! Slant ranges of radars without elevations, turned into ranges along the ground: with the height that a detection tells, else the
//! one that is assumed of the sensor's targets.
//!
//! # Symbols
//! r slant range, h height of the target, h_s of the sensor, g range along the ground.
//!
//! # Method
//! On data without an origin on the Earth the ground is flat: g = √(r² − (h − h_s)²), and 0 where the range is shorter than the
//! difference of heights. Else the place at r and h over the ellipsoid is found, and g and the bearing are those in the plane.
//! Range rates grow by r/g.

use crate::experiment::input::extent::place_of;
use crate::filtering::AnyFilter;
use crate::geodesy::{Geodetic, Stereographic, at_slant_range};
use crate::model::scan::{Measurement, Recording, RecordingParts};
use crate::model::sensor::SensorSettings;
use crate::model::space::{Frame, Space};
use std::borrow::Cow;

/// The recording as a tracker of the plane takes it.
pub fn along_ground<'r>(
    recording: &'r Recording,
    known: &[SensorSettings],
    filter: &AnyFilter,
    warnings: &mut Vec<String>,
) -> Cow<'r, Recording> {
    let is_slant = |settings: &SensorSettings| settings.assumed_altitude_m.is_some();
    if filter.space() != Space::Plane || !known.iter().any(is_slant) {
        return Cow::Borrowed(recording);
    }
    for settings in known.iter().filter(|settings| is_slant(settings)) {
        if own_height_m(settings).is_none() {
            warnings.push(format!(
                "sensor '{}': how high it stands is not known; its slant ranges are taken from 0",
                settings.sensor_id
            ));
        }
    }
    let (frame, mut parts) = (recording.frame, recording.clone().into_parts());
    let RecordingParts { scans, beside, .. } = &mut parts;
    let mut index = 0;
    for scan in scans {
        let settings = &known[scan.sensor];
        for detection in &mut scan.detections {
            let told_m = beside.heights_m.get(index).copied().flatten();
            index += 1;
            if let Some(assumed_m) = settings.assumed_altitude_m {
                let height_m = told_m.unwrap_or(assumed_m);
                detection.measurement = lowered(&detection.measurement, settings, frame, height_m);
            }
        }
    }
    // What was sound stays so.
    Recording::new(parts).map_or(Cow::Borrowed(recording), Cow::Owned)
}

fn own_height_m(settings: &SensorSettings) -> Option<f64> {
    settings.height_m.or(settings.z_m)
}

/// A slant range and its bearing along the ground; other reports stay what they are.
fn lowered(
    measurement: &Measurement,
    settings: &SensorSettings,
    frame: Option<Frame>,
    height_m: f64,
) -> Measurement {
    let Measurement::RangeBearing {
        range_m,
        bearing_rad,
        range_rate_mps,
    } = *measurement
    else {
        return *measurement;
    };
    let own_m = own_height_m(settings).unwrap_or(0.0);
    let site = settings.lat_deg.zip(settings.lon_deg);
    let (ground_m, bearing_rad) = match frame.zip(site) {
        Some((frame, (lat_deg, lon_deg))) => {
            let site = Geodetic {
                lat_deg,
                lon_deg,
                height_m: own_m,
            };
            let there = at_slant_range(&site, range_m, bearing_rad, Some(height_m));
            let plane = Stereographic::from(frame);
            let away_m = plane.project(there.lat_deg, there.lon_deg) - place_of(settings);
            (away_m.norm(), away_m.x.atan2(away_m.y))
        }
        None => {
            let rise_m = height_m - own_m;
            let square_m2 = (range_m - rise_m) * (range_m + rise_m);
            (square_m2.max(0.0).sqrt(), bearing_rad)
        }
    };
    Measurement::RangeBearing {
        range_m: ground_m,
        bearing_rad,
        range_rate_mps: range_rate_mps.map(|rate_mps| rate_mps * range_m / ground_m.max(1.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::state::Position;

    const POLAR: Measurement = Measurement::RangeBearing {
        range_m: 10_000.0,
        bearing_rad: 0.5,
        range_rate_mps: Some(-95.0),
    };

    #[test]
    fn ten_kilometres_up_to_three_are_461_m_less_along_the_ground() {
        let settings = SensorSettings {
            height_m: Some(100.0),
            ..SensorSettings::named("radar")
        };
        let Measurement::RangeBearing {
            range_m,
            bearing_rad,
            range_rate_mps,
        } = lowered(&POLAR, &settings, None, 3100.0)
        else {
            panic!("a range and a bearing")
        };
        assert!(
            (10_000.0 - range_m - 460.607_985_8).abs() < 1e-6,
            "{range_m}"
        );
        assert_eq!(bearing_rad, 0.5);
        // A target that comes along the ground at 99.587 m/s.
        assert!((range_rate_mps.unwrap() + 95.0 / 0.953_939_201_4).abs() < 1e-6);
        let over = lowered(&POLAR, &settings, None, 20_000.0);
        assert!(matches!(
            over,
            Measurement::RangeBearing { range_m: 0.0, .. }
        ));
    }

    #[test]
    fn on_the_earth_the_ground_falls_away() {
        // 300 km away and 11 km up: on flat ground g would be 299 798 m.
        let frame = Frame::new(50.1109, 8.6821, 0.0).unwrap();
        let settings = SensorSettings {
            lat_deg: Some(50.1109),
            lon_deg: Some(8.6821),
            height_m: Some(112.0),
            x_m: Some(0.0),
            y_m: Some(0.0),
            ..SensorSettings::named("radar")
        };
        let far = Measurement::RangeBearing {
            range_m: 308_873.476_928_3,
            bearing_rad: 308.867_664_500_5_f64.to_radians(),
            range_rate_mps: None,
        };
        let Measurement::RangeBearing {
            range_m,
            bearing_rad,
            ..
        } = lowered(&far, &settings, Some(frame), 11_000.0)
        else {
            panic!("a range and a bearing")
        };
        // The slant range, bearing and height of the worked target of two sites, at 51.8 N 5.2 E.
        let wanted_m = Stereographic::from(frame).project(51.8, 5.2);
        let place_m = Position::new(bearing_rad.sin(), bearing_rad.cos()) * range_m;
        assert!((place_m - wanted_m).norm() < 1e-3, "{place_m} {wanted_m}");
    }
}
