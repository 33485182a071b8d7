//! How much may come in a time.

use std::time::{Duration, Instant};

/// An allowance that grows with time.
pub(super) struct Rate {
    per_s: f64,
    /// What may be saved, and so come at once.
    most: f64,
    /// What may come now; less than 0 after more came at once than may be saved.
    left: f64,
    counted: Instant,
}

impl Rate {
    /// So many a second; what was not used of the time `saved` may be used at once.
    pub fn new(per_s: f64, saved: Duration, now: Instant) -> Self {
        let most = (per_s * saved.as_secs_f64()).max(1.0);
        Rate {
            per_s,
            most,
            left: most,
            counted: now,
        }
    }

    /// Whether so many may come now; then they count.
    pub fn take(&mut self, count: usize, now: Instant) -> bool {
        let (count, most) = (count as f64, self.most);
        let since_s = now.saturating_duration_since(self.counted).as_secs_f64();
        (self.left, self.counted) = ((self.left + self.per_s * since_s).min(most), now);
        // What is larger than all that may be saved is paid off afterwards.
        let is_allowed = self.left >= count.min(most);
        if is_allowed {
            self.left -= count;
        }
        is_allowed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAVED: Duration = Duration::from_secs(10);

    #[test]
    fn what_comes_is_taken_at_its_rate_and_what_was_saved_at_once() {
        let begin = Instant::now();
        let after = |s: f64| begin + Duration::from_secs_f64(s);
        let mut rate = Rate::new(2.0, SAVED, begin);
        assert!(rate.take(20, begin) && !rate.take(1, begin));
        assert!(!rate.take(1, after(0.4)));
        assert!(rate.take(1, after(0.5)) && !rate.take(1, after(0.6)));
        // Not more than 10 s are saved, and 30 then cost 5 s more.
        assert!(rate.take(30, after(100.0)));
        assert!(!rate.take(1, after(105.4)) && rate.take(1, after(105.5)));
    }

    #[test]
    fn a_slow_rate_still_takes_one() {
        let begin = Instant::now();
        let mut rate = Rate::new(0.01, SAVED, begin);
        assert!(rate.take(1, begin) && !rate.take(1, begin + Duration::from_secs(99)));
        assert!(rate.take(1, begin + Duration::from_secs(100)));
    }
}
