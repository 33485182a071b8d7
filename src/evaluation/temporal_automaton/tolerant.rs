//! Verdicts that forgive: how many errors a target needs to be forgiven before it is correct.
//!
//! Time is aligned, so the errors between a truth string and an output string are the scans at which they differ (their
//! Hamming distance, ε outside a string): a detection in place of another, one too many, one missing. Late start and
//! early end count one a scan.
//!
//! # Method
//! 1. The errors of every truth string and output string that share a detection.
//! 2. One to one, with the fewest errors in all: a truth string that goes without counts its own detections as missing, an
//!    output string that goes without counts its detections as too many. This is an optimal assignment over the pairs.
//!    Of several such assignments it is the one that the solver of [`crate::math::assignment`] finds first in the order of the ids:
//!    always the same one, whatever the order of the rows of the files.
//! 3. The least errors of a target are those of all its strings together. It has none when no string of it was given a track. A
//!    target that is correct in the strict sense has 0 errors.
//! 4. For an error budget k, a target is correct when its least errors are at most k.

use super::verdict::{TargetVerdict, Verdict};
use crate::evaluation::strings::Strings;
use crate::evaluation::strings::difference::differences;
use crate::evaluation::strings::normal_form::TrackString;
use crate::evaluation::strings::step::EPSILON;
use crate::math::assignment::AssignmentSolver;

/// A truth string and an output string that share a detection.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Pair {
    truth: u32,
    output: u32,
    errors: u32,
}

/// The least errors of each target, and the tracks that bridge gaps.
pub fn least_errors(
    strings: &Strings,
    verdicts: &[TargetVerdict],
) -> (Vec<Option<usize>>, Vec<Bridge>) {
    let pairs = pairs(strings);
    let matched = assign(strings, &pairs);
    let of_target = |(owner, judged): (usize, &TargetVerdict)| {
        if judged.verdict == Verdict::Correct {
            return Some(0);
        }
        let own = strings.truth.of_owner(owner);
        let has_track = own.clone().any(|string| matched[string].is_some());
        has_track.then(|| {
            own.map(|string| matched[string].unwrap_or(strings.truth.strings()[string].real))
                .sum()
        })
    };
    (
        verdicts.iter().enumerate().map(of_target).collect(),
        bridges(strings, &pairs),
    )
}

/// A track that goes on across a gap which ends a string of its target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Bridge {
    pub target: u32,
    pub track: u32,
}

/// Every bridge, by target. What follows the gap is a string of its own, for which the track is not left: the least errors of the
/// target count it as missing, the errors of the track do not.
fn bridges(strings: &Strings, pairs: &[Pair]) -> Vec<Bridge> {
    let owner = |pair: &Pair| strings.truth.strings()[pair.truth as usize].owner;
    let mut of_several: Vec<(u32, u32)> = pairs
        .iter()
        .filter(|pair| strings.truth.of_owner(owner(pair) as usize).len() > 1)
        .map(|pair| (owner(pair), pair.output))
        .collect();
    of_several.sort_unstable();
    let twice = of_several.windows(2).filter(|two| two[0] == two[1]);
    let mut bridges: Vec<Bridge> = twice
        .map(|two| Bridge {
            target: two[0].0,
            track: strings.outputs.strings.strings()[two[0].1 as usize].owner,
        })
        .collect();
    bridges.dedup();
    bridges
}

/// How many targets are correct for each error budget 0..=`tolerance`.
pub fn correct_by_budget(least_errors: &[Option<usize>], tolerance: usize) -> Vec<usize> {
    let mut correct = vec![0; tolerance + 1];
    for &errors in least_errors
        .iter()
        .flatten()
        .filter(|&&errors| errors <= tolerance)
    {
        correct[errors] += 1;
    }
    for budget in 1..correct.len() {
        correct[budget] += correct[budget - 1];
    }
    correct
}

/// Step 1, in order of truth strings.
fn pairs(strings: &Strings) -> Vec<Pair> {
    let (truths, outputs) = (&strings.truth, &strings.outputs.strings);
    let mut pairs = Vec::new();
    let mut sharing = Vec::new();
    for (index, output) in outputs.strings().iter().enumerate() {
        sharing.clear();
        find_sharing(strings, output, &mut sharing);
        for &truth in &sharing {
            let string = &truths.strings()[truth];
            let places = string.start.min(output.start)..string.end().max(output.end());
            let errors = differences((truths, string), (outputs, output), places).count();
            pairs.push(Pair {
                truth: truth as u32,
                output: index as u32,
                errors: errors as u32,
            });
        }
    }
    pairs.sort_unstable();
    pairs
}

/// The truth strings that an output string shares a detection with.
fn find_sharing(strings: &Strings, output: &TrackString, sharing: &mut Vec<usize>) {
    let (truths, outputs) = (&strings.truth, &strings.outputs.strings);
    for (offset, step) in output.steps().enumerate() {
        let position = output.start + offset;
        for (symbol, _) in outputs
            .choices_at(step)
            .filter(|&(symbol, _)| symbol != EPSILON)
        {
            // Most often it is the string that was found last.
            let is_again = sharing.last().is_some_and(|&last| {
                truths.symbol_at(&truths.strings()[last], position) == Some(symbol)
            });
            if let Some(truth) = (!is_again)
                .then(|| strings.truth_string_of(symbol, position))
                .flatten()
                && !sharing.contains(&truth)
            {
                sharing.push(truth);
            }
        }
    }
}

/// Step 2: for each truth string its errors with the output string that it was given.
fn assign(strings: &Strings, pairs: &[Pair]) -> Vec<Option<usize>> {
    let (truths, outputs) = (&strings.truth, &strings.outputs.strings);
    let surplus: Vec<f64> = outputs
        .strings()
        .iter()
        .map(|output| must_be_real(strings, output) as f64)
        .collect();
    let mut solver = AssignmentSolver::default();
    for of_truth in pairs.chunk_by(|a, b| a.truth == b.truth) {
        for pair in of_truth {
            solver.push_edge(
                pair.output,
                f64::from(pair.errors) - surplus[pair.output as usize],
            );
        }
        solver.end_row(truths.strings()[of_truth[0].truth as usize].real as f64);
    }
    let mut matched = vec![None; truths.strings().len()];
    if solver.solve().is_some() {
        for (row, of_truth) in pairs.chunk_by(|a, b| a.truth == b.truth).enumerate() {
            matched[of_truth[0].truth as usize] = solver
                .edge_of(row)
                .map(|edge| of_truth[edge].errors as usize);
        }
    }
    matched
}

/// The scans at which an output string cannot be ε.
fn must_be_real(strings: &Strings, output: &TrackString) -> usize {
    let outputs = &strings.outputs.strings;
    if outputs.has_choices() {
        output
            .steps()
            .filter(|&step| outputs.weight_of(step, EPSILON).is_none())
            .count()
    } else {
        output.real
    }
}
