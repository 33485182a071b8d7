//! `trackloom inspect` and `convert` as a user meets them: what is told, and how it is said on the command line.

use crate::process::trackloom;
use std::path::{Path, PathBuf};
use std::process::Output;

fn run(arguments: &[&str]) -> Output {
    trackloom().args(arguments).output().unwrap()
}

fn told(output: &Output) -> String {
    let text = [output.stdout.as_slice(), output.stderr.as_slice()].concat();
    String::from_utf8(text).unwrap()
}

fn put(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn faults_name_the_options_of_the_command_line_and_the_documents() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |name: &str, text: &str, wanted: &str| {
        let path = put(folder.path(), name, text);
        let output = run(&["inspect", path.to_str().unwrap()]);
        let told = told(&output);
        assert_eq!(output.status.code(), Some(2), "{told}");
        assert!(told.contains(wanted), "{told}");
        assert!(told.contains("docs/formats.md"), "{told}");
        assert!(!told.contains("/meta/"), "{told}");
    };
    refused("gt.txt", "1,1,399,182,121,229,1,-1,-1,-1\n", "--kind: ");
    refused("a.avr", "*8D40621D58C382D690C8AC2863A7;\n", "have no times");
    refused(
        "b.avr",
        "@0000000000018D40621D58C382D690C8AC2863A7;\n",
        "--start: ",
    );
    let split = r#"{"columns":["time_s","x_m"],"index":[0],"data":[[0,1]]}"#;
    refused("split.json", split, "orient='split'");
}

#[test]
fn dates_survive_csv_and_times_are_rounded() {
    let folder = tempfile::tempdir().unwrap();
    let rows =
        "time,truth_id,x_m,y_m\n2016-01-12T13:02:11.218Z,a,1,2\n2016-01-12T13:02:12.9996Z,a,2,2\n";
    let source = put(folder.path(), "dates.csv", rows);
    let again = folder.path().join("again.csv");
    let (source, again) = (source.to_str().unwrap(), again.to_str().unwrap());
    let converted = run(&["convert", source, "--to", "csv", "--output", again]);
    assert!(converted.status.success(), "{}", told(&converted));
    for path in [source, again] {
        let told = told(&run(&["inspect", path]));
        let span = "2016-01-12T13:02:11.218Z to 2016-01-12T13:02:13.000Z (1.7816 s)";
        assert!(told.contains(span), "{path}: {told}");
    }
}

#[test]
fn what_was_seen_is_held_against_its_truth() {
    let folder = tempfile::tempdir().unwrap();
    let row = |step: u32, late_s: u32| format!("{},{step},{},7\n", step + late_s, 5 * step);
    let seen: String = (0..50).map(|step| row(step, 3600)).collect();
    let truth: String = (0..50)
        .map(|step| format!("{step},a,{},7\n", 5 * step))
        .collect();
    let seen = put(
        folder.path(),
        "seen.csv",
        format!("time_s,scan,x_m,y_m\n{seen}"),
    );
    let truth = put(
        folder.path(),
        "truth.csv",
        format!("time_s,truth_id,x_m,y_m\n{truth}"),
    );
    let (seen, truth) = (seen.to_str().unwrap(), truth.to_str().unwrap());
    let apart = told(&run(&["inspect", seen, "--truth", truth]));
    assert!(apart.contains("100 % does 1 hour earlier"), "{apart}");
    let offset = "clock_offset_s=-3600";
    let together = told(&run(&[
        "inspect", seen, "--truth", truth, "--option", offset,
    ]));
    assert!(!together.contains("suspicion"), "{together}");
}

/// Some of these make a decoder panic; the panic is told as a fault, and as nothing else.
#[cfg(feature = "parquet")]
#[test]
fn a_damaged_file_of_columns_leaves_no_trace_of_a_panic() {
    let folder = tempfile::tempdir().unwrap();
    let rows = "time_s,truth_id,x_m,y_m\n0,a,1,2\n1,a,2,2\n2,b,2,2\n";
    let source = put(folder.path(), "sound.csv", rows);
    let sound = folder.path().join("sound.arrow");
    let (source, sound) = (source.to_str().unwrap(), sound.to_str().unwrap());
    let converted = run(&["convert", source, "--to", "arrow", "--output", sound]);
    assert!(converted.status.success(), "{}", told(&converted));
    let bytes = std::fs::read(sound).unwrap();
    let mut refused = 0;
    for at in (8..bytes.len()).step_by(bytes.len() / 150) {
        let mut broken = bytes.clone();
        broken[at] ^= 0xff;
        let path = put(folder.path(), "broken.arrow", &broken);
        let output = run(&["inspect", path.to_str().unwrap()]);
        let told = told(&output);
        assert!(!told.contains("panicked"), "octet {at}: {told}");
        refused += u32::from(output.status.code() == Some(2));
    }
    assert!(refused > 10, "{refused}");
}
