//! The density of clutter at a detection, where it is learnt while a tracker runs: from a map of cells in the sensor's own
//! coordinates, or from the neighbours of each detection.
//!
//! # Symbols
//! λ density of clutter, λ₀ the sensor's; A measure of a cell (m², rad); n clutter counted in it in a scan; α the map's gain;
//! d_k distance from a detection to the k-th nearest other of its scan.
//!
//! # Method
//! 1. Map: λ ← (1 − α) λ + α n / A in each cell once a scan, from λ₀ on. n counts what the confirmed tracks leave over:
//!    Σ (1 − β) with β the weights that they give a detection. Steady clutter is told with the relative standard deviation
//!    √(α / ((2 − α) λ A)); half of a change is followed after ln ½ / ln(1 − α) scans.
//! 2. Neighbours: λ = (k − 1) / (π d_k²) of places, (k − 1) / (2 d_k) of bearings; k / (π d_k²) would be too large.
//!
//! # References
//! T. L. Song, D. Mušicki, Adaptive Clutter Measurement Density Estimation for Improved Target Tracking, IEEE Transactions on
//! Aerospace and Electronic Systems 47(2), 2011; X. R. Li, N. Li, Integrated Real-Time Estimation of Clutter Density for
//! Tracking, IEEE Transactions on Signal Processing 48(10), 2000.

use super::{Limits, Spot};
use crate::model::angle::wrap;
use crate::model::scan::{Measurement, Scan};
use crate::model::state::Position;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// λ never falls below this, per m² or per rad: no scene is so clean that a false detection is impossible.
pub const LEAST_CLUTTER: f64 = 1e-15;
/// Scans with more detections have no need of neighbours, and their distances would take long.
const MOST_NEIGHBOURS: usize = 1000;

/// How the density of clutter is known, if not as one number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "service", schema(as = SensorClutter))]
#[serde(tag = "method", rename_all = "snake_case", deny_unknown_fields)]
pub enum ClutterSettings {
    /// One number, of what the tracks of a first pass leave over.
    Estimated,
    /// A map that is learnt.
    Map {
        #[serde(default = "usual_gain")]
        alpha: f64,
        /// Along each coordinate.
        #[serde(default = "usual_cells")]
        cells: u32,
    },
    /// The neighbours of each detection.
    Nearest {
        #[serde(default = "usual_neighbour")]
        k: u32,
    },
}

fn usual_gain() -> f64 {
    0.05
}

fn usual_cells() -> u32 {
    12
}

fn usual_neighbour() -> u32 {
    5
}

impl ClutterSettings {
    pub fn is_sound(&self) -> bool {
        match *self {
            ClutterSettings::Estimated => true,
            ClutterSettings::Map { alpha, cells } => {
                alpha > 0.0 && alpha < 1.0 && (1..=100).contains(&cells)
            }
            ClutterSettings::Nearest { k } => (2..=50).contains(&k),
        }
    }
}

/// What a tracker learns of clutter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ClutterPlan {
    Map(MapPlan),
    Nearest { k: usize },
}

/// The cells of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapPlan {
    /// α.
    pub alpha: f64,
    pub area: MapArea,
    /// Along the first and the second coordinate.
    pub cells: [usize; 2],
}

/// What a map covers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MapArea {
    /// Bearings and ranges around the sensor, wherever it is.
    Polar(Limits),
    /// A rectangle of the plane, by its corners.
    Plane { low_m: Position, high_m: Position },
    /// Bearings alone.
    Arc(Limits),
}

impl MapPlan {
    pub fn cell_count(&self) -> usize {
        match self.area {
            MapArea::Arc(_) => self.cells[0],
            _ => self.cells[0] * self.cells[1],
        }
    }

    /// The cell that holds a report; `None` outside the map.
    pub fn cell_of(&self, report: &Measurement, from_m: &Position) -> Option<usize> {
        let spot = Spot::of_report(report, from_m);
        match self.area {
            MapArea::Arc(limits) => part(turned(&limits, &spot), self.cells[0]),
            MapArea::Polar(limits) => {
                let depth_m = limits.range_to_m() - limits.range_from_m();
                let along = (spot.range_m? - limits.range_from_m()) / depth_m;
                Some(
                    part(turned(&limits, &spot), self.cells[0])? * self.cells[1]
                        + part(along, self.cells[1])?,
                )
            }
            MapArea::Plane { low_m, high_m } => {
                let place_m = report.position_seen_from(from_m)?;
                let share = (place_m - low_m).component_div(&(high_m - low_m));
                Some(
                    part(share[0], self.cells[0])? * self.cells[1] + part(share[1], self.cells[1])?,
                )
            }
        }
    }

    /// The middle of a cell, as a sensor there sees it; of a rectangle its place.
    pub fn middle_of(&self, cell: usize, from_m: &Position) -> Spot {
        let [first, second] = match self.area {
            MapArea::Arc(_) => [cell, 0],
            _ => [cell / self.cells[1], cell % self.cells[1]],
        };
        let share = |index: usize, axis: usize| (index as f64 + 0.5) / self.cells[axis] as f64;
        match self.area {
            MapArea::Plane { low_m, high_m } => {
                let shares = Position::new(share(first, 0), share(second, 1));
                let place_m = low_m + (high_m - low_m).component_mul(&shares);
                Spot::of_place(&place_m, from_m)
            }
            MapArea::Polar(limits) | MapArea::Arc(limits) => {
                let (from_rad, width_rad) = limits.arc_rad();
                let depth_m = limits.range_to_m() - limits.range_from_m();
                Spot {
                    bearing_rad: from_rad + width_rad * share(first, 0),
                    range_m: matches!(self.area, MapArea::Polar(_))
                        .then(|| limits.range_from_m() + depth_m * share(second, 1)),
                }
            }
        }
    }

    /// A.
    pub fn measure_of(&self, cell: usize) -> f64 {
        match self.area {
            MapArea::Arc(limits) => limits.arc_rad().1 / self.cells[0] as f64,
            MapArea::Plane { low_m, high_m } => {
                let sides = high_m - low_m;
                sides[0] * sides[1] / self.cell_count() as f64
            }
            MapArea::Polar(limits) => {
                let depth_m = (limits.range_to_m() - limits.range_from_m()) / self.cells[1] as f64;
                let near_m = limits.range_from_m() + depth_m * (cell % self.cells[1]) as f64;
                let width_rad = limits.arc_rad().1 / self.cells[0] as f64;
                width_rad * depth_m * (near_m + depth_m / 2.0)
            }
        }
    }
}

/// How far clockwise through an arc a bearing lies: 0 to 1 inside.
fn turned(limits: &Limits, spot: &Spot) -> f64 {
    let (from_rad, width_rad) = limits.arc_rad();
    (spot.bearing_rad - from_rad).rem_euclid(TAU) / width_rad
}

/// Which of so many equal parts; the end belongs to the last one.
fn part(share: f64, parts: usize) -> Option<usize> {
    (0.0..=1.0)
        .contains(&share)
        .then(|| ((share * parts as f64) as usize).min(parts - 1))
}

/// Densities of clutter that are learnt, as ratios to the sensor's λ₀.
#[derive(Debug, Clone, PartialEq)]
pub struct ClutterMap {
    ratios: Vec<f64>,
    /// n of the current scan.
    counts: Vec<f64>,
}

impl ClutterMap {
    /// With a ratio for each cell to begin with.
    pub fn new(ratios: Vec<f64>) -> Self {
        ClutterMap {
            counts: vec![0.0; ratios.len()],
            ratios,
        }
    }

    /// λ / λ₀ of each cell.
    pub fn ratios(&self) -> &[f64] {
        &self.ratios
    }

    /// ln λ / λ₀ at a report; 0 outside the map.
    pub fn log_ratio(&self, plan: &MapPlan, report: &Measurement, from_m: &Position) -> f64 {
        plan.cell_of(report, from_m)
            .map_or(0.0, |cell| self.ratios[cell].ln())
    }

    /// Step 1. `left` is 1 − β of each detection of the scan; `density` is λ₀.
    pub fn learn(
        &mut self,
        plan: &MapPlan,
        (scan, from_m): (&Scan, &Position),
        left: &[f64],
        density: f64,
    ) {
        self.counts.fill(0.0);
        for (detection, left) in scan.detections.iter().zip(left) {
            if let Some(cell) = plan.cell_of(&detection.measurement, from_m) {
                self.counts[cell] += left;
            }
        }
        for (cell, (ratio, count)) in self.ratios.iter_mut().zip(&self.counts).enumerate() {
            let found = count / (plan.measure_of(cell) * density);
            *ratio =
                ((1.0 - plan.alpha) * *ratio + plan.alpha * found).max(LEAST_CLUTTER / density);
        }
    }
}

/// Step 2 for each detection of a scan: ln λ / λ₀, 0 where it has too few neighbours.
pub fn log_ratios_by_neighbours(
    k: usize,
    (scan, from_m): (&Scan, &Position),
    density: f64,
    ratios: &mut Vec<f64>,
) {
    let count = scan.detections.len();
    if count <= k || count > MOST_NEIGHBOURS {
        ratios.resize(count, 0.0);
        return;
    }
    let mut distances = Vec::with_capacity(count);
    for (index, detection) in scan.detections.iter().enumerate() {
        distances.clear();
        let others = scan.detections.iter().enumerate();
        distances.extend(
            others
                .filter(|(other, _)| *other != index)
                .filter_map(|(_, other)| {
                    distance(&detection.measurement, &other.measurement, from_m)
                }),
        );
        if distances.len() < k {
            ratios.push(0.0);
            continue;
        }
        let (_, kth, _) = distances.select_nth_unstable_by(k - 1, f64::total_cmp);
        let found = density_of_neighbours(k, *kth, &detection.measurement);
        let is_told = found.is_finite() && found > 0.0;
        ratios.push(if is_told { (found / density).ln() } else { 0.0 });
    }
}

fn density_of_neighbours(k: usize, distance: f64, report: &Measurement) -> f64 {
    let measure = match report.flat() {
        Measurement::Bearing { .. } => 2.0 * distance,
        _ => PI * distance * distance,
    };
    (k - 1) as f64 / measure
}

/// Between two reports of a sensor: m, or of bearings rad.
fn distance(one: &Measurement, other: &Measurement, from_m: &Position) -> Option<f64> {
    if let (
        Measurement::Bearing { bearing_rad: one },
        Measurement::Bearing { bearing_rad: other },
    ) = (one.flat(), other.flat())
    {
        return Some(wrap(one - other).abs());
    }
    let (one_m, other_m) = (
        one.position_seen_from(from_m)?,
        other.position_seen_from(from_m)?,
    );
    Some((one_m - other_m).norm())
}

#[cfg(test)]
mod tests;
