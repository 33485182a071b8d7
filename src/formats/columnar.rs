//! Parquet, and Arrow IPC as a file (Feather 2) or a stream: a table whose columns have types. Cells become text, and mean what
//! they mean in CSV. Files of trackloom's own (see [`super::out`]) read as the dataset that they were written from.

mod budget;
mod cells;
mod ipc;
mod messages;
mod pages;
mod thrift;

use super::out::columnar::{METADATA_KEY, Metadata};
use super::table::{self, FaultLog, Rows, pointer_token};
use super::{Format, MAX_COLUMNS, MAX_HEADER_BYTES, ReadOptions, ReadOutcome, TABLES};
use crate::model::fault::Fault;
use arrow_array::RecordBatch;
use arrow_schema::{ArrowError, DataType, Schema};
use budget::{Budget, most_rows};
use bytes::Bytes;
use cells::Cells;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use std::io::BufRead;
use std::panic::{AssertUnwindSafe, catch_unwind};

pub const PARQUET: Format = Format {
    name: "parquet",
    summary: "Parquet: detections, truth or tracks, the columns of CSV with their types",
    media_type: "application/vnd.apache.parquet",
    kinds: TABLES,
    options: &[],
    read: read_parquet,
};

pub const ARROW: Format = Format {
    name: "arrow",
    summary: "Arrow IPC, as a file (Feather 2) or a stream: the columns of CSV with their types",
    media_type: "application/vnd.apache.arrow.file",
    kinds: TABLES,
    options: &[],
    read: read_arrow,
};

/// Of a file; a stream begins with its first message.
const ARROW_MAGIC: &[u8] = b"ARROW1\0\0";

fn read_parquet(input: &mut dyn BufRead, options: &ReadOptions) -> Result<ReadOutcome, Vec<Fault>> {
    let bytes = Bytes::from(whole(input)?);
    let size = bytes.len() as u64;
    guarded(|| {
        let builder = ParquetRecordBatchReaderBuilder::try_new(bytes.clone()).map_err(damaged)?;
        let rows = builder.metadata().file_metadata().num_rows();
        check_rows(u64::try_from(rows).unwrap_or(u64::MAX), size)?;
        let schema = builder.schema().clone();
        let batch_rows = pages::check(&bytes, builder.metadata())?;
        let batches = builder
            .with_batch_size(batch_rows)
            .build()
            .map_err(damaged)?;
        read_batches(&schema, Box::new(batches), size, options)
    })
}

fn read_arrow(input: &mut dyn BufRead, options: &ReadOptions) -> Result<ReadOutcome, Vec<Fault>> {
    let bytes = whole(input)?;
    let size = bytes.len() as u64;
    guarded(|| {
        let (schema, batches) = ipc::open(bytes)?;
        read_batches(&schema, batches, size, options)
    })
}

fn whole(input: &mut dyn BufRead) -> Result<Vec<u8>, Vec<Fault>> {
    let mut bytes = Vec::new();
    input.read_to_end(&mut bytes).map_err(|error| {
        vec![Fault::new(
            "/file",
            "malformed",
            format!("the file cannot be read: {error}"),
        )]
    })?;
    Ok(bytes)
}

/// What a decoder does not expect of a damaged file may end in a panic: it is the file's fault.
fn guarded(
    read: impl FnOnce() -> Result<ReadOutcome, Vec<Fault>>,
) -> Result<ReadOutcome, Vec<Fault>> {
    catch_unwind(AssertUnwindSafe(read))
        .unwrap_or_else(|_| Err(damaged("its parts do not fit together")))
}

fn damaged(error: impl std::fmt::Display) -> Vec<Fault> {
    let error = error.to_string();
    // In the words of the two crates for a compression that they are built without.
    if error.contains("Disabled feature") || error.contains("decompression requires") {
        let is_brotli = error.to_ascii_lowercase().contains("brotli");
        let how = if is_brotli {
            "with Brotli, which"
        } else {
            "in a way that"
        };
        let detail = format!("the file is compressed {how} is not read");
        let fault = Fault::new("/file", "unsupported", detail);
        return vec![fault.allowing("Parquet with snappy, gzip, Zstandard, LZ4 or uncompressed")];
    }
    let detail = format!("the file is damaged or cut off: {error}");
    vec![Fault::new("/file", "malformed", detail)]
}

fn check_rows(rows: u64, bytes: u64) -> Result<(), Vec<Fault>> {
    let most = most_rows(bytes);
    if rows <= most {
        return Ok(());
    }
    let detail = format!("the file has {bytes} bytes and says that it has {rows} rows");
    Err(vec![
        Fault::new("/file", "too_large", detail).allowing(format!("<= {most} rows")),
    ])
}

type Batches = Box<dyn Iterator<Item = Result<RecordBatch, ArrowError>>>;

fn read_batches(
    schema: &Schema,
    batches: Batches,
    bytes: u64,
    options: &ReadOptions,
) -> Result<ReadOutcome, Vec<Fault>> {
    check_columns(schema)?;
    let own = own_metadata(schema);
    let mut options = options.clone();
    let kind = own.as_ref().map(|own| own.kind);
    options.kind = options.kind.or(kind);
    let mut rows = BatchRows::new(schema, batches, bytes, own.as_ref());
    let mut outcome = table::read(&mut rows, &options, Vec::new())?;
    if let Some(own) = own {
        if let (Some(frame), None) = (own.frame, outcome.dataset.frame()) {
            outcome.dataset.place_at(frame);
        }
        outcome.dataset.set_time_base(own.time_base);
    }
    Ok(outcome)
}

/// What trackloom itself wrote of a file, of a description that this version knows.
fn own_metadata(schema: &Schema) -> Option<Metadata> {
    let text = schema.metadata().get(METADATA_KEY)?;
    let own: Metadata = serde_json::from_str(text).ok()?;
    (own.version == 1).then_some(own)
}

fn check_columns(schema: &Schema) -> Result<(), Vec<Fault>> {
    let fields = schema.fields();
    let bytes: usize = fields.iter().map(|field| field.name().len()).sum();
    if fields.len() > MAX_COLUMNS || bytes > MAX_HEADER_BYTES {
        let detail = format!("the file names {} columns in {bytes} bytes", fields.len());
        let allowed = format!("<= {MAX_COLUMNS} columns in <= {MAX_HEADER_BYTES} bytes");
        return Err(vec![
            Fault::new("/file", "too_large", detail).allowing(allowed),
        ]);
    }
    let mut faults = FaultLog::default();
    for field in fields
        .iter()
        .filter(|field| !cells::is_readable(field.data_type()))
    {
        let (name, found) = (field.name(), type_name(field.data_type()));
        let detail = format!("column '{name}' is of the type {found}: no cell of a table is");
        let pointer = format!("/file/columns/{}", pointer_token(name));
        faults.push(Fault::new(pointer, "unsupported", detail).allowing(cells::READABLE));
    }
    faults.finish()
}

/// Without what is inside of it.
fn type_name(found: &DataType) -> String {
    let text = format!("{found:?}");
    text.chars()
        .take_while(|letter| letter.is_alphanumeric())
        .collect()
}

struct BatchRows {
    names: Vec<String>,
    /// Of the columns that are shown, their places in a batch.
    columns: Vec<usize>,
    /// The column whose instants are shown as seconds since 1970.
    seconds: Option<usize>,
    batches: Batches,
    cells: Vec<Cells>,
    texts: Vec<String>,
    /// Rows of the batch at hand, and of those before it.
    in_batch: usize,
    before: u64,
    /// The row after the current one, in its batch.
    next: usize,
    most_rows: u64,
    /// Of the texts of all cells.
    budget: Budget,
}

impl BatchRows {
    fn new(schema: &Schema, batches: Batches, bytes: u64, own: Option<&Metadata>) -> Self {
        let names: Vec<&str> = schema
            .fields()
            .iter()
            .map(|field| field.name().as_str())
            .collect();
        // Of a file of our own x and y say more exactly what latitude and longitude say, too.
        let is_twice = own.is_some_and(|own| own.frame.is_some()) && names.contains(&"x_m");
        let is_shown = |name: &str| !(is_twice && matches!(name, "lat_deg" | "lon_deg"));
        let columns: Vec<usize> = (0..names.len())
            .filter(|place| is_shown(names[*place]))
            .collect();
        let mut shown: Vec<String> = columns
            .iter()
            .map(|place| names[*place].to_owned())
            .collect();
        let mut seconds = None;
        if own.is_some_and(|own| own.time_base.is_utc()) {
            seconds = shown.iter().position(|name| name == "time");
        }
        if let Some(column) = seconds {
            shown[column] = "time_s".to_owned();
        }
        BatchRows {
            texts: vec![String::new(); shown.len()],
            names: shown,
            columns,
            seconds,
            batches,
            cells: Vec::new(),
            in_batch: 0,
            before: 0,
            next: 0,
            most_rows: most_rows(bytes),
            budget: Budget::of_file(bytes),
        }
    }

    /// Goes to the next batch that has a row.
    fn next_batch(&mut self, faults: &mut FaultLog) -> bool {
        loop {
            self.before += self.in_batch as u64;
            let batch = match self.batches.next() {
                None => return false,
                Some(Ok(batch)) if self.before + batch.num_rows() as u64 <= self.most_rows => batch,
                Some(Ok(_)) => {
                    let detail = "the file has more rows than a table of its size can have";
                    faults.push(Fault::new("/file", "too_large", detail));
                    return false;
                }
                Some(Err(error)) => {
                    damaged(error)
                        .into_iter()
                        .for_each(|fault| faults.push(fault));
                    return false;
                }
            };
            (self.in_batch, self.next) = (batch.num_rows(), 0);
            if batch.num_rows() > 0 {
                let columns = self.columns.iter().enumerate();
                self.cells = columns
                    .map(|(shown, place)| {
                        Cells::of(batch.column(*place), self.seconds == Some(shown))
                    })
                    .collect();
                return true;
            }
        }
    }
}

impl Rows for BatchRows {
    fn names(&self) -> &[String] {
        &self.names
    }

    fn advance(&mut self, faults: &mut FaultLog) -> bool {
        if self.next >= self.in_batch && !self.next_batch(faults) {
            return false;
        }
        for (text, cells) in self.texts.iter_mut().zip(&self.cells) {
            text.clear();
            cells.push(self.next, text);
        }
        self.next += 1;
        let letters: usize = self.texts.iter().map(String::len).sum();
        match self.budget.take(letters as u64) {
            Ok(()) => true,
            Err(fault) => {
                faults.push(fault);
                false
            }
        }
    }

    fn cell(&self, column: usize) -> &str {
        &self.texts[column]
    }

    fn row(&self) -> u64 {
        (self.before + self.next as u64).saturating_sub(1)
    }

    fn row_word(&self) -> &'static str {
        "row"
    }

    fn cell_fault(&self, row: u64, column: usize, code: &str, detail: String) -> Fault {
        let name = pointer_token(&self.names[column]);
        Fault::new(format!("/file/columns/{name}/{row}"), code, detail)
    }

    fn header_fault(&self, name: Option<&str>, code: &str, detail: String) -> Fault {
        let token = name.map(|name| format!("/{}", pointer_token(name)));
        let pointer = format!("/file/columns{}", token.unwrap_or_default());
        Fault::new(pointer, code, detail)
    }
}
