//! Ground truth: where each target really was.

use super::fault::Fault;
use super::state::Position;
use std::f64::consts::{PI, TAU};

/// Where a target was at one time. All points of a set say the same kind of thing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TruthPoint {
    pub time_s: f64,
    pub place: TruePlace,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TruePlace {
    Plane {
        position_m: Position,
        velocity_mps: Option<Position>,
    },
    /// A direction alone, clockwise from north.
    Bearing { bearing_rad: f64 },
}

impl TruthPoint {
    pub fn in_plane(time_s: f64, position_m: Position, velocity_mps: Option<Position>) -> Self {
        TruthPoint {
            time_s,
            place: TruePlace::Plane {
                position_m,
                velocity_mps,
            },
        }
    }

    pub fn at_bearing(time_s: f64, bearing_rad: f64) -> Self {
        TruthPoint {
            time_s,
            place: TruePlace::Bearing { bearing_rad },
        }
    }

    /// `None` where only the direction is known.
    pub fn position_m(&self) -> Option<Position> {
        match self.place {
            TruePlace::Plane { position_m, .. } => Some(position_m),
            TruePlace::Bearing { .. } => None,
        }
    }

    /// `None` where it is not given.
    pub fn velocity_mps(&self) -> Option<Position> {
        match self.place {
            TruePlace::Plane { velocity_mps, .. } => velocity_mps,
            TruePlace::Bearing { .. } => None,
        }
    }

    /// `None` where its place is known.
    pub fn bearing_rad(&self) -> Option<f64> {
        match self.place {
            TruePlace::Plane { .. } => None,
            TruePlace::Bearing { bearing_rad } => Some(bearing_rad),
        }
    }

    fn is_finite(&self) -> bool {
        let is_place_finite = match self.place {
            TruePlace::Plane { position_m, .. } => position_m.iter().all(|value| value.is_finite()),
            TruePlace::Bearing { bearing_rad } => bearing_rad.is_finite(),
        };
        is_place_finite && self.time_s.is_finite()
    }
}

/// One target: its name and its path, times strictly rising.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    pub truth_id: String,
    pub points: Vec<TruthPoint>,
}

impl Target {
    /// Where the target was at `time_s`: the point at that time, else the line between its neighbours if they are
    /// at most `max_gap_s` apart. `None` outside the path, inside longer gaps, and where only directions are known.
    pub fn position_at(&self, time_s: f64, max_gap_s: f64) -> Option<Position> {
        let after = self.points.partition_point(|point| point.time_s < time_s);
        let next = self.points.get(after)?;
        if next.time_s == time_s {
            return next.position_m();
        }
        let last = self.points.get(after.checked_sub(1)?)?;
        let gap_s = next.time_s - last.time_s;
        let share = (time_s - last.time_s) / gap_s;
        let (from_m, to_m) = (last.position_m()?, next.position_m()?);
        (gap_s <= max_gap_s).then(|| from_m + (to_m - from_m) * share)
    }

    /// The direction of the target at `time_s`, found as [`position_at`](Self::position_at) finds a place, the shorter way
    /// round; `None` where places are known instead.
    pub fn bearing_at(&self, time_s: f64, max_gap_s: f64) -> Option<f64> {
        let after = self.points.partition_point(|point| point.time_s < time_s);
        let next = self.points.get(after)?;
        if next.time_s == time_s {
            return next.bearing_rad();
        }
        let last = self.points.get(after.checked_sub(1)?)?;
        let gap_s = next.time_s - last.time_s;
        let share = (time_s - last.time_s) / gap_s;
        let (from_rad, to_rad) = (last.bearing_rad()?, next.bearing_rad()?);
        (gap_s <= max_gap_s)
            .then(|| (from_rad + shorter_way(from_rad, to_rad) * share).rem_euclid(TAU))
    }

    /// How fast its direction turned at `time_s` (rad/s): the slope between the points around that time. `None` where
    /// [`bearing_at`](Self::bearing_at) has none, and for a single point.
    pub fn bearing_rate_at(&self, time_s: f64, max_gap_s: f64) -> Option<f64> {
        let after = self.points.partition_point(|point| point.time_s < time_s);
        let is_point = self.points.get(after)?.time_s == time_s;
        let until = if is_point {
            (after + 1).min(self.points.len() - 1)
        } else {
            after
        };
        let (from, to) = (&self.points[after.saturating_sub(1)], &self.points[until]);
        let gap_s = to.time_s - from.time_s;
        let turned_rad = shorter_way(from.bearing_rad()?, to.bearing_rad()?);
        (gap_s > 0.0 && (is_point || gap_s <= max_gap_s)).then(|| turned_rad / gap_s)
    }

    /// How fast the target was at `time_s`: the given velocity at that time, or on the line between its neighbours; the
    /// slope of the path where velocities are not given. `None` where [`position_at`](Self::position_at) has none, and
    /// for a single point without velocity.
    pub fn velocity_at(&self, time_s: f64, max_gap_s: f64) -> Option<Position> {
        let after = self.points.partition_point(|point| point.time_s < time_s);
        let next = self.points.get(after)?;
        if next.time_s == time_s {
            return next.velocity_mps().or_else(|| {
                self.slope(
                    after.saturating_sub(1),
                    (after + 1).min(self.points.len() - 1),
                )
            });
        }
        let last = self.points.get(after.checked_sub(1)?)?;
        if next.time_s - last.time_s > max_gap_s {
            return None;
        }
        match (last.velocity_mps(), next.velocity_mps()) {
            (Some(from), Some(to)) => {
                Some(from + (to - from) * ((time_s - last.time_s) / (next.time_s - last.time_s)))
            }
            _ => self.slope(after - 1, after),
        }
    }

    fn slope(&self, from: usize, to: usize) -> Option<Position> {
        let (from, to) = (&self.points[from], &self.points[to]);
        let step_m = to.position_m()? - from.position_m()?;
        (to.time_s > from.time_s).then(|| step_m / (to.time_s - from.time_s))
    }

    /// The point nearest to `time_s`, at most `max_gap_s` away; the earlier one of two.
    pub fn nearest_point(&self, time_s: f64, max_gap_s: f64) -> Option<&TruthPoint> {
        let after = self.points.partition_point(|point| point.time_s < time_s);
        let gap_s = |point: &&TruthPoint| (point.time_s - time_s).abs();
        let candidates = [after.checked_sub(1), Some(after)]
            .into_iter()
            .flatten()
            .filter_map(|index| self.points.get(index));
        candidates
            .min_by(|a, b| gap_s(a).total_cmp(&gap_s(b)))
            .filter(|point| gap_s(point) <= max_gap_s)
    }
}

/// From one direction to another, between −π and π.
fn shorter_way(from_rad: f64, to_rad: f64) -> f64 {
    (to_rad - from_rad + PI).rem_euclid(TAU) - PI
}

/// Every target of a scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TruthSet {
    targets: Vec<Target>,
}

impl TruthSet {
    /// # Errors
    /// All faults: a name twice, times that do not rise, values that are not finite.
    pub fn new(targets: Vec<Target>) -> Result<Self, Vec<Fault>> {
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
            Ok(TruthSet { targets })
        } else {
            Err(faults)
        }
    }

    /// Whether its points are directions instead of places.
    pub fn is_of_bearings(&self) -> bool {
        self.targets
            .iter()
            .find_map(|target| target.points.first())
            .is_some_and(|point| point.position_m().is_none())
    }

    pub fn targets(&self) -> &[Target] {
        &self.targets
    }
}
