//! Tells people that a command is still at work, once it has taken a while.

use crate::clock::{Stopwatch, in_words};
use crate::console;
use crate::table::grouped;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// How long a command may take without a word.
const PATIENCE: Duration = Duration::from_secs(2);
/// Longest time between two lines where lines cannot be redrawn.
const LONGEST: Duration = Duration::from_secs(30);
/// Time between two looks at how far the work is, where lines can be redrawn.
const TICK: Duration = Duration::from_millis(500);

/// Finished things, all things, and what they are, such as "frames". A process does one such work at a time.
static FAR: Mutex<(u64, u64, &str)> = Mutex::new((0, 0, ""));
/// Bytes written so far.
static WRITTEN: AtomicU64 = AtomicU64::new(0);
/// Fewest bytes whose number is worth a word.
const LARGE: f64 = 1e6;

/// Says on stderr what is being done, from the time when that has taken a while until this is dropped.
#[derive(Debug)]
pub(crate) struct Waiting(Option<(Sender<()>, JoinHandle<()>)>);

impl Waiting {
    /// Begins to wait for `what`, such as "drawing a.gif".
    pub(crate) fn on(what: String) -> Self {
        match console::is_live() {
            true => Self::telling(what, PATIENCE, |_| TICK, |line| console::note(&format!("\r{line}\x1b[K"))),
            false => Self::telling(what, PATIENCE, |pause| (2 * pause).min(LONGEST), console::note_line),
        }
    }

    /// Tells a line after each pause. At the end, a line on a terminal is wiped out.
    fn telling(
        what: String,
        mut pause: Duration,
        next: fn(Duration) -> Duration,
        tell: impl Fn(&str) + Send + 'static,
    ) -> Self {
        far(0, 0, "");
        WRITTEN.store(0, Relaxed);
        let (over, is_over) = channel();
        let watch = move || {
            let (start, mut has_told) = (Stopwatch::start(), false);
            while is_over.recv_timeout(pause) == Err(RecvTimeoutError::Timeout) {
                tell(&format!("{what}: {}", state(start.seconds())));
                (has_told, pause) = (true, next(pause));
            }
            if has_told && console::is_live() {
                console::note("\r\x1b[K");
            }
        };
        Self(thread::Builder::new().spawn(watch).ok().map(|thread| (over, thread)))
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        if let Some((over, thread)) = self.0.take() {
            drop(over);
            // A thread that cannot write to stderr has nothing left to do either.
            let _ = thread.join();
        }
    }
}

/// Notes how far the work is, such as 3 of 20 frames.
pub(crate) fn far(done: u64, of: u64, things: &'static str) {
    *FAR.lock().unwrap_or_else(PoisonError::into_inner) = (done, of, things);
}

/// Notes that so many more bytes are written.
pub(crate) fn wrote(bytes: usize) {
    WRITTEN.fetch_add(bytes as u64, Relaxed);
}

/// How far the work is after `seconds`, and how much time and how many bytes the rest takes at the same pace.
fn state(seconds: f64) -> String {
    let (done, of, things) = *FAR.lock().unwrap_or_else(PoisonError::into_inner);
    if of == 0 {
        return in_words(seconds);
    }
    let far = format!("{} of {} {things}", grouped(done), grouped(of));
    if done == 0 {
        return format!("{far}, {}", in_words(seconds));
    }
    let whole = of as f64 / done as f64;
    let bytes = whole * WRITTEN.load(Relaxed) as f64;
    let size = if bytes < LARGE { String::new() } else { format!(", about {:.0} MB in all", bytes / 1e6) };
    format!("{far}, about {} left{size}", in_words(seconds * (whole - 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_work_is_told_of_with_how_far_it_is() {
        let (tell, told) = channel();
        let waiting = Waiting::telling(
            "drawing".to_owned(),
            Duration::from_millis(1),
            |pause| pause,
            move |line| drop(tell.send(line.to_owned())),
        );
        assert!(told.recv().is_ok_and(|line| line.starts_with("drawing: 0.")));
        far(3, 20, "frames");
        assert!(told.iter().any(|line| line.starts_with("drawing: 3 of 20 frames, about ")));
        wrote(3_000_000);
        assert!(told.iter().any(|line| line.ends_with(" left, about 20 MB in all")));
        drop(waiting);
        // Whatever was told before the end is still there, and then nothing more comes.
        assert!(told.iter().all(|line| line.starts_with("drawing: ")));
    }
}
