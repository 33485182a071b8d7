//! Of the ways that are not looked at none may begin a track: with a bound that lets all threes pass the same tracks begin.

use super::*;
use crate::association::ASSOCIATORS;
use crate::filtering::{AnyFilter, FILTERS, WithFilter};
use crate::math::rng::{Purpose, Seed};
use crate::model::own::OwnNoise;
use crate::model::scan::{Detection, Measurement};
use crate::model::sensing::{Bearing, Platform, Polar};
use crate::model::sensor::Sensor;
use crate::model::space::Space;
use crate::model::state::Position;
use crate::registry;
use crate::tracking::recorder::RecordedPoint;
use crate::tracking::{Confirmation, Initiation, Lifecycle, Tracker, TrackerParts};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use serde_json::{Value, json};

/// Writes down all that it is told.
#[derive(Default)]
struct Log(Vec<String>);

impl Recorder for Log {
    fn given(&mut self, _serial: u32, _name: &str) {}

    fn point(&mut self, point: &RecordedPoint) {
        self.0.push(format!("{point:?}"));
    }

    fn end(&mut self, serial: u32) {
        self.0.push(format!("{serial} ends"));
    }
}

/// Tracks scans, with bounds so many times as wide.
struct Tracking<'a> {
    parts: TrackerParts,
    scans: &'a [Scan],
    slack: f64,
}

impl Tracking<'_> {
    fn run<F: Filter<K>, const K: usize>(self, filter: F) -> Vec<String> {
        let mut tracker = SingleHypothesis::<F, K>::new(filter, self.parts);
        tracker.scratch.ways.slack = self.slack;
        let mut log = Log::default();
        for scan in self.scans {
            tracker.step(scan, &mut log, &Watch::never()).unwrap();
        }
        tracker.finish(&mut log);
        assert_eq!(tracker.warnings(), Vec::<String>::new());
        log.0
    }
}

impl WithFilter for Tracking<'_> {
    type Output = Vec<String>;

    fn in_plane<F: Filter<4>>(self, filter: F) -> Vec<String> {
        self.run(filter)
    }

    fn in_volume<F: Filter<6>>(self, filter: F) -> Vec<String> {
        self.run(filter)
    }

    fn of_bearings<F: Filter<2>>(self, filter: F) -> Vec<String> {
        self.run(filter)
    }
}

fn filter(spec: &Value) -> AnyFilter {
    let mut fields = spec.clone();
    let method = fields["method"].take();
    fields.as_object_mut().unwrap().remove("method");
    let mut known = FILTERS.iter();
    let entry = known.find(|entry| entry.name == method).unwrap();
    (entry.build)(&registry::check(&fields, entry.parameters).unwrap()).unwrap()
}

const FAR_M: f64 = -30e3;

/// What a sensor reports, and how a place is reported by it. Bearings are from the origin, ranges from so far away that places are
/// nearly linear in them.
#[derive(Debug, Clone, Copy)]
enum Kind {
    Positions,
    Ranges,
    Heights,
    Bearings,
}

impl Kind {
    fn model(self) -> MeasurementModel {
        let place_m = Position::new(
            0.0,
            if matches!(self, Kind::Ranges) {
                FAR_M
            } else {
                0.0
            },
        );
        match self {
            Kind::Positions => MeasurementModel::Position {
                sigma_x_m: 15.0,
                sigma_y_m: 5.0,
            },
            Kind::Ranges => MeasurementModel::Polar(Polar {
                place_m,
                sigma_range_m: 15.0,
                sigma_bearing_rad: 0.002,
                range_rate: None,
                platform: Platform::STANDING,
            }),
            Kind::Heights => MeasurementModel::Position3 {
                sigmas_m: [15.0, 5.0, 30.0],
                clutter_span: None,
            },
            Kind::Bearings => MeasurementModel::Bearing(Bearing {
                place_m,
                sigma_bearing_rad: 0.005,
                platform: Platform::STANDING,
                range_prior: None,
            }),
        }
    }

    fn report(self, [x_m, y_m, z_m]: [f64; 3], errors: [f64; 3]) -> Measurement {
        let [one, two, three] = errors;
        match self {
            Kind::Positions => Measurement::Position {
                x_m: x_m + 15.0 * one,
                y_m: y_m + 5.0 * two,
            },
            Kind::Ranges => Measurement::RangeBearing {
                range_m: x_m.hypot(y_m - FAR_M) + 15.0 * one,
                bearing_rad: x_m.atan2(y_m - FAR_M) + 0.002 * two,
                range_rate_mps: None,
            },
            Kind::Heights => Measurement::Position3 {
                x_m: x_m + 15.0 * one,
                y_m: y_m + 5.0 * two,
                z_m: z_m + 30.0 * three,
            },
            Kind::Bearings => Measurement::Bearing {
                bearing_rad: x_m.atan2(y_m) + 0.005 * one,
            },
        }
    }

    /// Of false detections, as many as `clutter` says.
    fn clutter_density(self, clutter: f64) -> f64 {
        match self {
            Kind::Positions | Kind::Ranges => clutter / 4e8,
            Kind::Heights => clutter / 4e8 / 3000.0,
            Kind::Bearings => clutter / std::f64::consts::TAU,
        }
    }
}

/// Twelve targets that turn or not, and false detections, in a square of 20 km.
fn scans(kind: Kind, seed: u32, has_own: bool) -> Vec<Scan> {
    let draw = &mut Seed { seed, run: 0 }.stream(Purpose::Detection, 0, 0);
    let starts: Vec<[f64; 5]> = (0..12)
        .map(|_| std::array::from_fn(|_| draw.random::<f64>()))
        .collect();
    let mut scans = Vec::new();
    for number in 0..9u32 {
        let mut scan = Scan {
            number,
            // Not as regular as a clock.
            time_s: 8.0 * f64::from(number) + 2.0 * draw.random::<f64>(),
            sensor: 0,
            pose: None,
            detections: Vec::new(),
            own: Vec::new(),
        };
        let mut places = Vec::new();
        for (target, start) in starts.iter().enumerate() {
            if draw.random::<f64>() > 0.85 {
                continue;
            }
            let after_s = if has_own {
                draw.random::<f64>() - 0.5
            } else {
                0.0
            };
            let time_s = scan.time_s + after_s;
            let speed = 300.0 * start[2];
            let turn = if target % 2 == 0 { 0.0 } else { 0.01 };
            let course = std::f64::consts::TAU * start[3] + turn * time_s;
            let (x_m, y_m) = if turn == 0.0 {
                (speed * time_s * course.sin(), speed * time_s * course.cos())
            } else {
                (-speed / turn * course.cos(), speed / turn * course.sin())
            };
            let [x0_m, y0_m, z_m] = [start[0] - 0.5, start[1] - 0.5, start[4]];
            places.push((
                [20e3 * x0_m + x_m, 20e3 * y0_m + y_m, 3e3 * z_m],
                Some(target as u32),
                after_s,
            ));
        }
        for _ in 0..8 {
            let [x, y, z]: [f64; 3] = std::array::from_fn(|_| draw.random::<f64>());
            places.push(([20e3 * (x - 0.5), 20e3 * (y - 0.5), 3e3 * z], None, 0.0));
        }
        for (place, origin, after_s) in places {
            let errors: [f64; 3] = std::array::from_fn(|_| StandardNormal.sample(draw));
            scan.detections.push(Detection {
                measurement: kind.report(place, errors),
                origin,
                amplitude: None,
            });
            if has_own {
                scan.own.push(crate::model::own::Own {
                    after_s,
                    noise: OwnNoise {
                        sigma_x_m: Some(10.0 + 10.0 * draw.random::<f64>()),
                        ..OwnNoise::default()
                    },
                    velocity_mps: None,
                });
            }
        }
        scans.push(scan);
    }
    scans
}

fn parts(filter: AnyFilter, kind: Kind, rule: MultiScan, associator: &str) -> TrackerParts {
    let mut known = ASSOCIATORS.iter();
    let entry = known.find(|entry| entry.name == associator).unwrap();
    let checked = registry::check(&json!({}), entry.parameters).unwrap();
    TrackerParts {
        filter,
        associator: (entry.build)(&checked, Seed { seed: 1, run: 0 }).unwrap(),
        lifecycle: Lifecycle {
            gate_probability: 0.99,
            initiation: Initiation::MultiScan(rule),
            confirmation: Confirmation::MOfN,
            confirm_hits: 3,
            confirm_window: 5,
            max_missed: 3,
            max_missed_s: None,
            max_position_sigma_m: None,
            initial_speed_sigma_mps: 150.0,
            smoothing: None,
            merging: None,
        },
        sensors: vec![Sensor {
            sensor_id: "radar".into(),
            p_d: 0.85,
            clutter_density: kind.clutter_density(8.0),
            may_start: true,
            report: kind.model(),
            sight: None,
        }],
        undetected: None,
        given: Vec::new(),
    }
}

const RULE: MultiScan = MultiScan {
    max_speed_mps: None,
    window_scans: 5,
    min_detections: 3,
    max_gap_scans: 2,
    max_nodes: 1_000_000,
};

/// How many points tracks have, which are the same with any bound.
fn compare(
    spec: &Value,
    kind: Kind,
    rule: MultiScan,
    (associator, has_own): (&str, bool),
) -> usize {
    let mut filter = filter(spec);
    if matches!(kind, Kind::Heights) {
        filter = filter.within(Space::Volume);
    }
    let mut points = 0;
    for seed in 1..4 {
        let scans = scans(kind, seed, has_own);
        let [bounded, free] = [1.0, f64::INFINITY].map(|slack| {
            filter.with(Tracking {
                parts: parts(filter, kind, rule, associator),
                scans: &scans,
                slack,
            })
        });
        assert_eq!(
            bounded.len(),
            free.len(),
            "{spec} {kind:?} {associator} {seed}"
        );
        for (one, other) in bounded.iter().zip(&free) {
            assert_eq!(one, other, "{spec} {kind:?} {associator} {seed}");
        }
        points += bounded.len();
    }
    points
}

#[test]
fn the_bound_loses_no_beginning_under_any_motion() {
    for motion in [
        json!({"model": "constant_velocity", "process_noise_m2ps3": 1.0}),
        json!({"model": "constant_velocity", "process_noise_m2ps3": 300.0}),
        json!({"model": "constant_acceleration", "initial_acceleration_sigma_mps2": 5.0}),
        json!({"model": "coordinated_turn", "turn_rate_degps": -0.6}),
        json!({"model": "unknown_turn"}),
        json!({"model": "singer", "maneuver_sigma_mps2": 3.0}),
        json!({"model": "ornstein_uhlenbeck", "damping_per_s": 0.02, "mean_velocity_x_mps": 50.0}),
    ] {
        let spec = json!({"method": "kalman", "motion": motion});
        let points = compare(&spec, Kind::Positions, RULE, ("nearest_neighbour", false));
        assert!(points > 60, "{spec}: {points}");
    }
}

#[test]
fn the_bound_loses_no_beginning_of_other_reports_and_filters() {
    let models = json!([
        {"model": "constant_velocity", "process_noise_m2ps3": 1.0},
        {"model": "coordinated_turn", "turn_rate_degps": -0.6}
    ]);
    for (spec, kind) in [
        (json!({"method": "unscented"}), Kind::Ranges),
        (json!({"method": "extended"}), Kind::Ranges),
        (json!({"method": "converted"}), Kind::Ranges),
        (json!({"method": "imm", "models": models}), Kind::Positions),
        (json!({"method": "kalman"}), Kind::Heights),
        (
            json!({"method": "bearing_only", "initial_rate_sigma_degps": 1.0}),
            Kind::Bearings,
        ),
    ] {
        let points = compare(&spec, kind, RULE, ("nearest_neighbour", false));
        assert!(points > 60, "{spec}: {points}");
    }
}

#[test]
fn the_bound_loses_no_beginning_of_other_windows_and_associators() {
    let kalman = json!({"method": "kalman"});
    for (window_scans, min_detections, max_gap_scans) in
        [(3, 3, 0), (4, 3, 2), (6, 4, 1), (7, 3, 4)]
    {
        let rule = MultiScan {
            window_scans,
            min_detections,
            max_gap_scans,
            ..RULE
        };
        let points = compare(&kalman, Kind::Positions, rule, ("nearest_neighbour", false));
        assert!(points > 60, "{window_scans}: {points}");
    }
    for associator in ["oracle", "jpda"] {
        let points = compare(&kalman, Kind::Positions, RULE, (associator, false));
        assert!(points > 60, "{associator}: {points}");
    }
    // With noises and times of their own.
    let points = compare(&kalman, Kind::Positions, RULE, ("nearest_neighbour", true));
    assert!(points > 60, "{points}");
}
