//! What a sensor of a session reports, which follows from the noises that are told of it.

use crate::model::own::Own;
use crate::model::scan::Measurement;
use crate::model::sensor::SensorSettings;

/// Of one sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reports {
    kind: Kind,
    /// Whether each detection has a range rate.
    range_rates: bool,
    /// Whether a detection may have a velocity.
    pub velocities: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Places,
    PlacesInSpace,
    RangesAndBearings,
    RangesBearingsAndElevations,
    Bearings,
    BearingsAndElevations,
}

impl Kind {
    fn of(settings: &SensorSettings) -> Option<Self> {
        let is_placed = settings.sigma_x_m.is_some() && settings.sigma_y_m.is_some();
        let (has_range, has_bearing) = (
            settings.sigma_range_m.is_some(),
            settings.sigma_bearing_deg.is_some(),
        );
        let has_elevation = settings.sigma_elevation_deg.is_some();
        match (is_placed, has_range, has_bearing) {
            (true, false, false) if settings.sigma_z_m.is_some() => Some(Kind::PlacesInSpace),
            (true, false, false) => Some(Kind::Places),
            (false, true, true) if has_elevation => Some(Kind::RangesBearingsAndElevations),
            (false, true, true) => Some(Kind::RangesAndBearings),
            (false, false, true) if has_elevation => Some(Kind::BearingsAndElevations),
            (false, false, true) => Some(Kind::Bearings),
            _ => None,
        }
    }

    fn has_range(self) -> bool {
        matches!(
            self,
            Kind::RangesAndBearings | Kind::RangesBearingsAndElevations
        )
    }

    fn is_place(self) -> bool {
        matches!(self, Kind::Places | Kind::PlacesInSpace)
    }
}

impl Reports {
    /// `None` where no noise is told, that of two kinds, or that of what is not reported beside it.
    pub fn of(settings: &SensorSettings) -> Option<Self> {
        let kind = Kind::of(settings)?;
        let reports = Reports {
            kind,
            range_rates: settings.sigma_range_rate_mps.is_some(),
            velocities: settings.sigma_speed_mps.is_some(),
        };
        let fits =
            (kind.has_range() || !reports.range_rates) && (kind.is_place() || !reports.velocities);
        fits.then_some(reports)
    }

    pub fn is_direction(self) -> bool {
        matches!(self.kind, Kind::Bearings | Kind::BearingsAndElevations)
    }

    pub fn tells_place_in_space(self) -> bool {
        matches!(
            self.kind,
            Kind::PlacesInSpace | Kind::RangesBearingsAndElevations
        )
    }

    /// For people.
    pub fn name(self) -> String {
        let name = match self.kind {
            Kind::Places => "places",
            Kind::PlacesInSpace => "places in space",
            Kind::RangesAndBearings => "ranges and bearings",
            Kind::RangesBearingsAndElevations => "ranges, bearings and elevations",
            Kind::Bearings => "bearings",
            Kind::BearingsAndElevations => "bearings and elevations",
        };
        let more = if self.range_rates {
            " with range rates"
        } else {
            ""
        };
        format!("{name}{more}")
    }

    /// What each detection has.
    pub fn fields(self) -> Vec<&'static str> {
        let mut fields = match self.kind {
            Kind::Places => vec!["x_m", "y_m"],
            Kind::PlacesInSpace => vec!["x_m", "y_m", "z_m"],
            Kind::RangesAndBearings => vec!["range_m", "bearing_deg"],
            Kind::RangesBearingsAndElevations => vec!["range_m", "bearing_deg", "elevation_deg"],
            Kind::Bearings => vec!["bearing_deg"],
            Kind::BearingsAndElevations => vec!["bearing_deg", "elevation_deg"],
        };
        if self.range_rates {
            fields.push("range_rate_mps");
        }
        fields
    }

    /// Any such report, with a velocity where it may have one.
    pub fn sample(self) -> (Measurement, Own) {
        let own = Own {
            velocity_mps: self.velocities.then_some([0.0, 0.0]),
            ..Own::default()
        };
        (self.measurement(), own)
    }

    fn measurement(self) -> Measurement {
        let (range_m, bearing_rad, elevation_rad) = (1000.0, 0.0, 0.1);
        let range_rate_mps = self.range_rates.then_some(0.0);
        match self.kind {
            Kind::Places => Measurement::Position { x_m: 0.0, y_m: 0.0 },
            Kind::PlacesInSpace => Measurement::Position3 {
                x_m: 0.0,
                y_m: 0.0,
                z_m: 0.0,
            },
            Kind::RangesAndBearings => Measurement::RangeBearing {
                range_m,
                bearing_rad,
                range_rate_mps,
            },
            Kind::RangesBearingsAndElevations => Measurement::RangeBearingElevation {
                range_m,
                bearing_rad,
                elevation_rad,
                range_rate_mps,
            },
            Kind::Bearings => Measurement::Bearing { bearing_rad },
            Kind::BearingsAndElevations => Measurement::BearingElevation {
                bearing_rad,
                elevation_rad,
            },
        }
    }
}
