//! Jobs of all kinds whose numbers are made again.

use super::jobs::Texts;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use std::fmt::Write;
use trackloom_domain::experiment::{Outcome, presets};

const POINTS: [&str; 7] = [
    "siap",
    "clear",
    "identity",
    "hota",
    "assignment",
    "kinematics",
    "t_gospa",
];

/// Every metric of points, some of them twice.
fn all_metrics() -> Value {
    let mut metrics: Vec<Value> = POINTS.iter().map(|name| json!({"metric": name})).collect();
    metrics.extend([
        json!({"metric": "gospa"}),
        json!({"metric": "gospa", "p": 1.0, "cutoff_m": 10.0, "switch_penalty_m": 3.0}),
        json!({"metric": "ospa"}),
        json!({"metric": "labelled_ospa", "cutoff_m": 10.0}),
        json!({"metric": "ospa2", "window_steps": 3}),
        json!({"metric": "ospa", "p": 3.0, "cutoff_m": 5.0}),
        json!({"metric": "siap", "confirm_steps": 1, "end_steps": 1, "siap_compat": "stonesoup"}),
        json!({"metric": "assignment", "divergence_gate": 30.0}),
        json!({"metric": "clear", "mostly_tracked": "above"}),
        json!({"metric": "t_gospa", "p": 1.0, "cutoff_m": 10.0, "switch_penalty_m": 0.5}),
    ]);
    Value::Array(metrics)
}

pub fn two_targets() -> Outcome {
    let mut texts = Texts::of("csv");
    let truth = texts.dataset(include_str!("../../../examples/data/two-targets/truth.csv"));
    let tracks = texts.dataset(include_str!(
        "../../../examples/data/two-targets/tracks.csv"
    ));
    texts.judge(&json!({"truth": truth, "tracks": tracks, "comparison": {"gate_m": 10.0}, "metrics": all_metrics()})).unwrap()
}

/// Liang's scene with 30 targets, tracked by a tracker that tells covariances and NIS.
pub fn tracked() -> Outcome {
    let mut body = presets::find("liang2009-30").unwrap().body;
    body["comparison"] = json!({"gate_m": 200.0});
    body["metrics"] = all_metrics();
    Texts::of("csv").judge(&body).unwrap()
}

pub fn bearings() -> Outcome {
    let mut body = presets::find("wang-bat-2").unwrap().body["base"].take();
    body.as_object_mut().unwrap().shift_remove("kind");
    Texts::of("csv").judge(&body).unwrap()
}

/// Boxes in rows of a field, followed by tracks that now and then are late, change their names or see nothing.
pub fn boxes() -> Outcome {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut texts = Texts::of("mot");
    let mut sequence = |name: &str| {
        let (mut truth, mut tracks) = (String::new(), String::new());
        for object in 1..=6 {
            let mut track = object;
            for frame in 1..=25 {
                let x = 8.0 * f64::from(object) + 0.7 * f64::from(frame);
                writeln!(truth, "{frame},{object},{x},0,10,20,1,-1,-1,-1").unwrap();
                track += if rng.random_bool(0.08) { 6 } else { 0 };
                if rng.random_bool(0.85) {
                    let x = x + rng.random_range(-4.0..4.0);
                    writeln!(
                        tracks,
                        "{frame},{track},{x},{},10,20,1,-1,-1,-1",
                        rng.random_range(-3.0..3.0)
                    )
                    .unwrap();
                }
            }
        }
        json!({"name": name, "truth": texts.dataset(&truth), "tracks": texts.dataset(&tracks)})
    };
    let sequences = ["one", "two, quoted", "three"].map(&mut sequence);
    let metrics = ["hota", "clear", "identity", "assignment"].map(|name| json!({"metric": name}));
    texts
        .judge(&json!({"sequences": sequences, "metrics": metrics}))
        .unwrap()
}

const PLACES: &str = "time_s,track_id,x_m,y_m\n";
const WITH_COVARIANCE: &str = "time_s,track_id,x_m,y_m,vx_mps,vy_mps,p_xx,p_xy,p_xvx,p_xvy,p_yy,p_yvx,p_yvy,p_vxvx,p_vxvy,p_vyvy\n";

pub fn uneven_sequences() -> Outcome {
    let rows = |row: &dyn Fn(u32) -> String| (0..8).map(row).collect::<String>();
    let truth = format!(
        "time_s,truth_id,x_m,y_m,vx_mps,vy_mps\n{}",
        rows(&|t| format!("{t},A,{},0,10,0\n", 10 * t))
    );
    let plain = format!(
        "{PLACES}{}",
        rows(&|t| format!("{t},{},{},1\n", if t < 5 { "T" } else { "U" }, 10 * t + 1))
    );
    let full = format!(
        "{WITH_COVARIANCE}{}",
        rows(&|t| format!("{t},T,{},2,9,0,4,0,0,0,4,0,0,1,0,1\n", 10 * t))
    );
    let none = "time_s,truth_id,x_m,y_m\n";
    let mut texts = Texts::of("csv");
    let mut sequence = |name: &str, truth: &str, tracks: &str| json!({"name": name, "truth": texts.dataset(truth), "tracks": texts.dataset(tracks)});
    let sequences = [
        sequence("empty", none, &plain),
        sequence("plain", &truth, &plain),
        sequence("full", &truth, &full),
    ];
    texts.judge(&json!({"sequences": sequences, "comparison": {"gate_m": 10.0}, "metrics": all_metrics()})).unwrap()
}

/// A crowd in which everybody is near everybody.
pub fn entangled() -> Outcome {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let (mut truth, mut tracks) = ("time_s,truth_id,x_m,y_m\n".to_owned(), PLACES.to_owned());
    for time_s in 0..12 {
        for who in 0..10 {
            let mut place = || rng.random_range(0.0..60.0);
            writeln!(truth, "{time_s},A{who},{},{}", place(), place()).unwrap();
            writeln!(tracks, "{time_s},T{who},{},{}", place(), place()).unwrap();
        }
    }
    let metrics = [
        json!({"metric": "t_gospa", "cutoff_m": 100.0, "switch_penalty_m": 25.0}),
        json!({"metric": "gospa"}),
    ];
    let mut texts = Texts::of("csv");
    let body = json!({"truth": texts.dataset(&truth), "tracks": texts.dataset(&tracks), "metrics": metrics});
    texts.judge(&body).unwrap()
}
