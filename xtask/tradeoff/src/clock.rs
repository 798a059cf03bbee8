//! Time that this thread has spent computing, so that what a simulation costs does not depend on what else runs.

use std::time::Duration;

/// What `work` gives, and the seconds of processor time that it took.
pub(crate) fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let begin = now();
    let done = work();
    (done, now().saturating_sub(begin).as_secs_f64())
}

/// Processor time of this thread since an arbitrary instant.
#[cfg(unix)]
pub(crate) fn now() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec.unsigned_abs(), time.tv_nsec as u32)
}

/// Elsewhere time on the wall has to do.
#[cfg(not(unix))]
pub(crate) fn now() -> Duration {
    use std::sync::OnceLock;
    use std::time::Instant;
    static FIRST: OnceLock<Instant> = OnceLock::new();
    FIRST.get_or_init(Instant::now).elapsed()
}
