//! Numbers for sums of products of association weights: `f64` where nothing can leave its range, else [`Wide`], whose
//! exponent has 64 bits. All sums here have positive terms only, so neither loses more than rounding.

use std::ops::{Add, Div, Mul};

/// What the sums over joint events need of a number.
pub(super) trait Number:
    Copy + Default + Add<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    const ONE: Self;

    fn exp(logarithm: f64) -> Self;

    /// self / total, for self ≤ total.
    fn share_of(self, total: Self) -> f64;
}

impl Number for f64 {
    const ONE: Self = 1.0;

    #[inline]
    fn exp(logarithm: f64) -> Self {
        logarithm.exp()
    }

    #[inline]
    fn share_of(self, total: Self) -> f64 {
        self / total
    }
}

/// fraction · 2^exponent, with the fraction in [1, 2), or 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Wide {
    fraction: f64,
    exponent: i64,
}

const FRACTION_BITS: u32 = 52;
const BIAS: u64 = 1023;

impl Wide {
    /// `fraction` is 0 or a normal number.
    fn new(fraction: f64, exponent: i64) -> Self {
        if fraction == 0.0 {
            return Wide::default();
        }
        let bits = fraction.to_bits();
        let shift = (bits >> FRACTION_BITS) as i64 - BIAS as i64;
        let fraction =
            f64::from_bits((bits & ((1 << FRACTION_BITS) - 1)) | (BIAS << FRACTION_BITS));
        Wide {
            fraction,
            exponent: exponent + shift,
        }
    }

    /// The fraction as it stands beside a larger exponent; 0 when it is too small to be seen there.
    fn aligned_to(self, exponent: i64) -> f64 {
        let shift = exponent - self.exponent;
        if shift >= BIAS as i64 {
            0.0
        } else {
            self.fraction * f64::from_bits((BIAS - shift as u64) << FRACTION_BITS)
        }
    }
}

impl Add for Wide {
    type Output = Wide;

    fn add(self, other: Wide) -> Wide {
        if self.fraction == 0.0 || other.fraction == 0.0 {
            return if self.fraction == 0.0 { other } else { self };
        }
        let (large, small) = if self.exponent >= other.exponent {
            (self, other)
        } else {
            (other, self)
        };
        Wide::new(
            large.fraction + small.aligned_to(large.exponent),
            large.exponent,
        )
    }
}

impl Mul for Wide {
    type Output = Wide;

    fn mul(self, other: Wide) -> Wide {
        Wide::new(
            self.fraction * other.fraction,
            self.exponent + other.exponent,
        )
    }
}

impl Div for Wide {
    type Output = Wide;

    /// Nothing here is divided by 0.
    fn div(self, other: Wide) -> Wide {
        Wide::new(
            self.fraction / other.fraction,
            self.exponent - other.exponent,
        )
    }
}

impl Number for Wide {
    const ONE: Self = Wide {
        fraction: 1.0,
        exponent: 0,
    };

    fn exp(logarithm: f64) -> Self {
        let exponent = (logarithm * std::f64::consts::LOG2_E).floor();
        Wide::new(
            (logarithm - exponent * std::f64::consts::LN_2).exp(),
            exponent as i64,
        )
    }

    fn share_of(self, total: Self) -> f64 {
        if self.fraction == 0.0 {
            0.0
        } else {
            self.aligned_to(total.exponent) / total.fraction
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn wide_numbers_compute_as_f64_does(a in -200.0..200.0f64, b in -200.0..200.0f64, c in -200.0..200.0f64) {
            let wide = Wide::exp(a) * Wide::exp(b) + Wide::exp(c);
            let total = wide + Wide::exp(3.0);
            let expected = (a.exp() * b.exp() + c.exp()) / (a.exp() * b.exp() + c.exp() + 3f64.exp());
            prop_assert!((wide.share_of(total) - expected).abs() <= 1e-12 * expected, "{wide:?} {expected}");
            let quotient = (wide / total).share_of(Wide::ONE);
            prop_assert!((quotient - expected).abs() <= 1e-12 * expected, "{quotient} {expected}");
        }
    }

    #[test]
    fn far_beyond_the_range_of_f64_shares_are_still_right() {
        let huge = Wide::exp(5000.0);
        assert!((huge.share_of(huge + huge) - 0.5).abs() < 1e-15);
        let tiny = Wide::exp(-5000.0);
        assert!(((tiny * huge).share_of(Wide::ONE + tiny * huge) - 0.5).abs() < 1e-12);
        assert_eq!(tiny.share_of(huge), 0.0);
        assert_eq!(Wide::default() + huge, huge);
        assert_eq!(Wide::default() * huge, Wide::default());
    }
}
