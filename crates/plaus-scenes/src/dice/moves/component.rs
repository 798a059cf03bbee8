//! One initial condition.

use super::{Scale, WIDE, is_adapted, marked};
use crate::dice::constraint::turned;
use crate::dice::prior::{NUMBERS, number_mut};
use crate::dice::{Dice, Draw};
use glam::DVec3;
use plaus_dist::stream::below;
use plaus_dist::{Density, LogRatio, Stream, standard_normal};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// One of the numbers of one die's initial conditions makes a step that leaves its law as it is; or, a quarter of the
/// time, its orientation is turned about a random axis, which is as likely as turning it back.
///
/// The ratio is the old value's density over the new one's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Component {
    /// Sizes of the steps: of numbers of the place, of the velocity and of the spin, over their standard deviations;
    /// and of turns, over half a turn.
    pub scales: [Scale; KINDS],
}

impl Component {
    /// The same sizes for all.
    #[must_use]
    pub fn new(scale: Scale) -> Self {
        Self { scales: [scale; KINDS] }
    }
}

/// Kinds of ways to change a die, each with a scale of its own.
const KINDS: usize = 4;
const NAMES: [&str; KINDS] = ["place", "velocity", "spin", "turn"];

/// Ways to change a die: its numbers, and three times its orientation.
const WAYS: usize = NUMBERS + 3;
const PER_KIND: usize = WAYS / KINDS;

/// Die and way of a path.
fn way(path: Path) -> (usize, usize) {
    let index = (path.0 & !WIDE) as usize;
    (index / WAYS, index % WAYS)
}

fn ratio(target: &Dice, from: &Draw, to: &Draw, path: Path) -> Result<LogRatio, ModelError> {
    let (die, way) = way(path);
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
        let (throw, scale) = (&mut candidate.throws[die], self.scales[way / PER_KIND]);
        let is_wide = if way < NUMBERS {
            let law = target.prior().number(die, way);
            let (z, is_wide) = scale.step((old - law.mean()) / law.sd(), stream);
            *number_mut(throw, way) += law.mean() + law.sd() * z - old;
            is_wide
        } else {
            let (size, is_wide) = scale.sample(stream);
            let angle = size * std::f64::consts::PI;
            let vector = DVec3::from_array(std::array::from_fn(|_| standard_normal(stream)));
            throw.orientation = (turned(vector * angle) * throw.orientation).normalize();
            is_wide
        };
        let path = marked(Path((die * WAYS + way) as u64), is_wide);
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

    fn scales(&self) -> Vec<plaus_mcmc::Scale> {
        NAMES.iter().zip(self.scales).map(|(name, scale)| scale.declared(name, plaus_mcmc::Scale::ONE)).collect()
    }

    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<Dice>>> {
        let mut scales = self.scales;
        scales.iter_mut().zip(values).for_each(|(scale, value)| *scale = scale.about(*value));
        Some(Box::new(Self { scales }))
    }

    fn scale_of(&self, path: Path) -> Option<usize> {
        is_adapted(path).then(|| way(path).1 / PER_KIND)
    }
}
