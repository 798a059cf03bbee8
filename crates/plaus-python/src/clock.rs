//! The clock: it decides when to show progress, and when to stop; no result depends on it.

use std::sync::LazyLock;
use std::time::Instant;

/// Seconds since this was first asked.
#[allow(clippy::disallowed_methods, reason = "the one place that reads the clock")]
pub(crate) fn now() -> f64 {
    static BEGUN: LazyLock<Instant> = LazyLock::new(Instant::now);
    BEGUN.elapsed().as_secs_f64()
}
