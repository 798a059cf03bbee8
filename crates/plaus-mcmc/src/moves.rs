//! Moves, which propose candidates and answer for their own Hastings ratios; and mixtures, which choose among moves.

use crate::fit::Fit;
use crate::scale::Scale;
use crate::target::{ModelError, StateOf, StateRefOf, Target};
use plaus_dist::{LogRatio, Stream, open_unit};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Which of a move's ways led to a candidate (which coordinate, which pair, …), if that matters for the ratio.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Path(pub u64);

/// What a move proposed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Proposal {
    /// There is nothing to change: the chain stays, and the iteration counts.
    Stay,
    /// The candidate buffer holds a proposal.
    Candidate {
        /// `log q(current | candidate) − log q(candidate | current)` along `path`, as far as it is known without the
        /// candidate's outcome.
        log_ratio: LogRatio,
        /// The way it was made.
        path: Path,
        /// For a move whose ratio needs the candidate's outcome: an upper bound of [`Move::log_ratio_after`]. `None`:
        /// nothing is missing.
        later: Option<LogRatio>,
    },
    /// The candidate buffer holds a draw from the prior that does not depend on the current one. Whatever the current
    /// state, it is accepted with probability `p_c / M`, where `M` is [`Target::most`]. So an accepted draw is an
    /// independent draw of the target, exact by rejection.
    Anew,
}

impl Proposal {
    /// A proposal as likely as its reverse.
    pub const SYMMETRIC: Self = Self::Candidate { log_ratio: LogRatio::ONE, path: Path(0), later: None };

    /// A proposal with a ratio, for a move with only one way.
    #[must_use]
    pub fn with_ratio(log_ratio: LogRatio) -> Self {
        Self::Candidate { log_ratio, path: Path(0), later: None }
    }

    /// The way in which a candidate was made; `None` if there is no candidate, or none that came from the current
    /// state.
    #[must_use]
    pub fn path(self) -> Option<Path> {
        match self {
            Self::Stay | Self::Anew => None,
            Self::Candidate { path, .. } => Some(path),
        }
    }
}

/// Where a move starts: a target and the chain's current state.
pub struct At<'a, T: Target> {
    /// What is sampled.
    pub target: &'a T,
    /// The current state.
    pub state: StateRefOf<'a, T>,
}

impl<T: Target> Clone for At<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: Target> Copy for At<'_, T> {}

impl<'a, T: Target> At<'a, T> {
    /// A state of a target.
    pub fn new(target: &'a T, state: &'a StateOf<T>) -> Self {
        Self { target, state: state.by_ref() }
    }

    /// The step from here to another state, along `path`.
    pub fn to(self, to: StateRefOf<'a, T>, path: Path) -> Transition<'a, T> {
        Transition { target: self.target, from: self.state, to, path }
    }
}

/// Two states, and the way a move led from one to the other.
pub struct Transition<'a, T: Target> {
    /// What is sampled.
    pub target: &'a T,
    /// The state that the move started from.
    pub from: StateRefOf<'a, T>,
    /// The state that it led to.
    pub to: StateRefOf<'a, T>,
    /// The way.
    pub path: Path,
}

impl<T: Target> Clone for Transition<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: Target> Copy for Transition<'_, T> {}

impl<T: Target> Transition<'_, T> {
    /// The step back, along `path`.
    #[must_use]
    pub fn back(self, path: Path) -> Self {
        Self { from: self.to, to: self.from, path, ..self }
    }
}

/// A proposal kernel. How a [`Path`] is chosen must not depend on the state, unless the ratio accounts for it; the
/// ratio compares `q` along one given path.
pub trait Move<T: Target>: Send + Sync {
    /// A short name for statistics and scenario files, e.g. `redraw`.
    fn name(&self) -> &str;

    /// Changes `candidate`, which comes in as a copy of the current draw, into a proposal.
    ///
    /// # Errors
    /// [`ModelError`] if a density is not a number.
    fn propose(&self, at: At<'_, T>, candidate: &mut T::Draw, stream: &mut Stream) -> Result<Proposal, ModelError>;

    /// The whole `log q(from | to) − log q(to | from)` along `path`. The chain does not call it; the checks of
    /// [`crate::check`] compare it with what `propose` returned and with the reverse direction.
    ///
    /// # Errors
    /// [`ModelError`] if a density is not a number.
    fn log_ratio(&self, step: Transition<'_, T>) -> Result<LogRatio, ModelError>;

    /// The path that leads back; for most moves, the same path.
    fn reverse(&self, path: Path) -> Path {
        path
    }

    /// The part of the ratio that needs the candidate's outcome; called only if `propose` announced it.
    ///
    /// # Errors
    /// [`ModelError`] if a density is not a number.
    fn log_ratio_after(&self, _step: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }

    /// The scales that a chain may adapt in its warm-up, see [`crate::adapt`]; none unless a move says so.
    fn scales(&self) -> Vec<Scale> {
        Vec::new()
    }

    /// The same move with other values of its [`Move::scales`], one for each; `None` leaves a scale as configured. A
    /// move with scales must return one.
    fn at_scales(&self, _values: &[Option<f64>]) -> Option<Box<dyn Move<T>>> {
        None
    }

    /// For a move that learns in the warm-up, see [`crate::fit`]: how many numbers each part of its points has. Empty
    /// for other moves.
    fn learns(&self) -> Vec<usize> {
        Vec::new()
    }

    /// The point that a state gives: all parts' numbers, one part after the other. Empty if the state teaches nothing.
    fn learn_from(&self, _target: &T, _state: StateRefOf<'_, T>) -> Vec<f64> {
        Vec::new()
    }

    /// How good a state is. A move learns only from the best states that its chain has seen; so if there are better
    /// ones than before, it forgets the others. The same for all states if they are all to be learnt from.
    fn merit(&self, _target: &T, _state: StateRefOf<'_, T>) -> f64 {
        0.0
    }

    /// The same move with densities fitted to each part of its points. A move that learns must return one.
    fn at_fits(&self, _fits: &[Option<Fit>]) -> Option<Box<dyn Move<T>>> {
        None
    }

    /// The scale that the size of a proposal came from; `None` if it came from none. Then nothing is learnt from it.
    fn scale_of(&self, _path: Path) -> Option<usize> {
        Some(0)
    }
}

/// Index of a move in its mixture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct MoveId(pub u16);

/// Moves chosen at random with fixed weights that do not depend on the state.
pub struct Mixture<T: Target> {
    moves: Vec<Arc<dyn Move<T>>>,
    /// For each move, the probability of choosing it or one before it; the last is 1.
    cumulative: Vec<f64>,
}

/// Weights that do not make a mixture.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MixtureError {
    /// A weight is negative or not a number.
    #[error("the weight of move `{name}` is {weight}; weights are finite and at least 0")]
    Weight {
        /// The move.
        name: String,
        /// Its weight.
        weight: f64,
    },
    /// No move has a positive weight.
    #[error("no move has a positive weight")]
    Empty,
    /// More moves than [`MoveId`] can number.
    #[error("{0} moves are more than the 65,535 a mixture can hold")]
    TooMany(usize),
}

impl<T: Target> Mixture<T> {
    /// A mixture of `moves` with relative weights; moves of weight 0 are left out.
    ///
    /// # Errors
    /// [`MixtureError`] if a weight is negative or not finite, none is positive, or there are more than 65,535
    /// moves.
    pub fn new(moves: Vec<(f64, Box<dyn Move<T>>)>) -> Result<Self, MixtureError> {
        if let Some((weight, bad)) = moves.iter().find(|(weight, _)| !weight.is_finite() || *weight < 0.0) {
            return Err(MixtureError::Weight { name: bad.name().to_owned(), weight: *weight });
        }
        let moves: Vec<_> = moves.into_iter().filter(|(weight, _)| *weight > 0.0).collect();
        if moves.is_empty() {
            return Err(MixtureError::Empty);
        }
        if moves.len() > usize::from(u16::MAX) {
            return Err(MixtureError::TooMany(moves.len()));
        }
        let sum_in_units_of = |unit: f64| moves.iter().map(|(weight, _)| weight / unit).sum::<f64>();
        // Weights whose sum overflows are converted to a unit of 2⁶⁴, which is exact.
        let unit = if sum_in_units_of(1.0).is_finite() { 1.0 } else { 18_446_744_073_709_551_616.0 };
        let total = sum_in_units_of(unit);
        let mut sum = 0.0;
        let mut cumulative: Vec<f64> = moves
            .iter()
            .map(|(weight, _)| {
                sum += weight / unit;
                sum / total
            })
            .collect();
        if let Some(last) = cumulative.last_mut() {
            *last = 1.0;
        }
        Ok(Self { moves: moves.into_iter().map(|(_, kernel)| Arc::from(kernel)).collect(), cumulative })
    }

    /// A mixture of one move.
    #[must_use]
    pub fn of(only: Box<dyn Move<T>>) -> Self {
        Self { moves: vec![Arc::from(only)], cumulative: vec![1.0] }
    }

    /// Chooses a move. A mixture of one move uses no random number.
    pub fn choose(&self, stream: &mut Stream) -> (MoveId, &dyn Move<T>) {
        self.choose_by(&self.cumulative, stream)
    }

    /// Chooses by other probabilities, given cumulatively.
    pub(crate) fn choose_by(&self, cumulative: &[f64], stream: &mut Stream) -> (MoveId, &dyn Move<T>) {
        let index = if self.moves.len() == 1 {
            0
        } else {
            let u = open_unit(stream);
            cumulative.iter().position(|&bound| u < bound).unwrap_or(self.moves.len() - 1)
        };
        (MoveId(index as u16), self.moves[index].as_ref())
    }

    /// The move of an id this mixture gave, with its probability.
    ///
    /// # Panics
    ///
    /// If the id belongs to another mixture and is out of range.
    #[must_use]
    pub fn get(&self, id: MoveId) -> (f64, &dyn Move<T>) {
        let index = usize::from(id.0);
        let before = if index == 0 { 0.0 } else { self.cumulative[index - 1] };
        (self.cumulative[index] - before, self.moves[index].as_ref())
    }

    /// The moves with their probabilities, in order of their [`MoveId`].
    pub fn iter(&self) -> impl Iterator<Item = (f64, &dyn Move<T>)> {
        (0..self.moves.len()).map(|index| self.get(MoveId(index as u16)))
    }

    /// The same moves with some replaced, and with other cumulative probabilities where these are given.
    pub(crate) fn map(
        &self,
        replace: impl Fn(MoveId, &dyn Move<T>) -> Option<Box<dyn Move<T>>>,
        cumulative: Option<&[f64]>,
    ) -> Self {
        let kernel = |(id, kernel): (u16, &Arc<dyn Move<T>>)| {
            replace(MoveId(id), kernel.as_ref()).map_or_else(|| Arc::clone(kernel), Arc::from)
        };
        Self {
            moves: (0..).zip(&self.moves).map(kernel).collect(),
            cumulative: cumulative.unwrap_or(&self.cumulative).to_vec(),
        }
    }

    /// The same mixture with `kernel` in place of the move of its name; unchanged if there is none.
    #[must_use]
    pub fn with(mut self, kernel: Box<dyn Move<T>>) -> Self {
        let place = self.moves.iter().position(|other| other.name() == kernel.name());
        if let Some(place) = place {
            self.moves[place] = Arc::from(kernel);
        }
        self
    }

    /// The same probabilities for moves of another target, one for one.
    pub(crate) fn map_all<U: Target>(&self, raise: impl Fn(Arc<dyn Move<T>>) -> Box<dyn Move<U>>) -> Mixture<U> {
        let moves = self.moves.iter().map(|kernel| Arc::from(raise(Arc::clone(kernel)))).collect();
        Mixture { moves, cumulative: self.cumulative.clone() }
    }

    /// The moves, to be shared.
    pub(crate) fn shared(&self) -> impl Iterator<Item = (f64, Arc<dyn Move<T>>)> {
        (0..).zip(&self.moves).map(|(id, kernel)| (self.get(MoveId(id)).0, Arc::clone(kernel)))
    }

    /// The moves' names, in order of their [`MoveId`].
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        self.moves.iter().map(|kernel| kernel.name().to_owned()).collect()
    }
}
