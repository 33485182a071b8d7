//! Items to records, and records to blocks.

use crate::formats::asterix::items::Source;
use crate::formats::asterix::shape::Field;

/// Octets of a block at most, so that it fits a datagram of Ethernet.
const BLOCK_LENGTH: usize = 1400;
const DAY_S: f64 = 86_400.0;

/// The items of a record.
pub struct Record<'t> {
    fields: &'t [Option<Field>],
    items: Vec<(usize, Vec<u8>)>,
}

impl<'t> Record<'t> {
    pub fn of(fields: &'t [Option<Field>], source: Source) -> Self {
        let mut record = Record {
            fields,
            items: Vec::new(),
        };
        record.put(10, vec![source.0, source.1]);
        record
    }

    /// Adds an item that the category has.
    pub fn put(&mut self, number: u16, octets: impl Into<Option<Vec<u8>>>) {
        let is_it =
            |field: &Option<Field>| field.as_ref().is_some_and(|field| field.number == number);
        let reference = self.fields.iter().position(is_it);
        if let (Some(reference), Some(octets)) = (reference, octets.into()) {
            self.items.push((reference, octets));
        }
    }

    fn octets(self) -> Vec<u8> {
        compound(self.items)
    }
}

/// Presence bits, then the parts in their order.
pub fn compound(mut parts: Vec<(usize, Vec<u8>)>) -> Vec<u8> {
    parts.sort_by_key(|(number, _)| *number);
    let last = parts.last().map_or(0, |(number, _)| number / 7);
    let mut octets = vec![1; last + 1];
    octets[last] = 0;
    for (number, _) in &parts {
        octets[number / 7] |= 0x80 >> (number % 7);
    }
    for (_, part) in parts {
        octets.extend(part);
    }
    octets
}

/// Octets of seven bits, up to the last one that says something.
pub fn extended(bits: &[u8]) -> Vec<u8> {
    let last = bits.iter().rposition(|octet| *octet != 0).unwrap_or(0);
    let mut octets: Vec<u8> = bits[..=last].iter().map(|octet| octet | 1).collect();
    octets[last] &= !1;
    octets
}

/// Records of a category in as many blocks as they need, in their order.
pub fn blocks<'t>(category: u8, records: impl Iterator<Item = Record<'t>>) -> Vec<u8> {
    let mut written = Vec::new();
    let mut block = Vec::new();
    for record in records {
        let octets = record.octets();
        if !block.is_empty() && block.len() + octets.len() > BLOCK_LENGTH {
            finish(category, &mut block, &mut written);
        }
        block.extend(octets);
    }
    if !block.is_empty() {
        finish(category, &mut block, &mut written);
    }
    written
}

fn finish(category: u8, block: &mut Vec<u8>, written: &mut Vec<u8>) {
    written.push(category);
    written.extend((block.len() as u16 + 3).to_be_bytes());
    written.append(block);
}

/// A number in steps, of so many octets.
pub fn unsigned(value: f64, step: f64, octets: usize) -> Option<Vec<u8>> {
    let steps = (value / step).round();
    let end = 2f64.powi(8 * octets as i32);
    (0.0..end)
        .contains(&steps)
        .then(|| last(steps as u64, octets))
}

/// A number in steps, of so many octets, in two's complement.
pub fn signed(value: f64, step: f64, octets: usize) -> Option<Vec<u8>> {
    signed_bits(value, step, 8 * octets as u32).map(|bits| last(bits, octets))
}

/// The last `bits` of a number in two's complement.
pub fn signed_bits(value: f64, step: f64, bits: u32) -> Option<u64> {
    let steps = (value / step).round();
    let end = 2f64.powi(bits as i32 - 1);
    let mask = u64::MAX >> (64 - bits);
    (-end..end)
        .contains(&steps)
        .then_some(steps as i64 as u64 & mask)
}

/// Two numbers behind each other, where both can be said.
pub fn both(first: Option<Vec<u8>>, second: Option<Vec<u8>>) -> Option<Vec<u8>> {
    Some([first?, second?].concat())
}

/// The last octets of a number.
pub fn last(number: u64, octets: usize) -> Vec<u8> {
    number.to_be_bytes()[8 - octets..].to_vec()
}

/// Latitude and longitude in 180° times 2^-`power`, of four octets each.
pub fn geographic(lat_deg: f64, lon_deg: f64, power: i32) -> Option<Vec<u8>> {
    let step = 180.0 / 2f64.powi(power);
    both(signed(lat_deg, step, 4), signed(lon_deg, step, 4))
}

/// Time of the day in 1/128 s.
pub fn time_of_day(time_s: f64) -> Option<Vec<u8>> {
    let steps = (time_s * 128.0).round().rem_euclid(DAY_S * 128.0);
    steps.is_finite().then(|| last(steps as u64, 3))
}

/// An angle in 2⁻¹⁶ of a turn.
pub fn angle(angle_rad: f64) -> Option<Vec<u8>> {
    let steps = (angle_rad / std::f64::consts::TAU * 65_536.0).round();
    let steps = steps.rem_euclid(65_536.0);
    steps.is_finite().then(|| last(steps as u64, 2))
}

/// Twelve bits of a code.
pub fn mode_a(code: u16) -> Option<Vec<u8>> {
    (code < 0o10000).then(|| code.to_be_bytes().to_vec())
}

/// Eight letters of six bits. `None` where it is longer, or a letter is none of A to Z, 0 to 9 and space.
pub fn callsign(name: &str) -> Option<Vec<u8>> {
    if name.len() > 8 {
        return None;
    }
    let mut bits: u64 = 0;
    for place in 0..8 {
        let code = match name.as_bytes().get(place).copied().unwrap_or(b' ') {
            letter @ b'A'..=b'Z' => letter - b'A' + 1,
            letter @ (b'0'..=b'9' | b' ') => letter,
            _ => return None,
        };
        bits = bits << 6 | u64::from(code);
    }
    Some(last(bits, 6))
}

/// A 24-bit address.
pub fn address(address: u32) -> Option<Vec<u8>> {
    (address < 1 << 24).then(|| last(u64::from(address), 3))
}
