//! What a sensor of a session reports, which follows from the noises that are told of it.

use crate::model::scan::Measurement;
use crate::model::sensor::SensorSettings;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reports {
    Places,
    PlacesInSpace,
    RangesAndBearings,
    RangesBearingsAndElevations,
    Bearings,
    BearingsAndElevations,
}

impl Reports {
    /// `None` where no noise is told, or that of two kinds.
    pub fn of(settings: &SensorSettings) -> Option<Self> {
        let is_placed = settings.sigma_x_m.is_some() && settings.sigma_y_m.is_some();
        let (has_range, has_bearing) = (
            settings.sigma_range_m.is_some(),
            settings.sigma_bearing_deg.is_some(),
        );
        let has_elevation = settings.sigma_elevation_deg.is_some();
        match (is_placed, has_range, has_bearing) {
            (true, false, false) if settings.sigma_z_m.is_some() => Some(Reports::PlacesInSpace),
            (true, false, false) => Some(Reports::Places),
            (false, true, true) if has_elevation => Some(Reports::RangesBearingsAndElevations),
            (false, true, true) => Some(Reports::RangesAndBearings),
            (false, false, true) if has_elevation => Some(Reports::BearingsAndElevations),
            (false, false, true) => Some(Reports::Bearings),
            _ => None,
        }
    }

    pub fn tells_place_in_space(self) -> bool {
        matches!(
            self,
            Reports::PlacesInSpace | Reports::RangesBearingsAndElevations
        )
    }

    /// For people.
    pub fn name(self) -> &'static str {
        match self {
            Reports::Places => "places",
            Reports::PlacesInSpace => "places in space",
            Reports::RangesAndBearings => "ranges and bearings",
            Reports::RangesBearingsAndElevations => "ranges, bearings and elevations",
            Reports::Bearings => "bearings",
            Reports::BearingsAndElevations => "bearings and elevations",
        }
    }

    /// What each detection has.
    pub fn fields(self) -> &'static [&'static str] {
        match self {
            Reports::Places => &["x_m", "y_m"],
            Reports::PlacesInSpace => &["x_m", "y_m", "z_m"],
            Reports::RangesAndBearings => &["range_m", "bearing_deg"],
            Reports::RangesBearingsAndElevations => &["range_m", "bearing_deg", "elevation_deg"],
            Reports::Bearings => &["bearing_deg"],
            Reports::BearingsAndElevations => &["bearing_deg", "elevation_deg"],
        }
    }

    /// Any such report.
    pub fn sample(self) -> Measurement {
        let (range_m, bearing_rad, elevation_rad) = (1000.0, 0.0, 0.1);
        match self {
            Reports::Places => Measurement::Position { x_m: 0.0, y_m: 0.0 },
            Reports::PlacesInSpace => Measurement::Position3 {
                x_m: 0.0,
                y_m: 0.0,
                z_m: 0.0,
            },
            Reports::RangesAndBearings => Measurement::RangeBearing {
                range_m,
                bearing_rad,
                range_rate_mps: None,
            },
            Reports::RangesBearingsAndElevations => Measurement::RangeBearingElevation {
                range_m,
                bearing_rad,
                elevation_rad,
                range_rate_mps: None,
            },
            Reports::Bearings => Measurement::Bearing { bearing_rad },
            Reports::BearingsAndElevations => Measurement::BearingElevation {
                bearing_rad,
                elevation_rad,
            },
        }
    }
}
