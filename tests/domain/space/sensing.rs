//! Sensing models of space: worked values, slopes and curvatures by central differences, and where they have none.

use super::{FAR, SITES, State6, belief, radar, site_of, turned};
use nalgebra::{Matrix3, SMatrix, SVector};
use rand_distr::{Distribution, StandardNormal};
use trackloom_domain::math::rng::{Purpose, Seed};
use trackloom_domain::model::own::Own;
use trackloom_domain::model::pose::{Attitude, Pose, PoseSigmas};
use trackloom_domain::model::scan::Measurement;
use trackloom_domain::model::sensing::{
    Bearing, Directions, Dispatch, MeasurementModel, Places, Platform, Polar, Ranges, Sensing,
    Site, Spherical, WithSensing, unbiased_covariance, unbiased_place,
};
use trackloom_domain::model::space::Place;
use trackloom_domain::model::state::{GaussianState, Position};

fn near(found: f64, wanted: f64, tolerance: f64) {
    assert!(
        (found - wanted).abs() <= tolerance * wanted.abs().max(1e-12),
        "{found} {wanted}"
    );
}

/// Worked with another program, relative to a sensor that moves with 10 m/s east.
#[test]
fn a_target_is_seen_as_worked_and_so_are_the_slopes() {
    let pose = Pose {
        velocity: Place::new(10.0, 0.0, 0.0),
        ..Pose::at(Place::new(500.0, -200.0, 30.0))
    };
    let sensor = Ranges(radar(Site::level(Place::zeros())).seen_from(&pose));
    let mean = State6::from([3000.0, 4000.0, 1200.0, -50.0, 80.0, 5.0]);
    let seen: SVector<f64, 4> = sensor.project(&mean);
    let wanted = [
        5025.823315637,
        0.53691074274,
        0.234953412671,
        38.17285008868,
    ];
    for (found, wanted) in seen.iter().zip(wanted) {
        near(*found, wanted, 1e-10);
    }
    let slopes: SMatrix<f64, 4, 6> = sensor.jacobian(&belief(mean, 1.0, 1.0));
    let wanted = [
        [
            0.4974309367824,
            0.8356839737944,
            0.2327976784142,
            0.0,
            0.0,
            0.0,
        ],
        [0.0001758057764755, -0.0001046462955211, 0.0, 0.0, 0.0, 0.0],
        [
            -2.369208935972e-05,
            -3.980271012433e-05,
            0.0001935056460867,
            0.0,
            0.0,
            0.0,
        ],
        [
            -0.01571650088325,
            0.009570483864242,
            -0.0007733162578565,
            0.4974309367824,
            0.8356839737944,
            0.2327976784142,
        ],
    ];
    for (row, wanted) in wanted.iter().enumerate() {
        for (column, wanted) in wanted.iter().enumerate() {
            let found = slopes[(row, column)];
            assert!(
                (found - wanted).abs() <= 1e-11 * wanted.abs() + 1e-15,
                "{row} {column}: {found}"
            );
        }
    }
}

#[test]
fn two_sites_on_a_curved_earth_see_the_target_where_it_is() {
    let target = SITES[0].at_enu(&Place::from(FAR));
    near(target.lat_deg, 51.8, 1e-10);
    near(target.lon_deg, 5.2, 1e-10);
    assert!((target.height_m - 11_000.0).abs() < 1e-5);
    let sites = [0, 1].map(site_of);
    let offset_m = [-125_350.726_731_4, 89_273.706_597_28, -1_816.752_135_054];
    let turn = [
        [0.9995163247473, 0.02413387746084, -0.01961307019203],
        [-0.02386147828052, 0.9996171574461, 0.0140060127706],
        [0.01994358087006, -0.01353124156043, 0.9997095373577],
    ];
    for (row, (offset_m, turn)) in offset_m.into_iter().zip(turn).enumerate() {
        assert!((sites[1].place_m[row] - offset_m).abs() < 1e-5);
        for (column, wanted) in turn.into_iter().enumerate() {
            // That of the values leads from the second site to the first.
            let found = sites[1].turn[(column, row)];
            assert!((found - wanted).abs() < 1e-12, "{row} {column}");
        }
    }
    let seen = [
        [308_873.476_928_3, 308.867_664_500_5, 0.635_508_009_495_9],
        [155_593.265_604_3, 310.873_853_459_9, 3.302_438_630_839],
    ];
    let mean = State6::from([FAR[0], FAR[1], FAR[2], 0.0, 0.0, 0.0]);
    for (site, wanted) in sites.into_iter().zip(seen) {
        let sensor = Spherical {
            range_rate: None,
            ..radar(site)
        };
        let found: SVector<f64, 3> = Ranges(sensor).project(&mean);
        near(found[0], wanted[0], 1e-11);
        near(found[1].to_degrees().rem_euclid(360.0), wanted[1], 1e-10);
        near(found[2].to_degrees(), wanted[2], 1e-9);
        // And back: without noise of angles the conversion is exact.
        let sharp = Spherical {
            sigma_bearing_rad: 1e-9,
            sigma_elevation_rad: Some(1e-9),
            ..sensor
        };
        let back = unbiased_place(&sharp, found[0], found[1], found[2]);
        assert!((back - Place::from(FAR)).norm() < 1e-6, "{back}");
    }
    // As if the axes of the second site were parallel to those of the first.
    let flat = Site::level(sites[1].place_m);
    let (range_m, [bearing, elevation]) = (seen[1][0], [1, 2].map(|at| seen[1][at].to_radians()));
    let sharp = Spherical {
        sigma_bearing_rad: 1e-9,
        sigma_elevation_rad: Some(1e-9),
        ..radar(flat)
    };
    let error_m = (unbiased_place(&sharp, range_m, bearing, elevation) - Place::from(FAR)).norm();
    near(error_m, 5_257.322_960_093, 1e-6);
}

/// Two million draws in another program agree within a thousandth.
#[test]
fn the_conversion_to_places_is_the_published_one() {
    let sensor = Spherical {
        sigma_range_m: 30.0,
        sigma_bearing_rad: 2f64.to_radians(),
        sigma_elevation_rad: Some(1.5f64.to_radians()),
        ..radar(Site::level(Place::zeros()))
    };
    let (bearing, elevation) = (35f64.to_radians(), 10f64.to_radians());
    let found = unbiased_place(&sensor, 5000.0, bearing, elevation);
    for (found, wanted) in found
        .iter()
        .zip([2827.002433687, 4037.377890725, 868.538480785])
    {
        near(*found, wanted, 1e-11);
    }
    let (rise, level) = elevation.sin_cos();
    let truth = Place::new(bearing.sin() * level, bearing.cos() * level, rise) * 5000.0;
    let found = unbiased_covariance(&sensor, &truth, &Matrix3::zeros());
    let wanted = [
        [20289.88103168, -13217.55895349, -1591.906238553],
        [-13217.55895349, 10668.28497422, -2273.477721509],
        [-1591.906238553, -2273.477721509, 16645.96947717],
    ];
    for row in 0..3 {
        for column in 0..3 {
            near(found[(row, column)], wanted[row][column], 1e-10);
        }
    }
    // On turned axes it is the same, turned.
    let site = turned(Place::new(100.0, -70.0, 12.0));
    let elsewhere = Spherical { site, ..sensor };
    let place_m = site.place_m + site.turn.transpose() * truth;
    let turned = unbiased_covariance(&elsewhere, &place_m, &Matrix3::zeros());
    let back = site.turn * turned * site.turn.transpose();
    assert!((back - found).norm() < 1e-9 * found.norm());
}

/// Every kind of report, seen from places where axes are turned.
fn models() -> Vec<MeasurementModel> {
    let full = radar(turned(Place::new(400.0, -300.0, 50.0)));
    let without_rate = Spherical {
        range_rate: None,
        ..full
    };
    let slant = Spherical {
        sigma_elevation_rad: None,
        ..full
    };
    let polar = Polar {
        place_m: Position::new(400.0, -300.0),
        sigma_range_m: 30.0,
        sigma_bearing_rad: 0.004,
        range_rate: full.range_rate,
        platform: Platform::STANDING,
    };
    vec![
        MeasurementModel::Spherical(full),
        MeasurementModel::Spherical(without_rate),
        MeasurementModel::Spherical(slant),
        MeasurementModel::Spherical(Spherical {
            range_rate: None,
            ..slant
        }),
        MeasurementModel::Sight(full),
        MeasurementModel::Polar(polar),
        MeasurementModel::Polar(Polar {
            range_rate: None,
            ..polar
        }),
        MeasurementModel::Bearing(Bearing {
            place_m: polar.place_m,
            sigma_bearing_rad: 0.004,
            platform: Platform::STANDING,
            range_prior: None,
        }),
        MeasurementModel::Position {
            sigma_x_m: 3.0,
            sigma_y_m: 4.0,
        },
        MeasurementModel::Position3 {
            sigmas_m: [3.0, 4.0, 5.0],
            clutter_span: None,
        },
        MeasurementModel::Converted(polar),
        MeasurementModel::ConvertedSpherical(full),
    ]
}

/// Slopes and curvatures by central differences.
struct Slopes(State6);

impl WithSensing<6> for Slopes {
    type Output = ();

    fn with<S: Sensing<6, D>, const D: usize>(self, sensing: &S) {
        let mean = self.0;
        let sharp = |mean: State6| belief(mean, 1e-3, 1e-3);
        let slopes = sensing.jacobian(&sharp(mean));
        let mut seconds = [SMatrix::<f64, 6, 6>::zeros(); D];
        for variable in 0..6 {
            let step = State6::ith(variable, 0.05);
            let ahead = sensing.project(&(mean + step)) - sensing.project(&(mean - step));
            for row in 0..D {
                let found = slopes[(row, variable)];
                let wanted = ahead[row] / 0.1;
                assert!(
                    (found - wanted).abs() < 1e-7 * (1e-3 + wanted.abs()),
                    "{row} {variable}: {found} {wanted}"
                );
            }
            let change =
                sensing.jacobian(&sharp(mean + step)) - sensing.jacobian(&sharp(mean - step));
            for (row, second) in seconds.iter_mut().enumerate() {
                second.set_column(variable, &(change.row(row).transpose() / 0.1));
            }
        }
        if S::IS_DIRECT {
            return;
        }
        let around = belief(mean, 20.0, 5.0);
        let (shift, spread) = sensing.curvature(&around);
        let products = seconds.map(|second| second * around.covariance);
        for row in 0..D {
            let wanted = 0.5 * products[row].trace();
            assert!(
                (shift[row] - wanted).abs() < 1e-5 * spread[(row, row)].sqrt(),
                "{row}: {shift} {wanted}"
            );
            for column in 0..D {
                let wanted = 0.5 * (products[row] * products[column]).trace();
                let scale = (spread[(row, row)] * spread[(column, column)]).sqrt();
                assert!(
                    (spread[(row, column)] - wanted).abs() < 1e-5 * scale,
                    "{row} {column}: {spread} {wanted}"
                );
            }
        }
    }
}

#[test]
fn every_slope_and_curvature_is_that_of_the_projection() {
    for mean in [
        [3000.0, 4000.0, 1200.0, -50.0, 80.0, 5.0],
        [-6000.0, -2500.0, 4000.0, 120.0, -30.0, -20.0],
        [900.0, -5000.0, -300.0, 5.0, 200.0, 0.0],
    ] {
        for model in models() {
            model.dispatch(Slopes(State6::from(mean))).unwrap();
        }
    }
}

#[test]
fn right_above_a_sensor_nothing_is_without_bound() {
    let sensor = radar(Site::level(Place::zeros()));
    for offset_m in [0.0, 1e-9, 1.0, 100.0] {
        let mean = State6::from([offset_m, 0.0, 5000.0, 200.0, 10.0, 0.0]);
        let around = belief(mean, 50.0, 10.0);
        let slopes: SMatrix<f64, 4, 6> = Ranges(sensor).jacobian(&around);
        let (shift, spread) = Sensing::<6, 4>::curvature(&Ranges(sensor), &around);
        assert!(
            slopes
                .iter()
                .chain(shift.iter())
                .chain(spread.iter())
                .all(|value| value.is_finite())
        );
        // Nobody knows the bearing within 50 m of the zenith: a slope is at most 1/50 m.
        assert!(slopes.row(1).norm() < 0.025, "{slopes}");
        let covariance = unbiased_covariance(
            &sensor,
            &mean.fixed_rows::<3>(0).into(),
            &around.covariance.fixed_view::<3, 3>(0, 0).into(),
        );
        assert!(
            nalgebra::Cholesky::new(covariance).is_some(),
            "{covariance}"
        );
    }
}

#[test]
fn clutter_is_stated_over_space_or_over_the_ground() {
    let expected = SVector::<f64, 4>::new(1000.0, 0.3, 60f64.to_radians(), 0.0);
    let of_space = radar(Site::level(Place::zeros()));
    // r² cos ε over 400 m/s.
    let scale = Ranges(of_space).log_clutter_scale(&expected).exp();
    near(scale, 1e6 * 0.5 / 400.0, 1e-12);
    let of_ground = Spherical {
        clutter_span: Some(8000.0),
        ..of_space
    };
    near(
        Ranges(of_ground).log_clutter_scale(&expected).exp(),
        scale / 8000.0,
        1e-12,
    );
    let flat = Spherical {
        sigma_elevation_rad: None,
        range_rate: None,
        ..of_space
    };
    let polar = SVector::<f64, 2>::new(1000.0, 0.3);
    near(Ranges(flat).log_clutter_scale(&polar).exp(), 1000.0, 1e-12);
    let places = Places::Measured {
        sigmas_m: [1.0; 3],
        correlation_xy: 0.0,
        clutter_span: Some(50.0),
    };
    near(
        places.log_clutter_scale(&SVector::<f64, 3>::zeros()).exp(),
        0.02,
        1e-12,
    );
    let sight = Directions(of_ground);
    near(
        sight.log_clutter_scale(&SVector::<f64, 2>::zeros()).exp(),
        1.0 / 8000.0,
        1e-12,
    );
}

#[test]
fn a_report_of_space_starts_a_track_and_one_of_the_plane_does_not() {
    struct Start(Measurement);
    impl WithSensing<6> for Start {
        type Output = Option<GaussianState<6>>;
        fn with<S: Sensing<6, D>, const D: usize>(self, sensing: &S) -> Self::Output {
            sensing.locate(&sensing.read(&self.0, &Own::default())?, 100.0)
        }
    }
    let seen = Measurement::RangeBearingElevation {
        range_m: 2000.0,
        bearing_rad: 0.0,
        elevation_rad: 30f64.to_radians(),
        range_rate_mps: Some(-40.0),
    };
    let sensor = Spherical {
        sigma_bearing_rad: 1e-4,
        sigma_elevation_rad: Some(1e-4),
        ..radar(Site::level(Place::new(0.0, 0.0, 100.0)))
    };
    let start = MeasurementModel::Spherical(sensor)
        .dispatch(Start(seen))
        .flatten()
        .unwrap();
    let wanted = State6::from([0.0, 1_732.050_808, 1100.0, 0.0, -34.641_016, -20.0]);
    assert!((start.mean - wanted).norm() < 1e-3, "{}", start.mean);
    // 1 m/s along the range, and 100 m/s across it.
    let along = State6::from([0.0, 0.0, 0.0, 0.0, 0.866_025_404, 0.5]);
    let across = State6::from([0.0, 0.0, 0.0, 0.0, -0.5, 0.866_025_404]);
    let variance = |axis: State6| (axis.transpose() * start.covariance * axis)[0];
    assert!((variance(along) - 1.0).abs() < 0.01 && (variance(across) - 1e4).abs() < 1e-3);
    let height = |seen: Measurement, model: MeasurementModel| {
        model
            .dispatch(Start(seen))
            .flatten()
            .map(|state| state.mean[2])
    };
    let place = Measurement::Position3 {
        x_m: 1.0,
        y_m: 2.0,
        z_m: 3.0,
    };
    let report = MeasurementModel::Position3 {
        sigmas_m: [1.0; 3],
        clutter_span: None,
    };
    assert_eq!(height(place, report), Some(3.0));
    let flat = MeasurementModel::Position {
        sigma_x_m: 1.0,
        sigma_y_m: 1.0,
    };
    let plain = Measurement::Position { x_m: 1.0, y_m: 2.0 };
    assert_eq!([height(plain, flat), height(plain, report)], [None; 2]);
    let sight = Measurement::BearingElevation {
        bearing_rad: 0.1,
        elevation_rad: 0.2,
    };
    assert_eq!(height(sight, MeasurementModel::Sight(sensor)), None);
}

/// Poses are drawn, and what a sensor carried so reports of a target that stays: its covariance is what the pose adds to R. The angles
/// that the body sees are turned by the attitude that is believed.
#[test]
fn an_uncertain_pose_adds_to_the_noise_what_drawn_poses_scatter() {
    let pose = Pose {
        velocity: Place::new(40.0, -10.0, 3.0),
        attitude: Some(Attitude {
            heading_rad: 0.6,
            pitch_rad: 0.2,
            roll_rad: -0.3,
        }),
        sigmas: PoseSigmas {
            place: Place::new(20.0, 30.0, 25.0),
            velocity: Place::new(1.0, 2.0, 1.5),
            heading_rad: 0.01,
            pitch_rad: 0.015,
            roll_rad: 0.02,
        },
        ..Pose::at(Place::new(500.0, -200.0, 30.0))
    };
    let standing = radar(Site::level(Place::zeros()));
    let mean = State6::from([4000.0, 5000.0, 2500.0, -60.0, 80.0, 5.0]);
    let at = GaussianState {
        mean,
        covariance: SMatrix::zeros(),
    };
    let carried = Ranges(standing.seen_from(&pose));
    let seen: SVector<f64, 4> = carried.project(&mean);
    let added: SMatrix<f64, 4, 4> = carried.noise(&at) - Ranges(standing).noise(&at);

    let mut draw = Seed { seed: 8, run: 0 }.stream(Purpose::Detection, 0, 0);
    let mut normal = |sigma: f64| -> f64 {
        let drawn: f64 = StandardNormal.sample(&mut draw);
        sigma * drawn
    };
    let count = 40_000;
    let mut scatter = SMatrix::<f64, 4, 4>::zeros();
    for _ in 0..count {
        let mut other = pose;
        let sigmas = pose.sigmas;
        other.place += sigmas.place.map(&mut normal);
        other.velocity += sigmas.velocity.map(&mut normal);
        let mut attitude = pose.attitude.unwrap();
        attitude.heading_rad += normal(sigmas.heading_rad);
        attitude.pitch_rad += normal(sigmas.pitch_rad);
        attitude.roll_rad += normal(sigmas.roll_rad);
        // What the body sees of the target: its axes are those of the drawn attitude.
        let mut report: SVector<f64, 4> = Ranges(standing.seen_from(&other)).project(&mean);
        let body = attitude.rotation().transpose() * north_east_down(report[1], report[2]);
        let (bearing, elevation) = (body.y.atan2(body.x), (-body.z).asin());
        (report[1], report[2]) = pose.attitude.unwrap().direction(bearing, elevation);
        let error = report - seen;
        scatter += error * error.transpose() / f64::from(count);
    }
    for row in 0..4 {
        for column in 0..4 {
            // The product of two normal errors has the variance s_ii s_jj + s_ij².
            let variance =
                added[(row, row)] * added[(column, column)] + added[(row, column)].powi(2);
            let deviation = (scatter[(row, column)] - added[(row, column)]).abs();
            let limit = 4.0 * (variance / f64::from(count)).sqrt();
            assert!(deviation < limit, "{row} {column}: {deviation} {limit}");
        }
    }
}

fn north_east_down(bearing_rad: f64, elevation_rad: f64) -> nalgebra::Vector3<f64> {
    let (sin, cos) = bearing_rad.sin_cos();
    let (rise, level) = elevation_rad.sin_cos();
    nalgebra::Vector3::new(cos * level, sin * level, -rise)
}
