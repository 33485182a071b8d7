//! The body of a job that correlates tracks, described field by field.

use crate::association::ASSOCIATOR;
use crate::correlation::CORRELATOR;
use crate::correlation::fusion::FUSION;
use crate::correlation::statistic::STATISTIC;
use crate::experiment::request::fields::{
    DATA, JOB_NAME, LABELS, NAME, RANGE, SEED, SENSORS, SIGMA, input_sources,
};
use crate::filtering::FILTER;
use crate::registry::{Bound, Kind, Object, Union, Variant, default, optional, required};
use crate::simulation::LOCAL_TRACKS;
use crate::tracking::LIFECYCLE;

static LOCAL: Object = Object {
    name: "LocalTracksSource",
    summary: "Tracks of several sensors, drawn with the job's seed without detections and trackers; exact in what is true.",
    fields: &[default(
        "tracks",
        "How they are drawn.",
        Kind::Object(&LOCAL_TRACKS),
        "{}",
    )],
};

static INPUT: Union = Union {
    name: "CorrelateSource",
    summary: "Detections of two sensors or more, each tracked by itself, or drawn tracks.",
    tag: "source",
    variants: || {
        let mut variants = input_sources();
        variants.push(Variant {
            tag: "local_tracks",
            object: &LOCAL,
        });
        variants
    },
};

static ALIGNMENT: Object = Object {
    name: "TrackAlignment",
    summary: "How tracks are brought to common times: each is predicted with nearly constant velocity from its last point before.",
    fields: &[
        optional(
            "reference",
            "The sensor whose times are the common times; the first when absent.",
            NAME,
        ),
        optional(
            "period_s",
            "Common times so far apart instead, from the first time of all tracks on.",
            Kind::Number {
                min: Bound::Excluding(0.0),
                max: Bound::Including(1e6),
                unit: "s",
            },
        ),
        default(
            "process_noise_m2ps3",
            "Spectral density of the white-noise acceleration of the prediction.",
            Kind::Number {
                min: Bound::Including(0.0),
                max: Bound::Including(1e9),
                unit: "m²/s³",
            },
            "1.0",
        ),
        default(
            "max_gap_s",
            "Longest prediction; a track with no point within it before a common time says nothing there.",
            Kind::Number {
                min: Bound::Including(0.0),
                max: Bound::Including(1e6),
                unit: "s",
            },
            "2.0",
        ),
        optional(
            "sigma_m",
            "Standard deviation of x and of y, assumed where tracks carry no covariance.",
            SIGMA,
        ),
        optional(
            "sigma_mps",
            "The same of velocities; where it is absent velocities without covariance are not used.",
            Kind::Number {
                min: Bound::Excluding(0.0),
                max: Bound::Including(1e5),
                unit: "m/s",
            },
        ),
    ],
};

static CONFIRM: Object = Object {
    name: "TupleConfirmation",
    summary: "The tracks are put together anew at each of the last common times; a tuple stands when it was found often enough.",
    fields: &[
        default(
            "found",
            "Times that a tuple must have been found, absences included.",
            Kind::Integer {
                min: 1,
                max: 1000,
                unit: "times",
            },
            "1",
        ),
        default(
            "of",
            "Successive common times at which the tracks are put together.",
            Kind::Integer {
                min: 1,
                max: 1000,
                unit: "times",
            },
            "1",
        ),
    ],
};

static NONE: Object = Object {
    name: "NoCrossCovariance",
    summary: "The errors of the tracks are taken to be independent.",
    fields: &[],
};

static COEFFICIENT: Object = Object {
    name: "CoefficientCrossCovariance",
    summary: "P_ij = ρ √P_i √P_j for all pairs and times: an assumption.",
    fields: &[required(
        "coefficient",
        "ρ.",
        Kind::Number {
            min: Bound::Including(0.0),
            max: Bound::Excluding(1.0),
            unit: "",
        },
    )],
};

static RECURSION: Object = Object {
    name: "RecursionCrossCovariance",
    summary: "Bar-Shalom's recursion, with gains told from the covariances: exact for tracks of a Kalman filter of this process noise.",
    fields: &[required(
        "process_noise_m2ps3",
        "Process noise of the filters that made the tracks.",
        Kind::Number {
            min: Bound::Including(0.0),
            max: Bound::Including(1e9),
            unit: "m²/s³",
        },
    )],
};

static CROSS_COVARIANCE: Union = Union {
    name: "CrossCovariance",
    summary: "How the errors of tracks of one target depend on each other.",
    tag: "kind",
    variants: || {
        vec![
            Variant {
                tag: "none",
                object: &NONE,
            },
            Variant {
                tag: "coefficient",
                object: &COEFFICIENT,
            },
            Variant {
                tag: "recursion",
                object: &RECURSION,
            },
        ]
    },
};

pub static CORRELATE: Object = Object {
    name: "CorrelateRequest",
    summary: "Put together the tracks of several sensors that are of one target, and fuse them.",
    fields: &[
        JOB_NAME,
        LABELS,
        SEED,
        optional(
            "sets",
            "Tracks of two sensors or more, one set each; instead of `input`.",
            Kind::List {
                item: &Kind::Union(&DATA),
                min: 1,
                max: 64,
            },
        ),
        optional(
            "input",
            "Detections that are tracked first, sensor by sensor, or drawn tracks; instead of `sets`.",
            Kind::Union(&INPUT),
        ),
        SENSORS,
        optional(
            "associator",
            "Where `input` are detections: how they are given to tracks (default nearest_neighbour).",
            Kind::Union(&ASSOCIATOR),
        ),
        optional(
            "filter",
            "Where `input` are detections: how tracks are predicted and updated (default auto).",
            Kind::Union(&FILTER),
        ),
        optional(
            "tracker",
            "Where `input` are detections: gate and life cycle.",
            Kind::Object(&LIFECYCLE),
        ),
        optional(
            "truth",
            "The truth, to judge the tuples by; found by itself where the input knows it.",
            Kind::Union(&DATA),
        ),
        default(
            "truth_gate_m",
            "A track whose detections have no origin is of the target that is nearest to most of its points, within this distance.",
            RANGE,
            "100.0",
        ),
        default(
            "alignment",
            "How tracks are brought to common times.",
            Kind::Object(&ALIGNMENT),
            "{}",
        ),
        default(
            "statistic",
            "What a tuple costs.",
            Kind::Union(&STATISTIC),
            r#"{"kind":"chain"}"#,
        ),
        default(
            "cross_covariance",
            "How errors depend on each other.",
            Kind::Union(&CROSS_COVARIANCE),
            r#"{"kind":"none"}"#,
        ),
        required(
            "correlator",
            "How the cheapest tuples are looked for.",
            Kind::Union(&CORRELATOR),
        ),
        default(
            "confirm",
            "How often a tuple must be found.",
            Kind::Object(&CONFIRM),
            "{}",
        ),
        default(
            "fusion",
            "How the tracks of a tuple become one.",
            Kind::Union(&FUSION),
            r#"{"method":"weighted"}"#,
        ),
        default(
            "keep_unassociated",
            "Whether tracks that are alone become system tracks, too.",
            Kind::Flag,
            "true",
        ),
    ],
};
