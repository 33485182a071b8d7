//! From the body of a request to a plan: names and parameters checked, every fault reported, inputs named.

use crate::experiment::associate::{auto_filter, dry_run as rehearsal};
use crate::experiment::evaluate::profiles;
use crate::experiment::input::detect;
use crate::experiment::request::checks::{
    check_lifecycle, check_names, check_sensors, check_start,
};
use crate::experiment::request::{fields as requests, preset_source};
use crate::experiment::{campaign, catalogue, correlate};
use crate::math::rng::Seed;
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;
use crate::model::scenario::Scenario;
use crate::registry::{self, Kind};
use crate::tracking::LIFECYCLE;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::sync::Arc;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JobKind {
    Simulate,
    Associate,
    Evaluate,
    Group,
    Correlate,
    Campaign,
}

impl JobKind {
    pub const ALL: [JobKind; 6] = [
        JobKind::Simulate,
        JobKind::Associate,
        JobKind::Evaluate,
        JobKind::Group,
        JobKind::Correlate,
        JobKind::Campaign,
    ];

    pub fn name(self) -> &'static str {
        match self {
            JobKind::Simulate => "simulate",
            JobKind::Associate => "associate",
            JobKind::Evaluate => "evaluate",
            JobKind::Group => "group",
            JobKind::Correlate => "correlate",
            JobKind::Campaign => "campaign",
        }
    }
}

/// Where an input that must be loaded comes from.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "source", rename_all = "snake_case")]
pub enum Source {
    Dataset {
        dataset_id: String,
        #[serde(default)]
        sensor_ids: Option<Vec<String>>,
    },
    Job {
        job_id: String,
        #[serde(default)]
        sensor_ids: Option<Vec<String>>,
    },
}

/// One input that the caller must load before the plan can run.
#[derive(Debug, Clone, PartialEq)]
pub struct InputRequest {
    /// Where the request names it, for faults: `/input`, `/truth`, `/tracks`, `/detections`, `/sequences/0/truth`, …
    pub pointer: String,
    /// Index of the sequence that it belongs to.
    pub sequence: Option<usize>,
    pub role: DatasetKind,
    pub source: Source,
    /// A job's output may lack this input (a recording without truth); then the plan does without it.
    pub optional: bool,
}

/// A checked request.
#[derive(Debug, Clone)]
pub struct Plan {
    pub kind: JobKind,
    /// The request as normalised: defaults filled in, presets written out. A plan of it is the same plan.
    pub spec: Value,
    pub seed: u32,
    /// Number of the run within a campaign; 0 for a job alone.
    pub run: u32,
    /// Whether the files are wanted: not of the runs of a campaign.
    pub wants_files: bool,
    /// Whether what decides (an associator, a grouper) is timed by itself, where the observer has a clock.
    pub is_timed: bool,
    pub inputs: Vec<InputRequest>,
    pub estimate: Estimate,
    /// Of a campaign: its cells and runs.
    pub campaign: Option<Arc<campaign::Campaign>>,
}

impl Plan {
    /// What its random numbers are drawn from.
    pub fn stream(&self) -> Seed {
        Seed {
            seed: self.seed,
            run: self.run,
        }
    }
}

/// What a job will roughly cost.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Detections that a simulation will make, or that are known to be in the data.
    pub detections: u64,
    pub cost_s: f64,
    pub bytes: u64,
}

/// Checks the body of a request.
///
/// # Errors
/// Every fault, each with its JSON pointer.
pub fn plan(kind: JobKind, body: &Value) -> Result<Plan, Vec<Fault>> {
    let mut faults = Vec::new();
    let body = preset_source::with_settings(kind, body);
    let mut spec = registry::check_into(&body, catalogue::request_object(kind), &mut faults);
    if !spec.is_object() {
        return Err(faults);
    }
    check_names(&spec, "", &mut faults);
    if kind == JobKind::Campaign {
        return campaign::plan(spec, faults);
    }
    // What follows reads of the spec only what is right, so that one request shows all its faults.
    match kind {
        JobKind::Evaluate => check_evaluate(&mut spec, &mut faults),
        JobKind::Correlate => correlate::check(&mut spec, &mut faults),
        _ => {}
    }
    preset_source::write_out(&mut spec, &mut faults);
    detect::check(
        &mut spec,
        matches!(kind, JobKind::Associate | JobKind::Evaluate),
        &mut faults,
    );
    auto_filter::settle_at_planning(&mut spec);
    check_sensors(&spec, &mut faults);
    check_lifecycle(&spec, &mut faults);
    let faults_before = faults.len();
    let of_scenario = check_scenario(&spec, &mut faults);
    if faults.len() == faults_before {
        rehearsal::check(&spec, &mut faults);
    }
    let estimate = correlate::estimate(&spec, &mut faults).unwrap_or(of_scenario);
    let inputs = inputs_of(&spec, &mut faults);
    check_start(&spec, &inputs, &mut faults);
    if kind == JobKind::Evaluate {
        profiles::fill_metrics(&mut spec, &inputs, &mut faults);
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let seed = spec["seed"]
        .as_u64()
        .and_then(|seed| u32::try_from(seed).ok())
        .unwrap_or_default();
    Ok(Plan {
        kind,
        spec,
        seed,
        run: 0,
        wants_files: true,
        is_timed: false,
        inputs,
        estimate,
        campaign: None,
    })
}

/// `evaluate` tracks `input` first, or takes `tracks` or `sequences`: exactly one of them, with the settings that go with it.
fn check_evaluate(spec: &mut Value, faults: &mut Vec<Fault>) {
    const SUBJECTS: [&str; 3] = ["input", "tracks", "sequences"];
    let given: Vec<&str> = SUBJECTS
        .into_iter()
        .filter(|name| spec.get(*name).is_some())
        .collect();
    match given.as_slice() {
        ["input"] => fill_tracking_defaults(spec),
        ["tracks"] => {
            let is_of_detections = spec.get("detections").is_some();
            let sensors = if is_of_detections {
                None
            } else {
                Some("sensors")
            };
            let names: Vec<&str> = ["associator", "filter", "tracker"]
                .into_iter()
                .chain(sensors)
                .collect();
            refuse(
                spec,
                &names,
                "needs 'input'; 'tracks' are judged as they are",
                faults,
            );
        }
        [_] => {
            let names = [
                "associator",
                "filter",
                "tracker",
                "sensors",
                "truth",
                "detections",
                "tfa",
            ];
            refuse(
                spec,
                &names,
                "does not go with 'sequences': each has its own truth and tracks, for metrics alone",
                faults,
            );
            check_sequences(spec, faults);
        }
        [] => faults.push(
            Fault::new(
                "",
                "missing",
                "give 'input' to track first, or 'tracks' or 'sequences' to judge",
            )
            .allowing(SUBJECTS.join(", ")),
        ),
        [first, second, ..] => {
            faults.push(Fault::new(
                format!("/{second}"),
                "conflict",
                format!("give either '{first}' or '{second}', not both"),
            ));
        }
    }
}

/// Sequences are told apart by name, and only metrics judge them.
fn check_sequences(spec: &Value, faults: &mut Vec<Fault>) {
    let sequences = spec["sequences"].as_array().map_or(&[][..], Vec::as_slice);
    for (index, sequence) in sequences.iter().enumerate() {
        if let Some(name) = sequence["name"].as_str().filter(|name| {
            sequences[..index]
                .iter()
                .any(|other| other["name"] == *name)
        }) {
            let fault = Fault::new(
                format!("/sequences/{index}/name"),
                "duplicate",
                format!("two sequences are called '{name}'"),
            );
            faults.push(fault.allowing("each name once"));
        }
    }
    if spec["profile"] == "tfa" && spec["metrics"].as_array().is_none_or(Vec::is_empty) {
        let fault = Fault::new(
            "/profile",
            "unsupported",
            "the automaton does not judge sequences, so nothing would be judged",
        );
        faults.push(fault.allowing("tracking, vision, or metrics of your own"));
    }
}

pub(super) fn refuse(spec: &Value, names: &[&str], why: &str, faults: &mut Vec<Fault>) {
    for name in names.iter().filter(|name| spec.get(**name).is_some()) {
        faults.push(Fault::new(
            format!("/{name}"),
            "conflict",
            format!("'{name}' {why}"),
        ));
    }
}

pub(super) fn fill_tracking_defaults(spec: &mut Value) {
    static TRACKER: Kind = Kind::Object(&LIFECYCLE);
    static ASSOCIATOR: Kind = Kind::Union(&crate::association::ASSOCIATOR);
    let defaults: [(&str, &str, &'static Kind); 3] = [
        ("associator", requests::DEFAULT_ASSOCIATOR, &ASSOCIATOR),
        (
            "filter",
            requests::DEFAULT_FILTER,
            &crate::filtering::FILTER_KIND,
        ),
        ("tracker", "{}", &TRACKER),
    ];
    for (name, text, kind) in defaults {
        if spec.get(name).is_none() {
            let value = serde_json::from_str(text).expect("the defaults are JSON");
            spec[name] = registry::check_field(&value, kind, "", &mut Vec::new());
        }
    }
}

/// Whether there will be truth, unless a job that may know it does not.
pub(super) fn knows_truth(spec: &Value, inputs: &[InputRequest]) -> bool {
    spec.pointer("/input/scenario").is_some()
        || inputs.iter().any(|input| input.role == DatasetKind::Truth)
}

/// The scenario of the request, and where it stands.
pub(super) fn scenario_of(spec: &Value) -> Option<(Scenario, &'static str)> {
    let (value, pointer) = match (spec.get("scenario"), spec.pointer("/input/scenario")) {
        (Some(value), _) => (value, "/scenario"),
        (None, Some(value)) => (value, "/input/scenario"),
        (None, None) => return None,
    };
    Scenario::deserialize(value)
        .ok()
        .map(|scenario| (scenario, pointer))
}

fn check_scenario(spec: &Value, faults: &mut Vec<Fault>) -> Estimate {
    let Some((scenario, pointer)) = scenario_of(spec) else {
        return Estimate::default();
    };
    if let Err(found) = crate::simulation::check(&scenario) {
        faults.extend(found.into_iter().map(|fault| Fault {
            pointer: format!("{pointer}{}", fault.pointer),
            ..fault
        }));
    }
    let targets = scenario.targets.count() as f64;
    let in_a_scan: f64 = scenario
        .sensors
        .iter()
        .map(|sensor| targets * sensor.p_d + sensor.mean_clutter())
        .sum();
    let detections = in_a_scan * f64::from(scenario.scans);
    if detections > requests::MAX_DETECTIONS {
        let fault = Fault::new(
            pointer,
            "too_large",
            format!("the scenario makes about {detections:.0} detections"),
        );
        faults.push(fault.allowing(format!("at most {} detections", requests::MAX_DETECTIONS)));
    }
    let cells = scenario.record.as_ref().map_or(0.0, |record| {
        crate::simulation::row_count(&scenario, record) as f64 * 360.0 / record.bearing_step_deg
    });
    // Measured: about 3 µs and 250 bytes a detection, from simulation to the written artefacts; 0.2 µs and 15 bytes a cell.
    let (cost_s, bytes) = (
        detections * 3e-6 + cells * 2e-7,
        detections * 250.0 + cells * 15.0,
    );
    Estimate {
        detections: detections as u64,
        cost_s,
        bytes: bytes as u64,
    }
}

/// The inputs to load. A job brings along what else it knows: the truth with its detections, both with its tracks.
fn inputs_of(spec: &Value, faults: &mut Vec<Fault>) -> Vec<InputRequest> {
    let request = |pointer: &str, role, source: &Source, optional| InputRequest {
        pointer: pointer.to_owned(),
        sequence: None,
        role,
        source: source.clone(),
        optional,
    };
    let mut inputs = Vec::new();
    let mut known = Vec::new();
    let is_record = spec.get("detector").is_some();
    for (name, pointer, role) in [
        (
            "input",
            "/input",
            if is_record {
                DatasetKind::BearingTime
            } else {
                DatasetKind::Detections
            },
        ),
        ("tracks", "/tracks", DatasetKind::Tracks),
        ("detections", "/detections", DatasetKind::Detections),
        ("truth", "/truth", DatasetKind::Truth),
    ] {
        if let Some(source) = source_at(spec.get(name)) {
            inputs.push(request(pointer, role, &source, false));
            known.push(role);
        }
    }
    let sets: Vec<Source> = spec["sets"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|set| source_at(Some(set)))
        .collect();
    inputs.extend(sets.iter().enumerate().map(|(index, source)| {
        request(
            &format!("/sets/{index}"),
            DatasetKind::Tracks,
            source,
            false,
        )
    }));
    if known.contains(&DatasetKind::BearingTime) {
        // They are found in the record.
        known.push(DatasetKind::Detections);
    }
    for (name, pointer) in [("input", "/input"), ("tracks", "/tracks")] {
        if let Some(source @ Source::Job { .. }) = source_at(spec.get(name)) {
            for role in [DatasetKind::Detections, DatasetKind::Truth] {
                if !known.contains(&role) {
                    inputs.push(request(pointer, role, &source, true));
                    known.push(role);
                }
            }
        }
    }
    // One job among the sets may know the truth behind all of them.
    if let Some(index) = sets
        .iter()
        .position(|set| matches!(set, Source::Job { .. }))
        .filter(|_| !known.contains(&DatasetKind::Truth))
    {
        inputs.push(request(
            &format!("/sets/{index}"),
            DatasetKind::Truth,
            &sets[index],
            true,
        ));
    }
    check_symbols(spec, &known, faults);
    inputs.extend(sequence_inputs(spec));
    inputs
}

fn source_at(value: Option<&Value>) -> Option<Source> {
    value.and_then(|value| Source::deserialize(value).ok())
}

fn sequence_inputs(spec: &Value) -> impl Iterator<Item = InputRequest> {
    let sequences = spec
        .get("sequences")
        .and_then(Value::as_array)
        .into_iter()
        .flatten()
        .enumerate();
    sequences.flat_map(|(index, sequence)| {
        [
            ("truth", DatasetKind::Truth),
            ("tracks", DatasetKind::Tracks),
        ]
        .into_iter()
        .filter_map(move |(name, role)| {
            let (pointer, source) = (
                format!("/sequences/{index}/{name}"),
                source_at(sequence.get(name))?,
            );
            Some(InputRequest {
                pointer,
                sequence: Some(index),
                role,
                source,
                optional: false,
            })
        })
    })
}

/// The automaton cannot read symbols that no input gives.
fn check_symbols(spec: &Value, known: &[DatasetKind], faults: &mut Vec<Fault>) {
    let is_simulated =
        spec.pointer("/input/scenario").is_some() || spec.pointer("/input/preset").is_some();
    let (wanted, pointer, name) = match spec.pointer("/tfa/symbols/kind").and_then(Value::as_str) {
        Some("detection_id" | "nearest_detection") => {
            (DatasetKind::Detections, "/detections", "detections")
        }
        Some("nearest_truth") => (DatasetKind::Truth, "/truth", "truth"),
        None if spec.get("tracks").is_some() && known == [DatasetKind::Tracks] => {
            let detail = "'truth' is required to judge tracks, or 'detections' that know which target they came from";
            faults.push(Fault::new("/truth", "missing", detail));
            return;
        }
        _ => return,
    };
    let is_given = spec.get(name).is_some() || spec.get("sequences").is_some();
    if !is_simulated && !is_given && !known.is_empty() && !known.contains(&wanted) {
        let symbols = spec
            .pointer("/tfa/symbols/kind")
            .and_then(Value::as_str)
            .unwrap_or_default();
        faults.push(Fault::new(
            pointer,
            "missing",
            format!("'{name}' is required when the symbols are {symbols}"),
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::presets;
    use serde_json::json;

    const ID: &str = "0197";

    fn pointers(kind: JobKind, body: Value) -> Vec<(String, String)> {
        plan(kind, &body)
            .unwrap_err()
            .into_iter()
            .map(|fault| (fault.pointer, fault.code))
            .collect()
    }

    fn roles(body: Value) -> Vec<(&'static str, DatasetKind, bool)> {
        plan(JobKind::Evaluate, &body)
            .unwrap()
            .inputs
            .iter()
            .map(|input| (&*input.pointer.clone().leak(), input.role, input.optional))
            .collect()
    }

    #[test]
    fn every_preset_is_a_plan_and_its_spec_is_the_same_plan() {
        for preset in presets::all() {
            let first = plan(preset.kind, &preset.body).unwrap();
            let again = plan(preset.kind, &first.spec).unwrap();
            assert_eq!(first.spec, again.spec, "{}", preset.name);
            assert!(first.estimate.detections > 0 && first.inputs.is_empty());
        }
    }

    #[test]
    fn a_preset_as_a_source_is_written_out() {
        let body = json!({"input": {"source": "preset", "preset": "liang2009-30"}});
        let made = plan(JobKind::Associate, &body).unwrap();
        assert_eq!(
            made.spec.pointer("/input/scenario/targets/count"),
            Some(&json!(30))
        );
        let unknown = json!({"input": {"source": "preset", "preset": "liang2010"}});
        assert_eq!(
            pointers(JobKind::Associate, unknown),
            [("/input/preset".into(), "unknown_value".into())]
        );
    }

    #[test]
    fn evaluate_takes_input_or_tracks_but_not_both_nor_neither() {
        let tracks = json!({"source": "dataset", "dataset_id": ID});
        let input = json!({"source": "job", "job_id": ID});
        assert_eq!(
            pointers(JobKind::Evaluate, json!({})),
            [("".into(), "missing".into())]
        );
        let both = json!({"tracks": tracks, "input": input});
        assert_eq!(
            pointers(JobKind::Evaluate, both),
            [("/tracks".into(), "conflict".into())]
        );
        let settings = json!({"tracks": input, "filter": {"method": "kalman"}});
        assert_eq!(
            pointers(JobKind::Evaluate, settings),
            [("/filter".into(), "conflict".into())]
        );
        assert_eq!(
            pointers(JobKind::Evaluate, json!({"tracks": tracks})),
            [("/truth".into(), "missing".into())]
        );
        let by_id = json!({"tracks": tracks, "tfa": {}});
        assert_eq!(
            pointers(JobKind::Evaluate, by_id),
            [("/detections".into(), "missing".into())]
        );
        let by_truth =
            json!({"tracks": tracks, "tfa": {"symbols": {"kind": "nearest_truth", "gate_m": 10}}});
        assert_eq!(
            pointers(JobKind::Evaluate, by_truth),
            [("/truth".into(), "missing".into())]
        );
    }

    #[test]
    fn faults_of_single_fields_and_of_their_meaning_are_reported_together() {
        let body = json!({
            "input": {"source": "preset", "preset": "x"},
            "tracker": {"confirm_hits": 9, "confirm_window": 4, "max_missed": 0},
            "wings": 2
        });
        let found: Vec<String> = pointers(JobKind::Associate, body)
            .into_iter()
            .map(|(pointer, _)| pointer)
            .collect();
        assert_eq!(
            found,
            [
                "/tracker/max_missed",
                "/wings",
                "/input/preset",
                "/tracker/confirm_hits"
            ]
        );
        assert_eq!(
            pointers(JobKind::Evaluate, json!(7)),
            [("".into(), "wrong_type".into())]
        );
    }

    #[test]
    fn a_job_brings_along_its_detections_and_its_truth() {
        use DatasetKind::{Detections, Tracks, Truth};
        let job = json!({"source": "job", "job_id": ID});
        let dataset = json!({"source": "dataset", "dataset_id": ID});
        assert_eq!(
            roles(json!({"tracks": job})),
            [
                ("/tracks", Tracks, false),
                ("/tracks", Detections, true),
                ("/tracks", Truth, true)
            ]
        );
        assert_eq!(
            roles(json!({"input": job})),
            [("/input", Detections, false), ("/input", Truth, true)]
        );
        let own_truth = json!({"tracks": job, "truth": dataset});
        assert_eq!(
            roles(own_truth),
            [
                ("/tracks", Tracks, false),
                ("/truth", Truth, false),
                ("/tracks", Detections, true)
            ]
        );
    }

    #[test]
    fn a_request_too_large_for_the_machine_is_refused_before_it_runs() {
        let mut body = presets::find("liang2009").unwrap().body;
        body["input"]["scenario"]["scans"] = json!(100_000);
        body["input"]["scenario"]["targets"]["count"] = json!(100_000);
        assert_eq!(
            pointers(JobKind::Evaluate, body),
            [("/input/scenario".into(), "too_large".into())]
        );
    }

    #[test]
    fn confirmation_needs_as_many_scans_as_detections() {
        let mut body = presets::find("liang2009").unwrap().body;
        body["tracker"]["confirm_hits"] = json!(6);
        assert_eq!(
            pointers(JobKind::Evaluate, body),
            [("/tracker/confirm_hits".into(), "out_of_range".into())]
        );
    }

    #[test]
    fn sequences_are_judged_by_metrics_alone() {
        let data = json!({"source": "dataset", "dataset_id": ID});
        let sequence = json!({"name": "a", "truth": data, "tracks": data});
        let other = json!({"name": "b", "truth": data, "tracks": data});
        let body = json!({"sequences": [sequence, other], "profile": "vision"});
        use DatasetKind::{Tracks, Truth};
        let expected = [
            ("/sequences/0/truth", Truth),
            ("/sequences/0/tracks", Tracks),
            ("/sequences/1/truth", Truth),
            ("/sequences/1/tracks", Tracks),
        ];
        assert_eq!(
            roles(body.clone()),
            expected.map(|(pointer, role)| (pointer, role, false))
        );
        let with_more = json!({"sequences": [sequence], "tfa": {}, "truth": data, "filter": {"method": "kalman"}});
        let found: Vec<String> = pointers(JobKind::Evaluate, with_more)
            .into_iter()
            .map(|(pointer, _)| pointer)
            .collect();
        assert_eq!(found, ["/filter", "/truth", "/tfa"]);
        let both = json!({"sequences": [sequence], "tracks": data});
        assert_eq!(
            pointers(JobKind::Evaluate, both)[0],
            ("/sequences".into(), "conflict".into())
        );
    }

    #[test]
    fn a_profile_becomes_its_metrics_and_metrics_need_truth() {
        let names = |body: Value| -> Vec<String> {
            let spec = plan(JobKind::Evaluate, &body).unwrap().spec;
            spec["metrics"]
                .as_array()
                .unwrap()
                .iter()
                .map(|metric| metric["metric"].as_str().unwrap().to_owned())
                .collect()
        };
        let job = json!({"source": "job", "job_id": ID});
        let dataset = json!({"source": "dataset", "dataset_id": ID});
        assert_eq!(
            names(json!({"tracks": job, "profile": "vision"})),
            ["hota", "clear", "identity"]
        );
        assert_eq!(
            names(json!({"tracks": job})),
            ["gospa", "ospa", "siap", "clear", "assignment", "kinematics"]
        );
        assert_eq!(names(json!({"tracks": job, "profile": "tfa"})), [""; 0]);
        assert_eq!(
            names(json!({"tracks": dataset, "detections": dataset})),
            [""; 0],
            "there is no truth to compare with"
        );
        let gate = plan(
            JobKind::Evaluate,
            &json!({"tracks": job, "comparison": {"gate_m": 7.5}}),
        )
        .unwrap()
        .spec;
        assert_eq!(gate["metrics"][0]["cutoff_m"], 7.5);
        let asked =
            json!({"tracks": dataset, "detections": dataset, "metrics": [{"metric": "clear"}]});
        assert_eq!(
            pointers(JobKind::Evaluate, asked),
            [("/truth".into(), "missing".into())]
        );
        let unknown = json!({"tracks": job, "profile": "radar", "metrics": [{"metric": "mota"}], "comparison": {"gate_m": 0}});
        let found: Vec<String> = pointers(JobKind::Evaluate, unknown)
            .into_iter()
            .map(|(pointer, _)| pointer)
            .collect();
        assert_eq!(
            found,
            ["/profile", "/metrics/0/metric", "/comparison/gate_m"]
        );
    }

    #[test]
    fn sequences_have_names_of_their_own_and_are_judged_by_metrics() {
        let source = json!({"source": "dataset", "dataset_id": ID});
        let sequence = json!({"name": "a", "truth": source, "tracks": source});
        let body = json!({"sequences": [sequence, sequence], "profile": "tfa"});
        let found = pointers(JobKind::Evaluate, body);
        assert_eq!(
            found,
            [
                ("/sequences/1/name".into(), "duplicate".into()),
                ("/profile".into(), "unsupported".into())
            ]
        );
    }

    #[test]
    fn sensors_go_with_tracks_where_detections_are_known() {
        let source = json!({"source": "dataset", "dataset_id": ID});
        let mut body = json!({"tracks": source, "truth": source, "sensors": [{"sensor_id": "radar", "x_m": 0.0, "y_m": 0.0}]});
        assert_eq!(
            pointers(JobKind::Evaluate, body.clone()),
            [("/sensors".into(), "conflict".into())]
        );
        body["detections"] = source;
        assert!(plan(JobKind::Evaluate, &body).is_ok());
    }
}
