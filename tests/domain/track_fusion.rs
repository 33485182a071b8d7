//! Fusion against numbers by hand, covariance intersection against every correlation that errors can have, and the recursion of the
//! cross-covariance against the filters that made the tracks.

use nalgebra::{Matrix4, SMatrix, Vector4};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use serde_json::json;
use std::sync::Arc;
use trackloom_domain::correlation::cross_covariance::CrossTable;
use trackloom_domain::correlation::estimates::{AlignedEstimate, Estimates};
use trackloom_domain::correlation::evidence::{Evidence, Times};
use trackloom_domain::correlation::fusion::{FUSIONS, Fusion, Members, system_tracks};
use trackloom_domain::math::rng::{Purpose, Seed};
use trackloom_domain::model::state::{Covariance, GaussianState, State};
use trackloom_domain::model::track::{Kinematics, Track, TrackPoint};
use trackloom_domain::registry;

fn fusion(method: &str) -> Box<dyn Fusion> {
    let entry = FUSIONS.iter().find(|entry| entry.name == method).unwrap();
    (entry.build)(&registry::check(&json!({}), entry.parameters).unwrap()).unwrap()
}

fn state(mean: [f64; 4], variances: [f64; 4]) -> GaussianState {
    GaussianState {
        mean: State::from(mean),
        covariance: Covariance::from_diagonal(&Vector4::from(variances)),
    }
}

fn estimate(mean: State, covariance: Covariance) -> AlignedEstimate {
    AlignedEstimate::new(&GaussianState { mean, covariance }).unwrap()
}

/// x and its variance of two tracks at x = 0 ± 1 and x = 3 ± √2, with P₁₂ = ρ I.
fn fused_by(method: &str, cross: Option<f64>) -> (f64, f64) {
    let covariance = |variance: f64| Covariance::identity() * variance;
    let (one, other) = (
        estimate(State::zeros(), covariance(1.0)),
        estimate(State::new(3.0, 0.0, 0.0, 0.0), covariance(2.0)),
    );
    let cross: Vec<Covariance> = cross.iter().map(|&value| covariance(value)).collect();
    let fused = fusion(method)
        .fuse(&Members {
            estimates: &[&one, &other],
            cross: &cross,
        })
        .unwrap();
    (fused.mean[0], fused.covariance[(0, 0)])
}

fn assert_near(found: (f64, f64), expected: (f64, f64)) {
    assert!(
        (found.0 - expected.0).abs() < 1e-9 && (found.1 - expected.1).abs() < 1e-9,
        "{found:?} for {expected:?}"
    );
}

#[test]
fn two_tracks_by_hand() {
    // Information 1 and ½: x̂ = (½ · 3) / 1.5, P = 1 / 1.5.
    assert_near(fused_by("weighted", None), (1.0, 2.0 / 3.0));
    assert_near(fused_by("best_sensor", None), (0.0, 1.0));
    // x̂ = 0 + (1 − ½) / (1 + 2 − 1) · 3, P = 1 − (1 − ½)² / 2; without a cross-covariance the weighted mean.
    assert_near(fused_by("modified", Some(0.5)), (0.75, 0.875));
    assert_near(fused_by("modified", None), (1.0, 2.0 / 3.0));
    // One of two that differ in size alone is no worse than any mixture.
    assert_near(fused_by("covariance_intersection", None), (0.0, 1.0));
}

#[test]
fn covariance_intersection_of_two_crossed_ellipses_by_hand() {
    // By symmetry ω = ½: P⁻¹ = ½ · 1 + ½ · ¼ on both axes, x̂ = P (½ · 1 · 1, ½ · ¼ · 1).
    let one = estimate(
        State::new(1.0, 1.0, 0.0, 0.0),
        Covariance::from_diagonal(&Vector4::new(1.0, 4.0, 1.0, 1.0)),
    );
    let other = estimate(
        State::zeros(),
        Covariance::from_diagonal(&Vector4::new(4.0, 1.0, 1.0, 1.0)),
    );
    let fused = fusion("covariance_intersection")
        .fuse(&Members {
            estimates: &[&one, &other],
            cross: &[],
        })
        .unwrap();
    let expected = [
        (fused.covariance[(0, 0)], 1.6),
        (fused.covariance[(1, 1)], 1.6),
        (fused.mean[0], 0.8),
        (fused.mean[1], 0.2),
    ];
    assert!(
        expected
            .iter()
            .all(|(is, should)| (is - should).abs() < 1e-5),
        "{expected:?}"
    );
}

fn random_covariance(draw: &mut impl RngExt) -> Covariance {
    let root = Covariance::from_fn(|_, _| StandardNormal.sample(draw));
    root * root.transpose() + Covariance::identity() * 0.1
}

/// The least eigenvalue of P less what the errors of the fused state really are, for P₁₂ = √P₁ K √P₂ᵀ.
fn slack(fusion: &dyn Fusion, [left, right]: [Covariance; 2], correlation: &Covariance) -> f64 {
    let fuse = |mean: State| {
        let (left, right) = (estimate(mean, left), estimate(State::zeros(), right));
        fusion
            .fuse(&Members {
                estimates: &[&left, &right],
                cross: &[],
            })
            .unwrap()
    };
    // The fused state is linear in the two: its weights are what it makes of unit vectors.
    let weights = Covariance::from_columns(
        &[0, 1, 2, 3]
            .map(|axis| fuse(State::from_fn(|row, _| f64::from(u8::from(row == axis)))).mean),
    );
    let others = Covariance::identity() - weights;
    let cross =
        left.cholesky().unwrap().l() * correlation * right.cholesky().unwrap().l().transpose();
    let mixed = weights * cross * others.transpose();
    let real = weights * left * weights.transpose()
        + others * right * others.transpose()
        + mixed
        + mixed.transpose();
    (fuse(State::zeros()).covariance - real)
        .symmetric_eigenvalues()
        .min()
}

#[test]
fn covariance_intersection_claims_no_more_than_it_knows_and_the_weighted_mean_does() {
    let mut draw = Seed { seed: 4, run: 0 }.stream(Purpose::LocalTracks, 0, 0);
    let (intersection, weighted) = (fusion("covariance_intersection"), fusion("weighted"));
    let mut overconfident = 0;
    for _ in 0..500 {
        let covariances = [random_covariance(&mut draw), random_covariance(&mut draw)];
        // Any K whose singular values are at most 1.
        let any = Covariance::from_fn(|_, _| StandardNormal.sample(&mut draw));
        let correlation = any / any.singular_values().max() * draw.random::<f64>();
        let found = slack(&*intersection, covariances, &correlation);
        assert!(found > -1e-9, "{found}");
        overconfident += usize::from(slack(&*weighted, covariances, &correlation) < -1e-9);
    }
    assert!(overconfident > 250, "{overconfident} of 500");
}

#[test]
fn system_tracks_have_the_times_of_any_member() {
    let sensors = vec![
        ("a".to_owned(), vec!["1".to_owned()]),
        ("b".to_owned(), vec!["1".to_owned(), "2".to_owned()]),
    ];
    let mut estimates = Estimates::new(sensors, vec![0.0, 1.0, 2.0], true);
    let place = |x_m: f64, variance: f64| state([x_m, 0.0, 0.0, 0.0], [variance; 4]);
    for (track, time, x_m, variance) in [
        (0, 0, 0.0, 1.0),
        (0, 1, 0.0, 1.0),
        (1, 1, 3.0, 2.0),
        (2, 2, 7.0, 1.0),
    ] {
        assert!(estimates.set(track, time, &place(x_m, variance)));
    }
    let evidence = Evidence {
        estimates: Arc::new(estimates),
        cross: None,
        times: Times::All,
        until: 3,
    };
    let tracks = system_tracks(&evidence, &[vec![0, 1], vec![2]], &*fusion("weighted")).tracks;
    let rounded = |x_m: f64| (x_m * 1e9).round() / 1e9;
    let x_m = |track: &Track| {
        let points = track
            .points
            .iter()
            .map(|point| (point.time_s, rounded(point.estimate.state()[0])));
        points.collect::<Vec<_>>()
    };
    assert_eq!(
        (x_m(&tracks[0]), x_m(&tracks[1])),
        (vec![(0.0, 0.0), (1.0, 1.0)], vec![(2.0, 7.0)])
    );
    assert_eq!(
        tracks
            .iter()
            .map(|track| &*track.track_id)
            .collect::<Vec<_>>(),
        ["1", "2"]
    );
}

/// A Kalman filter of one target: positions measured every second with its own noise.
struct Filter {
    covariance: Matrix4<f64>,
    noise_m: f64,
}

const PROCESS_NOISE_M2PS3: f64 = 3.0;

/// F, Q and H.
fn model(dt_s: f64) -> (Matrix4<f64>, Matrix4<f64>, SMatrix<f64, 2, 4>) {
    let mut transition = Matrix4::identity();
    let mut noise = Matrix4::zeros();
    for axis in 0..2 {
        transition[(axis, axis + 2)] = dt_s;
        noise[(axis, axis)] = PROCESS_NOISE_M2PS3 * dt_s.powi(3) / 3.0;
        noise[(axis, axis + 2)] = PROCESS_NOISE_M2PS3 * dt_s.powi(2) / 2.0;
        noise[(axis + 2, axis)] = noise[(axis, axis + 2)];
        noise[(axis + 2, axis + 2)] = PROCESS_NOISE_M2PS3 * dt_s;
    }
    (transition, noise, SMatrix::identity())
}

impl Filter {
    /// I − K H of one step.
    fn step(&mut self) -> Matrix4<f64> {
        let (transition, noise, measured) = model(1.0);
        let predicted = transition * self.covariance * transition.transpose() + noise;
        let innovation = measured * predicted * measured.transpose()
            + SMatrix::<f64, 2, 2>::identity() * self.noise_m.powi(2);
        let gain = predicted * measured.transpose() * innovation.try_inverse().unwrap();
        let left = Matrix4::identity() - gain * measured;
        self.covariance = left * predicted;
        self.covariance = (self.covariance + self.covariance.transpose()) * 0.5;
        left
    }
}

#[test]
fn the_recursion_finds_what_two_filters_have_in_common() {
    const TIMES: usize = 8;
    let mut filters = [(5.0, 100.0), (12.0, 60.0)].map(|(noise_m, variance)| Filter {
        covariance: Matrix4::identity() * variance,
        noise_m,
    });
    let (transition, noise, _) = model(1.0);
    let mut expected = vec![Matrix4::zeros()];
    let mut tracks: Vec<Vec<TrackPoint>> = vec![Vec::new(), Vec::new()];
    let point = |time: usize, covariance: Matrix4<f64>| TrackPoint {
        height_m: None,
        time_s: time as f64,
        sensor: None,
        estimate: Kinematics::of_plane(&State::zeros(), true, Some(&covariance)),
        status: None,
        nis: None,
        known_at_s: None,
        existence: None,
        mode_row: None,
        first_candidate: 0,
        candidates: 0,
    };
    for time in 0..TIMES {
        if time > 0 {
            let [left, right] = filters.each_mut().map(Filter::step);
            let predicted = transition * expected[time - 1] * transition.transpose() + noise;
            expected.push(left * predicted * right.transpose());
        }
        tracks
            .iter_mut()
            .zip(&filters)
            .for_each(|(track, filter)| track.push(point(time, filter.covariance)));
    }
    let tracks: Vec<Track> = tracks
        .into_iter()
        .map(|points| Track {
            track_id: "1".to_owned(),
            points,
        })
        .collect();
    let named = |name: &str| (name.to_owned(), vec!["1".to_owned()]);
    let estimates = Estimates::new(
        vec![named("a"), named("b")],
        (0..TIMES).map(|time| time as f64).collect(),
        true,
    );
    let table = CrossTable::by_recursion(
        &estimates,
        &[&tracks[0], &tracks[1]],
        &[(0, 1)],
        PROCESS_NOISE_M2PS3,
    );
    for (time, expected) in expected.iter().enumerate() {
        let difference = (table.at(0, 1, time) - expected).abs().max();
        assert!(
            difference < 1e-8 * expected.abs().max().max(1.0),
            "at {time}: {difference}"
        );
    }
    // It settles far from nothing: the filters meet the same manoeuvres.
    assert!(expected[TIMES - 1][(0, 0)] > 3.0, "{}", expected[TIMES - 1]);
}
