//! The bodies of the requests, described field by field.

use crate::association::ASSOCIATOR;
use crate::correlation::GROUPER;
use crate::evaluation::metrics::METRIC;
use crate::filtering::FILTER;
use crate::registry::{Bound, Field, Kind, Object, Presence, Union, Variant};
use crate::tracking::LIFECYCLE;

/// Limits that keep a job within one machine.
pub const MAX_SCANS: i64 = 100_000;
pub const MAX_TARGETS: i64 = 100_000;
/// Detections of one simulation.
pub const MAX_DETECTIONS: f64 = 20e6;

const PLACE: Kind = Kind::Number { min: Bound::Including(-1e9), max: Bound::Including(1e9), unit: "m" };
const SIGMA: Kind = Kind::Number { min: Bound::Excluding(0.0), max: Bound::Including(1e6), unit: "m" };
const SIGMA_BEARING: Kind = Kind::Number { min: Bound::Excluding(0.0), max: Bound::Including(180.0), unit: "deg" };
const BEARING: Kind = Kind::Number { min: Bound::Including(-360.0), max: Bound::Including(360.0), unit: "deg" };
const SIGMA_RATE: Kind = Kind::Number { min: Bound::Excluding(0.0), max: Bound::Including(1e5), unit: "m/s" };
const RANGE: Kind = Kind::Number { min: Bound::Excluding(0.0), max: Bound::Including(1e9), unit: "m" };
const PROBABILITY: Kind = Kind::Number { min: Bound::Excluding(0.0), max: Bound::Including(1.0), unit: "" };
const SPEED: Kind = Kind::Number { min: Bound::Including(0.0), max: Bound::Including(1e5), unit: "m/s" };
const VELOCITY: Kind = Kind::Number { min: Bound::Including(-1e5), max: Bound::Including(1e5), unit: "m/s" };
const NAME: Kind = Kind::Text { max_length: 100 };

const fn required(name: &'static str, summary: &'static str, kind: Kind) -> Field {
    Field { name, summary, kind, presence: Presence::Required }
}

const fn optional(name: &'static str, summary: &'static str, kind: Kind) -> Field {
    Field { name, summary, kind, presence: Presence::Optional }
}

const fn default(name: &'static str, summary: &'static str, kind: Kind, value: &'static str) -> Field {
    Field { name, summary, kind, presence: Presence::Default(value) }
}

static SCENARIO_SENSOR: Object = Object {
    name: "ScenarioSensor",
    summary: "A sensor that reports positions (give sigma_x_m, sigma_y_m), ranges and bearings (give sigma_range_m, sigma_bearing_deg, and sigma_range_rate_mps for range rates) or bearings alone (give sigma_bearing_deg) with independent Gaussian noise, and uniform clutter in its field of view, its density told by clutter_per_scan or clutter_per_deg; without either there is none.",
    fields: &[
        default("sensor_id", "Name of the sensor.", NAME, "\"radar\""),
        default("x_m", "Position, east.", PLACE, "0.0"),
        default("y_m", "Position, north.", PLACE, "0.0"),
        optional(
            "max_range_m",
            "Radius of the field of view; required unless the targets are of the kind bearings, which are always in view.",
            RANGE,
        ),
        default("p_d", "Probability that a target in view is detected in a scan.", PROBABILITY, "0.9"),
        optional("sigma_x_m", "Standard deviation of x, of a sensor that reports positions; with sigma_y_m.", SIGMA),
        optional("sigma_y_m", "Standard deviation of y; with sigma_x_m.", SIGMA),
        optional(
            "sigma_range_m",
            "Standard deviation of ranges, of a sensor that reports them with bearings; with sigma_bearing_deg.",
            SIGMA,
        ),
        optional(
            "sigma_bearing_deg",
            "Standard deviation of bearings; with sigma_range_m, or alone for a sensor that reports bearings only.",
            SIGMA_BEARING,
        ),
        optional(
            "sigma_range_rate_mps",
            "Standard deviation of range rates, of a sensor that reports them with ranges and bearings.",
            SIGMA_RATE,
        ),
        optional(
            "clutter_per_scan",
            "Mean of the Poisson number of false detections in a scan.",
            Kind::Number { min: Bound::Including(0.0), max: Bound::Including(1e6), unit: "" },
        ),
        optional(
            "clutter_per_deg",
            "False detections per degree and scan, of a sensor of bearings alone; instead of clutter_per_scan.",
            Kind::Number { min: Bound::Including(0.0), max: Bound::Including(1000.0), unit: "1/deg" },
        ),
        optional(
            "clutter_within_deg",
            "With clutter_per_deg: false detections lie at most this far from the true bearing of a target in view, each degree counted once; on the whole circle when absent.",
            SIGMA_BEARING,
        ),
    ],
};

static RANDOM_TARGETS: Object = Object {
    name: "RandomTargets",
    summary: "Targets with uniform start in a square around (0, 0), uniform heading and uniform speed, all constant.",
    fields: &[
        required("count", "Number of targets.", Kind::Integer { min: 1, max: MAX_TARGETS, unit: "" }),
        required("area_side_m", "Side of the square.", RANGE),
        required("speed_min_mps", "Lowest speed.", SPEED),
        required("speed_max_mps", "Highest speed.", SPEED),
    ],
};

static LISTED_TARGET: Object = Object {
    name: "ListedTarget",
    summary: "A target with constant velocity from time 0.",
    fields: &[
        required("truth_id", "Name of the target.", NAME),
        required("x_m", "Start, east.", PLACE),
        required("y_m", "Start, north.", PLACE),
        default("vx_mps", "Velocity, east.", VELOCITY, "0.0"),
        default("vy_mps", "Velocity, north.", VELOCITY, "0.0"),
    ],
};

static LISTED_TARGETS: Object = Object {
    name: "ListedTargets",
    summary: "Targets written out one by one.",
    fields: &[required("targets", "The targets.", Kind::List { item: &Kind::Object(&LISTED_TARGET), min: 1, max: MAX_TARGETS as usize })],
};

static CROSSING_PAIR: Object = Object {
    name: "CrossingPair",
    summary: "Two targets at centre ∓ half_width · sgn(u) · |u|^power with u = 1 − t / crossing_time: one starts below the centre, the other above.",
    fields: &[
        required("centre_deg", "Bearing at which they cross.", BEARING),
        required("half_width_deg", "Difference of each from the centre at time 0.", SIGMA_BEARING),
        required(
            "crossing_time_s",
            "Time at which they cross.",
            Kind::Number { min: Bound::Including(1e-3), max: Bound::Including(1e9), unit: "s" },
        ),
        default(
            "power",
            "1 for constant rates; above it, the nearer the crossing the slower.",
            Kind::Number { min: Bound::Including(0.5), max: Bound::Including(10.0), unit: "" },
            "1.0",
        ),
    ],
};

static BEARING_LINE: Object = Object {
    name: "BearingLine",
    summary: "A target whose bearing changes at a constant rate from time 0.",
    fields: &[
        required("truth_id", "Name of the target; the targets of crossings are called 1, 2, … in order.", NAME),
        required("bearing_deg", "Bearing at time 0.", BEARING),
        default(
            "rate_degps",
            "Its rate.",
            Kind::Number { min: Bound::Including(-360.0), max: Bound::Including(360.0), unit: "deg/s" },
            "0.0",
        ),
    ],
};

static BEARING_TARGETS: Object = Object {
    name: "BearingTargets",
    summary: "Targets of which only the direction is told, for sensors that report bearings alone.",
    fields: &[
        default("crossings", "Pairs that cross.", Kind::List { item: &Kind::Object(&CROSSING_PAIR), min: 0, max: 10_000 }, "[]"),
        default("lines", "Others, one by one.", Kind::List { item: &Kind::Object(&BEARING_LINE), min: 0, max: 10_000 }, "[]"),
    ],
};

static CONSTANT_VELOCITY: Object =
    Object { name: "ConstantVelocityMotion", summary: "Every target keeps the course of the formation.", fields: &[] };

static WEAVING: Object = Object {
    name: "WeavingMotion",
    summary: "The heading swings around the course as a sine of time; each target has a random phase of its own, and its speed is constant.",
    fields: &[
        default(
            "heading_amplitude_deg",
            "Largest angle between heading and course.",
            Kind::Number { min: Bound::Excluding(0.0), max: Bound::Including(180.0), unit: "deg" },
            "30.0",
        ),
        default(
            "period_s",
            "Time from one swing to the next.",
            Kind::Number { min: Bound::Excluding(0.0), max: Bound::Including(1e6), unit: "s" },
            "60.0",
        ),
    ],
};

static FORMATION_MOTION: Union = Union {
    name: "FormationMotion",
    summary: "How the targets of a formation move.",
    tag: "kind",
    variants: || vec![Variant { tag: "constant_velocity", object: &CONSTANT_VELOCITY }, Variant { tag: "weaving", object: &WEAVING }],
};

static FORMATION_TARGETS: Object = Object {
    name: "FormationTargets",
    summary: "Targets in rows and columns around (0, 0) that fly at one speed on one random course.",
    fields: &[
        required("rows", "Rows of the grid.", Kind::Integer { min: 1, max: 300, unit: "" }),
        required("columns", "Columns of the grid.", Kind::Integer { min: 1, max: 300, unit: "" }),
        required("spacing_m", "Distance between neighbours in the grid.", RANGE),
        default(
            "displacement",
            "Each target starts up to this share of the spacing away from its place in the grid, uniform on each axis.",
            Kind::Number { min: Bound::Including(0.0), max: Bound::Including(1.0), unit: "" },
            "0.1",
        ),
        required("speed_mps", "Speed of every target.", SPEED),
        default("motion", "How the targets move.", Kind::Union(&FORMATION_MOTION), r#"{"kind":"constant_velocity"}"#),
    ],
};

static TARGET_PLAN: Union = Union {
    name: "TargetPlan",
    summary: "How the targets of a scenario are chosen.",
    tag: "kind",
    variants: || {
        vec![
            Variant { tag: "random", object: &RANDOM_TARGETS },
            Variant { tag: "listed", object: &LISTED_TARGETS },
            Variant { tag: "formation", object: &FORMATION_TARGETS },
            Variant { tag: "bearings", object: &BEARING_TARGETS },
        ]
    },
};

static DUPLICATES: Object = Object {
    name: "DuplicatesCoverage",
    summary: "Some targets, drawn at random, are seen by all sensors; each of the others by one, drawn at random.",
    fields: &[required("count", "Number of targets that all sensors see.", Kind::Integer { min: 0, max: MAX_TARGETS, unit: "" })],
};

static COVERAGE: Union = Union {
    name: "Coverage",
    summary: "Which sensors see which targets, besides what their fields of view allow.",
    tag: "kind",
    variants: || vec![Variant { tag: "duplicates", object: &DUPLICATES }],
};

pub static SCENARIO: Object = Object {
    name: "Scenario",
    summary: "A scene to simulate: every sensor makes one scan each period, the first at time 0.",
    fields: &[
        required("scans", "Scans of each sensor.", Kind::Integer { min: 1, max: MAX_SCANS, unit: "scans" }),
        required(
            "scan_period_s",
            "Time from scan to scan.",
            Kind::Number { min: Bound::Excluding(0.0), max: Bound::Including(1e6), unit: "s" },
        ),
        required("sensors", "The sensors.", Kind::List { item: &Kind::Object(&SCENARIO_SENSOR), min: 1, max: 64 }),
        required("targets", "The targets.", Kind::Union(&TARGET_PLAN)),
        optional(
            "coverage",
            "Which sensors see which targets; every sensor sees all in its field of view when absent.",
            Kind::Union(&COVERAGE),
        ),
        optional(
            "record",
            "A bearing-time record of the sensor instead of its detections, as long as its scans; targets must be of the kind bearings. A detector finds the detections; what the sensor says of p_d, noise and clutter is what a tracker is told.",
            Kind::Object(&crate::simulation::RECORD),
        ),
    ],
};

const SENSOR_IDS: Field =
    optional("sensor_ids", "Only the scans of these sensors; all of them when absent.", Kind::List { item: &NAME, min: 1, max: 64 });

static SOURCE_DATASET: Object = Object {
    name: "DatasetSource",
    summary: "An uploaded dataset, or one that a job made.",
    fields: &[required("dataset_id", "Identity of the dataset.", NAME), SENSOR_IDS],
};

static SOURCE_JOB: Object = Object {
    name: "JobSource",
    summary: "The output of another job; a job that is not finished is waited for.",
    fields: &[required("job_id", "Identity of the job.", NAME), SENSOR_IDS],
};

static SOURCE_SCENARIO: Object = Object {
    name: "ScenarioSource",
    summary: "A scenario, simulated with the job's seed.",
    fields: &[required("scenario", "The scene.", Kind::Object(&SCENARIO))],
};

static SOURCE_PRESET: Object = Object {
    name: "PresetSource",
    summary: "The scenario of a preset, simulated with the job's seed.",
    fields: &[required("preset", "Name of the preset.", NAME)],
};

static INPUT: Union = Union {
    name: "InputSource",
    summary: "Where detections come from.",
    tag: "source",
    variants: || {
        let mut variants = data_sources();
        variants.push(Variant { tag: "scenario", object: &SOURCE_SCENARIO });
        variants.push(Variant { tag: "preset", object: &SOURCE_PRESET });
        variants
    },
};

static DATA: Union =
    Union { name: "DataSource", summary: "Where recorded or computed data come from.", tag: "source", variants: data_sources };

fn data_sources() -> Vec<Variant> {
    vec![Variant { tag: "dataset", object: &SOURCE_DATASET }, Variant { tag: "job", object: &SOURCE_JOB }]
}

pub static SENSOR_SETTINGS: Object = Object {
    name: "SensorSettings",
    summary: "What is known of a sensor of a recording; given values replace those that came with the data.",
    fields: &[
        required("sensor_id", "Name of the sensor in the recording.", NAME),
        optional("x_m", "Position, east.", PLACE),
        optional("y_m", "Position, north.", PLACE),
        optional("max_range_m", "Radius of the field of view.", RANGE),
        optional("p_d", "Probability that a target in view is detected in a scan.", PROBABILITY),
        optional(
            "clutter_per_m2",
            "Expected false detections per square metre and scan, also of a sensor that reports ranges and bearings.",
            Kind::Number { min: Bound::Excluding(0.0), max: Bound::Including(1e6), unit: "1/m²" },
        ),
        optional(
            "clutter_per_deg",
            "Expected false detections per degree and scan, of a sensor whose bearings alone are used.",
            Kind::Number { min: Bound::Excluding(0.0), max: Bound::Including(1e6), unit: "1/deg" },
        ),
        optional("sigma_x_m", "Standard deviation of x.", SIGMA),
        optional("sigma_y_m", "Standard deviation of y.", SIGMA),
        optional("sigma_range_m", "Standard deviation of ranges.", SIGMA),
        optional("sigma_bearing_deg", "Standard deviation of bearings.", SIGMA_BEARING),
        optional("sigma_range_rate_mps", "Standard deviation of range rates.", SIGMA_RATE),
    ],
};

static NOTHING: Object =
    Object { name: "DetectionIdSymbols", summary: "A symbol is the identity of a detection, as in the paper.", fields: &[] };

static NEAREST_DETECTION: Object = Object {
    name: "NearestDetectionSymbols",
    summary: "A symbol is the detection of the same scan that is nearest to the track: for trackers that do not say which they took.",
    fields: &[required("gate_m", "Largest distance between a track and its detection.", RANGE)],
};

static NEAREST_TRUTH: Object = Object {
    name: "NearestTruthSymbols",
    summary: "A symbol is the nearest true target: for recordings whose detections have no known origin.",
    fields: &[
        required("gate_m", "Largest distance between a track and its truth.", RANGE),
        default(
            "max_gap_s",
            "Truth is interpolated between points at most this far apart.",
            Kind::Number { min: Bound::Including(0.0), max: Bound::Including(1e6), unit: "s" },
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
            Variant { tag: "detection_id", object: &NOTHING },
            Variant { tag: "nearest_detection", object: &NEAREST_DETECTION },
            Variant { tag: "nearest_truth", object: &NEAREST_TRUTH },
        ]
    },
};

static MOST_PROBABLE: Object =
    Object { name: "MostProbableDecision", summary: "A track's symbol is its most probable candidate, ε included.", fields: &[] };

static ALL_GATED: Object = Object {
    name: "AllGatedDecision",
    summary: "Every candidate of enough weight is a symbol of the track, ε too, or where nothing else is.",
    fields: &[default(
        "min_weight",
        "Least weight of a candidate.",
        Kind::Number { min: Bound::Excluding(0.0), max: Bound::Including(1.0), unit: "" },
        "0.05",
    )],
};

static DECISION: Union = Union {
    name: "TfaDecision",
    summary: "How a track's weights become symbols.",
    tag: "policy",
    variants: || vec![Variant { tag: "most_probable", object: &MOST_PROBABLE }, Variant { tag: "all_gated", object: &ALL_GATED }],
};

pub static TFA: Object = Object {
    name: "TfaSettings",
    summary: "The temporal finite automaton that judges tracks.",
    fields: &[
        default("symbols", "What the automaton reads.", Kind::Union(&SYMBOLS), r#"{"kind":"detection_id"}"#),
        default("decision", "How weights become symbols.", Kind::Union(&DECISION), r#"{"policy":"most_probable"}"#),
        default(
            "max_missed",
            "Scans in a row without a symbol that end a string.",
            Kind::Integer { min: 1, max: 1000, unit: "scans" },
            "5",
        ),
        default(
            "tolerance",
            "Largest number of errors that are forgiven: the report tells how many targets are correct for each up to it.",
            Kind::Integer { min: 0, max: 1000, unit: "scans" },
            "5",
        ),
        default(
            "search",
            "How a string is run through the automaton; the verdicts are the same.",
            Kind::Choice(&["breadth_first", "depth_first"]),
            "\"breadth_first\"",
        ),
        default("minimise", "Whether to determinise and minimise the automaton; the verdicts are the same.", Kind::Flag, "false"),
    ],
};

const JOB_NAME: Field = optional("name", "A name for people.", NAME);
const LABELS: Field = optional("labels", "Labels to find the job by, name to text.", Kind::TextMap { max_entries: 32, max_length: 100 });
const DETECTOR: Field = optional(
    "detector",
    "Where the input is a bearing-time record: how detections are found in it; {} takes the defaults. Filled in where a scenario has one.",
    Kind::Object(&crate::detection::DETECTOR),
);
const SEED: Field =
    default("seed", "Seed of every random number of the job.", Kind::Integer { min: 0, max: u32::MAX as i64, unit: "" }, "1");
static ONE_SENSOR: Kind = Kind::Object(&SENSOR_SETTINGS);
const SENSORS: Field =
    optional("sensors", "Settings of the recording's sensors, by name.", Kind::List { item: &ONE_SENSOR, min: 1, max: 64 });

pub static SIMULATE: Object = Object {
    name: "SimulateRequest",
    summary: "Simulate a scenario: detections with known origins, and the truth.",
    fields: &[JOB_NAME, LABELS, SEED, required("scenario", "The scene.", Kind::Object(&SCENARIO))],
};

pub static ASSOCIATE: Object = Object {
    name: "AssociateRequest",
    summary: "Track the targets of a recording or a scenario.",
    fields: &[
        JOB_NAME,
        LABELS,
        SEED,
        required("input", "The detections, or with detector a bearing-time record.", Kind::Union(&INPUT)),
        DETECTOR,
        optional("truth", "Truth at which tracks begin (initiation truth), where the input does not know it.", Kind::Union(&DATA)),
        SENSORS,
        default("associator", "How detections are given to tracks.", Kind::Union(&ASSOCIATOR), DEFAULT_ASSOCIATOR),
        default("filter", "How tracks are predicted and updated.", Kind::Union(&FILTER), DEFAULT_FILTER),
        default("tracker", "Gate and life cycle.", Kind::Object(&LIFECYCLE), "{}"),
    ],
};

pub static GROUP: Object = Object {
    name: "GroupRequest",
    summary: "Put together what several sensors report of one target at one instant.",
    fields: &[
        JOB_NAME,
        LABELS,
        SEED,
        required("input", "The detections: positions of two sensors or more at common times.", Kind::Union(&INPUT)),
        SENSORS,
        required("grouper", "How reports are put together.", Kind::Union(&GROUPER)),
        default("predictions", "The tracks behind groupers that use predictions.", Kind::Object(&super::group::PREDICTIONS), "{}"),
    ],
};

pub const DEFAULT_ASSOCIATOR: &str = r#"{"method":"nearest_neighbour"}"#;
pub const DEFAULT_FILTER: &str = r#"{"method":"kalman"}"#;

const MAX_GAP: Field = default(
    "max_gap_s",
    "Largest gap in the truth that is bridged.",
    Kind::Number { min: Bound::Including(0.0), max: Bound::Including(1e6), unit: "s" },
    "5.0",
);

static INTERPOLATE: Object =
    Object { name: "InterpolateAlignment", summary: "Truth on the line between its two neighbouring points.", fields: &[MAX_GAP] };

static NEAREST_TIME: Object = Object { name: "NearestAlignment", summary: "The truth's nearest point in time.", fields: &[MAX_GAP] };

static ALIGNMENT: Union = Union {
    name: "Alignment",
    summary: "How truth is brought to the times at which it is compared with tracks.",
    tag: "method",
    variants: || vec![Variant { tag: "interpolate", object: &INTERPOLATE }, Variant { tag: "nearest", object: &NEAREST_TIME }],
};

pub static COMPARISON: Object = Object {
    name: "ComparisonSettings",
    summary: "How truth and tracks are put side by side for all metrics.",
    fields: &[
        default("gate_m", "Largest distance of a match of points; a distance of exactly that is a match.", RANGE, "100.0"),
        default(
            "gate_deg",
            "The same of directions.",
            Kind::Number { min: Bound::Excluding(0.0), max: Bound::Including(90.0), unit: "deg" },
            "5.0",
        ),
        default(
            "min_iou",
            "Smallest intersection over union of a match of boxes.",
            Kind::Number { min: Bound::Excluding(0.0), max: Bound::Including(1.0), unit: "" },
            "0.5",
        ),
        default("alignment", "How clocks are brought together.", Kind::Union(&ALIGNMENT), r#"{"method":"interpolate"}"#),
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
        optional("associator", "With `input`: how detections are given to tracks (default nearest_neighbour).", Kind::Union(&ASSOCIATOR)),
        optional("filter", "With `input`: how tracks are predicted and updated (default kalman).", Kind::Union(&FILTER)),
        optional("tracker", "With `input`: gate and life cycle.", Kind::Object(&LIFECYCLE)),
        optional("tracks", "Tracks to judge; instead of `input`.", Kind::Union(&DATA)),
        optional("truth", "The truth; found by itself when the input or the tracks come from a job that knows it.", Kind::Union(&DATA)),
        optional(
            "detections",
            "With `tracks`: the detections they were made of; found by itself when `tracks` is a job.",
            Kind::Union(&DATA),
        ),
        optional(
            "sequences",
            "Several pairs of truth and tracks, judged by `metrics` together; instead of `input` and `tracks`.",
            Kind::List { item: &Kind::Object(&SEQUENCE), min: 1, max: 1000 },
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
            Kind::List { item: &Kind::Union(&METRIC), min: 0, max: 32 },
        ),
        default("comparison", "How truth and tracks are put side by side for the metrics.", Kind::Object(&COMPARISON), "{}"),
        optional(
            "tfa",
            "Settings of the temporal automaton. When absent, the profiles tracking and tfa read detection ids where detections with known origins are there, else the nearest target within the gate of `comparison`.",
            Kind::Object(&TFA),
        ),
    ],
};
