//! Category 021: reports of ADS-B.

use super::{Target, TimeSaid, address, of_day, source, special};
use crate::formats::asterix::octets::{
    Callsign, FOOT, QUARTER_LEVEL_FT, geographic, mode_a, octet, polar_motion, signed, time_of_day,
    unsigned,
};
use crate::formats::asterix::walk::Items;

const DAY_S: f64 = 86_400.0;

/// Radius that holds the position with 95 % (m) by NACp as in DO-260B; 0 says nothing.
const RADIUS_M: [f64; 12] = [
    f64::NAN,
    18_520.0,
    7408.0,
    3704.0,
    1852.0,
    926.0,
    555.6,
    185.2,
    92.6,
    30.0,
    10.0,
    3.0,
];

/// That radius of a circular Gaussian in standard deviations of an axis: √(−2 ln 0.05).
const RADIUS_SIGMAS: f64 = 2.447_746_830_680_816;

/// Editions from 1.0.
pub fn report(items: &Items) -> Target {
    let descriptor = items.get(40).unwrap_or_default();
    let precise = items.get(131).map(|item| geographic(item, 30));
    let coarse = items.get(130).map(|item| geographic(item, 23));
    Target {
        time: time(items),
        spot: precise.or(coarse),
        sigma_m: items.get(90).and_then(sigma_m),
        mode_a: items.get(70).and_then(mode_a),
        number: items.get(161).map(|item| unsigned(item) as u16 & 0x0fff),
        on_ground: descriptor.get(1).map(|octet| octet & 0x40 != 0),
        special: special(
            octet(descriptor, 1) & 0x20 != 0,
            octet(descriptor, 1) & 0x10 != 0,
            octet(descriptor, 0) & 0x02 != 0,
        ),
        ..of_any_edition(items)
    }
}

/// Editions 0.23 to 0.26.
pub fn draft_report(items: &Items) -> Target {
    let descriptor = octet(items.get(40).unwrap_or_default(), 0);
    Target {
        time: of_day(items, 30),
        spot: items.get(130).map(|item| geographic(item, 25)),
        mode_a: items.get(70).and_then(mode_a),
        on_ground: items.get(40).map(|item| octet(item, 0) & 0x40 != 0),
        special: special(
            descriptor & 0x20 != 0,
            descriptor & 0x10 != 0,
            descriptor & 0x08 != 0,
        ),
        ..of_any_edition(items)
    }
}

fn of_any_edition(items: &Items) -> Target {
    let mode_c_ft = items.get(145);
    let mode_c_ft = mode_c_ft.map(|item| signed(item) as f64 * QUARTER_LEVEL_FT);
    let geometric_ft = items.get(140).map(|item| signed(item) as f64 * 6.25);
    // The first bit says that the speed is beyond its range, or is a sign.
    let vector = items.get(160).filter(|item| item[0] & 0x80 == 0);
    Target {
        source: source(items),
        height_m: mode_c_ft.or(geometric_ft).map(|feet| feet * FOOT),
        mode_c_ft,
        motion: vector.map(polar_motion),
        report_kind: Some("adsb"),
        address: items.get(80).map(address),
        callsign: items.get(170).and_then(Callsign::of),
        ..Target::default()
    }
}

/// Of applicability, of reception, of transmission: the first that is said. Times of reception may be refined.
fn time(items: &Items) -> Option<TimeSaid> {
    let coarse = [(71, None), (73, Some(74)), (75, Some(76)), (77, None)];
    let (item, fine) = coarse
        .into_iter()
        .find_map(|(number, fine)| Some((items.get(number)?, fine)))?;
    let coarse_s = time_of_day(item);
    let fine = fine.and_then(|number| items.get(number));
    Some(TimeSaid::OfDay(
        fine.map_or(coarse_s, |fine| refined(coarse_s, fine)),
    ))
}

/// Two bits for the whole second, 30 for its fraction.
fn refined(coarse_s: f64, fine: &[u8]) -> f64 {
    let bits = unsigned(fine);
    let whole_s = match bits >> 30 {
        1 => coarse_s.floor() + 1.0,
        2 => coarse_s.floor() - 1.0,
        _ => coarse_s.floor(),
    };
    let refined_s = whole_s + (bits & 0x3fff_ffff) as f64 / f64::from(1u32 << 30);
    if coarse_s < DAY_S {
        refined_s.rem_euclid(DAY_S)
    } else {
        coarse_s
    }
}

fn sigma_m(quality: &[u8]) -> Option<f64> {
    let category = usize::from(quality.get(1)? >> 1 & 0x0f);
    let radius = RADIUS_M.get(category).filter(|radius| radius.is_finite())?;
    Some(radius / RADIUS_SIGMAS)
}
