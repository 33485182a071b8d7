//! Whether the data directory can take more: it is there, may be written, and has room.

use anyhow::Context;
use rustix::fs::{Access, StatVfs, access, statvfs};
use std::fs::{self, File};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::atomic::{AtomicU64, Ordering};

/// What has to stay free for what is at work already.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum MinFree {
    /// The smaller of 5 % of the file system and 1 GiB.
    #[default]
    Usual,
    Bytes(u64),
    Percent(f64),
}

const USUAL_PERCENT: f64 = 5.0;
const USUAL_BYTES: u64 = 1 << 30;

impl MinFree {
    fn bytes(self, total_bytes: u64) -> u64 {
        let share = |percent: f64| (total_bytes as f64 * percent / 100.0) as u64;
        match self {
            MinFree::Usual => share(USUAL_PERCENT).min(USUAL_BYTES),
            MinFree::Bytes(bytes) => bytes,
            MinFree::Percent(percent) => share(percent),
        }
    }
}

impl FromStr for MinFree {
    type Err = String;

    fn from_str(text: &str) -> Result<MinFree, String> {
        let read = match text.strip_suffix('%') {
            Some(percent) => percent
                .trim()
                .parse()
                .ok()
                .filter(|percent| (0.0..=100.0).contains(percent))
                .map(MinFree::Percent),
            None => text.parse().ok().map(MinFree::Bytes),
        };
        read.ok_or_else(|| {
            "it is neither a number of bytes nor a percentage, such as 500000000 or 5%".to_owned()
        })
    }
}

/// Why nothing more can be kept.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NoRoom {
    #[error(
        "the disk has {free_bytes} bytes free, of which {min_free_bytes} are kept for what is at work"
    )]
    Little {
        free_bytes: u64,
        min_free_bytes: u64,
    },
    #[error("{kept_bytes} bytes are kept, of {max_bytes} that may be, and no job may go")]
    Quota { kept_bytes: u64, max_bytes: u64 },
    #[error("the disk is full, or the data directory cannot be written")]
    Full,
    #[error("the data directory cannot be written: {0}")]
    NotWritable(String),
    #[error("the data directory is gone")]
    Gone,
}

/// The place of everything that is kept.
#[derive(Debug)]
pub struct Room {
    directory: PathBuf,
    /// A file in the directory as it was when the service began; absent where nothing of the tables is in it.
    witness: Option<(PathBuf, u64)>,
    min_free: MinFree,
    max_bytes: Option<u64>,
    /// What was kept when somebody last looked, and what has come since.
    kept_bytes: AtomicU64,
}

impl Room {
    /// `witness` is an open file of the directory, by which it is known again, and its name.
    ///
    /// # Errors
    /// When nothing can be known of the file.
    pub fn open(
        directory: &Path,
        witness: Option<(&File, &str)>,
        min_free: MinFree,
        max_bytes: Option<u64>,
    ) -> anyhow::Result<Room> {
        let witness = match witness {
            Some((file, name)) => Some((
                directory.join(name),
                file.metadata()
                    .context("cannot look at a file of the data directory")?
                    .ino(),
            )),
            None => None,
        };
        Ok(Room {
            directory: directory.to_owned(),
            witness,
            min_free,
            max_bytes,
            kept_bytes: AtomicU64::new(0),
        })
    }

    /// Whether so many bytes more would be more than may be kept.
    pub fn lacks(&self, bytes: u64) -> bool {
        let kept_bytes = self.kept_bytes.load(Ordering::Relaxed);
        self.max_bytes
            .is_some_and(|max_bytes| kept_bytes.saturating_add(bytes) > max_bytes)
    }

    pub fn note_kept(&self, bytes: u64) {
        self.kept_bytes.store(bytes, Ordering::Relaxed);
    }

    pub fn note_more(&self, bytes: u64) {
        self.kept_bytes.fetch_add(bytes, Ordering::Relaxed);
    }

    /// Whether so many bytes more can be kept.
    ///
    /// # Errors
    /// The reason why not.
    pub fn check(&self, bytes: u64) -> Result<(), NoRoom> {
        if let Some(max_bytes) = self.max_bytes.filter(|_| self.lacks(bytes)) {
            let kept_bytes = self.kept_bytes.load(Ordering::Relaxed);
            return Err(NoRoom::Quota {
                kept_bytes,
                max_bytes,
            });
        }
        let is_same = |(path, inode): &(PathBuf, u64)| {
            fs::metadata(path).is_ok_and(|data| data.ino() == *inode)
        };
        if !self.directory.exists()
            || self
                .witness
                .as_ref()
                .is_some_and(|witness| !is_same(witness))
        {
            return Err(NoRoom::Gone);
        }
        let no =
            |error: rustix::io::Errno| NoRoom::NotWritable(std::io::Error::from(error).to_string());
        access(&self.directory, Access::WRITE_OK).map_err(no)?;
        let (total_bytes, free_bytes) = total_and_free(&self.directory).map_err(no)?;
        let min_free_bytes = self.min_free.bytes(total_bytes);
        // Even where nothing is to be kept free, a disk without a byte is full.
        if free_bytes < min_free_bytes.saturating_add(bytes.max(1)) {
            return Err(NoRoom::Little {
                free_bytes,
                min_free_bytes,
            });
        }
        Ok(())
    }

    /// What is free; `None` where the directory is gone.
    pub fn free_bytes(&self) -> Option<u64> {
        let (_, free_bytes) = total_and_free(&self.directory).ok()?;
        Some(free_bytes)
    }
}

/// The bytes of the file system of a directory, and those that are free.
fn total_and_free(directory: &Path) -> rustix::io::Result<(u64, u64)> {
    let StatVfs {
        f_blocks,
        f_bavail,
        f_frsize,
        ..
    } = statvfs(directory)?;
    Ok((
        f_blocks.saturating_mul(f_frsize),
        f_bavail.saturating_mul(f_frsize),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_free_is_said_in_bytes_or_percent() {
        assert_eq!("5%".parse(), Ok(MinFree::Percent(5.0)));
        assert_eq!("1000000".parse(), Ok(MinFree::Bytes(1_000_000)));
        for wrong in ["", "%", "101%", "-1%", "NaN%", "-1", "1.5", "5 GB"] {
            assert!(
                wrong
                    .parse::<MinFree>()
                    .unwrap_err()
                    .contains("such as 500000000 or 5%"),
                "{wrong}"
            );
        }
        let (small, large) = (24 << 20, 1 << 40);
        assert_eq!(
            (MinFree::Usual.bytes(small), MinFree::Usual.bytes(large)),
            (1_258_291, 1 << 30)
        );
        assert_eq!(
            (
                MinFree::Percent(50.0).bytes(small),
                MinFree::Bytes(7).bytes(small)
            ),
            (12 << 20, 7)
        );
    }

    #[test]
    fn what_may_be_kept_is_a_limit() {
        let directory = tempfile::tempdir().unwrap();
        let room = Room::open(directory.path(), None, MinFree::Bytes(0), Some(1000)).unwrap();
        room.note_kept(900);
        assert_eq!((room.check(100), room.lacks(100)), (Ok(()), false));
        room.note_more(50);
        let quota = NoRoom::Quota {
            kept_bytes: 950,
            max_bytes: 1000,
        };
        assert_eq!((room.check(100), room.lacks(100)), (Err(quota), true));
        assert!(!room.lacks(50));
    }

    #[test]
    fn a_directory_that_is_gone_or_another_or_short_of_room_takes_nothing() {
        let parent = tempfile::tempdir().unwrap();
        let directory = parent.path().join("data");
        fs::create_dir(&directory).unwrap();
        let lock = File::create(directory.join("lock")).unwrap();
        let room =
            |min_free| Room::open(&directory, Some((&lock, "lock")), min_free, None).unwrap();
        assert_eq!(room(MinFree::Bytes(0)).check(1), Ok(()));
        assert!(matches!(
            room(MinFree::Percent(100.0)).check(0),
            Err(NoRoom::Little { .. })
        ));
        assert!(matches!(
            room(MinFree::Bytes(1)).check(u64::MAX),
            Err(NoRoom::Little { .. })
        ));
        let open = room(MinFree::Bytes(0));
        fs::remove_dir_all(&directory).unwrap();
        assert_eq!(open.check(0), Err(NoRoom::Gone));
        fs::create_dir(&directory).unwrap();
        fs::write(
            directory.join("other"),
            "takes the place of the file on the disk",
        )
        .unwrap();
        File::create(directory.join("lock")).unwrap();
        assert_eq!(
            open.check(0),
            Err(NoRoom::Gone),
            "another directory of the same name"
        );
    }
}
