//! Ground truth: where each target really was.

use super::attributes::Attributes;
use super::changes::Changes;
use super::fault::Fault;
use super::space::{Frame, Place, Space};
use super::state::Position;
use super::time::{TimeBase, rounding_s};

/// Where a target was at one time. All points of a set are of its space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TruthPoint {
    pub time_s: f64,
    pub position: Place,
    pub velocity: Option<Place>,
    /// Of a set in the plane: how high the target was, where that is known. No distance reads it.
    pub height_m: Option<f64>,
}

impl TruthPoint {
    pub fn in_plane(time_s: f64, position_m: Position, velocity_mps: Option<Position>) -> Self {
        TruthPoint {
            height_m: None,
            time_s,
            position: position_m.push(0.0),
            velocity: velocity_mps.map(|velocity_mps| velocity_mps.push(0.0)),
        }
    }

    pub fn in_space(time_s: f64, position: Place, velocity: Place) -> Self {
        TruthPoint {
            height_m: None,
            time_s,
            position,
            velocity: Some(velocity),
        }
    }

    pub fn at_bearing(time_s: f64, bearing_rad: f64) -> Self {
        TruthPoint {
            height_m: None,
            time_s,
            position: Place::new(bearing_rad, 0.0, 0.0),
            velocity: None,
        }
    }

    fn is_finite(&self) -> bool {
        self.position.iter().all(|value| value.is_finite()) && self.time_s.is_finite()
    }
}

/// One target: its name and its path, times strictly rising.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    pub truth_id: String,
    pub points: Vec<TruthPoint>,
}

impl Target {
    /// Where the target was at `time_s`: the point at that time, else the line between its neighbours, the shorter way round, if
    /// they are at most `max_gap_s` apart. `None` outside the path and inside longer gaps.
    pub fn position_at(&self, space: Space, time_s: f64, max_gap_s: f64) -> Option<Place> {
        let after = self.points.partition_point(|point| point.time_s < time_s);
        let next = self.points.get(after)?;
        if next.time_s == time_s {
            return Some(next.position);
        }
        let last = self.points.get(after.checked_sub(1)?)?;
        let gap_s = next.time_s - last.time_s;
        let share = (time_s - last.time_s) / gap_s;
        let step = space.difference(&last.position, &next.position);
        (gap_s <= max_gap_s).then(|| space.normal(last.position + step * share))
    }

    /// How fast the target was at `time_s`: the given velocity at that time, or on the line between its neighbours; the
    /// slope of the path where velocities are not given. `None` where [`position_at`](Self::position_at) has none, and
    /// for a single point without velocity.
    pub fn velocity_at(&self, space: Space, time_s: f64, max_gap_s: f64) -> Option<Place> {
        let after = self.points.partition_point(|point| point.time_s < time_s);
        let next = self.points.get(after)?;
        if next.time_s == time_s {
            let until = (after + 1).min(self.points.len() - 1);
            let slope = || self.slope(space, after.saturating_sub(1), until);
            return next.velocity.or_else(slope);
        }
        let last = self.points.get(after.checked_sub(1)?)?;
        if next.time_s - last.time_s > max_gap_s {
            return None;
        }
        match (last.velocity, next.velocity) {
            (Some(from), Some(to)) => {
                Some(from + (to - from) * ((time_s - last.time_s) / (next.time_s - last.time_s)))
            }
            _ => self.slope(space, after - 1, after),
        }
    }

    fn slope(&self, space: Space, from: usize, to: usize) -> Option<Place> {
        let (from, to) = (&self.points[from], &self.points[to]);
        let gap_s = to.time_s - from.time_s;
        (gap_s > 0.0).then(|| space.difference(&from.position, &to.position) / gap_s)
    }

    /// The point nearest to `time_s`, at most `max_gap_s` away; the earlier one of two.
    pub fn nearest_point(&self, time_s: f64, max_gap_s: f64) -> Option<&TruthPoint> {
        let after = self.points.partition_point(|point| point.time_s < time_s);
        let gap_s = |point: &&TruthPoint| (point.time_s - time_s).abs();
        let before = after.checked_sub(1).map(|before| &self.points[before]);
        let next = self.points.get(after);
        let nearest = match (before, next) {
            (Some(before), Some(next)) if gap_s(&before) > gap_s(&next) + rounding_s(time_s) => {
                next
            }
            (before, next) => before.or(next)?,
        };
        Some(nearest).filter(|point| gap_s(point) <= max_gap_s)
    }
}

/// Every target of a scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TruthSet {
    space: Space,
    pub frame: Option<Frame>,
    pub time_base: TimeBase,
    /// What is known of targets besides, by their names.
    pub attributes: Attributes,
    /// Of attributes that are not the same at all points.
    pub changes: Changes,
    targets: Vec<Target>,
}

impl TruthSet {
    /// # Errors
    /// All faults: a name twice, times that do not rise, values that are not finite.
    pub fn new(space: Space, targets: Vec<Target>) -> Result<Self, Vec<Fault>> {
        let mut faults = Vec::new();
        let mut names = std::collections::BTreeSet::new();
        for target in &targets {
            let pointer = format!("/targets/{}", target.truth_id);
            if !names.insert(target.truth_id.as_str()) {
                faults.push(Fault::new(
                    pointer.clone(),
                    "duplicate",
                    format!("target '{}' occurs twice", target.truth_id),
                ));
            }
            if target
                .points
                .windows(2)
                .any(|pair| pair[0].time_s >= pair[1].time_s)
            {
                faults.push(Fault::new(
                    pointer.clone(),
                    "unsorted",
                    format!("the times of target '{}' do not rise", target.truth_id),
                ));
            }
            if target.points.iter().any(|point| !point.is_finite()) {
                faults.push(Fault::new(
                    pointer,
                    "not_finite",
                    format!(
                        "target '{}' has a value that is not a finite number",
                        target.truth_id
                    ),
                ));
            }
        }
        if faults.is_empty() {
            let has_points = targets.iter().any(|target| !target.points.is_empty());
            Ok(TruthSet {
                space: space.of_points(has_points),
                targets,
                ..TruthSet::default()
            })
        } else {
            Err(faults)
        }
    }

    pub fn space(&self) -> Space {
        self.space
    }

    /// The same scene with some of its targets, or parts of them, alone.
    pub fn with_targets(&self, targets: Vec<Target>) -> TruthSet {
        TruthSet {
            targets,
            space: self.space,
            frame: self.frame,
            time_base: self.time_base,
            attributes: self.attributes.clone(),
            changes: self.changes.clone(),
        }
    }

    pub fn targets(&self) -> &[Target] {
        &self.targets
    }
}
