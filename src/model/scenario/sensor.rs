//! The sensors of a scenario: where they stand or go, when and where they look, and what they report with which noise.

use super::{Scenario, Segment};
use crate::model::sight::{Limits, SectorSettings, ViewSettings};
use serde::{Deserialize, Serialize};

/// A sensor with uniform clutter in its field of view; what it reports is told by the noises that are given. Its density of
/// clutter is stated in one way: a mean number a scan or, of bearings alone, a number per degree. Neither is no clutter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScenarioSensor {
    pub sensor_id: String,
    pub x_m: f64,
    pub y_m: f64,
    /// Of a sensor that moves from there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub course: Option<SensorCourse>,
    /// In place of `x_m` and `y_m` where the scene has an origin on the Earth.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lat_deg: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lon_deg: Option<f64>,
    /// Needed wherever targets have places.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_range_m: Option<f64>,
    pub p_d: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_x_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_y_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_range_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_bearing_deg: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_range_rate_mps: Option<f64>,
    /// Mean number of false detections in a scan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clutter_per_scan: Option<f64>,
    /// Variance of that number over its mean; a Poisson number when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clutter_dispersion: Option<f64>,
    /// False detections per degree and scan, of a sensor of bearings alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clutter_per_deg: Option<f64>,
    /// With `clutter_per_deg`: false detections lie at most this far from the true bearing of a target.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clutter_within_deg: Option<f64>,
    /// Mean signal-to-noise ratio of a target's echo, which fluctuates as Swerling 1 has it: with it detections have
    /// amplitudes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub snr_db: Option<f64>,
    #[serde(flatten)]
    pub in_space: InSpace,
    #[serde(flatten)]
    pub sight: ScenarioSight,
    #[serde(flatten)]
    pub timing: ScenarioTiming,
}

/// What a sensor of positions tells besides, and where it does not see the same everywhere.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ScenarioSight {
    /// With it positions come with velocities: the noise along them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_speed_mps: Option<f64>,
    /// Of their directions; without it `sigma_speed_mps` holds on each axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_course_deg: Option<f64>,
    /// Where the sensor sees at all; everywhere up to `max_range_m` when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub field_of_view: Option<ViewSettings>,
    /// Where P_D or clutter differ; the first that holds a place says them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sectors: Option<Vec<SectorSettings>>,
}

/// When a sensor looks, if not as the scenario says.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ScenarioTiming {
    /// Its own period: it scans as long as the others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scan_period_s: Option<f64>,
    /// Time of its first scan; 0 when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_scan_s: Option<f64>,
    /// How much later than it was made a scan is stamped.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub latency_s: Option<f64>,
}

/// What a sensor has besides where targets are in space.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct InSpace {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub z_m: Option<f64>,
    /// Above the ellipsoid, with a latitude and longitude.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_z_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_elevation_deg: Option<f64>,
    /// False detections are uniform over the field of view and up to so far above the sensor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clutter_height_m: Option<f64>,
}

/// How high false detections lie where a scenario does not say it.
const CLUTTER_HEIGHT_M: f64 = 10_000.0;

/// How a sensor moves from time 0: leg by leg, then straight on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SensorCourse {
    pub vx_mps: f64,
    pub vy_mps: f64,
    pub segments: Vec<Segment>,
}

impl ScenarioSensor {
    /// How far above the sensor its false detections reach, if it tells heights.
    pub fn clutter_height_m(&self) -> f64 {
        self.in_space.clutter_height_m.unwrap_or(CLUTTER_HEIGHT_M)
    }

    /// False detections per cubic metre and scan; `None` where the field of view has no size.
    pub fn clutter_per_m3(&self) -> Option<f64> {
        let per_m2 = self.clutter_per_m2()?;
        Some(per_m2 / self.clutter_height_m())
    }

    /// Whether its reports tell heights.
    pub fn tells_heights(&self) -> bool {
        self.in_space.sigma_z_m.is_some() || self.in_space.sigma_elevation_deg.is_some()
    }

    /// `None` unless the noises of exactly one kind of report are given.
    pub fn noise(&self) -> Option<ReportNoise> {
        let sigma_range_rate_mps = self.sigma_range_rate_mps;
        if sigma_range_rate_mps.is_some() && self.sigma_range_m.is_none() {
            return None;
        }
        let InSpace {
            sigma_z_m,
            sigma_elevation_deg,
            ..
        } = self.in_space;
        if (sigma_z_m.is_some() && self.sigma_x_m.is_none())
            || (sigma_elevation_deg.is_some() && self.sigma_bearing_deg.is_none())
        {
            return None;
        }
        match (
            self.sigma_x_m,
            self.sigma_y_m,
            self.sigma_range_m,
            self.sigma_bearing_deg,
        ) {
            (Some(sigma_x_m), Some(sigma_y_m), None, None) => Some(ReportNoise::Position {
                sigma_x_m,
                sigma_y_m,
                sigma_z_m,
            }),
            (None, None, Some(sigma_range_m), Some(sigma_bearing_deg)) => {
                let sigma_bearing_rad = sigma_bearing_deg.to_radians();
                Some(ReportNoise::RangeBearing {
                    sigma_range_m,
                    sigma_bearing_rad,
                    sigma_elevation_rad: sigma_elevation_deg.map(f64::to_radians),
                    sigma_range_rate_mps,
                })
            }
            (None, None, None, Some(sigma_bearing_deg)) => Some(ReportNoise::Bearing {
                sigma_bearing_rad: sigma_bearing_deg.to_radians(),
                sigma_elevation_rad: sigma_elevation_deg.map(f64::to_radians),
            }),
            _ => None,
        }
    }

    /// Mean number of false detections in a scan, if they lie in the whole field of view.
    pub fn mean_clutter(&self) -> f64 {
        let width_deg = self.view().arc_rad().1.to_degrees();
        self.clutter_per_scan
            .or(self.clutter_per_deg.map(|per_deg| width_deg * per_deg))
            .unwrap_or(0.0)
    }

    /// Where the sensor sees at all, no farther than `max_range_m`.
    pub fn view(&self) -> Limits {
        let view = self.sight.field_of_view.unwrap_or_default();
        let ranges_m = [view.range_to_m, self.max_range_m];
        let range_to_m = ranges_m.into_iter().flatten().reduce(f64::min);
        ViewSettings { range_to_m, ..view }.limits()
    }

    /// How many scans the sensor makes in a scenario, and the time of each after the start.
    pub fn scan_times_s(&self, scenario: &Scenario) -> impl Iterator<Item = f64> + use<> {
        let first_s = self.timing.first_scan_s.unwrap_or(0.0);
        let period_s = self.timing.scan_period_s.unwrap_or(scenario.scan_period_s);
        (0..self.scan_count(scenario)).map(move |scan| first_s + scan as f64 * period_s)
    }

    /// Those before the scans of the scenario are over, one period after its last.
    pub fn scan_count(&self, scenario: &Scenario) -> u64 {
        let ScenarioTiming {
            scan_period_s,
            first_scan_s,
            ..
        } = self.timing;
        if scan_period_s.is_none() && first_scan_s.is_none() {
            return u64::from(scenario.scans);
        }
        let duration_s = f64::from(scenario.scans) * scenario.scan_period_s;
        let left_s = duration_s - first_scan_s.unwrap_or(0.0);
        // What rounding alone puts before the end is after it.
        (left_s / scan_period_s.unwrap_or(scenario.scan_period_s) - 1e-9).ceil() as u64
    }

    /// False detections per square metre of the field of view and scan; `None` where that has no size.
    pub fn clutter_per_m2(&self) -> Option<f64> {
        let view = self.view();
        self.max_range_m
            .map(|_| self.mean_clutter() / view.area_m2(view.range_to_m()))
    }
}

/// The noise of what a simulated sensor reports.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ReportNoise {
    /// With heights where their noise is given.
    Position {
        sigma_x_m: f64,
        sigma_y_m: f64,
        sigma_z_m: Option<f64>,
    },
    /// With elevations and range rates where their noise is given.
    RangeBearing {
        sigma_range_m: f64,
        sigma_bearing_rad: f64,
        sigma_elevation_rad: Option<f64>,
        sigma_range_rate_mps: Option<f64>,
    },
    Bearing {
        sigma_bearing_rad: f64,
        sigma_elevation_rad: Option<f64>,
    },
}
