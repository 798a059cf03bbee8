//! A fresh throw from where it leads to the target.

use super::{aimed, log_between};
use crate::dice::constraint::Constraint;
use crate::dice::{Dice, Draw, End, Work};
use glam::DQuat;
use plaus_dist::stream::below;
use plaus_dist::{LogDensity, LogRatio, Stream, math, open_unit, standard_normal};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// A die gets a fresh throw from the prior, and a fresh table of its own, from a place from where it comes to rest near its target, with its pips turned so that
/// a demanded face is likely to be up.
///
/// The throw is tried out: how far it leads, d, does not depend on the place where it begins, for each die has a table of its own, of which each place is like any
/// other. So beginning at the target minus d, up to a Gaussian error, is a proposal with a known density: that of all else under the prior, times that
/// of the error, times the chance that the pips are turned so. The ratio is that of the old state over that of the new one; it does not depend on the way from one
/// to the other. On a random table a die begins at a uniform place within a cell, and whole cells are added. A die that does not come to rest is neither led
/// to nor from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recast {
    /// Standard deviation of the place aimed at, along each axis, in m.
    pub sd: f64,
}

/// Weights of the turns of a die's pips, given how its body lies: what the demands of a face make of them.
fn weights(target: &Dice, die: usize, orientation: DQuat) -> Vec<f64> {
    let log = |pips| {
        let logs = target.plan.demands.iter().map(|demand| match &demand.constraint {
            Constraint::FaceUp(up) if demand.die == die => up.mark(orientation, pips).log,
            _ => 0.0,
        });
        logs.sum::<f64>()
    };
    let logs: Vec<f64> = target.plan.rotations.iter().map(log).collect();
    let most = logs.iter().fold(f64::NEG_INFINITY, |most, log| most.max(*log));
    logs.into_iter().map(|log| math::exp(log - most)).collect()
}

fn is_at_rest(state: &StateOf<Dice>, die: usize) -> bool {
    state.outcome.trips[die].end == End::AtRest
}

impl Recast {
    /// Log density of proposing a die's throw as it is in a state, but for what is the same for all states.
    fn log_q(self, target: &Dice, state: &StateOf<Dice>, die: usize) -> Result<LogDensity, ModelError> {
        let Some(place) = target.plan.places[die] else { return Ok(LogDensity::ZERO) };
        let (throw, trip) = (&state.draw.throws[die], &state.outcome.trips[die]);
        let rest = trip.position + target.offset(&state.draw, die);
        let half = 0.5 * target.plan.surface.spacing();
        let along = |axis: usize| {
            let off = rest[axis] - place[axis];
            if target.plan.carries() {
                log_between((off - half) / self.sd, (off + half) / self.sd)
            } else {
                -0.5 * math::square(off / self.sd)
            }
        };
        let weights = weights(target, die, trip.orientation);
        let turned = math::ln(weights[usize::from(throw.turn)] / weights.iter().sum::<f64>());
        let elsewhere = target.prior().log_density_elsewhere(throw, die)?;
        Ok(elsewhere + LogDensity::new(along(0) + along(1) + turned)?)
    }

    fn ratio(
        self,
        target: &Dice,
        from: &StateOf<Dice>,
        to: &StateOf<Dice>,
        die: usize,
    ) -> Result<LogRatio, ModelError> {
        if !is_at_rest(to, die) {
            return Ok(LogRatio::ZERO);
        }
        Ok(LogRatio::of(self.log_q(target, from, die)?, self.log_q(target, to, die)?)?)
    }
}

impl Move<Dice> for Recast {
    fn name(&self) -> &'static str {
        "recast"
    }

    fn propose(
        &self,
        target: &Dice,
        current: &StateOf<Dice>,
        candidate: &mut Draw,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let count = aimed(target).count();
        let Some((die, place)) = aimed(target).nth(below(stream, count)) else { return Ok(Proposal::Stay) };
        if !is_at_rest(current, die) {
            return Ok(Proposal::Stay);
        }
        let cell = target.plan.surface.spacing();
        let mut throw = target.prior().throw(die, stream);
        candidate.tables[die].renew(stream);
        (throw.position.x, throw.position.y) = (cell * open_unit(stream), cell * open_unit(stream));
        let Some(trip) = Work::default().try_out(&target.plan, &throw, &candidate.tables[die])? else {
            return Ok(Proposal::with_ratio(LogRatio::ZERO));
        };
        for axis in 0..2 {
            let aim = place[axis] - trip.position[axis] + self.sd * standard_normal(stream);
            if target.plan.carries() {
                candidate.tables[die].shifted[axis] = (aim / cell).round() as i32;
            } else {
                throw.position[axis] += aim;
            }
        }
        let weights = weights(target, die, trip.orientation);
        let mut left = weights.iter().sum::<f64>() * open_unit(stream);
        let chosen = weights.iter().position(|weight| {
            left -= weight;
            left < 0.0
        });
        throw.turn = chosen.unwrap_or(weights.len() - 1) as u8;
        candidate.throws[die] = throw;
        // What is proposed depends on the state that it comes from in nothing: its density is known when it has been simulated.
        let log_ratio = LogRatio::of(self.log_q(target, current, die)?, LogDensity::ONE)?;
        let later = Some(LogRatio::new(f64::INFINITY)?);
        Ok(Proposal::Candidate { log_ratio, path: Path(die as u64), later })
    }

    fn log_ratio(
        &self,
        target: &Dice,
        from: &StateOf<Dice>,
        to: &StateOf<Dice>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        self.ratio(target, from, to, path.0 as usize)
    }

    fn log_ratio_after(
        &self,
        target: &Dice,
        _: &StateOf<Dice>,
        candidate: &StateOf<Dice>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        let die = path.0 as usize;
        if !is_at_rest(candidate, die) {
            return Ok(LogRatio::ZERO);
        }
        Ok(LogRatio::of(LogDensity::ONE, self.log_q(target, candidate, die)?)?)
    }
}
