//! How many detections confirm a track, where the request leaves it open and P_D was estimated from the data.
//!
//! # Method
//! A rule M of N is met within the first N scans by a share Σ_{k ≥ M} C(N, k) P_D^k (1 − P_D)^(N − k) of the targets. The stricter it is,
//! the fewer false tracks: so M is the largest below N that three targets of four meet, with the lowest P_D that was estimated, and at least
//! what is usual.

use super::estimates::Estimate;
use crate::experiment::request::methods::TrackerSpec;
use crate::tracking::{Confirmation, Lifecycle};

/// Share of the targets that meet the rule in their first scans.
const PROMPT: f64 = 0.75;

/// M, if it is more than usual, and that it was taken.
pub fn hits(
    tracker: &TrackerSpec,
    estimates: &[Estimate],
    warnings: &mut Vec<String>,
) -> Option<u32> {
    let lifecycle = &tracker.lifecycle;
    if !tracker.leaves_hits_open || lifecycle.confirmation != Confirmation::MOfN {
        return None;
    }
    let estimated = estimates
        .iter()
        .filter(|estimate| estimate.setting == "p_d");
    let p_d = estimated.map(|estimate| estimate.value).reduce(f64::min)?;
    let window = lifecycle.confirm_window;
    let hits = most_hits(p_d, window);
    (hits > Lifecycle::USUAL_HITS).then(|| {
        warnings.push(format!(
            "confirm_hits {hits} of {window} scans is the most that three targets of four meet at the estimated P_D {p_d:.2}; give it in \
             /tracker/confirm_hits to fix it"
        ));
        hits
    })
}

/// The largest M below N that so many targets meet.
fn most_hits(p_d: f64, window: u32) -> u32 {
    let (mut share, mut hits) = (0.0, window);
    // C(N, k) for k = N, N − 1, …
    let mut ways = 1.0;
    while hits > 0 {
        share += ways * p_d.powi(hits as i32) * (1.0 - p_d).powi((window - hits) as i32);
        if share >= PROMPT {
            return hits.min(window - 1);
        }
        ways *= f64::from(hits) / f64::from(window - hits + 1);
        hits -= 1;
    }
    0
}

#[cfg(test)]
mod tests {
    use super::most_hits;

    #[test]
    fn the_rule_is_the_strictest_that_three_targets_of_four_meet() {
        // At 0.8 of five: all five 0.328, four 0.737, three 0.942. At 0.81: four 0.758. One may always lack.
        let of_five = [0.5, 0.8, 0.81, 0.99, 1.0].map(|p_d| most_hits(p_d, 5));
        assert_eq!(of_five, [2, 3, 4, 4, 4]);
        // Six of eight at 0.8: 0.797; seven 0.503.
        assert_eq!(most_hits(0.8, 8), 6);
    }
}
