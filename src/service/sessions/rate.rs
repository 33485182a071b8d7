//! How many scans a session takes a second.

use std::time::{Duration, Instant};

/// What was not used of so long may be used at once.
const SAVED: Duration = Duration::from_secs(10);

/// An allowance that grows with time.
pub(super) struct Rate {
    per_s: f64,
    /// Scans that may come; less than 0 after more came at once than may be saved.
    left: f64,
    counted: Instant,
}

impl Rate {
    pub fn new(per_s: f64, now: Instant) -> Self {
        Rate {
            per_s,
            left: Rate::most(per_s),
            counted: now,
        }
    }

    fn most(per_s: f64) -> f64 {
        (per_s * SAVED.as_secs_f64()).max(1.0)
    }

    /// Whether so many scans may come now; then they count.
    pub fn take(&mut self, scans: usize, now: Instant) -> bool {
        let (scans, most) = (scans as f64, Rate::most(self.per_s));
        let since_s = now.saturating_duration_since(self.counted).as_secs_f64();
        (self.left, self.counted) = ((self.left + self.per_s * since_s).min(most), now);
        // A batch that is larger than all that may be saved is paid off afterwards.
        let is_allowed = self.left >= scans.min(most);
        if is_allowed {
            self.left -= scans;
        }
        is_allowed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scans_are_taken_at_their_rate_and_what_was_saved_at_once() {
        let begin = Instant::now();
        let after = |s: f64| begin + Duration::from_secs_f64(s);
        let mut rate = Rate::new(2.0, begin);
        assert!(rate.take(20, begin) && !rate.take(1, begin));
        assert!(!rate.take(1, after(0.4)));
        assert!(rate.take(1, after(0.5)) && !rate.take(1, after(0.6)));
        // Not more than 10 s are saved, and 30 scans then cost 5 s more.
        assert!(rate.take(30, after(100.0)));
        assert!(!rate.take(1, after(105.4)) && rate.take(1, after(105.5)));
    }

    #[test]
    fn a_slow_rate_still_takes_a_scan() {
        let begin = Instant::now();
        let mut rate = Rate::new(0.01, begin);
        assert!(rate.take(1, begin) && !rate.take(1, begin + Duration::from_secs(99)));
        assert!(rate.take(1, begin + Duration::from_secs(100)));
    }
}
