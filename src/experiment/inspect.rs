//! What a dataset holds, looked at before any job: how its units fared, when and where it is, and what about it seems wrong.

mod beside;
mod chains;
mod clocks;
mod job;
mod suspicions;
#[cfg(test)]
mod tests;

pub use self::beside::suspicions as suspicions_beside_truth;
use crate::formats::{ReadOutcome, Units};
use crate::geodesy::Stereographic;
use crate::model::dataset::{Dataset, DatasetKind};
use crate::model::scan::{Recording, Scan};
use crate::model::space::{Frame, Space};
use crate::model::state::Position;
use crate::model::time::TimeBase;
use serde::Serialize;
use serde_json::Value;

/// What there is to say of a file.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct Inspection {
    pub kind: DatasetKind,
    /// A name of `formats::FORMATS`.
    pub format: String,
    pub units: Units,
    /// Scans of detections, frames of boxes, times of a bearing-time record.
    pub scans: u64,
    /// Detections, points, boxes or cells.
    pub rows: u64,
    /// Targets, tracks, or targets that detections name.
    pub objects: u64,
    pub sensors: Vec<InspectedSensor>,
    pub time_base: TimeBase,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<TimeSpan>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<Frame>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area: Option<Area>,
    pub warnings: Vec<String>,
    /// What seems wrong, though it can be read.
    pub suspicions: Vec<String>,
    /// A job to start from; the file is named by `path`.
    #[cfg_attr(feature = "service", schema(value_type = Object))]
    pub job: Value,
}

/// A sensor, and how much it saw.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct InspectedSensor {
    pub sensor_id: String,
    pub scans: u64,
    pub detections: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lat_deg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lon_deg: Option<f64>,
    /// Median time between its scans.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub period_s: Option<f64>,
}

/// From the first to the last time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct TimeSpan {
    pub start_s: f64,
    pub end_s: f64,
}

/// The smallest box around all places.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
pub struct Area {
    pub x_m: [f64; 2],
    pub y_m: [f64; 2],
    /// From south to north, where the data have an origin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lat_deg: Option<[f64; 2]>,
    /// From west to east; the first is the greater one of data across 180°.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lon_deg: Option<[f64; 2]>,
}

/// Looks at what was read of the file at `path` in a format.
pub fn inspect(read: ReadOutcome, format: &str, path: &str) -> Inspection {
    let ReadOutcome {
        dataset,
        warnings,
        units,
    } = read;
    let summary = dataset.summary();
    let places = places_with_times(&dataset);
    let places_m: Vec<Position> = places.into_iter().map(|(_, place_m)| place_m).collect();
    let suspicions = suspicions::of(&dataset, &places_m);
    let sensors = sensors_of(&dataset);
    Inspection {
        kind: summary.kind,
        format: format.to_owned(),
        units,
        scans: summary.scans,
        rows: summary.rows,
        objects: summary.objects,
        job: job::start_from(&dataset, format, path),
        sensors,
        time_base: summary.time_base,
        time: summary
            .start_s
            .zip(summary.end_s)
            .map(|(start_s, end_s)| TimeSpan { start_s, end_s }),
        frame: summary.frame,
        area: area_of(&places_m, summary.frame),
        warnings,
        suspicions,
    }
}

fn sensors_of(dataset: &Dataset) -> Vec<InspectedSensor> {
    let Dataset::Detections(recording) = dataset else {
        return Vec::new();
    };
    let mut sensors = Vec::with_capacity(recording.sensors.len());
    for (index, settings) in recording.sensors.iter().enumerate() {
        let scans = recording.scans.iter().filter(|scan| scan.sensor == index);
        let times_s: Vec<f64> = scans.clone().map(|scan| scan.time_s).collect();
        sensors.push(InspectedSensor {
            sensor_id: settings.sensor_id.clone(),
            scans: times_s.len() as u64,
            detections: scans.map(|scan| scan.detections.len() as u64).sum(),
            lat_deg: settings.lat_deg,
            lon_deg: settings.lon_deg,
            period_s: median_gap_s(&times_s),
        });
    }
    sensors
}

/// The median of the differences of neighbours.
fn median_gap_s(times_s: &[f64]) -> Option<f64> {
    let mut gaps_s: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    gaps_s.sort_by(f64::total_cmp);
    gaps_s.get(gaps_s.len() / 2).copied()
}

/// The places of a scan (m), as far as its detections have one.
fn places_of_scan<'a>(
    recording: &'a Recording,
    scan: &'a Scan,
) -> impl Iterator<Item = Position> + 'a {
    let settings = &recording.sensors[scan.sensor];
    let site_m = settings.x_m.zip(settings.y_m);
    let site_m = site_m.map_or(Position::zeros(), |(x_m, y_m)| Position::new(x_m, y_m));
    let places = scan.detections.iter();
    places.filter_map(move |one| one.measurement.position_seen_from(&site_m))
}

/// All places of a set (m), with their times (s).
fn places_with_times(dataset: &Dataset) -> Vec<(f64, Position)> {
    match dataset {
        Dataset::Detections(recording) => {
            let scans = recording.scans.iter();
            let places = scans.flat_map(|scan| {
                places_of_scan(recording, scan).map(|place_m| (scan.time_s, place_m))
            });
            places.collect()
        }
        Dataset::Truth(truth) if truth.space() != Space::Bearing => {
            let points = truth.targets().iter().flat_map(|target| &target.points);
            points
                .map(|point| (point.time_s, point.position.xy()))
                .collect()
        }
        Dataset::Tracks(set) if set.space != Space::Bearing => {
            let points = set.tracks.iter().flat_map(|track| &track.points);
            points
                .map(|point| (point.time_s, point.estimate.position.xy()))
                .collect()
        }
        _ => Vec::new(),
    }
}

fn area_of(places_m: &[Position], frame: Option<Frame>) -> Option<Area> {
    let first = places_m.first()?;
    let (mut least, mut most) = (*first, *first);
    for place in places_m {
        least = least.inf(place);
        most = most.sup(place);
    }
    let mut area = Area {
        x_m: [least.x, most.x],
        y_m: [least.y, most.y],
        lat_deg: None,
        lon_deg: None,
    };
    if let Some(frame) = frame {
        let [lat_deg, lon_deg] = spans_deg(places_m, frame);
        (area.lat_deg, area.lon_deg) = (Some(lat_deg), Some(lon_deg));
    }
    Some(area)
}

/// Least and greatest latitude, and westernmost and easternmost longitude as seen from the origin.
fn spans_deg(places_m: &[Position], frame: Frame) -> [[f64; 2]; 2] {
    let plane = Stereographic::from(frame);
    let middle_deg = frame.longitude_deg();
    let mut lat_deg = [f64::INFINITY, f64::NEG_INFINITY];
    let mut east_deg = lat_deg;
    for place_m in places_m {
        let (lat, lon) = plane.unproject(place_m);
        let east = (lon - middle_deg + 540.0).rem_euclid(360.0) - 180.0;
        lat_deg = [lat_deg[0].min(lat), lat_deg[1].max(lat)];
        east_deg = [east_deg[0].min(east), east_deg[1].max(east)];
    }
    let lon_deg = east_deg.map(|east| (east + middle_deg + 540.0).rem_euclid(360.0) - 180.0);
    [lat_deg, lon_deg]
}
