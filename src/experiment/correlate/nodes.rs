//! The tracks of each sensor, and which target each of them is of, where that is known.

use super::check::one_sensor;
use super::spec::Spec;
use crate::correlation::alignment::{Assumed, Node};
use crate::experiment::job::refuse_any;
use crate::math::rng::Seed;
use crate::model::fault::Fault;
use crate::model::scan::Recording;
use crate::model::space::Space;
use crate::model::state::Position;
use crate::model::track::TrackSet;
use crate::model::truth::{Target, TruthSet};
use crate::simulation::{LocalTracks, SensorTracks, simulate_local_tracks};
use std::collections::BTreeMap;

/// Truth is interpolated over gaps up to this when tracks are compared with it.
const MAX_TRUTH_GAP_S: f64 = 5.0;

/// Tracks of each sensor with what is true of them.
#[derive(Debug, Clone, Default)]
pub struct Nodes {
    pub nodes: Vec<Node>,
    /// For each track, numbered through, its target.
    pub origins: Option<Vec<Option<u32>>>,
    /// What the targets of `origins` are called.
    pub truth_ids: Vec<String>,
}

/// Drawn tracks, and the truth behind them.
///
/// # Errors
/// Tracks that are nowhere.
pub fn draw_tracks(settings: &LocalTracks, seed: Seed) -> Result<(Nodes, TruthSet), Vec<Fault>> {
    let (sensors, truth) = simulate_local_tracks(settings, seed)?;
    let origins = sensors
        .iter()
        .flat_map(|sensor| sensor.origins.iter().copied())
        .collect();
    let node = |SensorTracks {
                    sensor_id, tracks, ..
                }| Node { sensor_id, tracks };
    let nodes = Nodes {
        nodes: sensors.into_iter().map(node).collect(),
        origins: Some(origins),
        truth_ids: ids_of(&truth),
    };
    Ok((nodes, truth))
}

fn ids_of(truth: &TruthSet) -> Vec<String> {
    let targets = truth.targets().iter();
    targets.map(|target| target.truth_id.clone()).collect()
}

/// Uploaded tracks, or those of other jobs: a set is called by its sensor, or by its place where it has none or several.
pub fn name_sets(sets: Vec<TrackSet>) -> Nodes {
    let name = |(index, tracks): (usize, TrackSet)| {
        let sensor_id = match tracks.sensor_ids.as_slice() {
            [only] => only.clone(),
            _ => format!("set {}", index + 1),
        };
        Node { sensor_id, tracks }
    };
    Nodes {
        nodes: sets.into_iter().enumerate().map(name).collect(),
        ..Nodes::default()
    }
}

/// What makes tracks impossible to compare: every fault, and what is assumed of tracks without covariance.
pub fn check(nodes: &[Node], spec: &Spec, warnings: &mut Vec<String>) -> Result<(), Vec<Fault>> {
    let (is_of_sets, assumed) = (spec.has_sets(), spec.alignment.assumed());
    let mut faults = Vec::new();
    let place = |index: usize| {
        if is_of_sets {
            format!("/sets/{index}")
        } else {
            "/input".to_owned()
        }
    };
    if nodes.len() < 2 {
        faults.push(one_sensor(spec.place(), nodes.len()));
    }
    for (index, node) in nodes.iter().enumerate() {
        let name = &node.sensor_id;
        if nodes[..index].iter().any(|other| other.sensor_id == *name) {
            let detail = format!(
                "two sets are of sensor '{name}', whose tracks are not put together with each other"
            );
            faults.push(Fault::new(place(index), "duplicate", detail).allowing("each sensor once"));
        }
        if !node.tracks.space.has_places() {
            let detail = format!(
                "the tracks of '{name}' are directions (bearing_deg), which are not compared with places"
            );
            faults.push(
                Fault::new(place(index), "unsupported", detail)
                    .allowing("tracks in the plane (x_m, y_m)"),
            );
            continue;
        }
        let lacking = lacking_covariance(&node.tracks);
        match assumed {
            _ if lacking == 0 => {}
            Some(Assumed { sigma_m, sigma_mps }) => {
                let of_velocity = sigma_mps
                    .map_or("their velocities are not used".to_owned(), |sigma| {
                        format!("{sigma} m/s")
                    });
                warnings.push(format!("{lacking} points of '{name}' carry no covariance: σ = {sigma_m} m is assumed, {of_velocity}"));
            }
            None => {
                let detail = format!(
                    "{lacking} points of '{name}' carry no covariance, and nothing is assumed in its place"
                );
                faults.push(
                    Fault::new(place(index), "missing", detail)
                        .allowing("columns p_xx … p_vyvy, or alignment/sigma_m"),
                );
            }
        }
    }
    refuse_any(faults)
}

fn lacking_covariance(tracks: &TrackSet) -> usize {
    let points = tracks.tracks.iter().flat_map(|track| &track.points);
    points
        .filter(|point| point.estimate.covariance.is_none())
        .count()
}

/// For each track of one sensor the target of most of its detections.
pub fn by_detections(tracks: &TrackSet, recording: &Recording) -> Vec<Option<u32>> {
    let mut targets = Vec::with_capacity(tracks.tracks.len());
    let index = recording.index_detections();
    for track in &tracks.tracks {
        let detections = track
            .points
            .iter()
            .filter_map(|point| tracks.most_probable(point)?.detection);
        targets.push(most_frequent(
            detections.map(|detection| index.get(detection as usize)?.origin),
        ));
    }
    targets
}

impl Nodes {
    /// With the targets that tracks are near.
    pub fn by_truth(self, truth: &TruthSet, gate_m: f64) -> Nodes {
        Nodes {
            origins: Some(nearest_targets(&self.nodes, truth, gate_m)),
            truth_ids: ids_of(truth),
            ..self
        }
    }
}

/// For each track, numbered through, the target that is nearest to most of its points, within the gate.
fn nearest_targets(nodes: &[Node], truth: &TruthSet, gate_m: f64) -> Vec<Option<u32>> {
    let mut targets = Vec::new();
    // Directions are near to nothing.
    let known = if truth.space().has_places() {
        truth.targets()
    } else {
        &[]
    };
    for track in nodes.iter().flat_map(|node| &node.tracks.tracks) {
        let places = track
            .points
            .iter()
            .map(|point| (point.time_s, point.estimate.position_m()));
        targets.push(most_frequent(places.map(|(time_s, position_m)| {
            nearest_target(known, time_s, position_m, gate_m)
        })));
    }
    targets
}

fn nearest_target(
    targets: &[Target],
    time_s: f64,
    position_m: Position,
    gate_m: f64,
) -> Option<u32> {
    let distance_m = |(index, target): (usize, &Target)| {
        let true_m = target.position_at(Space::Plane, time_s, MAX_TRUTH_GAP_S)?;
        let distance_m = (true_m.xy() - position_m).norm();
        (distance_m <= gate_m).then_some((distance_m, index as u32))
    };
    let near = targets.iter().enumerate().filter_map(distance_m);
    near.min_by(|left, right| left.0.total_cmp(&right.0))
        .map(|(_, index)| index)
}

/// The most frequent, "none" included; the smaller of two.
fn most_frequent(found: impl Iterator<Item = Option<u32>>) -> Option<u32> {
    let mut counts: BTreeMap<Option<u32>, usize> = BTreeMap::new();
    found.for_each(|origin| *counts.entry(origin).or_default() += 1);
    let most = counts.values().copied().max()?;
    counts
        .into_iter()
        .find(|(_, count)| *count == most)
        .and_then(|(origin, _)| origin)
}
