//! Query parameters, read one by one; every fault is kept, and a parameter nobody asked for is one.

use crate::model::fault::Fault;
use crate::registry::{control_character_fault, placed};
use crate::service::http::error::ApiError;
use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use jiff::Timestamp;
use serde_json::Value;
use std::convert::Infallible;

/// The query of a request. Ask for each parameter, then [`Params::finish`].
#[derive(Debug, Default)]
pub struct Params {
    pairs: Vec<(String, String)>,
    known: Vec<&'static str>,
    faults: Vec<Fault>,
}

impl<S: Sync> FromRequestParts<S> for Params {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Infallible> {
        let mut params = Params::default();
        for pair in parts
            .uri
            .query()
            .unwrap_or_default()
            .split('&')
            .filter(|pair| !pair.is_empty())
        {
            let (name, value) = pair.split_once('=').unwrap_or((pair, ""));
            params.take(name, value);
        }
        Ok(params)
    }
}

impl Params {
    /// A pair as it stands in the query. What cannot be read is a fault and left out.
    fn take(&mut self, name: &str, value: &str) {
        let Some(name) = decoded(name) else {
            return self.faults.push(Fault::new(
                "/query",
                "malformed",
                "the name of a parameter is not UTF-8",
            ));
        };
        let pointer = format!("/query/{name}");
        let Some(value) = decoded(value) else {
            return self.faults.push(Fault::new(
                pointer,
                "malformed",
                format!("the value of '{name}' is not UTF-8"),
            ));
        };
        match control_character_fault(&name, &pointer)
            .or_else(|| control_character_fault(&value, &pointer))
        {
            Some(fault) => self.faults.push(fault),
            None => self.pairs.push((name, value)),
        }
    }

    /// Faults of what was read of the parameters.
    pub fn add(&mut self, faults: Vec<Fault>) {
        self.faults.extend(faults);
    }

    /// Every value of a parameter that may be repeated.
    pub fn all(&mut self, name: &'static str) -> Vec<String> {
        self.known.push(name);
        self.pairs
            .iter()
            .filter(|(key, _)| key == name)
            .map(|(_, value)| value.clone())
            .collect()
    }

    /// The value of a parameter that may be given once.
    pub fn text(&mut self, name: &'static str) -> Option<String> {
        let mut values = self.all(name);
        if values.len() > 1 {
            self.fault(
                name,
                "duplicate",
                "the parameter is given more than once",
                "once",
            );
        }
        values.pop()
    }

    /// A parameter that `read` understands; `allowed` says what that is.
    pub fn read<T>(
        &mut self,
        name: &'static str,
        allowed: &str,
        read: impl Fn(&str) -> Option<T>,
    ) -> Option<T> {
        let text = self.text(name)?;
        self.read_value(name, &text, allowed, read)
    }

    /// The entries of a comma list.
    pub fn list<T>(
        &mut self,
        name: &'static str,
        allowed: &str,
        read: impl Fn(&str) -> Option<T>,
    ) -> Vec<T> {
        let text = self.text(name).unwrap_or_default();
        let entries = text.split(',').filter(|entry| !entry.is_empty());
        entries
            .filter_map(|entry| self.read_value(name, entry, allowed, &read))
            .collect()
    }

    /// A value written as JSON.
    pub fn json(&mut self, name: &'static str) -> Option<Value> {
        let text = self.text(name)?;
        let read = serde_json::from_str(&text);
        read.map_err(|error| {
            self.fault(
                name,
                "malformed",
                &format!("the value is not JSON: {error}"),
                "JSON",
            )
        })
        .ok()
    }

    /// `key:value` pairs, the parameter repeated.
    pub fn labels(&mut self, name: &'static str) -> Vec<(String, String)> {
        let split = |text: &str| {
            text.split_once(':')
                .map(|(key, value)| (key.to_owned(), value.to_owned()))
        };
        let texts = self.all(name);
        texts
            .iter()
            .filter_map(|text| self.read_value(name, text, "key:value", split))
            .collect()
    }

    pub fn whole_number(
        &mut self,
        name: &'static str,
        range: std::ops::RangeInclusive<u64>,
    ) -> Option<u64> {
        let allowed = if *range.end() == u64::MAX {
            format!(">= {}", range.start())
        } else {
            format!("[{}, {}]", range.start(), range.end())
        };
        self.read(name, &allowed, |text| {
            text.parse().ok().filter(|number| range.contains(number))
        })
    }

    pub fn number(&mut self, name: &'static str) -> Option<f64> {
        self.read(name, "a finite number", |text| {
            text.parse().ok().filter(|number: &f64| number.is_finite())
        })
    }

    pub fn flag(&mut self, name: &'static str) -> bool {
        self.read(name, "true, false", |text| text.parse().ok())
            .unwrap_or(false)
    }

    pub fn timestamp(&mut self, name: &'static str) -> Option<Timestamp> {
        self.read(
            name,
            "an RFC 3339 time such as 2026-01-31T12:00:00Z",
            |text| text.parse().ok(),
        )
    }

    pub fn fault(&mut self, name: &str, code: &str, detail: &str, allowed: &str) {
        self.faults
            .push(Fault::new(format!("/query/{name}"), code, detail).allowing(allowed));
    }

    /// Faults of what the parameters say, each with its pointer into them.
    pub fn add_within(&mut self, faults: Vec<Fault>) {
        self.faults.extend(placed("/query", faults));
    }

    /// The query without its cursor, ready to have one appended.
    pub fn next_page(&self) -> String {
        let kept = self.pairs.iter().filter(|(name, _)| name != "cursor");
        kept.map(|(name, value)| format!("{}={}&", encoded(name), encoded(value)))
            .collect()
    }

    /// # Errors
    /// `validation` with every fault, unknown parameters among them.
    pub fn finish(self) -> Result<(), ApiError> {
        let Params {
            pairs,
            known,
            mut faults,
        } = self;
        let allowed = if known.is_empty() {
            "no parameter".to_owned()
        } else {
            known.join(", ")
        };
        for (name, _) in pairs
            .iter()
            .filter(|(name, _)| !known.contains(&name.as_str()))
        {
            let detail = format!("unknown query parameter '{name}'");
            faults.push(
                Fault::new(format!("/query/{name}"), "unknown_field", detail)
                    .allowing(allowed.clone()),
            );
        }
        if faults.is_empty() {
            Ok(())
        } else {
            Err(ApiError::validation(faults))
        }
    }

    fn read_value<T>(
        &mut self,
        name: &str,
        text: &str,
        allowed: &str,
        read: impl Fn(&str) -> Option<T>,
    ) -> Option<T> {
        let value = read(text);
        if value.is_none() {
            self.fault(
                name,
                "unknown_value",
                &format!("'{text}' is not a value of '{name}'"),
                allowed,
            );
        }
        value
    }
}

/// A part of a query without its encoding (`+` is a space; a `%` without two digits stands for itself), if it is UTF-8.
fn decoded(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&byte, after)) = rest.split_first() {
        let digits = after
            .get(..2)
            .filter(|digits| byte == b'%' && digits.iter().all(u8::is_ascii_hexdigit));
        let code = digits
            .and_then(|digits| std::str::from_utf8(digits).ok())
            .and_then(|digits| u8::from_str_radix(digits, 16).ok());
        bytes.push(code.unwrap_or(if byte == b'+' { b' ' } else { byte }));
        rest = if code.is_some() { &after[2..] } else { after };
    }
    String::from_utf8(bytes).ok()
}

/// Percent-encoded, all but unreserved characters (RFC 3986).
pub fn encoded(text: &str) -> String {
    let encode = |byte: u8| match byte {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' => {
            char::from(byte).to_string()
        }
        _ => format!("%{byte:02X}"),
    };
    text.bytes().map(encode).collect()
}

/// Names joined as people list them.
pub fn names<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    names.into_iter().collect::<Vec<_>>().join(", ")
}

/// A route whose query must be empty.
pub struct NoParams;

impl<S: Sync> FromRequestParts<S> for NoParams {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, ApiError> {
        let Ok(params) = Params::from_request_parts(parts, state).await;
        params.finish().map(|()| NoParams)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_query_is_decoded_as_forms_are_and_must_be_utf_8() {
        for (text, expected) in [
            ("a+b%20c%2B", Some("a b c+")),
            ("%C3%BC%e2%82%ac", Some("ü€")),
            ("100%", Some("100%")),
            ("%zz%4", Some("%zz%4")),
            ("%ff", None),
            ("%C3", None),
        ] {
            assert_eq!(decoded(text).as_deref(), expected, "{text}");
        }
    }
}
