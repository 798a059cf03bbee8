//! One chain that goes on from a run's.

use super::{Found, Live, Outcome, in_words};
use plaus_mcmc::{
    Block, Control, Distinct, FirstOfClass, Goal, Independent, Mixture, MoveCounts, Plan, Progress, Pulse, Sink,
    Snapshot, Start, State, run_some,
};
use plaus_scenes::{AnyDraw, AnyScratch, Rules, Scene, Stage};
use std::convert::Infallible;

/// A chain of a page.
pub struct Sampler {
    stage: Stage,
    moves: Mixture<Stage>,
    rules: Rules,
    plan: Plan,
    chain: u32,
    /// Where it is; `None` before its first iteration.
    snapshot: Option<Snapshot<AnyDraw, Outcome>>,
    /// Solutions that it found, to tell clearly different ones from them.
    seen: Distinct,
}

impl Sampler {
    /// The chain of this number, which the run must not have. It begins with the state of one of the run's chains, with
    /// all that this has learnt, or at the beginning if the run has none; its random numbers are its own.
    ///
    /// # Errors
    /// In words, if the page's run cannot be gone on from.
    pub fn new(live: Live, chain: u32) -> Result<Self, String> {
        let Live { world, plan, independent, chains, mut known, .. } = live;
        let mut chains: Vec<Snapshot<AnyDraw, ()>> = serde_json::from_value(chains).map_err(in_words)?;
        let scenario = world.scenario().map_err(in_words)?;
        let stage = scenario.stage().map_err(in_words)?;
        let rules = scenario.sampler.rules;
        if chain < plan.chains {
            return Err(format!("the run has a chain {chain} already"));
        }
        let moves = match independent {
            true if known.is_empty() => Independent::mixture(),
            _ => stage.moves(&rules).map_err(in_words)?,
        };
        let plan = Plan { thin: 1, solutions: None, iterations: Plan::ENDLESS, ..plan };
        let number = (chain - plan.chains) as usize;
        let learnt = (!chains.is_empty()).then(|| chains.swap_remove(number % chains.len()));
        let mut sampler = Self { stage, moves, rules, plan, chain, snapshot: None, seen: Distinct::apart(1.0) };
        if !known.is_empty() {
            let draw = known.swap_remove(number % known.len());
            // What the run's chains have learnt is of use in the new scenario too, if it has the same moves.
            let fits = |one: &Snapshot<AnyDraw, ()>| one.counts.len() == sampler.moves.names().len();
            sampler.go_to(draw, learnt.filter(|one| !independent && plan.rungs == 1 && fits(one)))?;
            return Ok(sampler);
        }
        let evaluated = |state: State<AnyDraw, ()>| Found::of(chain, 0, &state).state(&sampler.stage);
        sampler.snapshot = learnt.map(|snapshot| snapshot.try_map(evaluated)).transpose()?;
        Ok(sampler)
    }

    /// Begins anew at a solution, as the chain of another number, with the scene's moves and nothing learnt.
    ///
    /// # Errors
    /// In words, if the draw cannot be simulated.
    pub fn begin_at(&mut self, draw: AnyDraw, chain: u32) -> Result<(), String> {
        self.moves = self.stage.moves(&self.rules).map_err(in_words)?;
        self.chain = chain;
        self.go_to(draw, None)
    }

    /// Goes on from a draw, after the warm-up, with what a chain without tempering has learnt, or with nothing learnt.
    fn go_to(&mut self, draw: AnyDraw, learnt: Option<Snapshot<AnyDraw, ()>>) -> Result<(), String> {
        let state = State::evaluate(&self.stage, draw, &mut AnyScratch::default()).map_err(in_words)?;
        let snapshot = match learnt {
            Some(snapshot) => snapshot.try_map(|_| Ok::<_, String>(state.clone()))?,
            None => {
                self.plan = Plan {
                    warmup: 0,
                    climbs: 0,
                    adapt: false,
                    weigh: false,
                    settle: false,
                    rungs: 1,
                    adapt_rungs: false,
                    ..self.plan
                };
                Snapshot {
                    end_iteration: 1,
                    state,
                    counts: vec![MoveCounts::default(); self.moves.names().len()],
                    scales: None,
                    failures: Default::default(),
                    hits: Default::default(),
                    pending: (0, None),
                    replicas: None,
                }
            }
        };
        self.snapshot = Some(Snapshot { hits: Default::default(), pending: (0, None), ..snapshot });
        Ok(())
    }

    /// Makes about so many iterations, at least one. Returns what it found that looks clearly different from all that
    /// it found before.
    ///
    /// # Errors
    /// In words, if the chain fails.
    pub fn advance(&mut self, iterations: u64) -> Result<Vec<Found>, String> {
        let plan = Plan { block: iterations.max(1), chains: self.chain + 1, ..self.plan };
        let start = |snapshot| Start { snapshot, distinct: Distinct::default() };
        let starts = self.snapshot.take().map(start).into_iter().collect();
        let mut once = Once { stage: &self.stage, seen: &mut self.seen, snapshot: None, found: Vec::new() };
        let chains = self.chain..self.chain + 1;
        run_some(&self.stage, &self.moves, plan, chains, starts, 1, &mut once, &Pulse::default()).map_err(in_words)?;
        let Once { snapshot, found, .. } = once;
        self.snapshot = snapshot;
        Ok(found)
    }

    /// How many iterations the chain has behind it, with those of the run's chain that it goes on from.
    #[must_use]
    pub fn iterations(&self) -> u64 {
        self.snapshot.as_ref().map_or(0, |snapshot| snapshot.end_iteration)
    }

    /// Where the chain is.
    #[must_use]
    pub fn state(&self) -> Option<Found> {
        let Snapshot { end_iteration, state, .. } = self.snapshot.as_ref()?;
        Some(Found::of(self.chain, end_iteration - 1, state))
    }
}

/// Takes one block, and ends.
struct Once<'a> {
    stage: &'a Stage,
    seen: &'a mut Distinct,
    snapshot: Option<Snapshot<AnyDraw, Outcome>>,
    found: Vec<Found>,
}

impl Sink<AnyDraw, Outcome> for Once<'_> {
    type Error = Infallible;

    fn block(
        &mut self,
        chain: u32,
        block: Block<AnyDraw, Outcome>,
        snapshot: &Snapshot<AnyDraw, Outcome>,
    ) -> Result<(), Infallible> {
        let mut iteration = block.first_iteration;
        for entry in &block.entries {
            if let Some(class) = entry.class {
                let (first, state) = (FirstOfClass { iteration, chain, class }, &entry.state);
                if self.seen.note_with(first, Some(|| self.stage.look(state.by_ref()))).is_some() {
                    self.found.push(Found::of(chain, iteration, state));
                }
            }
            iteration += entry.draws;
        }
        self.snapshot = Some(snapshot.clone());
        Ok(())
    }

    fn round(&mut self, _: &Progress<'_>) -> Result<Control, Infallible> {
        Ok(Control::Stop)
    }
}
