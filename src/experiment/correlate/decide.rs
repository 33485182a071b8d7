//! Decisions at successive times, and which tuples stand: those found often enough (Huo et al. 2008, the N/M rule).
//!
//! With more than half of the decisions no two different tuples of one track can stand. With fewer they can; then the more
//! frequent one does, of equally frequent ones the one that costs less at the last time.

use super::spec::Confirm;
use crate::correlation::problem::CorrelationProblem;
use crate::correlation::statistic::Correlation;
use crate::correlation::{Correlator, Solution};
use crate::experiment::job::{AssociationTime, RunError};
use crate::experiment::observer::{Observer, Step, report_progress};
use crate::model::fault::Fault;
use crate::model::watch::Watch;
use crate::registry::placed;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::time::Duration;

pub struct Decisions {
    /// The last, and its problem.
    pub solution: Solution,
    pub problem: CorrelationProblem,
    /// Those that stand, with how often each was found.
    pub tuples: Vec<(Vec<u32>, u32)>,
    pub alone: Vec<u32>,
    pub association_time: Option<AssociationTime>,
}

/// Puts the tracks together at each of the last `of` times.
pub fn decide(
    correlation: &Correlation,
    confirm: Confirm,
    correlator: &mut dyn Correlator,
    observer: &mut dyn Observer,
) -> Result<Decisions, RunError> {
    let times = correlation.estimates.times();
    let total = u64::from(confirm.of);
    report_progress(observer, Step::Correlate, 0, total)?;
    let mut counts: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
    let mut spent = Some(Duration::ZERO);
    let mut last = None;
    for number in 1..=confirm.of {
        let problem = correlation.problem(times - (confirm.of - number) as usize);
        let begun = observer.now();
        let solution = correlate_watched(
            correlator,
            &problem,
            (u64::from(number - 1).max(1), total),
            observer,
        )?;
        spent = spent
            .zip(begun)
            .zip(observer.now())
            .and_then(|((spent, begun), now)| Some(spent + now.checked_sub(begun)?));
        for tuple in solution.tuples.iter().filter(|tuple| tuple.len() > 1) {
            *counts.entry(tuple.clone()).or_default() += 1;
        }
        report_progress(observer, Step::Correlate, u64::from(number), total)?;
        last = Some((solution, problem));
    }
    let (solution, problem) = last.ok_or_else(|| {
        vec![Fault::new(
            "/confirm/of",
            "out_of_range",
            "no decision was made",
        )]
    })?;
    counts.retain(|_, count| *count >= confirm.found);
    let tuples = standing(counts, &problem);
    let mut is_alone = vec![true; problem.tracks()];
    tuples
        .iter()
        .flat_map(|(tuple, _)| tuple)
        .for_each(|&track| is_alone[track as usize] = false);
    let alone = (0..problem.tracks() as u32)
        .filter(|&track| is_alone[track as usize])
        .collect();
    let association_time = spent.map(|spent| AssociationTime {
        spent,
        scans: total,
    });
    Ok(Decisions {
        solution,
        problem,
        tuples,
        alone,
        association_time,
    })
}

/// What the correlator finds, unless the observer stops it on the way.
fn correlate_watched(
    correlator: &mut dyn Correlator,
    problem: &CorrelationProblem,
    (done, total): (u64, u64),
    observer: &mut dyn Observer,
) -> Result<Solution, RunError> {
    let observer = RefCell::new(observer);
    let question = || observer.borrow_mut().progress(Step::Correlate, done, total);
    let watch = Watch::new(&question);
    let solution = correlator.correlate_until(problem, &watch);
    if watch.is_stopped() {
        Err(RunError::Stopped)
    } else {
        solution.map_err(refuse)
    }
}

/// Tuples without a track in common, the most frequent first chosen; in the order of their first tracks.
fn standing(counts: BTreeMap<Vec<u32>, u32>, problem: &CorrelationProblem) -> Vec<(Vec<u32>, u32)> {
    let mut found: Vec<(Vec<u32>, u32, f64)> = counts
        .into_iter()
        .map(|(tuple, count)| {
            let cost = problem.cost(&tuple).unwrap_or(f64::INFINITY);
            (tuple, count, cost)
        })
        .collect();
    found.sort_by(|left, right| {
        right
            .1
            .cmp(&left.1)
            .then(left.2.total_cmp(&right.2))
            .then(left.0.cmp(&right.0))
    });
    let mut is_taken = vec![false; problem.tracks()];
    let mut stand = Vec::with_capacity(found.len());
    for (tuple, count, _) in found {
        if tuple.iter().all(|&track| !is_taken[track as usize]) {
            tuple
                .iter()
                .for_each(|&track| is_taken[track as usize] = true);
            stand.push((tuple, count));
        }
    }
    stand.sort();
    stand
}

fn refuse(faults: Vec<Fault>) -> RunError {
    RunError::Faults(placed("/correlator", faults))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correlation::problem::Costs;

    #[test]
    fn the_more_frequent_tuple_stands_and_of_equals_the_cheaper() {
        let problem = CorrelationProblem::new(
            &[2, 2],
            &[(0, 2, -1.0), (0, 3, -5.0), (1, 2, -2.0), (1, 3, -1.0)],
            Costs::Chain,
        );
        let counts = |list: &[(&[u32], u32)]| {
            list.iter()
                .map(|(tuple, count)| (tuple.to_vec(), *count))
                .collect()
        };
        assert_eq!(
            standing(
                counts(&[(&[0, 2], 3), (&[0, 3], 2), (&[1, 3], 1)]),
                &problem
            ),
            [(vec![0, 2], 3), (vec![1, 3], 1)]
        );
        assert_eq!(
            standing(
                counts(&[(&[0, 2], 2), (&[0, 3], 2), (&[1, 2], 2)]),
                &problem
            ),
            [(vec![0, 3], 2), (vec![1, 2], 2)]
        );
    }
}
