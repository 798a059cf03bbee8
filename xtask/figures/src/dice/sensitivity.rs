//! The effect of one control point: it is drawn anew, and the die is thrown again.

use super::Thrown;
use super::steering::{KINDS, Row, basis, contact};
use crate::{Result, Work};
use plaus_dist::stream::below;
use plaus_dist::{Purpose, Seed, Stream, math, open_unit, standard_normal};
use plaus_mcmc::{Chain, Goal, State, StateRefOf, Target};
use plaus_scenes::dice::{Dice, End, Field, Site, Work as Memory};
use rayon::prelude::*;

/// The effects of redraws, by the contact that the point is near.
pub(super) struct Felt {
    /// How far the resting place moves, in mm: median over throws of the prior.
    pub(super) moved: Row,
    /// How often a different face comes up.
    pub(super) turned: Row,
    /// How often the change of a solution is accepted.
    pub(super) accepted: Row,
    /// How this was computed.
    pub(super) note: String,
}

/// One state with a point redrawn near a contact of each kind: how far the resting place moves in mm (NaN if there is
/// no such contact, or if either throw does not come to rest), whether a different face is up, and the probability of
/// acceptance.
/// is no such contact, or either does not come to rest), whether another face is up, and the chance of acceptance.
type Tried = [Option<(f64, bool, f64)>; KINDS];

pub(super) fn measure(work: &Work, thrown: &Thrown) -> Result<Felt> {
    let count: u64 = work.size(800, 2);
    let of_prior = (0..count).into_par_iter().map(|k| {
        let mut stream = Seed(7).chain(k).at(0, Purpose::START);
        let mut memory = Memory::default();
        loop {
            let state = State::evaluate(&thrown.scene, thrown.scene.start(&mut stream), &mut memory)?;
            if state.outcome.complete() {
                return tried(&thrown.scene, state.by_ref(), &mut stream);
            }
        }
    });
    let of_prior = of_prior.collect::<Result<Vec<Tried>>>()?;
    // Solutions come from several chains, and are far apart.
    let (chains, each, apart): (u64, u64, u64) = work.size((16, 40, 25), (1, 2, 1));
    let of_chain = |k: u64| -> Result<Vec<Tried>> {
        let mut chain = Chain::start(&thrown.scene, &thrown.moves, Seed(8).chain(k))?;
        let mut stream = Seed(9).chain(k).at(0, Purpose::START);
        let (mut found, most) = (Vec::new(), work.size(100_000, 3));
        while (found.len() as u64) < each && chain.iteration() < most {
            chain.step()?;
            let due = chain.iteration() >= work.size(300, 1) && chain.iteration().is_multiple_of(apart);
            if due && (work.quick || thrown.scene.class(chain.state().by_ref()).is_some()) {
                found.push(tried(&thrown.scene, chain.state().by_ref(), &mut stream)?);
            }
        }
        Ok(found)
    };
    let of_solutions = (0..chains).into_par_iter().map(of_chain).collect::<Result<Vec<_>>>()?;
    let column = |all: &[Tried], kind: usize, of: fn((f64, bool, f64)) -> f64| -> Vec<f64> {
        all.iter().filter_map(|tried| tried[kind].map(of)).collect()
    };
    let row = |of: &dyn Fn(usize) -> (f64, f64)| -> Row { std::array::from_fn(of) };
    // Chains are independent, so the spread of their means gives the error.
    let accepted = |kind: usize| {
        let means: Vec<f64> =
            of_solutions.iter().map(|all| mean(&column(all, kind, |t| t.2)).0).filter(|m| m.is_finite()).collect();
        mean(&means)
    };
    Ok(Felt {
        moved: row(&|kind| median(column(&of_prior, kind, |t| t.0))),
        turned: row(&|kind| mean(&column(&of_prior, kind, |t| f64::from(u8::from(t.1))))),
        accepted: row(&accepted),
        note: format!(
            "{count} throws of the prior and {} solutions of {chains} chains: one control point of the height, chosen among the sixteen under the n-th contact by its weight there, is drawn anew from its law. \
             A change is accepted with the ratio of the constraints.",
            of_solutions.iter().map(Vec::len).sum::<usize>()
        ),
    })
}

fn tried(scene: &Dice, state: StateRefOf<'_, Dice>, stream: &mut Stream) -> Result<Tried> {
    let trip = &state.outcome.trips[0];
    let cell = scene.config().table.grid_mm * 1e-3;
    let mut memory = Memory::default();
    let mut found = [None; KINDS];
    for (kind, found) in found.iter_mut().enumerate() {
        let Some(n) = contact(kind, trip.impacts.len(), open_unit(stream)) else { continue };
        let [_, x, y] = trip.impacts[n];
        let sites: Vec<([i32; 2], f64)> = basis(x, y, cell).collect();
        let mut left = open_unit(stream);
        let chosen = sites.iter().find(|(_, weight)| {
            left -= weight;
            left < 0.0
        });
        let ([i, j], _) = chosen.copied().unwrap_or(sites[below(stream, 16)]);
        let mut draw = state.draw.clone();
        draw.tables[0].set(Site { field: Field::Height, i, j }, standard_normal(stream));
        let new = State::evaluate(scene, draw, &mut memory)?;
        let accepted = math::exp((new.log_constraint.value() - state.log_constraint.value()).min(0.0));
        let there = &new.outcome.trips[0];
        if there.end == End::AtRest {
            let moved = (there.position - trip.position).length() * 1e3;
            *found = Some((moved, new.outcome.faces != state.outcome.faces, accepted));
        } else {
            // Off the table counts as farther than anything else.
            *found = Some((f64::INFINITY, true, 0.0));
        }
    }
    Ok(found)
}

/// Mean of independent numbers, and its standard error.
pub(super) fn mean(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|x| math::square(x - mean)).sum();
    (mean, (squares / (n * (n - 1.0))).sqrt())
}

/// Median of independent numbers, with half the width of its 68% interval from order statistics.
fn median(mut values: Vec<f64>) -> (f64, f64) {
    values.sort_by(f64::total_cmp);
    let n = values.len() as f64;
    let rank = |rank: f64| {
        values.get((rank.round().max(0.0) as usize).min(values.len().saturating_sub(1))).copied().unwrap_or(f64::NAN)
    };
    let half = 0.5 * n.sqrt();
    (rank(0.5 * n), 0.5 * (rank(0.5 * n + half) - rank(0.5 * n - half)))
}
