//! Common times by hand, and drawn tracks against what their settings say.

use nalgebra::Vector4;
use serde::Deserialize;
use serde_json::{Value, json};
use trackloom_domain::correlation::alignment::{Alignment, Assumed, Node, align};
use trackloom_domain::math::rng::Seed;
use trackloom_domain::model::state::{Covariance, State};
use trackloom_domain::model::track::{Kinematics, Track, TrackPoint, TrackSet};
use trackloom_domain::registry;
use trackloom_domain::simulation::{
    LOCAL_TRACKS, LocalTracks, SensorTracks, simulate_local_tracks,
};

/// A sensor with one track: times with states.
fn node(name: &str, points: &[(f64, [f64; 4])], estimate: impl Fn(State) -> Kinematics) -> Node {
    let point = |&(time_s, state): &(f64, [f64; 4])| TrackPoint {
        height_m: None,
        time_s,
        sensor: None,
        estimate: estimate(State::from(state)),
        status: None,
        nis: None,
        known_at_s: None,
        existence: None,
        mode_row: None,
        first_candidate: 0,
        candidates: 0,
    };
    let track = Track {
        track_id: "1".to_owned(),
        points: points.iter().map(point).collect(),
    };
    Node {
        sensor_id: name.to_owned(),
        tracks: TrackSet {
            tracks: vec![track],
            ..TrackSet::default()
        },
    }
}

fn known(state: State) -> Kinematics {
    let covariance = Covariance::from_diagonal(&Vector4::new(1.0, 1.0, 0.25, 0.25));
    Kinematics::of_plane(&state, true, Some(&covariance))
}

const ALIGNMENT: Alignment = Alignment {
    process_noise_m2ps3: 2.0,
    max_gap_s: 0.8,
    assumed: None,
};

#[test]
fn a_track_is_predicted_to_the_times_of_the_other() {
    let (a, b) = (
        node(
            "a",
            &[
                (0.0, [0.0; 4]),
                (1.0, [0.0; 4]),
                (2.0, [0.0; 4]),
                (3.0, [0.0; 4]),
            ],
            known,
        ),
        node(
            "b",
            &[(0.5, [10.0, -1.0, 4.0, 2.0]), (2.0, [16.0, 2.0, 4.0, 2.0])],
            known,
        ),
    );
    let (estimates, left_out) = align(&[a, b], &[0.0, 1.0, 2.0, 3.0], &ALIGNMENT);
    // At 0 b has not begun, at 3 its last point is older than the gap.
    assert_eq!((&*estimates.times_s, left_out), (&[1.0, 2.0][..], 0));
    let predicted = estimates.at(1, 0).unwrap();
    assert_eq!(predicted.mean, State::new(12.0, 0.0, 4.0, 2.0));
    // Half a second: 1 + ¼ · ¼ + 2 / 24, ½ · ¼ + 2 / 8, ¼ + 1.
    let found = [(0, 0), (0, 2), (2, 2), (0, 1)].map(|place| predicted.covariance[place]);
    let expected = [1.0 + 0.0625 + 1.0 / 12.0, 0.375, 1.25, 0.0];
    assert!(
        found
            .iter()
            .zip(expected)
            .all(|(is, should)| (is - should).abs() < 1e-12),
        "{found:?}"
    );
    assert_eq!(
        estimates.at(1, 1).unwrap().mean,
        State::new(16.0, 2.0, 4.0, 2.0)
    );
}

#[test]
fn tracks_without_velocities_count_at_their_own_times() {
    let positions = |state: State| Kinematics {
        velocity: None,
        ..known(state)
    };
    let nodes = [
        node("a", &[(0.0, [0.0; 4]), (1.0, [0.0; 4])], known),
        node("b", &[(0.5, [9.0; 4]), (1.0, [1.0; 4])], positions),
    ];
    let (estimates, _) = align(&nodes, &[0.0, 1.0], &ALIGNMENT);
    assert_eq!(
        (&*estimates.times_s, estimates.dimensions()),
        (&[1.0][..], 2)
    );
    assert_eq!(
        estimates.at(1, 0).unwrap().mean,
        State::new(1.0, 1.0, 0.0, 0.0)
    );
}

#[test]
fn what_is_assumed_takes_the_place_of_missing_covariances() {
    let bare = |state: State| Kinematics {
        covariance: None,
        ..known(state)
    };
    let nodes = [
        node("a", &[(0.0, [0.0; 4])], known),
        node("b", &[(0.0, [3.0; 4])], bare),
    ];
    let assumed = Some(Assumed {
        sigma_m: 2.0,
        sigma_mps: Some(0.5),
    });
    let (estimates, _) = align(
        &nodes,
        &[0.0],
        &Alignment {
            assumed,
            ..ALIGNMENT
        },
    );
    let covariance = estimates.at(1, 0).unwrap().covariance;
    assert_eq!(
        (
            covariance[(0, 0)],
            covariance[(3, 3)],
            estimates.dimensions()
        ),
        (4.0, 0.25, 4)
    );
    // Of positions alone: velocities are not compared.
    let (estimates, _) = align(
        &nodes,
        &[0.0],
        &Alignment {
            assumed: Some(Assumed {
                sigma_m: 2.0,
                sigma_mps: None,
            }),
            ..ALIGNMENT
        },
    );
    assert_eq!(estimates.dimensions(), 2);
}

/// Sensor and target of a track, and its errors time by time.
type Errors = (usize, u32, Vec<State>);

/// Drawn tracks with their errors.
fn drawn(settings: Value) -> (Vec<SensorTracks>, Vec<Errors>) {
    let settings =
        LocalTracks::deserialize(&registry::check(&settings, &LOCAL_TRACKS).unwrap()).unwrap();
    let (sensors, truth) = simulate_local_tracks(&settings, Seed { seed: 5, run: 0 }).unwrap();
    let mut errors = Vec::new();
    for (sensor, tracks) in sensors.iter().enumerate() {
        for (track, origin) in tracks.tracks.tracks.iter().zip(&tracks.origins) {
            let Some(origin) = *origin else { continue };
            let target = &truth.targets()[origin as usize].points;
            let error =
                |(point, truth): (&TrackPoint, &trackloom_domain::model::truth::TruthPoint)| {
                    let (state, position_m) = (point.estimate.state(), truth.position);
                    assert_eq!(point.time_s, truth.time_s);
                    State::new(state[0] - position_m[0], state[1] - position_m[1], 0.0, 0.0)
                };
            errors.push((
                sensor,
                origin,
                track.points.iter().zip(target).map(error).collect(),
            ));
        }
    }
    (sensors, errors)
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    sum / f64::from(count)
}

#[test]
fn drawn_tracks_have_the_errors_that_were_asked_for() {
    let (_, errors) = drawn(
        json!({"sensors": 2, "targets": 4000, "sigma_m": 10.0, "correlation": 0.8, "times": 2}),
    );
    let variance = mean(errors.iter().map(|(_, _, of)| of[0][0].powi(2)));
    let lag = mean(errors.iter().map(|(_, _, of)| of[0][0] * of[1][0]));
    // 8 000 tracks: ± 3 % are four standard deviations.
    assert!(
        (variance - 100.0).abs() < 6.5 && (lag - 80.0).abs() < 6.5,
        "{variance}, {lag}"
    );
    let between = |errors: &[Errors]| {
        let of_sensor = |sensor: usize| {
            let mut found: Vec<_> = errors
                .iter()
                .filter(|error| error.0 == sensor)
                .map(|(_, target, of)| (*target, of[0][0]))
                .collect();
            found.sort_by_key(|found| found.0);
            found
        };
        mean(
            of_sensor(0)
                .iter()
                .zip(of_sensor(1))
                .map(|(left, right)| left.1 * right.1),
        )
    };
    assert!(between(&errors).abs() < 6.5, "{}", between(&errors));
    let (_, common) = drawn(
        json!({"sensors": 2, "targets": 4000, "sigma_m": 10.0, "cross_correlation": 0.5, "times": 1}),
    );
    let variance = mean(common.iter().map(|(_, _, of)| of[0][0].powi(2)));
    assert!(
        (between(&common) - 50.0).abs() < 7.0 && (variance - 100.0).abs() < 6.5,
        "{}, {variance}",
        between(&common)
    );
}

#[test]
fn drawn_sensors_miss_targets_have_false_tracks_and_biases() {
    let (sensors, errors) = drawn(
        json!({"sensors": 3, "targets": 2000, "sigma_m": 1.0, "p_d": 0.7, "false_tracks": 300.0, "bias_m": 50.0, "times": 1}),
    );
    for (sensor, tracks) in sensors.iter().enumerate() {
        let found = tracks.origins.iter().flatten().count();
        assert!(
            (1318..1482).contains(&found),
            "{found}: four standard deviations of 2 000 at 0.7"
        );
        let strange = tracks.origins.len() - found;
        assert!(
            (231..370).contains(&strange),
            "{strange}: four standard deviations of 300"
        );
        let of = |axis: usize| {
            mean(
                errors
                    .iter()
                    .filter(|error| error.0 == sensor)
                    .map(|(_, _, of)| of[0][axis]),
            )
        };
        assert!(
            (of(0).hypot(of(1)) - 50.0).abs() < 0.2,
            "{} {}",
            of(0),
            of(1)
        );
    }
    let (none, _) = drawn(json!({"sensors": 2, "targets": 5, "times": 1}));
    assert!(
        none.iter()
            .all(|sensor| sensor.origins.iter().flatten().count() == 5
                && sensor.tracks.tracks.len() == 5)
    );
}
