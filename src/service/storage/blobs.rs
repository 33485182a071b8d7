//! Files named by the SHA-256 of their content. A file appears by an atomic rename of a complete, synced one.

use anyhow::Context;
use sha2::{Digest, Sha256};
use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// The blobs of one data directory. All calls block.
#[derive(Debug, Clone)]
pub struct Blobs {
    directory: PathBuf,
    temporary: PathBuf,
}

impl Blobs {
    /// Makes the directories and throws away what an earlier process left half-written.
    pub fn open(data_dir: &Path) -> anyhow::Result<Blobs> {
        let blobs = Blobs { directory: data_dir.join("blobs"), temporary: data_dir.join("tmp") };
        if blobs.temporary.exists() {
            fs::remove_dir_all(&blobs.temporary).with_context(|| format!("cannot empty {}", blobs.temporary.display()))?;
        }
        for directory in [&blobs.directory, &blobs.temporary] {
            fs::create_dir_all(directory).with_context(|| format!("cannot make {}", directory.display()))?;
        }
        Ok(blobs)
    }

    /// For files on their way in; on the same file system as the blobs.
    pub fn temporary(&self) -> &Path {
        &self.temporary
    }

    /// Where the blob is.
    pub fn path(&self, sha256: &str) -> PathBuf {
        self.directory.join(sha256.get(..2).unwrap_or("xx")).join(sha256)
    }

    /// Keeps `bytes`; gives their SHA-256.
    pub fn put(&self, bytes: &[u8]) -> anyhow::Result<String> {
        let sha256 = sha256_hex(bytes);
        if !self.path(&sha256).exists() {
            let received = self.temporary.join(uuid::Uuid::now_v7().to_string());
            File::create(&received).and_then(|mut file| file.write_all(bytes)).context("cannot write a blob")?;
            self.adopt(&received, &sha256)?;
        }
        Ok(sha256)
    }

    /// Makes a received file the blob of its SHA-256.
    pub fn adopt(&self, received: &Path, sha256: &str) -> anyhow::Result<()> {
        let path = self.path(sha256);
        let directory = path.parent().unwrap_or(&self.directory);
        fs::create_dir_all(directory).context("cannot make a directory for blobs")?;
        File::open(received).and_then(|file| file.sync_all()).context("cannot sync a blob")?;
        fs::rename(received, &path).context("cannot move a blob into place")?;
        // The rename itself is only safe once the directory is on the disk.
        File::open(directory).and_then(|directory| directory.sync_all()).context("cannot sync the directory of a blob")
    }

    pub fn remove(&self, sha256: &str) -> anyhow::Result<()> {
        match fs::remove_file(self.path(sha256)) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(error).context("cannot remove a blob"),
            _ => Ok(()),
        }
    }
}

/// SHA-256 in lower-case hex.
pub fn sha256_hex(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Bytes of a hash in lower-case hex.
pub fn hex(hash: &[u8]) -> String {
    hash.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_bytes_are_one_file_under_their_published_hash() {
        let directory = tempfile::tempdir().unwrap();
        let blobs = Blobs::open(directory.path()).unwrap();
        let sha256 = blobs.put(b"abc").unwrap();
        assert_eq!(sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        assert_eq!(blobs.put(b"abc").unwrap(), sha256);
        assert_eq!(fs::read(blobs.path(&sha256)).unwrap(), b"abc");
        assert_eq!(fs::read_dir(blobs.temporary()).unwrap().count(), 0);
        blobs.remove(&sha256).unwrap();
        blobs.remove(&sha256).unwrap();
        assert!(!blobs.path(&sha256).exists());
    }

    #[test]
    fn opening_throws_away_half_written_files() {
        let directory = tempfile::tempdir().unwrap();
        let blobs = Blobs::open(directory.path()).unwrap();
        fs::write(blobs.temporary().join("half"), b"x").unwrap();
        Blobs::open(directory.path()).unwrap();
        assert_eq!(fs::read_dir(blobs.temporary()).unwrap().count(), 0);
    }
}
