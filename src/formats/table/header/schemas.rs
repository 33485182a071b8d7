//! Which columns each kind of dataset knows.

use crate::formats::table::detections::{OWN_VELOCITY, POSE_PLACE};
use crate::model::modes::MAX_MODES;

/// The ten columns of a covariance, upper triangle.
pub const COVARIANCE: [&str; 10] = [
    "p_xx", "p_xy", "p_xvx", "p_xvy", "p_yy", "p_yvx", "p_yvy", "p_vxvx", "p_vxvy", "p_vyvy",
];

pub const VELOCITY: [&str; 2] = ["vx_mps", "vy_mps"];

pub const VOLUME_VELOCITY: [&str; 3] = ["vx_mps", "vy_mps", "vz_mps"];

/// The 21 columns of a covariance in a volume, upper triangle.
pub const VOLUME_COVARIANCE: [&str; 21] = [
    "p_xx", "p_xy", "p_xz", "p_xvx", "p_xvy", "p_xvz", "p_yy", "p_yz", "p_yvx", "p_yvy", "p_yvz",
    "p_zz", "p_zvx", "p_zvy", "p_zvz", "p_vxvx", "p_vxvy", "p_vxvz", "p_vyvy", "p_vyvz", "p_vzvz",
];

/// The three columns of a bearing's covariance, upper triangle (deg², deg²/s, deg²/s²).
pub const BEARING_COVARIANCE: [&str; 3] = ["p_bb", "p_bbr", "p_brbr"];

/// The columns of one kind of dataset.
pub struct Schema {
    pub required: &'static [&'static str],
    pub optional: &'static [&'static str],
    /// Known, kept in the file, but not read into the dataset.
    pub unused: &'static [&'static str],
    /// Columns that come together or not at all.
    pub together: &'static [&'static [&'static str]],
}

/// Columns that every kind may have.
pub const EVERYWHERE: &[&str] = &[
    "lat_deg",
    "lon_deg",
    "height_m",
    "speed_mps",
    "course_deg",
    TIME_BASE,
];

/// What times are counted from.
pub const TIME_BASE: &str = "time_base";

pub const DETECTIONS: Schema = Schema {
    required: &["time_s"],
    optional: &[
        "scan",
        "sensor_id",
        "detection_id",
        "x_m",
        "y_m",
        "range_m",
        "bearing_deg",
        "range_rate_mps",
        "amplitude",
        "truth_id",
        "z_m",
        "elevation_deg",
        OWN_VELOCITY[0],
        OWN_VELOCITY[1],
    ],
    unused: &[],
    together: &[&["x_m", "y_m"], &POSE_PLACE, &OWN_VELOCITY],
};

pub const TRUTH: Schema = Schema {
    required: &["time_s", "truth_id", "x_m", "y_m"],
    optional: &["vx_mps", "vy_mps"],
    unused: &["z_m", "bearing_deg"],
    together: &[&VELOCITY],
};

pub const TRUTH_IN_VOLUME: Schema = Schema {
    required: &["time_s", "truth_id", "x_m", "y_m", "z_m"],
    optional: &VOLUME_VELOCITY,
    unused: &["bearing_deg"],
    together: &[&VOLUME_VELOCITY],
};

/// Of targets whose direction alone is known.
pub const TRUE_BEARINGS: Schema = Schema {
    required: &["time_s", "truth_id", "bearing_deg"],
    optional: &[],
    unused: &[],
    together: &[],
};

/// How probable each motion model was.
pub const MODE_COLUMNS: [&str; MAX_MODES] =
    ["mode_1", "mode_2", "mode_3", "mode_4", "mode_5", "mode_6"];

pub const TRACKS: Schema = Schema {
    required: &["time_s", "track_id", "x_m", "y_m"],
    optional: &[
        "sensor_id",
        "vx_mps",
        "vy_mps",
        "p_xx",
        "p_xy",
        "p_xvx",
        "p_xvy",
        "p_yy",
        "p_yvx",
        "p_yvy",
        "p_vxvx",
        "p_vxvy",
        "p_vyvy",
        "detection_id",
        "probability",
        "status",
        "nis",
        "known_at_s",
        "existence",
        "mode_1",
        "mode_2",
        "mode_3",
        "mode_4",
        "mode_5",
        "mode_6",
    ],
    unused: &["z_m", "bearing_deg", "bearing_rate_degps"],
    together: &[&VELOCITY, &COVARIANCE],
};

pub const TRACKS_IN_VOLUME: Schema = Schema {
    required: &["time_s", "track_id", "x_m", "y_m", "z_m"],
    optional: &[
        "sensor_id",
        "vx_mps",
        "vy_mps",
        "vz_mps",
        "p_xx",
        "p_xy",
        "p_xz",
        "p_xvx",
        "p_xvy",
        "p_xvz",
        "p_yy",
        "p_yz",
        "p_yvx",
        "p_yvy",
        "p_yvz",
        "p_zz",
        "p_zvx",
        "p_zvy",
        "p_zvz",
        "p_vxvx",
        "p_vxvy",
        "p_vxvz",
        "p_vyvy",
        "p_vyvz",
        "p_vzvz",
        "detection_id",
        "probability",
        "status",
        "nis",
        "known_at_s",
        "existence",
        "mode_1",
        "mode_2",
        "mode_3",
        "mode_4",
        "mode_5",
        "mode_6",
    ],
    unused: &["bearing_deg", "bearing_rate_degps"],
    together: &[&VOLUME_VELOCITY, &VOLUME_COVARIANCE],
};

/// Of trackers that know directions alone.
pub const BEARING_TRACKS: Schema = Schema {
    required: &["time_s", "track_id", "bearing_deg"],
    optional: &[
        "sensor_id",
        "bearing_rate_degps",
        "p_bb",
        "p_bbr",
        "p_brbr",
        "detection_id",
        "probability",
        "status",
        "nis",
        "known_at_s",
        "existence",
    ],
    unused: &[],
    together: &[&BEARING_COVARIANCE],
};

/// Groups of a volume, and those of the plane with a part of the same names.
pub const PLANAR_PARTS: [(&[&str], &[&str]); 2] = [
    (&VOLUME_VELOCITY, &VELOCITY),
    (&VOLUME_COVARIANCE, &COVARIANCE),
];
