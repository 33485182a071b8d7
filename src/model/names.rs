//! Names of targets, tracks, sensors and detections: which are sound, and the order a reader expects: "2" before "10".
//!
//! Names come from files and requests and go into tables that people open with a spreadsheet. A cell that begins with `=`,
//! `@`, `+` or `-` is a formula there, which may run a program or send data away. Such names are refused where they come
//! in; so files are written as they are, and what is written reads back. A number with a sign is only a number there.

use std::cmp::Ordering;

/// Compares two names piece by piece: runs of digits by value, everything else by character. Names that differ only in
/// leading zeros are ordered as text, so that only equal names compare equal.
pub fn natural_order(a: &str, b: &str) -> Ordering {
    let (mut rest_a, mut rest_b) = (a.as_bytes(), b.as_bytes());
    while let (Some(first_a), Some(first_b)) = (rest_a.first(), rest_b.first()) {
        let step = if first_a.is_ascii_digit() && first_b.is_ascii_digit() {
            let (number_a, after_a) = rest_a.split_at(digits(rest_a));
            let (number_b, after_b) = rest_b.split_at(digits(rest_b));
            (rest_a, rest_b) = (after_a, after_b);
            by_value(number_a, number_b)
        } else {
            (rest_a, rest_b) = (&rest_a[1..], &rest_b[1..]);
            first_a.cmp(first_b)
        };
        if step != Ordering::Equal {
            return step;
        }
    }
    rest_a.len().cmp(&rest_b.len()).then_with(|| a.cmp(b))
}

/// How many digits `text` starts with.
fn digits(text: &[u8]) -> usize {
    text.iter().take_while(|byte| byte.is_ascii_digit()).count()
}

/// Numbers of any length: without leading zeros, the longer is the larger.
fn by_value(a: &[u8], b: &[u8]) -> Ordering {
    let zeros = |digits: &[u8]| digits.iter().take_while(|&&digit| digit == b'0').count();
    let (a, b) = (&a[zeros(a)..], &b[zeros(b)..]);
    a.len().cmp(&b.len()).then_with(|| a.cmp(b))
}

/// Bytes of a name. Tables of pairs repeat names, so their length must not multiply.
pub const MAX_NAME_BYTES: usize = 200;

/// What is wrong with a name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NameFault {
    pub code: &'static str,
    pub detail: String,
    pub allowed: &'static str,
}

/// Why this text, empty or not, cannot be a name.
pub fn name_fault(name: &str) -> Option<NameFault> {
    if name.len() > MAX_NAME_BYTES {
        let detail = format!("the name '{}' has {} bytes", shorten(name), name.len());
        return Some(NameFault {
            code: "too_large",
            detail,
            allowed: "at most 200 bytes",
        });
    }
    let is_formula = match name.as_bytes().first()? {
        b'=' | b'@' | b'\t' | b'\r' => true,
        b'+' | b'-' => !name.parse::<f64>().is_ok_and(f64::is_finite),
        _ => false,
    };
    let detail = || {
        format!(
            "the name '{}' would be a formula in a spreadsheet",
            shorten(name)
        )
    };
    let allowed = "numbers, and names that do not begin with = @ + - or a tab";
    is_formula.then(|| NameFault {
        code: "malformed",
        detail: detail(),
        allowed,
    })
}

/// A text at a length that fits a message.
pub fn shorten(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_count_by_value() {
        let mut names = vec![
            "10",
            "2",
            "T10",
            "T9",
            "",
            "1",
            "T9b",
            "02",
            "a2b10",
            "a2b9",
            "18446744073709551617",
            "18446744073709551616",
        ];
        names.sort_by(|a, b| natural_order(a, b));
        assert_eq!(
            names,
            [
                "",
                "1",
                "02",
                "2",
                "10",
                "18446744073709551616",
                "18446744073709551617",
                "T9",
                "T9b",
                "T10",
                "a2b9",
                "a2b10"
            ]
        );
    }

    #[test]
    fn names_that_are_formulas_are_refused_and_numbers_are_not() {
        for sound in [
            "",
            "1",
            "-1",
            "+12",
            "-1.5e3",
            "T-1",
            "a=b",
            "radar@north",
            " =1",
            "\u{e9}=",
        ] {
            assert_eq!(name_fault(sound), None, "{sound}");
        }
        for formula in [
            "=1+1",
            "@SUM(A1)",
            "+A1",
            "-A1",
            "-",
            "+",
            "-inf",
            "-1+1",
            "\t=1",
            "\r=1",
            "=cmd|'/c calc'!A0",
        ] {
            assert_eq!(
                name_fault(formula).map(|found| found.code),
                Some("malformed"),
                "{formula}"
            );
        }
        let long = "x".repeat(MAX_NAME_BYTES);
        assert_eq!(name_fault(&long), None);
        let found = name_fault(&(long + "x")).map(|found| (found.code, found.detail));
        assert_eq!(
            found,
            Some((
                "too_large",
                format!("the name '{}…' has 201 bytes", "x".repeat(40))
            ))
        );
    }

    #[test]
    fn only_equal_names_compare_equal() {
        assert_eq!(natural_order("T01", "T1"), Ordering::Less);
        assert_eq!(natural_order("T1", "T01"), Ordering::Greater);
        assert_eq!(natural_order("T1", "T1"), Ordering::Equal);
    }
}
