//! The detections of one scan as hypotheses look at them: as points of a measurement space, in a grid, used or not.

use crate::filtering::{Corrector, Expected, Filter};
use crate::gating::ellipsoidal::{EllipsoidalGate, Hull};
use crate::gating::grid::Grid;
use crate::model::angle;
use crate::model::scan::Detection;
use nalgebra::SVector;

/// The detections of a scan, prepared for gating; memory is reused.
#[derive(Debug, Default)]
pub(super) struct Detections {
    /// As points of the measurement space, one after the other.
    values: Vec<f64>,
    /// The same as the grid arranged them.
    placed: Vec<f64>,
    grid: Grid,
    pub used: Vec<bool>,
    /// The detection of each target in this scan.
    by_origin: Vec<Option<u32>>,
}

impl Detections {
    /// Takes the points of a new scan; none of them is used.
    pub fn read<const D: usize>(&mut self, points: impl Iterator<Item = [f64; D]>) {
        self.values.clear();
        self.values.extend(points.flatten());
        self.used.clear();
        self.used.resize(self.values.len() / D, false);
    }

    pub fn len(&self) -> usize {
        self.used.len()
    }

    /// As points of `D` values, as which they were read.
    pub fn points<const D: usize>(&self) -> &[[f64; D]] {
        self.values.as_chunks().0
    }

    /// Sorts the points into the grid.
    pub fn arrange<const D: usize>(&mut self) {
        let points = self.values.as_chunks::<D>().0;
        self.grid.rebuild(points);
        self.grid.arrange(points, &mut self.placed);
    }

    /// Notes the first detection of each target.
    pub fn index_origins(&mut self, detections: &[Detection]) {
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

    /// Calls `found(detection, ν, d²)` for each unused detection inside the gate; where reports are expected in several regions,
    /// inside the gate of any.
    #[inline]
    pub fn inside<C: Corrector<F, K, D>, F: Filter<K>, const K: usize, const D: usize>(
        &self,
        gate: &EllipsoidalGate,
        (expected, gain): (&Expected<D>, &C::Gain),
        mut found: impl FnMut(u32, SVector<f64, D>, f64),
    ) {
        let placed = (&self.grid, self.placed.as_chunks().0);
        if C::HAS_REGIONS {
            let regions = C::regions(gain).iter().map(Expected::as_region);
            gate.candidates_of_any(placed, C::ANGLE, regions, |detection, point| {
                if !self.used[detection as usize] {
                    let innovation = angle::difference(&point, &expected.measurement, C::ANGLE);
                    let squared = expected.gaussian.squared_distance(&innovation);
                    found(detection, innovation, squared);
                }
            });
            return;
        }
        gate.candidates(
            placed,
            (&expected.measurement, C::ANGLE),
            (&expected.covariance, &expected.gaussian),
            |detection, innovation, squared| {
                if !self.used[detection as usize] {
                    found(detection, innovation, squared);
                }
            },
        );
    }

    /// The same of those on a list.
    #[inline(never)]
    pub fn among<C: Corrector<F, K, D>, F: Filter<K>, const K: usize, const D: usize>(
        &self,
        gate: &EllipsoidalGate,
        (expected, gain): (&Expected<D>, &C::Gain),
        list: &[u32],
        mut found: impl FnMut(u32, SVector<f64, D>, f64),
    ) {
        for &detection in list {
            let point = SVector::from(self.points()[detection as usize]);
            let is_inside = if C::HAS_REGIONS {
                let regions = C::regions(gain).iter().map(Expected::as_region);
                gate.is_inside(&point, C::ANGLE, regions)
            } else {
                gate.is_inside(&point, C::ANGLE, std::iter::once(expected.as_region()))
            };
            if is_inside && !self.used[detection as usize] {
                let innovation = angle::difference(&point, &expected.measurement, C::ANGLE);
                let squared = expected.gaussian.squared_distance(&innovation);
                found(detection, innovation, squared);
            }
        }
    }

    /// Appends the unused detections that lie in a box.
    pub fn near<const D: usize>(&self, hull: &Hull<D>, angle: Option<usize>, near: &mut Vec<u32>) {
        let Some((centre, half)) = hull.centre(angle) else {
            return;
        };
        self.grid
            .near_places(&centre, half, angle, |_, detections| {
                near.extend_from_slice(detections);
            });
        near.retain(|detection| !self.used[*detection as usize]);
    }

    /// The unused detection of a target.
    pub fn own(&self, origin: Option<u32>) -> Option<u32> {
        let detection = (*self.by_origin.get(origin? as usize)?)?;
        (!self.used[detection as usize]).then_some(detection)
    }

    /// The same for the detection of one target, inside the gate or not.
    #[inline]
    pub fn of_target<const D: usize>(
        &self,
        origin: Option<u32>,
        expected: &Expected<D>,
        angle: Option<usize>,
        mut found: impl FnMut(u32, SVector<f64, D>, f64),
    ) {
        let Some(detection) = self.own(origin) else {
            return;
        };
        let point = SVector::from(self.points()[detection as usize]);
        let innovation = angle::difference(&point, &expected.measurement, angle);
        let squared = expected.gaussian.squared_distance(&innovation);
        found(detection, innovation, squared);
    }
}
