//! Changes of bytes, each from the numbers of one seed.

/// SplitMix64 (Steele, Lea and Flood 2014).
pub struct Draws(u64);

impl Draws {
    pub fn of(seed: u64) -> Self {
        Draws(seed.wrapping_mul(0xd129_0d3c_8f5a_2e6b))
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// From 0 up to `end`, which is above 0.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    /// A piece of so many bytes: where it begins and ends.
    fn piece(&mut self, length: usize) -> std::ops::Range<usize> {
        let from = self.below(length + 1);
        let most = (length - from).min(64);
        from..from + self.below(most + 1)
    }
}

/// What stands at ends of ranges, or means something to some reader.
const TOKENS: [&[u8]; 24] = [
    b"0",
    b"-1",
    b"1e308",
    b"-1e308",
    b"5e-324",
    b"NaN",
    b"inf",
    b"18446744073709551616",
    b"4294967295",
    b"",
    b",",
    b";",
    b"\t",
    b"\n",
    b"\r\n",
    b"\"",
    b"{",
    b"[",
    b"null",
    b"\xff\xff\xff\xff",
    b"\0\0\0\0",
    b"\x1a\x33",
    b"\xef\xbb\xbf",
    b"2026-02-30T25:61:61Z",
];

/// Changes the bytes in one place, or cuts them.
pub fn once(bytes: &mut Vec<u8>, other: &[u8], draws: &mut Draws) {
    let at = draws.below(bytes.len() + 1);
    match draws.below(8) {
        0..=1 if at < bytes.len() => bytes[at] ^= 1 << draws.below(8),
        2 if at < bytes.len() => bytes[at] = draws.next() as u8,
        3 => bytes.truncate(at),
        4 => {
            bytes.drain(draws.piece(bytes.len()));
        }
        5 => {
            let token = TOKENS[draws.below(TOKENS.len())];
            let end = (at + draws.below(token.len() + 1)).min(bytes.len());
            bytes.splice(at..end, token.iter().copied());
        }
        6 => {
            let again = bytes[draws.piece(bytes.len())].to_vec();
            bytes.splice(at..at, again);
        }
        _ => {
            let piece = other[draws.piece(other.len())].to_vec();
            bytes.splice(at..at, piece);
        }
    }
}
