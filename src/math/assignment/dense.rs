//! Assignment over a full matrix without misses: as many pairs as the shorter side has members.

use super::AssignmentSolver;

/// The optimum over a matrix. The duals certify it as in [`super`], with rows and columns changing places when there are
/// more rows than columns: then vⱼ is free and uᵢ ≤ 0, with uᵢ = 0 for every row that is left over.
#[derive(Debug, Clone, PartialEq)]
pub struct DenseAssignment {
    pub cost: f64,
    /// For each row its column.
    pub column_of: Vec<Option<usize>>,
    pub row_duals: Vec<f64>,
    pub column_duals: Vec<f64>,
}

/// Assigns the rows of a matrix, given row by row, to its columns; every member of the shorter side gets a partner.
/// A cost that is not finite forbids the pair. `None` when there is no assignment.
pub fn assign_dense(costs: &[f64], columns: usize) -> Option<DenseAssignment> {
    let rows = costs.len().checked_div(columns).unwrap_or(0);
    let is_wide = rows <= columns;
    let (short, long) = if is_wide {
        (rows, columns)
    } else {
        (columns, rows)
    };
    let mut solver = AssignmentSolver::default();
    for near in 0..short {
        for far in 0..long {
            let cost = if is_wide {
                costs[near * columns + far]
            } else {
                costs[far * columns + near]
            };
            solver.push_edge(far as u32, cost);
        }
        solver.end_row(f64::INFINITY);
    }
    let cost = solver.solve()?;
    let far_of: Vec<usize> = (0..short).filter_map(|near| solver.edge_of(near)).collect();
    let near_duals = (0..short).map(|near| solver.row_dual(near)).collect();
    let far_duals = (0..long)
        .map(|far| solver.column_dual(far as u32))
        .collect();
    if is_wide {
        let column_of = far_of.into_iter().map(Some).collect();
        return Some(DenseAssignment {
            cost,
            column_of,
            row_duals: near_duals,
            column_duals: far_duals,
        });
    }
    let mut column_of = vec![None; rows];
    for (near, far) in far_of.into_iter().enumerate() {
        column_of[far] = Some(near);
    }
    Some(DenseAssignment {
        cost,
        column_of,
        row_duals: far_duals,
        column_duals: near_duals,
    })
}
