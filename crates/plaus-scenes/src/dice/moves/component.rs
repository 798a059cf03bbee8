//! One initial condition.

use super::Scale;
use crate::dice::constraint::turned;
use crate::dice::prior::{NUMBERS, number_mut};
use crate::dice::{Dice, Draw};
use glam::DVec3;
use plaus_dist::stream::below;
use plaus_dist::{Density, LogRatio, Stream, standard_normal};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// One of the numbers of one die's initial conditions makes a step that leaves its law as it is; or, a quarter of the time, its orientation is turned about
/// a random axis, which is as likely as turning it back.
///
/// The ratio is the old value's density over the new one's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Component {
    /// Sizes of the steps: over the number's standard deviation, and over half a turn.
    pub scale: Scale,
}

/// Ways to change a die: its numbers, and three times its orientation.
const WAYS: usize = NUMBERS + 3;

fn ratio(target: &Dice, from: &Draw, to: &Draw, path: Path) -> Result<LogRatio, ModelError> {
    let (die, way) = (path.0 as usize / WAYS, path.0 as usize % WAYS);
    if way >= NUMBERS {
        return Ok(LogRatio::ONE);
    }
    let law = target.prior().number(die, way);
    let density = |draw: &Draw| law.log_density(&target.prior().value(draw, die, way));
    Ok(LogRatio::of(density(from)?, density(to)?)?)
}

impl Move<Dice> for Component {
    fn name(&self) -> &'static str {
        "component"
    }

    fn propose(
        &self,
        target: &Dice,
        current: &StateOf<Dice>,
        candidate: &mut Draw,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let die = below(stream, candidate.throws.len());
        let way = below(stream, WAYS);
        let old = target.prior().value(candidate, die, way.min(NUMBERS - 1));
        let throw = &mut candidate.throws[die];
        if way < NUMBERS {
            let law = target.prior().number(die, way);
            let new = law.mean() + law.sd() * self.scale.step((old - law.mean()) / law.sd(), stream);
            *number_mut(throw, way) += new - old;
        } else {
            let angle = self.scale.sample(stream) * std::f64::consts::PI;
            let vector = DVec3::from_array(std::array::from_fn(|_| standard_normal(stream)));
            throw.orientation = (turned(vector * angle) * throw.orientation).normalize();
        }
        let path = Path((die * WAYS + way) as u64);
        Ok(Proposal::Candidate { log_ratio: ratio(target, &current.draw, candidate, path)?, path, later: None })
    }

    fn log_ratio(
        &self,
        target: &Dice,
        from: &StateOf<Dice>,
        to: &StateOf<Dice>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        ratio(target, &from.draw, &to.draw, path)
    }
}
