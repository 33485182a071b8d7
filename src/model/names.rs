//! Names of targets, tracks and sensors in the order a reader expects: "2" before "10".

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_count_by_value() {
        let mut names = vec!["10", "2", "T10", "T9", "", "1", "T9b", "02", "a2b10", "a2b9", "18446744073709551617", "18446744073709551616"];
        names.sort_by(|a, b| natural_order(a, b));
        assert_eq!(names, ["", "1", "02", "2", "10", "18446744073709551616", "18446744073709551617", "T9", "T9b", "T10", "a2b9", "a2b10"]);
    }

    #[test]
    fn only_equal_names_compare_equal() {
        assert_eq!(natural_order("T01", "T1"), Ordering::Less);
        assert_eq!(natural_order("T1", "T01"), Ordering::Greater);
        assert_eq!(natural_order("T1", "T1"), Ordering::Equal);
    }
}
