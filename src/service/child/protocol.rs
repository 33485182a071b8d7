//! What a service and its child say to each other: JSON, each text with its length in four bytes before it.

use super::input::InputFile;
use crate::experiment::JobKind;
use crate::formats::FormatOptions;
use crate::model::dataset::{DatasetKind, DatasetSummary};
use crate::model::fault::Fault;
use crate::model::sensor::SensorSettings;
use crate::service::types::Progress;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use serde_json::value::RawValue;
use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::ops::Range;
use std::path::PathBuf;
use uuid::Uuid;

/// What the service says.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Message {
    Work(Order),
    /// The work at hand is not wanted any more.
    Stop,
}

/// What the child says.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Answer {
    /// It waits for work. The program is another one where the version is not the service's own.
    Ready {
        version: String,
    },
    Progress(Progress),
    /// `is_grown`: it kept memory that the next work may miss.
    Done {
        made: Made,
        is_grown: bool,
    },
}

/// Something to do.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum Order {
    Check(Upload),
    /// The first rows of a dataset.
    Preview {
        input: InputFile,
        rows: usize,
    },
    /// Writes a dataset into the file `path`, in a format of `formats::WRITERS`.
    Write {
        input: InputFile,
        format: String,
        path: PathBuf,
    },
    /// A job that is no campaign. Its files go into `directory`.
    Job {
        id: Uuid,
        kind: JobKind,
        spec: Value,
        inputs: Vec<Option<InputFile>>,
        directory: PathBuf,
    },
    Runs {
        campaign: CampaignOrder,
        runs: Runs,
    },
    /// Looks at the pieces of a campaign, each a line of the file `pieces`: more runs to make, or the result.
    Look {
        campaign: CampaignOrder,
        pieces: PathBuf,
        outcomes: Option<String>,
        directory: PathBuf,
    },
    /// What the pieces say while others are being made.
    SoFar {
        campaign: CampaignOrder,
        pieces: PathBuf,
        outcomes: String,
    },
}

impl Order {
    /// The campaign that it is about.
    pub fn campaign(&self) -> Option<Uuid> {
        match self {
            Order::Runs { campaign, .. }
            | Order::Look { campaign, .. }
            | Order::SoFar { campaign, .. } => Some(campaign.id),
            Order::Check(_) | Order::Preview { .. } | Order::Write { .. } | Order::Job { .. } => {
                None
            }
        }
    }
}

/// A file to be checked.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Upload {
    pub path: PathBuf,
    pub file_name: Option<String>,
    /// Told from the file when absent.
    pub format: Option<String>,
    pub kind: Option<DatasetKind>,
    pub columns: BTreeMap<String, String>,
    pub options: FormatOptions,
    /// Whether all that there is to say of it is asked for.
    pub inspect: bool,
}

/// A campaign, by its job.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct CampaignOrder {
    pub id: Uuid,
    pub spec: Value,
    pub inputs: Vec<Option<InputFile>>,
}

/// Runs to make.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Runs {
    /// The first ones, as many as a short time allows.
    pub is_pilot: bool,
    pub items: Vec<Range<u64>>,
    /// What is kept of each run, as JSON, once that is known.
    pub outcomes: Option<String>,
    pub done: u64,
    pub total: u64,
}

/// What came of an order.
#[derive(Debug, Serialize, Deserialize)]
pub enum Made {
    Checked(Box<Checked>),
    Preview(Box<RawValue>),
    /// The file that was named is there.
    Written,
    Files {
        files: Vec<MadeFile>,
        warnings: Vec<String>,
    },
    /// Of a campaign; `piece` and `outcomes` are JSON.
    Piece {
        piece: String,
        runs: u64,
        outcomes: String,
    },
    Looked(Looked),
    SoFar {
        runs: u64,
        result: Box<RawValue>,
    },
    Stopped,
    Faults(Vec<Fault>),
    /// It needs more memory than it may have.
    Memory,
    /// An error that is ours; `is_full`: of a full disk.
    Internal {
        text: String,
        is_full: bool,
    },
}

/// What was found in an upload.
#[derive(Debug, Serialize, Deserialize)]
pub struct Checked {
    /// The name of its format.
    pub format: String,
    pub summary: DatasetSummary,
    pub warnings: Vec<String>,
    /// An [`crate::experiment::inspect::Inspection`], where it was asked for.
    pub inspection: Option<Value>,
}

/// What a look at a campaign gave.
#[derive(Debug, Serialize, Deserialize)]
pub enum Looked {
    More {
        chunks: Vec<Vec<Range<u64>>>,
        runs_total: u64,
    },
    Report {
        files: Vec<MadeFile>,
        warnings: Vec<String>,
    },
}

/// A file that was made, ready to be adopted.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct MadeFile {
    pub name: String,
    pub media_type: String,
    pub path: PathBuf,
    pub bytes: u64,
    pub sha256: String,
    /// Set when other jobs can use it.
    pub dataset: Option<DatasetSummary>,
    pub sensors: Vec<SensorSettings>,
}

/// The bytes of one text with its length.
pub(super) fn frame(value: &impl Serialize) -> io::Result<Vec<u8>> {
    let mut bytes = vec![0; 4];
    serde_json::to_writer(&mut bytes, value)?;
    let length =
        u32::try_from(bytes.len() - 4).map_err(|_| io::Error::other("a message is too long"))?;
    bytes[..4].copy_from_slice(&length.to_le_bytes());
    Ok(bytes)
}

pub(super) fn write(output: &mut impl Write, value: &impl Serialize) -> io::Result<()> {
    output.write_all(&frame(value)?)?;
    output.flush()
}

/// The next text; `None` at the end of the input.
pub(super) fn read<T: DeserializeOwned>(input: &mut impl Read) -> io::Result<Option<T>> {
    let mut length = [0; 4];
    match input.read_exact(&mut length) {
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => return Ok(None),
        read => read?,
    }
    let length = u32::from_le_bytes(length);
    // Grows with what is there, whatever the length says.
    let mut bytes = Vec::new();
    if input.take(u64::from(length)).read_to_end(&mut bytes)? < length as usize {
        return Ok(None);
    }
    Ok(Some(serde_json::from_slice(&bytes)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn texts_arrive_one_by_one_and_a_broken_one_is_the_end() {
        let mut bytes = frame(&json!({"a": [1, 0.1]})).unwrap();
        bytes.extend(frame(&json!("b")).unwrap());
        bytes.extend([200, 0, 0, 0, b'1']);
        let mut input = bytes.as_slice();
        assert_eq!(
            read::<Value>(&mut input).unwrap(),
            Some(json!({"a": [1, 0.1]}))
        );
        assert_eq!(read::<Value>(&mut input).unwrap(), Some(json!("b")));
        assert_eq!(read::<Value>(&mut input).unwrap(), None);
    }

    #[test]
    fn numbers_and_raw_texts_come_through_as_they_are() {
        let result =
            RawValue::from_string("{\"x\":0.30000000000000004,\"y\":1e-320}".to_owned()).unwrap();
        let done = Answer::Done {
            made: Made::SoFar { runs: 3, result },
            is_grown: true,
        };
        let bytes = frame(&done).unwrap();
        let Some(Answer::Done {
            made: Made::SoFar { runs, result },
            is_grown,
        }) = read(&mut bytes.as_slice()).unwrap()
        else {
            panic!("another answer")
        };
        assert_eq!(
            (runs, result.get(), is_grown),
            (3, "{\"x\":0.30000000000000004,\"y\":1e-320}", true)
        );
    }
}
