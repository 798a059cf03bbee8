//! How a run's draws are made: by chains or as independent draws of the prior, and the trial that finds out which pays.
//!
//! A trial is a function of scenario and seed alone: it counts simulations and looks at no clock. So every piece of a
//! run, and the run that is begun anew, finds the same; what it found lies in the manifest.

use crate::diagnosis::worth_of;
use crate::error::Error;
use crate::manifest::Recipe;
use plaus_dist::Seed;
use plaus_mcmc::{
    Block, Control, Independent, Mixture, MoveCounts, Plan, Progress, Pulse, Sink, Snapshot, Tried, run_watched,
    try_draws,
};
use plaus_scenes::scenario::Method;
use plaus_scenes::{ConfigError, Role, Rules, Scenario, Scene};
use serde::{Deserialize, Serialize};

/// Draws of the prior between two looks at what they come to.
const AT_A_TIME: u64 = 32;
/// Most draws of the prior in a trial, and the fewest that it may stop at where there are no solutions.
const DRAWS: [u64; 2] = [512, 64];
/// Solutions that a trial looks for: their number is then known to a half.
const ENOUGH: f64 = 4.0;
/// Where the prior needs fewer draws than this for a solution, no chain is tried. Of the scenes that come with plaus no
/// chain was measured to make an independent solution in fewer than 60 iterations.
const FEW: f64 = 40.0;
/// The same of who looks for some solutions only: they end before a chain would have been tried.
const FEW_FOR_SOME: f64 = 100.0;
/// Independent solutions that the prior would make in as many simulations as a trial gives to chains after their
/// warm-up. Chains that never get anywhere seem to make one or two each.
const RIVAL: f64 = 12.0;
/// Chains of a trial.
const CHAINS: u32 = 4;
/// The part of the run's iterations that the trial of chains may take.
const SHARE: f64 = 0.1;

/// How draws are made, and why so.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Way {
    /// Whether they are independent draws of the prior, kept by rejection; else chains make them.
    pub independent: bool,
    /// Why, in words.
    pub why: String,
}

impl Way {
    /// What a scenario says itself; `None` where it says nothing, or leaves it to a trial.
    #[must_use]
    pub fn said(scenario: &Scenario) -> Option<Self> {
        let why = || "as the scenario says".to_owned();
        match scenario.sampler.method? {
            Method::Chain => Some(Self { independent: false, why: why() }),
            Method::Independent => Some(Self { independent: true, why: why() }),
            Method::Auto => None,
        }
    }
}

/// Whether draws are independent ones.
pub(crate) fn is_independent(way: Option<&Way>) -> bool {
    way.is_some_and(|way| way.independent)
}

/// The moves of chains that make draws this way.
pub(crate) fn moves_of<S: Scene>(scene: &S, rules: &Rules, way: Option<&Way>) -> Result<Mixture<S>, ConfigError> {
    if is_independent(way) { Ok(Independent::mixture()) } else { scene.moves(rules) }
}

/// Finds out by a trial, on the current pool of threads.
///
/// # Errors
/// [`Error`] where the model fails, or `pulse` was stopped.
pub(crate) fn tried<S: Scene>(recipe: &Recipe, scene: &S, pulse: &Pulse) -> Result<Way, Error> {
    let plan = recipe.plan();
    let total = plan.end().saturating_mul(u64::from(plan.chains));
    let most = (total / 50).clamp(DRAWS[1], DRAWS[0]);
    let mut found = Tried::default();
    while found.draws < most && found.kept < ENOUGH {
        go_on(pulse)?;
        let made = try_draws(scene, plan.seed, found.draws..found.draws + AT_A_TIME.min(most - found.draws));
        found = found.and(made.map_err(|error| Error::Sampling(error.to_string()))?);
    }
    let Tried { draws, hits, kept } = found;
    let one_in = draws as f64 / kept;
    let seen = format!("{hits} of {draws} draws of the prior are solutions");
    let kept_words = format!("{seen}, and one in {one_in:.0} draws makes one that counts");
    let because = |independent, why: String| Ok(Way { independent, why });
    if hits == 0 {
        return because(false, format!("none of {draws} draws of the prior is a solution"));
    }
    if one_in <= if plan.solutions.is_some() { FEW_FOR_SOME } else { FEW } {
        return because(true, format!("{kept_words}, fewer than the iterations that chains are known to need"));
    }
    let iterations = (RIVAL * one_in / f64::from(CHAINS)).ceil();
    if plan.solutions.is_some() || 2.0 * iterations * f64::from(CHAINS) > SHARE * total as f64 {
        return because(false, format!("{kept_words}: too few to try whether chains need as many iterations"));
    }
    let rival = Trial::of(scene, recipe, iterations as u64, pulse)?;
    let each = rival.simulations / rival.independent;
    let of_chains = if each.is_finite() { format!("{each:.0} simulations") } else { "more than were tried".into() };
    because(one_in <= each, format!("{kept_words}, while a trial of chains needed {of_chains} for one"))
}

fn go_on(pulse: &Pulse) -> Result<(), Error> {
    let message = "stopped while it was tried how draws are best made, so nothing was written";
    if pulse.is_stopped() { Err(Error::Request(message.to_owned())) } else { Ok(()) }
}

/// What chains came to in a trial.
struct Trial {
    /// Independent solutions.
    independent: f64,
    /// Simulations that they took.
    simulations: f64,
}

impl Trial {
    /// Runs chains for a warm-up of `iterations`, and as many that count.
    fn of<S: Scene>(scene: &S, recipe: &Recipe, iterations: u64, pulse: &Pulse) -> Result<Self, Error> {
        let own = recipe.plan();
        // No run has a seed of 2⁶³ or more, so none has these chains.
        let (seed, block) = (Seed(!own.seed.0), 256);
        let plan =
            Plan { seed, chains: CHAINS, warmup: iterations, iterations, thin: 1, block, solutions: None, ..own };
        let moves = scene.moves(&recipe.scenario.sampler.rules)?;
        let mut seen = Seen::new(scene, iterations);
        let stop = Stopper { pulse, seen: &mut seen };
        run_watched(scene, &moves, plan, Vec::new(), rayon::current_num_threads(), &mut { stop }, &Pulse::default())
            .map_err(|error| Error::Sampling(error.to_string()))?;
        go_on(pulse)?;
        let counts = seen.counts;
        let simulated = counts.made() - counts.stayed - counts.rejected_by_prior;
        let share = simulated as f64 / counts.made().max(1) as f64;
        let all = iterations as f64 * f64::from(CHAINS);
        let fewest = seen.columns.iter().filter_map(|chains| worth_of(chains, &seen.satisfied)).reduce(f64::min);
        Ok(Self { independent: fewest.unwrap_or(0.0), simulations: all * share })
    }
}

/// What is looked at of a trial's chains after their warm-up.
struct Seen<'a, S: Scene> {
    scene: &'a S,
    from: u64,
    /// Numbers of the variables of the draw among the scalars.
    variables: Vec<usize>,
    scalars: Vec<f64>,
    /// Per variable, per chain, per draw.
    columns: Vec<Vec<Vec<f64>>>,
    satisfied: Vec<Vec<bool>>,
    counts: MoveCounts,
}

impl<'a, S: Scene> Seen<'a, S> {
    fn new(scene: &'a S, from: u64) -> Self {
        let all = scene.scalars();
        let variables: Vec<usize> = (0..all.len()).filter(|&number| all[number].role == Role::Draw).collect();
        let columns = vec![vec![Vec::new(); CHAINS as usize]; variables.len()];
        let satisfied = vec![Vec::new(); CHAINS as usize];
        Self { scene, from, scalars: vec![0.0; all.len()], variables, columns, satisfied, counts: MoveCounts::default() }
    }
}

/// Looks at a trial, and stops it with the run that it is for.
struct Stopper<'a, 'b, S: Scene> {
    pulse: &'a Pulse,
    seen: &'a mut Seen<'b, S>,
}

impl<S: Scene> Sink<S::Draw, S::Outcome> for Stopper<'_, '_, S> {
    type Error = std::convert::Infallible;

    fn block(
        &mut self,
        chain: u32,
        block: Block<S::Draw, S::Outcome>,
        _: &Snapshot<S::Draw, S::Outcome>,
    ) -> Result<(), Self::Error> {
        let (seen, chain, mut next) = (&mut *self.seen, chain as usize, block.first_iteration);
        for entry in &block.entries {
            next += entry.draws;
            let times = (next.saturating_sub(seen.from)).min(entry.draws) as usize;
            if times == 0 {
                continue;
            }
            seen.scene.write_scalars(&entry.state, &mut seen.scalars);
            for (&number, chains) in seen.variables.iter().zip(&mut seen.columns) {
                chains[chain].extend(std::iter::repeat_n(seen.scalars[number], times));
            }
            seen.satisfied[chain].extend(std::iter::repeat_n(entry.class.is_some(), times));
        }
        Ok(())
    }

    fn round(&mut self, progress: &Progress<'_>) -> Result<Control, Self::Error> {
        self.seen.counts = MoveCounts::default();
        let counts = progress.chains.iter().flat_map(|(counts, _)| counts.iter());
        counts.for_each(|one| self.seen.counts.add(one));
        Ok(if self.pulse.is_stopped() { Control::Stop } else { Control::Continue })
    }
}
