//! A scene of the plane that is turned into a volume keeps all its distances, so every metric says the same of both.

use super::brute_force::random_scene;
use super::fixture::{Scene, assert_close, set_covariance};
use nalgebra::{Matrix6, Rotation3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::json;
use trackloom_domain::evaluation::metrics::{METRICS, MetricReport};
use trackloom_domain::model::space::{Place, Space};
use trackloom_domain::model::state::{Covariance, upper_triangle};
use trackloom_domain::model::track::{TrackPoint, TrackSet};
use trackloom_domain::model::truth::TruthSet;

/// What depends on the axes themselves.
const OF_AXES: [&str; 8] = [
    "along_rmse",
    "across_rmse",
    "along_bias",
    "across_bias",
    "x_bias",
    "y_bias",
    "z_bias",
    "z_rmse",
];

fn points(set: &mut TrackSet) -> impl Iterator<Item = &mut TrackPoint> {
    set.tracks.iter_mut().flat_map(|track| &mut track.points)
}

/// Both are of six variables; what is out of the plane has a variance of one there, and errs by nothing.
fn turned(scene: &Scene, turn: &Rotation3<f64>) -> Scene {
    let place = |place: Place| turn * place;
    let mut targets = scene.truth.targets().to_vec();
    for point in targets.iter_mut().flat_map(|target| &mut target.points) {
        (point.position, point.velocity) = (place(point.position), point.velocity.map(place));
    }
    let mut tracks = scene.tracks.clone();
    tracks.space = Space::Volume.of_points(!tracks.tracks.is_empty());
    for point in tracks.tracks.iter_mut().flat_map(|track| &mut track.points) {
        let estimate = &mut point.estimate;
        if let Some(covariance) = estimate.covariance::<4>() {
            estimate.covariance = Some(upper_triangle(&turned_covariance(&covariance, turn)));
        }
        estimate.position = place(estimate.position);
        estimate.velocity = estimate.velocity.map(place);
    }
    Scene {
        truth: TruthSet::new(Space::Volume, targets).unwrap(),
        tracks,
        steps: scene.steps,
    }
}

fn turned_covariance(flat: &Covariance, turn: &Rotation3<f64>) -> Matrix6<f64> {
    let mut whole = Matrix6::identity();
    let place_of = [0, 1, 3, 4];
    for (row, &to_row) in place_of.iter().enumerate() {
        for (column, &to_column) in place_of.iter().enumerate() {
            whole[(to_row, to_column)] = flat[(row, column)];
        }
    }
    let mut both = Matrix6::zeros();
    both.fixed_view_mut::<3, 3>(0, 0).copy_from(turn.matrix());
    both.fixed_view_mut::<3, 3>(3, 3).copy_from(turn.matrix());
    both * whole * both.transpose()
}

/// Every quantity but those of axes, and the bounds for another number of axes.
fn assert_same(flat: &MetricReport, turned: &MetricReport, what: &str) {
    for quantity in &flat.quantities {
        let name = quantity.name;
        let is_bound =
            name.starts_with("nees") && !name.ends_with("position") && !name.ends_with("state");
        if OF_AXES.contains(&name) || is_bound {
            continue;
        }
        let found = turned.quantity(name);
        match quantity.value {
            Some(value) => assert_close(found, value, &format!("{what}: {name}")),
            None => assert_eq!(found, None, "{what}: {name}"),
        }
    }
}

#[test]
fn a_turned_scene_is_judged_as_the_plane_is_by_every_metric() {
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    for case in 0..150 {
        let mut scene = random_scene(&mut rng, 3, 4);
        for point in scene
            .tracks
            .tracks
            .iter_mut()
            .flat_map(|track| &mut track.points)
        {
            set_covariance(point, Covariance::identity() * 4.0);
        }
        let axis = Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0));
        let turned = turned(&scene, &Rotation3::new(axis * 2.0));
        for method in METRICS {
            let spec = json!({"metric": method.name});
            let what = format!("{} of case {case}", method.name);
            assert_same(
                &scene.evaluate(7.0, spec.clone()),
                &turned.evaluate(7.0, spec),
                &what,
            );
        }
    }
}

/// The same volume with its heights left out on one side is what the plane says.
#[test]
fn where_only_one_side_has_heights_both_are_compared_in_the_plane() {
    let mut rng = ChaCha8Rng::seed_from_u64(22);
    for case in 0..50 {
        let mut flat = random_scene(&mut rng, 3, 4);
        if flat.truth.targets().is_empty() || flat.tracks.tracks.is_empty() {
            continue;
        }
        let mut high = flat.tracks.clone();
        high.space = Space::Volume;
        for point in points(&mut flat.tracks) {
            set_covariance(point, Covariance::identity() * 4.0);
        }
        let whole = Matrix6::from_diagonal(&[4.0, 4.0, 1e6, 4.0, 4.0, 1e6].into());
        for point in points(&mut high) {
            let estimate = &mut point.estimate;
            estimate.covariance = Some(upper_triangle(&whole));
            estimate.position.z = rng.random_range(-1e3..1e3);
            estimate.velocity.as_mut().unwrap().z = rng.random_range(-1e3..1e3);
        }
        let mixed = Scene {
            truth: flat.truth.clone(),
            tracks: high,
            steps: flat.steps,
        };
        for method in METRICS {
            let spec = json!({"metric": method.name});
            let (of_mixed, of_flat) = (mixed.evaluate(7.0, spec.clone()), flat.evaluate(7.0, spec));
            assert_eq!(
                of_mixed.quantities, of_flat.quantities,
                "{} of case {case}",
                method.name
            );
        }
    }
}
