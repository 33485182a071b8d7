//! A message in its armour, six bits a letter, and its fields.

/// The six bits of each letter, in a buffer that is used again.
#[derive(Default)]
pub(super) struct Bits {
    sextets: Vec<u8>,
    count: usize,
}

impl Bits {
    pub fn clear(&mut self) {
        self.sextets.clear();
        self.count = 0;
    }

    /// Adds a part; `false` where a letter is none of the armour's.
    pub fn add(&mut self, payload: &[u8]) -> bool {
        let start = self.sextets.len();
        self.sextets
            .extend(payload.iter().map(|letter| sextet(*letter)));
        self.count = self.sextets.len() * 6;
        !self.sextets[start..].contains(&NONE)
    }

    /// Takes off the bits that only fill the last letter.
    pub fn drop_last(&mut self, fill: u8) {
        self.count = self.count.saturating_sub(fill.into());
    }

    /// A sum over all letters (FNV-1a), by which repeated messages are found.
    pub fn sum(&self) -> u64 {
        let add = |sum: u64, byte: &u8| (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        self.sextets.iter().fold(0xcbf2_9ce4_8422_2325, add)
    }

    /// How many bits there are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// A field of up to 57 bits; bits behind the end are 0.
    pub fn unsigned(&self, from: usize, count: usize) -> u64 {
        let (first, end) = (from / 6, from + count);
        let last = end.div_ceil(6);
        let sextet = |index: usize| u64::from(self.sextets.get(index).copied().unwrap_or(0));
        let value = (first..last).fold(0, |value, index| value << 6 | sextet(index));
        value >> (last * 6 - end) & ((1 << count) - 1)
    }

    /// A field in two's complement.
    pub fn signed(&self, from: usize, count: usize) -> i64 {
        let unused = 64 - count;
        (self.unsigned(from, count) << unused) as i64 >> unused
    }

    pub fn bit(&self, at: usize) -> bool {
        self.unsigned(at, 1) == 1
    }

    /// Letters of six bits each, up to an `@`, without the spaces behind.
    pub fn text(&self, from: usize, letters: usize) -> String {
        let letter = |index: usize| match self.unsigned(from + index * 6, 6) as u8 {
            code @ 0..32 => char::from(code + 64),
            code => char::from(code),
        };
        let text: String = (0..letters)
            .map(letter)
            .take_while(|letter| *letter != '@')
            .collect();
        text.trim_end().to_owned()
    }
}

const NONE: u8 = 0xff;

fn sextet(letter: u8) -> u8 {
    match letter {
        b'0'..=b'W' => letter - 48,
        b'`'..=b'w' => letter - 56,
        _ => NONE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `w` is 111111, `0` 000000, `` ` `` 101000, `5` 000101.
    #[test]
    fn fields_lie_across_letters() {
        let mut bits = Bits::default();
        assert!(bits.add(b"w0`") && bits.add(b"5"));
        bits.drop_last(2);
        assert_eq!(bits.count(), 22);
        assert_eq!((bits.unsigned(0, 6), bits.unsigned(4, 4)), (63, 0b1100));
        assert_eq!(
            (bits.signed(0, 6), bits.signed(5, 7), bits.signed(6, 6)),
            (-1, -64, 0)
        );
        assert_eq!(
            (bits.unsigned(12, 10), bits.bit(12), bits.bit(13)),
            (0b10_1000_0001, true, false)
        );
        assert_eq!(bits.unsigned(30, 28), 0);
        assert!(!bits.add(b"X"));
    }

    #[test]
    fn letters_of_six_bits() {
        let mut bits = Bits::default();
        // A is 1, B is 2, space 32, Z 26, digit 7 is 55, @ ends.
        assert!(bits.add(b"12PJo0P"));
        assert_eq!(bits.text(0, 7), "AB Z7");
        assert_eq!(bits.text(6, 2), "B");
    }
}
