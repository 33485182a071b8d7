//! Scenarios, described field by field.

use super::fields::{
    MAX_SCANS, MAX_TARGETS, NAME, PLACE, PROBABILITY, RANGE, SIGMA, SIGMA_BEARING, SIGMA_RATE,
    VELOCITY,
};
use super::sight::{FIELD_OF_VIEW, SECTORS};
use super::targets::{SEGMENTS, TARGET_PLAN};
use crate::registry::{
    Kind, Object, Union, above, default, list, number, optional, required, variant, whole,
};

static SCENARIO_SENSOR: Object = Object {
    name: "ScenarioSensor",
    summary: "A sensor that reports positions (give sigma_x_m, sigma_y_m), ranges and bearings (give sigma_range_m, sigma_bearing_deg, and sigma_range_rate_mps for range rates) or bearings alone (give sigma_bearing_deg) with independent Gaussian noise, and uniform clutter in its field of view, its density told by clutter_per_scan or clutter_per_deg, and by sectors with one of their own; without any there is none.",
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
        FIELD_OF_VIEW,
        SECTORS,
        optional(
            "scan_period_s",
            "Time from scan to scan of this sensor, which looks as long as the others; that of the scenario when absent.",
            above(0.0, 1e6, "s"),
        ),
        optional(
            "first_scan_s",
            "Time of the first scan of this sensor; 0 when absent.",
            number(0.0, 1e9, "s"),
        ),
        optional(
            "latency_s",
            "How much later than they were made the scans are stamped, as a sensor's are that stamps them on arrival; 0 when absent.",
            number(0.0, 1e6, "s"),
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
            "sigma_speed_mps",
            "Standard deviation of speeds, of a sensor of positions that reports velocities over ground with them; with sigma_x_m and sigma_y_m.",
            SIGMA_RATE,
        ),
        optional(
            "sigma_course_deg",
            "Standard deviation of courses, with sigma_speed_mps; without it sigma_speed_mps holds on each axis.",
            SIGMA_BEARING,
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
            "Mean of the number of false detections in a scan.",
            number(0.0, 1e6, ""),
        ),
        optional(
            "clutter_dispersion",
            "Variance of the number of false detections in a scan over its mean: a negative binomial number, for clutter that comes in bursts. A Poisson number when absent or 1.",
            number(1.0, 1000.0, ""),
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

pub static ORIGIN: Object = Object {
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
    summary: "A scene to simulate: every sensor makes one scan each period, the first at time 0, unless it says otherwise of itself.",
    fields: &[
        required(
            "scans",
            "Scans of each sensor that has no times of its own; the scene lasts so many periods.",
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
