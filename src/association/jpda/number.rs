//! Numbers for sums of products of association weights: `f64` where nothing can leave its range, [`Scaled`] where nothing does
//! if tables are scaled on the way, else [`Wide`], whose exponent has 64 bits. All sums here have positive terms only, so none
//! loses more than rounding.

use std::ops::{Add, Div, Mul};

/// What the sums over joint events need of a number.
pub(super) trait Number:
    Copy + Default + Add<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    const ONE: Self;

    fn exp(logarithm: f64) -> Self;

    /// self / total, for self ≤ total.
    fn share_of(self, total: Self) -> f64;

    /// self · 2^shift / total, for tables that [`Number::settle`] scaled.
    #[inline]
    fn share_at(self, _shift: i64, total: Self) -> f64 {
        self.share_of(total)
    }

    /// Scales a table by a power of two where that keeps it in range, and tells which; `None` where nothing would.
    #[inline]
    fn settle(_table: &mut [Self]) -> Option<i64> {
        Some(0)
    }
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

/// An `f64` in tables that are scaled on the way. Nothing is lost by that: weights are within e^±[`MAX_SCALED_LOG`], the cells of a
/// table within 2^-[`SPAN`] of the largest, which is below 2^[`TOP`], and no product of two cells and a weight leaves the range.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Scaled(f64);

/// Logarithms of weights that [`Scaled`] takes; e^100 is below 2^145.
pub(super) const MAX_SCALED_LOG: f64 = 100.0;
const SPAN: i64 = 200;
const TOP: i64 = 100;

/// 2^exponent, for exponents of normal numbers.
#[inline]
fn power_of_two(exponent: i64) -> f64 {
    f64::from_bits(((BIAS as i64 + exponent) as u64) << FRACTION_BITS)
}

impl Add for Scaled {
    type Output = Scaled;

    #[inline]
    fn add(self, other: Scaled) -> Scaled {
        Scaled(self.0 + other.0)
    }
}

impl Mul for Scaled {
    type Output = Scaled;

    #[inline]
    fn mul(self, other: Scaled) -> Scaled {
        Scaled(self.0 * other.0)
    }
}

impl Div for Scaled {
    type Output = Scaled;

    #[inline]
    fn div(self, other: Scaled) -> Scaled {
        Scaled(self.0 / other.0)
    }
}

impl Number for Scaled {
    const ONE: Self = Scaled(1.0);

    /// To the bit what [`Wide`] makes of it.
    fn exp(logarithm: f64) -> Self {
        let wide = Wide::exp(logarithm);
        Scaled(wide.fraction * power_of_two(wide.exponent))
    }

    #[inline]
    fn share_of(self, total: Self) -> f64 {
        self.0 / total.0
    }

    fn share_at(self, shift: i64, total: Self) -> f64 {
        Wide::new(self.0, shift).share_of(Wide::new(total.0, 0))
    }

    fn settle(table: &mut [Self]) -> Option<i64> {
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        for cell in table.iter() {
            // A cell that no event leads to is 0.
            least = least.min(if cell.0 > 0.0 { cell.0 } else { f64::INFINITY });
            most = most.max(cell.0);
        }
        if least < most * power_of_two(-SPAN) {
            return None;
        }
        if most <= power_of_two(TOP) {
            return Some(0);
        }
        let exponent = (most.to_bits() >> FRACTION_BITS) as i64 - BIAS as i64;
        let factor = power_of_two(-exponent);
        for cell in table {
            cell.0 *= factor;
        }
        Some(exponent)
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
