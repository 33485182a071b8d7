//! Dates and times of day as files write them, to seconds since 1970. Leap seconds are not counted.

use jiff::civil::Date;

pub const SECONDS_A_DAY: i64 = 86_400;

const EPOCH: Date = Date::constant(1970, 1, 1);

/// Days since 1970-01-01 in the Gregorian calendar; `None` where there is no such day.
pub fn days_since_1970(year: i64, month: u32, day: u32) -> Option<i64> {
    let year = i16::try_from(year).ok().filter(|year| *year >= 0)?;
    let (month, day) = (i8::try_from(month).ok()?, i8::try_from(day).ok()?);
    let date = Date::new(year, month, day).ok()?;
    Some(date.duration_since(EPOCH).as_secs() / SECONDS_A_DAY)
}

/// Seconds since 1970 of `2024-01-31T12:00:00.5Z`, its zone `Z`, `+02`, `+0200` or `+02:00`; `T` may be a space, `-` in the
/// date `/`. Without a zone it is local time, and `utc_offset_s` says how far that is ahead of UTC.
pub fn instant(text: &str, utc_offset_s: Option<f64>) -> Option<f64> {
    let text = text.trim();
    let days = date(text.get(..10)?)?;
    let rest = text.get(10..)?.strip_prefix(['T', 't', ' '])?.trim_start();
    let end = rest.find(['Z', 'z', '+', '-']).unwrap_or(rest.len());
    let (time, zone) = rest.split_at(end);
    let ahead_s = match zone {
        "" => utc_offset_s?,
        zone => zone_offset_s(zone)?,
    };
    Some((days * SECONDS_A_DAY) as f64 + time_of_day_s(time.trim_end())? - ahead_s)
}

/// Days since 1970 of `2024-01-31` or `2024/01/31`.
pub fn date(text: &str) -> Option<i64> {
    let separator = text.chars().nth(4).filter(|c| matches!(c, '-' | '/'))?;
    let mut parts = text.split(separator);
    let (year, month, day) = (parts.next()?, parts.next()?, parts.next()?);
    if parts.next().is_some() {
        return None;
    }
    days_since_1970(digits(year, 4)?.into(), digits(month, 2)?, digits(day, 2)?)
}

/// Seconds of `12:30`, `12:30:00` or `12:30:00.25`. A leap second is the first of the next minute.
pub fn time_of_day_s(text: &str) -> Option<f64> {
    let mut parts = text.split(':');
    let (hour, minute) = (digits(parts.next()?, 2)?, digits(parts.next()?, 2)?);
    let second = seconds(parts.next().unwrap_or("00"))?;
    let is_time = hour < 24 && minute < 60 && second < 61.0 && parts.next().is_none();
    is_time.then(|| f64::from(hour * 3600 + minute * 60) + second)
}

fn seconds(text: &str) -> Option<f64> {
    let (whole, fraction) = text.split_once(['.', ',']).unwrap_or((text, "0"));
    if !fraction.bytes().all(|byte| byte.is_ascii_digit()) || fraction.is_empty() {
        return None;
    }
    let fraction: f64 = format!("0.{fraction}").parse().ok()?;
    Some(f64::from(digits(whole, 2)?) + fraction)
}

fn zone_offset_s(zone: &str) -> Option<f64> {
    let (sign, hours) = match zone.split_at_checked(1)? {
        ("Z" | "z", "") => return Some(0.0),
        ("+", hours) => (1.0, hours),
        ("-", hours) => (-1.0, hours),
        _ => return None,
    };
    let (hour, minute) = match hours.len() {
        2 => (hours, "00"),
        4 => hours.split_at_checked(2)?,
        _ => hours.split_once(':')?,
    };
    let (hour, minute) = (digits(hour, 2)?, digits(minute, 2)?);
    (hour < 24 && minute < 60).then(|| sign * f64::from(hour * 3600 + minute * 60))
}

fn digits(text: &str, count: usize) -> Option<u32> {
    let is_number = text.len() == count && text.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then(|| text.parse().ok())?
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of `date -u -d … +%s`.
    #[test]
    fn dates_are_seconds_since_1970() {
        let is =
            |text: &str, seconds: f64| assert_eq!(instant(text, None), Some(seconds), "{text}");
        is("1970-01-01T00:00:00Z", 0.0);
        is("2000-02-29T23:59:59Z", 951_868_799.0);
        is("2024-02-29 12:30:15.25Z", 1_709_209_815.25);
        is("2024/12/31T00:00:00+02:00", 1_735_596_000.0);
        is("1969-12-31T23:00:00-0130", 1800.0);
        is("2016-12-31T23:59:60Z", 1_483_228_800.0);
        assert_eq!(days_since_1970(1600, 3, 1), Some(-135_080));
    }

    #[test]
    fn local_time_needs_an_offset() {
        assert_eq!(instant("1970-01-01T02:00", None), None);
        assert_eq!(instant("1970-01-01T02:00", Some(7200.0)), Some(0.0));
        assert_eq!(instant("1970-01-01T02:00Z", Some(7200.0)), Some(7200.0));
    }

    #[test]
    fn what_is_no_time_is_none() {
        let texts = [
            "",
            "2023-02-29T00:00:00Z",
            "2100-02-29T00:00Z",
            "2024-13-01T00:00Z",
            "2024-00-10T00:00Z",
            "2024-01-01T24:00Z",
            "2024-01-01T12:60Z",
            "2024-01-01T12:00:61Z",
            "2024-01-01T12:00:00.Z",
            "2024-01-01T12:00:00+25:00",
            "2024-01-01",
            "2024-01-01T",
            "2024-01-01T1:2:3Z",
            "2024-01-0é",
            "2024-01-01T12:00:00Zx",
            "+024-01-01T00:00Z",
            "2024-01-01T12:00:00+0é0",
        ];
        for text in texts {
            assert_eq!(instant(text, None), None, "{text}");
        }
    }
}
