//! The clock, read nowhere else. It decides when something is shown or saved, never what the result is.

use std::time::{Duration, Instant};

/// Measures time since it was started.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stopwatch(Instant);

impl Stopwatch {
    /// Starts.
    #[allow(clippy::disallowed_methods)]
    pub(crate) fn start() -> Self {
        Self(Instant::now())
    }

    /// Time since the start.
    pub(crate) fn elapsed(&self) -> Duration {
        self.0.elapsed()
    }

    /// Seconds since the start.
    pub(crate) fn seconds(&self) -> f64 {
        self.elapsed().as_secs_f64()
    }
}

/// Measures the processor time of the whole process since it was started: the time of all threads on all cores
/// together. Where the system does not report it, this is wall-clock time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ProcessorClock(f64, Stopwatch);

impl ProcessorClock {
    /// Starts.
    pub(crate) fn start() -> Self {
        Self(processor_seconds().unwrap_or(0.0), Stopwatch::start())
    }

    /// Seconds since the start.
    pub(crate) fn seconds(&self) -> f64 {
        processor_seconds().map_or_else(|| self.1.seconds(), |now| now - self.0)
    }
}

#[cfg(unix)]
fn processor_seconds() -> Option<f64> {
    let spent = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(spent.tv_sec as f64 + 1e-9 * spent.tv_nsec as f64)
}

#[cfg(not(unix))]
fn processor_seconds() -> Option<f64> {
    None
}

/// Seconds since 1970, for comparison with another machine's clock.
#[allow(clippy::disallowed_methods)]
pub(crate) fn unix_seconds() -> u64 {
    std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).map_or(0, |time| time.as_secs())
}

/// Reads `90`, `90s`, `1.5m`, `2h` or `500ms`; a bare number is seconds.
pub(crate) fn parse_duration(text: &str) -> Result<Duration, String> {
    let text = text.trim();
    if text.starts_with('-') {
        return Err("a time cannot be negative".to_owned());
    }
    let split = text.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(text.len());
    let (number, unit) = text.split_at(split);
    let factor = match unit.trim() {
        "" | "s" => 1.0,
        "ms" => 1e-3,
        "m" | "min" => 60.0,
        "h" => 3600.0,
        "d" => 86_400.0,
        other => return Err(format!("unknown unit `{other}`: ms, s, m, h and d are known, e.g. 60s")),
    };
    let number: f64 = number.parse().map_err(|_| "not a time: write e.g. 60s, 1.5m or 2h".to_owned())?;
    Duration::try_from_secs_f64(number * factor).map_err(|_| "too long".to_owned())
}

/// Seconds in a form that people read.
pub(crate) fn in_words(seconds: f64) -> String {
    match seconds {
        s if !s.is_finite() => "?".to_owned(),
        s if s < 9.95 => format!("{s:.1} s"),
        s if s < 99.5 => format!("{s:.0} s"),
        s if s < 5940.0 => format!("{:.0} min", s / 60.0),
        s if s < 172_800.0 => format!("{:.1} h", s / 3600.0),
        s => format!("{:.1} d", s / 86_400.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_read() {
        let seconds = |text| parse_duration(text).map(|time| time.as_secs_f64());
        assert_eq!(seconds("60s"), Ok(60.0));
        assert_eq!(seconds("90"), Ok(90.0));
        assert_eq!(seconds("1.5m"), Ok(90.0));
        assert_eq!(seconds("250ms"), Ok(0.25));
        for wrong in ["", "s", "-5s", "5 parsecs", "1e400h", "..", "inf", "NaN"] {
            assert!(seconds(wrong).is_err(), "{wrong}");
        }
    }
}
