//! Numbers that have one right value, worked by hand or by another program, and warnings that say what a number cannot.

mod apart;
mod clocks;
mod confirmed_late;
mod correlation;
mod directions;
mod noise;
mod precise_sensor;
mod radar_requirements;
mod scans;
mod steps;
mod surveillance;
mod surveillance_recording;
mod within;
mod zeros;

use crate::origins::jobs::Texts;
use serde_json::{Value, json};
use std::fmt::Write;
use trackloom_domain::experiment::Outcome;

/// Rows below a header.
fn table(header: &str, rows: impl IntoIterator<Item = String>) -> String {
    rows.into_iter()
        .fold(format!("{header}\n"), |mut text, row| {
            writeln!(text, "{row}").unwrap();
            text
        })
}

fn truth_of(rows: impl IntoIterator<Item = (f64, f64, f64)>) -> String {
    table(
        "time_s,truth_id,x_m,y_m",
        rows.into_iter()
            .map(|(time_s, x_m, y_m)| format!("{time_s},A,{x_m},{y_m}")),
    )
}

fn tracks_of(rows: impl IntoIterator<Item = (f64, f64, f64)>) -> String {
    table(
        "time_s,track_id,x_m,y_m",
        rows.into_iter()
            .map(|(time_s, x_m, y_m)| format!("{time_s},1,{x_m},{y_m}")),
    )
}

/// Judges tracks beside a truth with these settings.
fn judged(truth: &str, tracks: &str, settings: Value) -> Outcome {
    let mut texts = Texts::of("csv");
    let mut body = json!({"truth": texts.dataset(truth), "tracks": texts.dataset(tracks)});
    body.as_object_mut()
        .unwrap()
        .extend(settings.as_object().unwrap().clone());
    texts.judge(&body).unwrap()
}

fn metrics(names: &[&str]) -> Value {
    names.iter().map(|name| json!({"metric": name})).collect()
}

fn quantity(outcome: &Outcome, metric: &str, name: &str) -> f64 {
    let value = &outcome.result["metrics"][metric]["quantities"][name]["value"];
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{metric}.{name} is {value}"))
}

/// The only warning that has these words.
#[track_caller]
fn warning<'o>(outcome: &'o Outcome, words: &str) -> &'o str {
    let found: Vec<&String> = outcome
        .warnings
        .iter()
        .filter(|warning| warning.contains(words))
        .collect();
    assert_eq!(found.len(), 1, "'{words}' in {:#?}", outcome.warnings);
    found[0]
}

#[test]
fn a_segment_ends_where_the_track_is_not_there() {
    // Twenty steps; the track is there in the first five and the last five: two pieces of 4 s of a life of 19 s.
    let step = |time: u32| (f64::from(time), f64::from(time), 0.0);
    let (truth, tracks) = (
        truth_of((0..20).map(step)),
        tracks_of((0..20).filter(|time| !(5..15).contains(time)).map(step)),
    );
    let siap = |compat: &str, [confirm, end]: [u32; 2]| {
        let metric = json!({"metric": "siap", "confirm_steps": confirm, "end_steps": end, "siap_compat": compat});
        judged(
            &truth,
            &tracks,
            json!({"comparison": {"gate_m": 10.0}, "metrics": [metric]}),
        )
    };
    for (compat, segment, changes) in [
        ("none", 4.0 / 19.0, 0.0),
        ("stonesoup", 8.0 / 19.0, 1.0 / 8.0),
    ] {
        let outcome = siap(compat, [1, 1]);
        assert_eq!(quantity(&outcome, "siap", "completeness"), 0.5);
        assert!(
            (quantity(&outcome, "siap", "longest_segment") - segment).abs() < 1e-12,
            "{compat}"
        );
        // Tracked for 4 + 4 s.
        assert!(
            (quantity(&outcome, "siap", "track_number_change_rate") - changes).abs() < 1e-12,
            "{compat}"
        );
    }
    // A hole of ten steps is shorter than eleven.
    assert_eq!(
        quantity(&siap("none", [1, 11]), "siap", "longest_segment"),
        1.0
    );
    assert!(
        (quantity(&siap("none", [3, 10]), "siap", "longest_segment") - 4.0 / 19.0).abs() < 1e-12
    );
}

#[test]
fn a_track_at_every_third_step_is_away_for_two_in_a_row() {
    let step = |time: u32| (f64::from(time), f64::from(time), 0.0);
    let of = |first: u32| {
        (first..21)
            .step_by(3)
            .map(step)
            .map(move |(time_s, x_m, y_m)| format!("{time_s},{first},{x_m},{y_m}"))
    };
    let tracks = table("time_s,track_id,x_m,y_m", (0..3).flat_map(of));
    for (end_steps, segment) in [(2, 0.0), (3, 18.0 / 20.0)] {
        let metric = json!({"metric": "siap", "confirm_steps": 1, "end_steps": end_steps});
        let outcome = judged(
            &truth_of((0..21).map(step)),
            &tracks,
            json!({"comparison": {"gate_m": 10.0}, "metrics": [metric]}),
        );
        assert!((quantity(&outcome, "siap", "longest_segment") - segment).abs() < 1e-12);
    }
}

#[test]
fn trajectories_that_are_entangled_have_two_bounds_and_a_warning() {
    let outcome = crate::origins::entangled();
    let [lower, upper, gap, value] = ["t_gospa_lower", "t_gospa_upper", "gap", "t_gospa"]
        .map(|name| quantity(&outcome, "t_gospa", name));
    assert!(
        lower <= value
            && value < (1.0 + 1e-6) * lower
            && gap > 0.0
            && (upper - lower - gap).abs() < 1e-9,
        "{lower} {upper} {gap} {value}"
    );
    assert!(gap < 0.1 * upper, "{lower} to {upper}");
    let told = format!(
        "t_gospa is a lower bound: the exact value lies between {lower:.3} m and {upper:.3} m, a gap of {gap:.3} m"
    );
    assert!(
        warning(&outcome, "t_gospa").starts_with(&told),
        "{:?}",
        outcome.warnings
    );

    let path = |time: u32| (f64::from(time), 10.0 * f64::from(time), 0.0);
    let alone = judged(
        &truth_of((0..9).map(path)),
        &tracks_of((0..9).map(path)),
        json!({"metrics": [{"metric": "t_gospa"}]}),
    );
    let bounds = ["t_gospa", "t_gospa_lower", "t_gospa_upper", "gap"]
        .map(|name| quantity(&alone, "t_gospa", name));
    assert_eq!((bounds, alone.warnings), ([0.0; 4], Vec::new()));
}
