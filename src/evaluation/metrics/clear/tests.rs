//! CLEAR MOT of scenes worked by hand.

use crate::evaluation::comparison::Comparison;
use crate::evaluation::tests::{
    GONE, Places, assert_quantities, compare, evaluate, line, main_scene, swap_scene,
};
use serde_json::json;

fn clear(comparisons: &[Comparison]) -> super::MetricReport {
    evaluate("clear", json!({}), comparisons)
}

#[test]
fn the_swap_scene_keeps_pairs_inside_the_gate() {
    // After the crossing both pairs are kept for one step (distances √37 and √36.25), then exchanged.
    let report = clear(&[swap_scene(10.0)]);
    let distance_m = (10.0 * 1.5 + 37f64.sqrt() + 36.25f64.sqrt()) / 22.0;
    let expected = [
        ("mota", Some(20.0 / 22.0)),
        ("motp_distance", Some(distance_m)),
        ("idsw", Some(2.0)),
        ("frag", Some(0.0)),
    ];
    assert_quantities(&report, &expected);
    assert!((report.quantity("motp_distance").unwrap() - 1.231_979_991_804_289_5).abs() < 1e-12);
    assert_quantities(
        &report,
        &[
            ("motp_similarity", Some(1.0 - distance_m / 20.0)),
            ("mt", Some(2.0)),
            ("moda", Some(1.0)),
        ],
    );
}

#[test]
fn the_main_scene_by_hand() {
    // 18 truth points. A: T1 at 0..5, T3 at 7..9 (a break, a switch); B: T2 at 3..9, at 7 with an error of 10.
    let report = clear(&[main_scene(10.0)]);
    let counts = [
        ("tp", Some(16.0)),
        ("fn", Some(2.0)),
        ("fp", Some(3.0)),
        ("idsw", Some(1.0)),
        ("frag", Some(1.0)),
    ];
    assert_quantities(&report, &counts);
    let ratios = [
        ("mota", Some(12.0 / 18.0)),
        ("motal", Some(13.0 / 18.0)),
        ("precision", Some(16.0 / 19.0)),
        ("f1", Some(16.0 / 18.5)),
    ];
    assert_quantities(&report, &ratios);
    assert_quantities(
        &report,
        &[
            ("motp_distance", Some(2.544_383_064_661_009_3)),
            ("fp_false_alarm", Some(3.0)),
            ("fp_per_step", Some(0.3)),
        ],
    );
    // Just below 10 m the error is a miss and a diverged track: the reference's mean of the other 15.
    let report = clear(&[main_scene(9.999)]);
    assert_quantities(
        &report,
        &[
            ("motp_distance", Some(2.047_341_935_638_409_7)),
            ("fp_divergence", Some(1.0)),
            ("fn", Some(3.0)),
        ],
    );
    assert_quantities(
        &report,
        &[
            ("mota", Some(1.0 - 8.0 / 18.0)),
            ("frag", Some(2.0)),
            ("frag_trackeval", Some(2.0)),
        ],
    );
}

#[test]
fn truths_and_tracks_have_lines() {
    let report = clear(&[main_scene(10.0)]);
    let truth = [
        ("steps", Some(10.0)),
        ("tp", Some(9.0)),
        ("fn", Some(1.0)),
        ("recall", Some(0.9)),
        ("idsw", Some(1.0)),
        ("frag", Some(1.0)),
        ("frag_trackeval", Some(1.0)),
        ("mt", Some(1.0)),
        ("pt", Some(0.0)),
        ("ml", Some(0.0)),
    ];
    assert_eq!(line(&report.per_truth, "A"), truth);
    assert_eq!(
        line(&report.per_track, "T4")[..4],
        [
            ("steps", Some(3.0)),
            ("tp", Some(0.0)),
            ("fp", Some(3.0)),
            ("precision", Some(0.0))
        ]
    );
    assert!(
        clear(&[main_scene(10.0), main_scene(10.0)])
            .per_truth
            .is_empty()
    );
}

#[test]
fn the_two_fragmentations_differ_where_nobody_is_tracked_and_where_a_truth_is_gone() {
    // One hole in the only track: a step without any track, which TrackEval does not see.
    let hole = [0.0, 0.0, GONE, 0.0, 0.0];
    let report = clear(&[compare(&[("A", &[0.0; 5])], &[("T", &hole)], 10.0)]);
    assert_quantities(
        &report,
        &[
            ("frag", Some(1.0)),
            ("frag_trackeval", Some(0.0)),
            ("mota", Some(0.8)),
            ("idsw", Some(0.0)),
        ],
    );
    // The truth is gone while another is tracked: no interruption, but TrackEval counts one.
    let other: Places = ("B", &[50.0; 5]);
    let report = clear(&[compare(
        &[("A", &hole), other],
        &[("T", &hole), ("U", &[50.0; 5])],
        10.0,
    )]);
    assert_quantities(
        &report,
        &[
            ("frag", Some(0.0)),
            ("frag_trackeval", Some(1.0)),
            ("mota", Some(1.0)),
        ],
    );
}

#[test]
fn eighty_percent_is_mostly_tracked_unless_asked_otherwise() {
    let scene = || {
        [compare(
            &[("A", &[0.0; 5]), ("B", &[50.0; 5])],
            &[
                ("T", &[0.0, 0.0, 0.0, 0.0, 30.0]),
                ("U", &[50.0, GONE, GONE, GONE, GONE]),
            ],
            10.0,
        )]
    };
    // A at 4 of 5 steps; B at 1 of 5, which is not below 20 %.
    let expected = [
        ("mt", Some(1.0)),
        ("pt", Some(1.0)),
        ("ml", Some(0.0)),
        ("mt_share", Some(0.5)),
    ];
    assert_quantities(&clear(&scene()), &expected);
    let report = evaluate("clear", json!({"mostly_tracked": "above"}), &scene());
    assert_quantities(
        &report,
        &[("mt", Some(0.0)), ("pt", Some(2.0)), ("ml", Some(0.0))],
    );
    assert_eq!(report.parameters["mostly_tracked"], "above");
}

#[test]
fn the_logarithm_of_switches() {
    // A and B exchange their tracks at steps 1 and 2: four switches; TP 6 of 6.
    let report = clear(&[compare(
        &[("A", &[0.0; 3]), ("B", &[50.0; 3])],
        &[("T", &[0.0, 50.0, 0.0]), ("U", &[50.0, 0.0, 50.0])],
        10.0,
    )]);
    assert_quantities(
        &report,
        &[
            ("idsw", Some(4.0)),
            ("mota", Some(2.0 / 6.0)),
            ("motal", Some((6.0 - 4f64.log10()) / 6.0)),
            ("smota", Some(2.0 / 6.0)),
        ],
    );
}

#[test]
fn edges() {
    let truth: [Places; 2] = [("A", &[0.0; 3]), ("B", &[50.0; 3])];
    let report = clear(&[compare(&truth, &[], 10.0)]);
    assert_quantities(
        &report,
        &[
            ("mota", Some(0.0)),
            ("recall", Some(0.0)),
            ("precision", None),
            ("motp_distance", None),
            ("ml", Some(2.0)),
        ],
    );
    assert_quantities(
        &report,
        &[
            ("ml_share", Some(1.0)),
            ("fn", Some(6.0)),
            ("f1", Some(0.0)),
            ("motp_similarity", None),
        ],
    );
    let report = clear(&[compare(&[], &truth, 10.0)]);
    assert_quantities(
        &report,
        &[
            ("mota", None),
            ("fp", Some(6.0)),
            ("recall", None),
            ("precision", Some(0.0)),
            ("ml_share", None),
        ],
    );
    assert_eq!(
        (report.value, report.reason),
        (None, Some("no truth at any step"))
    );
    let report = clear(&[compare(&[], &[], 10.0)]);
    assert_quantities(
        &report,
        &[
            ("mota", None),
            ("f1", None),
            ("precision", None),
            ("fp_per_step", None),
            ("tp", Some(0.0)),
        ],
    );
    assert_quantities(&clear(&[]), &[("mota", None), ("tp", Some(0.0))]);
}

#[test]
fn sequences_combine_from_counts() {
    // 12 of 18 and −3 with nothing to find: together (12 − 3) / 18, not the mean of the ratios.
    let alarms = compare(&[], &[("T", &[0.0; 3])], 10.0);
    let report = clear(&[main_scene(10.0), alarms]);
    assert_quantities(
        &report,
        &[
            ("mota", Some(9.0 / 18.0)),
            ("fp", Some(6.0)),
            // At three of the thirteen steps nothing is due.
            ("fp_per_step", Some(6.0 / 10.0)),
            ("mt", Some(2.0)),
        ],
    );
}

#[test]
fn numbers_over_time_add_up_to_the_totals() {
    for (metric, names) in [
        ("clear", &["tp", "fn", "fp", "idsw"][..]),
        ("identity", &["idtp", "idfn", "idfp"]),
        ("t_gospa", &["localisation", "missed", "false", "switches"]),
        ("assignment", &["swaps", "divergences"]),
    ] {
        for scene in [main_scene(10.0), swap_scene(10.0)] {
            let report = evaluate(metric, serde_json::json!({}), &[scene]);
            for name in names {
                let series = report.series.iter().find(|series| series.name == *name);
                let sum: f64 = series.unwrap().values.iter().flatten().sum();
                let total = report.quantity(name).unwrap();
                assert!(
                    (sum - total).abs() < 1e-9,
                    "{metric}.{name}: {sum}, {total}"
                );
            }
        }
    }
}
