//! The bodies of the requests, described field by field.

use super::scenario::SCENARIO;
use crate::association::ASSOCIATOR;
use crate::correlation::grouping::GROUPER;
use crate::evaluation::metrics::{METRES, METRIC};
use crate::filtering::FILTER;
use crate::registry::{Bound, Field, Kind, Object, Union, Variant, default, optional, required};
use crate::tracking::LIFECYCLE;

/// Limits that keep a job within one machine.
pub const MAX_SCANS: i64 = 100_000;
pub const MAX_TARGETS: i64 = 100_000;
/// Detections of one simulation.
pub const MAX_DETECTIONS: f64 = 20e6;

pub const PLACE: Kind = Kind::Number {
    min: Bound::Including(-1e9),
    max: Bound::Including(1e9),
    unit: "m",
};
pub const SIGMA: Kind = Kind::Number {
    min: Bound::Excluding(0.0),
    max: Bound::Including(1e6),
    unit: "m",
};
pub const SIGMA_BEARING: Kind = Kind::Number {
    min: Bound::Excluding(0.0),
    max: Bound::Including(180.0),
    unit: "deg",
};
pub const BEARING: Kind = Kind::Number {
    min: Bound::Including(-360.0),
    max: Bound::Including(360.0),
    unit: "deg",
};
pub const SIGMA_RATE: Kind = Kind::Number {
    min: Bound::Excluding(0.0),
    max: Bound::Including(1e5),
    unit: "m/s",
};
pub const RANGE: Kind = Kind::Number {
    min: Bound::Excluding(0.0),
    max: Bound::Including(1e9),
    unit: "m",
};
pub const PROBABILITY: Kind = Kind::Number {
    min: Bound::Excluding(0.0),
    max: Bound::Including(1.0),
    unit: "",
};
pub const SPEED: Kind = Kind::Number {
    min: Bound::Including(0.0),
    max: Bound::Including(1e5),
    unit: "m/s",
};
pub const VELOCITY: Kind = Kind::Number {
    min: Bound::Including(-1e5),
    max: Bound::Including(1e5),
    unit: "m/s",
};
pub const NAME: Kind = Kind::Text { max_length: 100 };

const SENSOR_IDS: Field = optional(
    "sensor_ids",
    "Only the scans, or of tracks the points, of these sensors; all of them when absent.",
    Kind::List {
        item: &NAME,
        min: 1,
        max: 64,
    },
);

static SOURCE_DATASET: Object = Object {
    name: "DatasetSource",
    summary: "An uploaded dataset, or one that a job made.",
    fields: &[
        required("dataset_id", "Identity of the dataset.", Kind::Id),
        SENSOR_IDS,
    ],
};

static SOURCE_JOB: Object = Object {
    name: "JobSource",
    summary: "The output of another job; a job that is not finished is waited for.",
    fields: &[
        required("job_id", "Identity of the job.", Kind::Id),
        SENSOR_IDS,
    ],
};

static SOURCE_SCENARIO: Object = Object {
    name: "ScenarioSource",
    summary: "A scenario, simulated with the job's seed.",
    fields: &[required("scenario", "The scene.", Kind::Object(&SCENARIO))],
};

static SOURCE_PRESET: Object = Object {
    name: "PresetSource",
    summary: "The scenario of a preset, simulated with the job's seed; its sensors, associator, filter and tracker are the defaults of the job.",
    fields: &[required("preset", "Name of the preset.", NAME)],
};

static INPUT: Union = Union {
    name: "InputSource",
    summary: "Where detections come from.",
    tag: "source",
    variants: input_sources,
};

pub static DATA: Union = Union {
    name: "DataSource",
    summary: "Where recorded or computed data come from.",
    tag: "source",
    variants: data_sources,
};

pub fn input_sources() -> Vec<Variant> {
    let mut variants = data_sources();
    variants.push(Variant {
        tag: "scenario",
        object: &SOURCE_SCENARIO,
    });
    variants.push(Variant {
        tag: "preset",
        object: &SOURCE_PRESET,
    });
    variants
}

fn data_sources() -> Vec<Variant> {
    vec![
        Variant {
            tag: "dataset",
            object: &SOURCE_DATASET,
        },
        Variant {
            tag: "job",
            object: &SOURCE_JOB,
        },
    ]
}

pub static SENSOR_SETTINGS: Object = Object {
    name: "SensorSettings",
    summary: "What is known of a sensor of a recording; given values replace those that came with the data.",
    fields: &[
        required("sensor_id", "Name of the sensor in the recording.", NAME),
        optional("x_m", "Position, east.", PLACE),
        optional("y_m", "Position, north.", PLACE),
        optional("max_range_m", "Radius of the field of view.", RANGE),
        optional(
            "p_d",
            "Probability that a target in view is detected in a scan.",
            PROBABILITY,
        ),
        optional(
            "clutter_per_m2",
            "Expected false detections per square metre and scan, also of a sensor that reports ranges and bearings.",
            Kind::Number {
                min: Bound::Excluding(0.0),
                max: Bound::Including(1e6),
                unit: "1/m²",
            },
        ),
        optional(
            "clutter_per_deg",
            "Expected false detections per degree and scan, of a sensor whose bearings alone are used.",
            Kind::Number {
                min: Bound::Excluding(0.0),
                max: Bound::Including(1e6),
                unit: "1/deg",
            },
        ),
        optional("sigma_x_m", "Standard deviation of x.", SIGMA),
        optional("sigma_y_m", "Standard deviation of y.", SIGMA),
        optional("sigma_range_m", "Standard deviation of ranges.", SIGMA),
        optional(
            "sigma_bearing_deg",
            "Standard deviation of bearings.",
            SIGMA_BEARING,
        ),
        optional(
            "sigma_range_rate_mps",
            "Standard deviation of range rates.",
            SIGMA_RATE,
        ),
    ],
};

static NOTHING: Object = Object {
    name: "DetectionIdSymbols",
    summary: "A symbol is the identity of a detection, as in the paper.",
    fields: &[],
};

static NEAREST_DETECTION: Object = Object {
    name: "NearestDetectionSymbols",
    summary: "A symbol is the detection of the same scan that is nearest to the track: for trackers that do not say which they took.",
    fields: &[required(
        "gate_m",
        "Largest distance between a track and its detection.",
        RANGE,
    )],
};

static NEAREST_TRUTH: Object = Object {
    name: "NearestTruthSymbols",
    summary: "A symbol is the nearest true target: for recordings whose detections have no known origin.",
    fields: &[
        required(
            "gate_m",
            "Largest distance between a track and its truth.",
            RANGE,
        ),
        default(
            "max_gap_s",
            "Truth is interpolated between points at most this far apart.",
            Kind::Number {
                min: Bound::Including(0.0),
                max: Bound::Including(1e6),
                unit: "s",
            },
            "5.0",
        ),
    ],
};

static SYMBOLS: Union = Union {
    name: "TfaSymbols",
    summary: "What the automaton reads at each scan.",
    tag: "kind",
    variants: || {
        vec![
            Variant {
                tag: "detection_id",
                object: &NOTHING,
            },
            Variant {
                tag: "nearest_detection",
                object: &NEAREST_DETECTION,
            },
            Variant {
                tag: "nearest_truth",
                object: &NEAREST_TRUTH,
            },
        ]
    },
};

static MOST_PROBABLE: Object = Object {
    name: "MostProbableDecision",
    summary: "A track's symbol is its most probable candidate, ε included.",
    fields: &[],
};

static ALL_GATED: Object = Object {
    name: "AllGatedDecision",
    summary: "Every candidate of enough weight is a symbol of the track, ε too, or where nothing else is.",
    fields: &[default(
        "min_weight",
        "Least weight of a candidate.",
        Kind::Number {
            min: Bound::Excluding(0.0),
            max: Bound::Including(1.0),
            unit: "",
        },
        "0.05",
    )],
};

static DECISION: Union = Union {
    name: "TfaDecision",
    summary: "How a track's weights become symbols.",
    tag: "policy",
    variants: || {
        vec![
            Variant {
                tag: "most_probable",
                object: &MOST_PROBABLE,
            },
            Variant {
                tag: "all_gated",
                object: &ALL_GATED,
            },
        ]
    },
};

pub static TFA: Object = Object {
    name: "TfaSettings",
    summary: "The temporal finite automaton that judges tracks.",
    fields: &[
        default(
            "symbols",
            "What the automaton reads.",
            Kind::Union(&SYMBOLS),
            r#"{"kind":"detection_id"}"#,
        ),
        default(
            "decision",
            "How weights become symbols.",
            Kind::Union(&DECISION),
            r#"{"policy":"most_probable"}"#,
        ),
        default(
            "max_missed",
            "Scans in a row without a symbol that end a string.",
            Kind::Integer {
                min: 1,
                max: 1000,
                unit: "scans",
            },
            "5",
        ),
        default(
            "tolerance",
            "Largest number of errors that are forgiven: the report tells how many targets are correct for each up to it.",
            Kind::Integer {
                min: 0,
                max: 1000,
                unit: "scans",
            },
            "5",
        ),
        default(
            "search",
            "How a string is run through the automaton; the verdicts are the same.",
            Kind::Choice(&["breadth_first", "depth_first"]),
            "\"breadth_first\"",
        ),
        default(
            "minimise",
            "Whether to determinise and minimise the automaton; the verdicts are the same.",
            Kind::Flag,
            "false",
        ),
    ],
};

pub const JOB_NAME: Field = optional("name", "A name for people.", NAME);
pub const LABELS: Field = optional(
    "labels",
    "Labels to find the job by, name to text.",
    Kind::TextMap {
        max_entries: 32,
        max_length: 100,
    },
);
const DETECTOR: Field = optional(
    "detector",
    "Where the input is a bearing-time record: how detections are found in it; {} takes the defaults. Filled in where a scenario has one.",
    Kind::Object(&crate::detection::DETECTOR),
);
pub const SEED: Field = default(
    "seed",
    "Seed of every random number of the job.",
    Kind::Integer {
        min: 0,
        max: u32::MAX as i64,
        unit: "",
    },
    "1",
);
static ONE_SENSOR: Kind = Kind::Object(&SENSOR_SETTINGS);
pub const SENSORS: Field = optional(
    "sensors",
    "Settings of the recording's sensors, by name.",
    Kind::List {
        item: &ONE_SENSOR,
        min: 1,
        max: 64,
    },
);

pub static SIMULATE: Object = Object {
    name: "SimulateRequest",
    summary: "Simulate a scenario: detections with known origins, and the truth.",
    fields: &[
        JOB_NAME,
        LABELS,
        SEED,
        required("scenario", "The scene.", Kind::Object(&SCENARIO)),
    ],
};

pub static ASSOCIATE: Object = Object {
    name: "AssociateRequest",
    summary: "Track the targets of a recording or a scenario.",
    fields: &[
        JOB_NAME,
        LABELS,
        SEED,
        required(
            "input",
            "The detections, or with detector a bearing-time record.",
            Kind::Union(&INPUT),
        ),
        DETECTOR,
        optional(
            "truth",
            "Truth at which tracks begin (initiation truth), where the input does not know it.",
            Kind::Union(&DATA),
        ),
        SENSORS,
        default(
            "associator",
            "How detections are given to tracks.",
            Kind::Union(&ASSOCIATOR),
            DEFAULT_ASSOCIATOR,
        ),
        default(
            "filter",
            "How tracks are predicted and updated.",
            Kind::Union(&FILTER),
            DEFAULT_FILTER,
        ),
        default(
            "tracker",
            "Gate and life cycle.",
            Kind::Object(&LIFECYCLE),
            "{}",
        ),
    ],
};

pub static GROUP: Object = Object {
    name: "GroupRequest",
    summary: "Put together what several sensors report of one target at one instant.",
    fields: &[
        JOB_NAME,
        LABELS,
        SEED,
        required(
            "input",
            "The detections: positions of two sensors or more at common times.",
            Kind::Union(&INPUT),
        ),
        SENSORS,
        required(
            "grouper",
            "How reports are put together.",
            Kind::Union(&GROUPER),
        ),
        default(
            "predictions",
            "The tracks behind groupers that use predictions.",
            Kind::Object(&crate::experiment::group::PREDICTIONS),
            "{}",
        ),
    ],
};

pub const DEFAULT_ASSOCIATOR: &str = r#"{"method":"nearest_neighbour"}"#;
pub const DEFAULT_FILTER: &str = r#"{"method":"auto"}"#;

const MAX_GAP: Field = default(
    "max_gap_s",
    "Largest gap in the truth that is bridged.",
    Kind::Number {
        min: Bound::Including(0.0),
        max: Bound::Including(1e6),
        unit: "s",
    },
    "5.0",
);

const TIME_TOLERANCE: Field = optional(
    "time_tolerance_s",
    "Times that differ by no more are one step. Default: a twentieth of the shortest time between two points of one target or track, at most 0.01 s.",
    Kind::Number {
        min: Bound::Including(0.0),
        max: Bound::Including(1e6),
        unit: "s",
    },
);

static INTERPOLATE: Object = Object {
    name: "InterpolateAlignment",
    summary: "Truth on the line between its two neighbouring points.",
    fields: &[MAX_GAP, TIME_TOLERANCE],
};

static NEAREST_TIME: Object = Object {
    name: "NearestAlignment",
    summary: "The truth's nearest point in time.",
    fields: &[MAX_GAP, TIME_TOLERANCE],
};

static ALIGNMENT: Union = Union {
    name: "Alignment",
    summary: "How truth is brought to the times at which it is compared with tracks.",
    tag: "method",
    variants: || {
        vec![
            Variant {
                tag: "interpolate",
                object: &INTERPOLATE,
            },
            Variant {
                tag: "nearest",
                object: &NEAREST_TIME,
            },
        ]
    },
};

pub static COMPARISON: Object = Object {
    name: "ComparisonSettings",
    summary: "How truth and tracks are put side by side for all metrics.",
    fields: &[
        // The profiles take it for the cutoff of their metrics, so it has the range of one.
        default(
            "gate_m",
            "Largest distance of a match of points; a distance of exactly that is a match.",
            METRES,
            "100.0",
        ),
        default(
            "gate_deg",
            "The same of directions.",
            Kind::Number {
                min: Bound::Excluding(0.0),
                max: Bound::Including(90.0),
                unit: "deg",
            },
            "5.0",
        ),
        default(
            "min_iou",
            "Smallest intersection over union of a match of boxes.",
            Kind::Number {
                min: Bound::Excluding(0.0),
                max: Bound::Including(1.0),
                unit: "",
            },
            "0.5",
        ),
        default(
            "alignment",
            "How clocks are brought together.",
            Kind::Union(&ALIGNMENT),
            r#"{"method":"interpolate"}"#,
        ),
    ],
};

/// What is judged when the request does not list it.
pub const PROFILES: &[&str] = &["tracking", "vision", "tfa"];

static SEQUENCE: Object = Object {
    name: "EvaluationSequence",
    summary: "Truth and tracks of one of several recordings.",
    fields: &[
        required("name", "Name of the sequence in the report.", NAME),
        required("truth", "The truth.", Kind::Union(&DATA)),
        required("tracks", "The tracks.", Kind::Union(&DATA)),
    ],
};

pub static EVALUATE: Object = Object {
    name: "EvaluateRequest",
    summary: "Judge tracks: those of `tracks` or `sequences`, or those that an associator makes of `input` first.",
    fields: &[
        JOB_NAME,
        LABELS,
        SEED,
        optional(
            "input",
            "Detections, or with detector a bearing-time record, to track before the evaluation; instead of `tracks`.",
            Kind::Union(&INPUT),
        ),
        DETECTOR,
        SENSORS,
        optional(
            "associator",
            "With `input`: how detections are given to tracks (default nearest_neighbour).",
            Kind::Union(&ASSOCIATOR),
        ),
        optional(
            "filter",
            "With `input`: how tracks are predicted and updated (default auto).",
            Kind::Union(&FILTER),
        ),
        optional(
            "tracker",
            "With `input`: gate and life cycle.",
            Kind::Object(&LIFECYCLE),
        ),
        optional(
            "tracks",
            "Tracks to judge; instead of `input`.",
            Kind::Union(&DATA),
        ),
        optional(
            "truth",
            "The truth; found by itself when the input or the tracks come from a job that knows it.",
            Kind::Union(&DATA),
        ),
        optional(
            "detections",
            "With `tracks`: the detections they were made of; found by itself when `tracks` is a job.",
            Kind::Union(&DATA),
        ),
        optional(
            "sequences",
            "Several pairs of truth and tracks, judged by `metrics` together; instead of `input` and `tracks`.",
            Kind::List {
                item: &Kind::Object(&SEQUENCE),
                min: 1,
                max: 1000,
            },
        ),
        default(
            "profile",
            "What is judged when `metrics` is absent: tracking (metrics in metres and the automaton), vision (HOTA, CLEAR, identity), tfa (the automaton alone).",
            Kind::Choice(PROFILES),
            "\"tracking\"",
        ),
        optional(
            "metrics",
            "The metrics; instead of those of the profile. A metric may be listed twice with other parameters.",
            Kind::List {
                item: &Kind::Union(&METRIC),
                min: 0,
                max: 32,
            },
        ),
        default(
            "comparison",
            "How truth and tracks are put side by side for the metrics.",
            Kind::Object(&COMPARISON),
            "{}",
        ),
        optional(
            "tfa",
            "Settings of the temporal automaton. When absent, the profiles tracking and tfa read detection ids where detections with known origins are there, else the nearest target within the gate and the largest gap of `comparison`.",
            Kind::Object(&TFA),
        ),
    ],
};
