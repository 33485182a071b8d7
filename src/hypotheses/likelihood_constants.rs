//! What the likelihoods of a scan have in common, and what of them differs from track to track.

use crate::model::scan::Scan;
use crate::model::sensor::Sensor;
use crate::model::sight::Sight;
use crate::model::state::{GaussianState, Position};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LikelihoodConstants {
    /// P_D.
    pub p_d: f64,
    /// ln λ.
    pub log_clutter: f64,
    /// ln(r P_D / λ).
    pub log_density: f64,
    /// ln(1 − r P_D P_G).
    pub log_missed: f64,
}

impl LikelihoodConstants {
    /// Where the sensor sees as it is said to see everywhere.
    pub fn new(sensor: &Sensor, gate_probability: f64) -> Self {
        Self::of((sensor.p_d, 1.0), sensor, gate_probability)
    }

    /// Of a target that is detected with P_D, and there with probability r.
    fn of((p_d, existence): (f64, f64), sensor: &Sensor, gate_probability: f64) -> Self {
        let detected = existence * p_d;
        LikelihoodConstants {
            p_d,
            log_clutter: sensor.clutter_density.ln(),
            log_density: (detected / sensor.clutter_density).ln(),
            log_missed: (1.0 - detected * gate_probability).ln(),
        }
    }
}

/// The likelihoods of a scan by what its sensor sees of each track.
#[derive(Debug, Clone, Copy)]
pub struct Likelihoods<'a> {
    usual: LikelihoodConstants,
    sensor: &'a Sensor,
    gate_probability: f64,
    /// Where the sensor does not see the same everywhere; and from where it sees.
    sight: Option<(&'a Sight, Position)>,
}

impl<'a> Likelihoods<'a> {
    pub fn new(sensor: &'a Sensor, scan: &Scan, gate_probability: f64) -> Self {
        let sight = sensor.sight.as_ref();
        Likelihoods {
            usual: LikelihoodConstants::new(sensor, gate_probability),
            sensor,
            gate_probability,
            sight: sight.map(|sight| (sight, sight.place_in(scan))),
        }
    }

    /// Of a track that has a target with this probability, and these kinematics.
    #[inline]
    pub fn of<const K: usize>(
        &self,
        existence: f64,
        kinematics: impl FnOnce() -> GaussianState<K>,
    ) -> LikelihoodConstants {
        let p_d = match self.sight {
            None if existence == 1.0 => return self.usual,
            None => self.usual.p_d,
            Some((sight, from_m)) => sight.mean_p_d(&kinematics(), &from_m),
        };
        LikelihoodConstants::of((p_d, existence), self.sensor, self.gate_probability)
    }
}
