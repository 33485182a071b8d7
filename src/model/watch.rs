//! How work that takes long is asked to stop: a question handed down by whoever runs the job, asked between small pieces.
//!
//! Work counts what it does in pieces of roughly a nanosecond to ten; the question is put each [`PIECES`] of them, so that
//! asking costs nothing beside the work, and a stop is noticed within milliseconds. Work that was stopped may return
//! anything: whoever handed the question down looks at [`Watch::is_stopped`] before using it.

use super::fault::Fault;
use std::cell::Cell;
use std::ops::ControlFlow;

/// Pieces of work between two questions.
const PIECES: u64 = 1 << 20;

/// `Break` asks to stop.
pub type Question<'a> = &'a dyn Fn() -> ControlFlow<()>;

/// Asks whether to go on, and remembers the answer.
pub struct Watch<'a> {
    question: Option<Question<'a>>,
    left: Cell<u64>,
    is_stopped: Cell<bool>,
}

impl<'a> Watch<'a> {
    pub fn new(question: Question<'a>) -> Self {
        Watch {
            question: Some(question),
            left: Cell::new(PIECES),
            is_stopped: Cell::new(false),
        }
    }

    /// Never asks, and never stops.
    pub const fn never() -> Self {
        Watch {
            question: None,
            left: Cell::new(PIECES),
            is_stopped: Cell::new(false),
        }
    }

    /// Whether a question was answered with a stop.
    pub fn is_stopped(&self) -> bool {
        self.is_stopped.get()
    }

    /// Counts so many pieces of work, asks when it is time, and says whether to stop.
    #[inline]
    pub fn stops_after(&self, pieces: u64) -> bool {
        match self.left.get().checked_sub(pieces) {
            Some(left) => self.left.set(left),
            None => self.ask(),
        }
        self.is_stopped.get()
    }

    #[cold]
    fn ask(&self) {
        self.left.set(PIECES);
        if let Some(question) = self.question
            && !self.is_stopped.get()
        {
            self.is_stopped.set(question().is_break());
        }
    }
}

/// Why work ended before its end.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Halt {
    /// It was asked to stop.
    #[error("stopped")]
    Stopped,
    /// Its tables would hold more than is allowed.
    #[error(transparent)]
    TooLarge(Box<Fault>),
    /// It was given something of a time that it has passed.
    #[error("a scan at {time_s} s follows one at {last_s} s")]
    Late { time_s: f64, last_s: f64 },
}

impl std::fmt::Debug for Watch<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Watch")
            .field("left", &self.left)
            .field("is_stopped", &self.is_stopped)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_asks_each_so_many_pieces_and_no_more_after_a_stop() {
        let asked = Cell::new(0);
        let question = || {
            asked.set(asked.get() + 1);
            if asked.get() < 3 {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        };
        let watch = Watch::new(&question);
        let stops: Vec<bool> = (0..9).map(|_| watch.stops_after(PIECES / 2)).collect();
        assert_eq!(
            stops,
            [false, false, false, false, false, false, false, false, true]
        );
        assert!(watch.is_stopped() && watch.stops_after(u64::MAX));
        assert_eq!(asked.get(), 3);
        assert!(!Watch::never().stops_after(u64::MAX));
    }
}
