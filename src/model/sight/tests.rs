//! Limits, sectors, P_D by range, and what is seen of an uncertain track.

use super::*;
use crate::model::state::State;

const RADAR: ViewSettings = ViewSettings {
    bearing_from_deg: None,
    bearing_to_deg: None,
    range_from_m: None,
    range_to_m: None,
};

fn spot(bearing_deg: f64, range_m: f64) -> Spot {
    Spot {
        bearing_rad: bearing_deg.to_radians(),
        range_m: Some(range_m),
    }
}

fn sight(view: ViewSettings, sectors: &[SectorSettings]) -> Sight {
    let sector = |sector: &SectorSettings| Sector {
        limits: sector.view().limits(),
        p_d: sector.p_d,
        log_clutter_ratio: sector
            .clutter_per_m2
            .map_or(0.0, |clutter| (clutter / 1e-6).ln()),
    };
    Sight {
        place_m: Position::zeros(),
        view: view.limits(),
        sectors: sectors.iter().map(sector).collect(),
        p_d: 0.9,
        by_range: None,
        clutter: None,
    }
}

#[test]
fn limits_go_clockwise_and_may_hold_north() {
    let limits = ViewSettings {
        bearing_from_deg: Some(300.0),
        bearing_to_deg: Some(60.0),
        range_from_m: Some(100.0),
        range_to_m: Some(1000.0),
    }
    .limits();
    let inside = [
        (0.0, 500.0),
        (300.0, 100.0),
        (-60.0, 1000.0),
        (60.0, 500.0),
        (359.0, 500.0),
    ];
    let outside = [
        (61.0, 500.0),
        (180.0, 500.0),
        (299.0, 500.0),
        (0.0, 99.0),
        (0.0, 1001.0),
    ];
    for (bearing_deg, range_m) in inside {
        assert!(
            limits.hold(&spot(bearing_deg, range_m)),
            "{bearing_deg} {range_m}"
        );
    }
    for (bearing_deg, range_m) in outside {
        assert!(
            !limits.hold(&spot(bearing_deg, range_m)),
            "{bearing_deg} {range_m}"
        );
    }
    let bearing = Spot {
        range_m: None,
        ..spot(10.0, 0.0)
    };
    assert!(
        limits.hold(&bearing),
        "bearings alone decide where ranges are not known"
    );
    let turn = ViewSettings {
        bearing_from_deg: Some(90.0),
        bearing_to_deg: Some(450.0),
        ..RADAR
    };
    assert!(
        turn.limits().hold(&spot(80.0, 5.0)),
        "from 90° to 450° is the whole turn"
    );
}

#[test]
fn the_first_sector_that_holds_a_place_says_what_is_seen_there() {
    let near = SectorSettings {
        range_to_m: Some(100.0),
        p_d: Some(0.5),
        ..SectorSettings::default()
    };
    let east = SectorSettings {
        bearing_from_deg: Some(45.0),
        bearing_to_deg: Some(135.0),
        p_d: Some(0.2),
        clutter_per_m2: Some(1e-4),
        ..SectorSettings::default()
    };
    let view = ViewSettings {
        range_to_m: Some(1000.0),
        ..RADAR
    };
    let seen = sight(view, &[near, east]);
    let p_d = |bearing_deg, range_m| seen.p_d_at(&spot(bearing_deg, range_m));
    assert_eq!(
        [
            p_d(90.0, 50.0),
            p_d(90.0, 500.0),
            p_d(0.0, 500.0),
            p_d(90.0, 1500.0)
        ],
        [0.5, 0.2, 0.9, 0.0]
    );
    let ratio = |bearing_deg, range_m| seen.log_clutter_ratio_at(&spot(bearing_deg, range_m));
    assert_eq!([ratio(0.0, 500.0), ratio(90.0, 50.0)], [0.0, 0.0]);
    assert!((ratio(90.0, 500.0) - 100f64.ln()).abs() < 1e-12);
}

#[test]
fn p_d_falls_with_the_range_as_swerling_1_has_it() {
    // P_FA 1e-6, P_D 0.9 at 20 km: 1 + SNR₀ = ln 1e-6 / ln 0.9 = 131.126; P_D(r) = 1e-6^(1 / (1 + 130.126 (20 km / r)⁴)).
    let law = RangeLaw::new(0.9, 20e3, 1e-6);
    assert!((law.snr - 130.126_071_960_697).abs() < 1e-9);
    for (range_m, wanted) in [
        (10e3, 0.993_389_494_504_355_9),
        (20e3, 0.9),
        (30e3, 0.596_092_761_625_244_8),
        (40e3, 0.220_309_410_655_587_73),
        (60e3, 0.004_989_509_673_911_405),
    ] {
        assert!(
            (law.p_d(range_m) - wanted).abs() < 1e-12,
            "{range_m}: {}",
            law.p_d(range_m)
        );
    }
    assert_eq!(law.p_d(0.0), 1.0);
    assert!((law.p_d(1e9) - 1e-6).abs() < 1e-12, "a false alarm is left");
}

/// A track at (x, y) with these standard deviations.
fn belief(x_m: f64, y_m: f64, sigma_x_m: f64, sigma_y_m: f64) -> GaussianState {
    let mut belief = GaussianState {
        mean: State::new(x_m, y_m, 0.0, 0.0),
        covariance: nalgebra::SMatrix::identity(),
    };
    belief.covariance[(0, 0)] = sigma_x_m * sigma_x_m;
    belief.covariance[(1, 1)] = sigma_y_m * sigma_y_m;
    belief
}

#[test]
fn p_d_of_a_track_fades_at_an_edge() {
    let view = ViewSettings {
        range_to_m: Some(1000.0),
        ..RADAR
    };
    let seen = sight(view, &[]);
    // The tail of the standard normal distribution beyond so many σ.
    let tails = [
        (0.2, 0.420_740),
        (0.6, 0.274_253),
        (1.2, 0.115_070),
        (2.5, 0.006_210),
    ];
    for (offset, share) in tails
        .into_iter()
        .flat_map(|(offset, tail)| [(offset, tail), (-offset, 1.0 - tail)])
    {
        // σ 20 m along the range at 1 000 m + offset σ.
        let found = seen.mean_p_d(
            &belief(0.0, 1000.0 + 20.0 * offset, 1.0, 20.0),
            &Position::zeros(),
        );
        let wanted = 0.9 * share;
        assert!(
            (found - wanted).abs() < 0.9 / 14.0 + 1e-9,
            "{offset}: {found} for {wanted}"
        );
    }
    let inside = seen.mean_p_d(&belief(300.0, 200.0, 10.0, 10.0), &Position::zeros());
    assert_eq!(
        inside, 0.9,
        "far from every edge it is the sensor's to the bit"
    );
    assert_eq!(
        seen.mean_p_d(&belief(0.0, 2000.0, 10.0, 10.0), &Position::zeros()),
        0.0
    );
}

#[test]
fn the_mean_over_a_track_is_that_of_drawn_places() {
    let east = SectorSettings {
        bearing_from_deg: Some(80.0),
        bearing_to_deg: Some(100.0),
        range_from_m: Some(900.0),
        range_to_m: Some(1100.0),
        p_d: Some(0.1),
        ..SectorSettings::default()
    };
    let seen = sight(RADAR, &[east]);
    let mut track = belief(1050.0, 120.0, 80.0, 100.0);
    track.covariance[(0, 1)] = 3000.0;
    track.covariance[(1, 0)] = 3000.0;
    // Cholesky of [6400 3000; 3000 10000]: 80, 37.5, √(10000 − 37.5²).
    let root = (10_000.0 - 37.5f64 * 37.5).sqrt();
    let (mut sum, mut count) = (0.0, 0);
    // A fine grid of ±4 σ, weighted by the density.
    for i in -200..=200 {
        for j in -200..=200 {
            let (a, b) = (f64::from(i) / 50.0, f64::from(j) / 50.0);
            let weight = (-0.5 * (a * a + b * b)).exp() / std::f64::consts::TAU / 2500.0;
            let place = Position::new(1050.0 + 80.0 * a, 120.0 + 37.5 * a + root * b);
            sum += weight * seen.p_d_at(&Spot::of_place(&place, &Position::zeros()));
            count += 1;
        }
    }
    let found = seen.mean_p_d(&track, &Position::zeros());
    assert!(
        count == 401 * 401 && (found - sum).abs() < 0.05,
        "{found} for {sum}"
    );
}

#[test]
fn what_no_sensor_sees_so_is_no_setting() {
    let arc = |from, to| ViewSettings {
        bearing_from_deg: from,
        bearing_to_deg: to,
        ..RADAR
    };
    let ring = |from, to| ViewSettings {
        range_from_m: from,
        range_to_m: to,
        ..RADAR
    };
    assert!(arc(Some(350.0), Some(10.0)).is_sound() && ring(Some(5.0), Some(6.0)).is_sound());
    for wrong in [
        arc(Some(1.0), None),
        arc(None, Some(1.0)),
        ring(Some(6.0), Some(5.0)),
        ring(Some(-1.0), None),
    ] {
        assert!(!wrong.is_sound(), "{wrong:?}");
    }
    let sector = |p_d| SectorSettings {
        p_d,
        ..SectorSettings::default()
    };
    assert!(sector(Some(0.0)).is_sound() && !sector(Some(1.1)).is_sound());
}
