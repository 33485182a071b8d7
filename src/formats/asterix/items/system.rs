//! Category 062: system tracks.

use super::{Target, address, of_day, on_each_axis, source, special};
use crate::formats::asterix::octets::{
    Callsign, FOOT, QUARTER_LEVEL_FT, geographic, mode_a, octet, plane, plane_motion, signed,
    unsigned, unsigned_pair,
};
use crate::formats::asterix::walk::Items;

/// Editions from 1.16.
pub fn track(items: &Items) -> Target {
    let status = items.get(80).unwrap_or_default();
    let mode_c_ft = items.get(136);
    let mode_c_ft = mode_c_ft.map(|item| signed(item) as f64 * QUARTER_LEVEL_FT);
    let geographic = items.get(105).map(|item| geographic(item, 25));
    let of_plane = items.get(100).map(|item| plane(item, 0.5));
    let downlinked = items.part(380, 1).and_then(Callsign::of);
    let named = items.get(245).and_then(|item| Callsign::of(&item[1..]));
    Target {
        source: source(items),
        time: of_day(items, 70),
        spot: geographic.or(of_plane),
        height_m: mode_c_ft.or(height_ft(items)).map(|feet| feet * FOOT),
        mode_c_ft,
        motion: items.get(185).map(|item| plane_motion(item, 0.25)),
        sigma_m: items
            .part(500, 0)
            .map(|item| on_each_axis(unsigned_pair(item, 0.5))),
        address: items.part(380, 0).map(address),
        callsign: downlinked.or(named),
        mode_a: items.get(60).and_then(mode_a),
        number: items.get(40).map(|item| unsigned(item) as u16),
        on_ground: items.part(380, 10).and_then(ground_bit),
        special: special(octet(status, 1) & 0x80 != 0, false, false),
        is_tentative: octet(status, 0) & 0x02 != 0,
        is_coasted: octet(status, 3) & 0x80 != 0,
        begins: octet(status, 1) & 0x20 != 0,
        ends: octet(status, 1) & 0x40 != 0,
        ..Target::default()
    }
}

/// A bit that is not set says nothing.
fn ground_bit(item: &[u8]) -> Option<bool> {
    (item[0] & 0x02 != 0).then_some(true)
}

/// Calculated: barometric (15 bits behind one that says whether QNH is applied), else geometric.
fn height_ft(items: &Items) -> Option<f64> {
    let barometric = items.get(135);
    let barometric = barometric.map(|item| (unsigned(item) as u16) << 1);
    let barometric = barometric.map(|bits| f64::from(bits as i16 >> 1) * QUARTER_LEVEL_FT);
    barometric.or_else(|| Some(signed(items.get(130)?) as f64 * 6.25))
}
