//! What is known of targets, tracks or detections beside where they were: who they say they are, how they were seen.

use std::collections::BTreeMap;

/// Names of attributes, which are their columns.
pub const ATTRIBUTES: &[&str] = &[
    "address",
    "callsign",
    "mode_a",
    "mode_c_ft",
    "position_accuracy_m",
    "mmsi",
    "ship_name",
    "ship_type",
    "track_number",
    "on_ground",
    "report_kind",
];

/// The name of an attribute as this program writes it.
pub fn attribute_named(name: &str) -> Option<&'static str> {
    ATTRIBUTES.iter().find(|known| **known == name).copied()
}

/// Of each target or track by its name: attributes by theirs.
pub type Attributes = BTreeMap<String, BTreeMap<&'static str, String>>;
