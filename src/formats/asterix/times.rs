//! Records say times of day, some only modulo 512 s; here they become absolute.

use super::items::{Source, TimeSaid};
use crate::formats::Reason;
use crate::model::time::TimeBase;
use std::collections::BTreeMap;

const DAY_S: f64 = 86_400.0;
/// A truncated time is known modulo this.
const PERIOD_S: f64 = 512.0;
/// Reports of one source come this much late at most.
const LATE_S: f64 = 60.0;

/// What is known of the time beside what a record says.
#[derive(Debug, Clone, Copy, Default)]
pub struct Around {
    /// When the packet was captured (Unix seconds).
    pub captured_s: Option<f64>,
    /// Time of day of the frame around the block (s).
    pub framed_s: Option<f64>,
}

/// Finds the day of each time. With the capture's time it is the day that brings both nearest; without, it is the day of the
/// record before from the same source, or the next one where the time of day falls by more than 12 h.
pub struct Clock {
    /// Midnight of the first day, where it was told.
    told_s: Option<f64>,
    is_captured: bool,
    /// Of the first record of all: the day of a new source is that which brings it nearest.
    first_s: Option<f64>,
    latest_s: BTreeMap<Source, f64>,
    /// Times of day of service messages.
    service_s: BTreeMap<Source, f64>,
}

impl Clock {
    pub fn new(told_s: Option<f64>) -> Self {
        Clock {
            told_s: told_s.map(|time_s| (time_s / DAY_S).floor() * DAY_S),
            is_captured: false,
            first_s: None,
            latest_s: BTreeMap::new(),
            service_s: BTreeMap::new(),
        }
    }

    /// What its times are counted from.
    pub fn base(&self) -> TimeBase {
        match (self.told_s, self.is_captured) {
            (Some(_), _) => TimeBase::AssumedDate,
            (None, true) => TimeBase::Utc,
            (None, false) => TimeBase::Relative,
        }
    }

    /// Time of a target's report.
    ///
    /// # Errors
    /// `no_time`, `out_of_range` (no time of day), `time_jump` (over 60 s before the record before from this source).
    pub fn of_target(
        &mut self,
        source: Source,
        said: Option<TimeSaid>,
        around: Around,
    ) -> Result<f64, Reason> {
        let of_day_s = match said.ok_or(Reason::NoTime)? {
            TimeSaid::OfDay(of_day_s) => of_day_s,
            TimeSaid::Truncated(truncated_s) => {
                let captured_s = around.captured_s.map(|time_s| time_s.rem_euclid(DAY_S));
                let latest_s = self.service_s.get(&source).copied();
                let near_s = latest_s.or(around.framed_s).or(captured_s);
                completed(truncated_s, near_s.ok_or(Reason::NoTime)?)
            }
        };
        self.absolute(source, of_day_s, around)
    }

    /// Time of a service message.
    ///
    /// # Errors
    /// As for a target.
    pub fn of_service(
        &mut self,
        source: Source,
        of_day_s: f64,
        around: Around,
    ) -> Result<f64, Reason> {
        let time_s = self.absolute(source, of_day_s, around)?;
        self.service_s.insert(source, of_day_s);
        Ok(time_s)
    }

    fn absolute(&mut self, source: Source, of_day_s: f64, around: Around) -> Result<f64, Reason> {
        if of_day_s >= DAY_S {
            return Err(Reason::OutOfRange);
        }
        let before_s = self.latest_s.get(&source).copied();
        let captured_s = around.captured_s.filter(|_| self.told_s.is_none());
        let time_s = match (captured_s, before_s, self.first_s) {
            (Some(captured_s), ..) => nearest(of_day_s, captured_s),
            (None, Some(before_s), _) => following(of_day_s, before_s),
            (None, None, Some(first_s)) => nearest(of_day_s, first_s),
            (None, None, None) => self.told_s.unwrap_or(0.0) + of_day_s,
        };
        self.is_captured |= captured_s.is_some();
        self.first_s.get_or_insert(time_s);
        self.latest_s.insert(source, time_s);
        if before_s.is_some_and(|before_s| time_s < before_s - LATE_S) {
            return Err(Reason::TimeJump);
        }
        Ok(time_s)
    }
}

/// On the day that brings it nearest to a time.
fn nearest(of_day_s: f64, to_s: f64) -> f64 {
    ((to_s - of_day_s) / DAY_S).round() * DAY_S + of_day_s
}

/// On the day of the time before, or the next one after a fall of more than 12 h. A late report from before midnight is of
/// the day before.
fn following(of_day_s: f64, before_s: f64) -> f64 {
    let midnight_s = (before_s / DAY_S).floor() * DAY_S;
    let time_s = midnight_s + of_day_s;
    if time_s < before_s - 0.5 * DAY_S {
        time_s + DAY_S
    } else if time_s - DAY_S >= before_s - LATE_S {
        time_s - DAY_S
    } else {
        time_s
    }
}

/// The time of day that a truncated one means: of all with this rest, the nearest to a time of day around midnight, too.
fn completed(truncated_s: f64, near_s: f64) -> f64 {
    let distance = |time_s: f64| {
        let apart_s = (time_s - near_s).abs();
        apart_s.min(DAY_S - apart_s)
    };
    let periods = ((near_s - truncated_s) / PERIOD_S).round();
    [periods - 1.0, periods, periods + 1.0, 0.0, 167.0, 168.0]
        .map(|periods| truncated_s + periods * PERIOD_S)
        .into_iter()
        .filter(|time_s| (0.0..DAY_S).contains(time_s))
        .min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
        .unwrap_or(truncated_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: Source = (25, 1);

    fn times(clock: &mut Clock, of_day_s: &[f64]) -> Vec<Result<f64, Reason>> {
        let said = |time_s: &f64| {
            let said = Some(TimeSaid::OfDay(*time_s));
            clock.of_target(SOURCE, said, Around::default())
        };
        of_day_s.iter().map(said).collect()
    }

    #[test]
    fn midnight_begins_the_next_day() {
        let mut clock = Clock::new(None);
        let found = times(&mut clock, &[86_399.5, 0.5, 86_390.0, 10.0]);
        assert_eq!(
            found,
            [Ok(86_399.5), Ok(86_400.5), Ok(86_390.0), Ok(86_410.0)]
        );
        assert_eq!(clock.base(), TimeBase::Relative);
    }

    #[test]
    fn three_days_with_long_gaps() {
        let hours = [1.0, 14.0, 20.0, 2.0, 13.5, 23.0, 5.0].map(|hour| hour * 3600.0);
        let found = times(&mut Clock::new(None), &hours);
        let wanted = [1.0, 14.0, 20.0, 26.0, 37.5, 47.0, 53.0].map(|hour| Ok(hour * 3600.0));
        assert_eq!(found, wanted);
    }

    #[test]
    fn a_step_back_of_more_than_a_minute_is_a_jump() {
        let found = times(
            &mut Clock::new(Some(DAY_S * 1e4 + 7.0)),
            &[100.0, 41.0, 140.0, 79.0, 80.0],
        );
        let jump = Err(Reason::TimeJump);
        let wanted = [
            Ok(DAY_S * 1e4 + 100.0),
            Ok(DAY_S * 1e4 + 41.0),
            Ok(DAY_S * 1e4 + 140.0),
            jump,
            Ok(DAY_S * 1e4 + 80.0),
        ];
        assert_eq!(found, wanted);
        assert_eq!(
            times(&mut Clock::new(None), &[86_400.0]),
            [Err(Reason::OutOfRange)]
        );
    }

    /// 29 February 2024, 23:59:59 is 1 709 251 199 s.
    #[test]
    fn the_capture_says_the_day() {
        let mut clock = Clock::new(None);
        let around = Around {
            captured_s: Some(1_709_251_199.0),
            framed_s: None,
        };
        let mut said = |time_s| clock.of_target(SOURCE, Some(TimeSaid::OfDay(time_s)), around);
        assert_eq!(said(86_398.0), Ok(1_709_251_198.0));
        assert_eq!(said(2.0), Ok(1_709_251_202.0));
        assert_eq!(clock.base(), TimeBase::Utc);
    }

    /// 86 400 = 168 · 512 + 384.
    #[test]
    fn truncated_times_are_completed_across_midnight() {
        assert_eq!(completed(256.1015625, 45_826.101), 45_824.1015625);
        assert_eq!(completed(383.0, 1.0), 86_399.0);
        assert_eq!(completed(0.5, 86_399.0), 0.5);
        assert_eq!(completed(511.5, 85_999.0), 86_015.5);
    }
}
