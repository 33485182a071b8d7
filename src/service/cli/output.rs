//! The standard output. Who stops listening has heard enough: a pipe that is closed early is no failure.

use std::fmt::Display;
use std::io::{ErrorKind, Write, stdout};

/// Writes a line, or several.
///
/// # Errors
/// It cannot be written, for another reason than that nobody reads it.
pub(super) fn print(text: impl Display) -> std::io::Result<()> {
    match writeln!(stdout().lock(), "{text}") {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error),
        _ => Ok(()),
    }
}
