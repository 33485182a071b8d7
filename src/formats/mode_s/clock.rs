//! Clocks of receivers: a counter from some beginning, or the time of day.

use crate::formats::feed::civil::SECONDS_A_DAY;

/// What the six octets in front of a frame count.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Ticks {
    /// Ticks of 12 MHz.
    #[default]
    Counter,
    /// Seconds of the day times 2^30, and nanoseconds: receivers with GPS.
    TimeOfDay,
}

const TICKS_A_SECOND: f64 = 12e6;

/// The counter begins anew after 48 bits.
const TURN: i64 = 1 << 48;

/// What receivers of multilateration write in place of a time: `MLAT`.
const NO_TIME: u64 = 0xff00_4d4c_4154;

/// Turns what a clock shows into Unix seconds, from the start that is given.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clock {
    ticks: Ticks,
    start_s: f64,
    /// What the counter shows, and how far it is from what it showed first.
    counter: Option<(u64, i64)>,
    latest_s: f64,
}

impl Clock {
    pub fn new(ticks: Ticks, start_s: f64) -> Self {
        Clock {
            ticks,
            start_s,
            counter: None,
            latest_s: start_s,
        }
    }

    /// `None` where the clock shows that it has no time.
    pub fn time_s(&mut self, shown: u64) -> Option<f64> {
        if shown == 0 || shown == NO_TIME {
            return None;
        }
        match self.ticks {
            Ticks::Counter => Some(self.counted_s(shown)),
            Ticks::TimeOfDay => self.of_day_s(shown),
        }
    }

    fn counted_s(&mut self, shown: u64) -> f64 {
        let elapsed = self.counter.map_or(0, |(before, elapsed)| {
            let step = (shown as i64 - before as i64).rem_euclid(TURN);
            // Frames come a little out of order, never half a turn, 136 days, later.
            let step = if step >= TURN / 2 { step - TURN } else { step };
            elapsed.saturating_add(step)
        });
        self.counter = Some((shown, elapsed));
        self.start_s + elapsed as f64 / TICKS_A_SECOND
    }

    /// On the day that brings it nearest to the frame before.
    fn of_day_s(&mut self, shown: u64) -> Option<f64> {
        let day_s = SECONDS_A_DAY as f64;
        let (seconds, nanoseconds) = (shown >> 30, shown & ((1 << 30) - 1));
        let of_day_s = seconds as f64 + nanoseconds as f64 * 1e-9;
        if of_day_s >= day_s {
            return None;
        }
        let days = ((self.latest_s - of_day_s) / day_s).round();
        self.latest_s = days * day_s + of_day_s;
        Some(self.latest_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_counter_turns_over_and_steps_back() {
        let mut clock = Clock::new(Ticks::Counter, 100.0);
        let shown = [
            (1 << 48) - 12_000_000,
            (1 << 48) - 6_000_000,
            6_000_000,
            3_000_000,
        ];
        assert_eq!(
            shown.map(|shown| clock.time_s(shown)),
            [100.0, 100.5, 101.5, 101.25].map(Some)
        );
        assert_eq!((clock.time_s(0), clock.time_s(NO_TIME)), (None, None));
    }

    #[test]
    fn a_time_of_day_passes_midnight() {
        // 1 January 2024, 23:00 UTC.
        let mut clock = Clock::new(Ticks::TimeOfDay, 1_704_150_000.0);
        let shown = |seconds: u64, nanoseconds: u64| seconds << 30 | nanoseconds;
        let midnight_s = 1_704_153_600.0;
        assert_eq!(
            clock.time_s(shown(86_399, 500_000_000)),
            Some(midnight_s - 0.5)
        );
        assert_eq!(clock.time_s(shown(0, 250_000_000)), Some(midnight_s + 0.25));
        assert_eq!(
            clock.time_s(shown(86_399, 750_000_000)),
            Some(midnight_s - 0.25)
        );
        assert_eq!(clock.time_s(shown(86_400, 0)), None);
    }
}
