//! Watches a run: shows how far it is, makes it durable about once a second, stops it when asked to.

use crate::clock::{Stopwatch, in_words};
use crate::console;
use crate::interrupt;
use crate::table::{grouped, lay_out, percent, rate};
use plaus_mcmc::{Control, Hits, MoveCounts, Progress};
use plaus_run::{Manifest, Watch};
use serde_json::{Value, json};
use std::rc::Rc;
use std::time::Duration;

/// Chains shown on a terminal; the others are summed up.
const SHOWN_CHAINS: usize = 8;

/// How progress is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Style {
    /// Not at all.
    Silent,
    /// A block of lines on a terminal, drawn again and again.
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

/// The watch of a run.
pub(crate) struct Monitor {
    style: Style,
    verbose: bool,
    limit: Option<Duration>,
    clock: Stopwatch,
    /// Seconds the sampling took, once it is over.
    took: Option<f64>,
    manifest: Option<Rc<Manifest>>,
    begun_at: u64,
    done: u64,
    shown: Option<Stopwatch>,
    drawn: usize,
    checkpoint: Stopwatch,
    /// Seconds to the next checkpoint: few before the first, then at least one, and more where writing one takes long.
    pause: f64,
    writing: Option<Stopwatch>,
    stop: Option<Stop>,
}

impl Monitor {
    /// A watch that stops the run after `limit`.
    pub(crate) fn new(style: Style, verbose: bool, limit: Option<Duration>) -> Self {
        Self {
            style,
            verbose,
            limit,
            clock: Stopwatch::start(),
            took: None,
            manifest: None,
            begun_at: 0,
            done: 0,
            shown: None,
            drawn: 0,
            checkpoint: Stopwatch::start(),
            pause: 0.2,
            writing: None,
            stop: None,
        }
    }

    /// Why the run was stopped, if it was.
    pub(crate) fn stop(&self) -> Option<Stop> {
        self.stop
    }

    /// Iterations each chain has done.
    pub(crate) fn done(&self) -> u64 {
        self.done
    }

    /// Iterations each chain had done before.
    pub(crate) fn begun_at(&self) -> u64 {
        self.begun_at
    }

    /// Seconds since the run began, or went on, until it ended.
    pub(crate) fn seconds(&self) -> f64 {
        self.took.unwrap_or_else(|| self.clock.seconds())
    }

    /// Iterations of all chains together, per second.
    pub(crate) fn rate(&self) -> f64 {
        let chains = self.manifest.as_ref().map_or(0, |manifest| manifest.plan.chains);
        (self.done - self.begun_at) as f64 * f64::from(chains) / self.seconds()
    }

    fn show(&mut self, progress: &Progress<'_>) {
        let every = match (self.style, self.verbose) {
            (Style::Silent, _) => return,
            (Style::Live, _) => 0.15,
            (Style::Json, _) | (Style::Plain, true) => 1.0,
            (Style::Plain, false) => 10.0,
        };
        if self.shown.map_or(self.seconds(), |shown| shown.seconds()) < every {
            return;
        }
        let Some(manifest) = self.manifest.clone() else { return };
        match self.style {
            Style::Live => self.draw(&manifest, progress),
            Style::Json => self.print_json(&manifest, progress),
            _ => {
                console::note_line(&self.headlines(&manifest, progress).join("  "));
                let chains = if self.verbose { self.chain_lines(&manifest, progress) } else { Vec::new() };
                chains.iter().for_each(|line| console::note_line(line));
            }
        }
        self.shown = Some(Stopwatch::start());
    }

    fn eta(&self, manifest: &Manifest) -> f64 {
        let left = manifest.plan.end().saturating_sub(self.done) as f64;
        left * self.seconds() / (self.done - self.begun_at) as f64
    }

    /// How far the run is, and what it has found.
    fn headlines(&self, manifest: &Manifest, progress: &Progress<'_>) -> [String; 2] {
        let end = manifest.plan.end();
        let wanted = manifest.plan.solutions.map(|wanted| format!(" of {}", grouped(wanted))).unwrap_or_default();
        let far = format!(
            "{} {:>3.0}%  iteration {} of {}  {}  ETA {}",
            manifest.scene,
            100.0 * self.done as f64 / end as f64,
            grouped(self.done),
            grouped(end),
            rate(self.rate()),
            in_words(self.eta(manifest)),
        );
        let hits = percent(share_of_hits(&progress.chains, self.done));
        let restarts: u64 = progress.climbs.iter().map(|climb| climb.restarts()).sum();
        let fresh =
            if progress.climbs.is_empty() { String::new() } else { format!("  restarts {}", grouped(restarts)) };
        [far, format!("hits {hits}  distinct {}{wanted}{fresh}", grouped(progress.distinct.count()))]
    }

    /// A column a chain: how fast it is, what it hits, what it accepts of each move.
    fn chain_lines(&self, manifest: &Manifest, progress: &Progress<'_>) -> Vec<String> {
        let chains = &progress.chains[..progress.chains.len().min(SHOWN_CHAINS)];
        let row = |name: &str, cell: &dyn Fn(usize) -> String| -> Vec<String> {
            std::iter::once(name.to_owned()).chain((0..chains.len()).map(cell)).collect()
        };
        let speed = rate(self.rate() / f64::from(manifest.plan.chains));
        let hits = |chain: usize| percent(chains[chain].1.count as f64 / self.done as f64);
        let mut rows = vec![
            row("", &|chain| format!("chain {chain}")),
            row("  iterations", &|_| speed.clone()),
            row("  hits", &hits),
            vec!["  accepted:".to_owned()],
        ];
        rows.extend(manifest.moves.iter().enumerate().map(|(index, name)| {
            row(&format!("    {name}"), &|chain| {
                chains[chain].0.get(index).map_or_else(String::new, |count| percent(count.acceptance()))
            })
        }));
        let mut lines: Vec<String> = lay_out(&rows).lines().map(str::to_owned).collect();
        if let Some(more) = progress.chains.len().checked_sub(SHOWN_CHAINS).filter(|&more| more > 0) {
            lines.push(format!("  and {more} more chains"));
        }
        lines
    }

    /// Draws the block in place of the one before.
    fn draw(&mut self, manifest: &Manifest, progress: &Progress<'_>) {
        let mut lines = self.headlines(manifest, progress).to_vec();
        lines.extend(self.chain_lines(manifest, progress));
        let text: String = lines.iter().map(|line| format!("\x1b[2K{line}\n")).collect();
        // Without wrapping meanwhile: a line is a row, however narrow the terminal.
        console::note(&format!("\x1b[?7l{}{text}\x1b[?7h", self.up()));
        self.drawn = lines.len();
    }

    fn up(&self) -> String {
        if self.drawn > 0 { format!("\x1b[{}A", self.drawn) } else { String::new() }
    }

    /// Stops the clock and takes the block away, so that what follows stands in its place.
    pub(crate) fn finish(&mut self) {
        self.took = Some(self.seconds());
        if self.drawn > 0 {
            console::note(&format!("{}\x1b[J", self.up()));
            self.drawn = 0;
        }
    }

    fn print_json(&self, manifest: &Manifest, progress: &Progress<'_>) {
        let chain = |(chain, (counts, hits)): (usize, &(&[MoveCounts], Hits))| {
            json!({
                "chain": chain,
                "iterations_per_second": self.rate() / f64::from(manifest.plan.chains),
                "hits": hits.count,
                "first_hit": hits.first,
                "acceptance": acceptance(&manifest.moves, counts),
            })
        };
        let line = json!({
            "event": "progress",
            "iteration": self.done,
            "end": manifest.plan.end(),
            "distinct": progress.distinct.count(),
            "iterations_per_second": self.rate(),
            "eta_seconds": self.eta(manifest),
            "restarts": progress.climbs.iter().map(|climb| climb.restarts()).sum::<u64>(),
            "chains": progress.chains.iter().enumerate().map(chain).collect::<Vec<_>>(),
        });
        let _ = console::print_line(&line.to_string()); // where the reader has gone, the end of the run will say so
    }
}

/// Acceptance of each move, by name.
pub(crate) fn acceptance(moves: &[String], counts: &[MoveCounts]) -> Value {
    moves.iter().zip(counts).map(|(name, count)| (name.clone(), json!(count.acceptance()))).collect()
}

fn share_of_hits(chains: &[(&[MoveCounts], Hits)], done: u64) -> f64 {
    let hits: u64 = chains.iter().map(|(_, hits)| hits.count).sum();
    hits as f64 / (done as f64 * chains.len() as f64)
}

impl Watch for Monitor {
    fn begin(&mut self, manifest: &Manifest, done: u64) {
        self.clock = Stopwatch::start();
        self.checkpoint = self.clock;
        (self.begun_at, self.done) = (done, done);
        self.manifest = Some(Rc::new(manifest.clone()));
    }

    fn round(&mut self, progress: &Progress<'_>) -> Control {
        self.done = progress.end_iteration;
        if interrupt::asked() {
            self.stop = Some(Stop::Interrupted);
        } else if self.limit.is_some_and(|limit| self.clock.elapsed() >= limit) {
            self.stop = Some(Stop::OutOfTime);
        }
        self.show(progress);
        if self.stop.is_some() { Control::Stop } else { Control::Continue }
    }

    fn checkpoint_due(&mut self) -> bool {
        let due = self.checkpoint.seconds() >= self.pause;
        self.writing = due.then(Stopwatch::start);
        due
    }

    fn checkpoint_done(&mut self) {
        if let Some(writing) = self.writing.take() {
            self.pause = (20.0 * writing.seconds()).max(1.0);
        }
        self.checkpoint = Stopwatch::start();
    }
}
