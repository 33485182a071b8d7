//! Labelled OSPA and OSPA⁽²⁾, which ask who is who over time: by hand, and by trying everything.

use super::brute_force::{Positions, distance, partial_assignments, positions_at, random_scene};
use super::fixture::{Scene, assert_close};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde_json::json;

/// Two targets 40 m apart for four steps; at the last two their tracks are exchanged.
fn exchanged() -> Scene {
    let truth: String = (0..4)
        .map(|t| format!("{t} A 0 0 0 0\n{t} B 40 0 0 0\n"))
        .collect();
    let tracks: String = (0..4)
        .map(|t| {
            let (one, two) = if t < 2 { (0, 40) } else { (40, 0) };
            format!("{t} 1 {one} 3 0 0\n{t} 2 {two} 4 0 0\n")
        })
        .collect();
    Scene::read(&truth, &tracks)
}

#[test]
fn an_exchange_costs_nothing_in_ospa_and_something_in_those_that_know_who_is_who() {
    let scene = exchanged();
    let found = |metric: &str, more: serde_json::Value| {
        let mut spec = json!({"metric": metric, "cutoff_m": 10.0, "p": 2.0});
        spec.as_object_mut()
            .unwrap()
            .extend(more.as_object().unwrap().clone());
        scene.evaluate(10.0, spec)
    };
    let ospa = found("ospa", json!({}));
    assert_close(ospa.value, (12.5f64).sqrt(), "OSPA");
    // A has track 1 and B has track 2, as these were first; a tie goes by the sum of shares, which are equal here. Either way
    // two of four steps cost 5² twice.
    let labelled = found("labelled_ospa", json!({"label_share": 0.5}));
    let mean = 0.5 * (12.5f64).sqrt() + 0.5 * (12.5f64 + 25.0).sqrt();
    assert_close(labelled.value, mean, "labelled OSPA");
    assert_close(labelled.quantity("labelling"), 0.5 * 5.0, "its labels");
    assert_close(
        labelled.quantity("localisation"),
        (12.5f64).sqrt(),
        "its distances",
    );
    // Over all: A with 1 is 3 m for two steps and at the cutoff for two, (9 + 9 + 100 + 100) / 4 = 54.5; B with 2, at 4 m, 58.
    let ospa2 = found("ospa2", json!({"q": 2.0, "window_steps": 2}));
    assert_close(
        ospa2.quantity("ospa2_whole"),
        ((54.5f64 + 58.0) / 2.0).sqrt(),
        "one window",
    );
    // Windows of two steps: the first and the second are 3 and 4 m, so is the fourth; the third has one step of each.
    let near = (12.5f64).sqrt();
    let third = ((0.5 * (9.0 + 100.0) + 0.5 * (16.0 + 100.0)) / 2.0f64).sqrt();
    assert_close(ospa2.value, (3.0 * near + third) / 4.0, "windows of two");
    let values = &ospa2.series[0].values;
    assert_close(values[2], third, "the third window");
}

/// Labels by trying every assignment of truths to tracks: the largest gain, summed in order of time.
fn labels_by_trial(
    steps: &[(Positions, Positions)],
    c: f64,
    p: f64,
) -> (f64, Vec<Vec<Option<usize>>>) {
    let (truths, tracks) = (steps[0].0.len(), steps[0].1.len());
    let gain_of = |choice: &[Option<usize>]| {
        let mut gain = 0.0;
        for (of_truths, of_tracks) in steps {
            for (truth, track) in choice.iter().enumerate() {
                let track = track.and_then(|track| of_tracks[track]);
                if let (Some(here), Some(there)) = (of_truths[truth], track) {
                    gain += 1.0 - (distance(here, there).min(c) / c).powf(p);
                }
            }
        }
        gain
    };
    let all = partial_assignments(truths, tracks);
    let best = all.iter().map(|choice| gain_of(choice)).fold(0.0, f64::max);
    let are_best = all
        .into_iter()
        .filter(|choice| gain_of(choice) > best - 1e-9)
        .collect();
    (best, are_best)
}

fn present(positions: &Positions) -> Vec<(usize, (f64, f64))> {
    let numbered = positions.iter().enumerate();
    numbered
        .filter_map(|(id, place)| Some((id, (*place)?)))
        .collect()
}

/// OSPA of one step where a label costs, by trying every assignment.
fn labelled_by_trial(
    (truths, tracks): &(Positions, Positions),
    labels: &[Option<usize>],
    (c, p, label_share): (f64, f64, f64),
) -> f64 {
    let (truths, tracks) = (present(truths), present(tracks));
    let more = truths.len().max(tracks.len());
    if more == 0 {
        return 0.0;
    }
    let cost = |choice: &Vec<Option<usize>>| {
        let mut sum = c.powf(p) * more as f64;
        for (row, column) in choice.iter().enumerate() {
            if let Some(column) = column {
                let ((truth, here), (track, there)) = (truths[row], tracks[*column]);
                let is_its = labels[truth] == Some(track);
                let label = if is_its {
                    0.0
                } else {
                    (label_share * c).powf(p)
                };
                let pair = (distance(here, there).powf(p) + label).min(c.powf(p));
                sum += pair - c.powf(p);
            }
        }
        sum
    };
    let all = partial_assignments(truths.len(), tracks.len());
    let least = all.iter().map(cost).fold(f64::INFINITY, f64::min);
    (least / more as f64).powf(1.0 / p)
}

/// OSPA⁽²⁾ of some steps, by trying every assignment.
fn ospa2_by_trial(steps: &[(Positions, Positions)], (c, p, q): (f64, f64, f64)) -> f64 {
    let exist = |of: fn(&(Positions, Positions)) -> &Positions| -> Vec<usize> {
        let heads = 0..of(&steps[0]).len();
        heads
            .filter(|head| steps.iter().any(|step| of(step)[*head].is_some()))
            .collect()
    };
    let (truths, tracks) = (exist(|step| &step.0), exist(|step| &step.1));
    let more = truths.len().max(tracks.len());
    if more == 0 {
        return 0.0;
    }
    let apart = |truth: usize, track: usize| {
        let (mut sum, mut count) = (0.0, 0);
        for (of_truths, of_tracks) in steps {
            let both = (of_truths[truth], of_tracks[track]);
            sum += match both {
                (Some(here), Some(there)) => distance(here, there).min(c).powf(q),
                (None, None) => continue,
                _ => c.powf(q),
            };
            count += 1;
        }
        (sum / f64::from(count)).powf(1.0 / q)
    };
    let cost = |choice: &Vec<Option<usize>>| {
        let mut sum = c.powf(p) * more as f64;
        for (row, column) in choice.iter().enumerate() {
            if let Some(column) = column {
                sum += apart(truths[row], tracks[*column]).min(c).powf(p) - c.powf(p);
            }
        }
        sum
    };
    let all = partial_assignments(truths.len(), tracks.len());
    let least = all.iter().map(cost).fold(f64::INFINITY, f64::min);
    (least.max(0.0) / more as f64).powf(1.0 / p)
}

#[test]
fn random_scenes_have_the_distances_that_trying_everything_finds() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let mut judged = 0;
    for case in 0..300 {
        let scene = random_scene(&mut rng, 3, 5);
        let (c, p, q) = (
            [5.0, 10.0, 30.0][case % 3],
            [1.0, 2.0, 2.5][case % 3],
            [2.0, 1.0, 3.0, 2.0][case % 4],
        );
        let comparison = scene.compare(5.0, c);
        let steps: Vec<_> = comparison
            .steps
            .iter()
            .map(|step| positions_at(&comparison, step))
            .collect();
        let due = comparison.due_steps();
        if due == 0 {
            continue;
        }
        judged += 1;
        let what = |name: &str| format!("{name} of case {case}");
        let spec = json!({"metric": "ospa2", "cutoff_m": c, "p": p, "q": q, "window_steps": 3});
        let ospa2 = scene.evaluate(5.0, spec);
        let windows: Vec<f64> = (0..steps.len())
            .map(|last| ospa2_by_trial(&steps[(last + 1).saturating_sub(3)..=last], (c, p, q)))
            .collect();
        for (step, expected) in windows.iter().enumerate() {
            let found = ospa2.series[0].values[step].unwrap();
            assert!(
                (found - expected).abs() < 1e-6,
                "{}: {found} {expected}",
                what("a window")
            );
        }
        let mean = windows.iter().sum::<f64>() / due as f64;
        assert!(
            (ospa2.value.unwrap() - mean).abs() < 1e-6,
            "{}",
            what("OSPA2")
        );
        let whole = ospa2_by_trial(&steps, (c, p, q));
        let found = ospa2.quantity("ospa2_whole").unwrap();
        assert!(
            (found - whole).abs() < 1e-6,
            "{}: {found} {whole}",
            what("one window")
        );

        let spec = json!({"metric": "labelled_ospa", "cutoff_m": c, "p": p, "label_share": 0.6});
        let labelled = scene.evaluate(5.0, spec).value.unwrap();
        let (_, labels) = labels_by_trial(&steps, c, p);
        let of_labels = |labels: &Vec<Option<usize>>| {
            let of_step = |step| labelled_by_trial(step, labels, (c, p, 0.6));
            steps.iter().map(of_step).sum::<f64>() / due as f64
        };
        let is_found = labels
            .iter()
            .any(|labels| (of_labels(labels) - labelled).abs() < 1e-9);
        assert!(is_found, "{}: {labelled}", what("labelled OSPA"));
        // No label costs: OSPA.
        let spec = json!({"metric": "labelled_ospa", "cutoff_m": c, "p": p, "label_share": 0.0});
        let free = scene.evaluate(5.0, spec).value.unwrap();
        let ospa = scene.evaluate(5.0, json!({"metric": "ospa", "cutoff_m": c, "p": p}));
        assert_close(ospa.value, free, &what("OSPA"));
        assert!(labelled >= free - 1e-12);
    }
    assert!(judged > 200, "{judged}");
}

#[test]
fn windows_of_one_step_are_ospa() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for _ in 0..100 {
        let scene = random_scene(&mut rng, 4, 4);
        let ospa = scene.evaluate(5.0, json!({"metric": "ospa", "cutoff_m": 10.0}));
        let spec = json!({"metric": "ospa2", "cutoff_m": 10.0, "window_steps": 1});
        let ospa2 = scene.evaluate(5.0, spec);
        match ospa.value {
            Some(value) => assert!((ospa2.value.unwrap() - value).abs() < 1e-6),
            None => assert_eq!(ospa2.value, None),
        }
    }
}

#[test]
fn the_tracks_are_the_truth() {
    let truth: String = (0..30)
        .map(|t| format!("{t} A {t} 0 0 0\n{t} B 40 {t} 0 0\n"))
        .collect();
    let scene = Scene::read(&truth, &truth);
    for metric in ["labelled_ospa", "ospa2"] {
        assert_eq!(
            scene.evaluate(10.0, json!({"metric": metric})).value,
            Some(0.0)
        );
    }
}
