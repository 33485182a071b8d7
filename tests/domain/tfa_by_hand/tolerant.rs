//! Verdicts that forgive, by hand and against every way of giving tracks to targets.

use super::naive::{Text, borrowed, differing, lines, scene, strings_of};
use super::notation::{evaluate, tolerance};
use proptest::prelude::*;
use std::collections::BTreeSet;

#[test]
fn a_substituted_an_extra_and_an_absent_detection_are_one_error_each() {
    let truth = ["A: a1 a2 . a4 a5"];
    for (track, clutter) in [
        ("1: a1 a2 . a4 c5", ". . . . c5"),
        ("1: a1 a2 c3 a4 a5", ". . c3"),
        ("1: a1 . . a4 a5", ""),
    ] {
        let report = evaluate(&truth, &[clutter], &[track]);
        assert_eq!(report.targets[0].least_errors, Some(1), "{track}");
        assert_eq!(tolerance(&report), [0, 1, 1, 1, 1, 1], "{track}");
        assert_eq!(
            (
                report.tolerance[0].probability,
                report.tolerance[1].probability
            ),
            (Some(0.0), Some(1.0))
        );
    }
}

#[test]
fn late_start_and_early_end_count_one_a_scan() {
    let report = evaluate(&["A: a1 a2 a3 a4 a5"], &[], &["1: _ _ a3 a4"]);
    assert_eq!(report.targets[0].least_errors, Some(3));
    assert_eq!(tolerance(&report), [0, 0, 0, 1, 1, 1]);
    assert_eq!(report.counts.missed, 1, "the strict verdict stays");
}

#[test]
fn a_target_without_a_detection_in_any_track_is_never_correct() {
    let report = evaluate(&["A: a1", "B: b1 b2"], &["c1"], &["1: c1", "2: b1 b2"]);
    assert_eq!(
        (
            report.targets[0].least_errors,
            report.targets[1].least_errors
        ),
        (None, Some(0))
    );
    assert_eq!(tolerance(&report), [1, 1, 1, 1, 1, 1]);
}

#[test]
fn a_track_forgives_one_target_only() {
    // Track 1 is two errors from A and two from B, track 2 is one from A and shares nothing with B.
    let report = evaluate(
        &["A: a1 a2 a3 a4", "B: . . b3 b4"],
        &[],
        &["1: a1 a2 b3 b4", "2: a1 a2 a3"],
    );
    assert_eq!(
        (
            report.targets[0].least_errors,
            report.targets[1].least_errors
        ),
        (Some(1), Some(2))
    );
    // Alone, it goes to where it saves most errors.
    let report = evaluate(&["A: a1 a2 a3 a4", "B: . . . b4"], &[], &["1: a1 a2 a3 b4"]);
    assert_eq!(
        (
            report.targets[0].least_errors,
            report.targets[1].least_errors
        ),
        (Some(1), None)
    );
}

#[test]
fn the_strings_of_a_target_add_up() {
    let truth = ["A: a1 a2 . . . . . a8 a9"];
    let report = evaluate(
        &truth,
        &[". . . . . . . . c9"],
        &["1: a1 . . . . . . a8 c9"],
    );
    assert_eq!(
        report.targets[0].least_errors,
        Some(2),
        "a2 is absent, c9 is in place of a9"
    );
    let report = evaluate(&truth, &[], &["1: a1 a2"]);
    assert_eq!(
        report.targets[0].least_errors,
        Some(2),
        "the second string has no track: a8, a9 are absent"
    );
}

#[test]
fn with_every_choice_kept_an_error_is_what_the_track_cannot_have_been() {
    let lines = ["1: a1 c2=0.6|a2=0.3|.=0.1 a3=0.2|c3=0.8"];
    let report = super::all_gated::evaluate_gated(&["A: a1 a2 . a4"], &[". c2 c3"], &lines, 0.1);
    assert_eq!(
        report.targets[0].least_errors,
        Some(2),
        "scan 3 cannot be ε, and a4 is absent"
    );
}

/// Every way of giving output strings to truth strings that share a word with them, each at most once: for each truth
/// string its errors when it is given one.
fn matchings(
    truths: &[Text],
    outputs: &[Text],
    scans: usize,
    used: &mut Vec<bool>,
    given: &mut Vec<Option<usize>>,
    all: &mut Vec<(usize, Vec<Option<usize>>)>,
) {
    let Some(truth) = truths.get(given.len()) else {
        let real = |text: &Text| text.1.iter().filter(|word| *word != ".").count();
        let of_truth: usize = truths
            .iter()
            .zip(given.iter())
            .map(|(truth, errors)| errors.unwrap_or(real(truth)))
            .sum();
        let left_over: usize = outputs
            .iter()
            .zip(used.iter())
            .filter(|(_, used)| !**used)
            .map(|(output, _)| real(output))
            .sum();
        all.push((of_truth + left_over, given.clone()));
        return;
    };
    given.push(None);
    matchings(truths, outputs, scans, used, given, all);
    given.pop();
    for (index, output) in outputs.iter().enumerate() {
        let shares = truth.1.iter().enumerate().any(|(offset, word)| {
            word != "." && super::naive::word_at(output, truth.0 + offset) == word
        });
        if !used[index] && shares {
            used[index] = true;
            given.push(Some(differing(truth, output, scans).len()));
            matchings(truths, outputs, scans, used, given, all);
            given.pop();
            used[index] = false;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn least_errors_are_those_of_the_best_of_all_matchings((truth, tracks) in scene()) {
        let scans = truth[0].len();
        let outputs: Vec<Text> = tracks.iter().flat_map(|words| strings_of(words)).collect();
        let of_target: Vec<Vec<Text>> = truth.iter().map(|words| strings_of(words)).collect();
        let truths: Vec<Text> = of_target.iter().flatten().cloned().collect();
        prop_assume!(truths.len() <= 5 && outputs.len() <= 6);
        let mut all = Vec::new();
        matchings(&truths, &outputs, scans, &mut vec![false; outputs.len()], &mut Vec::new(), &mut all);
        let fewest = all.iter().map(|(errors, _)| *errors).min().unwrap();
        // Several matchings may be equally good; the report may take any.
        let best: BTreeSet<Vec<Option<usize>>> =
            all.into_iter().filter(|(errors, _)| *errors == fewest).map(|(_, given)| by_target(&of_target, &given)).collect();

        let clutter: String = (1..=scans).map(|scan| format!("x{scan} ")).collect();
        let (truth_lines, track_lines) = (lines(&truth), lines(&tracks));
        let report = evaluate(&borrowed(&truth_lines), &[&clutter], &borrowed(&track_lines));
        let found: Vec<Option<usize>> = report.targets.iter().map(|target| target.least_errors).collect();
        prop_assert!(best.contains(&found), "{found:?} is none of {best:?}");
        prop_assert_eq!(report.tolerance[0].correct, report.counts.correct, "k = 0 is the strict verdict");
        for line in &report.tolerance {
            let within = found.iter().filter(|errors| errors.is_some_and(|errors| errors <= line.k)).count();
            prop_assert_eq!(line.correct, within, "k = {}", line.k);
        }
    }
}

/// The errors of all strings of each target; none when none of them was given a track.
fn by_target(of_target: &[Vec<Text>], given: &[Option<usize>]) -> Vec<Option<usize>> {
    let mut rest = given;
    let errors_of = |strings: &Vec<Text>| {
        let (own, others) = rest.split_at(strings.len());
        rest = others;
        let real = |text: &Text| text.1.iter().filter(|word| *word != ".").count();
        let errors = strings
            .iter()
            .zip(own)
            .map(|(string, errors)| errors.unwrap_or(real(string)))
            .sum();
        own.iter().any(Option::is_some).then_some(errors)
    };
    of_target.iter().map(errors_of).collect()
}
