//! Metrics over time, from the file that the job left.

use super::{Method, Reduced, Window};
use serde::Serialize;
use std::collections::BTreeMap;
use utoipa::ToSchema;

/// The file `metric-series.csv` of a job: a row for each step of each sequence.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MetricTable {
    /// Name of the sequence of each row; empty where the job has only one.
    pub sequences: Vec<String>,
    pub time_s: Vec<f64>,
    /// Name, unit and values of each column.
    pub columns: Vec<(String, String, Vec<Option<f64>>)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum MetricsName {
    Metrics,
}

/// One row for each time at which truth and tracks were compared.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct MetricsSeries {
    pub name: MetricsName,
    pub columns: MetricsColumns,
    /// Unit of each column of `values` that has one.
    pub units: BTreeMap<String, String>,
    pub source_points: usize,
    pub returned_points: usize,
    pub method: Method,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct MetricsColumns {
    pub time_s: Vec<f64>,
    /// The sequence of the row; null where the job has only one.
    pub sequence: Vec<Option<String>>,
    /// Columns by metric and quantity, as `gospa.missed`; null where undefined.
    pub values: BTreeMap<String, Vec<Option<f64>>>,
}

impl MetricTable {
    /// Reads the file that jobs write: `[sequence,]time_s,metric.quantity [unit],…`.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub fn read(bytes: &[u8]) -> Result<MetricTable, csv::Error> {
        let mut reader = csv::Reader::from_reader(bytes);
        let header = reader.headers()?.clone();
        let time = usize::from(header.get(0) == Some("sequence"));
        let columns = header.iter().skip(time + 1).map(split_unit).collect();
        let mut table = MetricTable {
            columns,
            ..MetricTable::default()
        };
        for record in reader.records() {
            let record = record?;
            table.sequences.push(if time == 1 {
                record[0].to_owned()
            } else {
                String::new()
            });
            table.time_s.push(record[time].parse().unwrap_or(f64::NAN));
            for (column, cell) in table.columns.iter_mut().zip(record.iter().skip(time + 1)) {
                column.2.push(cell.parse().ok());
            }
        }
        Ok(table)
    }
}

/// `gospa.missed [m]` in its name and its unit.
pub(super) fn split_unit(label: &str) -> (String, String, Vec<Option<f64>>) {
    let (name, unit) = label
        .strip_suffix(']')
        .and_then(|label| label.split_once(" ["))
        .unwrap_or((label, ""));
    (name.to_owned(), unit.to_owned(), Vec::new())
}

pub fn over_time(table: &MetricTable, window: &Window) -> MetricsSeries {
    let rows: Vec<usize> = (0..table.time_s.len())
        .filter(|&row| window.holds(table.time_s[row]))
        .collect();
    let of_rows = |(_, _, values): &(String, String, Vec<Option<f64>>)| {
        rows.iter()
            .map(|&row| values[row].unwrap_or(f64::NAN))
            .collect()
    };
    let known: Vec<Vec<f64>> = table.columns.iter().map(of_rows).collect();
    let kept = if known.is_empty() {
        Reduced::every_nth(rows.len(), window.max_points)
    } else {
        Reduced::min_max(
            &known.iter().map(Vec::as_slice).collect::<Vec<_>>(),
            window.max_points,
        )
    };
    let values = table
        .columns
        .iter()
        .map(|(name, _, values)| (name.clone(), kept.column(|row| values[rows[row]])));
    let columns = MetricsColumns {
        time_s: kept.column(|row| table.time_s[rows[row]]),
        sequence: kept
            .column(|row| Some(table.sequences[rows[row]].clone()).filter(|name| !name.is_empty())),
        values: values.collect(),
    };
    let named = table
        .columns
        .iter()
        .filter(|(_, unit, _)| !unit.is_empty())
        .map(|(name, unit, _)| (name.clone(), unit.clone()));
    let units = named
        .chain([("time_s".to_owned(), "s".to_owned())])
        .collect();
    MetricsSeries {
        name: MetricsName::Metrics,
        columns,
        units,
        source_points: kept.source_points,
        returned_points: kept.rows.len(),
        method: kept.method,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::service::views::tests::everything;

    #[test]
    fn the_file_becomes_columns_with_units_and_holes() {
        let text = "sequence,time_s,gospa.gospa [m],clear.matches\na,0,1.5,2\na,1,,3\nb,0,2,1\n";
        let table = MetricTable::read(text.as_bytes()).unwrap();
        let series = over_time(
            &table,
            &Window {
                from_s: Some(0.5),
                ..everything()
            },
        );
        assert_eq!(series.columns.time_s, [1.0]);
        assert_eq!(series.columns.sequence, [Some("a".to_owned())]);
        assert_eq!(series.columns.values["gospa.gospa"], [None]);
        assert_eq!(series.columns.values["clear.matches"], [Some(3.0)]);
        assert_eq!(series.units["gospa.gospa"], "m");
        let plain = over_time(
            &MetricTable::read(b"time_s,x\n4,2\n").unwrap(),
            &everything(),
        );
        assert_eq!(
            (plain.columns.sequence, plain.columns.time_s),
            (vec![None], vec![4.0])
        );
    }
}
