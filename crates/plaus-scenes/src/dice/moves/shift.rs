//! A throw shifted towards its target.

use crate::dice::{Dice, Draw};
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream, math, standard_normal};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// A die's throw is shifted along the table so that, if all went as before, it would come to rest near its target: at a place Gaussian about it.
///
/// A die with a random table of its own is shifted by whole cells together with the table: the same animation elsewhere, but for rounding and for what was spilt. Any
/// other is shifted alone, by any length; on a flat table without fields that is the same animation elsewhere, too. The way back aims from where the
/// candidate came to rest, so the ratio is `q(−shift | candidate)/q(shift | current)`, of densities or of probabilities of cells; both kinds of shift keep volumes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shift {
    /// Standard deviation of the place aimed at, along each axis, in m.
    pub sd: f64,
}

/// Whether a die's table goes with it.
fn carries(target: &Dice, draw: &Draw) -> bool {
    !target.fields().is_empty() && draw.tables.len() == draw.throws.len() && !target.plan.together
}

/// `ln (Φ(b) − Φ(a))` for `a < b`, from the nearer tail.
fn log_between(a: f64, b: f64) -> f64 {
    let upper = |z: f64| 0.5 * math::erfc(z * std::f64::consts::FRAC_1_SQRT_2);
    math::ln(if a > 0.0 { upper(a) - upper(b) } else { upper(-b) - upper(-a) })
}

impl Shift {
    /// The dice that have a target.
    fn aimed(target: &Dice) -> impl Iterator<Item = (usize, [f64; 2])> {
        target.plan.places.iter().enumerate().filter_map(|(die, place)| Some((die, (*place)?)))
    }

    /// Log probability, or density per m², of the shift from one draw to another, given where the die of the first came to rest.
    fn log_q(self, target: &Dice, from: &StateOf<Dice>, to: &Draw, die: usize) -> f64 {
        let Some(place) = target.plan.places[die] else { return f64::NEG_INFINITY };
        let rest = from.outcome.trips[die].position;
        let cell = target.plan.surface.spacing();
        let along = |axis: usize| {
            let aim = place[axis] - rest[axis];
            if carries(target, to) {
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

    /// What no log probability or density exceeds, rounding included.
    fn most(self, target: &Dice, draw: &Draw) -> f64 {
        if carries(target, draw) { 1e-9 } else { 2.0 * self.log_peak() + 1e-9 }
    }
}

impl Move<Dice> for Shift {
    fn name(&self) -> &'static str {
        "shift"
    }

    fn propose(
        &self,
        target: &Dice,
        current: &StateOf<Dice>,
        candidate: &mut Draw,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let count = Self::aimed(target).count();
        let Some((die, place)) = Self::aimed(target).nth(below(stream, count)) else { return Ok(Proposal::Stay) };
        let (rest, cell) = (current.outcome.trips[die].position, target.plan.surface.spacing());
        for axis in 0..2 {
            let aim = place[axis] - rest[axis] + self.sd * standard_normal(stream);
            let shift = if carries(target, candidate) {
                // Off any table where the die is farther than 2²⁴ cells from its target.
                let cells = (aim / cell).round().clamp(-1.6e7, 1.6e7);
                let shifted = &mut candidate.tables[die].shifted[axis];
                *shifted = shifted.wrapping_add(cells as i32);
                cells * cell
            } else {
                aim
            };
            candidate.throws[die].position[axis] += shift;
        }
        let log_ratio = LogRatio::new(-self.log_q(target, current, candidate, die))?;
        let later = Some(LogRatio::new(self.most(target, candidate))?);
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
        let forth = LogRatio::new(self.log_q(target, from, &to.draw, die))?;
        Ok(LogRatio::new(self.log_q(target, to, &from.draw, die))?.times(forth.inverse())?)
    }

    fn log_ratio_after(
        &self,
        target: &Dice,
        current: &StateOf<Dice>,
        candidate: &StateOf<Dice>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::new(self.log_q(target, candidate, &current.draw, path.0 as usize))?)
    }
}
