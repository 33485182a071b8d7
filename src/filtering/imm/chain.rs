//! The Markov chain that says which model a target moves by: it stays with model i for a mean time τᵢ, then takes any of the
//! others with equal probability.
//!
//! # Symbols
//! G generator: Gᵢᵢ = −1/τᵢ, Gᵢⱼ = 1/(τᵢ (r − 1)); Π transition probabilities over T.
//!
//! # Method
//! Π = exp(G T), by the exponential's series on G T/2ˢ, squared s times. Over T = 0 nothing changes, and Π over two times in a row
//! is their product, so that scans at any times mix the models alike.

use nalgebra::SMatrix;

/// The rates of scaled generators are at most this.
const LARGEST_RATE: f64 = 0.25;
/// 0.5ⁿ/n! of the last term is below 1e-18.
const TERMS: u32 = 14;

/// G of the first `sojourns_s.len()` of `R` models; nothing leaves the others.
pub fn generator<const R: usize>(sojourns_s: &[f64]) -> SMatrix<f64, R, R> {
    let mut generator = SMatrix::zeros();
    for (row, sojourn_s) in sojourns_s.iter().enumerate() {
        for column in 0..sojourns_s.len() {
            generator[(row, column)] = if row == column {
                -1.0 / sojourn_s
            } else {
                1.0 / (sojourn_s * (sojourns_s.len() - 1) as f64)
            };
        }
    }
    generator
}

/// Π over `dt_s` ≥ 0.
pub fn transition<const R: usize>(generator: &SMatrix<f64, R, R>, dt_s: f64) -> SMatrix<f64, R, R> {
    let fastest = (0..R).fold(0.0, |most: f64, mode| most.max(-generator[(mode, mode)])) * dt_s;
    let mut halvings = 0;
    while fastest * 0.5f64.powi(halvings) > LARGEST_RATE {
        halvings += 1;
    }
    let step = generator * (dt_s * 0.5f64.powi(halvings));
    let mut transition = SMatrix::<f64, R, R>::identity();
    for term in (1..=TERMS).rev() {
        transition = SMatrix::identity() + step * transition / f64::from(term);
    }
    for _ in 0..halvings {
        transition *= transition;
        // Squaring doubles what rounding made of the sums.
        for mut row in transition.row_iter_mut() {
            let sum = row.sum();
            row /= sum;
        }
    }
    transition
}
