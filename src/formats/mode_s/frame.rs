//! A frame of Mode S: 56 or 112 bits, the last 24 of them parity.
//!
//! # Reference
//! ICAO Annex 10, volume IV, 3.1.2; J. Sun, The 1090 Megahertz Riddle, 2021.

/// Without its highest bit.
const GENERATOR: u32 = 0xff_f409;

const SHORT: usize = 7;
const LONG: usize = 14;

/// What the division of each first octet leaves.
const REMAINDERS: [u32; 256] = {
    let mut table = [0; 256];
    let mut octet = 0;
    while octet < 256 {
        let mut rest = (octet as u32) << 16;
        let mut bit = 0;
        while bit < 8 {
            let carry = rest >> 23 & 1;
            rest = (rest << 1) ^ (carry * (GENERATOR | 1 << 24));
            bit += 1;
        }
        table[octet] = rest & 0xff_ffff;
        octet += 1;
    }
    table
};

/// The bits of a frame, the first is the highest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    bits: u128,
    is_long: bool,
}

/// Why octets are no frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NoFrame {
    /// The format wants more of them.
    Short,
    Malformed,
}

impl Frame {
    pub fn of(octets: &[u8]) -> Result<Self, NoFrame> {
        let is_long = match octets.len() {
            SHORT => false,
            LONG => true,
            _ => return Err(NoFrame::Malformed),
        };
        let first = 16 - octets.len();
        let mut whole = [0; 16];
        whole[first..].copy_from_slice(octets);
        let bits = u128::from_be_bytes(whole) << (first * 8);
        let frame = Frame { bits, is_long };
        match (frame.format() >= 16, is_long) {
            (true, false) => Err(NoFrame::Short),
            (false, true) => Err(NoFrame::Malformed),
            _ => Ok(frame),
        }
    }

    /// Bits from the first one of the frame, which is 0.
    pub fn field(&self, from: u32, count: u32) -> u32 {
        (self.bits >> (128 - from - count) & ((1 << count) - 1)) as u32
    }

    /// Bits from the first one of the message of an extended squitter.
    pub fn message(&self, from: u32, count: u32) -> u32 {
        self.field(32 + from, count)
    }

    /// All 56 bits of that message.
    pub fn whole_message(&self) -> u64 {
        (self.bits >> 40) as u64 & ((1 << 56) - 1)
    }

    /// The downlink format; all from 24 on are the same.
    pub fn format(&self) -> usize {
        self.field(0, 5).min(24) as usize
    }

    /// The address that formats 11, 17 and 18 say.
    pub fn address(&self) -> u32 {
        self.field(8, 24)
    }

    /// What is left of the frame by the generator: 0 of a sound squitter, the address of a reply to an interrogation.
    pub fn remainder(&self) -> u32 {
        let octets = self.bits.to_be_bytes();
        let data = if self.is_long { LONG } else { SHORT } - 3;
        let divide = |rest: u32, octet: &u8| {
            (rest << 8 & 0xff_ffff) ^ REMAINDERS[(rest >> 16 ^ u32::from(*octet)) as usize & 0xff]
        };
        octets[..data].iter().fold(0, divide) ^ self.field(data as u32 * 8, 24)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(hex: &str) -> Frame {
        let octet = |at: usize| u8::from_str_radix(&hex[at..at + 2], 16).unwrap();
        let octets: Vec<u8> = (0..hex.len()).step_by(2).map(octet).collect();
        Frame::of(&octets).unwrap()
    }

    /// Frames of the Riddle, and replies of pyModeS's tests with the addresses that it finds.
    #[test]
    fn parity_is_zero_or_an_address() {
        let found = [
            "8D406B902015A678D4D220AA4BDA",
            "2A00516D492B80",
            "20001718029FCD",
            "A02014B400000000000000F9D514",
        ]
        .map(|hex| frame(hex).remainder());
        assert_eq!(found, [0, 0x51_0af9, 0x48_91a6, 0x75_82f7]);
        let frame = frame("8D406B902015A678D4D220AA4BDA");
        assert_eq!(
            (frame.format(), frame.address(), frame.message(0, 5)),
            (17, 0x40_6b90, 4)
        );
        assert_eq!(frame.whole_message(), 0x20_15a6_78d4_d220);
    }

    #[test]
    fn octets_that_are_no_frame() {
        assert_eq!(Frame::of(&[0x8d; 7]), Err(NoFrame::Short));
        assert_eq!(Frame::of(&[0x28; 14]), Err(NoFrame::Malformed));
        assert_eq!(Frame::of(&[0x28; 8]), Err(NoFrame::Malformed));
    }
}
