//! What is known of a sensor, and the complete description that a tracker works with.

use serde::{Deserialize, Serialize};

/// What is known of one sensor; absent values come from the request, from the data, or are a fault.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SensorSettings {
    pub sensor_id: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub y_m: Option<f64>,
    /// Radius of the field of view around the sensor's position.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_range_m: Option<f64>,
    /// Probability that a target inside the field of view is detected in a scan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p_d: Option<f64>,
    /// Expected false detections per square metre and scan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clutter_per_m2: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_x_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_y_m: Option<f64>,
}

impl SensorSettings {
    pub fn named(sensor_id: impl Into<String>) -> Self {
        SensorSettings { sensor_id: sensor_id.into(), ..Default::default() }
    }

    /// These settings, with every value that `other` knows taken from `other`.
    #[must_use]
    pub fn overridden_by(&self, other: &SensorSettings) -> SensorSettings {
        SensorSettings {
            sensor_id: self.sensor_id.clone(),
            x_m: other.x_m.or(self.x_m),
            y_m: other.y_m.or(self.y_m),
            max_range_m: other.max_range_m.or(self.max_range_m),
            p_d: other.p_d.or(self.p_d),
            clutter_per_m2: other.clutter_per_m2.or(self.clutter_per_m2),
            sigma_x_m: other.sigma_x_m.or(self.sigma_x_m),
            sigma_y_m: other.sigma_y_m.or(self.sigma_y_m),
        }
    }
}

/// A sensor as the tracker needs it: position reports with independent noise on x and y.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    pub sensor_id: String,
    pub p_d: f64,
    pub clutter_per_m2: f64,
    pub sigma_x_m: f64,
    pub sigma_y_m: f64,
}
