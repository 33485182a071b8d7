//! Covariances stay positive definite: every motion model with every sensing model that observes it. A hundred thousand updates in
//! all; `TRACKLOOM_UPDATES` says how many of each pair instead, for those who wait for more.

use super::{State6, belief, radar};
use nalgebra::Cholesky;
use rand_distr::{Distribution, StandardNormal};
use trackloom_domain::filtering::imm::settings::Model;
use trackloom_domain::filtering::imm::{Mixing, Models};
use trackloom_domain::filtering::motions::AnyMotion;
use trackloom_domain::filtering::unscented::Unscented;
use trackloom_domain::filtering::{
    AnyFilter, Filter, Movement, PlaceFilter, Reports, Way, WithFilter,
};
use trackloom_domain::hypotheses::certain::update_own;
use trackloom_domain::math::rng::{Purpose, Seed};
use trackloom_domain::model::motion::constant_acceleration::ConstantAcceleration;
use trackloom_domain::model::motion::constant_velocity::ConstantVelocity;
use trackloom_domain::model::motion::coordinated_turn::CoordinatedTurn;
use trackloom_domain::model::motion::ornstein_uhlenbeck::OrnsteinUhlenbeck;
use trackloom_domain::model::motion::singer::Singer;
use trackloom_domain::model::motion::unknown_turn::UnknownTurn;
use trackloom_domain::model::own::{Own, OwnNoise};
use trackloom_domain::model::scan::Measurement;
use trackloom_domain::model::sensing::{
    Bearing, MeasurementModel, Moving, Platform, Polar, Site, Spherical, VelocityNoise,
};
use trackloom_domain::model::space::Place;
use trackloom_domain::model::state::{GaussianState, Position};

fn motions() -> [AnyMotion; 6] {
    let spectral_density = 1.0;
    [
        AnyMotion::ConstantVelocity(ConstantVelocity { spectral_density }),
        AnyMotion::CoordinatedTurn(CoordinatedTurn {
            turn_rate_radps: 0.01,
            spectral_density,
        }),
        AnyMotion::UnknownTurn(UnknownTurn {
            spectral_density,
            turn_density: 3e-5,
            initial_sigma: 0.05,
        }),
        AnyMotion::ConstantAcceleration(ConstantAcceleration {
            spectral_density: 0.1,
            initial_sigma: 1.0,
        }),
        AnyMotion::Singer(Singer {
            maneuver_sigma_mps2: 1.0,
            maneuver_time_s: 20.0,
        }),
        AnyMotion::OrnsteinUhlenbeck(OrnsteinUhlenbeck {
            damping_per_s: 1e-3,
            spectral_density,
            mean_velocity_mps: [0.0; 2],
        }),
    ]
}

fn movements() -> Vec<Movement> {
    let all = motions().map(|motion| Model {
        motion,
        sojourn_s: 50.0,
        initial_probability: None,
    });
    let several = Movement::Several(Models::new(&all, Mixing::Unbiased).unwrap());
    motions()
        .into_iter()
        .map(Movement::Single)
        .chain([several])
        .collect()
}

fn updates(movement: &Movement) -> usize {
    let told = std::env::var("TRACKLOOM_UPDATES").ok();
    let few = if matches!(movement, Movement::Several(_)) {
        100
    } else {
        600
    };
    told.and_then(|told| told.parse().ok()).unwrap_or(few)
}

/// A sensor of places and velocities.
const MOVING: Moving = Moving {
    sigmas_m: [10.0, 1.0, 30.0],
    correlation_xy: 0.5,
    is_in_volume: false,
    clutter_span: None,
    velocity: VelocityNoise {
        sigma_speed_mps: 1.0,
        sigma_course_rad: Some(0.02),
        area_m2ps2: 900.0,
    },
    tells_velocity: true,
};

/// Sensors of the plane, of which each alone or two together observe it.
fn of_the_plane() -> Vec<Vec<MeasurementModel>> {
    let polar = Polar {
        place_m: Position::new(-2000.0, 500.0),
        sigma_range_m: 5.0,
        sigma_bearing_rad: 0.002,
        range_rate: None,
        platform: Platform::STANDING,
    };
    let bearing = |x_m: f64, y_m: f64| {
        MeasurementModel::Bearing(Bearing {
            place_m: Position::new(x_m, y_m),
            sigma_bearing_rad: 0.002,
            platform: Platform::STANDING,
            range_prior: None,
        })
    };
    let position = MeasurementModel::Position {
        sigma_x_m: 10.0,
        sigma_y_m: 1.0,
    };
    let with_rate = Polar {
        range_rate: radar(Site::level(Place::zeros())).range_rate,
        ..polar
    };
    vec![
        vec![position],
        vec![MeasurementModel::Moving(MOVING)],
        vec![MeasurementModel::Polar(polar)],
        vec![MeasurementModel::Polar(with_rate)],
        vec![MeasurementModel::Converted(polar)],
        vec![bearing(-3000.0, -3000.0), bearing(4000.0, -3500.0)],
    ]
}

/// Those of space, and those of the plane beside one that tells heights.
fn of_space() -> Vec<Vec<MeasurementModel>> {
    let full = radar(Site::level(Place::new(-2000.0, 500.0, 20.0)));
    let high = MeasurementModel::Position3 {
        sigmas_m: [10.0, 20.0, 30.0],
        clutter_span: None,
    };
    let slant = Spherical {
        sigma_elevation_rad: None,
        range_rate: None,
        ..full
    };
    let sight = |x_m: f64, y_m: f64| {
        MeasurementModel::Sight(Spherical {
            site: Site::level(Place::new(x_m, y_m, 0.0)),
            ..full
        })
    };
    let moving = Moving {
        is_in_volume: true,
        ..MOVING
    };
    let mut sets = vec![
        vec![high],
        vec![MeasurementModel::Moving(moving)],
        vec![MeasurementModel::Spherical(full)],
        vec![MeasurementModel::Spherical(Spherical {
            range_rate: None,
            ..full
        })],
        vec![MeasurementModel::ConvertedSpherical(full)],
        vec![sight(-3000.0, -3000.0), sight(4000.0, -3500.0)],
        vec![MeasurementModel::Spherical(slant), high],
    ];
    sets.extend(of_the_plane().into_iter().map(|mut set| {
        set.push(high);
        set
    }));
    sets
}

struct Long<'m> {
    models: &'m [MeasurementModel],
    updates: usize,
}

impl Long<'_> {
    fn follow<F: Filter<K>, const K: usize>(self, filter: &F, start: &GaussianState<K>) {
        let mut believed = filter.begin(start);
        let mut draw = Seed { seed: 2, run: 0 }.stream(Purpose::Detection, 0, 0);
        let (mut time_s, steps_s) = (0.0, [1.0, 0.0, 0.1, 4.0, 10.0]);
        for at in 0..self.updates {
            let dt_s = steps_s[at % steps_s.len()];
            time_s += dt_s;
            F::predict(&filter.step(dt_s), &mut believed);
            let model = &self.models[at % self.models.len()];
            let errors: [f64; 4] = std::array::from_fn(|_| StandardNormal.sample(&mut draw));
            let report = report_of(model, time_s, errors);
            let own = own_of(model, time_s, errors);
            let updated = update_own(filter, model, (&report, &own), &mut believed);
            assert!(
                updated.is_some(),
                "{model:?}: nothing is expected after {at}"
            );
            let covariance = F::kinematics(&believed).covariance;
            assert!(
                Cholesky::new(covariance).is_some(),
                "{model:?} after {at}: {covariance}"
            );
        }
    }
}

impl WithFilter for Long<'_> {
    type Output = ();

    fn in_plane<F: Filter<4>>(self, filter: F) {
        let start = belief(truth_at(0.0), 50.0, 20.0);
        let places = [0, 1, 3, 4];
        let flat = GaussianState {
            mean: places.map(|place| start.mean[place]).into(),
            covariance: nalgebra::SMatrix::from_fn(|row, column| {
                start.covariance[(places[row], places[column])]
            }),
        };
        self.follow(&filter, &flat);
    }

    fn in_volume<F: Filter<6>>(self, filter: F) {
        self.follow(&filter, &belief(truth_at(0.0), 50.0, 20.0));
    }

    fn of_bearings<F: Filter<2>>(self, _filter: F) {
        panic!("the filters are of places")
    }
}

/// A target that circles and climbs up and down.
fn truth_at(time_s: f64) -> State6 {
    let (sin, cos) = (0.01 * time_s).sin_cos();
    let (rise, fall) = (0.003 * time_s).sin_cos();
    State6::from([
        6000.0 * cos,
        6000.0 * sin,
        4000.0 + 1000.0 * rise,
        -60.0 * sin,
        60.0 * cos,
        3.0 * fall,
    ])
}

/// Of a report of a velocity that, and of every fourth report also a noise and a time.
fn own_of(model: &MeasurementModel, time_s: f64, errors: [f64; 4]) -> Own {
    let velocity_mps = truth_at(time_s).fixed_rows::<2>(3).into_owned();
    let told = [velocity_mps[0] + errors[2], velocity_mps[1] + errors[3]];
    let is_other = errors[0] > 0.7;
    Own {
        after_s: if is_other { 0.4 * errors[1] } else { 0.0 },
        noise: OwnNoise {
            sigma_x_m: is_other.then_some(3.0),
            correlation_xy: is_other.then_some(0.99),
            sigma_range_m: is_other.then_some(50.0),
            ..OwnNoise::default()
        },
        velocity_mps: matches!(model, MeasurementModel::Moving(_)).then_some(told),
    }
}

fn report_of(model: &MeasurementModel, time_s: f64, errors: [f64; 4]) -> Measurement {
    let truth = truth_at(time_s);
    let place_m: Place = truth.fixed_rows::<3>(0).into();
    let velocity_mps: Place = truth.fixed_rows::<3>(3).into();
    let polar_of = |from_m: Place, is_flat: bool| {
        let mut offset_m = place_m - from_m;
        if is_flat {
            offset_m.z = 0.0;
        }
        let bearing_rad = offset_m.x.atan2(offset_m.y) + 0.002 * errors[1];
        let elevation_rad = offset_m.z.atan2(offset_m.xy().norm()) + 0.003 * errors[2];
        let rate_mps = offset_m.normalize().dot(&velocity_mps) + errors[3];
        (
            offset_m.norm() + 5.0 * errors[0],
            bearing_rad,
            elevation_rad,
            Some(rate_mps),
        )
    };
    match model {
        MeasurementModel::Position { .. } => Measurement::Position {
            x_m: place_m.x + 10.0 * errors[0],
            y_m: place_m.y + errors[1],
        },
        MeasurementModel::Position3 { .. } | MeasurementModel::Moving(_) => {
            Measurement::Position3 {
                x_m: place_m.x + 10.0 * errors[0],
                y_m: place_m.y + 20.0 * errors[1],
                z_m: place_m.z + 30.0 * errors[2],
            }
        }
        MeasurementModel::Polar(polar) | MeasurementModel::Converted(polar) => {
            let (range_m, bearing_rad, _, range_rate_mps) = polar_of(polar.place_m.push(0.0), true);
            Measurement::RangeBearing {
                range_m,
                bearing_rad,
                range_rate_mps,
            }
        }
        MeasurementModel::Bearing(bearing) => Measurement::Bearing {
            bearing_rad: polar_of(bearing.place_m.push(0.0), true).1,
        },
        MeasurementModel::Sight(sight) => {
            let (_, bearing_rad, elevation_rad, _) = polar_of(sight.site.place_m, false);
            Measurement::BearingElevation {
                bearing_rad,
                elevation_rad,
            }
        }
        MeasurementModel::Spherical(sensor) | MeasurementModel::ConvertedSpherical(sensor) => {
            let (range_m, bearing_rad, elevation_rad, range_rate_mps) =
                polar_of(sensor.site.place_m, false);
            Measurement::RangeBearingElevation {
                range_m,
                bearing_rad,
                elevation_rad,
                range_rate_mps,
            }
        }
    }
}

fn follow_all(sets: &[Vec<MeasurementModel>], make: fn(PlaceFilter) -> AnyFilter) {
    let vertical = ConstantVelocity {
        spectral_density: 0.01,
    };
    for movement in movements() {
        for way in [Way::Line, Way::Points(Unscented::default())] {
            for models in sets {
                let filter = make(PlaceFilter {
                    movement,
                    way,
                    reports: Reports::All,
                    vertical,
                });
                let updates = updates(&movement);
                filter.with(Long { models, updates });
            }
        }
    }
}

#[test]
fn in_the_plane() {
    follow_all(&of_the_plane(), AnyFilter::Plane);
}

#[test]
fn in_space() {
    follow_all(&of_space(), AnyFilter::Volume);
}
