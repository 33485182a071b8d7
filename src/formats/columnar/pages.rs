//! The pages of a Parquet file, looked at before any is unpacked: what they say that they unpack to, and whether it is so.

use super::budget::Budget;
use super::damaged;
use super::thrift::{Compact, STRUCT};
use crate::model::fault::Fault;
use flate2::bufread::MultiGzDecoder;
use parquet::basic::{Compression, Type};
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData};
use std::io::{self, Read};

/// Rows that are decoded at once, and the bytes that their texts may have.
const BATCH_ROWS: u64 = 8192;
const BATCH_BYTES: u64 = 256 << 20;

const DICTIONARY_PAGE: i64 = 2;
/// The encoding whose values repeat the begin of the value before.
const DELTA_BYTE_ARRAY: i64 = 7;

/// Checks all pages; how many rows may be decoded at once.
///
/// # Errors
/// Pages that unpack to more than the [`Budget`], or than they say; columns that share bytes; damaged heads.
pub fn check(file: &[u8], metadata: &ParquetMetaData) -> Result<usize, Vec<Fault>> {
    let mut budget = Budget::of_file(file.len() as u64);
    let mut packed_left = file.len() as u64;
    let mut most_repeated = 0;
    for group in metadata.row_groups() {
        let mut repeated = 0;
        for column in group.columns() {
            let (start, length) = column.byte_range();
            packed_left = packed_left
                .checked_sub(length)
                .ok_or_else(|| damaged("its columns are longer than the file"))?;
            let pages = part(file, start, length).ok_or_else(|| damaged("a column is cut off"))?;
            repeated += check_column(pages, column, &mut budget)?;
        }
        most_repeated = most_repeated.max(repeated);
    }
    let rows = (BATCH_BYTES / most_repeated.max(1)).clamp(1, BATCH_ROWS);
    Ok(rows as usize)
}

fn part(file: &[u8], start: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(start).ok()?;
    file.get(start..)?.get(..usize::try_from(length).ok()?)
}

/// The longest text that each row of the column may repeat.
fn check_column(
    pages: &[u8],
    column: &ColumnChunkMetaData,
    budget: &mut Budget,
) -> Result<u64, Vec<Fault>> {
    let (mut rest, mut repeated) = (pages, 0);
    while !rest.is_empty() {
        let (page, body) = Page::read(rest).ok_or_else(|| damaged("a page has no sound head"))?;
        let packed = body
            .get(..page.packed)
            .ok_or_else(|| damaged("a page is cut off"))?;
        budget.take(page.unpacked).map_err(|fault| vec![fault])?;
        if matches!(column.compression(), Compression::GZIP(_)) {
            check_gzip(&page, packed)?;
        }
        if column.column_type() == Type::BYTE_ARRAY && page.repeats_texts() {
            repeated = repeated.max(page.unpacked);
        }
        rest = &body[page.packed..];
    }
    Ok(repeated)
}

/// Gzip alone is unpacked to its end whatever its page says, so it is measured first.
fn check_gzip(page: &Page, packed: &[u8]) -> Result<(), Vec<Fault>> {
    let Some(packed) = packed.get(page.level_bytes..).filter(|_| page.is_packed) else {
        return Ok(());
    };
    let most = page.unpacked.saturating_sub(page.level_bytes as u64);
    let mut unpacked = MultiGzDecoder::new(packed).take(most + 1);
    match io::copy(&mut unpacked, &mut io::sink()) {
        Ok(found) if found > most => Err(damaged("a page unpacks to more than it says")),
        Ok(_) => Ok(()),
        Err(error) => Err(damaged(error)),
    }
}

/// The head of a page.
struct Page {
    kind: i64,
    encoding: i64,
    /// Bytes of the page, as it is and unpacked.
    packed: usize,
    unpacked: u64,
    /// Bytes before what is packed.
    level_bytes: usize,
    is_packed: bool,
}

impl Page {
    /// With what follows the head.
    fn read(bytes: &[u8]) -> Option<(Page, &[u8])> {
        let mut input = Compact { rest: bytes };
        let mut sizes = [0_i64; 4];
        let mut page = Page {
            kind: 0,
            encoding: 0,
            packed: 0,
            unpacked: 0,
            level_bytes: 0,
            is_packed: true,
        };
        let mut last = 0;
        while let Some((id, kind)) = input.field(last)? {
            last = id;
            match id {
                1..=3 => sizes[id as usize] = input.integer()?,
                5 | 7 if kind == STRUCT => page.encoding = input.numbers([0; 3])?[2],
                8 if kind == STRUCT => page.read_second_version(&mut input)?,
                _ => input.skip(kind)?,
            }
        }
        page.kind = sizes[1];
        page.unpacked = u64::try_from(sizes[2]).ok()?;
        page.packed = usize::try_from(sizes[3]).ok()?;
        Some((page, input.rest))
    }

    fn read_second_version(&mut self, input: &mut Compact) -> Option<()> {
        let told = input.numbers([0, 0, 0, 0, 0, 0, 0, 1])?;
        self.encoding = told[4];
        self.level_bytes = usize::try_from(told[5].checked_add(told[6])?).ok()?;
        self.is_packed = told[7] != 0;
        Some(())
    }

    fn repeats_texts(&self) -> bool {
        self.kind == DICTIONARY_PAGE || self.encoding == DELTA_BYTE_ARRAY
    }
}
