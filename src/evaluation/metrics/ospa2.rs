//! OSPA⁽²⁾: OSPA between sets of tracks instead of sets of places. A track that changes its target, breaks or is told twice costs
//! over a whole window of time, so identity counts without labels.
//!
//! # Reference
//! M. Beard, B. T. Vo, B.-N. Vo, A Solution for Large-Scale Multi-Object Tracking, IEEE Trans. Signal Processing 68, 2020,
//! 2754–2769: OSPA⁽²⁾ with equal weights.
//!
//! # Symbols
//! W the steps of a window; f a truth, g a track in it; c cutoff, p order over tracks, q order over time, d distance.
//!
//! # Method
//! 1. D(f, g)^q is the mean of δ^q over those steps of W at which f or g exists: δ = min(d, c) where both do, else c. A pair that is
//!    never within the cutoff is at c.
//! 2. OSPA with the distance D, of all truths and all tracks that exist in W.
//! 3. The window of a step are the last `window_steps` steps up to it. The headline is the sum over all steps of all sequences, divided
//!    by the steps at which a target is due; `ospa2_whole` is that of one window over everything, of several sequences by
//!    the p-th powers of their heads.

use super::cutoff::{CUTOFF_DEG, CUTOFF_M, Cutoff, Cutoffs, ORDER, Unit};
use super::origin::{DUE_STEPS, Origin, SERIES, STEPS, Statistic};
use super::{BuildMetric, Metric, MetricReport, NOTHING_DUE, Quantity, Sequence, Series};
use crate::evaluation::comparison::{Comparison, Presence};
use crate::math::assignment::AssignmentSolver;
use crate::model::watch::Watch;
use crate::registry::{Method, Object, default, number, whole};
use serde::Deserialize;
use serde_json::json;
use std::ops::Range;

pub const METHOD: Method<BuildMetric> = Method {
    name: "ospa2",
    parameters: &PARAMETERS,
    build: |spec| {
        let Windows { window_steps, q } = Windows::deserialize(spec)?;
        Ok(Box::new(Ospa2 {
            cutoffs: Cutoffs::deserialize(spec)?,
            window_steps,
            q,
        }))
    },
};

static PARAMETERS: Object = Object {
    name: "Ospa2",
    summary: "Distance per head between the sets of whole truths and of whole tracks in a window of time.",
    fields: &[
        CUTOFF_M,
        CUTOFF_DEG,
        ORDER,
        default(
            "q",
            "The order of the mean over the steps of a window.",
            number(1.0, 10.0, ""),
            "2.0",
        ),
        default(
            "window_steps",
            "How many steps a window has.",
            whole(1, 1000, ""),
            "10",
        ),
    ],
};

#[derive(Deserialize)]
struct Windows {
    window_steps: usize,
    q: f64,
}

struct Ospa2 {
    cutoffs: Cutoffs,
    window_steps: usize,
    q: f64,
}

impl Metric for Ospa2 {
    fn cutoffs(&self) -> Option<Cutoffs> {
        Some(self.cutoffs)
    }

    fn evaluate(&self, sequences: &[Sequence]) -> MetricReport {
        self.evaluate_until(sequences, &Watch::never())
    }

    fn evaluate_until(&self, sequences: &[Sequence], watch: &Watch) -> MetricReport {
        let unit = self.cutoffs.unit(sequences);
        let (mut values, mut whole) = (Vec::new(), Whole::default());
        let mut due = 0;
        for Sequence { comparison, .. } in sequences {
            let mut lives = Lives::new(comparison, unit.cutoff, self.q);
            for step in 0..comparison.steps.len() {
                let first = (step + 1).saturating_sub(self.window_steps);
                values.push(
                    lives
                        .distance(first..step + 1, unit.cutoff)
                        .value(unit.cutoff),
                );
                if watch.stops_after(lives.work()) {
                    break;
                }
            }
            let all = lives.distance(0..comparison.steps.len(), unit.cutoff);
            whole.share += all.share;
            whole.heads += all.heads;
            due += comparison.due_steps();
        }
        self.report(unit, &values, &whole, (due, sequences.len()))
    }
}

impl Ospa2 {
    fn report(
        &self,
        unit: Unit,
        values: &[f64],
        whole: &Whole,
        (due, sequences): (usize, usize),
    ) -> MetricReport {
        let sum = values.iter().sum();
        let quantities = vec![
            Quantity::ratio("ospa2", sum, due as f64, unit.name, NOTHING_DUE),
            Quantity::new("ospa2_whole", whole.value(unit.cutoff), unit.name),
            Quantity::count("steps", values.len() as f64),
            Quantity::count("due_steps", due as f64),
        ];
        let parameters = json!({
            unit.parameter: unit.cutoff.cutoff_m, "p": unit.cutoff.p, "q": self.q, "window_steps": self.window_steps
        });
        let mut report = MetricReport::new("ospa2", false, parameters, quantities);
        report.origins = vec![
            Origin::rows("ospa2_sum", Statistic::Sum, SERIES, "ospa2_of_window"),
            Origin::ratio("ospa2", &["ospa2_sum"], &["due_steps"]),
            STEPS,
            DUE_STEPS,
        ];
        if sequences == 1 {
            let values = values.iter().copied().map(Some);
            report.series = vec![Series::over_time("ospa2_of_window", unit.name, values)];
        }
        report
    }
}

/// Of one window: the sum over heads as a share of cᵖ, and the larger number of heads.
#[derive(Debug, Default)]
struct Whole {
    share: f64,
    heads: usize,
}

impl Whole {
    fn value(&self, cutoff: Cutoff) -> f64 {
        cutoff.metres(self.share / self.heads.max(1) as f64)
    }
}

/// A truth and a track that are within the cutoff at some step: at which steps, and what is gained there of 1.
struct Meeting {
    truth: u32,
    track: u32,
    gains: Vec<(u32, f64)>,
}

/// When truths and tracks exist, and which of them meet.
struct Lives {
    truths: Vec<Vec<u32>>,
    tracks: Vec<Vec<u32>>,
    /// By truth, then track.
    meetings: Vec<Meeting>,
    q: f64,
    solver: AssignmentSolver,
    /// The steps that the last window looked at.
    looked_at: u64,
}

impl Lives {
    fn new(comparison: &Comparison, cutoff: Cutoff, q: f64) -> Lives {
        let of_time = Cutoff { p: q, ..cutoff };
        let mut lives = Lives {
            truths: vec![Vec::new(); comparison.truth_ids.len()],
            tracks: vec![Vec::new(); comparison.track_ids.len()],
            meetings: Vec::new(),
            q,
            solver: AssignmentSolver::default(),
            looked_at: 0,
        };
        let mut gains: Vec<(u32, u32, u32, f64)> = Vec::new();
        for (index, step) in (0u32..).zip(&comparison.steps) {
            note(
                &comparison.truths[step.truths.clone()],
                index,
                &mut lives.truths,
            );
            note(
                &comparison.tracks[step.tracks.clone()],
                index,
                &mut lives.tracks,
            );
            for pair in &comparison.pairs[step.pairs.clone()] {
                if pair.distance < cutoff.cutoff_m {
                    let truth = comparison.truths[pair.truth as usize].id;
                    let track = comparison.tracks[pair.track as usize].id;
                    let gain = 1.0 - of_time.share_of(pair.distance);
                    gains.push((truth, track, index, gain));
                }
            }
        }
        gains.sort_unstable_by_key(|&(truth, track, step, _)| (truth, track, step));
        for of_pair in gains.chunk_by(|left, right| (left.0, left.1) == (right.0, right.1)) {
            lives.meetings.push(Meeting {
                truth: of_pair[0].0,
                track: of_pair[0].1,
                gains: of_pair
                    .iter()
                    .map(|&(_, _, step, gain)| (step, gain))
                    .collect(),
            });
        }
        lives
    }

    fn work(&self) -> u64 {
        self.looked_at
    }

    /// Steps 1 and 2.
    fn distance(&mut self, window: Range<usize>, cutoff: Cutoff) -> Whole {
        let window = window.start as u32..window.end as u32;
        let truths = existing(&self.truths, &window);
        let tracks = existing(&self.tracks, &window);
        self.looked_at = (self.truths.len() + self.tracks.len()) as u64;
        self.solver.clear();
        let by_truth = self
            .meetings
            .chunk_by(|left, right| left.truth == right.truth);
        for of_truth in by_truth {
            let mut has_edge = false;
            for meeting in of_truth {
                let (share, looked_at) = self.share(meeting, &window);
                self.looked_at += looked_at as u64;
                if let Some(share) = share {
                    // D^q as a share of c^q; then D^p as one of c^p.
                    let of_heads = share.powf(cutoff.p / self.q);
                    self.solver.push_edge(meeting.track, of_heads - 1.0);
                    has_edge = true;
                }
            }
            if has_edge {
                self.solver.end_row(0.0);
            }
        }
        let gained = self.solver.solve().unwrap_or_default();
        let heads = truths.max(tracks);
        Whole {
            share: (heads as f64 + gained).max(0.0),
            heads,
        }
    }

    /// D^q / c^q of a pair in a window, `None` where it is never within the cutoff; and how many steps were looked at.
    fn share(&self, meeting: &Meeting, window: &Range<u32>) -> (Option<f64>, usize) {
        let first = meeting
            .gains
            .partition_point(|(step, _)| *step < window.start);
        let mut gained = 0.0;
        let mut met = 0;
        for (step, gain) in &meeting.gains[first..] {
            if *step >= window.end {
                break;
            }
            gained += gain;
            met += 1;
        }
        if met == 0 {
            return (None, 1);
        }
        let truth = within(&self.truths[meeting.truth as usize], window);
        let track = within(&self.tracks[meeting.track as usize], window);
        let either = truth.len() + track.len() - in_common(truth, track);
        let lost = (met as f64 - gained) + (either - met) as f64;
        (Some(lost / either as f64), met + truth.len() + track.len())
    }
}

fn note(presences: &[Presence], step: u32, lives: &mut [Vec<u32>]) {
    for presence in presences {
        lives[presence.id as usize].push(step);
    }
}

/// How many exist in a window.
fn existing(lives: &[Vec<u32>], window: &Range<u32>) -> usize {
    let exists = |life: &&Vec<u32>| !within(life, window).is_empty();
    lives.iter().filter(exists).count()
}

/// Of rising steps those in a window.
fn within<'l>(life: &'l [u32], window: &Range<u32>) -> &'l [u32] {
    let first = life.partition_point(|step| *step < window.start);
    let behind = life.partition_point(|step| *step < window.end);
    &life[first..behind]
}

/// How many members two rising lists have in common.
fn in_common(left: &[u32], right: &[u32]) -> usize {
    let (mut first, mut second, mut both) = (0, 0, 0);
    while first < left.len() && second < right.len() {
        match left[first].cmp(&right[second]) {
            std::cmp::Ordering::Less => first += 1,
            std::cmp::Ordering::Greater => second += 1,
            std::cmp::Ordering::Equal => {
                both += 1;
                first += 1;
                second += 1;
            }
        }
    }
    both
}
