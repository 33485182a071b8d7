//! A feed that is asked to end: by Ctrl-C or SIGTERM.

use tokio::signal::unix::{Signal, SignalKind, signal};

pub(super) struct Stop {
    interrupt: Signal,
    terminate: Signal,
    is_asked: bool,
}

/// As a shell tells of a program that was ended by Ctrl-C.
const INTERRUPTED: i32 = 130;

impl Stop {
    /// The second Ctrl-C ends the process at once.
    pub fn on_signals() -> anyhow::Result<Self> {
        let mut again = signal(SignalKind::interrupt())?;
        tokio::spawn(async move {
            again.recv().await;
            again.recv().await;
            std::process::exit(INTERRUPTED);
        });
        Ok(Stop {
            interrupt: signal(SignalKind::interrupt())?,
            terminate: signal(SignalKind::terminate())?,
            is_asked: false,
        })
    }

    /// Waits until somebody asks; at once where somebody has.
    pub async fn asked(&mut self) {
        if self.is_asked {
            return;
        }
        tokio::select! {
            _ = self.interrupt.recv() => {}
            _ = self.terminate.recv() => {}
        }
        self.is_asked = true;
    }
}
