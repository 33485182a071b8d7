//! Where along a bearing a target may be: several ranges at once, each as well known as the others in proportion.
//!
//! # Reference
//! N. Peach, Bearings-only tracking using a set of range-parameterised extended Kalman filters, IEE Proceedings 142(1), 1995.
//!
//! # Symbols
//! n ranges between r_min and r_max; ρ = (r_max / r_min)^(1/n).
//!
//! # Method
//! The edges r_min ρᵏ cut the interval into n parts. Part k has the mean and the standard deviation of a uniform range within it:
//! half of the sum of its edges, and their difference over √12. All parts are equally probable.

/// Limits of the range of a target that is seen in a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangePrior {
    pub min_m: f64,
    pub max_m: f64,
    /// From 1 to [`MAX_RANGES`].
    pub ranges: u32,
}

/// Ranges of a prior at the most.
pub const MAX_RANGES: usize = 12;

/// A range and its standard deviation (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UncertainRange {
    pub mean_m: f64,
    pub sigma_m: f64,
}

impl RangePrior {
    pub fn parts(&self) -> impl Iterator<Item = UncertainRange> + use<> {
        let RangePrior { min_m, ranges, .. } = *self;
        let ratio = (self.max_m / min_m).powf(1.0 / f64::from(ranges));
        (0..ranges as i32).map(move |part| {
            let (near_m, far_m) = (min_m * ratio.powi(part), min_m * ratio.powi(part + 1));
            UncertainRange {
                mean_m: (near_m + far_m) / 2.0,
                sigma_m: (far_m - near_m) / 12f64.sqrt(),
            }
        })
    }

    /// The mean and the standard deviation over all parts.
    pub fn whole(&self) -> UncertainRange {
        let count = f64::from(self.ranges);
        let mean_m = self.parts().map(|part| part.mean_m).sum::<f64>() / count;
        let square = |part: UncertainRange| part.sigma_m.powi(2) + (part.mean_m - mean_m).powi(2);
        UncertainRange {
            mean_m,
            sigma_m: (self.parts().map(square).sum::<f64>() / count).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_grow_by_one_ratio_and_are_known_alike() {
        let prior = RangePrior {
            min_m: 1000.0,
            max_m: 32_000.0,
            ranges: 5,
        };
        let means = [1500.0, 3000.0, 6000.0, 12_000.0, 24_000.0];
        let sigmas = [
            288.675_134_594_8,
            577.350_269_189_6,
            1_154.700_538_379,
            2_309.401_076_759,
            4_618.802_153_517,
        ];
        let parts: Vec<UncertainRange> = prior.parts().collect();
        assert_eq!(parts.len(), 5);
        for (part, (mean_m, sigma_m)) in parts.iter().zip(means.into_iter().zip(sigmas)) {
            assert!((part.mean_m - mean_m).abs() < 1e-8, "{part:?}");
            assert!((part.sigma_m - sigma_m).abs() < 1e-8, "{part:?}");
            assert!((part.sigma_m / part.mean_m - 0.192_450_089_729_9).abs() < 1e-12);
        }
    }

    #[test]
    fn the_whole_has_the_moments_of_its_parts() {
        // Parts 1–2 and 2–4: means 1.5 and 3, variances 1/12 and 4/12.
        let prior = RangePrior {
            min_m: 1.0,
            max_m: 4.0,
            ranges: 2,
        };
        let whole = prior.whole();
        assert!((whole.mean_m - 2.25).abs() < 1e-12);
        assert!((whole.sigma_m.powi(2) - (2.5 / 12.0 + 0.5625)).abs() < 1e-12);
    }
}
