//! The cells of a typed column as text.

use crate::formats::table::push_number;
use arrow_array::cast::AsArray;
use arrow_array::types::{
    Date32Type, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type,
    TimestampMicrosecondType, TimestampMillisecondType, TimestampNanosecondType,
    TimestampSecondType, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{
    Array, ArrayRef, BooleanArray, Float32Array, Float64Array, Int64Array, PrimitiveArray,
    UInt64Array,
};
use arrow_schema::{DataType, TimeUnit};
use jiff::Timestamp;
use jiff::tz::TimeZone;
use std::fmt::Write;

/// What is read, for those who gave something else.
pub const READABLE: &str =
    "integers, floats, timestamps, dates, booleans, strings, and dictionaries of strings";

pub fn is_readable(found: &DataType) -> bool {
    match found {
        DataType::Dictionary(_, value) => is_text(value),
        DataType::Null
        | DataType::Boolean
        | DataType::Float32
        | DataType::Float64
        | DataType::Date32
        | DataType::Timestamp(..) => true,
        other => is_text(other) || other.is_integer(),
    }
}

fn is_text(found: &DataType) -> bool {
    matches!(
        found,
        DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View
    )
}

/// The cells of one column of a batch.
pub struct Cells {
    /// `None` where the cell is; of a dictionary by its key.
    nulls: Option<arrow_buffer::NullBuffer>,
    values: Values,
}

enum Values {
    Nothing,
    Flags(BooleanArray),
    Whole(Int64Array),
    WholeUnsigned(UInt64Array),
    Single(Float32Array),
    Double(Float64Array),
    /// Days since 1970.
    Days(PrimitiveArray<Date32Type>),
    Instants {
        counts: Int64Array,
        /// Of a second.
        ticks: i64,
        shown: Shown,
    },
    Texts(ArrayRef),
    /// Texts, and which of them each row has.
    Dictionary {
        texts: ArrayRef,
        keys: Vec<usize>,
    },
}

/// How instants are written.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Shown {
    /// Seconds since 1970.
    Seconds,
    /// With the zone UTC, or without one.
    Utc,
    Local,
}

impl Cells {
    /// `as_seconds`: instants as seconds since 1970. A column of a type that is not readable has empty cells.
    pub fn of(column: &ArrayRef, as_seconds: bool) -> Cells {
        Cells {
            nulls: column.logical_nulls(),
            values: values(column, as_seconds),
        }
    }

    pub fn push(&self, row: usize, text: &mut String) {
        if self.nulls.as_ref().is_some_and(|nulls| nulls.is_null(row)) {
            return;
        }
        let written = match &self.values {
            Values::Nothing => Ok(()),
            Values::Flags(values) => write!(text, "{}", values.value(row)),
            Values::Whole(values) => write!(text, "{}", values.value(row)),
            Values::WholeUnsigned(values) => write!(text, "{}", values.value(row)),
            // The shortest decimal that is this single: not the double nearest to it.
            Values::Single(values) => write!(text, "{}", values.value(row)),
            Values::Double(values) => {
                push_number(text, values.value(row));
                Ok(())
            }
            Values::Days(values) => push_day(values.value(row), text),
            Values::Instants {
                counts,
                ticks,
                shown,
            } => push_instant(counts.value(row), *ticks, *shown, text),
            Values::Texts(values) => {
                text.push_str(text_at(values, row));
                Ok(())
            }
            Values::Dictionary { texts, keys } => {
                text.push_str(keys.get(row).map_or("", |key| text_at(texts, *key)));
                Ok(())
            }
        };
        debug_assert!(written.is_ok(), "a String takes any text");
    }
}

fn values(column: &ArrayRef, as_seconds: bool) -> Values {
    match column.data_type() {
        DataType::Boolean => Values::Flags(column.as_boolean().clone()),
        DataType::Int8 => whole(column.as_primitive::<Int8Type>()),
        DataType::Int16 => whole(column.as_primitive::<Int16Type>()),
        DataType::Int32 => whole(column.as_primitive::<Int32Type>()),
        DataType::Int64 => whole(column.as_primitive::<Int64Type>()),
        DataType::UInt8 => whole(column.as_primitive::<UInt8Type>()),
        DataType::UInt16 => whole(column.as_primitive::<UInt16Type>()),
        DataType::UInt32 => whole(column.as_primitive::<UInt32Type>()),
        DataType::UInt64 => Values::WholeUnsigned(column.as_primitive::<UInt64Type>().clone()),
        DataType::Float32 => Values::Single(column.as_primitive::<Float32Type>().clone()),
        DataType::Float64 => Values::Double(column.as_primitive::<Float64Type>().clone()),
        DataType::Date32 => Values::Days(column.as_primitive::<Date32Type>().clone()),
        DataType::Timestamp(unit, zone) => instants(column, *unit, zone.is_some(), as_seconds),
        DataType::Dictionary(_, value) if is_text(value) => {
            let dictionary = column.as_any_dictionary();
            Values::Dictionary {
                texts: dictionary.values().clone(),
                keys: dictionary.normalized_keys(),
            }
        }
        found if is_text(found) => Values::Texts(column.clone()),
        _ => Values::Nothing,
    }
}

fn whole<Type: arrow_array::ArrowPrimitiveType>(values: &PrimitiveArray<Type>) -> Values
where
    Type::Native: Into<i64>,
{
    Values::Whole(values.unary(Into::into))
}

fn instants(column: &ArrayRef, unit: TimeUnit, has_zone: bool, as_seconds: bool) -> Values {
    let (counts, ticks): (Int64Array, i64) = match unit {
        TimeUnit::Second => (
            column.as_primitive::<TimestampSecondType>().unary(|at| at),
            1,
        ),
        TimeUnit::Millisecond => (
            column
                .as_primitive::<TimestampMillisecondType>()
                .unary(|at| at),
            1_000,
        ),
        TimeUnit::Microsecond => (
            column
                .as_primitive::<TimestampMicrosecondType>()
                .unary(|at| at),
            1_000_000,
        ),
        TimeUnit::Nanosecond => (
            column
                .as_primitive::<TimestampNanosecondType>()
                .unary(|at| at),
            1_000_000_000,
        ),
    };
    let shown = match (as_seconds, has_zone) {
        (true, _) => Shown::Seconds,
        (false, true) => Shown::Utc,
        (false, false) => Shown::Local,
    };
    Values::Instants {
        counts,
        ticks,
        shown,
    }
}

fn push_instant(count: i64, ticks: i64, shown: Shown, text: &mut String) -> std::fmt::Result {
    if shown == Shown::Seconds {
        push_number(text, count as f64 / ticks as f64);
        return Ok(());
    }
    let nanoseconds = i128::from(count) * i128::from(1_000_000_000 / ticks);
    match Timestamp::from_nanosecond(nanoseconds) {
        Ok(instant) if shown == Shown::Utc => write!(text, "{instant}"),
        Ok(instant) => write!(text, "{}", TimeZone::UTC.to_datetime(instant)),
        // No time: whoever reads the cell says so.
        Err(_) => write!(text, "timestamp {count}"),
    }
}

fn push_day(days: i32, text: &mut String) -> std::fmt::Result {
    match Timestamp::from_second(i64::from(days) * 86_400) {
        Ok(instant) => write!(text, "{}", TimeZone::UTC.to_datetime(instant).date()),
        Err(_) => write!(text, "day {days}"),
    }
}

fn text_at(texts: &ArrayRef, row: usize) -> &str {
    if row >= texts.len() || texts.is_null(row) {
        return "";
    }
    match texts.data_type() {
        DataType::Utf8 => texts.as_string::<i32>().value(row),
        DataType::LargeUtf8 => texts.as_string::<i64>().value(row),
        DataType::Utf8View => texts.as_string_view().value(row),
        _ => "",
    }
}
