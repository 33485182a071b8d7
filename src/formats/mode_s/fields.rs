//! Values of fields: altitudes, identity codes, callsigns, velocities.

use super::frame::Frame;
use crate::formats::feed::Motion;

const KNOT_MPS: f64 = 1852.0 / 3600.0;
pub(super) const FOOT_M: f64 = 0.3048;

/// Feet of an altitude code of 13 bits; `None` where there is none, or where it is in metres, which nobody sends.
pub(super) fn altitude_ft(code: u32) -> Option<i32> {
    const METRIC: u32 = 0x40;
    const BY_25_FEET: u32 = 0x10;
    if code == 0 || code & METRIC != 0 {
        return None;
    }
    if code & BY_25_FEET == 0 {
        return gillham_ft(code);
    }
    let steps = (code & 0x1f80) >> 2 | (code & 0x20) >> 1 | code & 0xf;
    Some(steps as i32 * 25 - 1000)
}

/// The altitude code of a squitter has no bit that says metres.
pub(super) fn squitter_altitude_ft(code: u32) -> Option<i32> {
    altitude_ft((code & 0xfc0) << 1 | code & 0x3f)
}

/// Steps of 100 ft in the reflected code of old encoders: D, A and B count 500 ft, and C 100 ft, every other time backwards.
fn gillham_ft(code: u32) -> Option<i32> {
    // The pulse 1 counts most here, in an identity least.
    let turned = |digit: u32| (digit & 1) << 2 | digit & 2 | digit >> 2;
    let [a, b, c, d] = pulses(code).map(turned);
    let hundreds = match from_reflected(c) {
        7 => 5,
        hundreds @ 1..=4 => hundreds,
        _ => return None,
    };
    let five_hundreds = from_reflected(d << 6 | a << 3 | b);
    let is_backwards = five_hundreds % 2 == 1;
    let hundreds = if is_backwards { 6 - hundreds } else { hundreds };
    Some(five_hundreds as i32 * 500 + hundreds as i32 * 100 - 1300)
}

fn from_reflected(code: u32) -> u32 {
    (1..10).fold(code, |value, shift| value ^ code >> shift)
}

/// The four digits of an identity code of 13 bits, as one octal number.
pub(super) fn identity_code(code: u32) -> u16 {
    let [a, b, c, d] = pulses(code);
    (a << 9 | b << 6 | c << 3 | d) as u16
}

/// The pulses A, B, C and D of a reply, each a digit: C1 A1 C2 A2 C4 A4 X B1 D1 B2 D2 B4 D4.
fn pulses(code: u32) -> [u32; 4] {
    let digit =
        |one: u32| (code >> one & 1) | (code >> (one - 2) & 1) << 1 | (code >> (one - 4) & 1) << 2;
    [digit(11), digit(5), digit(12), digit(4)]
}

/// Eight letters and digits of six bits each; `None` where one is neither.
pub(super) fn callsign(frame: &Frame) -> Option<String> {
    let letter = |index: u32| match frame.message(8 + index * 6, 6) as u8 {
        code @ 1..=26 => Some(char::from(code + 64)),
        code @ (32 | 48..=57) => Some(char::from(code)),
        _ => None,
    };
    let callsign: String = (0..8).map(letter).collect::<Option<_>>()?;
    let callsign = callsign.trim();
    (!callsign.is_empty()).then(|| callsign.to_owned())
}

/// Over ground; of a velocity through the air nothing.
pub(super) fn velocity(frame: &Frame) -> Option<Motion> {
    let unit_mps = match frame.message(5, 3) {
        1 => KNOT_MPS,
        2 => 4.0 * KNOT_MPS,
        _ => return None,
    };
    // 0 is none, 1 stands still; the bit before says west or south.
    let component = |from: u32| {
        let speed_mps = f64::from(frame.message(from + 1, 10).checked_sub(1)?) * unit_mps;
        Some(if frame.message(from, 1) == 1 {
            -speed_mps
        } else {
            speed_mps
        })
    };
    let (east_mps, north_mps) = (component(13)?, component(24)?);
    Some(Motion {
        speed_mps: east_mps.hypot(north_mps),
        course_rad: east_mps.atan2(north_mps).rem_euclid(std::f64::consts::TAU),
    })
}

/// Of a surface position; `None` where it says no speed or no direction.
pub(super) fn surface_motion(frame: &Frame) -> Option<Motion> {
    let has_track = frame.message(12, 1) == 1;
    let track_rad = f64::from(frame.message(13, 7)) * std::f64::consts::TAU / 128.0;
    let speed_kt = surface_speed_kt(frame.message(5, 7))?;
    has_track.then_some(Motion {
        speed_mps: speed_kt * KNOT_MPS,
        course_rad: track_rad,
    })
}

/// The movement field: ever wider steps.
fn surface_speed_kt(movement: u32) -> Option<f64> {
    /// First value, its speed (kt), and the step.
    const STEPS: [(u32, f64, f64); 7] = [
        (1, 0.0, 0.125),
        (9, 1.0, 0.25),
        (13, 2.0, 0.5),
        (39, 15.0, 1.0),
        (94, 70.0, 2.0),
        (109, 100.0, 5.0),
        (124, 175.0, 0.0),
    ];
    let is_speed = (1..=124).contains(&movement);
    let (first, speed_kt, step_kt) = *STEPS
        .iter()
        .rev()
        .find(|step| step.0 <= movement && is_speed)?;
    Some(speed_kt + f64::from(movement - first) * step_kt)
}

/// Standard deviation (m) on each axis: a circle of the radius EPU holds 95 % of positions.
pub(super) fn sigma_m(nac_p: Option<u32>) -> f64 {
    const EPU_M: [f64; 11] = [
        18_520.0, 7408.0, 3704.0, 1852.0, 926.0, 555.6, 185.2, 92.6, 30.0, 10.0, 3.0,
    ];
    const UNKNOWN_M: f64 = 50.0;
    let epu_m = nac_p.and_then(|nac_p| EPU_M.get((nac_p as usize).checked_sub(1)?));
    epu_m.map_or(UNKNOWN_M, |epu_m| epu_m / 2.4477)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// That in steps of 25 ft is of the Riddle's 8D40621D58C382D690C8AC2863A7; the others are rows of the table of Annex 10,
    /// volume IV, their pulses D2 D4 A1 A2 A4 B1 B2 B4 C1 C2 C4.
    #[test]
    fn altitudes() {
        assert_eq!(squitter_altitude_ft(0xc38), Some(38_000));
        assert_eq!((altitude_ft(0), altitude_ft(0x40)), (None, None));
        let of = |pulses: &str| {
            let places = [2, 0, 11, 9, 7, 5, 3, 1, 12, 10, 8];
            let pulses = pulses.bytes().zip(places);
            altitude_ft(
                pulses
                    .map(|(pulse, place)| u32::from(pulse - b'0') << place)
                    .sum(),
            )
        };
        assert_eq!(of("00000000001"), Some(-1200));
        assert_eq!(of("00000000010"), Some(-1000));
        assert_eq!(of("00000000100"), Some(-800));
        assert_eq!(of("00000001100"), Some(-700));
        assert_eq!(of("00000011010"), Some(0));
        assert_eq!(of("00000011110"), Some(100));
        assert_eq!(of("10000000001"), Some(126_700));
        assert_eq!(
            (of("00000011000"), of("00000011111"), of("00000011101")),
            (None, None, None)
        );
    }

    #[test]
    fn speeds_on_the_ground() {
        let speeds = [0, 1, 2, 8, 9, 13, 39, 94, 109, 123, 124, 125].map(surface_speed_kt);
        let kt = [0.0, 0.125, 0.875, 1.0, 2.0, 15.0, 70.0, 100.0, 170.0, 175.0].map(Some);
        assert_eq!(speeds[1..11], kt);
        assert_eq!((speeds[0], speeds[11]), (None, None));
    }
}
