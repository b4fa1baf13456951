//! Paths of the files within an FMU, by version of the standard.

use crate::platform::Platform;

/// Version of the standard.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Version {
    /// FMI 2.0: what nearly every tool reads.
    Fmi2,
    /// FMI 3.0.
    #[default]
    Fmi3,
}

impl Version {
    /// Name of this crate's target: the folder below `binaries`.
    #[must_use]
    pub fn platform(self) -> String {
        self.folder(Platform::OWN)
    }

    /// FMI 2.0 names systems by their word length, FMI 3.0 (2.5.1.4.3) by architecture and system.
    fn folder(self, platform: Platform) -> String {
        let Platform { architecture, system } = platform;
        match (self, architecture, system) {
            (Self::Fmi2, "x86_64", "linux") => "linux64".into(),
            (Self::Fmi2, "x86", "linux") => "linux32".into(),
            (Self::Fmi2, "x86_64", "windows") => "win64".into(),
            (Self::Fmi2, "x86", "windows") => "win32".into(),
            (Self::Fmi2, "x86_64", "macos") => "darwin64".into(),
            // FMI 2.0 has no names for other architectures; tools that run there use those of FMI 3.0.
            (_, _, "macos") => format!("{architecture}-darwin"),
            _ => format!("{architecture}-{system}"),
        }
    }

    /// Place of the library for a platform.
    pub(crate) fn library(self, platform: Platform, identifier: &str) -> String {
        format!("binaries/{}/{identifier}.{}", self.folder(platform), platform.extension())
    }
}

/// A time as the standard's example has it, `2026-11-21T19:00:00Z`; from seconds since 1970.
pub(crate) fn utc(seconds: u64) -> String {
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    let (year, month, day) = date(days);
    format!("{year:04}-{month:02}-{day:02}T{:02}:{:02}:{:02}Z", second / 3600, second / 60 % 60, second % 60)
}

/// The Gregorian date of a day since 1970-01-01, by counting.
fn date(mut days: u64) -> (u64, u64, u64) {
    let leap = |year: u64| (year.is_multiple_of(4) && !year.is_multiple_of(100)) || year.is_multiple_of(400);
    let mut year = 1970;
    while days >= 365 + u64::from(leap(year)) {
        days -= 365 + u64::from(leap(year));
        year += 1;
    }
    let lengths = [31, 28 + u64::from(leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut month = 1;
    for length in lengths {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    (year, month, days + 1)
}

#[cfg(test)]
mod tests {
    use super::utc;

    #[test]
    fn analytic_known_times() {
        for (seconds, text) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (1_000_000_000, "2001-09-09T01:46:40Z"),
            (1_735_689_599, "2024-12-31T23:59:59Z"),
        ] {
            assert_eq!(utc(seconds), text);
        }
    }
}
