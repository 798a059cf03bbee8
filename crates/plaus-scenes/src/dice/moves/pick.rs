//! Fresh throws, picked from among many.

use super::aimed;
use super::recast::{Led, MOST_AT_ONCE, Recast, led, led_on_table, members, over, turned};
use crate::dice::{Dice, Draw, Rest};
use plaus_dist::stream::below;
use plaus_dist::{LogDensity, LogRatio, Stream, math, open_unit};
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, Transition};

/// For dice thrown onto one table. Recasts one, two or three neighbouring dice at once, by tries that are repeated
/// until one is picked: a try whose place of release is likely under the prior, and which, alone on its table, comes to
/// rest near its target. If dice keep each other from their places, several have to move at once, and each only to a
/// good place. Tries picked die by die find that in a time that is a sum, where random candidates for all at once would
/// need the product.
///
/// A try is that of a recast (see [`Recast`]), but is led more often. It is picked with a probability g that depends on
/// the try and on its table, and is never 0. So a picked throw has the density q g/Z, where Z is the same for the way
/// back, and so is the probability that none of `TRIES` tries is picked. This leaves the ratio `q(old) g(old) / (q(new)
/// g(new))`. This is rejection sampling (von Neumann 1951) inside an independence move (Tierney, "Markov chains for
/// exploring posterior distributions", Annals of Statistics 22, 1994).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pick {
    /// Standard deviation of the place that tries aim at, along each axis, in m.
    pub sd: f64,
    /// How near its target a die must come to rest alone to be picked: the standard deviation of a Gaussian factor of
    /// g, in m.
    pub near: f64,
}

/// Most tries for a die.
const TRIES: usize = 300;
/// Share of tries that stay where the prior puts them. It must not be 0: a die that another die pushed to its place may
/// have been led anywhere, and there must be a way back to that.
const LEFT: f64 = 0.1;
/// The least g of the place of release, and of the resting place: the cost of leaving a state that would never be
/// picked.
const LEAST: [f64; 2] = [0.01, 0.01];
/// Places of release at least this likely, relative to the likeliest, are always picked, in nats.
const SPARED: f64 = 2.0;

impl Pick {
    fn recast(self) -> Recast {
        Recast { sd: self.sd }
    }

    /// The part of g that a place of release gives.
    fn released(target: &Dice, draw: &Draw, die: usize) -> f64 {
        let z = |axis: usize| {
            let law = target.prior().number(die, axis);
            (target.prior().value(draw, die, axis) - law.mean()) / law.sd()
        };
        math::exp((SPARED - 0.5 * (math::square(z(0)) + math::square(z(1)))).min(0.0)).max(LEAST[0])
    }

    /// The part of g that a place of rest gives.
    fn rested(self, led: &Led, place: [f64; 2]) -> f64 {
        let off = |axis: usize| (led.own[axis] - place[axis]) / self.near;
        math::exp(-0.5 * (math::square(off(0)) + math::square(off(1)))).max(LEAST[1])
    }

    /// Tries until one is picked.
    fn pick(
        self,
        target: &Dice,
        candidate: &mut Draw,
        (die, place): (usize, [f64; 2]),
        stream: &mut Stream,
    ) -> Result<Option<Led>, ModelError> {
        for _ in 0..TRIES {
            let Some(plain) = self.recast().lead(target, candidate, (die, place), LEFT, stream)? else { continue };
            if open_unit(stream) >= Self::released(target, candidate, die) {
                continue;
            }
            let Some(led) = led_on_table(target, candidate, die, plain)? else { continue };
            if open_unit(stream) < self.rested(&led, place) {
                candidate.throws[die].turn = turned(target, die, led.orientation, stream);
                return Ok(Some(led));
            }
        }
        Ok(None)
    }

    /// Log of q g of some dice as they are, up to a constant that is the same for all.
    fn log_q(self, target: &Dice, draw: &Draw, dice: &[(usize, Led)]) -> Result<LogDensity, ModelError> {
        dice.iter().try_fold(LogDensity::ONE, |sum, &(die, led)| {
            let Some(place) = target.plan.places[die] else { return Ok(LogDensity::ZERO) };
            let g = Self::released(target, draw, die) * self.rested(&led, place);
            Ok(sum + self.recast().log_q(target, draw, (die, Some(led)), LEFT)? + LogDensity::new(math::ln(g))?)
        })
    }

    /// The same for a state, by new trials; 0 if one does not come to rest.
    fn log_q_of(self, target: &Dice, draw: &Draw, rest: &Rest, path: Path) -> Result<LogDensity, ModelError> {
        let mut dice = Vec::new();
        for die in members(path) {
            let Some(led) = led(target, draw, Some(rest), die)? else { return Ok(LogDensity::ZERO) };
            dice.push((die, led));
        }
        self.log_q(target, draw, &dice)
    }
}

impl Move<Dice> for Pick {
    fn name(&self) -> &'static str {
        "pick"
    }

    fn propose(&self, at: At<'_, Dice>, candidate: &mut Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let count = aimed(at.target).count();
        let size = 1 + below(stream, count.min(MOST_AT_ONCE));
        let first = below(stream, count + 1 - size);
        let path = Path(aimed(at.target).skip(first).take(size).fold(0, |dice, (die, _)| dice | 1 << die));
        let from = self.log_q_of(at.target, at.state.draw, at.state.outcome, path)?;
        if from.is_zero() {
            return Ok(Proposal::Stay);
        }
        let mut picked = Vec::with_capacity(size);
        for (die, place) in aimed(at.target).skip(first).take(size) {
            let Some(led) = self.pick(at.target, candidate, (die, place), stream)? else { return Ok(Proposal::Stay) };
            picked.push((die, led));
        }
        let to = self.log_q(at.target, candidate, &picked)?;
        Ok(Proposal::Candidate { log_ratio: over(from, to)?, path, later: None })
    }

    fn log_ratio(&self, step: Transition<'_, Dice>) -> Result<LogRatio, ModelError> {
        let there = self.log_q_of(step.target, step.to.draw, step.to.outcome, step.path)?;
        if there.is_zero() {
            return Ok(LogRatio::ZERO);
        }
        over(self.log_q_of(step.target, step.from.draw, step.from.outcome, step.path)?, there)
    }
}
