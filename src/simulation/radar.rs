//! One scan of a sensor that reports positions, ranges and bearings, or bearings alone: detection with probability P_D where it sees,
//! and Gaussian noise on each value; the [false detections](super::clutter) are drawn besides.

use super::carriers::Carriers;
use super::clutter;
use super::coverage::Coverage;
use super::echoes::Echoes;
use super::targets::Path;
use super::view::View;
use crate::math::rng::{Purpose, Seed};
use crate::model::scan::{Detection, Measurement};
use crate::model::scenario::{ReportNoise, ScenarioSensor};
use crate::model::sensing::Site;
use crate::model::sight::Spot;
use crate::model::space::{Place, Space};
use crate::model::state::Position;
use crate::model::truth::TruthPoint;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::{FRAC_PI_2, TAU};

/// A sensor at work.
#[derive(Clone, Copy)]
pub(super) struct Radar<'a> {
    pub sensor: &'a ScenarioSensor,
    /// Its place among the sensors of the scenario.
    pub index: usize,
    pub noise: ReportNoise,
    pub view: &'a View,
    pub coverage: &'a Coverage,
    pub carriers: &'a Carriers,
    /// Speed of the fastest target of the scene: range rates of false detections are uniform between it and its opposite.
    pub fastest_mps: f64,
    /// Of the targets.
    pub space: Space,
    /// Where it stands in a volume.
    pub site: Site,
}

/// A detection, and the velocity over ground that it tells.
pub(super) struct Found {
    pub detection: Detection,
    pub velocity_mps: Option<[f64; 2]>,
}

/// How probably a sensor at a place detects a target; 0 outside its field of view, which in space is a part of a half ball. Directions
/// have no range.
pub(super) fn p_d(
    (sensor, place_m): (&ScenarioSensor, Position),
    view: &View,
    space: Space,
    point: &TruthPoint,
) -> f64 {
    if !space.has_places() {
        return view.p_d(&Spot {
            bearing_rad: point.position.x,
            range_m: None,
        });
    }
    let from_m = Place::new(place_m.x, place_m.y, sensor.in_space.z_m.unwrap_or(0.0));
    let spot = Spot::of_place(&point.position.xy(), &place_m);
    let is_near = |max_range_m| match space {
        Space::Volume => (point.position - from_m).norm() <= max_range_m,
        _ => true,
    };
    if sensor.max_range_m.is_some_and(is_near) {
        view.p_d(&spot)
    } else {
        0.0
    }
}

/// The detections of one scan, targets first. `seen[path]` is the index of the path's target in the recording.
pub(super) fn scan(
    radar: Radar,
    scan_index: u64,
    time_s: f64,
    paths: &[Path],
    seen: &[Option<u32>],
    seed: Seed,
) -> Vec<Found> {
    let mut found = Vec::new();
    let mut bearings_rad = Vec::new();
    let place_m = radar.place_m(time_s);
    for (index, path) in paths.iter().enumerate() {
        if !path.exists_at(time_s) || !radar.coverage.includes(radar.index, index) {
            continue;
        }
        let point = path.point_at(time_s);
        let p_d = p_d((radar.sensor, place_m), radar.view, radar.space, &point);
        if p_d > 0.0 {
            bearings_rad.push(radar.bearing_rad(&point).rem_euclid(TAU));
            let entity = ((radar.index as u64) << 32) | index as u64;
            let mut draw = seed.stream(Purpose::Detection, entity, scan_index);
            if draw.random::<f64>() < p_d {
                // A stream of its own: with amplitudes and without a scene is the same.
                let mut strength = seed.stream(Purpose::Amplitude, entity, scan_index);
                found.extend(radar.detect(&point, seen[index], (&mut draw, &mut strength)));
            }
        }
    }
    bearings_rad.sort_by(f64::total_cmp);
    clutter::add_clutter(radar, (scan_index, time_s), &bearings_rad, seed, &mut found);
    found
}

impl Radar<'_> {
    /// A detection of a target, with draws for its errors and for its strength.
    fn detect<R: Rng>(
        &self,
        point: &TruthPoint,
        origin: Option<u32>,
        (draw, strength): (&mut R, &mut R),
    ) -> Option<Found> {
        let errors: [f64; 4] = std::array::from_fn(|_| StandardNormal.sample(draw));
        let measurement = self.report(point, errors)?;
        let amplitude = Echoes::of(self.sensor).map(|echoes| echoes.of_target(strength));
        let detection = Detection {
            measurement,
            origin,
            amplitude,
        };
        Some(Found {
            detection,
            velocity_mps: self.velocity_mps(point, draw),
        })
    }

    /// Over ground, of a sensor that tells it: its noise is along the velocity and across it.
    fn velocity_mps(&self, point: &TruthPoint, draw: &mut impl Rng) -> Option<[f64; 2]> {
        let sight = &self.sensor.sight;
        let sigma_mps = sight.sigma_speed_mps?;
        let velocity_mps = point.velocity.unwrap_or_default().xy();
        let speed_mps = velocity_mps.norm();
        let along = velocity_mps.try_normalize(0.0).unwrap_or_else(Position::y);
        let across = Position::new(along.y, -along.x);
        let across_mps = sight
            .sigma_course_deg
            .map_or(sigma_mps, |sigma_deg| speed_mps * sigma_deg.to_radians());
        let errors: [f64; 2] = std::array::from_fn(|_| StandardNormal.sample(draw));
        let told =
            velocity_mps + along * (errors[0] * sigma_mps) + across * (errors[1] * across_mps);
        Some([told.x, told.y])
    }

    pub(super) fn place_m(&self, time_s: f64) -> Position {
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
