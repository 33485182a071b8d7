//! What the likelihoods of a scan have in common.

use crate::model::sensor::Sensor;

pub struct LikelihoodConstants {
    /// ln λ.
    pub log_clutter: f64,
    /// ln(P_D / λ).
    pub log_density: f64,
    /// ln(1 − P_D P_G).
    pub log_missed: f64,
}

impl LikelihoodConstants {
    pub fn new(sensor: &Sensor, gate_probability: f64) -> Self {
        LikelihoodConstants {
            log_clutter: sensor.clutter_density.ln(),
            log_density: (sensor.p_d / sensor.clutter_density).ln(),
            log_missed: (1.0 - sensor.p_d * gate_probability).ln(),
        }
    }
}
