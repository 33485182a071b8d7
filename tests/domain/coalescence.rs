//! The scene in which averages draw tracks together: its courses, and what each associator makes of it.

use crate::coalescence_scene::{OUTCOMES, PUBLISHED, associators, found, simulated};
use trackloom_domain::experiment::job_shape::take_kind;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{Artifact, plan, presets, run};

#[test]
fn the_targets_come_together_and_part() {
    let (_, truth, _) = simulated(0);
    for (scan, half_m) in [
        (0, 10.0),
        (10, 10.0),
        (20, 5.2),
        (30, 0.4),
        (70, 0.4),
        (99, 14.32),
    ] {
        for (target, side) in truth.targets().iter().zip([1.0, -1.0]) {
            let place = target.points[scan].position;
            assert!((place.y - side * half_m).abs() < 0.01, "{scan}: {place}");
            // The speed is the same on the slanted legs, which are a little longer.
            let late_m = 0.011_54 * (scan.clamp(10, 30) - 10 + scan.max(70) - 70) as f64;
            assert!(
                (place.x - (10.0 * scan as f64 - late_m)).abs() < 0.01,
                "{scan}: {place}"
            );
        }
    }
}

const RUNS: u32 = 100;

/// Within four standard errors of both programs, a hundred runs here and three hundred there.
#[test]
fn associators_err_as_in_the_published_table() {
    let both = (1.0 + f64::from(RUNS) / 300.0).sqrt();
    for ((name, associator), published) in associators().iter().zip(PUBLISHED) {
        let (expected_name, rms_m, median_m2, shares) = published;
        assert_eq!(name, expected_name);
        let found = found(associator, RUNS);
        let numbers = found.rms_m().into_iter().zip(rms_m);
        for ((number, error), expected) in numbers.chain([(found.median_m2(), median_m2)]) {
            let apart = (number - expected).abs() / (error * both);
            assert!(apart < 4.0, "{name}: {number} ± {error}, not {expected}");
        }
        for (outcome, expected) in shares.into_iter().enumerate() {
            let variance = (expected * (1.0 - expected)).max(0.01);
            let error = both * (variance / f64::from(RUNS)).sqrt();
            let share = found.shares()[outcome];
            let what = OUTCOMES[outcome];
            assert!(
                (share - expected).abs() < 4.0 * error,
                "{name}: {what} {share}"
            );
        }
    }
}

/// While the targets fly side by side the average errs least. Afterwards it holds on to both, and what decides does not.
#[test]
fn what_decides_parts_when_the_targets_part() {
    let found: Vec<[f64; 2]> = associators()
        .iter()
        .map(|(_, associator)| found(associator, 30).rms_m().map(|(rms_m, _)| rms_m))
        .collect();
    let [gnn, jpda, star, nn] = found.try_into().unwrap();
    assert!(jpda[0] < 0.85 && 0.95 < star[0].min(gnn[0]).min(nn[0]));
    assert!(jpda[1] > 2.5 && star[1] < 1.1, "{jpda:?} {star:?}");
}

/// The report tells how many clusters were served how, and weights that decide are 0 or 1.
#[test]
fn a_job_says_what_it_did_against_coalescence() {
    for (name, associator) in associators() {
        let mut body = presets::find("coalescence").unwrap().body["base"].take();
        body["associator"] = associator;
        let kind = take_kind(&mut body).unwrap();
        let outcome = run(&plan(kind, &body).unwrap(), Vec::new(), &mut Silent).unwrap();
        let diagnostics = &outcome.result["association"]["diagnostics"];
        let kept = &diagnostics["best_permutation"];
        if name == "JPDA*" {
            assert!(kept["clusters"].as_u64().unwrap() > 40, "{diagnostics}");
            assert!(kept["most_events"].as_u64().unwrap() >= 5, "{diagnostics}");
            assert_eq!(kept["left_to_jpda"], 0);
        } else {
            assert!(kept.is_null(), "{name}: {diagnostics}");
        }
        let is_soft = outcome.artifacts.iter().any(has_shared_weights);
        assert_eq!(is_soft, matches!(name.as_str(), "JPDA" | "JPDA*"), "{name}");
    }
}

/// Whether the tracks of a job have probabilities between 0 and 1.
fn has_shared_weights(file: &Artifact) -> bool {
    if file.name != "tracks.csv" {
        return false;
    }
    let mut lines = std::str::from_utf8(&file.bytes).unwrap().lines();
    let header = lines.next().unwrap();
    let column = header.split(',').position(|name| name == "probability");
    let value = |line: &str| line.split(',').nth(column.unwrap()).unwrap().parse::<f64>();
    lines.any(|line| (0.01..0.99).contains(&value(line).unwrap()))
}
