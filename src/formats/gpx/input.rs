//! The bytes of an XML file: how far they are read, and no more than so many for one tag or text.

use std::io::{self, BufRead, ErrorKind, Read};

/// Bytes of a tag, a text or a comment.
pub(super) const MAX_EVENT_BYTES: usize = 1 << 20;

pub(super) struct Input<'a> {
    input: &'a mut dyn BufRead,
    /// Bytes since the last event.
    taken: usize,
    /// Line that has been reached.
    pub line: u64,
}

impl<'a> Input<'a> {
    pub fn new(input: &'a mut dyn BufRead) -> Self {
        Input {
            input,
            taken: 0,
            line: 1,
        }
    }

    pub fn begin_event(&mut self) {
        self.taken = 0;
    }
}

impl Read for Input<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(buffer)?;
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Input<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.taken > MAX_EVENT_BYTES {
            return Err(ErrorKind::FileTooLarge.into());
        }
        // No more at once, so that it does not depend on the buffer's size what is too long.
        let buffer = self.input.fill_buf()?;
        Ok(&buffer[..buffer.len().min(MAX_EVENT_BYTES + 1 - self.taken)])
    }

    fn consume(&mut self, count: usize) {
        // What is consumed is what `fill_buf` gave, which is in the buffer still.
        if let Ok(buffer) = self.input.fill_buf() {
            let taken = &buffer[..count.min(buffer.len())];
            self.line += taken.iter().filter(|byte| **byte == b'\n').count() as u64;
        }
        self.taken += count;
        self.input.consume(count);
    }
}
