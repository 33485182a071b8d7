//! A directory of files named by the SHA-256 of their content. A file appears by an atomic rename of a complete, synced
//! one.

use anyhow::Context;
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// All calls block.
#[derive(Debug, Clone)]
pub struct Directory {
    root: PathBuf,
}

impl Directory {
    /// Makes the directory where it is missing.
    pub fn open(root: PathBuf) -> anyhow::Result<Directory> {
        fs::create_dir_all(&root).with_context(|| format!("cannot make {}", root.display()))?;
        Ok(Directory { root })
    }

    /// A word that is in this directory and in no other.
    pub fn identity(&self) -> anyhow::Result<String> {
        let path = self.root.join("identity");
        let ours = self.root.join(format!("identity-{}", uuid::Uuid::now_v7()));
        if !path.exists() {
            // Of several that begin at once, one leaves its word; linking fails where there is one.
            fs::write(&ours, uuid::Uuid::now_v7().to_string()).with_context(|| format!("cannot write to {}", self.root.display()))?;
            let _ = fs::hard_link(&ours, &path);
            fs::remove_file(&ours).context("cannot remove a file of blobs")?;
        }
        fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))
    }

    /// Where the blob is, or would be.
    pub fn path(&self, sha256: &str) -> PathBuf {
        self.root.join(shard(sha256)).join(sha256)
    }

    /// Makes a file on the same file system the blob of its SHA-256.
    pub fn adopt(&self, received: &Path, sha256: &str) -> anyhow::Result<()> {
        let path = self.path(sha256);
        let directory = path.parent().unwrap_or(&self.root);
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

    /// The files with what the file system knows of them, in no order.
    #[cfg(feature = "s3")]
    pub fn files(&self) -> std::io::Result<Vec<(PathBuf, fs::Metadata)>> {
        let mut files = Vec::new();
        for shard in fs::read_dir(&self.root)? {
            for file in fs::read_dir(shard?.path())? {
                let file = file?;
                match file.metadata() {
                    Ok(metadata) => files.push((file.path(), metadata)),
                    // Removed meanwhile.
                    Err(error) if error.kind() == ErrorKind::NotFound => {}
                    Err(error) => return Err(error),
                }
            }
        }
        Ok(files)
    }
}

/// The part of a hash that spreads blobs over directories.
pub fn shard(sha256: &str) -> &str {
    sha256.get(..2).unwrap_or("xx")
}
