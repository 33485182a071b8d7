//! Whether a file still has the content of its name. It is read for that once in each process, and again when it has become another.

use super::{Damaged, hex};
use anyhow::Context;
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::fs::{File, Metadata};
use std::io::Read;
use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Files that are remembered; beyond it all are looked at anew.
const MOST: usize = 200_000;
const CHUNK_BYTES: usize = 1 << 16;

/// What tells a file from another that takes its place. A cache sets times of its files, so there they do not count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Identity {
    device: u64,
    inode: u64,
    bytes: u64,
    modified: Option<(i64, i64)>,
}

impl Identity {
    fn of(metadata: &Metadata, times_count: bool) -> Identity {
        let modified = times_count.then(|| (metadata.mtime(), metadata.mtime_nsec()));
        Identity {
            device: metadata.dev(),
            inode: metadata.ino(),
            bytes: metadata.len(),
            modified,
        }
    }
}

/// The files that were found whole.
#[derive(Debug)]
pub(super) struct Verified {
    times_count: bool,
    files: Mutex<HashMap<String, Identity>>,
}

impl Verified {
    pub fn new(times_count: bool) -> Verified {
        Verified {
            times_count,
            files: Mutex::default(),
        }
    }

    /// Reads the file unless it was read before. Blocks.
    ///
    /// # Errors
    /// [`Damaged`] when it has another content; also when it cannot be read.
    pub fn check(&self, sha256: &str, path: &Path) -> anyhow::Result<()> {
        let mut file =
            File::open(path).with_context(|| format!("cannot open {}", path.display()))?;
        let identity = Identity::of(
            &file.metadata().context("cannot look at a blob")?,
            self.times_count,
        );
        if self.lock().get(sha256) == Some(&identity) {
            return Ok(());
        }
        let found = hash(&mut file).with_context(|| format!("cannot read {}", path.display()))?;
        if found != sha256 {
            tracing::error!(path = %path.display(), found, "a file is damaged: it has not the content of its name");
            return Err(Damaged.into());
        }
        let mut files = self.lock();
        if files.len() >= MOST {
            files.clear();
        }
        files.insert(sha256.to_owned(), identity);
        Ok(())
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<String, Identity>> {
        self.files.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

pub(super) fn hash(file: &mut File) -> std::io::Result<String> {
    let (mut hash, mut chunk) = (Sha256::new(), vec![0; CHUNK_BYTES]);
    loop {
        match file.read(&mut chunk)? {
            0 => return Ok(hex(&hash.finalize())),
            length => hash.update(&chunk[..length]),
        }
    }
}
