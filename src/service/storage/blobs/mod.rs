//! Blobs: bytes named by their SHA-256, in a directory or in an S3-compatible bucket. The only place that knows which.

#[cfg_attr(not(feature = "s3"), path = "no_bucket.rs")]
mod bucket;
#[cfg(feature = "s3")]
mod cache;
mod directory;
mod url;

pub use url::BucketUrl;

use anyhow::Context;
use bucket::Bucket;
use directory::Directory;
use sha2::{Digest, Sha256};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Nothing stays half-written so long.
const OLD: Duration = Duration::from_secs(24 * 3600);

/// The blobs of one data directory. All calls block, and belong on threads that may.
#[derive(Debug, Clone)]
pub struct Blobs {
    place: Place,
    identity: String,
    temporary: PathBuf,
}

#[derive(Debug, Clone)]
enum Place {
    Directory(Directory),
    Bucket(Arc<Bucket>),
}

impl Blobs {
    /// Makes the directories, throws away what an earlier process left half-written, and tries the bucket if there is one. Where
    /// other processes use the directory as well, this one has a place of its own for what is half-written.
    ///
    /// # Errors
    /// When a directory cannot be made, or the bucket cannot be written, read and removed from.
    pub async fn open(data_dir: &Path, bucket: Option<&BucketUrl>, is_shared: bool) -> anyhow::Result<Blobs> {
        let mut temporary = data_dir.join("tmp");
        if is_shared {
            remove_old(&temporary);
            temporary.push(uuid::Uuid::now_v7().to_string());
        } else if temporary.exists() {
            fs::remove_dir_all(&temporary).with_context(|| format!("cannot empty {}", temporary.display()))?;
        }
        fs::create_dir_all(&temporary).with_context(|| format!("cannot make {}", temporary.display()))?;
        let (place, identity) = match bucket {
            None => {
                let directory = Directory::open(data_dir.join("blobs"))?;
                let identity = directory.identity()?;
                (Place::Directory(directory), identity)
            }
            Some(url) => (Place::Bucket(Arc::new(Bucket::open(url, data_dir, &temporary).await?)), url.to_string()),
        };
        Ok(Blobs { place, identity, temporary })
    }

    /// What tells this place from any other: the bucket's address, or a word that was left in the directory when it was made.
    pub fn identity(&self) -> &str {
        &self.identity
    }

    /// For files on their way in; on the same file system as what is kept here.
    pub fn temporary(&self) -> &Path {
        &self.temporary
    }

    /// Makes a file that a job made the blob of its SHA-256. The file stays where the same content is kept already.
    pub fn keep(&self, made: &Path, sha256: &str) -> anyhow::Result<()> {
        if self.is_surely_kept(sha256) { Ok(()) } else { self.adopt(made, sha256) }
    }

    /// A bucket may have lost an object through another process; writing it again is cheaper than to be wrong.
    fn is_surely_kept(&self, sha256: &str) -> bool {
        matches!(&self.place, Place::Directory(directory) if directory.path(sha256).exists())
    }

    /// Makes a received file the blob of its SHA-256; the file moves away.
    pub fn adopt(&self, received: &Path, sha256: &str) -> anyhow::Result<()> {
        match &self.place {
            Place::Directory(directory) => directory.adopt(received, sha256),
            Place::Bucket(bucket) => bucket.adopt(received, sha256),
        }
    }

    /// A local file with the content of the blob, to be opened soon: a copy of a bucket's object stays for a minute at
    /// least. Nothing is there if there is no such blob.
    pub fn local(&self, sha256: &str) -> anyhow::Result<PathBuf> {
        match &self.place {
            Place::Directory(directory) => Ok(directory.path(sha256)),
            Place::Bucket(bucket) => bucket.local(sha256),
        }
    }

    /// Blobs that were to be removed and may still be there; nothing may need them when they are given to [`Self::remove`]
    /// again.
    pub fn left_over(&self) -> anyhow::Result<Vec<String>> {
        match &self.place {
            Place::Directory(_) => Ok(Vec::new()),
            Place::Bucket(bucket) => bucket.left_over(),
        }
    }

    /// Removes blobs. What a bucket out of reach still has is left over, and no error.
    pub fn remove(&self, blobs: &[String]) -> anyhow::Result<()> {
        match &self.place {
            Place::Directory(directory) => blobs.iter().try_for_each(|sha256| directory.remove(sha256)),
            Place::Bucket(bucket) => bucket.remove(blobs),
        }
    }
}

/// Throws away what processes that are long gone have left half-written.
fn remove_old(temporary: &Path) {
    let is_old = |entry: &fs::DirEntry| {
        let changed = entry.metadata().and_then(|data| data.modified()).ok();
        changed.and_then(|changed| changed.elapsed().ok()).is_some_and(|age| age > OLD)
    };
    for entry in fs::read_dir(temporary).into_iter().flatten().flatten().filter(is_old) {
        let _ = fs::remove_dir_all(entry.path());
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

    #[tokio::test]
    async fn the_same_bytes_are_one_file_under_their_published_hash() {
        let directory = tempfile::tempdir().unwrap();
        let blobs = Blobs::open(directory.path(), None, false).await.unwrap();
        let (made, sha256) = (directory.path().join("made"), sha256_hex(b"abc"));
        fs::write(&made, b"abc").unwrap();
        blobs.keep(&made, &sha256).unwrap();
        assert_eq!(sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        assert!(!made.exists());
        fs::write(&made, b"abc").unwrap();
        blobs.keep(&made, &sha256).unwrap();
        assert!(made.exists(), "it is kept already");
        let path = blobs.local(&sha256).unwrap();
        assert_eq!(path, directory.path().join("blobs/ba").join(&sha256));
        assert_eq!(fs::read(&path).unwrap(), b"abc");
        assert_eq!(fs::read_dir(blobs.temporary()).unwrap().count(), 0);
        blobs.remove(std::slice::from_ref(&sha256)).unwrap();
        blobs.remove(&[sha256]).unwrap();
        assert!(!path.exists());
        assert!(blobs.left_over().unwrap().is_empty());
    }

    #[tokio::test]
    async fn opening_throws_away_half_written_files() {
        let directory = tempfile::tempdir().unwrap();
        let blobs = Blobs::open(directory.path(), None, false).await.unwrap();
        fs::write(blobs.temporary().join("half"), b"x").unwrap();
        Blobs::open(directory.path(), None, false).await.unwrap();
        assert_eq!(fs::read_dir(blobs.temporary()).unwrap().count(), 0);
    }

    #[tokio::test]
    async fn processes_that_share_a_directory_leave_each_others_files_alone_and_know_it_again() {
        let (directory, other) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let first = Blobs::open(directory.path(), None, true).await.unwrap();
        fs::write(first.temporary().join("half"), b"x").unwrap();
        let second = Blobs::open(directory.path(), None, true).await.unwrap();
        assert!(first.temporary().join("half").exists());
        assert_eq!(first.identity(), second.identity());
        let elsewhere = Blobs::open(other.path(), None, true).await.unwrap();
        assert_ne!(first.identity(), elsewhere.identity());
    }

    #[cfg(not(feature = "s3"))]
    #[tokio::test]
    async fn a_bucket_is_refused_by_a_program_that_was_built_without() {
        let directory = tempfile::tempdir().unwrap();
        let refused = Blobs::open(directory.path(), Some(&"s3://tracks/lab".parse().unwrap()), false).await.unwrap_err();
        assert_eq!(
            refused.to_string(),
            "artefacts cannot be kept at s3://tracks/lab: this trackloom was built without the feature s3 \
             (cargo build --release --features s3)"
        );
    }
}
