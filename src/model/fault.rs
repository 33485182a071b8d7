//! One fault of an input: where it is, what is wrong, what would be allowed.
//! Checks collect faults and return all of them; nothing here knows HTTP.

use serde::{Deserialize, Serialize};

/// A fault in a request or a file. `pointer` is a JSON pointer into the request ("" is the whole body);
/// faults of an uploaded file also carry `line` (from 1, the header is line 1) and `column` (its name).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fault {
    pub pointer: String,
    /// Machine-readable: `missing`, `unknown_field`, `wrong_type`, `out_of_range`, `unknown_value`, `duplicate`,
    /// `not_finite`, `unsorted`, `malformed`, `empty`, `not_found`, `conflict`, `unsupported`, `too_large`.
    pub code: String,
    pub detail: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub allowed: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub column: Option<String>,
}

impl Fault {
    pub fn new(pointer: impl Into<String>, code: &str, detail: impl Into<String>) -> Self {
        Fault { pointer: pointer.into(), code: code.to_owned(), detail: detail.into(), allowed: None, line: None, column: None }
    }

    #[must_use]
    pub fn allowing(mut self, allowed: impl Into<String>) -> Self {
        self.allowed = Some(allowed.into());
        self
    }

    #[must_use]
    pub fn at(mut self, line: u64, column: impl Into<String>) -> Self {
        self.line = Some(line);
        self.column = Some(column.into());
        self
    }
}
