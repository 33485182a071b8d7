//! What sensors report of targets in space, and where they stand in it.

use super::{Kind, NoiseReader};
use crate::experiment::input::extent::{detections_of, elevations_rad, heights_m, place_of};
use crate::geodesy::Geodetic;
use crate::model::scan::Recording;
use crate::model::sensing::{Carrier, MeasurementModel, Site, Spherical};
use crate::model::sensor::SensorSettings;
use crate::model::space::Frame;

/// Whether a recording is of a volume: a sensor of it tells how high targets are.
pub fn is_in_volume(recording: &Recording) -> bool {
    (0..recording.sensors.len()).any(|sensor| tells_heights(recording, sensor))
}

/// Whether every report of a sensor says how high its target is; a sensor that never reported anything does not.
fn tells_heights(recording: &Recording, sensor: usize) -> bool {
    let mut detections = detections_of(recording, sensor).peekable();
    detections.peek().is_some() && detections.all(|one| one.measurement.tells_height())
}

/// How many of a sensor's detections have a height or an elevation, and how many there are.
fn counts(recording: &Recording, sensor: usize) -> (usize, usize) {
    let (mut telling, mut all) = (0, 0);
    for detection in detections_of(recording, sensor) {
        let measurement = &detection.measurement;
        let tells = measurement.tells_height() || measurement.elevation_rad().is_some();
        telling += usize::from(tells);
        all += 1;
    }
    (telling, all)
}

impl NoiseReader<'_> {
    /// What a sensor reports of targets in space. One that tells no heights says something of the horizontal; of its ranges it has
    /// to be known how high it stands, else they are taken as those along the ground.
    pub fn report_in_space(
        mut self,
        (recording, sensor): (&Recording, usize),
        kind: Kind,
        span_mps: Option<f64>,
        warnings: &mut Vec<String>,
    ) -> MeasurementModel {
        let settings = self.settings;
        let (telling, all) = counts(recording, sensor);
        if telling > 0 && telling < all {
            warnings.push(format!(
                "sensor '{}': heights and elevations are not used: {telling} of {all} detections have one",
                settings.sensor_id
            ));
        }
        let is_spatial = if all == 0 {
            settings.sigma_z_m.is_some() || settings.sigma_elevation_deg.is_some()
        } else {
            telling == all
        };
        let knows_height = height_m(settings, None).is_some();
        match kind {
            Kind::Position if is_spatial => MeasurementModel::Position3 {
                sigmas_m: self.sigmas_m(warnings),
                clutter_span: ground_span(settings, heights_m(recording, sensor)),
            },
            Kind::Bearing if is_spatial => {
                let site = site_of(settings, recording.frame, warnings);
                MeasurementModel::Sight(Spherical {
                    site,
                    carrier: Carrier::STANDING,
                    is_flat: false,
                    sigma_range_m: 1.0,
                    sigma_bearing_rad: self.bearing_sigma(),
                    sigma_elevation_rad: Some(self.elevation_sigma(warnings)),
                    range_rate: None,
                    clutter_span: Some(elevations_rad(recording, sensor)),
                })
            }
            Kind::Polar if is_spatial || knows_height => {
                let elevation_rad = is_spatial.then(|| self.elevation_sigma(warnings));
                let polar = self.polar(place_of(settings), span_mps);
                MeasurementModel::Spherical(Spherical {
                    site: site_of(settings, recording.frame, warnings),
                    is_flat: false,
                    sigma_elevation_rad: elevation_rad,
                    clutter_span: ground_span(settings, heights_m(recording, sensor)),
                    ..Spherical::from(polar)
                })
            }
            Kind::Polar | Kind::Position | Kind::Bearing => self.report(kind, span_mps, warnings),
        }
    }

    /// That of z is taken from the others where nobody knows it.
    fn sigmas_m(&mut self, warnings: &mut Vec<String>) -> [f64; 3] {
        let settings = self.settings;
        let x_m = self.required("sigma_x_m", settings.sigma_x_m, "m");
        let y_m = self.required("sigma_y_m", settings.sigma_y_m, "m");
        let z_m = settings.sigma_z_m.unwrap_or_else(|| {
            let assumed_m = x_m.max(y_m);
            warnings.push(format!(
                "sensor '{}': the noise of its heights is not known; that of x and y, {assumed_m} m, is assumed: 'sigma_z_m' says it",
                settings.sensor_id
            ));
            assumed_m
        });
        [x_m, y_m, z_m]
    }

    fn elevation_sigma(&mut self, warnings: &mut Vec<String>) -> f64 {
        let settings = self.settings;
        if let Some(sigma_deg) = settings.sigma_elevation_deg {
            return sigma_deg.to_radians();
        }
        let assumed_rad = self.bearing_sigma();
        warnings.push(format!(
            "sensor '{}': the noise of its elevations is not known; that of its bearings, {} deg, is assumed: 'sigma_elevation_deg' says it",
            settings.sensor_id,
            assumed_rad.to_degrees()
        ));
        assumed_rad
    }
}

/// The heights over which clutter is spread that is stated per m² of ground; `None` of what is stated per m³, or not at all.
fn ground_span(settings: &SensorSettings, heights_m: f64) -> Option<f64> {
    let is_of_ground = settings.clutter_per_m3.is_none() && settings.clutter_per_m2.is_some();
    is_of_ground.then_some(heights_m)
}

/// How high a sensor stands over the horizontal of the origin, where that is known.
fn height_m(settings: &SensorSettings, frame: Option<Frame>) -> Option<f64> {
    let origin_m = frame.map_or(0.0, |frame| frame.height_m());
    let above_m = settings.height_m.map(|height_m| height_m - origin_m);
    settings.z_m.or(above_m)
}

/// Where a sensor stands, and how its axes lie: where it is placed by latitude and longitude, as the Earth is curved.
fn site_of(settings: &SensorSettings, frame: Option<Frame>, warnings: &mut Vec<String>) -> Site {
    if height_m(settings, frame).is_none() {
        warnings.push(format!(
            "sensor '{}': how high it stands is not known; it is taken to be 0",
            settings.sensor_id
        ));
    }
    if let (Some(frame), Some(lat_deg), Some(lon_deg)) = (frame, settings.lat_deg, settings.lon_deg)
    {
        let origin = Geodetic::from(&frame);
        let own = Geodetic {
            lat_deg,
            lon_deg,
            height_m: settings.height_m.unwrap_or(0.0),
        };
        return Site {
            place_m: origin.enu_of(&own),
            turn: origin.turn_to(&own),
        };
    }
    if settings.x_m.is_none() || settings.y_m.is_none() {
        warnings.push(format!(
            "sensor '{}': its position is not known; missing x_m or y_m are taken to be 0",
            settings.sensor_id
        ));
    }
    let up_m = height_m(settings, frame).unwrap_or(0.0);
    Site::level(place_of(settings).push(up_m))
}
