//! The range-parametrised filter: a target that a bearing started is at one of several ranges, and a belief is kept at each until
//! the reports say that it is wrong. All move by the same model, and none becomes another: an IMM whose models never change.
//!
//! # Reference
//! N. Peach, Bearings-only tracking using a set of range-parameterised extended Kalman filters, IEE Proceedings 142(1), 1995.
//!
//! # Method
//! Steps 2 to 4 of [`super`] with equal probabilities at the start; what is left of a belief with less than 0.001 is dropped. A
//! target whose place was told has one belief, and is tracked as by the filter alone.

use super::look::{self, Change, ImmGain, Loss};
use super::mode::{Extra, ModeStep};
use super::{Belief, mean_of};
use crate::filtering::motions::AnyMotion;
use crate::filtering::smoothing::Passage;
use crate::filtering::{Corrector, Expected, Filter, Reports, Way, Weighted, WithCorrector};
use crate::model::motion::{Motion, wander};
use crate::model::own::Own;
use crate::model::sensing::{Dispatch, MAX_RANGES, MeasurementModel, Sensing, WithSensing};
use crate::model::state::GaussianState;
use nalgebra::{SMatrix, SVector};

/// Probability below which a belief is dropped.
const LEAST_KEPT: f64 = 1e-3;

/// Of states that are positions and velocities alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeParametrised {
    pub motion: AnyMotion,
    pub way: Way,
    pub reports: Reports,
}

const PLAIN: [Extra; MAX_RANGES] = [Extra::Nothing; MAX_RANGES];

type Several = Belief<MAX_RANGES, 4>;

impl Filter<4> for RangeParametrised {
    type Belief = Several;
    type Step = ModeStep;
    type Change = Change<MAX_RANGES, 4>;
    type Loss = Loss<MAX_RANGES, 4>;

    fn step(&self, dt_s: f64) -> ModeStep {
        ModeStep::new(&self.motion, dt_s)
    }

    fn predict(step: &ModeStep, belief: &mut Several) {
        for (state, probability) in belief.states.iter_mut().zip(&belief.probabilities) {
            if *probability > 0.0 {
                step.predict(state);
            }
        }
    }

    fn correct<W: WithCorrector<Self, 4>>(
        &self,
        report: &MeasurementModel,
        work: W,
    ) -> Option<W::Output> {
        let way = self.way;
        let report = match self.reports {
            Reports::Converted => report.converted(),
            Reports::Positions | Reports::All => *report,
        };
        report.dispatch(WithRanges { way, work })
    }

    fn update(
        belief: &mut Several,
        loss: &Loss<MAX_RANGES, 4>,
        detections: &[Weighted<Change<MAX_RANGES, 4>>],
    ) {
        look::update(belief, loss, detections);
        drop_improbable(belief);
    }

    fn mean_loss(
        losses: &[Loss<MAX_RANGES, 4>],
        detections: &[Weighted<Change<MAX_RANGES, 4>>],
    ) -> Loss<MAX_RANGES, 4> {
        look::mean_loss(losses, detections)
    }

    /// Each part by itself; what was dropped since was wrong from the start.
    fn smooth(step: &ModeStep, belief: &Several, next: &Several) -> Several {
        let mut smoothed = *belief;
        smoothed.probabilities = next.probabilities;
        for part in 0..MAX_RANGES {
            if next.probabilities[part] > 0.0 {
                let state = &belief.states[part];
                let mut predicted = *state;
                step.predict(&mut predicted);
                let cross = state.covariance * step.transition(&state.mean).transpose();
                smoothed.states[part] =
                    Passage::new(&predicted, &cross).back(state, &next.states[part]);
            }
        }
        smoothed
    }

    fn begin(&self, kinematics: &GaussianState<4>) -> Several {
        among(std::slice::from_ref(kinematics), kinematics)
    }

    fn begin_among(&self, whole: &GaussianState<4>, parts: &[GaussianState<4>]) -> Several {
        if parts.is_empty() {
            self.begin(whole)
        } else {
            among(parts, whole)
        }
    }

    fn kinematics(belief: &Several) -> GaussianState<4> {
        let centre = belief.states[0].mean;
        mean_of(&belief.probabilities, &centre, |part| belief.states[part])
    }

    fn pack(belief: &Several, packed: &mut Vec<f64>) {
        belief.pack_into(packed);
    }

    fn unpack(packed: &[f64]) -> Option<Several> {
        Belief::unpacked(packed)
    }

    fn fit(change: &Change<MAX_RANGES, 4>, _squared_distance: f64) -> f64 {
        change.fit
    }

    fn rate_variance(&self, dt_s: f64) -> f64 {
        Motion::<4>::rate_variance(&self.motion, dt_s)
    }

    fn most_rate_variance(&self, dt_s: f64, speed_mps: f64) -> f64 {
        wander::<_, 4>(&self.motion, dt_s, speed_mps)
    }

    fn rate_sigma(&self, speed_sigma_mps: f64) -> f64 {
        speed_sigma_mps
    }
}

/// Beliefs that are equally probable; `rest` fills the places of those that there are not.
fn among(parts: &[GaussianState<4>], rest: &GaussianState<4>) -> Several {
    let mut belief = Belief {
        probabilities: [0.0; MAX_RANGES],
        states: [*rest; MAX_RANGES],
    };
    let count = parts.len().min(MAX_RANGES);
    for (place, part) in parts.iter().take(MAX_RANGES).enumerate() {
        belief.states[place] = *part;
        belief.probabilities[place] = 1.0 / count as f64;
    }
    belief
}

/// What is left shares the probability; each keeps its place, so that it is known again when it is smoothed.
fn drop_improbable(belief: &mut Several) {
    let mut total = 0.0;
    for probability in &mut belief.probabilities {
        if *probability < LEAST_KEPT {
            *probability = 0.0;
        }
        total += *probability;
    }
    for probability in &mut belief.probabilities {
        *probability /= total;
    }
}

/// Hands the reports of a sensor on.
struct WithRanges<W> {
    way: Way,
    work: W,
}

impl<W: WithCorrector<RangeParametrised, 4>> WithSensing<4> for WithRanges<W> {
    type Output = W::Output;

    fn with<S: Sensing<4, D>, const D: usize>(self, sensing: &S) -> W::Output {
        let way = self.way;
        self.work.with(&Through { way, sensing })
    }
}

struct Through<'s, S> {
    way: Way,
    sensing: &'s S,
}

impl<S: Sensing<4, D>, const D: usize> Corrector<RangeParametrised, 4, D> for Through<'_, S> {
    type Sensing = S;
    type Gain = ImmGain<MAX_RANGES, 4, D>;
    const HAS_REGIONS: bool = true;

    #[inline(always)]
    fn sensing(&self) -> &S {
        self.sensing
    }

    fn expect(&self, belief: &Several) -> Option<(Expected<D>, Self::Gain)> {
        look::expect::<AnyMotion, _, _, _, 4, D>(belief, &PLAIN, &self.way, self.sensing)
    }

    fn expect_own(&self, belief: &Several, own: &Own) -> Option<(Expected<D>, Self::Gain)> {
        let sensing = self.sensing.with_own(own);
        let at_report = belief.coasted::<4>(own.after_s);
        let (expected, gain) =
            look::expect::<AnyMotion, _, _, _, 4, D>(&at_report, &PLAIN, &self.way, &sensing)?;
        Some((expected, gain.coasted::<4>(-own.after_s)))
    }

    fn regions(gain: &Self::Gain) -> &[Expected<D>] {
        gain.regions()
    }

    fn assess(
        gain: &Self::Gain,
        _expected: &Expected<D>,
        innovation: &SVector<f64, D>,
        _squared_distance: f64,
    ) -> (Change<MAX_RANGES, 4>, f64) {
        gain.assess(innovation, S::ANGLE)
    }

    fn change(gain: &Self::Gain, innovation: &SVector<f64, D>) -> Change<MAX_RANGES, 4> {
        gain.assess(innovation, S::ANGLE).0
    }

    fn loss(gain: &Self::Gain) -> [SMatrix<f64, 4, 4>; MAX_RANGES] {
        gain.loss()
    }

    fn parts(&self, report: &SVector<f64, D>, rate_sigma: f64, own: &Own) -> Vec<GaussianState<4>> {
        let sensing = self.sensing.with_own(own);
        sensing.parts(report, rate_sigma)
    }
}
