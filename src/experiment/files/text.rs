//! Tables of fixed-width columns, for terminals and text files.

use serde_json::Value;

/// Lines of a table: the first column to the left, the others to the right, as wide as their widest cell.
pub fn table(header: &[&str], rows: &[Vec<String>]) -> String {
    let width = |column: usize| {
        let cells = rows
            .iter()
            .filter_map(|row| row.get(column))
            .map(|cell| cell.chars().count());
        cells
            .chain([header[column].chars().count()])
            .max()
            .unwrap_or(0)
    };
    let widths: Vec<usize> = (0..header.len()).map(width).collect();
    let line = |cells: Vec<&str>| {
        let place = |(column, cell): (usize, &&str)| {
            let width = widths[column];
            if column == 0 {
                format!("{cell:<width$}")
            } else {
                format!("{cell:>width$}")
            }
        };
        cells
            .iter()
            .enumerate()
            .map(place)
            .collect::<Vec<_>>()
            .join("  ")
            .trim_end()
            .to_owned()
    };
    let mut lines = vec![line(header.to_vec())];
    lines.push(
        widths
            .iter()
            .map(|&width| "─".repeat(width))
            .collect::<Vec<_>>()
            .join("  "),
    );
    lines.extend(
        rows.iter()
            .map(|row| line(row.iter().map(String::as_str).collect())),
    );
    lines.join("\n")
}

/// A number of a report as text: whole numbers as they are, others with three decimals and small ones with three digits,
/// absent ones as `–`.
pub fn cell(value: &Value) -> String {
    match value {
        Value::Null => "–".to_owned(),
        Value::Number(number) if number.is_f64() => {
            number.as_f64().map_or_else(String::new, decimal)
        }
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

fn decimal(number: f64) -> String {
    // Zero has no sign.
    let number = number + 0.0;
    match number.abs() {
        size if size == size.trunc() && size < 1e15 => format!("{number}"),
        size if size < 1e-3 => format!("{number:.3e}"),
        _ => format!("{number:.3}"),
    }
}

/// What was judged, in a sentence a line: at which steps, how points were put side by side, what was left out. `None` of a
/// result that judges nothing.
pub fn judged(result: &Value) -> Option<String> {
    let head = result.get("comparison").filter(|head| head.is_object())?;
    let period = match head["period_s"].as_f64() {
        Some(period_s) => format!(", one in {} s", decimal(period_s)),
        None => String::new(),
    };
    let unit = cell(&head["gate_unit"]);
    let gate = match head["gate"].as_f64() {
        Some(gate) => format!("{gate} {unit}").trim_end().to_owned(),
        None => "none".to_owned(),
    };
    let mut lines = vec![
        format!(
            "judged at {} steps ({}{period}), {} of them with truth",
            cell(&head["step_count"]),
            cell(&head["steps"]),
            cell(&head["due_steps"])
        ),
        format!(
            "gate {gate}, alignment {}, credit {}",
            cell(&head["alignment"]),
            cell(&head["credit"])
        ),
    ];
    let mut left_out = Vec::new();
    for (name, words) in LEFT_OUT {
        let count = head[name].as_u64().unwrap_or(0);
        if count > 0 {
            left_out.push(format!("{count} {words}"));
        }
    }
    if !left_out.is_empty() {
        lines.push(format!("left out: {}", left_out.join(", ")));
    }
    Some(lines.join("\n"))
}

/// What the head of a comparison counts, in words.
const LEFT_OUT: [(&str, &str); 4] = [
    ("points_between_steps", "points between steps"),
    (
        "points_not_known_then",
        "points of tracks before they were known",
    ),
    (
        "truth_points_left_out",
        "points of the truth outside what is judged",
    ),
    (
        "track_points_left_out",
        "points of tracks outside what is judged",
    ),
];

/// The shares of the automaton without forgiven errors: of what, how many, the value.
pub fn shares(result: &Value) -> Vec<(String, &Value)> {
    let shares = result.pointer("/tfa/shares").and_then(Value::as_array);
    let strict = shares
        .into_iter()
        .flatten()
        .filter(|share| share["forgiven"] == 0);
    let row = |share: &'_ Value| {
        let of = cell(&share["of"]).replace('_', " ");
        let (part, whole) = (cell(&share["numerator"]), cell(&share["denominator"]));
        format!("tfa {}, {part} of {whole} {of}", cell(&share["name"]))
    };
    strict.map(|share| (row(share), &share["value"])).collect()
}

/// The metrics of a result: each quantity with its value and unit; with several sequences, a column for each and one for
/// all together. `None` when the result has no metrics.
pub fn metrics(result: &Value) -> Option<String> {
    let together = result["metrics"]
        .as_object()
        .filter(|metrics| !metrics.is_empty())?;
    let sequences = result["sequences"]
        .as_array()
        .map(Vec::as_slice)
        .unwrap_or_default();
    let mut header = vec![
        "metric",
        "unit",
        if sequences.is_empty() {
            "value"
        } else {
            "combined"
        },
    ];
    header.extend(
        sequences
            .iter()
            .map(|sequence| sequence["name"].as_str().unwrap_or_default()),
    );
    let mut rows = Vec::new();
    for (metric, report) in together {
        for (name, quantity) in report["quantities"].as_object().into_iter().flatten() {
            let mut row = vec![
                format!("{metric} {}", name.replace('_', " ")),
                cell(&quantity["unit"]),
                cell(&quantity["value"]),
            ];
            row.extend(
                sequences.iter().map(|sequence| {
                    cell(&sequence["metrics"][metric]["quantities"][name]["value"])
                }),
            );
            rows.push(row);
        }
    }
    Some(table(&header, &rows))
}

/// The requirements of a result: sector, name, value, threshold, margin, verdict. `None` when it has none.
pub fn requirements(result: &Value) -> Option<String> {
    let findings = result.pointer("/requirements/findings")?.as_array()?;
    let header = [
        "requirement",
        "unit",
        "value",
        "wanted",
        "margin",
        "verdict",
    ];
    let mut rows = Vec::new();
    for finding in findings {
        let of = |name: &str| cell(&finding[name]);
        let phase = finding["phase"]
            .as_str()
            .map(|phase| format!(", {phase}"))
            .unwrap_or_default();
        let wanted = finding["comparison"]
            .as_str()
            .map(|comparison| format!("{comparison} {}", of("threshold")));
        rows.push(vec![
            format!("{} {}{phase}", of("sector_id"), of("requirement")),
            of("unit"),
            of("value"),
            wanted.unwrap_or_default(),
            of("margin"),
            of("verdict"),
        ]);
    }
    Some(table(&header, &rows))
}

/// The tuples of a result: the track of each sensor, cost and p-value, below J, its bound and the gap. `None` when the result has
/// no tuples.
pub fn correlation(result: &Value) -> Option<String> {
    let tuples = result["tuples"].as_array()?;
    let sensors: Vec<&str> = result["sensors"]
        .as_array()?
        .iter()
        .filter_map(|sensor| sensor["sensor_id"].as_str())
        .collect();
    let mut header = vec!["system track"];
    header.extend(&sensors);
    header.extend(["cost", "b", "Q", "degrees", "p-value"]);
    let row = |tuple: &Value| {
        let tracks = tuple["tracks"].as_array().into_iter().flatten().map(cell);
        let numbers = ["cost", "b", "statistic", "degrees_of_freedom", "p_value"]
            .map(|name| cell(&tuple[name]));
        std::iter::once(cell(&tuple["system_track_id"]))
            .chain(tracks)
            .chain(numbers)
            .collect::<Vec<_>>()
    };
    let head = ["cost", "dual_bound", "gap"]
        .map(|name| format!("{} {}", name.replace('_', " "), cell(&result[name])))
        .join(", ");
    Some(format!(
        "{} by {}: {head}\n{}",
        cell(&result["statistic"]),
        cell(&result["correlator"]),
        table(&header, &tuples.iter().map(row).collect::<Vec<_>>())
    ))
}

/// The cells of a campaign's report: each outcome's mean with its interval, and how long deciding took beside the cell that
/// it is compared with; below them the differences to that cell. `None` when there are no cells.
pub fn campaign(report: &Value) -> Option<String> {
    let cells = report["result"]["cells"].as_array()?;
    let names: Vec<&str> = report["result"]["outcomes"]
        .as_array()?
        .iter()
        .filter_map(Value::as_str)
        .collect();
    let times = report["timing"]["cells"]
        .as_array()
        .map(Vec::as_slice)
        .unwrap_or_default();
    let mut header = vec!["cell", "runs"];
    header.extend(&names);
    header.extend(["µs a scan", "time ratio"]);
    let row = |line: &Value| {
        let time = times
            .iter()
            .find(|time| time["cell"] == line["name"])
            .unwrap_or(&Value::Null);
        let outcomes = names
            .iter()
            .map(|&name| with_interval(&line["outcomes"][name]));
        let times = [&time["decide_us_per_scan"], &time["ratio"]].map(cell);
        [&line["name"], &line["runs"]]
            .map(cell)
            .into_iter()
            .chain(outcomes)
            .chain(times)
            .collect::<Vec<_>>()
    };
    let text = table(&header, &cells.iter().map(row).collect::<Vec<_>>());
    Some(match differences(cells, &names) {
        Some(differences) => format!("{text}\n\n{differences}"),
        None => text,
    })
}

/// What each cell has more than the one it is compared with, run by run. `None` where none is compared.
fn differences(cells: &[Value], names: &[&str]) -> Option<String> {
    let compared: Vec<&Value> = cells
        .iter()
        .filter(|line| line["compared_with"].is_string())
        .collect();
    let header: Vec<&str> = ["difference, run by run", "pairs"]
        .into_iter()
        .chain(names.iter().copied())
        .collect();
    let row = |line: &&Value| {
        let name = format!("{} − {}", cell(&line["name"]), cell(&line["compared_with"]));
        let pairs = names
            .iter()
            .filter_map(|&name| line["differences"][name]["pairs"].as_u64())
            .max();
        let outcomes = names
            .iter()
            .map(|&name| with_interval(&line["differences"][name]));
        [name, cell(&pairs.into())]
            .into_iter()
            .chain(outcomes)
            .collect::<Vec<_>>()
    };
    (!compared.is_empty()).then(|| table(&header, &compared.iter().map(row).collect::<Vec<_>>()))
}

/// `0.987 [0.978, 0.993]`.
fn with_interval(summary: &Value) -> String {
    match &summary["interval"] {
        Value::Null => cell(&summary["mean"]),
        interval => format!(
            "{} [{}, {}]",
            cell(&summary["mean"]),
            cell(&interval["low"]),
            cell(&interval["high"])
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_head_says_what_was_judged() {
        let mut result = json!({
            "comparison": {
                "steps": "the scans of the recording", "period_s": 8.0, "step_count": 30, "due_steps": 28, "gate": 1000.0, "gate_unit": "m",
                "alignment": "interpolate", "credit": "at_the_time", "points_between_steps": 0, "points_not_known_then": 14,
                "truth_points_left_out": 3, "track_points_left_out": 0
            },
            "tfa": {"shares": [
                {"name": "correct", "forgiven": 0, "of": "output_tracks", "numerator": 6, "denominator": 8, "value": 0.75},
                {"name": "correct", "forgiven": 1, "of": "output_tracks", "numerator": 8, "denominator": 8, "value": 1.0}
            ]}
        });
        assert_eq!(
            judged(&result).unwrap_or_default(),
            "judged at 30 steps (the scans of the recording, one in 8 s), 28 of them with truth\n\
             gate 1000 m, alignment interpolate, credit at_the_time\n\
             left out: 14 points of tracks before they were known, 3 points of the truth outside what is judged"
        );
        assert_eq!(
            shares(&result),
            [("tfa correct, 6 of 8 output tracks".to_owned(), &json!(0.75))]
        );
        result["comparison"] = json!({
            "steps": "frames", "period_s": null, "step_count": 2, "due_steps": 2, "gate": 0.5, "gate_unit": "", "alignment": "nearest",
            "credit": "afterwards"
        });
        assert_eq!(
            judged(&result).unwrap_or_default(),
            "judged at 2 steps (frames), 2 of them with truth\ngate 0.5, alignment nearest, credit afterwards"
        );
        assert_eq!(judged(&json!({"counts": {}})), None);
    }

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let rows = vec![
            vec!["radar".to_owned(), "7".to_owned()],
            vec!["é".to_owned(), "12.500".to_owned()],
        ];
        assert_eq!(
            table(&["name", "n"], &rows),
            "name        n\n─────  ──────\nradar       7\né      12.500"
        );
    }

    #[test]
    fn absent_numbers_are_a_dash_and_fractions_have_three_decimals() {
        assert_eq!(
            [
                cell(&json!(13.0)),
                cell(&json!(-0.000123)),
                cell(&json!(0.0)),
                cell(&json!(-0.0))
            ],
            ["13", "-1.230e-4", "0", "0"]
        );
        assert_eq!(
            [
                cell(&Value::Null),
                cell(&json!(3)),
                cell(&json!(0.56338)),
                cell(&json!("x"))
            ],
            ["–", "3", "0.563", "x"]
        );
    }

    #[test]
    fn differences_stand_below_the_cells() {
        let outcome = |mean: f64| json!({"mean": mean, "pairs": 5, "interval": {"low": mean - 1.0, "high": mean + 1.0}});
        let cells = json!([
            {"name": "NN", "runs": 5, "outcomes": {"cost": outcome(4.0)}, "differences": {}},
            {"name": "JPDA", "runs": 5, "outcomes": {"cost": outcome(2.0)}, "differences": {"cost": outcome(-2.0)}, "compared_with": "NN"}
        ]);
        let text = campaign(&json!({"result": {"outcomes": ["cost"], "cells": cells}})).unwrap();
        let told = "difference, run by run  pairs         cost\n──────────────────────  ─────  ───────────\nJPDA − NN                   5  -2 [-3, -1]";
        assert!(text.ends_with(told), "{text}");
    }

    #[test]
    fn metrics_stand_in_columns_by_sequence() {
        let quantities =
            |mota: Value| json!({"clear": {"quantities": {"mota": {"value": mota, "unit": ""}}}});
        let mut result = json!({"metrics": quantities(json!(0.5))});
        assert_eq!(
            metrics(&result).unwrap().lines().last(),
            Some("clear mota        0.500")
        );
        result["sequences"] = json!([{"name": "a", "metrics": quantities(Value::Null)}]);
        let text = metrics(&result).unwrap();
        assert_eq!(text.lines().next(), Some("metric      unit  combined  a"));
        assert_eq!(text.lines().last(), Some("clear mota           0.500  –"));
        assert_eq!(metrics(&json!({"metrics": {}})), None);
    }
}
