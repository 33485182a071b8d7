//! The generations: selection, offspring, the end. What an individual is, its coding knows.
//!
//! # Method
//! Individuals stand in the order of their costs. Selection by rank: of two drawn at random the better one, so that the
//! chance of rank r of n (the best is 0) falls linearly, (2(n − r) − 1) / n².
//! 1. The next generation takes over what the generation gap leaves of the present one: the elite, then others by rank.
//! 2. Pairs by rank beget the rest, by crossover at its rate, else as copies; each child mutates at its rate.
//! 3. It ends after the given generations or evaluations, or when the best cost has changed by no more than ε in each of G′ generations, or
//!    when the best cost is one that nothing undercuts.

use super::GeneticCorrelatorSettings;
use crate::correlation::cluster::LEAST_GAIN;
use crate::model::watch::Watch;
use rand::RngExt;
use rand::rngs::Xoshiro256PlusPlus;

/// What an individual is, and what is done to it.
pub(super) trait Coding {
    type Individual: Clone;

    fn create(&mut self, number: usize, rng: &mut Xoshiro256PlusPlus) -> Self::Individual;

    /// Both become children.
    fn cross(
        &mut self,
        left: &mut Self::Individual,
        right: &mut Self::Individual,
        rng: &mut Xoshiro256PlusPlus,
    );

    fn mutate(&mut self, individual: &mut Self::Individual, rng: &mut Xoshiro256PlusPlus);

    /// J; a coding may improve the individual first.
    fn cost(&mut self, individual: &mut Self::Individual) -> f64;

    /// Solutions whose cost was computed so far.
    fn evaluations(&self) -> u64;
}

/// What came of it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Evolution<Individual> {
    pub(super) best: Individual,
    /// Best and mean cost of each generation, the first included.
    pub(super) best_costs: Vec<f64>,
    pub(super) mean_costs: Vec<f64>,
    pub(super) stop: &'static str,
}

impl<Individual> Evolution<Individual> {
    /// With another search behind it: the better of both, and the costs of the generations one after the other.
    pub(super) fn then(mut self, other: Self) -> Self {
        let cost = self.best_costs[self.best_costs.len() - 1];
        let of_other = other.best_costs[other.best_costs.len() - 1];
        self.best_costs
            .extend(other.best_costs.iter().map(|found| found.min(cost)));
        self.mean_costs.extend(other.mean_costs);
        let best = if of_other < cost {
            other.best
        } else {
            self.best
        };
        Evolution {
            best,
            stop: other.stop,
            ..self
        }
    }
}

struct Member<Individual> {
    individual: Individual,
    cost: f64,
}

/// Evolves; no individual can cost less than `least_cost`.
pub(super) fn evolve<C: Coding>(
    coding: &mut C,
    settings: &GeneticCorrelatorSettings,
    least_cost: f64,
    rng: &mut Xoshiro256PlusPlus,
    watch: &Watch,
) -> Evolution<C::Individual> {
    let mut members: Vec<Member<C::Individual>> = Vec::new();
    let is_spent = |coding: &C| coding.evaluations() >= settings.max_evaluations;
    while members.len() < settings.population
        && !is_least(&members, least_cost)
        && (members.len() < 2 || !is_spent(coding))
    {
        let individual = coding.create(members.len(), rng);
        members.push(measure(coding, individual));
    }
    sort(&mut members);
    let (mut best_costs, mut mean_costs) = (vec![members[0].cost], vec![mean(&members)]);
    let (mut unchanged, mut evaluated) = (0, 0);
    let stop = loop {
        if is_least(&members, least_cost) {
            break "optimal";
        } else if unchanged >= settings.stop_after {
            break "unchanged";
        } else if best_costs.len() > settings.generations {
            break "generations";
        } else if is_spent(coding) || watch.stops_after(64 * (coding.evaluations() - evaluated)) {
            break "evaluations";
        }
        evaluated = coding.evaluations();
        members = next_generation(coding, settings, members, rng);
        let change = best_costs[best_costs.len() - 1] - members[0].cost;
        unchanged = if change <= settings.epsilon {
            unchanged + 1
        } else {
            0
        };
        best_costs.push(members[0].cost);
        mean_costs.push(mean(&members));
    };
    Evolution {
        best: members.swap_remove(0).individual,
        best_costs,
        mean_costs,
        stop,
    }
}

fn next_generation<C: Coding>(
    coding: &mut C,
    settings: &GeneticCorrelatorSettings,
    members: Vec<Member<C::Individual>>,
    rng: &mut Xoshiro256PlusPlus,
) -> Vec<Member<C::Individual>> {
    let population = members.len();
    let elite = settings.elite.min(population);
    let kept = (((1.0 - settings.generation_gap) * population as f64).round() as usize).max(elite);
    let mut next: Vec<Member<C::Individual>> = Vec::with_capacity(population + 1);
    for place in 0..kept {
        let Member { individual, cost } = &members[if place < elite {
            place
        } else {
            draw_rank(population, rng)
        }];
        next.push(Member {
            individual: individual.clone(),
            cost: *cost,
        });
    }
    while next.len() < population {
        let mut children = [(); 2].map(|()| members[draw_rank(population, rng)].individual.clone());
        let [left, right] = &mut children;
        if rng.random_bool(settings.crossover_rate) {
            coding.cross(left, right, rng);
        }
        for mut child in children.into_iter().take(population - next.len()) {
            if rng.random_bool(settings.mutation_rate) {
                coding.mutate(&mut child, rng);
            }
            next.push(measure(coding, child));
        }
    }
    sort(&mut next);
    next
}

fn measure<C: Coding>(coding: &mut C, mut individual: C::Individual) -> Member<C::Individual> {
    let cost = coding.cost(&mut individual);
    Member { individual, cost }
}

fn is_least<Individual>(members: &[Member<Individual>], least_cost: f64) -> bool {
    members
        .iter()
        .any(|member| member.cost <= least_cost + LEAST_GAIN)
}

fn sort<Individual>(members: &mut [Member<Individual>]) {
    members.sort_by(|left, right| left.cost.total_cmp(&right.cost));
}

fn mean<Individual>(members: &[Member<Individual>]) -> f64 {
    members.iter().map(|member| member.cost).sum::<f64>() / members.len() as f64
}

/// A place among so many, by rank.
fn draw_rank(population: usize, rng: &mut Xoshiro256PlusPlus) -> usize {
    rng.random_range(0..population)
        .min(rng.random_range(0..population))
}
