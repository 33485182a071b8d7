//! The field of a request that asks for requirements.

use super::kinds::REQUIREMENT;
use super::presets::PRESETS;
use crate::experiment::evaluate::within::{AREA, PLACE_M};
use crate::registry::{Field, Kind, Object, above, default, list, optional, required};

const NAME: Kind = Kind::Text { max_length: 200 };
static SECTOR_NAME: Kind = NAME;
const MOST: usize = 100;

static SECTOR: Object = Object {
    name: "RequirementSector",
    summary: "A part of the airspace or of an airport.",
    fields: &[
        required("sector_id", "Its name in the report.", NAME),
        optional(
            "areas",
            "Points in any of these are inside; everywhere when absent.",
            list(&Kind::Union(&AREA), 1, MOST),
        ),
        optional(
            "height_min_m",
            "Lowest height; points without one are inside.",
            PLACE_M,
        ),
        optional(
            "height_max_m",
            "Highest height; points without one are inside.",
            PLACE_M,
        ),
    ],
};

static PRESET: Object = Object {
    name: "RequirementPreset",
    summary: "Requirements with thresholds as another tool ships them; the standards' own texts were not read.",
    fields: &[
        required("preset", "Which.", Kind::Choice(PRESETS)),
        optional(
            "sectors",
            "Identifiers of the sectors that it holds in; all when absent.",
            list(&SECTOR_NAME, 1, MOST),
        ),
    ],
};

static REQUIREMENTS: Object = Object {
    name: "Requirements",
    summary: "Requirements of air surveillance, held against tracks and truth.",
    fields: &[
        optional(
            "sectors",
            "Where; one sector called everywhere when absent.",
            list(&Kind::Object(&SECTOR), 1, MOST),
        ),
        optional(
            "presets",
            "Lists of requirements.",
            list(&Kind::Object(&PRESET), 1, MOST),
        ),
        optional(
            "items",
            "Requirements of your own, after those of presets.",
            list(&Kind::Union(&REQUIREMENT), 1, 1000),
        ),
        default(
            "pairing",
            "How updates find their target. auto: by identity where that target is within the gate, else the nearest within it. nearest: the nearest.",
            Kind::Choice(&["auto", "nearest"]),
            "\"auto\"",
        ),
        optional(
            "gate_m",
            "Within this distance an update may be of a target; that of `comparison` when absent.",
            above(0.0, 1e8, "m"),
        ),
        default(
            "reference_reach_s",
            "A point of the truth may be this far from an update, and from the next point of its period.",
            above(0.0, 1e6, "s"),
            "5.0",
        ),
        default(
            "counts_coasted",
            "Whether points of tracks that were predicted without a detection are updates.",
            Kind::Flag,
            "true",
        ),
    ],
};

/// The field of a request.
pub const FIELD: Field = optional(
    "requirements",
    "Requirements of air surveillance: updates, gaps, accuracy, identity, false and extra tracks, by sector and phase. What fails, or has no value, is not met: see `limits` of the result.",
    Kind::Object(&REQUIREMENTS),
);
