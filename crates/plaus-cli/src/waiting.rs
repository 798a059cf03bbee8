//! Tells people that a command is still at work, once it has taken a while.

use crate::clock::{Stopwatch, in_words};
use crate::console;
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

/// How far the work is. A process does one such work at a time.
static FAR: Mutex<String> = Mutex::new(String::new());

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
        far(String::new());
        let (over, is_over) = channel();
        let watch = move || {
            let (start, mut has_told) = (Stopwatch::start(), false);
            while is_over.recv_timeout(pause) == Err(RecvTimeoutError::Timeout) {
                let far = FAR.lock().unwrap_or_else(PoisonError::into_inner).clone();
                tell(&format!("{what}: {far}{}", in_words(start.seconds())));
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

/// Notes how far the work is, such as "3 of 20 frames".
pub(crate) fn far(words: String) {
    let words = if words.is_empty() { words } else { words + ", " };
    *FAR.lock().unwrap_or_else(PoisonError::into_inner) = words;
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
        far("3 of 20 frames".to_owned());
        assert!(told.iter().any(|line| line.starts_with("drawing: 3 of 20 frames, 0.")));
        drop(waiting);
        // Whatever was told before the end is still there, and then nothing more comes.
        assert!(told.iter().all(|line| line.starts_with("drawing: ")));
    }
}
