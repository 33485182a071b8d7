//! Whether the other side moves enough bytes while it is waited for.

use crate::service::config::ConnectionLimits;
use std::pin::Pin;
use std::task::Context;
use std::time::Duration;
use tokio::time::{Instant, Sleep, sleep};

/// A time that ended this long ago ended while nobody waited.
const LATE: Duration = Duration::from_secs(1);

/// Asks for a least number of bytes in each stretch of waiting.
pub(super) struct Pace {
    transfer_time: Duration,
    least_bytes: usize,
    /// The end of the stretch; absent while nobody waits.
    end: Option<Pin<Box<Sleep>>>,
    moved: usize,
}

impl Pace {
    pub fn new(limits: &ConnectionLimits) -> Self {
        Pace {
            transfer_time: limits.transfer_time,
            least_bytes: limits.least_bytes,
            end: None,
            moved: 0,
        }
    }

    /// Bytes have come, or been taken.
    pub fn note(&mut self, bytes: usize) {
        self.moved += bytes;
        if self.moved >= self.least_bytes {
            self.reset();
        }
    }

    /// Nothing moves just now: whether that has been so for too long. The task is woken when it will have been.
    pub fn is_too_slow(&mut self, context: &mut Context<'_>) -> bool {
        if self
            .end
            .as_ref()
            .is_some_and(|end| end.deadline() + LATE < Instant::now())
        {
            self.reset();
        }
        let end = self
            .end
            .get_or_insert_with(|| Box::pin(sleep(self.transfer_time)));
        end.as_mut().poll(context).is_ready()
    }

    fn reset(&mut self) {
        self.end = None;
        self.moved = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::task::Waker;

    fn limits() -> ConnectionLimits {
        ConnectionLimits {
            transfer_time: Duration::from_millis(300),
            least_bytes: 100,
            ..ConnectionLimits::of(1)
        }
    }

    #[tokio::test]
    async fn few_bytes_in_a_stretch_are_too_few() {
        let mut context = Context::from_waker(Waker::noop());
        let mut pace = Pace::new(&limits());
        assert!(!pace.is_too_slow(&mut context));
        pace.note(99);
        tokio::time::sleep(Duration::from_millis(320)).await;
        assert!(pace.is_too_slow(&mut context));
        let mut pace = Pace::new(&limits());
        assert!(!pace.is_too_slow(&mut context));
        pace.note(100);
        tokio::time::sleep(Duration::from_millis(320)).await;
        assert!(!pace.is_too_slow(&mut context), "enough moved");
    }

    #[tokio::test]
    async fn a_stretch_that_ended_while_nobody_waited_does_not_count() {
        let mut context = Context::from_waker(Waker::noop());
        let mut pace = Pace::new(&limits());
        assert!(!pace.is_too_slow(&mut context));
        tokio::time::sleep(Duration::from_millis(1400)).await;
        assert!(!pace.is_too_slow(&mut context));
    }
}
