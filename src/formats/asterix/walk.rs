//! From the octets of a block to the items of its records.

use super::shape::{Field, Shape, present};
use super::uap::Uap;
use crate::formats::Reason;

/// The items of one record, in their order.
#[derive(Default)]
pub struct Items<'t, 'a> {
    found: Vec<(u16, &'t Shape, &'a [u8])>,
}

impl<'a> Items<'_, 'a> {
    /// The octets of an item.
    pub fn get(&self, number: u16) -> Option<&'a [u8]> {
        let found = self.found.iter().find(|(found, ..)| *found == number);
        found.map(|(_, _, octets)| *octets)
    }

    /// A part of a compound item, counted from 0.
    pub fn part(&self, number: u16, part: usize) -> Option<&'a [u8]> {
        let found = self.found.iter().find(|(found, ..)| *found == number);
        found.and_then(|(_, shape, octets)| shape.part(octets, part))
    }
}

/// The item that tells plots and tracks of category 001 apart by its first bit.
const DESCRIPTOR: u16 = 20;

/// Finds the items of the record at the front, and says how long it is.
///
/// # Errors
/// Why there is none. Where the next record would begin is not known then.
pub fn walk<'t, 'a>(
    uap: &'t Uap,
    octets: &'a [u8],
    items: &mut Items<'t, 'a>,
) -> Result<usize, Reason> {
    items.found.clear();
    let mut fields: &[Option<Field>] = &uap.fields;
    let last = octets.iter().position(|octet| octet & 1 == 0);
    let mut at = last.ok_or(Reason::Truncated)? + 1;
    for reference in present(&octets[..at]) {
        let Some(Some(Field { number, shape })) = fields.get(reference) else {
            return Err(Reason::Malformed);
        };
        let length = shape.length(&octets[at..])?;
        items.found.push((*number, shape, &octets[at..at + length]));
        if let (DESCRIPTOR, Some(of_track)) = (*number, &uap.fields_of_track)
            && octets[at] & 0x80 != 0
        {
            fields = of_track;
        }
        at += length;
    }
    Ok(at)
}
