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
//! 5. Over time: truths that are associated and that are not, tracks that are redundant and that keep no truth, and how many
//!    tracks diverge and swap at the step.
//!
//! Inside coverage are the steps at which the truth exists: what no sensor can see must not be among the truth.

mod lives;

use self::lives::{TrackLife, TruthLife, lines, totals};
use super::origin::{
    Origin, PAIRS, PairColumn, SERIES, Statistic, TRACK_POINTS, TRACKS, TRUTH_POINTS, TRUTHS,
};
use super::{BuildMetric, Metric, MetricReport, Sequence, Series};
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
        let (mut per_truth, mut per_track) = (Vec::new(), Vec::new());
        let (mut pairs, mut series) = (Vec::new(), Vec::new());
        for &Sequence { comparison, .. } in sequences {
            let walk = Walk::new(comparison, self.divergence_gate(comparison.gate));
            if sequences.len() == 1 {
                per_truth = lines(&comparison.truth_ids, &walk.truths, TruthLife::quantities);
                per_track = lines(&comparison.track_ids, &walk.tracks, TrackLife::quantities);
                pairs.push(PairColumn::new("associated", "", walk.associated_pairs));
                pairs.push(PairColumn::new("redundant", "", walk.redundant_pairs));
                let [associated, redundant] =
                    [0, 1].map(|place: usize| pairs[place].sums(comparison));
                series = over_time(comparison, &associated, &redundant);
                for (name, counts) in [("swaps", walk.swaps), ("divergences", walk.divergences)] {
                    let counts = counts.into_iter().map(|count| Some(f64::from(count)));
                    series.push(Series::over_time(name, "", counts));
                }
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
            series,
            origins: FROM.to_vec(),
            ..report
        }
    }
}

const FROM: &[Origin] = &[
    TRUTH_POINTS,
    TRACK_POINTS,
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
    Origin::sum("swaps", SERIES),
    Origin::sum("divergences", SERIES),
    Origin::sum("divergence_length", TRACKS),
    Origin::sum("redundancies", TRACKS),
    Origin::rows("redundancy_length", Statistic::Count, PAIRS, "redundant"),
    Origin::rows("false_tracks", Statistic::Sum, TRACKS, "false"),
    Origin::ratio("false_tracks_share", &["false_tracks"], &["tracks"]),
    Origin::rows("false_track_length", Statistic::Sum, TRACKS, "false_length"),
    Origin::terms(
        "series.missed",
        &["series.truth_points", "-series.associated"],
    ),
    Origin::rows("series.redundant", Statistic::Count, PAIRS, "redundant"),
    Origin::terms(
        "series.unassigned",
        &[
            "series.track_points",
            "-series.associated",
            "-series.redundant",
        ],
    ),
];

/// Method, 5.
fn over_time(comparison: &Comparison, associated: &[f64], redundant: &[f64]) -> Vec<Series> {
    let names = ["associated", "missed", "beside"];
    let mut series = Series::of_matched(names, comparison, associated);
    let beside = series.pop().map_or(Vec::new(), |series| series.values);
    let unassigned = beside.iter().zip(redundant);
    let unassigned = unassigned.map(|(beside, redundant)| Some((*beside)? - redundant));
    let redundant = redundant.iter().copied().map(Some);
    series.extend([
        Series::over_time("redundant", "", redundant),
        Series::over_time("unassigned", "", unassigned),
    ]);
    series
}

impl Assignment {
    fn divergence_gate(self, gate: f64) -> f64 {
        self.divergence_gate
            .map_or(gate, |divergence_gate| divergence_gate.max(gate))
    }
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
    /// How many tracks diverge and swap at each step.
    divergences: Vec<u32>,
    swaps: Vec<u32>,
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
            divergences: vec![0; comparison.steps.len()],
            swaps: vec![0; comparison.steps.len()],
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
                self.divergences[index as usize] += u32::from(track.is_divergent);
            }
            if let (None, Some((_, truth))) = (track.truth, self.nearest[offset]) {
                let swaps = u32::from(track.last_truth.is_some_and(|last| last != truth));
                track.swaps += swaps;
                self.swaps[index as usize] += swaps;
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

#[cfg(test)]
mod tests;
