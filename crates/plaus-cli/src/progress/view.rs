//! The progress of a run, in words and as JSON.

use super::Speed;
use crate::clock::in_words;
use crate::table::{grouped, lay_out, percent, rate, rounded};
use plaus_mcmc::{ChainPulse, Hits, MoveCounts, Progress};
use plaus_run::{Manifest, Mixing};
use serde_json::{Value, json};

/// Chains shown on a terminal; the others are summed up.
const SHOWN_CHAINS: usize = 8;

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

    /// How far the run is, what it has found, and how well it mixes, if that is known.
    pub(super) fn headlines(&self) -> Vec<String> {
        let (plan, done) = (&self.manifest.plan, self.done());
        let end = plan.end();
        // Iterations are counted in each chain, speed is that of all chains together.
        let [each, all] = if self.chains.len() > 1 { [" of each chain", " in all chains"] } else { ["", ""] };
        let phase = if done < plan.warmup { " (warm-up)" } else { "" };
        let sooner = if plan.enough().is_some() { ", or once enough are found" } else { "" };
        let left = self.speed.seconds_left(end).filter(|_| !plan.is_endless());
        let left = left.map(|left| format!("  ETA {}{sooner}", in_words(left))).unwrap_or_default();
        let [share, of_all] = match plan.is_endless() {
            true => [String::new(), String::new()],
            false => {
                [format!(" {:>3.0}%", (100.0 * done as f64 / end as f64).floor()), format!(" of {}", grouped(end))]
            }
        };
        let far = format!(
            "{}{share}  iteration {}{of_all}{each}{phase}  {}{all}{left}",
            self.manifest.scene,
            grouped(done),
            rate(self.speed.per_second),
        );
        let hits: u64 = self.chains.iter().map(|chain| chain.hits).sum();
        let iterations: u64 = self.chains.iter().map(|chain| chain.iterations).sum();
        let wanted = plan.enough().map(|wanted| format!(" of {}", grouped(wanted))).unwrap_or_default();
        let fresh =
            self.standing.restarts.map(|restarts| format!("  restarts {}", grouped(restarts))).unwrap_or_default();
        let hits = percent(hits as f64 / iterations as f64);
        // Without `--solutions`, distinct solutions are counted from the end of the warm-up.
        let distinct = match plan.solutions.is_none() && self.done() < plan.warmup {
            true => "(counted after the warm-up)".to_owned(),
            false => format!("{}{wanted}", grouped(self.distinct)),
        };
        let mut lines = vec![far, format!("hits {hits}  distinct {distinct}{fresh}")];
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

    /// The same for programs.
    pub(super) fn json(&self) -> Value {
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
            "end": self.manifest.plan.end(),
            "distinct": self.distinct,
            "iterations_per_second": self.speed.per_second,
            "eta_seconds": self.speed.seconds_left(self.manifest.plan.end()),
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
