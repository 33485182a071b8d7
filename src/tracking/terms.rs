//! What the likelihoods of a scan have in common.

use crate::model::sensor::Sensor;

pub(super) struct Terms {
    /// ln λ.
    pub log_clutter: f64,
    /// ln(P_D / λ).
    pub log_density: f64,
    /// ln(1 − P_D P_G).
    pub log_none: f64,
}

impl Terms {
    pub fn of(sensor: &Sensor, gate_probability: f64) -> Self {
        Terms {
            log_clutter: sensor.clutter_density.ln(),
            log_density: (sensor.p_d / sensor.clutter_density).ln(),
            log_none: (1.0 - sensor.p_d * gate_probability).ln(),
        }
    }
}
