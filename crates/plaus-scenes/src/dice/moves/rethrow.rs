//! One die thrown anew.

use crate::dice::prior::NUMBERS;
use crate::dice::{Dice, Draw};
use plaus_dist::stream::below;
use plaus_dist::{Density, LogDensity, LogRatio, Stream};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// One die, each as likely, gets a fresh throw from the prior, and a fresh table where it has one of its own. The ratio
/// is the old throw's density over the new one's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Rethrow;

/// Log density of a throw, before heights are cut off: neither the old nor the new one is.
fn log_density(target: &Dice, draw: &Draw, die: usize) -> Result<LogDensity, ModelError> {
    let density = |k| target.prior().number(die, k).log_density(&target.prior().value(draw, die, k));
    (0..NUMBERS).try_fold(LogDensity::ONE, |sum, k| Ok(sum + density(k)?))
}

fn ratio(target: &Dice, from: &Draw, to: &Draw, die: usize) -> Result<LogRatio, ModelError> {
    let of = |draw: &Draw| log_density(target, draw, die);
    Ok(LogRatio::of(of(from)?, of(to)?)?)
}

impl Move<Dice> for Rethrow {
    fn name(&self) -> &'static str {
        "rethrow"
    }

    fn propose(
        &self,
        target: &Dice,
        current: &StateOf<Dice>,
        candidate: &mut Draw,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let die = below(stream, candidate.throws.len());
        candidate.throws[die] = target.prior().throw(die, stream);
        if candidate.tables.len() == candidate.throws.len() {
            candidate.tables[die].renew(stream);
        }
        let log_ratio = ratio(target, &current.draw, candidate, die)?;
        Ok(Proposal::Candidate { log_ratio, path: Path(die as u64), later: None })
    }

    fn log_ratio(
        &self,
        target: &Dice,
        from: &StateOf<Dice>,
        to: &StateOf<Dice>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        ratio(target, &from.draw, &to.draw, path.0 as usize)
    }
}
