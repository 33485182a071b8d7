//! Thrift's compact protocol, as far as the head of a page of Parquet needs it.

/// Structs inside structs; heads of pages have three levels.
const MAX_DEPTH: usize = 16;

const TRUE: u8 = 1;
const FALSE: u8 = 2;
const BYTE: u8 = 3;
const DOUBLE: u8 = 7;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const SET: u8 = 10;
const MAP: u8 = 11;
pub const STRUCT: u8 = 12;
const UUID: u8 = 13;

/// The bytes that are not read yet. `None` of its methods: they end, or are none of the protocol.
pub struct Compact<'b> {
    pub rest: &'b [u8],
}

impl Compact<'_> {
    fn byte(&mut self) -> Option<u8> {
        let (first, rest) = self.rest.split_first()?;
        self.rest = rest;
        Some(*first)
    }

    fn pass(&mut self, count: u64) -> Option<()> {
        self.rest = self.rest.get(usize::try_from(count).ok()?..)?;
        Some(())
    }

    fn varint(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Some(value);
            }
        }
        None
    }

    /// A number of 16, 32 or 64 bits.
    pub fn integer(&mut self) -> Option<i64> {
        let value = self.varint()?;
        Some((value >> 1) as i64 ^ -((value & 1) as i64))
    }

    /// Number and type of the field after the one numbered `last`; `Some(None)` at the end of the struct.
    pub fn field(&mut self, last: i16) -> Option<Option<(i16, u8)>> {
        let head = self.byte()?;
        let (step, kind) = (i16::from(head >> 4), head & 0xf);
        if kind == 0 {
            return Some(None);
        }
        let id = match step {
            0 => i16::try_from(self.integer()?).ok()?,
            step => last.checked_add(step)?,
        };
        Some(Some((id, kind)))
    }

    /// The numbers and flags of a struct by their fields' numbers; what is not told stays as in `told`.
    pub fn numbers<const N: usize>(&mut self, mut told: [i64; N]) -> Option<[i64; N]> {
        let mut last = 0;
        while let Some((id, kind)) = self.field(last)? {
            last = id;
            let place = usize::try_from(id).ok().and_then(|id| told.get_mut(id));
            match (kind, place) {
                (TRUE | FALSE, Some(place)) => *place = i64::from(kind == TRUE),
                (4..=6, Some(place)) => *place = self.integer()?,
                _ => self.skip(kind)?,
            }
        }
        Some(told)
    }

    /// Goes past a field of that type.
    pub fn skip(&mut self, kind: u8) -> Option<()> {
        self.skip_within(kind, MAX_DEPTH)
    }

    fn skip_within(&mut self, kind: u8, depth: usize) -> Option<()> {
        let depth = depth.checked_sub(1)?;
        match kind {
            TRUE | FALSE => Some(()),
            BYTE => self.pass(1),
            4..=6 => self.integer().map(|_| ()),
            DOUBLE => self.pass(8),
            BINARY => {
                let length = self.varint()?;
                self.pass(length)
            }
            LIST | SET => self.skip_list(depth),
            MAP => self.skip_map(depth),
            STRUCT => {
                let mut last = 0;
                while let Some((id, kind)) = self.field(last)? {
                    last = id;
                    self.skip_within(kind, depth)?;
                }
                Some(())
            }
            UUID => self.pass(16),
            _ => None,
        }
    }

    fn skip_list(&mut self, depth: usize) -> Option<()> {
        let head = self.byte()?;
        let count = match head >> 4 {
            15 => self.varint()?,
            count => u64::from(count),
        };
        for _ in 0..count {
            self.skip_element(head & 0xf, depth)?;
        }
        Some(())
    }

    fn skip_map(&mut self, depth: usize) -> Option<()> {
        let count = self.varint()?;
        if count == 0 {
            return Some(());
        }
        let kinds = self.byte()?;
        for _ in 0..count {
            self.skip_element(kinds >> 4, depth)?;
            self.skip_element(kinds & 0xf, depth)?;
        }
        Some(())
    }

    /// Flags in lists have a byte; in structs they are in the head of their field.
    fn skip_element(&mut self, kind: u8, depth: usize) -> Option<()> {
        match kind {
            TRUE | FALSE => self.pass(1),
            kind => self.skip_within(kind, depth),
        }
    }
}
