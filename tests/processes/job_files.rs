//! Job files on the command line.

use crate::process::trackloom;

#[test]
fn a_member_that_is_given_twice_is_bad_input() {
    let folder = tempfile::tempdir().unwrap();
    let job = folder.path().join("job.json");
    std::fs::write(
        &job,
        r#"{"kind": "simulate", "seed": 1, "scenario": {"scans": 1, "scans": 2}, "seed": 2}"#,
    )
    .unwrap();
    let output = trackloom().arg("run").arg(&job).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{said}");
    for (pointer, name) in [("/scenario/scans", "scans"), ("/seed", "seed")] {
        assert!(
            said.contains(pointer)
                && said.contains(&format!("the member '{name}' is given more than once")),
            "{said}"
        );
    }
}
