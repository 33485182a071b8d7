//! Errors worked out by hand, and the consistency of a filter that is right about itself.

use super::fixture::{
    Row, Scene, assert_close, assert_series, evaluate_all, reason, set_covariance, values,
};
use nalgebra::Matrix4;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde_json::{Value, json};
use trackloom_domain::model::state::{Covariance, State};

fn spec() -> Value {
    json!({"metric": "kinematics"})
}

/// A target heading north at 10 m/s, its track 3 m to the right and 4 m ahead, then 3 m to the right and 4 m behind.
fn northbound() -> Scene {
    let truth = [
        (0.0, "a", 0.0, 0.0, 0.0, 10.0),
        (1.0, "a", 0.0, 10.0, 0.0, 10.0),
    ];
    let tracks = [
        (0.0, "t", 3.0, 4.0, 1.0, 10.0),
        (1.0, "t", 3.0, 6.0, 0.0, 7.0),
    ];
    Scene::new(&truth, &tracks)
}

#[test]
fn errors_along_and_across_the_course() {
    let report = northbound().evaluate(50.0, spec());
    let expected = [
        ("position_rmse", 5.0),
        ("position_95", 5.0),
        ("velocity_rmse", 5f64.sqrt()),
        ("along_rmse", 4.0),
        ("across_rmse", 3.0),
        ("along_bias", 0.0),
        ("across_bias", 3.0),
        ("x_bias", 3.0),
        ("y_bias", 0.0),
        ("matches", 2.0),
    ];
    for (name, value) in expected {
        assert_close(report.quantity(name), value, name);
        let of_truth = report.per_truth[0]
            .quantities
            .iter()
            .find(|quantity| quantity.name == name)
            .unwrap();
        assert_close(of_truth.value, value, name);
    }
    assert_series(&report, "position_rmse", &[5.0, 5.0]);
    assert_eq!(
        reason(&report, "nees_position"),
        "no matched track has a covariance that can be inverted"
    );
}

#[test]
fn the_95_percent_value_is_a_value_that_occurred() {
    // 40 steps with errors of 1 to 40 m: 38 of 40 are 95 %.
    let truth: Vec<Row> = (0..40)
        .map(|step| (f64::from(step), "a", 0.0, 0.0, 0.0, 0.0))
        .collect();
    let tracks: Vec<Row> = (0..40)
        .map(|step| (f64::from(step), "t", f64::from(step + 1), 0.0, 0.0, 0.0))
        .collect();
    let report = Scene::new(&truth, &tracks).evaluate(50.0, spec());
    assert_close(report.quantity("position_95"), 38.0, "95 %");
    assert_eq!(
        reason(&report, "along_rmse"),
        "no matched target is known to move"
    );
}

#[test]
fn nothing_matched_is_null_with_a_reason() {
    let none = Scene::new(
        &[(0.0, "a", 0.0, 0.0, 1.0, 0.0)],
        &[(0.0, "t", 90.0, 0.0, 1.0, 0.0)],
    )
    .evaluate(50.0, spec());
    assert_eq!(
        (none.value, none.reason),
        (None, Some("no track matches a target"))
    );
    assert_eq!(
        reason(&none, "velocity_rmse"),
        "no track with a velocity matches a target with one"
    );
    assert_eq!(values(&none, "position_rmse"), [None]);
    assert_close(none.quantity("matches"), 0.0, "matches");
}

#[test]
fn nees_by_hand() {
    // P = diag(9, 16, 1, 4): position (3, 4) gives 1 + 1, velocity (1, 0) adds 1; then (3, −4), (0, −3) adds 9/4.
    let mut scene = northbound();
    for point in &mut scene.tracks.tracks[0].points {
        set_covariance(
            point,
            Covariance::from_diagonal(&State::new(9.0, 16.0, 1.0, 4.0)),
        );
    }
    let report = scene.evaluate(50.0, spec());
    assert_close(report.quantity("nees_position"), 2.0, "position");
    assert_close(report.quantity("nees_state"), (3.0 + 4.25) / 2.0, "state");
    // χ²(4; 0.025) = 0.484419, χ²(4; 0.975) = 11.143287, halved for the mean of two samples of two numbers.
    assert!((report.quantity("nees_position_lower").unwrap() - 0.2422093).abs() < 1e-6);
    assert!((report.quantity("nees_position_upper").unwrap() - 5.5716434).abs() < 1e-6);
    assert_close(
        report.quantity("nees_position_steps_within"),
        1.0,
        "both steps are within",
    );
    assert_series(&report, "nees_state", &[3.0, 4.25]);
}

#[test]
fn nis_is_what_the_tracks_say_within_the_bounds_of_their_measurements() {
    let mut scene = northbound();
    for (point, nis) in scene.tracks.tracks[0].points.iter_mut().zip([1.0, 4.0]) {
        point.nis = Some(nis);
    }
    let report = scene.evaluate(
        50.0,
        json!({"metric": "kinematics", "measurement_dimensions": 1}),
    );
    assert_close(report.quantity("nis_of_matches"), 2.5, "mean");
    // χ²(2; 0.025) = 0.0506356, χ²(2; 0.975) = 7.3777589, halved for two samples of one number.
    assert!((report.quantity("nis_of_matches_lower").unwrap() - 0.0253178).abs() < 1e-6);
    assert!((report.quantity("nis_of_matches_upper").unwrap() - 3.6888795).abs() < 1e-6);
    assert_close(
        report.quantity("nis_of_matches_steps_within"),
        1.0,
        "both below 5.02",
    );
    assert_eq!(
        reason(&northbound().evaluate(50.0, spec()), "nis_of_matches"),
        "no matched track says the NIS of its updates"
    );
}

#[test]
fn a_singular_covariance_is_left_out() {
    let mut scene = northbound();
    set_covariance(&mut scene.tracks.tracks[0].points[0], Covariance::zeros());
    set_covariance(
        &mut scene.tracks.tracks[0].points[1],
        Covariance::identity(),
    );
    let report = scene.evaluate(50.0, spec());
    assert_close(
        report.quantity("nees_position"),
        25.0,
        "the second point alone",
    );
    assert_close(report.quantity("nees_position_samples"), 1.0, "one sample");
    assert_close(
        report.quantity("nees_position_steps_within"),
        0.0,
        "out of bounds",
    );
}

/// Ten targets far apart for 200 steps, errors drawn from a correlated covariance, `claimed` times which tracks claim.
fn simulated(seed: u64, claimed: f64) -> Scene {
    let root = Matrix4::new(
        3.0, 0.0, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.5, 0.1, 1.0, 0.0, -0.2, 0.4, 0.3, 0.8,
    );
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let names: Vec<String> = (0..10).map(|target| format!("{target}")).collect();
    let (mut truth, mut tracks): (Vec<Row>, Vec<Row>) = Default::default();
    for (target, name) in names.iter().enumerate() {
        for step in 0..200 {
            let (time_s, x, y) = (
                f64::from(step),
                10.0 * f64::from(step),
                1000.0 * target as f64,
            );
            let error = root * State::from_fn(|_, _| StandardNormal.sample(&mut rng));
            truth.push((time_s, name, x, y, 10.0, 0.0));
            tracks.push((
                time_s,
                name,
                x + error[0],
                y + error[1],
                10.0 + error[2],
                error[3],
            ));
        }
    }
    let mut scene = Scene::new(&truth, &tracks);
    for point in scene
        .tracks
        .tracks
        .iter_mut()
        .flat_map(|track| &mut track.points)
    {
        set_covariance(point, root * root.transpose() * claimed);
    }
    scene
}

#[test]
fn a_consistent_filter_lies_within_its_bounds_and_a_boastful_one_does_not() {
    let report = simulated(11, 1.0).evaluate(100.0, spec());
    for (mean, lower, upper, within) in [
        (
            "nees_position",
            "nees_position_lower",
            "nees_position_upper",
            "nees_position_steps_within",
        ),
        (
            "nees_state",
            "nees_state_lower",
            "nees_state_upper",
            "nees_state_steps_within",
        ),
    ] {
        let [mean, lower, upper, within] =
            [mean, lower, upper, within].map(|name| report.quantity(name).unwrap());
        assert!(lower < mean && mean < upper, "{lower} {mean} {upper}");
        assert!((0.90..=1.0).contains(&within), "{within}");
    }
    let boastful = simulated(11, 0.5).evaluate(100.0, spec());
    assert!(
        boastful.quantity("nees_state").unwrap() > boastful.quantity("nees_state_upper").unwrap()
    );
    assert!(boastful.quantity("nees_state_steps_within").unwrap() < 0.25);
}

#[test]
fn sequences_pool_their_errors() {
    let (one, two) = (
        northbound(),
        Scene::new(
            &[(0.0, "b", 0.0, 0.0, 1.0, 0.0)],
            &[(0.0, "t", 0.0, 1.0, 1.0, 0.0)],
        ),
    );
    let report = evaluate_all(&[&one, &two], 50.0, spec());
    assert_close(
        report.quantity("position_rmse"),
        ((25.0 + 25.0 + 1.0) / 3.0f64).sqrt(),
        "over three matches",
    );
    assert!(report.per_truth.is_empty());
    assert!(report.series.is_empty());
}
