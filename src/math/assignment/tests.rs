//! Assignment against another solver, against itself on the padded matrix, against brute force, and against its duals.

use super::*;
use crate::math::rng::{Purpose, Seed};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

const ABSENT: f64 = f64::INFINITY;

/// Row by row; `misses` has one cost a row.
#[derive(Debug, Clone)]
struct Matrix {
    columns: usize,
    costs: Vec<f64>,
    misses: Vec<f64>,
}

impl Matrix {
    fn rows(&self) -> usize {
        self.misses.len()
    }

    fn cost(&self, row: usize, column: usize) -> f64 {
        self.costs[row * self.columns + column]
    }

    /// The same problem without misses: each is a column that only its own row may take.
    fn padded(&self) -> Vec<f64> {
        let rows = self.rows();
        let pad = |row: usize| {
            (0..rows).map(move |other| {
                if other == row {
                    self.misses[row]
                } else {
                    ABSENT
                }
            })
        };
        (0..rows)
            .flat_map(|row| {
                (0..self.columns)
                    .map(move |column| self.cost(row, column))
                    .chain(pad(row))
            })
            .collect()
    }

    /// Solves it sparse, edges in an order of its own.
    fn solve(&self, solver: &mut AssignmentSolver, backwards: bool) -> Option<f64> {
        solver.clear();
        for row in 0..self.rows() {
            for index in 0..self.columns {
                let column = if backwards {
                    self.columns - 1 - index
                } else {
                    index
                };
                if self.cost(row, column) < ABSENT {
                    solver.push_edge(column as u32 * 3, self.cost(row, column));
                }
            }
            solver.end_row(self.misses[row]);
        }
        solver.solve()
    }

    /// The optimum by trying everything from `row` on.
    fn brute_force(&self, row: usize, used: &mut Vec<bool>) -> f64 {
        if row == self.rows() {
            return 0.0;
        }
        let mut best = self.misses[row] + self.brute_force(row + 1, used);
        for column in 0..self.columns {
            if !used[column] {
                used[column] = true;
                best = best.min(self.cost(row, column) + self.brute_force(row + 1, used));
                used[column] = false;
            }
        }
        best
    }

    /// Feasible, tight where something is taken, and worth as much as the assignment: optimal.
    fn assert_certified(&self, solver: &AssignmentSolver, cost: f64) {
        let (mut taken, mut paid) = (vec![false; self.columns], 0.0);
        for row in 0..self.rows() {
            let dual = solver.row_dual(row);
            assert!(dual <= self.misses[row] + 1e-9, "{self:?}");
            for column in 0..self.columns {
                assert!(
                    dual + solver.column_dual(column as u32 * 3) <= self.cost(row, column) + 1e-9,
                    "{self:?}"
                );
            }
            let column = solver.column_of(row).map(|number| number as usize / 3);
            let (tight, price) = match column {
                Some(column) => (
                    dual + solver.column_dual(column as u32 * 3),
                    self.cost(row, column),
                ),
                None => (dual, self.misses[row]),
            };
            assert!((tight - price).abs() < 1e-9, "{self:?}");
            paid += price;
            if let Some(column) = column {
                assert!(
                    !std::mem::replace(&mut taken[column], true),
                    "column {column} is taken twice in {self:?}"
                );
            }
        }
        let mut worth: f64 = (0..self.rows()).map(|row| solver.row_dual(row)).sum();
        for (column, is_taken) in taken.into_iter().enumerate() {
            let dual = solver.column_dual(column as u32 * 3);
            assert!(dual <= 1e-9 && (is_taken || dual == 0.0), "{self:?}");
            worth += dual;
        }
        assert!(
            (worth - cost).abs() < 1e-8 && (paid - cost).abs() < 1e-9,
            "{self:?}"
        );
    }
}

/// Random and degenerate matrices: sizes from 0, single rows and columns, ties, equal rows, absent entries and misses.
fn matrix(draw: &mut ChaCha8Rng, trial: u32) -> Matrix {
    let largest = if trial % 100 == 99 { 40 } else { 8 };
    let mut side = || {
        if draw.random::<f64>() < 0.1 {
            1
        } else {
            (draw.random::<f64>() * f64::from(largest + 1)) as usize
        }
    };
    let (rows, columns) = (side(), side());
    let (ties, equal_rows, absent) = (
        trial.is_multiple_of(2),
        trial.is_multiple_of(7),
        f64::from(trial % 3) * 0.35,
    );
    let mut number = || {
        let value = draw.random::<f64>() * 20.0 - 10.0;
        if ties { (value / 4.0).round() } else { value }
    };
    let mut costs: Vec<f64> = (0..rows * columns).map(|_| number()).collect();
    let mut misses: Vec<f64> = (0..rows).map(|_| number()).collect();
    costs
        .iter_mut()
        .chain(&mut misses)
        .filter(|_| draw.random::<f64>() < absent)
        .for_each(|cost| *cost = ABSENT);
    if equal_rows {
        (columns..costs.len()).for_each(|index| costs[index] = costs[index - columns]);
    }
    Matrix {
        columns,
        costs,
        misses,
    }
}

fn matrices() -> impl Iterator<Item = Matrix> {
    let mut draw = Seed { seed: 20, run: 0 }.stream(Purpose::Clutter, 0, 0);
    (0..10_000).map(move |trial| matrix(&mut draw, trial))
}

/// What another solver finds, `None` when it finds no assignment. It knows no absent entries: they get a cost that no
/// assignment without them can reach.
fn elsewhere(costs: &[f64], rows: usize, columns: usize) -> Option<f64> {
    const FORBIDDEN: f64 = 1e6;
    let costs: Vec<f64> = costs.iter().map(|cost| cost.min(FORBIDDEN)).collect();
    let (row_of, column_of) = lsap::solve(rows, columns, &costs, false).unwrap();
    let cost = row_of
        .iter()
        .zip(&column_of)
        .map(|(row, column)| costs[row * columns + column])
        .sum();
    Some(cost).filter(|cost| *cost < FORBIDDEN / 2.0)
}

fn assert_same(ours: Option<f64>, theirs: Option<f64>, matrix: &Matrix) {
    match (ours, theirs) {
        (Some(ours), Some(theirs)) => assert!(
            (ours - theirs).abs() < 1e-9,
            "{ours} and {theirs} for {matrix:?}"
        ),
        _ => assert_eq!(ours, theirs, "{matrix:?}"),
    }
}

#[test]
fn sparse_with_misses_equals_the_padded_matrix_here_and_elsewhere() {
    let mut solver = AssignmentSolver::default();
    let (mut solved, mut missed) = (0, 0);
    for (trial, matrix) in matrices().enumerate() {
        let cost = matrix.solve(&mut solver, trial.is_multiple_of(2));
        let padded = matrix.padded();
        let columns = matrix.columns + matrix.rows();
        assert_same(cost, elsewhere(&padded, matrix.rows(), columns), &matrix);
        assert_same(
            cost,
            assign_dense(&padded, columns).map(|found| found.cost),
            &matrix,
        );
        if let Some(cost) = cost {
            matrix.assert_certified(&solver, cost);
            solved += 1;
            missed += (0..matrix.rows())
                .filter(|&row| solver.edge_of(row).is_none())
                .count();
        }
    }
    assert!(
        solved > 7_000 && missed > 7_000,
        "{solved} solved, {missed} rows missed"
    );
}

#[test]
fn dense_equals_elsewhere_with_more_rows_and_with_more_columns() {
    let (mut solved, mut infeasible) = (0, 0);
    for matrix in matrices() {
        let (rows, columns) = (
            if matrix.columns == 0 {
                0
            } else {
                matrix.rows()
            },
            matrix.columns,
        );
        let ours = assign_dense(&matrix.costs, columns);
        assert_same(
            ours.as_ref().map(|found| found.cost),
            elsewhere(&matrix.costs, rows, columns),
            &matrix,
        );
        let Some(found) = ours else {
            infeasible += 1;
            continue;
        };
        solved += 1;
        assert_eq!(found.column_of.iter().flatten().count(), rows.min(columns));
        let worth: f64 = found.row_duals.iter().chain(&found.column_duals).sum();
        assert!((worth - found.cost).abs() < 1e-8);
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)))
        {
            assert!(
                found.row_duals[row] + found.column_duals[column]
                    <= matrix.cost(row, column) + 1e-9
            );
        }
    }
    assert!(
        solved > 5_000 && infeasible > 500,
        "{solved} solved, {infeasible} infeasible"
    );
}

#[test]
fn small_ones_equal_brute_force() {
    let mut solver = AssignmentSolver::default();
    let mut tried = 0;
    for matrix in matrices().filter(|matrix| matrix.rows() <= 5 && matrix.columns <= 5) {
        let best = matrix.brute_force(0, &mut vec![false; matrix.columns]);
        assert_same(
            matrix.solve(&mut solver, false),
            Some(best).filter(|best| *best < ABSENT),
            &matrix,
        );
        tried += 1;
    }
    assert!(tried > 2_000, "{tried}");
}

#[test]
fn a_cheap_miss_frees_a_column_for_a_row_that_needs_it() {
    // Both rows want column 0. Row 0 could miss for 2 more; row 1's other choices cost 7 and 9 more.
    let matrix = Matrix {
        columns: 2,
        costs: vec![1.0, ABSENT, 1.0, 8.0],
        misses: vec![3.0, 10.0],
    };
    let mut solver = AssignmentSolver::default();
    assert_eq!(matrix.solve(&mut solver, false), Some(4.0));
    assert_eq!((solver.column_of(0), solver.column_of(1)), (None, Some(0)));
    assert_eq!((solver.edge_of(0), solver.edge_of(1)), (None, Some(0)));
    // u = (3, 3), v₀ = −2: row 1 would pay 2 less if there were a second column 0.
    assert_eq!(
        (
            solver.row_dual(0),
            solver.row_dual(1),
            solver.column_dual(0),
            solver.column_dual(3)
        ),
        (3.0, 3.0, -2.0, 0.0)
    );
}

#[test]
fn rows_that_must_be_assigned_and_compete_have_no_assignment() {
    let matrix = Matrix {
        columns: 1,
        costs: vec![1.0, 2.0],
        misses: vec![ABSENT, ABSENT],
    };
    assert_eq!(matrix.solve(&mut AssignmentSolver::default(), false), None);
    let alone = Matrix {
        columns: 1,
        costs: vec![f64::NAN],
        misses: vec![f64::NAN],
    };
    assert_eq!(alone.solve(&mut AssignmentSolver::default(), false), None);
}
