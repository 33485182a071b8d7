//! The probabilities of the verdicts with what each is a share of, so that none stands alone.

use super::report::{Counts, Tolerance};
use serde::Serialize;

/// A share of the targets or of the output tracks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = TfaShare))]
pub struct Share {
    /// `correct`, `missed`, `late` or `false` of targets; `correct`, `matched`, `redundant` or `false` of output tracks.
    pub name: &'static str,
    /// Errors that are forgiven: 0 of the strict automaton.
    pub forgiven: usize,
    /// `targets` or `output_tracks`.
    pub of: &'static str,
    pub numerator: usize,
    pub denominator: usize,
    /// Null over nothing.
    pub value: Option<f64>,
}

const TARGETS: &str = "targets";
const OUTPUT_TRACKS: &str = "output_tracks";

/// Of the strict automaton, then of those that forgive more and more.
pub fn shares(counts: &Counts, tolerance: &[Tolerance]) -> Vec<Share> {
    let strict = [
        ("correct", TARGETS, counts.correct),
        ("missed", TARGETS, counts.missed),
        ("late", TARGETS, counts.late),
        ("false", TARGETS, counts.wrong),
        ("correct", OUTPUT_TRACKS, counts.correct),
        ("matched", OUTPUT_TRACKS, counts.matched_tracks),
        ("redundant", OUTPUT_TRACKS, counts.redundant_tracks),
        ("false", OUTPUT_TRACKS, counts.false_tracks),
    ];
    let mut shares: Vec<Share> = strict
        .into_iter()
        .map(|(name, of, numerator)| share(counts, (name, 0), of, numerator))
        .collect();
    for line in tolerance.iter().filter(|line| line.k > 0) {
        for of in [TARGETS, OUTPUT_TRACKS] {
            shares.push(share(counts, ("correct", line.k), of, line.correct));
        }
    }
    shares
}

fn share(
    counts: &Counts,
    (name, forgiven): (&'static str, usize),
    of: &'static str,
    numerator: usize,
) -> Share {
    let denominator = if of == TARGETS {
        counts.targets
    } else {
        counts.output_tracks
    };
    Share {
        name,
        forgiven,
        of,
        numerator,
        denominator,
        value: (denominator > 0).then(|| numerator as f64 / denominator as f64),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_share_names_what_it_is_of() {
        let counts = Counts {
            targets: 10,
            output_tracks: 8,
            correct: 6,
            missed: 3,
            late: 2,
            wrong: 1,
            matched_tracks: 7,
            redundant_tracks: 1,
            false_tracks: 0,
            violations: 0,
            unknown_detections: 0,
        };
        let line = |k, correct| Tolerance {
            k,
            correct,
            probability: None,
        };
        let all = shares(&counts, &[line(0, 6), line(1, 7)]);
        let told: Vec<_> = all
            .iter()
            .map(|one| (one.name, one.forgiven, one.of, one.value.unwrap()))
            .collect();
        let expected = [
            ("correct", 0, TARGETS, 0.6),
            ("missed", 0, TARGETS, 0.3),
            ("late", 0, TARGETS, 0.2),
            ("false", 0, TARGETS, 0.1),
            ("correct", 0, OUTPUT_TRACKS, 0.75),
            ("matched", 0, OUTPUT_TRACKS, 0.875),
            ("redundant", 0, OUTPUT_TRACKS, 0.125),
            ("false", 0, OUTPUT_TRACKS, 0.0),
            ("correct", 1, TARGETS, 0.7),
            ("correct", 1, OUTPUT_TRACKS, 0.875),
        ];
        assert_eq!(told, expected);
    }
}
