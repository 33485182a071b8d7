//! Truth and tracks side by side at common times, with the pairs that are near enough to matter. Every metric reads this
//! table, or the log of events made of it.
//!
//! # Method
//! 1. The [`steps`](super::steps): the times of the recording's scans when there is one, else those of tracks and truth.
//! 2. The truth at each step, as [`Alignment`] says; a step never sees truth from outside a target's path, but for the
//!    tolerance of times.
//! 3. The tracks at each step: the points whose times belong to it; of several points of one track the last counts.
//! 4. The pairs with a distance of at most `reach_m`, found by a sweep along x.
//!
//! Distances are along all axes of the [space](spaces) that truth and tracks have in common. Directions stand in it as places (bearing in degrees, 0), and their distances take the shorter way round.
//!
//! Costs are in proportion to points and pairs, apart from sorting.

use super::EvaluationInput;
use super::extent::Extent;
use super::spaces;
use super::steps::Steps;
use crate::model::space::{Place, Space};
use crate::model::track::{Kinematics, TrackSet};
use crate::model::truth::{Target, TruthSet};
use crate::model::watch::Watch;
use serde::Deserialize;
use std::ops::Range;

/// How truth is brought to the times of the steps.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(tag = "method", rename_all = "snake_case")]
pub enum Alignment {
    /// On the line between two points at most `max_gap_s` apart.
    Interpolate { max_gap_s: f64 },
    /// The nearest point in time, at most `max_gap_s` away; the earlier one of two.
    Nearest { max_gap_s: f64 },
}

/// One time at which truth and tracks are compared.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedStep {
    pub time_s: f64,
    /// Ranges of [`Comparison::truths`], [`Comparison::tracks`], [`Comparison::pairs`].
    pub truths: Range<usize>,
    pub tracks: Range<usize>,
    pub pairs: Range<usize>,
}

/// A truth or a track at one step.
#[derive(Debug, Clone, Copy)]
pub struct Presence {
    /// Index into [`Comparison::truth_ids`] or [`Comparison::track_ids`].
    pub id: u32,
    /// Of boxes: their centres, in pixels. Of directions: the bearing in degrees, and 0.
    pub position_m: Place,
    /// NaN where it is not known: of millions, an `Option` of each takes too much room.
    rates: Place,
    /// Of a track: index of the point in its track.
    pub point: u32,
}

impl Presence {
    /// `velocity_mps` is `None` where it is not known.
    pub fn new(id: u32, position_m: Place, velocity_mps: Option<Place>, point: u32) -> Self {
        Presence {
            id,
            position_m,
            rates: velocity_mps.unwrap_or(Place::repeat(f64::NAN)),
            point,
        }
    }

    pub fn velocity_mps(&self) -> Option<Place> {
        (!self.rates.x.is_nan()).then_some(self.rates)
    }
}

/// A truth and a track that are near each other at one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// Index into the whole lists [`Comparison::truths`] and [`Comparison::tracks`].
    pub truth: u32,
    pub track: u32,
    /// Of points: metres. Of directions: degrees. Of boxes: 1 − intersection over union.
    pub distance: f64,
    /// From 0 (strangers) to 1 (the same). Of points and directions: 1 − distance / (2 · gate), at least 0, so one half at the gate.
    pub similarity: f64,
}

/// The table. Within a step, truths and tracks rise by id, pairs by truth, then track.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// `None` of boxes.
    pub space: Option<Space>,
    /// Largest distance of a match: metres, degrees, or 1 − intersection over union.
    pub gate: f64,
    pub truth_ids: Vec<String>,
    pub track_ids: Vec<String>,
    pub steps: Vec<ComparedStep>,
    pub truths: Vec<Presence>,
    pub tracks: Vec<Presence>,
    pub pairs: Vec<Pair>,
    pub warnings: Vec<String>,
}

/// How points are compared; for directions the gate and the reach are in degrees, at most 90.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointSettings {
    pub alignment: Alignment,
    /// Largest distance of a match.
    pub gate_m: f64,
    /// Pairs farther apart are not listed; at least the gate.
    pub reach_m: f64,
    /// Times nearer than this are one step; `None` is what the data allow.
    pub time_tolerance_s: Option<f64>,
}

impl Comparison {
    /// Compares points, or directions where both sides are. `truth` is the truth of `input`.
    pub fn of_points(
        input: &EvaluationInput,
        truth: &TruthSet,
        settings: &PointSettings,
    ) -> Comparison {
        Comparison::of_points_within(
            input,
            truth,
            settings,
            &mut Extent::unbounded(&Watch::never()),
        )
    }

    /// The same of what the extent allows; its [`Extent::finish`] says whether the comparison is whole.
    pub fn of_points_within(
        input: &EvaluationInput,
        truth: &TruthSet,
        settings: &PointSettings,
        extent: &mut Extent,
    ) -> Comparison {
        let space = spaces::common(truth, input.tracks);
        let mut comparison = Comparison {
            space: Some(space),
            gate: settings.gate_m,
            truth_ids: truth
                .targets()
                .iter()
                .map(|target| target.truth_id.clone())
                .collect(),
            track_ids: input
                .tracks
                .tracks
                .iter()
                .map(|track| track.track_id.clone())
                .collect(),
            steps: Vec::new(),
            truths: Vec::new(),
            tracks: Vec::new(),
            pairs: Vec::new(),
            warnings: spaces::warning(truth, input.tracks).into_iter().collect(),
        };
        let mut steps = Steps::new(
            input.recording,
            Some(truth),
            input.tracks,
            settings.time_tolerance_s,
        );
        comparison.warnings.append(&mut steps.warnings);
        extent.add_ids(comparison.truth_ids.len() + comparison.track_ids.len());
        let truths = truths_at(truth, &steps, space, settings.alignment, extent);
        let tracks = tracks_at(input.tracks, &steps, space, extent);
        comparison.warn_of_strangers(&truths, truth, &tracks, input.tracks);
        for ((time_s, truths), tracks) in steps.times_s().zip(truths).zip(tracks) {
            let first_pair = comparison.pairs.len();
            comparison.push_step(time_s, truths, tracks, |truths, tracks, found| {
                near_pairs((truths, tracks), space, settings, extent, found);
            });
            if !extent.end_step(comparison.pairs.len() - first_pair) {
                break;
            }
        }
        comparison
    }

    /// Adds a step; `pair` calls back with the places of each pair in the two lists, its distance and its similarity.
    pub fn push_step(
        &mut self,
        time_s: f64,
        truths: Vec<Presence>,
        tracks: Vec<Presence>,
        pair: impl FnOnce(&[Presence], &[Presence], &mut dyn FnMut(usize, usize, f64, f64)),
    ) {
        let (first_truth, first_track, first_pair) =
            (self.truths.len(), self.tracks.len(), self.pairs.len());
        pair(
            &truths,
            &tracks,
            &mut |truth, track, distance, similarity| {
                let (truth, track) = ((first_truth + truth) as u32, (first_track + track) as u32);
                self.pairs.push(Pair {
                    truth,
                    track,
                    distance,
                    similarity,
                });
            },
        );
        self.pairs[first_pair..].sort_unstable_by_key(|pair| (pair.truth, pair.track));
        self.truths.extend(truths);
        self.tracks.extend(tracks);
        self.steps.push(ComparedStep {
            time_s,
            truths: first_truth..self.truths.len(),
            tracks: first_track..self.tracks.len(),
            pairs: first_pair..self.pairs.len(),
        });
    }

    /// The pairs of a step that may be matched.
    pub fn matchable<'c>(
        &'c self,
        step: &ComparedStep,
    ) -> impl Iterator<Item = &'c Pair> + use<'c> {
        self.pairs[step.pairs.clone()]
            .iter()
            .filter(|pair| pair.distance <= self.gate)
    }

    /// The similarity of a pair at this distance.
    pub fn similarity(&self, distance: f64) -> f64 {
        let zero_at = self.space.map_or(1.0, |_| 2.0 * self.gate);
        (1.0 - distance / zero_at).max(0.0)
    }

    /// How far apart two places are: of directions, in degrees, the shorter way round.
    pub fn distance(&self, left: &Place, right: &Place) -> f64 {
        let distance = (left - right).norm();
        if self.space == Some(Space::Bearing) {
            distance.min(360.0 - distance)
        } else {
            distance
        }
    }

    /// Whether places in metres are compared.
    pub fn is_in_metres(&self) -> bool {
        self.space.is_some_and(Space::has_places)
    }

    fn warn_of_strangers(
        &mut self,
        truths: &[Vec<Presence>],
        truth: &TruthSet,
        tracks: &[Vec<Presence>],
        set: &TrackSet,
    ) {
        for (name, space) in [("truth", truth.space()), ("tracks", set.space)] {
            if self.is_in_metres() && !space.has_places() {
                self.warnings.push(format!("the {name} are directions (bearing_deg) without places: nothing is compared in metres"));
                return;
            }
        }
        let is_listed = |targets: usize, lists: &[Vec<Presence>]| {
            targets > 0 && lists.iter().all(Vec::is_empty)
        };
        if is_listed(truth.targets().len(), truths) {
            self.warnings.push("no target exists at any time of the comparison: the clocks of truth and tracks do not meet".into());
        }
        if is_listed(set.tracks.len(), tracks) {
            self.warnings.push("no track exists at any time of the comparison: the clocks of tracks and recording do not meet".into());
        }
    }
}

fn truths_at(
    truth: &TruthSet,
    steps: &Steps,
    space: Space,
    alignment: Alignment,
    extent: &mut Extent,
) -> Vec<Vec<Presence>> {
    let mut lists = vec![Vec::new(); steps.count()];
    for (id, target) in truth.targets().iter().enumerate() {
        let mut points = 0;
        for step in alignment.steps_of(target, steps) {
            let (time_s, tolerance_s) = (steps.time_s(step), steps.tolerance_s);
            let place = (truth.space().has_places() == space.has_places())
                .then(|| alignment.place(truth.space(), target, time_s, tolerance_s));
            if let Some((position, velocity)) = place.flatten() {
                lists[step].push(presence(space, (id, 0), &position, velocity));
                points += 1;
            }
        }
        if !extent.add_points(points) {
            break;
        }
    }
    lists
}

/// What is compared of a place: a direction in degrees, whose rate is not compared.
fn presence(
    space: Space,
    (id, point): (usize, usize),
    position: &Place,
    velocity: Option<Place>,
) -> Presence {
    let (position_m, velocity_mps) = match space {
        Space::Bearing => (direction(position), None),
        Space::Plane | Space::Volume => {
            let velocity = velocity.map(|velocity| space.cut(velocity));
            (space.cut(*position), velocity)
        }
    };
    Presence::new(id as u32, position_m, velocity_mps, point as u32)
}

impl Alignment {
    pub fn max_gap_s(self) -> f64 {
        let (Alignment::Interpolate { max_gap_s } | Alignment::Nearest { max_gap_s }) = self;
        max_gap_s
    }

    /// The steps at which a target may exist.
    pub fn steps_of(self, target: &Target, steps: &Steps) -> Range<usize> {
        let (Some(first), Some(last)) = (target.points.first(), target.points.last()) else {
            return 0..0;
        };
        let margin_s = match self {
            Alignment::Interpolate { .. } => steps.tolerance_s,
            Alignment::Nearest { max_gap_s } => max_gap_s.max(steps.tolerance_s),
        };
        // One step more at both ends: sums of times are rounded, and `place` decides.
        let from = steps.first_from(first.time_s - margin_s).saturating_sub(1);
        from..(steps.first_from(last.time_s + margin_s) + 1).min(steps.count())
    }

    /// Position and velocity of a target at a time; a point within the tolerance counts as at that time where the target's
    /// path does not say more.
    pub fn place(
        self,
        space: Space,
        target: &Target,
        time_s: f64,
        tolerance_s: f64,
    ) -> Option<(Place, Option<Place>)> {
        let at_point = |limit_s: f64| {
            let point = target.nearest_point(time_s, limit_s)?;
            let velocity = target.velocity_at(space, point.time_s, f64::INFINITY);
            Some((point.position, velocity))
        };
        match self {
            Alignment::Interpolate { max_gap_s } => {
                match target.position_at(space, time_s, max_gap_s) {
                    Some(position) => {
                        Some((position, target.velocity_at(space, time_s, max_gap_s)))
                    }
                    None => at_point(tolerance_s),
                }
            }
            Alignment::Nearest { max_gap_s } => at_point(max_gap_s.max(tolerance_s)),
        }
    }
}

fn direction(bearing: &Place) -> Place {
    Place::new(bearing.x.to_degrees().rem_euclid(360.0), 0.0, 0.0)
}

/// What is added to a place to find it again: directions repeat after a turn.
pub fn turns(space: Option<Space>) -> &'static [f64] {
    if space == Some(Space::Bearing) {
        &[0.0, -360.0, 360.0]
    } else {
        &[0.0]
    }
}

fn tracks_at(
    set: &TrackSet,
    steps: &Steps,
    space: Space,
    extent: &mut Extent,
) -> Vec<Vec<Presence>> {
    let mut lists: Vec<Vec<Presence>> = vec![Vec::new(); steps.count()];
    for (id, track) in set.tracks.iter().enumerate() {
        let mut guess = 0;
        for (index, point) in track.points.iter().enumerate() {
            let Some(step) = steps.near(point.time_s, guess) else {
                continue;
            };
            guess = step + 1;
            if set.space.has_places() != space.has_places() {
                continue;
            }
            let Kinematics {
                position, velocity, ..
            } = &point.estimate;
            let presence = presence(space, (id, index), position, *velocity);
            match lists[step].last_mut() {
                Some(last) if last.id == presence.id => *last = presence,
                _ => lists[step].push(presence),
            }
        }
        if !extent.add_points(track.points.len()) {
            break;
        }
    }
    lists
}

/// The pairs within reach: for each truth the tracks whose x is near enough are looked at, at every turn.
fn near_pairs(
    (truths, tracks): (&[Presence], &[Presence]),
    space: Space,
    settings: &PointSettings,
    extent: &mut Extent,
    found: &mut dyn FnMut(usize, usize, f64, f64),
) {
    let (mut pairs, mut looked_at) = (0, 0);
    let mut by_x: Vec<(f64, usize)> = tracks
        .iter()
        .enumerate()
        .map(|(index, track)| (track.position_m.x, index))
        .collect();
    by_x.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for (truth, place) in truths.iter().enumerate() {
        for turn in turns(Some(space)) {
            let position_m = place.position_m + Place::new(*turn, 0.0, 0.0);
            let from = by_x.partition_point(|&(x_m, _)| x_m < position_m.x - settings.reach_m);
            for &(x_m, track) in &by_x[from..] {
                if x_m > position_m.x + settings.reach_m {
                    break;
                }
                looked_at += 1;
                let distance_m = (tracks[track].position_m - position_m).norm();
                if distance_m <= settings.reach_m {
                    found(
                        truth,
                        track,
                        distance_m,
                        (1.0 - distance_m / (2.0 * settings.gate_m)).max(0.0),
                    );
                    pairs += 1;
                }
            }
        }
        // One truth has no more pairs than there are tracks.
        if !extent.goes_on_with(pairs, 4 * std::mem::take(&mut looked_at)) {
            return;
        }
    }
}
