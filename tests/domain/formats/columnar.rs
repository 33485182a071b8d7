//! Parquet and Arrow: what is written reads back, other people's types are read, and what is damaged is refused.

use super::*;
use arrow_array::types::Int8Type;
use arrow_array::{
    Array, ArrayRef, DictionaryArray, Float32Array, Int16Array, Int64Array, LargeStringArray,
    ListArray, RecordBatch, TimestampMillisecondArray, TimestampNanosecondArray,
};
use parquet::arrow::ArrowWriter;
use std::sync::Arc;
use trackloom_domain::formats::{detect_format, writer_named};
use trackloom_domain::model::space::Frame;
use trackloom_domain::model::time::TimeBase;

fn written(name: &str, dataset: &Dataset) -> Vec<u8> {
    let mut bytes = Vec::new();
    let writer = writer_named(name).expect("the writer is known");
    writer
        .put(dataset, &mut bytes)
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    bytes
}

const DETECTIONS: &str = "time_s,scan,sensor_id,detection_id,x_m,y_m,range_m,bearing_deg,amplitude,truth_id\n\
    0.1,1,r,a,1.5,-2,,,7,t\n0.1,1,r,b,,,100.25,33,,\n2.1,3,r,,,,,,,\n";
const TRACKS: &str = "time_s,track_id,sensor_id,x_m,y_m,vx_mps,vy_mps,detection_id,probability,status,nis\n\
    0,1,r,1,2,0.1,0.2,a,0.25,confirmed,\n0,1,r,1,2,0.1,0.2,,0.75,confirmed,\n1,1,r,1,3,,,,,coasted,1.5\n";

fn samples() -> Vec<Dataset> {
    let mut samples: Vec<Dataset> = [
        "time_s,truth_id,x_m,y_m\n0,a,1,2\n0.1,b,3e-300,4\n",
        DETECTIONS,
        TRACKS,
    ]
    .iter()
    .map(|text| read("csv", text).expect("the sample is sound").dataset)
    .collect();
    let placed: Vec<Dataset> = samples.clone();
    for mut dataset in placed {
        dataset.place_at(Frame::new(45.7294, 16.06, 120.0).expect("it is on the Earth"));
        dataset.set_time_base(TimeBase::Utc);
        samples.push(dataset);
    }
    samples
}

#[test]
fn what_is_written_reads_back_as_the_same_dataset_and_every_cut_is_a_fault() {
    for dataset in samples() {
        for name in ["parquet", "arrow"] {
            let bytes = written(name, &dataset);
            assert_eq!(
                detect_format("a", &bytes).map(|format| format.name),
                Some(name)
            );
            let outcome = read(name, &bytes).unwrap_or_else(|faults| panic!("{name}: {faults:#?}"));
            assert_eq!(outcome.dataset, dataset, "{name}");
            for end in 0..bytes.len() {
                assert!(read(name, &bytes[..end]).is_err(), "{name} cut at {end}");
            }
        }
    }
}

fn parquet(columns: Vec<(&str, ArrayRef)>) -> Vec<u8> {
    let batch = RecordBatch::try_from_iter(columns).expect("the columns fit");
    let mut writer =
        ArrowWriter::try_new(Vec::new(), batch.schema(), None).expect("a Vec takes any bytes");
    writer.write(&batch).expect("a Vec takes any bytes");
    writer.into_inner().expect("a Vec takes any bytes")
}

fn stream(columns: Vec<(&str, ArrayRef)>) -> Vec<u8> {
    let batch = RecordBatch::try_from_iter(columns).expect("the columns fit");
    let schema = batch.schema();
    let mut writer = arrow_ipc::writer::StreamWriter::try_new(Vec::new(), &schema)
        .expect("a Vec takes any bytes");
    writer.write(&batch).expect("a Vec takes any bytes");
    writer.into_inner().expect("a Vec takes any bytes")
}

fn others() -> Vec<(&'static str, ArrayRef)> {
    let names: DictionaryArray<Int8Type> = ["b", "a"].into_iter().collect();
    vec![
        (
            "time",
            Arc::new(
                TimestampMillisecondArray::from(vec![1_452_603_731_218, 1_452_603_732_000])
                    .with_timezone("+01:00"),
            ),
        ),
        ("truth_id", Arc::new(names)),
        ("x_m", Arc::new(Float32Array::from(vec![0.1, 2.5]))),
        ("y_m", Arc::new(Int16Array::from(vec![-7, 8]))),
        ("height_m", Arc::new(Int64Array::from(vec![None, Some(9)]))),
        (
            "callsign",
            Arc::new(LargeStringArray::from(vec![Some("KLM1302"), None])),
        ),
    ]
}

#[test]
fn types_of_others_are_read_as_csv_reads_their_texts() {
    let text = "time,truth_id,x_m,y_m,height_m,callsign\n\
        2016-01-12T13:02:11.218Z,b,0.1,-7,,KLM1302\n2016-01-12T13:02:12Z,a,2.5,8,9,\n";
    let wanted = read("csv", text).expect("the text is sound").dataset;
    for (name, bytes) in [("parquet", parquet(others())), ("arrow", stream(others()))] {
        assert_eq!(
            detect_format("a", &bytes).map(|format| format.name),
            Some(name)
        );
        let found = read(name, &bytes).unwrap_or_else(|faults| panic!("{name}: {faults:#?}"));
        assert_eq!(found.dataset, wanted, "{name}");
    }
    let mut columns = others();
    columns[0].1 = Arc::new(TimestampNanosecondArray::from(vec![
        1_452_603_731_218_000_000,
        1_452_603_732_000_000_000,
    ]));
    let found = read("parquet", parquet(columns)).expect("an instant without a zone is UTC");
    assert_eq!(found.dataset, wanted);
}

#[test]
fn nested_columns_are_refused_by_name_and_faults_name_their_cell() {
    let mut columns = others();
    let lists = ListArray::from_iter_primitive::<arrow_array::types::Int32Type, _, _>([
        Some(vec![Some(1)]),
        None,
    ]);
    assert_eq!(lists.len(), 2);
    columns.push(("path", Arc::new(lists)));
    let faults = read("parquet", parquet(columns)).expect_err("a list is no cell");
    assert_eq!(
        (faults.len(), faults[0].pointer.as_str()),
        (1, "/file/columns/path")
    );
    assert!(faults[0].detail.contains("List"), "{}", faults[0]);
    let mut columns = others();
    columns[2].1 = Arc::new(Float32Array::from(vec![f32::NAN, 1.0]));
    let faults = read("parquet", parquet(columns)).expect_err("NaN is no place");
    assert_eq!(
        (faults[0].pointer.as_str(), faults[0].code.as_str()),
        ("/file/columns/x_m/0", "not_finite")
    );
}

#[test]
fn damaged_files_are_faults_and_never_panics() {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    for dataset in &samples()[..3] {
        for name in ["parquet", "arrow"] {
            let sound = written(name, dataset);
            for place in 0..sound.len() {
                for mask in [0x01, 0x80, 0xff] {
                    let mut bytes = sound.clone();
                    bytes[place] ^= mask;
                    // What is read then may be another dataset, but it is one.
                    let _ = read(name, &bytes);
                }
            }
        }
    }
    std::panic::set_hook(hook);
}
