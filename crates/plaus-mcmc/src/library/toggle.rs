//! Births and deaths of optional variables.

use super::happens;
use crate::law::Recipe;
use crate::moves::{At, Move, Path, Proposal, Transition};
use crate::target::ModelError;
use crate::vars::{Variables, log_density, renew};
use plaus_dist::{LogRatio, Stream, math};

/// With probability ½ births: each variable of a set that the draw lacks is added with probability η, with a value of
/// its law. Otherwise deaths: each one that the draw has is removed with probability η. These are the last two
/// strategies of Chenney & Forsyth's appendix B.2; each is the other's reverse.
///
/// If n of N variables are present, s births have density `η^s (1−η)^(N−n−s) Π p(value)`, and the way back has density
/// `η^s (1−η)^n`. The prior's own factors cancel. What remains beside the constraint is `(1−η)^(n+n'−N)`, or its
/// inverse for deaths.
#[derive(Debug, Clone)]
pub struct Toggle {
    /// The move's name.
    pub name: &'static str,
    /// The set.
    pub among: Vec<usize>,
    /// η.
    pub chance: f64,
    /// Leave out the variables that were not toggled, (1−η)^…, as Chenney & Forsyth do (erratum; samples no known law).
    pub incomplete: bool,
}

const BIRTHS: Path = Path(0);

impl Toggle {
    /// Log density of proposing `to` from `from`.
    fn log_q<T: Variables>(&self, target: &T, from: &T::Draw, to: &T::Draw, path: Path) -> Result<f64, ModelError> {
        let (mut toggled, mut untoggled, mut values) = (0.0, 0.0, 0.0);
        for &var in &self.among {
            let (before, after) = (target.get(from, var).is_some(), target.get(to, var).is_some());
            if before == (path == BIRTHS) {
                continue;
            }
            if before == after {
                untoggled += 1.0;
                continue;
            }
            toggled += 1.0;
            if path == BIRTHS {
                values += log_density(target, to, var)?.value();
            }
        }
        let left = if self.incomplete { 0.0 } else { untoggled * math::ln_1p(-self.chance) };
        Ok(toggled * math::ln(self.chance) + values + left)
    }
}

impl<T: Variables> Move<T> for Toggle {
    fn name(&self) -> &str {
        self.name
    }

    fn propose(&self, at: At<'_, T>, candidate: &mut T::Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let path = Path(u64::from(!happens(0.5, stream)));
        let mut any = false;
        for &var in &self.among {
            let present = at.target.get(candidate, var).is_some();
            if present != (path == BIRTHS) && happens(self.chance, stream) {
                at.target.set_present(candidate, var, !present);
                if !present {
                    renew(at.target, candidate, var, Recipe::Exact, stream);
                }
                any = true;
            }
        }
        if !any {
            return Ok(Proposal::Stay);
        }
        let back = self.log_q(at.target, candidate, at.state.draw, Path(1 - path.0))?;
        let log_ratio = LogRatio::new(back - self.log_q(at.target, at.state.draw, candidate, path)?)?;
        Ok(Proposal::Candidate { log_ratio, path, later: None })
    }

    fn log_ratio(&self, step: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        let back = self.log_q(step.target, step.to.draw, step.from.draw, Path(1 - step.path.0))?;
        Ok(LogRatio::new(back - self.log_q(step.target, step.from.draw, step.to.draw, step.path)?)?)
    }

    fn reverse(&self, path: Path) -> Path {
        Path(1 - path.0)
    }
}
