//! Genetic fuzzy c-means: a population of centre sets, each driven to its local optimum by FCM before it is crossed and
//! mutated, and so is each child before it joins. It buys independence from the initial centres with many runs of FCM.
//!
//! # Reference
//! The last page of an article on genetic fuzzy c-means (GFCM) that follows J. Liang, Y. Liu, 2009, in its source. That
//! page names what is done and no operators: the operators below are ours.
//!
//! # Symbols
//! An individual is a local optimum of FCM: its centres V and its J, the less the fitter.
//!
//! # Method
//! 1. The population: FCM from different random objects as centres.
//! 2. A generation has as many children as there are individuals. Two parents are the fitter of two drawn at random, each.
//!    With the crossover rate their centres are paired at the least total distance ([`crate::math::assignment`]) and the
//!    child takes each centre from one or the other; else it is the first parent's copy. Pairing first matters: clusters
//!    have no names, and two good parents would otherwise give a child the same cluster twice.
//! 3. Each centre of a child becomes a random object with the mutation rate, and at least one does when the child would
//!    else be a copy. FCM drives the child to its optimum.
//! 4. Of parents and children together the fittest live on (elitism), each optimum once: J never rises.
//!
//! The cost is (generations + 1) · population runs of FCM; its iterations are counted. What FCM saves is seen by the same search
//! without it, a plain genetic algorithm over centres.

use super::{FuzzyCMeans, FuzzyError, Metric, Objects, start};
use crate::math::assignment::assign_dense;
use rand::{Rng, RngExt};

/// How the search goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GeneticSettings {
    /// Individuals.
    pub population: u32,
    pub generations: u32,
    /// Probability that a child has two parents.
    pub crossover_rate: f64,
    /// Probability that a centre of a child is replaced.
    pub mutation_rate: f64,
    /// Whether fuzzy c-means drives each individual to its local optimum; else J is that of the centres as they are, and this is
    /// a plain genetic algorithm.
    pub is_driven: bool,
}

impl Default for GeneticSettings {
    fn default() -> Self {
        GeneticSettings {
            population: 10,
            generations: 10,
            crossover_rate: 0.8,
            mutation_rate: 0.15,
            is_driven: true,
        }
    }
}

impl GeneticSettings {
    /// # Errors
    /// The first value out of its range.
    pub fn check(&self) -> Result<(), FuzzyError> {
        let refuse = |field, found, allowed| {
            Err(FuzzyError::Search {
                field,
                found,
                allowed,
            })
        };
        if self.population < 2 {
            return refuse("population", f64::from(self.population), ">= 2");
        }
        for (field, rate) in [
            ("crossover_rate", self.crossover_rate),
            ("mutation_rate", self.mutation_rate),
        ] {
            if !(0.0..=1.0).contains(&rate) {
                return refuse(field, rate, "[0, 1]");
            }
        }
        Ok(())
    }
}

/// What the search found and what it cost.
#[derive(Debug, Clone, PartialEq)]
pub struct GeneticOutcome {
    /// The least J.
    pub cost: f64,
    /// Individuals: runs of FCM.
    pub runs: u64,
    /// Iterations of all of them, each a round of all distances; of a plain search one for each individual.
    pub iterations: u64,
    /// The least J of the first population, then after each generation.
    pub trace: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq)]
struct Individual {
    centres: Vec<f64>,
    cost: f64,
}

/// Optima whose J differ by less than this, relative to J, are taken for one.
const SAME_OPTIMUM: f64 = 1e-6;

/// Searches for `clusters` centres; `means` holds the best run at the end.
///
/// # Errors
/// c outside 2 to n, or the first setting out of its range.
pub fn search(
    means: &mut FuzzyCMeans,
    objects: &Objects,
    clusters: usize,
    settings: GeneticSettings,
    stream: &mut impl Rng,
) -> Result<GeneticOutcome, FuzzyError> {
    settings.check()?;
    let mut search = CentreSearch {
        means,
        objects,
        settings,
        runs: 0,
        iterations: 0,
        population: Vec::new(),
    };
    search.populate(clusters, stream)?;
    let mut trace = vec![search.population[0].cost];
    for _ in 0..settings.generations {
        search.generation(stream)?;
        trace.push(search.population[0].cost);
    }
    // The best is run once more from its own centres, so that `means` holds it.
    let best = search.population.swap_remove(0);
    let outcome = search.drive(&best.centres)?;
    Ok(GeneticOutcome {
        cost: outcome.cost.min(best.cost),
        runs: search.runs,
        iterations: search.iterations,
        trace,
    })
}

struct CentreSearch<'a, 'o> {
    means: &'a mut FuzzyCMeans,
    objects: &'a Objects<'o>,
    settings: GeneticSettings,
    runs: u64,
    iterations: u64,
    /// The fittest first.
    population: Vec<Individual>,
}

impl CentreSearch<'_, '_> {
    /// Step 1.
    fn populate(&mut self, clusters: usize, stream: &mut impl Rng) -> Result<(), FuzzyError> {
        let mut centres = Vec::new();
        for _ in 0..self.settings.population {
            start::random(self.objects, clusters, stream, &mut centres)?;
            let individual = self.drive(&centres)?;
            self.population.push(individual);
        }
        self.select();
        Ok(())
    }

    /// The local optimum that FCM reaches, or the centres as they are.
    fn drive(&mut self, centres: &[f64]) -> Result<Individual, FuzzyError> {
        let (iterations, cost) = if self.settings.is_driven {
            let outcome = self.means.run(self.objects, centres)?;
            (outcome.iterations, outcome.cost)
        } else {
            (1, self.means.judge(self.objects, centres)?)
        };
        self.runs += 1;
        self.iterations += u64::from(iterations);
        Ok(Individual {
            centres: self.means.centres().to_vec(),
            cost,
        })
    }

    /// Steps 2 to 4.
    fn generation(&mut self, stream: &mut impl Rng) -> Result<(), FuzzyError> {
        let parents = self.population.len();
        for _ in 0..self.settings.population {
            let child = self.child(parents, stream);
            let individual = self.drive(&child)?;
            self.population.push(individual);
        }
        self.select();
        Ok(())
    }

    /// Step 4.
    fn select(&mut self) {
        self.population
            .sort_by(|left, right| left.cost.total_cmp(&right.cost));
        self.population
            .dedup_by(|later, kept| later.cost - kept.cost <= SAME_OPTIMUM * kept.cost);
        self.population.truncate(self.settings.population as usize);
    }

    fn child(&self, parents: usize, stream: &mut impl Rng) -> Vec<f64> {
        let (first, second) = (
            self.tournament(parents, stream),
            self.tournament(parents, stream),
        );
        let is_crossed = stream.random_bool(self.settings.crossover_rate) && first != second;
        let (first, second) = (
            &self.population[first].centres,
            &self.population[second].centres,
        );
        let mut child = first.clone();
        if is_crossed {
            self.cross(&mut child, second, stream);
        }
        let is_changed = self.mutate(&mut child, stream);
        if !is_crossed && !is_changed {
            let centre = stream.random_range(0..child.len() / self.objects.attributes());
            self.replace(&mut child, centre, stream);
        }
        child
    }

    /// The fitter of two; the population is sorted.
    fn tournament(&self, parents: usize, stream: &mut impl Rng) -> usize {
        stream
            .random_range(0..parents)
            .min(stream.random_range(0..parents))
    }

    fn cross(&self, child: &mut [f64], other: &[f64], stream: &mut impl Rng) {
        let attributes = self.objects.attributes();
        let clusters = child.len() / attributes;
        let pairs = child.chunks_exact(attributes).flat_map(|left| {
            other
                .chunks_exact(attributes)
                .map(move |right| (left, right))
        });
        let costs: Vec<f64> = pairs
            .map(|(left, right)| self.squared_distance(left, right))
            .collect();
        let Some(paired) = assign_dense(&costs, clusters) else {
            return;
        };
        for (centre, partner) in child.chunks_exact_mut(attributes).zip(&paired.column_of) {
            if let Some(partner) = partner.filter(|_| stream.random_bool(0.5)) {
                centre.copy_from_slice(&other[partner * attributes..][..attributes]);
            }
        }
    }

    /// Between centres, where only the order of the distances matters: by σ, or by the first object's covariance.
    fn squared_distance(&self, left: &[f64], right: &[f64]) -> f64 {
        match self.objects.metric() {
            Metric::Scaled(sigmas) => self.objects.scaled(left, right, sigmas),
            Metric::Mahalanobis(inverses) => self.objects.quadratic(left, right, inverses),
        }
    }

    fn mutate(&self, child: &mut [f64], stream: &mut impl Rng) -> bool {
        let mut is_changed = false;
        for centre in 0..child.len() / self.objects.attributes() {
            if stream.random_bool(self.settings.mutation_rate) {
                self.replace(child, centre, stream);
                is_changed = true;
            }
        }
        is_changed
    }

    fn replace(&self, child: &mut [f64], centre: usize, stream: &mut impl Rng) {
        let attributes = self.objects.attributes();
        let object = stream.random_range(0..self.objects.len());
        child[centre * attributes..][..attributes].copy_from_slice(self.objects.object(object));
    }
}
