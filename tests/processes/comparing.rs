//! `trackloom compare` as a build server meets it: what is worse fails, what is the same passes.

use crate::process::trackloom;
use serde_json::{Value, json};
use std::path::Path;
use std::process::Output;

const STEPS: u32 = 40;

/// One target that moves along x and the track on it, with what else the tracks say.
fn write_scene(folder: &Path, name: &str, more: impl Fn(u32) -> Option<(&'static str, f64)>) {
    let mut truth = "time_s,truth_id,x_m,y_m\n".to_owned();
    let mut tracks = "time_s,track_id,x_m,y_m\n".to_owned();
    for step in 0..STEPS {
        let (time_s, x_m) = (f64::from(step), 20.0 * f64::from(step));
        truth += &format!("{time_s},A,{x_m},0\n");
        tracks += &format!("{time_s},T,{x_m},1\n");
        if let Some((id, y_m)) = more(step) {
            tracks += &format!("{time_s},{id},{x_m},{y_m}\n");
        }
    }
    std::fs::write(folder.join("truth.csv"), truth).unwrap();
    std::fs::write(folder.join(format!("{name}.csv")), tracks).unwrap();
}

/// Judges the tracks of this name; the result is in the directory of the same name.
fn judge(folder: &Path, name: &str, more: &Value) -> Output {
    let mut job = json!({
        "kind": "evaluate",
        "truth": {"source": "file", "path": "truth.csv"},
        "tracks": {"source": "file", "path": format!("{name}.csv")}
    });
    let more = more.as_object().unwrap().clone();
    job.as_object_mut().unwrap().extend(more);
    let path = folder.join("job.json");
    std::fs::write(&path, job.to_string()).unwrap();
    let mut command = trackloom();
    let output = command.arg("run").arg(&path).arg("--out");
    output.arg(folder.join(name)).output().unwrap()
}

/// The exit code of `compare --fail-if-worse`, and what it said.
fn compare(folder: &Path, baseline: &str, other: &str) -> (Option<i32>, String) {
    let sides = [folder.join(baseline), folder.join(other)];
    let mut command = trackloom();
    let output = command.arg("compare").args(sides).arg("--fail-if-worse");
    let output = output.output().unwrap();
    let said = [output.stdout, output.stderr].concat();
    (output.status.code(), String::from_utf8(said).unwrap())
}

#[test]
fn false_points_are_worse_under_every_metric_that_counts_them() {
    let folder = tempfile::tempdir().unwrap();
    write_scene(folder.path(), "good", |_| None);
    write_scene(folder.path(), "bad", |_| Some(("F", 900.0)));
    let alone = |metric: &str| json!({"metrics": [{"metric": metric}]});
    let mut settings = vec![json!({"profile": "vision"}), json!({"profile": "tracking"})];
    for metric in [
        "clear",
        "identity",
        "hota",
        "gospa",
        "t_gospa",
        "ospa",
        "labelled_ospa",
        "ospa2",
        "siap",
        "assignment",
    ] {
        settings.push(alone(metric));
    }
    for more in settings {
        for name in ["good", "bad"] {
            let output = judge(folder.path(), name, &more);
            assert_eq!(output.status.code(), Some(0), "{more}: {output:?}");
        }
        let (code, said) = compare(folder.path(), "good", "bad");
        assert_eq!(code, Some(1), "{more}: {said}");
        let (code, said) = compare(folder.path(), "good", "good");
        assert_eq!(code, Some(0), "{more}: {said}");
        let (code, said) = compare(folder.path(), "bad", "good");
        assert_eq!(code, Some(0), "{more}: {said}");
    }
}

#[test]
fn a_directory_holds_the_files_of_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("one");
    write_scene(folder.path(), "one", |_| None);
    judge(
        folder.path(),
        "one",
        &json!({"metrics": [{"metric": "clear"}]}),
    );
    let is_there = |name: &str| out.join(name).is_file();
    assert!(is_there("metric-series.csv") && is_there("automaton.json"));
    std::fs::write(out.join("mine.csv"), "kept").unwrap();

    // Another run without metrics: what the first wrote is gone, what is nobody's stays.
    let tfa = json!({"profile": "tfa"});
    let read = out.join("tracks.csv");
    std::fs::copy(folder.path().join("one.csv"), &read).unwrap();
    judge(folder.path(), "one", &tfa);
    assert!(is_there("mine.csv") && is_there("automaton.json") && is_there("tracks.csv"));
    assert!(!is_there("metric-series.csv") && !is_there("events.csv") && !is_there("metrics.txt"));

    // A file that no run of this directory listed is not taken for its own.
    std::fs::write(out.join("metric-series.csv"), "no table").unwrap();
    let (code, said) = compare(folder.path(), "one", "one");
    assert!(
        code == Some(2) && said.contains("nothing can be told apart"),
        "{said}"
    );

    // What an earlier run wrote here and this one reads stays.
    let scene = json!({"source": "preset", "preset": "liang2009-10"});
    let tracked = json!({"kind": "evaluate", "input": scene, "metrics": [{"metric": "clear"}]});
    let job = folder.path().join("tracked.json");
    std::fs::write(&job, tracked.to_string()).unwrap();
    let mut command = trackloom();
    let done = command.arg("run").arg(&job).arg("--out").arg(&out);
    assert_eq!(done.output().unwrap().status.code(), Some(0));
    let of = |name: &str| json!({"source": "file", "path": format!("one/{name}.csv")});
    let again = json!({"truth": of("truth"), "tracks": of("tracks")});
    assert_eq!(judge(folder.path(), "one", &again).status.code(), Some(0));
    assert!(is_there("truth.csv") && is_there("tracks.csv") && !is_there("scans.csv"));
}
