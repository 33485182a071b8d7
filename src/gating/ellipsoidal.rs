//! The ellipsoidal gate: a detection is a track's candidate when its squared distance is at most γ, the chi-square
//! quantile of the gate probability P_G, so that a true detection falls inside with probability P_G.
//!
//! # Reference
//! Y. Bar-Shalom, X.-R. Li, Multitarget-Multisensor Tracking, 1995, section 2.3.2.

use super::grid::Grid;
use crate::math::gaussian::{Gaussian, gate_threshold, log_unit_ball};
use crate::model::angle;
use nalgebra::{SMatrix, SVector};

/// Values of a measurement at the most.
const MAX_DIMENSIONS: usize = 5;

/// The gate of a tracker, for measurements of any number of values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EllipsoidalGate {
    /// γ of measurements of 1, 2, … values.
    thresholds: [f64; MAX_DIMENSIONS],
    /// ln((γ / 2π)^(D/2)) and that of the volume of the unit ball.
    log_scales: [f64; MAX_DIMENSIONS],
}

impl EllipsoidalGate {
    /// `probability` P_G in (0, 1]; with 1 everything is inside.
    pub fn new(probability: f64) -> Self {
        let of_dimension = [1, 2, 3, 4, 5];
        let thresholds = of_dimension.map(|d| gate_threshold(probability, d));
        let log_scales = of_dimension.map(|d| {
            let threshold = thresholds[d as usize - 1];
            log_unit_ball(d) + f64::from(d) / 2.0 * (threshold / std::f64::consts::TAU).ln()
        });
        EllipsoidalGate {
            thresholds,
            log_scales,
        }
    }

    /// γ of measurements of so many values, 1 to 5.
    pub fn threshold(&self, dimensions: usize) -> f64 {
        self.thresholds[dimensions - 1]
    }

    /// ln V of the gate around a Gaussian with covariance S: V = c_D γ^(D/2) √det S, in the units of the measurement;
    /// c_D is the volume of the unit ball, π in the plane.
    #[inline]
    pub fn log_volume<const D: usize>(&self, gaussian: &Gaussian<D>) -> f64 {
        // The density at the centre is 1 / ((2π)^(D/2) √det S).
        self.log_scales[D - 1] - gaussian.log_density(0.0)
    }

    /// Calls `found(detection, ν, d²)` for each measurement inside the gate around ẑ with innovation covariance S.
    /// `placed` are the measurements as the grid arranged them; `angle` names the coordinate that goes round, if there is one.
    #[inline]
    pub fn candidates<const D: usize>(
        &self,
        (grid, placed): (&Grid, &[[f64; D]]),
        (centre, angle): (&SVector<f64, D>, Option<usize>),
        (covariance, gaussian): (&SMatrix<f64, D, D>, &Gaussian<D>),
        mut found: impl FnMut(u32, SVector<f64, D>, f64),
    ) {
        let threshold = self.thresholds[D - 1];
        // The ellipsoid's bounding box reaches √(γ Sᵢᵢ) along axis i.
        let reach = |axis: usize| {
            if axis < D {
                (threshold * covariance[(axis, axis)]).sqrt()
            } else {
                0.0
            }
        };
        grid.near_places(centre, [reach(0), reach(1)], angle, |places, detections| {
            for (near, &detection) in placed[places].iter().zip(detections) {
                let innovation = angle::difference(&SVector::from(*near), centre, angle);
                let squared = gaussian.squared_distance(&innovation);
                if squared <= threshold {
                    found(detection, innovation, squared);
                }
            }
        });
    }

    /// Calls `found(detection, z)` once for each measurement inside the gate of any of the regions, each a ẑ with its S.
    #[inline]
    pub fn candidates_of_any<'r, const D: usize>(
        &self,
        (grid, placed): (&Grid, &[[f64; D]]),
        angle: Option<usize>,
        regions: impl Iterator<Item = Region<'r, D>> + Clone,
        mut found: impl FnMut(u32, SVector<f64, D>),
    ) {
        let mut hull = Hull::default();
        for region in regions.clone() {
            hull.add(self, region, angle);
        }
        let Some((centre, half)) = hull.centre(angle) else {
            return;
        };
        grid.near_places(&centre, half, angle, |places, detections| {
            for (near, &detection) in placed[places].iter().zip(detections) {
                let point = SVector::from(*near);
                if self.is_inside(&point, angle, regions.clone()) {
                    found(detection, point);
                }
            }
        });
    }

    /// Whether a measurement is inside the gate of any of the regions.
    #[inline]
    pub fn is_inside<'r, const D: usize>(
        &self,
        point: &SVector<f64, D>,
        angle: Option<usize>,
        mut regions: impl Iterator<Item = Region<'r, D>>,
    ) -> bool {
        regions.any(|(centre, _, gaussian)| {
            let innovation = angle::difference(point, centre, angle);
            gaussian.squared_distance(&innovation) <= self.thresholds[D - 1]
        })
    }
}

/// The box around regions, along the first two axes.
pub struct Hull<const D: usize> {
    /// The first centre, from which the others are measured.
    first: Option<SVector<f64, D>>,
    low: [f64; 2],
    high: [f64; 2],
}

impl<const D: usize> Default for Hull<D> {
    fn default() -> Self {
        Hull {
            first: None,
            low: [f64::INFINITY; 2],
            high: [f64::NEG_INFINITY; 2],
        }
    }
}

impl<const D: usize> Hull<D> {
    /// Takes in the bounding box of the gate of a region.
    pub fn add(
        &mut self,
        gate: &EllipsoidalGate,
        (centre, covariance, _): Region<D>,
        angle: Option<usize>,
    ) {
        let threshold = gate.thresholds[D - 1];
        let first = self.first.get_or_insert(*centre);
        let offset = angle::difference(centre, first, angle);
        for axis in 0..D.min(2) {
            let reach = (threshold * covariance[(axis, axis)]).sqrt();
            self.low[axis] = self.low[axis].min(offset[axis] - reach);
            self.high[axis] = self.high[axis].max(offset[axis] + reach);
        }
    }

    /// Its centre, and half of its sides.
    pub fn centre(&self, angle: Option<usize>) -> Option<(SVector<f64, D>, [f64; 2])> {
        let (mut centre, mut half) = (self.first?, [0.0; 2]);
        for axis in 0..D.min(2) {
            half[axis] = (self.high[axis] - self.low[axis]) / 2.0;
            if half[axis].is_finite() {
                centre[axis] += (self.low[axis] + self.high[axis]) / 2.0;
            }
        }
        if let Some(axis) = angle {
            centre[axis] = angle::wrap(centre[axis]);
        }
        Some((centre, half))
    }
}

/// ẑ, S, and what is made of S.
pub type Region<'r, const D: usize> =
    (&'r SVector<f64, D>, &'r SMatrix<f64, D, D>, &'r Gaussian<D>);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::state::{Position, PositionCovariance};
    use nalgebra::{Matrix1, Matrix2, Vector1, Vector2};
    use proptest::prelude::*;
    use std::f64::consts::PI;

    /// The detections inside the gate, in their order.
    fn gated<const D: usize>(
        measurements: &[SVector<f64, D>],
        (centre, angle): (SVector<f64, D>, Option<usize>),
        covariance: SMatrix<f64, D, D>,
        probability: f64,
    ) -> Vec<u32> {
        let rows: Vec<[f64; D]> = measurements.iter().map(|row| row.data.0[0]).collect();
        let (mut grid, mut placed, mut found) = (Grid::default(), Vec::new(), Vec::new());
        grid.rebuild(&rows);
        grid.arrange(&rows, &mut placed);
        let gaussian = Gaussian::new(&covariance).unwrap();
        EllipsoidalGate::new(probability).candidates(
            (&grid, placed.as_chunks::<D>().0),
            (&centre, angle),
            (&covariance, &gaussian),
            |detection, _, _| found.push(detection),
        );
        found.sort_unstable();
        found
    }

    #[test]
    fn the_volume_of_the_gate_is_that_of_an_ellipse() {
        // S = diag(16, 9) and γ = −2 ln 0.01: half axes 4√γ and 3√γ, V = 12 π γ.
        let gaussian = Gaussian::new(&PositionCovariance::new(16.0, 0.0, 0.0, 9.0)).unwrap();
        let expected = 12.0 * std::f64::consts::PI * -2.0 * 0.01f64.ln();
        assert!((EllipsoidalGate::new(0.99).log_volume(&gaussian).exp() - expected).abs() < 1e-9);
    }

    #[test]
    fn without_a_gate_everything_is_a_candidate() {
        let positions: Vec<Position> = (0..50)
            .map(|index| Position::new(1e5 * f64::from(index), -3.0 * f64::from(index)))
            .collect();
        let covariance = PositionCovariance::new(1.0, 0.5, 0.5, 2.0);
        let centre = (Position::new(7.0, 7.0), None);
        let found = gated(&positions, centre, covariance, 1.0);
        assert_eq!(found, (0..50).collect::<Vec<u32>>());
    }

    proptest! {
        #[test]
        fn the_gated_set_equals_that_of_brute_force(
            places in prop::collection::vec((-30.0..30.0f64, -30.0..30.0f64), 0..80),
            centre in (-40.0..40.0f64, -40.0..40.0f64),
            (xx, yy, correlation) in (0.1..200.0f64, 0.1..200.0f64, -0.95..0.95f64),
        ) {
            let positions: Vec<Position> = places.iter().map(|&(x, y)| Position::new(x, y)).collect();
            let centre = Position::new(centre.0, centre.1);
            let xy = correlation * (xx * yy).sqrt();
            let covariance = PositionCovariance::new(xx, xy, xy, yy);
            let gaussian = Gaussian::new(&covariance).unwrap();
            let gated = gated(&positions, (centre, None), covariance, 0.99);
            let inside = |index: &u32| gaussian.squared_distance(&(positions[*index as usize] - centre)) <= -2.0 * 0.01f64.ln() + 1e-12;
            let brute: Vec<u32> = (0..positions.len() as u32).filter(inside).collect();
            prop_assert_eq!(gated, brute);
        }

        #[test]
        fn the_gates_of_several_regions_are_those_of_each_together(
            reports in prop::collection::vec((0.0..100.0f64, -PI..PI), 0..80),
            regions in prop::collection::vec((0.0..120.0f64, -PI..PI, 0.1..20.0f64, 0.01..1.0f64), 1..4),
            goes_round in any::<bool>(),
        ) {
            let reports: Vec<Vector2<f64>> = reports.iter().map(|&(range, bearing)| Vector2::new(range, bearing)).collect();
            let angle = goes_round.then_some(1);
            let (mut regions_of, mut alone) = (Vec::new(), std::collections::BTreeSet::new());
            for (range, bearing, range_sigma, bearing_sigma) in regions {
                let (centre, covariance) = (Vector2::new(range, bearing), Matrix2::new(range_sigma.powi(2), 0.0, 0.0, bearing_sigma.powi(2)));
                alone.extend(gated(&reports, (centre, angle), covariance, 0.99));
                regions_of.push((centre, covariance, Gaussian::new(&covariance).unwrap()));
            }
            let rows: Vec<[f64; 2]> = reports.iter().map(|row| row.data.0[0]).collect();
            let (mut grid, mut placed, mut found) = (Grid::default(), Vec::new(), Vec::new());
            grid.rebuild(&rows);
            grid.arrange(&rows, &mut placed);
            EllipsoidalGate::new(0.99).candidates_of_any(
                (&grid, placed.as_chunks().0),
                angle,
                regions_of.iter().map(|(centre, covariance, gaussian)| (centre, covariance, gaussian)),
                |detection, point| {
                    assert_eq!(point, reports[detection as usize]);
                    found.push(detection);
                },
            );
            found.sort_unstable();
            prop_assert_eq!(found, alone.into_iter().collect::<Vec<u32>>());
        }

        #[test]
        fn the_gated_ranges_and_bearings_equal_those_of_brute_force_all_round(
            reports in prop::collection::vec((0.0..100.0f64, -PI..PI), 0..80),
            (range, bearing) in (0.0..120.0f64, -PI..PI),
            (range_sigma, bearing_sigma, correlation) in (0.1..40.0f64, 0.01..1.5f64, -0.95..0.95f64),
        ) {
            let reports: Vec<Vector2<f64>> = reports.iter().map(|&(range, bearing)| Vector2::new(range, bearing)).collect();
            let cross = correlation * range_sigma * bearing_sigma;
            let covariance = Matrix2::new(range_sigma * range_sigma, cross, cross, bearing_sigma * bearing_sigma);
            assert_equals_brute_force(&reports, Vector2::new(range, bearing), covariance, 1)?;
        }

        #[test]
        fn the_gated_bearings_equal_those_of_brute_force_all_round(
            bearings in prop::collection::vec(-PI..PI, 0..80),
            bearing in -PI..PI,
            sigma in 0.001..1.5f64,
        ) {
            let bearings: Vec<Vector1<f64>> = bearings.into_iter().map(Vector1::new).collect();
            assert_equals_brute_force(&bearings, Vector1::new(bearing), Matrix1::new(sigma * sigma), 0)?;
        }
    }

    /// Brute force writes the difference of two bearings as the smaller way round, by trying all three.
    fn assert_equals_brute_force<const D: usize>(
        measurements: &[SVector<f64, D>],
        centre: SVector<f64, D>,
        covariance: SMatrix<f64, D, D>,
        axis: usize,
    ) -> Result<(), TestCaseError> {
        let gaussian = Gaussian::new(&covariance).unwrap();
        let gated = gated(measurements, (centre, Some(axis)), covariance, 0.99);
        let inside = |index: &u32| {
            let mut difference = measurements[*index as usize] - centre;
            let ways = [
                difference[axis],
                difference[axis] - 2.0 * PI,
                difference[axis] + 2.0 * PI,
            ];
            difference[axis] = ways
                .into_iter()
                .min_by(|left, right| left.abs().total_cmp(&right.abs()))
                .unwrap();
            gaussian.squared_distance(&difference) <= gate_threshold(0.99, D as u32)
        };
        let brute: Vec<u32> = (0..measurements.len() as u32).filter(inside).collect();
        prop_assert_eq!(gated, brute);
        Ok(())
    }
}
