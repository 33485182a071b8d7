//! Noise that is assumed wrongly is told from NIS and NEES.

use super::{judged, table, warning};
use serde_json::{Value, json};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{JobKind, Outcome, plan, run};

/// One target that is always seen with a noise of 5 m, tracked as if it were `assumed_m`.
fn tracked(assumed_m: f64, kind: JobKind) -> Outcome {
    let mut body = json!({
        "seed": 7,
        "input": {"source": "scenario", "scenario": {
            "scans": 400, "scan_period_s": 1.0,
            "sensors": [{"sensor_id": "r", "max_range_m": 50_000.0, "p_d": 1.0, "sigma_x_m": 5.0, "sigma_y_m": 5.0}],
            "targets": {"kind": "listed", "targets": [{"truth_id": "a", "x_m": 0.0, "y_m": 0.0, "vx_mps": 10.0}]}
        }},
        "sensors": [{"sensor_id": "r", "sigma_x_m": assumed_m, "sigma_y_m": assumed_m}],
        "associator": {"method": "global_nearest_neighbour"},
        "filter": {"method": "kalman", "process_noise_m2ps3": 1e-4},
        "tracker": {"gate_probability": 0.9999, "initial_speed_sigma_mps": 20.0}
    });
    if kind == JobKind::Evaluate {
        body["metrics"] = json!([{"metric": "kinematics"}]);
    }
    run(&plan(kind, &body).unwrap(), Vec::new(), &mut Silent).unwrap()
}

/// The factor behind "sigma × ".
fn factor(warning: &str) -> f64 {
    let (_, rest) = warning
        .split_once("sigma × ")
        .unwrap_or_else(|| panic!("{warning}"));
    rest.split(' ').next().unwrap().parse().unwrap()
}

#[test]
fn the_sigma_that_would_fit_is_named() {
    for (assumed_m, says) in [(15.0, "assumed too large"), (3.0, "assumed too small")] {
        let outcome = tracked(assumed_m, JobKind::Associate);
        let told = warning(&outcome, "mean NIS");
        assert!(
            told.contains(says) && told.contains("2.00 is due within the gate (1.80 to 2."),
            "{told}"
        );
        assert!(
            (factor(told) * assumed_m - 5.0).abs() < 0.7,
            "{assumed_m}: {told}"
        );
    }
    let fitting = tracked(5.0, JobKind::Associate);
    assert!(
        !fitting
            .warnings
            .iter()
            .any(|warning| warning.contains("NIS")),
        "{:?}",
        fitting.warnings
    );
}

#[test]
fn tracks_that_are_too_sure_or_too_unsure_are_told_by_their_nees() {
    let unsure = tracked(15.0, JobKind::Evaluate);
    let told = warning(&unsure, "mean NEES");
    assert!(
        told.starts_with("mean NEES of the state")
            && told.contains("4 is due")
            && told.contains("less sure"),
        "{told}"
    );
    // A third, but errors of a track go on for long, so that 400 of them are few.
    assert!((0.15..0.6).contains(&factor(told)), "{told}");
    // The NIS is told once.
    warning(&unsure, "mean NIS");
}

#[test]
fn uploaded_tracks_are_judged_by_the_nis_and_the_covariances_that_they_carry() {
    // Errors of ±3 m in x with a variance of 1: NEES 9 and NIS 8 at every point.
    let errors = |time: u32| if time.is_multiple_of(2) { 3.0 } else { -3.0 };
    let row = |time: u32| format!("{time},1,{},0,1,0,0,0,1,0,0,1,0,1,8", errors(time));
    let header =
        "time_s,track_id,x_m,y_m,p_xx,p_xy,p_xvx,p_xvy,p_yy,p_yvx,p_yvy,p_vxvx,p_vxvy,p_vyvy,nis";
    let truth = table(
        "time_s,truth_id,x_m,y_m",
        (0..50).map(|time| format!("{time},A,0,0")),
    );
    let metrics: Value =
        json!({"metrics": [{"metric": "kinematics"}], "comparison": {"gate_m": 10.0}});
    let outcome = judged(&truth, &table(header, (0..50).map(row)), metrics);
    // χ²(100) has the quantiles 74.22 and 129.56; √(9 / 2) = 2.12, √(8 / 2) = 2.
    let nees = "mean NEES of the position 9.00 over 50 matches, 2 is due (1.48 to 2.59 with 95 %): the tracks are surer than they are \
                right; covariances of sigma × 2.12 would fit";
    let nis = "mean NIS 8.00 over 50 matches, 2 is due (1.48 to 2.59 with 95 %): the noise was assumed too small; sigma × 2.00 would fit";
    assert_eq!(
        [warning(&outcome, "NEES"), warning(&outcome, "NIS")],
        [nees, nis]
    );
}
