//! Series over time: the probability of each candidate and each motion model of each track, what each scan held, gates and bearings.

use super::association_map::{self, AssociationMapSeries};
use super::bearing_time::{self, BearingTimeSeries};
use super::gates::{self, GatesSeries};
use super::layers::JobLayers;
use super::metrics::{MetricsSeries, over_time};
use super::modes::{self, ModeProbabilitySeries};
use super::origins::Origins;
use super::{Method, Reduced, Window, detection_id, points, scans};
use crate::model::scan::Recording;
use crate::model::track::{Candidate, TrackPoint, TrackSet, TrackStatus};
use serde::Serialize;
use std::collections::BTreeMap;
use utoipa::ToSchema;

/// Makes a series of a job's data.
pub type MakeSeries = fn(&JobLayers, &Window) -> Series;

/// Every series, by name.
pub const SERIES: [(&str, MakeSeries); 7] = [
    ("track_probability", |layers, window| {
        Series::TrackProbability(track_probability(layers, window))
    }),
    ("association_map", |layers, window| {
        Series::AssociationMap(association_map::of(layers, window))
    }),
    ("mode_probability", |layers, window| {
        Series::ModeProbability(modes::of(layers, window))
    }),
    ("scan_counts", |layers, window| {
        Series::ScanCounts(scan_counts(layers, window))
    }),
    ("bearing_time", |layers, window| {
        Series::BearingTime(bearing_time::of(layers, window))
    }),
    ("gates", |layers, window| {
        Series::Gates(Box::new(gates::of(layers, window)))
    }),
    ("metrics", |layers, window| {
        Series::Metrics(over_time(&layers.metrics, window))
    }),
];

/// A series of a job, as columns of equal length.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum Series {
    TrackProbability(TrackProbabilitySeries),
    AssociationMap(AssociationMapSeries),
    ModeProbability(ModeProbabilitySeries),
    ScanCounts(ScanCountsSeries),
    BearingTime(BearingTimeSeries),
    Gates(Box<GatesSeries>),
    Metrics(MetricsSeries),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum TrackProbabilityName {
    TrackProbability,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ScanCountsName {
    ScanCounts,
}

/// One row for each candidate of each track at each scan.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct TrackProbabilitySeries {
    pub name: TrackProbabilityName,
    /// Whether the recording says which target each detection came from.
    pub origins_known: bool,
    pub columns: TrackProbabilityColumns,
    /// Unit of each column that has one.
    pub units: BTreeMap<String, String>,
    pub source_points: usize,
    pub returned_points: usize,
    pub method: Method,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct TrackProbabilityColumns {
    pub time_s: Vec<f64>,
    /// Number of the scan; null where no recording is known.
    pub scan: Vec<Option<u32>>,
    pub track_id: Vec<String>,
    /// Null is "no detection".
    pub detection_id: Vec<Option<String>>,
    /// The target that the detection came from; null for none, for clutter, and where origins are unknown.
    pub truth_id: Vec<Option<String>>,
    pub probability: Vec<f64>,
    /// `tentative`, `confirmed`, `coasted`; null where the tracks do not say.
    pub status: Vec<Option<String>>,
    /// Normalised innovation squared of the track's update at this scan; null where it had no detection to update with.
    pub nis: Vec<Option<f64>>,
    /// The probability that the track had a target; null where the tracks do not say.
    pub existence: Vec<Option<f64>>,
}

/// One row for each scan.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct ScanCountsSeries {
    pub name: ScanCountsName,
    pub columns: ScanCountsColumns,
    /// Unit of each column that has one.
    pub units: BTreeMap<String, String>,
    pub source_points: usize,
    pub returned_points: usize,
    pub method: Method,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct ScanCountsColumns {
    pub time_s: Vec<f64>,
    pub scan: Vec<u32>,
    pub sensor_id: Vec<String>,
    pub detections: Vec<usize>,
    /// Tracks that were alive.
    pub tracks: Vec<u32>,
    /// Tracks that were confirmed, with or without a detection at this scan.
    pub confirmed: Vec<u32>,
}

/// The series of that name.
pub fn named(name: &str) -> Option<MakeSeries> {
    SERIES
        .iter()
        .find(|(known, _)| *known == name)
        .map(|(_, make)| *make)
}

pub(super) fn track_probability(layers: &JobLayers, window: &Window) -> TrackProbabilitySeries {
    let empty = TrackSet::default();
    let set = layers.tracks.as_ref().unwrap_or(&empty);
    let numbers = layers
        .detections
        .as_ref()
        .map(scan_numbers)
        .unwrap_or_default();
    let rows: Vec<_> = points(set, window)
        .flat_map(|(track_id, point)| {
            set.candidates_of(point)
                .iter()
                .map(move |candidate| (track_id, point, candidate))
        })
        .collect();
    let probabilities: Vec<f64> = rows
        .iter()
        .map(|(.., candidate)| candidate.probability)
        .collect();
    let kept = Reduced::min_max(&[&probabilities], window.max_points);
    let scan_of = |row: usize| {
        let point = rows[row].1;
        let sensor_id = point
            .sensor
            .map(|index| set.sensor_ids[index as usize].as_str());
        numbers.get(&(point.time_s.to_bits(), sensor_id)).copied()
    };
    let origins = Origins::of(layers, set);
    let columns = TrackProbabilityColumns {
        time_s: kept.column(|row| rows[row].1.time_s),
        scan: kept.column(scan_of),
        track_id: kept.column(|row| rows[row].0.to_owned()),
        detection_id: kept.column(|row| detection_id(set, rows[row].2)),
        truth_id: kept.column(|row| truth_of(origins.as_ref(), rows[row].1, rows[row].2)),
        probability: kept.column(|row| rows[row].2.probability),
        status: kept.column(|row| rows[row].1.status.map(|status| status.name().to_owned())),
        nis: kept.column(|row| rows[row].1.nis),
        existence: kept.column(|row| rows[row].1.existence),
    };
    TrackProbabilitySeries {
        name: TrackProbabilityName::TrackProbability,
        origins_known: origins.is_some(),
        columns,
        units: seconds(),
        source_points: kept.source_points,
        returned_points: kept.rows.len(),
        method: kept.method,
    }
}

/// Name of the target that a candidate came from.
fn truth_of(
    origins: Option<&Origins>,
    point: &TrackPoint,
    candidate: &Candidate,
) -> Option<String> {
    let origins = origins?;
    let target = origins.target(point, candidate)?;
    Some(origins.name(target).to_owned())
}

/// Numbers of the scans by time and sensor; by time alone under the sensor `None`, for tracks that do not name one.
fn scan_numbers(recording: &Recording) -> BTreeMap<(u64, Option<&str>), u32> {
    let entries = recording.scans.iter().rev().flat_map(|scan| {
        let sensor_id = recording.sensors[scan.sensor].sensor_id.as_str();
        [Some(sensor_id), None].map(|sensor| ((scan.time_s.to_bits(), sensor), scan.number))
    });
    entries.collect()
}

fn scan_counts(layers: &JobLayers, window: &Window) -> ScanCountsSeries {
    let empty = Recording::default();
    let recording = layers.detections.as_ref().unwrap_or(&empty);
    let tracks_alive = layers
        .tracks
        .as_ref()
        .map(|set| tracks_alive(set, window))
        .unwrap_or_default();
    let rows: Vec<_> = scans(recording, window).collect();
    let alive_at = |row: usize| {
        let time = rows[row].time_s.to_bits();
        let sensor_id = recording.sensors[rows[row].sensor].sensor_id.as_str();
        let counts = [Some(sensor_id), None].map(|sensor| {
            tracks_alive
                .get(&(time, sensor))
                .copied()
                .unwrap_or_default()
        });
        (counts[0].0 + counts[1].0, counts[0].1 + counts[1].1)
    };
    let counts = (0..rows.len()).map(|row| (rows[row].detections.len() as f64, alive_at(row)));
    let (detections, alive): (Vec<f64>, Vec<(u32, u32)>) = counts.unzip();
    let (tracks, confirmed): (Vec<f64>, Vec<f64>) = alive
        .iter()
        .map(|(tracks, confirmed)| (f64::from(*tracks), f64::from(*confirmed)))
        .unzip();
    let kept = Reduced::min_max(&[&detections, &tracks, &confirmed], window.max_points);
    let columns = ScanCountsColumns {
        time_s: kept.column(|row| rows[row].time_s),
        scan: kept.column(|row| rows[row].number),
        sensor_id: kept.column(|row| recording.sensors[rows[row].sensor].sensor_id.clone()),
        detections: kept.column(|row| rows[row].detections.len()),
        tracks: kept.column(|row| alive[row].0),
        confirmed: kept.column(|row| alive[row].1),
    };
    ScanCountsSeries {
        name: ScanCountsName::ScanCounts,
        columns,
        units: seconds(),
        source_points: kept.source_points,
        returned_points: kept.rows.len(),
        method: kept.method,
    }
}

/// How many tracks have a point at each time and sensor, and how many of them are confirmed.
fn tracks_alive<'a>(
    set: &'a TrackSet,
    window: &Window,
) -> BTreeMap<(u64, Option<&'a str>), (u32, u32)> {
    let mut alive: BTreeMap<_, (u32, u32)> = BTreeMap::new();
    for (_, point) in points(set, window) {
        let sensor_id = point
            .sensor
            .map(|index| set.sensor_ids[index as usize].as_str());
        let counts = alive
            .entry((point.time_s.to_bits(), sensor_id))
            .or_default();
        counts.0 += 1;
        counts.1 += u32::from(matches!(
            point.status,
            Some(TrackStatus::Confirmed | TrackStatus::Coasted)
        ));
    }
    alive
}

fn seconds() -> BTreeMap<String, String> {
    BTreeMap::from([("time_s".to_owned(), "s".to_owned())])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::dataset::Dataset;
    use crate::service::views::tests::{everything, read};

    fn layers() -> JobLayers {
        let detections = "time_s,scan,sensor_id,detection_id,x_m,y_m\n0,1,a,d1,0,0\n0,2,b,d2,0,0\n2,3,a,d3,0,0\n2,3,a,d4,0,0\n";
        let tracks = "time_s,track_id,sensor_id,x_m,y_m,detection_id,probability,status,nis,existence\n\
            0,t,a,0,0,d1,1,tentative,,0.25\n2,t,a,0,0,d3,0.5,confirmed,1.5,0.75\n2,t,a,0,0,,0.5,confirmed,1.5,0.75\n2,u,a,0,0,d4,1,tentative,,\n";
        let Dataset::Detections(detections) = read(detections) else {
            panic!("not detections")
        };
        let Dataset::Tracks(tracks) = read(tracks) else {
            panic!("not tracks")
        };
        JobLayers {
            detections: Some(detections),
            tracks: Some(tracks),
            ..JobLayers::default()
        }
    }

    #[test]
    fn every_candidate_is_a_row_with_its_scan() {
        let columns = track_probability(&layers(), &everything()).columns;
        assert_eq!(columns.time_s, [0.0, 2.0, 2.0, 2.0]);
        assert_eq!(columns.scan, [Some(1), Some(3), Some(3), Some(3)]);
        assert_eq!(columns.probability, [1.0, 0.5, 0.5, 1.0]);
        assert_eq!(columns.nis, [None, Some(1.5), Some(1.5), None]);
        assert_eq!(
            columns.existence,
            [Some(0.25), Some(0.75), Some(0.75), None]
        );
        assert_eq!(
            columns
                .detection_id
                .iter()
                .filter(|id| id.is_none())
                .count(),
            1
        );
    }

    #[test]
    fn a_scan_counts_the_tracks_of_its_sensor() {
        let columns = scan_counts(&layers(), &everything()).columns;
        assert_eq!(columns.sensor_id, ["a", "b", "a"]);
        assert_eq!(columns.detections, [1, 1, 2]);
        assert_eq!(columns.tracks, [1, 0, 2]);
        assert_eq!(columns.confirmed, [0, 0, 1]);
    }
}
