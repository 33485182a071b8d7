//! What an exponential decay and its integrals leave, to all digits also where the closed forms cancel: e = exp(−x), x ≥ 0.

/// Below it the closed forms lose digits.
const SMALL: f64 = 0.5;

/// Terms of a series: (2·0.5)ⁿ/n! is below 1e-22 at the last.
const TERMS: i32 = 22;

/// 1 − e.
pub fn lost(x: f64) -> f64 {
    -(-x).exp_m1()
}

/// x − 1 + e; x²/2 for small x.
pub fn lag(x: f64) -> f64 {
    if x < SMALL {
        series(x, 2, |_| 1.0)
    } else {
        x - lost(x)
    }
}

/// 1 − e² − 2 x e; x³/3 for small x.
pub fn third_power(x: f64) -> f64 {
    if x < SMALL {
        series(x, 3, |n| 2.0 * f64::from(n) - 2f64.powi(n))
    } else {
        lost(2.0 * x) - 2.0 * x * (-x).exp()
    }
}

/// 2 x − 3 + 4 e − e²; 2 x³/3 for small x.
pub fn lag_of_squares(x: f64) -> f64 {
    if x < SMALL {
        series(x, 3, |n| 4.0 - 2f64.powi(n))
    } else {
        2.0 * x - 4.0 * lost(x) + lost(2.0 * x)
    }
}

/// 1 − e² + 2 x + 2 x³/3 − 2 x² − 4 x e; x⁵/10 for small x.
pub fn fifth_power(x: f64) -> f64 {
    if x < SMALL {
        series(x, 5, |n| 4.0 * f64::from(n) - 2f64.powi(n))
    } else {
        lost(2.0 * x) + 2.0 * x + 2.0 * x.powi(3) / 3.0 - 2.0 * x * x - 4.0 * x * (-x).exp()
    }
}

/// Σ cₙ (−x)ⁿ/n! from n = `first` on, smallest terms first.
fn series(x: f64, first: i32, coefficient: impl Fn(i32) -> f64) -> f64 {
    let mut factorial = 1.0;
    let mut terms = [0.0; TERMS as usize + 1];
    for n in 1..=TERMS {
        factorial *= f64::from(n);
        terms[n as usize] = coefficient(n) * (-x).powi(n) / factorial;
    }
    terms[first as usize..].iter().rev().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_and_closed_forms_meet() {
        for function in [lag, third_power, lag_of_squares, fifth_power] {
            let (below, above) = (function(SMALL - 1e-12), function(SMALL));
            assert!((below / above - 1.0).abs() < 1e-10, "{below} {above}");
        }
    }

    #[test]
    fn small_ones_are_their_leading_powers() {
        let x: f64 = 1e-7;
        for (found, leading) in [
            (lost(x), x),
            (lag(x), x * x / 2.0),
            (third_power(x), x.powi(3) / 3.0),
            (lag_of_squares(x), 2.0 * x.powi(3) / 3.0),
            (fifth_power(x), x.powi(5) / 10.0),
        ] {
            assert!((found / leading - 1.0).abs() < 1e-6, "{found} {leading}");
        }
    }
}
