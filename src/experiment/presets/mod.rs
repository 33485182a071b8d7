//! Presets: complete job bodies, ready to run or to change. One file an origin, one line of [`all`].

pub mod cai_fuzzy;
mod huo2008;
mod liang2009;
mod wang_bat;
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
pub const PAPERS: [&str; 4] = [
    "liang2009-table1",
    "cai-fuzzy-tables",
    "huo2008-study",
    "wang-bat-tables",
];

/// Every preset.
pub fn all() -> Vec<Preset> {
    let mut presets = liang2009::presets();
    presets.extend(cai_fuzzy::presets());
    presets.extend(huo2008::presets());
    presets.extend(wang_bat::presets());
    presets.extend(wang_bat_record::presets());
    presets
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
    all().into_iter().find(|preset| preset.name == name)
}
