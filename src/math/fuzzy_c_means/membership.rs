//! From distances to memberships.
//!
//! # Method
//! u_i = 1 / Σ_j (d_i / d_j)^(2/(q−1)) is computed as r_i / Σ r_j with r_i = (d_min² / d_i²)^(1/(q−1)) ≤ 1, so that
//! nothing overflows, however near an object comes to a centre. For q = 2 the exponents are 1 and 2 and no power is taken.

use super::FuzzyError;

/// q > 1, prepared for many memberships.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fuzzifier {
    q: f64,
    /// 1 / (q − 1).
    exponent: f64,
}

impl Fuzzifier {
    /// # Errors
    /// q that is not above 1.
    pub fn new(q: f64) -> Result<Self, FuzzyError> {
        if q.is_finite() && q > 1.0 {
            Ok(Fuzzifier {
                q,
                exponent: 1.0 / (q - 1.0),
            })
        } else {
            Err(FuzzyError::Fuzzifier(q))
        }
    }

    /// u^q.
    #[inline]
    pub fn raise(self, membership: f64) -> f64 {
        if self.q == 2.0 {
            membership * membership
        } else {
            membership.powf(self.q)
        }
    }

    /// The memberships of one object from its squared distances d_i², of which at least one is finite; they sum to 1.
    /// An infinite distance gives the membership 0.
    #[inline]
    pub fn share(self, squared_distances: &[f64], memberships: &mut [f64]) {
        let nearest = squared_distances
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min);
        let mut sum = 0.0;
        for (membership, &squared) in memberships.iter_mut().zip(squared_distances) {
            *membership = self.ratio(nearest, squared);
            sum += *membership;
        }
        memberships
            .iter_mut()
            .for_each(|membership| *membership /= sum);
    }

    /// r_i; where the nearest centre is the object itself, 1 for the centres there and 0 for the others.
    #[inline]
    fn ratio(self, nearest: f64, squared: f64) -> f64 {
        if squared == nearest {
            return 1.0;
        }
        let ratio = nearest / squared;
        if self.q == 2.0 {
            ratio
        } else {
            ratio.powf(self.exponent)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shared(q: f64, distances: &[f64]) -> Vec<f64> {
        let squared: Vec<f64> = distances
            .iter()
            .map(|distance| distance * distance)
            .collect();
        let mut memberships = vec![0.0; distances.len()];
        Fuzzifier::new(q).unwrap().share(&squared, &mut memberships);
        memberships
    }

    fn assert_close(found: &[f64], expected: &[f64]) {
        let close = found
            .iter()
            .zip(expected)
            .all(|(found, expected)| (found - expected).abs() < 1e-12);
        assert!(
            close && found.len() == expected.len(),
            "{found:?} is not {expected:?}"
        );
    }

    #[test]
    fn memberships_by_hand() {
        // q = 2: 1/1 : 1/9 = 0.9 : 0.1.
        assert_close(&shared(2.0, &[1.0, 3.0]), &[0.9, 0.1]);
        // q = 3, exponent of d 1: 1 : 1/3; q = 1.5, exponent 4: 1 : 1/81.
        assert_close(&shared(3.0, &[1.0, 3.0]), &[0.75, 0.25]);
        assert_close(&shared(1.5, &[1.0, 3.0]), &[81.0 / 82.0, 1.0 / 82.0]);
        // q = 2, three centres: 1 : 1/4 : 1/4.
        assert_close(
            &shared(2.0, &[1.0, 2.0, 2.0]),
            &[2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0],
        );
    }

    #[test]
    fn an_object_on_centres_is_shared_among_them_alone() {
        for q in [1.5, 2.0, 3.0] {
            assert_eq!(shared(q, &[2.0, 0.0, 5.0]), [0.0, 1.0, 0.0]);
            assert_eq!(shared(q, &[0.0, 0.0, 5.0]), [0.5, 0.5, 0.0]);
        }
    }

    #[test]
    fn extreme_distances_neither_overflow_nor_vanish() {
        assert_close(&shared(2.0, &[1e-150, 1e150]), &[1.0, 0.0]);
        assert_close(&shared(1.01, &[1e-100, 1e100]), &[1.0, 0.0]);
        assert_close(&shared(2.0, &[1e-160, 1e-160]), &[0.5, 0.5]);
        assert_eq!(shared(2.0, &[3.0, f64::INFINITY]), [1.0, 0.0]);
    }

    #[test]
    fn a_fuzzifier_of_one_or_less_is_refused() {
        for q in [1.0, 0.5, f64::NAN, f64::INFINITY] {
            assert!(
                matches!(Fuzzifier::new(q), Err(FuzzyError::Fuzzifier(_))),
                "{q}"
            );
        }
    }
}
