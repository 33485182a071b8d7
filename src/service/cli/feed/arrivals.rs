//! The reader's end of a stream: chunks as whole lines or blocks, and the format by what comes first.

use super::queue::{Chunk, Queue};
use super::ready::is_scan;
use crate::formats::live::{Arrivals, Cut, Cutter, Piece, cut_of};
use crate::formats::{Format, detect_format};
use std::collections::VecDeque;

/// So much is looked at to tell the format.
const LOOKED_AT: usize = 1 << 16;

/// What a stream is.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    /// Lines that are scans as sessions take them.
    Scans,
    Of(&'static Format),
}

impl Kind {
    fn cut(self) -> Cut {
        match self {
            Kind::Scans => Cut::Lines,
            Kind::Of(format) => cut_of(format).unwrap_or(Cut::Lines),
        }
    }
}

/// Chunks that came first, looked at and to be read again.
pub(super) struct Head {
    queue: Queue,
    held: VecDeque<super::queue::Arrived>,
}

impl Head {
    pub fn of(queue: Queue) -> Self {
        Head {
            queue,
            held: VecDeque::new(),
        }
    }

    /// Waits for what tells the format; `None` where nothing does.
    pub fn tell(&mut self) -> Option<Kind> {
        let mut bytes = Vec::new();
        while !is_enough(&bytes) {
            let Some(arrived) = self.queue.take() else {
                break;
            };
            if let Chunk::Bytes(part) | Chunk::Datagram(part) = &arrived.chunk {
                bytes.extend_from_slice(part);
                let is_datagram = matches!(arrived.chunk, Chunk::Datagram(_));
                if is_datagram && !bytes.ends_with(b"\n") && !bytes.contains(&0) {
                    bytes.push(b'\n');
                }
            }
            self.held.push_back(arrived);
        }
        let mut lines = bytes.split(|byte| *byte == b'\n');
        if lines
            .find(|line| !line.trim_ascii().is_empty())
            .is_some_and(is_scan)
        {
            return Some(Kind::Scans);
        }
        // Garbage in front is no reason to give up a feed that is one line later.
        detect_format("", &bytes).map(Kind::Of)
    }

    pub fn arrivals(self, kind: Kind) -> Chunks {
        Chunks {
            head: self,
            cut: kind.cut(),
            cutter: Some(Cutter::new(kind.cut())),
            pieces: VecDeque::new(),
            arrived_s: 0.0,
        }
    }
}

/// A line that is said, or bytes that are no text.
fn is_enough(bytes: &[u8]) -> bool {
    let is_said = |line: &[u8]| {
        line.ends_with(b"\n") && !line.trim_ascii().is_empty() && !line.starts_with(b"#")
    };
    let is_text = !bytes.contains(&0);
    let mut lines = bytes.split_inclusive(|byte| *byte == b'\n');
    bytes.len() >= LOOKED_AT || lines.any(is_said) || (bytes.len() >= 3 && !is_text)
}

/// Pieces of the chunks of a queue.
pub(super) struct Chunks {
    head: Head,
    cut: Cut,
    /// None when the stream has ended.
    cutter: Option<Cutter>,
    pieces: VecDeque<Piece>,
    arrived_s: f64,
}

impl Chunks {
    /// Cuts the next chunk; at the end what is left.
    fn cut_next(&mut self) {
        let Some(mut cutter) = self.cutter.take() else {
            return;
        };
        let mut pieces = Vec::new();
        let next = self.head.held.pop_front();
        match next.or_else(|| self.head.queue.take()) {
            None => cutter.end(&mut pieces),
            Some(arrived) => {
                self.arrived_s = arrived.at_s;
                match arrived.chunk {
                    Chunk::Bytes(bytes) => cutter.add(&bytes, &mut pieces),
                    Chunk::Datagram(bytes) if self.cut == Cut::Blocks => {
                        pieces.push(Piece::Whole(bytes));
                    }
                    Chunk::Datagram(bytes) => {
                        cutter.add(&bytes, &mut pieces);
                        cutter.end(&mut pieces);
                    }
                    Chunk::Break => cutter.break_off(&mut pieces),
                }
                self.cutter = Some(cutter);
            }
        }
        self.pieces.extend(pieces);
    }
}

impl Arrivals for Chunks {
    fn next(&mut self) -> Option<Piece> {
        while self.pieces.is_empty() && self.cutter.is_some() {
            self.cut_next();
        }
        self.pieces.pop_front()
    }

    fn arrived_s(&self) -> f64 {
        self.arrived_s
    }
}
