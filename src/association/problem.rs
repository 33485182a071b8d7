//! The association problem of one scan, sparse: for each track its candidate detections with squared distance and
//! log-likelihood, and what "no detection" costs. It is split into clusters (tracks connected by shared candidates);
//! an associator sees one cluster at a time. All memory is reused from scan to scan.

use crate::math::disjoint_sets;
use crate::model::watch::Watch;

/// A track's candidate. `log_likelihood` is ln(P_D · N(ν; 0, S) / λ), to be compared with the row's `log_missed`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// Index of the detection in its scan.
    pub detection: u32,
    pub squared_distance: f64,
    pub log_likelihood: f64,
}

/// A track of the problem: its candidates are `first .. first + count` of the edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    pub first: u32,
    pub count: u32,
    /// ln(1 − P_D · P_G).
    pub log_missed: f64,
    /// ln(λ · V): false detections expected in the track's gate, which covers V.
    pub log_gate_clutter: f64,
}

impl Row {
    /// Indices of this row's edges, in the problem and in [`Weights::edges`].
    #[inline]
    pub fn edges(&self) -> std::ops::Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }
}

/// Every track of a scan with its candidates.
#[derive(Debug, Clone, Default)]
pub struct ScanProblem {
    rows: Vec<Row>,
    edges: Vec<Edge>,
    amplitudes: Vec<f64>,
    places: Places,
    /// Of each row; [`NOBODY`] where there is none. Filled only for an associator that is told.
    own: Vec<u32>,
    problem_index: u32,
    detections: u32,
    clusters: Clusters,
}

/// Where the detections of a scan are and where its tracks expect theirs, as points of the measurement space; filled only
/// for an associator that needs places.
#[derive(Debug, Clone, Default)]
pub struct Places {
    /// Values of a measurement.
    dimensions: usize,
    /// The coordinate that is an angle (rad), if there is one.
    pub angle: Option<usize>,
    measured: Vec<f64>,
    /// z of each edge, where reports have times of their own: brought to the time of the scan by the motion of its track.
    moved: Vec<f64>,
    expected: Vec<f64>,
    inverses: Vec<f64>,
}

impl Places {
    pub fn dimensions(&self) -> usize {
        self.dimensions
    }

    /// z of a detection as the track of an edge sees it at the time of the scan.
    #[inline]
    pub fn seen(&self, edge: u32, detection: u32) -> &[f64] {
        if self.moved.is_empty() {
            &self.measured[detection as usize * self.dimensions..][..self.dimensions]
        } else {
            &self.moved[edge as usize * self.dimensions..][..self.dimensions]
        }
    }

    /// ẑ of a row.
    pub fn expected(&self, row: usize) -> &[f64] {
        &self.expected[row * self.dimensions..][..self.dimensions]
    }

    /// S⁻¹ of a row, `dimensions`² values; it is symmetric.
    pub fn inverse(&self, row: usize) -> &[f64] {
        let size = self.dimensions * self.dimensions;
        &self.inverses[row * size..][..size]
    }
}

/// One cluster: some rows of a [`ScanProblem`].
#[derive(Debug, Clone, Copy)]
pub struct Problem<'a> {
    rows: &'a [Row],
    edges: &'a [Edge],
    amplitudes: &'a [f64],
    places: &'a Places,
    own: &'a [u32],
    problem_index: u32,
    detections: u32,
    members: &'a [u32],
    watch: &'a Watch<'a>,
}

/// What an associator answers, for all rows and edges of the scan.
#[derive(Debug, Clone, Default)]
pub struct Weights {
    /// β of each edge, parallel to the problem's edges.
    pub edges: Vec<f64>,
    /// β₀ of each row: the weight of "no detection".
    pub missed: Vec<f64>,
}

impl Weights {
    /// As many weights as the problem has rows and edges, all "none".
    pub fn reset(&mut self, problem: &ScanProblem) {
        self.edges.clear();
        self.edges.resize(problem.edges.len(), 0.0);
        self.missed.clear();
        self.missed.resize(problem.rows.len(), 1.0);
    }

    /// Gives all of a row's weight to one of its edges.
    #[inline]
    pub fn choose(&mut self, row: usize, edge: usize) {
        self.missed[row] = 0.0;
        self.edges[edge] = 1.0;
    }
}

impl ScanProblem {
    /// Begins a new problem with a scan of so many detections. `problem_index` numbers the problems of a tracker.
    pub fn begin(&mut self, problem_index: u32, detections: usize) {
        self.rows.clear();
        self.edges.clear();
        self.own.clear();
        self.places.moved.clear();
        self.places.expected.clear();
        self.places.inverses.clear();
        self.problem_index = problem_index;
        self.detections = detections as u32;
    }

    /// Adds an edge to the row that the next [`ScanProblem::end_row`] closes.
    #[inline]
    pub fn push_edge(&mut self, edge: Edge) {
        self.edges.push(edge);
    }

    /// The edges pushed since the last row was closed.
    pub fn open_edges(&self) -> &[Edge] {
        let first = self.rows.last().map_or(0, |row| row.first + row.count);
        &self.edges[first as usize..]
    }

    /// Closes a row: every edge pushed since the last one is its.
    #[inline]
    pub fn end_row(&mut self, log_missed: f64, log_gate_clutter: f64) {
        let first = self.rows.last().map_or(0, |row| row.first + row.count);
        self.rows.push(Row {
            first,
            count: self.edges.len() as u32 - first,
            log_missed,
            log_gate_clutter,
        });
    }

    /// The amplitudes of the scan's detections, for an associator that needs them; kept until the next call.
    pub fn set_amplitudes(&mut self, amplitudes: impl Iterator<Item = f64>) {
        self.amplitudes.clear();
        self.amplitudes.extend(amplitudes);
    }

    /// The measurements of the scan's detections, for an associator that needs places; kept until the next call.
    pub fn set_measurements<'m>(
        &mut self,
        dimensions: usize,
        angle: Option<usize>,
        values: impl Iterator<Item = &'m [f64]>,
    ) {
        let places = &mut self.places;
        (places.dimensions, places.angle) = (dimensions, angle);
        places.measured.clear();
        values.for_each(|value| places.measured.extend_from_slice(value));
    }

    /// What the detection of the edge pushed last differs from ẑ at its own time, for an associator that needs places: for every
    /// edge of a problem or for none. `expected` is ẑ of the row at the time of the scan.
    pub fn push_moved(&mut self, expected: &[f64], innovation: &[f64]) {
        let moved = expected.iter().zip(innovation);
        let moved = moved.map(|(expected, innovation)| expected + innovation);
        self.places.moved.extend(moved);
    }

    /// ẑ and S⁻¹ of the row that the next [`ScanProblem::end_row`] closes, for an associator that needs places.
    pub fn push_place(&mut self, expected: &[f64], inverse: &[f64]) {
        self.places.expected.extend_from_slice(expected);
        self.places.inverses.extend_from_slice(inverse);
    }

    /// The detection of the target of the row that the next [`ScanProblem::end_row`] closes, for an associator that is told.
    pub fn push_own(&mut self, detection: Option<u32>) {
        self.own.push(detection.unwrap_or(NOBODY));
    }

    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// Calls `visit` for each cluster, in the order of its first row; rows without a candidate are in none.
    pub fn for_each_cluster(&mut self, visit: impl FnMut(&Problem)) {
        self.for_each_cluster_until(&Watch::never(), visit);
    }

    /// The same, until the watch says to stop.
    pub fn for_each_cluster_until(&mut self, watch: &Watch, mut visit: impl FnMut(&Problem)) {
        let ScanProblem {
            rows,
            edges,
            amplitudes,
            places,
            own,
            clusters,
            problem_index,
            detections,
        } = self;
        clusters.find(rows, edges, *detections as usize);
        for members in clusters.iter() {
            visit(&Problem {
                rows,
                edges,
                amplitudes,
                places,
                own,
                problem_index: *problem_index,
                detections: *detections,
                members,
                watch,
            });
            if watch.stops_after(members.len() as u64) {
                return;
            }
        }
    }
}

impl<'a> Problem<'a> {
    /// The cluster's rows, each with its index in the scan (and in [`Weights::missed`]).
    pub fn rows(&self) -> impl Iterator<Item = (usize, &'a Row)> + use<'a> {
        let rows = self.rows;
        self.members
            .iter()
            .map(move |&row| (row as usize, &rows[row as usize]))
    }

    pub fn row_count(&self) -> usize {
        self.members.len()
    }

    /// The row with an index taken from [`Problem::rows`].
    #[inline]
    pub fn row(&self, index: usize) -> &'a Row {
        &self.rows[index]
    }

    /// The edge with an index taken from [`Row::edges`].
    #[inline]
    pub fn edge(&self, index: usize) -> &'a Edge {
        &self.edges[index]
    }

    /// The edges of one of the cluster's rows.
    #[inline]
    pub fn edges_of(&self, row: &Row) -> &'a [Edge] {
        &self.edges[row.edges()]
    }

    /// Says whether to stop, once a piece of work in so many parts is done. An associator that stops may leave any weights.
    #[inline]
    pub fn stops_after(&self, pieces: u64) -> bool {
        self.watch.stops_after(pieces)
    }

    /// What says whether to stop.
    pub fn watch(&self) -> &'a Watch<'a> {
        self.watch
    }

    /// Numbers the problems of a tracker: with a row it names what a random choice is for.
    pub fn problem_index(&self) -> u32 {
        self.problem_index
    }

    /// Detections of the whole scan.
    pub fn detections(&self) -> u32 {
        self.detections
    }

    /// Only for an associator that said it needs places.
    pub fn places(&self) -> &'a Places {
        self.places
    }

    /// The detection of the target of a row of the scan; only for an associator that said it needs origins in gates.
    pub fn own(&self, row: usize) -> Option<u32> {
        Some(self.own[row]).filter(|&detection| detection != NOBODY)
    }

    /// The amplitude of a detection; only for an associator that said it needs amplitudes.
    #[inline]
    pub fn amplitude(&self, detection: u32) -> f64 {
        self.amplitudes[detection as usize]
    }
}

/// Connected components of rows that share detections, by union–find.
#[derive(Debug, Clone, Default)]
struct Clusters {
    /// Parent of each row; a cluster's root is its first row.
    parent: Vec<u32>,
    /// The first row that wanted each detection.
    wanted_by: Vec<u32>,
    /// Rows, grouped by cluster.
    members: Vec<u32>,
    /// End of each cluster in `members`.
    ends: Vec<u32>,
    /// Index of each root's cluster.
    cluster_of: Vec<u32>,
}

const NOBODY: u32 = u32::MAX;

impl Clusters {
    fn find(&mut self, rows: &[Row], edges: &[Edge], detections: usize) {
        disjoint_sets::reset(&mut self.parent, rows.len());
        self.wanted_by.clear();
        self.wanted_by.resize(detections, NOBODY);
        for (index, row) in rows.iter().enumerate() {
            for edge in &edges[row.edges()] {
                let other = &mut self.wanted_by[edge.detection as usize];
                if *other == NOBODY {
                    *other = index as u32;
                } else {
                    disjoint_sets::join(&mut self.parent, *other, index as u32);
                }
            }
        }
        self.group(rows);
    }

    /// Counting sort of the rows that have candidates by cluster.
    fn group(&mut self, rows: &[Row]) {
        self.cluster_of.clear();
        self.cluster_of.resize(rows.len(), NOBODY);
        self.ends.clear();
        for row in 0..rows.len() as u32 {
            let root = disjoint_sets::root(&mut self.parent, row) as usize;
            if rows[row as usize].count > 0 {
                if self.cluster_of[root] == NOBODY {
                    self.cluster_of[root] = self.ends.len() as u32;
                    self.ends.push(0);
                }
                self.ends[self.cluster_of[root] as usize] += 1;
            }
        }
        let mut total = 0;
        for end in &mut self.ends {
            let size = *end;
            *end = total;
            total += size;
        }
        self.members.clear();
        self.members.resize(total as usize, 0);
        for row in 0..rows.len() as u32 {
            if rows[row as usize].count > 0 {
                let root = disjoint_sets::root(&mut self.parent, row) as usize;
                let end = &mut self.ends[self.cluster_of[root] as usize];
                self.members[*end as usize] = row;
                *end += 1;
            }
        }
    }

    fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts
            .zip(&self.ends)
            .map(|(start, &end)| &self.members[start as usize..end as usize])
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A problem from (detection, d²) lists, one list a track, of a scan with twelve detections.
    pub(crate) fn problem_of(tracks: &[&[(u32, f64)]]) -> ScanProblem {
        let mut problem = ScanProblem::default();
        problem.begin(0, 12);
        for candidates in tracks {
            for &(detection, squared_distance) in *candidates {
                problem.push_edge(Edge {
                    detection,
                    squared_distance,
                    log_likelihood: -0.5 * squared_distance,
                });
            }
            problem.end_row(0.1f64.ln(), 0.0);
        }
        problem
    }

    /// The detection that a hard associator gives to each track.
    pub(crate) fn chosen_by(
        associator: &mut dyn super::super::Associator,
        problem: &mut ScanProblem,
    ) -> Vec<Option<u32>> {
        let mut weights = Weights::default();
        weights.reset(problem);
        problem.for_each_cluster(|cluster| associator.associate(cluster, &mut weights));
        let pick = |row: &Row| {
            row.edges()
                .find(|&edge| weights.edges[edge] == 1.0)
                .map(|edge| problem.edges()[edge].detection)
        };
        problem.rows().iter().map(pick).collect()
    }

    fn clusters_of(problem: &mut ScanProblem) -> Vec<Vec<usize>> {
        let mut clusters = Vec::new();
        problem.for_each_cluster(|cluster| {
            clusters.push(cluster.rows().map(|(row, _)| row).collect())
        });
        clusters
    }

    #[test]
    fn tracks_that_share_a_detection_are_one_cluster() {
        let mut problem = problem_of(&[
            &[(0, 1.0)],
            &[(3, 1.0)],
            &[],
            &[(0, 1.0), (1, 1.0)],
            &[(2, 1.0)],
            &[(1, 1.0), (2, 1.0)],
        ]);
        assert_eq!(clusters_of(&mut problem), vec![vec![0, 3, 4, 5], vec![1]]);
    }

    proptest! {
        #[test]
        fn clusters_equal_the_transitive_closure(wants in prop::collection::vec(prop::collection::btree_set(0u32..12, 0..4), 0..12)) {
            let lists: Vec<Vec<(u32, f64)>> = wants.iter().map(|set| set.iter().map(|&detection| (detection, 1.0)).collect()).collect();
            let slices: Vec<&[(u32, f64)]> = lists.iter().map(Vec::as_slice).collect();
            let mut found = vec![usize::MAX; wants.len()];
            for (cluster, rows) in clusters_of(&mut problem_of(&slices)).into_iter().enumerate() {
                for row in rows {
                    found[row] = cluster;
                }
            }
            let mut reach = vec![vec![false; wants.len()]; wants.len()];
            for (a, b) in (0..wants.len()).flat_map(|a| (0..wants.len()).map(move |b| (a, b))) {
                reach[a][b] = !wants[a].is_disjoint(&wants[b]);
            }
            for middle in 0..wants.len() {
                for (a, b) in (0..wants.len()).flat_map(|a| (0..wants.len()).map(move |b| (a, b))) {
                    reach[a][b] |= reach[a][middle] && reach[middle][b];
                }
            }
            for (a, b) in (0..wants.len()).flat_map(|a| (0..wants.len()).map(move |b| (a, b))) {
                prop_assert_eq!(reach[a][b], found[a] == found[b] && found[a] != usize::MAX, "rows {} and {}", a, b);
            }
        }
    }
}
