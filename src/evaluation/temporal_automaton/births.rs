//! Where the start state leads: at which time and on which symbol a track may be born.
//!
//! A string of decided symbols is born with its first symbol. With choices (`all_gated`) a string may also be born later,
//! where it may have been ε so long that what was before it does not belong to the same string.

use crate::evaluation::strings::normal_form::{StringSet, TrackString};
use crate::evaluation::strings::step::EPSILON;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Birth {
    pub time: u32,
    pub symbol: u32,
    /// Index of the string, and how many of its steps are before the first one that is read.
    pub string: u32,
    pub offset: u32,
}

/// Every birth, in order of time and symbol.
#[derive(Debug)]
pub struct Births(Vec<Birth>);

impl Births {
    pub fn new(outputs: &StringSet) -> Self {
        let mut births = Vec::with_capacity(outputs.strings().len());
        for (index, string) in outputs.strings().iter().enumerate() {
            let may_begin = |offset: usize| {
                let passed = outputs.max_missed().min(offset);
                (offset - passed..offset).all(|before| may_be_nothing(outputs, string, before))
            };
            let offsets = if outputs.has_choices() {
                string.steps().len()
            } else {
                1
            };
            for offset in (0..offsets).filter(|&offset| may_begin(offset)) {
                let real = outputs
                    .choices_at(string.first_step + offset)
                    .filter(|&(symbol, _)| symbol != EPSILON);
                let time = (string.start + offset) as u32;
                births.extend(real.map(|(symbol, _)| Birth {
                    time,
                    symbol,
                    string: index as u32,
                    offset: offset as u32,
                }));
            }
        }
        births.sort_unstable();
        Births(births)
    }

    pub fn all(&self) -> &[Birth] {
        &self.0
    }

    /// The births on one symbol at one time.
    pub fn on(&self, time: u32, symbol: u32) -> &[Birth] {
        let from = self
            .0
            .partition_point(|birth| (birth.time, birth.symbol) < (time, symbol));
        let count = self.0[from..]
            .iter()
            .take_while(|birth| (birth.time, birth.symbol) == (time, symbol))
            .count();
        &self.0[from..from + count]
    }
}

/// Whether a string may end with the step at `offset`: what follows may be ε so long that it belongs to the string no more.
pub fn may_end(outputs: &StringSet, string: &TrackString, offset: usize) -> bool {
    let behind = offset + 1..string.steps().len().min(offset + 1 + outputs.max_missed());
    behind
        .into_iter()
        .all(|behind| may_be_nothing(outputs, string, behind))
}

fn may_be_nothing(outputs: &StringSet, string: &TrackString, offset: usize) -> bool {
    outputs
        .weight_of(string.first_step + offset, EPSILON)
        .is_some()
}
