//! Which way is better: of quantities of metrics by their names, and of the shares of the automaton.
//!
//! A quantity that is neither good nor bad by itself (a count of steps, a bias, a bound of a test) has no direction; nor has a sum over what is
//! matched (localisation), which grows with every target that is found.

/// Larger is better.
const HIGHER: &[&str] = &[
    "ass_a",
    "ass_pr",
    "ass_re",
    "completeness",
    "correct",
    "det_a",
    "det_pr",
    "det_re",
    "f1",
    "hota",
    "identity",
    "idf1",
    "idp",
    "idr",
    "idtp",
    "loc_a",
    "longest_segment",
    "matched",
    "matched_points",
    "moda",
    "mota",
    "motal",
    "motp_similarity",
    "mt",
    "mt_share",
    "owta",
    "precision",
    "recall",
    "smota",
    "stay",
    "targets_identity",
    "tp",
];

/// Smaller is better.
const LOWER: &[&str] = &[
    "across_rmse",
    "along_rmse",
    "bearing_95",
    "bearing_rmse",
    "breaks",
    "cardinality",
    "divergences",
    "establishment_length",
    "false",
    "false_mean",
    "false_points",
    "false_sum",
    "fn",
    "fp",
    "fp_divergence",
    "fp_false_alarm",
    "fp_per_step",
    "fp_redundant",
    "frag",
    "frag_trackeval",
    "gospa",
    "idfn",
    "idfp",
    "idsw",
    "labelled_ospa",
    "labelling",
    "mean_absolute_error",
    "mean_establishment_length",
    "missed",
    "missed_mean",
    "missed_points",
    "missed_sum",
    "ml",
    "ml_share",
    "motp_distance",
    "ospa",
    "ospa2",
    "ospa2_whole",
    "position_95",
    "position_accuracy",
    "position_rmse",
    "redundancies",
    "spuriousness",
    "swaps",
    "switches",
    "switching",
    "switching_mean",
    "switching_sum",
    "t_gospa",
    "t_gospa_per_step",
    "track_number_change_rate",
    "velocity_accuracy",
    "velocity_rmse",
    "z_rmse",
];

/// Whether larger values of a quantity of this name are better; `None` where neither is. `name` may be a path, whose last step counts.
pub fn higher_is_better(name: &str) -> Option<bool> {
    let last = name.rsplit('.').next().unwrap_or(name);
    if HIGHER.contains(&last) {
        return Some(true);
    }
    LOWER.contains(&last).then_some(false)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::tests::{evaluate, main_scene};
    use serde_json::json;
    use std::collections::BTreeSet;

    #[test]
    fn headlines_agree_with_their_metrics_and_names_are_those_of_quantities() {
        let scene = main_scene(10.0);
        let mut known = BTreeSet::from(
            [
                "correct",
                "missed",
                "false",
                "z_rmse",
                "bearing_rmse",
                "bearing_95",
            ]
            .map(str::to_owned),
        );
        for method in crate::evaluation::metrics::METRICS {
            let report = evaluate(method.name, json!({}), std::slice::from_ref(&scene));
            let headline = report.quantities.iter().find(|quantity| {
                quantity.value == report.value && higher_is_better(quantity.name).is_some()
            });
            if let Some(headline) = headline.filter(|_| report.value.is_some()) {
                assert_eq!(
                    higher_is_better(headline.name),
                    Some(report.higher_is_better),
                    "{}",
                    headline.name
                );
            }
            known.extend(
                report
                    .quantities
                    .iter()
                    .map(|quantity| quantity.name.to_owned()),
            );
            known.extend(report.series.iter().map(|series| series.name.to_owned()));
            let lines = report.per_truth.iter().chain(&report.per_track);
            known.extend(
                lines
                    .flat_map(|line| &line.quantities)
                    .map(|quantity| quantity.name.to_owned()),
            );
        }
        let unknown: Vec<&&str> = HIGHER
            .iter()
            .chain(LOWER)
            .filter(|name| !known.contains(**name))
            .collect();
        assert!(unknown.is_empty(), "{unknown:?} of {known:?}");
        assert!(HIGHER.iter().all(|name| !LOWER.contains(name)));
    }

    #[test]
    fn the_last_step_of_a_path_counts() {
        assert_eq!(
            higher_is_better("metrics.gospa.quantities.gospa"),
            Some(false)
        );
        assert_eq!(higher_is_better("tfa.probability.correct"), Some(true));
        assert_eq!(
            higher_is_better("metrics.kinematics.quantities.x_bias"),
            None
        );
    }
}
