//! One scan of a sensor that reports positions, ranges and bearings, or bearings alone: detection with probability P_D,
//! Gaussian noise on each value, and a Poisson number of false detections uniform over the field of view. Where a sensor of
//! bearings has false detections near targets only, those elsewhere are left out: the others stay what they were, and where
//! targets are close together each degree counts once.

use super::carriers::Carriers;
use super::coverage::Coverage;
use super::echoes::Echoes;
use super::targets::Path;
use crate::math::rng::{Purpose, Seed};
use crate::model::angle::wrap;
use crate::model::scan::{Detection, Measurement};
use crate::model::scenario::{ReportNoise, ScenarioSensor};
use crate::model::sensing::Site;
use crate::model::space::{Place, Space};
use crate::model::state::Position;
use crate::model::truth::TruthPoint;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, Gamma, Poisson, StandardNormal};
use std::f64::consts::{FRAC_PI_2, TAU};

/// A sensor at work.
#[derive(Clone, Copy)]
pub(super) struct Radar<'a> {
    pub sensor: &'a ScenarioSensor,
    /// Its place among the sensors of the scenario.
    pub index: usize,
    pub noise: ReportNoise,
    pub coverage: &'a Coverage,
    pub carriers: &'a Carriers,
    /// Speed of the fastest target of the scene: range rates of false detections are uniform between it and its opposite.
    pub fastest_mps: f64,
    /// Of the targets.
    pub space: Space,
    /// Where it stands in a volume.
    pub site: Site,
}

/// Whether a place is inside the sensor's field of view: directions always are. In space that is a half ball.
pub(super) fn is_in_view(
    (sensor, place_m): (&ScenarioSensor, Position),
    space: Space,
    point: &TruthPoint,
) -> bool {
    let from_m = Place::new(place_m.x, place_m.y, sensor.in_space.z_m.unwrap_or(0.0));
    let range_m = if space == Space::Volume {
        (point.position - from_m).norm()
    } else {
        (point.position.xy() - place_m).norm()
    };
    let is_near = |max_range_m| range_m <= max_range_m;
    !space.has_places() || sensor.max_range_m.is_some_and(is_near)
}

/// The detections of one scan, targets first. `seen[path]` is the index of the path's target in the recording.
pub(super) fn scan(
    radar: Radar,
    scan_index: u64,
    time_s: f64,
    paths: &[Path],
    seen: &[Option<u32>],
    seed: Seed,
) -> Vec<Detection> {
    let mut found = Vec::new();
    let mut bearings_rad = Vec::new();
    let echoes = Echoes::of(radar.sensor);
    for (index, path) in paths.iter().enumerate() {
        if !path.exists_at(time_s) {
            continue;
        }
        let point = path.point_at(time_s);
        if radar.coverage.includes(radar.index, index)
            && is_in_view((radar.sensor, radar.place_m(time_s)), radar.space, &point)
        {
            bearings_rad.push(radar.bearing_rad(&point).rem_euclid(TAU));
            let entity = ((radar.index as u64) << 32) | index as u64;
            let mut draw = seed.stream(Purpose::Detection, entity, scan_index);
            if draw.random::<f64>() < radar.sensor.p_d {
                let errors: [f64; 4] = std::array::from_fn(|_| StandardNormal.sample(&mut draw));
                let report = radar.report(&point, errors);
                // A stream of its own: with amplitudes and without a scene is the same.
                let mut strength = seed.stream(Purpose::Amplitude, entity, scan_index);
                found.extend(report.map(|measurement| Detection {
                    measurement,
                    origin: seen[index],
                    amplitude: echoes.map(|echoes| echoes.of_target(&mut strength)),
                }));
            }
        }
    }
    bearings_rad.sort_by(f64::total_cmp);
    radar.add_clutter((scan_index, time_s), &bearings_rad, seed, &mut found);
    found
}

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
    // A mean of zero is no distribution at all: then there is no clutter.
    Poisson::new(mean).map_or(0.0, |count| count.sample(draw)) as u64
}

impl Radar<'_> {
    /// `bearings_rad`: where the targets in view really are, in rising order.
    fn add_clutter(
        &self,
        (scan_index, time_s): (u64, f64),
        bearings_rad: &[f64],
        seed: Seed,
        found: &mut Vec<Detection>,
    ) {
        let sensor = self.sensor;
        let (echoes, place_m) = (Echoes::of(sensor), self.place_m(time_s));
        let mut draw = seed.stream(Purpose::Clutter, self.index as u64, scan_index);
        let mut strength = seed.stream(Purpose::Amplitude, self.all_noise(), scan_index);
        let number = clutter_count(sensor, &mut draw);
        for _ in 0..number {
            let range_m = sensor.max_range_m.unwrap_or(0.0) * draw.random::<f64>().sqrt();
            let bearing_rad = TAU * draw.random::<f64>();
            let (x_m, y_m) = (
                place_m.x + range_m * bearing_rad.sin(),
                place_m.y + range_m * bearing_rad.cos(),
            );
            let measurement = match self.noise {
                _ if sensor.tells_heights() => {
                    let rise_m = sensor.clutter_height_m() * draw.random::<f64>();
                    let rate_mps = self.fastest_mps * (2.0 * draw.random::<f64>() - 1.0);
                    self.high_clutter((range_m, bearing_rad, rise_m), rate_mps)
                }
                ReportNoise::Position { .. } => Measurement::Position { x_m, y_m },
                ReportNoise::RangeBearing {
                    sigma_range_rate_mps,
                    ..
                } => {
                    let range_rate_mps = sigma_range_rate_mps
                        .map(|_| self.fastest_mps * (2.0 * draw.random::<f64>() - 1.0));
                    Measurement::RangeBearing {
                        range_m,
                        bearing_rad,
                        range_rate_mps,
                    }
                }
                ReportNoise::Bearing { .. } if self.leaves_out(bearing_rad, bearings_rad) => {
                    continue;
                }
                ReportNoise::Bearing { .. } => Measurement::Bearing { bearing_rad },
            };
            found.push(Detection {
                measurement,
                origin: None,
                amplitude: echoes.map(|echoes| echoes.of_noise(&mut strength)),
            });
        }
    }

    /// The entity of all false detections of the sensor: no target of it has this number.
    fn all_noise(&self) -> u64 {
        ((self.index as u64) << 32) | u64::from(u32::MAX)
    }

    /// Whether a false detection is too far from every target.
    fn leaves_out(&self, bearing_rad: f64, bearings_rad: &[f64]) -> bool {
        let Some(within_deg) = self.sensor.clutter_within_deg else {
            return false;
        };
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

    fn place_m(&self, time_s: f64) -> Position {
        self.carriers.place_m(self.index, time_s)
    }

    /// The direction of a target.
    fn bearing_rad(&self, point: &TruthPoint) -> f64 {
        match self.space {
            Space::Bearing => point.position.x,
            Space::Plane => {
                let offset_m = point.position.xy() - self.place_m(point.time_s);
                offset_m.x.atan2(offset_m.y)
            }
            Space::Volume => {
                let offset_m = self.offset_m(point);
                offset_m.x.atan2(offset_m.y)
            }
        }
    }

    /// Where a target is from a sensor of a volume, on its own axes.
    fn offset_m(&self, point: &TruthPoint) -> Place {
        self.site.turn * (point.position - self.site.place_m)
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

    /// What a sensor of a volume reports of a target: like [`Radar::report`]. Without heights ranges are slant ranges still.
    fn report_in_volume(&self, point: &TruthPoint, errors: [f64; 4]) -> Measurement {
        let offset_m = self.offset_m(point);
        let elevation_rad = offset_m.z.atan2(offset_m.xy().norm());
        let seen_rad = |error_rad: f64| (self.bearing_rad(point) + error_rad).rem_euclid(TAU);
        match self.noise {
            ReportNoise::Position {
                sigma_x_m,
                sigma_y_m,
                sigma_z_m,
            } => {
                let x_m = point.position.x + errors[0] * sigma_x_m;
                let y_m = point.position.y + errors[1] * sigma_y_m;
                match sigma_z_m {
                    Some(sigma_m) => Measurement::Position3 {
                        x_m,
                        y_m,
                        z_m: point.position.z + errors[3] * sigma_m,
                    },
                    None => Measurement::Position { x_m, y_m },
                }
            }
            ReportNoise::RangeBearing {
                sigma_range_m,
                sigma_bearing_rad,
                sigma_elevation_rad,
                sigma_range_rate_mps,
            } => {
                let towards = offset_m.try_normalize(0.0).unwrap_or_else(Place::zeros);
                let velocity_mps = self.site.turn * point.velocity.unwrap_or_default();
                let range_m = (offset_m.norm() + errors[0] * sigma_range_m).abs();
                let bearing_rad = seen_rad(errors[1] * sigma_bearing_rad);
                let range_rate_mps = sigma_range_rate_mps
                    .map(|sigma_mps| towards.dot(&velocity_mps) + errors[2] * sigma_mps);
                match sigma_elevation_rad {
                    Some(sigma_rad) => Measurement::RangeBearingElevation {
                        range_m,
                        bearing_rad,
                        elevation_rad: within_quarter(elevation_rad + errors[3] * sigma_rad),
                        range_rate_mps,
                    },
                    None => Measurement::RangeBearing {
                        range_m,
                        bearing_rad,
                        range_rate_mps,
                    },
                }
            }
            ReportNoise::Bearing {
                sigma_bearing_rad,
                sigma_elevation_rad,
            } => {
                let bearing_rad = seen_rad(errors[0] * sigma_bearing_rad);
                match sigma_elevation_rad {
                    Some(sigma_rad) => Measurement::BearingElevation {
                        bearing_rad,
                        elevation_rad: within_quarter(elevation_rad + errors[3] * sigma_rad),
                    },
                    None => Measurement::Bearing { bearing_rad },
                }
            }
        }
    }

    /// What the sensor reports of a target, with draws of the standard normal distribution as its errors. `None` of a
    /// direction, if it reports places.
    fn report(&self, point: &TruthPoint, errors: [f64; 4]) -> Option<Measurement> {
        let seen_rad = |error_rad: f64| (self.bearing_rad(point) + error_rad).rem_euclid(TAU);
        match (self.noise, self.space) {
            (_, Space::Volume) => Some(self.report_in_volume(point, errors)),
            (
                ReportNoise::Bearing {
                    sigma_bearing_rad, ..
                },
                _,
            ) => Some(Measurement::Bearing {
                bearing_rad: seen_rad(errors[0] * sigma_bearing_rad),
            }),
            (_, Space::Bearing) => None,
            (
                ReportNoise::Position {
                    sigma_x_m,
                    sigma_y_m,
                    ..
                },
                _,
            ) => Some(Measurement::Position {
                x_m: point.position.x + errors[0] * sigma_x_m,
                y_m: point.position.y + errors[1] * sigma_y_m,
            }),
            (
                ReportNoise::RangeBearing {
                    sigma_range_m,
                    sigma_bearing_rad,
                    sigma_range_rate_mps,
                    ..
                },
                _,
            ) => {
                let offset_m = point.position.xy() - self.place_m(point.time_s);
                let pose = self.carriers.pose(self.index, point.time_s);
                let own_mps = pose.map_or_else(Position::zeros, |pose| pose.velocity.xy());
                // A range below 0 would be one in the opposite direction, which no sensor reports.
                let range_m = (offset_m.norm() + errors[0] * sigma_range_m).abs();
                let towards = offset_m.try_normalize(0.0).unwrap_or_else(Position::zeros);
                let approach_mps = point.velocity.map_or(0.0, |velocity_mps| {
                    towards.dot(&(velocity_mps.xy() - own_mps))
                });
                let range_rate_mps =
                    sigma_range_rate_mps.map(|sigma_mps| approach_mps + errors[2] * sigma_mps);
                Some(Measurement::RangeBearing {
                    range_m,
                    bearing_rad: seen_rad(errors[1] * sigma_bearing_rad),
                    range_rate_mps,
                })
            }
        }
    }
}

/// No elevation is beyond straight up or down.
fn within_quarter(elevation_rad: f64) -> f64 {
    elevation_rad.clamp(-FRAC_PI_2, FRAC_PI_2)
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
