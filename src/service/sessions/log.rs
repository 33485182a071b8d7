//! Appending to the logs of all sessions: what comes while a change is written is written together with the next one.

use crate::service::storage::{LogAppend, Storage};
use std::sync::Arc;
use tokio::sync::{mpsc, oneshot};

/// Pushes that may wait for the disk.
const WAITING: usize = 256;

struct Asked {
    append: LogAppend,
    answer: oneshot::Sender<Result<bool, Arc<anyhow::Error>>>,
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
        answered.map_err(|error| {
            Arc::try_unwrap(error).unwrap_or_else(|shared| anyhow::anyhow!("{shared:#}"))
        })
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
                let error = Arc::new(error);
                for asked in together.drain(..) {
                    let _ = asked.answer.send(Err(error.clone()));
                }
            }
        }
    }
}
