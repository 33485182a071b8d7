//! One step back in time of several models.
//!
//! # Reference
//! The probabilities: C.-J. Kim, Dynamic linear models with Markov-switching, Journal of Econometrics 60, 1994. The kinematics:
//! the best linear estimate that the moments of all models together allow.
//!
//! # Symbols
//! j model at this scan, i at the next one; μⱼ, x̂ⱼ, Pⱼ what was believed here; Π transition probabilities, cᵢ = Σⱼ Πⱼᵢ μⱼ; μᵢ⁺, x̂⁺, P⁺ the models
//! and the kinematics at the next scan in the light of all; x̂ⱼᵢ⁻, Pⱼᵢ⁻ the state of j as i takes it and predicts it, Cⱼᵢ its covariance with
//! x̂ⱼ, to which what i takes from itself adds nothing.
//!
//! # Method
//! 1. wⱼᵢ = Πⱼᵢ μⱼ μᵢ⁺/cᵢ; μⱼ ← Σᵢ wⱼᵢ.
//! 2. x̂, x̂⁻, P, P⁻ and C are the moments of the kinematics over j and i with the weights wⱼᵢ: P⁻ is as large as the models are apart.
//! 3. One step back of these ([`crate::filtering::smoothing`]).
//!
//! Of a single model, and of models that are alike, this is the step of one. A step back within each model would believe each of
//! them for certain, and what a model that sees no turn believes in a turn would spoil the straight course before it.

use super::mode::{ModeMotion, lent, set_leading};
use super::{Belief, Step, kinematics_of};
use crate::filtering::smoothing::Passage;
use crate::model::state::GaussianState;
use nalgebra::{SMatrix, SVector};

/// The way of a target from one model to another.
struct Passing<const K: usize> {
    weight: f64,
    now: GaussianState<K>,
    next: GaussianState<K>,
    cross: SMatrix<f64, K, K>,
}

/// All models of what comes back have the same kinematics.
pub(super) fn smooth<M: ModeMotion<N, K>, const R: usize, const N: usize, const K: usize>(
    step: &Step<M::Step, R>,
    belief: &Belief<R, N>,
    next: &Belief<R, N>,
) -> Belief<R, N> {
    let mut smoothed = *belief;
    let mut passings = Vec::with_capacity(R * R);
    for from in 0..step.count {
        let first = passings.len();
        for to in 0..step.count {
            passings.push(passing::<M, R, N, K>(step, (belief, next), (from, to)));
        }
        let weights = passings[first..].iter().map(|passing| passing.weight);
        smoothed.probabilities[from] = weights.sum();
    }
    let now = moments(&passings, |passing| {
        (&passing.now, &passing.now, &passing.now.covariance)
    });
    let after = moments(&passings, |passing| {
        (&passing.next, &passing.next, &passing.next.covariance)
    });
    let (_, cross) = moments(&passings, |passing| {
        (&passing.now, &passing.next, &passing.cross)
    });
    let now = state_of(now);
    let kinematics =
        Passage::new(&state_of(after), &cross).back(&now, &kinematics_of::<R, N, K>(next));
    for state in smoothed.states.iter_mut().take(step.count) {
        set_leading(state, &kinematics);
    }
    smoothed
}

fn state_of<const K: usize>(
    (mean, covariance): (SVector<f64, K>, SMatrix<f64, K, K>),
) -> GaussianState<K> {
    GaussianState { mean, covariance }
}

/// Of the model `from` at this scan and `to` at the next one.
fn passing<M: ModeMotion<N, K>, const R: usize, const N: usize, const K: usize>(
    step: &Step<M::Step, R>,
    (belief, next): (&Belief<R, N>, &Belief<R, N>),
    (from, to): (usize, usize),
) -> Passing<K> {
    let into = |from: usize| step.transition[(from, to)] * belief.probabilities[from];
    let total: f64 = (0..step.count).map(into).sum();
    let (lender, own) = (M::extra_of(&step.modes[from]), M::extra_of(&step.modes[to]));
    let (state, its) = (&belief.states[from], &belief.states[to]);
    let mut predicted = lent::<N, K>((state, lender), (its, own), step.mixing);
    let transition = M::transition(&step.modes[to], &predicted.mean);
    M::predict(&step.modes[to], &mut predicted);
    let mut shared = state.covariance;
    if lender != own {
        for column in K..N {
            shared.fill_column(column, 0.0);
        }
    }
    Passing {
        weight: into(from) * next.probabilities[to] / total,
        now: state.leading(),
        next: predicted.leading(),
        cross: (shared * transition.transpose())
            .fixed_view::<K, K>(0, 0)
            .into_owned(),
    }
}

/// Two states, and a covariance of theirs.
type Part<'p, const K: usize> = (
    &'p GaussianState<K>,
    &'p GaussianState<K>,
    &'p SMatrix<f64, K, K>,
);

/// The weighted mean of the first states, and the covariance of those with the second ones, of which each passing has a part.
fn moments<'p, const K: usize>(
    passings: &'p [Passing<K>],
    of: impl Fn(&'p Passing<K>) -> Part<'p, K>,
) -> (SVector<f64, K>, SMatrix<f64, K, K>) {
    // Differences to one of them are summed, so that equal ones stay what they are.
    let (mut first, mut second) = (SVector::<f64, K>::zeros(), SVector::<f64, K>::zeros());
    let centre = of(&passings[0]);
    for passing in passings {
        let (one, other, _) = of(passing);
        first += (one.mean - centre.0.mean) * passing.weight;
        second += (other.mean - centre.1.mean) * passing.weight;
    }
    let (first, second) = (centre.0.mean + first, centre.1.mean + second);
    let mut covariance = SMatrix::<f64, K, K>::zeros();
    for passing in passings {
        let (one, other, own) = of(passing);
        let apart = (one.mean - first) * (other.mean - second).transpose();
        covariance += (own + apart) * passing.weight;
    }
    (first, covariance)
}
