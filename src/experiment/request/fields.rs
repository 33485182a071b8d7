//! Fields that requests of several kinds have, described one by one.

use super::scenario::SCENARIO;
use super::sight;
use crate::association::ASSOCIATOR;
use crate::filtering::FILTER;
use crate::registry::{
    Field, Kind, Object, Union, Variant, above, default, list, number, optional, required,
    text_map, variant, whole,
};
use crate::tracking::LIFECYCLE;

/// Limits that keep a job within one machine.
pub const MAX_SCANS: i64 = 100_000;
pub const MAX_TARGETS: i64 = 100_000;
/// Detections of one simulation.
pub const MAX_DETECTIONS: f64 = 20e6;

pub const PLACE: Kind = number(-1e9, 1e9, "m");
pub const SIGMA: Kind = above(0.0, 1e6, "m");
pub const SIGMA_BEARING: Kind = above(0.0, 180.0, "deg");
pub const BEARING: Kind = number(-360.0, 360.0, "deg");
pub const SIGMA_RATE: Kind = above(0.0, 1e5, "m/s");
pub const RANGE: Kind = above(0.0, 1e9, "m");
pub const PROBABILITY: Kind = above(0.0, 1.0, "");
pub const SPEED: Kind = number(0.0, 1e5, "m/s");
pub const VELOCITY: Kind = number(-1e5, 1e5, "m/s");
pub const NAME: Kind = Kind::Text { max_length: 100 };

const SENSOR_IDS: Field = optional(
    "sensor_ids",
    "Only the scans, or of tracks the points, of these sensors; all of them when absent.",
    list(&NAME, 1, 64),
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
        optional(
            "estimates",
            "Of tracks: filtered, as they were known at each scan, or smoothed, where the job has smoothed_tracks.csv; filtered when absent.",
            Kind::Choice(&["filtered", "smoothed"]),
        ),
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

pub static INPUT: Union = Union {
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
    variants.push(variant("scenario", &SOURCE_SCENARIO));
    variants.push(variant("preset", &SOURCE_PRESET));
    variants
}

fn data_sources() -> Vec<Variant> {
    vec![
        variant("dataset", &SOURCE_DATASET),
        variant("job", &SOURCE_JOB),
    ]
}

pub static SENSOR_SETTINGS: Object = Object {
    name: "SensorSettings",
    summary: "What is known of a sensor of a recording; given values replace those that came with the data.",
    fields: &[
        required("sensor_id", "Name of the sensor in the recording.", NAME),
        optional("x_m", "Position, east.", PLACE),
        optional("y_m", "Position, north.", PLACE),
        optional(
            "lat_deg",
            "Latitude (WGS 84), in place of x_m and y_m where the data have an origin on the Earth.",
            number(-90.0, 90.0, "deg"),
        ),
        optional("lon_deg", "Longitude.", number(-180.0, 180.0, "deg")),
        optional("height_m", "Height above the ellipsoid.", PLACE),
        optional(
            "z_m",
            "Position, up, on the axes of the data; where they have an origin on the Earth, height_m with lat_deg and lon_deg say it.",
            PLACE,
        ),
        optional(
            "assumed_altitude_m",
            "How high its targets are: says that its ranges are slant ranges of a sensor without elevations, which tracking in the plane turns into ranges along the ground. A detection's own height_m goes before it. Above the ellipsoid, or on data without an origin from the zero of z_m.",
            PLACE,
        ),
        optional("max_range_m", "Radius of the field of view.", RANGE),
        optional(
            "p_d",
            "Probability that a target in view is detected in a scan.",
            PROBABILITY,
        ),
        optional(
            "clutter_per_m2",
            "Expected false detections per square metre and scan, also of a sensor that reports ranges and bearings.",
            above(0.0, 1e6, "1/m²"),
        ),
        optional(
            "clutter_per_m3",
            "Expected false detections per cubic metre and scan, of a sensor that tells heights, in place of clutter_per_m2. That, of such a sensor, is per square metre of ground, spread over the heights that its detections fill.",
            above(0.0, 1e6, "1/m³"),
        ),
        optional(
            "clutter_per_deg",
            "Expected false detections per degree and scan, of a sensor whose bearings alone are used.",
            above(0.0, 1e6, "1/deg"),
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
        optional(
            "sigma_z_m",
            "Standard deviation of z; the larger of sigma_x_m and sigma_y_m when absent.",
            SIGMA,
        ),
        optional(
            "sigma_elevation_deg",
            "Standard deviation of elevations; sigma_bearing_deg when absent.",
            SIGMA_BEARING,
        ),
        optional(
            "sigma_speed_mps",
            "Standard deviation of the speeds of a sensor that reports velocities with its positions; 1 m/s when absent. Without sigma_course_deg it holds on each axis of the velocity.",
            SIGMA_RATE,
        ),
        optional(
            "sigma_course_deg",
            "Standard deviation of the courses of such a sensor. The error across the velocity grows with the speed; below 0.5 m/s a course says nothing.",
            SIGMA_BEARING,
        ),
        optional(
            "range_rate_span_mps",
            "Interval over which range rates of false detections lie; that of all range rates of the data when absent.",
            SIGMA_RATE,
        ),
        optional(
            "velocity_span_mps",
            "Interval over which velocities of false detections lie, east and north each; that of all velocities of the data when absent.",
            SIGMA_RATE,
        ),
        optional(
            "may_start",
            "Whether a report that no track uses may start a track; false of bearings in the plane without limits of their ranges, else true. Bearings of two sensors at different places start tracks where they cross, if both may.",
            Kind::Flag,
        ),
        sight::FIELD_OF_VIEW,
        sight::SECTORS,
        sight::P_D_AT,
        sight::P_FA,
        sight::CLUTTER,
        optional(
            "bearings",
            "What bearings are counted from: true, from north; relative, from the bow of what carries the sensor, whose heading is in each scan (sensor_heading_deg). True when absent.",
            Kind::Choice(&["true", "relative"]),
        ),
        optional(
            "range_min_m",
            "Nearest range of a target of which a bearing alone starts a track in the plane; with range_max_m.",
            RANGE,
        ),
        optional(
            "range_max_m",
            "Farthest range of such a target. The track starts at range_filters ranges at once.",
            RANGE,
        ),
        optional(
            "range_filters",
            "At how many ranges between range_min_m and range_max_m, in geometric progression, such a track starts; 5 when absent.",
            whole(1, 12, ""),
        ),
        optional(
            "error_correlation_s",
            "Time after which errors of successive reports of a target are forgotten to 1/e; where scans are faster, noise counts as larger, so that many of them say no more than they do. Independent when absent.",
            above(0.0, 1e6, "s"),
        ),
        optional(
            "merge_within_m",
            "Detections of a scan that are not farther apart than this, or are joined by a chain of such, are taken as one at their mean, where a sensor gives several of each target; each counts by itself when absent.",
            above(0.0, 1e6, "m"),
        ),
    ],
};

pub const JOB_NAME: Field = optional("name", "A name for people.", NAME);
pub const LABELS: Field = optional(
    "labels",
    "Labels to find the job by, name to text.",
    text_map(32, 100),
);
pub const DETECTOR: Field = optional(
    "detector",
    "Where the input is a bearing-time record: how detections are found in it; {} takes the defaults. Filled in where a scenario has one.",
    Kind::Object(&crate::detection::DETECTOR),
);
pub const SEED: Field = default(
    "seed",
    "Seed of every random number of the job.",
    whole(0, u32::MAX as i64, ""),
    "1",
);
pub static ONE_SENSOR: Kind = Kind::Object(&SENSOR_SETTINGS);
pub const SENSORS: Field = optional(
    "sensors",
    "Settings of the recording's sensors, by name.",
    list(&ONE_SENSOR, 1, 64),
);

pub const ASSOCIATOR_FIELD: Field = default(
    "associator",
    "How detections are given to tracks.",
    Kind::Union(&ASSOCIATOR),
    DEFAULT_ASSOCIATOR,
);
pub const FILTER_FIELD: Field = default(
    "filter",
    "How tracks are predicted and updated.",
    Kind::Union(&FILTER),
    DEFAULT_FILTER,
);
pub const TRACKER_FIELD: Field = default(
    "tracker",
    "Gate and life cycle.",
    Kind::Object(&LIFECYCLE),
    "{}",
);

pub const DEFAULT_ASSOCIATOR: &str = r#"{"method":"nearest_neighbour"}"#;
pub const DEFAULT_FILTER: &str = r#"{"method":"auto"}"#;
