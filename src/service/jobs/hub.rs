//! Wakes whoever waits for news of a job, so that nobody has to ask the tables again and again.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};
use tokio::sync::watch;
use uuid::Uuid;

/// Channels kept although nobody may listen any more; beyond it they are looked through.
const SPARE: usize = 1024;

#[derive(Default)]
pub(super) struct Hub {
    channels: Mutex<HashMap<Uuid, watch::Sender<()>>>,
}

impl Hub {
    /// Hears of everything that is committed from now on. Subscribe first, then read.
    pub(super) fn subscribe(&self, id: Uuid) -> watch::Receiver<()> {
        let mut channels = self.channels.lock().unwrap_or_else(PoisonError::into_inner);
        if channels.len() > SPARE {
            channels.retain(|_, sender| sender.receiver_count() > 0);
        }
        channels.entry(id).or_default().subscribe()
    }

    /// Anything may have happened.
    pub(super) fn wake_all(&self) {
        let mut channels = self.channels.lock().unwrap_or_else(PoisonError::into_inner);
        channels.retain(|_, sender| sender.send(()).is_ok());
    }

    pub(super) fn wake(&self, ids: &[Uuid]) {
        let mut channels = self.channels.lock().unwrap_or_else(PoisonError::into_inner);
        for id in ids {
            if let Some(sender) = channels.get(id)
                && sender.send(()).is_err()
            {
                channels.remove(id);
            }
        }
    }
}
