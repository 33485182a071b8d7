//! The targets of scenarios, described field by field.

use super::fields::{
    BEARING, MAX_TARGETS, NAME, PLACE, RANGE, SIGMA, SIGMA_BEARING, SPEED, VELOCITY,
};
use crate::registry::{
    Field, Kind, Object, Union, above, default, list, number, optional, required, variant, whole,
};

static RANDOM_TARGETS: Object = Object {
    name: "RandomTargets",
    summary: "Targets with uniform start in a square around (0, 0), uniform heading and uniform speed, all constant.",
    fields: &[
        required("count", "Number of targets.", whole(1, MAX_TARGETS, "")),
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
        optional(
            "z_m",
            "Start, up. One target with z_m or vz_mps puts the scene in space; those that are absent are 0 there.",
            PLACE,
        ),
        optional("vz_mps", "Velocity, up.", VELOCITY),
    ],
};

static LISTED_TARGETS: Object = Object {
    name: "ListedTargets",
    summary: "Targets written out one by one.",
    fields: &[required(
        "targets",
        "The targets.",
        Kind::List {
            item: &Kind::Object(&LISTED_TARGET),
            min: 1,
            max: MAX_TARGETS as usize,
        },
    )],
};

static STRAIGHT: Object = Object {
    name: "StraightSegment",
    summary: "Straight on at constant speed.",
    fields: &[DURATION],
};

static TURN: Object = Object {
    name: "TurnSegment",
    summary: "A circle at constant speed.",
    fields: &[
        DURATION,
        required(
            "rate_degps",
            "Rate of the turn, positive to the left (counter-clockwise).",
            number(-360.0, 360.0, "deg/s"),
        ),
    ],
};

static ACCELERATE: Object = Object {
    name: "AccelerateSegment",
    summary: "A constant acceleration along the heading.",
    fields: &[
        DURATION,
        required(
            "acceleration_mps2",
            "Acceleration; negative to slow down, and below 0 m/s to go back.",
            number(-1e4, 1e4, "m/s²"),
        ),
    ],
};

static CLIMB: Object = Object {
    name: "ClimbSegment",
    summary: "Straight over the ground with a constant rate of climb; level after it.",
    fields: &[
        DURATION,
        required("rate_mps", "Rate of climb; negative to descend.", VELOCITY),
    ],
};

const DURATION: Field = required("duration_s", "How long it lasts.", above(0.0, 1e9, "s"));

static SEGMENT: Union = Union {
    name: "Segment",
    summary: "A leg of a target's course.",
    tag: "move",
    variants: || {
        vec![
            variant("straight", &STRAIGHT),
            variant("turn", &TURN),
            variant("accelerate", &ACCELERATE),
            variant("climb", &CLIMB),
        ]
    },
};

static MANEUVERING_TARGET: Object = Object {
    name: "ManeuveringTarget",
    summary: "A target that turns, accelerates and climbs; after its last segment it goes on straight and level.",
    fields: &[
        required("truth_id", "Name of the target.", NAME),
        required("x_m", "Start, east.", PLACE),
        required("y_m", "Start, north.", PLACE),
        default("vx_mps", "Velocity at the start, east.", VELOCITY, "0.0"),
        default("vy_mps", "Velocity at the start, north.", VELOCITY, "0.0"),
        optional(
            "z_m",
            "Place at the start, up. A height or a climb of one target puts the scene in space; targets without are at 0 there.",
            PLACE,
        ),
        default(
            "start_s",
            "Time at which it appears and its first segment begins.",
            number(0.0, 1e9, "s"),
            "0.0",
        ),
        optional(
            "end_s",
            "Time at which it is seen last; it stays when absent.",
            above(0.0, 1e9, "s"),
        ),
        SEGMENTS,
    ],
};

pub(super) const SEGMENTS: Field = default(
    "segments",
    "Its course, leg by leg.",
    list(&SEGMENT_KIND, 0, 1000),
    "[]",
);
static SEGMENT_KIND: Kind = Kind::Union(&SEGMENT);

static MANEUVERING_TARGETS: Object = Object {
    name: "ManeuveringTargets",
    summary: "Targets that turn, accelerate and climb, each on a course of its own.",
    fields: &[required(
        "targets",
        "The targets.",
        list(&Kind::Object(&MANEUVERING_TARGET), 1, 10_000),
    )],
};

static CROSSING_PAIR: Object = Object {
    name: "CrossingPair",
    summary: "Two targets at centre ∓ half_width · sgn(u) · |u|^power with u = 1 − t / crossing_time: one starts below the centre, the other above.",
    fields: &[
        required("centre_deg", "Bearing at which they cross.", BEARING),
        required(
            "half_width_deg",
            "Difference of each from the centre at time 0.",
            SIGMA_BEARING,
        ),
        required(
            "crossing_time_s",
            "Time at which they cross.",
            number(1e-3, 1e9, "s"),
        ),
        default(
            "power",
            "1 for constant rates; above it, the nearer the crossing the slower.",
            number(0.5, 10.0, ""),
            "1.0",
        ),
    ],
};

static BEARING_LINE: Object = Object {
    name: "BearingLine",
    summary: "A target whose bearing changes at a constant rate from time 0.",
    fields: &[
        required(
            "truth_id",
            "Name of the target; the targets of crossings are called 1, 2, … in order.",
            NAME,
        ),
        required("bearing_deg", "Bearing at time 0.", BEARING),
        default(
            "rate_degps",
            "Its rate.",
            number(-360.0, 360.0, "deg/s"),
            "0.0",
        ),
    ],
};

static BEARING_TARGETS: Object = Object {
    name: "BearingTargets",
    summary: "Targets of which only the direction is told, for sensors that report bearings alone.",
    fields: &[
        default(
            "crossings",
            "Pairs that cross.",
            list(&Kind::Object(&CROSSING_PAIR), 0, 10_000),
            "[]",
        ),
        default(
            "lines",
            "Others, one by one.",
            list(&Kind::Object(&BEARING_LINE), 0, 10_000),
            "[]",
        ),
    ],
};

static CONSTANT_VELOCITY: Object = Object {
    name: "ConstantVelocityMotion",
    summary: "Every target keeps the course of the formation.",
    fields: &[],
};

static WEAVING: Object = Object {
    name: "WeavingMotion",
    summary: "The heading swings around the course as a sine of time; each target has a random phase of its own, and its speed is constant.",
    fields: &[
        default(
            "heading_amplitude_deg",
            "Largest angle between heading and course.",
            above(0.0, 180.0, "deg"),
            "30.0",
        ),
        default(
            "period_s",
            "Time from one swing to the next.",
            above(0.0, 1e6, "s"),
            "60.0",
        ),
    ],
};

static FORMATION_MOTION: Union = Union {
    name: "FormationMotion",
    summary: "How the targets of a formation move.",
    tag: "kind",
    variants: || {
        vec![
            variant("constant_velocity", &CONSTANT_VELOCITY),
            variant("weaving", &WEAVING),
        ]
    },
};

static FORMATION_TARGETS: Object = Object {
    name: "FormationTargets",
    summary: "Targets in rows and columns around (0, 0) that fly at one speed on one random course.",
    fields: &[
        required("rows", "Rows of the grid.", whole(1, 300, "")),
        required("columns", "Columns of the grid.", whole(1, 300, "")),
        required(
            "spacing_m",
            "Distance between neighbours in the grid.",
            RANGE,
        ),
        default(
            "displacement",
            "Each target starts up to this share of the spacing away from its place in the grid, uniform on each axis.",
            number(0.0, 1.0, ""),
            "0.1",
        ),
        required("speed_mps", "Speed of every target.", SPEED),
        default(
            "motion",
            "How the targets move.",
            Kind::Union(&FORMATION_MOTION),
            r#"{"kind":"constant_velocity"}"#,
        ),
    ],
};

static RECORDED_TARGETS: Object = Object {
    name: "RecordedTargets",
    summary: "The targets of the truth that the job names in `truth`, on splines through their points; the truth is then what the sensors could see of them.",
    fields: &[
        optional(
            "recording",
            "A recording that comes with the program, in place of the job's truth: `solent`, twenty minutes of AIS.",
            Kind::Choice(crate::model::scenario::RECORDINGS),
        ),
        optional(
            "start_s",
            "Time of the first scan; the first time of the truth when absent.",
            number(-1e12, 1e12, "s"),
        ),
        default(
            "max_gap_s",
            "A target is nowhere between points farther apart in time.",
            above(0.0, 1e9, "s"),
            "60.0",
        ),
    ],
};

static MEETING_TARGETS: Object = Object {
    name: "MeetingTargets",
    summary: "Targets of nearly constant velocity that are close to each other at one time (Williams 2015), each with a random course before and after.",
    fields: &[
        required("count", "Number of targets.", whole(1, 1000, "")),
        default(
            "leaving",
            "So many of them are gone from the scan of the meeting on.",
            whole(0, 1000, ""),
            "0",
        ),
        required(
            "meeting_s",
            "Time of the meeting: the first scan then or later; the last scan where all are earlier.",
            number(0.0, 1e9, "s"),
        ),
        default("x_m", "Place of the meeting, east.", PLACE, "0.0"),
        default("y_m", "Place of the meeting, north.", PLACE, "0.0"),
        required(
            "sigma_m",
            "Standard deviation of each coordinate about the place.",
            SIGMA,
        ),
        required(
            "speed_sigma_mps",
            "Standard deviation of each component of the velocity then, about 0.",
            above(0.0, 1e5, "m/s"),
        ),
        default(
            "process_noise_m2ps3",
            "Noise of the velocity (white acceleration).",
            number(0.0, 1e9, "m²/s³"),
            "0.0",
        ),
    ],
};

pub(super) static TARGET_PLAN: Union = Union {
    name: "TargetPlan",
    summary: "How the targets of a scenario are chosen.",
    tag: "kind",
    variants: || {
        vec![
            variant("random", &RANDOM_TARGETS),
            variant("listed", &LISTED_TARGETS),
            variant("maneuvering", &MANEUVERING_TARGETS),
            variant("formation", &FORMATION_TARGETS),
            variant("meeting", &MEETING_TARGETS),
            variant("bearings", &BEARING_TARGETS),
            variant("recorded", &RECORDED_TARGETS),
        ]
    },
};
