//! Categories 010 (surface movement), 011 (its fused tracks) and 020 (multilateration).

use super::{Target, address, of_day, on_each_axis, source, special};
use crate::formats::asterix::octets::{
    Callsign, FOOT, QUARTER_LEVEL_FT, flight_level_ft, geographic, mode_a, octet, plane,
    plane_motion, polar, polar_motion, signed, unsigned, unsigned_pair,
};
use crate::formats::asterix::walk::Items;
use crate::formats::feed::{Motion, Spot};

/// CAT010.
pub fn movement(items: &Items) -> Target {
    let descriptor = items.get(20).unwrap_or_default();
    let polar_spot = items.get(40).map(|item| polar(item, 1.0));
    let polar_speed = items.get(200).map(polar_motion);
    Target {
        spot: spot(items, 31, 1.0).or(polar_spot),
        motion: motion(items, 0.0625).or(polar_speed),
        sigma_m: items
            .get(500)
            .map(|item| on_each_axis(unsigned_pair(&item[..2], 0.25))),
        report_kind: match octet(descriptor, 0) >> 5 {
            _ if descriptor.is_empty() => None,
            0 | 1 | 5 => Some("mlat"),
            2 => Some("adsb"),
            3 => Some("psr"),
            _ => None,
        },
        on_ground: items.get(20).map(|item| octet(item, 0) & 0x04 != 0),
        special: special(
            octet(descriptor, 1) & 0x80 != 0,
            octet(descriptor, 1) & 0x40 != 0,
            octet(descriptor, 1) & 0x20 != 0,
        ),
        ..of_cooperative(items, 0x30, &[91])
    }
}

/// CAT020.
pub fn multilateration(items: &Items) -> Target {
    let descriptor = items.get(20).unwrap_or_default();
    Target {
        spot: spot(items, 25, 0.5),
        motion: motion(items, 0.25),
        mode_a: items.get(70).and_then(mode_a),
        sigma_m: items
            .part(500, 1)
            .map(|item| on_each_axis(unsigned_pair(&item[..4], 0.25))),
        report_kind: Some("mlat"),
        on_ground: descriptor.get(1).map(|octet| octet & 0x10 != 0),
        special: special(
            octet(descriptor, 1) & 0x04 != 0,
            octet(descriptor, 1) & 0x02 != 0,
            octet(descriptor, 1) & 0x80 != 0,
        ),
        ..of_cooperative(items, 0x20, &[105, 110])
    }
}

/// What both say alike. `coasting` are the bits of the track's status for extrapolation, `heights` the items with a height in
/// steps of 6.25 ft.
fn of_cooperative(items: &Items, coasting: u8, heights: &[u16]) -> Target {
    let status = octet(items.get(170).unwrap_or_default(), 0);
    let mode_c_ft = items.get(90).and_then(flight_level_ft);
    let height_ft = heights.iter().find_map(|item| items.get(*item));
    let height_ft = height_ft.map(|item| signed(item) as f64 * 6.25);
    Target {
        source: source(items),
        time: of_day(items, 140),
        height_m: mode_c_ft.or(height_ft).map(|feet| feet * FOOT),
        mode_c_ft,
        address: items.get(220).map(address),
        callsign: items.get(245).and_then(|item| Callsign::of(&item[1..])),
        mode_a: items.get(60).and_then(mode_a),
        number: items.get(161).map(|item| unsigned(item) as u16 & 0x0fff),
        is_tentative: status & 0x80 != 0,
        is_coasted: status & coasting != 0,
        ends: status & 0x40 != 0,
        ..Target::default()
    }
}

/// CAT011.
pub fn fused(items: &Items) -> Target {
    let status = items.get(170).unwrap_or_default();
    let mode_c_ft = items.get(90);
    let mode_c_ft = mode_c_ft.map(|item| signed(item) as f64 * QUARTER_LEVEL_FT);
    let geometric_ft = items.get(92).map(|item| signed(item) as f64 * 6.25);
    Target {
        source: source(items),
        time: of_day(items, 140),
        spot: spot(items, 31, 1.0),
        height_m: mode_c_ft.or(geometric_ft).map(|feet| feet * FOOT),
        mode_c_ft,
        motion: motion(items, 0.25),
        sigma_m: items
            .part(500, 0)
            .map(|item| on_each_axis(unsigned_pair(item, 0.25))),
        address: items.part(380, 1).map(address),
        callsign: items.get(245).and_then(|item| Callsign::of(&item[1..])),
        mode_a: items.get(60).and_then(mode_a),
        number: items.get(161).map(|item| unsigned(item) as u16 & 0x7fff),
        // A bit that is not set says nothing.
        on_ground: (octet(status, 0) & 0x40 != 0).then_some(true),
        special: special(octet(status, 1) & 0x80 != 0, false, false),
        is_tentative: octet(status, 0) & 0x02 != 0,
        is_coasted: octet(status, 2) & 0x20 != 0,
        begins: octet(status, 1) & 0x20 != 0,
        ends: octet(status, 1) & 0x40 != 0,
        ..Target::default()
    }
}

/// On the Earth, else about the system's reference point.
fn spot(items: &Items, power: i32, plane_step_m: f64) -> Option<Spot> {
    let geographic = items.get(41).map(|item| geographic(item, power));
    geographic.or_else(|| items.get(42).map(|item| plane(item, plane_step_m)))
}

fn motion(items: &Items, step_mps: f64) -> Option<Motion> {
    items.get(202).map(|item| plane_motion(item, step_mps))
}
