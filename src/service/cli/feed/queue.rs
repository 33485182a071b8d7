//! What came and was not read yet, in bounded memory: threads that wait for input put it in, the reader takes it out.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// Bytes that may wait to be read.
const MOST_BYTES: usize = 16 << 20;
/// What a part costs besides its bytes.
const OVERHEAD: usize = 64;

/// A part of a stream.
pub(super) enum Chunk {
    /// It goes on from the one before.
    Bytes(Vec<u8>),
    /// It stands alone.
    Datagram(Vec<u8>),
    /// What comes next does not go on from the one before.
    Break,
}

/// A chunk, and when it came (Unix seconds).
pub(super) struct Arrived {
    pub chunk: Chunk,
    pub at_s: f64,
}

#[derive(Clone, Default)]
pub(super) struct Queue(Arc<(Mutex<State>, Condvar)>);

#[derive(Default)]
struct State {
    waiting: VecDeque<Arrived>,
    bytes: usize,
    is_closed: bool,
    failure: Option<anyhow::Error>,
}

impl Chunk {
    fn cost(&self) -> usize {
        OVERHEAD
            + match self {
                Chunk::Bytes(bytes) | Chunk::Datagram(bytes) => bytes.len(),
                Chunk::Break => 0,
            }
    }
}

impl Queue {
    fn state(&self) -> MutexGuard<'_, State> {
        self.0.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'s>(&self, state: MutexGuard<'s, State>) -> MutexGuard<'s, State> {
        self.0.1.wait(state).unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts it in when there is room; `false` where nobody reads any more.
    pub fn put(&self, chunk: Chunk) -> bool {
        let mut state = self.state();
        while state.bytes > MOST_BYTES && !state.is_closed {
            state = self.wait(state);
        }
        self.add(state, chunk)
    }

    /// Puts it in where there is room; `None` where nobody reads any more, `false` where there is none.
    pub fn put_now(&self, chunk: Chunk) -> Option<bool> {
        let state = self.state();
        if state.is_closed {
            return None;
        }
        Some(state.bytes <= MOST_BYTES && self.add(state, chunk))
    }

    fn add(&self, mut state: MutexGuard<State>, chunk: Chunk) -> bool {
        if state.is_closed {
            return false;
        }
        state.bytes += chunk.cost();
        let at_s = now_s();
        state.waiting.push_back(Arrived { chunk, at_s });
        self.0.1.notify_all();
        true
    }

    /// The next chunk, when it has come; `None` at the end.
    pub fn take(&self) -> Option<Arrived> {
        let mut state = self.state();
        loop {
            if let Some(next) = state.waiting.pop_front() {
                state.bytes -= next.chunk.cost();
                self.0.1.notify_all();
                return Some(next);
            }
            if state.is_closed {
                return None;
            }
            state = self.wait(state);
        }
    }

    pub fn is_closed(&self) -> bool {
        self.state().is_closed
    }

    /// Nothing more comes; what is there is still read.
    pub fn close(&self) {
        self.state().is_closed = true;
        self.0.1.notify_all();
    }

    /// Nothing more is wanted: what came is still read, as far as it is whole.
    pub fn stop(&self) {
        let at_s = now_s();
        let chunk = Chunk::Break;
        let mut state = self.state();
        state.bytes += chunk.cost();
        state.waiting.push_back(Arrived { chunk, at_s });
        state.is_closed = true;
        drop(state);
        self.0.1.notify_all();
    }

    /// Nothing more comes, and why.
    pub fn fail(&self, error: anyhow::Error) {
        self.state().failure = Some(error);
        self.close();
    }

    pub fn failure(&self) -> Option<anyhow::Error> {
        self.state().failure.take()
    }
}

/// The time (Unix seconds).
pub(super) fn now_s() -> f64 {
    jiff::Timestamp::now().as_nanosecond() as f64 / 1e9
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_no_room_is_told_and_what_was_put_in_is_read_after_the_end() {
        let queue = Queue::default();
        let mut kept = 0;
        while queue.put_now(Chunk::Datagram(vec![0; 1 << 16])) == Some(true) {
            kept += 1;
        }
        assert_eq!(kept, 256, "16 MiB");
        queue.close();
        assert_eq!(queue.put_now(Chunk::Break), None);
        assert!(!queue.put(Chunk::Break));
        let mut read = 0;
        while queue.take().is_some() {
            read += 1;
        }
        assert_eq!((read, queue.state().bytes), (kept, 0));
    }
}
