//! A scenario: which targets move how, and which sensors watch them. Pure description; `simulation` plays it.

mod sensor;

pub use sensor::{
    InSpace, ReportNoise, ScenarioSensor, ScenarioSight, ScenarioTiming, SensorCourse,
};

use super::space::{Frame, Space};
use serde::{Deserialize, Serialize};

/// A scene to simulate. Every sensor makes `scans` scans, one each `scan_period_s`, the first at time 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scenario {
    pub scans: u32,
    pub scan_period_s: f64,
    pub sensors: Vec<ScenarioSensor>,
    pub targets: TargetPlan,
    /// Every sensor sees every target in its field of view when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coverage: Option<Coverage>,
    /// Where x, y and z are 0 on the Earth: latitudes of sensors are measured from it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub origin: Option<Frame>,
    /// With it the sensor makes no detections: a detector finds them in its record.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub record: Option<RecordPlan>,
}

/// How a bearing-time record is made. Levels are over the noise in a cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordPlan {
    pub time_step_s: f64,
    pub bearing_step_deg: f64,
    /// At half power.
    pub beam_width_deg: f64,
    /// Independent values of which the power in a cell is the mean.
    pub noise_averages: u32,
    /// One for all targets, or one each.
    pub levels_db: Vec<f64>,
    /// Standard deviation of a target's level, which wanders slowly.
    pub fluctuation_db: f64,
    pub fluctuation_time_s: f64,
    #[serde(default)]
    pub sectors: Vec<InterferenceSector>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transients: Option<Transients>,
}

/// A sector with more noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct InterferenceSector {
    pub centre_deg: f64,
    pub width_deg: f64,
    pub level_db: f64,
}

/// Short sounds at random times from random directions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Transients {
    pub per_minute: f64,
    pub duration_s: f64,
    pub level_db: f64,
}

/// Which sensors see which targets, besides what their fields of view allow.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Coverage {
    /// `count` targets, drawn at random, are seen by all sensors; each of the others by one, drawn at random.
    Duplicates { count: u32 },
}

/// How the targets are chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum TargetPlan {
    /// `count` targets, start uniform in a square, heading uniform, speed uniform between two values.
    Random(RandomTargets),
    /// Targets written out one by one.
    Listed { targets: Vec<ListedTarget> },
    /// Targets that turn and accelerate, each with a course of its own.
    Maneuvering { targets: Vec<ManeuveringTarget> },
    /// Targets of which only the direction is told.
    Bearings(BearingTargets),
    /// Targets in rows and columns that fly one random course.
    Formation(FormationTargets),
    /// Targets that are close to each other at one time.
    Meeting(MeetingTargets),
    /// The targets of the job's truth, as they were recorded.
    Recorded(RecordedTargets),
}

impl TargetPlan {
    pub fn space(&self) -> Space {
        match self {
            TargetPlan::Bearings(_) => Space::Bearing,
            TargetPlan::Listed { targets } if targets.iter().any(ListedTarget::has_height) => {
                Space::Volume
            }
            TargetPlan::Maneuvering { targets }
                if targets.iter().any(ManeuveringTarget::has_height) =>
            {
                Space::Volume
            }
            _ => Space::Plane,
        }
    }

    pub fn count(&self) -> usize {
        match self {
            TargetPlan::Random(plan) => plan.count as usize,
            TargetPlan::Listed { targets } => targets.len(),
            TargetPlan::Maneuvering { targets } => targets.len(),
            TargetPlan::Bearings(plan) => 2 * plan.crossings.len() + plan.lines.len(),
            TargetPlan::Formation(plan) => plan.rows as usize * plan.columns as usize,
            TargetPlan::Meeting(plan) => plan.count as usize,
            // How many there are, the recording says.
            TargetPlan::Recorded(_) => 0,
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RandomTargets {
    pub count: u32,
    /// Side of the square around (0, 0) in which targets start.
    pub area_side_m: f64,
    pub speed_min_mps: f64,
    pub speed_max_mps: f64,
}

/// Targets of nearly constant velocity that are close to each other at one time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeetingTargets {
    pub count: u32,
    /// So many are gone at the meeting.
    pub leaving: u32,
    pub meeting_s: f64,
    pub x_m: f64,
    pub y_m: f64,
    /// Standard deviation of each coordinate there.
    pub sigma_m: f64,
    /// Of each component of the velocity there.
    pub speed_sigma_mps: f64,
    pub process_noise_m2ps3: f64,
}

/// Names of the recordings that come with the program.
pub const RECORDINGS: &[&str] = &["solent"];

/// Recorded targets move on a spline through their points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordedTargets {
    /// A recording that comes with the program, in place of the job's truth.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recording: Option<String>,
    /// Time of the first scan; the first time of the truth when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_s: Option<f64>,
    /// A target is nowhere between points farther apart in time.
    pub max_gap_s: f64,
}

/// A target with constant velocity from time 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ListedTarget {
    pub truth_id: String,
    pub x_m: f64,
    pub y_m: f64,
    pub vx_mps: f64,
    pub vy_mps: f64,
    /// One of them makes the scene a volume, where those that are absent are 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub z_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vz_mps: Option<f64>,
}

impl ListedTarget {
    fn has_height(&self) -> bool {
        self.z_m.is_some() || self.vz_mps.is_some()
    }
}

/// A target whose course is told leg by leg; after the last one it goes on straight.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ManeuveringTarget {
    pub truth_id: String,
    /// Where it is at its start, and how fast.
    pub x_m: f64,
    pub y_m: f64,
    pub vx_mps: f64,
    pub vy_mps: f64,
    /// A height or a climb of one target makes the scene a volume; those without are at 0 there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub z_m: Option<f64>,
    /// From then on it is there, and its first segment begins.
    pub start_s: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end_s: Option<f64>,
    pub segments: Vec<Segment>,
}

impl ManeuveringTarget {
    fn has_height(&self) -> bool {
        self.z_m.is_some() || self.segments.iter().any(Segment::climbs)
    }
}

/// A leg of a course.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "move", rename_all = "snake_case")]
pub enum Segment {
    Straight {
        duration_s: f64,
    },
    /// On a circle, to the left where the rate is positive.
    Turn {
        duration_s: f64,
        rate_degps: f64,
    },
    /// Along the heading at its beginning.
    Accelerate {
        duration_s: f64,
        acceleration_mps2: f64,
    },
    /// Straight over the ground; down where the rate is negative.
    Climb {
        duration_s: f64,
        rate_mps: f64,
    },
}

impl Segment {
    pub fn climbs(&self) -> bool {
        matches!(self, Segment::Climb { .. })
    }

    pub fn duration_s(&self) -> f64 {
        match *self {
            Segment::Straight { duration_s }
            | Segment::Turn { duration_s, .. }
            | Segment::Accelerate { duration_s, .. }
            | Segment::Climb { duration_s, .. } => duration_s,
        }
    }
}

/// The targets of the crossings come first, named 1, 2, … in the order of the pairs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BearingTargets {
    #[serde(default)]
    pub crossings: Vec<CrossingPair>,
    #[serde(default)]
    pub lines: Vec<BearingLine>,
}

/// Two targets at c ∓ h sgn(1 − t/t×) |1 − t/t×|ᵖ: c − h and c + h at time 0, both at c at t×.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CrossingPair {
    /// c.
    pub centre_deg: f64,
    /// h.
    pub half_width_deg: f64,
    /// t×.
    pub crossing_time_s: f64,
    /// p.
    pub power: f64,
}

/// A target whose bearing changes at a constant rate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BearingLine {
    pub truth_id: String,
    /// At time 0.
    pub bearing_deg: f64,
    pub rate_degps: f64,
}

/// A grid of targets around (0, 0) that all fly at one speed on one random course.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FormationTargets {
    pub rows: u32,
    pub columns: u32,
    pub spacing_m: f64,
    /// Each target starts up to this share of the spacing away from its place in the grid, uniform on each axis.
    pub displacement: f64,
    pub speed_mps: f64,
    pub motion: FormationMotion,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum FormationMotion {
    ConstantVelocity,
    /// The heading swings around the course as a sine of time; each target has a random phase of its own.
    Weaving {
        heading_amplitude_deg: f64,
        period_s: f64,
    },
}
