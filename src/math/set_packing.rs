//! Weighted set packing: of sets that each have a weight those that share no element and weigh most together.
//!
//! # Method
//! 1. Sets that share elements, directly or through others, are a cluster.
//! 2. In a cluster the heaviest set that fits is taken again and again: a first packing.
//! 3. Branch and bound: elements in their order; of the sets whose first element one is, each that fits is tried, then none of them. A
//!    set of weight w with n elements gives each of them a share of w/n, so that what may still come is at most the sum over the free
//!    elements of the largest share that any set gives them.
//!
//! Where the elements of a cluster are too few for two of its sets, the heaviest is the best packing. Where one takes more than so many
//! steps, the best packing so far is kept.

use super::disjoint_sets;

/// Sets of elements, one after the other; memory is reused.
#[derive(Debug, Clone, Default)]
pub struct Sets {
    elements: Vec<u32>,
    /// Where each set ends.
    ends: Vec<u32>,
}

impl Sets {
    pub fn clear(&mut self) {
        self.elements.clear();
        self.ends.clear();
    }

    /// One more set: its elements in rising order, each once.
    pub fn push(&mut self, elements: impl IntoIterator<Item = u32>) {
        self.elements.extend(elements);
        self.ends.push(self.elements.len() as u32);
    }

    pub fn len(&self) -> usize {
        self.ends.len()
    }

    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    pub fn of(&self, set: u32) -> &[u32] {
        let at = set as usize;
        let from = at.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.elements[from as usize..self.ends[at] as usize]
    }
}

/// The chosen sets, in rising order.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Packing {
    pub chosen: Vec<u32>,
    /// Whether no other weighs more.
    pub is_exact: bool,
}

/// Only sets of positive weight are chosen; weights are finite. `max_steps` bounds the sets that are tried in a cluster.
pub fn pack(sets: &Sets, weights: &[f64], max_steps: usize) -> Packing {
    let usable = |&set: &u32| weights[set as usize] > 0.0 && !sets.of(set).is_empty();
    let usable: Vec<u32> = (0..sets.len() as u32).filter(usable).collect();
    let mut packing = Packing {
        chosen: Vec::new(),
        is_exact: true,
    };
    let clusters = Clusters::new(sets, &usable);
    let mut from = 0;
    for (&end, &elements) in clusters.ends.iter().zip(&clusters.elements) {
        let cluster = &clusters.sets[from as usize..end as usize];
        from = end;
        let least = cluster.iter().map(|&set| sets.of(set).len()).min();
        // No two of them fit.
        if (elements as usize) < 2 * least.unwrap_or(0) {
            packing.chosen.extend(heaviest(cluster, weights));
            continue;
        }
        let mut search = Search::new(sets, weights, cluster, max_steps);
        search.take_heaviest();
        search.run(0, 0.0);
        packing.is_exact &= search.steps_left > 0;
        packing
            .chosen
            .extend(search.best.iter().map(|&index| cluster[index]));
    }
    packing.chosen.sort_unstable();
    packing
}

/// The first of the heaviest.
fn heaviest(cluster: &[u32], weights: &[f64]) -> Option<u32> {
    let heavier = |best: u32, other: u32| {
        let is_heavier = weights[other as usize] > weights[best as usize];
        if is_heavier { other } else { best }
    };
    cluster.iter().copied().reduce(heavier)
}

/// Step 1: clusters in the order of their first sets.
struct Clusters {
    /// Those of each, one after the other.
    sets: Vec<u32>,
    /// Where each ends.
    ends: Vec<u32>,
    /// How many elements the sets of each have together.
    elements: Vec<u32>,
}

impl Clusters {
    fn new(sets: &Sets, usable: &[u32]) -> Self {
        let elements = sets.elements.iter().max();
        let elements = elements.map_or(0, |&most| most as usize + 1);
        let mut parents = Vec::new();
        disjoint_sets::reset(&mut parents, elements);
        for &set in usable {
            for pair in sets.of(set).windows(2) {
                disjoint_sets::join(&mut parents, pair[0], pair[1]);
            }
        }
        let mut clusters = Clusters {
            sets: vec![0; usable.len()],
            ends: Vec::new(),
            elements: Vec::new(),
        };
        let mut of_root = vec![u32::MAX; elements];
        let mut is_counted = vec![false; elements];
        let mut of_set = Vec::with_capacity(usable.len());
        for &set in usable {
            let place = &mut of_root[disjoint_sets::root(&mut parents, sets.of(set)[0]) as usize];
            if *place == u32::MAX {
                *place = clusters.ends.len() as u32;
                clusters.ends.push(0);
                clusters.elements.push(0);
            }
            clusters.ends[*place as usize] += 1;
            for &element in sets.of(set) {
                let is_known = std::mem::replace(&mut is_counted[element as usize], true);
                clusters.elements[*place as usize] += u32::from(!is_known);
            }
            of_set.push(*place);
        }
        clusters.sort(usable, &of_set);
        clusters
    }

    /// Counting sort of the sets by cluster, whose sizes are in `ends`.
    fn sort(&mut self, usable: &[u32], of_set: &[u32]) {
        let mut total = 0;
        for end in &mut self.ends {
            total += *end;
            *end = total - *end;
        }
        for (&set, &cluster) in usable.iter().zip(of_set) {
            let place = &mut self.ends[cluster as usize];
            self.sets[*place as usize] = set;
            *place += 1;
        }
    }
}

/// Steps 2 and 3 in one cluster, whose sets and elements have numbers of their own.
struct Search {
    /// Elements of each set, and its weight.
    sets: Vec<(Vec<usize>, f64)>,
    /// The sets whose first element each is, the heaviest first.
    first_at: Vec<Vec<usize>>,
    /// The largest share of each element.
    shares: Vec<f64>,
    is_used: Vec<bool>,
    chosen: Vec<usize>,
    best: Vec<usize>,
    best_weight: f64,
    steps_left: usize,
}

impl Search {
    fn new(sets: &Sets, weights: &[f64], cluster: &[u32], max_steps: usize) -> Self {
        let mut elements: Vec<u32> = Vec::new();
        for &set in cluster {
            elements.extend(sets.of(set));
        }
        elements.sort_unstable();
        elements.dedup();
        let own = |&set: &u32| {
            let numbers = sets.of(set).iter();
            let numbers = numbers.map(|element| elements.partition_point(|other| other < element));
            (numbers.collect(), weights[set as usize])
        };
        let sets: Vec<(Vec<usize>, f64)> = cluster.iter().map(own).collect();
        let mut first_at = vec![Vec::new(); elements.len()];
        let mut shares = vec![0.0f64; elements.len()];
        for (index, (numbers, weight)) in sets.iter().enumerate() {
            first_at[numbers[0]].push(index);
            for &number in numbers {
                shares[number] = shares[number].max(weight / numbers.len() as f64);
            }
        }
        for starting in &mut first_at {
            starting.sort_by(|&a, &b| sets[b].1.total_cmp(&sets[a].1));
        }
        Search {
            is_used: vec![false; elements.len()],
            sets,
            first_at,
            shares,
            chosen: Vec::new(),
            best: Vec::new(),
            best_weight: 0.0,
            steps_left: max_steps.max(1),
        }
    }

    /// Step 2.
    fn take_heaviest(&mut self) {
        let mut order: Vec<usize> = (0..self.sets.len()).collect();
        order.sort_by(|&a, &b| self.sets[b].1.total_cmp(&self.sets[a].1));
        for index in order {
            if self.fits(index) {
                self.mark(index, true);
                self.best.push(index);
                self.best_weight += self.sets[index].1;
            }
        }
        self.is_used.fill(false);
    }

    /// Step 3 from an element on, with the weight of what is chosen.
    fn run(&mut self, from: usize, weight: f64) {
        if weight > self.best_weight {
            self.best_weight = weight;
            self.best.clone_from(&self.chosen);
        }
        let free = |at: &usize| !self.is_used[*at];
        let shares = (from..self.shares.len())
            .filter(free)
            .map(|at| self.shares[at]);
        let mut bound: f64 = weight + shares.sum::<f64>();
        for at in from..self.first_at.len() {
            if self.is_used[at] {
                continue;
            }
            for place in 0..self.first_at[at].len() {
                // Rounding of the sum must not cut off the best.
                if self.steps_left == 0 || bound <= self.best_weight * (1.0 - 1e-12) {
                    return;
                }
                self.steps_left -= 1;
                let index = self.first_at[at][place];
                if self.fits(index) {
                    self.mark(index, true);
                    self.chosen.push(index);
                    self.run(at + 1, weight + self.sets[index].1);
                    self.chosen.pop();
                    self.mark(index, false);
                }
            }
            bound -= self.shares[at];
        }
    }

    fn fits(&self, index: usize) -> bool {
        self.sets[index]
            .0
            .iter()
            .all(|&number| !self.is_used[number])
    }

    fn mark(&mut self, index: usize, is_used: bool) {
        for &number in &self.sets[index].0 {
            self.is_used[number] = is_used;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::{Purpose, Seed};
    use rand::RngExt;

    fn flat(sets: &[Vec<u32>]) -> Sets {
        let mut flat = Sets::default();
        for set in sets {
            flat.push(set.iter().copied());
        }
        flat
    }

    /// The weight of the best packing, by trying all.
    fn by_force(sets: &[Vec<u32>], weights: &[f64]) -> f64 {
        let mut best = 0.0f64;
        for choice in 0u32..1 << sets.len() {
            let mut used = 0u32;
            let mut weight = Some(0.0);
            for (index, set) in sets.iter().enumerate() {
                if choice >> index & 1 == 1 {
                    let mask = set.iter().fold(0, |mask, element| mask | 1 << element);
                    weight = weight
                        .filter(|_| used & mask == 0)
                        .map(|sum| sum + weights[index]);
                    used |= mask;
                }
            }
            best = best.max(weight.unwrap_or(0.0));
        }
        best
    }

    #[test]
    fn small_problems_are_solved_as_by_trying_all() {
        let mut draw = Seed { seed: 7, run: 0 }.stream(Purpose::Detection, 0, 0);
        let mut greedy_fails = 0;
        for _ in 0..10_000 {
            let sets: Vec<Vec<u32>> = (0..draw.random_range(1..11))
                .map(|_| (0..12).filter(|_| draw.random::<f64>() < 0.25).collect())
                .collect();
            let weights: Vec<f64> = sets
                .iter()
                .map(|_| 10.0 * draw.random::<f64>() - 2.0)
                .collect();
            let packing = pack(&flat(&sets), &weights, 1_000_000);
            assert!(packing.is_exact);
            let mut used = [false; 12];
            let mut weight = 0.0;
            for &set in &packing.chosen {
                weight += weights[set as usize];
                for &element in &sets[set as usize] {
                    assert!(!std::mem::replace(&mut used[element as usize], true));
                }
            }
            let usable = |index: &usize| !sets[*index].is_empty();
            let kept: Vec<usize> = (0..sets.len()).filter(usable).collect();
            let kept_sets: Vec<Vec<u32>> = kept.iter().map(|&index| sets[index].clone()).collect();
            let kept_weights: Vec<f64> = kept.iter().map(|&index| weights[index]).collect();
            let best = by_force(&kept_sets, &kept_weights);
            assert!(
                (weight - best).abs() < 1e-9,
                "{weight} {best} {sets:?} {weights:?}"
            );
            let all: Vec<u32> = (0..kept.len() as u32)
                .filter(|&set| kept_weights[set as usize] > 0.0)
                .collect();
            let kept_sets = flat(&kept_sets);
            let mut search = Search::new(&kept_sets, &kept_weights, &all, 1);
            search.take_heaviest();
            let greedy = search.best_weight;
            greedy_fails += u32::from(greedy < best - 1e-9);
        }
        assert!(
            greedy_fails > 300,
            "{greedy_fails}: the problems are too easy"
        );
    }

    #[test]
    fn without_steps_the_heaviest_are_taken_and_told() {
        let sets = vec![vec![0, 1], vec![0], vec![1]];
        let packing = pack(&flat(&sets), &[3.0, 2.0, 2.0], 1);
        assert_eq!((packing.chosen, packing.is_exact), (vec![0], false));
        let packing = pack(&flat(&sets), &[3.0, 2.0, 2.0], 100);
        assert_eq!((packing.chosen, packing.is_exact), (vec![1, 2], true));
    }

    #[test]
    fn many_clusters_that_do_not_touch_take_as_long_as_each() {
        let sets: Vec<Vec<u32>> = (0..30_000)
            .map(|index| vec![index, index + 1 - index % 2])
            .map(|mut set: Vec<u32>| {
                set.dedup();
                set
            })
            .collect();
        let weights: Vec<f64> = (0..30_000)
            .map(|index| 1.0 + f64::from(index % 7))
            .collect();
        let packing = pack(&flat(&sets), &weights, 1000);
        assert!(packing.is_exact && packing.chosen.len() >= 15_000);
    }
}
