//! The plan view: truth, detections and tracks in the plane, with the scans to step through.

use super::heights;
use super::layers::JobLayers;
use super::{
    Density, Method, Reduced, Seen, Window, detection_id, detections, place, points, scans,
};
use crate::model::scan::{Detection, Recording};
use crate::model::state::Position;
use crate::model::track::TrackSet;
use crate::model::truth::TruthSet;
use crate::service::types::SensorSettings;
use serde::Serialize;
use std::collections::BTreeMap;
use utoipa::ToSchema;

/// Everything that the plan view of a job draws. Columns of a layer have equal length.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = PlanView)]
pub struct Plan {
    pub truth: TruthLayer,
    pub detections: DetectionLayer,
    /// Where all detections are, when not all are returned.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub density: Option<Density>,
    pub tracks: TrackLayer,
    pub extent: Extent,
    pub scans: Vec<PlanScan>,
    pub sensors: Vec<SensorSettings>,
    /// What could not be drawn, and why.
    pub notes: Vec<String>,
}

macro_rules! layer {
    ($(#[$doc:meta])* $layer:ident, $columns:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
        pub struct $layer {
            pub columns: $columns,
            /// Points of the layer inside the window.
            pub source_points: usize,
            pub returned_points: usize,
            pub method: Method,
        }

        impl $layer {
            fn new(columns: $columns, kept: &Reduced) -> Self {
                $layer { columns, source_points: kept.source_points, returned_points: kept.rows.len(), method: kept.method }
            }
        }
    };
}

layer!(
    /// Where targets really were.
    TruthLayer,
    TruthColumns
);
layer!(
    /// What sensors reported.
    DetectionLayer,
    DetectionColumns
);
layer!(
    /// What the tracker says.
    TrackLayer,
    TrackColumns
);

#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct TruthColumns {
    pub time_s: Vec<f64>,
    pub truth_id: Vec<String>,
    pub x_m: Vec<f64>,
    pub y_m: Vec<f64>,
    /// Up; no column where no point has a height.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub height_m: Option<Vec<Option<f64>>>,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct DetectionColumns {
    pub time_s: Vec<f64>,
    pub scan: Vec<u32>,
    pub sensor_id: Vec<String>,
    pub detection_id: Vec<String>,
    /// Null where the sensor reports bearings alone.
    pub x_m: Vec<Option<f64>>,
    pub y_m: Vec<Option<f64>>,
    /// The target it came from; null for clutter, and where origins are unknown.
    pub truth_id: Vec<Option<String>>,
    /// Up; no column where no detection has a height.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub height_m: Option<Vec<Option<f64>>>,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct TrackColumns {
    pub time_s: Vec<f64>,
    pub track_id: Vec<String>,
    pub x_m: Vec<f64>,
    pub y_m: Vec<f64>,
    /// Null where the tracks have no velocity.
    pub vx_mps: Vec<Option<f64>>,
    pub vy_mps: Vec<Option<f64>>,
    /// `tentative`, `confirmed`, `coasted`; null where the tracks do not say.
    pub status: Vec<Option<String>>,
    /// The most probable detection; null is "no detection".
    pub detection_id: Vec<Option<String>>,
    /// Probability of the most probable candidate.
    pub probability: Vec<Option<f64>>,
    /// Covariance of the position (m²); null where the tracks have none.
    pub p_xx: Vec<Option<f64>>,
    pub p_xy: Vec<Option<f64>>,
    pub p_yy: Vec<Option<f64>>,
    /// Up; no column where no point has a height.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub height_m: Option<Vec<Option<f64>>>,
}

/// The smallest box and time span around every point; absent members where there is no point.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, ToSchema)]
#[schema(as = PlanExtent)]
pub struct Extent {
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub x_min_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub x_max_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub y_min_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub y_max_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub from_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub to_s: Option<f64>,
}

/// One scan to step to.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct PlanScan {
    pub number: u32,
    pub time_s: f64,
    pub sensor_id: String,
}

impl Extent {
    fn include(&mut self, time_s: f64, place_m: Option<(f64, f64)>) {
        stretch(&mut self.from_s, &mut self.to_s, time_s);
        if let Some((x_m, y_m)) = place_m {
            stretch(&mut self.x_min_m, &mut self.x_max_m, x_m);
            stretch(&mut self.y_min_m, &mut self.y_max_m, y_m);
        }
    }
}

fn stretch(low: &mut Option<f64>, high: &mut Option<f64>, value: f64) {
    *low = Some(low.map_or(value, |low| low.min(value)));
    *high = Some(high.map_or(value, |high| high.max(value)));
}

/// The plan view of a job's data; each layer has at most `window.max_points` points.
pub fn of(layers: &JobLayers, window: &Window) -> Plan {
    let empty = (
        TruthSet::default(),
        Recording::default(),
        TrackSet::default(),
    );
    let truth = layers.truth.as_ref().unwrap_or(&empty.0);
    let recording = layers.detections.as_ref().unwrap_or(&empty.1);
    let tracks = layers.tracks.as_ref().unwrap_or(&empty.2);
    let mut extent = Extent::default();
    let (detections, density) = detection_layer(recording, layers, window, &mut extent);
    let spaces = [("truth", truth.space()), ("tracks", tracks.space)];
    let note = |name: &str| {
        format!(
            "the {name} are directions (bearing_deg), which have no place in the plane: see the series bearing_time"
        )
    };
    Plan {
        notes: spaces
            .iter()
            .filter(|(_, space)| !space.has_places())
            .map(|(name, _)| note(name))
            .collect(),
        truth: truth_layer(truth, window, &mut extent),
        detections,
        density,
        tracks: track_layer(tracks, window, &mut extent),
        extent,
        scans: scans(recording, window)
            .map(|scan| PlanScan {
                number: scan.number,
                time_s: scan.time_s,
                sensor_id: recording.sensors[scan.sensor].sensor_id.clone(),
            })
            .collect(),
        sensors: layers.sensors.clone(),
    }
}

fn truth_layer(truth: &TruthSet, window: &Window, extent: &mut Extent) -> TruthLayer {
    let all = truth
        .targets()
        .iter()
        .flat_map(|target| target.points.iter().map(move |point| (target, point)));
    let rows: Vec<_> = all
        .filter(|(_, point)| truth.space().has_places() && window.holds(point.time_s))
        .collect();
    rows.iter().for_each(|(_, point)| {
        extent.include(point.time_s, Some((point.position.x, point.position.y)))
    });
    let kept = Reduced::every_nth(rows.len(), window.max_points);
    let columns = TruthColumns {
        time_s: kept.column(|row| rows[row].1.time_s),
        truth_id: kept.column(|row| rows[row].0.truth_id.clone()),
        x_m: kept.column(|row| rows[row].1.position.x),
        y_m: kept.column(|row| rows[row].1.position.y),
        height_m: heights::column(&kept, |row| heights::of_truth(truth, rows[row].1)),
    };
    TruthLayer::new(columns, &kept)
}

fn detection_layer(
    recording: &Recording,
    layers: &JobLayers,
    window: &Window,
    extent: &mut Extent,
) -> (DetectionLayer, Option<Density>) {
    let sensors_m = sensor_places(recording, layers);
    let rows: Vec<Seen> = detections(recording, window).collect();
    let places: Vec<_> = rows
        .iter()
        .map(|seen| {
            let sensor_m = seen.scan.sensor_place_m(sensors_m[seen.scan.sensor]);
            place(seen.detection.measurement, sensor_m)
        })
        .collect();
    rows.iter()
        .zip(&places)
        .for_each(|(seen, place)| extent.include(seen.scan.time_s, *place));
    let kept = Reduced::every_nth(rows.len(), window.max_points);
    let truth_id = |detection: &Detection| {
        detection
            .origin
            .map(|origin| recording.targets[origin as usize].clone())
    };
    let columns = DetectionColumns {
        time_s: kept.column(|row| rows[row].scan.time_s),
        scan: kept.column(|row| rows[row].scan.number),
        sensor_id: kept.column(|row| recording.sensors[rows[row].scan.sensor].sensor_id.clone()),
        detection_id: kept.column(|row| rows[row].detection_id.to_owned()),
        x_m: kept.column(|row| places[row].map(|place| place.0)),
        y_m: kept.column(|row| places[row].map(|place| place.1)),
        truth_id: kept.column(|row| truth_id(rows[row].detection)),
        height_m: heights::column(&kept, |row| rows[row].z_m),
    };
    let is_reduced = kept.method != Method::All;
    let density = is_reduced
        .then(|| places.iter().flatten().copied().collect::<Vec<_>>())
        .and_then(|places| Density::of(&places));
    (DetectionLayer::new(columns, &kept), density)
}

/// Where each sensor of the recording stands: as the job knows it, else as the recording does, else at the origin.
pub(super) fn sensor_places(recording: &Recording, layers: &JobLayers) -> Vec<Position> {
    let known: BTreeMap<_, _> = layers
        .sensors
        .iter()
        .map(|sensor| (sensor.sensor_id.as_str(), sensor))
        .collect();
    let place = |sensor: &SensorSettings| {
        let settings = known
            .get(sensor.sensor_id.as_str())
            .map_or_else(|| sensor.clone(), |other| sensor.overridden_by(other));
        Position::new(settings.x_m.unwrap_or(0.0), settings.y_m.unwrap_or(0.0))
    };
    recording.sensors.iter().map(place).collect()
}

fn track_layer(set: &TrackSet, window: &Window, extent: &mut Extent) -> TrackLayer {
    let rows: Vec<_> = points(set, window)
        .filter(|_| set.space.has_places())
        .collect();
    rows.iter().for_each(|(_, point)| {
        let position_m = point.estimate.position;
        extent.include(point.time_s, Some((position_m.x, position_m.y)))
    });
    let kept = Reduced::every_nth(rows.len(), window.max_points);
    let velocity = |row: usize| rows[row].1.estimate.velocity;
    // The upper triangle, row by row: the variables are two for each axis.
    let variables = 2 * set.space.axes();
    let variance =
        |row: usize, element: usize| Some(rows[row].1.estimate.covariance.as_ref()?[element]);
    let candidate = |row: usize| set.most_probable(rows[row].1);
    let columns = TrackColumns {
        time_s: kept.column(|row| rows[row].1.time_s),
        track_id: kept.column(|row| rows[row].0.to_owned()),
        x_m: kept.column(|row| rows[row].1.estimate.position.x),
        y_m: kept.column(|row| rows[row].1.estimate.position.y),
        vx_mps: kept.column(|row| velocity(row).map(|velocity_mps| velocity_mps.x)),
        vy_mps: kept.column(|row| velocity(row).map(|velocity_mps| velocity_mps.y)),
        status: kept.column(|row| rows[row].1.status.map(|status| status.name().to_owned())),
        detection_id: kept
            .column(|row| candidate(row).and_then(|candidate| detection_id(set, &candidate))),
        probability: kept.column(|row| candidate(row).map(|candidate| candidate.probability)),
        p_xx: kept.column(|row| variance(row, 0)),
        p_xy: kept.column(|row| variance(row, 1)),
        p_yy: kept.column(|row| variance(row, variables)),
        height_m: heights::column(&kept, |row| heights::of_track(set, rows[row].1)),
    };
    TrackLayer::new(columns, &kept)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::dataset::Dataset;
    use crate::model::sensor;
    use crate::service::views::tests::{everything, read};

    fn layers() -> JobLayers {
        let polar = "time_s,scan,sensor_id,detection_id,range_m,bearing_deg\n0,1,s,d1,100,90\n2,2,s,d2,50,0\n";
        let tracks = "time_s,track_id,x_m,y_m,detection_id,probability,status\n0,t,1,2,d1,0.25,tentative\n0,t,1,2,,0.75,tentative\n";
        let Dataset::Detections(detections) = read(polar) else {
            panic!("not detections")
        };
        let Dataset::Tracks(tracks) = read(tracks) else {
            panic!("not tracks")
        };
        let sensor = sensor::SensorSettings {
            x_m: Some(10.0),
            y_m: Some(20.0),
            ..sensor::SensorSettings::named("s")
        };
        JobLayers {
            detections: Some(detections),
            tracks: Some(tracks),
            sensors: vec![sensor],
            ..JobLayers::default()
        }
    }

    #[test]
    fn a_range_and_a_bearing_are_placed_from_the_sensor() {
        let plan = of(&layers(), &everything());
        let DetectionColumns { x_m, y_m, .. } = plan.detections.columns;
        let placed: Vec<(f64, f64)> = x_m
            .into_iter()
            .zip(y_m)
            .map(|(x_m, y_m)| (x_m.unwrap(), y_m.unwrap()))
            .collect();
        for ((x_m, y_m), (wanted_x_m, wanted_y_m)) in
            placed.into_iter().zip([(110.0, 20.0), (10.0, 70.0)])
        {
            assert!(
                (x_m - wanted_x_m).abs() < 1e-9 && (y_m - wanted_y_m).abs() < 1e-9,
                "east is bearing 90: {x_m}, {y_m}"
            );
        }
        assert_eq!(
            (plan.extent.from_s, plan.extent.to_s),
            (Some(0.0), Some(2.0))
        );
        assert_eq!(
            (plan.extent.x_min_m, plan.extent.y_min_m),
            (Some(1.0), Some(2.0))
        );
        assert_eq!(
            plan.scans
                .iter()
                .map(|scan| scan.number)
                .collect::<Vec<_>>(),
            [1, 2]
        );
    }

    #[test]
    fn a_track_point_shows_its_most_probable_candidate() {
        let columns = of(&layers(), &everything()).tracks.columns;
        assert_eq!(columns.detection_id, [None]);
        assert_eq!(columns.probability, [Some(0.75)]);
        assert_eq!(columns.vx_mps, [None]);
    }

    #[test]
    fn points_of_a_volume_have_heights_and_others_have_no_column() {
        let columns = of(&layers(), &everything()).tracks.columns;
        assert_eq!(columns.height_m, None);
        let Dataset::Tracks(tracks) = read("time_s,track_id,x_m,y_m,z_m\n0,t,1,2,3\n1,t,1,2,-4\n")
        else {
            panic!("not tracks")
        };
        let Dataset::Detections(detections) =
            read("time_s,scan,sensor_id,detection_id,x_m,y_m,z_m\n0,1,s,a,1,2,30\n0,1,s,b,1,2,\n")
        else {
            panic!("not detections")
        };
        let layers = JobLayers {
            detections: Some(detections),
            tracks: Some(tracks),
            ..JobLayers::default()
        };
        let plan = of(&layers, &everything());
        assert_eq!(
            plan.tracks.columns.height_m,
            Some(vec![Some(3.0), Some(-4.0)])
        );
        assert_eq!(
            plan.detections.columns.height_m,
            Some(vec![Some(30.0), None])
        );
        assert_eq!(plan.truth.columns.height_m, None);
    }

    #[test]
    fn a_window_leaves_out_what_is_outside() {
        let window = Window {
            from_s: Some(1.0),
            ..everything()
        };
        let plan = of(&layers(), &window);
        assert_eq!(plan.detections.columns.detection_id, ["d2"]);
        assert_eq!(plan.tracks.source_points, 0);
        let other = Window {
            track_id: Some("u".to_owned()),
            ..everything()
        };
        assert_eq!(of(&layers(), &other).tracks.source_points, 0);
    }
}
