//! Several jobs side by side: the numbers of their reports, differences pair by pair, and where their requests differ.

mod data;
mod held;

pub use held::kept_limits;

use self::data::reads_other_data;
use super::metrics::{MetricTable, split_unit};
use crate::evaluation::metrics::direction::higher_is_better;
use crate::math::stats::{self, Interval};
use crate::service::types::{
    ComparedJob, ComparedNumber, ComparedVerdicts, Comparison, DifferenceVerdict, PairedDifference,
    PairedNumber, PairedOver, RequestDifference,
};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Parts of a result whose numbers are compared, besides those of the metrics.
const PARTS: [&str; 13] = [
    "counts",
    "association.counts",
    "association.nis",
    "tfa.counts",
    "tfa.probability",
    "tfa.ratios",
    "grouping.accuracy",
    "grouping.precision",
    "grouping.recall",
    "cost",
    "dual_bound",
    "gap",
    "truth",
];

/// What is known of one job.
#[derive(Debug, Clone)]
pub struct Side {
    pub job: ComparedJob,
    pub spec: Value,
    pub result: Value,
    pub metrics: MetricTable,
    /// `metric-truths.csv`: what metrics say of each target.
    pub truths: Option<Vec<u8>>,
    /// `runs.csv` of a campaign.
    pub runs: Option<Vec<u8>>,
}

/// Values of one name, by what they are paired over.
type Values = BTreeMap<String, f64>;

/// `baseline` is the place of the job that the others are compared with.
pub fn of(sides: &[Side], baseline: usize, confidence: f64) -> Comparison {
    let directions = directions(&sides[baseline].spec);
    let mut paired = Vec::new();
    for (columns, over) in [
        (runs_of as fn(&Side) -> Columns, PairedOver::Runs),
        (targets_of, PairedOver::Targets),
        (steps_of, PairedOver::Steps),
    ] {
        let of_sides: Vec<Columns> = sides.iter().map(columns).collect();
        paired.extend(self::paired(
            &of_sides,
            &directions,
            (baseline, confidence),
            over,
        ));
    }
    Comparison {
        jobs: sides.iter().map(|side| side.job.clone()).collect(),
        baseline: sides[baseline].job.id,
        confidence,
        numbers: numbers(sides, &sides[baseline].spec),
        paired,
        verdicts: verdicts(sides, baseline),
        request: request_differences(sides),
        notes: notes(sides),
    }
}

/// The metrics of one job that another does not have.
pub fn lost_metrics(side: &Side, other: &Side) -> Vec<String> {
    let has = |side: &Side, name: &str| side.result["metrics"].get(name).is_some();
    let metrics = side.result["metrics"].as_object().into_iter().flatten();
    let names = metrics.map(|(name, _)| name.clone());
    names.filter(|name| !has(other, name)).collect()
}

/// A number and its unit, by path.
fn numbers_of(result: &Value) -> BTreeMap<String, (f64, String)> {
    let plain = |(path, value)| (path, (value, String::new()));
    let mut found: BTreeMap<_, _> = held::values_of(result).map(plain).collect();
    for part in PARTS {
        let Some(place) = part
            .split('.')
            .try_fold(result, |place, step| place.get(step))
        else {
            continue;
        };
        let fields = place
            .as_object()
            .into_iter()
            .flatten()
            .map(|(name, value)| (format!("{part}.{name}"), value));
        let alone = [(part.to_owned(), place)];
        found.extend(
            fields
                .chain(alone)
                .filter_map(|(path, value)| Some((path, (value.as_f64()?, String::new())))),
        );
    }
    for (metric, report) in result["metrics"].as_object().into_iter().flatten() {
        for (name, quantity) in report["quantities"].as_object().into_iter().flatten() {
            if let Some(value) = quantity["value"].as_f64() {
                let unit = quantity["unit"].as_str().unwrap_or_default().to_owned();
                found.insert(format!("metrics.{metric}.quantities.{name}"), (value, unit));
            }
        }
    }
    found
}

/// `spec` is the baseline's.
fn numbers(sides: &[Side], spec: &Value) -> Vec<ComparedNumber> {
    let of_sides: Vec<_> = sides.iter().map(|side| numbers_of(&side.result)).collect();
    let paths: BTreeSet<&String> = of_sides.iter().flat_map(BTreeMap::keys).collect();
    let number = |path: &String| {
        let values: Vec<Option<f64>> = of_sides
            .iter()
            .map(|side| side.get(path).map(|(value, _)| *value))
            .collect();
        let unit = of_sides
            .iter()
            .find_map(|side| Some(side.get(path)?.1.clone()))
            .unwrap_or_default();
        (values.iter().flatten().count() > 1).then(|| ComparedNumber {
            path: path.clone(),
            unit,
            higher_is_better: held::better(path, spec),
            values,
        })
    };
    paths.into_iter().filter_map(number).collect()
}

/// A column to be paired: its cell (of campaigns) and its name.
type Key = (Option<String>, String);

/// Its unit, and its values by what they are paired over, in order.
type Column = (String, Vec<(String, f64)>);

type Columns = BTreeMap<Key, Column>;

fn runs_of(side: &Side) -> Columns {
    let mut columns = Columns::new();
    let Some(bytes) = &side.runs else {
        return columns;
    };
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    let Ok(header) = reader.headers().cloned() else {
        return columns;
    };
    for record in reader.records().flatten() {
        for (name, cell) in header.iter().zip(record.iter()).skip(3) {
            let Ok(value) = cell.parse() else { continue };
            let (_, values) = columns
                .entry((Some(record[0].to_owned()), name.to_owned()))
                .or_default();
            values.push((record[1].to_owned(), value));
        }
    }
    columns
}

/// Which way outcomes of a campaign are better, by the names that people gave them.
fn directions(spec: &Value) -> BTreeMap<String, Option<bool>> {
    let mut found = BTreeMap::new();
    for outcome in spec["outcomes"].as_array().into_iter().flatten() {
        if let Some(path) = outcome["path"].as_str() {
            let name = outcome["name"].as_str().unwrap_or(path);
            found.insert(name.to_owned(), held::better(path, spec));
        }
    }
    found
}

/// Columns of `metric-truths.csv`, by the targets.
fn targets_of(side: &Side) -> Columns {
    let mut columns = Columns::new();
    let Some(bytes) = &side.truths else {
        return columns;
    };
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    let Ok(header) = reader.headers().cloned() else {
        return columns;
    };
    let names = usize::from(header.get(0) == Some("sequence")) + 1;
    for record in reader.records().flatten() {
        let target = record.iter().take(names).collect::<Vec<_>>().join(" ");
        for (label, cell) in header.iter().zip(record.iter()).skip(names) {
            let Ok(value) = cell.parse() else { continue };
            let (name, unit, _) = split_unit(label);
            let column = columns.entry((None, name)).or_default();
            column.0 = unit;
            column.1.push((target.clone(), value));
        }
    }
    columns
}

fn steps_of(side: &Side) -> Columns {
    let table = &side.metrics;
    let keys: Vec<String> = table
        .sequences
        .iter()
        .zip(&table.time_s)
        .map(|(sequence, time_s)| format!("{sequence} {time_s}"))
        .collect();
    let column = |(name, unit, values): &(String, String, Vec<Option<f64>>)| {
        let known = keys
            .iter()
            .zip(values)
            .filter_map(|(key, value)| Some((key.clone(), (*value)?)));
        ((None, name.clone()), (unit.clone(), known.collect()))
    };
    table.columns.iter().map(column).collect()
}

fn paired(
    sides: &[Columns],
    directions: &BTreeMap<String, Option<bool>>,
    (baseline, confidence): (usize, f64),
    over: PairedOver,
) -> Vec<PairedNumber> {
    let number = |(key, (unit, theirs)): (&Key, &Column)| {
        let theirs: Values = theirs.iter().cloned().collect();
        let better = directions
            .get(&key.1)
            .copied()
            .unwrap_or_else(|| higher_is_better(&key.1));
        let difference = |(index, side): (usize, &Columns)| {
            let (_, ours) = side.get(key).filter(|_| index != baseline)?;
            let found = if over == PairedOver::Steps {
                let ours = filled(&key.1, ours, &theirs);
                let all: Vec<(String, f64)> = theirs.clone().into_iter().collect();
                let theirs = filled(&key.1, &all, &ours.iter().cloned().collect());
                difference(&ours, &theirs.into_iter().collect(), confidence, over)?
            } else {
                difference(ours, &theirs, confidence, over)?
            };
            Some(PairedDifference {
                verdict: verdict(found.interval, better),
                ..found
            })
        };
        let differences: Vec<_> = sides.iter().enumerate().map(difference).collect();
        let mean = |side: &Columns| {
            stats::mean(
                &side
                    .get(key)?
                    .1
                    .iter()
                    .map(|(_, value)| *value)
                    .collect::<Vec<_>>(),
            )
        };
        let means = sides.iter().map(mean).collect();
        let (cell, name) = key.clone();
        differences
            .iter()
            .any(Option::is_some)
            .then(|| PairedNumber {
                name,
                cell,
                over,
                unit: unit.clone(),
                higher_is_better: better,
                means,
                differences,
            })
    };
    sides[baseline].iter().filter_map(number).collect()
}

/// Names of metrics of which a step that a job does not have is one without any error: nobody was due and nobody there.
const NOTHING_AT_OTHER_STEPS: [&str; 4] = ["gospa", "ospa", "labelled_ospa", "t_gospa"];
/// Numbers that are 0 at such a step, of whichever metric.
const NOTHING_OF_A_STEP: [&str; 15] = [
    "associated",
    "association",
    "divergences",
    "fn",
    "fp",
    "idfn",
    "idfp",
    "idsw",
    "idtp",
    "missed",
    "redundant",
    "spuriousness",
    "swaps",
    "tp",
    "unassigned",
];

/// Values by step, with 0 at the steps that the other side alone has, where that is what they would be.
fn filled(name: &str, ours: &[(String, f64)], theirs: &Values) -> Vec<(String, f64)> {
    let mut filled = ours.to_vec();
    let (metric, number) = name.split_once('.').unwrap_or((name, name));
    // The second one of a name is `gospa_2`.
    let counted = metric
        .rsplit_once('_')
        .filter(|(_, count)| count.parse::<u32>().is_ok());
    let metric = counted.map_or(metric, |(plain, _)| plain);
    if NOTHING_AT_OTHER_STEPS.contains(&metric) || NOTHING_OF_A_STEP.contains(&number) {
        let known: BTreeSet<&String> = ours.iter().map(|(key, _)| key).collect();
        let missing = theirs.keys().filter(|key| !known.contains(key));
        filled.extend(missing.map(|key| (key.clone(), 0.0)));
    }
    filled
}

fn difference(
    ours: &[(String, f64)],
    theirs: &Values,
    confidence: f64,
    over: PairedOver,
) -> Option<PairedDifference> {
    let pairs: Vec<f64> = ours
        .iter()
        .filter_map(|(key, value)| Some(value - theirs.get(key)?))
        .collect();
    let values = if over == PairedOver::Steps {
        batch_means(&pairs)
    } else {
        pairs.clone()
    };
    let count = |is_one: fn(&f64) -> bool| pairs.iter().filter(|pair| is_one(pair)).count() as u64;
    Some(PairedDifference {
        pairs: pairs.len() as u64,
        mean: stats::mean(&pairs)?,
        interval: stats::t_interval(&values, confidence),
        smaller: count(|pair| *pair < 0.0),
        larger: count(|pair| *pair > 0.0),
        verdict: None,
    })
}

fn verdict(
    interval: Option<Interval>,
    higher_is_better: Option<bool>,
) -> Option<DifferenceVerdict> {
    let (interval, higher_is_better) = (interval?, higher_is_better?);
    let is_larger = interval.low > 0.0;
    if !is_larger && interval.high >= 0.0 {
        return Some(DifferenceVerdict::NotSignificant);
    }
    Some(if is_larger == higher_is_better {
        DifferenceVerdict::Better
    } else {
        DifferenceVerdict::Worse
    })
}

/// Means of ⌊√n⌋ batches of values that follow each other, as equal in size as they can be: nearly independent where the batches
/// are longer than the memory of the values.
fn batch_means(values: &[f64]) -> Vec<f64> {
    let batches = values.len().isqrt();
    let edge = |batch: usize| batch * values.len() / batches.max(1);
    (0..batches)
        .filter_map(|batch| stats::mean(&values[edge(batch)..edge(batch + 1)]))
        .collect()
}

/// Whether each target was followed correctly; `None` without verdicts.
fn correct_targets(side: &Side) -> Option<BTreeMap<&str, bool>> {
    let targets = side.result.pointer("/tfa/targets")?.as_array()?;
    Some(
        targets
            .iter()
            .filter_map(|target| {
                Some((target["truth_id"].as_str()?, target["verdict"] == "correct"))
            })
            .collect(),
    )
}

fn verdicts(sides: &[Side], baseline: usize) -> Option<Vec<ComparedVerdicts>> {
    let theirs = correct_targets(&sides[baseline])?;
    let compared = |(_, side): (usize, &Side)| {
        let ours = correct_targets(side)?;
        let both: Vec<(bool, bool)> = ours
            .iter()
            .filter_map(|(target, ours)| Some((*ours, *theirs.get(target)?)))
            .collect();
        let count =
            |wanted: (bool, bool)| both.iter().filter(|pair| **pair == wanted).count() as u64;
        let (both_correct, gained, lost) = (
            count((true, true)),
            count((true, false)),
            count((false, true)),
        );
        Some(ComparedVerdicts {
            job_id: side.job.id,
            targets: both.len() as u64,
            both_correct,
            gained,
            lost,
        })
    };
    Some(
        sides
            .iter()
            .enumerate()
            .filter(|(index, _)| *index != baseline)
            .filter_map(compared)
            .collect(),
    )
}

/// Every plain value of a request by its JSON pointer.
fn leaves(value: &Value, pointer: String, found: &mut BTreeMap<String, String>) {
    let escaped = |step: &str| step.replace('~', "~0").replace('/', "~1");
    match value {
        Value::Object(fields) if !fields.is_empty() => {
            fields.iter().for_each(|(name, field)| {
                leaves(field, format!("{pointer}/{}", escaped(name)), found)
            });
        }
        Value::Array(items) if !items.is_empty() => {
            items
                .iter()
                .enumerate()
                .for_each(|(index, item)| leaves(item, format!("{pointer}/{index}"), found));
        }
        plain => {
            found.insert(pointer, plain.to_string());
        }
    }
}

fn request_differences(sides: &[Side]) -> Vec<RequestDifference> {
    let mut of_sides = vec![BTreeMap::new(); sides.len()];
    sides
        .iter()
        .zip(&mut of_sides)
        .for_each(|(side, found)| leaves(&side.spec, String::new(), found));
    let pointers: BTreeSet<&String> = of_sides.iter().flat_map(BTreeMap::keys).collect();
    let row = |pointer: &String| {
        let values: Vec<Option<String>> = of_sides
            .iter()
            .map(|side| side.get(pointer).cloned())
            .collect();
        values
            .iter()
            .any(|value| *value != values[0])
            .then(|| RequestDifference {
                pointer: pointer.clone(),
                values,
            })
    };
    pointers.into_iter().filter_map(row).collect()
}

fn notes(sides: &[Side]) -> Vec<String> {
    let mut notes = Vec::new();
    if sides.iter().any(|side| side.job.kind != sides[0].job.kind) {
        notes.push("the jobs are of different kinds: only what they share is compared".to_owned());
    }
    if sides.iter().any(|side| side.job.seed != sides[0].job.seed) {
        notes.push("the jobs have different seeds: what was drawn differs, so that pairs are not of the same scene".to_owned());
    }
    if sides.iter().any(|side| reads_other_data(side, &sides[0])) {
        notes.push(
            "the jobs read different data or scenes: see where the requests differ".to_owned(),
        );
    }
    notes
}

#[cfg(test)]
mod tests;
