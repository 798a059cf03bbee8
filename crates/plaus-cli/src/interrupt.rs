//! Ctrl-C, and the signals that schedulers send before they kill. The first asks for a checkpoint and an end; the
//! second ends the process at once.

use crate::clock::Stopwatch;
use crate::failure::Failure;
use signal_hook::consts::signal;
use signal_hook::flag::{register as raise, register_conditional_shutdown};
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

/// Exit code of an interrupted run.
pub(crate) const EXIT: u8 = 130;

/// How often a clock is looked at.
const POLL: Duration = Duration::from_millis(20);

static ASKED: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// From now on, an interrupt is noted and does not end the process.
pub(crate) fn listen() -> Result<(), Failure> {
    let asked = flag();
    let register = |signal| -> io::Result<()> {
        // Handlers run in this order: only the second signal finds the flag set.
        register_conditional_shutdown(signal, i32::from(EXIT), Arc::clone(&asked))?;
        raise(signal, Arc::clone(&asked)).map(|_| ())
    };
    let registered = signals().into_iter().try_for_each(register);
    registered.map_err(|error| Failure::Message(format!("cannot listen for interrupts: {error}")))
}

/// Set once an interrupt came.
pub(crate) fn flag() -> Arc<AtomicBool> {
    Arc::clone(ASKED.get_or_init(Arc::default))
}

/// Set once an interrupt came, or this time has passed.
pub(crate) fn flag_within(most: Option<Duration>) -> Arc<AtomicBool> {
    let Some(most) = most else { return flag() };
    let (flag, clock) = (Arc::new(AtomicBool::new(false)), Stopwatch::start());
    let mine = Arc::clone(&flag);
    std::thread::spawn(move || {
        while !asked() && clock.elapsed() < most && Arc::strong_count(&mine) > 1 {
            std::thread::sleep(POLL);
        }
        mine.store(true, Ordering::SeqCst);
    });
    flag
}

/// Whether an interrupt came.
pub(crate) fn asked() -> bool {
    ASKED.get().is_some_and(|asked| asked.load(Ordering::SeqCst))
}

/// Asks a process that was started here to write a checkpoint and end. On systems without signals, Ctrl-C reached it as
/// well.
#[cfg(unix)]
pub(crate) fn pass_on(process: u32) {
    let process = i32::try_from(process).ok().and_then(rustix::process::Pid::from_raw);
    // It may have ended in the meantime.
    let _ = process.map(|process| rustix::process::kill_process(process, rustix::process::Signal::TERM));
}

/// Asks a process that was started here to write a checkpoint and end. On systems without signals, Ctrl-C reached it as
/// well.
#[cfg(not(unix))]
pub(crate) fn pass_on(_: u32) {}

#[cfg(unix)]
fn signals() -> Vec<i32> {
    let mut signals = vec![signal::SIGINT, signal::SIGTERM];
    if !is_ignored(signal::SIGHUP) {
        signals.push(signal::SIGHUP);
    }
    signals
}

#[cfg(not(unix))]
fn signals() -> Vec<i32> {
    vec![signal::SIGINT, signal::SIGTERM]
}

/// Whether the process was started with this signal ignored, as `nohup` does for the end of the terminal; `false` if
/// that is unknown.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask >> (signal - 1) & 1 == 1
}
