//! A throw shifted towards its target.

use super::{aimed, log_between};
use crate::dice::{Dice, Draw};
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream, math, standard_normal};
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, StateRefOf, Transition};

/// Shifts a die's throw along the table so that, if everything goes as before, it comes to rest near its target, at a
/// place with a Gaussian law around it.
///
/// A die with a random table of its own is shifted by whole cells together with the table: the same animation
/// elsewhere, bit by bit, except for the spill. Any other die is shifted alone, by any length; on a flat table without
/// fields that is the same animation elsewhere, up to rounding. The way back aims from where the candidate came to
/// rest, so the ratio is `q(−shift | candidate)/q(shift | current)`, of densities or of probabilities of cells; both
/// kinds of shift preserve volumes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shift {
    /// Standard deviation of the place aimed at, along each axis, in m.
    pub sd: f64,
}

impl Shift {
    /// Log probability, or density per m², of the shift from one draw to another, given where the die of the first came
    /// to rest.
    fn log_q(self, target: &Dice, from: StateRefOf<'_, Dice>, to: &Draw, die: usize) -> f64 {
        let Some(place) = target.plan.places[die] else { return f64::NEG_INFINITY };
        let rest = from.outcome.trips[die].position + target.offset(from.draw, die);
        let cell = target.plan.surface.spacing();
        let along = |axis: usize| {
            let aim = place[axis] - rest[axis];
            if target.plan.carries() {
                let shift = to.tables[die].shifted[axis].wrapping_sub(from.draw.tables[die].shifted[axis]);
                let z = |k: f64| (k * cell - aim) / self.sd;
                log_between(z(f64::from(shift) - 0.5), z(f64::from(shift) + 0.5))
            } else {
                let shift = to.throws[die].position[axis] - from.draw.throws[die].position[axis];
                self.log_peak() - 0.5 * math::square((shift - aim) / self.sd)
            }
        };
        along(0) + along(1)
    }

    fn log_peak(self) -> f64 {
        -math::ln(self.sd * std::f64::consts::TAU.sqrt())
    }

    /// An upper bound of any log probability or density, including rounding.
    fn most(self, target: &Dice) -> f64 {
        if target.plan.carries() { 1e-9 } else { 2.0 * self.log_peak() + 1e-9 }
    }
}

/// Farther than any table is large, in cells.
const FARTHEST: f64 = 1.6e7;

impl Move<Dice> for Shift {
    fn name(&self) -> &'static str {
        "shift"
    }

    fn propose(&self, at: At<'_, Dice>, candidate: &mut Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let count = aimed(at.target).count();
        let Some((die, place)) = aimed(at.target).nth(below(stream, count)) else { return Ok(Proposal::Stay) };
        let rest = at.state.outcome.trips[die].position + at.target.offset(at.state.draw, die);
        for axis in 0..2 {
            let aim = place[axis] - rest[axis] + self.sd * standard_normal(stream);
            if at.target.plan.carries() {
                let cells = (aim / at.target.plan.surface.spacing()).round().clamp(-FARTHEST, FARTHEST);
                let shifted = &mut candidate.tables[die].shifted[axis];
                *shifted = shifted.wrapping_add(cells as i32);
            } else {
                candidate.throws[die].position[axis] += aim;
            }
        }
        let log_ratio = LogRatio::new(-self.log_q(at.target, at.state, candidate, die))?;
        let later = Some(LogRatio::new(self.most(at.target))?);
        Ok(Proposal::Candidate { log_ratio, path: Path(die as u64), later })
    }

    fn log_ratio(&self, step: Transition<'_, Dice>) -> Result<LogRatio, ModelError> {
        let die = step.path.0 as usize;
        let forth = LogRatio::new(self.log_q(step.target, step.from, step.to.draw, die))?;
        Ok(LogRatio::new(self.log_q(step.target, step.to, step.from.draw, die))?.times(forth.inverse())?)
    }

    fn log_ratio_after(&self, step: Transition<'_, Dice>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::new(self.log_q(step.target, step.to, step.from.draw, step.path.0 as usize))?)
    }
}
