//! The tracks of a cluster in tuples, each tuple a row by sensor. What searches for a cheaper one changes two rows at a time.

use super::cluster::{Cluster, NONE};

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Partition {
    sensors: usize,
    /// As many rows as tracks, so that each may have its own; some are empty.
    rows: Vec<u32>,
    costs: Vec<f64>,
    row_of: Vec<u32>,
    empty: Vec<u32>,
}

impl Partition {
    /// Every track by itself.
    pub(super) fn singles(cluster: &Cluster) -> Self {
        let (tracks, sensors) = (cluster.len(), cluster.sensors());
        let mut rows = vec![NONE; tracks * sensors];
        for track in 0..tracks {
            rows[track * sensors + cluster.sensor_of(track as u32)] = track as u32;
        }
        Partition {
            sensors,
            rows,
            costs: vec![0.0; tracks],
            row_of: (0..tracks as u32).collect(),
            empty: Vec::new(),
        }
    }

    /// From tuples that exist; a track that is in none is alone.
    pub(super) fn from_tuples<'t>(
        cluster: &Cluster,
        tuples: impl Iterator<Item = &'t [u32]>,
    ) -> Self {
        let mut partition = Partition::singles(cluster);
        let mut row = vec![NONE; cluster.sensors()];
        for tuple in tuples.filter(|tuple| tuple.len() > 1) {
            row.fill(NONE);
            tuple
                .iter()
                .for_each(|&track| row[cluster.sensor_of(track)] = track);
            tuple
                .iter()
                .for_each(|&track| partition.clear(partition.row_of(track)));
            partition.add(cluster, &row);
        }
        partition
    }

    /// What the tuples of a whole problem are in this cluster.
    pub(super) fn of_problem(cluster: &Cluster, tuples: &[Vec<u32>]) -> Self {
        let here = |tuple: &Vec<u32>| {
            tuple
                .iter()
                .filter_map(|&track| cluster.number_of(track))
                .collect::<Vec<u32>>()
        };
        let here: Vec<Vec<u32>> = tuples.iter().map(here).collect();
        Partition::from_tuples(cluster, here.iter().map(Vec::as_slice))
    }

    #[inline]
    pub(super) fn row(&self, number: u32) -> &[u32] {
        &self.rows[number as usize * self.sensors..][..self.sensors]
    }

    #[inline]
    pub(super) fn row_of(&self, track: u32) -> u32 {
        self.row_of[track as usize]
    }

    #[inline]
    pub(super) fn cost_of(&self, row: u32) -> f64 {
        self.costs[row as usize]
    }

    /// J.
    pub(super) fn cost(&self) -> f64 {
        self.costs.iter().sum()
    }

    /// The tuples, members ascending.
    pub(super) fn tuples(&self) -> impl Iterator<Item = Vec<u32>> {
        self.rows.chunks_exact(self.sensors).filter_map(|row| {
            let tuple: Vec<u32> = row.iter().copied().filter(|&track| track != NONE).collect();
            (!tuple.is_empty()).then_some(tuple)
        })
    }

    /// Empties a row; its tracks must be put elsewhere.
    pub(super) fn clear(&mut self, number: u32) {
        let row = &mut self.rows[number as usize * self.sensors..][..self.sensors];
        if row.iter().any(|&track| track != NONE) {
            row.fill(NONE);
            self.costs[number as usize] = 0.0;
            self.empty.push(number);
        }
    }

    /// Puts tracks that are in no row into one; a chain that a missing link cuts gets a row for each piece.
    pub(super) fn add(&mut self, cluster: &Cluster, row: &[u32]) {
        if !cluster.is_chain() {
            return self.add_whole(cluster, row);
        }
        let (mut first, mut before) = (0, NONE);
        for (sensor, &track) in row.iter().enumerate().filter(|&(_, &track)| track != NONE) {
            if before != NONE && cluster.link(before, track).is_none() {
                self.add_piece(cluster, row, first..sensor);
                first = sensor;
            }
            before = track;
        }
        self.add_piece(cluster, row, first..row.len());
    }

    fn add_piece(&mut self, cluster: &Cluster, row: &[u32], piece: std::ops::Range<usize>) {
        let mut part = vec![NONE; row.len()];
        part[piece.clone()].copy_from_slice(&row[piece]);
        self.add_whole(cluster, &part);
    }

    fn add_whole(&mut self, cluster: &Cluster, row: &[u32]) {
        if row.iter().all(|&track| track == NONE) {
            return;
        }
        let number = self
            .empty
            .pop()
            .expect("there are as many rows as tracks, so one is empty while a track has none");
        self.rows[number as usize * self.sensors..][..self.sensors].copy_from_slice(row);
        self.costs[number as usize] = cluster.cost(row);
        row.iter()
            .filter(|&&track| track != NONE)
            .for_each(|&track| self.row_of[track as usize] = number);
    }
}

#[cfg(test)]
mod tests {
    use super::super::cluster::clusters;
    use super::super::problem::{CorrelationProblem, Costs};
    use super::*;

    #[test]
    fn rows_are_emptied_filled_and_cut() {
        let problem = CorrelationProblem::new(
            &[1, 1, 2],
            &[(0, 1, -3.0), (1, 2, -2.0), (0, 3, -1.0)],
            Costs::Chain,
        );
        let cluster = &clusters(&problem)[0];
        let mut partition = Partition::from_tuples(cluster, [&[0, 1][..], &[2]].into_iter());
        assert_eq!(partition.tuples().collect::<Vec<_>>().len(), 3);
        assert_eq!(partition.cost(), -3.0);
        // 1 and 3 are not linked: the row is cut between them.
        partition.clear(partition.row_of(0));
        partition.clear(partition.row_of(3));
        partition.add(cluster, &[0, 1, 3]);
        let mut tuples: Vec<_> = partition.tuples().collect();
        tuples.sort();
        assert_eq!(tuples, [vec![0, 1], vec![2], vec![3]]);
        assert_eq!(partition.cost(), -3.0);
    }
}
