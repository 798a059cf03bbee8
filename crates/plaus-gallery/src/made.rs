//! A page of a run.

use crate::features::{self, Features};
use crate::live::{Ends, Live, World};
use crate::{map, page, whole};
use plaus_mcmc::State;
use plaus_run::replay::replay_each_until;
use plaus_run::{Error, RunReader, SampleId, solutions};
use plaus_scenes::Until;
use std::convert::Infallible;

/// What to show.
#[derive(Debug, Clone)]
pub struct Options {
    /// Largest number of solutions on the page.
    pub count: usize,
    /// The run's folder, in the form that commands to copy show.
    pub run: String,
    /// Where each animation ends; `None` for what is usual in the scene: in bowling when it is decided which pins
    /// stand, else at rest.
    pub until: Option<Until>,
    /// Whether the page goes on sampling by itself.
    pub live: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { count: 64, run: "RUN".to_owned(), until: None, live: false }
    }
}

/// A page.
#[derive(Debug, Clone)]
pub struct Gallery {
    /// Its complete text.
    pub html: String,
    /// Number of solutions on it.
    pub shown: usize,
    /// Number of distinct solutions of the run.
    pub distinct: usize,
}

/// The beginning of every gallery: exports replace only files that begin with it.
pub const HEAD: &str = page::HEAD;

/// Makes a page of a run's distinct satisfying solutions.
///
/// # Errors
/// [`Error`] if no sample satisfies the constraint, or the run cannot be read.
pub fn gallery(run: &RunReader<'_>, options: &Options) -> Result<Gallery, Error> {
    let chosen = solutions::most_different(run, options.count)?;
    if chosen.distinct == 0 {
        return Err(Error::Request(
            "no sample of the run satisfies the constraint: there is nothing to show".to_owned(),
        ));
    }
    let ids: Vec<SampleId> = chosen.solutions.iter().map(|solution| solution.sample).collect();
    let until = options.until.unwrap_or_else(|| Ends::usual(&run.run().manifest().scene).into());
    let replays = replay_each_until(run, &ids, until, |replay| replay)?;
    let features = Features::of(replays.iter().map(|replay| features::Paths::of(&replay.animation)).collect());
    let maps = map::Maps { outcomes: map::of(&features.outcomes), paths: map::of(&features.paths) };
    let live = options.live.then(|| live_of(run, &ids, until)).transpose()?;
    let (distinct, candidates) = (chosen.distinct, chosen.compared);
    let packed = whole::pack(run, &replays, &maps, &whole::About { options, distinct, candidates, live, until });
    Ok(Gallery { html: page::html(run.run().manifest(), &packed), shown: replays.len(), distinct })
}

/// What a page needs to go on from a run, as text.
fn live_of(run: &RunReader<'_>, ids: &[SampleId], until: Until) -> Result<String, Error> {
    let manifest = run.run().manifest();
    if let Some(name) = &manifest.requirement {
        return Err(Error::Request(format!(
            "this run has a requirement, {name}, that its folder does not hold: so its page cannot go on sampling"
        )));
    }
    let draw = |&id: &SampleId| run.sample(id).map(|entry| entry.state.draw);
    let without = |state: State<_, _>| -> Result<State<_, ()>, Infallible> {
        let State { draw, log_prior, log_constraint, .. } = state;
        Ok(State { draw, outcome: (), log_prior, log_constraint })
    };
    let snapshots = run.chains().filter_map(|chain| run.snapshot(chain).cloned());
    let chains: Vec<_> =
        snapshots.map(|snapshot| snapshot.try_map(without).unwrap_or_else(|never| match never {})).collect();
    let in_words = |error: serde_json::Error| Error::Sampling(error.to_string());
    let live = Live {
        world: World::of(run.run().scenario()).map_err(Error::Request)?,
        plan: manifest.plan,
        independent: manifest.is_independent(),
        until: until.into(),
        chains: serde_json::to_value(chains).map_err(in_words)?,
        shown: ids.iter().map(draw).collect::<Result<_, _>>()?,
        known: Vec::new(),
    };
    serde_json::to_string(&live).map_err(in_words)
}
