//! The body of a campaign, described field by field, and its type.

use super::outcomes::Outcome;
use crate::experiment::limits::{LIMITS, Limit};
use crate::experiment::request::fields::{JOB_NAME, LABELS, NAME, SEED};
use crate::registry::{
    Bound, Field, Kind, Object, Union, above, default, list, optional, required, variant, whole,
};
use serde::Deserialize;
use serde_json::Value;

pub(super) const MAX_RUNS: i64 = 1_000_000;

const PATH: Kind = Kind::Text { max_length: 500 };

const POINTER: Field = required(
    "path",
    "JSON pointer into `base`, such as `/associator` or `/tracker/gate_probability`.",
    PATH,
);

static CHANGE: Object = Object {
    name: "CampaignChange",
    summary: "A value for one place of the base.",
    fields: &[POINTER, required("value", "What stands there.", Kind::Json)],
};

static VARIANT: Object = Object {
    name: "CampaignVariant",
    summary: "A named set of changes.",
    fields: &[
        required("name", "Name of the variant in the table.", NAME),
        required("set", "The changes.", list(&Kind::Object(&CHANGE), 0, 50)),
    ],
};

static BY_VALUES: Object = Object {
    name: "ValuesAxis",
    summary: "One place of the base takes each of several values.",
    fields: &[
        optional("name", "Name of the axis; the path when absent.", NAME),
        POINTER,
        required("values", "The values.", list(&Kind::Json, 1, 1000)),
    ],
};

static BY_VARIANTS: Object = Object {
    name: "VariantsAxis",
    summary: "Named variants, each of which changes several places of the base.",
    fields: &[
        required("name", "Name of the axis.", NAME),
        required(
            "variants",
            "The variants.",
            list(&Kind::Object(&VARIANT), 1, 1000),
        ),
    ],
};

static AXIS: Union = Union {
    name: "CampaignAxis",
    summary: "One direction of the grid.",
    tag: "by",
    variants: || {
        vec![
            variant("values", &BY_VALUES),
            variant("variants", &BY_VARIANTS),
        ]
    },
};

static OUTCOME: Object = Object {
    name: "CampaignOutcome",
    summary: "A number of every run's result.",
    fields: &[
        required(
            "path",
            "Where it stands in the result, names divided by dots, such as `tfa.probability.correct`.",
            PATH,
        ),
        optional("name", "Its name in the table; the path when absent.", NAME),
        default(
            "interval",
            "t: of a mean, within 0 and 1 where the number is a share or a probability; wilson: of a share, for what is 0 or 1 (or false and true) in a run; bootstrap: of a mean, by 2 000 resamples.",
            Kind::Choice(&["t", "wilson", "bootstrap"]),
            "\"t\"",
        ),
        optional(
            "where",
            "Only runs in which the number at this path is 1 (or true).",
            PATH,
        ),
    ],
};

static COMPARE: Object = Object {
    name: "CampaignComparison",
    summary: "What the cells are compared with, run by run on the same scenes.",
    fields: &[
        required("axis", "Name of an axis.", NAME),
        required(
            "to",
            "The point of that axis that the others are compared with; a value as JSON writes it.",
            NAME,
        ),
    ],
};

static STOP: Object = Object {
    name: "CampaignStop",
    summary: "A cell ends when the interval of an outcome is narrow enough; looked at after 10, 20, 40, 80, … runs.",
    fields: &[
        required("outcome", "Name of one of the listed outcomes.", NAME),
        required(
            "half_width",
            "Half of the length of its interval, in the unit of the outcome, at which it is narrow enough.",
            above(0.0, 1e300, ""),
        ),
    ],
};

pub static CAMPAIGN: Object = Object {
    name: "CampaignRequest",
    summary: "Run a job many times over a grid of its parameters. Run r of every cell has the same scene.",
    fields: &[
        JOB_NAME,
        LABELS,
        LIMITS,
        SEED,
        required(
            "base",
            "The job of each run: the body of a job of another kind, with its `kind`.",
            Kind::Json,
        ),
        optional(
            "grid",
            "The axes; the cells are their product. When absent, the base is the one cell.",
            list(&Kind::Union(&AXIS), 1, 8),
        ),
        default(
            "runs",
            "Runs of each cell, the most where `stop_at` may end it before.",
            whole(1, MAX_RUNS, "runs"),
            "20",
        ),
        default(
            "confidence",
            "Confidence of the intervals.",
            Kind::Number {
                min: Bound::Excluding(0.0),
                max: Bound::Excluding(1.0),
                unit: "",
            },
            "0.95",
        ),
        optional(
            "outcomes",
            "The numbers that are kept of each run; when absent, counts and probabilities of the automaton and every metric.",
            list(&Kind::Object(&OUTCOME), 1, 100),
        ),
        optional(
            "compare",
            "When absent, the first point of the last axis.",
            Kind::Object(&COMPARE),
        ),
        optional(
            "stop_at",
            "When absent, every cell has all its runs.",
            Kind::Object(&STOP),
        ),
        default(
            "timed_runs",
            "In the first so many runs of a cell the associator or grouper is timed by itself.",
            whole(0, 1000, "runs"),
            "20",
        ),
    ],
};

/// A request for a campaign.
#[derive(Deserialize)]
pub struct Spec {
    pub seed: u32,
    pub base: Value,
    #[serde(default)]
    pub grid: Vec<AxisSpec>,
    pub runs: u32,
    pub timed_runs: u32,
    pub confidence: f64,
    pub outcomes: Option<Vec<Outcome>>,
    pub compare: Option<ComparisonSpec>,
    pub stop_at: Option<StopSpec>,
    #[serde(default)]
    pub limits: Vec<Limit>,
}

/// What the cells are compared with.
#[derive(Deserialize)]
pub struct ComparisonSpec {
    pub axis: String,
    pub to: String,
}

/// When a cell ends before it has all its runs.
#[derive(Deserialize)]
pub struct StopSpec {
    pub outcome: String,
    pub half_width: f64,
}

/// A value for one place of the base.
#[derive(Debug, Clone, Deserialize)]
pub struct Change {
    pub path: String,
    pub value: Value,
}

/// A named set of changes.
#[derive(Debug, Clone, Deserialize)]
pub struct VariantSpec {
    pub name: String,
    pub set: Vec<Change>,
}

/// One direction of the grid.
#[derive(Debug, Clone, Deserialize)]
#[serde(tag = "by", rename_all = "snake_case")]
pub enum AxisSpec {
    Values {
        name: Option<String>,
        path: String,
        values: Vec<Value>,
    },
    Variants {
        name: String,
        variants: Vec<VariantSpec>,
    },
}
