//! Which numbers of a result are shares or probabilities, so that an interval of their mean ends within 0 and 1.

use crate::math::stats::Interval;

pub(super) const SHARE: Interval = Interval {
    low: 0.0,
    high: 1.0,
};
/// What two of them can differ by.
pub(super) const DIFFERENCE: Interval = Interval {
    low: -1.0,
    high: 1.0,
};

const PARTS: [&str; 11] = [
    "tfa.probability.correct",
    "tfa.probability.missed",
    "tfa.probability.false",
    "tfa.ratios.correct_per_target",
    "tfa.consistent",
    "grouping.accuracy",
    "grouping.precision",
    "grouping.recall",
    "truth.share_right",
    "truth.pairwise_precision",
    "truth.pairwise_recall",
];

/// Quantities of each metric; the first is its headline where that is one.
const QUANTITIES: [(&str, &[&str]); 7] = [
    (
        "hota",
        &[
            "hota",
            "det_a",
            "ass_a",
            "loc_a",
            "det_re",
            "det_pr",
            "ass_re",
            "ass_pr",
            "owta",
            "hota_0",
            "loc_a_0",
            "hota_loc_a_0",
        ],
    ),
    ("identity", &["idf1", "idp", "idr"]),
    (
        "clear",
        &[
            "recall",
            "precision",
            "f1",
            "mt_share",
            "pt_share",
            "ml_share",
            "motp_similarity",
        ],
    ),
    ("siap", &["completeness", "spuriousness", "longest_segment"]),
    (
        "assignment",
        &[
            "associated_share",
            "truths_established_share",
            "false_tracks_share",
        ],
    ),
    (
        "kinematics",
        &[
            "nees_position_steps_within",
            "nees_state_steps_within",
            "nis_of_matches_steps_within",
        ],
    ),
    ("track_keeping", &["identity", "stay"]),
];

/// Whether the number at this path is never below 0 or above 1.
pub(super) fn is_share(path: &str) -> bool {
    let path = path.strip_suffix(".value").unwrap_or(path);
    PARTS.contains(&path)
        || path
            .strip_prefix("metrics.")
            .is_some_and(is_share_of_metric)
}

/// `NAME.quantities.QUANTITY`; a metric that is listed twice has a number behind its name.
fn is_share_of_metric(path: &str) -> bool {
    let Some((metric, quantity)) = path.split_once(".quantities.") else {
        return false;
    };
    let metric = metric
        .trim_end_matches(|sign: char| sign.is_ascii_digit())
        .trim_end_matches('_');
    QUANTITIES
        .iter()
        .any(|(name, quantities)| *name == metric && quantities.contains(&quantity))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_told_from_counts_and_lengths() {
        for path in [
            "tfa.probability.correct",
            "metrics.hota.quantities.det_a",
            "metrics.hota_2.quantities.hota.value",
        ] {
            assert!(is_share(path), "{path}");
        }
        for path in [
            "tfa.counts.correct",
            "metrics.gospa.quantities.gospa",
            "metrics.clear.quantities.mota",
            "metrics.clear.quantities.mt",
        ] {
            assert!(!is_share(path), "{path}");
        }
    }
}
