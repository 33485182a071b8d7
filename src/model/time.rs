//! What the times of a set are counted from.

use serde::{Deserialize, Serialize};

/// Times are seconds; from when, the set says.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum TimeBase {
    /// From whatever the file chose.
    #[default]
    Relative,
    /// From 1970-01-01 00:00 UTC, leap seconds not counted.
    Utc,
    /// The same, but the day was told or assumed: the file has times of day only.
    AssumedDate,
}

/// Times that differ by no more are one time: files have decimals, and sums and differences of them are rounded. A nanosecond,
/// and at times that are counted from long ago, which are coarser, four steps of the numbers.
pub fn rounding_s(time_s: f64) -> f64 {
    (4.0 * f64::EPSILON * time_s.abs()).max(1e-9)
}

impl TimeBase {
    pub const ALL: [TimeBase; 3] = [TimeBase::Relative, TimeBase::Utc, TimeBase::AssumedDate];

    pub fn is_utc(self) -> bool {
        self != TimeBase::Relative
    }

    /// As files and requests write it.
    pub fn name(self) -> &'static str {
        match self {
            TimeBase::Relative => "relative",
            TimeBase::Utc => "utc",
            TimeBase::AssumedDate => "assumed_date",
        }
    }

    pub fn named(name: &str) -> Option<TimeBase> {
        TimeBase::ALL.into_iter().find(|base| base.name() == name)
    }
}
