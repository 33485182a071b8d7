//! Jobs with a third axis: numbers by hand in which it decides, and those of other programs.

use crate::origins::check_all;
use crate::origins::jobs::Texts;
use serde_json::{Value, json};
use trackloom_domain::evaluation::{
    EvaluationInput, SymbolRule, TfaSettings, evaluate_temporal_automaton,
};
use trackloom_domain::experiment::{JobKind, Outcome};
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::model::dataset::Dataset;
use trackloom_domain::model::fault::Fault;

/// A target that flies north and climbs.
const TRUTH: &str = "time_s,truth_id,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps\n\
                     0,A,0,0,100,0,10,1\n1,A,0,10,101,0,10,1\n2,A,0,20,102,0,10,1\n";
/// 3 m to the right, 4 m ahead and 12 m above: 13 m away. Velocities err by (1, 2, 2), which is 3 m/s.
const TRACKS: &str = "time_s,track_id,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps\n\
                      0,T,3,4,112,1,12,3\n1,T,3,14,113,1,12,3\n2,T,3,24,114,1,12,3\n";

fn judge(truth: &str, tracks: &str, gate_m: f64, metrics: &[Value]) -> Result<Outcome, Vec<Fault>> {
    let mut texts = Texts::of("csv");
    let body = json!({
        "truth": texts.dataset(truth),
        "tracks": texts.dataset(tracks),
        "metrics": metrics,
        "comparison": {"gate_m": gate_m},
    });
    texts.judge(&body)
}

fn all_metrics() -> Vec<Value> {
    let names = [
        "gospa",
        "ospa",
        "t_gospa",
        "siap",
        "clear",
        "identity",
        "hota",
        "assignment",
        "kinematics",
    ];
    let metric = |name| match name {
        "gospa" | "ospa" | "t_gospa" => json!({"metric": name, "cutoff_m": 20.0}),
        _ => json!({"metric": name}),
    };
    names.map(metric).to_vec()
}

#[track_caller]
fn assert_values(outcome: &Outcome, expected: &[(&str, f64)]) {
    for (name, value) in expected {
        let (metric, quantity) = name.split_once('.').unwrap();
        let found = &outcome.result["metrics"][metric]["quantities"][quantity]["value"];
        let found = found.as_f64().unwrap_or(f64::NAN);
        assert!(
            (found - value).abs() < 1e-9,
            "{name} is {found}, not {value}"
        );
    }
}

#[test]
fn thirteen_metres_are_five_in_the_plane_and_twelve_above_it() {
    let outcome = judge(TRUTH, TRACKS, 15.0, &all_metrics()).unwrap();
    assert_eq!(outcome.warnings, Vec::<String>::new());
    let expected = [
        ("gospa.gospa", 13.0),
        ("ospa.ospa", 13.0),
        ("siap.completeness", 1.0),
        ("siap.position_accuracy", 13.0),
        ("siap.velocity_accuracy", 3.0),
        ("clear.mota", 1.0),
        ("clear.motp_distance", 13.0),
        ("identity.idf1", 1.0),
        ("kinematics.position_rmse", 13.0),
        ("kinematics.position_95", 13.0),
        ("kinematics.velocity_rmse", 3.0),
        ("kinematics.along_rmse", 4.0),
        ("kinematics.across_bias", 3.0),
        ("kinematics.z_rmse", 12.0),
        ("kinematics.z_bias", 12.0),
    ];
    assert_values(&outcome, &expected);
    check_all(&outcome);
    // The gate lies between 5 m and 13 m: nothing is matched.
    let outcome = judge(TRUTH, TRACKS, 10.0, &all_metrics()).unwrap();
    let expected = [
        ("clear.mota", -1.0),
        ("clear.fn", 3.0),
        ("clear.fp", 3.0),
        ("identity.idf1", 0.0),
        ("siap.completeness", 0.0),
        ("kinematics.matches", 0.0),
    ];
    assert_values(&outcome, &expected);
}

#[test]
fn nees_is_of_three_and_of_six_numbers() {
    // P = diag(9, 16, 144, 1, 4, 4): each error is one standard deviation.
    let names = "p_xx,p_xy,p_xz,p_xvx,p_xvy,p_xvz,p_yy,p_yz,p_yvx,p_yvy,p_yvz,p_zz,p_zvx,p_zvy,p_zvz,p_vxvx,p_vxvy,p_vxvz,p_vyvy,p_vyvz,p_vzvz";
    let cells = "9,0,0,0,0,0,16,0,0,0,0,144,0,0,0,1,0,0,4,0,4";
    let tracks: Vec<String> = TRACKS
        .lines()
        .enumerate()
        .map(|(row, line)| format!("{line},{}\n", if row == 0 { names } else { cells }))
        .collect();
    let truth: String = TRUTH
        .lines()
        .take(2)
        .map(|line| format!("{line}\n"))
        .collect();
    let metrics = [json!({"metric": "kinematics"})];
    let outcome = judge(&truth, &tracks[..2].concat(), 15.0, &metrics).unwrap();
    // The bounds of one sample, by scipy.stats.chi2 1.17.
    let expected = [
        ("kinematics.nees_position", 3.0),
        ("kinematics.nees_state", 6.0),
        ("kinematics.nees_position_lower", 0.215_795_282_623_897_85),
        ("kinematics.nees_position_upper", 9.348_403_604_496_148),
        ("kinematics.nees_state_lower", 1.237_344_245_791_202_7),
        ("kinematics.nees_state_upper", 14.449_375_335_447_92),
    ];
    assert_values(&outcome, &expected);
    check_all(&judge(TRUTH, &tracks.concat(), 15.0, &metrics).unwrap());
}

/// Targets that cross in the plane, far apart in height. OSPA and GOSPA are Stone Soup's (1.9.1, p 2, cutoff 20 m), the counts and
/// the mean distance those of motmetrics (1.4.0, gate 12 m).
#[test]
fn a_crossing_is_judged_as_other_programs_judge_it() {
    let truth = "time_s,truth_id,x_m,y_m,z_m\n0,A,0,0,0\n0,B,40,0,30\n0,C,20,16,60\n1,A,10,4,3\n1,B,30,4,28\n1,C,20,13,48\n2,A,20,8,6\n\
                 2,B,20,8,26\n2,C,20,10,36\n3,A,30,12,9\n3,B,10,12,24\n3,C,20,7,24\n4,A,40,16,12\n4,B,0,16,22\n";
    let tracks = "time_s,track_id,x_m,y_m,z_m\n0,1,-2.1,0.4,-2.1\n0,2,40.8,1.0,23.0\n0,3,16.1,18.7,56.1\n1,1,7.9,8.0,2.5\n\
                  1,2,32.7,3.8,30.2\n1,3,17.2,14.1,53.9\n2,1,20.2,9.9,8.7\n2,3,16.5,12.1,37.5\n3,1,28.4,8.2,14.8\n3,2,9.8,13.8,30.1\n\
                  3,3,21.7,10.4,22.3\n3,4,25.0,20.0,-40.0\n4,1,42.4,15.6,19.0\n4,2,3.0,12.8,16.2\n";
    let outcome = judge(truth, tracks, 12.0, &all_metrics()).unwrap();
    let expected = [
        ("ospa.ospa", 8.267_665_548_012_301),
        ("gospa.gospa", 12.345_935_224_080_753),
        ("clear.mota", 0.857_142_857_142_857_2),
        ("clear.motp_distance", 5.453_272_450_689_871),
        ("clear.tp", 13.0),
        ("clear.fn", 1.0),
        ("clear.fp", 1.0),
        ("clear.idsw", 0.0),
        ("identity.idf1", 0.928_571_428_571_428_6),
    ];
    assert_values(&outcome, &expected);
    check_all(&outcome);
}

#[test]
fn truth_with_heights_and_tracks_without_are_compared_in_the_plane_with_a_warning() {
    let cut = |text: &str| -> String {
        let without = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            format!("{}\n", [0, 1, 2, 3, 5, 6].map(|cell| cells[cell]).join(","))
        };
        text.lines().map(without).collect()
    };
    for (truth, tracks, wanted) in [
        (
            TRUTH.to_owned(),
            cut(TRACKS),
            "the tracks are of the plane and the truth is of a volume (z_m): they are compared in the plane, without heights",
        ),
        (
            cut(TRUTH),
            TRACKS.to_owned(),
            "the truth is of the plane and the tracks are of a volume (z_m): they are compared in the plane, without heights",
        ),
    ] {
        let outcome = judge(&truth, &tracks, 10.0, &all_metrics()).unwrap();
        assert_eq!(outcome.warnings, [wanted]);
        assert_values(&outcome, &[("ospa.ospa", 5.0), ("clear.mota", 1.0)]);
        assert!(outcome.result["metrics"]["kinematics"]["quantities"]["z_bias"].is_null());
        let flat = judge(&cut(TRUTH), &cut(TRACKS), 10.0, &all_metrics()).unwrap();
        assert_eq!(outcome.result["metrics"], flat.result["metrics"]);
    }
    let none = "time_s,track_id,x_m,y_m\n";
    let outcome = judge(TRUTH, none, 10.0, &all_metrics()[..2]).unwrap();
    let says_plane = |warning: &String| warning.contains("in the plane");
    assert!(
        !outcome.warnings.iter().any(says_plane),
        "{:?}",
        outcome.warnings
    );
}

#[test]
fn sequences_of_a_volume_and_of_the_plane_make_no_number_together() {
    let mut texts = Texts::of("csv");
    let sequence = |texts: &mut Texts, name: &str, truth: &str, tracks: &str| json!({"name": name, "truth": texts.dataset(truth), "tracks": texts.dataset(tracks)});
    let flat = (
        "time_s,truth_id,x_m,y_m\n0,A,0,0\n",
        "time_s,track_id,x_m,y_m\n0,T,0,1\n",
    );
    let sequences = [
        sequence(&mut texts, "high", TRUTH, TRACKS),
        sequence(&mut texts, "flat", flat.0, flat.1),
    ];
    let body = json!({"sequences": sequences, "metrics": [{"metric": "clear"}]});
    let faults = texts.judge(&body).unwrap_err();
    assert_eq!(faults.len(), 1);
    assert_eq!(
        (faults[0].pointer.as_str(), faults[0].code.as_str()),
        ("/sequences/1", "conflict")
    );
    let both = [
        sequence(&mut texts, "one", TRUTH, TRACKS),
        sequence(&mut texts, "two", TRUTH, TRACKS),
    ];
    let metrics = [json!({"metric": "kinematics"}), json!({"metric": "gospa"})];
    let body = json!({"sequences": both, "metrics": metrics, "comparison": {"gate_m": 15.0}});
    let outcome = texts.judge(&body).unwrap();
    assert_values(
        &outcome,
        &[("kinematics.z_bias", 12.0), ("gospa.gospa", 13.0)],
    );
    check_all(&outcome);
}

fn read(text: &str) -> Dataset {
    let outcome =
        (format_named("csv").unwrap().read)(&mut text.as_bytes(), &ReadOptions::default());
    outcome.unwrap().dataset
}

/// A below B, one metre apart in the plane; each track is over the other target, at the height of its own.
#[test]
fn the_nearest_target_and_the_nearest_detection_are_those_of_the_same_height() {
    let rows = |of: fn(u32) -> String| (0..4).map(of).collect::<String>();
    let truth = rows(|t| format!("{t},A,0,0,0\n{t},B,1,0,100\n"));
    let tracks = rows(|t| format!("{t},1,1,0,0\n{t},2,0,0,100\n"));
    let seen = rows(|t| format!("{t},{t},r,a,0,0,0,A\n{t},{t},r,b,1,0,100,B\n"));
    let Dataset::Truth(truth) = read(&format!("time_s,truth_id,x_m,y_m,z_m\n{truth}")) else {
        panic!("not truth")
    };
    let Dataset::Tracks(tracks) = read(&format!("time_s,track_id,x_m,y_m,z_m\n{tracks}")) else {
        panic!("not tracks")
    };
    let header = "time_s,scan,sensor_id,detection_id,x_m,y_m,z_m,truth_id";
    let Dataset::Detections(recording) = read(&format!("{header}\n{seen}")) else {
        panic!("not detections")
    };
    let input = EvaluationInput {
        recording: Some(&recording),
        truth: Some(&truth),
        tracks: &tracks,
    };
    let rules = [
        SymbolRule::NearestTruth {
            gate_m: 5.0,
            max_gap_s: Some(5.0),
        },
        SymbolRule::NearestDetection { gate_m: 5.0 },
    ];
    for symbols in rules {
        let settings = TfaSettings {
            symbols,
            ..TfaSettings::PAPER
        };
        let report = evaluate_temporal_automaton(&input, &settings).unwrap();
        let matched: Vec<_> = report
            .output_tracks
            .iter()
            .map(|track| (track.track_id.as_str(), track.follows.as_deref()))
            .collect();
        assert_eq!(matched, [("1", Some("A")), ("2", Some("B"))], "{symbols:?}");
    }
}

#[test]
fn detections_with_heights_are_tracked_in_space_unless_asked_otherwise_and_written_with_them() {
    let row = |t: u32| format!("{t},{n},r,a,{x},0,{z}\n", n = t + 1, x = 10 * t, z = 50 + t);
    let rows: String = (0..8).map(row).collect();
    let mut texts = Texts::of("csv");
    let input = texts.dataset(&format!(
        "time_s,scan,sensor_id,detection_id,x_m,y_m,z_m\n{rows}"
    ));
    let sensor = json!({"sensor_id": "r", "sigma_x_m": 1.0, "sigma_y_m": 1.0, "p_d": 0.9, "clutter_per_m2": 1e-6});
    let body = json!({"input": input, "sensors": [sensor]});
    let outcome = texts.run(JobKind::Associate, &body).unwrap();
    let of_heights: Vec<_> = outcome
        .warnings
        .iter()
        .filter(|warning| warning.contains("z_m"))
        .collect();
    let wanted = "sensor 'r': the noise of its heights is not known; that of x and y, 1 m, is assumed: 'sigma_z_m' says it";
    assert_eq!(of_heights, [wanted]);
    let flat = json!({"input": input, "sensors": [sensor], "tracker": {"space": "plane"}});
    let flat = texts.run(JobKind::Associate, &flat).unwrap();
    assert!(!flat.warnings.iter().any(|warning| warning.contains("z_m")));
    let file = |outcome: &Outcome, name: &str| {
        let file = outcome
            .artifacts
            .iter()
            .find(|file| file.name == name)
            .unwrap();
        String::from_utf8(file.bytes.clone()).unwrap()
    };
    for outcome in [&outcome, &flat] {
        let detections = file(outcome, "detections.csv");
        assert_eq!(detections.lines().nth(2), Some("1,2,r,a,10,0,51"));
    }
    let beginning = "time_s,track_id,sensor_id,x_m,y_m,vx_mps";
    assert!(file(&flat, "tracks.csv").starts_with(beginning));
    let tracks = file(&outcome, "tracks.csv");
    assert!(tracks.starts_with("time_s,track_id,sensor_id,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,p_xx"));
    // It climbs with a metre a second.
    let last: Vec<f64> = tracks
        .lines()
        .last()
        .unwrap()
        .split(',')
        .map(|cell| cell.parse().unwrap_or(f64::NAN))
        .collect();
    assert!(
        (last[3] - 70.0).abs() < 1.0 && (last[5] - 57.0).abs() < 1.0,
        "{last:?}"
    );
    assert!(
        (last[6] - 10.0).abs() < 1.0 && (last[8] - 1.0).abs() < 0.5,
        "{last:?}"
    );
}

#[test]
fn tracks_begin_at_truth_of_a_volume_as_at_that_of_the_plane() {
    let row = |t: u32| format!("{t},{n},r,a,{x},0\n", n = t + 1, x = 10 * t);
    let rows: String = (0..6).map(row).collect();
    let detections = format!("time_s,scan,sensor_id,detection_id,x_m,y_m\n{rows}");
    let tracks_of = |truth: &str| {
        let mut texts = Texts::of("csv");
        let sensor = json!({"sensor_id": "r", "sigma_x_m": 1.0, "sigma_y_m": 1.0, "p_d": 0.9, "clutter_per_m2": 1e-6});
        let body = json!({
            "input": texts.dataset(&detections),
            "truth": texts.dataset(truth),
            "sensors": [sensor],
            "tracker": {"initiation": {"method": "truth", "speed_sigma_mps": 1.0}},
        });
        let outcome = texts.run(JobKind::Associate, &body).unwrap();
        let mut files = outcome.artifacts.into_iter();
        files.find(|file| file.name == "tracks.csv").unwrap().bytes
    };
    let high = "time_s,truth_id,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps\n0,A,0,0,900,10,0,-5\n5,A,50,0,875,10,0,-5\n";
    let flat = "time_s,truth_id,x_m,y_m,vx_mps,vy_mps\n0,A,0,0,10,0\n5,A,50,0,10,0\n";
    assert_eq!(tracks_of(high), tracks_of(flat));
}
