//! Symbols for recordings whose detections have no origin: the target nearest to the track.
//!
//! A target is where the truth says at the time of a scan, or on the line between its two neighbouring points if they
//! are at most `max_gap_s` apart; else it does not exist at that scan. Metrics see it so too. The symbol of a track point is the nearest
//! target with a distance of at most `gate_m`, ties to the smaller id, ε when there is none. It is not one to one: two
//! tracks may take the same target at the same scan. The truth string of a target is the target itself at each scan at
//! which it exists.
//!
//! With a recording, targets that exist at none of its scans were never watched and are left out.

use super::axis::Axis;
use super::comparison::Alignment;
use super::id_order;
use super::nearest_point::{Place, PlaceTree};
use crate::model::allowance::{MAX_POINTS, too_large};
use crate::model::fault::Fault;
use crate::model::space::{self, Space};
use crate::model::truth::{Target, TruthSet};

pub struct NearestTruth<'a> {
    /// The targets that count; symbols are indices into them.
    pub target_ids: Vec<&'a str>,
    /// For each of them, the scans at which it exists.
    pub scans_of_target: Vec<Vec<usize>>,
    /// How many targets were left out.
    pub never_watched: usize,
    space: Space,
    gate_m: f64,
    trees: Vec<PlaceTree>,
}

impl<'a> NearestTruth<'a> {
    /// Distances are of `space`.
    ///
    /// # Errors
    /// When the targets exist at more scans, one after the other, than may be held.
    pub fn new(
        truth: &'a TruthSet,
        space: Space,
        axis: &Axis,
        (gate_m, max_gap_s): (f64, f64),
        keep_all: bool,
    ) -> Result<Self, Vec<Fault>> {
        let ranks = id_order::ranks(
            truth
                .targets()
                .iter()
                .map(|target| target.truth_id.as_str()),
        );
        let mut places: Vec<Vec<Place>> = vec![Vec::new(); axis.scans().len()];
        let (mut target_ids, mut scans_of_target, mut never_watched, mut points) =
            (Vec::new(), Vec::new(), 0, 0);
        for (target, rank) in truth.targets().iter().zip(ranks) {
            let index = target_ids.len() as u32;
            let path = positions_on(axis, truth.space(), target, max_gap_s);
            if path.is_empty() && !keep_all {
                never_watched += 1;
                continue;
            }
            points += path.len();
            if points > MAX_POINTS {
                let remedy = "a part of the steps in each job, or a smaller max_gap_s";
                return Err(vec![too_large(
                    "/truth",
                    "points of truth at the steps",
                    points,
                    MAX_POINTS,
                    remedy,
                )]);
            }
            for &(scan, position_m) in &path {
                places[scan].push(Place {
                    position_m: space.cut(position_m),
                    index,
                    rank,
                });
            }
            target_ids.push(target.truth_id.as_str());
            scans_of_target.push(path.into_iter().map(|(scan, _)| scan).collect());
        }
        let trees = places.into_iter().map(PlaceTree::new).collect();
        Ok(NearestTruth {
            target_ids,
            scans_of_target,
            never_watched,
            space,
            gate_m,
            trees,
        })
    }

    /// The symbol of a track that is at `position_m` at a scan.
    pub fn symbol(&self, scan: usize, position_m: &space::Place) -> Option<u32> {
        self.trees[scan].nearest(&self.space.cut(*position_m), self.gate_m)
    }
}

/// The scans at which a target exists, and where it is then.
fn positions_on(
    axis: &Axis,
    space: Space,
    target: &Target,
    max_gap_s: f64,
) -> Vec<(usize, space::Place)> {
    let (Some(first), Some(last)) = (target.points.first(), target.points.last()) else {
        return Vec::new();
    };
    let (alignment, tolerance_s) = (Alignment::Interpolate { max_gap_s }, axis.tolerance_s());
    let from = axis
        .scans()
        .partition_point(|scan| scan.time_s < first.time_s - tolerance_s);
    let scans = axis
        .scans()
        .iter()
        .enumerate()
        .skip(from)
        .take_while(|(_, scan)| scan.time_s <= last.time_s + tolerance_s);
    scans
        .filter_map(|(index, scan)| {
            let place = alignment.place(space, target, scan.time_s, tolerance_s)?;
            Some((index, place.0))
        })
        .collect()
}
