//! What a sensor sees: where, how surely, and among how much clutter. Bearings are clockwise from north, and all places are
//! relative to where the sensor is at the time of the scan.
//!
//! # Symbols
//! r, β range and bearing of a target; P_D probability that it is detected; P_FA that of a false alarm in a cell of the radar;
//! λ density of clutter.
//!
//! # Method
//! 1. Outside the field of view P_D = 0.
//! 2. Inside it the first sector that holds a place says P_D and λ there; what it leaves open, and where no sector is, the
//!    sensor says.
//! 3. Where P_D is stated for a range r₀ it falls with the range as that of a radar does whose targets fluctuate slowly
//!    (Swerling 1): P_D(r) = P_FA^(1 / (1 + SNR₀ (r₀ / r)⁴)) with 1 + SNR₀ = ln P_FA / ln P_D(r₀).
//! 4. P_D of an uncertain track is the mean over its Gaussian: over 7 × 7 points of equal weight in range and bearing. So it
//!    fades at an edge.
//!
//! # Reference
//! P. Swerling, Probability of Detection for Fluctuating Targets, IRE Transactions on Information Theory 6, 1960.

pub mod clutter;
mod settings;

pub use settings::{SectorSettings, ViewSettings};

use super::scan::{Measurement, Scan};
use super::state::{GaussianState, Position};
use clutter::{ClutterMap, ClutterPlan};
use std::f64::consts::{PI, TAU};

/// A place as a sensor sees it; where only directions are known there is no range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    pub bearing_rad: f64,
    pub range_m: Option<f64>,
}

impl Spot {
    /// Of a place seen from another.
    pub fn of_place(place_m: &Position, from_m: &Position) -> Spot {
        let offset_m = place_m - from_m;
        Spot {
            bearing_rad: offset_m[0].atan2(offset_m[1]),
            range_m: Some(offset_m.norm()),
        }
    }

    /// Of a report, along the ground.
    pub fn of_report(report: &Measurement, from_m: &Position) -> Spot {
        match report.flat() {
            Measurement::RangeBearing {
                range_m,
                bearing_rad,
                ..
            } => Spot {
                bearing_rad,
                range_m: Some(range_m),
            },
            Measurement::Bearing { bearing_rad } => Spot {
                bearing_rad,
                range_m: None,
            },
            Measurement::Position { x_m, y_m } | Measurement::Position3 { x_m, y_m, .. } => {
                Spot::of_place(&Position::new(x_m, y_m), from_m)
            }
            // Those are flat now.
            Measurement::RangeBearingElevation { bearing_rad, .. }
            | Measurement::BearingElevation { bearing_rad, .. } => Spot {
                bearing_rad,
                range_m: None,
            },
        }
    }
}

/// An interval of bearings and one of ranges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// From 0 to 2π.
    from_rad: f64,
    /// Clockwise from there: up to 2π.
    width_rad: f64,
    range_from_m: f64,
    range_to_m: f64,
}

impl Limits {
    /// Everything.
    pub const ALL: Limits = Limits {
        from_rad: 0.0,
        width_rad: TAU,
        range_from_m: 0.0,
        range_to_m: f64::INFINITY,
    };

    /// Where ranges are not known, bearings alone decide.
    pub fn hold(&self, spot: &Spot) -> bool {
        let is_in_arc = self.width_rad >= TAU
            || (spot.bearing_rad - self.from_rad).rem_euclid(TAU) <= self.width_rad;
        is_in_arc
            && spot
                .range_m
                .is_none_or(|range_m| self.range_from_m <= range_m && range_m <= self.range_to_m)
    }

    /// From and width (rad).
    pub fn arc_rad(&self) -> (f64, f64) {
        (self.from_rad, self.width_rad)
    }

    /// Of the part of a ring that it is up to a range; of the whole turn exactly π r².
    pub fn area_m2(&self, range_m: f64) -> f64 {
        let turn = self.width_rad / TAU;
        turn * (PI * range_m * range_m - PI * self.range_from_m.powi(2))
    }

    pub fn range_from_m(&self) -> f64 {
        self.range_from_m
    }

    /// Infinite where nothing says it.
    pub fn range_to_m(&self) -> f64 {
        self.range_to_m
    }
}

/// A part of the field of view that differs from the rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sector {
    pub limits: Limits,
    /// In place of the sensor's.
    pub p_d: Option<f64>,
    /// ln of its density of clutter over the sensor's; 0 where they are the same.
    pub log_clutter_ratio: f64,
}

/// P_D of a radar by range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeLaw {
    /// r₀.
    pub at_m: f64,
    /// ln P_FA.
    pub log_p_fa: f64,
    /// SNR₀.
    pub snr: f64,
}

impl RangeLaw {
    /// Of a sensor with this P_D at the range `at_m`; `p_fa` < `p_d` < 1.
    pub fn new(p_d: f64, at_m: f64, p_fa: f64) -> Self {
        RangeLaw {
            at_m,
            log_p_fa: p_fa.ln(),
            snr: p_fa.ln() / p_d.ln() - 1.0,
        }
    }

    /// Step 3; 1 at the sensor itself.
    pub fn p_d(&self, range_m: f64) -> f64 {
        let snr = self.snr * (self.at_m / range_m).powi(4);
        (self.log_p_fa / (1.0 + snr)).exp()
    }
}

/// What a sensor sees, where it is not the same everywhere.
#[derive(Debug, Clone, PartialEq)]
pub struct Sight {
    /// Where the sensor stands, unless the scan says it.
    pub place_m: Position,
    pub view: Limits,
    /// The first that holds a place is its.
    pub sectors: Vec<Sector>,
    /// P_D where no sector says another.
    pub p_d: f64,
    pub by_range: Option<RangeLaw>,
    /// How its density of clutter is learnt; `None` where the sensor and its sectors say it.
    pub clutter: Option<ClutterPlan>,
}

/// Middles of seven parts of equal probability of the standard normal distribution.
const STRATA: [f64; 7] = [
    -1.465_233_793,
    -0.791_638_608,
    -0.366_106_357,
    0.0,
    0.366_106_357,
    0.791_638_608,
    1.465_233_793,
];

impl Sight {
    /// Where the sensor is at a scan.
    pub fn place_in(&self, scan: &Scan) -> Position {
        scan.sensor_place_m(self.place_m)
    }

    /// Steps 1 to 3.
    pub fn p_d_at(&self, spot: &Spot) -> f64 {
        if !self.view.hold(spot) {
            return 0.0;
        }
        if let Some(p_d) = self.sector_of(spot).and_then(|sector| sector.p_d) {
            return p_d;
        }
        match (&self.by_range, spot.range_m) {
            (Some(law), Some(range_m)) => law.p_d(range_m),
            _ => self.p_d,
        }
    }

    /// ln of the density of clutter over the sensor's.
    pub fn log_clutter_ratio_at(&self, spot: &Spot) -> f64 {
        self.sector_of(spot)
            .map_or(0.0, |sector| sector.log_clutter_ratio)
    }

    fn sector_of(&self, spot: &Spot) -> Option<&Sector> {
        self.sectors.iter().find(|sector| sector.limits.hold(spot))
    }

    /// Whether clutter differs from place to place.
    pub fn has_clutter_sectors(&self) -> bool {
        let mut sectors = self.sectors.iter();
        sectors.any(|sector| sector.log_clutter_ratio != 0.0)
    }

    /// A map to begin with, of a sensor that learns one.
    pub fn new_map(&self) -> Option<ClutterMap> {
        let Some(ClutterPlan::Map(plan)) = &self.clutter else {
            return None;
        };
        let ratio = |cell| {
            let middle = plan.middle_of(cell, &self.place_m);
            self.log_clutter_ratio_at(&middle).exp()
        };
        Some(ClutterMap::new((0..plan.cell_count()).map(ratio).collect()))
    }

    /// ln of the density of clutter at each detection of a scan over the sensor's, `density`; nothing where it is that everywhere.
    pub fn clutter_ratios(
        &self,
        scan: &Scan,
        map: Option<&ClutterMap>,
        density: f64,
        ratios: &mut Vec<f64>,
    ) {
        let from_m = self.place_in(scan);
        let reports = scan
            .detections
            .iter()
            .map(|detection| &detection.measurement);
        match (&self.clutter, map) {
            (Some(ClutterPlan::Map(plan)), Some(map)) => {
                ratios.extend(reports.map(|report| map.log_ratio(plan, report, &from_m)));
            }
            (Some(ClutterPlan::Nearest { k }), _) => {
                clutter::log_ratios_by_neighbours(*k, (scan, &from_m), density, ratios);
            }
            _ if self.has_clutter_sectors() => {
                let spots = reports.map(|report| Spot::of_report(report, &from_m));
                ratios.extend(spots.map(|spot| self.log_clutter_ratio_at(&spot)));
            }
            _ => {}
        }
    }

    /// The highest P_D that is stated.
    pub fn highest_p_d(&self) -> f64 {
        let stated = self.sectors.iter().filter_map(|sector| sector.p_d);
        stated.fold(self.p_d, f64::max)
    }

    /// Step 4, of kinematics in the plane or in a volume, or of a bearing and its rate.
    pub fn mean_p_d<const K: usize>(&self, belief: &GaussianState<K>, from_m: &Position) -> f64 {
        let (spot, spread) = seen_from(belief, from_m);
        let first = self.p_d_at(&spot);
        let mut surplus = 0.0;
        for along in STRATA {
            for across in STRATA {
                let point = Spot {
                    bearing_rad: spot.bearing_rad + spread.turn * along + spread.across * across,
                    range_m: spot.range_m.map(|range_m| range_m + spread.along_m * along),
                };
                surplus += self.p_d_at(&point.in_front()) - first;
            }
        }
        // Exactly that of the middle where all are the same.
        first + surplus / 49.0
    }
}

impl Spot {
    /// A range below 0 is one in the opposite direction.
    fn in_front(self) -> Spot {
        match self.range_m {
            Some(range_m) if range_m < 0.0 => Spot {
                bearing_rad: self.bearing_rad + TAU / 2.0,
                range_m: Some(-range_m),
            },
            _ => self,
        }
    }
}

/// The lower triangle of the root of a covariance in range and bearing.
struct Spread {
    along_m: f64,
    /// Of the bearing with the range.
    turn: f64,
    across: f64,
}

/// Where a target is expected, and how uncertain that is.
fn seen_from<const K: usize>(belief: &GaussianState<K>, from_m: &Position) -> (Spot, Spread) {
    let (mean, covariance) = (&belief.mean, &belief.covariance);
    if K < 4 {
        let spot = Spot {
            bearing_rad: mean[0],
            range_m: None,
        };
        let spread = Spread {
            along_m: 0.0,
            turn: 0.0,
            across: covariance[(0, 0)].max(0.0).sqrt(),
        };
        return (spot, spread);
    }
    let spot = Spot::of_place(&Position::new(mean[0], mean[1]), from_m);
    let (sin, cos) = spot.bearing_rad.sin_cos();
    let (xx, xy, yy) = (covariance[(0, 0)], covariance[(0, 1)], covariance[(1, 1)]);
    // u = (sin, cos) along the range, t = (cos, −sin) clockwise across it.
    let along = sin * sin * xx + 2.0 * sin * cos * xy + cos * cos * yy;
    let across = cos * cos * xx - 2.0 * sin * cos * xy + sin * sin * yy;
    let both = sin * cos * (xx - yy) + (cos * cos - sin * sin) * xy;
    let along_m = along.max(0.0).sqrt();
    // A target that may be on either side of the sensor has no narrower bearing than this.
    let range_m = spot.range_m.unwrap_or(0.0).max(across.max(0.0).sqrt());
    let shear = if along_m > 0.0 { both / along_m } else { 0.0 };
    let spread = Spread {
        along_m,
        turn: shear / range_m.max(f64::MIN_POSITIVE),
        across: (across - shear * shear).max(0.0).sqrt() / range_m.max(f64::MIN_POSITIVE),
    };
    (spot, spread)
}

#[cfg(test)]
mod tests;
