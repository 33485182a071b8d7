//! Where a sensor stands in the plane of the data, from its latitude and longitude.

use crate::geodesy::Stereographic;
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use crate::model::space::Frame;

/// The settings with the place in the plane that latitude and longitude say, where the request gives them or nothing else does.
pub(super) fn in_plane(
    settings: SensorSettings,
    asked: &SensorSettings,
    frame: Option<Frame>,
) -> Result<SensorSettings, Box<Fault>> {
    let (Some(lat_deg), Some(lon_deg)) = (settings.lat_deg, settings.lon_deg) else {
        return Ok(settings);
    };
    if asked.x_m.is_some() && asked.lat_deg.is_none() {
        // The request puts it elsewhere than the data do.
        return Ok(SensorSettings {
            lat_deg: None,
            lon_deg: None,
            ..settings
        });
    }
    if settings.x_m.is_some() && asked.lat_deg.is_none() {
        return Ok(settings);
    }
    let Some(frame) = frame else {
        let detail = "the data have no origin on the Earth to measure latitude and longitude from";
        return Err(Box::new(
            Fault::new("/lat_deg", "unsupported", detail).allowing("x_m, y_m"),
        ));
    };
    let plane = Stereographic::from(frame);
    let place_m = plane.project(lat_deg, lon_deg);
    Ok(SensorSettings {
        x_m: Some(place_m.x),
        y_m: Some(place_m.y),
        ..settings
    })
}
