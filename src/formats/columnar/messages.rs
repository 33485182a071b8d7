//! The messages of Arrow IPC, looked at before any is unpacked.

use super::budget::Budget;
use super::damaged;
use crate::model::fault::Fault;
use arrow_ipc::{Message, RecordBatch, root_as_message};

/// Stands before the length of a message since version 0.15 of the format.
const CONTINUATION: [u8; 4] = [0xff; 4];

/// Adds up what the buffers say that they unpack to; what is cut off is left to the decoder.
///
/// # Errors
/// More than the [`Budget`]; damaged heads.
pub fn check(messages: &[u8], budget: &mut Budget) -> Result<(), Vec<Fault>> {
    let mut rest = messages;
    while let Some((head, after)) = split_head(rest) {
        let message = root_as_message(head).map_err(damaged)?;
        let Some((body, after)) = split(after, message.bodyLength()) else {
            break;
        };
        take_sizes(&message, body, budget)?;
        rest = after;
    }
    Ok(())
}

/// As [`check`], of one message of a file, whose body is where the footer says, whatever the message says.
///
/// # Errors
/// More than the [`Budget`]; a damaged head; a body outside of the message.
pub fn check_block(bytes: &[u8], head_bytes: i32, budget: &mut Budget) -> Result<(), Vec<Fault>> {
    let head = bytes.strip_prefix(&CONTINUATION).unwrap_or(bytes);
    let message = root_as_message(head.get(4..).unwrap_or_default()).map_err(damaged)?;
    let start = usize::try_from(head_bytes).ok();
    let body = start.and_then(|start| bytes.get(start..));
    let body = body.ok_or_else(|| damaged("a batch has no body"))?;
    take_sizes(&message, body, budget)
}

fn take_sizes(message: &Message, body: &[u8], budget: &mut Budget) -> Result<(), Vec<Fault>> {
    for bytes in unpacked_sizes(message, body) {
        budget.take(bytes).map_err(|fault| vec![fault])?;
    }
    Ok(())
}

/// The head of a message, and what follows it; `None` at the end.
fn split_head(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let bytes = bytes.strip_prefix(&CONTINUATION).unwrap_or(bytes);
    let (length, rest) = bytes.split_first_chunk::<4>()?;
    let length = i64::from(i32::from_le_bytes(*length));
    split(rest, length).filter(|_| length > 0)
}

fn split(bytes: &[u8], length: i64) -> Option<(&[u8], &[u8])> {
    bytes.split_at_checked(usize::try_from(length).ok()?)
}

/// Of each packed buffer: its first eight bytes. Negative ones say that it is not packed.
fn unpacked_sizes(message: &Message, body: &[u8]) -> Vec<u64> {
    let Some(batch) = batch_of(message).filter(|batch| batch.compression().is_some()) else {
        return Vec::new();
    };
    let mut sizes = Vec::new();
    for buffer in batch.buffers().into_iter().flatten() {
        let start = usize::try_from(buffer.offset()).unwrap_or(usize::MAX);
        let head = body.get(start..).and_then(<[u8]>::first_chunk::<8>);
        let size = head.map_or(0, |head| i64::from_le_bytes(*head));
        if buffer.length() > 0 {
            sizes.push(u64::try_from(size).unwrap_or(0));
        }
    }
    sizes
}

fn batch_of<'m>(message: &Message<'m>) -> Option<RecordBatch<'m>> {
    let dictionary = message.header_as_dictionary_batch();
    message
        .header_as_record_batch()
        .or_else(|| dictionary.and_then(|dictionary| dictionary.data()))
}
