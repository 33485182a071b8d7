//! What is kept of undetected targets.

use super::*;

type Packed = [f64; 1];

fn intensity(weights: &[f64]) -> Intensity<Packed> {
    Intensity {
        weights: weights.to_vec(),
        beliefs: weights.iter().map(|weight| [*weight]).collect(),
        density: 0.0,
    }
}

#[test]
fn light_parts_are_dropped_and_beyond_the_most_the_lightest() {
    let mut few = intensity(&[0.5, 0.9e-5, 1e-5, 0.0]);
    few.prune();
    assert_eq!(few.weights, [0.5, 1e-5]);
    assert_eq!(few.beliefs, [[0.5], [1e-5]]);
    few.push(0.9e-5, [1.0]);
    assert_eq!(few.weights.len(), 2);
    let many: Vec<f64> = (0..MOST_PARTS + 100).map(|at| 0.1 + at as f64).collect();
    let mut many = intensity(&many);
    many.prune();
    assert_eq!(many.weights.len(), MOST_PARTS);
    assert_eq!(many.weights[0], 100.1, "the first hundred are the lightest");
}
