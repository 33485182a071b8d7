//! Targets in space: what is reported of them, how they move, filters that stay sound, and jobs.

mod consistency;
mod definite;
mod jobs;
mod motions;
mod plane;
mod sensing;

use nalgebra::{Matrix3, SMatrix, SVector};
use trackloom_domain::geodesy::Geodetic;
use trackloom_domain::model::sensing::{Carrier, RangeRate, Site, Spherical};
use trackloom_domain::model::space::Place;
use trackloom_domain::model::state::GaussianState;

pub type State6 = SVector<f64, 6>;

/// The two sites of the worked values, 154 km apart, and a target 309 km from the first.
pub const SITES: [Geodetic; 2] = [
    Geodetic {
        lat_deg: 50.1109,
        lon_deg: 8.6821,
        height_m: 112.0,
    },
    Geodetic {
        lat_deg: 50.9,
        lon_deg: 6.9,
        height_m: 150.0,
    },
];
pub const FAR: [f64; 3] = [-240_473.299_991_4, 193_813.519_129_7, 3_425.863_918_336];

pub fn site_of(index: usize) -> Site {
    let (origin, own) = (&SITES[0], &SITES[index]);
    Site {
        place_m: origin.enu_of(own),
        turn: origin.turn_to(own),
    }
}

/// Ranges, bearings, elevations and range rates.
pub fn radar(site: Site) -> Spherical {
    Spherical {
        site,
        carrier: Carrier::STANDING,
        is_flat: false,
        sigma_range_m: 30.0,
        sigma_bearing_rad: 0.004,
        sigma_elevation_rad: Some(0.006),
        range_rate: Some(RangeRate {
            sigma_mps: 1.0,
            span_mps: 400.0,
        }),
        clutter_span: None,
    }
}

/// Axes that are turned about all three of them.
pub fn turned(place_m: Place) -> Site {
    let turn = nalgebra::Rotation3::from_euler_angles(0.2, -0.3, 0.7);
    Site {
        place_m,
        turn: Matrix3::from(turn),
    }
}

/// A belief with these standard deviations of places and speeds, and correlations.
pub fn belief(mean: State6, sigma_m: f64, sigma_mps: f64) -> GaussianState<6> {
    let root = SMatrix::<f64, 6, 6>::from_fn(|row, column| {
        let sigma = if row < 3 { sigma_m } else { sigma_mps };
        sigma
            * (if row == column { 1.0 } else { 0.0 }
                + 0.1 * (((2 * row + 3 * column) % 5) as f64 - 2.0))
    });
    GaussianState {
        mean,
        covariance: root * root.transpose(),
    }
}
