//! Moves whose proposals can be listed, and a check that `propose` agrees with the list.

use super::laws::{LogP, multinomial};
use super::ratios::compare;
use super::{CheckError, TRY};
use crate::moves::{At, Move, Path, Proposal};
use crate::target::{ModelError, StateOf, StateRefOf, Target};
use plaus_dist::Seed;

/// One way in which a move may leave a state.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch<D> {
    /// The candidate; `None` if the move has nothing to change.
    pub draw: Option<D>,
    /// Its probability, in [0, 1].
    pub probability: f64,
    /// Its path. Without meaning if the move stays.
    pub path: Path,
}

/// A move on a toy world small enough that all its proposals from a state can be listed. Write the list from what the
/// move is meant to do, not by calling [`Move::propose`]: the check compares the two.
pub trait Enumerable<T: Target>: Move<T> {
    /// All ways from `state`. Their probabilities add up to 1; the same candidate may come more than once.
    ///
    /// # Errors
    /// [`ModelError`] if the model fails.
    fn branches(&self, target: &T, state: StateRefOf<'_, T>) -> Result<Vec<Branch<T::Draw>>, ModelError>;
}

/// How the proposals of a move compare with its list.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frequencies {
    /// p-value of the state whose proposals deviate most, corrected for the number of states.
    pub p: LogP,
    /// That state.
    pub state: Option<usize>,
    /// Largest difference between the ratio an accept step uses and [`Move::log_ratio`], in nats.
    pub gap: f64,
    /// The state it was found at.
    pub gap_state: Option<usize>,
}

/// A branch that leads to a listed state, or nowhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Way {
    /// Index of the candidate; `None` if the move stays, or leads to a candidate of prior density 0.
    pub(super) to: Option<usize>,
    pub(super) probability: f64,
    pub(super) path: Path,
}

/// Makes `tries` proposals from `states[from]` and compares them with its `branches`, each of which has its `way`.
fn frequencies_from<T: Target>(
    target: &T,
    kernel: &dyn Enumerable<T>,
    states: &[StateOf<T>],
    from: usize,
    ways: &[Way],
    (seed, tries): (Seed, u64),
) -> Result<(LogP, f64), ModelError> {
    let state = &states[from];
    let branches = kernel.branches(target, state.by_ref())?;
    let streams = seed.chain(from as u64);
    // Branches that cannot be distinguished share the cell of the first of them.
    let alike = |a: &Branch<T::Draw>, b: &Branch<T::Draw>| a.draw == b.draw && (a.draw.is_none() || a.path == b.path);
    let cell_of = |seen: &Branch<T::Draw>| branches.iter().position(|branch| alike(branch, seen));
    let mut cells = vec![(0_u64, 0.0); branches.len() + 1];
    for branch in &branches {
        cells[cell_of(branch).unwrap_or(branches.len())].1 += branch.probability;
    }
    let mut gap = 0.0_f64;
    let mut candidate = state.draw.clone();
    for index in 0..tries {
        candidate.clone_from(&state.draw);
        let proposal = kernel.propose(At::new(target, state), &mut candidate, &mut streams.at(index, TRY))?;
        let seen = match proposal {
            Proposal::Stay => Branch { draw: None, probability: 0.0, path: Path(0) },
            Proposal::Anew => Branch { draw: Some(candidate.clone()), probability: 0.0, path: Path(0) },
            Proposal::Candidate { path, .. } => Branch { draw: Some(candidate.clone()), probability: 0.0, path },
        };
        let cell = cell_of(&seen).unwrap_or(branches.len());
        cells[cell].0 += 1;
        if let Proposal::Candidate { log_ratio, path, later } = proposal
            && let Some(to) = ways.get(cell).and_then(|way| way.to)
        {
            let ratios = compare(target, kernel, (state, &states[to]), path, (log_ratio, later))?;
            let (used, forth) = (ratios.used.value(), ratios.forth.value());
            gap = gap.max(if used == forth { 0.0 } else { (used - forth).abs() });
        }
    }
    Ok((multinomial(&cells), gap))
}

/// [`frequencies_from`] every state of positive density.
pub(super) fn frequencies<T: Target>(
    target: &T,
    kernel: &dyn Enumerable<T>,
    states: &[StateOf<T>],
    ways: &[Vec<Way>],
    (seed, tries): (Seed, u64),
) -> Result<Frequencies, CheckError> {
    let mut found = Frequencies { p: LogP::ONE, state: None, gap: 0.0, gap_state: None };
    let possible = (0..states.len()).filter(|&from| !states[from].log_p().is_zero());
    for from in possible.clone() {
        let (p, gap) = frequencies_from(target, kernel, states, from, &ways[from], (seed, tries))
            .map_err(CheckError::model(from as u64))?;
        if p < found.p {
            (found.p, found.state) = (p, Some(from));
        }
        if gap > found.gap {
            (found.gap, found.gap_state) = (gap, Some(from));
        }
    }
    found.p = found.p.of_smallest_among(possible.count());
    Ok(found)
}
