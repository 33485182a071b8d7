//! Records that come twice, as a recording of two networks has them all.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

/// So many records are remembered at least, and twice as many at most.
const REMEMBERED: usize = 1 << 16;

/// Remembers the latest records by a hash of 64 bits.
#[derive(Default)]
pub struct Repeats {
    recent: HashSet<u64>,
    older: HashSet<u64>,
}

impl Repeats {
    /// Whether the same octets, the time of day among them, were seen lately.
    pub fn again(&mut self, category: u8, record: &[u8]) -> bool {
        let mut hasher = DefaultHasher::new();
        (category, record).hash(&mut hasher);
        let hash = hasher.finish();
        if self.older.contains(&hash) || !self.recent.insert(hash) {
            return true;
        }
        if self.recent.len() == REMEMBERED {
            self.older = std::mem::take(&mut self.recent);
        }
        false
    }
}
