//! JSON texts read as they come: nothing of a file is held but what its reader keeps.

use crate::model::fault::Fault;
use serde::de::DeserializeSeed;
use std::io::{self, BufRead, BufReader, Read};

/// Reads a whole JSON text.
///
/// # Errors
/// One fault, with the line and, as its column, the character where the text goes wrong.
pub(super) fn parse<T>(
    input: &mut dyn BufRead,
    seed: impl for<'de> DeserializeSeed<'de, Value = T>,
) -> Result<T, Vec<Fault>> {
    let mut is_text = false;
    let read = without_mark(input).and_then(|head| {
        let text = Noticing {
            input: head.chain(input),
            is_text: &mut is_text,
        };
        let mut deserializer = serde_json::Deserializer::from_reader(BufReader::new(text));
        let value = seed.deserialize(&mut deserializer)?;
        deserializer.end().map(|()| value)
    });
    match read {
        Ok(value) => Ok(value),
        Err(error) if error.is_io() => Err(vec![Fault::new(
            "/file",
            "malformed",
            format!("the file cannot be read: {error}"),
        )]),
        Err(_) if !is_text => Err(vec![Fault::new("/file", "empty", "the file is empty")]),
        Err(error) => {
            let code = if error.is_data() {
                "wrong_type"
            } else {
                "malformed"
            };
            Err(vec![
                Fault::new("/file", code, error.to_string())
                    .at(error.line() as u64, error.column().to_string()),
            ])
        }
    }
}

/// The first bytes, less a byte order mark.
fn without_mark(input: &mut dyn BufRead) -> serde_json::Result<io::Cursor<Vec<u8>>> {
    let mut head = Vec::new();
    input
        .take(3)
        .read_to_end(&mut head)
        .map_err(serde_json::Error::io)?;
    if head == b"\xef\xbb\xbf" {
        head.clear();
    }
    Ok(io::Cursor::new(head))
}

/// Notices whether there is anything but white space.
struct Noticing<'a, R> {
    input: R,
    is_text: &'a mut bool,
}

impl<R: Read> Read for Noticing<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.input.read(buffer)?;
        *self.is_text = *self.is_text || !buffer[..count].trim_ascii().is_empty();
        Ok(count)
    }
}

/// Field names that a fault lists, and how much of each.
const MAX_LISTED: usize = 8;
const MAX_CHARACTERS: usize = 40;

/// The first names of a record's fields.
#[derive(Default)]
pub(super) struct FieldNames(Vec<String>);

impl FieldNames {
    pub fn push(&mut self, name: String) {
        if self.0.len() < MAX_LISTED {
            self.0.push(name.chars().take(MAX_CHARACTERS).collect());
        }
    }

    /// The fault of an array of such records where scans are wanted.
    pub fn records_fault(&self) -> Fault {
        let detail = format!(
            "the file is an array of records ({}), not of scans",
            self.0.join(", ")
        );
        Fault::new("/file", "unsupported", detail).allowing("the format json")
    }
}
