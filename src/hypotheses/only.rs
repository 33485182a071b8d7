//! What each of several tracks may have caused, where that is known before its gate is.

use std::ops::Range;

/// Lists of detections, of one track after the other; memory is reused.
#[derive(Debug, Clone, Default)]
pub struct Only {
    detections: Vec<u32>,
    /// Of each track; none where all may be.
    lists: Vec<Option<Range<usize>>>,
}

impl Only {
    pub fn clear(&mut self) {
        self.detections.clear();
        self.lists.clear();
    }

    /// The next track; without a list all detections may be its.
    pub fn push(&mut self, list: Option<impl Iterator<Item = u32>>) {
        let from = self.detections.len();
        let range = list.map(|list| {
            self.detections.extend(list);
            from..self.detections.len()
        });
        self.lists.push(range);
    }

    /// The list of a track.
    #[inline]
    pub fn of(&self, track: usize) -> Option<&[u32]> {
        let range = self.lists.get(track)?.clone()?;
        Some(&self.detections[range])
    }
}
