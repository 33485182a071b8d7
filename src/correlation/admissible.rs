//! Tracks that someone wants together, as tuples that exist and pay.
//!
//! # Method
//! In a chain a row of tracks is cut wherever the link of neighbours is missing or costs more than nothing. Otherwise its tracks,
//! in the order of their sensors, each join the tuple of the row whose cost they lower most, or begin one. A joint cost may be such
//! that no track by itself lowers it, but all together do: there the whole row stays one tuple where that costs less.

use super::problem::{CorrelationProblem, Costs};

/// Shows the tuples that a row is made of, each with its cost; `row` has one track of a sensor at most, ascending.
pub(super) fn divide(
    problem: &CorrelationProblem,
    row: &[u32],
    show: &mut impl FnMut(&[u32], f64),
) {
    match problem.costs {
        Costs::Chain => cut_chain(problem, row, show),
        Costs::AllPairs | Costs::Joint(_) => split(problem, row, show),
    }
}

/// The tuples that all rows are made of.
pub(super) fn divide_rows(problem: &CorrelationProblem, rows: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let mut tuples = Vec::with_capacity(rows.len());
    rows.iter()
        .for_each(|row| divide(problem, row, &mut |tuple, _| tuples.push(tuple.to_vec())));
    tuples
}

fn cut_chain(problem: &CorrelationProblem, row: &[u32], show: &mut impl FnMut(&[u32], f64)) {
    let (mut first, mut cost) = (0, 0.0);
    for place in 1..row.len() {
        match problem
            .link(row[place - 1], row[place])
            .filter(|cost| *cost < 0.0)
        {
            Some(of_link) => cost += of_link,
            None => {
                show(&row[first..place], cost);
                (first, cost) = (place, 0.0);
            }
        }
    }
    if first < row.len() {
        show(&row[first..], cost);
    }
}

fn split(problem: &CorrelationProblem, row: &[u32], show: &mut impl FnMut(&[u32], f64)) {
    let mut tuples: Vec<(Vec<u32>, f64)> = Vec::new();
    for &track in row {
        let mut best = (0.0, None);
        for (number, (tuple, cost)) in tuples.iter_mut().enumerate() {
            let change = change_by(problem, tuple, *cost, track).unwrap_or(0.0);
            if change < best.0 {
                best = (change, Some(number));
            }
        }
        match best {
            (change, Some(number)) => {
                tuples[number].0.push(track);
                tuples[number].1 += change;
            }
            (_, None) => tuples.push((vec![track], 0.0)),
        }
    }
    let sum: f64 = tuples.iter().map(|(_, cost)| cost).sum();
    let whole = if let Costs::Joint(_) = problem.costs {
        problem.cost(row).filter(|cost| *cost < sum)
    } else {
        None
    };
    match whole {
        Some(cost) => show(row, cost),
        None => tuples.iter().for_each(|(tuple, cost)| show(tuple, *cost)),
    }
}

/// What a track of a later sensor adds to the cost of a tuple, where it may join.
fn change_by(
    problem: &CorrelationProblem,
    tuple: &mut Vec<u32>,
    cost: f64,
    track: u32,
) -> Option<f64> {
    if let Costs::AllPairs = problem.costs {
        return tuple
            .iter()
            .map(|&member| problem.link(member, track))
            .sum();
    }
    tuple.push(track);
    let grown = problem.cost(tuple);
    tuple.pop();
    grown.map(|grown| grown - cost)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_track_joins_the_tuple_of_its_row_that_gains_most() {
        // 1 is not linked with 0 and begins a tuple of its own; 2 gains more with it than with 0.
        let all =
            CorrelationProblem::new(&[1, 1, 1], &[(0, 2, -1.0), (1, 2, -2.0)], Costs::AllPairs);
        assert_eq!(divide_rows(&all, &[vec![0, 1, 2]]), [vec![0], vec![1, 2]]);
    }

    #[test]
    fn a_chain_is_cut_where_a_link_is_missing_or_dear() {
        let chain = CorrelationProblem::new(
            &[1, 1, 1, 1],
            &[(0, 1, -1.0), (1, 2, 0.5), (2, 3, -2.0)],
            Costs::Chain,
        );
        let mut found = Vec::new();
        divide(&chain, &[0, 1, 2, 3], &mut |tuple, cost| {
            found.push((tuple.to_vec(), cost))
        });
        assert_eq!(found, [(vec![0, 1], -1.0), (vec![2, 3], -2.0)]);
        assert_eq!(divide_rows(&chain, &[vec![], vec![3]]), [vec![3]]);
    }
}
