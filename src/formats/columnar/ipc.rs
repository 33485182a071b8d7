//! The batches of Arrow IPC: of a stream one message after another, of a file where its footer says that they are. Some writers leave
//! the schema out of the messages of a file, so it is the footer's.

use super::budget::Budget;
use super::{ARROW_MAGIC, Batches, damaged, messages};
use crate::model::fault::Fault;
use arrow_array::RecordBatch;
use arrow_buffer::Buffer;
use arrow_ipc::convert::try_fb_to_schema;
use arrow_ipc::reader::{FileDecoder, StreamDecoder, read_footer_length};
use arrow_ipc::{Block, root_as_footer};
use arrow_schema::{ArrowError, SchemaRef};
use std::sync::Arc;

/// Columns, and their batches in turn.
///
/// # Errors
/// A damaged file; one that unpacks to more than the [`Budget`].
pub fn open(bytes: Vec<u8>) -> Result<(SchemaRef, Batches), Vec<Fault>> {
    if bytes.starts_with(ARROW_MAGIC) {
        return open_file(bytes);
    }
    let mut budget = Budget::of_file(bytes.len() as u64);
    messages::check(&bytes, &mut budget)?;
    let mut stream = Stream {
        rest: Buffer::from_vec(bytes),
        decoder: StreamDecoder::new(),
    };
    let first = stream.next_batch().map_err(damaged)?;
    let schema = stream
        .decoder
        .schema()
        .ok_or_else(|| damaged("it ends before its columns are named"))?;
    Ok((schema, Box::new(first.map(Ok).into_iter().chain(stream))))
}

struct Stream {
    rest: Buffer,
    decoder: StreamDecoder,
}

impl Stream {
    fn next_batch(&mut self) -> Result<Option<RecordBatch>, ArrowError> {
        let batch = self.decoder.decode(&mut self.rest)?;
        if batch.is_none() {
            self.decoder.finish()?;
        }
        Ok(batch)
    }
}

impl Iterator for Stream {
    type Item = Result<RecordBatch, ArrowError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_batch().transpose()
    }
}

/// The batches that the footer of a file names.
struct File {
    bytes: Buffer,
    decoder: FileDecoder,
    blocks: std::vec::IntoIter<Block>,
}

impl Iterator for File {
    type Item = Result<RecordBatch, ArrowError>;

    fn next(&mut self) -> Option<Self::Item> {
        let block = self.blocks.next()?;
        let message = message_of(&self.bytes, &block);
        let batch = message.and_then(|message| self.decoder.read_record_batch(&block, &message));
        batch.transpose()
    }
}

fn open_file(bytes: Vec<u8>) -> Result<(SchemaRef, Batches), Vec<Fault>> {
    let mut budget = Budget::of_file(bytes.len() as u64);
    // A copy begins at a place that numbers may stand at.
    let footer = footer_of(&bytes).map_err(damaged)?.to_vec();
    let footer = root_as_footer(&footer).map_err(damaged)?;
    let schema = footer
        .schema()
        .ok_or_else(|| damaged("its footer names no columns"))?;
    let schema = Arc::new(try_fb_to_schema(schema).map_err(damaged)?);
    let bytes = Buffer::from_vec(bytes);
    let mut decoder = FileDecoder::new(schema.clone(), footer.version());
    for block in footer.dictionaries().iter().flatten() {
        let message = take_message(&bytes, block, &mut budget)?;
        decoder.read_dictionary(block, &message).map_err(damaged)?;
    }
    let blocks: Vec<Block> = footer.recordBatches().iter().flatten().copied().collect();
    for block in &blocks {
        take_message(&bytes, block, &mut budget)?;
    }
    let blocks = blocks.into_iter();
    let file = File {
        bytes,
        decoder,
        blocks,
    };
    Ok((schema, Box::new(file)))
}

/// The footer of a file: its length and the magic stand behind it.
fn footer_of(bytes: &[u8]) -> Result<&[u8], ArrowError> {
    let cut = || ArrowError::ParseError("the file is cut off".to_owned());
    let (rest, trailer) = bytes.split_last_chunk::<10>().ok_or_else(cut)?;
    let length = read_footer_length(*trailer)?;
    let start = rest.len().checked_sub(length).ok_or_else(cut)?;
    Ok(&rest[start..])
}

/// As [`message_of`]; what it unpacks to is taken from the budget.
fn take_message(bytes: &Buffer, block: &Block, budget: &mut Budget) -> Result<Buffer, Vec<Fault>> {
    let message = message_of(bytes, block).map_err(damaged)?;
    messages::check_block(&message, block.metaDataLength(), budget)?;
    Ok(message)
}

/// The head of a block and its body.
fn message_of(bytes: &Buffer, block: &Block) -> Result<Buffer, ArrowError> {
    let span =
        span_of(block).filter(|(start, length)| *length <= bytes.len().saturating_sub(*start));
    let outside = || ArrowError::ParseError("a batch lies outside of the file".to_owned());
    let (start, length) = span.ok_or_else(outside)?;
    Ok(bytes.slice_with_length(start, length))
}

/// Where a block begins, and how long it is.
fn span_of(block: &Block) -> Option<(usize, usize)> {
    let length = i64::from(block.metaDataLength()).checked_add(block.bodyLength())?;
    Some((
        usize::try_from(block.offset()).ok()?,
        usize::try_from(length).ok()?,
    ))
}
