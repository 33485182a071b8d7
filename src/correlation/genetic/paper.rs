//! The paper's coding: a chromosome has for each sensor but the first a permutation of its tracks, which stand against the
//! tracks of the first sensor in their fixed order. A row of the chromosome is one position of all of them.
//!
//! # Method
//! - Padding: there are as many rows as tracks in all. A permutation has more values than its sensor has tracks; those
//!   beyond are "absent", and so is the first sensor beyond its own tracks. Each track can have a row for itself, so
//!   every partition into tuples has a chromosome.
//! - A row is one tuple as long as its links pay, else several ([`crate::correlation::admissible`]).
//! - With a [`CompleteProblem`], the paper's own, there are as many rows as targets, nothing is absent, a row is one tuple whatever
//!   it costs, and the fitness is Σ b.
//! - Fitness: J of the tuples so made. Crossover: PMX, a cut for each permutation. Mutation: in one permutation, drawn at
//!   random, two positions change their values.

use super::complete::CompleteProblem;
use super::evolve::Coding;
use super::permutation::Crossover;
use crate::correlation::admissible::divide;
use crate::correlation::problem::CorrelationProblem;
use rand::RngExt;
use rand::rngs::Xoshiro256PlusPlus;
use rand::seq::SliceRandom;
use std::ops::Range;

pub(super) struct Chromosomes<'a> {
    problem: &'a CorrelationProblem,
    complete: Option<&'a CompleteProblem>,
    rows: usize,
    crossover: Crossover,
    row: Vec<u32>,
    /// Chromosomes whose cost was computed.
    evaluations: u64,
}

impl<'a> Chromosomes<'a> {
    pub(super) fn new(
        problem: &'a CorrelationProblem,
        complete: Option<&'a CompleteProblem>,
    ) -> Self {
        Chromosomes {
            problem,
            complete,
            rows: complete.map_or(problem.tracks(), |complete| complete.targets),
            crossover: Crossover::default(),
            row: Vec::new(),
            evaluations: 0,
        }
    }

    pub(super) fn tuples(&mut self, chromosome: &[u32]) -> Vec<Vec<u32>> {
        let mut tuples = Vec::new();
        if self.complete.is_some() {
            for number in 0..self.rows {
                self.read_row(chromosome, number);
                tuples.push(self.row.clone());
            }
        } else {
            self.divide_rows(chromosome, |tuple, _| tuples.push(tuple.to_vec()));
        }
        tuples
    }

    /// Shows every tuple with its cost.
    fn divide_rows(&mut self, chromosome: &[u32], mut show: impl FnMut(&[u32], f64)) {
        for number in 0..self.rows {
            self.read_row(chromosome, number);
            divide(self.problem, &self.row, &mut show);
        }
    }

    /// The tracks that stand at a position.
    fn read_row(&mut self, chromosome: &[u32], number: usize) {
        self.row.clear();
        let first = self.problem.of_sensor(0);
        self.row
            .extend((number < first.len()).then_some(number as u32));
        for (permutation, sensor) in chromosome.chunks_exact(self.rows).zip(1..) {
            let tracks = self.problem.of_sensor(sensor);
            let value = permutation[number];
            self.row
                .extend(((value as usize) < tracks.len()).then_some(tracks.start + value));
        }
    }

    fn permutation_of(&self, number: usize) -> Range<usize> {
        number * self.rows..(number + 1) * self.rows
    }
}

impl Coding for Chromosomes<'_> {
    type Individual = Vec<u32>;

    fn create(&mut self, _: usize, rng: &mut Xoshiro256PlusPlus) -> Vec<u32> {
        let permutations = self.problem.sensors().saturating_sub(1);
        let mut chromosome: Vec<u32> = (0..permutations)
            .flat_map(|_| 0..self.rows as u32)
            .collect();
        chromosome
            .chunks_exact_mut(self.rows.max(1))
            .for_each(|permutation| permutation.shuffle(rng));
        chromosome
    }

    fn cross(&mut self, left: &mut Vec<u32>, right: &mut Vec<u32>, rng: &mut Xoshiro256PlusPlus) {
        for number in 0..left.len() / self.rows {
            let (one, other) = (
                rng.random_range(0..=self.rows),
                rng.random_range(0..=self.rows),
            );
            let range = self.permutation_of(number);
            self.crossover.cross(
                &mut left[range.clone()],
                &mut right[range],
                one.min(other)..one.max(other),
            );
        }
    }

    fn mutate(&mut self, chromosome: &mut Vec<u32>, rng: &mut Xoshiro256PlusPlus) {
        if chromosome.is_empty() {
            return;
        }
        let range = self.permutation_of(rng.random_range(0..chromosome.len() / self.rows));
        let permutation = &mut chromosome[range];
        permutation.swap(
            rng.random_range(0..self.rows),
            rng.random_range(0..self.rows),
        );
    }

    fn cost(&mut self, chromosome: &mut Vec<u32>) -> f64 {
        self.evaluations += 1;
        if let Some(complete) = self.complete {
            return complete.cost(chromosome);
        }
        let mut sum = 0.0;
        self.divide_rows(chromosome, |_, cost| sum += cost);
        sum
    }

    fn evaluations(&self) -> u64 {
        self.evaluations
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correlation::problem::Costs;
    use rand::SeedableRng;

    fn decode(problem: &CorrelationProblem, chromosome: &[u32]) -> (Vec<Vec<u32>>, f64) {
        let mut coding = Chromosomes::new(problem, None);
        (
            coding.tuples(chromosome),
            coding.cost(&mut chromosome.to_vec()),
        )
    }

    #[test]
    fn rows_are_cut_where_links_do_not_pay() {
        // Sensors {0, 1}, {2}, {3}: four rows. Values 1 to 3 of the second and third sensor are "absent".
        let pairs = [(0, 2, -3.0), (2, 3, 1.0), (0, 3, -2.0), (1, 3, -1.0)];
        let chain = CorrelationProblem::new(&[2, 1, 1], &pairs, Costs::Chain);
        let in_one_row = [0, 1, 2, 3, 0, 2, 1, 3];
        assert_eq!(
            decode(&chain, &in_one_row),
            (vec![vec![0, 2], vec![3], vec![1]], -3.0)
        );
        // Two absent between 0 and 3 are skipped; 2 stands behind the rows of the first sensor.
        assert_eq!(
            decode(&chain, &[1, 2, 0, 3, 0, 2, 1, 3]),
            (vec![vec![0, 3], vec![1], vec![2]], -2.0)
        );
        // All pairs: 3 lowers the cost of (0, 2) by 1.
        let all = CorrelationProblem::new(&[2, 1, 1], &pairs, Costs::AllPairs);
        assert_eq!(
            decode(&all, &in_one_row),
            (vec![vec![0, 2, 3], vec![1]], -4.0)
        );
    }

    #[test]
    fn the_fitness_is_the_sum_over_the_tuples() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(9);
        let counts = [4, 3, 5];
        let sensor_of = |track: u32| [4, 7, 12].iter().position(|&end| track < end);
        for number in 0..200 {
            let all = (0..12)
                .flat_map(|a| (a + 1..12).map(move |b| (a, b)))
                .filter(|&(a, b)| sensor_of(a) != sensor_of(b));
            let pairs: Vec<(u32, u32, f64)> = all
                .filter(|_| rng.random_bool(0.6))
                .map(|(a, b)| (a, b, f64::from(a * 7 + b * 5) % 11.0 - 7.0))
                .collect();
            let costs = if number % 2 == 0 {
                Costs::Chain
            } else {
                Costs::AllPairs
            };
            let problem = CorrelationProblem::new(&counts, &pairs, costs);
            let mut coding = Chromosomes::new(&problem, None);
            let mut chromosome = coding.create(0, &mut rng);
            coding.mutate(&mut chromosome, &mut rng);
            let tuples = coding.tuples(&chromosome);
            let sum: f64 = tuples
                .iter()
                .map(|tuple| {
                    problem
                        .cost(tuple)
                        .expect("a row is made of tuples that exist")
                })
                .sum();
            assert!((coding.cost(&mut chromosome) - sum).abs() < 1e-9);
            assert_eq!(tuples.iter().map(Vec::len).sum::<usize>(), 12);
        }
    }
}
