//! Random scenes judged a second time without any automaton, by laying whole strings beside each other.

use super::notation::evaluate;
use proptest::prelude::*;

/// A string in normal form: where it starts and its words.
pub type Text = (usize, Vec<String>);

/// Splits a line of words at five ε in a row and trims what is left.
pub fn strings_of(words: &[String]) -> Vec<Text> {
    let mut strings: Vec<Text> = Vec::new();
    for (place, word) in words.iter().enumerate().filter(|(_, word)| *word != ".") {
        match strings.last_mut() {
            Some((start, open)) if place - (*start + open.len()) < 5 => {
                open.resize(place - *start, ".".to_owned());
                open.push(word.clone());
            }
            _ => strings.push((place, vec![word.clone()])),
        }
    }
    strings
}

pub fn word_at((start, words): &Text, place: usize) -> &str {
    place
        .checked_sub(*start)
        .and_then(|offset| words.get(offset))
        .map_or(".", String::as_str)
}

pub fn differing(a: &Text, b: &Text, scans: usize) -> Vec<usize> {
    (0..scans)
        .filter(|&place| word_at(a, place) != word_at(b, place))
        .collect()
}

/// Verdict, scan of the first difference and errors of one truth string.
fn judge_string(
    truth: &Text,
    outputs: &[Text],
    scans: usize,
) -> (&'static str, Option<usize>, usize) {
    let followers: Vec<&Text> = outputs
        .iter()
        .filter(|output| output.0 == truth.0 && output.1[0] == truth.1[0])
        .collect();
    if followers.is_empty() {
        return (
            "missed",
            Some(truth.0),
            truth.1.iter().filter(|word| *word != ".").count(),
        );
    }
    if followers.contains(&truth) {
        return ("correct", None, 0);
    }
    let mut longest: Option<Vec<usize>> = None;
    for follower in followers {
        let places = differing(truth, follower, scans);
        if longest.as_ref().is_none_or(|kept| kept[0] < places[0]) {
            longest = Some(places);
        }
    }
    let places = longest.unwrap();
    ("false", Some(places[0]), places.len())
}

fn judge_target(
    truths: &[Text],
    outputs: &[Text],
    scans: usize,
) -> (&'static str, Option<u32>, usize) {
    let judged: Vec<_> = truths
        .iter()
        .map(|truth| judge_string(truth, outputs, scans))
        .collect();
    let errors = judged.iter().map(|(.., errors)| errors).sum();
    if judged.iter().all(|(verdict, ..)| *verdict == "missed") {
        return ("missed", None, errors);
    }
    let first = judged.iter().find(|(verdict, ..)| *verdict != "correct");
    first.map_or(("correct", None, errors), |(_, place, _)| {
        ("false", place.map(|place| place as u32 + 1), errors)
    })
}

/// For each target its words, scan by scan; for each track which target's word it takes, with some clutter and ε.
pub fn scene() -> impl Strategy<Value = (Vec<Vec<String>>, Vec<Vec<String>>)> {
    (1..4usize, 0..5usize, 1..20usize).prop_flat_map(|(targets, tracks, scans)| {
        let seen = prop::collection::vec(
            prop::collection::vec(prop::bool::weighted(0.6), scans),
            targets,
        );
        let habit =
            prop::collection::vec((0..targets, prop::collection::vec(0..24u8, scans)), tracks);
        (seen, habit).prop_map(|(seen, habit)| {
            let word =
                |target: usize, place: usize| format!("{}{}", ["a", "b", "c"][target], place + 1);
            let truth: Vec<Vec<String>> = (0..seen.len())
                .map(|target| {
                    (0..scans_of(&seen))
                        .map(|place| {
                            if seen[target][place] {
                                word(target, place)
                            } else {
                                ".".into()
                            }
                        })
                        .collect()
                })
                .collect();
            let take = |own: usize, place: usize, dice: u8| match dice {
                0 => format!("x{}", place + 1),
                1 => ".".to_owned(),
                2 => truth[(own + 1) % truth.len()][place].clone(),
                _ => truth[own][place].clone(),
            };
            let tracks = habit
                .iter()
                .map(|(own, dice)| {
                    dice.iter()
                        .enumerate()
                        .map(|(place, &dice)| take(*own, place, dice))
                        .collect()
                })
                .collect();
            (truth, tracks)
        })
    })
}

fn scans_of(seen: &[Vec<bool>]) -> usize {
    seen[0].len()
}

/// The lines of a scene, named by their number.
pub fn lines(all: &[Vec<String>]) -> Vec<String> {
    all.iter()
        .enumerate()
        .map(|(index, words)| format!("{index}: {}", words.join(" ")))
        .collect()
}

pub fn borrowed(lines: &[String]) -> Vec<&str> {
    lines.iter().map(String::as_str).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn verdicts_are_those_of_comparing_whole_strings((truth, tracks) in scene()) {
        let scans = truth[0].len();
        let outputs: Vec<Text> = tracks.iter().flat_map(|words| strings_of(words)).collect();
        let clutter: String = (1..=scans).map(|scan| format!("x{scan} ")).collect();
        let (truth_lines, track_lines) = (lines(&truth), lines(&tracks));
        let report = evaluate(&borrowed(&truth_lines), &[&clutter], &borrowed(&track_lines));
        let empty = tracks.iter().filter(|words| words.iter().all(|word| word == ".")).count();
        prop_assert_eq!(report.counts.output_tracks, outputs.len() + empty);
        for (target, words) in report.targets.iter().zip(&truth) {
            let found = (super::notation::word(&target.verdict), target.at_scan, target.errors);
            let (verdict, at_scan, errors) = judge_target(&strings_of(words), &outputs, scans);
            prop_assert_eq!(found, (verdict.to_owned(), at_scan, errors), "target {}", &target.truth_id);
        }
    }
}
