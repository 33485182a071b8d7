//! The binary format of Mode S Beast: `1A`, a type, six octets of a clock, one of the signal, and the frame. A `1A` within is
//! written twice.

use std::io::{self, BufRead};

const ESCAPE: u8 = 0x1a;

/// Octets of clock and signal.
pub(super) const HEAD: usize = 7;

/// A unit of the stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Found {
    /// Clock, signal and a frame, in the buffer.
    Frame,
    /// A reply of Mode A or C, and what the receiver says of itself.
    ModeAc,
    Status,
    /// A frame that another one, or the end, cuts off.
    Cut,
    /// Octets between frames.
    Junk,
}

pub(super) struct Beast<'a> {
    input: &'a mut dyn BufRead,
    /// Type of a frame that has begun.
    begun: Option<u8>,
}

/// What stands next.
enum Next {
    Octet(u8),
    /// A frame of this type begins.
    Begin(u8),
    /// An escape of nothing.
    Stray,
    End,
}

impl<'a> Beast<'a> {
    pub fn new(input: &'a mut dyn BufRead) -> Self {
        Beast { input, begun: None }
    }

    /// Reads a unit, its octets into the emptied `body`; `None` at the end.
    pub fn read(&mut self, body: &mut Vec<u8>) -> io::Result<Option<Found>> {
        body.clear();
        let mut is_junk = false;
        let kind = loop {
            if let Some(kind) = self.begun.take() {
                break kind;
            }
            match self.next()? {
                Next::End => return Ok(is_junk.then_some(Found::Junk)),
                Next::Octet(_) | Next::Stray => is_junk = true,
                Next::Begin(kind) if is_junk => {
                    self.begun = Some(kind);
                    return Ok(Some(Found::Junk));
                }
                Next::Begin(kind) => break kind,
            }
        };
        let (found, length) = match kind {
            b'1' => (Found::ModeAc, 2),
            b'2' => (Found::Frame, 7),
            b'3' => (Found::Frame, 14),
            _ => (Found::Status, 14),
        };
        while body.len() < HEAD + length {
            match self.next()? {
                Next::Octet(octet) => body.push(octet),
                Next::Begin(kind) => {
                    self.begun = Some(kind);
                    return Ok(Some(Found::Cut));
                }
                Next::Stray | Next::End => return Ok(Some(Found::Cut)),
            }
        }
        Ok(Some(found))
    }

    fn next(&mut self) -> io::Result<Next> {
        Ok(match self.octet()? {
            None => Next::End,
            Some(ESCAPE) => match self.octet()? {
                Some(ESCAPE) => Next::Octet(ESCAPE),
                Some(kind @ b'1'..=b'4') => Next::Begin(kind),
                _ => Next::Stray,
            },
            Some(octet) => Next::Octet(octet),
        })
    }

    fn octet(&mut self) -> io::Result<Option<u8>> {
        let octet = self.input.fill_buf()?.first().copied();
        if octet.is_some() {
            self.input.consume(1);
        }
        Ok(octet)
    }
}
