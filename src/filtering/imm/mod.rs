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
mod ranges;
pub mod settings;
mod smooth;

pub use look::{Change, Loss};
pub use mode::{Extra, ModeMotion, ModeStep, expect_leading, on_leading};
pub use ranges::RangeParametrised;
pub use settings::{METHOD, Models};

use super::motions::AnyMotion;
use super::{Corrector, Filter, Reports, Way, Weighted, WithCorrector};
use crate::model::motion::wander;
use crate::model::own::Own;
use crate::model::sensing::{Dispatch, MeasurementModel, Sensing, WithSensing};
use crate::model::state::{GaussianState, packed_len};
use look::ImmGain;
use mode::lent;
use nalgebra::{SMatrix, SVector};
use std::marker::PhantomData;

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

/// Of up to `R` models of up to `N` variables, of which the first `K` are the kinematics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interacting<M, const R: usize, const N: usize, const K: usize> {
    models: Models,
    motions: [M; R],
    generator: SMatrix<f64, R, R>,
    way: Way,
    reports: Reports,
}

/// Of targets in the plane.
pub type Imm<const R: usize, const N: usize> = Interacting<AnyMotion, R, N, 4>;

/// What is believed of a target; models beyond those that there are have the probability 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Belief<const R: usize, const N: usize> {
    /// μ, after a prediction c.
    pub probabilities: [f64; R],
    pub states: [GaussianState<N>; R],
}

impl<const R: usize, const N: usize> Belief<R, N> {
    /// As [`GaussianState::coasted`], of each model.
    fn coasted<const K: usize>(&self, dt_s: f64) -> Self {
        Belief {
            states: self.states.map(|state| state.coasted::<K>(dt_s)),
            ..*self
        }
    }

    fn pack_into(&self, packed: &mut Vec<f64>) {
        packed.extend_from_slice(&self.probabilities);
        for state in &self.states {
            state.pack_into(packed);
        }
    }

    fn unpacked(packed: &[f64]) -> Option<Self> {
        let (probabilities, rest) = packed.split_at_checked(R)?;
        let chunks = rest.chunks(packed_len(N));
        let states: Option<Vec<GaussianState<N>>> = chunks.map(GaussianState::unpacked).collect();
        Some(Belief {
            probabilities: probabilities.try_into().ok()?,
            states: states?.try_into().ok()?,
        })
    }
}

/// What a time does to every belief.
#[derive(Debug, Clone, Copy)]
pub struct Step<S, const R: usize> {
    transition: SMatrix<f64, R, R>,
    modes: [S; R],
    count: usize,
    mixing: Mixing,
}

impl<S, const R: usize> Step<S, R> {
    /// Π and what each of `R` models does.
    pub fn new(transition: SMatrix<f64, R, R>, modes: [S; R], mixing: Mixing) -> Self {
        Step {
            transition,
            modes,
            count: R,
            mixing,
        }
    }

    /// Step 1 without the predictions.
    #[inline(always)]
    fn mix<M, const N: usize, const K: usize>(&self, belief: &mut Belief<R, N>)
    where
        M: ModeMotion<N, K, Step = S>,
    {
        let before = *belief;
        for to in 0..self.count {
            let mut weights = [0.0; R];
            for (from, weight) in weights.iter_mut().enumerate().take(self.count) {
                *weight = self.transition[(from, to)] * before.probabilities[from];
            }
            let total: f64 = weights.iter().sum();
            belief.probabilities[to] = total;
            weights.iter_mut().for_each(|weight| *weight /= total);
            let own = (&before.states[to], M::extra_of(&self.modes[to]));
            let borrowed = |from: usize| {
                let lender = (&before.states[from], M::extra_of(&self.modes[from]));
                lent::<N, K>(lender, own, self.mixing)
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

/// Step 4.
#[inline]
fn kinematics_of<const R: usize, const N: usize, const K: usize>(
    belief: &Belief<R, N>,
) -> GaussianState<K> {
    let centre = belief.states[0].leading::<K>().mean;
    mean_of(&belief.probabilities, &centre, |mode| {
        belief.states[mode].leading::<K>()
    })
}

impl<const R: usize, const N: usize> Imm<R, N> {
    /// Of at most `R` models, whose states have at most `N` variables.
    pub fn new(models: Models, way: Way, reports: Reports) -> Self {
        Interacting::of_motions(models, |motion| *motion, way, reports)
    }
}

impl<M: ModeMotion<N, K>, const R: usize, const N: usize, const K: usize> Interacting<M, R, N, K> {
    /// Of at most `R` models, whose states have at most `N` variables; `make` makes the motion of each.
    pub fn of_motions(
        models: Models,
        make: impl Fn(&AnyMotion) -> M,
        way: Way,
        reports: Reports,
    ) -> Self {
        Interacting {
            generator: chain::generator(&models.sojourns_s()),
            motions: std::array::from_fn(|mode| make(models.motion(mode))),
            models,
            way,
            reports,
        }
    }
}

impl<M: ModeMotion<N, K>, const R: usize, const N: usize, const K: usize> Filter<K>
    for Interacting<M, R, N, K>
where
    MeasurementModel: Dispatch<K>,
{
    type Belief = Belief<R, N>;
    type Step = Step<M::Step, R>;
    type Change = Change<R, N>;
    type Loss = Loss<R, N>;

    fn step(&self, dt_s: f64) -> Self::Step {
        Step {
            transition: chain::transition(&self.generator, dt_s),
            modes: self.motions.map(|motion| motion.step(dt_s)),
            count: self.models.count(),
            mixing: self.models.mixing,
        }
    }

    #[inline]
    fn predict(step: &Self::Step, belief: &mut Belief<R, N>) {
        step.mix::<M, N, K>(belief);
        let states = belief.states.iter_mut().zip(&step.modes);
        for (state, mode) in states.take(step.count) {
            M::predict(mode, state);
        }
    }

    fn correct<W: WithCorrector<Self, K>>(
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

    fn mean_loss(losses: &[Loss<R, N>], detections: &[Weighted<Change<R, N>>]) -> Loss<R, N> {
        look::mean_loss(losses, detections)
    }

    fn smooth(step: &Self::Step, belief: &Belief<R, N>, next: &Belief<R, N>) -> Belief<R, N> {
        smooth::smooth::<M, R, N, K>(step, belief, next)
    }

    fn begin(&self, kinematics: &GaussianState<K>) -> Belief<R, N> {
        let mut belief = Belief {
            probabilities: [0.0; R],
            states: [GaussianState {
                mean: SVector::zeros(),
                covariance: SMatrix::zeros(),
            }; R],
        };
        let probabilities = self.models.initial_probabilities();
        for (mode, motion) in self.motions.iter().enumerate().take(self.models.count()) {
            belief.probabilities[mode] = probabilities[mode];
            let state = &mut belief.states[mode];
            let (extra, sigma) = (motion.extra(), motion.initial_sigma());
            for variable in K..extra.variables(K) {
                state.covariance[(variable, variable)] = sigma * sigma;
            }
            mode::set_leading(state, kinematics);
        }
        belief
    }

    /// Step 4.
    #[inline]
    fn kinematics(belief: &Belief<R, N>) -> GaussianState<K> {
        kinematics_of(belief)
    }

    fn mode_probabilities(belief: &Belief<R, N>) -> &[f64] {
        if R == 1 {
            return &[];
        }
        let count = belief
            .probabilities
            .iter()
            .take_while(|p| **p > 0.0)
            .count();
        &belief.probabilities[..count]
    }

    fn pack(belief: &Belief<R, N>, packed: &mut Vec<f64>) {
        belief.pack_into(packed);
    }

    fn unpack(packed: &[f64]) -> Option<Belief<R, N>> {
        Belief::unpacked(packed)
    }

    fn fit(change: &Change<R, N>, _squared_distance: f64) -> f64 {
        change.fit
    }

    /// The mean over the models as they are at the start.
    fn rate_variance(&self, dt_s: f64) -> f64 {
        let probabilities = self.models.initial_probabilities();
        let motions = self.motions.iter().take(self.models.count());
        motions
            .zip(probabilities)
            .map(|(motion, probability)| probability * motion.rate_variance(dt_s))
            .sum()
    }

    fn most_rate_variance(&self, dt_s: f64, speed_mps: f64) -> f64 {
        let motions = self.motions.iter().take(self.models.count());
        let of_each = motions.map(|motion| wander(motion, dt_s, speed_mps));
        of_each.fold(0.0, f64::max)
    }

    fn rate_sigma(&self, speed_sigma_mps: f64) -> f64 {
        speed_sigma_mps
    }
}

/// Hands the reports of a sensor on as this filter sees them.
struct WithImm<'f, W, M, const R: usize, const N: usize, const K: usize> {
    imm: &'f Interacting<M, R, N, K>,
    work: W,
}

impl<W, M, const R: usize, const N: usize, const K: usize> WithSensing<K>
    for WithImm<'_, W, M, R, N, K>
where
    M: ModeMotion<N, K>,
    W: WithCorrector<Interacting<M, R, N, K>, K>,
    MeasurementModel: Dispatch<K>,
{
    type Output = W::Output;

    fn with<S: Sensing<K, D>, const D: usize>(self, sensing: &S) -> W::Output {
        let WithImm { imm, work } = self;
        work.with(&Through {
            way: imm.way,
            extras: imm.motions.map(|motion| motion.extra()),
            sensing,
            motion: PhantomData::<M>,
        })
    }
}

/// A sensing model as the filter goes through it.
struct Through<'s, S, M, const R: usize> {
    way: Way,
    /// What each model has beyond the kinematics.
    extras: [Extra; R],
    sensing: &'s S,
    motion: PhantomData<M>,
}

impl<S, M, const R: usize, const N: usize, const K: usize, const D: usize>
    Corrector<Interacting<M, R, N, K>, K, D> for Through<'_, S, M, R>
where
    S: Sensing<K, D>,
    M: ModeMotion<N, K>,
    MeasurementModel: Dispatch<K>,
{
    type Sensing = S;
    type Gain = ImmGain<R, N, D>;
    const HAS_REGIONS: bool = true;

    #[inline(always)]
    fn sensing(&self) -> &S {
        self.sensing
    }

    #[inline(always)]
    fn expect(&self, belief: &Belief<R, N>) -> Option<(super::Expected<D>, ImmGain<R, N, D>)> {
        look::expect::<M, S, R, N, K, D>(belief, &self.extras, &self.way, self.sensing)
    }

    fn expect_own(
        &self,
        belief: &Belief<R, N>,
        own: &Own,
    ) -> Option<(super::Expected<D>, ImmGain<R, N, D>)> {
        let sensing = self.sensing.with_own(own);
        let at_report = belief.coasted::<K>(own.after_s);
        let (expected, gain) =
            look::expect::<M, S, R, N, K, D>(&at_report, &self.extras, &self.way, &sensing)?;
        Some((expected, gain.coasted::<K>(-own.after_s)))
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
}
