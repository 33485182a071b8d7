//! How a CSV file is written, told from its first lines.

use csv::StringRecord;

/// Separators that files have, the likelier first.
const DELIMITERS: [u8; 4] = [b',', b';', b'\t', b'|'];

/// What differs between CSV files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Dialect {
    pub delimiter: u8,
    /// What lines of comment begin with; `None` where the header begins so.
    pub comment: Option<u8>,
    pub has_decimal_commas: bool,
}

impl Dialect {
    /// From the first bytes: the separator of the header is the one that it has most of.
    pub fn of(head: &[u8]) -> Self {
        let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
        let mut lines = head
            .split(|&byte| byte == b'\n')
            .map(<[u8]>::trim_ascii)
            .filter(|line| !line.is_empty());
        let mut comments: Vec<&[u8]> = Vec::new();
        let mut header: &[u8] = b"";
        for line in lines.by_ref() {
            if !line.starts_with(b"#") {
                header = line;
                break;
            }
            comments.push(line);
        }
        let delimiter = delimiter_of(header);
        let marked = comments
            .last()
            .is_some_and(|line| is_header(line, header, delimiter));
        let row = if marked { Some(header) } else { lines.next() };
        let has_decimal_commas = delimiter != b','
            && row.is_some_and(|row| row.split(|&byte| byte == delimiter).any(is_decimal_comma));
        Dialect {
            delimiter,
            comment: (!marked).then_some(b'#'),
            has_decimal_commas,
        }
    }
}

/// Whether a line of comment is the header of the row below it, such as `# Timestamp,MMSI`: it has as many columns, and the row
/// has a number.
fn is_header(comment: &[u8], row: &[u8], delimiter: u8) -> bool {
    let columns = count(comment, delimiter);
    let mut cells = row.split(|&byte| byte == delimiter).map(<[u8]>::trim_ascii);
    columns > 0
        && columns == count(row, delimiter)
        && cells.any(|cell| cell.first().is_some_and(u8::is_ascii_digit))
}

/// The separator that a line has most of, outside quotes.
fn delimiter_of(line: &[u8]) -> u8 {
    let mut best = (b',', 0);
    for delimiter in DELIMITERS {
        let found = count(line, delimiter);
        if found > best.1 {
            best = (delimiter, found);
        }
    }
    best.0
}

fn count(line: &[u8], delimiter: u8) -> usize {
    let mut is_quoted = false;
    let mut found = 0;
    for &byte in line {
        is_quoted ^= byte == b'"';
        found += usize::from(byte == delimiter && !is_quoted);
    }
    found
}

/// Whether a cell is a number with a comma in the place of its point.
fn is_decimal_comma(cell: &[u8]) -> bool {
    let cell = cell.trim_ascii();
    let cell = cell
        .strip_prefix(b"\"")
        .and_then(|cell| cell.strip_suffix(b"\""))
        .unwrap_or(cell);
    let of_number = |byte: &u8| byte.is_ascii_digit() || b"+-,eE".contains(byte);
    cell.iter().filter(|&&byte| byte == b',').count() == 1
        && cell.iter().any(u8::is_ascii_digit)
        && cell.iter().all(of_number)
}

/// The record with points in place of decimal commas.
pub(super) fn with_points(record: &StringRecord) -> StringRecord {
    let mut changed = StringRecord::with_capacity(record.as_slice().len(), record.len());
    for cell in record {
        if is_decimal_comma(cell.as_bytes()) {
            changed.push_field(&cell.replace(',', "."));
        } else {
            changed.push_field(cell);
        }
    }
    changed
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dialect(text: &str) -> (char, bool, bool) {
        let found = Dialect::of(text.as_bytes());
        (
            found.delimiter as char,
            found.comment.is_some(),
            found.has_decimal_commas,
        )
    }

    #[test]
    fn dialects_are_told_from_the_first_lines() {
        assert_eq!(dialect("time_s,x_m\n0,1\n"), (',', true, false));
        assert_eq!(
            dialect("# a, b; c\ntime_s;x_m\n0,5;1,25\n"),
            (';', true, true)
        );
        assert_eq!(dialect("time_s\tx_m\n0\t1\n"), ('\t', true, false));
        assert_eq!(dialect("\"a,b,c\"|d\n1|2\n"), ('|', true, false));
        assert_eq!(
            dialect("# Timestamp,MMSI\n01/02/2016 10:00:00,2\n"),
            (',', false, false)
        );
        assert_eq!(dialect(""), (',', true, false));
    }
}
