//! Adds a ball over a bin that lacks one, or removes a ball.

use super::aim::Aim;
use crate::spelling::{Drops, Spelling};
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream, math};
use plaus_mcmc::library::happens;
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, StateRefOf, Transition};

/// Half of the time a birth: one of the N − n balls that are not dropped, all equally likely, is added at a position
/// that mostly lies over an empty designated bin. Otherwise a death: one of the n balls that are dropped, all equally
/// likely, is removed.
///
/// A birth has density `h(position)/(N−n)`, and the death that undoes it has probability `1/(n+1)`. The law h is that
/// of the state with one ball fewer, so the ratio of a death is known only after the simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BirthDeath {
    /// Share of positions that aim.
    pub aimed: f64,
}

/// The path of a birth is twice the ball's index; that of a death is one more.
fn is_birth(path: Path) -> bool {
    path.0.is_multiple_of(2)
}

fn ball_of(path: Path) -> usize {
    (path.0 / 2) as usize
}

impl BirthDeath {
    /// Log density of the birth of `ball` at `position` in `less`, without h.
    fn log_choice(target: &Spelling, less: &Drops) -> f64 {
        -math::ln((target.balls() - less.active()) as f64)
    }

    /// Log of h in the state with one ball fewer.
    fn log_aim(self, target: &Spelling, less: StateRefOf<'_, Spelling>, ball: usize, position: [f64; 2]) -> f64 {
        Aim::new(target, self.aimed, less.outcome, ball).log_density(position)
    }

    fn birth(self, target: &Spelling, less: StateRefOf<'_, Spelling>, ball: usize, position: [f64; 2]) -> f64 {
        let death = -math::ln((less.draw.active() + 1) as f64);
        death - Self::log_choice(target, less.draw) - self.log_aim(target, less, ball, position)
    }
}

impl Move<Spelling> for BirthDeath {
    fn name(&self) -> &'static str {
        "birth_death"
    }

    fn propose(
        &self,
        at: At<'_, Spelling>,
        candidate: &mut Drops,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let n = at.state.draw.active();
        if happens(0.5, stream) {
            let chosen = below(stream, at.target.balls() - n);
            let mut absent = (0..candidate.balls.len()).filter(|&ball| candidate.balls[ball].is_none());
            let Some(ball) = absent.nth(chosen) else { return Ok(Proposal::Stay) };
            let position = Aim::new(at.target, self.aimed, at.state.outcome, ball).sample(stream);
            candidate.balls[ball] = Some(position);
            let log_ratio = LogRatio::new(self.birth(at.target, at.state, ball, position))?;
            return Ok(Proposal::Candidate { log_ratio, path: Path(2 * ball as u64), later: None });
        }
        let chosen = below(stream, n);
        let mut present = (0..candidate.balls.len()).filter(|&ball| candidate.balls[ball].is_some());
        let Some(ball) = present.nth(chosen) else { return Ok(Proposal::Stay) };
        candidate.balls[ball] = None;
        let log_ratio = LogRatio::new(Self::log_choice(at.target, candidate) + math::ln(n as f64))?;
        let later = Some(LogRatio::new(Aim::highest(at.target, self.aimed))?);
        Ok(Proposal::Candidate { log_ratio, path: Path(2 * ball as u64 + 1), later })
    }

    fn log_ratio(&self, step: Transition<'_, Spelling>) -> Result<LogRatio, ModelError> {
        let ball = ball_of(step.path);
        let (less, more) = if is_birth(step.path) { (step.from, step.to) } else { (step.to, step.from) };
        let Some(position) = more.draw.balls[ball] else { return Ok(LogRatio::ZERO) };
        let birth = LogRatio::new(self.birth(step.target, less, ball, position))?;
        Ok(if is_birth(step.path) { birth } else { birth.inverse() })
    }

    fn reverse(&self, path: Path) -> Path {
        Path(path.0 ^ 1)
    }

    fn log_ratio_after(&self, step: Transition<'_, Spelling>) -> Result<LogRatio, ModelError> {
        let ball = ball_of(step.path);
        let Some(position) = step.from.draw.balls[ball] else { return Ok(LogRatio::ZERO) };
        Ok(LogRatio::new(self.log_aim(step.target, step.to, ball, position))?)
    }
}
