//! Local copies of a bucket's objects: as trustworthy as a directory of blobs, and no more than fit.

use super::directory::Directory;
use anyhow::Context;
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, SystemTime};

/// A copy that was asked for this recently is not removed: whoever asked may not have opened it yet.
const RECENT: Duration = Duration::from_secs(60);

/// All calls block.
#[derive(Debug)]
pub struct Cache {
    directory: Directory,
    limit_bytes: u64,
    /// At least what the copies take; counted anew when it passes the limit.
    used_bytes: AtomicU64,
}

impl Cache {
    /// Copies that an earlier process left are used again.
    pub fn open(root: PathBuf, limit_bytes: u64) -> anyhow::Result<Cache> {
        let directory = Directory::open(root)?;
        let files = directory.files().context("cannot list the cached blobs")?;
        let used_bytes = files
            .iter()
            .map(|(_, metadata)| metadata.len())
            .sum::<u64>()
            .into();
        Ok(Cache {
            directory,
            limit_bytes,
            used_bytes,
        })
    }

    /// Where the copy is, or would be.
    pub fn path(&self, sha256: &str) -> PathBuf {
        self.directory.path(sha256)
    }

    /// The copy, if there is one; it is the newest from now on.
    pub fn find(&self, sha256: &str) -> Option<PathBuf> {
        let path = self.directory.path(sha256);
        // A file's time may be set by whoever may write it; opening for writing changes nothing else.
        let file = File::options().write(true).open(&path).ok()?;
        if let Err(error) = file.set_modified(SystemTime::now()) {
            tracing::warn!(%error, "a cached blob could not be marked as used");
        }
        Some(path)
    }

    /// Makes a file the copy of the blob of its SHA-256, then removes the oldest copies while they are too many.
    pub fn adopt(&self, received: &Path, sha256: &str) -> anyhow::Result<PathBuf> {
        let bytes = fs::metadata(received)
            .context("cannot look at a blob")?
            .len();
        self.directory.adopt(received, sha256)?;
        if self.used_bytes.fetch_add(bytes, Ordering::Relaxed) + bytes > self.limit_bytes {
            self.trim(SystemTime::now())
                .context("cannot tidy up the cached blobs")?;
        }
        Ok(self.directory.path(sha256))
    }

    pub fn remove(&self, sha256: &str) -> anyhow::Result<()> {
        self.directory.remove(sha256)
    }

    /// Removes the oldest copies until the rest takes nine tenths of the limit, so that not every new copy asks for this.
    fn trim(&self, now: SystemTime) -> anyhow::Result<()> {
        let mut files = Vec::new();
        for (path, metadata) in self.directory.files()? {
            files.push((metadata.modified()?, metadata.len(), path));
        }
        files.sort();
        let mut used_bytes: u64 = files.iter().map(|(_, bytes, _)| bytes).sum();
        for (modified, bytes, path) in files {
            let is_recent =
                now.duration_since(modified).is_ok_and(|age| age < RECENT) || modified > now;
            if is_recent || used_bytes <= self.limit_bytes / 10 * 9 {
                break;
            }
            match fs::remove_file(&path) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(error.into()),
                _ => used_bytes -= bytes,
            }
        }
        self.used_bytes.store(used_bytes, Ordering::Relaxed);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A copy of 100 bytes, last asked for so many seconds ago.
    fn add(cache: &Cache, directory: &Path, sha256: &str, age_s: u64) {
        let received = directory.join("received");
        fs::write(&received, [7; 100]).unwrap();
        let asked = SystemTime::now() - Duration::from_secs(age_s);
        File::options()
            .write(true)
            .open(&received)
            .unwrap()
            .set_modified(asked)
            .unwrap();
        cache.adopt(&received, sha256).unwrap();
    }

    fn names(cache: &Cache) -> Vec<String> {
        let mut names: Vec<String> = cache
            .directory
            .files()
            .unwrap()
            .into_iter()
            .map(|(path, _)| path.file_name().unwrap().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn the_copies_that_were_not_asked_for_longest_make_room() {
        let directory = tempfile::tempdir().unwrap();
        let cache = Cache::open(directory.path().join("cache"), 450).unwrap();
        for (sha256, age_s) in [("aa1", 900), ("bb2", 800), ("cc3", 700), ("dd4", 600)] {
            add(&cache, directory.path(), sha256, age_s);
        }
        assert_eq!(
            names(&cache),
            ["aa1", "bb2", "cc3", "dd4"],
            "400 of 450 bytes"
        );
        assert_eq!(cache.find("aa1"), Some(cache.path("aa1")));
        assert_eq!(cache.find("ee5"), None);
        add(&cache, directory.path(), "ee5", 500);
        assert_eq!(
            names(&cache),
            ["aa1", "cc3", "dd4", "ee5"],
            "the one just asked for is the newest; 400 of 405 bytes"
        );
        assert_eq!(cache.used_bytes.load(Ordering::Relaxed), 400);
        let reopened = Cache::open(directory.path().join("cache"), 450).unwrap();
        assert_eq!(reopened.used_bytes.load(Ordering::Relaxed), 400);
    }

    #[test]
    fn a_copy_that_was_just_asked_for_stays_even_when_there_is_no_room() {
        let directory = tempfile::tempdir().unwrap();
        let cache = Cache::open(directory.path().join("cache"), 150).unwrap();
        add(&cache, directory.path(), "aa1", 0);
        add(&cache, directory.path(), "bb2", 0);
        assert_eq!(names(&cache), ["aa1", "bb2"]);
        cache.trim(SystemTime::now() + 2 * RECENT).unwrap();
        assert_eq!(names(&cache).len(), 1);
    }
}
