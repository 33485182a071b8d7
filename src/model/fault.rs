//! One fault of an input: where it is, what is wrong, what would be allowed.
//! Checks collect faults and return all of them; nothing here knows HTTP.

use serde::{Deserialize, Serialize};

/// Every `code` of a fault, and what it means.
pub const FAULT_CODES: &[(&str, &str)] = &[
    ("missing", "something required is absent"),
    (
        "unknown_field",
        "there is no such member, parameter or column",
    ),
    ("unknown_path", "the path leads nowhere"),
    ("unknown_value", "the text is none of the known ones"),
    ("wrong_type", "the value is of another type"),
    ("malformed", "the text cannot be read"),
    (
        "out_of_range",
        "the number, or the count, is outside the allowed range",
    ),
    ("not_finite", "the number is infinite or not a number"),
    ("too_large", "there is more of it than the service takes"),
    ("empty", "there is nothing in it"),
    ("too_many", "it is given more often than the service takes"),
    (
        "control_character",
        "the text has a character that texts may not have",
    ),
    ("duplicate", "it is there more than once"),
    ("unsorted", "it is not in order"),
    (
        "conflict",
        "it does not go with something else that is given",
    ),
    ("disjoint", "times or places of two inputs do not meet"),
    (
        "unsupported",
        "what is asked for cannot be done with this input",
    ),
    ("not_found", "what is named does not exist"),
    (
        "rejected",
        "more units of the file are wrong than may be, for one reason",
    ),
    (
        "unsupported_edition",
        "the records are of an edition of their format that is not read",
    ),
    (
        "no_frame",
        "the data do not say where on the Earth their origin is",
    ),
];

/// A fault in a request or a file. `pointer` is a JSON pointer into the request ("" is the whole body);
/// faults of an uploaded file also carry `line` (from 1, the header is line 1) and `column` (its name).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
#[error("{pointer}: {detail}")]
pub struct Fault {
    pub pointer: String,
    /// Machine-readable: one of [`FAULT_CODES`].
    pub code: String,
    pub detail: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub allowed: Option<Box<str>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub column: Option<Box<str>>,
}

impl Fault {
    pub fn new(pointer: impl Into<String>, code: &str, detail: impl Into<String>) -> Self {
        debug_assert!(
            FAULT_CODES.iter().any(|(known, _)| *known == code),
            "{code} is no code of a fault"
        );
        Fault {
            pointer: pointer.into(),
            code: code.to_owned(),
            detail: detail.into(),
            allowed: None,
            line: None,
            column: None,
        }
    }

    #[must_use]
    pub fn allowing(mut self, allowed: impl Into<String>) -> Self {
        self.allowed = Some(allowed.into().into());
        self
    }

    #[must_use]
    pub fn at(mut self, line: u64, column: impl Into<String>) -> Self {
        self.line = Some(line);
        self.column = Some(column.into().into());
        self
    }
}
