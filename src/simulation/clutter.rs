//! The false detections of a scan: a Poisson number, or one more dispersed, uniform over the field of view, and where a sector has a
//! density of its own, in that sector. Where a sensor of bearings has false detections near targets only, those elsewhere are left
//! out: the others stay what they were, and where targets are close together each degree counts once.

use super::echoes::Echoes;
use super::radar::{Found, Radar};
use super::view::View;
use crate::math::rng::{Purpose, Seed};
use crate::model::angle::wrap;
use crate::model::scan::{Detection, Measurement};
use crate::model::scenario::{ReportNoise, ScenarioSensor};
use crate::model::sight::Spot;
use crate::model::space::Place;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, Gamma, Poisson};

/// How many false detections a scan has: a Poisson number, whose mean is itself of a gamma distribution where the number is more
/// dispersed. With shape μ/(a − 1) and scale a − 1 that has mean μ and variance a μ in all (negative binomial).
fn clutter_count(sensor: &ScenarioSensor, draw: &mut impl Rng) -> u64 {
    let mut mean = sensor.mean_clutter();
    let excess = sensor.clutter_dispersion.unwrap_or(1.0) - 1.0;
    if excess > 0.0
        && let Ok(rate) = Gamma::new(mean / excess, excess)
    {
        mean = rate.sample(draw);
    }
    poisson(mean, draw)
}

/// A mean of zero is no distribution at all: then there is none.
fn poisson(mean: f64, draw: &mut impl Rng) -> u64 {
    Poisson::new(mean).map_or(0.0, |count| count.sample(draw)) as u64
}

/// What draws the false detections of one scan.
struct Source<'s, 'r> {
    radar: Radar<'r>,
    time_s: f64,
    /// Where the targets in view really are, in rising order.
    bearings_rad: &'s [f64],
    echoes: Option<Echoes>,
}

/// Adds the false detections of a scan; `bearings_rad`: where the targets in view really are, in rising order.
pub(super) fn add_clutter(
    radar: Radar,
    (scan_index, time_s): (u64, f64),
    bearings_rad: &[f64],
    seed: Seed,
    found: &mut Vec<Found>,
) {
    let source = Source {
        radar,
        time_s,
        bearings_rad,
        echoes: Echoes::of(radar.sensor),
    };
    let mut draw = seed.stream(Purpose::Clutter, radar.index as u64, scan_index);
    let mut strength = seed.stream(Purpose::Amplitude, radar.all_noise(), scan_index);
    for _ in 0..clutter_count(radar.sensor, &mut draw) {
        let (range_m, bearing_rad) = radar.view.anywhere(&mut draw);
        let report = source.report((range_m, bearing_rad), &mut draw);
        if radar
            .view
            .has_clutter_of_sensor(&source.spot(range_m, bearing_rad))
        {
            found.extend(report.map(|report| source.found(report, &mut strength)));
        }
    }
    for (index, sector) in radar.view.sectors.iter().enumerate() {
        for _ in 0..poisson(sector.mean_clutter, &mut draw) {
            let (range_m, bearing_rad) = View::inside(&sector.limits, &mut draw);
            let report = source.report((range_m, bearing_rad), &mut draw);
            let spot = source.spot(range_m, bearing_rad);
            if radar.view.limits.hold(&spot) && radar.view.sector_of(&spot) == Some(index) {
                found.extend(report.map(|report| source.found(report, &mut strength)));
            }
        }
    }
}

impl Source<'_, '_> {
    /// Bearings alone have no range.
    fn spot(&self, range_m: f64, bearing_rad: f64) -> Spot {
        let has_range = !matches!(self.radar.noise, ReportNoise::Bearing { .. });
        Spot {
            bearing_rad,
            range_m: Some(range_m).filter(|_| has_range),
        }
    }

    fn found(&self, (measurement, velocity_mps): Report, strength: &mut impl Rng) -> Found {
        let detection = Detection {
            measurement,
            origin: None,
            amplitude: self.echoes.map(|echoes| echoes.of_noise(strength)),
        };
        Found {
            detection,
            velocity_mps,
        }
    }

    /// A false detection there; `None` where it is too far from every target.
    fn report(&self, (range_m, bearing_rad): (f64, f64), draw: &mut impl Rng) -> Option<Report> {
        let (sensor, place_m) = (self.radar.sensor, self.radar.place_m(self.time_s));
        let fastest_mps = self.radar.fastest_mps;
        let measurement = match self.radar.noise {
            _ if sensor.tells_heights() => {
                let rise_m = sensor.clutter_height_m() * draw.random::<f64>();
                let rate_mps = fastest_mps * (2.0 * draw.random::<f64>() - 1.0);
                self.radar
                    .high_clutter((range_m, bearing_rad, rise_m), rate_mps)
            }
            ReportNoise::Position { .. } => Measurement::Position {
                x_m: place_m.x + range_m * bearing_rad.sin(),
                y_m: place_m.y + range_m * bearing_rad.cos(),
            },
            ReportNoise::RangeBearing {
                sigma_range_rate_mps,
                ..
            } => {
                let range_rate_mps =
                    sigma_range_rate_mps.map(|_| fastest_mps * (2.0 * draw.random::<f64>() - 1.0));
                Measurement::RangeBearing {
                    range_m,
                    bearing_rad,
                    range_rate_mps,
                }
            }
            ReportNoise::Bearing { .. } if self.leaves_out(bearing_rad) => return None,
            ReportNoise::Bearing { .. } => Measurement::Bearing { bearing_rad },
        };
        // East and north each between the fastest target and its opposite.
        let velocity_mps = sensor
            .sight
            .sigma_speed_mps
            .map(|_| [(); 2].map(|()| fastest_mps * (2.0 * draw.random::<f64>() - 1.0)));
        Some((measurement, velocity_mps))
    }

    /// Whether a false detection is too far from every target.
    fn leaves_out(&self, bearing_rad: f64) -> bool {
        let Some(within_deg) = self.radar.sensor.clutter_within_deg else {
            return false;
        };
        let bearings_rad = self.bearings_rad;
        let after = bearings_rad.partition_point(|&other| other < bearing_rad);
        let neighbours = [
            bearings_rad.get(after).or(bearings_rad.first()),
            bearings_rad[..after].last().or(bearings_rad.last()),
        ];
        !neighbours
            .into_iter()
            .flatten()
            .any(|other| wrap(bearing_rad - other).abs() <= within_deg.to_radians())
    }
}

/// What was measured, and a velocity over ground where the sensor tells one.
type Report = (Measurement, Option<[f64; 2]>);

impl Radar<'_> {
    /// The entity of all false detections of the sensor: no target of it has this number.
    fn all_noise(&self) -> u64 {
        ((self.index as u64) << 32) | u64::from(u32::MAX)
    }

    /// A false detection so far along the ground and above a sensor that tells heights.
    fn high_clutter(
        &self,
        (ground_m, bearing_rad, rise_m): (f64, f64, f64),
        rate_mps: f64,
    ) -> Measurement {
        let offset_m = Place::new(
            ground_m * bearing_rad.sin(),
            ground_m * bearing_rad.cos(),
            rise_m,
        );
        match self.noise {
            ReportNoise::Position { .. } => {
                let place_m = self.site.place_m + self.site.turn.transpose() * offset_m;
                Measurement::Position3 {
                    x_m: place_m.x,
                    y_m: place_m.y,
                    z_m: place_m.z,
                }
            }
            ReportNoise::RangeBearing {
                sigma_range_rate_mps,
                ..
            } => Measurement::RangeBearingElevation {
                range_m: offset_m.norm(),
                bearing_rad,
                elevation_rad: rise_m.atan2(ground_m),
                range_rate_mps: sigma_range_rate_mps.map(|_| rate_mps),
            },
            ReportNoise::Bearing { .. } => Measurement::BearingElevation {
                bearing_rad,
                elevation_rad: rise_m.atan2(ground_m),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// 40 000 scans of mean 10: mean and variance lie within four standard errors of 10 and of 10 and 200. The variance of a sample
    /// variance is (κ₄ + 2σ⁴)/n; a negative binomial number has κ₄ = μ a (1 + 6 (a − 1) + 6 (a − 1)²), a Poisson one μ.
    #[test]
    fn clutter_has_the_stated_mean_and_variance() {
        for dispersion in [None, Some(20.0)] {
            let sensor: ScenarioSensor = serde_json::from_value(json!({
                "sensor_id": "r", "x_m": 0.0, "y_m": 0.0, "p_d": 0.9, "clutter_per_scan": 10.0, "clutter_dispersion": dispersion
            }))
            .unwrap();
            let seed = Seed { seed: 1, run: 0 };
            let scans = 40_000;
            let count =
                |scan| clutter_count(&sensor, &mut seed.stream(Purpose::Clutter, 0, scan)) as f64;
            let counts: Vec<f64> = (0..scans).map(count).collect();
            let mean = counts.iter().sum::<f64>() / scans as f64;
            let squares = counts.iter().map(|count| (count - mean).powi(2));
            let variance = squares.sum::<f64>() / (scans - 1) as f64;
            let a: f64 = dispersion.unwrap_or(1.0);
            let expected = 10.0 * a;
            let fourth = 10.0 * a * (1.0 + 6.0 * (a - 1.0) + 6.0 * (a - 1.0).powi(2));
            let of_mean = (expected / scans as f64).sqrt();
            let of_variance = ((fourth + 2.0 * expected * expected) / scans as f64).sqrt();
            assert!((mean - 10.0).abs() < 4.0 * of_mean, "{mean}");
            assert!(
                (variance - expected).abs() < 4.0 * of_variance,
                "{variance}"
            );
        }
    }
}
