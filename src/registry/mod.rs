//! The language in which everything configurable describes itself: one table of fields an object, from which come
//! the check of a request (every fault at once), its defaults, the catalogue, the OpenAPI document and the forms.
//!
//! Reads: nothing but `model::fault`. The tables themselves stand beside what they describe.

mod check;
mod export;
mod parse;
mod paths;
mod place;

pub use check::{check, check_field, check_into, control_character_fault};
pub use export::{Components, json_schema, standalone_schema, tagged_schema};
pub use parse::parse;
pub use paths::{nearest_of, nearest_path};
pub use place::Place;

use crate::model::fault::Fault;

/// A JSON object with known fields; any other field is a fault.
pub struct Object {
    /// Name of its schema in the OpenAPI document, in PascalCase.
    pub name: &'static str,
    pub summary: &'static str,
    pub fields: &'static [Field],
}

#[derive(Clone, Copy)]
pub struct Field {
    pub name: &'static str,
    pub summary: &'static str,
    pub kind: Kind,
    pub presence: Presence,
}

#[derive(Clone, Copy)]
pub enum Presence {
    Required,
    Optional,
    /// The value taken when the field is absent, as JSON text.
    Default(&'static str),
}

#[derive(Clone, Copy)]
pub enum Kind {
    Number {
        min: Bound,
        max: Bound,
        unit: &'static str,
    },
    Integer {
        min: i64,
        max: i64,
        unit: &'static str,
    },
    Text {
        max_length: usize,
    },
    Choice(&'static [&'static str]),
    Flag,
    /// The identity of a job or a dataset; who asks for it looks it up.
    Id,
    /// Any JSON value; who asks for it checks it.
    Json,
    Object(&'static Object),
    Union(&'static Union),
    List {
        item: &'static Kind,
        min: usize,
        max: usize,
    },
    /// A free map from short names to short texts (labels).
    TextMap {
        max_entries: usize,
        max_length: usize,
    },
}

/// The end of a range of numbers.
#[derive(Clone, Copy)]
pub enum Bound {
    None,
    Including(f64),
    Excluding(f64),
}

/// A field that every object must have.
pub const fn required(name: &'static str, summary: &'static str, kind: Kind) -> Field {
    Field {
        name,
        summary,
        kind,
        presence: Presence::Required,
    }
}

/// A field that may be absent.
pub const fn optional(name: &'static str, summary: &'static str, kind: Kind) -> Field {
    Field {
        name,
        summary,
        kind,
        presence: Presence::Optional,
    }
}

/// A field with the value that it has when absent, as JSON text.
pub const fn default(
    name: &'static str,
    summary: &'static str,
    kind: Kind,
    value: &'static str,
) -> Field {
    Field {
        name,
        summary,
        kind,
        presence: Presence::Default(value),
    }
}

/// A number from `min` to `max`.
pub const fn number(min: f64, max: f64, unit: &'static str) -> Kind {
    Kind::Number {
        min: Bound::Including(min),
        max: Bound::Including(max),
        unit,
    }
}

/// A number above `min`, up to `max`.
pub const fn above(min: f64, max: f64, unit: &'static str) -> Kind {
    Kind::Number {
        min: Bound::Excluding(min),
        max: Bound::Including(max),
        unit,
    }
}

/// A list of `min` to `max` items.
pub const fn list(item: &'static Kind, min: usize, max: usize) -> Kind {
    Kind::List { item, min, max }
}

/// A map of at most so many texts of at most so many characters.
pub const fn text_map(max_entries: usize, max_length: usize) -> Kind {
    Kind::TextMap {
        max_entries,
        max_length,
    }
}

/// A whole number from `min` to `max`.
pub const fn whole(min: i64, max: i64, unit: &'static str) -> Kind {
    Kind::Integer { min, max, unit }
}

/// How many fields several tables have together.
pub const fn count_fields(tables: &[&[Field]]) -> usize {
    let (mut count, mut table) = (0, 0);
    while table < tables.len() {
        count += tables[table].len();
        table += 1;
    }
    count
}

/// The fields of several tables as those of one, which has `N` of them.
pub const fn joined<const N: usize>(tables: &[&[Field]]) -> [Field; N] {
    let mut fields = [optional("", "", Kind::Json); N];
    let (mut count, mut table) = (0, 0);
    while table < tables.len() {
        let mut index = 0;
        while index < tables[table].len() {
            fields[count] = tables[table][index];
            (count, index) = (count + 1, index + 1);
        }
        table += 1;
    }
    fields
}

/// One of several objects, told apart by the text in the field `tag`.
pub struct Union {
    pub name: &'static str,
    pub summary: &'static str,
    pub tag: &'static str,
    /// A function, so that a union can read a table of methods.
    pub variants: fn() -> Vec<Variant>,
}

#[derive(Clone, Copy)]
pub struct Variant {
    pub tag: &'static str,
    /// The variant's other fields; the tag itself is not among them.
    pub object: &'static Object,
}

pub const fn variant(tag: &'static str, object: &'static Object) -> Variant {
    Variant { tag, object }
}

/// One entry of a family of methods: its name, its parameters, and how it is built from checked parameters.
pub struct Method<Build> {
    pub name: &'static str,
    pub parameters: &'static Object,
    pub build: Build,
}

impl<Build> Method<Build> {
    pub fn variant(&self) -> Variant {
        Variant {
            tag: self.name,
            object: self.parameters,
        }
    }
}

/// Faults of a part, each with the place of the part before its pointer.
pub fn placed(place: &str, faults: Vec<Fault>) -> Vec<Fault> {
    let placed = |fault: Fault| Fault {
        pointer: format!("{place}{}", fault.pointer),
        ..fault
    };
    faults.into_iter().map(placed).collect()
}
