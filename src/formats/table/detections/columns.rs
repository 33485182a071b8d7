//! Where the columns of detections are.

use super::own::OwnColumns;
use super::poses::PoseColumns;
use crate::formats::table::header::Header;

/// The file's columns by what they mean.
pub(super) struct Columns {
    pub time: usize,
    pub scan: Option<usize>,
    pub sensor: Option<usize>,
    pub id: Option<usize>,
    /// East and north, or longitude and latitude.
    pub place: Option<[usize; 2]>,
    pub is_geographic: bool,
    /// Longitude and latitude beside places in the plane.
    pub earth: Option<[usize; 2]>,
    pub range: Option<usize>,
    pub bearing: Option<usize>,
    pub elevation: Option<usize>,
    pub range_rate: Option<usize>,
    pub amplitude: Option<usize>,
    pub truth: Option<usize>,
    pub z: Option<usize>,
    pub height: Option<usize>,
    pub own: OwnColumns,
    pub pose: PoseColumns,
    pub attributes: Vec<(&'static str, usize)>,
}

impl Columns {
    pub fn from_header(header: &Header) -> Self {
        let plane = header.find("x_m").zip(header.find("y_m"));
        // Beside ranges and bearings a latitude and longitude only say them again.
        let earth = header.find("lon_deg").zip(header.find("lat_deg"));
        let earth = earth.filter(|_| header.find("bearing_deg").is_none());
        let place = plane.or(earth);
        Columns {
            time: header.required("time_s"),
            scan: header.find("scan"),
            sensor: header.find("sensor_id"),
            id: header.find("detection_id"),
            place: place.map(|(east, north)| [east, north]),
            is_geographic: plane.is_none() && earth.is_some(),
            earth: header.beside_plane(),
            range: header.find("range_m"),
            bearing: header.find("bearing_deg"),
            elevation: header.find("elevation_deg"),
            range_rate: header.find("range_rate_mps"),
            amplitude: header.find("amplitude"),
            truth: header.find("truth_id"),
            z: header.find("z_m"),
            height: header.find("height_m"),
            own: OwnColumns::from_header(header),
            pose: PoseColumns::from_header(header),
            attributes: header.attributes(),
        }
    }
}
