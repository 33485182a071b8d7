//! Inputs whose tables would be a product of their sizes are refused with the number and the bound, and long work stops when
//! it is asked to.

use crate::origins::jobs::Texts;
use serde_json::{Value, json};
use std::fmt::Write;
use std::ops::ControlFlow;
use trackloom_domain::experiment::observer::{Observer, Silent, Step};
use trackloom_domain::experiment::{Input, JobKind, Outcome, RunError, plan, run};
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::model::allowance::{
    MAX_CANDIDATES, MAX_CANDIDATES_OF_SCAN, MAX_PAIRS_OF_STEP,
};
use trackloom_domain::model::dataset::DatasetKind;
use trackloom_domain::model::fault::Fault;

/// Stops a job that asks a second time while no more is done: in the midst of a scan or of a metric.
#[derive(Default)]
struct StopsAmidst {
    step: Option<Step>,
    told: Vec<u64>,
}

impl Observer for StopsAmidst {
    fn progress(&mut self, step: Step, done: u64, _: u64) -> ControlFlow<()> {
        if self.step != Some(step) {
            return ControlFlow::Continue(());
        }
        let repeats = self.told.iter().filter(|&&told| told == done).count();
        self.told.push(done);
        if repeats > 1 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

/// So many scans of so many detections, all at one place or spread over ten metres.
fn crowd(scans: u32, detections: u32, spread_m: f64) -> String {
    let mut text = "time_s,scan,sensor_id,detection_id,x_m,y_m\n".to_owned();
    for scan in 1..=scans {
        for detection in 0..detections {
            let place = |step: u32| {
                f64::from((detection * step + 7 * scan) % detections) / f64::from(detections)
                    * spread_m
            };
            writeln!(
                text,
                "{scan},{scan},r,d{detection},{},{}",
                place(1),
                place(37)
            )
            .unwrap();
        }
    }
    text
}

fn associate(text: &str, method: &str, observer: &mut dyn Observer) -> Result<Outcome, RunError> {
    let body = json!({
        "input": {"source": "dataset", "dataset_id": "0198c0de-0000-7000-8000-000000000000"},
        "associator": {"method": method}, "filter": {"method": "kalman"}, "tracker": {"initial_speed_sigma_mps": 1.0},
        "sensors": [{"sensor_id": "r", "p_d": 0.9, "clutter_per_m2": 1e-6, "sigma_x_m": 10.0, "sigma_y_m": 10.0}]
    });
    let plan = plan(JobKind::Associate, &body).unwrap();
    let options = ReadOptions {
        kind: Some(DatasetKind::Detections),
        ..ReadOptions::default()
    };
    let dataset = (format_named("csv").unwrap().read)(&mut text.as_bytes(), &options)
        .unwrap()
        .dataset;
    let input = Some(Input {
        dataset,
        sensors: Vec::new(),
        sha256: String::new(),
    });
    let inputs = plan
        .inputs
        .iter()
        .enumerate()
        .map(|(index, _)| input.clone().filter(|_| index == 0))
        .collect();
    run(&plan, inputs, observer)
}

fn only_fault(found: Result<Outcome, RunError>) -> Fault {
    match found {
        Err(RunError::Faults(faults)) if faults.len() == 1 => faults[0].clone(),
        Err(RunError::Faults(faults)) => panic!("{faults:#?}"),
        Err(RunError::Stopped) => panic!("nobody stopped it"),
        Ok(_) => panic!("it is not refused"),
    }
}

#[test]
fn candidates_of_a_soft_associator_are_counted_before_they_are_remembered() {
    let fault = only_fault(associate(&crowd(20, 1000, 0.0), "pda", &mut Silent));
    assert_eq!(
        (fault.pointer.as_str(), fault.code.as_str()),
        ("/tracker/gate_probability", "too_large")
    );
    assert!(
        fault
            .detail
            .contains("candidates of tracks to be remembered or more"),
        "{fault:?}"
    );
    let bound = format!(
        "at most {MAX_CANDIDATES}; a smaller gate_probability, fewer detections at one place"
    );
    assert!(fault.allowed.unwrap().starts_with(&bound));
}

#[test]
fn candidates_of_one_scan_are_counted_before_they_are_decided() {
    let fault = only_fault(associate(
        &crowd(3, 2100, 0.0),
        "nearest_neighbour",
        &mut Silent,
    ));
    assert_eq!(fault.code, "too_large");
    assert!(
        fault.detail.starts_with("at scan 2 (2 s) there are 40")
            && fault.detail.contains("candidates of tracks in one scan"),
        "{fault:?}"
    );
    assert!(
        fault
            .allowed
            .unwrap()
            .starts_with(&format!("at most {MAX_CANDIDATES_OF_SCAN}; "))
    );
}

#[test]
fn a_scan_of_one_large_cluster_is_left_when_the_job_is_to_stop() {
    let mut observer = StopsAmidst {
        step: Some(Step::Associate),
        ..StopsAmidst::default()
    };
    let found = associate(&crowd(8, 700, 10.0), "jpda", &mut observer);
    assert!(
        matches!(found, Err(RunError::Stopped)),
        "told {:?}",
        observer.told
    );
    assert!(
        observer.told.last().is_some_and(|&done| done < 8),
        "{:?}",
        observer.told
    );
}

/// Objects at one place in each of so many steps.
fn rows(format: &str, steps: u32, objects: u32) -> String {
    let mut text = String::new();
    for (step, object) in
        (1..=steps).flat_map(|step| (1..=objects).map(move |object| (step, object)))
    {
        if format == "mot" {
            writeln!(text, "{step},{object},1,1,30,60,1,1,1").unwrap();
        } else {
            writeln!(text, "{step},{object},{step},0").unwrap();
        }
    }
    text
}

fn evaluated(
    format: &'static str,
    (steps, objects): (u32, u32),
    settings: Value,
) -> (Texts, Value) {
    let mut texts = Texts::of(format);
    let text = rows(format, steps, objects);
    let headed = |id: &str| {
        if format == "csv" {
            format!("time_s,{id},x_m,y_m\n{text}")
        } else {
            text.clone()
        }
    };
    let mut body = json!({"truth": texts.dataset(&headed("truth_id")), "tracks": texts.dataset(&headed("track_id"))});
    body.as_object_mut()
        .unwrap()
        .extend(settings.as_object().unwrap().clone());
    (texts, body)
}

#[test]
fn pairs_are_counted_before_they_are_kept() {
    for (format, settings) in [
        ("mot", json!({"profile": "vision"})),
        ("csv", json!({"metrics": [{"metric": "clear"}]})),
    ] {
        let (texts, body) = evaluated(format, (1, 2100), settings);
        let faults = texts
            .judge(&body)
            .expect_err("4 410 000 pairs are too many");
        let [fault] = faults.as_slice() else {
            panic!("{faults:#?}")
        };
        assert_eq!(
            (fault.pointer.as_str(), fault.code.as_str()),
            ("/comparison", "too_large")
        );
        assert_eq!(
            fault.detail,
            "there are 4000500 pairs within reach of each other in one step or more"
        );
        assert!(
            fault
                .allowed
                .as_deref()
                .unwrap()
                .starts_with(&format!("at most {MAX_PAIRS_OF_STEP}; "))
        );
    }
}

#[test]
fn trajectories_all_at_one_place_are_left_when_the_job_is_to_stop() {
    let (texts, body) = evaluated("csv", (10, 60), json!({"metrics": [{"metric": "t_gospa"}]}));
    let mut observer = StopsAmidst {
        step: Some(Step::Evaluate),
        ..StopsAmidst::default()
    };
    let found = texts.run_watched(JobKind::Evaluate, &body, &mut observer);
    assert!(
        matches!(found, Err(RunError::Stopped)),
        "told {:?}",
        observer.told
    );
}

#[test]
fn trajectories_with_more_pairs_than_a_programme_holds_are_assigned_step_by_step() {
    // Each truth has its own track at every step, so nothing is missed and nobody switches.
    let (texts, body) = evaluated("csv", (3, 100), json!({"metrics": [{"metric": "t_gospa"}]}));
    let outcome = texts.judge(&body).unwrap();
    let report = &outcome.result["metrics"]["t_gospa"];
    assert_eq!(report["value"], json!(0.0));
    assert_eq!(
        report["quantities"]["matched_points"]["value"],
        json!(300.0)
    );
}
