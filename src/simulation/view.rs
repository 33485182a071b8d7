//! Where a sensor of a scenario sees, how surely, and where its false detections lie.

use crate::model::scenario::{ReportNoise, ScenarioSensor};
use crate::model::sight::{Limits, SectorSettings, Spot, ViewSettings};
use rand::{Rng, RngExt};
use std::f64::consts::TAU;

/// What one sensor sees.
pub(super) struct View {
    pub limits: Limits,
    pub sectors: Vec<Sector>,
    p_d: f64,
}

/// A part that differs.
pub(super) struct Sector {
    pub limits: Limits,
    p_d: Option<f64>,
    has_clutter_of_its_own: bool,
    /// Mean number of false detections in the whole sector, if its density is its own.
    pub mean_clutter: f64,
}

impl View {
    pub fn of(sensor: &ScenarioSensor) -> Self {
        let limits = sensor.view();
        let sectors = sensor.sight.sectors.iter().flatten();
        View {
            limits,
            sectors: sectors.map(|sector| Sector::of(sector, sensor)).collect(),
            p_d: sensor.p_d,
        }
    }

    /// The first sector that holds a place.
    pub fn sector_of(&self, spot: &Spot) -> Option<usize> {
        let mut sectors = self.sectors.iter();
        sectors.position(|sector| sector.limits.hold(spot))
    }

    /// 0 outside the field of view.
    pub fn p_d(&self, spot: &Spot) -> f64 {
        if !self.limits.hold(spot) {
            return 0.0;
        }
        let sector = self.sector_of(spot);
        let own = sector.and_then(|sector| self.sectors[sector].p_d);
        own.unwrap_or(self.p_d)
    }

    /// Whether the density of clutter there is the sensor's.
    pub fn has_clutter_of_sensor(&self, spot: &Spot) -> bool {
        let sector = self.sector_of(spot);
        sector.is_none_or(|sector| !self.sectors[sector].has_clutter_of_its_own)
    }

    /// A range and a bearing, uniform over the field of view.
    pub fn anywhere(&self, draw: &mut impl Rng) -> (f64, f64) {
        View::inside(&self.limits, draw)
    }

    /// Uniform over the part of a ring; the range is 0 where it has no end.
    pub fn inside(limits: &Limits, draw: &mut impl Rng) -> (f64, f64) {
        let share = draw.random::<f64>();
        let (from_m, to_m) = (limits.range_from_m(), limits.range_to_m());
        let range_m = if to_m.is_infinite() {
            0.0
        } else if from_m == 0.0 {
            to_m * share.sqrt()
        } else {
            (from_m * from_m + share * (to_m * to_m - from_m * from_m)).sqrt()
        };
        let (from_rad, width_rad) = limits.arc_rad();
        let bearing_rad = from_rad + width_rad * draw.random::<f64>();
        // A turn from north is as it was drawn.
        let is_turned = bearing_rad >= TAU;
        (
            range_m,
            if is_turned {
                bearing_rad - TAU
            } else {
                bearing_rad
            },
        )
    }
}

impl Sector {
    /// Its ranges end where those of the sensor end.
    fn of(settings: &SectorSettings, sensor: &ScenarioSensor) -> Self {
        let seen = sensor.view();
        let view = settings.view();
        let range_to_m = view
            .range_to_m
            .unwrap_or(f64::INFINITY)
            .min(seen.range_to_m());
        let range_to_m = Some(range_to_m).filter(|range_m| range_m.is_finite());
        let limits = ViewSettings { range_to_m, ..view }.limits();
        let is_of_bearings = matches!(sensor.noise(), Some(ReportNoise::Bearing { .. }));
        let mean_clutter = if is_of_bearings {
            let width_deg = limits.arc_rad().1.to_degrees();
            settings.clutter_per_deg.map(|per_deg| per_deg * width_deg)
        } else {
            let area_m2 = limits.area_m2(limits.range_to_m()).max(0.0);
            settings.clutter_per_m2.map(|per_m2| per_m2 * area_m2)
        };
        Sector {
            limits,
            p_d: settings.p_d,
            has_clutter_of_its_own: mean_clutter.is_some(),
            mean_clutter: mean_clutter.unwrap_or(0.0),
        }
    }
}
