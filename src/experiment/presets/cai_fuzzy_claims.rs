//! What Cai et al. say besides their tables, one campaign a claim: how many targets are reported twice, where fuzzy c-means begins,
//! how much noise it bears, what several attributes give, and what a genetic search of its centres finds.

use super::Preset;
use super::cai_fuzzy::{TARGETS, campaign, scenario};
use crate::experiment::job::JobKind;
use serde_json::{Value, json};

pub(super) fn presets() -> Vec<Preset> {
    vec![
        duplicates(),
        starts(),
        noise(),
        strongest(),
        attributes(),
        genetic(),
    ]
}

/// An axis of named variants, each a list of places and their values.
fn axis(name: &str, variants: &[(String, Vec<(&str, Value)>)]) -> Value {
    let variants = variants
        .iter()
        .map(|(name, changes)| {
            let set = changes
                .iter()
                .map(|(path, value)| json!({"path": path, "value": value}));
            json!({"name": name, "set": set.collect::<Vec<_>>()})
        })
        .collect::<Vec<_>>();
    json!({"by": "variants", "name": name, "variants": variants})
}

const MOTION: &str = "/input/scenario/targets/motion";

/// Straight and weaving courses.
fn motions() -> Value {
    let of = |motion: &str| vec![(MOTION, scenario(motion, 10)["targets"]["motion"].clone())];
    axis(
        "motion",
        &[
            ("cv".to_owned(), of("straight")),
            ("weave".to_owned(), of("weaving")),
        ],
    )
}

/// Values of one place of the base.
fn values(name: &str, path: &str, values: &Value) -> Value {
    json!({"by": "values", "name": name, "path": path, "values": values})
}

/// Changes of the grouper, or of the loop, too.
fn groupers(variants: &[(&str, Value, bool)]) -> Value {
    let variants: Vec<_> = variants
        .iter()
        .map(|(name, grouper, is_closed)| {
            let mut changes = vec![("/grouper", grouper.clone())];
            if *is_closed {
                changes.push(("/predictions/loop", json!("closed")));
            }
            ((*name).to_owned(), changes)
        })
        .collect();
    axis("grouper", &variants)
}

fn gated() -> Value {
    json!({"method": "nearest_neighbour", "gate_sigmas": 3.0})
}

fn fuzzy(initial: &str) -> Value {
    match initial {
        "predictions" => json!({"method": "fuzzy_c_means"}),
        from => {
            json!({"method": "fuzzy_c_means", "initial": {"from": from, "clusters": {"by": "count", "count": TARGETS}}})
        }
    }
}

/// A number that is kept, beside those of every campaign of groups.
fn keep(preset: &mut Preset, name: &str, path: &str) {
    if let Some(outcomes) = preset.body["outcomes"].as_array_mut() {
        outcomes.push(json!({"name": name, "path": path}));
    }
}

/// Two scenes with any number of targets that all sensors report, open and closed loop, with times.
fn duplicates() -> Preset {
    let counts = values(
        "duplicates",
        "/input/scenario/coverage/count",
        &json!([5, 10, 15, 20, 25]),
    );
    let groupers = groupers(&[
        ("NN, 3 σ", gated(), false),
        ("NN, 3 σ, closed loop", gated(), true),
        ("FCM", fuzzy("predictions"), false),
        ("FCM, closed loop", fuzzy("predictions"), true),
    ]);
    let summary = "Cai et al.: accuracy, iterations and time over the number of targets that all sensors report, with tracks that are \
                   fed the truth (open loop) or the groups found (closed loop).";
    let mut preset = campaign(
        "cai-fuzzy-duplicates".to_owned(),
        summary.to_owned(),
        scenario("straight", 10),
        &[motions(), counts, groupers],
        40,
    );
    keep(&mut preset, "reports", "grouping.counts.reports");
    keep(&mut preset, "instants", "grouping.counts.instants");
    preset
}

/// Where fuzzy c-means begins.
fn starts() -> Preset {
    let counts = values(
        "duplicates",
        "/input/scenario/coverage/count",
        &json!([10, 15]),
    );
    let mut patient = fuzzy("memberships");
    patient["max_iterations"] = json!(1000);
    let groupers = groupers(&[
        ("predictions", fuzzy("predictions"), false),
        ("one sensor", fuzzy("sensor"), false),
        ("random reports", fuzzy("random"), false),
        ("random memberships", fuzzy("memberships"), false),
        ("random memberships, 1000 iterations", patient, false),
    ]);
    let summary = "Cai et al.: fuzzy c-means from a random matrix of memberships, as their Figure 1 begins, beside other beginnings.";
    let mut preset = campaign(
        "cai-fuzzy-starts".to_owned(),
        summary.to_owned(),
        scenario("straight", 10),
        &[motions(), counts, groupers],
        10,
    );
    keep(&mut preset, "J", "grouping.search.mean_cost");
    keep(&mut preset, "unconverged", "grouping.search.unconverged");
    preset.body["compare"]["to"] = json!("predictions");
    preset
}

/// How much noise a grouper bears.
fn noise() -> Preset {
    let of = |sigma_m: f64| {
        let mut sensors = scenario("straight", 15)["sensors"].clone();
        for sensor in sensors.as_array_mut().into_iter().flatten() {
            (sensor["sigma_x_m"], sensor["sigma_y_m"]) = (json!(sigma_m), json!(sigma_m));
        }
        (
            format!("{sigma_m} m"),
            vec![("/input/scenario/sensors", sensors)],
        )
    };
    let noises = axis("sigma", &[50.0, 100.0, 200.0, 400.0, 800.0].map(of));
    let groupers = groupers(&[
        ("NN, 3 σ", gated(), false),
        ("NN, no gate", json!({"method": "nearest_neighbour"}), false),
        ("FCM", fuzzy("predictions"), false),
    ]);
    campaign(
        "cai-fuzzy-noise".to_owned(),
        "Cai et al.: accuracy of groups over the noise of the sensors, 15 duplicates.".to_owned(),
        scenario("straight", 15),
        &[motions(), noises, groupers],
        15,
    )
}

const SENSOR: &str = "/input/scenario/sensors/0";

/// The only sensor with another noise.
fn noise_of_one(sigma_m: f64) -> Value {
    let changes = ["sigma_x_m", "sigma_y_m"]
        .map(|field| json!({"path": format!("{SENSOR}/{field}"), "value": sigma_m}));
    json!({"name": format!("{sigma_m} m"), "set": changes})
}

fn associator(name: &str, associator: Value, snr_db: f64) -> Value {
    json!({"name": name, "set": [
        {"path": "/associator", "value": associator},
        {"path": format!("{SENSOR}/snr_db"), "value": snr_db}
    ]})
}

/// The strongest and the nearest neighbour as associators of one sensor with clutter and amplitudes.
fn strongest() -> Preset {
    let mut scenario = scenario("straight", 10);
    scenario["sensors"] = json!([{
        "sensor_id": "radar", "max_range_m": 30_000.0, "p_d": 0.9, "sigma_x_m": 200.0, "sigma_y_m": 200.0, "clutter_per_scan": 500.0,
        "snr_db": 13.0
    }]);
    if let Some(scenario) = scenario.as_object_mut() {
        scenario.remove("coverage");
    }
    let noises = [25.0, 50.0, 100.0, 200.0, 400.0].map(noise_of_one);
    let noises = json!({"by": "variants", "name": "sigma", "variants": noises});
    let associators = json!({"by": "variants", "name": "associator", "variants": [
        associator("NNF", json!({"method": "nearest_neighbour"}), 13.0),
        associator("SNF, 13 dB", json!({"method": "strongest_neighbour"}), 13.0),
        associator("SNF, 20 dB", json!({"method": "strongest_neighbour"}), 20.0),
        associator("PDA", json!({"method": "pda"}), 13.0),
        associator("FCM, weighted", json!({"method": "fuzzy_c_means", "weights": "weighted"}), 13.0)
    ]});
    let name = "cai-fuzzy-strongest".to_owned();
    Preset {
        summary: "Cai et al.: the strongest and the nearest neighbour over the noise of a sensor with 500 false detections a scan, on \
                  straight and weaving courses; tracks begin at the truth. Echoes fluctuate as Swerling 1 has it."
            .to_owned(),
        kind: JobKind::Campaign,
        body: json!({
            "name": name,
            "seed": 1,
            "base": {
                "kind": "evaluate",
                "input": {"source": "scenario", "scenario": scenario},
                "associator": {"method": "nearest_neighbour"},
                "filter": {"method": "kalman", "process_noise_m2ps3": 100.0},
                "tracker": {"gate_probability": 0.999, "initiation": {"method": "truth"}},
                "comparison": {"gate_m": 1250.0, "credit": "afterwards"},
                "profile": "vision",
                "metrics": [{"metric": "identity"}]
            },
            "grid": [motions(), noises, associators],
            "runs": 25,
            "outcomes": [
                {"name": "IDF1", "path": "metrics.identity.value"}
            ],
            "compare": {"axis": "associator", "to": "NNF"}
        }),
        name,
    }
}

/// One attribute and several, of sensors at one place that report ranges, bearings and range rates.
fn attributes() -> Preset {
    let sensor = |number: u32| {
        json!({
            "sensor_id": format!("S{number}"), "y_m": -40_000.0, "max_range_m": 100_000.0, "p_d": 1.0, "sigma_range_m": 200.0,
            "sigma_bearing_deg": 0.3, "sigma_range_rate_mps": 10.0, "clutter_per_scan": 0.0
        })
    };
    let mut scenario = scenario("straight", 15);
    scenario["sensors"] = json!((1..=6).map(sensor).collect::<Vec<_>>());
    let sets = [
        vec!["range"],
        vec!["bearing"],
        vec!["range_rate"],
        vec!["position"],
        vec!["range", "bearing"],
        vec!["position", "range_rate"],
        vec!["position", "range", "bearing", "range_rate"],
    ];
    let sets = sets.map(|set| (set.join(", "), vec![("/attributes", json!(set))]));
    let groupers = groupers(&[
        ("NN", json!({"method": "nearest_neighbour"}), false),
        ("FCM", fuzzy("predictions"), false),
    ]);
    let mut preset = campaign(
        "cai-fuzzy-attributes".to_owned(),
        "Cai et al.: groups by one attribute and by several, 15 duplicates, of six sensors 40 km south that report ranges, bearings \
         and range rates."
            .to_owned(),
        scenario,
        &[motions(), groupers, axis("attributes", &sets)],
        15,
    );
    preset.body["compare"] = json!({"axis": "attributes", "to": "position"});
    preset
}

/// Fuzzy c-means from random reports, by a genetic search, and by the same search without c-means inside.
fn genetic() -> Preset {
    let search = |population: u32, generations: u32, is_driven: bool| {
        let mut grouper = fuzzy("genetic");
        let initial = &mut grouper["initial"];
        (initial["population"], initial["generations"]) = (json!(population), json!(generations));
        if !is_driven {
            initial["driven"] = json!(false);
        }
        grouper
    };
    let mut scenario = scenario("straight", 10);
    scenario["scans"] = json!(3);
    let counts = values(
        "duplicates",
        "/input/scenario/coverage/count",
        &json!([10, 15]),
    );
    let groupers = groupers(&[
        ("random reports", fuzzy("random"), false),
        ("genetic, 6 × 6", search(6, 6, true), false),
        ("plain genetic, 40 × 40", search(40, 40, false), false),
        ("predictions", fuzzy("predictions"), false),
    ]);
    let mut preset = campaign(
        "cai-fuzzy-genetic".to_owned(),
        "Genetic fuzzy c-means: J and accuracy from random reports, by a genetic search whose individuals c-means drives to their \
         optima, and by one without c-means that computes as many distances; the first instants of each scene."
            .to_owned(),
        scenario,
        &[motions(), counts, groupers],
        6,
    );
    keep(&mut preset, "J", "grouping.search.mean_cost");
    preset.body["compare"]["to"] = json!("random reports");
    preset
}
