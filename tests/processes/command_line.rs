//! The command line as a user meets it: what it prints, where, and with which exit code.

use crate::process::trackloom;
use serde_json::{Value, json};
use std::io::{BufRead, Write};
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn run(arguments: &[&str]) -> Output {
    trackloom().args(arguments).output().unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn the_version_names_features() {
    let printed = stdout(&run(&["--version"]));
    assert!(
        printed.starts_with(&format!("trackloom {}", env!("CARGO_PKG_VERSION"))),
        "{printed}"
    );
    assert!(printed.contains("(features: "), "{printed}");
}

#[test]
fn methods_and_presets_are_tables_for_people_and_json_for_programs() {
    let table = stdout(&run(&["methods"]));
    assert!(
        table
            .lines()
            .any(|line| line.starts_with("associator  jpda ")),
        "{table}"
    );
    let parameters = stdout(&run(&["methods", "jpda"]));
    assert!(
        parameters
            .lines()
            .any(|line| line.starts_with("marginals ")),
        "{parameters}"
    );
    let catalogue: Value = serde_json::from_slice(&run(&["methods", "--json"]).stdout).unwrap();
    let named: usize = catalogue["families"]
        .as_array()
        .unwrap()
        .iter()
        .map(|family| family["methods"].as_array().unwrap().len())
        .sum();
    // The header, an empty line, and the last line stand around the methods.
    assert_eq!(table.lines().count(), named + 3);

    let presets: Vec<Value> = serde_json::from_slice(&run(&["presets", "--json"]).stdout).unwrap();
    let table = stdout(&run(&["presets"]));
    for preset in &presets {
        let name = preset["name"].as_str().unwrap();
        assert!(
            table
                .lines()
                .any(|line| line.split_whitespace().next() == Some(name)),
            "{name} is not listed:\n{table}"
        );
    }
    // Every alias that is listed is a preset.
    for alias in ["liang2009", "liang2009-polar"] {
        assert!(
            table
                .lines()
                .any(|line| line.split_whitespace().next() == Some(alias)),
            "{table}"
        );
        assert_eq!(run(&["presets", alias]).status.code(), Some(0));
    }
    for arguments in [["methods", "jdpa"], ["presets", "liang"]] {
        let refused = run(&arguments);
        assert_eq!(refused.status.code(), Some(2));
        assert!(stderr(&refused).contains(&format!("'{}'", arguments[1])));
    }
}

#[test]
fn a_job_is_read_from_standard_input_and_its_paths_from_where_one_stands() {
    let folder = tempfile::tempdir().unwrap();
    let csv = "time_s,scan,sensor_id,detection_id,x_m,y_m\n0,0,r,a,0,0\n1,1,r,b,10,0\n2,2,r,c,20,0\n3,3,r,d,30,0\n";
    std::fs::write(folder.path().join("det.csv"), csv).unwrap();
    let job = json!({
        "kind": "associate", "input": {"source": "file", "path": "det.csv"},
        "sensors": [{"sensor_id": "r", "sigma_x_m": 1.0, "sigma_y_m": 1.0, "p_d": 0.9, "clutter_per_m2": 1e-6}]
    });
    let mut child = trackloom()
        .args(["run", "-"])
        .current_dir(folder.path())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child
        .stdin
        .take()
        .unwrap()
        .write_all(job.to_string().as_bytes())
        .unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let head = stdout(&output).lines().next().unwrap().to_owned();
    assert!(
        head.starts_with("associate, seed ") && head.contains(": det.csv; "),
        "{head}"
    );
}

#[test]
fn what_is_missing_is_told_together() {
    let folder = tempfile::tempdir().unwrap();
    let job = json!({
        "kind": "evaluate", "truth": {"source": "file", "path": "no-truth.csv"}, "tracks": {"source": "file", "path": "no-tracks.csv"},
        "profile": "nonsense"
    });
    let path = folder.path().join("job.json");
    std::fs::write(&path, job.to_string()).unwrap();
    let refused = run(&["run", path.to_str().unwrap()]);
    let said = stderr(&refused);
    assert_eq!(refused.status.code(), Some(2));
    for place in ["/profile", "/truth/path", "/tracks/path"] {
        assert!(said.contains(place), "{place} is not told:\n{said}");
    }
    let refused = run(&["run"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        stderr(&refused).contains("--preset"),
        "{}",
        stderr(&refused)
    );
    let refused = run(&["run", "--preset", "liang2009-10", "--runs", "3"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        stderr(&refused).contains("--runs is of campaigns"),
        "{}",
        stderr(&refused)
    );
}

#[test]
fn what_was_written_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("result");
    let output = run(&[
        "run",
        "--preset",
        "liang2009-10",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(0));
    let said = stderr(&output);
    let told = said
        .lines()
        .find_map(|line| line.strip_prefix("wrote "))
        .unwrap()
        .split(" into ")
        .next()
        .unwrap();
    let mut told: Vec<&str> = told.split(", ").collect();
    told.sort_unstable();
    let mut written: Vec<String> = files(&out);
    written.sort_unstable();
    assert_eq!(told, written);
}

fn files(folder: &Path) -> Vec<String> {
    std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect()
}

#[test]
fn a_port_that_is_taken_is_told_before_the_tour() {
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let data = tempfile::tempdir().unwrap();
    let address = taken.local_addr().unwrap().to_string();
    let output = trackloom()
        .args(["demo", "--listen", &address, "--data"])
        .arg(data.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("--listen"), "{}", stderr(&output));
    assert_eq!(stdout(&output), "");
}

/// Lines that a program prints, until one has this in it; what follows it there.
fn printed_after(child: &mut std::process::Child, start: &str) -> String {
    let lines = std::io::BufReader::new(child.stdout.take().unwrap()).lines();
    let mut rest = lines.filter_map(|line| Some(line.ok()?.split_once(start)?.1.to_owned()));
    rest.next().unwrap()
}

#[tokio::test(flavor = "multi_thread")]
async fn the_tour_ends_with_a_live_session_that_moves() {
    let data = tempfile::tempdir().unwrap();
    let mut child = trackloom()
        .args(["demo", "--listen", "127.0.0.1:0", "--data"])
        .arg(data.path())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let page = printed_after(&mut child, "as a live session: ");
    let (base, session) = page.split_once("/?view=session&session=").unwrap();
    let picture = async |after: u64| {
        let path = format!("{base}/v1/sessions/{session}/picture?after_scan={after}&wait=30");
        let answer = reqwest::get(path).await.unwrap();
        answer.json::<Value>().await.unwrap()
    };
    let first = picture(0).await;
    let after = first["last_scan"].as_u64().unwrap();
    let next = picture(after).await;
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(next["scans"][0]["number"], after + 1, "{next}");
    // The clock of the recording: the radar turns once in 1.7 s.
    let time_s = |picture: &Value| picture["processed_to_s"].as_f64().unwrap();
    let passed_s = time_s(&next) - time_s(&first);
    assert!((1.0..6.0).contains(&passed_s), "{passed_s}");
    assert!(
        next["scans"][0]["detections"].as_u64().unwrap() > 0,
        "{next}"
    );
}

/// The example for build servers on a job; its exit code, and where its verdicts are.
fn check(job: &Path, folder: &Path, name: &str) -> (Option<i32>, PathBuf) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let out = folder.join(name);
    let status = Command::new(root.join("examples/ci/check.sh"))
        .arg(job)
        .arg(folder.join("baseline"))
        .arg(&out)
        .env("TRACKLOOM", env!("CARGO_BIN_EXE_trackloom"))
        .output()
        .unwrap()
        .status;
    (status.code(), out)
}

/// Tests and failures of a JUnit file, as a parser of XML finds them.
fn junit(path: &Path) -> (usize, usize) {
    let text = std::fs::read_to_string(path).unwrap();
    let mut reader = quick_xml::Reader::from_str(&text);
    let (mut tests, mut failures, mut depth) = (0, 0, 0);
    loop {
        match reader.read_event().unwrap() {
            quick_xml::events::Event::Start(tag) => {
                depth += 1;
                tests += usize::from(tag.name().as_ref() == b"testcase");
            }
            quick_xml::events::Event::Empty(tag) => {
                failures += usize::from(tag.name().as_ref() == b"failure");
            }
            quick_xml::events::Event::End(_) => depth -= 1,
            quick_xml::events::Event::Eof => break,
            _ => {}
        }
    }
    assert_eq!(depth, 0, "{text}");
    (tests, failures)
}

#[test]
fn a_build_fails_on_a_tracker_that_was_made_worse_and_passes_on_the_same_one() {
    let folder = tempfile::tempdir().unwrap();
    let job = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/ci/job.json");
    // The first result becomes the baseline, the second is the same.
    for name in ["first", "same"] {
        let (code, out) = check(&job, folder.path(), name);
        assert_eq!(code, Some(0), "{name}");
        assert_eq!(junit(&out.join("limits.xml")), (3, 0));
        let (compared, worse) = junit(&out.join("compare.xml"));
        assert!(compared > 10 && worse == 0, "{worse} of {compared}");
    }
    let mut worse: Value = serde_json::from_slice(&std::fs::read(&job).unwrap()).unwrap();
    worse["associator"] = json!({"method": "nearest_neighbour"});
    worse["tracker"] = json!({"confirm_hits": 5, "confirm_window": 5, "max_missed": 1});
    let path = folder.path().join("worse.json");
    std::fs::write(&path, worse.to_string()).unwrap();
    let (code, out) = check(&path, folder.path(), "worse");
    assert_eq!(code, Some(1));
    assert_eq!(junit(&out.join("limits.xml")), (3, 2));
    let (_, failed) = junit(&out.join("compare.xml"));
    assert!(failed >= 5, "{failed}");
    let table = std::fs::read_to_string(out.join("limits.md")).unwrap();
    assert!(
        table.starts_with("### trackloom evaluate: 1 of 3 met"),
        "{table}"
    );
    assert!(
        table.contains("| **not met** | clear.recall | 0.53"),
        "{table}"
    );
}

#[test]
fn limits_that_nothing_can_meet_are_refused_and_results_that_are_none_too() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |limit: Value| {
        let path = folder.path().join("job.json");
        let scenario = json!({"source": "preset", "preset": "liang2009-10"});
        let job = json!({"kind": "evaluate", "input": scenario, "limits": [limit]});
        std::fs::write(&path, job.to_string()).unwrap();
        let output = run(&["run", path.to_str().unwrap()]);
        (output.status.code(), stderr(&output))
    };
    let (code, said) = refused(json!({"quantity": "clear.mota"}));
    assert_eq!(code, Some(2));
    assert!(
        said.contains("/limits/0: a limit needs 'at_most' or 'at_least'"),
        "{said}"
    );
    let (code, said) =
        refused(json!({"quantity": "clear.mota", "at_least": 0, "with": "interval"}));
    assert!(
        code == Some(2) && said.contains("/limits/0/with: one run has no interval"),
        "{said}"
    );
    // A name that no result has is a limit that is not met.
    let (code, said) = refused(json!({"quantity": "clear.moto", "at_least": 0}));
    assert_eq!(code, Some(1));
    assert!(said.contains("there is no such number"), "{said}");
    let none = run(&["compare", folder.path().to_str().unwrap(), "."]);
    assert_eq!(none.status.code(), Some(2));
    assert!(stderr(&none).contains("report.json"), "{}", stderr(&none));
}

/// `| head` closes the pipe early: that is no failure, and nothing panics.
#[test]
fn who_stops_reading_is_no_failure() {
    let folder = tempfile::tempdir().unwrap();
    let result = folder.path().join("result");
    let result = result.to_str().unwrap();
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/two-targets/");
    let job = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/judge-tracks.json");
    assert!(run(&["run", job, "--out", result]).status.success());
    for arguments in [
        vec!["methods"],
        vec!["presets", "--json"],
        vec!["openapi"],
        vec!["inspect", &format!("{data}tracks.csv")],
        vec!["run", job],
        vec!["compare", result, result],
        vec!["compare", result, result, "--format", "json"],
        vec![
            "demo",
            "--once",
            "--listen",
            "127.0.0.1:0",
            "--data",
            result,
        ],
    ] {
        let mut command = trackloom();
        command.args(&arguments);
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let told = stderr(&output);
        assert!(!told.contains("panicked"), "{arguments:?}: {told}");
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {told}");
    }
}
