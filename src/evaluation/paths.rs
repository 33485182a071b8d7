//! Where the targets of a truth are at any time.
//!
//! # Method
//! - A target is on the line between its two neighbouring points, or at the nearest one in time, as [`Alignment`] says.
//! - Nobody exists before his first point or behind his last one.
//! - Points farther apart than `max_gap_s` are not bridged. Where nobody says it, that is 2.5 times the median time between
//!   two points of the target: one that is missing is bridged, an absence is not.

use super::spaces;
use crate::model::space::{Place, Space};
use crate::model::state::Position;
use crate::model::time::rounding_s;
use crate::model::truth::{Target, TruthSet};
use serde::Deserialize;
use std::borrow::Cow;

/// How truth is brought to the times of the steps.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(tag = "method", rename_all = "snake_case")]
pub enum Alignment {
    /// On the line between two points at most `max_gap_s` apart.
    Interpolate { max_gap_s: Option<f64> },
    /// The nearest point in time, at most `max_gap_s` away; the earlier one of two.
    Nearest { max_gap_s: Option<f64> },
}

/// A target's place, and its velocity where that is known.
pub type Standing = (Place, Option<Place>);

/// Of the median time between two points of a target.
const BRIDGED_GAPS: f64 = 2.5;

impl Alignment {
    pub fn max_gap_s(self) -> Option<f64> {
        let (Alignment::Interpolate { max_gap_s } | Alignment::Nearest { max_gap_s }) = self;
        max_gap_s
    }
}

/// The paths of all targets.
#[derive(Debug, Clone)]
pub struct Paths<'t> {
    truth: Cow<'t, TruthSet>,
    alignment: Alignment,
    /// Of each target the longest gap that is bridged.
    limits_s: Vec<f64>,
}

impl<'t> Paths<'t> {
    pub fn new(truth: &'t TruthSet, alignment: Alignment) -> Self {
        let limit_s = |target: &Target| {
            let limit_s = alignment.max_gap_s().or_else(|| usual_limit_s(target));
            // A gap is the difference of two times that were rounded.
            let last_s = target.points.last().map_or(0.0, |point| point.time_s);
            limit_s.map_or(0.0, |limit_s| limit_s + rounding_s(last_s))
        };
        Paths {
            truth: Cow::Borrowed(truth),
            alignment,
            limits_s: truth.targets().iter().map(limit_s).collect(),
        }
    }

    /// With a truth of their own.
    pub fn into_owned(self) -> Paths<'static> {
        Paths {
            truth: Cow::Owned(self.truth.into_owned()),
            alignment: self.alignment,
            limits_s: self.limits_s,
        }
    }

    pub fn targets(&self) -> &[Target] {
        self.truth.targets()
    }

    pub fn space(&self) -> Space {
        self.truth.space()
    }

    /// From when to when a target exists; `None` without points.
    pub fn span_s(&self, target: usize, tolerance_s: f64) -> Option<(f64, f64)> {
        let points = &self.targets()[target].points;
        let (first, last) = (points.first()?, points.last()?);
        let tolerance_s = rounded_up(tolerance_s, last.time_s);
        Some((first.time_s - tolerance_s, last.time_s + tolerance_s))
    }

    /// Where a target is; a point within the tolerance counts as at that time where the path does not say more.
    pub fn at(&self, target: usize, time_s: f64, tolerance_s: f64) -> Option<Standing> {
        let (space, limit_s) = (self.space(), self.limits_s[target]);
        let (from_s, to_s) = self.span_s(target, tolerance_s)?;
        if time_s < from_s || time_s > to_s {
            return None;
        }
        let tolerance_s = rounded_up(tolerance_s, time_s);
        let target = &self.targets()[target];
        let at_point = |limit_s: f64| {
            let point = target.nearest_point(time_s, limit_s)?;
            let velocity = target.velocity_at(space, point.time_s, f64::INFINITY);
            Some((point.position, velocity))
        };
        match self.alignment {
            Alignment::Interpolate { .. } => match target.position_at(space, time_s, limit_s) {
                Some(position) => Some((position, target.velocity_at(space, time_s, limit_s))),
                None => at_point(tolerance_s),
            },
            Alignment::Nearest { .. } => at_point(limit_s.max(tolerance_s)),
        }
    }

    /// Where a target that exists at a time is so much later: along its path, and where that does not say, by its velocity.
    pub fn after(
        &self,
        target: usize,
        (time_s, after_s): (f64, f64),
        tolerance_s: f64,
    ) -> Option<Standing> {
        self.at(target, time_s + after_s, 0.0).or_else(|| {
            let (place, velocity) = self.at(target, time_s, tolerance_s)?;
            let moved = place + velocity.unwrap_or_default() * after_s;
            Some((self.space().normal(moved), velocity))
        })
    }

    /// How far a target goes from where it is at a time while others may be compared with it.
    pub fn farthest_m(
        &self,
        target: usize,
        time_s: f64,
        (from_s, to_s): (f64, f64),
        tolerance_s: f64,
    ) -> f64 {
        let points = &self.targets()[target].points;
        let first = points.partition_point(|point| point.time_s < from_s);
        let inside = points[first..]
            .iter()
            .take_while(|point| point.time_s <= to_s);
        let Some((start, _)) = self.at(target, time_s, tolerance_s) else {
            return 0.0;
        };
        let mut farthest_m = 0.0f64;
        for at_s in [from_s, to_s]
            .into_iter()
            .chain(inside.map(|point| point.time_s))
        {
            if let Some((place, _)) = self.after(target, (time_s, at_s - time_s), tolerance_s) {
                farthest_m = farthest_m.max((place - start).norm());
            }
        }
        farthest_m
    }

    /// The times at which any target exists, as rising stretches that do not touch.
    pub fn stretches_s(&self) -> Vec<(f64, f64)> {
        let mut pieces = Vec::new();
        for (target, &limit_s) in self.targets().iter().zip(&self.limits_s) {
            add_pieces(target, limit_s, self.alignment, &mut pieces);
        }
        pieces.sort_unstable_by(|a: &(f64, f64), b| a.0.total_cmp(&b.0));
        let mut stretches: Vec<(f64, f64)> = Vec::new();
        for (from_s, to_s) in pieces {
            match stretches.last_mut() {
                Some((_, last_s)) if from_s <= *last_s => *last_s = to_s.max(*last_s),
                _ => stretches.push((from_s, to_s)),
            }
        }
        stretches
    }
}

/// Which targets are within a gate of a place: paths with the box around each, so that most need no look.
pub struct Reach<'t> {
    paths: Paths<'t>,
    gate: f64,
    boxes: Vec<(Position, Position)>,
}

impl<'t> Reach<'t> {
    /// The gate is in metres, of directions in degrees.
    pub fn new(paths: Paths<'t>, gate: f64) -> Self {
        let everywhere = Position::repeat(f64::INFINITY);
        let boxes = paths.targets().iter().map(|target| match paths.space() {
            // Directions repeat after a turn.
            Space::Bearing => (-everywhere, everywhere),
            Space::Plane | Space::Volume => box_around(target, gate),
        });
        Reach {
            boxes: boxes.collect(),
            paths,
            gate,
        }
    }

    pub fn space(&self) -> Space {
        self.paths.space()
    }

    /// Whether any target is within the gate of a place at a time; the place is as it is compared in `space`.
    pub fn is_near(&self, space: Space, time_s: f64, place: &Place) -> bool {
        self.near(space, time_s, place).next().is_some()
    }

    /// Whether some targets are within the gate, and none of them is due.
    pub fn is_near_only(
        &self,
        space: Space,
        time_s: f64,
        place: &Place,
        is_due: impl Fn(usize) -> bool,
    ) -> bool {
        let mut near = self.near(space, time_s, place).peekable();
        near.peek().is_some() && !near.any(is_due)
    }

    fn near(&self, space: Space, time_s: f64, place: &Place) -> impl Iterator<Item = usize> {
        let (plane, place) = (place.xy(), *place);
        let boxes = self.boxes.iter().enumerate();
        let in_box = boxes.filter(move |(_, (low, high))| plane >= *low && plane <= *high);
        in_box.map(|(target, _)| target).filter(move |target| {
            let standing = self.paths.at(*target, time_s, rounding_s(time_s));
            standing.is_some_and(|(there, _)| {
                spaces::distance(space, &spaces::compared(space, &there), &place) <= self.gate
            })
        })
    }
}

/// What is within a tolerance but for rounding is within it; no tolerance is none.
fn rounded_up(tolerance_s: f64, time_s: f64) -> f64 {
    if tolerance_s > 0.0 {
        tolerance_s + rounding_s(time_s)
    } else {
        0.0
    }
}

fn box_around(target: &Target, gate: f64) -> (Position, Position) {
    let mut low = Position::repeat(f64::INFINITY);
    let mut high = -low;
    for point in &target.points {
        let place = point.position.xy();
        (low, high) = (low.inf(&place), high.sup(&place));
    }
    let margin = Position::repeat(gate);
    (low - margin, high + margin)
}

/// The stretches of one target.
fn add_pieces(target: &Target, limit_s: f64, alignment: Alignment, pieces: &mut Vec<(f64, f64)>) {
    let longest_s = match alignment {
        Alignment::Interpolate { .. } => limit_s,
        // Each point reaches so far to its side.
        Alignment::Nearest { .. } => 2.0 * limit_s,
    };
    for piece in target
        .points
        .chunk_by(|before, after| after.time_s - before.time_s <= longest_s)
    {
        if let (Some(first), Some(last)) = (piece.first(), piece.last()) {
            pieces.push((first.time_s, last.time_s));
        }
    }
}

/// The times between the points of a target that follow each other, rising.
pub fn gaps_s(target: &Target) -> Vec<f64> {
    let pairs = target.points.windows(2);
    let mut gaps_s: Vec<f64> = pairs.map(|pair| pair[1].time_s - pair[0].time_s).collect();
    gaps_s.sort_unstable_by(f64::total_cmp);
    gaps_s
}

/// The middle one of rising values, the lower of two.
pub fn median(rising: &[f64]) -> Option<f64> {
    rising.get(rising.len().saturating_sub(1) / 2).copied()
}

fn usual_limit_s(target: &Target) -> Option<f64> {
    Some(BRIDGED_GAPS * median(&gaps_s(target))?)
}
