//! The detections of one scan as the tracker looks at them: as points, in a grid, used or not.

use crate::association::Needs;
use crate::filtering::Filter;
use crate::filtering::mixture::Expected;
use crate::gating::ellipsoidal::EllipsoidalGate;
use crate::gating::grid::{Grid, Placed};
use crate::math::angle;
use crate::model::scan::{Detection, Scan};
use crate::model::sensor::Sensor;
use crate::model::track::Candidate;
use nalgebra::SVector;

/// A detection to which a track gives at least this weight is used: neither do the tentative tracks see it after a
/// confirmed one used it, nor does it start a track. One that all tracks weigh less explains too little of any of them.
const USED_WEIGHT: f64 = 0.01;

/// The detections of a scan, prepared for gating; memory is reused.
#[derive(Debug)]
pub(super) struct ScanView<const D: usize> {
    /// As points of the measurement space.
    pub measurements: Vec<SVector<f64, D>>,
    /// The same as the grid arranged them.
    placed: Vec<Placed<D>>,
    /// The coordinate that is an angle.
    pub angle: Option<usize>,
    pub used: Vec<bool>,
    grid: Grid,
    choose_by_origin: bool,
    /// For the oracle: the detection of each target in this scan.
    by_origin: Vec<Option<u32>>,
}

impl<const D: usize> Default for ScanView<D> {
    fn default() -> Self {
        ScanView {
            measurements: Vec::new(),
            placed: Vec::new(),
            angle: None,
            used: Vec::new(),
            grid: Grid::default(),
            choose_by_origin: false,
            by_origin: Vec::new(),
        }
    }
}

impl<const D: usize> ScanView<D> {
    pub fn rebuild<const N: usize>(
        &mut self,
        filter: &impl Filter<N, D>,
        sensor: &Sensor,
        detections: &[Detection],
        needs: Needs,
    ) {
        self.measurements.clear();
        self.measurements.extend(
            detections.iter().filter_map(|detection| {
                filter.to_measurement_space(sensor, &detection.measurement)
            }),
        );
        debug_assert_eq!(
            self.measurements.len(),
            detections.len(),
            "only reports that the filter can use are let through"
        );
        self.angle = filter.angle(sensor);
        self.used.clear();
        self.used.resize(detections.len(), false);
        self.choose_by_origin = needs == Needs::Origins;
        if self.choose_by_origin {
            self.index_origins(detections);
        } else {
            self.grid.rebuild(&self.measurements);
            self.grid.arrange(&self.measurements, &mut self.placed);
        }
    }

    #[inline]
    pub fn mark_used(&mut self, candidates: &[Candidate], scan: &Scan) {
        for candidate in candidates {
            if let Some(detection) = candidate
                .detection
                .filter(|_| candidate.probability >= USED_WEIGHT)
            {
                self.used[detection as usize - scan.first] = true;
            }
        }
    }

    fn index_origins(&mut self, detections: &[Detection]) {
        self.by_origin.clear();
        let highest = detections
            .iter()
            .filter_map(|detection| detection.origin)
            .max();
        self.by_origin
            .resize(highest.map_or(0, |origin| origin as usize + 1), None);
        for (index, detection) in detections.iter().enumerate() {
            if let Some(origin) = detection.origin {
                self.by_origin[origin as usize].get_or_insert(index as u32);
            }
        }
    }

    /// A track's candidates among the unused detections: by the gate, or by origin when origins are indexed.
    #[inline]
    pub fn candidates<const N: usize>(
        &self,
        gate: &EllipsoidalGate<D>,
        origin: Option<u32>,
        expected: &Expected<N, D>,
        mut found: impl FnMut(u32, SVector<f64, D>, f64),
    ) {
        if self.choose_by_origin {
            let detection =
                origin.and_then(|origin| self.by_origin.get(origin as usize).copied().flatten());
            if let Some(detection) = detection.filter(|&detection| !self.used[detection as usize]) {
                let innovation = angle::difference(
                    &self.measurements[detection as usize],
                    &expected.measurement,
                    self.angle,
                );
                found(
                    detection,
                    innovation,
                    expected.gaussian.squared_distance(&innovation),
                );
            }
            return;
        }
        let (centre, spread) = (
            (&expected.measurement, self.angle),
            (&expected.covariance, &expected.gaussian),
        );
        gate.candidates(
            &self.grid,
            &self.placed,
            centre,
            spread,
            |detection, innovation, squared| {
                if !self.used[detection as usize] {
                    found(detection, innovation, squared);
                }
            },
        );
    }
}
