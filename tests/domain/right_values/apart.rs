//! Truth and tracks that never come near each other.

use super::{judged, tracks_of, truth_of, warning};
use serde_json::json;

#[test]
fn metres_beside_kilometres_are_asked_about() {
    let truth =
        truth_of((0..5).map(|time| (f64::from(time), 1000.0 + 10.0 * f64::from(time), 2000.0)));
    let tracks = tracks_of((0..5).map(|time| (f64::from(time), 1.0 + 0.01 * f64::from(time), 2.0)));
    let outcome = judged(&truth, &tracks, json!({"comparison": {"gate_m": 10.0}}));
    // √(999² + 1998²).
    let told = "no track ever comes within the gate of a target: the least distance is 2233.8 m, the gate 10 m; are both in one unit and \
                in the same coordinates?";
    assert_eq!(warning(&outcome, "ever comes within"), told);
    // At a tenth of a metre more than the gate the same, and at the gate nothing.
    let beside = |offset_m: f64| {
        judged(
            &truth,
            &tracks_of((0..5).map(|time| {
                (
                    f64::from(time),
                    1000.0 + 10.0 * f64::from(time),
                    2000.0 + offset_m,
                )
            })),
            json!({"comparison": {"gate_m": 10.0}}),
        )
    };
    assert!(warning(&beside(10.1), "ever comes within").contains("the least distance is 10.1 m"));
    assert!(
        !beside(10.0)
            .warnings
            .iter()
            .any(|warning| warning.contains("ever comes within"))
    );
}

#[test]
fn clocks_apart_are_told_with_the_shift_that_would_bring_them_together() {
    // 20 m/s; the clock of the tracks is half a minute ahead, so that they are 600 m behind.
    let truth = truth_of((0..80).map(|time| (f64::from(time), 20.0 * f64::from(time), 5.0)));
    let tracks =
        tracks_of((0..80).map(|time| (30.0 + f64::from(time), 20.0 * f64::from(time), 5.5)));
    let outcome = judged(&truth, &tracks, json!({"comparison": {"gate_m": 10.0}}));
    let told = "no track ever comes within the gate of a target: the least distance is 600.0 m, the gate 10 m; with the times of the tracks \
                30.000 s earlier they would meet: do both have one clock?";
    assert_eq!(warning(&outcome, "ever comes within"), told);
}
