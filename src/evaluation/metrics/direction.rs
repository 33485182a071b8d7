//! Which way is better: of quantities of metrics by their names, and of the shares of the automaton.
//!
//! A quantity that is neither good nor bad by itself (a count of steps, a bias, a bound of a test) has no direction; nor has a sum over what is
//! matched (localisation), which grows with every target that is found.

/// Larger is better.
const HIGHER: &[&str] = &[
    "ass_a",
    "ass_pr",
    "ass_re",
    "associated",
    "associated_share",
    "association",
    "completeness",
    "correct",
    "det_a",
    "det_pr",
    "det_re",
    "established",
    "explained_share",
    "f1",
    "following",
    "hota",
    "hota_0",
    "hota_loc_a_0",
    "identity",
    "idf1",
    "idp",
    "idr",
    "idtp",
    "loc_a",
    "loc_a_0",
    "longest_segment",
    "longest_segment_time",
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
    "targets_stay",
    "tp",
    "tracked_time",
    "truths_established",
    "truths_established_share",
];

/// Smaller is better.
const LOWER: &[&str] = &[
    "across_rmse",
    "along_rmse",
    "ambiguity",
    "bearing_95",
    "bearing_rmse",
    "break_length",
    "breaks",
    "cardinality",
    "divergence_length",
    "divergences",
    "establishment_length",
    "false",
    "false_length",
    "false_mean",
    "false_points",
    "false_sum",
    "false_track_length",
    "false_tracks",
    "false_tracks_share",
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
    "missing_points",
    "ml",
    "ml_share",
    "motp_distance",
    "ospa",
    "ospa2",
    "ospa2_of_window",
    "ospa2_whole",
    "position_95",
    "position_accuracy",
    "position_rmse",
    "redundancies",
    "redundancy_length",
    "redundant",
    "spuriousness",
    "swaps",
    "switches",
    "switching",
    "switching_mean",
    "switching_sum",
    "t_gospa",
    "t_gospa_per_step",
    "track_number_change_rate",
    "track_number_changes",
    "unassigned",
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
    use crate::evaluation::metrics::{MetricReport, Quantity};
    use crate::evaluation::tests::{GONE, Places, compare, evaluate, main_scene};
    use serde_json::json;
    use std::collections::{BTreeMap, BTreeSet};

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

    /// Numbers with a direction over the steps, and over the targets: their sums, where what is not there is 0.
    fn sums_of_parts(report: &MetricReport) -> BTreeMap<String, f64> {
        let mut sums = BTreeMap::new();
        let over_time = report.series.iter().filter(|s| s.axis == "time_s");
        let over_time =
            over_time.flat_map(|s| s.values.iter().map(|value| ("steps", s.name, *value)));
        let of_targets = report.per_truth.iter().flat_map(|line| &line.quantities);
        let of_targets = of_targets.map(|quantity| ("targets", quantity.name, quantity.value));
        for (over, name, value) in over_time.chain(of_targets) {
            *sums.entry(format!("{over}.{name}")).or_insert(0.0) += value.unwrap_or(0.0);
        }
        sums
    }

    /// Whether one of them is worse.
    fn is_worse_in_parts(good: &MetricReport, bad: &MetricReport) -> bool {
        let bad = sums_of_parts(bad);
        sums_of_parts(good).into_iter().any(|(name, sum)| {
            let more = bad.get(&name).map_or(0.0, |bad| bad - sum);
            higher_is_better(&name).is_some_and(|higher| more != 0.0 && higher == (more < 0.0))
        })
    }

    #[test]
    fn what_makes_a_metric_worse_shows_over_steps_or_targets() {
        let truths: [Places; 2] = [("A", &[0.0; 12]), ("B", &[900.0; 12])];
        let steady: [Places; 2] = [("T", &[1.0; 12]), ("U", &[901.0; 12])];
        let beside: [Places; 3] = [steady[0], steady[1], ("F", &[400.0; 12])];
        let twice: [Places; 3] = [steady[0], steady[1], ("V", &[3.0; 12])];
        let silent: [f64; 12] = std::array::from_fn(|step| if step % 2 == 0 { 1.0 } else { GONE });
        let gaps: [Places; 2] = [("T", &silent), steady[1]];
        let (mut first, mut second) = ([1.0; 12], [901.0; 12]);
        first[6..].swap_with_slice(&mut second[6..]);
        let swapped: [Places; 2] = [("T", &first), ("U", &second)];
        let scene = |tracks: &[Places]| compare(&truths, tracks, 10.0);
        for method in crate::evaluation::metrics::METRICS {
            let report = |tracks| evaluate(method.name, json!({}), &[scene(tracks)]);
            let good = report(&steady);
            for bad in [
                report(&beside),
                report(&twice),
                report(&gaps),
                report(&swapped),
            ] {
                let is_worse = |good: &Quantity| {
                    let more = bad
                        .quantity(good.name)
                        .zip(good.value)
                        .map_or(0.0, |(b, g)| b - g);
                    let higher = higher_is_better(good.name);
                    more.abs() > 1e-9 && higher.is_some_and(|higher| higher == (more < 0.0))
                };
                let worse: Vec<_> = good.quantities.iter().filter(|q| is_worse(q)).collect();
                assert!(
                    worse.is_empty() || is_worse_in_parts(&good, &bad),
                    "{}: {worse:?}",
                    method.name
                );
            }
        }
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
