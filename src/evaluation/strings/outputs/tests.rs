//! Decisions and choices among candidates.

use super::*;

fn decide(candidates: &[(Option<u32>, f64)]) -> Option<Option<u32>> {
    candidates_of(candidates)
        .into_iter()
        .fold(None, Candidate::more_probable)
        .map(|decision| decision.detection)
}

#[test]
fn the_most_probable_candidate_counts_and_ties_go_to_the_first_detection() {
    assert_eq!(decide(&[]), None);
    assert_eq!(
        decide(&[(None, 0.5), (Some(1), 0.3), (Some(2), 0.2)]),
        Some(None)
    );
    assert_eq!(
        decide(&[(None, 0.2), (Some(1), 0.4), (Some(2), 0.4)]),
        Some(Some(1))
    );
    assert_eq!(decide(&[(None, 0.5), (Some(7), 0.5)]), Some(Some(7)));
    assert_eq!(decide(&[(Some(7), 0.5), (None, 0.5)]), Some(Some(7)));
    assert_eq!(decide(&[(Some(7), f64::NAN), (None, 0.1)]), Some(None));
}

fn candidates_of(candidates: &[(Option<u32>, f64)]) -> Vec<Candidate> {
    candidates
        .iter()
        .map(|&(detection, probability)| Candidate {
            detection,
            probability,
        })
        .collect()
}

fn allowed(candidates: &[(Option<u32>, f64)], min_weight: f64) -> Vec<(Option<u32>, f64)> {
    let mut choices = Vec::new();
    allow(&candidates_of(candidates), min_weight, &mut choices);
    choices
        .into_iter()
        .map(|step| (step.symbol, step.weight))
        .collect()
}

#[test]
fn candidates_of_enough_weight_are_choices_and_epsilon_where_none_is() {
    let soft = [
        (None, 0.25),
        (Some(1), 0.5),
        (Some(2), 0.125),
        (Some(3), 0.125),
    ];
    assert_eq!(allowed(&soft, 0.125), soft);
    assert_eq!(allowed(&soft, 0.2), [(None, 0.25), (Some(1), 0.5)]);
    assert_eq!(allowed(&soft, 0.4), [(Some(1), 0.5)]);
    assert_eq!(allowed(&soft, 0.6), [(None, 0.25)], "nothing else is");
    assert_eq!(
        allowed(&[(Some(1), 0.25), (Some(2), 0.5)], 0.6),
        [(None, 0.25)],
        "what the others leave"
    );
    assert_eq!(allowed(&[], 0.1), [(None, 1.0)]);
    assert_eq!(
        allowed(&[(Some(1), 0.25), (Some(1), 0.5), (Some(2), f64::NAN)], 0.1),
        [(Some(1), 0.5)]
    );
}
