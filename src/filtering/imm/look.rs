//! What the models of a target expect of a report, what a detection says of them, and the update by weighted detections: steps 2
//! and 3 of [`super`].

#![expect(
    clippy::needless_range_loop,
    reason = "what belongs to a model lies in several arrays"
)]

use super::mode::{Extra, ModeMotion};
use super::{Belief, LEAST_PROBABILITY};
use crate::filtering::expected::{Expected, Gain, Way};
use crate::filtering::{Weighted, mixture};
use crate::math::gaussian::Gaussian;
use crate::model::angle::{difference, wrap};
use crate::model::sensing::Sensing;
use crate::model::state::GaussianState;
use nalgebra::{SMatrix, SVector};

/// A model whose probability is at most this has no gate.
const LEAST_GATED: f64 = 1e-3;

/// What one model expects.
#[derive(Debug, Clone, Copy)]
struct ModeLook<const N: usize, const D: usize> {
    expected: Expected<D>,
    gain: Gain<N, D>,
    /// From ẑⱼ to where the mixture expects the report.
    offset: SVector<f64, D>,
}

/// What makes changes of innovations, which are differences to what the mixture expects.
#[derive(Debug, Clone, Copy)]
pub struct ImmGain<const R: usize, const N: usize, const D: usize> {
    modes: [ModeLook<N, D>; R],
    /// c.
    probabilities: [f64; R],
    /// What the models expect that have a gate, in their order.
    regions: [Expected<D>; R],
    region_count: usize,
}

/// What a detection changes, were it certain.
#[derive(Debug, Clone, Copy)]
pub struct Change<const R: usize, const N: usize> {
    /// Kⱼ νᵢⱼ.
    shifts: [SVector<f64, N>; R],
    /// μⱼ|ᵢ.
    probabilities: [f64; R],
    /// The normalised innovation squared.
    pub(super) fit: f64,
}

/// Kⱼ Sⱼ Kⱼᵀ.
pub type Loss<const R: usize, const N: usize> = [SMatrix<f64, N, N>; R];

/// What a model expects: compiled by itself, for it is large and asked for in several places.
#[inline(never)]
fn look_by<M, S, const N: usize, const K: usize, const D: usize>(
    extra: Extra,
    state: &GaussianState<N>,
    way: &Way,
    sensing: &S,
) -> Option<ModeLook<N, D>>
where
    M: ModeMotion<N, K>,
    S: Sensing<K, D>,
{
    let (expected, gain) = M::expect(extra, state, way, sensing)?;
    Some(ModeLook {
        expected,
        gain,
        offset: SVector::zeros(),
    })
}

/// What all models expect of a report, and the moments of that. `None` when an S is not positive definite.
#[inline(never)]
pub(super) fn expect<M, S, const R: usize, const N: usize, const K: usize, const D: usize>(
    belief: &Belief<R, N>,
    extras: &[Extra; R],
    way: &Way,
    sensing: &S,
) -> Option<(Expected<D>, ImmGain<R, N, D>)>
where
    M: ModeMotion<N, K>,
    S: Sensing<K, D>,
{
    let look_by = look_by::<M, S, N, K, D>;
    let first = look_by(extras[0], &belief.states[0], way, sensing)?;
    let mut gain = ImmGain {
        modes: [first; R],
        probabilities: belief.probabilities,
        regions: [first.expected; R],
        region_count: 0,
    };
    for mode in 0..R {
        let probability = belief.probabilities[mode];
        if mode > 0 && probability > 0.0 {
            gain.modes[mode] = look_by(extras[mode], &belief.states[mode], way, sensing)?;
        }
        if probability > LEAST_GATED {
            gain.regions[gain.region_count] = gain.modes[mode].expected;
            gain.region_count += 1;
        }
    }
    let expected = gain.centre(S::ANGLE)?;
    Some((expected, gain))
}

impl<const R: usize, const N: usize, const D: usize> ImmGain<R, N, D> {
    #[inline(always)]
    pub fn regions(&self) -> &[Expected<D>] {
        &self.regions[..self.region_count]
    }

    /// Of the states after `dt_s`, as [`Gain::coasted`].
    pub fn coasted<const K: usize>(mut self, dt_s: f64) -> Self {
        for look in &mut self.modes {
            look.gain = look.gain.coasted::<K>(dt_s);
        }
        self
    }

    /// The moments of Σ cⱼ N(ẑⱼ, Sⱼ); notes how far each ẑⱼ is from its centre.
    #[inline(always)]
    fn centre(&mut self, angle: Option<usize>) -> Option<Expected<D>> {
        let first = self.modes[0].expected.measurement;
        let mut apart = [SVector::<f64, D>::zeros(); R];
        let mut shift = SVector::<f64, D>::zeros();
        for mode in 1..R {
            apart[mode] = difference(&self.modes[mode].expected.measurement, &first, angle);
            shift += apart[mode] * self.probabilities[mode];
        }
        let mut covariance = SMatrix::<f64, D, D>::zeros();
        for mode in 0..R {
            let offset = shift - apart[mode];
            self.modes[mode].offset = offset;
            let of_mode = self.modes[mode].expected.covariance + offset * offset.transpose();
            covariance += of_mode * self.probabilities[mode];
        }
        let mut measurement = first + shift;
        if let Some(value) = angle {
            measurement[value] = wrap(measurement[value]);
        }
        Some(Expected {
            measurement,
            covariance,
            gaussian: Gaussian::new(&covariance)?,
        })
    }

    /// What a detection with this innovation changes, and ln Σ cⱼ N(z; ẑⱼ, Sⱼ).
    #[inline(never)]
    pub fn assess(
        &self,
        innovation: &SVector<f64, D>,
        angle: Option<usize>,
    ) -> (Change<R, N>, f64) {
        let mut change = Change {
            shifts: [SVector::zeros(); R],
            probabilities: self.probabilities,
            fit: 0.0,
        };
        let (mut squares, mut logs) = ([0.0; R], [f64::NEG_INFINITY; R]);
        for mode in 0..R {
            if self.probabilities[mode] > 0.0 {
                let look = &self.modes[mode];
                let of_mode = difference(innovation, &-look.offset, angle);
                squares[mode] = look.expected.gaussian.squared_distance(&of_mode);
                logs[mode] = look.expected.gaussian.log_density(squares[mode]);
                change.shifts[mode] = look.gain.change(&of_mode);
            }
        }
        let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut total = 0.0;
        if largest > f64::NEG_INFINITY {
            for mode in 0..R {
                change.probabilities[mode] *= (logs[mode] - largest).exp();
                total += change.probabilities[mode];
            }
        } else {
            total = 1.0;
        }
        for mode in 0..R {
            change.probabilities[mode] /= total;
            change.fit += change.probabilities[mode] * squares[mode];
        }
        (change, largest + total.ln())
    }

    #[inline(never)]
    pub fn loss(&self) -> Loss<R, N> {
        std::array::from_fn(|mode| self.modes[mode].gain.loss())
    }
}

/// Of each model, by the weights with which step 3 updates it.
pub(super) fn mean_loss<const R: usize, const N: usize>(
    losses: &[Loss<R, N>],
    detections: &[Weighted<Change<R, N>>],
) -> Loss<R, N> {
    std::array::from_fn(|mode| {
        let of_mode = losses.iter().zip(detections).map(|(loss, detection)| {
            let weight = detection.weight * detection.change.probabilities[mode];
            (&loss[mode], weight)
        });
        mixture::mean_loss(of_mode)
    })
}

/// Step 3.
#[inline(always)]
pub(super) fn update<const R: usize, const N: usize>(
    belief: &mut Belief<R, N>,
    loss: &Loss<R, N>,
    detections: &[Weighted<Change<R, N>>],
) {
    if detections.is_empty() {
        return;
    }
    let detected: f64 = detections.iter().map(|detection| detection.weight).sum();
    let missed = (1.0 - detected).max(0.0);
    for mode in 0..R {
        let before = belief.probabilities[mode];
        if before == 0.0 {
            continue;
        }
        let of_mode = |detection: &Weighted<Change<R, N>>| {
            detection.weight * detection.change.probabilities[mode]
        };
        let probability = missed * before + detections.iter().map(of_mode).sum::<f64>();
        if probability > 0.0 {
            let of_mode = detections.iter().map(|detection| Weighted {
                change: detection.change.shifts[mode],
                weight: of_mode(detection) / probability,
            });
            mixture::update(&mut belief.states[mode], &loss[mode], of_mode);
        }
        belief.probabilities[mode] = probability.max(LEAST_PROBABILITY);
    }
    let total: f64 = belief.probabilities.iter().sum();
    belief
        .probabilities
        .iter_mut()
        .for_each(|probability| *probability /= total);
}
