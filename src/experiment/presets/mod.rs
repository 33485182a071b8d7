//! Presets: complete job bodies, ready to run or to change. One file an origin, one line of [`all`].

pub mod cai_fuzzy;
mod huo2008;
mod liang2009;
mod wang_bat;
mod wang_bat_record;

use super::plan::JobKind;
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
pub const PAPERS: [&str; 4] = ["liang2009-table1", "cai-fuzzy-tables", "huo2008-study", "wang-bat-tables"];

/// Every preset.
pub fn all() -> Vec<Preset> {
    let mut presets = liang2009::presets();
    presets.extend(cai_fuzzy::presets());
    presets.extend(huo2008::presets());
    presets.extend(wang_bat::presets());
    presets.extend(wang_bat_record::presets());
    presets
}

/// The preset with this name. `liang2009` and `liang2009-polar` alone are the largest scenes.
pub fn find(name: &str) -> Option<Preset> {
    let largest = format!("{name}-100");
    let named = |wanted: &str| all().into_iter().find(|preset| preset.name == wanted);
    named(name).or_else(|| named(&largest))
}
