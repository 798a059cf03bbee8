//! A new throw from a place from which it leads to the target.

use super::{aimed, log_between};
use crate::dice::constraint::Constraint;
use crate::dice::{Dice, Draw, End, MOST_DICE, Rest, Trip, Work};
use glam::{DQuat, DVec3};
use plaus_dist::stream::below;
use plaus_dist::{Density, Gaussian, LogDensity, LogRatio, Sample, Stream, math, open_unit, standard_normal};
use plaus_mcmc::library::one_of;
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, StateRefOf, Transition};

/// Gives a die a new throw from the prior, and a new table if it has its own, from a place from which it should come to
/// rest near its target, with its pips turned so that the right face is likely to be up.
///
/// A trial shows how far the throw leads. A die with a random table of its own is tried on that table: it begins at a
/// uniform place within a cell, the table moves with it by whole cells, and it comes to rest exactly where it is led.
/// Any other die, and any die on a table with a spill, is first tried alone on a plain table, and led by any length;
/// then it is tried alone on its own table from there, which shows how its pips have to be turned. The effect of other
/// dice shows when it is simulated.
///
/// The density of such a proposal is that of the throw under the prior, except for its place, times that of the error
/// of the place aimed at, times the probability that the pips are turned this way. It depends on the state led to and
/// not on the one led from, so the ratio is that of the old state over that of the new one. A die whose trial does not
/// come to rest is neither led to nor from.
///
/// For dice thrown onto one table, one, two or three neighbouring ones are recast at once, with probabilities that do
/// not depend on the state: dice in each other's way hold each other where they are, because neither comes to its own
/// place before the other goes. Half of them are not led, but thrown from where the prior puts them. The place that
/// they leave may have been led anywhere, like that of a die pushed to its place by another one, and there must be a
/// way back to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recast {
    /// Standard deviation of the place aimed at, along each axis, in m.
    pub sd: f64,
}

/// Where a throw should come to rest, and how its body lies then.
#[derive(Debug, Clone, Copy)]
pub(super) struct Led {
    /// Where it was led.
    pub(super) rest: DVec3,
    /// Where it comes to rest alone on its table.
    pub(super) own: DVec3,
    pub(super) orientation: DQuat,
}

/// Share of throws that stay where they were drawn, for dice thrown onto one table.
const LEFT: f64 = 0.5;

/// Whether dice are tried on the tables onto which they are thrown.
pub(super) fn is_exact(target: &Dice) -> bool {
    target.plan.carries() && !target.plan.surface.is_patched()
}

/// Whether some throws are left where they were drawn.
fn is_mixed(target: &Dice) -> bool {
    target.plan.together
}

/// Where a die's throw leads, according to trials; `None` if it does not come to rest.
pub(super) fn led(target: &Dice, draw: &Draw, rest: Option<&Rest>, die: usize) -> Result<Option<Led>, ModelError> {
    let offset = target.offset(draw, die);
    if is_exact(target) {
        let trip = rest.map(|rest| &rest.trips[die]).filter(|trip| trip.end == End::AtRest);
        let at_rest = |trip: &Trip| (trip.position + offset, trip.orientation);
        return Ok(trip.map(at_rest).map(|(rest, orientation)| Led { rest, own: rest, orientation }));
    }
    let mut throw = draw.throws[die];
    let start = DVec3::new(throw.position.x, throw.position.y, 0.0);
    throw.position -= start;
    let Some(plain) = Work::default().try_out(&target.plan, &throw, None)? else { return Ok(None) };
    led_on_table(target, draw, die, (start + offset + plain.position, plain.orientation))
}

/// Where and how a die finally lies if it is thrown alone onto its table; `None` if it does not come to rest. `plain`
/// is where and how it does so on a plain table, where it was led.
pub(super) fn led_on_table(
    target: &Dice,
    draw: &Draw,
    die: usize,
    (rest, orientation): (DVec3, DQuat),
) -> Result<Option<Led>, ModelError> {
    if target.plan.surface.is_plain() {
        return Ok(Some(Led { rest, own: rest, orientation }));
    }
    let (throw, table) = (&draw.throws[die], &draw.tables[draw.table_of(die)]);
    let trip = Work::default().try_out(&target.plan, throw, Some(table))?;
    let offset = target.offset(draw, die);
    Ok(trip.map(|trip| Led { rest, own: trip.position + offset, orientation: trip.orientation }))
}

/// Weights of the turns of a die's pips, given how its body lies, according to the faces asked for.
pub(super) fn weights(target: &Dice, die: usize, orientation: DQuat) -> Vec<f64> {
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

/// The turn of a die's pips, chosen by these weights.
pub(super) fn turned(target: &Dice, die: usize, orientation: DQuat, stream: &mut Stream) -> u8 {
    let weights = weights(target, die, orientation);
    one_of(weights.iter().copied(), stream).unwrap_or(weights.len() - 1) as u8
}

/// Largest number of dice of one table that are recast at once.
pub(super) const MOST_AT_ONCE: usize = 3;

/// The dice of a path: one bit for each.
pub(super) fn members(path: Path) -> impl Iterator<Item = usize> {
    (0..MOST_DICE as usize).filter(move |die| path.0 >> die & 1 == 1)
}

impl Recast {
    /// Casts one die anew, and returns where it is led; `None` if it does not come to rest in its trial.
    fn cast(
        self,
        target: &Dice,
        candidate: &mut Draw,
        (die, place): (usize, [f64; 2]),
        stream: &mut Stream,
    ) -> Result<Option<Led>, ModelError> {
        let Some((rest, orientation)) = self.lead(target, candidate, (die, place), LEFT, stream)? else {
            return Ok(None);
        };
        let led = if is_exact(target) {
            Some(Led { rest, own: rest, orientation })
        } else {
            led_on_table(target, candidate, die, (rest, orientation))?
        };
        if let Some(led) = led {
            candidate.throws[die].turn = turned(target, die, led.orientation, stream);
        }
        Ok(led)
    }

    /// Throws one die anew and leads it to its place; if dice meet, it stays where it was drawn with probability
    /// `left`. Returns where and how it comes to rest, if it does.
    pub(super) fn lead(
        self,
        target: &Dice,
        candidate: &mut Draw,
        (die, place): (usize, [f64; 2]),
        left: f64,
        stream: &mut Stream,
    ) -> Result<Option<(DVec3, DQuat)>, ModelError> {
        let (plan, cell) = (&target.plan, target.plan.surface.spacing());
        let mut throw = target.prior().throw(die, stream);
        if plan.carries() {
            candidate.tables[die].renew(stream);
        }
        let within = if is_exact(target) { cell } else { 0.0 };
        (throw.position.x, throw.position.y) = (within * open_unit(stream), within * open_unit(stream));
        let table = is_exact(target).then(|| &candidate.tables[die]);
        let Some(trip) = Work::default().try_out(plan, &throw, table)? else { return Ok(None) };
        let mut rest = trip.position;
        let is_left = is_mixed(target) && open_unit(stream) < left;
        for axis in 0..2 {
            if is_left {
                // Replaces the value with which the throw was drawn.
                let place = target.prior().number(die, axis).sample(stream);
                rest[axis] += place - throw.position[axis];
                throw.position[axis] = place;
                continue;
            }
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
        candidate.throws[die] = throw;
        Ok(Some((rest, trip.orientation)))
    }

    /// Log density of proposing a die's throw as it is, up to a constant that is the same for all.
    pub(super) fn log_q(
        self,
        target: &Dice,
        draw: &Draw,
        (die, led): (usize, Option<Led>),
        left: f64,
    ) -> Result<LogDensity, ModelError> {
        let (Some(place), Some(led)) = (target.plan.places[die], led) else { return Ok(LogDensity::ZERO) };
        let half = 0.5 * target.plan.surface.spacing();
        let along = |axis: usize| {
            let off = led.rest[axis] - place[axis];
            log_between((off - half) / self.sd, (off + half) / self.sd)
        };
        let place = if is_exact(target) {
            LogDensity::new(along(0) + along(1))?
        } else {
            self.log_place(target, draw, (die, led.rest, place), left)?
        };
        let throw = &draw.throws[die];
        let weights = weights(target, die, led.orientation);
        let turned = math::ln(weights[usize::from(throw.turn)] / weights.iter().sum::<f64>());
        let elsewhere = target.prior().log_density_elsewhere(throw, die)?;
        Ok(elsewhere + place + LogDensity::new(turned)?)
    }

    /// Log density of the place of a throw that is led by any length, or left where it was drawn.
    fn log_place(
        self,
        target: &Dice,
        draw: &Draw,
        (die, rest, place): (usize, DVec3, [f64; 2]),
        left: f64,
    ) -> Result<LogDensity, ModelError> {
        let about = |axis: usize| Gaussian::new(place[axis], self.sd).map_err(ModelError::new);
        let led = about(0)?.log_density(&rest[0])?.value() + about(1)?.log_density(&rest[1])?.value();
        let drawn = |axis: usize| target.prior().number(die, axis).log_density(&target.prior().value(draw, die, axis));
        if !is_mixed(target) {
            return Ok(LogDensity::new(led)?);
        }
        let drawn = drawn(0)?.value() + drawn(1)?.value();
        let most = led.max(drawn);
        let sum = (1.0 - left) * math::exp(led - most) + left * math::exp(drawn - most);
        Ok(LogDensity::new(most + math::ln(sum))?)
    }
}

/// The ratio of two densities; 0 if the first is 0, whatever the second is.
pub(super) fn over(from: LogDensity, to: LogDensity) -> Result<LogRatio, ModelError> {
    if from.is_zero() { Ok(LogRatio::ZERO) } else { Ok(LogRatio::of(from, to)?) }
}

impl Move<Dice> for Recast {
    fn name(&self) -> &'static str {
        "recast"
    }

    fn propose(&self, at: At<'_, Dice>, candidate: &mut Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let count = aimed(at.target).count();
        let most = if at.target.plan.together { count.min(MOST_AT_ONCE) } else { 1 };
        let size = if most > 1 { 1 + below(stream, most) } else { 1 };
        let first = below(stream, count + 1 - size);
        let (mut from, mut to, mut dice) = (LogDensity::ONE, LogDensity::ONE, 0);
        for (die, place) in aimed(at.target).skip(first).take(size) {
            let Some(old) = led(at.target, at.state.draw, Some(at.state.outcome), die)? else {
                return Ok(Proposal::Stay);
            };
            let Some(new) = self.cast(at.target, candidate, (die, place), stream)? else { return Ok(Proposal::Stay) };
            from = from + self.log_q(at.target, at.state.draw, (die, Some(old)), LEFT)?;
            to = to + self.log_q(at.target, candidate, (die, Some(new)), LEFT)?;
            dice |= 1 << die;
        }
        // A die that leaves its table has no way back.
        let later = is_exact(at.target).then_some(LogRatio::ONE);
        Ok(Proposal::Candidate { log_ratio: over(from, to)?, path: Path(dice), later })
    }

    fn log_ratio(&self, step: Transition<'_, Dice>) -> Result<LogRatio, ModelError> {
        let log_q = |state: StateRefOf<'_, Dice>| {
            members(step.path).try_fold(LogDensity::ONE, |sum, die| -> Result<_, ModelError> {
                let led = led(step.target, state.draw, Some(state.outcome), die)?;
                Ok(sum + self.log_q(step.target, state.draw, (die, led), LEFT)?)
            })
        };
        let there = log_q(step.to)?;
        if there.is_zero() { Ok(LogRatio::ZERO) } else { over(log_q(step.from)?, there) }
    }

    fn log_ratio_after(&self, step: Transition<'_, Dice>) -> Result<LogRatio, ModelError> {
        let are_at_rest = members(step.path).all(|die| step.to.outcome.trips[die].end == End::AtRest);
        Ok(if are_at_rest { LogRatio::ONE } else { LogRatio::ZERO })
    }
}
