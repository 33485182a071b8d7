//! Numbers made again from the files of a job, as its report says (`from`), by what a reader of the files has: their text.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use trackloom_domain::experiment::Outcome;

struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    fn place(&self, column: &str) -> usize {
        self.header
            .iter()
            .position(|name| name == column)
            .unwrap_or_else(|| panic!("no column {column} in {:?}", self.header))
    }
}

pub struct Files(BTreeMap<String, Table>);

/// The rows that count: of one sequence, of one step.
#[derive(Debug, Clone, Copy, Default)]
pub struct Scope<'a> {
    pub sequence: Option<&'a str>,
    pub time_s: Option<&'a str>,
}

/// A metric of the report.
pub struct Metric<'a> {
    pub files: &'a Files,
    pub from: &'a [Value],
}

impl Files {
    pub fn of(outcome: &Outcome) -> Files {
        let tables = outcome
            .artifacts
            .iter()
            .filter(|file| file.media_type == "text/csv" && file.dataset.is_none())
            .map(|file| {
                let mut reader = csv::Reader::from_reader(&file.bytes[..]);
                let header = reader.headers().unwrap().iter().map(String::from).collect();
                let rows = reader
                    .records()
                    .map(|row| row.unwrap().iter().map(String::from).collect())
                    .collect();
                (file.name.to_owned(), Table { header, rows })
            });
        Files(tables.collect())
    }

    fn rows(&self, file: &str, scope: Scope) -> (&Table, Vec<&Vec<String>>) {
        let table = self.0.get(file).unwrap_or_else(|| panic!("no file {file}"));
        let wanted = [("sequence", scope.sequence), ("time_s", scope.time_s)];
        let wanted: Vec<(usize, &str)> = wanted
            .iter()
            .filter_map(|(name, value)| value.map(|value| (table.place(name), value)))
            .collect();
        (
            table,
            table
                .rows
                .iter()
                .filter(|row| wanted.iter().all(|&(place, value)| row[place] == value))
                .collect(),
        )
    }

    /// The cells of a column in `metric-series.csv`, with their times.
    pub fn series(&self, column: &str, scope: Scope) -> Vec<(String, Option<f64>)> {
        let (table, rows) = self.rows("metric-series.csv", scope);
        let (time, place) = (table.place("time_s"), table.place(column));
        rows.iter()
            .map(|row| (row[time].clone(), row[place].parse().ok()))
            .collect()
    }

    pub fn series_columns(&self) -> &[String] {
        &self.0["metric-series.csv"].header
    }

    /// Each match of a metric that reaches threshold `k`: its row, its similarity, its truth and its track.
    fn reaching(&self, entry: &Value, k: usize, scope: Scope) -> Vec<(f64, [String; 3])> {
        let (table, rows) = self.rows(text(entry, "file"), scope);
        let of_rows = rows.iter().filter(|row| {
            row[table.place(text(entry, "column"))]
                .parse::<f64>()
                .is_ok_and(|count| count >= k as f64)
        });
        let cell = |row: &Vec<String>, column: &str| row[table.place(column)].clone();
        let name = |row: &Vec<String>| {
            scope
                .sequence
                .map_or_else(|| self.sequence_of(table, row), String::from)
        };
        of_rows
            .map(|row| {
                (
                    cell(row, "similarity").parse().unwrap(),
                    [name(row), cell(row, "truth_id"), cell(row, "track_id")],
                )
            })
            .collect()
    }

    fn sequence_of(&self, table: &Table, row: &[String]) -> String {
        if table.header[0] == "sequence" {
            row[0].clone()
        } else {
            String::new()
        }
    }

    /// Points of a truth or a track: rows of the log.
    fn points(&self, events: &[&str], column: &str, [sequence, id]: [&str; 2]) -> f64 {
        let (table, rows) = self.rows("events.csv", Scope::default());
        let is_of = |row: &&&Vec<String>| {
            events.contains(&row[table.place("event")].as_str())
                && row[table.place(column)] == id
                && self.sequence_of(table, row) == sequence
        };
        rows.iter().filter(is_of).count() as f64
    }
}

fn text<'v>(entry: &'v Value, key: &str) -> &'v str {
    entry[key]
        .as_str()
        .unwrap_or_else(|| panic!("no {key} in {entry}"))
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

impl Metric<'_> {
    fn entry(&self, name: &str) -> Option<&Value> {
        self.from.iter().find(|entry| entry["quantity"] == name)
    }

    /// The number of this name, made again; `None` where it is 0 / 0.
    ///
    /// `series.x` wants a scope with a time.
    pub fn number(&self, name: &str, scope: Scope) -> Option<f64> {
        let plain = name.strip_prefix("series.");
        let scope = if plain.is_some() {
            scope
        } else {
            Scope {
                time_s: None,
                ..scope
            }
        };
        let (entry, prefix) = match (self.entry(name), plain.and_then(|plain| self.entry(plain))) {
            (Some(entry), _) => (entry, ""),
            (None, Some(entry)) => (entry, "series."),
            (None, None) => panic!("nothing says how {name} is made"),
        };
        if entry.get("file").is_some() {
            self.of_rows(entry, scope)
        } else {
            self.of_numbers(entry, prefix, scope)
        }
    }

    fn of_rows(&self, entry: &Value, scope: Scope) -> Option<f64> {
        let (table, rows) = self.files.rows(text(entry, "file"), scope);
        let events = entry.pointer("/filter/event").and_then(Value::as_array);
        let rows = rows.into_iter().filter(|row| {
            events.is_none_or(|events| {
                events
                    .iter()
                    .any(|event| *event == row[table.place("event")])
            })
        });
        let Some(column) = entry["column"].as_str() else {
            if entry["statistic"] == "count_steps" {
                let step = |row: &Vec<String>| {
                    (
                        self.files.sequence_of(table, row),
                        row[table.place("step")].clone(),
                    )
                };
                return Some(rows.map(step).collect::<BTreeSet<_>>().len() as f64);
            }
            assert_eq!(entry["statistic"], "count");
            return Some(rows.count() as f64);
        };
        let rows: Vec<&Vec<String>> = rows
            .filter(|row| !row[table.place(column)].is_empty())
            .collect();
        let cell =
            |row: &Vec<String>, column: &str| row[table.place(column)].parse::<f64>().unwrap();
        let values: Vec<f64> = rows.iter().map(|row| cell(row, column)).collect();
        let is_within = |row: &&&Vec<String>| {
            let bound = |end: &str| cell(row, &format!("{column}_{end}"));
            (bound("lower")..=bound("upper")).contains(&cell(row, column))
        };
        match text(entry, "statistic") {
            "count" => Some(values.len() as f64),
            "count_positive" => Some(values.iter().filter(|value| **value > 0.0).count() as f64),
            "sum" => Some(values.iter().sum()),
            "mean" => mean(&values),
            "root_mean_square" => mean(
                &values
                    .iter()
                    .map(|value| value * value)
                    .collect::<Vec<f64>>(),
            )
            .map(f64::sqrt),
            "nearest_rank95" => nearest_rank_95(values),
            "share_within" => (!rows.is_empty())
                .then(|| rows.iter().filter(is_within).count() as f64 / rows.len() as f64),
            other => panic!("{other} is no statistic of rows"),
        }
    }

    /// `prefix` stands in front of the numbers that the entry names.
    fn of_numbers(&self, entry: &Value, prefix: &str, scope: Scope) -> Option<f64> {
        let names = |key: &str| {
            entry[key]
                .as_array()
                .into_iter()
                .flatten()
                .map(|name| name.as_str().unwrap())
                .collect::<Vec<_>>()
        };
        let signed = |name: &str| match name.strip_prefix('-') {
            Some(name) => self
                .number(&format!("{prefix}{name}"), scope)
                .map(|number| -number),
            None => self.number(&format!("{prefix}{name}"), scope),
        };
        if let Some(curve) = names("over")[0].strip_prefix("curves.") {
            return match text(entry, "statistic") {
                "mean_of_curve" => mean(
                    &self
                        .curve(curve, scope)
                        .into_iter()
                        .collect::<Option<Vec<f64>>>()?,
                ),
                "first_of_curve" => self.curve(curve, scope)[0],
                other => panic!("{other} is no statistic of a curve"),
            };
        }
        let over: Vec<f64> = names("over")
            .into_iter()
            .map(signed)
            .collect::<Option<_>>()?;
        let under = if entry.get("under").is_some() {
            names("under")
                .into_iter()
                .map(signed)
                .sum::<Option<f64>>()?
        } else {
            1.0
        };
        let option = |key: &str| entry[key].as_f64().unwrap_or(1.0);
        match text(entry, "statistic") {
            "ratio" => (under != 0.0)
                .then(|| option("factor") * root(over.iter().sum::<f64>() / under, option("root"))),
            "largest" => over.into_iter().reduce(f64::max),
            "log10" => Some(over[0].max(1.0).log10()),
            "product" => Some(over.iter().product()),
            other => panic!("{other} is no statistic of numbers"),
        }
    }

    /// The 19 values of a curve.
    pub fn curve(&self, name: &str, scope: Scope) -> Vec<Option<f64>> {
        (1..=19)
            .map(|k| self.at(&format!("curves.{name}"), k, scope))
            .collect()
    }

    /// A curve's value at threshold `k`, counted from 1.
    fn at(&self, name: &str, k: usize, scope: Scope) -> Option<f64> {
        if !name.starts_with("curves.") {
            return self.number(name, scope);
        }
        let entry = self
            .entry(name)
            .unwrap_or_else(|| panic!("nothing says how {name} is made"));
        if entry.get("file").is_some() {
            return self.of_matches(entry, k, scope);
        }
        let sum = |key: &str| {
            let names = entry[key]
                .as_array()
                .into_iter()
                .flatten()
                .map(|name| name.as_str().unwrap());
            names.map(|name| {
                Some(if let Some(name) = name.strip_prefix('-') {
                    -self.at(name, k, scope)?
                } else {
                    self.at(name, k, scope)?
                })
            })
        };
        match text(entry, "statistic") {
            "ratio" => {
                let under = if entry.get("under").is_some() {
                    sum("under").sum::<Option<f64>>()?
                } else {
                    1.0
                };
                let over = sum("over").sum::<Option<f64>>()?;
                (under != 0.0).then(|| over / under)
            }
            "geometric_mean" => Some(sum("over").product::<Option<f64>>()?.sqrt()),
            other => panic!("{other} is no statistic of curves"),
        }
    }

    fn of_matches(&self, entry: &Value, k: usize, scope: Scope) -> Option<f64> {
        let matches = self.files.reaching(entry, k, scope);
        let mut together: BTreeMap<&[String; 3], f64> = BTreeMap::new();
        matches
            .iter()
            .for_each(|(_, ids)| *together.entry(ids).or_default() += 1.0);
        let truth_points = |[sequence, truth, _]: &[String; 3]| {
            self.files
                .points(&["match", "miss"], "truth_id", [sequence, truth])
        };
        let track_points = |[sequence, _, track]: &[String; 3]| {
            self.files.points(
                &["match", "false_alarm", "redundant", "divergence"],
                "track_id",
                [sequence, track],
            )
        };
        let association = |under: &dyn Fn(&[String; 3], f64) -> f64| {
            let sum = together
                .iter()
                .map(|(ids, count)| count * count / under(ids, *count))
                .sum::<f64>();
            if matches.is_empty() {
                0.0
            } else {
                sum / matches.len() as f64
            }
        };
        Some(match text(entry, "statistic") {
            "count_reaching" => matches.len() as f64,
            "mean_reaching" => mean(
                &matches
                    .iter()
                    .map(|(similarity, _)| *similarity)
                    .collect::<Vec<f64>>(),
            )
            .unwrap_or(1.0),
            "association_jaccard" => {
                association(&|ids, count| truth_points(ids) + track_points(ids) - count)
            }
            "association_recall" => association(&|ids, _| truth_points(ids)),
            "association_precision" => association(&|ids, _| track_points(ids)),
            other => panic!("{other} is no statistic of matches"),
        })
    }
}

/// Rounding may leave the inside of a root just below 0.
fn root(inside: f64, order: f64) -> f64 {
    if order == 1.0 {
        inside
    } else {
        inside.max(0.0).powf(1.0 / order)
    }
}

fn nearest_rank_95(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let rank = (values.len() * 95).div_ceil(100).checked_sub(1)?;
    Some(values[rank])
}
