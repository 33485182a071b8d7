//! Fuzzy c-means from a random start beside the genetic search, on any objects and on grey-level images drawn from a seed; the
//! examples use it, too.

use rand_distr::{Distribution, StandardNormal};
use trackloom_domain::math::fuzzy_c_means::genetic::{GeneticSettings, search};
use trackloom_domain::math::fuzzy_c_means::{
    FuzzyCMeans, FuzzyCMeansSettings, Objects, harden, start,
};
use trackloom_domain::math::rng::{Purpose, Seed};

/// Pixels on a side.
const SIDE: usize = 40;

/// Grey levels of 40 × 40 pixels in three classes of 60, 120 and 190 with noise of 20: a ground, and on it a disc of `disc` pixels'
/// radius and a square of `square` pixels' side.
pub fn image(seed: Seed, disc: f64, square: usize) -> Vec<f64> {
    let mut draw = seed.stream(Purpose::BearingTime, 0, 0);
    let mut pixels = Vec::with_capacity(SIDE * SIDE);
    for row in 0..SIDE {
        for column in 0..SIDE {
            let from_centre = (row as f64 - 15.0).hypot(column as f64 - 15.0);
            let is_square = SIDE - row <= square && SIDE - column <= square;
            let level = match (is_square, from_centre < disc) {
                (true, _) => 190.0,
                (false, true) => 120.0,
                (false, false) => 60.0,
            };
            let error: f64 = StandardNormal.sample(&mut draw);
            pixels.push((level + 20.0 * error).clamp(0.0, 255.0).round());
        }
    }
    pixels
}

/// What one method found.
#[derive(Debug, Clone, Copy)]
pub struct Found {
    /// Mean squared distance of the objects to the centres of their clusters, by largest membership.
    pub mean_squared_error: f64,
    /// J.
    pub cost: f64,
    /// How often all distances were computed.
    pub rounds: u64,
}

/// Fuzzy c-means from random objects; the genetic search, whose first individual that is; and the search without c-means, with as
/// many individuals as the other needed rounds, and ten times as many.
pub fn compare(objects: &Objects, clusters: usize, seed: Seed) -> [Found; 4] {
    let mut means = FuzzyCMeans::new(FuzzyCMeansSettings::default()).unwrap();
    let stream = || seed.stream(Purpose::Clustering, clusters as u64, 0);
    let mut initial = Vec::new();
    start::random(objects, clusters, &mut stream(), &mut initial).unwrap();
    let run = means.run(objects, &initial).unwrap();
    let plain = found(&means, run.cost, u64::from(run.iterations) + 1);
    let driven = GeneticSettings {
        population: 6,
        generations: 6,
        ..Default::default()
    };
    let outcome = search(&mut means, objects, clusters, driven, &mut stream()).unwrap();
    let rounds = outcome.iterations + outcome.runs;
    let genetic = found(&means, outcome.cost, rounds);
    let mut without = |rounds: u64| {
        let side = (rounds as f64).sqrt().round() as u32;
        let settings = GeneticSettings {
            population: side,
            generations: side,
            is_driven: false,
            ..Default::default()
        };
        let outcome = search(&mut means, objects, clusters, settings, &mut stream()).unwrap();
        found(&means, outcome.cost, outcome.iterations)
    };
    [plain, genetic, without(rounds), without(10 * rounds)]
}

fn found(means: &FuzzyCMeans, cost: f64, rounds: u64) -> Found {
    let mut labels = Vec::new();
    harden::largest(means.memberships(), means.clusters(), &mut labels);
    let squared = labels
        .iter()
        .enumerate()
        .map(|(object, label)| means.squared_distances()[object * means.clusters() + label]);
    Found {
        mean_squared_error: squared.sum::<f64>() / labels.len() as f64,
        cost,
        rounds,
    }
}
