//! What a user is told of the names of columns.

use super::Schema;
use crate::formats::table::{FaultLog, Rows};
use crate::model::names::shorten;
use std::collections::BTreeMap;

/// Names in a message: the first ones, each cut to a length that fits.
pub(super) fn listed<'n>(names: impl ExactSizeIterator<Item = &'n str>) -> String {
    const MOST: usize = 50;
    let more = names.len().saturating_sub(MOST);
    let first = names.take(MOST).map(shorten).collect::<Vec<_>>().join(", ");
    if more > 0 {
        format!("{first} and {more} more")
    } else {
        first
    }
}

fn planar_warning(part: &[&str]) -> String {
    let [first, .., last] = part else {
        return String::new();
    };
    format!(
        "z_m makes these places those of a volume, but {first} … {last} are of the plane, so they are not read; without z_m all is of the plane"
    )
}

pub(super) fn warnings(schema: &Schema, file_names: &[String], names: &[String]) -> Vec<String> {
    let list = |wanted: &dyn Fn(&str) -> bool| -> Vec<&str> {
        file_names
            .iter()
            .zip(names)
            .filter(|(_, name)| wanted(name))
            .map(|(file_name, _)| file_name.as_str())
            .collect()
    };
    let unused = list(&|name| schema.is_unused(name));
    let unknown = list(&|name| !schema.is_unused(name) && !schema.is_used(name));
    let planar = schema.planar_parts(names).map(planar_warning);
    let mut warnings: Vec<String> = planar.collect();
    if !unused.is_empty() {
        warnings.push(format!(
            "columns kept in the file but not used: {}",
            listed(unused.iter().copied())
        ));
    }
    if !unknown.is_empty() {
        warnings.push(format!(
            "unknown columns, kept in the file but not used: {}",
            listed(unknown.iter().copied())
        ));
    }
    warnings
}

/// Reports a column that is there twice.
pub(super) fn check_duplicates(rows: &dyn Rows, names: &[String], faults: &mut FaultLog) {
    let mut places = BTreeMap::new();
    for (index, name) in names.iter().enumerate() {
        let first = *places.entry(name).or_insert(index);
        if first == index {
            continue;
        }
        let detail = format!(
            "column '{name}' occurs twice: columns {} and {}",
            first + 1,
            index + 1
        );
        faults.push(rows.header_fault(Some(&rows.names()[index]), "duplicate", detail));
    }
}
