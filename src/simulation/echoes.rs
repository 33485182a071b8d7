//! How strong echoes are. A square-law detector lets pass what exceeds its threshold; the power of noise alone is exponential, and so
//! is that of a target whose echo fluctuates from scan to scan as Swerling's first model has it.
//!
//! # Reference
//! P. Swerling, Probability of detection for fluctuating targets, IRE Trans. Information Theory 6, 1960; Y. Bar-Shalom, X.-R. Li,
//! Multitarget-Multisensor Tracking, 1995, section 2.6: amplitudes of false detections and of targets.
//!
//! # Symbols
//! a power of an echo in units of the noise's mean; s mean signal-to-noise ratio as a factor; τ threshold.
//!
//! # Method
//! - Noise has the density e^(−a), a target e^(−a/(1+s)) / (1 + s). So P_D = e^(−τ/(1+s)), and τ = −(1 + s) ln P_D.
//! - What has passed the threshold is τ + (1 + s) e of a target and τ + e of a false detection, e exponential with mean 1: an
//!   exponential has no memory.

use crate::model::scenario::ScenarioSensor;
use rand::Rng;
use rand_distr::{Distribution, Exp1};

/// The detector of a sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Echoes {
    /// 1 + s.
    mean_of_target: f64,
    /// τ.
    threshold: f64,
}

impl Echoes {
    /// `None` of a sensor that does not tell how strong echoes are.
    pub fn of(sensor: &ScenarioSensor) -> Option<Self> {
        let mean_of_target = 1.0 + 10f64.powf(sensor.snr_db? / 10.0);
        Some(Echoes {
            mean_of_target,
            threshold: -mean_of_target * sensor.p_d.ln(),
        })
    }

    /// a of a target that was detected.
    pub fn of_target(&self, draw: &mut impl Rng) -> f64 {
        let excess: f64 = Exp1.sample(draw);
        self.threshold + self.mean_of_target * excess
    }

    /// a of a false detection.
    pub fn of_noise(&self, draw: &mut impl Rng) -> f64 {
        let excess: f64 = Exp1.sample(draw);
        self.threshold + excess
    }
}

#[cfg(test)]
mod tests {
    use crate::math::rng::Seed;
    use crate::model::scenario::Scenario;
    use crate::simulation::{check, simulate};
    use serde_json::json;
    use std::ops::ControlFlow;

    /// Targets far apart, P_D 0.8, and 50 false detections a scan; s = 10 dB unless said otherwise.
    fn scenario(sensor: &serde_json::Value) -> Scenario {
        let target = |index: u32| json!({"truth_id": index.to_string(), "x_m": 100.0 * f64::from(index), "y_m": 0.0, "vx_mps": 0.0, "vy_mps": 0.0});
        let mut scenario = json!({
            "scans": 100, "scan_period_s": 1.0,
            "sensors": [{"sensor_id": "radar", "x_m": 0.0, "y_m": 0.0, "max_range_m": 10_000.0, "p_d": 0.8, "sigma_x_m": 1.0, "sigma_y_m": 1.0, "clutter_per_scan": 50.0}],
            "targets": {"kind": "listed", "targets": (0..50).map(target).collect::<Vec<_>>()}
        });
        for (name, value) in sensor.as_object().unwrap() {
            scenario["sensors"][0][name] = value.clone();
        }
        serde_json::from_value(scenario).unwrap()
    }

    fn detections(scenario: &Scenario) -> Vec<crate::model::scan::Detection> {
        let seed = Seed { seed: 1, run: 0 };
        let simulated = simulate(scenario, seed, &mut |_| ControlFlow::Continue(()));
        simulated.unwrap().unwrap().recording.detections.clone()
    }

    /// Kolmogorov and Smirnov's √n max |F_n − F| against the exponential beyond `threshold`.
    fn distance_of_exponential(mut values: Vec<f64>, threshold: f64, mean: f64) -> f64 {
        values.sort_by(f64::total_cmp);
        let n = values.len() as f64;
        let mut largest = 0.0_f64;
        for (index, value) in values.iter().enumerate() {
            let expected = 1.0 - (-(value - threshold) / mean).exp();
            let (below, above) = (index as f64 / n, (index as f64 + 1.0) / n);
            largest = largest
                .max((expected - below).abs())
                .max((above - expected).abs());
        }
        largest * n.sqrt()
    }

    #[test]
    fn echoes_are_exponential_beyond_the_threshold_that_p_d_sets() {
        // 1 + s = 11, τ = −11 ln 0.8 = 2.4546.
        let found = detections(&scenario(&json!({"snr_db": 10.0})));
        let strengths = |is_target: bool| -> Vec<f64> {
            let of_kind = found
                .iter()
                .filter(|found| found.origin.is_some() == is_target);
            of_kind.map(|found| found.amplitude.unwrap()).collect()
        };
        let (targets, noise) = (strengths(true), strengths(false));
        assert!(targets.len() > 3800 && noise.len() > 4700);
        let threshold = -11.0 * 0.8_f64.ln();
        // 1.628 is exceeded once in a hundred times.
        for (values, mean) in [(targets, 11.0), (noise, 1.0)] {
            let distance = distance_of_exponential(values.clone(), threshold, mean);
            assert!(distance < 1.628, "{distance} of {mean}");
            let wrong = distance_of_exponential(values, threshold, 1.1 * mean);
            assert!(wrong > 1.628, "{wrong} of {mean}");
        }
    }

    #[test]
    fn amplitudes_change_nothing_else_and_are_absent_unless_asked_for() {
        let (without, with) = (
            detections(&scenario(&json!({}))),
            detections(&scenario(&json!({"snr_db": 10.0}))),
        );
        assert_eq!(without.len(), with.len());
        for (without, with) in without.iter().zip(&with) {
            assert_eq!(
                (without.measurement, without.origin, without.amplitude),
                (with.measurement, with.origin, None)
            );
            assert!(with.amplitude.is_some());
        }
    }

    #[test]
    fn a_record_has_amplitudes_of_its_own() {
        let mut scenario = scenario(&json!({"snr_db": 10.0}));
        scenario.record = Some(serde_json::from_value(json!({
            "time_step_s": 1.0, "bearing_step_deg": 1.0, "beam_width_deg": 2.0, "noise_averages": 10, "levels_db": [6.0],
            "fluctuation_db": 0.0, "fluctuation_time_s": 10.0
        })).unwrap());
        let faults = check(&scenario).unwrap_err();
        assert!(
            faults
                .iter()
                .any(|fault| fault.pointer == "/sensors/0/snr_db")
        );
    }
}
