//! Cells, what a map learns, and what neighbours tell.

use super::*;
use crate::model::scan::Detection;
use crate::model::sight::ViewSettings;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Poisson};

fn scan_of(places: &[[f64; 2]]) -> Scan {
    let detection = |place: &[f64; 2]| Detection {
        measurement: Measurement::Position {
            x_m: place[0],
            y_m: place[1],
        },
        origin: None,
        amplitude: None,
    };
    Scan {
        number: 1,
        time_s: 0.0,
        sensor: 0,
        pose: None,
        own: Vec::new(),
        detections: places.iter().map(detection).collect(),
    }
}

fn polar(bearing_deg: f64, range_m: f64) -> Measurement {
    Measurement::RangeBearing {
        range_m,
        bearing_rad: bearing_deg.to_radians(),
        range_rate_mps: None,
    }
}

#[test]
fn cells_of_a_polar_map_cover_what_they_say() {
    let limits = ViewSettings {
        bearing_from_deg: Some(300.0),
        bearing_to_deg: Some(60.0),
        range_from_m: Some(100.0),
        range_to_m: Some(700.0),
    };
    let plan = MapPlan {
        alpha: 0.05,
        area: MapArea::Polar(limits.limits()),
        cells: [4, 3],
    };
    let origin = Position::zeros();
    // Four arcs of 30° from 300° on, three rings of 200 m from 100 m on.
    let cell = |bearing_deg, range_m| plan.cell_of(&polar(bearing_deg, range_m), &origin);
    assert_eq!(
        [
            cell(301.0, 101.0),
            cell(329.0, 650.0),
            cell(0.5, 301.0),
            cell(59.0, 700.0)
        ],
        [Some(0), Some(2), Some(2 * 3 + 1), Some(3 * 3 + 2)]
    );
    assert_eq!(
        [cell(61.0, 200.0), cell(0.0, 99.0), cell(0.0, 701.0)],
        [None; 3]
    );
    // A third of the turn: π / 3 (700² − 100²) = 502 654.82 m²; the first ring of an arc π / 12 (300² − 100²).
    let total: f64 = (0..plan.cell_count())
        .map(|cell| plan.measure_of(cell))
        .sum();
    assert!(
        (total - PI / 3.0 * (490_000.0 - 10_000.0)).abs() < 1e-6,
        "{total}"
    );
    assert!((plan.measure_of(0) - PI / 12.0 * 80_000.0).abs() < 1e-9);
    for cell in 0..plan.cell_count() {
        let middle = plan.middle_of(cell, &origin);
        let report = polar(middle.bearing_rad.to_degrees(), middle.range_m.unwrap());
        assert_eq!(plan.cell_of(&report, &origin), Some(cell));
    }
}

/// A map of one cell of a square kilometre.
const ONE_CELL: MapPlan = MapPlan {
    alpha: 0.05,
    area: MapArea::Plane {
        low_m: Position::new(0.0, 0.0),
        high_m: Position::new(1000.0, 1000.0),
    },
    cells: [1, 1],
};

#[test]
fn a_map_wanders_around_the_density_as_worked_out() {
    // λ A = 5: variance α λ / ((2 − α) A) = 1.282051e-13, relative standard deviation 0.0716115.
    let count = Poisson::new(5.0).unwrap();
    let mut draw = ChaCha8Rng::seed_from_u64(7);
    let mut map = ClutterMap::new(vec![1.0]);
    let (mut sum, mut squares, scans) = (0.0, 0.0, 200_000);
    for index in 0..scans + 200 {
        let places = vec![[500.0, 500.0]; count.sample(&mut draw) as usize];
        map.learn(
            &ONE_CELL,
            (&scan_of(&places), &Position::zeros()),
            &vec![1.0; places.len()],
            5e-6,
        );
        if index >= 200 {
            sum += map.ratios()[0];
            squares += map.ratios()[0].powi(2);
        }
    }
    let mean = sum / f64::from(scans);
    let deviation = (squares / f64::from(scans) - mean * mean).sqrt();
    // About 39 scans an independent value: 5 000 of them.
    assert!((mean - 1.0).abs() < 3.0 * 0.0716 / 5000f64.sqrt(), "{mean}");
    assert!((deviation - 0.071_611_487_4).abs() < 0.003, "{deviation}");
}

#[test]
fn a_map_follows_half_a_change_in_thirteen_and_a_half_scans() {
    let mut map = ClutterMap::new(vec![1.0]);
    let mut before = 1.0;
    for scan in 1..=14 {
        before = map.ratios()[0];
        map.learn(&ONE_CELL, (&scan_of(&[]), &Position::zeros()), &[], 5e-6);
        assert!((map.ratios()[0] - 0.95f64.powi(scan)).abs() < 1e-12);
    }
    assert!(
        before > 0.5 && map.ratios()[0] < 0.5,
        "ln ½ / ln 0.95 = 13.513"
    );
    // 3 detections, of which a track takes 0.6 of one: 2.4 in 1e6 m² against 5e-6 per m².
    map.learn(
        &ONE_CELL,
        (&scan_of(&[[1.0, 1.0]; 3]), &Position::zeros()),
        &[1.0, 0.4, 1.0],
        5e-6,
    );
    let wanted = 0.95f64.powi(15) + 0.05 * 2.4 / 5.0;
    assert!((map.ratios()[0] - wanted).abs() < 1e-12);
    for _ in 0..1000 {
        map.learn(&ONE_CELL, (&scan_of(&[]), &Position::zeros()), &[], 5e-6);
    }
    assert!(
        (map.ratios()[0] * 5e-6 - LEAST_CLUTTER).abs() < 1e-20,
        "the floor"
    );
}

#[test]
fn neighbours_tell_the_density_without_bias() {
    // λ 0.01, k 5: E (k − 1) / (π d²) = 0.01 with a standard deviation of λ / √3 = 0.0057735.
    let (mut sum, mut squares, scenes) = (0.0, 0.0, 4000);
    for scene in 0..scenes {
        let mut draw = ChaCha8Rng::seed_from_u64(scene);
        let count = Poisson::new(0.01 * 80.0 * 80.0).unwrap().sample(&mut draw) as usize;
        let mut places = vec![[40.0, 40.0]];
        for _ in 0..count {
            places.push([draw.random_range(0.0..80.0), draw.random_range(0.0..80.0)]);
        }
        let mut ratios = Vec::new();
        log_ratios_by_neighbours(
            5,
            (&scan_of(&places), &Position::zeros()),
            0.01,
            &mut ratios,
        );
        let found = 0.01 * ratios[0].exp();
        sum += found;
        squares += found * found;
    }
    let mean = sum / scenes as f64;
    let deviation = (squares / scenes as f64 - mean * mean).sqrt();
    assert!(
        (mean - 0.01).abs() < 3.0 * 0.005_773_5 / (scenes as f64).sqrt(),
        "{mean}"
    );
    assert!((deviation - 0.005_773_5).abs() < 0.0008, "{deviation}");
}

#[test]
fn bearings_have_neighbours_on_two_sides() {
    let mut scan = scan_of(&[]);
    for bearing_deg in [0.0, 1.0, 358.0, 4.0, 180.0] {
        scan.detections.push(Detection {
            measurement: Measurement::Bearing {
                bearing_rad: f64::to_radians(bearing_deg),
            },
            origin: None,
            amplitude: None,
        });
    }
    let mut ratios = Vec::new();
    log_ratios_by_neighbours(3, (&scan, &Position::zeros()), 1.0, &mut ratios);
    // From 0° the third nearest is at 4°: 2 / (2 · 4°).
    assert!((ratios[0].exp() - 1.0 / 4f64.to_radians()).abs() < 1e-9);
    ratios.clear();
    log_ratios_by_neighbours(5, (&scan, &Position::zeros()), 1.0, &mut ratios);
    assert_eq!(ratios, [0.0; 5], "too few to tell");
}
