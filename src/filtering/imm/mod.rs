//! The interacting multiple model filter (IMM): a target moves by one of several models and changes between them now and then.
//! Each model has a state of its own; before each prediction they are mixed by how probable it is that the target came from one
//! to the other, and after each update the models are as probable as the detections say.
//!
//! # Reference
//! H. A. P. Blom, Y. Bar-Shalom, The interacting multiple model algorithm for systems with Markovian switching coefficients, IEEE
//! Transactions on Automatic Control 33(8), 1988; T. Yuan, Y. Bar-Shalom, P. Willett et al., A multiple IMM estimation approach
//! with unbiased mixing for thrusting projectiles, IEEE Transactions on Aerospace and Electronic Systems 48(4), 2012.
//!
//! # Symbols
//! μⱼ probability of model j, x̂ⱼ, Pⱼ its state; Π transition probabilities over T ([`chain`]); eᵢⱼ = P_D N(zᵢ; ẑⱼ, Sⱼ)/λ;
//! βᵢ weight of detection i, β₀ of none.
//!
//! # Method
//! 1. cⱼ = Σᵢ Πᵢⱼ μᵢ, wᵢ = Πᵢⱼ μᵢ/cⱼ; x̂ⱼ ← x̂₀ = Σ wᵢ x̂ᵢ, Pⱼ ← Σ wᵢ (Pᵢ + (x̂ᵢ − x̂₀)(x̂ᵢ − x̂₀)ᵀ). What model i does not have,
//!    j takes from itself. Then each model predicts.
//! 2. To an associator detection i has the likelihood Σⱼ cⱼ eᵢⱼ, and lies where the mixture of the models expects it. It is a
//!    candidate when it is inside the gate of any model with cⱼ > 0.001.
//! 3. μⱼ|ᵢ = cⱼ eᵢⱼ/Σ, μⱼ|₀ = cⱼ; μⱼ ← Σᵢ βᵢ μⱼ|ᵢ, at least 1e-6; model j is updated with the weights βᵢ μⱼ|ᵢ/μⱼ, as any filter is
//!    ([`super::mixture`]). These are the moments of the mixture over all models and events, for hard and for soft association.
//! 4. What is told are the moments of Σ μⱼ N(x̂ⱼ, Pⱼ). The normalised innovation squared is Σⱼ μⱼ|ᵢ νᵢⱼᵀ Sⱼ⁻¹ νᵢⱼ: its mean is the
//!    number of values of a measurement, where the models are honest.
//!
//! Densities are compared as logarithms: models that are all far off are still compared with each other.

pub mod chain;
mod look;
mod mode;
pub mod settings;
mod smooth;

pub use look::{Change, Loss};
pub use mode::{Extra, ModeStep};
pub use settings::{METHOD, Models};

use super::{Corrector, Filter, Reports, Way, Weighted, WithCorrector};
use crate::model::scan::Measurement;
use crate::model::sensing::{Dispatch, MeasurementModel, Sensing, WithSensing};
use crate::model::state::{GaussianState, packed_len};
use look::ImmGain;
use mode::lent;
use nalgebra::{SMatrix, SVector};

/// Probabilities of models stay at or above it, so that none is lost for good.
const LEAST_PROBABILITY: f64 = 1e-6;

/// What a model is taken to be in the variables that another one does not have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mixing {
    /// As it is itself.
    Unbiased,
    /// 0, for certain.
    Zero,
}

/// Of up to `R` models of up to `N` variables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Imm<const R: usize, const N: usize> {
    models: Models,
    generator: SMatrix<f64, R, R>,
    way: Way,
    reports: Reports,
}

/// What is believed of a target; models beyond those that there are have the probability 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Belief<const R: usize, const N: usize> {
    /// μ, after a prediction c.
    pub probabilities: [f64; R],
    pub states: [GaussianState<N>; R],
}

/// What a time does to every belief.
#[derive(Debug, Clone, Copy)]
pub struct Step<const R: usize> {
    transition: SMatrix<f64, R, R>,
    modes: [ModeStep; R],
    count: usize,
    mixing: Mixing,
}

impl<const R: usize> Step<R> {
    /// Π and what each of `R` models does.
    pub fn new(transition: SMatrix<f64, R, R>, modes: [ModeStep; R], mixing: Mixing) -> Self {
        Step {
            transition,
            modes,
            count: R,
            mixing,
        }
    }

    /// Step 1 without the predictions.
    #[inline(always)]
    fn mix<const N: usize>(&self, belief: &mut Belief<R, N>) {
        let before = *belief;
        for to in 0..self.count {
            let mut weights = [0.0; R];
            for (from, weight) in weights.iter_mut().enumerate().take(self.count) {
                *weight = self.transition[(from, to)] * before.probabilities[from];
            }
            let total: f64 = weights.iter().sum();
            belief.probabilities[to] = total;
            weights.iter_mut().for_each(|weight| *weight /= total);
            let own = (&before.states[to], self.modes[to].extra());
            let borrowed = |from: usize| {
                let lender = (&before.states[from], self.modes[from].extra());
                lent(lender, own, self.mixing)
            };
            belief.states[to] = mean_of(&weights, &own.0.mean, borrowed);
        }
    }
}

/// The moments of weighted states; means are summed as differences to `centre`, so that equal ones stay what they are.
#[inline(always)]
fn mean_of<const R: usize, const N: usize>(
    weights: &[f64; R],
    centre: &SVector<f64, N>,
    state: impl Fn(usize) -> GaussianState<N>,
) -> GaussianState<N> {
    let mut shift = SVector::<f64, N>::zeros();
    for (mode, weight) in weights.iter().enumerate() {
        if *weight > 0.0 {
            shift += (state(mode).mean - centre) * *weight;
        }
    }
    let mean = centre + shift;
    let mut covariance = SMatrix::<f64, N, N>::zeros();
    for (mode, weight) in weights.iter().enumerate() {
        if *weight > 0.0 {
            let state = state(mode);
            let apart = state.mean - mean;
            covariance += (state.covariance + apart * apart.transpose()) * *weight;
        }
    }
    GaussianState { mean, covariance }
}

impl<const R: usize, const N: usize> Imm<R, N> {
    /// Of at most `R` models, whose states have at most `N` variables.
    pub fn new(models: Models, way: Way, reports: Reports) -> Self {
        Imm {
            generator: chain::generator(&models.sojourns_s()),
            models,
            way,
            reports,
        }
    }
}

impl<const R: usize, const N: usize> Filter<4> for Imm<R, N> {
    type Belief = Belief<R, N>;
    type Step = Step<R>;
    type Change = Change<R, N>;
    type Loss = Loss<R, N>;

    fn step(&self, dt_s: f64) -> Step<R> {
        Step {
            transition: chain::transition(&self.generator, dt_s),
            modes: std::array::from_fn(|mode| ModeStep::new(self.models.motion(mode), dt_s)),
            count: self.models.count(),
            mixing: self.models.mixing,
        }
    }

    #[inline]
    fn predict(step: &Step<R>, belief: &mut Belief<R, N>) {
        step.mix(belief);
        let states = belief.states.iter_mut().zip(&step.modes);
        for (state, mode) in states.take(step.count) {
            mode.predict(state);
        }
    }

    fn correct<W: WithCorrector<Self, 4>>(
        &self,
        report: &MeasurementModel,
        work: W,
    ) -> Option<W::Output> {
        let report = match self.reports {
            Reports::Converted => report.converted(),
            Reports::Positions | Reports::All => *report,
        };
        report.dispatch(WithImm { imm: self, work })
    }

    #[inline]
    fn update(belief: &mut Belief<R, N>, loss: &Loss<R, N>, detections: &[Weighted<Change<R, N>>]) {
        look::update(belief, loss, detections);
    }

    fn smooth(step: &Step<R>, belief: &Belief<R, N>, next: &Belief<R, N>) -> Belief<R, N> {
        smooth::smooth(step, belief, next)
    }

    fn begin(&self, kinematics: &GaussianState<4>) -> Belief<R, N> {
        let mut belief = Belief {
            probabilities: [0.0; R],
            states: [GaussianState {
                mean: SVector::zeros(),
                covariance: SMatrix::zeros(),
            }; R],
        };
        let probabilities = self.models.initial_probabilities();
        for (mode, model) in self.models.iter().enumerate() {
            belief.probabilities[mode] = probabilities[mode];
            let state = &mut belief.states[mode];
            let (extra, sigma) = (Extra::of(&model.motion), model.motion.initial_sigma());
            for variable in 4..extra.variables() {
                state.covariance[(variable, variable)] = sigma * sigma;
            }
            mode::set_leading(state, kinematics);
        }
        belief
    }

    /// Step 4.
    #[inline]
    fn kinematics(belief: &Belief<R, N>) -> GaussianState<4> {
        let centre = belief.states[0].leading::<4>().mean;
        mean_of(&belief.probabilities, &centre, |mode| {
            belief.states[mode].leading::<4>()
        })
    }

    fn mode_probabilities(belief: &Belief<R, N>) -> &[f64] {
        let count = belief
            .probabilities
            .iter()
            .take_while(|p| **p > 0.0)
            .count();
        &belief.probabilities[..count]
    }

    fn pack(belief: &Belief<R, N>, packed: &mut Vec<f64>) {
        packed.extend_from_slice(&belief.probabilities);
        for state in &belief.states {
            state.pack_into(packed);
        }
    }

    fn unpack(packed: &[f64]) -> Option<Belief<R, N>> {
        let (probabilities, rest) = packed.split_at_checked(R)?;
        let mut chunks = rest.chunks(packed_len(N));
        let states: Option<Vec<GaussianState<N>>> =
            chunks.by_ref().map(GaussianState::unpacked).collect();
        Some(Belief {
            probabilities: probabilities.try_into().ok()?,
            states: states?.try_into().ok()?,
        })
    }

    fn fit(change: &Change<R, N>, _squared_distance: f64) -> f64 {
        change.fit
    }

    /// The mean over the models as they are at the start.
    fn rate_variance(&self, dt_s: f64) -> f64 {
        let probabilities = self.models.initial_probabilities();
        let models = self.models.iter().zip(probabilities);
        models
            .map(|(model, probability)| probability * model.motion.rate_variance(dt_s))
            .sum()
    }

    fn rate_sigma(&self, speed_sigma_mps: f64) -> f64 {
        speed_sigma_mps
    }
}

/// Hands the reports of a sensor on as this filter sees them.
struct WithImm<'f, W, const R: usize, const N: usize> {
    imm: &'f Imm<R, N>,
    work: W,
}

impl<W, const R: usize, const N: usize> WithSensing<4> for WithImm<'_, W, R, N>
where
    W: WithCorrector<Imm<R, N>, 4>,
{
    type Output = W::Output;

    fn with<S: Sensing<4, D>, const D: usize>(self, sensing: &S) -> W::Output {
        let WithImm { imm, work } = self;
        work.with(&Through {
            way: imm.way,
            extras: imm.models.extras(),
            sensing,
        })
    }
}

/// A sensing model as the filter goes through it.
struct Through<'s, S, const R: usize> {
    way: Way,
    /// What each model has beyond the kinematics.
    extras: [Extra; R],
    sensing: &'s S,
}

impl<S, const R: usize, const N: usize, const D: usize> Corrector<Imm<R, N>, 4, D>
    for Through<'_, S, R>
where
    S: Sensing<4, D>,
{
    type Gain = ImmGain<R, N, D>;
    const ANGLE: Option<usize> = S::ANGLE;
    const HAS_REGIONS: bool = true;

    fn read(&self, report: &Measurement) -> Option<SVector<f64, D>> {
        self.sensing.read(report)
    }

    #[inline(always)]
    fn expect(&self, belief: &Belief<R, N>) -> Option<(super::Expected<D>, ImmGain<R, N, D>)> {
        look::expect(belief, &self.extras, &self.way, self.sensing)
    }

    #[inline(always)]
    fn regions(gain: &ImmGain<R, N, D>) -> &[super::Expected<D>] {
        gain.regions()
    }

    #[inline(always)]
    fn assess(
        gain: &ImmGain<R, N, D>,
        _expected: &super::Expected<D>,
        innovation: &SVector<f64, D>,
        _squared_distance: f64,
    ) -> (Change<R, N>, f64) {
        gain.assess(innovation, S::ANGLE)
    }

    #[inline(always)]
    fn change(gain: &ImmGain<R, N, D>, innovation: &SVector<f64, D>) -> Change<R, N> {
        gain.assess(innovation, S::ANGLE).0
    }

    #[inline(always)]
    fn loss(gain: &ImmGain<R, N, D>) -> Loss<R, N> {
        gain.loss()
    }

    #[inline(always)]
    fn log_clutter_scale(&self, expected: &SVector<f64, D>) -> f64 {
        self.sensing.log_clutter_scale(expected)
    }

    fn locate(&self, report: &SVector<f64, D>, rate_sigma: f64) -> Option<GaussianState<4>> {
        self.sensing.locate(report, rate_sigma)
    }
}
