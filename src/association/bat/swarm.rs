//! The bats and their moves. A neighbour differs in two entries at most, so its objective is that of the bat plus a
//! difference. All memory is reused from cluster to cluster.

use super::BatSettings;
use super::cluster::{Cluster, Move, NOBODY};
use super::cluster_rng::ClusterRng;
use super::visited::Visited;

/// Bats side by side in flat tables; x* stands behind the last bat.
#[derive(Debug, Clone, Default)]
pub(super) struct Swarm {
    rows: usize,
    /// Places of a bat in `owners`: one a detection, and one for "none" that nobody owns.
    places: usize,
    population: usize,
    /// The code of each row, bat by bat.
    entries: Vec<u32>,
    /// The row that holds each detection, bat by bat.
    owners: Vec<u32>,
    bats: Vec<BatState>,
    evaluations: u64,
}

#[derive(Debug, Clone, Copy)]
struct BatState {
    value: f64,
    /// Of the edges it holds.
    hash: u64,
    loudness: f64,
    pulse_rate: f64,
    first_pulse_rate: f64,
}

impl Swarm {
    /// Looks for the best assignment; `goes_on` is called with the swarm at the start and after each iteration. It ends early
    /// when that says no, and when every row has the best of its candidates, for then no later bat is better; not where what is visited counts.
    pub(super) fn search(
        &mut self,
        cluster: &Cluster,
        settings: &BatSettings,
        mut visited: Option<&mut Visited>,
        rng: &mut ClusterRng,
        mut goes_on: impl FnMut(&Swarm, u32) -> bool,
    ) {
        self.start(cluster, settings, visited.as_deref_mut(), rng);
        if !goes_on(self, 0) {
            return;
        }
        let enough = if visited.is_none() {
            cluster.bound()
        } else {
            f64::INFINITY
        };
        for iteration in 1..=settings.iterations {
            if self.best_value() >= enough {
                break;
            }
            let returned = -(-settings.gamma * f64::from(iteration)).exp_m1();
            for bat in 0..self.population {
                self.fly(cluster, bat, visited.as_deref_mut(), rng);
                if rng.unit() > self.bats[bat].pulse_rate {
                    self.approach_best(cluster, bat, visited.as_deref_mut(), rng);
                }
                if rng.unit() < self.bats[bat].loudness && self.is_accepted(cluster, bat) {
                    let state = &mut self.bats[bat];
                    state.loudness *= settings.alpha;
                    state.pulse_rate = state.first_pulse_rate * returned;
                }
            }
            if !goes_on(self, iteration) {
                break;
            }
        }
    }

    /// Step 1.
    fn start(
        &mut self,
        cluster: &Cluster,
        settings: &BatSettings,
        mut visited: Option<&mut Visited>,
        rng: &mut ClusterRng,
    ) {
        self.population = settings.population as usize;
        (self.rows, self.places) = (cluster.row_count(), cluster.detections() + 1);
        self.entries.clear();
        self.entries
            .resize((self.population + 1) * self.rows, cluster.missed());
        self.owners.clear();
        self.owners
            .resize((self.population + 1) * self.places, NOBODY);
        self.bats.clear();
        self.evaluations = self.population as u64;
        if let Some(visited) = &mut visited {
            visited.begin(cluster);
        }
        let mut best = 0;
        for bat in 0..self.population {
            self.draw_bat(cluster, settings, bat, rng);
            if let Some(visited) = &mut visited {
                visited.see(cluster, self.entries_of(bat), self.bats[bat].hash);
            }
            if self.bats[bat].value > self.bats[best].value {
                best = bat;
            }
        }
        self.bats.push(self.bats[best]);
        self.copy(best, self.population);
    }

    /// A new bat: the detection drawn for each row, or the next of the row's that is free.
    fn draw_bat(
        &mut self,
        cluster: &Cluster,
        settings: &BatSettings,
        bat: usize,
        rng: &mut ClusterRng,
    ) {
        let owners = &mut self.owners[bat * self.places..][..self.places];
        let entries = &mut self.entries[bat * self.rows..][..self.rows];
        let mut hash = 0;
        for (row, entry) in entries.iter_mut().enumerate() {
            let is_free = |code: &u32| owners[cluster.code(*code).detection as usize] == NOBODY;
            let drawn = cluster.draw_for(row, rng.pair().0);
            let others = cluster.codes_of(row);
            let next =
                (drawn.max(others.start)..others.end).chain(others.start..drawn.min(others.end));
            *entry = std::iter::once(drawn)
                .chain(next)
                .find(is_free)
                .unwrap_or(cluster.missed());
            let code = cluster.code(*entry);
            hash ^= code.key;
            if *entry != cluster.missed() {
                owners[code.detection as usize] = row as u32;
            }
        }
        let (value, first_pulse_rate) = (cluster.value_of(entries), rng.unit());
        self.bats.push(BatState {
            value,
            hash,
            loudness: settings.loudness,
            pulse_rate: first_pulse_rate,
            first_pulse_rate,
        });
    }

    /// Step 2.
    #[inline]
    fn fly(
        &mut self,
        cluster: &Cluster,
        bat: usize,
        mut visited: Option<&mut Visited>,
        rng: &mut ClusterRng,
    ) {
        let speed = match self.distance_to_best(bat) {
            0 | 1 => 1,
            distance => 1 + rng.below(distance),
        };
        let mut best = self.neighbour(cluster, bat, visited.as_deref_mut(), rng);
        for _ in 1..speed {
            let step = self.neighbour(cluster, bat, visited.as_deref_mut(), rng);
            if step.delta > best.delta {
                best = step;
            }
        }
        self.take(cluster, bat, best);
    }

    /// Step 3.
    #[inline]
    fn approach_best(
        &mut self,
        cluster: &Cluster,
        bat: usize,
        visited: Option<&mut Visited>,
        rng: &mut ClusterRng,
    ) {
        self.copy(self.population, bat);
        let step = self.neighbour(cluster, bat, visited, rng);
        self.take(cluster, bat, step);
    }

    /// Step 4: whether the bat is the best from now on. What differences left in its last digits goes with a fresh sum.
    #[inline]
    fn is_accepted(&mut self, cluster: &Cluster, bat: usize) -> bool {
        if self.bats[bat].value <= self.best_value() {
            return false;
        }
        self.bats[bat].value = cluster.value_of(self.entries_of(bat));
        if self.bats[bat].value <= self.best_value() {
            return false;
        }
        self.copy(bat, self.population);
        true
    }

    /// D.
    #[inline]
    fn distance_to_best(&self, bat: usize) -> u32 {
        self.entries_of(bat)
            .iter()
            .zip(self.best())
            .map(|(left, right)| u32::from(left != right))
            .sum()
    }

    /// Makes and evaluates a neighbour.
    #[inline]
    fn neighbour(
        &mut self,
        cluster: &Cluster,
        bat: usize,
        visited: Option<&mut Visited>,
        rng: &mut ClusterRng,
    ) -> Move {
        let (row, code) = cluster.draw(rng);
        let step = self.step_to(cluster, bat, row, code);
        self.evaluations += 1;
        if let Some(visited) = visited {
            visited.see_neighbour(
                cluster,
                &self.entries[bat * self.rows..][..self.rows],
                self.bats[bat].hash,
                &step,
            );
        }
        step
    }

    /// The neighbour in which `row` has `code`; who held that detection gets the row's old one, if it is his to have.
    #[inline]
    fn step_to(&self, cluster: &Cluster, bat: usize, row: u32, code: u32) -> Move {
        let entries = self.entries_of(bat);
        let (old, new) = (cluster.code(entries[row as usize]), cluster.code(code));
        let delta = new.gain - old.gain;
        let other = self.owners[bat * self.places + new.detection as usize];
        if other == NOBODY || other == row {
            return Move {
                row,
                code,
                other: NOBODY,
                other_code: code,
                delta,
            };
        }
        let other_code = cluster.code_for(other as usize, old.detection);
        let other_delta =
            cluster.code(other_code).gain - cluster.code(entries[other as usize]).gain;
        Move {
            row,
            code,
            other,
            other_code,
            delta: delta + other_delta,
        }
    }

    #[inline]
    fn take(&mut self, cluster: &Cluster, bat: usize, step: Move) {
        let entries = &mut self.entries[bat * self.rows..][..self.rows];
        let owners = &mut self.owners[bat * self.places..][..self.places];
        let state = &mut self.bats[bat];
        let mut put = |row: u32, code: u32| {
            let (old, new) = (
                cluster.code(std::mem::replace(&mut entries[row as usize], code)),
                cluster.code(code),
            );
            state.hash ^= old.key ^ new.key;
            if owners[old.detection as usize] == row {
                owners[old.detection as usize] = NOBODY;
            }
            owners[new.detection as usize] = row;
        };
        put(step.row, step.code);
        if step.other != NOBODY {
            put(step.other, step.other_code);
        }
        owners[self.places - 1] = NOBODY;
        state.value += step.delta;
    }

    /// Copies position and objective from one bat to another.
    #[inline]
    fn copy(&mut self, from: usize, to: usize) {
        let (rows, places) = (self.rows, self.places);
        self.entries
            .copy_within(from * rows..(from + 1) * rows, to * rows);
        self.owners
            .copy_within(from * places..(from + 1) * places, to * places);
        let BatState { value, hash, .. } = self.bats[from];
        (self.bats[to].value, self.bats[to].hash) = (value, hash);
    }

    #[inline]
    fn entries_of(&self, bat: usize) -> &[u32] {
        &self.entries[bat * self.rows..][..self.rows]
    }

    /// x*.
    #[inline]
    pub(super) fn best(&self) -> &[u32] {
        self.entries_of(self.population)
    }

    /// J(x*), a fresh sum.
    #[inline]
    pub(super) fn best_value(&self) -> f64 {
        self.bats[self.population].value
    }

    /// Of the bats, without x*.
    pub(super) fn mean_value(&self) -> f64 {
        self.bats[..self.population]
            .iter()
            .map(|bat| bat.value)
            .sum::<f64>()
            / self.population as f64
    }

    /// Objectives computed so far in this search: one a bat and one a neighbour.
    pub(super) fn evaluations(&self) -> u64 {
        self.evaluations
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::random_problem;
    use super::*;
    use crate::association::problem::tests::problem_of;
    use crate::math::rng::{Purpose, Seed};
    use rand::RngExt;

    fn rng(number: u64) -> ClusterRng {
        ClusterRng::new(Seed { seed: 3, run: 0 }.stream(Purpose::Associator, number, 0))
    }

    /// A swarm of one bat whose rows hold these detections.
    fn swarm_of(cluster: &Cluster, detections: &[u32]) -> Swarm {
        let mut swarm = Swarm::default();
        swarm.start(
            cluster,
            &BatSettings {
                population: 1,
                ..BatSettings::default()
            },
            None,
            &mut rng(0),
        );
        swarm.owners.fill(NOBODY);
        for (row, &detection) in detections.iter().enumerate() {
            swarm.entries[row] = cluster.code_for(row, detection);
            swarm.owners[detection as usize] = row as u32;
        }
        swarm
    }

    #[test]
    fn the_papers_example_of_a_neighbour() {
        // Four targets, nine detections, all in every gate; the paper counts detections from 1.
        let all: Vec<(u32, f64)> = (0..9).map(|detection| (detection, 1.0)).collect();
        problem_of(&[all.as_slice(); 4]).for_each_cluster(|problem| {
            let mut cluster = Cluster::default();
            cluster.load(problem, &BatSettings::default());
            for (given, expected) in [(2, [3, 5, 2, 9]), (4, [2, 5, 4, 9])] {
                let mut swarm = swarm_of(&cluster, &[1, 4, 2, 8]);
                let step = swarm.step_to(&cluster, 0, 2, cluster.code_for(2, given - 1));
                swarm.take(&cluster, 0, step);
                let after: Vec<u32> = swarm
                    .entries_of(0)
                    .iter()
                    .map(|&code| cluster.code(code).detection + 1)
                    .collect();
                assert_eq!(after, expected);
            }
        });
    }

    /// Entries are distinct detections of their own gates, owners and objective say the same as the entries.
    fn check(cluster: &Cluster, swarm: &Swarm, bat: usize) {
        let mut owners = vec![NOBODY; swarm.places];
        for (row, &code) in swarm.entries_of(bat).iter().enumerate() {
            if code != cluster.missed() {
                assert!(
                    cluster.codes_of(row).contains(&code),
                    "row {row} has {code}"
                );
                let owner = &mut owners[cluster.code(code).detection as usize];
                assert_eq!(
                    std::mem::replace(owner, row as u32),
                    NOBODY,
                    "a detection twice"
                );
            }
        }
        assert_eq!(swarm.owners[bat * swarm.places..][..swarm.places], owners);
    }

    #[test]
    fn a_million_moves_leave_every_bat_valid_and_its_objective_the_sum() {
        let mut random = Seed { seed: 5, run: 0 }.stream(Purpose::Clutter, 0, 0);
        let mut moves = 0;
        for number in 0..50 {
            let settings = BatSettings {
                population: 4,
                weights: super::super::Answer::Visited,
                ..BatSettings::default()
            };
            let tracks = random.random_range(2..=7);
            random_problem(&mut random, tracks, 8, 0.5).for_each_cluster(|problem| {
                let (mut cluster, mut swarm, mut rng) =
                    (Cluster::default(), Swarm::default(), rng(number));
                cluster.load(problem, &settings);
                swarm.start(&cluster, &settings, None, &mut rng);
                for step in 0..25_000 {
                    let bat = step % 4;
                    let neighbour = swarm.neighbour(&cluster, bat, None, &mut rng);
                    swarm.take(&cluster, bat, neighbour);
                    check(&cluster, &swarm, bat);
                    moves += 1;
                }
                let sum = cluster.value_of(swarm.entries_of(0));
                assert!((sum - swarm.bats[0].value).abs() < 1e-9, "{sum}");
            });
        }
        assert!(moves >= 1_000_000, "{moves}");
    }
}
