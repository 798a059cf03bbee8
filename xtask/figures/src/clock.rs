//! Time that is spent, whatever else the machine does.

/// Seconds of processor time of this thread, where Linux tells; else those since some fixed time.
pub(crate) fn seconds() -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(since_start, |ns| ns * 1e-9)
}

#[allow(clippy::disallowed_methods, reason = "times of the report are read from the clock")]
fn since_start() -> f64 {
    use std::sync::OnceLock;
    use std::time::Instant;
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}
