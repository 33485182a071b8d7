//! Presets: complete job bodies, ready to run or to change. One file an origin, one line of [`FAMILIES`].

pub mod cai_fuzzy;
mod cai_fuzzy_claims;
mod coalescence;
mod hard_scenes;
mod huo2008;
mod huo2008_claims;
mod liang2009;
mod maneuvers;
mod own_ship;
mod random_sets;
mod recorded;
mod two_radars;
mod wang_bat;
mod wang_bat_claims;
mod wang_bat_record;

use crate::experiment::job::JobKind;
use serde_json::Value;

/// A named job body.
#[derive(Debug, Clone)]
pub struct Preset {
    pub name: String,
    pub summary: String,
    pub kind: JobKind,
    pub body: Value,
}

/// The campaigns that compute what four papers claim.
pub const PAPERS: &[&str] = &[
    "liang2009-table1",
    "liang2009-clutter",
    "liang2009-beginnings",
    "cai-fuzzy-tables",
    "cai-fuzzy-duplicates",
    "cai-fuzzy-starts",
    "cai-fuzzy-noise",
    "cai-fuzzy-strongest",
    "cai-fuzzy-attributes",
    "cai-fuzzy-genetic",
    "huo2008-study",
    "huo2008-statistic",
    "huo2008-printed",
    "huo2008-confirmation",
    "huo2008-integer-programming",
    "huo2008-nodes",
    "huo2008-relaxation",
    "huo2008-alpha",
    "wang-bat-tables",
    "wang-bat-noise",
    "wang-bat-clutter",
    "wang-bat-targets",
    "wang-bat-crossings",
    "wang-bat-objective",
    "wang-bat-alpha-gamma",
    "wang-bat-sea-trials",
];

type MakePresets = fn() -> Vec<Preset>;

/// What the names of some presets begin with, and the presets. Making a body takes time, so whoever looks for one makes few.
const FAMILIES: [(&str, MakePresets); 17] = [
    ("liang2009-", liang2009::presets),
    ("cai-fuzzy-", cai_fuzzy::presets),
    ("cai-fuzzy-", cai_fuzzy_claims::presets),
    ("huo2008", huo2008::presets),
    ("huo2008-", huo2008_claims::presets),
    ("wang-bat-", wang_bat::presets),
    ("wang-bat-", wang_bat_claims::presets),
    ("wang-bat-", wang_bat_record::presets),
    ("solent-", recorded::presets),
    ("atc-maneuver", maneuvers::atc),
    ("maneuver-10hz", maneuvers::ten_hertz),
    ("two-radars", two_radars::presets),
    ("own-ship-", own_ship::presets),
    ("williams2015", random_sets::williams),
    ("coalescence", coalescence::presets),
    ("crossing-low-pd", hard_scenes::crossing),
    ("clumped-clutter", hard_scenes::clumped),
];

/// Every preset.
pub fn all() -> Vec<Preset> {
    FAMILIES.iter().flat_map(|(_, presets)| presets()).collect()
}

/// Other names of presets: of a series of scenes, the largest.
pub const ALIASES: [(&str, &str); 2] = [
    ("liang2009", "liang2009-100"),
    ("liang2009-polar", "liang2009-polar-100"),
];

/// The preset with this name or alias.
pub fn find(name: &str) -> Option<Preset> {
    let name = ALIASES
        .iter()
        .find(|(alias, _)| *alias == name)
        .map_or(name, |(_, preset)| preset);
    FAMILIES
        .iter()
        .filter(|(beginning, _)| name.starts_with(beginning))
        .flat_map(|(_, presets)| presets())
        .find(|preset| preset.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_is_found_by_its_name_and_alias() {
        for preset in all() {
            let found = find(&preset.name).unwrap();
            assert_eq!((found.name, found.body), (preset.name, preset.body));
        }
        for (alias, name) in ALIASES {
            assert_eq!(find(alias).unwrap().name, name);
        }
        assert!(find("liang2009-11").is_none() && find("").is_none());
    }
}
