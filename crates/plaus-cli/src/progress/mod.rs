//! Watches a run: shows how far it is, saves it about once a second, and stops it when asked to.
//!
//! A separate thread reads the chains' [`Pulse`] while they run, so that progress shows from the first second, however
//! long a round takes.

mod beacon;
mod view;

pub(crate) use beacon::{LONGEST as LONGEST_SILENCE, Signal, State, host, read as read_signal};
pub(crate) use view::acceptance;

use crate::clock::{ProcessorClock, Stopwatch};
use crate::console;
use crate::failure::Failure;
use crate::interrupt;
use crate::output;
use beacon::Beacon;
use plaus_mcmc::{ChainPulse, Control, Ending, Progress, Pulse};
use plaus_run::{Folder, Manifest, Mixing, Watch};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;
use view::{Standing, View};

/// Time between two checks for a reason to stop, or something to show.
const TICK: Duration = Duration::from_millis(50);
/// Measuring how well a run mixes takes at most this fraction of its time: one part in 60.
const MIXING_SHARE: f64 = 60.0;

/// How progress is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Style {
    /// Not at all.
    Silent,
    /// A block of lines on a terminal, redrawn again and again.
    Live,
    /// A line now and then.
    Plain,
    /// A JSON line on stdout now and then.
    Json,
}

/// Why a run was stopped before its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stop {
    /// By Ctrl-C or a signal.
    Interrupted,
    /// By `--max-time`.
    OutOfTime,
}

/// Iterations of all chains together, and how long they will take.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Speed {
    per_second: f64,
    /// Iterations since the run began or was continued, and the seconds that they took.
    made: u64,
    seconds: f64,
    done: u64,
    chains: u64,
}

/// Seconds, and iterations of each chain, before which nobody can tell how long a run will take: the first iterations
/// are slower or faster than most.
const SOON: (f64, u64) = (3.0, 20);

impl Speed {
    /// Seconds until each chain has done `end` iterations; `None` as long as that cannot be told.
    fn seconds_left(self, end: u64) -> Option<f64> {
        let left = end.saturating_mul(self.chains).saturating_sub(self.done);
        let is_known = self.seconds >= SOON.0 && self.made >= SOON.1 * self.chains;
        is_known.then(|| left as f64 / self.per_second)
    }
}

/// The watch of a run.
pub(crate) struct Monitor<'a> {
    folder: Folder,
    style: Style,
    verbose: bool,
    limit: Option<Duration>,
    pulse: Arc<Pulse>,
    board: Mutex<Board>,
    /// Notified when the sampling is over.
    over: Condvar,
    /// Whether something else ends the run.
    is_over: &'a (dyn Fn() -> bool + Sync),
}

/// What is known of the run, and what has been shown of it.
struct Board {
    clock: Stopwatch,
    /// What the time limit counts from: the trial and the start of the chains are part of it.
    limited: Stopwatch,
    processor: ProcessorClock,
    /// Processor seconds that the sampling took, once it is over.
    spent: f64,
    /// Seconds the sampling took, once it is over.
    took: Option<f64>,
    manifest: Option<Arc<Manifest>>,
    begun_at: u64,
    /// Iterations that each chain has recorded.
    done: u64,
    standing: Standing,
    shown: Option<Stopwatch>,
    /// Lines on the terminal that the next drawing replaces.
    drawn: usize,
    stop: Option<Stop>,
    /// Set if the run is a piece.
    beacon: Option<Beacon>,
}

impl<'a> Monitor<'a> {
    /// A watch of the run in `folder` that stops it after `limit`, or as by an interrupt once `is_over`.
    pub(crate) fn new(
        style: Style,
        verbose: bool,
        limit: Option<Duration>,
        folder: &Folder,
        is_over: &'a (dyn Fn() -> bool + Sync),
    ) -> Self {
        let board = Board {
            clock: Stopwatch::start(),
            limited: Stopwatch::start(),
            processor: ProcessorClock::start(),
            spent: 0.0,
            took: None,
            manifest: None,
            begun_at: 0,
            done: 0,
            standing: Standing::default(),
            shown: None,
            drawn: 0,
            stop: None,
            beacon: None,
        };
        let folder = folder.clone();
        let (board, over) = (Mutex::new(board), Condvar::new());
        Self { folder, style, verbose, limit, pulse: Arc::default(), board, over, is_over }
    }

    /// Runs `sampling` while a thread watches it. Then clears what was drawn, so that later output takes its place.
    pub(crate) fn over<T>(&self, sampling: impl FnOnce() -> T) -> T {
        /// Ends the other thread, even if `sampling` panics.
        struct End<'a>(&'a Monitor<'a>);
        impl Drop for End<'_> {
            fn drop(&mut self) {
                self.0.finish();
            }
        }
        thread::scope(|scope| {
            let _end = End(self);
            scope.spawn(|| self.look_on());
            sampling()
        })
    }

    fn board(&self) -> MutexGuard<'_, Board> {
        self.board.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Why the run was stopped, if it was.
    pub(crate) fn stop(&self) -> Option<Stop> {
        self.board().stop
    }

    /// The flag that lets another command take as long as this one may; empty if this one has no limit.
    pub(crate) fn as_long_again(&self) -> String {
        self.limit.map_or(String::new(), |most| format!(" --max-time {}s", most.as_secs_f64()))
    }

    /// Whether the chains have begun.
    pub(crate) fn has_begun(&self) -> bool {
        self.board().manifest.is_some()
    }

    /// Iterations that each chain has recorded.
    pub(crate) fn done(&self) -> u64 {
        self.board().done
    }

    /// Iterations that each chain had done before.
    pub(crate) fn begun_at(&self) -> u64 {
        self.board().begun_at
    }

    /// Seconds from when the run began, or was continued, until it ended.
    pub(crate) fn seconds(&self) -> f64 {
        self.board().seconds()
    }

    /// Processor seconds of all threads, from when the run began, or was continued, until it ended.
    pub(crate) fn processor_seconds(&self) -> f64 {
        self.board().spent
    }

    /// Iterations of all chains together, per second.
    pub(crate) fn rate(&self) -> f64 {
        self.board().speed(&self.pulse.chains()).per_second
    }

    fn look_on(&self) {
        let mut board = self.board();
        while board.took.is_none() {
            self.check(&mut board);
            if board.manifest.is_some() {
                self.show(&mut board);
                self.signal(&mut board);
            }
            board = self.over.wait_timeout(board, TICK).unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Stops the run if there is a reason.
    fn check(&self, board: &mut Board) {
        if interrupt::asked() || (self.is_over)() {
            board.stop = Some(Stop::Interrupted);
        } else if self.limit.is_some_and(|limit| board.limited.elapsed() >= limit) {
            board.stop.get_or_insert(Stop::OutOfTime);
        }
        if board.stop.is_some() {
            self.pulse.stop();
        }
    }

    fn show(&self, board: &mut Board) {
        let seconds = board.seconds();
        let every = match (self.style, self.verbose) {
            (Style::Silent, _) => return,
            (Style::Live, _) => 0.15,
            (Style::Json, _) | (Style::Plain, true) => 1.0,
            // A reader of the file wants to see at first that the run works, and later not thousands of lines of it.
            (Style::Plain, false) => (0.5 * seconds).clamp(1.0, 60.0),
        };
        let chains = self.pulse.chains();
        if chains.is_empty() || board.shown.map_or(seconds, |shown| shown.seconds()) < every {
            return;
        }
        let Some(manifest) = board.manifest.clone() else { return };
        let (distinct, speed) = (self.pulse.distinct(), board.speed(&chains));
        let view = View { manifest: &manifest, standing: &board.standing, chains: &chains, distinct, speed };
        let left = self.limit.map(|limit| (limit.as_secs_f64() - board.limited.seconds()).max(0.0));
        let details = || if self.verbose { [view.details(), view.chain_lines()].concat() } else { Vec::new() };
        match self.style {
            Style::Live => {
                let mut lines = vec![view.bar(left)];
                lines.extend(details());
                board.draw(&lines);
            }
            // If the reader has gone, the end of the run will report it.
            Style::Json => drop(output::print_line(&view.json(left).to_string())),
            _ => {
                console::note_line(&view.line(left));
                details().iter().for_each(|line| console::note_line(line));
            }
        }
        board.shown = Some(Stopwatch::start());
    }

    /// Tells those who watch pieces from elsewhere how far this one is.
    fn signal(&self, board: &mut Board) {
        let seconds = board.seconds();
        let Some(mut beacon) = board.beacon.take_if(|beacon| beacon.is_due(seconds)) else { return };
        let chains = self.pulse.chains();
        let speed = board.speed(&chains).per_second;
        beacon.send(State::Running, &chains, self.pulse.distinct(), (seconds, speed), None);
        board.beacon = Some(beacon);
    }

    /// The last signal: how the sampling ended.
    pub(crate) fn signal_end(&self, ended: Result<&Ending, &Failure>) {
        let mut board = self.board();
        let chains = self.pulse.chains();
        let (seconds, speed) = (board.seconds(), board.speed(&chains).per_second);
        let Some(beacon) = &mut board.beacon else { return };
        let (state, why) = match ended {
            Ok(Ending::Stopped) => (State::Stopped, None),
            Ok(_) => (State::Done, None),
            Err(failure) => (State::Failed, failure.message()),
        };
        beacon.send(state, &chains, self.pulse.distinct(), (seconds, speed), why);
    }

    fn finish(&self) {
        let mut board = self.board();
        board.took = Some(board.seconds());
        board.spent = board.processor.seconds();
        board.wipe();
        self.over.notify_all();
    }
}

impl Board {
    fn seconds(&self) -> f64 {
        self.took.unwrap_or_else(|| self.clock.seconds())
    }

    fn speed(&self, chains: &[ChainPulse]) -> Speed {
        let done: u64 = chains.iter().map(|chain| chain.iterations).sum();
        let before = self.begun_at * chains.len() as u64;
        let (made, seconds) = (done.saturating_sub(before), self.seconds());
        Speed { per_second: made as f64 / seconds, made, seconds, done, chains: chains.len() as u64 }
    }

    /// Draws lines in place of the previous ones.
    fn draw(&mut self, lines: &[String]) {
        let text: String = lines.iter().map(|line| format!("\x1b[2K{line}\n")).collect();
        // Turns wrapping off in the meantime: then a line takes one row, however narrow the terminal.
        console::note(&format!("\x1b[?7l{}{text}\x1b[J\x1b[?7h", self.up()));
        self.drawn = lines.len();
    }

    fn up(&self) -> String {
        if self.drawn > 0 { format!("\x1b[{}A", self.drawn) } else { String::new() }
    }

    fn wipe(&mut self) {
        if self.drawn > 0 {
            console::note(&format!("{}\x1b[J", self.up()));
            self.drawn = 0;
        }
    }
}

/// A [`Monitor`] in the sampling thread, with what only that thread needs.
pub(crate) struct Rounds<'a> {
    monitor: &'a Monitor<'a>,
    checkpoint: Stopwatch,
    /// Seconds to the next checkpoint: short before the first, then at least one, and longer if writing one takes long.
    pause: f64,
    writing: Option<Stopwatch>,
    mixing: Stopwatch,
    /// Seconds until mixing is measured again.
    mixing_pause: f64,
    /// Called once it is known what is sampled.
    opening: &'a dyn Fn(&Manifest, u64),
    /// Whether to wait for another process that is writing the run.
    waits: bool,
    waiting: bool,
    is_piece: bool,
}

impl<'a> Rounds<'a> {
    /// `opening` is called before the first round.
    pub(crate) fn new(monitor: &'a Monitor<'a>, opening: &'a dyn Fn(&Manifest, u64), waits: bool) -> Self {
        let now = Stopwatch::start();
        let (writing, mixing, mixing_pause) = (None, now, 0.5);
        let (waiting, is_piece) = (false, false);
        Self { monitor, checkpoint: now, pause: 0.2, writing, mixing, mixing_pause, opening, waits, waiting, is_piece }
    }
}

impl Watch for Rounds<'_> {
    fn noted(&mut self, notes: &[String]) {
        if matches!(self.monitor.style, Style::Live | Style::Plain) {
            notes.iter().for_each(|note| console::remark(note));
        }
    }

    fn begin(&mut self, manifest: &Manifest, done: u64) {
        (self.opening)(manifest, done);
        self.checkpoint = Stopwatch::start();
        let mut board = self.monitor.board();
        (board.clock, board.processor) = (self.checkpoint, ProcessorClock::start());
        (board.begun_at, board.done) = (done, done);
        if self.waiting {
            board.limited = self.checkpoint;
        }
        board.manifest = Some(Arc::new(manifest.clone()));
        board.beacon = Beacon::of(manifest, &self.monitor.folder);
        self.is_piece = manifest.shard.is_some();
    }

    fn round(&mut self, progress: &Progress<'_>) -> Control {
        let mut board = self.monitor.board();
        board.done = progress.end_iteration;
        board.standing.update(progress);
        self.monitor.check(&mut board);
        if board.stop.is_some() { Control::Stop } else { Control::Continue }
    }

    fn checkpoint_due(&mut self) -> bool {
        let due = self.checkpoint.seconds() >= self.pause;
        self.writing = due.then(Stopwatch::start);
        due
    }

    fn checkpoint_done(&mut self) {
        if let Some(writing) = self.writing.take() {
            self.pause = (20.0 * writing.seconds()).max(1.0);
            if self.is_piece {
                // Many pieces share a disk. A piece that is killed loses at most a twentieth of its work, and at most a
                // minute.
                self.pause = self.pause.max((self.monitor.seconds() / 20.0).min(60.0));
            }
        }
        self.checkpoint = Stopwatch::start();
    }

    fn pulse(&self) -> Arc<Pulse> {
        Arc::clone(&self.monitor.pulse)
    }

    fn locked(&mut self, folder: &Folder) -> bool {
        if self.waits && !self.waiting {
            console::note_line(&format!(
                "{}: another process is writing it; waiting for that process to end",
                folder.path().display()
            ));
        }
        self.waiting = self.waits;
        thread::sleep(TICK);
        self.waits && !interrupt::asked()
    }

    fn looks_at_mixing(&self) -> bool {
        self.monitor.style != Style::Silent
    }

    fn mixing_due(&mut self) -> bool {
        let due = self.mixing.seconds() >= self.mixing_pause;
        if due {
            self.mixing = Stopwatch::start();
        }
        due
    }

    fn mixing(&mut self, mixing: Option<Mixing>) {
        self.mixing_pause = (MIXING_SHARE * self.mixing.seconds()).max(0.5);
        self.monitor.board().standing.mixing = mixing;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run of which one slow iteration is known is not told to take hours.
    #[test]
    fn how_long_it_takes_is_told_once_it_is_known() {
        let speed = Speed { per_second: 100.0, made: 400, seconds: 4.0, done: 500, chains: 4 };
        assert_eq!(speed.seconds_left(1_000), Some(35.0));
        assert_eq!(Speed { seconds: 0.5, ..speed }.seconds_left(1_000), None);
        assert_eq!(Speed { made: 4, ..speed }.seconds_left(1_000), None);
    }
}
