//! Optimal assignment of rows to columns, sparse and rectangular. A row takes one of its edges or stays unassigned at a
//! cost of its own (its miss); a column is taken at most once and may stay free. The least total cost comes with dual
//! variables that certify it.
//!
//! # Reference
//! R. Jonker, A. Volgenant, A shortest augmenting path algorithm for dense and sparse linear assignment problems,
//! Computing 38, 1987, 325–340; D. F. Crouse, On implementing 2D rectangular assignment algorithms, IEEE Trans. Aerospace
//! and Electronic Systems 52, 2016, 1679–1696.
//!
//! # Symbols
//! cᵢⱼ cost of an edge, mᵢ of a miss; uᵢ, vⱼ dual variables; dⱼ length of the shortest path to a column.
//!
//! # Method
//! A miss is a column that only its own row knows. It is never stored: wherever a path has reached row i, it may end there
//! at mᵢ − uᵢ.
//! 1. Row reduction: vⱼ = 0, uᵢ = min(mᵢ, minⱼ cᵢⱼ); a row whose minimum is its miss or a free column takes it.
//! 2. For every other row the shortest augmenting path (Dijkstra's) over the reduced costs cᵢⱼ − uᵢ − vⱼ ≥ 0 to a free
//!    column or a miss; then uᵢ and vⱼ of what was reached are moved so that the reduced costs stay so, and those along
//!    the path are 0.
//! 3. The certificate: uᵢ + vⱼ ≤ cᵢⱼ, uᵢ ≤ mᵢ, vⱼ ≤ 0, with equality for every edge and miss that is taken and vⱼ = 0 for
//!    every free column; so Σ uᵢ + Σ vⱼ, which no assignment can undercut, is the cost.
//!
//! All memory is reused from problem to problem.

mod dense;
#[cfg(test)]
mod tests;

pub use dense::{DenseAssignment, assign_dense};

use crate::model::watch::Watch;

const NONE: u32 = u32::MAX;

/// Solves one problem after another: [`clear`](Self::clear), edges and [`end_row`](Self::end_row) for each row,
/// [`solve`](Self::solve), then read the answer.
#[derive(Debug, Clone, Default)]
pub struct AssignmentSolver {
    rows: Vec<RowState>,
    edges: Vec<Edge>,
    columns: Vec<ColumnState>,
    /// The place in `columns` of each column number ever met; `NONE` where this problem has not named it.
    place_of: Vec<u32>,
    /// Columns that are taken and reached, but whose rows the search has not looked at.
    frontier: Vec<u32>,
    /// Rows that the search has looked at, each with the length of the path to it.
    looked_at: Vec<(u32, f64)>,
    /// Columns whose rows the search has looked at.
    settled: Vec<u32>,
    /// Columns that the search has met.
    met: Vec<u32>,
}

#[derive(Debug, Clone, Copy)]
struct Edge {
    column: u32,
    cost: f64,
}

#[derive(Debug, Clone, Copy)]
struct RowState {
    end: u32,
    /// The edge taken, by its index in `edges`; `NONE` for a miss, and before the row was served.
    taken: u32,
    miss: f64,
    dual: f64,
}

#[derive(Debug, Clone, Copy)]
struct ColumnState {
    /// What the caller calls it.
    number: u32,
    /// The row that takes it.
    row: u32,
    dual: f64,
    /// Of the search: dⱼ, infinite where the column was not met.
    distance: f64,
    /// The last row and edge of the shortest path to it.
    from_row: u32,
    from_edge: u32,
}

/// Where a search may end: with the miss of a row, or in a free column.
#[derive(Debug, Clone, Copy)]
enum End {
    Miss(u32),
    Column(u32),
}

impl AssignmentSolver {
    /// Forgets the problem before.
    pub fn clear(&mut self) {
        for column in self.columns.drain(..) {
            self.place_of[column.number as usize] = NONE;
        }
        self.rows.clear();
        self.edges.clear();
        self.met.clear();
    }

    /// Adds an edge to the row that the next [`end_row`](Self::end_row) closes. An edge whose cost is not finite is
    /// absent, though it counts among the row's edges. Memory grows with the largest column number, time does not.
    #[inline]
    pub fn push_edge(&mut self, column: u32, cost: f64) {
        if self.place_of.len() <= column as usize {
            self.place_of.resize(column as usize + 1, NONE);
        }
        let place = &mut self.place_of[column as usize];
        if *place == NONE {
            *place = self.columns.len() as u32;
            let (distance, from) = (f64::INFINITY, NONE);
            self.columns.push(ColumnState {
                number: column,
                row: NONE,
                dual: 0.0,
                distance,
                from_row: from,
                from_edge: from,
            });
        }
        self.edges.push(Edge {
            column: *place,
            cost: if cost.is_finite() {
                cost
            } else {
                f64::INFINITY
            },
        });
    }

    /// Closes a row: every edge pushed since the last one is its. `miss` is what it costs to leave it unassigned;
    /// when that is not finite, it must be assigned.
    #[inline]
    pub fn end_row(&mut self, miss: f64) {
        let miss = if miss.is_finite() {
            miss
        } else {
            f64::INFINITY
        };
        self.rows.push(RowState {
            end: self.edges.len() as u32,
            taken: NONE,
            miss,
            dual: 0.0,
        });
    }

    /// The least total cost; `None` when there is no assignment, because rows that must be assigned compete.
    pub fn solve(&mut self) -> Option<f64> {
        self.solve_until(&Watch::never())
    }

    /// The same; `None` also when the watch says to stop.
    pub fn solve_until(&mut self, watch: &Watch) -> Option<f64> {
        for row in 0..self.rows.len() as u32 {
            self.reduce(row);
        }
        for row in 0..self.rows.len() as u32 {
            let state = &self.rows[row as usize];
            // A row that took its miss in step 1 has u = m; one that did not is waiting.
            if state.taken == NONE && state.dual < state.miss {
                let (length, end) = self.shortest_path(row)?;
                self.move_duals(length);
                self.augment(row, end);
                let edges_of_row = self.edges.len() / self.rows.len();
                if watch.stops_after((self.looked_at.len() * edges_of_row) as u64) {
                    return None;
                }
            } else if state.dual == f64::INFINITY {
                return None;
            }
        }
        Some(self.cost())
    }

    /// Which of its edges a row takes, counted from 0 in the order in which they were pushed; `None` for a miss.
    #[inline]
    pub fn edge_of(&self, row: usize) -> Option<usize> {
        let taken = self.rows[row].taken;
        (taken != NONE).then(|| taken as usize - self.range(row as u32).start)
    }

    /// The column that a row takes.
    pub fn column_of(&self, row: usize) -> Option<u32> {
        let edge = self.edges.get(self.rows[row].taken as usize)?;
        Some(self.columns[edge.column as usize].number)
    }

    /// uᵢ.
    pub fn row_dual(&self, row: usize) -> f64 {
        self.rows[row].dual
    }

    /// vⱼ; 0 for a column that no edge names.
    pub fn column_dual(&self, column: u32) -> f64 {
        let place = self.place_of.get(column as usize).copied().unwrap_or(NONE);
        self.columns
            .get(place as usize)
            .map_or(0.0, |state| state.dual)
    }

    #[inline]
    fn range(&self, row: u32) -> std::ops::Range<usize> {
        let start = if row == 0 {
            0
        } else {
            self.rows[row as usize - 1].end
        };
        start as usize..self.rows[row as usize].end as usize
    }

    /// Step 1 for one row.
    #[inline]
    fn reduce(&mut self, row: u32) {
        let mut least = self.rows[row as usize].miss;
        let mut best = NONE;
        for index in self.range(row) {
            if self.edges[index].cost < least {
                least = self.edges[index].cost;
                best = index as u32;
            }
        }
        self.rows[row as usize].dual = least;
        if best != NONE {
            let column = self.edges[best as usize].column;
            if self.columns[column as usize].row == NONE {
                self.take(row, best, column);
            }
        }
    }

    #[inline]
    fn take(&mut self, row: u32, edge: u32, column: u32) {
        self.columns[column as usize].row = row;
        self.rows[row as usize].taken = edge;
    }

    /// Step 2: length and end of the shortest augmenting path from a row.
    fn shortest_path(&mut self, start: u32) -> Option<(f64, End)> {
        for column in self.met.drain(..) {
            self.columns[column as usize].distance = f64::INFINITY;
        }
        self.frontier.clear();
        self.looked_at.clear();
        self.settled.clear();
        let mut best = (f64::INFINITY, End::Miss(start));
        let (mut row, mut length) = (start, 0.0);
        loop {
            self.look_at(row, length, &mut best);
            let Some(next) = self
                .nearest_in_frontier()
                .filter(|&(_, distance)| distance < best.0)
            else {
                break;
            };
            let (place, distance) = next;
            let column = self.frontier.swap_remove(place);
            self.settled.push(column);
            (row, length) = (self.columns[column as usize].row, distance);
        }
        (best.0 < f64::INFINITY).then_some(best)
    }

    /// Takes the search on from a row that a path of `length` reaches.
    #[inline]
    fn look_at(&mut self, row: u32, length: f64, best: &mut (f64, End)) {
        self.looked_at.push((row, length));
        let RowState { miss, dual, .. } = self.rows[row as usize];
        // Rounding may leave a reduced cost just below 0; no path gets shorter by going on.
        let miss_length = length + (miss - dual).max(0.0);
        if miss_length < best.0 {
            *best = (miss_length, End::Miss(row));
        }
        for index in self.range(row) {
            let Edge { column, cost } = self.edges[index];
            let state = &mut self.columns[column as usize];
            let reached = length + (cost - dual - state.dual).max(0.0);
            if reached >= state.distance || reached >= best.0 {
                continue;
            }
            if state.distance == f64::INFINITY {
                self.met.push(column);
                if state.row != NONE {
                    self.frontier.push(column);
                }
            }
            state.distance = reached;
            (state.from_row, state.from_edge) = (row, index as u32);
            if state.row == NONE {
                *best = (reached, End::Column(column));
            }
        }
    }

    /// Place in the frontier and distance of its nearest column.
    #[inline]
    fn nearest_in_frontier(&self) -> Option<(usize, f64)> {
        let distances = self
            .frontier
            .iter()
            .map(|&column| self.columns[column as usize].distance);
        distances
            .enumerate()
            .min_by(|left, right| left.1.total_cmp(&right.1))
    }

    /// Keeps the reduced costs at 0 or above, and at 0 along every shortest path.
    fn move_duals(&mut self, length: f64) {
        for &(row, distance) in &self.looked_at {
            self.rows[row as usize].dual += length - distance;
        }
        for &column in &self.settled {
            let state = &mut self.columns[column as usize];
            state.dual -= length - state.distance;
        }
    }

    /// Gives every row of the path the next column of it; the row that ends it may take its miss instead.
    fn augment(&mut self, start: u32, end: End) {
        let mut column = match end {
            End::Column(column) => column,
            End::Miss(row) => {
                let state = &mut self.rows[row as usize];
                let given_up = std::mem::replace(&mut state.taken, NONE);
                state.dual = state.miss;
                if row == start {
                    return;
                }
                self.edges[given_up as usize].column
            }
        };
        loop {
            let ColumnState {
                from_row,
                from_edge,
                ..
            } = self.columns[column as usize];
            let given_up = self.rows[from_row as usize].taken;
            self.take(from_row, from_edge, column);
            if from_row == start {
                return;
            }
            column = self.edges[given_up as usize].column;
        }
    }

    fn cost(&self) -> f64 {
        let cost = |row: &RowState| {
            self.edges
                .get(row.taken as usize)
                .map_or(row.miss, |edge| edge.cost)
        };
        self.rows.iter().map(cost).sum()
    }
}
