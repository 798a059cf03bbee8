//! Time that this thread has spent computing, so that the cost of a simulation does not depend on what else is running.

use std::time::Duration;

/// Seconds of processor time of this thread since an arbitrary instant.
#[must_use]
pub fn seconds() -> f64 {
    now().as_secs_f64()
}

/// The result of `work`, and the seconds of processor time that it took.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let begin = now();
    let done = work();
    (done, now().saturating_sub(begin).as_secs_f64())
}

/// Processor time of this thread since an arbitrary instant.
#[cfg(unix)]
#[must_use]
pub fn now() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec.unsigned_abs(), time.tv_nsec as u32)
}

/// On other systems the wall clock has to do.
#[cfg(not(unix))]
#[must_use]
#[allow(clippy::disallowed_methods, reason = "times are read from the clock")]
pub fn now() -> Duration {
    use std::sync::OnceLock;
    use std::time::Instant;
    static FIRST: OnceLock<Instant> = OnceLock::new();
    FIRST.get_or_init(Instant::now).elapsed()
}
