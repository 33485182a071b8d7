//! Arrivals as something to read from, for readers of tables.

use super::{Arrivals, Piece};
use crate::formats::Units;
use std::cell::RefCell;
use std::io::{self, BufRead, Read};
use std::rc::Rc;

/// Whole pieces one after another; it waits for the next when one was read.
pub struct Incoming<'a> {
    arrivals: &'a mut dyn Arrivals,
    piece: Vec<u8>,
    at: usize,
    /// Lines so far.
    lines: u64,
    broken: Broken,
}

/// What was broken among the pieces, which whoever reads the rows counts.
pub type Broken = Rc<RefCell<Units>>;

impl<'a> Incoming<'a> {
    /// What comes first has two lines at least: the header tells the separator, a row the decimal mark.
    pub fn begin(arrivals: &'a mut dyn Arrivals) -> Self {
        let mut incoming = Incoming {
            arrivals,
            piece: Vec::new(),
            at: 0,
            lines: 0,
            broken: Broken::default(),
        };
        while !has_a_row(&incoming.piece) && incoming.piece.len() < 1 << 16 {
            let Some(more) = incoming.next() else { break };
            incoming.piece.extend(more);
        }
        incoming
    }

    fn next(&mut self) -> Option<Vec<u8>> {
        loop {
            match self.arrivals.next()? {
                Piece::Whole(bytes) => {
                    let ends = bytes.iter().filter(|byte| **byte == b'\n');
                    self.lines += ends.count() as u64;
                    return Some(bytes);
                }
                Piece::Broken(reason) => self.broken.borrow_mut().reject(reason, self.lines + 1, 1),
            }
        }
    }

    pub fn broken(&self) -> Broken {
        self.broken.clone()
    }
}

/// Whether there are two lines that are neither empty nor comments.
fn has_a_row(text: &[u8]) -> bool {
    let lines = text.split_inclusive(|byte| *byte == b'\n');
    let whole = lines.filter(|line| line.ends_with(b"\n"));
    let said = whole.filter(|line| !line.trim_ascii().is_empty() && !line.starts_with(b"#"));
    said.take(2).count() == 2
}

impl Read for Incoming<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let piece = self.fill_buf()?;
        let count = piece.len().min(buffer.len());
        buffer[..count].copy_from_slice(&piece[..count]);
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Incoming<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.at == self.piece.len() {
            (self.piece, self.at) = (self.next().unwrap_or_default(), 0);
        }
        Ok(&self.piece[self.at..])
    }

    fn consume(&mut self, count: usize) {
        self.at += count;
    }
}
