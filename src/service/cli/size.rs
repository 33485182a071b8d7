//! Sizes as people write them.

use crate::service::child::{SMALLEST_BYTES, size_text};

/// Powers of 1024 by their names; what has none is bytes.
const UNITS: [(&str, u32); 4] = [("KiB", 10), ("MiB", 20), ("GiB", 30), ("TiB", 40)];

/// Bytes of `2GiB`, `512 MiB` or `1000000`.
pub(super) fn bytes(text: &str) -> Result<u64, String> {
    let (number, shift) = UNITS
        .iter()
        .find_map(|(unit, shift)| Some((text.strip_suffix(unit)?.trim_end(), *shift)))
        .unwrap_or((text, 0));
    let wrong = || "a size is a whole number of bytes, or one with KiB, MiB, GiB or TiB".to_owned();
    let number: u64 = number.parse().map_err(|_| wrong())?;
    number.checked_mul(1 << shift).ok_or_else(wrong)
}

/// A size that leaves a job something to work with.
pub(super) fn job_memory(text: &str) -> Result<u64, String> {
    match bytes(text)? {
        bytes if bytes < SMALLEST_BYTES => Err(format!(
            "a job needs at least {}",
            size_text(SMALLEST_BYTES)
        )),
        bytes => Ok(bytes),
    }
}

/// The least room that makes sense: tables alone take some hundred kilobytes.
const LEAST_KEPT: u64 = 10 << 20;

/// A size that leaves room for something to keep.
pub(super) fn kept(text: &str) -> Result<u64, String> {
    match bytes(text)? {
        bytes if bytes < LEAST_KEPT => Err(format!(
            "what is kept needs at least {}",
            size_text(LEAST_KEPT)
        )),
        bytes => Ok(bytes),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_units_or_are_bytes() {
        assert_eq!(bytes("2GiB"), Ok(2_147_483_648));
        assert_eq!(bytes("512 MiB"), Ok(536_870_912));
        assert_eq!(bytes("1000000"), Ok(1_000_000));
        for wrong in ["", "GiB", "2G", "-1", "1.5GiB", "99999999TiB"] {
            assert!(bytes(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_job_needs_some_memory() {
        assert_eq!(
            job_memory("63MiB"),
            Err("a job needs at least 64 MiB".to_owned())
        );
        assert_eq!(job_memory("64MiB"), Ok(67_108_864));
    }
}
