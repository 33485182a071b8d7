//! Lists of requirements by what they check.

use super::kinds::REQUIREMENT;
use crate::evaluation::surveillance::Requirement;
use crate::registry::{Kind, check_field};
use serde::Deserialize;
use serde_json::Value;

/// In the order of the file.
pub const PRESETS: &[&str] = &[
    "airport_surface_radar",
    "airport_mlat_manoeuvring_area",
    "airport_mlat_apron",
    "airport_mlat_stand",
    "asmgcs_manoeuvring_area",
    "asmgcs_apron",
    "asmgcs_stand",
    "en_route_8s",
    "terminal_area_5s",
    "radar_5s",
    "tracker_against_tracker",
];

const FILE: &str = include_str!("presets.json");

#[derive(Debug, Deserialize)]
struct Preset {
    preset: String,
    items: Vec<Value>,
}

static ITEM: Kind = Kind::Union(&REQUIREMENT);

/// The requirements of a preset; none of an unknown one.
pub fn items_of(name: &str) -> Vec<Requirement> {
    let presets: Vec<Preset> = serde_json::from_str(FILE).unwrap_or_default();
    let preset = presets.into_iter().find(|one| one.preset == name);
    let items = preset.map(|preset| preset.items).unwrap_or_default();
    let checked = items
        .iter()
        .map(|item| check_field(item, &ITEM, "", &mut Vec::new()));
    checked
        .filter_map(|item| Requirement::deserialize(item).ok())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_of_the_file_is_right_and_every_preset_has_a_name() {
        let presets: Vec<Preset> = serde_json::from_str(FILE).unwrap();
        let names: Vec<&str> = presets.iter().map(|one| one.preset.as_str()).collect();
        assert_eq!(names, PRESETS);
        for preset in &presets {
            let mut faults = Vec::new();
            for item in &preset.items {
                check_field(item, &ITEM, &preset.preset, &mut faults);
            }
            assert!(faults.is_empty(), "{faults:?}");
            let items = items_of(&preset.preset);
            assert_eq!(items.len(), preset.items.len(), "{}", preset.preset);
            for item in &items {
                assert!(item.bound.comparison().is_some(), "{item:?}");
            }
        }
    }
}
