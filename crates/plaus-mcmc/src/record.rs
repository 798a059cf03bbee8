//! What a chain leaves behind: recorded draws, run-length encoded, in blocks whose bounds follow from the plan.

use crate::moves::MoveId;
use crate::target::{SolutionClass, State};
use serde::{Deserialize, Serialize};

/// Consecutive recorded draws at the same state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Entry<D, O> {
    /// How many recorded draws in a row have this state; at least 1.
    pub draws: u64,
    /// Proposals accepted since the recorded draw before the first of these; 0 in an entry that continues the last
    /// block's state.
    pub accepted: u32,
    /// The move accepted last; `None` if none was, or if the state came from another rung after it.
    pub by: Option<MoveId>,
    /// Which class of solutions the state belongs to; `None` if it does not satisfy the constraint.
    pub class: Option<SolutionClass>,
    /// The state.
    pub state: State<D, O>,
}

/// The recorded draws of a stretch of iterations of one chain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Block<D, O> {
    /// First iteration the block covers.
    pub first_iteration: u64,
    /// One past the last iteration it covers.
    pub end_iteration: u64,
    /// Its recorded draws in order.
    pub entries: Vec<Entry<D, O>>,
}

impl<D: Clone, O: Clone> Block<D, O> {
    /// An empty block from `first_iteration` on.
    #[must_use]
    pub fn starting_at(first_iteration: u64) -> Self {
        Self { first_iteration, end_iteration: first_iteration, entries: Vec::new() }
    }

    /// Records one draw. `accepted` proposals were accepted since the draw before, the last by `by`.
    pub(crate) fn push(
        &mut self,
        accepted: u32,
        by: Option<MoveId>,
        class: Option<SolutionClass>,
        state: &State<D, O>,
    ) {
        match self.entries.last_mut() {
            Some(last) if accepted == 0 => last.draws += 1,
            _ => self.entries.push(Entry { draws: 1, accepted, by, class, state: state.clone() }),
        }
    }
}

impl<D, O> Block<D, O> {
    /// The same draws with other states, one for one.
    #[must_use]
    pub fn map<P>(self, mut look: impl FnMut(State<D, O>) -> State<D, P>) -> Block<D, P> {
        let Self { first_iteration, end_iteration, entries } = self;
        let entry = |Entry { draws, accepted, by, class, state }| {
            let state = look(state);
            Entry { draws, accepted, by, class, state }
        };
        Block { first_iteration, end_iteration, entries: entries.into_iter().map(entry).collect() }
    }
}

/// The iterations that are recorded: every `thin`-th from 0 on.
#[must_use]
pub(crate) fn is_recorded(iteration: u64, thin: u64) -> bool {
    iteration.is_multiple_of(thin)
}
