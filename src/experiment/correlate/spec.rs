//! The body of a job that correlates tracks, described field by field, and its type.

use crate::association::ASSOCIATOR;
use crate::correlation::alignment::Assumed;
use crate::correlation::fusion::{BuildFusion, FUSION};
use crate::correlation::statistic::{STATISTIC, Statistic};
use crate::correlation::{BuildCorrelator, CORRELATOR};
use crate::experiment::limits::LIMITS;
use crate::experiment::request::fields::{
    DATA, JOB_NAME, LABELS, NAME, RANGE, SEED, SENSORS, SIGMA, input_sources,
};
use crate::experiment::request::methods::{Choice, OptionalTracking};
use crate::experiment::request::sources::InputSpec;
use crate::filtering::FILTER;
use crate::model::sensor::SensorSettings;
use crate::registry::{
    Bound, Kind, Object, Union, above, default, list, number, optional, required, variant, whole,
};
use crate::simulation::LOCAL_TRACKS;
use crate::tracking::LIFECYCLE;
use serde::Deserialize;
use serde::de::IgnoredAny;

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
        variants.push(variant("local_tracks", &LOCAL));
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
            above(0.0, 1e6, "s"),
        ),
        default(
            "process_noise_m2ps3",
            "Spectral density of the white-noise acceleration of the prediction.",
            number(0.0, 1e9, "m²/s³"),
            "1.0",
        ),
        default(
            "max_gap_s",
            "Longest prediction; a track with no point within it before a common time says nothing there.",
            number(0.0, 1e6, "s"),
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
            above(0.0, 1e5, "m/s"),
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
            whole(1, 1000, "times"),
            "1",
        ),
        default(
            "of",
            "Successive common times at which the tracks are put together.",
            whole(1, 1000, "times"),
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
        number(0.0, 1e9, "m²/s³"),
    )],
};

static CROSS_COVARIANCE: Union = Union {
    name: "CrossCovariance",
    summary: "How the errors of tracks of one target depend on each other.",
    tag: "kind",
    variants: || {
        vec![
            variant("none", &NONE),
            variant("coefficient", &COEFFICIENT),
            variant("recursion", &RECURSION),
        ]
    },
};

pub static CORRELATE: Object = Object {
    name: "CorrelateRequest",
    summary: "Put together the tracks of several sensors that are of one target, and fuse them.",
    fields: &[
        JOB_NAME,
        LABELS,
        LIMITS,
        SEED,
        optional(
            "sets",
            "Tracks of two sensors or more, one set each; instead of `input`.",
            list(&Kind::Union(&DATA), 1, 64),
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

/// A request that puts tracks together.
#[derive(Clone, Deserialize)]
pub struct Spec {
    #[serde(default)]
    sets: Vec<IgnoredAny>,
    #[serde(default)]
    pub input: InputSpec,
    #[serde(default)]
    pub sensors: Vec<SensorSettings>,
    #[serde(flatten)]
    pub tracking: OptionalTracking,
    pub truth_gate_m: f64,
    pub alignment: AlignmentSettings,
    pub statistic: Statistic,
    pub cross_covariance: CrossSpec,
    pub correlator: Choice<BuildCorrelator>,
    pub confirm: Confirm,
    pub fusion: Choice<BuildFusion>,
    pub keep_unassociated: bool,
}

impl Spec {
    /// Where the tracks come from, for faults.
    pub fn place(&self) -> &'static str {
        if self.has_sets() { "/sets" } else { "/input" }
    }

    pub fn has_sets(&self) -> bool {
        !self.sets.is_empty()
    }
}

/// How often a tuple must be found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub struct Confirm {
    pub found: u32,
    pub of: u32,
}

/// How tracks are brought to common times.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct AlignmentSettings {
    pub reference: Option<String>,
    pub period_s: Option<f64>,
    pub process_noise_m2ps3: f64,
    pub max_gap_s: f64,
    pub sigma_m: Option<f64>,
    pub sigma_mps: Option<f64>,
}

/// How the errors of tracks of one target depend on each other.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum CrossSpec {
    None,
    Coefficient { coefficient: f64 },
    Recursion { process_noise_m2ps3: f64 },
}

impl AlignmentSettings {
    pub fn assumed(&self) -> Option<Assumed> {
        self.sigma_m.map(|sigma_m| Assumed {
            sigma_m,
            sigma_mps: self.sigma_mps,
        })
    }
}
