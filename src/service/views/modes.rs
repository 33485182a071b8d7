//! How probable each motion model of a filter was, over time.

use super::{Method, Reduced, Window, points};
use crate::model::track::{TrackPoint, TrackSet};
use crate::service::views::layers::JobLayers;
use serde::Serialize;
use std::collections::BTreeMap;
use utoipa::ToSchema;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ModeProbabilityName {
    ModeProbability,
}

/// One row for each motion model of each track at each scan; none where the filter has one.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct ModeProbabilitySeries {
    pub name: ModeProbabilityName,
    pub columns: ModeProbabilityColumns,
    /// Unit of each column that has one.
    pub units: BTreeMap<String, String>,
    pub source_points: usize,
    pub returned_points: usize,
    pub method: Method,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct ModeProbabilityColumns {
    pub time_s: Vec<f64>,
    pub track_id: Vec<String>,
    /// Place of the model in the request, from 1.
    pub model: Vec<usize>,
    pub probability: Vec<f64>,
}

/// The series of the tracks inside the window.
pub fn of(layers: &JobLayers, window: &Window) -> ModeProbabilitySeries {
    let empty = TrackSet::default();
    let set = layers.tracks.as_ref().unwrap_or(&empty);
    let mut rows: Vec<(&str, &TrackPoint, usize, f64)> = Vec::new();
    for (track_id, point) in points(set, window) {
        for (model, probability) in set.modes_of(point).iter().enumerate() {
            rows.push((track_id, point, model + 1, *probability));
        }
    }
    let probabilities: Vec<f64> = rows.iter().map(|row| row.3).collect();
    let kept = Reduced::min_max(&[&probabilities], window.max_points);
    ModeProbabilitySeries {
        name: ModeProbabilityName::ModeProbability,
        columns: ModeProbabilityColumns {
            time_s: kept.column(|row| rows[row].1.time_s),
            track_id: kept.column(|row| rows[row].0.to_owned()),
            model: kept.column(|row| rows[row].2),
            probability: kept.column(|row| rows[row].3),
        },
        units: BTreeMap::from([("time_s".to_owned(), "s".to_owned())]),
        source_points: kept.source_points,
        returned_points: kept.rows.len(),
        method: kept.method,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::dataset::Dataset;
    use crate::service::views::tests::{everything, read};

    #[test]
    fn every_model_of_every_point_is_a_row() {
        let tracks = "time_s,track_id,x_m,y_m,mode_1,mode_2\n0,t,0,0,0.75,0.25\n1,t,0,0,0.5,0.5\n0,u,0,0,1,0\n";
        let Dataset::Tracks(tracks) = read(tracks) else {
            panic!("not tracks")
        };
        let layers = JobLayers {
            tracks: Some(tracks),
            ..JobLayers::default()
        };
        let window = Window {
            track_id: Some("t".to_owned()),
            ..everything()
        };
        let columns = of(&layers, &window).columns;
        assert_eq!(columns.time_s, [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(columns.model, [1, 2, 1, 2]);
        assert_eq!(columns.probability, [0.75, 0.25, 0.5, 0.5]);
    }
}
