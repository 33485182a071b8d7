//! T-GOSPA against the small scenes, and against trying every sequence of assignments.

use super::brute_force::{Positions, distance, partial_assignments, positions_at, random_scene};
use super::fixture::{Row, Scene, assert_close, checked, evaluate_all, reason};
use super::golden::T_GOSPA;
use super::scenes;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use trackloom_domain::evaluation::comparison::Comparison;

type Assignment = Vec<Option<usize>>;

fn spec(c: f64, p: f64, gamma: f64) -> Value {
    json!({"metric": "t_gospa", "cutoff_m": c, "p": p, "switch_penalty_m": gamma})
}

#[test]
fn the_small_scenes() {
    for &(name, c, p, gamma, value, per_step) in T_GOSPA {
        let scene = if name == "main" {
            scenes::main()
        } else {
            scenes::swap()
        };
        let report = scene.evaluate(10.0, spec(c, p, gamma));
        assert_close(report.value, value, name);
        assert_close(report.quantity("t_gospa_per_step"), per_step, name);
        assert_eq!(report.parameters["method"], "dynamic programming: exact");
    }
}

#[test]
fn the_parts_of_the_exchange_are_two_switches_and_the_offsets() {
    let report = scenes::swap().evaluate(10.0, spec(10.0, 2.0, 2.0));
    for (name, value) in [
        ("localisation", 13.75),
        ("missed", 0.0),
        ("false", 0.0),
        ("switching", 8.0),
        ("switches", 2.0),
    ] {
        assert_close(report.quantity(name), value, name);
    }
    let parts: f64 = ["localisation", "missed", "false", "switching"]
        .iter()
        .map(|name| report.quantity(name).unwrap())
        .sum();
    assert_close(report.value, parts.sqrt(), "the parts add up");
}

/// Cost (p-th power) of one assignment at the time with these positions.
fn cost_at((truths, tracks): &(Positions, Positions), choices: &Assignment, c: f64, p: f64) -> f64 {
    let half = c.powf(p) / 2.0;
    let mut cost = tracks.iter().flatten().count() as f64 * half;
    for (truth, choice) in truths.iter().zip(choices) {
        let track = choice.and_then(|track| tracks[track]);
        cost += match (truth, track) {
            (Some(truth), Some(track)) => distance(*truth, track).min(c).powf(p) - half,
            (Some(_), None) => half,
            (None, _) => 0.0,
        };
    }
    cost
}

fn switches(before: &Assignment, after: &Assignment) -> f64 {
    let of_truth = |(before, after): (&Option<usize>, &Option<usize>)| match (before, after) {
        (before, after) if before == after => 0.0,
        (Some(_), Some(_)) => 1.0,
        _ => 0.5,
    };
    before.iter().zip(after).map(of_truth).sum()
}

/// The least over all sequences of assignments, by going on from every assignment to every other.
fn by_every_sequence(comparison: &Comparison, c: f64, p: f64, gamma: f64) -> f64 {
    let assignments = partial_assignments(comparison.truth_ids.len(), comparison.track_ids.len());
    let mut best: Vec<f64> = vec![0.0; assignments.len()];
    for (index, step) in comparison.steps.iter().enumerate() {
        let positions = positions_at(comparison, step);
        let from_before = |after: &Assignment| {
            let reach = |(before, cost): (&Assignment, &f64)| {
                cost + gamma.powf(p) * switches(before, after)
            };
            assignments
                .iter()
                .zip(&best)
                .map(reach)
                .fold(f64::INFINITY, f64::min)
        };
        best = assignments
            .iter()
            .map(|after| {
                cost_at(&positions, after, c, p) + if index == 0 { 0.0 } else { from_before(after) }
            })
            .collect();
    }
    best.into_iter().fold(f64::INFINITY, f64::min).powf(1.0 / p)
}

#[test]
fn a_thousand_random_scenes() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut compared = 0;
    for case in 0.. {
        if compared == 1000 {
            break;
        }
        let (heads, steps) = ([2, 3, 3][case % 3], [3, 5, 8][case % 3]);
        let scene = random_scene(&mut rng, heads, steps);
        let (c, p, gamma) = (
            [6.0, 12.0, 25.0][case % 3],
            [1.0, 2.0, 3.0][case % 3 / 2 + case % 2],
            [0.0, 1.0, 4.0, 10.0, 40.0][case % 5],
        );
        let comparison = scene.compare(5.0, c);
        if comparison.steps.is_empty() {
            continue;
        }
        let report = scene.evaluate(5.0, spec(c, p, gamma));
        assert_eq!(report.parameters["method"], "dynamic programming: exact");
        let expected = by_every_sequence(&comparison, c, p, gamma);
        assert_close(
            report.value,
            expected,
            &format!("case {case}: c {c} p {p} gamma {gamma}"),
        );
        compared += 1;
    }
}

#[test]
fn without_a_penalty_it_is_the_sum_of_gospa() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    for _ in 0..50 {
        let scene = random_scene(&mut rng, 4, 6);
        let gospa = scene.evaluate(5.0, json!({"metric": "gospa", "cutoff_m": 12.0, "p": 1.0}));
        let Some(mean) = gospa.value else {
            continue;
        };
        let sum = mean * gospa.quantity("due_steps").unwrap();
        assert_close(scene.evaluate(5.0, spec(12.0, 1.0, 0.0)).value, sum, "sum");
    }
}

#[test]
fn what_is_too_entangled_is_bounded_from_below() {
    // Eight targets on one spot, eight tracks hopping about them: every pair is near at every step.
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let names = ["a", "b", "c", "d", "e", "f", "g", "h"];
    let mut rows = || -> Vec<Row> {
        use rand::RngExt;
        let mut row = |name, step| {
            (
                f64::from(step),
                name,
                rng.random_range(0.0..50.0),
                rng.random_range(0.0..50.0),
                0.0,
                0.0,
            )
        };
        names
            .iter()
            .flat_map(|name| (0..12).map(|step| (*name, step)))
            .map(|(name, step)| row(name, step))
            .collect()
    };
    let scene = Scene::new(&rows(), &rows());
    let report = scene.evaluate(10.0, spec(100.0, 1.0, 30.0));
    assert_eq!(report.quantity("clusters_exact"), Some(0.0));
    let method = report.parameters["method"].as_str().unwrap();
    assert!(
        method.starts_with("dynamic and linear programming"),
        "{method}"
    );
    // Better than never switching, not better than switching for nothing.
    let free = scene.evaluate(10.0, spec(100.0, 1.0, 0.0)).value.unwrap();
    let value = report.value.unwrap();
    assert!(free < value, "{free} {value}");
    let fixed = kept_together(&scene);
    assert!(value <= fixed + 1e-6, "{value} {fixed}");
}

/// The cost, c = 100 and p = 1, of keeping target n and track n together throughout.
fn kept_together(scene: &Scene) -> f64 {
    let pairs = scene.truth.targets().iter().zip(&scene.tracks.tracks);
    let cost = |(target, track): (
        &trackloom_domain::model::truth::Target,
        &trackloom_domain::model::track::Track,
    )| {
        let points = target.points.iter().zip(&track.points);
        points
            .map(|(truth, track)| {
                distance(
                    (truth.position.x, truth.position.y),
                    (track.estimate.state().x, track.estimate.state().y),
                )
                .min(100.0)
            })
            .sum::<f64>()
    };
    pairs.map(cost).sum()
}

#[test]
fn edges() {
    let one = [
        (0.0, "a", 0.0, 0.0, 0.0, 0.0),
        (1.0, "a", 0.0, 0.0, 0.0, 0.0),
    ];
    let alone = Scene::new(&one, &[]).evaluate(10.0, spec(10.0, 2.0, 1.0));
    assert_close(alone.value, 10.0, "two missed points at half of c² each");
    assert_close(alone.quantity("missed"), 100.0, "missed");
    let spare = Scene::new(&[], &one).evaluate(10.0, spec(10.0, 2.0, 1.0));
    assert_close(spare.quantity("false"), 100.0, "false");
    let none = Scene::new(&[], &[]).evaluate(10.0, spec(10.0, 2.0, 1.0));
    assert_eq!(
        (none.value, reason(&none, "t_gospa")),
        (None, "there is no step")
    );
    let at_cutoff = Scene::new(&one[..1], &[(0.0, "t", 10.0, 0.0, 0.0, 0.0)])
        .evaluate(20.0, spec(10.0, 2.0, 1.0));
    assert_eq!(
        [
            at_cutoff.quantity("missed_points"),
            at_cutoff.quantity("false_points")
        ],
        [Some(1.0), Some(1.0)]
    );
    let faults = checked(&spec(-1.0, 0.0, -2.0)).err().unwrap();
    assert_eq!(
        faults,
        [
            "/cutoff_m [0.001, 10000000] m",
            "/p [1, 10]",
            "/switch_penalty_m [0, 10000000] m"
        ]
    );
    let extreme = Scene::new(&one, &one).evaluate(10.0, spec(1e-3, 10.0, 1e7));
    assert_close(extreme.value, 0.0, "nothing is wrong");
}

#[test]
fn sequences_add_up_their_powers() {
    let report = evaluate_all(
        &[&scenes::main(), &scenes::swap()],
        10.0,
        spec(10.0, 2.0, 1.0),
    );
    assert_close(
        report.value,
        20.77257807784099f64.hypot(3.968626966596886),
        "root of the sum of squares",
    );
}
