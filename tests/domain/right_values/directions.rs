//! Directions judged by metrics that need no metres.

use super::{quantity, table};
use crate::origins::jobs::Texts;
use serde_json::json;

/// A target that turns over north, always detected half a degree to one side; from 30 to 39 the track is on another bearing.
#[test]
fn directions_are_matched_within_their_gate_the_shorter_way_round() {
    let bearing_deg =
        |step: u32, by_deg: f64| (355.0 + 0.2 * f64::from(step) + by_deg).rem_euclid(360.0);
    let truth = table(
        "time_s,truth_id,bearing_deg",
        (0..60).map(|step| format!("{},A,{}", 10 * step, bearing_deg(step, 0.0))),
    );
    let tracks = table(
        "time_s,track_id,bearing_deg,bearing_rate_degps,p_bb,p_bbr,p_brbr",
        (0..60).map(|step| {
            let by_deg = if (30..40).contains(&step) { 7.0 } else { 0.5 };
            format!("{},1,{},0,0.16,0,1", 10 * step, bearing_deg(step, by_deg))
        }),
    );
    let mut texts = Texts::of("csv");
    let body = json!({
        "truth": texts.dataset(&truth), "tracks": texts.dataset(&tracks), "comparison": {"gate_deg": 3.0}, "profile": "vision",
        "metrics": [
            {"metric": "clear"}, {"metric": "kinematics"}, {"metric": "identity"}, {"metric": "hota"}, {"metric": "gospa", "cutoff_deg": 3.0},
            {"metric": "ospa", "cutoff_deg": 3.0}, {"metric": "labelled_ospa", "cutoff_deg": 3.0}, {"metric": "ospa2", "cutoff_deg": 3.0}
        ]
    });
    let outcome = texts.judge(&body).unwrap();
    let clear = ["tp", "fn", "fp", "idsw"].map(|name| quantity(&outcome, "clear", name));
    assert_eq!(clear, [50.0, 10.0, 10.0, 0.0]);
    assert!((quantity(&outcome, "clear", "motp_distance") - 0.5).abs() < 1e-9);
    let unit = &outcome.result["metrics"]["clear"]["quantities"]["motp_distance"]["unit"];
    assert_eq!(unit, "deg");
    assert!((quantity(&outcome, "identity", "idf1") - 50.0 / 60.0).abs() < 1e-12);
    // At every alpha up to the similarity 1 - 0.5 / 6 = 0.917, so at 18 of 19, 50 of 70 are found and of one identity.
    let hota = 18.0 / 19.0 * (50.0f64 / 70.0);
    assert!((quantity(&outcome, "hota", "hota") - hota).abs() < 1e-9);
    assert_eq!(outcome.result["comparison"]["gate_unit"], "deg");
    // Half a degree at 50 steps, one missed and one false at ten.
    let mean_deg = (50.0 * 0.5 + 10.0 * 3.0) / 60.0;
    for metric in ["gospa", "ospa", "labelled_ospa"] {
        let found_deg = quantity(&outcome, metric, metric);
        assert!((found_deg - mean_deg).abs() < 1e-9, "{metric} {found_deg}");
        let unit = &outcome.result["metrics"][metric]["unit"];
        assert_eq!(unit, "deg", "{metric}");
    }
    // Half a degree clockwise, also where one side is at 359.9 and the other at 0.4.
    for quantity_name in ["bearing_rmse", "bearing_bias", "bearing_95"] {
        let found_deg = quantity(&outcome, "kinematics", quantity_name);
        assert!(
            (found_deg - 0.5).abs() < 1e-9,
            "{quantity_name} {found_deg}"
        );
    }
    assert_eq!(quantity(&outcome, "kinematics", "matches"), 50.0);
    // 0.5² / 0.16 at each; of 50 samples the mean is due between χ²(50, 0.025) / 50 and χ²(50, 0.975) / 50.
    for (name, expected) in [
        ("nees_bearing", 1.5625),
        ("nees_bearing_lower", 32.357_363_7 / 50.0),
        ("nees_bearing_upper", 71.420_195_2 / 50.0),
        ("nees_bearing_samples", 50.0),
    ] {
        let found = quantity(&outcome, "kinematics", name);
        assert!((found - expected).abs() < 1e-8, "{name} {found}");
    }
    let whole_deg = ((50.0f64 * 0.25 + 10.0 * 9.0) / 60.0).sqrt();
    let found_deg = quantity(&outcome, "ospa2", "ospa2_whole");
    assert!((found_deg - whole_deg).abs() < 1e-9, "{found_deg}");

    // The automaton of the default profile reads places: it is left out, and said so.
    let mut body = body;
    body.as_object_mut().unwrap().remove("profile");
    let outcome = texts.judge(&body).unwrap();
    assert_eq!(quantity(&outcome, "clear", "tp"), 50.0);
    super::warning(&outcome, "the automaton does not read directions");
    assert!(outcome.result.get("tfa").is_none());
    body.as_object_mut().unwrap().remove("metrics");
    body["profile"] = json!("tfa");
    let faults = texts.judge(&body).unwrap_err();
    assert_eq!(
        (faults[0].pointer.as_str(), faults[0].code.as_str()),
        ("/profile", "unsupported")
    );
}
