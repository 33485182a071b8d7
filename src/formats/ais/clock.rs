//! Times of messages: most feeds say when they were received, and a message says the second of the minute of its fix.

/// How far the second of a message may carry the clock of a base station.
const LONGEST_S: f64 = 60.0;

/// The time nearest to `time_s` with that second of the minute; without one `time_s`.
pub(super) fn with_second(time_s: f64, second: Option<u8>) -> f64 {
    let Some(second) = second.map(f64::from) else {
        return time_s;
    };
    let minute_s = (time_s / 60.0).floor() * 60.0;
    let ahead_s = minute_s + second - time_s;
    if ahead_s > 30.0 {
        minute_s + second - 60.0
    } else if ahead_s < -30.0 {
        minute_s + second + 60.0
    } else {
        minute_s + second
    }
}

/// The clock of a feed without times: what base stations say, or a start that the seconds of messages carry on. A message may
/// come up to 30 s late. One message in twenty says a second that is far ahead, so the clock only goes as far as two messages in
/// turn: each such second would push it on by up to half a minute.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clock {
    now_s: Option<f64>,
    /// Time of the message before.
    before_s: f64,
    /// What a base station said last.
    set_s: f64,
    is_started: bool,
}

impl Clock {
    pub fn new(start_s: Option<f64>) -> Self {
        let set_s = start_s.unwrap_or(0.0);
        Clock {
            now_s: start_s,
            before_s: set_s,
            set_s,
            is_started: start_s.is_some(),
        }
    }

    /// A base station says its time. Where the start is given, a station that is far from it is not believed.
    pub fn set(&mut self, time_s: f64) {
        let is_far = |now_s: f64| (time_s - now_s).abs() > LONGEST_S;
        if self.is_started && self.now_s.is_some_and(is_far) {
            return;
        }
        self.now_s = Some(time_s);
        self.before_s = time_s;
        self.set_s = time_s;
    }

    /// The time of a message; `None` where nothing says it, or what did is too long ago.
    pub fn time_s(&mut self, second: Option<u8>) -> Option<f64> {
        let time_s = with_second(self.now_s?, second);
        let now_s = self.now_s?.max(time_s.min(self.before_s));
        self.before_s = time_s;
        let is_lost = !self.is_started && now_s - self.set_s > LONGEST_S;
        self.now_s = (!is_lost).then_some(now_s);
        self.now_s.map(|_| time_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_time_with_a_second() {
        assert_eq!(with_second(1_418_172_113.0, Some(51)), 1_418_172_111.0);
        assert_eq!(with_second(119.5, Some(1)), 121.0);
        assert_eq!(with_second(121.0, Some(59)), 119.0);
        assert_eq!(with_second(150.0, Some(0)), 120.0);
        assert_eq!(with_second(151.0, Some(0)), 180.0);
        assert_eq!(with_second(-1.0, Some(58)), -2.0);
        assert_eq!(with_second(7.25, None), 7.25);
    }

    /// 1000 s is second 40 of its minute.
    #[test]
    fn seconds_carry_a_start_on() {
        let mut clock = Clock::new(Some(1000.0));
        let times = [50, 30, 52, 0, 59, 9].map(|second| clock.time_s(Some(second)));
        assert_eq!(
            times,
            [1010.0, 990.0, 1012.0, 1020.0, 1019.0, 1029.0].map(Some)
        );
        assert_eq!(clock.time_s(None), Some(1019.0));
        clock.set(5000.0);
        assert_eq!(clock.time_s(None), Some(1019.0));
        clock.set(1070.0);
        assert_eq!(clock.time_s(None), Some(1070.0));
    }

    /// Every third message says a second that is 20 s ahead.
    #[test]
    fn one_wrong_second_does_not_push_the_clock() {
        let mut clock = Clock::new(Some(0.0));
        for time_s in 1..600_u32 {
            let ahead_s = if time_s % 3 == 0 { 20 } else { 0 };
            let found_s = clock.time_s(Some(((time_s + ahead_s) % 60) as u8));
            assert_eq!(found_s, Some(f64::from(time_s + ahead_s)));
        }
    }

    #[test]
    fn a_base_station_is_good_for_a_minute() {
        let mut clock = Clock::new(None);
        assert_eq!(clock.time_s(Some(5)), None);
        clock.set(6000.0);
        let times = [20, 25, 45, 50, 5, 10].map(|second| clock.time_s(Some(second)));
        assert_eq!(
            times[..5],
            [6020.0, 6025.0, 6045.0, 6050.0, 6065.0].map(Some)
        );
        assert_eq!((times[5], clock.time_s(Some(11))), (None, None));
    }
}
