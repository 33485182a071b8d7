//! What a detection tells by itself of where its target is.

use super::Hypotheses;
use super::detections::Detections;
use crate::filtering::{Corrector, Filter, WithCorrector};
use crate::model::own::Own;
use crate::model::sensing::MeasurementModel;
use crate::model::state::GaussianState;

impl<F: Filter<K>, const K: usize> Hypotheses<F, K> {
    /// The kinematics that a detection tells by itself, if no track uses it; at its own time.
    pub fn locate(
        &self,
        filter: &F,
        report: &MeasurementModel,
        speed_sigma_mps: f64,
        (detection, own): (usize, &Own),
    ) -> Option<GaussianState<K>> {
        if self.detections.used[detection] {
            return None;
        }
        let work = Locating {
            detections: &self.detections,
            detection,
            own,
            rate_sigma: filter.rate_sigma(speed_sigma_mps),
        };
        filter.correct(report, work).flatten()
    }

    /// The parts of those kinematics, where the filter begins among several.
    pub fn parts(
        &self,
        filter: &F,
        report: &MeasurementModel,
        speed_sigma_mps: f64,
        (detection, own): (usize, &Own),
    ) -> Vec<GaussianState<K>> {
        let work = LocatingParts(Locating {
            detections: &self.detections,
            detection,
            own,
            rate_sigma: filter.rate_sigma(speed_sigma_mps),
        });
        filter.correct(report, work).unwrap_or_default()
    }
}

struct Locating<'a> {
    detections: &'a Detections,
    detection: usize,
    own: &'a Own,
    rate_sigma: f64,
}

impl<F: Filter<K>, const K: usize> WithCorrector<F, K> for Locating<'_> {
    type Output = Option<GaussianState<K>>;

    fn with<C: Corrector<F, K, D>, const D: usize>(self, corrector: &C) -> Self::Output {
        let values = self.detections.points::<D>()[self.detection];
        corrector.locate(&values.into(), self.rate_sigma, self.own)
    }
}

struct LocatingParts<'a>(Locating<'a>);

impl<F: Filter<K>, const K: usize> WithCorrector<F, K> for LocatingParts<'_> {
    type Output = Vec<GaussianState<K>>;

    fn with<C: Corrector<F, K, D>, const D: usize>(self, corrector: &C) -> Self::Output {
        let values = self.0.detections.points::<D>()[self.0.detection];
        corrector.parts(&values.into(), self.0.rate_sigma, self.0.own)
    }
}
