//! Jobs of kind `group`: accuracy, loops, files, and what is refused.

use serde_json::{Value, json};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{Input, JobKind, Outcome, RunError, plan, presets, run};
use trackloom_domain::formats;
use trackloom_domain::model::dataset::DatasetKind;
use trackloom_domain::model::fault::Fault;

/// The job that a preset's campaign runs.
fn base_of(name: &str) -> Value {
    let mut body = presets::find(name).unwrap().body["base"].take();
    body.as_object_mut().unwrap().remove("kind");
    body
}

fn preset(name: &str, change: &Value) -> Outcome {
    let mut body = base_of(name);
    for (name, value) in change.as_object().unwrap() {
        body[name] = value.clone();
    }
    run(
        &plan(JobKind::Group, &body).unwrap(),
        Vec::new(),
        &mut Silent,
    )
    .unwrap()
}

fn accuracy(name: &str, grouper: &Value) -> f64 {
    preset(name, &json!({"grouper": grouper})).result["grouping"]["accuracy"]
        .as_f64()
        .unwrap()
}

/// A job over detections of two sensors with σ 10 m.
fn of_csv(csv: &str, settings: &Value) -> Result<Outcome, Vec<Fault>> {
    let sensor = |name: &str| json!({"sensor_id": name, "sigma_x_m": 10.0, "sigma_y_m": 10.0});
    let names: &[&str] = if csv.contains(",B,") {
        &["A", "B"]
    } else {
        &["A"]
    };
    let mut body = json!({
        "input": {"source": "dataset", "dataset_id": "0"},
        "sensors": names.iter().map(|name| sensor(name)).collect::<Vec<_>>(),
        "grouper": {"method": "nearest_neighbour"}
    });
    for (name, value) in settings.as_object().unwrap() {
        body[name] = value.clone();
    }
    let plan = plan(JobKind::Group, &body)?;
    let options = formats::ReadOptions {
        kind: Some(DatasetKind::Detections),
        ..Default::default()
    };
    let dataset = (formats::format_named("csv").unwrap().read)(&mut csv.as_bytes(), &options)
        .unwrap()
        .dataset;
    let input = Input {
        dataset,
        sensors: Vec::new(),
        sha256: String::new(),
    };
    run(&plan, vec![Some(input)], &mut Silent).map_err(|error| match error {
        RunError::Faults(faults) => faults,
        RunError::Stopped => panic!("nobody stops it"),
    })
}

const HEADER: &str = "time_s,scan,sensor_id,detection_id,x_m,y_m,truth_id\n";

/// Targets 1 (both sensors) and 2 (sensor A alone), at rest, at three times.
fn two_targets() -> String {
    let mut csv = HEADER.to_owned();
    for scan in 0..3 {
        csv += &format!(
            "{scan},{scan},A,a{scan},0,0,1\n{scan},{scan},A,b{scan},500,0,2\n{scan},{scan},B,c{scan},5,5,1\n"
        );
    }
    csv
}

#[test]
fn a_gate_costs_the_nearest_neighbour_what_lies_outside_it() {
    // 0.989 of the reports are inside 3 σ: six are with 0.989⁶ = 0.935.
    let gated = json!({"method": "nearest_neighbour", "gate_sigmas": 3.0});
    let straight = accuracy("cai-fuzzy-cv-15", &gated);
    assert!((0.90..0.98).contains(&straight), "{straight}");
    assert_eq!(
        accuracy("cai-fuzzy-cv-15", &json!({"method": "nearest_neighbour"})),
        1.0
    );
    assert!(accuracy("cai-fuzzy-weave-15", &gated) < 0.9);
}

#[test]
fn fuzzy_c_means_from_predictions_is_right_on_straight_courses() {
    let outcome = preset("cai-fuzzy-cv-10", &json!({}));
    let grouping = &outcome.result["grouping"];
    assert!(grouping["accuracy"].as_f64().unwrap() > 0.99);
    // 29 of 30 instants: 10 targets with six reports, 15 with one.
    assert_eq!(grouping["counts"]["reports"], 29 * 75);
    assert_eq!(grouping["counts"]["duplicates"], 290);
    assert_eq!(grouping["search"]["unconverged"], 0);
    let groups = outcome
        .artifacts
        .iter()
        .find(|file| file.name == "groups.csv")
        .unwrap();
    let text = String::from_utf8(groups.bytes.clone()).unwrap();
    assert_eq!(text.lines().count(), 1 + 29 * 75);
    assert!(text.starts_with("time_s,group,sensor_id,detection_id,membership,truth_id\n2,"));
}

#[test]
fn every_contender_is_a_job() {
    for (name, change) in presets::cai_fuzzy::contenders()
        .into_iter()
        .filter(|contender| !contender.0.contains("genetic"))
    {
        let mut body = base_of("cai-fuzzy-weave-10");
        body["input"]["scenario"]["scans"] = json!(3);
        for (field, value) in change.as_object().unwrap() {
            body[field] = value.clone();
        }
        let result = run(
            &plan(JobKind::Group, &body).unwrap(),
            Vec::new(),
            &mut Silent,
        )
        .unwrap()
        .result;
        let accuracy = result["grouping"]["accuracy"].as_f64().unwrap();
        assert!((0.0..=1.0).contains(&accuracy), "{name}: {accuracy}");
    }
}

#[test]
fn an_uploaded_recording_is_grouped_with_and_without_truth() {
    let open = of_csv(&two_targets(), &json!({})).unwrap().result;
    assert_eq!(
        open["grouping"]["counts"],
        json!({"sensors": 2, "instants": 2, "reports": 6, "groups": 4, "duplicates": 2, "exact": 2})
    );
    assert_eq!(
        open["grouping"]["instants"][0],
        json!({"time_s": 1.0, "reports": 3, "groups": 2, "duplicates": 1, "exact": 1})
    );
    let closed = of_csv(
        &two_targets(),
        &json!({"predictions": {"start": "groups", "loop": "closed"}}),
    )
    .unwrap()
    .result;
    assert_eq!(closed["grouping"]["accuracy"], 1.0);
    let sequential = of_csv(
        &two_targets(),
        &json!({"grouper": {"method": "sequential_nearest_neighbour"}}),
    )
    .unwrap()
    .result;
    assert_eq!(
        sequential["grouping"]["counts"]["instants"], 3,
        "without predictions the first instant is grouped too"
    );
    // A wrong partition by hand: with a gate of 0.1 σ the two reports of target 1 fall apart.
    let split = json!({"grouper": {"method": "sequential_nearest_neighbour", "gate_sigmas": 0.1}});
    let grouping = &of_csv(&two_targets(), &split).unwrap().result["grouping"];
    assert_eq!(
        (
            &grouping["accuracy"],
            &grouping["precision"],
            &grouping["recall"]
        ),
        (&json!(0.0), &Value::Null, &json!(0.0))
    );
}

#[test]
fn what_cannot_be_grouped_is_named() {
    let faults = |csv: &str, settings: Value| -> Vec<(String, String)> {
        of_csv(csv, &settings)
            .unwrap_err()
            .into_iter()
            .map(|fault| (fault.pointer, fault.code))
            .collect()
    };
    let named = |pointer: &str, code: &str| (pointer.to_owned(), code.to_owned());
    let alone = format!("{HEADER}0,0,A,a,0,0,1\n1,1,A,b,0,0,1\n");
    assert_eq!(faults(&alone, json!({})), [named("/input", "unsupported")]);
    let apart = format!("{HEADER}0,0,A,a,0,0,1\n1,1,B,b,0,0,1\n");
    assert_eq!(faults(&apart, json!({})), [named("/input", "disjoint")]);
    let unknown = two_targets()
        .replace(",truth_id", "")
        .replace(",1\n", "\n")
        .replace(",2\n", "\n");
    assert_eq!(
        faults(&unknown, json!({})),
        [
            named("/predictions/start", "unsupported"),
            named("/predictions/loop", "unsupported")
        ]
    );
    let many = json!({"grouper": {"method": "fuzzy_c_means", "initial": {"from": "random", "clusters": {"by": "count", "count": 4}}}});
    assert_eq!(
        faults(&two_targets(), many),
        [named("/grouper/initial/clusters", "out_of_range")]
    );
    let sharp = json!({"grouper": {"method": "fuzzy_c_means", "fuzzifier": 1.0}});
    assert_eq!(
        faults(&two_targets(), sharp),
        [named("/grouper/fuzzifier", "out_of_range")]
    );
    let bearings = "time_s,scan,sensor_id,detection_id,bearing_deg\n0,0,A,a,1\n0,0,B,b,2\n1,1,A,c,1\n1,1,B,d,2\n";
    assert_eq!(
        faults(bearings, json!({})),
        [
            named("/input", "unsupported"),
            named("/input", "unsupported")
        ]
    );
}

#[test]
fn the_trace_has_costs_centres_and_memberships() {
    let body = json!({"grouper": {"method": "fuzzy_c_means", "trace": true}});
    let outcome = of_csv(&two_targets(), &body).unwrap();
    let file = outcome
        .artifacts
        .iter()
        .find(|file| file.name == "grouping_trace.csv")
        .unwrap();
    let text = String::from_utf8(file.bytes.clone()).unwrap();
    let first: Vec<&str> = text
        .lines()
        .skip(1)
        .take_while(|line| line.starts_with("1,0,"))
        .collect();
    let count = |quantity: &str| first.iter().filter(|line| line.contains(quantity)).count();
    assert_eq!(
        (count(",cost,"), count(",centre_"), count(",membership,")),
        (1, 4, 6)
    );
}
