//! Evaluation of files that trackloom did not make, through a whole job: bad input is refused with the field's name, what is
//! undefined is null with a reason, and no number is NaN.

use crate::origins::jobs::Texts;
use serde_json::{Value, json};
use trackloom_domain::experiment::Outcome;
use trackloom_domain::model::fault::Fault;

const TRUTH: &str = "time_s,truth_id,x_m,y_m\n0,A,0,0\n1,A,10,0\n2,A,20,0\n3,A,30,0\n";
const TRACKS: &str = "time_s,track_id,x_m,y_m\n0,T,0,1\n1,T,10,1\n2,T,20,1\n3,T,30,1\n";
const NO_TRUTH: &str = "time_s,truth_id,x_m,y_m\n";
const NO_TRACKS: &str = "time_s,track_id,x_m,y_m\n";
const METRICS: [&str; 9] = [
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
const OF_BOXES: [&str; 4] = ["hota", "clear", "identity", "assignment"];

fn metrics(names: &[&str]) -> Value {
    names.iter().map(|name| json!({"metric": name})).collect()
}

fn judge(
    format: &'static str,
    truth: &str,
    tracks: &str,
    settings: &Value,
) -> Result<Outcome, Vec<Fault>> {
    let mut texts = Texts::of(format);
    let mut body = json!({"truth": texts.dataset(truth), "tracks": texts.dataset(tracks)});
    body.as_object_mut()
        .unwrap()
        .extend(settings.as_object().unwrap().clone());
    texts.judge(&body)
}

/// All metrics of points within a gate of 10 m.
fn of_points(truth: &str, tracks: &str) -> Result<Outcome, Vec<Fault>> {
    judge(
        "csv",
        truth,
        tracks,
        &json!({"metrics": metrics(&METRICS), "comparison": {"gate_m": 10.0}}),
    )
}

fn of_boxes(truth: &str, tracks: &str) -> Result<Outcome, Vec<Fault>> {
    judge(
        "mot",
        truth,
        tracks,
        &json!({"metrics": metrics(&OF_BOXES)}),
    )
}

/// Every null has a reason, and no text has a number that is not finite.
fn assert_sound(outcome: &Outcome) {
    for (metric, report) in outcome.result["metrics"].as_object().unwrap() {
        for (name, quantity) in report["quantities"].as_object().unwrap() {
            assert_eq!(
                quantity["value"].is_null(),
                quantity["reason"].is_string(),
                "{metric}.{name}: {quantity}"
            );
        }
        assert_eq!(
            report["value"].is_null(),
            report["reason"].is_string(),
            "{metric}"
        );
    }
    for file in outcome
        .artifacts
        .iter()
        .filter(|file| file.media_type.starts_with("text"))
    {
        let text = String::from_utf8(file.bytes.clone()).unwrap();
        let is_strange = |cell: &str| cell.parse::<f64>().is_ok_and(|number| !number.is_finite());
        assert!(
            !text.split([',', '\n', ' ']).any(is_strange),
            "{}:\n{text}",
            file.name
        );
    }
}

fn quantity<'o>(outcome: &'o Outcome, name: &str) -> &'o Value {
    let (metric, name) = name.split_once('.').unwrap();
    let quantity = &outcome.result["metrics"][metric]["quantities"][name];
    assert!(!quantity.is_null(), "no {metric}.{name}");
    &quantity["value"]
}

#[track_caller]
fn assert_values(outcome: &Outcome, expected: &[(&str, Option<f64>)]) {
    for (name, value) in expected {
        let found = quantity(outcome, name).as_f64();
        let is_close = found
            .zip(*value)
            .is_some_and(|(found, value)| (found - value).abs() < 1e-9);
        assert!(
            is_close || found == *value,
            "{name} is {found:?}, not {value:?}"
        );
    }
}

#[track_caller]
fn assert_refused(found: Result<Outcome, Vec<Fault>>, pointer: &str, code: &str, says: &str) {
    let faults = found.expect_err(says);
    let is_it = |fault: &Fault| {
        fault.pointer == pointer
            && fault.code == code
            && (fault.detail.contains(says) || says.is_empty())
    };
    assert!(
        faults.iter().any(is_it),
        "{pointer} {code} {says} is not among {faults:#?}"
    );
}

#[track_caller]
fn assert_refused_at(found: Result<Outcome, Vec<Fault>>, code: &str, line: u64, column: &str) {
    let faults = found.expect_err(code);
    let is_it = |fault: &Fault| {
        fault.code == code && fault.line == Some(line) && fault.column.as_deref() == Some(column)
    };
    assert!(
        faults.iter().any(is_it),
        "{code} at line {line}, column {column} is not among {faults:#?}"
    );
}

#[test]
fn one_name_twice_at_a_time_is_refused_by_line() {
    assert_refused_at(
        of_points(&format!("{TRUTH}3,A,31,0\n"), TRACKS),
        "duplicate",
        6,
        "time_s",
    );
    assert_refused_at(
        of_points(TRUTH, &format!("{TRACKS}3,T,31,0\n")),
        "duplicate",
        6,
        "time_s",
    );
    let twice = format!("{}{}", one_box(1, 1, 0.0), one_box(1, 1, 5.0));
    assert_refused_at(of_boxes(&twice, &one_box(1, 1, 0.0)), "duplicate", 2, "id");
    assert_refused_at(of_boxes(&one_box(1, 1, 0.0), &twice), "duplicate", 2, "id");
}

#[test]
fn numbers_that_are_not_finite_are_refused_by_line_and_column() {
    for number in ["NaN", "inf", "-inf", "1e999"] {
        assert_refused_at(
            of_points(&format!("{TRUTH}4,A,{number},0\n"), TRACKS),
            "not_finite",
            6,
            "x_m",
        );
        assert_refused_at(
            of_points(TRUTH, &format!("{TRACKS}4,T,0,{number}\n")),
            "not_finite",
            6,
            "y_m",
        );
        assert_refused_at(
            of_points(TRUTH, &format!("{TRACKS}{number},T,0,0\n")),
            "not_finite",
            6,
            "time_s",
        );
        let boxes = format!("1,1,{number},0,10,10,1,-1,-1,-1\n");
        assert_refused_at(
            of_boxes(&boxes, &one_box(1, 1, 0.0)),
            "not_finite",
            1,
            "left",
        );
    }
}

fn one_box(frame: u32, object: u32, left: f64) -> String {
    format!("{frame},{object},{left},0,10,10,1,-1,-1,-1\n")
}

#[test]
fn boxes_without_a_size_are_refused_by_line_and_column() {
    for (size, column) in [
        ("0,10", "width"),
        ("-3,10", "width"),
        ("10,0", "height"),
        ("10,-1e-9", "height"),
    ] {
        let flat = format!("{}1,2,0,0,{size},1,-1,-1,-1\n", one_box(1, 1, 0.0));
        assert_refused_at(
            of_boxes(&flat, &one_box(1, 1, 0.0)),
            "out_of_range",
            2,
            column,
        );
        assert_refused_at(
            of_boxes(&one_box(1, 1, 0.0), &flat),
            "out_of_range",
            2,
            column,
        );
    }
}

#[test]
fn times_that_do_not_meet_are_refused_with_both_spans() {
    let moved = |by_s: f64| {
        let rows: String = (0..4)
            .map(|t| format!("{},T,{},1\n", by_s + f64::from(t), 10 * t))
            .collect();
        format!("{NO_TRACKS}{rows}")
    };
    let says = "(0 to 3 s) and of tracks (100 to 103 s) do not meet";
    assert_refused(of_points(TRUTH, &moved(100.0)), "/truth", "disjoint", says);
    assert_refused(
        of_points(TRUTH, &moved(1.7e9)),
        "/truth",
        "disjoint",
        "1700000003 s",
    );
    // Spans that overlap meet by interpolation, each point in the step that is nearest; the first is half a period early.
    let outcome = of_points(TRUTH, &moved(-0.5)).unwrap();
    assert_values(
        &outcome,
        &[
            ("clear.tp", Some(4.0)),
            ("clear.fp", Some(0.0)),
            ("clear.fn", Some(0.0)),
        ],
    );
    let head = json!({
        "steps": "the times of the truth", "period_s": 1.0, "step_count": 4, "due_steps": 4, "filled_steps": 0, "extra_steps": 0,
        "points_between_steps": 0, "credit": "at_the_time", "points_not_known_then": 0, "truth_points_left_out": 0, "track_points_left_out": 0, "alignment": "interpolate", "gate": 10.0, "gate_unit": "m"
    });
    assert_eq!(outcome.result["comparison"], head);
    assert_sound(&outcome);
}

#[test]
fn boxes_whose_frames_are_disjoint_are_refused() {
    let (truth, tracks) = (
        format!("{}{}", one_box(1, 1, 0.0), one_box(2, 1, 1.0)),
        format!("{}{}", one_box(7, 1, 0.0), one_box(9, 1, 1.0)),
    );
    let says = "the frames of truth (1 to 2) and of tracks (7 to 9) do not meet";
    assert_refused(of_boxes(&truth, &tracks), "/truth", "disjoint", says);
    let mut texts = Texts::of("mot");
    let mut sequence = |name: &str, tracks: &str| json!({"name": name, "truth": texts.dataset(&truth), "tracks": texts.dataset(tracks)});
    let body = json!({"profile": "vision", "sequences": [sequence("good", &truth), sequence("bad", &tracks)]});
    assert_refused(texts.judge(&body), "/sequences/1/truth", "disjoint", says);
    // Frames of tracks outside those of truth are all compared, with a warning.
    let outcome = of_boxes(
        &truth,
        &format!("{}{}", one_box(2, 1, 1.0), one_box(9, 1, 1.0)),
    )
    .unwrap();
    assert!(
        outcome
            .warnings
            .iter()
            .any(|warning| warning.contains("1 frames with tracks are outside")),
        "{:?}",
        outcome.warnings
    );
    assert_values(
        &outcome,
        &[
            ("clear.fp", Some(1.0)),
            ("clear.fn", Some(1.0)),
            ("clear.tp", Some(1.0)),
        ],
    );
}

#[test]
fn truth_without_tracks_has_numbers_where_they_are_defined() {
    let outcome = of_points(TRUTH, NO_TRACKS).unwrap();
    assert_sound(&outcome);
    let zero = [
        "clear.mota",
        "clear.recall",
        "identity.idf1",
        "identity.idr",
        "hota.hota",
        "hota.det_re",
        "siap.completeness",
    ];
    assert_values(&outcome, &zero.map(|name| (name, Some(0.0))));
    let null = [
        "clear.precision",
        "clear.motp_distance",
        "identity.idp",
        "hota.loc_a",
        "siap.position_accuracy",
        "siap.ambiguity",
    ];
    assert_values(&outcome, &null.map(|name| (name, None)));
    let missed = 100.0 / 2f64.sqrt();
    assert_values(
        &outcome,
        &[
            ("ospa.ospa", Some(100.0)),
            ("gospa.gospa", Some(missed)),
            ("clear.ml", Some(1.0)),
            ("clear.fn", Some(4.0)),
        ],
    );
    assert_values(
        &outcome,
        &[
            ("t_gospa.t_gospa", Some(2.0 * missed)),
            ("kinematics.position_rmse", None),
            ("assignment.tracks", Some(0.0)),
        ],
    );
    let boxes = of_boxes(&one_box(1, 1, 0.0), "").unwrap();
    assert_sound(&boxes);
    assert_values(
        &boxes,
        &[
            ("clear.mota", Some(0.0)),
            ("clear.ml_share", Some(1.0)),
            ("hota.loc_a", None),
            ("identity.idp", None),
        ],
    );
}

#[test]
fn tracks_without_truth_are_false_and_have_no_accuracy() {
    let outcome = of_points(NO_TRUTH, TRACKS).unwrap();
    assert_sound(&outcome);
    let null = [
        "clear.mota",
        "clear.recall",
        "identity.idr",
        "hota.det_re",
        "siap.completeness",
        "siap.velocity_accuracy",
    ];
    assert_values(&outcome, &null.map(|name| (name, None)));
    assert_values(
        &outcome,
        &[
            ("clear.fp", Some(4.0)),
            ("siap.spuriousness", Some(1.0)),
            ("ospa.ospa", None),
            ("hota.hota", Some(0.0)),
        ],
    );
    assert_eq!(outcome.result["events"]["counts"]["false_alarm"], 4);
    let boxes = of_boxes("", &one_box(1, 1, 0.0)).unwrap();
    assert_sound(&boxes);
    assert_values(
        &boxes,
        &[
            ("clear.mota", None),
            ("clear.fp", Some(1.0)),
            ("hota.hota", Some(0.0)),
        ],
    );
}

#[test]
fn nothing_at_all_is_null_with_reasons() {
    let outcome = of_points(NO_TRUTH, NO_TRACKS).unwrap();
    assert_sound(&outcome);
    for name in METRICS {
        assert!(outcome.result["metrics"][name]["value"].is_null(), "{name}");
    }
    let boxes = of_boxes("", "").unwrap();
    assert_sound(&boxes);
    assert!(
        OF_BOXES
            .iter()
            .all(|name| boxes.result["metrics"][name]["value"].is_null())
    );
    let mut texts = Texts::of("csv");
    let mut sequence = |name: &str| json!({"name": name, "truth": texts.dataset(NO_TRUTH), "tracks": texts.dataset(NO_TRACKS)});
    let body =
        json!({"sequences": [sequence("one"), sequence("two")], "metrics": metrics(&METRICS)});
    assert_sound(&texts.judge(&body).unwrap());
}

#[test]
fn at_the_gate_is_a_match_and_at_the_cutoff_is_a_miss_and_a_false_track() {
    let tracks = "time_s,track_id,x_m,y_m\n0,T,0,10\n";
    let truth = "time_s,truth_id,x_m,y_m\n0,A,0,0\n";
    let settings = json!({"metrics": [{"metric": "clear"}, {"metric": "gospa", "cutoff_m": 10.0}, {"metric": "siap", "confirm_steps": 1}],
        "comparison": {"gate_m": 10.0}});
    let outcome = judge("csv", truth, tracks, &settings).unwrap();
    assert_values(
        &outcome,
        &[
            ("clear.tp", Some(1.0)),
            ("clear.motp_similarity", Some(0.5)),
            ("siap.position_accuracy", Some(10.0)),
        ],
    );
    assert_values(
        &outcome,
        &[
            ("gospa.missed", Some(1.0)),
            ("gospa.false", Some(1.0)),
            ("gospa.gospa", Some(10.0)),
        ],
    );
}

#[test]
fn a_step_without_any_track_is_a_miss_and_only_one_of_the_fragmentations_sees_it() {
    let outcome = of_points(
        TRUTH,
        "time_s,track_id,x_m,y_m\n0,T,0,1\n1,T,10,1\n3,T,30,1\n",
    )
    .unwrap();
    assert_values(
        &outcome,
        &[
            ("clear.fn", Some(1.0)),
            ("clear.frag", Some(1.0)),
            ("clear.frag_trackeval", Some(0.0)),
            ("clear.idsw", Some(0.0)),
        ],
    );
}

#[test]
fn settings_that_make_no_sense_are_refused_by_field_all_at_once() {
    let cutoff = |value: Value| json!({"metrics": [{"metric": "gospa", "cutoff_m": value}]});
    let cases = [
        (cutoff(json!(0)), "/metrics/0/cutoff_m", "out_of_range"),
        (cutoff(json!(-5.0)), "/metrics/0/cutoff_m", "out_of_range"),
        (cutoff(json!("ten")), "/metrics/0/cutoff_m", "wrong_type"),
        (cutoff(json!(null)), "/metrics/0/cutoff_m", "wrong_type"),
        (
            json!({"metrics": [{"metric": "ospa", "cutoff_m": 0.0}]}),
            "/metrics/0/cutoff_m",
            "out_of_range",
        ),
        (
            json!({"metrics": [{"metric": "t_gospa", "cutoff_m": 0.0}]}),
            "/metrics/0/cutoff_m",
            "out_of_range",
        ),
        (
            json!({"metrics": [{"metric": "gospa", "p": 0.5}]}),
            "/metrics/0/p",
            "out_of_range",
        ),
        (
            json!({"metrics": [{"metric": "t_gospa", "switch_penalty_m": -1}]}),
            "/metrics/0/switch_penalty_m",
            "out_of_range",
        ),
        (
            json!({"metrics": [{"metric": "siap", "confirm_steps": 0}]}),
            "/metrics/0/confirm_steps",
            "out_of_range",
        ),
        (
            json!({"metrics": [{"metric": "assignment", "divergence_gate": 0}]}),
            "/metrics/0/divergence_gate",
            "out_of_range",
        ),
        (
            json!({"metrics": [{"metric": "kinematics", "confidence": 1.5}]}),
            "/metrics/0/confidence",
            "out_of_range",
        ),
        (
            json!({"metrics": [{"metric": "clear", "mostly_tracked": "often"}]}),
            "/metrics/0/mostly_tracked",
            "unknown_value",
        ),
        (
            json!({"metrics": [{"metric": "accuracy"}]}),
            "/metrics/0/metric",
            "unknown_value",
        ),
        (json!({"metrics": [{}]}), "/metrics/0/metric", "missing"),
        (json!({"metrics": "clear"}), "/metrics", "wrong_type"),
        (json!({"profile": "radar"}), "/profile", "unknown_value"),
        (json!({"profile": 3}), "/profile", "wrong_type"),
        (
            json!({"comparison": {"gate_m": 0}}),
            "/comparison/gate_m",
            "out_of_range",
        ),
        (
            json!({"comparison": {"gate_m": -1}}),
            "/comparison/gate_m",
            "out_of_range",
        ),
        (
            json!({"comparison": {"min_iou": 0}}),
            "/comparison/min_iou",
            "out_of_range",
        ),
        (
            json!({"comparison": {"min_iou": 1.5}}),
            "/comparison/min_iou",
            "out_of_range",
        ),
        (
            json!({"comparison": {"alignment": {"method": "guess"}}}),
            "/comparison/alignment/method",
            "unknown_value",
        ),
        (
            json!({"comparison": {"alignment": {"method": "nearest", "max_gap_s": -1}}}),
            "/comparison/alignment/max_gap_s",
            "out_of_range",
        ),
        (
            json!({"tfa": {"symbols": {"kind": "nearest_truth", "gate_m": 0}}}),
            "/tfa/symbols/gate_m",
            "out_of_range",
        ),
        (
            json!({"tfa": {"max_missed": 0}}),
            "/tfa/max_missed",
            "out_of_range",
        ),
        (json!({"gate": 5}), "/gate", "unknown_field"),
    ];
    for (settings, pointer, code) in &cases {
        assert_refused(judge("csv", TRUTH, TRACKS, settings), pointer, code, "");
    }
    let both = json!({"profile": "radar", "metrics": [{"metric": "gospa", "cutoff_m": 0, "p": 0}], "comparison": {"gate_m": 0}});
    let faults = judge("csv", TRUTH, TRACKS, &both).unwrap_err();
    let mut pointers: Vec<&str> = faults.iter().map(|fault| fault.pointer.as_str()).collect();
    pointers.sort_unstable();
    assert_eq!(
        pointers,
        [
            "/comparison/gate_m",
            "/metrics/0/cutoff_m",
            "/metrics/0/p",
            "/profile"
        ]
    );
}

#[test]
fn what_data_cannot_be_judged_by_is_refused() {
    let (boxes, tracks) = (one_box(1, 1, 0.0), one_box(1, 1, 1.0));
    let with = |settings: Value| judge("mot", &boxes, &tracks, &settings);
    assert_refused(
        with(json!({"metrics": [{"metric": "ospa"}]})),
        "/metrics",
        "unsupported",
        "not for boxes",
    );
    assert_refused(
        with(json!({"tfa": {"symbols": {"kind": "nearest_truth", "gate_m": 5}}})),
        "/tfa",
        "unsupported",
        "not boxes",
    );
    assert_refused(
        with(json!({"profile": "tfa"})),
        "/profile",
        "unsupported",
        "nothing would be judged",
    );
    let mut texts = Texts::of("csv");
    let mut sequence = |name: &str| json!({"name": name, "truth": texts.dataset(TRUTH), "tracks": texts.dataset(TRACKS)});
    let twice = json!({"sequences": [sequence("one"), sequence("one")]});
    assert_refused(texts.judge(&twice), "/sequences/1/name", "duplicate", "");
    assert_refused(
        texts.judge(&json!({"sequences": []})),
        "/sequences",
        "out_of_range",
        "0 entries",
    );
    let swapped = judge("csv", TRACKS, TRUTH, &json!({}));
    assert!(swapped.is_err(), "truth and tracks are exchanged");
}

#[test]
fn breaks_say_in_which_sequence_they_happened() {
    let broken = "time_s,track_id,x_m,y_m\n0,T,0,1\n1,T,10,1\n3,T,30,1\n";
    let mut texts = Texts::of("csv");
    let mut sequence = |name: &str, tracks: &str| json!({"name": name, "truth": texts.dataset(TRUTH), "tracks": texts.dataset(tracks)});
    let sequences = [
        sequence("whole", TRACKS),
        sequence("broken", broken),
        sequence("again", broken),
    ];
    let outcome = texts
        .judge(&json!({"sequences": sequences, "metrics": metrics(&["clear"])}))
        .unwrap();
    let breaks = outcome.result["events"]["breaks"].as_array().unwrap();
    let brief: Vec<[&Value; 3]> = breaks
        .iter()
        .map(|found| [&found["sequence"], &found["time_s"], &found["track_id"]])
        .collect();
    assert_eq!(
        brief,
        [
            [&json!("broken"), &json!(2.0), &json!("T")],
            [&json!("again"), &json!(2.0), &json!("T")]
        ]
    );
    let alone = of_points(TRUTH, broken).unwrap();
    assert!(
        alone.result["events"]["breaks"][0]
            .get("sequence")
            .is_none()
    );
}

/// Two targets side by side and tracks that switch, miss and are false now and then; times of the tracks as `moved` has them.
fn noisy(moved: impl Fn(u32) -> f64) -> Outcome {
    let (mut truth, mut tracks) = (NO_TRUTH.to_owned(), NO_TRACKS.to_owned());
    for t in 0..30 {
        for (target, y) in [("A", 0), ("B", 50)] {
            truth += &format!("{t},{target},{},{y}\n", 10 * t);
        }
        let time_s = f64::from(t) + moved(t);
        let (first, second) = if t < 15 { ("T", "U") } else { ("U", "T") };
        if t % 7 != 3 {
            tracks += &format!("{time_s},{first},{},1\n", 10 * t);
        }
        tracks += &format!("{time_s},{second},{},49\n", 10 * t);
        if t % 10 == 5 {
            tracks += &format!("{time_s},V,0,500\n");
        }
    }
    of_points(&truth, &tracks).unwrap()
}

#[test]
fn noise_of_clocks_changes_no_count() {
    let exact = noisy(|_| 0.0);
    assert_values(
        &exact,
        &[
            ("clear.fn", Some(4.0)),
            ("clear.fp", Some(3.0)),
            ("clear.idsw", Some(2.0)),
            ("clear.mota", Some(51.0 / 60.0)),
        ],
    );
    type Clock = fn(u32) -> f64;
    let clocks: [(&str, Clock); 5] = [
        ("rounding", |t| [1e-9, -1e-9, 3e-10][t as usize % 3]),
        ("a float's noise", |t| f64::from(t) * 1e-15),
        ("late", |_| 1e-3),
        ("early", |_| -1e-3),
        (
            "now late, now early",
            |t| if t % 2 == 0 { 1e-3 } else { -1e-3 },
        ),
    ];
    for (name, clock) in clocks {
        let outcome = noisy(clock);
        for metric in ["clear", "identity", "assignment"] {
            let counts = |outcome: &Outcome| {
                let quantities = outcome.result["metrics"][metric]["quantities"]
                    .as_object()
                    .unwrap()
                    .clone();
                quantities
                    .into_iter()
                    .filter(|(name, _)| !name.contains("motp") && name != "smota")
                    .collect::<Vec<_>>()
            };
            assert_eq!(counts(&outcome), counts(&exact), "{name}: {metric}");
        }
        let distance_m = quantity(&outcome, "clear.motp_distance").as_f64().unwrap();
        assert!(
            (distance_m - 1.0).abs() < 1e-3,
            "{name}: {distance_m} m, though targets move 1 cm in a millisecond"
        );
    }
}
