//! ASTERIX, Eurocontrol's binary messages of surveillance: recordings of radars, multilateration, ADS-B and trackers.
//!
//! A file is read in steps: packets of a capture ([`capture`]), frames of a recorder around blocks ([`framing`]), items of
//! records by the tables of [`uap`] ([`walk`]), what they say ([`items`]), and what becomes of each record ([`gather`]).
//! Tables follow asterix-specs (BSD-3).

mod capture;
mod editions;
pub mod encode;
mod framing;
mod gather;
mod items;
mod network;
mod octets;
mod repeats;
mod shape;
mod stream;
mod times;
mod uap;
mod walk;

pub(super) use stream::Stream;

use super::feed::Feed;
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;
use crate::model::time::TimeBase;
use std::collections::BTreeMap;
use std::io::BufRead;

/// What a user says of a file.
#[derive(Debug, Clone, Default)]
pub struct Told {
    /// `None`: detections where the file has any, else tracks, else truth, by the default of each category.
    pub kind: Option<DatasetKind>,
    /// Category → edition: `021` → `0.26`. Others are told from the records.
    pub editions: BTreeMap<String, String>,
    /// A time (Unix seconds) of the day of the first record: records say times of day alone. `None`: that of the capture.
    pub day_s: Option<f64>,
    /// Whether simulated targets, test targets and fixed transponders are read, too.
    pub with_test_targets: bool,
}

/// What a file says.
pub struct Decoded {
    pub feed: Feed,
    /// What its reports are.
    pub kind: DatasetKind,
    /// How many records could be of each kind: a plot with a track number of detections and of tracks.
    pub held: BTreeMap<DatasetKind, u64>,
    pub time_base: TimeBase,
    /// What was around its blocks.
    pub framing: &'static str,
}

/// Reads a recording. Memory is bounded by the size of the file.
///
/// # Errors
/// `unsupported` where blocks are framed in no known way, `unsupported_edition` where a category is of no edition that is
/// read, `unknown_value` for an edition that was told, `malformed` where the input cannot be read, `empty`.
pub fn decode(input: &mut dyn BufRead, told: &Told) -> Result<Decoded, Vec<Fault>> {
    let mut file = Vec::new();
    if let Err(error) = input.read_to_end(&mut file) {
        let detail = format!("the file cannot be read: {error}");
        return Err(vec![Fault::new("/file", "malformed", detail)]);
    }
    if file.is_empty() {
        return Err(vec![Fault::new("/file", "empty", "the file is empty")]);
    }
    let framing = framing::tell(&file)?;
    let chosen = editions::choose(&file, framing, told)?;
    let kind = told.kind.unwrap_or_else(|| default_kind(&chosen.uaps));
    let mut gathering = gather::Gathering::new(kind, told);
    let mut items = walk::Items::default();
    for payload in capture::payloads(&file) {
        for piece in framing::pieces(payload, framing) {
            gathering.take(piece, &chosen.uaps, &mut items);
        }
    }
    let time_base = gathering.clock.base();
    let mut feed = gathering.feed;
    feed.warnings.extend(chosen.warnings);
    Ok(Decoded {
        feed,
        kind,
        held: gathering.held,
        time_base,
        framing: framing.name(),
    })
}

/// Detections where a category of the file is read as such, else tracks, else truth.
fn default_kind(uaps: &BTreeMap<u8, uap::Uap>) -> DatasetKind {
    [
        DatasetKind::Detections,
        DatasetKind::Tracks,
        DatasetKind::Truth,
    ]
    .into_iter()
    .find(|kind| {
        uaps.keys()
            .any(|category| items::kinds_of(*category).first() == Some(kind))
    })
    .unwrap_or(DatasetKind::Detections)
}
