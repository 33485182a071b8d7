//! The format of a file by its first bytes.

use super::{Format, autoferry, format_named, npy};

/// What recordings of a network begin with: pcap in both orders of bytes, in micro- and nanoseconds, and pcapng.
const CAPTURES: [&[u8]; 5] = [
    b"\xd4\xc3\xb2\xa1",
    b"\xa1\xb2\xc3\xd4",
    b"\x4d\x3c\xb2\xa1",
    b"\xa1\xb2\x3c\x4d",
    b"\x0a\x0d\x0d\x0a",
];

/// Categories of ASTERIX that a block may begin with.
pub(super) const CATEGORIES: [u8; 14] = [1, 2, 4, 8, 10, 11, 19, 20, 21, 23, 34, 48, 62, 65];

/// The format of a file by its first bytes, or by its name where they say nothing: what has a magic by that; JSON starts with `{` or
/// `[`, and is of autoferry where it is an array of arrays or names what those files have; sentences, frames and XML by their first
/// line; MOTChallenge text starts with a number and has no header; any other text is CSV. `None` for other bytes that are no text.
pub fn detect_format(file_name: &str, first_bytes: &[u8]) -> Option<&'static Format> {
    if let Some(format) = of_bytes(first_bytes) {
        return format_named(format);
    }
    let text = first_bytes
        .strip_prefix(b"\xef\xbb\xbf")
        .unwrap_or(first_bytes)
        .trim_ascii_start();
    match text.first() {
        Some(b'{') => format_named("json"),
        Some(b'[') if autoferry::is_one(text) => format_named("autoferry"),
        Some(b'[') => format_named("json"),
        Some(_) if text.contains(&0) => None,
        None if file_name.to_ascii_lowercase().ends_with(".json") => format_named("json"),
        _ => format_named(of_line(first_line(text), text)),
    }
}

fn of_bytes(bytes: &[u8]) -> Option<&'static str> {
    let is_beast = bytes.first() == Some(&0x1a)
        && bytes
            .get(1)
            .is_some_and(|kind| (b'1'..=b'4').contains(kind));
    if bytes.starts_with(npy::MAGIC) {
        Some("npy")
    } else if bytes.starts_with(b"PAR1") {
        Some("parquet")
    } else if bytes.starts_with(b"ARROW1") || bytes.starts_with(&[0xff; 4]) {
        // The magic of a file, the first message of a stream.
        Some("arrow")
    } else if CAPTURES.iter().any(|magic| bytes.starts_with(magic)) || are_blocks(bytes) {
        Some("asterix")
    } else {
        is_beast.then_some("mode_s")
    }
}

/// Whether the bytes are blocks of ASTERIX: category, length, the next block; the last one may be cut off. A text is none, even where
/// its letters happen to be lengths.
fn are_blocks(bytes: &[u8]) -> bool {
    if bytes
        .iter()
        .all(|byte| byte.is_ascii_graphic() || byte.is_ascii_whitespace())
    {
        return false;
    }
    let mut rest = bytes;
    let mut blocks = 0;
    while let [category, high, low, ..] = rest {
        let length = usize::from(u16::from_be_bytes([*high, *low]));
        if !CATEGORIES.contains(category) || length < 4 {
            return false;
        }
        blocks += 1;
        rest = rest.get(length..).unwrap_or_default();
    }
    blocks > 0 && rest.is_empty()
}

/// The first line that is neither empty nor a comment, else the first.
fn first_line(text: &[u8]) -> &[u8] {
    let lines = text.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let mut said = lines.filter(|line| !line.is_empty() && !line.starts_with(b"#"));
    said.next().unwrap_or_default()
}

fn of_line(line: &[u8], text: &[u8]) -> &'static str {
    let has = |part: &[u8]| line.windows(part.len()).any(|window| window == part);
    let is_avr = matches!(line.first(), Some(b'*' | b'@')) && line.ends_with(b";");
    if has(b"VDM,") || has(b"VDO,") {
        return "ais";
    }
    if is_avr || line.starts_with(b"MSG,") || has(b",1a32") || has(b",1a33") || has(b",1A33") {
        return "mode_s";
    }
    if line.starts_with(b"<") && text.windows(4).any(|window| window == b"<gpx") {
        return "gpx";
    }
    match line.first() {
        Some(b'0'..=b'9' | b'-') if text.first() == line.first() => "mot",
        _ => "csv",
    }
}
