//! A stream cut into whole units, in bounded memory: lines, or blocks of ASTERIX.

use crate::formats::Reason;
use crate::formats::lines::MAX_LINE_BYTES;
use crate::formats::told::CATEGORIES;

/// What the units of a stream are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cut {
    Lines,
    Blocks,
}

/// A part of a stream.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Piece {
    /// Whole units, one after another.
    Whole(Vec<u8>),
    Broken(Reason),
}

/// Collects bytes until they are whole units. It holds no more than one unit and what was added last.
pub struct Cutter {
    cut: Cut,
    buffer: Vec<u8>,
    /// Whether what comes is of a unit that was given up.
    is_lost: bool,
}

impl Cutter {
    pub fn new(cut: Cut) -> Self {
        Cutter {
            cut,
            buffer: Vec::new(),
            is_lost: false,
        }
    }

    /// Adds what came, and tells the units that are whole now.
    pub fn add(&mut self, bytes: &[u8], pieces: &mut Vec<Piece>) {
        self.buffer.extend_from_slice(bytes);
        match self.cut {
            Cut::Lines => self.lines(pieces),
            Cut::Blocks => self.blocks(pieces),
        }
    }

    /// The stream ended: a line without an end is whole, half a block is none.
    pub fn end(&mut self, pieces: &mut Vec<Piece>) {
        let is_line = self.cut == Cut::Lines && !self.is_lost;
        if is_line && !self.buffer.is_empty() {
            self.buffer.push(b'\n');
            pieces.push(Piece::Whole(std::mem::take(&mut self.buffer)));
        }
        self.break_off(pieces);
    }

    /// The stream broke off and will begin anew: what is not whole is lost.
    pub fn break_off(&mut self, pieces: &mut Vec<Piece>) {
        if !self.buffer.is_empty() && !self.is_lost {
            pieces.push(Piece::Broken(Reason::Truncated));
        }
        self.buffer.clear();
        self.is_lost = false;
    }

    fn lines(&mut self, pieces: &mut Vec<Piece>) {
        if self.is_lost {
            let Some(end) = self.buffer.iter().position(|byte| *byte == b'\n') else {
                return self.buffer.clear();
            };
            self.buffer.drain(..=end);
            self.is_lost = false;
        }
        if let Some(end) = self.buffer.iter().rposition(|byte| *byte == b'\n') {
            let rest = self.buffer.split_off(end + 1);
            pieces.push(Piece::Whole(std::mem::replace(&mut self.buffer, rest)));
        }
        if self.buffer.len() > MAX_LINE_BYTES {
            pieces.push(Piece::Broken(Reason::Malformed));
            self.buffer = Vec::new();
            self.is_lost = true;
        }
    }

    fn blocks(&mut self, pieces: &mut Vec<Piece>) {
        loop {
            if self.is_lost && !self.find_block() {
                return;
            }
            let whole = whole_blocks(&self.buffer);
            if whole > 0 {
                let rest = self.buffer.split_off(whole);
                pieces.push(Piece::Whole(std::mem::replace(&mut self.buffer, rest)));
            }
            if head(&self.buffer) != Head::None {
                return;
            }
            pieces.push(Piece::Broken(Reason::Malformed));
            self.buffer.remove(0);
            self.is_lost = true;
        }
    }

    /// Drops bytes up to what may begin a block. It is believed where another block, or nothing yet, follows it.
    fn find_block(&mut self) -> bool {
        let begins = |at: &usize| {
            let rest = &self.buffer[*at..];
            match head(rest) {
                Head::None => false,
                Head::Short => true,
                Head::Block(length) => rest.len() <= length || head(&rest[length..]) != Head::None,
            }
        };
        let found = (0..self.buffer.len()).find(begins);
        let Some(at) = found else {
            self.buffer.clear();
            return false;
        };
        self.buffer.drain(..at);
        self.is_lost = false;
        true
    }
}

/// What bytes begin with.
#[derive(PartialEq, Eq)]
enum Head {
    /// A block of this length, which may not all be there.
    Block(usize),
    /// Too short to tell.
    Short,
    None,
}

fn head(bytes: &[u8]) -> Head {
    match bytes {
        [] => Head::Short,
        [category, ..] if !CATEGORIES.contains(category) => Head::None,
        [_, high, low, ..] => match usize::from(u16::from_be_bytes([*high, *low])) {
            ..4 => Head::None,
            length => Head::Block(length),
        },
        _ => Head::Short,
    }
}

/// How many bytes of whole blocks stand at the front.
fn whole_blocks(bytes: &[u8]) -> usize {
    let mut at = 0;
    while let Head::Block(length) = head(&bytes[at..]) {
        if bytes.len() - at < length {
            break;
        }
        at += length;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whole pieces as one, and how many were broken, of bytes that come in parts of a size.
    fn cut(cut: Cut, bytes: &[u8], size: usize) -> (Vec<u8>, usize) {
        let (mut cutter, mut pieces) = (Cutter::new(cut), Vec::new());
        for part in bytes.chunks(size) {
            cutter.add(part, &mut pieces);
            assert!(cutter.buffer.len() <= MAX_LINE_BYTES + size);
        }
        cutter.end(&mut pieces);
        let mut whole = Vec::new();
        let mut broken = 0;
        for piece in pieces {
            match piece {
                Piece::Whole(bytes) => whole.extend(bytes),
                Piece::Broken(_) => broken += 1,
            }
        }
        (whole, broken)
    }

    #[test]
    fn lines_are_whole_however_they_come() {
        for size in [1, 2, 3, 7, 100] {
            let found = cut(Cut::Lines, b"one\ntwo\r\nthree", size);
            assert_eq!(found, (b"one\ntwo\r\nthree\n".to_vec(), 0));
        }
    }

    #[test]
    fn a_line_without_end_is_given_up_and_the_next_is_read() {
        let mut text = b"first\n".to_vec();
        text.resize(3 * MAX_LINE_BYTES, b'x');
        text.extend_from_slice(b"\nlast\n");
        let found = cut(Cut::Lines, &text, 1 << 16);
        assert_eq!(found, (b"first\nlast\n".to_vec(), 1));
    }

    #[test]
    fn blocks_are_whole_and_found_again_after_garbage() {
        let block = [48, 0, 6, 1, 2, 3];
        let other = [34, 0, 5, 9, 9];
        let sound = [&block[..], &other, &block].concat();
        for size in [1, 2, 5, 17, 100] {
            assert_eq!(cut(Cut::Blocks, &sound, size), (sound.clone(), 0));
            let mixed = [&block[..], &[0xff; 40], &other, &block].concat();
            assert_eq!(cut(Cut::Blocks, &mixed, size), (sound.clone(), 1), "{size}");
        }
        let half = &sound[..sound.len() - 2];
        assert_eq!(cut(Cut::Blocks, half, 4), (sound[..11].to_vec(), 1));
    }

    #[test]
    fn what_breaks_off_is_no_part_of_what_follows() {
        let (mut cutter, mut pieces) = (Cutter::new(Cut::Lines), Vec::new());
        cutter.add(b"whole\nhal", &mut pieces);
        cutter.break_off(&mut pieces);
        cutter.add(b"next\n", &mut pieces);
        let whole = |text: &str| Piece::Whole(text.as_bytes().to_vec());
        let wanted = [
            whole("whole\n"),
            Piece::Broken(Reason::Truncated),
            whole("next\n"),
        ];
        assert_eq!(pieces, wanted);
    }
}
