//! Reference values of PROJ 9.5.1 and pymap3d 3.2.0, and what must hold whatever the place.

use super::*;
use crate::model::state::Position;
use proptest::prelude::*;

fn geodetic((lat_deg, lon_deg, height_m): (f64, f64, f64)) -> Geodetic {
    Geodetic {
        lat_deg,
        lon_deg,
        height_m,
    }
}

fn assert_near(found: f64, wanted: f64, tolerance: f64) {
    assert!(
        (found - wanted).abs() <= tolerance,
        "{found} is not {wanted}"
    );
}

/// Latitude, longitude (degrees), height (m).
type Site = (f64, f64, f64);
/// The same without height.
type OnEarth = (f64, f64);
/// Range (NM), bearing (degrees), flight level, and where that is.
type Seen = (f64, f64, Option<f64>, OnEarth);

/// Latitude, longitude, height; geocentric.
const GEOCENTRIC: &[(Site, [f64; 3])] = &[
    (
        (63.4389029083, 10.39908278, 39.923),
        [2812709.903606396, 516182.3247799928, 5682056.950295131],
    ),
    (
        (50.77, -1.2, 0.0),
        [4040996.358615855, -84646.80693281167, 4917402.585805893],
    ),
    (
        (47.4582, 8.5555, 432.0),
        [4272507.218863516, 642762.1312797258, 4676675.095504443],
    ),
    (
        (43.57102202219, 16.40606241326, 780.0),
        [4440547.431549152, 1307434.7469542713, 4374219.778577672],
    ),
    (
        (89.9999, 0.0, 0.0),
        [11.16939795641181, 0.0, 6356752.314235432],
    ),
    (
        (-17.7, 179.95, 10.0),
        [-6078093.512493062, 5304.1385483002, -1926782.2913733276],
    ),
    ((0.0, 0.0, 0.0), [6378137.0, 0.0, 0.0]),
    (
        (51.5, -0.12, 35786000.0),
        [26255899.73164151, -54990.30821172813, 32974777.95841151],
    ),
    (
        (11.35, 142.2, -10900.0),
        [-4933353.079137677, 3826700.9042606195, 1244842.502654799],
    ),
];

/// Site; place; east, north, up.
const LOCAL: &[(Site, Site, [f64; 3])] = &[
    (
        (50.77, -1.2, 0.0),
        (50.7730133333333, -1.092935, 0.0),
        [7552.321194104392, 340.6808312892149, -4.471449749785904],
    ),
    (
        (50.77, -1.2, 0.0),
        (50.5172, -1.390667, 0.0),
        [-13522.778757577702, -28104.3166117797, -76.26893265517356],
    ),
    (
        (47.4582, 8.5555, 432.0),
        (47.456049515, 8.5780686599, 449.58),
        [1701.9416167886643, -238.86029954200552, 17.348877951484724],
    ),
    (
        (47.4582, 8.5555, 432.0),
        (45.8189849854, 9.2295455933, 10660.38),
        [52469.992273385426, -182274.03810085397, 7408.990991937768],
    ),
    (
        (43.57102202219, 16.40606241326, 780.0),
        (45.40080785751343, 15.13318419456482, 11000.0),
        [-99823.60796744144, 204409.9475319063, 6164.349643793801],
    ),
    (
        (43.57102202219, 16.40606241326, 780.0),
        (47.9, 16.4, 11582.4),
        [-454.10496607814275, 481565.7577261431, -7400.912493103358],
    ),
    (
        (89.9999, 0.0, 0.0),
        (89.9999, 180.0, 0.0),
        [
            1.3678567455722712e-15,
            22.338795912789596,
            -3.898855396272489e-05,
        ],
    ),
    (
        (-17.7, 179.95, 10.0),
        (-17.7, -179.95, 10.0),
        [10608.273057268158, -2.814576025382022, -8.819232215335907],
    ),
    (
        (0.0, 0.0, 0.0),
        (0.5, 0.5, 10000.0),
        [55744.195837290856, 55373.715634730164, 9515.153539039195],
    ),
    (
        (63.4389029083, 10.39908278, 39.923),
        (63.4389029083, 10.39908278, 39.923),
        [0.0, 0.0, 0.0],
    ),
    (
        (43.57102202219, 16.40606241326, 780.0),
        (39.0, 16.40606241326, 11582.4),
        [
            -5.820766091346741e-11,
            -508040.29460848926,
            -9471.237693296483,
        ],
    ),
];

/// Origin; place; x, y.
const PLANE: &[(OnEarth, OnEarth, [f64; 2])] = &[
    (
        (50.77, -1.2),
        (50.7730133333333, -1.092935),
        [7552.323838463082, 340.68095078752395],
    ),
    (
        (50.77, -1.2),
        (50.5172, -1.390667),
        [-13522.85946258683, -28104.48464080852],
    ),
    (
        (47.4582, 8.5555),
        (47.456049515, 8.5780686599),
        [1701.8219082901448, -238.8434471456595],
    ),
    (
        (47.4582, 8.5555),
        (45.8189849854, 9.2295455933),
        [52394.133556271256, -182009.64534896452],
    ),
    (
        (43.57102202219, 16.40606241326),
        (45.40080785751343, 15.13318419456482),
        [-99683.62598993981, 204122.2429500272],
    ),
    (
        (43.57102202219, 16.40606241326),
        (47.9, 16.4),
        [-453.9286176760725, 481377.48436291143],
    ),
    (
        (-17.7, 179.95),
        (-17.7, -179.95),
        [10608.263777037799, -2.814573567612549],
    ),
    (
        (0.0, 0.0),
        (0.5, 0.5),
        [55659.048377818595, 55288.560203950496],
    ),
    (
        (63.4389029083, 10.39908278),
        (63.4389029083, 10.39908278),
        [0.0, -1.064312238953719e-09],
    ),
    (
        (43.57102202219, 16.40606241326),
        (39.0, 16.40606241326),
        [0.0, -507923.8822937533],
    ),
];

/// From the site of a radar: range (NM), bearing (degrees), flight level; latitude, longitude.
const SLANT: &[Seen] = &[
    (
        64.0,
        90.0,
        Some(330.0),
        (43.56168122544841, 17.867451678982732),
    ),
    (
        197.68359375,
        340.13671875,
        Some(330.0),
        (46.65501820755618, 14.78325907985464),
    ),
    (
        5.0,
        180.0,
        Some(20.0),
        (43.48769918020331, 16.406062413260003),
    ),
    (120.0, 225.0, None, (42.14115491759228, 14.506137681467779)),
];
const RADAR: (f64, f64, f64) = (43.57102202219, 16.40606241326, 780.0);

#[test]
fn geocentric_coordinates_are_those_of_the_references() {
    for (place, ecef) in GEOCENTRIC {
        let place = geodetic(*place);
        let found = place.to_ecef();
        for axis in 0..3 {
            assert_near(found[axis], ecef[axis], 1e-6);
        }
        let back = Geodetic::from_ecef(&Place::from(*ecef));
        assert_near(back.lat_deg, place.lat_deg, 1e-11);
        assert_near(back.lon_deg, place.lon_deg, 1e-11);
        assert_near(back.height_m, place.height_m, 1e-6);
    }
}

#[test]
fn east_north_and_up_are_those_of_the_references() {
    for (site, place, enu) in LOCAL {
        let (site, place) = (geodetic(*site), geodetic(*place));
        let found = site.enu_of(&place);
        for axis in 0..3 {
            assert_near(found[axis], enu[axis], 1e-6);
        }
        let back = site.at_enu(&found);
        assert_near(back.lat_deg, place.lat_deg, 1e-11);
        assert_near(back.height_m, place.height_m, 1e-6);
    }
}

#[test]
fn the_plane_is_that_of_the_references() {
    for ((lat_deg, lon_deg), place, plane_m) in PLANE {
        let plane = Stereographic::about(*lat_deg, *lon_deg);
        let found = plane.project(place.0, place.1);
        assert_near(found.x, plane_m[0], 1e-6);
        assert_near(found.y, plane_m[1], 1e-6);
        let back = plane.unproject(&found);
        assert_near(back.0, place.0, 1e-11);
        assert_near(back.1, place.1, 1e-11);
    }
}

#[test]
fn slant_ranges_lead_where_the_references_say() {
    let site = geodetic(RADAR);
    for &(range_nm, bearing_deg, level, (lat_deg, lon_deg)) in SLANT {
        let height_m = level.map(|level| level * 30.48);
        let found = at_slant_range(&site, range_nm * 1852.0, bearing_deg.to_radians(), height_m);
        assert_near(found.lat_deg, lat_deg, 1e-9);
        assert_near(found.lon_deg, lon_deg, 1e-9);
        if let Some(height_m) = height_m {
            assert_near(found.height_m, height_m, 1e-9);
            assert_near(site.enu_of(&found).norm(), range_nm * 1852.0, 1e-3);
        }
    }
}

/// At both ends of the Earth, near and far, low and high: the place has the range to 1e-6 m and the bearing.
#[test]
fn slant_ranges_are_those_of_the_place_found() {
    for lat_deg in [-89.0, -45.0, 0.0, 52.3, 80.0] {
        let site = geodetic((lat_deg, 179.0, 250.0));
        for range_m in [12_000.0, 80_000.0, 470_000.0] {
            for height_m in [-100.0, 0.0, 3_000.0, 11_900.0] {
                let found = at_slant_range(&site, range_m, 2.0, Some(height_m));
                let enu_m = site.enu_of(&found);
                assert_near(enu_m.norm(), range_m, 1e-6);
                assert_near(enu_m.x.atan2(enu_m.y), 2.0, 1e-9);
            }
        }
    }
}

#[test]
fn a_range_shorter_than_the_height_is_right_above() {
    let site = geodetic(RADAR);
    let found = at_slant_range(&site, 1000.0, 1.0, Some(9000.0));
    assert_near(found.lat_deg, site.lat_deg, 1e-9);
    assert_near(found.lon_deg, site.lon_deg, 1e-9);
}

#[test]
fn poles_and_the_date_line_are_places_like_others() {
    for (lat_deg, lon_deg) in [(90.0, 0.0), (-90.0, 0.0), (0.0, 180.0), (-17.0, -180.0)] {
        let plane = Stereographic::about(lat_deg, lon_deg);
        let origin = plane.project(lat_deg, lon_deg);
        assert!(origin.norm() < 1e-6, "{lat_deg} {lon_deg}: {origin}");
        let back = plane.unproject(&Position::new(30_000.0, -40_000.0));
        let again = plane.project(back.0, back.1);
        assert!(
            (again - Position::new(30_000.0, -40_000.0)).norm() < 1e-6,
            "{lat_deg}: {again}"
        );
    }
    let plane = Stereographic::about(-17.7, 179.95);
    assert_near(
        plane.project(-17.7, -179.95).x,
        plane.project(-17.7, 180.05).x,
        1e-9,
    );
}

#[test]
fn north_turns_with_the_longitude() {
    let plane = Stereographic::about(50.0, 0.0);
    assert_near(plane.turn_rad(50.0, 0.0), 0.0, 1e-9);
    // On a sphere about a pole of the plane's own the turn at the same latitude is nearly −Δλ sin φ: the true value, by a finite
    // difference of the reference values' projection, is 0.766 of a degree a degree.
    assert_near(plane.turn_rad(50.0, 1.0).to_degrees(), -0.766, 2e-3);
    assert_near(plane.turn_rad(50.0, -1.0).to_degrees(), 0.766, 2e-3);
}

proptest! {
    #[test]
    fn what_is_projected_comes_back(
        (lat_deg, lon_deg) in (-89.9..89.9_f64, -180.0..180.0_f64),
        (x_m, y_m) in (-500_000.0..500_000.0_f64, -500_000.0..500_000.0_f64),
        height_m in -5_000.0..100_000.0_f64,
    ) {
        let plane = Stereographic::about(lat_deg, lon_deg);
        let there = plane.unproject(&Position::new(x_m, y_m));
        let back = plane.project(there.0, there.1);
        prop_assert!((back - Position::new(x_m, y_m)).norm() < 1e-6);
        let site = geodetic((lat_deg, lon_deg, 100.0));
        let place = geodetic((there.0, there.1, height_m));
        let again = site.at_enu(&site.enu_of(&place));
        prop_assert!((again.to_ecef() - place.to_ecef()).norm() < 1e-6);
    }
}
