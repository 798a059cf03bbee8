//! The progress of a run, in words and as JSON.

use super::{SOON, Speed};
use crate::clock::in_words;
use crate::table::{grouped, lay_out, percent, rate, rounded};
use plaus_mcmc::{ChainPulse, Hits, MoveCounts, Progress};
use plaus_run::{Manifest, Mixing};
use serde_json::{Value, json};

/// Chains shown on a terminal; the others are summed up.
const SHOWN_CHAINS: usize = 8;
/// Columns of the bar.
const BAR: usize = 20;

/// The state of a run after its last round.
#[derive(Debug, Clone, Default)]
pub(super) struct Standing {
    /// For each chain, how often each move ended in each way, and its hits.
    chains: Vec<(Vec<MoveCounts>, Hits)>,
    /// Set if chains are tempered.
    restarts: Option<u64>,
    pub(super) mixing: Option<Mixing>,
}

impl Standing {
    /// Takes over the results of a round.
    pub(super) fn update(&mut self, progress: &Progress<'_>) {
        self.chains = progress.chains.iter().map(|(counts, hits)| (counts.to_vec(), *hits)).collect();
        let restarts = || progress.climbs.iter().map(|climb| climb.restarts()).sum();
        self.restarts = (!progress.climbs.is_empty()).then(restarts);
    }
}

/// Everything that is shown at one moment.
pub(super) struct View<'a> {
    pub(super) manifest: &'a Manifest,
    pub(super) standing: &'a Standing,
    /// How far each chain is now.
    pub(super) chains: &'a [ChainPulse],
    pub(super) distinct: u64,
    pub(super) speed: Speed,
}

impl View<'_> {
    /// Iterations that a chain has done, as a mean over the chains.
    fn done(&self) -> u64 {
        self.chains.iter().map(|chain| chain.iterations).sum::<u64>() / (self.chains.len() as u64).max(1)
    }

    /// One past its last iteration; `None` if only its solutions or its time end the run.
    fn end(&self) -> Option<u64> {
        let plan = &self.manifest.plan;
        (!plan.is_endless()).then(|| plan.end())
    }

    /// How far the run is, from 0 to 1: the nearest of all that can end it, which are the solutions that it looks for
    /// or its iterations, and its time. `None` if only the user ends it.
    fn share(&self, limit: Option<f64>) -> Option<f64> {
        let plan = &self.manifest.plan;
        let of_all = |done: u64, all: u64| (done as f64 / all.max(1) as f64).min(1.0);
        let by_iterations = || self.end().map(|end| of_all(self.done(), end));
        let by_plan = plan.enough().map(|wanted| of_all(self.distinct, wanted)).or_else(by_iterations);
        let by_time = limit.map(|left| self.speed.seconds / (self.speed.seconds + left));
        by_plan.into_iter().chain(by_time).max_by(f64::total_cmp)
    }

    /// Seconds that are left, if that can be told; `limit` are those until the run is stopped.
    fn seconds_left(&self, limit: Option<f64>) -> Option<f64> {
        let plan = &self.manifest.plan;
        let by_iterations = || self.end().and_then(|end| self.speed.seconds_left(end));
        let by_solutions = |wanted: u64| {
            let missing = wanted.saturating_sub(self.distinct) as f64;
            let is_known = self.speed.seconds >= SOON.0 && self.distinct > 0;
            is_known.then(|| self.speed.seconds * missing / self.distinct as f64)
        };
        let left = plan.enough().map_or_else(by_iterations, by_solutions);
        match (left, limit) {
            (Some(left), Some(limit)) => Some(left.min(limit)),
            (left, limit) => left.or(limit.filter(|_| self.speed.seconds >= SOON.0)),
        }
    }

    /// What is found, and how long it takes: at most 60 characters.
    fn in_short(&self, limit: Option<f64>) -> String {
        let plan = &self.manifest.plan;
        let counts = plan.counts_from() == 0 || self.done() >= plan.warmup;
        let found = match plan.enough() {
            _ if !counts => "warming up".to_owned(),
            Some(wanted) => format!("{} of {} found", grouped(self.distinct), grouped(wanted)),
            None => format!("{} found", grouped(self.distinct)),
        };
        let left = self.seconds_left(limit).map(|left| format!(", about {} left", in_words(left))).unwrap_or_default();
        let share = self.share(limit).map(|share| format!("{:3.0}%  ", (100.0 * share).floor())).unwrap_or_default();
        format!("{share}{found}{left}")
    }

    /// One line, with a bar if it is known how far the run is, for a terminal of 80 columns.
    pub(super) fn bar(&self, limit: Option<f64>) -> String {
        let Some(share) = self.share(limit) else { return self.in_short(limit) };
        let full = (BAR as f64 * share) as usize;
        format!("[{}{}] {}", "#".repeat(full), " ".repeat(BAR - full), self.in_short(limit))
    }

    /// One line for a file.
    pub(super) fn line(&self, limit: Option<f64>) -> String {
        self.in_short(limit).trim_start().to_owned()
    }

    /// Iterations, their rate, hits, and how well the run mixes, if that is known.
    pub(super) fn details(&self) -> Vec<String> {
        let (plan, done) = (&self.manifest.plan, self.done());
        // Iterations are counted in each chain, their rate is that of all chains together.
        let [each, all] = if self.chains.len() > 1 { [" of each chain", " in all chains"] } else { ["", ""] };
        let of_all = self.end().map(|end| format!(" of {}", grouped(end))).unwrap_or_default();
        let phase = if done < plan.warmup { " (warm-up)" } else { "" };
        let hits: u64 = self.chains.iter().map(|chain| chain.hits).sum();
        let iterations: u64 = self.chains.iter().map(|chain| chain.iterations).sum();
        let fresh =
            self.standing.restarts.map(|restarts| format!("  restarts {}", grouped(restarts))).unwrap_or_default();
        let mut lines = vec![
            format!("iteration {}{of_all}{each}{phase}  {}{all}", grouped(done), rate(self.speed.per_second)),
            format!("hits {}{fresh}", percent(hits as f64 / iterations as f64)),
        ];
        // A run that looks for solutions does not say how far averages over them can be trusted.
        let mixing = self.standing.mixing.as_ref().filter(|_| plan.enough().is_none());
        if let Some(Mixing { rhat, ess: (scarce, ess) }) = mixing {
            let rhat =
                rhat.as_ref().map(|(name, rhat)| format!("R-hat at most {rhat:.3} ({name})  ")).unwrap_or_default();
            lines.push(format!("outcomes: {rhat}ESS at least {} ({scarce})", rounded(*ess)));
        }
        lines
    }

    /// One column for each chain: its speed, its hits, and the share of each move that it accepts.
    pub(super) fn chain_lines(&self) -> Vec<String> {
        let first = self.manifest.chains().start as usize;
        let shown = self.chains.len().min(SHOWN_CHAINS);
        let row = |name: &str, cell: &dyn Fn(usize) -> String| -> Vec<String> {
            std::iter::once(name.to_owned()).chain((0..shown).map(cell)).collect()
        };
        let hits = |chain: usize| percent(self.chains[chain].hits as f64 / self.chains[chain].iterations as f64);
        let mut rows = vec![
            row("", &|chain| format!("chain {}", first + chain)),
            row("  iterations", &|chain| grouped(self.chains[chain].iterations)),
            row("  hits", &hits),
            vec!["  accepted:".to_owned()],
        ];
        rows.extend(self.manifest.moves.iter().enumerate().map(|(index, name)| {
            row(&format!("    {name}"), &|chain| {
                let count = self.standing.chains.get(chain).and_then(|(counts, _)| counts.get(index));
                let made = count.filter(|count| count.made() > 0);
                made.map_or_else(|| "-".to_owned(), |count| percent(count.acceptance()))
            })
        }));
        let mut lines: Vec<String> = lay_out(&rows).lines().map(str::to_owned).collect();
        if let Some(more) = self.chains.len().checked_sub(SHOWN_CHAINS).filter(|&more| more > 0) {
            lines.push(format!("  and {more} more chains"));
        }
        lines
    }

    /// The same for programs; what is not known is null.
    pub(super) fn json(&self, limit: Option<f64>) -> Value {
        let (moves, first) = (&self.manifest.moves, self.manifest.chains().start as usize);
        let chain = |(index, now): (usize, &ChainPulse)| {
            let before = self.standing.chains.get(index);
            json!({
                "chain": index + first,
                "iterations": now.iterations,
                "iterations_per_second": self.speed.per_second / self.chains.len() as f64,
                "hits": now.hits,
                "first_hit": before.and_then(|(_, hits)| hits.first),
                "acceptance": before.map(|(counts, _)| acceptance(moves, counts)),
            })
        };
        let mixing = self.standing.mixing.as_ref();
        json!({
            "event": "progress",
            "iteration": self.done(),
            "end": self.end(),
            "distinct": self.distinct,
            "iterations_per_second": self.speed.per_second,
            "eta_seconds": self.seconds_left(limit),
            "restarts": self.standing.restarts.unwrap_or(0),
            "max_rhat": mixing.and_then(|mixing| Some(mixing.rhat.as_ref()?.1)),
            "min_ess": mixing.map(|mixing| mixing.ess.1),
            "chains": self.chains.iter().enumerate().map(chain).collect::<Vec<_>>(),
        })
    }
}

/// Acceptance of each move, by name.
pub(crate) fn acceptance(moves: &[String], counts: &[MoveCounts]) -> Value {
    moves.iter().zip(counts).map(|(name, count)| (name.clone(), json!(count.acceptance()))).collect()
}
