//! The reduced programme against values of another solver.

use super::super::linear_programme;
use super::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Numbers that a few lines of any language make again.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, limit: u64) -> i64 {
        let Numbers(state) = self;
        *state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((*state >> 33) % limit) as i64
    }
}

/// Targets within 250 m over 30 steps, their tracks 30 m off, one in twenty points missing, and sometimes two tracks that change places.
fn close(seed: u64, count: usize) -> Cluster {
    let mut numbers = Numbers(seed);
    let truths: Vec<[i64; 4]> = (0..count)
        .map(|_| {
            let [x, y] = [numbers.below(250), numbers.below(250)];
            [x, y, numbers.below(7) - 3, numbers.below(7) - 3]
        })
        .collect();
    let mut followed: Vec<usize> = (0..count).collect();
    let mut steps = Vec::new();
    for step in 0..30 {
        if numbers.below(3) == 0 {
            let one = numbers.below(count as u64 - 1) as usize;
            followed.swap(one, one + 1);
        }
        let at = |truth: usize| {
            let [x, y, vx, vy] = truths[truth];
            [x + step * vx, y + step * vy]
        };
        let mut near = Vec::new();
        for (track, &of) in followed.iter().enumerate() {
            let [x, y] = at(of)
                .map(|axis| axis + numbers.below(61) + numbers.below(61) + numbers.below(61) - 90);
            if numbers.below(20) == 0 {
                continue;
            }
            for truth in 0..count {
                let [dx, dy] = [at(truth)[0] - x, at(truth)[1] - y];
                let gain = 1.0 - (dx * dx + dy * dy) as f64 / 3600.0;
                if gain > 0.0 {
                    near.push(Near {
                        truth,
                        track,
                        gain,
                        pair: 0,
                    });
                }
            }
        }
        near.sort_by_key(|pair| (pair.truth, pair.track));
        steps.push(near);
    }
    Cluster {
        truths: count,
        tracks: count,
        steps,
    }
}

/// Least costs of [`close`] with (20 / 60)² a switch, found by HiGHS 1.12 with fractions and where there are any with whole numbers.
const BY_HIGHS: [(u64, usize, f64, f64); 8] = [
    (4, 30, -542.223888889, -542.223888889),
    (8, 30, -531.203888889, -531.196666667),
    (10, 20, -334.256944444, -334.242500000),
    (11, 25, -432.379861111, -432.375277778),
    (12, 30, -548.358055556, -548.358055556),
    (16, 30, -511.733333333, -511.733333333),
    (19, 25, -449.197111111, -449.193888889),
    (20, 30, -531.438888889, -531.435000000),
];

#[test]
fn close_targets_cost_what_an_outside_solver_finds() {
    let penalty = 1.0 / 9.0;
    for (seed, count, with_fractions, whole) in BY_HIGHS {
        let cluster = close(seed, count);
        let bound = linear_programme::solve(&cluster, penalty, &Watch::never()).unwrap();
        let cost = bound.solution.tally.cost(penalty);
        let error = (cost - with_fractions) / with_fractions;
        assert!(
            error.abs() < 1e-7,
            "seed {seed}: {cost} is not {with_fractions}"
        );
        assert!(bound.least <= with_fractions + 1e-8 && cost >= with_fractions - 1e-8);
        match solve(&cluster, &bound, penalty, &Watch::never()) {
            Reduced::Exact(solution) => {
                let cost = solution.tally.cost(penalty);
                assert!(
                    (cost - whole).abs() < 1e-7,
                    "seed {seed}: {cost} is not {whole}"
                );
            }
            // The search needs more than the prices say where shares are fractions; the bounds are near each other all the same.
            Reduced::AtMost(most) => assert!(
                whole > with_fractions + 1e-4 && most >= whole - 1e-7 && most < whole + 0.4,
                "seed {seed}: {with_fractions} to {most}"
            ),
        }
    }
}

#[test]
fn small_clusters_cost_what_the_search_without_prices_finds() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut left_out = 0;
    for case in 0..300 {
        let (truths, tracks) = (rng.random_range(2..=3), rng.random_range(2..=4));
        let mut step = || -> Vec<Near> {
            let all = (0..truths * tracks).map(|pair| (pair / tracks, pair % tracks));
            let near: Vec<(usize, usize)> = all.filter(|_| rng.random_bool(0.7)).collect();
            near.into_iter()
                .map(|(truth, track)| Near {
                    truth,
                    track,
                    gain: rng.random_range(0.01..1.0),
                    pair: 0,
                })
                .collect()
        };
        let steps = (0..7).map(|_| step()).collect();
        let cluster = Cluster {
            truths,
            tracks,
            steps,
        };
        let penalty = [0.0, 0.1, 0.4, 1.5][case % 4];
        let expected = exact::solve(&cluster, penalty, &Watch::never()).unwrap();
        let expected = expected.tally.cost(penalty);
        let bound = linear_programme::solve(&cluster, penalty, &Watch::never()).unwrap();
        let Reduced::Exact(found) = solve(&cluster, &bound, penalty, &Watch::never()) else {
            panic!("case {case} is not exact");
        };
        let cost = found.tally.cost(penalty);
        assert!(
            (cost - expected).abs() < 1e-9,
            "case {case}: {cost} is not {expected}"
        );
        let (least, excesses) = excesses(&cluster, &bound.prices, penalty);
        assert!(least <= expected + 1e-9);
        let costly = |excess: &&f64| least + **excess > expected + 1e-9;
        left_out += excesses.iter().flatten().filter(costly).count();
    }
    assert!(left_out > 1000, "only {left_out} pairs are ruled out");
}
