//! Text line by line in bounded memory: no line is longer than any sound file has.

use crate::model::fault::Fault;
use std::io::{self, BufRead, ErrorKind, Read};

/// Bytes of one line of a text file; the widest record of bearings needs about a megabyte.
pub const MAX_LINE_BYTES: usize = 1 << 22;

/// The fault of a longer line.
pub fn too_long(line: u64) -> Fault {
    let fault = Fault::new(
        "/file",
        "too_large",
        format!("the line is longer than {MAX_LINE_BYTES} bytes"),
    );
    Fault {
        line: Some(line),
        ..fault.allowing(format!("<= {MAX_LINE_BYTES} bytes a line"))
    }
}

/// The fault of a file that cannot be read further.
pub fn unreadable(error: &io::Error) -> Fault {
    Fault::new(
        "/file",
        "malformed",
        format!("the file cannot be read: {error}"),
    )
}

/// Passes its input on, and fails with [`ErrorKind::FileTooLarge`] at a line that is too long.
pub struct BoundedLines<'a> {
    input: &'a mut dyn BufRead,
    /// Bytes of the line so far.
    length: usize,
    longest: usize,
}

impl<'a> BoundedLines<'a> {
    pub fn new(input: &'a mut dyn BufRead) -> Self {
        BoundedLines {
            input,
            length: 0,
            longest: 0,
        }
    }

    fn count(&mut self, bytes: &[u8]) {
        let mut lines = bytes.split(|&byte| byte == b'\n');
        self.length += lines.next().map_or(0, <[u8]>::len);
        self.longest = self.longest.max(self.length);
        for line in lines {
            self.length = line.len();
            self.longest = self.longest.max(self.length);
        }
    }
}

impl Read for BoundedLines<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.input.read(buffer)?;
        self.count(&buffer[..count]);
        if self.longest > MAX_LINE_BYTES {
            Err(ErrorKind::FileTooLarge.into())
        } else {
            Ok(count)
        }
    }
}

/// Reads one line, its end included, into the emptied `line`; `false` at the end of the file.
///
/// # Errors
/// What the input says, and [`ErrorKind::FileTooLarge`] of a line that is too long.
pub fn read_line(mut input: &mut dyn BufRead, line: &mut Vec<u8>) -> io::Result<bool> {
    line.clear();
    let count = (&mut input)
        .take(MAX_LINE_BYTES as u64 + 1)
        .read_until(b'\n', line)?;
    if count > MAX_LINE_BYTES {
        Err(ErrorKind::FileTooLarge.into())
    } else {
        Ok(count > 0)
    }
}

/// Hands on every line with its number (from 1), without the mark that some write before UTF-8.
///
/// # Errors
/// A line that is too long, and input that cannot be read.
pub fn each_line(
    input: &mut dyn BufRead,
    take: &mut dyn FnMut(&[u8], u64),
) -> Result<(), Vec<Fault>> {
    let mut line = Vec::new();
    for number in 1.. {
        if !read_line(input, &mut line).map_err(|error| vec![unreadable_at(&error, number)])? {
            break;
        }
        let is_marked = number == 1 && line.starts_with(BYTE_ORDER_MARK);
        let mark = if is_marked { BYTE_ORDER_MARK.len() } else { 0 };
        take(&line[mark..], number);
    }
    Ok(())
}

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The fault of a file that cannot be read further than this line.
pub fn unreadable_at(error: &io::Error, line: u64) -> Fault {
    if error.kind() == ErrorKind::FileTooLarge {
        return too_long(line);
    }
    Fault {
        line: Some(line),
        ..unreadable(error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_as_long_as_allowed_and_no_longer() {
        let longest = "x".repeat(MAX_LINE_BYTES - 1) + "\n";
        let read = |text: &str| {
            let mut found = Vec::new();
            BoundedLines::new(&mut text.as_bytes())
                .read_to_end(&mut found)
                .map(|_| found.len())
                .map_err(|error| error.kind())
        };
        assert_eq!(read(&longest.repeat(2)), Ok(2 * MAX_LINE_BYTES));
        assert_eq!(
            read(&format!("{longest}xx{longest}")),
            Err(ErrorKind::FileTooLarge)
        );
        let (mut line, mut input) = (Vec::new(), longest.as_bytes());
        assert!(
            read_line(&mut input, &mut line).is_ok_and(|is_read| is_read)
                && line.len() == MAX_LINE_BYTES
        );
        let too_long = format!("x{longest}");
        assert_eq!(
            read_line(&mut too_long.as_bytes(), &mut line).map_err(|error| error.kind()),
            Err(ErrorKind::FileTooLarge)
        );
    }
}
