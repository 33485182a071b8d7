//! What the parts of a file may unpack to together, before any of them is unpacked.

use crate::formats::packed::{FREE_BYTES, MOST_TIMES};
use crate::model::fault::Fault;

/// Rows that any file may have, and one more for each of its bytes: columns of one value need no bytes for their rows.
const FREE_ROWS: u64 = 1 << 20;

/// Bytes that are left to unpack.
pub struct Budget {
    file_bytes: u64,
    most: u64,
    left: u64,
}

impl Budget {
    pub fn of_file(file_bytes: u64) -> Self {
        let most = FREE_BYTES.saturating_add(file_bytes.saturating_mul(MOST_TIMES));
        Budget {
            file_bytes,
            most,
            left: most,
        }
    }

    /// # Errors
    /// The file unpacks to more than a sound one.
    pub fn take(&mut self, bytes: u64) -> Result<(), Fault> {
        match self.left.checked_sub(bytes) {
            Some(left) => {
                self.left = left;
                Ok(())
            }
            None => Err(self.fault()),
        }
    }

    fn fault(&self) -> Fault {
        let (file_bytes, most) = (self.file_bytes, self.most);
        let detail = format!("the file has {file_bytes} bytes and unpacks to more than {most}");
        let allowed = format!("<= {FREE_BYTES} bytes and {MOST_TIMES} times those of the file");
        Fault::new("/file", "too_large", detail).allowing(allowed)
    }
}

/// Rows that a table of so many bytes can have.
pub fn most_rows(file_bytes: u64) -> u64 {
    FREE_ROWS.saturating_add(file_bytes)
}
