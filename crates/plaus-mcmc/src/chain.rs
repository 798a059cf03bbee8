//! One Markov chain: the accept step that leaves the target invariant.

use crate::adapt::{Adaptation, Scales};
pub(crate) use crate::counts::{Decision, MoveCounts};
use crate::failures::Failures;
use crate::moves::{At, Mixture, Move, MoveId, Proposal};
use crate::target::{ModelError, Simulated, State, StateOf, Target, at_most, most_of};
use crate::tempered::floor_seen;
use plaus_dist::{ChainStreams, LogDensity, LogPotential, LogRatio, Purpose, math, open_unit};

/// Start draws tried before giving up on finding one of positive probability.
const START_TRIES: u64 = 10_000;

/// Why a chain could not continue.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ChainError {
    /// No start draw had positive probability.
    #[error(
        "none of {START_TRIES} start draws has positive probability: {}",
        match failures.failed() {
            0 => "the constraint seems to forbid everything that the prior allows".to_owned(),
            _ => failures.to_string(),
        }
    )]
    NoStart {
        /// How many of them failed.
        failures: Box<Failures>,
    },
    /// The model failed.
    #[error("iteration {iteration}{}: {source}", .step.as_ref().map(|name| format!(", move `{name}`")).unwrap_or_default())]
    Model {
        /// The iteration being made; 0 is the start.
        iteration: u64,
        /// The move being made, if any.
        step: Option<String>,
        /// The model's error.
        source: ModelError,
    },
}

impl ChainError {
    /// Whether nothing failed, but a simulation was [`Interrupted`](crate::Interrupted).
    #[must_use]
    pub fn is_interruption(&self) -> bool {
        matches!(self, Self::Model { source, .. } if source.is_interruption())
    }

    /// The iteration that failed; 0 is the start.
    #[must_use]
    pub fn iteration(&self) -> u64 {
        match self {
            Self::NoStart { .. } => 0,
            Self::Model { iteration, .. } => *iteration,
        }
    }
}

/// One iteration, as reported to the caller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Step {
    /// The move made.
    pub move_id: MoveId,
    /// How it ended.
    pub decision: Decision,
}

/// A chain at one iteration. With the same streams, target, moves and inverse temperature, its future follows from
/// `iteration` and `state` alone; if it adapts scales, also from these.
pub struct Chain<'a, T: Target> {
    target: &'a T,
    moves: &'a Mixture<T>,
    streams: ChainStreams,
    /// The chain samples `p_w · p_c^β`; its states are those of the target for any β.
    beta: f64,
    iteration: u64,
    state: StateOf<T>,
    counts: Vec<MoveCounts>,
    /// Of this chain since it was made: [`Replicas`](crate::Replicas) add them up.
    failures: Failures,
    /// Its number among the replicas, for its failures.
    replica: u32,
    adaptation: Option<Adaptation<T>>,
    candidate: T::Draw,
    scratch: T::Scratch,
}

impl<'a, T: Target> Chain<'a, T> {
    /// A chain at iteration 0, at the first start draw of positive probability.
    ///
    /// # Errors
    /// [`ChainError::NoStart`] if there is none in 10,000 tries; [`ChainError::Model`] if the model fails.
    pub fn start(target: &'a T, moves: &'a Mixture<T>, streams: ChainStreams) -> Result<Self, ChainError> {
        let mut scratch = T::Scratch::default();
        let (mut stream, mut failures) = (streams.at(0, Purpose::START), Failures::default());
        for _ in 0..START_TRIES {
            let draw = target.start(&mut stream);
            let state = Self::state_of(target, draw, &mut scratch, (&mut failures, (0, 0)))
                .map_err(|source| ChainError::Model { iteration: 0, step: None, source })?;
            if let Some(state) = state {
                let counts = vec![MoveCounts::default(); moves.names().len()];
                return Ok(Self { failures, ..Self::resume(target, moves, streams, 0, state, counts) });
            }
        }
        Err(ChainError::NoStart { failures: Box::new(failures) })
    }

    /// Makes one iteration that puts the first start draw of positive probability in place of the state. This leaves
    /// nothing invariant: it is for searching, not for sampling. If 10,000 tries find none, it keeps its state, and
    /// returns false.
    ///
    /// # Errors
    /// [`ChainError::Model`] if the model fails.
    pub(crate) fn begin_anew(&mut self) -> Result<bool, ChainError> {
        let next = self.iteration + 1;
        let mut stream = self.streams.at(next, Purpose::START);
        // It knows nothing of the state that ends, as after a resume.
        self.scratch = T::Scratch::default();
        for _ in 0..START_TRIES {
            let draw = self.target.start(&mut stream);
            let since = (next, self.replica);
            let state = Self::state_of(self.target, draw, &mut self.scratch, (&mut self.failures, since));
            let state = state.map_err(|source| ChainError::Model { iteration: next, step: None, source })?;
            if let Some(state) = state {
                (self.state, self.iteration, self.scratch) = (state, next, T::Scratch::default());
                self.adaptation.iter_mut().for_each(Adaptation::forget_state);
                return Ok(true);
            }
        }
        self.iteration = next;
        Ok(false)
    }

    /// The state of a draw of positive probability; the prior is asked first.
    fn state_of(
        target: &T,
        draw: T::Draw,
        scratch: &mut T::Scratch,
        (failures, since): (&mut Failures, (u64, u32)),
    ) -> Result<Option<StateOf<T>>, ModelError> {
        let log_prior = target.log_prior(&draw)?;
        if log_prior.is_zero() {
            return Ok(None);
        }
        let state = State::simulate(target, draw, log_prior, scratch)?;
        failures.note(since, target.failure(&state.outcome));
        Ok(Some(state).filter(|state| !state.log_p().is_zero()))
    }

    /// A chain that continues from a state that it, or an equal chain, had at `iteration`. `counts` has one entry for
    /// each move.
    #[must_use]
    pub fn resume(
        target: &'a T,
        moves: &'a Mixture<T>,
        streams: ChainStreams,
        iteration: u64,
        state: StateOf<T>,
        counts: Vec<MoveCounts>,
    ) -> Self {
        Self {
            target,
            moves,
            streams,
            beta: 1.0,
            iteration,
            candidate: state.draw.clone(),
            state,
            counts,
            failures: Failures::default(),
            replica: 0,
            adaptation: None,
            scratch: T::Scratch::default(),
        }
    }

    /// The same chain as this one of several replicas.
    #[must_use]
    pub(crate) fn with_replica(mut self, replica: usize) -> Self {
        self.replica = replica as u32;
        self.failures.move_to(self.replica);
        self
    }

    /// The draws that it has simulated since it was made, by [`start`](Self::start) or [`resume`](Self::resume), and
    /// which of them failed.
    #[must_use]
    pub fn failures(&self) -> &Failures {
        &self.failures
    }

    /// The same chain, adapting the scales of its moves in the iterations before `until`, and keeping them from then
    /// on. If `until` is below 2, there is no such iteration, and moves stay as configured. To be called on a chain
    /// that has just started.
    #[must_use]
    pub fn adapting(self, until: u64) -> Self {
        Self { adaptation: Adaptation::start(self.moves, until, false), ..self }
    }

    /// The same, which also learns how often to make each move, see [`crate::weigh`].
    #[must_use]
    pub fn weighing(self, until: u64) -> Self {
        Self { adaptation: Adaptation::start(self.moves, until, true), ..self }
    }

    /// Whether everything that it adapts has settled.
    pub(crate) fn has_settled(&self) -> bool {
        let adaptation = self.adaptation.as_ref();
        adaptation.is_none_or(|adaptation| adaptation.scales().have_settled(self.moves, self.iteration + 1))
    }

    /// Ends its adaptation before its time.
    pub(crate) fn freeze(&mut self) {
        let until = self.iteration + 1;
        if let Some(adaptation) = self.adaptation.as_mut().filter(|adaptation| !adaptation.scales().are_frozen()) {
            adaptation.freeze(self.moves, until);
        }
    }

    /// Stands still up to this iteration.
    pub(crate) fn rest_until(&mut self, iteration: u64) {
        self.iteration = iteration;
    }

    /// The same chain, continuing with the scales that it had; they must [fit](Scales::fit) its moves.
    #[must_use]
    pub fn with_scales(self, scales: Scales) -> Self {
        Self { adaptation: Some(Adaptation::resume(self.moves, scales)), ..self }
    }

    /// Its present scales; `None` if it adapts none.
    #[must_use]
    pub fn scales(&self) -> Option<&Scales> {
        self.adaptation.as_ref().map(Adaptation::scales)
    }

    /// The same chain at another inverse temperature, at least 0.
    #[must_use]
    pub(crate) fn at(self, beta: f64) -> Self {
        Self { beta, ..self }
    }

    /// Changes the inverse temperature.
    pub(crate) fn set_beta(&mut self, beta: f64) {
        self.beta = beta;
    }

    /// The current state.
    #[must_use]
    pub fn state(&self) -> &StateOf<T> {
        &self.state
    }

    /// Number of iterations that led to the current state.
    #[must_use]
    pub fn iteration(&self) -> u64 {
        self.iteration
    }

    /// How often each move ended in each way, in order of [`MoveId`].
    #[must_use]
    pub fn counts(&self) -> &[MoveCounts] {
        &self.counts
    }

    /// Makes one iteration: choose a move, propose, evaluate in order of cost, accept or reject.
    ///
    /// # Errors
    ///
    /// [`ChainError::Model`] if the model fails; the state is then still the previous one.
    pub fn step(&mut self) -> Result<Step, ChainError> {
        let (next, moves) = (self.iteration + 1, self.moves);
        let mut stream = self.streams.at(next, Purpose::PROPOSE);
        let learnt = self.adaptation.as_ref().and_then(Adaptation::cumulative);
        let (move_id, configured) = match learnt {
            Some(cumulative) => moves.choose_by(cumulative, &mut stream),
            None => moves.choose(&mut stream),
        };
        let fail = |source| ChainError::Model { iteration: next, step: Some(configured.name().to_owned()), source };
        let begun = self.begin_to_count(next).map_err(fail)?;
        self.candidate.clone_from(&self.state.draw);
        let kernel = kernel(moves, self.adaptation.as_ref(), move_id);
        let at = At::new(self.target, &self.state);
        let proposal = kernel.propose(at, &mut self.candidate, &mut stream).map_err(fail)?;
        let decision = self.judge(next, move_id, proposal).map_err(fail)?;
        self.iteration = next;
        self.counts[usize::from(move_id.0)].count(decision);
        if let Some(adaptation) = &mut self.adaptation {
            let work = begun.map(|begun| self.target.work() - begun);
            adaptation.look(moves, next, self.target, self.state.by_ref());
            let accepted = decision == Decision::Accepted;
            adaptation.weigh(next, (move_id, accepted), work, (self.target, self.state.by_ref()));
            adaptation.learn(moves, next, (move_id, proposal.path()), accepted);
        }
        Ok(Step { move_id, decision })
    }

    /// The work done so far, if the work of iteration `next` is to be counted. The work of an iteration must follow
    /// from the state alone, whatever the scratch memory holds. So the memory is first made anew, by simulating the
    /// state.
    fn begin_to_count(&mut self, next: u64) -> Result<Option<u64>, ModelError> {
        if !self.adaptation.as_ref().is_some_and(|adaptation| adaptation.counts_work(next)) {
            return Ok(None);
        }
        self.scratch = T::Scratch::default();
        self.target.simulate(&self.state.draw, None, LogPotential::ZERO, &mut self.scratch)?;
        self.target.decided(true, &mut self.scratch);
        Ok(Some(self.target.work()))
    }

    /// The accept step of Metropolis and Hastings, solved for the constraint: with u uniform and drawn first, `ln u <
    /// log α` means that the candidate's log constraint exceeds a floor known before the simulation. Rounding is
    /// monotone, so a bound on the constraint at or below the floor decides exactly as the whole simulation would.
    fn judge(&mut self, next: u64, move_id: MoveId, proposal: Proposal) -> Result<Decision, ModelError> {
        let (log_ratio, path, later) = match proposal {
            Proposal::Stay => return Ok(Decision::Stayed),
            Proposal::Anew => return self.judge_anew(next),
            Proposal::Candidate { log_ratio, path, later } => (log_ratio, path, later),
        };
        let log_prior = self.target.log_prior(&self.candidate)?;
        let ln_u = math::ln(open_unit(&mut self.streams.at(next, Purpose::ACCEPT)));
        let log_p = self.state.log_prior + self.state.log_constraint.tempered(self.beta)?;
        let most = log_ratio.times(later.unwrap_or(LogRatio::ONE))?;
        let Some(floor) = floor(ln_u, most, log_p, log_prior)? else { return Ok(Decision::RejectedByPrior) };
        let Some(seen) = floor_seen(floor, self.beta) else { return Ok(Decision::RejectedEarly) };
        let Some(outcome) = self.simulated(next, seen)? else { return Ok(Decision::RejectedEarly) };
        let log_constraint = self.target.log_constraint(&outcome)?;
        let accepted = if later.is_none() {
            self.accept_above(floor, outcome, log_prior, log_constraint)?
        } else {
            let candidate = State { draw: self.candidate.clone(), outcome, log_prior, log_constraint };
            let kernel = kernel(self.moves, self.adaptation.as_ref(), move_id);
            let after = kernel.log_ratio_after(At::new(self.target, &self.state).to(candidate.by_ref(), path))?;
            match self::floor(ln_u, log_ratio.times(after)?, log_p, log_prior)? {
                Some(floor) => self.accept_above(floor, candidate.outcome, log_prior, log_constraint)?,
                None => false,
            }
        };
        self.target.decided(accepted, &mut self.scratch);
        Ok(if accepted { Decision::Accepted } else { Decision::Rejected })
    }

    /// The candidate's outcome; `None` if its constraint cannot exceed `floor`. In that case the target is told, unless
    /// no outcome at all could do so: then nothing is simulated.
    fn simulated(&mut self, next: u64, floor: LogPotential) -> Result<Option<T::Outcome>, ModelError> {
        if self.target.most().is_some_and(|most| most <= floor) {
            return Ok(None);
        }
        let simulated = self.target.simulate(&self.candidate, Some(self.state.by_ref()), floor, &mut self.scratch)?;
        let Simulated::Complete(outcome) = simulated else {
            self.failures.note((next, self.replica), None);
            self.target.decided(false, &mut self.scratch);
            return Ok(None);
        };
        self.failures.note((next, self.replica), self.target.failure(&outcome));
        Ok(Some(outcome))
    }

    /// The accept step of rejection: a draw from the prior is kept with probability `(p_c / M)^β`, whatever the current
    /// state. The flow from a to b, `p_w(a) p_c(a)^β · p_w(b) (p_c(b) / M)^β`, equals that from b to a.
    fn judge_anew(&mut self, next: u64) -> Result<Decision, ModelError> {
        let log_prior = self.target.log_prior(&self.candidate)?;
        if log_prior.is_zero() {
            return Ok(Decision::RejectedByPrior);
        }
        let most = most_of(self.target)?;
        let ln_u = math::ln(open_unit(&mut self.streams.at(next, Purpose::ACCEPT)));
        let floor = LogPotential::new(ln_u + most.tempered(self.beta)?.value())?;
        let Some(seen) = floor_seen(floor, self.beta) else { return Ok(Decision::RejectedEarly) };
        let Some(outcome) = self.simulated(next, seen)? else { return Ok(Decision::RejectedEarly) };
        let log_constraint = at_most(self.target.log_constraint(&outcome)?, most)?;
        let accepted = self.accept_above(floor, outcome, log_prior, log_constraint)?;
        self.target.decided(accepted, &mut self.scratch);
        Ok(if accepted { Decision::Accepted } else { Decision::Rejected })
    }

    /// Exchanges the goals of two chains, which are their inverse temperatures, moves, scales and counts. Each keeps
    /// its state, memory and streams.
    pub(crate) fn exchange_rungs(a: &mut Self, b: &mut Self) {
        std::mem::swap(&mut a.beta, &mut b.beta);
        std::mem::swap(&mut a.moves, &mut b.moves);
        std::mem::swap(&mut a.counts, &mut b.counts);
        std::mem::swap(&mut a.adaptation, &mut b.adaptation);
        [a, b].into_iter().filter_map(|chain| chain.adaptation.as_mut()).for_each(Adaptation::forget_state);
    }

    fn accept_above(
        &mut self,
        floor: LogPotential,
        outcome: T::Outcome,
        log_prior: LogDensity,
        log_constraint: LogPotential,
    ) -> Result<bool, ModelError> {
        let accepted = log_constraint.tempered(self.beta)? > floor;
        if accepted {
            std::mem::swap(&mut self.state.draw, &mut self.candidate);
            self.state.outcome = outcome;
            self.state.log_prior = log_prior;
            self.state.log_constraint = log_constraint;
        }
        Ok(accepted)
    }
}

/// A move, with its scale if that is adapted.
fn kernel<'k, T: Target>(moves: &'k Mixture<T>, adaptation: Option<&'k Adaptation<T>>, id: MoveId) -> &'k dyn Move<T> {
    adaptation.and_then(|adaptation| adaptation.kernel(id)).unwrap_or_else(|| moves.get(id).1)
}

/// What the candidate's log constraint must exceed: `ln u − log ratio + log p(current) − log p_w(candidate)`. `None` if
/// no constraint is enough, because the candidate is impossible or could not be undone.
fn floor(
    ln_u: f64,
    log_ratio: LogRatio,
    log_p: LogPotential,
    log_prior: LogDensity,
) -> Result<Option<LogPotential>, ModelError> {
    if log_prior.is_zero() || log_ratio == LogRatio::ZERO {
        return Ok(None);
    }
    Ok(Some(LogPotential::new(ln_u - log_ratio.value() + log_p.value() - log_prior.value())?))
}
