//! Detailed balance on worlds whose states can be listed.

use super::CheckError;
use super::proposals::{Enumerable, Frequencies, Way, frequencies};
use crate::moves::At;
use crate::target::{ModelError, State, StateOf, Target};
use plaus_dist::{Seed, math};
use std::fmt;

/// How to check balance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balance {
    /// Largest allowed `|π_i P_ij − π_j P_ji|`, and largest deviation of a row sum from 1. Probabilities add up to 1,
    /// so 1e-12 is about 10⁴ rounding errors.
    pub tolerance: f64,
    /// Seed of the proposals that are compared with the lists.
    pub seed: Seed,
    /// Proposals made from each state; 0 skips that comparison.
    pub tries: u64,
    /// Probability of a false alarm in that comparison, over all moves together, above 0 and below 1.
    pub false_alarm: f64,
    /// Largest allowed difference between the ratio an accept step uses and [`crate::Move::log_ratio`], in nats.
    pub ratio_tolerance: f64,
}

impl Default for Balance {
    fn default() -> Self {
        Self { tolerance: 1e-12, seed: Seed(0), tries: 4_000, false_alarm: 1e-6, ratio_tolerance: 1e-9 }
    }
}

/// The largest imbalance of probability flow, and between which two states.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Unbalance {
    /// `max |π_i P_ij − π_j P_ji|`.
    pub value: f64,
    /// Indices (i, j) into the list of states, if there is any imbalance.
    pub states: Option<(usize, usize)>,
}

/// What was found about one move.
#[derive(Debug, Clone, PartialEq)]
pub struct MoveBalance {
    /// The move.
    pub name: String,
    /// Its imbalance alone.
    pub unbalance: Unbalance,
    /// Largest deviation of the sum of its branches' probabilities from 1.
    pub row_error: f64,
    /// How its proposals compare with its list; `None` without tries.
    pub frequencies: Option<Frequencies>,
}

/// What [`balance()`] found.
#[derive(Debug, Clone, PartialEq)]
pub struct BalanceReport {
    /// The settings.
    pub plan: Balance,
    /// Number of states.
    pub states: usize,
    /// Each move.
    pub moves: Vec<MoveBalance>,
    /// The mixture.
    pub mixture: Unbalance,
    /// `max_j |Σ_i π_i P_ij − π_j|` of the mixture: shows whether the target is invariant, even without balance.
    pub drift: f64,
}

impl BalanceReport {
    /// Whether every move by itself and the mixture are in balance, and every move proposes what it lists.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.mixture_passed() && self.moves.iter().all(|one| one.unbalance.value <= self.plan.tolerance)
    }

    /// The same, except that a single move need not be in balance: for moves that are each other's reverse.
    #[must_use]
    pub fn mixture_passed(&self) -> bool {
        let Balance { tolerance, ratio_tolerance, .. } = self.plan;
        let level = self.plan.false_alarm / self.moves.len() as f64;
        let honest = |found: Frequencies| found.p.value() >= level && found.gap <= ratio_tolerance;
        self.mixture.value <= tolerance
            && self.drift <= tolerance
            && self.moves.iter().all(|one| one.row_error <= tolerance && one.frequencies.is_none_or(honest))
    }
}

impl fmt::Display for BalanceReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = match (self.passed(), self.mixture_passed()) {
            (true, _) => "passed",
            (false, true) => "the mixture passed, not every move",
            (false, false) => "FAILED",
        };
        writeln!(f, "balance over {} states: {verdict} (tolerance {:e})", self.states, self.plan.tolerance)?;
        let flow = |Unbalance { value, states }: Unbalance| match states {
            Some((i, j)) => format!("imbalance {value:.1e} between states {i} and {j}"),
            None => "no imbalance".to_owned(),
        };
        writeln!(f, "  mixture: {}, drift {:.1e}", flow(self.mixture), self.drift)?;
        for MoveBalance { name, unbalance, row_error, frequencies } in &self.moves {
            write!(f, "  `{name}`: {}, row sums off by {row_error:.1e}", flow(*unbalance))?;
            if let Some(Frequencies { p, state, gap, gap_state }) = frequencies {
                let at = |state: &Option<usize>| state.map_or(String::new(), |state| format!(" at state {state}"));
                write!(f, ", proposals p = {p}{}, ratios off by {gap:.1e}{}", at(state), at(gap_state))?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

/// Builds the whole transition matrix of the accept rule `min(1, exp(log α))` for a toy `target` whose states are
/// exactly `draws` (others have prior density 0) and moves with relative weights; reports how far it is from detailed
/// balance for the target, move by move and mixed. Also makes proposals and tests that they come with the listed
/// probabilities and with the ratios the matrix is built from.
///
/// Time and memory grow with the square of the number of states.
///
/// # Errors
/// [`CheckError`] if the model fails, a state is missing from `draws` or twice in it, or a setting or weight is out
/// of range.
pub fn balance<T: Target>(
    target: &T,
    draws: Vec<T::Draw>,
    moves: &[(f64, &dyn Enumerable<T>)],
    plan: Balance,
) -> Result<BalanceReport, CheckError> {
    CheckError::check_false_alarm(plan.false_alarm)?;
    let total: f64 = moves.iter().map(|(weight, _)| weight).sum();
    for (weight, _) in moves {
        CheckError::unless(*weight > 0.0 && *weight < f64::INFINITY, "weight", *weight, "positive and finite")?;
    }
    CheckError::unless(total > 0.0, "number of moves", 0.0, "at least 1")?;
    let states = listed(target, draws)?;
    let law = law(&states);
    let mut mixture = Matrix::new(states.len());
    let mut found = Vec::new();
    for &(weight, kernel) in moves {
        let ways = ways(target, kernel, &states)?;
        let matrix = transition(target, kernel, &states, &ways)?;
        let sums = ways.iter().map(|row| (row.iter().map(|way| way.probability).sum::<f64>() - 1.0).abs());
        let tried = match plan.tries {
            0 => None,
            tries => Some(frequencies(target, kernel, &states, &ways, (plan.seed, tries))?),
        };
        found.push(MoveBalance {
            name: kernel.name().to_owned(),
            unbalance: matrix.unbalance(&law),
            row_error: sums.fold(0.0, f64::max),
            frequencies: tried,
        });
        mixture.add(weight / total, &matrix);
    }
    let drift = mixture.drift(&law);
    Ok(BalanceReport { plan, states: states.len(), moves: found, mixture: mixture.unbalance(&law), drift })
}

/// Evaluates the listed draws.
fn listed<T: Target>(target: &T, draws: Vec<T::Draw>) -> Result<Vec<StateOf<T>>, CheckError> {
    for (second, draw) in draws.iter().enumerate() {
        if let Some(first) = draws[..second].iter().position(|other| other == draw) {
            return Err(CheckError::Repeated { first, second });
        }
    }
    let mut scratch = T::Scratch::default();
    let evaluate = |(index, draw)| State::evaluate(target, draw, &mut scratch).map_err(CheckError::model(index));
    (0..).zip(draws).map(evaluate).collect()
}

/// The normalised target.
fn law<D, O>(states: &[State<D, O>]) -> Vec<f64> {
    let most = states.iter().map(|state| state.log_p().value()).fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<_> = states.iter().map(|state| math::exp(state.log_p().value() - most)).collect();
    let total: f64 = weights.iter().sum();
    weights.into_iter().map(|weight| weight / total).collect()
}

/// Where each branch from each state leads. States of density 0 are never left.
fn ways<T: Target>(target: &T, kernel: &dyn Enumerable<T>, states: &[StateOf<T>]) -> Result<Vec<Vec<Way>>, CheckError> {
    let from = |(from, state): (usize, &StateOf<T>)| -> Result<Vec<Way>, CheckError> {
        if state.log_p().is_zero() {
            return Ok(vec![Way { to: None, probability: 1.0, path: crate::Path(0) }]);
        }
        let branches = kernel.branches(target, state.by_ref()).map_err(CheckError::model(from as u64))?;
        let mut row = Vec::with_capacity(branches.len());
        for branch in branches {
            let to = branch.draw.as_ref().and_then(|draw| states.iter().position(|state| state.draw == *draw));
            if let (None, Some(draw)) = (to, &branch.draw) {
                let prior = target.log_prior(draw).map_err(CheckError::model(from as u64))?;
                if !prior.is_zero() {
                    return Err(CheckError::Unlisted { name: kernel.name().to_owned(), from });
                }
            }
            row.push(Way { to, probability: branch.probability, path: branch.path });
        }
        Ok(row)
    };
    states.iter().enumerate().map(from).collect()
}

/// The transition matrix of one move with the accept rule.
fn transition<T: Target>(
    target: &T,
    kernel: &dyn Enumerable<T>,
    states: &[StateOf<T>],
    ways: &[Vec<Way>],
) -> Result<Matrix, CheckError> {
    let mut matrix = Matrix::new(states.len());
    for (from, row) in ways.iter().enumerate() {
        for way in row {
            let Some(to) = way.to else {
                *matrix.at(from, from) += way.probability;
                continue;
            };
            let moved = way.probability
                * acceptance(target, kernel, (&states[from], &states[to]), way)
                    .map_err(CheckError::model(from as u64))?;
            *matrix.at(from, to) += moved;
            *matrix.at(from, from) += way.probability - moved;
        }
    }
    Ok(matrix)
}

/// `min(1, α)`; 0 for a candidate of density 0.
fn acceptance<T: Target>(
    target: &T,
    kernel: &dyn Enumerable<T>,
    (from, to): (&StateOf<T>, &StateOf<T>),
    way: &Way,
) -> Result<f64, ModelError> {
    if to.log_p().is_zero() {
        return Ok(0.0);
    }
    let ratio = kernel.log_ratio(At::new(target, from).to(to.by_ref(), way.path))?;
    Ok(math::exp((to.log_p().value() - from.log_p().value() + ratio.value()).min(0.0)))
}

/// A square matrix, row by row.
struct Matrix {
    size: usize,
    cells: Vec<f64>,
}

impl Matrix {
    fn new(size: usize) -> Self {
        Self { size, cells: vec![0.0; size * size] }
    }

    fn at(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.cells[row * self.size + column]
    }

    fn add(&mut self, weight: f64, other: &Self) {
        self.cells.iter_mut().zip(&other.cells).for_each(|(cell, other)| *cell += weight * other);
    }

    fn unbalance(&self, law: &[f64]) -> Unbalance {
        let mut worst = Unbalance::default();
        for (i, j) in (0..self.size).flat_map(|j| (0..j).map(move |i| (i, j))) {
            let flow = law[i] * self.cells[i * self.size + j] - law[j] * self.cells[j * self.size + i];
            if flow.abs() > worst.value {
                worst = Unbalance { value: flow.abs(), states: Some((i, j)) };
            }
        }
        worst
    }

    fn drift(&self, law: &[f64]) -> f64 {
        let arriving = |column: usize| -> f64 {
            law.iter().enumerate().map(|(row, mass)| mass * self.cells[row * self.size + column]).sum()
        };
        (0..self.size).map(|column| (arriving(column) - law[column]).abs()).fold(0.0, f64::max)
    }
}
