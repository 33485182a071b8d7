//! Which pairs of tracks of different sensors may be of one target at all: those that are near each other at some common time.
//!
//! # Symbols
//! g a squared distance; σ² = P_xx the variance of a track's x; r = √g σ.
//!
//! # Method
//! d² = tᵀ (P_i + P_j)⁻¹ t of a pair is at least t_x² / (P_xx,i + P_xx,j): d² ≤ g at a time needs |t_x| ≤ √(g (σ_i² + σ_j²)) ≤
//! r_i + r_j, which is to say that the intervals x ± r overlap there. The intervals of each time are swept in the order of their lower
//! ends, and y is looked at where those of x overlap. A sum of k distances of at most k g has one of at most g: every pair
//! whose mean over time is within the gate is found.

use super::estimates::{AlignedEstimate, Estimates};

/// The interval of one track at one time.
struct Reach<'a> {
    low: f64,
    high: f64,
    track: u32,
    estimate: &'a AlignedEstimate,
}

/// The pairs, ascending, each once with the lower number first; `None` when there are more than `limit` to be looked at.
pub fn candidates(estimates: &Estimates, gate: f64, limit: usize) -> Option<Vec<(u32, u32)>> {
    let sensors = estimates.sensors_of_tracks();
    let mut found = Vec::new();
    for time in 0..estimates.times() {
        let mut reaches: Vec<Reach> = (0..estimates.tracks() as u32)
            .filter_map(|track| reach(estimates, track, time, gate))
            .collect();
        reaches.sort_by(|left, right| {
            left.low
                .total_cmp(&right.low)
                .then(left.track.cmp(&right.track))
        });
        for (index, left) in reaches.iter().enumerate() {
            let overlapping = reaches[index + 1..]
                .iter()
                .take_while(|right| right.low <= left.high);
            let near = overlapping.filter(|right| {
                sensors[left.track as usize] != sensors[right.track as usize]
                    && is_near(left, right, gate)
            });
            found.extend(
                near.map(|right| (left.track.min(right.track), left.track.max(right.track))),
            );
            // Pairs of one time are all different: as many of this time alone are too many.
            if found.len() > 2 * limit {
                return None;
            }
        }
        found.sort_unstable();
        found.dedup();
        if found.len() > limit {
            return None;
        }
    }
    Some(found)
}

fn reach(estimates: &Estimates, track: u32, time: usize, gate: f64) -> Option<Reach<'_>> {
    let estimate = estimates.at(track, time)?;
    let reach_m = (gate * estimate.covariance[(0, 0)]).sqrt();
    Some(Reach {
        low: estimate.mean[0] - reach_m,
        high: estimate.mean[0] + reach_m,
        track,
        estimate,
    })
}

fn is_near(left: &Reach, right: &Reach, gate: f64) -> bool {
    let (left, right) = (left.estimate, right.estimate);
    (0..2).all(|axis| {
        let variance = left.covariance[(axis, axis)] + right.covariance[(axis, axis)];
        (left.mean[axis] - right.mean[axis]).powi(2) <= gate * variance
    })
}
