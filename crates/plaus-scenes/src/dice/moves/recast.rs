//! A fresh throw from where it leads to the target.

use super::{aimed, log_between};
use crate::dice::constraint::Constraint;
use crate::dice::{Dice, Draw, End, Rest, Work};
use glam::{DQuat, DVec3};
use plaus_dist::stream::below;
use plaus_dist::{LogDensity, LogRatio, Stream, math, open_unit, standard_normal};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// A die gets a fresh throw from the prior, and a fresh table where it has one of its own, from a place from where it should come to rest near its target, with its pips
/// turned so that a demanded face is likely to be up.
///
/// The throw is tried out to see how far it leads. A die with a random table of its own is tried out on that: it begins at a uniform place within a cell, the table goes
/// with it by whole cells, and it comes to rest just where it is led. Any other die, and any where something was spilt, is tried out alone on a plain table, and led by any
/// length; what bumps and other dice do to it is seen when it is simulated.
///
/// The density of such a proposal is that of the throw under the prior, but for its place; times that of the error of the place aimed at; times the chance that the
/// pips are turned so. It depends on the state led to and not on that led from, so the ratio is that of the old state over that of the new one. A die whose try-out does
/// not come to rest is neither led to nor from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recast {
    /// Standard deviation of the place aimed at, along each axis, in m.
    pub sd: f64,
}

/// Where a throw should come to rest, and how its body lies then.
#[derive(Debug, Clone, Copy)]
struct Led {
    rest: DVec3,
    orientation: DQuat,
}

/// Whether dice are tried out on the tables that they are thrown onto.
fn is_exact(target: &Dice) -> bool {
    target.plan.carries() && !target.plan.surface.is_patched()
}

/// Where a die's throw leads, as a try-out tells; `None` where it does not come to rest.
fn led(target: &Dice, draw: &Draw, rest: Option<&Rest>, die: usize) -> Result<Option<Led>, ModelError> {
    let offset = target.offset(draw, die);
    if is_exact(target) {
        let trip = rest.map(|rest| &rest.trips[die]).filter(|trip| trip.end == End::AtRest);
        return Ok(trip.map(|trip| Led { rest: trip.position + offset, orientation: trip.orientation }));
    }
    let mut throw = draw.throws[die];
    let start = DVec3::new(throw.position.x, throw.position.y, 0.0);
    throw.position -= start;
    let trip = Work::default().try_out(&target.plan, &throw, None)?;
    Ok(trip.map(|trip| Led { rest: start + offset + trip.position, orientation: trip.orientation }))
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

impl Recast {
    /// Log density of proposing a die's throw as it is, but for what is the same for all.
    fn log_q(self, target: &Dice, draw: &Draw, led: Option<Led>, die: usize) -> Result<LogDensity, ModelError> {
        let (Some(place), Some(led)) = (target.plan.places[die], led) else { return Ok(LogDensity::ZERO) };
        let half = 0.5 * target.plan.surface.spacing();
        let along = |axis: usize| {
            let off = led.rest[axis] - place[axis];
            if is_exact(target) {
                log_between((off - half) / self.sd, (off + half) / self.sd)
            } else {
                -0.5 * math::square(off / self.sd)
            }
        };
        let throw = &draw.throws[die];
        let weights = weights(target, die, led.orientation);
        let turned = math::ln(weights[usize::from(throw.turn)] / weights.iter().sum::<f64>());
        let elsewhere = target.prior().log_density_elsewhere(throw, die)?;
        Ok(elsewhere + LogDensity::new(along(0) + along(1) + turned)?)
    }
}

/// The ratio of two densities; 0 where the first is, whatever the second.
fn over(from: LogDensity, to: LogDensity) -> Result<LogRatio, ModelError> {
    if from.is_zero() { Ok(LogRatio::ZERO) } else { Ok(LogRatio::of(from, to)?) }
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
        let Some(old) = led(target, &current.draw, Some(&current.outcome), die)? else { return Ok(Proposal::Stay) };
        let (plan, cell) = (&target.plan, target.plan.surface.spacing());
        let mut throw = target.prior().throw(die, stream);
        if plan.carries() {
            candidate.tables[die].renew(stream);
        }
        let within = if is_exact(target) { cell } else { 0.0 };
        (throw.position.x, throw.position.y) = (within * open_unit(stream), within * open_unit(stream));
        let table = is_exact(target).then(|| &candidate.tables[die]);
        let Some(trip) = Work::default().try_out(plan, &throw, table)? else {
            return Ok(Proposal::Stay);
        };
        let mut rest = trip.position;
        for axis in 0..2 {
            let aim = place[axis] - trip.position[axis] + self.sd * standard_normal(stream);
            if is_exact(target) {
                let cells = (aim / cell).round();
                candidate.tables[die].shifted[axis] = cells as i32;
                rest[axis] += cells * cell;
            } else {
                throw.position[axis] += aim;
                rest[axis] += aim;
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
        let new = Led { rest, orientation: trip.orientation };
        let from = self.log_q(target, &current.draw, Some(old), die)?;
        let log_ratio = over(from, self.log_q(target, candidate, Some(new), die)?)?;
        // A die that leaves its table on the way has no way back.
        let later = is_exact(target).then_some(LogRatio::ONE);
        Ok(Proposal::Candidate { log_ratio, path: Path(die as u64), later })
    }

    fn log_ratio(
        &self,
        target: &Dice,
        from: &StateOf<Dice>,
        to: &StateOf<Dice>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        let die = path.0 as usize;
        let log_q = |state: &StateOf<Dice>| {
            let led = led(target, &state.draw, Some(&state.outcome), die)?;
            self.log_q(target, &state.draw, led, die)
        };
        let there = log_q(to)?;
        if there.is_zero() { Ok(LogRatio::ZERO) } else { over(log_q(from)?, there) }
    }

    fn log_ratio_after(
        &self,
        _: &Dice,
        _: &StateOf<Dice>,
        candidate: &StateOf<Dice>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        let is_at_rest = candidate.outcome.trips[path.0 as usize].end == End::AtRest;
        Ok(if is_at_rest { LogRatio::ONE } else { LogRatio::ZERO })
    }
}
