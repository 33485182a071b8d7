//! When a way is better than all of its parts, so that these need not be known.
//!
//! Of nearly constant velocity and of positions alone, where a sensor sees the same everywhere.
//!
//! # Symbols
//! A way has the detections 0, 1, …, m − 1 at the times t₀ < t₁ < …; aⱼ is what detection j adds to its score and νⱼ² its normalised
//! innovation squared; σ_v standard deviation of each unknown rate; q spectral density of the acceleration; T time of the window.
//!
//! # Method
//! 1. A part knows less than the whole when it comes to detection j: its S is at least as large, but for 1 + q T/σ_v² by which a rate that
//!    is unknown later is thought to be less spread than one that was unknown before. So j adds at most aⱼ + νⱼ²/2 + ln(1 + q T/σ_v²) to it.
//! 2. As the second detection of a part j finds the rate unknown: it adds at most pⱼ = ln(P_D/λ) − ln(2π σ_v² (tⱼ − tⱼ₋₁)²).
//! 3. A part with detections 0 and 1 lacks a later one; any other has a later one as its second. It may do without the misses of the whole,
//!    and have another root. Its score is below that of the whole by at least
//!    min(minⱼ₌₂ (aⱼ + νⱼ²/2), a₁ + ν₁²/2 + minⱼ₌₂ (aⱼ + νⱼ²/2 − pⱼ)) less Σ νⱼ²/2, what step 1 adds, and those.

use super::OfSensor;
use super::choice::Past;
use super::ways::Rules;
use crate::filtering::Filter;
use crate::model::sensing::MeasurementModel;
use std::f64::consts::TAU;

/// What the parts of all ways have in common.
pub(super) struct Bounds {
    /// ln(P_D/λ).
    log_density: f64,
    /// σ_v².
    rate_variance: f64,
    /// ln(1 + q T/σ_v²).
    wander: f64,
    /// How much more a root may be worth than another.
    log_odds: f64,
}

impl Bounds {
    /// `None` where it is not known how much less parts know.
    pub fn of<F: Filter<K>, const K: usize>(
        rules: &Rules<F>,
        waiting: &OfSensor<K>,
    ) -> Option<Self> {
        let sensor = rules.sensor;
        let is_plain = K == 4
            && sensor.sight.is_none()
            && matches!(sensor.report, MeasurementModel::Position { .. })
            && waiting.layers.iter().all(|layer| layer.scan.own.is_empty());
        let density = rules.filter.white_acceleration().filter(|_| is_plain)?;
        let sigma_mps = rules.lifecycle.initial_speed_sigma_mps;
        let rate_variance = rules.filter.rate_sigma(sigma_mps).powi(2);
        let times_s = waiting.layers.iter().map(|layer| layer.scan.time_s);
        let time_s = times_s.clone().fold(f64::NEG_INFINITY, f64::max)
            - times_s.fold(f64::INFINITY, f64::min);
        let odds = waiting.layers.iter().map(|layer| layer.log_odds);
        Some(Bounds {
            log_density: (sensor.p_d / sensor.clutter_density).ln(),
            rate_variance,
            wander: (density * time_s / rate_variance).ln_1p(),
            log_odds: odds.clone().fold(f64::NEG_INFINITY, f64::max)
                - odds.fold(f64::INFINITY, f64::min),
        })
    }

    /// Step 3.
    pub fn are_parts_worse<B, const K: usize>(
        &self,
        pasts: &[Past<B>],
        waiting: &OfSensor<K>,
    ) -> bool {
        let mut may_gain = self.log_odds;
        let (mut hits, mut last_s) = (0, 0.0);
        let (mut of_second, mut least, mut least_over) = (0.0, f64::INFINITY, f64::INFINITY);
        for past in pasts {
            let time_s = waiting.layers[past.layer as usize].scan.time_s;
            if past.detection.is_none() {
                may_gain -= past.log_ratio;
                continue;
            }
            let half = past.nis.unwrap_or(0.0) / 2.0;
            let most = past.log_ratio + half;
            if hits == 1 {
                of_second = most;
            }
            if hits > 1 {
                let between = TAU * self.rate_variance * (time_s - last_s).powi(2);
                least = least.min(most);
                least_over = least_over.min(most - (self.log_density - between.ln()));
            }
            if hits > 0 {
                may_gain += half + self.wander;
            }
            (hits, last_s) = (hits + 1, time_s);
        }
        // A part that lacks more loses more.
        let must_lose = least.min(of_second + least_over);
        least >= 0.0 && of_second >= 0.0 && must_lose > may_gain
    }
}
