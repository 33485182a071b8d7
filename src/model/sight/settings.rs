//! What a request or a file says of where a sensor sees.

use super::Limits;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Where a sensor sees at all. Bearings go clockwise from the first to the second, and may hold north.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "service", schema(as = SensorFieldOfView))]
#[serde(deny_unknown_fields)]
pub struct ViewSettings {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub bearing_from_deg: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub bearing_to_deg: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub range_from_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub range_to_m: Option<f64>,
}

/// A part of what a sensor sees, and what is different there.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "service", schema(as = SensorSector))]
#[serde(deny_unknown_fields)]
pub struct SectorSettings {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub bearing_from_deg: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub bearing_to_deg: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub range_from_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub range_to_m: Option<f64>,
    /// Probability of detection there; 0 where nothing is seen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub p_d: Option<f64>,
    /// Expected false detections per square metre and scan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub clutter_per_m2: Option<f64>,
    /// Expected false detections per degree and scan, of a sensor whose bearings alone are used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub clutter_per_deg: Option<f64>,
}

impl SectorSettings {
    pub fn view(&self) -> ViewSettings {
        ViewSettings {
            bearing_from_deg: self.bearing_from_deg,
            bearing_to_deg: self.bearing_to_deg,
            range_from_m: self.range_from_m,
            range_to_m: self.range_to_m,
        }
    }

    /// Whether every number is one that a sector can have.
    pub fn is_sound(&self) -> bool {
        let is_positive =
            |value: Option<f64>| value.is_none_or(|value| value > 0.0 && value.is_finite());
        self.view().is_sound()
            && self.p_d.is_none_or(|p_d| (0.0..=1.0).contains(&p_d))
            && is_positive(self.clutter_per_m2)
            && is_positive(self.clutter_per_deg)
    }
}

impl ViewSettings {
    /// Both bearings or neither, and ranges that rise.
    pub fn is_sound(&self) -> bool {
        let bearings = [self.bearing_from_deg, self.bearing_to_deg];
        let is_arc = bearings[0].is_some() == bearings[1].is_some()
            && bearings.into_iter().flatten().all(f64::is_finite);
        let from_m = self.range_from_m.unwrap_or(0.0);
        let rises = self
            .range_to_m
            .is_none_or(|to_m| to_m > from_m && to_m.is_finite());
        is_arc && from_m.is_finite() && from_m >= 0.0 && rises
    }

    /// What is left open is everything. From a bearing to the same one is the whole turn.
    pub fn limits(&self) -> Limits {
        let (from_rad, width_rad) = match (self.bearing_from_deg, self.bearing_to_deg) {
            (Some(from_deg), Some(to_deg)) => {
                let width_deg = (to_deg - from_deg).rem_euclid(360.0);
                let width_rad = if width_deg == 0.0 {
                    TAU
                } else {
                    width_deg.to_radians()
                };
                (from_deg.to_radians().rem_euclid(TAU), width_rad)
            }
            _ => (0.0, TAU),
        };
        Limits {
            from_rad,
            width_rad,
            range_from_m: self.range_from_m.unwrap_or(0.0),
            range_to_m: self.range_to_m.unwrap_or(f64::INFINITY),
        }
    }
}
