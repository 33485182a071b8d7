//! Blobs: bytes named by their SHA-256, in a directory or in an S3-compatible bucket. The only place that knows which.

#[cfg_attr(not(feature = "s3"), path = "no_bucket.rs")]
mod bucket;
#[cfg(feature = "s3")]
mod cache;
mod directory;
mod small;
mod url;
mod verified;

pub use url::BucketUrl;

use anyhow::Context;
use bucket::Bucket;
use directory::Directory;
use sha2::{Digest, Sha256};
use small::Small;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use verified::Verified;

/// The files of a job that together are not larger than this are made safe by the tables.
const NOTED_BYTES: u64 = 1 << 20;

/// A file that has not the content of its name; the log says which.
#[derive(Debug, Clone, Copy, thiserror::Error)]
#[error("a stored file is damaged")]
pub struct Damaged;

/// A complete file in [`Blobs::temporary`].
#[derive(Debug, Clone)]
pub struct ReceivedFile {
    pub path: PathBuf,
    /// In lower-case hex, of the content.
    pub sha256: String,
    pub bytes: u64,
}

/// Nothing stays half-written so long.
const OLD: Duration = Duration::from_secs(24 * 3600);

/// The blobs of one data directory. All calls block, and belong on threads that may.
#[derive(Debug, Clone)]
pub struct Blobs {
    place: Place,
    identity: String,
    temporary: PathBuf,
    verified: Arc<Verified>,
    small: Arc<Small>,
}

/// What a blob holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Content {
    /// A small one, in memory.
    Bytes(Arc<[u8]>),
    /// In a local file, to be opened soon.
    File(PathBuf),
}

impl Content {
    /// All bytes. Blocks.
    pub fn read(&self) -> std::io::Result<Arc<[u8]>> {
        match self {
            Content::Bytes(bytes) => Ok(bytes.clone()),
            Content::File(path) => Ok(fs::read(path)?.into()),
        }
    }
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
    pub async fn open(
        data_dir: &Path,
        bucket: Option<&BucketUrl>,
        is_shared: bool,
    ) -> anyhow::Result<Blobs> {
        let mut temporary = data_dir.join("tmp");
        if is_shared {
            remove_old(&temporary);
            temporary.push(uuid::Uuid::now_v7().to_string());
        } else if temporary.exists() {
            fs::remove_dir_all(&temporary)
                .with_context(|| format!("cannot empty {}", temporary.display()))?;
        }
        fs::create_dir_all(&temporary)
            .with_context(|| format!("cannot make {}", temporary.display()))?;
        let (place, identity) = match bucket {
            None => {
                let directory = Directory::open(data_dir.join("blobs"))?;
                let identity = directory.identity()?;
                (Place::Directory(directory), identity)
            }
            Some(url) => (
                Place::Bucket(Arc::new(Bucket::open(url, data_dir, &temporary).await?)),
                url.to_string(),
            ),
        };
        let verified = Arc::new(Verified::new(matches!(place, Place::Directory(_))));
        Ok(Blobs {
            place,
            identity,
            temporary,
            verified,
            small: Arc::default(),
        })
    }

    /// What tells this place from any other: the bucket's address, or a word that was left in the directory when it was made.
    pub fn identity(&self) -> &str {
        &self.identity
    }

    /// For files on their way in; on the same file system as what is kept here.
    pub fn temporary(&self) -> &Path {
        &self.temporary
    }

    /// Writes a file that is to become a blob.
    pub fn receive(&self, bytes: &[u8]) -> anyhow::Result<ReceivedFile> {
        let path = self.temporary.join(uuid::Uuid::now_v7().to_string());
        if let Err(error) = File::create(&path).and_then(|mut file| file.write_all(bytes)) {
            // The next start throws away what stays.
            let _ = fs::remove_file(&path);
            return Err(error).context("cannot write a blob");
        }
        Ok(ReceivedFile {
            path,
            sha256: sha256_hex(bytes),
            bytes: bytes.len() as u64,
        })
    }

    /// Makes all received files blobs; they move away. Gives for each the content that the change which names the blob has to note, for
    /// only then is it safe; `None` where the blob is on the disk already. May be called again for the same files when it has failed.
    pub fn adopt_all(&self, files: &[ReceivedFile]) -> anyhow::Result<Vec<Option<Vec<u8>>>> {
        match &self.place {
            Place::Directory(directory)
                if files.iter().map(|file| file.bytes).sum::<u64>() <= NOTED_BYTES =>
            {
                files
                    .iter()
                    .map(|file| take_in(directory, file).map(Some))
                    .collect()
            }
            Place::Directory(directory) => {
                directory.adopt_all(files)?;
                Ok(vec![None; files.len()])
            }
            Place::Bucket(bucket) => {
                for file in files.iter().filter(|file| file.path.exists()) {
                    bucket.adopt(&file.path, &file.sha256)?;
                }
                Ok(vec![None; files.len()])
            }
        }
    }

    /// Everything that was adopted is on the disk afterwards.
    pub fn sync(&self) -> anyhow::Result<()> {
        match &self.place {
            Place::Directory(directory) => directory.sync(),
            Place::Bucket(_) => Ok(()),
        }
    }

    /// Writes a noted content anew unless its blob is there and whole; [`Self::sync`] has to follow.
    pub fn restore(&self, sha256: &str, content: &[u8]) -> anyhow::Result<()> {
        if let Place::Directory(directory) = &self.place {
            let is_whole = File::open(directory.path(sha256))
                .and_then(|mut file| verified::hash(&mut file))
                .is_ok_and(|found| found == sha256);
            if !is_whole {
                tracing::warn!(
                    sha256,
                    "a file was not whole on the disk; it is written again"
                );
                directory.move_in(&self.receive(content)?.path, sha256)?;
            }
        }
        Ok(())
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
    ///
    /// # Errors
    /// [`Damaged`] when the file has another content.
    pub fn local(&self, sha256: &str) -> anyhow::Result<PathBuf> {
        let path = match &self.place {
            Place::Directory(directory) => directory.path(sha256),
            Place::Bucket(bucket) => bucket.local(sha256)?,
        };
        if path.exists() {
            self.verified.check(sha256, &path)?;
        } else {
            tracing::error!(path = %path.display(), "a file is missing");
        }
        Ok(path)
    }

    /// The content of a blob that was read before and is small; does not block.
    pub fn known(&self, sha256: &str) -> Option<Content> {
        self.small.get(sha256).map(Content::Bytes)
    }

    /// The content of a blob of so many bytes: in memory where it is small.
    ///
    /// # Errors
    /// As [`Self::local`]; also when a small file cannot be read.
    pub fn content(&self, sha256: &str, bytes: u64) -> anyhow::Result<Content> {
        let path = self.local(sha256)?;
        if !Small::is_small(bytes) || !path.exists() {
            return Ok(Content::File(path));
        }
        let content = Content::File(path).read().context("cannot read a blob")?;
        self.small.keep(sha256, content.clone());
        Ok(Content::Bytes(content))
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
            Place::Directory(directory) => {
                blobs.iter().try_for_each(|sha256| directory.remove(sha256))
            }
            Place::Bucket(bucket) => bucket.remove(blobs),
        }
    }
}

/// Moves the file to its place; gives its content.
fn take_in(directory: &Directory, file: &ReceivedFile) -> anyhow::Result<Vec<u8>> {
    directory.move_in(&file.path, &file.sha256)?;
    fs::read(directory.path(&file.sha256)).context("cannot read a blob")
}

/// Throws away what processes that are long gone have left half-written.
fn remove_old(temporary: &Path) {
    let is_old = |entry: &fs::DirEntry| {
        let changed = entry.metadata().and_then(|data| data.modified()).ok();
        changed
            .and_then(|changed| changed.elapsed().ok())
            .is_some_and(|age| age > OLD)
    };
    for entry in fs::read_dir(temporary)
        .into_iter()
        .flatten()
        .flatten()
        .filter(is_old)
    {
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
        let files = [
            blobs.receive(b"abc").unwrap(),
            blobs.receive(b"abc").unwrap(),
            blobs.receive(b"").unwrap(),
        ];
        let sha256 = files[0].sha256.clone();
        assert_eq!(
            sha256,
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
        let contents = [
            Some(b"abc".to_vec()),
            Some(b"abc".to_vec()),
            Some(Vec::new()),
        ];
        assert_eq!(blobs.adopt_all(&files).unwrap(), contents);
        assert_eq!(
            blobs.adopt_all(&files).unwrap(),
            contents,
            "a second try finds them in place"
        );
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
    async fn large_files_are_on_the_disk_at_once() {
        let directory = tempfile::tempdir().unwrap();
        let blobs = Blobs::open(directory.path(), None, false).await.unwrap();
        let files = [
            blobs.receive(&[7; NOTED_BYTES as usize]).unwrap(),
            blobs.receive(b"x").unwrap(),
        ];
        assert_eq!(blobs.adopt_all(&files).unwrap(), [None, None]);
        assert_eq!(
            fs::metadata(blobs.local(&files[0].sha256).unwrap())
                .unwrap()
                .len(),
            NOTED_BYTES
        );
        assert_eq!(
            fs::read(blobs.local(&files[1].sha256).unwrap()).unwrap(),
            b"x"
        );
    }

    #[tokio::test]
    async fn a_file_that_has_changed_is_damaged_and_is_written_anew_from_a_note() {
        let directory = tempfile::tempdir().unwrap();
        let blobs = Blobs::open(directory.path(), None, false).await.unwrap();
        let file = blobs.receive(b"abc").unwrap();
        blobs.adopt_all(std::slice::from_ref(&file)).unwrap();
        let path = blobs.local(&file.sha256).unwrap();
        // Another length, and the same length at a later time.
        for content in [b"ab".as_slice(), b"abd"] {
            std::thread::sleep(Duration::from_millis(20));
            fs::write(&path, content).unwrap();
            let error = blobs.local(&file.sha256).unwrap_err();
            assert!(error.downcast_ref::<Damaged>().is_some(), "{error:#}");
            blobs.restore(&file.sha256, b"abc").unwrap();
            assert_eq!(
                fs::read(blobs.local(&file.sha256).unwrap()).unwrap(),
                b"abc"
            );
        }
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
        let refused = Blobs::open(
            directory.path(),
            Some(&"s3://tracks/lab".parse().unwrap()),
            false,
        )
        .await
        .unwrap_err();
        assert_eq!(
            refused.to_string(),
            "artefacts cannot be kept at s3://tracks/lab: this trackloom was built without the feature s3 \
             (cargo build --release --features s3)"
        );
    }
}
