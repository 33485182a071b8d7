//! Appending to the logs of all sessions: what comes while a change is written is written together with the next one.

use crate::service::storage::{LogAppend, Storage};
use std::sync::Arc;
use tokio::sync::{mpsc, oneshot};

/// Pushes that may wait for the disk.
const WAITING: usize = 256;

struct Asked {
    append: LogAppend,
    answer: oneshot::Sender<Result<bool, Shared>>,
}

/// Why one change failed, for all whose entries were in it: what kind of error it is can be told of its source.
#[derive(Debug, Clone)]
struct Shared(Arc<anyhow::Error>);

impl std::fmt::Display for Shared {
    fn fmt(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        formatter.write_str("entries were not kept")
    }
}

impl std::error::Error for Shared {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(self.0.as_ref().as_ref())
    }
}

/// Whoever appends.
#[derive(Clone)]
pub(super) struct Log(mpsc::Sender<Asked>);

impl Log {
    pub fn start(storage: Storage) -> Self {
        let (sender, receiver) = mpsc::channel(WAITING);
        tokio::spawn(write_all(storage, receiver));
        Log(sender)
    }

    /// Keeps entries; `false` where this process does not have the session any more.
    pub async fn append(&self, append: LogAppend) -> anyhow::Result<bool> {
        let (answer, answered) = oneshot::channel();
        let asked = Asked { append, answer };
        let is_gone = || anyhow::anyhow!("the log of sessions has stopped");
        self.0.send(asked).await.map_err(|_| is_gone())?;
        let answered = answered.await.map_err(|_| is_gone())?;
        Ok(answered?)
    }
}

async fn write_all(storage: Storage, mut receiver: mpsc::Receiver<Asked>) {
    let mut together = Vec::new();
    while receiver.recv_many(&mut together, WAITING).await > 0 {
        let appends: Vec<LogAppend> = together.iter().map(|asked| asked.append.clone()).collect();
        match storage.append_to_logs(&appends).await {
            Ok(taken) => {
                for (asked, taken) in together.drain(..).zip(taken) {
                    // Whoever asked may have gone.
                    let _ = asked.answer.send(Ok(taken));
                }
            }
            Err(error) => {
                let error = Shared(Arc::new(error));
                for asked in together.drain(..) {
                    let _ = asked.answer.send(Err(error.clone()));
                }
            }
        }
    }
}
