//! Where heights are not looked at, a filter of space says of x and y what one of the plane says.

use super::{State6, belief};
use rand_distr::{Distribution, StandardNormal};
use trackloom_domain::filtering::gaussian::GaussianFilter;
use trackloom_domain::filtering::{Filter, Reports, Way};
use trackloom_domain::hypotheses::certain::update;
use trackloom_domain::math::rng::{Purpose, Seed};
use trackloom_domain::model::motion::constant_velocity::ConstantVelocity;
use trackloom_domain::model::motion::in_space::ClimbingVelocity;
use trackloom_domain::model::scan::Measurement;
use trackloom_domain::model::sensing::{Bearing, MeasurementModel, Platform, Polar, RangeRate};
use trackloom_domain::model::state::{GaussianState, Position};

const MOTION: ConstantVelocity = ConstantVelocity {
    spectral_density: 1.0,
};
const PLACES: [usize; 4] = [0, 1, 3, 4];

fn flat(state: &GaussianState<6>) -> GaussianState<4> {
    GaussianState {
        mean: PLACES.map(|place| state.mean[place]).into(),
        covariance: nalgebra::SMatrix::from_fn(|row, column| {
            state.covariance[(PLACES[row], PLACES[column])]
        }),
    }
}

fn polar(range_rate: Option<RangeRate>) -> Polar {
    Polar {
        place_m: Position::new(-300.0, 200.0),
        sigma_range_m: 20.0,
        sigma_bearing_rad: 0.01,
        range_rate,
        platform: Platform::STANDING,
    }
}

#[test]
fn what_is_reported_of_the_plane_updates_space_as_the_plane() {
    let rate = Some(RangeRate {
        sigma_mps: 0.5,
        span_mps: 100.0,
    });
    let bearing = Bearing {
        place_m: Position::new(-300.0, 200.0),
        sigma_bearing_rad: 0.01,
        platform: Platform::STANDING,
        range_prior: None,
    };
    let position = MeasurementModel::Position {
        sigma_x_m: 10.0,
        sigma_y_m: 20.0,
    };
    for (model, reports) in [
        (position, Reports::Positions),
        (MeasurementModel::Polar(polar(None)), Reports::All),
        (MeasurementModel::Polar(polar(rate)), Reports::All),
        (MeasurementModel::Polar(polar(None)), Reports::Converted),
        (MeasurementModel::Bearing(bearing), Reports::All),
    ] {
        follow(&model, reports);
    }
}

fn follow(model: &MeasurementModel, reports: Reports) {
    let plane = GaussianFilter::<_, 4, 4>::new(MOTION, Way::Line, reports);
    let climbing = ClimbingVelocity {
        horizontal: MOTION,
        vertical: ConstantVelocity {
            spectral_density: 0.1,
        },
    };
    let space = GaussianFilter::<_, 6, 6>::new(climbing, Way::Line, reports);
    let start = belief(
        State6::from([2000.0, 900.0, 700.0, -30.0, 60.0, 3.0]),
        40.0,
        8.0,
    );
    let (mut high, mut low) = (space.begin(&start), plane.begin(&flat(&start)));
    let mut draw = Seed { seed: 9, run: 0 }.stream(Purpose::Detection, 0, 0);
    for scan in 1..=40 {
        GaussianFilter::<ClimbingVelocity, 6, 6>::predict(&space.step(2.0), &mut high);
        GaussianFilter::<ConstantVelocity, 4, 4>::predict(&plane.step(2.0), &mut low);
        let errors: [f64; 3] = std::array::from_fn(|_| StandardNormal.sample(&mut draw));
        let report = report(model, 2.0 * f64::from(scan), errors);
        update(&space, model, &report, &mut high).unwrap();
        update(&plane, model, &report, &mut low).unwrap();
        let found = flat(&high);
        let (mean, covariance) = (found.mean - low.mean, found.covariance - low.covariance);
        assert!(
            mean.norm() < 1e-9 * low.mean.norm(),
            "{model:?}: {}",
            found.mean
        );
        assert!(
            covariance.norm() < 1e-8 * low.covariance.norm(),
            "{model:?}: {}",
            found.covariance
        );
    }
}

/// Of a target at 2 km east that goes north.
fn report(model: &MeasurementModel, time_s: f64, errors: [f64; 3]) -> Measurement {
    let place_m = Position::new(2000.0 - 30.0 * time_s, 900.0 + 60.0 * time_s);
    let offset_m = place_m - Position::new(-300.0, 200.0);
    let bearing_rad = offset_m[0].atan2(offset_m[1]) + 0.01 * errors[1];
    match model {
        MeasurementModel::Position { .. } => Measurement::Position {
            x_m: place_m[0] + 10.0 * errors[0],
            y_m: place_m[1] + 20.0 * errors[1],
        },
        MeasurementModel::Bearing(_) => Measurement::Bearing { bearing_rad },
        _ => Measurement::RangeBearing {
            range_m: offset_m.norm() + 20.0 * errors[0],
            bearing_rad,
            range_rate_mps: Some(
                offset_m.normalize().dot(&Position::new(-30.0, 60.0)) + 0.5 * errors[2],
            ),
        },
    }
}
