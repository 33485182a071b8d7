//! What a scan's look at tracks is made of.

use crate::model::scan::Scan;
use crate::model::sensing::MeasurementModel;
use crate::model::sensor::Sensor;

/// What is known of a track besides its belief.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct About {
    /// The target that its first detection came from.
    pub origin: Option<u32>,
    /// r: the probability that it has a target.
    pub existence: f64,
}

impl About {
    /// Of a track that surely has a target.
    pub fn of(origin: Option<u32>) -> Self {
        About {
            origin,
            existence: 1.0,
        }
    }
}

/// A look of a sensor at tracks.
#[derive(Clone, Copy)]
pub struct Look<'a, F, S> {
    pub filter: &'a F,
    pub sensor: &'a Sensor,
    /// What the sensor reports in this scan.
    pub report: &'a MeasurementModel,
    pub scan: &'a Scan,
    /// From the scan before to this one.
    pub step: &'a S,
}
