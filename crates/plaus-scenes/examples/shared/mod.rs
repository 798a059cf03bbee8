//! Time that a program spent computing, whatever else the machine did.

/// Seconds of processor time of this thread since an arbitrary instant.
#[cfg(unix)]
pub(crate) fn seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// On other systems the wall clock has to do.
#[cfg(not(unix))]
#[allow(clippy::disallowed_methods, reason = "a measuring program reads the clock")]
pub(crate) fn seconds() -> f64 {
    use std::sync::OnceLock;
    use std::time::Instant;
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}
