//! Assignment metrics: what happened to each truth and to each track, told from the side of the tracks.
//!
//! # Reference
//! S. B. Colegrove, L. M. Davis, S. J. Davey, Performance Assessment of Tracking Systems, Proc. Int. Symp. on Signal
//! Processing and its Applications, 1996; the terms are those of S. B. Colegrove, 2005.
//!
//! # Method
//! 1. A track takes the nearest truth within the gate and keeps it up to the divergence gate (never smaller than the
//!    gate). Beyond that it diverges; it is divergent until it takes a truth again. Taking another truth than before is
//!    a swap. A truth that ceases to exist frees its tracks.
//! 2. Several tracks may keep one truth. The one that has kept it longest is associated with it, the others are
//!    redundant.
//! 3. A truth is established when a track is first associated with it; the establishment length counts its steps
//!    before. A break begins at each step at which nobody is associated any more; its length counts such steps.
//! 4. A track that never takes a truth is false.
//!
//! Inside coverage are the steps at which the truth exists: what no sensor can see must not be among the truth.

use super::origin::{Origin, PAIRS, PairColumn, Statistic, TRACKS, TRUTH_POINTS, TRUTHS};
use super::{BuildMetric, Line, Metric, MetricReport, Quantity, Sequence};
use crate::evaluation::comparison::{ComparedStep, Comparison};
use crate::model::space::Space;
use crate::registry::{Bound, Kind, Method, Object, optional};
use serde::Deserialize;
use serde_json::json;

pub const METHOD: Method<BuildMetric> = Method {
    name: "assignment",
    parameters: &PARAMETERS,
    build: |spec| Ok(Box::new(Assignment::deserialize(spec)?)),
};

static PARAMETERS: Object = Object {
    name: "AssignmentMetrics",
    summary: "Establishment and breaks of each truth; swaps, divergence, redundancy and falsehood of each track.",
    fields: &[optional(
        "divergence_gate",
        "A track keeps its truth up to this distance (m, or 1 - intersection over union of boxes); default: the gate.",
        Kind::Number {
            min: Bound::Excluding(0.0),
            max: Bound::None,
            unit: "",
        },
    )],
};

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Assignment {
    divergence_gate: Option<f64>,
}

impl Metric for Assignment {
    fn accepts(&self, space: Option<Space>) -> bool {
        space != Some(Space::Bearing)
    }

    fn reach_m(&self, gate_m: f64) -> f64 {
        self.divergence_gate(gate_m)
    }

    fn evaluate(&self, sequences: &[Sequence]) -> MetricReport {
        let (mut truths, mut tracks) = (Vec::new(), Vec::new());
        let (mut per_truth, mut per_track, mut pairs) = (Vec::new(), Vec::new(), Vec::new());
        for &Sequence { comparison, .. } in sequences {
            let walk = Walk::new(comparison, self.divergence_gate(comparison.gate));
            if sequences.len() == 1 {
                per_truth = lines(&comparison.truth_ids, &walk.truths, TruthLife::quantities);
                per_track = lines(&comparison.track_ids, &walk.tracks, TrackLife::quantities);
                pairs.push(PairColumn::new("associated", "", walk.associated_pairs));
                pairs.push(PairColumn::new("redundant", "", walk.redundant_pairs));
            }
            truths.extend(walk.truths.into_iter().filter(|truth| truth.steps > 0));
            tracks.extend(walk.tracks.into_iter().filter(|track| track.steps > 0));
        }
        let gate = sequences.first().map(|sequence| sequence.comparison.gate);
        let parameters =
            json!({"gate": gate, "divergence_gate": gate.map(|gate| self.divergence_gate(gate))});
        let report = MetricReport::new(
            "associated_share",
            true,
            parameters,
            totals(&truths, &tracks),
        );
        MetricReport {
            per_truth,
            per_track,
            pairs,
            origins: FROM.to_vec(),
            ..report
        }
    }
}

const FROM: &[Origin] = &[
    TRUTH_POINTS,
    Origin::rows("associated", Statistic::Count, PAIRS, "associated"),
    Origin::ratio("associated_share", &["associated"], &["truth_points"]),
    Origin::rows(
        "truths",
        Statistic::CountPositive,
        TRUTHS,
        "steps_inside_coverage",
    ),
    Origin::rows("truths_established", Statistic::Sum, TRUTHS, "established"),
    Origin::ratio(
        "truths_established_share",
        &["truths_established"],
        &["truths"],
    ),
    Origin::rows(
        "mean_establishment_length",
        Statistic::Mean,
        TRUTHS,
        "establishment_length",
    ),
    Origin::sum("breaks", TRUTHS),
    Origin::sum("break_length", TRUTHS),
    Origin::rows("tracks", Statistic::CountPositive, TRACKS, "length"),
    Origin::sum("swaps", TRACKS),
    Origin::sum("divergences", TRACKS),
    Origin::sum("divergence_length", TRACKS),
    Origin::sum("redundancies", TRACKS),
    Origin::rows("redundancy_length", Statistic::Count, PAIRS, "redundant"),
    Origin::rows("false_tracks", Statistic::Sum, TRACKS, "false"),
    Origin::ratio("false_tracks_share", &["false_tracks"], &["tracks"]),
    Origin::rows("false_track_length", Statistic::Sum, TRACKS, "false_length"),
];

impl Assignment {
    fn divergence_gate(self, gate: f64) -> f64 {
        self.divergence_gate
            .map_or(gate, |divergence_gate| divergence_gate.max(gate))
    }
}

/// The life of one truth, in steps at which it exists.
#[derive(Debug, Clone, Copy, Default)]
struct TruthLife {
    steps: u32,
    associated: u32,
    establishment: u32,
    breaks: u32,
    break_length: u32,
    was_associated: bool,
}

/// The life of one track, in steps at which it exists.
#[derive(Debug, Clone, Copy, Default)]
struct TrackLife {
    steps: u32,
    assigned: u32,
    swaps: u32,
    divergences: u32,
    divergence_length: u32,
    redundancies: u32,
    redundancy_length: u32,
    /// The truth it keeps, and since which step; the truth it kept last.
    truth: Option<u32>,
    since: u32,
    last_truth: Option<u32>,
    is_divergent: bool,
    was_redundant: bool,
}

/// Goes through the steps.
struct Walk<'a> {
    comparison: &'a Comparison,
    divergence_gate: f64,
    truths: Vec<TruthLife>,
    tracks: Vec<TrackLife>,
    /// For each track of the step: distance of the truth it keeps, and its nearest truth.
    kept: Vec<Option<f64>>,
    nearest: Vec<Option<(f64, u32)>>,
    /// For each truth of the step: the track associated with it.
    associated: Vec<Option<u32>>,
    /// Who was associated with whom and who was redundant to whom, as [`PairColumn`] has it.
    associated_pairs: Vec<(u32, u32, f64)>,
    redundant_pairs: Vec<(u32, u32, f64)>,
}

impl<'a> Walk<'a> {
    fn new(comparison: &'a Comparison, divergence_gate: f64) -> Self {
        let mut walk = Walk {
            comparison,
            divergence_gate,
            truths: vec![TruthLife::default(); comparison.truth_ids.len()],
            tracks: vec![TrackLife::default(); comparison.track_ids.len()],
            kept: Vec::new(),
            nearest: Vec::new(),
            associated: Vec::new(),
            associated_pairs: Vec::new(),
            redundant_pairs: Vec::new(),
        };
        for (index, step) in comparison.steps.iter().enumerate() {
            walk.look_around(step);
            walk.assign(index as u32, step);
            walk.associate(step);
            walk.count_truths(step);
        }
        walk
    }

    fn look_around(&mut self, step: &ComparedStep) {
        self.kept.clear();
        self.kept.resize(step.tracks.len(), None);
        self.nearest.clear();
        self.nearest.resize(step.tracks.len(), None);
        for pair in &self.comparison.pairs[step.pairs.clone()] {
            let offset = pair.track as usize - step.tracks.start;
            let (truth, track) = (
                self.comparison.truths[pair.truth as usize].id,
                self.comparison.tracks[pair.track as usize].id,
            );
            if self.tracks[track as usize].truth == Some(truth)
                && pair.distance <= self.divergence_gate
            {
                self.kept[offset] = Some(pair.distance);
            }
            if pair.distance <= self.comparison.gate
                && self.nearest[offset].is_none_or(|nearest| pair.distance < nearest.0)
            {
                self.nearest[offset] = Some((pair.distance, truth));
            }
        }
    }

    /// Method, 1.
    fn assign(&mut self, index: u32, step: &ComparedStep) {
        let truths = &self.comparison.truths[step.truths.clone()];
        for (offset, presence) in self.comparison.tracks[step.tracks.clone()]
            .iter()
            .enumerate()
        {
            let track = &mut self.tracks[presence.id as usize];
            track.steps += 1;
            if let Some(truth) = track.truth.filter(|_| self.kept[offset].is_none()) {
                track.truth = None;
                track.is_divergent = truths
                    .binary_search_by_key(&truth, |truth| truth.id)
                    .is_ok();
                track.divergences += u32::from(track.is_divergent);
            }
            if let (None, Some((_, truth))) = (track.truth, self.nearest[offset]) {
                track.swaps += u32::from(track.last_truth.is_some_and(|last| last != truth));
                (
                    track.truth,
                    track.last_truth,
                    track.since,
                    track.is_divergent,
                ) = (Some(truth), Some(truth), index, false);
            }
            track.assigned += u32::from(track.truth.is_some());
            track.divergence_length += u32::from(track.is_divergent);
        }
    }

    /// Method, 2.
    fn associate(&mut self, step: &ComparedStep) {
        let comparison = self.comparison;
        self.associated.clear();
        self.associated.resize(step.truths.len(), None);
        let truths = &comparison.truths[step.truths.clone()];
        let place = |truth: u32| {
            truths
                .binary_search_by_key(&truth, |presence| presence.id)
                .ok()
        };
        for presence in &comparison.tracks[step.tracks.clone()] {
            let track = &self.tracks[presence.id as usize];
            let Some(place) = track.truth.and_then(place) else {
                continue;
            };
            let other = self.associated[place].map(|other| &self.tracks[other as usize]);
            if other.is_none_or(|other| track.since < other.since) {
                self.associated[place] = Some(presence.id);
            }
        }
        for (offset, presence) in comparison.tracks[step.tracks.clone()].iter().enumerate() {
            let track = &mut self.tracks[presence.id as usize];
            let place = track.truth.and_then(place);
            let is_redundant =
                place.is_some_and(|place| self.associated[place] != Some(presence.id));
            if let Some(place) = place {
                let pairs = if is_redundant {
                    &mut self.redundant_pairs
                } else {
                    &mut self.associated_pairs
                };
                pairs.push((
                    (step.truths.start + place) as u32,
                    (step.tracks.start + offset) as u32,
                    1.0,
                ));
            }
            track.redundancies += u32::from(is_redundant && !track.was_redundant);
            track.redundancy_length += u32::from(is_redundant);
            track.was_redundant = is_redundant;
        }
    }

    /// Method, 3.
    fn count_truths(&mut self, step: &ComparedStep) {
        for (presence, associated) in self.comparison.truths[step.truths.clone()]
            .iter()
            .zip(&self.associated)
        {
            let life = &mut self.truths[presence.id as usize];
            life.steps += 1;
            match associated {
                Some(_) => life.associated += 1,
                None if life.associated == 0 => life.establishment += 1,
                None => {
                    life.breaks += u32::from(life.was_associated);
                    life.break_length += 1;
                }
            }
            life.was_associated = associated.is_some();
        }
    }
}

impl TruthLife {
    fn quantities(&self) -> Vec<Quantity> {
        let establishment = Some(f64::from(self.establishment)).filter(|_| self.associated > 0);
        vec![
            Quantity::count("steps_inside_coverage", self.steps),
            Quantity::count("established", u32::from(self.associated > 0)),
            Quantity::or(
                "establishment_length",
                establishment,
                "steps",
                "never established",
            ),
            Quantity::count("breaks", self.breaks),
            Quantity::new("break_length", f64::from(self.break_length), "steps"),
            Quantity::ratio(
                "associated_share",
                f64::from(self.associated),
                f64::from(self.steps),
                "",
                "does not exist at any step",
            ),
        ]
    }
}

impl TrackLife {
    fn is_false(&self) -> bool {
        self.steps > 0 && self.last_truth.is_none()
    }

    fn quantities(&self) -> Vec<Quantity> {
        let length = |name, steps: u32| Quantity::new(name, f64::from(steps), "steps");
        vec![
            length("length", self.steps),
            length("assigned_length", self.assigned),
            Quantity::count("swaps", self.swaps),
            Quantity::count("divergences", self.divergences),
            length("divergence_length", self.divergence_length),
            Quantity::count("redundancies", self.redundancies),
            length("redundancy_length", self.redundancy_length),
            Quantity::count("false", u32::from(self.is_false())),
            length("false_length", if self.is_false() { self.steps } else { 0 }),
        ]
    }
}

fn lines<Life>(
    ids: &[String],
    lives: &[Life],
    quantities: impl Fn(&Life) -> Vec<Quantity>,
) -> Vec<Line> {
    ids.iter()
        .zip(lives)
        .map(|(id, life)| Line {
            id: id.clone(),
            quantities: quantities(life),
        })
        .collect()
}

fn totals(truths: &[TruthLife], tracks: &[TrackLife]) -> Vec<Quantity> {
    let established = sum(truths, |life| u32::from(life.associated > 0));
    let establishment = sum(truths, |life| {
        if life.associated > 0 {
            life.establishment
        } else {
            0
        }
    });
    let false_tracks = sum(tracks, |life| u32::from(life.is_false()));
    let no_truth = "no truth at any step";
    vec![
        Quantity::ratio(
            "associated_share",
            sum(truths, |life| life.associated),
            sum(truths, |life| life.steps),
            "",
            no_truth,
        ),
        Quantity::new("truths", truths.len() as f64, ""),
        Quantity::new("truths_established", established, ""),
        Quantity::ratio(
            "truths_established_share",
            established,
            truths.len() as f64,
            "",
            no_truth,
        ),
        Quantity::ratio(
            "mean_establishment_length",
            establishment,
            established,
            "steps",
            "no truth was established",
        ),
        Quantity::new("breaks", sum(truths, |life| life.breaks), ""),
        Quantity::new(
            "break_length",
            sum(truths, |life| life.break_length),
            "steps",
        ),
        Quantity::new("tracks", tracks.len() as f64, ""),
        Quantity::new("swaps", sum(tracks, |life| life.swaps), ""),
        Quantity::new("divergences", sum(tracks, |life| life.divergences), ""),
        Quantity::new(
            "divergence_length",
            sum(tracks, |life| life.divergence_length),
            "steps",
        ),
        Quantity::new("redundancies", sum(tracks, |life| life.redundancies), ""),
        Quantity::new(
            "redundancy_length",
            sum(tracks, |life| life.redundancy_length),
            "steps",
        ),
        Quantity::new("false_tracks", false_tracks, ""),
        Quantity::ratio(
            "false_tracks_share",
            false_tracks,
            tracks.len() as f64,
            "",
            "no track at any step",
        ),
        Quantity::new(
            "false_track_length",
            sum(tracks, |life| if life.is_false() { life.steps } else { 0 }),
            "steps",
        ),
    ]
}

fn sum<Life>(lives: &[Life], part: fn(&Life) -> u32) -> f64 {
    lives.iter().map(|life| f64::from(part(life))).sum()
}

#[cfg(test)]
mod tests;
