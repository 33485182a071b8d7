//! From payloads to blocks. A recorder may put frames of its own around blocks; which ones a file has is told by walking
//! over their lengths. Layouts of frames: jASTERIX's definitions and the readers of Croatia Control's asterix (facts alone).

use super::capture::{Content, Payload, payloads};
use crate::formats::Reason;
use crate::model::fault::Fault;

/// A block: records of one category.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block<'a> {
    pub category: u8,
    pub records: &'a [u8],
    pub captured_s: Option<f64>,
    /// Time of day of the frame around it (s).
    pub framed_s: Option<f64>,
}

/// A part of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Piece<'a> {
    Block(Block<'a>),
    /// Sound, but nothing of ASTERIX.
    Foreign(&'static str),
    Broken(Reason),
}

/// What is around blocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Framing {
    Bare,
    /// Length with its 6 octets, ms of the day.
    Oradis,
    /// IOSS "final": length of all, error, board, recording day, time of day in 0.01 s; 4 octets A5 at the end. The
    /// number says how many octets of a sequence number follow the length.
    Final(u8),
    /// Comsoft: 128 octets, then ms since the start and a length, whose order of octets differs.
    Rff {
        is_little: bool,
    },
    /// 2200 octets, then each block with 10 octets after it.
    Gps,
}

const ORDER: [Framing; 7] = [
    Framing::Bare,
    Framing::Oradis,
    Framing::Final(0),
    Framing::Final(4),
    Framing::Rff { is_little: true },
    Framing::Rff { is_little: false },
    Framing::Gps,
];

const DAY_MS: u32 = 86_400_000;
const TRAILER: [u8; 4] = [0xa5; 4];
/// What is looked at of a payload to tell its framing.
const LOOKED_AT: usize = 1 << 16;
/// How many payloads are looked at.
const PAYLOADS: usize = 200;

impl Framing {
    pub fn name(self) -> &'static str {
        match self {
            Framing::Bare => "bare blocks",
            Framing::Oradis => "ORADIS",
            Framing::Final(0) => "final",
            Framing::Final(_) => "final with sequence numbers",
            Framing::Rff { is_little: true } => "RFF",
            Framing::Rff { is_little: false } => "RFF with lengths in network order",
            Framing::Gps => "GPS",
        }
    }

    /// What stands before the first frame; `None` where the file is none of these.
    fn head_length(self, payload: &[u8]) -> Option<usize> {
        match self {
            Framing::Rff { .. } => {
                let texts = payload.get(..40)?;
                let is_text = |octet: &u8| matches!(octet, 0 | b' '..=b'~');
                let says_time = texts[..20].iter().any(u8::is_ascii_digit)
                    && texts[20..].iter().any(u8::is_ascii_digit);
                (texts.iter().all(is_text) && says_time && payload.len() >= 128).then_some(128)
            }
            Framing::Gps => (payload.len() > 2200).then_some(2200),
            _ => Some(0),
        }
    }

    /// The frame at the front: what is in it, its time of day, and how long it is.
    fn frame(self, octets: &[u8]) -> Option<(&[u8], Option<f64>, usize)> {
        let number = |from: usize, to: usize| Some(unsigned(octets.get(from..to)?));
        match self {
            Framing::Bare => {
                let length = number(1, 3)? as usize;
                Some((octets.get(..length)?, None, length))
            }
            Framing::Oradis => {
                let (length, time_ms) = (number(0, 2)? as usize, number(2, 6)?);
                let time_s = (time_ms < DAY_MS).then(|| f64::from(time_ms) / 1000.0)?;
                Some((octets.get(6..length)?, Some(time_s), length))
            }
            Framing::Final(more) => {
                let start = 8 + usize::from(more);
                let length = number(0, 2)? as usize;
                let time_s = f64::from(number(start - 3, start)?) / 100.0;
                let (body, trailer) = octets.get(start..length)?.split_last_chunk::<4>()?;
                (*trailer == TRAILER).then_some((body, Some(time_s), length))
            }
            Framing::Rff { is_little } => {
                let length = number(4, 6)? as u16;
                let length = if is_little {
                    length.swap_bytes()
                } else {
                    length
                };
                let end = 6 + usize::from(length);
                Some((octets.get(6..end)?, None, end))
            }
            Framing::Gps => {
                let length = number(1, 3)? as usize;
                let time_s = f64::from(number(length + 6, length + 9)?) / 128.0;
                octets.get(length + 9)?;
                Some((octets.get(..length)?, Some(time_s), length + 10))
            }
        }
    }
}

fn unsigned(octets: &[u8]) -> u32 {
    let add = |sum: u32, octet: &u8| sum << 8 | u32::from(*octet);
    octets.iter().fold(0, add)
}

/// The blocks of one payload.
pub struct Pieces<'a> {
    framing: Framing,
    captured_s: Option<f64>,
    framed_s: Option<f64>,
    /// Blocks of the frame at hand.
    frame: &'a [u8],
    rest: &'a [u8],
    /// What there is instead of blocks.
    instead: Option<Piece<'a>>,
}

pub fn pieces(payload: Payload<'_>, framing: Framing) -> Pieces<'_> {
    let (octets, instead): (&[u8], _) = match payload.content {
        Content::Foreign(kind) => (&[], Some(Piece::Foreign(kind))),
        Content::Cut => (&[], Some(Piece::Broken(Reason::Truncated))),
        Content::Octets(octets) => match framing.head_length(octets) {
            Some(start) => (&octets[start..], None),
            None => (&[], Some(Piece::Broken(Reason::Truncated))),
        },
    };
    Pieces {
        framing,
        captured_s: payload.captured_s,
        framed_s: None,
        frame: &[],
        rest: octets,
        instead,
    }
}

impl<'a> Iterator for Pieces<'a> {
    type Item = Piece<'a>;

    fn next(&mut self) -> Option<Piece<'a>> {
        if let Some(instead) = self.instead.take() {
            return Some(instead);
        }
        if self.frame.is_empty() {
            if self.rest.is_empty() {
                return None;
            }
            let Some((frame, framed_s, length)) = self.framing.frame(self.rest) else {
                return Some(self.broken());
            };
            (self.frame, self.framed_s) = (frame, framed_s);
            self.rest = &self.rest[length..];
        }
        Some(self.block().unwrap_or_else(|| self.broken()))
    }
}

impl<'a> Pieces<'a> {
    /// Nothing after a break can be found.
    fn broken(&mut self) -> Piece<'a> {
        (self.frame, self.rest) = (&[], &[]);
        Piece::Broken(Reason::Truncated)
    }

    fn block(&mut self) -> Option<Piece<'a>> {
        let category = *self.frame.first()?;
        let length = unsigned(self.frame.get(1..3)?) as usize;
        if category == 0 || length < 4 {
            return None;
        }
        let (block, rest) = self.frame.split_at_checked(length)?;
        self.frame = rest;
        Some(Piece::Block(Block {
            category,
            records: &block[3..],
            captured_s: self.captured_s,
            framed_s: self.framed_s,
        }))
    }

    fn octets_left(&self) -> usize {
        self.frame.len() + self.rest.len()
    }
}

/// The framing of a file: that whose walk ends exactly for most of its payloads; of a long file, that which does not break
/// within its first 64 KiB.
///
/// # Errors
/// `unsupported`, with what was tried and where each broke.
pub fn tell(file: &[u8]) -> Result<Framing, Vec<Fault>> {
    let walked: Vec<&[u8]> = payloads(file)
        .filter_map(|payload| match payload.content {
            Content::Octets(octets) => Some(octets),
            _ => None,
        })
        .take(PAYLOADS)
        .collect();
    let fits = |framing: &Framing| {
        let exact = walked
            .iter()
            .filter(|octets| broken_at(octets, *framing).is_none());
        exact.count()
    };
    let best = ORDER.into_iter().rev().max_by_key(fits);
    match best {
        Some(framing) if fits(&framing) > 0 => Ok(framing),
        _ => Err(vec![none_fits(walked.first().copied())]),
    }
}

/// The octet at which the walk over a payload breaks.
fn broken_at(octets: &[u8], framing: Framing) -> Option<usize> {
    let Some(head) = framing.head_length(octets) else {
        return Some(0);
    };
    let payload = Payload {
        content: Content::Octets(octets),
        captured_s: None,
    };
    let mut walk = pieces(payload, framing);
    let mut at = head;
    while let Some(piece) = walk.next() {
        if let Piece::Broken(_) = piece {
            return Some(at);
        }
        at = octets.len() - walk.octets_left();
        if at >= LOOKED_AT {
            return None;
        }
    }
    // A head alone is no file.
    (at == head && octets.len() == head).then_some(at)
}

fn none_fits(first: Option<&[u8]>) -> Fault {
    let Some(octets) = first else {
        return Fault::new("/file", "unsupported", "the capture holds no UDP datagram");
    };
    let place = |framing: &Framing| match broken_at(octets, *framing) {
        Some(at) => format!("{} break at octet {at}", framing.name()),
        None => framing.name().to_owned(),
    };
    let tried: Vec<String> = ORDER.iter().map(place).collect();
    let detail = format!("blocks are framed in no known way: {}", tried.join(", "));
    Fault::new("/file", "unsupported", detail)
}
