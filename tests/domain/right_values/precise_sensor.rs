//! A sensor so precise that it sees how a straight course bends in range and bearing: every filter follows the target.

use super::{quantity, table, truth_of};
use crate::origins::jobs::Texts;
use serde_json::{Value, json};
use trackloom_domain::experiment::Outcome;

/// 60 m/s past a sensor at 8 km, seen once a second to a millimetre and a hundred-thousandth of a degree.
fn passing(filter: Value, has_rates: bool) -> Outcome {
    let place = |time: u32| (f64::from(time), -1500.0 + 60.0 * f64::from(time), 8000.0);
    let row = |time: u32| {
        let (time_s, x_m, y_m) = place(time);
        let (range_m, bearing_deg) = (
            x_m.hypot(y_m),
            x_m.atan2(y_m).to_degrees().rem_euclid(360.0),
        );
        let rate = if has_rates {
            format!(",{}", 60.0 * x_m / range_m)
        } else {
            String::new()
        };
        format!("{time_s},{time},r,a{time},{range_m},{bearing_deg}{rate}")
    };
    let header = if has_rates { ",range_rate_mps" } else { "" };
    let detections = table(
        &format!("time_s,scan,sensor_id,detection_id,range_m,bearing_deg{header}"),
        (0..30).map(row),
    );
    let mut sensor = json!({
        "sensor_id": "r", "p_d": 0.9, "clutter_per_m2": 1e-8, "sigma_range_m": 0.001, "sigma_bearing_deg": 1e-5, "x_m": 0.0, "y_m": 0.0
    });
    if has_rates {
        sensor["sigma_range_rate_mps"] = json!(0.001);
    }
    let mut texts = Texts::of("csv");
    let body = json!({
        "input": texts.dataset(&detections), "truth": texts.dataset(&truth_of((0..30).map(place))), "sensors": [sensor],
        "associator": {"method": "global_nearest_neighbour"}, "filter": filter, "tracker": {"initial_speed_sigma_mps": 60.0},
        "metrics": [{"metric": "clear"}, {"metric": "kinematics"}], "comparison": {"gate_m": 1.0, "credit": "afterwards"}
    });
    texts.judge(&body).unwrap()
}

fn filter(method: &str) -> Value {
    json!({"method": method, "process_noise_m2ps3": 0.0})
}

#[test]
fn every_filter_follows_a_target_that_it_sees_to_the_millimetre() {
    for method in ["extended", "unscented", "converted"] {
        let outcome = passing(filter(method), false);
        assert_eq!(
            outcome.result["association"]["counts"]["tracks"], 1,
            "{method}"
        );
        let counts = ["tp", "fn", "fp", "idsw"].map(|name| quantity(&outcome, "clear", name));
        // The first second point is where the curvature is not known yet.
        assert_eq!(counts[0] + counts[1], 30.0, "{method}");
        assert!(
            counts[0] >= 29.0 && counts[3] == 0.0,
            "{method}: {counts:?}"
        );
        assert!(
            quantity(&outcome, "kinematics", "position_rmse") < 0.1,
            "{method}"
        );
    }
}

#[test]
fn range_rates_as_precise_change_nothing() {
    for method in ["extended", "unscented"] {
        let outcome = passing(filter(method), true);
        assert_eq!(
            outcome.result["association"]["nis"]["dimensions"], 3,
            "{method}"
        );
        assert_eq!(
            outcome.result["association"]["counts"]["tracks"], 1,
            "{method}"
        );
        assert!(quantity(&outcome, "clear", "tp") >= 29.0, "{method}");
    }
}
