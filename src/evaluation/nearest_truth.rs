//! Symbols for recordings whose detections have no origin: the target nearest to the track.
//!
//! A target is where the truth says at the time of a scan, or on the line between its two neighbouring points if they
//! are at most `max_gap_s` apart; else it does not exist at that scan. Metrics see it so too. The symbol of a track point is the nearest
//! target, each at the time of the point, with a distance of at most `gate_m`, ties to the smaller id, ε when there is none. It is not one to one: two
//! tracks may take the same target at the same scan. The truth string of a target is the target itself at each scan at
//! which it exists.
//!
//! With a recording, targets that exist at none of its scans were never watched and are left out.

use super::axis::Axis;
use super::id_order;
use super::nearest_point::{Place, PlaceTree};
use super::paths::Paths;
use crate::model::allowance::{MAX_POINTS, too_large};
use crate::model::fault::Fault;
use crate::model::space::{self, Space};
use std::cell::OnceCell;

pub struct NearestTruth<'a> {
    /// The targets that count, by their places in the truth; symbols are indices into them.
    pub targets: Vec<usize>,
    /// For each of them, the scans at which it exists.
    pub scans_of_target: Vec<Vec<usize>>,
    /// How many targets were left out.
    pub never_watched: usize,
    space: Space,
    gate_m: f64,
    trees: Vec<PlaceTree>,
    paths: Paths<'a>,
    /// Of each target that counts, its rank by name.
    ranks: Vec<u32>,
    /// Of each scan, how far a target goes in its window.
    farthest_m: Vec<OnceCell<f64>>,
    tolerance_s: f64,
}

impl<'a> NearestTruth<'a> {
    /// Distances are of `space`.
    ///
    /// # Errors
    /// When the targets exist at more scans, one after the other, than may be held.
    pub fn new(
        paths: Paths<'a>,
        space: Space,
        axis: &Axis,
        gate_m: f64,
        keep_all: bool,
    ) -> Result<Self, Vec<Fault>> {
        let names = paths
            .targets()
            .iter()
            .map(|target| target.truth_id.as_str());
        let mut places: Vec<Vec<Place>> = vec![Vec::new(); axis.scans().len()];
        let (mut targets, mut ranks, mut scans_of_target) = (Vec::new(), Vec::new(), Vec::new());
        let (mut never_watched, mut points) = (0, 0);
        for (target, rank) in id_order::ranks(names).into_iter().enumerate() {
            let path = positions_on(axis, &paths, target);
            if path.is_empty() && !keep_all {
                never_watched += 1;
                continue;
            }
            points += path.len();
            if points > MAX_POINTS {
                return Err(vec![too_many(points)]);
            }
            let index = targets.len() as u32;
            for &(scan, position_m) in &path {
                let position_m = space.cut(position_m);
                places[scan].push(Place {
                    position_m,
                    index,
                    rank,
                });
            }
            targets.push(target);
            ranks.push(rank);
            scans_of_target.push(path.into_iter().map(|(scan, _)| scan).collect());
        }
        Ok(NearestTruth {
            targets,
            scans_of_target,
            never_watched,
            space,
            gate_m,
            farthest_m: vec![OnceCell::new(); places.len()],
            trees: places.into_iter().map(PlaceTree::new).collect(),
            paths,
            ranks,
            tolerance_s: axis.tolerance_s(),
        })
    }

    /// The symbol of a track that is at `position_m` at a time that belongs to a scan.
    pub fn symbol(
        &self,
        axis: &Axis,
        scan: usize,
        time_s: f64,
        position_m: &space::Place,
    ) -> Option<u32> {
        let (wanted, scan_s) = (self.space.cut(*position_m), axis.scans()[scan].time_s);
        if time_s == scan_s {
            return self.trees[scan].nearest(&wanted, self.gate_m);
        }
        let farthest_m = *self.farthest_m[scan].get_or_init(|| self.farthest_at(axis, scan));
        let mut best = (self.gate_m, u32::MAX, None);
        self.trees[scan].for_each_within(&wanted, self.gate_m + farthest_m, &mut |place| {
            let (target, rank) = self.target_of(place);
            let times_s = (scan_s, time_s - scan_s);
            let Some((there, _)) = self.paths.after(target, times_s, self.tolerance_s) else {
                return;
            };
            let distance_m = (self.space.cut(there) - wanted).norm();
            if distance_m < best.0 || (distance_m == best.0 && rank < best.1) {
                best = (distance_m, rank, Some(place.index));
            }
        });
        best.2
    }

    fn target_of(&self, place: &Place) -> (usize, u32) {
        let index = place.index as usize;
        (self.targets[index], self.ranks[index])
    }

    fn farthest_at(&self, axis: &Axis, scan: usize) -> f64 {
        let (scan_s, window_s) = (axis.scans()[scan].time_s, axis.window_s(scan));
        let mut farthest_m = 0.0f64;
        for place in self.trees[scan].places() {
            let (target, _) = self.target_of(place);
            let far_m = self
                .paths
                .farthest_m(target, scan_s, window_s, self.tolerance_s);
            farthest_m = farthest_m.max(far_m);
        }
        farthest_m
    }
}

fn too_many(points: usize) -> Fault {
    let remedy = "a part of the steps in each job, or a smaller max_gap_s";
    too_large(
        "/truth",
        "points of truth at the steps",
        points,
        MAX_POINTS,
        remedy,
    )
}

/// The scans at which a target exists, and where it is then.
fn positions_on(axis: &Axis, paths: &Paths, target: usize) -> Vec<(usize, space::Place)> {
    let tolerance_s = axis.tolerance_s();
    let Some((from_s, to_s)) = paths.span_s(target, tolerance_s) else {
        return Vec::new();
    };
    let from = axis.scans().partition_point(|scan| scan.time_s < from_s);
    let mut found = Vec::new();
    for (index, scan) in axis.scans().iter().enumerate().skip(from) {
        if scan.time_s > to_s {
            break;
        }
        let standing = paths.at(target, scan.time_s, tolerance_s);
        found.extend(standing.map(|(place, _)| (index, place)));
    }
    found
}
