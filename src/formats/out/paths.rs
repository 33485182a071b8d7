//! Truth and tracks as paths over the Earth: what GeoJSON, KML, CZML and GPX have in common.

use super::WriteError;
use super::earth::{Earth, Spot};
use crate::model::attributes::Attributes;
use crate::model::dataset::Dataset;
use crate::model::space::Place;
use crate::model::track::TrackStatus;
use std::collections::BTreeMap;

/// Silence after which a path begins anew (s), where it is also more than [`GAP_STEPS`] of its usual steps.
const TRUTH_GAP_S: f64 = 600.0;
const TRACK_GAP_S: f64 = 60.0;
const GAP_STEPS: f64 = 5.0;

/// The path of a target or of a track. Of points at one time the last is kept.
pub struct Path<'a> {
    pub id: &'a str,
    /// What else is known of it.
    pub attributes: Option<&'a BTreeMap<&'static str, String>>,
    /// Of its last point.
    pub status: Option<TrackStatus>,
    /// Without silence in between; none is empty.
    pub pieces: Vec<Vec<Spot>>,
}

impl Path<'_> {
    /// What to call it: who it says it is, else its name in the dataset.
    pub fn label(&self) -> &str {
        let known = |name: &str| self.attributes.and_then(|known| known.get(name));
        known("callsign")
            .or_else(|| known("ship_name"))
            .map_or(self.id, String::as_str)
    }

    pub fn spots(&self) -> impl Iterator<Item = &Spot> {
        self.pieces.iter().flatten()
    }

    /// Whether the height is known at some point.
    pub fn has_heights(&self) -> bool {
        self.spots().any(|spot| spot.height_m.is_some())
    }

    /// Gives points without a height that of the point before, those at the start that of the first with one: a line is all in
    /// the air or all on the ground.
    pub fn fill_heights(&mut self) {
        let first = self.spots().find_map(|spot| spot.height_m);
        let mut latest = first;
        for spot in self.pieces.iter_mut().flatten() {
            latest = spot.height_m.or(latest);
            spot.height_m = latest;
        }
    }
}

/// The points of a piece as a line, which has two at least: a lone point is there twice. Readers that make geometries of lines refuse
/// those of one point.
pub fn line(piece: &[Spot]) -> impl Iterator<Item = &Spot> {
    let again = piece.first().filter(|_| piece.len() == 1);
    piece.iter().chain(again)
}

/// The name of what identifies a path.
pub fn id_name(dataset: &Dataset) -> &'static str {
    match dataset {
        Dataset::Tracks(_) => "track_id",
        _ => "truth_id",
    }
}

/// Calls `use_path` with the path of each target or track that has a point.
///
/// # Errors
/// A place that is not on the Earth; what `use_path` says.
pub fn for_each(
    dataset: &Dataset,
    earth: &Earth,
    mut use_path: impl FnMut(Path) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    match dataset {
        Dataset::Truth(truth) => {
            for target in truth.targets() {
                let points = target.points.iter();
                let points = points.map(|point| (point.time_s, &point.position, point.height_m));
                let path = Path {
                    id: &target.truth_id,
                    attributes: attributes(&truth.attributes, &target.truth_id),
                    status: None,
                    pieces: pieces(earth, points, TRUTH_GAP_S)?,
                };
                if !path.pieces.is_empty() {
                    use_path(path)?;
                }
            }
        }
        Dataset::Tracks(set) => {
            for track in &set.tracks {
                let points = track.points.iter();
                let points =
                    points.map(|point| (point.time_s, &point.estimate.position, point.height_m));
                let path = Path {
                    id: &track.track_id,
                    attributes: attributes(&set.attributes, &track.track_id),
                    status: track.points.last().and_then(|point| point.status),
                    pieces: pieces(earth, points, TRACK_GAP_S)?,
                };
                if !path.pieces.is_empty() {
                    use_path(path)?;
                }
            }
        }
        _ => {}
    }
    Ok(())
}

fn attributes<'a>(known: &'a Attributes, id: &str) -> Option<&'a BTreeMap<&'static str, String>> {
    known.get(id)
}

/// First and last time of all points (s), where there is a point.
pub fn span_s(dataset: &Dataset) -> Option<(f64, f64)> {
    let summary = dataset.summary();
    summary.start_s.zip(summary.end_s)
}

fn pieces<'a>(
    earth: &Earth,
    points: impl Iterator<Item = (f64, &'a Place, Option<f64>)>,
    gap_s: f64,
) -> Result<Vec<Vec<Spot>>, WriteError> {
    let mut spots: Vec<Spot> = Vec::new();
    for (time_s, place_m, height_m) in points {
        let spot = earth.spot(time_s, place_m, height_m)?;
        match spots.last_mut() {
            Some(last) if last.time_s == time_s => *last = spot,
            _ => spots.push(spot),
        }
    }
    let gap_s = gap_s.max(GAP_STEPS * usual_step_s(&spots));
    let pieces = spots.chunk_by(|one, next| next.time_s - one.time_s <= gap_s);
    Ok(pieces.map(<[Spot]>::to_vec).collect())
}

/// The median time between neighbours (s), the lower of two; 0 of a single point.
fn usual_step_s(spots: &[Spot]) -> f64 {
    let mut steps: Vec<f64> = spots
        .windows(2)
        .map(|pair| pair[1].time_s - pair[0].time_s)
        .collect();
    if steps.is_empty() {
        return 0.0;
    }
    let middle = (steps.len() - 1) / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}
