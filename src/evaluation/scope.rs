//! What is judged of truth and tracks: where, when, and whom. What lies outside is left out and counted: a target there is not
//! missed, and a track there is not false.
//!
//! # Method
//! 1. A point of the truth is due where it lies in the area, in the heights, in the window of time, and is of a listed target; these
//!    points are a truth of their own, with paths and steps of their own.
//! 2. A point of a track outside the window of time is left out.
//! 3. Else it is judged where it is within the gate of a target that is due at its time; left out where it is within the gate of one
//!    that is not; and otherwise judged where it lies in the area itself.
//!
//! So a target that crosses the edge costs nothing on either side of it, and a false track outside costs nothing.

use super::paths::{Alignment, Paths, Reach};
use crate::model::sight::{Limits, Spot};
use crate::model::space::{Place, Space};
use crate::model::state::Position;
use crate::model::track::{TrackPoint, TrackSet};
use crate::model::truth::{Target, TruthSet};
use std::collections::BTreeSet;

/// Where targets are due; in metres, x east and y north.
#[derive(Debug, Clone, PartialEq)]
pub enum Area {
    /// Its corners in order, at least three; points on the edge are in it.
    Polygon(Vec<Position>),
    /// Ranges and bearings (clockwise from north, in radians, over north where `from` is larger than `to`) about a place.
    Sector {
        centre: Position,
        range_m: (f64, f64),
        bearings_rad: Option<(f64, f64)>,
    },
    /// What a sensor sees from its place.
    Coverage { from: Position, limits: Limits },
}

/// What is judged.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scope {
    pub from_s: Option<f64>,
    pub to_s: Option<f64>,
    /// Names of targets; `None` is all.
    pub targets: Option<BTreeSet<String>>,
    /// In any of them; none is everywhere.
    pub areas: Vec<Area>,
    /// Heights of a volume.
    pub height_m: (Option<f64>, Option<f64>),
}

/// How much was left out.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LeftOut {
    pub truth_points: usize,
    pub track_points: usize,
    /// Targets and tracks of which nothing was kept.
    pub targets: usize,
    pub tracks: usize,
}

impl Area {
    /// How large it is; `None` of what a sensor covers.
    pub fn size_m2(&self) -> Option<f64> {
        match self {
            Area::Polygon(corners) => {
                let mut before = corners[corners.len() - 1];
                let mut twice_m2 = 0.0;
                for &corner in corners {
                    twice_m2 += before.x * corner.y - corner.x * before.y;
                    before = corner;
                }
                Some(0.5 * twice_m2.abs())
            }
            Area::Sector {
                range_m: (from_m, to_m),
                bearings_rad,
                ..
            } => {
                let full_rad = std::f64::consts::TAU;
                let width_rad =
                    bearings_rad.map_or(full_rad, |(from, to)| (to - from).rem_euclid(full_rad));
                Some(0.5 * width_rad * (to_m * to_m - from_m * from_m))
            }
            Area::Coverage { .. } => None,
        }
    }

    pub fn holds(&self, place: &Position) -> bool {
        match self {
            Area::Polygon(corners) => is_inside(corners, place),
            Area::Sector {
                centre,
                range_m: (from_m, to_m),
                bearings_rad,
            } => {
                let away = place - centre;
                let is_at_range = (*from_m..=*to_m).contains(&away.norm());
                is_at_range && bearings_rad.is_none_or(|bearings| is_between(away, bearings))
            }
            Area::Coverage { from, limits } => limits.hold(&Spot::of_place(place, from)),
        }
    }
}

/// Clockwise from the first bearing to the second.
fn is_between(away: Position, (from_rad, to_rad): (f64, f64)) -> bool {
    let full = std::f64::consts::TAU;
    let bearing = away.x.atan2(away.y);
    (bearing - from_rad).rem_euclid(full) <= (to_rad - from_rad).rem_euclid(full)
}

/// A ray to the east crosses the edges of a polygon around it an odd number of times.
fn is_inside(corners: &[Position], place: &Position) -> bool {
    let mut is_inside = false;
    let mut before = corners[corners.len() - 1];
    for &corner in corners {
        let side = (corner.x - before.x) * (place.y - before.y)
            - (place.x - before.x) * (corner.y - before.y);
        let is_within = |a: f64, b: f64, value: f64| value >= a.min(b) && value <= a.max(b);
        if side == 0.0
            && is_within(before.x, corner.x, place.x)
            && is_within(before.y, corner.y, place.y)
        {
            return true;
        }
        let goes_up = before.y <= place.y && place.y < corner.y;
        let goes_down = corner.y <= place.y && place.y < before.y;
        if (goes_up && side < 0.0) || (goes_down && side > 0.0) {
            is_inside = !is_inside;
        }
        before = corner;
    }
    is_inside
}

impl Scope {
    fn holds_time(&self, time_s: f64) -> bool {
        self.from_s.is_none_or(|from_s| time_s >= from_s)
            && self.to_s.is_none_or(|to_s| time_s <= to_s)
    }

    fn holds_place(&self, space: Space, place: &Place) -> bool {
        let is_at_height = space != Space::Volume
            || (self.height_m.0.is_none_or(|least_m| place.z >= least_m)
                && self.height_m.1.is_none_or(|most_m| place.z <= most_m));
        is_at_height
            && (self.areas.is_empty() || self.areas.iter().any(|area| area.holds(&place.xy())))
    }

    fn holds_target(&self, name: &str) -> bool {
        self.targets
            .as_ref()
            .is_none_or(|names| names.contains(name))
    }

    /// The truth that is due and the tracks that are judged beside it, within `gate_m` and with paths by `alignment`.
    pub fn restrict(
        &self,
        truth: &TruthSet,
        tracks: &TrackSet,
        (gate_m, alignment): (f64, Alignment),
    ) -> (TruthSet, TrackSet, LeftOut) {
        let mut left_out = LeftOut::default();
        let due = self.due(truth, &mut left_out);
        let judge = Judge {
            scope: self,
            due: Reach::new(Paths::new(&due, alignment), gate_m),
            all: Reach::new(Paths::new(truth, alignment), gate_m),
        };
        let mut kept = tracks.clone();
        kept.tracks.clear();
        for track in &tracks.tracks {
            let mut judged = track.clone();
            judged
                .points
                .retain(|point| judge.is_judged(tracks.space, point));
            left_out.track_points += track.points.len() - judged.points.len();
            if judged.points.is_empty() {
                left_out.tracks += 1;
            } else {
                kept.tracks.push(judged);
            }
        }
        (due, kept, left_out)
    }

    fn due(&self, truth: &TruthSet, left_out: &mut LeftOut) -> TruthSet {
        let mut due = Vec::new();
        for target in truth.targets() {
            let mut points = Vec::new();
            if self.holds_target(&target.truth_id) {
                points.extend(target.points.iter().copied().filter(|point| {
                    self.holds_time(point.time_s)
                        && self.holds_place(truth.space(), &point.position)
                }));
            }
            left_out.truth_points += target.points.len() - points.len();
            if points.is_empty() {
                left_out.targets += 1;
            } else {
                let truth_id = target.truth_id.clone();
                due.push(Target { truth_id, points });
            }
        }
        truth.with_targets(due)
    }
}

struct Judge<'t> {
    scope: &'t Scope,
    due: Reach<'t>,
    all: Reach<'t>,
}

impl Judge<'_> {
    fn is_judged(&self, space: Space, point: &TrackPoint) -> bool {
        let (time_s, place) = (point.time_s, &point.estimate.position);
        let common = if self.all.space() == Space::Volume {
            space
        } else {
            Space::Plane
        };
        if !self.scope.holds_time(time_s) {
            return false;
        }
        if self.due.is_near(common, time_s, &common.cut(*place)) {
            return true;
        }
        !self.all.is_near(common, time_s, &common.cut(*place))
            && self.scope.holds_place(space, place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::tests::{tracks_of, truth_of};

    fn square() -> Area {
        let corner = |x: f64, y: f64| Position::new(x, y);
        Area::Polygon(vec![
            corner(0.0, 0.0),
            corner(10.0, 0.0),
            corner(10.0, 10.0),
            corner(0.0, 10.0),
        ])
    }

    #[test]
    fn a_polygon_holds_its_edges_and_a_notch_is_outside() {
        let is_in = |area: &Area, x: f64, y: f64| area.holds(&Position::new(x, y));
        for (x, y, inside) in [
            (5.0, 5.0, true),
            (0.0, 5.0, true),
            (10.0, 10.0, true),
            (10.1, 5.0, false),
            (-1.0, 0.0, false),
        ] {
            assert_eq!(is_in(&square(), x, y), inside, "{x} {y}");
        }
        let notched = [
            (0.0, 0.0),
            (10.0, 0.0),
            (10.0, 10.0),
            (5.0, 2.0),
            (0.0, 10.0),
        ];
        let notched = Area::Polygon(notched.map(|(x, y)| Position::new(x, y)).to_vec());
        assert!(
            !is_in(&notched, 5.0, 5.0) && is_in(&notched, 5.0, 1.0) && is_in(&notched, 1.0, 5.0)
        );
    }

    #[test]
    fn a_sector_reaches_over_north() {
        let sector = Area::Sector {
            centre: Position::new(100.0, 0.0),
            range_m: (10.0, 50.0),
            bearings_rad: Some((350f64.to_radians(), 20f64.to_radians())),
        };
        let at = |bearing_deg: f64, range_m: f64| {
            let (sin, cos) = bearing_deg.to_radians().sin_cos();
            sector.holds(&Position::new(100.0 + range_m * sin, range_m * cos))
        };
        assert_eq!(
            [355.0, 0.0, 19.0, 21.0, 340.0, 180.0].map(|deg| at(deg, 30.0)),
            [true, true, true, false, false, false]
        );
        assert_eq!(
            [9.0, 10.1, 49.9, 51.0].map(|range_m| at(5.0, range_m)),
            [false, true, true, false]
        );
    }

    #[test]
    fn a_target_that_leaves_is_neither_missed_nor_false_and_a_false_track_outside_costs_nothing() {
        // A goes east, 2 m a second, and leaves the square behind 5 s; a track follows it to the end, another is far outside, a third
        // is false inside.
        let path: Vec<f64> = (0..10).map(|step| 2.0 * f64::from(step)).collect();
        let mut tracks = tracks_of(&[
            ("follows", &path),
            ("outside", &[500.0; 10]),
            ("inside", &[9.5, 9.5, 9.5]),
        ]);
        tracks.tracks[2]
            .points
            .iter_mut()
            .for_each(|point| point.estimate.position.y = 9.0);
        let truth = truth_of(&[("A", &path), ("B", &[300.0; 10])]);
        let scope = Scope {
            areas: vec![square()],
            ..Scope::default()
        };
        let alignment = Alignment::Interpolate { max_gap_s: None };
        let (due, kept, left_out) = scope.restrict(&truth, &tracks, (1.0, alignment));
        assert_eq!(
            due.targets()
                .iter()
                .map(|target| target.points.len())
                .collect::<Vec<_>>(),
            [6]
        );
        let lengths: Vec<(&str, usize)> = kept
            .tracks
            .iter()
            .map(|track| (track.track_id.as_str(), track.points.len()))
            .collect();
        assert_eq!(lengths, [("follows", 6), ("inside", 3)]);
        assert_eq!(
            left_out,
            LeftOut {
                truth_points: 14,
                track_points: 14,
                targets: 1,
                tracks: 1
            }
        );
        let whom = Scope {
            targets: Some(["B".to_owned()].into()),
            from_s: Some(3.0),
            to_s: Some(7.0),
            ..Scope::default()
        };
        let (due, kept, _) = whom.restrict(&truth, &tracks, (1.0, alignment));
        assert_eq!(due.targets()[0].points.len(), 5);
        // The track on A is on a target that nobody asks for; the one outside is near nobody, and so false.
        assert_eq!(
            kept.tracks
                .iter()
                .map(|track| track.points.len())
                .collect::<Vec<_>>(),
            [5]
        );
    }
}
