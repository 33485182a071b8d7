//! A directory of files named by the SHA-256 of their content. A file appears by an atomic rename of a complete one, which is on the disk
//! or whose content is about to be noted in the tables.

use super::ReceivedFile;
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
            fs::write(&ours, uuid::Uuid::now_v7().to_string())
                .with_context(|| format!("cannot write to {}", self.root.display()))?;
            let _ = fs::hard_link(&ours, &path);
            fs::remove_file(&ours).context("cannot remove a file of blobs")?;
        }
        fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))
    }

    /// Where the blob is, or would be.
    pub fn path(&self, sha256: &str) -> PathBuf {
        self.root.join(shard(sha256)).join(sha256)
    }

    /// Makes a file on the same file system the blob of its SHA-256; it is on the disk afterwards.
    pub fn adopt(&self, received: &Path, sha256: &str) -> anyhow::Result<()> {
        File::open(received)
            .and_then(|file| file.sync_all())
            .context("cannot sync a blob")?;
        self.move_in(received, sha256)?;
        // The rename itself is only safe once the directory is on the disk.
        let path = self.path(sha256);
        let directory = path.parent().unwrap_or(&self.root);
        File::open(directory)
            .and_then(|directory| directory.sync_all())
            .context("cannot sync the directory of a blob")
    }

    /// Makes a file the blob of its SHA-256, which a power failure may still take away. One that has moved before is there.
    pub fn move_in(&self, received: &Path, sha256: &str) -> anyhow::Result<()> {
        let path = self.path(sha256);
        fs::create_dir_all(path.parent().unwrap_or(&self.root))
            .context("cannot make a directory for blobs")?;
        match fs::rename(received, &path) {
            Err(error) if error.kind() == ErrorKind::NotFound && path.exists() => Ok(()),
            moved => moved.context("cannot move a blob into place"),
        }
    }

    /// The same for many; they are on the disk afterwards, by two syncs for all of them.
    pub fn adopt_all(&self, files: &[ReceivedFile]) -> anyhow::Result<()> {
        self.sync()?;
        files
            .iter()
            .try_for_each(|file| self.move_in(&file.path, &file.sha256))?;
        self.sync()
    }

    /// Everything that was written to this file system is on the disk afterwards.
    #[cfg(target_os = "linux")]
    pub fn sync(&self) -> anyhow::Result<()> {
        let synced = File::open(&self.root)
            .and_then(|directory| rustix::fs::syncfs(directory).map_err(std::io::Error::from));
        synced.with_context(|| format!("cannot sync {}", self.root.display()))
    }

    /// Elsewhere there is no such call for one file system; this one asks for all of them.
    #[cfg(not(target_os = "linux"))]
    pub fn sync(&self) -> anyhow::Result<()> {
        rustix::fs::sync();
        Ok(())
    }

    pub fn remove(&self, sha256: &str) -> anyhow::Result<()> {
        match fs::remove_file(self.path(sha256)) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                Err(error).context("cannot remove a blob")
            }
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
