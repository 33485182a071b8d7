//! Identity: how well one track for each truth, and one truth for each track, explain the whole.
//!
//! # Reference
//! E. Ristani, F. Solera, R. Zou, R. Cucchiara, C. Tomasi, Performance Measures and a Data Set for Multi-Target, Multi-Camera
//! Tracking, ECCV Workshops 2016.
//!
//! # Method
//! 1. nᵢⱼ: at how many steps truth i and track j are within the gate of each other, whoever else is there.
//! 2. The assignment of truths to tracks with the greatest Σ nᵢⱼ; that sum is IDTP. Only pairs that ever met are edges, so
//!    truths and tracks that have nothing to do with each other cost nothing.
//! 3. IDFN and IDFP are the other points of truths and tracks; IDR = IDTP / (IDTP + IDFN), IDP = IDTP / (IDTP + IDFP),
//!    IDF1 = IDTP / (IDTP + (IDFN + IDFP) / 2). Over time: IDTP, IDFN and IDFP of each step.

use super::origin::{Origin, PAIRS, PairColumn, Statistic, TRACK_POINTS, TRUTH_POINTS};
use super::{BuildMetric, Line, Metric, MetricReport, Quantity, Sequence, Series};
use crate::evaluation::comparison::{Comparison, Presence};
use crate::math::assignment::AssignmentSolver;
use crate::model::space::Space;
use crate::registry::{Method, Object};
use serde_json::json;

pub const METHOD: Method<BuildMetric> = Method {
    name: "identity",
    parameters: &PARAMETERS,
    build: |_| Ok(Box::new(Identity)),
};

static PARAMETERS: Object = Object {
    name: "Identity",
    summary: "IDF1, IDP and IDR: points explained by one track for each truth, over all time.",
    fields: &[],
};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Identity;

impl Metric for Identity {
    fn accepts(&self, _: Option<Space>) -> bool {
        true
    }

    fn evaluate(&self, sequences: &[Sequence]) -> MetricReport {
        let mut total = [0u64; 3];
        let (mut per_truth, mut per_track) = (Vec::new(), Vec::new());
        let (mut pairs, mut series) = (Vec::new(), Vec::new());
        for sequence in sequences {
            let comparison = sequence.comparison;
            let explained = Explained::new(comparison);
            let idtp: u64 = explained
                .of_truth
                .iter()
                .map(|&count| u64::from(count))
                .sum();
            let points = [
                idtp,
                comparison.truths.len() as u64,
                comparison.tracks.len() as u64,
            ];
            total
                .iter_mut()
                .zip(points)
                .for_each(|(sum, more)| *sum += more);
            if sequences.len() == 1 {
                per_truth = lines(
                    &comparison.truth_ids,
                    &comparison.truths,
                    &explained.of_truth,
                    "idfn",
                );
                per_track = lines(
                    &comparison.track_ids,
                    &comparison.tracks,
                    &explained.of_track,
                    "idfp",
                );
                let column = PairColumn::new("explained", "", explained.pairs(comparison));
                let names = ["idtp", "idfn", "idfp"];
                series = Series::of_matched(names, comparison, &column.sums(comparison));
                pairs = vec![column];
            }
        }
        let parameters =
            json!({"gate": sequences.first().map(|sequence| sequence.comparison.gate)});
        let report = MetricReport::new(
            "idf1",
            true,
            parameters,
            quantities(total.map(|count| count as f64)),
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
    Origin::rows("idtp", Statistic::Count, PAIRS, "explained"),
    Origin::terms("idfn", &["truth_points", "-idtp"]),
    Origin::terms("idfp", &["track_points", "-idtp"]),
    TRUTH_POINTS,
    TRACK_POINTS,
    Origin::ratio("idf1", &["idtp", "idtp"], &["truth_points", "track_points"]),
    Origin::ratio("idp", &["idtp"], &["track_points"]),
    Origin::ratio("idr", &["idtp"], &["truth_points"]),
];

/// How many points of each truth and of each track its partner explains.
struct Explained {
    of_truth: Vec<u32>,
    of_track: Vec<u32>,
    /// Of each truth its partner.
    partner: Vec<Option<u32>>,
}

impl Explained {
    fn new(comparison: &Comparison) -> Explained {
        let acquaintances = comparison.acquaintances();
        let mut meetings = vec![0u32; acquaintances.ids.len()];
        for (pair, &acquaintance) in comparison.pairs.iter().zip(&acquaintances.of_pair) {
            meetings[acquaintance as usize] += u32::from(pair.distance <= comparison.gate);
        }
        let mut solver = AssignmentSolver::default();
        let mut rows = Vec::with_capacity(comparison.truth_ids.len());
        let mut from = 0;
        for truth in 0..comparison.truth_ids.len() as u32 {
            rows.push(from);
            while let Some(&(_, track)) = acquaintances.ids.get(from).filter(|ids| ids.0 == truth) {
                // Who never met is no partner: NaN is no edge.
                let cost = if meetings[from] > 0 {
                    -f64::from(meetings[from])
                } else {
                    f64::NAN
                };
                solver.push_edge(track, cost);
                from += 1;
            }
            solver.end_row(0.0);
        }
        let is_solved = solver.solve().is_some();
        debug_assert!(
            is_solved,
            "an assignment in which everyone may stay alone exists"
        );
        let mut explained = Explained {
            of_truth: vec![0; rows.len()],
            of_track: vec![0; comparison.track_ids.len()],
            partner: vec![None; rows.len()],
        };
        for (truth, first) in rows.into_iter().enumerate() {
            if let Some(edge) = solver.edge_of(truth) {
                let track = acquaintances.ids[first + edge].1;
                explained.of_truth[truth] = meetings[first + edge];
                explained.of_track[track as usize] = meetings[first + edge];
                explained.partner[truth] = Some(track);
            }
        }
        explained
    }

    /// The pairs of partners within the gate.
    fn pairs(&self, comparison: &Comparison) -> Vec<(u32, u32, f64)> {
        let mut explained = Vec::new();
        for pair in &comparison.pairs {
            let truth = comparison.truths[pair.truth as usize].id;
            let track = comparison.tracks[pair.track as usize].id;
            if pair.distance <= comparison.gate && self.partner[truth as usize] == Some(track) {
                explained.push((pair.truth, pair.track, 1.0));
            }
        }
        explained
    }
}

fn quantities([idtp, truth_points, track_points]: [f64; 3]) -> Vec<Quantity> {
    let mean_points = (truth_points + track_points) / 2.0;
    vec![
        Quantity::ratio(
            "idf1",
            idtp,
            mean_points,
            "",
            "neither truth nor track at any step",
        ),
        Quantity::ratio("idp", idtp, track_points, "", "no track at any step"),
        Quantity::ratio("idr", idtp, truth_points, "", "no truth at any step"),
        Quantity::new("idtp", idtp, ""),
        Quantity::new("idfn", truth_points - idtp, ""),
        Quantity::new("idfp", track_points - idtp, ""),
    ]
}

fn lines(
    ids: &[String],
    presences: &[Presence],
    explained: &[u32],
    rest: &'static str,
) -> Vec<Line> {
    let mut points = vec![0u32; ids.len()];
    presences
        .iter()
        .for_each(|presence| points[presence.id as usize] += 1);
    let line = |((id, &points), &idtp): ((&String, &u32), &u32)| {
        let (points, idtp) = (f64::from(points), f64::from(idtp));
        let quantities = vec![
            Quantity::new("idtp", idtp, ""),
            Quantity::new(rest, points - idtp, ""),
            Quantity::ratio(
                "explained_share",
                idtp,
                points,
                "",
                "does not exist at any step",
            ),
        ];
        Line {
            id: id.clone(),
            quantities,
        }
    };
    ids.iter().zip(&points).zip(explained).map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::MetricReport;
    use crate::evaluation::comparison::Comparison;
    use crate::evaluation::tests::{
        GONE, assert_quantities, compare, evaluate, line, main_scene, swap_scene,
    };
    use serde_json::json;

    fn identity(comparisons: &[Comparison]) -> MetricReport {
        evaluate("identity", json!({}), comparisons)
    }

    #[test]
    fn one_track_explains_one_truth() {
        // A is explained by T1 (6 of 10; T3 has 3), B by T2 (7 of 8); 19 track points.
        let report = identity(&[main_scene(10.0)]);
        let expected = [
            ("idtp", Some(13.0)),
            ("idfn", Some(5.0)),
            ("idfp", Some(6.0)),
            ("idf1", Some(26.0 / 37.0)),
        ];
        assert_quantities(&report, &expected);
        assert_quantities(
            &report,
            &[("idp", Some(13.0 / 19.0)), ("idr", Some(13.0 / 18.0))],
        );
        assert_eq!(
            line(&report.per_truth, "A"),
            [
                ("idtp", Some(6.0)),
                ("idfn", Some(4.0)),
                ("explained_share", Some(0.6))
            ]
        );
        assert_eq!(
            line(&report.per_track, "T3"),
            [
                ("idtp", Some(0.0)),
                ("idfp", Some(3.0)),
                ("explained_share", Some(0.0))
            ]
        );
    }

    #[test]
    fn exchanged_identities_count_once() {
        // S1 is within 10 m of A at 0..=6 (at 6 √37), and so is S2 of B; each of the other truth at 5..=10.
        assert_quantities(
            &identity(&[swap_scene(10.0)]),
            &[("idtp", Some(14.0)), ("idf1", Some(14.0 / 22.0))],
        );
    }

    #[test]
    fn the_greatest_sum_is_not_the_sum_of_the_greatest() {
        // T is 3 steps near A and 2 near B at once; U is 2 steps near A: A–U and B–T explain 4, A–T alone 3.
        let truths: [(&str, &[f64]); 2] = [
            ("A", &[0.0, 0.0, 0.0, 0.0, 0.0]),
            ("B", &[5.0, 5.0, GONE, GONE, GONE]),
        ];
        let tracks: [(&str, &[f64]); 2] = [
            ("T", &[2.0, 2.0, 2.0, GONE, GONE]),
            ("U", &[GONE, GONE, GONE, 1.0, 1.0]),
        ];
        assert_quantities(
            &identity(&[compare(&truths, &tracks, 10.0)]),
            &[
                ("idtp", Some(4.0)),
                ("idfn", Some(3.0)),
                ("idfp", Some(1.0)),
            ],
        );
    }

    #[test]
    fn edges() {
        let report = identity(&[compare(&[("A", &[0.0; 3])], &[], 10.0)]);
        assert_quantities(
            &report,
            &[
                ("idf1", Some(0.0)),
                ("idr", Some(0.0)),
                ("idp", None),
                ("idfn", Some(3.0)),
            ],
        );
        let report = identity(&[compare(&[], &[("T", &[0.0; 3])], 10.0)]);
        assert_quantities(
            &report,
            &[
                ("idf1", Some(0.0)),
                ("idr", None),
                ("idp", Some(0.0)),
                ("idfp", Some(3.0)),
            ],
        );
        let report = identity(&[compare(&[], &[], 10.0)]);
        assert_quantities(
            &report,
            &[
                ("idf1", None),
                ("idr", None),
                ("idp", None),
                ("idtp", Some(0.0)),
            ],
        );
        let report = identity(&[compare(
            &[("A", &[0.0; 5])],
            &[("T", &[0.0, 0.0, GONE, 0.0, 0.0])],
            10.0,
        )]);
        assert_quantities(
            &report,
            &[
                ("idf1", Some(8.0 / 9.0)),
                ("idp", Some(1.0)),
                ("idr", Some(0.8)),
            ],
        );
    }

    #[test]
    fn sequences_combine_from_counts() {
        let report = identity(&[main_scene(10.0), swap_scene(10.0)]);
        assert_quantities(
            &report,
            &[
                ("idtp", Some(27.0)),
                ("idf1", Some(27.0 / ((18.0 + 22.0 + 19.0 + 22.0) / 2.0))),
            ],
        );
    }
}
