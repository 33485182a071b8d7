//! Query parameters, read one by one; every fault is kept, and a parameter nobody asked for is one.

use crate::model::fault::Fault;
use crate::service::error::ApiError;
use axum::extract::{FromRequestParts, Query};
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
        match Query::try_from_uri(&parts.uri) {
            Ok(Query(pairs)) => params.pairs = pairs,
            Err(_) => params.faults.push(Fault::new("/query", "malformed", "the query is not a list of name=value pairs in UTF-8")),
        }
        Ok(params)
    }
}

impl Params {
    /// Every value of a parameter that may be repeated.
    pub fn all(&mut self, name: &'static str) -> Vec<String> {
        self.known.push(name);
        self.pairs.iter().filter(|(key, _)| key == name).map(|(_, value)| value.clone()).collect()
    }

    /// The value of a parameter that may be given once.
    pub fn text(&mut self, name: &'static str) -> Option<String> {
        let mut values = self.all(name);
        if values.len() > 1 {
            self.fault(name, "duplicate", "the parameter is given more than once", "once");
        }
        values.pop()
    }

    /// A parameter that `read` understands; `allowed` says what that is.
    pub fn read<T>(&mut self, name: &'static str, allowed: &str, read: impl Fn(&str) -> Option<T>) -> Option<T> {
        let text = self.text(name)?;
        self.read_value(name, &text, allowed, read)
    }

    /// The entries of a comma list.
    pub fn list<T>(&mut self, name: &'static str, allowed: &str, read: impl Fn(&str) -> Option<T>) -> Vec<T> {
        let text = self.text(name).unwrap_or_default();
        let entries = text.split(',').filter(|entry| !entry.is_empty());
        entries.filter_map(|entry| self.read_value(name, entry, allowed, &read)).collect()
    }

    /// A value written as JSON.
    pub fn json(&mut self, name: &'static str) -> Option<Value> {
        let text = self.text(name)?;
        let read = serde_json::from_str(&text);
        read.map_err(|error| self.fault(name, "malformed", &format!("the value is not JSON: {error}"), "JSON")).ok()
    }

    /// `key:value` pairs, the parameter repeated.
    pub fn labels(&mut self, name: &'static str) -> Vec<(String, String)> {
        let split = |text: &str| text.split_once(':').map(|(key, value)| (key.to_owned(), value.to_owned()));
        let texts = self.all(name);
        texts.iter().filter_map(|text| self.read_value(name, text, "key:value", split)).collect()
    }

    pub fn whole_number(&mut self, name: &'static str, range: std::ops::RangeInclusive<u64>) -> Option<u64> {
        let allowed =
            if *range.end() == u64::MAX { format!(">= {}", range.start()) } else { format!("[{}, {}]", range.start(), range.end()) };
        self.read(name, &allowed, |text| text.parse().ok().filter(|number| range.contains(number)))
    }

    pub fn number(&mut self, name: &'static str) -> Option<f64> {
        self.read(name, "a finite number", |text| text.parse().ok().filter(|number: &f64| number.is_finite()))
    }

    pub fn flag(&mut self, name: &'static str) -> bool {
        self.read(name, "true, false", |text| text.parse().ok()).unwrap_or(false)
    }

    pub fn timestamp(&mut self, name: &'static str) -> Option<Timestamp> {
        self.read(name, "an RFC 3339 time such as 2026-01-31T12:00:00Z", |text| text.parse().ok())
    }

    pub fn fault(&mut self, name: &str, code: &str, detail: &str, allowed: &str) {
        self.faults.push(Fault::new(format!("/query/{name}"), code, detail).allowing(allowed));
    }

    /// Faults of what the parameters say, each with its pointer into them.
    pub fn add(&mut self, faults: Vec<Fault>) {
        self.faults.extend(faults.into_iter().map(|fault| Fault { pointer: format!("/query{}", fault.pointer), ..fault }));
    }

    /// The query without its cursor, ready to have one appended.
    pub fn next_page(&self) -> String {
        let kept = self.pairs.iter().filter(|(name, _)| name != "cursor");
        kept.map(|(name, value)| format!("{}={}&", encoded(name), encoded(value))).collect()
    }

    /// # Errors
    /// `validation` with every fault, unknown parameters among them.
    pub fn finish(self) -> Result<(), ApiError> {
        let Params { pairs, known, mut faults } = self;
        let allowed = if known.is_empty() { "no parameter".to_owned() } else { known.join(", ") };
        for (name, _) in pairs.iter().filter(|(name, _)| !known.contains(&name.as_str())) {
            let detail = format!("unknown query parameter '{name}'");
            faults.push(Fault::new(format!("/query/{name}"), "unknown_field", detail).allowing(allowed.clone()));
        }
        if faults.is_empty() { Ok(()) } else { Err(ApiError::validation(faults)) }
    }

    fn read_value<T>(&mut self, name: &str, text: &str, allowed: &str, read: impl Fn(&str) -> Option<T>) -> Option<T> {
        let value = read(text);
        if value.is_none() {
            self.fault(name, "unknown_value", &format!("'{text}' is not a value of '{name}'"), allowed);
        }
        value
    }
}

/// Percent-encoded, all but unreserved characters (RFC 3986).
pub fn encoded(text: &str) -> String {
    let encode = |byte: u8| match byte {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' => char::from(byte).to_string(),
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
