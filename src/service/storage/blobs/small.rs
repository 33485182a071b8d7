//! Contents of small files that were read last, kept in memory: a content never changes.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Bytes of a file that is kept, and of all together; then all are forgotten.
const SMALL_BYTES: u64 = 256 << 10;
const MOST_BYTES: usize = 16 << 20;

#[derive(Debug, Default)]
pub(super) struct Small(Mutex<HashMap<String, Arc<[u8]>>>);

impl Small {
    pub fn is_small(bytes: u64) -> bool {
        bytes <= SMALL_BYTES
    }

    pub fn get(&self, sha256: &str) -> Option<Arc<[u8]>> {
        self.kept().get(sha256).cloned()
    }

    pub fn keep(&self, sha256: &str, content: Arc<[u8]>) {
        let mut kept = self.kept();
        let bytes: usize = kept.values().map(|content| content.len()).sum();
        if bytes + content.len() > MOST_BYTES {
            kept.clear();
        }
        kept.insert(sha256.to_owned(), content);
    }

    fn kept(&self) -> std::sync::MutexGuard<'_, HashMap<String, Arc<[u8]>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contents_are_kept_until_they_are_too_many() {
        let small = Small::default();
        for number in 0..1_000 {
            small.keep(&number.to_string(), Arc::from(vec![1; 100_000]));
            assert!(small.kept().len() <= MOST_BYTES / 100_000);
        }
        assert!(small.get("999").is_some() && small.get("0").is_none());
    }
}
