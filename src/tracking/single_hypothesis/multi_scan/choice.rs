//! The ways that are chosen, as they are told.

use std::ops::Range;

/// A point of a way.
#[derive(Debug, Clone, Copy)]
pub(in crate::tracking::single_hypothesis) struct Past<B> {
    /// Its layer.
    pub layer: u32,
    /// Its index in its scan; none where the scan missed it.
    pub detection: Option<u32>,
    pub origin: Option<u32>,
    pub log_ratio: f64,
    pub share: f64,
    pub nis: Option<f64>,
    pub belief: B,
}

/// The ways that are chosen.
#[derive(Debug)]
pub(in crate::tracking::single_hypothesis) struct Choice<B> {
    pub(super) ways: Vec<Chosen>,
    pub(super) pasts: Vec<Past<B>>,
    /// The numbers of their detections.
    pub(super) numbers: Vec<u32>,
    /// Ways that were cut.
    pub cut: u64,
    pub is_exact: bool,
}

/// Where its points and its detections are.
#[derive(Debug, Clone)]
pub(super) struct Chosen {
    pub pasts: Range<usize>,
    pub numbers: Range<usize>,
}

impl<B> Default for Choice<B> {
    fn default() -> Self {
        Choice {
            ways: Vec::new(),
            pasts: Vec::new(),
            numbers: Vec::new(),
            cut: 0,
            is_exact: true,
        }
    }
}

impl<B> Choice<B> {
    pub(super) fn clear(&mut self) {
        self.ways.clear();
        self.pasts.clear();
        self.numbers.clear();
        (self.cut, self.is_exact) = (0, true);
    }

    /// Points and numbers of each, in the order of their roots.
    pub fn ways(&self) -> impl Iterator<Item = (&[Past<B>], &[u32])> {
        let ways = self.ways.iter();
        ways.map(|way| {
            let pasts = &self.pasts[way.pasts.clone()];
            (pasts, &self.numbers[way.numbers.clone()])
        })
    }
}
