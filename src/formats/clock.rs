//! Times as files write them: seconds, ISO 8601, a named format, or the time of day.

use crate::model::time::TimeBase;
use jiff::civil::{DateTime, Time};
use jiff::fmt::strtime;
use jiff::fmt::temporal::Pieces;
use jiff::tz::{Offset, TimeZone};

const DAY_S: f64 = 86_400.0;

/// Reads the times of one file, all of them written in the same way. Times of day pass midnight: each is of the day that
/// brings it nearest to the one before.
#[derive(Debug, Default)]
pub struct Clock {
    format: Option<String>,
    /// What one unit of a number is (s); 0: a second.
    unit_s: f64,
    utc_offset_s: Option<f64>,
    added_s: f64,
    day_s: Option<f64>,
    of_numbers: Option<TimeBase>,
    way: Option<Way>,
    /// The time before, of times of day.
    before_s: Option<f64>,
    /// Whether a time without a zone was read.
    pub assumed_utc: bool,
}

/// Seconds since 1970 of an ISO 8601 text, of UTC where it names no zone; `None` of other texts.
pub fn read_instant(text: &str) -> Option<f64> {
    Clock::default().read_instant(text)
}

/// How a file writes its times.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    Number,
    Instant,
    TimeOfDay,
}

/// Why a text is no time of this file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoTime {
    /// It is none at all.
    Unreadable,
    NotFinite,
    /// Others before were written in another way.
    OtherWay,
}

impl Clock {
    /// `unit_s`: what one unit of a number is.
    pub fn new(reading: &super::reading::Reading, unit_s: f64) -> Self {
        Clock {
            format: reading.time_format.clone(),
            unit_s,
            utc_offset_s: reading.utc_offset_s,
            added_s: reading.clock_offset_s.unwrap_or_default(),
            day_s: reading.day_s().ok().flatten(),
            of_numbers: reading.time_base,
            ..Clock::default()
        }
    }

    /// What the times read so far are counted from; of numbers the request knows, else the file.
    pub fn base(&self) -> TimeBase {
        match self.way {
            Some(Way::Instant) => TimeBase::Utc,
            Some(Way::TimeOfDay) if self.day_s.is_some() => TimeBase::AssumedDate,
            Some(Way::TimeOfDay) => TimeBase::Relative,
            Some(Way::Number) | None => self.of_numbers.unwrap_or_default(),
        }
    }

    /// Notes what the file says that its numbers are counted from.
    pub fn note_base(&mut self, base: TimeBase) {
        self.of_numbers.get_or_insert(base);
    }

    /// Seconds.
    ///
    /// # Errors
    /// A text that is no time, or not of the way of those before.
    pub fn read(&mut self, text: &str) -> Result<f64, NoTime> {
        let (way, time_s) = self.recognise(text).ok_or(NoTime::Unreadable)?;
        if !time_s.is_finite() {
            return Err(NoTime::NotFinite);
        }
        if *self.way.get_or_insert(way) != way {
            return Err(NoTime::OtherWay);
        }
        let time_s = match way {
            Way::Number => time_s * if self.unit_s > 0.0 { self.unit_s } else { 1.0 },
            Way::Instant => time_s,
            Way::TimeOfDay => self.of_day(time_s),
        };
        Ok(time_s + self.added_s)
    }

    /// The same of a file whose numbers count from 1970: those too large for seconds are milli-, micro- or nanoseconds.
    ///
    /// # Errors
    /// As of [`Clock::read`].
    pub fn read_unix(&mut self, text: &str) -> Result<f64, NoTime> {
        let number: Option<f64> = text.parse().ok().filter(|_| self.format.is_none());
        let Some(number) = number else {
            return self.read(text);
        };
        if !number.is_finite() {
            return Err(NoTime::NotFinite);
        }
        // The year 5138 in seconds.
        let mut unit_s = 1.0;
        while number * unit_s > 1e11 {
            unit_s *= 1e-3;
        }
        Ok(number * unit_s + self.added_s)
    }

    fn recognise(&mut self, text: &str) -> Option<(Way, f64)> {
        if let Some(format) = &self.format {
            return self.read_named(&format.clone(), text);
        }
        if let Ok(number) = text.parse::<f64>() {
            return Some((Way::Number, number));
        }
        if let Some(time_s) = self.read_instant(text) {
            return Some((Way::Instant, time_s));
        }
        // Of a text with a day the library would take the time alone.
        let time: Time = Some(text)
            .filter(|text| !text.contains(['-', 'T']))?
            .parse()
            .ok()?;
        Some((
            Way::TimeOfDay,
            seconds_of_day(time) - self.utc_offset_s.unwrap_or_default(),
        ))
    }

    /// ISO 8601, with `T` or a space, with or without a zone; a day alone is its midnight.
    fn read_instant(&mut self, text: &str) -> Option<f64> {
        let text = text.strip_suffix(" UTC").unwrap_or(text);
        let pieces = Pieces::parse(text).ok()?;
        // A name such as [Europe/Paris] needs tables that change.
        if pieces.time_zone_annotation().is_some() {
            return None;
        }
        let local = pieces
            .date()
            .to_datetime(pieces.time().unwrap_or(Time::midnight()));
        let offset = pieces.to_numeric_offset();
        Some(self.as_utc(local, offset))
    }

    fn read_named(&mut self, format: &str, text: &str) -> Option<(Way, f64)> {
        let parts = strtime::parse(format, text).ok()?;
        if let Ok(timestamp) = parts.to_timestamp() {
            return Some((Way::Instant, seconds(timestamp.as_nanosecond())));
        }
        match (parts.to_date(), parts.to_time()) {
            (Ok(date), time) => {
                let local = date.to_datetime(time.unwrap_or(Time::midnight()));
                Some((Way::Instant, self.as_utc(local, parts.offset())))
            }
            (Err(_), Ok(time)) => {
                let offset_s = self.utc_offset_s.unwrap_or_default();
                Some((Way::TimeOfDay, seconds_of_day(time) - offset_s))
            }
            _ => None,
        }
    }

    fn as_utc(&mut self, local: DateTime, offset: Option<Offset>) -> f64 {
        let as_utc_s = TimeZone::UTC
            .to_timestamp(local)
            .map_or(f64::NAN, |timestamp| seconds(timestamp.as_nanosecond()));
        match (offset, self.utc_offset_s) {
            (Some(offset), _) => as_utc_s - f64::from(offset.seconds()),
            (None, Some(offset_s)) => as_utc_s - offset_s,
            (None, None) => {
                self.assumed_utc = true;
                as_utc_s
            }
        }
    }

    fn of_day(&mut self, of_day_s: f64) -> f64 {
        let near_s = self
            .before_s
            .unwrap_or(of_day_s + self.day_s.unwrap_or_default());
        let time_s = nearest_day_s(of_day_s, near_s);
        self.before_s = Some(time_s);
        time_s
    }
}

/// The time of day on the day that brings it nearest to `near_s`.
pub fn nearest_day_s(of_day_s: f64, near_s: f64) -> f64 {
    of_day_s + ((near_s - of_day_s) / DAY_S).round() * DAY_S
}

fn seconds_of_day(time: Time) -> f64 {
    let since = time.duration_since(Time::midnight());
    seconds(since.as_nanos())
}

/// The whole seconds are exact, so that a fraction loses no more than a double must.
fn seconds(nanoseconds: i128) -> f64 {
    let (whole, rest) = (
        nanoseconds.div_euclid(1_000_000_000),
        nanoseconds.rem_euclid(1_000_000_000),
    );
    whole as f64 + rest as f64 / 1e9
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::reading::Reading;

    fn clock(change: impl FnOnce(&mut Reading)) -> Clock {
        let mut reading = Reading::default();
        change(&mut reading);
        Clock::new(&reading, 1.0)
    }

    // Seconds of the dates are those of `date -u -d … +%s`.
    #[test]
    fn instants_are_read_in_every_spelling() {
        for (text, wanted_s) in [
            ("2016-01-12 13:02:11.218", 1_452_603_731.218),
            ("2016-01-12T13:02:11.218Z", 1_452_603_731.218),
            ("2016-01-12T14:02:11.218+01:00", 1_452_603_731.218),
            ("2016-01-12 13:02:11.218 UTC", 1_452_603_731.218),
            ("2024-02-29", 1_709_164_800.0),
            ("1969-12-31T23:59:59.5Z", -0.5),
        ] {
            let mut clock = Clock::default();
            assert_eq!(clock.read(text), Ok(wanted_s), "{text}");
            assert_eq!(clock.base(), TimeBase::Utc);
        }
        let mut local = clock(|reading| reading.utc_offset_s = Some(3600.0));
        assert_eq!(local.read("2016-01-12 14:02:11.218"), Ok(1_452_603_731.218));
        assert!(!local.assumed_utc);
    }

    #[test]
    fn a_named_format_and_units_are_read() {
        let mut danish = clock(|reading| reading.time_format = Some("%d/%m/%Y %H:%M:%S".into()));
        assert_eq!(danish.read("12/01/2016 13:02:11"), Ok(1_452_603_731.0));
        assert!(danish.assumed_utc);
        assert_eq!(danish.read("2016-01-12 13:02:11"), Err(NoTime::Unreadable));
        let mut milliseconds = Clock::new(&Reading::default(), 1e-3);
        assert_eq!(milliseconds.read("1533101250125"), Ok(1_533_101_250.125));
    }

    #[test]
    fn times_of_day_pass_midnight_both_ways() {
        let mut clock = clock(|reading| reading.date = Some("2024-02-29".into()));
        let day_s = 1_709_164_800.0;
        for (text, wanted_s) in [
            ("23:59:59.5", 86_399.5),
            ("00:00:00.5", 86_400.5),
            ("23:59:30", 86_370.0),
            ("00:00:10", 86_410.0),
        ] {
            assert_eq!(clock.read(text), Ok(day_s + wanted_s), "{text}");
        }
        assert_eq!(clock.base(), TimeBase::AssumedDate);
        assert_eq!(clock.read("3"), Err(NoTime::OtherWay));
    }

    #[test]
    fn what_is_no_time_is_none() {
        for text in [
            "",
            "noon",
            "2023-02-29",
            "2016-01-12T13:02:11[Europe/Paris]",
            "25:00:00",
        ] {
            assert_eq!(
                Clock::default().read(text),
                Err(NoTime::Unreadable),
                "{text}"
            );
        }
        assert_eq!(Clock::default().read("inf"), Err(NoTime::NotFinite));
    }
}
