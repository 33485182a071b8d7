//! Parquet and Arrow as others pack them: every codec gives the same dataset, and a small file that unpacks to a large one is refused.

use super::*;
use arrow_array::types::Int32Type;
use arrow_array::{ArrayRef, DictionaryArray, Float64Array, RecordBatch, StringArray};
use arrow_ipc::reader::read_footer_length;
use arrow_ipc::writer::{FileWriter, IpcWriteOptions};
use arrow_ipc::{CompressionType, root_as_footer};
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_writer::ArrowWriterOptions;
use parquet::basic::Compression;
use parquet::file::properties::{WriterProperties, WriterVersion};
use std::sync::Arc;

const TEXT: &str = "time_s,truth_id,x_m,y_m\n0,a,0.1,-7\n1,a,2.5,8\n2,b,3,1e5\n";

/// The table of `TEXT`, packed in every way.
pub fn packed() -> Vec<(&'static str, Vec<u8>)> {
    let mut files = Vec::new();
    for version in [WriterVersion::PARQUET_1_0, WriterVersion::PARQUET_2_0] {
        for codec in codecs() {
            files.push(("parquet", parquet(&table(), codec, version)));
        }
    }
    for codec in [
        None,
        Some(CompressionType::LZ4_FRAME),
        Some(CompressionType::ZSTD),
    ] {
        files.push(("arrow", arrow(&table(), codec)));
    }
    files
}

fn table() -> RecordBatch {
    let columns: [(&str, ArrayRef); 4] = [
        ("time_s", Arc::new(Float64Array::from(vec![0.0, 1.0, 2.0]))),
        ("truth_id", Arc::new(StringArray::from(vec!["a", "a", "b"]))),
        ("x_m", Arc::new(Float64Array::from(vec![0.1, 2.5, 3.0]))),
        ("y_m", Arc::new(Float64Array::from(vec![-7.0, 8.0, 1e5]))),
    ];
    RecordBatch::try_from_iter(columns).expect("the columns fit")
}

/// One row whose name has so many letters, or as many rows of it as are said.
fn named(name: ArrayRef) -> RecordBatch {
    let numbers: ArrayRef = Arc::new(Float64Array::from_iter_values(
        (0..name.len()).map(|at| at as f64),
    ));
    let columns = [
        ("time_s", &numbers),
        ("truth_id", &name),
        ("x_m", &numbers),
        ("y_m", &numbers),
    ];
    RecordBatch::try_from_iter(columns.map(|(name, column)| (name, column.clone())))
        .expect("the columns fit")
}

fn long_name(letters: usize) -> RecordBatch {
    named(Arc::new(StringArray::from(vec!["a".repeat(letters)])))
}

fn parquet(batch: &RecordBatch, codec: Compression, version: WriterVersion) -> Vec<u8> {
    let properties = WriterProperties::builder()
        .set_compression(codec)
        .set_writer_version(version)
        .set_dictionary_page_size_limit(1 << 28)
        .build();
    let options = ArrowWriterOptions::new()
        .with_properties(properties)
        .with_skip_arrow_metadata(true);
    let mut writer = ArrowWriter::try_new_with_options(Vec::new(), batch.schema(), options)
        .expect("a Vec takes any bytes");
    writer.write(batch).expect("a Vec takes any bytes");
    writer.into_inner().expect("a Vec takes any bytes")
}

fn arrow(batch: &RecordBatch, codec: Option<CompressionType>) -> Vec<u8> {
    let options = IpcWriteOptions::default()
        .try_with_compression(codec)
        .expect("the codec is built in");
    let mut writer = FileWriter::try_new_with_options(Vec::new(), &batch.schema(), options)
        .expect("a Vec takes any bytes");
    writer.write(batch).expect("a Vec takes any bytes");
    writer.into_inner().expect("a Vec takes any bytes")
}

fn codecs() -> [Compression; 6] {
    [
        Compression::UNCOMPRESSED,
        Compression::SNAPPY,
        Compression::GZIP(Default::default()),
        Compression::ZSTD(Default::default()),
        Compression::LZ4,
        Compression::LZ4_RAW,
    ]
}

#[test]
fn every_codec_gives_the_same_dataset() {
    let wanted = read("csv", TEXT).expect("the text is sound").dataset;
    for (number, (format, bytes)) in packed().into_iter().enumerate() {
        let found = read(format, bytes)
            .unwrap_or_else(|faults| panic!("{format}, way {number}: {faults:#?}"));
        assert_eq!(found.dataset, wanted, "{format}, way {number}");
    }
}

/// Polars leaves out the length of the schema's message: only the footer says where batches are.
#[test]
fn the_footer_of_a_file_says_where_its_batches_are() {
    let wanted = read("csv", TEXT).expect("the text is sound").dataset;
    let mut bytes = arrow(&table(), None);
    bytes[8..24].fill(0xa5);
    let found = read("arrow", bytes).expect("nobody reads the schema's message");
    assert_eq!(found.dataset, wanted);
}

fn refused(format: &str, bytes: &[u8], code: &str, words: &str) {
    let faults = read(format, bytes).expect_err("the file is a bomb");
    let told = (
        faults.len(),
        faults[0].pointer.as_str(),
        faults[0].code.as_str(),
    );
    assert_eq!(told, (1, "/file", code), "{}", faults[0]);
    assert!(faults[0].detail.contains(words), "{}", faults[0]);
}

#[test]
fn a_file_that_unpacks_to_much_more_than_its_size_is_refused() {
    let batch = long_name(100 << 20);
    let version = WriterVersion::PARQUET_1_0;
    for codec in [
        Compression::GZIP(Default::default()),
        Compression::ZSTD(Default::default()),
    ] {
        let bomb = parquet(&batch, codec, version);
        assert!(bomb.len() < 120_000, "{codec}: {}", bomb.len());
        refused("parquet", &bomb, "too_large", "unpacks to more than");
    }
    let bomb = arrow(&batch, Some(CompressionType::ZSTD));
    assert!(bomb.len() < 120_000, "{}", bomb.len());
    refused("arrow", &bomb, "too_large", "unpacks to more than");
}

const ZSTD_MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// Where the body of a batch is, its block in the footer says; what its message says of that is not believed.
#[test]
fn a_batch_that_says_a_wrong_length_is_held_to_what_it_unpacks_to() {
    let mut bomb = arrow(&long_name(1 << 20), Some(CompressionType::ZSTD));
    let trailer = bomb.last_chunk::<10>().expect("a file ends with its magic");
    let footer_bytes = read_footer_length(*trailer).expect("the file is sound");
    let footer = bomb[bomb.len() - 10 - footer_bytes..bomb.len() - 10].to_vec();
    let footer = root_as_footer(&footer).expect("the file is sound");
    let blocks = footer.recordBatches().expect("there is a batch");
    let (block, length) = (blocks.get(0), blocks.get(0).bodyLength());
    let start = block.offset() as usize;
    let head = &mut bomb[start..start + block.metaDataLength() as usize];
    let place = head
        .windows(8)
        .position(|eight| eight == length.to_le_bytes());
    let place = place.expect("the head says how long the body is");
    head[place..place + 8].copy_from_slice(&(length * 2).to_le_bytes());
    // What a buffer unpacks to stands before its frame.
    let place = bomb.windows(4).position(|four| four == ZSTD_MAGIC);
    let place = place.expect("the name is packed");
    bomb[place - 8..place].copy_from_slice(&(1_i64 << 57).to_le_bytes());
    refused("arrow", &bomb, "too_large", "unpacks to more than");
}

/// A number as the heads of pages write it.
fn varint(number: u64) -> Vec<u8> {
    let (mut zigzag, mut bytes) = (number << 1, Vec::new());
    while zigzag >= 0x80 {
        bytes.push(zigzag as u8 | 0x80);
        zigzag >>= 7;
    }
    bytes.push(zigzag as u8);
    bytes
}

#[test]
fn a_page_that_unpacks_to_more_than_it_says_is_refused() {
    let letters = 32 << 20;
    let codec = Compression::GZIP(Default::default());
    let mut bytes = parquet(&long_name(letters), codec, WriterVersion::PARQUET_1_0);
    let (told, less) = (varint(letters as u64 + 4), varint(2 << 20));
    assert_eq!(told.len(), less.len());
    let place = bytes.windows(told.len()).position(|window| window == told);
    let place = place.expect("the head of the page says its size");
    bytes[place..place + less.len()].copy_from_slice(&less);
    refused(
        "parquet",
        &bytes,
        "malformed",
        "a page unpacks to more than it says",
    );
}

#[test]
fn a_long_text_that_many_rows_share_is_refused() {
    let texts = std::iter::repeat_n("a".repeat(1 << 20), 300);
    let texts: DictionaryArray<Int32Type> = texts
        .collect::<Vec<_>>()
        .iter()
        .map(String::as_str)
        .collect();
    let ids: ArrayRef = Arc::new(StringArray::from(vec!["a"; texts.len()]));
    let batch = named(ids);
    let mut columns: Vec<(String, ArrayRef)> = Vec::new();
    for (field, column) in batch.schema().fields().iter().zip(batch.columns()) {
        columns.push((field.name().clone(), column.clone()));
    }
    columns.push(("remark".to_owned(), Arc::new(texts)));
    let batch = RecordBatch::try_from_iter(columns).expect("the columns fit");
    let codec = Compression::ZSTD(Default::default());
    let bomb = parquet(&batch, codec, WriterVersion::PARQUET_1_0);
    assert!(bomb.len() < 50_000, "{}", bomb.len());
    refused("parquet", &bomb, "too_large", "unpacks to more than");
}

#[test]
fn a_file_of_more_rows_than_its_size_allows_is_refused() {
    let same: ArrayRef = Arc::new(Float64Array::from(vec![0.0; 2 << 20]));
    let columns = ["time_s", "x_m", "y_m"].map(|name| (name, same.clone()));
    let batch = RecordBatch::try_from_iter(columns).expect("the columns fit");
    let bomb = parquet(&batch, Compression::SNAPPY, WriterVersion::PARQUET_1_0);
    refused("parquet", &bomb, "too_large", "2097152 rows");
}
