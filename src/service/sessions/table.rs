//! The log of a session as a table of detections: looked at for its columns, then written, and never held.

use crate::experiment::session::{Entry, Scene, SessionRecording};
use crate::formats::DetectionsCsv;
use crate::model::fault::Fault;
use crate::model::scan::Recording;
use crate::service::datasets::ReceivedFile;
use crate::service::error::ServiceError;
use crate::service::storage::blobs::hex;
use anyhow::Context;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;

/// Scans of a recording: scans have numbers of 32 bits.
const MOST_RECORDED: u32 = 1_000_000_000;

/// Reads entries for the columns that they need.
pub(super) struct Looking {
    recording: SessionRecording,
    table: DetectionsCsv,
}

impl Looking {
    pub fn new(scene: Arc<Scene>) -> Self {
        Looking {
            recording: SessionRecording::new(scene),
            table: DetectionsCsv::default(),
        }
    }

    pub fn take(&mut self, entry: Entry) -> Result<(), ServiceError> {
        if let Some(piece) = self.recording.add(entry).map_err(ServiceError::Invalid)? {
            self.table.look(&piece);
        }
        if self.recording.scans() > MOST_RECORDED {
            let detail = format!("the session has more than {MOST_RECORDED} scans");
            let fault = Fault::new("", "too_large", detail);
            return Err(ServiceError::Invalid(vec![fault]));
        }
        Ok(())
    }

    /// # Errors
    /// A session without scans.
    pub fn end(mut self) -> Result<DetectionsCsv, ServiceError> {
        let piece = self.recording.end().map_err(ServiceError::Invalid)?;
        self.table.look(&piece);
        if self.recording.scans() == 0 {
            let detail = "the session has no scans";
            return Err(ServiceError::Invalid(vec![Fault::new("", "empty", detail)]));
        }
        Ok(self.table)
    }
}

/// Writes as many entries as were looked at.
pub(super) struct Writing {
    recording: SessionRecording,
    table: DetectionsCsv,
    entries: u64,
    path: PathBuf,
    file: File,
    sha256: Sha256,
    bytes: u64,
}

impl Writing {
    pub fn begin(
        scene: Arc<Scene>,
        table: DetectionsCsv,
        entries: u64,
        path: PathBuf,
    ) -> anyhow::Result<Self> {
        let file = File::create(&path).context("the recording cannot be written")?;
        let mut writing = Writing {
            recording: SessionRecording::new(scene),
            table,
            entries,
            path,
            file,
            sha256: Sha256::new(),
            bytes: 0,
        };
        let mut head = Vec::new();
        table.begin(&mut head)?;
        writing.put(&head)?;
        Ok(writing)
    }

    pub fn take(&mut self, entry: Entry) -> Result<(), ServiceError> {
        // What came since is of the next recording.
        if self.entries == 0 {
            return Ok(());
        }
        self.entries -= 1;
        if let Some(piece) = self.recording.add(entry).map_err(ServiceError::Invalid)? {
            self.write(&piece)?;
        }
        Ok(())
    }

    pub fn end(mut self) -> Result<ReceivedFile, ServiceError> {
        let piece = self.recording.end().map_err(ServiceError::Invalid)?;
        self.write(&piece)?;
        Ok(ReceivedFile {
            path: self.path,
            sha256: hex(&self.sha256.finalize()),
            bytes: self.bytes,
        })
    }

    fn write(&mut self, piece: &Recording) -> anyhow::Result<()> {
        let mut rows = Vec::new();
        self.table.write(piece, &mut rows)?;
        self.put(&rows)
    }

    fn put(&mut self, bytes: &[u8]) -> anyhow::Result<()> {
        self.sha256.update(bytes);
        self.bytes += bytes.len() as u64;
        self.file
            .write_all(bytes)
            .context("the recording cannot be written")
    }
}
