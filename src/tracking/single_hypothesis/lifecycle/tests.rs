//! The life of tracks, scan by scan.

use super::super::confirmation::ScoreRule;
use super::*;

const LIFE: Lifecycle = Lifecycle {
    gate_probability: 0.99,
    initiation: Initiation::OnePoint,
    confirmation: Confirmation::MOfN,
    confirm_hits: 3,
    confirm_window: 4,
    max_missed: 3,
    max_missed_s: None,
    max_position_sigma_m: None,
    initial_speed_sigma_mps: 1.0,
    smoothing: None,
    merging: None,
};

fn statuses(lifecycle: &Lifecycle, detected: &str) -> String {
    let mut life = lifecycle.start(&Glance::first(0.0, 0));
    let mut seen = String::from(&life.status().name()[..1]);
    for (index, symbol) in detected.chars().enumerate().skip(1) {
        let glance = Glance {
            was_detected: symbol == '1',
            log_ratio: if symbol == '1' { 3.0 } else { -2.0 },
            ..Glance::first(index as f64, 0)
        };
        lifecycle.advance(&mut life, &glance);
        seen.push_str(if life.is_over() {
            "x"
        } else {
            &life.status().name()[..1]
        });
    }
    seen
}

#[test]
fn confirmation_counts_the_last_n_scans_and_deletion_counts_misses_in_a_row() {
    let lifecycle = LIFE;
    assert_eq!(statuses(&lifecycle, "111"), "ttc");
    assert_eq!(statuses(&lifecycle, "11001011"), "tttttttc");
    assert_eq!(statuses(&lifecycle, "1111001000"), "ttcccccccx");
    assert_eq!(statuses(&lifecycle, "1000"), "tttx");
    let at_once = Lifecycle {
        confirm_hits: 1,
        confirm_window: 1,
        ..lifecycle
    };
    assert_eq!(statuses(&at_once, "1001"), "cccc");
    let long = Lifecycle {
        confirm_hits: 2,
        confirm_window: 64,
        max_missed: 100,
        ..lifecycle
    };
    assert_eq!(
        statuses(&long, &format!("1{}1", "0".repeat(62))).pop(),
        Some('c')
    );
    assert_eq!(
        statuses(&long, &format!("1{}1", "0".repeat(63))).pop(),
        Some('t')
    );
}

/// Statuses after scans of several sensors: a letter a sensor, capital where it detects the track.
fn statuses_of(lifecycle: &Lifecycle, scans: &str) -> String {
    let glance = |(index, letter): (usize, char)| Glance {
        was_detected: letter.is_uppercase(),
        ..Glance::first(
            index as f64,
            letter.to_ascii_lowercase() as usize - 'a' as usize,
        )
    };
    let mut glances = scans.chars().enumerate().map(glance);
    let mut life = lifecycle.start(&glances.next().unwrap());
    let mut seen = String::from(&life.status().name()[..1]);
    for glance in glances {
        lifecycle.advance(&mut life, &glance);
        seen.push_str(match (life.is_over(), life.status()) {
            (true, _) => "x",
            (false, TrackStatus::Coasted) => "-",
            (false, status) => &status.name()[..1],
        });
    }
    seen
}

#[test]
fn a_sensor_that_never_detects_a_track_deletes_none() {
    // A detects, B never does; one real miss of A between two of B would be three.
    assert_eq!(statuses_of(&LIFE, "AbAbAbabAb"), "ttttc---c-");
    assert_eq!(statuses_of(&LIFE, "AbAbAbababab"), "ttttc-----xx");
    // A fast one neither, nor does it keep the track from being confirmed.
    assert_eq!(
        statuses_of(&LIFE, "AbbbbAbbbbAbbbbabbbbA"),
        "ttttttttttc---------c"
    );
    // Where B detects it too, its misses count as those of A.
    assert_eq!(statuses_of(&LIFE, "ABAbab"), "ttc--x");
}

#[test]
fn a_tentative_track_is_judged_by_all_sensors_that_find_targets() {
    // Three of the last four scans confirm: with the misses of B two of four are the most.
    let ends = |finds_targets: bool| {
        let mut life = LIFE.start(&Glance::first(0.0, 0));
        for scan in 1..8 {
            let glance = Glance {
                was_detected: scan % 2 == 0,
                finds_targets,
                ..Glance::first(f64::from(scan), scan as usize % 2)
            };
            LIFE.advance(&mut life, &glance);
        }
        life.is_confirmed()
    };
    assert_eq!([false, true].map(ends), [true, false]);
    // One that is confirmed is not.
    let mut life = LIFE.start(&Glance::first(0.0, 0));
    LIFE.advance(&mut life, &Glance::first(1.0, 0));
    LIFE.advance(&mut life, &Glance::first(2.0, 0));
    for scan in 3..9 {
        let missed = Glance {
            was_detected: false,
            finds_targets: true,
            ..Glance::first(f64::from(scan), 1)
        };
        LIFE.advance(&mut life, &missed);
    }
    assert!(!life.is_over());
}

#[test]
fn a_sensor_that_detects_a_track_no_more_is_forgotten() {
    // After three detections by B and three more, A has no say: b is a first real miss.
    assert_eq!(statuses_of(&LIFE, "AAABaBaBaBaBaBaba"), "ttcc-c-c-c-c-c---");
    // Before that it has: a, b and a are three.
    assert_eq!(statuses_of(&LIFE, "AAABaBaba"), "ttcc-c--x");
}

#[test]
fn a_miss_counts_as_much_as_the_sensor_sees() {
    let mut life = LIFE.start(&Glance::first(0.0, 0));
    let miss = |share: f64, time_s: f64| Glance {
        was_detected: false,
        share,
        ..Glance::first(time_s, 0)
    };
    // Thirty at a tenth are three; what is not seen counts nothing.
    for index in 0..29 {
        LIFE.advance(&mut life, &miss(0.1, f64::from(index)));
        assert!(!life.is_over(), "{index}");
    }
    LIFE.advance(&mut life, &miss(0.0, 29.0));
    assert!(!life.is_over());
    LIFE.advance(&mut life, &miss(0.1, 29.0));
    LIFE.advance(&mut life, &miss(0.1, 30.0));
    assert!(life.is_over());
    // 20 times three scans of nothing end it as well.
    let mut life = LIFE.start(&Glance::first(0.0, 0));
    for index in 1..=60 {
        assert!(!life.is_over());
        LIFE.advance(&mut life, &miss(0.0, f64::from(index)));
    }
    assert!(life.is_over());
}

#[test]
fn a_time_takes_the_place_of_scans() {
    let timed = Lifecycle {
        max_missed_s: Some(10.0),
        ..LIFE
    };
    // The last detection is at 2 s: at 12 s the track is there, at 13 s no more.
    assert_eq!(statuses(&timed, "11100000000000"), "ttcccccccccccx");
}

#[test]
fn a_score_confirms_drops_and_deletes() {
    // Each detection adds 3, each miss −2. ln(0.9 / 0.005) = 5.19, ln(0.1 / 0.995) = −2.30; the first one adds nothing.
    let rule = ScoreRule {
        false_track_probability: 0.005,
        missed_track_probability: 0.1,
        max_score_drop: 5.0,
    };
    let scored = Lifecycle {
        confirmation: Confirmation::Score(rule),
        max_missed: 10,
        ..LIFE
    };
    assert_eq!(statuses(&scored, "111"), "ttc");
    assert_eq!(statuses(&scored, "100"), "ttx");
    assert_eq!(statuses(&scored, "10100"), "ttttx", "−2, 1, −1, −3");
    assert_eq!(
        statuses(&scored, "1110010000"),
        "ttcccccxxx",
        "6, then 2, 5, 3, 1 and, 5 below the highest, the end"
    );
    let impatient = Lifecycle {
        max_missed: 2,
        ..scored
    };
    assert_eq!(
        statuses(&impatient, "11100"),
        "ttccx",
        "misses in a row end a track before its score does"
    );
}

#[test]
fn no_rule_ends_a_track_that_was_given() {
    let rule = ScoreRule {
        false_track_probability: 0.005,
        missed_track_probability: 0.1,
        max_score_drop: 5.0,
    };
    for lifecycle in [
        LIFE,
        Lifecycle {
            confirmation: Confirmation::Score(rule),
            ..LIFE
        },
    ] {
        let lifecycle = Lifecycle {
            max_position_sigma_m: Some(1.0),
            ..lifecycle
        };
        let mut life = TrackLifecycleState::permanent();
        assert_eq!(life.status(), TrackStatus::Confirmed);
        for time_s in 0..10 {
            let glance = Glance {
                was_detected: false,
                log_ratio: -2.0,
                ..Glance::first(f64::from(time_s), 0)
            };
            lifecycle.advance(&mut life, &glance);
            lifecycle.limit(&mut life, || {
                SMatrix::<f64, 4, 4>::from_diagonal_element(1e6)
            });
            assert_eq!(
                (life.is_over(), life.status()),
                (false, TrackStatus::Coasted)
            );
        }
    }
}

#[test]
fn an_uncertain_position_ends_a_track() {
    // [5 2; 2 2] has the eigenvalues 6 and 1.
    let mut covariance = SMatrix::<f64, 4, 4>::from_diagonal_element(1e6);
    (
        covariance[(0, 0)],
        covariance[(0, 1)],
        covariance[(1, 0)],
        covariance[(1, 1)],
    ) = (5.0, 2.0, 2.0, 2.0);
    assert!((largest_variance(&covariance) - 6.0).abs() < 1e-12);
    assert!((largest_variance(&SMatrix::<f64, 2, 2>::new(3.0, 1.0, 1.0, 9.0)) - 3.0).abs() < 1e-12);
    for (limit_m, is_over) in [(6.01f64.sqrt(), false), (5.99f64.sqrt(), true)] {
        let lifecycle = Lifecycle {
            max_position_sigma_m: Some(limit_m),
            ..LIFE
        };
        let mut life = lifecycle.start(&Glance::first(0.0, 0));
        lifecycle.limit(&mut life, || covariance);
        assert_eq!(life.is_over(), is_over);
    }
}
