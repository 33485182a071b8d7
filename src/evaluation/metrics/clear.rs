//! CLEAR: MOTA and what it is made of. Counts of the event log, and what sums of similarities and distances add to them.
//!
//! # Reference
//! K. Bernardin, R. Stiefelhagen, Evaluating Multiple Object Tracking Performance: The CLEAR MOT Metrics, EURASIP Journal on
//! Image and Video Processing, 2008; sMOTA: P. Voigtlaender et al., MOTS: Multi-Object Tracking and Segmentation, CVPR 2019;
//! mostly tracked: B. Wu, R. Nevatia, Tracking of Multiple, Partially Occluded Humans, CVPR 2006.
//!
//! # Symbols
//! TP matches, FN misses, FP unmatched track points, IDSW switches; G = TP + FN the truth points; S the sum of similarities.
//!
//! # Method
//! 1. MODA = (TP − FP) / G, MOTA = (TP − FP − IDSW) / G, sMOTA = (S − FP − IDSW) / G,
//!    MOTAL = (TP − FP − log₁₀ IDSW) / G, the logarithm counting 0 without a switch.
//! 2. MOTP is the mean over the matches, of the similarity (larger is better) or of the distance (smaller is better).
//! 3. A truth is mostly tracked when it is matched at 80 % of its steps, mostly lost below 20 %, else partly tracked.
//! 4. `frag` counts the interruptions of a truth's being matched, over the steps at which it exists. `frag_trackeval` is
//!    TrackEval's count: over the steps that have both truths and tracks, whether or not this truth exists.
//! 5. Over time: TP, FN, FP and IDSW of each step.

use super::origin::{DUE_STEPS, EVENTS, Origin, Source, Statistic, TRUTHS};
use super::{BuildMetric, Line, Metric, MetricReport, NOTHING_DUE, Quantity, Sequence, Series};
use crate::evaluation::events::{EventKind, EventLog};
use crate::model::space::Space;
use crate::registry::{Kind, Method, Object, default};
use serde::{Deserialize, Serialize};
use serde_json::json;

pub const METHOD: Method<BuildMetric> = Method {
    name: "clear",
    parameters: &PARAMETERS,
    build: |spec| Ok(Box::new(Clear::deserialize(spec)?)),
};

static PARAMETERS: Object = Object {
    name: "Clear",
    summary: "MOTA and its parts: misses, false positives, identity switches, fragmentation, mostly tracked and mostly lost.",
    fields: &[default(
        "mostly_tracked",
        "at_least: a truth matched at exactly 80 % of its steps is mostly tracked; above: it is not.",
        Kind::Choice(&["at_least", "above"]),
        "\"at_least\"",
    )],
};

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Clear {
    mostly_tracked: Boundary,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Boundary {
    AtLeast,
    Above,
}

/// What one truth went through.
#[derive(Debug, Clone, Copy, Default)]
struct TruthLife {
    steps: u32,
    matched: u32,
    switches: u32,
    interruptions: u32,
    interruptions_trackeval: u32,
    /// The last round (step with both truths and tracks) at which it was matched.
    round: u32,
}

/// The counts of one sequence, or of several together.
#[derive(Debug, Clone, Default)]
struct Counts {
    due_steps: u64,
    kinds: [u64; EventKind::ALL.len()],
    similarity: f64,
    distance: f64,
    frag_trackeval: u64,
    /// Truths mostly tracked, partly tracked, mostly lost.
    classes: [u64; 3],
}

impl Metric for Clear {
    fn accepts(&self, _: Option<Space>) -> bool {
        true
    }

    fn evaluate(&self, sequences: &[Sequence]) -> MetricReport {
        let mut counts = Counts::default();
        let (mut per_truth, mut per_track, mut series) = (Vec::new(), Vec::new(), Vec::new());
        for sequence in sequences {
            let lives = counts.add(sequence);
            let classes: Vec<[u64; 3]> = lives.iter().map(|life| self.class(life)).collect();
            classes
                .iter()
                .flat_map(|class| class.iter().enumerate())
                .for_each(|(place, one)| counts.classes[place] += one);
            if sequences.len() == 1 {
                per_truth = truth_lines(sequence, &lives, &classes);
                per_track = track_lines(sequence);
                series = counts_over_time(sequence.events);
            }
        }
        let first = sequences.first().map(|sequence| sequence.comparison);
        let unit = match first.and_then(|comparison| comparison.space) {
            None => "",
            Some(Space::Bearing) => "deg",
            Some(Space::Plane | Space::Volume) => "m",
        };
        let parameters = json!({
            "gate": first.map(|comparison| comparison.gate),
            "mostly_tracked": self.mostly_tracked,
            "mostly_tracked_share": 0.8,
            "mostly_lost_share": 0.2,
        });
        let report = MetricReport::new("mota", true, parameters, counts.quantities(unit));
        MetricReport {
            per_truth,
            per_track,
            series,
            origins: FROM.to_vec(),
            ..report
        }
    }
}

const NO_TRUTH: &str = "no truth at any step";
const NO_MATCH: &str = "nothing was matched";

const FALSE: &[&str] = &["false_alarm", "redundant", "divergence"];
/// The same as events.
const FALSE_KINDS: [EventKind; 3] = [
    EventKind::FalseAlarm,
    EventKind::Redundant,
    EventKind::Divergence,
];

/// A statistic of a column of the matches in the log.
const fn of_matches(quantity: &'static str, statistic: Statistic, column: &'static str) -> Origin {
    Origin {
        quantity,
        statistic,
        source: Source::Rows {
            file: EVENTS,
            column: Some(column),
            events: &["match"],
        },
    }
}

const FROM: &[Origin] = &[
    Origin::events("tp", &["match"]),
    Origin::events("fn", &["miss"]),
    Origin::events("fp", FALSE),
    Origin::events("fp_false_alarm", &["false_alarm"]),
    Origin::events("fp_redundant", &["redundant"]),
    Origin::events("fp_divergence", &["divergence"]),
    Origin::events("idsw", &["switch"]),
    Origin::events("frag", &["reacquisition"]),
    of_matches("similarity_sum", Statistic::Sum, "similarity"),
    of_matches("motp_similarity", Statistic::Mean, "similarity"),
    of_matches("motp_distance", Statistic::Mean, "distance"),
    Origin::ratio("mota", &["tp", "-fp", "-idsw"], &["tp", "fn"]),
    Origin::ratio("moda", &["tp", "-fp"], &["tp", "fn"]),
    Origin::ratio("smota", &["similarity_sum", "-fp", "-idsw"], &["tp", "fn"]),
    Origin::numbers("log10_idsw", Statistic::Log10, &["idsw"]),
    Origin::ratio("motal", &["tp", "-fp", "-log10_idsw"], &["tp", "fn"]),
    Origin::ratio("recall", &["tp"], &["tp", "fn"]),
    Origin::ratio("precision", &["tp"], &["tp", "fp"]),
    Origin::ratio("f1", &["tp", "tp"], &["tp", "tp", "fn", "fp"]),
    DUE_STEPS,
    Origin::ratio("fp_per_step", &["fp"], &["due_steps"]),
    Origin::sum("frag_trackeval", TRUTHS),
    Origin::sum("mt", TRUTHS),
    Origin::sum("pt", TRUTHS),
    Origin::sum("ml", TRUTHS),
    Origin::ratio("mt_share", &["mt"], &["mt", "pt", "ml"]),
    Origin::ratio("pt_share", &["pt"], &["mt", "pt", "ml"]),
    Origin::ratio("ml_share", &["ml"], &["mt", "pt", "ml"]),
];

impl Clear {
    /// 1 for mostly tracked, partly tracked or mostly lost; in whole numbers, so that 80 % is 80 %.
    fn class(self, life: &TruthLife) -> [u64; 3] {
        let (five_matched, steps) = (5 * u64::from(life.matched), u64::from(life.steps));
        let is_tracked = match self.mostly_tracked {
            Boundary::AtLeast => five_matched >= 4 * steps,
            Boundary::Above => five_matched > 4 * steps,
        };
        match steps {
            0 => [0, 0, 0],
            _ if is_tracked => [1, 0, 0],
            _ if five_matched < steps => [0, 0, 1],
            _ => [0, 1, 0],
        }
    }
}

impl Counts {
    /// Adds a sequence; says how each of its truths fared.
    fn add(&mut self, sequence: &Sequence) -> Vec<TruthLife> {
        let Sequence {
            comparison, events, ..
        } = sequence;
        let mut lives = vec![TruthLife::default(); comparison.truth_ids.len()];
        let mut round = 0;
        self.due_steps += comparison.due_steps() as u64;
        for (step, range) in comparison.steps.iter().zip(&events.steps) {
            round += u32::from(!step.truths.is_empty() && !step.tracks.is_empty());
            for event in &events.events[range.clone()] {
                self.kinds[event.kind as usize] += 1;
                let Some(life) = event.truth.map(|truth| &mut lives[truth as usize]) else {
                    continue;
                };
                match event.kind {
                    EventKind::Match => {
                        let distance = event.distance.unwrap_or(0.0);
                        self.distance += distance;
                        self.similarity += comparison.similarity(distance);
                        life.steps += 1;
                        life.matched += 1;
                        life.interruptions_trackeval +=
                            u32::from(life.round > 0 && life.round + 1 < round);
                        life.round = round;
                    }
                    EventKind::Miss => life.steps += 1,
                    EventKind::Switch => life.switches += 1,
                    EventKind::Reacquisition => life.interruptions += 1,
                    _ => {}
                }
            }
        }
        self.frag_trackeval += lives
            .iter()
            .map(|life| u64::from(life.interruptions_trackeval))
            .sum::<u64>();
        lives
    }

    fn count(&self, kind: EventKind) -> f64 {
        self.kinds[kind as usize] as f64
    }

    fn quantities(&self, distance_unit: &'static str) -> Vec<Quantity> {
        let (tp, missed, switches) = (
            self.count(EventKind::Match),
            self.count(EventKind::Miss),
            self.count(EventKind::Switch),
        );
        let parts = FALSE_KINDS.map(|kind| self.count(kind));
        let fp: f64 = parts.iter().sum();
        let truth_points = tp + missed;
        let log_switches = if switches > 0.0 {
            switches.log10()
        } else {
            0.0
        };
        let truths = self.classes.iter().sum::<u64>() as f64;
        let [mostly_tracked, partly_tracked, mostly_lost] =
            self.classes.map(|truths| truths as f64);
        let of_truth = |name, over: f64| Quantity::ratio(name, over, truth_points, "", NO_TRUTH);
        vec![
            of_truth("mota", tp - fp - switches),
            of_truth("moda", tp - fp),
            Quantity::ratio("motp_similarity", self.similarity, tp, "", NO_MATCH),
            Quantity::ratio("motp_distance", self.distance, tp, distance_unit, NO_MATCH),
            of_truth("smota", self.similarity - fp - switches),
            of_truth("motal", tp - fp - log_switches),
            of_truth("recall", tp),
            Quantity::ratio("precision", tp, tp + fp, "", "no track at any step"),
            Quantity::ratio(
                "f1",
                tp,
                tp + (missed + fp) / 2.0,
                "",
                "neither truth nor track at any step",
            ),
            Quantity::count("tp", tp),
            Quantity::count("fn", missed),
            Quantity::count("fp", fp),
            Quantity::count("fp_false_alarm", parts[0]),
            Quantity::count("fp_redundant", parts[1]),
            Quantity::count("fp_divergence", parts[2]),
            Quantity::ratio("fp_per_step", fp, self.due_steps as f64, "", NOTHING_DUE),
            Quantity::count("idsw", switches),
            Quantity::count("frag", self.count(EventKind::Reacquisition)),
            Quantity::count("frag_trackeval", self.frag_trackeval as f64),
            Quantity::count("mt", mostly_tracked),
            Quantity::count("pt", partly_tracked),
            Quantity::count("ml", mostly_lost),
            Quantity::ratio("mt_share", mostly_tracked, truths, "", NO_TRUTH),
            Quantity::ratio("pt_share", partly_tracked, truths, "", NO_TRUTH),
            Quantity::ratio("ml_share", mostly_lost, truths, "", NO_TRUTH),
        ]
    }
}

/// Matches, misses, false positives and switches at each step.
fn counts_over_time(events: &EventLog) -> Vec<Series> {
    let mut columns: [Vec<Option<f64>>; 4] = Default::default();
    for range in &events.steps {
        let mut kinds = [0.0; EventKind::ALL.len()];
        for event in &events.events[range.clone()] {
            kinds[event.kind as usize] += 1.0;
        }
        let of = |kind: EventKind| kinds[kind as usize];
        let fp = FALSE_KINDS.map(of).iter().sum();
        let counts = [
            of(EventKind::Match),
            of(EventKind::Miss),
            fp,
            of(EventKind::Switch),
        ];
        for (column, count) in columns.iter_mut().zip(counts) {
            column.push(Some(count));
        }
    }
    let named = ["tp", "fn", "fp", "idsw"].into_iter().zip(columns);
    named
        .map(|(name, counts)| Series::over_time(name, "", counts.into_iter()))
        .collect()
}

fn truth_lines(sequence: &Sequence, lives: &[TruthLife], classes: &[[u64; 3]]) -> Vec<Line> {
    let ids = sequence.comparison.truth_ids.iter();
    ids.zip(lives)
        .zip(classes)
        .map(|((id, life), class)| Line {
            id: id.clone(),
            quantities: truth_quantities(life, class),
        })
        .collect()
}

fn truth_quantities(life: &TruthLife, class: &[u64; 3]) -> Vec<Quantity> {
    let (matched, steps) = (f64::from(life.matched), f64::from(life.steps));
    vec![
        Quantity::count("steps", life.steps),
        Quantity::count("tp", life.matched),
        Quantity::count("fn", life.steps - life.matched),
        Quantity::ratio("recall", matched, steps, "", "does not exist at any step"),
        Quantity::count("idsw", life.switches),
        Quantity::count("frag", life.interruptions),
        Quantity::count("frag_trackeval", life.interruptions_trackeval),
        Quantity::new("mt", class[0] as f64, ""),
        Quantity::new("pt", class[1] as f64, ""),
        Quantity::new("ml", class[2] as f64, ""),
    ]
}

fn track_lines(sequence: &Sequence) -> Vec<Line> {
    let mut counts = vec![[0; EventKind::ALL.len()]; sequence.comparison.track_ids.len()];
    for event in &sequence.events.events {
        if let Some(track) = event.track {
            counts[track as usize][event.kind as usize] += 1;
        }
    }
    let ids = sequence.comparison.track_ids.iter();
    ids.zip(&counts)
        .map(|(id, counts)| Line {
            id: id.clone(),
            quantities: track_quantities(counts),
        })
        .collect()
}

fn track_quantities(counts: &[u32; EventKind::ALL.len()]) -> Vec<Quantity> {
    let of = |kind: EventKind| f64::from(counts[kind as usize]);
    let (tp, alarms) = (of(EventKind::Match), of(EventKind::FalseAlarm));
    let (redundant, divergence) = (of(EventKind::Redundant), of(EventKind::Divergence));
    let fp = alarms + redundant + divergence;
    vec![
        Quantity::new("steps", tp + fp, ""),
        Quantity::new("tp", tp, ""),
        Quantity::new("fp", fp, ""),
        Quantity::ratio("precision", tp, tp + fp, "", "does not exist at any step"),
        Quantity::new("fp_false_alarm", alarms, ""),
        Quantity::new("fp_redundant", redundant, ""),
        Quantity::new("fp_divergence", divergence, ""),
    ]
}

#[cfg(test)]
mod tests;
