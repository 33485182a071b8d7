//! What is known of a sensor, and the complete description that a tracker works with.

use super::scan::Scan;
use super::sensing::MeasurementModel;
use super::sight::clutter::ClutterSettings;
use super::sight::{Limits, SectorSettings, Sight, ViewSettings};
use serde::{Deserialize, Serialize};

/// What is known of a sensor; what is absent comes from the data or from the request that uses it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct SensorSettings {
    pub sensor_id: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub x_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub y_m: Option<f64>,
    /// Latitude of where it stands (WGS 84); `x_m` and `y_m` come from it where the data have a frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub lat_deg: Option<f64>,
    /// Longitude of where it stands.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub lon_deg: Option<f64>,
    /// Height of where it stands, above the ellipsoid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub height_m: Option<f64>,
    /// Position, up.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub z_m: Option<f64>,
    /// How high targets are where a detection does not say it: its ranges are slant ranges then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub assumed_altitude_m: Option<f64>,
    /// Radius of the field of view around the sensor's position.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub max_range_m: Option<f64>,
    /// Probability that a target inside the field of view is detected in a scan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub p_d: Option<f64>,
    // Also of a sensor that reports ranges and bearings.
    /// Expected false detections per square metre and scan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub clutter_per_m2: Option<f64>,
    /// Expected false detections per cubic metre and scan, of a sensor that tells heights.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub clutter_per_m3: Option<f64>,
    /// Expected false detections per degree and scan, of a sensor whose bearings alone are used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub clutter_per_deg: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub sigma_x_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub sigma_y_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub sigma_range_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub sigma_bearing_deg: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub sigma_range_rate_mps: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub sigma_z_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub sigma_elevation_deg: Option<f64>,
    /// Of velocities that are reported with places: along the velocity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub sigma_speed_mps: Option<f64>,
    /// Of their directions; when absent `sigma_speed_mps` holds on each axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub sigma_course_deg: Option<f64>,
    /// Interval over which range rates of false detections lie; that of all range rates of the data when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub range_rate_span_mps: Option<f64>,
    /// The same of velocities, east and north each.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub velocity_span_mps: Option<f64>,
    /// Whether a report that no track uses may start a track.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub may_start: Option<bool>,
    /// Where the sensor sees at all, around the place where it is; everywhere when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub field_of_view: Option<ViewSettings>,
    /// Where it sees otherwise; the first that holds a place says it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub sectors: Option<Vec<SectorSettings>>,
    /// Range at which the probability of detection is `p_d`: with it the probability falls with the range.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub p_d_at_m: Option<f64>,
    /// With `p_d_at_m`: probability of a false alarm in a resolution cell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub p_fa: Option<f64>,
    /// How the density of clutter is known, if not as the number that is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub clutter: Option<ClutterSettings>,
    /// What bearings are counted from; north when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false, inline))]
    pub bearings: Option<BearingReference>,
    /// Nearest range of a target that a bearing alone starts a track of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub range_min_m: Option<f64>,
    /// Farthest range of such a target.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub range_max_m: Option<f64>,
    /// At how many ranges between them such a track starts at once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub range_filters: Option<u32>,
    /// Time after which errors of successive reports are independent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub error_correlation_s: Option<f64>,
    /// Detections of a scan that are not farther apart are of one target.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub merge_within_m: Option<f64>,
}

/// What bearings are counted from, clockwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum BearingReference {
    /// North.
    True,
    /// The bow of what carries the sensor.
    Relative,
}

impl SensorSettings {
    /// Where it sees at all: within its field of view, else within its range; `None` where it says neither.
    pub fn limits(&self) -> Option<Limits> {
        let of_range = self.max_range_m.map(|range_to_m| ViewSettings {
            range_to_m: Some(range_to_m),
            ..ViewSettings::default()
        });
        self.field_of_view.or(of_range).map(|view| view.limits())
    }

    pub fn named(sensor_id: impl Into<String>) -> Self {
        SensorSettings {
            sensor_id: sensor_id.into(),
            ..Default::default()
        }
    }

    /// The values that no sensor can have.
    pub fn misfits(&self) -> Vec<Misfit> {
        const POSITIVE: (&str, fn(f64) -> bool) = ("> 0", |value| value > 0.0 && value.is_finite());
        const FINITE: (&str, fn(f64) -> bool) = ("a finite number", f64::is_finite);
        const LATITUDE: (&str, fn(f64) -> bool) = ("-90 to 90", |value| value.abs() <= 90.0);
        const LONGITUDE: (&str, fn(f64) -> bool) = ("-180 to 180", |value| value.abs() <= 180.0);
        const PROBABILITY: (&str, fn(f64) -> bool) =
            ("(0, 1]", |value| value > 0.0 && value <= 1.0);
        const RANGES: (&str, fn(f64) -> bool) = ("1 to 12", |value| (1.0..=12.0).contains(&value));
        let checks = [
            ("x_m", self.x_m, FINITE),
            ("y_m", self.y_m, FINITE),
            ("lat_deg", self.lat_deg, LATITUDE),
            ("lon_deg", self.lon_deg, LONGITUDE),
            ("height_m", self.height_m, FINITE),
            ("z_m", self.z_m, FINITE),
            ("assumed_altitude_m", self.assumed_altitude_m, FINITE),
            ("max_range_m", self.max_range_m, POSITIVE),
            ("p_d", self.p_d, PROBABILITY),
            ("clutter_per_m2", self.clutter_per_m2, POSITIVE),
            ("clutter_per_m3", self.clutter_per_m3, POSITIVE),
            ("clutter_per_deg", self.clutter_per_deg, POSITIVE),
            ("sigma_x_m", self.sigma_x_m, POSITIVE),
            ("sigma_y_m", self.sigma_y_m, POSITIVE),
            ("sigma_range_m", self.sigma_range_m, POSITIVE),
            ("sigma_bearing_deg", self.sigma_bearing_deg, POSITIVE),
            ("sigma_range_rate_mps", self.sigma_range_rate_mps, POSITIVE),
            ("p_d_at_m", self.p_d_at_m, POSITIVE),
            ("p_fa", self.p_fa, PROBABILITY),
            ("sigma_z_m", self.sigma_z_m, POSITIVE),
            ("sigma_elevation_deg", self.sigma_elevation_deg, POSITIVE),
            ("sigma_speed_mps", self.sigma_speed_mps, POSITIVE),
            ("sigma_course_deg", self.sigma_course_deg, POSITIVE),
            ("range_rate_span_mps", self.range_rate_span_mps, POSITIVE),
            ("velocity_span_mps", self.velocity_span_mps, POSITIVE),
            ("range_min_m", self.range_min_m, POSITIVE),
            ("range_max_m", self.range_max_m, POSITIVE),
            ("range_filters", self.range_filters.map(f64::from), RANGES),
            ("error_correlation_s", self.error_correlation_s, POSITIVE),
            ("merge_within_m", self.merge_within_m, POSITIVE),
        ];
        let misfits = checks
            .into_iter()
            .filter_map(|(field, value, (allowed, is_sound))| {
                value.filter(|value| !is_sound(*value)).map(|value| Misfit {
                    field,
                    value,
                    allowed,
                })
            });
        misfits.collect()
    }

    /// These settings, with every value that `other` knows taken from `other`.
    #[must_use]
    pub fn overridden_by(&self, other: &SensorSettings) -> SensorSettings {
        SensorSettings {
            sensor_id: self.sensor_id.clone(),
            x_m: other.x_m.or(self.x_m),
            y_m: other.y_m.or(self.y_m),
            lat_deg: other.lat_deg.or(self.lat_deg),
            lon_deg: other.lon_deg.or(self.lon_deg),
            height_m: other.height_m.or(self.height_m),
            z_m: other.z_m.or(self.z_m),
            assumed_altitude_m: other.assumed_altitude_m.or(self.assumed_altitude_m),
            max_range_m: other.max_range_m.or(self.max_range_m),
            p_d: other.p_d.or(self.p_d),
            clutter_per_m2: other.clutter_per_m2.or(self.clutter_per_m2),
            clutter_per_m3: other.clutter_per_m3.or(self.clutter_per_m3),
            clutter_per_deg: other.clutter_per_deg.or(self.clutter_per_deg),
            sigma_x_m: other.sigma_x_m.or(self.sigma_x_m),
            sigma_y_m: other.sigma_y_m.or(self.sigma_y_m),
            sigma_range_m: other.sigma_range_m.or(self.sigma_range_m),
            sigma_bearing_deg: other.sigma_bearing_deg.or(self.sigma_bearing_deg),
            sigma_range_rate_mps: other.sigma_range_rate_mps.or(self.sigma_range_rate_mps),
            sigma_z_m: other.sigma_z_m.or(self.sigma_z_m),
            sigma_elevation_deg: other.sigma_elevation_deg.or(self.sigma_elevation_deg),
            sigma_speed_mps: other.sigma_speed_mps.or(self.sigma_speed_mps),
            sigma_course_deg: other.sigma_course_deg.or(self.sigma_course_deg),
            range_rate_span_mps: other.range_rate_span_mps.or(self.range_rate_span_mps),
            velocity_span_mps: other.velocity_span_mps.or(self.velocity_span_mps),
            may_start: other.may_start.or(self.may_start),
            field_of_view: other.field_of_view.or(self.field_of_view),
            sectors: other.sectors.clone().or_else(|| self.sectors.clone()),
            p_d_at_m: other.p_d_at_m.or(self.p_d_at_m),
            p_fa: other.p_fa.or(self.p_fa),
            clutter: other.clutter.or(self.clutter),
            bearings: other.bearings.or(self.bearings),
            range_min_m: other.range_min_m.or(self.range_min_m),
            range_max_m: other.range_max_m.or(self.range_max_m),
            range_filters: other.range_filters.or(self.range_filters),
            error_correlation_s: other.error_correlation_s.or(self.error_correlation_s),
            merge_within_m: other.merge_within_m.or(self.merge_within_m),
        }
    }
}

/// A setting that no sensor can have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Misfit {
    pub field: &'static str,
    pub value: f64,
    pub allowed: &'static str,
}

/// A sensor as the tracker needs it.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    pub sensor_id: String,
    pub p_d: f64,
    /// Expected false detections a scan: per m² of ground, or of what tells heights per m³ if its model says so, and per rad for
    /// directions alone.
    pub clutter_density: f64,
    /// Whether a report that no track uses may start a track.
    pub may_start: bool,
    pub report: MeasurementModel,
    /// What it sees, where that is not the same everywhere.
    pub sight: Option<Sight>,
}

impl Sensor {
    /// A sensor of positions with this noise on each axis, P_D 0.9 and one false detection in 100 km² and scan.
    pub fn of_positions(known: &SensorSettings, sigma_m: f64) -> Self {
        Sensor {
            sensor_id: known.sensor_id.clone(),
            p_d: 0.9,
            clutter_density: 1e-8,
            may_start: true,
            report: MeasurementModel::Position {
                sigma_x_m: sigma_m,
                sigma_y_m: sigma_m,
            },
            sight: None,
        }
    }

    /// What it reports in a scan: it may be elsewhere in each.
    pub fn report_in(&self, scan: &Scan) -> MeasurementModel {
        let moved = scan.pose.map(|pose| self.report.seen_from(&pose));
        moved.unwrap_or(self.report)
    }
}
