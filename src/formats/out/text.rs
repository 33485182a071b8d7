//! Numbers, instants and XML as text.

use super::refusal;
use crate::model::fault::Fault;
use jiff::Timestamp;

/// Of latitudes and longitudes: a centimetre.
pub const DEGREES: usize = 7;
/// Of heights (m).
pub const METRES: usize = 2;
/// Of seconds: what a double resolves of the seconds since 1970.
pub const SECONDS: usize = 6;

/// A number with at most so many decimals, without zeros at its end.
pub fn push_fixed(text: &mut String, value: f64, decimals: usize) {
    let written = format!("{value:.decimals$}");
    let short = written.trim_end_matches('0').trim_end_matches('.');
    text.push_str(if short == "-0" { "0" } else { short });
}

pub fn fixed(value: f64, decimals: usize) -> String {
    let mut text = String::new();
    push_fixed(&mut text, value, decimals);
    text
}

/// Seconds since 1970 as RFC 3339, to the microsecond.
///
/// # Errors
/// A fault of a time before the year 1 or after the year 9999, which no calendar of those who read it has.
pub fn instant(time_s: f64) -> Result<String, Box<Fault>> {
    const FIRST_S: f64 = -62_135_596_800.0;
    const END_S: f64 = 253_402_300_799.0;
    let found = (FIRST_S..END_S)
        .contains(&time_s)
        .then(|| Timestamp::from_microsecond((time_s * 1e6).round() as i64).ok());
    found
        .flatten()
        .map(|instant| instant.to_string())
        .ok_or_else(|| {
            let detail = format!("{time_s} s after 1970 is no instant that the format can say");
            Box::new(refusal("out_of_range", detail).allowing("years 1 to 9999"))
        })
}

/// Text between XML tags or in quotes. Characters that XML 1.0 cannot say become U+FFFD.
pub fn push_xml(text: &mut String, content: &str) {
    for letter in content.chars() {
        match letter {
            '&' => text.push_str("&amp;"),
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '"' => text.push_str("&quot;"),
            '\t' | '\n' | '\r' | ' '..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' => text.push(letter),
            '\u{10000}'.. => text.push(letter),
            _ => text.push('\u{fffd}'),
        }
    }
}

/// `<tag>content</tag>`.
pub fn push_element(text: &mut String, tag: &str, content: &str) {
    text.push_str(&format!("<{tag}>"));
    push_xml(text, content);
    text.push_str(&format!("</{tag}>"));
}

/// A string in JSON's quotes.
pub fn push_json(text: &mut String, content: &str) {
    // A string is always JSON.
    text.push_str(&serde_json::to_string(content).unwrap_or_default());
}
