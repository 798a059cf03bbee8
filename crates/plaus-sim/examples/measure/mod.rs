//! Shared by the measuring examples: a clock, quantiles, a digest of outcomes, heights of bumps, and the path of a
//! trace.
#![allow(
    clippy::disallowed_methods,
    dead_code,
    unused_imports,
    unreachable_pub,
    reason = "shared by programs that use parts of it, and measuring reads the clock"
)]

#[path = "../../tests/common/bumps.rs"]
mod bumps;

pub use bumps::noise;
use serde::Serialize;
use std::error::Error;
use std::time::Instant;

/// Wall-clock time for each piece of work, and processor time over all of it: other programs make the first longer, but
/// not the second.
pub struct Stopwatch {
    pieces: Vec<f64>,
    on_processor: Option<f64>,
}

impl Stopwatch {
    pub fn start() -> Self {
        Self { pieces: Vec::new(), on_processor: processor_time() }
    }

    pub fn time<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let clock = Instant::now();
        let result = work();
        self.pieces.push(clock.elapsed().as_secs_f64());
        result
    }

    /// The fraction `p` of the pieces took no longer than this, in s.
    pub fn quantile(&self, p: f64) -> f64 {
        let mut sorted = self.pieces.clone();
        sorted.sort_by(f64::total_cmp);
        sorted.get((p * sorted.len() as f64) as usize).copied().unwrap_or(f64::NAN)
    }

    /// Processor time per piece in s, including everything between the pieces; wall-clock time if the system does not
    /// tell.
    pub fn mean(&self) -> f64 {
        let all = match (self.on_processor, processor_time()) {
            (Some(from), Some(to)) => to - from,
            _ => self.pieces.iter().sum(),
        };
        all / self.pieces.len() as f64
    }
}

/// Seconds that this thread has been on a processor (Linux).
pub fn processor_time() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(1e-9 * text.split(' ').next()?.parse::<f64>().ok()?)
}

/// FNV-1a over the bits of outcomes: two builds with equal digests made the same outcomes.
pub struct Digest(u64);

impl Digest {
    pub fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    pub fn add(&mut self, bits: u64) {
        for byte in bits.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    }

    pub fn add_all(&mut self, values: impl IntoIterator<Item = f64>) {
        values.into_iter().for_each(|v| self.add(v.to_bits()));
    }

    pub fn get(&self) -> u64 {
        self.0
    }
}

/// The arguments, without `--trace` and the path after it; and that path, or `default`.
pub fn arguments(default: &str) -> Result<(Vec<String>, String), Box<dyn Error>> {
    let mut args: Vec<String> = std::env::args().skip(1).collect();
    let Some(at) = args.iter().position(|a| a == "--trace") else { return Ok((args, default.to_owned())) };
    let path = args.drain(at..args.len().min(at + 2)).nth(1).ok_or("--trace needs a path")?;
    Ok((args, path))
}

/// Writes a trace as JSON.
pub fn write_trace(path: &str, trace: &impl Serialize) -> Result<(), Box<dyn Error>> {
    if let Some(folder) = std::path::Path::new(path).parent() {
        std::fs::create_dir_all(folder)?;
    }
    std::fs::write(path, serde_json::to_string(trace)?)?;
    Ok(())
}
