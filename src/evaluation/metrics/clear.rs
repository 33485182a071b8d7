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

use super::origin::{EVENTS, Origin, STEPS, Source, Statistic, TRUTHS};
use super::{BuildMetric, Line, Metric, MetricReport, Quantity, Sequence};
use crate::evaluation::comparison::Shape;
use crate::evaluation::events::EventKind;
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
struct Life {
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
    steps: u64,
    kinds: [u64; EventKind::ALL.len()],
    similarity: f64,
    distance: f64,
    frag_trackeval: u64,
    /// Truths mostly tracked, partly tracked, mostly lost.
    classes: [u64; 3],
}

impl Metric for Clear {
    fn accepts(&self, shape: Shape) -> bool {
        shape != Shape::Bearings
    }

    fn evaluate(&self, sequences: &[Sequence]) -> MetricReport {
        let mut counts = Counts::default();
        let (mut per_truth, mut per_track) = (Vec::new(), Vec::new());
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
            }
        }
        let first = sequences.first().map(|sequence| sequence.comparison);
        let unit = if first.is_some_and(|comparison| comparison.shape == Shape::Points) {
            "m"
        } else {
            ""
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
            origins: FROM.to_vec(),
            ..report
        }
    }
}

const FALSE: &[&str] = &["false_alarm", "redundant", "divergence"];

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
    STEPS,
    Origin::ratio("fp_per_step", &["fp"], &["steps"]),
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
    fn class(self, life: &Life) -> [u64; 3] {
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
    fn add(&mut self, sequence: &Sequence) -> Vec<Life> {
        let Sequence {
            comparison, events, ..
        } = sequence;
        let mut lives = vec![Life::default(); comparison.truth_ids.len()];
        let mut round = 0;
        self.steps += comparison.steps.len() as u64;
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

    fn of(&self, kind: EventKind) -> f64 {
        self.kinds[kind as usize] as f64
    }

    fn quantities(&self, distance_unit: &'static str) -> Vec<Quantity> {
        let (tp, missed, switches) = (
            self.of(EventKind::Match),
            self.of(EventKind::Miss),
            self.of(EventKind::Switch),
        );
        let parts = [
            EventKind::FalseAlarm,
            EventKind::Redundant,
            EventKind::Divergence,
        ]
        .map(|kind| self.of(kind));
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
        let count = |name, count: f64| Quantity::new(name, count, "");
        let of_truth =
            |name, over: f64| Quantity::ratio(name, over, truth_points, "", "no truth at any step");
        let of_matches =
            |name, over: f64, unit| Quantity::ratio(name, over, tp, unit, "nothing was matched");
        let of_truths =
            |name, over: f64| Quantity::ratio(name, over, truths, "", "no truth at any step");
        vec![
            of_truth("mota", tp - fp - switches),
            of_truth("moda", tp - fp),
            of_matches("motp_similarity", self.similarity, ""),
            of_matches("motp_distance", self.distance, distance_unit),
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
            count("tp", tp),
            count("fn", missed),
            count("fp", fp),
            count("fp_false_alarm", parts[0]),
            count("fp_redundant", parts[1]),
            count("fp_divergence", parts[2]),
            Quantity::ratio("fp_per_step", fp, self.steps as f64, "", "no step"),
            count("idsw", switches),
            count("frag", self.of(EventKind::Reacquisition)),
            count("frag_trackeval", self.frag_trackeval as f64),
            count("mt", mostly_tracked),
            count("pt", partly_tracked),
            count("ml", mostly_lost),
            of_truths("mt_share", mostly_tracked),
            of_truths("pt_share", partly_tracked),
            of_truths("ml_share", mostly_lost),
        ]
    }
}

fn truth_lines(sequence: &Sequence, lives: &[Life], classes: &[[u64; 3]]) -> Vec<Line> {
    let line = |((id, life), class): ((&String, &Life), &[u64; 3])| {
        let count = |name, count: u32| Quantity::new(name, f64::from(count), "");
        let (matched, steps) = (f64::from(life.matched), f64::from(life.steps));
        let quantities = vec![
            count("steps", life.steps),
            count("tp", life.matched),
            count("fn", life.steps - life.matched),
            Quantity::ratio("recall", matched, steps, "", "does not exist at any step"),
            count("idsw", life.switches),
            count("frag", life.interruptions),
            count("frag_trackeval", life.interruptions_trackeval),
            Quantity::new("mt", class[0] as f64, ""),
            Quantity::new("pt", class[1] as f64, ""),
            Quantity::new("ml", class[2] as f64, ""),
        ];
        Line {
            id: id.clone(),
            quantities,
        }
    };
    sequence
        .comparison
        .truth_ids
        .iter()
        .zip(lives)
        .zip(classes)
        .map(line)
        .collect()
}

fn track_lines(sequence: &Sequence) -> Vec<Line> {
    let mut counts = vec![[0u32; EventKind::ALL.len()]; sequence.comparison.track_ids.len()];
    for event in &sequence.events.events {
        if let Some(track) = event.track {
            counts[track as usize][event.kind as usize] += 1;
        }
    }
    let line = |(id, counts): (&String, &[u32; EventKind::ALL.len()])| {
        let of = |kind: EventKind| f64::from(counts[kind as usize]);
        let (tp, alarms) = (of(EventKind::Match), of(EventKind::FalseAlarm));
        let (redundant, divergence) = (of(EventKind::Redundant), of(EventKind::Divergence));
        let fp = alarms + redundant + divergence;
        let quantities = vec![
            Quantity::new("steps", tp + fp, ""),
            Quantity::new("tp", tp, ""),
            Quantity::new("fp", fp, ""),
            Quantity::ratio("precision", tp, tp + fp, "", "does not exist at any step"),
            Quantity::new("fp_false_alarm", alarms, ""),
            Quantity::new("fp_redundant", redundant, ""),
            Quantity::new("fp_divergence", divergence, ""),
        ];
        Line {
            id: id.clone(),
            quantities,
        }
    };
    sequence
        .comparison
        .track_ids
        .iter()
        .zip(&counts)
        .map(line)
        .collect()
}

#[cfg(test)]
mod tests {
    use crate::evaluation::comparison::Comparison;
    use crate::evaluation::tests::{
        GONE, Places, assert_quantities, compare, evaluate, line, main_scene, swap_scene,
    };
    use serde_json::json;

    fn clear(comparisons: &[Comparison]) -> super::MetricReport {
        evaluate("clear", json!({}), comparisons)
    }

    #[test]
    fn the_swap_scene_keeps_pairs_inside_the_gate() {
        // After the crossing both pairs are kept for one step (distances √37 and √36.25), then exchanged.
        let report = clear(&[swap_scene(10.0)]);
        let distance_m = (10.0 * 1.5 + 37f64.sqrt() + 36.25f64.sqrt()) / 22.0;
        let expected = [
            ("mota", Some(20.0 / 22.0)),
            ("motp_distance", Some(distance_m)),
            ("idsw", Some(2.0)),
            ("frag", Some(0.0)),
        ];
        assert_quantities(&report, &expected);
        assert!(
            (report.quantity("motp_distance").unwrap() - 1.231_979_991_804_289_5).abs() < 1e-12
        );
        assert_quantities(
            &report,
            &[
                ("motp_similarity", Some(1.0 - distance_m / 20.0)),
                ("mt", Some(2.0)),
                ("moda", Some(1.0)),
            ],
        );
    }

    #[test]
    fn the_main_scene_by_hand() {
        // 18 truth points. A: T1 at 0..5, T3 at 7..9 (a break, a switch); B: T2 at 3..9, at 7 with an error of 10.
        let report = clear(&[main_scene(10.0)]);
        let counts = [
            ("tp", Some(16.0)),
            ("fn", Some(2.0)),
            ("fp", Some(3.0)),
            ("idsw", Some(1.0)),
            ("frag", Some(1.0)),
        ];
        assert_quantities(&report, &counts);
        let ratios = [
            ("mota", Some(12.0 / 18.0)),
            ("motal", Some(13.0 / 18.0)),
            ("precision", Some(16.0 / 19.0)),
            ("f1", Some(16.0 / 18.5)),
        ];
        assert_quantities(&report, &ratios);
        assert_quantities(
            &report,
            &[
                ("motp_distance", Some(2.544_383_064_661_009_3)),
                ("fp_false_alarm", Some(3.0)),
                ("fp_per_step", Some(0.3)),
            ],
        );
        // Just below 10 m the error is a miss and a diverged track: the reference's mean of the other 15.
        let report = clear(&[main_scene(9.999)]);
        assert_quantities(
            &report,
            &[
                ("motp_distance", Some(2.047_341_935_638_409_7)),
                ("fp_divergence", Some(1.0)),
                ("fn", Some(3.0)),
            ],
        );
        assert_quantities(
            &report,
            &[
                ("mota", Some(1.0 - 8.0 / 18.0)),
                ("frag", Some(2.0)),
                ("frag_trackeval", Some(2.0)),
            ],
        );
    }

    #[test]
    fn truths_and_tracks_have_lines() {
        let report = clear(&[main_scene(10.0)]);
        let truth = [
            ("steps", Some(10.0)),
            ("tp", Some(9.0)),
            ("fn", Some(1.0)),
            ("recall", Some(0.9)),
            ("idsw", Some(1.0)),
            ("frag", Some(1.0)),
            ("frag_trackeval", Some(1.0)),
            ("mt", Some(1.0)),
            ("pt", Some(0.0)),
            ("ml", Some(0.0)),
        ];
        assert_eq!(line(&report.per_truth, "A"), truth);
        assert_eq!(
            line(&report.per_track, "T4")[..4],
            [
                ("steps", Some(3.0)),
                ("tp", Some(0.0)),
                ("fp", Some(3.0)),
                ("precision", Some(0.0))
            ]
        );
        assert!(
            clear(&[main_scene(10.0), main_scene(10.0)])
                .per_truth
                .is_empty()
        );
    }

    #[test]
    fn the_two_fragmentations_differ_where_nobody_is_tracked_and_where_a_truth_is_gone() {
        // One hole in the only track: a step without any track, which TrackEval does not see.
        let hole = [0.0, 0.0, GONE, 0.0, 0.0];
        let report = clear(&[compare(&[("A", &[0.0; 5])], &[("T", &hole)], 10.0)]);
        assert_quantities(
            &report,
            &[
                ("frag", Some(1.0)),
                ("frag_trackeval", Some(0.0)),
                ("mota", Some(0.8)),
                ("idsw", Some(0.0)),
            ],
        );
        // The truth is gone while another is tracked: no interruption, but TrackEval counts one.
        let other: Places = ("B", &[50.0; 5]);
        let report = clear(&[compare(
            &[("A", &hole), other],
            &[("T", &hole), ("U", &[50.0; 5])],
            10.0,
        )]);
        assert_quantities(
            &report,
            &[
                ("frag", Some(0.0)),
                ("frag_trackeval", Some(1.0)),
                ("mota", Some(1.0)),
            ],
        );
    }

    #[test]
    fn eighty_percent_is_mostly_tracked_unless_asked_otherwise() {
        let scene = || {
            [compare(
                &[("A", &[0.0; 5]), ("B", &[50.0; 5])],
                &[
                    ("T", &[0.0, 0.0, 0.0, 0.0, 30.0]),
                    ("U", &[50.0, GONE, GONE, GONE, GONE]),
                ],
                10.0,
            )]
        };
        // A at 4 of 5 steps; B at 1 of 5, which is not below 20 %.
        let expected = [
            ("mt", Some(1.0)),
            ("pt", Some(1.0)),
            ("ml", Some(0.0)),
            ("mt_share", Some(0.5)),
        ];
        assert_quantities(&clear(&scene()), &expected);
        let report = evaluate("clear", json!({"mostly_tracked": "above"}), &scene());
        assert_quantities(
            &report,
            &[("mt", Some(0.0)), ("pt", Some(2.0)), ("ml", Some(0.0))],
        );
        assert_eq!(report.parameters["mostly_tracked"], "above");
    }

    #[test]
    fn the_logarithm_of_switches() {
        // A and B exchange their tracks at steps 1 and 2: four switches; TP 6 of 6.
        let report = clear(&[compare(
            &[("A", &[0.0; 3]), ("B", &[50.0; 3])],
            &[("T", &[0.0, 50.0, 0.0]), ("U", &[50.0, 0.0, 50.0])],
            10.0,
        )]);
        assert_quantities(
            &report,
            &[
                ("idsw", Some(4.0)),
                ("mota", Some(2.0 / 6.0)),
                ("motal", Some((6.0 - 4f64.log10()) / 6.0)),
                ("smota", Some(2.0 / 6.0)),
            ],
        );
    }

    #[test]
    fn edges() {
        let truth: [Places; 2] = [("A", &[0.0; 3]), ("B", &[50.0; 3])];
        let report = clear(&[compare(&truth, &[], 10.0)]);
        assert_quantities(
            &report,
            &[
                ("mota", Some(0.0)),
                ("recall", Some(0.0)),
                ("precision", None),
                ("motp_distance", None),
                ("ml", Some(2.0)),
            ],
        );
        assert_quantities(
            &report,
            &[
                ("ml_share", Some(1.0)),
                ("fn", Some(6.0)),
                ("f1", Some(0.0)),
                ("motp_similarity", None),
            ],
        );
        let report = clear(&[compare(&[], &truth, 10.0)]);
        assert_quantities(
            &report,
            &[
                ("mota", None),
                ("fp", Some(6.0)),
                ("recall", None),
                ("precision", Some(0.0)),
                ("ml_share", None),
            ],
        );
        assert_eq!(
            (report.value, report.reason),
            (None, Some("no truth at any step"))
        );
        let report = clear(&[compare(&[], &[], 10.0)]);
        assert_quantities(
            &report,
            &[
                ("mota", None),
                ("f1", None),
                ("precision", None),
                ("fp_per_step", None),
                ("tp", Some(0.0)),
            ],
        );
        assert_quantities(&clear(&[]), &[("mota", None), ("tp", Some(0.0))]);
    }

    #[test]
    fn sequences_combine_from_counts() {
        // 12 of 18 and −3 with nothing to find: together (12 − 3) / 18, not the mean of the ratios.
        let alarms = compare(&[], &[("T", &[0.0; 3])], 10.0);
        let report = clear(&[main_scene(10.0), alarms]);
        assert_quantities(
            &report,
            &[
                ("mota", Some(9.0 / 18.0)),
                ("fp", Some(6.0)),
                ("fp_per_step", Some(6.0 / 13.0)),
                ("mt", Some(2.0)),
            ],
        );
    }
}
