//! The bearing–time series: in which direction truth, detections and tracks lay, clockwise from north, for sensors that know
//! directions alone. Places are seen from the sensors when all stand at one place, else they are left out.

use super::layers::JobLayers;
use super::plan::sensor_places;
use super::{Method, Reduced, Seen, Window, detections, points};
use crate::model::scan::{Measurement, Recording};
use crate::model::space::Space;
use crate::model::state::Position;
use crate::model::track::{TrackPoint, TrackSet};
use crate::model::truth::{TruthPoint, TruthSet};
use serde::Serialize;
use std::collections::BTreeMap;
use utoipa::ToSchema;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum BearingTimeName {
    BearingTime,
}

/// What a bearing is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum BearingLayer {
    Truth,
    Detection,
    Track,
}

/// One row for each bearing: truth, then detections, then tracks.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct BearingTimeSeries {
    pub name: BearingTimeName,
    pub columns: BearingTimeColumns,
    /// Unit of each column that has one.
    pub units: BTreeMap<String, String>,
    pub source_points: usize,
    pub returned_points: usize,
    pub method: Method,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct BearingTimeColumns {
    pub time_s: Vec<f64>,
    pub layer: Vec<BearingLayer>,
    /// Name of the target, detection or track.
    pub id: Vec<String>,
    /// From 0 to 360.
    pub bearing_deg: Vec<f64>,
    /// Of tracks; null where they do not say.
    pub bearing_rate_degps: Vec<Option<f64>>,
    /// Of tracks: standard deviation of the bearing; null where they do not say.
    pub sigma_bearing_deg: Vec<Option<f64>>,
    /// Of tracks: the most probable detection; null is "no detection".
    pub detection_id: Vec<Option<String>>,
}

struct Row<'a> {
    time_s: f64,
    layer: BearingLayer,
    id: &'a str,
    bearing_rad: f64,
    rate_radps: Option<f64>,
    sigma_rad: Option<f64>,
    detection_id: Option<&'a str>,
}

impl<'a> Row<'a> {
    fn new(time_s: f64, layer: BearingLayer, id: &'a str, bearing_rad: f64) -> Self {
        Row {
            time_s,
            layer,
            id,
            bearing_rad,
            rate_radps: None,
            sigma_rad: None,
            detection_id: None,
        }
    }
}

pub(super) fn of(layers: &JobLayers, window: &Window) -> BearingTimeSeries {
    let mut rows = Vec::new();
    if let Some(truth) = &layers.truth {
        rows.extend(truth_rows(truth, layers, window));
    }
    if let Some(recording) = &layers.detections {
        rows.extend(detection_rows(recording, window));
    }
    if let Some(tracks) = &layers.tracks {
        rows.extend(track_rows(tracks, window));
    }
    let kept = Reduced::every_nth(rows.len(), window.max_points);
    let columns = BearingTimeColumns {
        time_s: kept.column(|row| rows[row].time_s),
        layer: kept.column(|row| rows[row].layer),
        id: kept.column(|row| rows[row].id.to_owned()),
        bearing_deg: kept.column(|row| rows[row].bearing_rad.to_degrees().rem_euclid(360.0)),
        bearing_rate_degps: kept.column(|row| rows[row].rate_radps.map(f64::to_degrees)),
        sigma_bearing_deg: kept.column(|row| rows[row].sigma_rad.map(f64::to_degrees)),
        detection_id: kept.column(|row| rows[row].detection_id.map(str::to_owned)),
    };
    let units = [
        ("time_s", "s"),
        ("bearing_deg", "deg"),
        ("bearing_rate_degps", "deg/s"),
        ("sigma_bearing_deg", "deg"),
    ];
    BearingTimeSeries {
        name: BearingTimeName::BearingTime,
        columns,
        units: units
            .map(|(column, unit)| (column.to_owned(), unit.to_owned()))
            .into(),
        source_points: kept.source_points,
        returned_points: kept.rows.len(),
        method: kept.method,
    }
}

fn truth_rows<'a>(truth: &'a TruthSet, layers: &JobLayers, window: &Window) -> Vec<Row<'a>> {
    let place_m = layers
        .detections
        .as_ref()
        .and_then(|recording| common_place(recording, layers));
    let bearing = |point: &TruthPoint| match truth.space() {
        Space::Bearing => Some(point.position.x),
        Space::Plane | Space::Volume => {
            place_m.map(|at_m| (point.position.x - at_m.x).atan2(point.position.y - at_m.y))
        }
    };
    let all = truth
        .targets()
        .iter()
        .flat_map(|target| target.points.iter().map(move |point| (target, point)));
    let inside = all.filter(|(_, point)| window.holds(point.time_s));
    inside
        .filter_map(|(target, point)| {
            Some(Row::new(
                point.time_s,
                BearingLayer::Truth,
                &target.truth_id,
                bearing(point)?,
            ))
        })
        .collect()
}

/// Where all sensors stand, if they stand together and none moves.
fn common_place(recording: &Recording, layers: &JobLayers) -> Option<Position> {
    if recording.scans.iter().any(|scan| scan.pose.is_some()) {
        return None;
    }
    let places_m = sensor_places(recording, layers);
    let first = *places_m.first()?;
    places_m
        .iter()
        .all(|place_m| *place_m == first)
        .then_some(first)
}

fn detection_rows<'a>(recording: &'a Recording, window: &Window) -> Vec<Row<'a>> {
    let row = |seen: Seen<'a>| match seen.detection.measurement.flat() {
        Measurement::Bearing { bearing_rad } | Measurement::RangeBearing { bearing_rad, .. } => {
            Some(Row::new(
                seen.scan.time_s,
                BearingLayer::Detection,
                seen.detection_id,
                bearing_rad,
            ))
        }
        _ => None,
    };
    detections(recording, window).filter_map(row).collect()
}

fn track_rows<'a>(set: &'a TrackSet, window: &Window) -> Vec<Row<'a>> {
    if set.space != Space::Bearing {
        return Vec::new();
    }
    let row = |(track_id, point): (&'a str, &'a TrackPoint)| {
        let detection = set
            .most_probable(point)
            .and_then(|candidate| candidate.detection);
        let estimate = &point.estimate;
        let variance = estimate.covariance.as_ref().map(|elements| elements[0]);
        Row {
            rate_radps: estimate.velocity.map(|velocity| velocity.x),
            sigma_rad: variance.map(|variance| variance.max(0.0).sqrt()),
            detection_id: detection.map(|index| set.detection_ids[index as usize].as_str()),
            ..Row::new(
                point.time_s,
                BearingLayer::Track,
                track_id,
                estimate.position.x,
            )
        }
    };
    points(set, window).map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::dataset::Dataset;
    use crate::model::sensor::SensorSettings;
    use crate::service::views::plan;
    use crate::service::views::tests::{everything, read};

    fn layers(truth: &str) -> JobLayers {
        let Dataset::Truth(truth) = read(truth) else {
            panic!("not truth")
        };
        let Dataset::Detections(detections) =
            read("time_s,scan,sensor_id,detection_id,bearing_deg\n0,1,s,d1,359\n1,2,s,d2,1\n")
        else {
            panic!("not detections")
        };
        let tracks = "time_s,track_id,bearing_deg,bearing_rate_degps,p_bb,p_bbr,p_brbr,detection_id\n0,t,359,2,4,0,1,d1\n1,t,1,,,,,\n";
        let Dataset::Tracks(tracks) = read(tracks) else {
            panic!("not tracks")
        };
        let sensor = SensorSettings {
            x_m: Some(10.0),
            y_m: Some(20.0),
            ..SensorSettings::named("s")
        };
        JobLayers {
            detections: Some(detections),
            truth: Some(truth),
            tracks: Some(tracks),
            sensors: vec![sensor],
            ..JobLayers::default()
        }
    }

    #[test]
    fn bearings_of_all_layers_are_rows_and_places_are_seen_from_the_sensor() {
        let columns = of(
            &layers("time_s,truth_id,x_m,y_m\n0,a,10,1000\n1,a,-90,20\n"),
            &everything(),
        )
        .columns;
        use BearingLayer::{Detection, Track, Truth};
        assert_eq!(
            columns.layer,
            [Truth, Truth, Detection, Detection, Track, Track]
        );
        for (found, wanted) in columns
            .bearing_deg
            .iter()
            .zip([0.0, 270.0, 359.0, 1.0, 359.0, 1.0])
        {
            assert!((found - wanted).abs() < 1e-9, "{found} for {wanted}");
        }
        assert!(
            (columns.sigma_bearing_deg[4].unwrap() - 2.0).abs() < 1e-12
                && (columns.bearing_rate_degps[4].unwrap() - 2.0).abs() < 1e-12
        );
        assert_eq!(
            (
                columns.sigma_bearing_deg[5],
                columns.detection_id[5].as_deref()
            ),
            (None, None)
        );
        assert_eq!(columns.detection_id[4].as_deref(), Some("d1"));
    }

    #[test]
    fn a_plan_of_directions_is_empty_and_says_why() {
        let plan = plan::of(
            &layers("time_s,truth_id,bearing_deg\n0,a,359\n"),
            &everything(),
        );
        assert_eq!(
            (
                plan.tracks.returned_points,
                plan.truth.returned_points,
                plan.extent.x_min_m
            ),
            (0, 0, None)
        );
        assert_eq!(plan.detections.columns.x_m, [None, None]);
        assert_eq!(plan.notes.len(), 2);
        assert!(
            plan.notes[1].starts_with("the tracks are directions (bearing_deg)"),
            "{:?}",
            plan.notes
        );
    }
}
