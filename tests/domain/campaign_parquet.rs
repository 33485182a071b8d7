//! `runs.parquet` says what `runs.csv` says.

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use serde_json::json;
use std::io::Write;
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{JobKind, plan, run};

#[test]
fn every_number_of_runs_csv_is_in_runs_parquet() {
    // A run without targets has no share of correct tracks, and names are quoted in one file and not in the other.
    let body = json!({
        "base": {
            "kind": "evaluate", "input": {"source": "preset", "preset": "liang2009-10"}, "tracker": {"initial_speed_sigma_mps": 430.0}
        },
        "grid": [
            {"by": "values", "name": "targets", "path": "/input/scenario/targets/count", "values": [1, 3]},
            {"by": "variants", "name": "associator", "variants": [
                {"name": "the \"nearest\", of all", "set": [{"path": "/associator", "value": {"method": "nearest_neighbour"}}]},
                {"name": "σ", "set": [{"path": "/associator", "value": {"method": "pda"}}]}
            ]}
        ],
        "outcomes": [
            {"name": "P correct", "path": "tfa.probability.correct"}, {"name": "GOSPA, m", "path": "metrics.gospa.quantities.gospa"}
        ],
        "runs": 12,
        "seed": 4_000_000_000_u32
    });
    let outcome = run(
        &plan(JobKind::Campaign, &body).unwrap(),
        Vec::new(),
        &mut Silent,
    )
    .unwrap();
    let bytes = |name| {
        outcome
            .artifacts
            .iter()
            .find(|artifact| artifact.name == name)
            .unwrap()
            .bytes
            .clone()
    };
    let mut table = csv::Reader::from_reader(std::io::Cursor::new(bytes("runs.csv")));
    let mut on_disk = tempfile::tempfile().unwrap();
    on_disk.write_all(&bytes("runs.parquet")).unwrap();
    let file = SerializedFileReader::new(on_disk).unwrap();
    let mut rows = file.get_row_iter(None).unwrap();
    let header = table.headers().unwrap().clone();
    let mut counts = [0, 0, 0];
    for line in table.records() {
        let (line, row) = (line.unwrap(), rows.next().unwrap().unwrap());
        let fields: Vec<(&String, &Field)> = row.get_column_iter().collect();
        assert_eq!(fields.len(), line.len());
        for ((name, field), (title, text)) in fields.into_iter().zip(header.iter().zip(&line)) {
            assert_eq!(name, title);
            match field {
                Field::Str(cell) => assert_eq!(cell, text),
                Field::Long(number) => assert_eq!(*number, text.parse::<i64>().unwrap()),
                Field::Double(number) => {
                    assert_eq!(number.to_bits(), text.parse::<f64>().unwrap().to_bits());
                    counts[1] += 1;
                }
                Field::Null => {
                    assert_eq!(text, "");
                    counts[2] += 1;
                }
                other => panic!("{other} is of no kind that the file should have"),
            }
        }
        counts[0] += 1;
    }
    assert!(rows.next().is_none());
    assert_eq!(counts[0], 48);
    assert!(
        counts[1] > 60 && counts[2] > 0 && counts[1] + counts[2] == 96,
        "{counts:?}"
    );
}
