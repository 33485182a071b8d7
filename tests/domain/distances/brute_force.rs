//! On a thousand random scenes OSPA and GOSPA are what trying every assignment gives.

use super::fixture::{Row, Scene, assert_close};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::json;
use trackloom_domain::evaluation::comparison::{ComparedStep, Comparison, Presence};
use trackloom_domain::evaluation::steps::{StepRule, StepSettings};

const NAMES: [&str; 4] = ["a", "b", "c", "d"];

/// Up to `heads` truths and tracks in a field of 20 m at each of `steps` steps; about one in five is absent. Both have one clock, so
/// that every time of either is a step.
pub fn random_scene(rng: &mut ChaCha8Rng, heads: usize, steps: usize) -> Scene {
    let (truths, tracks) = (rng.random_range(0..=heads), rng.random_range(0..=heads));
    let (truth, track) = (rows(rng, truths, steps), rows(rng, tracks, steps));
    let steps = StepSettings {
        rule: StepRule::Union,
        ..StepSettings::default()
    };
    Scene {
        steps,
        ..Scene::new(&truth, &track)
    }
}

fn rows(rng: &mut ChaCha8Rng, heads: usize, steps: usize) -> Vec<Row<'static>> {
    let mut rows = Vec::new();
    for name in &NAMES[..heads] {
        for step in 0..steps {
            let (x, y) = (rng.random_range(0.0..20.0), rng.random_range(0.0..20.0));
            if rng.random_bool(0.8) {
                rows.push((step as f64, *name, x, y, 0.0, 0.0));
            }
        }
    }
    rows
}

/// Positions of all truths and all tracks at a step, where they exist.
pub fn positions_at(comparison: &Comparison, step: &ComparedStep) -> (Positions, Positions) {
    let spread = |presences: &[Presence], count: usize| {
        let mut positions = vec![None; count];
        for presence in presences {
            positions[presence.id as usize] = Some((presence.position_m.x, presence.position_m.y));
        }
        positions
    };
    let truths = spread(
        &comparison.truths[step.truths.clone()],
        comparison.truth_ids.len(),
    );
    (
        truths,
        spread(
            &comparison.tracks[step.tracks.clone()],
            comparison.track_ids.len(),
        ),
    )
}

pub type Positions = Vec<Option<(f64, f64)>>;

pub fn distance((x, y): (f64, f64), (other_x, other_y): (f64, f64)) -> f64 {
    (x - other_x).hypot(y - other_y)
}

/// Every way to give each of `rows` rows one of `columns` columns or none, no column twice.
pub fn partial_assignments(rows: usize, columns: usize) -> Vec<Vec<Option<usize>>> {
    let mut all = vec![vec![]];
    for _ in 0..rows {
        let extend = |start: Vec<Option<usize>>| {
            let free = (0..columns)
                .filter(|column| !start.contains(&Some(*column)))
                .map(Some)
                .collect::<Vec<_>>();
            let with = |choice| start.iter().copied().chain([choice]).collect::<Vec<_>>();
            free.into_iter().chain([None]).map(with).collect::<Vec<_>>()
        };
        all = all.into_iter().flat_map(extend).collect();
    }
    all
}

fn ospa(truths: &[(f64, f64)], tracks: &[(f64, f64)], c: f64, p: f64) -> f64 {
    let (fewer, more) = if truths.len() <= tracks.len() {
        (truths, tracks)
    } else {
        (tracks, truths)
    };
    if more.is_empty() {
        return 0.0;
    }
    let full = partial_assignments(fewer.len(), more.len())
        .into_iter()
        .filter(|choices| choices.iter().all(Option::is_some));
    let cost = |choices: Vec<Option<usize>>| {
        let pairs = choices
            .iter()
            .enumerate()
            .map(|(row, column)| distance(fewer[row], more[column.unwrap()]).min(c).powf(p));
        pairs.sum::<f64>() + c.powf(p) * (more.len() - fewer.len()) as f64
    };
    (full.map(cost).fold(f64::INFINITY, f64::min) / more.len() as f64).powf(1.0 / p)
}

fn gospa(truths: &[(f64, f64)], tracks: &[(f64, f64)], c: f64, p: f64) -> f64 {
    let cost = |choices: Vec<Option<usize>>| {
        let pairs: Vec<f64> = choices
            .iter()
            .enumerate()
            .filter_map(|(row, column)| {
                Some(distance(truths[row], tracks[(*column)?]).min(c).powf(p))
            })
            .collect();
        let strangers = truths.len() + tracks.len() - 2 * pairs.len();
        pairs.iter().sum::<f64>() + c.powf(p) / 2.0 * strangers as f64
    };
    partial_assignments(truths.len(), tracks.len())
        .into_iter()
        .map(cost)
        .fold(f64::INFINITY, f64::min)
        .powf(1.0 / p)
}

#[test]
fn a_thousand_random_sets() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for case in 0..1000 {
        let scene = random_scene(&mut rng, 4, 1);
        let (c, p) = ([5.0, 10.0, 30.0][case % 3], [1.0, 2.0, 2.5, 4.0][case % 4]);
        let parameters = |name: &str| json!({"metric": name, "cutoff_m": c, "p": p});
        let of_targets = scene
            .truth
            .targets()
            .iter()
            .map(|target| (target.points[0].position.x, target.points[0].position.y));
        let of_tracks = scene.tracks.tracks.iter().map(|track| {
            (
                track.points[0].estimate.state().x,
                track.points[0].estimate.state().y,
            )
        });
        let (truths, tracks): (Vec<_>, Vec<_>) = (of_targets.collect(), of_tracks.collect());
        let (found_ospa, found_gospa) = (
            scene.evaluate(5.0, parameters("ospa")),
            scene.evaluate(5.0, parameters("gospa")),
        );
        if truths.is_empty() {
            assert_eq!(
                (found_ospa.value, found_ospa.reason),
                (None, Some("no target is due at any step"))
            );
            let found = found_gospa.quantity("false");
            assert_eq!(found, Some(tracks.len() as f64));
            continue;
        }
        assert_close(
            found_ospa.value,
            ospa(&truths, &tracks, c, p),
            &format!("OSPA of case {case}"),
        );
        assert_close(
            found_gospa.value,
            gospa(&truths, &tracks, c, p),
            &format!("GOSPA of case {case}"),
        );
    }
}
