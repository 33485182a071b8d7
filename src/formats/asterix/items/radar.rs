//! Categories 001, 048 (plots and local tracks of a radar) and 002, 034 (its service messages).

use super::{Service, Target, TimeSaid, address, of_day, on_each_axis, source, special};
use crate::formats::asterix::octets::{
    Callsign, FOOT, NM, flight_level_ft, mode_a, octet, polar, polar_motion, polar_of_plane,
    signed, signed_pair, time_of_day, unsigned, unsigned_pair,
};
use crate::formats::asterix::walk::Items;
use crate::formats::feed::{Site, Spot};

/// CAT048.
pub fn target(items: &Items) -> Target {
    let descriptor = items.get(20).unwrap_or_default();
    let kind = items.get(20).map(|item| octet(item, 0) >> 5);
    let height = items.get(110).map(height_of_3d);
    Target {
        time: of_day(items, 140),
        spot: spot(items, NM / 256.0, NM / 128.0),
        track_sigma_m: items
            .get(210)
            .map(|item| on_each_axis(unsigned_pair(&item[..2], NM / 128.0))),
        report_kind: match kind {
            Some(1) => Some("psr"),
            Some(2) => Some("ssr"),
            Some(3) => Some("combined"),
            Some(4..=7) => Some("mode_s"),
            _ => None,
        },
        address: items.get(220).map(address),
        callsign: items.get(240).and_then(Callsign::of),
        number: items.get(161).map(|item| unsigned(item) as u16 & 0x0fff),
        special: special(
            octet(descriptor, 0) & 0x10 != 0,
            octet(descriptor, 1) & 0x80 != 0,
            octet(descriptor, 0) & 0x02 != 0,
        ),
        ..said_alike(items, kind, height)
    }
}

/// CAT001.
pub fn plot_or_track(items: &Items) -> Target {
    let descriptor = items.get(20).unwrap_or_default();
    let kind = items.get(20).map(|item| octet(item, 0) >> 4 & 3);
    Target {
        time: items
            .get(141)
            .map(|item| TimeSaid::Truncated(time_of_day(item))),
        spot: spot(items, NM / 128.0, NM / 64.0),
        report_kind: match kind {
            Some(1) => Some("psr"),
            Some(2) => Some("ssr"),
            Some(3) => Some("combined"),
            _ => None,
        },
        number: items.get(161).map(|item| unsigned(item) as u16),
        special: special(
            octet(descriptor, 0) & 0x40 != 0,
            octet(descriptor, 1) & 0x80 != 0,
            octet(descriptor, 0) & 0x02 != 0,
        ),
        ..said_alike(items, kind, None)
    }
}

/// What both say alike.
fn said_alike(items: &Items, kind: Option<u8>, height_of_radar_m: Option<f64>) -> Target {
    let status = items.get(170).unwrap_or_default();
    let mode_c_ft = items.get(90).and_then(flight_level_ft);
    Target {
        source: source(items),
        height_m: mode_c_ft.map(|feet| feet * FOOT).or(height_of_radar_m),
        mode_c_ft,
        mode_a: items.get(70).and_then(mode_a),
        motion: items.get(200).map(polar_motion),
        is_extrapolated: kind == Some(0),
        is_tentative: octet(status, 0) & 0x80 != 0,
        is_coasted: kind == Some(0),
        ends: octet(status, 1) & 0x80 != 0,
        ..Target::default()
    }
}

/// The measured position; where it lacks, the calculated one.
fn spot(items: &Items, range_step_m: f64, plane_step_m: f64) -> Option<Spot> {
    let measured = items.get(40).map(|item| polar(item, range_step_m));
    measured.or_else(|| {
        let item = items.get(42)?;
        Some(polar_of_plane(item, plane_step_m))
    })
}

/// Of 14 bits in steps of 25 ft.
fn height_of_3d(item: &[u8]) -> f64 {
    let steps = (unsigned(item) as u16) << 2;
    f64::from(steps as i16 >> 2) * 25.0 * FOOT
}

/// CAT034 and CAT002.
pub fn service(items: &Items) -> Service {
    Service {
        is_north: items.get(0) == Some(&[1]),
        rotation_s: items.get(41).map(time_of_day),
        site: items.get(120).map(site),
        ..super::service(items, 30)
    }
}

fn site(item: &[u8]) -> Site {
    let (height, place) = item.split_at(2);
    let (lat_deg, lon_deg) = signed_pair(place, 180.0 / 2f64.powi(23));
    Site {
        lat_deg,
        lon_deg,
        height_m: signed(height) as f64,
    }
}
