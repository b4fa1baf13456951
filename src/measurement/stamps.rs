//! Time stamps: dates, times of day and counts since 1970, as seconds since the first row.

use std::str::FromStr;
use toml::value::{Datetime, Offset};

const DAY: f64 = 86_400.0;

/// Counts since 1970 are told apart by their size: each of these ranges holds the years 1973 to 5138 in one unit.
const EPOCHS: [(f64, f64); 4] = [(1e8, 1.0), (1e11, 1e3), (1e14, 1e6), (1e17, 1e9)];

/// Where the last of these ranges ends.
const LAST_EPOCH: f64 = 1e20;

/// What a time stamp is, for messages.
pub(super) const EXPECTED: &str = "a date with a time (2019-01-29T10:53:36.120), a time of day (10:53:36.120), or seconds, ms, us or ns since 1970 \
     (a time that starts near 0 is no stamp: { signal = \"time\", unit = \"s\" })";

/// One time stamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stamp {
    /// Whole days since 1970; `None` for a time of day alone.
    day: Option<i64>,
    /// Seconds since midnight, or since 1970 where the stamp is a count.
    seconds: f64,
    form: Form,
}

/// Stamps of one column have one form.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    Date,
    /// A date with an offset from universal time.
    Zoned,
    Clock,
    /// A count of so many a second.
    Count(f64),
}

impl Stamp {
    /// The stamp in a cell; a comma may stand before its fractions of a second.
    pub fn parse(text: &str) -> Option<Self> {
        let text = text.trim().replace(',', ".");
        if let Ok(count) = text.parse::<f64>() {
            return Self::count(count);
        }
        let stamp = Datetime::from_str(&text).ok()?;
        let time = stamp.time?;
        let second = f64::from(time.second.unwrap_or(0)) + f64::from(time.nanosecond.unwrap_or(0)) * 1e-9;
        let seconds = f64::from(time.hour) * 3600.0 + f64::from(time.minute) * 60.0 + second;
        let Some(date) = stamp.date else {
            return Some(Self { day: None, seconds, form: Form::Clock });
        };
        let day = Some(days_since_1970(i64::from(date.year), i64::from(date.month), i64::from(date.day)));
        Some(match stamp.offset {
            None => Self { day, seconds, form: Form::Date },
            Some(Offset::Z) => Self { day, seconds, form: Form::Zoned },
            Some(Offset::Custom { minutes }) => {
                Self { day, seconds: seconds - 60.0 * f64::from(minutes), form: Form::Zoned }
            }
        })
    }

    fn count(count: f64) -> Option<Self> {
        let (_, a_second) = EPOCHS.iter().rev().find(|(from, _)| count >= *from)?;
        (count < LAST_EPOCH).then_some(Self { day: None, seconds: count / a_second, form: Form::Count(*a_second) })
    }

    /// Whether both stamps are written in one form, so that there is a time between them.
    pub fn is_like(&self, other: &Self) -> bool {
        self.form == other.form
    }

    /// Seconds from `first` to this stamp.
    pub fn since(&self, first: &Self) -> f64 {
        let days = self.day.unwrap_or(0) - first.day.unwrap_or(0);
        days as f64 * DAY + (self.seconds - first.seconds)
    }

    /// Seconds to be added to this time of day, so that it comes after `before`: a day where midnight passed between
    /// them, which a step back by more than half a day means.
    pub fn midnights(&self, before: &Self) -> f64 {
        let back = self.form == Form::Clock && before.seconds - self.seconds > 0.5 * DAY;
        if back { DAY } else { 0.0 }
    }
}

/// Days from 1 January 1970 in the Gregorian calendar.
fn days_since_1970(year: i64, month: i64, day: i64) -> i64 {
    // Years from March, so that a leap day ends the year.
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let leaps = year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400);
    // Months from March have 31, 30, 31, 30, 31 days, twice and a bit: (153 m + 2) / 5 days before month m.
    365 * year + leaps + (153 * month + 2) / 5 + day - 1 - 719_468
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]
    use super::*;

    /// Rounding of fractions of a second within a day.
    const ROUNDING: f64 = 1e-9;

    fn between(first: &str, last: &str) -> f64 {
        let (first, last) = (Stamp::parse(first).unwrap(), Stamp::parse(last).unwrap());
        assert!(last.is_like(&first));
        last.since(&first)
    }

    #[test]
    fn analytic_times_between_stamps() {
        let cases = [
            ("2019-01-29T10:53:36.120", "2019-01-29T10:53:37.250", 1.13),
            ("2019-01-29 10:53:36,120", "2019-01-29 10:53:37,250", 1.13),
            ("2019-12-31T23:59:59", "2020-01-01T00:00:01", 2.0),
            ("2020-02-28T12:00:00Z", "2020-03-01T12:00:00+01:00", 2.0 * DAY - 3600.0),
            ("10:53:36.12", "10:54:36.12", 60.0),
            ("1548759216.5", "1548759217.75", 1.25),
            ("1548759216500", "1548759217750", 1.25),
        ];
        for (first, last, seconds) in cases {
            assert!((between(first, last) - seconds).abs() < ROUNDING, "{first} {last}");
        }
        assert_eq!(days_since_1970(1970, 1, 1), 0);
        assert_eq!(days_since_1970(2000, 3, 1), 11_017);
    }

    #[test]
    fn property_midnight_passes_once() {
        let (before, after) = (Stamp::parse("23:59:59.5").unwrap(), Stamp::parse("00:00:00.5").unwrap());
        assert_eq!(after.since(&before) + after.midnights(&before), 1.0);
        assert_eq!(before.midnights(&after), 0.0);
    }

    #[test]
    fn property_what_is_no_stamp_is_refused() {
        for text in ["", "0.1", "12", "29.01.2019 10:53", "2019-01-29", "soon", "nan"] {
            assert_eq!(Stamp::parse(text), None, "{text}");
        }
    }
}
