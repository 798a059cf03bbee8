//! Balls activated or deactivated.

use super::happens;
use crate::spelling::{Drops, Spelling};
use plaus_dist::{LogRatio, Stream, math};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// Half of the time activates: each ball that is not dropped is, with probability η, at a uniform position. Else
/// deactivates: each ball that is dropped no longer is, with probability η. The paper's last two strategies, each the
/// other's reverse.
///
/// With N balls of which n are dropped, activating s of them has density `η^s (1−η)^(N−n−s) a^−s`, and the way back
/// `η^s (1−η)^n`. The prior's a^−s cancels, so that `α = min(1, λ^Δk (1−η)^(n+n'−N))`, and the inverse power for
/// deactivating.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Toggle {
    /// η.
    pub chance: f64,
    /// Forget the balls that were not toggled, (1−η)^…, as the paper does (erratum; samples no known law).
    pub incomplete: bool,
}

const ACTIVATE: Path = Path(0);
const DEACTIVATE: Path = Path(1);

impl Toggle {
    /// Log density of going from one to the other.
    fn log_q(self, target: &Spelling, from: &Drops, to: &Drops, path: Path) -> f64 {
        let (n, m) = (from.active(), to.active());
        let choices = if path == ACTIVATE { target.prior().balls() - n } else { n };
        let toggled = n.abs_diff(m);
        let untoggled = if self.incomplete { 0 } else { choices - toggled };
        let place = if path == ACTIVATE { -math::ln(target.prior().area()) } else { 0.0 };
        toggled as f64 * (math::ln(self.chance) + place) + untoggled as f64 * math::ln_1p(-self.chance)
    }

    fn ratio(self, target: &Spelling, from: &Drops, to: &Drops, path: Path) -> Result<LogRatio, ModelError> {
        let back = self.log_q(target, to, from, self.reverse(path));
        Ok(LogRatio::new(back - self.log_q(target, from, to, path))?)
    }
}

impl Move<Spelling> for Toggle {
    fn name(&self) -> &'static str {
        "toggle"
    }

    fn propose(
        &self,
        target: &Spelling,
        current: &StateOf<Spelling>,
        candidate: &mut Drops,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let path = if happens(0.5, stream) { ACTIVATE } else { DEACTIVATE };
        let mut any = false;
        for ball in candidate.balls.iter_mut().filter(|ball| ball.is_none() == (path == ACTIVATE)) {
            if happens(self.chance, stream) {
                *ball = if ball.is_none() { Some(target.prior().position(stream)) } else { None };
                any = true;
            }
        }
        if !any {
            return Ok(Proposal::Stay);
        }
        let log_ratio = self.ratio(target, &current.draw, candidate, path)?;
        Ok(Proposal::Candidate { log_ratio, path, later: None })
    }

    fn log_ratio(
        &self,
        target: &Spelling,
        from: &StateOf<Spelling>,
        to: &StateOf<Spelling>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        self.ratio(target, &from.draw, &to.draw, path)
    }

    fn reverse(&self, path: Path) -> Path {
        Path(1 - path.0)
    }
}
