//! What is required, and of whom.

use super::gaps::{Count, GapRule};
use super::reference::Phase;
use crate::evaluation::credit::Credit;
use crate::evaluation::scope::Area;
use crate::model::space::Place;
use crate::model::state::Position;
use serde::Deserialize;

/// A part of the airspace or of an airport.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sector {
    pub sector_id: String,
    /// In any of them; none is everywhere.
    pub areas: Vec<Area>,
    pub height_m: (Option<f64>, Option<f64>),
}

impl Sector {
    /// The sum of its areas; `None` where one is unbounded or what a sensor covers.
    pub fn area_km2(&self) -> Option<f64> {
        let areas_m2 = self.areas.iter().map(Area::size_m2);
        let sum_m2: Option<f64> = areas_m2.sum();
        sum_m2
            .filter(|sum_m2| *sum_m2 > 0.0)
            .map(|sum_m2| sum_m2 / 1e6)
    }

    /// A place without a height is inside whatever the heights are.
    pub fn holds(&self, place: &Place, height_m: Option<f64>) -> bool {
        let (least_m, most_m) = self.height_m;
        let is_at_height = height_m.is_none_or(|height_m| {
            least_m.is_none_or(|least_m| height_m >= least_m)
                && most_m.is_none_or(|most_m| height_m <= most_m)
        });
        is_at_height
            && (self.areas.is_empty() || self.areas.iter().any(|area| area.holds(&place.xy())))
    }
}

/// How updates find their target.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Pairing {
    /// By identity where the target of that identity is within the gate, else the nearest within it.
    #[default]
    Auto,
    /// The nearest within the gate.
    Nearest,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    pub sectors: Vec<Sector>,
    pub requirements: Vec<Requirement>,
    pub pairing: Pairing,
    pub gate_m: f64,
    /// How far in time a reference point may be from an update, and from the next point of its period.
    pub reference_reach_s: f64,
    /// Whether points that were predicted without a detection are updates.
    pub counts_coasted: bool,
    pub credit: Credit,
}

/// One line of a standard.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Requirement {
    /// What it is called in the report; the kind where absent.
    pub name: Option<String>,
    /// Names of sectors; all where absent.
    pub sectors: Option<Vec<String>>,
    pub phase: Option<Phase>,
    #[serde(flatten)]
    pub bound: Bound,
    /// No target may fail it by itself.
    #[serde(default)]
    pub each_target: bool,
    /// Points of the truth that are said to be less accurate (1 σ, m) judge nobody.
    pub reference_accuracy_m: Option<f64>,
    #[serde(flatten)]
    pub check: Check,
}

/// What its value must be: one of them, or nothing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
pub struct Bound {
    pub at_least: Option<f64>,
    pub at_most: Option<f64>,
    pub above: Option<f64>,
    pub below: Option<f64>,
}

impl Bound {
    /// The comparison as it is written, and the threshold.
    pub fn comparison(&self) -> Option<(&'static str, f64)> {
        let all = [
            (">=", self.at_least),
            ("<=", self.at_most),
            (">", self.above),
            ("<", self.below),
        ];
        all.into_iter()
            .find_map(|(comparison, threshold)| Some((comparison, threshold?)))
    }

    /// How far a value is on the right side, and whether it is there; `None` without a threshold.
    pub fn hold(&self, value: f64) -> Option<(f64, bool)> {
        let (comparison, threshold) = self.comparison()?;
        Some(match comparison {
            ">=" => (value - threshold, value >= threshold),
            "<=" => (threshold - value, value <= threshold),
            ">" => (value - threshold, value > threshold),
            _ => (threshold - value, value < threshold),
        })
    }
}

/// What an update says of who it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Code {
    Address,
    Callsign,
    ModeA,
    ModeC,
}

impl Code {
    /// The attribute that holds it.
    pub fn attribute(self) -> &'static str {
        match self {
            Code::Address => "address",
            Code::Callsign => "callsign",
            Code::ModeA => "mode_a",
            Code::ModeC => "mode_c_ft",
        }
    }
}

/// Of several codes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rule {
    Any,
    All,
}

/// How a percentile lies between two values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rank {
    Nearest,
    Linear,
}

/// The radar that positions are seen from.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
pub struct Radar {
    /// Only its updates are judged, where tracks say whose they are.
    pub sensor_id: Option<String>,
    pub x_m: Option<f64>,
    pub y_m: Option<f64>,
}

impl Radar {
    /// Where it stands; settled before anything is judged.
    pub fn place_m(&self) -> Position {
        Position::new(self.x_m.unwrap_or_default(), self.y_m.unwrap_or_default())
    }
}

/// What makes a track dubious without any truth.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Doubts {
    /// Of its updates, at most this share may be dubious.
    pub max_share: f64,
    pub min_updates: u32,
    pub min_duration_s: f64,
    pub max_speed_mps: f64,
    pub max_acceleration_mps2: f64,
    pub max_turn_degps: f64,
    pub max_climb_mps: f64,
    /// Whether an update without any code is dubious.
    pub needs_code: bool,
}

/// What is measured. The page on surveillance defines each.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "requirement", rename_all = "snake_case")]
pub enum Check {
    Detection {
        update_interval_s: f64,
        tolerance_s: f64,
        min_gap_s: Option<f64>,
        max_gap_s: Option<f64>,
        count: Count,
    },
    LongGaps {
        update_interval_s: f64,
        tolerance_s: f64,
        min_gap_s: f64,
        max_gap_s: Option<f64>,
    },
    PositionWithin {
        distance_m: f64,
    },
    PositionBeyond {
        distance_m: f64,
        inclusive: bool,
    },
    PositionRms {},
    PositionPercentile {
        percent: f64,
        rank: Rank,
    },
    Along {
        max_m: f64,
    },
    Across {
        max_m: f64,
    },
    Latency {
        max_s: f64,
    },
    RadarRange {
        #[serde(flatten)]
        radar: Radar,
        max_m: f64,
    },
    RadarAzimuth {
        #[serde(flatten)]
        radar: Radar,
        max_deg: f64,
    },
    IdentityCorrect {
        of: Vec<Code>,
        rule: Rule,
    },
    IdentityFalse {
        of: Vec<Code>,
        rule: Rule,
    },
    IdentityUpdate {
        of: Vec<Code>,
        rule: Rule,
        update_interval_s: f64,
        tolerance_s: f64,
    },
    ModeCUpdate {
        max_difference_ft: f64,
        update_interval_s: f64,
        tolerance_s: f64,
    },
    CodePresent {
        code: Code,
    },
    ModeAFalse {},
    ModeCCorrect {
        max_difference_ft: f64,
    },
    ModeCFalse {
        max_difference_ft: f64,
    },
    Speed {
        max_difference_mps: f64,
        max_share: f64,
    },
    Course {
        max_difference_deg: f64,
        min_speed_mps: f64,
    },
    ExtraData {
        min_updates: u32,
        min_duration_s: f64,
    },
    ExtraTrack {
        min_updates: u32,
        min_duration_s: f64,
        ends_after_s: f64,
    },
    FalseUpdates {},
    FalseTracks {
        per_km2: Option<f64>,
    },
    DubiousTracks(Doubts),
    Continuity {
        ends_after_s: f64,
    },
    LongestTrack {},
    InitiationDelay {
        max_delay_s: f64,
    },
}

/// Of a requirement that is no share.
pub const PER_HOUR: &str = "1/h";

impl Check {
    /// How updates are expected, of those that expect them.
    pub fn gap_rule(&self) -> Option<GapRule> {
        let plain = |update_interval_s: f64, tolerance_s: f64| GapRule {
            update_interval_s,
            tolerance_s,
            min_gap_s: None,
            max_gap_s: None,
            count: Count::Gaps,
        };
        match *self {
            Check::Detection {
                update_interval_s,
                tolerance_s,
                min_gap_s,
                max_gap_s,
                count,
            } => Some(GapRule {
                update_interval_s,
                tolerance_s,
                min_gap_s,
                max_gap_s,
                count,
            }),
            Check::LongGaps {
                update_interval_s,
                tolerance_s,
                min_gap_s,
                max_gap_s,
            } => Some(GapRule {
                min_gap_s: Some(min_gap_s),
                max_gap_s,
                ..plain(update_interval_s, tolerance_s)
            }),
            Check::IdentityUpdate {
                update_interval_s,
                tolerance_s,
                ..
            }
            | Check::ModeCUpdate {
                update_interval_s,
                tolerance_s,
                ..
            } => Some(plain(update_interval_s, tolerance_s)),
            _ => None,
        }
    }

    /// The radar that it asks from.
    pub fn radar_mut(&mut self) -> Option<&mut Radar> {
        match self {
            Check::RadarRange { radar, .. } | Check::RadarAzimuth { radar, .. } => Some(radar),
            _ => None,
        }
    }

    pub fn name(&self) -> &'static str {
        match self {
            Check::Detection { .. } => "detection",
            Check::LongGaps { .. } => "long_gaps",
            Check::PositionWithin { .. } => "position_within",
            Check::PositionBeyond { .. } => "position_beyond",
            Check::PositionRms {} => "position_rms",
            Check::PositionPercentile { .. } => "position_percentile",
            Check::Along { .. } => "along",
            Check::Across { .. } => "across",
            Check::Latency { .. } => "latency",
            Check::RadarRange { .. } => "radar_range",
            Check::RadarAzimuth { .. } => "radar_azimuth",
            Check::IdentityCorrect { .. } => "identity_correct",
            Check::IdentityFalse { .. } => "identity_false",
            Check::IdentityUpdate { .. } => "identity_update",
            Check::ModeCUpdate { .. } => "mode_c_update",
            Check::CodePresent { .. } => "code_present",
            Check::ModeAFalse {} => "mode_a_false",
            Check::ModeCCorrect { .. } => "mode_c_correct",
            Check::ModeCFalse { .. } => "mode_c_false",
            Check::Speed { .. } => "speed",
            Check::Course { .. } => "course",
            Check::ExtraData { .. } => "extra_data",
            Check::ExtraTrack { .. } => "extra_track",
            Check::FalseUpdates {} => "false_updates",
            Check::FalseTracks { .. } => "false_tracks",
            Check::DubiousTracks(_) => "dubious_tracks",
            Check::Continuity { .. } => "continuity",
            Check::LongestTrack {} => "longest_track",
            Check::InitiationDelay { .. } => "initiation_delay",
        }
    }

    /// Of its value; empty of a share.
    pub fn unit(&self) -> &'static str {
        match self {
            Check::PositionRms {} | Check::PositionPercentile { .. } => "m",
            Check::FalseTracks { .. } | Check::Continuity { .. } => PER_HOUR,
            _ => "",
        }
    }

    /// Of the errors whose statistics are told; `None` where there are none.
    pub fn error_unit(&self) -> Option<&'static str> {
        match self {
            Check::PositionWithin { .. }
            | Check::PositionBeyond { .. }
            | Check::PositionRms {}
            | Check::PositionPercentile { .. }
            | Check::Along { .. }
            | Check::Across { .. }
            | Check::RadarRange { .. } => Some("m"),
            Check::Latency { .. } | Check::InitiationDelay { .. } => Some("s"),
            Check::ModeCCorrect { .. } | Check::ModeCFalse { .. } => Some("ft"),
            Check::Speed { .. } => Some("m/s"),
            Check::Course { .. } | Check::RadarAzimuth { .. } => Some("deg"),
            _ => None,
        }
    }
}
