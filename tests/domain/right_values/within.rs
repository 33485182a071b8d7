//! Where, when and whom a job judges.

use super::{metrics, quantity, table};
use crate::origins::jobs::Texts;
use serde_json::{Value, json};
use trackloom_domain::experiment::Outcome;
use trackloom_domain::model::fault::Fault;

/// A goes east from the origin, 10 m a second for 20 s; B stands at (0, 500). Tracks on both, one far away, one at (50, 30).
fn judged(within: Value, more: Value) -> Result<Outcome, Vec<Fault>> {
    let rows = |id: &str, x_m: i32, y_m: i32, step_m: i32| -> Vec<String> {
        (0..20)
            .map(|time| format!("{time},{id},{},{y_m}", x_m + step_m * time))
            .collect()
    };
    let truth = table(
        "time_s,truth_id,x_m,y_m",
        [rows("A", 0, 0, 10), rows("B", 0, 500, 0)].concat(),
    );
    let tracks = [
        rows("a", 0, 1, 10),
        rows("b", 1, 500, 0),
        rows("far", 9000, 0, 0),
        rows("near", 50, 30, 0),
    ]
    .concat();
    let mut texts = Texts::of("csv");
    let mut body = json!({
        "truth": texts.dataset(&truth), "tracks": texts.dataset(&table("time_s,track_id,x_m,y_m", tracks)),
        "metrics": metrics(&["clear", "gospa"]), "comparison": {"gate_m": 10.0, "within": within}
    });
    body.as_object_mut()
        .unwrap()
        .extend(more.as_object().unwrap().clone());
    texts.judge(&body)
}

fn counts(outcome: &Outcome) -> [f64; 3] {
    ["tp", "fn", "fp"].map(|name| quantity(outcome, "clear", name))
}

#[test]
fn what_lies_outside_is_left_out_and_what_is_false_inside_counts() {
    // Without bounds: both are followed, and two tracks are false.
    assert_eq!(
        counts(&judged(json!({}), json!({})).unwrap()),
        [40.0, 0.0, 40.0]
    );
    // A circle of 100 m: A is in it to 100 m, at 10 s; the track at (50, 30) is false there, and the one on A leaves with A.
    let circle = json!({"areas": [{"kind": "sector", "range_max_m": 100.0}]});
    let outcome = judged(circle, json!({})).unwrap();
    assert_eq!(counts(&outcome), [11.0, 0.0, 20.0]);
    let head = &outcome.result["comparison"];
    assert_eq!(
        (
            &head["truth_points_left_out"],
            &head["track_points_left_out"]
        ),
        (&json!(29), &json!(49))
    );
    // A quarter of it, to the south-east, holds A alone, but for the place in the middle, which is to the north of itself.
    let quarter = json!({"areas": [{"kind": "sector", "range_max_m": 100.0, "from_deg": 89.0, "to_deg": 180.0}]});
    assert_eq!(
        counts(&judged(quarter, json!({})).unwrap()),
        [10.0, 0.0, 0.0]
    );
    // B alone from 5 to 9 s: the tracks far away and near A are false everywhere, the one on A is on somebody else.
    let whom = json!({"targets": ["B"], "from_s": 5.0, "to_s": 9.0});
    let outcome = judged(whom, json!({})).unwrap();
    assert_eq!(counts(&outcome), [5.0, 0.0, 10.0]);
    assert_eq!(outcome.result["tfa"]["counts"]["targets"], 1);
    assert_eq!(outcome.result["tfa"]["counts"]["correct"], 1);
    let corner = |x_m: f64, y_m: f64| json!({"x_m": x_m, "y_m": y_m});
    let square = json!([
        corner(-10.0, 490.0),
        corner(10.0, 490.0),
        corner(10.0, 510.0),
        corner(-10.0, 510.0)
    ]);
    let square = json!({"areas": [{"kind": "polygon", "corners": square}]});
    assert_eq!(
        counts(&judged(square, json!({})).unwrap()),
        [20.0, 0.0, 0.0]
    );
}

/// A stands at (0, 300), B at (0, 900), each with a track; a third track is at (200, 300), a fourth at (0, -300).
fn seen_by(sensor: &Value, sensor_id: &str) -> Result<Outcome, Vec<Fault>> {
    let rows = |id: &str, x_m: i32, y_m: i32| -> Vec<String> {
        (0..10)
            .map(|time| format!("{time},{id},{x_m},{y_m}"))
            .collect()
    };
    let detections = (0..10).map(|time| format!("{time},{time},r,d{time},0,300"));
    let truth = [rows("A", 0, 300), rows("B", 0, 900)].concat();
    let tracks = [
        rows("a", 0, 300),
        rows("b", 0, 900),
        rows("c", 200, 300),
        rows("d", 0, -300),
    ]
    .concat();
    let mut texts = Texts::of("csv");
    let coverage = json!({"areas": [{"kind": "coverage", "sensor_id": sensor_id}]});
    let body = json!({
        "truth": texts.dataset(&table("time_s,truth_id,x_m,y_m", truth)),
        "tracks": texts.dataset(&table("time_s,track_id,x_m,y_m", tracks)),
        "detections": texts.dataset(&table("time_s,scan,sensor_id,detection_id,x_m,y_m", detections)),
        "sensors": [sensor], "profile": "vision",
        "metrics": metrics(&["clear"]), "comparison": {"gate_m": 10.0, "within": coverage}
    });
    texts.judge(&body)
}

#[test]
fn a_sensor_s_coverage_is_its_field_of_view_or_its_range() {
    // Within 500 m of (0, 100) are A and all tracks but the one on B.
    let range = json!({"sensor_id": "r", "y_m": 100.0, "max_range_m": 500.0});
    let outcome = seen_by(&range, "r").unwrap();
    assert_eq!(counts(&outcome), [10.0, 0.0, 20.0]);
    // 45 degrees about north from there leave the tracks beside it and behind it out, too: atan(200 / 200) is 45.
    let view = json!({"sensor_id": "r", "y_m": 100.0, "field_of_view": {"range_to_m": 500.0, "bearing_from_deg": -44.0, "bearing_to_deg": 44.0}});
    let outcome = seen_by(&view, "r").unwrap();
    assert_eq!(counts(&outcome), [10.0, 0.0, 0.0]);
    let told = |sensor: Value, sensor_id: &str| {
        let fault = seen_by(&sensor, sensor_id).unwrap_err().remove(0);
        (fault.pointer, fault.code)
    };
    let pointer = "/comparison/within/areas/0/sensor_id";
    for (sensor_id, code) in [("r", "unsupported"), ("q", "unknown_value")] {
        let expected = (pointer.to_owned(), code.into());
        assert_eq!(told(json!({"sensor_id": "r"}), sensor_id), expected);
    }
}

#[test]
fn bounds_that_make_no_sense_are_told_together() {
    let pointers = |found: Result<Outcome, Vec<Fault>>| -> Vec<(String, String)> {
        found
            .unwrap_err()
            .into_iter()
            .map(|fault| (fault.pointer, fault.code))
            .collect()
    };
    let at = |place: &str, code: &str| (format!("/comparison/within{place}"), code.to_owned());
    let backwards = json!({
        "from_s": 9.0, "to_s": 5.0,
        "areas": [{"kind": "sector", "range_min_m": 9.0, "range_max_m": 1.0, "from_deg": 3.0}]
    });
    let expected = [
        at("/to_s", "out_of_range"),
        at("/areas/0/range_max_m", "out_of_range"),
        at("/areas/0", "missing"),
    ];
    assert_eq!(pointers(judged(backwards, json!({}))), expected);
    let heights = judged(json!({"height_min_m": 5.0, "height_max_m": 9.0}), json!({}));
    let in_the_plane = [
        at("/height_min_m", "unsupported"),
        at("/height_max_m", "unsupported"),
    ];
    assert_eq!(pointers(heights), in_the_plane);
    let unknown = judged(json!({"targets": ["A", "C"]}), json!({}));
    assert_eq!(pointers(unknown), [at("/targets/1", "unknown_value")]);
    let corners = json!([{"lat_deg": 0, "lon_deg": 0}, {"lat_deg": 1, "lon_deg": 0}, {"lat_deg": 0, "lon_deg": 1}]);
    let on_earth = judged(
        json!({"areas": [{"kind": "polygon_deg", "corners": corners}]}),
        json!({}),
    );
    assert_eq!(pointers(on_earth), [at("/areas/0", "unsupported")]);
    assert_eq!(
        pointers(judged(json!({"from_s": 900.0}), json!({}))),
        [at("", "empty")]
    );
    let symbols = json!({"tfa": {"symbols": {"kind": "detection_id"}}});
    let whole = judged(json!({"from_s": 1.0}), symbols);
    assert!(pointers(whole).contains(&("/tfa/symbols/kind".to_owned(), "conflict".to_owned())));
}

#[test]
fn a_polygon_of_latitudes_lies_where_the_data_lie() {
    // 0.001° of latitude is 110.9 m at 50° N; the track is on the target, which leaves the polygon to the north at 8 s.
    let row = |time: u32, id: &str| format!("{time},{id},{},10", 50.0 + 0.0001 * f64::from(time));
    let mut texts = Texts::of("csv");
    let truth = texts.dataset(&table(
        "time_s,truth_id,lat_deg,lon_deg",
        (0..20).map(|time| row(time, "A")),
    ));
    let tracks = texts.dataset(&table(
        "time_s,track_id,lat_deg,lon_deg",
        (0..20).map(|time| row(time, "1")),
    ));
    let corner = |lat_deg: f64, lon_deg: f64| json!({"lat_deg": lat_deg, "lon_deg": lon_deg});
    let corners = [
        corner(49.9, 9.9),
        corner(50.000_85, 9.9),
        corner(50.000_85, 10.1),
        corner(49.9, 10.1),
    ];
    let body = json!({
        "truth": truth, "tracks": tracks, "metrics": metrics(&["clear"]),
        "comparison": {"gate_m": 1.0, "within": {"areas": [{"kind": "polygon_deg", "corners": corners}]}}
    });
    assert_eq!(counts(&texts.judge(&body).unwrap()), [9.0, 0.0, 0.0]);
}
