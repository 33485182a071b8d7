//! Stored values: what the presets and the jobs of `examples/` give, numbers within 1e-9 and words exactly.
//!
//! `TRACKLOOM_WRITE_GOLDENS=1 cargo test --test domain goldens` writes the file anew. Two builds on one machine are
//! compared byte for byte, with all files, by `tests/goldens.sh`.

use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use trackloom_domain::experiment::job_shape::take_kind;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{Input, Inputs, JobKind, plan, presets, run};
use trackloom_domain::formats::{ReadOptions, detect_format, format_named};
use trackloom_domain::model::dataset::DatasetKind;

const TOLERANCE: f64 = 1e-9;

/// Numbers are stored with so many digits.
const DIGITS: usize = 11;

/// A longer list is stored as its ends and a sum.
const LONGEST_LIST: usize = 5;

/// Presets that take seconds; what they run is run by others, too.
const SLOW: [&str; 8] = [
    "cai-fuzzy-duplicates",
    "cai-fuzzy-genetic",
    "cai-fuzzy-starts",
    "cai-fuzzy-tables",
    "huo2008-integer-programming",
    "huo2008-size",
    "huo2008-study",
    "wang-bat-6-ungated",
];

/// Runs of each cell of a campaign: as few as have an interval.
const CAMPAIGN_RUNS: u32 = 2;

#[test]
fn presets_and_examples_give_what_is_stored() {
    let path = root().join("tests/domain/goldens.json");
    let found: Map<String, Value> = results()
        .into_iter()
        .map(|(name, result)| (name, condensed(&result)))
        .collect();
    if std::env::var_os("TRACKLOOM_WRITE_GOLDENS").is_some() {
        std::fs::write(&path, written(&found)).unwrap();
        return;
    }
    let stored: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    let mut told = Vec::new();
    compare("", &stored, &Value::Object(found), &mut told);
    let first = told.iter().take(20).cloned().collect::<Vec<_>>();
    assert!(
        told.is_empty(),
        "{} values differ:\n{}",
        told.len(),
        first.join("\n")
    );
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Name and `result` of every job.
fn results() -> Vec<(String, Value)> {
    let mut results = Vec::new();
    for mut preset in presets::all() {
        if SLOW.contains(&preset.name.as_str()) {
            continue;
        }
        if preset.kind == JobKind::Campaign {
            preset.body["runs"] = json!(CAMPAIGN_RUNS);
        }
        let plan = plan(preset.kind, &preset.body).unwrap();
        let outcome = run(&plan, Vec::new(), &mut Silent).unwrap();
        results.push((preset.name, outcome.result));
    }
    for path in examples() {
        let name = path.file_name().unwrap().to_str().unwrap();
        results.push((name.to_owned(), example(&path)));
    }
    results
}

fn examples() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(root().join("examples")).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| {
        path.extension()
            .is_some_and(|extension| extension == "json")
    });
    paths.sort();
    paths
}

/// The result of a job file whose sources are files.
fn example(path: &Path) -> Value {
    let mut body: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    let kind = take_kind(&mut body).unwrap();
    let files = take_files(&mut body);
    let plan = plan(kind, &body).unwrap();
    let mut inputs = Inputs::new();
    for request in &plan.inputs {
        let source = &files[request.pointer.as_str()];
        inputs.push(Some(input(path.parent().unwrap(), source, request.role)));
    }
    run(&plan, inputs, &mut Silent).unwrap().result
}

/// Puts datasets, which a plan knows, in the places of files.
fn take_files(body: &mut Value) -> BTreeMap<&'static str, Value> {
    let mut files = BTreeMap::new();
    for pointer in ["/input", "/truth", "/tracks"] {
        if let Some(source) = body.pointer_mut(pointer)
            && source["source"] == "file"
        {
            let dataset = json!({"source": "dataset", "dataset_id": pointer});
            files.insert(pointer, std::mem::replace(source, dataset));
        }
    }
    files
}

fn input(folder: &Path, source: &Value, role: DatasetKind) -> Input {
    let name = source["path"].as_str().unwrap();
    let bytes = std::fs::read(folder.join(name)).unwrap();
    let format = match source["format"].as_str() {
        Some(format) => format_named(format),
        None => detect_format(name, &bytes),
    };
    let options = ReadOptions {
        kind: Some(role),
        ..ReadOptions::default()
    };
    let mut dataset = (format.unwrap().read)(&mut bytes.as_slice(), &options)
        .unwrap()
        .dataset;
    if let Some(sensor_ids) = source.get("sensor_ids") {
        let sensor_ids: Vec<String> = serde_json::from_value(sensor_ids.clone()).unwrap();
        dataset = dataset.only_sensors(&sensor_ids).unwrap();
    }
    Input {
        dataset,
        sensors: Vec::new(),
        sha256: String::new(),
    }
}

/// Numbers with the digits that are compared, long lists as [`Sum`]s between their ends.
fn condensed(value: &Value) -> Value {
    match value {
        Value::Array(items) if items.len() > LONGEST_LIST => {
            let mut sum = Sum::default();
            sum.add(value);
            json!({
                "entries": items.len(),
                "first": condensed(&items[0]),
                "last": condensed(&items[items.len() - 1]),
                "sum": rounded(sum.numbers),
                "words": format!("{:016x}", sum.words),
            })
        }
        Value::Array(items) => items.iter().map(condensed).collect(),
        Value::Object(members) => members
            .iter()
            .map(|(name, member)| (name.clone(), condensed(member)))
            .collect(),
        Value::Number(number) if number.is_f64() => json!(rounded(number.as_f64().unwrap())),
        _ => value.clone(),
    }
}

fn rounded(number: f64) -> f64 {
    format!("{number:.0$e}", DIGITS - 1).parse().unwrap()
}

/// What changes when anything in a list does.
#[derive(Default)]
struct Sum {
    numbers: f64,
    /// Of names, texts, truths and nulls in their order.
    words: u64,
}

impl Sum {
    fn add(&mut self, value: &Value) {
        match value {
            Value::Number(number) => self.numbers += number.as_f64().unwrap(),
            Value::Array(items) => items.iter().for_each(|item| self.add(item)),
            Value::Object(members) => {
                for (name, member) in members {
                    self.add_word(name);
                    self.add(member);
                }
            }
            Value::String(text) => self.add_word(text),
            Value::Bool(_) | Value::Null => self.add_word(&value.to_string()),
        }
    }

    /// FNV-1a.
    fn add_word(&mut self, word: &str) {
        for byte in word.bytes().chain([0]) {
            self.words = (self.words ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    }
}

/// One line for each member of a result, so that a change is seen where it is.
fn written(results: &Map<String, Value>) -> String {
    let mut jobs = Vec::new();
    for (name, result) in results {
        let mut members = Vec::new();
        for (member, value) in result.as_object().unwrap() {
            members.push(format!("{}: {value}", json!(member)));
        }
        jobs.push(format!("{}: {{\n{}\n}}", json!(name), members.join(",\n")));
    }
    format!("{{\n{}\n}}\n", jobs.join(",\n"))
}

fn compare(place: &str, stored: &Value, found: &Value, told: &mut Vec<String>) {
    match (stored, found) {
        (Value::Object(stored), Value::Object(found)) if stored.keys().eq(found.keys()) => {
            for (name, value) in stored {
                compare(&format!("{place}/{name}"), value, &found[name], told);
            }
        }
        (Value::Array(stored), Value::Array(found)) if stored.len() == found.len() => {
            for (index, (stored, found)) in stored.iter().zip(found).enumerate() {
                compare(&format!("{place}/{index}"), stored, found, told);
            }
        }
        (Value::Number(stored), Value::Number(found))
            if is_near(stored.as_f64().unwrap(), found.as_f64().unwrap()) => {}
        _ if stored == found => {}
        _ => {
            let [stored, found] = [stored, found].map(Value::to_string);
            told.push(format!(
                "{place}: {stored:.200} is stored, {found:.200} found"
            ));
        }
    }
}

fn is_near(stored: f64, found: f64) -> bool {
    (stored - found).abs() <= TOLERANCE * stored.abs().max(1.0)
}

#[test]
fn a_number_a_word_or_a_name_that_differs_is_told() {
    let stored = json!({"a": [1.0, "x"], "long": condensed(&json!([1, 2, 3, 4, 5, {"b": 6.0}]))});
    let same = json!({"a": [1.000_000_000_5, "x"], "long": condensed(&json!([1, 2, 3, 4, 5, {"b": 6.0}]))});
    let other = json!({"a": [1.1, "y"], "long": condensed(&json!([1, 2, 3, 4.1, 5, {"c": 6.0}]))});
    for (found, count) in [(same, 0), (other, 5), (json!({"a": []}), 1)] {
        let mut told = Vec::new();
        compare("", &stored, &found, &mut told);
        assert_eq!(told.len(), count, "{told:?}");
    }
}
