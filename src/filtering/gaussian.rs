//! The filter of one Gaussian belief: any motion model, any way through a sensing model.

use super::expected::{Expected, Gain, Way};
use super::smoothing::Passage;
use super::{Corrector, Filter, Reports, Weighted, WithCorrector, mixture};
use crate::model::motion::{Motion, wander};
use crate::model::own::Own;
use crate::model::sensing::{Dispatch, MeasurementModel, Sensing, WithSensing};
use crate::model::state::GaussianState;
use nalgebra::{SMatrix, SVector};
use std::marker::PhantomData;

/// Its states have `N` variables, of which the first `K` are the kinematics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GaussianFilter<M, const N: usize, const K: usize> {
    pub motion: M,
    pub way: Way,
    pub reports: Reports,
    /// Standard deviation of the rates of a new track, where the tracker does not say it.
    pub rate_sigma: Option<f64>,
}

impl<M, const N: usize, const K: usize> GaussianFilter<M, N, K> {
    pub fn new(motion: M, way: Way, reports: Reports) -> Self {
        GaussianFilter {
            motion,
            way,
            reports,
            rate_sigma: None,
        }
    }
}

impl<M: Motion<N>, const N: usize, const K: usize> Filter<K> for GaussianFilter<M, N, K>
where
    MeasurementModel: Dispatch<K>,
{
    type Belief = GaussianState<N>;
    type Step = M::Step;
    type Change = SVector<f64, N>;
    type Loss = SMatrix<f64, N, N>;

    fn step(&self, dt_s: f64) -> M::Step {
        self.motion.step(dt_s)
    }

    #[inline]
    fn predict(step: &M::Step, belief: &mut GaussianState<N>) {
        M::predict(step, belief);
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
        let work = WithFilter {
            way: self.way,
            work,
            filter: PhantomData,
        };
        report.dispatch(work)
    }

    #[inline]
    fn update(
        belief: &mut GaussianState<N>,
        loss: &SMatrix<f64, N, N>,
        detections: &[Weighted<SVector<f64, N>>],
    ) {
        mixture::update(belief, loss, detections.iter().copied());
    }

    fn mean_loss(
        losses: &[SMatrix<f64, N, N>],
        detections: &[Weighted<SVector<f64, N>>],
    ) -> SMatrix<f64, N, N> {
        let weights = detections.iter().map(|detection| detection.weight);
        mixture::mean_loss(losses.iter().zip(weights))
    }

    fn smooth(
        step: &M::Step,
        belief: &GaussianState<N>,
        next: &GaussianState<N>,
    ) -> GaussianState<N> {
        let mut predicted = *belief;
        M::predict(step, &mut predicted);
        let cross = belief.covariance * M::transition(step, &belief.mean).transpose();
        Passage::new(&predicted, &cross).back(belief, next)
    }

    fn begin(&self, kinematics: &GaussianState<K>) -> GaussianState<N> {
        let mut mean = SVector::<f64, N>::zeros();
        let mut covariance =
            SMatrix::<f64, N, N>::from_diagonal_element(self.motion.initial_sigma().powi(2));
        mean.fixed_rows_mut::<K>(0).copy_from(&kinematics.mean);
        covariance
            .fixed_view_mut::<K, K>(0, 0)
            .copy_from(&kinematics.covariance);
        GaussianState { mean, covariance }
    }

    #[inline(always)]
    fn kinematics(belief: &GaussianState<N>) -> GaussianState<K> {
        belief.leading()
    }

    fn pack(belief: &GaussianState<N>, packed: &mut Vec<f64>) {
        belief.pack_into(packed);
    }

    fn unpack(packed: &[f64]) -> Option<GaussianState<N>> {
        GaussianState::unpacked(packed)
    }

    fn rate_variance(&self, dt_s: f64) -> f64 {
        self.motion.rate_variance(dt_s)
    }

    fn most_rate_variance(&self, dt_s: f64, speed_mps: f64) -> f64 {
        wander(&self.motion, dt_s, speed_mps)
    }

    fn white_acceleration(&self) -> Option<f64> {
        self.motion.white_acceleration()
    }

    fn rate_sigma(&self, speed_sigma_mps: f64) -> f64 {
        self.rate_sigma.unwrap_or(speed_sigma_mps)
    }
}

/// Hands the reports of a sensor on as this filter sees them.
struct WithFilter<W, F> {
    way: Way,
    work: W,
    filter: PhantomData<F>,
}

impl<W, M: Motion<N>, const N: usize, const K: usize> WithSensing<K>
    for WithFilter<W, GaussianFilter<M, N, K>>
where
    W: WithCorrector<GaussianFilter<M, N, K>, K>,
    MeasurementModel: Dispatch<K>,
{
    type Output = W::Output;

    fn with<S: Sensing<K, D>, const D: usize>(self, sensing: &S) -> W::Output {
        let way = self.way;
        self.work.with(&Through { way, sensing })
    }
}

/// A sensing model as the filter goes through it.
struct Through<'s, S> {
    way: Way,
    sensing: &'s S,
}

impl<S, M, const N: usize, const K: usize, const D: usize> Corrector<GaussianFilter<M, N, K>, K, D>
    for Through<'_, S>
where
    S: Sensing<K, D>,
    M: Motion<N>,
    MeasurementModel: Dispatch<K>,
{
    type Sensing = S;
    type Gain = Gain<N, D>;

    #[inline(always)]
    fn sensing(&self) -> &S {
        self.sensing
    }

    #[inline(always)]
    fn expect(&self, belief: &GaussianState<N>) -> Option<(Expected<D>, Gain<N, D>)> {
        self.way.expect(belief, self.sensing)
    }

    fn expect_own(
        &self,
        belief: &GaussianState<N>,
        own: &Own,
    ) -> Option<(Expected<D>, Gain<N, D>)> {
        let sensing = self.sensing.with_own(own);
        let at_report = belief.coasted::<K>(own.after_s);
        let (expected, gain) = self.way.expect(&at_report, &sensing)?;
        Some((expected, gain.coasted::<K>(-own.after_s)))
    }

    #[inline(always)]
    fn change(gain: &Gain<N, D>, innovation: &SVector<f64, D>) -> SVector<f64, N> {
        gain.change(innovation)
    }

    #[inline(always)]
    fn loss(gain: &Gain<N, D>) -> SMatrix<f64, N, N> {
        gain.loss()
    }
}
