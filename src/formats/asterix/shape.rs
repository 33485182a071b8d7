//! How long an item is, and where the parts of a compound one are.

use crate::formats::Reason;

/// An item of a record.
#[derive(Debug)]
pub struct Field {
    pub number: u16,
    pub shape: Shape,
}

#[derive(Debug)]
pub enum Shape {
    Fixed(usize),
    /// Octets up to one whose last bit is 0.
    Extended,
    /// A count, then so many octets each.
    Repetitive(usize),
    /// Presence bits, then those that are there.
    Compound(Vec<Option<Shape>>),
    /// Its first octet is its length.
    Explicit,
    /// Random field sequencing, which is not read.
    Sequence,
}

/// Numbers of what has none: the special purpose and the reserved expansion field, random field sequencing.
const SP: u16 = 1001;
const RE: u16 = 1002;
const RFS: u16 = 1003;

/// Reads a table of `uap.rs`.
pub fn fields(table: &str) -> Vec<Option<Field>> {
    table.split_whitespace().map(field).collect()
}

fn field(text: &str) -> Option<Field> {
    let (name, shape) = text.split_once('=').unwrap_or((text, text));
    let number = match name {
        "-" => return None,
        "SP" => SP,
        "RE" => RE,
        "rfs" => RFS,
        number => number.parse().ok()?,
    };
    Some(Field {
        number,
        shape: self::shape(shape)?,
    })
}

fn shape(text: &str) -> Option<Shape> {
    match text.as_bytes().first()? {
        b'x' | b'f' => Some(Shape::Extended),
        b'e' => Some(Shape::Explicit),
        b'r' if text == "rfs" => Some(Shape::Sequence),
        b'r' => Some(Shape::Repetitive(text.strip_prefix("r1:")?.parse().ok()?)),
        b'c' => {
            let parts = text.strip_prefix("c(")?.strip_suffix(')')?.split(',');
            Some(Shape::Compound(parts.map(shape).collect()))
        }
        _ => text.parse().ok().map(Shape::Fixed),
    }
}

impl Shape {
    /// How many of the octets are this item.
    ///
    /// # Errors
    /// Why they cannot be.
    pub fn length(&self, octets: &[u8]) -> Result<usize, Reason> {
        let length = match self {
            Shape::Fixed(length) => *length,
            Shape::Extended => extended(octets)?,
            Shape::Repetitive(each) => 1 + each * usize::from(first(octets)?),
            Shape::Compound(parts) => compound(parts, octets, |_, _| {})?,
            Shape::Explicit => match usize::from(first(octets)?) {
                0 => return Err(Reason::Malformed),
                length => length,
            },
            Shape::Sequence => return Err(Reason::UnknownType),
        };
        if length > octets.len() {
            return Err(Reason::Truncated);
        }
        Ok(length)
    }

    /// A part of a compound item, counted from 0.
    pub fn part<'a>(&self, octets: &'a [u8], wanted: usize) -> Option<&'a [u8]> {
        let Shape::Compound(parts) = self else {
            return None;
        };
        let mut found = None;
        let keep = |number: usize, part: &'a [u8]| {
            if number == wanted {
                found = Some(part);
            }
        };
        compound(parts, octets, keep).ok()?;
        found
    }
}

fn first(octets: &[u8]) -> Result<u8, Reason> {
    octets.first().copied().ok_or(Reason::Truncated)
}

fn extended(octets: &[u8]) -> Result<usize, Reason> {
    let last = octets.iter().position(|octet| octet & 1 == 0);
    last.map(|last| last + 1).ok_or(Reason::Truncated)
}

fn compound<'a>(
    parts: &[Option<Shape>],
    octets: &'a [u8],
    mut visit: impl FnMut(usize, &'a [u8]),
) -> Result<usize, Reason> {
    let presence = extended(octets)?;
    let mut at = presence;
    for number in present(&octets[..presence]) {
        let Some(Some(shape)) = parts.get(number) else {
            return Err(Reason::Malformed);
        };
        let length = shape.length(&octets[at..])?;
        visit(number, &octets[at..at + length]);
        at += length;
    }
    Ok(at)
}

/// Numbers, from 0, of the bits that are set; the last one of each octet is none of them.
pub fn present(octets: &[u8]) -> impl Iterator<Item = usize> {
    octets.iter().enumerate().flat_map(|(octet, bits)| {
        (0..7)
            .filter(move |place| bits & (0x80 >> place) != 0)
            .map(move |place| octet * 7 + place)
    })
}
