//! MOTChallenge text: values, what truth leaves out, and every fault with its line.

use super::*;
use serde_json::json;
use trackloom_domain::formats::{FormatOptions, write_mot};
use trackloom_domain::model::boxes::{BoxSet, ObjectBox};
use trackloom_domain::model::scan::Measurement;

fn read_as(kind: DatasetKind, text: &str) -> Result<ReadOutcome, Vec<Fault>> {
    read_with("mot", text, &of_kind(kind))
}

fn boxes(outcome: &ReadOutcome) -> &BoxSet {
    match &outcome.dataset {
        Dataset::TruthBoxes(set) | Dataset::TrackBoxes(set) => set,
        other => panic!("expected boxes, found {}", other.kind().name()),
    }
}

#[test]
fn rows_of_each_length_are_read() {
    let text = "\u{feff}2,10,1.5,2,3,4\r\n1,2.0,-1,0.5,7,8,0.9\n\n1,10,0,0,1,1,-1,-1,-1,-1\n";
    let outcome = read_as(DatasetKind::Tracks, text).expect("the text is sound");
    assert!(outcome.warnings.is_empty());
    let set = boxes(&outcome);
    assert_eq!(set.object_ids(), ["2", "10"]);
    let one = |frame, object, left_px, top_px, width_px, height_px, confidence| ObjectBox {
        frame,
        object,
        left_px,
        top_px,
        width_px,
        height_px,
        confidence,
    };
    let expected = [
        one(1, 0, -1.0, 0.5, 7.0, 8.0, 0.9),
        one(1, 1, 0.0, 0.0, 1.0, 1.0, -1.0),
        one(2, 1, 1.5, 2.0, 3.0, 4.0, 1.0),
    ];
    assert_eq!(set.boxes(), expected);
    let summary = outcome.dataset.summary();
    assert_eq!(
        (
            summary.kind,
            summary.scans,
            summary.rows,
            summary.objects,
            summary.start_s
        ),
        (DatasetKind::Tracks, 2, 3, 2, None)
    );
}

#[test]
fn truth_leaves_out_confidence_zero_and_other_classes() {
    // Nine values: the eighth is the class. Ten values have no class.
    let text = "1,1,0,0,5,5,1,1,0.8\n1,2,0,0,5,5,0,1,0.8\n1,3,0,0,5,5,1,8,0.8\n1,4,0,0,5,5,1,8,-1,-1\n1,2,9,9,5,5,0,1,1\n";
    let outcome = read_as(DatasetKind::Truth, text).expect("the text is sound");
    assert_eq!(boxes(&outcome).object_ids(), ["1", "4"]);
    let expected = [
        "2 lines of truth are left out (confidence 0 or another class): tracks on them are false",
        "1 lines of truth are left out (distractor): tracks on them are forgiven",
    ];
    assert_eq!(outcome.warnings, expected);
    let forgiving: Vec<bool> = boxes(&outcome)
        .others()
        .iter()
        .map(|other| other.forgives)
        .collect();
    assert_eq!(forgiving, [false, true, false]);
    let units = &outcome.units;
    assert_eq!(
        (units.total, units.used, units.ignored["distractor"]),
        (5, 2, 1)
    );
    // Tracks keep them all, but for the object twice in a frame.
    let faults = read_as(DatasetKind::Tracks, text).expect_err("object 2 is in frame 1 twice");
    assert_eq!(
        faults,
        [Fault::new(
            "/file",
            "duplicate",
            "object 2 is in frame 1 twice: also on line 2"
        )
        .at(5, "id")]
    );
}

#[test]
fn every_fault_is_found_at_once_with_its_line() {
    let text = "0,1,0,0,5,5\n1.5,1,0,0,5,5\n1,-1,0,0,5,5\n1,1,nan,x,,5\n1,1,0,0,-5,0\n1,1,0,0,5\n1,7,0,0,5,5\n1,7,1,1,5,5\n1,1,2,3,4,5,6,7,8,9,10\n";
    let faults = read_as(DatasetKind::Truth, text).expect_err("the text is faulty");
    let found: Vec<(u64, &str, &str)> = faults
        .iter()
        .map(|fault| {
            (
                fault.line.expect("a line"),
                fault.column.as_deref().unwrap_or("-"),
                fault.code.as_str(),
            )
        })
        .collect();
    let expected = [
        (1, "frame", "out_of_range"),
        (2, "frame", "malformed"),
        (3, "id", "out_of_range"),
        (4, "left", "not_finite"),
        (4, "top", "malformed"),
        (4, "width", "missing"),
        (5, "width", "out_of_range"),
        (5, "height", "out_of_range"),
        (6, "-", "malformed"),
        (8, "id", "duplicate"),
        (9, "-", "malformed"),
    ];
    assert_eq!(found, expected);
    assert_eq!(faults[0].allowed.as_deref(), Some("1 to 4294967295"));
    assert_eq!(
        faults[9].detail,
        "object 7 is in frame 1 twice: also on line 7"
    );
}

#[test]
fn bytes_that_are_no_text_are_a_fault_of_their_line() {
    let faults = read_with(
        "mot",
        b"1,1,0,0,5,5\n1,\xff,0,0,5,5\n",
        &of_kind(DatasetKind::Tracks),
    )
    .expect_err("not UTF-8");
    assert_eq!(
        faults,
        [Fault {
            line: Some(2),
            ..Fault::new("/file", "malformed", "the text is not UTF-8")
        }]
    );
}

#[test]
fn the_uploader_says_which_kind_it_is() {
    let missing = Fault::new(
        "/meta/kind",
        "missing",
        "files in the format 'mot' do not say what they hold",
    )
    .allowing("truth, tracks, detections");
    assert_eq!(
        read("mot", "1,1,0,0,5,5\n").expect_err("no kind"),
        [missing]
    );
    let faults = read_as(DatasetKind::BearingTime, "1,-1,0,0,5,5\n")
        .expect_err("boxes are no bearing-time record");
    assert_eq!(
        (faults[0].pointer.as_str(), faults[0].code.as_str()),
        ("/meta/kind", "unsupported")
    );
    let options = ReadOptions {
        columns: [("a".to_owned(), "b".to_owned())].into(),
        ..of_kind(DatasetKind::Truth)
    };
    assert_eq!(
        read_with("mot", "", &options).expect_err("no columns")[0].pointer,
        "/meta/columns"
    );
}

#[test]
fn no_rows_are_an_empty_dataset() {
    let outcome = read_as(DatasetKind::Tracks, "\n").expect("an empty file is sound");
    assert_eq!(
        outcome.warnings,
        ["there are no boxes: the dataset is empty"]
    );
    assert!(boxes(&outcome).boxes().is_empty());
}

#[test]
fn what_is_written_reads_back() {
    let text = "1,1,0.1,-2.5,3,4,1\n1,12,1e-7,0,5.25,6,0.5\n9,1,100,200,30,40,-1\n";
    let outcome = read_as(DatasetKind::Tracks, text).expect("the text is sound");
    let mut written = Vec::new();
    write_mot(boxes(&outcome), &mut written).expect("writing to memory does not fail");
    let again = read_with("mot", &written, &of_kind(DatasetKind::Tracks))
        .expect("what was written is sound");
    assert_eq!(again.dataset, outcome.dataset);
    assert!(written.starts_with(b"1,1,0.1,-2.5,3,4,1,-1,-1,-1\n1,12,1e-7,0,5.25,6,0.5,-1,-1,-1\n"));
}

/// As detectors write it: no identity, frames that may be missing, boxes from the left and top.
#[test]
fn what_a_detector_found_becomes_detections() {
    let text = "3,-1,10,20,4,6,0.5,-1,-1,-1\n1,-1,0,0,2,2,-0.25\n3,-1,100,0,10,10,0.9\n";
    let mut options = of_kind(DatasetKind::Detections);
    options.options = FormatOptions::from_iter([("frame_s".to_owned(), json!(0.04))]);
    let recording = recording(read_with("mot", text, &options).expect("the text is sound"));
    let found: Vec<_> = recording
        .scans
        .iter()
        .map(|scan| (scan.number, scan.time_s, scan.detections.len()))
        .collect();
    assert_eq!(found, [(1, 0.0, 1), (3, 0.08, 2)]);
    let places: Vec<_> = recording
        .detections()
        .map(|detection| (detection.measurement, detection.amplitude))
        .collect();
    let at = |x_m, y_m| Measurement::Position { x_m, y_m };
    let expected = [
        (at(1.0, -1.0), Some(-0.25)),
        (at(12.0, -23.0), Some(0.5)),
        (at(105.0, -5.0), Some(0.9)),
    ];
    assert_eq!(places, expected);
    assert_eq!(recording.detection_ids, ["1.1", "3.1", "3.2"]);
}
