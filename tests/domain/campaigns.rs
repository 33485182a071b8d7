//! Campaigns: their runs are the jobs, cells are compared on the same scenes, and what cannot be run is refused.

use serde_json::{Value, json};
use std::ops::ControlFlow;
use trackloom_domain::experiment::campaign::{Campaign, ChunkRequest, ChunkResult, Next};
use trackloom_domain::experiment::observer::{Observer, Silent, Step};
use trackloom_domain::experiment::{JobKind, Outcome, Plan, RunError, plan, presets, run};

fn base() -> Value {
    let mut base = json!({"kind": "evaluate", "input": {"source": "preset", "preset": "liang2009-10"}, "comparison": {"gate_m": 1000.0}});
    base["tracker"] = json!({"gate_probability": 0.999, "initial_speed_sigma_mps": 430.0});
    base
}

fn associators(names: &[&str]) -> Value {
    let variant = |name: &&str| json!({"name": name, "set": [{"path": "/associator", "value": {"method": name}}]});
    json!({"by": "variants", "name": "associator", "variants": names.iter().map(variant).collect::<Vec<_>>()})
}

fn campaign(changes: Value) -> Value {
    let mut body = json!({"base": base(), "grid": [associators(&["nearest_neighbour", "jpda"])], "runs": 3, "seed": 5});
    for (name, value) in changes.as_object().unwrap() {
        body[name] = value.clone();
    }
    body
}

fn outcome(body: &Value) -> Outcome {
    run(
        &plan(JobKind::Campaign, body).unwrap(),
        Vec::new(),
        &mut Silent,
    )
    .unwrap()
}

/// The faults of a campaign that is refused: pointer, code, what is allowed.
fn faults(changes: Value) -> Vec<(String, String, String)> {
    let faults = plan(JobKind::Campaign, &campaign(changes)).expect_err("it cannot be run");
    faults
        .into_iter()
        .map(|fault| {
            (
                fault.pointer,
                fault.code,
                fault.allowed.unwrap_or_default().into(),
            )
        })
        .collect()
}

fn single(method: &str, number: u32) -> Value {
    let mut body = base();
    body.as_object_mut().unwrap().remove("kind");
    body["associator"] = json!({"method": method});
    body["seed"] = json!(5);
    let job = plan(JobKind::Evaluate, &body).unwrap();
    run(&Plan { run: number, ..job }, Vec::new(), &mut Silent)
        .unwrap()
        .result
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn the_runs_are_the_jobs_and_the_differences_theirs() {
    let found = outcome(&campaign(json!({"outcomes": [
        {"path": "tfa.probability.correct", "name": "correct"}, {"path": "metrics.gospa.quantities.gospa"}
    ]})));
    let gospa = |method| -> Vec<f64> {
        let value = |number| {
            single(method, number)["metrics"]["gospa"]["quantities"]["gospa"]["value"]
                .as_f64()
                .unwrap()
        };
        (0..3).map(value).collect()
    };
    let (nearest, jpda) = (gospa("nearest_neighbour"), gospa("jpda"));
    let cells = &found.result["cells"];
    assert_eq!(cells[0]["name"], "nearest_neighbour");
    let name = "metrics.gospa.quantities.gospa";
    assert_eq!(
        cells[0]["outcomes"][name]["mean"].as_f64(),
        Some(mean(&nearest))
    );
    assert_eq!(
        cells[1]["outcomes"][name]["mean"].as_f64(),
        Some(mean(&jpda))
    );
    let differences: Vec<f64> = jpda
        .iter()
        .zip(&nearest)
        .map(|(jpda, nearest)| jpda - nearest)
        .collect();
    assert_eq!(
        cells[1]["differences"][name]["mean"].as_f64(),
        Some(mean(&differences))
    );
    assert_eq!(
        (&cells[0]["differences"], &cells[1]["compared_with"]),
        (&json!({}), &json!("nearest_neighbour"))
    );
    assert_eq!(
        (&cells[1]["parameters"], &cells[1]["runs"]),
        (&json!({"associator": "jpda"}), &json!(3))
    );
    // The runs are different scenes.
    assert_ne!(nearest[0], nearest[1]);

    let text = |name: &str| {
        String::from_utf8(
            found
                .artifacts
                .iter()
                .find(|file| file.name == name)
                .unwrap()
                .bytes
                .clone(),
        )
        .unwrap()
    };
    let runs = text("runs.csv");
    assert_eq!(
        runs.lines().next(),
        Some("cell,run,seed,correct,metrics.gospa.quantities.gospa")
    );
    assert_eq!(runs.lines().count(), 1 + 2 * 3);
    assert!(
        runs.lines()
            .nth(1)
            .unwrap()
            .starts_with("nearest_neighbour,0,5,")
            && runs.contains(&nearest[0].to_string())
    );
    assert_eq!(text("cells.csv").lines().count(), 1 + 2 * 2);
    // Two cells below a head, then a difference below a head.
    assert_eq!(text("cells.md").lines().count(), 2 + 2 + 1 + 2 + 1);
    let last = text("cells.md").lines().last().unwrap().to_owned();
    assert!(
        last.starts_with("| jpda − nearest_neighbour | ") && last.contains(" to "),
        "{last}"
    );
}

#[test]
fn the_same_campaign_gives_the_same_bytes_and_a_method_does_not_differ_from_itself() {
    let twins = json!({"by": "variants", "name": "twins", "variants": [{"name": "a", "set": []}, {"name": "b", "set": []}]});
    let body = campaign(json!({"grid": [twins], "runs": 2}));
    let (first, second) = (outcome(&body).result, outcome(&body).result);
    assert_eq!(first.to_string(), second.to_string());
    let differences = first["cells"][1]["differences"].as_object().unwrap();
    assert!(
        differences.len() > 20,
        "every number is kept when none is asked for"
    );
    assert!(
        differences
            .values()
            .all(|difference| difference["mean"].is_null() || difference["mean"] == 0.0)
    );
}

#[test]
fn cells_are_the_product_of_the_axes_and_a_condition_chooses_runs() {
    let densities = json!({"by": "values", "name": "P_D", "path": "/input/scenario/sensors/0/p_d", "values": [0.5, 1.0]});
    let keeping = |quantity: &str| format!("metrics.track_keeping.quantities.{quantity}");
    let mut base = presets::find("wang-bat-2").unwrap().body["base"].take();
    base["input"]["scenario"]["scans"] = json!(10);
    let found = outcome(&json!({
        "base": base, "runs": 4, "grid": [densities, associators(&["nearest_neighbour", "bat"])],
        "outcomes": [
            {"name": "identity", "path": keeping("identity"), "interval": "wilson"},
            {"name": "kept", "path": keeping("mean_absolute_error"), "where": keeping("identity"), "interval": "bootstrap"},
            {"name": "gap", "path": "association.diagnostics.optimum.mean_gap"}
        ]
    }));
    let names: Vec<&str> = found.result["cells"]
        .as_array()
        .unwrap()
        .iter()
        .map(|cell| cell["name"].as_str().unwrap())
        .collect();
    assert_eq!(
        names,
        [
            "0.5, nearest_neighbour",
            "0.5, bat",
            "1.0, nearest_neighbour",
            "1.0, bat"
        ]
    );
    let outcomes = &found.result["cells"][2]["outcomes"];
    // Ten scans long before the crossing nothing can go wrong; 4 of 4 at 95 %: z² = 3.8415, low = 4 / (4 + z²).
    assert_eq!(
        (&outcomes["identity"]["mean"], &outcomes["kept"]["count"]),
        (&json!(1.0), &json!(4))
    );
    assert!(
        (outcomes["identity"]["interval"]["low"].as_f64().unwrap() - 4.0 / 7.8415).abs() < 1e-4
    );
    assert_eq!(
        (&outcomes["gap"]["count"], &outcomes["gap"]["missing"]),
        (&json!(0), &json!(4)),
        "it has no such number"
    );
    assert_eq!(
        found.result["cells"][3]["compared_with"],
        "1.0, nearest_neighbour"
    );
}

#[test]
fn a_cell_ends_at_a_half_width_and_says_so() {
    // The cells differ in how much their runs vary: every target is detected in each scan, or half of the time.
    let axis = json!({"by": "values", "name": "P_D", "path": "/input/scenario/sensors/0/p_d", "values": [0.5, 1.0]});
    let body = |changes: Value| {
        let mut body = campaign(json!({
            "base": small_base(), "grid": [axis], "runs": 45, "timed_runs": 0, "outcomes": [{"name": "n", "path": "tfa.counts.correct"}]
        }));
        body.as_object_mut()
            .unwrap()
            .extend(changes.as_object().unwrap().clone());
        body
    };
    let all = outcome(&body(json!({})));
    let cell = |found: &Outcome, index: usize| found.result["cells"][index].clone();
    assert_eq!(
        (&cell(&all, 0)["runs"], &cell(&all, 0)["ended"]),
        (&json!(45), &json!("runs"))
    );
    // What the first so many runs of each cell say by themselves.
    let half_width = |runs: u32, index: usize| {
        let interval =
            cell(&outcome(&body(json!({"runs": runs}))), index)["outcomes"]["n"]["interval"].take();
        (interval["high"].as_f64().unwrap() - interval["low"].as_f64().unwrap()) / 2.0
    };
    let (ten, twenty) = (
        [half_width(10, 0), half_width(10, 1)],
        [half_width(20, 0), half_width(20, 1)],
    );
    // One cell is narrow enough after ten runs, the other, if ever, later.
    let wide = usize::from(ten[1] > ten[0]);
    let found = outcome(&body(
        json!({"stop_at": {"outcome": "n", "half_width": (ten[0] + ten[1]) / 2.0}}),
    ));
    let narrow = cell(&found, 1 - wide);
    assert_eq!(
        (
            &narrow["runs"],
            &narrow["ended"],
            &narrow["outcomes"]["n"]["count"]
        ),
        (&json!(10), &json!("half_width"), &json!(10))
    );
    let expected = if twenty[wide] <= (ten[0] + ten[1]) / 2.0 {
        20
    } else {
        40
    };
    assert_eq!(
        (&cell(&found, wide)["runs"], &cell(&found, wide)["ended"]),
        (&json!(expected), &json!("half_width"))
    );
    // Its numbers are those of the campaign that has only so many runs, and differences are of the runs that both have.
    let alone = cell(&outcome(&body(json!({"runs": 10}))), 1 - wide);
    assert_eq!(narrow["outcomes"], alone["outcomes"]);
    assert_eq!(cell(&found, 1)["differences"]["n"]["pairs"], 10);
    let runs = found
        .artifacts
        .iter()
        .find(|file| file.name == "runs.csv")
        .unwrap();
    assert_eq!(
        String::from_utf8_lossy(&runs.bytes).lines().count(),
        1 + 10 + expected
    );
    // A half-width out of reach changes nothing but that it is asked for.
    let never = outcome(&body(
        json!({"stop_at": {"outcome": "n", "half_width": 1e-9}}),
    ));
    assert_eq!(never.result, all.result);
}

/// Runs of some hundred microseconds.
fn small_base() -> Value {
    let mut base = presets::find("liang2009-table1").unwrap().body["base"].take();
    base["input"]["scenario"]["scans"] = json!(8);
    base
}

#[test]
fn what_ends_a_cell_is_one_of_its_outcomes() {
    let outcomes =
        json!([{"path": "tfa.counts.correct", "name": "n"}, {"path": "tfa.counts.missed"}]);
    let stop =
        |outcome: &str, half_width: f64| json!({"outcome": outcome, "half_width": half_width});
    fault_is(
        json!({"outcomes": outcomes, "stop_at": stop("m", 1.0)}),
        "/stop_at/outcome",
        "unknown_value",
        "n, tfa.counts.missed",
    );
    fault_is(
        json!({"stop_at": stop("n", 1.0)}),
        "/stop_at/outcome",
        "unknown_value",
        "an outcome listed in 'outcomes'",
    );
    fault_is(
        json!({"outcomes": outcomes, "stop_at": stop("n", 0.0)}),
        "/stop_at/half_width",
        "out_of_range",
        &format!("(0, {}]", 1e300),
    );
}

/// Has a clock that ticks a millisecond a look, and stops after some calls.
struct Watch {
    looks: std::cell::Cell<u32>,
    calls: u32,
    last: u32,
}

impl Observer for Watch {
    fn progress(&mut self, step: Step, _: u64, total: u64) -> ControlFlow<()> {
        assert!(step == Step::Run && total == 6);
        self.calls += 1;
        if self.calls > self.last {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    fn now(&self) -> Option<std::time::Duration> {
        self.looks.set(self.looks.get() + 1);
        Some(std::time::Duration::from_millis(u64::from(
            self.looks.get(),
        )))
    }
}

#[test]
fn deciding_is_timed_by_the_observers_clock_and_a_campaign_can_be_stopped() {
    let job = plan(JobKind::Campaign, &campaign(json!({"timed_runs": 2}))).unwrap();
    let mut watch = Watch {
        looks: std::cell::Cell::new(0),
        calls: 0,
        last: u32::MAX,
    };
    let found = run(&job, Vec::new(), &mut watch).unwrap();
    // Two looks a timed run, a millisecond apart, for 30 scans.
    let times: Vec<(&str, f64, Option<f64>, u32)> = found
        .cell_times
        .iter()
        .map(|time| {
            (
                &*time.cell,
                time.decide_us_per_scan,
                time.ratio,
                time.timed_runs,
            )
        })
        .collect();
    assert_eq!(
        times,
        [
            ("nearest_neighbour", 1000.0 / 30.0, Some(1.0), 2),
            ("jpda", 1000.0 / 30.0, Some(1.0), 2)
        ]
    );
    // Two for each of four timed runs, one at the start, one after each of six runs.
    assert_eq!(watch.looks.get(), 8 + 1 + 6);
    let mut stopped = Watch {
        looks: std::cell::Cell::new(0),
        calls: 0,
        last: 40,
    };
    assert_eq!(
        run(&job, Vec::new(), &mut stopped).unwrap_err(),
        RunError::Stopped
    );
}

fn values(path: &str, values: Value) -> Value {
    json!([{"by": "values", "path": path, "values": values}])
}

/// The one fault of a campaign that is refused: pointer, code, what is allowed.
fn fault(changes: Value) -> (String, String, String) {
    let mut found = faults(changes);
    assert_eq!(found.len(), 1, "{found:?}");
    found.remove(0)
}

fn fault_is(changes: Value, pointer: &str, code: &str, allowed: &str) {
    assert_eq!(
        fault(changes),
        (pointer.to_owned(), code.to_owned(), allowed.to_owned())
    );
}

#[test]
fn what_is_out_of_range_is_refused_with_its_range() {
    fault_is(json!({"runs": 0}), "/runs", "out_of_range", "[1, 1000000]");
    for confidence in [0.0, 1.0, 95.0] {
        fault_is(
            json!({"confidence": confidence}),
            "/confidence",
            "out_of_range",
            "(0, 1)",
        );
    }
    fault_is(
        json!({"grid": []}),
        "/grid",
        "out_of_range",
        "1 to 8 entries",
    );
    fault_is(
        json!({"grid": values("/seed", json!([]))}),
        "/grid/0/values",
        "out_of_range",
        "1 to 1000 entries",
    );
    let no_variants = json!([{"by": "variants", "name": "none", "variants": []}]);
    fault_is(
        json!({"grid": no_variants}),
        "/grid/0/variants",
        "out_of_range",
        "1 to 1000 entries",
    );
}

#[test]
fn a_grid_too_large_and_a_campaign_too_long_are_refused_with_what_they_would_take() {
    let detail = |changes: Value| {
        plan(JobKind::Campaign, &campaign(changes))
            .unwrap_err()
            .remove(0)
            .detail
    };
    let axis = |number: u32| json!({"by": "values", "name": number.to_string(), "path": "/input", "values": (0..1000).collect::<Vec<_>>()});
    let billion = json!({"grid": [axis(0), axis(1), axis(2)]});
    fault_is(billion.clone(), "/grid", "too_large", "at most 2000 cells");
    assert_eq!(detail(billion), "the grid has 1000000000 cells");
    // 10 000 false detections and 90 of targets a scan, 30 scans, 3 µs each: 0.9081 s a run; 2 cells, 1 000 000 runs.
    let long = json!({"runs": 1_000_000, "base": scenario_base(), "outcomes": [{"path": "tfa.counts.correct"}]});
    fault_is(
        long.clone(),
        "/runs",
        "too_large",
        "at most 604800 s and 50000000 numbers",
    );
    assert_eq!(
        detail(long),
        "2 cells with 1000000 runs each are about 1816200 s of work and 2000000 numbers"
    );
}

#[test]
fn an_unknown_path_is_refused_with_the_nearest_one() {
    let refused = |path: &str| {
        let faults = plan(
            JobKind::Campaign,
            &campaign(json!({"grid": values(path, json!([1, 2])), "base": scenario_base()})),
        )
        .unwrap_err();
        assert_eq!(
            (faults.len(), &*faults[0].pointer),
            (1, "/grid/0/path"),
            "{faults:?}"
        );
        (
            faults[0].code.clone(),
            faults[0].allowed.clone().unwrap(),
            faults[0].detail.clone(),
        )
    };
    let (code, allowed, detail) = refused("/trakcer/gate_probability");
    assert!(
        code == "unknown_field" && allowed.split(", ").any(|name| name == "tracker"),
        "{code} {allowed}"
    );
    assert!(
        detail
            .ends_with("unknown field 'trakcer'; the nearest path is '/tracker/gate_probability'"),
        "{detail}"
    );
    let (code, allowed, detail) = refused("/input/scenario/sensors/0/pd");
    assert!(
        code == "unknown_field" && allowed.split(", ").any(|name| name == "p_d"),
        "{code} {allowed}"
    );
    assert!(
        detail.ends_with("the nearest path is '/input/scenario/sensors/0/p_d'"),
        "{detail}"
    );
    let (code, allowed, detail) = refused("/input/scenario/sensors/3/p_d");
    assert_eq!((&*code, &*allowed), ("unknown_path", "an index below 1"));
    assert!(
        detail
            .ends_with("there is no item '3'; the nearest path is '/input/scenario/sensors/0/p_d'"),
        "{detail}"
    );
    let (code, allowed, detail) = refused("input");
    assert_eq!(
        (&*code, &*allowed),
        ("unknown_path", "a JSON pointer such as /associator")
    );
    assert!(detail.ends_with("the nearest path is '/input'"), "{detail}");
    let (code, allowed, detail) = refused("/input/source/p_d");
    assert_eq!(
        (&*code, &*allowed),
        ("unknown_path", "a path to a field of the base")
    );
    assert!(
        detail.contains("'p_d' is inside of a plain value; the nearest path is"),
        "{detail}"
    );
    let (code, allowed, detail) = refused("/seed");
    assert_eq!(
        (&*code, &*allowed),
        (
            "unknown_path",
            "'runs' for more scenes, or 'seed' of the campaign for others"
        )
    );
    assert!(
        detail.ends_with("every cell has the seed of the campaign"),
        "{detail}"
    );
}

#[test]
fn a_fault_of_a_value_is_told_once_and_where_the_value_stands() {
    let gate = values("/tracker/gate_probability", json!([0.9, 2.0]));
    let both = json!([gate[0], associators(&["jpda", "nearest_neighbour"])]);
    fault_is(
        json!({"grid": both}),
        "/grid/0/values/1",
        "out_of_range",
        "(0, 1]",
    );
    let (pointer, code, allowed) = fault(json!({"grid": [associators(&["jpda", "jpta"])]}));
    assert_eq!(
        (&*pointer, &*code),
        ("/grid/0/variants/1/set/0/value/method", "unknown_value")
    );
    assert!(allowed.split(", ").any(|name| name == "jpda"), "{allowed}");
    let misspelt = json!([{"by": "variants", "name": "a", "variants": [{"name": "a", "set": [{"path": "/asociator", "value": {}}]}]}]);
    let (pointer, code, _) = fault(json!({"grid": misspelt}));
    assert_eq!(
        (&*pointer, &*code),
        ("/grid/0/variants/0/set/0/path", "unknown_field")
    );
}

#[test]
fn what_does_not_fit_together_is_refused() {
    fault_is(
        json!({"base": {"kind": "campaign"}}),
        "/base/kind",
        "unknown_value",
        "simulate, associate, evaluate, group, correlate",
    );
    assert_eq!(
        faults(json!({"base": {"kind": "evaluate", "inptu": 1}}))[0].0,
        "/base/inptu"
    );
    fault_is(json!({"base": 7}), "/base", "wrong_type", "an object");
    fault_is(
        json!({"compare": {"axis": "associator", "to": "pda"}}),
        "/compare/to",
        "unknown_value",
        "nearest_neighbour, jpda",
    );
    fault_is(
        json!({"compare": {"axis": "filter", "to": "pda"}}),
        "/compare/axis",
        "unknown_value",
        "associator",
    );
    fault_is(
        json!({"grid": [associators(&["jpda", "jpda"])]}),
        "/grid/0/1",
        "duplicate",
        "each name once",
    );
}

#[test]
fn without_a_grid_the_base_is_the_one_cell() {
    let mut body = campaign(json!({"runs": 2}));
    body.as_object_mut().unwrap().remove("grid");
    let cells = outcome(&body).result["cells"].take();
    assert_eq!(
        (
            cells.as_array().unwrap().len(),
            &cells[0]["name"],
            &cells[0]["runs"]
        ),
        (1, &json!("all"), &json!(2))
    );
}

fn scenario_base() -> Value {
    let mut base = base();
    base["input"] = presets::find("liang2009-100").unwrap().body["input"].take();
    base["input"]["scenario"]["sensors"][0]["clutter_per_scan"] = json!(10_000.0);
    base
}

#[test]
fn faults_of_the_table_and_of_the_base_are_told_together() {
    let mut bad = base();
    bad["inptu"] = json!(1);
    let found: Vec<String> = faults(json!({"runs": 0, "base": bad}))
        .into_iter()
        .map(|fault| fault.0)
        .collect();
    assert_eq!(found, ["/runs", "/base/inptu"]);
}

#[test]
fn each_outcome_has_a_name_of_its_own() {
    let outcomes = json!([{"path": "tfa.counts.correct", "name": "n"}, {"path": "tfa.counts.missed", "name": "n"}]);
    assert_eq!(
        faults(json!({"outcomes": outcomes}))[0],
        (
            "/outcomes/1".into(),
            "duplicate".into(),
            "each name once; 'name' sets it".into()
        )
    );
}

#[test]
fn an_outcome_that_no_run_has_and_a_share_that_is_none_are_told() {
    let found = outcome(&campaign(json!({"runs": 2, "outcomes": [
        {"path": "tfa.counts.corect", "name": "mistyped"},
        {"path": "tfa.counts.targets", "name": "targets", "interval": "wilson"}
    ]})));
    assert_eq!(found.warnings.len(), 2, "{:?}", found.warnings);
    assert!(
        found.warnings[0].contains("'mistyped'") && found.warnings[0].contains("tfa.counts.corect")
    );
    assert!(found.warnings[1].contains("'targets'"));
    let targets = &found.result["cells"][0]["outcomes"]["targets"];
    let each: Vec<f64> = (0..2)
        .map(|number| {
            single("jpda", number)["tfa"]["counts"]["targets"]
                .as_f64()
                .unwrap()
        })
        .collect();
    assert_eq!(
        (&targets["mean"], &targets["interval"]),
        (&json!(mean(&each)), &Value::Null)
    );
}

/// A clock that goes on by a millisecond with each look.
#[derive(Default)]
struct Ticks(std::cell::Cell<u64>);

impl Observer for Ticks {
    fn progress(&mut self, _: Step, _: u64, _: u64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn now(&self) -> Option<std::time::Duration> {
        self.0.set(self.0.get() + 1);
        Some(std::time::Duration::from_millis(self.0.get()))
    }
}

/// All runs, made in lots of about `lot` by what the first took, the lots in another order.
fn in_lots(body: &Value, lot: std::time::Duration) -> (Outcome, usize) {
    let plan = plan(JobKind::Campaign, body).unwrap();
    let campaign = plan.job_as::<Campaign>().unwrap();
    let (mut pieces, mut outcomes) = (Vec::new(), None);
    while let Next::Runs { items, .. } = campaign.next(&pieces) {
        let is_first = pieces.is_empty();
        let mut lots = if is_first {
            vec![items]
        } else {
            campaign.cut(items, &pieces, lot, lot)
        };
        lots.reverse();
        for items in lots {
            // The first runs are few: the clock says at once that it is enough.
            let enough = is_first.then_some(std::time::Duration::ZERO);
            let request = ChunkRequest {
                items,
                outcomes: outcomes.take(),
                enough,
                done: 0,
                total: campaign.total(),
            };
            let (piece, found) = campaign
                .make(request, &Vec::new(), &mut Ticks::default())
                .unwrap();
            let text = serde_json::to_string(&piece).unwrap();
            pieces.push(serde_json::from_str::<ChunkResult>(&text).unwrap());
            assert_eq!(
                pieces.last(),
                Some(&piece),
                "a piece is the same after it was stored"
            );
            outcomes = Some(found);
        }
    }
    (
        campaign.report(&pieces, &outcomes.unwrap()).unwrap(),
        pieces.len(),
    )
}

#[test]
fn the_result_does_not_depend_on_how_runs_are_cut_into_pieces_and_in_which_order_they_are_made() {
    let unlisted = campaign(json!({"runs": 12}));
    let bootstrapped = campaign(json!({"runs": 45, "outcomes": [
        {"path": "tfa.probability.correct", "name": "correct", "interval": "bootstrap"}, {"path": "tfa.counts.false", "name": "false"}
    ], "stop_at": {"outcome": "correct", "half_width": 0.03}}));
    for (body, at_least) in [(&unlisted, 5), (&bootstrapped, 8)] {
        let expected = outcome(body);
        // Each look at the clock is a millisecond, so that a run takes one to three.
        let (found, pieces) = in_lots(body, std::time::Duration::from_millis(5));
        assert!(pieces >= at_least, "{pieces} pieces");
        assert_eq!(found.result.to_string(), expected.result.to_string());
        let files = |outcome: &Outcome| {
            outcome
                .artifacts
                .iter()
                .map(|file| (file.name, file.bytes.clone()))
                .collect::<Vec<_>>()
        };
        assert_eq!(files(&found), files(&expected));
        assert_eq!(found.warnings, expected.warnings);
    }
}

#[test]
#[expect(
    clippy::single_range_in_vec_init,
    reason = "lots are lists of ranges of runs"
)]
fn lots_take_about_the_time_that_the_first_runs_tell() {
    let body = campaign(json!({"runs": 50, "timed_runs": 0}));
    let plan = plan(JobKind::Campaign, &body).unwrap();
    let campaign = plan.job_as::<Campaign>().unwrap();
    let request = ChunkRequest {
        items: vec![0..4],
        outcomes: None,
        enough: None,
        done: 0,
        total: 100,
    };
    let (piece, _) = campaign
        .make(request, &Vec::new(), &mut Ticks::default())
        .unwrap();
    // One look a run: each took a millisecond.
    assert_eq!(
        (piece.len(), piece.spent()),
        (4, std::time::Duration::from_millis(4))
    );
    let pieces = [piece];
    let Next::Runs { items, skipped } = campaign.next(&pieces) else {
        panic!("there is more to do")
    };
    assert_eq!((&items, skipped), (&vec![4..100], 0));
    assert_eq!(
        campaign.cost(&items, &pieces),
        std::time::Duration::from_millis(96)
    );
    let ms = std::time::Duration::from_millis;
    assert_eq!(
        campaign.cut(items.clone(), &pieces, ms(40), ms(40)),
        [vec![4..44], vec![44..84], vec![84..100]]
    );
    // Of 96 ms a sixteenth is 6, of 90 then 5.6, which is six runs as well, and so on down to two.
    let lengths: Vec<u64> = campaign
        .cut(items, &pieces, ms(2), ms(40))
        .iter()
        .map(|lot| lot[0].end - lot[0].start)
        .collect();
    assert_eq!(lengths[..4], [6, 6, 6, 5]);
    assert!(
        lengths.is_sorted_by(|one, next| one >= next) && lengths.last() == Some(&2),
        "{lengths:?}"
    );
    assert_eq!(lengths.iter().sum::<u64>(), 96);
    assert_eq!(campaign.name_of(45), "cell 'jpda', run 22");
}

#[test]
fn a_run_makes_no_files_and_says_the_same() {
    let jobs = [
        (JobKind::Evaluate, base(), 10),
        (
            JobKind::Correlate,
            presets::find("huo2008").unwrap().body,
            3,
        ),
        (
            JobKind::Group,
            presets::find("cai-fuzzy-cv-10").unwrap().body["base"].clone(),
            1,
        ),
    ];
    for (kind, mut body, least_files) in jobs {
        body.as_object_mut().unwrap().remove("kind");
        let job = plan(kind, &body).unwrap();
        let with_files = run(&job, Vec::new(), &mut Silent).unwrap();
        let without = run(
            &Plan {
                wants_files: false,
                ..job
            },
            Vec::new(),
            &mut Silent,
        )
        .unwrap();
        assert!(
            with_files.artifacts.len() >= least_files,
            "{kind:?}: {}",
            with_files.artifacts.len()
        );
        assert_eq!(without.artifacts.len(), 0, "{kind:?}");
        assert_eq!(without.result, with_files.result, "{kind:?}");
    }
}
