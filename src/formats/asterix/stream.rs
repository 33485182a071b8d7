//! Blocks as they come, one after another or in datagrams.

use super::Told;
use super::capture::{Content, Payload};
use super::editions::{named, of_first_blocks};
use super::framing::{Block, Framing, Piece, pieces};
use super::gather::Gathering;
use super::uap::{Edition, Uap, editions_of};
use super::walk::Items;
use crate::formats::Reason;
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;
use std::collections::BTreeMap;

/// Identities that are known at most; beyond it they are made known anew.
const MOST_IDENTITIES: usize = 200_000;

/// A stream of blocks. The edition of a category is told from the first piece that holds it.
pub struct Stream {
    pub gathering: Gathering,
    uaps: BTreeMap<u8, Uap>,
    named: BTreeMap<u8, &'static Edition>,
}

impl Stream {
    /// # Errors
    /// An edition that was told and is not known.
    pub fn new(told: Told) -> Result<Self, Vec<Fault>> {
        let kind = told.kind.unwrap_or(DatasetKind::Detections);
        Ok(Stream {
            named: named(&told)?,
            gathering: Gathering::new(kind, &told),
            uaps: BTreeMap::new(),
        })
    }

    /// Takes blocks that came at a time (Unix seconds).
    pub fn take(&mut self, octets: &[u8], arrived_s: f64) {
        let payload = Payload {
            content: Content::Octets(octets),
            captured_s: Some(arrived_s),
        };
        let found: Vec<Piece> = pieces(payload, Framing::Bare).collect();
        self.learn(&found);
        let mut items = Items::default();
        for piece in found {
            if self.is_of_no_edition(&piece) {
                self.gathering.reject(Reason::UnsupportedEdition);
            } else {
                self.gathering.take(piece, &self.uaps, &mut items);
            }
        }
    }

    /// Chooses the editions of categories that come for the first time.
    fn learn(&mut self, found: &[Piece]) {
        let mut new: BTreeMap<u8, Vec<Block>> = BTreeMap::new();
        for piece in found {
            if let Piece::Block(block) = piece
                && self.is_of_no_edition(piece)
            {
                new.entry(block.category).or_default().push(*block);
            }
        }
        for (category, blocks) in new {
            let named = self.named.get(&category).copied();
            if let Ok((uap, warning)) = of_first_blocks(category, named, &blocks) {
                self.uaps.insert(category, uap);
                self.gathering.feed.warnings.extend(warning);
            }
        }
    }

    /// Whether it is of a category that is read, but of no edition that was told so far.
    fn is_of_no_edition(&self, piece: &Piece) -> bool {
        let Piece::Block(block) = piece else {
            return false;
        };
        let is_read = editions_of(block.category).next().is_some();
        is_read && !self.uaps.contains_key(&block.category)
    }

    /// Keeps what is known of identities bounded.
    pub fn forget(&mut self) {
        self.gathering.forget_beyond(MOST_IDENTITIES);
    }
}
