//! Truth and tracks side by side at common times, with the pairs that are near enough to matter. Every metric reads this
//! table, or the log of events made of it.
//!
//! # Method
//! 1. The [`steps`](super::steps), and the truth at each of them, by its [`paths`](super::paths): these targets are due.
//! 2. The tracks at each step: of each track the point nearest in time of those that belong to the step, at its own time. Its other
//!    points are between steps.
//! 3. A point that belongs to no step is between steps where it is within the gate of a target; else its time is a step at
//!    which nothing is due, so that it counts as false.
//! 4. The pairs with a distance of at most `reach_m`: of the track and the target at the time of the track.
//!
//! Distances are along all axes of the [space](spaces) that truth and tracks have in common. Directions stand in it as places (bearing in degrees, 0), and their distances take the shorter way round.
//!
//! Costs are in proportion to points and pairs, apart from sorting.

mod points;
mod sweep;

use super::EvaluationInput;
use super::acquaintances::Acquaintances;
use super::credit::Credit;
use super::extent::Extent;
use super::paths::{Alignment, Paths};
use super::spaces;
use super::steps::{StepSettings, Steps};
use crate::model::space::{Place, Space};
use crate::model::truth::TruthSet;
use crate::model::watch::Watch;
use std::cell::OnceCell;
use std::ops::Range;

/// One time at which truth and tracks are compared.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedStep {
    pub time_s: f64,
    /// The time of tracks alone, at which nothing is due.
    pub is_extra: bool,
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
#[derive(Debug, Clone, Default)]
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
    /// Where tracks speak at other times than those of the steps.
    pub(super) own_times: Option<OwnTimes>,
    pub facts: Facts,
    pub warnings: Vec<String>,
    pub(super) acquaintances: OnceCell<Acquaintances>,
}

/// What a reader must know of a comparison before its numbers.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Facts {
    /// In words, what the steps are.
    pub made_of: &'static str,
    /// The usual time between two steps, where there is one.
    pub period_s: Option<f64>,
    /// How many steps fill holes of a recording.
    pub filled: usize,
    /// Points that are not credited: the track was not known then.
    pub unknown_then: usize,
    /// Points of tracks that were not compared: others of their track are nearer to the step, or there is no step but a target.
    pub between_steps: usize,
}

/// Tracks at times of their own, and the paths of the targets.
#[derive(Debug, Clone)]
pub(super) struct OwnTimes {
    /// Of each of [`Comparison::tracks`], how much later than its step it is.
    after_s: Vec<f64>,
    paths: Paths<'static>,
}

/// How points are compared; for directions the gate is in degrees, at most 90, and the reach less than 180.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointSettings {
    pub alignment: Alignment,
    /// Largest distance of a match.
    pub gate_m: f64,
    /// Pairs farther apart are not listed; at least the gate.
    pub reach_m: f64,
    pub steps: StepSettings,
    pub credit: Credit,
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
        let names = truth.targets().iter().map(|target| target.truth_id.clone());
        let tracks = input.tracks.tracks.iter();
        let mut comparison = Comparison {
            space: Some(space),
            gate: settings.gate_m,
            truth_ids: names.collect(),
            track_ids: tracks.map(|track| track.track_id.clone()).collect(),
            warnings: spaces::warning(truth, input.tracks).into_iter().collect(),
            ..Comparison::default()
        };
        let paths = Paths::new(truth, settings.alignment);
        let mut steps = Steps::new(input.recording, &paths, input.tracks, &settings.steps);
        comparison.warnings.append(&mut steps.warnings);
        extent.add_ids(comparison.truth_ids.len() + comparison.track_ids.len());
        comparison.facts = Facts {
            made_of: steps.made_of,
            period_s: steps.period_s,
            filled: steps.filled,
            ..Facts::default()
        };
        comparison.take_points(input.tracks, &paths, &steps, settings, extent);
        comparison
    }

    /// Adds a step; `pair` calls back with the places of each pair in the two lists, its distance and its similarity.
    pub fn push_step(
        &mut self,
        (time_s, is_extra): (f64, bool),
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
            is_extra,
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
        spaces::distance(self.space.unwrap_or_default(), left, right)
    }

    /// A truth as it is at the time of a track of the same step, both by their places in the lists.
    pub fn truth_beside(&self, truth: usize, track: usize) -> Presence {
        let presence = self.truths[truth];
        let (Some(own), Some(space)) = (&self.own_times, self.space) else {
            return presence;
        };
        let after_s = own.after_s[track];
        if after_s == 0.0 {
            return presence;
        }
        let step = self.steps.partition_point(|step| step.tracks.end <= track);
        presence_after(
            &own.paths,
            space,
            &presence,
            (self.steps[step].time_s, after_s),
        )
    }

    /// Who ever meets whom; found when first asked for, so all pairs must be listed by then.
    pub fn acquaintances(&self) -> &Acquaintances {
        self.acquaintances.get_or_init(|| Acquaintances::new(self))
    }

    /// How many steps have a target that is due.
    pub fn due_steps(&self) -> usize {
        let is_due = |step: &&ComparedStep| !step.truths.is_empty();
        self.steps.iter().filter(is_due).count()
    }

    /// Whether places in metres are compared.
    pub fn is_in_metres(&self) -> bool {
        self.space.is_some_and(Space::has_places)
    }
}

/// What is compared of a place: a direction in degrees, whose rate is not compared.
fn presence(
    space: Space,
    (id, point): (usize, usize),
    position: &Place,
    velocity: Option<Place>,
) -> Presence {
    let (position_m, velocity_mps) = match space {
        Space::Bearing => (spaces::compared(space, position), None),
        Space::Plane | Space::Volume => {
            let velocity = velocity.map(|velocity| space.cut(velocity));
            (space.cut(*position), velocity)
        }
    };
    Presence::new(id as u32, position_m, velocity_mps, point as u32)
}

/// The same target so much later than at a step at which it is present: along its path, and where that does not say, by its velocity.
fn presence_after(
    paths: &Paths,
    space: Space,
    target: &Presence,
    (step_s, after_s): (f64, f64),
) -> Presence {
    if after_s == 0.0 {
        return *target;
    }
    match paths.at(target.id as usize, step_s + after_s, 0.0) {
        Some((position, velocity)) => presence(space, (target.id as usize, 0), &position, velocity),
        None => {
            let velocity = target.velocity_mps().unwrap_or_default();
            Presence {
                position_m: target.position_m + velocity * after_s,
                ..*target
            }
        }
    }
}

/// What is added to a place to find it again: directions repeat after a turn.
pub fn turns(space: Option<Space>) -> &'static [f64] {
    if space == Some(Space::Bearing) {
        &[0.0, -360.0, 360.0]
    } else {
        &[0.0]
    }
}
