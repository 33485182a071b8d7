//! The cross-covariance of the errors of two tracks: both filters meet the same process noise, so that their errors are not
//! independent, and the difference of two tracks of one target is smaller than P_i + P_j says.
//!
//! # Reference
//! Y. Bar-Shalom, On the track-to-track correlation problem, IEEE Transactions on Automatic Control 26, 1981; Y. Bar-Shalom,
//! L. Campo, The effect of the common process noise on the two-sensor fused-track covariance, IEEE Transactions on Aerospace and
//! Electronic Systems 22, 1986.
//!
//! # Symbols
//! P_i covariance of a track, P_ij cross-covariance of two; F, Q transition and process noise; K, H gain and measurement matrix of
//! an update; ρ a coefficient of correlation.
//!
//! # Method
//! - `coefficient`: P_ij = ρ √P_i √P_jᵀ with the symmetric square roots. For |ρ| < 1 the joint covariance of the two is positive
//!   definite. It is an assumption, the same for all pairs and times.
//! - `recursion` (1981): P_ij ← F P_ij Fᵀ + Q from one time to the next, and at an update of track i P_ij ← (I − K H) P_ij, of
//!   track j P_ij ← P_ij (I − K H)ᵀ; 0 at the start of the later of the two. Tracks do not carry gains, but a Kalman filter's
//!   I − K H is P(l|l) P(l|l−1)⁻¹, and P(l|l−1) follows from the point before with the same Q. So it is exact for tracks of a linear
//!   filter whose process noise is the given one and which never blended detections; for others it is an approximation.

use super::alignment::transition;
use super::estimates::Estimates;
use crate::model::motion::constant_velocity::ConstantVelocity;
use crate::model::state::Covariance;
use crate::model::track::{Track, TrackPoint};
use nalgebra::SymmetricEigen;
use std::collections::BTreeMap;

/// P_ij of linked pairs at every common time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CrossTable {
    of_pair: BTreeMap<(u32, u32), Vec<Covariance>>,
}

impl CrossTable {
    /// P_ij = ρ √P_i √P_j; 0 where one of the two says nothing.
    pub fn with_coefficient(estimates: &Estimates, pairs: &[(u32, u32)], coefficient: f64) -> Self {
        let roots: Vec<Option<Covariance>> = (0..estimates.tracks() as u32)
            .flat_map(|track| estimates.of_track(track))
            .map(|estimate| {
                estimate
                    .as_ref()
                    .map(|estimate| square_root(&estimate.covariance))
            })
            .collect();
        let times = estimates.times();
        let at = |(a, b): (u32, u32), time: usize| {
            let (left, right) = (a as usize * times + time, b as usize * times + time);
            match (roots[left], roots[right]) {
                (Some(left), Some(right)) => left * right * coefficient,
                _ => Covariance::zeros(),
            }
        };
        let of_pair = pairs
            .iter()
            .map(|&pair| (pair, (0..times).map(|time| at(pair, time)).collect()))
            .collect();
        CrossTable { of_pair }
    }

    /// Bar-Shalom's recursion over the points of both tracks; `tracks` in the numbering of the estimates.
    pub fn by_recursion(
        estimates: &Estimates,
        tracks: &[&Track],
        pairs: &[(u32, u32)],
        process_noise_m2ps3: f64,
    ) -> Self {
        let motion = ConstantVelocity {
            spectral_density: process_noise_m2ps3,
        };
        let of = |&(a, b): &(u32, u32)| {
            (
                (a, b),
                recursion(
                    [tracks[a as usize], tracks[b as usize]],
                    &estimates.times_s,
                    motion,
                ),
            )
        };
        CrossTable {
            of_pair: pairs.iter().map(of).collect(),
        }
    }

    /// By time, for a < b.
    pub fn of_pair(&self, a: u32, b: u32) -> Option<&[Covariance]> {
        self.of_pair.get(&(a, b)).map(Vec::as_slice)
    }

    /// The cross-covariance of the errors of `a` with those of `b`; 0 for a pair that is not in the table.
    pub fn at(&self, a: u32, b: u32, time: usize) -> Covariance {
        match (self.of_pair(a, b), self.of_pair(b, a)) {
            (Some(series), _) => series[time],
            (None, Some(series)) => series[time].transpose(),
            (None, None) => Covariance::zeros(),
        }
    }
}

/// The symmetric square root.
fn square_root(covariance: &Covariance) -> Covariance {
    let SymmetricEigen {
        eigenvectors,
        eigenvalues,
    } = SymmetricEigen::new(*covariance);
    eigenvectors
        * Covariance::from_diagonal(&eigenvalues.map(|value| value.max(0.0).sqrt()))
        * eigenvectors.transpose()
}

/// An update of one of the two tracks: when, which of them, and I − K H.
type Update = (f64, usize, Covariance);

/// P_ij of two tracks at the common times.
fn recursion(tracks: [&Track; 2], times_s: &[f64], motion: ConstantVelocity) -> Vec<Covariance> {
    let starts_s = tracks.map(|track| {
        track
            .points
            .first()
            .map_or(f64::INFINITY, |point| point.time_s)
    });
    let start_s = starts_s[0].max(starts_s[1]);
    let mut updates: Vec<Update> = (0..2)
        .flat_map(|side| updates_of(tracks[side], side, motion))
        .filter(|(time_s, ..)| *time_s > start_s)
        .collect();
    updates.sort_by(|left, right| left.0.total_cmp(&right.0));
    let mut cross = Covariance::zeros();
    let (mut now_s, mut next) = (start_s, 0);
    let advance = |cross: &mut Covariance, from_s: f64, to_s: f64| {
        if to_s > from_s {
            let transition = transition(to_s - from_s);
            *cross = transition * *cross * transition.transpose()
                + motion.process_noise::<4>(to_s - from_s);
        }
    };
    let mut series = Vec::with_capacity(times_s.len());
    for &time_s in times_s {
        while let Some((at_s, side, kept)) =
            updates.get(next).filter(|update| update.0 <= time_s + 1e-6)
        {
            advance(&mut cross, now_s, *at_s);
            cross = if *side == 0 {
                kept * cross
            } else {
                cross * kept.transpose()
            };
            (now_s, next) = (now_s.max(*at_s), next + 1);
        }
        let mut at_time = cross;
        if time_s > start_s {
            advance(&mut at_time, now_s, time_s);
        }
        series.push(at_time);
    }
    series
}

/// I − K H = P(l|l) P(l|l−1)⁻¹ of every point but the first.
fn updates_of(track: &Track, side: usize, motion: ConstantVelocity) -> Vec<Update> {
    let mut updates = Vec::new();
    for pair in track.points.windows(2) {
        let factor = update_factor(&pair[0], &pair[1], motion);
        updates.extend(factor.map(|factor| (pair[1].time_s, side, factor)));
    }
    updates
}

/// I − K H of the update at a point, as P(l|l) P(l|l−1)⁻¹.
fn update_factor(
    before: &TrackPoint,
    now: &TrackPoint,
    motion: ConstantVelocity,
) -> Option<Covariance> {
    let dt_s = now.time_s - before.time_s;
    let transition = transition(dt_s);
    let predicted = transition * before.estimate.covariance()? * transition.transpose()
        + motion.process_noise::<4>(dt_s);
    Some(now.estimate.covariance()? * predicted.try_inverse()?)
}
