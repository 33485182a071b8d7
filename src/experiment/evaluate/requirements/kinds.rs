//! Each kind of requirement, described field by field.

use crate::experiment::evaluate::within::PLACE_M;
use crate::registry::{
    Field, Kind, Object, Union, above, default, joined, list, number, optional, required, variant,
    whole,
};

const THRESHOLD: Kind = number(-1e15, 1e15, "");
const TEXT: Kind = Kind::Text { max_length: 200 };
static SECTOR_NAME: Kind = TEXT;

/// What every requirement may say.
const COMMON: [Field; 9] = [
    optional(
        "name",
        "What it is called in the report; its kind when absent.",
        TEXT,
    ),
    optional(
        "sectors",
        "Identifiers of the sectors that it holds in; all when absent.",
        list(&SECTOR_NAME, 1, 100),
    ),
    optional(
        "phase",
        "Only while the truth does so. turning: more than 1 deg/s. climbing: more than 300 ft/min, up or down. steady: neither.",
        Kind::Choice(&["steady", "turning", "climbing"]),
    ),
    optional("at_least", "The smallest value that passes.", THRESHOLD),
    optional("at_most", "The largest value that passes.", THRESHOLD),
    optional("above", "Larger values pass.", THRESHOLD),
    optional("below", "Smaller values pass.", THRESHOLD),
    default(
        "each_target",
        "Whether it fails where one target fails it by itself.",
        Kind::Flag,
        "false",
    ),
    optional(
        "reference_accuracy_m",
        "Updates are not judged where the truth states a worse 'position_accuracy_m' (1 σ).",
        above(0.0, 1e6, "m"),
    ),
];

const fn with<const N: usize>(own: &[Field]) -> [Field; N] {
    assert!(N == own.len() + COMMON.len());
    joined(&[own, &COMMON])
}

const SECONDS: Kind = number(0.0, 1e6, "s");
const METRES: Kind = number(0.0, 1e8, "m");

const UPDATE_INTERVAL: Field = required(
    "update_interval_s",
    "Within this time an update is expected.",
    above(0.0, 1e6, "s"),
);
const TOLERANCE: Field = default(
    "tolerance_s",
    "What is taken off a gap before it is counted.",
    SECONDS,
    "0.0",
);
const MAX_GAP: Field = optional("max_gap_s", "Longer gaps do not count.", SECONDS);
const COUNT: Field = default(
    "count",
    "gaps: as many misses as whole intervals in a gap. slots: each interval without an update.",
    Kind::Choice(&["gaps", "slots"]),
    "\"gaps\"",
);
static IDENTITY: Kind = Kind::Choice(&["address", "callsign", "mode_a"]);
const OF: Field = default(
    "of",
    "Which codes are asked for.",
    list(&IDENTITY, 1, 3),
    r#"["address","callsign","mode_a"]"#,
);
const RULE: Field = default(
    "rule",
    "Whether any or all of the codes must be so.",
    Kind::Choice(&["any", "all"]),
    "\"any\"",
);
const DIFFERENCE_FT: Field = default(
    "max_difference_ft",
    "Largest difference to the height before or after that is right.",
    number(0.0, 1e6, "ft"),
    "300.0",
);
const MIN_UPDATES: &str = "Fewer are not counted.";
const MIN_DURATION: &str = "Shorter ones are not counted.";
const ENDS_AFTER: Field = default(
    "ends_after_s",
    "A track number ends after this time without an update.",
    SECONDS,
    "300.0",
);

static DETECTION: Object = Object {
    name: "DetectionRequirement",
    summary: "1 − misses / expected updates of the periods in which targets are due (probability of update, of detection).",
    fields: &with::<14>(&[
        UPDATE_INTERVAL,
        TOLERANCE,
        optional("min_gap_s", "Shorter gaps do not count.", SECONDS),
        MAX_GAP,
        COUNT,
    ]),
};

static LONG_GAPS: Object = Object {
    name: "LongGapsRequirement",
    summary: "Misses of long gaps / expected updates.",
    fields: &with::<13>(&[
        UPDATE_INTERVAL,
        TOLERANCE,
        required("min_gap_s", "Shorter gaps do not count.", SECONDS),
        MAX_GAP,
    ]),
};

static POSITION_WITHIN: Object = Object {
    name: "PositionWithinRequirement",
    summary: "Share of updates at most so far from the truth, along the ground.",
    fields: &with::<10>(&[required(
        "distance_m",
        "Largest distance that is right.",
        METRES,
    )]),
};

static POSITION_BEYOND: Object = Object {
    name: "PositionBeyondRequirement",
    summary: "Share of updates at least so far from the truth: false positions.",
    fields: &with::<11>(&[
        required("distance_m", "Smallest distance that is false.", METRES),
        default(
            "inclusive",
            "Whether exactly this distance is false.",
            Kind::Flag,
            "true",
        ),
    ]),
};

static POSITION_RMS: Object = Object {
    name: "PositionRmsRequirement",
    summary: "Root mean square of the distances from the truth (m).",
    fields: &with::<9>(&[]),
};

static POSITION_PERCENTILE: Object = Object {
    name: "PositionPercentileRequirement",
    summary: "A percentile of the distances from the truth (m).",
    fields: &with::<11>(&[
        required("percent", "Of the updates.", above(0.0, 100.0, "%")),
        default(
            "rank",
            "nearest: the value of the nearest rank. linear: between the two beside.",
            Kind::Choice(&["nearest", "linear"]),
            "\"nearest\"",
        ),
    ]),
};

static ALONG: Object = Object {
    name: "AlongRequirement",
    summary: "Share of updates whose error along the heading of the truth is small; ahead is positive.",
    fields: &with::<10>(&[required("max_m", "Largest error that is right.", METRES)]),
};

static ACROSS: Object = Object {
    name: "AcrossRequirement",
    summary: "Share of updates whose error across the heading of the truth is small; right is positive.",
    fields: &with::<10>(&[required("max_m", "Largest error that is right.", METRES)]),
};

static LATENCY: Object = Object {
    name: "LatencyRequirement",
    summary: "Share of updates whose error along, as time at the true speed, is small; late is positive.",
    fields: &with::<10>(&[required("max_s", "Largest latency that is right.", SECONDS)]),
};

const RADAR: [Field; 3] = [
    optional(
        "sensor_id",
        "The radar, of the job's detections; only its updates are judged, where tracks say whose they are.",
        TEXT,
    ),
    optional(
        "x_m",
        "Where it stands, east; the place of the sensor when absent.",
        PLACE_M,
    ),
    optional(
        "y_m",
        "Where it stands, north; the place of the sensor when absent.",
        PLACE_M,
    ),
];

static RADAR_RANGE: Object = Object {
    name: "RadarRangeRequirement",
    summary: "Share of updates whose range from a radar along the ground is right; `errors` has bias (mean), σ, and the line of gain and bias.",
    fields: &with::<13>(&joined::<4>(&[
        &RADAR,
        &[required("max_m", "Largest error that is right.", METRES)],
    ])),
};

static RADAR_AZIMUTH: Object = Object {
    name: "RadarAzimuthRequirement",
    summary: "Share of updates whose bearing from a radar is right, clockwise positive; `errors` has bias (mean), σ, and the line of gain and bias.",
    fields: &with::<13>(&joined::<4>(&[
        &RADAR,
        &[required(
            "max_deg",
            "Largest error that is right.",
            number(0.0, 180.0, "deg"),
        )],
    ])),
};

static IDENTITY_CORRECT: Object = Object {
    name: "IdentityCorrectRequirement",
    summary: "Share of updates whose identity is that of the truth, where the truth has one.",
    fields: &with::<11>(&[OF, RULE]),
};

static IDENTITY_FALSE: Object = Object {
    name: "IdentityFalseRequirement",
    summary: "Share of updates whose identity differs from the truth, where both have one.",
    fields: &with::<11>(&[OF, RULE]),
};

static IDENTITY_UPDATE: Object = Object {
    name: "IdentityUpdateRequirement",
    summary: "As detection, of updates with the right identity.",
    fields: &with::<13>(&[OF, RULE, UPDATE_INTERVAL, TOLERANCE]),
};

static MODE_C_UPDATE: Object = Object {
    name: "ModeCUpdateRequirement",
    summary: "As detection, of updates with the right Mode C height.",
    fields: &with::<12>(&[DIFFERENCE_FT, UPDATE_INTERVAL, TOLERANCE]),
};

static CODE_PRESENT: Object = Object {
    name: "CodePresentRequirement",
    summary: "Share of updates that have a code, where the truth has it.",
    fields: &with::<10>(&[required(
        "code",
        "Which.",
        Kind::Choice(&["address", "callsign", "mode_a", "mode_c"]),
    )]),
};

static MODE_A_FALSE: Object = Object {
    name: "ModeAFalseRequirement",
    summary: "Share of updates whose Mode A code differs from the truth, where both have one.",
    fields: &with::<9>(&[]),
};

static MODE_C_CORRECT: Object = Object {
    name: "ModeCCorrectRequirement",
    summary: "Share of updates whose Mode C height is right, where the truth has one.",
    fields: &with::<10>(&[DIFFERENCE_FT]),
};

static MODE_C_FALSE: Object = Object {
    name: "ModeCFalseRequirement",
    summary: "Share of updates whose Mode C height is wrong, where both have one.",
    fields: &with::<10>(&[DIFFERENCE_FT]),
};

static SPEED: Object = Object {
    name: "SpeedRequirement",
    summary: "Share of updates whose speed is right.",
    fields: &with::<11>(&[
        required(
            "max_difference_mps",
            "Largest difference that is right.",
            number(0.0, 1e6, "m/s"),
        ),
        default(
            "max_share",
            "The same as a share of the speed of the update; the larger of both counts.",
            number(0.0, 10.0, ""),
            "0.0",
        ),
    ]),
};

static COURSE: Object = Object {
    name: "CourseRequirement",
    summary: "Share of updates whose course is right.",
    fields: &with::<11>(&[
        required(
            "max_difference_deg",
            "Largest difference that is right.",
            number(0.0, 180.0, "deg"),
        ),
        default(
            "min_speed_mps",
            "Slower targets are not judged.",
            number(0.0, 1e6, "m/s"),
            "3.0",
        ),
    ]),
};

static EXTRA_DATA: Object = Object {
    name: "ExtraDataRequirement",
    summary: "Share of updates of a target at times at which it is not due.",
    fields: &with::<11>(&[
        default("min_updates", MIN_UPDATES, whole(0, 1_000_000, ""), "3"),
        default("min_duration_s", MIN_DURATION, SECONDS, "11.0"),
    ]),
};

static EXTRA_TRACK: Object = Object {
    name: "ExtraTrackRequirement",
    summary: "Share of updates at whose time another track number of the same target is alive.",
    fields: &with::<12>(&[
        default("min_updates", MIN_UPDATES, whole(0, 1_000_000, ""), "10"),
        default("min_duration_s", MIN_DURATION, SECONDS, "60.0"),
        ENDS_AFTER,
    ]),
};

static FALSE_TRACKS: Object = Object {
    name: "FalseTracksRequirement",
    summary: "Tracks that are of no target, per hour.",
    fields: &with::<10>(&[optional(
        "per_km2",
        "Per hour and this area, too; the areas of the sector are added up.",
        above(0.0, 1e9, "km²"),
    )]),
};

static FALSE_UPDATES: Object = Object {
    name: "FalseUpdatesRequirement",
    summary: "Share of updates that are of no target (false plots).",
    fields: &with::<9>(&[]),
};

static DUBIOUS_TRACKS: Object = Object {
    name: "DubiousTracksRequirement",
    summary: "Share of tracks that are dubious by themselves, whatever the truth: too many of their updates are. All updates of short tracks that do not leave the sector are.",
    fields: &with::<17>(&[
        default(
            "max_share",
            "A track with a larger share of dubious updates is dubious.",
            number(0.0, 1.0, ""),
            "0.05",
        ),
        default(
            "min_updates",
            "Shorter tracks are dubious.",
            whole(0, 1_000_000, ""),
            "10",
        ),
        default(
            "min_duration_s",
            "Shorter tracks are dubious.",
            SECONDS,
            "30.0",
        ),
        default(
            "max_speed_mps",
            "Faster updates are dubious; 1333 kt unless said otherwise.",
            number(0.0, 1e6, "m/s"),
            "685.75",
        ),
        default(
            "max_acceleration_mps2",
            "Larger changes of the speed between updates 1 to 30 s apart are dubious.",
            number(0.0, 1e6, "m/s²"),
            "29.43",
        ),
        default(
            "max_turn_degps",
            "Faster turns between such updates are dubious.",
            number(0.0, 1e6, "deg/s"),
            "30.0",
        ),
        default(
            "max_climb_mps",
            "Faster climbs and descents between such updates are dubious; 1000 ft/s unless said otherwise.",
            number(0.0, 1e6, "m/s"),
            "304.8",
        ),
        default(
            "needs_code",
            "Whether updates without address, callsign and Mode A are dubious.",
            Kind::Flag,
            "true",
        ),
    ]),
};

static CONTINUITY: Object = Object {
    name: "ContinuityRequirement",
    summary: "Changes of the track number of a target, per hour in which targets are due.",
    fields: &with::<10>(&[ENDS_AFTER]),
};

static LONGEST_TRACK: Object = Object {
    name: "LongestTrackRequirement",
    summary: "Share of the updates of targets that are of the most frequent track number of their target.",
    fields: &with::<9>(&[]),
};

static INITIATION_DELAY: Object = Object {
    name: "InitiationDelayRequirement",
    summary: "Share of targets that have an update soon after they are due for the first time.",
    fields: &with::<10>(&[required(
        "max_delay_s",
        "Latest time that is right.",
        SECONDS,
    )]),
};

/// A requirement.
pub static REQUIREMENT: Union = Union {
    name: "Requirement",
    summary: "What is measured, and what the value must be: one of at_least, at_most, above and below, or nothing.",
    tag: "requirement",
    variants: || {
        vec![
            variant("detection", &DETECTION),
            variant("long_gaps", &LONG_GAPS),
            variant("position_within", &POSITION_WITHIN),
            variant("position_beyond", &POSITION_BEYOND),
            variant("position_rms", &POSITION_RMS),
            variant("position_percentile", &POSITION_PERCENTILE),
            variant("along", &ALONG),
            variant("across", &ACROSS),
            variant("latency", &LATENCY),
            variant("radar_range", &RADAR_RANGE),
            variant("radar_azimuth", &RADAR_AZIMUTH),
            variant("identity_correct", &IDENTITY_CORRECT),
            variant("identity_false", &IDENTITY_FALSE),
            variant("identity_update", &IDENTITY_UPDATE),
            variant("mode_c_update", &MODE_C_UPDATE),
            variant("code_present", &CODE_PRESENT),
            variant("mode_a_false", &MODE_A_FALSE),
            variant("mode_c_correct", &MODE_C_CORRECT),
            variant("mode_c_false", &MODE_C_FALSE),
            variant("speed", &SPEED),
            variant("course", &COURSE),
            variant("extra_data", &EXTRA_DATA),
            variant("extra_track", &EXTRA_TRACK),
            variant("false_updates", &FALSE_UPDATES),
            variant("false_tracks", &FALSE_TRACKS),
            variant("dubious_tracks", &DUBIOUS_TRACKS),
            variant("continuity", &CONTINUITY),
            variant("longest_track", &LONGEST_TRACK),
            variant("initiation_delay", &INITIATION_DELAY),
        ]
    },
};
