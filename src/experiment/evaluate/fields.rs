//! The body of a job that judges tracks, described field by field.

use super::requirements::FIELD as REQUIREMENTS;
use super::within::FIELD as WITHIN;
use crate::association::ASSOCIATOR;
use crate::evaluation::metrics::{METRES, METRIC};
use crate::experiment::limits::LIMITS;
use crate::experiment::request::fields::{
    DATA, DETECTOR, INPUT, JOB_NAME, LABELS, NAME, RANGE, SEED, SENSORS,
};
use crate::filtering::FILTER;
use crate::registry::{
    Field, Kind, Object, Union, above, default, list, number, optional, required, variant, whole,
};
use crate::tracking::LIFECYCLE;

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
        optional(
            "max_gap_s",
            "Truth is interpolated between points at most this far apart. Default: 2.5 times the median time between two points of the target.",
            number(0.0, 1e6, "s"),
        ),
    ],
};

static SYMBOLS: Union = Union {
    name: "TfaSymbols",
    summary: "What the automaton reads at each scan.",
    tag: "kind",
    variants: || {
        vec![
            variant("detection_id", &NOTHING),
            variant("nearest_detection", &NEAREST_DETECTION),
            variant("nearest_truth", &NEAREST_TRUTH),
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
        above(0.0, 1.0, ""),
        "0.05",
    )],
};

static DECISION: Union = Union {
    name: "TfaDecision",
    summary: "How a track's weights become symbols.",
    tag: "policy",
    variants: || {
        vec![
            variant("most_probable", &MOST_PROBABLE),
            variant("all_gated", &ALL_GATED),
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
            whole(1, 1000, "scans"),
            "5",
        ),
        default(
            "tolerance",
            "Largest number of errors that are forgiven: the report tells how many targets are correct for each up to it.",
            whole(0, 1000, "scans"),
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

const MAX_GAP: Field = optional(
    "max_gap_s",
    "Largest gap in the truth that is bridged. Default: 2.5 times the median time between two points of the target.",
    number(0.0, 1e6, "s"),
);

const TIME_TOLERANCE: Field = optional(
    "time_tolerance_s",
    "Times of truth that differ by no more are one step. Default: a twentieth of the shortest time between two points of one target, at most 0.01 s.",
    number(0.0, 1e6, "s"),
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
            variant("interpolate", &INTERPOLATE),
            variant("nearest", &NEAREST_TIME),
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
            above(0.0, 90.0, "deg"),
            "5.0",
        ),
        default(
            "min_iou",
            "Smallest intersection over union of a match of boxes.",
            above(0.0, 1.0, ""),
            "0.5",
        ),
        default(
            "alignment",
            "How clocks are brought together.",
            Kind::Union(&ALIGNMENT),
            r#"{"method":"interpolate"}"#,
        ),
        default(
            "steps",
            "Whose times count. auto: the scans of the recording, holes of regular sensors filled; without one the times of the truth, or a grid where targets have clocks of their own. as_recorded: the same without filling. truth: the times of the truth. every_s: a grid. tracks, union: the times of the tracks, alone or with those of the truth; these two flatter.",
            Kind::Choice(&["auto", "as_recorded", "truth", "every_s", "tracks", "union"]),
            "\"auto\"",
        ),
        optional(
            "credit",
            "Which points of a track count. at_the_time (default): what was known then, without tentative points and without the past of a beginning that was chosen later. afterwards: all points of a track that was confirmed at last; the default of an automaton on detections, which judges what the tracker decided, not what an operator saw.",
            Kind::Choice(&["at_the_time", "afterwards"]),
        ),
        WITHIN,
        optional(
            "every_s",
            "With steps every_s: the time between two steps.",
            above(0.0, 1e6, "s"),
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
        LIMITS,
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
            list(&Kind::Object(&SEQUENCE), 1, 1000),
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
            list(&Kind::Union(&METRIC), 0, 32),
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
        REQUIREMENTS,
    ],
};
