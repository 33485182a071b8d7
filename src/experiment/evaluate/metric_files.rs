//! The files of a judgement: the log of events, the table of pairs, the metrics over time, and what the metrics say of each
//! truth and each track. With them how the numbers of the report are made of their rows.

use crate::evaluation::comparison::Comparison;
use crate::evaluation::metrics::origin::{
    EVENTS, Origin, PAIRS, PairColumn, SERIES, Source, TRACKS, TRUTHS,
};
use crate::evaluation::metrics::{Line, MetricReport, Sequence, Series};
use crate::experiment::files::tables::{Table, number, optional};
use crate::experiment::job::Artifact;
use serde_json::{Map, Value, json};

/// Metrics by the names that they have in the report.
pub type Reports<'a> = Vec<(&'a str, MetricReport)>;

/// Axis of the series that have one value for each step of the comparison.
pub const TIME: &str = "time_s";

/// More pairs are not written to a file.
pub const MAX_PAIRS: usize = 1_000_000;

const EVENT_COLUMNS: [&str; 7] = [
    "step",
    "time_s",
    "event",
    "truth_id",
    "track_id",
    "distance",
    "similarity",
];

const PAIR_COLUMNS: [&str; 6] = [
    "step",
    "time_s",
    "truth_id",
    "track_id",
    "distance",
    "similarity",
];

/// The files of all sequences, and how many pairs there are.
pub fn files(
    names: &[&str],
    sequences: &[Sequence],
    reports: &[&Reports],
) -> (Vec<Artifact>, usize) {
    let has_names = names.len() > 1;
    let mut events = Table::new(has_names, &EVENT_COLUMNS);
    let mut pairs = Table::new(has_names, &PAIR_COLUMNS);
    let mut series = Table::new(has_names, &["time_s"]);
    let mut truths = Table::new(has_names, &["truth_id"]);
    let mut tracks = Table::new(has_names, &["track_id"]);
    truths.columns(line_columns(reports, |report| &report.per_truth));
    tracks.columns(line_columns(reports, |report| &report.per_track));
    let found: Vec<Vec<(u32, u32)>> = sequences
        .iter()
        .zip(reports)
        .map(|(sequence, reports)| all_pairs(sequence, reports))
        .collect();
    let count = found.iter().map(Vec::len).sum();
    for (place, (name, sequence)) in names.iter().zip(sequences).enumerate() {
        let (comparison, reports) = (sequence.comparison, reports[place]);
        for table in [
            &mut events,
            &mut pairs,
            &mut series,
            &mut truths,
            &mut tracks,
        ] {
            table.begin(name);
        }
        add_events(&mut events, sequence);
        if count <= MAX_PAIRS {
            add_pairs(&mut pairs, comparison, &found[place], reports);
        }
        add_series(&mut series, comparison, reports);
        add_lines(&mut truths, &comparison.truth_ids, reports, |report| {
            &report.per_truth
        });
        add_lines(&mut tracks, &comparison.track_ids, reports, |report| {
            &report.per_track
        });
    }
    let mut files = vec![events.artifact(EVENTS)];
    files.extend((count <= MAX_PAIRS).then(|| pairs.artifact(PAIRS)));
    files.extend([
        series.artifact(SERIES),
        truths.artifact(TRUTHS),
        tracks.artifact(TRACKS),
    ]);
    (files, count)
}

fn add_events(table: &mut Table, sequence: &Sequence) {
    let comparison = sequence.comparison;
    let name = |ids: &[String], index: Option<u32>| {
        index
            .map(|index| ids[index as usize].clone())
            .unwrap_or_default()
    };
    for event in &sequence.events.events {
        table.row(&[
            (event.step + 1).to_string(),
            number(comparison.steps[event.step as usize].time_s),
            event.kind.name().to_owned(),
            name(&comparison.truth_ids, event.truth),
            name(&comparison.track_ids, event.track),
            optional(event.distance),
            optional(
                event
                    .distance
                    .map(|distance| comparison.similarity(distance)),
            ),
        ]);
    }
}

/// The pairs within reach, and those beyond that contribute to some metric, in order.
fn all_pairs(sequence: &Sequence, reports: &Reports) -> Vec<(u32, u32)> {
    let listed = sequence
        .comparison
        .pairs
        .iter()
        .map(|pair| (pair.truth, pair.track));
    let columns = reports.iter().flat_map(|(_, report)| &report.pairs);
    let mut pairs: Vec<(u32, u32)> = listed
        .chain(
            columns.flat_map(|column| column.cells.iter().map(|&(truth, track, _)| (truth, track))),
        )
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

fn add_pairs(table: &mut Table, comparison: &Comparison, pairs: &[(u32, u32)], reports: &Reports) {
    let columns: Vec<(&str, &PairColumn)> = reports
        .iter()
        .flat_map(|(name, report)| report.pairs.iter().map(move |column| (*name, column)))
        .collect();
    table.columns(
        columns
            .iter()
            .map(|(name, column)| label(name, column.name, column.unit)),
    );
    let mut cells: Vec<_> = columns
        .iter()
        .map(|(_, column)| column.cells.iter().peekable())
        .collect();
    let mut listed = comparison.pairs.iter().peekable();
    let mut step = 0;
    for &(truth, track) in pairs {
        while comparison.steps[step].truths.end <= truth as usize {
            step += 1;
        }
        let (of_truth, of_track) = (
            &comparison.truths[truth as usize],
            &comparison.tracks[track as usize],
        );
        let known = listed
            .next_if(|pair| (pair.truth, pair.track) == (truth, track))
            .map(|pair| (pair.distance, pair.similarity));
        let far = || {
            let beside = comparison.truth_beside(truth as usize, track as usize);
            let distance = comparison.distance(&beside.position_m, &of_track.position_m);
            comparison.space?;
            Some((distance, comparison.similarity(distance)))
        };
        let distances = known.or_else(far);
        let mut row = vec![
            (step + 1).to_string(),
            number(comparison.steps[step].time_s),
            comparison.truth_ids[of_truth.id as usize].clone(),
            comparison.track_ids[of_track.id as usize].clone(),
            optional(distances.map(|(distance, _)| distance)),
            optional(distances.map(|(_, similarity)| similarity)),
        ];
        row.extend(cells.iter_mut().map(|cells| {
            optional(
                cells
                    .next_if(|cell| (cell.0, cell.1) == (truth, track))
                    .map(|cell| cell.2),
            )
        }));
        table.row(&row);
    }
}

fn add_series(table: &mut Table, comparison: &Comparison, reports: &Reports) {
    let listed: Vec<(&str, &Series)> = reports
        .iter()
        .flat_map(|(name, report)| report.series.iter().map(move |series| (*name, series)))
        .filter(|(_, series)| series.axis == TIME)
        .collect();
    table.columns(
        listed
            .iter()
            .map(|(name, series)| label(name, series.name, series.unit)),
    );
    for (index, step) in comparison.steps.iter().enumerate() {
        let mut cells = vec![number(step.time_s)];
        cells.extend(
            listed
                .iter()
                .map(|(_, series)| optional(series.values.get(index).copied().flatten())),
        );
        table.row(&cells);
    }
}

type Lines = fn(&MetricReport) -> &Vec<Line>;

/// The columns of the first sequence that has any line: all that have one have the same.
fn line_columns(reports: &[&Reports], of: Lines) -> impl Iterator<Item = String> {
    let first = reports
        .iter()
        .find(|reports| reports.iter().any(|(_, report)| !of(report).is_empty()));
    let listed = first.into_iter().flat_map(|reports| reports.iter());
    let columns = listed.flat_map(move |(name, report)| {
        let quantities = of(report)
            .first()
            .map(|line| line.quantities.as_slice())
            .unwrap_or_default();
        quantities
            .iter()
            .map(|quantity| label(name, quantity.name, quantity.unit))
            .collect::<Vec<_>>()
    });
    columns.collect::<Vec<_>>().into_iter()
}

fn add_lines(table: &mut Table, ids: &[String], reports: &Reports, of: Lines) {
    let listed: Vec<&Vec<Line>> = reports
        .iter()
        .map(|(_, report)| of(report))
        .filter(|lines| lines.len() == ids.len())
        .collect();
    for (index, id) in ids.iter().enumerate() {
        let mut cells = vec![id.clone()];
        cells.extend(listed.iter().flat_map(|lines| {
            lines[index]
                .quantities
                .iter()
                .map(|quantity| optional(quantity.value))
        }));
        table.row(&cells);
    }
}

/// How the numbers of a metric of this name are made, as the report says it; `alone` is what it says of each sequence.
pub fn origins(name: &str, report: &MetricReport, alone: &[&MetricReport]) -> Value {
    report
        .origins
        .iter()
        .map(|origin| write_origin(name, origin, alone))
        .collect()
}

fn write_origin(name: &str, origin: &Origin, alone: &[&MetricReport]) -> Value {
    let mut value = Map::new();
    value.insert("quantity".to_owned(), json!(origin.quantity));
    value.insert("statistic".to_owned(), json!(origin.statistic));
    let mut tell =
        |key: &str, told: Value, is_told: bool| is_told.then(|| value.insert(key.to_owned(), told));
    match origin.source {
        Source::Rows {
            file,
            column,
            events,
        } => {
            tell("file", json!(file), true);
            let label = column.map(|column| {
                if file == EVENTS {
                    column.to_owned()
                } else {
                    column_label(name, file, column, alone)
                }
            });
            tell("column", json!(label), column.is_some());
            tell("filter", json!({"event": events}), !events.is_empty());
        }
        Source::Numbers {
            over,
            under,
            factor,
            power,
        } => {
            tell("over", json!(over), true);
            tell("under", json!(under), !under.is_empty());
            tell("factor", json!(factor), factor != 1.0);
            tell("root", json!(power), power != 1.0);
        }
    }
    Value::Object(value)
}

/// The header of a metric's column in a file, with its unit where any sequence has the column.
fn column_label(name: &str, file: &str, column: &str, alone: &[&MetricReport]) -> String {
    let of_lines = |lines: &[Line]| {
        let quantities = lines
            .first()
            .map(|line| line.quantities.as_slice())
            .unwrap_or_default();
        quantities
            .iter()
            .find(|quantity| quantity.name == column)
            .map(|quantity| quantity.unit)
    };
    let unit = |report: &&MetricReport| match file {
        PAIRS => report
            .pairs
            .iter()
            .find(|pairs| pairs.name == column)
            .map(|pairs| pairs.unit),
        SERIES => report
            .series
            .iter()
            .find(|series| series.name == column)
            .map(|series| series.unit),
        TRUTHS => of_lines(&report.per_truth),
        _ => of_lines(&report.per_track),
    };
    label(
        name,
        column,
        alone.iter().find_map(unit).unwrap_or_default(),
    )
}

/// A column's name with its unit: `gospa.localisation [m]`.
fn label(metric: &str, name: &str, unit: &str) -> String {
    if unit.is_empty() {
        format!("{metric}.{name}")
    } else {
        format!("{metric}.{name} [{unit}]")
    }
}
