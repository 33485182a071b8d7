//! Scenarios, described field by field.

use super::fields::{
    BEARING, MAX_SCANS, MAX_TARGETS, NAME, PLACE, PROBABILITY, RANGE, SIGMA, SIGMA_BEARING,
    SIGMA_RATE, SPEED, VELOCITY,
};
use crate::registry::{
    Field, Kind, Object, Union, above, default, list, number, optional, required, variant, whole,
};

static SCENARIO_SENSOR: Object = Object {
    name: "ScenarioSensor",
    summary: "A sensor that reports positions (give sigma_x_m, sigma_y_m), ranges and bearings (give sigma_range_m, sigma_bearing_deg, and sigma_range_rate_mps for range rates) or bearings alone (give sigma_bearing_deg) with independent Gaussian noise, and uniform clutter in its field of view, its density told by clutter_per_scan or clutter_per_deg; without either there is none.",
    fields: &[
        default("sensor_id", "Name of the sensor.", NAME, "\"radar\""),
        default("x_m", "Position, east.", PLACE, "0.0"),
        default("y_m", "Position, north.", PLACE, "0.0"),
        optional(
            "z_m",
            "Position, up, where targets are in space; 0 when absent.",
            PLACE,
        ),
        optional(
            "course",
            "How the sensor moves, from there at time 0; it stands when absent. Its scans say where it is, how fast and with which heading: along its velocity.",
            Kind::Object(&SENSOR_COURSE),
        ),
        optional(
            "lat_deg",
            "Latitude, in place of x_m and y_m where the scene, or recorded targets, have an origin on the Earth; with lon_deg.",
            number(-90.0, 90.0, "deg"),
        ),
        optional("lon_deg", "Longitude.", number(-180.0, 180.0, "deg")),
        optional(
            "height_m",
            "Height above the ellipsoid, with lat_deg and lon_deg where targets are in space: the sensor then measures east, north and up of its own place on a curved Earth.",
            PLACE,
        ),
        optional(
            "max_range_m",
            "Radius of the field of view; required unless the targets are of the kind bearings, which are always in view.",
            RANGE,
        ),
        default(
            "p_d",
            "Probability that a target in view is detected in a scan.",
            PROBABILITY,
            "0.9",
        ),
        optional(
            "sigma_x_m",
            "Standard deviation of x, of a sensor that reports positions; with sigma_y_m.",
            SIGMA,
        ),
        optional(
            "sigma_y_m",
            "Standard deviation of y; with sigma_x_m.",
            SIGMA,
        ),
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
            "sigma_z_m",
            "Standard deviation of z, of a sensor that reports positions in space; with sigma_x_m and sigma_y_m.",
            SIGMA,
        ),
        optional(
            "sigma_elevation_deg",
            "Standard deviation of elevations, of a sensor that reports them with bearings in space; its ranges are slant ranges.",
            SIGMA_BEARING,
        ),
        optional(
            "clutter_height_m",
            "False detections of a sensor that tells heights are uniform over its field of view and up to so far above it; 10 000 m when absent.",
            RANGE,
        ),
        optional(
            "clutter_per_scan",
            "Mean of the Poisson number of false detections in a scan.",
            number(0.0, 1e6, ""),
        ),
        optional(
            "clutter_per_deg",
            "False detections per degree and scan, of a sensor of bearings alone; instead of clutter_per_scan.",
            number(0.0, 1000.0, "1/deg"),
        ),
        optional(
            "clutter_within_deg",
            "With clutter_per_deg: false detections lie at most this far from the true bearing of a target in view, each degree counted once; on the whole circle when absent.",
            SIGMA_BEARING,
        ),
        optional(
            "snr_db",
            "Mean signal-to-noise ratio of a target's echo (Swerling 1). With it detections have amplitudes: the power of their echoes in units of the noise's, beyond the threshold that p_d and this ratio set.",
            number(-30.0, 100.0, "dB"),
        ),
    ],
};

static SENSOR_COURSE: Object = Object {
    name: "SensorCourse",
    summary: "The course of a sensor that moves; after its last segment it goes on straight.",
    fields: &[
        default("vx_mps", "Velocity at time 0, east.", VELOCITY, "0.0"),
        default("vy_mps", "Velocity at time 0, north.", VELOCITY, "0.0"),
        SEGMENTS,
    ],
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
        ]
    },
};

static MANEUVERING_TARGET: Object = Object {
    name: "ManeuveringTarget",
    summary: "A target that turns and accelerates; after its last segment it goes on straight.",
    fields: &[
        required("truth_id", "Name of the target.", NAME),
        required("x_m", "Start, east.", PLACE),
        required("y_m", "Start, north.", PLACE),
        default("vx_mps", "Velocity at the start, east.", VELOCITY, "0.0"),
        default("vy_mps", "Velocity at the start, north.", VELOCITY, "0.0"),
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

const SEGMENTS: Field = default(
    "segments",
    "Its course, leg by leg.",
    list(&SEGMENT_KIND, 0, 1000),
    "[]",
);
static SEGMENT_KIND: Kind = Kind::Union(&SEGMENT);

static MANEUVERING_TARGETS: Object = Object {
    name: "ManeuveringTargets",
    summary: "Targets that turn and accelerate, each on a course of its own.",
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

static TARGET_PLAN: Union = Union {
    name: "TargetPlan",
    summary: "How the targets of a scenario are chosen.",
    tag: "kind",
    variants: || {
        vec![
            variant("random", &RANDOM_TARGETS),
            variant("listed", &LISTED_TARGETS),
            variant("maneuvering", &MANEUVERING_TARGETS),
            variant("formation", &FORMATION_TARGETS),
            variant("bearings", &BEARING_TARGETS),
            variant("recorded", &RECORDED_TARGETS),
        ]
    },
};

static DUPLICATES: Object = Object {
    name: "DuplicatesCoverage",
    summary: "Some targets, drawn at random, are seen by all sensors; each of the others by one, drawn at random.",
    fields: &[required(
        "count",
        "Number of targets that all sensors see.",
        whole(0, MAX_TARGETS, ""),
    )],
};

static COVERAGE: Union = Union {
    name: "Coverage",
    summary: "Which sensors see which targets, besides what their fields of view allow.",
    tag: "kind",
    variants: || vec![variant("duplicates", &DUPLICATES)],
};

static ORIGIN: Object = Object {
    name: "ScenarioOrigin",
    summary: "A place on the Earth (WGS 84).",
    fields: &[
        required("lat_deg", "Latitude.", number(-90.0, 90.0, "deg")),
        required("lon_deg", "Longitude.", number(-180.0, 180.0, "deg")),
        default("height_m", "Height above the ellipsoid.", PLACE, "0.0"),
    ],
};

pub static SCENARIO: Object = Object {
    name: "Scenario",
    summary: "A scene to simulate: every sensor makes one scan each period, the first at time 0.",
    fields: &[
        required(
            "scans",
            "Scans of each sensor.",
            whole(1, MAX_SCANS, "scans"),
        ),
        required(
            "scan_period_s",
            "Time from scan to scan.",
            above(0.0, 1e6, "s"),
        ),
        required(
            "sensors",
            "The sensors.",
            list(&Kind::Object(&SCENARIO_SENSOR), 1, 64),
        ),
        required("targets", "The targets.", Kind::Union(&TARGET_PLAN)),
        optional(
            "coverage",
            "Which sensors see which targets; every sensor sees all in its field of view when absent.",
            Kind::Union(&COVERAGE),
        ),
        optional(
            "origin",
            "Where x, y and z are 0 on the Earth (WGS 84), from which latitudes of sensors are measured. Targets in space move on straight lines of the axes east, north and up there.",
            Kind::Object(&ORIGIN),
        ),
        optional(
            "record",
            "A bearing-time record of the sensor instead of its detections, as long as its scans; targets must be of the kind bearings. A detector finds the detections; what the sensor says of p_d, noise and clutter is what a tracker is told.",
            Kind::Object(&crate::simulation::RECORD),
        ),
    ],
};
