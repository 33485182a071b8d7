//! Local search: makes a partition cheaper by changes of two rows at a time until none of them helps.
//!
//! # Method
//! For a track i of row A and each row B to which a link of negative cost leads from i (from sensor s to sensor t):
//! 1. i leaves A and is alone.
//! 2. i and the track of sensor s in B, if there is one, change rows.
//! 3. i goes to B; the track of sensor s in B is alone.
//! 4. A and B become one row, where they share no sensor.
//! 5. A and B exchange what comes after sensor s. In a chain with t > s instead: A ends with i and goes on with B from t; what
//!    is left of B and of A becomes one row, if that orders its sensors, else two.
//!
//! The change that gains most is made, and the tracks of the rows that it touched are looked at again.

use super::cluster::{Cluster, LEAST_GAIN, NONE};
use super::partition::Partition;

/// Memory of the search, reused from partition to partition.
#[derive(Debug, Default)]
pub(super) struct Improver {
    waiting: Vec<u32>,
    is_waiting: Vec<bool>,
    /// For each row the last round in which it was tried as B.
    seen: Vec<u32>,
    round: u32,
    trial: Change,
    best: Change,
    /// Changes whose cost was computed.
    pub(super) evaluations: u64,
}

/// What takes the place of two rows: up to three.
#[derive(Debug, Default)]
struct Change {
    of: [u32; 2],
    rows: [Vec<u32>; 3],
    gain: f64,
}

impl Change {
    /// Takes the tracks of two rows as they are; of one, if both are the same.
    fn begin(&mut self, partition: &Partition, a: u32, b: u32) {
        self.of = [a, b];
        self.rows.iter_mut().for_each(Vec::clear);
        self.rows[0].extend_from_slice(partition.row(a));
        let sensors = self.rows[0].len();
        if a == b {
            self.rows[1].resize(sensors, NONE);
        } else {
            self.rows[1].extend_from_slice(partition.row(b));
        }
        self.rows[2].resize(sensors, NONE);
    }

    fn measure(&mut self, cluster: &Cluster, partition: &Partition) {
        let [a, b] = self.of;
        let before = partition.cost_of(a) + if a == b { 0.0 } else { partition.cost_of(b) };
        self.gain = before - self.rows.iter().map(|row| cluster.cost(row)).sum::<f64>();
    }

    fn make(&self, cluster: &Cluster, partition: &mut Partition) {
        self.of.iter().for_each(|&row| partition.clear(row));
        self.rows.iter().for_each(|row| partition.add(cluster, row));
    }

    fn tracks(&self) -> impl Iterator<Item = u32> {
        self.rows
            .iter()
            .flatten()
            .copied()
            .filter(|&track| track != NONE)
    }
}

impl Improver {
    /// Makes ready for a cluster.
    pub(super) fn begin(&mut self, cluster: &Cluster) {
        self.waiting.clear();
        self.is_waiting.clear();
        self.is_waiting.resize(cluster.len(), false);
        self.seen.clear();
        self.seen.resize(cluster.len(), 0);
        self.round = 0;
    }

    /// Notes a track whose surroundings have changed; the last one noted is looked at first.
    pub(super) fn note(&mut self, track: u32) {
        if !std::mem::replace(&mut self.is_waiting[track as usize], true) {
            self.waiting.push(track);
        }
    }

    /// Improves until no change around any track gains anything.
    pub(super) fn improve_all(&mut self, cluster: &Cluster, partition: &mut Partition) {
        self.begin(cluster);
        (0..cluster.len() as u32).for_each(|track| self.note(track));
        self.improve(cluster, partition);
    }

    /// Improves until no change around the noted tracks, and those that changes touch, gains anything.
    pub(super) fn improve(&mut self, cluster: &Cluster, partition: &mut Partition) {
        while let Some(track) = self.waiting.pop() {
            self.is_waiting[track as usize] = false;
            self.look_around(cluster, partition, track);
            if self.best.gain > LEAST_GAIN {
                self.best.make(cluster, partition);
                let best = std::mem::take(&mut self.best);
                best.tracks().for_each(|track| self.note(track));
                self.best = best;
            }
        }
    }

    /// The best change around a track.
    fn look_around(&mut self, cluster: &Cluster, partition: &Partition, track: u32) {
        self.best.gain = 0.0;
        self.round += 1;
        let a = partition.row_of(track);
        self.seen[a as usize] = self.round;
        self.try_alone(cluster, partition, track);
        for edge in cluster
            .edges(track)
            .iter()
            .filter(|edge| edge.cost < 0.0 || !cluster.is_pairwise())
        {
            let b = partition.row_of(edge.track);
            if a != b && cluster.is_chain() {
                self.try_link(cluster, partition, [track, edge.track]);
            }
            if std::mem::replace(&mut self.seen[b as usize], self.round) != self.round {
                self.try_with(cluster, partition, track, b);
            }
        }
    }

    /// Change 1.
    fn try_alone(&mut self, cluster: &Cluster, partition: &Partition, track: u32) {
        let (a, sensor) = (partition.row_of(track), cluster.sensor_of(track));
        if partition.cost_of(a) != 0.0 {
            self.trial.begin(partition, a, a);
            let [row, alone, _] = &mut self.trial.rows;
            std::mem::swap(&mut row[sensor], &mut alone[sensor]);
            self.weigh(cluster, partition);
        }
    }

    /// Changes 2 to 5 with one other row.
    fn try_with(&mut self, cluster: &Cluster, partition: &Partition, track: u32, b: u32) {
        let (a, sensor) = (partition.row_of(track), cluster.sensor_of(track));
        self.trial.begin(partition, a, b);
        let [left, right, _] = &mut self.trial.rows;
        std::mem::swap(&mut left[sensor], &mut right[sensor]);
        let is_taken = left[sensor] != NONE;
        self.weigh(cluster, partition);
        if is_taken {
            let [left, _, alone] = &mut self.trial.rows;
            std::mem::swap(&mut left[sensor], &mut alone[sensor]);
            self.weigh(cluster, partition);
        }
        if !is_taken
            && partition
                .row(a)
                .iter()
                .zip(partition.row(b))
                .all(|(&left, &right)| left == NONE || right == NONE)
        {
            self.trial.begin(partition, a, b);
            let [left, right, _] = &mut self.trial.rows;
            left.iter_mut()
                .zip(right)
                .filter(|(left, _)| **left == NONE)
                .for_each(|(left, right)| std::mem::swap(left, right));
            self.weigh(cluster, partition);
        }
        if !cluster.is_chain() {
            self.trial.begin(partition, a, b);
            let [left, right, _] = &mut self.trial.rows;
            left[sensor + 1..].swap_with_slice(&mut right[sensor + 1..]);
            self.weigh(cluster, partition);
        }
    }

    /// Change 5 of a chain, by the link that it makes.
    fn try_link(&mut self, cluster: &Cluster, partition: &Partition, ends: [u32; 2]) {
        let from = ends[0].min(ends[1]);
        let to = ends[0].max(ends[1]);
        let (s, t) = (cluster.sensor_of(from), cluster.sensor_of(to));
        self.trial
            .begin(partition, partition.row_of(from), partition.row_of(to));
        let [left, right, rest] = &mut self.trial.rows;
        rest[s + 1..].swap_with_slice(&mut left[s + 1..]);
        left[t..].swap_with_slice(&mut right[t..]);
        let last = right.iter().rposition(|&track| track != NONE);
        let next = rest.iter().position(|&track| track != NONE);
        if let (Some(last), Some(next)) = (last, next)
            && last < next
        {
            right[next..].swap_with_slice(&mut rest[next..]);
        }
        self.weigh(cluster, partition);
    }

    fn weigh(&mut self, cluster: &Cluster, partition: &Partition) {
        self.evaluations += 1;
        self.trial.measure(cluster, partition);
        if self.trial.gain > self.best.gain {
            let Change { of, rows, gain } = &self.trial;
            (self.best.of, self.best.gain) = (*of, *gain);
            self.best
                .rows
                .iter_mut()
                .zip(rows)
                .for_each(|(best, row)| best.clone_from(row));
        }
    }
}

/// What others answer for a cluster, after local search, the better first.
pub(super) fn improve_all(
    cluster: &Cluster,
    known: &[Vec<Vec<u32>>],
    improver: &mut Improver,
) -> Vec<Partition> {
    let improve = |tuples: &Vec<Vec<u32>>| {
        let mut partition = Partition::of_problem(cluster, tuples);
        improver.improve_all(cluster, &mut partition);
        partition
    };
    let mut partitions: Vec<Partition> = known.iter().map(improve).collect();
    partitions.sort_by(|left, right| left.cost().total_cmp(&right.cost()));
    partitions
}
